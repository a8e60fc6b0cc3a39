// contacts.js - the list of a step's records: contacts by time, what is near by distance.

import { colourOfObject, colourOfTime, cssOf, nameOfColour } from "./colours.js";
import { KINDS } from "./data.js";
import { byId, colourOf, count, element, hideTip, oncePerFrame, plural, prepareCanvas, showTip } from "./dom.js";
import { findContacts, readWords } from "./find.js";
import { areCounted, countsOf, earliestOf, isOfPair, namesOf, neverPairs, pairName, stepsOfPairs } from "./pairs.js";
import { digits, featureText, firstOf, flagText, isOfBounds, measureOf, nounOf, pairsOf, partText, sideOf } from "./words.js";

const BINS = 60;
const SPARE = 6; // rows beyond what is seen
const PAIRS_OFFERED = 200; // of a step; and of those that meet in other steps alone

/** How many of what is found have each kind in each part of the time. */
function histogramOf({ toi, kind }, { found, kinds }) {
  const bins = Array.from({ length: BINS }, () => KINDS.map(() => 0));
  for (const i of found.filter((one) => kinds[kind[one]])) {
    bins[Math.min(BINS - 1, Math.floor(toi[i] * BINS))][kind[i]]++;
  }
  return bins;
}

const sumOf = (bin) => bin.reduce((sum, of) => sum + of, 0);

function makeHistogram(data, state) {
  const canvas = byId("histogram");
  let from = null; // where a drag began, 0 .. 1

  const draw = oncePerFrame(() => {
    const { context, width, height } = prepareCanvas(canvas);
    const { index, range } = state.values;
    const bins = histogramOf(data.step(index).contacts, state.values);
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
    if (!data.step(index).near) { // there the axis is a distance
      context.fillStyle = colourOf("accent");
      context.fillRect(state.values.t * width - 0.75, 0, 1.5, height);
    }
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
    const step = data.step(state.values.index);
    const bin = histogramOf(step.contacts, state.values)[Math.min(BINS - 1, Math.floor(at * BINS))];
    showTip(event, step.near ? `distance ${digits(at * step.contacts.greatest)}` : `t = ${digits(at)}`, KINDS.flatMap(({ name }, kind) =>
      (bin[kind] > 0 ? [`${count(bin[kind])} ${name}`] : [])));
    if (from !== null && Math.abs(at - from) > 0.01) { // whole bars: what is at 0 is in the first
      state.set({ range: [Math.floor(Math.min(from, at) * BINS) / BINS, Math.ceil(Math.max(from, at) * BINS) / BINS] });
    }
  });
  canvas.addEventListener("pointerup", (event) => {
    if (from !== null && Math.abs(timeAt(event) - from) <= 0.01) {
      state.set({ range: [0, 1] });
    }
    from = null;
  });
  canvas.addEventListener("pointerleave", hideTip);
  state.on(["found", "kinds", "range", "t", "theme"], draw);
  new ResizeObserver(draw).observe(canvas);
}

/** A list of which only the rows that are seen exist. */
function makeList(data, state, fly) {
  const list = byId("contacts");
  const rows = byId("contact-rows");
  /** Pixels; style.css knows when a row has two lines. */
  const rowHeight = () => parseFloat(getComputedStyle(rows).minHeight);

  /** A feature, with the colour of its object before it. */
  function feature(step, i, side) {
    const dot = element("i", { className: "dot square" });
    const { object } = sideOf(step, i, side);
    dot.style.background = cssOf(colourOfObject(object));
    dot.title = nameOfColour(object);
    return element("span", { title: featureText(step, i, side) }, ...(step.objects.length > 1 ? [dot] : []),
      featureText(step, i, side));
  }

  function row(step, i, place, height) {
    const { contacts } = step;
    const { chosen } = state.values;
    const { name, id } = KINDS[contacts.kind[i]];
    const flag = flagText(step, i);
    const measure = measureOf(step);
    const value = measure ? digits(measure.of(i)) : "";
    const made = element("div", { className: "row", role: "option", id: `contact-${i}` },
      element("i", { className: "dot" }),
      element("span", { className: "kind", title: flag?.title ?? name }, isOfBounds(step) ? "" : `${id.toUpperCase()} ${flag?.text ?? ""}`),
      element("span", { className: "features" }, feature(step, i, "a"), ...(isOfBounds(step) ? [] : [feature(step, i, "b")])),
      element("span", { className: "number" }, value));
    made.firstChild.style.background = cssOf(colourOfTime(contacts.toi[i]));
    made.style.top = `${place * height}px`;
    made.setAttribute("aria-selected", String(i === chosen));
    made.setAttribute("aria-setsize", String(state.values.picked.length));
    made.setAttribute("aria-posinset", String(place + 1));
    made.addEventListener("click", () => {
      state.set({ chosen: i });
      fly(i);
    });
    return made;
  }

  let isToReveal = false; // what is chosen: when the list has its height
  const draw = oncePerFrame(() => {
    const { index, picked, chosen } = state.values;
    const step = data.step(index);
    const isNamed = step.objects.length > 1; // then two lines have room for names
    list.parentElement.classList.toggle("named", isNamed);
    byId("head-features").replaceChildren(...(isOfBounds(step) ? ["vertex"] : isNamed ? ["the two features"] : ["first feature", "second feature"])
      .map((text) => element("span", {}, text)));
    byId("head-kind").textContent = isOfBounds(step) ? "" : "kind";
    byId("head-measure").textContent = measureOf(step)?.name ?? "";
    const height = rowHeight();
    rows.style.height = `${picked.length * height}px`;
    if (isToReveal) {
      reveal(picked.indexOf(chosen), height);
      isToReveal = false;
    }
    const first = Math.max(0, Math.floor(list.scrollTop / height) - SPARE);
    const end = Math.min(picked.length, Math.ceil((list.scrollTop + list.clientHeight) / height) + SPARE);
    rows.replaceChildren(...picked.slice(first, end).map((i, k) => row(step, i, first + k, height)));
    if (chosen >= 0) {
      list.setAttribute("aria-activedescendant", `contact-${chosen}`);
    } else {
      list.removeAttribute("aria-activedescendant");
    }
  });

  function reveal(place, height) {
    if (place >= 0 && (place * height < list.scrollTop || (place + 1) * height > list.scrollTop + list.clientHeight)) {
      list.scrollTop = Math.max(0, place * height - list.clientHeight / 2);
    }
  }
  list.addEventListener("scroll", draw);
  list.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && state.values.chosen >= 0) {
      fly(state.values.chosen);
    }
  });
  state.on(["picked", "chosen", "theme"], () => {
    isToReveal = true;
    draw();
  });
  new ResizeObserver(draw).observe(list);
}

/** Choose the next or previous record of the list; `by` -Infinity: the first. */
export function moveChoice(state, by) {
  const { picked, chosen } = state.values;
  if (picked.length > 0) {
    const place = picked.indexOf(chosen);
    const next = place < 0 ? (by === -1 ? picked.length - 1 : 0) : place + by;
    state.set({ chosen: picked[Math.min(picked.length - 1, Math.max(0, next))] });
  }
}

/** First, previous, next; and which one of how many that is, in the order of the list. With several
 * steps also the first contact of all; behind the list's end the next step that has any goes on. */
function makeGoing(data, state, { fly, goTo, show }) {
  const { all, meta: { steps } } = data;
  /** The next step, or the one before, that has any; -1: none has. */
  const beyond = ({ index, pair }, by) => {
    let at = index + by;
    while (steps[at] && countsOf(data, pair).get(steps[at]) === 0) {
      at += by;
    }
    return steps[at] ? at : -1;
  };
  const goEarliest = async () => {
    const earliest = earliestOf(data, state.values.pair);
    if (earliest.index !== undefined) { // else one stays here
      state.set({ kinds: KINDS.map(() => true), range: [0, 1], find: "", playing: false });
    }
    await show(earliest);
    if (state.values.index === earliest.index) { // nothing else was asked for meanwhile
      const step = data.step(earliest.index);
      state.set({ chosen: firstOf(step, isOfPair(step, state.values.pair)) });
      fly(state.values.chosen);
    }
  };
  byId("go-earliest").addEventListener("click", goEarliest);
  byId("go-earliest").textContent = `First of ${partText(data) || "all steps"}`;
  const goes = { "go-first": -Infinity, "go-previous": -1, "go-next": 1 };
  for (const [id, by] of Object.entries(goes)) {
    byId(id).addEventListener("click", async () => {
      const { picked, chosen } = state.values;
      const isBeyond = Math.abs(by) === 1 && (picked.length === 0 || (chosen >= 0 && chosen === picked.at(by < 0 ? 0 : -1)));
      const to = isBeyond ? beyond(state.values, by) : -1;
      if (to >= 0) {
        await goTo(to, { chosen: -1, playing: false });
      }
      moveChoice(state, by);
      fly(state.values.chosen);
    });
  }
  state.on(["picked", "chosen"], ({ index, pair, picked, chosen, order }) => {
    const focused = document.activeElement;
    const place = picked.indexOf(chosen);
    const step = data.step(index);
    const measure = measureOf(step);
    const earliest = earliestOf(data, pair);
    const isAlone = all.length === 1 && step.contacts.count < 2; // else buttons stay in their places
    const [before, behind] = [-1, 1].map((by) => beyond({ index, pair }, by));
    byId("go-earliest").hidden = !earliest || all.length === 1;
    byId("go-earliest").disabled = index === earliest?.index && chosen >= 0 && chosen === firstOf(step, isOfPair(step, pair));
    byId("goes").hidden = isAlone;
    byId("go-first").disabled = place === 0 || picked.length === 0;
    byId("go-previous").disabled = place <= 0 && before < 0;
    byId("go-next").disabled = place === picked.length - 1 && behind < 0;
    byId("go-previous").title = place > 0 || before < 0 ? "The one before (↑, enter)" : `The last of step ${steps[before].number}`;
    byId("go-next").title = place < picked.length - 1 || behind < 0 ? "The next one (↓, enter)" : `The first of step ${steps[behind].number}`;
    if (focused?.disabled) { // it would be lost
      byId("contacts").focus();
    }
    byId("place").textContent = place < 0 ? "" : `row ${count(place + 1)} of ${count(picked.length)}, ${order === "toi" && measure ? `by ${measure.name}` : "in file order"}`;
  });
}

/** Buttons of the kinds that there are, the list of pairs of objects, and what was typed. */
function makeFilters(data, state) {
  const buttons = KINDS.map(({ id }) => byId(`kind-${id}`));
  const select = byId("pair");
  const find = byId("find");
  buttons.forEach((button, kind) => button.addEventListener("click", () =>
    state.set({ kinds: state.values.kinds.map((on, i) => (i === kind ? !on : on)) })));
  byId("order").addEventListener("change", (event) => state.set({ order: event.target.value }));
  byId("range-clear").addEventListener("click", () => state.set({ range: [0, 1] }));
  select.addEventListener("change", () => state.set({ pair: select.value }));
  find.addEventListener("input", () => state.set({ find: find.value }));
  state.on(["found", "kinds", "range"], ({ index, found, kinds, range }) => {
    const step = data.step(index);
    const { kind: kindOf, toi } = step.contacts;
    const counts = KINDS.map(() => 0);
    found.filter((i) => toi[i] >= range[0] && toi[i] <= range[1]).forEach((i) => counts[kindOf[i]]++);
    buttons.forEach((button, kind) => {
      button.hidden = isOfBounds(step) || !(step.near ? kindOf.includes(kind) : data.meta.steps.some(({ answer }) => answer[KINDS[kind].id]));
      button.querySelector("b").textContent = count(counts[kind]);
      button.setAttribute("aria-pressed", String(kinds[kind]));
    });
  });
  const names = namesOf(data);
  const others = stepsOfPairs(data);
  const isCounted = areCounted(data);
  state.on(["index", "pair"], ({ index, pair }) => {
    const step = data.step(index);
    if (pair !== "" && pair.split(",").some((number) => !names.has(Number(number)))) {
      state.set({ pair: "" });
      return;
    }
    const here = new Map(pairsOf(step).map((its) => [its.pair, its.count]));
    const away = [...others.keys()].filter((its) => !here.has(its));
    const [never, neverCount] = isOfBounds(step) ? [[], 0] : neverPairs(data, step, new Set([...here.keys(), ...away]), PAIRS_OFFERED);
    const offered = [...here.keys()].slice(0, PAIRS_OFFERED).concat(away.slice(0, PAIRS_OFFERED), never);
    const left = here.size + away.length + neverCount - offered.length;
    const noun = step.near ? "question" : "step";
    const options = [...offered, ...(pair === "" || offered.includes(pair) ? [] : [pair])].map((its) =>
      [its, here.has(its) ? `${count(here.get(its))} in this ${noun}` : others.has(its) ? `none in this ${noun}, some in ${plural(others.get(its), "other", "others")}`
        : isCounted ? `never${partText(data) && ` in ${partText(data)}`}` : `none in this ${noun}; of others that is not known`]);
    select.replaceChildren(element("option", { value: "" }, isOfBounds(step) ? "all objects" : "all pairs of objects"),
      ...options.map(([value, text]) => element("option", { value }, `${pairName(names, value, step)}: ${text}`)),
      ...(left > 0 ? [element("option", { disabled: true }, `${count(left)} more pairs: find one by its two names`)] : []));
    select.value = pair;
    select.title = select.selectedOptions[0].text;
    select.hidden = options.length < 2 && pair === "";
  });
  state.on(["find"], ({ find: text }) => {
    if (find.value !== text) {
      find.value = text;
    }
  });
  state.on(["order"], ({ order }) => {
    byId("order").value = order;
  });
}

/** `does`: fly and show, as of makeKeys and main.js. */
export function makeContacts(data, state, does) {
  const isTouched = window.matchMedia("(pointer: coarse)").matches;
  makeFilters(data, state);
  state.on(["index", "kinds", "range", "order", "pair", "find"], ({ index, ...filters }, changed) => {
    const step = data.step(index);
    const { kind, toi } = step.contacts;
    const found = findContacts(step, filters);
    const picked = found.filter((i) => filters.kinds[kind[i]] && toi[i] >= filters.range[0] && toi[i] <= filters.range[1]);
    const isKept = picked.includes(filters.chosen) && !(changed.has("index") && !changed.has("chosen"));
    const isLeft = filters.chosen >= 0 && !isKept && changed.has("index") && !changed.has("t");
    state.set({ found, picked, chosen: isKept ? filters.chosen : -1, ...(isLeft ? { t: 1 } : {}) }); // not its moment
    const isCut = filters.range[0] > 0 || filters.range[1] < 1;
    const greatest = step.near ? step.contacts.greatest : 1;
    byId("range-clear").hidden = !isCut;
    byId("range-clear").textContent = `${filters.range.map((t) => digits(t * greatest)).join(" – ")}  ✕`;
    const measure = measureOf(step);
    byId("histogram").hidden = measure === null || greatest === 0;
    byId("order-box").hidden = measure === null || greatest === 0;
    byId("copy-list").hidden = measure?.name !== "time" || picked.length === 0;
    byId("copy-list").textContent = "Copy the list";
    byId("order").options[0].textContent = measure?.name ?? "time";
    const all = step.contacts.count;
    const { unknown, missing, own } = readWords(filters.find, step.objects);
    const ownCount = own ? picked.filter((i) => ["a", "b"].some((side) => own(sideOf(step, i, side)))).length : picked.length;
    const others = picked.length - ownCount;
    const hint = unknown.length > 0 ? `: no object is called “${unknown[0]}”; find vertex 3, edge 4-7, face 12, vf, t<0.5, a name`
      : missing ? `: ${missing}`
      : picked.length === 0 ? "" : `: ${isTouched ? "tap" : "click"} a row to see it`;
    byId("picked").textContent = step.answer.status !== "OK" ? "none: it was not answered" : `${picked.length === all ? "" : `${count(picked.length)} of `}${plural(all, ...nounOf(step))}${picked.length === all || data.all.length === 1 ? "" : ` in this ${step.near ? "question" : "step"}`}${others > 0 ? `, ${count(ownCount)} of the vertex itself, ${count(others)} of its edges and faces` : ""}${hint}`;
  });
  makeGoing(data, state, does);
  makeHistogram(data, state);
  makeList(data, state, does.fly);
}
