// main.js - the page of `pccdctl inspect`: puts the parts together.

import { keepAddress, readAddress, unsaid } from "./address.js";
import { scaleGradient, setTheme } from "./colours.js";
import { makeContacts } from "./contacts.js";
import { makeCounters } from "./counters.js";
import { KINDS, readData, vertexAt, verticesAt } from "./data.js";
import { byId, plural } from "./dom.js";
import { makeKeys } from "./keys.js";
import { makeLanes } from "./lanes.js";
import { featuresOf } from "./marks.js";
import { contactsText, makeAbsent, makeAnswer, makeDetail, makeHead, makeHierarchy, makeObjectList, makeWhole, recordText } from "./panels.js";
import { isOfPair } from "./pairs.js";
import { makeScene } from "./scene.js";
import { makeState } from "./state.js";
import { makeTimeline } from "./timeline.js";
import { makeGoTo, makeTransport } from "./transport.js";
import { digits, firstOf, measureOf, nounOf } from "./words.js";

const WIRES_MAX = 30000; // triangles up to which edges are drawn at first

function fail(text) {
  byId("failure").textContent = text;
  byId("failure").hidden = false;
}

/** How large a contact's features are, to be seen from near. */
function sizeOf(step, i, radius) {
  const points = featuresOf(step, i).flatMap(({ object, vertices }) =>
    vertices.map((vertex) => vertexAt(object, vertex, 1)));
  let longest = 0;
  for (const p of points) {
    for (const q of points) {
      longest = Math.max(longest, Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    }
  }
  return Math.min(Math.max(longest, 1e-4 * radius) * 0.7, radius / 8);
}

function makeView(onMove) {
  try {
    return makeScene(byId("view"), onMove);
  } catch {
    fail("This browser gives the page no WebGL, so there is nothing to see here; all else works. "
      + "Try another browser, or switch on its graphics acceleration.");
    byId("view").hidden = true;
    return null;
  }
}

/** A ring around what is chosen: its place [x, y, depth] on the canvas, and whether a surface hides
 * it; null: nothing is. */
function movePin(pin) {
  byId("pin").hidden = pin === null || pin.place[2] >= 1;
  if (pin !== null) {
    const { place } = pin;
    byId("pin").classList.toggle("behind", pin.isHidden);
    byId("pin").style.transform = `translate(${place[0]}px, ${place[1]}px)`;
  }
}

/** Three axes in a corner, as the camera sees them. */
function drawAxes(camera) {
  const lines = byId("axes").querySelectorAll("g");
  const { elements } = camera.matrixWorldInverse;
  lines.forEach((group, axis) => {
    const x = 22 * elements[4 * axis];
    const y = -22 * elements[4 * axis + 1];
    const [line, text] = group.children;
    line.setAttribute("x2", x.toFixed(2));
    line.setAttribute("y2", y.toFixed(2));
    text.setAttribute("x", (1.32 * x).toFixed(2));
    text.setAttribute("y", (1.32 * y).toFixed(2));
    group.style.opacity = String(0.65 + 0.35 * elements[4 * axis + 2]);
  });
}

/** The time of what is chosen; what is near has none. */
const momentOf = (step, i) => ({ t: step.near ? 1 : step.contacts.toi[i], playing: false });

function connectView(data, state, view) {
  const radius = () => view.extentRadius();
  let scene = null;
  state.on(["theme"], () => view.dress());
  state.on(["t"], ({ t }) => view.setTime(t));
  state.on(["index", "wires", "opacity", "hidden", "thick", "theme"], (values) => {
    const step = data.step(values.index);
    if (scene !== step.scene) { // another one may be anywhere
      scene = step.scene;
      view.setExtent(step, values.up, values.thick);
      view.fit(values.up, true);
    }
    view.showObjects(step, values);
  });
  state.on(["picked", "theme"], ({ index, picked }) => state.set({ lines: view.showLines(data.step(index), picked) }));
  state.on(["picked", "thick", "theme"], ({ index, picked, thick }) =>
    state.set({ sticks: view.showMarks(data.step(index), picked, thick) }));
  state.on(["chosen", "theme"], ({ index, chosen }) => {
    const step = data.step(index);
    view.choose(step, chosen, chosen >= 0 ? sizeOf(step, chosen, radius()) : 0);
  });
  state.on(["up"], ({ up }) => {
    view.setUp(up);
    view.fit(up, true);
  });
  const canvas = byId("view");
  let down = null;
  canvas.addEventListener("pointerdown", (event) => {
    down = [event.clientX, event.clientY];
  });
  canvas.addEventListener("pointerup", (event) => {
    const still = event.pointerType === "touch" ? 12 : 4; // pixels that a click may move
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < still) {
      const step = data.step(state.values.index);
      const box = canvas.getBoundingClientRect();
      const chosen = view.pick(step, state.values, event.clientX - box.left, event.clientY - box.top, event.pointerType);
      state.set({ chosen, ...(chosen >= 0 ? momentOf(step, chosen) : {}) });
    }
    down = null;
  });
}

/** The step that has the most contacts, or that was told the most. */
const busiestOf = ({ meta: { steps } }) =>
  steps.reduce((best, { answer }, i) => (answer.total > steps[best].answer.total ? i : best), 0);

/** Where a page opens that is asked for nothing else: at the first contact, or at the start. On a
 * phone what is known of a contact would lie over the rest. */
function openingOf(step) {
  const first = firstOf(step);
  const isPhone = window.matchMedia("(max-width: 42.5em)").matches; // as in style.css
  return { chosen: isPhone ? -1 : first, t: step.near ? 1 : first < 0 ? 0 : step.contacts.toi[first] };
}

/** Which moment of a step that is, for the pair that is chosen. */
function momentText(step, t, pair) {
  const first = firstOf(step, isOfPair(step, pair));
  return first >= 0 && Math.abs(t - step.contacts.toi[first]) < 1e-6 ? `, its first contact${pair === "" ? "" : " of this pair"}` : { 0: ", its start", 1: ", its end" }[t] ?? "";
}

/** What is seen, under the view: which moment, and what the colours mean. */
function makeCaption(data, state) {
  const draw = ({ index, t, pair, picked }) => { // at once, as the time beside the slider
    const step = data.step(index);
    const measure = measureOf(step);
    const greatest = step.near ? step.contacts.greatest : 1;
    const isBusiest = pair === "" && data.all.length > 1 && index === busiestOf(data) && step.answer.total > 0
      && data.all.every(({ number, answer }) => number === step.number || answer.total < step.answer.total);
    const which = `${step.near ? "question" : "step"} ${step.number}${isBusiest ? `, with the most ${nounOf(step)[1]}` : ""}`;
    byId("caption").textContent = step.near ? which : `${which}; t = ${digits(t)}${momentText(step, t, pair)}`;
    byId("scale-box").hidden = measure === null || picked.length === 0 || greatest === 0;
    byId("scale").style.background = scaleGradient();
    byId("scale-text").textContent = step.near ? "distance" : "time of impact";
    byId("scale-end").textContent = digits(greatest);
    byId("view").setAttribute("aria-label", `Step ${step.number} at time ${digits(t)}: `
      + `${plural(step.objects.length, "object", "objects")}, ${plural(picked.length, "contact", "contacts")} shown`);
  };
  state.on(["index", "t", "pair", "picked", "theme"], draw);
}

function makeToggles(state, does) {
  const toggle = (id, read, write) => {
    byId(id).addEventListener("click", () => state.set(write(state.values)));
    state.on(["wires", "opacity", "thick"], (values) => byId(id).setAttribute("aria-pressed", String(read(values))));
  };
  toggle("wires", ({ wires }) => wires, ({ wires }) => ({ wires: !wires }));
  toggle("xray", ({ opacity }) => opacity < 1, ({ opacity }) => ({ opacity: opacity < 1 ? 1 : 0.28 }));
  toggle("thick", ({ thick }) => thick, ({ thick }) => ({ thick: !thick }));
  byId("fit").addEventListener("click", does.fit);
  byId("up").addEventListener("change", (event) => state.set({ up: event.target.value }));
  state.on(["up"], ({ up }) => {
    byId("up").value = up;
  });
  byId("engine").addEventListener("toggle", () => state.set({ engine: byId("engine").open }));
  state.on(["engine"], ({ engine }) => {
    byId("engine").open = engine;
  });
}

/** Whether anything in the page has a thickness. */
const isThick = ({ steps, meshes }) => meshes.some(({ radii }) => radii)
  || steps.some(({ separation, objects }) => separation > 0 || objects.some(({ radius }) => radius > 0));

/** Put a text where one pastes from; pages from a disk may not be allowed the short way. */
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const field = document.createElement("textarea");
    field.value = text;
    document.body.append(field);
    field.select();
    document.execCommand("copy");
    field.remove();
  }
}

async function start() {
  const data = readData();
  const { steps } = data.meta;
  const busiest = busiestOf(data);
  const triangles = steps[0].objects.reduce((sum, { mesh }) => sum + data.meta.meshes[mesh].triangles, 0);
  const first = {
    index: busiest, absent: null, t: 1, playing: false, speed: 1, kinds: KINDS.map(() => true), range: [0, 1], order: "toi", find: "", pair: "",
    camera: "", found: [], picked: [], chosen: -1, lines: 0, sticks: 0, thick: false, tree: "faces", level: -1, boxes: 0, lanes: 0, hidden: new Set(),
    wires: triangles <= WIRES_MAX, opacity: 1, up: data.meta.up, engine: false, theme: "",
  };
  const said = readAddress(data);
  await data.load(said.index ?? busiest);
  const state = makeState({ ...first, index: said.index ?? busiest });
  const goTo = makeGoTo(data, state);
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const dress = () => {
    const theme = dark.matches ? "dark" : "light";
    setTheme(theme);
    state.set({ theme });
  };
  dark.addEventListener("change", dress);
  dress();
  const view = makeView((camera, pin, at) => {
    drawAxes(camera);
    movePin(pin);
    state.set({ camera: at });
  });
  const flyTo = (i, isClose) => {
    const { index } = state.values;
    if (view && i >= 0) {
      const step = data.step(index);
      byId("view").scrollIntoView({ block: "nearest" }); // on a phone the list is below it
      state.set(momentOf(step, i));
      view.flyToContact(step, i, step.contacts.toi[i], sizeOf(step, i, view.extentRadius()), isClose);
    }
  };
  byId("copy-address").addEventListener("click", async () => {
    await copyText(window.location.href);
    byId("copy-address").textContent = "copied";
  });
  byId("copy-list").addEventListener("click", async () => {
    const { index, picked } = state.values;
    await copyText(contactsText(data.step(index), picked, data.meta));
    byId("copy-list").textContent = "Copied";
  });
  const does = {
    goTo,
    /** Go to one of data.all, or say that it is not drawn. */
    show: (step) => (step.index === undefined ? state.set({ absent: step.number, playing: false })
      : goTo(step.index, { playing: false })),
    fit() {
      const { index, up, thick } = state.values;
      view?.setExtent(data.step(index), up, thick);
      view?.fit(up);
    },
    turn: (...by) => view?.turn(...by),
    fly: (i) => flyTo(i, false),
    closer: () => flyTo(state.values.chosen, true),
    async copy() {
      const { index, chosen } = state.values;
      if (chosen >= 0) {
        await copyText(recordText(data.step(index), chosen, data.meta));
        byId("copied").textContent = "copied";
      }
    },
  };
  byId("thick").hidden = !isThick(data.meta);
  byId("list-part").hidden = steps.every(({ contacts, lines }) => contacts.count === 0 && !lines?.count);
  makeHead(data, does.show);
  makeContacts(data, state, does);
  if (view) {
    connectView(data, state, view);
  }
  makeHierarchy(data, state, view);
  makeAnswer(data, state);
  makeWhole(data, state, does.show);
  makeAbsent(data, state);
  makeDetail(data, state, does);
  makeObjectList(data, state);
  makeCounters(data, state);
  makeTimeline(data, state, does.show);
  makeLanes(data, state);
  makeTransport(data, state, goTo);
  makeCaption(data, state);
  makeToggles(state, does);
  makeKeys(data, state, does);
  const follow = (values) => {
    const { index, chosen = -1, camera, absent = null, ...rest } = values;
    state.set(rest);
    state.set({ chosen: state.values.picked.includes(chosen) ? chosen : -1 });
    if (camera) {
      view?.lookFrom(camera);
    }
    state.set({ absent });
  };
  follow(window.location.hash.length > 1 ? said : openingOf(data.step(busiest)));
  keepAddress(data, state, first);
  window.addEventListener("hashchange", async () => {
    const asked = readAddress(data);
    await goTo(asked.index ?? state.values.index);
    follow({ ...unsaid(first), t: 1, ...asked });
  });
  // For consoles, and for the tests of the page.
  window.pccd = {
    data, state, view, fly: does.fly,
    positions: (object) =>
      [...verticesAt(data.step(state.values.index).objects[object], state.values.t)],
  };
}

start().then(() => document.body.classList.add("ready"), (error) => {
  byId("sentence").textContent = "";
  fail(error.message);
  console.error(error);
});
