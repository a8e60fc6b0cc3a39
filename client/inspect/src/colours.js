// colours.js - colours of times, objects and phases; the same scale as pccdctl render.

// "plasma" of matplotlib (CC0), at nine places, as in client/ctl/export/colour.c.
const STOPS = [
  [0.050, 0.030, 0.528], [0.294, 0.012, 0.631], [0.492, 0.012, 0.658],
  [0.658, 0.134, 0.588], [0.798, 0.280, 0.470], [0.899, 0.424, 0.360],
  [0.973, 0.585, 0.252], [0.994, 0.770, 0.165], [0.940, 0.975, 0.131],
];

/** Red, green, blue, 0 .. 1, of a time of impact. */
export function colourOfTime(toi) {
  const at = Math.min(Math.max(toi, 0), 1) * (STOPS.length - 1);
  const below = Math.min(Math.floor(at), STOPS.length - 2);
  return STOPS[below].map((low, k) => low + (at - below) * (STOPS[below + 1][k] - low));
}

export const cssOf = (rgb) => `rgb(${rgb.map((part) => Math.round(255 * part)).join(" ")})`;

/** For style: "linear-gradient(...)" of the whole scale. */
export const scaleGradient = () =>
  `linear-gradient(90deg, ${STOPS.map((stop) => cssOf(stop)).join(", ")})`;

const OBJECTS = [
  [0.36, 0.55, 0.83], [0.88, 0.74, 0.52], [0.45, 0.69, 0.49], [0.73, 0.52, 0.75],
  [0.60, 0.63, 0.68], [0.83, 0.53, 0.42],
];

export const colourOfObject = (index) => OBJECTS[index % OBJECTS.length];

/** The phases of a step in their order; each has a colour in style.css. */
export const PHASES = ["ingest", "refit", "traversal", "tests", "merge"];

/** The style variable for an event of a thread, by EVENT_KINDS. */
export const EVENT_COLOURS = ["other", "refit", "traversal", "traversal", "traversal",
  "high", "tests", "rebuild", "rebuild", "wait", "merge"];
