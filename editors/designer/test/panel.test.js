import assert from "node:assert/strict";
import { test } from "node:test";

import {
  cellAt,
  cellsPanel,
  edgesOf,
  gridOf,
  layoutOf,
  outlineOf,
  scaleOf,
  shareOf,
  strokesOf,
  ticksOf,
  valueAt,
  wordsOf,
} from "../../../src/fuzzyarm/apps/designer/page/geometry/panel.js";

test("a scale takes the ends of its axis to those of the plot, also where ratios are equal lengths", () => {
  for (const logarithmic of [false, true]) {
    const at = scaleOf({ low: 0.1, high: 100, logarithmic }, 300, 10);
    assert.equal(at(0.1), 300);
    assert.ok(Math.abs(at(100) - 10) < 1e-9);
    assert.ok(at(1) > at(2) && at(2) > at(50)); // up is towards smaller pixels
  }
  const at = scaleOf({ low: 0.01, high: 100, logarithmic: true }, 0, 4);
  assert.deepEqual(
    [0.1, 1, 10].map((value) => Math.round(at(value))),
    [1, 2, 3],
  );
});

test("ticks lie within their axis", () => {
  for (const axis of [
    { low: -3.7, high: 12.2 },
    { low: 0.02, high: 900, logarithmic: true },
    { low: -6, high: -2 },
    { low: 0, high: 1 },
  ]) {
    const found = ticksOf(axis, 5);
    assert.ok(found.length >= 2, JSON.stringify(axis));
    for (const value of found) assert.ok(value >= axis.low - 1e-9 && value <= axis.high + 1e-9, `${value}`);
  }
});

test("an axis that counts has whole numbers alone", () => {
  assert.deepEqual(ticksOf({ low: 0.5, high: 4.5, whole: true }, 8), [1, 2, 3, 4]);
});

test("cells meet in the middle between their places; edges are taken as they are", () => {
  assert.deepEqual(edgesOf([0, 1, 3], 3), [-0.5, 0.5, 2, 4]);
  assert.deepEqual(edgesOf([0, 1, 3], 2), [0, 1, 3]);
  assert.deepEqual(edgesOf([5], 1), [4.5, 5.5]);
});

test("a stroke ends where a value is missing, and steps are level", () => {
  assert.deepEqual(strokesOf([1, 2, 3, 4], [5, 6, null, 8]), [
    [
      [1, 5],
      [2, 6],
    ],
    [[4, 8]],
  ]);
  assert.deepEqual(strokesOf([1, 2], [5, 6], true), [
    [
      [1, 5],
      [2, 5],
      [2, 6],
    ],
  ]);
});

test("the share of a value is between 0 and 1", () => {
  assert.deepEqual(
    [-9, -1, 0, 1, 9].map((value) => shareOf(value, { low: -1, high: 1 })),
    [0, 0, 0.5, 1, 1],
  );
});

test("a pixel leads back to its value, and no further than the ends", () => {
  for (const axis of [
    { low: -2, high: 6 },
    { low: 0.1, high: 100, logarithmic: true },
  ]) {
    const [to, back] = [scaleOf(axis, 300, 10), valueAt(axis, 300, 10)];
    for (const value of [axis.low, 1, 5, axis.high]) assert.ok(Math.abs(back(to(value)) - value) < 1e-9 * axis.high);
    assert.ok(Math.abs(back(0) - axis.high) < 1e-9 * axis.high && Math.abs(back(999) - axis.low) < 1e-9);
  }
});

test("cells whose first row stands at the top turn the axis over, and have a bar where there is room", () => {
  const axis = { low: 0, high: 1, words: "", logarithmic: false, whole: false };
  const panelOf = (downward) => ({ title: "t", across: axis, up: axis, parts: [{ is: "cells", downward }] });
  const [upward, turned] = [false, true].map((downward) => layoutOf(panelOf(downward), 400, 200, 1));
  assert.ok(upward.toY(1) < upward.toY(0) && turned.toY(1) > turned.toY(0));
  assert.equal(turned.yAt(turned.toY(0.25)), 0.25);
  assert.ok(upward.hasBar && !layoutOf(panelOf(false), 200, 200, 0).hasBar);
  assert.ok(upward.inside.right < 400 - 60);
});

const TABLE = gridOf({ name: "ce", levels: [-1, 0, 2] }, { name: "e", levels: [10, 20] });

test("a table is a panel of cells about its levels, or between them", () => {
  assert.deepEqual(TABLE, { x: [-1.5, -0.5, 1, 3], y: [5, 15, 25], names: ["ce", "e"] });
  assert.deepEqual(gridOf({ name: "x", levels: [0, 1, 4] }, null, true).x, [0, 1, 4]);
  const { across, up, parts } = cellsPanel(TABLE, [1, 2, 3, 4, 5, null], { low: 1, high: 5 }, { downward: true });
  assert.deepEqual([across.words, across.low, across.high], ["ce", -1.5, 3]);
  assert.deepEqual([up.words, up.low, up.high], ["e", 5, 25]);
  assert.equal(parts[0].values.length, (parts[0].x.length - 1) * (parts[0].y.length - 1));
});

test("the axis of a table of one row has no ticks", () => {
  const { up } = cellsPanel(gridOf({ name: "x", levels: [0, 1] }, null), [1, 2], { low: 0, high: 1 });
  assert.deepEqual(ticksOf(up, 5), []);
});

test("the pixel in the middle of a cell leads to it, its first row on top", () => {
  const panel = cellsPanel(TABLE, Array(6).fill(0), { low: 0, high: 1 }, { downward: true });
  const layout = layoutOf(panel, 400, 300, 0);
  for (let row = 0; row < 2; row++)
    for (let column = 0; column < 3; column++) {
      const { x, y } = outlineOf(TABLE, [row, column]);
      const at = [layout.toX((x[0] + x[1]) / 2), layout.toY((y[0] + y[2]) / 2)];
      assert.deepEqual(cellAt(TABLE, layout, at[0], at[1]), [row, column]);
    }
  assert.ok(layout.toY(TABLE.y[0]) < layout.toY(TABLE.y[1]));
  assert.equal(cellAt(TABLE, layout, layout.inside.left - 1, 100), null);
});

test("a negative fraction has a form for a narrow cell", () => {
  assert.deepEqual(wordsOf(-0.64, {}), ["-0.64", "-0.6", "-0.6", "-.6"]);
  assert.equal(wordsOf(-0.04, {}).at(-1), "0");
  assert.equal(wordsOf(10.5, {}).at(-1), "10.5");
  assert.deepEqual(wordsOf(1200, { whole: true }), ["1200", "1.2k"]);
});
