// @ts-nocheck: built by editors/designer/build.js from playground/app.js and what it imports
(() => {
  // draw.js
  var UNSEEN = /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u200e\u200f\u2028-\u202e\u2066-\u2069]/g;
  function clean(text) {
    return String(text).replace(UNSEEN, "\uFFFD");
  }
  var cleaned = (children) => children.map((each) => typeof each === "string" ? clean(each) : each);
  function el(name, properties = {}, ...children) {
    const made = document.createElement(name);
    for (const [key2, value] of Object.entries(properties)) {
      if (key2 === "class") made.className = value;
      else if (key2.startsWith("on")) made.addEventListener(key2.slice(2), value);
      else if (key2 === "textContent" || key2 === "title") made[key2] = clean(value);
      else if (key2 in made && key2 !== "list") made[key2] = value;
      else made.setAttribute(key2, typeof value === "string" ? clean(value) : value);
    }
    made.append(...cleaned(children));
    return made;
  }
  function svg(name, attributes = {}, ...children) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key2, value] of Object.entries(attributes)) {
      if (key2.startsWith("on")) made.addEventListener(key2.slice(2), value);
      else if (key2 === "style")
        made.style.cssText = value;
      else made.setAttribute(key2, value);
    }
    made.append(...cleaned(children));
    return made;
  }
  function keepFocus(root) {
    const held = (
      /** @type {HTMLInputElement} */
      document.activeElement
    );
    if (!held || held === document.body || !root.contains(held)) return () => {
    };
    const { key: key2 } = held.dataset;
    const chosen = typeof held.selectionStart === "number" ? [held.selectionStart, held.selectionEnd] : null;
    return () => {
      const same = () => [...root.querySelectorAll("[data-key]")].find((each) => each.dataset.key === key2);
      const next = held.isConnected ? held : key2 && same();
      if (!next || next === document.activeElement) return;
      next.focus({ preventScroll: true });
      if (chosen) next.setSelectionRange(...chosen);
    };
  }
  function pane(kind, title2) {
    const id2 = `title-${kind}`;
    const bar2 = el("div", { class: "bar" }, el("h2", { id: id2, textContent: title2 }));
    const body = el("div", { class: "body" });
    const section = el("section", { class: `pane ${kind}`, "aria-labelledby": id2, tabIndex: -1 }, bar2, body);
    return { section, bar: bar2, body };
  }
  function choice(label, options, chosen, onchange) {
    const select = el("select", { onchange: () => onchange(select.value) });
    for (const [value, text] of options) {
      select.append(el("option", { value, textContent: text, selected: value === chosen }));
    }
    return el("label", { class: "small" }, label, select);
  }
  function shortNumber(x2, digits = 4) {
    if (!Number.isFinite(x2)) return "\u2013";
    return String(Number(x2.toPrecision(digits)));
  }
  var HUES = [
    ["#2563a8", "#74b3f7"],
    ["#b34e14", "#ff9e63"],
    ["#1f7a4a", "#66cf97"],
    ["#a23b8f", "#ec8fdc"],
    ["#7a6000", "#dcbf45"],
    ["#0b7484", "#58cfe0"],
    ["#b3343f", "#ff8e97"],
    ["#5f50c0", "#b3a8ff"]
  ].map((pair) => `light-dark(${pair.join(", ")})`);
  function hue(index) {
    return HUES[index % HUES.length];
  }
  var STOPS = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37]
  ];
  var SHADES = Array.from({ length: 256 }, (_2, i) => {
    const at2 = i / 255 * (STOPS.length - 1);
    const low = Math.min(Math.floor(at2), STOPS.length - 2);
    return STOPS[low].map((c, k) => Math.round(c + (at2 - low) * (STOPS[low + 1][k] - c)));
  });
  function heat(share2) {
    const t = Math.max(-1, Math.min(1, 2 * share2 - 1));
    const [r, g, b] = t < 0 ? [33, 102, 172] : [178, 24, 43];
    const strength = 0.85 * Math.abs(t);
    const mixed = [r, g, b].map((c) => Math.round(247 + strength * (c - 247)));
    return [`rgb(${mixed.join(" ")})`, luminance(mixed) < 0.18 ? "#ffffff" : "#000000"];
  }
  function luminance(colour) {
    const [r, g, b] = colour.map((c) => c <= 10 ? c / 3294 : ((c / 255 + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  }
  function context(canvas, width, height) {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    return { g, width, height };
  }
  function colourOf(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }
  function eachFrame(draw) {
    let asked = 0;
    return () => {
      asked ||= requestAnimationFrame(() => {
        asked = 0;
        draw();
      });
    };
  }

  // geometry/chart.js
  function ticks(low, high, wanted = 5) {
    const raw = (high - low) / wanted;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((x2) => x2 * power).find((x2) => x2 >= raw) ?? raw;
    const found = [];
    for (let x2 = Math.ceil(low / step - 1e-9); x2 * step <= high + 1e-9 * step; x2++) {
      found.push(Number((x2 * step).toPrecision(12)));
    }
    return found;
  }
  function decades(low, high) {
    const wide = high / low > 200;
    const found = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++) {
      for (const digit of wide ? [1] : [1, 2, 5]) {
        const v = digit * 10 ** power;
        if (v >= low * 0.9 && v <= high * 1.1) found.push(v);
      }
    }
    return found.length > 1 ? found : ticks(low, high, 3);
  }
  function valueRange(ends, limits) {
    const all = [...ends, ...limits].filter(Number.isFinite);
    if (!all.length) return [-1, 1];
    const [low, high] = [Math.min(...all), Math.max(...all)];
    if (high - low < 1e-9 * Math.max(1, Math.abs(high))) return [low - 1, high + 1];
    const room = 0.08 * (high - low);
    return [low - room, high + room];
  }

  // geometry/panel.js
  function scaleOf({ low, high, logarithmic = false }, from, to3) {
    const measure = logarithmic ? Math.log10 : (value) => value;
    const [a, b] = [measure(low), measure(high)];
    return (value) => from + (to3 - from) * (measure(value) - a) / (b - a);
  }
  function valueAt({ low, high, logarithmic = false }, from, to3) {
    return (pixel) => {
      const share2 = Math.min(1, Math.max(0, (pixel - from) / (to3 - from)));
      return logarithmic ? low * (high / low) ** share2 : low + share2 * (high - low);
    };
  }
  function ticksOf({ low, high, logarithmic = false, whole = false }, wanted) {
    const found = logarithmic ? decades(low, high) : ticks(low, high, wanted);
    return found.filter(
      (value) => (!whole || Number.isInteger(value)) && value >= low * (1 - 1e-9 * Math.sign(low)) && value <= high * (1 + 1e-9 * Math.sign(high))
    );
  }
  function edgesOf(places, count) {
    if (places.length === count + 1) return places;
    if (count === 1) return [places[0] - 0.5, places[0] + 0.5];
    const middles = places.slice(1).map((place, i) => (places[i] + place) / 2);
    return [2 * places[0] - middles[0], ...middles, 2 * places[count - 1] - middles[count - 2]];
  }
  function strokesOf(x2, y, steps = false) {
    const strokes = [];
    let stroke = null;
    for (let i = 0; i < x2.length; i++) {
      if (x2[i] === null || y[i] === null) {
        stroke = null;
        continue;
      }
      if (!stroke) strokes.push(stroke = []);
      else if (steps) stroke.push([x2[i], stroke.at(-1)[1]]);
      stroke.push([x2[i], y[i]]);
    }
    return strokes;
  }
  function shareOf(value, axis) {
    return Math.min(1, Math.max(0, scaleOf(axis, 0, 1)(value)));
  }
  function layoutOf(panel, width, height, rows) {
    const cells2 = panel.parts.find((part) => part.is === "cells");
    const hasBar = Boolean(cells2) && width >= LEAST_WITH_BAR;
    const inside = {
      left: ROOM.left,
      top: ROOM.top + (panel.title ? ROOM.title : 0) + ROOM.row * rows,
      right: width - (hasBar ? ROOM.bar : ROOM.right),
      bottom: height - ROOM.bottom
    };
    const upward = cells2?.downward ? [inside.top, inside.bottom] : [inside.bottom, inside.top];
    return {
      inside,
      hasBar,
      toX: scaleOf(panel.across, inside.left, inside.right),
      toY: scaleOf(panel.up, upward[0], upward[1]),
      xAt: valueAt(panel.across, inside.left, inside.right),
      yAt: valueAt(panel.up, upward[0], upward[1])
    };
  }
  var ROOM = { left: 52, right: 12, top: 10, title: 16, bottom: 36, row: 15, bar: 74 };
  var LEAST_WITH_BAR = 300;

  // geometry/surface.js
  function fillTriangle(pixels, width, height, x0, y0, x1, y1, x2, y2, colour) {
    if (y1 < y0) [x0, y0, x1, y1] = [x1, y1, x0, y0];
    if (y2 < y0) [x0, y0, x2, y2] = [x2, y2, x0, y0];
    if (y2 < y1) [x1, y1, x2, y2] = [x2, y2, x1, y1];
    const end = Math.min(height, Math.ceil(y2 - 0.5));
    for (let row = Math.max(0, Math.ceil(y0 - 0.5)); row < end; row++) {
      const y = row + 0.5;
      const a = x0 + (x2 - x0) * (y - y0) / (y2 - y0);
      const b = y < y1 ? x0 + (x1 - x0) * (y - y0) / (y1 - y0) : x1 + (x2 - x1) * (y - y1) / (y2 - y1);
      const from = row * width + Math.max(0, Math.ceil((a < b ? a : b) - 0.5));
      const to3 = row * width + Math.min(width, Math.ceil((a < b ? b : a) - 0.5));
      for (let at2 = from; at2 < to3; at2++) pixels[at2] = colour;
    }
  }
  function limitsOf(z2, output) {
    let [low, high] = [output.low, output.high];
    if (low === null || high === null) {
      [low, high] = [Infinity, -Infinity];
      for (const value of z2) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    return low < high ? [low, high] : [low - 1, low + 1];
  }
  var axisOf = (words2, [low, high]) => ({ words: words2, low, high, logarithmic: false, whole: false });
  var numbersOf = (values) => Array.from(values, (value) => Number.isFinite(value) ? value : null);
  function linePanel({ xs: xs2, z: z2 }, input, output) {
    const parts = [
      { is: "line", x: Array.from(xs2), y: numbersOf(z2), tone: "accent", width: 1.6, dash: "-" },
      { is: "level", at: input.at, upright: true, tone: "soft", width: 0.6, dash: "--" },
      { is: "dots", x: [input.at], y: numbersOf([output.at]), sign: "o", size: 7, tone: "lit" }
    ];
    return { title: "", across: axisOf(input.name, input.range), up: axisOf(output.name, output.range), parts };
  }
  function planePanel({ xs: xs2, ys: ys2, z: z2 }, inputs, output) {
    const [across, up2] = inputs.map(({ name, range }) => axisOf(name, range));
    const value = axisOf(output.name, output.range);
    const rulings = inputs.map(({ at: at2, isCut }, k) => ({
      is: "level",
      at: at2,
      upright: k === 0,
      tone: isCut ? "lit" : "#ffffff",
      width: isCut ? 1.6 : 0.7,
      dash: isCut ? "-" : "--"
    }));
    const parts = [
      { is: "cells", x: Array.from(xs2), y: Array.from(ys2), values: numbersOf(z2), value, signed: false },
      ...rulings,
      { is: "dots", x: [inputs[0].at], y: [inputs[1].at], sign: "+", size: 6, tone: "mark" }
    ];
    return { title: "", across, up: up2, parts };
  }
  function projectionOf(turned, width, height) {
    const [ca2, sa2] = [Math.cos(turned.azimuth), Math.sin(turned.azimuth)];
    const [ce2, se2] = [Math.cos(turned.elevation), Math.sin(turned.elevation)];
    const reach = Math.min(width * 0.58, height * 0.68);
    return {
      reach,
      /** @returns {Page.Pair} */
      project(u, v, w) {
        const [right, depth] = [u * ca2 - v * sa2, u * sa2 + v * ca2];
        return [width / 2 + reach * right, height * 0.5 - reach * (0.62 * w * ce2 + depth * se2)];
      },
      /** Whether the far end of each axis is the one with the large numbers. */
      farIsHigh: { u: sa2 > 0, v: ca2 > 0 }
    };
  }
  var farToNear = (count, farIsHigh) => Array.from({ length: count }, (_2, i) => farIsHigh ? count - 1 - i : i);
  function crossings(z2, n66, level, rows = n66) {
    const segments = [];
    for (let j2 = 0; j2 + 1 < rows; j2++) {
      for (let i = 0; i + 1 < n66; i++) {
        const k = j2 * n66 + i;
        const [a, b, c, d] = [z2[k] - level, z2[k + 1] - level, z2[k + n66 + 1] - level, z2[k + n66] - level];
        const found = [];
        if (a < 0 !== b < 0) found.push([i + a / (a - b), j2]);
        if (b < 0 !== c < 0) found.push([i + 1, j2 + b / (b - c)]);
        if (d < 0 !== c < 0) found.push([i + d / (d - c), j2 + 1]);
        if (a < 0 !== d < 0) found.push([i, j2 + a / (a - d)]);
        for (let m = 0; m + 1 < found.length; m += 2) segments.push([found[m], found[m + 1]]);
      }
    }
    return segments;
  }
  function spotsOf(spots, { left, top, right, bottom }, taken) {
    const found = [];
    for (let i = 0; i < spots.length && found.length < 2; i++) {
      const spot = spots[Math.floor(i * 0.618034 % 1 * spots.length)];
      const [x2, y] = spot;
      const isInside = x2 > left + 16 && x2 < right - 16 && y > top + 10 && y < bottom - 10;
      if (isInside && ![...taken, ...found].some(([u, v]) => Math.hypot(u - x2, v - y) < 42)) found.push(spot);
    }
    return found;
  }

  // panel.js
  var LABELS = "11px system-ui, sans-serif";
  var DASHES = { "-": [], "--": [6, 4], "-.": [8, 3, 2, 3], ":": [2, 3] };
  var SMOOTH = 40;
  var POINT = 1.3;
  var BAR = 9;
  var LEVELS = 9;
  var numbersOf2 = (colour) => colour.match(/\d+/g).slice(0, 3).map(Number);
  var HEATS = Array.from({ length: 256 }, (_2, i) => numbersOf2(heat(i / 255)[0]));
  var markAt = ([x2, y]) => ({ is: "dots", x: [x2], y: [y], sign: "+", size: 6, tone: "mark" });
  var levelAt = (at2) => ({ is: "level", at: at2, upright: true, tone: "ink", width: 0.8, dash: "-" });
  function drawPanel(canvas, panel) {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    return width && height ? paintPanel(context(canvas, width, height), panel, tonesOf(canvas)) : null;
  }
  function tonesOf(canvas) {
    const probe = canvas.ownerDocument.createElement("i");
    canvas.after(probe);
    const known = /* @__PURE__ */ new Map();
    const find = (tone) => {
      if (tone.startsWith("#")) return tone;
      if (!tone.startsWith("series")) return colourOf(`--run-${tone}`) || colourOf(`--${tone}`) || colourOf("--ink");
      probe.style.color = hue(Number(tone.slice(6)));
      return getComputedStyle(probe).color;
    };
    const colours = (tone) => known.get(tone) ?? known.set(tone, find(tone)).get(tone);
    return Object.assign(colours, { done: () => probe.remove() });
  }
  function paintPanel({ g, width, height }, panel, tone) {
    const labels = legendOf(g, panel, width);
    const layout = layoutOf(panel, width, height, labels.length ? labels.at(-1).row + 1 : 0);
    const paper = { g, ...layout, panel, labels, width, tone };
    const { inside } = layout;
    const cells2 = panel.parts.find((part) => part.is === "cells");
    title(paper);
    axes(paper, !cells2);
    g.save();
    g.beginPath();
    g.rect(inside.left - 1, inside.top - 1, inside.right - inside.left + 2, inside.bottom - inside.top + 2);
    g.clip();
    for (const part of panel.parts) {
      g.globalAlpha = part.opacity ?? 1;
      PARTS[part.is](paper, part);
      g.globalAlpha = 1;
    }
    g.restore();
    if (layout.hasBar) bar(paper, cells2);
    legend(paper);
    tone.done();
    return layout;
  }
  function title({ g, inside, panel }) {
    g.fillStyle = colourOf("--ink");
    g.font = "600 12px system-ui, sans-serif";
    g.textAlign = "left";
    g.fillText(clean(panel.title), inside.left, 15, inside.right - inside.left);
  }
  function axes({ g, inside, panel, toX, toY }, ruled) {
    const { left, right, top, bottom } = inside;
    g.font = "11px system-ui, sans-serif";
    g.fillStyle = colourOf("--soft");
    g.strokeStyle = colourOf("--line");
    g.lineWidth = 1;
    g.textAlign = "right";
    for (const value of ticksOf(panel.up, Math.max(2, (bottom - top) / 40))) {
      const y = Math.round(toY(value)) + 0.5;
      if (ruled) g.strokeRect(left, y, right - left, 0);
      g.fillText(shortNumber(value), left - 5, y + 4);
    }
    g.textAlign = "center";
    for (const value of ticksOf(panel.across, Math.max(2, (right - left) / 70))) {
      g.fillText(shortNumber(value), toX(value), bottom + 14);
    }
    g.font = "600 12px system-ui, sans-serif";
    g.fillText(clean(panel.across.words), (left + right) / 2, bottom + 30, right - left);
    g.save();
    g.translate(11, (top + bottom) / 2);
    g.rotate(-Math.PI / 2);
    g.fillText(clean(panel.up.words), 0, 0, bottom - top);
    g.restore();
  }
  var PARTS = {
    line({ g, toX, toY, tone }, { x: x2, y, steps, width, dash, tone: colour }) {
      g.strokeStyle = tone(colour);
      g.lineWidth = POINT * width;
      g.setLineDash(DASHES[dash] ?? []);
      g.beginPath();
      for (const stroke of strokesOf(x2, y, steps)) trace(g, stroke, toX, toY);
      g.stroke();
      g.setLineDash([]);
    },
    area({ g, toX, toY, tone }, { x: x2, y, tone: colour }) {
      g.fillStyle = tone(colour);
      g.beginPath();
      for (const stroke of strokesOf(x2, y)) trace(g, stroke, toX, toY);
      g.fill();
    },
    band(paper, { x: x2, low, high, ...part }) {
      const around = { x: [...x2, ...x2.toReversed()], y: [...high, ...low.toReversed()] };
      PARTS.area(
        paper,
        /** @type {any} */
        { ...part, ...around }
      );
    },
    level({ g, inside, toX, toY, tone }, { at: at2, upright, width, dash, tone: colour }) {
      g.strokeStyle = tone(colour);
      g.lineWidth = POINT * width;
      g.setLineDash(DASHES[dash] ?? []);
      g.beginPath();
      g.moveTo(upright ? toX(at2) : inside.left, upright ? inside.top : toY(at2));
      g.lineTo(upright ? toX(at2) : inside.right, upright ? inside.bottom : toY(at2));
      g.stroke();
      g.setLineDash([]);
    },
    dots({ g, toX, toY, tone }, { x: x2, y, sign, size, tone: colour }) {
      g.fillStyle = g.strokeStyle = tone(colour);
      g.lineWidth = 1.2;
      const draw = SIGNS[sign] ?? SIGNS["."];
      x2.forEach((each, i) => each !== null && y[i] !== null && draw(g, toX(each), toY(y[i]), 0.5 * POINT * size));
    },
    cells(paper, part) {
      const columns = part.x.length;
      if (columns <= SMOOTH || part.y.length * columns !== part.values.length) cells(paper, part);
      else {
        samples(paper, part);
        if (!part.signed) levels(paper, part);
      }
    }
  };
  var SIGNS = {
    ".": (g, x2, y, r) => g.fillRect(x2 - r, y - r, 2 * r, 2 * r),
    o(g, x2, y, r) {
      g.beginPath();
      g.arc(x2, y, r, 0, 2 * Math.PI);
      g.fill();
    },
    x: diagonal,
    X: diagonal,
    "+": (g, x2, y) => cross(g, x2, y)
  };
  function diagonal(g, x2, y, r) {
    g.beginPath();
    g.moveTo(x2 - r, y - r);
    g.lineTo(x2 + r, y + r);
    g.moveTo(x2 - r, y + r);
    g.lineTo(x2 + r, y - r);
    g.stroke();
  }
  function cross(g, x2, y) {
    for (const [width, colour] of [
      [4.5, "#ffffff"],
      [2, "#000000"]
    ]) {
      g.strokeStyle = colour;
      g.lineWidth = width;
      g.beginPath();
      g.arc(x2, y, 6, 0, 2 * Math.PI);
      g.moveTo(x2 - 10, y);
      g.lineTo(x2 + 10, y);
      g.moveTo(x2, y - 10);
      g.lineTo(x2, y + 10);
      g.stroke();
    }
  }
  function trace(g, stroke, toX, toY) {
    stroke.forEach(([x2, y], i) => i ? g.lineTo(toX(x2), toY(y)) : g.moveTo(toX(x2), toY(y)));
  }
  var shadeOf = (value, { value: axis, signed }) => (signed ? HEATS : SHADES)[Math.round(255 * shareOf(value, axis))];
  function samples({ g, toX, toY }, part) {
    const { x: x2, y, values } = part;
    const [wide, tall] = [x2.length, y.length];
    const colours = new ImageData(wide, tall);
    values.forEach((value, k) => {
      const row = part.downward ? Math.floor(k / wide) : tall - 1 - Math.floor(k / wide);
      if (value !== null) colours.data.set([...shadeOf(value, part), 255], 4 * (row * wide + k % wide));
    });
    const small = new OffscreenCanvas(wide, tall);
    small.getContext("2d").putImageData(colours, 0, 0);
    const [left, right] = [toX(x2[0]), toX(x2.at(-1))];
    const [top, bottom] = [toY(y[0]), toY(y.at(-1))].toSorted((a, b) => a - b);
    g.drawImage(small, 0.5, 0.5, wide - 1, tall - 1, left, top, right - left, bottom - top);
  }
  function levels({ g, inside, toX, toY }, { x: x2, y, values, value }) {
    const last = [x2.length - 1, y.length - 1];
    const spotOf = ([i, j2]) => [
      toX(x2[0] + (x2[last[0]] - x2[0]) * i / last[0]),
      toY(y[0] + (y[last[1]] - y[0]) * j2 / last[1])
    ];
    const numbers = values.map((each) => each ?? NaN);
    const named2 = [];
    g.strokeStyle = "rgb(255 255 255 / 0.75)";
    g.lineWidth = 1;
    g.beginPath();
    for (const level of ticksOf(value, LEVELS)) {
      if (level <= value.low || level >= value.high) continue;
      const segments = crossings(numbers, x2.length, level, y.length).map((ends) => ends.map(spotOf));
      for (const [from, to3] of segments) {
        g.moveTo(...from);
        g.lineTo(...to3);
      }
      spotsOf(
        segments.map(([from]) => from),
        inside,
        named2.map(({ spot }) => spot)
      ).forEach((spot) => named2.push({ spot, level }));
    }
    g.stroke();
    g.font = "10.5px system-ui, sans-serif";
    g.textAlign = "center";
    g.lineWidth = 3;
    g.strokeStyle = "rgb(0 0 0 / 0.7)";
    g.fillStyle = "#ffffff";
    for (const { spot, level } of named2) {
      g.strokeText(shortNumber(level), spot[0], spot[1] + 4);
      g.fillText(shortNumber(level), spot[0], spot[1] + 4);
    }
  }
  function bar({ g, inside, width }, part) {
    const [left, top, tall] = [inside.right + 10, inside.top, inside.bottom - inside.top];
    const { value } = part;
    for (let row = 0; row < tall; row++) {
      const [r, g_, b] = (part.signed ? HEATS : SHADES)[Math.round(255 * (1 - row / tall))];
      g.fillStyle = `rgb(${r} ${g_} ${b})`;
      g.fillRect(left, top + row, BAR, 1.5);
    }
    const toY = scaleOf(value, inside.bottom, inside.top);
    g.fillStyle = colourOf("--soft");
    g.font = "11px system-ui, sans-serif";
    g.textAlign = "left";
    for (const tick of ticksOf(value, Math.max(2, tall / 40))) {
      g.fillText(shortNumber(tick, 3), left + BAR + 4, toY(tick) + 4);
    }
    g.save();
    g.translate(width - 5, (inside.top + inside.bottom) / 2);
    g.rotate(-Math.PI / 2);
    g.textAlign = "center";
    g.fillText(clean(value.words), 0, 0, tall);
    g.restore();
  }
  function hatch(g, x0, y0, x1, y1) {
    g.save();
    g.beginPath();
    g.rect(x0, y0, x1 - x0, y1 - y0);
    g.clip();
    g.strokeStyle = colourOf("--soft");
    g.globalAlpha = 0.4;
    g.lineWidth = 1;
    g.beginPath();
    for (let c = Math.floor((x0 - y1) / 6) * 6; c < x1 - y0; c += 6) {
      g.moveTo(y0 + c, y0);
      g.lineTo(y1 + c, y1);
    }
    g.stroke();
    g.restore();
  }
  function cells({ g, toX, toY }, part) {
    const { x: x2, y, values } = part;
    const isEdged = values.length === (x2.length - 1) * (y.length - 1);
    const [columns, rows] = isEdged ? [x2.length - 1, y.length - 1] : [x2.length, y.length];
    const [across, up2] = [edgesOf(x2, columns), edgesOf(y, rows)];
    g.font = "11px system-ui, sans-serif";
    g.textAlign = "center";
    values.forEach((value, k) => {
      const [i, j2] = [k % columns, Math.floor(k / columns)];
      const [x0, x1] = [toX(across[i]), toX(across[i + 1])];
      const [y0, y1] = [toY(up2[j2]), toY(up2[j2 + 1])].toSorted((a, b) => a - b);
      if (value === null) {
        if (part.missing) hatch(g, x0, y0, x1, y1);
        return;
      }
      const shade = shadeOf(value, part);
      g.fillStyle = `rgb(${shade.join(" ")})`;
      g.fillRect(x0, y0, x1 - x0 - 0.5, y1 - y0 - 0.5);
      const said2 = shortNumber(value, 2);
      if (x1 - x0 < 8 * said2.length || y1 - y0 < 13) return;
      g.fillStyle = inkOn(shade);
      g.fillText(said2, (x0 + x1) / 2, (y0 + y1) / 2 + 4);
    });
  }
  var inkOn = ([r, g, b]) => 0.2126 * r ** 2.2 + 0.7152 * g ** 2.2 + 0.0722 * b ** 2.2 < 0.18 * 255 ** 2.2 ? "#fff" : "#000";
  function legendOf(g, panel, width) {
    g.font = LABELS;
    let [x2, row] = [ROOM.left, 0];
    return panel.parts.filter((part) => part.label || part.missing).map((part) => {
      const wide = 34 + g.measureText(clean(part.label || part.missing)).width + 10;
      if (x2 > ROOM.left && x2 + wide > width - ROOM.right) [x2, row] = [ROOM.left, row + 1];
      const place = { part, x: x2, row };
      x2 += wide;
      return place;
    });
  }
  function legend({ g, labels, panel, tone }) {
    g.font = LABELS;
    g.textAlign = "left";
    for (const { part, x: x2, row } of labels) {
      const y = ROOM.top + (panel.title ? ROOM.title : 0) + ROOM.row * row + 4;
      key(g, part, x2, y, tone);
      g.fillStyle = colourOf("--ink");
      g.fillText(clean(part.label || part.missing), x2 + 30, y + 4);
    }
  }
  function key(g, part, x2, y, tone) {
    if (part.is === "cells") return hatch(g, x2, y - 5, x2 + 24, y + 5);
    g.fillStyle = g.strokeStyle = tone(part.tone);
    g.globalAlpha = part.opacity ?? 1;
    if (part.is === "area" || part.is === "band") g.fillRect(x2, y - 5, 24, 10);
    else if (part.is === "dots") (SIGNS[part.sign] ?? SIGNS["."])(g, x2 + 12, y, 0.5 * POINT * Math.max(4, part.size));
    else {
      g.lineWidth = 2;
      g.setLineDash(DASHES[part.dash] ?? []);
      g.beginPath();
      g.moveTo(x2, y);
      g.lineTo(x2 + 24, y);
      g.stroke();
      g.setLineDash([]);
    }
    g.globalAlpha = 1;
  }

  // strings.js
  var S = {
    designer: "fuzzyarm designer",
    file: "File",
    save: "Save",
    saved: "saved",
    unsaved: "not saved",
    format: "Format",
    undo: "Undo",
    redo: "Redo",
    revert: "Back to the file",
    revertHint: "The text as it is saved; one step back undoes it",
    dark: "Dark",
    light: "Light",
    theme: "Light or dark",
    gone: "The server does not answer. Your text is kept in this page, and is sent when it is back.",
    back: "connected again",
    conflict: "Another program has changed the file, and something here is not saved.",
    reread: "Another program has changed the file. This is its text now.",
    follows: "Another window writes this file; this one follows it.",
    behind: "Another window writes this file. What was typed here last is not in it.",
    writeHere: "Write here",
    fileGone: "The file is gone from the folder. Save writes it anew.",
    unreadable: (why) => `The file has changed on disk, and is not taken: ${why}.`,
    keepMine: "Keep mine",
    takeTheirs: "Take the file's",
    keepBoth: "Keep both",
    otherWindow: "Another window has had other lines here while the server was away.",
    keepThis: "Keep these",
    takeOther: "Take the other's",
    text: "Text",
    editor: "The text of the file",
    findings: "Findings",
    noFindings: "no findings",
    fix: "Fix \u2026",
    allow: "Choose \u2026",
    noFix: "No quick fix is known here.",
    fixes: "Quick fixes",
    rename: "Rename",
    renameTo: "New name of",
    cancel: "Cancel",
    ok: "OK",
    close: "Close",
    working: "working \u2026",
    report: "What is known of it",
    files: "Files",
    kind: "Kind",
    description: "Description",
    newFile: "New file \u2026",
    importFile: "Import \u2026",
    importHint: "Rule bases and tables of other programs: drop them anywhere on this page",
    onlyOne: "The designer has one file open; open its folder to write others. What is dropped takes the place of the text.",
    emptyFolder: "This folder has no rule base yet",
    emptyHint: "Begin with one of these; everything in it can be changed, by hand or in its text.",
    startTitles: {
      blank: "Blank",
      pd: "Two inputs, PD",
      pi: "Two inputs, PI",
      single: "One input",
      controller: "Controller"
    },
    startNames: { blank: "blank.frb", pd: "pd.frb", pi: "pi.frb", single: "single.frb", controller: "controller.frb" },
    around: "rule base",
    shippedRules: "pd7.frb, which comes with fuzzyarm",
    orImport: "Or drop a rule base or a table of another program anywhere on this page:",
    foreignFiles: "Rule bases of other programs in this folder; a click converts one:",
    convertHint: "Write it in the language, beside the file",
    notSound: "not sound",
    notThere: (name) => `${name} is not in this folder.`,
    duplicate: "Duplicate",
    duplicateOf: (name) => `Duplicate ${name}`,
    renameFile: "Rename",
    renameOf: (name) => `Rename ${name}`,
    deleteFile: "Delete",
    deleteOf: (name) => `Delete ${name}`,
    template: "made for",
    nameOfFile: "name",
    unnamed: "unnamed.frb",
    create: "Create",
    copyOf: (name) => name.replace(/(\.[^.]*)$/, "-copy$1"),
    usedBy: (names) => `It is used by ${names}.`,
    unsavedGoes: "What is not saved goes with it.",
    deleteForGood: "The file is deleted for good.",
    noScripts: "A script is not run from a page. fuzzyarm convert SCRIPT.py -o FOLDER runs it; the page shows what it makes.",
    tooLarge: (bytes, most) => `The file has ${bytes} bytes; at most ${most} are taken here. fuzzyarm convert has no such limit.`,
    converting: (name) => `${name} is converted \u2026`,
    notRead: (why) => `It cannot be read; a folder cannot be imported. (${why})`,
    notImported: (name) => `${name} is not imported`,
    importedAs: (name, made) => `${name} is now ${made}`,
    otherKind: (name) => `${name} is of another kind: a rule base is not a table.`,
    replaceText: (name, dropped2) => `Replace the text of ${name} by what ${dropped2} says? One step back undoes it.`,
    replaceIt: "Replace",
    dropHere: "Drop rule bases and tables here",
    exports: "Export",
    exportsNote: "Of the text as it is now, saved or not; the files that a controller uses are taken as they are saved.",
    exportGroups: {
      programs: "Program",
      tables: "Table",
      pictures: "Picture",
      pages: "Page",
      others: "For other programs"
    },
    exportKinds: {
      ".h": "C header",
      ".c": "C, two files",
      ".st": "Structured Text",
      ".xml": "PLCopen XML",
      ".fmu": "FMU",
      ".mjs": "JavaScript",
      ".lut": "Table .lut",
      ".csv": "CSV",
      ".tex": "LaTeX",
      ".json": "JSON",
      ".npz": "NumPy",
      ".png": "PNG",
      ".svg": "SVG",
      ".html": "Page without a server",
      ".fis": "FIS",
      ".fll": "FLL",
      ".fcl": "FCL",
      ".fml": "FML"
    },
    exportTitle: (kind, name) => `${kind} of ${name}`,
    exportNow: "Export",
    exported: "done",
    download: (name, bytes) => `${name}, ${bytes} bytes`,
    options: {
      way: "inference",
      output: "output",
      levels: "levels",
      mode: "looked up by",
      q: "numbers of the table",
      precision: "precision",
      name: "names begin with",
      tolerance: "smallest within",
      round: "rounded to",
      fmi: "version of FMI",
      what: "what is drawn"
    },
    levelsHint: "49, or -6 .. 6 step 1, or e = 49, ce = 25",
    asInFile: "as in the file",
    everyOutput: "every output",
    tables: "Table",
    cells: "Cells",
    tableOf: (output, cells2, mode) => `${cells2} cells of ${output}, looked up by ${mode}`,
    axisLevels: (name, count, low, high, bins) => `${name}: ${count} levels ${low} \u2026 ${high}${bins ? ", bins" : ""}`,
    thinned: "not every level is shown",
    tableError: "Table against direct inference",
    measure: "Measure",
    measureAgain: "Measure again",
    signed: "table \u2212 rules",
    provedCells: "proved per cell",
    provedSoFar: (done, all) => `${done} of ${all} cells proved \u2026`,
    provedAll: "Every cell is proved: between the points, too, its error is not larger.",
    worstAt: (output, mode, where, table, direct, difference2, proved) => `Worst by ${mode}: at ${where} the table has ${output} = ${table}, the rules ${direct}: ${difference2} apart. ` + (proved === null ? "This is the largest of many points, and not proved." : `Proved: nowhere more than ${proved}.`),
    errorTitle: (output, mode, held) => `${output} by ${mode}${held ? `, ${held}` : ""}`,
    compare: "Compare",
    with: "with",
    chooseOther: "Choose the file to compare with.",
    nothingToCompare: "There is no other file in this folder.",
    sideBySide: "side by side",
    onlyDifference: "difference",
    compareAgain: "Compare again",
    largestHere: (size, where) => `Largest difference here: ${size} at ${where}.`,
    largest: (size, where, points) => `Over all inputs: ${size} at ${where} (of ${points} points).`,
    oneSided: (count) => `At ${count} points only one of them has a value.`,
    nothingShared: "There is no point at which both have a value.",
    compareLabel: (before, after, words2) => `${before} compared with ${after}. ${words2}`,
    changed: { rules: "Rules", terms: "Terms", settings: "Settings", cells: "Cells" },
    marks: { changed: ["~", "changed"], added: ["+", "added"], removed: ["\u2212", "removed"], more: ["\u2026", "more"] },
    mixed: "A rule base and a table: only their surfaces are compared.",
    sameMeaning: "Both mean the same.",
    inMeaning: "What differs in meaning:",
    helpTitle: "Help and keys",
    helpHint: "Help and keys: ? or F1",
    help: [
      {
        title: "Everywhere",
        words: [
          "The text on the left is what counts: whatever you drag, choose or add is an edit of it, and one step back undoes it. Borders between panes can be dragged."
        ],
        rows: [
          ["? or F1", "this help (? where nothing is typed)"],
          ["F6 or Shift+F6", "to the next pane, or to the one before; Tab goes on within it"],
          ["Ctrl+Z or Ctrl+Shift+Z", "undo and redo"],
          ["Ctrl+S", "save"],
          ["\u2190 \u2192 \u2191 \u2193", "move a border that has the focus; Enter puts it back"]
        ]
      },
      {
        title: "Text",
        words: ["Point at a word to read what it means. Findings stand below."],
        rows: [
          ["Ctrl+Space", "what could stand here"],
          ["F2", "give the name under the cursor another one, everywhere"],
          ["Ctrl+.", "fixes for the finding of this line"],
          ["Shift+Alt+F", "format"],
          ["Ctrl+F", "search"]
        ]
      },
      {
        title: "Design: terms",
        view: "design",
        words: [
          "Drag a circle to move a corner, a diamond to change a width, the name to move a whole term. A term that is chosen shows its kind and its numbers below, to be typed. Above each plot: another term, the range, another name, remove it."
        ],
        rows: [
          ["Tab", "from handle to handle"],
          ["\u2190 \u2192", "move the handle; with Ctrl ten steps"],
          ["Alt", "neighbours that share the corner move along"],
          ["Shift", "the term on the other side moves as well"]
        ]
      },
      {
        title: "Design: rules, surface, inference",
        view: "design",
        words: [
          "A cell of the grid is a list. The name of a row or a column leads to what is done with it. Methods opens to the lists of and, or, implication, aggregation and defuzzifier.",
          "A click in the contour, or a slider, moves the point. Rules that fire there are framed; they are called by their place in the text."
        ],
        rows: [["\u2190 \u2192 \u2191 \u2193", "turn the surface, or move the point in a contour, a line or a section"]]
      },
      {
        title: "Run",
        view: "run",
        words: [
          "A controller on a plant. The run stands at its time with all of it in view; Go on, or a push, takes it further. What is changed then is run from the start."
        ],
        rows: [
          ["Space", "pause and go on, in the picture"],
          ["\u2190 \u2192 \u2191 \u2193", "push the plant, in the picture; with Shift harder"]
        ]
      },
      {
        title: "Table",
        view: "table",
        words: ["How far a lookup table is from the rules; of a .lut file its cells."],
        rows: [["\u2190 \u2192 \u2191 \u2193", "from cell to cell"]]
      },
      {
        title: "Learn and Tune",
        view: "tune",
        words: ["A table that learns while it runs; a search for better numbers, with its report."],
        rows: []
      },
      {
        title: "Sweep, Fit and Prove",
        view: "prove",
        words: [
          "Many runs over ranges, with a map; a rule base from samples; verdicts on `prove` lines, bounds, sectors and loops."
        ],
        rows: []
      },
      {
        title: "Compare",
        view: "compare",
        words: ["The file beside another one: surfaces, and what differs in meaning."],
        rows: []
      },
      {
        title: "Files",
        view: "files",
        words: ["New files, copies, other names, imports and exports. Files can be dropped anywhere."],
        rows: [["\u2191 \u2193", "from name to name"]]
      }
    ],
    split: "Drag it, or move it with the arrow keys; Enter or a double click puts it back",
    splitOf: (vertical) => vertical ? "Width of the panes beside" : "Height of the panes above and below",
    design: "Design",
    terms: "Terms",
    inputs: "input",
    outputs: "output",
    partition: "Partition",
    partitionHint: "Neighbours that share a corner move along (or hold Alt)",
    mirror: "Mirror",
    mirrorHint: "The term on the other side moves as well (or hold Shift)",
    snap: "Snap",
    snapHint: "Corners stop at round numbers",
    wholeTerm: (variable, term) => `${variable} ${term}: move the whole term`,
    corner: (variable, term, n66) => `${variable} ${term}: corner ${n66}`,
    lowerCorner: (variable, term, n66) => `${variable} ${term}: lower corner ${n66}`,
    width: (variable, term, name, lower) => `${variable} ${term}: ${lower ? "lower " : ""}${name}`,
    overShape: "over",
    height: "height",
    kindOf: (variable, term) => `${variable} ${term}: kind of its shape`,
    kindHint: "Another kind at the same place; what it cannot have is lost",
    addTerm: "Term \u2026",
    nameOfTerm: (variable) => `Name of a new term of ${variable}`,
    addTermHint: "Add a term",
    addRole: { input: "Add an input", output: "Add an output" },
    addVariableNote: "Its terms are triangles, evenly spaced from the first to the last name; each can be moved then.",
    addInput: "Input \u2026",
    addOutput: "Output \u2026",
    nameOfVariable: "name",
    lowEnd: "from",
    highEnd: "to",
    namesOfTerms: "terms, from low to high",
    threeTerms: "LOW MIDDLE HIGH",
    notARange: "The ends of a range are two numbers.",
    notANumber: "Where it stands is a number.",
    peak: "peak at",
    renameDots: "Rename \u2026",
    renameVariable: "Give it another name, wherever it stands",
    removeVariable: (name) => `Remove ${name}`,
    removeVariableNote: "Its terms go with it, and the rules, grids, expectations and properties that name it. One step back undoes it.",
    removeVariableHint: "Remove it with all that names it",
    noVariables: "There is no variable yet: add the inputs and outputs of the rule base.",
    methods: "Methods",
    newGrid: "A new grid of rules",
    gridDots: "Grid \u2026",
    gridHint: "Add a grid of rules over one input or two",
    concludes: "concludes",
    oneRow: "(one row)",
    fills: [
      ["rising", "rising with the inputs"],
      ["falling", "falling with the inputs"],
      ["empty", "empty"]
    ],
    removeGrid: (output) => `Remove the grid of ${output}`,
    removeRow: (term) => `Remove the row ${term}`,
    removeColumn: (term) => `Remove the column ${term}`,
    rowOf: (name, term) => `The row where ${name} is ${term}`,
    columnOf: (name, term) => `The column where ${name} is ${term}`,
    addRow: "Add a row \u2026",
    addColumn: "Add a column \u2026",
    rowDots: "Row \u2026",
    columnDots: "Column \u2026",
    addRowOf: (name) => `Add a row of ${name}`,
    addColumnOf: (name) => `Add a column of ${name}`,
    term: "term",
    newTerm: "a new term",
    newTermName: "name of the new term",
    join: "between the parts",
    compose: "Put a rule together",
    ifWord: "if",
    thenWord: "then",
    noRulesYet: "There are no rules yet.",
    missing: { "no-inputs": "an input", "no-outputs": "an output", "no-rules": "rules" },
    notYet: (parts) => `Nothing to draw yet: the rule base needs ${parts.join(", ")}.`,
    remove: "Remove",
    range: "Range \u2026",
    rangeHint: "Its range; evenly spaced terms follow",
    rangeOf: (variable) => `Range of ${variable}`,
    rules: "Rules",
    ruleOf: (row, column) => `rule for ${row}, ${column}`,
    noRule: "no rule",
    ruleAt: (place) => `the rule of ${place}`,
    newRule: "A new rule",
    ifThen: "if \u2026 then \u2026",
    add: "Add",
    change: "Edit",
    fires: (place, strength) => `${place}: ${strength}`,
    severity: { error: "error", warning: "warning", info: "note" },
    between: (low, high) => `${low} \u2026 ${high}`,
    surface: "Surface",
    horizontal: "across",
    vertical: "down",
    shown: "output",
    view: "view",
    solid: "3-D",
    contour: "contour",
    cut: "cut",
    noCut: "none",
    cutAt: (name, value) => `cut at ${name} = ${value}`,
    sectionLabel: (output, name, cut) => `${output} over ${name}, ${cut}. Arrow keys move the point.`,
    byServer: "computed by the server",
    coarse: "with few points: this takes long",
    asking: (reason) => `This page does not compute ${reason}. The server is asked \u2026`,
    surfaceLabel: (output, x2, y) => `${output} over ${x2}${y ? ` and ${y}` : ""}. Arrow keys turn it, or move the point in the contour.`,
    inference: "Inference",
    value: "value",
    because: "because",
    strength: "strength",
    silent: "does not fire",
    nothingFires: "no rule fires here",
    noValue: "no value",
    order: "rules",
    strongest: "strongest first",
    asWritten: "as in the text",
    interval: (left, right) => `(${left} \u2026 ${right})`,
    aggregate: "all rules together",
    run: "Run",
    runNotFitting: (name) => `${name} (does not fit)`,
    aloneRuns: (name, onArm) => `${name} is a rule base, not a controller: nothing in it says what its inputs measure and what its output drives.` + (onArm ? " As error and rate of its joints the arm takes the rules as they are; for any other plant a controller goes around them." : " A controller goes around it."),
    makeAround: "Make a controller \u2026",
    aroundTitle: (name) => `A controller around ${name}`,
    aroundName: (name) => name.replace(/(\.[^.]*)?$/, "-controller.frb"),
    unsavedUsed: (names) => names.length === 1 ? `${names[0]} has unsaved changes; the run uses the saved version.` : `${names.join(", ")} have unsaved changes; the run uses the saved versions.`,
    saveFile: (name) => `Save ${name}`,
    copyHere: (name) => `Copy ${name} here`,
    copyHereHint: "It comes with fuzzyarm; a copy in this folder can be changed",
    onlyOneAround: "Open the folder to make one.",
    usedIn: "It is used by",
    canRun: "These can run:",
    runFitsNone: "The text controls none of these plants.",
    runReference: "Reference",
    runSignals: ["step:1", "step:1,0.5", "ramp:0.5", "sine:1,0.5", "quintic:1,2"],
    runOpenEnded: "open end",
    runOpenEndedHint: "Until it is stopped; what is older than the time given leaves the picture",
    runSpeed: "Speed",
    runTimes: (times) => `\xD7 ${times}`,
    runFastest: "as fast as possible",
    runStart: "Start",
    runStartHint: "Run the text on the plant",
    runPause: "Pause",
    runResume: "Go on",
    runPauseHint: "Stand still, or go on (in the picture: space)",
    runStep: "Step",
    runStepHint: "One sample further",
    runAgain: "Restart",
    runAgainHint: "From the start, with the text and the settings of now",
    runStop: "Stop",
    runStopHint: "End the run",
    runTime: "Simulated time",
    runBehind: "slower than asked for",
    runStarting: "starting \u2026",
    runWaits: "It has waited while another file was shown.",
    runNextTime: "This counts from the next start on.",
    runTaken: "The text of now runs.",
    runRestart: "The text has another structure now: Restart runs it.",
    runReached: ({ at: at2 }) => `${at2} s, the time asked for. 'Go on' continues, and so does a push of the plant; what is changed now is run from the start.`,
    runOver: {
      finished: ({ at: at2 }) => `Finished at ${at2} s.`,
      ended: ({ at: at2 }) => `The plant ended the run at ${at2} s.`,
      diverged: ({ at: at2, port, value, bound, unit }) => port ? `Diverged: stopped at ${at2} s with ${port} ${value === null ? "not a number" : `at ${value} ${unit}`}, beyond its bound of ${bound} ${unit}.` : `Diverged: stopped at ${at2} s.`
    },
    runPicture: "Plant",
    runPictureLabel: "Picture of the plant. Drag it with the mouse to push it, or hold the arrow keys (with Shift harder); space pauses.",
    runPulled: ([x2, y]) => `push ${Math.round(100 * x2)} % \u2192, ${Math.round(100 * y)} % \u2191`,
    runNotYet: "Start runs the text on the plant.",
    runNoPicture: "This plant has no picture; it can be pushed here.",
    runCurves: "Over time",
    runCurvesLabel: "Reference, output, error and drives over time; the numbers stand under Metrics.",
    runOutputs: "output (reference dashed)",
    runError: "error",
    runDrives: "drive",
    runGains: "Gains",
    runGainsNote: "The gains of the controller, while it runs.",
    runNoGains: "This controller has no gains.",
    runGainElsewhere: "Not in this text: it counts for this run only.",
    runMetrics: "Metrics",
    runErrorOf: "error of",
    runMetric: { saturated: "saturated share", variation: "variation per second" },
    runMetricHint: {
      rms: "root mean square of the error",
      max: "error of largest magnitude",
      final: "last error",
      chatter: "root mean square of the change of the drive from period to period",
      settling: "until the error stays within 2 % of a step",
      rise: "from 10 to 90 % of a step",
      effort: "root mean square of the drives",
      saturated: "share of the samples with a drive at a limit"
    },
    runSame: "The same run as a command",
    start: "Start",
    stop: "Stop",
    pause: "Pause",
    goOn: "Go on",
    replace: "Replace it",
    replaceFile: (name) => `${name} exists already. Replace it?`,
    preparing: "preparing \u2026",
    usual: "usual",
    yes: "yes",
    no: "no",
    oneALine: "one a line",
    learn: "Learn",
    thisText: "this text",
    asTheText: "as the text says",
    speed: "Speed",
    watch: "to be watched",
    fast: "as fast as it goes",
    onePass: "One pass",
    onePassHint: "Train one pass, then wait",
    tableName: "Name of the file",
    saveTable: "Save the table",
    tableSaved: (name) => `${name} is written, with where it comes from.`,
    learnsItself: "This text has a table that learns.",
    learnsNot: "This text has no table that learns; shipped controllers that do can be chosen.",
    learning: (news, begin) => {
      const what = news.mode === "run" ? "" : news.mode === "pause" ? ", waiting" : ", stopped";
      const table = news.tables.map((each) => each.visited).join(" and ");
      const lost = news.diverged === null ? "" : ` Diverged at ${news.diverged.toFixed(3)} s.`;
      return `${begin.title} on ${begin.along}: pass ${news.pass} of ${news.limit}${what}; RMS error ${news.words}; ${table} cells visited.${lost}`;
    },
    moment: (news) => `pass ${news.pass}${news.complete ? "" : `, ${news.time.toFixed(2)} s`}`,
    table: "What is learned",
    visits: "Visits",
    errorOfPasses: "Error of each pass",
    axis: "axis",
    noTraining: "Nothing has been learned yet.",
    tableLabel: (axis, table, count) => `Table of ${axis}: ${table.visited} of ${count} cells visited, ${table.changed} changed, values from ${Math.min(...table.values)} to ${Math.max(...table.values)}. Arrow keys read the cells; those that were never visited are hatched.`,
    visitsLabel: (axis, most) => `How often each cell of ${axis} was used, ${most} times at most. Arrow keys read the cells.`,
    errorsLabel: (errors, begin, news) => errors.length ? `RMS error after ${errors.length} passes: ${news.words}; at first ${errors[0].map((x2) => x2.toPrecision(3)).join(" and ")}.` : "No pass is over yet.",
    cell: (place, value, visits) => visits ? `${place}: ${value}, used ${visits} ${visits === 1 ? "time" : "times"}` : `${place}: ${value}, never used`,
    prove: "Prove",
    proveIt: "Prove",
    proveLines: (count) => count === 1 ? "The text has one `prove` line." : `The text has ${count || "no"} \`prove\` lines.`,
    certificate: "Certificate",
    certificateHint: "Certify what is proved of a loop; fuzzyarm prove --check asks such a file whether it proves what it says",
    proveEnds: { done: "All is judged.", stopped: "Stopped." },
    toLoad: "To load:",
    savedAs: (name) => `Saved as ${name}.`,
    sweep: "Sweep",
    sweepEnds: { done: "All runs are made.", stopped: "Stopped." },
    sweepReady: (gains) => `NAME=A..B:N takes N values from A to B of a gain${gains.length ? ` (${gains.join(", ")})` : ""} or a parameter of the plant.`,
    fit: "Fit",
    fitIt: "Fit",
    fitEnds: { done: "It can be saved.", stopped: "Stopped." },
    fitReady: "A rule base is learned from samples of this folder; the last column is what is learned, unless a target is named.",
    noSamples: "There is no .csv file in this folder; a table or a rule base can be learned as well.",
    none: "none",
    tune: "Tune",
    needsConnect: (name) => `${name} (other axes)`,
    asCompared: "the usual ones",
    fifth: "a fifth of them",
    stopAndKeep: "Stop, keep the best",
    stopping: "Stopping; the best so far is judged \u2026",
    insertTune: "Write it into the text",
    whatMoves: ({ says, parameters, why, loop, plants, samples: samples2 }) => {
      if (why) return `${why[0].toUpperCase()}${why.slice(1)}.`;
      const names = parameters.length > 6 ? `${parameters.length} numbers` : parameters.join(", ");
      const where = loop && !plants.some((each) => each.fits) ? " No plant here has its axes; names can be joined to ports." : !loop && !samples2.length ? " A rule base alone is fitted to samples: there is no .csv file in this folder." : "";
      return `${says ? `What may move, as the text says: ${names}.` : `The text has no tune block and no gain with a range, so all peaks move that can: ${names}.`}${where}`;
    },
    searching: (phase, count, best, evals) => phase === "linear" ? `The linear PD is tuned on the same: ${count} trials.` : `${count} of ${evals} trials; the best costs ${best === null ? "nothing known" : best.toPrecision(4)}.`,
    stopped: (report) => `Stopped after ${report.trials} trials; the best is kept.`,
    tuned: (report) => `${report.trials} trials in ${report.seconds.toFixed(1)} s.`,
    searchState: (count, best, seconds) => `${count} trials, ${seconds.toFixed(0)} s, best ${best === null ? "\u2013" : best.toPrecision(4)}`,
    costOfTrials: "Cost of the trials",
    costLabel: (count, best) => count ? `Cost of ${count} trials; the best so far costs ${best === null ? "nothing known" : best.toPrecision(4)}.` : "No trial yet.",
    numbersThatMove: "Numbers that move, between their bounds",
    numberLabel: (name, value, low, high, start2) => `${name}: ${value}, between ${low} and ${high}; ${start2} in the file`,
    inTheFile: "in the file",
    more: (count) => `\u2026 and ${count} more.`,
    noSearch: "Nothing is being searched.",
    whatCameOfIt: "What came of it",
    waiting: "The report comes when the search is over.",
    noReport: "Start a search; its report stands here: cost on what it was tuned on, on unseen scenarios and with noise, and what changed.",
    costs: (report) => `${report.cost}, ${report.over} of ${report.scenarios.length === 1 ? "1 scenario" : `${report.scenarios.length} scenarios`}`,
    sets: { train: "train", unseen: "unseen", noisy: "noisy" },
    rmsOf: (set) => `rms (${set})`,
    chatterOf: (set) => `chatter (${set})`,
    diverge: (count) => `${count} diverge`,
    changes: "What changes",
    difference: "The lines that differ",
    takeIt: "Take it",
    takeItHint: "Write the new numbers into the text; one step back undoes it",
    taken: (written) => `The text has the new numbers; one step back undoes them.${written.length ? ` ${written.join(", ")} is written.` : ""}`,
    notTaken: "The text has changed in the same lines meanwhile.",
    notDrawn: "The text has mistakes; nothing has been drawn yet.",
    noRules: "Pictures are drawn of rule bases and controllers. The cells of a table stand in the view Table.",
    diagram: "Block diagram",
    diagramLabel: (name, count) => `Block diagram of ${name}: ${count} blocks; each leads to its line of the text.`,
    blockKinds: { times: "product", plus: "sum", sum: "sum of", port: "", drive: "drive" },
    toRules: "Rule base",
    lookedUp: "What it looks up",
    openFile: (name) => `Open ${name}`,
    rulesOf: (count) => count === 1 ? "1 rule" : `${count} rules`,
    cellsOf: (count) => `table of ${count} cells`,
    sheetLabel: ({ name, output, x: x2, y }) => `${name}: ${output} over ${x2}${y ? ` and ${y}` : ""}`,
    notHere: (reason) => `This page does not compute ${reason}. fuzzyarm eval and fuzzyarm plot do.`,
    tooManyRules: "There are too many rules to be drawn.",
    readOnly: "This page needs no server. Corners can be dragged; the text follows.",
    madeBy: (version) => `made by fuzzyarm ${version}`,
    playground: {
      loading: "Python is being loaded; what you type is kept, and checked when it is there.",
      doing: {
        python: "Python is being started; what you type is kept, and checked when it is there.",
        fuzzyarm: "fuzzyarm is being loaded; what you type is kept, and checked when it is there."
      },
      failed: (why) => `Python does not run here: ${why}. Your text is kept in this browser; load the page again to try anew.`,
      notLoaded: "its files could not be loaded",
      noWebAssembly: "This browser has no WebAssembly, which checking and running need; here are your texts, and nothing is lost.",
      noWorker: "This browser has no workers, which checking and running need; here are your texts, and nothing is lost.",
      noServer: "A browser loads Python from a web server only, not from a file: type  python -m http.server  in this folder, and open the address that it prints.",
      damagedLink: "The link is damaged: the file that it carried cannot be read. Your own files are as they were.",
      notKept: "This browser's storage is full: the text lasts only as long as this page is open. Download it.",
      notLasting: "This browser keeps nothing: download what you want to keep.",
      link: "Link",
      linkHint: "an address that carries this file",
      linkNote: "Whoever opens this address has the file; it is not sent to a server.",
      linkTooLong: "The file is too long for an address. Download it, and send it as a file.",
      address: "Address",
      copy: "Copy",
      notCopied: "The browser does not let the page copy: copy the address by hand.",
      download: "Download",
      downloadHint: "save the text as a file"
    }
  };

  // diagram.js
  var ROOM2 = 14;
  var TIP = 7;
  var SIGNS2 = { "+": "+", "-": "\u2212", "*": "\xD7", "/": "\xF7" };
  var GREATEST = 1.25;
  function outline({ kind, round, x: x2, y, width, height }) {
    const [right, bottom] = [x2 + width, y + height];
    if (round)
      return `M${x2} ${y + width / 2}a${width / 2} ${width / 2} 0 0 1 ${width} 0V${bottom - width / 2}a${width / 2} ${width / 2} 0 0 1 ${-width} 0Z`;
    if (kind !== "gain") return `M${x2} ${y}H${right}V${bottom}H${x2}Z`;
    return `M${x2} ${y}H${right - 16}L${right} ${y + height / 2}L${right - 16} ${bottom}H${x2}Z`;
  }
  function diagramPicture(diagram, goTo) {
    const { width, height, blocks, strokes, tips, dots, words: words2 } = diagram;
    const line = ([x1, y1, x2, y2]) => svg("line", { x1, y1, x2, y2 });
    const tip = ([x2, y]) => svg("path", { class: "tip", d: `M${x2} ${y}l${-TIP} ${-TIP / 2}v${TIP}Z` });
    const word = ({ text, x: x2, y, style }) => svg("text", { x: x2, y, class: style }, text);
    const picture = svg(
      "svg",
      {
        viewBox: `${-ROOM2} ${-ROOM2} ${width + 2 * ROOM2} ${height + 2 * ROOM2}`,
        role: "group",
        "aria-label": S.diagramLabel(diagram.name, blocks.length),
        class: "wires"
      },
      ...strokes.map(line),
      ...tips.map(tip),
      ...dots.map(([cx, cy]) => svg("circle", { cx, cy, r: 3 })),
      ...words2.map(word),
      ...blocks.map((block) => blockPicture(block, goTo))
    );
    picture.style.width = `${Math.round(GREATEST * (width + 2 * ROOM2))}px`;
    return picture;
  }
  function blockPicture(block, goTo) {
    const { kind, x: x2, y, width, height, lines, pins, label, at: at2 } = block;
    const middle = x2 + (width - (kind === "gain" ? 16 : 0)) / 2;
    const top = y + (height - 16 * lines.length) / 2;
    const said2 = `${S.blockKinds[kind] ?? kind} ${label}`.trim();
    const leads = at2 && goTo ? {
      tabindex: 0,
      role: "button",
      onclick: () => goTo(at2),
      onkeydown: (event) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), goTo(at2))
    } : {};
    return svg(
      "g",
      { class: `block ${kind}`, ...leads },
      svg("title", {}, said2),
      svg("path", { d: outline(block) }),
      ...lines.map(([text, style], i) => svg("text", { x: middle, y: top + 16 * i + 12, class: style }, text)),
      ...pins.map(([sign, , at_]) => svg("text", { x: x2 + width / 2, y: at_ + 5, class: "sign" }, SIGNS2[sign] ?? sign))
    );
  }
  function sheetCard(sheet, hand, names) {
    const canvas = el("canvas", { role: "img", "aria-label": S.sheetLabel(sheet) });
    const open2 = sheetButton(sheet, hand, names);
    const words2 = sheet.kind === "rules" ? S.rulesOf(sheet.count) : S.cellsOf(sheet.count);
    const card = el(
      "div",
      { class: "sheet" },
      el(
        "div",
        { class: "row" },
        el("strong", { textContent: sheet.name }),
        el("span", { class: "small", textContent: words2 }),
        el("span", { class: "space" }),
        ...open2
      ),
      sheet.panel ? canvas : el("p", { class: "note", textContent: sheet.why })
    );
    const draw = () => {
      if (sheet.panel) drawPanel(canvas, sheet.panel);
    };
    return { card, draw };
  }
  function sheetButton({ file, shipped }, hand, names) {
    if (names.includes(file)) return [el("button", { textContent: S.openFile(file), onclick: () => hand.turnTo(file) })];
    if (!shipped) return [];
    return [
      el("button", {
        textContent: S.copyHere(file),
        title: S.copyHereHint,
        onclick: async (event) => {
          const made = await hand.folder({ what: "adopt", file });
          if (made.open) hand.turnTo(made.open);
          else event.target.after(el("span", { class: "error", role: "alert", textContent: made.error }));
        }
      })
    ];
  }
  function diagramPane(store2, hand) {
    const { section, bar: bar2, body } = pane("diagram", S.diagram);
    const said2 = el("span", { class: "small" });
    const picture = el("div", { class: "canvas" });
    const list = el("div", { class: "sheets", role: "group", "aria-label": S.lookedUp });
    let cards = [];
    let used = "";
    let asked = "";
    const toRules = el("button", { textContent: S.toRules, onclick: () => store2.turnDiagram(false) });
    bar2.append(said2, el("span", { class: "space" }), toRules);
    body.append(picture, list);
    function build() {
      const { diagram } = store2;
      toRules.hidden = !store2.scene;
      if (!diagram) return;
      said2.textContent = clean([diagram.name, diagram.description, diagram.period].filter(Boolean).join(", "));
      picture.replaceChildren(diagramPicture(diagram, hand.goTo));
      if (uses() !== used) look();
    }
    const uses = () => JSON.stringify(store2.diagram?.uses ?? null);
    async function look() {
      if (!store2.diagram || store2.view !== "design") return;
      used = uses();
      const listing = await hand.folder({ what: "list" });
      if (!listing.files || used !== uses()) return;
      const names = listing.files.map((each) => each.name);
      const files = store2.diagram.uses.flatMap(([, ...each]) => each);
      const key2 = JSON.stringify([
        used,
        listing.files.filter((each) => files.includes(each.name)).map((each) => [each.name, each.stamp])
      ]);
      if (key2 === asked) return;
      asked = key2;
      hand.start("sheets", {}, (news) => {
        if (news.end === "failed") asked = used = "";
        if (!news.sheets || key2 !== asked) return;
        cards = news.sheets.map((sheet) => sheetCard({ ...sheet, shipped: sheet.shipped && !listing.only }, hand, names));
        list.replaceChildren(...cards.map(({ card }) => card));
        redraw();
      });
    }
    const redraw = eachFrame(() => {
      for (const { draw } of cards) draw();
    });
    store2.on("diagram", build);
    store2.on("scene", build);
    for (const name of ["view", "shown", "unsaved", "files"]) store2.on(name, look);
    store2.on("theme", redraw);
    new ResizeObserver(redraw).observe(list);
    return section;
  }

  // dialogs.js
  function opened(name, ...content) {
    const form = el("form", { method: "dialog" }, ...content);
    const dialog = el("dialog", { "aria-label": name }, form);
    const refocus = keepFocus(document.body);
    document.body.append(dialog);
    dialog.showModal();
    return new Promise((resolve) => {
      dialog.addEventListener("close", () => {
        dialog.remove();
        refocus();
        resolve(dialog.returnValue);
      });
    });
  }
  async function ask(question, text, button) {
    const field = el("input", { type: "text", value: text, "aria-label": question });
    const row = el(
      "div",
      { class: "row" },
      el("button", { value: "", textContent: S.cancel, type: "submit", formNoValidate: true }),
      el("button", { value: "ok", textContent: button, type: "submit" })
    );
    const enter = el("button", { value: "ok", class: "unseen", tabIndex: -1, type: "submit", "aria-hidden": "true" });
    setTimeout(() => field.select());
    return await opened(question, enter, el("label", {}, question), field, row) === "ok" ? field.value : null;
  }
  async function choose(title2, texts) {
    const choices = el("div", { class: "choices", role: "group", "aria-label": title2 });
    texts.forEach((text, i) => choices.append(el("button", { value: String(i), textContent: text, type: "submit" })));
    const row = el("div", { class: "row" }, el("button", { value: "", textContent: S.cancel, type: "submit" }));
    const found = await opened(title2, el("strong", {}, title2), choices, row);
    return found === "" ? null : Number(found);
  }
  async function tellAll(title2, lines) {
    const list = el("ul", { class: "choices" }, ...lines.map((line) => el("li", { textContent: line })));
    const row = el("div", { class: "row" }, el("button", { value: "", textContent: S.close, type: "submit" }));
    await opened(title2, el("strong", {}, title2), list, row);
  }
  function fill(title2, fields, button, act, note = "") {
    const wrong = el("p", { class: "error", role: "alert" });
    const controls = fields.map(
      ({ name, value, options, hint }) => options ? el(
        "select",
        { name },
        ...options.map(([key2, words2]) => el("option", { value: key2, textContent: words2, selected: key2 === value }))
      ) : el("input", { type: "text", name, value, placeholder: hint ?? "", autocomplete: "off", spellcheck: false })
    );
    const labels = fields.map(
      ({ label }, i) => el("label", { class: "field" }, el("span", { textContent: label }), controls[i])
    );
    const go3 = el("button", { type: "submit", textContent: button });
    const stop = el("button", { type: "button", textContent: S.cancel, onclick: () => dialog.close() });
    const form = el(
      "form",
      {},
      el("strong", {}, title2),
      ...note ? [el("p", { textContent: note })] : [],
      ...labels,
      wrong,
      el("div", { class: "row" }, stop, go3)
    );
    const dialog = el("dialog", { "aria-label": title2 }, form);
    const refocus = keepFocus(document.body);
    let done = null;
    const dim = () => fields.forEach(({ when = {} }, i) => {
      labels[i].hidden = controls[i].disabled = Object.entries(when).some(
        ([name, value]) => (form.elements[name]?.value ?? value) !== value
      );
    });
    form.addEventListener("change", dim);
    dim();
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      go3.disabled = true;
      const answer = await act(Object.fromEntries(new FormData(form)));
      go3.disabled = false;
      wrong.textContent = answer.error ?? "";
      if (answer.error) return;
      done = answer;
      dialog.close();
    });
    document.body.append(dialog);
    dialog.showModal();
    const text = controls.find((each) => each.tagName === "INPUT");
    (text ?? go3).focus();
    if (text) text.setSelectionRange(0, text.value.length - suffixOf(text.value).length);
    return new Promise((resolve) => {
      dialog.addEventListener("close", () => {
        dialog.remove();
        refocus();
        resolve(done);
      });
    });
  }
  var suffixOf = (value) => (/^[^/:]*[^/:.](\.[a-z][a-z0-9]*)$/i.exec(value) ?? ["", ""])[1];

  // fields.js
  var typesOf = (schema) => [schema.type].flat();
  var typeOf = (schema) => typesOf(schema).find((type) => type !== "null");
  var isOptional = (field) => typesOf(field).includes("null");
  function controlOf(field) {
    if (typeOf(field) === "array") return field.placeholder === "LINE" ? "lines" : "text";
    if (field.enum) return "choice";
    if (typeOf(field) !== "boolean") return "text";
    return isOptional(field) ? "choice" : "check";
  }
  function choicesOf(field, words2) {
    const known = field.enum ?? [true, false];
    const spoken = { true: words2.yes, false: words2.no };
    const listed = known.filter((value) => value !== null).map((value) => [String(value), spoken[value] ?? String(value)]);
    return (
      /** @type {any} */
      isOptional(field) ? [["", words2.usual], ...listed] : listed
    );
  }
  function shownDefault(field) {
    if (controlOf(field) === "check") return field.default === true;
    return [field.default ?? ""].flat().join(controlOf(field) === "lines" ? "\n" : " ");
  }
  function valueOf(field, shown) {
    if (typeof shown === "boolean") return shown;
    const text = shown.trim();
    if (typeOf(field) === "array") return text.split(controlOf(field) === "lines" ? /\s*\n\s*/ : BETWEEN).filter(Boolean);
    if (typeOf(field) === "boolean") return text === "" ? null : text === "true";
    return text;
  }
  var BETWEEN = /\s+(?!log(?:\s|$))/;
  var saysNothing = (field, value) => [value ?? ""].flat().join(" ") === [field.default ?? ""].flat().join(" ");
  function optionsOf(fields, values) {
    return fields.flatMap((field) => {
      const value = values[field.name];
      if (!field.option || value === void 0 || value === null || value === "" || saysNothing(field, value)) return [];
      if (typeof value === "boolean") return value ? [field.option] : [field.option.replace("--", "--no-")];
      if (!Array.isArray(value)) return [field.option, value];
      return field.repeated ? value.flatMap((each) => [field.option, each]) : [field.option, ...value];
    });
  }
  var quoted = (word) => /^[\w./:=,+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;

  // form.js
  var JUDGED = { check: "change", choice: "change", lines: "input", text: "input" };
  var forms = 0;
  function refill(select, options, chosen = select.value) {
    select.replaceChildren(...options.map(([value, text]) => el("option", { value, textContent: text })));
    if (options.some(([value]) => value === chosen)) select.value = chosen;
  }
  var Form = class {
    /**
     * @param {{ changed?: (name: string) => void, judge?: (values: Record<string, any>) => Promise<Page.Answer> }} ends
     *   `changed` hears which field was; `judge` asks what is wrong while a hand fills the form in.
     */
    constructor({ changed = () => {
    }, judge } = {}) {
      this.changed = changed;
      this.judge = judge;
      this.id = `form-${++forms}`;
      this.rows = /* @__PURE__ */ new Map();
      this.first = el("div", { class: "fields" });
      this.folded = el("div", { class: "folded" });
      this.view = el("div", { class: "request" }, this.first, this.folded);
      this.asked = 0;
    }
    /**
     * Build the fields, where they are not there yet.
     *
     * @param {Messages.FormField[]} fields
     */
    open(fields) {
      if (this.rows.size) return;
      const groups = /* @__PURE__ */ new Map([["", this.first]]);
      for (const field of fields) {
        const group = field.group ?? "";
        if (!groups.has(group)) groups.set(group, this.fold(group));
        groups.get(group).append(this.row(field));
      }
    }
    fold(title2) {
      const inside = el("div", { class: "fields" });
      const words2 = title2.charAt(0).toUpperCase() + title2.slice(1);
      this.folded.append(el("details", { class: "experiment" }, el("summary", { textContent: words2 }), inside));
      return inside;
    }
    /** @param {Messages.FormField} field */
    row(field) {
      const kind = controlOf(field);
      const input = this.control(field, kind);
      input.title = field.description ?? "";
      input.dataset.key = `${this.id}-${field.name}`;
      input.addEventListener(JUDGED[kind], () => this.touched(field.name));
      const words2 = field.unit ? `${field.title}, ${field.unit}` : field.title;
      const label = kind === "check" ? el("label", { class: "check", title: field.description }, input, words2) : el("label", { class: "field", title: field.description }, el("span", { textContent: words2 }), input);
      this.rows.set(field.name, { field, input, label });
      return label;
    }
    control(field, kind) {
      const shown = shownDefault(field);
      if (kind === "check") return el("input", { type: "checkbox", checked: shown });
      if (kind === "choice") {
        const select = el("select");
        refill(select, choicesOf(field, { usual: S.usual, yes: S.yes, no: S.no }), shown);
        return select;
      }
      const plain = { value: shown, spellcheck: false, autocomplete: "off" };
      const isNumber = ["integer", "number"].includes(typeOf(field));
      const placeholder = isNumber || !field.placeholder ? isOptional(field) ? S.usual : "" : field.placeholder;
      if (kind === "lines") return el("textarea", { ...plain, rows: 2, cols: 30, placeholder: S.oneALine });
      return el("input", {
        ...plain,
        type: "text",
        placeholder,
        size: isNumber ? 7 : typeOf(field) === "array" ? 18 : 12,
        inputMode: isNumber ? "decimal" : "text"
      });
    }
    /** A field has been changed by a hand; what is wrong with it is asked for once it rests. */
    touched(name) {
      this.changed(name);
      if (!this.judge) return;
      const mine = ++this.asked;
      setTimeout(async () => {
        if (mine !== this.asked) return;
        const { field = "", message = "" } = await this.judge(this.values());
        if (mine === this.asked) this.mark(field, message, false);
      }, 250);
    }
    has = (name) => this.rows.has(name);
    input = (name) => this.rows.get(name)?.input;
    isShown = (name) => this.rows.get(name)?.label.hidden === false;
    /** The value of a field as its control shows it; empty while it is not there. */
    shown = (name) => this.input(name)?.value ?? "";
    set(name, value) {
      const input = this.input(name);
      if (!input) return;
      if (input.type === "checkbox") input.checked = value;
      else input.value = value;
    }
    /** Give a field choices that only the page knows: files, plants. */
    choices(name, pairs2, chosen = this.shown(name)) {
      const row = this.rows.get(name);
      if (!row) return;
      if (row.input.tagName !== "SELECT") {
        const select = el("select", { title: row.input.title });
        select.dataset.key = row.input.dataset.key;
        select.addEventListener("change", () => this.touched(name));
        row.input.replaceWith(select);
        row.input = select;
      }
      refill(row.input, pairs2, chosen);
    }
    /** Suggest values of a text. */
    suggest(name, values) {
      const row = this.rows.get(name);
      if (!row) return;
      const id2 = `${row.input.dataset.key}-list`;
      row.label.querySelector("datalist")?.remove();
      row.label.append(el("datalist", { id: id2 }, ...values.map((value) => el("option", { value }))));
      row.input.setAttribute("list", id2);
    }
    /** Show some fields and hide others. */
    show(names, isShown) {
      for (const name of names) if (this.rows.has(name)) this.rows.get(name).label.hidden = !isShown;
      for (const details of this.folded.children)
        details.toggleAttribute("hidden", ![...details.querySelectorAll("label")].some((label) => !label.hidden));
    }
    /** Whether a hand may fill it in. */
    lock(isLocked) {
      for (const { input } of this.rows.values()) input.disabled = isLocked;
    }
    /**
     * What the fields say that are seen, by name.
     *
     * @returns {Record<string, any>}
     */
    values() {
      const found = {};
      for (const [name, { field, input, label }] of this.rows) {
        if (!label.hidden) found[name] = valueOf(field, input.type === "checkbox" ? input.checked : input.value);
      }
      return found;
    }
    /** The same in words of a command. */
    words(values = this.values()) {
      const fields = [...this.rows.values()].map(({ field }) => field);
      return optionsOf(fields, values).map(quoted);
    }
    /** Say a mistake beside its field, and nothing beside others; where no field has that name, say so. */
    mark(name, message = "", focus = true) {
      if (focus) this.asked++;
      for (const [own, { input, label }] of this.rows) {
        label.querySelector(".wrong")?.remove();
        if (own !== name) {
          input.removeAttribute("aria-invalid");
          input.removeAttribute("aria-describedby");
          continue;
        }
        const id2 = `${this.id}-wrong`;
        input.setAttribute("aria-invalid", "true");
        input.setAttribute("aria-describedby", id2);
        input.closest("details")?.setAttribute("open", "");
        label.append(el("span", { class: "wrong", id: id2, role: "alert", textContent: clean(message) }));
        if (focus) input.focus();
      }
      return this.rows.has(name);
    }
  };

  // exports.js
  var GROUPS = [
    ["programs", [".h", ".c", ".st", ".fmu", ".mjs"]],
    ["tables", [".lut", ".csv", ".tex", ".json", ".npz"]],
    ["pictures", [".png", ".svg"]],
    ["pages", [".html"]],
    ["others", [".fis", ".fll", ".fcl", ".fml"]]
  ];
  function exportPane(store2, hand) {
    const { section, body } = pane("exports", S.exports);
    const note = el("p", { class: "note", textContent: S.exportsNote });
    const groups = el("div", { class: "groups" });
    body.append(note, groups);
    async function build() {
      if (store2.view !== "files" || !hand.file()) return;
      const { forms: forms2 = {} } = await hand.askNow("exports");
      groups.replaceChildren(
        ...GROUPS.flatMap(([name, suffixes]) => {
          const shown = suffixes.filter((suffix) => suffix in forms2);
          if (!shown.length) return [];
          const buttons = shown.map(
            (suffix) => el("button", {
              textContent: S.exportKinds[suffix],
              title: suffix,
              onclick: () => exportDialog(store2, hand, suffix, forms2[suffix])
            })
          );
          return [
            el(
              "div",
              { role: "group", "aria-label": S.exportGroups[name] },
              el("h3", { textContent: S.exportGroups[name] }),
              ...buttons
            )
          ];
        })
      );
    }
    store2.on("view", build);
    store2.on("text", build);
    return section;
  }
  function exportDialog(store2, hand, suffix, fields) {
    const state = el("p", { class: "state", role: "status" });
    const found = el("ul", { class: "made" });
    const lines = el("pre", { class: "printed", tabIndex: 0, hidden: true, "aria-label": S.report });
    const go3 = el("button", { type: "submit", textContent: S.exportNow });
    const close = el("button", { type: "button", textContent: S.close, onclick: () => dialog.close() });
    const asked = new Form();
    asked.open(fields);
    const outputs = (store2.scene?.outputs ?? []).map((each) => [each.name, each.name]);
    const every = [".h", ".c", ".st", ".png", ".svg"].includes(suffix) ? [["", S.everyOutput]] : [];
    asked.choices("output", [...every, ...outputs]);
    asked.show(["output"], outputs.length > 1);
    const form = el(
      "form",
      { class: "exporting" },
      el("strong", { textContent: S.exportTitle(S.exportKinds[suffix], hand.file()) }),
      asked.view,
      state,
      found,
      lines,
      el("div", { class: "row" }, close, go3)
    );
    const dialog = el("dialog", { "aria-label": S.exports }, form);
    let job = null;
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      if (job) return;
      const options = asked.values();
      asked.mark("");
      go3.disabled = true;
      found.replaceChildren();
      lines.hidden = true;
      state.textContent = S.working;
      state.classList.remove("error");
      await hand.settled();
      job = hand.start("export", { suffix, options }, hear);
    });
    function hear(news) {
      if (news.doing) state.textContent = clean(`${news.doing} \u2026`);
      if (news.files) show(news);
      if (!news.end) return;
      job = null;
      go3.disabled = false;
      if (news.end === "failed") {
        state.textContent = asked.mark(news.field ?? "", news.message) ? "" : clean(news.message);
        state.classList.add("error");
      } else if (news.end === "done") state.textContent = S.exported;
    }
    function show(news) {
      const links = news.files.map(
        ({ name, bytes, href }) => el("a", { href, download: name, textContent: S.download(clean(name), bytes) })
      );
      found.replaceChildren(...links.map((link) => el("li", {}, link)));
      lines.textContent = clean(news.lines.join("\n"));
      lines.hidden = !news.lines.length;
      if (links.length === 1) links[0].click();
    }
    dialog.addEventListener("close", () => {
      job?.stop();
      dialog.remove();
    });
    document.body.append(dialog);
    dialog.showModal();
    if (!fields.length) form.requestSubmit();
  }

  // starts.js
  function invitation({ starts, foreign, trouble }, { begin, convert, choose: choose2 }) {
    const cards = Object.entries(starts).map(
      ([kind, words2]) => el(
        "button",
        { disabled: Boolean(trouble), onclick: () => begin(kind) },
        el("strong", { textContent: S.startTitles[kind] ?? kind }),
        el("span", { textContent: words2 })
      )
    );
    return [
      el("h3", { textContent: S.emptyFolder }),
      el("p", { textContent: S.emptyHint }),
      el("div", { class: "starts", role: "group", "aria-label": S.emptyFolder }, ...cards),
      ...offers(foreign, { convert }),
      el(
        "p",
        {},
        S.orImport,
        " ",
        el("button", { textContent: S.importFile, disabled: Boolean(trouble), onclick: choose2 })
      )
    ];
  }
  function offers(foreign, { convert }) {
    if (!foreign.length) return [];
    const buttons = foreign.map(
      (name) => el("button", { textContent: clean(name), title: S.convertHint, onclick: () => convert(name) })
    );
    return [
      el("p", {}, S.foreignFiles),
      el("div", { class: "foreign", role: "group", "aria-label": S.foreignFiles }, ...buttons)
    ];
  }

  // table.js
  var isTable = (name) => /\.lut$/i.test(name);
  function cellsPane(store2, hand) {
    return new CellsPane(store2, hand).section;
  }
  var CellsPane = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand) {
      this.store = store2;
      this.hand = hand;
      const { section, bar: bar2, body } = pane("cells", S.cells);
      this.section = section;
      this.bar = bar2;
      this.body = body;
      this.page = [];
      this.asked = 0;
      this.section.hidden = true;
      this.store.on("view", this.look);
      this.store.on("text", this.look);
    }
    look = async () => {
      this.section.hidden = !isTable(this.hand.file());
      if (this.section.hidden || this.store.view !== "table") return;
      const mine = ++this.asked;
      const { table } = await this.hand.askNow("table", { page: this.page });
      if (mine !== this.asked) return;
      if (table) this.show(table);
      else this.section.classList.add("stale");
    };
    show = (table) => {
      this.section.classList.remove("stale");
      ({ page: this.page } = table);
      while (this.bar.childNodes.length > 1) this.bar.lastChild.remove();
      this.bar.append(el("span", { class: "space" }));
      const outer = table.axes.slice(0, -2);
      outer.forEach((axis, k) => {
        const levels2 = axis.levels.map((x2, i) => [String(i), shortNumber(x2, 6)]);
        this.bar.append(
          choice(axis.name, levels2, String(this.page[k]), (i) => {
            this.page = this.page.with(k, Number(i));
            this.look();
          })
        );
      });
      this.body.replaceChildren(this.words(table), this.grid(table));
    };
    words = (table) => {
      const axes2 = table.axes.map(
        (axis) => S.axisLevels(
          axis.name,
          axis.levels.length,
          shortNumber(axis.levels[0], 6),
          shortNumber(axis.levels.at(-1), 6),
          axis.bins
        )
      );
      const thin = table.columns.length < table.axes.at(-1).levels.length || table.rows.length < (table.axes.at(-2)?.levels.length ?? 1);
      return el("p", {
        class: "note",
        textContent: [
          S.tableOf(table.output, table.cells, table.mode),
          table.description,
          ...axes2,
          thin ? S.thinned : "",
          ...table.says.filter(([key2]) => key2 === "source" || key2.startsWith("error")).map(([key2, value]) => `${key2}: ${value}`)
        ].filter(Boolean).join(" \xB7 ")
      });
    };
    grid = (table) => {
      const across = table.axes.at(-1);
      const down = table.axes.at(-2);
      const corner = down ? `${down.name} \\ ${across.name}` : across.name;
      const head = el("tr", {}, el("th", { scope: "col", textContent: corner }));
      for (const j2 of table.columns)
        head.append(el("th", { scope: "col", textContent: shortNumber(across.levels[j2], 5) }));
      const rows = table.rows.map((i, k) => {
        const label = down ? shortNumber(down.levels[i], 5) : table.output;
        const line = el("tr", {}, el("th", { scope: "row", textContent: label }));
        table.values[k].forEach((value, m) => {
          const cell = [...this.page, ...down ? [i] : [], table.columns[m]];
          const shown = el("button", {
            textContent: shortNumber(value, 5),
            tabIndex: k || m ? -1 : 0,
            onclick: () => this.goTo(cell)
          });
          [shown.style.background, shown.style.color] = heat((value - table.low) / (table.high - table.low || 1));
          line.append(el("td", {}, shown));
        });
        return line;
      });
      const made = el(
        "table",
        { class: "cells" },
        el("caption", { class: "unseen", textContent: S.tableOf(table.output, table.cells, table.mode) }),
        el("thead", {}, head),
        el("tbody", {}, ...rows)
      );
      made.addEventListener("keydown", (event) => this.step(event, made));
      return made;
    };
    /** Arrow keys go from cell to cell; one of them is in the order of the Tab key. */
    step = (event, made) => {
      const [dy, dx] = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key] ?? [];
      const held = (
        /** @type {HTMLElement} */
        document.activeElement
      );
      const td2 = held.closest?.("td");
      if (dy === void 0 || !td2) return;
      event.preventDefault();
      const next = made.tBodies[0].rows[
        /** @type {HTMLTableRowElement} */
        td2.parentElement.sectionRowIndex + dy
      ]?.cells[td2.cellIndex + dx]?.querySelector("button");
      if (!next) return;
      held.tabIndex = -1;
      next.tabIndex = 0;
      next.focus();
    };
    goTo = async (cell) => {
      const { range } = await this.hand.askNow("table-cell", { cell });
      if (range) this.hand.goTo(range[0]);
    };
  };
  function errorPane(store2, hand) {
    return new ErrorPane(store2, hand).section;
  }
  var ErrorPane = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand) {
      this.store = store2;
      this.hand = hand;
      const { section, bar: bar2, body } = pane("accuracy", S.tableError);
      this.section = section;
      this.bar = bar2;
      this.canvas = el("canvas", { role: "img", "aria-label": S.tableError });
      this.state = el("p", { class: "note", role: "status" });
      this.worst = el("p", { class: "worst" });
      this.lines = el("pre", { class: "printed", tabIndex: 0, hidden: true, "aria-label": S.report });
      this.wanted = { levels: "", mode: "", output: "", x: "", y: "" };
      const side = el("div", { class: "side" }, this.worst, this.state, this.lines);
      body.append(el("div", { class: "beside" }, this.canvas, side));
      this.job = null;
      this.found = null;
      this.shown = "difference";
      this.built = "";
      this.go = el("button", { textContent: S.measure, onclick: this.run });
      this.redraw = eachFrame(() => {
        this.build();
        this.draw();
      });
      this.store.on("view", () => {
        this.build();
        if (this.store.view === "table" && !this.found && !this.job) this.run();
        else this.redraw();
      });
      this.store.on("text", () => {
        if (!this.found) return;
        this.go.textContent = S.measureAgain;
        this.section.classList.add("stale");
      });
      this.go.addEventListener("click", () => this.section.classList.remove("stale"));
      for (const name of ["theme", "scene"]) this.store.on(name, this.redraw);
      new ResizeObserver(this.redraw).observe(body);
    }
    /** A proved cell as column, row and value: its numbers come in the order of the axes. */
    /** @returns {(cell: number[]) => [number, number, number]} */
    cellOf = (map) => (cell) => {
      const value = cell.at(-1);
      if (!map.y) return [cell[0], 0, value];
      const [column, row] = [map.x, map.y].map((name) => cell[map.names.indexOf(name)]);
      return [column, row, value];
    };
    /** @returns {Page.Pair | null} */
    inSlice = (map, at2) => Object.keys(map.held).length ? null : [at2[map.x], at2[map.y]];
    build = () => {
      const outputs = isTable(this.hand.file()) ? [] : (this.store.scene?.outputs ?? []).map((each) => each.name);
      const names = this.found?.map.names ?? [];
      const key2 = JSON.stringify([isTable(this.hand.file()), outputs, names, this.shown]);
      if (key2 === this.built) return;
      this.built = key2;
      while (this.bar.childNodes.length > 1) this.bar.lastChild.remove();
      this.bar.append(el("span", { class: "space" }));
      const set = (name) => (value) => {
        this.wanted[name] = value;
        this.run();
      };
      if (outputs.length > 1)
        this.bar.append(
          choice(
            S.shown,
            outputs.map((n66) => [n66, n66]),
            this.wanted.output || outputs[0],
            set("output")
          )
        );
      if (!isTable(this.hand.file())) {
        const levels2 = el("input", {
          type: "text",
          class: "short",
          value: this.wanted.levels,
          placeholder: S.asInFile,
          title: S.levelsHint,
          onchange: () => set("levels")(levels2.value)
        });
        this.bar.append(el("label", { class: "small" }, S.options.levels, levels2));
      }
      this.bar.append(
        choice(
          S.options.mode,
          [
            ["", S.asInFile],
            ["bins", "bins"],
            ["nearest", "nearest"],
            ["linear", "linear"]
          ],
          this.wanted.mode,
          set("mode")
        )
      );
      if (names.length > 2) {
        const axes2 = names.map((n66) => [n66, n66]);
        this.bar.append(
          choice(S.horizontal, axes2, this.found.map.x, set("x")),
          choice(S.vertical, axes2, this.found.map.y, set("y"))
        );
      }
      this.bar.append(
        choice(
          S.view,
          [
            ["difference", S.signed],
            ["proved", S.provedCells]
          ],
          this.shown,
          (value) => {
            this.shown = value;
            this.redraw();
          }
        ),
        this.go
      );
    };
    run = async () => {
      this.job?.stop();
      if (this.store.view !== "table" || !this.hand.file()) return;
      this.state.classList.remove("error");
      this.state.textContent = S.working;
      if (!await this.hand.settled()) {
        this.state.textContent = S.gone;
        return;
      }
      const { levels: levels2, mode, output, x: x2, y } = this.wanted;
      const at2 = Object.fromEntries((this.store.scene?.inputs ?? []).map((each, i) => [each.name, this.store.point[i]]));
      const mine = this.hand.start("table-error", { options: { levels: levels2, mode, output }, axes: { x: x2, y, at: at2 } }, (news) => {
        if (mine === this.job || !this.job) this.hear(news);
      });
      this.job = mine;
    };
    hear = (news) => {
      if (news.map) {
        this.found = { map: news.map, cells: [], worst: null };
        this.build();
      }
      if (news.doing) this.state.textContent = clean(`${news.doing} \u2026`);
      if (news.cells) {
        this.found.cells.push(...news.cells);
        this.state.textContent = S.provedSoFar(news.done, news.of);
      }
      if (news.lines) {
        this.lines.textContent = clean(news.lines.join("\n"));
        this.lines.hidden = !news.lines.length;
        this.found.worst = news.worst;
        this.worst.textContent = clean(this.worstWords(news.worst, this.found.map.output));
      }
      if (news.unproved) this.found.unproved = news.unproved;
      if (news.end) this.ended(news);
      this.redraw();
    };
    ended = (news) => {
      this.job = null;
      if (news.end === "failed") {
        this.state.textContent = clean(news.message);
        this.state.classList.add("error");
        if (!this.found?.worst) this.worst.textContent = "";
      } else if (news.end === "done") this.state.textContent = clean(this.found.unproved ?? S.provedAll);
    };
    worstWords = ({ at: at2, table, direct, difference: difference2, proved, mode }, output) => {
      const where = Object.entries(at2).map(([name, x2]) => `${name} = ${shortNumber(x2, 5)}`).join(", ");
      return S.worstAt(
        output,
        mode,
        where,
        shortNumber(table, 6),
        shortNumber(direct, 6),
        shortNumber(difference2, 6),
        proved === null ? null : shortNumber(proved, 7)
      );
    };
    draw = () => {
      if (!this.found || this.store.view !== "table") return;
      const { map } = this.found;
      const place = this.found.worst && this.inSlice(map, this.found.worst.at);
      const title2 = S.errorTitle(
        map.output,
        map.mode,
        Object.entries(map.held).map(([n66, x2]) => `${n66} = ${shortNumber(x2)}`).join(", ")
      );
      const isProved = this.shown === "proved" && this.found.cells.length > 0;
      const panel = isProved ? this.provedPanel(map) : map.panel;
      const high = Math.max(Math.abs(panel.parts[0].value?.high ?? panel.up.high));
      const words2 = isProved ? `${S.provedCells} (\u2264 ${shortNumber(high, 6)})` : `${S.signed}, \xB1${shortNumber(high)}`;
      const worst = place ? [map.y ? markAt(place) : levelAt(place[0])] : [];
      drawPanel(this.canvas, { ...panel, title: `${title2}: ${words2}`, parts: [...panel.parts, ...worst] });
      this.canvas.setAttribute("aria-label", `${title2}. ${this.worst.textContent}`);
    };
    /** The cells whose error has been proved so far: they come one by one. */
    provedPanel(map) {
      const [x2, y] = [map.levels[map.x], map.y ? map.levels[map.y] : [0, 1]];
      const values = Array((x2.length - 1) * (y.length - 1)).fill(null);
      for (const [i, j2, value2] of this.found.cells.map(this.cellOf(map))) values[j2 * (x2.length - 1) + i] = value2;
      const high = Math.max(...values) || 1;
      const value = { words: "", low: -high, high, logarithmic: false, whole: false };
      const across = { words: map.x, low: x2[0], high: x2.at(-1), logarithmic: false, whole: false };
      const up2 = { words: map.y, low: y[0], high: y.at(-1), logarithmic: false, whole: false };
      return { title: "", across, up: up2, parts: [{ is: "cells", x: x2, y, values, value, signed: true }] };
    }
  };
  var TABLE = {
    name: "table",
    title: S.tables,
    drawn: false,
    panes: [cellsPane, errorPane],
    splits: [{ key: "table-rows", vertical: false, at: 1, usual: 0.4 }]
  };

  // files.js
  function folderPane(store2, hand) {
    return new FolderPane(store2, hand).section;
  }
  var FolderPane = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand) {
      this.store = store2;
      this.hand = hand;
      const { section, bar: bar2, body } = pane("folder", S.files);
      this.section = section;
      this.list = el("tbody");
      this.said = el("p", { class: "note", role: "status" });
      this.chosen = el("input", {
        type: "file",
        class: "unseen",
        tabIndex: -1,
        "aria-hidden": "true",
        accept: this.hand.imports.join(),
        onchange: () => {
          if (this.chosen.files.length) this.bring(this.chosen.files);
          this.chosen.value = "";
        }
      });
      this.files = [];
      this.starts = {};
      this.standing = "";
      this.round = 0;
      this.create = el("button", { textContent: S.newFile, onclick: () => this.begin() });
      bar2.append(
        el("span", { class: "space" }),
        this.create,
        el("button", { textContent: S.importFile, title: S.importHint, onclick: () => this.chosen.click() }),
        this.chosen
      );
      const heads = [S.file, S.kind, S.description, S.findings, ""].map(
        (words2) => words2 ? el("th", { scope: "col", textContent: words2 }) : el("td")
      );
      this.table = el("table", { class: "files" }, el("thead", {}, el("tr", {}, ...heads)), this.list);
      this.below = el("div", { class: "beginning" });
      body.append(this.said, this.table, this.below);
      this.list.addEventListener("keydown", (event) => {
        const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
        const names = [...this.list.querySelectorAll("button.go")];
        const at2 = names.indexOf(document.activeElement);
        if (!step || at2 < 0) return;
        event.preventDefault();
        names[Math.min(names.length - 1, Math.max(0, at2 + step))].focus();
      });
      this.hand.onDrop(this.bring);
      this.store.on("view", this.look);
      this.store.on("files", this.look);
    }
    ask = async (question) => {
      const answer = await this.hand.folder(question);
      if (answer.files) this.show(answer);
      this.said.textContent = this.standing;
      if (answer.error && !document.querySelector("dialog[open]")) this.said.textContent = clean(answer.error);
      return answer;
    };
    show = (answer) => {
      ({ files: this.files, starts: this.starts } = answer);
      this.hand.listed(this.files.map((each) => each.name));
      this.create.disabled = answer.only;
      const refocus = keepFocus(this.list);
      this.list.replaceChildren(...this.files.map((each) => this.row(each, answer.only)));
      refocus();
      this.table.hidden = !this.files.length;
      const act = { begin: this.begin, convert: this.convert, choose: () => this.chosen.click() };
      const isBegun = answer.only || this.files.some((each) => each.kind !== "table");
      this.below.replaceChildren(...isBegun ? offers(answer.foreign, act) : invitation(answer, act));
      this.standing = [answer.trouble, answer.only ? S.onlyOne : ""].filter(Boolean).join(" ");
      this.check(++this.round);
    };
    row = (each, only) => {
      const here = each.name === this.hand.file();
      const open2 = el("button", {
        class: "go",
        textContent: each.name,
        onclick: () => this.hand.turnTo(each.name),
        "aria-current": here ? "true" : "false",
        "data-key": `open ${each.name}`
      });
      const act = (words2, label, doing) => el("button", {
        textContent: words2,
        "aria-label": label(each.name),
        onclick: doing,
        disabled: only,
        "data-key": label(each.name)
      });
      const findings = el("td", { class: "small", textContent: "\u2026" });
      each.findings = findings;
      const head = el("th", { scope: "row" }, open2);
      if (each.changed) head.append(el("span", { class: "small", textContent: ` \u25CF ${S.unsaved}` }));
      return el(
        "tr",
        { class: here ? "here" : "" },
        head,
        el("td", { textContent: each.kind }),
        el("td", { textContent: each.description, title: each.description }),
        findings,
        el(
          "td",
          { class: "acts" },
          act(S.duplicate, S.duplicateOf, () => this.duplicate(each.name)),
          act(S.renameFile, S.renameOf, () => this.rename(each.name)),
          act(S.deleteFile, S.deleteOf, () => this.remove(each))
        )
      );
    };
    /** Ask for the findings of one file after the other, while they are looked at. */
    check = async (mine) => {
      for (const each of this.files) {
        if (mine !== this.round || this.store.view !== "files") return;
        const found = await this.hand.folder({ what: "findings", file: each.name });
        const words2 = found.error ?? found.summary;
        each.findings.textContent = clean(found.sound ? words2 : `${S.notSound}: ${words2}`);
        each.findings.classList.toggle("error", !found.sound);
      }
    };
    /** Make a file: its kind is chosen before, or in the dialog. */
    begin = async (kind = "") => {
      const ruleBases = this.files.filter((each) => each.kind === "rule base").map((each) => [each.name, each.name]);
      const kinds = Object.entries(this.starts).map(([name, words2]) => [name, `${S.startTitles[name]}: ${words2}`]);
      const around = {
        name: "around",
        label: S.around,
        options: ruleBases.length ? ruleBases : [["", S.shippedRules]],
        when: { kind: "controller" }
      };
      const made = await fill(
        kind ? S.startTitles[kind] : S.newFile,
        [
          { name: "name", label: S.nameOfFile, value: S.startNames[kind] ?? S.unnamed },
          ...kind ? [] : [{ name: "kind", label: S.template, options: kinds, value: "pd" }],
          ...kind && kind !== "controller" ? [] : [around]
        ],
        S.create,
        (values) => this.ask({ what: "new", kind, ...values }),
        kind ? this.starts[kind] : ""
      );
      if (made?.open) this.hand.turnTo(made.open);
    };
    /** Bring a file of the folder, which another program wrote, into the language. */
    convert = async (name) => {
      this.said.textContent = S.converting(clean(name));
      await this.taken(name, await this.ask({ what: "convert", name }), true);
    };
    duplicate = async (file) => {
      const made = await fill(
        S.duplicateOf(file),
        [{ name: "name", label: S.nameOfFile, value: S.copyOf(file) }],
        S.duplicate,
        (values) => this.ask({ what: "duplicate", file, ...values })
      );
      if (made?.open) this.hand.turnTo(made.open);
    };
    users = async (file) => {
      const found = (await this.hand.folder({ what: "users", file })).users ?? [];
      return found.length ? S.usedBy(found.join(", ")) : "";
    };
    rename = async (file) => {
      await fill(
        S.renameOf(file),
        [{ name: "name", label: S.nameOfFile, value: file }],
        S.renameFile,
        (values) => this.ask({ what: "rename", file, ...values }),
        await this.users(file)
      );
    };
    remove = async (each) => {
      const words2 = [each.changed ? S.unsavedGoes : "", await this.users(each.name), S.deleteForGood].filter(Boolean).join(" ");
      await fill(S.deleteOf(each.name), [], S.deleteFile, () => this.ask({ what: "delete", file: each.name }), words2);
    };
    bring = async (dropped2) => {
      for (const each of dropped2) await this.bringOne(each, dropped2.length === 1);
    };
    bringOne = async (each, alone) => {
      if (/\.py$/i.test(each.name)) return tellAll(each.name, [S.noScripts]);
      if (each.size > this.hand.largest) return tellAll(each.name, [S.tooLarge(each.size, this.hand.largest)]);
      this.said.textContent = S.converting(clean(each.name));
      let data;
      try {
        data = await encoded(each);
      } catch (error) {
        this.said.textContent = this.standing;
        return tellAll(S.notImported(each.name), [S.notRead(error.message)]);
      }
      return this.taken(each.name, await this.ask({ what: "import", name: each.name, data }), alone);
    };
    /** Say what came of a conversion, and open what it has made. */
    taken = async (name, answer, alone) => {
      if (answer.error) return tellAll(S.notImported(name), [answer.error]);
      if (answer.only) return this.instead(name, answer);
      if (answer.findings.length) await tellAll(S.importedAs(name, answer.open), answer.findings);
      if (alone) this.hand.turnTo(answer.open);
      return null;
    };
    /** With one file open nothing is written beside it: what was dropped takes the place of its text. */
    instead = async (name, { text, findings, name: made }) => {
      const same = isTable(made) === isTable(this.hand.file());
      if (!same) return tellAll(S.notImported(name), [S.otherKind(this.hand.file())]);
      const words2 = [S.replaceText(this.hand.file(), name), ...findings];
      if (await choose(words2.join("\n"), [S.replaceIt]) === 0) this.hand.replace(text);
      return null;
    };
    look = () => {
      if (this.store.view === "files") this.ask({ what: "list" });
      else this.round++;
    };
  };
  async function encoded(file) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    const pieces = [];
    for (let i = 0; i < bytes.length; i += 32768) pieces.push(String.fromCharCode(...bytes.subarray(i, i + 32768)));
    return btoa(pieces.join(""));
  }
  function dropped(bring) {
    const shade = el("div", { class: "shade", hidden: true }, el("strong", { textContent: S.dropHere }));
    document.body.append(shade);
    const carries = (event) => event.dataTransfer?.types.includes("Files");
    const take = (name, act) => window.addEventListener(
      name,
      (event) => {
        if (!carries(event)) return;
        event.preventDefault();
        event.stopPropagation();
        act(event);
      },
      true
    );
    take("dragenter", () => {
      shade.hidden = false;
    });
    take("dragover", () => {
      shade.hidden = false;
    });
    take("drop", (event) => {
      shade.hidden = true;
      bring([...event.dataTransfer.files]);
    });
    window.addEventListener("dragleave", (event) => {
      if (!event.relatedTarget) shade.hidden = true;
    });
  }
  var FILES = {
    name: "files",
    title: S.files,
    drawn: false,
    panes: [folderPane, exportPane],
    splits: [{ key: "files-rows", vertical: false, at: 1, usual: 0.6 }]
  };

  // geometry/shapes.js
  var CORNERS = {
    triangle: (p) => [p[0], 0, p[1], 1, p[2], 0],
    trapezoid: (p) => [p[0], 0, p[1], 1, p[2], 1, p[3], 0],
    rectangle: (p) => [p[0], 0, p[0], 1, p[1], 1, p[1], 0],
    ramp: (p) => p[0] <= p[1] ? [p[0], 0, p[1], 1] : [p[1], 1, p[0], 0],
    binary: (p) => p[1] > p[0] ? [p[0], 0, p[0], 1] : [p[0], 1, p[0], 0],
    singleton: (p) => [p[0], 0, p[0], 1, p[0], 0]
  };
  function cornersOf(shape, parameters, height = shape.height) {
    const points = shape.kind === "points" ? parameters : CORNERS[shape.kind]?.(parameters);
    if (!points) return null;
    const found = [];
    for (let i = 0; i < points.length; i += 2) {
      if (Number.isFinite(points[i])) found.push(points[i], points[i + 1] * height);
    }
    return found.length ? found : [0, height];
  }
  var LEVEL = Math.log(9);
  var beside = (centre, width, way = 1, share2 = 1) => ({
    at: (p) => p[centre] + way * share2 * p[width],
    to: (p, x2) => Math.abs(x2 - p[centre]) / share2
  });
  var slope = (inflection, own) => ({
    at: (p) => p[inflection] + LEVEL / p[own],
    to: (p, x2) => LEVEL / (x2 - p[inflection])
  });
  var WIDTHS = {
    gaussian: { 1: beside(0, 1) },
    // where it is exp(-1/2)
    "two-sided-gaussian": { 1: beside(0, 1, -1), 3: beside(2, 3) },
    bell: {
      1: beside(0, 1),
      // where it is one half; its slope where it is 0.9
      2: {
        at: (p) => p[0] + p[1] * (1 / 9) ** (0.5 / p[2]),
        to: (p, x2) => Math.min(50, Math.max(0.1, -0.5 * LEVEL / Math.log(Math.min(0.999, Math.abs(x2 - p[0]) / p[1]))))
      }
    },
    sigmoid: { 1: slope(0, 1) },
    "sigmoid-difference": { 1: slope(0, 1), 3: slope(2, 3) },
    "sigmoid-product": { 1: slope(0, 1), 3: slope(2, 3) },
    cosine: { 1: beside(0, 1, 1, 0.5) },
    // where it is 0
    spike: { 1: beside(0, 1, 1, 0.1) }
    // where it is exp(-1)
  };
  var sidesOf = (term) => term.lower ? [term, term.lower] : [term];
  var shapeKey = (variable, shape) => `${variable.name}
${shape.name}
${shape.side ?? 0}`;
  function piecesOf(corners, low, high) {
    const last = corners.length - 2;
    const ends = [Math.min(low, corners[0]), corners[1], ...corners, Math.max(high, corners[last]), corners[last + 1]];
    const pieces = [];
    for (let i = 0; i + 3 < ends.length; i += 2) {
      const [x0, y0, x1, y1] = ends.slice(i, i + 4);
      const [a, b] = [Math.max(x0, low), Math.min(x1, high)];
      if (!(b > a)) continue;
      const slope2 = (y1 - y0) / (x1 - x0);
      pieces.push(a, a === x0 ? y0 : y0 + slope2 * (a - x0), b, b === x1 ? y1 : y0 + slope2 * (b - x0));
    }
    return pieces;
  }
  var sendable = (x2) => Number.isFinite(x2) ? x2 : x2 > 0 ? "inf" : "-inf";
  function rangeOf(variable) {
    const known = variable.terms.flatMap((term) => term.parameters.map(Number)).filter(Number.isFinite);
    const low = variable.low ?? Math.min(0, ...known) - 1;
    const high = variable.high ?? Math.max(1, ...known) + 1;
    return [low, high];
  }
  function moved(shape, parameters, index, to3, by) {
    const next = [...parameters];
    if (index === null) {
      for (const i of shape.handles) next[i] = parameters[i] + by;
      return next;
    }
    const place = shape.handles.indexOf(index);
    if (shape.ordered || shape.kind === "points") {
      const before = parameters[shape.handles[place - 1]] ?? -Infinity;
      const behind = parameters[shape.handles[place + 1]] ?? Infinity;
      to3 = Math.min(behind, Math.max(before, to3));
    }
    next[index] = to3;
    return next;
  }
  var SYMMETRIC = /* @__PURE__ */ new Set(["triangle", "trapezoid", "rectangle", "pi", "semi-ellipse", "s", "z", "singleton"]);
  var TURNED = { s: "z", z: "s" };
  function mirrorOf(kind, p, sum) {
    const flip = (x2) => Number((sum - x2).toPrecision(12));
    if (SYMMETRIC.has(kind)) return [...p].reverse().map(flip);
    if (kind === "two-sided-gaussian") return [flip(p[2]), p[3], flip(p[0]), p[1]];
    if (kind === "sigmoid") return [flip(p[0]), -p[1]];
    if (kind.startsWith("sigmoid-")) return [flip(p[2]), -p[3], flip(p[0]), -p[1]];
    if (["ramp", "concave", "arc"].includes(kind)) return p.map(flip);
    return WIDTHS[kind] ? [flip(p[0]), ...p.slice(1)] : null;
  }

  // variables.js
  function readEnds(low, high) {
    const ends = [low, high].map((text) => Number(String(text).trim().replace("inf", "Infinity") || NaN));
    return ends.some(Number.isNaN) ? null : ends;
  }
  function readNames(text) {
    return (text.match(/'[^']*'|"[^"]*"|[^\s,]+/g) ?? []).map((name) => name.replace(/^(['"])(.*)\1$/, "$2"));
  }
  var said = (x2) => x2 === null ? "inf" : shortNumber(x2, 12);
  var endsWords = ({ low, high }) => `${low === null ? "-inf" : said(low)} .. ${said(high)}`;
  function addVariable({ fill: fill2, attempt }, role) {
    return fill2(
      S.addRole[role],
      [
        { name: "variable", label: S.nameOfVariable, value: "" },
        { name: "low", label: S.lowEnd, value: role === "input" ? "-1" : "0" },
        { name: "high", label: S.highEnd, value: "1" },
        { name: "terms", label: S.namesOfTerms, value: S.threeTerms }
      ],
      S.add,
      ({ variable, low, high, terms }) => {
        const ends = readEnds(low, high);
        if (!ends) return { error: S.notARange };
        return attempt("variable", {
          role,
          variable: variable.trim(),
          low: sendable(ends[0]),
          high: sendable(ends[1]),
          terms: readNames(terms)
        });
      },
      S.addVariableNote
    );
  }
  function stretch({ fill: fill2, attempt }, variable) {
    const [low, high] = endsWords(variable).split(" .. ");
    return fill2(
      S.rangeOf(variable.name),
      [
        { name: "low", label: S.lowEnd, value: low },
        { name: "high", label: S.highEnd, value: high }
      ],
      S.ok,
      (values) => {
        const ends = readEnds(values.low, values.high);
        return ends ? attempt("range", { variable: variable.name, low: sendable(ends[0]), high: sendable(ends[1]) }) : { error: S.notARange };
      }
    );
  }
  function rename({ fill: fill2, attempt }, variable) {
    return fill2(
      `${S.renameTo} ${variable.name}`,
      [{ name: "name", label: S.nameOfVariable, value: variable.name }],
      S.rename,
      ({ name }) => name.trim() === variable.name ? {} : attempt("variable", { variable: variable.name, name: name.trim() })
    );
  }
  function remove({ fill: fill2, attempt }, variable) {
    return fill2(
      S.removeVariable(variable.name),
      [],
      S.remove,
      () => attempt("variable", { variable: variable.name }),
      S.removeVariableNote
    );
  }
  function newShape(variable, peak) {
    const [low, high] = rangeOf(variable);
    const half = (high - low) / (variable.terms.length + 1);
    const discrete = variable.terms.length && variable.terms.every((term) => term.kind === "singleton");
    const numbers = discrete ? [peak] : [peak - half, peak, peak + half];
    return { kind: discrete ? "singleton" : "triangle", parameters: numbers.map((x2) => Number(x2.toPrecision(6))) };
  }
  function addTerm({ fill: fill2, attempt }, variable, peak) {
    return fill2(
      S.nameOfTerm(variable.name),
      [
        { name: "term", label: S.nameOfFile, value: "" },
        { name: "peak", label: S.peak, value: shortNumber(peak, 6) }
      ],
      S.add,
      ({ term, peak: at2 }) => {
        const number = Number(at2.trim() || NaN);
        if (!Number.isFinite(number)) return { error: S.notANumber };
        return attempt("term", { variable: variable.name, term: term.trim(), shape: newShape(variable, number) });
      }
    );
  }
  function variableHead(hand, peakOf) {
    let variable = null;
    const name = el("strong");
    const words2 = el("span");
    const button = (text, label, act) => el("button", { textContent: text, title: label, onclick: () => act(hand, variable, peakOf(variable)) });
    const tools = !hand.attempt ? [] : [
      button(S.addTerm, S.addTermHint, addTerm),
      button(S.range, S.rangeHint, stretch),
      button(S.renameDots, S.renameVariable, rename),
      button("\xD7", S.removeVariableHint, remove)
    ];
    const element = el("div", { class: "head" }, name, words2, el("span", { class: "space" }), ...tools);
    return {
      element,
      show(now, role) {
        variable = now;
        name.textContent = now.name;
        words2.textContent = `${role} ${endsWords(now)}`;
        words2.title = now.description;
        for (const tool of tools) {
          const label = `${now.name}: ${tool.title}`;
          tool.setAttribute("aria-label", label.includes(tool.textContent) ? label : `${label}: ${tool.textContent}`);
        }
      }
    };
  }

  // terms.js
  var [LEFT, RIGHT, TOP, BOTTOM] = [14, 14, 18, 15];
  var HEAD = 20;
  var DETAILS = 52;
  var [LEAST, MOST] = [60, 240];
  var SMOOTH2 = 161;
  var LEAST_HEIGHT = 0.05;
  var DIAMOND = 5.5;
  var plotHeight = (room, count) => Math.round(Math.min(MOST, Math.max(LEAST, (room - DETAILS) / Math.max(1, count) - HEAD)));
  function termsPane(store2, hand) {
    return new TermsPane(store2, hand).section;
  }
  var TermsPane = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand) {
      this.store = store2;
      this.hand = hand;
      this.edit = this.hand.edit;
      this.numbers = this.hand.numbers;
      this.change = this.hand.change;
      this.askFor = this.hand.askFor;
      const { section, bar: bar2, body: all } = pane("terms", S.terms);
      this.section = section;
      this.bar = bar2;
      this.all = all;
      this.body = el("div", { class: "plots" });
      this.details = el("div", { class: "details", hidden: true });
      this.all.append(this.body, this.details);
      if (this.hand.attempt) this.bar.append(this.adding(S.addInput, "input"), this.adding(S.addOutput, "output"));
      const toDiagram = el("button", {
        textContent: S.diagram,
        hidden: true,
        onclick: () => this.store.turnDiagram(true)
      });
      this.bar.append(toDiagram, el("span", { class: "space" }));
      this.partition = this.option(S.partition, S.partitionHint, false);
      this.mirror = this.option(S.mirror, S.mirrorHint, false);
      this.snap = this.option(S.snap, S.snapHint, true);
      this.plots = /* @__PURE__ */ new Map();
      this.heads = /* @__PURE__ */ new Map();
      this.tall = LEAST;
      this.chosen = "";
      this.fields = null;
      this.rebuilding = false;
      this.drag = null;
      this.moving = "";
      this.waiting = 0;
      this.wide = 0;
      this.partly = "";
      this.redraw = eachFrame(this.draw);
      this.store.on("scene", this.build);
      this.store.on("diagram", () => {
        toDiagram.hidden = !this.store.diagram;
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
        this.wide = this.body.clientWidth;
        this.tall = plotHeight(this.all.clientHeight, this.plots.size);
        this.redraw();
      });
      watch.observe(this.body);
      watch.observe(this.all);
    }
    option = (text, title2, checked) => {
      const box = el("input", { type: "checkbox", checked });
      this.bar.append(el("label", { class: "small", title: title2 }, box, text));
      return box;
    };
    adding = (words2, role) => el("button", { textContent: words2, title: S.addRole[role], onclick: () => addVariable(this.hand, role) });
    each = () => [...this.store.scene.inputs, ...this.store.scene.outputs];
    termKey = (variable, term) => `${variable.name}
${term.name}`;
    roleOf = (v) => v < this.store.scene.inputs.length ? S.inputs : S.outputs;
    path = (points, at2) => points.map(([x2, y], i) => `${i ? "L" : "M"}${at2.x(x2).toFixed(1)} ${at2.y(y).toFixed(1)}`).join("");
    peak = (shape, parameters) => {
      if (shape.kind === "triangle") return parameters[1];
      if (shape.kind === "trapezoid") return 0.5 * (parameters[1] + parameters[2]);
      return shape.handles.length === 1 ? parameters[shape.handles[0]] : null;
    };
    /** Whether the term has a place that another kind can take: a shape, or a number of an output. */
    canChange = (term) => this.store.scene.kinds && !["formula", "linear"].includes(term.kind);
    handleAt = (shape, parameters, index) => shape.handles.includes(index) ? parameters[index] : WIDTHS[shape.kind][index].at(parameters);
    plain = ({ parameters, height }) => ({ parameters, height });
    found = () => {
      for (const variable of this.each()) {
        for (const term of variable.terms) if (this.termKey(variable, term) === this.chosen) return { variable, term };
      }
      return null;
    };
    build = () => {
      const names = this.each().map((variable) => variable.name);
      if (this.body.firstChild && JSON.stringify(names) === JSON.stringify([...this.plots.keys()])) {
        if (this.store.busy) this.grip(this.each().find((variable) => variable.name === this.moving));
      } else {
        this.body.replaceChildren(...names.length ? [] : [el("p", { class: "note", textContent: S.noVariables })]);
        this.plots.clear();
        this.heads.clear();
        for (const variable of this.each()) {
          const plot = svg("svg", { role: "group", "aria-label": variable.name });
          const head = variableHead(this.hand, this.peakOfNew);
          this.plots.set(variable.name, plot);
          this.heads.set(variable.name, head);
          this.body.append(head.element, plot);
        }
      }
      this.tall = plotHeight(this.all.clientHeight, names.length);
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
      const x2 = (value) => LEFT + (value - low) / (high - low) * (width - LEFT - RIGHT);
      const back = (pixel) => low + (pixel - LEFT) / (width - LEFT - RIGHT) * (high - low);
      const y = (degree2) => this.tall - BOTTOM - degree2 * (this.tall - TOP - BOTTOM);
      const degree = (pixel) => (this.tall - BOTTOM - pixel) / (this.tall - TOP - BOTTOM);
      return { width, low, high, x: x2, y, back, degree };
    };
    // --- pictures ---
    draw = () => {
      if (!this.store.scene) return;
      const focused = (
        /** @type {SVGElement} */
        document.activeElement?.dataset?.handle
      );
      const only = this.partly;
      this.partly = "";
      this.each().forEach((variable, v) => {
        if (!only || variable.name === only) this.drawOne(variable, v);
      });
      if (focused) {
        const same = [...this.body.querySelectorAll("[data-handle]")].find((e) => e.dataset.handle === focused);
        same?.focus({ preventScroll: true });
      }
      this.fill();
    };
    drawOne = (variable, v) => {
      const plot = this.plots.get(variable.name);
      const at2 = this.scale(variable);
      const parts = [];
      parts.push(svg("line", { class: "axis", x1: LEFT, x2: at2.width - RIGHT, y1: at2.y(0), y2: at2.y(0) }));
      for (const tick of ticks(at2.low, at2.high, at2.width / 80)) {
        parts.push(svg("text", { x: at2.x(tick), y: this.tall - 4, "text-anchor": "middle" }, shortNumber(tick)));
      }
      if (v < this.store.scene.inputs.length) {
        const x2 = at2.x(this.store.point[v]);
        parts.push(svg("line", { class: "at", x1: x2, x2, y1: TOP, y2: at2.y(0) }));
      }
      const handles = [];
      variable.terms.forEach((term, t) => {
        if (!term.curve) return;
        const isChosen = this.termKey(variable, term) === this.chosen;
        const own = isChosen ? "chosen" : "";
        const style = `stroke: ${hue(t)}`;
        const lines = sidesOf(term).map((shape) => this.curve(variable, shape, at2));
        if (lines.length > 1) {
          const d = `${this.path(lines[0], at2)}${this.path([...lines[1]].reverse(), at2).replace("M", "L")}Z`;
          parts.push(svg("path", { d, class: "footprint", style: `fill: ${hue(t)}` }));
        }
        lines.forEach((points, side) => {
          parts.push(svg("path", { d: this.path(points, at2), style, class: side ? `${own} lower` : own }));
        });
        handles.push(...this.handlesOf(variable, term, t, at2, isChosen));
      });
      plot.setAttribute("width", at2.width);
      plot.setAttribute("height", this.tall);
      plot.replaceChildren(...parts, ...handles);
    };
    curve = (variable, shape, at2) => {
      const now = this.store.now(variable, shape);
      const corners = shape.straight ? cornersOf(shape, now.parameters, now.height) : null;
      if (!corners) {
        const xs2 = Float64Array.from({ length: SMOOTH2 }, (_2, i) => at2.low + (at2.high - at2.low) * i / (SMOOTH2 - 1));
        const ys2 = this.store.degrees(variable, shape, xs2, now);
        return Array.from(xs2, (x2, i) => [x2, ys2[i]]);
      }
      const last = corners.length - 2;
      const points = [[Math.min(at2.low, corners[0]), corners[1]]];
      for (let i = 0; i <= last; i += 2) points.push([corners[i], corners[i + 1]]);
      points.push([Math.max(at2.high, corners[last]), corners[last + 1]]);
      return points;
    };
    handlesOf = (variable, term, t, at2, isChosen) => {
      const made = [];
      const top = this.peak(term, this.store.now(variable, term).parameters) ?? term.centre;
      if (top !== null) {
        const x2 = at2.x(Math.min(at2.high, Math.max(at2.low, top)));
        const half = 3.6 * term.name.length;
        const anchor = x2 < half ? "start" : x2 > at2.width - half ? "end" : "middle";
        made.push(
          svg(
            "text",
            {
              x: anchor === "start" ? 3 : anchor === "end" ? at2.width - 3 : x2,
              y: TOP - 6,
              "text-anchor": anchor,
              class: "term",
              style: `fill: ${hue(t)}`,
              ...this.target(variable, term, term, null, S.wholeTerm(variable.name, term.name), top, at2)
            },
            term.name
          )
        );
      }
      for (const shape of sidesOf(term)) {
        const now = this.store.now(variable, shape);
        const style = `stroke: ${hue(t)}`;
        shape.handles.forEach((index, place) => {
          const value = now.parameters[index];
          if (!isChosen && (shape.side || value !== top)) return;
          if (value < at2.low || value > at2.high) return;
          const label = (shape.side ? S.lowerCorner : S.corner)(variable.name, term.name, place + 1);
          const own = this.target(variable, term, shape, index, label, value, at2);
          const [cx, cy] = [at2.x(value), at2.y(this.heightAt(variable, shape, now, index, value))];
          made.push(svg("circle", { cx, cy, r: isChosen && !shape.side ? 5.5 : 4, style, ...own }));
        });
        if (!isChosen) continue;
        for (const [index, width] of Object.entries(WIDTHS[shape.kind] ?? {})) {
          const value = width.at(now.parameters);
          if (!(value >= at2.low && value <= at2.high)) continue;
          const said2 = S.width(variable.name, term.name, shape.names[index], Boolean(shape.side));
          const own = this.target(variable, term, shape, Number(index), said2, value, at2, now.parameters[index]);
          const [x2, y] = [at2.x(value), at2.y(this.store.degrees(variable, shape, Float64Array.of(value), now)[0])];
          const d = `M${x2 - DIAMOND} ${y}L${x2} ${y - DIAMOND}L${x2 + DIAMOND} ${y}L${x2} ${y + DIAMOND}Z`;
          made.push(svg("path", { d, class: "width", style, ...own }));
        }
      }
      return made;
    };
    target = (variable, term, shape, index, label, value, at2, said2 = value) => {
      return {
        tabindex: 0,
        role: "slider",
        "aria-label": label,
        "aria-valuenow": Math.min(at2.high, Math.max(at2.low, value)),
        "aria-valuemin": at2.low,
        "aria-valuemax": at2.high,
        "aria-valuetext": shortNumber(said2, 6),
        "data-handle": `${shapeKey(variable, shape)}
${index}`,
        "data-side": shape.side ?? 0,
        "data-variable": variable.name,
        "data-term": term.name,
        "data-index": index ?? "whole",
        onpointerdown: (event) => this.take(event, variable, term, shape, index),
        onkeydown: (event) => this.step(event, variable, term, shape, index),
        onfocus: () => this.choose(variable, term)
      };
    };
    choose = (variable, term) => {
      const key2 = this.termKey(variable, term);
      if (key2 !== this.chosen) {
        this.chosen = key2;
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
          el("span", { class: "space" }),
          button(S.rename, () => this.rename(variable, term)),
          button(S.remove, () => this.change("term", { variable: variable.name, term: term.name }))
        );
      }
      const onKind = document.activeElement?.closest(".details .kind");
      const typed = document.activeElement?.closest(".details input");
      this.rebuilding = true;
      this.details.replaceChildren(...parts);
      this.rebuilding = false;
      this.fill();
      if (onKind) this.details.querySelector(".kind")?.focus();
      if (typed) this.goOnTyping(typed);
    };
    /** A number that is being typed while the terms are drawn anew stays, with its cursor. */
    goOnTyping = (typed) => {
      const label = typed.getAttribute("aria-label");
      const field = this.fields.find((each) => each.field.getAttribute("aria-label") === label)?.field;
      if (!field) return;
      field.value = typed.value;
      field.focus();
      field.setSelectionRange(typed.selectionStart, typed.selectionEnd);
    };
    /** Choose the kind of the shape; the text keeps place and width as far as the kinds allow. */
    kindOf = (variable, term) => {
      const kinds = this.store.scene.kinds.includes(term.kind) ? this.store.scene.kinds : [term.kind, ...this.store.scene.kinds];
      const select = el(
        "select",
        {
          class: "kind",
          title: S.kindHint,
          "aria-label": S.kindOf(variable.name, term.name),
          onchange: async () => {
            const taken = await this.change("term", { variable: variable.name, term: term.name, kind: select.value });
            if (!taken) select.value = term.kind;
          }
        },
        ...kinds.map((kind) => el("option", { value: kind, textContent: kind }))
      );
      select.value = term.kind;
      return select;
    };
    fieldsOf = (variable, term, shape) => {
      const side = shape.side ? `${S.overShape} ` : "";
      const count = shape.kind === "points" ? shape.parameters.length : shape.names.length;
      const name = (i) => shape.names[i] ?? `${i % 2 ? "y" : "x"}${Math.floor(i / 2) + 1}`;
      const made = Array.from({ length: count + 1 }, (_2, i) => {
        const label = i < count ? name(i) : S.height;
        const field = el("input", {
          type: "text",
          inputMode: "decimal",
          title: label,
          readOnly: !this.edit,
          "aria-label": `${variable.name} ${term.name}, ${side}${label}`,
          onblur: () => commit(),
          onkeydown: (event) => event.key === "Enter" && commit()
        });
        const commit = () => {
          if (!this.rebuilding && field.value !== field.dataset.shown)
            this.put(variable, term, shape, i < count ? i : null, field);
        };
        this.fields.push({ field, variable, shape, index: i < count ? i : null });
        return field;
      });
      return made;
    };
    /** Show the numbers of the chosen term as they are now. */
    fill = () => {
      for (const { field, variable, shape, index } of this.fields ?? []) {
        const now = this.store.now(variable, shape);
        const value = index === null ? now.height : now.parameters[index];
        const said2 = Number.isFinite(value) ? shortNumber(value, 8) : value > 0 ? "inf" : "-inf";
        if (document.activeElement !== field || field.value === field.dataset.shown) field.value = said2;
        field.dataset.shown = said2;
      }
    };
    put = (variable, term, shape, index, field) => {
      const text = field.value.trim().replace(/^([+-]?)inf$/, "$1Infinity");
      const value = text === "" ? NaN : Number(text);
      if (Number.isNaN(value) || index === null && !(value > 0 && value <= 1)) {
        field.setAttribute("aria-invalid", "true");
        return;
      }
      field.removeAttribute("aria-invalid");
      this.begin(variable);
      const now = this.store.now(variable, shape);
      const parameters = index === null ? now.parameters : now.parameters.with(index, value);
      this.store.reshape(variable, shape, parameters, index === null ? value : now.height);
      this.drag = null;
      this.finish(variable.name);
    };
    rename = async (variable, term) => {
      const name = await this.askFor(`${S.renameTo} ${term.name}`, term.name, S.rename);
      if (!name || name === term.name) return;
      const taken = await this.change("term", { variable: variable.name, term: term.name, name });
      if (taken) this.chosen = `${variable.name}
${name}`;
    };
    // --- moving ---
    /** Remember every shape of a variable as it is, to move from there. */
    begin = (variable) => {
      this.drag = { variable, from: /* @__PURE__ */ new Map() };
      for (const shape of variable.terms.flatMap(sidesOf)) this.drag.from.set(shape, this.store.now(variable, shape));
    };
    take = (event, variable, term, shape, index) => {
      if (!this.edit) return;
      event.preventDefault();
      event.currentTarget.focus({ preventScroll: true });
      const at2 = this.scale(variable);
      const plot = this.plots.get(variable.name);
      const place = (each) => {
        const box = plot.getBoundingClientRect();
        return { x: at2.back(each.clientX - box.left), degree: at2.degree(each.clientY - box.top) };
      };
      this.begin(variable);
      const start2 = place(event);
      const old = this.drag.from.get(shape);
      const where = index === null ? 0 : this.handleAt(shape, old.parameters, index);
      plot.setPointerCapture(event.pointerId);
      this.grip(variable);
      plot.onpointermove = (each) => {
        const here = place(each);
        const rise = this.isRaised(shape, index) ? here.degree - start2.degree : 0;
        this.shift(variable, term, shape, index, where + here.x - start2.x, rise, each);
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
      const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!sign || !this.edit) return;
      event.preventDefault();
      this.grip(variable);
      this.begin(variable);
      const steps = sign * (event.ctrlKey ? 10 : 1);
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
      const changed = /* @__PURE__ */ new Map();
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
      const tidy = (x2, step) => this.snap.checked ? Number((Math.round(x2 / step) * step).toPrecision(12)) : Number(x2.toPrecision(6));
      if (!shape.handles.includes(index)) {
        const width = WIDTHS[shape.kind][index].to(old.parameters, this.rounded(value, variable));
        const sound = Number.isFinite(width) && Math.abs(width) > 1e-9;
        const said2 = Number(width.toPrecision(this.snap.checked ? 3 : 6));
        return { ...this.plain(old), parameters: sound ? old.parameters.with(index, said2) : old.parameters };
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
        const to3 = from.parameters.map((x2, i) => {
          const shared = other.handles.includes(i) ? shape.handles.findIndex((k) => old[k] === x2) : -1;
          return shared < 0 ? x2 : next[shape.handles[shared]];
        });
        const sorted = other.handles.every((i, k) => !k || to3[other.handles[k - 1]] <= to3[i]);
        if (sorted && to3.some((x2, i) => x2 !== from.parameters[i]))
          changed.set(other, { ...this.plain(from), parameters: to3 });
      }
    };
    mirrored = (variable, changed) => {
      const [low, high] = rangeOf(variable);
      for (const [shape, next] of [...changed]) {
        const place = variable.terms.findIndex((term2) => sidesOf(term2).includes(shape));
        const term = variable.terms[variable.terms.length - 1 - place];
        const other = sidesOf(term)[shape.side ?? 0];
        if (!other || other === shape || other.kind !== (TURNED[shape.kind] ?? shape.kind)) continue;
        const parameters = mirrorOf(shape.kind, next.parameters, low + high);
        if (parameters) changed.set(other, { parameters, height: next.height });
      }
    };
    /** Stop where the lower function of a term would rise above the upper one. */
    keepBelow = (variable, term, changed) => {
      if (!term.lower || !term.curve) return;
      const sides = sidesOf(term);
      if (!sides.some((side) => changed.has(side))) return;
      const from = sides.map((side) => this.drag.from.get(side));
      const to3 = sides.map((side, i) => changed.get(side) ?? from[i]);
      if (this.isBelow(variable, sides, to3)) return;
      const between = (share2) => from.map((start2, i) => ({
        parameters: start2.parameters.map((x2, k) => Number.isFinite(x2) ? x2 + share2 * (to3[i].parameters[k] - x2) : x2),
        height: start2.height + share2 * (to3[i].height - start2.height)
      }));
      let [reach, beyond] = [0, 1];
      for (let i = 0; i < 12; i++) {
        const middle = 0.5 * (reach + beyond);
        if (this.isBelow(variable, sides, between(middle))) reach = middle;
        else beyond = middle;
      }
      const kept3 = between(reach);
      const short = kept3.map(({ parameters, height }) => ({
        parameters: parameters.map((x2) => Number(x2.toPrecision(4))),
        height: Number(height.toPrecision(3))
      }));
      const best = this.isBelow(variable, sides, short) ? short : kept3;
      sides.forEach((side, i) => {
        if (changed.has(side)) changed.set(side, best[i]);
      });
    };
    isBelow = (variable, sides, numbers) => {
      const [[upper, lower], [high, low]] = [sides, numbers];
      const [start2, end] = rangeOf(variable);
      const corners = [cornersOf(upper, high.parameters), cornersOf(lower, low.parameters)];
      const bends = corners.flatMap((found) => (found ?? []).filter((_2, i) => i % 2 === 0));
      const even = Array.from({ length: SMOOTH2 }, (_2, i) => start2 + (end - start2) * i / (SMOOTH2 - 1));
      const xs2 = Float64Array.from([...even, ...bends.filter((x2) => x2 >= start2 && x2 <= end)]);
      const above = this.store.degrees(variable, upper, xs2, high);
      return this.store.degrees(variable, lower, xs2, low).every((y, i) => y <= above[i] + 1e-12);
    };
    finish = (name) => {
      const variable = this.each().find((other) => other.name === name);
      this.store.busy = false;
      const isSame = (shape) => {
        const now = this.store.now(variable, shape);
        return now.height === shape.height && now.parameters.every((x2, i) => x2 === shape.parameters[i]);
      };
      const said2 = (shape) => {
        const { parameters, height } = this.store.now(variable, shape);
        return { kind: shape.kind, parameters: parameters.map(sendable), height };
      };
      const shapes = variable.terms.flatMap(
        (term) => sidesOf(term).every(isSame) ? [] : [{ variable: variable.name, term: term.name, ...said2(term), lower: term.lower ? said2(term.lower) : null }]
      );
      if (!shapes.length) return;
      Promise.resolve(this.edit(shapes)).then((taken) => {
        if (taken === false) this.store.forget();
      });
    };
  };

  // help.js
  function showHelp(views) {
    if (document.querySelector("dialog[open]")) return;
    const close = el("button", { value: "", textContent: S.close, type: "submit" });
    const keys = (rows) => el(
      "table",
      { class: "keys" },
      el(
        "tbody",
        {},
        ...rows.map(
          ([key2, words2]) => el(
            "tr",
            {},
            el(
              "th",
              { scope: "row" },
              ...key2.split(" ").flatMap((each, i) => [
                ...i ? [" "] : [],
                /^[a-z]+$/.test(each) ? each : el("kbd", { textContent: each })
              ])
            ),
            el("td", { textContent: words2 })
          )
        )
      )
    );
    const parts = S.help.filter(({ view }) => !view || views.includes(view)).map(
      ({ title: title2, words: words2, rows }) => el(
        "section",
        {},
        el("h3", { textContent: title2 }),
        ...words2.map((line) => el("p", { textContent: line })),
        ...rows.length ? [keys(rows)] : []
      )
    );
    const body = el("div", { class: "parts", tabIndex: 0, role: "group", "aria-label": S.helpTitle }, ...parts);
    const dialog = el(
      "dialog",
      { class: "help", "aria-label": S.helpTitle },
      el(
        "form",
        { method: "dialog" },
        el("div", { class: "row" }, el("strong", { textContent: S.helpTitle }), el("span", { class: "space" }), close),
        body
      )
    );
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
    body.focus();
  }
  var isTyped = (target) => Boolean(target.closest?.(".cm-editor, textarea, select, input:not([type='range'], [type='checkbox'])"));
  function helpButton(views, gone) {
    const button = el("button", {
      class: "help",
      textContent: "?",
      title: S.helpHint,
      "aria-label": S.helpTitle,
      onclick: () => showHelp(views)
    });
    window.addEventListener(
      "keydown",
      (event) => {
        if (!button.isConnected || event.ctrlKey || event.metaKey || event.altKey) return;
        if (event.key !== "F1" && (event.key !== "?" || isTyped(event.target))) return;
        event.preventDefault();
        showHelp(views);
      },
      { signal: gone }
    );
    return button;
  }

  // gridtools.js
  var pairs = (names) => names.map((name) => [name, name]);
  var named = (variables) => variables.filter((each) => each.terms.length).map((each) => each.name);
  var canConclude = ({ inputs, outputs }) => named(inputs).length > 0 && named(outputs).length > 0;
  function addGrid({ fill: fill2, attempt }, { inputs, outputs }) {
    const across = named(inputs);
    return fill2(
      S.newGrid,
      [
        { name: "output", label: S.concludes, options: pairs(named(outputs)) },
        {
          name: "row",
          label: S.vertical,
          options: [["", S.oneRow], ...pairs(across)],
          value: across.length > 1 ? across[0] : ""
        },
        { name: "column", label: S.horizontal, options: pairs(across), value: across[1] ?? across[0] },
        { name: "fill", label: S.cells, options: S.fills }
      ],
      S.add,
      (values) => attempt("grid", values)
    );
  }
  function headDialog({ choose: choose2, attempt, change, fill: fill2 }, scene, head) {
    const words2 = head.row ? [S.removeRow(head.term), S.addRow] : [S.removeColumn(head.term), S.addColumn];
    return choose2(head.row ? S.rowOf(head.variable, head.term) : S.columnOf(head.variable, head.term), words2).then(
      (chosen) => {
        if (chosen === 0) return change("head", { ...head, remove: true });
        return chosen === 1 ? addHead({ attempt, fill: fill2 }, scene, head) : null;
      }
    );
  }
  function addHead({ fill: fill2, attempt }, { inputs }, { line, row, variable: name, present }) {
    const variable = inputs.find((each) => each.name === name);
    const [low, high] = rangeOf(variable);
    const absent = variable.terms.map((each) => each.name).filter((each) => !present.includes(each));
    const isNew = absent.length ? { when: { chosen: "" } } : {};
    return fill2(
      row ? S.addRowOf(name) : S.addColumnOf(name),
      [
        ...absent.length ? [{ name: "chosen", label: S.term, options: [...pairs(absent), ["", S.newTerm]] }] : [],
        { name: "name", label: S.newTermName, value: "", ...isNew },
        { name: "peak", label: S.peak, value: shortNumber(0.5 * (low + high)), ...isNew }
      ],
      S.add,
      ({ chosen = "", name: given, peak }) => {
        if (chosen) return attempt("head", { line, row, term: chosen });
        const at2 = Number((peak ?? "").trim() || NaN);
        if (!Number.isFinite(at2)) return { error: S.notANumber };
        return attempt("head", { line, row, term: given.trim(), shape: newShape(variable, at2) });
      }
    );
  }
  function composer(attempt, { inputs, outputs }) {
    const choices = (variable, none) => el(
      "select",
      { "aria-label": variable.name, "data-variable": variable.name },
      ...none ? [el("option", { value: "", textContent: "\u2026" })] : [],
      ...variable.terms.map(({ name }) => el("option", { value: name, textContent: name }))
    );
    const asked = inputs.filter((each) => each.terms.length).map((each) => choices(each, true));
    const concluded = outputs.filter((each) => each.terms.length).map((each) => choices(each, outputs.length > 1));
    const join = el(
      "select",
      { "aria-label": S.join },
      ...["and", "or"].map((word) => el("option", { value: word, textContent: word }))
    );
    const wrong = el("span", { class: "wrong", role: "alert" });
    const part = (select) => el("label", {}, `${select.dataset.variable} is`, select);
    const values = (selects) => selects.filter((each) => each.value).map((each) => [each.dataset.variable, each.value]);
    const between = asked.flatMap(
      (each, i) => i === 0 ? [part(each)] : i === 1 ? [join, part(each)] : [el("span", { class: "again", textContent: join.value }), part(each)]
    );
    const form = el(
      "form",
      {
        class: "composer",
        "aria-label": S.compose,
        onsubmit: async (event) => {
          event.preventDefault();
          const answer = await attempt("compose", { if: values(asked), then: values(concluded), join: join.value });
          wrong.textContent = answer.error ?? "";
          if (!answer.error) for (const each of asked) each.value = "";
        }
      },
      el("span", { textContent: S.ifWord }),
      ...between,
      el("span", { textContent: S.thenWord }),
      ...concluded.map(part),
      el("button", { class: "small", type: "submit", textContent: S.add }),
      wrong
    );
    join.addEventListener("change", () => {
      for (const each of form.querySelectorAll(".again")) each.textContent = join.value;
    });
    return form;
  }

  // methods.js
  function methodLines(change) {
    const summary = el("summary");
    const body = el("div", { class: "fields" });
    const element = el("details", { class: "methods" }, summary, body);
    function list(row) {
      const label = row.target ? `${row.target}: ${row.key}` : row.key;
      const select = el(
        "select",
        {
          "aria-label": label,
          "data-key": `method ${label}`,
          disabled: !change,
          onchange: async () => {
            const taken = await change("setting", { key: row.key, value: select.value, target: row.target });
            if (!taken) select.value = row.value;
          }
        },
        ...row.options.map((value) => el("option", { value, textContent: value, selected: value === row.value }))
      );
      return el("label", { class: "field" }, el("span", { textContent: label }), select);
    }
    return {
      element,
      show(rows) {
        const lists = rows.filter((row) => row.key);
        const refocus = keepFocus(body);
        summary.textContent = clean(
          `${S.methods}: ${lists.map(({ key: key2, value, target }) => `${target ? `${target} ` : ""}${key2} ${value}`).join(", ")}`
        );
        body.replaceChildren(
          ...lists.map(list),
          ...rows.filter((row) => row.block).map(({ block }) => el("span", { class: "small", textContent: block }))
        );
        refocus();
      }
    };
  }

  // rules.js
  var MOST_CELLS = 700;
  var MOST_SENTENCES = 400;
  function rulesPane(store2, hand) {
    return new RulesPane(store2, hand).section;
  }
  var RulesPane = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand) {
      this.store = store2;
      this.hand = hand;
      this.setCell = this.hand.setCell;
      this.goTo = this.hand.goTo;
      this.change = this.hand.change;
      this.attempt = this.hand.attempt;
      const { section, bar: bar2, body } = pane("rules", S.rules);
      this.section = section;
      this.body = body;
      this.methods = methodLines(this.change);
      this.grid = el("button", {
        textContent: S.gridDots,
        title: S.gridHint,
        onclick: () => addGrid(this.hand, this.store.scene)
      });
      if (this.attempt) bar2.append(el("span", { class: "space" }), this.grid);
      this.lit = [];
      this.shown = [];
      this.fresh = { rule: null, text: "" };
      this.drafts = /* @__PURE__ */ new Set();
      this.composed = { names: "", form: null };
      const relight = eachFrame(this.light);
      this.store.on("scene", this.build);
      this.store.on("point", relight);
      this.store.on("told", relight);
      this.store.on("reshaped", relight);
    }
    // --- findings ---
    before = (one, other) => one[0] < other[0] || one[0] === other[0] && one[1] < other[1];
    words = (finding) => `${S.severity[finding.severity] ?? finding.severity}: ${finding.message}`;
    /** A sign with the findings as its name. */
    sign = (found) => el("span", {
      class: `sign ${found[0].severity}`,
      role: "img",
      textContent: "\u25B2",
      title: found.map(this.words).join("\n"),
      "aria-label": found.map(this.words).join("; ")
    });
    present = (grid, row) => row ? grid.rows.map((each) => each.label) : grid.columns;
    said = (cell) => cell.term === null ? "\xB7" : cell.weight ? `${cell.term} \xD7${cell.weight}` : cell.term;
    build = () => {
      const { grids, rules, outputs } = this.store.scene;
      const isReady = canConclude(this.store.scene);
      this.grid.disabled = !isReady;
      this.methods.show(this.store.scene.methods);
      const refocus = keepFocus(this.section);
      this.findAgain(rules);
      this.lit = [];
      this.shown = [];
      const seen = this.body.scrollTop;
      this.body.replaceChildren(...outputs.length ? [this.methods.element] : []);
      const cells2 = grids.reduce((sum, grid) => sum + grid.rows.length * grid.columns.length, 0);
      grids.forEach((grid, k) => this.body.append(this.table(grid, outputs, this.setCell && cells2 <= MOST_CELLS, k)));
      const sentences = rules.map((rule, number) => (
        /** @type {const} */
        [rule, number]
      )).filter(([rule]) => !rule.inGrid);
      if (sentences.length) {
        const list = el("ol");
        for (const [rule, number] of sentences.slice(0, MOST_SENTENCES)) list.append(this.item(rule, number));
        this.body.append(list);
      }
      if (!rules.length)
        this.body.append(
          el("p", {
            class: "note",
            textContent: grids.length || !this.store.scene.missing.includes("no-rules") ? S.tooManyRules : S.noRulesYet
          })
        );
      if (this.attempt && isReady) this.body.append(this.composing());
      if (this.change && isReady) this.body.append(this.writer(this.fresh, S.newRule));
      this.body.scrollTop = seen;
      refocus();
      this.light();
    };
    /**
     * Find the rules again that are being changed, in a text that may have other lines now: one that says what it
     * said, the nearest; else the one in its place, where there are as many. What has no rule any more may be a new one.
     */
    findAgain = (rules) => {
      for (const draft of this.drafts) {
        const same = rules.flatMap((rule2, number) => rule2.written === draft.written ? [number] : []);
        same.sort((a, b) => Math.abs(a - draft.rule) - Math.abs(b - draft.rule));
        const inPlace = rules.length === draft.of && rules[draft.rule]?.written ? draft.rule : null;
        const rule = same[0] ?? inPlace;
        if (rule === null) {
          this.fresh.text ||= draft.text;
          this.drafts.delete(draft);
        } else Object.assign(draft, { rule, of: rules.length });
      }
    };
    /** The lists of a new rule: what has been chosen stays while the variables do. */
    composing = () => {
      const { inputs, outputs } = this.store.scene;
      const names = JSON.stringify(
        [inputs, outputs].map((each) => each.map(({ name, terms }) => [name, terms.map((term) => term.name)]))
      );
      if (names !== this.composed.names) this.composed = { names, form: composer(this.attempt, this.store.scene) };
      return this.composed.form;
    };
    /** Findings that lie within a stretch of the text, or cover it in its own line. */
    findingsOf = ([start2, end]) => {
      return this.store.findings.filter(
        ({ range: [from, to3] }) => from[0] === start2[0] && !this.before(to3, start2) && (from[0] !== end[0] || this.before(from, end))
      );
    };
    /** Mark an element with its findings, for the eye, the pointer and the screen reader. */
    mark = (element, named2, found) => {
      if (!found.length) return;
      const said2 = found.map(this.words).join("; ");
      element.classList.add("found", found[0].severity);
      named2.title = said2;
      named2.setAttribute("aria-label", `${named2.getAttribute("aria-label") ?? named2.textContent}. ${said2}`);
    };
    // --- sentences ---
    item = (rule, number) => {
      const said2 = this.goTo ? el("button", { class: "said", textContent: rule.text, onclick: () => this.goTo(rule.at) }) : rule.text;
      const li3 = el("li", {}, el("span", { class: "place", textContent: rule.place }), said2);
      const found = this.findingsOf(rule.range);
      if (found.length) {
        li3.classList.add("found", found[0].severity);
        li3.append(this.sign(found));
      }
      const draft = [...this.drafts].find((each) => each.rule === number);
      if (draft) li3.replaceChildren(this.writer(draft, S.ruleAt(rule.place)));
      else if (this.change && rule.written) {
        const edit = () => {
          const line = { rule: number, of: this.store.scene.rules.length, written: rule.written, text: rule.written };
          this.drafts.add(line);
          this.build();
          this.body.querySelector(`[data-key="write ${number}"]`).focus();
        };
        li3.append(
          el("button", {
            class: "small",
            textContent: S.change,
            "aria-label": `${S.change} ${S.ruleAt(rule.place)}`,
            "data-key": `edit ${number}`,
            onclick: edit
          }),
          el("button", {
            class: "small",
            textContent: "\xD7",
            title: S.remove,
            "aria-label": `${S.remove} ${S.ruleAt(rule.place)}`,
            "data-key": `remove ${number}`,
            onclick: () => this.change("rule", { line: rule.line, sentence: "" })
          })
        );
      }
      this.lit[number] = li3;
      return li3;
    };
    /** A line to write a rule in; one that is changed may be left with Escape. */
    writer = (draft, label) => {
      const isNew = draft === this.fresh;
      const key2 = `write ${isNew ? "new" : draft.rule}`;
      const field = el("input", {
        type: "text",
        class: "write",
        value: draft.text,
        "aria-label": label,
        placeholder: S.ifThen,
        "data-key": key2,
        spellcheck: false
      });
      const leave = () => {
        this.drafts.delete(draft);
        const isHeld = this.body.querySelector(`[data-key="${key2}"]`)?.closest("form").contains(document.activeElement);
        this.build();
        if (isHeld) this.body.querySelector(`[data-key="edit ${draft.rule}"]`)?.focus();
      };
      const send = async (event) => {
        event.preventDefault();
        const sentence = draft.text;
        if (!sentence.trim()) return;
        const line = isNew ? null : this.store.scene.rules[draft.rule].line;
        const taken = await this.change("rule", { line, sentence });
        if (!taken) field.setAttribute("aria-invalid", "true");
        else if (!isNew) leave();
        else if (this.fresh.text === sentence) {
          this.fresh.text = field.value = "";
          if (!field.isConnected) this.build();
        }
      };
      field.addEventListener("input", () => {
        draft.text = field.value;
        field.removeAttribute("aria-invalid");
      });
      field.addEventListener("keydown", (event) => {
        if (event.key === "Escape" && !isNew) leave();
      });
      return el(
        "form",
        { class: "sentence", onsubmit: send },
        field,
        el("button", { class: "small", type: "submit", textContent: isNew ? S.add : S.ok, "data-key": `done ${key2}` })
      );
    };
    // --- grids ---
    table = (grid, outputs, editable, k) => {
      const output = outputs.find((each) => each.name === grid.output);
      const when = grid.condition ? ` when ${grid.condition}` : "";
      const corner = grid.row ? `${grid.row} \\ ${grid.column}` : grid.column;
      const head = el("tr", {}, el("th", { scope: "col", textContent: corner }));
      for (const name of grid.columns) head.append(el("th", { scope: "col" }, this.label(grid, name, false, k)));
      const caption = el("caption", {}, el("span", { textContent: `${grid.output}${when}` }), ...this.tools(grid, k));
      const found = this.findingsOf(grid.range);
      if (found.length) caption.append(" ", this.sign(found));
      const made = el("table", {}, caption, el("thead", {}, head));
      const rows = el("tbody");
      for (const row of grid.rows) {
        const line = el(
          "tr",
          {},
          el("th", { scope: "row" }, grid.row ? this.label(grid, row.label, true, k) : row.label)
        );
        row.cells.forEach((cell, i) => {
          const label = S.ruleOf(row.label, grid.columns[i]);
          const change = editable && !(grid.joined && cell.term === null);
          const content = change ? this.picker(cell, output, label, grid.joined) : this.plain(cell);
          content.dataset.key = `cell ${k} ${row.label}, ${grid.columns[i]}`;
          this.paint(content, cell.term, output);
          const td2 = el("td", {}, content);
          this.mark(td2, content, this.findingsOf(cell.range));
          if (cell.rule !== null) this.lit[cell.rule] = td2;
          line.append(td2);
        });
        rows.append(line);
      }
      made.append(rows);
      return made;
    };
    /** What names a row or a column, and leads to what is done with it. */
    label = (grid, term, row, k) => {
      if (!this.attempt) return el("span", { textContent: term, title: term });
      const variable = row ? grid.row : grid.column;
      return el("button", {
        textContent: term,
        "data-key": `head ${k} ${row} ${term}`,
        title: row ? S.rowOf(variable, term) : S.columnOf(variable, term),
        onclick: () => headDialog(this.hand, this.store.scene, {
          line: grid.line,
          row,
          variable,
          term,
          present: this.present(grid, row)
        })
      });
    };
    /** Buttons of a grid: another row or column, and its removal. */
    tools = (grid, k) => {
      if (!this.attempt) return [];
      const adding = (words2, title2, row) => el("button", {
        class: "small",
        textContent: words2,
        title: title2,
        "data-key": `add ${k} ${row}`,
        onclick: () => addHead(this.hand, this.store.scene, {
          line: grid.line,
          row,
          variable: row ? grid.row : grid.column,
          present: this.present(grid, row)
        })
      });
      return [
        ...grid.row ? [adding(S.rowDots, S.addRowOf(grid.row), true)] : [],
        adding(S.columnDots, S.addColumnOf(grid.column), false),
        el("button", {
          class: "small",
          textContent: "\xD7",
          title: S.removeGrid(grid.output),
          "aria-label": S.removeGrid(grid.output),
          onclick: () => this.change("grid", { line: grid.line })
        })
      ];
    };
    plain = (cell) => {
      return el("span", { textContent: this.said(cell), title: cell.term ?? S.noRule });
    };
    picker = (cell, output, label, joined) => {
      const select = el("select", { "aria-label": label, title: label });
      const names = output.terms.map((term) => term.name);
      for (const name of names) {
        const text = name === cell.term ? this.said(cell) : name;
        select.append(el("option", { value: name, textContent: text, selected: name === cell.term }));
      }
      if (!joined) select.append(el("option", { value: "", textContent: "\xB7", selected: cell.term === null }));
      select.addEventListener("change", () => {
        const chosen = select.selectedIndex < names.length ? names[select.selectedIndex] : null;
        this.paint(select, chosen, output);
        this.setCell(cell.at, chosen);
      });
      return select;
    };
    paint = (element, name, output) => {
      const term = output.terms.find((each) => each.name === name);
      const [low, high] = rangeOf(output);
      const value = term && (term.centre ?? term.parameters[term.parameters.length - 1]);
      if (value === void 0 || value === null) {
        element.style.background = element.style.color = "";
        return;
      }
      [element.style.background, element.style.color] = heat((value - low) / (high - low));
    };
    light = () => {
      const found = this.store.fired();
      this.lit.forEach((element, number) => {
        const strength = found?.strengths[number] ?? 0;
        if (this.shown[number] === strength) return;
        this.shown[number] = strength;
        element.classList.toggle("lit", strength > 0);
        const lower = found?.lower[number] ?? strength;
        const range = lower === strength ? shortNumber(strength, 3) : S.between(shortNumber(lower, 3), shortNumber(strength, 3));
        const said2 = strength > 0 ? `${S.strength} ${range}` : S.silent;
        element.title = S.fires(this.store.scene.rules[number].place, said2);
      });
    };
  };

  // split.js
  var LEAST_SHARE = 0.08;
  var STEPS = { ArrowLeft: -0.02, ArrowUp: -0.02, ArrowRight: 0.02, ArrowDown: 0.02, PageUp: -0.1, PageDown: 0.1 };
  var bounded = (share2) => Math.min(1 - LEAST_SHARE, Math.max(LEAST_SHARE, share2));
  var shareAt = (position, start2, first, handle, second) => bounded((position - start2 - handle / 2) / Math.max(1, first + second));
  function shareBy(key2, share2, usual, vertical) {
    if (key2 === "Home") return LEAST_SHARE;
    if (key2 === "End") return 1 - LEAST_SHARE;
    if (key2 === "Enter") return usual;
    const isAcross = /Left|Right/.test(key2);
    const step = /^Arrow/.test(key2) && isAcross !== vertical ? void 0 : STEPS[key2];
    return step === void 0 ? null : bounded(share2 + step);
  }
  var sizesOf = (tracks) => tracks.split(" ").map(parseFloat).filter(Number.isFinite);
  var kept = {
    read: (key2) => {
      try {
        return Number(localStorage.getItem(`fuzzyarm.split.${key2}`)) || null;
      } catch {
        return null;
      }
    },
    write: (key2, share2) => {
      try {
        if (share2 === null) localStorage.removeItem(`fuzzyarm.split.${key2}`);
        else localStorage.setItem(`fuzzyarm.split.${key2}`, share2.toFixed(4));
      } catch {
      }
    }
  };
  function splitter({ key: key2, vertical, at: at2, usual }) {
    const root = document.documentElement;
    const now = () => parseFloat(root.style.getPropertyValue(`--${key2}-a`)) || null;
    let share2 = now() ?? kept.read(key2) ?? usual;
    const handle = el("div", {
      class: `split ${vertical ? "columns" : "rows"}`,
      role: "separator",
      tabIndex: 0,
      title: S.split,
      "aria-label": S.splitOf(vertical),
      "aria-orientation": vertical ? "vertical" : "horizontal",
      "aria-valuemin": Math.round(100 * LEAST_SHARE),
      "aria-valuemax": Math.round(100 - 100 * LEAST_SHARE)
    });
    function put(next, isDone = true) {
      share2 = next;
      root.style.setProperty(`--${key2}-a`, `${share2}fr`);
      root.style.setProperty(`--${key2}-b`, `${1 - share2}fr`);
      tell();
      if (isDone) kept.write(key2, share2 === usual ? null : share2);
    }
    const tell = () => handle.setAttribute("aria-valuenow", String(Math.round(100 * share2)));
    function tracks() {
      const grid = handle.parentElement;
      const style = getComputedStyle(grid);
      const sizes = sizesOf(vertical ? style.gridTemplateColumns : style.gridTemplateRows);
      const gap = parseFloat(vertical ? style.columnGap : style.rowGap) || 0;
      const box = grid.getBoundingClientRect();
      const pad = parseFloat(vertical ? style.paddingLeft : style.paddingTop) || 0;
      const start2 = (vertical ? box.left : box.top) + pad + sizes.slice(0, at2 - 1).reduce((sum, size) => sum + size + gap, 0);
      return [start2, sizes[at2 - 1], sizes[at2], sizes[at2 + 1]];
    }
    handle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      const [start2, ...sizes] = tracks();
      handle.onpointermove = (move) => put(shareAt(vertical ? move.clientX : move.clientY, start2, ...sizes), false);
      handle.onpointerup = handle.onpointercancel = () => {
        handle.onpointermove = handle.onpointerup = handle.onpointercancel = null;
        put(share2);
      };
    });
    handle.addEventListener("dblclick", () => put(usual));
    handle.addEventListener("keydown", (event) => {
      const next = shareBy(event.key, now(), usual, vertical);
      if (next === null || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      put(next);
    });
    handle.addEventListener("focus", () => put(now(), false));
    put(share2, false);
    return handle;
  }

  // surface.js
  var packed = (share2) => SHADES.map(([r, g, b]) => (255 << 24 | b * share2 << 16 | g * share2 << 8 | r * share2) >>> 0);
  var FILLS = Uint32Array.from(packed(1));
  var DARKER = Uint32Array.from(packed(0.87));
  var MESH = 6;
  function surfacePane(store2, { start: start2 }) {
    return new SurfacePane(store2, { start: start2 }).section;
  }
  var SurfacePane = class {
    /**
     * @param {Page.Store} store
     */
    constructor(store2, { start: start2 }) {
      this.store = store2;
      this.start = start2;
      const { section, bar: bar2, body } = pane("surface", S.surface);
      this.section = section;
      this.bar = bar2;
      this.canvas = el("canvas", { tabIndex: 0, role: "img" });
      const main = el("div", { class: "main" }, this.canvas);
      this.line = el("canvas", { tabIndex: 0, role: "img" });
      this.cutSlider = el("input", {
        type: "range",
        step: "any",
        oninput: () => this.store.setPoint(this.cutInput(), Number(this.cutSlider.value))
      });
      this.cutLabel = el("label", { class: "small" }, el("span"), this.cutSlider);
      this.below = el("div", { class: "below", hidden: true }, this.cutLabel, el("div", { class: "line" }, this.line));
      this.others = el("div", { class: "others" });
      this.turned = { azimuth: -0.65, elevation: 0.55 };
      this.flat = false;
      this.cut = "";
      this.image = null;
      this.layer = null;
      this.scale = null;
      this.size = { width: 0, height: 0 };
      this.plot = null;
      this.linePlot = null;
      this.handle = null;
      this.sliders = [];
      body.append(main, this.below, this.others);
      let held = false;
      this.canvas.addEventListener("pointerdown", (event) => {
        if (!this.store.scene) return;
        this.canvas.setPointerCapture(event.pointerId);
        held = Boolean(this.handle) && Math.hypot(event.offsetX - this.handle.at[0], event.offsetY - this.handle.at[1]) < 12;
        if (this.isPlane()) this.aim(event);
      });
      this.canvas.addEventListener("pointermove", (event) => {
        if (!this.store.scene || !event.buttons) return;
        if (this.isPlane()) this.aim(event);
        else if (held && this.handle) this.slide(event);
        else this.turn(0.01 * event.movementX, 0.01 * event.movementY);
      });
      this.canvas.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
        if (!step || !this.store.scene) return;
        event.preventDefault();
        if (this.isPlane()) this.nudge(step[0] ? this.store.axes.x : this.store.axes.y, step[0] + step[1]);
        else this.turn(0.1 * step[0], 0.1 * step[1]);
      });
      this.line.addEventListener("pointerdown", (event) => {
        this.line.setPointerCapture(event.pointerId);
        this.aimLine(event);
      });
      this.line.addEventListener("pointermove", (event) => {
        if (event.buttons) this.aimLine(event);
      });
      this.line.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 }[event.key];
        if (!step) return;
        event.preventDefault();
        this.nudge(this.otherInput(), step);
      });
      this.redraw = eachFrame(this.draw);
      this.store.on("scene", this.build);
      this.store.on("axes", this.build);
      for (const name of ["reshaped", "point", "theme", "told"]) this.store.on(name, this.redraw);
      const watch = new ResizeObserver(() => {
        this.size = { width: main.clientWidth, height: main.clientHeight };
        this.redraw();
      });
      watch.observe(main);
      watch.observe(this.line.parentElement);
    }
    cutInput = () => this.store.axes[this.cut];
    otherInput = () => this.store.axes[this.cut === "x" ? "y" : "x"];
    /** The side of the base, -0.5 or 0.5, that is nearer to the eye. */
    front = (axis) => {
      const depth = axis === "x" ? Math.sin(this.turned.azimuth) : Math.cos(this.turned.azimuth);
      return depth > 0 ? -0.5 : 0.5;
    };
    place = (variable, value) => {
      const [low, high] = rangeOf(variable);
      return (value - low) / (high - low);
    };
    isPlane = () => this.flat || this.store.axes.x === this.store.axes.y;
    build = () => {
      const focused = [...this.bar.querySelectorAll("select")].indexOf(document.activeElement);
      while (this.bar.childNodes.length > 1) this.bar.lastChild.remove();
      this.bar.append(el("span", { class: "space" }));
      const { inputs, outputs, missing } = this.store.scene;
      if (missing.length) {
        this.below.hidden = true;
        this.others.replaceChildren();
        this.redraw();
        return;
      }
      const names = inputs.map((each, i) => [String(i), each.name]);
      if (inputs.length > 2) {
        this.bar.append(
          choice(S.horizontal, names, String(this.store.axes.x), (i) => this.pick({ x: Number(i) })),
          choice(S.vertical, names, String(this.store.axes.y), (i) => this.pick({ y: Number(i) }))
        );
      }
      if (outputs.length > 1) {
        const shown = outputs.map((each, i) => [String(i), each.name]);
        this.bar.append(choice(S.shown, shown, String(this.store.axes.output), (i) => this.pick({ output: Number(i) })));
      }
      if (inputs.length > 1) {
        const views = [
          ["solid", S.solid],
          ["contour", S.contour]
        ];
        const cuts = [
          ["", S.noCut],
          ["x", inputs[this.store.axes.x].name],
          ["y", inputs[this.store.axes.y].name]
        ];
        this.bar.append(
          choice(S.view, views, this.flat ? "contour" : "solid", (view) => {
            this.flat = view === "contour";
            this.redraw();
          }),
          choice(S.cut, cuts, this.cut, (axis) => {
            this.cut = axis;
            this.prepare();
          })
        );
      } else this.cut = "";
      this.bar.querySelectorAll("select")[focused]?.focus();
      this.prepare();
    };
    /** Set up the line below for the cut, and the sliders beside for the inputs that are no axes. */
    prepare = () => {
      const { inputs } = this.store.scene;
      this.below.hidden = !this.cut;
      if (this.cut) {
        const [low, high] = rangeOf(inputs[this.cutInput()]);
        Object.assign(this.cutSlider, { min: low, max: high, step: (high - low) / 400 });
      }
      this.sliders = inputs.map((variable, i) => (
        /** @type {const} */
        [variable, i]
      )).filter(([, i]) => i !== this.store.axes.x && i !== this.store.axes.y).map(([variable, i]) => {
        const [low, high] = rangeOf(variable);
        const range = el("input", {
          type: "range",
          min: low,
          max: high,
          step: (high - low) / 400,
          oninput: () => this.store.setPoint(i, Number(range.value))
        });
        const said2 = el("output", {});
        return {
          i,
          range,
          said: said2,
          label: el("label", { class: "small" }, el("span", { textContent: variable.name }), range, said2)
        };
      });
      this.others.replaceChildren(...this.sliders.map(({ label }) => label));
      this.redraw();
    };
    pick = (axes2) => {
      const { x: x2, y } = this.store.axes;
      if (axes2.x === y) axes2.y = x2;
      else if (axes2.y === x2) axes2.x = y;
      this.store.setAxes(axes2);
    };
    draw = () => {
      const { scene, axes: axes2 } = this.store;
      if (!scene || !this.size.width) return;
      if (scene.missing.length) {
        this.nothing(
          S.notYet(
            Object.keys(S.missing).filter((name) => scene.missing.includes(name)).map((name) => S.missing[name])
          )
        );
        return;
      }
      const [x2, y] = [scene.inputs[axes2.x], scene.inputs[axes2.y]];
      const output = scene.outputs[axes2.output];
      for (const { i, range, said: said2 } of this.sliders) {
        range.value = this.store.point[i];
        said2.textContent = shortNumber(this.store.point[i]);
      }
      const { g, width, height } = context(this.canvas, this.size.width, this.size.height);
      this.handle = null;
      const found = this.store.surface();
      const label = S.surfaceLabel(output.name, x2.name, x2 === y ? "" : y.name);
      const source = found?.isFar ? S.byServer : found && this.store.coarse ? S.coarse : "";
      this.canvas.setAttribute("aria-label", `${label} ${source}`.trim());
      if (!found) {
        this.nothing(this.store.refused || (this.start ? S.asking(scene.reason) : S.notHere(scene.reason)));
        return;
      }
      const [low, high] = limitsOf(found.z, output);
      const section = this.cut ? this.store.section(this.otherInput()) : null;
      const picture = { g, width, height, found, low, high, x: x2, y, output, section };
      if (this.isPlane()) this.drawPlane(picture);
      else {
        this.drawSolid(picture);
        this.drawScale(picture);
      }
      if (source) {
        g.fillStyle = colourOf("--soft");
        g.font = "11px system-ui, sans-serif";
        g.textAlign = "left";
        g.fillText(source, 8, height - 6);
      }
      if (this.cut) this.drawSection(picture);
    };
    /** Say why nothing is drawn. */
    nothing = (words2) => {
      const { g, width } = context(this.canvas, this.size.width, this.size.height);
      g.fillStyle = colourOf("--soft");
      g.font = "13px system-ui, sans-serif";
      this.wrapped(g, clean(words2), 12, 24, width - 24);
      this.canvas.setAttribute("aria-label", clean(words2));
    };
    scaleImage = () => {
      const colours = new ImageData(1, 256);
      SHADES.forEach((shade, i) => colours.data.set([...shade, 255], 4 * (255 - i)));
      const made = new OffscreenCanvas(1, 256);
      made.getContext("2d").putImageData(colours, 0, 0);
      return made;
    };
    /** What the colours stand for. */
    drawScale = ({ g, width, height, low, high }) => {
      const [right, top, tall, wide] = [width - 10, 26, Math.min(150, height - 70), 9];
      if (tall < 40) return;
      this.scale ??= this.scaleImage();
      g.drawImage(this.scale, right - wide, top, wide, tall);
      g.fillStyle = colourOf("--soft");
      g.font = "11px system-ui, sans-serif";
      g.textAlign = "right";
      for (const tick of ticks(low, high, tall / 34)) {
        g.fillText(shortNumber(tick), right - wide - 4, top + (tall - 1) * (1 - (tick - low) / (high - low)) + 4);
      }
    };
    // --- the solid ---
    drawSolid = ({ g, width, height, found, low, high, x: x2, y, output }) => {
      const { z: z2 } = found;
      const n66 = found.xs.length;
      const { project, reach, farIsHigh } = projectionOf(this.turned, width, height);
      const px = new Float64Array(n66 * n66);
      const py = new Float64Array(n66 * n66);
      const share2 = new Float64Array(n66 * n66);
      for (let j2 = 0, k = 0; j2 < n66; j2++) {
        for (let i = 0; i < n66; i++, k++) {
          share2[k] = (z2[k] - low) / (high - low);
          const at2 = project(i / (n66 - 1) - 0.5, j2 / (n66 - 1) - 0.5, share2[k] - 0.5);
          px[k] = at2[0];
          py[k] = at2[1];
        }
      }
      this.frame(g, project, { x: x2, y, low, high, output, wanted: reach < 130 ? 2 : 4 });
      const is3 = farToNear(n66 - 1, farIsHigh.u);
      const js2 = farToNear(n66 - 1, farIsHigh.v);
      const ratio = 2;
      const [wide, tall] = [Math.round(ratio * width), Math.round(ratio * height)];
      if (this.image?.width !== wide || this.image?.height !== tall) {
        this.image = new ImageData(wide, tall);
        this.layer = new OffscreenCanvas(wide, tall);
      }
      const pixels = new Uint32Array(this.image.data.buffer);
      pixels.fill(0);
      for (let k = 0; k < n66 * n66; k++) {
        px[k] *= ratio;
        py[k] *= ratio;
      }
      for (const j2 of js2) {
        for (const i of is3) {
          const [a, b] = [j2 * n66 + i, (j2 + 1) * n66 + i];
          const middle = 0.25 * (share2[a] + share2[a + 1] + share2[b] + share2[b + 1]);
          if (!(middle === middle)) continue;
          const fills = i % MESH && j2 % MESH ? FILLS : DARKER;
          const colour = fills[Math.max(0, Math.min(255, Math.round(255 * middle)))];
          const [c, d] = [a + 1, b + 1];
          fillTriangle(pixels, wide, tall, px[a], py[a], px[c], py[c], px[d], py[d], colour);
          fillTriangle(pixels, wide, tall, px[a], py[a], px[b], py[b], px[d], py[d], colour);
        }
      }
      this.layer.getContext("2d").putImageData(this.image, 0, 0);
      g.drawImage(this.layer, 0, 0, width, height);
      const value = this.store.value();
      if (this.cut) this.drawCut(g, project, low, high);
      if (Number.isFinite(value)) {
        const [u, v] = [x2, y].map(
          (each, k) => this.place(each, this.store.point[k ? this.store.axes.y : this.store.axes.x])
        );
        this.dot(g, ...project(u - 0.5, v - 0.5, (value - low) / (high - low) - 0.5));
      }
    };
    /** The plane of the cut, where it meets the surface, and the handle that moves it. */
    drawCut = (g, project, low, high) => {
      const [one, other] = [this.cutInput(), this.otherInput()].map((i) => this.store.scene.inputs[i]);
      const at2 = this.place(one, this.store.point[this.cutInput()]) - 0.5;
      const corner = (along, w) => this.cut === "x" ? project(at2, along, w) : project(along, at2, w);
      g.fillStyle = g.strokeStyle = colourOf("--lit");
      g.globalAlpha = 0.12;
      g.beginPath();
      [
        [-0.5, -0.5],
        [0.5, -0.5],
        [0.5, 0.5],
        [-0.5, 0.5]
      ].forEach(([along, w], i) => i ? g.lineTo(...corner(along, w)) : g.moveTo(...corner(along, w)));
      g.closePath();
      g.fill();
      g.globalAlpha = 1;
      g.lineWidth = 1;
      g.stroke();
      const section = this.store.section(this.otherInput());
      g.lineWidth = 2;
      g.beginPath();
      let down = false;
      section?.z.forEach((value, i) => {
        const spot = corner(this.place(other, section.xs[i]) - 0.5, (value - low) / (high - low) - 0.5);
        if (Number.isFinite(value)) down ? g.lineTo(...spot) : g.moveTo(...spot);
        down = Number.isFinite(value);
      });
      g.stroke();
      const way = (share2) => this.cut === "x" ? project(share2, this.front("y"), -0.5) : project(this.front("x"), share2, -0.5);
      this.handle = { at: way(at2), from: way(-0.5), to: way(0.5) };
      g.fillStyle = colourOf("--pane");
      g.beginPath();
      g.arc(...this.handle.at, 6, 0, 2 * Math.PI);
      g.fill();
      g.stroke();
    };
    frame = (g, project, { x: x2, y, low, high, output, wanted }) => {
      g.strokeStyle = colourOf("--line");
      g.fillStyle = colourOf("--soft");
      g.font = "11px system-ui, sans-serif";
      g.textAlign = "center";
      g.lineWidth = 1;
      const base = [
        [-0.5, -0.5],
        [0.5, -0.5],
        [0.5, 0.5],
        [-0.5, 0.5]
      ].map(([u, v]) => project(u, v, -0.5));
      g.beginPath();
      base.forEach((at2, i) => i ? g.lineTo(...at2) : g.moveTo(...at2));
      g.closePath();
      g.stroke();
      const near = Math.cos(this.turned.azimuth) > 0 ? -0.5 : 0.5;
      const side = Math.sin(this.turned.azimuth) > 0 ? -0.5 : 0.5;
      const axis = (variable, at2) => {
        const [a, b] = rangeOf(variable);
        for (const tick of ticks(a, b, wanted)) {
          g.fillText(shortNumber(tick), ...at2((tick - a) / (b - a) - 0.5, 1.1));
        }
        g.font = "600 12px system-ui, sans-serif";
        g.fillText(clean(variable.name).slice(0, 24), ...at2(0, 1.32));
        g.font = "11px system-ui, sans-serif";
      };
      axis(x2, (t, out) => project(t, near * out, -0.5));
      axis(y, (t, out) => project(side * out, t, -0.5));
      g.textAlign = "left";
      g.fillText(`${clean(output.name).slice(0, 24)}: ${shortNumber(low)} \u2026 ${shortNumber(high)}`, 8, 15);
    };
    dot = (g, x2, y) => {
      g.fillStyle = colourOf("--lit");
      g.strokeStyle = "#ffffff";
      g.lineWidth = 1.5;
      g.beginPath();
      g.arc(x2, y, 4.5, 0, 2 * Math.PI);
      g.fill();
      g.stroke();
    };
    // --- seen from above, over one input, or the section of the cut ---
    drawPlane = ({ found, low, high, x: x2, y, output }) => {
      const { axes: axes2 } = this.store;
      const whole = this.whole(output, low, high);
      const [across, up2] = [this.along(axes2.x), this.along(axes2.y)];
      if (x2 === y) this.plot = drawPanel(this.canvas, linePanel(found, across, whole));
      else {
        const inputs = [
          { ...across, isCut: this.cut === "x" },
          { ...up2, isCut: this.cut === "y" }
        ];
        this.plot = drawPanel(this.canvas, planePanel(found, inputs, whole));
      }
    };
    /**
     * The output as an axis, and its value at the point.
     *
     * @returns {{ name: string, range: Page.Pair, at: number }}
     */
    whole = ({ name }, low, high) => ({ name, range: [low, high], at: this.store.value() });
    /** An input as an axis, and where the point lies along it. */
    along = (input) => {
      const variable = this.store.scene.inputs[input];
      return { name: variable.name, range: rangeOf(variable), at: this.store.point[input] };
    };
    drawSection = ({ section: found, low, high, output }) => {
      const [at2, other] = [this.cutInput(), this.otherInput()].map(this.along);
      this.cutSlider.value = at2.at;
      const said2 = S.cutAt(at2.name, shortNumber(at2.at));
      this.cutLabel.firstChild.textContent = clean(said2);
      this.line.setAttribute("aria-label", S.sectionLabel(output.name, other.name, said2));
      if (!found) return;
      const whole = this.whole(output, low, high);
      this.linePlot = drawPanel(this.line, linePanel(found, other, whole));
    };
    wrapped = (g, text, x2, y, width) => {
      let line = "";
      for (const word of text.split(" ")) {
        if (line && g.measureText(`${line} ${word}`).width > width) {
          g.fillText(line, x2, y);
          [line, y] = [word, y + 18];
        } else line = line ? `${line} ${word}` : word;
      }
      g.fillText(line, x2, y);
    };
    // --- hands ---
    aim = (event) => {
      if (!this.plot) return;
      const { x: x2, y } = this.store.axes;
      this.store.setPoint(x2, this.plot.xAt(event.offsetX));
      if (x2 !== y) this.store.setPoint(y, this.plot.yAt(event.offsetY));
    };
    nudge = (input, steps) => {
      const [low, high] = rangeOf(this.store.scene.inputs[input]);
      this.store.setPoint(input, this.store.point[input] + steps * 0.01 * (high - low));
    };
    /** Move the cut to where the pointer is along the edge that its handle runs on. */
    slide = (event) => {
      const { from, to: to3 } = this.handle;
      const [dx, dy] = [to3[0] - from[0], to3[1] - from[1]];
      const share2 = ((event.offsetX - from[0]) * dx + (event.offsetY - from[1]) * dy) / (dx * dx + dy * dy);
      const [low, high] = rangeOf(this.store.scene.inputs[this.cutInput()]);
      this.store.setPoint(this.cutInput(), low + share2 * (high - low));
    };
    aimLine = (event) => {
      if (this.linePlot) this.store.setPoint(this.otherInput(), this.linePlot.xAt(event.offsetX));
    };
    turn = (azimuth, elevation) => {
      this.turned.azimuth -= azimuth;
      this.turned.elevation = Math.min(1.5, Math.max(0.05, this.turned.elevation + elevation));
      this.redraw();
    };
  };

  // viewer.js
  var SAMPLES = 121;
  var ROW = 27;
  var SPARE = 2;
  function viewerPane(store2) {
    return new ViewerPane(store2).section;
  }
  var ViewerPane = class {
    /**
     * @param {Page.Store} store
     */
    constructor(store2) {
      this.store = store2;
      const { section, bar: bar2, body } = pane("inference", S.inference);
      this.section = section;
      this.sliders = el("div", { class: "sliders" });
      this.why = el("div", { "aria-live": "polite" });
      this.head = el("div", { class: "fired head" });
      this.rows = el("div", { class: "rules-fired", tabIndex: 0, role: "group", "aria-label": S.rules });
      this.foot = el("div", { class: "fired foot" });
      this.inputs = [];
      this.order = "strength";
      bar2.append(
        el("span", { class: "space" }),
        choice(
          S.order,
          [
            ["strength", S.strongest],
            ["text", S.asWritten]
          ],
          this.order,
          (to3) => {
            this.order = to3;
            this.rows.scrollTop = 0;
            this.draw();
          }
        )
      );
      body.append(this.sliders, this.why, this.head, this.rows, this.foot);
      const redraw = eachFrame(this.draw);
      this.store.on("scene", this.build);
      for (const name of ["reshaped", "point", "told"]) this.store.on(name, redraw);
      this.rows.addEventListener("scroll", redraw);
      new ResizeObserver(redraw).observe(this.rows);
    }
    small = (x2) => x2 > 0 && x2 < 1e-3 ? x2.toExponential(0) : shortNumber(x2, 3);
    degree = (found, number) => {
      const [high, low] = [found.strengths[number], found.lower[number]].map(this.small);
      return high === low ? high : S.between(low, high);
    };
    samples = (variable) => {
      const [low, high] = rangeOf(variable);
      return Float64Array.from({ length: SAMPLES }, (_2, i) => low + (high - low) * i / (SAMPLES - 1));
    };
    across = (i) => (100 * i / (SAMPLES - 1)).toFixed(2);
    line = (y) => Array.from(y, (v, i) => `${i ? "L" : "M"}${this.across(i)} ${(-v).toFixed(3)}`).join("");
    area = (y) => `${this.line(y)}L100 0L0 0Z`;
    filled = (y, side) => svg("path", { class: side ? "cut lower" : "cut", d: this.area(y) });
    outline = (y, side) => svg("path", { class: side ? "set lower" : "set", d: this.line(y) });
    share = (variable, value) => {
      const [low, high] = rangeOf(variable);
      return 100 * (value - low) / (high - low);
    };
    build = () => {
      this.sliders.replaceChildren();
      this.inputs = this.store.scene.inputs.map((variable, i) => {
        const [low, high] = rangeOf(variable);
        const set = (value) => {
          if (Number.isFinite(value)) this.store.setPoint(i, value);
        };
        const label = el("label", { textContent: variable.name, title: variable.description || variable.name });
        const range = el("input", {
          type: "range",
          min: low,
          max: high,
          step: (high - low) / 400,
          id: `input-${i}`,
          oninput: () => set(Number(range.value))
        });
        label.htmlFor = range.id;
        const number = el("input", {
          type: "text",
          inputMode: "decimal",
          "aria-label": `${variable.name}: ${S.value}`,
          onchange: () => set(Number(number.value))
        });
        this.sliders.append(el("div", { class: "slider" }, label, range, number));
        return { range, number };
      });
      const { scene } = this.store;
      const first = scene.rules.some((rule) => rule.readings.length > 1) ? "8.4em" : "5.4em";
      const columns = `${first} repeat(${scene.inputs.length + scene.outputs.length}, minmax(0, 1fr))`;
      for (const part of [this.head, this.foot]) part.style.gridTemplateColumns = columns;
      this.rows.style.setProperty("--columns", columns);
      this.head.replaceChildren(
        el("span"),
        ...[...scene.inputs, ...scene.outputs].map(
          (variable) => el("strong", { class: "cell", textContent: variable.name })
        )
      );
      this.draw();
    };
    draw = () => {
      if (!this.store.scene) return;
      this.inputs.forEach(({ range, number }, i) => {
        range.value = this.store.point[i];
        if (document.activeElement !== number) number.value = shortNumber(this.store.point[i], 6);
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
        this.why.replaceChildren(
          el("p", { class: "note", textContent: this.store.refused || S.notHere(this.store.scene.reason) })
        );
        return;
      }
      this.why.replaceChildren(...this.reasons(found));
      if (!found) return;
      this.list(found);
      this.foot.replaceChildren(
        el("span"),
        ...this.store.scene.inputs.map(() => el("span")),
        ...this.store.scene.outputs.map((output, o) => this.whole(output, o, found))
      );
    };
    reasons = (found) => {
      return this.store.scene.outputs.map((output, o) => {
        const value = found?.outputs[o];
        const line = el("p", { class: "why" });
        const ends = output.interval && found?.ends?.[o].every(Number.isFinite) ? found.ends[o] : null;
        const interval = ends ? ` ${S.interval(...ends.map((x2) => shortNumber(x2, 6)))}` : "";
        const said2 = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
        line.append(el("output", { textContent: `${output.name} = ${said2}${interval}` }));
        let first = -1;
        this.store.scene.rules.forEach((rule, number) => {
          const strength = found?.strengths[number] ?? 0;
          const concludes = rule.concludes.some(([k]) => k === o);
          if (concludes && strength > (first < 0 ? 0 : found.strengths[first])) first = number;
        });
        const reason = first >= 0 ? ` ${S.because} ${this.store.scene.rules[first].text} (${S.strength} ${this.degree(found, first)}, ${this.store.scene.rules[first].place})` : ` \u2013 ${S.nothingFires}`;
        line.append(clean(reason));
        return line;
      });
    };
    /** Draw the rules that are seen; those above and below are as much room. */
    list = (found) => {
      const { rules } = this.store.scene;
      let numbers = rules.map((_2, number) => number);
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
        room(numbers.length - last)
      );
    };
    row = (found, number) => {
      const { scene } = this.store;
      const rule = scene.rules[number];
      const made = el("div", {
        class: found.strengths[number] > 0 ? "fired" : "fired silent",
        title: `${rule.place}: ${rule.text} (${S.strength} ${this.degree(found, number)})`
      });
      made.append(el("span", { class: "degree" }, el("span", { textContent: rule.place }), this.degree(found, number)));
      scene.inputs.forEach((variable, i) => made.append(this.premise(variable, i, rule)));
      scene.outputs.forEach((output, o) => made.append(this.conclusion(output, o, rule, found, number)));
      return made;
    };
    // --- pictures, 100 wide and 1 high ---
    picture = (label, kind, ...parts) => {
      const title2 = svg("title", {}, label);
      return svg(
        "svg",
        { viewBox: "0 -1.04 100 1.1", preserveAspectRatio: "none", role: "img", "aria-label": label, class: kind },
        title2,
        svg("line", { class: "base", x1: 0, x2: 100, y1: 0, y2: 0 }),
        ...parts
      );
    };
    mark = (variable, value) => {
      const x2 = this.share(variable, value);
      return svg("line", { x1: x2, x2, y1: -1.04, y2: 0 });
    };
    premise = (variable, i, rule) => {
      const parts = [];
      const words2 = [];
      for (const [input, name, hedges] of rule.parts) {
        const term = variable.terms.find((each) => input === i && each.name === name);
        if (!term?.curve) continue;
        const degrees = sidesOf(term).map((shape) => {
          const y = this.store.degrees(variable, shape, this.samples(variable));
          const at2 = this.store.degrees(variable, shape, Float64Array.of(this.store.point[i]))[0];
          const side = shape.side ?? 0;
          parts.push(
            this.filled(
              y.map((v) => Math.min(v, at2)),
              side
            ),
            this.outline(y, side)
          );
          return shortNumber(at2, 3);
        });
        words2.push(`${hedges} ${name}: ${degrees.length > 1 ? S.between(degrees[1], degrees[0]) : degrees[0]}`.trim());
      }
      if (!parts.length) return el("span");
      return this.picture(`${variable.name} ${words2.join(", ")}`, "", ...parts, this.mark(variable, this.store.point[i]));
    };
    /** Degrees of a consequent at the samples, as it is now. */
    setOf = (output, member) => {
      const term = output.terms.find((each) => each.name === member.term);
      const shape = member.isLower ? term?.lower ?? term : term;
      if (shape?.curve && !member.hedged) return this.store.degrees(output, shape, this.samples(output));
      const numbers = Float64Array.from(member.curve.numbers);
      return this.store.curves.degrees(member.curve.address, numbers, this.samples(output));
    };
    conclusion = (output, o, rule, found, number) => {
      const parts = [];
      const words2 = [];
      const sides = [
        [rule.concludes, found.strengths],
        [rule.concludesLower, found.lower]
      ];
      sides.forEach(([concludes, strengths], side) => {
        for (const [k, index] of concludes) {
          const member = output.members[index];
          if (k !== o) continue;
          if (!side) words2.push(member.words);
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
      return words2.length ? this.picture(`${output.name} ${words2.join(", ")}`, "", ...parts) : el("span");
    };
    stem = (output, value, height) => {
      const x2 = this.share(output, value);
      return svg("line", { x1: x2, x2, y1: -height, y2: 0 });
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
      let said2 = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
      const ends = output.interval ? found.ends?.[o] : null;
      if (ends?.every(Number.isFinite)) {
        const [left, right] = ends.map((end) => this.share(output, end));
        parts.push(
          svg("rect", { class: "interval", x: left, width: Math.max(0.2, right - left), y: -1.04, height: 1.04 })
        );
        said2 += ` ${S.interval(...ends.map((x2) => shortNumber(x2, 6)))}`;
      }
      if (Number.isFinite(value)) parts.push(this.mark(output, value));
      return this.picture(`${S.aggregate}: ${output.name} = ${said2}`, "whole", ...parts);
    };
  };

  // frame.js
  var DESIGN = {
    name: "design",
    title: S.design,
    drawn: true,
    panes: [termsPane, surfacePane, rulesPane, viewerPane],
    splits: [
      { key: "design-columns", vertical: true, at: 1, usual: 0.5 },
      { key: "design-rows", vertical: false, at: 1, usual: 0.5 }
    ]
  };
  var DARK = "(prefers-color-scheme: dark)";
  function frame(store2, hand, text, controls, shownViews = [DESIGN]) {
    return new Frame(store2, hand, text, controls, shownViews).api();
  }
  var Frame = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand, text, controls, shownViews = [DESIGN]) {
      this.store = store2;
      this.shownViews = shownViews;
      this.note = el("p", { class: "note" });
      this.views = this.shownViews.map(({ name, title: title2, drawn, panes, splits = [] }) => {
        const made = [...panes.map((make) => make(this.store, hand)), ...splits.map(splitter)];
        const panel = this.shownViews.length > 1 ? { role: "tabpanel", "aria-label": title2 } : {};
        return el(
          "div",
          { class: `pictures view-${name}${drawn ? " drawn" : ""}`, id: `view-${name}`, hidden: true, ...panel },
          ...made
        );
      });
      this.area = el("div", { class: "area" }, this.note, ...this.views);
      const between = text ? [text, splitter({ key: "text", vertical: true, at: 1, usual: 0.35 })] : [];
      const main = el("main", { class: text ? "design" : "design alone" }, ...between, this.area);
      const gone = new AbortController();
      const help = helpButton(
        this.shownViews.map((view) => view.name),
        gone.signal
      );
      const header = el(
        "header",
        {},
        el("h1", { textContent: S.designer }),
        ...controls,
        el("span", { class: "last" }, help, themeButton(this.store))
      );
      this.shown = 0;
      this.tabs = this.shownViews.map(
        ({ name, title: title2 }, i) => el("button", { role: "tab", textContent: title2, "aria-controls": `view-${name}`, onclick: () => this.turn(i) })
      );
      if (this.tabs.length > 1) header.lastChild.before(el("div", { role: "tablist", class: "tabs" }, ...this.tabs));
      this.root = el("div", { class: "desk" }, header, main);
      this.turn(0);
      window.addEventListener(
        "keydown",
        (event) => {
          if (event.key === "F6" && this.root.isConnected) this.step(event);
        },
        gone
      );
      matchMedia(DARK).addEventListener("change", () => this.store.emit("theme"), gone);
      this.store.on("closed", () => gone.abort());
      this.store.on("scene", this.sound);
      this.store.on("diagram", this.sound);
      this.store.on("stale", () => {
        this.note.textContent = this.store.why === "other" ? S.noRules : S.notDrawn;
        this.area.classList.add("stale");
      });
    }
    api() {
      return { root: this.root, turn: (name) => this.turn(this.shownViews.findIndex((view) => view.name === name)) };
    }
    sound = () => {
      this.area.classList.remove("stale");
      this.area.classList.toggle("as-diagram", Boolean(this.store.diagram) && this.store.asDiagram);
      this.turn(this.shown);
    };
    turn = (to3) => {
      this.shown = to3;
      this.note.hidden = !this.shownViews[this.shown].drawn || Boolean(this.store.scene ?? this.store.diagram);
      this.views.forEach((view, i) => {
        view.hidden = i !== this.shown || !this.note.hidden;
      });
      this.tabs.forEach((tab, i) => tab.setAttribute("aria-selected", String(i === this.shown)));
      if (this.store.view === this.shownViews[this.shown].name) return;
      this.store.view = this.shownViews[this.shown].name;
      this.store.emit("view");
    };
    /** Go to the next pane, or with Shift to the one before: there are many stops of Tab between. */
    step = (event) => {
      if (document.querySelector("dialog[open]")) return;
      const panes = [...this.root.querySelectorAll(".pane")].filter((each) => each.offsetParent);
      const at2 = panes.findIndex((each) => each.contains(document.activeElement));
      const next = event.shiftKey ? Math.max(at2, 0) - 1 : at2 + 1;
      event.preventDefault();
      panes.at(next % panes.length).focus();
    };
  };
  function themeButton(store2) {
    const root = document.documentElement;
    const dark = () => root.dataset.theme ? root.dataset.theme === "dark" : matchMedia(DARK).matches;
    const button = el("button", { title: S.theme, textContent: dark() ? S.light : S.dark });
    button.addEventListener("click", () => {
      root.dataset.theme = dark() ? "light" : "dark";
      store2.emit("theme");
    });
    store2.on("theme", () => {
      button.textContent = dark() ? S.light : S.dark;
    });
    return button;
  }

  // around.js
  async function makeAround(hand) {
    const file = hand.file();
    if (!await hand.save()) return;
    const made = await fill(
      S.aroundTitle(file),
      [{ name: "name", label: S.nameOfFile, value: S.aroundName(file) }],
      S.create,
      (values) => hand.folder({ what: "new", kind: "controller", around: file, ...values })
    );
    if (made?.open) hand.turnTo(made.open);
  }
  function aroundLine(hand) {
    const line = el("p", { class: "around", hidden: true });
    const go3 = (name) => el("button", { textContent: clean(name), onclick: () => hand.turnTo(name) });
    const links = (words2, names) => names.length ? [` ${words2} `, ...names.slice(0, 8).map(go3)] : [];
    async function show(wanted, onArm) {
      line.hidden = !wanted;
      if (!wanted) return;
      const listing = await hand.folder({ what: "list" });
      const using = (await hand.folder({ what: "users", file: hand.file() })).users ?? [];
      const others = (listing.files ?? []).filter((each) => each.kind === "controller" && !using.includes(each.name));
      const make = el("button", { class: "main", textContent: S.makeAround, onclick: () => makeAround(hand) });
      line.replaceChildren(
        clean(S.aloneRuns(hand.file(), onArm)),
        " ",
        ...listing.only ? [S.onlyOneAround] : [make],
        ...links(S.usedIn, using),
        ...links(
          S.canRun,
          others.map((each) => each.name)
        )
      );
    }
    return { line, show };
  }
  function unsavedLine(store2, hand) {
    const line = el("p", { class: "around", hidden: true });
    const wrong = el("span", { class: "error", role: "alert" });
    let uses = [];
    function draw() {
      const names = hand.unsaved().filter((name) => uses.includes(name));
      line.hidden = !names.length;
      wrong.textContent = "";
      const buttons = names.map(
        (name) => el("button", {
          textContent: S.saveFile(name),
          onclick: async () => {
            const { error } = await hand.saveFile(name);
            wrong.textContent = error ? ` ${clean(error)}` : "";
          }
        })
      );
      line.replaceChildren(clean(S.unsavedUsed(names)), " ", ...buttons, wrong);
    }
    store2.on("unsaved", draw);
    return {
      line,
      show(used) {
        uses = used;
        draw();
      }
    };
  }

  // vendor/uplot.js
  var Js = "uplot";
  var Zs = "u-hz";
  var Qs = "u-vt";
  var Xs = "u-title";
  var er = "u-wrap";
  var tr = "u-under";
  var lr = "u-over";
  var nr = "u-axis";
  var Zt = "u-off";
  var ir = "u-select";
  var or = "u-cursor-x";
  var sr = "u-cursor-y";
  var rr = "u-cursor-pt";
  var fr = "u-legend";
  var ur = "u-live";
  var cr = "u-inline";
  var ar = "u-series";
  var pr = "u-marker";
  var ji = "u-label";
  var hr = "u-value";
  var Nl = "width";
  var Wl = "height";
  var qi = "bottom";
  var yl = "left";
  var Wn = "right";
  var ni = "#000";
  var $i = ni + "0";
  var Gn = "mousemove";
  var Ji = "mousedown";
  var In = "mouseup";
  var Zi = "mouseenter";
  var Qi = "mouseleave";
  var Xi = "dblclick";
  var mr = "resize";
  var dr = "scroll";
  var eo = "change";
  var sn = "dppxchange";
  var ii = "--";
  var Al = typeof window < "u";
  var jn = Al ? document : null;
  var kl = Al ? window : null;
  var gr = Al ? navigator : null;
  var oe;
  var tn;
  function qn() {
    let e = devicePixelRatio;
    oe != e && (oe = e, tn && Jn(eo, tn, qn), tn = matchMedia(`(min-resolution: ${oe - 1e-3}dppx) and (max-resolution: ${oe + 1e-3}dppx)`), Qt(eo, tn, qn), kl.dispatchEvent(new CustomEvent(sn)));
  }
  function Xe(e, i) {
    if (i != null) {
      let o = e.classList;
      !o.contains(i) && o.add(i);
    }
  }
  function $n(e, i) {
    let o = e.classList;
    o.contains(i) && o.remove(i);
  }
  function ge(e, i, o) {
    e.style[i] = o + "px";
  }
  function dt(e, i, o, n66) {
    let s = jn.createElement(e);
    return i != null && Xe(s, i), o?.insertBefore(s, n66), s;
  }
  function ft(e, i) {
    return dt("div", e, i);
  }
  var to = /* @__PURE__ */ new WeakMap();
  function bt(e, i, o, n66, s) {
    let a = "translate(" + i + "px," + o + "px)", u = to.get(e);
    a != u && (e.style.transform = a, to.set(e, a), i < 0 || o < 0 || i > n66 || o > s ? Xe(e, Zt) : $n(e, Zt));
  }
  var lo = /* @__PURE__ */ new WeakMap();
  function no(e, i, o) {
    let n66 = i + o, s = lo.get(e);
    n66 != s && (lo.set(e, n66), e.style.background = i, e.style.borderColor = o);
  }
  var io = /* @__PURE__ */ new WeakMap();
  function oo(e, i, o, n66) {
    let s = i + "" + o, a = io.get(e);
    s != a && (io.set(e, s), e.style.height = o + "px", e.style.width = i + "px", e.style.marginLeft = n66 ? -i / 2 + "px" : 0, e.style.marginTop = n66 ? -o / 2 + "px" : 0);
  }
  var oi = { passive: true };
  var wr = { ...oi, capture: true };
  function Qt(e, i, o, n66) {
    i.addEventListener(e, o, n66 ? wr : oi);
  }
  function Jn(e, i, o, n66) {
    i.removeEventListener(e, o, oi);
  }
  Al && qn();
  function gt(e, i, o, n66) {
    let s;
    o = o || 0, n66 = n66 || i.length - 1;
    let a = n66 <= 2147483647;
    for (; n66 - o > 1; ) s = a ? o + n66 >> 1 : et((o + n66) / 2), i[s] < e ? o = s : n66 = s;
    return e - i[o] <= i[n66] - e ? o : n66;
  }
  function Ro(e) {
    return (o, n66, s) => {
      let a = -1, u = -1;
      for (let h = n66; h <= s; h++) if (e(o[h])) {
        a = h;
        break;
      }
      for (let h = s; h >= n66; h--) if (e(o[h])) {
        u = h;
        break;
      }
      return [a, u];
    };
  }
  var zo = (e) => e != null;
  var Fo = (e) => e != null && e > 0;
  var un = Ro(zo);
  var Sr = Ro(Fo);
  function _r(e, i, o, n66 = 0, s = false) {
    let a = s ? Sr : un, u = s ? Fo : zo;
    [i, o] = a(e, i, o);
    let h = e[i], m = e[i];
    if (i > -1) if (n66 == 1) h = e[i], m = e[o];
    else if (n66 == -1) h = e[o], m = e[i];
    else for (let d = i; d <= o; d++) {
      let y = e[d];
      u(y) && (y < h ? h = y : y > m && (m = y));
    }
    return [h ?? ce, m ?? -ce];
  }
  function cn(e, i, o, n66) {
    let s = fo(e), a = fo(i);
    e == i && (s == -1 ? (e *= o, i /= o) : (e /= o, i *= o));
    let u = o == 10 ? Pt : Oo, h = s == 1 ? et : ut, m = a == 1 ? ut : et, d = h(u(Ee(e))), y = m(u(Ee(i))), g = xl(o, d), w = xl(o, y);
    return o == 10 && (d < 0 && (g = ae(g, -d)), y < 0 && (w = ae(w, -y))), n66 || o == 2 ? (e = g * s, i = w * a) : (e = Go(e, g), i = an(i, w)), [e, i];
  }
  function si(e, i, o, n66) {
    let s = cn(e, i, o, n66);
    return e == 0 && (s[0] = 0), i == 0 && (s[1] = 0), s;
  }
  var ri = 0.1;
  var so = { mode: 3, pad: ri };
  var Il = { pad: 0, soft: null, mode: 0 };
  var yr = { min: Il, max: Il };
  function rn(e, i, o, n66) {
    return pn(o) ? ro(e, i, o) : (Il.pad = o, Il.soft = n66 ? 0 : null, Il.mode = n66 ? 3 : 0, ro(e, i, yr));
  }
  function ne(e, i) {
    return e ?? i;
  }
  function vr(e, i, o) {
    for (i = ne(i, 0), o = ne(o, e.length - 1); i <= o; ) {
      if (e[i] != null) return true;
      i++;
    }
    return false;
  }
  function ro(e, i, o) {
    let n66 = o.min, s = o.max, a = ne(n66.pad, 0), u = ne(s.pad, 0), h = ne(n66.hard, -ce), m = ne(s.hard, ce), d = ne(n66.soft, ce), y = ne(s.soft, -ce), g = ne(n66.mode, 0), w = ne(s.mode, 0), L2 = i - e, D = Pt(L2), O2 = Be(Ee(e), Ee(i)), N = Pt(O2), G2 = Ee(N - D);
    (L2 < 1e-24 || G2 > 10) && (L2 = 0, (e == 0 || i == 0) && (L2 = 1e-24, g == 2 && d != ce && (a = 0), w == 2 && y != -ce && (u = 0)));
    let k = L2 || O2 || 1e3, H2 = Pt(k), x2 = xl(10, et(H2)), q = k * (L2 == 0 ? e == 0 ? 0.1 : 1 : a), P4 = ae(Go(e - q, x2 / 10), 24), $2 = e >= d && (g == 1 || g == 3 && P4 <= d || g == 2 && P4 >= d) ? d : ce, U = Be(h, P4 < $2 && e >= $2 ? $2 : wt($2, P4)), Q2 = k * (L2 == 0 ? i == 0 ? 0.1 : 1 : u), B = ae(an(i + Q2, x2 / 10), 24), T2 = i <= y && (w == 1 || w == 3 && B >= y || w == 2 && B <= y) ? y : -ce, j2 = wt(m, B > T2 && i <= T2 ? T2 : Be(T2, B));
    return U == j2 && U == 0 && (j2 = 100), [U, j2];
  }
  var kr = new Intl.NumberFormat(Al ? gr.language : "en-US");
  var fi = (e) => kr.format(e);
  var tt = Math;
  var on = tt.PI;
  var Ee = tt.abs;
  var et = tt.floor;
  var Ae = tt.round;
  var ut = tt.ceil;
  var wt = tt.min;
  var Be = tt.max;
  var xl = tt.pow;
  var fo = tt.sign;
  var Pt = tt.log10;
  var Oo = tt.log2;
  var xr = (e, i = 1) => tt.sinh(e) * i;
  var Yn = (e, i = 1) => tt.asinh(e / i);
  var ce = 1 / 0;
  function uo(e) {
    return (Pt((e ^ e >> 31) - (e >> 31)) | 0) + 1;
  }
  function Zn(e, i, o) {
    return wt(Be(e, i), o);
  }
  function Ho(e) {
    return typeof e == "function";
  }
  function X(e) {
    return Ho(e) ? e : () => e;
  }
  var Tr = () => {
  };
  var No = (e) => e;
  var Wo = (e, i) => i;
  var br = (e) => null;
  var co = (e) => true;
  var ao = (e, i) => e == i;
  var Mr = /\.\d*?(?=9{6,}|0{6,})/gm;
  var Xt = (e) => {
    if (Yo(e) || Ht.has(e)) return e;
    let i = `${e}`, o = i.match(Mr);
    if (o == null) return e;
    let n66 = o[0].length - 1;
    if (i.indexOf("e-") != -1) {
      let [s, a] = i.split("e");
      return +`${Xt(s)}e${a}`;
    }
    return ae(e, n66);
  };
  function $t(e, i) {
    return Xt(ae(Xt(e / i)) * i);
  }
  function an(e, i) {
    return Xt(ut(Xt(e / i)) * i);
  }
  function Go(e, i) {
    return Xt(et(Xt(e / i)) * i);
  }
  function ae(e, i = 0) {
    if (Yo(e)) return e;
    let o = 10 ** i, n66 = e * o * (1 + Number.EPSILON);
    return Ae(n66) / o;
  }
  var Ht = /* @__PURE__ */ new Map();
  function Io(e) {
    return (("" + e).split(".")[1] || "").length;
  }
  function Bl(e, i, o, n66) {
    let s = [], a = n66.map(Io);
    for (let u = i; u < o; u++) {
      let h = Ee(u), m = ae(xl(e, u), h);
      for (let d = 0; d < n66.length; d++) {
        let y = e == 10 ? +`${n66[d]}e${u}` : n66[d] * m, g = (u >= 0 ? 0 : h) + (u >= a[d] ? 0 : a[d]), w = e == 10 ? y : ae(y, g);
        s.push(w), Ht.set(w, g);
      }
    }
    return s;
  }
  var Yl = {};
  var ui = [];
  var Tl = [null, null];
  var Ot = Array.isArray;
  var Yo = Number.isInteger;
  var Ar = (e) => e === void 0;
  function po(e) {
    return typeof e == "string";
  }
  function pn(e) {
    let i = false;
    if (e != null) {
      let o = e.constructor;
      i = o == null || o == Object;
    }
    return i;
  }
  function Er(e) {
    return e != null && typeof e == "object";
  }
  var Pr = Object.getPrototypeOf(Uint8Array);
  var Bo = "__proto__";
  function bl(e, i = pn) {
    let o;
    if (Ot(e)) {
      let n66 = e.find((s) => s != null);
      if (Ot(n66) || i(n66)) {
        o = Array(e.length);
        for (let s = 0; s < e.length; s++) o[s] = bl(e[s], i);
      } else o = e.slice();
    } else if (e instanceof Pr) o = e.slice();
    else if (i(e)) {
      o = {};
      for (let n66 in e) n66 != Bo && (o[n66] = bl(e[n66], i));
    } else o = e;
    return o;
  }
  function Te(e) {
    let i = arguments;
    for (let o = 1; o < i.length; o++) {
      let n66 = i[o];
      for (let s in n66) s != Bo && (pn(e[s]) ? Te(e[s], bl(n66[s])) : e[s] = bl(n66[s]));
    }
    return e;
  }
  var Dr = 0;
  var Lr = 1;
  var Cr = 2;
  function Vr(e, i, o) {
    for (let n66 = 0, s, a = -1; n66 < i.length; n66++) {
      let u = i[n66];
      if (u > a) {
        for (s = u - 1; s >= 0 && e[s] == null; ) e[s--] = null;
        for (s = u + 1; s < o && e[s] == null; ) e[a = s++] = null;
      }
    }
  }
  function Rr(e, i) {
    if (Or(e)) {
      let u = e[0].slice();
      for (let h = 1; h < e.length; h++) u.push(...e[h].slice(1));
      return Hr(u[0]) || (u = Fr(u)), u;
    }
    let o = /* @__PURE__ */ new Set();
    for (let u = 0; u < e.length; u++) {
      let m = e[u][0], d = m.length;
      for (let y = 0; y < d; y++) o.add(m[y]);
    }
    let n66 = [Array.from(o).sort((u, h) => u - h)], s = n66[0].length, a = /* @__PURE__ */ new Map();
    for (let u = 0; u < s; u++) a.set(n66[0][u], u);
    for (let u = 0; u < e.length; u++) {
      let h = e[u], m = h[0];
      for (let d = 1; d < h.length; d++) {
        let y = h[d], g = Array(s).fill(void 0), w = i ? i[u][d] : Lr, L2 = [];
        for (let D = 0; D < y.length; D++) {
          let O2 = y[D], N = a.get(m[D]);
          O2 === null ? w != Dr && (g[N] = O2, w == Cr && L2.push(N)) : g[N] = O2;
        }
        Vr(g, L2, s), n66.push(g);
      }
    }
    return n66;
  }
  var zr = typeof queueMicrotask > "u" ? (e) => Promise.resolve().then(e) : queueMicrotask;
  function Fr(e) {
    let i = e[0], o = i.length, n66 = Array(o);
    for (let a = 0; a < n66.length; a++) n66[a] = a;
    n66.sort((a, u) => i[a] - i[u]);
    let s = [];
    for (let a = 0; a < e.length; a++) {
      let u = e[a], h = Array(o);
      for (let m = 0; m < o; m++) h[m] = u[n66[m]];
      s.push(h);
    }
    return s;
  }
  function Or(e) {
    let i = e[0][0], o = i.length;
    for (let n66 = 1; n66 < e.length; n66++) {
      let s = e[n66][0];
      if (s.length != o) return false;
      if (s != i) {
        for (let a = 0; a < o; a++) if (s[a] != i[a]) return false;
      }
    }
    return true;
  }
  function Hr(e, i = 100) {
    let o = e.length;
    if (o <= 1) return true;
    let n66 = 0, s = o - 1;
    for (; n66 <= s && e[n66] == null; ) n66++;
    for (; s >= n66 && e[s] == null; ) s--;
    if (s <= n66) return true;
    let a = Be(1, et((s - n66 + 1) / i));
    for (let u = e[n66], h = n66 + a; h <= s; h += a) {
      let m = e[h];
      if (m != null) {
        if (m <= u) return false;
        u = m;
      }
    }
    return true;
  }
  var Uo = ["January", "February", "March", "April", "May", "June", "July", "August", "September", "October", "November", "December"];
  var Ko = ["Sunday", "Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday"];
  function jo(e) {
    return e.slice(0, 3);
  }
  var Nr = Ko.map(jo);
  var Wr = Uo.map(jo);
  var Gr = { MMMM: Uo, MMM: Wr, WWWW: Ko, WWW: Nr };
  function Hl(e) {
    return (e < 10 ? "0" : "") + e;
  }
  function Ir(e) {
    return (e < 10 ? "00" : e < 100 ? "0" : "") + e;
  }
  var Yr = { YYYY: (e) => e.getFullYear(), YY: (e) => (e.getFullYear() + "").slice(2), MMMM: (e, i) => i.MMMM[e.getMonth()], MMM: (e, i) => i.MMM[e.getMonth()], MM: (e) => Hl(e.getMonth() + 1), M: (e) => e.getMonth() + 1, DD: (e) => Hl(e.getDate()), D: (e) => e.getDate(), WWWW: (e, i) => i.WWWW[e.getDay()], WWW: (e, i) => i.WWW[e.getDay()], HH: (e) => Hl(e.getHours()), H: (e) => e.getHours(), h: (e) => {
    let i = e.getHours();
    return i == 0 ? 12 : i > 12 ? i - 12 : i;
  }, AA: (e) => e.getHours() >= 12 ? "PM" : "AM", aa: (e) => e.getHours() >= 12 ? "pm" : "am", a: (e) => e.getHours() >= 12 ? "p" : "a", mm: (e) => Hl(e.getMinutes()), m: (e) => e.getMinutes(), ss: (e) => Hl(e.getSeconds()), s: (e) => e.getSeconds(), fff: (e) => Ir(e.getMilliseconds()) };
  function ci(e, i) {
    i = i || Gr;
    let o = [], n66 = /\{([a-z]+)\}|[^{]+/gi, s;
    for (; s = n66.exec(e); ) o.push(s[0][0] == "{" ? Yr[s[1]] : s[0]);
    return (a) => {
      let u = "";
      for (let h = 0; h < o.length; h++) u += typeof o[h] == "string" ? o[h] : o[h](a, i);
      return u;
    };
  }
  var Br = new Intl.DateTimeFormat().resolvedOptions().timeZone;
  function Ur(e, i) {
    let o;
    return i == "UTC" || i == "Etc/UTC" ? o = new Date(+e + e.getTimezoneOffset() * 6e4) : i == Br ? o = e : (o = new Date(e.toLocaleString("en-US", { timeZone: i })), o.setMilliseconds(e.getMilliseconds())), o;
  }
  var qo = (e) => e % 1 == 0;
  var fn = [1, 2, 2.5, 5];
  var Kr = Bl(10, -32, 0, fn);
  var $o = Bl(10, 0, 32, fn);
  var jr = $o.filter(qo);
  var Jt = Kr.concat($o);
  var ai = `
`;
  var Jo = "{YYYY}";
  var ho = ai + Jo;
  var Zo = "{M}/{D}";
  var Gl = ai + Zo;
  var ln = Gl + "/{YY}";
  var Qo = "{aa}";
  var qr = "{h}:{mm}";
  var vl = qr + Qo;
  var mo = ai + vl;
  var go = ":{ss}";
  var re = null;
  function Xo(e) {
    let i = e * 1e3, o = i * 60, n66 = o * 60, s = n66 * 24, a = s * 30, u = s * 365, m = (e == 1 ? Bl(10, 0, 3, fn).filter(qo) : Bl(10, -3, 0, fn)).concat([i, i * 5, i * 10, i * 15, i * 30, o, o * 5, o * 10, o * 15, o * 30, n66, n66 * 2, n66 * 3, n66 * 4, n66 * 6, n66 * 8, n66 * 12, s, s * 2, s * 3, s * 4, s * 5, s * 6, s * 7, s * 8, s * 9, s * 10, s * 15, a, a * 2, a * 3, a * 4, a * 6, u, u * 2, u * 5, u * 10, u * 25, u * 50, u * 100]), d = [[u, Jo, re, re, re, re, re, re, 1], [s * 28, "{MMM}", ho, re, re, re, re, re, 1], [s, Zo, ho, re, re, re, re, re, 1], [n66, "{h}" + Qo, ln, re, Gl, re, re, re, 1], [o, vl, ln, re, Gl, re, re, re, 1], [i, go, ln + " " + vl, re, Gl + " " + vl, re, mo, re, 1], [e, go + ".{fff}", ln + " " + vl, re, Gl + " " + vl, re, mo, re, 1]];
    function y(g) {
      return (w, L2, D, O2, N, G2) => {
        let k = [], H2 = N >= u, x2 = N >= a && N < u, q = g(D), P4 = ae(q * e, 3), $2 = Bn(q.getFullYear(), H2 ? 0 : q.getMonth(), x2 || H2 ? 1 : q.getDate()), U = ae($2 * e, 3);
        if (x2 || H2) {
          let Q2 = x2 ? N / a : 0, B = H2 ? N / u : 0, T2 = P4 == U ? P4 : ae(Bn($2.getFullYear() + B, $2.getMonth() + Q2, 1) * e, 3), j2 = new Date(Ae(T2 / e)), C2 = j2.getFullYear(), I = j2.getMonth();
          for (let F2 = 0; T2 <= O2; F2++) {
            let ee2 = Bn(C2 + B * F2, I + Q2 * F2, 1), z2 = ee2 - g(ae(ee2 * e, 3));
            T2 = ae((+ee2 + z2) * e, 3), T2 <= O2 && k.push(T2);
          }
        } else {
          let Q2 = N >= s ? s : N, B = et(D) - et(P4), T2 = U + B + an(P4 - U, Q2);
          k.push(T2);
          let j2 = g(T2), C2 = j2.getHours() + j2.getMinutes() / o + j2.getSeconds() / n66, I = N / n66, F2 = w.axes[L2]._space, ee2 = G2 / F2;
          for (; T2 = ae(T2 + N, e == 1 ? 0 : 3), !(T2 > O2); ) if (I > 1) {
            let z2 = et(ae(C2 + I, 6)) % 24, te2 = g(T2).getHours() - z2;
            te2 > 1 && (te2 = -1), T2 -= te2 * n66, C2 = (C2 + I) % 24;
            let fe2 = k[k.length - 1];
            ae((T2 - fe2) / N, 3) * ee2 >= 0.7 && k.push(T2);
          } else k.push(T2);
        }
        return k;
      };
    }
    return [m, d, y];
  }
  var [$r, Jr, Zr] = Xo(1);
  var [Qr, Xr, ef] = Xo(1e-3);
  Bl(2, -53, 53, [1]);
  function wo(e, i) {
    return e.map((o) => o.map((n66, s) => s == 0 || s == 8 || n66 == null ? n66 : i(s == 1 || o[8] == 0 ? n66 : o[1] + n66)));
  }
  function So(e, i) {
    return (o, n66, s, a, u) => {
      let h = i.find((D) => u >= D[0]) || i[i.length - 1], m, d, y, g, w, L2;
      return n66.map((D) => {
        let O2 = e(D), N = O2.getFullYear(), G2 = O2.getMonth(), k = O2.getDate(), H2 = O2.getHours(), x2 = O2.getMinutes(), q = O2.getSeconds(), P4 = N != m && h[2] || G2 != d && h[3] || k != y && h[4] || H2 != g && h[5] || x2 != w && h[6] || q != L2 && h[7] || h[1];
        return m = N, d = G2, y = k, g = H2, w = x2, L2 = q, P4(O2);
      });
    };
  }
  function tf(e, i) {
    let o = ci(i);
    return (n66, s, a, u, h) => s.map((m) => o(e(m)));
  }
  function Bn(e, i, o) {
    return new Date(e, i, o);
  }
  function _o(e, i) {
    return i(e);
  }
  var lf = "{YYYY}-{MM}-{DD} {h}:{mm}{aa}";
  function yo(e, i) {
    return (o, n66, s, a) => a == null ? ii : i(e(n66));
  }
  function nf(e, i) {
    let o = e.series[i];
    return o.width ? o.stroke(e, i) : o.points.width ? o.points.stroke(e, i) : null;
  }
  function of(e, i) {
    return e.series[i].fill(e, i);
  }
  var sf = { show: true, live: true, isolate: false, mount: Tr, markers: { show: true, width: 2, stroke: nf, fill: of, dash: "solid" }, idx: null, idxs: null, values: [] };
  function rf(e, i) {
    let o = e.cursor.points, n66 = ft(), s = o.size(e, i);
    ge(n66, Nl, s), ge(n66, Wl, s);
    let a = s / -2;
    ge(n66, "marginLeft", a), ge(n66, "marginTop", a);
    let u = o.width(e, i, s);
    return u && ge(n66, "borderWidth", u), n66;
  }
  function ff(e, i) {
    let o = e.series[i].points;
    return o._fill || o._stroke;
  }
  function uf(e, i) {
    let o = e.series[i].points;
    return o._stroke || o._fill;
  }
  function cf(e, i) {
    return e.series[i].points.size;
  }
  var Un = [0, 0];
  function af(e, i, o) {
    return Un[0] = i, Un[1] = o, Un;
  }
  function nn(e, i, o, n66 = true) {
    return (s) => {
      s.button == 0 && (!n66 || s.target == i) && o(s);
    };
  }
  function Kn(e, i, o, n66 = true) {
    return (s) => {
      (!n66 || s.target == i) && o(s);
    };
  }
  var pf = { show: true, x: true, y: true, lock: false, move: af, points: { one: false, show: rf, size: cf, width: 0, stroke: uf, fill: ff }, bind: { mousedown: nn, mouseup: nn, click: nn, dblclick: nn, mousemove: Kn, mouseleave: Kn, mouseenter: Kn }, drag: { setScale: true, x: true, y: false, dist: 0, uni: null, click: (e, i) => {
    i.stopPropagation(), i.stopImmediatePropagation();
  }, _x: false, _y: false }, focus: { dist: (e, i, o, n66, s) => n66 - s, prox: -1, bias: 0 }, hover: { skip: [void 0], prox: null, bias: 0 }, left: -10, top: -10, idx: null, dataIdx: null, idxs: null, event: null };
  var es = { show: true, stroke: "rgba(0,0,0,0.07)", width: 2 };
  var pi = Te({}, es, { filter: Wo });
  var ts = Te({}, pi, { size: 10 });
  var ls = Te({}, es, { show: false });
  var hi = '12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"';
  var ns = "bold " + hi;
  var is = 1.5;
  var vo = { show: true, scale: "x", stroke: ni, space: 50, gap: 5, alignTo: 1, size: 50, labelGap: 0, labelSize: 30, labelFont: ns, side: 2, grid: pi, ticks: ts, border: ls, font: hi, lineGap: is, rotate: 0 };
  var hf = "Value";
  var mf = "Time";
  var ko = { show: true, scale: "x", auto: false, sorted: 1, min: ce, max: -ce, idxs: [] };
  function df(e, i, o, n66, s) {
    return i.map((a) => a == null ? "" : fi(a));
  }
  function gf(e, i, o, n66, s, a, u) {
    let h = [], m = Ht.get(s) || 0;
    o = u ? o : ae(an(o, s), m);
    for (let d = o; d <= n66; d = ae(d + s, m)) h.push(Object.is(d, -0) ? 0 : d);
    return h;
  }
  function Qn(e, i, o, n66, s, a, u) {
    let h = [], m = e.scales[e.axes[i].scale].log, d = m == 10 ? Pt : Oo, y = et(d(o));
    s = xl(m, y), m == 10 && (s = Jt[gt(s, Jt)]);
    let g = o, w = s * m;
    m == 10 && (w = Jt[gt(w, Jt)]);
    do
      h.push(g), g = g + s, m == 10 && !Ht.has(g) && (g = ae(g, Ht.get(s))), g >= w && (s = g, w = s * m, m == 10 && (w = Jt[gt(w, Jt)]));
    while (g <= n66);
    return h;
  }
  function wf(e, i, o, n66, s, a, u) {
    let m = e.scales[e.axes[i].scale].asinh, d = n66 > m ? Qn(e, i, Be(m, o), n66, s) : [m], y = n66 >= 0 && o <= 0 ? [0] : [];
    return (o < -m ? Qn(e, i, Be(m, -n66), -o, s) : [m]).reverse().map((w) => -w).concat(y, d);
  }
  var os = /./;
  var Sf = /[12357]/;
  var _f = /[125]/;
  var xo = /1/;
  var Xn = (e, i, o, n66) => e.map((s, a) => i == 4 && s == 0 || a % n66 == 0 && o.test(s.toExponential()[s < 0 ? 1 : 0]) ? s : null);
  function yf(e, i, o, n66, s) {
    let a = e.axes[o], u = a.scale, h = e.scales[u], m = e.valToPos, d = a._space, y = m(10, u), g = m(9, u) - y >= d ? os : m(7, u) - y >= d ? Sf : m(5, u) - y >= d ? _f : xo;
    if (g == xo) {
      let w = Ee(m(1, u) - y);
      if (w < d) return Xn(i.slice().reverse(), h.distr, g, ut(d / w)).reverse();
    }
    return Xn(i, h.distr, g, 1);
  }
  function vf(e, i, o, n66, s) {
    let a = e.axes[o], u = a.scale, h = a._space, m = e.valToPos, d = Ee(m(1, u) - m(2, u));
    return d < h ? Xn(i.slice().reverse(), 3, os, ut(h / d)).reverse() : i;
  }
  function kf(e, i, o, n66) {
    return n66 == null ? ii : i == null ? "" : fi(i);
  }
  var To = { show: true, scale: "y", stroke: ni, space: 30, gap: 5, alignTo: 1, size: 50, labelGap: 0, labelSize: 30, labelFont: ns, side: 3, grid: pi, ticks: ts, border: ls, font: hi, lineGap: is, rotate: 0 };
  function xf(e, i) {
    let o = 3 + (e || 1) * 2;
    return ae(o * i, 3);
  }
  function Tf(e, i) {
    let { scale: o, idxs: n66 } = e.series[0], s = e._data[0], a = e.valToPos(s[n66[0]], o, true), u = e.valToPos(s[n66[1]], o, true), h = Ee(u - a), m = e.series[i], d = h / (m.points.space * oe);
    return n66[1] - n66[0] <= d;
  }
  var bo = { scale: null, auto: true, sorted: 0, min: ce, max: -ce };
  var ss = (e, i, o, n66, s) => s;
  var Mo = { show: true, auto: true, sorted: 0, gaps: ss, alpha: 1, facets: [Te({}, bo, { scale: "x" }), Te({}, bo, { scale: "y" })] };
  var Ao = { scale: "y", auto: true, sorted: 0, show: true, spanGaps: false, gaps: ss, alpha: 1, points: { show: Tf, filter: null }, values: null, min: ce, max: -ce, idxs: [], path: null, clip: null };
  function bf(e, i, o, n66, s) {
    return o / 10;
  }
  var rs = { time: true, auto: true, distr: 1, log: 10, asinh: 1, min: null, max: null, dir: 1, ori: 0 };
  var Mf = Te({}, rs, { time: false, ori: 1 });
  var Eo = {};
  function fs(e, i) {
    let o = Eo[e];
    return o || (o = { key: e, plots: [], sub(n66) {
      o.plots.push(n66);
    }, unsub(n66) {
      o.plots = o.plots.filter((s) => s != n66);
    }, pub(n66, s, a, u, h, m, d) {
      for (let y = 0; y < o.plots.length; y++) o.plots[y] != s && o.plots[y].pub(n66, s, a, u, h, m, d);
    } }, e != null && (Eo[e] = o)), o;
  }
  var Ml = 1;
  var ei = 2;
  function el2(e, i, o) {
    let n66 = e.mode, s = e.series[i], a = n66 == 2 ? e._data[i] : e._data, u = e.scales, h = e.bbox, m = a[0], d = n66 == 2 ? a[1] : a[i], y = n66 == 2 ? u[s.facets[0].scale] : u[e.series[0].scale], g = n66 == 2 ? u[s.facets[1].scale] : u[s.scale], w = h.left, L2 = h.top, D = h.width, O2 = h.height, N = e.valToPosH, G2 = e.valToPosV;
    return y.ori == 0 ? o(s, m, d, y, g, N, G2, w, L2, D, O2, mn, El, gn, cs, ps) : o(s, m, d, y, g, G2, N, L2, w, O2, D, dn, Pl, gi, as, hs);
  }
  function mi(e, i) {
    let o = 0, n66 = 0, s = ne(e.bands, ui);
    for (let a = 0; a < s.length; a++) {
      let u = s[a];
      u.series[0] == i ? o = u.dir : u.series[1] == i && (u.dir == 1 ? n66 |= 1 : n66 |= 2);
    }
    return [o, n66 == 1 ? -1 : n66 == 2 ? 1 : n66 == 3 ? 2 : 0];
  }
  function Af(e, i, o, n66, s) {
    let a = e.mode, u = e.series[i], h = a == 2 ? u.facets[1].scale : u.scale, m = e.scales[h];
    return s == -1 ? m.min : s == 1 ? m.max : m.distr == 3 ? m.dir == 1 ? m.min : m.max : 0;
  }
  function Dt(e, i, o, n66, s, a) {
    return el2(e, i, (u, h, m, d, y, g, w, L2, D, O2, N) => {
      let G2 = u.pxRound, k = d.dir * (d.ori == 0 ? 1 : -1), H2 = d.ori == 0 ? El : Pl, x2, q;
      k == 1 ? (x2 = o, q = n66) : (x2 = n66, q = o);
      let P4 = G2(g(h[x2], d, O2, L2)), $2 = G2(w(m[x2], y, N, D)), U = G2(g(h[q], d, O2, L2)), Q2 = G2(w(a == 1 ? y.max : y.min, y, N, D)), B = new Path2D(s);
      return H2(B, U, Q2), H2(B, P4, Q2), H2(B, P4, $2), B;
    });
  }
  function hn(e, i, o, n66, s, a) {
    let u = null;
    if (e.length > 0) {
      u = new Path2D();
      let h = i == 0 ? gn : gi, m = o;
      for (let g = 0; g < e.length; g++) {
        let w = e[g];
        if (w[1] > w[0]) {
          let L2 = w[0] - m;
          L2 > 0 && h(u, m, n66, L2, n66 + a), m = w[1];
        }
      }
      let d = o + s - m, y = 10;
      d > 0 && h(u, m, n66 - y / 2, d, n66 + a + y);
    }
    return u;
  }
  function Ef(e, i, o) {
    let n66 = e[e.length - 1];
    n66 && n66[0] == i ? n66[1] = o : e.push([i, o]);
  }
  function di(e, i, o, n66, s, a, u) {
    let h = [], m = e.length;
    for (let d = s == 1 ? o : n66; d >= o && d <= n66; d += s) if (i[d] === null) {
      let g = d, w = d;
      if (s == 1) for (; ++d <= n66 && i[d] === null; ) w = d;
      else for (; --d >= o && i[d] === null; ) w = d;
      let L2 = a(e[g]), D = w == g ? L2 : a(e[w]), O2 = g - s;
      L2 = u <= 0 && O2 >= 0 && O2 < m ? a(e[O2]) : L2;
      let G2 = w + s;
      D = u >= 0 && G2 >= 0 && G2 < m ? a(e[G2]) : D, D >= L2 && h.push([L2, D]);
    }
    return h;
  }
  function Po(e) {
    return e == 0 ? No : e == 1 ? Ae : (i) => $t(i, e);
  }
  function us(e) {
    let i = e == 0 ? mn : dn, o = e == 0 ? (s, a, u, h, m, d) => {
      s.arcTo(a, u, h, m, d);
    } : (s, a, u, h, m, d) => {
      s.arcTo(u, a, m, h, d);
    }, n66 = e == 0 ? (s, a, u, h, m) => {
      s.rect(a, u, h, m);
    } : (s, a, u, h, m) => {
      s.rect(u, a, m, h);
    };
    return (s, a, u, h, m, d = 0, y = 0) => {
      d == 0 && y == 0 ? n66(s, a, u, h, m) : (d = wt(d, h / 2, m / 2), y = wt(y, h / 2, m / 2), i(s, a + d, u), o(s, a + h, u, a + h, u + m, d), o(s, a + h, u + m, a, u + m, y), o(s, a, u + m, a, u, y), o(s, a, u, a + h, u, d), s.closePath());
    };
  }
  var mn = (e, i, o) => {
    e.moveTo(i, o);
  };
  var dn = (e, i, o) => {
    e.moveTo(o, i);
  };
  var El = (e, i, o) => {
    e.lineTo(i, o);
  };
  var Pl = (e, i, o) => {
    e.lineTo(o, i);
  };
  var gn = us(0);
  var gi = us(1);
  var cs = (e, i, o, n66, s, a) => {
    e.arc(i, o, n66, s, a);
  };
  var as = (e, i, o, n66, s, a) => {
    e.arc(o, i, n66, s, a);
  };
  var ps = (e, i, o, n66, s, a, u) => {
    e.bezierCurveTo(i, o, n66, s, a, u);
  };
  var hs = (e, i, o, n66, s, a, u) => {
    e.bezierCurveTo(o, i, s, n66, u, a);
  };
  function ms(e) {
    return (i, o, n66, s, a) => el2(i, o, (u, h, m, d, y, g, w, L2, D, O2, N) => {
      let { pxRound: G2, points: k } = u, H2, x2;
      d.ori == 0 ? (H2 = mn, x2 = cs) : (H2 = dn, x2 = as);
      let q = ae(k.width * oe, 3), P4 = (k.size - k.width) / 2 * oe, $2 = ae(P4 * 2, 3), U = new Path2D(), Q2 = new Path2D(), { left: B, top: T2, width: j2, height: C2 } = i.bbox;
      gn(Q2, B - $2, T2 - $2, j2 + $2 * 2, C2 + $2 * 2);
      let I = (F2) => {
        if (m[F2] != null) {
          let ee2 = G2(g(h[F2], d, O2, L2)), z2 = G2(w(m[F2], y, N, D));
          H2(U, ee2 + P4, z2), x2(U, ee2, z2, P4, 0, on * 2);
        }
      };
      if (a) a.forEach(I);
      else for (let F2 = n66; F2 <= s; F2++) I(F2);
      return { stroke: q > 0 ? U : null, fill: U, clip: Q2, flags: Ml | ei };
    });
  }
  function ds(e) {
    return (i, o, n66, s, a, u) => {
      n66 != s && (a != n66 && u != n66 && e(i, o, n66), a != s && u != s && e(i, o, s), e(i, o, u));
    };
  }
  var Pf = ds(El);
  var Df = ds(Pl);
  function gs(e) {
    let i = ne(e?.alignGaps, 0);
    return (o, n66, s, a) => el2(o, n66, (u, h, m, d, y, g, w, L2, D, O2, N) => {
      [s, a] = un(m, s, a);
      let G2 = u.pxRound, k = (C2) => G2(g(C2, d, O2, L2)), H2 = (C2) => G2(w(C2, y, N, D)), x2, q;
      d.ori == 0 ? (x2 = El, q = Pf) : (x2 = Pl, q = Df);
      let P4 = d.dir * (d.ori == 0 ? 1 : -1), $2 = { stroke: new Path2D(), fill: null, clip: null, band: null, gaps: null, flags: Ml }, U = $2.stroke, Q2 = false;
      if (a - s >= O2 * 4) {
        let C2 = (V2) => o.posToVal(V2, d.key, true), I = null, F2 = null, ee2, z2, Ue2, we = k(h[P4 == 1 ? s : a]), te2 = k(h[s]), fe2 = k(h[a]), J2 = C2(P4 == 1 ? te2 + 1 : fe2 - 1);
        for (let V2 = P4 == 1 ? s : a; V2 >= s && V2 <= a; V2 += P4) {
          let be2 = h[V2], Se2 = (P4 == 1 ? be2 < J2 : be2 > J2) ? we : k(be2), se2 = m[V2];
          Se2 == we ? se2 != null ? (z2 = se2, I == null ? (x2(U, Se2, H2(z2)), ee2 = I = F2 = z2) : z2 < I ? I = z2 : z2 > F2 && (F2 = z2)) : se2 === null && (Q2 = true) : (I != null && q(U, we, H2(I), H2(F2), H2(ee2), H2(z2)), se2 != null ? (z2 = se2, x2(U, Se2, H2(z2)), I = F2 = ee2 = z2) : (I = F2 = null, se2 === null && (Q2 = true)), we = Se2, J2 = C2(we + P4));
        }
        I != null && I != F2 && Ue2 != we && q(U, we, H2(I), H2(F2), H2(ee2), H2(z2));
      } else for (let C2 = P4 == 1 ? s : a; C2 >= s && C2 <= a; C2 += P4) {
        let I = m[C2];
        I === null ? Q2 = true : I != null && x2(U, k(h[C2]), H2(I));
      }
      let [T2, j2] = mi(o, n66);
      if (u.fill != null || T2 != 0) {
        let C2 = $2.fill = new Path2D(U), I = u.fillTo(o, n66, u.min, u.max, T2), F2 = H2(I), ee2 = k(h[s]), z2 = k(h[a]);
        P4 == -1 && ([z2, ee2] = [ee2, z2]), x2(C2, z2, F2), x2(C2, ee2, F2);
      }
      if (!u.spanGaps) {
        let C2 = [];
        Q2 && C2.push(...di(h, m, s, a, P4, k, i)), $2.gaps = C2 = u.gaps(o, n66, s, a, C2), $2.clip = hn(C2, d.ori, L2, D, O2, N);
      }
      return j2 != 0 && ($2.band = j2 == 2 ? [Dt(o, n66, s, a, U, -1), Dt(o, n66, s, a, U, 1)] : Dt(o, n66, s, a, U, j2)), $2;
    });
  }
  function Lf(e) {
    let i = ne(e.align, 1), o = ne(e.ascDesc, false), n66 = ne(e.alignGaps, 0), s = ne(e.extend, false);
    return (a, u, h, m) => el2(a, u, (d, y, g, w, L2, D, O2, N, G2, k, H2) => {
      [h, m] = un(g, h, m);
      let x2 = d.pxRound, { left: q, width: P4 } = a.bbox, $2 = (te2) => x2(D(te2, w, k, N)), U = (te2) => x2(O2(te2, L2, H2, G2)), Q2 = w.ori == 0 ? El : Pl, B = { stroke: new Path2D(), fill: null, clip: null, band: null, gaps: null, flags: Ml }, T2 = B.stroke, j2 = w.dir * (w.ori == 0 ? 1 : -1), C2 = U(g[j2 == 1 ? h : m]), I = $2(y[j2 == 1 ? h : m]), F2 = I, ee2 = I;
      s && i == -1 && (ee2 = q, Q2(T2, ee2, C2)), Q2(T2, I, C2);
      for (let te2 = j2 == 1 ? h : m; te2 >= h && te2 <= m; te2 += j2) {
        let fe2 = g[te2];
        if (fe2 == null) continue;
        let J2 = $2(y[te2]), V2 = U(fe2);
        i == 1 ? Q2(T2, J2, C2) : Q2(T2, F2, V2), Q2(T2, J2, V2), C2 = V2, F2 = J2;
      }
      let z2 = F2;
      s && i == 1 && (z2 = q + P4, Q2(T2, z2, C2));
      let [Ue2, we] = mi(a, u);
      if (d.fill != null || Ue2 != 0) {
        let te2 = B.fill = new Path2D(T2), fe2 = d.fillTo(a, u, d.min, d.max, Ue2), J2 = U(fe2);
        Q2(te2, z2, J2), Q2(te2, ee2, J2);
      }
      if (!d.spanGaps) {
        let te2 = [];
        te2.push(...di(y, g, h, m, j2, $2, n66));
        let fe2 = d.width * oe / 2, J2 = o || i == 1 ? fe2 : -fe2, V2 = o || i == -1 ? -fe2 : fe2;
        te2.forEach((be2) => {
          be2[0] += J2, be2[1] += V2;
        }), B.gaps = te2 = d.gaps(a, u, h, m, te2), B.clip = hn(te2, w.ori, N, G2, k, H2);
      }
      return we != 0 && (B.band = we == 2 ? [Dt(a, u, h, m, T2, -1), Dt(a, u, h, m, T2, 1)] : Dt(a, u, h, m, T2, we)), B;
    });
  }
  function Do(e, i, o, n66, s, a, u = ce) {
    if (e.length > 1) {
      let h = null;
      for (let m = 0, d = 1 / 0; m < e.length; m++) if (i[m] !== void 0) {
        if (h != null) {
          let y = Ee(e[m] - e[h]);
          y < d && (d = y, u = Ee(o(e[m], n66, s, a) - o(e[h], n66, s, a)));
        }
        h = m;
      }
    }
    return u;
  }
  function Cf(e) {
    e = e || Yl;
    let i = ne(e.size, [0.6, ce, 1]), o = e.align || 0, n66 = e.gap || 0, s = e.radius;
    s = s == null ? [0, 0] : typeof s == "number" ? [s, 0] : s;
    let a = X(s), u = 1 - i[0], h = ne(i[1], ce), m = ne(i[2], 1), d = ne(e.disp, Yl), y = ne(e.each, (L2) => {
    }), { fill: g, stroke: w } = d;
    return (L2, D, O2, N) => el2(L2, D, (G2, k, H2, x2, q, P4, $2, U, Q2, B, T2) => {
      let j2 = G2.pxRound, C2 = o, I = n66 * oe, F2 = h * oe, ee2 = m * oe, z2, Ue2;
      x2.ori == 0 ? [z2, Ue2] = a(L2, D) : [Ue2, z2] = a(L2, D);
      let we = x2.dir * (x2.ori == 0 ? 1 : -1), te2 = x2.ori == 0 ? gn : gi, fe2 = x2.ori == 0 ? y : (A2, pe2, Me2, il2, Gt2, _t2, It2) => {
        y(A2, pe2, Me2, Gt2, il2, It2, _t2);
      }, J2 = ne(L2.bands, ui).find((A2) => A2.series[0] == D), V2 = J2 != null ? J2.dir : 0, be2 = G2.fillTo(L2, D, G2.min, G2.max, V2), Ne2 = j2($2(be2, q, T2, Q2)), Se2, se2, ct2, qe2 = B, ye2 = j2(G2.width * oe), St2 = false, Mt2 = null, lt2 = null, Lt2 = null, tl2 = null;
      g != null && (ye2 == 0 || w != null) && (St2 = true, Mt2 = g.values(L2, D, O2, N), lt2 = /* @__PURE__ */ new Map(), new Set(Mt2).forEach((A2) => {
        A2 != null && lt2.set(A2, new Path2D());
      }), ye2 > 0 && (Lt2 = w.values(L2, D, O2, N), tl2 = /* @__PURE__ */ new Map(), new Set(Lt2).forEach((A2) => {
        A2 != null && tl2.set(A2, new Path2D());
      })));
      let { x0: ll2, size: Dl2 } = d;
      if (ll2 != null && Dl2 != null) {
        C2 = 1, k = ll2.values(L2, D, O2, N), ll2.unit == 2 && (k = k.map((Me2) => L2.posToVal(U + Me2 * B, x2.key, true)));
        let A2 = Dl2.values(L2, D, O2, N);
        Dl2.unit == 2 ? se2 = A2[0] * B : se2 = P4(A2[0], x2, B, U) - P4(0, x2, B, U), qe2 = Do(k, H2, P4, x2, B, U, qe2), ct2 = qe2 - se2 + I;
      } else qe2 = Do(k, H2, P4, x2, B, U, qe2), ct2 = qe2 * u + I, se2 = qe2 - ct2;
      ct2 < 1 && (ct2 = 0), ye2 >= se2 / 2 && (ye2 = 0), ct2 < 5 && (j2 = No);
      let Ul2 = ct2 > 0, Nt2 = qe2 - ct2 - (Ul2 ? ye2 : 0);
      se2 = j2(Zn(Nt2, ee2, F2)), Se2 = (C2 == 0 ? se2 / 2 : C2 == we ? 0 : se2) - C2 * we * ((C2 == 0 ? I / 2 : 0) + (Ul2 ? ye2 / 2 : 0));
      let We2 = { stroke: null, fill: null, clip: null, band: null, gaps: null, flags: 0 }, nl2 = St2 ? null : new Path2D(), At2 = null;
      if (J2 != null) At2 = L2.data[J2.series[1]];
      else {
        let { y0: A2, y1: pe2 } = d;
        A2 != null && pe2 != null && (H2 = pe2.values(L2, D, O2, N), At2 = A2.values(L2, D, O2, N));
      }
      let Wt2 = z2 * se2, K = Ue2 * se2;
      for (let A2 = we == 1 ? O2 : N; A2 >= O2 && A2 <= N; A2 += we) {
        let pe2 = H2[A2];
        if (pe2 == null) continue;
        if (At2 != null) {
          let Ke2 = At2[A2] ?? 0;
          if (pe2 - Ke2 == 0) continue;
          Ne2 = $2(Ke2, q, T2, Q2);
        }
        let Me2 = x2.distr != 2 || d != null ? k[A2] : A2, il2 = P4(Me2, x2, B, U), Gt2 = $2(ne(pe2, be2), q, T2, Q2), _t2 = j2(il2 - Se2), It2 = j2(Be(Gt2, Ne2)), $e2 = j2(wt(Gt2, Ne2)), nt2 = It2 - $e2;
        if (pe2 != null) {
          let Ke2 = pe2 < 0 ? K : Wt2, at2 = pe2 < 0 ? Wt2 : K;
          St2 ? (ye2 > 0 && Lt2[A2] != null && te2(tl2.get(Lt2[A2]), _t2, $e2 + et(ye2 / 2), se2, Be(0, nt2 - ye2), Ke2, at2), Mt2[A2] != null && te2(lt2.get(Mt2[A2]), _t2, $e2 + et(ye2 / 2), se2, Be(0, nt2 - ye2), Ke2, at2)) : te2(nl2, _t2, $e2 + et(ye2 / 2), se2, Be(0, nt2 - ye2), Ke2, at2), fe2(L2, D, A2, _t2 - ye2 / 2, $e2, se2 + ye2, nt2);
        }
      }
      return ye2 > 0 ? We2.stroke = St2 ? tl2 : nl2 : St2 || (We2._fill = G2.width == 0 ? G2._fill : G2._stroke ?? G2._fill, We2.width = 0), We2.fill = St2 ? lt2 : nl2, We2;
    });
  }
  function Vf(e, i) {
    let o = ne(i?.alignGaps, 0);
    return (n66, s, a, u) => el2(n66, s, (h, m, d, y, g, w, L2, D, O2, N, G2) => {
      [a, u] = un(d, a, u);
      let k = h.pxRound, H2 = (z2) => k(w(z2, y, N, D)), x2 = (z2) => k(L2(z2, g, G2, O2)), q, P4, $2;
      y.ori == 0 ? (q = mn, $2 = El, P4 = ps) : (q = dn, $2 = Pl, P4 = hs);
      let U = y.dir * (y.ori == 0 ? 1 : -1), Q2 = H2(m[U == 1 ? a : u]), B = Q2, T2 = [], j2 = [];
      for (let z2 = U == 1 ? a : u; z2 >= a && z2 <= u; z2 += U) if (d[z2] != null) {
        let we = m[z2], te2 = H2(we);
        T2.push(B = te2), j2.push(x2(d[z2]));
      }
      let C2 = { stroke: e(T2, j2, q, $2, P4, k), fill: null, clip: null, band: null, gaps: null, flags: Ml }, I = C2.stroke, [F2, ee2] = mi(n66, s);
      if (h.fill != null || F2 != 0) {
        let z2 = C2.fill = new Path2D(I), Ue2 = h.fillTo(n66, s, h.min, h.max, F2), we = x2(Ue2);
        $2(z2, B, we), $2(z2, Q2, we);
      }
      if (!h.spanGaps) {
        let z2 = [];
        z2.push(...di(m, d, a, u, U, H2, o)), C2.gaps = z2 = h.gaps(n66, s, a, u, z2), C2.clip = hn(z2, y.ori, D, O2, N, G2);
      }
      return ee2 != 0 && (C2.band = ee2 == 2 ? [Dt(n66, s, a, u, I, -1), Dt(n66, s, a, u, I, 1)] : Dt(n66, s, a, u, I, ee2)), C2;
    });
  }
  function Rf(e) {
    return Vf(zf, e);
  }
  function zf(e, i, o, n66, s, a) {
    let u = e.length;
    if (u < 2) return null;
    let h = new Path2D();
    if (o(h, e[0], i[0]), u == 2) n66(h, e[1], i[1]);
    else {
      let m = Array(u), d = Array(u - 1), y = Array(u - 1), g = Array(u - 1);
      for (let w = 0; w < u - 1; w++) y[w] = i[w + 1] - i[w], g[w] = e[w + 1] - e[w], d[w] = y[w] / g[w];
      m[0] = d[0];
      for (let w = 1; w < u - 1; w++) d[w] === 0 || d[w - 1] === 0 || d[w - 1] > 0 != d[w] > 0 ? m[w] = 0 : (m[w] = 3 * (g[w - 1] + g[w]) / ((2 * g[w] + g[w - 1]) / d[w - 1] + (g[w] + 2 * g[w - 1]) / d[w]), isFinite(m[w]) || (m[w] = 0));
      m[u - 1] = d[u - 2];
      for (let w = 0; w < u - 1; w++) s(h, e[w] + g[w] / 3, i[w] + m[w] * g[w] / 3, e[w + 1] - g[w] / 3, i[w + 1] - m[w + 1] * g[w] / 3, e[w + 1], i[w + 1]);
    }
    return h;
  }
  var ti = /* @__PURE__ */ new Set();
  function Lo() {
    for (let e of ti) e.syncRect(true);
  }
  Al && (Qt(mr, kl, Lo), Qt(dr, kl, Lo, true), Qt(sn, kl, () => {
    He.pxRatio = oe;
  }));
  var Ff = gs();
  var Of = ms();
  function Co(e, i, o, n66) {
    return (n66 ? [e[0], e[1]].concat(e.slice(2)) : [e[0]].concat(e.slice(1))).map((a, u) => li(a, u, i, o));
  }
  function Hf(e, i) {
    return e.map((o, n66) => n66 == 0 ? {} : Te({}, i, o));
  }
  function li(e, i, o, n66) {
    return Te({}, i == 0 ? o : n66, e);
  }
  function ws(e, i, o) {
    return i == null ? Tl : [i, o];
  }
  var Nf = ws;
  function Wf(e, i, o) {
    return i == null ? Tl : rn(i, o, ri, true);
  }
  function Ss(e, i, o, n66) {
    return i == null ? Tl : cn(i, o, e.scales[n66].log, false);
  }
  var Gf = Ss;
  function _s(e, i, o, n66) {
    return i == null ? Tl : si(i, o, e.scales[n66].log, false);
  }
  var If = _s;
  function Yf(e, i, o, n66, s) {
    let a = Be(uo(e), uo(i)), u = i - e, h = gt(s / n66 * u, o);
    do {
      let m = o[h], d = n66 * m / u;
      if (d >= s && a + (m < 5 ? Ht.get(m) : 0) <= 17) return [m, d];
    } while (++h < o.length);
    return [0, 0];
  }
  function Vo(e) {
    let i, o;
    return e = e.replace(/(\d+)px/, (n66, s) => (i = Ae((o = +s) * oe)) + "px"), [e, i, o];
  }
  function Bf(e) {
    e.show && [e.font, e.labelFont].forEach((i) => {
      let o = ae(i[2] * oe, 1);
      i[0] = i[0].replace(/[0-9.]+px/, o + "px"), i[1] = o;
    });
  }
  function He(e, i, o) {
    let n66 = { mode: ne(e.mode, 1) }, s = n66.mode;
    function a(t, l, r, f) {
      let c = l.valToPct(t);
      return f + r * (l.dir == -1 ? 1 - c : c);
    }
    function u(t, l, r, f) {
      let c = l.valToPct(t);
      return f + r * (l.dir == -1 ? c : 1 - c);
    }
    function h(t, l, r, f) {
      return l.ori == 0 ? a(t, l, r, f) : u(t, l, r, f);
    }
    n66.valToPosH = a, n66.valToPosV = u;
    let m = false;
    n66.status = 0;
    let d = n66.root = ft(Js);
    if (e.id != null && (d.id = e.id), Xe(d, e.class), e.title) {
      let t = ft(Xs, d);
      t.textContent = e.title;
    }
    let y = dt("canvas"), g = n66.ctx = y.getContext("2d"), w = ft(er, d);
    Qt("click", w, (t) => {
      t.target === D && (he2 != dl2 || _e != gl2) && Fe.click(n66, t);
    }, true);
    let L2 = n66.under = ft(tr, w);
    w.appendChild(y);
    let D = n66.over = ft(lr, w);
    e = bl(e);
    let O2 = +ne(e.pxAlign, 1), N = Po(O2);
    (e.plugins || []).forEach((t) => {
      t.opts && (e = t.opts(n66, e) || e);
    });
    let G2 = e.ms || 1e-3, k = n66.series = s == 1 ? Co(e.series || [], ko, Ao, false) : Hf(e.series || [null], Mo), H2 = n66.axes = Co(e.axes || [], vo, To, true), x2 = n66.scales = {}, q = n66.bands = e.bands || [];
    q.forEach((t) => {
      t.fill = X(t.fill || null), t.dir = ne(t.dir, -1);
    });
    let P4 = s == 2 ? k[1].facets[0].scale : k[0].scale, $2 = { axes: zs2, series: Ds2 }, U = (e.drawOrder || ["axes", "series"]).map((t) => $2[t]);
    function Q2(t) {
      let l = t.distr == 3 ? (r) => Pt(r > 0 ? r : t.clamp(n66, r, t.min, t.max, t.key)) : t.distr == 4 ? (r) => Yn(r, t.asinh) : t.distr == 100 ? (r) => t.fwd(r) : (r) => r;
      return (r) => {
        let f = l(r), { _min: c, _max: p } = t, S2 = p - c;
        return (f - c) / S2;
      };
    }
    function B(t) {
      let l = x2[t];
      if (l == null) {
        let r = (e.scales || Yl)[t] || Yl;
        if (r.from != null) {
          B(r.from);
          let f = Te({}, x2[r.from], r, { key: t });
          f.valToPct = Q2(f), x2[t] = f;
        } else {
          l = x2[t] = Te({}, t == P4 ? rs : Mf, r), l.key = t;
          let f = l.time, c = l.range, p = Ot(c);
          if ((t != P4 || s == 2 && !f) && (p && (c[0] == null || c[1] == null) && (c = { min: c[0] == null ? so : { mode: 1, hard: c[0], soft: c[0] }, max: c[1] == null ? so : { mode: 1, hard: c[1], soft: c[1] } }, p = false), !p && pn(c))) {
            let S2 = c;
            c = (_2, v, b) => v == null ? Tl : rn(v, b, S2);
          }
          l.range = X(c || (f ? Nf : t == P4 ? l.distr == 3 ? Gf : l.distr == 4 ? If : ws : l.distr == 3 ? Ss : l.distr == 4 ? _s : Wf)), l.auto = X(p ? false : l.auto), l.clamp = X(l.clamp || bf), l._min = l._max = null, l.valToPct = Q2(l);
        }
      }
    }
    B("x"), B("y"), s == 1 && k.forEach((t) => {
      B(t.scale);
    }), H2.forEach((t) => {
      B(t.scale);
    });
    for (let t in e.scales) B(t);
    let T2 = x2[P4], j2 = T2.distr, C2, I;
    T2.ori == 0 ? (Xe(d, Zs), C2 = a, I = u) : (Xe(d, Qs), C2 = u, I = a);
    let F2 = {};
    for (let t in x2) {
      let l = x2[t];
      (l.min != null || l.max != null) && (F2[t] = { min: l.min, max: l.max }, l.min = l.max = null);
    }
    let ee2 = e.tzDate || ((t) => new Date(Ae(t / G2))), z2 = e.fmtDate || ci, Ue2 = G2 == 1 ? Zr(ee2) : ef(ee2), we = So(ee2, wo(G2 == 1 ? Jr : Xr, z2)), te2 = yo(ee2, _o(lf, z2)), fe2 = [], J2 = n66.legend = Te({}, sf, e.legend), V2 = n66.cursor = Te({}, pf, { drag: { y: s == 2 } }, e.cursor), be2 = J2.show, Ne2 = V2.show, Se2 = J2.markers;
    J2.idxs = fe2, Se2.width = X(Se2.width), Se2.dash = X(Se2.dash), Se2.stroke = X(Se2.stroke), Se2.fill = X(Se2.fill);
    let se2, ct2, qe2, ye2 = [], St2 = [], Mt2, lt2 = false, Lt2 = {};
    if (J2.live) {
      let t = k[1] ? k[1].values : null;
      lt2 = t != null, Mt2 = lt2 ? t(n66, 1, 0) : { _: 0 };
      for (let l in Mt2) Lt2[l] = ii;
    }
    if (be2) if (se2 = dt("table", fr, d), qe2 = dt("tbody", null, se2), J2.mount(n66, se2), lt2) {
      ct2 = dt("thead", null, se2, qe2);
      let t = dt("tr", null, ct2);
      dt("th", null, t);
      for (var tl2 in Mt2) dt("th", ji, t).textContent = tl2;
    } else Xe(se2, cr), J2.live && Xe(se2, ur);
    let ll2 = { show: true }, Dl2 = { show: false };
    function Ul2(t, l) {
      if (l == 0 && (lt2 || !J2.live || s == 2)) return Tl;
      let r = [], f = dt("tr", ar, qe2, qe2.childNodes[l]);
      Xe(f, t.class), t.show || Xe(f, Zt);
      let c = dt("th", null, f);
      if (Se2.show) {
        let _2 = ft(pr, c);
        if (l > 0) {
          let v = Se2.width(n66, l);
          v && (_2.style.border = v + "px " + Se2.dash(n66, l) + " " + Se2.stroke(n66, l)), _2.style.background = Se2.fill(n66, l);
        }
      }
      let p = ft(ji, c);
      t.label instanceof HTMLElement ? p.appendChild(t.label) : p.textContent = t.label, l > 0 && (Se2.show || (p.style.color = t.width > 0 ? Se2.stroke(n66, l) : Se2.fill(n66, l)), We2("click", c, (_2) => {
        if (V2._lock) return;
        Bt2(_2);
        let v = k.indexOf(t);
        if ((_2.ctrlKey || _2.metaKey) != J2.isolate) {
          let b = k.some((M2, E2) => E2 > 0 && E2 != v && M2.show);
          k.forEach((M2, E2) => {
            E2 > 0 && vt2(E2, b ? E2 == v ? ll2 : Dl2 : ll2, true, xe2.setSeries);
          });
        } else vt2(v, { show: !t.show }, true, xe2.setSeries);
      }, false), sl2 && We2(Zi, c, (_2) => {
        V2._lock || (Bt2(_2), vt2(k.indexOf(t), Sl2, true, xe2.setSeries));
      }, false));
      for (var S2 in Mt2) {
        let _2 = dt("td", hr, f);
        _2.textContent = "--", r.push(_2);
      }
      return [f, r];
    }
    let Nt2 = /* @__PURE__ */ new Map();
    function We2(t, l, r, f = true) {
      let c = Nt2.get(l) || {}, p = V2.bind[t](n66, l, r, f);
      p && (Qt(t, l, c[t] = p), Nt2.set(l, c));
    }
    function nl2(t, l, r) {
      let f = Nt2.get(l) || {};
      for (let c in f) (t == null || c == t) && (Jn(c, l, f[c]), delete f[c]);
      t == null && Nt2.delete(l);
    }
    let At2 = 0, Wt2 = 0, K = 0, A2 = 0, pe2 = 0, Me2 = 0, il2 = pe2, Gt2 = Me2, _t2 = K, It2 = A2, $e2 = 0, nt2 = 0, Ke2 = 0, at2 = 0;
    n66.bbox = {};
    let wn2 = false, Kl2 = false, ol2 = false, Yt2 = false, jl2 = false, it2 = false;
    function Sn2(t, l, r) {
      (r || t != n66.width || l != n66.height) && wi2(t, l), al2(false), ol2 = true, Kl2 = true, pl2();
    }
    function wi2(t, l) {
      n66.width = At2 = K = t, n66.height = Wt2 = A2 = l, pe2 = Me2 = 0, xs2(), Ts2();
      let r = n66.bbox;
      $e2 = r.left = $t(pe2 * oe, 0.5), nt2 = r.top = $t(Me2 * oe, 0.5), Ke2 = r.width = $t(K * oe, 0.5), at2 = r.height = $t(A2 * oe, 0.5);
    }
    let ys2 = 3;
    function vs2() {
      let t = false, l = 0;
      for (; !t; ) {
        l++;
        let r = Vs2(l), f = Rs2(l);
        t = l == ys2 || r && f, t || (wi2(n66.width, n66.height), Kl2 = true);
      }
    }
    function ks2({ width: t, height: l }) {
      Sn2(t, l);
    }
    n66.setSize = ks2;
    function xs2() {
      let t = false, l = false, r = false, f = false;
      H2.forEach((c, p) => {
        if (c.show && c._show) {
          let { side: S2, _size: _2 } = c, v = S2 % 2, b = c.label != null ? c.labelSize : 0, M2 = _2 + b;
          M2 > 0 && (v ? (K -= M2, S2 == 3 ? (pe2 += M2, f = true) : r = true) : (A2 -= M2, S2 == 0 ? (Me2 += M2, t = true) : l = true));
        }
      }), Ut2[0] = t, Ut2[1] = r, Ut2[2] = l, Ut2[3] = f, K -= Ct2[1] + Ct2[3], pe2 += Ct2[3], A2 -= Ct2[2] + Ct2[0], Me2 += Ct2[0];
    }
    function Ts2() {
      let t = pe2 + K, l = Me2 + A2, r = pe2, f = Me2;
      function c(p, S2) {
        switch (p) {
          case 1:
            return t += S2, t - S2;
          case 2:
            return l += S2, l - S2;
          case 3:
            return r -= S2, r + S2;
          case 0:
            return f -= S2, f + S2;
        }
      }
      H2.forEach((p, S2) => {
        if (p.show && p._show) {
          let _2 = p.side;
          p._pos = c(_2, p._size), p.label != null && (p._lpos = c(_2, p.labelSize));
        }
      });
    }
    if (V2.dataIdx == null) {
      let t = V2.hover, l = t.skip = new Set(t.skip ?? []);
      l.add(void 0);
      let r = t.prox = X(t.prox), f = t.bias ??= 0;
      V2.dataIdx = (c, p, S2, _2) => {
        if (p == 0) return S2;
        let v = S2, b = r(c, p, S2, _2) ?? ce, M2 = b >= 0 && b < ce, E2 = T2.ori == 0 ? K : A2, Y2 = V2.left, ie2 = i[0], le2 = i[p];
        if (l.has(le2[S2])) {
          v = null;
          let Z2 = null, W = null, R;
          if (f == 0 || f == -1) for (R = S2; Z2 == null && R-- > 0; ) l.has(le2[R]) || (Z2 = R);
          if (f == 0 || f == 1) for (R = S2; W == null && R++ < le2.length; ) l.has(le2[R]) || (W = R);
          if (Z2 != null || W != null) if (M2) {
            let de2 = Z2 == null ? -1 / 0 : C2(ie2[Z2], T2, E2, 0), ve2 = W == null ? 1 / 0 : C2(ie2[W], T2, E2, 0), Re2 = Y2 - de2, ue2 = ve2 - Y2;
            Re2 <= ue2 ? Re2 <= b && (v = Z2) : ue2 <= b && (v = W);
          } else v = W == null ? Z2 : Z2 == null ? W : S2 - Z2 <= W - S2 ? Z2 : W;
        } else M2 && Ee(Y2 - C2(ie2[S2], T2, E2, 0)) > b && (v = null);
        return v;
      };
    }
    let Bt2 = (t) => {
      V2.event = t;
    };
    V2.idxs = fe2, V2._lock = false;
    let Oe2 = V2.points;
    Oe2.show = X(Oe2.show), Oe2.size = X(Oe2.size), Oe2.stroke = X(Oe2.stroke), Oe2.width = X(Oe2.width), Oe2.fill = X(Oe2.fill);
    let yt2 = n66.focus = Te({}, e.focus || { alpha: 0.3 }, V2.focus), sl2 = yt2.prox >= 0, rl2 = sl2 && Oe2.one, ot2 = [], fl2 = [], ul2 = [];
    function Si2(t, l) {
      let r = Oe2.show(n66, l);
      if (r instanceof HTMLElement) return Xe(r, rr), Xe(r, t.class), bt(r, -10, -10, K, A2), D.insertBefore(r, ot2[l]), r;
    }
    function _i2(t, l) {
      if (s == 1 || l > 0) {
        let r = s == 1 && x2[t.scale].time, f = t.value;
        t.value = r ? po(f) ? yo(ee2, _o(f, z2)) : f || te2 : f || kf, t.label = t.label || (r ? mf : hf);
      }
      if (rl2 || l > 0) {
        t.width = t.width == null ? 1 : t.width, t.paths = t.paths || Ff || br, t.fillTo = X(t.fillTo || Af), t.pxAlign = +ne(t.pxAlign, O2), t.pxRound = Po(t.pxAlign), t.stroke = X(t.stroke || null), t.fill = X(t.fill || null), t._stroke = t._fill = t._paths = t._focus = null;
        let r = xf(Be(1, t.width), 1), f = t.points = Te({}, { size: r, width: Be(1, r * 0.2), stroke: t.stroke, space: r * 2, paths: Of, _stroke: null, _fill: null }, t.points);
        f.show = X(f.show), f.filter = X(f.filter), f.fill = X(f.fill), f.stroke = X(f.stroke), f.paths = X(f.paths), f.pxAlign = t.pxAlign;
      }
      if (be2) {
        let r = Ul2(t, l);
        ye2.splice(l, 0, r[0]), St2.splice(l, 0, r[1]), J2.values.push(null);
      }
      if (Ne2) {
        fe2.splice(l, 0, null);
        let r = null;
        rl2 ? l == 0 && (r = Si2(t, l)) : l > 0 && (r = Si2(t, l)), ot2.splice(l, 0, r), fl2.splice(l, 0, 0), ul2.splice(l, 0, 0);
      }
      Ve2("addSeries", l);
    }
    function bs2(t, l) {
      l = l ?? k.length, t = s == 1 ? li(t, l, ko, Ao) : li(t, l, {}, Mo), k.splice(l, 0, t), _i2(k[l], l);
    }
    n66.addSeries = bs2;
    function Ms2(t) {
      if (k.splice(t, 1), be2) {
        J2.values.splice(t, 1), St2.splice(t, 1);
        let l = ye2.splice(t, 1)[0];
        nl2(null, l.firstChild), l.remove();
      }
      Ne2 && (fe2.splice(t, 1), ot2.splice(t, 1)[0].remove(), fl2.splice(t, 1), ul2.splice(t, 1)), Ve2("delSeries", t);
    }
    n66.delSeries = Ms2;
    let Ut2 = [false, false, false, false];
    function As2(t, l) {
      if (t._show = t.show, t.show) {
        let r = t.side % 2, f = x2[t.scale];
        f == null && (t.scale = r ? k[1].scale : P4, f = x2[t.scale]);
        let c = f.time;
        t.size = X(t.size), t.space = X(t.space), t.rotate = X(t.rotate), Ot(t.incrs) && t.incrs.forEach((S2) => {
          !Ht.has(S2) && Ht.set(S2, Io(S2));
        }), t.incrs = X(t.incrs || (f.distr == 2 ? jr : c ? G2 == 1 ? $r : Qr : Jt)), t.splits = X(t.splits || (c && f.distr == 1 ? Ue2 : f.distr == 3 ? Qn : f.distr == 4 ? wf : gf)), t.stroke = X(t.stroke), t.grid.stroke = X(t.grid.stroke), t.ticks.stroke = X(t.ticks.stroke), t.border.stroke = X(t.border.stroke);
        let p = t.values;
        t.values = Ot(p) && !Ot(p[0]) ? X(p) : c ? Ot(p) ? So(ee2, wo(p, z2)) : po(p) ? tf(ee2, p) : p || we : p || df, t.filter = X(t.filter || (f.distr >= 3 && f.log == 10 ? yf : f.distr == 3 && f.log == 2 ? vf : Wo)), t.font = Vo(t.font), t.labelFont = Vo(t.labelFont), t._size = t.size(n66, null, l, 0), t._space = t._rotate = t._incrs = t._found = t._splits = t._values = null, t._size > 0 && (Ut2[l] = true, t._el = ft(nr, w));
      }
    }
    function Ll2(t, l, r, f) {
      let [c, p, S2, _2] = r, v = l % 2, b = 0;
      return v == 0 && (_2 || p) && (b = l == 0 && !c || l == 2 && !S2 ? Ae(vo.size / 3) : 0), v == 1 && (c || S2) && (b = l == 1 && !p || l == 3 && !_2 ? Ae(To.size / 2) : 0), b;
    }
    let yi2 = n66.padding = (e.padding || [Ll2, Ll2, Ll2, Ll2]).map((t) => X(ne(t, Ll2))), Ct2 = n66._padding = yi2.map((t, l) => t(n66, l, Ut2, 0)), ze2, Pe2 = null, De2 = null, ql2 = s == 1 ? k[0].idxs : null, pt2 = null, Cl = false;
    function vi2(t, l) {
      if (i = t ?? [], n66.data = n66._data = i, s == 2) {
        ze2 = 0;
        for (let r = 1; r < k.length; r++) ze2 += i[r][0].length;
      } else {
        i.length == 0 && (n66.data = n66._data = i = [[]]), pt2 = i[0], ze2 = pt2.length;
        let r = i;
        if (j2 == 2) {
          r = i.slice();
          let f = r[0] = Array(ze2);
          for (let c = 0; c < ze2; c++) f[c] = c;
        }
        n66._data = i = r;
      }
      if (al2(true), Ve2("setData"), j2 == 2 && (ol2 = true), l !== false) {
        let r = T2;
        r.auto(n66, Cl) ? _n2() : Rt2(P4, r.min, r.max), Yt2 = Yt2 || V2.left >= 0, it2 = true, pl2();
      }
    }
    n66.setData = vi2;
    function _n2() {
      Cl = true;
      let t, l;
      s == 1 && (ze2 > 0 ? (Pe2 = ql2[0] = 0, De2 = ql2[1] = ze2 - 1, t = i[0][Pe2], l = i[0][De2], j2 == 2 ? (t = Pe2, l = De2) : t == l && (j2 == 3 ? [t, l] = cn(t, t, T2.log, false) : j2 == 4 ? [t, l] = si(t, t, T2.log, false) : T2.time ? l = t + Ae(86400 / G2) : [t, l] = rn(t, l, ri, true))) : (Pe2 = ql2[0] = t = null, De2 = ql2[1] = l = null)), Rt2(P4, t, l);
    }
    let $l2, cl2, yn2, vn2, kn2, xn2, Tn2, bn2, Mn2, je2;
    function ki2(t, l, r, f, c, p) {
      t ??= $i, r ??= ui, f ??= "butt", c ??= $i, p ??= "round", t != $l2 && (g.strokeStyle = $l2 = t), c != cl2 && (g.fillStyle = cl2 = c), l != yn2 && (g.lineWidth = yn2 = l), p != kn2 && (g.lineJoin = kn2 = p), f != xn2 && (g.lineCap = xn2 = f), r != vn2 && g.setLineDash(vn2 = r);
    }
    function xi(t, l, r, f) {
      l != cl2 && (g.fillStyle = cl2 = l), t != Tn2 && (g.font = Tn2 = t), r != bn2 && (g.textAlign = bn2 = r), f != Mn2 && (g.textBaseline = Mn2 = f);
    }
    function An2(t, l, r, f, c = 0) {
      if (f.length > 0 && t.auto(n66, Cl) && (l == null || l.min == null)) {
        let p = ne(Pe2, 0), S2 = ne(De2, f.length - 1), _2 = r.min == null ? _r(f, p, S2, c, t.distr == 3) : [r.min, r.max];
        t.min = wt(t.min, r.min = _2[0]), t.max = Be(t.max, r.max = _2[1]);
      }
    }
    let Ti2 = { min: null, max: null };
    function Es2() {
      for (let f in x2) {
        let c = x2[f];
        F2[f] == null && (c.min == null || F2[P4] != null && c.auto(n66, Cl)) && (F2[f] = Ti2);
      }
      for (let f in x2) {
        let c = x2[f];
        F2[f] == null && c.from != null && F2[c.from] != null && (F2[f] = Ti2);
      }
      F2[P4] != null && al2(true);
      let t = {};
      for (let f in F2) {
        let c = F2[f];
        if (c != null) {
          let p = t[f] = bl(x2[f], Er);
          if (c.min != null) Te(p, c);
          else if (f != P4 || s == 2) if (ze2 == 0 && p.from == null) {
            let S2 = p.range(n66, null, null, f);
            p.min = S2[0], p.max = S2[1];
          } else p.min = ce, p.max = -ce;
        }
      }
      if (ze2 > 0) {
        k.forEach((f, c) => {
          if (s == 1) {
            let p = f.scale, S2 = F2[p];
            if (S2 == null) return;
            let _2 = t[p];
            if (c == 0) {
              let v = _2.range(n66, _2.min, _2.max, p);
              _2.min = v[0], _2.max = v[1], Pe2 = gt(_2.min, i[0]), De2 = gt(_2.max, i[0]), De2 - Pe2 > 1 && (i[0][Pe2] < _2.min && Pe2++, i[0][De2] > _2.max && De2--), f.min = pt2[Pe2], f.max = pt2[De2];
            } else f.show && f.auto && An2(_2, S2, f, i[c], f.sorted);
            f.idxs[0] = Pe2, f.idxs[1] = De2;
          } else if (c > 0 && f.show && f.auto) {
            let [p, S2] = f.facets, _2 = p.scale, v = S2.scale, [b, M2] = i[c], E2 = t[_2], Y2 = t[v];
            E2 != null && An2(E2, F2[_2], p, b, p.sorted), Y2 != null && An2(Y2, F2[v], S2, M2, S2.sorted), f.min = S2.min, f.max = S2.max;
          }
        });
        for (let f in t) {
          let c = t[f], p = F2[f];
          if (c.from == null && (p == null || p.min == null)) {
            let S2 = c.range(n66, c.min == ce ? null : c.min, c.max == -ce ? null : c.max, f);
            c.min = S2[0], c.max = S2[1];
          }
        }
      }
      for (let f in t) {
        let c = t[f];
        if (c.from != null) {
          let p = t[c.from];
          if (p.min == null) c.min = c.max = null;
          else {
            let S2 = c.range(n66, p.min, p.max, f);
            c.min = S2[0], c.max = S2[1];
          }
        }
      }
      let l = {}, r = false;
      for (let f in t) {
        let c = t[f], p = x2[f];
        if (p.min != c.min || p.max != c.max) {
          p.min = c.min, p.max = c.max;
          let S2 = p.distr;
          p._min = S2 == 3 ? Pt(p.min) : S2 == 4 ? Yn(p.min, p.asinh) : S2 == 100 ? p.fwd(p.min) : p.min, p._max = S2 == 3 ? Pt(p.max) : S2 == 4 ? Yn(p.max, p.asinh) : S2 == 100 ? p.fwd(p.max) : p.max, l[f] = r = true;
        }
      }
      if (r) {
        k.forEach((f, c) => {
          s == 2 ? c > 0 && l.y && (f._paths = null) : l[f.scale] && (f._paths = null);
        });
        for (let f in l) ol2 = true, Ve2("setScale", f);
        Ne2 && V2.left >= 0 && (Yt2 = it2 = true);
      }
      for (let f in F2) F2[f] = null;
    }
    function Ps2(t) {
      let l = Zn(Pe2 - 1, 0, ze2 - 1), r = Zn(De2 + 1, 0, ze2 - 1);
      for (; t[l] == null && l > 0; ) l--;
      for (; t[r] == null && r < ze2 - 1; ) r++;
      return [l, r];
    }
    function Ds2() {
      if (ze2 > 0) {
        let t = k.some((l) => l._focus) && je2 != yt2.alpha;
        t && (g.globalAlpha = je2 = yt2.alpha), k.forEach((l, r) => {
          if (r > 0 && l.show && (bi2(r, false), bi2(r, true), l._paths == null)) {
            let f = je2;
            je2 != l.alpha && (g.globalAlpha = je2 = l.alpha);
            let c = s == 2 ? [0, i[r][0].length - 1] : Ps2(i[r]);
            l._paths = l.paths(n66, r, c[0], c[1]), je2 != f && (g.globalAlpha = je2 = f);
          }
        }), k.forEach((l, r) => {
          if (r > 0 && l.show) {
            let f = je2;
            je2 != l.alpha && (g.globalAlpha = je2 = l.alpha), l._paths != null && Mi2(r, false);
            {
              let c = l._paths != null ? l._paths.gaps : null, p = l.points.show(n66, r, Pe2, De2, c), S2 = l.points.filter(n66, r, p, c);
              (p || S2) && (l.points._paths = l.points.paths(n66, r, Pe2, De2, S2), Mi2(r, true));
            }
            je2 != f && (g.globalAlpha = je2 = f), Ve2("drawSeries", r);
          }
        }), t && (g.globalAlpha = je2 = 1);
      }
    }
    function bi2(t, l) {
      let r = l ? k[t].points : k[t];
      r._stroke = r.stroke(n66, t), r._fill = r.fill(n66, t);
    }
    function Mi2(t, l) {
      let r = l ? k[t].points : k[t], { stroke: f, fill: c, clip: p, flags: S2, _stroke: _2 = r._stroke, _fill: v = r._fill, _width: b = r.width } = r._paths;
      b = ae(b * oe, 3);
      let M2 = null, E2 = b % 2 / 2;
      l && v == null && (v = b > 0 ? "#fff" : _2);
      let Y2 = r.pxAlign == 1 && E2 > 0;
      if (Y2 && g.translate(E2, E2), !l) {
        let ie2 = $e2 - b / 2, le2 = nt2 - b / 2, Z2 = Ke2 + b, W = at2 + b;
        M2 = new Path2D(), M2.rect(ie2, le2, Z2, W);
      }
      l ? En2(_2, b, r.dash, r.cap, v, f, c, S2, p) : Ls2(t, _2, b, r.dash, r.cap, v, f, c, S2, M2, p), Y2 && g.translate(-E2, -E2);
    }
    function Ls2(t, l, r, f, c, p, S2, _2, v, b, M2) {
      let E2 = false;
      v != 0 && q.forEach((Y2, ie2) => {
        if (Y2.series[0] == t) {
          let le2 = k[Y2.series[1]], Z2 = i[Y2.series[1]], W = (le2._paths || Yl).band;
          Ot(W) && (W = Y2.dir == 1 ? W[0] : W[1]);
          let R, de2 = null;
          le2.show && W && vr(Z2, Pe2, De2) ? (de2 = Y2.fill(n66, ie2) || p, R = le2._paths.clip) : W = null, En2(l, r, f, c, de2, S2, _2, v, b, M2, R, W), E2 = true;
        }
      }), E2 || En2(l, r, f, c, p, S2, _2, v, b, M2);
    }
    let Ai2 = Ml | ei;
    function En2(t, l, r, f, c, p, S2, _2, v, b, M2, E2) {
      ki2(t, l, r, f, c), (v || b || E2) && (g.save(), v && g.clip(v), b && g.clip(b)), E2 ? (_2 & Ai2) == Ai2 ? (g.clip(E2), M2 && g.clip(M2), Zl2(c, S2), Jl2(t, p, l)) : _2 & ei ? (Zl2(c, S2), g.clip(E2), Jl2(t, p, l)) : _2 & Ml && (g.save(), g.clip(E2), M2 && g.clip(M2), Zl2(c, S2), g.restore(), Jl2(t, p, l)) : (Zl2(c, S2), Jl2(t, p, l)), (v || b || E2) && g.restore();
    }
    function Jl2(t, l, r) {
      r > 0 && (l instanceof Map ? l.forEach((f, c) => {
        g.strokeStyle = $l2 = c, g.stroke(f);
      }) : l != null && t && g.stroke(l));
    }
    function Zl2(t, l) {
      l instanceof Map ? l.forEach((r, f) => {
        g.fillStyle = cl2 = f, g.fill(r);
      }) : l != null && t && g.fill(l);
    }
    function Cs2(t, l, r, f) {
      let c = H2[t], p;
      if (f <= 0) p = [0, 0];
      else {
        let S2 = c._space = c.space(n66, t, l, r, f), _2 = c._incrs = c.incrs(n66, t, l, r, f, S2);
        p = Yf(l, r, _2, f, S2);
      }
      return c._found = p;
    }
    function Pn2(t, l, r, f, c, p, S2, _2, v, b) {
      let M2 = S2 % 2 / 2;
      O2 == 1 && g.translate(M2, M2), ki2(_2, S2, v, b, _2), g.beginPath();
      let E2, Y2, ie2, le2, Z2 = c + (f == 0 || f == 3 ? -p : p);
      r == 0 ? (Y2 = c, le2 = Z2) : (E2 = c, ie2 = Z2);
      for (let W = 0; W < t.length; W++) l[W] != null && (r == 0 ? E2 = ie2 = t[W] : Y2 = le2 = t[W], g.moveTo(E2, Y2), g.lineTo(ie2, le2));
      g.stroke(), O2 == 1 && g.translate(-M2, -M2);
    }
    function Vs2(t) {
      let l = true;
      return H2.forEach((r, f) => {
        if (!r.show) return;
        let c = x2[r.scale];
        if (c.min == null) {
          r._show && (l = false, r._show = false, al2(false));
          return;
        } else r._show || (l = false, r._show = true, al2(false));
        let p = r.side, S2 = p % 2, { min: _2, max: v } = c, [b, M2] = Cs2(f, _2, v, S2 == 0 ? K : A2);
        if (M2 == 0) return;
        let E2 = c.distr == 2, Y2 = r._splits = r.splits(n66, f, _2, v, b, M2, E2), ie2 = c.distr == 2 ? Y2.map((R) => pt2[R]) : Y2, le2 = c.distr == 2 ? pt2[Y2[1]] - pt2[Y2[0]] : b, Z2 = r._values = r.values(n66, r.filter(n66, ie2, f, M2, le2), f, M2, le2);
        r._rotate = p == 2 ? r.rotate(n66, Z2, f, M2) : 0;
        let W = r._size;
        r._size = ut(r.size(n66, Z2, f, t)), W != null && r._size != W && (l = false);
      }), l;
    }
    function Rs2(t) {
      let l = true;
      return yi2.forEach((r, f) => {
        let c = r(n66, f, Ut2, t);
        c != Ct2[f] && (l = false), Ct2[f] = c;
      }), l;
    }
    function zs2() {
      for (let t = 0; t < H2.length; t++) {
        let l = H2[t];
        if (!l.show || !l._show) continue;
        let r = l.side, f = r % 2, c, p, S2 = l.stroke(n66, t), _2 = r == 0 || r == 3 ? -1 : 1, [v, b] = l._found;
        if (l.label != null) {
          let Ie2 = l.labelGap * _2, Qe2 = Ae((l._lpos + Ie2) * oe);
          xi(l.labelFont[0], S2, "center", r == 2 ? "top" : qi), g.save(), f == 1 ? (c = p = 0, g.translate(Qe2, Ae(nt2 + at2 / 2)), g.rotate((r == 3 ? -on : on) / 2)) : (c = Ae($e2 + Ke2 / 2), p = Qe2);
          let qt2 = Ho(l.label) ? l.label(n66, t, v, b) : l.label;
          g.fillText(qt2, c, p), g.restore();
        }
        if (b == 0) continue;
        let M2 = x2[l.scale], E2 = f == 0 ? Ke2 : at2, Y2 = f == 0 ? $e2 : nt2, ie2 = l._splits, le2 = M2.distr == 2 ? ie2.map((Ie2) => pt2[Ie2]) : ie2, Z2 = M2.distr == 2 ? pt2[ie2[1]] - pt2[ie2[0]] : v, W = l.ticks, R = l.border, de2 = W.show ? W.size : 0, ve2 = Ae(de2 * oe), Re2 = Ae((l.alignTo == 2 ? l._size - de2 - l.gap : l.gap) * oe), ue2 = l._rotate * -on / 180, ke2 = N(l._pos * oe), Je2 = (ve2 + Re2) * _2, Ge2 = ke2 + Je2;
        p = f == 0 ? Ge2 : 0, c = f == 1 ? Ge2 : 0;
        let st = l.font[0], ht2 = l.align == 1 ? yl : l.align == 2 ? Wn : ue2 > 0 ? yl : ue2 < 0 ? Wn : f == 0 ? "center" : r == 3 ? Wn : yl, xt2 = ue2 || f == 1 ? "middle" : r == 2 ? "top" : qi;
        xi(st, S2, ht2, xt2);
        let Ze2 = l.font[1] * l.lineGap, rt = ie2.map((Ie2) => N(h(Ie2, M2, E2, Y2))), mt2 = l._values;
        for (let Ie2 = 0; Ie2 < mt2.length; Ie2++) {
          let Qe2 = mt2[Ie2];
          if (Qe2 != null) {
            f == 0 ? c = rt[Ie2] : p = rt[Ie2], Qe2 = "" + Qe2;
            let qt2 = Qe2.indexOf(`
`) == -1 ? [Qe2] : Qe2.split(/\n/gm);
            for (let Ye = 0; Ye < qt2.length; Ye++) {
              let Ki2 = qt2[Ye];
              ue2 ? (g.save(), g.translate(c, p + Ye * Ze2), g.rotate(ue2), g.fillText(Ki2, 0, 0), g.restore()) : g.fillText(Ki2, c, p + Ye * Ze2);
            }
          }
        }
        W.show && Pn2(rt, W.filter(n66, le2, t, b, Z2), f, r, ke2, ve2, ae(W.width * oe, 3), W.stroke(n66, t), W.dash, W.cap);
        let Tt2 = l.grid;
        Tt2.show && Pn2(rt, Tt2.filter(n66, le2, t, b, Z2), f, f == 0 ? 2 : 1, f == 0 ? nt2 : $e2, f == 0 ? at2 : Ke2, ae(Tt2.width * oe, 3), Tt2.stroke(n66, t), Tt2.dash, Tt2.cap), R.show && Pn2([ke2], [1], f == 0 ? 1 : 0, f == 0 ? 1 : 2, f == 1 ? nt2 : $e2, f == 1 ? at2 : Ke2, ae(R.width * oe, 3), R.stroke(n66, t), R.dash, R.cap);
      }
      Ve2("drawAxes");
    }
    function al2(t) {
      k.forEach((l, r) => {
        r > 0 && (l._paths = null, t && (s == 1 ? (l.min = null, l.max = null) : l.facets.forEach((f) => {
          f.min = null, f.max = null;
        })));
      });
    }
    let Ql2 = false, Dn2 = false, Vl2 = [];
    function Fs2() {
      Dn2 = false;
      for (let t = 0; t < Vl2.length; t++) Ve2(...Vl2[t]);
      Vl2.length = 0;
    }
    function pl2() {
      Ql2 || (zr(Ei2), Ql2 = true);
    }
    function Os2(t, l = false) {
      Ql2 = true, Dn2 = l, t(n66), Ei2(), l && Vl2.length > 0 && queueMicrotask(Fs2);
    }
    n66.batch = Os2;
    function Ei2() {
      if (wn2 && (Es2(), wn2 = false), ol2 && (vs2(), ol2 = false), Kl2) {
        if (ge(L2, yl, pe2), ge(L2, "top", Me2), ge(L2, Nl, K), ge(L2, Wl, A2), ge(D, yl, pe2), ge(D, "top", Me2), ge(D, Nl, K), ge(D, Wl, A2), ge(w, Nl, At2), ge(w, Wl, Wt2), y.width = Ae(At2 * oe), y.height = Ae(Wt2 * oe), H2.forEach(({ _el: t, _show: l, _size: r, _pos: f, side: c }) => {
          if (t != null) if (l) {
            let p = c === 3 || c === 0 ? r : 0, S2 = c % 2 == 1;
            ge(t, S2 ? "left" : "top", f - p), ge(t, S2 ? "width" : "height", r), ge(t, S2 ? "top" : "left", S2 ? Me2 : pe2), ge(t, S2 ? "height" : "width", S2 ? A2 : K), $n(t, Zt);
          } else Xe(t, Zt);
        }), $l2 = cl2 = yn2 = kn2 = xn2 = Tn2 = bn2 = Mn2 = vn2 = null, je2 = 1, Fl2(true), pe2 != il2 || Me2 != Gt2 || K != _t2 || A2 != It2) {
          al2(false);
          let t = K / _t2, l = A2 / It2;
          if (Ne2 && !Yt2 && V2.left >= 0) {
            V2.left *= t, V2.top *= l, hl2 && bt(hl2, Ae(V2.left), 0, K, A2), ml2 && bt(ml2, 0, Ae(V2.top), K, A2);
            for (let r = 0; r < ot2.length; r++) {
              let f = ot2[r];
              f != null && (fl2[r] *= t, ul2[r] *= l, bt(f, ut(fl2[r]), ut(ul2[r]), K, A2));
            }
          }
          if (me.show && !jl2 && me.left >= 0 && me.width > 0) {
            me.left *= t, me.width *= t, me.top *= l, me.height *= l;
            for (let r in Fn2) ge(wl2, r, me[r]);
          }
          il2 = pe2, Gt2 = Me2, _t2 = K, It2 = A2;
        }
        Ve2("setSize"), Kl2 = false;
      }
      At2 > 0 && Wt2 > 0 && (g.clearRect(0, 0, y.width, y.height), Ve2("drawClear"), U.forEach((t) => t()), Ve2("draw")), me.show && jl2 && (Xl2(me), jl2 = false), Ne2 && Yt2 && (jt2(null, true, false), Yt2 = false), J2.show && J2.live && it2 && (Rn2(), it2 = false), m || (m = true, n66.status = 1, Ve2("ready")), Cl = false, Ql2 = false;
    }
    n66.redraw = (t, l) => {
      ol2 = l || false, t !== false ? Rt2(P4, T2.min, T2.max) : pl2();
    };
    function Ln2(t, l) {
      let r = x2[t];
      if (r.from == null) {
        if (ze2 == 0) {
          let f = r.range(n66, l.min, l.max, t);
          l.min = f[0], l.max = f[1];
        }
        if (l.min > l.max) {
          let f = l.min;
          l.min = l.max, l.max = f;
        }
        if (ze2 > 1 && l.min != null && l.max != null && l.max - l.min < 1e-16) return;
        t == P4 && r.distr == 2 && ze2 > 0 && (l.min = gt(l.min, i[0]), l.max = gt(l.max, i[0]), l.min == l.max && l.max++), F2[t] = l, wn2 = true, pl2();
      }
    }
    n66.setScale = Ln2;
    let Cn2, Vn2, hl2, ml2, Pi2, Di2, dl2, gl2, Li2, Ci2, he2, _e, Vt2 = false, Fe = V2.drag, Le2 = Fe.x, Ce2 = Fe.y;
    Ne2 && (V2.x && (Cn2 = ft(or, D)), V2.y && (Vn2 = ft(sr, D)), T2.ori == 0 ? (hl2 = Cn2, ml2 = Vn2) : (hl2 = Vn2, ml2 = Cn2), he2 = V2.left, _e = V2.top);
    let me = n66.select = Te({ show: true, over: true, left: 0, width: 0, top: 0, height: 0 }, e.select), wl2 = me.show ? ft(ir, me.over ? D : L2) : null;
    function Xl2(t, l) {
      if (me.show) {
        for (let r in t) me[r] = t[r], r in Fn2 && ge(wl2, r, t[r]);
        l !== false && Ve2("setSelect");
      }
    }
    n66.setSelect = Xl2;
    function Hs2(t) {
      if (k[t].show) be2 && $n(ye2[t], Zt);
      else if (be2 && Xe(ye2[t], Zt), Ne2) {
        let r = rl2 ? ot2[0] : ot2[t];
        r != null && bt(r, -10, -10, K, A2);
      }
    }
    function Rt2(t, l, r) {
      Ln2(t, { min: l, max: r });
    }
    function vt2(t, l, r, f) {
      l.focus != null && Ys2(t), l.show != null && k.forEach((c, p) => {
        p > 0 && (t == p || t == null) && (c.show = l.show, Hs2(p), s == 2 ? (Rt2(c.facets[0].scale, null, null), Rt2(c.facets[1].scale, null, null)) : Rt2(c.scale, null, null), pl2());
      }), r !== false && Ve2("setSeries", t, l), f && Ol2("setSeries", n66, t, l);
    }
    n66.setSeries = vt2;
    function Ns2(t, l) {
      Te(q[t], l);
    }
    function Ws2(t, l) {
      t.fill = X(t.fill || null), t.dir = ne(t.dir, -1), l = l ?? q.length, q.splice(l, 0, t);
    }
    function Gs2(t) {
      t == null ? q.length = 0 : q.splice(t, 1);
    }
    n66.addBand = Ws2, n66.setBand = Ns2, n66.delBand = Gs2;
    function Is2(t, l) {
      k[t].alpha = l, Ne2 && ot2[t] != null && (ot2[t].style.opacity = l), be2 && ye2[t] && (ye2[t].style.opacity = l);
    }
    let Et2, zt2, Kt, Sl2 = { focus: true };
    function Ys2(t) {
      if (t != Kt) {
        let l = t == null, r = yt2.alpha != 1;
        k.forEach((f, c) => {
          if (s == 1 || c > 0) {
            let p = l || c == 0 || c == t;
            f._focus = l ? null : p, r && Is2(c, p ? 1 : yt2.alpha);
          }
        }), Kt = t, r && pl2();
      }
    }
    be2 && sl2 && We2(Qi, se2, (t) => {
      V2._lock || (Bt2(t), Kt != null && vt2(null, Sl2, true, xe2.setSeries));
    });
    function kt2(t, l, r) {
      let f = x2[l];
      r && (t = t / oe - (f.ori == 1 ? Me2 : pe2));
      let c = K;
      f.ori == 1 && (c = A2, t = c - t), f.dir == -1 && (t = c - t);
      let p = f._min, S2 = f._max, _2 = t / c, v = p + (S2 - p) * _2, b = f.distr;
      return b == 3 ? xl(10, v) : b == 4 ? xr(v, f.asinh) : b == 100 ? f.bwd(v) : v;
    }
    function Bs2(t, l) {
      let r = kt2(t, P4, l);
      return gt(r, i[0], Pe2, De2);
    }
    n66.valToIdx = (t) => gt(t, i[0]), n66.posToIdx = Bs2, n66.posToVal = kt2, n66.valToPos = (t, l, r) => x2[l].ori == 0 ? a(t, x2[l], r ? Ke2 : K, r ? $e2 : 0) : u(t, x2[l], r ? at2 : A2, r ? nt2 : 0), n66.setCursor = (t, l, r) => {
      he2 = t.left, _e = t.top, jt2(null, l, r);
    };
    function Vi2(t, l) {
      ge(wl2, yl, me.left = t), ge(wl2, Nl, me.width = l);
    }
    function Ri2(t, l) {
      ge(wl2, "top", me.top = t), ge(wl2, Wl, me.height = l);
    }
    let Rl2 = T2.ori == 0 ? Vi2 : Ri2, zl2 = T2.ori == 1 ? Vi2 : Ri2;
    function Us2() {
      if (be2 && J2.live) for (let t = s == 2 ? 1 : 0; t < k.length; t++) {
        if (t == 0 && lt2) continue;
        let l = J2.values[t], r = 0;
        for (let f in l) St2[t][r++].firstChild.nodeValue = l[f];
      }
    }
    function Rn2(t, l) {
      if (t != null && (t.idxs ? t.idxs.forEach((r, f) => {
        fe2[f] = r;
      }) : Ar(t.idx) || fe2.fill(t.idx), J2.idx = fe2[0]), be2 && J2.live) {
        for (let r = 0; r < k.length; r++) (r > 0 || s == 1 && !lt2) && Ks2(r, fe2[r]);
        Us2();
      }
      it2 = false, l !== false && Ve2("setLegend");
    }
    n66.setLegend = Rn2;
    function Ks2(t, l) {
      let r = k[t], f = t == 0 && j2 == 2 ? pt2 : i[t], c;
      lt2 ? c = r.values(n66, t, l) ?? Lt2 : (c = r.value(n66, l == null ? null : f[l], t, l), c = c == null ? Lt2 : { _: c }), J2.values[t] = c;
    }
    function jt2(t, l, r) {
      Li2 = he2, Ci2 = _e, [he2, _e] = V2.move(n66, he2, _e), V2.left = he2, V2.top = _e, Ne2 && (hl2 && bt(hl2, Ae(he2), 0, K, A2), ml2 && bt(ml2, 0, Ae(_e), K, A2));
      let f, c = Pe2 > De2;
      Et2 = ce, zt2 = null;
      let p = T2.ori == 0 ? K : A2, S2 = T2.ori == 1 ? K : A2;
      if (he2 < 0 || ze2 == 0 || c) {
        f = V2.idx = null;
        for (let _2 = 0; _2 < k.length; _2++) {
          let v = ot2[_2];
          v != null && bt(v, -10, -10, K, A2);
        }
        sl2 && vt2(null, Sl2, true, t == null && xe2.setSeries), J2.live && (fe2.fill(f), it2 = true);
      } else {
        let _2, v, b;
        s == 1 && (_2 = T2.ori == 0 ? he2 : _e, v = kt2(_2, P4), f = V2.idx = gt(v, i[0], Pe2, De2), b = C2(i[0][f], T2, p, 0));
        let M2 = -10, E2 = -10, Y2 = 0, ie2 = 0, le2 = true, Z2 = "", W = "";
        for (let R = s == 2 ? 1 : 0; R < k.length; R++) {
          let de2 = k[R], ve2 = fe2[R], Re2 = ve2 == null ? null : s == 1 ? i[R][ve2] : i[R][1][ve2], ue2 = V2.dataIdx(n66, R, f, v), ke2 = ue2 == null ? null : s == 1 ? i[R][ue2] : i[R][1][ue2];
          if (it2 = it2 || ke2 != Re2 || ue2 != ve2, fe2[R] = ue2, R > 0 && de2.show) {
            let Je2 = ue2 == null ? -10 : ue2 == f ? b : C2(s == 1 ? i[0][ue2] : i[R][0][ue2], T2, p, 0), Ge2 = ke2 == null ? -10 : I(ke2, s == 1 ? x2[de2.scale] : x2[de2.facets[1].scale], S2, 0);
            if (sl2 && ke2 != null) {
              let st = T2.ori == 1 ? he2 : _e, ht2 = Ee(yt2.dist(n66, R, ue2, Ge2, st));
              if (ht2 < Et2) {
                let xt2 = yt2.bias;
                if (xt2 != 0) {
                  let Ze2 = kt2(st, de2.scale), rt = ke2 >= 0 ? 1 : -1, mt2 = Ze2 >= 0 ? 1 : -1;
                  mt2 == rt && (mt2 == 1 ? xt2 == 1 ? ke2 >= Ze2 : ke2 <= Ze2 : xt2 == 1 ? ke2 <= Ze2 : ke2 >= Ze2) && (Et2 = ht2, zt2 = R);
                } else Et2 = ht2, zt2 = R;
              }
            }
            if (it2 || rl2) {
              let st, ht2;
              T2.ori == 0 ? (st = Je2, ht2 = Ge2) : (st = Ge2, ht2 = Je2);
              let xt2, Ze2, rt, mt2, Tt2, Ie2, Qe2 = true, qt2 = Oe2.bbox;
              if (qt2 != null) {
                Qe2 = false;
                let Ye = qt2(n66, R);
                rt = Ye.left, mt2 = Ye.top, xt2 = Ye.width, Ze2 = Ye.height;
              } else rt = st, mt2 = ht2, xt2 = Ze2 = Oe2.size(n66, R);
              if (Ie2 = Oe2.fill(n66, R), Tt2 = Oe2.stroke(n66, R), rl2) R == zt2 && Et2 <= yt2.prox && (M2 = rt, E2 = mt2, Y2 = xt2, ie2 = Ze2, le2 = Qe2, Z2 = Ie2, W = Tt2);
              else {
                let Ye = ot2[R];
                Ye != null && (fl2[R] = rt, ul2[R] = mt2, oo(Ye, xt2, Ze2, Qe2), no(Ye, Ie2, Tt2), bt(Ye, ut(rt), ut(mt2), K, A2));
              }
            }
          }
        }
        if (rl2) {
          let R = yt2.prox, de2 = Kt == null ? Et2 <= R : Et2 > R || zt2 != Kt;
          if (it2 || de2) {
            let ve2 = ot2[0];
            ve2 != null && (fl2[0] = M2, ul2[0] = E2, oo(ve2, Y2, ie2, le2), no(ve2, Z2, W), bt(ve2, ut(M2), ut(E2), K, A2));
          }
        }
      }
      if (me.show && Vt2) if (t != null) {
        let [_2, v] = xe2.scales, [b, M2] = xe2.match, [E2, Y2] = t.cursor.sync.scales, ie2 = t.cursor.drag;
        if (Le2 = ie2._x, Ce2 = ie2._y, Le2 || Ce2) {
          let { left: le2, top: Z2, width: W, height: R } = t.select, de2 = t.scales[E2].ori, ve2 = t.posToVal, Re2, ue2, ke2, Je2, Ge2, st = _2 != null && b(_2, E2), ht2 = v != null && M2(v, Y2);
          st && Le2 ? (de2 == 0 ? (Re2 = le2, ue2 = W) : (Re2 = Z2, ue2 = R), ke2 = x2[_2], Je2 = C2(ve2(Re2, E2), ke2, p, 0), Ge2 = C2(ve2(Re2 + ue2, E2), ke2, p, 0), Rl2(wt(Je2, Ge2), Ee(Ge2 - Je2))) : Rl2(0, p), ht2 && Ce2 ? (de2 == 1 ? (Re2 = le2, ue2 = W) : (Re2 = Z2, ue2 = R), ke2 = x2[v], Je2 = I(ve2(Re2, Y2), ke2, S2, 0), Ge2 = I(ve2(Re2 + ue2, Y2), ke2, S2, 0), zl2(wt(Je2, Ge2), Ee(Ge2 - Je2))) : zl2(0, S2);
        } else On2();
      } else {
        let _2 = Ee(Li2 - Pi2), v = Ee(Ci2 - Di2);
        if (T2.ori == 1) {
          let Y2 = _2;
          _2 = v, v = Y2;
        }
        Le2 = Fe.x && _2 >= Fe.dist, Ce2 = Fe.y && v >= Fe.dist;
        let b = Fe.uni;
        b != null ? Le2 && Ce2 && (Le2 = _2 >= b, Ce2 = v >= b, !Le2 && !Ce2 && (v > _2 ? Ce2 = true : Le2 = true)) : Fe.x && Fe.y && (Le2 || Ce2) && (Le2 = Ce2 = true);
        let M2, E2;
        Le2 && (T2.ori == 0 ? (M2 = dl2, E2 = he2) : (M2 = gl2, E2 = _e), Rl2(wt(M2, E2), Ee(E2 - M2)), Ce2 || zl2(0, S2)), Ce2 && (T2.ori == 1 ? (M2 = dl2, E2 = he2) : (M2 = gl2, E2 = _e), zl2(wt(M2, E2), Ee(E2 - M2)), Le2 || Rl2(0, p)), !Le2 && !Ce2 && (Rl2(0, 0), zl2(0, 0));
      }
      if (Fe._x = Le2, Fe._y = Ce2, t == null) {
        if (r) {
          if (Ui2 != null) {
            let [_2, v] = xe2.scales;
            xe2.values[0] = _2 != null ? kt2(T2.ori == 0 ? he2 : _e, _2) : null, xe2.values[1] = v != null ? kt2(T2.ori == 1 ? he2 : _e, v) : null;
          }
          Ol2(Gn, n66, he2, _e, K, A2, f);
        }
        if (sl2) {
          let _2 = r && xe2.setSeries, v = yt2.prox;
          Kt == null ? Et2 <= v && vt2(zt2, Sl2, true, _2) : Et2 > v ? vt2(null, Sl2, true, _2) : zt2 != Kt && vt2(zt2, Sl2, true, _2);
        }
      }
      it2 && (J2.idx = f, Rn2()), l !== false && Ve2("setCursor");
    }
    let Ft2 = null;
    Object.defineProperty(n66, "rect", { get() {
      return Ft2 == null && Fl2(false), Ft2;
    } });
    function Fl2(t = false) {
      t ? Ft2 = null : (Ft2 = D.getBoundingClientRect(), Ve2("syncRect", Ft2));
    }
    function zi2(t, l, r, f, c, p, S2) {
      V2._lock || Vt2 && t != null && t.movementX == 0 && t.movementY == 0 || (zn2(t, l, r, f, c, p, S2, false, t != null), t != null ? jt2(null, true, true) : jt2(l, true, false));
    }
    function zn2(t, l, r, f, c, p, S2, _2, v) {
      if (Ft2 == null && Fl2(false), Bt2(t), t != null) r = t.clientX - Ft2.left, f = t.clientY - Ft2.top;
      else {
        if (r < 0 || f < 0) {
          he2 = -10, _e = -10;
          return;
        }
        let [b, M2] = xe2.scales, E2 = l.cursor.sync, [Y2, ie2] = E2.values, [le2, Z2] = E2.scales, [W, R] = xe2.match, de2 = l.axes[0].side % 2 == 1, ve2 = T2.ori == 0 ? K : A2, Re2 = T2.ori == 1 ? K : A2, ue2 = de2 ? p : c, ke2 = de2 ? c : p, Je2 = de2 ? f : r, Ge2 = de2 ? r : f;
        if (le2 != null ? r = W(b, le2) ? h(Y2, x2[b], ve2, 0) : -10 : r = ve2 * (Je2 / ue2), Z2 != null ? f = R(M2, Z2) ? h(ie2, x2[M2], Re2, 0) : -10 : f = Re2 * (Ge2 / ke2), T2.ori == 1) {
          let st = r;
          r = f, f = st;
        }
      }
      v && (l == null || l.cursor.event.type == Gn) && ((r <= 1 || r >= K - 1) && (r = $t(r, K)), (f <= 1 || f >= A2 - 1) && (f = $t(f, A2))), _2 ? (Pi2 = r, Di2 = f, [dl2, gl2] = V2.move(n66, r, f)) : (he2 = r, _e = f);
    }
    let Fn2 = { width: 0, height: 0, left: 0, top: 0 };
    function On2() {
      Xl2(Fn2, false);
    }
    let Fi2, Oi2, Hi2, Ni2;
    function Wi2(t, l, r, f, c, p, S2) {
      Vt2 = true, Le2 = Ce2 = Fe._x = Fe._y = false, zn2(t, l, r, f, c, p, S2, true, false), t != null && (We2(In, jn, Gi2, false), Ol2(Ji, n66, dl2, gl2, K, A2, null));
      let { left: _2, top: v, width: b, height: M2 } = me;
      Fi2 = _2, Oi2 = v, Hi2 = b, Ni2 = M2;
    }
    function Gi2(t, l, r, f, c, p, S2) {
      Vt2 = Fe._x = Fe._y = false, zn2(t, l, r, f, c, p, S2, false, true);
      let { left: _2, top: v, width: b, height: M2 } = me, E2 = b > 0 || M2 > 0, Y2 = Fi2 != _2 || Oi2 != v || Hi2 != b || Ni2 != M2;
      if (E2 && Y2 && Xl2(me), Fe.setScale && E2 && Y2) {
        let ie2 = _2, le2 = b, Z2 = v, W = M2;
        if (T2.ori == 1 && (ie2 = v, le2 = M2, Z2 = _2, W = b), Le2 && Rt2(P4, kt2(ie2, P4), kt2(ie2 + le2, P4)), Ce2) for (let R in x2) {
          let de2 = x2[R];
          R != P4 && de2.from == null && de2.min != ce && Rt2(R, kt2(Z2 + W, R), kt2(Z2, R));
        }
        On2();
      } else V2.lock && (V2._lock = !V2._lock, jt2(l, true, t != null));
      t != null && (nl2(In, jn), Ol2(In, n66, he2, _e, K, A2, null));
    }
    function js2(t, l, r, f, c, p, S2) {
      if (V2._lock) return;
      Bt2(t);
      let _2 = Vt2;
      if (Vt2) {
        let v = true, b = true, M2 = 10, E2, Y2;
        T2.ori == 0 ? (E2 = Le2, Y2 = Ce2) : (E2 = Ce2, Y2 = Le2), E2 && Y2 && (v = he2 <= M2 || he2 >= K - M2, b = _e <= M2 || _e >= A2 - M2), E2 && v && (he2 = he2 < dl2 ? 0 : K), Y2 && b && (_e = _e < gl2 ? 0 : A2), jt2(null, true, true), Vt2 = false;
      }
      he2 = -10, _e = -10, fe2.fill(null), jt2(null, true, true), _2 && (Vt2 = _2);
    }
    function Ii2(t, l, r, f, c, p, S2) {
      V2._lock || (Bt2(t), _n2(), On2(), t != null && Ol2(Xi, n66, he2, _e, K, A2, null));
    }
    function Yi2() {
      H2.forEach(Bf), Sn2(n66.width, n66.height, true);
    }
    Qt(sn, kl, Yi2);
    let _l2 = {};
    _l2.mousedown = Wi2, _l2.mousemove = zi2, _l2.mouseup = Gi2, _l2.dblclick = Ii2, _l2.setSeries = (t, l, r, f) => {
      let c = xe2.match[2];
      r = c(n66, l, r), r != -1 && vt2(r, f, true, false);
    }, Ne2 && (We2(Ji, D, Wi2), We2(Gn, D, zi2), We2(Zi, D, (t) => {
      Bt2(t), Fl2(false);
    }), We2(Qi, D, js2), We2(Xi, D, Ii2), ti.add(n66), n66.syncRect = Fl2);
    let en2 = n66.hooks = e.hooks || {};
    function Ve2(t, l, r) {
      Dn2 ? Vl2.push([t, l, r]) : t in en2 && en2[t].forEach((f) => {
        f.call(null, n66, l, r);
      });
    }
    (e.plugins || []).forEach((t) => {
      for (let l in t.hooks) en2[l] = (en2[l] || []).concat(t.hooks[l]);
    });
    let Bi2 = (t, l, r) => r, xe2 = Te({ key: null, setSeries: false, filters: { pub: co, sub: co }, scales: [P4, k[1] ? k[1].scale : null], match: [ao, ao, Bi2], values: [null, null] }, V2.sync);
    xe2.match.length == 2 && xe2.match.push(Bi2), V2.sync = xe2;
    let Ui2 = xe2.key, Hn2 = fs(Ui2);
    function Ol2(t, l, r, f, c, p, S2) {
      xe2.filters.pub(t, l, r, f, c, p, S2) && Hn2.pub(t, l, r, f, c, p, S2);
    }
    Hn2.sub(n66);
    function qs2(t, l, r, f, c, p, S2) {
      xe2.filters.sub(t, l, r, f, c, p, S2) && _l2[t](null, l, r, f, c, p, S2);
    }
    n66.pub = qs2;
    function $s2() {
      Hn2.unsub(n66), ti.delete(n66), Nt2.clear(), Jn(sn, kl, Yi2), d.remove(), se2?.remove(), Ve2("destroy");
    }
    n66.destroy = $s2;
    function Nn2() {
      Ve2("init", e, i), vi2(i || e.data, false), F2[P4] ? Ln2(P4, F2[P4]) : _n2(), jl2 = me.show && (me.width > 0 || me.height > 0), Yt2 = it2 = true, Sn2(e.width, e.height);
    }
    return k.forEach(_i2), H2.forEach(As2), o ? o instanceof HTMLElement ? (o.appendChild(d), Nn2()) : o(n66, Nn2) : Nn2(), n66;
  }
  He.assign = Te;
  He.fmtNum = fi;
  He.rangeNum = rn;
  He.rangeLog = cn;
  He.rangeAsinh = si;
  He.orient = el2;
  He.pxRatio = oe;
  He.join = Rr;
  He.fmtDate = ci, He.tzDate = Ur;
  He.sync = fs;
  {
    He.addGap = Ef, He.clipGaps = hn;
    let e = He.paths = { points: ms };
    e.linear = gs, e.stepped = Lf, e.bars = Cf, e.spline = Rf;
  }

  // curves.js
  var LEGEND = 22;
  var TIMES = 26;
  var VALUES = 56;
  var FONT = "11px system-ui, sans-serif";
  function curvePane(store2) {
    return new CurvePane(store2).api();
  }
  var CurvePane = class {
    /**
     * @param {Page.Store} store
     */
    constructor(store2) {
      const { section, body } = pane("run-curves", S.runCurves);
      this.section = section;
      this.host = el("div", { class: "plots", role: "group", "aria-label": S.runCurvesLabel });
      body.append(this.host);
      this.panels = [];
      this.plots = [];
      this.ready = null;
      this.t = [];
      this.low = [];
      this.high = [];
      this.redraw = eachFrame(this.draw);
      new ResizeObserver(this.resize).observe(body);
      store2.on("theme", this.build);
    }
    api() {
      return { section: this.section, open: this.open, add: this.add };
    }
    open = (news) => {
      this.ready = news;
      this.panels = panelsOf(news);
      this.t = [];
      this.low = Array.from({ length: 3 * news.tracked.length + news.drives.length }, () => []);
      this.high = this.low.map(() => []);
      this.build();
    };
    build = () => {
      for (const plot of this.plots) plot.destroy();
      this.plots = this.panels.map(this.plotOf);
      this.resize();
      this.redraw();
    };
    add = (news) => {
      this.t.push(...news.t);
      news.low.forEach((column, k) => {
        this.low[k].push(...column);
        this.high[k].push(...(news.high ?? news.low)[k]);
      });
      const first = this.t[this.t.length - 1] - this.ready.window;
      if (this.t[0] < first - 0.5 * this.ready.window) {
        const gone = this.t.findIndex((time) => time >= first);
        for (const column of [this.t, ...this.low, ...this.high]) column.splice(0, gone);
      }
      this.redraw();
    };
    draw = () => {
      this.plots.forEach((plot, p) => {
        const columns = this.panels[p].lines.flatMap(({ column }) => [this.high[column], this.low[column]]);
        plot.setData([this.t, ...columns]);
      });
    };
    resize = () => {
      const { clientWidth: width, clientHeight: height } = this.host;
      if (width < 40 || height < 40) return;
      const share2 = (height - TIMES) / Math.max(1, this.plots.length);
      this.plots.forEach((plot, p) => {
        const below = p === this.plots.length - 1 ? TIMES : 0;
        plot.setSize({ width, height: Math.max(20, share2 - LEGEND) + below });
      });
    };
    /** From when to when the plots go: the window ends with the last sample. */
    times = () => {
      const end = Math.max(this.ready.window, this.t[this.t.length - 1] ?? 0);
      return [end - this.ready.window, end];
    };
    plotOf = (panel, p) => {
      const isLast = p === this.panels.length - 1;
      const head = el("div", { class: "plot-head" }, el("span", { textContent: panelTitle(panel) }));
      const box = el("div", { class: "plot" }, head);
      this.host.append(box);
      const limits = panel.lines.flatMap(({ low, high }) => [low, high]).filter((limit) => Number.isFinite(limit));
      const plot = new He(
        {
          width: 100,
          height: 100,
          padding: [4, 12, isLast ? 0 : 4, 0],
          cursor: { y: false, sync: { key: "run" }, drag: { x: false, y: false }, points: { show: false } },
          legend: { mount: (_2, table) => head.append(table), markers: { show: false } },
          scales: { x: { time: false, range: this.times }, y: { range: (_2, ...ends) => valueRange(ends, limits) } },
          axes: [this.axis({ show: isLast, size: TIMES, unit: " s" }), this.axis({ size: VALUES, space: 24 })],
          series: [{ label: S.runTime, value: () => "" }].concat(panel.lines.flatMap((line) => this.seriesOf(line))),
          bands: panel.lines.map((line, k) => ({ series: [2 * k + 1, 2 * k + 2], fill: () => this.ink(line) })),
          hooks: { draw: [(drawn) => drawLimits(drawn, limits)] }
        },
        [[]],
        box
      );
      const destroy = plot.destroy;
      plot.destroy = () => {
        destroy();
        box.remove();
      };
      return plot;
    };
    axis = ({ show = true, size, space = 60, unit = "" }) => ({
      show,
      size,
      space,
      font: FONT,
      stroke: () => colourOf("--soft"),
      grid: { stroke: () => colourOf("--line"), width: 1 },
      ticks: { show: false },
      values: (_2, numbers) => numbers.map((number) => shortNumber(number) + unit)
    });
    /** The greatest and the least values of a line; the legend has it once. */
    seriesOf = (line) => {
      const isReference = line.colour === null;
      const common = {
        stroke: () => this.ink(line),
        width: isReference ? 1.2 : 1.7,
        dash: isReference ? [4, 3] : [],
        points: { show: false }
      };
      return [
        {
          ...common,
          label: line.name || S.runReference,
          value: (_2, number) => Number.isFinite(number) ? shortNumber(number) : ""
        },
        { ...common, class: "twin" }
      ];
    };
    /** The colour of a line: that of a term, as a canvas takes it. */
    ink = (line) => {
      if (line.colour === null) return colourOf("--soft");
      this.host.style.color = hue(line.colour);
      const ink = getComputedStyle(this.host).color;
      this.host.style.color = "";
      return ink;
    };
  };
  var panelTitle = ({ title: title2, unit }) => unit && unit !== "1" ? `${title2}, ${unit}` : title2;
  function panelsOf({ tracked, drives }) {
    const count = tracked.length;
    const numbered = tracked.map((port, i) => ({ ...port, i }));
    const units = [...new Set(tracked.map((port) => port.unit))];
    const driven = drives.map((port, i) => ({ ...port, column: 3 * count + i, colour: i }));
    return [
      ...units.flatMap((unit) => {
        const own = numbered.filter((port) => port.unit === unit);
        return [
          {
            title: S.runOutputs,
            unit,
            lines: own.flatMap(({ name, i }) => [
              { name: "", column: i, colour: null },
              // reference
              { name, column: count + i, colour: i }
            ])
          },
          { title: S.runError, unit, lines: own.map(({ name, i }) => ({ name, column: 2 * count + i, colour: i })) }
        ];
      }),
      ...[...new Set(driven.map((port) => port.unit))].map((unit) => ({
        title: S.runDrives,
        unit,
        lines: driven.filter((port) => port.unit === unit)
      }))
    ];
  }
  function drawLimits(plot, limits) {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.strokeStyle = colourOf("--lit");
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
    for (const limit of limits) {
      const y = plot.valToPos(limit, "y", true);
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
    ctx.restore();
  }

  // charts.js
  function stage(store2, body, draw) {
    const canvas = el("canvas", { role: "img" });
    const size = { width: 0, height: 0 };
    const redraw = eachFrame(() => {
      if (size.width > 4 && size.height > 4) draw(context(canvas, size.width, size.height));
    });
    new ResizeObserver(([entry]) => {
      size.width = entry.contentRect.width;
      size.height = entry.contentRect.height;
      redraw();
    }).observe(body);
    store2.on("theme", redraw);
    body.append(canvas);
    return { canvas, redraw };
  }

  // plant.js
  function picturePane(store2, push) {
    return new PicturePane(store2, push).api();
  }
  var PicturePane = class {
    /**
     * @param {Page.Store} store
     */
    constructor(store2, push) {
      this.push = push;
      const { section, bar: bar2, body } = pane("run-picture", S.runPicture);
      this.section = section;
      const { canvas, redraw } = stage(store2, body, this.draw);
      this.canvas = canvas;
      this.redraw = redraw;
      this.said = el("span", { class: "small" });
      this.keys = /* @__PURE__ */ new Map();
      this.colours = /* @__PURE__ */ new Map();
      this.drawing = null;
      this.open = false;
      this.held = null;
      this.scale = null;
      bar2.append(el("span", { class: "space" }), this.said);
      this.canvas.tabIndex = 0;
      this.canvas.setAttribute("aria-label", S.runPictureLabel);
      store2.on("theme", () => this.colours.clear());
      this.before = "";
      this.canvas.addEventListener("pointerdown", (event) => {
        if (!this.open || !this.scale) return;
        this.canvas.setPointerCapture(event.pointerId);
        this.held = this.place(event);
        this.tell();
      });
      this.canvas.addEventListener("pointermove", (event) => {
        if (!this.held) return;
        this.held = this.place(event);
        this.tell();
      });
      for (const name of ["pointerup", "pointercancel", "lostpointercapture", "blur"])
        this.canvas.addEventListener(name, this.letGo);
      const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      this.canvas.addEventListener("keydown", (event) => {
        const way = ARROWS[event.key];
        if (!way || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        this.keys.set(
          event.key,
          way.map((each) => each * (event.shiftKey ? 1 : 0.4))
        );
        this.tell();
      });
      this.canvas.addEventListener("keyup", (event) => {
        if (this.keys.delete(event.key)) this.tell();
      });
    }
    api() {
      return {
        section: this.section,
        canvas: this.canvas,
        open: (ready) => {
          this.open = true;
          this.drawing = null;
          this.before = "";
          this.section.setAttribute("data-plant", ready.plant);
          this.tell();
          this.redraw();
        },
        close: () => {
          this.open = false;
          this.letGo();
        },
        show: (next) => {
          this.drawing = next;
          if (this.held) this.tell();
          this.redraw();
        }
      };
    }
    letGo = () => {
      this.held = null;
      this.keys.clear();
      this.tell();
    };
    /** Colours by what they stand for; a plant that draws itself brings its own. */
    colour = (name) => {
      if (!this.colours.has(name)) this.colours.set(name, name.startsWith("#") ? name : colourOf(`--run-${name}`));
      return this.colours.get(name);
    };
    stage = () => {
      return this.drawing?.stage ?? [-1, 1, -1, 1];
    };
    grip = () => {
      return this.drawing?.grip ?? [0, 0];
    };
    /** The pull of the hand: right and up, 1 is half of the height of the stage. */
    pull = () => {
      const [, , bottom, top] = this.stage();
      let [x2, y] = [0, 0];
      if (this.held) {
        const [gx, gy] = this.grip();
        const reach = 0.5 * (top - bottom);
        [x2, y] = [(this.held[0] - gx) / reach, (this.held[1] - gy) / reach];
      }
      for (const [dx, dy] of this.keys.values()) [x2, y] = [x2 + dx, y + dy];
      const length = Math.hypot(x2, y);
      return (
        /** @type {Page.Pair} */
        length > 1 ? [x2 / length, y / length] : [x2, y]
      );
    };
    tell = () => {
      const now = (
        /** @type {Page.Pair} */
        this.pull().map((each) => Number(each.toFixed(3)))
      );
      if (JSON.stringify(now) === this.before) return;
      this.before = JSON.stringify(now);
      if (this.open) this.push(now.some(Boolean) ? now : null);
      this.said.textContent = now.some(Boolean) ? S.runPulled(now) : "";
      this.redraw();
    };
    draw = ({ g, width, height }) => {
      const [left, right, bottom, top] = this.stage();
      const size = Math.min(width / (right - left), height / (top - bottom));
      const [ox, oy] = [0.5 * (width - size * (left + right)), 0.5 * (height + size * (bottom + top))];
      this.scale = { size, ox, oy };
      const at2 = ([x3, y2]) => [ox + size * x3, oy - size * y2];
      g.lineCap = g.lineJoin = "round";
      if (!this.open && !this.drawing) {
        this.words(g, S.runNotYet, width / 2, height / 2);
        return;
      }
      for (const part of this.drawing?.parts ?? []) PARTS2[part.is](g, part, at2, this.colour);
      if (!this.drawing) this.words(g, S.runNoPicture, width / 2, height / 2 - 24);
      const [x2, y] = this.pull();
      if (x2 || y)
        arrow(
          g,
          /** @type {Page.Pair} */
          at2(this.grip()),
          [x2, y],
          0.5 * size * (top - bottom),
          this.colour("mark")
        );
    };
    words = (g, text, x2, y) => {
      g.fillStyle = colourOf("--soft");
      g.font = "13px system-ui, sans-serif";
      g.textAlign = "center";
      g.fillText(text, x2, y);
      g.textAlign = "start";
    };
    place = (event) => {
      const box = this.canvas.getBoundingClientRect();
      return [
        (event.clientX - box.left - this.scale.ox) / this.scale.size,
        (this.scale.oy - (event.clientY - box.top)) / this.scale.size
      ];
    };
  };
  var PARTS2 = {
    line(g, { points, colour, width }, at2, tint) {
      path(g, points, at2);
      g.strokeStyle = tint(colour);
      g.lineWidth = 1.4 * width;
      g.stroke();
    },
    area(g, { points, colour }, at2, tint) {
      path(g, points, at2);
      g.closePath();
      g.fillStyle = tint(colour);
      g.fill();
    },
    mark(g, { x: x2, y, sign, size, colour }, at2, tint) {
      const [px, py] = at2([x2, y]);
      const r = 0.7 * size;
      g.fillStyle = tint(colour);
      g.beginPath();
      if (sign === "s") g.rect(px - r, py - r, 2 * r, 2 * r);
      else if (sign === "^") {
        g.moveTo(px, py - r);
        g.lineTo(px + r, py + r);
        g.lineTo(px - r, py + r);
      } else g.arc(px, py, r, 0, 2 * Math.PI);
      g.fill();
    },
    words(g, { x: x2, y, text, size }, at2, tint) {
      g.fillStyle = tint("metal");
      g.font = `${Math.max(11, 1.45 * size)}px system-ui, sans-serif`;
      g.fillText(text, ...at2([x2, y]));
    }
  };
  function path(g, points, at2) {
    g.beginPath();
    points.forEach((point, i) => i ? g.lineTo(...at2(point)) : g.moveTo(...at2(point)));
  }
  function arrow(g, [x2, y], [dx, dy], reach, colour) {
    const [ex, ey] = [x2 + dx * reach, y - dy * reach];
    const angle = Math.atan2(ey - y, ex - x2);
    g.strokeStyle = g.fillStyle = colour;
    g.lineWidth = 3;
    g.beginPath();
    g.moveTo(x2, y);
    g.lineTo(ex, ey);
    g.stroke();
    g.beginPath();
    for (const turn of [0, 2.6, -2.6]) g.lineTo(ex + 9 * Math.cos(angle + turn), ey + 9 * Math.sin(angle + turn));
    g.fill();
  }

  // run.js
  var SPEEDS = [0.2, 1, 5, 60, 600];
  var FIRST = ["rms", "max", "final", "chatter"];
  var STEPS2 = 1e3;
  var timeWords = (seconds) => seconds % 3600 === 0 ? `${seconds / 3600}h` : seconds % 60 === 0 ? `${seconds / 60}min` : `${seconds}s`;
  var lasting = (seconds) => seconds <= 30 ? 1 : seconds <= 1e3 ? 60 : 600;
  function runView(store2, hand) {
    return new RunView(store2, hand).view;
  }
  var RunView = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand) {
      this.store = store2;
      this.hand = hand;
      this.calm = matchMedia("(prefers-reduced-motion: reduce)");
      this.state = { job: null, ready: null, paused: false, over: false, sent: "", described: "", reached: "" };
      this.picture = picturePane(this.store, (pull) => this.state.job?.say({ pull }));
      this.curves = curvePane(this.store);
      this.gains = gainPane(this.hand, (values, done) => {
        this.say({ gains: values });
        if (done && this.state.over) this.say({ restart: true, asked: this.asked(), pause: false });
      });
      this.metrics = metricPane();
      this.form = formPane(this.store, this.hand, this.changed);
      this.view = el(
        "div",
        { class: "run" },
        this.form.section,
        this.picture.section,
        this.curves.section,
        this.gains.section,
        this.metrics.section,
        splitter({ key: "run-columns", vertical: true, at: 1, usual: 0.4 }),
        splitter({ key: "run-rows", vertical: false, at: 2, usual: 0.6 })
      );
      this.listen();
      this.answer();
      this.follow();
    }
    listen() {
      this.form.start.addEventListener("click", this.start);
      this.form.pause.addEventListener("click", () => this.say({ pause: !this.state.paused }));
      this.form.step.addEventListener("click", () => this.say({ step: 1 }));
      this.form.again.addEventListener("click", this.again);
      this.form.stop.addEventListener("click", () => this.state.job?.stop());
      this.form.speed.addEventListener("change", () => this.say({ speed: this.form.asked().speed }));
      this.calm.addEventListener("change", this.calmed);
      this.store.on("closed", () => this.calm.removeEventListener("change", this.calmed));
      this.view.addEventListener("keydown", (event) => {
        if (event.key === " " && event.target === this.picture.canvas && this.state.job) {
          event.preventDefault();
          this.say({ pause: !this.state.paused });
        }
      });
    }
    /** What each piece of news does. */
    answer() {
      this.HEARD = {
        ready: (news) => {
          Object.assign(this.state, { ready: news, over: false });
          this.form.note("");
          this.form.mark("");
          this.curves.open(news);
          this.picture.open(news);
          this.gains.open(news.gains);
          this.metrics.open(news);
        },
        samples: (news) => {
          const before = this.state.paused;
          this.state.paused = news.paused;
          this.form.time(news.time, news.behind);
          if (news.low.length) this.curves.add(news);
          if (news.drawing) this.picture.show(news.drawing);
          if (before === this.state.paused) return;
          if (!this.state.paused) {
            this.state.over = false;
            this.form.unsay(this.state.reached);
          }
          this.form.running(this.state);
        },
        metrics: (news) => this.metrics.show(news.metrics),
        reached: (news) => {
          this.state.over = true;
          this.state.reached = S.runReached(news);
          this.form.note(this.state.reached);
        },
        over: (news) => {
          this.state.over = true;
          this.form.note(S.runOver[news.how](news), news.how === "diverged");
          this.form.running(this.state);
        },
        text: (news) => {
          this.form.note(news.taken ? S.runTaken : S.runRestart);
          if (news.taken) this.gains.open(news.gains);
        },
        note: (news) => {
          this.form.note(news.text, Boolean(news.field));
          this.form.mark(news.field ?? "", news.text);
        }
      };
    }
    follow() {
      this.store.on("judged", () => {
        if (!this.store.sound) return;
        const text = this.hand.text();
        const isNew = text !== this.state.sent;
        if (this.state.job && isNew && this.state.over) this.rerun();
        else if (this.state.job && isNew) this.say({ text });
        if (!this.state.over) this.state.sent = text;
        this.describe();
      });
      this.store.on("view", () => {
        this.describe();
        this.rerun();
      });
      let waits = false;
      this.store.on("left", () => {
        waits = Boolean(this.state.job) && !this.state.paused && !this.state.over;
        if (waits) this.say({ pause: true });
      });
      this.store.on("shown", () => {
        if (waits && this.state.job) this.form.note(S.runWaits);
        waits = false;
      });
      this.form.running(this.state);
    }
    calmed = () => this.say({ calm: this.calm.matches });
    say = (words2) => this.state.job?.say(words2);
    /** Ask which plants there are, and which of them the text fits. */
    describe = () => {
      const text = this.hand.text();
      if (this.store.view !== RUN.name || !this.store.sound || text === this.state.described) return;
      this.state.described = text;
      this.hand.start("plants", { text }, (news) => {
        if (news.uses) this.form.uses(news.uses);
        if (news.plants) this.form.offer(news);
        if (news.end !== "failed") return;
        this.form.note(news.message);
        this.state.described = "";
      });
    };
    asked = () => {
      return { ...this.form.asked(), calm: this.calm.matches };
    };
    start = () => {
      if (this.state.job) {
        this.again();
        return;
      }
      this.state.over = false;
      this.state.sent = this.hand.text();
      this.form.note(S.runStarting);
      this.state.job = this.hand.start("run", this.asked(), this.hear);
      this.form.running(this.state);
    };
    again = () => {
      this.state.sent = this.hand.text();
      this.say({ text: this.state.sent });
      this.say({ restart: true, asked: this.asked(), pause: false });
    };
    /** Something of the form has changed: it counts from the next start on. */
    changed = () => {
      if (this.state.job && this.state.ready) this.form.note(S.runNextTime);
    };
    hear = (news) => {
      if (news.end) {
        Object.assign(this.state, { job: null, ready: null, paused: false });
        this.picture.close();
        if (news.end === "failed") this.form.note(news.message, true);
        this.form.mark(news.field ?? "", news.message);
      } else this.HEARD[news.news]?.(news);
      if (news.end || news.news === "ready") this.form.running(this.state);
    };
    /** A run that has ended shows what has been changed since: it runs again where one looks at it. */
    rerun = () => {
      if (this.state.job && this.state.over && this.store.view === RUN.name && this.store.sound && this.hand.text() !== this.state.sent)
        this.again();
    };
  };
  var RUN = { name: "run", title: S.run, drawn: false, panes: [runView] };
  function formPane(store2, hand, changed) {
    return new RunForm(store2, hand, changed).api();
  }
  var RunForm = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store2, hand, changed) {
      this.store = store2;
      this.hand = hand;
      this.changed = changed;
      const { section, bar: bar2, body } = pane("run-form", S.run);
      this.section = section;
      this.bar = bar2;
      this.body = body;
      this.plants = [];
      this.direct = "";
      this.likely = "";
      this.touched = false;
      this.endless = el("input", { type: "checkbox", onchange: () => this.open(true) });
      this.form = new Form({
        changed: (name) => name === "plant" ? this.chosen(true) : this.changed(),
        judge: (values) => this.hand.askNow("judge", { form: "run", values })
      });
      this.speed = el(
        "select",
        {},
        ...SPEEDS.map((each) => el("option", { value: each, textContent: S.runTimes(each) })),
        el("option", { value: "", textContent: S.runFastest })
      );
      this.makeControls();
      this.arrange();
    }
    makeControls() {
      const [start2, pause, step, again, stop] = [
        this.button(S.runStart, S.runStartHint),
        this.button(S.runPause, S.runPauseHint),
        this.button(S.runStep, S.runStepHint),
        this.button(S.runAgain, S.runAgainHint),
        this.button(S.runStop, S.runStopHint)
      ];
      this.start = start2;
      this.pause = pause;
      this.step = step;
      this.again = again;
      this.stop = stop;
      this.start.classList.add("main");
      this.start.disabled = true;
      this.clock = el("output", { class: "clock", "aria-label": S.runTime });
      this.said = el("p", { class: "said", role: "status" });
    }
    arrange() {
      this.around = aroundLine(this.hand);
      this.unsaved = unsavedLine(this.store, this.hand);
      this.line = el("code", { class: "command", tabIndex: 0 });
      this.details = el("details", {}, el("summary", { textContent: S.runSame }), el("p", { class: "small" }, this.line));
      this.openEnd = el("label", { class: "check", title: S.runOpenEndedHint }, this.endless, S.runOpenEnded);
      this.details.addEventListener("toggle", () => this.showLine());
      this.body.addEventListener("change", this.showLine);
      this.bar.append(
        this.start,
        this.pause,
        this.step,
        this.again,
        this.stop,
        el("label", { class: "small" }, S.runSpeed, this.speed),
        this.clock
      );
      this.body.append(this.around.line, this.unsaved.line, this.form.view, this.details, this.said);
      this.note("");
    }
    api() {
      return {
        section: this.section,
        start: this.start,
        pause: this.pause,
        step: this.step,
        again: this.again,
        stop: this.stop,
        speed: this.speed,
        offer: this.offer,
        uses: this.unsaved.show,
        asked: this.asked,
        note: this.note,
        unsay: this.unsay,
        mark: this.mark,
        running: this.running,
        time: this.time
      };
    }
    button = (words2, hint) => el("button", { textContent: words2, title: hint });
    one = () => this.plants.find((each) => each.name === this.form.shown("plant"));
    mark = (name, message) => this.form.mark(name, message);
    open = (byHand) => {
      if (byHand) this.changed();
      this.showLine();
    };
    chosen = (byHand) => {
      this.touched ||= byHand;
      if (!this.one()) return;
      this.show(this.one());
      if (byHand) this.changed();
      this.showLine();
    };
    /** Show the fields of a plant: its trajectories, or references. */
    show = (one) => {
      const moves = one.trajectories.length > 0;
      this.form.show(["trajectory"], moves);
      this.form.show(["payload"], moves && one.carries);
      this.form.show(["reference", "duration"], !moves);
      this.openEnd.hidden = moves;
      const before = this.form.shown("trajectory");
      const names = one.trajectories.map((name) => [name, name]);
      this.form.choices("trajectory", names, one.trajectories.includes(before) ? before : one.shown);
      this.form.set("reference", one.reference);
      const port = one.reference.split("=")[0];
      this.form.suggest(
        "reference",
        S.runSignals.map((signal) => `${port}=${signal}`)
      );
      this.speed.value = String(moves ? 1 : lasting(one.duration ?? 10));
      this.endless.checked = !one.duration;
      this.form.set("duration", one.duration ? timeWords(one.duration) : "");
      this.open(false);
      this.note(one.why, Boolean(one.why));
    };
    offer = (news) => {
      const before = JSON.stringify(this.plants);
      if (news.form) this.form.open(news.form);
      this.form.first.append(this.openEnd);
      this.plants = news.plants;
      this.direct = news.direct;
      this.likely = news.likely;
      this.start.disabled = !this.plants.length;
      this.form.view.hidden = this.details.hidden = !this.plants.length;
      this.around.show(news.alone, Boolean(this.direct));
      if (!this.plants.length) {
        this.note("");
        return;
      }
      if (JSON.stringify(this.plants) === before) return;
      const chosen = this.form.shown("plant");
      const stays = this.touched && this.plants.some((each) => each.name === chosen);
      const kept3 = stays ? chosen : news.chosen || this.plants[0].name;
      this.form.choices(
        "plant",
        this.plants.map((each) => [each.name, each.why ? S.runNotFitting(each.name) : each.name]),
        kept3
      );
      const same = kept3 === chosen && before !== "[]";
      if (!same || !this.form.shown("reference")) this.chosen(false);
      if (!news.chosen) this.note(S.runFitsNone, true);
    };
    /** @returns {Messages.RunWork} */
    asked = () => {
      const { duration = "", ...form } = this.form.values();
      return {
        form,
        speed: this.speed.value === "" ? null : Number(this.speed.value),
        ...duration ? { [this.endless.checked ? "window" : "until"]: duration } : {}
      };
    };
    /** The same run on the command line. */
    showLine = () => {
      if (!this.details.open) return;
      const values = this.form.values();
      if (values.plant === this.likely) delete values.plant;
      if (this.endless.checked) delete values.duration;
      const file = quoted(this.hand.file());
      const what = this.direct ? [this.direct, "--rulebase", file] : [file];
      this.line.textContent = ["fuzzyarm", "simulate", ...what, ...this.form.words(values)].join(" ");
    };
    note = (words2, bad = false) => {
      this.said.textContent = words2;
      this.said.classList.toggle("error", bad);
      this.said.hidden = !words2;
    };
    /** Take back a note, where it is still there. */
    unsay = (words2) => {
      if (this.said.textContent === words2) this.note("");
    };
    /** Show which buttons do something. */
    running = ({ job, paused, over }) => {
      this.start.hidden = Boolean(job);
      this.again.hidden = !job;
      for (const each of [this.pause, this.step]) each.disabled = !job || over && !paused;
      this.stop.disabled = !job;
      this.pause.textContent = paused ? S.runResume : S.runPause;
    };
    time = (seconds, behind) => {
      this.clock.textContent = `${shortNumber(seconds, 5)} s${behind ? ` (${S.runBehind})` : ""}`;
    };
  };
  function gainPane(hand, move) {
    const { section, body } = pane("run-gains", S.runGains);
    const list = el("div", { class: "gains" });
    let shown = "";
    let rows = [];
    body.append(list);
    list.append(el("p", { class: "note", textContent: S.runGainsNote }));
    const share2 = ({ low, high, log }, value) => log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    const back = ({ low, high, log }, at2) => log ? low * (high / low) ** at2 : low + (high - low) * at2;
    function open2(gains) {
      const names = JSON.stringify(
        gains.map(({ name, values, low, high, log }) => [name, values.length, low, high, log])
      );
      if (names !== shown) {
        shown = names;
        rows = gains.flatMap((gain) => gain.values.map((_2, k) => row(gain, k)));
        list.replaceChildren(
          ...rows.length ? rows.map((each) => each.shown) : [el("p", { class: "note", textContent: S.runNoGains })]
        );
      }
      for (const each of rows) {
        const gain = gains.find(({ name }) => name === each.gain.name);
        Object.assign(each.gain, { values: [...gain.values], written: gain.written });
        each.set(gain.values[each.k]);
      }
    }
    function row(given, k) {
      const gain = { ...given, values: [...given.values] };
      const name = gain.values.length > 1 ? `${gain.name} ${k + 1}` : gain.name;
      const range = el("input", {
        type: "range",
        min: 0,
        max: STEPS2,
        step: 1,
        "aria-label": name,
        oninput: () => moved2(Number(back(gain, range.value / STEPS2).toPrecision(4)), false),
        onchange: () => moved2(Number(back(gain, range.value / STEPS2).toPrecision(4)), true)
      });
      const number = el("input", {
        type: "text",
        inputMode: "decimal",
        "aria-label": `${name}: ${S.value}`,
        onchange: () => moved2(Number(number.value), true)
      });
      const unit = el("span", { class: "unit", textContent: gain.unit });
      const label = el("span", { class: "name", textContent: name, title: gain.written ? "" : S.runGainElsewhere });
      const shownRow = el("div", { class: "gain" }, label, range, number, unit);
      function set(value) {
        const at2 = Math.round(STEPS2 * Math.min(1, Math.max(0, share2(gain, value))));
        if (document.activeElement !== range || Math.abs(range.value - at2) > 1) range.value = at2;
        range.setAttribute("aria-valuetext", `${shortNumber(value)} ${gain.unit}`);
        if (document.activeElement !== number) number.value = shortNumber(value, 6);
      }
      function moved2(value, done) {
        if (!Number.isFinite(value)) {
          number.value = shortNumber(gain.values[k], 6);
          return;
        }
        for (const each of rows) if (each.gain.name === gain.name) each.gain.values[k] = value;
        number.value = shortNumber(value, 6);
        range.setAttribute("aria-valuetext", `${shortNumber(value)} ${gain.unit}`);
        move({ [gain.name]: gain.values }, done && !gain.written);
        if (done && gain.written) hand.setGain(gain.name, gain.values);
      }
      return { gain, k, shown: shownRow, set };
    }
    return { section, open: open2 };
  }
  function metricPane() {
    const { section, body } = pane("run-metrics", S.runMetrics);
    const table = el("table", { class: "metrics" });
    let units = {};
    body.tabIndex = 0;
    body.append(table);
    function open2(ready) {
      units = ready.units;
      table.replaceChildren();
    }
    function show(metrics) {
      const outputs = Object.keys(metrics);
      if (!outputs.length) return;
      const names = Object.keys(metrics[outputs[0]]);
      const sorted = [...FIRST, ...names.filter((name) => !FIRST.includes(name))];
      const cell = (name, output) => {
        const value = metrics[output][name];
        return el("td", {
          textContent: value === null ? "\u2013" : `${shortNumber(value)} ${units[output]?.[name] ?? ""}`.trim()
        });
      };
      table.replaceChildren(
        el("caption", { class: "unseen", textContent: S.runMetrics }),
        el(
          "thead",
          {},
          el(
            "tr",
            {},
            el("th", { scope: "col", textContent: S.runErrorOf }),
            ...outputs.map((output) => el("th", { scope: "col", textContent: output }))
          )
        ),
        el(
          "tbody",
          {},
          ...sorted.map(
            (name) => el(
              "tr",
              { class: FIRST.includes(name) ? "first" : "" },
              el("th", { scope: "row", textContent: S.runMetric[name] ?? name, title: S.runMetricHint[name] ?? "" }),
              ...outputs.map((output) => cell(name, output))
            )
          )
        )
      );
    }
    return { section, open: open2, show };
  }

  // connection.js
  var AGAIN = 700;
  function socketLine({ opened: opened2, heard, closed }) {
    const address2 = new URL("socket", location.href);
    address2.protocol = "ws:";
    address2.hash = "";
    const socket = new WebSocket(address2);
    socket.onopen = opened2;
    socket.onmessage = (event) => heard(event.data);
    socket.onclose = () => closed(true);
    return {
      send: (text) => socket.send(text),
      isOpen: () => socket.readyState === WebSocket.OPEN,
      drop: () => socket.close()
    };
  }
  function connect({ opened: opened2, closed, take }, line = socketLine) {
    return new Connection({ opened: opened2, closed, take }, line).api();
  }
  var Connection = class {
    constructor({ opened: opened2, closed, take }, line) {
      this.opened = opened2;
      this.closed = closed;
      this.take = take;
      this.makeLine = line;
      this.line = null;
      this.asked = 0;
      this.begun = false;
      this.early = [];
      this.answers = /* @__PURE__ */ new Map();
      this.jobs = /* @__PURE__ */ new Map();
      this.ANSWERS = {
        answer: (message) => {
          this.answers.get(message.id)?.(message);
          this.answers.delete(message.id);
        },
        job: (message) => {
          const hear = this.jobs.get(message.id);
          if (message.end) this.jobs.delete(message.id);
          hear?.(message);
        }
      };
    }
    api() {
      return {
        open: this.open,
        send: this.send,
        /** Ask of the text of a file. */
        ask: (file, asked_for) => this.question({ ...asked_for, do: "ask", file }),
        /** Save a file; the answer has an `error` where it has not been saved. */
        save: (file) => this.question({ do: "save", file }),
        /** Ask of the folder, or have something done in it. */
        folder: (asked_for) => this.question({ ...asked_for, do: "folder" }),
        /** Begin long work on a file. `hear` takes its news, the last with `end`; what comes back tells and stops it. */
        start: (file, what, asked_for, hear) => {
          const id2 = ++this.asked;
          if (this.send({ ...asked_for, do: "start", file, id: id2, what })) this.jobs.set(id2, hear);
          else queueMicrotask(() => hear({ end: "failed", message: S.gone }));
          return { say: (words2) => this.send({ ...words2, do: "say", id: id2 }), stop: () => this.send({ do: "stop", id: id2 }) };
        },
        isOpen: this.isOpen,
        drop: () => this.line.drop()
      };
    }
    isOpen = () => Boolean(this.line?.isOpen());
    send = (message) => {
      if (!this.begun) return this.early.push(message) > 0;
      if (!this.isOpen()) return false;
      this.line.send(JSON.stringify(message));
      return true;
    };
    question = (message) => {
      const id2 = ++this.asked;
      return new Promise((resolve) => {
        if (this.send({ ...message, id: id2 })) this.answers.set(id2, resolve);
        else resolve({ error: S.gone });
      });
    };
    open = () => {
      this.line = this.makeLine({ opened: this.begin, heard: this.hear, closed: this.end });
    };
    begin = () => {
      this.begun = true;
      this.opened();
      for (const message of this.early.splice(0)) this.send(message);
    };
    hear = (text) => {
      const message = JSON.parse(text);
      (this.ANSWERS[message.is] ?? this.take)(message);
    };
    end = (again) => {
      for (const resolve of this.answers.values()) resolve({ error: S.gone });
      this.answers.clear();
      for (const hear of this.jobs.values()) hear({ end: "failed", message: S.gone });
      this.jobs.clear();
      this.closed();
      if (again) setTimeout(this.open, AGAIN);
    };
  };

  // front:engine
  var { Engine } = globalThis.fuzzyarm;

  // store.js
  var ACROSS = 61;
  var evenly = ([low, high], points) => Float64Array.from({ length: points }, (_2, k) => low + (high - low) * k / (points - 1));
  var Store = class {
    constructor() {
      this.listeners = {};
      this.scene = null;
      this.engine = null;
      this.held = null;
      this.reshaped = /* @__PURE__ */ new Map();
      this.busy = false;
      this.point = [];
      this.axes = { x: 0, y: 1, output: 0 };
      this.stale = false;
      this.sound = false;
      this.findings = [];
      this.far = null;
      this.told = null;
      this.view = "";
      this.diagram = null;
      this.refused = "";
      this.why = "";
      this.coarse = null;
      this.cost = null;
      this.asDiagram = true;
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
      const same = this.scene && JSON.stringify(this.scene.inputs.map((v) => [v.name, v.low, v.high])) === JSON.stringify(scene.inputs.map((v) => [v.name, v.low, v.high]));
      for (const variable of [...scene.inputs, ...scene.outputs]) {
        for (const term of variable.terms) {
          for (const shape of sidesOf(term)) {
            shape.parameters = shape.parameters.map(Number);
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
      this.curves = this.engine ?? new Engine(none);
      this.held = this.far = this.told = this.cost = null;
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
     * Take the block diagram of a controller, or that there is none.
     *
     * @param {Messages.SceneDiagram | null} diagram
     */
    draw(diagram) {
      this.diagram = diagram;
      if (diagram) this.stale = false;
      this.emit("diagram");
    }
    /** Show the block diagram or the rules, of a file that has both. */
    turnDiagram(shown) {
      this.asDiagram = shown;
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
    setPoint(index, value) {
      const [low, high] = rangeOf(this.scene.inputs[index]);
      this.point[index] = Math.min(high, Math.max(low, value));
      this.emit("point");
    }
    setAxes(axes2) {
      Object.assign(this.axes, axes2);
      this.emit("axes");
    }
    // --- terms ---
    /** Parameters and height of a shape as they are drawn: what a hand holds, or the text's. */
    now(variable, shape) {
      return this.reshaped.get(shapeKey(variable, shape)) ?? shape;
    }
    /** Degrees of a shape at some positions, as it is drawn, or with other numbers. */
    degrees(variable, shape, x2, now = this.now(variable, shape)) {
      const numbers = Float64Array.from(this.numbersOf(shape, now));
      const found = this.curves.degrees(shape.curve.address, numbers, x2);
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
          if (numbers.length === mark.room) engine.patch(mark.floats, numbers);
        } else if (mark.sort === "value") engine.patch(mark.floats, [now.parameters[0]]);
        else if (mark.sort === "samples") {
          const output = this.scene.outputs.findIndex((each) => each.name === variable.name);
          engine.patch(mark.floats, this.degrees(variable, shape, engine.positions(output), now));
        } else {
          const corners = cornersOf(shape, now.parameters, now.height);
          const pieces = piecesOf(corners, ...rangeOf(variable));
          engine.patch(mark.floats, pieces.slice(0, 4 * mark.room));
          engine.patchWhole(mark.row, Math.min(mark.room, pieces.length / 4));
        }
      }
    }
    // --- values ---
    /** Which surface is shown: what else it depends on than the point within it. */
    surfaceKey() {
      const { x: x2, y, output } = this.axes;
      return JSON.stringify([x2, y, output, this.point.filter((_2, i) => i !== x2 && i !== y)]);
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
      const { x: x2, y, output } = this.axes;
      const flat = x2 === y;
      const rows = flat ? 1 : points;
      const columns = this.scene.inputs.map((_2, i) => new Float64Array(points * rows).fill(this.point[i]));
      const [xs2, ys2] = [x2, y].map((i) => evenly(rangeOf(this.scene.inputs[i]), points));
      for (let j2 = 0; j2 < rows; j2++) {
        for (let i = 0; i < points; i++) {
          columns[x2][j2 * points + i] = xs2[i];
          if (!flat) columns[y][j2 * points + i] = ys2[j2];
        }
      }
      const start2 = performance.now();
      const z2 = this.running.many(columns)[output];
      const cost = (performance.now() - start2) / (points * rows);
      this.cost = Math.min(cost, this.cost ?? cost);
      return { xs: xs2, ys: ys2, z: z2, rows };
    }
    /** The output shown along one input through the point; of the server's surface by its lines. */
    section(input, points = 2 * ACROSS - 1) {
      const xs2 = evenly(rangeOf(this.scene.inputs[input]), points);
      if (this.running) {
        const few = this.coarse ? ACROSS : points;
        const at2 = few === points ? xs2 : evenly([xs2[0], xs2[points - 1]], few);
        const columns = this.scene.inputs.map((_2, i) => i === input ? at2 : new Float64Array(few).fill(this.point[i]));
        return { xs: at2, z: this.running.many(columns)[this.axes.output] };
      }
      const found = this.surface();
      if (!found) return null;
      const { x: x2, y } = this.axes;
      if (x2 === y) return { xs: found.xs, z: found.z };
      const other = input === x2 ? y : x2;
      const lines = other === x2 ? found.xs : found.ys;
      const n66 = lines.length;
      const share2 = (this.point[other] - lines[0]) / (lines[n66 - 1] - lines[0]) * (n66 - 1);
      const low = Math.min(n66 - 2, Math.max(0, Math.floor(share2)));
      const value = (i, k) => other === x2 ? found.z[i * n66 + k] : found.z[k * n66 + i];
      const z2 = Float64Array.from(
        { length: n66 },
        (_2, i) => value(i, low) + (share2 - low) * (value(i, low + 1) - value(i, low))
      );
      return { xs: input === x2 ? found.xs : found.ys, z: z2 };
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
        const of3 = (rule, side) => read.strengths[rule.readings[Math.min(side, rule.readings.length - 1)]];
        found = {
          outputs: read.outputs,
          ends: scene.outputs.some((each) => each.interval) ? this.running.ends(this.point) : null,
          strengths: scene.rules.map((rule) => of3(rule, 0)),
          lower: scene.rules.map((rule) => of3(rule, 1)),
          all: read.strengths
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
  };

  // remote.js
  var WAIT = 60;
  function askServer(store2, start2) {
    let work = null;
    let asked = "";
    let waiting = 0;
    const wanted = () => {
      if (!store2.scene || store2.scene.missing.length || store2.stale || store2.busy || store2.running && !store2.coarse)
        return "";
      return store2.surfaceKey() + (store2.running ? "" : JSON.stringify(store2.point));
    };
    function ask2() {
      const key2 = wanted();
      if (!key2 || key2 === asked) return;
      if (work) {
        work.stop();
        return;
      }
      asked = key2;
      const { scene, point, axes: axes2 } = store2;
      const surface = store2.surfaceKey();
      const isKnown = store2.far?.key === surface && !store2.running;
      const ends = [axes2.x, axes2.y].map((i) => rangeOf(scene.inputs[i]));
      const across = isKnown ? 2 : ACROSS;
      work = start2("surface", { ...axes2, point, ends, across, fired: !store2.running }, (news) => {
        if (store2.scene !== scene) {
          if (news.end) again();
          return;
        }
        if (news.strengths) {
          store2.told = { strengths: news.strengths, outputs: news.outputs.map((value) => value ?? NaN) };
          store2.emit("told");
        }
        if (news.z && !isKnown) {
          const [xs2, ys2] = ends.map(
            ([low, high]) => Float64Array.from({ length: across }, (_2, k) => low + (high - low) * k / (across - 1))
          );
          const z2 = Float64Array.from(news.z, (value) => value ?? NaN);
          store2.far = { key: surface, xs: xs2, ys: ys2, z: z2, rows: axes2.x === axes2.y ? 1 : across, isFar: true };
          store2.emit("told");
        }
        if (news.end === "failed") {
          store2.refused = news.message;
          store2.emit("told");
        }
        if (news.end) again();
      });
    }
    function again() {
      work = null;
      if (wanted() !== asked) soon();
    }
    function soon() {
      clearTimeout(waiting);
      waiting = setTimeout(ask2, WAIT);
    }
    store2.on("scene", () => {
      asked = store2.refused = "";
      soon();
    });
    for (const name of ["point", "axes", "reshaped", "coarse"]) store2.on(name, soon);
  }

  // vendor/codemirror.js
  var qs = [];
  var Dl = [];
  (() => {
    let n66 = "lc,34,7n,7,7b,19,,,,2,,2,,,20,b,1c,l,g,,2t,7,2,6,2,2,,4,z,,u,r,2j,b,1m,9,9,,o,4,,9,,3,,5,17,3,1n,9,16,o,,x,1i,3,,i,,7,a,2,t,3,1k,,,7,2,2,2,3,9,,a,2,q,,2,3,1k,,,5,4,2,2,3,3,,u,2,3,,b,3,1k,,,8,,3,,3,k,2,m,6,,3,1k,,,7,2,2,2,3,7,3,a,2,u,,1n,5,3,3,,4,9,,14,5,1j,,,7,,3,,4,7,2,b,2,t,3,1k,,,7,,3,,4,7,2,b,2,f,,c,4,1j,2,,7,,3,,4,9,,a,2,t,3,1y,,4,6,,,,8,i,2,1p,,,8,c,8,2q,,,a,b,7,21,2,r,,,,,,4,2,1d,k,,2,5,b,,10,9,,2u,b,,6,n,4,4,3,g,4,d,,,3,6,,f,,jj,3,qa,4,s,3,t,2,u,2,1s,w,9,,19,3,,,39,2,y,,3a,c,4,c,63,5,1l,a,,,,,2,o,2,,1c,1a,2,c,k,5,1b,h,12,9,c,3,u,d,1k,e,1c,k,48,3,,l,4,,6,,2,3,5i,1s,ek,,5f,x,2da,3,3x,,2o,w,fe,6,2x,2,n9w,4,,a,w,2,28,2,7k,,3,,4,,n,5,4,,2b,2,1e,i,q,i,d,,12,8,p,d,18,4,1b,e,10,,1v,e,c,,8,2,1a,,1f,,,3,2,2,5,2,,,15,5,5,2,6k,8,,2,fn4,,kh,g,g,g,a6,2,gt,,6a,,45,5,1ae,3,,2,5,4,14,3,4,,4l,2,fx,4,1t,5,8t,2,25,6,1y,b,1d,4,3e,3,1h,f,15,,2,2,a,4,19,b,7,,1p,3,10,e,g,2,18,,c,3,1c,e,8,4,,2,2k,c,6,,2,,4d,c,l,4,1j,2,,7,2,2,2,3,9,,a,2,2,7,3,5,1v,9,,,2,,,4,,5,,,e,2,2a,i,n,,29,k,6j,7,2,9,r,2,2a,h,2y,d,2t,3,2,a,74,f,6t,6,,2,2,4,,,,2,3x,7,2,7,3,,s,a,14,7,,4,8,,9,b,1a,g,5i,8,5j,8,,8,2a,m,,e,3e,6,3,,,2,,7,,,1u,5,,2,,5,9n,4,9,2,,,1c,7,3,5,n,,44l,,6,f,8ug,i,1xc,5,1n,7,t4,,,1j,7,4,29,,b,2,f57,2,3mp,1a,2,n,f2,5,3,6,8,8,2,7,u,4,44,3,1iz,1j,4,1e,8,,e,,m,5,,f,11s,7,,h,2,7,,2,,5,2s,,4g,7,af,,1p,4,e4,4,72,2,6r,,2,,7,2,5,,d6,7,31,7,240,5".split(",").map((e) => e ? parseInt(e, 36) : 1);
    for (let e = 0, t = 0; e < n66.length; e++) (e % 2 ? Dl : qs).push(t = t + n66[e]);
  })();
  function uf2(n66) {
    if (n66 < 768) return false;
    for (let e = 0, t = qs.length; ; ) {
      let i = e + t >> 1;
      if (n66 < qs[i]) t = i;
      else if (n66 >= Dl[i]) e = i + 1;
      else return true;
      if (e == t) return false;
    }
  }
  function Al2(n66) {
    return n66 >= 127462 && n66 <= 127487;
  }
  var Ml2 = 8205;
  function Ol(n66, e, t = true, i = true) {
    return (t ? Bl2 : df2)(n66, e, i);
  }
  function Bl2(n66, e, t) {
    if (e == n66.length) return e;
    e && El2(n66.charCodeAt(e)) && Ll(n66.charCodeAt(e - 1)) && e--;
    let i = zs(n66, e);
    for (e += Tl2(i); e < n66.length; ) {
      let s = zs(n66, e);
      if (i == Ml2 || s == Ml2 || t && uf2(s)) e += Tl2(s), i = s;
      else if (Al2(s)) {
        let r = 0, o = e - 2;
        for (; o >= 0 && Al2(zs(n66, o)); ) r++, o -= 2;
        if (r % 2 == 0) break;
        e += 2;
      } else break;
    }
    return e;
  }
  function df2(n66, e, t) {
    for (; e > 1; ) {
      let i = Bl2(n66, e - 2, t);
      if (i < e) return i;
      e--;
    }
    return 0;
  }
  function zs(n66, e) {
    let t = n66.charCodeAt(e);
    if (!Ll(t) || e + 1 == n66.length) return t;
    let i = n66.charCodeAt(e + 1);
    return El2(i) ? (t - 55296 << 10) + (i - 56320) + 65536 : t;
  }
  function El2(n66) {
    return n66 >= 56320 && n66 < 57344;
  }
  function Ll(n66) {
    return n66 >= 55296 && n66 < 56320;
  }
  function Tl2(n66) {
    return n66 < 65536 ? 1 : 2;
  }
  var F = class n {
    lineAt(e) {
      if (e < 0 || e > this.length) throw new RangeError(`Invalid position ${e} in document of length ${this.length}`);
      return this.lineInner(e, false, 1, 0);
    }
    line(e) {
      if (e < 1 || e > this.lines) throw new RangeError(`Invalid line number ${e} in ${this.lines}-line document`);
      return this.lineInner(e, true, 1, 0);
    }
    replace(e, t, i) {
      [e, t] = _t(this, e, t);
      let s = [];
      return this.decompose(0, e, s, 2), i.length && i.decompose(0, i.length, s, 3), this.decompose(t, this.length, s, 1), jt.from(s, this.length - (t - e) + i.length);
    }
    append(e) {
      return this.replace(this.length, this.length, e);
    }
    slice(e, t = this.length) {
      [e, t] = _t(this, e, t);
      let i = [];
      return this.decompose(e, t, i, 0), jt.from(i, t - e);
    }
    eq(e) {
      if (e == this) return true;
      if (e.length != this.length || e.lines != this.lines) return false;
      let t = this.scanIdentical(e, 1), i = this.length - this.scanIdentical(e, -1), s = new Tt(this), r = new Tt(e);
      for (let o = t, l = t; ; ) {
        if (s.next(o), r.next(o), o = 0, s.lineBreak != r.lineBreak || s.done != r.done || s.value != r.value) return false;
        if (l += s.value.length, s.done || l >= i) return true;
      }
    }
    iter(e = 1) {
      return new Tt(this, e);
    }
    iterRange(e, t = this.length) {
      return new un2(this, e, t);
    }
    iterLines(e, t) {
      let i;
      if (e == null) i = this.iter();
      else {
        t == null && (t = this.lines + 1);
        let s = this.line(e).from;
        i = this.iterRange(s, Math.max(s, t == this.lines + 1 ? this.length : t <= 1 ? 0 : this.line(t - 1).to));
      }
      return new dn2(i);
    }
    toString() {
      return this.sliceString(0);
    }
    toJSON() {
      let e = [];
      return this.flatten(e), e;
    }
    constructor() {
    }
    static of(e) {
      if (e.length == 0) throw new RangeError("A document must have at least one line");
      return e.length == 1 && !e[0] ? n.empty : e.length <= 32 ? new ve(e) : jt.from(ve.split(e, []));
    }
  };
  var ve = class n2 extends F {
    constructor(e, t = pf2(e)) {
      super(), this.text = e, this.length = t;
    }
    get lines() {
      return this.text.length;
    }
    get children() {
      return null;
    }
    lineInner(e, t, i, s) {
      for (let r = 0; ; r++) {
        let o = this.text[r], l = s + o.length;
        if ((t ? i : l) >= e) return new $s(s, l, i, o);
        s = l + 1, i++;
      }
    }
    decompose(e, t, i, s) {
      let r = e <= 0 && t >= this.length ? this : new n2(Rl(this.text, e, t), Math.min(t, this.length) - Math.max(0, e));
      if (s & 1) {
        let o = i.pop(), l = fn2(r.text, o.text.slice(), 0, r.length);
        if (l.length <= 32) i.push(new n2(l, o.length + r.length));
        else {
          let a = l.length >> 1;
          i.push(new n2(l.slice(0, a)), new n2(l.slice(a)));
        }
      } else i.push(r);
    }
    replace(e, t, i) {
      if (!(i instanceof n2)) return super.replace(e, t, i);
      [e, t] = _t(this, e, t);
      let s = fn2(this.text, fn2(i.text, Rl(this.text, 0, e)), t), r = this.length + i.length - (t - e);
      return s.length <= 32 ? new n2(s, r) : jt.from(n2.split(s, []), r);
    }
    sliceString(e, t = this.length, i = `
`) {
      [e, t] = _t(this, e, t);
      let s = "";
      for (let r = 0, o = 0; r <= t && o < this.text.length; o++) {
        let l = this.text[o], a = r + l.length;
        r > e && o && (s += i), e < a && t > r && (s += l.slice(Math.max(0, e - r), t - r)), r = a + 1;
      }
      return s;
    }
    flatten(e) {
      for (let t of this.text) e.push(t);
    }
    scanIdentical() {
      return 0;
    }
    static split(e, t) {
      let i = [], s = -1;
      for (let r of e) i.push(r), s += r.length + 1, i.length == 32 && (t.push(new n2(i, s)), i = [], s = -1);
      return s > -1 && t.push(new n2(i, s)), t;
    }
  };
  var jt = class n3 extends F {
    constructor(e, t) {
      super(), this.children = e, this.length = t, this.lines = 0;
      for (let i of e) this.lines += i.lines;
    }
    lineInner(e, t, i, s) {
      for (let r = 0; ; r++) {
        let o = this.children[r], l = s + o.length, a = i + o.lines - 1;
        if ((t ? a : l) >= e) return o.lineInner(e, t, i, s);
        s = l + 1, i = a + 1;
      }
    }
    decompose(e, t, i, s) {
      for (let r = 0, o = 0; o <= t && r < this.children.length; r++) {
        let l = this.children[r], a = o + l.length;
        if (e <= a && t >= o) {
          let h = s & ((o <= e ? 1 : 0) | (a >= t ? 2 : 0));
          o >= e && a <= t && !h ? i.push(l) : l.decompose(e - o, t - o, i, h);
        }
        o = a + 1;
      }
    }
    replace(e, t, i) {
      if ([e, t] = _t(this, e, t), i.lines < this.lines) for (let s = 0, r = 0; s < this.children.length; s++) {
        let o = this.children[s], l = r + o.length;
        if (e >= r && t <= l) {
          let a = o.replace(e - r, t - r, i), h = this.lines - o.lines + a.lines;
          if (a.lines < h >> 4 && a.lines > h >> 6) {
            let c = this.children.slice();
            return c[s] = a, new n3(c, this.length - (t - e) + i.length);
          }
          return super.replace(r, l, a);
        }
        r = l + 1;
      }
      return super.replace(e, t, i);
    }
    sliceString(e, t = this.length, i = `
`) {
      [e, t] = _t(this, e, t);
      let s = "";
      for (let r = 0, o = 0; r < this.children.length && o <= t; r++) {
        let l = this.children[r], a = o + l.length;
        o > e && r && (s += i), e < a && t > o && (s += l.sliceString(e - o, t - o, i)), o = a + 1;
      }
      return s;
    }
    flatten(e) {
      for (let t of this.children) t.flatten(e);
    }
    scanIdentical(e, t) {
      if (!(e instanceof n3)) return 0;
      let i = 0, [s, r, o, l] = t > 0 ? [0, 0, this.children.length, e.children.length] : [this.children.length - 1, e.children.length - 1, -1, -1];
      for (; ; s += t, r += t) {
        if (s == o || r == l) return i;
        let a = this.children[s], h = e.children[r];
        if (a != h) return i + a.scanIdentical(h, t);
        i += a.length + 1;
      }
    }
    static from(e, t = e.reduce((i, s) => i + s.length + 1, -1)) {
      let i = 0;
      for (let d of e) i += d.lines;
      if (i < 32) {
        let d = [];
        for (let p of e) p.flatten(d);
        return new ve(d, t);
      }
      let s = Math.max(32, i >> 5), r = s << 1, o = s >> 1, l = [], a = 0, h = -1, c = [];
      function f(d) {
        let p;
        if (d.lines > r && d instanceof n3) for (let m of d.children) f(m);
        else d.lines > o && (a > o || !a) ? (u(), l.push(d)) : d instanceof ve && a && (p = c[c.length - 1]) instanceof ve && d.lines + p.lines <= 32 ? (a += d.lines, h += d.length + 1, c[c.length - 1] = new ve(p.text.concat(d.text), p.length + 1 + d.length)) : (a + d.lines > s && u(), a += d.lines, h += d.length + 1, c.push(d));
      }
      function u() {
        a != 0 && (l.push(c.length == 1 ? c[0] : n3.from(c, h)), h = -1, a = c.length = 0);
      }
      for (let d of e) f(d);
      return u(), l.length == 1 ? l[0] : new n3(l, t);
    }
  };
  F.empty = new ve([""], 0);
  function pf2(n66) {
    let e = -1;
    for (let t of n66) e += t.length + 1;
    return e;
  }
  function fn2(n66, e, t = 0, i = 1e9) {
    for (let s = 0, r = 0, o = true; r < n66.length && s <= i; r++) {
      let l = n66[r], a = s + l.length;
      a >= t && (a > i && (l = l.slice(0, i - s)), s < t && (l = l.slice(t - s)), o ? (e[e.length - 1] += l, o = false) : e.push(l)), s = a + 1;
    }
    return e;
  }
  function Rl(n66, e, t) {
    return fn2(n66, [""], e, t);
  }
  var Tt = class {
    constructor(e, t = 1) {
      this.dir = t, this.done = false, this.lineBreak = false, this.value = "", this.nodes = [e], this.offsets = [t > 0 ? 1 : (e instanceof ve ? e.text.length : e.children.length) << 1];
    }
    nextInner(e, t) {
      for (this.done = this.lineBreak = false; ; ) {
        let i = this.nodes.length - 1, s = this.nodes[i], r = this.offsets[i], o = r >> 1, l = s instanceof ve ? s.text.length : s.children.length;
        if (o == (t > 0 ? l : 0)) {
          if (i == 0) return this.done = true, this.value = "", this;
          t > 0 && this.offsets[i - 1]++, this.nodes.pop(), this.offsets.pop();
        } else if ((r & 1) == (t > 0 ? 0 : 1)) {
          if (this.offsets[i] += t, e == 0) return this.lineBreak = true, this.value = `
`, this;
          e--;
        } else if (s instanceof ve) {
          let a = s.text[o + (t < 0 ? -1 : 0)];
          if (this.offsets[i] += t, a.length > Math.max(0, e)) return this.value = e == 0 ? a : t > 0 ? a.slice(e) : a.slice(0, a.length - e), this;
          e -= a.length;
        } else {
          let a = s.children[o + (t < 0 ? -1 : 0)];
          e > a.length ? (e -= a.length, this.offsets[i] += t) : (t < 0 && this.offsets[i]--, this.nodes.push(a), this.offsets.push(t > 0 ? 1 : (a instanceof ve ? a.text.length : a.children.length) << 1));
        }
      }
    }
    next(e = 0) {
      return e < 0 && (this.nextInner(-e, -this.dir), e = this.value.length), this.nextInner(e, this.dir);
    }
  };
  var un2 = class {
    constructor(e, t, i) {
      this.value = "", this.done = false, this.cursor = new Tt(e, t > i ? -1 : 1), this.pos = t > i ? e.length : 0, this.from = Math.min(t, i), this.to = Math.max(t, i);
    }
    nextInner(e, t) {
      if (t < 0 ? this.pos <= this.from : this.pos >= this.to) return this.value = "", this.done = true, this;
      e += Math.max(0, t < 0 ? this.pos - this.to : this.from - this.pos);
      let i = t < 0 ? this.pos - this.from : this.to - this.pos;
      e > i && (e = i), i -= e;
      let { value: s } = this.cursor.next(e);
      return this.pos += (s.length + e) * t, this.value = s.length <= i ? s : t < 0 ? s.slice(s.length - i) : s.slice(0, i), this.done = !this.value, this;
    }
    next(e = 0) {
      return e < 0 ? e = Math.max(e, this.from - this.pos) : e > 0 && (e = Math.min(e, this.to - this.pos)), this.nextInner(e, this.cursor.dir);
    }
    get lineBreak() {
      return this.cursor.lineBreak && this.value != "";
    }
  };
  var dn2 = class {
    constructor(e) {
      this.inner = e, this.afterBreak = true, this.value = "", this.done = false;
    }
    next(e = 0) {
      let { done: t, lineBreak: i, value: s } = this.inner.next(e);
      return t && this.afterBreak ? (this.value = "", this.afterBreak = false) : t ? (this.done = true, this.value = "") : i ? this.afterBreak ? this.value = "" : (this.afterBreak = true, this.next()) : (this.value = s, this.afterBreak = false), this;
    }
    get lineBreak() {
      return false;
    }
  };
  typeof Symbol < "u" && (F.prototype[Symbol.iterator] = function() {
    return this.iter();
  }, Tt.prototype[Symbol.iterator] = un2.prototype[Symbol.iterator] = dn2.prototype[Symbol.iterator] = function() {
    return this;
  });
  var $s = class {
    constructor(e, t, i, s) {
      this.from = e, this.to = t, this.number = i, this.text = s;
    }
    get length() {
      return this.to - this.from;
    }
  };
  function _t(n66, e, t) {
    return e = Math.max(0, Math.min(n66.length, e)), [e, Math.max(e, Math.min(n66.length, t))];
  }
  function Z(n66, e, t = true, i = true) {
    return Ol(n66, e, t, i);
  }
  function mf2(n66) {
    return n66 >= 56320 && n66 < 57344;
  }
  function gf2(n66) {
    return n66 >= 55296 && n66 < 56320;
  }
  function De(n66, e) {
    let t = n66.charCodeAt(e);
    if (!gf2(t) || e + 1 == n66.length) return t;
    let i = n66.charCodeAt(e + 1);
    return mf2(i) ? (t - 55296 << 10) + (i - 56320) + 65536 : t;
  }
  function bn(n66) {
    return n66 <= 65535 ? String.fromCharCode(n66) : (n66 -= 65536, String.fromCharCode((n66 >> 10) + 55296, (n66 & 1023) + 56320));
  }
  function Xe2(n66) {
    return n66 < 65536 ? 1 : 2;
  }
  var js = /\r\n?|\n/;
  var ue = (function(n66) {
    return n66[n66.Simple = 0] = "Simple", n66[n66.TrackDel = 1] = "TrackDel", n66[n66.TrackBefore = 2] = "TrackBefore", n66[n66.TrackAfter = 3] = "TrackAfter", n66;
  })(ue || (ue = {}));
  var ot = class n4 {
    constructor(e) {
      this.sections = e;
    }
    get length() {
      let e = 0;
      for (let t = 0; t < this.sections.length; t += 2) e += this.sections[t];
      return e;
    }
    get newLength() {
      let e = 0;
      for (let t = 0; t < this.sections.length; t += 2) {
        let i = this.sections[t + 1];
        e += i < 0 ? this.sections[t] : i;
      }
      return e;
    }
    get empty() {
      return this.sections.length == 0 || this.sections.length == 2 && this.sections[1] < 0;
    }
    iterGaps(e) {
      for (let t = 0, i = 0, s = 0; t < this.sections.length; ) {
        let r = this.sections[t++], o = this.sections[t++];
        o < 0 ? (e(i, s, r), s += r) : s += o, i += r;
      }
    }
    iterChangedRanges(e, t = false) {
      Us(this, e, t);
    }
    get invertedDesc() {
      let e = [];
      for (let t = 0; t < this.sections.length; ) {
        let i = this.sections[t++], s = this.sections[t++];
        s < 0 ? e.push(i, s) : e.push(s, i);
      }
      return new n4(e);
    }
    composeDesc(e) {
      return this.empty ? e : e.empty ? this : Hl2(this, e);
    }
    mapDesc(e, t = false) {
      return e.empty ? this : Gs(this, e, t);
    }
    mapPos(e, t = -1, i = ue.Simple) {
      let s = 0, r = 0;
      for (let o = 0; o < this.sections.length; ) {
        let l = this.sections[o++], a = this.sections[o++], h = s + l;
        if (a < 0) {
          if (h > e) return r + (e - s);
          r += l;
        } else {
          if (i != ue.Simple && h >= e && (i == ue.TrackDel && s < e && h > e || i == ue.TrackBefore && s < e || i == ue.TrackAfter && h > e)) return null;
          if (h > e || h == e && t < 0 && !l) return e == s || t < 0 ? r : r + a;
          r += a;
        }
        s = h;
      }
      if (e > s) throw new RangeError(`Position ${e} is out of range for changeset of length ${s}`);
      return r;
    }
    touchesRange(e, t = e) {
      for (let i = 0, s = 0; i < this.sections.length && s <= t; ) {
        let r = this.sections[i++], o = this.sections[i++], l = s + r;
        if (o >= 0 && s <= t && l >= e) return s < e && l > t ? "cover" : true;
        s = l;
      }
      return false;
    }
    toString() {
      let e = "";
      for (let t = 0; t < this.sections.length; ) {
        let i = this.sections[t++], s = this.sections[t++];
        e += (e ? " " : "") + i + (s >= 0 ? ":" + s : "");
      }
      return e;
    }
    toJSON() {
      return this.sections;
    }
    static fromJSON(e) {
      if (!Array.isArray(e) || e.length % 2 || e.some((t) => typeof t != "number")) throw new RangeError("Invalid JSON representation of ChangeDesc");
      return new n4(e);
    }
    static create(e) {
      return new n4(e);
    }
  };
  var ie = class n5 extends ot {
    constructor(e, t) {
      super(e), this.inserted = t;
    }
    apply(e) {
      if (this.length != e.length) throw new RangeError("Applying change set to a document with the wrong length");
      return Us(this, (t, i, s, r, o) => e = e.replace(s, s + (i - t), o), false), e;
    }
    mapDesc(e, t = false) {
      return Gs(this, e, t, true);
    }
    invert(e) {
      let t = this.sections.slice(), i = [];
      for (let s = 0, r = 0; s < t.length; s += 2) {
        let o = t[s], l = t[s + 1];
        if (l >= 0) {
          t[s] = l, t[s + 1] = o;
          let a = s >> 1;
          for (; i.length < a; ) i.push(F.empty);
          i.push(o ? e.slice(r, r + o) : F.empty);
        }
        r += o;
      }
      return new n5(t, i);
    }
    compose(e) {
      return this.empty ? e : e.empty ? this : Hl2(this, e, true);
    }
    map(e, t = false) {
      return e.empty ? this : Gs(this, e, t, true);
    }
    iterChanges(e, t = false) {
      Us(this, e, t);
    }
    get desc() {
      return ot.create(this.sections);
    }
    filter(e) {
      let t = [], i = [], s = [], r = new Dt2(this);
      e: for (let o = 0, l = 0; ; ) {
        let a = o == e.length ? 1e9 : e[o++];
        for (; l < a || l == a && r.len == 0; ) {
          if (r.done) break e;
          let c = Math.min(r.len, a - l);
          fe(s, c, -1);
          let f = r.ins == -1 ? -1 : r.off == 0 ? r.ins : 0;
          fe(t, c, f), f > 0 && ut2(i, t, r.text), r.forward(c), l += c;
        }
        let h = e[o++];
        for (; l < h; ) {
          if (r.done) break e;
          let c = Math.min(r.len, h - l);
          fe(t, c, -1), fe(s, c, r.ins == -1 ? -1 : r.off == 0 ? r.ins : 0), r.forward(c), l += c;
        }
      }
      return { changes: new n5(t, i), filtered: ot.create(s) };
    }
    toJSON() {
      let e = [];
      for (let t = 0; t < this.sections.length; t += 2) {
        let i = this.sections[t], s = this.sections[t + 1];
        s < 0 ? e.push(i) : s == 0 ? e.push([i]) : e.push([i].concat(this.inserted[t >> 1].toJSON()));
      }
      return e;
    }
    static of(e, t, i) {
      let s = [], r = [], o = 0, l = null;
      function a(c = false) {
        if (!c && !s.length) return;
        o < t && fe(s, t - o, -1);
        let f = new n5(s, r);
        l = l ? l.compose(f.map(l)) : f, s = [], r = [], o = 0;
      }
      function h(c) {
        if (Array.isArray(c)) for (let f of c) h(f);
        else if (c instanceof n5) {
          if (c.length != t) throw new RangeError(`Mismatched change set length (got ${c.length}, expected ${t})`);
          a(), l = l ? l.compose(c.map(l)) : c;
        } else {
          let { from: f, to: u = f, insert: d } = c;
          if (f > u || f < 0 || u > t) throw new RangeError(`Invalid change range ${f} to ${u} (in doc of length ${t})`);
          let p = d ? typeof d == "string" ? F.of(d.split(i || js)) : d : F.empty, m = p.length;
          if (f == u && m == 0) return;
          f < o && a(), f > o && fe(s, f - o, -1), fe(s, u - f, m), ut2(r, s, p), o = u;
        }
      }
      return h(e), a(!l), l;
    }
    static empty(e) {
      return new n5(e ? [e, -1] : [], []);
    }
    static fromJSON(e) {
      if (!Array.isArray(e)) throw new RangeError("Invalid JSON representation of ChangeSet");
      let t = [], i = [];
      for (let s = 0; s < e.length; s++) {
        let r = e[s];
        if (typeof r == "number") t.push(r, -1);
        else {
          if (!Array.isArray(r) || typeof r[0] != "number" || r.some((o, l) => l && typeof o != "string")) throw new RangeError("Invalid JSON representation of ChangeSet");
          if (r.length == 1) t.push(r[0], 0);
          else {
            for (; i.length < s; ) i.push(F.empty);
            i[s] = F.of(r.slice(1)), t.push(r[0], i[s].length);
          }
        }
      }
      return new n5(t, i);
    }
    static createSet(e, t) {
      return new n5(e, t);
    }
  };
  function fe(n66, e, t, i = false) {
    if (e == 0 && t <= 0) return;
    let s = n66.length - 2;
    s >= 0 && t <= 0 && t == n66[s + 1] ? n66[s] += e : s >= 0 && e == 0 && n66[s] == 0 ? n66[s + 1] += t : i ? (n66[s] += e, n66[s + 1] += t) : n66.push(e, t);
  }
  function ut2(n66, e, t) {
    if (t.length == 0) return;
    let i = e.length - 2 >> 1;
    if (i < n66.length) n66[n66.length - 1] = n66[n66.length - 1].append(t);
    else {
      for (; n66.length < i; ) n66.push(F.empty);
      n66.push(t);
    }
  }
  function Us(n66, e, t) {
    let i = n66.inserted;
    for (let s = 0, r = 0, o = 0; o < n66.sections.length; ) {
      let l = n66.sections[o++], a = n66.sections[o++];
      if (a < 0) s += l, r += l;
      else {
        let h = s, c = r, f = F.empty;
        for (; h += l, c += a, a && i && (f = f.append(i[o - 2 >> 1])), !(t || o == n66.sections.length || n66.sections[o + 1] < 0); ) l = n66.sections[o++], a = n66.sections[o++];
        e(s, h, r, c, f), s = h, r = c;
      }
    }
  }
  function Gs(n66, e, t, i = false) {
    let s = [], r = i ? [] : null, o = new Dt2(n66), l = new Dt2(e);
    for (let a = -1; ; ) {
      if (o.done && l.len || l.done && o.len) throw new Error("Mismatched change set lengths");
      if (o.ins == -1 && l.ins == -1) {
        let h = Math.min(o.len, l.len);
        fe(s, h, -1), o.forward(h), l.forward(h);
      } else if (l.ins >= 0 && (o.ins < 0 || a == o.i || o.off == 0 && (l.len < o.len || l.len == o.len && !t))) {
        let h = l.len;
        for (fe(s, l.ins, -1); h; ) {
          let c = Math.min(o.len, h);
          o.ins >= 0 && a < o.i && o.len <= c && (fe(s, 0, o.ins), r && ut2(r, s, o.text), a = o.i), o.forward(c), h -= c;
        }
        l.next();
      } else if (o.ins >= 0) {
        let h = 0, c = o.len;
        for (; c; ) if (l.ins == -1) {
          let f = Math.min(c, l.len);
          h += f, c -= f, l.forward(f);
        } else if (l.ins == 0 && l.len < c) c -= l.len, l.next();
        else break;
        fe(s, h, a < o.i ? o.ins : 0), r && a < o.i && ut2(r, s, o.text), a = o.i, o.forward(o.len - c);
      } else {
        if (o.done && l.done) return r ? ie.createSet(s, r) : ot.create(s);
        throw new Error("Mismatched change set lengths");
      }
    }
  }
  function Hl2(n66, e, t = false) {
    let i = [], s = t ? [] : null, r = new Dt2(n66), o = new Dt2(e);
    for (let l = false; ; ) {
      if (r.done && o.done) return s ? ie.createSet(i, s) : ot.create(i);
      if (r.ins == 0) fe(i, r.len, 0, l), r.next();
      else if (o.len == 0 && !o.done) fe(i, 0, o.ins, l), s && ut2(s, i, o.text), o.next();
      else {
        if (r.done || o.done) throw new Error("Mismatched change set lengths");
        {
          let a = Math.min(r.len2, o.len), h = i.length;
          if (r.ins == -1) {
            let c = o.ins == -1 ? -1 : o.off ? 0 : o.ins;
            fe(i, a, c, l), s && c && ut2(s, i, o.text);
          } else o.ins == -1 ? (fe(i, r.off ? 0 : r.len, a, l), s && ut2(s, i, r.textBit(a))) : (fe(i, r.off ? 0 : r.len, o.off ? 0 : o.ins, l), s && !o.off && ut2(s, i, o.text));
          l = (r.ins > a || o.ins >= 0 && o.len > a) && (l || i.length > h), r.forward2(a), o.forward(a);
        }
      }
    }
  }
  var Dt2 = class {
    constructor(e) {
      this.set = e, this.i = 0, this.next();
    }
    next() {
      let { sections: e } = this.set;
      this.i < e.length ? (this.len = e[this.i++], this.ins = e[this.i++]) : (this.len = 0, this.ins = -2), this.off = 0;
    }
    get done() {
      return this.ins == -2;
    }
    get len2() {
      return this.ins < 0 ? this.len : this.ins;
    }
    get text() {
      let { inserted: e } = this.set, t = this.i - 2 >> 1;
      return t >= e.length ? F.empty : e[t];
    }
    textBit(e) {
      let { inserted: t } = this.set, i = this.i - 2 >> 1;
      return i >= t.length && !e ? F.empty : t[i].slice(this.off, e == null ? void 0 : this.off + e);
    }
    forward(e) {
      e == this.len ? this.next() : (this.len -= e, this.off += e);
    }
    forward2(e) {
      this.ins == -1 ? this.forward(e) : e == this.ins ? this.next() : (this.ins -= e, this.off += e);
    }
  };
  var Ct = class n6 {
    constructor(e, t, i, s) {
      this.from = e, this.to = t, this.flags = i, this.goalColumn = s;
    }
    get anchor() {
      return this.flags & 32 ? this.to : this.from;
    }
    get head() {
      return this.flags & 32 ? this.from : this.to;
    }
    get empty() {
      return this.from == this.to;
    }
    get assoc() {
      return this.flags & 8 ? -1 : this.flags & 16 ? 1 : 0;
    }
    get undirectional() {
      return (this.flags & 64) > 0;
    }
    get bidiLevel() {
      let e = this.flags & 7;
      return e == 7 ? null : e;
    }
    map(e, t = -1) {
      let i, s;
      return this.empty ? i = s = e.mapPos(this.from, t) : (i = e.mapPos(this.from, 1), s = e.mapPos(this.to, -1)), i == this.from && s == this.to ? this : new n6(i, s, this.flags, this.goalColumn);
    }
    extend(e, t = e, i = 0) {
      if (e <= this.anchor && t >= this.anchor) return x.range(e, t, void 0, void 0, i);
      let s = Math.abs(e - this.anchor) > Math.abs(t - this.anchor) ? e : t;
      return x.range(this.anchor, s, void 0, void 0, i);
    }
    eq(e, t = false) {
      return this.anchor == e.anchor && this.head == e.head && this.goalColumn == e.goalColumn && (!t || !this.empty || this.assoc == e.assoc);
    }
    toJSON() {
      return { anchor: this.anchor, head: this.head };
    }
    static fromJSON(e) {
      if (!e || typeof e.anchor != "number" || typeof e.head != "number") throw new RangeError("Invalid JSON representation for SelectionRange");
      return x.range(e.anchor, e.head);
    }
    static create(e, t, i, s) {
      return new n6(e, t, i, s);
    }
  };
  var x = class n7 {
    constructor(e, t) {
      this.ranges = e, this.mainIndex = t;
    }
    map(e, t = -1) {
      return e.empty ? this : n7.create(this.ranges.map((i) => i.map(e, t)), this.mainIndex);
    }
    eq(e, t = false) {
      if (this.ranges.length != e.ranges.length || this.mainIndex != e.mainIndex) return false;
      for (let i = 0; i < this.ranges.length; i++) if (!this.ranges[i].eq(e.ranges[i], t)) return false;
      return true;
    }
    get main() {
      return this.ranges[this.mainIndex];
    }
    asSingle() {
      return this.ranges.length == 1 ? this : new n7([this.main], 0);
    }
    addRange(e, t = true) {
      return n7.create([e].concat(this.ranges), t ? 0 : this.mainIndex + 1);
    }
    replaceRange(e, t = this.mainIndex) {
      let i = this.ranges.slice();
      return i[t] = e, n7.create(i, this.mainIndex);
    }
    toJSON() {
      return { ranges: this.ranges.map((e) => e.toJSON()), main: this.mainIndex };
    }
    static fromJSON(e) {
      if (!e || !Array.isArray(e.ranges) || typeof e.main != "number" || e.main >= e.ranges.length) throw new RangeError("Invalid JSON representation for EditorSelection");
      return new n7(e.ranges.map((t) => Ct.fromJSON(t)), e.main);
    }
    static single(e, t = e) {
      return new n7([n7.range(e, t)], 0);
    }
    static create(e, t = 0) {
      if (e.length == 0) throw new RangeError("A selection needs at least one range");
      for (let i = 0, s = 0; s < e.length; s++) {
        let r = e[s];
        if (r.empty ? r.from <= i : r.from < i) return n7.normalized(e.slice(), t);
        i = r.to;
      }
      return new n7(e, t);
    }
    static cursor(e, t = 0, i, s) {
      return Ct.create(e, e, (t == 0 ? 0 : t < 0 ? 8 : 16) | (i == null ? 7 : Math.min(6, i)), s);
    }
    static range(e, t, i, s, r) {
      let o = s == null ? 7 : Math.min(6, s);
      return !r && e != t && (r = t < e ? 1 : -1), r && (o |= r < 0 ? 8 : 16), t < e ? Ct.create(t, e, o | 32, i) : Ct.create(e, t, o, i);
    }
    static undirectionalRange(e, t) {
      return Ct.create(e, t, 64, void 0);
    }
    static normalized(e, t = 0) {
      let i = e[t];
      e.sort((s, r) => s.from - r.from), t = e.indexOf(i);
      for (let s = 1; s < e.length; s++) {
        let r = e[s], o = e[s - 1];
        if (r.empty ? r.from <= o.to : r.from < o.to) {
          let l = o.from, a = Math.max(r.to, o.to);
          s <= t && t--, e.splice(--s, 2, r.anchor > r.head ? n7.range(a, l) : n7.range(l, a));
        }
      }
      return new n7(e, t);
    }
  };
  function Wl2(n66, e) {
    for (let t of n66.ranges) if (t.to > e) throw new RangeError("Selection points outside of document");
  }
  var nr2 = 0;
  var T = class n8 {
    constructor(e, t, i, s, r) {
      this.combine = e, this.compareInput = t, this.compare = i, this.isStatic = s, this.id = nr2++, this.default = e([]), this.extensions = typeof r == "function" ? r(this) : r;
    }
    get reader() {
      return this;
    }
    static define(e = {}) {
      return new n8(e.combine || ((t) => t), e.compareInput || ((t, i) => t === i), e.compare || (e.combine ? (t, i) => t === i : sr2), !!e.static, e.enables);
    }
    of(e) {
      return new Ut([], this, 0, e);
    }
    compute(e, t) {
      if (this.isStatic) throw new Error("Can't compute a static facet");
      return new Ut(e, this, 1, t);
    }
    computeN(e, t) {
      if (this.isStatic) throw new Error("Can't compute a static facet");
      return new Ut(e, this, 2, t);
    }
    from(e, t) {
      return t || (t = (i) => i), this.compute([e], (i) => t(i.field(e)));
    }
  };
  function sr2(n66, e) {
    return n66 == e || n66.length == e.length && n66.every((t, i) => t === e[i]);
  }
  var Ut = class {
    constructor(e, t, i, s) {
      this.dependencies = e, this.facet = t, this.type = i, this.value = s, this.id = nr2++;
    }
    dynamicSlot(e) {
      var t;
      let i = this.value, s = this.facet.compareInput, r = this.id, o = e[r] >> 1, l = this.type == 2, a = false, h = false, c = [];
      for (let f of this.dependencies) f == "doc" ? a = true : f == "selection" ? h = true : (((t = e[f.id]) !== null && t !== void 0 ? t : 1) & 1) == 0 && c.push(e[f.id]);
      return { create(f) {
        return f.values[o] = i(f), 1;
      }, update(f, u) {
        if (a && u.docChanged || h && (u.docChanged || u.selection) || _s2(f, c)) {
          let d = i(f);
          if (l ? !Pl2(d, f.values[o], s) : !s(d, f.values[o])) return f.values[o] = d, 1;
        }
        return 0;
      }, reconfigure: (f, u) => {
        let d, p = u.config.address[r];
        if (p != null) {
          let m = gn2(u, p);
          if (this.dependencies.every((g) => g instanceof T ? u.facet(g) === f.facet(g) : g instanceof J ? u.field(g, false) == f.field(g, false) : true) || (l ? Pl2(d = i(f), m, s) : s(d = i(f), m))) return f.values[o] = m, 0;
        } else d = i(f);
        return f.values[o] = d, 1;
      } };
    }
    get extension() {
      return this;
    }
  };
  function Pl2(n66, e, t) {
    if (n66.length != e.length) return false;
    for (let i = 0; i < n66.length; i++) if (!t(n66[i], e[i])) return false;
    return true;
  }
  function _s2(n66, e) {
    let t = false;
    for (let i of e) vi(n66, i) & 1 && (t = true);
    return t;
  }
  function yf2(n66, e, t) {
    let i = t.map((a) => n66[a.id]), s = t.map((a) => a.type), r = i.filter((a) => !(a & 1)), o = n66[e.id] >> 1;
    function l(a) {
      let h = [];
      for (let c = 0; c < i.length; c++) {
        let f = gn2(a, i[c]);
        if (s[c] == 2) for (let u of f) h.push(u);
        else h.push(f);
      }
      return e.combine(h);
    }
    return { create(a) {
      for (let h of i) vi(a, h);
      return a.values[o] = l(a), 1;
    }, update(a, h) {
      if (!_s2(a, r)) return 0;
      let c = l(a);
      return e.compare(c, a.values[o]) ? 0 : (a.values[o] = c, 1);
    }, reconfigure(a, h) {
      let c = _s2(a, i), f = h.config.facets[e.id], u = h.facet(e);
      if (f && !c && sr2(t, f)) return a.values[o] = u, 0;
      let d = l(a);
      return e.compare(d, u) ? (a.values[o] = u, 0) : (a.values[o] = d, 1);
    } };
  }
  var an2 = T.define({ static: true });
  var J = class n9 {
    constructor(e, t, i, s, r) {
      this.id = e, this.createF = t, this.updateF = i, this.compareF = s, this.spec = r, this.provides = void 0;
    }
    static define(e) {
      let t = new n9(nr2++, e.create, e.update, e.compare || ((i, s) => i === s), e);
      return e.provide && (t.provides = e.provide(t)), t;
    }
    create(e) {
      let t = e.facet(an2).find((i) => i.field == this);
      return (t?.create || this.createF)(e);
    }
    slot(e) {
      let t = e[this.id] >> 1;
      return { create: (i) => (i.values[t] = this.create(i), 1), update: (i, s) => {
        let r = i.values[t], o = this.updateF(r, s);
        return this.compareF(r, o) ? 0 : (i.values[t] = o, 1);
      }, reconfigure: (i, s) => {
        let r = i.facet(an2), o = s.facet(an2), l;
        return (l = r.find((a) => a.field == this)) && l != o.find((a) => a.field == this) ? (i.values[t] = l.create(i), 1) : s.config.address[this.id] != null ? (i.values[t] = s.field(this), 0) : (i.values[t] = this.create(i), 1);
      } };
    }
    init(e) {
      return [this, an2.of({ field: this, create: e })];
    }
    get extension() {
      return this;
    }
  };
  var At = { lowest: 4, low: 3, default: 2, high: 1, highest: 0 };
  function wi(n66) {
    return (e) => new pn2(e, n66);
  }
  var Je = { highest: wi(At.highest), high: wi(At.high), default: wi(At.default), low: wi(At.low), lowest: wi(At.lowest) };
  var pn2 = class {
    constructor(e, t) {
      this.inner = e, this.prec = t;
    }
    get extension() {
      return this;
    }
  };
  var ki = class n10 {
    of(e) {
      return new Si(this, e);
    }
    reconfigure(e) {
      return n10.reconfigure.of({ compartment: this, extension: e });
    }
    get(e) {
      return e.config.compartments.get(this);
    }
  };
  var Si = class {
    constructor(e, t) {
      this.compartment = e, this.inner = t;
    }
    get extension() {
      return this;
    }
  };
  var mn2 = class n11 {
    constructor(e, t, i, s, r, o) {
      for (this.base = e, this.compartments = t, this.dynamicSlots = i, this.address = s, this.staticValues = r, this.facets = o, this.statusTemplate = []; this.statusTemplate.length < i.length; ) this.statusTemplate.push(0);
    }
    staticFacet(e) {
      let t = this.address[e.id];
      return t == null ? e.default : this.staticValues[t >> 1];
    }
    static resolve(e, t, i) {
      let s = [], r = /* @__PURE__ */ Object.create(null), o = /* @__PURE__ */ new Map();
      for (let u of bf2(e, t, o)) u instanceof J ? s.push(u) : (r[u.facet.id] || (r[u.facet.id] = [])).push(u);
      let l = /* @__PURE__ */ Object.create(null), a = [], h = [];
      for (let u of s) l[u.id] = h.length << 1, h.push((d) => u.slot(d));
      let c = i?.config.facets;
      for (let u in r) {
        let d = r[u], p = d[0].facet, m = c && c[u] || [];
        if (d.every((g) => g.type == 0)) if (l[p.id] = a.length << 1 | 1, sr2(m, d)) a.push(i.facet(p));
        else {
          let g = p.combine(d.map((y) => y.value));
          a.push(i && p.compare(g, i.facet(p)) ? i.facet(p) : g);
        }
        else {
          for (let g of d) g.type == 0 ? (l[g.id] = a.length << 1 | 1, a.push(g.value)) : (l[g.id] = h.length << 1, h.push((y) => g.dynamicSlot(y)));
          l[p.id] = h.length << 1, h.push((g) => yf2(g, p, d));
        }
      }
      let f = h.map((u) => u(l));
      return new n11(e, o, f, l, a, r);
    }
  };
  function bf2(n66, e, t) {
    let i = [[], [], [], [], []], s = /* @__PURE__ */ new Map();
    function r(o, l) {
      let a = s.get(o);
      if (a != null) {
        if (a <= l) return;
        let h = i[a].indexOf(o);
        h > -1 && i[a].splice(h, 1), o instanceof Si && t.delete(o.compartment);
      }
      if (s.set(o, l), Array.isArray(o)) for (let h of o) r(h, l);
      else if (o instanceof Si) {
        if (t.has(o.compartment)) throw new RangeError("Duplicate use of compartment in extensions");
        let h = e.get(o.compartment) || o.inner;
        t.set(o.compartment, h), r(h, l);
      } else if (o instanceof pn2) r(o.inner, o.prec);
      else if (o instanceof J) i[l].push(o), o.provides && r(o.provides, l);
      else if (o instanceof Ut) i[l].push(o), o.facet.extensions && r(o.facet.extensions, At.default);
      else {
        let h = o.extension;
        if (!h) throw new Error(`Unrecognized extension value in extension set (${o}).`);
        if (h == o) throw new Error(`Unrecognized extension value in extension set (${o}). This sometimes happens because multiple instances of @codemirror/state are loaded, breaking instanceof checks.`);
        r(h, l);
      }
    }
    return r(n66, At.default), i.reduce((o, l) => o.concat(l));
  }
  function vi(n66, e) {
    if (e & 1) return 2;
    let t = e >> 1, i = n66.status[t];
    if (i == 4) throw new Error("Cyclic dependency between fields and/or facets");
    if (i & 2) return i;
    n66.status[t] = 4;
    let s = n66.computeSlot(n66, n66.config.dynamicSlots[t]);
    return n66.status[t] = 2 | s;
  }
  function gn2(n66, e) {
    return e & 1 ? n66.config.staticValues[e >> 1] : n66.values[e >> 1];
  }
  var Vl = T.define();
  var Ys = T.define({ combine: (n66) => n66.some((e) => e), static: true });
  var zl = T.define({ combine: (n66) => n66.length ? n66[0] : void 0, static: true });
  var ql = T.define();
  var Kl = T.define();
  var $l = T.define();
  var jl = T.define({ combine: (n66) => n66.length ? n66[0] : false });
  var oe2 = class {
    constructor(e, t) {
      this.type = e, this.value = t;
    }
    static define() {
      return new Xs2();
    }
  };
  var Xs2 = class {
    of(e) {
      return new oe2(this, e);
    }
  };
  var Js2 = class {
    constructor(e) {
      this.map = e;
    }
    of(e) {
      return new E(this, e);
    }
  };
  var E = class n12 {
    constructor(e, t) {
      this.type = e, this.value = t;
    }
    map(e) {
      let t = this.type.map(this.value, e);
      return t === void 0 ? void 0 : t == this.value ? this : new n12(this.type, t);
    }
    is(e) {
      return this.type == e;
    }
    static define(e = {}) {
      return new Js2(e.map || ((t) => t));
    }
    static mapEffects(e, t) {
      if (!e.length) return e;
      let i = [];
      for (let s of e) {
        let r = s.map(t);
        r && i.push(r);
      }
      return i;
    }
  };
  E.reconfigure = E.define();
  E.appendConfig = E.define();
  var X2 = class n13 {
    constructor(e, t, i, s, r, o) {
      this.startState = e, this.changes = t, this.selection = i, this.effects = s, this.annotations = r, this.scrollIntoView = o, this._doc = null, this._state = null, i && Wl2(i, t.newLength), r.some((l) => l.type == n13.time) || (this.annotations = r.concat(n13.time.of(Date.now())));
    }
    static create(e, t, i, s, r, o) {
      return new n13(e, t, i, s, r, o);
    }
    get newDoc() {
      return this._doc || (this._doc = this.changes.apply(this.startState.doc));
    }
    get newSelection() {
      return this.selection || this.startState.selection.map(this.changes);
    }
    get state() {
      return this._state || this.startState.applyTransaction(this), this._state;
    }
    annotation(e) {
      for (let t of this.annotations) if (t.type == e) return t.value;
    }
    get docChanged() {
      return !this.changes.empty;
    }
    get reconfigured() {
      return this.startState.config != this.state.config;
    }
    isUserEvent(e) {
      let t = this.annotation(n13.userEvent);
      return !!(t && (t == e || t.length > e.length && t.slice(0, e.length) == e && t[e.length] == "."));
    }
  };
  X2.time = oe2.define();
  X2.userEvent = oe2.define();
  X2.addToHistory = oe2.define();
  X2.remote = oe2.define();
  function xf2(n66, e) {
    let t = [];
    for (let i = 0, s = 0; ; ) {
      let r, o;
      if (i < n66.length && (s == e.length || e[s] >= n66[i])) r = n66[i++], o = n66[i++];
      else if (s < e.length) r = e[s++], o = e[s++];
      else return t;
      !t.length || t[t.length - 1] < r ? t.push(r, o) : t[t.length - 1] < o && (t[t.length - 1] = o);
    }
  }
  function Ul(n66, e, t) {
    var i;
    let s, r, o;
    return t ? (s = e.changes, r = ie.empty(e.changes.length), o = n66.changes.compose(e.changes)) : (s = e.changes.map(n66.changes), r = n66.changes.mapDesc(e.changes, true), o = n66.changes.compose(s)), { changes: o, selection: e.selection ? e.selection.map(r) : (i = n66.selection) === null || i === void 0 ? void 0 : i.map(s), effects: E.mapEffects(n66.effects, s).concat(E.mapEffects(e.effects, r)), annotations: n66.annotations.length ? n66.annotations.concat(e.annotations) : e.annotations, scrollIntoView: n66.scrollIntoView || e.scrollIntoView };
  }
  function Qs2(n66, e, t) {
    let i = e.selection, s = Gt(e.annotations);
    return e.userEvent && (s = s.concat(X2.userEvent.of(e.userEvent))), { changes: e.changes instanceof ie ? e.changes : ie.of(e.changes || [], t, n66.facet(zl)), selection: i && (i instanceof x ? i : x.single(i.anchor, i.head)), effects: Gt(e.effects), annotations: s, scrollIntoView: !!e.scrollIntoView };
  }
  function Gl2(n66, e, t) {
    let i = Qs2(n66, e.length ? e[0] : {}, n66.doc.length);
    e.length && e[0].filter === false && (t = false);
    for (let r = 1; r < e.length; r++) {
      e[r].filter === false && (t = false);
      let o = !!e[r].sequential;
      i = Ul(i, Qs2(n66, e[r], o ? i.changes.newLength : n66.doc.length), o);
    }
    let s = X2.create(n66, i.changes, i.selection, i.effects, i.annotations, i.scrollIntoView);
    return vf2(t ? wf2(s) : s);
  }
  function wf2(n66) {
    let e = n66.startState, t = true;
    for (let s of e.facet(ql)) {
      let r = s(n66);
      if (r === false) {
        t = false;
        break;
      }
      Array.isArray(r) && (t = t === true ? r : xf2(t, r));
    }
    if (t !== true) {
      let s, r;
      if (t === false) r = n66.changes.invertedDesc, s = ie.empty(e.doc.length);
      else {
        let o = n66.changes.filter(t);
        s = o.changes, r = o.filtered.mapDesc(o.changes).invertedDesc;
      }
      n66 = X2.create(e, s, n66.selection && n66.selection.map(r), E.mapEffects(n66.effects, r), n66.annotations, n66.scrollIntoView);
    }
    let i = e.facet(Kl);
    for (let s = i.length - 1; s >= 0; s--) {
      let r = i[s](n66);
      r instanceof X2 ? n66 = r : Array.isArray(r) && r.length == 1 && r[0] instanceof X2 ? n66 = r[0] : n66 = Gl2(e, Gt(r), false);
    }
    return n66;
  }
  function vf2(n66) {
    let e = n66.startState, t = e.facet($l), i = n66;
    for (let s = t.length - 1; s >= 0; s--) {
      let r = t[s](n66);
      r && Object.keys(r).length && (i = Ul(i, Qs2(e, r, n66.changes.newLength), true));
    }
    return i == n66 ? n66 : X2.create(e, n66.changes, n66.selection, i.effects, i.annotations, i.scrollIntoView);
  }
  var kf2 = [];
  function Gt(n66) {
    return n66 == null ? kf2 : Array.isArray(n66) ? n66 : [n66];
  }
  var G = (function(n66) {
    return n66[n66.Word = 0] = "Word", n66[n66.Space = 1] = "Space", n66[n66.Other = 2] = "Other", n66;
  })(G || (G = {}));
  var Sf2 = /[\u00df\u0587\u0590-\u05f4\u0600-\u06ff\u3040-\u309f\u30a0-\u30ff\u3400-\u4db5\u4e00-\u9fcc\uac00-\ud7af]/;
  var Zs2;
  try {
    Zs2 = new RegExp("[\\p{Alphabetic}\\p{Number}_]", "u");
  } catch {
  }
  function Cf2(n66) {
    if (Zs2) return Zs2.test(n66);
    for (let e = 0; e < n66.length; e++) {
      let t = n66[e];
      if (/\w/.test(t) || t > "\x80" && (t.toUpperCase() != t.toLowerCase() || Sf2.test(t))) return true;
    }
    return false;
  }
  function Af2(n66) {
    return (e) => {
      if (!/\S/.test(e)) return G.Space;
      if (Cf2(e)) return G.Word;
      for (let t = 0; t < n66.length; t++) if (e.indexOf(n66[t]) > -1) return G.Word;
      return G.Other;
    };
  }
  var _ = class n14 {
    constructor(e, t, i, s, r, o) {
      this.config = e, this.doc = t, this.selection = i, this.values = s, this.status = e.statusTemplate.slice(), this.computeSlot = r, o && (o._state = this);
      for (let l = 0; l < this.config.dynamicSlots.length; l++) vi(this, l << 1);
      this.computeSlot = null;
    }
    field(e, t = true) {
      let i = this.config.address[e.id];
      if (i == null) {
        if (t) throw new RangeError("Field is not present in this state");
        return;
      }
      return vi(this, i), gn2(this, i);
    }
    update(...e) {
      return Gl2(this, e, true);
    }
    applyTransaction(e) {
      let t = this.config, { base: i, compartments: s } = t;
      for (let l of e.effects) l.is(ki.reconfigure) ? (t && (s = /* @__PURE__ */ new Map(), t.compartments.forEach((a, h) => s.set(h, a)), t = null), s.set(l.value.compartment, l.value.extension)) : l.is(E.reconfigure) ? (t = null, i = l.value) : l.is(E.appendConfig) && (t = null, i = Gt(i).concat(l.value));
      let r;
      t ? r = e.startState.values.slice() : (t = mn2.resolve(i, s, this), r = new n14(t, this.doc, this.selection, t.dynamicSlots.map(() => null), (a, h) => h.reconfigure(a, this), null).values);
      let o = e.startState.facet(Ys) ? e.newSelection : e.newSelection.asSingle();
      new n14(t, e.newDoc, o, r, (l, a) => a.update(l, e), e);
    }
    replaceSelection(e) {
      return typeof e == "string" && (e = this.toText(e)), this.changeByRange((t) => ({ changes: { from: t.from, to: t.to, insert: e }, range: x.cursor(t.from + e.length, -1) }));
    }
    changeByRange(e) {
      let t = this.selection, i = e(t.ranges[0]), s = this.changes(i.changes), r = [i.range], o = Gt(i.effects);
      for (let l = 1; l < t.ranges.length; l++) {
        let a = e(t.ranges[l]), h = this.changes(a.changes), c = h.map(s);
        for (let u = 0; u < l; u++) r[u] = r[u].map(c);
        let f = s.mapDesc(h, true);
        r.push(a.range.map(f)), s = s.compose(c), o = E.mapEffects(o, c).concat(E.mapEffects(Gt(a.effects), f));
      }
      return { changes: s, selection: x.create(r, t.mainIndex), effects: o };
    }
    changes(e = []) {
      return e instanceof ie ? e : ie.of(e, this.doc.length, this.facet(n14.lineSeparator));
    }
    toText(e) {
      return F.of(e.split(this.facet(n14.lineSeparator) || js));
    }
    sliceDoc(e = 0, t = this.doc.length) {
      return this.doc.sliceString(e, t, this.lineBreak);
    }
    facet(e) {
      let t = this.config.address[e.id];
      return t == null ? e.default : (vi(this, t), gn2(this, t));
    }
    toJSON(e) {
      let t = { doc: this.sliceDoc(), selection: this.selection.toJSON() };
      if (e) for (let i in e) {
        let s = e[i];
        s instanceof J && this.config.address[s.id] != null && (t[i] = s.spec.toJSON(this.field(e[i]), this));
      }
      return t;
    }
    static fromJSON(e, t = {}, i) {
      if (!e || typeof e.doc != "string") throw new RangeError("Invalid JSON representation for EditorState");
      let s = [];
      if (i) {
        for (let r in i) if (Object.prototype.hasOwnProperty.call(e, r)) {
          let o = i[r], l = e[r];
          s.push(o.init((a) => o.spec.fromJSON(l, a)));
        }
      }
      return n14.create({ doc: e.doc, selection: x.fromJSON(e.selection), extensions: t.extensions ? s.concat([t.extensions]) : s });
    }
    static create(e = {}) {
      let t = mn2.resolve(e.extensions || [], /* @__PURE__ */ new Map()), i = e.doc instanceof F ? e.doc : F.of((e.doc || "").split(t.staticFacet(n14.lineSeparator) || js)), s = e.selection ? e.selection instanceof x ? e.selection : x.single(e.selection.anchor, e.selection.head) : x.single(0);
      return Wl2(s, i.length), t.staticFacet(Ys) || (s = s.asSingle()), new n14(t, i, s, t.dynamicSlots.map(() => null), (r, o) => o.create(r), null);
    }
    get tabSize() {
      return this.facet(n14.tabSize);
    }
    get lineBreak() {
      return this.facet(n14.lineSeparator) || `
`;
    }
    get readOnly() {
      return this.facet(jl);
    }
    phrase(e, ...t) {
      for (let i of this.facet(n14.phrases)) if (Object.prototype.hasOwnProperty.call(i, e)) {
        e = i[e];
        break;
      }
      return t.length && (e = e.replace(/\$(\$|\d*)/g, (i, s) => {
        if (s == "$") return "$";
        let r = +(s || 1);
        return !r || r > t.length ? i : t[r - 1];
      })), e;
    }
    languageDataAt(e, t, i = -1) {
      let s = [];
      for (let r of this.facet(Vl)) for (let o of r(this, t, i)) Object.prototype.hasOwnProperty.call(o, e) && s.push(o[e]);
      return s;
    }
    charCategorizer(e) {
      let t = this.languageDataAt("wordChars", e);
      return Af2(t.length ? t[0] : "");
    }
    wordAt(e) {
      let { text: t, from: i, length: s } = this.doc.lineAt(e), r = this.charCategorizer(e), o = e - i, l = e - i;
      for (; o > 0; ) {
        let a = Z(t, o, false);
        if (r(t.slice(a, o)) != G.Word) break;
        o = a;
      }
      for (; l < s; ) {
        let a = Z(t, l);
        if (r(t.slice(l, a)) != G.Word) break;
        l = a;
      }
      return o == l ? null : x.range(o + i, l + i);
    }
  };
  _.allowMultipleSelections = Ys;
  _.tabSize = T.define({ combine: (n66) => n66.length ? n66[0] : 4 });
  _.lineSeparator = zl;
  _.readOnly = jl;
  _.phrases = T.define({ compare(n66, e) {
    let t = Object.keys(n66), i = Object.keys(e);
    return t.length == i.length && t.every((s) => n66[s] == e[s]);
  } });
  _.languageData = Vl;
  _.changeFilter = ql;
  _.transactionFilter = Kl;
  _.transactionExtender = $l;
  ki.reconfigure = E.define();
  function de(n66, e, t = {}) {
    let i = {};
    for (let s of n66) for (let r of Object.keys(s)) {
      let o = s[r], l = i[r];
      if (l === void 0) i[r] = o;
      else if (!(l === o || o === void 0)) if (Object.hasOwnProperty.call(t, r)) i[r] = t[r](l, o);
      else throw new Error("Config merge conflict for field " + r);
    }
    for (let s in e) i[s] === void 0 && (i[s] = e[s]);
    return i;
  }
  var Te2 = class {
    eq(e) {
      return this == e;
    }
    range(e, t = e) {
      return Ci.create(e, t, this);
    }
  };
  Te2.prototype.startSide = Te2.prototype.endSide = 0;
  Te2.prototype.point = false;
  Te2.prototype.mapMode = ue.TrackDel;
  function rr2(n66, e) {
    return n66 == e || n66.constructor == e.constructor && n66.eq(e);
  }
  var Ci = class n15 {
    constructor(e, t, i) {
      this.from = e, this.to = t, this.value = i;
    }
    static create(e, t, i) {
      return new n15(e, t, i);
    }
  };
  function er2(n66, e) {
    return n66.from - e.from || n66.value.startSide - e.value.startSide;
  }
  var tr2 = class n16 {
    constructor(e, t, i, s) {
      this.from = e, this.to = t, this.value = i, this.maxPoint = s;
    }
    get length() {
      return $t2(this.to);
    }
    findIndex(e, t, i, s = 0) {
      let r = i ? this.to : this.from;
      for (let o = s, l = r.length; ; ) {
        if (o == l) return o;
        let a = o + l >> 1, h = r[a] - e || (i ? this.value[a].endSide : this.value[a].startSide) - t;
        if (a == o) return h >= 0 ? o : l;
        h >= 0 ? l = a : o = a + 1;
      }
    }
    between(e, t, i, s) {
      for (let r = this.findIndex(t, -1e9, true), o = this.findIndex(i, 1e9, false, r); r < o; r++) if (s(this.from[r] + e, this.to[r] + e, this.value[r]) === false) return false;
    }
    map(e, t, i, s, r) {
      let o = [], l = [], a = [], h = -1, c = -1;
      e: for (let f = 0; f < this.value.length; f++) {
        let u = this.value[f], d = this.from[f] + e, p = this.to[f] + e, m, g;
        if (d == p) {
          let y = t.mapPos(d, u.startSide, u.mapMode);
          if (y == null || (m = g = y, u.startSide != u.endSide && (g = t.mapPos(d, u.endSide), g < m))) continue;
        } else if (m = t.mapPos(d, u.startSide), g = t.mapPos(p, u.endSide), m > g || m == g && u.startSide > 0 && u.endSide <= 0) continue;
        if (!((g - m || u.endSide - u.startSide) < 0)) if (h < 0 && (h = m), u.point && (c = Math.max(c, g - m)), (m - i || u.startSide - s) >= 0) o.push(u), l.push(m - h), a.push(g - h), i = g, s = u.endSide;
        else {
          if (m == g) for (let y = o.length; y > 0; y--) {
            if ((m - (a[y - 1] + h) || u.startSide - o[y - 1].endSide) >= 0) {
              o.splice(y, 0, u), l.splice(y, 0, m - h), a.splice(y, 0, g - h);
              continue e;
            }
            if ((m - (l[y - 1] + h) || u.endSide - o[y - 1].startSide) > 0) break;
          }
          r(m, g, u);
        }
      }
      return { mapped: o.length ? new n16(l, a, o, c) : null, pos: h };
    }
  };
  var z = class n17 {
    constructor(e, t, i, s) {
      this.chunkPos = e, this.chunk = t, this.nextLayer = i, this.maxPoint = s;
    }
    static create(e, t, i, s) {
      return new n17(e, t, i, s);
    }
    get length() {
      let e = this.chunk.length - 1;
      return e < 0 ? 0 : Math.max(this.chunkEnd(e), this.nextLayer.length);
    }
    get size() {
      if (this.isEmpty) return 0;
      let e = this.nextLayer.size;
      for (let t of this.chunk) e += t.value.length;
      return e;
    }
    chunkEnd(e) {
      return this.chunkPos[e] + this.chunk[e].length;
    }
    update(e) {
      let { add: t = [], sort: i = false, filterFrom: s = 0, filterTo: r = this.length } = e, o = e.filter;
      if (t.length == 0 && !o) return this;
      if (i && (t = t.slice().sort(er2)), this.isEmpty) return t.length ? n17.of(t) : this;
      let l = new yn(this, null, -1).goto(0), a = 0, h = [], c = new Me();
      for (; l.value || a < t.length; ) if (a < t.length && (l.from - t[a].from || l.startSide - t[a].value.startSide) >= 0) {
        let f = t[a++];
        c.addInner(f.from, f.to, f.value, false) || h.push(f);
      } else l.rangeIndex == 1 && l.chunkIndex < this.chunk.length && (a == t.length || this.chunkEnd(l.chunkIndex) < t[a].from) && (!o || s > this.chunkEnd(l.chunkIndex) || r < this.chunkPos[l.chunkIndex]) && c.addChunk(this.chunkPos[l.chunkIndex], this.chunk[l.chunkIndex]) ? l.nextChunk() : ((!o || s > l.to || r < l.from || o(l.from, l.to, l.value)) && (c.addInner(l.from, l.to, l.value, false) || h.push(Ci.create(l.from, l.to, l.value))), l.next());
      return c.finishInner(this.nextLayer.isEmpty && !h.length ? n17.empty : this.nextLayer.update({ add: h, filter: o, filterFrom: s, filterTo: r }));
    }
    map(e) {
      if (e.empty || this.isEmpty) return this;
      let t = [], i = [], s = -1, r, o = (a, h, c) => {
        r || (r = new Me()), r.addRange(a, h, c, false);
      };
      for (let a = 0; a < this.chunk.length; a++) {
        let h = this.chunkPos[a], c = this.chunk[a], f = e.touchesRange(h, h + c.length);
        if (f === false) s = Math.max(s, c.maxPoint), t.push(c), i.push(e.mapPos(h));
        else if (f === true) {
          let [u, d] = t.length ? [$t2(i) + $t2(t).length, $t2($t2(t).value).endSide] : [-1, -1], { mapped: p, pos: m } = c.map(h, e, u, d, o);
          p && (s = Math.max(s, p.maxPoint), t.push(p), i.push(m));
        }
      }
      let l = this.nextLayer.map(e);
      return r && (l = r.finishInner(l)), t.length == 0 ? l : new n17(i, t, l || n17.empty, s);
    }
    between(e, t, i) {
      if (!this.isEmpty) {
        for (let s = 0; s < this.chunk.length; s++) {
          let r = this.chunkPos[s], o = this.chunk[s];
          if (t >= r && e <= r + o.length && o.between(r, e - r, t - r, i) === false) return;
        }
        this.nextLayer.between(e, t, i);
      }
    }
    iter(e = 0) {
      return Ai.from([this]).goto(e);
    }
    get isEmpty() {
      return this.nextLayer == this;
    }
    static iter(e, t = 0) {
      return Ai.from(e).goto(t);
    }
    static compare(e, t, i, s, r = -1) {
      let o = e.filter((f) => f.maxPoint > 0 || !f.isEmpty && f.maxPoint >= r), l = t.filter((f) => f.maxPoint > 0 || !f.isEmpty && f.maxPoint >= r), a = Il2(o, l, i), h = new Mt(o, a, r), c = new Mt(l, a, r);
      i.iterGaps((f, u, d) => Nl2(h, f, c, u, d, s)), i.empty && i.length == 0 && Nl2(h, 0, c, 0, 0, s);
    }
    static eq(e, t, i = 0, s) {
      s == null && (s = 999999999);
      let r = e.filter((c) => !c.isEmpty && t.indexOf(c) < 0), o = t.filter((c) => !c.isEmpty && e.indexOf(c) < 0);
      if (r.length != o.length) return false;
      if (!r.length) return true;
      let l = Il2(r, o), a = new Mt(r, l, 0).goto(i), h = new Mt(o, l, 0).goto(i);
      for (; ; ) {
        if (a.to != h.to || !ir2(a.active, h.active) || a.point && (!h.point || !rr2(a.point, h.point))) return false;
        if (a.to > s) return true;
        a.next(), h.next();
      }
    }
    static spans(e, t, i, s, r = -1) {
      let o = new Mt(e, null, r).goto(t), l = t, a = o.openStart;
      for (; ; ) {
        let h = Math.min(o.to, i);
        if (o.point) {
          let c = o.activeForPoint(o.to), f = o.pointFrom < t ? c.length + 1 : o.point.startSide < 0 ? c.length : Math.min(c.length, a);
          s.point(l, h, o.point, c, f, o.pointRank), a = Math.min(o.openEnd(h), c.length);
        } else h > l && (s.span(l, h, o.active, a), a = o.openEnd(h));
        if (o.to > i) return a + (o.point && o.to > i ? 1 : 0);
        l = o.to, o.next();
      }
    }
    static of(e, t = false) {
      let i = new Me();
      for (let s of e instanceof Ci ? [e] : t ? Mf2(e) : e) i.add(s.from, s.to, s.value);
      return i.finish();
    }
    static join(e) {
      if (!e.length) return n17.empty;
      let t = $t2(e);
      for (let i = e.length - 2; i >= 0; i--) for (let s = e[i]; s != n17.empty; s = s.nextLayer) t = new n17(s.chunkPos, s.chunk, t, Math.max(s.maxPoint, t.maxPoint));
      return t;
    }
  };
  z.empty = new z([], [], null, -1);
  function $t2(n66) {
    return n66[n66.length - 1];
  }
  function Mf2(n66) {
    if (n66.length > 1) for (let e = n66[0], t = 1; t < n66.length; t++) {
      let i = n66[t];
      if (er2(e, i) > 0) return n66.slice().sort(er2);
      e = i;
    }
    return n66;
  }
  z.empty.nextLayer = z.empty;
  var Me = class n18 {
    finishChunk(e) {
      this.chunks.push(new tr2(this.from, this.to, this.value, this.maxPoint)), this.chunkPos.push(this.chunkStart), this.chunkStart = -1, this.setMaxPoint = Math.max(this.setMaxPoint, this.maxPoint), this.maxPoint = -1, e && (this.from = [], this.to = [], this.value = []);
    }
    constructor() {
      this.chunks = [], this.chunkPos = [], this.chunkStart = -1, this.last = null, this.lastFrom = -1e9, this.lastTo = -1e9, this.from = [], this.to = [], this.value = [], this.maxPoint = -1, this.setMaxPoint = -1, this.nextLayer = null;
    }
    add(e, t, i) {
      this.addRange(e, t, i, true);
    }
    addRange(e, t, i, s) {
      this.addInner(e, t, i, s) || (this.nextLayer || (this.nextLayer = new n18())).addRange(e, t, i, s);
    }
    addInner(e, t, i, s) {
      let r = e - this.lastTo || i.startSide - this.last.endSide;
      if (s && r <= 0 && (e - this.lastFrom || i.startSide - this.last.startSide) < 0) throw new Error("Ranges must be added sorted by `from` position and `startSide`");
      return r < 0 ? false : (this.from.length == 250 && this.finishChunk(true), this.chunkStart < 0 && (this.chunkStart = e), this.from.push(e - this.chunkStart), this.to.push(t - this.chunkStart), this.last = i, this.lastFrom = e, this.lastTo = t, this.value.push(i), i.point && (this.maxPoint = Math.max(this.maxPoint, t - e)), true);
    }
    addChunk(e, t) {
      if ((e - this.lastTo || t.value[0].startSide - this.last.endSide) < 0) return false;
      this.from.length && this.finishChunk(true), this.setMaxPoint = Math.max(this.setMaxPoint, t.maxPoint), this.chunks.push(t), this.chunkPos.push(e);
      let i = t.value.length - 1;
      return this.last = t.value[i], this.lastFrom = t.from[i] + e, this.lastTo = t.to[i] + e, true;
    }
    finish() {
      return this.finishInner(z.empty);
    }
    finishInner(e) {
      if (this.from.length && this.finishChunk(false), this.chunks.length == 0) return e;
      let t = z.create(this.chunkPos, this.chunks, this.nextLayer ? this.nextLayer.finishInner(e) : e, this.setMaxPoint);
      return this.from = null, t;
    }
  };
  function Il2(n66, e, t) {
    let i = /* @__PURE__ */ new Map();
    for (let r of n66) for (let o = 0; o < r.chunk.length; o++) r.chunk[o].maxPoint <= 0 && i.set(r.chunk[o], r.chunkPos[o]);
    let s = /* @__PURE__ */ new Set();
    for (let r of e) for (let o = 0; o < r.chunk.length; o++) {
      let l = i.get(r.chunk[o]);
      l != null && (t ? t.mapPos(l) : l) == r.chunkPos[o] && !t?.touchesRange(l, l + r.chunk[o].length) && s.add(r.chunk[o]);
    }
    return s;
  }
  var yn = class {
    constructor(e, t, i, s = 0) {
      this.layer = e, this.skip = t, this.minPoint = i, this.rank = s;
    }
    get startSide() {
      return this.value ? this.value.startSide : 0;
    }
    get endSide() {
      return this.value ? this.value.endSide : 0;
    }
    goto(e, t = -1e9) {
      return this.chunkIndex = this.rangeIndex = 0, this.gotoInner(e, t, false), this;
    }
    gotoInner(e, t, i) {
      for (; this.chunkIndex < this.layer.chunk.length; ) {
        let s = this.layer.chunk[this.chunkIndex];
        if (!(this.skip && this.skip.has(s) || this.layer.chunkEnd(this.chunkIndex) < e || s.maxPoint < this.minPoint)) break;
        this.chunkIndex++, i = false;
      }
      if (this.chunkIndex < this.layer.chunk.length) {
        let s = this.layer.chunk[this.chunkIndex].findIndex(e - this.layer.chunkPos[this.chunkIndex], t, true);
        (!i || this.rangeIndex < s) && this.setRangeIndex(s);
      }
      this.next();
    }
    forward(e, t) {
      (this.to - e || this.endSide - t) < 0 && this.gotoInner(e, t, true);
    }
    next() {
      for (; ; ) if (this.chunkIndex == this.layer.chunk.length) {
        this.from = this.to = 1e9, this.value = null;
        break;
      } else {
        let e = this.layer.chunkPos[this.chunkIndex], t = this.layer.chunk[this.chunkIndex], i = e + t.from[this.rangeIndex];
        if (this.from = i, this.to = e + t.to[this.rangeIndex], this.value = t.value[this.rangeIndex], this.setRangeIndex(this.rangeIndex + 1), this.minPoint < 0 || this.value.point && this.to - this.from >= this.minPoint) break;
      }
    }
    setRangeIndex(e) {
      if (e == this.layer.chunk[this.chunkIndex].value.length) {
        if (this.chunkIndex++, this.skip) for (; this.chunkIndex < this.layer.chunk.length && this.skip.has(this.layer.chunk[this.chunkIndex]); ) this.chunkIndex++;
        this.rangeIndex = 0;
      } else this.rangeIndex = e;
    }
    nextChunk() {
      this.chunkIndex++, this.rangeIndex = 0, this.next();
    }
    compare(e) {
      return this.from - e.from || this.startSide - e.startSide || this.rank - e.rank || this.to - e.to || this.endSide - e.endSide;
    }
  };
  var Ai = class n19 {
    constructor(e) {
      this.heap = e;
    }
    static from(e, t = null, i = -1) {
      let s = [];
      for (let r = 0; r < e.length; r++) for (let o = e[r]; !o.isEmpty; o = o.nextLayer) o.maxPoint >= i && s.push(new yn(o, t, i, r));
      return s.length == 1 ? s[0] : new n19(s);
    }
    get startSide() {
      return this.value ? this.value.startSide : 0;
    }
    goto(e, t = -1e9) {
      for (let i of this.heap) i.goto(e, t);
      for (let i = this.heap.length >> 1; i >= 0; i--) Ks(this.heap, i);
      return this.next(), this;
    }
    forward(e, t) {
      for (let i of this.heap) i.forward(e, t);
      for (let i = this.heap.length >> 1; i >= 0; i--) Ks(this.heap, i);
      (this.to - e || this.value.endSide - t) < 0 && this.next();
    }
    next() {
      if (this.heap.length == 0) this.from = this.to = 1e9, this.value = null, this.rank = -1;
      else {
        let e = this.heap[0];
        this.from = e.from, this.to = e.to, this.value = e.value, this.rank = e.rank, e.value && e.next(), Ks(this.heap, 0);
      }
    }
  };
  function Ks(n66, e) {
    for (let t = n66[e]; ; ) {
      let i = (e << 1) + 1;
      if (i >= n66.length) break;
      let s = n66[i];
      if (i + 1 < n66.length && s.compare(n66[i + 1]) >= 0 && (s = n66[i + 1], i++), t.compare(s) < 0) break;
      n66[i] = t, n66[e] = s, e = i;
    }
  }
  var Mt = class {
    constructor(e, t, i) {
      this.minPoint = i, this.active = [], this.activeTo = [], this.activeRank = [], this.minActive = -1, this.point = null, this.pointFrom = 0, this.pointRank = 0, this.to = -1e9, this.endSide = 0, this.openStart = -1, this.cursor = Ai.from(e, t, i);
    }
    goto(e, t = -1e9) {
      return this.cursor.goto(e, t), this.active.length = this.activeTo.length = this.activeRank.length = 0, this.minActive = -1, this.to = e, this.endSide = t, this.openStart = -1, this.next(), this;
    }
    forward(e, t) {
      for (; this.minActive > -1 && (this.activeTo[this.minActive] - e || this.active[this.minActive].endSide - t) < 0; ) this.removeActive(this.minActive);
      this.cursor.forward(e, t);
    }
    removeActive(e) {
      hn2(this.active, e), hn2(this.activeTo, e), hn2(this.activeRank, e), this.minActive = Fl(this.active, this.activeTo);
    }
    addActive(e) {
      let t = 0, { value: i, to: s, rank: r } = this.cursor;
      for (; t < this.activeRank.length && (r - this.activeRank[t] || s - this.activeTo[t]) > 0; ) t++;
      cn2(this.active, t, i), cn2(this.activeTo, t, s), cn2(this.activeRank, t, r), e && cn2(e, t, this.cursor.from), this.minActive = Fl(this.active, this.activeTo);
    }
    next() {
      let e = this.to, t = this.point;
      this.point = null;
      let i = this.openStart < 0 ? [] : null;
      for (; ; ) {
        let s = this.minActive;
        if (s > -1 && (this.activeTo[s] - this.cursor.from || this.active[s].endSide - this.cursor.startSide) < 0) {
          if (this.activeTo[s] > e) {
            this.to = this.activeTo[s], this.endSide = this.active[s].endSide;
            break;
          }
          this.removeActive(s), i && hn2(i, s);
        } else if (this.cursor.value) if (this.cursor.from > e) {
          this.to = this.cursor.from, this.endSide = this.cursor.startSide;
          break;
        } else {
          let r = this.cursor.value;
          if (!r.point) this.addActive(i), this.cursor.next();
          else if (t && this.cursor.to == this.to && this.cursor.from < this.cursor.to) this.cursor.next();
          else {
            this.point = r, this.pointFrom = this.cursor.from, this.pointRank = this.cursor.rank, this.to = this.cursor.to, this.endSide = r.endSide, this.cursor.next(), this.forward(this.to, this.endSide);
            break;
          }
        }
        else {
          this.to = this.endSide = 1e9;
          break;
        }
      }
      if (i) {
        this.openStart = 0;
        for (let s = i.length - 1; s >= 0 && i[s] < e; s--) this.openStart++;
      }
    }
    activeForPoint(e) {
      if (!this.active.length) return this.active;
      let t = [];
      for (let i = this.active.length - 1; i >= 0 && !(this.activeRank[i] < this.pointRank); i--) (this.activeTo[i] > e || this.activeTo[i] == e && this.active[i].endSide >= this.point.endSide) && t.push(this.active[i]);
      return t.reverse();
    }
    openEnd(e) {
      let t = 0;
      for (let i = this.activeTo.length - 1; i >= 0 && this.activeTo[i] > e; i--) t++;
      return t;
    }
  };
  function Nl2(n66, e, t, i, s, r) {
    n66.goto(e), t.goto(i);
    let o = i + s, l = i, a = i - e, h = !!r.boundChange;
    for (let c = false; ; ) {
      let f = n66.to + a - t.to, u = f || n66.endSide - t.endSide, d = u < 0 ? n66.to + a : t.to, p = Math.min(d, o);
      if (n66.point || t.point ? (n66.point && t.point && rr2(n66.point, t.point) && ir2(n66.activeForPoint(n66.to), t.activeForPoint(t.to)) || r.comparePoint(l, p, n66.point, t.point), c = false) : (c && (r.boundChange(l), c = false), p > l && !ir2(n66.active, t.active) && r.compareRange(l, p, n66.active, t.active), h && p < o && (f || n66.openEnd(d) != t.openEnd(d)) && (c = true)), d > o) break;
      l = d, u <= 0 && n66.next(), u >= 0 && t.next();
    }
  }
  function ir2(n66, e) {
    if (n66.length != e.length) return false;
    for (let t = 0; t < n66.length; t++) if (n66[t] != e[t] && !rr2(n66[t], e[t])) return false;
    return true;
  }
  function hn2(n66, e) {
    for (let t = e, i = n66.length - 1; t < i; t++) n66[t] = n66[t + 1];
    n66.pop();
  }
  function cn2(n66, e, t) {
    for (let i = n66.length - 1; i >= e; i--) n66[i + 1] = n66[i];
    n66[e] = t;
  }
  function Fl(n66, e) {
    let t = -1, i = 1e9;
    for (let s = 0; s < e.length; s++) (e[s] - i || n66[s].endSide - n66[t].endSide) < 0 && (t = s, i = e[s]);
    return t;
  }
  function dt2(n66, e, t = n66.length) {
    let i = 0;
    for (let s = 0; s < t && s < n66.length; ) n66.charCodeAt(s) == 9 ? (i += e - i % e, s++) : (i++, s = Z(n66, s));
    return i;
  }
  function _l(n66, e, t, i) {
    for (let s = 0, r = 0; ; ) {
      if (r >= e) return s;
      if (s == n66.length) break;
      r += n66.charCodeAt(s) == 9 ? t - r % t : 1, s = Z(n66, s);
    }
    return i === true ? -1 : n66.length;
  }
  var Yl2 = typeof Symbol > "u" ? "__\u037C" : /* @__PURE__ */ Symbol.for("\u037C");
  var or2 = typeof Symbol > "u" ? "__styleSet" + Math.floor(Math.random() * 1e8) : /* @__PURE__ */ Symbol("styleSet");
  var Xl = typeof globalThis < "u" ? globalThis : typeof window < "u" ? window : {};
  var Oe = class {
    constructor(e, t) {
      this.rules = [];
      let { finish: i } = t || {};
      function s(o) {
        return /^@/.test(o) ? [o] : o.split(/,\s*/);
      }
      function r(o, l, a, h) {
        let c = [], f = /^@(\w+)\b/.exec(o[0]), u = f && f[1] == "keyframes";
        if (f && l == null) return a.push(o[0] + ";");
        for (let d in l) {
          let p = l[d];
          if (/&/.test(d)) r(d.split(/,\s*/).map((m) => o.map((g) => m.replace(/&/, g))).reduce((m, g) => m.concat(g)), p, a);
          else if (p && typeof p == "object") {
            if (!f) throw new RangeError("The value of a property (" + d + ") should be a primitive value.");
            r(s(d), p, c, u);
          } else p != null && c.push(d.replace(/_.*/, "").replace(/[A-Z]/g, (m) => "-" + m.toLowerCase()) + ": " + p + ";");
        }
        (c.length || u) && a.push((i && !f && !h ? o.map(i) : o).join(", ") + " {" + c.join(" ") + "}");
      }
      for (let o in e) r(s(o), e[o], this.rules);
    }
    getRules() {
      return this.rules.join(`
`);
    }
    static newName() {
      let e = Xl[Yl2] || 1;
      return Xl[Yl2] = e + 1, "\u037C" + e.toString(36);
    }
    static mount(e, t, i) {
      let s = e[or2], r = i && i.nonce;
      s ? r && s.setNonce(r) : s = new lr2(e, r), s.mount(Array.isArray(t) ? t : [t], e);
    }
  };
  var Jl = /* @__PURE__ */ new Map();
  var lr2 = class {
    constructor(e, t) {
      let i = e.ownerDocument || e, s = i.defaultView;
      if (!e.head && e.adoptedStyleSheets && s.CSSStyleSheet) {
        let r = Jl.get(i);
        if (r) return e[or2] = r;
        this.sheet = new s.CSSStyleSheet(), Jl.set(i, this);
      } else this.styleTag = i.createElement("style"), t && this.styleTag.setAttribute("nonce", t);
      this.modules = [], e[or2] = this;
    }
    mount(e, t) {
      let i = this.sheet, s = 0, r = 0, o = false;
      for (let l = 0; l < e.length; l++) {
        let a = e[l], h = this.modules.indexOf(a);
        if (h < r && h > -1 && (this.modules.splice(h, 1), o = true, r--, h = -1), h == -1) {
          if (this.modules.splice(r++, 0, a), o = true, i) for (let c = 0; c < a.rules.length; c++) i.insertRule(a.rules[c], s++);
        } else {
          for (; r < h; ) s += this.modules[r++].rules.length;
          s += a.rules.length, r++;
        }
      }
      if (i) t.adoptedStyleSheets.indexOf(this.sheet) < 0 && (t.adoptedStyleSheets = [this.sheet, ...t.adoptedStyleSheets]);
      else {
        if (o) {
          let a = "";
          for (let h = 0; h < this.modules.length; h++) a += this.modules[h].getRules() + `
`;
          this.styleTag.textContent = a;
        }
        let l = t.head || t;
        this.styleTag.parentNode != l && l.insertBefore(this.styleTag, l.firstChild);
      }
    }
    setNonce(e) {
      this.styleTag && this.styleTag.getAttribute("nonce") != e && this.styleTag.setAttribute("nonce", e);
    }
  };
  var lt = { 8: "Backspace", 9: "Tab", 10: "Enter", 12: "NumLock", 13: "Enter", 16: "Shift", 17: "Control", 18: "Alt", 20: "CapsLock", 27: "Escape", 32: " ", 33: "PageUp", 34: "PageDown", 35: "End", 36: "Home", 37: "ArrowLeft", 38: "ArrowUp", 39: "ArrowRight", 40: "ArrowDown", 44: "PrintScreen", 45: "Insert", 46: "Delete", 59: ";", 61: "=", 91: "Meta", 92: "Meta", 106: "*", 107: "+", 108: ",", 109: "-", 110: ".", 111: "/", 144: "NumLock", 145: "ScrollLock", 160: "Shift", 161: "Shift", 162: "Control", 163: "Control", 164: "Alt", 165: "Alt", 173: "-", 186: ";", 187: "=", 188: ",", 189: "-", 190: ".", 191: "/", 192: "`", 219: "[", 220: "\\", 221: "]", 222: "'" };
  var Yt = { 48: ")", 49: "!", 50: "@", 51: "#", 52: "$", 53: "%", 54: "^", 55: "&", 56: "*", 57: "(", 59: ":", 61: "+", 173: "_", 186: ":", 187: "+", 188: "<", 189: "_", 190: ">", 191: "?", 192: "~", 219: "{", 220: "|", 221: "}", 222: '"' };
  var Tf2 = typeof navigator < "u" && /Mac/.test(navigator.platform);
  var Df2 = typeof navigator < "u" && /MSIE \d|Trident\/(?:[7-9]|\d{2,})\..*rv:(\d+)/.exec(navigator.userAgent);
  for (ee = 0; ee < 10; ee++) lt[48 + ee] = lt[96 + ee] = String(ee);
  var ee;
  for (ee = 1; ee <= 24; ee++) lt[ee + 111] = "F" + ee;
  var ee;
  for (ee = 65; ee <= 90; ee++) lt[ee] = String.fromCharCode(ee + 32), Yt[ee] = String.fromCharCode(ee);
  var ee;
  for (xn in lt) Yt.hasOwnProperty(xn) || (Yt[xn] = lt[xn]);
  var xn;
  function Ql(n66) {
    var e = Tf2 && n66.metaKey && n66.shiftKey && !n66.ctrlKey && !n66.altKey || Df2 && n66.shiftKey && n66.key && n66.key.length == 1 || n66.key == "Unidentified", t = !e && n66.key || (n66.shiftKey ? Yt : lt)[n66.keyCode] || n66.key || "Unidentified";
    return t == "Esc" && (t = "Escape"), t == "Del" && (t = "Delete"), t == "Left" && (t = "ArrowLeft"), t == "Up" && (t = "ArrowUp"), t == "Right" && (t = "ArrowRight"), t == "Down" && (t = "ArrowDown"), t;
  }
  function H() {
    var n66 = arguments[0];
    typeof n66 == "string" && (n66 = document.createElement(n66));
    var e = 1, t = arguments[1];
    if (t && typeof t == "object" && t.nodeType == null && !Array.isArray(t)) {
      for (var i in t) if (Object.prototype.hasOwnProperty.call(t, i)) {
        var s = t[i];
        typeof s == "string" ? n66.setAttribute(i, s) : s != null && (n66[i] = s);
      }
      e++;
    }
    for (; e < arguments.length; e++) Zl(n66, arguments[e]);
    return n66;
  }
  function Zl(n66, e) {
    if (typeof e == "string") n66.appendChild(document.createTextNode(e));
    else if (e != null) if (e.nodeType != null) n66.appendChild(e);
    else if (Array.isArray(e)) for (var t = 0; t < e.length; t++) Zl(n66, e[t]);
    else throw new RangeError("Unsupported child node: " + e);
  }
  var ge2 = typeof navigator < "u" ? navigator : { userAgent: "", vendor: "", platform: "" };
  var yr2 = typeof document < "u" ? document : { documentElement: { style: {} } };
  var br2 = /Edge\/(\d+)/.exec(ge2.userAgent);
  var Na = /MSIE \d/.test(ge2.userAgent);
  var xr2 = /Trident\/(?:[7-9]|\d{2,})\..*rv:(\d+)/.exec(ge2.userAgent);
  var Qn2 = !!(Na || xr2 || br2);
  var ea = !Qn2 && /gecko\/(\d+)/i.test(ge2.userAgent);
  var ar2 = !Qn2 && /Chrome\/(\d+)/.exec(ge2.userAgent);
  var ta = "webkitFontSmoothing" in yr2.documentElement.style;
  var wr2 = !Qn2 && /Apple Computer/.test(ge2.vendor);
  var ia = wr2 && (/Mobile\/\w+/.test(ge2.userAgent) || ge2.maxTouchPoints > 2);
  var A = { mac: ia || /Mac/.test(ge2.platform), windows: /Win/.test(ge2.platform), linux: /Linux|X11/.test(ge2.platform), ie: Qn2, ie_version: Na ? yr2.documentMode || 6 : xr2 ? +xr2[1] : br2 ? +br2[1] : 0, gecko: ea, gecko_version: ea ? +(/Firefox\/(\d+)/.exec(ge2.userAgent) || [0, 0])[1] : 0, chrome: !!ar2, chrome_version: ar2 ? +ar2[1] : 0, ios: ia, android: /Android\b/.test(ge2.userAgent), webkit: ta, webkit_version: ta ? +(/\bAppleWebKit\/(\d+)/.exec(ge2.userAgent) || [0, 0])[1] : 0, safari: wr2, safari_version: wr2 ? +(/\bVersion\/(\d+(\.\d+)?)/.exec(ge2.userAgent) || [0, 0])[1] : 0, tabSize: yr2.documentElement.style.tabSize != null ? "tab-size" : "-moz-tab-size" };
  function mo2(n66, e) {
    for (let t in n66) t == "class" && e.class ? e.class += " " + n66.class : t == "style" && e.style ? e.style += ";" + n66.style : e[t] = n66[t];
    return e;
  }
  var In2 = /* @__PURE__ */ Object.create(null);
  function go2(n66, e, t) {
    if (n66 == e) return true;
    n66 || (n66 = In2), e || (e = In2);
    let i = Object.keys(n66), s = Object.keys(e);
    if (i.length - 0 != s.length - 0) return false;
    for (let r of i) if (r != t && (s.indexOf(r) == -1 || n66[r] !== e[r])) return false;
    return true;
  }
  function Of2(n66, e) {
    for (let t = n66.attributes.length - 1; t >= 0; t--) {
      let i = n66.attributes[t].name;
      e[i] == null && n66.removeAttribute(i);
    }
    for (let t in e) {
      let i = e[t];
      t == "style" ? n66.style.cssText = i : n66.getAttribute(t) != i && n66.setAttribute(t, i);
    }
  }
  function na(n66, e, t) {
    let i = false;
    if (e) for (let s in e) t && s in t || (i = true, s == "style" ? n66.style.cssText = "" : n66.removeAttribute(s));
    if (t) for (let s in t) e && e[s] == t[s] || (i = true, s == "style" ? n66.style.cssText = t[s] : n66.setAttribute(s, t[s]));
    return i;
  }
  function Bf2(n66) {
    let e = /* @__PURE__ */ Object.create(null);
    for (let t = 0; t < n66.attributes.length; t++) {
      let i = n66.attributes[t];
      e[i.name] = i.value;
    }
    return e;
  }
  var Re = class {
    eq(e) {
      return false;
    }
    updateDOM(e, t, i) {
      return false;
    }
    compare(e) {
      return this == e || this.constructor == e.constructor && this.eq(e);
    }
    get estimatedHeight() {
      return -1;
    }
    get lineBreaks() {
      return 0;
    }
    ignoreEvent(e) {
      return true;
    }
    coordsAt(e, t, i) {
      return null;
    }
    get isHidden() {
      return false;
    }
    get editable() {
      return false;
    }
    destroy(e) {
    }
  };
  var ae2 = (function(n66) {
    return n66[n66.Text = 0] = "Text", n66[n66.WidgetBefore = 1] = "WidgetBefore", n66[n66.WidgetAfter = 2] = "WidgetAfter", n66[n66.WidgetRange = 3] = "WidgetRange", n66;
  })(ae2 || (ae2 = {}));
  var L = class extends Te2 {
    constructor(e, t, i, s) {
      super(), this.startSide = e, this.endSide = t, this.widget = i, this.spec = s;
    }
    get heightRelevant() {
      return false;
    }
    static mark(e) {
      return new Ni(e);
    }
    static widget(e) {
      let t = Math.max(-1e4, Math.min(1e4, e.side || 0)), i = !!e.block;
      return t += i && !e.inlineOrder ? t > 0 ? 3e8 : -4e8 : t > 0 ? 1e8 : -1e8, new Lt(e, t, t, i, e.widget || null, false);
    }
    static replace(e) {
      let t = !!e.block, i, s;
      if (e.isBlockGap) i = -5e8, s = 4e8;
      else {
        let { start: r, end: o } = Fa(e, t);
        i = (r ? t ? -3e8 : -1 : 5e8) - 1, s = (o ? t ? 2e8 : 1 : -6e8) + 1;
      }
      return new Lt(e, i, s, t, e.widget || null, true);
    }
    static line(e) {
      return new Fi(e);
    }
    static set(e, t = false) {
      return z.of(e, t);
    }
    hasHeight() {
      return this.widget ? this.widget.estimatedHeight > -1 : false;
    }
  };
  L.none = z.empty;
  var Ni = class n20 extends L {
    constructor(e) {
      let { start: t, end: i } = Fa(e);
      super(t ? -1 : 5e8, i ? 1 : -6e8, null, e), this.tagName = e.tagName || "span", this.attrs = e.class && e.attributes ? mo2(e.attributes, { class: e.class }) : e.class ? { class: e.class } : e.attributes || In2;
    }
    eq(e) {
      return this == e || e instanceof n20 && this.tagName == e.tagName && go2(this.attrs, e.attrs);
    }
    range(e, t = e) {
      if (e >= t) throw new RangeError("Mark decorations may not be empty");
      return super.range(e, t);
    }
  };
  Ni.prototype.point = false;
  var Fi = class n21 extends L {
    constructor(e) {
      super(-2e8, -2e8, null, e);
    }
    eq(e) {
      return e instanceof n21 && this.spec.class == e.spec.class && go2(this.spec.attributes, e.spec.attributes);
    }
    range(e, t = e) {
      if (t != e) throw new RangeError("Line decoration ranges must be zero-length");
      return super.range(e, t);
    }
  };
  Fi.prototype.mapMode = ue.TrackBefore;
  Fi.prototype.point = true;
  var Lt = class n22 extends L {
    constructor(e, t, i, s, r, o) {
      super(t, i, r, e), this.block = s, this.isReplace = o, this.mapMode = s ? t <= 0 ? ue.TrackBefore : ue.TrackAfter : ue.TrackDel;
    }
    get type() {
      return this.startSide != this.endSide ? ae2.WidgetRange : this.startSide <= 0 ? ae2.WidgetBefore : ae2.WidgetAfter;
    }
    get heightRelevant() {
      return this.block || !!this.widget && (this.widget.estimatedHeight >= 5 || this.widget.lineBreaks > 0);
    }
    eq(e) {
      return e instanceof n22 && Ef2(this.widget, e.widget) && this.block == e.block && this.startSide == e.startSide && this.endSide == e.endSide;
    }
    range(e, t = e) {
      if (this.isReplace && (e > t || e == t && this.startSide > 0 && this.endSide <= 0)) throw new RangeError("Invalid range for replacement decoration");
      if (!this.isReplace && t != e) throw new RangeError("Widget decorations can only have zero-length ranges");
      return super.range(e, t);
    }
  };
  Lt.prototype.point = true;
  function Fa(n66, e = false) {
    let { inclusiveStart: t, inclusiveEnd: i } = n66;
    return t == null && (t = n66.inclusive), i == null && (i = n66.inclusive), { start: t ?? e, end: i ?? e };
  }
  function Ef2(n66, e) {
    return n66 == e || !!(n66 && e && n66.compare(e));
  }
  function ti2(n66, e, t, i = 0) {
    let s = t.length - 1;
    s >= 0 && t[s] + i >= n66 ? t[s] = Math.max(t[s], e) : t.push(n66, e);
  }
  var Nn = class n23 extends Te2 {
    constructor(e, t, i) {
      super(), this.tagName = e, this.attributes = t, this.rank = i;
    }
    eq(e) {
      return e == this || e instanceof n23 && this.tagName == e.tagName && go2(this.attributes, e.attributes);
    }
    static create(e) {
      return new n23(e.tagName, e.attributes || In2, e.rank == null ? 50 : Math.max(0, Math.min(e.rank, 100)));
    }
    static set(e, t = false) {
      return z.of(e, t);
    }
  };
  Nn.prototype.startSide = Nn.prototype.endSide = -1;
  var ne2 = (n66) => n66.nodeType == 1;
  var ni2 = (n66) => n66.nodeType == 3;
  function Hi(n66) {
    let e;
    return n66.nodeType == 11 ? e = n66.getSelection ? n66 : n66.ownerDocument : e = n66, e.getSelection();
  }
  function vr2(n66, e) {
    return e ? n66 == e || n66.contains(e.nodeType != 1 ? e.parentNode : e) : false;
  }
  function Di(n66, e) {
    if (!e.anchorNode) return false;
    try {
      return vr2(n66, e.anchorNode);
    } catch {
      return false;
    }
  }
  function On(n66) {
    return ni2(n66) ? Wi(n66, 0, n66.nodeValue.length).getClientRects() : ne2(n66) ? n66.getClientRects() : [];
  }
  function Oi(n66, e, t, i) {
    return t ? sa(n66, e, t, i, -1) || sa(n66, e, t, i, 1) : false;
  }
  function gt2(n66) {
    for (var e = 0; ; e++) if (n66 = n66.previousSibling, !n66) return e;
  }
  function Fn(n66) {
    return ne2(n66) && /^(DIV|P|LI|UL|OL|BLOCKQUOTE|DD|DT|H\d|SECTION|PRE)$/.test(n66.nodeName);
  }
  function sa(n66, e, t, i, s) {
    for (; ; ) {
      if (n66 == t && e == i) return true;
      if (e == (s < 0 ? 0 : ct(n66))) {
        if (n66.nodeName == "DIV") return false;
        let r = n66.parentNode;
        if (!r || !ne2(r)) return false;
        e = gt2(n66) + (s < 0 ? 0 : 1), n66 = r;
      } else if (ne2(n66)) {
        if (n66 = n66.childNodes[e + (s < 0 ? -1 : 0)], ne2(n66) && (n66.nodeName == "IMG" || n66.nodeName == "BR" || n66.contentEditable == "false")) return false;
        e = s < 0 ? ct(n66) : 0;
      } else return false;
    }
  }
  function ct(n66) {
    return ni2(n66) ? n66.nodeValue.length : n66.childNodes.length;
  }
  function Hn(n66, e) {
    let { left: t, right: i } = n66;
    if (t == i) return n66;
    let s = e ? t : i;
    return { left: s, right: s, top: n66.top, bottom: n66.bottom };
  }
  function Lf2(n66) {
    let e = n66.visualViewport;
    return e ? { left: 0, right: e.width, top: 0, bottom: e.height } : { left: 0, right: n66.innerWidth, top: 0, bottom: n66.innerHeight };
  }
  function Ha(n66, e) {
    let t = e.width / n66.offsetWidth, i = e.height / n66.offsetHeight;
    return (t > 0.995 && t < 1.005 || !isFinite(t) || Math.abs(e.width - n66.offsetWidth) < 1) && (t = 1), (i > 0.995 && i < 1.005 || !isFinite(i) || Math.abs(e.height - n66.offsetHeight) < 1) && (i = 1), { scaleX: t, scaleY: i };
  }
  function Rf2(n66, e, t, i, s, r, o, l) {
    let a = n66.ownerDocument, h = a.defaultView || window;
    for (let c = n66, f = false; c && !f; ) if (ne2(c)) {
      let u, d = c == a.body, p = 1, m = 1, g = true, y = true;
      if (d) u = Lf2(h);
      else {
        let D = getComputedStyle(c);
        if (/^(fixed|sticky)$/.test(D.position) && (f = true), (c.scrollHeight <= c.clientHeight || !/auto|scroll/.test(D.overflowY)) && (y = false), (c.scrollWidth <= c.clientWidth || !/auto|scroll/.test(D.overflowX)) && (g = false), !g && !y) {
          c = c.assignedSlot || c.parentNode;
          continue;
        }
        let w = c.getBoundingClientRect();
        ({ scaleX: p, scaleY: m } = Ha(c, w)), u = { left: w.left, right: w.left + c.clientWidth * p, top: w.top, bottom: w.top + c.clientHeight * m };
      }
      let v = 0, b = 0;
      if (y) if (s == "nearest") e.top < u.top + o ? (b = e.top - (u.top + o), t > 0 && e.bottom > u.bottom + b && (b = e.bottom - u.bottom + o)) : e.bottom > u.bottom - o && (b = e.bottom - u.bottom + o, t < 0 && e.top - b < u.top && (b = e.top - (u.top + o)));
      else {
        let D = e.bottom - e.top, w = u.bottom - u.top;
        b = (s == "center" && D <= w ? e.top + D / 2 - w / 2 : s == "start" || s == "center" && t < 0 ? e.top - o : e.bottom - w + o) - u.top;
      }
      if (g && (i == "nearest" ? e.left < u.left + r ? (v = e.left - (u.left + r), t > 0 && e.right > u.right + v && (v = e.right - u.right + r)) : e.right > u.right - r && (v = e.right - u.right + r, t < 0 && e.left < u.left + v && (v = e.left - (u.left + r))) : v = (i == "center" ? e.left + (e.right - e.left) / 2 - (u.right - u.left) / 2 : i == "start" == l ? e.left - r : e.right - (u.right - u.left) + r) - u.left), v || b) if (d) h.scrollBy(v, b);
      else {
        let D = 0, w = 0;
        if (b) {
          let k = c.scrollTop;
          c.scrollTop += b / m, w = (c.scrollTop - k) * m;
        }
        if (v) {
          let k = c.scrollLeft;
          c.scrollLeft += v / p, D = (c.scrollLeft - k) * p;
        }
        e = { left: e.left - D, top: e.top - w, right: e.right - D, bottom: e.bottom - w }, D && Math.abs(D - v) < 1 && (i = "nearest"), w && Math.abs(w - b) < 1 && (s = "nearest");
      }
      if (d) break;
      (e.top < u.top || e.bottom > u.bottom || e.left < u.left || e.right > u.right) && (e = { left: Math.max(e.left, u.left), right: Math.min(e.right, u.right), top: Math.max(e.top, u.top), bottom: Math.min(e.bottom, u.bottom) }), c = c.assignedSlot || c.parentNode;
    } else if (c.nodeType == 11) c = c.host;
    else break;
  }
  function Wa(n66, e = true) {
    let t = n66.ownerDocument, i = null, s = null;
    for (let r = n66.parentNode; r && !(r == t.body || (!e || i) && s); ) if (ne2(r)) !s && r.scrollHeight > r.clientHeight && /scroll|auto/.test(getComputedStyle(r).overflowY) && (s = r), e && !i && r.scrollWidth > r.clientWidth && /scroll|auto/.test(getComputedStyle(r).overflowX) && (i = r), r = r.assignedSlot || r.parentNode;
    else if (r.nodeType == 11) r = r.host;
    else break;
    return { x: i, y: s };
  }
  var kr2 = class {
    constructor() {
      this.anchorNode = null, this.anchorOffset = 0, this.focusNode = null, this.focusOffset = 0;
    }
    eq(e) {
      return this.anchorNode == e.anchorNode && this.anchorOffset == e.anchorOffset && this.focusNode == e.focusNode && this.focusOffset == e.focusOffset;
    }
    setRange(e) {
      let { anchorNode: t, focusNode: i } = e;
      this.set(t, Math.min(e.anchorOffset, t ? ct(t) : 0), i, Math.min(e.focusOffset, i ? ct(i) : 0));
    }
    set(e, t, i, s) {
      this.anchorNode = e, this.anchorOffset = t, this.focusNode = i, this.focusOffset = s;
    }
  };
  function Va(n66) {
    let e = [];
    for (let t = n66; t; t = t.nodeType == 11 ? t.host : t.parentNode) ne2(t) && e.push({ node: t, left: t.scrollLeft, top: t.scrollTop });
    return e;
  }
  function za(n66, e = true) {
    for (let { node: t, left: i, top: s } of n66) e && t.scrollTop != s && (t.scrollTop = s), t.scrollLeft != i && (t.scrollLeft = i);
  }
  var Ot2 = null;
  A.safari && A.safari_version >= 26 && (Ot2 = false);
  function qa(n66) {
    if (n66.setActive) return n66.setActive();
    if (Ot2) return n66.focus(Ot2);
    let e = Va(n66);
    n66.focus(Ot2 == null ? { get preventScroll() {
      return Ot2 = { preventScroll: true }, true;
    } } : void 0), Ot2 || (Ot2 = false, za(e));
  }
  var ra;
  function Wi(n66, e, t = e) {
    let i = ra || (ra = document.createRange());
    return i.setEnd(n66, t), i.setStart(n66, e), i;
  }
  function ii2(n66, e, t, i) {
    let s = { key: e, code: e, keyCode: t, which: t, cancelable: true };
    i && ({ altKey: s.altKey, ctrlKey: s.ctrlKey, shiftKey: s.shiftKey, metaKey: s.metaKey } = i);
    let r = new KeyboardEvent("keydown", s);
    r.synthetic = true, n66.dispatchEvent(r);
    let o = new KeyboardEvent("keyup", s);
    return o.synthetic = true, n66.dispatchEvent(o), r.defaultPrevented || o.defaultPrevented;
  }
  function Pf2(n66) {
    for (; n66; ) {
      if (n66 && (n66.nodeType == 9 || n66.nodeType == 11 && n66.host)) return n66;
      n66 = n66.assignedSlot || n66.parentNode;
    }
    return null;
  }
  function If2(n66, e) {
    let t = e.focusNode, i = e.focusOffset;
    if (!t || e.anchorNode != t || e.anchorOffset != i) return false;
    for (i = Math.min(i, ct(t)); ; ) if (i) {
      if (!ne2(t)) return false;
      let s = t.childNodes[i - 1];
      s.contentEditable == "false" ? i-- : (t = s, i = ct(t));
    } else {
      if (t == n66) return true;
      i = gt2(t), t = t.parentNode;
    }
  }
  function Ka(n66) {
    return n66 instanceof Window ? n66.pageYOffset > Math.max(0, n66.document.documentElement.scrollHeight - n66.innerHeight - 4) : n66.scrollTop > Math.max(1, n66.scrollHeight - n66.clientHeight - 4);
  }
  function $a(n66, e) {
    for (let t = n66, i = e; ; ) {
      if (ni2(t) && i > 0) return { node: t, offset: i };
      if (ne2(t) && i > 0) {
        if (t.contentEditable == "false") return null;
        t = t.childNodes[i - 1], i = ct(t);
      } else if (t.parentNode && !Fn(t)) i = gt2(t), t = t.parentNode;
      else return null;
    }
  }
  function ja(n66, e) {
    for (let t = n66, i = e; ; ) {
      if (ni2(t) && i < t.nodeValue.length) return { node: t, offset: i };
      if (ne2(t) && i < t.childNodes.length) {
        if (t.contentEditable == "false") return null;
        t = t.childNodes[i], i = 0;
      } else if (t.parentNode && !Fn(t)) i = gt2(t) + 1, t = t.parentNode;
      else return null;
    }
  }
  var Ze = class n24 {
    constructor(e, t, i = true) {
      this.node = e, this.offset = t, this.precise = i;
    }
    static before(e, t) {
      return new n24(e.parentNode, gt2(e), t);
    }
    static after(e, t) {
      return new n24(e.parentNode, gt2(e) + 1, t);
    }
  };
  var V = (function(n66) {
    return n66[n66.LTR = 0] = "LTR", n66[n66.RTL = 1] = "RTL", n66;
  })(V || (V = {}));
  var si2 = V.LTR;
  var yo2 = V.RTL;
  function Ua(n66) {
    let e = [];
    for (let t = 0; t < n66.length; t++) e.push(1 << +n66[t]);
    return e;
  }
  var Nf2 = Ua("88888888888888888888888888888888888666888888787833333333337888888000000000000000000000000008888880000000000000000000000000088888888888888888888888888888888888887866668888088888663380888308888800000000000000000000000800000000000000000000000000000008");
  var Ff2 = Ua("4444448826627288999999999992222222222222222222222222222222222222222222222229999999999999999999994444444444644222822222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222999999949999999229989999223333333333");
  var Sr2 = /* @__PURE__ */ Object.create(null);
  var Qe = [];
  for (let n66 of ["()", "[]", "{}"]) {
    let e = n66.charCodeAt(0), t = n66.charCodeAt(1);
    Sr2[e] = t, Sr2[t] = -e;
  }
  function Ga(n66) {
    return n66 <= 247 ? Nf2[n66] : 1424 <= n66 && n66 <= 1524 ? 2 : 1536 <= n66 && n66 <= 1785 ? Ff2[n66 - 1536] : 1774 <= n66 && n66 <= 2220 ? 4 : 8192 <= n66 && n66 <= 8204 ? 256 : 64336 <= n66 && n66 <= 65023 ? 4 : 1;
  }
  var Hf2 = /[\u0590-\u05f4\u0600-\u06ff\u0700-\u08ac\ufb50-\ufdff]/;
  var Le = class {
    get dir() {
      return this.level % 2 ? yo2 : si2;
    }
    constructor(e, t, i) {
      this.from = e, this.to = t, this.level = i;
    }
    side(e, t) {
      return this.dir == t == e ? this.to : this.from;
    }
    forward(e, t) {
      return e == (this.dir == t);
    }
    static find(e, t, i, s) {
      let r = -1;
      for (let o = 0; o < e.length; o++) {
        let l = e[o];
        if (l.from <= t && l.to >= t) {
          if (l.level == i) return o;
          (r < 0 || (s != 0 ? s < 0 ? l.from < t : l.to > t : e[r].level > l.level)) && (r = o);
        }
      }
      if (r < 0) throw new RangeError("Index out of range");
      return r;
    }
  };
  function _a(n66, e) {
    if (n66.length != e.length) return false;
    for (let t = 0; t < n66.length; t++) {
      let i = n66[t], s = e[t];
      if (i.from != s.from || i.to != s.to || i.direction != s.direction || !_a(i.inner, s.inner)) return false;
    }
    return true;
  }
  var $ = [];
  function Wf2(n66, e, t, i, s) {
    for (let r = 0; r <= i.length; r++) {
      let o = r ? i[r - 1].to : e, l = r < i.length ? i[r].from : t, a = r ? 256 : s;
      for (let h = o, c = a, f = a; h < l; h++) {
        let u = Ga(n66.charCodeAt(h));
        u == 512 ? u = c : u == 8 && f == 4 && (u = 16), $[h] = u == 4 ? 2 : u, u & 7 && (f = u), c = u;
      }
      for (let h = o, c = a, f = a; h < l; h++) {
        let u = $[h];
        if (u == 128) h < l - 1 && c == $[h + 1] && c & 24 ? u = $[h] = c : $[h] = 256;
        else if (u == 64) {
          let d = h + 1;
          for (; d < l && $[d] == 64; ) d++;
          let p = h && c == 8 || d < t && $[d] == 8 ? f == 1 ? 1 : 8 : 256;
          for (let m = h; m < d; m++) $[m] = p;
          h = d - 1;
        } else u == 8 && f == 1 && ($[h] = 1);
        c = u, u & 7 && (f = u);
      }
    }
  }
  function Vf2(n66, e, t, i, s) {
    let r = s == 1 ? 2 : 1;
    for (let o = 0, l = 0, a = 0; o <= i.length; o++) {
      let h = o ? i[o - 1].to : e, c = o < i.length ? i[o].from : t;
      for (let f = h, u, d, p; f < c; f++) if (d = Sr2[u = n66.charCodeAt(f)]) if (d < 0) {
        for (let m = l - 3; m >= 0; m -= 3) if (Qe[m + 1] == -d) {
          let g = Qe[m + 2], y = g & 2 ? s : g & 4 ? g & 1 ? r : s : 0;
          y && ($[f] = $[Qe[m]] = y), l = m;
          break;
        }
      } else {
        if (Qe.length == 189) break;
        Qe[l++] = f, Qe[l++] = u, Qe[l++] = a;
      }
      else if ((p = $[f]) == 2 || p == 1) {
        let m = p == s;
        a = m ? 0 : 1;
        for (let g = l - 3; g >= 0; g -= 3) {
          let y = Qe[g + 2];
          if (y & 2) break;
          if (m) Qe[g + 2] |= 2;
          else {
            if (y & 4) break;
            Qe[g + 2] |= 4;
          }
        }
      }
    }
  }
  function zf2(n66, e, t, i) {
    for (let s = 0, r = i; s <= t.length; s++) {
      let o = s ? t[s - 1].to : n66, l = s < t.length ? t[s].from : e;
      for (let a = o; a < l; ) {
        let h = $[a];
        if (h == 256) {
          let c = a + 1;
          for (; ; ) if (c == l) {
            if (s == t.length) break;
            c = t[s++].to, l = s < t.length ? t[s].from : e;
          } else if ($[c] == 256) c++;
          else break;
          let f = r == 1, u = (c < e ? $[c] : i) == 1, d = f == u ? f ? 1 : 2 : i;
          for (let p = c, m = s, g = m ? t[m - 1].to : n66; p > a; ) p == g && (p = t[--m].from, g = m ? t[m - 1].to : n66), $[--p] = d;
          a = c;
        } else r = h, a++;
      }
    }
  }
  function Cr2(n66, e, t, i, s, r, o) {
    let l = i % 2 ? 2 : 1;
    if (i % 2 == s % 2) for (let a = e, h = 0; a < t; ) {
      let c = true, f = false;
      if (h == r.length || a < r[h].from) {
        let m = $[a];
        m != l && (c = false, f = m == 16);
      }
      let u = !c && l == 1 ? [] : null, d = c ? i : i + 1, p = a;
      e: for (; ; ) if (h < r.length && p == r[h].from) {
        if (f) break e;
        let m = r[h];
        if (!c) for (let g = m.to, y = h + 1; ; ) {
          if (g == t) break e;
          if (y < r.length && r[y].from == g) g = r[y++].to;
          else {
            if ($[g] == l) break e;
            break;
          }
        }
        if (h++, u) u.push(m);
        else {
          m.from > a && o.push(new Le(a, m.from, d));
          let g = m.direction == si2 != !(d % 2);
          Ar2(n66, g ? i + 1 : i, s, m.inner, m.from, m.to, o), a = m.to;
        }
        p = m.to;
      } else {
        if (p == t || (c ? $[p] != l : $[p] == l)) break;
        p++;
      }
      u ? Cr2(n66, a, p, i + 1, s, u, o) : a < p && o.push(new Le(a, p, d)), a = p;
    }
    else for (let a = t, h = r.length; a > e; ) {
      let c = true, f = false;
      if (!h || a > r[h - 1].to) {
        let m = $[a - 1];
        m != l && (c = false, f = m == 16);
      }
      let u = !c && l == 1 ? [] : null, d = c ? i : i + 1, p = a;
      e: for (; ; ) if (h && p == r[h - 1].to) {
        if (f) break e;
        let m = r[--h];
        if (!c) for (let g = m.from, y = h; ; ) {
          if (g == e) break e;
          if (y && r[y - 1].to == g) g = r[--y].from;
          else {
            if ($[g - 1] == l) break e;
            break;
          }
        }
        if (u) u.push(m);
        else {
          m.to < a && o.push(new Le(m.to, a, d));
          let g = m.direction == si2 != !(d % 2);
          Ar2(n66, g ? i + 1 : i, s, m.inner, m.from, m.to, o), a = m.from;
        }
        p = m.from;
      } else {
        if (p == e || (c ? $[p - 1] != l : $[p - 1] == l)) break;
        p--;
      }
      u ? Cr2(n66, p, a, i + 1, s, u, o) : p < a && o.push(new Le(p, a, d)), a = p;
    }
  }
  function Ar2(n66, e, t, i, s, r, o) {
    let l = e % 2 ? 2 : 1;
    Wf2(n66, s, r, i, l), Vf2(n66, s, r, i, l), zf2(s, r, i, l), Cr2(n66, s, r, e, t, i, o);
  }
  function qf(n66, e, t) {
    if (!n66) return [new Le(0, 0, e == yo2 ? 1 : 0)];
    if (e == si2 && !t.length && !Hf2.test(n66)) return Ya(n66.length);
    if (t.length) for (; n66.length > $.length; ) $[$.length] = 256;
    let i = [], s = e == si2 ? 0 : 1;
    return Ar2(n66, s, s, t, 0, n66.length, i), i;
  }
  function Ya(n66) {
    return [new Le(0, n66, 0)];
  }
  var Xa = "";
  function Kf(n66, e, t, i, s) {
    var r;
    if (!n66.length) return null;
    let o = i.head - n66.from, l;
    if (i.head == n66.from && i.assoc < 0) {
      if (!s) return null;
      o = e[l = 0].side(false, t);
    } else if (i.head == n66.to && i.assoc > 0) {
      if (s) return null;
      o = e[l = e.length - 1].side(true, t);
    } else l = Le.find(e, o, (r = i.bidiLevel) !== null && r !== void 0 ? r : -1, i.assoc);
    let a = e[l], h = a.side(s, t);
    if (o == h) {
      let u = l += s ? 1 : -1;
      if (u < 0 || u >= e.length) return null;
      a = e[l = u], o = a.side(!s, t), h = a.side(s, t);
    }
    let c = Z(n66.text, o, a.forward(s, t));
    (c < a.from || c > a.to) && (c = h), Xa = n66.text.slice(Math.min(o, c), Math.max(o, c));
    let f = l == (s ? e.length - 1 : 0) ? null : e[l + (s ? 1 : -1)];
    if (c == h) {
      if (!f) return s ? x.cursor(n66.to, 1) : x.cursor(n66.from, -1);
      if (f.level + (s ? 0 : 1) < a.level) return x.cursor(f.side(!s, t) + n66.from, f.forward(s, t) ? 1 : -1, f.level);
    }
    return x.cursor(c + n66.from, a.forward(s, t) ? -1 : 1, a.level);
  }
  function $f(n66, e, t) {
    for (let i = e; i < t; i++) {
      let s = Ga(n66.charCodeAt(i));
      if (s == 1) return si2;
      if (s == 2 || s == 4) return yo2;
    }
  }
  var Ja = T.define();
  var Qa = T.define();
  var Za = T.define();
  var eh = T.define();
  var Mr2 = T.define();
  var th = T.define();
  var ih = T.define();
  var bo2 = T.define();
  var xo2 = T.define();
  var nh = T.define({ combine: (n66) => n66.some((e) => e) });
  var sh = T.define({ combine: (n66) => n66.some((e) => e) });
  var rh = T.define();
  var Bi = class n25 {
    constructor(e, t, i, s, r, o = false) {
      this.range = e, this.y = t, this.x = i, this.yMargin = s, this.xMargin = r, this.isSnapshot = o;
    }
    map(e) {
      return e.empty ? this : new n25(this.range.map(e), this.y, this.x, this.yMargin, this.xMargin, this.isSnapshot);
    }
    clip(e) {
      return this.range.to <= e.doc.length ? this : new n25(x.cursor(e.doc.length), this.y, this.x, this.yMargin, this.xMargin, this.isSnapshot);
    }
  };
  var wn = E.define({ map: (n66, e) => n66.map(e) });
  var oh = E.define();
  function le(n66, e, t) {
    let i = n66.facet(eh);
    i.length ? i[0](e) : window.onerror && window.onerror(String(e), t, void 0, void 0, e) || (t ? console.error(t + ":", e) : console.error(e));
  }
  var at = T.define({ combine: (n66) => n66.length ? n66[0] : true });
  var jf = 0;
  var Jt2 = T.define({ combine(n66) {
    return n66.filter((e, t) => {
      for (let i = 0; i < t; i++) if (n66[i].plugin == e.plugin) return false;
      return true;
    });
  } });
  var te = class n26 {
    constructor(e, t, i, s, r) {
      this.id = e, this.create = t, this.domEventHandlers = i, this.domEventObservers = s, this.baseExtensions = r(this), this.extension = this.baseExtensions.concat(Jt2.of({ plugin: this, arg: void 0 }));
    }
    of(e) {
      return this.baseExtensions.concat(Jt2.of({ plugin: this, arg: e }));
    }
    static define(e, t) {
      let { eventHandlers: i, eventObservers: s, provide: r, decorations: o } = t || {};
      return new n26(jf++, e, i, s, (l) => {
        let a = [];
        return o && a.push(Zn2.of((h) => {
          let c = h.plugin(l);
          return c ? o(c) : L.none;
        })), r && a.push(r(l)), a;
      });
    }
    static fromClass(e, t) {
      return n26.define((i, s) => new e(i, s), t);
    }
  };
  var Ei = class {
    constructor(e) {
      this.spec = e, this.mustUpdate = null, this.value = null;
    }
    get plugin() {
      return this.spec && this.spec.plugin;
    }
    update(e) {
      if (this.value) {
        if (this.mustUpdate) {
          let t = this.mustUpdate;
          if (this.mustUpdate = null, this.value.update) try {
            this.value.update(t);
          } catch (i) {
            if (le(t.state, i, "CodeMirror plugin crashed"), this.value.destroy) try {
              this.value.destroy();
            } catch {
            }
            this.deactivate();
          }
        }
      } else if (this.spec) try {
        this.value = this.spec.plugin.create(e, this.spec.arg);
      } catch (t) {
        le(e.state, t, "CodeMirror plugin crashed"), this.deactivate();
      }
      return this;
    }
    destroy(e) {
      var t;
      if (!((t = this.value) === null || t === void 0) && t.destroy) try {
        this.value.destroy();
      } catch (i) {
        le(e.state, i, "CodeMirror plugin crashed");
      }
    }
    deactivate() {
      this.spec = this.value = null;
    }
  };
  var lh = T.define();
  var wo2 = T.define();
  var Zn2 = T.define();
  var ah = T.define();
  var vo2 = T.define();
  var Vi = T.define();
  var hh = T.define();
  function oa(n66, e) {
    let t = n66.state.facet(hh);
    if (!t.length) return t;
    let i = t.map((r) => r instanceof Function ? r(n66) : r), s = [];
    return z.spans(i, e.from, e.to, { point() {
    }, span(r, o, l, a) {
      let h = r - e.from, c = o - e.from, f = s;
      for (let u = l.length - 1; u >= 0; u--, a--) {
        let d = l[u].spec.bidiIsolate, p;
        if (a > 0 && f.length && (p = f[f.length - 1]).to == h && p.direction == d) p.to = c, f = p.inner;
        else {
          let m = { from: h, to: c, direction: d, inner: [] };
          f.push(m), f = m.inner;
        }
      }
    } }), ch(e.text, s);
  }
  function ch(n66, e) {
    for (let t of e) {
      if (t.direction == null) {
        for (let i = t.from, s = 0; i < t.to; s++) {
          let r = s < t.inner.length ? t.inner[s] : null, o = $f(n66, i, r ? r.from : t.to);
          if (o) {
            t.direction = o;
            break;
          }
          if (!r) break;
          i = r.to;
        }
        t.direction == null && (t.direction = V.LTR);
      }
      ch(n66, t.inner);
    }
    return e;
  }
  var fh = T.define();
  function ko2(n66) {
    let e = 0, t = 0, i = 0, s = 0;
    for (let r of n66.state.facet(fh)) {
      let o = r(n66);
      o && (o.left != null && (e = Math.max(e, o.left)), o.right != null && (t = Math.max(t, o.right)), o.top != null && (i = Math.max(i, o.top)), o.bottom != null && (s = Math.max(s, o.bottom)));
    }
    return { left: e, right: t, top: i, bottom: s };
  }
  var Mi = T.define();
  var We = class n27 {
    constructor(e, t, i, s) {
      this.fromA = e, this.toA = t, this.fromB = i, this.toB = s;
    }
    join(e) {
      return new n27(Math.min(this.fromA, e.fromA), Math.max(this.toA, e.toA), Math.min(this.fromB, e.fromB), Math.max(this.toB, e.toB));
    }
    addToSet(e) {
      let t = e.length, i = this;
      for (; t > 0; t--) {
        let s = e[t - 1];
        if (!(s.fromA > i.toA)) {
          if (s.toA < i.fromA) break;
          i = i.join(s), e.splice(t - 1, 1);
        }
      }
      return e.splice(t, 0, i), e;
    }
    static extendWithRanges(e, t) {
      if (t.length == 0) return e;
      let i = [];
      for (let s = 0, r = 0, o = 0; ; ) {
        let l = s < e.length ? e[s].fromB : 1e9, a = r < t.length ? t[r] : 1e9, h = Math.min(l, a);
        if (h == 1e9) break;
        let c = h + o, f = h, u = c;
        for (; ; ) if (r < t.length && t[r] <= f) {
          let d = t[r + 1];
          r += 2, f = Math.max(f, d);
          for (let p = s; p < e.length && e[p].fromB <= f; p++) o = e[p].toA - e[p].toB;
          u = Math.max(u, d + o);
        } else if (s < e.length && e[s].fromB <= f) {
          let d = e[s++];
          f = Math.max(f, d.toB), u = Math.max(u, d.toA), o = d.toA - d.toB;
        } else break;
        i.push(new n27(c, u, h, f));
      }
      return i;
    }
  };
  var Wn2 = class n28 {
    constructor(e, t, i) {
      this.view = e, this.state = t, this.transactions = i, this.flags = 0, this.startState = e.state, this.changes = ie.empty(this.startState.doc.length);
      for (let r of i) this.changes = this.changes.compose(r.changes);
      let s = [];
      this.changes.iterChangedRanges((r, o, l, a) => s.push(new We(r, o, l, a))), this.changedRanges = s;
    }
    static create(e, t, i) {
      return new n28(e, t, i);
    }
    get viewportChanged() {
      return (this.flags & 4) > 0;
    }
    get viewportMoved() {
      return (this.flags & 8) > 0;
    }
    get heightChanged() {
      return (this.flags & 2) > 0;
    }
    get geometryChanged() {
      return this.docChanged || (this.flags & 18) > 0;
    }
    get focusChanged() {
      return (this.flags & 1) > 0;
    }
    get docChanged() {
      return !this.changes.empty;
    }
    get selectionSet() {
      return this.transactions.some((e) => e.selection);
    }
    get empty() {
      return this.flags == 0 && this.transactions.length == 0;
    }
  };
  var Uf = [];
  var Y = class {
    constructor(e, t, i = 0) {
      this.dom = e, this.length = t, this.flags = i, this.parent = null, e.cmTile = this;
    }
    get breakAfter() {
      return this.flags & 1;
    }
    get children() {
      return Uf;
    }
    isWidget() {
      return false;
    }
    get isHidden() {
      return false;
    }
    isComposite() {
      return false;
    }
    isLine() {
      return false;
    }
    isText() {
      return false;
    }
    isBlock() {
      return false;
    }
    get domAttrs() {
      return null;
    }
    sync(e) {
      if (this.flags |= 2, this.flags & 4) {
        this.flags &= -5;
        let t = this.domAttrs;
        t && Of2(this.dom, t);
      }
    }
    toString() {
      return this.constructor.name + (this.children.length ? `(${this.children})` : "") + (this.breakAfter ? "#" : "");
    }
    destroy() {
      this.parent = null;
    }
    setDOM(e) {
      this.dom = e, e.cmTile = this;
    }
    get posAtStart() {
      return this.parent ? this.parent.posBefore(this) : 0;
    }
    get posAtEnd() {
      return this.posAtStart + this.length;
    }
    posBefore(e, t = this.posAtStart) {
      let i = t;
      for (let s of this.children) {
        if (s == e) return i;
        i += s.length + s.breakAfter;
      }
      throw new RangeError("Invalid child in posBefore");
    }
    posAfter(e) {
      return this.posBefore(e) + e.length;
    }
    covers(e) {
      return true;
    }
    coordsIn(e, t, i) {
      return null;
    }
    domPosFor(e, t) {
      let i = gt2(this.dom), s = this.length ? e > 0 : t > 0;
      return new Ze(this.parent.dom, i + (s ? 1 : 0), e == 0 || e == this.length);
    }
    markDirty(e) {
      this.flags &= -3, e && (this.flags |= 4), this.parent && this.parent.flags & 2 && this.parent.markDirty(false);
    }
    get overrideDOMText() {
      return null;
    }
    get root() {
      for (let e = this; e; e = e.parent) if (e instanceof oi2) return e;
      return null;
    }
    static get(e) {
      return e.cmTile;
    }
  };
  var ri2 = class extends Y {
    constructor(e) {
      super(e, 0), this._children = [];
    }
    isComposite() {
      return true;
    }
    get children() {
      return this._children;
    }
    get lastChild() {
      return this.children.length ? this.children[this.children.length - 1] : null;
    }
    append(e) {
      this.children.push(e), e.parent = this;
    }
    sync(e) {
      if (this.flags & 2) return;
      super.sync(e);
      let t = this.dom, i = null, s, r = e?.node == t ? e : null, o = 0;
      for (let l of this.children) {
        if (l.sync(e), o += l.length + l.breakAfter, s = i ? i.nextSibling : t.firstChild, r && s != l.dom && (r.written = true), l.dom.parentNode == t) for (; s && s != l.dom; ) s = la(s);
        else t.insertBefore(l.dom, s);
        i = l.dom;
      }
      for (s = i ? i.nextSibling : t.firstChild, r && s && (r.written = true); s; ) s = la(s);
      this.length = o;
    }
  };
  function la(n66) {
    let e = n66.nextSibling;
    return n66.parentNode.removeChild(n66), e;
  }
  var oi2 = class extends ri2 {
    constructor(e, t) {
      super(t), this.view = e;
    }
    owns(e) {
      for (; e; e = e.parent) if (e == this) return true;
      return false;
    }
    isBlock() {
      return true;
    }
    nearest(e) {
      for (; ; ) {
        if (!e) return null;
        let t = Y.get(e);
        if (t && this.owns(t)) return t;
        e = e.parentNode;
      }
    }
    blockTiles(e) {
      for (let t = [], i = this, s = 0, r = 0; ; ) if (s == i.children.length) {
        if (!t.length) return;
        i = i.parent, i.breakAfter && r++, s = t.pop();
      } else {
        let o = i.children[s++];
        if (o instanceof ht) t.push(s), i = o, s = 0;
        else {
          let l = r + o.length, a = e(o, r);
          if (a !== void 0) return a;
          r = l + o.breakAfter;
        }
      }
    }
    resolveBlock(e, t) {
      let i, s = -1, r, o = -1;
      if (this.blockTiles((l, a) => {
        let h = a + l.length;
        if (e >= a && e <= h) {
          if (l.isWidget() && t >= -1 && t <= 1) {
            if (l.flags & 32) return true;
            l.flags & 16 && (i = void 0);
          }
          (a < e || e == h && (t < -1 ? l.length : l.covers(1))) && (!i || !l.isWidget() && i.isWidget()) && (i = l, s = e - a), (h > e || e == a && (t > 1 ? l.length : l.covers(-1))) && (!r || !l.isWidget() && r.isWidget()) && (r = l, o = e - a);
        }
      }), !i && !r) throw new Error("No tile at position " + e);
      return i && t < 0 || !r ? { tile: i, offset: s } : { tile: r, offset: o };
    }
  };
  var ht = class n29 extends ri2 {
    constructor(e, t) {
      super(e), this.wrapper = t;
    }
    isBlock() {
      return true;
    }
    covers(e) {
      return this.children.length ? e < 0 ? this.children[0].covers(-1) : this.lastChild.covers(1) : false;
    }
    get domAttrs() {
      return this.wrapper.attributes;
    }
    static of(e, t) {
      let i = new n29(t || document.createElement(e.tagName), e);
      return t || (i.flags |= 4), i;
    }
  };
  var li2 = class n30 extends ri2 {
    constructor(e, t) {
      super(e), this.attrs = t;
    }
    isLine() {
      return true;
    }
    static start(e, t, i) {
      let s = new n30(t || document.createElement("div"), e);
      return (!t || !i) && (s.flags |= 4), s;
    }
    get domAttrs() {
      return this.attrs;
    }
    resolveInline(e, t, i = false) {
      let s = null, r = -1, o = null, l = -1;
      function a(c, f) {
        for (let u = 0, d = 0; u < c.children.length && d <= f; u++) {
          let p = c.children[u], m = d + p.length;
          m >= f && (p.isComposite() ? a(p, f - d) : (!o || i && o.isHidden && (t > 0 && !(o.flags & 32) || i && _f2(o, p))) && (m > f || p.flags & 32 && t <= 1) ? (o = p, l = f - d) : (d < f || p.flags & 16 && !(i && p.isHidden) && t >= -1) && (s = p, r = f - d)), d = m;
        }
      }
      a(this, e);
      let h = (t < 0 ? s : o) || s || o;
      return h ? { tile: h, offset: h == s ? r : l } : null;
    }
    coordsIn(e, t, i) {
      let s = this.resolveInline(e, t, true);
      return s ? s.tile.coordsIn(Math.max(0, s.offset), t, i) : Gf2(this);
    }
    domIn(e, t) {
      let i = this.resolveInline(e, t);
      if (i) {
        let { tile: s, offset: r } = i;
        if (this.dom.contains(s.dom)) return s.isText() ? new Ze(s.dom, Math.min(s.dom.nodeValue.length, r)) : s.domPosFor(r, s.flags & 16 ? 1 : s.flags & 32 ? -1 : t);
        let o = i.tile.parent, l = false;
        for (let a of o.children) {
          if (l) return new Ze(a.dom, 0);
          a == i.tile && (l = true);
        }
      }
      return new Ze(this.dom, 0);
    }
  };
  function Gf2(n66) {
    let e = n66.dom.lastChild;
    if (!e) return n66.dom.getBoundingClientRect();
    let t = On(e);
    return t[t.length - 1] || null;
  }
  function _f2(n66, e) {
    let t = n66.coordsIn(0, 1), i = e.coordsIn(0, 1);
    return t && i && i.top < t.bottom;
  }
  var be = class n31 extends ri2 {
    constructor(e, t) {
      super(e), this.mark = t;
    }
    get domAttrs() {
      return this.mark.attrs;
    }
    static of(e, t) {
      let i = new n31(t || document.createElement(e.tagName), e);
      return t || (i.flags |= 4), i;
    }
  };
  var Bt = class n32 extends Y {
    constructor(e, t) {
      super(e, t.length), this.text = t;
    }
    sync(e) {
      this.flags & 2 || (super.sync(e), this.dom.nodeValue != this.text && (e && e.node == this.dom && (e.written = true), this.dom.nodeValue = this.text));
    }
    isText() {
      return true;
    }
    toString() {
      return JSON.stringify(this.text);
    }
    coordsIn(e, t, i) {
      let s = this.dom.nodeValue.length;
      e > s && (e = s);
      let r = e, o = e, l = 0;
      e == 0 && t < 0 || e == s && t >= 0 ? A.chrome || A.gecko || (e ? (r--, l = 1) : o < s && (o++, l = -1)) : t < 0 ? r-- : o < s && o++;
      let a = Wi(this.dom, r, o).getClientRects();
      if (!a.length) return null;
      let h = a[(l ? l < 0 : t >= 0) ? 0 : a.length - 1];
      return A.safari && !l && h.width == 0 && (h = Array.prototype.find.call(a, (c) => c.width) || h), i == null ? h : Hn(h, (l ? l > 0 : t < 0) == i);
    }
    static of(e, t) {
      let i = new n32(t || document.createTextNode(e), e);
      return t || (i.flags |= 2), i;
    }
  };
  var Rt = class n33 extends Y {
    constructor(e, t, i, s) {
      super(e, t, s), this.widget = i;
    }
    isWidget() {
      return true;
    }
    get isHidden() {
      return this.widget.isHidden;
    }
    covers(e) {
      return this.flags & 48 ? false : (this.flags & (e < 0 ? 64 : 128)) > 0;
    }
    coordsIn(e, t) {
      return this.coordsInWidget(e, t, false);
    }
    coordsInWidget(e, t, i) {
      let s = this.widget.coordsAt(this.dom, e, t);
      if (s) return s;
      if (i) return Hn(this.dom.getBoundingClientRect(), this.length ? e == 0 : t <= 0);
      {
        let r = this.dom.getClientRects(), o = null;
        if (!r.length) return null;
        let l = this.flags & 16 ? true : this.flags & 32 ? false : e > 0;
        for (let a = l ? r.length - 1 : 0; o = r[a], !(e > 0 ? a == 0 : a == r.length - 1 || o.top < o.bottom); a += l ? -1 : 1) ;
        return Hn(o, !l);
      }
    }
    get overrideDOMText() {
      if (!this.length) return F.empty;
      let { root: e } = this;
      if (!e) return F.empty;
      let t = this.posAtStart;
      return e.view.state.doc.slice(t, t + this.length);
    }
    destroy() {
      super.destroy(), this.widget.destroy(this.dom);
    }
    static of(e, t, i, s, r) {
      return r || (r = e.toDOM(t), e.editable || (r.contentEditable = "false")), new n33(r, i, e, s);
    }
  };
  var ai2 = class extends Y {
    constructor(e) {
      let t = document.createElement("img");
      t.className = "cm-widgetBuffer", t.setAttribute("aria-hidden", "true"), super(t, 0, e);
    }
    get isHidden() {
      return true;
    }
    get overrideDOMText() {
      return F.empty;
    }
    coordsIn(e, t, i) {
      let s = this.dom.getBoundingClientRect();
      return i == null ? s : Hn(s, t > 0 == i);
    }
  };
  var Tr2 = class {
    constructor(e) {
      this.index = 0, this.beforeBreak = false, this.parents = [], this.tile = e;
    }
    advance(e, t, i) {
      let { tile: s, index: r, beforeBreak: o, parents: l } = this;
      for (; e || t > 0; ) if (s.isComposite()) if (o) {
        if (!e) break;
        i && i.break(), e--, o = false;
      } else if (r == s.children.length) {
        if (!e && !l.length) break;
        i && i.leave(s), o = !!s.breakAfter, { tile: s, index: r } = l.pop(), r++;
      } else {
        let a = s.children[r], h = a.breakAfter;
        (t > 0 ? a.length <= e : a.length < e) && (!i || i.skip(a, 0, a.length) !== false || !a.isComposite) ? (o = !!h, r++, e -= a.length) : (l.push({ tile: s, index: r }), s = a, r = 0, i && a.isComposite() && i.enter(a));
      }
      else {
        let a = s.length;
        if (r < a && e) {
          let h = Math.min(e, a - r);
          i && i.skip(s, r, r + h), e -= h, r += h;
        }
        if (r == a) o = !!s.breakAfter, { tile: s, index: r } = l.pop(), r++;
        else if (!e) break;
      }
      return this.tile = s, this.index = r, this.beforeBreak = o, this;
    }
    get root() {
      return this.parents.length ? this.parents[0].tile : this.tile;
    }
  };
  var Dr2 = class {
    constructor(e, t, i, s) {
      this.from = e, this.to = t, this.wrapper = i, this.rank = s;
    }
  };
  var Or2 = class {
    constructor(e, t, i) {
      this.cache = e, this.root = t, this.blockWrappers = i, this.curLine = null, this.lastBlock = null, this.afterWidget = null, this.pos = 0, this.wrappers = [], this.wrapperPos = 0;
    }
    addText(e, t, i, s) {
      var r;
      this.flushBuffer();
      let o = this.ensureMarks(t, i), l = o.lastChild;
      if (l && l.isText() && !(l.flags & 8) && l.length + e.length < 512) {
        this.cache.reused.set(l, 2);
        let a = o.children[o.children.length - 1] = new Bt(l.dom, l.text + e);
        a.parent = o;
      } else o.append(s || Bt.of(e, (r = this.cache.find(Bt)) === null || r === void 0 ? void 0 : r.dom));
      this.pos += e.length, this.afterWidget = null;
    }
    addComposition(e, t) {
      let i = this.curLine;
      i.dom != t.line.dom && (i.setDOM(this.cache.reused.has(t.line) ? hr2(t.line.dom) : t.line.dom), this.cache.reused.set(t.line, 2));
      let s = i;
      for (let l = t.marks.length - 1; l >= 0; l--) {
        let a = t.marks[l], h = s.lastChild;
        if (h instanceof be && h.mark.eq(a.mark)) h.dom != a.dom && h.setDOM(hr2(a.dom)), s = h;
        else {
          let { dom: c } = a;
          this.cache.reused.get(a) && Y.get(a.dom) && (c = hr2(a.dom));
          let f = be.of(a.mark, c);
          s.append(f), s = f;
        }
        this.cache.reused.set(a, 2);
      }
      let r = Y.get(e.text);
      r && this.cache.reused.set(r, 2);
      let o = new Bt(e.text, e.text.nodeValue);
      o.flags |= 8, this.pos = e.range.toB, s.append(o);
    }
    addInlineWidget(e, t, i) {
      let s = this.afterWidget && e.flags & 48 && (this.afterWidget.flags & 48) == (e.flags & 48);
      s || this.flushBuffer();
      let r = this.ensureMarks(t, i);
      !s && !(e.flags & 16) && r.append(this.getBuffer(1)), r.append(e), this.pos += e.length, this.afterWidget = e;
    }
    addMark(e, t, i) {
      this.flushBuffer(), this.ensureMarks(t, i).append(e), this.pos += e.length, this.afterWidget = null;
    }
    addBlockWidget(e) {
      this.getBlockPos().append(e), this.pos += e.length, this.lastBlock = e, this.endLine();
    }
    continueWidget(e) {
      let t = this.afterWidget || this.lastBlock;
      t.length += e, this.pos += e;
    }
    addLineStart(e, t) {
      var i;
      e || (e = uh);
      let s = li2.start(e, t || ((i = this.cache.find(li2)) === null || i === void 0 ? void 0 : i.dom), !!t);
      this.getBlockPos().append(this.lastBlock = this.curLine = s);
    }
    addLine(e) {
      this.getBlockPos().append(e), this.pos += e.length, this.lastBlock = e, this.endLine();
    }
    addBreak() {
      this.lastBlock.flags |= 1, this.endLine(), this.pos++;
    }
    addLineStartIfNotCovered(e) {
      this.blockPosCovered() || this.addLineStart(e);
    }
    ensureLine(e) {
      this.curLine || this.addLineStart(e);
    }
    ensureMarks(e, t) {
      var i;
      let s = this.curLine;
      for (let r = e.length - 1; r >= 0; r--) {
        let o = e[r], l;
        if (t > 0 && (l = s.lastChild) && l instanceof be && l.mark.eq(o)) s = l, t--;
        else {
          let a = be.of(o, (i = this.cache.find(be, (h) => h.mark.eq(o))) === null || i === void 0 ? void 0 : i.dom);
          s.append(a), s = a, t = 0;
        }
      }
      return s;
    }
    endLine() {
      if (this.curLine) {
        this.flushBuffer();
        let e = this.curLine.lastChild;
        (!e || !aa(this.curLine, false) || e.dom.nodeName != "BR" && e.isWidget() && !(A.ios && aa(this.curLine, true))) && this.curLine.append(this.cache.findWidget(cr2, 0, 32) || new Rt(cr2.toDOM(), 0, cr2, 32)), this.curLine = this.afterWidget = null;
      }
    }
    updateBlockWrappers() {
      this.wrapperPos > this.pos + 1e4 && (this.blockWrappers.goto(this.pos), this.wrappers.length = 0);
      for (let e = this.wrappers.length - 1; e >= 0; e--) this.wrappers[e].to < this.pos && this.wrappers.splice(e, 1);
      for (let e = this.blockWrappers; e.value && e.from <= this.pos; e.next()) if (e.to >= this.pos) {
        let t = e.rank * 102 + e.value.rank, i = new Dr2(e.from, e.to, e.value, t), s = this.wrappers.length;
        for (; s > 0 && (this.wrappers[s - 1].rank - i.rank || this.wrappers[s - 1].to - i.to) < 0; ) s--;
        this.wrappers.splice(s, 0, i);
      }
      this.wrapperPos = this.pos;
    }
    getBlockPos() {
      var e;
      this.updateBlockWrappers();
      let t = this.root;
      for (let i of this.wrappers) {
        let s = t.lastChild;
        if (i.from < this.pos && s instanceof ht && s.wrapper.eq(i.wrapper)) t = s;
        else {
          let r = ht.of(i.wrapper, (e = this.cache.find(ht, (o) => o.wrapper.eq(i.wrapper))) === null || e === void 0 ? void 0 : e.dom);
          t.append(r), t = r;
        }
      }
      return t;
    }
    blockPosCovered() {
      let e = this.lastBlock;
      return e != null && !e.breakAfter && (!e.isWidget() || (e.flags & 160) > 0);
    }
    getBuffer(e) {
      let t = 2 | (e < 0 ? 16 : 32), i = this.cache.find(ai2, void 0, 1);
      return i && (i.flags = t), i || new ai2(t);
    }
    flushBuffer() {
      this.afterWidget && !(this.afterWidget.flags & 32) && (this.afterWidget.parent.append(this.getBuffer(-1)), this.afterWidget = null);
    }
  };
  var Br2 = class {
    constructor(e) {
      this.skipCount = 0, this.text = "", this.textOff = 0, this.cursor = e.iter();
    }
    skip(e) {
      this.textOff + e <= this.text.length ? this.textOff += e : (this.skipCount += e - (this.text.length - this.textOff), this.text = "", this.textOff = 0);
    }
    next(e) {
      if (this.textOff == this.text.length) {
        let { value: s, lineBreak: r, done: o } = this.cursor.next(this.skipCount);
        if (this.skipCount = 0, o) throw new Error("Ran out of text content when drawing inline views");
        this.text = s;
        let l = this.textOff = Math.min(e, s.length);
        return r ? null : s.slice(0, l);
      }
      let t = Math.min(this.text.length, this.textOff + e), i = this.text.slice(this.textOff, t);
      return this.textOff = t, i;
    }
  };
  var Vn = [Rt, li2, Bt, be, ai2, ht, oi2];
  for (let n66 = 0; n66 < Vn.length; n66++) Vn[n66].bucket = n66;
  var Er2 = class {
    constructor(e) {
      this.view = e, this.buckets = Vn.map(() => []), this.index = Vn.map(() => 0), this.reused = /* @__PURE__ */ new Map();
    }
    add(e) {
      let t = e.constructor.bucket, i = this.buckets[t];
      i.length < 6 ? i.push(e) : i[this.index[t] = (this.index[t] + 1) % 6] = e;
    }
    find(e, t, i = 2) {
      let s = e.bucket, r = this.buckets[s], o = this.index[s];
      for (let l = 0; l < r.length; l++) {
        let a = (l + o) % r.length, h = r[a];
        if ((!t || t(h)) && !this.reused.has(h)) return r.splice(a, 1), a < o && this.index[s]--, this.reused.set(h, i), h;
      }
      return null;
    }
    findWidget(e, t, i) {
      let s = this.buckets[0];
      if (s.length) for (let r = 0, o = 0; ; r++) {
        if (r == s.length) {
          if (o) return null;
          o = 1, r = 0;
        }
        let l = s[r];
        if (!this.reused.has(l) && (o == 0 ? l.widget.compare(e) : l.widget.constructor == e.constructor && e.updateDOM(l.dom, this.view, l.widget))) return s.splice(r, 1), r < this.index[0] && this.index[0]--, l.widget == e && l.length == t && (l.flags & 497) == i ? (this.reused.set(l, 1), l) : (this.reused.set(l, 2), new Rt(l.dom, t, e, l.flags & -498 | i));
      }
    }
    reuse(e) {
      return this.reused.set(e, 1), e;
    }
    maybeReuse(e, t = 2) {
      if (!this.reused.has(e)) return this.reused.set(e, t), e.dom;
    }
    clear() {
      for (let e = 0; e < this.buckets.length; e++) this.buckets[e].length = this.index[e] = 0;
    }
  };
  var Lr2 = class {
    constructor(e, t, i, s, r) {
      this.view = e, this.decorations = s, this.disallowBlockEffectsFor = r, this.openWidget = false, this.openMarks = 0, this.cache = new Er2(e), this.text = new Br2(e.state.doc), this.builder = new Or2(this.cache, new oi2(e, e.contentDOM), z.iter(i)), this.cache.reused.set(t, 2), this.old = new Tr2(t), this.reuseWalker = { skip: (o, l, a) => {
        if (this.cache.add(o), o.isComposite()) return false;
      }, enter: (o) => this.cache.add(o), leave: () => {
      }, break: () => {
      } };
    }
    run(e, t) {
      let i = t && this.getCompositionContext(t.text);
      for (let s = 0, r = 0, o = 0; ; ) {
        let l = o < e.length ? e[o++] : null, a = l ? l.fromA : this.old.root.length;
        if (a > s) {
          let h = a - s;
          this.preserve(h, !o, !l), s = a, r += h;
        }
        if (!l) break;
        t && l.fromA <= t.range.fromA && l.toA >= t.range.toA ? (this.forward(l.fromA, t.range.fromA, t.range.fromA < t.range.toA ? 1 : -1), this.emit(r, t.range.fromB), this.builder.flushBuffer(), this.cache.clear(), this.builder.addComposition(t, i), this.text.skip(t.range.toB - t.range.fromB), this.forward(t.range.fromA, l.toA), this.emit(t.range.toB, l.toB)) : (this.forward(l.fromA, l.toA), this.emit(r, l.toB)), r = l.toB, s = l.toA;
      }
      return this.builder.curLine && this.builder.endLine(), this.builder.root;
    }
    preserve(e, t, i) {
      let s = Jf(this.old), r = this.openMarks;
      this.old.advance(e, i ? 1 : -1, { skip: (o, l, a) => {
        if (o.isWidget()) if (this.openWidget) this.builder.continueWidget(a - l);
        else {
          let h = a > 0 || l < o.length ? Rt.of(o.widget, this.view, a - l, o.flags & 496, this.cache.maybeReuse(o)) : this.cache.reuse(o);
          h.flags & 256 ? (h.flags &= -2, this.builder.addBlockWidget(h)) : (this.builder.ensureLine(null), this.builder.addInlineWidget(h, s, r), r = s.length);
        }
        else if (o.isText()) this.builder.ensureLine(null), !l && a == o.length && !this.cache.reused.has(o) ? this.builder.addText(o.text, s, r, this.cache.reuse(o)) : (this.cache.add(o), this.builder.addText(o.text.slice(l, a), s, r)), r = s.length;
        else if (o.isLine()) o.flags &= -2, this.cache.reused.set(o, 1), this.builder.addLine(o);
        else if (o instanceof ai2) this.cache.add(o);
        else if (o instanceof be) this.builder.ensureLine(null), this.builder.addMark(o, s, r), this.cache.reused.set(o, 1), r = s.length;
        else return false;
        this.openWidget = false;
      }, enter: (o) => {
        o.isLine() ? this.builder.addLineStart(o.attrs, this.cache.maybeReuse(o)) : (this.cache.add(o), o instanceof be && s.unshift(o.mark)), this.openWidget = false;
      }, leave: (o) => {
        o.isLine() ? s.length && (s.length = r = 0) : o instanceof be && (s.shift(), r = Math.min(r, s.length));
      }, break: () => {
        this.builder.addBreak(), this.openWidget = false;
      } }), this.text.skip(e);
    }
    emit(e, t) {
      let i = null, s = this.builder, r = -1, o = z.spans(this.decorations, e, t, { point: (l, a, h, c, f, u) => {
        if (h instanceof Lt) {
          if (this.disallowBlockEffectsFor[u]) {
            if (h.block) throw new RangeError("Block decorations may not be specified via plugins");
            if (a > this.view.state.doc.lineAt(l).to) throw new RangeError("Decorations that replace line breaks may not be specified via plugins");
          }
          if (r = c.length, f > c.length) s.continueWidget(a - l);
          else {
            let d = h.widget || (h.block ? yt.block : yt.inline), p = Yf2(h), m = this.cache.findWidget(d, a - l, p) || Rt.of(d, this.view, a - l, p);
            h.block ? (h.startSide > 0 && s.addLineStartIfNotCovered(i), s.addBlockWidget(m)) : (s.ensureLine(i), s.addInlineWidget(m, c, f));
          }
          i = null;
        } else i = Xf(i, h);
        a > l && this.text.skip(a - l);
      }, span: (l, a, h, c) => {
        for (let f = l; f < a; ) {
          let u = this.text.next(Math.min(512, a - f));
          u == null ? (s.addLineStartIfNotCovered(i), s.addBreak(), f++) : (s.ensureLine(i), s.addText(u, h, f == l ? c : h.length), f += u.length), i = null;
        }
        r = h.length;
      } });
      r > -1 && (this.openWidget = o > r), this.openWidget || s.addLineStartIfNotCovered(i), this.openMarks = o;
    }
    forward(e, t, i = 1) {
      t - e <= 10 ? this.old.advance(t - e, i, this.reuseWalker) : (this.old.advance(5, -1, this.reuseWalker), this.old.advance(t - e - 10, -1), this.old.advance(5, i, this.reuseWalker));
    }
    getCompositionContext(e) {
      let t = [], i = null;
      for (let s = e.parentNode; ; s = s.parentNode) {
        let r = Y.get(s);
        if (s == this.view.contentDOM) break;
        r instanceof be ? t.push(r) : r?.isLine() ? i = r : r instanceof ht || (s.nodeName == "DIV" && !i ? i = new li2(s, uh) : i || t.push(be.of(new Ni({ tagName: s.nodeName.toLowerCase(), attributes: Bf2(s) }), s)));
      }
      return i ? { line: i, marks: t } : null;
    }
  };
  function aa(n66, e) {
    let t = (i) => {
      for (let s of i.children) if ((e ? s.isText() : s.length) || t(s)) return true;
      return false;
    };
    return t(n66);
  }
  function Yf2(n66) {
    let e = n66.isReplace ? (n66.startSide < 0 ? 64 : 0) | (n66.endSide > 0 ? 128 : 0) : n66.startSide > 0 ? 32 : 16;
    return n66.block && (e |= 256), e;
  }
  var uh = { class: "cm-line" };
  function Xf(n66, e) {
    let t = e.spec.attributes, i = e.spec.class;
    return !t && !i || (n66 || (n66 = { class: "cm-line" }), t && mo2(t, n66), i && (n66.class += " " + i)), n66;
  }
  function Jf(n66) {
    let e = [];
    for (let t = n66.parents.length; t > 1; t--) {
      let i = t == n66.parents.length ? n66.tile : n66.parents[t].tile;
      i instanceof be && e.push(i.mark);
    }
    return e;
  }
  function hr2(n66) {
    let e = Y.get(n66);
    return e && e.setDOM(n66.cloneNode()), n66;
  }
  var yt = class extends Re {
    constructor(e) {
      super(), this.tag = e;
    }
    eq(e) {
      return e.tag == this.tag;
    }
    toDOM() {
      return document.createElement(this.tag);
    }
    updateDOM(e) {
      return e.nodeName.toLowerCase() == this.tag;
    }
    get isHidden() {
      return true;
    }
  };
  yt.inline = new yt("span");
  yt.block = new yt("div");
  var cr2 = new class extends Re {
    toDOM() {
      return document.createElement("br");
    }
    get isHidden() {
      return true;
    }
    get editable() {
      return true;
    }
  }();
  var zn = class {
    constructor(e) {
      this.view = e, this.decorations = [], this.blockWrappers = [], this.dynamicDecorationMap = [false], this.domChanged = null, this.hasComposition = null, this.editContextFormatting = L.none, this.lastCompositionAfterCursor = false, this.minWidth = 0, this.minWidthFrom = 0, this.minWidthTo = 0, this.impreciseAnchor = null, this.impreciseHead = null, this.forceSelection = false, this.lastUpdate = Date.now(), this.updateDeco(), this.tile = new oi2(e, e.contentDOM), this.updateInner([new We(0, 0, 0, e.state.doc.length)], null);
    }
    update(e) {
      var t;
      let i = e.changedRanges;
      this.minWidth > 0 && i.length && (i.every(({ fromA: c, toA: f }) => f < this.minWidthFrom || c > this.minWidthTo) ? (this.minWidthFrom = e.changes.mapPos(this.minWidthFrom, 1), this.minWidthTo = e.changes.mapPos(this.minWidthTo, 1)) : this.minWidth = this.minWidthFrom = this.minWidthTo = 0), this.updateEditContextFormatting(e);
      let s = -1;
      this.view.inputState.composing >= 0 && !this.view.observer.editContext && (!((t = this.domChanged) === null || t === void 0) && t.newSel ? s = this.domChanged.newSel.head : !ru(e.changes, this.hasComposition) && !e.selectionSet && (s = e.state.selection.main.head));
      let r = s > -1 ? Zf(this.view, e.changes, s) : null;
      if (this.domChanged = null, this.hasComposition) {
        let { from: c, to: f } = this.hasComposition;
        i = new We(c, f, e.changes.mapPos(c, -1), e.changes.mapPos(f, 1)).addToSet(i.slice());
      }
      this.hasComposition = r ? { from: r.range.fromB, to: r.range.toB } : null, (A.ie || A.chrome) && !r && e && e.state.doc.lines != e.startState.doc.lines && (this.forceSelection = true);
      let o = this.decorations, l = this.blockWrappers;
      this.updateDeco();
      let a = iu(o, this.decorations, e.changes);
      a.length && (i = We.extendWithRanges(i, a));
      let h = nu(l, this.blockWrappers, e.changes);
      return h.length && (i = We.extendWithRanges(i, h)), r && !i.some((c) => c.fromA <= r.range.fromA && c.toA >= r.range.toA) && (i = r.range.addToSet(i.slice())), this.tile.flags & 2 && i.length == 0 ? false : (this.updateInner(i, r), e.transactions.length && (this.lastUpdate = Date.now()), true);
    }
    updateInner(e, t) {
      this.view.viewState.mustMeasureContent = true;
      let { observer: i } = this.view;
      i.ignore(() => {
        if (t || e.length) {
          let o = this.tile, l = new Lr2(this.view, o, this.blockWrappers, this.decorations, this.dynamicDecorationMap);
          t && Y.get(t.text) && l.cache.reused.set(Y.get(t.text), 2), this.tile = l.run(e, t), Rr2(o, l.cache.reused);
        }
        this.tile.dom.style.height = this.view.viewState.contentHeight / this.view.scaleY + "px", this.tile.dom.style.flexBasis = this.minWidth ? this.minWidth + "px" : "";
        let r = A.chrome || A.ios ? { node: i.selectionRange.focusNode, written: false } : void 0;
        this.tile.sync(r), r && (r.written || i.selectionRange.focusNode != r.node || !this.tile.dom.contains(r.node)) && (this.forceSelection = true), this.tile.dom.style.height = "";
      });
      let s = [];
      if (this.view.viewport.from || this.view.viewport.to < this.view.state.doc.length) for (let r of this.tile.children) r.isWidget() && r.widget instanceof Li && s.push(r.dom);
      i.updateGaps(s);
    }
    updateEditContextFormatting(e) {
      this.editContextFormatting = this.editContextFormatting.map(e.changes);
      for (let t of e.transactions) for (let i of t.effects) i.is(oh) && (this.editContextFormatting = i.value);
    }
    updateSelection(e = false, t = false) {
      (e || !this.view.observer.selectionRange.focusNode) && this.view.observer.readSelectionRange();
      let { dom: i } = this.tile, s = this.view.root.activeElement, r = s == i, o = !r && !(this.view.state.facet(at) || i.tabIndex > -1) && Di(i, this.view.observer.selectionRange) && !(s && i.contains(s));
      if (!(r || t || o)) return;
      let l = this.forceSelection;
      this.forceSelection = false;
      let a = this.view.state.selection.main, h, c;
      if (a.empty ? c = h = this.inlineDOMNearPos(a.anchor, a.assoc || 1) : (c = this.inlineDOMNearPos(a.head, a.head == a.from ? 1 : -1), h = this.inlineDOMNearPos(a.anchor, a.anchor == a.from ? 1 : -1)), A.gecko && a.empty && !this.hasComposition && Qf(h)) {
        let u = document.createTextNode("");
        this.view.observer.ignore(() => h.node.insertBefore(u, h.node.childNodes[h.offset] || null)), h = c = new Ze(u, 0), l = true;
      }
      let f = this.view.observer.selectionRange;
      (l || !f.focusNode || (!Oi(h.node, h.offset, f.anchorNode, f.anchorOffset) || !Oi(c.node, c.offset, f.focusNode, f.focusOffset)) && !this.suppressWidgetCursorChange(f, a)) && (this.view.observer.ignore(() => {
        A.android && A.chrome && i.contains(f.focusNode) && su(f.focusNode, i) && (i.blur(), i.focus({ preventScroll: true }));
        let u = Hi(this.view.root);
        if (u) if (a.empty) {
          if (A.gecko) {
            let d = eu(h.node, h.offset);
            if (d && d != 3) {
              let p = (d == 1 ? $a : ja)(h.node, h.offset);
              p && (h = new Ze(p.node, p.offset));
            }
          }
          u.collapse(h.node, h.offset), a.bidiLevel != null && u.caretBidiLevel !== void 0 && (u.caretBidiLevel = a.bidiLevel);
        } else if (u.extend) {
          u.collapse(h.node, h.offset);
          try {
            u.extend(c.node, c.offset);
          } catch {
          }
        } else {
          let d = document.createRange();
          a.anchor > a.head && ([h, c] = [c, h]), d.setEnd(c.node, c.offset), d.setStart(h.node, h.offset), u.removeAllRanges(), u.addRange(d);
        }
        o && this.view.root.activeElement == i && (i.blur(), s && s.focus());
      }), this.view.observer.setSelectionRange(h, c)), this.impreciseAnchor = h.precise ? null : new Ze(f.anchorNode, f.anchorOffset), this.impreciseHead = c.precise ? null : new Ze(f.focusNode, f.focusOffset);
    }
    suppressWidgetCursorChange(e, t) {
      return this.hasComposition && t.empty && Oi(e.focusNode, e.focusOffset, e.anchorNode, e.anchorOffset) && this.posFromDOM(e.focusNode, e.focusOffset) == t.head;
    }
    enforceCursorAssoc() {
      if (this.hasComposition) return;
      let { view: e } = this, t = e.state.selection.main, i = Hi(e.root), { anchorNode: s, anchorOffset: r } = e.observer.selectionRange;
      if (!i || !t.empty || !t.assoc || !i.modify) return;
      let o = this.lineAt(t.head, t.assoc);
      if (!o) return;
      let l = o.posAtStart;
      if (t.head == l || t.head == l + o.length) return;
      let a = this.coordsAt(t.head, -1), h = this.coordsAt(t.head, 1);
      if (!a || !h || a.bottom > h.top) return;
      let c = this.domAtPos(t.head + t.assoc, t.assoc);
      i.collapse(c.node, c.offset), i.modify("move", t.assoc < 0 ? "forward" : "backward", "lineboundary"), e.observer.readSelectionRange();
      let f = e.observer.selectionRange;
      e.docView.posFromDOM(f.anchorNode, f.anchorOffset) != t.from && i.collapse(s, r);
    }
    posFromDOM(e, t) {
      let i = this.tile.nearest(e);
      if (!i) return this.tile.dom.compareDocumentPosition(e) & 2 ? 0 : this.view.state.doc.length;
      let s = i.posAtStart;
      if (i.isComposite()) {
        let r;
        if (e == i.dom) r = i.dom.childNodes[t];
        else {
          let o = ct(e) == 0 ? 0 : t == 0 ? -1 : 1;
          for (; ; ) {
            let l = e.parentNode;
            if (l == i.dom) break;
            o == 0 && l.firstChild != l.lastChild && (e == l.firstChild ? o = -1 : o = 1), e = l;
          }
          o < 0 ? r = e : r = e.nextSibling;
        }
        if (r == i.dom.firstChild) return s;
        for (; r && !Y.get(r); ) r = r.nextSibling;
        if (!r) return s + i.length;
        for (let o = 0, l = s; ; o++) {
          let a = i.children[o];
          if (a.dom == r) return l;
          l += a.length + a.breakAfter;
        }
      } else return i.isText() ? e == i.dom ? s + t : s + (t ? i.length : 0) : s;
    }
    domAtPos(e, t) {
      let { tile: i, offset: s } = this.tile.resolveBlock(e, t);
      return i.isWidget() ? i.domPosFor(s, t) : i.domIn(s, t);
    }
    inlineDOMNearPos(e, t) {
      let i, s = -1, r = false, o, l = -1, a = false;
      return this.tile.blockTiles((h, c) => {
        if (h.isWidget()) {
          if (h.flags & 32 && c >= e) return true;
          h.flags & 16 && (r = true);
        } else {
          let f = c + h.length;
          if (c <= e && (i = h, s = e - c, r = f < e), f >= e && !o && (o = h, l = e - c, a = c > e), c > e && o) return true;
        }
      }), !i && !o ? this.domAtPos(e, t) : (r && o ? i = null : a && i && (o = null), i && t < 0 || !o ? i.domIn(s, t) : o.domIn(l, t));
    }
    coordsAt(e, t, i) {
      let { tile: s, offset: r } = this.tile.resolveBlock(e, t);
      return s.isWidget() ? s.widget instanceof Li ? null : s.coordsInWidget(r, t, true) : s.coordsIn(r, t, i);
    }
    lineAt(e, t) {
      let { tile: i } = this.tile.resolveBlock(e, t);
      return i.isLine() ? i : null;
    }
    coordsForChar(e) {
      let { tile: t, offset: i } = this.tile.resolveBlock(e, 1);
      if (!t.isLine()) return null;
      function s(r, o) {
        if (r.isComposite()) for (let l of r.children) {
          if (l.length >= o) {
            let a = s(l, o);
            if (a) return a;
          }
          if (o -= l.length, o < 0) break;
        }
        else if (r.isText() && o < r.length) {
          let l = Z(r.text, o);
          if (l == o) return null;
          let a = Wi(r.dom, o, l).getClientRects();
          for (let h = 0; h < a.length; h++) {
            let c = a[h];
            if (h == a.length - 1 || c.top < c.bottom && c.left < c.right) return c;
          }
        }
        return null;
      }
      return s(t, i);
    }
    measureVisibleLineHeights(e) {
      let t = [], { from: i, to: s } = e, r = this.view.contentDOM.clientWidth, o = r > Math.max(this.view.scrollDOM.clientWidth, this.minWidth) + 1, l = -1, a = this.view.textDirection == V.LTR, h = 0, c = (f, u, d) => {
        for (let p = 0; p < f.children.length && !(u > s); p++) {
          let m = f.children[p], g = u + m.length, y = m.dom.getBoundingClientRect(), { height: v } = y;
          if (d && !p && (h += y.top - d.top), m instanceof ht) g > i && c(m, u, y);
          else if (u >= i && (h > 0 && t.push(-h), t.push(v + h), h = 0, o)) {
            let b = m.dom.lastChild, D = b ? On(b) : [];
            if (D.length) {
              let w = D[D.length - 1], k = a ? w.right - y.left : y.right - w.left;
              k > l && (l = k, this.minWidth = r, this.minWidthFrom = u, this.minWidthTo = g);
            }
          }
          d && p == f.children.length - 1 && (h += d.bottom - y.bottom), u = g + m.breakAfter;
        }
      };
      return c(this.tile, 0, null), t;
    }
    textDirectionAt(e) {
      let { tile: t } = this.tile.resolveBlock(e, 1);
      return getComputedStyle(t.dom).direction == "rtl" ? V.RTL : V.LTR;
    }
    measureTextSize() {
      let e = this.tile.blockTiles((o) => {
        if (o.isLine() && o.children.length && o.length <= 20) {
          let l = 0, a;
          for (let h of o.children) {
            if (!h.isText() || /[^ -~]/.test(h.text)) return;
            let c = On(h.dom);
            if (c.length != 1) return;
            l += c[0].width, a = c[0].height;
          }
          if (l) return { lineHeight: o.dom.getBoundingClientRect().height, charWidth: l / o.length, textHeight: a };
        }
      });
      if (e) return e;
      let t = document.createElement("div"), i, s, r;
      return t.className = "cm-line", t.style.width = "99999px", t.style.position = "absolute", t.textContent = "abc def ghi jkl mno pqr stu", this.view.observer.ignore(() => {
        this.tile.dom.appendChild(t);
        let o = On(t.firstChild)[0];
        i = t.getBoundingClientRect().height, s = o && o.width ? o.width / 27 : 7, r = o && o.height ? o.height : i, t.remove();
      }), { lineHeight: i, charWidth: s, textHeight: r };
    }
    computeBlockGapDeco() {
      let e = [], t = this.view.viewState;
      for (let i = 0, s = 0; ; s++) {
        let r = s == t.viewports.length ? null : t.viewports[s], o = r ? r.from - 1 : this.view.state.doc.length;
        if (o > i) {
          let l = (t.lineBlockAt(o).bottom - t.lineBlockAt(i).top) / this.view.scaleY;
          e.push(L.replace({ widget: new Li(l), block: true, inclusive: true, isBlockGap: true }).range(i, o));
        }
        if (!r) break;
        i = r.to + 1;
      }
      return L.set(e);
    }
    updateDeco() {
      let e = 1, t = this.view.state.facet(Zn2).map((r) => (this.dynamicDecorationMap[e++] = typeof r == "function") ? r(this.view) : r), i = false, s = this.view.state.facet(vo2).map((r, o) => {
        let l = typeof r == "function";
        return l && (i = true), l ? r(this.view) : r;
      });
      for (s.length && (this.dynamicDecorationMap[e++] = i, t.push(z.join(s))), this.decorations = [this.editContextFormatting, ...t, this.computeBlockGapDeco(), this.view.viewState.lineGapDeco]; e < this.decorations.length; ) this.dynamicDecorationMap[e++] = false;
      this.blockWrappers = this.view.state.facet(ah).map((r) => typeof r == "function" ? r(this.view) : r);
    }
    scrollIntoView(e) {
      if (e.isSnapshot) {
        let h = this.view.viewState.lineBlockAt(e.range.head);
        this.view.scrollDOM.scrollTop = h.top - e.yMargin, this.view.scrollDOM.scrollLeft = e.xMargin;
        return;
      }
      for (let h of this.view.state.facet(rh)) try {
        if (h(this.view, e.range, e)) return true;
      } catch (c) {
        le(this.view.state, c, "scroll handler");
      }
      let { range: t } = e, i = this.coordsAt(t.head, t.assoc || (t.head > t.anchor ? -1 : 1)), s;
      if (!i) return;
      !t.empty && (s = this.coordsAt(t.anchor, t.anchor > t.head ? -1 : 1)) && (i = { left: Math.min(i.left, s.left), top: Math.min(i.top, s.top), right: Math.max(i.right, s.right), bottom: Math.max(i.bottom, s.bottom) });
      let r = ko2(this.view), o = { left: i.left - r.left, top: i.top - r.top, right: i.right + r.right, bottom: i.bottom + r.bottom }, { offsetWidth: l, offsetHeight: a } = this.view.scrollDOM;
      if (Rf2(this.view.scrollDOM, o, t.head < t.anchor ? -1 : 1, e.x, e.y, Math.max(Math.min(e.xMargin, l), -l), Math.max(Math.min(e.yMargin, a), -a), this.view.textDirection == V.LTR), window.visualViewport && window.innerHeight - window.visualViewport.height > 1 && (i.top > window.visualViewport.offsetTop + window.visualViewport.height || i.bottom < window.visualViewport.offsetTop)) {
        let h = this.view.docView.lineAt(t.head, 1);
        if (h) {
          let c = Va(h.dom);
          h.dom.scrollIntoView({ block: "nearest" }), za(c, false);
        }
      }
    }
    lineHasWidget(e) {
      let t = (i) => i.isWidget() || i.children.some(t);
      return t(this.tile.resolveBlock(e, 1).tile);
    }
    destroy() {
      Rr2(this.tile);
    }
  };
  function Rr2(n66, e) {
    let t = e?.get(n66);
    if (t != 1) {
      t == null && n66.destroy();
      for (let i of n66.children) Rr2(i, e);
    }
  }
  function Qf(n66) {
    return ne2(n66.node) && n66.node.firstChild && (n66.offset == 0 || n66.node.childNodes[n66.offset - 1].contentEditable == "false") && (n66.offset == n66.node.childNodes.length || n66.node.childNodes[n66.offset].contentEditable == "false");
  }
  function dh(n66, e) {
    let t = n66.observer.selectionRange;
    if (!t.focusNode) return null;
    let i = $a(t.focusNode, t.focusOffset), s = ja(t.focusNode, t.focusOffset), r = i || s;
    if (s && i && s.node != i.node) {
      let l = Y.get(s.node);
      if (!l || l.isText() && l.text != s.node.nodeValue) r = s;
      else if (n66.docView.lastCompositionAfterCursor) {
        let a = Y.get(i.node);
        !a || a.isText() && a.text != i.node.nodeValue || (r = s);
      }
    }
    if (n66.docView.lastCompositionAfterCursor = r != i, !r) return null;
    let o = e - r.offset;
    return { from: o, to: o + r.node.nodeValue.length, node: r.node };
  }
  function Zf(n66, e, t) {
    let i = dh(n66, t);
    if (!i) return null;
    let { node: s, from: r, to: o } = i, l = s.nodeValue;
    if (/[\n\r]/.test(l) || n66.state.doc.sliceString(i.from, i.to) != l) return null;
    let a = e.invertedDesc;
    return { range: new We(a.mapPos(r), a.mapPos(o), r, o), text: s };
  }
  function eu(n66, e) {
    return ne2(n66) ? (e && n66.childNodes[e - 1].contentEditable == "false" ? 1 : 0) | (e < n66.childNodes.length && n66.childNodes[e].contentEditable == "false" ? 2 : 0) : 0;
  }
  var tu = class {
    constructor() {
      this.changes = [];
    }
    compareRange(e, t) {
      ti2(e, t, this.changes);
    }
    comparePoint(e, t) {
      ti2(e, t, this.changes);
    }
    boundChange(e) {
      ti2(e, e, this.changes);
    }
  };
  function iu(n66, e, t) {
    let i = new tu();
    return z.compare(n66, e, t, i), i.changes;
  }
  var Pr2 = class {
    constructor() {
      this.changes = [];
    }
    compareRange(e, t) {
      ti2(e, t, this.changes);
    }
    comparePoint() {
    }
    boundChange(e) {
      ti2(e, e, this.changes);
    }
  };
  function nu(n66, e, t) {
    let i = new Pr2();
    return z.compare(n66, e, t, i), i.changes;
  }
  function su(n66, e) {
    for (let t = n66; t && t != e; t = t.assignedSlot || t.parentNode) if (ne2(t) && t.contentEditable == "false") return true;
    return false;
  }
  function ru(n66, e) {
    let t = false;
    return e && n66.iterChangedRanges((i, s) => {
      i < e.to && s > e.from && (t = true);
    }), t;
  }
  var Li = class extends Re {
    constructor(e) {
      super(), this.height = e;
    }
    toDOM() {
      let e = document.createElement("div");
      return e.className = "cm-gap", this.updateDOM(e), e;
    }
    eq(e) {
      return e.height == this.height;
    }
    updateDOM(e) {
      return e.style.height = this.height + "px", true;
    }
    get editable() {
      return true;
    }
    get estimatedHeight() {
      return this.height;
    }
    ignoreEvent() {
      return false;
    }
  };
  function ou(n66, e, t = 1) {
    let i = n66.charCategorizer(e), s = n66.doc.lineAt(e), r = e - s.from;
    if (s.length == 0) return x.cursor(e);
    r == 0 ? t = 1 : r == s.length && (t = -1);
    let o = r, l = r;
    t < 0 ? o = Z(s.text, r, false) : l = Z(s.text, r);
    let a = i(s.text.slice(o, l));
    for (; o > 0; ) {
      let h = Z(s.text, o, false);
      if (i(s.text.slice(h, o)) != a) break;
      o = h;
    }
    for (; l < s.length; ) {
      let h = Z(s.text, l);
      if (i(s.text.slice(l, h)) != a) break;
      l = h;
    }
    return x.undirectionalRange(o + s.from, l + s.from);
  }
  function lu(n66, e, t, i, s) {
    let r = Math.round((i - e.left) * n66.defaultCharacterWidth);
    if (n66.lineWrapping && t.height > n66.defaultLineHeight * 1.5) {
      let l = n66.viewState.heightOracle.textHeight, a = Math.floor((s - t.top - (n66.defaultLineHeight - l) * 0.5) / l);
      r += a * n66.viewState.heightOracle.lineLength;
    }
    let o = n66.state.sliceDoc(t.from, t.to);
    return t.from + _l(o, r, n66.state.tabSize);
  }
  function Ir2(n66, e, t) {
    let i = n66.lineBlockAt(e);
    if (Array.isArray(i.type)) {
      let s;
      for (let r of i.type) {
        if (r.from > e) break;
        if (!(r.to < e)) {
          if (r.from < e && r.to > e) return r;
          (!s || r.type == ae2.Text && (s.type != r.type || (t < 0 ? r.from < e : r.to > e))) && (s = r);
        }
      }
      return s || i;
    }
    return i;
  }
  function au(n66, e, t, i) {
    let s = Ir2(n66, e.head, e.assoc || -1), r = !i || s.type != ae2.Text || !(n66.lineWrapping || s.widgetLineBreaks) ? null : n66.coordsAtPos(e.assoc < 0 && e.head > s.from ? e.head - 1 : e.head);
    if (r) {
      let o = n66.dom.getBoundingClientRect(), l = n66.textDirectionAt(s.from), a = n66.posAndSideAtCoords({ x: t == (l == V.LTR) ? o.right - 1 : o.left + 1, y: (r.top + r.bottom) / 2 });
      if (a) return x.cursor(a.pos, a.assoc);
    }
    return x.cursor(t ? s.to : s.from, t ? 1 : -1);
  }
  function ha(n66, e, t, i) {
    let s = n66.state.doc.lineAt(e.head), r = n66.bidiSpans(s), o = n66.textDirectionAt(s.from);
    for (let l = e, a = null; ; ) {
      let h = Kf(s, r, o, l, t), c = Xa;
      if (!h) {
        if (s.number == (t ? n66.state.doc.lines : 1)) return l;
        c = `
`, s = n66.state.doc.line(s.number + (t ? 1 : -1)), r = n66.bidiSpans(s), h = t ? x.cursor(s.from, -1) : x.cursor(s.to, 1);
      }
      if (a) {
        if (!a(c)) return l;
      } else {
        if (!i) return h;
        a = i(c);
      }
      l = h;
    }
  }
  function hu(n66, e, t) {
    let i = n66.state.charCategorizer(e), s = i(t);
    return (r) => {
      let o = i(r);
      return s == G.Space && (s = o), s == o;
    };
  }
  function cu(n66, e, t, i) {
    let s = e.head, r = t ? 1 : -1;
    if (s == (t ? n66.state.doc.length : 0)) return x.cursor(s, e.assoc);
    let o = e.goalColumn, l, a = n66.contentDOM.getBoundingClientRect(), h = n66.coordsAtPos(s, e.assoc || ((e.empty ? t : e.head == e.from) ? 1 : -1)), c = n66.documentTop;
    if (h) o == null && (o = h.left - a.left), l = r < 0 ? h.top : h.bottom;
    else {
      let p = n66.viewState.lineBlockAt(s);
      o == null && (o = Math.min(a.right - a.left, n66.defaultCharacterWidth * (s - p.from))), l = (r < 0 ? p.top : p.bottom) + c;
    }
    let f = a.left + o, u = n66.viewState.heightOracle.textHeight >> 1, d = i ?? u;
    for (let p = 0; ; p += u) {
      let m = l + (d + p) * r, g = Nr2(n66, { x: f, y: m }, false, r);
      if (t ? m > a.bottom : m < a.top) return x.cursor(g.pos, g.assoc);
      let y = n66.coordsAtPos(g.pos, g.assoc), v = y ? (y.top + y.bottom) / 2 : 0;
      if (!y || (t ? v > l : v < l)) return x.cursor(g.pos, g.assoc, void 0, o);
    }
  }
  function Ri(n66, e, t) {
    for (; ; ) {
      let i = 0;
      for (let s of n66) s.between(e - 1, e + 1, (r, o, l) => {
        if (e > r && e < o) {
          let a = i || t || (e - r < o - e ? -1 : 1);
          e = a < 0 ? r : o, i = a;
        }
      });
      if (!i) return e;
    }
  }
  function ph(n66, e) {
    let t = null;
    for (let i = 0; i < e.ranges.length; i++) {
      let s = e.ranges[i], r = null;
      if (s.empty) {
        let o = Ri(n66, s.from, 0);
        o != s.from && (r = x.cursor(o, -1));
      } else {
        let o = Ri(n66, s.from, -1), l = Ri(n66, s.to, 1);
        (o != s.from || l != s.to) && (s.undirectional ? r = x.undirectionalRange(s.from, s.to) : r = x.range(s.from == s.anchor ? o : l, s.from == s.head ? o : l));
      }
      r && (t || (t = e.ranges.slice()), t[i] = r);
    }
    return t ? x.create(t, e.mainIndex) : e;
  }
  function fr2(n66, e, t) {
    let i = Ri(n66.state.facet(Vi).map((s) => s(n66)), t.from, e.head > t.from ? -1 : 1);
    return i == t.from ? t : x.cursor(i, i < t.from ? 1 : -1);
  }
  var Ee2 = class {
    constructor(e, t) {
      this.pos = e, this.assoc = t;
    }
  };
  function Nr2(n66, e, t, i) {
    let s = n66.contentDOM.getBoundingClientRect(), r = s.top + n66.viewState.paddingTop, { x: o, y: l } = e, a = l - r, h;
    for (; ; ) {
      if (a < 0) return new Ee2(0, 1);
      if (a > n66.viewState.docHeight) return new Ee2(n66.state.doc.length, -1);
      if (h = n66.elementAtHeight(a), i == null) break;
      if (h.type == ae2.Text) {
        if (i < 0 ? h.to < n66.viewport.from : h.from > n66.viewport.to) break;
        let u = n66.docView.coordsAt(i < 0 ? h.from : h.to, i > 0 ? -1 : 1);
        if (u && (i < 0 ? u.top <= a + r : u.bottom >= a + r)) break;
      }
      let f = n66.viewState.heightOracle.textHeight / 2;
      a = i > 0 ? h.bottom + f : h.top - f;
    }
    if (n66.viewport.from >= h.to || n66.viewport.to <= h.from) {
      if (t) return null;
      if (h.type == ae2.Text) {
        let f = lu(n66, s, h, o, l);
        return new Ee2(f, f == h.from ? 1 : -1);
      }
    }
    if (h.type != ae2.Text) return a < (h.top + h.bottom) / 2 ? new Ee2(h.from, 1) : new Ee2(h.to, -1);
    let c = n66.docView.lineAt(h.from, 2);
    return (!c || c.length != h.length) && (c = n66.docView.lineAt(h.from, -2)), new Fr2(n66, o, l, n66.textDirectionAt(h.from)).scanTile(c, h.from);
  }
  var Fr2 = class {
    constructor(e, t, i, s) {
      this.view = e, this.x = t, this.y = i, this.baseDir = s, this.line = null, this.spans = null;
    }
    bidiSpansAt(e) {
      return (!this.line || this.line.from > e || this.line.to < e) && (this.line = this.view.state.doc.lineAt(e), this.spans = this.view.bidiSpans(this.line)), this;
    }
    baseDirAt(e, t) {
      let { line: i, spans: s } = this.bidiSpansAt(e);
      return s[Le.find(s, e - i.from, -1, t)].level == this.baseDir;
    }
    dirAt(e, t) {
      let { line: i, spans: s } = this.bidiSpansAt(e);
      return s[Le.find(s, e - i.from, -1, t)].dir;
    }
    bidiIn(e, t) {
      let { spans: i, line: s } = this.bidiSpansAt(e);
      return i.length > 1 || i.length && (i[0].level != this.baseDir || i[0].to + s.from < t);
    }
    scan(e, t, i = false) {
      let s = 0, r = e.length - 1, o = /* @__PURE__ */ new Set(), l = this.bidiIn(e[0], e[r]), a, h, c = -1, f = 1e9, u;
      e: for (; s < r; ) {
        let p = r - s, m = s + r >> 1;
        t: if (o.has(m)) {
          for (let v = 1; v < p; v++) {
            let b = m + v;
            if (b >= r && (b -= p), !o.has(b)) {
              m = b;
              break t;
            }
          }
          break e;
        }
        o.add(m);
        let g = t(m), y = 0;
        if (g) for (let v = 0; v < g.length; v++) {
          let b = g[v];
          if (!(b.width == 0 && g.length > 1)) if (b.bottom < this.y) (!a || a.bottom < b.bottom) && (a = b), y = 1;
          else if (b.top > this.y) (!h || h.top > b.top) && (h = b), y = -1;
          else {
            let D = b.left > this.x ? this.x - b.left : b.right < this.x ? this.x - b.right : 0, w = Math.abs(D);
            w < f && (c = m, f = w, u = b), D && (y = D < 0 == (this.baseDir == V.LTR) ? -1 : 1);
          }
        }
        y == -1 && (!l || this.baseDirAt(e[m], 1)) ? r = m : y == 1 && (!l || this.baseDirAt(e[m + 1], -1)) && (s = m + 1);
      }
      if (!u) {
        if (!h && !a) return { i: 0, after: false };
        let p = a && (!h || this.y - a.bottom < h.top - this.y) ? a : h;
        return this.y = (p.top + p.bottom) / 2, this.scan(e, t, true);
      }
      if (f && !i) {
        let { top: p, bottom: m } = u;
        if (a && a.bottom > (p + p + m) / 3) return this.y = a.bottom - 1, this.scan(e, t, true);
        if (h && h.top < (p + m + m) / 3) return this.y = h.top + 1, this.scan(e, t, true);
      }
      let d = (l ? this.dirAt(e[c], 1) : this.baseDir) == V.LTR;
      return { i: c, after: this.x > (u.left + u.right) / 2 == d };
    }
    scanText(e, t) {
      let i = [];
      for (let r = 0; r < e.length; r = Z(e.text, r)) i.push(t + r);
      i.push(t + e.length);
      let s = this.scan(i, (r) => {
        let o = i[r] - t, l = i[r + 1] - t;
        return Wi(e.dom, o, l).getClientRects();
      });
      return s.after ? new Ee2(i[s.i + 1], -1) : new Ee2(i[s.i], 1);
    }
    scanTile(e, t) {
      if (!e.length) return new Ee2(t, 1);
      if (e.children.length == 1) {
        let l = e.children[0];
        if (l.isText()) return this.scanText(l, t);
        if (l.isComposite()) return this.scanTile(l, t);
      }
      let i = [t];
      for (let l = 0, a = t; l < e.children.length; l++) i.push(a += e.children[l].length);
      let s = this.scan(i, (l) => {
        let a = e.children[l];
        return a.flags & 48 ? null : (ne2(a.dom) ? a.dom : Wi(a.dom, 0, a.length)).getClientRects();
      }), r = e.children[s.i], o = i[s.i];
      return r.isText() ? this.scanText(r, o) : r.isComposite() ? this.scanTile(r, o) : s.after ? new Ee2(i[s.i + 1], -1) : new Ee2(o, 1);
    }
  };
  var Xt2 = "\uFFFF";
  var Hr2 = class {
    constructor(e, t) {
      this.points = e, this.view = t, this.text = "", this.lineSeparator = t.state.facet(_.lineSeparator);
    }
    append(e) {
      this.text += e;
    }
    lineBreak() {
      this.text += Xt2;
    }
    readRange(e, t) {
      if (!e) return this;
      let i = e.parentNode;
      for (let s = e; ; ) {
        this.findPointBefore(i, s);
        let r = this.text.length;
        this.readNode(s);
        let o = Y.get(s), l = s.nextSibling;
        if (l == t) {
          o?.breakAfter && !l && i != this.view.contentDOM && this.lineBreak();
          break;
        }
        let a = Y.get(l);
        (o && a ? o.breakAfter : (o ? o.breakAfter : Fn(s)) || Fn(l) && (s.nodeName != "BR" || o?.isWidget()) && this.text.length > r) && !uu(l, t) && this.lineBreak(), s = l;
      }
      return this.findPointBefore(i, t), this;
    }
    readTextNode(e) {
      let t = e.nodeValue;
      for (let i of this.points) i.node == e && (i.pos = this.text.length + Math.min(i.offset, t.length));
      for (let i = 0, s = this.lineSeparator ? null : /\r\n?|\n/g; ; ) {
        let r = -1, o = 1, l;
        if (this.lineSeparator ? (r = t.indexOf(this.lineSeparator, i), o = this.lineSeparator.length) : (l = s.exec(t)) && (r = l.index, o = l[0].length), this.append(t.slice(i, r < 0 ? t.length : r)), r < 0) break;
        if (this.lineBreak(), o > 1) for (let a of this.points) a.node == e && a.pos > this.text.length && (a.pos -= o - 1);
        i = r + o;
      }
    }
    readNode(e) {
      let t = Y.get(e), i = t && t.overrideDOMText;
      if (i != null) {
        this.findPointInside(e, i.length);
        for (let s = i.iter(); !s.next().done; ) s.lineBreak ? this.lineBreak() : this.append(s.value);
      } else ni2(e) ? this.readTextNode(e) : e.nodeName == "BR" ? e.nextSibling && this.lineBreak() : ne2(e) && this.readRange(e.firstChild, null);
    }
    findPointBefore(e, t) {
      for (let i of this.points) i.node == e && e.childNodes[i.offset] == t && (i.pos = this.text.length);
    }
    findPointInside(e, t) {
      for (let i of this.points) (ni2(e) ? i.node == e : e.contains(i.node)) && (i.pos = this.text.length + (fu(e, i.node, i.offset) ? t : 0));
    }
  };
  function fu(n66, e, t) {
    for (; ; ) {
      if (!e || t < ct(e)) return false;
      if (e == n66) return true;
      t = gt2(e) + 1, e = e.parentNode;
    }
  }
  function uu(n66, e) {
    let t;
    for (; !(n66 == e || !n66); n66 = n66.nextSibling) {
      let i = Y.get(n66);
      if (!i?.isWidget()) return false;
      i && (t || (t = [])).push(i);
    }
    if (t) for (let i of t) {
      let s = i.overrideDOMText;
      if (s?.length) return false;
    }
    return true;
  }
  var qn2 = class {
    constructor(e, t) {
      this.node = e, this.offset = t, this.pos = -1;
    }
  };
  var Wr2 = class {
    constructor(e, t, i, s) {
      this.typeOver = s, this.bounds = null, this.text = "", this.domChanged = t > -1;
      let { impreciseHead: r, impreciseAnchor: o } = e.docView, l = e.state.selection;
      if (e.state.readOnly && t > -1) this.newSel = null;
      else if (t > -1 && (this.bounds = mh(e.docView.tile, t, i, 0))) {
        let a = r || o ? [] : pu(e), h = new Hr2(a, e);
        h.readRange(this.bounds.startDOM, this.bounds.endDOM), this.text = h.text, this.newSel = mu(a, this.bounds.from);
      } else {
        let a = e.observer.selectionRange, h = r && r.node == a.focusNode && r.offset == a.focusOffset || !vr2(e.contentDOM, a.focusNode) ? l.main.head : e.docView.posFromDOM(a.focusNode, a.focusOffset), c = o && o.node == a.anchorNode && o.offset == a.anchorOffset || !vr2(e.contentDOM, a.anchorNode) ? l.main.anchor : e.docView.posFromDOM(a.anchorNode, a.anchorOffset), f = e.viewport;
        if ((A.ios || A.chrome) && h != c && Math.min(h, c) <= l.main.from && Math.max(h, c) >= l.main.to && (f.from > 0 || f.to < e.state.doc.length)) {
          let u = Math.min(h, c), d = Math.max(h, c), p = f.from - u, m = f.to - d;
          (p == 0 || p == 1 || u == 0) && (m == 0 || m == -1 || d == e.state.doc.length) && (h = 0, c = e.state.doc.length);
        }
        if (e.inputState.composing > -1 && l.ranges.length > 1) this.newSel = l.replaceRange(x.range(c, h));
        else if (e.lineWrapping && c == h && !(l.main.empty && l.main.head == h) && e.inputState.lastTouchTime > Date.now() - 100) {
          let u = e.coordsAtPos(h, -1), d = 0;
          u && (d = e.inputState.lastTouchY <= u.bottom ? -1 : 1), this.newSel = x.create([x.cursor(h, d)]);
        } else this.newSel = x.single(c, h);
      }
    }
  };
  function mh(n66, e, t, i) {
    if (n66.isComposite()) {
      let s = -1, r = -1, o = -1, l = -1;
      for (let a = 0, h = i, c = i; a < n66.children.length; a++) {
        let f = n66.children[a], u = h + f.length;
        if (h < e && u > t) return mh(f, e, t, h);
        if (u >= e && s == -1 && (s = a, r = h), h > t && f.dom.parentNode == n66.dom) {
          o = a, l = c;
          break;
        }
        c = u, h = u + f.breakAfter;
      }
      return { from: r, to: l < 0 ? i + n66.length : l, startDOM: (s ? n66.children[s - 1].dom.nextSibling : null) || n66.dom.firstChild, endDOM: o < n66.children.length && o >= 0 ? n66.children[o].dom : null };
    } else return n66.isText() ? { from: i, to: i + n66.length, startDOM: n66.dom, endDOM: n66.dom.nextSibling } : null;
  }
  function gh(n66, e) {
    let t, { newSel: i } = e, { state: s } = n66, r = s.selection.main, o = n66.inputState.lastKeyTime > Date.now() - 100 ? n66.inputState.lastKeyCode : -1;
    if (e.bounds) {
      let { from: l, to: a } = e.bounds, h = r.from, c = null;
      (o === 8 || A.android && e.text.length < a - l) && (h = r.to, c = "end");
      let f = s.doc.sliceString(l, a, Xt2), u, d;
      !r.empty && r.from >= l && r.to <= a && (e.typeOver || f != e.text) && f.slice(0, r.from - l) == e.text.slice(0, r.from - l) && f.slice(r.to - l) == e.text.slice(u = e.text.length - (f.length - (r.to - l))) ? t = { from: r.from, to: r.to, insert: F.of(e.text.slice(r.from - l, u).split(Xt2)) } : (d = yh(f, e.text, h - l, c)) && (A.chrome && o == 13 && d.toB == d.from + 2 && e.text.slice(d.from, d.toB) == Xt2 + Xt2 && d.toB--, t = { from: l + d.from, to: l + d.toA, insert: F.of(e.text.slice(d.from, d.toB).split(Xt2)) });
    } else i && (!n66.hasFocus && s.facet(at) || Vr2(i, r)) && (i = null);
    if (!t && !i) return false;
    if ((A.mac || A.android) && t && t.from == t.to && t.from == r.head - 1 && /^\. ?$/.test(t.insert.toString()) && n66.contentDOM.getAttribute("autocorrect") == "off" ? (i && t.insert.length == 2 && (i = x.single(i.main.anchor - 1, i.main.head - 1)), t = { from: t.from, to: t.to, insert: F.of([t.insert.toString().replace(".", " ")]) }) : s.doc.lineAt(r.from).to < r.to && n66.docView.lineHasWidget(r.to) && n66.inputState.insertingTextAt > Date.now() - 50 ? t = { from: r.from, to: r.to, insert: s.toText(n66.inputState.insertingText) } : A.chrome && t && t.from == t.to && t.from == r.head && t.insert.toString() == `
 ` && n66.lineWrapping && (i && (i = x.single(i.main.anchor - 1, i.main.head - 1)), t = { from: r.from, to: r.to, insert: F.of([" "]) }), t) return So2(n66, t, i, o);
    if (i && !Vr2(i, r)) {
      let l = false, a = "select";
      return n66.inputState.lastSelectionTime > Date.now() - 50 && (n66.inputState.lastSelectionOrigin == "select" && (l = true), a = n66.inputState.lastSelectionOrigin, a == "select.pointer" && (i = ph(s.facet(Vi).map((h) => h(n66)), i))), n66.dispatch({ selection: i, scrollIntoView: l, userEvent: a }), true;
    } else return false;
  }
  function So2(n66, e, t, i = -1) {
    if (A.ios && n66.inputState.flushIOSKey(e)) return true;
    let s = n66.state.selection.main;
    if (A.android && (e.to == s.to && (e.from == s.from || e.from == s.from - 1 && n66.state.sliceDoc(e.from, s.from) == " ") && e.insert.length == 1 && e.insert.lines == 2 && ii2(n66.contentDOM, "Enter", 13) || (e.from == s.from - 1 && e.to == s.to && e.insert.length == 0 || i == 8 && e.insert.length < e.to - e.from && e.to > s.head) && ii2(n66.contentDOM, "Backspace", 8) || e.from == s.from && e.to == s.to + 1 && e.insert.length == 0 && ii2(n66.contentDOM, "Delete", 46))) return true;
    let r = e.insert.toString();
    n66.inputState.composing >= 0 && n66.inputState.composing++;
    let o, l = () => o || (o = du(n66, e, t));
    return n66.state.facet(th).some((a) => a(n66, e.from, e.to, r, l)) || n66.dispatch(l()), true;
  }
  function du(n66, e, t) {
    let i, s = n66.state, r = s.selection.main, o = -1;
    if (e.from == e.to && e.from < r.from || e.from > r.to) {
      let a = e.from < r.from ? -1 : 1, h = a < 0 ? r.from : r.to, c = Ri(s.facet(Vi).map((f) => f(n66)), h, a);
      e.from == c && (o = c);
    }
    if (o > -1) i = { changes: e, selection: x.cursor(e.from + e.insert.length, -1) };
    else if (e.from >= r.from && e.to <= r.to && e.to - e.from >= (r.to - r.from) / 3 && (!t || t.main.empty && t.main.from == e.from + e.insert.length) && n66.inputState.composing < 0) {
      let a = r.from < e.from ? s.sliceDoc(r.from, e.from) : "", h = r.to > e.to ? s.sliceDoc(e.to, r.to) : "";
      i = s.replaceSelection(n66.state.toText(a + e.insert.sliceString(0, void 0, n66.state.lineBreak) + h));
    } else {
      let a = s.changes(e), h = t && t.main.to <= a.newLength ? t.main : void 0;
      if (s.selection.ranges.length > 1 && (n66.inputState.composing >= 0 || n66.inputState.compositionPendingChange) && e.to <= r.to + 10 && e.to >= r.to - 10) {
        let c = n66.state.sliceDoc(e.from, e.to), f, u = t && dh(n66, t.main.head);
        if (u) {
          let p = e.insert.length - (e.to - e.from);
          f = { from: u.from, to: u.to - p };
        } else f = n66.state.doc.lineAt(r.head);
        let d = r.to - e.to;
        i = s.changeByRange((p) => {
          if (p.from == r.from && p.to == r.to) return { changes: a, range: h || p.map(a) };
          let m = p.to - d, g = m - c.length;
          if (n66.state.sliceDoc(g, m) != c || m >= f.from && g <= f.to) return { range: p };
          let y = s.changes({ from: g, to: m, insert: e.insert }), v = p.to - r.to;
          return { changes: y, range: h ? x.range(Math.max(0, h.anchor + v), Math.max(0, h.head + v)) : p.map(y) };
        });
      } else i = { changes: a, selection: h && s.selection.replaceRange(h) };
    }
    let l = "input.type";
    return (n66.composing || n66.inputState.compositionPendingChange && n66.inputState.compositionEndedAt > Date.now() - 50) && (n66.inputState.compositionPendingChange = false, l += ".compose", n66.inputState.compositionFirstChange && (l += ".start", n66.inputState.compositionFirstChange = false)), s.update(i, { userEvent: l, scrollIntoView: true });
  }
  function yh(n66, e, t, i) {
    let s = Math.min(n66.length, e.length), r = 0;
    for (; r < s && n66.charCodeAt(r) == e.charCodeAt(r); ) r++;
    if (r == s && n66.length == e.length) return null;
    let o = n66.length, l = e.length;
    for (; o > 0 && l > 0 && n66.charCodeAt(o - 1) == e.charCodeAt(l - 1); ) o--, l--;
    if (i == "end") {
      let a = Math.max(0, r - Math.min(o, l));
      t -= o + a - r;
    }
    if (o < r && n66.length < e.length) {
      let a = t <= r && t >= o ? r - t : 0;
      r -= a, l = r + (l - o), o = r;
    } else if (l < r) {
      let a = t <= r && t >= l ? r - t : 0;
      r -= a, o = r + (o - l), l = r;
    }
    return { from: r, toA: o, toB: l };
  }
  function pu(n66) {
    let e = [];
    if (n66.root.activeElement != n66.contentDOM) return e;
    let { anchorNode: t, anchorOffset: i, focusNode: s, focusOffset: r } = n66.observer.selectionRange;
    return t && (e.push(new qn2(t, i)), (s != t || r != i) && e.push(new qn2(s, r))), e;
  }
  function mu(n66, e) {
    if (n66.length == 0) return null;
    let t = n66[0].pos, i = n66.length == 2 ? n66[1].pos : t;
    return t < 0 || i < 0 ? null : t == i ? x.create([x.cursor(i + e, -1)]) : x.single(t + e, i + e);
  }
  function Vr2(n66, e) {
    return e.head == n66.main.head && e.anchor == n66.main.anchor;
  }
  var zr2 = class {
    setSelectionOrigin(e) {
      this.lastSelectionOrigin = e, this.lastSelectionTime = Date.now();
    }
    constructor(e) {
      this.view = e, this.lastKeyCode = 0, this.lastKeyTime = 0, this.touchActive = false, this.lastTouchTime = 0, this.lastTouchX = 0, this.lastTouchY = 0, this.lastFocusTime = 0, this.lastScrollTop = 0, this.lastScrollLeft = 0, this.lastWheelEvent = 0, this.pendingIOSKey = void 0, this.lastIOSMomentumScroll = 0, this.tabFocusMode = -1, this.lastSelectionOrigin = null, this.lastSelectionTime = 0, this.lastContextMenu = 0, this.scrollHandlers = [], this.handlers = /* @__PURE__ */ Object.create(null), this.composing = -1, this.compositionFirstChange = null, this.compositionEndedAt = 0, this.compositionPendingKey = false, this.compositionPendingChange = false, this.insertingText = "", this.insertingTextAt = 0, this.mouseSelection = null, this.draggedContent = null, this.handleEvent = this.handleEvent.bind(this), this.notifiedFocused = e.hasFocus, A.safari && e.contentDOM.addEventListener("input", () => null), A.gecko && Bu(e.contentDOM.ownerDocument);
    }
    handleEvent(e) {
      !Su(this.view, e) || this.ignoreDuringComposition(e) || e.type == "keydown" && this.keydown(e) || (this.view.updateState != 0 ? Promise.resolve().then(() => this.runHandlers(e.type, e)) : this.runHandlers(e.type, e));
    }
    runHandlers(e, t) {
      let i = this.handlers[e];
      if (i) {
        for (let s of i.observers) s(this.view, t);
        for (let s of i.handlers) {
          if (t.defaultPrevented) break;
          if (s(this.view, t)) {
            t.preventDefault();
            break;
          }
        }
      }
    }
    ensureHandlers(e) {
      let t = yu(e), i = this.handlers, s = this.view.contentDOM;
      for (let r in t) if (r != "scroll") {
        let o = !t[r].handlers.length, l = i[r];
        l && o != !l.handlers.length && (s.removeEventListener(r, this.handleEvent), l = null), l || s.addEventListener(r, this.handleEvent, { passive: o });
      }
      for (let r in i) r != "scroll" && !t[r] && s.removeEventListener(r, this.handleEvent);
      this.handlers = t;
    }
    keydown(e) {
      if (this.lastKeyCode = e.keyCode, this.lastKeyTime = Date.now(), e.keyCode == 9 && this.tabFocusMode > -1 && (!this.tabFocusMode || Date.now() <= this.tabFocusMode)) return true;
      if (this.tabFocusMode > 0 && e.keyCode != 27 && xh.indexOf(e.keyCode) < 0 && (this.tabFocusMode = -1), A.android && A.chrome && !e.synthetic && (e.keyCode == 13 || e.keyCode == 8)) return this.view.observer.delayAndroidKey(e.key, e.keyCode), true;
      if (A.ios && !e.synthetic && !e.altKey && !e.metaKey && (bh.some((t) => t.keyCode == e.keyCode) && !e.ctrlKey || bu.indexOf(e.key) > -1 && e.ctrlKey)) {
        let t = { ctrlKey: e.ctrlKey, altKey: e.altKey, metaKey: e.metaKey, shiftKey: e.shiftKey };
        t.shiftKey && A.ios && !/^(off|none)$/.test(this.view.contentDOM.autocapitalize) && gu(this.view.win) && (t.shiftKey = false);
        let i = this.pendingIOSKey = { key: e.key, keyCode: e.keyCode, mods: t };
        return setTimeout(() => {
          this.pendingIOSKey == i && this.flushIOSKey();
        }, 50), true;
      }
      return e.keyCode != 229 && this.view.observer.forceFlush(), false;
    }
    flushIOSKey(e) {
      let t = this.pendingIOSKey;
      return !t || this.view.observer.pendingRecords().length || t.key == "Enter" && e && e.from < e.to && /^\S+$/.test(e.insert.toString()) ? false : (this.pendingIOSKey = void 0, ii2(this.view.contentDOM, t.key, t.keyCode, t.mods));
    }
    ignoreDuringComposition(e) {
      return !/^key/.test(e.type) || e.synthetic ? false : this.composing > 0 ? true : A.safari && !A.ios && this.compositionPendingKey && Date.now() - this.compositionEndedAt < 100 ? (this.compositionPendingKey = false, true) : false;
    }
    startMouseSelection(e) {
      this.mouseSelection && this.mouseSelection.destroy(), this.mouseSelection = e;
    }
    update(e) {
      this.view.observer.update(e), this.mouseSelection && this.mouseSelection.update(e), this.draggedContent && e.docChanged && (this.draggedContent = this.draggedContent.map(e.changes)), e.transactions.length && (this.lastKeyCode = this.lastSelectionTime = 0);
    }
    destroy() {
      this.mouseSelection && this.mouseSelection.destroy();
    }
  };
  function gu(n66) {
    return n66.visualViewport ? n66.visualViewport.height * n66.visualViewport.scale / n66.document.documentElement.clientHeight < 0.85 : false;
  }
  function ca(n66, e) {
    return (t, i) => {
      try {
        return e.call(n66, i, t);
      } catch (s) {
        le(t.state, s);
      }
    };
  }
  function yu(n66) {
    let e = /* @__PURE__ */ Object.create(null);
    function t(i) {
      return e[i] || (e[i] = { observers: [], handlers: [] });
    }
    for (let i of n66) {
      let s = i.spec, r = s && s.plugin.domEventHandlers, o = s && s.plugin.domEventObservers;
      if (r) for (let l in r) {
        let a = r[l];
        a && t(l).handlers.push(ca(i.value, a));
      }
      if (o) for (let l in o) {
        let a = o[l];
        a && t(l).observers.push(ca(i.value, a));
      }
    }
    for (let i in Ve) t(i).handlers.push(Ve[i]);
    for (let i in ye) t(i).observers.push(ye[i]);
    return e;
  }
  var bh = [{ key: "Backspace", keyCode: 8, inputType: "deleteContentBackward" }, { key: "Enter", keyCode: 13, inputType: "insertParagraph" }, { key: "Enter", keyCode: 13, inputType: "insertLineBreak" }, { key: "Delete", keyCode: 46, inputType: "deleteContentForward" }];
  var bu = "dthko";
  var xh = [16, 17, 18, 20, 91, 92, 224, 225];
  var vn = 6;
  function kn(n66) {
    return Math.max(0, n66) * 0.7 + 8;
  }
  function xu(n66, e) {
    return Math.max(Math.abs(n66.clientX - e.clientX), Math.abs(n66.clientY - e.clientY));
  }
  var qr2 = class {
    constructor(e, t, i, s) {
      this.view = e, this.startEvent = t, this.style = i, this.mustSelect = s, this.scrollSpeed = { x: 0, y: 0 }, this.scrolling = -1, this.lastEvent = t, this.scrollParents = Wa(e.contentDOM), this.atoms = e.state.facet(Vi).map((o) => o(e));
      let r = e.contentDOM.ownerDocument;
      r.addEventListener("mousemove", this.move = this.move.bind(this)), r.addEventListener("mouseup", this.up = this.up.bind(this)), this.extend = t.shiftKey, this.multiple = e.state.facet(_.allowMultipleSelections) && wu(e, t), this.dragging = ku(e, t) && kh(t) == 1 ? null : false;
    }
    start(e) {
      this.dragging === false && this.select(e);
    }
    move(e) {
      if (e.buttons == 0) return this.destroy();
      if (this.dragging || this.dragging == null && xu(this.startEvent, e) < 10) return;
      this.select(this.lastEvent = e);
      let t = 0, i = 0, s = 0, r = 0, o = this.view.win.innerWidth, l = this.view.win.innerHeight;
      this.scrollParents.x && ({ left: s, right: o } = this.scrollParents.x.getBoundingClientRect()), this.scrollParents.y && ({ top: r, bottom: l } = this.scrollParents.y.getBoundingClientRect());
      let a = ko2(this.view);
      e.clientX - a.left <= s + vn ? t = -kn(s - e.clientX) : e.clientX + a.right >= o - vn && (t = kn(e.clientX - o)), e.clientY - a.top <= r + vn ? i = -kn(r - e.clientY) : e.clientY + a.bottom >= l - vn && (i = kn(e.clientY - l)), this.setScrollSpeed(t, i);
    }
    up(e) {
      this.dragging == null && this.select(this.lastEvent), this.dragging || e.preventDefault(), this.destroy();
    }
    destroy() {
      this.setScrollSpeed(0, 0);
      let e = this.view.contentDOM.ownerDocument;
      e.removeEventListener("mousemove", this.move), e.removeEventListener("mouseup", this.up), this.view.inputState.mouseSelection = this.view.inputState.draggedContent = null;
    }
    setScrollSpeed(e, t) {
      this.scrollSpeed = { x: e, y: t }, e || t ? this.scrolling < 0 && (this.scrolling = setInterval(() => this.scroll(), 50)) : this.scrolling > -1 && (clearInterval(this.scrolling), this.scrolling = -1);
    }
    scroll() {
      let { x: e, y: t } = this.scrollSpeed;
      e && this.scrollParents.x && (this.scrollParents.x.scrollLeft += e, e = 0), t && this.scrollParents.y && (this.scrollParents.y.scrollTop += t, t = 0), (e || t) && this.view.win.scrollBy(e, t), this.dragging === false && this.select(this.lastEvent);
    }
    select(e) {
      let { view: t } = this, i = ph(this.atoms, this.style.get(e, this.extend, this.multiple));
      (this.mustSelect || !i.eq(t.state.selection, this.dragging === false)) && this.view.dispatch({ selection: i, userEvent: "select.pointer" }), this.mustSelect = false;
    }
    update(e) {
      e.transactions.some((t) => t.isUserEvent("input.type")) ? this.destroy() : this.style.update(e) && setTimeout(() => this.select(this.lastEvent), 20);
    }
  };
  function wu(n66, e) {
    let t = n66.state.facet(Ja);
    return t.length ? t[0](e) : A.mac ? e.metaKey : e.ctrlKey;
  }
  function vu(n66, e) {
    let t = n66.state.facet(Qa);
    return t.length ? t[0](e) : A.mac ? !e.altKey : !e.ctrlKey;
  }
  function ku(n66, e) {
    let { main: t } = n66.state.selection;
    if (t.empty) return false;
    let i = Hi(n66.root);
    if (!i || i.rangeCount == 0) return true;
    let s = i.getRangeAt(0).getClientRects();
    for (let r = 0; r < s.length; r++) {
      let o = s[r];
      if (o.left <= e.clientX && o.right >= e.clientX && o.top <= e.clientY && o.bottom >= e.clientY) return true;
    }
    return false;
  }
  function Su(n66, e) {
    if (!e.bubbles) return true;
    if (e.defaultPrevented) return false;
    for (let t = e.target, i; t != n66.contentDOM; t = t.parentNode) if (!t || t.nodeType == 11 || (i = Y.get(t)) && i.isWidget() && !i.isHidden && i.widget.ignoreEvent(e)) return false;
    return true;
  }
  var Ve = /* @__PURE__ */ Object.create(null);
  var ye = /* @__PURE__ */ Object.create(null);
  var wh = A.ie && A.ie_version < 15 || A.ios && A.webkit_version < 604;
  function Cu(n66) {
    let e = n66.dom.parentNode;
    if (!e) return;
    let t = e.appendChild(document.createElement("textarea"));
    t.style.cssText = "position: fixed; left: -10000px; top: 10px", t.focus(), setTimeout(() => {
      n66.focus(), t.remove(), vh(n66, t.value);
    }, 50);
  }
  function es2(n66, e, t) {
    for (let i of n66.facet(e)) t = i(t, n66);
    return t;
  }
  function vh(n66, e) {
    e = es2(n66.state, bo2, e);
    let { state: t } = n66, i, s = 1, r = t.toText(e), o = r.lines == t.selection.ranges.length;
    if (Kr2 != null && t.selection.ranges.every((a) => a.empty) && Kr2 == r.toString()) {
      let a = -1;
      i = t.changeByRange((h) => {
        let c = t.doc.lineAt(h.from);
        if (c.from == a) return { range: h };
        a = c.from;
        let f = t.toText((o ? r.line(s++).text : e) + t.lineBreak);
        return { changes: { from: c.from, insert: f }, range: x.cursor(h.from + f.length, -1) };
      });
    } else o ? i = t.changeByRange((a) => {
      let h = r.line(s++);
      return { changes: { from: a.from, to: a.to, insert: h.text }, range: x.cursor(a.from + h.length, -1) };
    }) : i = t.replaceSelection(r);
    n66.dispatch(i, { userEvent: "input.paste", scrollIntoView: true });
  }
  ye.scroll = (n66) => {
    let e = n66.inputState;
    e.lastScrollTop = n66.scrollDOM.scrollTop, e.lastScrollLeft = n66.scrollDOM.scrollLeft, A.ios && !e.touchActive && (e.lastIOSMomentumScroll = Date.now());
  };
  ye.wheel = ye.mousewheel = (n66) => {
    n66.inputState.lastWheelEvent = Date.now();
  };
  Ve.keydown = (n66, e) => (n66.inputState.setSelectionOrigin("select"), e.keyCode == 27 && n66.inputState.tabFocusMode != 0 && (n66.inputState.tabFocusMode = Date.now() + 2e3), false);
  ye.touchstart = (n66, e) => {
    let t = n66.inputState, i = e.targetTouches[0];
    t.touchActive = true, t.lastTouchTime = Date.now(), i && (t.lastTouchX = i.clientX, t.lastTouchY = i.clientY), t.setSelectionOrigin("select.pointer");
  };
  ye.touchmove = (n66) => {
    n66.inputState.setSelectionOrigin("select.pointer");
  };
  ye.touchend = (n66, e) => {
    n66.inputState.touchActive = false;
  };
  Ve.mousedown = (n66, e) => {
    if (n66.observer.flush(), n66.inputState.lastTouchTime > Date.now() - 2e3) return false;
    let t = null;
    for (let i of n66.state.facet(Za)) if (t = i(n66, e), t) break;
    if (!t && e.button == 0 && (t = Mu(n66, e)), t) {
      let i = !n66.hasFocus;
      n66.inputState.startMouseSelection(new qr2(n66, e, t, i)), i && n66.observer.ignore(() => {
        qa(n66.contentDOM);
        let r = n66.root.activeElement;
        r && !r.contains(n66.contentDOM) && r.blur();
      });
      let s = n66.inputState.mouseSelection;
      if (s) return s.start(e), s.dragging === false;
    } else n66.inputState.setSelectionOrigin("select.pointer");
    return false;
  };
  function fa(n66, e, t, i) {
    if (i == 1) return x.cursor(e, t);
    if (i == 2) return ou(n66.state, e, t);
    {
      let s = n66.docView.lineAt(e, t), r = n66.state.doc.lineAt(s ? s.posAtEnd : e), o = s ? s.posAtStart : r.from, l = s ? s.posAtEnd : r.to;
      return l < n66.state.doc.length && l == r.to && l++, x.undirectionalRange(o, l);
    }
  }
  var Au = A.ie && A.ie_version <= 11;
  var ua = null;
  var da = 0;
  var pa = 0;
  function kh(n66) {
    if (!Au) return n66.detail;
    let e = ua, t = pa;
    return ua = n66, pa = Date.now(), da = !e || t > Date.now() - 400 && Math.abs(e.clientX - n66.clientX) < 2 && Math.abs(e.clientY - n66.clientY) < 2 ? (da + 1) % 3 : 1;
  }
  function Mu(n66, e) {
    let t = n66.posAndSideAtCoords({ x: e.clientX, y: e.clientY }, false), i = kh(e), s = n66.state.selection;
    return { update(r) {
      r.docChanged && (t.pos = r.changes.mapPos(t.pos), s = s.map(r.changes));
    }, get(r, o, l) {
      let a = n66.posAndSideAtCoords({ x: r.clientX, y: r.clientY }, false), h, c = fa(n66, a.pos, a.assoc, i);
      if (t.pos != a.pos && !o) {
        let f = fa(n66, t.pos, t.assoc, i), u = Math.min(f.from, c.from), d = Math.max(f.to, c.to);
        c = u < c.from ? x.range(u, d, c.assoc) : x.range(d, u, c.assoc);
      }
      return o ? s.replaceRange(s.main.extend(c.from, c.to, c.assoc)) : l && i == 1 && s.ranges.length > 1 && (h = Tu(s, a.pos)) ? h : l ? s.addRange(c) : x.create([c]);
    } };
  }
  function Tu(n66, e) {
    for (let t = 0; t < n66.ranges.length; t++) {
      let { from: i, to: s } = n66.ranges[t];
      if (i <= e && s >= e) return x.create(n66.ranges.slice(0, t).concat(n66.ranges.slice(t + 1)), n66.mainIndex == t ? 0 : n66.mainIndex - (n66.mainIndex > t ? 1 : 0));
    }
    return null;
  }
  Ve.dragstart = (n66, e) => {
    let { selection: { main: t } } = n66.state;
    if (e.target.draggable) {
      let s = n66.docView.tile.nearest(e.target);
      if (s && s.isWidget()) {
        let r = s.posAtStart, o = r + s.length;
        (r >= t.to || o <= t.from) && (t = x.undirectionalRange(r, o));
      }
    }
    let { inputState: i } = n66;
    return i.mouseSelection && (i.mouseSelection.dragging = true), i.draggedContent = t, e.dataTransfer && (e.dataTransfer.setData("Text", es2(n66.state, xo2, n66.state.sliceDoc(t.from, t.to))), e.dataTransfer.effectAllowed = "copyMove"), false;
  };
  Ve.dragend = (n66) => (n66.inputState.draggedContent = null, false);
  function ma(n66, e, t, i) {
    if (t = es2(n66.state, bo2, t), !t) return;
    let s = n66.posAtCoords({ x: e.clientX, y: e.clientY }, false), { draggedContent: r } = n66.inputState, o = i && r && vu(n66, e) ? { from: r.from, to: r.to } : null, l = { from: s, insert: t }, a = n66.state.changes(o ? [o, l] : l);
    n66.focus(), n66.dispatch({ changes: a, selection: { anchor: a.mapPos(s, -1), head: a.mapPos(s, 1) }, userEvent: o ? "move.drop" : "input.drop" }), n66.inputState.draggedContent = null;
  }
  Ve.drop = (n66, e) => {
    if (!e.dataTransfer) return false;
    if (n66.state.readOnly) return true;
    let t = e.dataTransfer.files;
    if (t && t.length) {
      let i = Array(t.length), s = 0, r = () => {
        ++s == t.length && ma(n66, e, i.filter((o) => o != null).join(n66.state.lineBreak), false);
      };
      for (let o = 0; o < t.length; o++) {
        let l = new FileReader();
        l.onerror = r, l.onload = () => {
          /[\x00-\x08\x0e-\x1f]{2}/.test(l.result) || (i[o] = l.result), r();
        }, l.readAsText(t[o]);
      }
      return true;
    } else {
      let i = e.dataTransfer.getData("Text");
      if (i) return ma(n66, e, i, true), true;
    }
    return false;
  };
  Ve.paste = (n66, e) => {
    if (n66.state.readOnly) return true;
    n66.observer.flush();
    let t = wh ? null : e.clipboardData;
    return t ? (vh(n66, t.getData("text/plain") || t.getData("text/uri-list")), true) : (Cu(n66), false);
  };
  function Du(n66, e) {
    let t = n66.dom.parentNode;
    if (!t) return;
    let i = t.appendChild(document.createElement("textarea"));
    i.style.cssText = "position: fixed; left: -10000px; top: 10px", i.value = e, i.focus(), i.selectionEnd = e.length, i.selectionStart = 0, setTimeout(() => {
      i.remove(), n66.focus();
    }, 50);
  }
  function Ou(n66) {
    let e = [], t = [], i = false;
    for (let s of n66.selection.ranges) s.empty || (e.push(n66.sliceDoc(s.from, s.to)), t.push(s));
    if (!e.length) {
      let s = -1;
      for (let { from: r } of n66.selection.ranges) {
        let o = n66.doc.lineAt(r);
        o.number > s && (e.push(o.text), t.push({ from: o.from, to: Math.min(n66.doc.length, o.to + 1) })), s = o.number;
      }
      i = true;
    }
    return { text: es2(n66, xo2, e.join(n66.lineBreak)), ranges: t, linewise: i };
  }
  var Kr2 = null;
  Ve.copy = Ve.cut = (n66, e) => {
    if (!Di(n66.contentDOM, n66.observer.selectionRange)) return false;
    let { text: t, ranges: i, linewise: s } = Ou(n66.state);
    if (!t && !s) return false;
    Kr2 = s ? t : null, e.type == "cut" && !n66.state.readOnly && n66.dispatch({ changes: i, scrollIntoView: true, userEvent: "delete.cut" });
    let r = wh ? null : e.clipboardData;
    return r ? (r.clearData(), r.setData("text/plain", t), true) : (Du(n66, t), false);
  };
  var Sh = oe2.define();
  function Ch(n66, e) {
    let t = [];
    for (let i of n66.facet(ih)) {
      let s = i(n66, e);
      s && t.push(s);
    }
    return t.length ? n66.update({ effects: t, annotations: Sh.of(true) }) : null;
  }
  function Ah(n66) {
    setTimeout(() => {
      let e = n66.hasFocus;
      if (e != n66.inputState.notifiedFocused) {
        let t = Ch(n66.state, e);
        t ? n66.dispatch(t) : n66.update([]);
      }
    }, 10);
  }
  ye.focus = (n66) => {
    n66.inputState.lastFocusTime = Date.now(), !n66.scrollDOM.scrollTop && (n66.inputState.lastScrollTop || n66.inputState.lastScrollLeft) && (n66.scrollDOM.scrollTop = n66.inputState.lastScrollTop, n66.scrollDOM.scrollLeft = n66.inputState.lastScrollLeft), Ah(n66);
  };
  ye.blur = (n66) => {
    n66.observer.clearSelectionRange(), Ah(n66);
  };
  ye.compositionstart = ye.compositionupdate = (n66, e) => {
    if (!n66.observer.editContext && (n66.inputState.compositionFirstChange == null && (n66.inputState.compositionFirstChange = true), n66.inputState.composing < 0)) {
      let { main: t } = n66.state.selection;
      !t.empty && n66.lineBlockAt(t.from).from != n66.lineBlockAt(t.to).from && !n66.state.readOnly && n66.dispatch({ changes: n66.state.selection.ranges.filter((i) => !i.empty).map((i) => ({ from: i.from, to: i.to })), userEvent: "input" }), n66.inputState.composing = 0;
    }
  };
  ye.compositionend = (n66) => {
    n66.observer.editContext || (n66.inputState.composing = -1, n66.inputState.compositionEndedAt = Date.now(), n66.inputState.compositionPendingKey = true, n66.inputState.compositionPendingChange = n66.observer.pendingRecords().length > 0, n66.inputState.compositionFirstChange = null, A.chrome && A.android ? n66.observer.flushSoon() : n66.inputState.compositionPendingChange ? Promise.resolve().then(() => n66.observer.flush()) : setTimeout(() => {
      n66.inputState.composing < 0 && n66.docView.hasComposition && n66.update([]);
    }, 50));
  };
  ye.contextmenu = (n66) => {
    n66.inputState.lastContextMenu = Date.now();
  };
  Ve.beforeinput = (n66, e) => {
    var t, i;
    if ((e.inputType == "insertText" || e.inputType == "insertCompositionText") && (n66.inputState.insertingText = e.data, n66.inputState.insertingTextAt = Date.now()), e.inputType == "insertReplacementText" && n66.observer.editContext) {
      let r = (t = e.dataTransfer) === null || t === void 0 ? void 0 : t.getData("text/plain"), o = e.getTargetRanges();
      if (r && o.length) {
        let l = o[0], a = n66.posAtDOM(l.startContainer, l.startOffset), h = n66.posAtDOM(l.endContainer, l.endOffset);
        return So2(n66, { from: a, to: h, insert: n66.state.toText(r) }, null), true;
      }
    }
    let s;
    if (A.chrome && A.android && (s = bh.find((r) => r.inputType == e.inputType)) && (n66.observer.delayAndroidKey(s.key, s.keyCode), s.key == "Backspace" || s.key == "Delete")) {
      let r = ((i = window.visualViewport) === null || i === void 0 ? void 0 : i.height) || 0;
      setTimeout(() => {
        var o;
        (((o = window.visualViewport) === null || o === void 0 ? void 0 : o.height) || 0) > r + 10 && n66.hasFocus && (n66.contentDOM.blur(), n66.focus());
      }, 100);
    }
    return A.ios && e.inputType == "deleteContentForward" && n66.observer.flushSoon(), A.safari && e.inputType == "insertText" && n66.inputState.composing >= 0 && setTimeout(() => ye.compositionend(n66, e), 20), false;
  };
  var ga = /* @__PURE__ */ new Set();
  function Bu(n66) {
    ga.has(n66) || (ga.add(n66), n66.addEventListener("copy", () => {
    }), n66.addEventListener("cut", () => {
    }));
  }
  var ya = ["pre-wrap", "normal", "pre-line", "break-spaces"];
  var hi2 = false;
  function ba() {
    hi2 = false;
  }
  var $r2 = class {
    constructor(e) {
      this.lineWrapping = e, this.doc = F.empty, this.heightSamples = {}, this.lineHeight = 14, this.charWidth = 7, this.textHeight = 14, this.lineLength = 30;
    }
    heightForGap(e, t) {
      let i = this.doc.lineAt(t).number - this.doc.lineAt(e).number + 1;
      return this.lineWrapping && (i += Math.max(0, Math.ceil((t - e - i * this.lineLength * 0.5) / this.lineLength))), this.lineHeight * i;
    }
    heightForLine(e) {
      return this.lineWrapping ? (1 + Math.max(0, Math.ceil((e - this.lineLength) / Math.max(1, this.lineLength - 5)))) * this.lineHeight : this.lineHeight;
    }
    setDoc(e) {
      return this.doc = e, this;
    }
    mustRefreshForWrapping(e) {
      return ya.indexOf(e) > -1 != this.lineWrapping;
    }
    mustRefreshForHeights(e) {
      let t = false;
      for (let i = 0; i < e.length; i++) {
        let s = e[i];
        s < 0 ? i++ : this.heightSamples[Math.floor(s * 10)] || (t = true, this.heightSamples[Math.floor(s * 10)] = true);
      }
      return t;
    }
    refresh(e, t, i, s, r, o) {
      let l = ya.indexOf(e) > -1, a = Math.abs(t - this.lineHeight) > 0.3 || this.lineWrapping != l;
      if (this.lineWrapping = l, this.lineHeight = t, this.charWidth = i, this.textHeight = s, this.lineLength = r, a) {
        this.heightSamples = {};
        for (let h = 0; h < o.length; h++) {
          let c = o[h];
          c < 0 ? h++ : this.heightSamples[Math.floor(c * 10)] = true;
        }
      }
      return a;
    }
  };
  var jr2 = class {
    constructor(e, t) {
      this.from = e, this.heights = t, this.index = 0;
    }
    get more() {
      return this.index < this.heights.length;
    }
  };
  var He2 = class n34 {
    constructor(e, t, i, s, r) {
      this.from = e, this.length = t, this.top = i, this.height = s, this._content = r;
    }
    get type() {
      return typeof this._content == "number" ? ae2.Text : Array.isArray(this._content) ? this._content : this._content.type;
    }
    get to() {
      return this.from + this.length;
    }
    get bottom() {
      return this.top + this.height;
    }
    get widget() {
      return this._content instanceof Lt ? this._content.widget : null;
    }
    get widgetLineBreaks() {
      return typeof this._content == "number" ? this._content : 0;
    }
    join(e) {
      let t = (Array.isArray(this._content) ? this._content : [this]).concat(Array.isArray(e._content) ? e._content : [e]);
      return new n34(this.from, this.length + e.length, this.top, this.height + e.height, t);
    }
  };
  var j = (function(n66) {
    return n66[n66.ByPos = 0] = "ByPos", n66[n66.ByHeight = 1] = "ByHeight", n66[n66.ByPosNoHeight = 2] = "ByPosNoHeight", n66;
  })(j || (j = {}));
  var Bn2 = 1e-3;
  var ke = class n35 {
    constructor(e, t, i = 2) {
      this.length = e, this.height = t, this.flags = i;
    }
    get outdated() {
      return (this.flags & 2) > 0;
    }
    set outdated(e) {
      this.flags = (e ? 2 : 0) | this.flags & -3;
    }
    setHeight(e) {
      this.height != e && (Math.abs(this.height - e) > Bn2 && (hi2 = true), this.height = e);
    }
    replace(e, t, i) {
      return n35.of(i);
    }
    decomposeLeft(e, t) {
      t.push(this);
    }
    decomposeRight(e, t) {
      t.push(this);
    }
    applyChanges(e, t, i, s) {
      let r = this, o = i.doc;
      for (let l = s.length - 1; l >= 0; l--) {
        let { fromA: a, toA: h, fromB: c, toB: f } = s[l], u = r.lineAt(a, j.ByPosNoHeight, i.setDoc(t), 0, 0), d = u.to >= h ? u : r.lineAt(h, j.ByPosNoHeight, i, 0, 0);
        for (f += d.to - h, h = d.to; l > 0 && u.from <= s[l - 1].toA; ) a = s[l - 1].fromA, c = s[l - 1].fromB, l--, a < u.from && (u = r.lineAt(a, j.ByPosNoHeight, i, 0, 0));
        c += u.from - a, a = u.from;
        let p = Gr2.build(i.setDoc(o), e, c, f);
        r = Kn2(r, r.replace(a, h, p));
      }
      return r.updateHeight(i, 0);
    }
    static empty() {
      return new Be2(0, 0, 0);
    }
    static of(e) {
      if (e.length == 1) return e[0];
      let t = 0, i = e.length, s = 0, r = 0;
      for (; ; ) if (t == i) if (s > r * 2) {
        let l = e[t - 1];
        l.break ? e.splice(--t, 1, l.left, null, l.right) : e.splice(--t, 1, l.left, l.right), i += 1 + l.break, s -= l.size;
      } else if (r > s * 2) {
        let l = e[i];
        l.break ? e.splice(i, 1, l.left, null, l.right) : e.splice(i, 1, l.left, l.right), i += 2 + l.break, r -= l.size;
      } else break;
      else if (s < r) {
        let l = e[t++];
        l && (s += l.size);
      } else {
        let l = e[--i];
        l && (r += l.size);
      }
      let o = false;
      return e[t - 1] == null ? (o = true, t--) : e[t] == null && (o = true, i++), new Ur2(n35.of(e.slice(0, t)), o, n35.of(e.slice(i)));
    }
  };
  function Kn2(n66, e) {
    return n66 == e ? n66 : (n66.constructor != e.constructor && (hi2 = true), e);
  }
  ke.prototype.size = 1;
  var Eu = L.replace({});
  var $n2 = class extends ke {
    constructor(e, t, i) {
      super(e, t), this.deco = i, this.spaceAbove = 0;
    }
    mainBlock(e, t) {
      return new He2(t, this.length, e + this.spaceAbove, this.height - this.spaceAbove, this.deco || 0);
    }
    blockAt(e, t, i, s) {
      return this.spaceAbove && e < i + this.spaceAbove ? new He2(s, 0, i, this.spaceAbove, Eu) : this.mainBlock(i, s);
    }
    lineAt(e, t, i, s, r) {
      let o = this.mainBlock(s, r);
      return this.spaceAbove ? this.blockAt(0, i, s, r).join(o) : o;
    }
    forEachLine(e, t, i, s, r, o) {
      e <= r + this.length && t >= r && o(this.lineAt(0, j.ByPos, i, s, r));
    }
    setMeasuredHeight(e) {
      let t = e.heights[e.index++];
      t < 0 ? (this.spaceAbove = -t, t = e.heights[e.index++]) : this.spaceAbove = 0, this.setHeight(t);
    }
    updateHeight(e, t = 0, i = false, s) {
      return s && s.from <= t && s.more && this.setMeasuredHeight(s), this.outdated = false, this;
    }
    toString() {
      return `block(${this.length})`;
    }
  };
  var Be2 = class n36 extends $n2 {
    constructor(e, t, i) {
      super(e, t, null), this.collapsed = 0, this.widgetHeight = 0, this.breaks = 0, this.spaceAbove = i;
    }
    mainBlock(e, t) {
      return new He2(t, this.length, e + this.spaceAbove, this.height - this.spaceAbove, this.breaks);
    }
    replace(e, t, i) {
      let s = i[0];
      return i.length == 1 && (s instanceof n36 || s instanceof mt && s.flags & 4) && Math.abs(this.length - s.length) < 10 ? (s instanceof mt ? s = new n36(s.length, this.height, this.spaceAbove) : s.height = this.height, this.outdated || (s.outdated = false), s) : ke.of(i);
    }
    updateHeight(e, t = 0, i = false, s) {
      return s && s.from <= t && s.more ? this.setMeasuredHeight(s) : (i || this.outdated) && (this.spaceAbove = 0, this.setHeight(Math.max(this.widgetHeight, e.heightForLine(this.length - this.collapsed)) + this.breaks * e.lineHeight)), this.outdated = false, this;
    }
    toString() {
      return `line(${this.length}${this.collapsed ? -this.collapsed : ""}${this.widgetHeight ? ":" + this.widgetHeight : ""})`;
    }
  };
  var mt = class n37 extends ke {
    constructor(e) {
      super(e, 0);
    }
    heightMetrics(e, t) {
      let i = e.doc.lineAt(t).number, s = e.doc.lineAt(t + this.length).number, r = s - i + 1, o, l = 0;
      if (e.lineWrapping) {
        let a = Math.min(this.height, e.lineHeight * r);
        o = a / r, this.length > r + 1 && (l = (this.height - a) / (this.length - r - 1));
      } else o = this.height / r;
      return { firstLine: i, lastLine: s, perLine: o, perChar: l };
    }
    blockAt(e, t, i, s) {
      let { firstLine: r, lastLine: o, perLine: l, perChar: a } = this.heightMetrics(t, s);
      if (t.lineWrapping) {
        let h = s + (e < t.lineHeight ? 0 : Math.round(Math.max(0, Math.min(1, (e - i) / this.height)) * this.length)), c = t.doc.lineAt(h), f = l + c.length * a, u = Math.max(i, e - f / 2);
        return new He2(c.from, c.length, u, f, 0);
      } else {
        let h = Math.max(0, Math.min(o - r, Math.floor((e - i) / l))), { from: c, length: f } = t.doc.line(r + h);
        return new He2(c, f, i + l * h, l, 0);
      }
    }
    lineAt(e, t, i, s, r) {
      if (t == j.ByHeight) return this.blockAt(e, i, s, r);
      if (t == j.ByPosNoHeight) {
        let { from: d, to: p } = i.doc.lineAt(e);
        return new He2(d, p - d, 0, 0, 0);
      }
      let { firstLine: o, perLine: l, perChar: a } = this.heightMetrics(i, r), h = i.doc.lineAt(e), c = l + h.length * a, f = h.number - o, u = s + l * f + a * (h.from - r - f);
      return new He2(h.from, h.length, Math.max(s, Math.min(u, s + this.height - c)), c, 0);
    }
    forEachLine(e, t, i, s, r, o) {
      e = Math.max(e, r), t = Math.min(t, r + this.length);
      let { firstLine: l, perLine: a, perChar: h } = this.heightMetrics(i, r);
      for (let c = e, f = s; c <= t; ) {
        let u = i.doc.lineAt(c);
        if (c == e) {
          let p = u.number - l;
          f += a * p + h * (e - r - p);
        }
        let d = a + h * u.length;
        o(new He2(u.from, u.length, f, d, 0)), f += d, c = u.to + 1;
      }
    }
    replace(e, t, i) {
      let s = this.length - t;
      if (s > 0) {
        let r = i[i.length - 1];
        r instanceof n37 ? i[i.length - 1] = new n37(r.length + s) : i.push(null, new n37(s - 1));
      }
      if (e > 0) {
        let r = i[0];
        r instanceof n37 ? i[0] = new n37(e + r.length) : i.unshift(new n37(e - 1), null);
      }
      return ke.of(i);
    }
    decomposeLeft(e, t) {
      t.push(new n37(e - 1), null);
    }
    decomposeRight(e, t) {
      t.push(null, new n37(this.length - e - 1));
    }
    updateHeight(e, t = 0, i = false, s) {
      let r = t + this.length;
      if (s && s.from <= t + this.length && s.more) {
        let o = [], l = Math.max(t, s.from), a = -1;
        for (s.from > t && o.push(new n37(s.from - t - 1).updateHeight(e, t)); l <= r && s.more; ) {
          let c = e.doc.lineAt(l).length;
          o.length && o.push(null);
          let f = s.heights[s.index++], u = 0;
          f < 0 && (u = -f, f = s.heights[s.index++]), a == -1 ? a = f : Math.abs(f - a) >= Bn2 && (a = -2);
          let d = new Be2(c, f, u);
          d.outdated = false, o.push(d), l += c + 1;
        }
        l <= r && o.push(null, new n37(r - l).updateHeight(e, l));
        let h = ke.of(o);
        return (a < 0 || Math.abs(h.height - this.height) >= Bn2 || Math.abs(a - this.heightMetrics(e, t).perLine) >= Bn2) && (hi2 = true), Kn2(this, h);
      } else (i || this.outdated) && (this.setHeight(e.heightForGap(t, t + this.length)), this.outdated = false);
      return this;
    }
    toString() {
      return `gap(${this.length})`;
    }
  };
  var Ur2 = class extends ke {
    constructor(e, t, i) {
      super(e.length + (t ? 1 : 0) + i.length, e.height + i.height, (t ? 1 : 0) | (e.outdated || i.outdated ? 2 : 0)), this.left = e, this.right = i, this.size = e.size + i.size;
    }
    get break() {
      return this.flags & 1;
    }
    blockAt(e, t, i, s) {
      let r = i + this.left.height;
      return e < r ? this.left.blockAt(e, t, i, s) : this.right.blockAt(e, t, r, s + this.left.length + this.break);
    }
    lineAt(e, t, i, s, r) {
      let o = s + this.left.height, l = r + this.left.length + this.break, a = t == j.ByHeight ? e < o : e < l, h = a ? this.left.lineAt(e, t, i, s, r) : this.right.lineAt(e, t, i, o, l);
      if (this.break || (a ? h.to < l : h.from > l)) return h;
      let c = t == j.ByPosNoHeight ? j.ByPosNoHeight : j.ByPos;
      return a ? h.join(this.right.lineAt(l, c, i, o, l)) : this.left.lineAt(l, c, i, s, r).join(h);
    }
    forEachLine(e, t, i, s, r, o) {
      let l = s + this.left.height, a = r + this.left.length + this.break;
      if (this.break) e < a && this.left.forEachLine(e, t, i, s, r, o), t >= a && this.right.forEachLine(e, t, i, l, a, o);
      else {
        let h = this.lineAt(a, j.ByPos, i, s, r);
        e < h.from && this.left.forEachLine(e, Math.min(t, h.from - 1), i, s, r, o), h.to >= e && h.from <= t && o(h), t > h.to && this.right.forEachLine(Math.max(e, h.to + 1), t, i, l, a, o);
      }
    }
    replace(e, t, i) {
      let s = this.left.length + this.break;
      if (t < s) return this.balanced(this.left.replace(e, t, i), this.right);
      if (e > this.left.length) return this.balanced(this.left, this.right.replace(e - s, t - s, i));
      let r = [];
      e > 0 && this.decomposeLeft(e, r);
      let o = r.length;
      for (let l of i) r.push(l);
      if (e > 0 && xa(r, o - 1), t < this.length) {
        let l = r.length;
        this.decomposeRight(t, r), xa(r, l);
      }
      return ke.of(r);
    }
    decomposeLeft(e, t) {
      let i = this.left.length;
      if (e <= i) return this.left.decomposeLeft(e, t);
      t.push(this.left), this.break && (i++, e >= i && t.push(null)), e > i && this.right.decomposeLeft(e - i, t);
    }
    decomposeRight(e, t) {
      let i = this.left.length, s = i + this.break;
      if (e >= s) return this.right.decomposeRight(e - s, t);
      e < i && this.left.decomposeRight(e, t), this.break && e < s && t.push(null), t.push(this.right);
    }
    balanced(e, t) {
      return e.size > 2 * t.size || t.size > 2 * e.size ? ke.of(this.break ? [e, null, t] : [e, t]) : (this.left = Kn2(this.left, e), this.right = Kn2(this.right, t), this.setHeight(e.height + t.height), this.outdated = e.outdated || t.outdated, this.size = e.size + t.size, this.length = e.length + this.break + t.length, this);
    }
    updateHeight(e, t = 0, i = false, s) {
      let { left: r, right: o } = this, l = t + r.length + this.break, a = null;
      return s && s.from <= t + r.length && s.more ? a = r = r.updateHeight(e, t, i, s) : r.updateHeight(e, t, i), s && s.from <= l + o.length && s.more ? a = o = o.updateHeight(e, l, i, s) : o.updateHeight(e, l, i), a ? this.balanced(r, o) : (this.height = this.left.height + this.right.height, this.outdated = false, this);
    }
    toString() {
      return this.left + (this.break ? " " : "-") + this.right;
    }
  };
  function xa(n66, e) {
    let t, i;
    n66[e] == null && (t = n66[e - 1]) instanceof mt && (i = n66[e + 1]) instanceof mt && n66.splice(e - 1, 3, new mt(t.length + 1 + i.length));
  }
  var Lu = 5;
  var Gr2 = class n38 {
    constructor(e, t) {
      this.pos = e, this.oracle = t, this.nodes = [], this.lineStart = -1, this.lineEnd = -1, this.covering = null, this.writtenTo = e;
    }
    get isCovered() {
      return this.covering && this.nodes[this.nodes.length - 1] == this.covering;
    }
    span(e, t) {
      if (this.lineStart > -1) {
        let i = Math.min(t, this.lineEnd), s = this.nodes[this.nodes.length - 1];
        s instanceof Be2 ? s.length += i - this.pos : (i > this.pos || !this.isCovered) && this.nodes.push(new Be2(i - this.pos, -1, 0)), this.writtenTo = i, t > i && (this.nodes.push(null), this.writtenTo++, this.lineStart = -1);
      }
      this.pos = t;
    }
    point(e, t, i) {
      if (e < t || i.heightRelevant) {
        let s = i.widget ? i.widget.estimatedHeight : 0, r = i.widget ? i.widget.lineBreaks : 0;
        s < 0 && (s = this.oracle.lineHeight);
        let o = t - e;
        i.block ? this.addBlock(new $n2(o, s, i)) : (o || r || s >= Lu) && this.addLineDeco(s, r, o);
      } else t > e && this.span(e, t);
      this.lineEnd > -1 && this.lineEnd < this.pos && (this.lineEnd = this.oracle.doc.lineAt(this.pos).to);
    }
    enterLine() {
      if (this.lineStart > -1) return;
      let { from: e, to: t } = this.oracle.doc.lineAt(this.pos);
      this.lineStart = e, this.lineEnd = t, this.writtenTo < e && ((this.writtenTo < e - 1 || this.nodes[this.nodes.length - 1] == null) && this.nodes.push(this.blankContent(this.writtenTo, e - 1)), this.nodes.push(null)), this.pos > e && this.nodes.push(new Be2(this.pos - e, -1, 0)), this.writtenTo = this.pos;
    }
    blankContent(e, t) {
      let i = new mt(t - e);
      return this.oracle.doc.lineAt(e).to == t && (i.flags |= 4), i;
    }
    ensureLine() {
      this.enterLine();
      let e = this.nodes.length ? this.nodes[this.nodes.length - 1] : null;
      if (e instanceof Be2) return e;
      let t = new Be2(0, -1, 0);
      return this.nodes.push(t), t;
    }
    addBlock(e) {
      this.enterLine();
      let t = e.deco;
      t && t.startSide > 0 && !this.isCovered && this.ensureLine(), this.nodes.push(e), this.writtenTo = this.pos = this.pos + e.length, t && t.endSide > 0 && (this.covering = e);
    }
    addLineDeco(e, t, i) {
      let s = this.ensureLine();
      s.length += i, s.collapsed += i, s.widgetHeight = Math.max(s.widgetHeight, e), s.breaks += t, this.writtenTo = this.pos = this.pos + i;
    }
    finish(e) {
      let t = this.nodes.length == 0 ? null : this.nodes[this.nodes.length - 1];
      this.lineStart > -1 && !(t instanceof Be2) && !this.isCovered ? this.nodes.push(new Be2(0, -1, 0)) : (this.writtenTo < this.pos || t == null) && this.nodes.push(this.blankContent(this.writtenTo, this.pos));
      let i = e;
      for (let s of this.nodes) s instanceof Be2 && s.updateHeight(this.oracle, i), i += s ? s.length : 1;
      return this.nodes;
    }
    static build(e, t, i, s) {
      let r = new n38(i, e);
      return z.spans(t, i, s, r, 0), r.finish(i);
    }
  };
  function Ru(n66, e, t) {
    let i = new _r2();
    return z.compare(n66, e, t, i, 0), i.changes;
  }
  var _r2 = class {
    constructor() {
      this.changes = [];
    }
    compareRange() {
    }
    comparePoint(e, t, i, s) {
      (e < t || i && i.heightRelevant || s && s.heightRelevant) && ti2(e, t, this.changes, 5);
    }
  };
  function Pu(n66, e) {
    let t = n66.getBoundingClientRect(), i = n66.ownerDocument, s = i.defaultView || window, r = Math.max(0, t.left), o = Math.min(s.innerWidth, t.right), l = Math.max(0, t.top), a = Math.min(s.innerHeight, t.bottom);
    for (let h = n66.parentNode; h && h != i.body; ) if (ne2(h)) {
      let c = window.getComputedStyle(h);
      if ((h.scrollHeight > h.clientHeight || h.scrollWidth > h.clientWidth) && c.overflow != "visible") {
        let f = h.getBoundingClientRect();
        r = Math.max(r, f.left), o = Math.min(o, f.right), l = Math.max(l, f.top), a = Math.min(h == n66.parentNode ? s.innerHeight : a, f.bottom);
      }
      h = c.position == "absolute" || c.position == "fixed" ? h.offsetParent : h.parentNode;
    } else if (h.nodeType == 11) h = h.host;
    else break;
    return { left: r - t.left, right: Math.max(r, o) - t.left, top: l - (t.top + e), bottom: Math.max(l, a) - (t.top + e) };
  }
  function Iu(n66) {
    let e = n66.getBoundingClientRect(), t = n66.ownerDocument.defaultView || window;
    return e.left < t.innerWidth && e.right > 0 && e.top < t.innerHeight && e.bottom > 0;
  }
  function Nu(n66, e) {
    let t = n66.getBoundingClientRect();
    return { left: 0, right: t.right - t.left, top: e, bottom: t.bottom - (t.top + e) };
  }
  var Pi = class {
    constructor(e, t, i, s) {
      this.from = e, this.to = t, this.size = i, this.displaySize = s;
    }
    static same(e, t) {
      if (e.length != t.length) return false;
      for (let i = 0; i < e.length; i++) {
        let s = e[i], r = t[i];
        if (s.from != r.from || s.to != r.to || s.size != r.size) return false;
      }
      return true;
    }
    draw(e, t) {
      return L.replace({ widget: new Yr2(this.displaySize * (t ? e.scaleY : e.scaleX), t) }).range(this.from, this.to);
    }
  };
  var Yr2 = class extends Re {
    constructor(e, t) {
      super(), this.size = e, this.vertical = t;
    }
    eq(e) {
      return e.size == this.size && e.vertical == this.vertical;
    }
    toDOM() {
      let e = document.createElement("div");
      return this.vertical ? e.style.height = this.size + "px" : (e.style.width = this.size + "px", e.style.height = "2px", e.style.display = "inline-block"), e;
    }
    get estimatedHeight() {
      return this.vertical ? this.size : -1;
    }
  };
  var jn2 = class {
    constructor(e, t) {
      this.view = e, this.state = t, this.pixelViewport = { left: 0, right: window.innerWidth, top: 0, bottom: 0 }, this.inView = true, this.paddingTop = 0, this.paddingBottom = 0, this.contentDOMWidth = 0, this.contentDOMHeight = 0, this.editorHeight = 0, this.editorWidth = 0, this.scaleX = 1, this.scaleY = 1, this.scrollOffset = 0, this.scrolledToBottom = false, this.scrollAnchorPos = 0, this.scrollAnchorHeight = -1, this.scaler = Xr2, this.scrollTarget = null, this.printing = false, this.mustMeasureContent = true, this.defaultTextDirection = V.LTR, this.visibleRanges = [], this.mustEnforceCursorAssoc = false;
      let i = t.facet(wo2).some((s) => typeof s != "function" && s.class == "cm-lineWrapping");
      this.heightOracle = new $r2(i), this.stateDeco = wa(t), this.heightMap = ke.empty().applyChanges(this.stateDeco, F.empty, this.heightOracle.setDoc(t.doc), [new We(0, 0, 0, t.doc.length)]);
      for (let s = 0; s < 2 && (this.viewport = this.getViewport(0, null), !!this.updateForViewport()); s++) ;
      this.updateViewportLines(), this.lineGaps = this.ensureLineGaps([]), this.lineGapDeco = L.set(this.lineGaps.map((s) => s.draw(this, false))), this.scrollParent = e.scrollDOM, this.computeVisibleRanges();
    }
    updateForViewport() {
      let e = [this.viewport], { main: t } = this.state.selection;
      for (let i = 0; i <= 1; i++) {
        let s = i ? t.head : t.anchor;
        if (!e.some(({ from: r, to: o }) => s >= r && s <= o)) {
          let { from: r, to: o } = this.lineBlockAt(s);
          e.push(new Qt2(r, o));
        }
      }
      return this.viewports = e.sort((i, s) => i.from - s.from), this.updateScaler();
    }
    updateScaler() {
      let e = this.scaler;
      return this.scaler = this.heightMap.height <= 7e6 ? Xr2 : Jr2.get(this.heightOracle, this.heightMap, this.viewports), e.eq(this.scaler) ? 0 : 2;
    }
    updateViewportLines() {
      this.viewportLines = [], this.heightMap.forEachLine(this.viewport.from, this.viewport.to, this.heightOracle.setDoc(this.state.doc), 0, 0, (e) => {
        this.viewportLines.push(Ti(e, this.scaler));
      });
    }
    update(e, t = null) {
      this.state = e.state;
      let i = this.stateDeco;
      this.stateDeco = wa(this.state);
      let s = e.changedRanges, r = We.extendWithRanges(s, Ru(i, this.stateDeco, e ? e.changes : ie.empty(this.state.doc.length))), o = this.heightMap.height, l = this.scrolledToBottom ? null : this.scrollAnchorAt(this.scrollOffset);
      ba(), this.heightMap = this.heightMap.applyChanges(this.stateDeco, e.startState.doc, this.heightOracle.setDoc(this.state.doc), r), (this.heightMap.height != o || hi2) && (e.flags |= 2), l ? (this.scrollAnchorPos = e.changes.mapPos(l.from, -1), this.scrollAnchorHeight = l.top) : (this.scrollAnchorPos = -1, this.scrollAnchorHeight = o);
      let a = r.length ? this.mapViewport(this.viewport, e.changes) : this.viewport;
      (t && (t.range.head < a.from || t.range.head > a.to) || !this.viewportIsAppropriate(a)) && (a = this.getViewport(0, t));
      let h = a.from != this.viewport.from || a.to != this.viewport.to;
      this.viewport = a, e.flags |= this.updateForViewport(), (h || !e.changes.empty || e.flags & 2) && this.updateViewportLines(), (this.lineGaps.length || this.viewport.to - this.viewport.from > 4e3) && this.updateLineGaps(this.ensureLineGaps(this.mapLineGaps(this.lineGaps, e.changes))), e.flags |= this.computeVisibleRanges(e.changes), t && (this.scrollTarget = t), !this.mustEnforceCursorAssoc && (e.selectionSet || e.focusChanged) && e.view.lineWrapping && e.state.selection.main.empty && e.state.selection.main.assoc && !e.state.facet(sh) && (this.mustEnforceCursorAssoc = true);
    }
    measure() {
      let { view: e } = this, t = e.contentDOM, i = window.getComputedStyle(t), s = this.heightOracle, r = i.whiteSpace;
      this.defaultTextDirection = i.direction == "rtl" ? V.RTL : V.LTR;
      let o = this.heightOracle.mustRefreshForWrapping(r) || this.mustMeasureContent === "refresh", l = t.getBoundingClientRect(), a = o || this.mustMeasureContent || this.contentDOMHeight != l.height;
      this.contentDOMHeight = l.height, this.mustMeasureContent = false;
      let h = 0, c = 0;
      if (l.width && l.height) {
        let { scaleX: w, scaleY: k } = Ha(t, l);
        (w > 5e-3 && Math.abs(this.scaleX - w) > 5e-3 || k > 5e-3 && Math.abs(this.scaleY - k) > 5e-3) && (this.scaleX = w, this.scaleY = k, h |= 16, o = a = true);
      }
      let f = (parseInt(i.paddingTop) || 0) * this.scaleY, u = (parseInt(i.paddingBottom) || 0) * this.scaleY;
      (this.paddingTop != f || this.paddingBottom != u) && (this.paddingTop = f, this.paddingBottom = u, h |= 18), this.editorWidth != e.scrollDOM.clientWidth && (s.lineWrapping && (a = true), this.editorWidth = e.scrollDOM.clientWidth, h |= 16);
      let d = Wa(this.view.contentDOM, false).y;
      d != this.scrollParent && (this.scrollParent = d, this.scrollAnchorHeight = -1, this.scrollOffset = 0);
      let p = this.getScrollOffset();
      this.scrollOffset != p && (this.scrollAnchorHeight = -1, this.scrollOffset = p), this.scrolledToBottom = Ka(this.scrollParent || e.win);
      let m = (this.printing ? Nu : Pu)(t, this.paddingTop), g = m.top - this.pixelViewport.top, y = m.bottom - this.pixelViewport.bottom;
      this.pixelViewport = m;
      let v = this.pixelViewport.bottom > this.pixelViewport.top && this.pixelViewport.right > this.pixelViewport.left;
      if (v != this.inView && (this.inView = v, v && (a = true)), !this.inView && !this.scrollTarget && !Iu(e.dom)) return 0;
      let b = l.width;
      if ((this.contentDOMWidth != b || this.editorHeight != e.scrollDOM.clientHeight) && (this.contentDOMWidth = l.width, this.editorHeight = e.scrollDOM.clientHeight, h |= 16), a) {
        let w = e.docView.measureVisibleLineHeights(this.viewport);
        if (s.mustRefreshForHeights(w) && (o = true), o || s.lineWrapping && Math.abs(b - this.contentDOMWidth) > s.charWidth) {
          let { lineHeight: k, charWidth: S2, textHeight: R } = e.docView.measureTextSize();
          o = k > 0 && s.refresh(r, k, S2, R, Math.max(5, b / S2), w), o && (e.docView.minWidth = 0, h |= 16);
        }
        g > 0 && y > 0 ? c = Math.max(g, y) : g < 0 && y < 0 && (c = Math.min(g, y)), ba();
        for (let k of this.viewports) {
          let S2 = k.from == this.viewport.from ? w : e.docView.measureVisibleLineHeights(k);
          this.heightMap = (o ? ke.empty().applyChanges(this.stateDeco, F.empty, this.heightOracle, [new We(0, 0, 0, e.state.doc.length)]) : this.heightMap).updateHeight(s, 0, o, new jr2(k.from, S2));
        }
        hi2 && (h |= 2);
      }
      let D = !this.viewportIsAppropriate(this.viewport, c) || this.scrollTarget && (this.scrollTarget.range.head < this.viewport.from || this.scrollTarget.range.head > this.viewport.to);
      return D && (h & 2 && (h |= this.updateScaler()), this.viewport = this.getViewport(c, this.scrollTarget), h |= this.updateForViewport()), (h & 2 || D) && this.updateViewportLines(), (this.lineGaps.length || this.viewport.to - this.viewport.from > 4e3) && this.updateLineGaps(this.ensureLineGaps(o ? [] : this.lineGaps, e)), h |= this.computeVisibleRanges(), this.mustEnforceCursorAssoc && (this.mustEnforceCursorAssoc = false, e.docView.enforceCursorAssoc()), h;
    }
    get visibleTop() {
      return this.scaler.fromDOM(this.pixelViewport.top);
    }
    get visibleBottom() {
      return this.scaler.fromDOM(this.pixelViewport.bottom);
    }
    getViewport(e, t) {
      let i = 0.5 - Math.max(-0.5, Math.min(0.5, e / 1e3 / 2)), s = this.heightMap, r = this.heightOracle, { visibleTop: o, visibleBottom: l } = this, a = new Qt2(s.lineAt(o - i * 1e3, j.ByHeight, r, 0, 0).from, s.lineAt(l + (1 - i) * 1e3, j.ByHeight, r, 0, 0).to);
      if (t) {
        let { head: h } = t.range;
        if (h < a.from || h > a.to) {
          let c = Math.min(this.editorHeight, this.pixelViewport.bottom - this.pixelViewport.top), f = s.lineAt(h, j.ByPos, r, 0, 0), u;
          t.y == "center" ? u = (f.top + f.bottom) / 2 - c / 2 : t.y == "start" || t.y == "nearest" && h < a.from ? u = f.top : u = f.bottom - c, a = new Qt2(s.lineAt(u - 1e3 / 2, j.ByHeight, r, 0, 0).from, s.lineAt(u + c + 1e3 / 2, j.ByHeight, r, 0, 0).to);
        }
      }
      return a;
    }
    mapViewport(e, t) {
      let i = t.mapPos(e.from, -1), s = t.mapPos(e.to, 1);
      return new Qt2(this.heightMap.lineAt(i, j.ByPos, this.heightOracle, 0, 0).from, this.heightMap.lineAt(s, j.ByPos, this.heightOracle, 0, 0).to);
    }
    viewportIsAppropriate({ from: e, to: t }, i = 0) {
      if (!this.inView) return true;
      let { top: s } = this.heightMap.lineAt(e, j.ByPos, this.heightOracle, 0, 0), { bottom: r } = this.heightMap.lineAt(t, j.ByPos, this.heightOracle, 0, 0), { visibleTop: o, visibleBottom: l } = this;
      return (e == 0 || s <= o - Math.max(10, Math.min(-i, 250))) && (t == this.state.doc.length || r >= l + Math.max(10, Math.min(i, 250))) && s > o - 2 * 1e3 && r < l + 2 * 1e3;
    }
    mapLineGaps(e, t) {
      if (!e.length || t.empty) return e;
      let i = [];
      for (let s of e) t.touchesRange(s.from, s.to) || i.push(new Pi(t.mapPos(s.from), t.mapPos(s.to), s.size, s.displaySize));
      return i;
    }
    ensureLineGaps(e, t) {
      let i = this.heightOracle.lineWrapping, s = i ? 1e4 : 2e3, r = s >> 1, o = s << 1;
      if (this.defaultTextDirection != V.LTR && !i) return [];
      let l = [], a = (c, f, u, d) => {
        if (f - c < r) return;
        let p = this.state.selection.main, m = [p.from];
        p.empty || m.push(p.to);
        for (let y of m) if (y > c && y < f) {
          a(c, y - 10, u, d), a(y + 10, f, u, d);
          return;
        }
        let g = Hu(e, (y) => y.from >= u.from && y.to <= u.to && Math.abs(y.from - c) < r && Math.abs(y.to - f) < r && !m.some((v) => y.from < v && y.to > v));
        if (!g) {
          if (f < u.to && t && i && t.visibleRanges.some((b) => b.from <= f && b.to >= f)) {
            let b = t.moveToLineBoundary(x.cursor(f), false, true).head;
            b > c && (f = b);
          }
          let y = this.gapSize(u, c, f, d), v = i || y < 2e6 ? y : 2e6;
          g = new Pi(c, f, y, v);
        }
        l.push(g);
      }, h = (c) => {
        if (c.length < o || c.type != ae2.Text) return;
        let f = Fu(c.from, c.to, this.stateDeco);
        if (f.total < o) return;
        let u = this.scrollTarget ? this.scrollTarget.range.head : null, d, p;
        if (i) {
          let m = s / this.heightOracle.lineLength * this.heightOracle.lineHeight, g, y;
          if (u != null) {
            let v = Cn(f, u), b = ((this.visibleBottom - this.visibleTop) / 2 + m) / c.height;
            g = v - b, y = v + b;
          } else g = (this.visibleTop - c.top - m) / c.height, y = (this.visibleBottom - c.top + m) / c.height;
          d = Sn(f, g), p = Sn(f, y);
        } else {
          let m = f.total * this.heightOracle.charWidth, g = s * this.heightOracle.charWidth, y = 0;
          if (m > 2e6) for (let k of e) k.from >= c.from && k.from < c.to && k.size != k.displaySize && k.from * this.heightOracle.charWidth + y < this.pixelViewport.left && (y = k.size - k.displaySize);
          let v = this.pixelViewport.left + y, b = this.pixelViewport.right + y, D, w;
          if (u != null) {
            let k = Cn(f, u), S2 = ((b - v) / 2 + g) / m;
            D = k - S2, w = k + S2;
          } else D = (v - g) / m, w = (b + g) / m;
          d = Sn(f, D), p = Sn(f, w);
        }
        d > c.from && a(c.from, d, c, f), p < c.to && a(p, c.to, c, f);
      };
      for (let c of this.viewportLines) Array.isArray(c.type) ? c.type.forEach(h) : h(c);
      return l;
    }
    gapSize(e, t, i, s) {
      let r = Cn(s, i) - Cn(s, t);
      return this.heightOracle.lineWrapping ? e.height * r : s.total * this.heightOracle.charWidth * r;
    }
    updateLineGaps(e) {
      Pi.same(e, this.lineGaps) || (this.lineGaps = e, this.lineGapDeco = L.set(e.map((t) => t.draw(this, this.heightOracle.lineWrapping))));
    }
    computeVisibleRanges(e) {
      let t = this.stateDeco;
      this.lineGaps.length && (t = t.concat(this.lineGapDeco));
      let i = [];
      z.spans(t, this.viewport.from, this.viewport.to, { span(r, o) {
        i.push({ from: r, to: o });
      }, point() {
      } }, 20);
      let s = 0;
      if (i.length != this.visibleRanges.length) s = 12;
      else for (let r = 0; r < i.length && !(s & 8); r++) {
        let o = this.visibleRanges[r], l = i[r];
        (o.from != l.from || o.to != l.to) && (s |= 4, e && e.mapPos(o.from, -1) == l.from && e.mapPos(o.to, 1) == l.to || (s |= 8));
      }
      return this.visibleRanges = i, s;
    }
    lineBlockAt(e) {
      return e >= this.viewport.from && e <= this.viewport.to && this.viewportLines.find((t) => t.from <= e && t.to >= e) || Ti(this.heightMap.lineAt(e, j.ByPos, this.heightOracle, 0, 0), this.scaler);
    }
    lineBlockAtHeight(e) {
      return e >= this.viewportLines[0].top && e <= this.viewportLines[this.viewportLines.length - 1].bottom && this.viewportLines.find((t) => t.top <= e && t.bottom >= e) || Ti(this.heightMap.lineAt(this.scaler.fromDOM(e), j.ByHeight, this.heightOracle, 0, 0), this.scaler);
    }
    getScrollOffset() {
      return this.scrollParent == this.view.scrollDOM ? this.scrollParent.scrollTop * this.scaleY : (this.scrollParent ? this.scrollParent.getBoundingClientRect().top : 0) - this.view.contentDOM.getBoundingClientRect().top;
    }
    scrollAnchorAt(e) {
      let t = this.lineBlockAtHeight(e + 12 - this.paddingTop);
      return t.from >= this.viewport.from || this.viewportLines[0].top - e > 200 ? t : this.viewportLines[0];
    }
    elementAtHeight(e) {
      return Ti(this.heightMap.blockAt(this.scaler.fromDOM(e), this.heightOracle, 0, 0), this.scaler);
    }
    get docHeight() {
      return this.scaler.toDOM(this.heightMap.height);
    }
    get contentHeight() {
      return this.docHeight + this.paddingTop + this.paddingBottom;
    }
  };
  var Qt2 = class {
    constructor(e, t) {
      this.from = e, this.to = t;
    }
  };
  function Fu(n66, e, t) {
    let i = [], s = n66, r = 0;
    return z.spans(t, n66, e, { span() {
    }, point(o, l) {
      o > s && (i.push({ from: s, to: o }), r += o - s), s = l;
    } }, 20), s < e && (i.push({ from: s, to: e }), r += e - s), { total: r, ranges: i };
  }
  function Sn({ total: n66, ranges: e }, t) {
    if (t <= 0) return e[0].from;
    if (t >= 1) return e[e.length - 1].to;
    let i = Math.floor(n66 * t);
    for (let s = 0; ; s++) {
      let { from: r, to: o } = e[s], l = o - r;
      if (i <= l) return r + i;
      i -= l;
    }
  }
  function Cn(n66, e) {
    let t = 0;
    for (let { from: i, to: s } of n66.ranges) {
      if (e <= s) {
        t += e - i;
        break;
      }
      t += s - i;
    }
    return t / n66.total;
  }
  function Hu(n66, e) {
    for (let t of n66) if (e(t)) return t;
  }
  var Xr2 = { toDOM(n66) {
    return n66;
  }, fromDOM(n66) {
    return n66;
  }, scale: 1, eq(n66) {
    return n66 == this;
  } };
  function wa(n66) {
    let e = n66.facet(Zn2).filter((i) => typeof i != "function"), t = n66.facet(vo2).filter((i) => typeof i != "function");
    return t.length && e.push(z.join(t)), e;
  }
  var Jr2 = class n39 {
    constructor(e, t) {
      this.scale = e, this.viewports = t;
    }
    static get(e, t, i) {
      let s = 0, r = 0, o = 0, l = i.map(({ from: h, to: c }) => {
        let f = t.lineAt(h, j.ByPos, e, 0, 0).top, u = t.lineAt(c, j.ByPos, e, 0, 0).bottom;
        return s += u - f, { from: h, to: c, top: f, bottom: u, domTop: 0, domBottom: 0 };
      });
      if (t.height - s < 10) return Xr2;
      let a = (7e6 - s) / (t.height - s);
      for (let h of l) h.domTop = o + (h.top - r) * a, o = h.domBottom = h.domTop + (h.bottom - h.top), r = h.bottom;
      return new n39(a, l);
    }
    toDOM(e) {
      for (let t = 0, i = 0, s = 0; ; t++) {
        let r = t < this.viewports.length ? this.viewports[t] : null;
        if (!r || e < r.top) return s + (e - i) * this.scale;
        if (e <= r.bottom) return r.domTop + (e - r.top);
        i = r.bottom, s = r.domBottom;
      }
    }
    fromDOM(e) {
      for (let t = 0, i = 0, s = 0; ; t++) {
        let r = t < this.viewports.length ? this.viewports[t] : null;
        if (!r || e < r.domTop) return i + (e - s) / this.scale;
        if (e <= r.domBottom) return r.top + (e - r.domTop);
        i = r.bottom, s = r.domBottom;
      }
    }
    eq(e) {
      return e instanceof n39 ? this.scale == e.scale && this.viewports.length == e.viewports.length && this.viewports.every((t, i) => t.from == e.viewports[i].from && t.to == e.viewports[i].to) : false;
    }
  };
  function Ti(n66, e) {
    if (e.scale == 1) return n66;
    let t = e.toDOM(n66.top), i = e.toDOM(n66.bottom);
    return new He2(n66.from, n66.length, t, i - t, Array.isArray(n66._content) ? n66._content.map((s) => Ti(s, e)) : n66._content);
  }
  var An = T.define({ combine: (n66) => n66.join(" ") });
  var Qr2 = T.define({ combine: (n66) => n66.indexOf(true) > -1 });
  var Zr2 = Oe.newName();
  var Mh = Oe.newName();
  var Th = Oe.newName();
  var Dh = { "&light": "." + Mh, "&dark": "." + Th };
  function eo2(n66, e, t) {
    return new Oe(e, { finish(i) {
      return /&/.test(i) ? i.replace(/&\w*/, (s) => {
        if (s == "&") return n66;
        if (!t || !t[s]) throw new RangeError(`Unsupported selector: ${s}`);
        return t[s];
      }) : n66 + " " + i;
    } });
  }
  var Wu = eo2("." + Zr2, { "&": { position: "relative !important", boxSizing: "border-box", "&.cm-focused": { outline: "1px dotted #212121" }, display: "flex !important", flexDirection: "column" }, ".cm-scroller": { display: "flex !important", alignItems: "flex-start !important", fontFamily: "monospace", lineHeight: 1.4, height: "100%", overflowX: "auto", position: "relative", zIndex: 0, overflowAnchor: "none" }, ".cm-content": { margin: 0, flexGrow: 2, flexShrink: 0, display: "block", whiteSpace: "pre", wordWrap: "normal", boxSizing: "border-box", minHeight: "100%", padding: "4px 0", outline: "none", "&[contenteditable=true]": { WebkitUserModify: "read-write-plaintext-only" } }, ".cm-lineWrapping": { whiteSpace_fallback: "pre-wrap", whiteSpace: "break-spaces", wordBreak: "break-word", overflowWrap: "anywhere", flexShrink: 1 }, "&light .cm-content": { caretColor: "black" }, "&dark .cm-content": { caretColor: "white" }, ".cm-line": { display: "block", padding: "0 2px 0 6px" }, ".cm-layer": { userSelect: "none", position: "absolute", left: 0, top: 0, contain: "size style", "& > *": { position: "absolute" } }, "&light .cm-selectionBackground": { background: "#d9d9d9" }, "&dark .cm-selectionBackground": { background: "#222" }, "&light.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground": { background: "#d7d4f0" }, "&dark.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground": { background: "#233" }, ".cm-cursorLayer": { pointerEvents: "none" }, "&.cm-focused > .cm-scroller > .cm-cursorLayer": { animation: "steps(1) cm-blink 1.2s infinite" }, "@keyframes cm-blink": { "0%": {}, "50%": { opacity: 0 }, "100%": {} }, "@keyframes cm-blink2": { "0%": {}, "50%": { opacity: 0 }, "100%": {} }, ".cm-cursor, .cm-dropCursor": { borderLeft: "1.2px solid black", marginLeft: "-0.6px", pointerEvents: "none" }, ".cm-cursor": { display: "none" }, "&dark .cm-cursor": { borderLeftColor: "#ddd" }, ".cm-selectionHandle": { backgroundColor: "currentColor", width: "1.5px" }, ".cm-selectionHandle-start::before, .cm-selectionHandle-end::before": { content: '""', backgroundColor: "inherit", borderRadius: "50%", width: "8px", height: "8px", position: "absolute", left: "-3.25px" }, ".cm-selectionHandle-start::before": { top: "-8px" }, ".cm-selectionHandle-end::before": { bottom: "-8px" }, ".cm-dropCursor": { position: "absolute" }, "&.cm-focused > .cm-scroller > .cm-cursorLayer .cm-cursor": { display: "block" }, ".cm-iso": { unicodeBidi: "isolate" }, ".cm-announced": { position: "fixed", top: "-10000px" }, "@media print": { ".cm-announced": { display: "none" } }, "&light .cm-activeLine": { backgroundColor: "#cceeff44" }, "&dark .cm-activeLine": { backgroundColor: "#99eeff33" }, "&light .cm-specialChar": { color: "red" }, "&dark .cm-specialChar": { color: "#f78" }, ".cm-gutters": { flexShrink: 0, display: "flex", height: "100%", boxSizing: "border-box", zIndex: 200 }, ".cm-gutters-before": { insetInlineStart: 0 }, ".cm-gutters-after": { insetInlineEnd: 0 }, "&light .cm-gutters": { backgroundColor: "#f5f5f5", color: "#6c6c6c", border: "0px solid #ddd", "&.cm-gutters-before": { borderRightWidth: "1px" }, "&.cm-gutters-after": { borderLeftWidth: "1px" } }, "&dark .cm-gutters": { backgroundColor: "#333338", color: "#ccc" }, ".cm-gutter": { display: "flex !important", flexDirection: "column", flexShrink: 0, boxSizing: "border-box", minHeight: "100%", overflow: "hidden" }, ".cm-gutterElement": { boxSizing: "border-box" }, ".cm-lineNumbers .cm-gutterElement": { padding: "0 3px 0 5px", minWidth: "20px", textAlign: "right", whiteSpace: "nowrap" }, "&light .cm-activeLineGutter": { backgroundColor: "#e2f2ff" }, "&dark .cm-activeLineGutter": { backgroundColor: "#222227" }, ".cm-panels": { boxSizing: "border-box", position: "sticky", left: 0, right: 0, zIndex: 300 }, "&light .cm-panels": { backgroundColor: "#f5f5f5", color: "black" }, ".cm-panels-top": { top: "0" }, ".cm-panels-bottom": { bottom: "0" }, "&light .cm-panels-top": { borderBottom: "1px solid #ddd" }, "&light .cm-panels-bottom": { borderTop: "1px solid #ddd" }, "&dark .cm-panels": { backgroundColor: "#333338", color: "white" }, ".cm-dialog": { padding: "2px 19px 4px 6px", position: "relative", "& label": { fontSize: "80%" } }, ".cm-dialog-close": { position: "absolute", top: "3px", right: "4px", backgroundColor: "inherit", border: "none", font: "inherit", fontSize: "14px", padding: "0" }, ".cm-tab": { display: "inline-block", overflow: "hidden", verticalAlign: "bottom" }, ".cm-widgetBuffer": { verticalAlign: "baseline", height: "1em", width: 0, display: "inline" }, ".cm-placeholder": { color: "#888", display: "inline-block", verticalAlign: "top", userSelect: "none" }, ".cm-highlightSpace": { background: "radial-gradient(circle at 50% 55%, #aaa 20%, transparent 0) no-repeat", backgroundSize: ".4em", backgroundPosition: "calc(min(50%, 0px)) center" }, ".cm-highlightTab": { backgroundImage: `url('data:image/svg+xml,<svg xmlns="http://www.w3.org/2000/svg" width="200" height="20"><path stroke="%23888" stroke-width="1" fill="none" d="M1 10H196L190 5M190 15L196 10M197 4L197 16"/></svg>')`, backgroundSize: "auto 100%", backgroundPosition: "right 90%", backgroundRepeat: "no-repeat" }, ".cm-trailingSpace": { backgroundColor: "#ff332255" }, ".cm-button": { verticalAlign: "middle", color: "inherit", fontSize: "70%", padding: ".2em 1em", borderRadius: "1px" }, "&light .cm-button": { backgroundImage: "linear-gradient(#eff1f5, #d9d9df)", border: "1px solid #888", "&:active": { backgroundImage: "linear-gradient(#b4b4b4, #d0d3d6)" } }, "&dark .cm-button": { backgroundImage: "linear-gradient(#393939, #111)", border: "1px solid #888", "&:active": { backgroundImage: "linear-gradient(#111, #333)" } }, ".cm-textfield": { verticalAlign: "middle", color: "inherit", fontSize: "70%", border: "1px solid silver", padding: ".2em .5em" }, "&light .cm-textfield": { backgroundColor: "white" }, "&dark .cm-textfield": { border: "1px solid #555", backgroundColor: "inherit" } }, Dh);
  var Vu = { childList: true, characterData: true, subtree: true, attributes: true, characterDataOldValue: true };
  var ur2 = A.ie && A.ie_version <= 11;
  var to2 = class {
    constructor(e) {
      this.view = e, this.active = false, this.editContext = null, this.selectionRange = new kr2(), this.selectionChanged = false, this.delayedFlush = -1, this.resizeTimeout = -1, this.queue = [], this.delayedAndroidKey = null, this.flushingAndroidKey = -1, this.lastChange = 0, this.scrollTargets = [], this.intersection = null, this.resizeScroll = null, this.intersecting = false, this.gapIntersection = null, this.gaps = [], this.printQuery = null, this.parentCheck = -1, this.dom = e.contentDOM, this.observer = new MutationObserver((t) => {
        for (let i of t) this.queue.push(i);
        (A.ie && A.ie_version <= 11 || A.ios && e.composing) && t.some((i) => i.type == "childList" && i.removedNodes.length || i.type == "characterData" && i.oldValue.length > i.target.nodeValue.length) ? this.flushSoon() : this.flush();
      }), window.EditContext && A.android && e.constructor.EDIT_CONTEXT !== false && !(A.chrome && A.chrome_version < 126) && (this.editContext = new io2(e), e.state.facet(at) && (e.contentDOM.editContext = this.editContext.editContext)), ur2 && (this.onCharData = (t) => {
        this.queue.push({ target: t.target, type: "characterData", oldValue: t.prevValue }), this.flushSoon();
      }), this.onSelectionChange = this.onSelectionChange.bind(this), this.onResize = this.onResize.bind(this), this.onPrint = this.onPrint.bind(this), this.onScroll = this.onScroll.bind(this), window.matchMedia && (this.printQuery = window.matchMedia("print")), typeof ResizeObserver == "function" && (this.resizeScroll = new ResizeObserver(() => {
        var t;
        ((t = this.view.docView) === null || t === void 0 ? void 0 : t.lastUpdate) < Date.now() - 75 && this.onResize();
      }), this.resizeScroll.observe(e.scrollDOM)), this.addWindowListeners(this.win = e.win), this.start(), typeof IntersectionObserver == "function" && (this.intersection = new IntersectionObserver((t) => {
        this.parentCheck < 0 && (this.parentCheck = setTimeout(this.listenForScroll.bind(this), 1e3)), t.length > 0 && t[t.length - 1].intersectionRatio > 0 != this.intersecting && (this.intersecting = !this.intersecting, this.intersecting != this.view.inView && this.onScrollChanged(document.createEvent("Event")));
      }, { threshold: [0, 1e-3] }), this.intersection.observe(this.dom), this.gapIntersection = new IntersectionObserver((t) => {
        t.length > 0 && t[t.length - 1].intersectionRatio > 0 && this.onScrollChanged(document.createEvent("Event"));
      }, {})), this.listenForScroll(), this.readSelectionRange();
    }
    onScrollChanged(e) {
      this.view.inputState.runHandlers("scroll", e), this.intersecting && this.view.measure();
    }
    onScroll(e) {
      this.intersecting && this.flush(this.pendingRecords().length > 0), this.editContext && this.view.requestMeasure(this.editContext.measureReq), this.onScrollChanged(e);
    }
    onResize() {
      this.resizeTimeout < 0 && (this.resizeTimeout = setTimeout(() => {
        this.resizeTimeout = -1, this.view.requestMeasure();
      }, 50));
    }
    onPrint(e) {
      (e.type == "change" || !e.type) && !e.matches || (this.view.viewState.printing = true, this.view.measure(), setTimeout(() => {
        this.view.viewState.printing = false, this.view.requestMeasure();
      }, 500));
    }
    updateGaps(e) {
      if (this.gapIntersection && (e.length != this.gaps.length || this.gaps.some((t, i) => t != e[i]))) {
        this.gapIntersection.disconnect();
        for (let t of e) this.gapIntersection.observe(t);
        this.gaps = e;
      }
    }
    onSelectionChange(e) {
      let t = this.selectionChanged;
      if (!this.readSelectionRange() || this.delayedAndroidKey) return;
      let { view: i } = this, s = this.selectionRange;
      if (i.state.facet(at) ? i.root.activeElement != this.dom : !Di(this.dom, s)) return;
      let r = s.anchorNode && i.docView.tile.nearest(s.anchorNode);
      if (r && r.isWidget() && r.widget.ignoreEvent(e)) {
        t || (this.selectionChanged = false);
        return;
      }
      (A.ie && A.ie_version <= 11 || A.android && A.chrome) && !i.state.selection.main.empty && s.focusNode && Oi(s.focusNode, s.focusOffset, s.anchorNode, s.anchorOffset) ? this.flushSoon() : this.flush(false);
    }
    readSelectionRange() {
      let { view: e } = this, t = Hi(e.root);
      if (!t) return false;
      let i = A.safari && e.root.nodeType == 11 && e.root.activeElement == this.dom && zu(this.view, t) || t;
      if (!i || this.selectionRange.eq(i)) return false;
      let s = Di(this.dom, i);
      return s && !this.selectionChanged && e.inputState.lastFocusTime > Date.now() - 200 && e.inputState.lastTouchTime < Date.now() - 300 && If2(this.dom, i) ? (this.view.inputState.lastFocusTime = 0, e.docView.updateSelection(), false) : (this.selectionRange.setRange(i), s && (this.selectionChanged = true), true);
    }
    setSelectionRange(e, t) {
      this.selectionRange.set(e.node, e.offset, t.node, t.offset), this.selectionChanged = false;
    }
    clearSelectionRange() {
      this.selectionRange.set(null, 0, null, 0);
    }
    listenForScroll() {
      this.parentCheck = -1;
      let e = 0, t = null;
      for (let i = this.dom; i; ) if (ne2(i)) !t && e < this.scrollTargets.length && this.scrollTargets[e] == i ? e++ : t || (t = this.scrollTargets.slice(0, e)), t && t.push(i), i = i.assignedSlot || i.parentNode;
      else if (i.nodeType == 11) i = i.host;
      else break;
      if (e < this.scrollTargets.length && !t && (t = this.scrollTargets.slice(0, e)), t) {
        for (let i of this.scrollTargets) i.removeEventListener("scroll", this.onScroll);
        for (let i of this.scrollTargets = t) i.addEventListener("scroll", this.onScroll);
      }
    }
    ignore(e) {
      if (!this.active) return e();
      try {
        return this.stop(), e();
      } finally {
        this.start(), this.clear();
      }
    }
    start() {
      this.active || (this.observer.observe(this.dom, Vu), ur2 && this.dom.addEventListener("DOMCharacterDataModified", this.onCharData), this.active = true);
    }
    stop() {
      this.active && (this.active = false, this.observer.disconnect(), ur2 && this.dom.removeEventListener("DOMCharacterDataModified", this.onCharData));
    }
    clear() {
      this.processRecords(), this.queue.length = 0, this.selectionChanged = false;
    }
    delayAndroidKey(e, t) {
      var i;
      if (!this.delayedAndroidKey) {
        let s = () => {
          let r = this.delayedAndroidKey;
          r && (this.clearDelayedAndroidKey(), this.view.inputState.lastKeyCode = r.keyCode, this.view.inputState.lastKeyTime = Date.now(), !this.flush() && r.force && ii2(this.dom, r.key, r.keyCode));
        };
        this.flushingAndroidKey = this.view.win.requestAnimationFrame(s);
      }
      (!this.delayedAndroidKey || e == "Enter") && (this.delayedAndroidKey = { key: e, keyCode: t, force: this.lastChange < Date.now() - 50 || !!(!((i = this.delayedAndroidKey) === null || i === void 0) && i.force) });
    }
    clearDelayedAndroidKey() {
      this.win.cancelAnimationFrame(this.flushingAndroidKey), this.delayedAndroidKey = null, this.flushingAndroidKey = -1;
    }
    flushSoon() {
      this.delayedFlush < 0 && (this.delayedFlush = this.view.win.requestAnimationFrame(() => {
        this.delayedFlush = -1, this.flush();
      }));
    }
    forceFlush() {
      this.delayedFlush >= 0 && (this.view.win.cancelAnimationFrame(this.delayedFlush), this.delayedFlush = -1), this.flush();
    }
    pendingRecords() {
      for (let e of this.observer.takeRecords()) this.queue.push(e);
      return this.queue;
    }
    processRecords() {
      let e = this.pendingRecords();
      e.length && (this.queue = []);
      let t = -1, i = -1, s = false;
      for (let r of e) {
        let o = this.readMutation(r);
        o && (o.typeOver && (s = true), t == -1 ? { from: t, to: i } = o : (t = Math.min(o.from, t), i = Math.max(o.to, i)));
      }
      return { from: t, to: i, typeOver: s };
    }
    readChange() {
      let { from: e, to: t, typeOver: i } = this.processRecords(), s = this.selectionChanged && Di(this.dom, this.selectionRange);
      if (e < 0 && !s) return null;
      e > -1 && (this.lastChange = Date.now()), this.view.inputState.lastFocusTime = 0, this.selectionChanged = false;
      let r = new Wr2(this.view, e, t, i);
      return this.view.docView.domChanged = { newSel: r.newSel ? r.newSel.main : null }, r;
    }
    flush(e = true) {
      if (this.delayedFlush >= 0 || this.delayedAndroidKey) return false;
      e && this.readSelectionRange();
      let t = this.selectionChanged, i = this.readChange();
      if (!i) return this.view.requestMeasure(), false;
      let s = this.view.state, r = gh(this.view, i);
      return this.view.state == s && (i.domChanged || t) && this.view.update([]), r;
    }
    readMutation(e) {
      let t = this.view.docView.tile.nearest(e.target);
      if (!t || t.isWidget()) return null;
      if (t.markDirty(e.type == "attributes"), e.type == "childList") {
        let i = va(t, e.previousSibling || e.target.previousSibling, -1), s = va(t, e.nextSibling || e.target.nextSibling, 1);
        return { from: i ? t.posAfter(i) : t.posAtStart, to: s ? t.posBefore(s) : t.posAtEnd, typeOver: false };
      } else return e.type == "characterData" ? { from: t.posAtStart, to: t.posAtEnd, typeOver: e.target.nodeValue == e.oldValue } : null;
    }
    setWindow(e) {
      e != this.win && (this.removeWindowListeners(this.win), this.win = e, this.addWindowListeners(this.win));
    }
    addWindowListeners(e) {
      e.addEventListener("resize", this.onResize), this.printQuery ? this.printQuery.addEventListener ? this.printQuery.addEventListener("change", this.onPrint) : this.printQuery.addListener(this.onPrint) : e.addEventListener("beforeprint", this.onPrint), e.addEventListener("scroll", this.onScroll), e.document.addEventListener("selectionchange", this.onSelectionChange);
    }
    removeWindowListeners(e) {
      e.removeEventListener("scroll", this.onScroll), e.removeEventListener("resize", this.onResize), this.printQuery ? this.printQuery.removeEventListener ? this.printQuery.removeEventListener("change", this.onPrint) : this.printQuery.removeListener(this.onPrint) : e.removeEventListener("beforeprint", this.onPrint), e.document.removeEventListener("selectionchange", this.onSelectionChange);
    }
    update(e) {
      this.editContext && (this.editContext.update(e), e.startState.facet(at) != e.state.facet(at) && (e.view.contentDOM.editContext = e.state.facet(at) ? this.editContext.editContext : null));
    }
    destroy() {
      var e, t, i;
      this.stop(), (e = this.intersection) === null || e === void 0 || e.disconnect(), (t = this.gapIntersection) === null || t === void 0 || t.disconnect(), (i = this.resizeScroll) === null || i === void 0 || i.disconnect();
      for (let s of this.scrollTargets) s.removeEventListener("scroll", this.onScroll);
      this.removeWindowListeners(this.win), clearTimeout(this.parentCheck), clearTimeout(this.resizeTimeout), this.win.cancelAnimationFrame(this.delayedFlush), this.win.cancelAnimationFrame(this.flushingAndroidKey), this.editContext && (this.view.contentDOM.editContext = null, this.editContext.destroy());
    }
  };
  function va(n66, e, t) {
    for (; e; ) {
      let i = Y.get(e);
      if (i && i.parent == n66) return i;
      let s = e.parentNode;
      e = s != n66.dom ? s : t > 0 ? e.nextSibling : e.previousSibling;
    }
    return null;
  }
  function ka(n66, e) {
    let t = e.startContainer, i = e.startOffset, s = e.endContainer, r = e.endOffset, o = n66.docView.domAtPos(n66.state.selection.main.anchor, 1);
    return Oi(o.node, o.offset, s, r) && ([t, i, s, r] = [s, r, t, i]), { anchorNode: t, anchorOffset: i, focusNode: s, focusOffset: r };
  }
  function zu(n66, e) {
    if (e.getComposedRanges) {
      let s = e.getComposedRanges(n66.root)[0];
      if (s) return ka(n66, s);
    }
    let t = null;
    function i(s) {
      s.preventDefault(), s.stopImmediatePropagation(), t = s.getTargetRanges()[0];
    }
    return n66.contentDOM.addEventListener("beforeinput", i, true), n66.dom.ownerDocument.execCommand("indent"), n66.contentDOM.removeEventListener("beforeinput", i, true), t ? ka(n66, t) : null;
  }
  var io2 = class {
    constructor(e) {
      this.from = 0, this.to = 0, this.pendingContextChange = null, this.handlers = /* @__PURE__ */ Object.create(null), this.composing = null, this.resetRange(e.state);
      let t = this.editContext = new window.EditContext({ text: e.state.doc.sliceString(this.from, this.to), selectionStart: this.toContextPos(Math.max(this.from, Math.min(this.to, e.state.selection.main.anchor))), selectionEnd: this.toContextPos(e.state.selection.main.head) });
      this.handlers.textupdate = (i) => {
        let s = e.state.selection.main, { anchor: r, head: o } = s, l = this.toEditorPos(i.updateRangeStart), a = this.toEditorPos(i.updateRangeEnd);
        e.inputState.composing >= 0 && !this.composing && (this.composing = { contextBase: i.updateRangeStart, editorBase: l, drifted: false });
        let h = a - l > i.text.length;
        l == this.from && r < this.from ? l = r : a == this.to && r > this.to && (a = r);
        let c = yh(e.state.sliceDoc(l, a), i.text, (h ? s.from : s.to) - l, h ? "end" : null);
        if (!c) {
          let u = x.single(this.toEditorPos(i.selectionStart), this.toEditorPos(i.selectionEnd));
          Vr2(u, s) || e.dispatch({ selection: u, userEvent: "select" });
          return;
        }
        let f = { from: c.from + l, to: c.toA + l, insert: F.of(i.text.slice(c.from, c.toB).split(`
`)) };
        if ((A.mac || A.android) && f.from == o - 1 && /^\. ?$/.test(i.text) && e.contentDOM.getAttribute("autocorrect") == "off" && (f = { from: l, to: a, insert: F.of([i.text.replace(".", " ")]) }), this.pendingContextChange = f, !e.state.readOnly) {
          let u = this.to - this.from + (f.to - f.from + f.insert.length);
          So2(e, f, x.single(this.toEditorPos(i.selectionStart, u), this.toEditorPos(i.selectionEnd, u)));
        }
        this.pendingContextChange && (this.revertPending(e.state), this.setSelection(e.state)), f.from < f.to && !f.insert.length && e.inputState.composing >= 0 && !/[\\p{Alphabetic}\\p{Number}_]/.test(t.text.slice(Math.max(0, i.updateRangeStart - 1), Math.min(t.text.length, i.updateRangeStart + 1))) && this.handlers.compositionend(i);
      }, this.handlers.characterboundsupdate = (i) => {
        let s = [], r = null;
        for (let o = this.toEditorPos(i.rangeStart), l = this.toEditorPos(i.rangeEnd); o < l; o++) {
          let a = e.coordsForChar(o);
          r = a && new DOMRect(a.left, a.top, a.right - a.left, a.bottom - a.top) || r || new DOMRect(), s.push(r);
        }
        t.updateCharacterBounds(i.rangeStart, s);
      }, this.handlers.textformatupdate = (i) => {
        let s = [];
        for (let r of i.getTextFormats()) {
          let o = r.underlineStyle, l = r.underlineThickness;
          if (!/none/i.test(o) && !/none/i.test(l)) {
            let a = this.toEditorPos(r.rangeStart), h = this.toEditorPos(r.rangeEnd);
            if (a < h) {
              let c = `text-decoration: underline ${/^[a-z]/.test(o) ? o + " " : o == "Dashed" ? "dashed " : o == "Squiggle" ? "wavy " : ""}${/thin/i.test(l) ? 1 : 2}px`;
              s.push(L.mark({ attributes: { style: c } }).range(a, h));
            }
          }
        }
        e.dispatch({ effects: oh.of(L.set(s)) });
      }, this.handlers.compositionstart = () => {
        e.inputState.composing < 0 && (e.inputState.composing = 0, e.inputState.compositionFirstChange = true);
      }, this.handlers.compositionend = () => {
        if (e.inputState.composing = -1, e.inputState.compositionFirstChange = null, this.composing) {
          let { drifted: i } = this.composing;
          this.composing = null, i && this.reset(e.state);
        }
      };
      for (let i in this.handlers) t.addEventListener(i, this.handlers[i]);
      this.measureReq = { read: (i) => {
        let s = Hi(i.root);
        s && s.rangeCount && this.editContext.updateSelectionBounds(s.getRangeAt(0).getBoundingClientRect());
      } };
    }
    applyEdits(e) {
      let t = 0, i = false, s = this.pendingContextChange;
      return e.changes.iterChanges((r, o, l, a, h) => {
        if (i) return;
        let c = h.length - (o - r);
        if (s && o >= s.to) if (s.from == r && s.to == o && s.insert.eq(h)) {
          s = this.pendingContextChange = null, t += c, this.to += c;
          return;
        } else s = null, this.revertPending(e.state);
        if (r += t, o += t, o <= this.from) this.from += c, this.to += c;
        else if (r < this.to) {
          if (r < this.from || o > this.to || this.to - this.from + h.length > 3e4) {
            i = true;
            return;
          }
          this.editContext.updateText(this.toContextPos(r), this.toContextPos(o), h.toString()), this.to += c;
        }
        t += c;
      }), s && !i && this.revertPending(e.state), !i;
    }
    update(e) {
      let t = this.pendingContextChange, i = e.startState.selection.main;
      this.composing && (this.composing.drifted || !e.changes.touchesRange(i.from, i.to) && e.transactions.some((s) => !s.isUserEvent("input.type") && s.changes.touchesRange(this.from, this.to))) ? (this.composing.drifted = true, this.composing.editorBase = e.changes.mapPos(this.composing.editorBase)) : !this.applyEdits(e) || !this.rangeIsValid(e.state) ? (this.pendingContextChange = null, this.reset(e.state)) : (e.docChanged || e.selectionSet || t) && this.setSelection(e.state), (e.geometryChanged || e.docChanged || e.selectionSet) && e.view.requestMeasure(this.measureReq);
    }
    resetRange(e) {
      let { head: t } = e.selection.main;
      this.from = Math.max(0, t - 1e4), this.to = Math.min(e.doc.length, t + 1e4);
    }
    reset(e) {
      this.resetRange(e), this.editContext.updateText(0, this.editContext.text.length, e.doc.sliceString(this.from, this.to)), this.setSelection(e);
    }
    revertPending(e) {
      let t = this.pendingContextChange;
      this.pendingContextChange = null, this.editContext.updateText(this.toContextPos(t.from), this.toContextPos(t.from + t.insert.length), e.doc.sliceString(t.from, t.to));
    }
    setSelection(e) {
      let { main: t } = e.selection, i = this.toContextPos(Math.max(this.from, Math.min(this.to, t.anchor))), s = this.toContextPos(t.head);
      (this.editContext.selectionStart != i || this.editContext.selectionEnd != s) && this.editContext.updateSelection(i, s);
    }
    rangeIsValid(e) {
      let { head: t } = e.selection.main;
      return !(this.from > 0 && t - this.from < 500 || this.to < e.doc.length && this.to - t < 500 || this.to - this.from > 1e4 * 3);
    }
    toEditorPos(e, t = this.to - this.from) {
      e = Math.min(e, t);
      let i = this.composing;
      return i && i.drifted ? i.editorBase + (e - i.contextBase) : e + this.from;
    }
    toContextPos(e) {
      let t = this.composing;
      return t && t.drifted ? t.contextBase + (e - t.editorBase) : e - this.from;
    }
    destroy() {
      for (let e in this.handlers) this.editContext.removeEventListener(e, this.handlers[e]);
    }
  };
  var O = class n40 {
    get state() {
      return this.viewState.state;
    }
    get viewport() {
      return this.viewState.viewport;
    }
    get visibleRanges() {
      return this.viewState.visibleRanges;
    }
    get inView() {
      return this.viewState.inView;
    }
    get composing() {
      return !!this.inputState && this.inputState.composing > 0;
    }
    get compositionStarted() {
      return !!this.inputState && this.inputState.composing >= 0;
    }
    get root() {
      return this._root;
    }
    get win() {
      return this.dom.ownerDocument.defaultView || window;
    }
    constructor(e = {}) {
      var t;
      this.plugins = [], this.pluginMap = /* @__PURE__ */ new Map(), this.editorAttrs = {}, this.contentAttrs = {}, this.bidiCache = [], this.destroyed = false, this.updateState = 2, this.measureScheduled = -1, this.measureRequests = [], this.clearAnnouncement = -1, this.contentDOM = document.createElement("div"), this.scrollDOM = document.createElement("div"), this.scrollDOM.tabIndex = -1, this.scrollDOM.className = "cm-scroller", this.scrollDOM.appendChild(this.contentDOM), this.announceDOM = document.createElement("div"), this.announceDOM.className = "cm-announced", this.announceDOM.setAttribute("aria-live", "polite"), this.dom = document.createElement("div"), this.dom.appendChild(this.announceDOM), this.dom.appendChild(this.scrollDOM), e.parent && e.parent.appendChild(this.dom);
      let { dispatch: i } = e;
      this.dispatchTransactions = e.dispatchTransactions || i && ((s) => s.forEach((r) => i(r, this))) || ((s) => this.update(s)), this.dispatch = this.dispatch.bind(this), this._root = e.root || Pf2(e.parent) || document, this.viewState = new jn2(this, e.state || _.create(e)), e.scrollTo && e.scrollTo.is(wn) && (this.viewState.scrollTarget = e.scrollTo.value.clip(this.viewState.state)), this.plugins = this.state.facet(Jt2).map((s) => new Ei(s));
      for (let s of this.plugins) s.update(this);
      this.observer = new to2(this), this.inputState = new zr2(this), this.inputState.ensureHandlers(this.plugins), this.docView = new zn(this), this.mountStyles(), this.updateAttrs(), this.updateState = 0, this.requestMeasure(), !((t = document.fonts) === null || t === void 0) && t.ready && document.fonts.ready.then(() => {
        this.viewState.mustMeasureContent = "refresh", this.requestMeasure();
      });
    }
    dispatch(...e) {
      let t = e.length == 1 && e[0] instanceof X2 ? e : e.length == 1 && Array.isArray(e[0]) ? e[0] : [this.state.update(...e)];
      this.dispatchTransactions(t, this);
    }
    update(e) {
      if (this.updateState != 0) throw new Error("Calls to EditorView.update are not allowed while an update is in progress");
      let t = false, i = false, s, r = this.state;
      for (let u of e) {
        if (u.startState != r) throw new RangeError("Trying to update state with a transaction that doesn't start from the previous state.");
        r = u.state;
      }
      if (this.destroyed) {
        this.viewState.state = r;
        return;
      }
      let o = this.hasFocus, l = 0, a = null;
      e.some((u) => u.annotation(Sh)) ? (this.inputState.notifiedFocused = o, l = 1) : o != this.inputState.notifiedFocused && (this.inputState.notifiedFocused = o, a = Ch(r, o), a || (l = 1));
      let h = this.observer.delayedAndroidKey, c = null;
      if (h ? (this.observer.clearDelayedAndroidKey(), c = this.observer.readChange(), (c && !this.state.doc.eq(r.doc) || !this.state.selection.eq(r.selection)) && (c = null)) : this.observer.clear(), r.facet(_.phrases) != this.state.facet(_.phrases)) return this.setState(r);
      s = Wn2.create(this, r, e), s.flags |= l;
      let f = this.viewState.scrollTarget;
      try {
        this.updateState = 2;
        for (let u of e) {
          if (f && (f = f.map(u.changes)), u.scrollIntoView) {
            let { main: d } = u.state.selection, { x: p, y: m } = this.state.facet(n40.cursorScrollMargin);
            f = new Bi(d.empty ? d : x.cursor(d.head, d.head > d.anchor ? -1 : 1), "nearest", "nearest", m, p);
          }
          for (let d of u.effects) d.is(wn) && (f = d.value.clip(this.state));
        }
        this.viewState.update(s, f), this.bidiCache = Un2.update(this.bidiCache, s.changes), s.empty || (this.updatePlugins(s), this.inputState.update(s)), t = this.docView.update(s), this.state.facet(Mi) != this.styleModules && this.mountStyles(), i = this.updateAttrs(), this.showAnnouncements(e), this.docView.updateSelection(t, e.some((u) => u.isUserEvent("select.pointer")));
      } finally {
        this.updateState = 0;
      }
      if (s.startState.facet(An) != s.state.facet(An) && (this.viewState.mustMeasureContent = true), (t || i || f || this.viewState.mustEnforceCursorAssoc || this.viewState.mustMeasureContent) && this.requestMeasure(), t && this.docViewUpdate(), !s.empty) for (let u of this.state.facet(Mr2)) try {
        u(s);
      } catch (d) {
        le(this.state, d, "update listener");
      }
      (a || c) && Promise.resolve().then(() => {
        a && this.state == a.startState && this.dispatch(a), c && !gh(this, c) && h.force && ii2(this.contentDOM, h.key, h.keyCode);
      });
    }
    setState(e) {
      if (this.updateState != 0) throw new Error("Calls to EditorView.setState are not allowed while an update is in progress");
      if (this.destroyed) {
        this.viewState.state = e;
        return;
      }
      this.updateState = 2;
      let t = this.hasFocus;
      try {
        for (let i of this.plugins) i.destroy(this);
        this.viewState = new jn2(this, e), this.plugins = e.facet(Jt2).map((i) => new Ei(i)), this.pluginMap.clear();
        for (let i of this.plugins) i.update(this);
        this.docView.destroy(), this.docView = new zn(this), this.inputState.ensureHandlers(this.plugins), this.mountStyles(), this.updateAttrs(), this.bidiCache = [];
      } finally {
        this.updateState = 0;
      }
      t && this.focus(), this.requestMeasure();
    }
    updatePlugins(e) {
      let t = e.startState.facet(Jt2), i = e.state.facet(Jt2);
      if (t != i) {
        let s = [];
        for (let r of i) {
          let o = t.indexOf(r);
          if (o < 0) s.push(new Ei(r));
          else {
            let l = this.plugins[o];
            l.mustUpdate = e, s.push(l);
          }
        }
        for (let r of this.plugins) r.mustUpdate != e && r.destroy(this);
        this.plugins = s, this.pluginMap.clear();
      } else for (let s of this.plugins) s.mustUpdate = e;
      for (let s = 0; s < this.plugins.length; s++) this.plugins[s].update(this);
      t != i && this.inputState.ensureHandlers(this.plugins);
    }
    docViewUpdate() {
      for (let e of this.plugins) {
        let t = e.value;
        if (t && t.docViewUpdate) try {
          t.docViewUpdate(this);
        } catch (i) {
          le(this.state, i, "doc view update listener");
        }
      }
    }
    measure(e = true) {
      if (this.destroyed) return;
      if (this.measureScheduled > -1 && this.win.cancelAnimationFrame(this.measureScheduled), this.observer.delayedAndroidKey) {
        this.measureScheduled = -1, this.requestMeasure();
        return;
      }
      this.measureScheduled = 0, e && this.observer.forceFlush();
      let t = null, i = this.viewState.scrollParent, s = this.viewState.getScrollOffset(), { scrollAnchorPos: r, scrollAnchorHeight: o, scaleY: l } = this.viewState;
      Math.abs(s - this.viewState.scrollOffset) > 1 && (o = -1), this.viewState.scrollAnchorHeight = -1;
      try {
        for (let a = 0; ; a++) {
          if (o < 0) {
            if (Ka(i || this.win)) r = -1, o = this.viewState.heightMap.height / this.viewState.scaleY;
            else {
              let p = this.viewState.scrollAnchorAt(s);
              r = p.from, o = p.top;
            }
            l = this.viewState.scaleY;
          }
          this.updateState = 1;
          let h = this.viewState.measure();
          if (!h && !this.measureRequests.length && this.viewState.scrollTarget == null) break;
          if (a > 5) {
            console.warn(this.measureRequests.length ? "Measure loop restarted more than 5 times" : "Viewport failed to stabilize");
            break;
          }
          let c = [];
          h & 4 || ([this.measureRequests, c] = [c, this.measureRequests]);
          let f = c.map((p) => {
            try {
              return p.read(this);
            } catch (m) {
              return le(this.state, m), Sa;
            }
          }), u = Wn2.create(this, this.state, []), d = false;
          u.flags |= h, t ? t.flags |= h : t = u, this.updateState = 2, u.empty || (this.updatePlugins(u), this.inputState.update(u), this.updateAttrs(), d = this.docView.update(u), d && this.docViewUpdate());
          for (let p = 0; p < c.length; p++) if (f[p] != Sa) try {
            let m = c[p];
            m.write && m.write(f[p], this);
          } catch (m) {
            le(this.state, m);
          }
          if (d && this.docView.updateSelection(true), !u.viewportChanged && this.measureRequests.length == 0) {
            if (this.viewState.editorHeight) if (this.viewState.scrollTarget) {
              this.docView.scrollIntoView(this.viewState.scrollTarget), this.viewState.scrollTarget = null, o = -1;
              continue;
            } else {
              let m = (r < 0 ? this.viewState.heightMap.height : this.viewState.lineBlockAt(r).top) / this.viewState.scaleY - o / l;
              if ((m > 1 || m < -1) && !(A.ios && this.inputState.lastIOSMomentumScroll > Date.now() - 100) && (i == this.scrollDOM || this.hasFocus || Math.max(this.inputState.lastWheelEvent, this.inputState.lastTouchTime) > Date.now() - 100)) {
                s = s + m, i ? r < 0 ? i.scrollTop = i.scrollHeight : i.scrollTop += m : this.win.scrollBy(0, m), o = -1;
                continue;
              }
            }
            break;
          }
        }
      } finally {
        this.updateState = 0, this.measureScheduled = -1;
      }
      if (t && !t.empty) for (let a of this.state.facet(Mr2)) a(t);
    }
    get themeClasses() {
      return Zr2 + " " + (this.state.facet(Qr2) ? Th : Mh) + " " + this.state.facet(An);
    }
    updateAttrs() {
      let e = Ca(this, lh, { class: "cm-editor" + (this.hasFocus ? " cm-focused " : " ") + this.themeClasses }), t = { spellcheck: "false", autocorrect: "off", autocapitalize: "off", writingsuggestions: "false", translate: "no", contenteditable: this.state.facet(at) ? "true" : "false", class: "cm-content", style: `${A.tabSize}: ${this.state.tabSize}`, role: "textbox", "aria-multiline": "true" };
      this.state.readOnly && (t["aria-readonly"] = "true"), Ca(this, wo2, t);
      let i = this.observer.ignore(() => {
        let s = na(this.contentDOM, this.contentAttrs, t), r = na(this.dom, this.editorAttrs, e);
        return s || r;
      });
      return this.editorAttrs = e, this.contentAttrs = t, i;
    }
    showAnnouncements(e) {
      let t = true;
      for (let i of e) for (let s of i.effects) if (s.is(n40.announce)) {
        t && (this.announceDOM.textContent = "", this.win.clearTimeout(this.clearAnnouncement), this.clearAnnouncement = this.win.setTimeout(() => {
          this.announceDOM.textContent = "\xA0";
        }, 200), t = false);
        let r = this.announceDOM.appendChild(document.createElement("div"));
        r.textContent = s.value;
      }
    }
    mountStyles() {
      this.styleModules = this.state.facet(Mi);
      let e = this.state.facet(n40.cspNonce);
      Oe.mount(this.root, this.styleModules.concat(Wu).reverse(), e ? { nonce: e } : void 0);
    }
    readMeasured() {
      if (this.updateState == 2) throw new Error("Reading the editor layout isn't allowed during an update");
      this.updateState == 0 && this.measureScheduled > -1 && this.measure(false);
    }
    requestMeasure(e) {
      if (this.measureScheduled < 0 && (this.measureScheduled = this.win.requestAnimationFrame(() => this.measure())), e) {
        if (this.measureRequests.indexOf(e) > -1) return;
        if (e.key != null) {
          for (let t = 0; t < this.measureRequests.length; t++) if (this.measureRequests[t].key === e.key) {
            this.measureRequests[t] = e;
            return;
          }
        }
        this.measureRequests.push(e);
      }
    }
    plugin(e) {
      let t = this.pluginMap.get(e);
      return (t === void 0 || t && t.plugin != e) && this.pluginMap.set(e, t = this.plugins.find((i) => i.plugin == e) || null), t && t.update(this).value;
    }
    get documentTop() {
      return this.contentDOM.getBoundingClientRect().top + this.viewState.paddingTop;
    }
    get documentPadding() {
      return { top: this.viewState.paddingTop, bottom: this.viewState.paddingBottom };
    }
    get scaleX() {
      return this.viewState.scaleX;
    }
    get scaleY() {
      return this.viewState.scaleY;
    }
    elementAtHeight(e) {
      return this.readMeasured(), this.viewState.elementAtHeight(e);
    }
    lineBlockAtHeight(e) {
      return this.readMeasured(), this.viewState.lineBlockAtHeight(e);
    }
    get viewportLineBlocks() {
      return this.viewState.viewportLines;
    }
    lineBlockAt(e) {
      return this.viewState.lineBlockAt(e);
    }
    get contentHeight() {
      return this.viewState.contentHeight;
    }
    moveByChar(e, t, i) {
      return fr2(this, e, ha(this, e, t, i));
    }
    moveByGroup(e, t) {
      return fr2(this, e, ha(this, e, t, (i) => hu(this, e.head, i)));
    }
    visualLineSide(e, t) {
      return t ? x.cursor(e.to, 1) : x.cursor(e.from, -1);
    }
    moveToLineBoundary(e, t, i = true) {
      return au(this, e, t, i);
    }
    moveVertically(e, t, i) {
      return fr2(this, e, cu(this, e, t, i));
    }
    domAtPos(e, t = 1) {
      return this.docView.domAtPos(e, t);
    }
    posAtDOM(e, t = 0) {
      return this.docView.posFromDOM(e, t);
    }
    posAtCoords(e, t = true) {
      this.readMeasured();
      let i = Nr2(this, e, t);
      return i && i.pos;
    }
    posAndSideAtCoords(e, t = true) {
      return this.readMeasured(), Nr2(this, e, t);
    }
    coordsAtPos(e, t = 1) {
      this.readMeasured();
      let i = this.state.doc.lineAt(e), s = this.bidiSpans(i), r = s[Le.find(s, e - i.from, -1, t)];
      return i.length && (e == i.from && t < 0 || e == i.to && t > 0) && r.dir != this.textDirectionAt(i.from) && (e == i.to ? (e = i.from + r.from, t = 1) : (e = i.from + r.to, t = -1)), this.docView.coordsAt(e, t, r.dir == V.RTL);
    }
    coordsForChar(e) {
      return this.readMeasured(), this.docView.coordsForChar(e);
    }
    get defaultCharacterWidth() {
      return this.viewState.heightOracle.charWidth;
    }
    get defaultLineHeight() {
      return this.viewState.heightOracle.lineHeight;
    }
    get textDirection() {
      return this.viewState.defaultTextDirection;
    }
    textDirectionAt(e) {
      return !this.state.facet(nh) || e < this.viewport.from || e > this.viewport.to ? this.textDirection : (this.readMeasured(), this.docView.textDirectionAt(e));
    }
    get lineWrapping() {
      return this.viewState.heightOracle.lineWrapping;
    }
    bidiSpans(e) {
      if (e.length > qu) return Ya(e.length);
      let t = this.textDirectionAt(e.from), i;
      for (let r of this.bidiCache) if (r.from == e.from && r.dir == t && (r.fresh || _a(r.isolates, i = oa(this, e)))) return r.order;
      i || (i = oa(this, e));
      let s = qf(e.text, t, i);
      return this.bidiCache.push(new Un2(e.from, e.to, t, i, true, s)), s;
    }
    get hasFocus() {
      var e;
      return (this.dom.ownerDocument.hasFocus() || A.safari && ((e = this.inputState) === null || e === void 0 ? void 0 : e.lastContextMenu) > Date.now() - 3e4) && this.root.activeElement == this.contentDOM;
    }
    focus() {
      this.observer.ignore(() => {
        qa(this.contentDOM), this.docView.updateSelection();
      });
    }
    setRoot(e) {
      this._root != e && (this._root = e, this.observer.setWindow((e.nodeType == 9 ? e : e.ownerDocument).defaultView || window), this.mountStyles());
    }
    destroy() {
      this.root.activeElement == this.contentDOM && this.contentDOM.blur();
      for (let e of this.plugins) e.destroy(this);
      this.plugins = [], this.inputState.destroy(), this.docView.destroy(), this.dom.remove(), this.observer.destroy(), this.win.clearTimeout(this.clearAnnouncement), this.measureScheduled > -1 && this.win.cancelAnimationFrame(this.measureScheduled), this.destroyed = true;
    }
    static scrollIntoView(e, t = {}) {
      var i, s, r, o;
      return wn.of(new Bi(typeof e == "number" ? x.cursor(e) : e, (i = t.y) !== null && i !== void 0 ? i : "nearest", (s = t.x) !== null && s !== void 0 ? s : "nearest", (r = t.yMargin) !== null && r !== void 0 ? r : 5, (o = t.xMargin) !== null && o !== void 0 ? o : 5));
    }
    scrollSnapshot() {
      let { scrollTop: e, scrollLeft: t } = this.scrollDOM, i = this.viewState.scrollAnchorAt(e);
      return wn.of(new Bi(x.cursor(i.from), "start", "start", i.top - e, t, true));
    }
    setTabFocusMode(e) {
      e == null ? this.inputState.tabFocusMode = this.inputState.tabFocusMode < 0 ? 0 : -1 : typeof e == "boolean" ? this.inputState.tabFocusMode = e ? 0 : -1 : this.inputState.tabFocusMode != 0 && (this.inputState.tabFocusMode = Date.now() + e);
    }
    static domEventHandlers(e) {
      return te.define(() => ({}), { eventHandlers: e });
    }
    static domEventObservers(e) {
      return te.define(() => ({}), { eventObservers: e });
    }
    static theme(e, t) {
      let i = Oe.newName(), s = [An.of(i), Mi.of(eo2(`.${i}`, e))];
      return t && t.dark && s.push(Qr2.of(true)), s;
    }
    static baseTheme(e) {
      return Je.lowest(Mi.of(eo2("." + Zr2, e, Dh)));
    }
    static findFromDOM(e) {
      var t;
      let i = e.querySelector(".cm-content"), s = i && Y.get(i) || Y.get(e);
      return ((t = s?.root) === null || t === void 0 ? void 0 : t.view) || null;
    }
  };
  O.styleModule = Mi;
  O.inputHandler = th;
  O.clipboardInputFilter = bo2;
  O.clipboardOutputFilter = xo2;
  O.scrollHandler = rh;
  O.focusChangeEffect = ih;
  O.perLineTextDirection = nh;
  O.exceptionSink = eh;
  O.updateListener = Mr2;
  O.editable = at;
  O.mouseSelectionStyle = Za;
  O.dragMovesSelection = Qa;
  O.clickAddsSelectionRange = Ja;
  O.decorations = Zn2;
  O.blockWrappers = ah;
  O.outerDecorations = vo2;
  O.atomicRanges = Vi;
  O.bidiIsolatedRanges = hh;
  O.cursorScrollMargin = T.define({ combine: (n66) => {
    let e = 5, t = 5;
    for (let i of n66) typeof i == "number" ? e = t = i : { x: e, y: t } = i;
    return { x: e, y: t };
  } });
  O.scrollMargins = fh;
  O.darkTheme = Qr2;
  O.cspNonce = T.define({ combine: (n66) => n66.length ? n66[0] : "" });
  O.contentAttributes = wo2;
  O.editorAttributes = lh;
  O.lineWrapping = O.contentAttributes.of({ class: "cm-lineWrapping" });
  O.announce = E.define();
  var qu = 4096;
  var Sa = {};
  var Un2 = class n41 {
    constructor(e, t, i, s, r, o) {
      this.from = e, this.to = t, this.dir = i, this.isolates = s, this.fresh = r, this.order = o;
    }
    static update(e, t) {
      if (t.empty && !e.some((r) => r.fresh)) return e;
      let i = [], s = e.length ? e[e.length - 1].dir : V.LTR;
      for (let r = Math.max(0, e.length - 10); r < e.length; r++) {
        let o = e[r];
        o.dir == s && !t.touchesRange(o.from, o.to) && i.push(new n41(t.mapPos(o.from, 1), t.mapPos(o.to, -1), o.dir, o.isolates, false, o.order));
      }
      return i;
    }
  };
  function Ca(n66, e, t) {
    for (let i = n66.state.facet(e), s = i.length - 1; s >= 0; s--) {
      let r = i[s], o = typeof r == "function" ? r(n66) : r;
      o && mo2(o, t);
    }
    return t;
  }
  var Ku = A.mac ? "mac" : A.windows ? "win" : A.linux ? "linux" : "key";
  function $u(n66, e) {
    let t = n66.split(/-(?!$)/), i = t[t.length - 1];
    i == "Space" && (i = " ");
    let s, r, o, l;
    for (let a = 0; a < t.length - 1; ++a) {
      let h = t[a];
      if (/^(cmd|meta|m)$/i.test(h)) l = true;
      else if (/^a(lt)?$/i.test(h)) s = true;
      else if (/^(c|ctrl|control)$/i.test(h)) r = true;
      else if (/^s(hift)?$/i.test(h)) o = true;
      else if (/^mod$/i.test(h)) e == "mac" ? l = true : r = true;
      else throw new Error("Unrecognized modifier name: " + h);
    }
    return s && (i = "Alt-" + i), r && (i = "Ctrl-" + i), l && (i = "Meta-" + i), o && (i = "Shift-" + i), i;
  }
  function Mn(n66, e, t) {
    return e.altKey && (n66 = "Alt-" + n66), e.ctrlKey && (n66 = "Ctrl-" + n66), e.metaKey && (n66 = "Meta-" + n66), t !== false && e.shiftKey && (n66 = "Shift-" + n66), n66;
  }
  var ju = Je.default(O.domEventHandlers({ keydown(n66, e) {
    return Eh(Oh(e.state), n66, e, "editor");
  } }));
  var ts2 = T.define({ enables: ju });
  var Aa = /* @__PURE__ */ new WeakMap();
  function Oh(n66) {
    let e = n66.facet(ts2), t = Aa.get(e);
    return t || Aa.set(e, t = Gu(e.reduce((i, s) => i.concat(s), []))), t;
  }
  function Bh(n66, e, t) {
    return Eh(Oh(n66.state), e, n66, t);
  }
  var pt = null;
  var Uu = 4e3;
  function Gu(n66, e = Ku) {
    let t = /* @__PURE__ */ Object.create(null), i = /* @__PURE__ */ Object.create(null), s = (o, l) => {
      let a = i[o];
      if (a == null) i[o] = l;
      else if (a != l) throw new Error("Key binding " + o + " is used both as a regular binding and as a multi-stroke prefix");
    }, r = (o, l, a, h, c) => {
      var f, u;
      let d = t[o] || (t[o] = /* @__PURE__ */ Object.create(null)), p = l.split(/ (?!$)/).map((y) => $u(y, e));
      for (let y = 1; y < p.length; y++) {
        let v = p.slice(0, y).join(" ");
        s(v, true), d[v] || (d[v] = { preventDefault: true, stopPropagation: false, run: [(b) => {
          let D = pt = { view: b, prefix: v, scope: o };
          return setTimeout(() => {
            pt == D && (pt = null);
          }, Uu), true;
        }] });
      }
      let m = p.join(" ");
      s(m, false);
      let g = d[m] || (d[m] = { preventDefault: false, stopPropagation: false, run: ((u = (f = d._any) === null || f === void 0 ? void 0 : f.run) === null || u === void 0 ? void 0 : u.slice()) || [] });
      a && g.run.push(a), h && (g.preventDefault = true), c && (g.stopPropagation = true);
    };
    for (let o of n66) {
      let l = o.scope ? o.scope.split(" ") : ["editor"];
      if (o.any) for (let h of l) {
        let c = t[h] || (t[h] = /* @__PURE__ */ Object.create(null));
        c._any || (c._any = { preventDefault: false, stopPropagation: false, run: [] });
        let { any: f } = o;
        for (let u in c) c[u].run.push((d) => f(d, no2));
      }
      let a = o[e] || o.key;
      if (a) for (let h of l) r(h, a, o.run, o.preventDefault, o.stopPropagation), o.shift && r(h, "Shift-" + a, o.shift, o.preventDefault, o.stopPropagation);
    }
    return t;
  }
  var no2 = null;
  function Eh(n66, e, t, i) {
    no2 = e;
    let s = Ql(e), r = De(s, 0), o = Xe2(r) == s.length && s != " ", l = "", a = false, h = false, c = false;
    pt && pt.view == t && pt.scope == i && (l = pt.prefix + " ", xh.indexOf(e.keyCode) < 0 && (h = true, pt = null));
    let f = /* @__PURE__ */ new Set(), u = (g) => {
      if (g) {
        for (let y of g.run) if (!f.has(y) && (f.add(y), y(t))) return g.stopPropagation && (c = true), true;
        g.preventDefault && (g.stopPropagation && (c = true), h = true);
      }
      return false;
    }, d = n66[i], p, m;
    return d && (u(d[l + Mn(s, e, !o)]) ? a = true : o && (e.altKey || e.metaKey || e.ctrlKey) && !(A.windows && e.ctrlKey && e.altKey) && !(A.mac && e.altKey && !(e.ctrlKey || e.metaKey)) && (p = lt[e.keyCode]) && p != s ? (u(d[l + Mn(p, e, true)]) || e.shiftKey && (m = Yt[e.keyCode]) != s && m != p && u(d[l + Mn(m, e, false)])) && (a = true) : o && e.shiftKey && u(d[l + Mn(s, e, true)]) && (a = true), !a && u(d._any) && (a = true)), h && (a = true), a && c && e.stopPropagation(), no2 = null, a;
  }
  var Et = class n42 {
    constructor(e, t, i, s, r) {
      this.className = e, this.left = t, this.top = i, this.width = s, this.height = r;
    }
    draw() {
      let e = document.createElement("div");
      return e.className = this.className, this.adjust(e), e;
    }
    update(e, t) {
      return t.className != this.className ? false : (this.adjust(e), true);
    }
    adjust(e) {
      e.style.left = this.left + "px", e.style.top = this.top + "px", this.width != null && (e.style.width = this.width + "px"), e.style.height = this.height + "px";
    }
    eq(e) {
      return this.left == e.left && this.top == e.top && this.width == e.width && this.height == e.height && this.className == e.className;
    }
    static forRange(e, t, i) {
      if (i.empty) {
        let s = e.coordsAtPos(i.head, i.assoc || 1);
        if (!s) return [];
        let r = Lh(e);
        return [new n42(t, s.left - r.left, s.top - r.top, null, s.bottom - s.top)];
      } else return _u(e, t, i);
    }
  };
  function Lh(n66) {
    let e = n66.scrollDOM.getBoundingClientRect();
    return { left: (n66.textDirection == V.LTR ? e.left : e.right - n66.scrollDOM.clientWidth * n66.scaleX) - n66.scrollDOM.scrollLeft * n66.scaleX, top: e.top - n66.scrollDOM.scrollTop * n66.scaleY };
  }
  function Ma(n66, e, t, i) {
    let s = n66.coordsAtPos(e, t * 2);
    if (!s) return i;
    let r = n66.dom.getBoundingClientRect(), o = (s.top + s.bottom) / 2, l = n66.posAtCoords({ x: r.left + 1, y: o }), a = n66.posAtCoords({ x: r.right - 1, y: o });
    return l == null || a == null ? i : { from: Math.max(i.from, Math.min(l, a)), to: Math.min(i.to, Math.max(l, a)) };
  }
  function _u(n66, e, t) {
    if (t.to <= n66.viewport.from || t.from >= n66.viewport.to) return [];
    let i = Math.max(t.from, n66.viewport.from), s = Math.min(t.to, n66.viewport.to), r = n66.textDirection == V.LTR, o = n66.contentDOM, l = o.getBoundingClientRect(), a = Lh(n66), h = o.querySelector(".cm-line"), c = h && window.getComputedStyle(h), f = l.left + (c ? parseInt(c.paddingLeft) + Math.min(0, parseInt(c.textIndent)) : 0), u = l.right - (c ? parseInt(c.paddingRight) : 0), d = Ir2(n66, i, 1), p = Ir2(n66, s, -1), m = d.type == ae2.Text ? d : null, g = p.type == ae2.Text ? p : null;
    if (m && (n66.lineWrapping || d.widgetLineBreaks) && (m = Ma(n66, i, 1, m)), g && (n66.lineWrapping || p.widgetLineBreaks) && (g = Ma(n66, s, -1, g)), m && g && m.from == g.from && m.to == g.to) return v(b(t.from, t.to, m));
    {
      let w = m ? b(t.from, null, m) : D(d, false), k = g ? b(null, t.to, g) : D(p, true), S2 = [];
      return (m || d).to < (g || p).from - (m && g ? 1 : 0) || d.widgetLineBreaks > 1 && w.bottom + n66.defaultLineHeight / 2 < k.top ? S2.push(y(f, w.bottom, u, k.top)) : w.bottom < k.top && n66.elementAtHeight((w.bottom + k.top) / 2).type == ae2.Text && (w.bottom = k.top = (w.bottom + k.top) / 2), v(w).concat(S2).concat(v(k));
    }
    function y(w, k, S2, R) {
      return new Et(e, w - a.left, k - a.top, Math.max(0, S2 - w), R - k);
    }
    function v({ top: w, bottom: k, horizontal: S2 }) {
      let R = [];
      for (let N = 0; N < S2.length; N += 2) R.push(y(S2[N], w, S2[N + 1], k));
      return R;
    }
    function b(w, k, S2) {
      let R = 1e9, N = -1e9, K = [];
      function I(W, U, ce2, we, _e) {
        let re2 = n66.coordsAtPos(W, W == S2.to ? -2 : 2), Ae2 = n66.coordsAtPos(ce2, ce2 == S2.from ? 2 : -2);
        !re2 || !Ae2 || (R = Math.min(re2.top, Ae2.top, R), N = Math.max(re2.bottom, Ae2.bottom, N), _e == V.LTR ? K.push(r && U ? f : re2.left, r && we ? u : Ae2.right) : K.push(!r && we ? f : Ae2.left, !r && U ? u : re2.right));
      }
      let B = w ?? S2.from, q = k ?? S2.to;
      for (let W of n66.visibleRanges) if (W.to > B && W.from < q) for (let U = Math.max(W.from, B), ce2 = Math.min(W.to, q); ; ) {
        let we = n66.state.doc.lineAt(U);
        for (let _e of n66.bidiSpans(we)) {
          let re2 = _e.from + we.from, Ae2 = _e.to + we.from;
          if (re2 >= ce2) break;
          Ae2 > U && I(Math.max(re2, U), w == null && re2 <= B, Math.min(Ae2, ce2), k == null && Ae2 >= q, _e.dir);
        }
        if (U = we.to + 1, U >= ce2) break;
      }
      return K.length == 0 && I(B, w == null, q, k == null, n66.textDirection), { top: R, bottom: N, horizontal: K };
    }
    function D(w, k) {
      let S2 = l.top + (k ? w.top : w.bottom);
      return { top: S2, bottom: S2, horizontal: [] };
    }
  }
  function Yu(n66, e) {
    return n66.constructor == e.constructor && n66.eq(e);
  }
  var so2 = class {
    constructor(e, t) {
      this.view = e, this.layer = t, this.drawn = [], this.scaleX = 1, this.scaleY = 1, this.measureReq = { read: this.measure.bind(this), write: this.draw.bind(this) }, this.dom = e.scrollDOM.appendChild(document.createElement("div")), this.dom.classList.add("cm-layer"), t.above && this.dom.classList.add("cm-layer-above"), t.class && this.dom.classList.add(t.class), this.scale(), this.dom.setAttribute("aria-hidden", "true"), this.setOrder(e.state), e.requestMeasure(this.measureReq), t.mount && t.mount(this.dom, e);
    }
    update(e) {
      e.startState.facet(En) != e.state.facet(En) && this.setOrder(e.state), (this.layer.update(e, this.dom) || e.geometryChanged) && (this.scale(), e.view.requestMeasure(this.measureReq));
    }
    docViewUpdate(e) {
      this.layer.updateOnDocViewUpdate !== false && e.requestMeasure(this.measureReq);
    }
    setOrder(e) {
      let t = 0, i = e.facet(En);
      for (; t < i.length && i[t] != this.layer; ) t++;
      this.dom.style.zIndex = String((this.layer.above ? 150 : -1) - t);
    }
    measure() {
      return this.layer.markers(this.view);
    }
    scale() {
      let { scaleX: e, scaleY: t } = this.view;
      (e != this.scaleX || t != this.scaleY) && (this.scaleX = e, this.scaleY = t, this.dom.style.transform = `scale(${1 / e}, ${1 / t})`);
    }
    draw(e) {
      if (e.length != this.drawn.length || e.some((t, i) => !Yu(t, this.drawn[i]))) {
        let t = this.dom.firstChild, i = 0;
        for (let s of e) s.update && t && s.constructor && this.drawn[i].constructor && s.update(t, this.drawn[i]) ? (t = t.nextSibling, i++) : this.dom.insertBefore(s.draw(), t);
        for (; t; ) {
          let s = t.nextSibling;
          t.remove(), t = s;
        }
        this.drawn = e, A.webkit && (this.dom.style.display = this.dom.firstChild ? "" : "none");
      }
    }
    destroy() {
      this.layer.destroy && this.layer.destroy(this.dom, this.view), this.dom.remove();
    }
  };
  var En = T.define();
  function Rh(n66) {
    return [te.define((e) => new so2(e, n66)), En.of(n66)];
  }
  var ro2 = !A.ios;
  var ci2 = T.define({ combine(n66) {
    return de(n66, { cursorBlinkRate: 1200, drawRangeCursor: true, iosSelectionHandles: true }, { cursorBlinkRate: (e, t) => Math.min(e, t), drawRangeCursor: (e, t) => e || t });
  } });
  function Xu(n66 = {}) {
    return [ci2.of(n66), Ju, Qu, ed, sh.of(true)];
  }
  function Ph(n66) {
    return n66.startState.facet(ci2) != n66.state.facet(ci2);
  }
  var Ju = Rh({ above: true, markers(n66) {
    let { state: e } = n66, t = e.facet(ci2), i = [];
    for (let s of e.selection.ranges) {
      let r = s == e.selection.main;
      if (s.empty || t.drawRangeCursor && !(r && A.ios && t.iosSelectionHandles)) {
        let o = r ? "cm-cursor cm-cursor-primary" : "cm-cursor cm-cursor-secondary", l = s.empty ? s : x.cursor(s.head, s.assoc);
        for (let a of Et.forRange(n66, o, l)) i.push(a);
      }
    }
    return i;
  }, update(n66, e) {
    n66.transactions.some((i) => i.selection) && (e.style.animationName = e.style.animationName == "cm-blink" ? "cm-blink2" : "cm-blink");
    let t = Ph(n66);
    return t && Ta(n66.state, e), n66.docChanged || n66.selectionSet || t;
  }, mount(n66, e) {
    Ta(e.state, n66);
  }, class: "cm-cursorLayer" });
  function Ta(n66, e) {
    e.style.animationDuration = n66.facet(ci2).cursorBlinkRate + "ms";
  }
  var Qu = Rh({ above: false, markers(n66) {
    let e = [], { main: t, ranges: i } = n66.state.selection;
    for (let s of i) if (!s.empty && (ro2 || s != t)) for (let r of Et.forRange(n66, "cm-selectionBackground", s)) e.push(r);
    if (A.ios && !t.empty && n66.state.facet(ci2).iosSelectionHandles) {
      for (let s of Et.forRange(n66, "cm-selectionHandle cm-selectionHandle-start", x.cursor(t.from, 1))) e.push(s);
      for (let s of Et.forRange(n66, "cm-selectionHandle cm-selectionHandle-end", x.cursor(t.to, 1))) e.push(s);
    }
    return e;
  }, update(n66, e) {
    return n66.docChanged || n66.selectionSet || n66.viewportChanged || Ph(n66);
  }, class: "cm-selectionLayer" });
  var Zu = A.gecko && A.gecko_version == 153 ? "#ffffff01" : "transparent";
  var ed = Je.highest(O.theme({ ".cm-line": { ...ro2 ? { "& ::selection, &::selection": { backgroundColor: `${Zu} !important` } } : {}, caretColor: "transparent !important" }, ".cm-content": { caretColor: "transparent !important", "& :focus": { caretColor: "initial !important", ...ro2 ? { "&::selection, & ::selection": { backgroundColor: "Highlight !important" } } : {} } } }));
  function Da(n66, e, t, i, s) {
    e.lastIndex = 0;
    for (let r = n66.iterRange(t, i), o = t, l; !r.next().done; o += r.value.length) if (!r.lineBreak) for (; l = e.exec(r.value); ) s(o + l.index, l);
  }
  function td(n66, e) {
    let t = n66.visibleRanges;
    if (t.length == 1 && t[0].from == n66.viewport.from && t[0].to == n66.viewport.to) return t;
    let i = [];
    for (let { from: s, to: r } of t) s = Math.max(n66.state.doc.lineAt(s).from, s - e), r = Math.min(n66.state.doc.lineAt(r).to, r + e), i.length && i[i.length - 1].to >= s ? i[i.length - 1].to = r : i.push({ from: s, to: r });
    return i;
  }
  var oo2 = class {
    constructor(e) {
      let { regexp: t, decoration: i, decorate: s, boundary: r, maxLength: o = 1e3 } = e;
      if (!t.global) throw new RangeError("The regular expression given to MatchDecorator should have its 'g' flag set");
      if (this.regexp = t, s) this.addMatch = (l, a, h, c) => s(c, h, h + l[0].length, l, a);
      else if (typeof i == "function") this.addMatch = (l, a, h, c) => {
        let f = i(l, a, h);
        f && c(h, h + l[0].length, f);
      };
      else if (i) this.addMatch = (l, a, h, c) => c(h, h + l[0].length, i);
      else throw new RangeError("Either 'decorate' or 'decoration' should be provided to MatchDecorator");
      this.boundary = r, this.maxLength = o;
    }
    createDeco(e) {
      let t = new Me(), i = t.add.bind(t);
      for (let { from: s, to: r } of td(e, this.maxLength)) Da(e.state.doc, this.regexp, s, r, (o, l) => this.addMatch(l, e, o, i));
      return t.finish();
    }
    updateDeco(e, t) {
      let i = 1e9, s = -1;
      return e.docChanged && e.changes.iterChanges((r, o, l, a) => {
        a >= e.view.viewport.from && l <= e.view.viewport.to && (i = Math.min(l, i), s = Math.max(a, s));
      }), e.viewportMoved || s - i > 1e3 ? this.createDeco(e.view) : s > -1 ? this.updateRange(e.view, t.map(e.changes), i, s) : t;
    }
    updateRange(e, t, i, s) {
      for (let r of e.visibleRanges) {
        let o = Math.max(r.from, i), l = Math.min(r.to, s);
        if (l >= o) {
          let a = e.state.doc.lineAt(o), h = a.to < l ? e.state.doc.lineAt(l) : a, c = Math.max(r.from, a.from), f = Math.min(r.to, h.to);
          if (this.boundary) {
            for (; o > a.from; o--) if (this.boundary.test(a.text[o - 1 - a.from])) {
              c = o;
              break;
            }
            for (; l < h.to; l++) if (this.boundary.test(h.text[l - h.from])) {
              f = l;
              break;
            }
          }
          let u = [], d, p = (m, g, y) => u.push(y.range(m, g));
          if (a == h) for (this.regexp.lastIndex = c - a.from; (d = this.regexp.exec(a.text)) && d.index < f - a.from; ) this.addMatch(d, e, d.index + a.from, p);
          else Da(e.state.doc, this.regexp, c, f, (m, g) => this.addMatch(g, e, m, p));
          t = t.update({ filterFrom: c, filterTo: f, filter: (m, g) => m < c || g > f, add: u });
        }
      }
      return t;
    }
  };
  var lo2 = /x/.unicode != null ? "gu" : "g";
  var id = new RegExp(`[\0-\b
-\x7F-\x9F\xAD\u061C\u200B\u200E\u200F\u2028\u2029\u202D\u202E\u2066\u2067\u2069\uFEFF\uFFF9-\uFFFC]`, lo2);
  var nd = { 0: "null", 7: "bell", 8: "backspace", 10: "newline", 11: "vertical tab", 13: "carriage return", 27: "escape", 8203: "zero width space", 8204: "zero width non-joiner", 8205: "zero width joiner", 8206: "left-to-right mark", 8207: "right-to-left mark", 8232: "line separator", 8237: "left-to-right override", 8238: "right-to-left override", 8294: "left-to-right isolate", 8295: "right-to-left isolate", 8297: "pop directional isolate", 8233: "paragraph separator", 65279: "zero width no-break space", 65532: "object replacement" };
  var dr2 = null;
  function sd() {
    var n66;
    if (dr2 == null && typeof document < "u" && document.body) {
      let e = document.body.style;
      dr2 = ((n66 = e.tabSize) !== null && n66 !== void 0 ? n66 : e.MozTabSize) != null;
    }
    return dr2 || false;
  }
  var Ln = T.define({ combine(n66) {
    let e = de(n66, { render: null, specialChars: id, addSpecialChars: null });
    return (e.replaceTabs = !sd()) && (e.specialChars = new RegExp("	|" + e.specialChars.source, lo2)), e.addSpecialChars && (e.specialChars = new RegExp(e.specialChars.source + "|" + e.addSpecialChars.source, lo2)), e;
  } });
  function rd(n66 = {}) {
    return [Ln.of(n66), od()];
  }
  var Oa = null;
  function od() {
    return Oa || (Oa = te.fromClass(class {
      constructor(n66) {
        this.view = n66, this.decorations = L.none, this.decorationCache = /* @__PURE__ */ Object.create(null), this.decorator = this.makeDecorator(n66.state.facet(Ln)), this.decorations = this.decorator.createDeco(n66);
      }
      makeDecorator(n66) {
        return new oo2({ regexp: n66.specialChars, decoration: (e, t, i) => {
          let { doc: s } = t.state, r = De(e[0], 0);
          if (r == 9) {
            let o = s.lineAt(i), l = t.state.tabSize, a = dt2(o.text, l, i - o.from);
            return L.replace({ widget: new ho2((l - a % l) * this.view.defaultCharacterWidth / this.view.scaleX) });
          }
          return this.decorationCache[r] || (this.decorationCache[r] = L.replace({ widget: new ao2(n66, r) }));
        }, boundary: n66.replaceTabs ? void 0 : /[^]/ });
      }
      update(n66) {
        let e = n66.state.facet(Ln);
        n66.startState.facet(Ln) != e ? (this.decorator = this.makeDecorator(e), this.decorations = this.decorator.createDeco(n66.view)) : this.decorations = this.decorator.updateDeco(n66, this.decorations);
      }
    }, { decorations: (n66) => n66.decorations }));
  }
  var ld = "\u2022";
  function ad(n66) {
    return n66 >= 32 ? ld : n66 == 10 ? "\u2424" : String.fromCharCode(9216 + n66);
  }
  var ao2 = class extends Re {
    constructor(e, t) {
      super(), this.options = e, this.code = t;
    }
    eq(e) {
      return e.code == this.code;
    }
    toDOM(e) {
      let t = ad(this.code), i = e.state.phrase("Control character") + " " + (nd[this.code] || "0x" + this.code.toString(16)), s = this.options.render && this.options.render(this.code, i, t);
      if (s) return s;
      let r = document.createElement("span");
      return r.textContent = t, r.title = i, r.setAttribute("aria-label", i), r.className = "cm-specialChar", r;
    }
    ignoreEvent() {
      return false;
    }
  };
  var ho2 = class extends Re {
    constructor(e) {
      super(), this.width = e;
    }
    eq(e) {
      return e.width == this.width;
    }
    toDOM() {
      let e = document.createElement("span");
      return e.textContent = "	", e.className = "cm-tab", e.style.width = this.width + "px", e;
    }
    ignoreEvent() {
      return false;
    }
  };
  function hd() {
    return fd;
  }
  var cd = L.line({ class: "cm-activeLine" });
  var fd = te.fromClass(class {
    constructor(n66) {
      this.decorations = this.getDeco(n66);
    }
    update(n66) {
      (n66.docChanged || n66.selectionSet) && (this.decorations = this.getDeco(n66.view));
    }
    getDeco(n66) {
      let e = -1, t = [];
      for (let i of n66.state.selection.ranges) {
        let s = n66.lineBlockAt(i.head);
        s.from > e && (t.push(cd.range(s.from)), e = s.from);
      }
      return L.set(t);
    }
  }, { decorations: (n66) => n66.decorations });
  var Tn = "-10000px";
  var Gn2 = class {
    constructor(e, t, i, s) {
      this.facet = t, this.createTooltipView = i, this.removeTooltipView = s, this.input = e.state.facet(t), this.tooltips = this.input.filter((o) => o);
      let r = null;
      this.tooltipViews = this.tooltips.map((o) => r = i(o, r));
    }
    update(e, t) {
      var i;
      let s = e.state.facet(this.facet), r = s.filter((a) => a);
      if (s === this.input) {
        for (let a of this.tooltipViews) a.update && a.update(e);
        return false;
      }
      let o = [], l = t ? [] : null;
      for (let a = 0; a < r.length; a++) {
        let h = r[a], c = -1;
        if (h) {
          for (let f = 0; f < this.tooltips.length; f++) {
            let u = this.tooltips[f];
            u && u.create == h.create && (c = f);
          }
          if (c < 0) o[a] = this.createTooltipView(h, a ? o[a - 1] : null), l && (l[a] = !!h.above);
          else {
            let f = o[a] = this.tooltipViews[c];
            l && (l[a] = t[c]), f.update && f.update(e);
          }
        }
      }
      for (let a of this.tooltipViews) o.indexOf(a) < 0 && (this.removeTooltipView(a), (i = a.destroy) === null || i === void 0 || i.call(a));
      return t && (l.forEach((a, h) => t[h] = a), t.length = l.length), this.input = s, this.tooltips = r, this.tooltipViews = o, true;
    }
  };
  function Ih(n66) {
    let e = n66.dom.ownerDocument.documentElement, t = e.clientWidth, i = getComputedStyle(e);
    if (!/stable/.test(i.scrollbarGutter || "")) return { left: 0, right: t };
    let s = e.getBoundingClientRect(), r = n66.win.scrollX;
    return { left: Math.max(0, s.left + r - parseFloat(i.marginLeft)), right: Math.min(t, s.right + r + parseFloat(i.marginRight)) };
  }
  function ud(n66) {
    let { left: e, right: t } = Ih(n66);
    return { top: 0, left: e, right: t, bottom: n66.dom.ownerDocument.documentElement.clientHeight };
  }
  var pr2 = T.define({ combine: (n66) => {
    var e, t, i;
    return { position: A.ios ? "absolute" : ((e = n66.find((s) => s.position)) === null || e === void 0 ? void 0 : e.position) || "fixed", parent: ((t = n66.find((s) => s.parent)) === null || t === void 0 ? void 0 : t.parent) || null, tooltipSpace: ((i = n66.find((s) => s.tooltipSpace)) === null || i === void 0 ? void 0 : i.tooltipSpace) || ud };
  } });
  var Ba = /* @__PURE__ */ new WeakMap();
  var Co2 = te.fromClass(class {
    constructor(n66) {
      this.view = n66, this.above = [], this.inView = true, this.madeAbsolute = false, this.lastTransaction = 0, this.measureTimeout = -1;
      let e = n66.state.facet(pr2);
      this.position = e.position, this.parent = e.parent, this.classes = n66.themeClasses, this.createContainer(), this.measureReq = { read: this.readMeasure.bind(this), write: this.writeMeasure.bind(this), key: this }, this.resizeObserver = typeof ResizeObserver == "function" ? new ResizeObserver(() => this.measureSoon()) : null, this.manager = new Gn2(n66, zi, (t, i) => this.createTooltip(t, i), (t) => {
        this.resizeObserver && this.resizeObserver.unobserve(t.dom), t.dom.remove();
      }), this.above = this.manager.tooltips.map((t) => !!t.above), this.intersectionObserver = typeof IntersectionObserver == "function" ? new IntersectionObserver((t) => {
        Date.now() > this.lastTransaction - 50 && t.length > 0 && t[t.length - 1].intersectionRatio < 1 && this.measureSoon();
      }, { threshold: [1] }) : null, this.observeIntersection(), n66.win.addEventListener("resize", this.measureSoon = this.measureSoon.bind(this)), this.maybeMeasure();
    }
    createContainer() {
      this.parent ? (this.container = document.createElement("div"), this.container.style.position = "relative", this.container.className = this.view.themeClasses, this.parent.appendChild(this.container)) : this.container = this.view.dom;
    }
    observeIntersection() {
      if (this.intersectionObserver) {
        this.intersectionObserver.disconnect();
        for (let n66 of this.manager.tooltipViews) this.intersectionObserver.observe(n66.dom);
      }
    }
    measureSoon() {
      this.measureTimeout < 0 && (this.measureTimeout = setTimeout(() => {
        this.measureTimeout = -1, this.maybeMeasure();
      }, 50));
    }
    update(n66) {
      n66.transactions.length && (this.lastTransaction = Date.now());
      let e = this.manager.update(n66, this.above);
      e && this.observeIntersection();
      let t = e || n66.geometryChanged, i = n66.state.facet(pr2);
      if (i.position != this.position && !this.madeAbsolute) {
        this.position = i.position;
        for (let s of this.manager.tooltipViews) s.dom.style.position = this.position;
        t = true;
      }
      if (i.parent != this.parent) {
        this.parent && this.container.remove(), this.parent = i.parent, this.createContainer();
        for (let s of this.manager.tooltipViews) this.container.appendChild(s.dom);
        t = true;
      } else this.parent && this.view.themeClasses != this.classes && (this.classes = this.container.className = this.view.themeClasses);
      t && this.maybeMeasure();
    }
    createTooltip(n66, e) {
      let t = n66.create(this.view), i = e ? e.dom : null;
      if (t.dom.classList.add("cm-tooltip"), n66.arrow && !t.dom.querySelector(".cm-tooltip > .cm-tooltip-arrow")) {
        let s = document.createElement("div");
        s.className = "cm-tooltip-arrow", t.dom.appendChild(s);
      }
      return t.dom.style.position = this.position, t.dom.style.top = Tn, t.dom.style.left = "0px", this.container.insertBefore(t.dom, i), t.mount && t.mount(this.view), this.resizeObserver && this.resizeObserver.observe(t.dom), t;
    }
    destroy() {
      var n66, e, t;
      this.view.win.removeEventListener("resize", this.measureSoon);
      for (let i of this.manager.tooltipViews) i.dom.remove(), (n66 = i.destroy) === null || n66 === void 0 || n66.call(i);
      this.parent && this.container.remove(), (e = this.resizeObserver) === null || e === void 0 || e.disconnect(), (t = this.intersectionObserver) === null || t === void 0 || t.disconnect(), clearTimeout(this.measureTimeout);
    }
    readMeasure() {
      let n66 = 1, e = 1, t = false, i = 0;
      if (this.position == "fixed" && this.manager.tooltipViews.length) {
        let { dom: o } = this.manager.tooltipViews[0];
        if (A.safari) {
          let l = o.getBoundingClientRect();
          t = Math.abs(l.top + 1e4) > 1 || Math.abs(l.left) > 1;
        } else t = !!o.offsetParent && o.offsetParent != this.container.ownerDocument.body;
      }
      if (t || this.position == "absolute") if (this.parent) {
        let o = this.parent.getBoundingClientRect();
        o.width && o.height && (n66 = o.width / this.parent.offsetWidth, e = o.height / this.parent.offsetHeight);
      } else ({ scaleX: n66, scaleY: e } = this.view.viewState);
      else i = Ih(this.view).left;
      let s = this.view.scrollDOM.getBoundingClientRect(), r = ko2(this.view);
      return { visible: { left: s.left + r.left, top: s.top + r.top, right: s.right - r.right, bottom: s.bottom - r.bottom }, parent: this.parent ? this.container.getBoundingClientRect() : this.view.dom.getBoundingClientRect(), pos: this.manager.tooltips.map((o, l) => {
        let a = this.manager.tooltipViews[l];
        return a.getCoords ? a.getCoords(o.pos) : this.view.coordsAtPos(o.pos);
      }), size: this.manager.tooltipViews.map(({ dom: o }) => o.getBoundingClientRect()), space: this.view.state.facet(pr2).tooltipSpace(this.view), scaleX: n66, scaleY: e, makeAbsolute: t, fixedLeft: i };
    }
    writeMeasure(n66) {
      var e;
      if (n66.makeAbsolute) {
        this.madeAbsolute = true, this.position = "absolute";
        for (let l of this.manager.tooltipViews) l.dom.style.position = "absolute";
      }
      let { visible: t, space: i, scaleX: s, scaleY: r } = n66, o = [];
      for (let l = 0; l < this.manager.tooltips.length; l++) {
        let a = this.manager.tooltips[l], h = this.manager.tooltipViews[l], { dom: c } = h, f = n66.pos[l], u = n66.size[l];
        if (!f || a.clip !== false && (f.bottom <= Math.max(t.top, i.top) || f.top >= Math.min(t.bottom, i.bottom) || f.right < Math.max(t.left, i.left) - 0.1 || f.left > Math.min(t.right, i.right) + 0.1)) {
          c.style.top = Tn;
          continue;
        }
        let d = a.arrow ? h.dom.querySelector(".cm-tooltip-arrow") : null, p = d ? 7 : 0, m = u.right - u.left, g = (e = Ba.get(h)) !== null && e !== void 0 ? e : u.bottom - u.top, y = h.offset || pd, v = this.view.textDirection == V.LTR, b = u.width > i.right - i.left ? v ? i.left : i.right - u.width : v ? Math.max(i.left, Math.min(f.left - (d ? 14 : 0) + y.x, i.right - m)) : Math.min(Math.max(i.left, f.left - m + (d ? 14 : 0) - y.x), i.right - m), D = this.above[l];
        !a.strictSide && (D ? f.top - g - p - y.y < i.top : f.bottom + g + p + y.y > i.bottom) && D == i.bottom - f.bottom > f.top - i.top && (D = this.above[l] = !D);
        let w = (D ? f.top - i.top : i.bottom - f.bottom) - p;
        if (w < g && h.resize !== false) {
          if (w < this.view.defaultLineHeight) {
            c.style.top = Tn;
            continue;
          }
          Ba.set(h, g), c.style.height = (g = w) / r + "px";
        } else c.style.height && (c.style.height = "");
        let k = D ? f.top - g - p - y.y : f.bottom + p + y.y, S2 = b + m;
        if (h.overlap !== true) for (let R of o) R.left < S2 && R.right > b && R.top < k + g && R.bottom > k && (k = D ? R.top - g - 2 - p : R.bottom + p + 2);
        if (this.position == "absolute" ? (c.style.top = (k - n66.parent.top) / r + "px", Ea(c, (b - n66.parent.left) / s)) : (c.style.top = k / r + "px", Ea(c, (b - n66.fixedLeft) / s)), d) {
          let R = f.left + (v ? y.x : -y.x) - (b + 14 - 7);
          d.style.left = R / s + "px";
        }
        h.overlap !== true && o.push({ left: b, top: k, right: S2, bottom: k + g }), c.classList.toggle("cm-tooltip-above", D), c.classList.toggle("cm-tooltip-below", !D), h.positioned && h.positioned(n66.space);
      }
    }
    maybeMeasure() {
      if (this.manager.tooltips.length && (this.view.inView && this.view.requestMeasure(this.measureReq), this.inView != this.view.inView && (this.inView = this.view.inView, !this.inView))) for (let n66 of this.manager.tooltipViews) n66.dom.style.top = Tn;
    }
  }, { eventObservers: { scroll() {
    this.maybeMeasure();
  } } });
  function Ea(n66, e) {
    let t = parseInt(n66.style.left, 10);
    (isNaN(t) || Math.abs(e - t) > 1) && (n66.style.left = e + "px");
  }
  var dd = O.baseTheme({ ".cm-tooltip": { zIndex: 500, boxSizing: "border-box" }, "&light .cm-tooltip": { border: "1px solid #bbb", backgroundColor: "#f5f5f5" }, "&light .cm-tooltip-section:not(:first-child)": { borderTop: "1px solid #bbb" }, "&dark .cm-tooltip": { backgroundColor: "#333338", color: "white" }, ".cm-tooltip-arrow": { height: "7px", width: "14px", position: "absolute", zIndex: -1, overflow: "hidden", "&:before, &:after": { content: "''", position: "absolute", width: 0, height: 0, borderLeft: "7px solid transparent", borderRight: "7px solid transparent" }, ".cm-tooltip-above &": { bottom: "-7px", "&:before": { borderTop: "7px solid #bbb" }, "&:after": { borderTop: "7px solid #f5f5f5", bottom: "1px" } }, ".cm-tooltip-below &": { top: "-7px", "&:before": { borderBottom: "7px solid #bbb" }, "&:after": { borderBottom: "7px solid #f5f5f5", top: "1px" } } }, "&dark .cm-tooltip .cm-tooltip-arrow": { "&:before": { borderTopColor: "#333338", borderBottomColor: "#333338" }, "&:after": { borderTopColor: "transparent", borderBottomColor: "transparent" } } });
  var pd = { x: 0, y: 0 };
  var zi = T.define({ enables: [Co2, dd] });
  var _n = T.define({ combine: (n66) => n66.reduce((e, t) => e.concat(t), []) });
  var Yn2 = class n43 {
    static create(e) {
      return new n43(e);
    }
    constructor(e) {
      this.view = e, this.mounted = false, this.dom = document.createElement("div"), this.dom.classList.add("cm-tooltip-hover"), this.manager = new Gn2(e, _n, (t, i) => this.createHostedView(t, i), (t) => t.dom.remove());
    }
    createHostedView(e, t) {
      let i = e.create(this.view);
      return i.dom.classList.add("cm-tooltip-section"), this.dom.insertBefore(i.dom, t ? t.dom.nextSibling : this.dom.firstChild), this.mounted && i.mount && i.mount(this.view), i;
    }
    mount(e) {
      for (let t of this.manager.tooltipViews) t.mount && t.mount(e);
      this.mounted = true;
    }
    positioned(e) {
      for (let t of this.manager.tooltipViews) t.positioned && t.positioned(e);
    }
    update(e) {
      this.manager.update(e);
    }
    destroy() {
      var e;
      for (let t of this.manager.tooltipViews) (e = t.destroy) === null || e === void 0 || e.call(t);
    }
    passProp(e) {
      let t;
      for (let i of this.manager.tooltipViews) {
        let s = i[e];
        if (s !== void 0) {
          if (t === void 0) t = s;
          else if (t !== s) return;
        }
      }
      return t;
    }
    get offset() {
      return this.passProp("offset");
    }
    get getCoords() {
      return this.passProp("getCoords");
    }
    get overlap() {
      return this.passProp("overlap");
    }
    get resize() {
      return this.passProp("resize");
    }
  };
  var md = zi.compute([_n], (n66) => {
    let e = n66.facet(_n);
    return e.length === 0 ? null : { pos: Math.min(...e.map((t) => t.pos)), end: Math.max(...e.map((t) => {
      var i;
      return (i = t.end) !== null && i !== void 0 ? i : t.pos;
    })), create: Yn2.create, above: e[0].above, arrow: e.some((t) => t.arrow) };
  });
  var gd = T.define();
  var co2 = class {
    constructor(e, t, i, s, r, o) {
      this.view = e, this.source = t, this.field = i, this.locked = s, this.setHover = r, this.hoverTime = o, this.hoverTimeout = -1, this.restartTimeout = -1, this.pending = null, this.lastMove = { x: 0, y: 0, target: e.dom, time: 0 }, this.checkHover = this.checkHover.bind(this), e.dom.addEventListener("mouseleave", this.mouseleave = this.mouseleave.bind(this)), e.dom.addEventListener("mousemove", this.mousemove = this.mousemove.bind(this));
    }
    update(e) {
      this.pending && (this.pending = null, clearTimeout(this.restartTimeout), this.restartTimeout = setTimeout(() => this.startHover(), 20));
    }
    get active() {
      return this.view.state.field(this.field);
    }
    checkHover() {
      if (this.hoverTimeout = -1, this.active.length) return;
      let e = Date.now() - this.lastMove.time;
      e < this.hoverTime ? this.hoverTimeout = setTimeout(this.checkHover, this.hoverTime - e) : this.startHover();
    }
    startHover() {
      clearTimeout(this.restartTimeout);
      let { view: e, lastMove: t } = this, i = e.docView.tile.nearest(t.target);
      if (!i) return;
      let s, r = 1;
      if (i.isWidget()) s = i.posAtStart;
      else {
        if (s = e.posAtCoords(t), s == null) return;
        let o = e.coordsAtPos(s);
        if (!o || t.y < o.top || t.y > o.bottom || t.x < o.left - e.defaultCharacterWidth || t.x > o.right + e.defaultCharacterWidth) return;
        let l = e.bidiSpans(e.state.doc.lineAt(s)).find((h) => h.from <= s && h.to >= s), a = l && l.dir == V.RTL ? -1 : 1;
        r = t.x < o.left ? -a : a;
      }
      this.activateHover(e, s, r);
    }
    activateHover(e, t, i, s) {
      let r = this.source(e, t, i), o = (l) => {
        if (l && !(Array.isArray(l) && !l.length)) {
          let a = Array.isArray(l) ? l : [l];
          s && this.locked.set(a, s), e.dispatch({ effects: this.setHover.of(a) });
        }
      };
      if (r && "then" in r) {
        let l = this.pending = { pos: t };
        r.then((a) => {
          this.pending == l && (this.pending = null, o(a));
        }, (a) => le(e.state, a, "hover tooltip"));
      } else o(r);
    }
    get tooltip() {
      let e = this.view.plugin(Co2), t = e ? e.manager.tooltips.findIndex((i) => i.create == Yn2.create) : -1;
      return t > -1 ? e.manager.tooltipViews[t] : null;
    }
    mousemove(e) {
      var t, i;
      this.lastMove = { x: e.clientX, y: e.clientY, target: e.target, time: Date.now() }, this.hoverTimeout < 0 && (this.hoverTimeout = setTimeout(this.checkHover, this.hoverTime));
      let { active: s, tooltip: r } = this;
      if (s.length && !this.locked.has(s) && r && !yd(r.dom, e) || this.pending) {
        let { pos: o } = s[0] || this.pending, l = (i = (t = s[0]) === null || t === void 0 ? void 0 : t.end) !== null && i !== void 0 ? i : o;
        (o == l ? this.view.posAtCoords(this.lastMove) != o : !bd(this.view, o, l, e.clientX, e.clientY)) && (this.view.dispatch({ effects: this.setHover.of([]) }), this.pending = null);
      }
    }
    mouseleave(e) {
      clearTimeout(this.hoverTimeout), this.hoverTimeout = -1;
      let { active: t } = this;
      if (t.length && !this.locked.has(t)) {
        let { tooltip: i } = this;
        i && i.dom.contains(e.relatedTarget) ? this.watchTooltipLeave(i.dom) : this.view.dispatch({ effects: this.setHover.of([]) });
      }
    }
    watchTooltipLeave(e) {
      let t = (i) => {
        e.removeEventListener("mouseleave", t);
        let { active: s } = this;
        s.length && !this.locked.has(s) && !this.view.dom.contains(i.relatedTarget) && this.view.dispatch({ effects: this.setHover.of([]) });
      };
      e.addEventListener("mouseleave", t);
    }
    destroy() {
      clearTimeout(this.hoverTimeout), clearTimeout(this.restartTimeout), this.view.dom.removeEventListener("mouseleave", this.mouseleave), this.view.dom.removeEventListener("mousemove", this.mousemove);
    }
  };
  var Dn = 4;
  function yd(n66, e) {
    let { left: t, right: i, top: s, bottom: r } = n66.getBoundingClientRect(), o;
    if (o = n66.querySelector(".cm-tooltip-arrow")) {
      let l = o.getBoundingClientRect();
      s = Math.min(l.top, s), r = Math.max(l.bottom, r);
    }
    return e.clientX >= t - Dn && e.clientX <= i + Dn && e.clientY >= s - Dn && e.clientY <= r + Dn;
  }
  function bd(n66, e, t, i, s, r) {
    let o = n66.scrollDOM.getBoundingClientRect(), l = n66.documentTop + n66.documentPadding.top + n66.contentHeight;
    if (o.left > i || o.right < i || o.top > s || Math.min(o.bottom, l) < s) return false;
    let a = n66.posAtCoords({ x: i, y: s }, false);
    return a >= e && a <= t;
  }
  function Ao2(n66, e = {}) {
    let t = E.define(), i = /* @__PURE__ */ new WeakMap(), s = J.define({ create() {
      return [];
    }, update(o, l) {
      let a = i.get(o);
      if (o.length && (e.hideOnChange && (l.docChanged || l.selection) ? o = [] : a && a(l) ? o = [] : e.hideOn && (o = o.filter((h) => !e.hideOn(l, h)))), l.docChanged && o.length) {
        let h = [];
        for (let c of o) {
          let f = l.changes.mapPos(c.pos, -1, ue.TrackDel);
          if (f != null) {
            let u = Object.assign(/* @__PURE__ */ Object.create(null), c);
            u.pos = f, u.end != null && (u.end = l.changes.mapPos(u.end)), h.push(u);
          }
        }
        o = h;
      }
      for (let h of l.effects) h.is(t) && (o = h.value, a = void 0), (h.is(xd) && !h.value || h.value == s) && (o = []);
      return o.length && a && i.set(o, a), o;
    }, provide: (o) => _n.from(o) }), r = te.define((o) => new co2(o, n66, s, i, t, e.hoverTime || 300));
    return { active: s, extension: [s, r, gd.of(r), md] };
  }
  function Mo2(n66, e) {
    let t = n66.plugin(Co2);
    if (!t) return null;
    let i = t.manager.tooltips.indexOf(e);
    return i < 0 ? null : t.manager.tooltipViews[i];
  }
  var xd = E.define();
  var La = T.define({ combine(n66) {
    let e, t;
    for (let i of n66) e = e || i.topContainer, t = t || i.bottomContainer;
    return { topContainer: e, bottomContainer: t };
  } });
  function qi2(n66, e) {
    let t = n66.plugin(Nh), i = t ? t.specs.indexOf(e) : -1;
    return i > -1 ? t.panels[i] : null;
  }
  var Nh = te.fromClass(class {
    constructor(n66) {
      this.input = n66.state.facet(Pt2), this.specs = this.input.filter((t) => t), this.panels = this.specs.map((t) => t(n66));
      let e = n66.state.facet(La);
      this.top = new Zt2(n66, true, e.topContainer), this.bottom = new Zt2(n66, false, e.bottomContainer), this.top.sync(this.panels.filter((t) => t.top)), this.bottom.sync(this.panels.filter((t) => !t.top));
      for (let t of this.panels) t.dom.classList.add("cm-panel"), t.mount && t.mount();
    }
    update(n66) {
      let e = n66.state.facet(La);
      this.top.container != e.topContainer && (this.top.sync([]), this.top = new Zt2(n66.view, true, e.topContainer)), this.bottom.container != e.bottomContainer && (this.bottom.sync([]), this.bottom = new Zt2(n66.view, false, e.bottomContainer)), this.top.syncClasses(), this.bottom.syncClasses();
      let t = n66.state.facet(Pt2);
      if (t != this.input) {
        let i = t.filter((a) => a), s = [], r = [], o = [], l = [];
        for (let a of i) {
          let h = this.specs.indexOf(a), c;
          h < 0 ? (c = a(n66.view), l.push(c)) : (c = this.panels[h], c.update && c.update(n66)), s.push(c), (c.top ? r : o).push(c);
        }
        this.specs = i, this.panels = s, this.top.sync(r), this.bottom.sync(o);
        for (let a of l) a.dom.classList.add("cm-panel"), a.mount && a.mount();
      } else for (let i of this.panels) i.update && i.update(n66);
    }
    destroy() {
      this.top.sync([]), this.bottom.sync([]);
    }
  }, { provide: (n66) => O.scrollMargins.of((e) => {
    let t = e.plugin(n66);
    return t && { top: t.top.scrollMargin(), bottom: t.bottom.scrollMargin() };
  }) });
  var Zt2 = class {
    constructor(e, t, i) {
      this.view = e, this.top = t, this.container = i, this.dom = void 0, this.classes = "", this.panels = [], this.syncClasses();
    }
    sync(e) {
      for (let t of this.panels) t.destroy && e.indexOf(t) < 0 && t.destroy();
      this.panels = e, this.syncDOM();
    }
    syncDOM() {
      if (this.panels.length == 0) {
        this.dom && (this.dom.remove(), this.dom = void 0);
        return;
      }
      if (!this.dom) {
        this.dom = document.createElement("div"), this.dom.className = this.top ? "cm-panels cm-panels-top" : "cm-panels cm-panels-bottom";
        let t = this.container || this.view.dom;
        t.insertBefore(this.dom, this.top ? t.firstChild : null);
      }
      let e = this.dom.firstChild;
      for (let t of this.panels) if (t.dom.parentNode == this.dom) {
        for (; e != t.dom; ) e = Ra(e);
        e = e.nextSibling;
      } else this.dom.insertBefore(t.dom, e);
      for (; e; ) e = Ra(e);
    }
    scrollMargin() {
      return !this.dom || this.container ? 0 : Math.max(0, this.top ? this.dom.getBoundingClientRect().bottom - Math.max(0, this.view.scrollDOM.getBoundingClientRect().top) : Math.min(innerHeight, this.view.scrollDOM.getBoundingClientRect().bottom) - this.dom.getBoundingClientRect().top);
    }
    syncClasses() {
      if (!(!this.container || this.classes == this.view.themeClasses)) {
        for (let e of this.classes.split(" ")) e && this.container.classList.remove(e);
        for (let e of (this.classes = this.view.themeClasses).split(" ")) e && this.container.classList.add(e);
      }
    }
  };
  function Ra(n66) {
    let e = n66.nextSibling;
    return n66.remove(), e;
  }
  var Pt2 = T.define({ enables: Nh });
  function Fh(n66, e) {
    let t, i = new Promise((o) => t = o), s = (o) => wd(o, e, t);
    n66.state.field(Rn, false) ? n66.dispatch({ effects: Wh.of(s) }) : n66.dispatch({ effects: E.appendConfig.of(Rn.init(() => [s])) });
    let r = Vh.of(s);
    return { close: r, result: i.then((o) => ((n66.win.queueMicrotask || ((a) => n66.win.setTimeout(a, 10)))(() => {
      n66.state.field(Rn).indexOf(s) > -1 && n66.dispatch({ effects: r });
    }), o)) };
  }
  function Hh(n66, e) {
    let t = n66.state.field(Rn, false) || [];
    for (let i of t) {
      let s = qi2(n66, i);
      if (s && s.dom.classList.contains(e)) return s;
    }
    return null;
  }
  var Rn = J.define({ create() {
    return [];
  }, update(n66, e) {
    for (let t of e.effects) t.is(Wh) ? n66 = [t.value].concat(n66) : t.is(Vh) && (n66 = n66.filter((i) => i != t.value));
    return n66;
  }, provide: (n66) => Pt2.computeN([n66], (e) => e.field(n66)) });
  var Wh = E.define();
  var Vh = E.define();
  function wd(n66, e, t) {
    let i = e.content ? e.content(n66, () => l(null)) : null;
    if (!i) {
      if (i = H("form"), e.input) {
        let a = H("input", e.input);
        /^(text|password|number|email|tel|url)$/.test(a.type) && a.classList.add("cm-textfield"), a.name || (a.name = "input"), i.appendChild(H("label", (e.label || "") + ": ", a));
      } else i.appendChild(document.createTextNode(e.label || ""));
      i.appendChild(document.createTextNode(" ")), i.appendChild(H("button", { class: "cm-button", type: "submit" }, e.submitLabel || "OK"));
    }
    let s = i.nodeName == "FORM" ? [i] : i.querySelectorAll("form");
    for (let a = 0; a < s.length; a++) {
      let h = s[a];
      h.addEventListener("keydown", (c) => {
        c.keyCode == 27 ? (c.preventDefault(), l(null)) : c.keyCode == 13 && (c.preventDefault(), l(h));
      }), h.addEventListener("submit", (c) => {
        c.preventDefault(), l(h);
      });
    }
    let r = H("div", i, H("button", { onclick: () => l(null), "aria-label": n66.state.phrase("close"), class: "cm-dialog-close", type: "button" }, ["\xD7"]));
    e.class && (r.className = e.class), r.classList.add("cm-dialog");
    let o = typeof e.focus == "string" ? i.querySelector(e.focus) : e.focus ? i.querySelector("input") || i.querySelector("button") : null;
    function l(a) {
      r.contains(r.ownerDocument.activeElement) && n66.focus(), t(a);
    }
    return { dom: r, top: e.top, mount: () => {
      o && ("select" in o ? o.select() : "focus" in o && o.focus());
    }, destroy: () => t(null) };
  }
  var ze = class extends Te2 {
    compare(e) {
      return this == e || this.constructor == e.constructor && this.eq(e);
    }
    eq(e) {
      return false;
    }
    destroy(e) {
    }
  };
  ze.prototype.elementClass = "";
  ze.prototype.toDOM = void 0;
  ze.prototype.mapMode = ue.TrackBefore;
  ze.prototype.startSide = ze.prototype.endSide = -1;
  ze.prototype.point = true;
  var mr2 = T.define();
  var vd = T.define();
  var Pn = T.define();
  var fo2 = T.define({ combine: (n66) => n66.some((e) => e) });
  function kd(n66) {
    let e = [Sd];
    return n66 && n66.fixed === false && e.push(fo2.of(true)), e;
  }
  var Sd = te.fromClass(class {
    constructor(n66) {
      this.view = n66, this.domAfter = null, this.prevViewport = n66.viewport, this.dom = document.createElement("div"), this.dom.className = "cm-gutters cm-gutters-before", this.dom.setAttribute("aria-hidden", "true"), this.dom.style.minHeight = this.view.contentHeight / this.view.scaleY + "px", this.gutters = n66.state.facet(Pn).map((e) => new Xn2(n66, e)), this.fixed = !n66.state.facet(fo2);
      for (let e of this.gutters) e.config.side == "after" ? this.getDOMAfter().appendChild(e.dom) : this.dom.appendChild(e.dom);
      this.fixed && (this.dom.style.position = "sticky"), this.syncGutters(false), n66.scrollDOM.insertBefore(this.dom, n66.contentDOM);
    }
    getDOMAfter() {
      return this.domAfter || (this.domAfter = document.createElement("div"), this.domAfter.className = "cm-gutters cm-gutters-after", this.domAfter.setAttribute("aria-hidden", "true"), this.domAfter.style.minHeight = this.view.contentHeight / this.view.scaleY + "px", this.domAfter.style.position = this.fixed ? "sticky" : "", this.view.scrollDOM.appendChild(this.domAfter)), this.domAfter;
    }
    update(n66) {
      if (this.updateGutters(n66)) {
        let e = this.prevViewport, t = n66.view.viewport, i = Math.min(e.to, t.to) - Math.max(e.from, t.from);
        this.syncGutters(i < (t.to - t.from) * 0.8);
      }
      if (n66.geometryChanged) {
        let e = this.view.contentHeight / this.view.scaleY + "px";
        this.dom.style.minHeight = e, this.domAfter && (this.domAfter.style.minHeight = e);
      }
      this.view.state.facet(fo2) != !this.fixed && (this.fixed = !this.fixed, this.dom.style.position = this.fixed ? "sticky" : "", this.domAfter && (this.domAfter.style.position = this.fixed ? "sticky" : "")), this.prevViewport = n66.view.viewport;
    }
    syncGutters(n66) {
      let e = this.dom.nextSibling;
      n66 && (this.dom.remove(), this.domAfter && this.domAfter.remove());
      let t = z.iter(this.view.state.facet(mr2), this.view.viewport.from), i = [], s = this.gutters.map((r) => new po2(r, this.view.viewport, -this.view.documentPadding.top));
      for (let r of this.view.viewportLineBlocks) if (i.length && (i = []), Array.isArray(r.type)) {
        let o = true;
        for (let l of r.type) if (l.type == ae2.Text && o) {
          uo2(t, i, l.from);
          for (let a of s) a.line(this.view, l, i);
          o = false;
        } else if (l.widget) for (let a of s) a.widget(this.view, l);
      } else if (r.type == ae2.Text) {
        uo2(t, i, r.from);
        for (let o of s) o.line(this.view, r, i);
      } else if (r.widget) for (let o of s) o.widget(this.view, r);
      for (let r of s) r.finish();
      n66 && (this.view.scrollDOM.insertBefore(this.dom, e), this.domAfter && this.view.scrollDOM.appendChild(this.domAfter));
    }
    updateGutters(n66) {
      let e = n66.startState.facet(Pn), t = n66.state.facet(Pn), i = n66.docChanged || n66.heightChanged || n66.viewportChanged || !z.eq(n66.startState.facet(mr2), n66.state.facet(mr2), n66.view.viewport.from, n66.view.viewport.to);
      if (e == t) for (let s of this.gutters) s.update(n66) && (i = true);
      else {
        i = true;
        let s = [];
        for (let r of t) {
          let o = e.indexOf(r);
          o < 0 ? s.push(new Xn2(this.view, r)) : (this.gutters[o].update(n66), s.push(this.gutters[o]));
        }
        for (let r of this.gutters) r.dom.remove(), s.indexOf(r) < 0 && r.destroy();
        for (let r of s) r.config.side == "after" ? this.getDOMAfter().appendChild(r.dom) : this.dom.appendChild(r.dom);
        this.gutters = s;
      }
      return i;
    }
    destroy() {
      for (let n66 of this.gutters) n66.destroy();
      this.dom.remove(), this.domAfter && this.domAfter.remove();
    }
  }, { provide: (n66) => O.scrollMargins.of((e) => {
    let t = e.plugin(n66);
    if (!t || t.gutters.length == 0 || !t.fixed) return null;
    let i = t.dom.offsetWidth * e.scaleX, s = t.domAfter ? t.domAfter.offsetWidth * e.scaleX : 0;
    return e.textDirection == V.LTR ? { left: i, right: s } : { right: i, left: s };
  }) });
  function Pa(n66) {
    return Array.isArray(n66) ? n66 : [n66];
  }
  function uo2(n66, e, t) {
    for (; n66.value && n66.from <= t; ) n66.from == t && e.push(n66.value), n66.next();
  }
  var po2 = class {
    constructor(e, t, i) {
      this.gutter = e, this.height = i, this.i = 0, this.cursor = z.iter(e.markers, t.from);
    }
    addElement(e, t, i) {
      let { gutter: s } = this, r = (t.top - this.height) / e.scaleY, o = t.height / e.scaleY;
      if (this.i == s.elements.length) {
        let l = new Jn2(e, o, r, i);
        s.elements.push(l), s.dom.appendChild(l.dom);
      } else s.elements[this.i].update(e, o, r, i);
      this.height = t.bottom, this.i++;
    }
    line(e, t, i) {
      let s = [];
      uo2(this.cursor, s, t.from), i.length && (s = s.concat(i));
      let r = this.gutter.config.lineMarker(e, t, s);
      r && s.unshift(r);
      let o = this.gutter;
      s.length == 0 && !o.config.renderEmptyElements || this.addElement(e, t, s);
    }
    widget(e, t) {
      let i = this.gutter.config.widgetMarker(e, t.widget, t), s = i ? [i] : null;
      for (let r of e.state.facet(vd)) {
        let o = r(e, t.widget, t);
        o && (s || (s = [])).push(o);
      }
      s && this.addElement(e, t, s);
    }
    finish() {
      let e = this.gutter;
      for (; e.elements.length > this.i; ) {
        let t = e.elements.pop();
        e.dom.removeChild(t.dom), t.destroy();
      }
    }
  };
  var Xn2 = class {
    constructor(e, t) {
      this.view = e, this.config = t, this.elements = [], this.spacer = null, this.dom = document.createElement("div"), this.dom.className = "cm-gutter" + (this.config.class ? " " + this.config.class : "");
      for (let i in t.domEventHandlers) this.dom.addEventListener(i, (s) => {
        let r = s.target, o;
        if (r != this.dom && this.dom.contains(r)) {
          for (; r.parentNode != this.dom; ) r = r.parentNode;
          let a = r.getBoundingClientRect();
          o = (a.top + a.bottom) / 2;
        } else o = s.clientY;
        let l = e.lineBlockAtHeight(o - e.documentTop);
        t.domEventHandlers[i](e, l, s) && s.preventDefault();
      });
      this.markers = Pa(t.markers(e)), t.initialSpacer && (this.spacer = new Jn2(e, 0, 0, [t.initialSpacer(e)]), this.dom.appendChild(this.spacer.dom), this.spacer.dom.style.cssText += "visibility: hidden; pointer-events: none");
    }
    update(e) {
      let t = this.markers;
      if (this.markers = Pa(this.config.markers(e.view)), this.spacer && this.config.updateSpacer) {
        let s = this.config.updateSpacer(this.spacer.markers[0], e);
        s != this.spacer.markers[0] && this.spacer.update(e.view, 0, 0, [s]);
      }
      let i = e.view.viewport;
      return !z.eq(this.markers, t, i.from, i.to) || (this.config.lineMarkerChange ? this.config.lineMarkerChange(e) : false);
    }
    destroy() {
      for (let e of this.elements) e.destroy();
    }
  };
  var Jn2 = class {
    constructor(e, t, i, s) {
      this.height = -1, this.above = 0, this.markers = [], this.dom = document.createElement("div"), this.dom.className = "cm-gutterElement", this.update(e, t, i, s);
    }
    update(e, t, i, s) {
      this.height != t && (this.height = t, this.dom.style.height = t + "px"), this.above != i && (this.dom.style.marginTop = (this.above = i) ? i + "px" : ""), Cd(this.markers, s) || this.setMarkers(e, s);
    }
    setMarkers(e, t) {
      let i = "cm-gutterElement", s = this.dom.firstChild;
      for (let r = 0, o = 0; ; ) {
        let l = o, a = r < t.length ? t[r++] : null, h = false;
        if (a) {
          let c = a.elementClass;
          c && (i += " " + c);
          for (let f = o; f < this.markers.length; f++) if (this.markers[f].compare(a)) {
            l = f, h = true;
            break;
          }
        } else l = this.markers.length;
        for (; o < l; ) {
          let c = this.markers[o++];
          if (c.toDOM) {
            c.destroy(s);
            let f = s.nextSibling;
            s.remove(), s = f;
          }
        }
        if (!a) break;
        a.toDOM && (h ? s = s.nextSibling : this.dom.insertBefore(a.toDOM(e), s)), h && o++;
      }
      this.dom.className = i, this.markers = t;
    }
    destroy() {
      this.setMarkers(null, []);
    }
  };
  function Cd(n66, e) {
    if (n66.length != e.length) return false;
    for (let t = 0; t < n66.length; t++) if (!n66[t].compare(e[t])) return false;
    return true;
  }
  var Ad = T.define();
  var Md = T.define();
  var ei2 = T.define({ combine(n66) {
    return de(n66, { formatNumber: String, domEventHandlers: {} }, { domEventHandlers(e, t) {
      let i = Object.assign({}, e);
      for (let s in t) {
        let r = i[s], o = t[s];
        i[s] = r ? (l, a, h) => r(l, a, h) || o(l, a, h) : o;
      }
      return i;
    } });
  } });
  var Ii = class extends ze {
    constructor(e) {
      super(), this.number = e;
    }
    eq(e) {
      return this.number == e.number;
    }
    toDOM() {
      return document.createTextNode(this.number);
    }
  };
  function gr2(n66, e) {
    return n66.state.facet(ei2).formatNumber(e, n66.state);
  }
  var Td = Pn.compute([ei2], (n66) => ({ class: "cm-lineNumbers", renderEmptyElements: false, markers(e) {
    return e.state.facet(Ad);
  }, lineMarker(e, t, i) {
    return i.some((s) => s.toDOM) ? null : new Ii(gr2(e, e.state.doc.lineAt(t.from).number));
  }, widgetMarker: (e, t, i) => {
    for (let s of e.state.facet(Md)) {
      let r = s(e, t, i);
      if (r) return r;
    }
    return null;
  }, lineMarkerChange: (e) => e.startState.facet(ei2) != e.state.facet(ei2), initialSpacer(e) {
    return new Ii(gr2(e, Ia(e.state.doc.lines)));
  }, updateSpacer(e, t) {
    let i = gr2(t.view, Ia(t.view.state.doc.lines));
    return i == e.number ? e : new Ii(i);
  }, domEventHandlers: n66.facet(ei2).domEventHandlers, side: "before" }));
  function Dd(n66 = {}) {
    return [ei2.of(n66), kd(), Td];
  }
  function Ia(n66) {
    let e = 9;
    for (; e < n66; ) e = e * 10 + 9;
    return e;
  }
  var Od = 0;
  var Ki = class {
    constructor(e, t) {
      this.from = e, this.to = t;
    }
  };
  var P = class {
    constructor(e = {}) {
      this.id = Od++, this.perNode = !!e.perNode, this.deserialize = e.deserialize || (() => {
        throw new Error("This node type doesn't define a deserialize function");
      }), this.combine = e.combine || null;
    }
    add(e) {
      if (this.perNode) throw new RangeError("Can't add per-node props to node types");
      return typeof e != "function" && (e = Se.match(e)), (t) => {
        let i = e(t);
        return i === void 0 ? null : [this, i];
      };
    }
  };
  P.closedBy = new P({ deserialize: (n66) => n66.split(" ") });
  P.openedBy = new P({ deserialize: (n66) => n66.split(" ") });
  P.group = new P({ deserialize: (n66) => n66.split(" ") });
  P.isolate = new P({ deserialize: (n66) => {
    if (n66 && n66 != "rtl" && n66 != "ltr" && n66 != "auto") throw new RangeError("Invalid value for isolate: " + n66);
    return n66 || "auto";
  } });
  P.contextHash = new P({ perNode: true });
  P.lookAhead = new P({ perNode: true });
  P.mounted = new P({ perNode: true });
  var It = class {
    constructor(e, t, i, s = false) {
      this.tree = e, this.overlay = t, this.parser = i, this.bracketed = s;
    }
    static get(e) {
      return e && e.props && e.props[P.mounted.id];
    }
  };
  var Bd = /* @__PURE__ */ Object.create(null);
  var Se = class n44 {
    constructor(e, t, i, s = 0) {
      this.name = e, this.props = t, this.id = i, this.flags = s;
    }
    static define(e) {
      let t = e.props && e.props.length ? /* @__PURE__ */ Object.create(null) : Bd, i = (e.top ? 1 : 0) | (e.skipped ? 2 : 0) | (e.error ? 4 : 0) | (e.name == null ? 8 : 0), s = new n44(e.name || "", t, e.id, i);
      if (e.props) {
        for (let r of e.props) if (Array.isArray(r) || (r = r(s)), r) {
          if (r[0].perNode) throw new RangeError("Can't store a per-node prop on a node type");
          t[r[0].id] = r[1];
        }
      }
      return s;
    }
    prop(e) {
      return this.props[e.id];
    }
    get isTop() {
      return (this.flags & 1) > 0;
    }
    get isSkipped() {
      return (this.flags & 2) > 0;
    }
    get isError() {
      return (this.flags & 4) > 0;
    }
    get isAnonymous() {
      return (this.flags & 8) > 0;
    }
    is(e) {
      if (typeof e == "string") {
        if (this.name == e) return true;
        let t = this.prop(P.group);
        return t ? t.indexOf(e) > -1 : false;
      }
      return this.id == e;
    }
    static match(e) {
      let t = /* @__PURE__ */ Object.create(null);
      for (let i in e) for (let s of i.split(" ")) t[s] = e[i];
      return (i) => {
        for (let s = i.prop(P.group), r = -1; r < (s ? s.length : 0); r++) {
          let o = t[r < 0 ? i.name : s[r]];
          if (o) return o;
        }
      };
    }
  };
  Se.none = new Se("", /* @__PURE__ */ Object.create(null), 0, 8);
  var is2 = /* @__PURE__ */ new WeakMap();
  var zh = /* @__PURE__ */ new WeakMap();
  var Q;
  (function(n66) {
    n66[n66.ExcludeBuffers = 1] = "ExcludeBuffers", n66[n66.IncludeAnonymous = 2] = "IncludeAnonymous", n66[n66.IgnoreMounts = 4] = "IgnoreMounts", n66[n66.IgnoreOverlays = 8] = "IgnoreOverlays", n66[n66.EnterBracketed = 16] = "EnterBracketed";
  })(Q || (Q = {}));
  var he = class n45 {
    constructor(e, t, i, s, r) {
      if (this.type = e, this.children = t, this.positions = i, this.length = s, this.props = null, r && r.length) {
        this.props = /* @__PURE__ */ Object.create(null);
        for (let [o, l] of r) this.props[typeof o == "number" ? o : o.id] = l;
      }
    }
    toString() {
      let e = It.get(this);
      if (e && !e.overlay) return e.tree.toString();
      let t = "";
      for (let i of this.children) {
        let s = i.toString();
        s && (t && (t += ","), t += s);
      }
      return this.type.name ? (/\W/.test(this.type.name) && !this.type.isError ? JSON.stringify(this.type.name) : this.type.name) + (t.length ? "(" + t + ")" : "") : t;
    }
    cursor(e = 0) {
      return new Ui(this.topNode, e);
    }
    cursorAt(e, t = 0, i = 0) {
      let s = is2.get(this) || this.topNode, r = new Ui(s);
      return r.moveTo(e, t), is2.set(this, r._tree), r;
    }
    get topNode() {
      return new et2(this, 0, 0, null);
    }
    resolve(e, t = 0) {
      let i = $i2(is2.get(this) || this.topNode, e, t, false);
      return is2.set(this, i), i;
    }
    resolveInner(e, t = 0) {
      let i = $i2(zh.get(this) || this.topNode, e, t, true);
      return zh.set(this, i), i;
    }
    resolveStack(e, t = 0) {
      return Ed(this, e, t);
    }
    iterate(e) {
      let { enter: t, leave: i, from: s = 0, to: r = this.length } = e, o = e.mode || 0, l = (o & Q.IncludeAnonymous) > 0;
      for (let a = this.cursor(o | Q.IncludeAnonymous); ; ) {
        let h = false;
        if (a.from <= r && a.to >= s && (!l && a.type.isAnonymous || t(a) !== false)) {
          if (a.firstChild()) continue;
          h = true;
        }
        for (; h && i && (l || !a.type.isAnonymous) && i(a), !a.nextSibling(); ) {
          if (!a.parent()) return;
          h = true;
        }
      }
    }
    prop(e) {
      return e.perNode ? this.props ? this.props[e.id] : void 0 : this.type.prop(e);
    }
    get propValues() {
      let e = [];
      if (this.props) for (let t in this.props) e.push([+t, this.props[t]]);
      return e;
    }
    balance(e = {}) {
      return this.children.length <= 8 ? this : Ro2(Se.none, this.children, this.positions, 0, this.children.length, 0, this.length, (t, i, s) => new n45(this.type, t, i, s, this.propValues), e.makeTree || ((t, i, s) => new n45(Se.none, t, i, s)));
    }
    static build(e) {
      return Ld(e);
    }
  };
  he.empty = new he(Se.none, [], [], 0);
  var To2 = class n46 {
    constructor(e, t) {
      this.buffer = e, this.index = t;
    }
    get id() {
      return this.buffer[this.index - 4];
    }
    get start() {
      return this.buffer[this.index - 3];
    }
    get end() {
      return this.buffer[this.index - 2];
    }
    get size() {
      return this.buffer[this.index - 1];
    }
    get pos() {
      return this.index;
    }
    next() {
      this.index -= 4;
    }
    fork() {
      return new n46(this.buffer, this.index);
    }
  };
  var bt2 = class n47 {
    constructor(e, t, i) {
      this.buffer = e, this.length = t, this.set = i;
    }
    get type() {
      return Se.none;
    }
    toString() {
      let e = [];
      for (let t = 0; t < this.buffer.length; ) e.push(this.childString(t)), t = this.buffer[t + 3];
      return e.join(",");
    }
    childString(e) {
      let t = this.buffer[e], i = this.buffer[e + 3], s = this.set.types[t], r = s.name;
      if (/\W/.test(r) && !s.isError && (r = JSON.stringify(r)), e += 4, i == e) return r;
      let o = [];
      for (; e < i; ) o.push(this.childString(e)), e = this.buffer[e + 3];
      return r + "(" + o.join(",") + ")";
    }
    findChild(e, t, i, s, r) {
      let { buffer: o } = this, l = -1;
      for (let a = e; a != t && !($h(r, s, o[a + 1], o[a + 2]) && (l = a, i > 0)); a = o[a + 3]) ;
      return l;
    }
    slice(e, t, i) {
      let s = this.buffer, r = new Uint16Array(t - e), o = 0;
      for (let l = e, a = 0; l < t; ) {
        r[a++] = s[l++], r[a++] = s[l++] - i;
        let h = r[a++] = s[l++] - i;
        r[a++] = s[l++] - e, o = Math.max(o, h);
      }
      return new n47(r, o, this.set);
    }
  };
  function $h(n66, e, t, i) {
    switch (n66) {
      case -2:
        return t < e;
      case -1:
        return i >= e && t < e;
      case 0:
        return t < e && i > e;
      case 1:
        return t <= e && i > e;
      case 2:
        return i > e;
      case 4:
        return true;
    }
  }
  function $i2(n66, e, t, i) {
    for (var s; n66.from == n66.to || (t < 1 ? n66.from >= e : n66.from > e) || (t > -1 ? n66.to <= e : n66.to < e); ) {
      let o = !i && n66 instanceof et2 && n66.index < 0 ? null : n66.parent;
      if (!o) return n66;
      n66 = o;
    }
    let r = i ? 0 : Q.IgnoreOverlays;
    if (i) for (let o = n66, l = o.parent; l; o = l, l = o.parent) o instanceof et2 && o.index < 0 && ((s = l.enter(e, t, r)) === null || s === void 0 ? void 0 : s.from) != o.from && (n66 = l);
    for (; ; ) {
      let o = n66.enter(e, t, r);
      if (!o) return n66;
      n66 = o;
    }
  }
  var ss2 = class {
    cursor(e = 0) {
      return new Ui(this, e);
    }
    getChild(e, t = null, i = null) {
      let s = qh(this, e, t, i);
      return s.length ? s[0] : null;
    }
    getChildren(e, t = null, i = null) {
      return qh(this, e, t, i);
    }
    resolve(e, t = 0) {
      return $i2(this, e, t, false);
    }
    resolveInner(e, t = 0) {
      return $i2(this, e, t, true);
    }
    matchContext(e) {
      return Do2(this.parent, e);
    }
    enterUnfinishedNodesBefore(e) {
      let t = this.childBefore(e), i = this;
      for (; t; ) {
        let s = t.lastChild;
        if (!s || s.to != t.to) break;
        s.type.isError && s.from == s.to ? (i = t, t = s.prevSibling) : t = s;
      }
      return i;
    }
    get node() {
      return this;
    }
    get next() {
      return this.parent;
    }
  };
  var et2 = class n48 extends ss2 {
    constructor(e, t, i, s) {
      super(), this._tree = e, this.from = t, this.index = i, this._parent = s;
    }
    get type() {
      return this._tree.type;
    }
    get name() {
      return this._tree.type.name;
    }
    get to() {
      return this.from + this._tree.length;
    }
    nextChild(e, t, i, s, r = 0) {
      for (let o = this; ; ) {
        for (let { children: l, positions: a } = o._tree, h = t > 0 ? l.length : -1; e != h; e += t) {
          let c = l[e], f = a[e] + o.from, u;
          if (!(!(r & Q.EnterBracketed && c instanceof he && (u = It.get(c)) && !u.overlay && u.bracketed && i >= f && i <= f + c.length) && !$h(s, i, f, f + c.length))) {
            if (c instanceof bt2) {
              if (r & Q.ExcludeBuffers) continue;
              let d = c.findChild(0, c.buffer.length, t, i - f, s);
              if (d > -1) return new ji2(new Oo2(o, c, e, f), null, d);
            } else if (r & Q.IncludeAnonymous || !c.type.isAnonymous || Lo2(c)) {
              let d;
              if (!(r & Q.IgnoreMounts) && (d = It.get(c)) && !d.overlay) return new n48(d.tree, f, e, o);
              let p = new n48(c, f, e, o);
              return r & Q.IncludeAnonymous || !p.type.isAnonymous ? p : p.nextChild(t < 0 ? c.children.length - 1 : 0, t, i, s, r);
            }
          }
        }
        if (r & Q.IncludeAnonymous || !o.type.isAnonymous || (o.index >= 0 ? e = o.index + t : e = t < 0 ? -1 : o._parent._tree.children.length, o = o._parent, !o)) return null;
      }
    }
    get firstChild() {
      return this.nextChild(0, 1, 0, 4);
    }
    get lastChild() {
      return this.nextChild(this._tree.children.length - 1, -1, 0, 4);
    }
    childAfter(e) {
      return this.nextChild(0, 1, e, 2);
    }
    childBefore(e) {
      return this.nextChild(this._tree.children.length - 1, -1, e, -2);
    }
    prop(e) {
      return this._tree.prop(e);
    }
    enter(e, t, i = 0) {
      let s;
      if (!(i & Q.IgnoreOverlays) && (s = It.get(this._tree)) && s.overlay) {
        let r = e - this.from, o = i & Q.EnterBracketed && s.bracketed;
        for (let { from: l, to: a } of s.overlay) if ((t > 0 || o ? l <= r : l < r) && (t < 0 || o ? a >= r : a > r)) return new n48(s.tree, s.overlay[0].from + this.from, -1, this);
      }
      return this.nextChild(0, 1, e, t, i);
    }
    nextSignificantParent() {
      let e = this;
      for (; e.type.isAnonymous && e._parent; ) e = e._parent;
      return e;
    }
    get parent() {
      return this._parent ? this._parent.nextSignificantParent() : null;
    }
    get nextSibling() {
      return this._parent && this.index >= 0 ? this._parent.nextChild(this.index + 1, 1, 0, 4) : null;
    }
    get prevSibling() {
      return this._parent && this.index >= 0 ? this._parent.nextChild(this.index - 1, -1, 0, 4) : null;
    }
    get tree() {
      return this._tree;
    }
    toTree() {
      return this._tree;
    }
    toString() {
      return this._tree.toString();
    }
  };
  function qh(n66, e, t, i) {
    let s = n66.cursor(), r = [];
    if (!s.firstChild()) return r;
    if (t != null) {
      for (let o = false; !o; ) if (o = s.type.is(t), !s.nextSibling()) return r;
    }
    for (; ; ) {
      if (i != null && s.type.is(i)) return r;
      if (s.type.is(e) && r.push(s.node), !s.nextSibling()) return i == null ? r : [];
    }
  }
  function Do2(n66, e, t = e.length - 1) {
    for (let i = n66; t >= 0; i = i.parent) {
      if (!i) return false;
      if (!i.type.isAnonymous) {
        if (e[t] && e[t] != i.name) return false;
        t--;
      }
    }
    return true;
  }
  var Oo2 = class {
    constructor(e, t, i, s) {
      this.parent = e, this.buffer = t, this.index = i, this.start = s;
    }
  };
  var ji2 = class n49 extends ss2 {
    get name() {
      return this.type.name;
    }
    get from() {
      return this.context.start + this.context.buffer.buffer[this.index + 1];
    }
    get to() {
      return this.context.start + this.context.buffer.buffer[this.index + 2];
    }
    constructor(e, t, i) {
      super(), this.context = e, this._parent = t, this.index = i, this.type = e.buffer.set.types[e.buffer.buffer[i]];
    }
    child(e, t, i) {
      let { buffer: s } = this.context, r = s.findChild(this.index + 4, s.buffer[this.index + 3], e, t - this.context.start, i);
      return r < 0 ? null : new n49(this.context, this, r);
    }
    get firstChild() {
      return this.child(1, 0, 4);
    }
    get lastChild() {
      return this.child(-1, 0, 4);
    }
    childAfter(e) {
      return this.child(1, e, 2);
    }
    childBefore(e) {
      return this.child(-1, e, -2);
    }
    prop(e) {
      return this.type.prop(e);
    }
    enter(e, t, i = 0) {
      if (i & Q.ExcludeBuffers) return null;
      let { buffer: s } = this.context, r = s.findChild(this.index + 4, s.buffer[this.index + 3], t > 0 ? 1 : -1, e - this.context.start, t);
      return r < 0 ? null : new n49(this.context, this, r);
    }
    get parent() {
      return this._parent || this.context.parent.nextSignificantParent();
    }
    externalSibling(e) {
      return this._parent ? null : this.context.parent.nextChild(this.context.index + e, e, 0, 4);
    }
    get nextSibling() {
      let { buffer: e } = this.context, t = e.buffer[this.index + 3];
      return t < (this._parent ? e.buffer[this._parent.index + 3] : e.buffer.length) ? new n49(this.context, this._parent, t) : this.externalSibling(1);
    }
    get prevSibling() {
      let { buffer: e } = this.context, t = this._parent ? this._parent.index + 4 : 0;
      return this.index == t ? this.externalSibling(-1) : new n49(this.context, this._parent, e.findChild(t, this.index, -1, 0, 4));
    }
    get tree() {
      return null;
    }
    toTree() {
      let e = [], t = [], { buffer: i } = this.context, s = this.index + 4, r = i.buffer[this.index + 3];
      if (r > s) {
        let o = i.buffer[this.index + 1];
        e.push(i.slice(s, r, o)), t.push(0);
      }
      return new he(this.type, e, t, this.to - this.from);
    }
    toString() {
      return this.context.buffer.childString(this.index);
    }
  };
  function jh(n66) {
    if (!n66.length) return null;
    let e = 0, t = n66[0];
    for (let r = 1; r < n66.length; r++) {
      let o = n66[r];
      (o.from > t.from || o.to < t.to) && (t = o, e = r);
    }
    let i = t instanceof et2 && t.index < 0 ? null : t.parent, s = n66.slice();
    return i ? s[e] = i : s.splice(e, 1), new Bo2(s, t);
  }
  var Bo2 = class {
    constructor(e, t) {
      this.heads = e, this.node = t;
    }
    get next() {
      return jh(this.heads);
    }
  };
  function Ed(n66, e, t) {
    let i = n66.resolveInner(e, t), s = null;
    for (let r = i instanceof et2 ? i : i.context.parent; r; r = r.parent) if (r.index < 0) {
      let o = r.parent;
      (s || (s = [i])).push(o.resolve(e, t)), r = o;
    } else {
      let o = It.get(r.tree);
      if (o && o.overlay && o.overlay[0].from <= e && o.overlay[o.overlay.length - 1].to >= e) {
        let l = new et2(o.tree, o.overlay[0].from + r.from, -1, r);
        (s || (s = [i])).push($i2(l, e, t, false));
      }
    }
    return s ? jh(s) : i;
  }
  var Ui = class {
    get name() {
      return this.type.name;
    }
    constructor(e, t = 0) {
      if (this.buffer = null, this.stack = [], this.index = 0, this.bufferNode = null, this.mode = t & ~Q.EnterBracketed, e instanceof et2) this.yieldNode(e);
      else {
        this._tree = e.context.parent, this.buffer = e.context;
        for (let i = e._parent; i; i = i._parent) this.stack.unshift(i.index);
        this.bufferNode = e, this.yieldBuf(e.index);
      }
    }
    yieldNode(e) {
      return e ? (this._tree = e, this.type = e.type, this.from = e.from, this.to = e.to, true) : false;
    }
    yieldBuf(e, t) {
      this.index = e;
      let { start: i, buffer: s } = this.buffer;
      return this.type = t || s.set.types[s.buffer[e]], this.from = i + s.buffer[e + 1], this.to = i + s.buffer[e + 2], true;
    }
    yield(e) {
      return e ? e instanceof et2 ? (this.buffer = null, this.yieldNode(e)) : (this.buffer = e.context, this.yieldBuf(e.index, e.type)) : false;
    }
    toString() {
      return this.buffer ? this.buffer.buffer.childString(this.index) : this._tree.toString();
    }
    enterChild(e, t, i) {
      if (!this.buffer) return this.yield(this._tree.nextChild(e < 0 ? this._tree._tree.children.length - 1 : 0, e, t, i, this.mode));
      let { buffer: s } = this.buffer, r = s.findChild(this.index + 4, s.buffer[this.index + 3], e, t - this.buffer.start, i);
      return r < 0 ? false : (this.stack.push(this.index), this.yieldBuf(r));
    }
    firstChild() {
      return this.enterChild(1, 0, 4);
    }
    lastChild() {
      return this.enterChild(-1, 0, 4);
    }
    childAfter(e) {
      return this.enterChild(1, e, 2);
    }
    childBefore(e) {
      return this.enterChild(-1, e, -2);
    }
    enter(e, t, i = this.mode) {
      return this.buffer ? i & Q.ExcludeBuffers ? false : this.enterChild(1, e, t) : this.yield(this._tree.enter(e, t, i));
    }
    parent() {
      if (!this.buffer) return this.yieldNode(this.mode & Q.IncludeAnonymous ? this._tree._parent : this._tree.parent);
      if (this.stack.length) return this.yieldBuf(this.stack.pop());
      let e = this.mode & Q.IncludeAnonymous ? this.buffer.parent : this.buffer.parent.nextSignificantParent();
      return this.buffer = null, this.yieldNode(e);
    }
    sibling(e) {
      if (!this.buffer) return this._tree._parent ? this.yield(this._tree.index < 0 ? null : this._tree._parent.nextChild(this._tree.index + e, e, 0, 4, this.mode)) : false;
      let { buffer: t } = this.buffer, i = this.stack.length - 1;
      if (e < 0) {
        let s = i < 0 ? 0 : this.stack[i] + 4;
        if (this.index != s) return this.yieldBuf(t.findChild(s, this.index, -1, 0, 4));
      } else {
        let s = t.buffer[this.index + 3];
        if (s < (i < 0 ? t.buffer.length : t.buffer[this.stack[i] + 3])) return this.yieldBuf(s);
      }
      return i < 0 ? this.yield(this.buffer.parent.nextChild(this.buffer.index + e, e, 0, 4, this.mode)) : false;
    }
    nextSibling() {
      return this.sibling(1);
    }
    prevSibling() {
      return this.sibling(-1);
    }
    atLastNode(e) {
      let t, i, { buffer: s } = this;
      if (s) {
        if (e > 0) {
          if (this.index < s.buffer.buffer.length) return false;
        } else for (let r = 0; r < this.index; r++) if (s.buffer.buffer[r + 3] < this.index) return false;
        ({ index: t, parent: i } = s);
      } else ({ index: t, _parent: i } = this._tree);
      for (; i; { index: t, _parent: i } = i) if (t > -1) for (let r = t + e, o = e < 0 ? -1 : i._tree.children.length; r != o; r += e) {
        let l = i._tree.children[r];
        if (this.mode & Q.IncludeAnonymous || l instanceof bt2 || !l.type.isAnonymous || Lo2(l)) return false;
      }
      return true;
    }
    move(e, t) {
      if (t && this.enterChild(e, 0, 4)) return true;
      for (; ; ) {
        if (this.sibling(e)) return true;
        if (this.atLastNode(e) || !this.parent()) return false;
      }
    }
    next(e = true) {
      return this.move(1, e);
    }
    prev(e = true) {
      return this.move(-1, e);
    }
    moveTo(e, t = 0) {
      for (; (this.from == this.to || (t < 1 ? this.from >= e : this.from > e) || (t > -1 ? this.to <= e : this.to < e)) && this.parent(); ) ;
      for (; this.enterChild(1, e, t); ) ;
      return this;
    }
    get node() {
      if (!this.buffer) return this._tree;
      let e = this.bufferNode, t = null, i = 0;
      if (e && e.context == this.buffer) e: for (let s = this.index, r = this.stack.length; r >= 0; ) {
        for (let o = e; o; o = o._parent) if (o.index == s) {
          if (s == this.index) return o;
          t = o, i = r + 1;
          break e;
        }
        s = this.stack[--r];
      }
      for (let s = i; s < this.stack.length; s++) t = new ji2(this.buffer, t, this.stack[s]);
      return this.bufferNode = new ji2(this.buffer, t, this.index);
    }
    get tree() {
      return this.buffer ? null : this._tree._tree;
    }
    iterate(e, t) {
      for (let i = 0; ; ) {
        let s = false;
        if (this.type.isAnonymous || e(this) !== false) {
          if (this.firstChild()) {
            i++;
            continue;
          }
          this.type.isAnonymous || (s = true);
        }
        for (; ; ) {
          if (s && t && t(this), s = this.type.isAnonymous, !i) return;
          if (this.nextSibling()) break;
          this.parent(), i--, s = true;
        }
      }
    }
    matchContext(e) {
      if (!this.buffer) return Do2(this.node.parent, e);
      let { buffer: t } = this.buffer, { types: i } = t.set;
      for (let s = e.length - 1, r = this.stack.length - 1; s >= 0; r--) {
        if (r < 0) return Do2(this._tree, e, s);
        let o = i[t.buffer[this.stack[r]]];
        if (!o.isAnonymous) {
          if (e[s] && e[s] != o.name) return false;
          s--;
        }
      }
      return true;
    }
  };
  function Lo2(n66) {
    return n66.children.some((e) => e instanceof bt2 || !e.type.isAnonymous || Lo2(e));
  }
  function Ld(n66) {
    var e;
    let { buffer: t, nodeSet: i, maxBufferLength: s = 1024, reused: r = [], minRepeatType: o = i.types.length } = n66, l = Array.isArray(t) ? new To2(t, t.length) : t, a = i.types, h = 0, c = 0;
    function f(w, k, S2, R, N, K) {
      let { id: I, start: B, end: q, size: W } = l, U = c, ce2 = h;
      if (W < 0) if (l.next(), W == -1) {
        let st = r[I];
        S2.push(st), R.push(B - w);
        return;
      } else if (W == -3) {
        h = I;
        return;
      } else if (W == -4) {
        c = I;
        return;
      } else throw new RangeError(`Unrecognized record size: ${W}`);
      let we = a[I], _e, re2, Ae2 = B - w;
      if (q - B <= s && (re2 = g(l.pos - k, N))) {
        let st = new Uint16Array(re2.size - re2.skip), me = l.pos - re2.size, Fe = st.length;
        for (; l.pos > me; ) Fe = y(re2.start, st, Fe);
        _e = new bt2(st, q - re2.start, i), Ae2 = re2.start - w;
      } else {
        let st = l.pos - W;
        l.next();
        let me = [], Fe = [], Ye = I >= o ? I : -1, rt = 0, Kt = q, xi = U;
        for (; l.pos > st; ) Ye >= 0 && l.id == Ye && l.size >= 0 ? (l.end <= Kt - s && (p(me, Fe, B, rt, l.end, Kt, Ye, xi, ce2), rt = me.length, Kt = l.end, xi = c), l.next()) : K > 2500 ? u(B, st, me, Fe) : (Ye >= 0 && l.size == -1 && r[l.id].type == i.types[Ye] && (rt < me.length && p(me, Fe, B, rt, l.end, Kt, Ye, xi, ce2), rt = me.length + 1, Kt = l.start, xi = c), f(B, st, me, Fe, Ye, K + 1));
        if (Ye >= 0 && rt > 0 && rt < me.length && p(me, Fe, B, rt, B, Kt, Ye, xi, ce2), me.reverse(), Fe.reverse(), Ye > -1 && rt > 0) {
          let Cl = d(we, ce2);
          _e = Ro2(we, me, Fe, 0, me.length, 0, q - B, Cl, Cl);
        } else _e = m(we, me, Fe, q - B, U - q, ce2);
      }
      S2.push(_e), R.push(Ae2);
    }
    function u(w, k, S2, R) {
      let N = [], K = 0, I = -1;
      for (; l.pos > k; ) {
        let { id: B, start: q, end: W, size: U } = l;
        if (U > 4) l.next();
        else {
          if (I > -1 && q < I) break;
          I < 0 && (I = W - s), N.push(B, q, W), K++, l.next();
        }
      }
      if (K) {
        let B = new Uint16Array(K * 4), q = N[N.length - 2];
        for (let W = N.length - 3, U = 0; W >= 0; W -= 3) B[U++] = N[W], B[U++] = N[W + 1] - q, B[U++] = N[W + 2] - q, B[U++] = U;
        S2.push(new bt2(B, N[2] - q, i)), R.push(q - w);
      }
    }
    function d(w, k) {
      return (S2, R, N) => {
        let K = 0, I = S2.length - 1, B, q;
        if (I >= 0 && (B = S2[I]) instanceof he) {
          if (!I && B.type == w && B.length == N) return B;
          (q = B.prop(P.lookAhead)) && (K = R[I] + B.length + q - N);
        }
        return m(w, S2, R, N, K, k);
      };
    }
    function p(w, k, S2, R, N, K, I, B, q) {
      let W = [], U = [];
      for (; w.length > R; ) W.push(w.pop()), U.push(k.pop() + S2 - N);
      w.push(m(i.types[I], W, U, K - N, B - K, q)), k.push(N - S2);
    }
    function m(w, k, S2, R, N, K, I) {
      if (K) {
        let B = [P.contextHash, K];
        I = I ? [B].concat(I) : [B];
      }
      if (N > 25) {
        let B = [P.lookAhead, N];
        I = I ? [B].concat(I) : [B];
      }
      return new he(w, k, S2, R, I);
    }
    function g(w, k) {
      let S2 = l.fork(), R = 0, N = 0, K = 0, I = S2.end - s, B = { size: 0, start: 0, skip: 0 };
      e: for (let q = S2.pos - w; S2.pos > q; ) {
        let W = S2.size;
        if (S2.id == k && W >= 0) {
          B.size = R, B.start = N, B.skip = K, K += 4, R += 4, S2.next();
          continue;
        }
        let U = S2.pos - W;
        if (W < 0 || U < q || S2.start < I) break;
        let ce2 = S2.id >= o ? 4 : 0, we = S2.start;
        for (S2.next(); S2.pos > U; ) {
          if (S2.size < 0) if (S2.size == -3 || S2.size == -4) ce2 += 4;
          else break e;
          else S2.id >= o && (ce2 += 4);
          S2.next();
        }
        N = we, R += W, K += ce2;
      }
      return (k < 0 || R == w) && (B.size = R, B.start = N, B.skip = K), B.size > 4 ? B : void 0;
    }
    function y(w, k, S2) {
      let { id: R, start: N, end: K, size: I } = l;
      if (l.next(), I >= 0 && R < o) {
        let B = S2;
        if (I > 4) {
          let q = l.pos - (I - 4);
          for (; l.pos > q; ) S2 = y(w, k, S2);
        }
        k[--S2] = B, k[--S2] = K - w, k[--S2] = N - w, k[--S2] = R;
      } else I == -3 ? h = R : I == -4 && (c = R);
      return S2;
    }
    let v = [], b = [];
    for (; l.pos > 0; ) f(n66.start || 0, n66.bufferStart || 0, v, b, -1, 0);
    let D = (e = n66.length) !== null && e !== void 0 ? e : v.length ? b[0] + v[0].length : 0;
    return new he(a[n66.topID], v.reverse(), b.reverse(), D);
  }
  var Kh = /* @__PURE__ */ new WeakMap();
  function ns2(n66, e) {
    if (!n66.isAnonymous || e instanceof bt2 || e.type != n66) return 1;
    let t = Kh.get(e);
    if (t == null) {
      t = 1;
      for (let i of e.children) {
        if (i.type != n66 || !(i instanceof he)) {
          t = 1;
          break;
        }
        t += ns2(n66, i);
      }
      Kh.set(e, t);
    }
    return t;
  }
  function Ro2(n66, e, t, i, s, r, o, l, a) {
    let h = 0;
    for (let p = i; p < s; p++) h += ns2(n66, e[p]);
    let c = Math.ceil(h * 1.5 / 8), f = [], u = [];
    function d(p, m, g, y, v) {
      for (let b = g; b < y; ) {
        let D = b, w = m[b], k = ns2(n66, p[b]);
        for (b++; b < y; b++) {
          let S2 = ns2(n66, p[b]);
          if (k + S2 >= c) break;
          k += S2;
        }
        if (b == D + 1) {
          if (k > c) {
            let S2 = p[D];
            d(S2.children, S2.positions, 0, S2.children.length, m[D] + v);
            continue;
          }
          f.push(p[D]);
        } else {
          let S2 = m[b - 1] + p[b - 1].length - w;
          f.push(Ro2(n66, p, m, D, b, w, S2, null, a));
        }
        u.push(w + v - r);
      }
    }
    return d(e, t, i, s, 0), (l || a)(f, u, o);
  }
  var Nt = class n50 {
    constructor(e, t, i, s, r = false, o = false) {
      this.from = e, this.to = t, this.tree = i, this.offset = s, this.open = (r ? 1 : 0) | (o ? 2 : 0);
    }
    get openStart() {
      return (this.open & 1) > 0;
    }
    get openEnd() {
      return (this.open & 2) > 0;
    }
    static addTree(e, t = [], i = false) {
      let s = [new n50(0, e.length, e, 0, false, i)];
      for (let r of t) r.to > e.length && s.push(r);
      return s;
    }
    static applyChanges(e, t, i = 128) {
      if (!t.length) return e;
      let s = [], r = 1, o = e.length ? e[0] : null;
      for (let l = 0, a = 0, h = 0; ; l++) {
        let c = l < t.length ? t[l] : null, f = c ? c.fromA : 1e9;
        if (f - a >= i) for (; o && o.from < f; ) {
          let u = o;
          if (a >= u.from || f <= u.to || h) {
            let d = Math.max(u.from, a) - h, p = Math.min(u.to, f) - h;
            u = d >= p ? null : new n50(d, p, u.tree, u.offset + h, l > 0, !!c);
          }
          if (u && s.push(u), o.to > f) break;
          o = r < e.length ? e[r++] : null;
        }
        if (!c) break;
        a = c.toA, h = c.toA - c.toB;
      }
      return s;
    }
  };
  var rs2 = class {
    startParse(e, t, i) {
      return typeof e == "string" && (e = new Eo2(e)), i = i ? i.length ? i.map((s) => new Ki(s.from, s.to)) : [new Ki(0, 0)] : [new Ki(0, e.length)], this.createParse(e, t || [], i);
    }
    parse(e, t, i) {
      let s = this.startParse(e, t, i);
      for (; ; ) {
        let r = s.advance();
        if (r) return r;
      }
    }
  };
  var Eo2 = class {
    constructor(e) {
      this.string = e;
    }
    get length() {
      return this.string.length;
    }
    chunk(e) {
      return this.string.slice(e);
    }
    get lineChunks() {
      return false;
    }
    read(e, t) {
      return this.string.slice(e, t);
    }
  };
  var _g = new P({ perNode: true });
  var Rd = 0;
  var qe = class n51 {
    constructor(e, t, i, s) {
      this.name = e, this.set = t, this.base = i, this.modified = s, this.id = Rd++;
    }
    toString() {
      let { name: e } = this;
      for (let t of this.modified) t.name && (e = `${t.name}(${e})`);
      return e;
    }
    static define(e, t) {
      let i = typeof e == "string" ? e : "?";
      if (e instanceof n51 && (t = e), t?.base) throw new Error("Can not derive from a modified tag");
      let s = new n51(i, [], null, []);
      if (s.set.push(s), t) for (let r of t.set) s.set.push(r);
      return s;
    }
    static defineModifier(e) {
      let t = new hs2(e);
      return (i) => i.modified.indexOf(t) > -1 ? i : hs2.get(i.base || i, i.modified.concat(t).sort((s, r) => s.id - r.id));
    }
  };
  var Pd = 0;
  var hs2 = class n52 {
    constructor(e) {
      this.name = e, this.instances = [], this.id = Pd++;
    }
    static get(e, t) {
      if (!t.length) return e;
      let i = t[0].instances.find((l) => l.base == e && Id(t, l.modified));
      if (i) return i;
      let s = [], r = new qe(e.name, s, e, t);
      for (let l of t) l.instances.push(r);
      let o = Nd(t);
      for (let l of e.set) if (!l.modified.length) for (let a of o) s.push(n52.get(l, a));
      return r;
    }
  };
  function Id(n66, e) {
    return n66.length == e.length && n66.every((t, i) => t == e[i]);
  }
  function Nd(n66) {
    let e = [[]];
    for (let t = 0; t < n66.length; t++) for (let i = 0, s = e.length; i < s; i++) e.push(e[i].concat(n66[t]));
    return e.sort((t, i) => i.length - t.length);
  }
  function _h(n66) {
    let e = /* @__PURE__ */ Object.create(null);
    for (let t in n66) {
      let i = n66[t];
      Array.isArray(i) || (i = [i]);
      for (let s of t.split(" ")) if (s) {
        let r = [], o = 2, l = s;
        for (let f = 0; ; ) {
          if (l == "..." && f > 0 && f + 3 == s.length) {
            o = 1;
            break;
          }
          let u = /^"(?:[^"\\]|\\.)*?"|[^\/!]+/.exec(l);
          if (!u) throw new RangeError("Invalid path: " + s);
          if (r.push(u[0] == "*" ? "" : u[0][0] == '"' ? JSON.parse(u[0]) : u[0]), f += u[0].length, f == s.length) break;
          let d = s[f++];
          if (f == s.length && d == "!") {
            o = 0;
            break;
          }
          if (d != "/") throw new RangeError("Invalid path: " + s);
          l = s.slice(f);
        }
        let a = r.length - 1, h = r[a];
        if (!h) throw new RangeError("Invalid path: " + s);
        let c = new fi2(i, o, a > 0 ? r.slice(0, a) : null);
        e[h] = c.sort(e[h]);
      }
    }
    return Fd.add(e);
  }
  var Fd = new P({ combine(n66, e) {
    let t, i, s;
    for (; n66 || e; ) {
      if (!n66 || e && n66.depth <= e.depth ? (s = e, e = e.next) : (s = n66, n66 = n66.next), t && t.mode == s.mode && !s.context && !t.context) continue;
      let r = new fi2(s.tags, s.mode, s.context);
      t ? t.next = r : i = r, t = r;
    }
    return i;
  } });
  var fi2 = class {
    constructor(e, t, i, s) {
      this.tags = e, this.mode = t, this.context = i, this.next = s;
    }
    get opaque() {
      return this.mode == 0;
    }
    get inherit() {
      return this.mode == 1;
    }
    sort(e) {
      return !e || e.depth < this.depth ? (this.next = e, this) : (e.next = this.sort(e.next), e);
    }
    get depth() {
      return this.context ? this.context.length : 0;
    }
  };
  fi2.empty = new fi2([], 2, null);
  function No2(n66, e) {
    let t = /* @__PURE__ */ Object.create(null);
    for (let r of n66) if (!Array.isArray(r.tag)) t[r.tag.id] = r.class;
    else for (let o of r.tag) t[o.id] = r.class;
    let { scope: i, all: s = null } = e || {};
    return { style: (r) => {
      let o = s;
      for (let l of r) for (let a of l.set) {
        let h = t[a.id];
        if (h) {
          o = o ? o + " " + h : h;
          break;
        }
      }
      return o;
    }, scope: i };
  }
  var C = qe.define;
  var os2 = C();
  var xt = C();
  var Uh = C(xt);
  var Gh = C(xt);
  var wt2 = C();
  var ls2 = C(wt2);
  var Po2 = C(wt2);
  var nt = C();
  var Ft = C(nt);
  var tt2 = C();
  var it = C();
  var Io2 = C();
  var Gi = C(Io2);
  var as2 = C();
  var M = { comment: os2, lineComment: C(os2), blockComment: C(os2), docComment: C(os2), name: xt, variableName: C(xt), typeName: Uh, tagName: C(Uh), propertyName: Gh, attributeName: C(Gh), className: C(xt), labelName: C(xt), namespace: C(xt), macroName: C(xt), literal: wt2, string: ls2, docString: C(ls2), character: C(ls2), attributeValue: C(ls2), number: Po2, integer: C(Po2), float: C(Po2), bool: C(wt2), regexp: C(wt2), escape: C(wt2), color: C(wt2), url: C(wt2), keyword: tt2, self: C(tt2), null: C(tt2), atom: C(tt2), unit: C(tt2), modifier: C(tt2), operatorKeyword: C(tt2), controlKeyword: C(tt2), definitionKeyword: C(tt2), moduleKeyword: C(tt2), operator: it, derefOperator: C(it), arithmeticOperator: C(it), logicOperator: C(it), bitwiseOperator: C(it), compareOperator: C(it), updateOperator: C(it), definitionOperator: C(it), typeOperator: C(it), controlOperator: C(it), punctuation: Io2, separator: C(Io2), bracket: Gi, angleBracket: C(Gi), squareBracket: C(Gi), paren: C(Gi), brace: C(Gi), content: nt, heading: Ft, heading1: C(Ft), heading2: C(Ft), heading3: C(Ft), heading4: C(Ft), heading5: C(Ft), heading6: C(Ft), contentSeparator: C(nt), list: C(nt), quote: C(nt), emphasis: C(nt), strong: C(nt), link: C(nt), monospace: C(nt), strikethrough: C(nt), inserted: C(), deleted: C(), changed: C(), invalid: C(), meta: as2, documentMeta: C(as2), annotation: C(as2), processingInstruction: C(as2), definition: qe.defineModifier("definition"), constant: qe.defineModifier("constant"), function: qe.defineModifier("function"), standard: qe.defineModifier("standard"), local: qe.defineModifier("local"), special: qe.defineModifier("special") };
  for (let n66 in M) {
    let e = M[n66];
    e instanceof qe && (e.name = n66);
  }
  var Jg = No2([{ tag: M.link, class: "tok-link" }, { tag: M.heading, class: "tok-heading" }, { tag: M.emphasis, class: "tok-emphasis" }, { tag: M.strong, class: "tok-strong" }, { tag: M.keyword, class: "tok-keyword" }, { tag: M.atom, class: "tok-atom" }, { tag: M.bool, class: "tok-bool" }, { tag: M.url, class: "tok-url" }, { tag: M.labelName, class: "tok-labelName" }, { tag: M.inserted, class: "tok-inserted" }, { tag: M.deleted, class: "tok-deleted" }, { tag: M.literal, class: "tok-literal" }, { tag: M.string, class: "tok-string" }, { tag: M.number, class: "tok-number" }, { tag: [M.regexp, M.escape, M.special(M.string)], class: "tok-string2" }, { tag: M.variableName, class: "tok-variableName" }, { tag: M.local(M.variableName), class: "tok-variableName tok-local" }, { tag: M.definition(M.variableName), class: "tok-variableName tok-definition" }, { tag: M.special(M.variableName), class: "tok-variableName2" }, { tag: M.definition(M.propertyName), class: "tok-propertyName tok-definition" }, { tag: M.typeName, class: "tok-typeName" }, { tag: M.namespace, class: "tok-namespace" }, { tag: M.className, class: "tok-className" }, { tag: M.macroName, class: "tok-macroName" }, { tag: M.propertyName, class: "tok-propertyName" }, { tag: M.operator, class: "tok-operator" }, { tag: M.comment, class: "tok-comment" }, { tag: M.meta, class: "tok-meta" }, { tag: M.invalid, class: "tok-invalid" }, { tag: M.punctuation, class: "tok-punctuation" }]);
  var Fo2;
  var Yi = new P();
  var Wd = new P();
  var Pe = class {
    constructor(e, t, i = [], s = "") {
      this.data = e, this.name = s, _.prototype.hasOwnProperty("tree") || Object.defineProperty(_.prototype, "tree", { get() {
        return Ke(this);
      } }), this.parser = t, this.extension = [ui2.of(this), _.languageData.of((r, o, l) => {
        let a = Yh(r, o, l), h = a.type.prop(Yi);
        if (!h) return [];
        let c = r.facet(h), f = a.type.prop(Wd);
        if (f) {
          let u = a.resolve(o - a.from, l);
          for (let d of f) if (d.test(u, r)) {
            let p = r.facet(d.facet);
            return d.type == "replace" ? p : p.concat(c);
          }
        }
        return c;
      })].concat(i);
    }
    isActiveAt(e, t, i = -1) {
      return Yh(e, t, i).type.prop(Yi) == this.data;
    }
    findRegions(e) {
      let t = e.facet(ui2);
      if (t?.data == this.data) return [{ from: 0, to: e.doc.length }];
      if (!t || !t.allowsNesting) return [];
      let i = [], s = (r, o) => {
        if (r.prop(Yi) == this.data) {
          i.push({ from: o, to: o + r.length });
          return;
        }
        let l = r.prop(P.mounted);
        if (l) {
          if (l.tree.prop(Yi) == this.data) {
            if (l.overlay) for (let a of l.overlay) i.push({ from: a.from + o, to: a.to + o });
            else i.push({ from: o, to: o + r.length });
            return;
          } else if (l.overlay) {
            let a = i.length;
            if (s(l.tree, l.overlay[0].from + o), i.length > a) return;
          }
        }
        for (let a = 0; a < r.children.length; a++) {
          let h = r.children[a];
          h instanceof he && s(h, r.positions[a] + o);
        }
      };
      return s(Ke(e), 0), i;
    }
    get allowsNesting() {
      return true;
    }
  };
  Pe.setState = E.define();
  function Yh(n66, e, t) {
    let i = n66.facet(ui2), s = Ke(n66).topNode;
    if (!i || i.allowsNesting) for (let r = s; r; r = r.enter(e, t, Q.ExcludeBuffers | Q.EnterBracketed)) r.type.isTop && (s = r);
    return s;
  }
  function Ke(n66) {
    let e = n66.field(Pe.state, false);
    return e ? e.tree : he.empty;
  }
  var Vo2 = class {
    constructor(e) {
      this.doc = e, this.cursorPos = 0, this.string = "", this.cursor = e.iter();
    }
    get length() {
      return this.doc.length;
    }
    syncTo(e) {
      return this.string = this.cursor.next(e - this.cursorPos).value, this.cursorPos = e + this.string.length, this.cursorPos - this.string.length;
    }
    chunk(e) {
      return this.syncTo(e), this.string;
    }
    get lineChunks() {
      return true;
    }
    read(e, t) {
      let i = this.cursorPos - this.string.length;
      return e < i || t >= this.cursorPos ? this.doc.sliceString(e, t) : this.string.slice(e - i, t - i);
    }
  };
  var _i = null;
  var zo2 = class n53 {
    constructor(e, t, i = [], s, r, o, l, a) {
      this.parser = e, this.state = t, this.fragments = i, this.tree = s, this.treeLen = r, this.viewport = o, this.skipped = l, this.scheduleOn = a, this.parse = null, this.tempSkipped = [];
    }
    static create(e, t, i) {
      return new n53(e, t, [], he.empty, 0, i, [], null);
    }
    startParse() {
      return this.parser.startParse(new Vo2(this.state.doc), this.fragments);
    }
    work(e, t) {
      return t != null && t >= this.state.doc.length && (t = void 0), this.tree != he.empty && this.isDone(t ?? this.state.doc.length) ? (this.takeTree(), true) : this.withContext(() => {
        var i;
        if (typeof e == "number") {
          let s = Date.now() + e;
          e = () => Date.now() > s;
        }
        for (this.parse || (this.parse = this.startParse()), t != null && (this.parse.stoppedAt == null || this.parse.stoppedAt > t) && t < this.state.doc.length && this.parse.stopAt(t); ; ) {
          let s = this.parse.advance();
          if (s) if (this.fragments = this.withoutTempSkipped(Nt.addTree(s, this.fragments, this.parse.stoppedAt != null)), this.treeLen = (i = this.parse.stoppedAt) !== null && i !== void 0 ? i : this.state.doc.length, this.tree = s, this.parse = null, this.treeLen < (t ?? this.state.doc.length)) this.parse = this.startParse();
          else return true;
          if (e()) return false;
        }
      });
    }
    takeTree() {
      let e, t;
      this.parse && (e = this.parse.parsedPos) >= this.treeLen && ((this.parse.stoppedAt == null || this.parse.stoppedAt > e) && this.parse.stopAt(e), this.withContext(() => {
        for (; !(t = this.parse.advance()); ) ;
      }), this.treeLen = e, this.tree = t, this.fragments = this.withoutTempSkipped(Nt.addTree(this.tree, this.fragments, true)), this.parse = null);
    }
    withContext(e) {
      let t = _i;
      _i = this;
      try {
        return e();
      } finally {
        _i = t;
      }
    }
    withoutTempSkipped(e) {
      for (let t; t = this.tempSkipped.pop(); ) e = Xh(e, t.from, t.to);
      return e;
    }
    changes(e, t) {
      let { fragments: i, tree: s, treeLen: r, viewport: o, skipped: l } = this;
      if (this.takeTree(), !e.empty) {
        let a = [];
        if (e.iterChangedRanges((h, c, f, u) => a.push({ fromA: h, toA: c, fromB: f, toB: u })), i = Nt.applyChanges(i, a), s = he.empty, r = 0, o = { from: e.mapPos(o.from, -1), to: e.mapPos(o.to, 1) }, this.skipped.length) {
          l = [];
          for (let h of this.skipped) {
            let c = e.mapPos(h.from, 1), f = e.mapPos(h.to, -1);
            c < f && l.push({ from: c, to: f });
          }
        }
      }
      return new n53(this.parser, t, i, s, r, o, l, this.scheduleOn);
    }
    updateViewport(e) {
      if (this.viewport.from == e.from && this.viewport.to == e.to) return false;
      this.viewport = e;
      let t = this.skipped.length;
      for (let i = 0; i < this.skipped.length; i++) {
        let { from: s, to: r } = this.skipped[i];
        s < e.to && r > e.from && (this.fragments = Xh(this.fragments, s, r), this.skipped.splice(i--, 1));
      }
      return this.skipped.length >= t ? false : (this.reset(), true);
    }
    reset() {
      this.parse && (this.takeTree(), this.parse = null);
    }
    skipUntilInView(e, t) {
      this.skipped.push({ from: e, to: t });
    }
    static getSkippingParser(e) {
      return new class extends rs2 {
        createParse(t, i, s) {
          let r = s[0].from, o = s[s.length - 1].to;
          return { parsedPos: r, advance() {
            let a = _i;
            if (a) {
              for (let h of s) a.tempSkipped.push(h);
              e && (a.scheduleOn = a.scheduleOn ? Promise.all([a.scheduleOn, e]) : e);
            }
            return this.parsedPos = o, new he(Se.none, [], [], o - r);
          }, stoppedAt: null, stopAt() {
          } };
        }
      }();
    }
    isDone(e) {
      e = Math.min(e, this.state.doc.length);
      let t = this.fragments;
      return this.treeLen >= e && t.length && t[0].from == 0 && t[0].to >= e;
    }
    static get() {
      return _i;
    }
  };
  function Xh(n66, e, t) {
    return Nt.applyChanges(n66, [{ fromA: e, toA: t, fromB: e, toB: t }]);
  }
  var Xi2 = class n54 {
    constructor(e) {
      this.context = e, this.tree = e.tree;
    }
    apply(e) {
      if (!e.docChanged && this.tree == this.context.tree) return this;
      let t = this.context.changes(e.changes, e.state), i = this.context.treeLen == e.startState.doc.length ? void 0 : Math.max(e.changes.mapPos(this.context.treeLen), t.viewport.to);
      return t.work(20, i) || t.takeTree(), new n54(t);
    }
    static init(e) {
      let t = Math.min(3e3, e.doc.length), i = zo2.create(e.facet(ui2).parser, e, { from: 0, to: t });
      return i.work(20, t) || i.takeTree(), new n54(i);
    }
  };
  Pe.state = J.define({ create: Xi2.init, update(n66, e) {
    for (let t of e.effects) if (t.is(Pe.setState)) return t.value;
    return e.startState.facet(ui2) != e.state.facet(ui2) ? Xi2.init(e.state) : n66.apply(e);
  } });
  var ec = (n66) => {
    let e = setTimeout(() => n66(), 500);
    return () => clearTimeout(e);
  };
  typeof requestIdleCallback < "u" && (ec = (n66) => {
    let e = -1, t = setTimeout(() => {
      e = requestIdleCallback(n66, { timeout: 400 });
    }, 100);
    return () => e < 0 ? clearTimeout(t) : cancelIdleCallback(e);
  });
  var Ho2 = typeof navigator < "u" && (!((Fo2 = navigator.scheduling) === null || Fo2 === void 0) && Fo2.isInputPending) ? () => navigator.scheduling.isInputPending() : null;
  var Vd = te.fromClass(class {
    constructor(e) {
      this.view = e, this.working = null, this.workScheduled = 0, this.chunkEnd = -1, this.chunkBudget = -1, this.work = this.work.bind(this), this.scheduleWork();
    }
    update(e) {
      let t = this.view.state.field(Pe.state).context;
      (t.updateViewport(e.view.viewport) || this.view.viewport.to > t.treeLen) && this.scheduleWork(), (e.docChanged || e.selectionSet) && (this.view.hasFocus && (this.chunkBudget += 50), this.scheduleWork()), this.checkAsyncSchedule(t);
    }
    scheduleWork() {
      if (this.working) return;
      let { state: e } = this.view, t = e.field(Pe.state);
      (t.tree != t.context.tree || !t.context.isDone(e.doc.length)) && (this.working = ec(this.work));
    }
    work(e) {
      this.working = null;
      let t = Date.now();
      if (this.chunkEnd < t && (this.chunkEnd < 0 || this.view.hasFocus) && (this.chunkEnd = t + 3e4, this.chunkBudget = 3e3), this.chunkBudget <= 0) return;
      let { state: i, viewport: { to: s } } = this.view, r = i.field(Pe.state);
      if (r.tree == r.context.tree && r.context.isDone(s + 1e5)) return;
      let o = Date.now() + Math.min(this.chunkBudget, 100, e && !Ho2 ? Math.max(25, e.timeRemaining() - 5) : 1e9), l = r.context.treeLen < s && i.doc.length > s + 1e3, a = r.context.work(() => Ho2 && Ho2() || Date.now() > o, s + (l ? 0 : 1e5));
      this.chunkBudget -= Date.now() - t, (a || this.chunkBudget <= 0) && (r.context.takeTree(), this.view.dispatch({ effects: Pe.setState.of(new Xi2(r.context)) })), this.chunkBudget > 0 && !(a && !l) && this.scheduleWork(), this.checkAsyncSchedule(r.context);
    }
    checkAsyncSchedule(e) {
      e.scheduleOn && (this.workScheduled++, e.scheduleOn.then(() => this.scheduleWork()).catch((t) => le(this.view.state, t)).then(() => this.workScheduled--), e.scheduleOn = null);
    }
    destroy() {
      this.working && this.working();
    }
    isWorking() {
      return !!(this.working || this.workScheduled > 0);
    }
  }, { eventHandlers: { focus() {
    this.scheduleWork();
  } } });
  var ui2 = T.define({ combine(n66) {
    return n66.length ? n66[0] : null;
  }, enables: (n66) => [Pe.state, Vd, O.contentAttributes.compute([n66], (e) => {
    let t = e.facet(n66);
    return t && t.name ? { "data-language": t.name } : {};
  })] });
  var zd = T.define();
  var Ji2 = T.define({ combine: (n66) => {
    if (!n66.length) return "  ";
    let e = n66[0];
    if (!e || /\S/.test(e) || Array.from(e).some((t) => t != e[0])) throw new Error("Invalid indent unit: " + JSON.stringify(n66[0]));
    return e;
  } });
  function Qi2(n66) {
    let e = n66.facet(Ji2);
    return e.charCodeAt(0) == 9 ? n66.tabSize * e.length : e.length;
  }
  function Zi2(n66, e) {
    let t = "", i = n66.tabSize, s = n66.facet(Ji2)[0];
    if (s == "	") {
      for (; e >= i; ) t += "	", e -= i;
      s = " ";
    }
    for (let r = 0; r < e; r++) t += s;
    return t;
  }
  function Uo2(n66, e) {
    n66 instanceof _ && (n66 = new Ht2(n66));
    for (let i of n66.state.facet(zd)) {
      let s = i(n66, e);
      if (s !== void 0) return s;
    }
    let t = Ke(n66.state);
    return t.length >= e ? Kd(n66, t, e) : null;
  }
  var Ht2 = class {
    constructor(e, t = {}) {
      this.state = e, this.options = t, this.unit = Qi2(e);
    }
    lineAt(e, t = 1) {
      let i = this.state.doc.lineAt(e), { simulateBreak: s, simulateDoubleBreak: r } = this.options;
      return s != null && s >= i.from && s <= i.to ? r && s == e ? { text: "", from: e } : (t < 0 ? s < e : s <= e) ? { text: i.text.slice(s - i.from), from: s } : { text: i.text.slice(0, s - i.from), from: i.from } : i;
    }
    textAfterPos(e, t = 1) {
      if (this.options.simulateDoubleBreak && e == this.options.simulateBreak) return "";
      let { text: i, from: s } = this.lineAt(e, t);
      return i.slice(e - s, Math.min(i.length, e + 100 - s));
    }
    column(e, t = 1) {
      let { text: i, from: s } = this.lineAt(e, t), r = this.countColumn(i, e - s), o = this.options.overrideIndentation ? this.options.overrideIndentation(s) : -1;
      return o > -1 && (r += o - this.countColumn(i, i.search(/\S|$/))), r;
    }
    countColumn(e, t = e.length) {
      return dt2(e, this.state.tabSize, t);
    }
    lineIndent(e, t = 1) {
      let { text: i, from: s } = this.lineAt(e, t), r = this.options.overrideIndentation;
      if (r) {
        let o = r(s);
        if (o > -1) return o;
      }
      return this.countColumn(i, i.search(/\S|$/));
    }
    get simulatedBreak() {
      return this.options.simulateBreak || null;
    }
  };
  var qd = new P();
  function Kd(n66, e, t) {
    let i = e.resolveStack(t), s = e.resolveInner(t, -1).resolve(t, 0).enterUnfinishedNodesBefore(t);
    if (s != i.node) {
      let r = [];
      for (let o = s; o && !(o.from < i.node.from || o.to > i.node.to || o.from == i.node.from && o.type == i.node.type); o = o.parent) r.push(o);
      for (let o = r.length - 1; o >= 0; o--) i = { node: r[o], next: i };
    }
    return tc(i, n66, t);
  }
  function tc(n66, e, t) {
    for (let i = n66; i; i = i.next) {
      let s = jd(i.node);
      if (s) return s(qo2.create(e, t, i));
    }
    return 0;
  }
  function $d(n66) {
    return n66.pos == n66.options.simulateBreak && n66.options.simulateDoubleBreak;
  }
  function jd(n66) {
    let e = n66.type.prop(qd);
    if (e) return e;
    let t = n66.firstChild, i;
    if (t && (i = t.type.prop(P.closedBy))) {
      let s = n66.lastChild, r = s && i.indexOf(s.name) > -1;
      return (o) => Yd(o, true, 1, void 0, r && !$d(o) ? s.from : void 0);
    }
    return n66.parent == null ? Ud : null;
  }
  function Ud() {
    return 0;
  }
  var qo2 = class n55 extends Ht2 {
    constructor(e, t, i) {
      super(e.state, e.options), this.base = e, this.pos = t, this.context = i;
    }
    get node() {
      return this.context.node;
    }
    static create(e, t, i) {
      return new n55(e, t, i);
    }
    get textAfter() {
      return this.textAfterPos(this.pos);
    }
    get baseIndent() {
      return this.baseIndentFor(this.node);
    }
    baseIndentFor(e) {
      let t = this.state.doc.lineAt(e.from);
      for (; ; ) {
        let i = e.resolve(t.from);
        for (; i.parent && i.parent.from == i.from; ) i = i.parent;
        if (Gd(i, e)) break;
        t = this.state.doc.lineAt(i.from);
      }
      return this.lineIndent(t.from);
    }
    continue() {
      return tc(this.context.next, this.base, this.pos);
    }
  };
  function Gd(n66, e) {
    for (let t = e; t; t = t.parent) if (n66 == t) return true;
    return false;
  }
  function _d(n66) {
    let e = n66.node, t = e.childAfter(e.from), i = e.lastChild;
    if (!t) return null;
    let s = n66.options.simulateBreak, r = n66.state.doc.lineAt(t.from), o = s == null || s <= r.from ? r.to : Math.min(r.to, s);
    for (let l = t.to; ; ) {
      let a = e.childAfter(l);
      if (!a || a == i) return null;
      if (!a.type.isSkipped) {
        if (a.from >= o) return null;
        let h = /^ */.exec(r.text.slice(t.to - r.from))[0].length;
        return { from: t.from, to: t.to + h };
      }
      l = a.to;
    }
  }
  function Yd(n66, e, t, i, s) {
    let r = n66.textAfter, o = r.match(/^\s*/)[0].length, l = i && r.slice(o, o + i.length) == i || s == n66.pos + o, a = e ? _d(n66) : null;
    return a ? l ? n66.column(a.from) : n66.column(a.to) : n66.baseIndent + (l ? 0 : n66.unit * t);
  }
  var Ko2 = class n56 {
    constructor(e, t) {
      this.specs = e;
      let i;
      function s(l) {
        let a = Oe.newName();
        return (i || (i = /* @__PURE__ */ Object.create(null)))["." + a] = l, a;
      }
      let r = typeof t.all == "string" ? t.all : t.all ? s(t.all) : void 0, o = t.scope;
      this.scope = o instanceof Pe ? (l) => l.prop(Yi) == o.data : o ? (l) => l == o : void 0, this.style = No2(e.map((l) => ({ tag: l.tag, class: l.class || s(Object.assign({}, l, { tag: null })) })), { all: r }).style, this.module = i ? new Oe(i) : null, this.themeType = t.themeType;
    }
    static define(e, t) {
      return new n56(e, t || {});
    }
  };
  var l0 = Ko2.define([{ tag: M.meta, color: "#404740" }, { tag: M.link, textDecoration: "underline" }, { tag: M.heading, textDecoration: "underline", fontWeight: "bold" }, { tag: M.emphasis, fontStyle: "italic" }, { tag: M.strong, fontWeight: "bold" }, { tag: M.strikethrough, textDecoration: "line-through" }, { tag: M.keyword, color: "#708" }, { tag: [M.atom, M.bool, M.url, M.contentSeparator, M.labelName], color: "#219" }, { tag: [M.literal, M.inserted], color: "#164" }, { tag: [M.string, M.deleted], color: "#a11" }, { tag: [M.regexp, M.escape, M.special(M.string)], color: "#e40" }, { tag: M.definition(M.variableName), color: "#00f" }, { tag: M.local(M.variableName), color: "#30a" }, { tag: [M.typeName, M.namespace], color: "#085" }, { tag: M.className, color: "#167" }, { tag: [M.special(M.variableName), M.macroName], color: "#256" }, { tag: M.definition(M.propertyName), color: "#00c" }, { tag: M.comment, color: "#940" }, { tag: M.invalid, color: "#f00" }]);
  var Xd = 1e4;
  var Jd = "()[]{}";
  var Qd = new P();
  function $o2(n66, e, t) {
    let i = n66.prop(e < 0 ? P.openedBy : P.closedBy);
    if (i) return i;
    if (n66.name.length == 1) {
      let s = t.indexOf(n66.name);
      if (s > -1 && s % 2 == (e < 0 ? 1 : 0)) return [t[s + e]];
    }
    return null;
  }
  function jo2(n66) {
    let e = n66.type.prop(Qd);
    return e ? e(n66.node) : n66;
  }
  function Wt(n66, e, t, i = {}) {
    let s = i.maxScanDistance || Xd, r = i.brackets || Jd, o = Ke(n66), l = o.resolveInner(e, t);
    for (let a = l; a; a = a.parent) {
      let h = $o2(a.type, t, r);
      if (h && a.from < a.to) {
        let c = jo2(a);
        if (c && (t > 0 ? e >= c.from && e < c.to : e > c.from && e <= c.to)) return Zd(n66, e, t, a, c, h, r);
      }
    }
    return ep(n66, e, t, o, l.type, s, r);
  }
  function Zd(n66, e, t, i, s, r, o) {
    let l = i.parent, a = { from: s.from, to: s.to }, h = 0, c = l?.cursor();
    if (c && (t < 0 ? c.childBefore(i.from) : c.childAfter(i.to))) do
      if (t < 0 ? c.to <= i.from : c.from >= i.to) {
        if (h == 0 && r.indexOf(c.type.name) > -1 && c.from < c.to) {
          let f = jo2(c);
          return { start: a, end: f ? { from: f.from, to: f.to } : void 0, matched: true };
        } else if ($o2(c.type, t, o)) h++;
        else if ($o2(c.type, -t, o)) {
          if (h == 0) {
            let f = jo2(c);
            return { start: a, end: f && f.from < f.to ? { from: f.from, to: f.to } : void 0, matched: false };
          }
          h--;
        }
      }
    while (t < 0 ? c.prevSibling() : c.nextSibling());
    return { start: a, matched: false };
  }
  function ep(n66, e, t, i, s, r, o) {
    if (t < 0 ? !e : e == n66.doc.length) return null;
    let l = t < 0 ? n66.sliceDoc(e - 1, e) : n66.sliceDoc(e, e + 1), a = o.indexOf(l);
    if (a < 0 || a % 2 == 0 != t > 0) return null;
    let h = { from: t < 0 ? e - 1 : e, to: t > 0 ? e + 1 : e }, c = n66.doc.iterRange(e, t > 0 ? n66.doc.length : 0), f = 0;
    for (let u = 0; !c.next().done && u <= r; ) {
      let d = c.value;
      t < 0 && (u += d.length);
      let p = e + u * t;
      for (let m = t > 0 ? 0 : d.length - 1, g = t > 0 ? d.length : -1; m != g; m += t) {
        let y = o.indexOf(d[m]);
        if (!(y < 0 || i.resolveInner(p + m, 1).type != s)) if (y % 2 == 0 == t > 0) f++;
        else {
          if (f == 1) return { start: h, end: { from: p + m, to: p + m + 1 }, matched: y >> 1 == a >> 1 };
          f--;
        }
      }
      t > 0 && (u += d.length);
    }
    return c.done ? { start: h, matched: false } : null;
  }
  var tp = /* @__PURE__ */ Object.create(null);
  var Jh = [Se.none];
  var Qh = [];
  var Zh = /* @__PURE__ */ Object.create(null);
  var ip = /* @__PURE__ */ Object.create(null);
  for (let [n66, e] of [["variable", "variableName"], ["variable-2", "variableName.special"], ["string-2", "string.special"], ["def", "variableName.definition"], ["tag", "tagName"], ["attribute", "attributeName"], ["type", "typeName"], ["builtin", "variableName.standard"], ["qualifier", "modifier"], ["error", "invalid"], ["header", "heading"], ["property", "propertyName"]]) ip[n66] = np(tp, e);
  function Wo2(n66, e) {
    Qh.indexOf(n66) > -1 || (Qh.push(n66), console.warn(e));
  }
  function np(n66, e) {
    let t = [];
    for (let l of e.split(" ")) {
      let a = [];
      for (let h of l.split(".")) {
        let c = n66[h] || M[h];
        c ? typeof c == "function" ? a.length ? a = a.map(c) : Wo2(h, `Modifier ${h} used at start of tag`) : a.length ? Wo2(h, `Tag ${h} used as modifier`) : a = Array.isArray(c) ? c : [c] : Wo2(h, `Unknown highlighting tag ${h}`);
      }
      for (let h of a) t.push(h);
    }
    if (!t.length) return 0;
    let i = e.replace(/ /g, "_"), s = i + " " + t.map((l) => l.id), r = Zh[s];
    if (r) return r.id;
    let o = Zh[s] = Se.define({ id: Jh.length, name: i, props: [_h({ [i]: t })] });
    return Jh.push(o), o.id;
  }
  var a0 = { rtl: L.mark({ class: "cm-iso", inclusive: true, attributes: { dir: "rtl" }, bidiIsolate: V.RTL }), ltr: L.mark({ class: "cm-iso", inclusive: true, attributes: { dir: "ltr" }, bidiIsolate: V.LTR }), auto: L.mark({ class: "cm-iso", inclusive: true, attributes: { dir: "auto" }, bidiIsolate: null }) };
  var sp = (n66) => {
    let { state: e } = n66, t = e.doc.lineAt(e.selection.main.from), i = Qo2(n66.state, t.from);
    return i.line ? rp(n66) : i.block ? lp(n66) : false;
  };
  function Jo2(n66, e) {
    return ({ state: t, dispatch: i }) => {
      if (t.readOnly) return false;
      let s = n66(e, t);
      return s ? (i(t.update(s)), true) : false;
    };
  }
  var rp = Jo2(cp, 0);
  var op = Jo2(cc, 0);
  var lp = Jo2((n66, e) => cc(n66, e, hp(e)), 0);
  function Qo2(n66, e) {
    let t = n66.languageDataAt("commentTokens", e, 1);
    return t.length ? t[0] : {};
  }
  var en = 50;
  function ap(n66, { open: e, close: t }, i, s) {
    let r = n66.sliceDoc(i - en, i), o = n66.sliceDoc(s, s + en), l = /\s*$/.exec(r)[0].length, a = /^\s*/.exec(o)[0].length, h = r.length - l;
    if (r.slice(h - e.length, h) == e && o.slice(a, a + t.length) == t) return { open: { pos: i - l, margin: l && 1 }, close: { pos: s + a, margin: a && 1 } };
    let c, f;
    s - i <= 2 * en ? c = f = n66.sliceDoc(i, s) : (c = n66.sliceDoc(i, i + en), f = n66.sliceDoc(s - en, s));
    let u = /^\s*/.exec(c)[0].length, d = /\s*$/.exec(f)[0].length, p = f.length - d - t.length;
    return c.slice(u, u + e.length) == e && f.slice(p, p + t.length) == t ? { open: { pos: i + u + e.length, margin: /\s/.test(c.charAt(u + e.length)) ? 1 : 0 }, close: { pos: s - d - t.length, margin: /\s/.test(f.charAt(p - 1)) ? 1 : 0 } } : null;
  }
  function hp(n66) {
    let e = [];
    for (let t of n66.selection.ranges) {
      let i = n66.doc.lineAt(t.from), s = t.to <= i.to ? i : n66.doc.lineAt(t.to);
      s.from > i.from && s.from == t.to && (s = t.to == i.to + 1 ? i : n66.doc.lineAt(t.to - 1));
      let r = e.length - 1;
      r >= 0 && e[r].to > i.from ? e[r].to = s.to : e.push({ from: i.from + /^\s*/.exec(i.text)[0].length, to: s.to });
    }
    return e;
  }
  function cc(n66, e, t = e.selection.ranges) {
    let i = t.map((r) => Qo2(e, r.from).block);
    if (!i.every((r) => r)) return null;
    let s = t.map((r, o) => ap(e, i[o], r.from, r.to));
    if (n66 != 2 && !s.every((r) => r)) return { changes: e.changes(t.map((r, o) => s[o] ? [] : [{ from: r.from, insert: i[o].open + " " }, { from: r.to, insert: " " + i[o].close }])) };
    if (n66 != 1 && s.some((r) => r)) {
      let r = [];
      for (let o = 0, l; o < s.length; o++) if (l = s[o]) {
        let a = i[o], { open: h, close: c } = l;
        r.push({ from: h.pos - a.open.length, to: h.pos + h.margin }, { from: c.pos - c.margin, to: c.pos + a.close.length });
      }
      return { changes: r };
    }
    return null;
  }
  function cp(n66, e, t = e.selection.ranges) {
    let i = [], s = -1;
    e: for (let { from: r, to: o } of t) {
      let l = i.length, a = 1e9, h;
      for (let c = r; c <= o; ) {
        let f = e.doc.lineAt(c);
        if (h == null && (h = Qo2(e, f.from).line, !h)) continue e;
        if (f.from > s && (r == o || o > f.from)) {
          s = f.from;
          let u = /^\s*/.exec(f.text)[0].length, d = u == f.length, p = f.text.slice(u, u + h.length) == h ? u : -1;
          u < f.text.length && u < a && (a = u), i.push({ line: f, comment: p, token: h, indent: u, empty: d, single: false });
        }
        c = f.to + 1;
      }
      if (a < 1e9) for (let c = l; c < i.length; c++) i[c].indent < i[c].line.text.length && (i[c].indent = a);
      i.length == l + 1 && (i[l].single = true);
    }
    if (n66 != 2 && i.some((r) => r.comment < 0 && (!r.empty || r.single))) {
      let r = [];
      for (let { line: l, token: a, indent: h, empty: c, single: f } of i) (f || !c) && r.push({ from: l.from + h, insert: a + " " });
      let o = e.changes(r);
      return { changes: o, selection: e.selection.map(o, 1) };
    } else if (n66 != 1 && i.some((r) => r.comment >= 0)) {
      let r = [];
      for (let { line: o, comment: l, token: a } of i) if (l >= 0) {
        let h = o.from + l, c = h + a.length;
        o.text[c - o.from] == " " && c++, r.push({ from: h, to: c });
      }
      return { changes: r };
    }
    return null;
  }
  var _o2 = oe2.define();
  var fp = oe2.define();
  var up = T.define();
  var fc = T.define({ combine(n66) {
    return de(n66, { minDepth: 100, newGroupDelay: 500, joinToEvent: (e, t) => t }, { minDepth: Math.max, newGroupDelay: Math.min, joinToEvent: (e, t) => (i, s) => e(i, s) || t(i, s) });
  } });
  var uc = J.define({ create() {
    return Vt.empty;
  }, update(n66, e) {
    let t = e.state.facet(fc), i = e.annotation(_o2);
    if (i) {
      let a = $e.fromTransaction(e, i.selection), h = i.side, c = h == 0 ? n66.undone : n66.done;
      return a ? c = us2(c, c.length, t.minDepth, a) : c = pc(c, e.startState.selection), new Vt(h == 0 ? i.rest : c, h == 0 ? c : i.rest);
    }
    let s = e.annotation(fp);
    if ((s == "full" || s == "before") && (n66 = n66.isolate()), e.annotation(X2.addToHistory) === false) return e.changes.empty ? n66 : n66.addMapping(e.changes.desc);
    let r = $e.fromTransaction(e), o = e.annotation(X2.time), l = e.annotation(X2.userEvent);
    return r ? n66 = n66.addChanges(r, o, l, t, e) : e.selection && (n66 = n66.addSelection(e.startState.selection, o, l, t.newGroupDelay)), (s == "full" || s == "after") && (n66 = n66.isolate()), n66;
  }, toJSON(n66) {
    return { done: n66.done.map((e) => e.toJSON()), undone: n66.undone.map((e) => e.toJSON()) };
  }, fromJSON(n66) {
    return new Vt(n66.done.map($e.fromJSON), n66.undone.map($e.fromJSON));
  } });
  function dp(n66 = {}) {
    return [uc, fc.of(n66), O.domEventHandlers({ beforeinput(e, t) {
      let i = e.inputType == "historyUndo" ? Zo2 : e.inputType == "historyRedo" ? fs2 : null;
      return i ? (e.preventDefault(), i(t)) : false;
    } })];
  }
  function ds2(n66, e) {
    return function({ state: t, dispatch: i }) {
      if (!e && t.readOnly) return false;
      let s = t.field(uc, false);
      if (!s) return false;
      let r = s.pop(n66, t, e);
      return r ? (i(r), true) : false;
    };
  }
  var Zo2 = ds2(0, false);
  var fs2 = ds2(1, false);
  var pp = ds2(0, true);
  var mp = ds2(1, true);
  var $e = class n57 {
    constructor(e, t, i, s, r) {
      this.changes = e, this.effects = t, this.mapped = i, this.startSelection = s, this.selectionsAfter = r;
    }
    setSelAfter(e) {
      return new n57(this.changes, this.effects, this.mapped, this.startSelection, e);
    }
    toJSON() {
      var e, t, i;
      return { changes: (e = this.changes) === null || e === void 0 ? void 0 : e.toJSON(), mapped: (t = this.mapped) === null || t === void 0 ? void 0 : t.toJSON(), startSelection: (i = this.startSelection) === null || i === void 0 ? void 0 : i.toJSON(), selectionsAfter: this.selectionsAfter.map((s) => s.toJSON()) };
    }
    static fromJSON(e) {
      return new n57(e.changes && ie.fromJSON(e.changes), [], e.mapped && ot.fromJSON(e.mapped), e.startSelection && x.fromJSON(e.startSelection), e.selectionsAfter.map(x.fromJSON));
    }
    static fromTransaction(e, t) {
      let i = Ie;
      for (let s of e.startState.facet(up)) {
        let r = s(e);
        r.length && (i = i.concat(r));
      }
      return !i.length && e.changes.empty ? null : new n57(e.changes.invert(e.startState.doc), i, void 0, t || e.startState.selection, Ie);
    }
    static selection(e) {
      return new n57(void 0, Ie, void 0, void 0, e);
    }
  };
  function us2(n66, e, t, i) {
    let s = e + 1 > t + 20 ? e - t - 1 : 0, r = n66.slice(s, e);
    return r.push(i), r;
  }
  function gp(n66, e) {
    let t = [], i = false;
    return n66.iterChangedRanges((s, r) => t.push(s, r)), e.iterChangedRanges((s, r, o, l) => {
      for (let a = 0; a < t.length; ) {
        let h = t[a++], c = t[a++];
        l >= h && o <= c && (i = true);
      }
    }), i;
  }
  function yp(n66, e) {
    return n66.ranges.length == e.ranges.length && n66.ranges.filter((t, i) => t.empty != e.ranges[i].empty).length === 0;
  }
  function dc(n66, e) {
    return n66.length ? e.length ? n66.concat(e) : n66 : e;
  }
  var Ie = [];
  var bp = 200;
  function pc(n66, e) {
    if (n66.length) {
      let t = n66[n66.length - 1], i = t.selectionsAfter.slice(Math.max(0, t.selectionsAfter.length - bp));
      return i.length && i[i.length - 1].eq(e) ? n66 : (i.push(e), us2(n66, n66.length - 1, 1e9, t.setSelAfter(i)));
    } else return [$e.selection([e])];
  }
  function xp(n66) {
    let e = n66[n66.length - 1], t = n66.slice();
    return t[n66.length - 1] = e.setSelAfter(e.selectionsAfter.slice(0, e.selectionsAfter.length - 1)), t;
  }
  function Go2(n66, e) {
    if (!n66.length) return n66;
    let t = n66.length, i = Ie;
    for (; t; ) {
      let s = wp(n66[t - 1], e, i);
      if (s.changes && !s.changes.empty || s.effects.length) {
        let r = n66.slice(0, t);
        return r[t - 1] = s, r;
      } else e = s.mapped, t--, i = s.selectionsAfter;
    }
    return i.length ? [$e.selection(i)] : Ie;
  }
  function wp(n66, e, t) {
    let i = dc(n66.selectionsAfter.length ? n66.selectionsAfter.map((l) => l.map(e)) : Ie, t);
    if (!n66.changes) return $e.selection(i);
    let s = n66.changes.map(e), r = e.mapDesc(n66.changes, true), o = n66.mapped ? n66.mapped.composeDesc(r) : r;
    return new $e(s, E.mapEffects(n66.effects, e), o, n66.startSelection.map(r), i);
  }
  var vp = /^(input\.type|delete)($|\.)/;
  var Vt = class n58 {
    constructor(e, t, i = 0, s = void 0) {
      this.done = e, this.undone = t, this.prevTime = i, this.prevUserEvent = s;
    }
    isolate() {
      return this.prevTime ? new n58(this.done, this.undone) : this;
    }
    addChanges(e, t, i, s, r) {
      let o = this.done, l = o[o.length - 1];
      return l && l.changes && !l.changes.empty && e.changes && (!i || vp.test(i)) && (!l.selectionsAfter.length && t - this.prevTime < s.newGroupDelay && s.joinToEvent(r, gp(l.changes, e.changes)) || i == "input.type.compose") ? o = us2(o, o.length - 1, s.minDepth, new $e(e.changes.compose(l.changes), dc(E.mapEffects(e.effects, l.changes), l.effects), l.mapped, l.startSelection, Ie)) : o = us2(o, o.length, s.minDepth, e), new n58(o, Ie, t, i);
    }
    addSelection(e, t, i, s) {
      let r = this.done.length ? this.done[this.done.length - 1].selectionsAfter : Ie;
      return r.length > 0 && t - this.prevTime < s && i == this.prevUserEvent && i && /^select($|\.)/.test(i) && yp(r[r.length - 1], e) ? this : new n58(pc(this.done, e), this.undone, t, i);
    }
    addMapping(e) {
      return new n58(Go2(this.done, e), Go2(this.undone, e), this.prevTime, this.prevUserEvent);
    }
    pop(e, t, i) {
      let s = e == 0 ? this.done : this.undone;
      if (s.length == 0) return null;
      let r = s[s.length - 1], o = r.selectionsAfter[0] || (r.startSelection ? r.startSelection.map(r.changes.invertedDesc, 1) : t.selection);
      if (i && r.selectionsAfter.length) return t.update({ selection: r.selectionsAfter[r.selectionsAfter.length - 1], annotations: _o2.of({ side: e, rest: xp(s), selection: o }), userEvent: e == 0 ? "select.undo" : "select.redo", scrollIntoView: true });
      if (r.changes) {
        let l = s.length == 1 ? Ie : s.slice(0, s.length - 1);
        return r.mapped && (l = Go2(l, r.mapped)), t.update({ changes: r.changes, selection: r.startSelection, effects: r.effects, annotations: _o2.of({ side: e, rest: l, selection: o }), filter: false, userEvent: e == 0 ? "undo" : "redo", scrollIntoView: true });
      } else return null;
    }
  };
  Vt.empty = new Vt(Ie, Ie);
  var kp = [{ key: "Mod-z", run: Zo2, preventDefault: true }, { key: "Mod-y", mac: "Mod-Shift-z", run: fs2, preventDefault: true }, { linux: "Ctrl-Shift-z", run: fs2, preventDefault: true }, { key: "Mod-u", run: pp, preventDefault: true }, { key: "Alt-u", mac: "Mod-Shift-u", run: mp, preventDefault: true }];
  function di2(n66, e) {
    return x.create(n66.ranges.map(e), n66.mainIndex);
  }
  function je(n66, e) {
    return n66.update({ selection: e, scrollIntoView: true, userEvent: "select" });
  }
  function Ue({ state: n66, dispatch: e }, t) {
    let i = di2(n66.selection, t);
    return i.eq(n66.selection, true) ? false : (e(je(n66, i)), true);
  }
  function ps2(n66, e) {
    return x.cursor(e ? n66.to : n66.from);
  }
  function mc(n66, e) {
    return Ue(n66, (t) => t.empty ? n66.moveByChar(t, e) : ps2(t, e));
  }
  function pe(n66) {
    return n66.textDirectionAt(n66.state.selection.main.head) == V.LTR;
  }
  var gc = (n66) => mc(n66, !pe(n66));
  var yc = (n66) => mc(n66, pe(n66));
  function bc(n66, e) {
    return Ue(n66, (t) => t.empty ? n66.moveByGroup(t, e) : ps2(t, e));
  }
  var Sp = (n66) => bc(n66, !pe(n66));
  var Cp = (n66) => bc(n66, pe(n66));
  var m0 = typeof Intl < "u" && Intl.Segmenter ? new Intl.Segmenter(void 0, { granularity: "word" }) : null;
  function Ap(n66, e, t) {
    if (e.type.prop(t)) return true;
    let i = e.to - e.from;
    return i && (i > 2 || /[^\s,.;:]/.test(n66.sliceDoc(e.from, e.to))) || e.firstChild;
  }
  function ms2(n66, e, t) {
    let i = Ke(n66).resolveInner(e.head), s = t ? P.closedBy : P.openedBy;
    for (let a = e.head; ; ) {
      let h = t ? i.childAfter(a) : i.childBefore(a);
      if (!h) break;
      Ap(n66, h, s) ? i = h : a = t ? h.to : h.from;
    }
    let r = i.type.prop(s), o, l;
    return r && (o = t ? Wt(n66, i.from, 1) : Wt(n66, i.to, -1)) && o.matched ? l = t ? o.end.to : o.end.from : l = t ? i.to : i.from, x.cursor(l, t ? -1 : 1);
  }
  var Mp = (n66) => Ue(n66, (e) => ms2(n66.state, e, !pe(n66)));
  var Tp = (n66) => Ue(n66, (e) => ms2(n66.state, e, pe(n66)));
  function xc(n66, e) {
    return Ue(n66, (t) => {
      if (!t.empty) return ps2(t, e);
      let i = n66.moveVertically(t, e);
      return i.head != t.head ? i : n66.moveToLineBoundary(t, e);
    });
  }
  var wc = (n66) => xc(n66, false);
  var vc = (n66) => xc(n66, true);
  function kc(n66) {
    let e = n66.scrollDOM.clientHeight < n66.scrollDOM.scrollHeight - 2, t = 0, i = 0, s;
    if (e) {
      for (let r of n66.state.facet(O.scrollMargins)) {
        let o = r(n66);
        o?.top && (t = Math.max(o?.top, t)), o?.bottom && (i = Math.max(o?.bottom, i));
      }
      s = n66.scrollDOM.clientHeight - t - i;
    } else s = (n66.dom.ownerDocument.defaultView || window).innerHeight;
    return { marginTop: t, marginBottom: i, selfScroll: e, height: Math.max(n66.defaultLineHeight, s - 5) };
  }
  function Sc(n66, e) {
    let t = kc(n66), { state: i } = n66, s = di2(i.selection, (o) => o.empty ? n66.moveVertically(o, e, t.height) : ps2(o, e));
    if (s.eq(i.selection)) return false;
    let r;
    if (t.selfScroll) {
      let o = n66.coordsAtPos(i.selection.main.head), l = n66.scrollDOM.getBoundingClientRect(), a = l.top + t.marginTop, h = l.bottom - t.marginBottom;
      o && o.top > a && o.bottom < h && (r = O.scrollIntoView(s.main.head, { y: "start", yMargin: o.top - a }));
    }
    return n66.dispatch(je(i, s), { effects: r }), true;
  }
  var ic = (n66) => Sc(n66, false);
  var Yo2 = (n66) => Sc(n66, true);
  function vt(n66, e, t) {
    let i = n66.lineBlockAt(e.head), s = n66.moveToLineBoundary(e, t);
    if (s.head == e.head && s.head != (t ? i.to : i.from) && (s = n66.moveToLineBoundary(e, t, false)), !t && s.head == i.from && i.length) {
      let r = /^\s*/.exec(n66.state.sliceDoc(i.from, Math.min(i.from + 100, i.to)))[0].length;
      r && e.head != i.from + r && (s = x.cursor(i.from + r));
    }
    return s;
  }
  var Dp = (n66) => Ue(n66, (e) => vt(n66, e, true));
  var Op = (n66) => Ue(n66, (e) => vt(n66, e, false));
  var Bp = (n66) => Ue(n66, (e) => vt(n66, e, !pe(n66)));
  var Ep = (n66) => Ue(n66, (e) => vt(n66, e, pe(n66)));
  var Lp = (n66) => Ue(n66, (e) => n66.moveToLineBoundary(e, false, false));
  var Rp = (n66) => Ue(n66, (e) => n66.moveToLineBoundary(e, true, false));
  function Pp(n66, e, t) {
    let i = false, s = di2(n66.selection, (r) => {
      let o = Wt(n66, r.head, -1) || Wt(n66, r.head, 1) || r.head > 0 && Wt(n66, r.head - 1, 1) || r.head < n66.doc.length && Wt(n66, r.head + 1, -1);
      if (!o || !o.end) return r;
      i = true;
      let l = o.start.from == r.head ? o.end.to : o.end.from;
      return t ? x.range(r.anchor, l) : x.cursor(l);
    });
    return i ? (e(je(n66, s)), true) : false;
  }
  var Ip = ({ state: n66, dispatch: e }) => Pp(n66, e, false);
  function Ne(n66, e, t) {
    let i = di2(n66.state.selection, (s) => {
      s.undirectional && s.head >= s.anchor != e && (s = x.range(s.head, s.anchor));
      let r = t(s);
      return x.range(s.anchor, r.head, r.goalColumn, r.bidiLevel || void 0, r.assoc);
    });
    return i.eq(n66.state.selection) ? false : (n66.dispatch(je(n66.state, i)), true);
  }
  function Cc(n66, e) {
    return Ne(n66, e, (t) => n66.moveByChar(t, e));
  }
  var Ac = (n66) => Cc(n66, !pe(n66));
  var Mc = (n66) => Cc(n66, pe(n66));
  function Tc(n66, e) {
    return Ne(n66, e, (t) => n66.moveByGroup(t, e));
  }
  var Np = (n66) => Tc(n66, !pe(n66));
  var Fp = (n66) => Tc(n66, pe(n66));
  var Hp = (n66) => {
    let e = !pe(n66);
    return Ne(n66, e, (t) => ms2(n66.state, t, e));
  };
  var Wp = (n66) => {
    let e = pe(n66);
    return Ne(n66, e, (t) => ms2(n66.state, t, e));
  };
  function Dc(n66, e) {
    return Ne(n66, e, (t) => n66.moveVertically(t, e));
  }
  var Oc = (n66) => Dc(n66, false);
  var Bc = (n66) => Dc(n66, true);
  function Ec(n66, e) {
    return Ne(n66, e, (t) => n66.moveVertically(t, e, kc(n66).height));
  }
  var nc = (n66) => Ec(n66, false);
  var sc = (n66) => Ec(n66, true);
  var Vp = (n66) => Ne(n66, true, (e) => vt(n66, e, true));
  var zp = (n66) => Ne(n66, false, (e) => vt(n66, e, false));
  var qp = (n66) => {
    let e = !pe(n66);
    return Ne(n66, e, (t) => vt(n66, t, e));
  };
  var Kp = (n66) => {
    let e = pe(n66);
    return Ne(n66, e, (t) => vt(n66, t, e));
  };
  var $p = (n66) => Ne(n66, false, (e) => x.cursor(n66.lineBlockAt(e.head).from));
  var jp = (n66) => Ne(n66, true, (e) => x.cursor(n66.lineBlockAt(e.head).to));
  var rc = ({ state: n66, dispatch: e }) => (e(je(n66, { anchor: 0 })), true);
  var oc = ({ state: n66, dispatch: e }) => (e(je(n66, { anchor: n66.doc.length })), true);
  var lc = ({ state: n66, dispatch: e }) => (e(je(n66, { anchor: n66.selection.main.anchor, head: 0 })), true);
  var ac = ({ state: n66, dispatch: e }) => (e(je(n66, { anchor: n66.selection.main.anchor, head: n66.doc.length })), true);
  var Up = ({ state: n66, dispatch: e }) => (e(n66.update({ selection: { anchor: 0, head: n66.doc.length }, userEvent: "select" })), true);
  var Gp = ({ state: n66, dispatch: e }) => {
    let t = gs2(n66).map(({ from: i, to: s }) => x.undirectionalRange(i, Math.min(s + 1, n66.doc.length)));
    return e(n66.update({ selection: x.create(t), userEvent: "select" })), true;
  };
  var _p = ({ state: n66, dispatch: e }) => {
    let t = di2(n66.selection, (i) => {
      let s = Ke(n66), r = s.resolveStack(i.from, 1);
      if (i.empty) {
        let o = s.resolveStack(i.from, -1);
        o.node.from >= r.node.from && o.node.to <= r.node.to && (r = o);
      }
      for (let o = r; o; o = o.next) {
        let { node: l } = o;
        if ((l.from < i.from && l.to >= i.to || l.to > i.to && l.from <= i.from) && o.next) return x.undirectionalRange(l.from, l.to);
      }
      return i;
    });
    return t.eq(n66.selection) ? false : (e(je(n66, t)), true);
  };
  function Lc(n66, e) {
    let { state: t } = n66, i = t.selection, s = t.selection.ranges.slice();
    for (let r of t.selection.ranges) {
      let o = t.doc.lineAt(r.head);
      if (e ? o.to < n66.state.doc.length : o.from > 0) for (let l = r; ; ) {
        let a = n66.moveVertically(l, e);
        if (a.head < o.from || a.head > o.to) {
          s.some((h) => h.head == a.head) || s.push(a);
          break;
        } else {
          if (a.head == l.head) break;
          l = a;
        }
      }
    }
    return s.length == i.ranges.length ? false : (n66.dispatch(je(t, x.create(s, s.length - 1))), true);
  }
  var Yp = (n66) => Lc(n66, false);
  var Xp = (n66) => Lc(n66, true);
  var Jp = ({ state: n66, dispatch: e }) => {
    let t = n66.selection, i = null;
    return t.ranges.length > 1 ? i = x.create([t.main]) : t.main.empty || (i = x.create([x.cursor(t.main.head)])), i ? (e(je(n66, i)), true) : false;
  };
  function tn2(n66, e) {
    if (n66.state.readOnly) return false;
    let t = "delete.selection", { state: i } = n66, s = i.changeByRange((r) => {
      let { from: o, to: l } = r;
      if (o == l) {
        let a = e(r);
        a < o ? (t = "delete.backward", a = cs2(n66, a, false)) : a > o && (t = "delete.forward", a = cs2(n66, a, true)), o = Math.min(o, a), l = Math.max(l, a);
      } else o = cs2(n66, o, false), l = cs2(n66, l, true);
      return o == l ? { range: r } : { changes: { from: o, to: l }, range: x.cursor(o, o < r.head ? -1 : 1) };
    });
    return s.changes.empty ? false : (n66.dispatch(i.update(s, { scrollIntoView: true, userEvent: t, effects: t == "delete.selection" ? O.announce.of(i.phrase("Selection deleted")) : void 0 })), true);
  }
  function cs2(n66, e, t) {
    if (n66 instanceof O) for (let i of n66.state.facet(O.atomicRanges).map((s) => s(n66))) i.between(e, e, (s, r) => {
      s < e && r > e && (e = t ? r : s);
    });
    return e;
  }
  var Rc = (n66, e, t) => tn2(n66, (i) => {
    let s = i.from, { state: r } = n66, o = r.doc.lineAt(s), l, a;
    if (t && !e && s > o.from && s < o.from + 200 && !/[^ \t]/.test(l = o.text.slice(0, s - o.from))) {
      if (l[l.length - 1] == "	") return s - 1;
      let h = dt2(l, r.tabSize), c = h % Qi2(r) || Qi2(r);
      for (let f = 0; f < c && l[l.length - 1 - f] == " "; f++) s--;
      a = s;
    } else a = Z(o.text, s - o.from, e, e) + o.from, a == s && o.number != (e ? r.doc.lines : 1) ? a += e ? 1 : -1 : !e && /[\ufe00-\ufe0f]/.test(o.text.slice(a - o.from, s - o.from)) && (a = Z(o.text, a - o.from, false, false) + o.from);
    return a;
  });
  var Xo2 = (n66) => Rc(n66, false, true);
  var Pc = (n66) => Rc(n66, true, false);
  var Ic = (n66, e) => tn2(n66, (t) => {
    let i = t.head, { state: s } = n66, r = s.doc.lineAt(i), o = s.charCategorizer(i);
    for (let l = null; ; ) {
      if (i == (e ? r.to : r.from)) {
        i == t.head && r.number != (e ? s.doc.lines : 1) && (i += e ? 1 : -1);
        break;
      }
      let a = Z(r.text, i - r.from, e) + r.from, h = r.text.slice(Math.min(i, a) - r.from, Math.max(i, a) - r.from), c = o(h);
      if (l != null && c != l) break;
      (h != " " || i != t.head) && (l = c), i = a;
    }
    return i;
  });
  var Nc = (n66) => Ic(n66, false);
  var Qp = (n66) => Ic(n66, true);
  var Zp = (n66) => tn2(n66, (e) => {
    let t = n66.lineBlockAt(e.head).to;
    return e.head < t ? t : Math.min(n66.state.doc.length, e.head + 1);
  });
  var em = (n66) => tn2(n66, (e) => {
    let t = n66.moveToLineBoundary(e, false).head;
    return e.head > t ? t : Math.max(0, e.head - 1);
  });
  var tm = (n66) => tn2(n66, (e) => {
    let t = n66.moveToLineBoundary(e, true).head;
    return e.head < t ? t : Math.min(n66.state.doc.length, e.head + 1);
  });
  var im = ({ state: n66, dispatch: e }) => {
    if (n66.readOnly) return false;
    let t = n66.changeByRange((i) => ({ changes: { from: i.from, to: i.to, insert: F.of(["", ""]) }, range: x.cursor(i.from) }));
    return e(n66.update(t, { scrollIntoView: true, userEvent: "input" })), true;
  };
  var nm = ({ state: n66, dispatch: e }) => {
    if (n66.readOnly) return false;
    let t = n66.changeByRange((i) => {
      if (!i.empty || i.from == 0 || i.from == n66.doc.length) return { range: i };
      let s = i.from, r = n66.doc.lineAt(s), o = s == r.from ? s - 1 : Z(r.text, s - r.from, false) + r.from, l = s == r.to ? s + 1 : Z(r.text, s - r.from, true) + r.from;
      return { changes: { from: o, to: l, insert: n66.doc.slice(s, l).append(n66.doc.slice(o, s)) }, range: x.cursor(l) };
    });
    return t.changes.empty ? false : (e(n66.update(t, { scrollIntoView: true, userEvent: "move.character" })), true);
  };
  function gs2(n66) {
    let e = [], t = -1;
    for (let i of n66.selection.ranges) {
      let s = n66.doc.lineAt(i.from), r = n66.doc.lineAt(i.to);
      if (!i.empty && i.to == r.from && (r = n66.doc.lineAt(i.to - 1)), t >= s.number) {
        let o = e[e.length - 1];
        o.to = r.to, o.ranges.push(i);
      } else e.push({ from: s.from, to: r.to, ranges: [i] });
      t = r.number + 1;
    }
    return e;
  }
  function Fc(n66, e, t) {
    if (n66.readOnly) return false;
    let i = [], s = [];
    for (let r of gs2(n66)) {
      if (t ? r.to == n66.doc.length : r.from == 0) continue;
      let o = n66.doc.lineAt(t ? r.to + 1 : r.from - 1), l = o.length + 1;
      if (t) {
        i.push({ from: r.to, to: o.to }, { from: r.from, insert: o.text + n66.lineBreak });
        for (let a of r.ranges) s.push(x.range(Math.min(n66.doc.length, a.anchor + l), Math.min(n66.doc.length, a.head + l)));
      } else {
        i.push({ from: o.from, to: r.from }, { from: r.to, insert: n66.lineBreak + o.text });
        for (let a of r.ranges) s.push(x.range(a.anchor - l, a.head - l));
      }
    }
    return i.length ? (e(n66.update({ changes: i, scrollIntoView: true, selection: x.create(s, n66.selection.mainIndex), userEvent: "move.line" })), true) : false;
  }
  var sm = ({ state: n66, dispatch: e }) => Fc(n66, e, false);
  var rm = ({ state: n66, dispatch: e }) => Fc(n66, e, true);
  function Hc(n66, e, t) {
    if (n66.readOnly) return false;
    let i = [];
    for (let r of gs2(n66)) t ? i.push({ from: r.from, insert: n66.doc.slice(r.from, r.to) + n66.lineBreak }) : i.push({ from: r.to, insert: n66.lineBreak + n66.doc.slice(r.from, r.to) });
    let s = n66.changes(i);
    return e(n66.update({ changes: s, selection: n66.selection.map(s, t ? 1 : -1), scrollIntoView: true, userEvent: "input.copyline" })), true;
  }
  var om = ({ state: n66, dispatch: e }) => Hc(n66, e, false);
  var lm = ({ state: n66, dispatch: e }) => Hc(n66, e, true);
  var am = (n66) => {
    if (n66.state.readOnly) return false;
    let { state: e } = n66, t = e.changes(gs2(e).map(({ from: s, to: r }) => (s > 0 ? s-- : r < e.doc.length && r++, { from: s, to: r }))), i = di2(e.selection, (s) => {
      let r;
      if (n66.lineWrapping) {
        let o = n66.lineBlockAt(s.head), l = n66.coordsAtPos(s.head, s.assoc || 1);
        l && (r = o.bottom + n66.documentTop - l.bottom + n66.defaultLineHeight / 2);
      }
      return n66.moveVertically(s, true, r);
    }).map(t);
    return n66.dispatch({ changes: t, selection: i, scrollIntoView: true, userEvent: "delete.line" }), true;
  };
  function hm(n66, e) {
    if (/\(\)|\[\]|\{\}/.test(n66.sliceDoc(e - 1, e + 1))) return { from: e, to: e };
    let t = Ke(n66).resolveInner(e), i = t.childBefore(e), s = t.childAfter(e), r;
    return i && s && i.to <= e && s.from >= e && (r = i.type.prop(P.closedBy)) && r.indexOf(s.name) > -1 && n66.doc.lineAt(i.to).from == n66.doc.lineAt(s.from).from && !/\S/.test(n66.sliceDoc(i.to, s.from)) ? { from: i.to, to: s.from } : null;
  }
  var hc = Wc(false);
  var cm = Wc(true);
  function Wc(n66) {
    return ({ state: e, dispatch: t }) => {
      if (e.readOnly) return false;
      let i = e.changeByRange((s) => {
        let { from: r, to: o } = s, l = e.doc.lineAt(r), a = !n66 && r == o && hm(e, r);
        n66 && (r = o = (o <= l.to ? l : e.doc.lineAt(o)).to);
        let h = new Ht2(e, { simulateBreak: r, simulateDoubleBreak: !!a }), c = Uo2(h, r);
        for (c == null && (c = dt2(/^\s*/.exec(e.doc.lineAt(r).text)[0], e.tabSize)); o < l.to && /\s/.test(l.text[o - l.from]); ) o++;
        a ? { from: r, to: o } = a : r > l.from && r < l.from + 100 && !/\S/.test(l.text.slice(0, r)) && (r = l.from);
        let f = ["", Zi2(e, c)];
        return a && f.push(Zi2(e, h.lineIndent(l.from, -1))), { changes: { from: r, to: o, insert: F.of(f) }, range: x.cursor(r + 1 + f[1].length) };
      });
      return t(e.update(i, { scrollIntoView: true, userEvent: "input" })), true;
    };
  }
  function el3(n66, e) {
    let t = -1;
    return n66.changeByRange((i) => {
      let s = [];
      for (let o = i.from; o <= i.to; ) {
        let l = n66.doc.lineAt(o);
        l.number > t && (i.empty || i.to > l.from) && (e(l, s, i), t = l.number), o = l.to + 1;
      }
      let r = n66.changes(s);
      return { changes: s, range: x.range(r.mapPos(i.anchor, 1), r.mapPos(i.head, 1)) };
    });
  }
  var fm = ({ state: n66, dispatch: e }) => {
    if (n66.readOnly) return false;
    let t = /* @__PURE__ */ Object.create(null), i = new Ht2(n66, { overrideIndentation: (r) => {
      let o = t[r];
      return o ?? -1;
    } }), s = el3(n66, (r, o, l) => {
      let a = Uo2(i, r.from);
      if (a == null) return;
      /\S/.test(r.text) || (a = 0);
      let h = /^\s*/.exec(r.text)[0], c = Zi2(n66, a);
      (h != c || l.from < r.from + h.length) && (t[r.from] = a, o.push({ from: r.from, to: r.from + h.length, insert: c }));
    });
    return s.changes.empty || e(n66.update(s, { userEvent: "indent" })), true;
  };
  var um = ({ state: n66, dispatch: e }) => n66.readOnly ? false : (e(n66.update(el3(n66, (t, i) => {
    i.push({ from: t.from, insert: n66.facet(Ji2) });
  }), { userEvent: "input.indent" })), true);
  var dm = ({ state: n66, dispatch: e }) => n66.readOnly ? false : (e(n66.update(el3(n66, (t, i) => {
    let s = /^\s*/.exec(t.text)[0];
    if (!s) return;
    let r = dt2(s, n66.tabSize), o = 0, l = Zi2(n66, Math.max(0, r - Qi2(n66)));
    for (; o < s.length && o < l.length && s.charCodeAt(o) == l.charCodeAt(o); ) o++;
    i.push({ from: t.from + o, to: t.from + s.length, insert: l.slice(o) });
  }), { userEvent: "delete.dedent" })), true);
  var pm = (n66) => (n66.setTabFocusMode(), true);
  var mm = [{ key: "Ctrl-b", run: gc, shift: Ac, preventDefault: true }, { key: "Ctrl-f", run: yc, shift: Mc }, { key: "Ctrl-p", run: wc, shift: Oc }, { key: "Ctrl-n", run: vc, shift: Bc }, { key: "Ctrl-a", run: Lp, shift: $p }, { key: "Ctrl-e", run: Rp, shift: jp }, { key: "Ctrl-d", run: Pc }, { key: "Ctrl-h", run: Xo2 }, { key: "Ctrl-k", run: Zp }, { key: "Ctrl-Alt-h", run: Nc }, { key: "Ctrl-o", run: im }, { key: "Ctrl-t", run: nm }, { key: "Ctrl-v", run: Yo2 }];
  var gm = [{ key: "ArrowLeft", run: gc, shift: Ac, preventDefault: true }, { key: "Mod-ArrowLeft", mac: "Alt-ArrowLeft", run: Sp, shift: Np, preventDefault: true }, { mac: "Cmd-ArrowLeft", run: Bp, shift: qp, preventDefault: true }, { key: "ArrowRight", run: yc, shift: Mc, preventDefault: true }, { key: "Mod-ArrowRight", mac: "Alt-ArrowRight", run: Cp, shift: Fp, preventDefault: true }, { mac: "Cmd-ArrowRight", run: Ep, shift: Kp, preventDefault: true }, { key: "ArrowUp", run: wc, shift: Oc, preventDefault: true }, { mac: "Cmd-ArrowUp", run: rc, shift: lc }, { mac: "Ctrl-ArrowUp", run: ic, shift: nc }, { key: "ArrowDown", run: vc, shift: Bc, preventDefault: true }, { mac: "Cmd-ArrowDown", run: oc, shift: ac }, { mac: "Ctrl-ArrowDown", run: Yo2, shift: sc }, { key: "PageUp", run: ic, shift: nc }, { key: "PageDown", run: Yo2, shift: sc }, { key: "Home", run: Op, shift: zp, preventDefault: true }, { key: "Mod-Home", run: rc, shift: lc }, { key: "End", run: Dp, shift: Vp, preventDefault: true }, { key: "Mod-End", run: oc, shift: ac }, { key: "Enter", run: hc, shift: hc }, { key: "Mod-a", run: Up }, { key: "Backspace", run: Xo2, shift: Xo2, preventDefault: true }, { key: "Delete", run: Pc, preventDefault: true }, { key: "Mod-Backspace", mac: "Alt-Backspace", run: Nc, preventDefault: true }, { key: "Mod-Delete", mac: "Alt-Delete", run: Qp, preventDefault: true }, { mac: "Mod-Backspace", run: em, preventDefault: true }, { mac: "Mod-Delete", run: tm, preventDefault: true }].concat(mm.map((n66) => ({ mac: n66.key, run: n66.run, shift: n66.shift })));
  var ym = [{ key: "Alt-ArrowLeft", mac: "Ctrl-ArrowLeft", run: Mp, shift: Hp }, { key: "Alt-ArrowRight", mac: "Ctrl-ArrowRight", run: Tp, shift: Wp }, { key: "Alt-ArrowUp", run: sm }, { key: "Shift-Alt-ArrowUp", run: om }, { key: "Alt-ArrowDown", run: rm }, { key: "Shift-Alt-ArrowDown", run: lm }, { key: "Mod-Alt-ArrowUp", run: Yp }, { key: "Mod-Alt-ArrowDown", run: Xp }, { key: "Escape", run: Jp }, { key: "Mod-Enter", run: cm }, { key: "Alt-l", mac: "Ctrl-l", run: Gp }, { key: "Mod-i", run: _p, preventDefault: true }, { key: "Mod-[", run: dm }, { key: "Mod-]", run: um }, { key: "Mod-Alt-\\", run: fm }, { key: "Shift-Mod-k", run: am }, { key: "Shift-Mod-\\", run: Ip }, { key: "Mod-/", run: sp }, { key: "Alt-A", mac: "Ctrl-A", run: op }, { key: "Ctrl-m", mac: "Shift-Alt-m", run: pm }].concat(gm);
  var bs = class {
    constructor(e, t, i, s) {
      this.state = e, this.pos = t, this.explicit = i, this.view = s, this.abortListeners = [], this.abortOnDocChange = false;
    }
    tokenBefore(e) {
      let t = Ke(this.state).resolveInner(this.pos, -1);
      for (; t && e.indexOf(t.name) < 0; ) t = t.parent;
      return t ? { from: t.from, to: this.pos, text: this.state.sliceDoc(t.from, this.pos), type: t.type } : null;
    }
    matchBefore(e) {
      let t = this.state.doc.lineAt(this.pos), i = Math.max(t.from, this.pos - 250), s = t.text.slice(i - t.from, this.pos - t.from), r = s.search(jc(e, false));
      return r < 0 ? null : { from: i + r, to: this.pos, text: s.slice(r) };
    }
    get aborted() {
      return this.abortListeners == null;
    }
    addEventListener(e, t, i) {
      e == "abort" && this.abortListeners && (this.abortListeners.push(t), i && i.onDocChange && (this.abortOnDocChange = true));
    }
  };
  function Vc(n66) {
    let e = Object.keys(n66).join(""), t = /\w/.test(e);
    return t && (e = e.replace(/\w/g, "")), `[${t ? "\\w" : ""}${e.replace(/[^\w\s]/g, "\\$&")}]`;
  }
  function bm(n66) {
    let e = /* @__PURE__ */ Object.create(null), t = /* @__PURE__ */ Object.create(null);
    for (let { label: s } of n66) {
      e[s[0]] = true;
      for (let r = 1; r < s.length; r++) t[s[r]] = true;
    }
    let i = Vc(e) + Vc(t) + "*$";
    return [new RegExp("^" + i), new RegExp(i)];
  }
  function xm(n66) {
    let e = n66.map((s) => typeof s == "string" ? { label: s } : s), [t, i] = e.every((s) => /^\w+$/.test(s.label)) ? [/\w*$/, /\w+$/] : bm(e);
    return (s) => {
      let r = s.matchBefore(i);
      return r || s.explicit ? { from: r ? r.from : s.pos, options: e, validFor: t } : null;
    };
  }
  var xs = class {
    constructor(e, t, i, s) {
      this.completion = e, this.source = t, this.match = i, this.score = s;
    }
  };
  function zt(n66) {
    return n66.selection.main.from;
  }
  function jc(n66, e) {
    var t;
    let { source: i } = n66, s = e && i[0] != "^", r = i[i.length - 1] != "$";
    return !s && !r ? n66 : new RegExp(`${s ? "^" : ""}(?:${i})${r ? "$" : ""}`, (t = n66.flags) !== null && t !== void 0 ? t : n66.ignoreCase ? "i" : "");
  }
  var Uc = oe2.define();
  function wm(n66, e, t, i) {
    let { main: s } = n66.selection, r = t - s.from, o = i - s.from;
    return { ...n66.changeByRange((l) => {
      if (l != s && t != i && n66.sliceDoc(l.from + r, l.from + o) != n66.sliceDoc(t, i)) return { range: l };
      let a = n66.toText(e);
      return { changes: { from: l.from + r, to: i == s.from ? l.to : l.from + o, insert: a }, range: x.cursor(l.from + r + a.length) };
    }), scrollIntoView: true, userEvent: "input.complete" };
  }
  var zc = /* @__PURE__ */ new WeakMap();
  function vm(n66) {
    if (!Array.isArray(n66)) return n66;
    let e = zc.get(n66);
    return e || zc.set(n66, e = xm(n66)), e;
  }
  var ws2 = E.define();
  var nn2 = E.define();
  var nl = class {
    constructor(e) {
      this.pattern = e, this.chars = [], this.folded = [], this.any = [], this.precise = [], this.byWord = [], this.score = 0, this.matched = [];
      for (let t = 0; t < e.length; ) {
        let i = De(e, t), s = Xe2(i);
        this.chars.push(i);
        let r = e.slice(t, t + s), o = r.toUpperCase();
        this.folded.push(De(o == r ? r.toLowerCase() : o, 0)), t += s;
      }
      this.astral = e.length != this.chars.length;
    }
    ret(e, t) {
      return this.score = e, this.matched = t, this;
    }
    match(e) {
      if (this.pattern.length == 0) return this.ret(-100, []);
      if (e.length < this.pattern.length) return null;
      let { chars: t, folded: i, any: s, precise: r, byWord: o } = this;
      if (t.length == 1) {
        let v = De(e, 0), b = Xe2(v), D = b == e.length ? 0 : -100;
        if (v != t[0]) if (v == i[0]) D += -200;
        else return null;
        return this.ret(D, [0, b]);
      }
      let l = e.indexOf(this.pattern);
      if (l == 0) return this.ret(e.length == this.pattern.length ? 0 : -100, [0, this.pattern.length]);
      let a = t.length, h = 0;
      if (l < 0) {
        for (let v = 0, b = Math.min(e.length, 200); v < b && h < a; ) {
          let D = De(e, v);
          (D == t[h] || D == i[h]) && (s[h++] = v), v += Xe2(D);
        }
        if (h < a) return null;
      }
      let c = 0, f = 0, u = false, d = 0, p = -1, m = -1, g = /[a-z]/.test(e), y = true;
      for (let v = 0, b = Math.min(e.length, 200), D = 0; v < b && f < a; ) {
        let w = De(e, v);
        l < 0 && (c < a && w == t[c] && (r[c++] = v), d < a && (w == t[d] || w == i[d] ? (d == 0 && (p = v), m = v + 1, d++) : d = 0));
        let k, S2 = w < 255 ? w >= 48 && w <= 57 || w >= 97 && w <= 122 ? 2 : w >= 65 && w <= 90 ? 1 : 0 : (k = bn(w)) != k.toLowerCase() ? 1 : k != k.toUpperCase() ? 2 : 0;
        (!v || S2 == 1 && g || D == 0 && S2 != 0) && (t[f] == w || i[f] == w && (u = true) ? o[f++] = v : o.length && (y = false)), D = S2, v += Xe2(w);
      }
      return f == a && o[0] == 0 && y ? this.result(-100 + (u ? -200 : 0), o, e) : d == a && p == 0 ? this.ret(-200 - e.length + (m == e.length ? 0 : -100), [0, m]) : l > -1 ? this.ret(-700 - e.length, [l, l + this.pattern.length]) : d == a ? this.ret(-900 - e.length, [p, m]) : f == a ? this.result(-100 + (u ? -200 : 0) + -700 + (y ? 0 : -1100), o, e) : t.length == 2 ? null : this.result((s[0] ? -700 : 0) + -200 + -1100, s, e);
    }
    result(e, t, i) {
      let s = [], r = 0;
      for (let o of t) {
        let l = o + (this.astral ? Xe2(De(i, o)) : 1);
        r && s[r - 1] == o ? s[r - 1] = l : (s[r++] = o, s[r++] = l);
      }
      return this.ret(e - i.length, s);
    }
  };
  var sl = class {
    constructor(e) {
      this.pattern = e, this.matched = [], this.score = 0, this.folded = e.toLowerCase();
    }
    match(e) {
      if (e.length < this.pattern.length) return null;
      let t = e.slice(0, this.pattern.length), i = t == this.pattern ? 0 : t.toLowerCase() == this.folded ? -200 : null;
      return i == null ? null : (this.matched = [0, t.length], this.score = i + (e.length == this.pattern.length ? 0 : -100), this);
    }
  };
  var se = T.define({ combine(n66) {
    return de(n66, { activateOnTyping: true, activateOnCompletion: () => false, activateOnTypingDelay: 100, selectOnOpen: true, override: null, closeOnBlur: true, maxRenderedOptions: 100, defaultKeymap: true, tooltipClass: () => "", optionClass: () => "", aboveCursor: false, icons: true, addToOptions: [], positionInfo: km, filterStrict: false, compareCompletions: (e, t) => (e.sortText || e.label).localeCompare(t.sortText || t.label), interactionDelay: 75, updateSyncTime: 100 }, { defaultKeymap: (e, t) => e && t, closeOnBlur: (e, t) => e && t, icons: (e, t) => e && t, tooltipClass: (e, t) => (i) => qc(e(i), t(i)), optionClass: (e, t) => (i) => qc(e(i), t(i)), addToOptions: (e, t) => e.concat(t), filterStrict: (e, t) => e || t });
  } });
  function qc(n66, e) {
    return n66 ? e ? n66 + " " + e : n66 : e;
  }
  function km(n66, e, t, i, s, r) {
    let o = n66.textDirection == V.RTL, l = o, a = false, h = "top", c, f, u = e.left - s.left, d = s.right - e.right, p = i.right - i.left, m = i.bottom - i.top;
    if (l && u < Math.min(p, d) ? l = false : !l && d < Math.min(p, u) && (l = true), p <= (l ? u : d)) c = Math.max(s.top, Math.min(t.top, s.bottom - m)) - e.top, f = Math.min(400, l ? u : d);
    else {
      a = true, f = Math.min(400, (o ? e.right : s.right - e.left) - 30);
      let v = s.bottom - e.bottom;
      v >= m || v > e.top ? c = t.bottom - e.top : (h = "bottom", c = e.bottom - t.top);
    }
    let g = (e.bottom - e.top) / r.offsetHeight, y = (e.right - e.left) / r.offsetWidth;
    return { style: `${h}: ${c / g}px; max-width: ${f / y}px`, class: "cm-completionInfo-" + (a ? o ? "left-narrow" : "right-narrow" : l ? "left" : "right") };
  }
  var hl = E.define();
  function Sm(n66) {
    let e = n66.addToOptions.slice();
    return n66.icons && e.push({ render(t) {
      let i = document.createElement("div");
      return i.classList.add("cm-completionIcon"), t.type && i.classList.add(...t.type.split(/\s+/g).map((s) => "cm-completionIcon-" + s)), i.setAttribute("aria-hidden", "true"), i;
    }, position: 20 }), e.push({ render(t, i, s, r) {
      let o = document.createElement("span");
      o.className = "cm-completionLabel";
      let l = t.displayLabel || t.label, a = 0;
      for (let h = 0; h < r.length; ) {
        let c = r[h++], f = r[h++];
        c > a && o.appendChild(document.createTextNode(l.slice(a, c)));
        let u = o.appendChild(document.createElement("span"));
        u.appendChild(document.createTextNode(l.slice(c, f))), u.className = "cm-completionMatchedText", a = f;
      }
      return a < l.length && o.appendChild(document.createTextNode(l.slice(a))), o;
    }, position: 50 }, { render(t) {
      if (!t.detail) return null;
      let i = document.createElement("span");
      return i.className = "cm-completionDetail", i.textContent = t.detail, i;
    }, position: 80 }), e.sort((t, i) => t.position - i.position).map((t) => t.render);
  }
  function tl(n66, e, t) {
    if (n66 <= t) return { from: 0, to: n66 };
    if (e < 0 && (e = 0), e <= n66 >> 1) {
      let s = Math.floor(e / t);
      return { from: s * t, to: (s + 1) * t };
    }
    let i = Math.ceil((n66 - e) / t);
    return { from: n66 - i * t, to: n66 - (i - 1) * t };
  }
  var rl = class {
    constructor(e, t, i) {
      this.view = e, this.stateField = t, this.applyCompletion = i, this.info = null, this.infoDestroy = null, this.placeInfoReq = { read: () => this.measureInfo(), write: (a) => this.placeInfo(a), key: this }, this.space = null, this.currentClass = "";
      let s = e.state.field(t), { options: r, selected: o } = s.open, l = e.state.facet(se);
      this.optionContent = Sm(l), this.optionClass = l.optionClass, this.tooltipClass = l.tooltipClass, this.range = tl(r.length, o, l.maxRenderedOptions), this.dom = document.createElement("div"), this.dom.className = "cm-tooltip-autocomplete", this.updateTooltipClass(e.state), this.dom.addEventListener("mousedown", (a) => {
        let { options: h } = e.state.field(t).open;
        for (let c = a.target, f; c && c != this.dom; c = c.parentNode) if (c.nodeName == "LI" && (f = /-(\d+)$/.exec(c.id)) && +f[1] < h.length) {
          this.applyCompletion(e, h[+f[1]]), a.preventDefault();
          return;
        }
        if (a.target == this.list) {
          let c = this.list.classList.contains("cm-completionListIncompleteTop") && a.clientY < this.list.firstChild.getBoundingClientRect().top ? this.range.from - 1 : this.list.classList.contains("cm-completionListIncompleteBottom") && a.clientY > this.list.lastChild.getBoundingClientRect().bottom ? this.range.to : null;
          c != null && (e.dispatch({ effects: hl.of(c) }), a.preventDefault());
        }
      }), this.dom.addEventListener("focusout", (a) => {
        let h = e.state.field(this.stateField, false);
        h && h.tooltip && e.state.facet(se).closeOnBlur && a.relatedTarget != e.contentDOM && e.dispatch({ effects: nn2.of(null) });
      }), this.showOptions(r, s.id);
    }
    mount() {
      this.updateSel();
    }
    showOptions(e, t) {
      this.list && this.list.remove(), this.list = this.dom.appendChild(this.createListBox(e, t, this.range)), this.list.addEventListener("scroll", () => {
        this.info && this.view.requestMeasure(this.placeInfoReq);
      });
    }
    update(e) {
      var t;
      let i = e.state.field(this.stateField), s = e.startState.field(this.stateField);
      if (this.updateTooltipClass(e.state), i != s) {
        let { options: r, selected: o, disabled: l } = i.open;
        (!s.open || s.open.options != r) && (this.range = tl(r.length, o, e.state.facet(se).maxRenderedOptions), this.showOptions(r, i.id)), this.updateSel(), l != ((t = s.open) === null || t === void 0 ? void 0 : t.disabled) && this.dom.classList.toggle("cm-tooltip-autocomplete-disabled", !!l);
      }
    }
    updateTooltipClass(e) {
      let t = this.tooltipClass(e);
      if (t != this.currentClass) {
        for (let i of this.currentClass.split(" ")) i && this.dom.classList.remove(i);
        for (let i of t.split(" ")) i && this.dom.classList.add(i);
        this.currentClass = t;
      }
    }
    positioned(e) {
      this.space = e, this.info && this.view.requestMeasure(this.placeInfoReq);
    }
    updateSel() {
      let e = this.view.state.field(this.stateField), t = e.open;
      (t.selected > -1 && t.selected < this.range.from || t.selected >= this.range.to) && (this.range = tl(t.options.length, t.selected, this.view.state.facet(se).maxRenderedOptions), this.showOptions(t.options, e.id));
      let i = this.updateSelectedOption(t.selected);
      if (i) {
        this.destroyInfo();
        let { completion: s } = t.options[t.selected], { info: r } = s;
        if (!r) return;
        let o = typeof r == "string" ? document.createTextNode(r) : r(s);
        if (!o) return;
        "then" in o ? o.then((l) => {
          l && this.view.state.field(this.stateField, false) == e && this.addInfoPane(l, s);
        }).catch((l) => le(this.view.state, l, "completion info")) : (this.addInfoPane(o, s), i.setAttribute("aria-describedby", this.info.id));
      }
    }
    addInfoPane(e, t) {
      this.destroyInfo();
      let i = this.info = document.createElement("div");
      if (i.className = "cm-tooltip cm-completionInfo", i.id = "cm-completionInfo-" + Math.floor(Math.random() * 65535).toString(16), e.nodeType != null) i.appendChild(e), this.infoDestroy = null;
      else {
        let { dom: s, destroy: r } = e;
        i.appendChild(s), this.infoDestroy = r || null;
      }
      this.dom.appendChild(i), this.view.requestMeasure(this.placeInfoReq);
    }
    updateSelectedOption(e) {
      let t = null;
      for (let i = this.list.firstChild, s = this.range.from; i; i = i.nextSibling, s++) i.nodeName != "LI" || !i.id ? s-- : s == e ? i.hasAttribute("aria-selected") || (i.setAttribute("aria-selected", "true"), t = i) : i.hasAttribute("aria-selected") && (i.removeAttribute("aria-selected"), i.removeAttribute("aria-describedby"));
      return t && Am(this.list, t), t;
    }
    measureInfo() {
      let e = this.dom.querySelector("[aria-selected]");
      if (!e || !this.info) return null;
      let t = this.dom.getBoundingClientRect(), i = this.info.getBoundingClientRect(), s = e.getBoundingClientRect(), r = this.space;
      if (!r) {
        let o = this.dom.ownerDocument.documentElement;
        r = { left: 0, top: 0, right: o.clientWidth, bottom: o.clientHeight };
      }
      return s.top > Math.min(r.bottom, t.bottom) - 10 || s.bottom < Math.max(r.top, t.top) + 10 ? null : this.view.state.facet(se).positionInfo(this.view, t, s, i, r, this.dom);
    }
    placeInfo(e) {
      this.info && (e ? (e.style && (this.info.style.cssText = e.style), this.info.className = "cm-tooltip cm-completionInfo " + (e.class || "")) : this.info.style.cssText = "top: -1e6px");
    }
    createListBox(e, t, i) {
      let s = document.createElement("ul");
      s.id = t, s.setAttribute("role", "listbox"), s.setAttribute("aria-expanded", "true"), s.setAttribute("aria-label", this.view.state.phrase("Completions")), s.addEventListener("mousedown", (o) => {
        o.target == s && o.preventDefault();
      });
      let r = null;
      for (let o = i.from; o < i.to; o++) {
        let { completion: l, match: a } = e[o], { section: h } = l;
        if (h) {
          let u = typeof h == "string" ? h : h.name;
          if (u != r && (o > i.from || i.from == 0)) if (r = u, typeof h != "string" && h.header) s.appendChild(h.header(h));
          else {
            let d = s.appendChild(document.createElement("completion-section"));
            d.textContent = u;
          }
        }
        let c = s.appendChild(document.createElement("li"));
        c.id = t + "-" + o, c.setAttribute("role", "option");
        let f = this.optionClass(l);
        f && (c.className = f);
        for (let u of this.optionContent) {
          let d = u(l, this.view.state, this.view, a);
          d && c.appendChild(d);
        }
      }
      return i.from && s.classList.add("cm-completionListIncompleteTop"), i.to < e.length && s.classList.add("cm-completionListIncompleteBottom"), s;
    }
    destroyInfo() {
      this.info && (this.infoDestroy && this.infoDestroy(), this.info.remove(), this.info = null);
    }
    destroy() {
      this.destroyInfo();
    }
  };
  function Cm(n66, e) {
    return (t) => new rl(t, n66, e);
  }
  function Am(n66, e) {
    let t = n66.getBoundingClientRect(), i = e.getBoundingClientRect(), s = t.height / n66.offsetHeight;
    i.top < t.top ? n66.scrollTop -= (t.top - i.top) / s : i.bottom > t.bottom && (n66.scrollTop += (i.bottom - t.bottom) / s);
  }
  function Kc(n66) {
    return (n66.boost || 0) * 100 + (n66.apply ? 10 : 0) + (n66.info ? 5 : 0) + (n66.type ? 1 : 0);
  }
  function Mm(n66, e) {
    let t = [], i = null, s = null, r = (c) => {
      t.push(c);
      let { section: f } = c.completion;
      if (f) {
        i || (i = []);
        let u = typeof f == "string" ? f : f.name;
        i.some((d) => d.name == u) || i.push(typeof f == "string" ? { name: u } : f);
      }
    }, o = e.facet(se);
    for (let c of n66) if (c.hasResult()) {
      let f = c.result.getMatch;
      if (c.result.filter === false) for (let u of c.result.options) r(new xs(u, c.source, f ? f(u) : [], 1e9 - t.length));
      else {
        let u = e.sliceDoc(c.from, c.to), d, p = o.filterStrict ? new sl(u) : new nl(u);
        for (let m of c.result.options) if (d = p.match(m.label)) {
          let g = m.displayLabel ? f ? f(m, d.matched) : [] : d.matched, y = d.score + (m.boost || 0);
          if (r(new xs(m, c.source, g, y)), typeof m.section == "object" && m.section.rank === "dynamic") {
            let { name: v } = m.section;
            s || (s = /* @__PURE__ */ Object.create(null)), s[v] = Math.max(y, s[v] || -1e9);
          }
        }
      }
    }
    if (i) {
      let c = /* @__PURE__ */ Object.create(null), f = 0, u = (d, p) => (d.rank === "dynamic" && p.rank === "dynamic" ? s[p.name] - s[d.name] : 0) || (typeof d.rank == "number" ? d.rank : 1e9) - (typeof p.rank == "number" ? p.rank : 1e9) || (d.name < p.name ? -1 : 1);
      for (let d of i.sort(u)) f -= 1e5, c[d.name] = f;
      for (let d of t) {
        let { section: p } = d.completion;
        p && (d.score += c[typeof p == "string" ? p : p.name]);
      }
    }
    let l = [], a = null, h = o.compareCompletions;
    for (let c of t.sort((f, u) => u.score - f.score || h(f.completion, u.completion))) {
      let f = c.completion;
      !a || a.label != f.label || a.detail != f.detail || a.type != null && f.type != null && a.type != f.type || a.apply != f.apply || a.boost != f.boost ? l.push(c) : Kc(c.completion) > Kc(a) && (l[l.length - 1] = c), a = c.completion;
    }
    return l;
  }
  var ol = class n59 {
    constructor(e, t, i, s, r, o) {
      this.options = e, this.attrs = t, this.tooltip = i, this.timestamp = s, this.selected = r, this.disabled = o;
    }
    setSelected(e, t) {
      return e == this.selected || e >= this.options.length ? this : new n59(this.options, $c(t, e), this.tooltip, this.timestamp, e, this.disabled);
    }
    static build(e, t, i, s, r, o) {
      if (s && !o && e.some((h) => h.isPending)) return s.setDisabled();
      let l = Mm(e, t);
      if (!l.length) return s && e.some((h) => h.isPending) ? s.setDisabled() : null;
      let a = t.facet(se).selectOnOpen ? 0 : -1;
      if (s && s.selected != a && s.selected != -1) {
        let h = s.options[s.selected].completion;
        for (let c = 0; c < l.length; c++) if (l[c].completion == h) {
          a = c;
          break;
        }
      }
      return new n59(l, $c(i, a), { pos: e.reduce((h, c) => c.hasResult() ? Math.min(h, c.from) : h, 1e8), create: Lm, above: r.aboveCursor }, s ? s.timestamp : Date.now(), a, false);
    }
    map(e) {
      return new n59(this.options, this.attrs, { ...this.tooltip, pos: e.mapPos(this.tooltip.pos) }, this.timestamp, this.selected, this.disabled);
    }
    setDisabled() {
      return new n59(this.options, this.attrs, this.tooltip, this.timestamp, this.selected, true);
    }
  };
  var ll = class n60 {
    constructor(e, t, i) {
      this.active = e, this.id = t, this.open = i;
    }
    static start() {
      return new n60(Bm, "cm-ac-" + Math.floor(Math.random() * 2e6).toString(36), null);
    }
    update(e) {
      let { state: t } = e, i = t.facet(se), r = (i.override || t.languageDataAt("autocomplete", zt(t)).map(vm)).map((a) => (this.active.find((c) => c.source == a) || new ft2(a, this.active.some((c) => c.state != 0) ? 1 : 0)).update(e, i));
      r.length == this.active.length && r.every((a, h) => a == this.active[h]) && (r = this.active);
      let o = this.open, l = e.effects.some((a) => a.is(cl));
      o && e.docChanged && (o = o.map(e.changes)), e.selection || r.some((a) => a.hasResult() && e.changes.touchesRange(a.from, a.to)) || !Tm(r, this.active) || l ? o = ol.build(r, t, this.id, o, i, l) : o && o.disabled && !r.some((a) => a.isPending) && (o = null), !o && r.every((a) => !a.isPending) && r.some((a) => a.hasResult()) && (r = r.map((a) => a.hasResult() ? new ft2(a.source, 0) : a));
      for (let a of e.effects) a.is(hl) && (o = o && o.setSelected(a.value, this.id));
      return r == this.active && o == this.open ? this : new n60(r, this.id, o);
    }
    get tooltip() {
      return this.open ? this.open.tooltip : null;
    }
    get attrs() {
      return this.open ? this.open.attrs : this.active.length ? Dm : Om;
    }
  };
  function Tm(n66, e) {
    if (n66 == e) return true;
    for (let t = 0, i = 0; ; ) {
      for (; t < n66.length && !n66[t].hasResult(); ) t++;
      for (; i < e.length && !e[i].hasResult(); ) i++;
      let s = t == n66.length, r = i == e.length;
      if (s || r) return s == r;
      if (n66[t++].result != e[i++].result) return false;
    }
  }
  var Dm = { "aria-autocomplete": "list" };
  var Om = {};
  function $c(n66, e) {
    let t = { "aria-autocomplete": "list", "aria-haspopup": "listbox", "aria-controls": n66 };
    return e > -1 && (t["aria-activedescendant"] = n66 + "-" + e), t;
  }
  var Bm = [];
  function Gc(n66, e) {
    if (n66.isUserEvent("input.complete")) {
      let i = n66.annotation(Uc);
      if (i && e.activateOnCompletion(i)) return 12;
    }
    let t = n66.isUserEvent("input.type");
    return t && e.activateOnTyping ? 5 : t ? 1 : n66.isUserEvent("delete.backward") ? 2 : n66.selection ? 8 : n66.docChanged ? 16 : 0;
  }
  var ft2 = class n61 {
    constructor(e, t, i = false) {
      this.source = e, this.state = t, this.explicit = i;
    }
    hasResult() {
      return false;
    }
    get isPending() {
      return this.state == 1;
    }
    update(e, t) {
      let i = Gc(e, t), s = this;
      (i & 8 || i & 16 && this.touches(e)) && (s = new n61(s.source, 0)), i & 4 && s.state == 0 && (s = new n61(this.source, 1)), s = s.updateFor(e, i);
      for (let r of e.effects) if (r.is(ws2)) s = new n61(s.source, 1, r.value);
      else if (r.is(nn2)) s = new n61(s.source, 0);
      else if (r.is(cl)) for (let o of r.value) o.source == s.source && (s = o);
      return s;
    }
    updateFor(e, t) {
      return this.map(e.changes);
    }
    map(e) {
      return this;
    }
    touches(e) {
      return e.changes.touchesRange(zt(e.state));
    }
  };
  var vs = class n62 extends ft2 {
    constructor(e, t, i, s, r, o) {
      super(e, 3, t), this.limit = i, this.result = s, this.from = r, this.to = o;
    }
    hasResult() {
      return true;
    }
    updateFor(e, t) {
      var i;
      if (!(t & 3)) return this.map(e.changes);
      let s = this.result;
      s.map && !e.changes.empty && (s = s.map(s, e.changes));
      let r = e.changes.mapPos(this.from), o = e.changes.mapPos(this.to, 1), l = zt(e.state);
      if (l > o || !s || t & 2 && (zt(e.startState) == this.from || l < this.limit)) return new ft2(this.source, t & 4 ? 1 : 0);
      let a = e.changes.mapPos(this.limit);
      return Em(s.validFor, e.state, r, o) ? new n62(this.source, this.explicit, a, s, r, o) : s.update && (s = s.update(s, r, o, new bs(e.state, l, false))) ? new n62(this.source, this.explicit, a, s, s.from, (i = s.to) !== null && i !== void 0 ? i : zt(e.state)) : new ft2(this.source, 1, this.explicit);
    }
    map(e) {
      if (e.empty) return this;
      let t = this.result.map ? this.result.map(this.result, e) : this.result;
      return t ? new n62(this.source, this.explicit, e.mapPos(this.limit), t, e.mapPos(this.from), e.mapPos(this.to, 1)) : new ft2(this.source, 0);
    }
    touches(e) {
      return e.changes.touchesRange(this.from, this.to);
    }
  };
  function Em(n66, e, t, i) {
    if (!n66) return false;
    let s = e.sliceDoc(t, i);
    return typeof n66 == "function" ? n66(s, t, i, e) : jc(n66, true).test(s);
  }
  var cl = E.define({ map(n66, e) {
    return n66.map((t) => t.map(e));
  } });
  var xe = J.define({ create() {
    return ll.start();
  }, update(n66, e) {
    return n66.update(e);
  }, provide: (n66) => [zi.from(n66, (e) => e.tooltip), O.contentAttributes.from(n66, (e) => e.attrs)] });
  function fl(n66, e) {
    let t = e.completion.apply || e.completion.label, i = n66.state.field(xe).active.find((s) => s.source == e.source);
    return i instanceof vs ? (typeof t == "string" ? n66.dispatch({ ...wm(n66.state, t, i.from, i.to), annotations: Uc.of(e.completion) }) : t(n66, e.completion, i.from, i.to), true) : false;
  }
  var Lm = Cm(xe, fl);
  function ys(n66, e = "option") {
    return (t) => {
      let i = t.state.field(xe, false);
      if (!i || !i.open || i.open.disabled || Date.now() - i.open.timestamp < t.state.facet(se).interactionDelay) return false;
      let s = 1, r;
      e == "page" && (r = Mo2(t, i.open.tooltip)) && (s = Math.max(2, Math.floor(r.dom.offsetHeight / r.dom.querySelector("li").offsetHeight) - 1));
      let { length: o } = i.open.options, l = i.open.selected > -1 ? i.open.selected + s * (n66 ? 1 : -1) : n66 ? 0 : o - 1;
      return l < 0 ? l = e == "page" ? 0 : o - 1 : l >= o && (l = e == "page" ? o - 1 : 0), t.dispatch({ effects: hl.of(l) }), true;
    };
  }
  var Rm = (n66) => {
    let e = n66.state.field(xe, false);
    return n66.state.readOnly || !e || !e.open || e.open.selected < 0 || e.open.disabled || Date.now() - e.open.timestamp < n66.state.facet(se).interactionDelay ? false : fl(n66, e.open.options[e.open.selected]);
  };
  var il = (n66) => n66.state.field(xe, false) ? (n66.dispatch({ effects: ws2.of(true) }), true) : false;
  var Pm = (n66) => {
    let e = n66.state.field(xe, false);
    return !e || !e.active.some((t) => t.state != 0) ? false : (n66.dispatch({ effects: nn2.of(null) }), true);
  };
  var al = class {
    constructor(e, t) {
      this.active = e, this.context = t, this.time = Date.now(), this.updates = [], this.done = void 0;
    }
  };
  var Im = 50;
  var Nm = 1e3;
  var Fm = te.fromClass(class {
    constructor(n66) {
      this.view = n66, this.debounceUpdate = -1, this.running = [], this.debounceAccept = -1, this.pendingStart = false, this.composing = 0;
      for (let e of n66.state.field(xe).active) e.isPending && this.startQuery(e);
    }
    update(n66) {
      let e = n66.state.field(xe), t = n66.state.facet(se);
      if (!n66.selectionSet && !n66.docChanged && n66.startState.field(xe) == e) return;
      let i = n66.transactions.some((r) => {
        let o = Gc(r, t);
        return o & 8 || (r.selection || r.docChanged) && !(o & 3);
      });
      for (let r = 0; r < this.running.length; r++) {
        let o = this.running[r];
        if (i || o.context.abortOnDocChange && n66.docChanged || o.updates.length + n66.transactions.length > Im && Date.now() - o.time > Nm) {
          for (let l of o.context.abortListeners) try {
            l();
          } catch (a) {
            le(this.view.state, a);
          }
          o.context.abortListeners = null, this.running.splice(r--, 1);
        } else o.updates.push(...n66.transactions);
      }
      this.debounceUpdate > -1 && clearTimeout(this.debounceUpdate), n66.transactions.some((r) => r.effects.some((o) => o.is(ws2))) && (this.pendingStart = true);
      let s = this.pendingStart ? 50 : t.activateOnTypingDelay;
      if (this.debounceUpdate = e.active.some((r) => r.isPending && !this.running.some((o) => o.active.source == r.source)) ? setTimeout(() => this.startUpdate(), s) : -1, this.composing != 0) for (let r of n66.transactions) r.isUserEvent("input.type") ? this.composing = 2 : this.composing == 2 && r.selection && (this.composing = 3);
    }
    startUpdate() {
      this.debounceUpdate = -1, this.pendingStart = false;
      let { state: n66 } = this.view, e = n66.field(xe);
      for (let t of e.active) t.isPending && !this.running.some((i) => i.active.source == t.source) && this.startQuery(t);
      this.running.length && e.open && e.open.disabled && (this.debounceAccept = setTimeout(() => this.accept(), this.view.state.facet(se).updateSyncTime));
    }
    startQuery(n66) {
      let { state: e } = this.view, t = zt(e), i = new bs(e, t, n66.explicit, this.view), s = new al(n66, i);
      this.running.push(s), Promise.resolve(n66.source(i)).then((r) => {
        s.context.aborted || (s.done = r || null, this.scheduleAccept());
      }, (r) => {
        this.view.dispatch({ effects: nn2.of(null) }), le(this.view.state, r);
      });
    }
    scheduleAccept() {
      this.running.every((n66) => n66.done !== void 0) ? this.accept() : this.debounceAccept < 0 && (this.debounceAccept = setTimeout(() => this.accept(), this.view.state.facet(se).updateSyncTime));
    }
    accept() {
      var n66;
      this.debounceAccept > -1 && clearTimeout(this.debounceAccept), this.debounceAccept = -1;
      let e = [], t = this.view.state.facet(se), i = this.view.state.field(xe);
      for (let s = 0; s < this.running.length; s++) {
        let r = this.running[s];
        if (r.done === void 0) continue;
        if (this.running.splice(s--, 1), r.done) {
          let l = zt(r.updates.length ? r.updates[0].startState : this.view.state), a = Math.min(l, r.done.from + (r.active.explicit ? 0 : 1)), h = new vs(r.active.source, r.active.explicit, a, r.done, r.done.from, (n66 = r.done.to) !== null && n66 !== void 0 ? n66 : l);
          for (let c of r.updates) h = h.update(c, t);
          if (h.hasResult()) {
            e.push(h);
            continue;
          }
        }
        let o = i.active.find((l) => l.source == r.active.source);
        if (o && o.isPending) if (r.done == null) {
          let l = new ft2(r.active.source, 0);
          for (let a of r.updates) l = l.update(a, t);
          l.isPending || e.push(l);
        } else this.startQuery(o);
      }
      (e.length || i.open && i.open.disabled) && this.view.dispatch({ effects: cl.of(e) });
    }
  }, { eventHandlers: { blur(n66) {
    let e = this.view.state.field(xe, false);
    if (e && e.tooltip && this.view.state.facet(se).closeOnBlur) {
      let t = e.open && Mo2(this.view, e.open.tooltip);
      (!t || !t.dom.contains(n66.relatedTarget)) && setTimeout(() => this.view.dispatch({ effects: nn2.of(null) }), 10);
    }
  }, compositionstart() {
    this.composing = 1;
  }, compositionend() {
    this.composing == 3 && setTimeout(() => this.view.dispatch({ effects: ws2.of(false) }), 20), this.composing = 0;
  } } });
  var Hm = typeof navigator == "object" && /Win/.test(navigator.platform);
  var Wm = Je.highest(O.domEventHandlers({ keydown(n66, e) {
    let t = e.state.field(xe, false);
    if (!t || !t.open || t.open.disabled || t.open.selected < 0 || !n66.key || n66.key.length > 1 || n66.ctrlKey && !(Hm && n66.altKey) || n66.metaKey) return false;
    let i = t.open.options[t.open.selected], s = t.active.find((o) => o.source == i.source), r = i.completion.commitCharacters || s.result.commitCharacters;
    return r && r.indexOf(n66.key) > -1 && fl(e, i), false;
  } }));
  var Vm = O.baseTheme({ ".cm-tooltip.cm-tooltip-autocomplete": { "& > ul": { fontFamily: "monospace", whiteSpace: "nowrap", overflow: "hidden auto", maxWidth_fallback: "700px", maxWidth: "min(700px, 95vw)", minWidth: "250px", maxHeight: "10em", height: "100%", listStyle: "none", margin: 0, padding: 0, "& > li, & > completion-section": { padding: "1px 3px", lineHeight: 1.2 }, "& > li": { overflowX: "hidden", textOverflow: "ellipsis", cursor: "pointer" }, "& > completion-section": { display: "list-item", borderBottom: "1px solid silver", paddingLeft: "0.5em", opacity: 0.7 } } }, "&light .cm-tooltip-autocomplete ul li[aria-selected]": { background: "#17c", color: "white" }, "&light .cm-tooltip-autocomplete-disabled ul li[aria-selected]": { background: "#777" }, "&dark .cm-tooltip-autocomplete ul li[aria-selected]": { background: "#347", color: "white" }, "&dark .cm-tooltip-autocomplete-disabled ul li[aria-selected]": { background: "#444" }, ".cm-completionListIncompleteTop:before, .cm-completionListIncompleteBottom:after": { content: '"\xB7\xB7\xB7"', opacity: 0.5, display: "block", textAlign: "center", cursor: "pointer" }, ".cm-tooltip.cm-completionInfo": { position: "absolute", padding: "3px 9px", width: "max-content", maxWidth: "400px", boxSizing: "border-box", whiteSpace: "pre-line" }, ".cm-completionInfo.cm-completionInfo-left": { right: "100%" }, ".cm-completionInfo.cm-completionInfo-right": { left: "100%" }, ".cm-completionInfo.cm-completionInfo-left-narrow": { right: "30px" }, ".cm-completionInfo.cm-completionInfo-right-narrow": { left: "30px" }, "&light .cm-snippetField": { backgroundColor: "#00000022" }, "&dark .cm-snippetField": { backgroundColor: "#ffffff22" }, ".cm-snippetFieldPosition": { verticalAlign: "text-top", width: 0, height: "1.15em", display: "inline-block", margin: "0 -0.7px -.7em", borderLeft: "1.4px dotted #888" }, ".cm-completionMatchedText": { textDecoration: "underline" }, ".cm-completionDetail": { marginLeft: "0.5em", fontStyle: "italic" }, ".cm-completionIcon": { fontSize: "90%", width: ".8em", display: "inline-block", textAlign: "center", paddingRight: ".6em", opacity: "0.6", boxSizing: "content-box" }, ".cm-completionIcon-function, .cm-completionIcon-method": { "&:after": { content: "'\u0192'" } }, ".cm-completionIcon-class": { "&:after": { content: "'\u25CB'" } }, ".cm-completionIcon-interface": { "&:after": { content: "'\u25CC'" } }, ".cm-completionIcon-variable": { "&:after": { content: "'\u{1D465}'" } }, ".cm-completionIcon-constant": { "&:after": { content: "'\u{1D436}'" } }, ".cm-completionIcon-type": { "&:after": { content: "'\u{1D461}'" } }, ".cm-completionIcon-enum": { "&:after": { content: "'\u222A'" } }, ".cm-completionIcon-property": { "&:after": { content: "'\u25A1'" } }, ".cm-completionIcon-keyword": { "&:after": { content: "'\u{1F511}\uFE0E'" } }, ".cm-completionIcon-namespace": { "&:after": { content: "'\u25A2'" } }, ".cm-completionIcon-text": { "&:after": { content: "'abc'", fontSize: "50%", verticalAlign: "middle" } } });
  var _c = new class extends Te2 {
  }();
  _c.startSide = 1;
  _c.endSide = -1;
  var w0 = typeof navigator == "object" && /Android\b/.test(navigator.userAgent);
  function zm(n66 = {}) {
    return [Wm, xe, se.of(n66), Fm, qm, Vm];
  }
  var Yc = [{ key: "Ctrl-Space", run: il }, { mac: "Alt-`", run: il }, { mac: "Alt-i", run: il }, { key: "Escape", run: Pm }, { key: "ArrowDown", run: ys(true) }, { key: "ArrowUp", run: ys(false) }, { key: "PageDown", run: ys(true, "page") }, { key: "PageUp", run: ys(false, "page") }, { key: "Enter", run: Rm }];
  var qm = Je.highest(ts2.computeN([se], (n66) => n66.facet(se).defaultKeymap ? [Yc] : []));
  var Ss2 = class {
    constructor(e, t, i) {
      this.from = e, this.to = t, this.diagnostic = i;
    }
  };
  var qt = class n63 {
    constructor(e, t, i) {
      this.diagnostics = e, this.panel = t, this.selected = i;
    }
    static init(e, t, i) {
      let s = i.facet(sn2).markerFilter;
      s && (e = s(e, i));
      let r = e.slice().sort((d, p) => d.from - p.from || d.to - p.to), o = new Me(), l = [], a = 0, h = i.doc.iter(), c = 0, f = i.doc.length;
      for (let d = 0; ; ) {
        let p = d == r.length ? null : r[d];
        if (!p && !l.length) break;
        let m, g;
        if (l.length) m = a, g = l.reduce((b, D) => Math.min(b, D.to), p && p.from > m ? p.from : 1e8);
        else {
          if (m = p.from, m > f) break;
          g = p.to, l.push(p), d++;
        }
        for (; d < r.length; ) {
          let b = r[d];
          if (b.from == m && (b.to > b.from || b.to == m)) l.push(b), d++, g = Math.min(b.to, g);
          else {
            g = Math.min(b.from, g);
            break;
          }
        }
        g = Math.min(g, f);
        let y = false;
        if (l.some((b) => b.from == m && (b.to == g || g == f)) && (y = m == g, !y && g - m < 10)) {
          let b = m - (c + h.value.length);
          b > 0 && (h.next(b), c = m);
          for (let D = m; ; ) {
            if (D >= g) {
              y = true;
              break;
            }
            if (!h.lineBreak && c + h.value.length > D) break;
            D = c + h.value.length, c += h.value.length, h.next();
          }
        }
        let v = Qm(l);
        if (y) o.add(m, m, L.widget({ widget: new ul(v), diagnostics: l.slice() }));
        else {
          let b = l.reduce((D, w) => w.markClass ? D + " " + w.markClass : D, "");
          o.add(m, g, L.mark({ class: "cm-lintRange cm-lintRange-" + v + b, diagnostics: l.slice(), inclusiveEnd: l.some((D) => D.to > g) }));
        }
        if (a = g, a == f) break;
        for (let b = 0; b < l.length; b++) l[b].to <= a && l.splice(b--, 1);
      }
      let u = o.finish();
      return new n63(u, t, pi2(u));
    }
  };
  function pi2(n66, e = null, t = 0) {
    let i = null;
    return n66.between(t, 1e9, (s, r, { spec: o }) => {
      if (!(e && o.diagnostics.indexOf(e) < 0)) if (!i) i = new Ss2(s, r, e || o.diagnostics[0]);
      else {
        if (o.diagnostics.indexOf(i.diagnostic) < 0) return false;
        i = new Ss2(i.from, r, i.diagnostic);
      }
    }), i;
  }
  function Km(n66, e) {
    let t = e.pos, i = e.end || t, s = n66.state.facet(sn2).hideOn(n66, t, i);
    if (s != null) return s;
    let r = n66.startState.doc.lineAt(e.pos);
    return !!(n66.effects.some((o) => o.is(dl)) || n66.changes.touchesRange(r.from, Math.max(r.to, i)));
  }
  function $m(n66, e) {
    return n66.field(Ge, false) ? e : e.concat(E.appendConfig.of(eg));
  }
  function jm(n66, e) {
    return { effects: $m(n66, [dl.of(e)]) };
  }
  var dl = E.define();
  var Qc = E.define();
  var Zc = E.define();
  var Ge = J.define({ create() {
    return new qt(L.none, null, null);
  }, update(n66, e) {
    if (e.docChanged && n66.diagnostics.size) {
      let t = n66.diagnostics.map(e.changes), i = null, s = n66.panel;
      if (n66.selected) {
        let r = e.changes.mapPos(n66.selected.from, 1);
        i = pi2(t, n66.selected.diagnostic, r) || pi2(t, null, r);
      }
      !t.size && s && e.state.facet(sn2).autoPanel && (s = null), n66 = new qt(t, s, i);
    }
    for (let t of e.effects) if (t.is(dl)) {
      let i = e.state.facet(sn2).autoPanel ? t.value.length ? As.open : null : n66.panel;
      n66 = qt.init(t.value, i, e.state);
    } else t.is(Qc) ? n66 = new qt(n66.diagnostics, t.value ? As.open : null, n66.selected) : t.is(Zc) && (n66 = new qt(n66.diagnostics, n66.panel, t.value));
    return n66;
  }, provide: (n66) => [Pt2.from(n66, (e) => e.panel), O.decorations.from(n66, (e) => e.diagnostics)] });
  var Um = L.mark({ class: "cm-lintRange cm-lintRange-active" });
  function Gm(n66, e, t) {
    let { diagnostics: i } = n66.state.field(Ge), s, r = -1, o = -1;
    i.between(e - (t < 0 ? 1 : 0), e + (t > 0 ? 1 : 0), (a, h, { spec: c }) => {
      if (e >= a && e <= h && (a == h || (e > a || t > 0) && (e < h || t < 0))) return s = c.diagnostics, r = a, o = h, false;
    });
    let l = n66.state.facet(sn2).tooltipFilter;
    return s && l && (s = l(s, n66.state)), s ? { pos: r, end: o, above: true, create() {
      return { dom: _m(n66, s) };
    } } : null;
  }
  function _m(n66, e) {
    return H("ul", { class: "cm-tooltip-lint" }, e.map((t) => tf2(n66, t, false)));
  }
  var Xc = (n66) => {
    let e = n66.state.field(Ge, false);
    return !e || !e.panel ? false : (n66.dispatch({ effects: Qc.of(false) }), true);
  };
  var sn2 = T.define({ combine(n66) {
    return { sources: n66.map((e) => e.source).filter((e) => e != null), ...de(n66.map((e) => e.config), { delay: 750, markerFilter: null, tooltipFilter: null, needsRefresh: null, hideOn: () => null }, { delay: Math.max, markerFilter: Jc, tooltipFilter: Jc, needsRefresh: (e, t) => e ? t ? (i) => e(i) || t(i) : e : t, hideOn: (e, t) => e ? t ? (i, s, r) => e(i, s, r) || t(i, s, r) : e : t, autoPanel: (e, t) => e || t }) };
  } });
  function Jc(n66, e) {
    return n66 ? e ? (t, i) => e(n66(t, i), i) : n66 : e;
  }
  function ef2(n66) {
    let e = [];
    if (n66) e: for (let { name: t } of n66) {
      for (let i = 0; i < t.length; i++) {
        let s = t[i];
        if (/[a-zA-Z]/.test(s) && !e.some((r) => r.toLowerCase() == s.toLowerCase())) {
          e.push(s);
          continue e;
        }
      }
      e.push("");
    }
    return e;
  }
  function tf2(n66, e, t) {
    var i;
    let s = t ? ef2(e.actions) : [];
    return H("li", { class: "cm-diagnostic cm-diagnostic-" + e.severity }, H("span", { class: "cm-diagnosticText" }, e.renderMessage ? e.renderMessage(n66) : e.message), (i = e.actions) === null || i === void 0 ? void 0 : i.map((r, o) => {
      let l = 0, a = (d) => {
        if (d.preventDefault(), l > Date.now() - 100) return;
        let p = pi2(n66.state.field(Ge).diagnostics, e);
        p && r.apply(n66, p.from, p.to), l = Date.now();
      }, { name: h } = r, c = s[o] ? h.indexOf(s[o]) : -1, f = c < 0 ? h : [h.slice(0, c), H("u", h.slice(c, c + 1)), h.slice(c + 1)], u = r.markClass ? " " + r.markClass : "";
      return H("button", { type: "button", class: "cm-diagnosticAction" + u, onclick: a, onmousedown: a, "aria-label": ` Action: ${h}${c < 0 ? "" : ` (access key "${s[o]})"`}.` }, f);
    }), e.source && H("div", { class: "cm-diagnosticSource" }, e.source));
  }
  var ul = class extends Re {
    constructor(e) {
      super(), this.sev = e;
    }
    eq(e) {
      return e.sev == this.sev;
    }
    toDOM() {
      return H("span", { class: "cm-lintPoint cm-lintPoint-" + this.sev });
    }
  };
  var Cs = class {
    constructor(e, t) {
      this.diagnostic = t, this.id = "item_" + Math.floor(Math.random() * 4294967295).toString(16), this.dom = tf2(e, t, true), this.dom.id = this.id, this.dom.setAttribute("role", "option");
    }
  };
  var As = class n64 {
    constructor(e) {
      this.view = e, this.items = [];
      let t = (s) => {
        if (!(s.ctrlKey || s.altKey || s.metaKey)) {
          if (s.keyCode == 27) Xc(this.view), this.view.focus();
          else if (s.keyCode == 38 || s.keyCode == 33) this.moveSelection((this.selectedIndex - 1 + this.items.length) % this.items.length);
          else if (s.keyCode == 40 || s.keyCode == 34) this.moveSelection((this.selectedIndex + 1) % this.items.length);
          else if (s.keyCode == 36) this.moveSelection(0);
          else if (s.keyCode == 35) this.moveSelection(this.items.length - 1);
          else if (s.keyCode == 13) this.view.focus();
          else if (s.keyCode >= 65 && s.keyCode <= 90 && this.selectedIndex >= 0) {
            let { diagnostic: r } = this.items[this.selectedIndex], o = ef2(r.actions);
            for (let l = 0; l < o.length; l++) if (o[l].toUpperCase().charCodeAt(0) == s.keyCode) {
              let a = pi2(this.view.state.field(Ge).diagnostics, r);
              a && r.actions[l].apply(e, a.from, a.to);
            }
          } else return;
          s.preventDefault();
        }
      }, i = (s) => {
        for (let r = 0; r < this.items.length; r++) this.items[r].dom.contains(s.target) && this.moveSelection(r);
      };
      this.list = H("ul", { tabIndex: 0, role: "listbox", "aria-label": this.view.state.phrase("Diagnostics"), onkeydown: t, onclick: i }), this.dom = H("div", { class: "cm-panel-lint" }, this.list, H("button", { type: "button", name: "close", "aria-label": this.view.state.phrase("close"), onclick: () => Xc(this.view) }, "\xD7")), this.update();
    }
    get selectedIndex() {
      let e = this.view.state.field(Ge).selected;
      if (!e) return -1;
      for (let t = 0; t < this.items.length; t++) if (this.items[t].diagnostic == e.diagnostic) return t;
      return -1;
    }
    update() {
      let { diagnostics: e, selected: t } = this.view.state.field(Ge), i = 0, s = false, r = null, o = /* @__PURE__ */ new Set();
      for (e.between(0, this.view.state.doc.length, (l, a, { spec: h }) => {
        for (let c of h.diagnostics) {
          if (o.has(c)) continue;
          o.add(c);
          let f = -1, u;
          for (let d = i; d < this.items.length; d++) if (this.items[d].diagnostic == c) {
            f = d;
            break;
          }
          f < 0 ? (u = new Cs(this.view, c), this.items.splice(i, 0, u), s = true) : (u = this.items[f], f > i && (this.items.splice(i, f - i), s = true)), t && u.diagnostic == t.diagnostic ? u.dom.hasAttribute("aria-selected") || (u.dom.setAttribute("aria-selected", "true"), r = u) : u.dom.hasAttribute("aria-selected") && u.dom.removeAttribute("aria-selected"), i++;
        }
      }); i < this.items.length && !(this.items.length == 1 && this.items[0].diagnostic.from < 0); ) s = true, this.items.pop();
      this.items.length == 0 && (this.items.push(new Cs(this.view, { from: -1, to: -1, severity: "info", message: this.view.state.phrase("No diagnostics") })), s = true), r ? (this.list.setAttribute("aria-activedescendant", r.id), this.view.requestMeasure({ key: this, read: () => ({ sel: r.dom.getBoundingClientRect(), panel: this.list.getBoundingClientRect() }), write: ({ sel: l, panel: a }) => {
        let h = a.height / this.list.offsetHeight;
        l.top < a.top ? this.list.scrollTop -= (a.top - l.top) / h : l.bottom > a.bottom && (this.list.scrollTop += (l.bottom - a.bottom) / h);
      } })) : this.selectedIndex < 0 && this.list.removeAttribute("aria-activedescendant"), s && this.sync();
    }
    sync() {
      let e = this.list.firstChild;
      function t() {
        let i = e;
        e = i.nextSibling, i.remove();
      }
      for (let i of this.items) if (i.dom.parentNode == this.list) {
        for (; e != i.dom; ) t();
        e = i.dom.nextSibling;
      } else this.list.insertBefore(i.dom, e);
      for (; e; ) t();
    }
    moveSelection(e) {
      if (this.selectedIndex < 0) return;
      let t = this.view.state.field(Ge), i = pi2(t.diagnostics, this.items[e].diagnostic);
      i && this.view.dispatch({ selection: { anchor: i.from, head: i.to }, scrollIntoView: true, effects: Zc.of(i) });
    }
    static open(e) {
      return new n64(e);
    }
  };
  function Ym(n66, e = 'viewBox="0 0 40 40"') {
    return `url('data:image/svg+xml,<svg xmlns="http://www.w3.org/2000/svg" ${e}>${encodeURIComponent(n66)}</svg>')`;
  }
  function ks(n66) {
    return Ym(`<path d="m0 2.5 l2 -1.5 l1 0 l2 1.5 l1 0" stroke="${n66}" fill="none" stroke-width=".7"/>`, 'width="6" height="3"');
  }
  var Xm = O.baseTheme({ ".cm-diagnostic": { padding: "3px 6px 3px 8px", marginLeft: "-1px", display: "block", whiteSpace: "pre-wrap" }, ".cm-diagnostic-error": { borderLeft: "5px solid #d11" }, ".cm-diagnostic-warning": { borderLeft: "5px solid orange" }, ".cm-diagnostic-info": { borderLeft: "5px solid #999" }, ".cm-diagnostic-hint": { borderLeft: "5px solid #66d" }, ".cm-diagnosticAction": { font: "inherit", border: "none", padding: "2px 4px", backgroundColor: "#444", color: "white", borderRadius: "3px", marginLeft: "8px", cursor: "pointer" }, ".cm-diagnosticSource": { fontSize: "70%", opacity: 0.7 }, ".cm-lintRange": { backgroundPosition: "left bottom", backgroundRepeat: "repeat-x", paddingBottom: "0.7px" }, ".cm-lintRange-error": { backgroundImage: ks("#f11") }, ".cm-lintRange-warning": { backgroundImage: ks("orange") }, ".cm-lintRange-info": { backgroundImage: ks("#999") }, ".cm-lintRange-hint": { backgroundImage: ks("#66d") }, ".cm-lintRange-active": { backgroundColor: "#ffdd9980" }, ".cm-tooltip-lint": { padding: 0, margin: 0 }, ".cm-lintPoint": { position: "relative", "&:after": { content: '""', position: "absolute", bottom: 0, left: "-2px", borderLeft: "3px solid transparent", borderRight: "3px solid transparent", borderBottom: "4px solid #d11" } }, ".cm-lintPoint-warning": { "&:after": { borderBottomColor: "orange" } }, ".cm-lintPoint-info": { "&:after": { borderBottomColor: "#999" } }, ".cm-lintPoint-hint": { "&:after": { borderBottomColor: "#66d" } }, ".cm-panel.cm-panel-lint": { position: "relative", "& ul": { maxHeight: "100px", overflowY: "auto", "& [aria-selected]": { backgroundColor: "#ddd", "& u": { textDecoration: "underline" } }, "&:focus [aria-selected]": { background_fallback: "#bdf", backgroundColor: "Highlight", color_fallback: "white", color: "HighlightText" }, "& u": { textDecoration: "none" }, padding: 0, margin: 0 }, "& [name=close]": { position: "absolute", top: "0", right: "2px", background: "inherit", border: "none", font: "inherit", padding: 0, margin: 0 } }, "&dark .cm-lintRange-active": { backgroundColor: "#86714a80" }, "&dark .cm-panel.cm-panel-lint ul": { "& [aria-selected]": { backgroundColor: "#2e343e" } } });
  function Jm(n66) {
    return n66 == "error" ? 4 : n66 == "warning" ? 3 : n66 == "info" ? 2 : 1;
  }
  function Qm(n66) {
    let e = "hint", t = 1;
    for (let i of n66) {
      let s = Jm(i.severity);
      s > t && (t = s, e = i.severity);
    }
    return e;
  }
  var Zm = Ao2(Gm, { hideOn: Km });
  var eg = [Ge, O.decorations.compute([Ge], (n66) => {
    let { selected: e, panel: t } = n66.field(Ge);
    return !e || !t || e.from == e.to ? L.none : L.set([Um.range(e.from, e.to)]);
  }), Zm, Xm];
  var nf2 = typeof String.prototype.normalize == "function" ? (n66) => n66.normalize("NFKD") : (n66) => n66;
  var St = class {
    constructor(e, t, i = 0, s = e.length, r, o) {
      this.test = o, this.value = { from: 0, to: 0, precise: false }, this.done = false, this.matches = [], this.buffer = "", this.bufferPos = 0, this.iter = e.iterRange(i, s), this.bufferStart = i, this.normalize = r ? (l) => r(nf2(l)) : nf2, this.query = this.normalize(t);
    }
    peek() {
      if (this.bufferPos == this.buffer.length) {
        if (this.bufferStart += this.buffer.length, this.iter.next(), this.iter.done) return -1;
        this.bufferPos = 0, this.buffer = this.iter.value;
      }
      return De(this.buffer, this.bufferPos);
    }
    next() {
      for (; this.matches.length; ) this.matches.pop();
      return this.nextOverlapping();
    }
    nextOverlapping() {
      for (; ; ) {
        let e = this.peek();
        if (e < 0) return this.done = true, this;
        let t = bn(e), i = this.bufferStart + this.bufferPos;
        this.bufferPos += Xe2(e);
        let s = this.normalize(t);
        if (s.length) for (let r = 0, o = i, l = true; ; r++) {
          let a = s.charCodeAt(r), h = this.match(a, o, l, this.bufferPos + this.bufferStart, r == s.length - 1);
          if (h) return this.value = h, this;
          if (r == s.length - 1) break;
          l && r < t.length && t.charCodeAt(r) == a ? o++ : l = false;
        }
      }
    }
    match(e, t, i, s, r) {
      let o = null;
      for (let l = 0; l < this.matches.length; ) {
        let a = this.matches[l], h = false;
        this.query.charCodeAt(a.index) == e && (a.index == this.query.length - 1 ? o = { from: a.from, to: s, precise: r && a.precise } : (a.index++, h = true)), h ? l++ : this.matches.splice(l, 1);
      }
      return this.query.charCodeAt(0) == e && (this.query.length == 1 ? o = { from: t, to: s, precise: i && r } : this.matches.push({ from: t, index: 1, precise: i })), o && this.test && !this.test(o.from, o.to, this.buffer, this.bufferStart) && (o = null), o;
    }
  };
  typeof Symbol < "u" && (St.prototype[Symbol.iterator] = function() {
    return this;
  });
  var of2 = { from: -1, to: -1, match: /.*/.exec(""), precise: true };
  var xl2 = "gm" + (/x/.unicode == null ? "" : "u");
  var Ds = class {
    constructor(e, t, i, s = 0, r = e.length) {
      if (this.text = e, this.to = r, this.curLine = "", this.done = false, this.value = of2, /\\[sWDnr]|\n|\r|\[\^/.test(t)) return new Bs(e, t, i, s, r);
      this.re = new RegExp(t, xl2 + (i?.ignoreCase ? "i" : "")), this.test = i?.test, this.iter = e.iter();
      let o = e.lineAt(s);
      this.curLineStart = o.from, this.matchPos = Es(e, s), this.getLine(this.curLineStart);
    }
    getLine(e) {
      this.iter.next(e), this.iter.lineBreak ? this.curLine = "" : (this.curLine = this.iter.value, this.curLineStart + this.curLine.length > this.to && (this.curLine = this.curLine.slice(0, this.to - this.curLineStart)), this.iter.next());
    }
    nextLine() {
      this.curLineStart = this.curLineStart + this.curLine.length + 1, this.curLineStart > this.to ? this.curLine = "" : this.getLine(0);
    }
    next() {
      for (let e = this.matchPos - this.curLineStart; ; ) {
        this.re.lastIndex = e;
        let t = this.matchPos <= this.to && this.re.exec(this.curLine);
        if (t) {
          let i = this.curLineStart + t.index, s = i + t[0].length;
          if (this.matchPos = Es(this.text, s + (i == s ? 1 : 0)), i == this.curLineStart + this.curLine.length && this.nextLine(), (i < s || i > this.value.to) && (!this.test || this.test(i, s, t))) return this.value = { from: i, to: s, precise: true, match: t }, this;
          e = this.matchPos - this.curLineStart;
        } else if (this.curLineStart + this.curLine.length < this.to) this.nextLine(), e = 0;
        else return this.done = true, this;
      }
    }
  };
  var pl = /* @__PURE__ */ new WeakMap();
  var Os = class n65 {
    constructor(e, t) {
      this.from = e, this.text = t;
    }
    get to() {
      return this.from + this.text.length;
    }
    static get(e, t, i) {
      let s = pl.get(e);
      if (!s || s.from >= i || s.to <= t) {
        let l = new n65(t, e.sliceString(t, i));
        return pl.set(e, l), l;
      }
      if (s.from == t && s.to == i) return s;
      let { text: r, from: o } = s;
      return o > t && (r = e.sliceString(t, o) + r, o = t), s.to < i && (r += e.sliceString(s.to, i)), pl.set(e, new n65(o, r)), new n65(t, r.slice(t - o, i - o));
    }
  };
  var Bs = class {
    constructor(e, t, i, s, r) {
      this.text = e, this.to = r, this.done = false, this.value = of2, this.matchPos = Es(e, s), this.re = new RegExp(t, xl2 + (i?.ignoreCase ? "i" : "")), this.test = i?.test, this.flat = Os.get(e, s, this.chunkEnd(s + 5e3));
    }
    chunkEnd(e) {
      return e >= this.to ? this.to : this.text.lineAt(e).to;
    }
    next() {
      for (; ; ) {
        let e = this.re.lastIndex = this.matchPos - this.flat.from, t = this.re.exec(this.flat.text);
        if (t && !t[0] && t.index == e && (this.re.lastIndex = e + 1, t = this.re.exec(this.flat.text)), t) {
          let i = this.flat.from + t.index, s = i + t[0].length;
          if ((this.flat.to >= this.to || t.index + t[0].length <= this.flat.text.length - 10) && (!this.test || this.test(i, s, t))) return this.value = { from: i, to: s, precise: true, match: t }, this.matchPos = Es(this.text, s + (i == s ? 1 : 0)), this;
        }
        if (this.flat.to == this.to) return this.done = true, this;
        this.flat = Os.get(this.text, this.flat.from, this.chunkEnd(this.flat.from + this.flat.text.length * 2));
      }
    }
  };
  typeof Symbol < "u" && (Ds.prototype[Symbol.iterator] = Bs.prototype[Symbol.iterator] = function() {
    return this;
  });
  function tg(n66) {
    try {
      return new RegExp(n66, xl2), true;
    } catch {
      return false;
    }
  }
  function Es(n66, e) {
    if (e >= n66.length) return e;
    let t = n66.lineAt(e), i;
    for (; e < t.to && (i = t.text.charCodeAt(e - t.from)) >= 56320 && i < 57344; ) e++;
    return e;
  }
  var ig = (n66) => {
    let e = Hh(n66, "cm-goto-line");
    if (e) {
      let o = e.dom.querySelector("input[type=text]");
      return o && o.select(), true;
    }
    let { state: t } = n66, i = String(t.doc.lineAt(n66.state.selection.main.head).number), { close: s, result: r } = Fh(n66, { class: "cm-goto-line", label: t.phrase("Go to line"), input: { type: "text", name: "line", value: i }, focus: true, submitLabel: t.phrase("go") });
    return r.then((o) => {
      let l = o && /^([+-])?(\d+)?(:\d+)?(%)?$/.exec(o.elements.line.value);
      if (!l) {
        n66.dispatch({ effects: s });
        return;
      }
      let a = t.doc.lineAt(t.selection.main.head), [, h, c, f, u] = l, d = f ? +f.slice(1) : 0, p = c ? +c : a.number;
      if (c && u) {
        let y = p / 100;
        h && (y = y * (h == "-" ? -1 : 1) + a.number / t.doc.lines), p = Math.round(t.doc.lines * y);
      } else c && h && (p = p * (h == "-" ? -1 : 1) + a.number);
      let m = t.doc.line(Math.max(1, Math.min(t.doc.lines, p))), g = x.cursor(m.from + Math.max(0, Math.min(d, m.length)));
      n66.dispatch({ effects: [s, O.scrollIntoView(g.from, { y: "center" })], selection: g });
    }), true;
  };
  var ng = { highlightWordAroundCursor: false, minSelectionLength: 1, maxMatches: 100, wholeWords: false };
  var lf2 = T.define({ combine(n66) {
    return de(n66, ng, { highlightWordAroundCursor: (e, t) => e || t, minSelectionLength: Math.min, maxMatches: Math.min });
  } });
  function sg(n66) {
    let e = [hg, ag];
    return n66 && e.push(lf2.of(n66)), e;
  }
  var rg = L.mark({ class: "cm-selectionMatch" });
  var og = L.mark({ class: "cm-selectionMatch cm-selectionMatch-main" });
  function sf2(n66, e, t, i) {
    return (t == 0 || n66(e.sliceDoc(t - 1, t)) != G.Word) && (i == e.doc.length || n66(e.sliceDoc(i, i + 1)) != G.Word);
  }
  function lg(n66, e, t, i) {
    return n66(e.sliceDoc(t, t + 1)) == G.Word && n66(e.sliceDoc(i - 1, i)) == G.Word;
  }
  var ag = te.fromClass(class {
    constructor(n66) {
      this.decorations = this.getDeco(n66);
    }
    update(n66) {
      (n66.selectionSet || n66.docChanged || n66.viewportChanged) && (this.decorations = this.getDeco(n66.view));
    }
    getDeco(n66) {
      let e = n66.state.facet(lf2), { state: t } = n66, i = t.selection;
      if (i.ranges.length > 1) return L.none;
      let s = i.main, r, o = null;
      if (s.empty) {
        if (!e.highlightWordAroundCursor) return L.none;
        let a = t.wordAt(s.head);
        if (!a) return L.none;
        o = t.charCategorizer(s.head), r = t.sliceDoc(a.from, a.to);
      } else {
        let a = s.to - s.from;
        if (a < e.minSelectionLength || a > 200) return L.none;
        if (e.wholeWords) {
          if (r = t.sliceDoc(s.from, s.to), o = t.charCategorizer(s.head), !(sf2(o, t, s.from, s.to) && lg(o, t, s.from, s.to))) return L.none;
        } else if (r = t.sliceDoc(s.from, s.to), !r) return L.none;
      }
      let l = [];
      for (let a of n66.visibleRanges) {
        let h = new St(t.doc, r, a.from, a.to);
        for (; !h.next().done; ) {
          let { from: c, to: f } = h.value;
          if ((!o || sf2(o, t, c, f)) && (s.empty && c <= s.from && f >= s.to ? l.push(og.range(c, f)) : (c >= s.to || f <= s.from) && l.push(rg.range(c, f)), l.length > e.maxMatches)) return L.none;
        }
      }
      return L.set(l);
    }
  }, { decorations: (n66) => n66.decorations });
  var hg = O.baseTheme({ ".cm-selectionMatch": { backgroundColor: "#99ff7780" }, ".cm-searchMatch .cm-selectionMatch": { backgroundColor: "transparent" } });
  var cg = ({ state: n66, dispatch: e }) => {
    let { selection: t } = n66, i = x.create(t.ranges.map((s) => n66.wordAt(s.head) || x.cursor(s.head)), t.mainIndex);
    return i.eq(t) ? false : (e(n66.update({ selection: i })), true);
  };
  function fg(n66, e) {
    let { main: t, ranges: i } = n66.selection, s = n66.wordAt(t.head), r = s && s.from == t.from && s.to == t.to;
    for (let o = false, l = new St(n66.doc, e, i[i.length - 1].to); ; ) if (l.next(), l.done) {
      if (o) return null;
      l = new St(n66.doc, e, 0, Math.max(0, i[i.length - 1].from - 1)), o = true;
    } else {
      if (o && i.some((a) => a.from == l.value.from)) continue;
      if (r) {
        let a = n66.wordAt(l.value.from);
        if (!a || a.from != l.value.from || a.to != l.value.to) continue;
      }
      return l.value;
    }
  }
  var ug = ({ state: n66, dispatch: e }) => {
    let { ranges: t } = n66.selection;
    if (t.some((r) => r.from === r.to)) return cg({ state: n66, dispatch: e });
    let i = n66.sliceDoc(t[0].from, t[0].to);
    if (n66.selection.ranges.some((r) => n66.sliceDoc(r.from, r.to) != i)) return false;
    let s = fg(n66, i);
    return s ? (e(n66.update({ selection: n66.selection.addRange(x.range(s.from, s.to), false), effects: O.scrollIntoView(s.to) })), true) : false;
  };
  var yi = T.define({ combine(n66) {
    return de(n66, { top: false, caseSensitive: false, literal: false, regexp: false, wholeWord: false, createPanel: (e) => new bl2(e), scrollToMatch: (e) => O.scrollIntoView(e) });
  } });
  var Ls = class {
    constructor(e) {
      this.search = e.search, this.caseSensitive = !!e.caseSensitive, this.literal = !!e.literal, this.regexp = !!e.regexp, this.replace = e.replace || "", this.valid = !!this.search && (!this.regexp || tg(this.search)), this.unquoted = this.unquote(this.search), this.wholeWord = !!e.wholeWord, this.test = e.test;
    }
    unquote(e) {
      return this.literal ? e : e.replace(/\\([nrt\\])/g, (t, i) => i == "n" ? `
` : i == "r" ? "\r" : i == "t" ? "	" : "\\");
    }
    eq(e) {
      return this.search == e.search && this.replace == e.replace && this.caseSensitive == e.caseSensitive && this.regexp == e.regexp && this.wholeWord == e.wholeWord && this.test == e.test;
    }
    create() {
      return this.regexp ? new gl(this) : new ml(this);
    }
    getCursor(e, t = 0, i) {
      let s = e.doc ? e : _.create({ doc: e });
      return i == null && (i = s.doc.length), this.regexp ? gi2(this, s, t, i) : mi2(this, s, t, i);
    }
  };
  var Rs = class {
    constructor(e) {
      this.spec = e;
    }
  };
  function dg(n66, e, t) {
    return (i, s, r, o) => {
      if (t && !t(i, s, r, o)) return false;
      let l = i >= o && s <= o + r.length ? r.slice(i - o, s - o) : e.doc.sliceString(i, s);
      return n66(l, e, i, s);
    };
  }
  function mi2(n66, e, t, i) {
    let s;
    return n66.wholeWord && (s = pg(e.doc, e.charCategorizer(e.selection.main.head))), n66.test && (s = dg(n66.test, e, s)), new St(e.doc, n66.unquoted, t, i, n66.caseSensitive ? void 0 : (r) => r.toLowerCase(), s);
  }
  function pg(n66, e) {
    return (t, i, s, r) => ((r > t || r + s.length < i) && (r = Math.max(0, t - 2), s = n66.sliceString(r, Math.min(n66.length, i + 2))), (e(Ps(s, t - r)) != G.Word || e(Is(s, t - r)) != G.Word) && (e(Is(s, i - r)) != G.Word || e(Ps(s, i - r)) != G.Word));
  }
  var ml = class extends Rs {
    constructor(e) {
      super(e);
    }
    nextMatch(e, t, i) {
      let s = mi2(this.spec, e, i, e.doc.length).nextOverlapping();
      if (s.done) {
        let r = Math.min(e.doc.length, t + this.spec.unquoted.length);
        s = mi2(this.spec, e, 0, r).nextOverlapping();
      }
      return s.done || s.value.from == t && s.value.to == i ? null : s.value;
    }
    prevMatchInRange(e, t, i) {
      for (let s = i; ; ) {
        let r = Math.max(t, s - 1e4 - this.spec.unquoted.length), o = mi2(this.spec, e, r, s), l = null;
        for (; !o.nextOverlapping().done; ) l = o.value;
        if (l) return l;
        if (r == t) return null;
        s -= 1e4;
      }
    }
    prevMatch(e, t, i) {
      let s = this.prevMatchInRange(e, 0, t);
      return s || (s = this.prevMatchInRange(e, Math.max(0, i - this.spec.unquoted.length), e.doc.length)), s && (s.from != t || s.to != i) ? s : null;
    }
    getReplacement(e) {
      return this.spec.unquote(this.spec.replace);
    }
    matchAll(e, t) {
      let i = mi2(this.spec, e, 0, e.doc.length), s = [];
      for (; !i.next().done; ) {
        if (s.length >= t) return null;
        s.push(i.value);
      }
      return s;
    }
    highlight(e, t, i, s) {
      let r = mi2(this.spec, e, Math.max(0, t - this.spec.unquoted.length), Math.min(i + this.spec.unquoted.length, e.doc.length));
      for (; !r.next().done; ) s(r.value.from, r.value.to);
    }
  };
  function mg(n66, e, t) {
    return (i, s, r) => (!t || t(i, s, r)) && n66(r[0], e, i, s);
  }
  function gi2(n66, e, t, i) {
    let s;
    return n66.wholeWord && (s = gg(e.charCategorizer(e.selection.main.head))), n66.test && (s = mg(n66.test, e, s)), new Ds(e.doc, n66.search, { ignoreCase: !n66.caseSensitive, test: s }, t, i);
  }
  function Ps(n66, e) {
    return n66.slice(Z(n66, e, false), e);
  }
  function Is(n66, e) {
    return n66.slice(e, Z(n66, e));
  }
  function gg(n66) {
    return (e, t, i) => !i[0].length || (n66(Ps(i.input, i.index)) != G.Word || n66(Is(i.input, i.index)) != G.Word) && (n66(Is(i.input, i.index + i[0].length)) != G.Word || n66(Ps(i.input, i.index + i[0].length)) != G.Word);
  }
  var gl = class extends Rs {
    nextMatch(e, t, i) {
      let s = gi2(this.spec, e, i, e.doc.length).next();
      return s.done && (s = gi2(this.spec, e, 0, t).next()), s.done ? null : s.value;
    }
    prevMatchInRange(e, t, i) {
      for (let s = 1; ; s++) {
        let r = Math.max(t, i - s * 1e4), o = gi2(this.spec, e, r, i), l = null;
        for (; !o.next().done; ) l = o.value;
        if (l && (r == t || l.from > r + 10)) return l;
        if (r == t) return null;
      }
    }
    prevMatch(e, t, i) {
      return this.prevMatchInRange(e, 0, t) || this.prevMatchInRange(e, i, e.doc.length);
    }
    getReplacement(e) {
      return this.spec.unquote(this.spec.replace).replace(/\$([$&]|\d+)/g, (t, i) => {
        if (i == "&") return e.match[0];
        if (i == "$") return "$";
        for (let s = i.length; s > 0; s--) {
          let r = +i.slice(0, s);
          if (r > 0 && r < e.match.length) return e.match[r] + i.slice(s);
        }
        return t;
      });
    }
    matchAll(e, t) {
      let i = gi2(this.spec, e, 0, e.doc.length), s = [];
      for (; !i.next().done; ) {
        if (s.length >= t) return null;
        s.push(i.value);
      }
      return s;
    }
    highlight(e, t, i, s) {
      let r = gi2(this.spec, e, Math.max(0, t - 250), Math.min(i + 250, e.doc.length));
      for (; !r.next().done; ) s(r.value.from, r.value.to);
    }
  };
  var on2 = E.define();
  var wl = E.define();
  var kt = J.define({ create(n66) {
    return new rn2(yl2(n66).create(), null);
  }, update(n66, e) {
    for (let t of e.effects) t.is(on2) ? n66 = new rn2(t.value.create(), n66.panel) : t.is(wl) && (n66 = new rn2(n66.query, t.value ? vl2 : null));
    return n66;
  }, provide: (n66) => Pt2.from(n66, (e) => e.panel) });
  var rn2 = class {
    constructor(e, t) {
      this.query = e, this.panel = t;
    }
  };
  var yg = L.mark({ class: "cm-searchMatch" });
  var bg = L.mark({ class: "cm-searchMatch cm-searchMatch-selected" });
  var xg = te.fromClass(class {
    constructor(n66) {
      this.view = n66, this.decorations = this.highlight(n66.state.field(kt));
    }
    update(n66) {
      let e = n66.state.field(kt);
      (e != n66.startState.field(kt) || n66.docChanged || n66.selectionSet || n66.viewportChanged) && (this.decorations = this.highlight(e));
    }
    highlight({ query: n66, panel: e }) {
      if (!e || !n66.spec.valid) return L.none;
      let { view: t } = this, i = new Me();
      for (let s = 0, r = t.visibleRanges, o = r.length; s < o; s++) {
        let { from: l, to: a } = r[s];
        for (; s < o - 1 && a > r[s + 1].from - 500; ) a = r[++s].to;
        n66.highlight(t.state, l, a, (h, c) => {
          let f = t.state.selection.ranges.some((u) => u.from == h && u.to == c);
          i.add(h, c, f ? bg : yg);
        });
      }
      return i.finish();
    }
  }, { decorations: (n66) => n66.decorations });
  function ln2(n66) {
    return (e) => {
      let t = e.state.field(kt, false);
      return t && t.query.spec.valid ? n66(e, t) : cf2(e);
    };
  }
  var Ns = ln2((n66, { query: e }) => {
    let { to: t } = n66.state.selection.main, i = e.nextMatch(n66.state, t, t);
    if (!i) return false;
    let s = x.single(i.from, i.to), r = n66.state.facet(yi);
    return n66.dispatch({ selection: s, effects: [kl2(n66, i), r.scrollToMatch(s.main, n66)], userEvent: "select.search" }), hf2(n66), true;
  });
  var Fs = ln2((n66, { query: e }) => {
    let { state: t } = n66, { from: i } = t.selection.main, s = e.prevMatch(t, i, i);
    if (!s) return false;
    let r = x.single(s.from, s.to), o = n66.state.facet(yi);
    return n66.dispatch({ selection: r, effects: [kl2(n66, s), o.scrollToMatch(r.main, n66)], userEvent: "select.search" }), hf2(n66), true;
  });
  var wg = ln2((n66, { query: e }) => {
    let t = e.matchAll(n66.state, 1e3);
    return !t || !t.length ? false : (n66.dispatch({ selection: x.create(t.map((i) => x.range(i.from, i.to))), userEvent: "select.search.matches" }), true);
  });
  var vg = ({ state: n66, dispatch: e }) => {
    let t = n66.selection;
    if (t.ranges.length > 1 || t.main.empty) return false;
    let { from: i, to: s } = t.main, r = [], o = 0;
    for (let l = new St(n66.doc, n66.sliceDoc(i, s)); !l.next().done; ) {
      if (r.length > 1e3) return false;
      l.value.from == i && (o = r.length), r.push(x.range(l.value.from, l.value.to));
    }
    return e(n66.update({ selection: x.create(r, o), userEvent: "select.search.matches" })), true;
  };
  var rf2 = ln2((n66, { query: e }) => {
    let { state: t } = n66, { from: i, to: s } = t.selection.main;
    if (t.readOnly) return false;
    let r = e.nextMatch(t, i, i);
    if (!r) return false;
    let o = r, l = [], a, h, c = [];
    o.precise ? o.from == i && o.to == s && (h = t.toText(e.getReplacement(o)), l.push({ from: o.from, to: o.to, insert: h }), o = e.nextMatch(t, o.from, o.to), c.push(O.announce.of(t.phrase("replaced match on line $", t.doc.lineAt(i).number) + "."))) : o = e.nextMatch(t, o.from, o.to);
    let f = n66.state.changes(l);
    return o && (a = x.single(o.from, o.to).map(f), c.push(kl2(n66, o)), c.push(t.facet(yi).scrollToMatch(a.main, n66))), n66.dispatch({ changes: f, selection: a, effects: c, userEvent: "input.replace" }), true;
  });
  var kg = ln2((n66, { query: e }) => {
    if (n66.state.readOnly) return false;
    let t = [];
    for (let s of e.matchAll(n66.state, 1e9)) {
      let { from: r, to: o, precise: l } = s;
      l && t.push({ from: r, to: o, insert: e.getReplacement(s) });
    }
    if (!t.length) return false;
    let i = n66.state.phrase("replaced $ matches", t.length) + ".";
    return n66.dispatch({ changes: t, effects: O.announce.of(i), userEvent: "input.replace.all" }), true;
  });
  function vl2(n66) {
    return n66.state.facet(yi).createPanel(n66);
  }
  function yl2(n66, e) {
    var t, i, s, r, o;
    let l = n66.selection.main, a = l.empty || l.to > l.from + 100 ? "" : n66.sliceDoc(l.from, l.to);
    if (e && !a) return e;
    let h = n66.facet(yi);
    return new Ls({ search: ((t = e?.literal) !== null && t !== void 0 ? t : h.literal) ? a : a.replace(/\n/g, "\\n"), caseSensitive: (i = e?.caseSensitive) !== null && i !== void 0 ? i : h.caseSensitive, literal: (s = e?.literal) !== null && s !== void 0 ? s : h.literal, regexp: (r = e?.regexp) !== null && r !== void 0 ? r : h.regexp, wholeWord: (o = e?.wholeWord) !== null && o !== void 0 ? o : h.wholeWord });
  }
  function af2(n66) {
    let e = qi2(n66, vl2);
    return e && e.dom.querySelector("[main-field]");
  }
  function hf2(n66) {
    let e = af2(n66);
    e && e == n66.root.activeElement && e.select();
  }
  var cf2 = (n66) => {
    let e = n66.state.field(kt, false);
    if (e && e.panel) {
      let t = af2(n66);
      if (t && t != n66.root.activeElement) {
        let i = yl2(n66.state, e.query.spec);
        i.valid && n66.dispatch({ effects: on2.of(i) }), t.focus(), t.select();
      }
    } else n66.dispatch({ effects: [wl.of(true), e ? on2.of(yl2(n66.state, e.query.spec)) : E.appendConfig.of(Ag)] });
    return true;
  };
  var ff2 = (n66) => {
    let e = n66.state.field(kt, false);
    if (!e || !e.panel) return false;
    let t = qi2(n66, vl2);
    return t && t.dom.contains(n66.root.activeElement) && n66.focus(), n66.dispatch({ effects: wl.of(false) }), true;
  };
  var Sg = [{ key: "Mod-f", run: cf2, scope: "editor search-panel" }, { key: "F3", run: Ns, shift: Fs, scope: "editor search-panel", preventDefault: true }, { key: "Mod-g", run: Ns, shift: Fs, scope: "editor search-panel", preventDefault: true }, { key: "Escape", run: ff2, scope: "editor search-panel" }, { key: "Mod-Shift-l", run: vg }, { key: "Mod-Alt-g", run: ig }, { key: "Mod-d", run: ug, preventDefault: true }];
  var bl2 = class {
    constructor(e) {
      this.view = e;
      let t = this.query = e.state.field(kt).query.spec;
      this.commit = this.commit.bind(this), this.searchField = H("input", { value: t.search, placeholder: Ce(e, "Find"), "aria-label": Ce(e, "Find"), class: "cm-textfield", name: "search", form: "", "main-field": "true", onchange: this.commit, onkeyup: this.commit }), this.replaceField = H("input", { value: t.replace, placeholder: Ce(e, "Replace"), "aria-label": Ce(e, "Replace"), class: "cm-textfield", name: "replace", form: "", onchange: this.commit, onkeyup: this.commit }), this.caseField = H("input", { type: "checkbox", name: "case", form: "", checked: t.caseSensitive, onchange: this.commit }), this.reField = H("input", { type: "checkbox", name: "re", form: "", checked: t.regexp, onchange: this.commit }), this.wordField = H("input", { type: "checkbox", name: "word", form: "", checked: t.wholeWord, onchange: this.commit });
      function i(s, r, o) {
        return H("button", { class: "cm-button", name: s, onclick: r, type: "button" }, o);
      }
      this.dom = H("div", { onkeydown: (s) => this.keydown(s), class: "cm-search" }, [this.searchField, i("next", () => Ns(e), [Ce(e, "next")]), i("prev", () => Fs(e), [Ce(e, "previous")]), i("select", () => wg(e), [Ce(e, "all")]), H("label", null, [this.caseField, Ce(e, "match case")]), H("label", null, [this.reField, Ce(e, "regexp")]), H("label", null, [this.wordField, Ce(e, "by word")]), ...e.state.readOnly ? [] : [H("br"), this.replaceField, i("replace", () => rf2(e), [Ce(e, "replace")]), i("replaceAll", () => kg(e), [Ce(e, "replace all")])], H("button", { name: "close", onclick: () => ff2(e), "aria-label": Ce(e, "close"), type: "button" }, ["\xD7"])]);
    }
    commit() {
      let e = new Ls({ search: this.searchField.value, caseSensitive: this.caseField.checked, regexp: this.reField.checked, wholeWord: this.wordField.checked, replace: this.replaceField.value });
      e.eq(this.query) || (this.query = e, this.view.dispatch({ effects: on2.of(e) }));
    }
    keydown(e) {
      Bh(this.view, e, "search-panel") ? e.preventDefault() : e.keyCode == 13 && e.target == this.searchField ? (e.preventDefault(), (e.shiftKey ? Fs : Ns)(this.view)) : e.keyCode == 13 && e.target == this.replaceField && (e.preventDefault(), rf2(this.view));
    }
    update(e) {
      for (let t of e.transactions) for (let i of t.effects) i.is(on2) && !i.value.eq(this.query) && this.setQuery(i.value);
    }
    setQuery(e) {
      this.query = e, this.searchField.value = e.search, this.replaceField.value = e.replace, this.caseField.checked = e.caseSensitive, this.reField.checked = e.regexp, this.wordField.checked = e.wholeWord;
    }
    mount() {
      this.searchField.select();
    }
    get pos() {
      return 80;
    }
    get top() {
      return this.view.state.facet(yi).top;
    }
  };
  function Ce(n66, e) {
    return n66.state.phrase(e);
  }
  var Ms = 30;
  var Ts = /[\s\.,:;?!]/;
  function kl2(n66, { from: e, to: t }) {
    let i = n66.state.doc.lineAt(e), s = n66.state.doc.lineAt(t).to, r = Math.max(i.from, e - Ms), o = Math.min(s, t + Ms), l = n66.state.sliceDoc(r, o);
    if (r != i.from) {
      for (let a = 0; a < Ms; a++) if (!Ts.test(l[a + 1]) && Ts.test(l[a])) {
        l = l.slice(a);
        break;
      }
    }
    if (o != s) {
      for (let a = l.length - 1; a > l.length - Ms; a--) if (!Ts.test(l[a - 1]) && Ts.test(l[a])) {
        l = l.slice(0, a);
        break;
      }
    }
    return O.announce.of(`${n66.state.phrase("current match")}. ${l} ${n66.state.phrase("on line")} ${i.number}.`);
  }
  var Cg = O.baseTheme({ ".cm-panel.cm-search": { padding: "2px 6px 4px", position: "relative", "& [name=close]": { position: "absolute", top: "0", right: "4px", backgroundColor: "inherit", border: "none", font: "inherit", padding: 0, margin: 0 }, "& input, & button, & label": { margin: ".2em .6em .2em 0" }, "& input[type=checkbox]": { marginRight: ".2em" }, "& label": { fontSize: "80%", whiteSpace: "pre" } }, "&light .cm-searchMatch": { backgroundColor: "#ffff0054" }, "&dark .cm-searchMatch": { backgroundColor: "#00ffff8a" }, "&light .cm-searchMatch-selected": { backgroundColor: "#ff6a0054" }, "&dark .cm-searchMatch-selected": { backgroundColor: "#ff00ff8a" } });
  var Ag = [kt, Je.low(xg), Cg];
  var Hs = class {
    constructor(e, t, i, s) {
      this.origin = e, this.changes = t, this.effects = i, this.clientID = s;
    }
  };
  var bi = class {
    constructor(e, t) {
      this.version = e, this.unconfirmed = t;
    }
  };
  var Ws = T.define({ combine(n66) {
    let e = de(n66, { startVersion: 0, clientID: null, sharedEffects: () => [] }, { generatedID: (t) => t });
    return e.clientID == null && (e.clientID = n66.length && n66[0].generatedID || ""), e;
  } });
  var Sl = oe2.define();
  var Vs = J.define({ create(n66) {
    return new bi(n66.facet(Ws).startVersion, []);
  }, update(n66, e) {
    let t = e.annotation(Sl);
    if (t) return t;
    let { sharedEffects: i, clientID: s } = e.startState.facet(Ws), r = i(e);
    return r.length || !e.changes.empty ? new bi(n66.version, n66.unconfirmed.concat(new Hs(e, e.changes, r, s))) : n66;
  } });
  function Mg(n66 = {}) {
    return [Vs, Ws.of(Object.assign({ generatedID: Math.floor(Math.random() * 1e9).toString(36) }, n66))];
  }
  function Tg(n66, e) {
    let { version: t, unconfirmed: i } = n66.field(Vs), { clientID: s } = n66.facet(Ws);
    t += e.length;
    let r = [], o = null, l = 0;
    for (let a of e) {
      let h = l < i.length ? i[l] : null;
      h && h.clientID == a.clientID ? (o && (o = o.map(h.changes, true)), r = E.mapEffects(r, a.changes), l++) : (r = E.mapEffects(r, a.changes), a.effects && (r = r.concat(a.effects)), o = o ? o.compose(a.changes) : a.changes);
    }
    if (l && (i = i.slice(l)), i.length && (o && (i = i.map((a) => {
      let h = a.changes.map(o);
      return o = o.map(a.changes, true), new Hs(a.origin, h, E.mapEffects(a.effects, o), s);
    })), r.length)) {
      let a = i.reduce((h, c) => h.compose(c.changes), ie.empty(i[0].changes.length));
      r = E.mapEffects(r, a);
    }
    return o ? n66.update({ changes: o, effects: r, annotations: [X2.addToHistory.of(false), X2.remote.of(true), Sl.of(new bi(t, i))], filter: false }) : n66.update({ annotations: [Sl.of(new bi(t, i))] });
  }
  function Dg(n66) {
    return n66.field(Vs).unconfirmed;
  }
  function Og(n66) {
    return n66.field(Vs).version;
  }

  // text.js
  var FROZEN = [_.readOnly.of(true), O.editable.of(false)];
  var WAIT2 = 15;
  var [TRIES, BETWEEN2] = [300, 20];
  function explained(markdown) {
    const parts = markdown.split(/^```\w*\n([\s\S]*?)\n```$/m);
    return parts.flatMap((part, i) => i % 2 ? [el("pre", { textContent: part })] : words(part.trim()));
  }
  function words(text) {
    const found = [];
    let at2 = 0;
    for (const match of text.matchAll(/(`+)(.+?)\1(?!`)|\*\*(.+?)\*\*|\\(.)/gs)) {
      const [all, , code, strong, plain] = match;
      found.push(
        text.slice(at2, match.index),
        code ? el("code", { textContent: code }) : strong ? el("strong", { textContent: strong.replace(/\\(.)/g, "$1") }) : plain
      );
      at2 = match.index + all.length;
    }
    return [...found, text.slice(at2)].filter((each) => each !== "");
  }
  var setColours = E.define();
  var colourField = J.define({
    create: () => L.none,
    update(colours, transaction) {
      colours = colours.map(transaction.changes);
      for (const effect of transaction.effects) if (effect.is(setColours)) colours = effect.value;
      return colours;
    },
    provide: (field) => O.decorations.from(field)
  });
  function difference(old, now) {
    const most = Math.min(old.length, now.length);
    let [from, end] = [0, 0];
    while (from < most && old[from] === now[from]) from++;
    while (end < most - from && old[old.length - 1 - end] === now[now.length - 1 - end]) end++;
    if (from && /[\ud800-\udbff]/.test(old[from - 1])) from--;
    if (end && /[\udc00-\udfff]/.test(old[old.length - end])) end--;
    return { from, to: old.length - end, insert: now.slice(from, now.length - end) };
  }
  function textPane(link, nonce) {
    return new TextPane(link, nonce).api();
  }
  var TextPane = class {
    constructor(link, nonce) {
      this.link = link;
      const { section, bar: bar2, body } = pane("text", S.text);
      this.section = section;
      this.shared = new ki();
      this.frozen = new ki();
      this.revert = el("button", {
        textContent: S.revert,
        title: S.revertHint,
        disabled: true,
        onclick: () => this.replace(this.link.saved())
      });
      this.list = el("ul", { class: "findings", "aria-label": S.findings });
      const host = el("div", { class: "editor" });
      this.epoch = "";
      this.findings = [];
      this.sending = false;
      let waiting = 0;
      bar2.append(
        el("span", { class: "space" }),
        this.quick(S.undo, "Ctrl+Z", () => Zo2(this.view)),
        this.quick(S.redo, "Ctrl+Shift+Z", () => fs2(this.view)),
        this.revert,
        this.quick(S.format, "Shift+Alt+F", this.format)
      );
      body.append(host, this.list);
      this.view = new O({
        parent: host,
        state: _.create({
          doc: "",
          extensions: [
            Dd(),
            rd(),
            dp(),
            Xu(),
            hd(),
            sg(),
            O.cspNonce.of(nonce),
            _.lineSeparator.of("\n"),
            colourField,
            O.contentAttributes.of({ "aria-label": S.editor, tabindex: "0" }),
            zm({ override: [this.completions] }),
            Ao2(this.hovered),
            this.shared.of([]),
            this.frozen.of(FROZEN),
            ts2.of([
              { key: "Mod-s", run: () => this.link.save() ?? true },
              { key: "F2", run: () => this.rename() ?? true },
              { key: "Mod-.", run: () => this.fixes(this.head()) ?? true },
              { key: "Shift-Alt-f", run: () => this.format() ?? true },
              ...Yc,
              ...ym,
              ...kp,
              ...Sg
            ]),
            O.updateListener.of((update) => {
              if (update.docChanged) {
                this.link.edited(this.view.state.doc.toString());
                clearTimeout(waiting);
                waiting = setTimeout(this.send, WAIT2);
              }
            })
          ]
        })
      });
    }
    api() {
      return {
        section: this.section,
        view: this.view,
        question: this.question,
        sent: this.sent,
        replace: this.replace,
        close: () => this.view.destroy(),
        open: this.open,
        revertible: (changed) => {
          this.revert.disabled = !changed;
        },
        receive: this.receive,
        show: this.show,
        settled: this.settled,
        follow: this.follow,
        state: () => ({ text: this.view.state.doc.toString(), epoch: this.epoch }),
        undo: () => Zo2(this.view),
        redo: () => fs2(this.view),
        version: () => Og(this.view.state),
        goTo: (at2) => this.select(this.offset(at2), this.offset(at2)),
        edit: async (what, details) => this.apply(await this.question(what, details), `input.${what}`),
        /** Make an edit; what is wrong with it is in the answer. */
        attempt: async (what, details) => {
          const answer = this.link.writes() ? await this.question(what, details) : { error: S.follows };
          if (!answer.error) this.apply(answer, `input.${what}`);
          return answer;
        },
        numbers: async (variable) => (await this.question("numbers", { variable })).numbers ?? null
      };
    }
    quick = (text, title2, act) => el("button", { textContent: text, title: title2, onclick: act });
    // --- positions: line and unit from 0 on the wire, offsets in the editor ---
    offset = ([line, unit]) => {
      const doc = this.view.state.doc;
      if (line >= doc.lines) return doc.length;
      const found = doc.line(line + 1);
      return Math.min(found.from + unit, found.to);
    };
    position = (at2) => {
      const line = this.view.state.doc.lineAt(at2);
      return [line.number - 1, at2 - line.from];
    };
    head = () => this.view.state.selection.main.head;
    /** Whether the server has everything that is here. */
    settled = () => Boolean(this.epoch) && !this.sending && Dg(this.view.state).length === 0;
    // --- changes ---
    send = () => {
      if (this.sending || !this.epoch || !this.link.writes()) return;
      const updates = Dg(this.view.state);
      if (!updates.length) return;
      this.sending = this.link.push(
        Og(this.view.state),
        updates.map((update) => ({ clientID: update.clientID, changes: update.changes.toJSON() }))
      );
    };
    /** Take the changes of all windows from a version on; our own are confirmed by it. */
    receive = ({ version, updates }) => {
      this.sending = false;
      const known = Og(this.view.state) - version;
      const news = updates.slice(Math.max(0, known));
      if (known >= 0 && news.length) {
        this.view.dispatch(
          Tg(
            this.view.state,
            news.map((update) => ({ clientID: update.clientID, changes: ie.fromJSON(update.changes) }))
          )
        );
      }
      this.send();
    };
    /** Start from the server's text. It comes as the change of somebody else, so that undo does not take it back. */
    open = (message) => {
      this.epoch = message.epoch;
      this.sending = false;
      const change = difference(this.view.state.doc.toString(), message.text);
      this.view.dispatch({ effects: this.shared.reconfigure([]) });
      this.view.dispatch({ effects: this.shared.reconfigure(Mg({ startVersion: message.version - 1 })) });
      this.follow(!this.link.writes());
      const changes = ie.of(change, this.view.state.doc.length);
      this.view.dispatch(Tg(this.view.state, [{ clientID: this.epoch, changes }]));
      this.link.edited(message.text);
    };
    /** Write here, or only show what another window writes. */
    follow = (follows) => {
      if (!this.epoch) return;
      this.sending = false;
      this.view.dispatch({ effects: this.frozen.reconfigure(follows ? FROZEN : []) });
      if (!follows) this.send();
    };
    /** Ask something of the text as it is: what is typed first goes first. */
    question = async (what, details = {}) => {
      for (let tries = 0; tries < TRIES; tries++) {
        this.send();
        if (this.settled()) {
          const version = Og(this.view.state);
          const answer = await this.link.ask({ what, ...details });
          if (answer.version === void 0 || this.settled() && version === answer.version && Og(this.view.state) === version)
            return answer;
        }
        await new Promise((resolve) => setTimeout(resolve, BETWEEN2));
      }
      return { error: S.gone };
    };
    /** Put the edits of an answer into the text: one step back undoes them. */
    apply = (answer, label) => {
      const error = answer.error ?? (this.link.writes() ? "" : S.follows);
      if (error) {
        this.link.say(error);
        return false;
      }
      const changes = answer.edits ? answer.edits.map((edit) => ({
        from: this.offset(edit.range[0]),
        to: this.offset(edit.range[1]),
        insert: edit.text
      })) : ie.fromJSON(answer.changes);
      this.view.dispatch({ changes, userEvent: label, scrollIntoView: false });
      this.send();
      return true;
    };
    format = async () => {
      this.apply(await this.question("format"), "input.format");
    };
    rename = async () => {
      const at2 = this.position(this.head());
      const found = await this.question("rename", { at: at2 });
      if (!found.name) return;
      const name = await ask(`${S.renameTo} ${found.name}`, found.name, S.rename);
      if (name && name !== found.name) this.apply(await this.question("rename", { at: at2, name }), "input.rename");
      this.view.focus();
    };
    /** Offer the repairs of a finding; without its name those of all in the line. */
    fixes = async (offsetOfFinding, name = null) => {
      const found = await this.question("fixes", { at: this.position(offsetOfFinding), name });
      if (!found.fixes?.length) {
        this.link.say(S.noFix);
        return;
      }
      const picked = await choose(
        S.fixes,
        found.fixes.map((fix) => fix.title)
      );
      if (picked !== null) this.apply(found.fixes[picked], "input.fix");
      this.view.focus();
    };
    completions = async (context2) => {
      const word = context2.matchBefore(/[\w'-]*$/);
      if (!context2.explicit && !word?.text && !/[ :\\']$/.test(context2.state.doc.lineAt(context2.pos).text)) return null;
      const answer = await this.question("complete", { at: this.position(context2.pos) });
      if (!answer.options?.length || context2.aborted) return null;
      const ranges = answer.options.map((each) => each.range).filter(Boolean);
      const from = ranges.length ? this.offset(ranges[0][0]) : word?.from ?? context2.pos;
      return {
        from,
        options: answer.options.map((each, rank) => ({
          label: each.label,
          detail: each.detail.slice(0, 60),
          apply: each.insert,
          boost: -rank,
          type: { term: "enum", shape: "function", value: "constant", row: "text" }[each.kind] ?? each.kind
        }))
      };
    };
    hovered = async (_view, at2) => {
      const answer = await this.question("hover", { at: this.position(at2) });
      if (!answer.markdown) return null;
      return {
        pos: this.offset(answer.range[0]),
        end: this.offset(answer.range[1]),
        above: true,
        create: () => ({ dom: el("div", { class: "hover" }, ...explained(answer.markdown)) })
      };
    };
    // --- findings ---
    show = (message) => {
      if (message.version !== Og(this.view.state) || !this.settled()) return;
      const doc = this.view.state.doc;
      const marks = [];
      for (const [line, start2, end, colour] of message.colours) {
        const [from, to3] = [this.offset([line, start2]), this.offset([line, end])];
        if (to3 > from) marks.push(L.mark({ class: `colour-${colour}` }).range(from, to3));
      }
      this.findings = message.findings.map((each) => {
        const from = this.offset(each.range[0]);
        const to3 = Math.max(from, this.offset(each.range[1]));
        return { ...each, from, to: to3 > from ? to3 : Math.min(doc.length, from + 1) };
      });
      this.view.dispatch({ effects: setColours.of(L.set(marks, true)) });
      this.view.dispatch(
        jm(
          this.view.state,
          this.findings.map((each) => ({
            from: each.from,
            to: each.to,
            severity: each.severity,
            source: each.name,
            message: each.hint ? `${each.message}
${each.hint}` : each.message
          }))
        )
      );
      this.list.replaceChildren(
        ...this.findings.length ? this.findings.map(this.item) : [el("li", { class: "none", textContent: S.noFindings })]
      );
    };
    item = (each) => {
      const place = this.view.state.doc.lineAt(each.from).number;
      const text = `${place}: ${each.message}${each.hint ? ` (${each.hint})` : ""}`;
      const fix = el("button", {
        textContent: each.fixes.some(Boolean) ? S.fix : S.allow,
        onclick: () => this.fixes(each.from, each.name)
      });
      return el(
        "li",
        {},
        el("span", { class: each.severity, textContent: each.severity }),
        el("button", { class: "go", textContent: text, onclick: () => this.select(each.from, each.to) }),
        ...each.fixes.length ? [fix] : []
      );
    };
    select = (from, to3) => {
      this.view.dispatch({ selection: { anchor: from, head: to3 }, scrollIntoView: true });
      this.view.focus();
    };
    /** Wait until the server has everything that is here; whether it has. */
    sent = async () => {
      for (let tries = 0; tries < TRIES && !this.settled(); tries++) {
        this.send();
        await new Promise((resolve) => setTimeout(resolve, BETWEEN2));
      }
      return this.settled();
    };
    /** Put another text in the place of this one: one step back undoes it. */
    replace = (words2) => {
      if (!this.link.writes()) {
        this.link.say(S.follows);
        return;
      }
      this.view.dispatch({ changes: difference(this.view.state.doc.toString(), words2), userEvent: "input.replace" });
      this.send();
    };
  };

  // desk.js
  var FILES2 = "files";
  function makeDesk(file, page, views) {
    return new Desk(file, page, views).api();
  }
  var Desk = class {
    constructor(file, page, views) {
      this.file = file;
      this.page = page;
      this.views = views;
      this.connection = this.page.connection;
      this.store = new Store();
      this.status = el("span", { id: "status", role: "status" });
      this.save = el("button", { textContent: S.save, title: "Ctrl+S", disabled: true, onclick: () => this.link.save() });
      this.files = el("select", {
        "aria-label": S.file,
        onchange: () => {
          const to3 = this.files.value;
          this.files.value = this.file;
          this.page.turnTo(to3);
        }
      });
      this.saved = null;
      this.apart = false;
      this.dirty = false;
      this.lost = false;
      this.writes = true;
      this.latest = null;
      this.working = /* @__PURE__ */ new Set();
      this.bring = null;
      this.left = [];
      this.link = {
        push: (version, updates) => this.send({ do: "push", version, updates }),
        ask: (question) => this.connection.ask(this.file, question),
        save: () => {
          if (!this.writes) return true;
          const trySave = () => {
            if (!this.text.settled()) setTimeout(trySave, 20);
            else this.send({ do: "save" });
          };
          trySave();
          return true;
        },
        say: (words2) => {
          this.status.textContent = clean(words2);
        },
        edited: (now) => {
          this.mark(this.saved !== null && (this.apart || now !== this.saved));
          this.store.emit("edited");
        },
        saved: () => this.saved,
        writes: () => this.writes
      };
      this.text = textPane(this.link, this.page.nonce);
      this.makeHand();
      this.build();
      this.listen();
    }
    makeHand() {
      this.hand = {
        edit: (shapes) => this.text.edit("shapes", { shapes }),
        change: (what, details) => this.text.edit(what, details),
        // an edit that the server makes
        attempt: (what, details) => this.text.attempt(what, details),
        // the same, of a dialog that says what is wrong
        askFor: ask,
        choose,
        fill,
        numbers: (variable) => this.text.numbers(variable),
        ask: this.link.ask,
        start: this.start,
        setCell: (cell, term) => this.text.edit("cell", { cell, term }),
        setGain: (name, values) => this.text.edit("gain", { name, values }),
        text: () => this.text.state().text,
        goTo: (at2) => this.text.goTo(at2),
        save: () => this.saveNow(),
        saveFile: this.connection.save,
        unsaved: this.page.unsaved,
        askNow: (what, details) => this.text.question(what, details),
        // of the text as it is typed
        settled: () => this.text.sent(),
        replace: (words2) => this.text.replace(words2),
        folder: this.connection.folder,
        file: () => this.file,
        onDrop: (act) => {
          this.bring = act;
        },
        largest: this.page.largest,
        imports: this.page.imports,
        listed: this.page.listed,
        turnTo: this.page.turnTo
      };
    }
    build() {
      askServer(this.store, this.start);
      this.banner = el("div", { class: "banner", role: "alert", hidden: true });
      const chooser = this.page.only ? el("strong", { textContent: this.file }) : this.files;
      const controls = [
        ...this.file ? [chooser, this.save, ...this.page.buttons?.(this.hand) ?? [], this.status] : [this.status],
        el("span", { class: "space" })
      ];
      const { root, turn } = frame(this.store, this.hand, this.file ? this.text.section : null, controls, this.views);
      this.root = root;
      this.turn = turn;
      this.root.querySelector("main").before(this.banner);
    }
    listen() {
      this.TAKEN = {
        opened: (message) => {
          this.saved = message.saved;
          this.writes = message.writes;
          this.back();
          this.text.open(message);
        },
        reopened: (message) => {
          this.saved = message.saved;
          this.writes = message.writes;
          this.back();
          this.text.follow(!this.writes);
          this.text.receive(message);
          this.mark(this.text.state().text !== this.saved);
        },
        updates: (message) => this.text.receive(message),
        findings: (message) => {
          this.text.show(message);
          this.latest = message;
          this.store.emit("text");
        },
        scene: (message) => {
          if (message.version !== this.text.version()) return;
          this.store.findings = this.latest?.version === message.version ? this.latest.findings : [];
          if (message.scene) this.store.show(message.scene);
          if (message.diagram || message.why !== "mistakes") this.store.draw(message.diagram);
          if (!message.scene && !message.diagram) this.store.mistaken(message.why);
          this.store.judge(message.why !== "mistakes");
        },
        writer: (message) => {
          this.writes = message.writes;
          this.text.follow(!this.writes);
          this.mark(this.dirty);
          this.tell("");
          if (!this.writes) this.tellFollowing();
        },
        status: (message) => {
          this.saved = message.saved ?? this.saved;
          this.apart = message.gone || message.conflict;
          this.mark(this.apart || this.text.state().text !== this.saved);
          if (this.writes) this.tellState(message);
          else this.tellFollowing();
        },
        failed: (message) => {
          if (this.text.state().epoch && !this.lost) this.link.say(message.message);
          else this.tell(message.message);
          if (!this.text.state().epoch) this.turn(FILES2);
        }
      };
    }
    api() {
      return {
        root: this.root,
        store: this.store,
        text: this.text,
        show: this.show,
        leave: this.leave,
        open: this.open,
        turn: this.turn,
        file: () => this.file,
        view: () => this.store.view,
        isDirty: () => this.dirty,
        /** Whether nothing is lost with this desk but the steps back: an unsaved text asks before the page is left. */
        isIdle: () => this.text.settled() && !this.dirty && !this.working.size && this.banner.hidden,
        focus: (onChooser) => (onChooser || !this.file ? this.files : this.text.view).focus(),
        take: (message) => this.TAKEN[message.is]?.(message),
        undo: this.text.undo,
        redo: this.text.redo,
        save: this.link.save,
        say: this.link.say,
        tell: this.tell,
        bring: (dropped2) => this.bring(dropped2),
        offer: (names) => {
          const all = names.includes(this.file) ? names : [this.file, ...names];
          this.files.replaceChildren(...all.map((name) => el("option", { value: name, textContent: name })));
          this.files.value = this.file;
        },
        move: (to3) => {
          this.file = to3;
          this.mark(this.dirty);
          if (this.text.state().epoch) this.open();
        },
        lose: () => {
          if (!this.lost) this.tell(this.page.gone?.() ?? S.gone);
          this.lost = true;
        },
        close: () => {
          this.store.emit("closed");
          for (const job of this.working) job.stop();
          this.text.close();
          this.send({ do: "close" });
        }
      };
    }
    send = (message) => this.connection.send({ ...message, file: this.file });
    /** Say above all views what stands between the text and its file, and offer the ways out. */
    tellState = (message) => {
      const settle = (words2, keep) => el("button", { textContent: words2, onclick: () => this.send({ do: "settle", keep }) });
      if (message.unreadable) this.tell(S.unreadable(message.unreadable), settle(S.keepMine, "mine"));
      else if (message.elsewhere) this.tell(S.otherWindow, settle(S.keepThis, "mine"), settle(S.takeOther, "theirs"));
      else if (message.conflict) {
        const both = message.mergeable ? [settle(S.keepBoth, "both")] : [];
        this.tell(S.conflict, ...both, settle(S.keepMine, "mine"), settle(S.takeTheirs, "theirs"));
      } else if (message.gone) this.tell(S.fileGone);
      else if (message.reread) this.tell(S.reread, el("button", { textContent: S.close, onclick: () => this.tell("") }));
      else if (message.saved !== void 0 || !this.rereadShown()) this.tell("");
    };
    /** Whether the banner only says that the file was read again: it stays while one types. */
    rereadShown = () => this.banner.firstChild?.textContent === S.reread;
    tellFollowing = () => {
      const write = () => this.send({ do: "write" });
      this.tell(this.text.settled() ? S.follows : S.behind, el("button", { textContent: S.writeHere, onclick: write }));
    };
    mark = (changed) => {
      this.dirty = changed;
      this.save.disabled = !changed || !this.writes;
      this.text.revertible(changed && this.writes);
      if (!this.lost) this.status.textContent = changed ? S.unsaved : S.saved;
      this.page.marked();
    };
    start = (what, asked_for, hear) => {
      const job = this.connection.start(this.file, what, asked_for, (news) => {
        if (news.end) this.working.delete(job);
        hear(news);
      });
      this.working.add(job);
      return job;
    };
    /** Save, and wait until the server has; whether what is here is saved. */
    saveNow = async () => {
      if (!this.dirty) return true;
      const { error } = await this.text.sent() ? await this.connection.save(this.file) : { error: S.gone };
      if (error) this.link.say(error);
      return !error;
    };
    tell = (words2, ...buttons) => {
      this.banner.replaceChildren(clean(words2), ...buttons);
      this.banner.hidden = !words2;
    };
    /** Tell the server that this file is open, and what has been typed without it. */
    open = () => {
      if (!this.file) {
        this.back();
        return;
      }
      const { epoch, text: now } = this.text.state();
      this.send(
        epoch ? { do: "open", epoch, version: this.text.version(), text: now, saved: this.saved } : { do: "open" }
      );
    };
    back = () => {
      const before = this.lost;
      this.lost = false;
      this.tell("");
      if (!before) return;
      if (this.file) this.link.say(S.back);
      this.store.emit("view");
    };
    /** Put this desk in the place of another one, as it was left. */
    show = (other) => {
      if (other) other.root.replaceWith(this.root);
      else document.body.append(this.root);
      for (const [element, top, across] of this.left) element.scrollTo(across, top);
      this.store.emit("theme");
      this.store.emit("view");
      this.store.emit("shown");
    };
    /** Remember what goes when elements leave the document; call it before another desk is shown. */
    leave = () => {
      const scrolled = [...this.root.querySelectorAll("*")].filter((each) => each.scrollTop || each.scrollLeft);
      this.left = scrolled.map((each) => [each, each.scrollTop, each.scrollLeft]);
      this.store.emit("left");
    };
  };

  // window.js
  var WRITTEN_IN = ".cm-editor, textarea, input[type='text'], input[type='number']";
  var MOST_DESKS = 8;
  var address = (name) => `#${new URLSearchParams({ file: name })}`;
  var fromAddress = () => new URLSearchParams(location.hash.slice(1)).get("file");
  function openWindow(start2, views, around = {}) {
    return new Whole(start2, views, around);
  }
  var Whole = class {
    /**
     * @param {Page.Start} start
     * @param {Page.Around} around
     */
    constructor(start2, views, around) {
      this.views = views;
      this.around = around;
      this.desks = /* @__PURE__ */ new Map();
      this.renamed = /* @__PURE__ */ new Map();
      this.first = start2.first;
      this.names = start2.files;
      this.unsaved = [];
      this.shown = null;
      this.connection = connect({ opened: this.opened, closed: this.closed, take: this.take }, around.line);
      this.page = {
        connection: this.connection,
        nonce: start2.nonce,
        only: start2.only,
        largest: start2.largest,
        imports: start2.imports,
        gone: around.gone,
        buttons: around.buttons,
        unsaved: () => this.unsaved,
        turnTo: this.turnTo,
        listed: this.listed,
        marked: () => {
          if (!this.shown) return;
          document.title = clean(`${this.shown.isDirty() ? "\u25CF " : ""}${this.shown.file()} \u2013 ${S.designer}`);
        }
      };
      this.listen();
      const wanted = fromAddress();
      this.show(this.names.includes(wanted) ? wanted : this.first);
      if (wanted && this.shown.file() !== wanted) history.replaceState(null, "", address(this.shown.file()));
      this.connection.open();
    }
    // --- what comes ---
    opened = () => {
      this.connection.send({ do: "hello" });
      for (const desk of this.desks.values()) desk.open();
    };
    closed = () => {
      for (const desk of this.desks.values()) desk.lose();
    };
    take = (message) => {
      if (message.is === "moved") this.moved(message);
      else if (message.is === "names") this.changedFiles(message);
      else if (message.is === "unsaved") this.changedTexts(message);
      else (this.desks.get(message.file) ?? (message.file ? null : this.shown))?.take(message);
    };
    /** Offer these files. */
    listed = (found) => {
      this.names = found;
      for (const desk of this.desks.values()) desk.offer(this.names);
      this.around.listed?.(found);
    };
    /** Files have come or gone by themselves; a page that has none shows the first that comes. */
    changedFiles({ names: found, first: likeliest }) {
      this.listed(found);
      if (!this.shown.file() && likeliest && !document.querySelector("dialog[open]")) this.turnTo(likeliest);
      else this.shown.store.emit("files");
    }
    /** Other files than before have unsaved changes: one of them has been edited, or saved. */
    changedTexts({ names: changed }) {
      this.unsaved = changed;
      for (const desk of this.desks.values()) desk.store.emit("unsaved");
    }
    // --- which file is shown ---
    /** Show the desk of a file: as it was left, or a new one in the view of the one before. */
    show = (name) => {
      const before = this.shown;
      const onChooser = document.activeElement === before?.root.querySelector("header select");
      before?.leave();
      let desk = this.desks.get(name);
      if (desk)
        this.desks.delete(name);
      else {
        desk = makeDesk(name, this.page, name ? this.views : [FILES]);
        desk.offer(this.names);
        if (isTable(name)) desk.turn(TABLE.name);
        else if (before && ![FILES.name, TABLE.name].includes(before.view())) desk.turn(before.view());
        if (this.connection.isOpen()) desk.open();
        else if (before) desk.lose();
        this.around.begin?.(desk);
      }
      this.desks.set(name, desk);
      this.shown = desk;
      if (before !== desk) desk.show(before);
      if (before && before !== desk) desk.focus(onChooser);
      this.page.marked();
      this.tidy();
    };
    /** Close the desks that have not been shown for longest, where nothing is lost with them. */
    tidy() {
      for (const [name, desk] of this.desks) {
        if (this.desks.size <= MOST_DESKS) return;
        if (desk === this.shown || !desk.isIdle()) continue;
        desk.close();
        this.desks.delete(name);
      }
    }
    /** Turn to another file, as a step that can be taken back. */
    turnTo = (name) => {
      if (this.shown.file() !== name) {
        history.pushState(null, "", address(name));
        this.show(name);
      }
      if (name && this.shown.view() === FILES.name) this.shown.turn(isTable(name) ? TABLE.name : DESIGN.name);
    };
    /** Show the file of the address: after a step back, or when the address was written by hand. */
    turnBack = async () => {
      const begun = this.first || this.names[0] || "";
      const asked = fromAddress() ?? begun;
      let name = asked;
      while (this.renamed.has(name) && !this.names.includes(name)) name = this.renamed.get(name);
      if (!this.names.includes(name)) {
        const found = await this.connection.folder({ what: "list" });
        if ((fromAddress() ?? begun) !== asked) return;
        this.listed((found.files ?? []).map((each) => each.name));
      }
      if (!this.names.includes(name)) {
        name = this.shown.file();
        this.shown.say(S.notThere(asked));
      }
      if (name !== asked) history.replaceState(null, "", address(name));
      if (name !== this.shown.file()) this.show(name);
    };
    /** A file has another name, or none. */
    moved({ file, to: to3 }) {
      const desk = this.desks.get(file);
      this.renamed.set(file, to3);
      this.renamed.delete(to3);
      this.listed(
        this.names.includes(to3) || !to3 ? this.names.filter((name) => name !== file) : this.names.map((name) => name === file ? to3 : name)
      );
      if (!desk) return;
      this.desks.delete(file);
      if (to3) {
        desk.move(to3);
        this.desks.set(to3, desk);
        desk.offer(this.names);
      }
      if (desk !== this.shown) {
        if (!to3) desk.close();
        return;
      }
      const view = desk.view();
      if (!to3) this.show(this.names.includes(this.first) ? this.first : this.names[0] ?? "");
      if (!to3) desk.close();
      if (view === FILES.name) this.shown.turn(view);
      history.replaceState(null, "", address(this.shown.file()));
    }
    // --- the whole window ---
    listen() {
      dropped((files) => this.shown.bring(files));
      window.addEventListener("popstate", this.turnBack);
      window.addEventListener("beforeunload", (event) => {
        if (!this.around.keeps && [...this.desks.values()].some((desk) => desk.isDirty())) event.preventDefault();
      });
      window.addEventListener("keydown", (event) => {
        if (!event.ctrlKey && !event.metaKey) return;
        const key2 = event.key.toLowerCase();
        const { target } = event;
        const { shown } = this;
        const act = { s: shown.save, y: shown.redo, z: event.shiftKey ? shown.redo : shown.undo }[key2];
        if (act && (key2 === "s" || !(target instanceof Element && target.closest(WRITTEN_IN)))) {
          event.preventDefault();
          act();
        }
      });
    }
  };
  function expose(whole) {
    window.designer = {
      get store() {
        return whole.shown.store;
      },
      get text() {
        return whole.shown.text;
      },
      desks: whole.desks,
      connection: whole.connection,
      drop: whole.connection.drop
    };
  }

  // playground/kept.js
  var PREFIX = "fuzzyarm playground: ";
  var BEGUN = "fuzzyarm playground";
  var Passing = class {
    constructor() {
      this.all = /* @__PURE__ */ new Map();
    }
    getItem = (key2) => this.all.get(key2) ?? null;
    setItem = (key2, value) => void this.all.set(key2, value);
    removeItem = (key2) => void this.all.delete(key2);
    keys = () => [...this.all.keys()];
  };
  function store() {
    try {
      localStorage.setItem(PREFIX, "");
      localStorage.removeItem(PREFIX);
      return {
        getItem: (key2) => localStorage.getItem(key2),
        setItem: (key2, value) => localStorage.setItem(key2, value),
        removeItem: (key2) => localStorage.removeItem(key2),
        keys: () => Object.keys(localStorage)
      };
    } catch {
      return new Passing();
    }
  }
  var Kept = class {
    constructor() {
      this.store = store();
      this.lasting = !(this.store instanceof Passing);
    }
    /** Put files there for somebody who has not been here before. */
    begin(texts) {
      if (this.store.getItem(BEGUN) !== null) return;
      for (const [name, text] of Object.entries(texts)) if (this.get(name) === null) this.put(name, text);
      this.store.setItem(BEGUN, "");
    }
    names() {
      return this.store.keys().filter((key2) => key2.startsWith(PREFIX)).map((key2) => key2.slice(PREFIX.length)).sort();
    }
    /** @returns {string | null} */
    get(name) {
      return this.store.getItem(PREFIX + name);
    }
    /** Keep a text; whether there was room for it. */
    put(name, text) {
      try {
        this.store.setItem(PREFIX + name, text);
        return true;
      } catch {
        return false;
      }
    }
    remove(name) {
      this.store.removeItem(PREFIX + name);
    }
    all() {
      return Object.fromEntries(this.names().map((name) => [name, this.get(name)]));
    }
    /** A name that is free, or that has this text already. */
    free(name, text) {
      const at2 = name.lastIndexOf(".");
      for (let k = 1; ; k++) {
        const tried = k === 1 ? name : `${name.slice(0, at2)}-${k}${name.slice(at2)}`;
        const there = this.get(tried);
        if (there === null || there === text) return tried;
      }
    }
  };

  // playground/link.js
  var LARGEST = 6e4;
  var through = async (stream, bytes) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
  var BINARY = 32768;
  function base64(bytes) {
    let text = "";
    for (let k = 0; k < bytes.length; k += BINARY) text += String.fromCharCode(...bytes.subarray(k, k + BINARY));
    return btoa(text).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
  }
  var bytesOf = (text) => Uint8Array.from(atob(text.replace(/-/g, "+").replace(/_/g, "/")), (each) => each.charCodeAt(0));
  async function fragmentOf(file, text) {
    const packed2 = base64(await through(new CompressionStream("deflate"), new TextEncoder().encode(text)));
    const found = new URLSearchParams({ file, text: packed2 }).toString();
    return found.length > LARGEST ? "" : `#${found}`;
  }
  async function carriedBy(fragment) {
    const said2 = new URLSearchParams(fragment.replace(/^#/, ""));
    const packed2 = said2.get("text");
    if (packed2 === null) return null;
    const bytes = await through(new DecompressionStream("deflate"), bytesOf(packed2));
    return { file: said2.get("file") ?? "", text: new TextDecoder("utf-8", { fatal: true }).decode(bytes) };
  }

  // playground/python_line.js
  var P2 = S.playground;
  function canRunPython() {
    if (location.protocol === "file:") return P2.noServer;
    if (typeof WebAssembly !== "object") return P2.noWebAssembly;
    return typeof Worker === "function" ? "" : P2.noWorker;
  }
  function pythonLine(start2, texts, tell) {
    const parts = start2.python;
    return ({ opened: opened2, heard, closed }) => {
      const worker = new Worker("python.js", { type: "module" });
      let isOpen = false;
      const fail = (why) => {
        isOpen = false;
        worker.terminate();
        tell.failed(why);
        closed(false);
      };
      worker.onerror = (event) => fail(event.message || P2.notLoaded);
      worker.onmessage = ({ data }) => {
        if (data.said !== void 0) heard(data.said);
        else if (data.doing) tell.doing(data.doing);
        else if (data.failed) fail(data.failed);
        else if (data.ready) {
          isOpen = true;
          tell.ready();
          opened2();
          performance.mark("ready");
          keepOffline();
        }
      };
      worker.postMessage({ begin: { files: texts(), parts } });
      return { send: (said2) => worker.postMessage({ said: said2 }), isOpen: () => isOpen, drop: () => fail(P2.notLoaded) };
    };
  }
  function keepOffline() {
    navigator.serviceWorker?.register("offline.js").catch(() => null);
  }

  // playground/app.js
  var VIEWS = [{ ...DESIGN, panes: [...DESIGN.panes, diagramPane] }, RUN, TABLE, FILES];
  var LATER = 250;
  var P3 = S.playground;
  var start = JSON.parse(document.getElementById("start").textContent);
  var kept2 = new Kept();
  kept2.begin(start.texts);
  async function arrived() {
    let carried;
    try {
      carried = await carriedBy(location.hash);
    } catch {
      history.replaceState(null, "", location.pathname);
      return P3.damagedLink;
    }
    if (!carried) return "";
    const named2 = /^[^/\\]{1,80}\.(frb|lut)$/i.test(carried.file) ? carried.file : "linked.frb";
    const name = kept2.free(named2, carried.text);
    const isKept = kept2.put(name, carried.text);
    history.replaceState(null, "", `#${new URLSearchParams({ file: name })}`);
    return isKept ? "" : P3.notKept;
  }
  async function share(hand) {
    const fragment = await fragmentOf(hand.file(), hand.text());
    const address2 = `${location.href.replace(/#.*/, "")}${fragment}`;
    const note = fragment ? P3.linkNote : P3.linkTooLong;
    await fill(P3.link, fragment ? [{ name: "address", label: P3.address, value: address2 }] : [], P3.copy, copy, note);
    async function copy() {
      if (!fragment) return {};
      try {
        await navigator.clipboard.writeText(address2);
      } catch {
        return { error: P3.notCopied };
      }
      return {};
    }
  }
  function download(hand) {
    const href = URL.createObjectURL(new Blob([hand.text()], { type: "text/plain" }));
    el("a", { href, download: hand.file() }).click();
    setTimeout(() => URL.revokeObjectURL(href), 1e3);
  }
  function keeping(desk) {
    let later = 0;
    const keep = () => {
      if (!desk.file() || !desk.text.state().epoch) return;
      if (!kept2.put(desk.file(), desk.text.state().text)) desk.say(P3.notKept);
    };
    const soon = () => {
      clearTimeout(later);
      later = setTimeout(keep, LATER);
    };
    desk.store.on("edited", soon);
    desk.store.on("closed", () => clearTimeout(later));
    window.addEventListener("pagehide", keep);
  }
  function open(words2) {
    const desks = /* @__PURE__ */ new Set();
    let state = P3.loading;
    const say = (now) => {
      state = now;
      for (const desk of desks) desk.tell(now);
    };
    const line = pythonLine(start, () => kept2.all(), {
      doing: (what) => say(P3.doing[what] ?? what),
      ready: () => {
        state = "";
      },
      failed: (why) => say(clean(P3.failed(why)))
    });
    const whole = openWindow({ ...start, files: kept2.names(), first: firstOf(kept2.names()) }, VIEWS, {
      line,
      keeps: kept2.lasting,
      gone: () => state,
      buttons: (hand) => [
        el("button", { textContent: P3.link, title: P3.linkHint, onclick: () => share(hand) }),
        el("button", { textContent: P3.download, title: P3.downloadHint, onclick: () => download(hand) })
      ],
      begin: (desk) => {
        desks.add(desk);
        const text = kept2.get(desk.file());
        if (state) {
          const opened2 = { is: "opened", file: desk.file(), text, saved: text, version: 0, epoch: "kept", writes: true };
          if (text !== null) desk.take(opened2);
          desk.lose();
        }
        keeping(desk);
      },
      listed: (names) => {
        for (const name of kept2.names()) if (!names.includes(name)) kept2.remove(name);
      }
    });
    expose(whole);
    if (words2) whole.shown.say(words2);
  }
  function firstOf(names) {
    return names.includes(start.first) ? start.first : names[0] ?? "";
  }
  function standing(words2) {
    const texts = kept2.names().map((name) => [el("h2", { textContent: name }), el("pre", {}, kept2.get(name))]);
    document.body.append(el("main", { class: "standing" }, el("p", { role: "alert" }, words2), ...texts.flat()));
  }
  arrived().then((words2) => {
    const why = canRunPython();
    if (why) standing(why);
    else open(words2);
    if (!kept2.lasting) window.designer?.desks.forEach((desk) => desk.say(P3.notLasting));
  });
})();
