// Shapes of terms as numbers: corners, pieces, handles, mirror images. No drawing, no elements.

/** Corners (x, y, x, y …) of straight shapes; Python has them in its records, see the tests. */
const CORNERS = {
  triangle: (p) => [p[0], 0, p[1], 1, p[2], 0],
  trapezoid: (p) => [p[0], 0, p[1], 1, p[2], 1, p[3], 0],
  rectangle: (p) => [p[0], 0, p[0], 1, p[1], 1, p[1], 0],
  ramp: (p) => (p[0] <= p[1] ? [p[0], 0, p[1], 1] : [p[1], 1, p[0], 0]),
  binary: (p) => (p[1] > p[0] ? [p[0], 0, p[0], 1] : [p[0], 1, p[0], 0]),
  singleton: (p) => [p[0], 0, p[0], 1, p[0], 0],
};

/** Corners of a shape with some parameters; null where it is not straight. */
export function cornersOf(shape, parameters, height = shape.height) {
  const points = shape.kind === "points" ? parameters : CORNERS[shape.kind]?.(parameters);
  if (!points) return null;
  const found = [];
  for (let i = 0; i < points.length; i += 2) {
    if (Number.isFinite(points[i])) found.push(points[i], points[i + 1] * height);
  }
  return found.length ? found : [0, height]; // without any it is 1 everywhere
}

const LEVEL = Math.log(9); // of a sigmoid, from one half to 0.9

/** Where the handle of a number stands that is no position, and the number from where it is put. */
const beside = (centre, width, way = 1, share = 1) => ({
  at: (p) => p[centre] + way * share * p[width],
  to: (p, x) => Math.abs(x - p[centre]) / share,
});
const slope = (inflection, own) => ({
  at: (p) => p[inflection] + LEVEL / p[own],
  to: (p, x) => LEVEL / (x - p[inflection]),
});
export const WIDTHS = {
  gaussian: { 1: beside(0, 1) }, // where it is exp(-1/2)
  "two-sided-gaussian": { 1: beside(0, 1, -1), 3: beside(2, 3) },
  bell: {
    1: beside(0, 1), // where it is one half; its slope where it is 0.9
    2: {
      at: (p) => p[0] + p[1] * (1 / 9) ** (0.5 / p[2]),
      to: (p, x) => Math.min(50, Math.max(0.1, (-0.5 * LEVEL) / Math.log(Math.min(0.999, Math.abs(x - p[0]) / p[1])))),
    },
  },
  sigmoid: { 1: slope(0, 1) },
  "sigmoid-difference": { 1: slope(0, 1), 3: slope(2, 3) },
  "sigmoid-product": { 1: slope(0, 1), 3: slope(2, 3) },
  cosine: { 1: beside(0, 1, 1, 0.5) }, // where it is 0
  spike: { 1: beside(0, 1, 1, 0.1) }, // where it is exp(-1)
};

/** The shapes of a term: the upper one, and of interval type 2 the lower one below it. */
export const sidesOf = (term) => (term.lower ? [term, term.lower] : [term]);

export const shapeKey = (variable, shape) => `${variable.name}\n${shape.name}\n${shape.side ?? 0}`;

/** Straight pieces x, y, x, y within a range, as inference has them. */
export function piecesOf(corners, low, high) {
  const last = corners.length - 2;
  const ends = [Math.min(low, corners[0]), corners[1], ...corners, Math.max(high, corners[last]), corners[last + 1]];
  const pieces = [];
  for (let i = 0; i + 3 < ends.length; i += 2) {
    const [x0, y0, x1, y1] = ends.slice(i, i + 4);
    const [a, b] = [Math.max(x0, low), Math.min(x1, high)];
    if (!(b > a)) continue;
    const slope = (y1 - y0) / (x1 - x0);
    pieces.push(a, a === x0 ? y0 : y0 + slope * (a - x0), b, b === x1 ? y1 : y0 + slope * (b - x0));
  }
  return pieces;
}

/** A number as JSON can have it, which has no infinite ones. */
export const sendable = (x) => (Number.isFinite(x) ? x : x > 0 ? "inf" : "-inf");

/**
 * The range of a variable as it is drawn: of an unbounded one what its terms need.
 *
 * @param {Messages.SceneVariable} variable
 * @returns {Page.Pair}
 */
export function rangeOf(variable) {
  const known = variable.terms.flatMap((term) => term.parameters.map(Number)).filter(Number.isFinite);
  const low = variable.low ?? Math.min(0, ...known) - 1;
  const high = variable.high ?? Math.max(1, ...known) + 1;
  return [low, high];
}

/** Where a value lies along the range of a variable: 0 at its low end, 1 at its high one. */
export function shareAlong(variable, value) {
  const [low, high] = rangeOf(variable);
  return (value - low) / (high - low);
}

const TYPED = 12; // digits of a number that somebody may have typed; with more it was computed

/** A number as it may stand in the text: a computed one, such as 13.333333333333334, by six digits. */
const written = (x) => (String(x).replace(/^-|\.|e.*$/g, "").length > TYPED ? Number(x.toPrecision(6)) : x);

const near = (a, b) => a === b || Math.abs(a - b) < 1e-5 * (Math.abs(a) + Math.abs(b)); // one may have been written
const ascends = (shape, p) => shape.handles.every((i, k) => !k || p[shape.handles[k - 1]] <= p[i]);

/**
 * Parameters of a neighbour whose corners coincide with those of a shape that has moved from `old` to `next`; null where
 * it has none of them, or they would no longer ascend.
 */
export function following(neighbour, parameters, shape, old, next) {
  let isShared = false;
  const to = parameters.map((x, i) => {
    const place = neighbour.handles.includes(i) ? shape.handles.findIndex((k) => near(old[k], x)) : -1;
    if (place < 0) return written(x);
    isShared ||= !near(next[shape.handles[place]], old[shape.handles[place]]);
    return next[shape.handles[place]];
  });
  return isShared && ascends(neighbour, to) ? to : null;
}

/** Parameters of a shape after one of them (null: all positions) has moved to or by a number. */
export function moved(shape, parameters, index, to, by) {
  const next = [...parameters];
  if (index === null) {
    for (const i of shape.handles) next[i] = written(parameters[i] + by);
    return next;
  }
  const place = shape.handles.indexOf(index);
  if (shape.ordered || shape.kind === "points") {
    const before = parameters[shape.handles[place - 1]] ?? -Infinity;
    const behind = parameters[shape.handles[place + 1]] ?? Infinity;
    to = Math.min(behind, Math.max(before, to));
  }
  next[index] = to;
  return next.map(written);
}

const SYMMETRIC = new Set(["triangle", "trapezoid", "rectangle", "pi", "semi-ellipse", "s", "z", "singleton"]);
/** Kinds whose mirror image is of another one. */
export const TURNED = { s: "z", z: "s" };

/** The parameters of the mirror image about half of `sum`; null where there is none. */
export function mirrorOf(kind, p, sum) {
  const flip = (x) => Number((sum - x).toPrecision(12));
  if (SYMMETRIC.has(kind)) return [...p].reverse().map(flip);
  if (kind === "two-sided-gaussian") return [flip(p[2]), p[3], flip(p[0]), p[1]];
  if (kind === "sigmoid") return [flip(p[0]), -p[1]];
  if (kind.startsWith("sigmoid-")) return [flip(p[2]), -p[3], flip(p[0]), -p[1]];
  if (["ramp", "concave", "arc"].includes(kind)) return p.map(flip);
  return WIDTHS[kind] ? [flip(p[0]), ...p.slice(1)] : null;
}

/**
 * Parameters of a shape that moves itself and is the image of one that moves, each from `old` to `next`: its own moves
 * first, those of the image where it stays.
 */
export function joined(shape, own, image) {
  const stays = (move, i) => near(move.old[i], move.next[i]);
  const both = own.next.map((x, i) => (stays(own, i) && !stays(image, i) ? image.next[i] : x));
  return ascends(shape, both) ? both : own.next;
}
