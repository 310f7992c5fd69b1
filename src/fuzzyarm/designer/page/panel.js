// Panels of pictures, drawn on a canvas: the page's renderer beside those for print and for the terminal. What there is
// to be seen, and between which ends, is said by Python (fuzzyarm.picture); here are pixels and colours.

import { clean, colourOf, context, heat, hue, SHADES, shortNumber } from "./draw.js";
import { edgesOf, scaleOf, shareOf, strokesOf, ticksOf } from "./geometry/panel.js";

/** @typedef {Messages.PanelData} PanelData */

const ROOM = { left: 52, right: 12, top: 10, title: 16, bottom: 36 };
const ROW = 15; // of labels
const LABELS = "11px system-ui, sans-serif";
const DASHES = { "-": [], "--": [6, 4], "-.": [8, 3, 2, 3], ":": [2, 3] };
const SMOOTH = 40; // so many samples along an axis are a surface, not cells to be read
const POINT = 1.3; // pixels of a point of print

const numbersOf = (colour) => colour.match(/\d+/g).slice(0, 3).map(Number);
const HEATS = Array.from({ length: 256 }, (_, i) => numbersOf(heat(i / 255)[0]));

/** A place that is marked, as a part of a panel. */
export const markAt = ([x, y]) => ({ is: "dots", x: [x], y: [y], sign: "+", size: 6, tone: "mark" });

/** The same over one axis. */
export const levelAt = (at) => ({ is: "level", at, upright: true, tone: "ink", width: 0.8, dash: "-" });

/**
 * Draw a panel over a whole canvas; nothing while it is not shown.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {PanelData} panel
 */
export function drawPanel(canvas, panel) {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (width && height) paintPanel(context(canvas, width, height), panel, tonesOf(canvas));
}

/** The colours by what they stand for, as the theme has them now. */
function tonesOf(canvas) {
  const probe = canvas.ownerDocument.createElement("i");
  canvas.after(probe);
  const known = new Map();
  const find = (tone) => {
    if (tone.startsWith("#")) return tone;
    if (!tone.startsWith("series")) return colourOf(`--run-${tone}`) || colourOf("--ink");
    probe.style.color = hue(Number(tone.slice(6)));
    return getComputedStyle(probe).color;
  };
  const colours = (tone) => known.get(tone) ?? known.set(tone, find(tone)).get(tone);
  return Object.assign(colours, { done: () => probe.remove() });
}

function paintPanel({ g, width, height }, panel, tone) {
  const labels = legendOf(g, panel, width);
  const rows = labels.length ? labels.at(-1).row + 1 : 0;
  const top = ROOM.top + (panel.title ? ROOM.title : 0) + ROW * rows;
  const inside = { left: ROOM.left, top, right: width - ROOM.right, bottom: height - ROOM.bottom };
  const toX = scaleOf(panel.across, inside.left, inside.right);
  const toY = scaleOf(panel.up, inside.bottom, inside.top);
  const paper = { g, inside, panel, labels, toX, toY, tone };
  const isPlane = panel.parts.some((part) => part.is === "cells");
  title(paper);
  axes(paper, !isPlane);
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
  legend(paper);
  tone.done();
}

function title({ g, inside, panel }) {
  g.fillStyle = colourOf("--ink");
  g.font = "600 12px system-ui, sans-serif";
  g.textAlign = "left";
  g.fillText(clean(panel.title), inside.left, 15, inside.right - inside.left);
}

/** Numbers along both axes, their names, and rulings where no cells are. */
function axes({ g, inside, panel, toX, toY }, ruled) {
  const { left, right, top, bottom } = inside;
  g.font = "11px system-ui, sans-serif";
  g.fillStyle = colourOf("--soft");
  g.strokeStyle = colourOf("--line");
  g.lineWidth = 1;
  g.textAlign = "right";
  for (const value of ticksOf(panel.up, Math.max(2, (bottom - top) / 40))) {
    const y = Math.round(toY(value)) + 0.5;
    if (ruled) g.strokeRect(left, y, right - left, 0);
    g.fillText(shortNumber(value), left - 5, y + 4);
  }
  g.textAlign = "center";
  for (const value of ticksOf(panel.across, Math.max(2, (right - left) / 70))) {
    g.fillText(shortNumber(value), toX(value), bottom + 14);
  }
  g.font = "600 12px system-ui, sans-serif";
  g.fillText(clean(panel.across.words), (left + right) / 2, bottom + 30, right - left);
  g.save();
  g.translate(11, (top + bottom) / 2);
  g.rotate(-Math.PI / 2);
  g.fillText(clean(panel.up.words), 0, 0, bottom - top);
  g.restore();
}

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
    if (columns > SMOOTH && part.y.length * columns === part.values.length) samples(paper, part);
    else cells(paper, part);
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
    const row = tall - 1 - Math.floor(k / wide);
    if (value !== null) colours.data.set([...shadeOf(value, part), 255], 4 * (row * wide + (k % wide)));
  });
  const small = new OffscreenCanvas(wide, tall);
  small.getContext("2d").putImageData(colours, 0, 0);
  const [left, right, bottom, top] = [toX(x[0]), toX(x.at(-1)), toY(y[0]), toY(y.at(-1))];
  // Pixels stand for points: the outer half of the outer ones lies beyond the range.
  g.drawImage(small, 0.5, 0.5, wide - 1, tall - 1, left, top, right - left, bottom - top);
}

/** Cells with a number each, where there is room for it. */
function cells({ g, toX, toY }, part) {
  const { x, y, values } = part;
  const isEdged = values.length === (x.length - 1) * (y.length - 1);
  const [columns, rows] = isEdged ? [x.length - 1, y.length - 1] : [x.length, y.length];
  const [across, up] = [edgesOf(x, columns), edgesOf(y, rows)];
  g.font = "11px system-ui, sans-serif";
  g.textAlign = "center";
  values.forEach((value, k) => {
    if (value === null) return;
    const [i, j] = [k % columns, Math.floor(k / columns)];
    const [x0, x1, y0, y1] = [toX(across[i]), toX(across[i + 1]), toY(up[j + 1]), toY(up[j])];
    const shade = shadeOf(value, part);
    g.fillStyle = `rgb(${shade.join(" ")})`;
    g.fillRect(x0, y0, x1 - x0 - 0.5, y1 - y0 - 0.5);
    const said = shortNumber(value, 2);
    if (x1 - x0 < 8 * said.length || y1 - y0 < 13) return;
    g.fillStyle = inkOn(shade);
    g.fillText(said, (x0 + x1) / 2, (y0 + y1) / 2 + 4);
  });
}

/** Black or white, whichever has more contrast. */
const inkOn = ([r, g, b]) =>
  0.2126 * r ** 2.2 + 0.7152 * g ** 2.2 + 0.0722 * b ** 2.2 < 0.18 * 255 ** 2.2 ? "#fff" : "#000";

/**
 * Where the labels stand: in rows between title and plot.
 *
 * @returns {Array<{ part: any, x: number, row: number }>}
 */
function legendOf(g, panel, width) {
  g.font = LABELS;
  let [x, row] = [ROOM.left, 0];
  return panel.parts
    .filter((part) => part.label)
    .map((part) => {
      const wide = 34 + g.measureText(clean(part.label)).width + 10;
      if (x > ROOM.left && x + wide > width - ROOM.right) [x, row] = [ROOM.left, row + 1];
      const place = { part, x, row };
      x += wide;
      return place;
    });
}

/** What the labels say. */
function legend({ g, labels, panel, tone }) {
  g.font = LABELS;
  g.textAlign = "left";
  for (const { part, x, row } of labels) {
    const y = ROOM.top + (panel.title ? ROOM.title : 0) + ROW * row + 4;
    g.strokeStyle = tone(part.tone);
    g.lineWidth = part.is === "dots" ? 4 : 2;
    g.setLineDash(part.is === "dots" ? [3, 5] : (DASHES[part.dash] ?? []));
    g.beginPath();
    g.moveTo(x, y);
    g.lineTo(x + 24, y);
    g.stroke();
    g.setLineDash([]);
    g.fillStyle = colourOf("--ink");
    g.fillText(clean(part.label), x + 30, y + 4);
  }
}
