// dom.js - small helpers for elements, numbers and canvases.

export const byId = (id) => document.getElementById(id);

/** An element with properties; `children` are elements or texts, never markup. */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) {
      made[name] = value;
    } else {
      made.setAttribute(name, value);
    }
  }
  made.append(...children);
  return made;
}

/** "1 contact", "2 contacts". */
export function plural(value, one, many) {
  return `${count(value)} ${value === 1 ? one : many}`;
}

/** 12345 as "12 345", with thin spaces. */
export function count(value) {
  return String(value).replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
}

/** Nanoseconds, to three digits. */
export function duration(ns) {
  const units = [["s", 1e9], ["ms", 1e6], ["µs", 1e3]];
  for (const [unit, size] of units) {
    if (ns >= size) {
      return `${(ns / size).toPrecision(3)} ${unit}`;
    }
  }
  return `${Math.round(ns)} ns`;
}

/** A variable of the style sheet, which knows light from dark. */
export function colourOf(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Pixels of the text of a canvas: larger where the reader asks his browser for it, up to what its
 * lines have room for. */
export const canvasText = () =>
  11 * Math.min(1.4, parseFloat(getComputedStyle(document.documentElement).fontSize) / 16);

/** Give a canvas the pixels that it covers; its context, scaled to CSS pixels, emptied. */
export function prepareCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = `${canvasText()}px ${getComputedStyle(document.body).fontFamily}`;
  return { context, width, height };
}

/** Call once in the next frame, however often it is asked for. */
export function oncePerFrame(call) {
  let waits = false;
  return () => {
    if (!waits) {
      waits = true;
      requestAnimationFrame(() => {
        waits = false;
        call();
      });
    }
  };
}

const tip = () => byId("tip");

/** A box of text beside the pointer: over what it tells of where that has room, else above it, so that
 * no button is covered. */
export function showTip(event, title, lines) {
  const box = tip();
  box.replaceChildren(element("strong", {}, title), ...lines.map((line) => element("div", {}, line)));
  box.hidden = false;
  const { width, height } = box.getBoundingClientRect();
  const { top, bottom } = event.currentTarget.getBoundingClientRect();
  const isRight = event.clientX + 14 + width + 8 > window.innerWidth;
  box.style.left = `${Math.max(8, isRight ? event.clientX - 14 - width : event.clientX + 14)}px`;
  box.style.top = `${Math.max(8, height <= bottom - top ? top : top - height)}px`;
}

export function hideTip() {
  tip().hidden = true;
}
