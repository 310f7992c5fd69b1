// What all panes share: the rule base as it is drawn, the point, and the terms that a hand holds.

import { Engine } from "./engine.js";
import { evenly } from "./geometry/chart.js";
import { cornersOf, sidesOf, shapeKey, piecesOf, rangeOf } from "./geometry/shapes.js";

export const ACROSS = 61;

export class Store {
  constructor() {
    this.listeners = {};
    /** @type {Messages.Scene | null} */
    this.scene = null;
    this.engine = null;
    this.held = null; // { variable, engine } while a hand holds a term
    this.reshaped = new Map(); // parameters by "variable term", until the text says them
    this.busy = false; // whether a hand moves a term, or has just let go
    /** @type {number[]} */
    this.point = [];
    this.axes = { x: 0, y: 1, output: 0 };
    this.stale = false; // whether the text has mistakes now, or nothing to be drawn
    this.sound = false; // whether the text has no mistakes
    /** @type {Messages.Finding[]} */
    this.findings = []; // of the text that is drawn
    this.far = null; // the surface as the server computed it
    this.told = null; // what the server said of the point, where the page does not compute it
    this.view = ""; // which one is shown
    /** @type {Messages.SceneDiagram | null} */
    this.diagram = null; // of a controller
    this.refused = ""; // why the server does not compute what the page does not
    this.why = ""; // why nothing is drawn: mistakes, or something else than rules
    /** @type {boolean | null} */
    this.coarse = null; // whether the page computes fewer points than it draws
    /** @type {number | null} */
    this.cost = null; // of a point, ms
    this.works = new Set(); // views that are at work
    this.chosenDiagram = null; // whether the user wants it where there are rules as well
  }

  on(name, listener) {
    (this.listeners[name] ??= []).push(listener);
  }

  emit(name) {
    for (const listener of this.listeners[name] ?? []) listener();
  }

  /**
   * Take a rule base; the point and the axes stay where they fit.
   *
   * @param {Messages.Scene} scene
   */
  show(scene) {
    const same =
      this.scene &&
      JSON.stringify(this.scene.inputs.map((v) => [v.name, v.low, v.high])) ===
        JSON.stringify(scene.inputs.map((v) => [v.name, v.low, v.high]));
    for (const variable of [...scene.inputs, ...scene.outputs]) {
      for (const term of variable.terms) {
        for (const shape of sidesOf(term)) {
          shape.parameters = shape.parameters.map(Number); // "Infinity" is not a number of JSON
          if (shape.curve) shape.curve.numbers = shape.curve.numbers.map(Number);
        }
        if (term.lower) Object.assign(term.lower, { name: term.name, side: 1 });
      }
    }
    for (const output of scene.outputs) {
      for (const { curve } of output.members) if (curve) curve.numbers = curve.numbers.map(Number);
    }
    this.scene = scene;
    this.engine = scene.numbers ? new Engine(scene.numbers) : null;
    const none = { whole: "", floats: "", functions: scene.functions };
    this.curves = this.engine ?? new Engine(none); // sets are drawn in any case
    this.held = this.far = this.told = this.cost = null;
    // What a hand still holds is newer than this text.
    if (!this.busy) this.reshaped.clear();
    this.stale = false;
    if (!same) {
      this.point = scene.inputs.map((variable) => {
        const [low, high] = rangeOf(variable);
        return low + 0.6 * (high - low);
      });
      this.axes = { x: 0, y: Math.max(0, Math.min(1, scene.inputs.length - 1)), output: 0 };
    }
    this.axes.output = Math.max(0, Math.min(this.axes.output, scene.outputs.length - 1));
    this.emit("scene");
  }

  /**
   * Take the block diagram, or that there is none.
   *
   * @param {Messages.SceneDiagram | null} diagram
   */
  draw(diagram) {
    this.diagram = diagram;
    if (diagram) this.stale = false;
    this.emit("diagram");
  }

  /** Take whether a view is at work. */
  work(view, isAtWork) {
    if (this.works.has(view) === isAtWork) return;
    if (isAtWork) this.works.add(view);
    else this.works.delete(view);
    this.emit("works");
  }

  /** Whether the block diagram is shown: at first that of a controller is. */
  get asDiagram() {
    return Boolean(this.diagram) && (this.chosenDiagram ?? !this.diagram.isSystem);
  }

  /** Show the block diagram or the rules, of a file that has both. */
  turnDiagram(shown) {
    this.chosenDiagram = shown;
    this.emit("diagram");
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

  /** The value of the output shown at the point; NaN where there is none, or it is not known. */
  value() {
    const outputs = this.running ? this.running.at(this.point) : this.told?.outputs;
    return outputs?.[this.axes.output] ?? NaN;
  }

  /** The engine whose numbers are those of the picture. */
  get running() {
    return this.held?.engine ?? this.engine;
  }

  /** The point, input by input. */
  place() {
    return Object.fromEntries((this.scene?.inputs ?? []).map(({ name }, i) => [name, this.point[i]]));
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

  /** Parameters and height of a shape as they are drawn: what a hand holds, or the text's. */
  now(variable, shape) {
    return this.reshaped.get(shapeKey(variable, shape)) ?? shape;
  }

  /** Degrees of a shape at some positions, as it is drawn, or with other numbers. */
  degrees(variable, shape, x, now = this.now(variable, shape)) {
    const numbers = Float64Array.from(this.numbersOf(shape, now));
    const found = this.curves.degrees(shape.curve.address, numbers, x);
    const factor = shape.height === 1 && !cornersOf(shape, now.parameters) ? now.height : 1;
    if (factor !== 1) for (let i = 0; i < found.length; i++) found[i] *= factor;
    return found;
  }

  /** What the row function of a shape takes: corners, or numbers and the height that the text has. */
  numbersOf(shape, now) {
    if (now === shape) return shape.curve.numbers;
    const corners = cornersOf(shape, now.parameters, now.height);
    if (corners) return corners;
    return shape.height === 1 ? now.parameters : [...now.parameters, now.height];
  }

  /** Have the numbers of a variable's terms changed in place from now on. */
  hold(variable, numbers) {
    this.held = numbers ? { variable: variable.name, engine: new Engine(numbers) } : null;
    for (const shape of variable.terms.flatMap(sidesOf)) {
      const now = this.now(variable, shape);
      if (now !== shape && this.held) this.patch(variable, shape, now);
    }
    this.emit("reshaped");
  }

  reshape(variable, shape, parameters, height = this.now(variable, shape).height) {
    const now = { parameters, height };
    this.reshaped.set(shapeKey(variable, shape), now);
    if (this.held?.variable === variable.name) this.patch(variable, shape, now);
    this.emit("reshaped");
  }

  /** Draw the terms as the text has them: a change was not taken. */
  forget() {
    this.held = null;
    this.reshaped.clear();
    this.emit("reshaped");
  }

  patch(variable, shape, now) {
    const engine = this.held.engine;
    for (const mark of engine.data.marks) {
      if (!shape.marks.includes(mark.term)) continue;
      if (mark.sort === "curve") {
        const numbers = this.numbersOf(shape, now);
        if (numbers.length === mark.capacity) engine.patch(mark.floats, numbers);
      } else if (mark.sort === "value") engine.patch(mark.floats, [now.parameters[0]]);
      else if (mark.sort === "samples") {
        const output = this.scene.outputs.findIndex((each) => each.name === variable.name);
        engine.patch(mark.floats, this.degrees(variable, shape, engine.positions(output), now));
      } else {
        const corners = cornersOf(shape, now.parameters, now.height);
        const pieces = piecesOf(corners, ...rangeOf(variable));
        engine.patch(mark.floats, pieces.slice(0, 4 * mark.capacity));
        engine.patchWhole(mark.row, Math.min(mark.capacity, pieces.length / 4));
      }
    }
  }

  // --- values ---

  /** Which surface is shown: what else it depends on than the point within it. */
  surfaceKey() {
    const { x, y, output } = this.axes;
    return JSON.stringify([x, y, output, this.point.filter((_, i) => i !== x && i !== y)]);
  }

  /** How many points along an axis are computed within a tenth of a second. */
  across() {
    const few = this.scene.functions.some((each) => /^integrated_|_integral$/.test(each.program ?? "")) ? 15 : ACROSS;
    const known = this.cost ? Math.floor(Math.sqrt(100 / this.cost)) : few;
    return Math.min(ACROSS, Math.max(9, known));
  }

  /**
   * The output shown over the two inputs of the axes, row by row; NaN where there is no value. It
   * is the server's (`far`) where the page does not compute it, or not as finely; null before.
   */
  surface(points = this.across()) {
    const isFar = this.far?.key === this.surfaceKey() && !this.reshaped.size;
    const isCoarse = points < ACROSS;
    if (isCoarse !== this.coarse) {
      this.coarse = isCoarse;
      this.emit("coarse");
    }
    if (isFar && (this.coarse || !this.running)) return this.far;
    if (!this.running) return null;
    const { x, y, output } = this.axes;
    const flat = x === y; // one input
    const rows = flat ? 1 : points;
    const columns = this.scene.inputs.map((_, i) => new Float64Array(points * rows).fill(this.point[i]));
    const [xs, ys] = [x, y].map((i) => evenly(rangeOf(this.scene.inputs[i]), points));
    for (let j = 0; j < rows; j++) {
      for (let i = 0; i < points; i++) {
        columns[x][j * points + i] = xs[i];
        if (!flat) columns[y][j * points + i] = ys[j];
      }
    }
    const start = performance.now();
    const z = this.running.many(columns)[output];
    const cost = (performance.now() - start) / (points * rows);
    this.cost = Math.min(cost, this.cost ?? cost);
    return { xs, ys, z, rows };
  }

  /** The output shown along one input through the point; of the server's surface by its lines. */
  section(input, points = 2 * ACROSS - 1) {
    const xs = evenly(rangeOf(this.scene.inputs[input]), points);
    if (this.running) {
      const few = this.coarse ? ACROSS : points;
      const at = few === points ? xs : evenly([xs[0], xs[points - 1]], few);
      const columns = this.scene.inputs.map((_, i) => (i === input ? at : new Float64Array(few).fill(this.point[i])));
      return { xs: at, z: this.running.many(columns)[this.axes.output] };
    }
    const found = this.surface();
    if (!found) return null;
    const { x, y } = this.axes;
    if (x === y) return { xs: found.xs, z: found.z };
    const other = input === x ? y : x;
    const lines = other === x ? found.xs : found.ys;
    const n = lines.length;
    const share = ((this.point[other] - lines[0]) / (lines[n - 1] - lines[0])) * (n - 1);
    const low = Math.min(n - 2, Math.max(0, Math.floor(share)));
    const value = (i, k) => (other === x ? found.z[i * n + k] : found.z[k * n + i]);
    const z = Float64Array.from(
      { length: n },
      (_, i) => value(i, low) + (share - low) * (value(i, low + 1) - value(i, low)),
    );
    return { xs: input === x ? found.xs : found.ys, z };
  }

  /**
   * What fires at the point: the strength of each rule (`strengths`) and of its lower reading
   * (`lower`), heights of the sets of each output, outputs and the ends of each; null where it is
   * not known. What the page does not compute is what the server said of this point.
   */
  fired() {
    const { scene } = this;
    let found;
    if (this.running) {
      const read = this.running.fired(this.point);
      if (!read) return null;
      const of = (rule, side) => read.strengths[rule.readings[Math.min(side, rule.readings.length - 1)]];
      found = {
        outputs: read.outputs,
        ends: scene.outputs.some((each) => each.interval) ? this.running.ends(this.point) : null,
        strengths: scene.rules.map((rule) => of(rule, 0)),
        lower: scene.rules.map((rule) => of(rule, 1)),
        all: read.strengths,
      };
    } else {
      if (!this.told) return null;
      found = { ...this.told, ends: null, lower: this.told.strengths, all: this.told.strengths };
    }
    found.heights = scene.outputs.map((output) => {
      const heights = new Float64Array(output.members.length);
      for (const [member, reading] of output.asserted) {
        heights[member] = this.curves.joined(output.aggregation, heights[member], found.all[reading]);
      }
      return heights;
    });
    return found;
  }
}
