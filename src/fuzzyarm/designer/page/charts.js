// Lines over a count, drawn on a canvas: the error of each pass, the cost of each trial.

import { clean, el, context, colourOf, shortNumber, eachFrame } from "./draw.js";
import { chartScales, decades, ticks } from "./geometry/chart.js";

const ROOM = { left: 52, right: 12, top: 10, bottom: 34 };
const DASHES = [[], [6, 4], [2, 3], [8, 3, 2, 3]];

/**
 * A canvas that fills its pane and is drawn again when its size or the theme changes.
 *
 * @param {Page.Store} store
 */
export function stage(store, body, draw) {
  const canvas = el("canvas", { role: "img" });
  const size = { width: 0, height: 0 };
  const redraw = eachFrame(() => {
    if (size.width > 4 && size.height > 4) draw(context(canvas, size.width, size.height));
  });
  new ResizeObserver(([entry]) => {
    size.width = entry.contentRect.width;
    size.height = entry.contentRect.height;
    redraw();
  }).observe(body);
  store.on("theme", redraw);
  body.append(canvas);
  return { canvas, redraw };
}

/** The colours of canvases, as the theme has them now. */
export function inks() {
  return {
    ink: colourOf("--ink"),
    soft: colourOf("--soft"),
    line: colourOf("--line"),
    pane: colourOf("--pane"),
    lines: [colourOf("--accent"), colourOf("--lit"), colourOf("--number"), colourOf("--keyword")],
  };
}

/**
 * Draw series over 1, 2, 3 … A series has `values` (null where there is none), a `name`, and may
 * have `dots` (no line), `steps` (the line goes level from one to the next) and `line`, its colour.
 */
export function drawChart({ g, width, height }, series, { across, up, logarithmic = false, whole = false }) {
  const paint = inks();
  const plot = { x0: ROOM.left, x1: width - ROOM.right, y0: height - ROOM.bottom, y1: ROOM.top };
  const chart = { g, width, height, paint, plot, logarithmic, ...chartScales(series, plot, logarithmic) };
  rulings(chart);
  numbers(chart, whole);
  titles(chart, across, up);
  series.forEach((each, k) => {
    const colour = paint.lines[(each.line ?? k) % paint.lines.length];
    if (each.dots) dots(chart, each, colour);
    else line(chart, each, colour, each.line ?? k);
  });
  legend(chart, series);
}

/** Lines across the plot, with their numbers on the left. */
function rulings({ g, height, paint, plot, logarithmic, low, high, toY }) {
  g.font = "11px system-ui, sans-serif";
  g.strokeStyle = paint.line;
  g.fillStyle = paint.soft;
  g.lineWidth = 1;
  g.textAlign = "right";
  g.textBaseline = "middle";
  for (const v of logarithmic ? decades(low, high) : ticks(low, high, Math.max(3, height / 40))) {
    const y = Math.round(toY(v)) + 0.5;
    if (y < plot.y1 - 1 || y > plot.y0 + 1) continue;
    g.beginPath();
    g.moveTo(plot.x0, y);
    g.lineTo(plot.x1, y);
    g.stroke();
    g.fillText(shortNumber(v, 3), plot.x0 - 6, y);
  }
}

/** Whole numbers below the plot. */
function numbers({ g, width, plot, count, toX }, whole) {
  g.textAlign = "center";
  g.textBaseline = "top";
  const marks = ticks(1, count, Math.max(2, width / 110)).filter((v) => Number.isInteger(v) && v >= 1);
  for (const v of whole && count <= 12 ? Array.from({ length: count }, (_, i) => i + 1) : marks) {
    g.fillText(String(v), toX(v - 1), plot.y0 + 4);
  }
}

function titles({ g, plot }, across, up) {
  g.fillText(across, (plot.x0 + plot.x1) / 2, plot.y0 + 18);
  g.save();
  g.translate(10, (plot.y0 + plot.y1) / 2);
  g.rotate(-Math.PI / 2);
  g.textBaseline = "middle";
  g.fillText(up, 0, 0);
  g.restore();
}

function dots({ g, logarithmic, scale, to, toX, toY }, { values }, colour) {
  g.fillStyle = colour;
  g.globalAlpha = values.length > 300 ? 0.35 : 0.55;
  values.forEach((v, i) => {
    if (v !== null && (!logarithmic || v > 0) && scale(v) <= to) g.fillRect(toX(i) - 1, toY(v) - 1, 2.4, 2.4);
  });
  g.globalAlpha = 1;
}

function line({ g, logarithmic, toX, toY }, { values, steps }, colour, dash) {
  g.strokeStyle = colour;
  g.lineWidth = 1.8;
  g.setLineDash(DASHES[dash % DASHES.length]);
  g.beginPath();
  let last = null;
  values.forEach((v, i) => {
    if (v === null || (logarithmic && !(v > 0))) {
      last = null;
      return;
    }
    if (last === null) g.moveTo(toX(i), toY(v));
    else {
      if (steps) g.lineTo(toX(i), last);
      g.lineTo(toX(i), toY(v));
    }
    last = toY(v);
  });
  g.stroke();
  g.setLineDash([]);
  if (steps || values.length > 60) return;
  g.fillStyle = colour;
  values.forEach((v, i) => {
    if (v === null) return;
    g.beginPath();
    g.arc(toX(i), toY(v), 2.6, 0, 7);
    g.fill();
  });
}

/** The names of the series, where there are several. */
function legend({ g, paint, plot }, series) {
  const named = series.filter((each) => each.name);
  if (named.length < 2) return;
  g.textAlign = "right";
  g.textBaseline = "middle";
  named.forEach((each, row) => {
    const y = plot.y1 + 8 + 15 * row;
    const at = each.line ?? series.indexOf(each);
    g.strokeStyle = paint.lines[at % paint.lines.length];
    g.setLineDash(DASHES[at % DASHES.length]);
    g.lineWidth = 1.8;
    g.beginPath();
    g.moveTo(plot.x1 - 26, y);
    g.lineTo(plot.x1 - 4, y);
    g.stroke();
    g.setLineDash([]);
    g.fillStyle = paint.ink;
    g.fillText(clean(each.name), plot.x1 - 32, y);
  });
}

/** A field with its label, for the bar of a view. */
export function field(label, input, hint = "") {
  if (hint) input.title = hint;
  return el("label", { class: "field" }, el("span", { textContent: label }), input);
}
