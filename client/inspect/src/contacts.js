// contacts.js - the list of contacts: by kind, by time, one of them chosen.

import { colourOfTime, cssOf } from "./colours.js";
import { FEATURES, INITIAL, INSIDE, KINDS } from "./data.js";
import { byId, colourOf, count, element, hideTip, oncePerFrame, prepareCanvas, showTip } from "./dom.js";

const BINS = 60;
const ROW = 24; // pixels, as in style.css
const SPARE = 6; // rows beyond what is seen

/** Places of the contacts that pass the filters, in the order that is asked for. */
export function pickContacts(contacts, { kinds, range, order }) {
  const picked = [];
  for (let i = 0; i < contacts.count; i++) {
    const toi = contacts.toi[i];
    if (kinds[contacts.kind[i]] && toi >= range[0] && toi <= range[1]) {
      picked.push(i);
    }
  }
  return order === "toi" ? picked.sort((a, b) => contacts.toi[a] - contacts.toi[b] || a - b) : picked;
}

export function histogramOf(contacts, kinds) {
  const bins = Array.from({ length: BINS }, () => KINDS.map(() => 0));
  for (let i = 0; i < contacts.count; i++) {
    if (kinds[contacts.kind[i]]) {
      bins[Math.min(BINS - 1, Math.floor(contacts.toi[i] * BINS))][contacts.kind[i]]++;
    }
  }
  return bins;
}

/** "0.25", cut for a row. */
const timeText = (toi) => toi.toFixed(4);

export function featureText(step, i, side) {
  const { contacts, objects } = step;
  const object = side === "a" ? contacts.objectA[i] : contacts.objectB[i];
  const feature = side === "a" ? contacts.featureA[i] : contacts.featureB[i];
  const kind = FEATURES[KINDS[contacts.kind[i]].points[side === "a" ? 0 : 1]];
  return objects.length > 1 ? `${kind} ${feature} · ${object}` : `${kind} ${feature}`;
}

/** How the features of a contact begin: {text, title}, or null where it is as ever. */
export function flagText({ contacts }, i) {
  return contacts.flags[i] & INITIAL ? { text: "at 0", title: "touching or within their distance at t = 0" }
    : contacts.flags[i] & INSIDE ? { text: "in", title: "within their distance at t = 0, and approaching" } : null;
}

const sumOf = (bin) => bin.reduce((sum, of) => sum + of, 0);

function makeHistogram(data, state) {
  const canvas = byId("histogram");
  let from = null; // where a drag began, 0 .. 1

  const draw = oncePerFrame(() => {
    const { context, width, height } = prepareCanvas(canvas);
    const { index, kinds, range } = state.values;
    const bins = histogramOf(data.step(index).contacts, kinds);
    const highest = Math.max(1, ...bins.map(sumOf));
    const bar = width / BINS;
    bins.map(sumOf).forEach((sum, i) => {
      const share = sum / highest;
      const isIn = (i + 1) / BINS > range[0] && i / BINS < range[1];
      context.globalAlpha = isIn ? 1 : 0.25;
      context.fillStyle = cssOf(colourOfTime((i + 0.5) / BINS));
      const tall = sum > 0 ? Math.max(2, Math.sqrt(share) * (height - 4)) : 0;
      context.fillRect(i * bar + 0.5, height - tall, Math.max(1, bar - 1), tall);
    });
    context.globalAlpha = 1;
    context.fillStyle = colourOf("line");
    context.fillRect(0, height - 1, width, 1);
    context.fillStyle = colourOf("accent");
    context.fillRect(state.values.t * width - 0.75, 0, 1.5, height);
  });

  const timeAt = (event) => {
    const box = canvas.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
  };
  canvas.addEventListener("pointerdown", (event) => {
    from = timeAt(event);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const at = timeAt(event);
    const bins = histogramOf(data.step(state.values.index).contacts, state.values.kinds);
    const bin = bins[Math.min(BINS - 1, Math.floor(at * BINS))];
    showTip(event, `t = ${at.toFixed(3)}`, KINDS.flatMap(({ name }, kind) =>
      (kind < 2 || bin[kind] > 0 ? [`${count(bin[kind])} ${name}`] : [])));
    if (from !== null && Math.abs(at - from) > 0.01) {
      state.set({ range: [Math.min(from, at), Math.max(from, at)] });
    }
  });
  canvas.addEventListener("pointerup", (event) => {
    if (from !== null && Math.abs(timeAt(event) - from) <= 0.01) {
      state.set({ range: [0, 1] });
    }
    from = null;
  });
  canvas.addEventListener("pointerleave", hideTip);
  state.on(["index", "kinds", "range", "t", "theme"], draw);
  new ResizeObserver(draw).observe(canvas);
}

/** A list of which only the rows that are seen exist. */
function makeList(data, state, fly) {
  const list = byId("contacts");
  const rows = byId("contact-rows");

  function row(step, i, place) {
    const { contacts } = step;
    const { chosen } = state.values;
    const { name, id } = KINDS[contacts.kind[i]];
    const flag = flagText(step, i);
    const made = element("div", { className: "row", role: "option", id: `contact-${i}` },
      element("i", { className: "dot" }),
      element("span", { className: "kind", title: flag?.title ?? "" }, `${id.toUpperCase()} ${flag?.text ?? ""}`),
      element("span", {}, featureText(step, i, "a")),
      element("span", {}, featureText(step, i, "b")),
      element("span", { className: "number" }, timeText(contacts.toi[i])));
    made.firstChild.style.background = cssOf(colourOfTime(contacts.toi[i]));
    made.style.top = `${place * ROW}px`;
    made.setAttribute("aria-selected", String(i === chosen));
    made.setAttribute("aria-label", `${name}, ${featureText(step, i, "a")}, `
      + `${featureText(step, i, "b")}, time ${timeText(contacts.toi[i])}${flag ? `, ${flag.title}` : ""}`);
    made.addEventListener("click", () => {
      state.set({ chosen: i });
      fly(i);
    });
    return made;
  }

  const draw = oncePerFrame(() => {
    const { index, picked, chosen } = state.values;
    const step = data.step(index);
    const first = Math.max(0, Math.floor(list.scrollTop / ROW) - SPARE);
    const end = Math.min(picked.length, Math.ceil((list.scrollTop + list.clientHeight) / ROW) + SPARE);
    rows.style.height = `${picked.length * ROW}px`;
    rows.replaceChildren(...picked.slice(first, end).map((i, k) => row(step, i, first + k)));
    if (chosen >= 0) {
      list.setAttribute("aria-activedescendant", `contact-${chosen}`);
    } else {
      list.removeAttribute("aria-activedescendant");
    }
  });

  function reveal() {
    const place = state.values.picked.indexOf(state.values.chosen);
    if (place >= 0 && (place * ROW < list.scrollTop || (place + 1) * ROW > list.scrollTop + list.clientHeight)) {
      list.scrollTop = Math.max(0, place * ROW - list.clientHeight / 2);
    }
  }
  list.addEventListener("scroll", draw);
  list.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && state.values.chosen >= 0) {
      fly(state.values.chosen);
    }
  });
  state.on(["picked", "chosen"], () => {
    reveal();
    draw();
  });
  new ResizeObserver(draw).observe(list);
}

/** Choose the next or previous contact of the list. */
export function moveChoice(state, by) {
  const { picked, chosen } = state.values;
  if (picked.length > 0) {
    const place = picked.indexOf(chosen);
    const next = place < 0 ? (by > 0 ? 0 : picked.length - 1) : place + by;
    state.set({ chosen: picked[Math.min(picked.length - 1, Math.max(0, next))] });
  }
}

export function makeContacts(data, state, fly) {
  const buttons = KINDS.map(({ id }) => byId(`kind-${id}`));
  buttons.forEach((button, kind) => {
    button.hidden = kind > 1 && data.meta.steps.every(({ near, answer }) => near || answer[KINDS[kind].id] === 0);
    button.addEventListener("click", () => {
      const kinds = [...state.values.kinds];
      kinds[kind] = !kinds[kind];
      state.set({ kinds });
    });
  });
  byId("order").addEventListener("change", (event) => state.set({ order: event.target.value }));
  byId("range-clear").addEventListener("click", () => state.set({ range: [0, 1] }));
  state.on(["index", "kinds", "range", "order"], ({ index, ...filters }, changed) => {
    const { contacts } = data.step(index);
    const picked = pickContacts(contacts, filters);
    const isKept = !changed.has("index") && picked.includes(filters.chosen);
    state.set({ picked, chosen: isKept ? filters.chosen : -1 });
    buttons.forEach((button, kind) => {
      const of = contacts.kind.reduce((sum, its) => sum + (its === kind ? 1 : 0), 0);
      button.querySelector("b").textContent = count(of);
      button.setAttribute("aria-pressed", String(filters.kinds[kind]));
    });
    const isCut = filters.range[0] > 0 || filters.range[1] < 1;
    byId("range-clear").hidden = !isCut;
    byId("range-clear").textContent = `t ${filters.range.map((t) => t.toFixed(2)).join(" – ")}  ✕`;
    byId("picked").textContent = picked.length === contacts.count
      ? `${count(picked.length)} shown` : `${count(picked.length)} of ${count(contacts.count)} shown`;
  });
  makeHistogram(data, state);
  makeList(data, state, fly);
}
