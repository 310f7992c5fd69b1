// Lines over a count, drawn on a canvas: the error of each pass, the cost of each trial.

import { clean, el, context, colourOf, shortNumber, ticks, eachFrame } from "./draw.js";

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
  const all = series.flatMap((each) => each.values.filter((v) => v !== null && (!logarithmic || v > 0)));
  const count = Math.max(2, ...series.map((each) => each.values.length));
  const scale = logarithmic ? Math.log10 : (v) => v;
  let [low, high] = all.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  if (!all.length) [low, high] = logarithmic ? [0.1, 1] : [0, 1];
  if (!logarithmic) low = Math.min(0, low);
  if (!(scale(high) > scale(low))) [low, high] = logarithmic ? [low / 2, high * 2] : [low, low + 1];
  const plot = { x0: ROOM.left, x1: width - ROOM.right, y0: height - ROOM.bottom, y1: ROOM.top };
  const toX = (i) => plot.x0 + ((plot.x1 - plot.x0) * (i + 0.5)) / count;
  const margin = logarithmic ? 0.06 * (scale(high) - scale(low)) : 0;
  const [from, to] = [scale(low) - margin, scale(high) + 0.06 * (scale(high) - scale(low))];
  const toY = (v) => plot.y0 - ((plot.y0 - plot.y1) * (scale(v) - from)) / (to - from);

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
  g.textAlign = "center";
  g.textBaseline = "top";
  const marks = ticks(1, count, Math.max(2, width / 110)).filter((v) => Number.isInteger(v) && v >= 1);
  for (const v of whole && count <= 12 ? Array.from({ length: count }, (_, i) => i + 1) : marks) {
    g.fillText(String(v), toX(v - 1), plot.y0 + 4);
  }
  g.fillText(across, (plot.x0 + plot.x1) / 2, plot.y0 + 18);
  g.save();
  g.translate(10, (plot.y0 + plot.y1) / 2);
  g.rotate(-Math.PI / 2);
  g.textBaseline = "middle";
  g.fillText(up, 0, 0);
  g.restore();

  series.forEach((each, k) => {
    const colour = paint.lines[(each.line ?? k) % paint.lines.length];
    if (each.dots) dots(each, colour);
    else line(each, colour, each.line ?? k);
  });
  legend(series.filter((each) => each.name));

  function dots({ values }, colour) {
    g.fillStyle = colour;
    g.globalAlpha = values.length > 300 ? 0.35 : 0.55;
    values.forEach((v, i) => {
      if (v !== null && (!logarithmic || v > 0) && scale(v) <= to) g.fillRect(toX(i) - 1, toY(v) - 1, 2.4, 2.4);
    });
    g.globalAlpha = 1;
  }

  function line({ values, steps }, colour, dash) {
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

  function legend(named) {
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
}

/** Round numbers between two, a few in each power of ten. */
function decades(low, high) {
  const wide = high / low > 200;
  const found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++) {
    for (const digit of wide ? [1] : [1, 2, 5]) {
      const v = digit * 10 ** power;
      if (v >= low * 0.9 && v <= high * 1.1) found.push(v);
    }
  }
  return found.length > 1 ? found : ticks(low, high, 3);
}

/** A field with its label, for the bar of a view. */
export function field(label, input, hint = "") {
  if (hint) input.title = hint;
  return el("label", { class: "field" }, el("span", { textContent: label }), input);
}

export function number(value, least, most, step = 1) {
  return el("input", { type: "number", value, min: least, max: most, step });
}

/** Fill a choice; what was chosen stays where it still is. */
export function refill(select, options, chosen = select.value) {
  select.replaceChildren(...options.map(([value, text]) => el("option", { value, textContent: text })));
  if (options.some(([value]) => value === chosen)) select.value = chosen;
}
