// A surface as numbers: how it is turned, what covers what, where it has a level. No drawing, no elements.

import { axisOf } from "./panel.js";

/** Fill a triangle of an image of 32-bit pixels. */
export function fillTriangle(pixels, width, height, x0, y0, x1, y1, x2, y2, colour) {
  if (y1 < y0) [x0, y0, x1, y1] = [x1, y1, x0, y0];
  if (y2 < y0) [x0, y0, x2, y2] = [x2, y2, x0, y0];
  if (y2 < y1) [x1, y1, x2, y2] = [x2, y2, x1, y1];
  const end = Math.min(height, Math.ceil(y2 - 0.5));
  for (let row = Math.max(0, Math.ceil(y0 - 0.5)); row < end; row++) {
    const y = row + 0.5;
    const a = x0 + ((x2 - x0) * (y - y0)) / (y2 - y0);
    const b = y < y1 ? x0 + ((x1 - x0) * (y - y0)) / (y1 - y0) : x1 + ((x2 - x1) * (y - y1)) / (y2 - y1);
    const from = row * width + Math.max(0, Math.ceil((a < b ? a : b) - 0.5));
    const to = row * width + Math.min(width, Math.ceil((a < b ? b : a) - 0.5));
    for (let at = from; at < to; at++) pixels[at] = colour;
  }
}

/** The ends of the colours: those of the output, or of the values where it has none. */
export function limitsOf(z, output) {
  let [low, high] = [output.low, output.high];
  if (low === null || high === null) {
    [low, high] = [Infinity, -Infinity];
    for (const value of z) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low < high ? [low, high] : [low - 1, low + 1];
}

const numbersOf = (values) => Array.from(values, (value) => (Number.isFinite(value) ? value : null));

/**
 * An output over one input as a panel, with the point.
 *
 * @param {{ xs: ArrayLike<number>, z: ArrayLike<number> }} line
 * @param {{ name: string, range: Page.Pair, at: number }} input
 * @param {{ name: string, range: Page.Pair, at: number }} output
 * @returns {Messages.PanelData} as `fuzzyarm.show.plane` makes them
 */
export function linePanel({ xs, z }, input, output) {
  const parts = [
    { is: "line", x: Array.from(xs), y: numbersOf(z), tone: "accent", width: 1.6, dash: "-" },
    { is: "level", at: input.at, upright: true, tone: "soft", width: 0.6, dash: "--" },
    { is: "dots", x: [input.at], y: numbersOf([output.at]), sign: "o", size: 7, tone: "lit" },
  ];
  const [across, up] = [axisOf(input.name, input.range), axisOf(output.name, output.range)];
  return { title: "", across, up, parts, equal: false };
}

/**
 * An output over two inputs as a panel: its values by colours, and the point; a cut along one of them stands out.
 *
 * @param {{ xs: ArrayLike<number>, ys: ArrayLike<number>, z: ArrayLike<number> }} found
 * @param {{ name: string, range: Page.Pair, at: number, isCut: boolean }[]} inputs across and up
 * @param {{ name: string, range: Page.Pair }} output
 * @returns {Messages.PanelData} as `fuzzyarm.show.plane` makes them
 */
export function planePanel({ xs, ys, z }, inputs, output) {
  const [across, up] = inputs.map(({ name, range }) => axisOf(name, range));
  const value = axisOf(output.name, output.range);
  const rulings = inputs.map(({ at, isCut }, k) => ({
    is: "level",
    at,
    upright: k === 0,
    tone: isCut ? "lit" : "#ffffff",
    width: isCut ? 1.6 : 0.7,
    dash: isCut ? "-" : "--",
  }));
  const parts = [
    { is: "cells", x: Array.from(xs), y: Array.from(ys), values: numbersOf(z), value, signed: false },
    ...rulings,
    { is: "dots", x: [inputs[0].at], y: [inputs[1].at], sign: "+", size: 6, tone: "mark" },
  ];
  return { title: "", across, up, parts, equal: false };
}

/**
 * How a cube of side 1 about the origin is seen: inputs u and v lie across, the output w stands up.
 *
 * @param {{ azimuth: number, elevation: number }} turned radians
 * @param {number} width pixels
 * @param {number} height pixels
 */
export function projectionOf(turned, width, height) {
  const [ca, sa] = [Math.cos(turned.azimuth), Math.sin(turned.azimuth)];
  const [ce, se] = [Math.cos(turned.elevation), Math.sin(turned.elevation)];
  const reach = Math.min(width * 0.58, height * 0.68);
  return {
    reach,
    /** @returns {Page.Pair} */
    project(u, v, w) {
      const [right, depth] = [u * ca - v * sa, u * sa + v * ca];
      return [width / 2 + reach * right, height * 0.5 - reach * (0.62 * w * ce + depth * se)];
    },
    /** Whether the far end of each axis is the one with the large numbers. */
    farIsHigh: { u: sa > 0, v: ca > 0 },
  };
}

/** Indices of so many cells from far to near: what is in front covers what is behind. */
export const farToNear = (count, farIsHigh) => Array.from({ length: count }, (_, i) => (farIsHigh ? count - 1 - i : i));

/**
 * Where a level crosses the sides of each cell, joined two by two.
 *
 * @param {ArrayLike<number>} z values, row by row
 * @param {number} n columns
 * @param {number} level
 * @param {number} rows
 * @returns {Array<[Page.Pair, Page.Pair]>} in columns and rows of the grid
 */
export function crossings(z, n, level, rows = n) {
  /** @type {Array<[Page.Pair, Page.Pair]>} */
  const segments = [];
  for (let j = 0; j + 1 < rows; j++) {
    for (let i = 0; i + 1 < n; i++) {
      const k = j * n + i;
      const [a, b, c, d] = [z[k] - level, z[k + 1] - level, z[k + n + 1] - level, z[k + n] - level];
      /** @type {Page.Pair[]} */
      const found = [];
      if (a < 0 !== b < 0) found.push([i + a / (a - b), j]);
      if (b < 0 !== c < 0) found.push([i + 1, j + b / (b - c)]);
      if (d < 0 !== c < 0) found.push([i + d / (d - c), j + 1]);
      if (a < 0 !== d < 0) found.push([i, j + a / (a - d)]);
      for (let m = 0; m + 1 < found.length; m += 2) segments.push([found[m], found[m + 1]]);
    }
  }
  return segments;
}

/**
 * Places for the number of a level on its line: at most two, away from the edges and from other numbers.
 *
 * @param {number[][]} spots along the line, pixels
 * @param {{ left: number, top: number, right: number, bottom: number }} inside the plot
 * @param {number[][]} taken places of other numbers
 * @param {number} half of the width of the number
 */
export function spotsOf(spots, { left, top, right, bottom }, taken, half = 12) {
  const [margin, apart] = [half + 4, Math.max(42, 2 * half + 12)];
  const found = [];
  for (let i = 0; i < spots.length && found.length < 2; i++) {
    const spot = spots[Math.floor(((i * 0.618034) % 1) * spots.length)]; // spread over the line
    const [x, y] = spot;
    const isInside = x > left + margin && x < right - margin && y > top + 10 && y < bottom - 10;
    if (isInside && ![...taken, ...found].some(([u, v]) => Math.hypot(u - x, v - y) < apart)) found.push(spot);
  }
  return found;
}

/**
 * Where a label stands that leads outward from a place: its left end, its base line, and the box that it fills.
 *
 * @param {number[]} place
 * @param {number[]} direction
 * @param {number} wide pixels
 * @param {{ width: number, height: number }} picture which it does not leave
 */
export function outward([x, y], [dx, dy], wide, { width, height }) {
  const length = Math.hypot(dx, dy) || 1;
  const left = Math.max(4, Math.min(width - wide - 4, x - 0.5 * wide * (1 - dx / length)));
  const base = Math.max(12, Math.min(height - 4, y + 4 + (5 * dy) / length));
  return { left, base, box: [left - 3, base - 11, left + wide + 3, base + 3] };
}

/** Whether two boxes have nothing in common. */
export const areApart = (a, b) => a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
