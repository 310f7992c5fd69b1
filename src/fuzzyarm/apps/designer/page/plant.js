// The plant of a run: its drawing, and the hand that pushes it.

import { ARROWS, colourOf, el, FONTS, space } from "./draw.js";
import { Pane, stage as canvasStage } from "./pane.js";
import { S } from "./strings.js";

/** The plant as it moves; a hand pulls at it, by mouse or arrow keys. */
export class PicturePane extends Pane {
  constructor(store, push) {
    super(store, null, "run-picture", S.runPicture);
    this.push = push;
    const { bar, body } = this;
    const { canvas, redraw } = canvasStage(store, body, this.draw);
    this.canvas = canvas;
    this.redraw = redraw;
    this.said = el("span", { class: "small" });
    this.keys = new Map(); // arrow keys that are held
    this.colours = new Map();
    this.drawing = null;
    this.open = false;
    this.held = null; // where the pointer is, in the stage
    this.scale = null;
    bar.append(space(), this.said);
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("aria-label", S.runPictureLabel);
    store.on("theme", () => this.colours.clear());

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
    this.canvas.addEventListener("keydown", (event) => {
      const way = ARROWS[event.key];
      if (!way || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      this.keys.set(
        event.key,
        way.map((each) => each * (event.shiftKey ? 1 : 0.4)),
      );
      this.tell();
    });
    this.canvas.addEventListener("keyup", (event) => {
      if (this.keys.delete(event.key)) this.tell();
    });
  }

  begin = (ready) => {
    this.open = true;
    this.drawing = null;
    this.before = "";
    this.section.setAttribute("data-plant", ready.plant);
    this.tell();
    this.redraw();
  };

  close = () => {
    this.open = false;
    this.letGo();
  };

  show = (next) => {
    this.drawing = next;
    if (this.held) this.tell(); // the plant has moved below the hand
    this.redraw();
  };

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
    let [x, y] = [0, 0];
    if (this.held) {
      const [gx, gy] = this.grip();
      const reach = 0.5 * (top - bottom);
      [x, y] = [(this.held[0] - gx) / reach, (this.held[1] - gy) / reach];
    }
    for (const [dx, dy] of this.keys.values()) [x, y] = [x + dx, y + dy];
    const length = Math.hypot(x, y);
    return /** @type {Page.Pair} */ (length > 1 ? [x / length, y / length] : [x, y]);
  };
  tell = () => {
    const now = /** @type {Page.Pair} */ (this.pull().map((each) => Number(each.toFixed(3))));
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
    const at = ([x, y]) => [ox + size * x, oy - size * y];
    g.lineCap = g.lineJoin = "round";
    if (!this.open && !this.drawing) {
      this.words(g, S.runNotYet, width / 2, height / 2);
      return;
    }
    for (const part of this.drawing?.parts ?? []) PARTS[part.is](g, part, at, this.colour);
    if (!this.drawing) this.words(g, S.runNoPicture, width / 2, height / 2 - 24);
    const [x, y] = this.pull();
    if (x || y)
      arrow(g, /** @type {Page.Pair} */ (at(this.grip())), [x, y], 0.5 * size * (top - bottom), this.colour("mark"));
  };

  words = (g, text, x, y) => {
    g.fillStyle = colourOf("--soft");
    g.font = FONTS.words;
    g.textAlign = "center";
    g.fillText(text, x, y);
    g.textAlign = "start";
  };

  place = (event) => {
    const box = this.canvas.getBoundingClientRect();
    return [
      (event.clientX - box.left - this.scale.ox) / this.scale.size,
      (this.scale.oy - (event.clientY - box.top)) / this.scale.size,
    ];
  };
}

const PARTS = {
  line(g, { points, colour, width }, at, tint) {
    path(g, points, at);
    g.strokeStyle = tint(colour);
    g.lineWidth = 1.4 * width;
    g.stroke();
  },
  area(g, { points, colour }, at, tint) {
    path(g, points, at);
    g.closePath();
    g.fillStyle = tint(colour);
    g.fill();
  },
  mark(g, { x, y, sign, size, colour }, at, tint) {
    const [px, py] = at([x, y]);
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
  words(g, { x, y, text, size }, at, tint) {
    g.fillStyle = tint("metal");
    g.font = `${Math.max(11, 1.45 * size)}px system-ui, sans-serif`;
    g.fillText(text, ...at([x, y]));
  },
};

function path(g, points, at) {
  g.beginPath();
  points.forEach((point, i) => (i ? g.lineTo(...at(point)) : g.moveTo(...at(point))));
}

function arrow(g, [x, y], [dx, dy], reach, colour) {
  const [ex, ey] = [x + dx * reach, y - dy * reach];
  const angle = Math.atan2(ey - y, ex - x);
  g.strokeStyle = g.fillStyle = colour;
  g.lineWidth = 3;
  g.beginPath();
  g.moveTo(x, y);
  g.lineTo(ex, ey);
  g.stroke();
  g.beginPath();
  for (const turn of [0, 2.6, -2.6]) g.lineTo(ex + 9 * Math.cos(angle + turn), ey + 9 * Math.sin(angle + turn));
  g.fill();
}
