// address.js - what is looked at, kept in the page's address, so that it can be sent and found again.

const WRITE_AFTER = 300; // ms: browsers refuse addresses that change at each frame

/** Whether a text is six numbers: what is looked at, and the way from there to the camera. */
function isCamera(text) {
  const numbers = text.split(",").map((part) => (part === "" ? NaN : Number(part)));
  return numbers.length === 6 && numbers.every((x) => Math.abs(x) < 1e9) && Math.hypot(...numbers.slice(3)) > 0;
}

/** What is kept of the state beside the step, its moment, and the record: how it is written, and
 * read again, null where the text is none of it. */
const textOf = (is) => ({ write: (text) => text, read: (text) => (is(text) ? text : null) });
const flag = { write: (on) => (on ? "1" : "0"), read: (text) => (["0", "1"].includes(text) ? text === "1" : null) };
const PARTS = {
  find: textOf(() => true), pair: textOf(() => true), camera: textOf(isCamera),
  order: textOf((text) => ["toi", "record"].includes(text)), up: textOf((text) => ["x", "y", "z"].includes(text)),
  wires: flag, thick: flag, engine: flag,
  opacity: { write: String, read: (text) => (Number(text) > 0 && Number(text) <= 1 ? Number(text) : null) },
  kinds: { write: (on) => on.map(Number).join(""), read: (text) => (/^[01]{5}$/.test(text) ? [...text].map((one) => one === "1") : null) },
  range: {
    write: (range) => range.map((t) => Number(t.toFixed(6))).join(),
    read: (text) => (/^[\d.]+,[\d.]+$/.test(text) && text.split(",").every((t) => t <= 1) ? text.split(",").map(Number) : null),
  },
  hidden: { write: (handles) => [...handles].join(), read: (text) => (/^\d+(,\d+)*$/.test(text) ? new Set(text.split(",").map(Number)) : null) },
};
const NAMES = Object.keys(PARTS);

/** What an address says that says nothing of it; `first`: the state with which a page begins. */
export const unsaid = (first) => Object.fromEntries(NAMES.map((name) => [name, first[name]]));

/** The part of the state that the address says, as changes for state.set; `step` is a number of the
 * recording, `index` the place of its step in the page. */
export function readAddress({ meta }) {
  const said = new URLSearchParams(window.location.hash.slice(1));
  const values = {};
  const number = (name) => (said.has(name) && said.get(name) !== "" ? Number(said.get(name)) : NaN);
  const index = meta.steps.findIndex(({ number: its }) => its === number("step"));
  if (index >= 0) {
    values.index = index;
  } else if (number("step") > 0) {
    values.absent = number("step"); // it is not drawn
  }
  if (number("t") >= 0 && number("t") <= 1) {
    values.t = number("t");
  }
  if (Number.isInteger(number("record"))) {
    values.chosen = number("record") - 1;
  }
  for (const name of NAMES.filter((one) => said.has(one))) {
    const value = PARTS[name].read(said.get(name));
    if (value !== null) {
      values[name] = value;
    }
  }
  return values;
}

/** Keep the address as what is shown; not at each frame. `first`: what it says nothing of. */
export function keepAddress({ meta }, state, first) {
  let isWaiting = false;
  function write() {
    const { values } = state;
    const said = new URLSearchParams({ step: meta.steps[values.index].number });
    if (values.t !== 1) {
      said.set("t", String(Number(values.t.toFixed(6))));
    }
    if (values.chosen >= 0) {
      said.set("record", String(values.chosen + 1));
    }
    for (const name of NAMES) {
      const text = PARTS[name].write(values[name]);
      if (text !== PARTS[name].write(first[name])) {
        said.set(name, text);
      }
    }
    window.history.replaceState(null, "", `#${said}`);
  }
  state.on(["index", "t", "chosen", "playing", ...NAMES], ({ playing }) => {
    if (!playing && !isWaiting) {
      isWaiting = true;
      setTimeout(() => {
        isWaiting = false;
        write();
      }, WRITE_AFTER);
    }
  });
}
