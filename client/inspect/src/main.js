// main.js - the page of `pccdctl inspect`: puts the parts together.

import { featureText, flagText, makeContacts } from "./contacts.js";
import { makeCounters } from "./counters.js";
import { KINDS, readData } from "./data.js";
import { byId, oncePerFrame, plural } from "./dom.js";
import { makeKeys } from "./keys.js";
import { makeLanes } from "./lanes.js";
import { apartOf, between, featuresOf } from "./marks.js";
import { makeAnswer, makeHead, makeHierarchy, makeObjectList } from "./panels.js";
import { makeScene } from "./scene.js";
import { makeState } from "./state.js";
import { makeTimeline } from "./timeline.js";
import { makeTransport } from "./transport.js";

const WIRES_MAX = 30000; // triangles up to which edges are drawn at first

function fail(text) {
  byId("failure").textContent = text;
  byId("failure").hidden = false;
}

/** How large a contact's features are, to be seen from near. */
function sizeOf(step, i, radius) {
  const points = featuresOf(step, i).flatMap(({ object, vertices }) =>
    vertices.map((vertex) => between(object.x0, object.x1, vertex, 1)));
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
  state.on(["index", "theme"], ({ index }) => state.set({ lines: view.showLines(data.step(index)) }));
  state.on(["picked", "thick"], ({ index, picked, thick }) =>
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
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) {
      const { index, picked, t } = state.values;
      const box = canvas.getBoundingClientRect();
      state.set({ chosen: view.pick(data.step(index), picked, t, event.clientX - box.left, event.clientY - box.top) });
    }
    down = null;
  });
}

/** "vertex 3 meets face 4 at t = 0.500000, at the distance 0.02" */
function meetingText(step, i, unit) {
  const apart = apartOf(step, i) * unit;
  const flag = flagText(step, i);
  return `${featureText(step, i, "a")} meets ${featureText(step, i, "b")} at t = ${step.contacts.toi[i].toFixed(6)}`
    + (apart > 0 ? `, at the distance ${Number(apart.toPrecision(4))}` : "") + (flag ? ` (${flag.title})` : "");
}

/** What is chosen, in words, over the view. */
function makeCaption(data, state) {
  const draw = oncePerFrame(() => {
    const { index, chosen, t, picked } = state.values;
    const step = data.step(index);
    byId("caption").textContent = step.near
      ? `question ${step.number}: ${step.near}, ${plural(step.lines.count, "line", "lines")}`
      : chosen < 0 ? `step ${step.number}, t = ${t.toFixed(2)}` : meetingText(step, chosen, data.meta.unit);
    byId("scale-text").textContent = step.near ? "share of the greatest distance" : "time of impact";
    byId("view").setAttribute("aria-label", `Step ${step.number} at time ${t.toFixed(2)}: `
      + `${plural(step.objects.length, "object", "objects")}, ${plural(picked.length, "contact", "contacts")} shown`);
  });
  state.on(["index", "chosen", "t", "picked"], draw);
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
}

/** Whether anything in the page has a thickness. */
const isThick = ({ steps, meshes }) => meshes.some(({ radii }) => radii)
  || steps.some(({ separation, objects }) => separation > 0 || objects.some(({ radius }) => radius > 0));

function start() {
  const data = readData();
  const { steps } = data.meta;
  const busiest = steps.reduce((best, { answer }, i) => (answer.total > steps[best].answer.total ? i : best), 0);
  const triangles = steps[0].objects.reduce((sum, { mesh }) => sum + data.meta.meshes[mesh].triangles, 0);
  const state = makeState({
    index: busiest, t: 1, playing: false, speed: 1, kinds: KINDS.map(() => true), range: [0, 1], order: "toi",
    picked: [], chosen: -1, lines: 0, sticks: 0, thick: false, tree: "faces", level: -1, boxes: 0, lanes: 0, hidden: new Set(),
    wires: triangles <= WIRES_MAX, opacity: 1, up: "y", theme: "",
  });
  const view = makeView(drawAxes);
  const does = {
    fit() {
      const { index, up, thick } = state.values;
      view?.setExtent(data.step(index), up, thick);
      view?.fit(up);
    },
    fly(i) {
      const { index } = state.values;
      if (view && i >= 0) {
        const step = data.step(index);
        state.set({ t: step.contacts.toi[i], playing: false });
        view.flyToContact(step, i, step.contacts.toi[i], sizeOf(step, i, view.extentRadius()));
      }
    },
  };
  byId("thick").hidden = !isThick(data.meta);
  makeHead(data);
  makeContacts(data, state, does.fly);
  if (view) {
    connectView(data, state, view);
  }
  makeHierarchy(data, state, view);
  makeAnswer(data, state);
  makeObjectList(data, state);
  makeCounters(data, state);
  makeTimeline(data, state);
  makeLanes(data, state);
  makeTransport(data, state);
  makeCaption(data, state);
  makeToggles(state, does);
  makeKeys(data, state, does);
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const dress = () => state.set({ theme: dark.matches ? "dark" : "light" });
  dark.addEventListener("change", dress);
  dress();
  // For consoles, and for the tests of the page.
  window.pccd = {
    data, state, view, fly: does.fly,
    positions: (object) => {
      const { x0, x1 } = data.step(state.values.index).objects[object];
      return Array.from(x0, (x, i) => x + state.values.t * (x1[i] - x));
    },
  };
}

try {
  start();
  document.body.classList.add("ready");
} catch (error) {
  fail(error.message);
  console.error(error);
}
