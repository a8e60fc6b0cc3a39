// panels.js - the head of the page, the step's answer, the chosen record, the hierarchy and the
// objects.

import { TREES } from "./boxes.js";
import { PHASES, colourOfObject, cssOf, nameOfColour } from "./colours.js";
import { FEATURES, KINDS, PROVED, contactAt } from "./data.js";
import { byId, count, duration, element, plural } from "./dom.js";
import { apartOf } from "./marks.js";
import { countsOf, earliestOf, meetingText, namesOf, rangesText } from "./pairs.js";
import { partsOf } from "./timeline.js";
import { INCOMPLETE, absentTexts, askedText, digits, entryNoun, featureText, firstOf, flagText, headOf, isOfBounds, measureOf, nounOf, partText, refusalText, renderText, sentenceOf, sideOf } from "./words.js";

const VERDICTS = ["no", "possible", "yes"];

function chip(text, title, className = "") {
  return element("span", { className: `chip ${className}`, title }, text);
}

const isRefused = ({ answer }) => answer.status !== "OK";
const isComplete = ({ status, incomplete }) => status === "OK" && !INCOMPLETE[incomplete];

/** Whether answers are complete and proved, as check says it: [text, title, class] of a chip. */
function completeness(all) {
  const cut = all.filter(({ answer }) => !isComplete(answer));
  const possible = all.reduce((sum, { answer: { mode, verdict, possible: its } }) => sum + its + (mode === "any" && verdict === 1 ? 1 : 0), 0);
  const isTimed = all.some(({ near, answer }) => !near && answer.mode !== "pairs");
  return cut.length > 0 ? [cut.every(isRefused) ? plural(cut.length, "question was not answered", "questions were not answered")
    : `${plural(cut.length, "answer is", "answers are")} incomplete`,
    cut.map(({ near, number, answer }) => `${near ? "question" : "step"} ${number}: ${INCOMPLETE[answer.incomplete] || refusalText(answer)}`).slice(0, 10).join("; "), "warn"]
    : possible > 0 ? [`complete, ${count(possible)} not proved`, "every answer is complete; so many contacts are only possible", "warn"]
      : [`✓ complete${isTimed ? ", all proved" : ""}`, `every answer is complete${isTimed ? ", and no contact is only possible" : ""}`, "good"];
}

/** How the answers compare with those that were recorded: arguments of chips. */
function comparisons(all, isOfFiles) {
  const of = (value) => all.filter(({ recorded }) => recorded === value);
  const [same, other, cut] = ["same", "other", "incomplete"].map(of);
  const every = plural(all.length, "answer", "answers");
  const reasons = new Set(cut.map((step) => INCOMPLETE[step.recorded_incomplete]));
  return [
    ...(other.length > 0 ? [[plural(other.length, "answer differs", "answers differ"),
      isOfFiles ? "when it is computed again" : "from those that were recorded", "bad"]] : []),
    ...(cut.length > 0 ? [[`${count(cut.length)} of ${every} ${cut.length === 1 ? "was" : "were"} incomplete when recorded`,
      `${[...reasons].join(", ")}: the page shows them computed to their end, which the program was not told`, "warn"]] : []),
    ...(other.length > 0 || isOfFiles ? []
      : same.length === all.length ? [["✓ answers as recorded", "every hash is the recorded one", "good"]]
        : same.length > 0 ? [[`${count(same.length)} of ${every} as recorded`, "of the others nothing recorded can be compared", ""]]
          : [["not compared", "the recording holds no answers to compare with", "warn"]]),
  ];
}

/** "1 to 149", "150": what lies between two numbers, both left out; []: nothing does. */
const gapBetween = (before, behind) => (behind - before < 2 ? [] : [behind - before === 2 ? `${before + 1}` : `${before + 1} to ${behind - 1}`]);

export function makeHead(data, show) {
  const { meta, all } = data;
  const { recording, steps } = meta;
  const absent = [...gapBetween(0, all[0].number), ...gapBetween(all.at(-1).number, recording.steps + 1)];
  const crossed = all.filter(({ near, answer }) => !near && answer.crossings > 0);
  const intersecting = element("button", { className: "chip warn", title: `Go to step ${crossed[0]?.number}` },
    `${all.length === 1 ? "" : crossed.length < 2 ? `step ${crossed[0]?.number} ` : `${count(crossed.length)} steps begin with intersections; step ${crossed[0].number} `}begins with ${plural(crossed[0]?.answer.crossings, "pair that intersects", "pairs that intersect")}`);
  intersecting.addEventListener("click", () => show(crossed[0]));
  const when = new Date(recording.unix_ms);
  const name = meta.is_of_files ? recording.name.replace(/%\d*[du]/g, "…") : recording.name; // of a pattern
  document.title = `${name} · pccd inspect`;
  byId("name").textContent = name;
  const chips = [
    chip(`${count(steps.length)} of ${plural(recording.steps, ...entryNoun(data))} drawn${absent.length > 0 ? `, ${absent.join(" and ")} not in the page` : ""}`,
      meta.is_full ? `The page was full: nothing is known here of what comes after step ${all.at(-1).number}. See --every, --steps and --max-size`
        : meta.every > 1 ? `One in ${meta.every} is drawn, as --every or --max-size ask; bars, the first and the most are of all ${count(all.length)} that were played`
          : "in this page, and recorded",
      meta.is_full || absent.length > 0 ? "warn" : ""),
    chip(Number.isNaN(when.getTime()) ? "?" : when.toISOString().replace("T", " ").slice(0, 16), meta.is_of_files ? "computed from the files, UTC" : "recorded, UTC"),
    chip(`libpccd ${recording.library}`, "that recorded"),
    chip(recording.cpu || "?", "instruction set of the daemon that answered then"),
    ...(recording.is_whole ? [] : [chip("cut short", "the recording has no end", "warn")]),
    ...(meta.is_rounded ? [chip("16-bit positions", "written with --round")] : []),
    ...(meta.asked.length > 0 ? [chip(`asked about: ${askedText(meta)}`, "Pairs that these options leave out may meet", "warn")] : []),
    ...(crossed.length > 0 ? [intersecting] : []),
    chip(...completeness(all)),
    ...comparisons(all, meta.is_of_files).map((texts) => chip(...texts)),
  ];
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

/** Whether the recorded answer was complete, and this one, unless a chip says it of `all`. */
function doneFacts({ answer, near, recorded, recorded_incomplete: reason }, all) {
  const isTold = all.every((one) => isComplete(one.answer) && one.answer.possible === 0 && one.recorded !== "incomplete");
  const isTimed = !near && answer.mode !== "pairs";
  return [
    ...(recorded === "incomplete" ? [plainFact("as recorded", "incomplete", `${INCOMPLETE[reason]}; the page shows the answer computed to its end`)] : []),
    ...(!isTold && isComplete(answer) && answer.possible === 0 ? [plainFact("answer", `complete${isTimed && answer.verdict !== 1 ? ", all proved" : ""}`)] : []),
  ];
}

/** What is worth a line of a step's answer, beside its sentence. */
function stepFacts({ answer, turns }, pair) {
  const isTimed = !["pairs", "any"].includes(answer.mode);
  return [
    ...(isTimed ? [plainFact(`safe step${pair === "" ? "" : " of all pairs"}`, digits(answer.safe_step), answer.safe_step > 0 ? "before this t no contact begins"
      : answer.crossings > 0 ? "things already intersect at the start, so no part of this step is safe" : answer.toi_first === 0 ? "the first contact is at the start" : "it is not known")] : []),
    ...(turns ? [plainFact("turning bodies", "on arcs", "drawn on the way that they turn, with their contacts; boxes of hierarchies go straight; recordings have no values of joints")] : []),
    ...(answer.initial > 0 ? [fact("touching at 0", count(answer.initial), "contacts of features that touch at t = 0, or are within their distance")] : []),
    ...(answer.possible > 0 ? [fact("possible", count(answer.possible), "not proved")] : []),
  ];
}

/** What the step was answered: for everybody, and, folded, for those who look at the engine. */
export function makeAnswer(data, state) {
  state.on(["index", "pair"], ({ index, pair }) => {
    const step = data.step(index);
    const { answer } = step;
    const [before, total, behind] = sentenceOf(step, data, pair, true);
    byId("sentence").replaceChildren(before,
      element("b", { id: "total" }, typeof total === "number" ? count(total) : total), behind);
    byId("sentence").title = sentenceOf(step, data, pair, false).join("");
    byId("records-head").textContent = headOf(step);
    byId("facts").replaceChildren(...(isRefused(step) ? [] : step.near ? nearFacts(step) : stepFacts(step, pair)), ...thickFacts(step), ...doneFacts(step, data.all));
    byId("engine-facts").replaceChildren(
      ...(step.near ? [] : [fact("mode", answer.mode)]),
      fact("method", `${answer.method}, ${answer.threads} thread${answer.threads === 1 ? "" : "s"}`),
      fact("times", "when this page was written", "of the repeat by that daemon, not of the program that asked first"),
      fact("step", duration(answer.times.step)),
      fact("queue", duration(answer.times.queue), "from arrival to the compute thread"),
    );
    const hash = byId("hash");
    hash.textContent = answer.hash;
    const known = data.meta.is_of_files ? "hash of the first time" : "recorded hash";
    hash.title = { same: `the ${known}`, other: `not the ${known}`, incomplete: "the recorded answer was incomplete", none: "nothing to compare with" }[step.recorded];
    hash.className = { same: "good", other: "bad", incomplete: "", none: "" }[step.recorded];
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

/** What is worth knowing of all steps that were played, or of the pair that is chosen in them, in a
 * sentence whose steps one can go to. */
export function makeWhole(data, state, show) {
  const { meta, all } = data;
  const names = namesOf(data);
  const steps = all.filter(({ near, answer }) => !near && answer.mode !== "pairs");
  const meets = ({ answer }) => (answer.mode === "any" ? answer.verdict > 0 : answer.total > 0);
  const meeting = steps.filter(meets);
  const crossed = steps.filter(({ answer }) => answer.crossings > 0);
  const greatest = (among, measure) => among.reduce((most, step) => (measure(step.answer) > measure(most.answer) ? step : most));
  const go = (step) => {
    const button = element("button", { title: `Go to step ${step.number}` }, `step ${step.number}`);
    button.addEventListener("click", () => show(step));
    return button;
  };
  byId("whole").hidden = steps.length < 2;
  if (steps.length < 2) {
    return;
  }
  const most = greatest(steps, ({ total }) => total);
  const slowest = greatest(steps.slice(1), ({ times }) => times.step);
  const told = [...(partText(data) ? [partText(data)] : []), ...(entryNoun(data)[0] === "entry" ? [plural(all.filter(({ near }) => near).length, "entry is a question", "entries are questions")] : [])];
  const part = told.length > 0 ? ` (${told.join("; ")})` : "";
  const first = partText(data) ? "; of these first in " : "; first in ";
  const unknown = steps.filter(({ answer }) => answer.status !== "OK").length;
  const whole = () => [
    `In ${count(meeting.length)} of ${count(steps.length)} steps${part} something${meta.asked.length > 0 ? " that was asked about" : ""} meets${rangesText(steps, meets)}`,
    ...(unknown > 0 ? [`; ${plural(unknown, "step was", "steps were")} not answered`] : []),
    ...(meeting.length > 0 ? [first, go(meeting[0])] : []),
    ...(most.answer.total > 0 ? [", most in ", go(most), ` (${count(most.answer.total)})`] : []),
    ...(crossed.length > 0 ? [`; ${plural(crossed.length, "step begins", "steps begin")} with an intersection, the first is `, go(crossed[0])] : []),
    ...(steps.length > 2 ? ["; when this page was written, the slowest after the first was ", go(slowest), ` (${duration(slowest.answer.times.step).replace(" ", "\u00a0")})`] : []),
  ];
  const ofPair = (pair) => {
    const counts = countsOf(data, pair);
    const has = steps.filter((step) => counts.get(step) > 0);
    const best = has.reduce((most, step) => (counts.get(step) > counts.get(most) ? step : most), has[0]);
    return [meetingText(data, names, pair, steps, part), ...(has.length > 0 ? [first, go(has[0])] : []),
      ...(has.some((step) => counts.get(step) < counts.get(best)) ? [", most in ", go(best), ` (${count(counts.get(best))})`] : [])];
  };
  state.on(["pair"], ({ pair }) => byId("whole").replaceChildren(...(pair === "" ? whole() : ofPair(pair))));
}

/** What is said in the place of a step that was asked for and is not drawn. */
export function makeAbsent(data, state) {
  state.on(["chosen", "find", "kinds", "order", "pair", "range"], () => state.set({ absent: null })); // one went on
  state.on(["absent"], ({ absent }) => {
    byId("absent").hidden = absent === null;
    if (absent !== null) {
      const [text, command] = absentTexts(data, absent);
      byId("absent").replaceChildren(`${text} `, ...(command ? [element("code", {}, command)] : []));
    }
  });
}

const FLOAT_PART = 2 ** -22; // of the size of a scene: what is less is the rounding of its floats
const ROUND_PART = 2 ** -16; // the same of positions in 16 bits

/** Where record `i` is, in the recording's own coordinates: at most so many digits of each, and none
 * that the page's positions do not have. */
function placeOf(step, i, { origin, unit, is_rounded: isRounded }, most) {
  step.size ??= step.objects.reduce((greatest, { x1 }) => x1.reduce((its, x) => Math.max(its, Math.abs(x)), greatest), 0);
  const least = Math.ceil(Math.log10((isRounded ? ROUND_PART : FLOAT_PART) * step.size * unit));
  return contactAt(step, i, step.near ? 0 : step.contacts.toi[i]).map((at, k) => {
    const x = at * unit + origin[k];
    const known = Math.min(most, Math.floor(Math.log10(Math.abs(x))) - least + 1);
    return known > 0 ? Number(x.toPrecision(known)) : 0;
  });
}

/** "(0.1, 0.2, 0.3)" */
const pointText = (x) => `(${x.map(digits).join(", ")})`;

/** Of a 32767th. */
const normalOf = ({ contacts }, i) => [0, 1, 2].map((k) => Number(contacts.normal[3 * i + k].toFixed(4)));

/** Which way the normal points: "points from ball to cloth". */
function wayText(step, i) {
  const [a, b] = ["a", "b"].map((side) => sideOf(step, i, side).object);
  return a === b ? "points from the second to the first" : `points from ${step.objects[b].name} to ${step.objects[a].name}`;
}

/** What is known of a record: [name, text]. */
function recordFacts(step, i, meta) {
  const normal = normalOf(step, i);
  const apart = apartOf(step, i) * meta.unit;
  const measure = measureOf(step);
  const flag = flagText(step, i);
  return [
    ...(isOfBounds(step) ? [["vertex", featureText(step, i, "a")]]
      : [["kind", KINDS[step.contacts.kind[i]].name], ["first", featureText(step, i, "a")], ["second", featureText(step, i, "b")]]),
    ...(measure?.name === "time" ? [["time", `t = ${digits(measure.of(i))}`]] : []),
    ...(measure ? [["place", pointText(placeOf(step, i, meta, 4))]] : []),
    ...(normal.some((x) => x !== 0) ? [["normal", `${pointText(normal)}, ${wayText(step, i)}`]] : []),
    ...(measure && (step.near || apart > 0) ? [[isOfBounds(step) ? "bound" : "distance", digits(step.near ? measure.of(i) : apart)]] : []),
    ...(flag ? [["begins", flag.title]] : []),
    ["number", `${nounOf(step)[0] === "contact" ? "contact" : "record"} ${i + 1} of ${meta.recording.steps === 1 ? "the file" : `this ${step.near ? "question" : "step"}, in file order`}`],
    ...(measure?.name === "time" ? [["picture command", renderText(step, i, meta)]] : []),
  ];
}

/** A record as a line of JSON, by the names of check --json, with all digits that the page has. */
export function recordText(step, i, meta) {
  const { contacts, number, near } = step;
  const kind = KINDS[contacts.kind[i]];
  const side = (its) => {
    const { object, points, feature, vertices } = sideOf(step, i, its);
    return { object: step.objects[object].name, [FEATURES[points]]: points === 2 && vertices.length > 0 ? vertices : feature };
  };
  const measure = measureOf(step);
  const apart = apartOf(step, i) * meta.unit;
  const normal = normalOf(step, i);
  return JSON.stringify({
    file: meta.recording.name, [near ? "question" : "step"]: number, record: i + 1,
    ...(isOfBounds(step) ? side("a") : { kind: kind.id, ...(measure?.name === "time" ? { toi: contacts.toi[i] } : {}), a: side("a"), b: side("b") }),
    ...(measure ? { at: placeOf(step, i, meta, 17) } : {}),
    ...(normal.some((x) => x !== 0) ? { normal } : {}),
    ...(measure && (near || apart > 0) ? { [isOfBounds(step) ? "bound" : "distance"]: near ? measure.of(i) : apart } : {}),
  });
}

const inQuotes = (name) => (/[",\r\n]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);

/** Contacts as CSV, by the names of check --contacts; the page does not have toi_hi. */
export function contactsText(step, picked, meta) {
  const { contacts, objects, number } = step;
  const lines = picked.map((i) => {
    const sides = ["a", "b"].map((side) => sideOf(step, i, side));
    const vertices = sides.flatMap((side) => side.vertices);
    return [number, KINDS[contacts.kind[i]].id, ...[0, 1, 2, 3].map((k) => vertices[k] ?? ""), contacts.toi[i], contacts.flags[i] & PROVED ? 1 : 0,
      ...sides.map(({ object }) => inQuotes(objects[object].name)), ...placeOf(step, i, meta, 17)].join();
  });
  return ["step,kind,i0,i1,i2,i3,toi,proved,object_a,object_b,x,y,z", ...lines, ""].join("\n");
}

/** In which colour of style.css the view draws what a fact names; undefined: it does not. */
function drawnAs(step, i, name) {
  return { first: "feature-a", second: "feature-b", [apartOf(step, i) > 0 ? "distance" : "normal"]: "normal" }[name];
}

/** A point is drawn as the path that it takes. */
const isPath = (step, i, name) => !step.near && ((name === "first" && sideOf(step, i, "a").points === 1)
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
      const which = data.all.length === 1 ? "" : step.near ? " of this question"
        : earliestOf(data, "")?.index === index ? ` of ${partText(data) || "all steps"}` : " of this step";
      byId("detail-head").textContent = chosen === firstOf(step) ? `First ${noun}${which}` : `${noun[0].toUpperCase()}${noun.slice(1)}`;
      byId("detail-facts").replaceChildren(...recordFacts(step, chosen, data.meta).flatMap(([name, text]) => {
        const dot = element("i", { className: "dot square", title: "its colour in the view" });
        const drawn = drawnAs(step, chosen, name);
        dot.style.background = `var(--${drawn})`;
        return [element("dt", {}, name), element("dd", { title: text }, ...(drawn ? [dot] : []), text,
          ...(isPath(step, chosen, name) ? [element("span", { className: "quiet" }, ", the line shows its path")] : []))];
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
  const fold = byId("objects-fold");
  fold.addEventListener("toggle", () => fold.open && fold.scrollIntoView({ block: "nearest" }));
  state.on(["index", "hidden"], ({ index, hidden }) => {
    const { objects } = data.step(index);
    byId("object-count").textContent = `${count(objects.length)}${hidden.size > 0 ? `, ${count(hidden.size)} hidden; contacts stay in the view and in the list` : ""}`;
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
      return element("label", { className: "object" }, box, dot, element("span", { className: "name", title: object.name }, object.name), element("span", { className: "colour" }, nameOfColour(i)),
        element("span", {}, sizeText(object, data.meta.unit)));
    }));
  });
}
