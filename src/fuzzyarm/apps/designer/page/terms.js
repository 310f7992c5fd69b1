// Terms: the membership functions of every variable, with handles that a hand can move.

import {
  ARROWS,
  eachFrame,
  el,
  hue,
  numberInput,
  pairsOf,
  readNumber,
  sayWrong,
  select,
  shortNumber,
  space,
  svg,
} from "./draw.js";
import { evenly, ticks } from "./geometry/chart.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { addVariable, variableHead } from "./variables.js";
import {
  rangeOf,
  cornersOf,
  sendable,
  sidesOf,
  shapeKey,
  WIDTHS,
  following,
  moved,
  joined,
  mirrorOf,
  TURNED,
} from "./geometry/shapes.js";

const [LEFT, RIGHT, TOP, BOTTOM] = [14, 14, 18, 15];
const HEAD = 20; // of the line above a plot
const DETAILS = 52; // below all, for the term that is chosen: two lines in a narrow pane
const [LEAST, MOST] = [54, 240]; // height of a plot; three fit into a window of 1280 × 720
const SMOOTH = 161;
const LEAST_HEIGHT = 0.05;
const DIAMOND = 5.5;

/** The height of each of so many plots in a pane: they share it, within bounds. */
export const plotHeight = (room, count) =>
  Math.round(Math.min(MOST, Math.max(LEAST, (room - DETAILS) / Math.max(1, count) - HEAD)));

/**
 * The pane; `edit` takes the shapes when a hand lets go, `numbers` brings those of a variable. Where the text can be edited,
 * `change` removes terms, and `rename` and `attempt` make the edits of dialogs.
 */
export class TermsPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "terms", S.terms);
    this.edit = this.hand.edit;
    this.numbers = this.hand.numbers;
    this.change = this.hand.change;
    this.list = el("div", { class: "plots" });
    this.details = el("div", { class: "details", hidden: true });
    this.body.append(this.list, this.details);
    if (this.hand.attempt) this.bar.append(this.adding(S.addInput, "input"), this.adding(S.addOutput, "output"));
    const toDiagram = el("button", {
      textContent: S.diagram,
      hidden: true,
      onclick: () => this.store.turnDiagram(true),
    });
    this.bar.append(toDiagram, space());
    this.options = el("span", { class: "options" });
    this.bar.append(this.options);
    this.partition = this.option(S.partition, S.partitionHint, false);
    this.mirror = this.option(S.mirror, S.mirrorHint, false);
    this.snap = this.option(S.snap, S.snapHint, true);
    this.plots = new Map();
    this.heads = new Map();
    this.tall = LEAST;
    this.chosen = ""; // "variable term" whose handles are shown
    this.fields = null; // the numbers of the chosen term
    this.rebuilding = false; // while they are put in the place of others
    this.drag = null;
    this.moving = ""; // the variable that a hand is on
    this.waiting = 0;
    this.wide = 0; // of the plots; asked for when it changes, as asking lays the page out
    this.partly = "";

    this.redraw = eachFrame(this.draw);
    this.store.on("scene", this.build);
    this.store.on("diagram", () => {
      toDiagram.hidden = !this.store.diagram || this.store.diagram.isSystem;
    });
    this.store.on("reshaped", () => {
      this.partly = this.store.busy ? this.moving : "";
      this.redraw();
    });
    this.store.on("point", () => {
      this.partly = "";
      this.redraw();
    });
    const watch = new ResizeObserver(() => {
      this.wide = this.list.clientWidth;
      this.tall = plotHeight(this.body.clientHeight, this.plots.size);
      this.redraw();
    });
    watch.observe(this.list);
    watch.observe(this.body);
  }

  option = (text, title, checked) => {
    const box = el("input", { type: "checkbox", checked });
    this.options.append(el("label", { class: "small", title }, box, text));
    return box;
  };
  adding = (words, role) =>
    el("button", { textContent: words, title: S.addRole[role], onclick: () => addVariable(this.hand, role) });

  each = () => [...this.store.scene.inputs, ...this.store.scene.outputs];
  termKey = (variable, term) => `${variable.name}\n${term.name}`;

  roleOf = (v) => (v < this.store.scene.inputs.length ? S.inputs : S.outputs);

  path = (points, at) =>
    points.map(([x, y], i) => `${i ? "L" : "M"}${at.x(x).toFixed(1)} ${at.y(y).toFixed(1)}`).join("");

  peak = (shape, parameters) => {
    if (shape.kind === "triangle") return parameters[1];
    if (shape.kind === "trapezoid") return 0.5 * (parameters[1] + parameters[2]);
    return shape.handles.length === 1 ? parameters[shape.handles[0]] : null;
  };

  /** Whether the term has a place that another kind can take: a shape, or a number of an output. */
  canChange = (term) => this.store.scene.kinds && !["formula", "linear"].includes(term.kind);

  handleAt = (shape, parameters, index) =>
    shape.handles.includes(index) ? parameters[index] : WIDTHS[shape.kind][index].at(parameters);

  plain = ({ parameters, height }) => ({ parameters, height });

  found = () => {
    for (const variable of this.each()) {
      for (const term of variable.terms) if (this.termKey(variable, term) === this.chosen) return { variable, term };
    }
    return null;
  };

  build = () => {
    const names = this.each().map((variable) => variable.name);
    // A plot that a hand is on stays where it is.
    if (this.list.firstChild && JSON.stringify(names) === JSON.stringify([...this.plots.keys()])) {
      if (this.store.busy) this.grip(this.each().find((variable) => variable.name === this.moving));
    } else {
      this.list.replaceChildren(...(names.length ? [] : [el("p", { class: "note", textContent: S.noVariables })]));
      this.plots.clear();
      this.heads.clear();
      for (const variable of this.each()) {
        const plot = svg("svg", { role: "group", "aria-label": variable.name });
        const head = variableHead(this.hand, this.peakOfNew);
        this.plots.set(variable.name, plot);
        this.heads.set(variable.name, head);
        this.list.append(head.element, plot);
      }
    }
    this.tall = plotHeight(this.body.clientHeight, names.length);
    this.each().forEach((variable, v) => this.heads.get(variable.name).show(variable, this.roleOf(v)));
    this.describe();
    this.draw();
  };

  /** Where a new term of a variable stands: at the point, or in the middle. */
  peakOfNew = (variable) => {
    const [low, high] = rangeOf(variable);
    const input = this.store.scene.inputs.indexOf(variable);
    return this.rounded(input < 0 ? 0.5 * (low + high) : this.store.point[input], variable);
  };

  scale = (variable) => {
    const width = Math.max(160, this.wide);
    const [low, high] = rangeOf(variable);
    const x = (value) => LEFT + ((value - low) / (high - low)) * (width - LEFT - RIGHT);
    const back = (pixel) => low + ((pixel - LEFT) / (width - LEFT - RIGHT)) * (high - low);
    const y = (degree) => this.tall - BOTTOM - degree * (this.tall - TOP - BOTTOM);
    const degree = (pixel) => (this.tall - BOTTOM - pixel) / (this.tall - TOP - BOTTOM);
    return { width, low, high, x, y, back, degree };
  };

  // --- pictures ---

  draw = () => {
    if (!this.store.scene) return;
    const focused = /** @type {SVGElement} */ (document.activeElement)?.dataset?.handle;
    const only = this.partly; // the plot that a hand is on; the others have not changed
    this.partly = "";
    this.each().forEach((variable, v) => {
      if (!only || variable.name === only) this.drawOne(variable, v);
    });
    if (focused) {
      const same = [...this.list.querySelectorAll("[data-handle]")].find((e) => e.dataset.handle === focused);
      same?.focus({ preventScroll: true });
    }
    this.fill();
  };

  drawOne = (variable, v) => {
    const plot = this.plots.get(variable.name);
    const at = this.scale(variable);
    const parts = [];
    parts.push(svg("line", { class: "axis", x1: LEFT, x2: at.width - RIGHT, y1: at.y(0), y2: at.y(0) }));
    for (const tick of ticks(at.low, at.high, at.width / 55)) {
      parts.push(svg("text", { x: at.x(tick), y: this.tall - 4, "text-anchor": "middle" }, shortNumber(tick)));
    }
    if (v < this.store.scene.inputs.length) {
      const x = at.x(this.store.point[v]);
      parts.push(svg("line", { class: "at", x1: x, x2: x, y1: TOP, y2: at.y(0) }));
    }
    const handles = [];
    variable.terms.forEach((term, t) => {
      if (!term.curve) return;
      const isChosen = this.termKey(variable, term) === this.chosen;
      const own = isChosen ? "chosen" : "";
      const style = `stroke: ${hue(t)}`;
      const lines = sidesOf(term).map((shape) => this.curve(variable, shape, at));
      if (lines.length > 1) {
        const d = `${this.path(lines[0], at)}${this.path([...lines[1]].reverse(), at).replace("M", "L")}Z`;
        parts.push(svg("path", { d, class: "footprint", style: `fill: ${hue(t)}` }));
      }
      lines.forEach((points, side) => {
        parts.push(svg("path", { d: this.path(points, at), style, class: side ? `${own} lower` : own }));
      });
      handles.push(...this.handlesOf(variable, term, t, at, isChosen));
    });
    plot.setAttribute("width", at.width);
    plot.setAttribute("height", this.tall);
    plot.replaceChildren(...parts, ...handles);
  };

  curve = (variable, shape, at) => {
    const now = this.store.now(variable, shape);
    const corners = shape.straight ? cornersOf(shape, now.parameters, now.height) : null;
    if (!corners) {
      const xs = evenly([at.low, at.high], SMOOTH);
      const ys = this.store.degrees(variable, shape, xs, now);
      return Array.from(xs, (x, i) => [x, ys[i]]);
    }
    const last = corners.length - 2;
    const points = [[Math.min(at.low, corners[0]), corners[1]]];
    for (let i = 0; i <= last; i += 2) points.push([corners[i], corners[i + 1]]);
    points.push([Math.max(at.high, corners[last]), corners[last + 1]]);
    return points;
  };

  handlesOf = (variable, term, t, at, isChosen) => {
    const made = [];
    const top = this.peak(term, this.store.now(variable, term).parameters) ?? term.centre;
    if (top !== null) {
      const x = at.x(Math.min(at.high, Math.max(at.low, top)));
      const half = 3.6 * term.name.length; // about half of its width: it stays inside
      const anchor = x < half ? "start" : x > at.width - half ? "end" : "middle";
      made.push(
        svg(
          "text",
          {
            x: anchor === "start" ? 3 : anchor === "end" ? at.width - 3 : x,
            y: TOP - 6,
            "text-anchor": anchor,
            class: "term",
            style: `fill: ${hue(t)}`,
            ...this.target(variable, term, term, null, S.wholeTerm(variable.name, term.name), top, at),
          },
          term.name,
        ),
      );
    }
    for (const shape of sidesOf(term)) {
      const now = this.store.now(variable, shape);
      const style = `stroke: ${hue(t)}`;
      shape.handles.forEach((index, place) => {
        const value = now.parameters[index];
        if (!isChosen && (shape.side || value !== top)) return;
        if (value < at.low || value > at.high) return;
        const label = (shape.side ? S.lowerCorner : S.corner)(variable.name, term.name, place + 1);
        const own = this.target(variable, term, shape, index, label, value, at);
        const [cx, cy] = [at.x(value), at.y(this.heightAt(variable, shape, now, index, value))];
        made.push(svg("circle", { cx, cy, r: isChosen && !shape.side ? 5.5 : 4, style, ...own }));
      });
      if (!isChosen) continue;
      for (const [index, width] of Object.entries(WIDTHS[shape.kind] ?? {})) {
        const value = width.at(now.parameters);
        if (!(value >= at.low && value <= at.high)) continue;
        const said = S.width(variable.name, term.name, shape.names[index], Boolean(shape.side));
        const own = this.target(variable, term, shape, Number(index), said, value, at, now.parameters[index]);
        const [x, y] = [at.x(value), at.y(this.store.degrees(variable, shape, Float64Array.of(value), now)[0])];
        const d = `M${x - DIAMOND} ${y}L${x} ${y - DIAMOND}L${x + DIAMOND} ${y}L${x} ${y + DIAMOND}Z`;
        made.push(svg("path", { d, class: "width", style, ...own }));
      }
    }
    return made;
  };

  target = (variable, term, shape, index, label, value, at, said = value) => {
    return {
      tabindex: 0,
      role: "slider",
      "aria-label": label,
      "aria-valuenow": Math.min(at.high, Math.max(at.low, value)),
      "aria-valuemin": at.low,
      "aria-valuemax": at.high,
      "aria-valuetext": shortNumber(said, 6),
      "data-handle": `${shapeKey(variable, shape)}\n${index}`,
      "data-side": shape.side ?? 0,
      "data-variable": variable.name,
      "data-term": term.name,
      "data-index": index ?? "whole",
      onpointerdown: (event) => this.take(event, variable, term, shape, index),
      onkeydown: (event) => this.step(event, variable, term, shape, index),
      onfocus: () => this.choose(variable, term),
    };
  };

  choose = (variable, term) => {
    const key = this.termKey(variable, term);
    if (key !== this.chosen) {
      this.chosen = key;
      this.describe();
      this.redraw();
    }
  };

  heightAt = (variable, shape, now, index, value) => {
    if (shape.kind === "points") return now.parameters[index + 1] * now.height;
    if (shape.kind === "triangle") return index === 1 ? now.height : 0;
    if (shape.kind === "trapezoid") return index % 3 ? now.height : 0;
    return this.store.degrees(variable, shape, Float64Array.of(value), now)[0];
  };

  // --- numbers beside, and what is done with whole terms ---

  /** Build the line below the plots for the term that is chosen. */
  describe = () => {
    const one = this.found();
    this.details.hidden = !one;
    this.fields = [];
    if (!one) {
      this.details.replaceChildren();
      return;
    }
    const { variable, term } = one;
    const parts = [el("strong", { textContent: `${variable.name} ${term.name}` })];
    for (const shape of sidesOf(term)) {
      if (this.change && !shape.side && this.canChange(term)) parts.push(this.kindOf(variable, term));
      else parts.push(el("span", { textContent: shape.side ? `${S.overShape} ${shape.kind}` : shape.kind }));
      if (term.kind !== "formula" && term.kind !== "linear") parts.push(...this.fieldsOf(variable, term, shape));
    }
    if (this.change) {
      const button = (text, act) => el("button", { textContent: text, onclick: act });
      parts.push(
        space(),
        button(S.rename, () => this.rename(variable, term)),
        button(S.remove, () => this.change("term", { variable: variable.name, term: term.name })),
      );
    }
    const onKind = document.activeElement?.closest(".details .kind");
    const typed = document.activeElement?.closest(".details input");
    this.rebuilding = true;
    this.details.replaceChildren(...parts);
    this.rebuilding = false;
    this.fill();
    if (onKind) this.details.querySelector(".kind")?.focus(); // a kind after the other by the arrow keys
    if (typed) this.goOnTyping(typed);
  };

  /** A number that is being typed while the terms are drawn anew stays, with its cursor and what is wrong with it. */
  goOnTyping = (typed) => {
    const label = typed.getAttribute("aria-label");
    const field = this.fields.find((each) => each.field.getAttribute("aria-label") === label)?.field;
    if (!field) return;
    field.value = typed.value;
    sayWrong(field, typed.parentElement.querySelector(".wrong")?.textContent);
    field.focus();
    field.setSelectionRange(typed.selectionStart, typed.selectionEnd);
  };

  /** Choose the kind of the shape; the text keeps place and width as far as the kinds allow. */
  kindOf = (variable, term) => {
    const kinds = this.store.scene.kinds.includes(term.kind)
      ? this.store.scene.kinds
      : [term.kind, ...this.store.scene.kinds];
    const list = select(pairsOf(kinds), term.kind, {
      class: "kind",
      title: S.kindHint,
      "aria-label": S.kindOf(variable.name, term.name),
      onchange: async () => {
        const taken = await this.change("term", { variable: variable.name, term: term.name, kind: list.value });
        if (!taken) list.value = term.kind; // the status says why
      },
    });
    return list;
  };

  fieldsOf = (variable, term, shape) => {
    const side = shape.side ? `${S.overShape} ` : "";
    const count = shape.kind === "points" ? shape.parameters.length : shape.names.length;
    const name = (i) => shape.names[i] ?? `${i % 2 ? "y" : "x"}${Math.floor(i / 2) + 1}`;
    const made = Array.from({ length: count + 1 }, (_, i) => {
      const label = i < count ? name(i) : S.height;
      const { input: field, typed } = numberInput({
        title: label,
        readOnly: !this.edit,
        "aria-label": `${variable.name} ${term.name}, ${side}${label}`,
        onblur: () => commit(),
        onkeydown: (event) => event.key === "Enter" && commit(),
      });
      // Not on `change`, which a field that was put in the place of another does not have.
      const commit = () => {
        if (!this.rebuilding && field.value !== field.dataset.shown)
          this.put(variable, term, shape, i < count ? i : null, field);
      };
      this.fields.push({ field, variable, shape, index: i < count ? i : null });
      return typed;
    });
    return made;
  };

  /** Show the numbers of the chosen term as they are now. */
  fill = () => {
    for (const { field, variable, shape, index } of this.fields ?? []) {
      const now = this.store.now(variable, shape);
      const value = index === null ? now.height : now.parameters[index];
      const said = Number.isFinite(value) ? shortNumber(value, 8) : value > 0 ? "inf" : "-inf";
      if (document.activeElement !== field || field.value === field.dataset.shown) {
        field.value = said;
        sayWrong(field);
      }
      field.dataset.shown = said;
    }
  };

  put = (variable, term, shape, index, field) => {
    const value = readNumber(field.value.trim().replace(/^([+-]?)inf$/, "$1Infinity"));
    const isHeight = index !== null || (value > 0 && value <= 1);
    sayWrong(field, Number.isNaN(value) ? S.noNumber(field.value) : isHeight ? "" : S.noHeight);
    if (field.hasAttribute("aria-invalid")) return;
    this.begin(variable);
    const now = this.store.now(variable, shape);
    const parameters = index === null ? now.parameters : now.parameters.with(index, value);
    this.store.reshape(variable, shape, parameters, index === null ? value : now.height);
    this.drag = null;
    this.finish(variable.name);
  };

  rename = (variable, term) =>
    this.hand.rename(term.name, async (name) => {
      const answer = await this.hand.attempt("term", { variable: variable.name, term: term.name, name });
      if (!answer.error) this.chosen = this.termKey(variable, { name });
      return answer;
    });

  // --- moving ---

  /** Remember every shape of a variable as it is, to move from there. */
  begin = (variable) => {
    this.drag = { variable, from: new Map() };
    for (const shape of variable.terms.flatMap(sidesOf)) this.drag.from.set(shape, this.store.now(variable, shape));
  };

  take = (event, variable, term, shape, index) => {
    if (!this.edit) return;
    event.preventDefault();
    event.currentTarget.focus({ preventScroll: true });
    const at = this.scale(variable);
    const plot = this.plots.get(variable.name);
    const place = (each) => {
      const box = plot.getBoundingClientRect();
      return { x: at.back(each.clientX - box.left), degree: at.degree(each.clientY - box.top) };
    };
    this.begin(variable);
    const start = place(event);
    const old = this.drag.from.get(shape);
    const where = index === null ? 0 : this.handleAt(shape, old.parameters, index);
    // The plot keeps the pointer: handles are drawn anew while they move.
    plot.setPointerCapture(event.pointerId);
    this.grip(variable);
    plot.onpointermove = (each) => {
      const here = place(each);
      const rise = this.isRaised(shape, index) ? here.degree - start.degree : 0;
      this.shift(variable, term, shape, index, where + here.x - start.x, rise, each);
    };
    plot.onpointerup = plot.onpointercancel = () => {
      plot.onpointermove = plot.onpointerup = plot.onpointercancel = null;
      this.drag = null;
      this.finish(variable.name);
    };
  };

  /** Whether a handle moves up and down as well: corners of points, and tops of lower functions. */
  isRaised = (shape, index) => {
    if (index === null || !shape.handles.includes(index)) return false;
    if (shape.kind === "points") return true;
    const tops = { triangle: [1], trapezoid: [1, 2], pi: [1, 2], rectangle: [0, 1] }[shape.kind];
    return Boolean(shape.side) && (tops ? tops.includes(index) : shape.handles.length === 1);
  };

  /** Ask for the numbers of a variable that can be changed in place. */
  grip = (variable) => {
    this.store.busy = true;
    this.moving = variable.name;
    if (this.store.held?.variable === variable.name) return;
    this.numbers(variable.name).then((brought) => {
      if (brought) this.store.hold(variable, brought);
    });
  };

  step = (event, variable, term, shape, index) => {
    if (!ARROWS[event.key] || !this.edit) return;
    event.preventDefault();
    this.grip(variable);
    this.begin(variable);
    const [right, up] = ARROWS[event.key];
    const steps = (right + up) * (event.ctrlKey ? 10 : 1);
    const rises = this.isRaised(shape, index) && /Up|Down/.test(event.key);
    const old = this.drag.from.get(shape).parameters;
    const where = index === null ? 0 : this.handleAt(shape, old, index);
    const by = rises ? 0 : steps * this.unit(variable);
    this.shift(variable, term, shape, index, where + by, rises ? 0.05 * steps : 0, event);
    this.drag = null;
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.finish(variable.name), 350);
  };

  /** A round number, about a two-hundredth of the range. */
  unit = (variable) => {
    const [low, high] = rangeOf(variable);
    const power = 10 ** Math.floor(Math.log10((high - low) / 100));
    return power * ((high - low) / power > 400 ? 5 : (high - low) / power > 200 ? 2 : 1);
  };

  rounded = (value, variable) => {
    const step = this.snap.checked ? this.unit(variable) : this.unit(variable) / 100;
    return Number((Math.round(value / step) * step).toPrecision(12));
  };

  /** Move a handle to, or a whole term by, a number; neighbours and the mirror image as asked. */
  shift = (variable, term, shape, index, value, rise, event) => {
    const changed = new Map();
    if (index === null) {
      const by = this.rounded(value, variable);
      for (const side of sidesOf(term)) {
        const old = this.drag.from.get(side);
        changed.set(side, { ...this.plain(old), parameters: moved(side, old.parameters, null, 0, by) });
      }
    } else changed.set(shape, this.one(variable, shape, index, value, rise));
    if (this.partition.checked || event.altKey) {
      for (const [side, next] of [...changed]) this.neighbours(variable, side, next.parameters, changed);
    }
    if (this.mirror.checked || event.shiftKey) this.mirrored(variable, changed);
    for (const each of variable.terms) this.keepBelow(variable, each, changed);
    for (const [each, next] of changed) this.store.reshape(variable, each, next.parameters, next.height);
  };

  /** Parameters and height of a shape after one of its handles has moved. */
  one = (variable, shape, index, value, rise) => {
    const old = this.drag.from.get(shape);
    const tidy = (x, step) =>
      this.snap.checked ? Number((Math.round(x / step) * step).toPrecision(12)) : Number(x.toPrecision(6));
    if (!shape.handles.includes(index)) {
      const width = WIDTHS[shape.kind][index].to(old.parameters, this.rounded(value, variable));
      const sound = Number.isFinite(width) && Math.abs(width) > 1e-9;
      const said = Number(width.toPrecision(this.snap.checked ? 3 : 6));
      return { ...this.plain(old), parameters: sound ? old.parameters.with(index, said) : old.parameters };
    }
    const parameters = moved(shape, old.parameters, index, this.rounded(value, variable));
    if (!rise) return { parameters, height: old.height };
    if (shape.kind === "points") {
      const y = tidy(old.parameters[index + 1] + rise / old.height, 0.05);
      parameters[index + 1] = Math.min(1, Math.max(0, y));
      return { parameters, height: old.height };
    }
    const height = Math.min(1, Math.max(LEAST_HEIGHT, tidy(old.height + rise, 0.05)));
    return { parameters, height };
  };

  neighbours = (variable, shape, next, changed) => {
    const old = this.drag.from.get(shape).parameters;
    for (const other of variable.terms.flatMap(sidesOf)) {
      if (changed.has(other) || (other.side ?? 0) !== (shape.side ?? 0) || other.kind === "points") continue;
      const from = this.drag.from.get(other);
      const parameters = following(other, from.parameters, shape, old, next);
      if (parameters) changed.set(other, { ...this.plain(from), parameters });
    }
  };

  mirrored = (variable, changed) => {
    const [low, high] = rangeOf(variable);
    const moves = [...changed];
    for (const [shape, next] of moves) {
      const place = variable.terms.findIndex((term) => sidesOf(term).includes(shape));
      const term = variable.terms[variable.terms.length - 1 - place];
      const other = sidesOf(term)[shape.side ?? 0]; // the term in the middle is its own image
      if (!other || other.kind !== (TURNED[shape.kind] ?? shape.kind)) continue;
      const image = (parameters) => mirrorOf(shape.kind, parameters, low + high);
      const parameters = image(next.parameters);
      if (!parameters) continue;
      const own = changed.get(other) ?? null;
      const from = (each) => this.drag.from.get(each).parameters;
      const both = () =>
        joined(other, { old: from(other), next: own.parameters }, { old: image(from(shape)), next: parameters });
      changed.set(other, own ? { ...own, parameters: both() } : { parameters, height: next.height });
    }
  };

  /** Stop where the lower function of a term would rise above the upper one. */
  keepBelow = (variable, term, changed) => {
    if (!term.lower || !term.curve) return;
    const sides = sidesOf(term);
    if (!sides.some((side) => changed.has(side))) return;
    const from = sides.map((side) => this.drag.from.get(side));
    const to = sides.map((side, i) => changed.get(side) ?? from[i]);
    if (this.isBelow(variable, sides, to)) return;
    const between = (share) =>
      from.map((start, i) => ({
        parameters: start.parameters.map((x, k) => (Number.isFinite(x) ? x + share * (to[i].parameters[k] - x) : x)),
        height: start.height + share * (to[i].height - start.height),
      }));
    let [reach, beyond] = [0, 1];
    for (let i = 0; i < 12; i++) {
      const middle = 0.5 * (reach + beyond);
      if (this.isBelow(variable, sides, between(middle))) reach = middle;
      else beyond = middle;
    }
    const kept = between(reach);
    const short = kept.map(({ parameters, height }) => ({
      parameters: parameters.map((x) => Number(x.toPrecision(4))),
      height: Number(height.toPrecision(3)),
    }));
    const best = this.isBelow(variable, sides, short) ? short : kept;
    sides.forEach((side, i) => {
      if (changed.has(side)) changed.set(side, best[i]);
    });
  };

  isBelow = (variable, sides, numbers) => {
    const [[upper, lower], [high, low]] = [sides, numbers];
    const [start, end] = rangeOf(variable);
    const corners = [cornersOf(upper, high.parameters), cornersOf(lower, low.parameters)];
    const bends = corners.flatMap((found) => (found ?? []).filter((_, i) => i % 2 === 0));
    const even = evenly([start, end], SMOOTH);
    const xs = Float64Array.from([...even, ...bends.filter((x) => x >= start && x <= end)]);
    const above = this.store.degrees(variable, upper, xs, high);
    return this.store.degrees(variable, lower, xs, low).every((y, i) => y <= above[i] + 1e-12);
  };

  finish = (name) => {
    const variable = this.each().find((other) => other.name === name);
    this.store.busy = false;
    const isSame = (shape) => {
      const now = this.store.now(variable, shape);
      return now.height === shape.height && now.parameters.every((x, i) => x === shape.parameters[i]);
    };
    const said = (shape) => {
      const { parameters, height } = this.store.now(variable, shape);
      return { kind: shape.kind, parameters: parameters.map(sendable), height };
    };
    const shapes = variable.terms.flatMap((term) =>
      sidesOf(term).every(isSame)
        ? []
        : [{ variable: variable.name, term: term.name, ...said(term), lower: term.lower ? said(term.lower) : null }],
    );
    if (!shapes.length) return;
    Promise.resolve(this.edit(shapes)).then((taken) => {
      if (taken === false) this.store.forget();
    });
  };
}
