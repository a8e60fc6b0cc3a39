// transport.js - play, the step and the time within it.

import { byId } from "./dom.js";

const STEP_MS = 900; // one step, at speed 1
const PAUSE = 0.12; // of it, at the end of each step

export function moveStep(data, state, by) {
  const index = Math.min(data.meta.steps.length - 1, Math.max(0, state.values.index + by));
  state.set({ index });
}

export function makeTransport(data, state) {
  const { steps } = data.meta;
  const play = byId("play");
  const step = byId("step");
  const time = byId("time");
  let last = 0;
  let pause = 0;

  function advance(now) {
    if (!state.values.playing) {
      return;
    }
    const passed = Math.min(100, now - last) / STEP_MS * state.values.speed;
    last = now;
    if (pause > 0) {
      pause -= passed;
    } else if (state.values.t >= 1) {
      const isLast = state.values.index === steps.length - 1;
      state.set({ index: isLast ? 0 : state.values.index + 1, t: 0 });
    } else {
      const t = Math.min(1, state.values.t + passed);
      pause = t === 1 && steps.length === 1 ? PAUSE * 4 : 0;
      state.set({ t });
    }
    requestAnimationFrame(advance);
  }

  step.max = String(steps.length - 1);
  step.addEventListener("input", () => state.set({ index: Number(step.value), playing: false }));
  time.addEventListener("input", () => state.set({ t: Number(time.value), playing: false }));
  play.addEventListener("click", () => state.set({ playing: !state.values.playing }));
  byId("previous").addEventListener("click", () => moveStep(data, state, -1));
  byId("next").addEventListener("click", () => moveStep(data, state, 1));
  byId("speed").addEventListener("change", (event) => state.set({ speed: Number(event.target.value) }));
  state.on(["index"], ({ index }) => {
    step.value = String(index);
    step.setAttribute("aria-valuetext", `step ${steps[index].number}`);
    byId("step-number").textContent = steps[index].number;
    byId("step-last").textContent = steps[steps.length - 1].number;
    byId("previous").disabled = index === 0;
    byId("next").disabled = index === steps.length - 1;
  });
  state.on(["t"], ({ t }) => {
    time.value = String(t);
    byId("time-number").textContent = t.toFixed(3);
  });
  state.on(["playing"], ({ playing }) => {
    play.setAttribute("aria-label", playing ? "Pause" : "Play");
    play.classList.toggle("playing", playing);
    if (playing) {
      last = performance.now();
      requestAnimationFrame(advance);
    }
  });
}
