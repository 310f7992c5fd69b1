// What all panes share: the rule base as it is drawn, the point, and the terms that a hand holds.

import { Engine } from "./engine.js";

export const ACROSS = 61;

/** Corners (x, y, x, y …) of straight shapes; Python has them in its records, see the tests. */
const CORNERS = {
  triangle: (p) => [p[0], 0, p[1], 1, p[2], 0],
  trapezoid: (p) => [p[0], 0, p[1], 1, p[2], 1, p[3], 0],
  rectangle: (p) => [p[0], 0, p[0], 1, p[1], 1, p[1], 0],
  ramp: (p) => (p[0] <= p[1] ? [p[0], 0, p[1], 1] : [p[1], 1, p[0], 0]),
  singleton: (p) => [p[0], 0, p[0], 1, p[0], 0],
};

/** Corners of a term with some parameters; null where it is not straight. */
export function cornersOf(term, parameters) {
  const points = term.kind === "points" ? parameters : CORNERS[term.kind]?.(parameters);
  if (!points) return null;
  const found = [];
  for (let i = 0; i < points.length; i += 2) {
    if (Number.isFinite(points[i])) found.push(points[i], points[i + 1] * term.height);
  }
  return found.length ? found : [0, term.height]; // without any it is 1 everywhere
}

/** Straight pieces x, y, x, y within a range, as inference has them. */
export function piecesOf(corners, low, high) {
  const last = corners.length - 2;
  const ends = [Math.min(low, corners[0]), corners[1], ...corners,
    Math.max(high, corners[last]), corners[last + 1]];
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

export function rangeOf(variable) {
  const known = variable.terms.flatMap((term) => term.parameters).filter(Number.isFinite);
  const low = variable.low ?? Math.min(0, ...known) - 1;
  const high = variable.high ?? Math.max(1, ...known) + 1;
  return [low, high];
}

export class Store {
  constructor() {
    this.listeners = {};
    this.scene = null;
    this.engine = null;
    this.held = null; // { variable, engine } while a hand holds a term
    this.reshaped = new Map(); // parameters by "variable term", until the text says them
    this.busy = false; // whether a hand moves a term, or has just let go
    this.point = [];
    this.axes = { x: 0, y: 1, output: 0 };
    this.stale = false; // whether the text has mistakes now, or nothing to be drawn
    this.sound = false; // whether the text has no mistakes
    this.view = ""; // which one is shown
  }

  on(name, listener) {
    (this.listeners[name] ??= []).push(listener);
  }

  emit(name) {
    for (const listener of this.listeners[name] ?? []) listener();
  }

  /** Take a rule base; the point and the axes stay where they fit. */
  show(scene) {
    const same = this.scene && JSON.stringify(this.scene.inputs.map((v) => [v.name, v.low, v.high]))
      === JSON.stringify(scene.inputs.map((v) => [v.name, v.low, v.high]));
    for (const variable of [...scene.inputs, ...scene.outputs]) {
      for (const term of variable.terms) {
        term.parameters = term.parameters.map(Number); // "Infinity" is not a number of JSON
        if (term.curve) term.curve.numbers = term.curve.numbers.map(Number);
      }
    }
    for (const output of scene.outputs) {
      for (const { curve } of output.members) if (curve) curve.numbers = curve.numbers.map(Number);
    }
    this.scene = scene;
    this.engine = scene.numbers ? new Engine(scene.numbers) : null;
    const none = { whole: "", floats: "", functions: scene.functions };
    this.curves = this.engine ?? new Engine(none); // sets are drawn in any case
    this.held = null;
    // What a hand still holds is newer than this text.
    if (!this.busy) this.reshaped.clear();
    this.stale = false;
    if (!same) {
      this.point = scene.inputs.map((variable) => {
        const [low, high] = rangeOf(variable);
        return low + 0.6 * (high - low);
      });
      this.axes = { x: 0, y: Math.min(1, scene.inputs.length - 1), output: 0 };
    }
    this.axes.output = Math.min(this.axes.output, scene.outputs.length - 1);
    this.emit("scene");
  }

  /** Keep what is drawn, as of an earlier text; `why` says what the text is now. */
  mistaken(why) {
    this.why = why;
    if (!this.stale) {
      this.stale = true;
      this.emit("stale");
    }
  }

  /** Take whether the text of now is sound. */
  judge(sound) {
    this.sound = sound;
    this.emit("judged");
  }

  /** The engine whose numbers are those of the picture. */
  get running() {
    return this.held?.engine ?? this.engine;
  }

  setPoint(index, value) {
    const [low, high] = rangeOf(this.scene.inputs[index]);
    this.point[index] = Math.min(high, Math.max(low, value));
    this.emit("point");
  }

  setAxes(axes) {
    Object.assign(this.axes, axes);
    this.emit("axes");
  }

  // --- terms ---

  parameters(variable, term) {
    return this.reshaped.get(`${variable.name}\n${term.name}`) ?? term.parameters;
  }

  /** Degrees of a term at some positions. */
  degrees(variable, term, x) {
    const numbers = this.numbersOf(term, this.parameters(variable, term));
    return this.curves.degrees(term.curve.address, Float64Array.from(numbers), x);
  }

  /** What the row function of a term takes. */
  numbersOf(term, parameters) {
    if (parameters === term.parameters) return term.curve.numbers;
    if (term.kind === "points") return cornersOf(term, parameters);
    return term.height === 1 ? parameters : [...parameters, term.height];
  }

  /** Have the numbers of a variable's terms changed in place from now on. */
  hold(variable, numbers) {
    this.held = numbers ? { variable: variable.name, engine: new Engine(numbers) } : null;
    for (const term of variable.terms) {
      const now = this.parameters(variable, term);
      if (now !== term.parameters) this.patch(variable, term, now);
    }
    this.emit("reshaped");
  }

  reshape(variable, term, parameters) {
    this.reshaped.set(`${variable.name}\n${term.name}`, parameters);
    if (this.held?.variable === variable.name) this.patch(variable, term, parameters);
    this.emit("reshaped");
  }

  /** Draw the terms as the text has them: a change was not taken. */
  forget() {
    this.held = null;
    this.reshaped.clear();
    this.emit("reshaped");
  }

  patch(variable, term, parameters) {
    const engine = this.held.engine;
    for (const mark of engine.data.marks) {
      if (mark.term !== term.name) continue;
      if (mark.sort === "curve") engine.patch(mark.floats, this.numbersOf(term, parameters));
      else if (mark.sort === "value") engine.patch(mark.floats, [parameters[0]]);
      else if (mark.sort === "samples") {
        const output = this.scene.outputs.findIndex((each) => each.name === variable.name);
        const x = engine.positions(output);
        engine.patch(mark.floats, this.degrees(variable, term, x));
      } else {
        const pieces = piecesOf(cornersOf(term, parameters), ...rangeOf(variable));
        engine.patch(mark.floats, pieces.slice(0, 4 * mark.room));
        engine.patchWhole(mark.row, Math.min(mark.room, pieces.length / 4));
      }
    }
  }

  // --- values ---

  /** The output shown over the two inputs of the axes, row by row; NaN where there is no value. */
  surface(points = ACROSS) {
    const { x, y, output } = this.axes;
    const flat = x === y; // one input
    const rows = flat ? 1 : points;
    const columns = this.scene.inputs.map((_, i) => new Float64Array(points * rows).fill(this.point[i]));
    const [xs, ys] = [x, y].map((i) => {
      const [low, high] = rangeOf(this.scene.inputs[i]);
      return Float64Array.from({ length: points }, (_, k) => low + ((high - low) * k) / (points - 1));
    });
    for (let j = 0; j < rows; j++) {
      for (let i = 0; i < points; i++) {
        columns[x][j * points + i] = xs[i];
        if (!flat) columns[y][j * points + i] = ys[j];
      }
    }
    return { xs, ys, z: this.running.many(columns)[output], rows };
  }

  /** Strengths, heights of the sets of each output, and values at the point; null in no program. */
  fired() {
    const found = this.running?.fired(this.point);
    if (!found) return null;
    const heights = this.scene.outputs.map((each) => new Float64Array(each.members.length));
    this.scene.rules.forEach((rule, number) => {
      for (const [o, member] of rule.concludes) {
        const fold = this.scene.outputs[o].aggregation;
        heights[o][member] = this.engine.joined(fold, heights[o][member], found.strengths[number]);
      }
    });
    return { ...found, heights };
  }
}
