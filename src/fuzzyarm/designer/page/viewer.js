// Inference: sliders for the inputs, the rules with their sets filled to where the point lies, what
// they conclude, the aggregate, the value and why. Of interval type 2 both readings, and both ends.

import { clean, el, svg, pane, choice, shortNumber, eachFrame } from "./draw.js";
import { rangeOf, sidesOf } from "./store.js";
import { S } from "./strings.js";

const SAMPLES = 121;
const ROW = 27; // pixels of a rule
const SPARE = 2; // rules drawn beyond what is seen

/**
 * @param {Page.Store} store
 */
export function viewerPane(store) {
  const { section, bar, body } = pane("inference", S.inference);
  const sliders = el("div", { class: "sliders" });
  const why = el("div", { "aria-live": "polite" });
  const head = el("div", { class: "fired head" });
  const rows = el("div", { class: "rules-fired", tabIndex: 0, role: "group", "aria-label": S.rules });
  const foot = el("div", { class: "fired foot" });
  let inputs = [];
  let order = "strength";
  bar.append(
    el("span", { class: "space" }),
    choice(
      S.order,
      [
        ["strength", S.strongest],
        ["text", S.asWritten],
      ],
      order,
      (to) => {
        order = to;
        rows.scrollTop = 0;
        draw();
      },
    ),
  );
  body.append(sliders, why, head, rows, foot);

  function build() {
    sliders.replaceChildren();
    inputs = store.scene.inputs.map((variable, i) => {
      const [low, high] = rangeOf(variable);
      const set = (value) => {
        if (Number.isFinite(value)) store.setPoint(i, value);
      };
      const label = el("label", { textContent: variable.name, title: variable.description || variable.name });
      const range = el("input", {
        type: "range",
        min: low,
        max: high,
        step: (high - low) / 400,
        id: `input-${i}`,
        oninput: () => set(Number(range.value)),
      });
      label.htmlFor = range.id;
      const number = el("input", {
        type: "text",
        inputMode: "decimal",
        "aria-label": `${variable.name}: ${S.value}`,
        onchange: () => set(Number(number.value)),
      });
      sliders.append(el("div", { class: "slider" }, label, range, number));
      return { range, number };
    });
    const { scene } = store;
    const first = scene.rules.some((rule) => rule.readings.length > 1) ? "8.4em" : "5.4em";
    const columns = `${first} repeat(${scene.inputs.length + scene.outputs.length}, minmax(0, 1fr))`;
    for (const part of [head, foot]) part.style.gridTemplateColumns = columns;
    rows.style.setProperty("--columns", columns);
    head.replaceChildren(
      el("span"),
      ...[...scene.inputs, ...scene.outputs].map((variable) =>
        el("strong", { class: "cell", textContent: variable.name }),
      ),
    );
    draw();
  }

  function draw() {
    if (!store.scene) return;
    inputs.forEach(({ range, number }, i) => {
      range.value = store.point[i];
      if (document.activeElement !== number) number.value = shortNumber(store.point[i], 6);
    });
    if (store.scene.missing.length) {
      why.replaceChildren();
      for (const part of [head, rows, foot]) part.hidden = true;
      return;
    }
    const found = store.fired();
    const isKnown = found || store.running;
    for (const part of [head, rows, foot]) part.hidden = !found;
    if (!isKnown) {
      why.replaceChildren(el("p", { class: "note", textContent: store.refused || S.notHere(store.scene.reason) }));
      return;
    }
    why.replaceChildren(...reasons(found));
    if (!found) return;
    list(found);
    foot.replaceChildren(
      el("span"),
      ...store.scene.inputs.map(() => el("span")),
      ...store.scene.outputs.map((output, o) => whole(output, o, found)),
    );
  }

  const small = (x) => (x > 0 && x < 1e-3 ? x.toExponential(0) : shortNumber(x, 3));
  const degree = (found, number) => {
    const [high, low] = [found.strengths[number], found.lower[number]].map(small);
    return high === low ? high : S.between(low, high);
  };

  function reasons(found) {
    return store.scene.outputs.map((output, o) => {
      const value = found?.outputs[o];
      const line = el("p", { class: "why" });
      const ends = output.interval && found?.ends?.[o].every(Number.isFinite) ? found.ends[o] : null;
      const interval = ends ? ` ${S.interval(...ends.map((x) => shortNumber(x, 6)))}` : "";
      const said = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
      line.append(el("output", { textContent: `${output.name} = ${said}${interval}` }));
      let first = -1;
      store.scene.rules.forEach((rule, number) => {
        const strength = found?.strengths[number] ?? 0;
        const concludes = rule.concludes.some(([k]) => k === o);
        if (concludes && strength > (first < 0 ? 0 : found.strengths[first])) first = number;
      });
      const reason =
        first >= 0
          ? ` ${S.because} ${store.scene.rules[first].text} (${S.strength} ${degree(found, first)}, ${store.scene.rules[first].place})`
          : ` – ${S.nothingFires}`;
      line.append(clean(reason));
      return line;
    });
  }

  /** Draw the rules that are seen; those above and below are as much room. */
  function list(found) {
    const { rules } = store.scene;
    let numbers = rules.map((_, number) => number);
    if (order === "strength") {
      numbers = numbers.filter((number) => found.strengths[number] > 0);
      numbers.sort((a, b) => found.strengths[b] - found.strengths[a]);
    }
    const first = Math.max(0, Math.floor(rows.scrollTop / ROW) - SPARE);
    const last = Math.min(numbers.length, first + Math.ceil((rows.clientHeight || 200) / ROW) + 2 * SPARE);
    const room = (count) => {
      const made = el("div");
      made.style.height = `${count * ROW}px`;
      return made;
    };
    rows.replaceChildren(
      room(first),
      ...numbers.slice(first, last).map((number) => row(found, number)),
      room(numbers.length - last),
    );
  }

  function row(found, number) {
    const { scene } = store;
    const rule = scene.rules[number];
    const made = el("div", {
      class: found.strengths[number] > 0 ? "fired" : "fired silent",
      title: `${rule.place}: ${rule.text} (${S.strength} ${degree(found, number)})`,
    });
    made.append(el("span", { class: "degree" }, el("span", { textContent: rule.place }), degree(found, number)));
    scene.inputs.forEach((variable, i) => made.append(premise(variable, i, rule)));
    scene.outputs.forEach((output, o) => made.append(conclusion(output, o, rule, found, number)));
    return made;
  }

  // --- pictures, 100 wide and 1 high ---

  function picture(label, kind, ...parts) {
    const title = svg("title", {}, label);
    return svg(
      "svg",
      { viewBox: "0 -1.04 100 1.1", preserveAspectRatio: "none", role: "img", "aria-label": label, class: kind },
      title,
      svg("line", { class: "base", x1: 0, x2: 100, y1: 0, y2: 0 }),
      ...parts,
    );
  }

  const samples = (variable) => {
    const [low, high] = rangeOf(variable);
    return Float64Array.from({ length: SAMPLES }, (_, i) => low + ((high - low) * i) / (SAMPLES - 1));
  };
  const across = (i) => ((100 * i) / (SAMPLES - 1)).toFixed(2);
  const line = (y) => Array.from(y, (v, i) => `${i ? "L" : "M"}${across(i)} ${(-v).toFixed(3)}`).join("");
  const area = (y) => `${line(y)}L100 0L0 0Z`;
  const filled = (y, side) => svg("path", { class: side ? "cut lower" : "cut", d: area(y) });
  const outline = (y, side) => svg("path", { class: side ? "set lower" : "set", d: line(y) });

  const share = (variable, value) => {
    const [low, high] = rangeOf(variable);
    return (100 * (value - low)) / (high - low);
  };

  function mark(variable, value) {
    const x = share(variable, value);
    return svg("line", { x1: x, x2: x, y1: -1.04, y2: 0 });
  }

  function premise(variable, i, rule) {
    const parts = [];
    const words = [];
    for (const [input, name, hedges] of rule.parts) {
      const term = variable.terms.find((each) => input === i && each.name === name);
      if (!term?.curve) continue;
      const degrees = sidesOf(term).map((shape) => {
        const y = store.degrees(variable, shape, samples(variable));
        const at = store.degrees(variable, shape, Float64Array.of(store.point[i]))[0];
        const side = shape.side ?? 0;
        parts.push(
          filled(
            y.map((v) => Math.min(v, at)),
            side,
          ),
          outline(y, side),
        );
        return shortNumber(at, 3);
      });
      words.push(`${hedges} ${name}: ${degrees.length > 1 ? S.between(degrees[1], degrees[0]) : degrees[0]}`.trim());
    }
    if (!parts.length) return el("span");
    return picture(`${variable.name} ${words.join(", ")}`, "", ...parts, mark(variable, store.point[i]));
  }

  /** Degrees of a consequent at the samples, as it is now. */
  function setOf(output, member) {
    const term = output.terms.find((each) => each.name === member.term);
    const shape = member.isLower ? (term?.lower ?? term) : term;
    if (shape?.curve && !member.hedged) return store.degrees(output, shape, samples(output));
    const numbers = Float64Array.from(member.curve.numbers);
    return store.curves.degrees(member.curve.address, numbers, samples(output));
  }

  function conclusion(output, o, rule, found, number) {
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
          if (member.value !== null) parts.push(stem(output, member.value, strengths[number]));
          continue;
        }
        const y = setOf(output, member);
        const cut = new Float64Array(SAMPLES);
        store.curves.cut(member.implication, 2, strengths[number], y, cut);
        parts.push(filled(cut, side), outline(y, side));
      }
    });
    return words.length ? picture(`${output.name} ${words.join(", ")}`, "", ...parts) : el("span");
  }

  function stem(output, value, height) {
    const x = share(output, value);
    return svg("line", { x1: x, x2: x, y1: -height, y2: 0 });
  }

  function whole(output, o, found) {
    const parts = [];
    for (const side of output.twoSided ? [0, 1] : [0]) {
      const aggregate = new Float64Array(SAMPLES);
      output.members.forEach((member, index) => {
        const height = found.heights[o][index];
        if (!(height > 0) || member.side !== side) return;
        if (member.curve !== null) {
          store.curves.cut(member.implication, output.aggregation, height, setOf(output, member), aggregate);
        } else if (member.value !== null) parts.push(stem(output, member.value, height));
      });
      if (aggregate.some((v) => v > 0)) parts.unshift(filled(aggregate, side));
    }
    const value = found.outputs[o];
    let said = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
    const ends = output.interval ? found.ends?.[o] : null;
    if (ends?.every(Number.isFinite)) {
      const [left, right] = ends.map((end) => share(output, end));
      parts.push(
        svg("rect", { class: "interval", x: left, width: Math.max(0.2, right - left), y: -1.04, height: 1.04 }),
      );
      said += ` ${S.interval(...ends.map((x) => shortNumber(x, 6)))}`;
    }
    if (Number.isFinite(value)) parts.push(mark(output, value));
    return picture(`${S.aggregate}: ${output.name} = ${said}`, "whole", ...parts);
  }

  const redraw = eachFrame(draw);
  store.on("scene", build);
  for (const name of ["reshaped", "point", "told"]) store.on(name, redraw);
  rows.addEventListener("scroll", redraw);
  new ResizeObserver(redraw).observe(rows);
  return section;
}
