// The plant of a run: its drawing, and the hand that pushes it.

import { stage as canvasStage } from "./charts.js";
import { el, pane, colourOf } from "./draw.js";
import { S } from "./strings.js";

/**
 * The plant as it moves; a hand pulls at it, by mouse or arrow keys.
 *
 * @param {Page.Store} store
 */
export function picturePane(store, push) {
  const { section, bar, body } = pane("run-picture", S.runPicture);
  const { canvas, redraw } = canvasStage(store, body, draw);
  const said = el("span", { class: "small" });
  const keys = new Map(); // arrow keys that are held
  const colours = new Map();
  let drawing = null;
  let open = false;
  let held = null; // where the pointer is, in the stage
  let scale = null;
  bar.append(el("span", { class: "space" }), said);
  canvas.tabIndex = 0;
  canvas.setAttribute("aria-label", S.runPictureLabel);
  store.on("theme", () => colours.clear());

  /** Colours by what they stand for; a plant that draws itself brings its own. */
  function colour(name) {
    if (!colours.has(name)) colours.set(name, name.startsWith("#") ? name : colourOf(`--run-${name}`));
    return colours.get(name);
  }

  function stage() {
    return drawing?.stage ?? [-1, 1, -1, 1];
  }

  function grip() {
    return drawing?.grip ?? [0, 0];
  }

  /** The pull of the hand: right and up, 1 is half of the height of the stage. */
  function pull() {
    const [, , bottom, top] = stage();
    let [x, y] = [0, 0];
    if (held) {
      const [gx, gy] = grip();
      const reach = 0.5 * (top - bottom);
      [x, y] = [(held[0] - gx) / reach, (held[1] - gy) / reach];
    }
    for (const [dx, dy] of keys.values()) [x, y] = [x + dx, y + dy];
    const length = Math.hypot(x, y);
    return /** @type {Page.Pair} */ (length > 1 ? [x / length, y / length] : [x, y]);
  }

  let before = "";
  function tell() {
    const now = /** @type {Page.Pair} */ (pull().map((each) => Number(each.toFixed(3))));
    if (JSON.stringify(now) === before) return;
    before = JSON.stringify(now);
    if (open) push(now.some(Boolean) ? now : null);
    said.textContent = now.some(Boolean) ? S.runPulled(now) : "";
    redraw();
  }

  function draw({ g, width, height }) {
    const [left, right, bottom, top] = stage();
    const size = Math.min(width / (right - left), height / (top - bottom));
    const [ox, oy] = [0.5 * (width - size * (left + right)), 0.5 * (height + size * (bottom + top))];
    scale = { size, ox, oy };
    const at = ([x, y]) => [ox + size * x, oy - size * y];
    g.lineCap = g.lineJoin = "round";
    if (!open && !drawing) {
      words(g, S.runNotYet, width / 2, height / 2);
      return;
    }
    for (const part of drawing?.parts ?? []) PARTS[part.is](g, part, at, colour);
    if (!drawing) words(g, S.runNoPicture, width / 2, height / 2 - 24);
    const [x, y] = pull();
    if (x || y) arrow(g, /** @type {Page.Pair} */ (at(grip())), [x, y], 0.5 * size * (top - bottom), colour("mark"));
  }

  function words(g, text, x, y) {
    g.fillStyle = colourOf("--soft");
    g.font = "13px system-ui, sans-serif";
    g.textAlign = "center";
    g.fillText(text, x, y);
    g.textAlign = "start";
  }

  function place(event) {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left - scale.ox) / scale.size, (scale.oy - (event.clientY - box.top)) / scale.size];
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (!open || !scale) return;
    canvas.setPointerCapture(event.pointerId);
    held = place(event);
    tell();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    held = place(event);
    tell();
  });
  const letGo = () => {
    held = null;
    keys.clear();
    tell();
  };
  for (const name of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) canvas.addEventListener(name, letGo);
  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  canvas.addEventListener("keydown", (event) => {
    const way = ARROWS[event.key];
    if (!way || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys.set(
      event.key,
      way.map((each) => each * (event.shiftKey ? 1 : 0.4)),
    );
    tell();
  });
  canvas.addEventListener("keyup", (event) => {
    if (keys.delete(event.key)) tell();
  });

  return {
    section,
    canvas,
    open(ready) {
      open = true;
      drawing = null;
      before = "";
      section.setAttribute("data-plant", ready.plant);
      tell();
      redraw();
    },
    close() {
      open = false;
      letGo();
    },
    show(next) {
      drawing = next;
      if (held) tell(); // the plant has moved below the hand
      redraw();
    },
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
