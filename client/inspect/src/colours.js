// colours.js - colours of times, objects and phases.

// "plasma" of matplotlib (CC0), as pccdctl render has it, but without the end that cannot be seen
// before the page: in the dark the early blue is lighter, in the light the late yellow is darker.
const STOPS = {
  dark: [
    [0.45, 0.47, 1.00], [0.66, 0.42, 0.97], [0.83, 0.40, 0.82], [0.93, 0.45, 0.62],
    [0.98, 0.57, 0.42], [0.99, 0.77, 0.27], [0.94, 0.98, 0.30],
  ],
  light: [
    [0.05, 0.03, 0.53], [0.29, 0.01, 0.63], [0.49, 0.01, 0.66], [0.66, 0.13, 0.59],
    [0.78, 0.25, 0.46], [0.84, 0.31, 0.26], [0.74, 0.40, 0.02],
  ],
};
let stops = STOPS.dark;

/** Choose the scale of times: "dark" or "light". */
export function setTheme(theme) {
  stops = STOPS[theme];
}

/** Red, green, blue, 0 .. 1, of a time of impact. */
export function colourOfTime(toi) {
  const at = Math.min(Math.max(toi, 0), 1) * (stops.length - 1);
  const below = Math.min(Math.floor(at), stops.length - 2);
  return stops[below].map((low, k) => low + (at - below) * (stops[below + 1][k] - low));
}

export const cssOf = (rgb) => `rgb(${rgb.map((part) => Math.round(255 * part)).join(" ")})`;

/** For style: "linear-gradient(...)" of the whole scale. */
export const scaleGradient = () =>
  `linear-gradient(90deg, ${stops.map((stop) => cssOf(stop)).join(", ")})`;

// By their places; people search for an object by the name of its colour.
const OBJECTS = {
  blue: [0.36, 0.55, 0.83], sand: [0.88, 0.74, 0.52], green: [0.45, 0.69, 0.49],
  violet: [0.73, 0.52, 0.75], grey: [0.60, 0.63, 0.68], brick: [0.83, 0.53, 0.42],
  teal: [0.12, 0.60, 0.62], rose: [0.97, 0.66, 0.76], olive: [0.56, 0.58, 0.16],
  brown: [0.56, 0.38, 0.24], red: [0.83, 0.27, 0.30], plum: [0.56, 0.36, 0.66],
};
const NAMES = Object.keys(OBJECTS);

export const nameOfColour = (index) => NAMES[index % NAMES.length];
export const colourOfObject = (index) => OBJECTS[nameOfColour(index)];

/** The phases of a step in their order; each has a colour in style.css. */
export const PHASES = ["ingest", "refit", "traversal", "tests", "merge"];

/** The style variable for an event of a thread, by EVENT_KINDS. */
export const EVENT_COLOURS = ["other", "refit", "traversal", "traversal", "traversal",
  "high", "tests", "rebuild", "rebuild", "wait", "merge"];
