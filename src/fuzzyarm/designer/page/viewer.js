// Inference: sliders for the inputs, the rules that fire with their cut sets, the value and why.

import { clean, el, svg, pane, shortNumber, eachFrame } from "./draw.js";
import { rangeOf } from "./store.js";
import { S } from "./strings.js";

const MOST = 6; // rules that are shown
const SAMPLES = 121;

export function viewerPane(store) {
  const { section, body } = pane("inference", S.inference);
  const sliders = el("div");
  const shown = el("div", { "aria-live": "polite" });
  let inputs = [];
  body.append(sliders, shown);

  function build() {
    sliders.replaceChildren();
    inputs = store.scene.inputs.map((variable, i) => {
      const [low, high] = rangeOf(variable);
      const set = (value) => {
        if (Number.isFinite(value)) store.setPoint(i, value);
      };
      const label = el("label", { textContent: variable.name, title: variable.description || variable.name });
      const range = el("input", {
        type: "range", min: low, max: high, step: (high - low) / 400, id: `input-${i}`,
        oninput: () => set(Number(range.value)),
      });
      label.htmlFor = range.id;
      const number = el("input", {
        type: "text", inputMode: "decimal", "aria-label": `${variable.name}: ${S.value}`,
        onchange: () => set(Number(number.value)),
      });
      sliders.append(el("div", { class: "slider" }, label, range, number));
      return { range, number };
    });
    draw();
  }

  function draw() {
    if (!store.scene) return;
    inputs.forEach(({ range, number }, i) => {
      range.value = store.point[i];
      if (document.activeElement !== number) number.value = shortNumber(store.point[i], 6);
    });
    if (!store.running) {
      shown.replaceChildren(el("p", { class: "note", textContent: S.notHere(store.scene.reason) }));
      return;
    }
    const found = store.fired();
    const parts = [];
    const strongest = found
      ? Array.from(found.strengths, (strength, number) => [strength, number])
          .filter(([strength]) => strength > 0).sort((a, b) => b[0] - a[0])
      : [];
    parts.push(...why(found, strongest));
    if (strongest.length) parts.push(table(found, strongest));
    shown.replaceChildren(...parts);
  }

  function why(found, strongest) {
    return store.scene.outputs.map((output, o) => {
      const value = found?.outputs[o];
      const line = el("p", { class: "why" });
      const said = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
      line.append(el("output", { textContent: `${output.name} = ${said}` }));
      const first = strongest.find(([, number]) => store.scene.rules[number].concludes.some(([k]) => k === o));
      const reason = first
        ? ` ${S.because} ${store.scene.rules[first[1]].text} (${S.strength} ${shortNumber(first[0], 3)})`
        : ` – ${S.nothingFires}`;
      line.append(clean(reason));
      return line;
    });
  }

  function table(found, strongest) {
    const { scene } = store;
    const made = el("div", { class: "fired" });
    const width = scene.inputs.length + scene.outputs.length;
    made.style.gridTemplateColumns = `3.4em repeat(${width}, minmax(0, 1fr))`;
    made.append(el("span"));
    for (const variable of [...scene.inputs, ...scene.outputs]) {
      made.append(el("strong", { class: "cell", textContent: variable.name }));
    }
    for (const [strength, number] of strongest.slice(0, MOST)) {
      made.append(el("span", { textContent: shortNumber(strength, 3), title: scene.rules[number].text }));
      scene.inputs.forEach((variable, i) => made.append(premise(variable, i, scene.rules[number])));
      scene.outputs.forEach((output, o) => made.append(conclusion(output, o, scene.rules[number], strength)));
    }
    const rest = strongest.length - MOST;
    made.append(el("span", { textContent: rest > 0 ? "…" : "", title: rest > 0 ? S.more(rest) : "" }));
    scene.inputs.forEach((_, i) => {
      made.append(el("span", { class: "cell", textContent: i || rest <= 0 ? "" : S.more(rest) }));
    });
    scene.outputs.forEach((output, o) => made.append(whole(output, o, found)));
    return made;
  }

  // --- pictures, 100 wide and 1 high ---

  function picture(label, kind, ...parts) {
    const title = svg("title", {}, label);
    return svg("svg", {
      viewBox: "0 -1.04 100 1.1", preserveAspectRatio: "none", role: "img", "aria-label": label, class: kind,
    }, title, svg("line", { class: "base", x1: 0, x2: 100, y1: 0, y2: 0 }), ...parts);
  }

  const samples = (variable) => {
    const [low, high] = rangeOf(variable);
    return Float64Array.from({ length: SAMPLES }, (_, i) => low + ((high - low) * i) / (SAMPLES - 1));
  };
  const across = (i) => ((100 * i) / (SAMPLES - 1)).toFixed(2);
  const line = (y) => Array.from(y, (v, i) => `${i ? "L" : "M"}${across(i)} ${(-v).toFixed(3)}`).join("");
  const area = (y) => `${line(y)}L100 0L0 0Z`;

  function mark(variable, value) {
    const [low, high] = rangeOf(variable);
    const x = (100 * (value - low)) / (high - low);
    return svg("line", { x1: x, x2: x, y1: -1.04, y2: 0 });
  }

  function premise(variable, i, rule) {
    const parts = [];
    const words = [];
    for (const [input, name, hedges] of rule.parts) {
      const term = variable.terms.find((each) => input === i && each.name === name);
      if (!term?.curve) continue;
      const y = store.degrees(variable, term, samples(variable));
      const degree = store.degrees(variable, term, Float64Array.of(store.point[i]))[0];
      words.push(`${hedges} ${name}: ${shortNumber(degree, 3)}`.trim());
      parts.push(svg("path", { class: "cut", d: area(y.map((v) => Math.min(v, degree))) }));
      parts.push(svg("path", { class: "set", d: line(y) }));
    }
    if (!parts.length) return el("span");
    return picture(`${variable.name} ${words.join(", ")}`, "", ...parts, mark(variable, store.point[i]));
  }

  /** Degrees of a consequent at the samples, as it is now. */
  function setOf(output, member) {
    const term = output.terms.find((each) => each.name === member.term);
    if (term?.curve && member.words === member.term) return store.degrees(output, term, samples(output));
    const numbers = Float64Array.from(member.curve.numbers);
    return store.engine.degrees(member.curve.address, numbers, samples(output));
  }

  function conclusion(output, o, rule, strength) {
    const parts = [];
    const words = [];
    for (const [k, index] of rule.concludes) {
      const member = output.members[index];
      if (k !== o) continue;
      words.push(member.words);
      if (member.curve === null) {
        if (member.value !== null) parts.push(stem(output, member.value, strength));
        continue;
      }
      const y = setOf(output, member);
      const cut = new Float64Array(SAMPLES);
      store.engine.cut(member.implication, 2, strength, y, cut);
      parts.push(svg("path", { class: "cut", d: area(cut) }), svg("path", { class: "set", d: line(y) }));
    }
    return words.length ? picture(`${output.name} ${words.join(", ")}`, "", ...parts) : el("span");
  }

  function stem(output, value, height) {
    const [low, high] = rangeOf(output);
    const x = (100 * (value - low)) / (high - low);
    return svg("line", { x1: x, x2: x, y1: -height, y2: 0 });
  }

  function whole(output, o, found) {
    const aggregate = new Float64Array(SAMPLES);
    const parts = [];
    output.members.forEach((member, index) => {
      const height = found.heights[o][index];
      if (!(height > 0)) return;
      if (member.curve !== null) {
        store.engine.cut(member.implication, output.aggregation, height, setOf(output, member), aggregate);
      } else if (member.value !== null) parts.push(stem(output, member.value, height));
    });
    const value = found.outputs[o];
    const said = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
    if (aggregate.some((v) => v > 0)) parts.unshift(svg("path", { class: "cut", d: area(aggregate) }));
    if (Number.isFinite(value)) parts.push(mark(output, value));
    return picture(`${S.aggregate}: ${output.name} = ${said}`, "whole", ...parts);
  }

  const redraw = eachFrame(draw);
  store.on("scene", build);
  store.on("reshaped", redraw);
  store.on("point", redraw);
  return section;
}
