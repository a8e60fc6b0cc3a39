// panels.js - the head of the page, the step's answer, the chosen record, the hierarchy and the
// objects.

import { TREES } from "./boxes.js";
import { PHASES, colourOfObject, cssOf, nameOfColour } from "./colours.js";
import { KINDS, contactAt } from "./data.js";
import { byId, count, duration, element, plural } from "./dom.js";
import { apartOf } from "./marks.js";
import { partsOf } from "./timeline.js";
import { digits, featureText, firstOf, flagText, headOf, isOfBounds, measureOf, nounOf, renderText, sentenceOf, sideOf } from "./words.js";

const VERDICTS = ["no", "possible", "yes"];

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
      meta.is_full ? "The page was full: see --every, --steps and --max-size"
        : meta.every > 1 ? `One in ${meta.every}, as --every or --max-size ask` : "in this page, and recorded",
      meta.is_full ? "warn" : ""),
    chip(Number.isNaN(when.getTime()) ? "?" : when.toISOString().replace("T", " ").slice(0, 16), meta.is_of_files ? "computed from the files, UTC" : "recorded, UTC"),
    chip(`libpccd ${recording.library}`, "that recorded"),
    chip(recording.cpu || "?", "instruction set of the daemon that answered then"),
  ];
  if (!recording.is_whole) {
    chips.push(chip("cut short", "the recording has no end", "warn"));
  }
  if (meta.is_rounded) {
    chips.push(chip("16-bit positions", "written with --round"));
  }
  if (differ > 0) {
    chips.push(chip(plural(differ, "answer differs", "answers differ"),
      meta.is_of_files ? "when it is computed again" : "from those that were recorded", "bad"));
  } else if (!meta.is_of_files) {
    chips.push(compared > 0 ? chip("✓ answers as recorded", "every hash is the recorded one", "good")
      : chip("not compared", "the recording holds no answers to compare with", "warn"));
  }
  byId("chips").replaceChildren(...chips);
}

function fact(name, value, title = "") {
  return element("div", { className: "fact", title }, element("span", {}, name), element("b", {}, value));
}

/** One with a line of its own, which says what it means. */
function plainFact(...of) {
  const made = fact(...of);
  made.classList.add("plain");
  return made;
}

/** What else is known of an answer about what is near: crossings, if they were asked for. */
function nearFacts({ answer, asked }) {
  const { distance_min: least, distance_max: greatest, crossings, verdict } = answer;
  return [
    ...(least === null || least === greatest ? [] : [fact("least distance", digits(least)),
      fact("greatest", digits(greatest), "distance; of depth: how deep one is in the other")]),
    ...(asked.crossings ? [fact("crossings", count(crossings), "edges that pass through faces")] : []),
    ...(VERDICTS[verdict] ? [fact("intersects", VERDICTS[verdict])] : []),
  ];
}

/** What there is to say where things have a thickness. */
function thickFacts({ answer, separation, approach }) {
  return [
    ...(separation > 0 ? [fact("separation", digits(separation), "added to the radii of each two features")] : []),
    ...(approach > 0 ? [fact("approach", digits(approach), "the part of their first distance to which features may come that begin within it")] : []),
    ...(answer.inside > 0 ? [fact("inside at 0", count(answer.inside), "contacts of features that begin within their distance")] : []),
    ...(answer.crowded ? [fact("crowded", "yes", "more than half of the contacts begin within their distance: mostly the thickness is above the length of the edges")] : []),
  ];
}

/** What is worth a line of a step's answer, beside its sentence. */
function stepFacts({ answer, turns }) {
  const isTimed = !["pairs", "any"].includes(answer.mode);
  const isCrossed = answer.crossings + answer.start_inside > 0;
  return [
    ...(isTimed ? [plainFact("safe step", digits(answer.safe_step), isCrossed ? "there is none from such a start" : "before this t no contact begins")] : []),
    ...(turns ? [plainFact("turning bodies", "on arcs", "drawn on the way that they turn, with their contacts; boxes of hierarchies go straight")] : []),
    ...(answer.initial > 0 ? [fact("touching at 0", count(answer.initial), "contacts of features that touch at t = 0, or are within their distance")] : []),
    ...(answer.possible > 0 ? [fact("possible", count(answer.possible), "not proved")] : []),
  ];
}

/** What the step was answered: for everybody, and, folded, for those who look at the engine. */
export function makeAnswer(data, state) {
  const { steps } = data.meta;
  state.on(["index"], ({ index }) => {
    const step = data.step(index);
    const { answer } = step;
    const [before, total, behind] = sentenceOf(step, steps[steps.length - 1].number);
    byId("sentence").replaceChildren(before,
      element("b", { id: "total" }, typeof total === "number" ? count(total) : total), behind);
    byId("records-head").textContent = headOf(step);
    byId("facts").replaceChildren(...(step.near ? nearFacts(step) : stepFacts(step)), ...thickFacts(step));
    byId("engine-facts").replaceChildren(
      ...(step.near ? [] : [fact("mode", answer.mode)]),
      fact("method", `${answer.method}, ${answer.threads} thread${answer.threads === 1 ? "" : "s"}`),
      fact("step", duration(answer.times.step)),
      fact("queue", duration(answer.times.queue), "from arrival to the compute thread"),
    );
    const hash = byId("hash");
    hash.textContent = answer.hash;
    const known = data.meta.is_of_files ? "hash of the first time" : "recorded hash";
    hash.title = { same: `the ${known}`, other: `not the ${known}`, none: "nothing to compare with" }[step.recorded];
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

/** What is worth knowing of all steps of the page, in a sentence whose steps one can go to. */
export function makeWhole({ meta }, goTo) {
  const steps = meta.steps.map(({ near, answer, number }, index) => ({ near, answer, number, index }))
    .filter(({ near, answer }) => !near && answer.mode !== "pairs");
  const meeting = steps.filter(({ answer }) => (answer.mode === "any" ? answer.verdict > 0 : answer.total > 0));
  const crossed = steps.filter(({ answer }) => answer.crossings > 0);
  const greatest = (measure) => steps.reduce((most, step) => (measure(step.answer) > measure(most.answer) ? step : most), steps[0]);
  const go = ({ number, index }) => {
    const button = element("button", { title: `Go to step ${number}` }, `step ${number}`);
    button.addEventListener("click", () => goTo(index, { playing: false }));
    return button;
  };
  byId("whole").hidden = steps.length < 2;
  if (steps.length < 2) {
    return;
  }
  const most = greatest(({ total }) => total);
  const slowest = greatest(({ times }) => times.step);
  byId("whole").replaceChildren(
    `In ${count(meeting.length)} of ${count(steps.length)} steps something meets`,
    ...(meeting.length > 0 ? [", first in ", go(meeting[0])] : []),
    ...(most.answer.total > 0 ? [", most in ", go(most), ` (${count(most.answer.total)})`] : []),
    ...(crossed.length > 0 ? [`; ${plural(crossed.length, "step begins", "steps begin")} with an intersection, the first is `, go(crossed[0])] : []),
    "; the slowest is ", go(slowest), ` (${duration(slowest.answer.times.step).replace(" ", "\u00a0")})`,
  );
}

/** "(0.1, 0.2, 0.3)" */
const pointText = (x) => `(${x.map(digits).join(", ")})`;

const FLOAT_PART = 2 ** -22; // of the size of a scene: what is less is the rounding of its floats

/** Where record `i` is, in the recording's own coordinates. */
function placeText(step, i, { origin, unit }) {
  step.size ??= step.objects.reduce((most, { x1 }) => x1.reduce((its, x) => Math.max(its, Math.abs(x)), most), 0);
  const at = contactAt(step, i, step.near ? 0 : step.contacts.toi[i]).map((x, k) => x * unit + origin[k]);
  return pointText(at.map((x) => (Math.abs(x) > FLOAT_PART * step.size * unit ? x : 0)));
}

/** What is known of a record: [name, text]. */
function recordFacts(step, i, meta) {
  const normal = [0, 1, 2].map((k) => step.contacts.normal[3 * i + k]);
  const apart = apartOf(step, i) * meta.unit;
  const measure = measureOf(step);
  const flag = flagText(step, i);
  return [
    ...(isOfBounds(step) ? [["vertex", featureText(step, i, "a")]]
      : [["kind", KINDS[step.contacts.kind[i]].name], ["first", featureText(step, i, "a")], ["second", featureText(step, i, "b")]]),
    ...(measure?.name === "time" ? [["time", `t = ${digits(measure.of(i))}`]] : []),
    ...(measure ? [["place", placeText(step, i, meta)]] : []),
    ...(normal.some((x) => x !== 0) ? [["normal", pointText(normal.map((x) => Number(x.toFixed(2))))]] : []), // a 127th
    ...(measure && (step.near || apart > 0) ? [[isOfBounds(step) ? "bound" : "distance", digits(step.near ? measure.of(i) : apart)]] : []),
    ...(flag ? [["begins", flag.title]] : []),
    ...(measure?.name === "time" ? [["drawn by", renderText(step, i, meta)]] : []),
  ];
}

/** A record in a sentence, for a mail: "step 3: vertex 3 of cloth meets face 12 of ball at ...". */
export function recordText(step, i, meta) {
  const facts = Object.fromEntries(recordFacts(step, i, meta));
  const details = ["time", "place", "normal", "distance", "bound"].filter((name) => facts[name])
    .map((name) => (name === "time" ? facts.time : `${name} ${facts[name]}`));
  const features = facts.vertex ?? `${facts.first} ${measureOf(step)?.name === "time" ? "meets" : "and"} ${facts.second}`;
  return `${step.near ? "question" : "step"} ${step.number}: ${features}`
    + `${details.length > 0 ? ` at ${details.join(", ")}` : ""}${facts.begins ? ` (${facts.begins})` : ""}`;
}

/** In which colour of style.css the view draws what a fact names; undefined: it does not. */
function drawnAs(step, i, name) {
  return { first: "feature-a", second: "feature-b", [apartOf(step, i) > 0 ? "distance" : "normal"]: "normal" }[name];
}

/** A point is drawn as the way that it goes. */
const isWay = (step, i, name) => !step.near && ((name === "first" && sideOf(step, i, "a").points === 1)
  || (name === "second" && sideOf(step, i, "b").points === 1));

/** The record that is chosen, with all that is known of it. */
export function makeDetail(data, state, does) {
  byId("closer").addEventListener("click", does.closer);
  byId("copy").addEventListener("click", does.copy);
  byId("detail-close").addEventListener("click", () => state.set({ chosen: -1 }));
  state.on(["index", "chosen"], ({ index, chosen }) => {
    const step = data.step(index);
    const isShown = chosen >= 0 && chosen < step.contacts.count;
    byId("detail").hidden = !isShown;
    byId("copied").textContent = "";
    if (isShown) {
      const [one] = nounOf(step);
      const noun = one === "contact" ? "contact" : "record";
      const which = data.meta.steps.length === 1 ? "" : step.near ? " of this question" : " of this step";
      byId("detail-head").textContent = chosen === firstOf(step) ? `First ${noun}${which}` : `${noun[0].toUpperCase()}${noun.slice(1)}`;
      byId("detail-facts").replaceChildren(...recordFacts(step, chosen, data.meta).flatMap(([name, text]) => {
        const dot = element("i", { className: "dot square", title: "its colour in the view" });
        const drawn = drawnAs(step, chosen, name);
        dot.style.background = `var(--${drawn})`;
        return [element("dt", {}, name), element("dd", {}, ...(drawn ? [dot] : []), text,
          ...(isWay(step, chosen, name) ? [element("span", { className: "quiet" }, ", the line is its way")] : []))];
      }));
    }
  });
}

/** Which level of which hierarchy is drawn. */
export function makeHierarchy(data, state, view) {
  const select = byId("tree");
  const slider = byId("level");
  const levelsOf = ({ index, tree }) => data.meta.steps[index].boxes?.[tree] ?? [];

  select.addEventListener("change", () => state.set({ tree: select.value }));
  slider.addEventListener("input", () => state.set({ level: Number(slider.value) - 1 }));
  state.on(["index", "tree", "level", "engine"], (values) => {
    const trees = TREES.filter((tree) => data.meta.steps[values.index].boxes?.[tree]?.length > 0);
    byId("hierarchy").hidden = trees.length === 0 || !values.engine;
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
    const level = values.engine ? Math.min(values.level, levels.length - 1) : -1;
    slider.max = String(levels.length);
    slider.value = String(level + 1);
    const text = level < 0 ? "off" : `level ${level} of ${levels.length - 1}: ${plural(levels[level].count, "box", "boxes")}`;
    byId("level-text").textContent = text;
    slider.setAttribute("aria-valuetext", text);
    const floats = level < 0 ? null : data.step(values.index).boxesAt(values.tree, level);
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
    byId("objects-fold").hidden = objects.length < 2;
    list.replaceChildren(...objects.slice(0, 200).map((object, i) => {
      const box = element("input", { type: "checkbox", checked: !hidden.has(object.handle) });
      const dot = element("i", { className: "dot square" });
      dot.style.background = cssOf(colourOfObject(i));
      box.addEventListener("change", () => {
        const next = new Set(state.values.hidden);
        next[box.checked ? "delete" : "add"](object.handle);
        state.set({ hidden: next });
      });
      return element("label", { className: "object" }, box, dot, `${object.name} `, element("span", { className: "colour" }, nameOfColour(i)),
        element("span", {}, sizeText(object, data.meta.unit)));
    }));
  });
}
