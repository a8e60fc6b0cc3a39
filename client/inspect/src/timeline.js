// timeline.js - how many contacts each step has; with the engine's figures what each phase took, too.

import { PHASES } from "./colours.js";
import { byId, canvasText, colourOf, count, duration, hideTip, oncePerFrame, prepareCanvas, showTip } from "./dom.js";
import { countsOf, namesOf, pairName } from "./pairs.js";
import { entryNoun, shortName } from "./words.js";

const top = () => canvasText() + 5; // above the bars, for words
const BAR_MAX = 128;

/** A round number of nanoseconds below `ns`, for a line of the scale. */
function roundBelow(ns) {
  const power = 10 ** Math.floor(Math.log10(ns));
  return [5, 2, 1].find((digit) => digit * power <= ns) * power;
}

/** Nanoseconds of a step that no phase has. */
const restOf = ({ times }) =>
  Math.max(0, times.step - PHASES.reduce((sum, phase) => sum + times[phase], 0));

/** [name, nanoseconds] of the parts of a step in their order. */
export const partsOf = (answer) => (answer.times.refit === undefined ? [["other", answer.times.step]] // its drawing was left out
  : [...PHASES.map((phase) => [phase, answer.times[phase]]), ["other", restOf(answer)]]);

/** `show`: go to one of data.all. */
export function makeTimeline(data, state, show) {
  const canvas = byId("timeline");
  const steps = data.all;
  const highest = Math.max(1, ...steps.map(({ answer }) => answer.times.step));
  const found = steps.every(({ near, answer }) => !near && !["any", "pairs"].includes(answer.mode)) ? "contacts" : "all that was found";
  const names = new Map([...namesOf(data)].map(([number, name]) => [number, shortName(name)]));
  let hover = -1;

  const widthOf = (width) => Math.min(BAR_MAX, width / steps.length);
  const indexAt = (event) => {
    const box = canvas.getBoundingClientRect();
    const index = Math.floor((event.clientX - box.left) / widthOf(box.width));
    return Math.min(steps.length - 1, Math.max(0, index));
  };

  /** A line at a round time. */
  function drawScale(context, width, height, room) {
    const line = roundBelow(highest);
    const y = Math.round(height - (line / highest) * room);
    context.fillStyle = colourOf("line");
    context.fillRect(0, y, width, 1);
    context.fillStyle = colourOf("faint");
    context.fillText(duration(line), width - 4, y + 12);
  }

  const slider = byId("step");
  const THUMB = 16; // pixels that its handle is wide
  const draw = oncePerFrame(() => {
    const { context, width, height } = prepareCanvas(canvas);
    const room = height - top() - 2;
    const bar = widthOf(width);
    slider.style.marginLeft = `${(bar - THUMB) / 2}px`;
    slider.style.width = `${(steps.length - 1) * bar + THUMB}px`;
    const gap = bar > 4 ? Math.min(3, bar * 0.2) : 0;
    const { engine, pair } = state.values;
    const counts = countsOf(data, pair);
    const most = Math.max(1, ...[...counts.values()].filter(Boolean));
    const below = engine ? room / 2 : 0; // for the times, under what was found
    steps.forEach(({ answer }, i) => {
      const isShown = steps[i].index === state.values.index;
      let bottom = height;
      if (isShown || i === hover) {
        context.fillStyle = colourOf(isShown ? "chosen" : "hover");
        context.fillRect(i * bar, 0, Math.max(bar, 2), height);
      }
      const put = (name, tall) => {
        context.fillStyle = colourOf(`phase-${name}`);
        context.fillRect(i * bar + gap / 2, bottom - tall, Math.max(bar - gap, 0.75), tall);
        bottom -= tall;
      };
      if (engine) {
        partsOf(answer).forEach(([name, ns]) => put(name, (ns / highest) * below));
      }
      bottom = height - below;
      const many = counts.get(steps[i]);
      put(many === undefined ? "other" : "contacts", many === 0 ? 0 : Math.max(((many ?? 0) / most) * (room - below), 1.5));
    });
    context.textAlign = "right";
    if (engine) {
      drawScale(context, width, height, below);
    }
    context.fillStyle = colourOf("faint");
    const isNone = [...counts.values()].every((many) => many === 0);
    context.fillText(`${isNone ? "no " : ""}${found}${pair === "" ? "" : ` of ${pairName(names, pair)}`} in ${isNone ? "any" : "each"} ${entryNoun(data)[0]}${isNone ? "" : `, ${count(most)} at most`}`, width - 4, canvasText());
    context.fillStyle = colourOf("accent");
    context.fillRect(steps.findIndex(({ index }) => index === state.values.index) * bar, 0, Math.max(bar, 2), 2);
  });

  canvas.addEventListener("pointermove", (event) => {
    hover = indexAt(event);
    const { near, number, answer, index } = steps[hover];
    const { pair } = state.values;
    const many = countsOf(data, pair).get(steps[hover]);
    showTip(event, `${near ? "question" : "step"} ${number}: ${many === undefined ? "not known how many" : count(many)} ${pair === "" ? "found" : `of ${pairName(names, pair)}`}${index === undefined ? ", not drawn" : ""}`, state.values.engine
      ? [`in ${duration(answer.times.step)}`, ...partsOf(answer).map(([name, ns]) => `${name}  ${duration(ns)}`)] : []);
    if (event.buttons & 1) {
      show(steps[hover]);
    }
    draw();
  });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    show(steps[indexAt(event)]);
  });
  canvas.addEventListener("pointerleave", () => {
    hover = -1;
    hideTip();
    draw();
  });
  canvas.hidden = steps.length === 1;
  state.on(["index", "theme", "engine", "pair"], draw);
  new ResizeObserver(draw).observe(canvas);
}
