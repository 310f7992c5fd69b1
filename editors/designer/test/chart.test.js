import assert from "node:assert/strict";
import test from "node:test";
import { chartScales, decades, ticks, valueRange } from "../../../src/fuzzyarm/designer/page/geometry/chart.js";

const PLOT = { x0: 50, x1: 350, y0: 200, y1: 10 };

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

test("all values lie within the plot, from its left to its right", () => {
  const values = [4, null, 1, 9, 2];
  const { toX, toY, count } = chartScales([{ values }], PLOT, false);
  assert.equal(count, 5);
  values.forEach((v, i) => {
    assert.ok(toX(i) > PLOT.x0 && toX(i) < PLOT.x1);
    if (v !== null) assert.ok(toY(v) <= PLOT.y0 && toY(v) >= PLOT.y1);
  });
  assert.ok(toY(9) < toY(1));
});

test("a scale of powers gives each the same way", () => {
  const { toY } = chartScales([{ values: [1, 10, 100] }], PLOT, true);
  assert.ok(Math.abs(toY(1) - toY(10) - (toY(10) - toY(100))) < 1e-9);
});

test("without values there is a scale", () => {
  const { toY } = chartScales([{ values: [null] }], PLOT, true);
  assert.ok(Number.isFinite(toY(0.5)));
});

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
