// Inference: sliders for the inputs, the rules with their sets filled to where the point lies, what
// they conclude, the aggregate, the value and why. Of interval type 2 both readings, and both ends.

import {
  choice,
  clean,
  eachFrame,
  el,
  numberInput,
  readNumber,
  sayWrong,
  shortNumber,
  slider,
  space,
  svg,
} from "./draw.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { evenly } from "./geometry/chart.js";
import { rangeOf, shareAlong, sidesOf } from "./geometry/shapes.js";

const SAMPLES = 121;
const ROW = 27; // pixels of a rule
const SPARE = 2; // rules drawn beyond what is seen

/** The pane; with `start` the server computes what the page does not. */
export class ViewerPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "inference", S.inference);
    const { bar, body } = this;
    this.sliders = el("div", { class: "sliders" });
    this.why = el("div", { "aria-live": "polite" });
    this.head = el("div", { class: "fired head" });
    this.rows = el("div", { class: "rules-fired", tabIndex: 0, role: "group", "aria-label": S.rules });
    this.foot = el("div", { class: "fired foot" });
    this.inputs = [];
    this.order = "strength";
    bar.append(
      space(),
      choice(
        S.order,
        [
          ["strength", S.strongest],
          ["text", S.asWritten],
        ],
        this.order,
        (to) => {
          this.order = to;
          this.rows.scrollTop = 0;
          this.draw();
        },
      ),
    );
    body.append(this.sliders, this.why, this.head, this.rows, this.foot);

    const redraw = eachFrame(this.draw);
    this.store.on("scene", this.build);
    this.on(["reshaped", "point", "told"], redraw);
    this.rows.addEventListener("scroll", redraw);
    new ResizeObserver(redraw).observe(this.rows);
  }

  small = (x) => (x > 0 && x < 1e-3 ? x.toExponential(0) : shortNumber(x, 3));
  degree = (found, number) => {
    const [high, low] = [found.strengths[number], found.lower[number]].map(this.small);
    return high === low ? high : S.between(low, high);
  };

  samples = (variable) => evenly(rangeOf(variable), SAMPLES);
  across = (i) => ((100 * i) / (SAMPLES - 1)).toFixed(2);
  line = (y) => Array.from(y, (v, i) => `${i ? "L" : "M"}${this.across(i)} ${(-v).toFixed(3)}`).join("");
  area = (y) => `${this.line(y)}L100 0L0 0Z`;
  filled = (y, side) => svg("path", { class: side ? "cut lower" : "cut", d: this.area(y) });
  outline = (y, side) => svg("path", { class: side ? "set lower" : "set", d: this.line(y) });

  share = (variable, value) => 100 * shareAlong(variable, value);

  build = () => {
    this.sliders.replaceChildren();
    this.inputs = this.store.scene.inputs.map((variable, i) => {
      const set = (value) => this.store.setPoint(i, value);
      const label = el("label", { textContent: variable.name, title: variable.description || variable.name });
      const range = slider(rangeOf(variable), set, { id: `input-${i}` });
      label.htmlFor = range.id;
      const { input: number, typed } = numberInput({
        "aria-label": `${variable.name}: ${S.value}`,
        onchange: () => this.take(i, number),
        onblur: this.draw,
      });
      this.sliders.append(el("div", { class: "slider" }, label, range, typed));
      return { range, number, shown: "" };
    });
    const { scene } = this.store;
    const first = scene.rules.some((rule) => rule.readings.length > 1) ? "9.5em" : "5.4em"; // both ends of a strength, or one
    const columns = `${first} repeat(${scene.inputs.length + scene.outputs.length}, minmax(0, 1fr))`;
    for (const part of [this.head, this.foot]) part.style.gridTemplateColumns = columns;
    this.rows.style.setProperty("--columns", columns);
    this.head.replaceChildren(
      el("span"),
      ...[...scene.inputs, ...scene.outputs].map((variable) =>
        el("strong", { class: "cell", textContent: variable.name }),
      ),
    );
    this.draw();
  };

  /** Move the point to where a hand says; what cannot be taken stays as it is typed, with the reason beside it. */
  take = (i, number) => {
    const variable = this.store.scene.inputs[i];
    const value = readNumber(number.value);
    const [low, high] = rangeOf(variable);
    const isInside = value >= low && value <= high;
    const range = [low, high].map((end) => shortNumber(end, 6));
    const isClamped = !isInside && variable.outside === "clamp";
    const beyond = S.outside(value, ...range) + (isClamped ? S.countsAs(range[value < low ? 0 : 1]) : "");
    if (isInside || (isClamped && Number.isFinite(value))) this.store.setPoint(i, value);
    if (isClamped) this.inputs[i].shown = shortNumber(this.store.point[i], 6); // what is said stays
    sayWrong(number, !Number.isFinite(value) ? S.noNumber(number.value) : isInside ? "" : beyond);
  };

  draw = () => {
    if (!this.store.scene) return;
    this.inputs.forEach((each, i) => {
      const { range, number } = each;
      const said = shortNumber(this.store.point[i], 6);
      range.value = this.store.point[i];
      if (said !== each.shown) sayWrong(number); // the point has moved: it says where to
      if (document.activeElement !== number && !number.hasAttribute("aria-invalid")) number.value = said;
      each.shown = said;
    });
    if (this.store.scene.missing.length) {
      this.why.replaceChildren();
      for (const part of [this.head, this.rows, this.foot]) part.hidden = true;
      return;
    }
    const found = this.store.fired();
    const isKnown = found || this.store.running;
    for (const part of [this.head, this.rows, this.foot]) part.hidden = !found;
    if (!isKnown) {
      const { refused, scene } = this.store;
      const words = refused || (this.hand.start ? S.asking : S.notHere)(scene.reason);
      this.why.replaceChildren(el("p", { class: "note", textContent: words }));
      return;
    }
    this.why.replaceChildren(...this.reasons(found));
    if (!found) return;
    this.list(found);
    this.foot.replaceChildren(
      el("span"),
      ...this.store.scene.inputs.map(() => el("span")),
      ...this.store.scene.outputs.map((output, o) => this.whole(output, o, found)),
    );
  };

  reasons = (found) => {
    return this.store.scene.outputs.map((output, o) => {
      const value = found?.outputs[o];
      const line = el("p", { class: "why" });
      const ends = output.interval && found?.ends?.[o].every(Number.isFinite) ? found.ends[o] : null;
      const interval = ends ? ` ${S.interval(...ends.map((x) => shortNumber(x, 6)))}` : "";
      const said = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
      line.append(el("output", { textContent: `${output.name} = ${said}${interval}` }));
      let first = -1;
      this.store.scene.rules.forEach((rule, number) => {
        const strength = found?.strengths[number] ?? 0;
        const concludes = rule.concludes.some(([k]) => k === o);
        if (concludes && strength > (first < 0 ? 0 : found.strengths[first])) first = number;
      });
      const reason =
        first >= 0
          ? ` ${S.because} ${this.store.scene.rules[first].text} (${S.strength} ${this.degree(found, first)}, ${this.store.scene.rules[first].place})`
          : ` – ${S.nothingFires}`;
      line.append(clean(reason));
      return line;
    });
  };

  /** Draw the rules that are seen; those above and below are as much room. */
  list = (found) => {
    const { rules } = this.store.scene;
    let numbers = rules.map((_, number) => number);
    if (this.order === "strength") {
      numbers = numbers.filter((number) => found.strengths[number] > 0);
      numbers.sort((a, b) => found.strengths[b] - found.strengths[a]);
    }
    const first = Math.max(0, Math.floor(this.rows.scrollTop / ROW) - SPARE);
    const last = Math.min(numbers.length, first + Math.ceil((this.rows.clientHeight || 200) / ROW) + 2 * SPARE);
    const room = (count) => {
      const made = el("div");
      made.style.height = `${count * ROW}px`;
      return made;
    };
    this.rows.replaceChildren(
      room(first),
      ...numbers.slice(first, last).map((number) => this.row(found, number)),
      room(numbers.length - last),
    );
  };

  row = (found, number) => {
    const { scene } = this.store;
    const rule = scene.rules[number];
    const made = el("div", {
      class: found.strengths[number] > 0 ? "fired" : "fired silent",
      title: `${rule.place}: ${rule.text} (${S.strength} ${this.degree(found, number)})`,
    });
    made.append(el("span", { class: "degree" }, el("span", { textContent: rule.place }), this.degree(found, number)));
    scene.inputs.forEach((variable, i) => made.append(this.premise(variable, i, rule)));
    scene.outputs.forEach((output, o) => made.append(this.conclusion(output, o, rule, found, number)));
    return made;
  };

  // --- pictures, 100 wide and 1 high ---

  picture = (label, kind, ...parts) => {
    const title = svg("title", {}, label);
    return svg(
      "svg",
      { viewBox: "0 -1.04 100 1.1", preserveAspectRatio: "none", role: "img", "aria-label": label, class: kind },
      title,
      svg("line", { class: "base", x1: 0, x2: 100, y1: 0, y2: 0 }),
      ...parts,
    );
  };

  mark = (variable, value) => {
    const x = this.share(variable, value);
    return svg("line", { x1: x, x2: x, y1: -1.04, y2: 0 });
  };

  premise = (variable, i, rule) => {
    const parts = [];
    const words = [];
    for (const [input, name, hedges] of rule.parts) {
      const term = variable.terms.find((each) => input === i && each.name === name);
      if (!term?.curve) continue;
      const degrees = sidesOf(term).map((shape) => {
        const y = this.store.degrees(variable, shape, this.samples(variable));
        const at = this.store.degrees(variable, shape, Float64Array.of(this.store.point[i]))[0];
        const side = shape.side ?? 0;
        parts.push(
          this.filled(
            y.map((v) => Math.min(v, at)),
            side,
          ),
          this.outline(y, side),
        );
        return shortNumber(at, 3);
      });
      words.push(`${hedges} ${name}: ${degrees.length > 1 ? S.between(degrees[1], degrees[0]) : degrees[0]}`.trim());
    }
    if (!parts.length) return el("span");
    return this.picture(`${variable.name} ${words.join(", ")}`, "", ...parts, this.mark(variable, this.store.point[i]));
  };

  /** Degrees of a consequent at the samples, as it is now. */
  setOf = (output, member) => {
    const term = output.terms.find((each) => each.name === member.term);
    const shape = member.isLower ? (term?.lower ?? term) : term;
    if (shape?.curve && !member.hedged) return this.store.degrees(output, shape, this.samples(output));
    const numbers = Float64Array.from(member.curve.numbers);
    return this.store.curves.degrees(member.curve.address, numbers, this.samples(output));
  };

  conclusion = (output, o, rule, found, number) => {
    const parts = [];
    const words = [];
    const sides = [
      [rule.concludes, found.strengths],
      [rule.concludesLower, found.lower],
    ];
    sides.forEach(([concludes, strengths], side) => {
      for (const [k, index] of concludes) {
        const member = output.members[index];
        if (k !== o) continue;
        if (!side) words.push(member.words);
        if (member.curve === null) {
          if (member.value !== null) parts.push(this.stem(output, member.value, strengths[number]));
          continue;
        }
        const y = this.setOf(output, member);
        const cut = new Float64Array(SAMPLES);
        this.store.curves.cut(member.implication, 2, strengths[number], y, cut);
        parts.push(this.filled(cut, side), this.outline(y, side));
      }
    });
    return words.length ? this.picture(`${output.name} ${words.join(", ")}`, "", ...parts) : el("span");
  };

  stem = (output, value, height) => {
    const x = this.share(output, value);
    return svg("line", { x1: x, x2: x, y1: -height, y2: 0 });
  };

  whole = (output, o, found) => {
    const parts = [];
    for (const side of output.twoSided ? [0, 1] : [0]) {
      const aggregate = new Float64Array(SAMPLES);
      output.members.forEach((member, index) => {
        const height = found.heights[o][index];
        if (!(height > 0) || member.side !== side) return;
        if (member.curve !== null) {
          this.store.curves.cut(member.implication, output.aggregation, height, this.setOf(output, member), aggregate);
        } else if (member.value !== null) parts.push(this.stem(output, member.value, height));
      });
      if (aggregate.some((v) => v > 0)) parts.unshift(this.filled(aggregate, side));
    }
    const value = found.outputs[o];
    let said = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
    const ends = output.interval ? found.ends?.[o] : null;
    if (ends?.every(Number.isFinite)) {
      const [left, right] = ends.map((end) => this.share(output, end));
      parts.push(
        svg("rect", { class: "interval", x: left, width: Math.max(0.2, right - left), y: -1.04, height: 1.04 }),
      );
      said += ` ${S.interval(...ends.map((x) => shortNumber(x, 6)))}`;
    }
    if (Number.isFinite(value)) parts.push(this.mark(output, value));
    return this.picture(`${S.aggregate}: ${output.name} = ${said}`, "whole", ...parts);
  };
}
