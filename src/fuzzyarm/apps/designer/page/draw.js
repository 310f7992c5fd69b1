// What several panes draw with: elements, colours, numbers as text, canvases.

const UNSEEN = /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u200e\u200f\u2028-\u202e\u2066-\u2069]/g;

/** A text without controls and without marks that turn the direction of what follows. */
export function clean(text) {
  return String(text).replace(UNSEEN, "\ufffd");
}

const cleaned = (children) => children.map((each) => (typeof each === "string" ? clean(each) : each));

/** An element with properties and children; text is only ever text. */
export function el(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key === "class") made.className = value;
    else if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key === "textContent" || key === "title") made[key] = clean(value);
    else if (key in made && key !== "list") made[key] = value;
    else made.setAttribute(key, typeof value === "string" ? clean(value) : value);
  }
  made.append(...cleaned(children));
  return made;
}

export function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key === "style")
      made.style.cssText = value; // an attribute would be refused
    else made.setAttribute(key, value);
  }
  made.append(...cleaned(children));
  return made;
}

/**
 * Remember the focus within what is built anew; what comes back puts it where it was: on the same element,
 * or on the one that has its `data-key` now.
 */
export function keepFocus(root) {
  const held = /** @type {HTMLInputElement} */ (document.activeElement);
  if (!held || held === document.body || !root.contains(held)) return () => {};
  const { key } = held.dataset;
  const chosen = typeof held.selectionStart === "number" ? [held.selectionStart, held.selectionEnd] : null;
  return () => {
    const same = () => [...root.querySelectorAll("[data-key]")].find((each) => each.dataset.key === key);
    const next = held.isConnected ? held : key && same();
    if (!next || next === document.activeElement) return;
    next.focus({ preventScroll: true });
    if (chosen) next.setSelectionRange(...chosen);
  };
}

/** A pane with a title bar; returns its parts. */
export function pane(kind, title) {
  const id = `title-${kind}`;
  const bar = el("div", { class: "bar" }, el("h2", { id, textContent: title }));
  const body = el("div", { class: "body" });
  const section = el("section", { class: `pane ${kind}`, "aria-labelledby": id, tabIndex: -1 }, bar, body);
  return { section, bar, body };
}

/** Choices, each of them its own words. */
export const pairsOf = (words) => words.map((word) => /** @type {[string, string]} */ ([word, word]));

/** The point of several variables in words. */
export const placeWords = (at, digits = 5) =>
  Object.entries(at)
    .map(([name, x]) => `${name} = ${shortNumber(x, digits)}`)
    .join(", ");

/** Printed words in which the name of an option, as `--levels`, does not break at its hyphens. */
export const printed = (words) =>
  words.split(/(--[a-z][\w-]*)/).map((part, i) => (i % 2 ? el("span", { class: "option", textContent: part }) : part));

/** What keeps the tools behind it at the end of a bar. */
export const space = () => el("span", { class: "space" });

/** Fill a list with pairs of a value and its words; what was chosen stays where it still is. */
export function refill(list, options, chosen = list.value) {
  list.replaceChildren(...options.map(([value, text]) => el("option", { value, textContent: text })));
  if (options.some(([value]) => value === chosen)) list.value = chosen;
}

/** A list to choose from. */
export function select(options, chosen, properties = {}) {
  const list = el("select", properties);
  refill(list, options, chosen);
  return list;
}

/** The same with its label, for the bar of a pane. */
export function choice(label, options, chosen, onchange) {
  const list = select(options, chosen, { "data-key": label, onchange: () => onchange(list.value) });
  return el("label", { class: "small" }, label, list);
}

/** A slider along a range; `act` hears of its value while it moves. */
export function slider([low, high], act, properties = {}) {
  const looks = { type: "range", min: low, max: high, step: (high - low) / SLIDER_STEPS, ...properties };
  const range = el("input", { ...looks, oninput: () => act(Number(range.value)) });
  return range;
}

const SLIDER_STEPS = 400;

/** The number that a text is; NaN where it is none. */
export const readNumber = (text) => Number(text.trim() || NaN);

/** An input for a number, with room for what is wrong with it. */
export function numberInput(properties) {
  const input = el("input", { type: "text", inputMode: "decimal", ...properties });
  return { input, typed: el("span", { class: "typed" }, input) };
}

let wrongs = 0;

/**
 * Say beside a control, in the element around it, what is wrong with its value, which stays; without words take it back.
 *
 * @param {HTMLElement} input
 */
export function sayWrong(input, words = "") {
  const holder = input.parentElement;
  holder.querySelector(":scope > .wrong")?.remove();
  if (!words) {
    input.removeAttribute("aria-invalid");
    input.removeAttribute("aria-describedby");
    return;
  }
  const id = `wrong-${++wrongs}`;
  input.setAttribute("aria-invalid", "true");
  input.setAttribute("aria-describedby", id);
  const wrong = el("span", { class: "wrong", id, role: "alert", textContent: words });
  holder.append(wrong);
  const room = holder.closest(".pane, dialog").getBoundingClientRect().right - 9;
  const beyond = wrong.getBoundingClientRect().right - room;
  if (beyond > 0) wrong.style.left = `${-beyond}px`;
}

/** A control with its label above it. */
export const field = (label, input) => el("label", { class: "field" }, el("span", { textContent: label }), input);

/**
 * A table; the first cell of a row is its head. A cell or a row may be an element that stands there as it is.
 *
 * @param {{ class?: string, caption?: any, head?: any[], rows: any[] }} parts
 */
export function tableOf({ class: kind = "", caption, head, rows }) {
  const cell = (name, content, properties = {}) =>
    content instanceof HTMLTableCellElement ? content : el(name, properties, content);
  const headCell = (scope, content) => (content === "" ? el("td") : cell("th", content, { scope }));
  const row = ([first, ...others]) =>
    el("tr", {}, headCell("row", first), ...others.map((content) => cell("td", content)));
  return el(
    "table",
    { class: kind },
    ...(caption ? [caption instanceof HTMLTableCaptionElement ? caption : el("caption", {}, caption)] : []),
    ...(head ? [el("thead", {}, el("tr", {}, ...head.map((content) => headCell("col", content))))] : []),
    el("tbody", {}, ...rows.map((cells) => (cells instanceof Node ? cells : row(cells)))),
  );
}

/** Where the arrow keys lead: to the right and up. */
export const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** What is written on a canvas: numbers and labels, words, the names of axes. */
export const FONTS = {
  small: "11px system-ui, sans-serif",
  words: "13px system-ui, sans-serif",
  bold: "600 12px system-ui, sans-serif",
};

/** A number to so many significant digits, without zeros that say nothing. */
export function shortNumber(x, digits = 4) {
  if (!Number.isFinite(x)) return "–";
  return String(Number(x.toPrecision(digits)));
}

const LONG = 6; // characters beside an axis

/** A number beside an axis: short, with a power of ten where it would be long. */
export function tickNumber(x, digits = 4) {
  const said = shortNumber(x, digits);
  if (said.length <= LONG) return said;
  const power = x
    .toExponential(digits - 1)
    .replace(/\.?0+e/, "e")
    .replace("e+", "e");
  return power.length < said.length ? power : said;
}

const HUES = [
  ["#2563a8", "#74b3f7"],
  ["#b34e14", "#ff9e63"],
  ["#1f7a4a", "#66cf97"],
  ["#a23b8f", "#ec8fdc"],
  ["#7a6000", "#dcbf45"],
  ["#0b7484", "#58cfe0"],
  ["#b3343f", "#ff8e97"],
  ["#5f50c0", "#b3a8ff"],
].map((pair) => `light-dark(${pair.join(", ")})`);

export function hue(index) {
  return HUES[index % HUES.length];
}

const STOPS = [
  [68, 1, 84],
  [71, 44, 122],
  [59, 81, 139],
  [44, 113, 142],
  [33, 144, 141],
  [39, 173, 129],
  [92, 200, 99],
  [170, 220, 50],
  [253, 231, 37],
];

/** The colours of surfaces: from dark to light, told apart by people who see no red or green. */
export const SHADES = Array.from({ length: 256 }, (_, i) => {
  const at = (i / 255) * (STOPS.length - 1);
  const low = Math.min(Math.floor(at), STOPS.length - 2);
  return STOPS[low].map((c, k) => Math.round(c + (at - low) * (STOPS[low + 1][k] - c)));
});

/** The colours of rules: blue below the middle of the range, red above it. */
export function heatOf(share) {
  const t = Math.max(-1, Math.min(1, 2 * share - 1));
  const strength = 0.85 * Math.abs(t);
  return (t < 0 ? [33, 102, 172] : [178, 24, 43]).map((c) => Math.round(247 + strength * (c - 247)));
}

/** The same as a style sheet has it, and the colour of a text on it. */
export function heat(share) {
  const colour = heatOf(share);
  return [`rgb(${colour.join(" ")})`, inkOn(colour)];
}

/** Black or white, whichever has more contrast. */
export const inkOn = (colour) => (luminance(colour) < 0.18 ? "#ffffff" : "#000000");

/** How much light a colour reflects, 0 to 1, as accessibility rules weigh it. */
function luminance(colour) {
  const [r, g, b] = colour.map((c) => (c <= 10 ? c / 3294 : ((c / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** The drawing context of a canvas that covers so much of the screen. */
export function context(canvas, width, height) {
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  return { g, width, height };
}

export function colourOf(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Call a function once before the next frame, however often it is asked for. */
export function eachFrame(draw) {
  let asked = 0;
  return () => {
    asked ||= requestAnimationFrame(() => {
      asked = 0;
      draw();
    });
  };
}
