// Where a chart over 1, 2, 3 … has its values: no drawing, no elements.

/** Round numbers between two, about so many. */
export function ticks(low, high, wanted = 5) {
  const raw = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((x) => x * power).find((x) => x >= raw) ?? raw;
  const found = [];
  for (let x = Math.ceil(low / step - 1e-9); x * step <= high + 1e-9 * step; x++) {
    found.push(Number((x * step).toPrecision(12)));
  }
  return found;
}

/**
 * The scales of a chart.
 *
 * @param {Array<{ values: Array<number | null> }>} series
 * @param {{ x0: number, x1: number, y0: number, y1: number }} plot left, right, bottom and top in pixels
 * @param {boolean} logarithmic
 */
export function chartScales(series, plot, logarithmic) {
  const all = series.flatMap((each) => each.values.filter((v) => v !== null && (!logarithmic || v > 0)));
  const count = Math.max(2, ...series.map((each) => each.values.length));
  const scale = logarithmic ? Math.log10 : (v) => v;
  let [low, high] = all.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  if (!all.length) [low, high] = logarithmic ? [0.1, 1] : [0, 1];
  if (!logarithmic) low = Math.min(0, low);
  if (!(scale(high) > scale(low))) [low, high] = logarithmic ? [low / 2, high * 2] : [low, low + 1];
  const margin = logarithmic ? 0.06 * (scale(high) - scale(low)) : 0;
  const [from, to] = [scale(low) - margin, scale(high) + 0.06 * (scale(high) - scale(low))];
  return {
    count,
    low,
    high,
    to,
    scale,
    toX: (i) => plot.x0 + ((plot.x1 - plot.x0) * (i + 0.5)) / count,
    toY: (v) => plot.y0 - ((plot.y0 - plot.y1) * (scale(v) - from)) / (to - from),
  };
}

/** Round numbers between two, a few in each power of ten. */
export function decades(low, high) {
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

/**
 * Between what a plot of values goes: what is seen and the limits, with some room.
 *
 * @param {Array<number | null>} ends the least and the greatest value; null where there is none
 * @param {number[]} limits lines that are always seen
 */
export function valueRange(ends, limits) {
  const all = [...ends, ...limits].filter(Number.isFinite);
  if (!all.length) return [-1, 1];
  const [low, high] = [Math.min(...all), Math.max(...all)];
  if (high - low < 1e-9 * Math.max(1, Math.abs(high))) return [low - 1, high + 1];
  const room = 0.08 * (high - low);
  return [low - room, high + room];
}
