// panels.js - the head of the page, the step's answer, the hierarchy and the objects.

import { TREES } from "./boxes.js";
import { PHASES, colourOfObject, cssOf, scaleGradient } from "./colours.js";
import { KINDS } from "./data.js";
import { byId, count, duration, element, plural } from "./dom.js";
import { partsOf } from "./timeline.js";

const INCOMPLETE = ["complete", "complete", "the deadline passed", "cancelled",
  "more records than the daemon keeps"];
const VERDICTS = ["no", "possible", "yes", "none"];

function chip(text, title, className = "") {
  return element("span", { className: `chip ${className}`, title }, text);
}

export function makeHead({ meta }) {
  const { recording, steps } = meta;
  const when = new Date(recording.unix_ms);
  const differ = steps.filter(({ recorded }) => recorded === "other").length;
  const compared = steps.filter(({ recorded }) => recorded !== "none").length;
  document.title = `${recording.name} · pccd inspect`;
  byId("name").textContent = recording.name;
  const chips = [
    chip(`${count(steps.length)} of ${plural(recording.steps, "step", "steps")}`,
      meta.is_full ? "The page was full: see --every, --steps and --max-size" : "in this page, and recorded",
      meta.is_full ? "warn" : ""),
    chip(Number.isNaN(when.getTime()) ? "?" : when.toISOString().replace("T", " ").slice(0, 16), "recorded, UTC"),
    chip(`libpccd ${recording.library}`, "that recorded"),
    chip(recording.cpu || "?", "instruction set of the daemon that answered then"),
  ];
  if (!recording.is_whole) {
    chips.push(chip("cut short", "the recording has no end", "warn"));
  }
  if (meta.is_rounded) {
    chips.push(chip("16-bit positions", "written with --round"));
  }
  chips.push(differ > 0
    ? chip(plural(differ, "answer differs", "answers differ"), "from those that were recorded", "bad")
    : compared > 0 ? chip("✓ answers as recorded", "every hash is the recorded one", "good")
      : chip("not compared", "the recording holds no answers to compare with", "warn"));
  byId("chips").replaceChildren(...chips);
  byId("scale").style.background = scaleGradient();
}

function fact(name, value, title = "") {
  return element("div", { className: "fact", title }, element("span", {}, name), element("b", {}, value));
}

/** What else is known of an answer about what is near. */
function nearFacts({ distance_min: least, distance_max: greatest, crossings, verdict }) {
  return [
    fact("least distance", least === null ? "–" : least.toPrecision(6)),
    fact("greatest", greatest.toPrecision(6), "distance; of depth: how deep one is in the other"),
    fact("crossings", count(crossings), "edges that pass through faces"),
    fact("intersects", VERDICTS[verdict] ?? "?"),
  ];
}

/** What there is to say where things have a thickness. */
function thickFacts({ answer, separation, approach }) {
  return [
    ...(separation > 0 ? [fact("separation", Number(separation.toPrecision(6)), "added to the radii of each two features")] : []),
    ...(approach > 0 ? [fact("approach", approach, "the part of their first distance to which features may come that begin within it")] : []),
    ...(answer.inside > 0 ? [fact("inside at 0", count(answer.inside), "contacts of features that begin within their distance")] : []),
    ...(answer.crowded ? [fact("crowded", "yes", "more than half of the contacts begin within their distance: mostly the thickness is above the length of the edges")] : []),
  ];
}

/** What the step was answered. */
export function makeAnswer(data, state) {
  state.on(["index"], ({ index }) => {
    const step = data.meta.steps[index];
    const { answer } = step;
    const isPairs = answer.mode === "pairs";
    byId("total").textContent = count(answer.total);
    byId("total-what").textContent = step.near ? `near: ${step.near}` : isPairs ? "candidate pairs" : answer.total === 1 ? "contact" : "contacts";
    byId("facts").replaceChildren(
      ...KINDS.flatMap(({ name, id }, kind) => (kind < 2 || answer[id] > 0 ? [fact(name, count(answer[id]))] : [])),
      ...(step.near ? nearFacts(answer) : []),
      fact("first", answer.toi_first === null ? "–" : answer.toi_first.toFixed(6), "smallest time of impact"),
      ...(step.near ? [] : [fact("safe step", answer.safe_step.toFixed(6), "up to there nothing meets")]),
      ...(step.turns ? [fact("bodies on joints", "drawn right at t = 0 and 1", "between them they turn, but this page draws them, their contacts and boxes on straight ways; pccdctl render --time has their arcs")] : []),
      ...thickFacts(step),
      fact("touching at 0", count(answer.initial), "contacts of features that touch at t = 0, or are within their distance"),
      fact("possible", count(answer.possible), "not proved"),
      fact("answer", answer.status !== "OK" ? answer.status : INCOMPLETE[answer.incomplete] ?? "?"),
      ...(step.near ? [] : [fact("mode", answer.mode === "any" ? `any: ${VERDICTS[answer.verdict]}` : answer.mode)]),
      fact("method", `${answer.method}, ${answer.threads} thread${answer.threads === 1 ? "" : "s"}`),
      fact("step", duration(answer.times.step)),
      fact("queue", duration(answer.times.queue), "from arrival to the compute thread"),
    );
    const hash = byId("hash");
    hash.textContent = answer.hash;
    hash.title = { same: "the recorded hash", other: "not the recorded hash", none: "nothing to compare with" }[step.recorded];
    hash.className = { same: "good", other: "bad", none: "" }[step.recorded];
    const parts = partsOf(answer);
    byId("phases").replaceChildren(...parts.filter(([, ns]) => ns > 0).map(([name, ns]) => {
      const part = element("i", { title: `${name}: ${duration(ns)}` });
      part.style.flexGrow = String(ns);
      part.style.background = `var(--phase-${name})`;
      return part;
    }));
    byId("phase-names").replaceChildren(...[...PHASES, "other"].map((name) => {
      const dot = element("i", { className: "dot" });
      dot.style.background = `var(--phase-${name})`;
      return element("span", {}, dot, `${name} `, element("b", {}, duration(parts.find(([of]) => of === name)[1])));
    }));
  });
}

/** Which level of which hierarchy is drawn. */
export function makeHierarchy(data, state, view) {
  const select = byId("tree");
  const slider = byId("level");
  const levelsOf = ({ index, tree }) => data.meta.steps[index].boxes?.[tree] ?? [];

  select.addEventListener("change", () => state.set({ tree: select.value }));
  slider.addEventListener("input", () => state.set({ level: Number(slider.value) - 1 }));
  state.on(["index", "tree", "level"], (values) => {
    const trees = TREES.filter((tree) => data.meta.steps[values.index].boxes?.[tree]?.length > 0);
    byId("hierarchy").hidden = trees.length === 0;
    if (trees.length === 0) {
      state.set({ boxes: view?.showBoxes("faces", null) ?? 0 });
      return;
    }
    if (!trees.includes(values.tree)) {
      state.set({ tree: trees.includes("faces") ? "faces" : trees[0] });
      return;
    }
    select.replaceChildren(...trees.map((tree) => element("option", { value: tree, selected: tree === values.tree }, tree)));
    const levels = levelsOf(values);
    const level = Math.min(values.level, levels.length - 1);
    slider.max = String(levels.length);
    slider.value = String(level + 1);
    const text = level < 0 ? "off" : `level ${level} of ${levels.length - 1}: ${plural(levels[level].count, "box", "boxes")}`;
    byId("level-text").textContent = text;
    slider.setAttribute("aria-valuetext", text);
    const floats = level < 0 ? null : data.boxes(values.index, values.tree, level);
    state.set({ boxes: view ? view.showBoxes(values.tree, floats) : (floats?.length ?? 0) / 12 });
  });
}

/** "12 v · 4 f", and rods (r), points (p) and half the thickness where there are any. */
function sizeText({ mesh, radius }, unit) {
  const { vertexCount, triangles, rods, points, radii } = mesh;
  const parts = [[vertexCount, "v"], [triangles.length / 3, "f"], [rods.length / 2, "rod edges"], [points.length, "points"]];
  const most = radius > 0 || !radii ? radius : radii.reduce((a, b) => Math.max(a, b), 0);
  return [...parts.filter(([of]) => of > 0).map(([of, name]) => `${count(of)} ${name}`),
    ...(most > 0 ? [`radius ${Number((most * unit).toPrecision(3))}`] : [])].join(" · ");
}

/** The list of objects, and which are hidden. */
export function makeObjectList(data, state) {
  const list = byId("objects");
  state.on(["index", "hidden"], ({ index, hidden }) => {
    const { objects } = data.step(index);
    byId("object-count").textContent = count(objects.length);
    list.replaceChildren(...objects.slice(0, 200).map((object, i) => {
      const box = element("input", { type: "checkbox", checked: !hidden.has(object.handle) });
      const dot = element("i", { className: "dot square" });
      dot.style.background = cssOf(colourOfObject(i));
      box.addEventListener("change", () => {
        const next = new Set(state.values.hidden);
        next[box.checked ? "delete" : "add"](object.handle);
        state.set({ hidden: next });
      });
      return element("label", { className: "object" }, box, dot, `object ${i}`,
        element("span", {}, sizeText(object, data.meta.unit)));
    }));
  });
}
