// find.js - which records are listed: by their objects, and by what was typed.

import { FEATURES, KINDS } from "./data.js";
import { nameOfColour } from "./colours.js";
import { plural } from "./dom.js";
import { isOfPair } from "./pairs.js";
import { sideOf } from "./words.js";

/** How many points a feature of that name has: "edge", "e"; -1: it is none. */
const pointsOf = (word) => FEATURES.findIndex((name) => name !== "" && (name === word || name[0] === word));

const BETWEEN = ["meets", "hits", "and", "with"]; // two features, as the page and people say them

/** Whether a side is the feature that was typed: by its number, or of an edge by its vertices. */
function isFeature(side, points, numbers) {
  return (points === 0 || side.points === points) && (points === 0 || points === 2
    ? numbers.every((number) => side.vertices.includes(number)) : numbers.length === 0 || side.feature === numbers[0]);
}

/** What was typed, as tests of a record's side, or of its time; all must hold. "vertex 3" or "v3",
 * "face 12", "edge 4-7" (its vertices), "12" (any feature with that vertex), each also with the
 * object that it is of: "vertex 3 of cloth"; "vf"; "t<0.5"; a part of an object's name, or its colour. A
 * vertex, unless it is said what it meets, stands for its edges and faces, too, and `own` tests for
 * itself; null: none does.
 * `unknown`: the words that are none of these; `missing`: of a number that no feature has, how many
 * there are. */
export function readWords(text, objects) {
  const tests = [];
  const unknown = [];
  let missing = "";
  const ofObject = (name) => {
    const named = objects.map((object, i) => object.name.toLowerCase().includes(name) || nameOfColour(i) === name);
    return named.includes(true) ? ({ object }) => named[object] : null;
  };
  const words = text.toLowerCase().replace(/t\s*([<>])\s*(?=[\d.])/g, "t$1").replace(/(\d)[-–](?=\d)/g, "$1 ")
    .replace(/#(?=\d)/g, "").replace(/\b([a-z]+)(\d+)\b/g, (whole, name, number) => (pointsOf(name) > 0 && !ofObject(whole) ? `${name} ${number}` : whole))
    .split(/[\s,;]+/).filter(Boolean);
  const isNumber = (word) => /^\d+$/.test(word ?? "");
  /** The object that a feature is of: the words up to the next feature. */
  const takeObject = () => {
    if (words[0] === "of") {
      const end = words.findIndex((word, i) => i > 1 && BETWEEN.includes(word));
      const name = words.splice(0, end < 0 ? words.length : end).slice(1).join(" ");
      const is = ofObject(name);
      if (!is) {
        unknown.push(name);
      }
      return is;
    }
    const is = words.length > 0 && pointsOf(words[0]) <= 0 && !isNumber(words[0]) ? ofObject(words[0]) : null;
    if (is) {
      words.shift();
    }
    return is;
  };
  while (words.length > 0) {
    const word = words.shift();
    const time = /^t([<>])(\d*\.?\d+)$/.exec(word);
    const points = pointsOf(word);
    const kind = KINDS.findIndex(({ id }) => id === word);
    if (kind >= 0) {
      tests.push({ kind });
    } else if (time) {
      tests.push({ time: (toi) => (time[1] === "<" ? toi < Number(time[2]) : toi > Number(time[2])) });
    } else if (points > 0 || isNumber(word)) {
      const numbers = points > 0 ? [] : [Number(word)];
      while (points > 0 && numbers.length < (points === 2 ? 2 : 1) && isNumber(words[0])) {
        numbers.push(Number(words.shift()));
      }
      const isOf = takeObject();
      const among = objects.filter((_, object) => !isOf || isOf({ object }));
      const most = Math.max(...among.map(({ mesh }) => (points === 3 ? mesh.triangles.length / 3 : mesh.vertexCount)));
      if (numbers.some((number) => number >= most)) {
        missing = `${among.length === 1 ? `${among[0].name} has` : "none has more than"} ${plural(most, ...(points === 3 ? ["face", "faces"] : ["vertex", "vertices"]))}`;
      }
      if (points === 2 && numbers.length === 2 && missing === "" && !among.some(({ mesh: { edges } }) => edges.some((vertex, at) =>
        at % 2 === 0 && numbers.includes(vertex) && numbers.includes(edges[at + 1])))) {
        missing = `${among.length === 1 ? `${among[0].name} has` : "no object has"} ${among.length === 1 ? "no" : "an"} edge ${numbers.join("-")}`;
      }
      const testOf = (wanted) => (side) => isFeature(side, wanted, numbers) && (!isOf || isOf(side));
      tests.push({ side: testOf(Math.max(points, 0)), wide: points === 1 && numbers.length > 0 ? testOf(0) : null, isFeature: true });
    } else if (!BETWEEN.includes(word)) {
      const isOf = ofObject(word);
      if (isOf) {
        tests.push({ side: isOf });
      } else {
        unknown.push(word);
      }
    }
  }
  const [one, other] = tests.filter((test) => test.isFeature);
  const own = one?.wide && !other ? one.side : null;
  return { tests: tests.map((test) => (test === one && own ? { side: one.wide } : test)), unknown, missing, own };
}

/** Places of the records that pass what was typed and the pair, in the order that is asked for.
 * `pair`: as of pairs.js. None passes where a word was not understood. */
export function findContacts(step, { order, find, pair }) {
  const { contacts } = step;
  const { tests, unknown } = readWords(find, step.objects);
  const isWanted = isOfPair(step, pair);
  const found = [];
  if (unknown.length > 0) {
    return found;
  }
  for (let i = 0; i < contacts.count; i++) {
    const toi = contacts.toi[i];
    if (isWanted(i)) {
      const sides = tests.length > 0 ? ["a", "b"].map((side) => sideOf(step, i, side)) : [];
      if (tests.every(({ kind, time, side }) => (kind >= 0 ? contacts.kind[i] === kind : time ? time(toi) : sides.some(side)))) {
        found.push(i);
      }
    }
  }
  return order === "toi" ? found.sort((a, b) => contacts.toi[a] - contacts.toi[b] || a - b) : found;
}
