import assert from "node:assert/strict";
import test from "node:test";
import {
  areApart,
  crossings,
  farToNear,
  fillTriangle,
  limitsOf,
  linePanel,
  outward,
  planePanel,
  projectionOf,
  spotsOf,
} from "../../../src/fuzzyarm/apps/designer/page/geometry/surface.js";

test("a triangle fills as many pixels as it has area, and a shared side is filled once", () => {
  const fill = (...corners) => {
    const pixels = new Uint32Array(100 * 100);
    fillTriangle(pixels, 100, 100, ...corners, 7);
    return pixels;
  };
  const [one, two] = [fill(10, 10, 90, 10, 90, 90), fill(10, 10, 10, 90, 90, 90)];
  const count = (pixels) => pixels.reduce((sum, colour) => sum + (colour === 7), 0);
  assert.ok(Math.abs(count(one) - 3200) < 100);
  assert.equal(count(one) + count(two), 6400);
  assert.equal(
    one.some((colour, k) => colour && two[k]),
    false,
  );
});

test("a triangle that reaches beyond the image stays within", () => {
  const pixels = new Uint32Array(10 * 10);
  fillTriangle(pixels, 10, 10, -50, -50, 60, -50, 5, 80, 3);
  assert.equal(pixels.length, 100);
  assert.ok(pixels.some((colour) => colour === 3));
});

test("the ends of the colours are those of the output, else of the values, and never one", () => {
  assert.deepEqual(limitsOf([1, 2], { low: -4, high: 4 }), [-4, 4]);
  assert.deepEqual(limitsOf([3, NaN, -1], { low: null, high: null }), [-1, 3]);
  assert.deepEqual(limitsOf([2, 2], { low: null, high: null }), [1, 3]);
});

test("the middle of the cube is the middle of the picture, and what is higher is drawn above", () => {
  const { project } = projectionOf({ azimuth: 0.7, elevation: 0.5 }, 400, 300);
  assert.deepEqual(project(0, 0, 0), [200, 150]);
  assert.ok(project(0, 0, 0.5)[1] < project(0, 0, -0.5)[1]);
});

test("cells go from far to near: the far ones are drawn higher up", () => {
  for (const azimuth of [0.3, 1.9, 3.5, 5.1]) {
    const { project, farIsHigh } = projectionOf({ azimuth, elevation: 0.6 }, 400, 300);
    const along = farToNear(5, farIsHigh.u).map((i) => project(i / 4 - 0.5, 0, 0)[1]);
    assert.deepEqual(
      along,
      [...along].sort((a, b) => a - b),
    );
    const across = farToNear(5, farIsHigh.v).map((j) => project(0, j / 4 - 0.5, 0)[1]);
    assert.deepEqual(
      across,
      [...across].sort((a, b) => a - b),
    );
  }
});

test("a level of a plane is a straight line", () => {
  const n = 9;
  const z = Float64Array.from({ length: n * n }, (_, k) => 2 * (k % n) + 3 * Math.floor(k / n));
  const segments = crossings(z, n, 17.5);
  assert.ok(segments.length > 4);
  for (const [i, j] of segments.flat()) assert.ok(Math.abs(2 * i + 3 * j - 17.5) < 1e-12);
});

test("a level beyond all values crosses nothing", () => {
  assert.deepEqual(crossings([0, 1, 2, 3], 2, 9), []);
});

test("over one input an output is a line with the point; a value that is missing is a gap", () => {
  const input = { name: "e", range: /** @type {[number, number]} */ ([-1, 1]), at: 0.5 };
  const panel = linePanel({ xs: [-1, 0, 1], z: [2, NaN, 4] }, input, { name: "u", range: [0, 5], at: 3 });
  assert.deepEqual(
    panel.parts.map((part) => part.is),
    ["line", "level", "dots"],
  );
  assert.deepEqual(panel.parts[0].y, [2, null, 4]);
  assert.deepEqual([panel.across.low, panel.up.high, panel.parts[1].at, panel.parts[2].y], [-1, 5, 0.5, [3]]);
});

test("over two inputs an output is cells, and a cut along one stands out", () => {
  const inputs = ["e", "ce"].map((name, k) => ({
    name,
    range: /** @type {[number, number]} */ ([k, k + 1]),
    at: k + 0.25,
    isCut: k === 1,
  }));
  const panel = planePanel({ xs: [0, 1], ys: [1, 2], z: [1, 2, 3, NaN] }, inputs, { name: "u", range: [1, 3] });
  const [cells, across, up, mark] = panel.parts;
  assert.deepEqual([cells.values, cells.value.low, cells.value.high], [[1, 2, 3, null], 1, 3]);
  assert.deepEqual([across.upright, across.at, up.upright, up.at], [true, 0.25, false, 1.25]);
  assert.ok(up.width > across.width && up.dash === "-");
  assert.deepEqual([mark.x, mark.y, panel.up.words], [[0.25], [1.25], "ce"]);
});

test("a level of a plane that is not square is straight, too", () => {
  const z = Array.from({ length: 3 * 5 }, (_, k) => k % 3); // three columns, five rows
  for (const ends of crossings(z, 3, 0.5, 5)) for (const [i] of ends) assert.ok(Math.abs(i - 0.5) < 1e-12);
  assert.equal(crossings(z, 3, 0.5, 5).length, 4);
});

test("the number of a level stands inside, away from others, at most twice", () => {
  const inside = { left: 0, top: 0, right: 300, bottom: 200 };
  const line = Array.from({ length: 100 }, (_, i) => [3 * i, 100]);
  const spots = spotsOf(line, inside, [[150, 100]]);
  assert.equal(spots.length, 2);
  for (const [x] of spots) assert.ok(x > 16 && x < 284 && Math.abs(x - 150) >= 42);
  assert.ok(Math.abs(spots[0][0] - spots[1][0]) >= 42);
  assert.deepEqual(spotsOf([[1, 1]], inside, []), []);
  const wide = spotsOf(line, inside, [], 40);
  for (const [x] of wide) assert.ok(x > 40 && x < 260);
});

test("a label leads outward from its place and stays within the picture", () => {
  const picture = { width: 300, height: 200 };
  const right = outward([100, 100], [5, 0], 40, picture);
  assert.equal(right.left, 100);
  assert.equal(outward([100, 100], [-5, 0], 40, picture).left, 60);
  assert.equal(outward([100, 100], [0, 3], 40, picture).left, 80);
  for (const place of [
    [-20, -20],
    [330, 260],
  ]) {
    const { left, base } = outward(place, [1, 1], 40, picture);
    assert.ok(left >= 0 && left + 40 <= 300 && base >= 10 && base <= 200);
  }
  assert.ok(!areApart(right.box, outward([110, 100], [1, 0], 40, picture).box));
  assert.ok(areApart(right.box, outward([100, 130], [1, 0], 40, picture).box));
});
