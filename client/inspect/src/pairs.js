// pairs.js - two objects that are chosen, by their numbers, "3,5", or none, "": how much of what was
// found is theirs, over all steps.

import { count, plural } from "./dom.js";
import { INCOMPLETE, isOfBounds } from "./words.js";

/** Whether record `i` of a step is of a pair. */
export function isOfPair({ contacts, objects }, pair) {
  const [one, other] = pair.split(",").map(Number);
  return (i) => {
    const [a, b] = [objects[contacts.objectA[i]].number, objects[contacts.objectB[i]].number];
    return pair === "" || (a === one && b === other) || (a === other && b === one);
  };
}

/** How many records of a step are of a pair; undefined: that is not known. */
function countOf({ near, answer, pairs }, pair) {
  if (pair === "") {
    return answer.total;
  }
  const [a, b] = pair.split(",").map(Number);
  for (let i = 0; i < (pairs?.length ?? 0); i += 3) {
    if (pairs[i] === a && pairs[i + 1] === b) {
      return pairs[i + 2];
    }
  }
  const { status, mode, verdict, total, incomplete } = answer;
  const isAll = near || (status === "OK" && !INCOMPLETE[incomplete] && !(mode === "any" && verdict > 0) && !(mode === "first" && total > 0));
  return pairs !== null && isAll ? 0 : undefined;
}

let last = { pair: null, counts: null };

/** The same of each of data.all, as a map. */
export function countsOf({ all }, pair) {
  if (last.pair !== pair) {
    last = { pair, counts: new Map(all.map((step) => [step, countOf(step, pair)])) };
  }
  return last.counts;
}

/** Whether the counts of pairs are known of all steps, so that a pair without one never meets. */
export const areCounted = ({ all }) => all.every((step) => countOf(step, "-1,-1") === 0);

/** Of two different objects of a step, up to `most` pairs without records in any step, which the set `known`
 * has, and how many there are: [pairs, count]; none where only some pairs were asked about. */
export function neverPairs({ meta: { asked } }, { objects }, known, most) {
  const never = [];
  const total = asked.length > 0 ? 0 : objects.length * (objects.length - 1) / 2;
  const numbers = objects.map(({ number }) => number).sort((a, b) => a - b);
  const here = new Set(numbers);
  for (let i = 0; i < numbers.length && total > 0 && never.length < most; i++) {
    for (let k = i + 1; k < numbers.length && never.length < most; k++) {
      const pair = `${numbers[i]},${numbers[k]}`;
      if (!known.has(pair)) {
        never.push(pair);
      }
    }
  }
  const met = [...known.keys()].filter((pair) => {
    const [a, b] = pair.split(",").map(Number);
    return a !== b && here.has(a) && here.has(b);
  }).length;
  return [never, Math.max(0, total - met)];
}

/** The first of data.all in which a pair meets, as far as that is known; undefined: none. */
export const earliestOf = (data, pair) =>
  data.all.find((step) => !step.near && step.answer.toi_first !== null && countsOf(data, pair).get(step) > 0);

/** Of all pairs that any step has records of, in how many steps. */
export function stepsOfPairs({ all }) {
  const found = new Map();
  for (const { pairs } of all) {
    for (let i = 0; i < (pairs?.length ?? 0); i += 3) {
      const pair = `${pairs[i]},${pairs[i + 1]}`;
      found.set(pair, (found.get(pair) ?? 0) + 1);
    }
  }
  return found;
}

/** Names of objects by their numbers, of those in the steps that are drawn. */
export function namesOf({ meta: { steps } }) {
  const names = new Map();
  for (const { objects } of steps) {
    objects.forEach(({ number, name }, place) => names.has(number) || names.set(number, name ?? `object ${place}`));
  }
  return names;
}

/** "cloth and ball", "cloth and itself"; of a step whose records have one object each, "cloth". */
export function pairName(names, pair, step) {
  const [a, b] = pair.split(",").map((number) => names.get(Number(number)) ?? `object number ${number}, which is not drawn`);
  return step && isOfBounds(step) ? a : `${a} and ${pair.split(",")[0] === pair.split(",")[1] ? "itself" : b}`;
}

const RANGES_LETTERS = 90; // of them all; of more only the ends are told

/** ", 3 to 41 and 50": the numbers of those of `steps` that `is` tells; "" of less than two. */
export function rangesText(steps, is) {
  const ranges = [];
  for (const step of steps.filter(is)) {
    if (ranges.at(-1)?.at(-1) === step.number - 1) {
      ranges.at(-1)[1] = step.number;
    } else {
      ranges.push([step.number]);
    }
  }
  const texts = ranges.map((range) => range.join(" to "));
  const text = `, ${[...(texts.length > 1 ? [texts.slice(0, -1).join(", ")] : []), texts.at(-1)].join(" and ")}`;
  return ranges.flat().length < 2 ? ""
    : text.length > RANGES_LETTERS ? `, from ${ranges[0][0]} to ${ranges.at(-1).at(-1)}, not in all between` : text;
}

/** In which of `steps`, `part` " (steps 150 to 190)" or "", a pair meets, as the begin of a sentence. */
export function meetingText(data, names, pair, steps, part) {
  const counts = countsOf(data, pair);
  const has = (step) => counts.get(step) > 0;
  const unknown = steps.filter((step) => counts.get(step) === undefined);
  const full = unknown.filter(({ pairs, answer }) => pairs === null && answer.mode !== "any");
  const who = pairName(names, pair);
  return `${who.endsWith(" and itself") ? who.replace(/ and itself$/, " meets itself") : `${who} meet`} in ${count(steps.filter(has).length)} of ${plural(steps.length, "step", "steps")}${part}`
    + `${rangesText(steps, has)}${unknown.length === 0 ? "" : `; ${plural(unknown.length, "step", "steps")}: not known`}`
    + `${full.length === 0 ? "" : `, as the page has no room to count the pairs of ${count(full.length)}: --max-size allows more`}`;
}
