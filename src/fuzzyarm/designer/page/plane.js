// Values over two inputs as a coloured plane, over one as lines: for differences of two surfaces.
//
// A plane has no point that a hand moves, no program and no store; the contour of the Surface pane
// has all of them. It marks a place, and draws cells of a table.

import { clean, colourOf, context, drawAxes, heat, SHADES, shortNumber } from "./draw.js";

const box = (width, height) => ({ left: 46, top: 26, wide: width - 60, tall: height - 64 });

/** A canvas with its title, and the plot in it; null while it is not shown. */
function begin(canvas, title) {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (!width || !height) return null;
  const { g } = context(canvas, width, height);
  const inside = box(width, height);
  heading(g, title, inside);
  return { g, inside };
}

/**
 * Where a place of both axes is in a plot.
 *
 * @returns {(u: number, v: number) => Page.Pair}
 */
function placed({ left, top, wide, tall }, [a, b], [c, d]) {
  return (u, v) => [left + (wide * (u - a)) / (b - a), top + tall - (tall * (v - c)) / (d - c)];
}

function heading(g, title, { left, wide }) {
  g.fillStyle = colourOf("--ink");
  g.font = "600 12px system-ui, sans-serif";
  g.textAlign = "left";
  g.fillText(clean(title), left, 15, wide);
}

function mark(g, x, y) {
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

/** Both ends of some values; about 0 where they are differences. */
export function rangeOfValues(lists, aboutZero = false) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of lists) {
    for (const value of values) {
      if (value === null) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(low <= high)) return [0, 1];
  if (aboutZero) {
    const far = Math.max(Math.abs(low), Math.abs(high)) || 1;
    return [-far, far];
  }
  return low < high ? [low, high] : [low - 1, high + 1];
}

const parts = (colour) => colour.match(/\d+/g).slice(0, 3).map(Number);
const HEATS = Array.from({ length: 256 }, (_, i) => parts(heat(i / 255)[0]));

/**
 * Draw a plane: `z` row by row over `xs` and `ys`; `low` and `high` are the ends of the colours,
 * which are those of differences if `signed`; `grid` has lines to be drawn, `worst` a place.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {{ title: string, xs: ArrayLike<number>, ys: ArrayLike<number>, z: ArrayLike<number>, low: number, high: number,
 *   signed?: boolean, x: string, y: string, grid?: any, worst?: Page.Pair }} plane
 */
export function drawPlane(canvas, { title, xs, ys, z, low, high, signed, x, y, grid, worst }) {
  const begun = begin(canvas, title);
  if (!begun) return;
  const { g, inside } = begun;
  const { left, top, wide, tall } = inside;
  /** @type {Page.Pair[]} */
  const [across, up] = [
    [xs[0], xs[xs.length - 1]],
    [ys[0], ys[ys.length - 1]],
  ];
  const colours = new ImageData(xs.length, ys.length);
  const shades = signed ? HEATS : SHADES;
  for (let j = 0; j < ys.length; j++) {
    for (let i = 0; i < xs.length; i++) {
      const value = z[j * xs.length + i];
      if (value === null) continue;
      const shade = shades[Math.max(0, Math.min(255, Math.round((255 * (value - low)) / (high - low))))];
      colours.data.set([...shade, 255], 4 * ((ys.length - 1 - j) * xs.length + i));
    }
  }
  const small = new OffscreenCanvas(xs.length, ys.length);
  small.getContext("2d").putImageData(colours, 0, 0);
  // Pixels stand for points: the outer half of the outer ones lies beyond the range.
  g.drawImage(small, 0.5, 0.5, xs.length - 1, ys.length - 1, left, top, wide, tall);
  const at = placed(inside, across, up);
  if (grid) rulings(g, grid, at, inside);
  drawAxes(g, inside, across, up, x, y);
  if (worst) mark(g, ...at(...worst));
}

function rulings(g, [across, up], at, { left, top, wide, tall }) {
  if (across.length > 80 || up.length > 80) return;
  g.strokeStyle = "rgb(90 90 90 / 0.35)";
  g.lineWidth = 1;
  g.beginPath();
  for (const u of across) {
    const [px] = at(u, up[0]);
    g.moveTo(px, top);
    g.lineTo(px, top + tall);
  }
  for (const v of up) {
    const [, py] = at(across[0], v);
    g.moveTo(left, py);
    g.lineTo(left + wide, py);
  }
  g.stroke();
}

/**
 * Draw cells with a number each: `cells` has [column, row, value], between the levels of the axes.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {{ title: string, across: number[], up: number[], cells: Array<[number, number, number]>, high: number,
 *   x: string, y: string, worst?: Page.Pair }} map
 */
export function drawCells(canvas, { title, across, up, cells, high, x, y, worst }) {
  const begun = begin(canvas, title);
  if (!begun) return;
  const { g, inside } = begun;
  const [a, b] = [across[0], across[across.length - 1]];
  const [c, d] = [up[0], up[up.length - 1]];
  const at = placed(inside, [a, b], [c, d]);
  g.font = "11px system-ui, sans-serif";
  for (const [i, j, value] of cells) {
    const [x0, y1] = at(across[i], up[j]);
    const [x1, y0] = at(across[i + 1], up[j + 1]);
    const [colour, ink] = heat(0.5 + (0.5 * value) / high);
    g.fillStyle = colour;
    g.fillRect(x0, y0, x1 - x0 - 0.5, y1 - y0 - 0.5);
    const said = shortNumber(value, 2);
    if (x1 - x0 > 8 * said.length && y1 - y0 > 13) {
      g.fillStyle = ink;
      g.textAlign = "center";
      g.fillText(said, (x0 + x1) / 2, (y0 + y1) / 2 + 4);
    }
  }
  drawAxes(g, inside, [a, b], [c, d], x, y);
  if (worst) mark(g, ...at(...worst));
}

const STYLES = [
  ["--accent", []],
  ["--lit", [6, 4]],
];

/**
 * Draw lines over one input: `lines` are values at `xs`.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {{ title: string, xs: ArrayLike<number>, lines: Array<Array<number | null>>, low: number, high: number,
 *   x: string, y: string, worst?: number }} plot
 */
export function drawLines(canvas, { title, xs, lines, low, high, x, y, worst }) {
  const begun = begin(canvas, title);
  if (!begun) return;
  const { g, inside } = begun;
  const { top, tall } = inside;
  const [a, b] = [xs[0], xs[xs.length - 1]];
  drawAxes(g, inside, [a, b], [low, high], x, y);
  const at = placed(inside, [a, b], [low, high]);
  lines.forEach((values, k) => {
    const [colour, dashes] = STYLES[k % STYLES.length];
    g.strokeStyle = colourOf(colour);
    g.lineWidth = 2;
    g.setLineDash(dashes);
    g.beginPath();
    let down = false;
    values.forEach((value, i) => {
      if (value !== null) {
        if (down) g.lineTo(...at(xs[i], value));
        else g.moveTo(...at(xs[i], value));
      }
      down = value !== null;
    });
    g.stroke();
  });
  g.setLineDash([]);
  if (worst !== null && worst !== undefined) {
    const [px] = at(worst, low);
    g.strokeStyle = colourOf("--ink");
    g.strokeRect(px, top, 0, tall);
  }
}
