// timeline.js - how many contacts each step has; with the engine's figures what each phase took, too.

import { PHASES } from "./colours.js";
import { byId, colourOf, count, duration, hideTip, oncePerFrame, prepareCanvas, showTip } from "./dom.js";

const TOP = 16; // above the bars, for the scale
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
  const most = Math.max(1, ...steps.map(({ answer }) => answer.total));
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

  const draw = oncePerFrame(() => {
    const { context, width, height } = prepareCanvas(canvas);
    const room = height - TOP - 2;
    const bar = widthOf(width);
    const gap = bar > 4 ? Math.min(3, bar * 0.2) : 0;
    const { engine } = state.values;
    steps.forEach(({ answer }, i) => {
      const isShown = steps[i].index === state.values.index;
      let bottom = height;
      if (isShown || i === hover) {
        context.fillStyle = colourOf(isShown ? "chosen" : "hover");
        context.fillRect(i * bar, 0, Math.max(bar, 2), height);
      }
      const parts = engine ? partsOf(answer).map(([name, ns]) => [name, ns / highest])
        : [["contacts", answer.total / most]];
      for (const [name, share] of parts) {
        const tall = share > 0 ? Math.max(share * room, engine ? 0 : 1.5) : 0;
        context.fillStyle = colourOf(`phase-${name}`);
        context.fillRect(i * bar + gap / 2, bottom - tall, Math.max(bar - gap, 0.75), tall);
        bottom -= tall;
      }
    });
    context.textAlign = "right";
    if (engine) {
      drawScale(context, width, height, room);
      context.strokeStyle = colourOf("text");
      context.globalAlpha = 0.65;
      context.lineWidth = 1.25;
      context.beginPath();
      steps.forEach(({ answer }, i) => {
        context.lineTo((i + 0.5) * bar, height - 1 - (answer.total / most) * (room - 4));
      });
      context.stroke();
      context.globalAlpha = 1;
    }
    context.fillStyle = colourOf("faint");
    context.fillText(`${engine ? "— " : ""}found in each step, at most ${count(most)}`, width - 4, 11);
    context.fillStyle = colourOf("accent");
    context.fillRect(steps.findIndex(({ index }) => index === state.values.index) * bar, 0, Math.max(bar, 2), 2);
  });

  canvas.addEventListener("pointermove", (event) => {
    hover = indexAt(event);
    const { number, answer, index } = steps[hover];
    showTip(event, `step ${number}: ${count(answer.total)} found${index === undefined ? ", not drawn" : ""}`, state.values.engine
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
  state.on(["index", "theme", "engine"], draw);
  new ResizeObserver(draw).observe(canvas);
}
