// Learn: an SOC table that grows cell by cell while passes run, its visits, the error of each pass.

import {
  ARROWS,
  clean,
  colourOf,
  el,
  field,
  FONTS,
  pairsOf,
  pane,
  placeWords,
  refill,
  select,
  shortNumber,
  space,
} from "./draw.js";
import { cellAt, cellsPanel, gridOf, outlineOf } from "./geometry/panel.js";
import { stage } from "./pane.js";
import { drawPanel } from "./panel.js";
import { S } from "./strings.js";
import { noTables } from "./table.js";
import { showGrounds, Work } from "./work.js";

/** @type {import("./work.js").Kind} */
const KIND = { name: "learn", title: S.learn, go: S.start, facts: "learnable", form: () => "learn" };

class LearnWork extends Work {
  constructor(store, hand) {
    super(store, hand, KIND);
    this.training = null; // what is learned where, from its beginning
    this.cells = null; // of the tables, as they are drawn
    this.news = null; // its last word
    this.errors = []; // RMS of each pass, for each axis
    this.axis = 0;
    this.cell = null; // [row, column] that is read out
    const speeds = [
      ["watch", S.watch],
      ["fast", S.fast],
    ];
    this.speed = select(speeds, "watch", { onchange: () => this.task.say({ speed: this.speed.value }) });
    this.step = el("button", { textContent: S.onePass, title: S.onePassHint, onclick: () => this.stepped() });
    this.start.after(this.step);
    this.actions.append(field(S.speed, this.speed));
    this.saving("learned.lut", S.saveTable);
    this.makePictures();
    this.show();
  }

  makePictures() {
    const [left, right] = [pane("table", S.table), pane("visits", S.visits)];
    const below = pane("errors", S.errorOfPasses);
    this.which = el("select", {
      onchange: () => {
        this.axis = Number(this.which.value);
        this.cell = null;
        this.show();
      },
    });
    this.whichLabel = el("label", { class: "small", hidden: true }, S.axis, this.which);
    this.readout = el("span", { class: "readout", "aria-live": "polite" });
    this.moment = el("span", { class: "readout" });
    left.bar.append(space(), this.moment, this.whichLabel);
    right.bar.append(space(), this.readout);
    this.values = this.grid(left.body, () => this.valuesPanel());
    this.visits = this.grid(right.body, () => this.visitsPanel());
    this.curve = stage(this.store, below.body, () => this.news && drawPanel(this.curve.canvas, this.news.panel));
    const panes = new DocumentFragment();
    panes.append(this.section, left.section, right.section, below.section);
    this.section = panes;
  }

  /** A table that is read out cell by cell, by the pointer or by keys. */
  grid(body, panel) {
    let plot = null;
    const made = stage(this.store, body, ({ g }) => {
      plot = this.table() ? drawPanel(made.canvas, panel()) : null;
      if (plot) return;
      g.fillStyle = colourOf("--soft");
      g.font = FONTS.words;
      g.fillText(S.noTraining, 12, 24);
    });
    const { canvas } = made;
    canvas.tabIndex = 0;
    canvas.addEventListener("keydown", (event) => this.moved(event));
    canvas.addEventListener("pointermove", (event) => {
      if (plot) this.point(cellAt(this.cells, plot, event.offsetX, event.offsetY));
    });
    canvas.addEventListener("focus", () => this.point(this.cell ?? [0, 0]));
    return made;
  }

  // --- the training ---

  text = () => this.facts?.texts.find((each) => each.name === this.form.shown("controller"));

  fill({ texts, tables }) {
    this.form.choices(
      "controller",
      texts.map((each) => [each.name, each.name || S.thisText]),
    );
    this.form.choices("begin", [["zero", S.asTheText], ...pairsOf(tables)]);
    this.changed("controller");
  }

  changed(name) {
    const plants = this.text()?.plants ?? [];
    if (name === "controller") this.form.choices("plant", pairsOf(plants.map((each) => each.name)));
    if (name !== "controller" && name !== "plant") return;
    showGrounds(
      this.form,
      plants.find((each) => each.name === this.form.shown("plant")),
    );
  }

  ready({ own }) {
    return own ? S.learnsItself : S.learnsNot;
  }

  mode = () => (this.task.isBegun ? (this.news?.mode ?? "run") : "none");

  canStart() {
    return Boolean(this.facts) || this.mode() === "run" || this.mode() === "pause";
  }

  press() {
    if (this.mode() === "run") this.task.say({ go: "pause" });
    else if (this.mode() === "pause") this.task.say({ go: "run" });
    else this.train(false);
  }

  stepped() {
    if (this.mode() === "pause") this.task.say({ go: "step" });
    else this.train(true);
  }

  halt() {
    if (this.task.job) this.task.say({ go: "stop" });
    else this.task.stop();
  }

  train(step) {
    this.training = this.news = this.cell = null;
    this.errors = [];
    this.begin({ step, speed: this.speed.value });
  }

  take(news) {
    if (news.begin) this.opened(news.begin);
    if (!news.mode) return;
    const turned = news.mode !== this.mode();
    this.news = news;
    this.errors.push(...news.errors);
    // A line for each pass is enough to listen to; pictures change oftener.
    if (news.complete || turned) this.say(S.learning(news, this.training));
  }

  opened(training) {
    this.training = training;
    this.cells = gridOf(training.across, training.down);
    this.axis = 0;
    refill(
      this.which,
      training.axes.map((each, i) => [String(i), each]),
      "0",
    );
    this.whichLabel.hidden = training.axes.length < 2;
  }

  show() {
    const now = this.mode();
    this.isOver = now === "none" || now === "stop";
    super.show();
    this.start.textContent = clean(now === "run" ? S.pause : now === "pause" ? S.goOn : S.start);
    this.step.disabled = now === "run" || !this.canStart();
    this.keep.disabled = !this.task.job || !this.news || now === "run";
    this.describe();
    for (const each of [this.values, this.visits, this.curve]) each.redraw();
  }

  // --- pictures ---

  table = () => this.news?.tables[this.axis];

  describe() {
    const table = this.table();
    const name = table && this.training.axes[this.axis];
    this.moment.textContent = clean(table ? S.moment(this.news) : "");
    const labels = /** @type {const} */ ([
      [this.values, table ? S.tableLabel(name, table) : S.noTraining],
      [this.visits, table ? S.visitsLabel(name, Math.max(...table.visits)) : S.noTraining],
      [this.curve, S.errorsLabel(this.errors, this.news)],
    ]);
    for (const [{ canvas }, words] of labels) canvas.setAttribute("aria-label", clean(words));
    this.readOut();
  }

  /** What is learned so far; cells that were never used are hatched. */
  valuesPanel() {
    const { values, visits } = this.table();
    const { low, high, axes } = this.training;
    const ends = low < high ? { low, high } : { low: low - 1, high: high + 1 };
    const bare = visits.map((count) => count === 0);
    return this.panel(values, { words: axes[this.axis], ...ends }, { bare });
  }

  visitsPanel() {
    const { visits } = this.table();
    const value = { words: S.visits, low: 1, high: Math.max(2, ...visits), logarithmic: true, whole: true };
    return this.panel(
      visits.map((count) => count || null),
      value,
      { signed: false },
    );
  }

  panel(values, value, looks = {}) {
    const panel = cellsPanel(this.cells, values, value, { missing: S.neverUsed, downward: true, ...looks });
    return { ...panel, parts: [...panel.parts, ...(this.cell ? [outlineOf(this.cells, this.cell)] : [])] };
  }

  point(cell) {
    this.cell = cell ?? this.cell;
    this.readOut();
  }

  moved(event) {
    if (!ARROWS[event.key] || !this.training) return;
    const [right, up] = ARROWS[event.key];
    const way = [-up, right];
    event.preventDefault();
    const counts = [this.cells.y.length - 1, this.cells.x.length - 1];
    this.point(counts.map((count, k) => Math.min(count - 1, Math.max(0, (this.cell?.[k] ?? 0) + way[k]))));
  }

  readOut() {
    const table = this.table();
    if (table && this.cell) {
      const { across, down } = this.training;
      const [row, column] = this.cell;
      const at = row * across.levels.length + column;
      const place = { ...(down && { [down.name]: down.levels[row] }), [across.name]: across.levels[column] };
      this.readout.textContent = clean(S.cell(placeWords(place), shortNumber(table.values[at]), table.visits[at]));
    } else this.readout.textContent = "";
    this.values.redraw();
    this.visits.redraw();
  }
}

export const LEARN = {
  name: "learn",
  title: S.learn,
  drawn: false,
  further: true,
  why: noTables,
  panes: [LearnWork],
  splits: [
    { key: "learn-columns", vertical: true, at: 1, usual: 0.5 },
    { key: "learn-rows", vertical: false, at: 2, usual: 0.63 },
  ],
};
