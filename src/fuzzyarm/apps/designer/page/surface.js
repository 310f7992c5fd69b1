// Surface: an output over two inputs, as a solid that turns or as a contour; over one as a line.
//
// The solid is filled pixel by pixel, 3,600 quadrilaterals of which the far ones come first, and put
// on a plain canvas. That needs neither a library nor a graphics processor, halves the time of a
// frame against as many paths, and prints as it looks.

import {
  ARROWS,
  choice,
  clean,
  colourOf,
  context,
  eachFrame,
  el,
  FONTS,
  SHADES,
  shortNumber,
  slider,
  space,
  tickNumber,
} from "./draw.js";
import { ticks } from "./geometry/chart.js";
import {
  areApart,
  farToNear,
  fillTriangle,
  limitsOf,
  linePanel,
  outward,
  planePanel,
  projectionOf,
} from "./geometry/surface.js";
import { drawPanel, fitted, paintScale } from "./panel.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { rangeOf, shareAlong } from "./geometry/shapes.js";

const packed = (share) =>
  SHADES.map(([r, g, b]) => ((255 << 24) | ((b * share) << 16) | ((g * share) << 8) | (r * share)) >>> 0);
const FILLS = Uint32Array.from(packed(1));
const DARKER = Uint32Array.from(packed(0.87)); // of the mesh
const MESH = 6;

/** Pixels of the scale of colours. */
const scaleHeight = (height) => Math.min(150, height - 70);

export class SurfacePane extends Pane {
  constructor(store, hand) {
    super(store, hand, "surface", S.surface);
    const { body } = this;
    this.canvas = el("canvas", { tabIndex: 0, role: "img" });
    const main = el("div", { class: "main" }, this.canvas);
    this.line = el("canvas", { tabIndex: 0, role: "img" });
    this.cutSlider = slider([0, 1], (value) => this.store.setPoint(this.cutInput(), value));
    this.cutLabel = el("label", { class: "small" }, el("span"), this.cutSlider);
    this.below = el("div", { class: "below", hidden: true }, this.cutLabel, el("div", { class: "line" }, this.line));
    this.others = el("div", { class: "others" });
    this.turned = { azimuth: -0.65, elevation: 0.55 };
    this.flat = false;
    this.cut = ""; // "x" or "y": the axis that the cut is at a value of
    this.image = null; // what the solid is filled into
    this.layer = null;
    this.size = { width: 0, height: 0 };
    this.plot = null; // where the plot of a panel lies
    this.linePlot = null;
    this.handle = null; // of the cut in the solid: where it is, and the ends of its way
    this.sliders = [];
    body.append(main, this.below, this.others);
    let held = false; // whether the hand is on the cut
    this.canvas.addEventListener("pointerdown", (event) => {
      if (!this.store.scene) return;
      this.canvas.setPointerCapture(event.pointerId);
      held =
        Boolean(this.handle) && Math.hypot(event.offsetX - this.handle.at[0], event.offsetY - this.handle.at[1]) < 12;
      if (this.isPlane()) this.aim(event);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!this.store.scene || !event.buttons) return;
      if (this.isPlane()) this.aim(event);
      else if (held && this.handle) this.slide(event);
      else this.turn(0.01 * event.movementX, 0.01 * event.movementY);
    });
    this.canvas.addEventListener("keydown", (event) => {
      const step = ARROWS[event.key];
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
      const step = ARROWS[event.key];
      if (!step) return;
      event.preventDefault();
      this.nudge(this.otherInput(), step[0] + step[1]);
    });

    this.redraw = eachFrame(this.draw);
    this.store.on("scene", this.build);
    this.store.on("axes", this.build);
    this.on(["reshaped", "point", "theme", "told"], this.redraw);
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

  isPlane = () => this.flat || this.store.axes.x === this.store.axes.y;

  build = () => {
    const { inputs, outputs, missing } = this.store.scene;
    if (missing.length) {
      this.setTools(space());
      this.below.hidden = true;
      this.others.replaceChildren();
      this.redraw();
      return;
    }
    const { x, y, output } = this.store.axes;
    const named = (variables) => variables.map((each, i) => [String(i), each.name]);
    const tools = [];
    if (inputs.length > 2) {
      tools.push(
        choice(S.horizontal, named(inputs), String(x), (i) => this.pick({ x: Number(i) })),
        choice(S.vertical, named(inputs), String(y), (i) => this.pick({ y: Number(i) })),
      );
    }
    if (outputs.length > 1)
      tools.push(choice(S.shown, named(outputs), String(output), (i) => this.pick({ output: Number(i) })));
    if (inputs.length > 1) tools.push(...this.views(inputs[x], inputs[y]));
    else this.cut = "";
    this.setTools(space(), ...tools);
    this.prepare();
  };

  views = (x, y) => {
    const views = [
      ["solid", S.solid],
      ["contour", S.contour],
    ];
    const cuts = [
      ["", S.none],
      ["x", x.name],
      ["y", y.name],
    ];
    const turn = (view) => {
      this.flat = view === "contour";
      this.redraw();
    };
    const cut = (axis) => {
      this.cut = axis;
      this.prepare();
    };
    return [choice(S.view, views, this.flat ? "contour" : "solid", turn), choice(S.cut, cuts, this.cut, cut)];
  };

  /** Set up the line below for the cut, and the sliders beside for the inputs that are no axes. */
  prepare = () => {
    const { inputs } = this.store.scene;
    this.below.hidden = !this.cut;
    if (this.cut) {
      const [low, high] = rangeOf(inputs[this.cutInput()]);
      Object.assign(this.cutSlider, { min: low, max: high, step: (high - low) / 400 });
    }
    this.sliders = inputs
      .map((variable, i) => /** @type {const} */ ([variable, i]))
      .filter(([, i]) => i !== this.store.axes.x && i !== this.store.axes.y)
      .map(([variable, i]) => {
        const range = slider(rangeOf(variable), (value) => this.store.setPoint(i, value));
        const said = el("output", {});
        return {
          i,
          range,
          said,
          label: el("label", { class: "small" }, el("span", { textContent: variable.name }), range, said),
        };
      });
    this.others.replaceChildren(...this.sliders.map(({ label }) => label));
    this.redraw();
  };

  pick = (axes) => {
    const { x, y } = this.store.axes;
    // Two inputs cannot be one: they change places.
    if (axes.x === y) axes.y = x;
    else if (axes.y === x) axes.x = y;
    this.store.setAxes(axes);
  };

  draw = () => {
    const { scene, axes } = this.store;
    if (!scene || !this.size.width) return;
    if (scene.missing.length) {
      this.nothing(
        S.notYet(
          Object.keys(S.missing)
            .filter((name) => scene.missing.includes(name))
            .map((name) => S.missing[name]),
        ),
      );
      return;
    }
    const [x, y] = [scene.inputs[axes.x], scene.inputs[axes.y]];
    const output = scene.outputs[axes.output];
    for (const { i, range, said } of this.sliders) {
      range.value = this.store.point[i];
      said.textContent = shortNumber(this.store.point[i]);
    }
    const { g, width, height } = context(this.canvas, this.size.width, this.size.height);
    this.handle = null;
    const found = this.store.surface();
    const label = S.surfaceLabel(output.name, x.name, x === y ? "" : y.name);
    const source = found?.isFar ? S.byServer : found && this.store.coarse ? S.coarse : "";
    this.canvas.setAttribute("aria-label", `${label} ${source}`.trim());
    if (!found) {
      this.nothing(this.store.refused || (this.hand.start ? S.asking(scene.reason) : S.notHere(scene.reason)));
      return;
    }
    const [low, high] = limitsOf(found.z, output);
    const section = this.cut ? this.store.section(this.otherInput()) : null;
    const picture = { g, width, height, found, low, high, x, y, output, section };
    if (this.isPlane()) this.drawPlane(picture);
    else {
      this.drawSolid(picture);
      this.drawScale(picture);
    }
    if (source) {
      g.fillStyle = colourOf("--soft");
      g.font = FONTS.small;
      g.textAlign = "left";
      g.fillText(source, 8, height - 6);
    }
    if (this.cut) this.drawSection(picture);
  };

  /** Say why nothing is drawn. */
  nothing = (words) => {
    const { g, width } = context(this.canvas, this.size.width, this.size.height);
    g.fillStyle = colourOf("--soft");
    g.font = FONTS.words;
    this.wrapped(g, clean(words), 12, 24, width - 24);
    this.canvas.setAttribute("aria-label", clean(words));
  };

  /** What the colours stand for. */
  drawScale = ({ g, width, height, low, high }) => {
    const tall = scaleHeight(height);
    if (tall >= 40) paintScale(g, [width - 19, 26, 9, tall], { low, high }, { apart: 34 });
  };

  // --- the solid ---

  drawSolid = ({ g, width, height, found, low, high, x, y, output }) => {
    const { z } = found;
    const n = found.xs.length;
    const { project, reach, farIsHigh } = projectionOf(this.turned, width, height);
    const px = new Float64Array(n * n);
    const py = new Float64Array(n * n);
    const share = new Float64Array(n * n);
    for (let j = 0, k = 0; j < n; j++) {
      for (let i = 0; i < n; i++, k++) {
        share[k] = (z[k] - low) / (high - low);
        const at = project(i / (n - 1) - 0.5, j / (n - 1) - 0.5, share[k] - 0.5);
        px[k] = at[0];
        py[k] = at[1];
      }
    }
    this.frame(g, project);
    const is = farToNear(n - 1, farIsHigh.u);
    const js = farToNear(n - 1, farIsHigh.v);
    const ratio = 2; // pixels of the image for one of the page: their mean smooths the edges
    const [wide, tall] = [Math.round(ratio * width), Math.round(ratio * height)];
    if (this.image?.width !== wide || this.image?.height !== tall) {
      this.image = new ImageData(wide, tall);
      this.layer = new OffscreenCanvas(wide, tall);
    }
    const pixels = new Uint32Array(this.image.data.buffer);
    pixels.fill(0);
    for (let k = 0; k < n * n; k++) {
      px[k] *= ratio;
      py[k] *= ratio;
    }
    for (const j of js) {
      for (const i of is) {
        const [a, b] = [j * n + i, (j + 1) * n + i];
        const middle = 0.25 * (share[a] + share[a + 1] + share[b] + share[b + 1]);
        if (!(middle === middle)) continue; // no value at a corner
        const fills = i % MESH && j % MESH ? FILLS : DARKER;
        const colour = fills[Math.max(0, Math.min(255, Math.round(255 * middle)))];
        const [c, d] = [a + 1, b + 1];
        fillTriangle(pixels, wide, tall, px[a], py[a], px[c], py[c], px[d], py[d], colour);
        fillTriangle(pixels, wide, tall, px[a], py[a], px[b], py[b], px[d], py[d], colour);
      }
    }
    this.layer.getContext("2d").putImageData(this.image, 0, 0);
    g.drawImage(this.layer, 0, 0, width, height);
    this.labels(g, project, { x, y, width, height, low, high, output, wanted: reach < 130 ? 2 : 4 });
    const value = this.store.value();
    if (this.cut) this.drawCut(g, project, low, high);
    if (Number.isFinite(value)) {
      const [u, v] = [x, y].map((each, k) =>
        shareAlong(each, this.store.point[k ? this.store.axes.y : this.store.axes.x]),
      );
      this.dot(g, ...project(u - 0.5, v - 0.5, (value - low) / (high - low) - 0.5));
    }
  };

  /** The plane of the cut, where it meets the surface, and the handle that moves it. */
  drawCut = (g, project, low, high) => {
    const [one, other] = [this.cutInput(), this.otherInput()].map((i) => this.store.scene.inputs[i]);
    const at = shareAlong(one, this.store.point[this.cutInput()]) - 0.5;
    const corner = (along, w) => (this.cut === "x" ? project(at, along, w) : project(along, at, w));
    g.fillStyle = g.strokeStyle = colourOf("--lit");
    g.globalAlpha = 0.12;
    g.beginPath();
    [
      [-0.5, -0.5],
      [0.5, -0.5],
      [0.5, 0.5],
      [-0.5, 0.5],
    ].forEach(([along, w], i) => (i ? g.lineTo(...corner(along, w)) : g.moveTo(...corner(along, w))));
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
      const spot = corner(shareAlong(other, section.xs[i]) - 0.5, (value - low) / (high - low) - 0.5);
      if (Number.isFinite(value)) down ? g.lineTo(...spot) : g.moveTo(...spot);
      down = Number.isFinite(value);
    });
    g.stroke();
    const way = (share) =>
      this.cut === "x" ? project(share, this.front("y"), -0.5) : project(this.front("x"), share, -0.5);
    this.handle = { at: way(at), from: way(-0.5), to: way(0.5) };
    g.fillStyle = colourOf("--pane");
    g.beginPath();
    g.arc(...this.handle.at, 6, 0, 2 * Math.PI);
    g.fill();
    g.stroke();
  };

  /** The outline of the base. */
  frame = (g, project) => {
    g.strokeStyle = colourOf("--line");
    g.lineWidth = 1;
    g.beginPath();
    for (const [u, v] of [
      [-0.5, -0.5],
      [0.5, -0.5],
      [0.5, 0.5],
      [-0.5, 0.5],
    ])
      g.lineTo(...project(u, v, -0.5));
    g.closePath();
    g.stroke();
  };

  /** Names and numbers outside the base; a number that would stand on another one is left out. */
  labels = (g, project, { x, y, width, height, low, high, output, wanted }) => {
    const near = Math.cos(this.turned.azimuth) > 0 ? -0.5 : 0.5;
    const side = Math.sin(this.turned.azimuth) > 0 ? -0.5 : 0.5;
    const taken = [
      [0, 0, width, 22],
      [width - 62, 0, width, scaleHeight(height) + 34],
    ];
    const write = (words, place, direction, isSure) => {
      const { left, base, box } = outward(place, direction, g.measureText(words).width, { width, height });
      if (!isSure && !taken.every((other) => areApart(box, other))) return;
      taken.push(box);
      g.fillText(words, left, base);
    };
    const axes = [
      { variable: x, at: (t, out) => project(t, near * out, -0.5) },
      { variable: y, at: (t, out) => project(side * out, t, -0.5) },
    ].map(({ variable, at }) => {
      const [[x0, y0], [x1, y1]] = [at(0, 1), at(0, 1.1)];
      const [a, b] = rangeOf(variable);
      const values = ticks(a, b, wanted);
      return { variable, at, a, b, values, direction: [x1 - x0, y1 - y0] };
    });
    g.fillStyle = colourOf("--soft");
    g.textAlign = "left";
    for (const { variable, at, values, direction } of axes) {
      g.font = FONTS.small;
      const widest = Math.max(...values.map((value) => g.measureText(tickNumber(value)).width));
      const [dx, dy] = direction.map((each) => each / (Math.hypot(...direction) || 1));
      const beyond = 10 + widest * Math.abs(dx) + 12 * Math.abs(dy);
      const [px, py] = at(0, 1.06);
      const [nx, ny] = [px + beyond * dx, py + beyond * dy];
      const room = Math.abs(dx) > 0.5 ? Math.max(64, dx < 0 ? nx : width - nx) : width;
      g.font = FONTS.bold;
      write(fitted(g, variable.name, Math.min(0.34 * width, 0.75 * room)), [nx, ny], direction, true);
    }
    g.font = FONTS.small;
    for (const { at, a, b, values, direction } of axes)
      for (const value of values) write(tickNumber(value), at((value - a) / (b - a) - 0.5, 1.06), direction, false);
    const range = `: ${shortNumber(low)} … ${shortNumber(high)}`;
    g.fillText(fitted(g, output.name, 0.7 * (width - 16 - g.measureText(range).width)) + range, 8, 15);
  };

  dot = (g, x, y) => {
    g.fillStyle = colourOf("--lit");
    g.strokeStyle = "#ffffff";
    g.lineWidth = 1.5;
    g.beginPath();
    g.arc(x, y, 4.5, 0, 2 * Math.PI);
    g.fill();
    g.stroke();
  };

  // --- seen from above, over one input, or the section of the cut ---

  drawPlane = ({ found, low, high, x, y, output }) => {
    const { axes } = this.store;
    const whole = this.whole(output, low, high);
    const [across, up] = [this.along(axes.x), this.along(axes.y)];
    if (x === y) this.plot = drawPanel(this.canvas, linePanel(found, across, whole));
    else {
      const inputs = [
        { ...across, isCut: this.cut === "x" },
        { ...up, isCut: this.cut === "y" },
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
    const [at, other] = [this.cutInput(), this.otherInput()].map(this.along);
    this.cutSlider.value = at.at;
    const said = S.cutAt(at.name, shortNumber(at.at));
    this.cutLabel.firstChild.textContent = clean(said);
    this.line.setAttribute("aria-label", S.sectionLabel(output.name, other.name, said));
    if (!found) return;
    const whole = this.whole(output, low, high);
    this.linePlot = drawPanel(this.line, linePanel(found, other, whole));
  };

  wrapped = (g, text, x, y, width) => {
    let line = "";
    for (const word of text.split(" ")) {
      if (line && g.measureText(`${line} ${word}`).width > width) {
        g.fillText(line, x, y);
        [line, y] = [word, y + 18];
      } else line = line ? `${line} ${word}` : word;
    }
    g.fillText(line, x, y);
  };

  // --- hands ---

  aim = (event) => {
    if (!this.plot) return;
    const { x, y } = this.store.axes;
    this.store.setPoint(x, this.plot.xAt(event.offsetX));
    if (x !== y) this.store.setPoint(y, this.plot.yAt(event.offsetY));
  };

  nudge = (input, steps) => {
    const [low, high] = rangeOf(this.store.scene.inputs[input]);
    this.store.setPoint(input, this.store.point[input] + steps * 0.01 * (high - low));
  };

  /** Move the cut to where the pointer is along the edge that its handle runs on. */
  slide = (event) => {
    const { from, to } = this.handle;
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    const share = ((event.offsetX - from[0]) * dx + (event.offsetY - from[1]) * dy) / (dx * dx + dy * dy);
    const [low, high] = rangeOf(this.store.scene.inputs[this.cutInput()]);
    this.store.setPoint(this.cutInput(), low + share * (high - low));
  };

  aimLine = (event) => {
    if (this.linePlot) this.store.setPoint(this.otherInput(), this.linePlot.xAt(event.offsetX));
  };

  turn = (azimuth, elevation) => {
    this.turned.azimuth -= azimuth;
    this.turned.elevation = Math.min(1.5, Math.max(0.05, this.turned.elevation + elevation));
    this.redraw();
  };
}
