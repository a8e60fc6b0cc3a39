// transport.js - play, the step and the time within it.

import { byId, count } from "./dom.js";
import { digits, entryNoun, partText } from "./words.js";

const STEP_MS = 900; // one step, at speed 1
const PAUSE = 0.12; // of it, at the end of each step

/** Return a function that shows a step of a number of the page, once its data are ready, with other
 * changes of the state; of many that are asked for meanwhile, the last. */
export function makeGoTo(data, state) {
  let wanted = null; // {index, changes} that is not shown yet
  return async (index, changes = {}) => {
    const isBusy = wanted !== null;
    wanted = { index: Math.min(data.meta.steps.length - 1, Math.max(0, index)), changes };
    while (!isBusy && wanted !== null) {
      const next = wanted;
      await data.load(next.index);
      if (wanted === next) {
        wanted = null;
      }
      state.set({ index: next.index, absent: null, ...next.changes });
    }
  };
}

export function makeTransport(data, state, goTo) {
  const { steps } = data.meta;
  const play = byId("play");
  const step = byId("step");
  const time = byId("time");
  let last = 0;
  let pause = 0;
  let waits = false; // for the data of the next step

  function advance(now) {
    if (!state.values.playing) {
      return;
    }
    const passed = Math.min(100, now - last) / STEP_MS * state.values.speed;
    last = now;
    if (waits) {
      // the time stands
    } else if (pause > 0) {
      pause -= passed;
    } else if (state.values.t >= 1) {
      const isLast = state.values.index === steps.length - 1;
      waits = true;
      goTo(isLast ? 0 : state.values.index + 1, { t: 0 }).then(() => {
        waits = false;
      });
    } else {
      const t = Math.min(1, state.values.t + passed);
      pause = t === 1 && steps.length === 1 ? PAUSE * 4 : 0;
      state.set({ t });
    }
    requestAnimationFrame(advance);
  }

  for (const id of ["previous", "next", "step-text", "step"]) {
    byId(id).hidden = steps.length === 1;
  }
  const places = steps.map((_, index) => data.all.findIndex((one) => one.index === index));
  const [noun] = entryNoun(data);
  byId("step-word").textContent = `${noun[0].toUpperCase()}${noun.slice(1)}`;
  byId("step-last").textContent = `${partText(data) ? `${count(data.all[0].number)}–` : ""}${count(data.all.at(-1).number)}`;
  step.max = String(data.all.length - 1);
  step.addEventListener("input", () => { // to the next one that is drawn, in the same direction
    const place = Number(step.value);
    const before = places.filter((one) => one < place).length; // drawn ones
    const isBack = place < places[state.values.index] && places[before] !== place;
    const to = Math.max(0, Math.min(steps.length - 1, isBack ? before - 1 : before));
    step.value = String(places[to]);
    goTo(to, { playing: false });
  });
  time.addEventListener("input", () => state.set({ t: Number(time.value), playing: false }));
  play.addEventListener("click", () => state.set({ playing: !state.values.playing }));
  byId("previous").addEventListener("click", () => goTo(state.values.index - 1));
  byId("next").addEventListener("click", () => goTo(state.values.index + 1));
  byId("speed").addEventListener("change", (event) => state.set({ speed: Number(event.target.value) }));
  state.on(["index"], ({ index }) => {
    step.value = String(places[index]);
    step.setAttribute("aria-valuetext", `step ${steps[index].number}`);
    byId("step-number").textContent = count(steps[index].number);
    byId("time-slide").hidden = Boolean(steps[index].near); // nothing moves
    byId("transport").hidden = Boolean(steps[index].near) && steps.length === 1;
    byId("previous").disabled = index === 0;
    byId("next").disabled = index === steps.length - 1;
  });
  state.on(["t"], ({ t }) => {
    time.value = String(t);
    byId("time-number").textContent = digits(t);
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
