import assert from "node:assert/strict";
import test from "node:test";
import { decades, ticks, valueRange } from "../../../src/fuzzyarm/apps/designer/page/geometry/chart.js";

test("ticks are round, in order, and within", () => {
  for (const [low, high] of [
    [0, 1],
    [-3.7, 12.2],
    [1e-6, 3e-6],
    [-4e8, 2e8],
  ]) {
    const found = ticks(low, high);
    assert.ok(found.length >= 2 && found.length <= 11);
    assert.deepEqual(
      found,
      [...found].sort((a, b) => a - b),
    );
    for (const x of found) assert.ok(x >= low - 1e-9 * (high - low) && x <= high + 1e-9 * (high - low));
  }
});

test("decades have powers of ten", () => assert.ok([0.1, 1, 10].every((v) => decades(0.05, 50).includes(v))));

test("a plot of values holds them and their limits with room, and never has one value for both ends", () => {
  assert.deepEqual(valueRange([null, null], []), [-1, 1]);
  assert.deepEqual(valueRange([3, 3], []), [2, 4]);
  for (const [ends, limits] of [
    [[-2, 5], []],
    [
      [0.1, 0.2],
      [-24, 24],
    ],
    [
      [null, null],
      [0, 10],
    ],
  ]) {
    const [low, high] = valueRange(ends, limits);
    for (const value of [...ends, ...limits].filter(Number.isFinite)) assert.ok(low < value && value < high);
  }
});
