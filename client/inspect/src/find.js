// find.js - which records are listed: by kind, time, objects, and by what was typed.

import { FEATURES } from "./data.js";
import { nameOfColour } from "./colours.js";
import { sideOf } from "./words.js";

/** What was typed, as tests of a record's side, or of its whole; all must hold. Words: "vertex 3",
 * "face 12", "edge 4-7" (its vertices), "12" (any feature with that vertex), "t<0.5", and else a
 * part of an object's name, or its colour. */
export function readWords(text) {
  const tests = [];
  const words = text.toLowerCase().replace(/[-–,;]/g, " ").split(/\s+/).filter(Boolean);
  const isNumber = (word) => /^\d+$/.test(word ?? "");
  while (words.length > 0) {
    const word = words.shift();
    const time = /^t([<>])(\d*\.?\d+)$/.exec(word);
    const points = FEATURES.findIndex((name) => name !== "" && (name === word || (word.length === 1 && name[0] === word)));
    if (time) {
      tests.push({ time: (toi) => (time[1] === "<" ? toi < Number(time[2]) : toi > Number(time[2])) });
    } else if (points > 0 && isNumber(words[0])) {
      const numbers = [Number(words.shift())];
      if (points === 2 && isNumber(words[0])) {
        numbers.push(Number(words.shift()));
      }
      tests.push({ side: (side) => side.points === points && (points === 2
        ? numbers.every((number) => side.vertices.includes(number)) : side.feature === numbers[0]) });
    } else if (points > 0) {
      tests.push({ side: (side) => side.points === points });
    } else if (isNumber(word)) {
      tests.push({ side: (side) => side.vertices.includes(Number(word)) });
    } else {
      tests.push({ side: (side, { objects }) =>
        objects[side.object].name.toLowerCase().includes(word) || nameOfColour(side.object) === word });
    }
  }
  return tests;
}

/** Places of the records that pass, in the order that is asked for. `pair`: "" or the two objects. */
export function pickContacts(step, { kinds, range, order, find, pair }) {
  const { contacts } = step;
  const tests = readWords(find);
  const [one, other] = pair === "" ? [] : pair.split(",").map(Number);
  const picked = [];
  for (let i = 0; i < contacts.count; i++) {
    const toi = contacts.toi[i];
    const [a, b] = [contacts.objectA[i], contacts.objectB[i]];
    const isPair = pair === "" || (a === one && b === other) || (a === other && b === one);
    if (kinds[contacts.kind[i]] && toi >= range[0] && toi <= range[1] && isPair) {
      const sides = tests.length > 0 ? ["a", "b"].map((side) => sideOf(step, i, side)) : [];
      if (tests.every(({ time, side }) => (time ? time(toi) : sides.some((its) => side(its, step))))) {
        picked.push(i);
      }
    }
  }
  return order === "toi" ? picked.sort((a, b) => contacts.toi[a] - contacts.toi[b] || a - b) : picked;
}
