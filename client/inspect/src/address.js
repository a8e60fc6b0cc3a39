// address.js - what is looked at, kept in the page's address, so that it can be sent and found again.

const TEXTS = ["find", "pair", "order", "up", "camera"];

/** Whether a text is six numbers: what is looked at, and the way from there to the camera. */
function isCamera(text) {
  const numbers = text.split(",").map((part) => (part === "" ? NaN : Number(part)));
  return numbers.length === 6 && numbers.every((x) => Math.abs(x) < 1e9) && Math.hypot(...numbers.slice(3)) > 0;
}

/** The part of the state that the address says, as changes for state.set; `step` is a number of the
 * recording, `index` the place of its step in the page. */
export function readAddress({ meta }) {
  const said = new URLSearchParams(window.location.hash.slice(1));
  const values = {};
  const number = (name) => (said.has(name) && said.get(name) !== "" ? Number(said.get(name)) : NaN);
  const index = meta.steps.findIndex(({ number: its }) => its === number("step"));
  if (index >= 0) {
    values.index = index;
  }
  if (number("t") >= 0 && number("t") <= 1) {
    values.t = number("t");
  }
  if (Number.isInteger(number("record"))) {
    values.chosen = number("record") - 1;
  }
  for (const name of TEXTS.filter((one) => said.has(one))) {
    values[name] = said.get(name);
  }
  if (values.up !== undefined && !["x", "y", "z"].includes(values.up)) {
    delete values.up;
  }
  if (values.order !== undefined && !["toi", "record"].includes(values.order)) {
    delete values.order;
  }
  if (values.camera !== undefined && !isCamera(values.camera)) {
    delete values.camera;
  }
  return values;
}

/** Keep the address as what is shown; not at each frame while it plays. `first`: what it says nothing
 * of. */
export function keepAddress({ meta }, state, first) {
  state.on(["index", "t", "chosen", "playing", ...TEXTS], (values) => {
    if (values.playing) {
      return;
    }
    const said = new URLSearchParams({ step: meta.steps[values.index].number });
    if (values.t !== 1) {
      said.set("t", String(Number(values.t.toFixed(6))));
    }
    if (values.chosen >= 0) {
      said.set("record", String(values.chosen + 1));
    }
    for (const name of TEXTS.filter((one) => values[one] !== first[one])) {
      said.set(name, values[name]);
    }
    window.history.replaceState(null, "", `#${said}`);
  });
}
