// counters.js - the counters of a step, each with its course over all steps.

import { byId, count, element } from "./dom.js";

const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 84;
const HEIGHT = 18;

const TEXTS = {
  task_units: "self-CD task units processed",
  box_tests: "pairs of nodes tested",
  leaf_pairs: "pairs of leaves that overlap",
  candidates_vf: "vertex-face pairs after box tests",
  candidates_ee: "edge-edge pairs after box tests",
  candidates_ve: "vertex-edge pairs after box tests",
  candidates_vv: "vertex-vertex pairs after box tests",
  survivors: "pairs that the filter could not reject",
  exact: "queries that went to exact arithmetic",
  builds: "hierarchies built during the step",
  allocs: "allocations the engine made",
  rebuilds: "subtrees built anew in the traversal",
  rebuilt_triangles: "triangles of these",
  swaps: "large subtrees, built in the background, put in place",
  swapped_triangles: "triangles of these",
  still_features: "features that stand still, whose boxes were kept",
  still_pairs: "pairs of nodes or features left out: neither moves",
  kept_records: "records of what stands still, from the last answer",
  rigid_objects: "rigid objects that were not tested against themselves",
  thick_candidates: "pairs that meet at a distance above 0",
  thick_survivors: "of these, asked one by one",
  thick_exact: "of these, by exact arithmetic",
};

function course(values) {
  const svg = document.createElementNS(SVG, "svg");
  const line = document.createElementNS(SVG, "polyline");
  const mark = document.createElementNS(SVG, "circle");
  const highest = Math.max(1, ...values);
  const at = values.map((value, i) => [
    2 + (values.length > 1 ? (i / (values.length - 1)) * (WIDTH - 4) : (WIDTH - 4) / 2),
    HEIGHT - 3 - (value / highest) * (HEIGHT - 6)]);
  svg.setAttribute("width", WIDTH);
  svg.setAttribute("height", HEIGHT);
  svg.setAttribute("aria-hidden", "true");
  line.setAttribute("points", at.map((point) => point.map((x) => x.toFixed(1)).join()).join(" "));
  mark.setAttribute("r", 2);
  svg.append(line, mark);
  return {
    svg,
    show(index) {
      mark.setAttribute("cx", at[index][0].toFixed(1));
      mark.setAttribute("cy", at[index][1].toFixed(1));
    },
  };
}

export function makeCounters(data, state) {
  const { steps } = data.meta;
  const rows = Object.keys(steps[0].answer.counters).map((name) => {
    const values = steps.map(({ answer }) => answer.counters[name]);
    const { svg, show } = course(values);
    const number = element("td", { className: "number" });
    const row = element("tr", { title: TEXTS[name] ?? "" },
      element("th", { scope: "row" }, name.replaceAll("_", " ")), element("td", {}, ...(steps.length > 1 ? [svg] : [])), number);
    return { row, values, number, show };
  });
  byId("counters").replaceChildren(...rows.map(({ row }) => row));
  state.on(["index"], ({ index }) => {
    for (const { row, values, number, show } of rows) {
      number.textContent = count(values[index]);
      row.classList.toggle("zero", values[index] === 0);
      show(index);
    }
  });
}
