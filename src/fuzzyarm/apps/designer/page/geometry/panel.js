// Where the parts of a panel lie: the arithmetic of the page's renderer of pictures (panel.js). No drawing, no elements.

import { shortNumber } from "../draw.js";
import { decades, ticks } from "./chart.js";

/** @typedef {{ low: number, high: number, logarithmic?: boolean, whole?: boolean, words?: string }} Axis */

/** An axis of a panel. */
export const axisOf = (words, [low, high]) => ({ words, low, high, logarithmic: false, whole: false });

/**
 * The scale of an axis, from a value to a pixel.
 *
 * @param {Axis} axis
 * @param {number} from the pixel of its low end
 * @param {number} to that of its high end
 */
export function scaleOf({ low, high, logarithmic = false }, from, to) {
  const measure = logarithmic ? Math.log10 : (value) => value;
  const [a, b] = [measure(low), measure(high)];
  return (value) => from + ((to - from) * (measure(value) - a)) / (b - a);
}

/**
 * The way back: the value at a pixel, within the ends of the axis.
 *
 * @param {Axis} axis
 * @param {number} from the pixel of its low end
 * @param {number} to that of its high end
 */
export function valueAt({ low, high, logarithmic = false }, from, to) {
  return (pixel) => {
    const share = Math.min(1, Math.max(0, (pixel - from) / (to - from)));
    return logarithmic ? low * (high / low) ** share : low + share * (high - low);
  };
}

/**
 * Round numbers along an axis, about so many.
 *
 * @param {Axis} axis
 * @param {number} wanted
 */
export function ticksOf({ low, high, logarithmic = false, whole = false }, wanted) {
  const found = logarithmic ? decades(low, high) : ticks(low, high, wanted);
  return found.filter(
    (value) =>
      (!whole || Number.isInteger(value)) &&
      value >= low * (1 - 1e-9 * Math.sign(low)) &&
      value <= high * (1 + 1e-9 * Math.sign(high)),
  );
}

/**
 * The edges of cells that stand at places: the middles between them; places that are one more than the cells are edges.
 *
 * @param {number[]} places
 * @param {number} count of cells
 */
export function edgesOf(places, count) {
  if (places.length === count + 1) return places;
  if (count === 1) return [places[0] - 0.5, places[0] + 0.5];
  const middles = places.slice(1).map((place, i) => (places[i] + place) / 2);
  return [2 * places[0] - middles[0], ...middles, 2 * places[count - 1] - middles[count - 2]];
}

/**
 * Strokes through points: a gap where one is missing; with steps level from each to the next.
 *
 * @param {Array<number | null>} x
 * @param {Array<number | null>} y
 * @param {boolean} steps
 * @returns {Array<Array<[number, number]>>}
 */
export function strokesOf(x, y, steps = false) {
  const strokes = [];
  let stroke = null;
  for (let i = 0; i < x.length; i++) {
    if (x[i] === null || y[i] === null) {
      stroke = null;
      continue;
    }
    if (!stroke) strokes.push((stroke = []));
    else if (steps) stroke.push([x[i], stroke.at(-1)[1]]);
    stroke.push([x[i], y[i]]);
  }
  return strokes;
}

/**
 * Where a value lies between the ends of its axis, 0 to 1.
 *
 * @param {number} value
 * @param {Axis} axis
 */
export function shareOf(value, axis) {
  return Math.min(1, Math.max(0, scaleOf(axis, 0, 1)(value)));
}

/**
 * Where a plot lies on a canvas, and its scales both ways. Cells whose first row stands at the top turn the axis over.
 *
 * @param {{ across: Axis, up: Axis, parts: any[], title: string, equal?: boolean }} panel
 * @param {number} width pixels
 * @param {number} height pixels
 * @param {number} rows of labels above the plot
 * @param {number} left room for numbers and the name of the axis that goes up
 */
export function layoutOf(panel, width, height, rows, left = ROOM.left) {
  const cells = panel.parts.find((part) => part.is === "cells");
  const hasBar = Boolean(cells) && width >= LEAST_WITH_BAR;
  const inside = {
    left,
    top: ROOM.top + (panel.title ? ROOM.title : 0) + ROOM.row * rows,
    right: width - (hasBar ? ROOM.bar : ROOM.right),
    bottom: height - ROOM.bottom,
  };
  if (panel.equal) {
    const [wide, high] = [panel.across, panel.up].map((axis) => axis.high - axis.low);
    const unit = Math.min((inside.right - inside.left) / wide, (inside.bottom - inside.top) / high);
    inside.right = inside.left + unit * wide;
    inside.top = inside.bottom - unit * high;
  }
  const upward = cells?.downward ? [inside.top, inside.bottom] : [inside.bottom, inside.top];
  return {
    inside,
    hasBar,
    toX: scaleOf(panel.across, inside.left, inside.right),
    toY: scaleOf(panel.up, upward[0], upward[1]),
    xAt: valueAt(panel.across, inside.left, inside.right),
    yAt: valueAt(panel.up, upward[0], upward[1]),
  };
}

/** Pixels around a plot; `row` is one of labels. */
export const ROOM = { left: 52, right: 12, top: 10, title: 16, bottom: 36, row: 15, bar: 74, name: 23 };

const LEAST_WITH_BAR = 300;

/**
 * A table as it is drawn: the edges of its columns and rows, and the names of both axes; the name of a table of one row is
 * empty.
 *
 * @typedef {{ x: number[], y: number[], names: [string, string] }} Grid
 */

const ONE_ROW = [0.1, 0.9]; // no whole number lies between them: the axis has no ticks

/**
 * The cells of two axes of levels.
 *
 * @param {{ name: string, levels: number[] }} across
 * @param {{ name: string, levels: number[] } | null} down
 * @param {boolean} areEdges whether levels lie between the cells, and not in their middles
 * @returns {Grid}
 */
export function gridOf(across, down, areEdges = false) {
  const edges = ({ levels }) => (areEdges ? levels : edgesOf(levels, levels.length));
  return { x: edges(across), y: down ? edges(down) : ONE_ROW, names: [across.name, down?.name ?? ""] };
}

/**
 * A table as a panel: cells whose colours are those of an axis of values.
 *
 * @param {Grid} grid
 * @param {Array<number | null>} values row by row
 * @param {Axis} value
 * @param {Record<string, any>} looks what else is said of the cells
 */
export function cellsPanel({ x, y, names }, values, value, looks = {}) {
  const across = axisOf(names[0], [x[0], x.at(-1)]);
  const up = { ...axisOf(names[1], [y[0], y.at(-1)]), whole: !names[1] };
  return { title: "", across, up, parts: [{ is: "cells", x, y, values, value, signed: true, ...looks }] };
}

/**
 * The row and the column that lie under a pixel; null beside the plot.
 *
 * @param {Grid} grid
 * @param {ReturnType<typeof layoutOf>} layout
 */
export function cellAt(grid, { inside, xAt, yAt }, x, y) {
  if (x < inside.left || x > inside.right || y < inside.top || y > inside.bottom) return null;
  const within = (edges, value) => edges.slice(1, -1).filter((edge) => edge <= value).length;
  return [within(grid.y, yAt(y)), within(grid.x, xAt(x))];
}

/**
 * A line around a cell, as a part of a panel.
 *
 * @param {Grid} grid
 * @param {number[]} cell its row and its column
 */
export function outlineOf({ x, y }, [row, column]) {
  const [x0, x1, y0, y1] = [x[column], x[column + 1], y[row], y[row + 1]];
  return { is: "line", x: [x0, x1, x1, x0, x0], y: [y0, y0, y1, y1, y0], tone: "lit", width: 1.8, dash: "-" };
}

/** A number in a cell, the shorter the later: at last a fraction without its 0. */
export function wordsOf(value, { whole }) {
  if (whole) return [String(value), `${shortNumber(value / 1000, 2)}k`];
  const tenths = shortNumber(Math.round(10 * value) / 10);
  return [shortNumber(value, 2), shortNumber(value, 1), tenths, tenths.replace(/^(-?)0\./, "$1.")];
}
