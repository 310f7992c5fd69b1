// Round numbers along an axis, and between what a plot of values goes: no drawing, no elements.

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

/** So many numbers between two, evenly. */
export const evenly = ([low, high], count) =>
  Float64Array.from({ length: count }, (_, k) => low + ((high - low) * k) / (count - 1));
