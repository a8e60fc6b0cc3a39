// lanes.js - what each thread did in the step shown; wheel and drag zoom and move.

import { EVENT_COLOURS } from "./colours.js";
import { EVENT_KINDS } from "./data.js";
import { byId, colourOf, count, duration, hideTip, oncePerFrame, prepareCanvas, showTip } from "./dom.js";

const LANE = 24;
const LANE_GAP = 3;
const RULER = 16;
const LABEL = 62;
const ZOOM_MAX = 500;
const STEP_KIND = 0;
const SHARE_MIN = 0.9; // of a step: where less was recorded, it is said
const SAYS = { // what an event's two numbers are, by kind
  2: ["node", "triangles"], 3: ["node", "triangles"], 4: ["node", "other node"],
  5: ["node", "pairs"], 6: ["kind", "candidates"], 7: ["node", "triangles"], 8: ["node", "triangles"],
};

/** Rows: of each thread the events, and at which depth, those within others being deeper. */
export function layOut(events, threads) {
  const lanes = Array.from({ length: threads }, () => ({ events: [], depth: 1 }));
  for (const event of events) {
    if (event.kind !== STEP_KIND) {
      lanes[event.thread].events.push(event);
    }
  }
  for (const lane of lanes) {
    const open = []; // ends of the events around
    lane.events.sort((a, b) => a.begin - b.begin || b.end - a.end);
    for (const event of lane.events) {
      while (open.length > 0 && open[open.length - 1] <= event.begin) {
        open.pop();
      }
      event.depth = open.length;
      open.push(event.end);
      lane.depth = Math.max(lane.depth, open.length);
    }
  }
  return lanes;
}

function ticks(span) {
  const rough = span / 8;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((digit) => digit * power).find((step) => step >= rough);
}

export function makeLanes(data, state) {
  const canvas = byId("lanes");
  const none = byId("no-lanes");
  let lanes = [];
  let total = 1; // nanoseconds of the step
  let from = 0; // what is seen
  let to = 1;
  let drag = null;

  const scale = (width) => (width - LABEL) / (to - from);

  function drawLane(context, lane, thread, y, width) {
    const perNs = scale(width);
    const tall = (LANE - 2) / lane.depth;
    context.fillStyle = colourOf("lane");
    context.fillRect(LABEL, y, width - LABEL, LANE);
    for (const event of lane.events) {
      const x = LABEL + (event.begin - from) * perNs;
      const wide = Math.max(0.6, (event.end - event.begin) * perNs);
      if (x + wide < LABEL || x > width) {
        continue;
      }
      const left = Math.max(LABEL, x);
      const right = Math.min(width, x + wide);
      const top = y + 1 + event.depth * tall;
      context.fillStyle = colourOf(`phase-${EVENT_COLOURS[event.kind] ?? "other"}`);
      context.fillRect(left, top, right - left - (wide > 3 ? 0.75 : 0), tall - (lane.depth > 1 ? 0.75 : 0));
      if (right - left > 44 && tall >= 9) {
        context.fillStyle = colourOf("on-phase");
        context.save();
        context.beginPath();
        context.rect(left, top, right - left - 3, tall);
        context.clip();
        context.fillText(EVENT_KINDS[event.kind] ?? "?", left + 4, top + tall / 2 + 4);
        context.restore();
      }
    }
    context.fillStyle = colourOf("faint");
    context.fillText(`thread ${thread}`, 6, y + LANE / 2 + 4);
  }

  const draw = oncePerFrame(() => {
    canvas.style.height = `${RULER + lanes.length * (LANE + LANE_GAP)}px`;
    const { context, width, height } = prepareCanvas(canvas);
    const step = ticks(to - from);
    context.fillStyle = colourOf("faint");
    for (let at = Math.ceil(from / step) * step; at <= to; at += step) {
      const x = LABEL + (at - from) * scale(width);
      context.globalAlpha = 0.35;
      context.fillRect(x, RULER - 4, 1, height);
      context.globalAlpha = 1;
      if (x < width - 46) {
        context.fillText(at === 0 ? "0" : duration(at), x + 3, 10);
      }
    }
    lanes.forEach((lane, thread) => drawLane(context, lane, thread, RULER + thread * (LANE + LANE_GAP), width));
  });

  function eventAt(event) {
    const box = canvas.getBoundingClientRect();
    const lane = lanes[Math.floor((event.clientY - box.top - RULER) / (LANE + LANE_GAP))];
    const at = from + (event.clientX - box.left - LABEL) / scale(box.width);
    const slack = 1.5 / scale(box.width);
    const within = (lane?.events ?? []).filter((one) => one.begin - slack <= at && at <= one.end + slack);
    return within.reduce((best, one) => (best && best.depth > one.depth ? best : one), null);
  }
  function show(begin, end) {
    const span = Math.min(total, Math.max(total / ZOOM_MAX, end - begin));
    from = Math.min(Math.max(0, begin), total - span);
    to = from + span;
    draw();
  }
  canvas.addEventListener("wheel", (event) => {
    const box = canvas.getBoundingClientRect();
    const at = from + Math.max(0, event.clientX - box.left - LABEL) / scale(box.width);
    const zoom = Math.exp(event.deltaY * 0.002);
    event.preventDefault();
    show(at - (at - from) * zoom, at + (to - at) * zoom);
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    drag = { x: event.clientX, from, to };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointerup", () => {
    drag = null;
  });
  canvas.addEventListener("dblclick", () => show(0, total));
  canvas.addEventListener("pointermove", (event) => {
    if (drag) {
      const by = (drag.x - event.clientX) / scale(canvas.clientWidth);
      show(drag.from + by, drag.to + by);
      return;
    }
    const found = eventAt(event);
    if (!found) {
      hideTip();
      return;
    }
    const says = SAYS[found.kind] ?? [];
    showTip(event, `${EVENT_KINDS[found.kind] ?? "?"}: ${duration(found.end - found.begin)}`, [
      `thread ${found.thread}, from ${duration(found.begin)}`,
      ...says.map((name, i) => `${name} ${name === "kind" ? ["vertex-face", "edge-edge"][found.a] ?? found.a : count(i === 0 ? found.a : found.b)}`),
    ]);
  });
  canvas.addEventListener("pointerleave", hideTip);

  state.on(["index"], ({ index }) => {
    const { events } = data.meta.steps[index];
    const read = data.step(index).events;
    lanes = layOut(read, events?.threads ?? 0);
    total = Math.max(1, events?.ns ?? 1);
    from = 0;
    to = total;
    none.hidden = read.length > 0;
    canvas.hidden = read.length === 0;
    none.textContent = data.meta.no_lanes
      ? `Threads were not recorded: ${data.meta.no_lanes}` : "Threads were not recorded at this step.";
    const { step: took } = data.meta.steps[index].answer.times;
    byId("lanes-lost").textContent = [
      ...(read.length > 0 && total < SHARE_MIN * took ? [`threads were recorded for ${duration(total)} of ${duration(took)}`] : []),
      ...(events?.lost > 0 ? [`${count(events.lost)} events had no room`] : []),
    ].join("; ");
    state.set({ lanes: lanes.filter((lane) => lane.events.length > 0).length });
    draw();
  });
  state.on(["theme"], draw);
  new ResizeObserver(draw).observe(canvas);
}
