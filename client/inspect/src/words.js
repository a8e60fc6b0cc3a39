// words.js - what the page says: numbers, features, objects, and what a step was answered.

import { FEATURES, INITIAL, INSIDE, KINDS, verticesOf } from "./data.js";
import { count, plural } from "./dom.js";

/** Why an answer is not complete, by enum pccd_incomplete; "": it is. */
export const INCOMPLETE = ["", "", "the deadline passed", "it was cancelled", "there are more than the daemon keeps",
  "some pairs of what turns are not known"];

/** Why there is no answer: "invalid argument (E_INVAL)". */
export const refusalText = ({ status, refusal }) => `${refusal} (${status})`;

/** A number, to four significant digits: 0.0283, 7.492e-6; below 1 to so many that it is not read as 1. */
export function digits(value) {
  let known = 4;
  while (value < 1 && Number(value.toPrecision(known)) === 1) {
    known++;
  }
  const rounded = Number(value.toPrecision(known));
  return rounded !== 0 && Math.abs(rounded) < 1e-3 ? rounded.toExponential() : String(rounded);
}

/** Whether the records are vertices with their bounds, and so have one feature each. */
export const isOfBounds = ({ near }) => near === "vertices";

/** Two objects of a step: "cloth and ball", "cloth and itself". */
export const pairText = (step, a, b) => (isOfBounds(step) ? step.objects[a].name
  : `${step.objects[a].name} and ${a === b ? "itself" : step.objects[b].name}`);

/** One side of record `i`: {object, points, feature, vertices}; no vertices: there is no such
 * feature. */
export function sideOf({ contacts, objects }, i, side) {
  const object = side === "a" ? contacts.objectA[i] : contacts.objectB[i];
  const feature = side === "a" ? contacts.featureA[i] : contacts.featureB[i];
  const points = KINDS[contacts.kind[i]].points[side === "a" ? 0 : 1];
  return { object, points, feature, vertices: verticesOf(objects[object], points, feature) };
}

/** "vertex 3 of cloth", "edge 4-7 of ball": an edge by its vertices, which files name. */
export function featureText(step, i, side) {
  const { object, points, feature, vertices } = sideOf(step, i, side);
  const number = points === 2 && vertices.length > 0 ? vertices.join("-") : feature;
  return `${FEATURES[points]} ${number}${step.objects.length > 1 ? ` of ${step.objects[object].name}` : ""}`;
}

/** How the features of a contact begin: {text, title}, or null where it is as ever. */
export function flagText({ contacts }, i) {
  return contacts.flags[i] & INITIAL ? { text: "at 0", title: "touching or within their distance at t = 0" }
    : contacts.flags[i] & INSIDE ? { text: "in", title: "within their distance at t = 0, and approaching" } : null;
}

/** How a step's records are measured: {name, of(i)}; null: candidate pairs have no measure. */
export function measureOf({ contacts, near, answer }) {
  return near ? { name: near === "vertices" ? "bound" : "distance", of: (i) => contacts.distance[i] }
    : answer.mode === "pairs" ? null : { name: "time", of: (i) => contacts.toi[i] };
}

/** Each two objects that records name, with how many: [{pair, a, b, count}], most first; `pair` as of
 * pairs.js. */
export function pairsOf({ contacts, objects }) {
  const pairs = new Map();
  for (let i = 0; i < contacts.count; i++) {
    const [a, b] = [contacts.objectA[i], contacts.objectB[i]].sort((one, other) => objects[one].number - objects[other].number);
    const key = a * objects.length + b;
    const pair = pairs.get(key) ?? { pair: `${objects[a].number},${objects[b].number}`, key, a, b, count: 0 };
    pair.count++;
    pairs.set(key, pair);
  }
  return [...pairs.values()].sort((one, other) => other.count - one.count || one.key - other.key);
}

const NAME_MAX = 32; // letters of an object's name in a sentence that is to be short
const PAIRS_NAMED = 3; // in a sentence; of more it says how many there are

/** With its middle left out, if it is long. */
export const shortName = (name) => (name.length > NAME_MAX
  ? `${name.slice(0, NAME_MAX / 2)}…${name.slice(1 - NAME_MAX / 2)}` : name);

/** " between cloth and ball", of all records of a step; "" where there is one object. `isShort`: long
 * names are cut in their middle. */
function whereText(whole, isShort) {
  const step = isShort ? { ...whole, objects: whole.objects.map(({ name, number }) => ({ name: shortName(name), number })) } : whole;
  const pairs = pairsOf(step);
  return step.objects.length < 2 || pairs.length === 0 ? ""
    : pairs.length <= PAIRS_NAMED ? ` between ${pairs.map(({ a, b }) => pairText(step, a, b)).join(", and between ")}`
      : ` between ${plural(pairs.length, "pair", "pairs")} of objects`;
}

/** What a step was told of its start, before anything moves; "": nothing intersects there. */
function startText({ answer, tells_start: isTold }, hasNone, isOfSome) {
  const { crossings, start_inside: inside } = answer;
  return !isTold ? (hasNone ? " during the step; what already intersects at its start was not asked with it" : "")
    : crossings > 0 ? `, but ${plural(crossings, "pair", "pairs")} of features already ${crossings === 1 ? "intersects" : "intersect"} at the start`
      : inside > 0 ? `, but ${plural(inside, "pair", "pairs")} of features ${inside === 1 ? "is" : "are"} already within their distance at the start`
        : hasNone ? `: nothing${isOfSome ? " that was asked about" : ""} meets` : "";
}

/** What a question about what is near asked for: its records as [one, many]. */
function nearNoun({ near, asked }) {
  const within = asked.distance === null ? "" : asked.distance === 0 ? " that touch" : ` within ${digits(asked.distance)}`;
  return {
    pairs: [`pair of features${within}`, `pairs of features${within}`],
    features: [`closest feature${within}`, `closest features${within}`],
    vertices: ["vertex with its bound", "vertices with their bounds"],
    nearest: ["nearest pair of features", "nearest pairs of features"],
    crossings: ["edge that passes through a face", "edges that pass through faces"],
    depth: ["vertex inside another object", "vertices inside other objects"],
  }[near] ?? ["record", "records"];
}

/** What stands over the list of a step's records. */
export const headOf = ({ near, answer }) => (!near ? (answer.mode === "pairs" ? "Pairs that may meet" : "Contacts") : {
  pairs: "Pairs of features", features: "Closest features", vertices: "Vertices", nearest: "Nearest pairs",
  crossings: "Edges through faces", depth: "Vertices inside",
}[near] ?? "Records");

/** The record with the least time, or distance, of those that `is` tells; -1: none has one. */
export function firstOf(step, is = () => true) {
  const { toi } = step.contacts;
  return measureOf(step) === null ? -1
    : toi.reduce((first, its, i) => ((first < 0 || its < toi[first]) && is(i) ? i : first), -1);
}

const quoted = (word) => (/^[\w./,-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

/** Which pairs were asked about, as options of a command; "": all. */
export const askedText = ({ asked }) => asked.map(quoted).join(" ");

/** The file of a page in a command, with what was asked of it: else contacts have other numbers.
 * Of files that were given, only one that is a whole scene is known by its name. */
const isOneScene = (name) => /\.(json|gltf|glb)$/.test(name) && !name.includes(" to ");
const fileText = ({ recording: { name }, ...meta }) => [meta.is_of_files && !isOneScene(name) ? "FILES" : quoted(name), ...meta.asked.map(quoted)].join(" ");

/** The command that draws a record of a step. */
export const renderText = ({ number }, i, meta) =>
  `pccdctl render ${fileText(meta)} --steps ${number} --at 'contact ${i + 1}'`;

/** What is known of a step that cannot be gone to, and the command that makes a page of it; no
 * command: there is no such step. */
export function absentTexts({ meta, all }, number) {
  const step = all.find((one) => one.number === number);
  if (!step) {
    return [`This page knows no step ${number}: its steps are ${all[0].number} to ${all.at(-1).number}.`, ""];
  }
  const { near, answer: { mode, total, verdict, toi_first: first }, first_pair: pair } = step;
  const found = near ? plural(total, "record", "records") : mode === "any" ? ["nothing meets", "something may meet", "something meets", "what meets is not known"][verdict]
    : mode === "pairs" ? plural(total, "pair that may meet", "pairs that may meet")
      : `${plural(total, "contact", "contacts")}${first === null ? "" : `, the first at t = ${digits(first)}${pair ? `: ${pair}` : ""}`}`;
  return [`The drawing of ${near ? "question" : "step"} ${number} was left out: the page has one step in ${meta.every}. Known of it: ${found}. `
    + "This writes a page with it:", `pccdctl inspect ${fileText(meta)} --steps ${number} -o step-${number}.html`];
}

/** What the steps of a page are called, [one, many]: entries where some are questions. */
export const entryNoun = ({ all }) => (all.every(({ near }) => near) ? ["question", "questions"]
  : all.some(({ near }) => near) ? ["entry", "entries"] : ["step", "steps"]);

/** "steps 150 to 190", where more were recorded than the page was asked for; "". */
export const partText = ({ meta, all }) => (all[0].number === 1 && all.at(-1).number >= meta.recording.steps ? ""
  : `${entryNoun({ all })[1]} ${all[0].number} to ${all.at(-1).number}`);

/** What the records of a step are called: [one, many]. */
export const nounOf = (step) => (step.near ? nearNoun(step)
  : step.answer.mode === "pairs" ? ["pair of features that may meet", "pairs of features that may meet"]
    : ["contact", "contacts"]);

/** "Step 3 of 5", "Step 160 (of 150 to 190; 290 recorded)", "Entry 2 of 56, a question". */
function numberText({ near, number }, data) {
  const [noun] = entryNoun(data);
  const of = partText(data) && data.all.length > 1 ? ` (of ${count(data.all[0].number)} to ${count(data.all.at(-1).number)}; ${count(data.meta.recording.steps)} recorded)` : ` of ${count(data.meta.recording.steps)}`;
  return `${noun[0].toUpperCase()}${noun.slice(1)} ${count(number)}${of}${noun === "entry" ? `, a ${near ? "question" : "step"}` : ""}`;
}

/** The sentence that says what is looked at, in parts: [before, count, behind]; `pair`: that is chosen,
 * which it is not of; `isShort` as of whereText. */
export function sentenceOf(step, data, pair, isShort) {
  const { answer, near } = step;
  const scenes = [...new Set(data.meta.steps.map((its) => its.scene))];
  const isOfSome = data.meta.asked.length > 0;
  const scene = scenes.length > 1 ? `, scene ${count(scenes.indexOf(step.scene) + 1)} of ${count(scenes.length)}` : "";
  const before = `${numberText(step, data)}${scene}${pair === "" ? "" : ", all pairs"}: `;
  const cut = INCOMPLETE[answer.incomplete] ? `; ${INCOMPLETE[answer.incomplete]}` : "";
  if (answer.status !== "OK") {
    return [before, "", `it was not answered: ${refusalText(answer)}`];
  }
  if (!near && answer.mode === "any") {
    return [before, "", `it was asked whether anything meets: ${["nothing does", "something may", "something does", "that is not known"][answer.verdict]}${startText(step, answer.verdict === 0)}${cut}`];
  }
  const [one, many] = nounOf(step);
  const asked = { first: ", the earliest; later ones were not asked for", "first-per-pair": "; of each two objects only their first was asked for" }[answer.mode] ?? "";
  const first = near && answer.distance_min !== null ? `; the least distance is ${digits(answer.distance_min)}`
    : !near && answer.toi_first !== null ? `${answer.mode === "first" ? "" : ", the first"} at t\u00a0=\u00a0${digits(answer.toi_first)}` : "";
  const none = isOfBounds(step) ? `; ${count(step.contacts.count)} ${step.contacts.count === 1 ? "has" : "have"} something within ${digits(step.asked.distance)}`
    : !near ? startText(step, answer.total === 0 && !cut, isOfSome) : "";
  return [before, answer.total, ` ${answer.total === 1 ? one : many}${isOfBounds(step) ? "" : whereText(step, isShort)}${first}${answer.total > 0 ? asked : ""}${none}${cut}`];
}
