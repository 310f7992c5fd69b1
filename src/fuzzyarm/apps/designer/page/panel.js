// Panels of pictures, drawn on a canvas: the page's renderer beside those for print and for the terminal. What there is
// to be seen, and between which ends, is said by Python (fuzzyarm.base.picture); here are pixels and colours.

import { clean, colourOf, context, FONTS, heatOf, hue, inkOn, SHADES, tickNumber } from "./draw.js";
import { edgesOf, layoutOf, ROOM, scaleOf, shareOf, strokesOf, ticksOf, wordsOf } from "./geometry/panel.js";
import { crossings, spotsOf } from "./geometry/surface.js";

/** @typedef {Messages.PanelData} PanelData */

const DASHES = { "-": [], "--": [6, 4], "-.": [8, 3, 2, 3], ":": [2, 3] };
const SMOOTH = 40; // so many samples along an axis are a surface, not cells to be read
const POINT = 1.3; // pixels of a point of print
const BAR = 9; // pixels across
const LEVELS = 9; // that are drawn of a surface
const NARROWEST = 0.75; // of the usual width of letters
const ABOVE_NAME = 20; // pixels between a plot and the name below it, with the numbers
const MARGIN = 4; // pixels between a text and the edge of the picture

const HEATS = Array.from({ length: 256 }, (_, i) => heatOf(i / 255));

/** A place that is marked, as a part of a panel. */
export const markAt = ([x, y]) => ({ is: "dots", x: [x], y: [y], sign: "+", size: 6, tone: "mark" });

/** The same over one axis. */
export const levelAt = (at) => ({ is: "level", at, upright: true, tone: "ink", width: 0.8, dash: "-" });

/**
 * Draw a panel over a whole canvas; nothing while it is not shown. Returns where its plot lies.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {PanelData} panel
 */
export function drawPanel(canvas, panel) {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  return width && height ? paintPanel(context(canvas, width, height), panel, tonesOf(canvas)) : null;
}

/** The colours by what they stand for, as the theme has them now. */
function tonesOf(canvas) {
  const probe = canvas.ownerDocument.createElement("i");
  canvas.after(probe);
  const known = new Map();
  const find = (tone) => {
    if (tone.startsWith("#")) return tone;
    if (!tone.startsWith("series")) return colourOf(`--run-${tone}`) || colourOf(`--${tone}`) || colourOf("--ink");
    probe.style.color = hue(Number(tone.slice(6)));
    return getComputedStyle(probe).color;
  };
  const colours = (tone) => known.get(tone) ?? known.set(tone, find(tone)).get(tone);
  return Object.assign(colours, { done: () => probe.remove() });
}

function paintPanel({ g, width, height }, panel, tone) {
  const heads = headsOf(g, panel, width);
  const labels = legendOf(g, panel, width, Math.max(0, heads.length - 1));
  const rows = labels.length ? labels.at(-1).row + 1 : Math.max(0, heads.length - 1);
  const layout = layoutOf(panel, width, height, rows, leftOf(g, panel, layoutOf(panel, width, height, rows)));
  const paper = { g, ...layout, panel, heads, labels, width, tone };
  const { inside } = layout;
  const cells = panel.parts.find((part) => part.is === "cells");
  title(paper);
  axes(paper, !cells);
  g.save();
  g.beginPath();
  g.rect(inside.left - 1, inside.top - 1, inside.right - inside.left + 2, inside.bottom - inside.top + 2);
  g.clip();
  for (const part of panel.parts) {
    g.globalAlpha = part.opacity ?? 1;
    PARTS[part.is](paper, part);
    g.globalAlpha = 1;
  }
  g.restore();
  if (layout.hasBar) bar(paper, cells);
  legend(paper);
  tone.done();
  return layout;
}

/** The numbers beside the axis that goes up. */
const upTicks = ({ up }, { top, bottom }) => ticksOf(up, Math.max(2, (bottom - top) / 40));

/** The room that they take, with the name of the axis beside them. */
function leftOf(g, panel, { inside }) {
  g.font = FONTS.small;
  const widths = upTicks(panel, inside).map((value) => g.measureText(tickNumber(value)).width);
  return Math.max(ROOM.left, ROOM.name + Math.max(0, ...widths));
}

/**
 * The lines of a title: broken at blanks, and within a word that is wider than the picture.
 *
 * @returns {string[]}
 */
function headsOf(g, panel, width) {
  g.font = FONTS.bold;
  const room = width - ROOM.left - MARGIN;
  const lines = [""];
  const add = (piece) => {
    const longer = lines.at(-1) + piece;
    if (g.measureText(longer).width <= room || !lines.at(-1)) lines.splice(-1, 1, longer);
    else lines.push(piece.trimStart());
  };
  for (const word of clean(panel.title).split(/(?= )/)) {
    if (g.measureText(word).width <= room) add(word);
    else [...word].forEach(add);
  }
  return lines.filter(Boolean);
}

function title({ g, heads, width }) {
  g.fillStyle = colourOf("--ink");
  g.font = FONTS.bold;
  g.textAlign = "left";
  heads.forEach((line, i) => g.fillText(line, ROOM.left, 15 + ROOM.row * i, width - ROOM.left));
}

/** A name that fits into some room in narrower letters; where these could not be read, with dots in its middle. */
export function fitted(g, words, room) {
  let said = clean(words);
  for (let kept = said.length - 1; kept > 4 && NARROWEST * g.measureText(said).width > room; kept--)
    said = `${clean(words).slice(0, Math.ceil(kept / 2))}…${clean(words).slice(-Math.floor(kept / 2))}`;
  return said;
}

/** Write a name in some room. */
const writeName = (g, words, x, y, room) => g.fillText(fitted(g, words, room), x, y, room);

/** Numbers along both axes, their names, and rulings where no cells are. */
function axes({ g, inside, panel, toX, toY, width }, ruled) {
  const { left, right, top, bottom } = inside;
  g.font = FONTS.small;
  g.fillStyle = colourOf("--soft");
  g.strokeStyle = colourOf("--line");
  g.lineWidth = 1;
  g.textAlign = "right";
  for (const value of upTicks(panel, inside)) {
    const y = Math.round(toY(value)) + 0.5;
    if (ruled) g.strokeRect(left, y, right - left, 0);
    g.fillText(tickNumber(value), left - 5, y + 4);
  }
  g.textAlign = "center";
  for (const value of ticksOf(panel.across, Math.max(2, (right - left) / 58))) {
    g.fillText(tickNumber(value), toX(value), bottom + 14);
  }
  g.font = FONTS.bold;
  writeName(g, panel.across.words, (left + right) / 2, bottom + 30, roomAround((left + right) / 2, width));
  g.save();
  g.translate(11, (top + bottom) / 2);
  g.rotate(-Math.PI / 2);
  writeName(g, panel.up.words, 0, 0, roomAround((top + bottom) / 2, bottom + ABOVE_NAME));
  g.restore();
}

/** How long a text may be that has its middle somewhere. */
const roomAround = (middle, whole) => 2 * Math.min(middle, whole - middle) - 2 * MARGIN;

const PARTS = {
  line({ g, toX, toY, tone }, { x, y, steps, width, dash, tone: colour }) {
    g.strokeStyle = tone(colour);
    g.lineWidth = POINT * width;
    g.setLineDash(DASHES[dash] ?? []);
    g.beginPath();
    for (const stroke of strokesOf(x, y, steps)) trace(g, stroke, toX, toY);
    g.stroke();
    g.setLineDash([]);
  },
  area({ g, toX, toY, tone }, { x, y, tone: colour }) {
    g.fillStyle = tone(colour);
    g.beginPath();
    for (const stroke of strokesOf(x, y)) trace(g, stroke, toX, toY);
    g.fill();
  },
  band(paper, { x, low, high, ...part }) {
    const around = { x: [...x, ...x.toReversed()], y: [...high, ...low.toReversed()] };
    PARTS.area(paper, /** @type {any} */ ({ ...part, ...around }));
  },
  level({ g, inside, toX, toY, tone }, { at, upright, width, dash, tone: colour }) {
    g.strokeStyle = tone(colour);
    g.lineWidth = POINT * width;
    g.setLineDash(DASHES[dash] ?? []);
    g.beginPath();
    g.moveTo(upright ? toX(at) : inside.left, upright ? inside.top : toY(at));
    g.lineTo(upright ? toX(at) : inside.right, upright ? inside.bottom : toY(at));
    g.stroke();
    g.setLineDash([]);
  },
  dots({ g, toX, toY, tone }, { x, y, sign, size, tone: colour }) {
    g.fillStyle = g.strokeStyle = tone(colour);
    g.lineWidth = 1.2;
    const draw = SIGNS[sign] ?? SIGNS["."];
    x.forEach((each, i) => each !== null && y[i] !== null && draw(g, toX(each), toY(y[i]), 0.5 * POINT * size));
  },
  cells(paper, part) {
    const columns = part.x.length;
    if (columns <= SMOOTH || part.y.length * columns !== part.values.length) cells(paper, part);
    else {
      samples(paper, part);
      if (!part.signed) levels(paper, part);
    }
  },
};

const SIGNS = {
  ".": (g, x, y, r) => g.fillRect(x - r, y - r, 2 * r, 2 * r),
  o(g, x, y, r) {
    g.beginPath();
    g.arc(x, y, r, 0, 2 * Math.PI);
    g.fill();
  },
  x: diagonal,
  X: diagonal,
  "+": (g, x, y) => cross(g, x, y),
};

function diagonal(g, x, y, r) {
  g.beginPath();
  g.moveTo(x - r, y - r);
  g.lineTo(x + r, y + r);
  g.moveTo(x - r, y + r);
  g.lineTo(x + r, y - r);
  g.stroke();
}

/** A place that is seen on any colour. */
function cross(g, x, y) {
  for (const [width, colour] of [
    [4.5, "#ffffff"],
    [2, "#000000"],
  ]) {
    g.strokeStyle = colour;
    g.lineWidth = width;
    g.beginPath();
    g.arc(x, y, 6, 0, 2 * Math.PI);
    g.moveTo(x - 10, y);
    g.lineTo(x + 10, y);
    g.moveTo(x, y - 10);
    g.lineTo(x, y + 10);
    g.stroke();
  }
}

function trace(g, stroke, toX, toY) {
  stroke.forEach(([x, y], i) => (i ? g.lineTo(toX(x), toY(y)) : g.moveTo(toX(x), toY(y))));
}

const shadeOf = (value, { value: axis, signed }) => (signed ? HEATS : SHADES)[Math.round(255 * shareOf(value, axis))];

/** Samples of a surface, a pixel each, which the canvas draws larger. */
function samples({ g, toX, toY }, part) {
  const { x, y, values } = part;
  const [wide, tall] = [x.length, y.length];
  const colours = new ImageData(wide, tall);
  values.forEach((value, k) => {
    const row = part.downward ? Math.floor(k / wide) : tall - 1 - Math.floor(k / wide);
    if (value !== null) colours.data.set([...shadeOf(value, part), 255], 4 * (row * wide + (k % wide)));
  });
  const small = new OffscreenCanvas(wide, tall);
  small.getContext("2d").putImageData(colours, 0, 0);
  const [left, right] = [toX(x[0]), toX(x.at(-1))];
  const [top, bottom] = [toY(y[0]), toY(y.at(-1))].toSorted((a, b) => a - b);
  // Pixels stand for points: the outer half of the outer ones lies beyond the range.
  g.drawImage(small, 0.5, 0.5, wide - 1, tall - 1, left, top, right - left, bottom - top);
}

/** Lines where a surface has round values, with their numbers. */
function levels({ g, inside, panel, toX, toY }, { x, y, values, value }) {
  const last = [x.length - 1, y.length - 1];
  const spotOf = ([i, j]) => [
    toX(x[0] + ((x[last[0]] - x[0]) * i) / last[0]),
    toY(y[0] + ((y[last[1]] - y[0]) * j) / last[1]),
  ];
  const numbers = values.map((each) => each ?? NaN);
  const named = [];
  // A cross that is drawn later would cover them.
  const crosses = panel.parts.filter((part) => part.is === "dots" && part.sign === "+");
  const marked = crosses.flatMap((part) => part.x.map((each, i) => [toX(each), toY(part.y[i])]));
  g.font = FONTS.small;
  g.strokeStyle = "rgb(255 255 255 / 0.75)";
  g.lineWidth = 1;
  g.beginPath();
  for (const level of ticksOf(value, LEVELS)) {
    if (level <= value.low || level >= value.high) continue;
    const segments = crossings(numbers, x.length, level, y.length).map((ends) => ends.map(spotOf));
    for (const [from, to] of segments) {
      g.moveTo(...from);
      g.lineTo(...to);
    }
    spotsOf(
      segments.map(([from]) => from),
      inside,
      [...marked, ...named.map(({ spot }) => spot)],
      0.5 * g.measureText(tickNumber(level)).width,
    ).forEach((spot) => named.push({ spot, level }));
  }
  g.stroke();
  g.textAlign = "center";
  g.lineWidth = 3;
  g.strokeStyle = "rgb(0 0 0 / 0.7)";
  g.fillStyle = "#ffffff";
  for (const { spot, level } of named) {
    g.strokeText(tickNumber(level), spot[0], spot[1] + 4);
    g.fillText(tickNumber(level), spot[0], spot[1] + 4);
  }
}

/**
 * A scale of colours, the greatest value on top, with numbers beside it.
 *
 * @param {CanvasRenderingContext2D} g
 * @param {number[]} box left, top, width and height
 * @param {{ low: number, high: number }} axis
 * @param {{ isSigned?: boolean, right?: boolean, apart?: number, digits?: number }} looks
 *   whether numbers stand on the right, how far apart, in how many digits
 */
export function paintScale(g, [left, top, wide, tall], axis, { isSigned, right, apart = 40, digits }) {
  for (let row = 0; row < tall; row++) {
    g.fillStyle = `rgb(${(isSigned ? HEATS : SHADES)[Math.round(255 * (1 - row / tall))].join(" ")})`;
    g.fillRect(left, top + row, wide, 1.5);
  }
  const toY = scaleOf(axis, top + tall, top);
  g.fillStyle = colourOf("--soft");
  g.font = FONTS.small;
  g.textAlign = right ? "left" : "right";
  for (const tick of ticksOf(axis, Math.max(2, tall / apart)))
    g.fillText(tickNumber(tick, digits), right ? left + wide + 4 : left - 4, toY(tick) + 4);
}

/** What the colours stand for, beside the plot. */
function bar({ g, inside, width }, { value, signed }) {
  const { right, top, bottom } = inside;
  paintScale(g, [right + 10, top, BAR, bottom - top], value, { isSigned: signed, right: true, digits: 3 });
  g.save();
  g.translate(width - 5, (top + bottom) / 2);
  g.rotate(-Math.PI / 2);
  g.textAlign = "center";
  writeName(g, value.words, 0, 0, roomAround((top + bottom) / 2, bottom + ABOVE_NAME));
  g.restore();
}

/** Stripes where a cell has no value and that means something; they meet those of its neighbours. */
function hatch(g, x0, y0, x1, y1) {
  g.save();
  g.beginPath();
  g.rect(x0, y0, x1 - x0, y1 - y0);
  g.clip();
  g.strokeStyle = colourOf("--soft");
  g.globalAlpha = 0.4;
  g.lineWidth = 1;
  g.beginPath();
  for (let c = Math.floor((x0 - y1) / 6) * 6; c < x1 - y0; c += 6) {
    g.moveTo(y0 + c, y0);
    g.lineTo(y1 + c, y1);
  }
  g.stroke();
  g.restore();
}

/** Cells with a number each, where there is room for it. */
function cells({ g, toX, toY }, part) {
  const { x, y, values } = part;
  const isEdged = values.length === (x.length - 1) * (y.length - 1);
  const [columns, rows] = isEdged ? [x.length - 1, y.length - 1] : [x.length, y.length];
  const [across, up] = [edgesOf(x, columns), edgesOf(y, rows)];
  g.font = FONTS.small;
  g.textAlign = "center";
  const gap = Math.abs(toX(across[columns]) - toX(across[0])) > 6 * columns ? 0.5 : -0.5; // small cells leave none
  values.forEach((value, k) => {
    const [i, j] = [k % columns, Math.floor(k / columns)];
    const [x0, x1] = [toX(across[i]), toX(across[i + 1])];
    const [y0, y1] = [toY(up[j]), toY(up[j + 1])].toSorted((a, b) => a - b);
    const isBare = value === null || part.bare?.[k];
    if (isBare && part.missing) hatch(g, x0, y0, x1, y1);
    if (value === null || (isBare && !value)) return;
    const shade = shadeOf(value, part);
    if (!isBare) {
      g.fillStyle = `rgb(${shade.join(" ")})`;
      g.fillRect(x0, y0, x1 - x0 - gap, y1 - y0 - gap);
    }
    const said = wordsOf(value, part.value).find((each) => g.measureText(each).width <= x1 - x0 - 2);
    if (!said || y1 - y0 < 12) return;
    g.fillStyle = isBare ? colourOf("--ink") : inkOn(shade);
    g.fillText(said, (x0 + x1) / 2, (y0 + y1) / 2 + 4);
  });
}

/**
 * Where the labels stand: in rows between title and plot.
 *
 * @returns {Array<{ part: any, x: number, row: number }>}
 */
function legendOf(g, panel, width, first) {
  g.font = FONTS.small;
  let [x, row] = [ROOM.left, first];
  return panel.parts
    .filter((part) => part.label || part.missing)
    .map((part) => {
      const wide = 34 + g.measureText(clean(part.label || part.missing)).width + 10;
      if (x > ROOM.left && x + wide > width - ROOM.right) [x, row] = [ROOM.left, row + 1];
      const place = { part, x, row };
      x += wide;
      return place;
    });
}

/** What the labels say. */
function legend({ g, labels, panel, tone, width }) {
  g.font = FONTS.small;
  g.textAlign = "left";
  for (const { part, x, row } of labels) {
    const y = ROOM.top + (panel.title ? ROOM.title : 0) + ROOM.row * row + 4;
    key(g, part, x, y, tone);
    g.fillStyle = colourOf("--ink");
    writeName(g, part.label || part.missing, x + 30, y + 4, width - x - 30 - MARGIN);
  }
}

/** What a part looks like, beside its label. */
function key(g, part, x, y, tone) {
  if (part.is === "cells") return hatch(g, x, y - 5, x + 24, y + 5);
  g.fillStyle = g.strokeStyle = tone(part.tone);
  g.globalAlpha = part.opacity ?? 1;
  if (part.is === "area" || part.is === "band") g.fillRect(x, y - 5, 24, 10);
  else if (part.is === "dots") (SIGNS[part.sign] ?? SIGNS["."])(g, x + 12, y, 0.5 * POINT * Math.max(4, part.size));
  else {
    g.lineWidth = 2;
    g.setLineDash(DASHES[part.dash] ?? []);
    g.beginPath();
    g.moveTo(x, y);
    g.lineTo(x + 24, y);
    g.stroke();
    g.setLineDash([]);
  }
  g.globalAlpha = 1;
}
