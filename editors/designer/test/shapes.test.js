import assert from "node:assert/strict";
import test from "node:test";
import {
  WIDTHS,
  cornersOf,
  following,
  joined,
  mirrorOf,
  moved,
  piecesOf,
  rangeOf,
  sendable,
} from "../../../src/fuzzyarm/apps/designer/page/geometry/shapes.js";

const close = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);
const NUMBERS = {
  gaussian: [2, 0.7],
  "two-sided-gaussian": [1, 0.5, 3, 0.9],
  bell: [2, 1.5, 2.5],
  sigmoid: [1, 4],
  "sigmoid-difference": [0, 5, 4, 3],
  "sigmoid-product": [0, 5, 4, -3],
  cosine: [2, 3],
  spike: [2, 3],
};

test("the corners of a trapezoid are its parameters, at the height of the shape", () => {
  assert.deepEqual(cornersOf({ kind: "trapezoid", height: 0.5 }, [0, 1, 2, 4]), [0, 0, 1, 0.5, 2, 0.5, 4, 0]);
  assert.equal(cornersOf({ kind: "gaussian", height: 1 }, [0, 1]), null);
});

test("a corner at infinity is none", () => {
  assert.deepEqual(cornersOf({ kind: "triangle", height: 1 }, [-Infinity, 0, 1]), [0, 1, 1, 0]);
});

test("pieces cover the range, and meet", () => {
  const pieces = piecesOf([1, 0, 2, 1, 3, 0], 0, 4);
  assert.equal(pieces[0], 0);
  assert.equal(pieces.at(-2), 4);
  for (let k = 4; k < pieces.length; k += 4) assert.deepEqual(pieces.slice(k, k + 2), pieces.slice(k - 2, k));
});

for (const [kind, widths] of Object.entries(WIDTHS)) {
  test(`a handle of ${kind} leads back to its number`, () => {
    const p = NUMBERS[kind];
    for (const [index, { at, to }] of Object.entries(widths)) close(to(p, at(p)), p[index]);
  });
}

for (const [kind, p] of Object.entries({ ...NUMBERS, triangle: [0, 1, 5], ramp: [0, 2], trapezoid: [0, 1, 2, 9] })) {
  test(`the mirror image of a mirror image of ${kind} is the shape`, () => {
    const there = mirrorOf(kind, p, 7);
    if (there) mirrorOf(kind, there, 7).forEach((x, i) => close(x, p[i]));
  });
}

test("numbers that JSON does not have are words", () => {
  assert.deepEqual([1.5, Infinity, -Infinity].map(sendable), [1.5, "inf", "-inf"]);
});

test("the range of an unbounded variable holds its terms", () => {
  const [low, high] = rangeOf({ low: null, high: null, terms: [{ parameters: [-3, 2, 8] }] });
  assert.ok(low < -3 && high > 8);
});

test("a neighbour takes the corners that it shares, and its others as somebody would type them", () => {
  const shape = { handles: [0, 1, 2] };
  const [left, right] = [
    [0, 40 / 3, 80 / 3],
    [40 / 3, 80 / 3, 40],
  ];
  assert.deepEqual(following(shape, right, shape, left, [0, 15, 26.6667]), [15, 26.6667, 40]);
  assert.deepEqual(following(shape, [13.3333, 26.6667, 40], shape, left, [0, 15, 80 / 3])[0], 15); // written before
  assert.equal(following(shape, [20, 30, 40], shape, left, [0, 15, 80 / 3]), null);
  assert.deepEqual(moved(shape, left, 1, 15), [0, 15, 26.6667]);
  assert.deepEqual(moved({ handles: [0] }, [0.1], null, 0, 0.2), [0.3]);
  assert.deepEqual(moved({ handles: [0] }, [1234567.25], null, 0, 1), [1234568.25]);
});

test("what is a neighbour on one side and an image on the other keeps the feet of both", () => {
  const shape = { handles: [0, 1, 2] };
  const own = { old: [-2, 0, 2], next: [-2, 0, 2.4] };
  const image = { old: [-2, 0, 2], next: [-2.4, 0, 2] };
  assert.deepEqual(joined(shape, own, image), [-2.4, 0, 2.4]);
  assert.deepEqual(joined(shape, { ...own, next: [-2, 0.5, 2] }, { ...image, next: [-2, -0.5, 2] }), [-2, 0.5, 2]);
  assert.deepEqual(
    joined(shape, { old: [-2, -1, 2], next: [-2, -1, 0] }, { old: [-2, 1, 2], next: [0, 1, 2] }),
    [-2, -1, 0],
  );
});
