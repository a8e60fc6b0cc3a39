// keys.js - the keyboard.

import { byId } from "./dom.js";
import { moveChoice } from "./contacts.js";

const TIME_STEP = 0.05;
const TURN_STEP = Math.PI / 24;
const ZOOM_STEP = 0.8;

/** `does`: what the keys call beside changing the state: fit, turn, fly, closer, copy, goTo. */
export function makeKeys(data, state, does) {
  const help = byId("help");
  /** With the keys of what is on the screen. */
  const openHelp = () => {
    for (const part of help.querySelectorAll("[data-of]")) {
      part.hidden = !byId(part.dataset.of).checkVisibility();
    }
    help.showModal();
  };
  const move = (by) => state.set({ t: Math.min(1, Math.max(0, state.values.t + by)), playing: false });
  const level = (by) => {
    const slider = byId("level");
    slider.value = String(Number(slider.value) + by);
    slider.dispatchEvent(new Event("input"));
  };
  const kind = (which) => state.set({ kinds: state.values.kinds.map((on, i) => (i === which ? !on : on)) });
  const keys = {
    " ": () => state.set({ playing: !state.values.playing }),
    ArrowLeft: (event) => (event.shiftKey ? move(-TIME_STEP) : does.goTo(state.values.index - 1)),
    ArrowRight: (event) => (event.shiftKey ? move(TIME_STEP) : does.goTo(state.values.index + 1)),
    Home: (event) => (!event.shiftKey ? does.goTo(0) : byId("go-earliest").checkVisibility() && byId("go-earliest").click()),
    End: () => does.goTo(Infinity),
    ArrowUp: () => moveChoice(state, -1),
    ArrowDown: () => moveChoice(state, 1),
    Enter: (event) => (event.shiftKey ? does.closer() : does.fly(state.values.chosen)),
    Escape: () => state.set({ chosen: -1 }),
    1: () => kind(0),
    2: () => kind(1),
    3: () => kind(2),
    4: () => kind(3),
    5: () => kind(4),
    c: does.copy,
    "/": () => byId("find").focus(),
    "[": () => level(-1),
    "]": () => level(1),
    f: does.fit,
    ",": () => does.turn(-TURN_STEP, 0, 1),
    ".": () => does.turn(TURN_STEP, 0, 1),
    PageUp: () => does.turn(0, TURN_STEP, 1),
    PageDown: () => does.turn(0, -TURN_STEP, 1),
    "+": () => does.turn(0, 0, ZOOM_STEP),
    "-": () => does.turn(0, 0, 1 / ZOOM_STEP),
    w: () => state.set({ wires: !state.values.wires }),
    t: () => state.set({ thick: !state.values.thick && !byId("thick").hidden }),
    x: () => state.set({ opacity: state.values.opacity < 1 ? 1 : 0.28 }),
    "?": openHelp,
  };
  document.addEventListener("keydown", (event) => {
    const { target } = event;
    const isForm = target.matches("input, select, button, summary, a");
    const call = keys[event.key];
    if (target.matches("input[type='search']")) { // which takes letters
      if (event.key === "Enter" || event.key === "ArrowDown") {
        event.preventDefault();
        byId("contacts").focus();
        moveChoice(state, -Infinity);
      }
      return;
    }
    if (help.open || event.ctrlKey || event.metaKey || event.altKey || !call) {
      return;
    }
    // A slider or a button has its own use for these.
    if (isForm && (event.key.startsWith("Arrow") || [" ", "Enter", "Home", "End", "PageUp", "PageDown"].includes(event.key))) {
      return;
    }
    event.preventDefault();
    call(event);
  });
  byId("help-open").addEventListener("click", openHelp);
  byId("help-close").addEventListener("click", () => help.close());
}
