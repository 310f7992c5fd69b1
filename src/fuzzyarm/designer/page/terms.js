// Terms: the membership functions of every variable, with corners that a hand can move.

import { el, svg, pane, hue, shortNumber, ticks, eachFrame } from "./draw.js";
import { rangeOf, cornersOf } from "./store.js";
import { S } from "./strings.js";

const HEIGHT = 98;
const [LEFT, RIGHT, TOP, BOTTOM] = [14, 14, 30, 17];
const SMOOTH = 161;

/** Parameters of a term after one of them (null: all positions) has moved to or by a number. */
export function moved(term, parameters, index, to, by) {
  const next = [...parameters];
  if (index === null) {
    for (const i of term.handles) next[i] = parameters[i] + by;
    return next;
  }
  const place = term.handles.indexOf(index);
  if (term.ordered || term.kind === "points") {
    const before = parameters[term.handles[place - 1]] ?? -Infinity;
    const behind = parameters[term.handles[place + 1]] ?? Infinity;
    to = Math.min(behind, Math.max(before, to));
  }
  next[index] = to;
  return next;
}

/** The pane; `edit` takes the shapes when a hand lets go, `numbers` brings those of a variable. */
export function termsPane(store, { edit, numbers }) {
  const { section, bar, body } = pane("terms", S.terms);
  const option = (text, title, checked) => {
    const box = el("input", { type: "checkbox", checked });
    bar.append(el("label", { class: "small", title }, box, text));
    return box;
  };
  bar.append(el("span", { class: "space" }));
  const partition = option(S.partition, S.partitionHint, false);
  const mirror = option(S.mirror, S.mirrorHint, false);
  const snap = option(S.snap, S.snapHint, true);
  const plots = new Map();
  let chosen = ""; // "variable term" whose corners are shown
  let drag = null;
  let moving = ""; // the variable that a hand is on
  let waiting = 0;
  let wide = 0; // of the plots; asked for when it changes, as asking lays the page out
  let partly = "";

  const each = () => [...store.scene.inputs, ...store.scene.outputs];

  function build() {
    const names = each().map((variable) => variable.name);
    // A plot that a hand is on stays where it is.
    if (JSON.stringify(names) === JSON.stringify([...plots.keys()])) {
      if (store.busy) grip(each().find((variable) => variable.name === moving));
      draw();
      return;
    }
    body.replaceChildren();
    plots.clear();
    for (const variable of each()) {
      const plot = svg("svg", { height: HEIGHT, role: "group", "aria-label": variable.name });
      plots.set(variable.name, plot);
      body.append(plot);
    }
    draw();
  }

  function scale(variable) {
    const width = Math.max(160, wide);
    const [low, high] = rangeOf(variable);
    const x = (value) => LEFT + ((value - low) / (high - low)) * (width - LEFT - RIGHT);
    const back = (pixel) => low + ((pixel - LEFT) / (width - LEFT - RIGHT)) * (high - low);
    const y = (degree) => HEIGHT - BOTTOM - degree * (HEIGHT - TOP - BOTTOM);
    return { width, low, high, x, y, back };
  }

  function draw() {
    if (!store.scene) return;
    const focused = document.activeElement?.dataset?.handle;
    const only = partly; // the plot that a hand is on; the others have not changed
    partly = "";
    each().forEach((variable, v) => {
      if (!only || variable.name === only) drawOne(variable, v);
    });
    if (focused) {
      const same = [...body.querySelectorAll("[data-handle]")].find((e) => e.dataset.handle === focused);
      same?.focus({ preventScroll: true });
    }
  }

  function drawOne(variable, v) {
    const plot = plots.get(variable.name);
    const at = scale(variable);
    const parts = [];
    const role = v < store.scene.inputs.length ? S.inputs : S.outputs;
    parts.push(svg("text", { x: 4, y: 12, class: "name" }, variable.name));
    parts.push(svg("text", { x: at.width - 4, y: 12, "text-anchor": "end" }, role));
    parts.push(svg("line", { class: "axis", x1: LEFT, x2: at.width - RIGHT, y1: at.y(0), y2: at.y(0) }));
    for (const tick of ticks(at.low, at.high, at.width / 80)) {
      parts.push(svg("text", { x: at.x(tick), y: HEIGHT - 4, "text-anchor": "middle" }, shortNumber(tick)));
    }
    if (role === S.inputs) {
      const x = at.x(store.point[v]);
      parts.push(svg("line", { class: "at", x1: x, x2: x, y1: TOP, y2: at.y(0) }));
    }
    const handles = [];
    variable.terms.forEach((term, t) => {
      if (!term.curve) return;
      const key = `${variable.name}\n${term.name}`;
      const held = store.parameters(variable, term);
      const path = curve(variable, term, held, at);
      parts.push(svg("path", { d: path, style: `stroke: ${hue(t)}`, class: key === chosen ? "chosen" : "" }));
      handles.push(...handlesOf(variable, term, t, held, at, key === chosen));
    });
    plot.setAttribute("width", at.width);
    plot.replaceChildren(...parts, ...handles);
  }

  function curve(variable, term, held, at) {
    const corners = term.straight ? cornersOf(term, held) : null;
    let points;
    if (corners) {
      const last = corners.length - 2;
      points = [[Math.min(at.low, corners[0]), corners[1]]];
      for (let i = 0; i <= last; i += 2) points.push([corners[i], corners[i + 1]]);
      points.push([Math.max(at.high, corners[last]), corners[last + 1]]);
    } else {
      const xs = Float64Array.from({ length: SMOOTH }, (_, i) => at.low + ((at.high - at.low) * i) / (SMOOTH - 1));
      const ys = store.degrees(variable, term, xs);
      points = Array.from(xs, (x, i) => [x, ys[i]]);
    }
    return points.map(([x, y], i) => `${i ? "L" : "M"}${at.x(x).toFixed(1)} ${at.y(y).toFixed(1)}`).join("");
  }

  function handlesOf(variable, term, t, held, at, isChosen) {
    const found = [];
    const positions = term.handles.map((i) => held[i]);
    const top = peak(term, held) ?? term.centre;
    if (top !== null) {
      const x = at.x(Math.min(at.high, Math.max(at.low, top)));
      const half = 3.6 * term.name.length; // about half of its width: it stays inside
      const anchor = x < half ? "start" : x > at.width - half ? "end" : "middle";
      found.push(svg("text", {
        x: anchor === "start" ? 3 : anchor === "end" ? at.width - 3 : x, y: TOP - 6,
        "text-anchor": anchor, class: "term", style: `fill: ${hue(t)}`,
        ...target(variable, term, null, S.wholeTerm(variable.name, term.name), top, at),
      }, term.name));
    }
    term.handles.forEach((index, place) => {
      const isPeak = positions[place] === top;
      if (!isChosen && !isPeak) return;
      const value = held[index];
      if (value < at.low || value > at.high) return;
      const y = heightAt(variable, term, held, index, value);
      found.push(svg("circle", {
        cx: at.x(value), cy: at.y(y), r: isChosen ? 5.5 : 4, style: `stroke: ${hue(t)}`,
        ...target(variable, term, index, S.corner(variable.name, term.name, place + 1), value, at),
      }));
    });
    if (isChosen && positions.length) {
      const said = positions.map((x) => shortNumber(x, 6)).join("  ");
      found.push(svg("text", { class: "numbers", x: at.width / 2, y: 12, "text-anchor": "middle" }, said));
    }
    return found;
  }

  function target(variable, term, index, label, value, at) {
    return {
      tabindex: 0, role: "slider", "aria-label": label, "aria-valuenow": Math.min(at.high, Math.max(at.low, value)),
      "aria-valuemin": at.low, "aria-valuemax": at.high, "aria-valuetext": shortNumber(value, 6),
      "data-handle": `${variable.name}\n${term.name}\n${index}`,
      "data-variable": variable.name, "data-term": term.name, "data-index": index ?? "whole",
      onpointerdown: (event) => take(event, variable, term, index),
      onkeydown: (event) => step(event, variable, term, index),
      onfocus: () => choose(variable, term),
    };
  }

  function choose(variable, term) {
    const key = `${variable.name}\n${term.name}`;
    if (key !== chosen) {
      chosen = key;
      redraw();
    }
  }

  const peak = (term, held) => {
    if (term.kind === "triangle") return held[1];
    if (term.kind === "trapezoid") return 0.5 * (held[1] + held[2]);
    return term.handles.length === 1 ? held[term.handles[0]] : null;
  };

  function heightAt(variable, term, held, index, value) {
    if (term.kind === "points") return held[index + 1] * term.height;
    if (term.kind === "triangle") return index === 1 ? term.height : 0;
    if (term.kind === "trapezoid") return index % 3 ? term.height : 0;
    return store.degrees(variable, term, Float64Array.of(value))[0];
  }

  // --- moving ---

  function take(event, variable, term, index) {
    if (!edit) return;
    event.preventDefault();
    event.currentTarget.focus({ preventScroll: true });
    const at = scale(variable);
    const plot = plots.get(variable.name);
    const pixel = (each) => at.back(each.clientX - plot.getBoundingClientRect().left);
    drag = { variable, start: pixel(event), from: new Map() };
    for (const other of variable.terms) drag.from.set(other.name, store.parameters(variable, other));
    // The plot keeps the pointer: handles are drawn anew while they move.
    plot.setPointerCapture(event.pointerId);
    grip(variable);
    plot.onpointermove = (each) => {
      const by = pixel(each) - drag.start;
      const old = drag.from.get(term.name);
      shift(variable, term, index, index === null ? by : old[index] + by, each);
    };
    plot.onpointerup = plot.onpointercancel = () => {
      plot.onpointermove = plot.onpointerup = plot.onpointercancel = null;
      drag = null;
      finish(variable.name);
    };
  }

  /** Ask for the numbers of a variable that can be changed in place. */
  function grip(variable) {
    store.busy = true;
    moving = variable.name;
    if (store.held?.variable === variable.name) return;
    numbers(variable.name).then((found) => {
      if (found) store.hold(variable, found);
    });
  }

  function step(event, variable, term, index) {
    const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    if (!sign || !edit) return;
    event.preventDefault();
    grip(variable);
    const by = sign * unit(variable) * (event.ctrlKey ? 10 : 1);
    drag = { variable, from: new Map() };
    for (const other of variable.terms) drag.from.set(other.name, store.parameters(variable, other));
    const old = drag.from.get(term.name);
    shift(variable, term, index, index === null ? by : old[index] + by, event);
    drag = null;
    clearTimeout(waiting);
    waiting = setTimeout(() => finish(variable.name), 350);
  }

  /** A round number, about a two-hundredth of the range. */
  function unit(variable) {
    const [low, high] = rangeOf(variable);
    const power = 10 ** Math.floor(Math.log10((high - low) / 100));
    return power * ((high - low) / power > 400 ? 5 : (high - low) / power > 200 ? 2 : 1);
  }

  function rounded(value, variable) {
    const step = snap.checked ? unit(variable) : unit(variable) / 100;
    return Number((Math.round(value / step) * step).toPrecision(12));
  }

  /** Move a corner to, or a whole term by, a number; neighbours and the mirror image as asked. */
  function shift(variable, term, index, value, event) {
    const old = drag.from.get(term.name);
    const next = index === null
      ? moved(term, old, null, 0, rounded(value, variable))
      : moved(term, old, index, rounded(value, variable));
    const changed = new Map([[term, next]]);
    if (partition.checked || event.altKey) neighbours(variable, term, old, next, changed);
    if (mirror.checked || event.shiftKey) mirrored(variable, changed);
    for (const [each, parameters] of changed) store.reshape(variable, each, parameters);
  }

  function neighbours(variable, term, old, next, changed) {
    for (const other of variable.terms) {
      if (other === term || other.kind === "points") continue;
      const from = drag.from.get(other.name);
      const to = from.map((x, i) => {
        const shared = other.handles.includes(i) ? term.handles.findIndex((k) => old[k] === x) : -1;
        return shared < 0 ? x : next[term.handles[shared]];
      });
      const sorted = other.handles.every((i, k) => !k || to[other.handles[k - 1]] <= to[i]);
      if (sorted && to.some((x, i) => x !== from[i])) changed.set(other, to);
    }
  }

  function mirrored(variable, changed) {
    const [low, high] = rangeOf(variable);
    for (const [term, parameters] of [...changed]) {
      const other = variable.terms[variable.terms.length - 1 - variable.terms.indexOf(term)];
      const fits = other !== term && other.kind === term.kind && term.kind !== "points";
      if (!fits || other.handles.length !== other.parameters.length) continue;
      changed.set(other, [...parameters].reverse().map((x) => Number((low + high - x).toPrecision(12))));
    }
  }

  function finish(name) {
    const variable = each().find((other) => other.name === name);
    store.busy = false;
    const shapes = variable.terms.flatMap((term) => {
      const now = store.parameters(variable, term);
      const same = now.every((x, i) => x === term.parameters[i]);
      return same ? [] : [{
        variable: variable.name, term: term.name, kind: term.kind, parameters: now, height: term.height,
      }];
    });
    if (!shapes.length) return;
    Promise.resolve(edit(shapes)).then((taken) => {
      if (taken === false) store.forget();
    });
  }

  const redraw = eachFrame(draw);
  store.on("scene", build);
  store.on("reshaped", () => {
    partly = store.busy ? moving : "";
    redraw();
  });
  store.on("point", () => {
    partly = "";
    redraw();
  });
  new ResizeObserver(() => {
    wide = body.clientWidth;
    redraw();
  }).observe(body);
  return section;
}
