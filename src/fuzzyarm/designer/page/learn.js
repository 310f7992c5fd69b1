// Learn: an SOC table that grows cell by cell while passes run, its visits, the error of each pass.

import { clean, el, pane, heat, shortNumber, SHADES } from "./draw.js";
import { field, inks, stage } from "./charts.js";
import { confirm } from "./dialogs.js";
import { Form, refill } from "./form.js";
import { drawPanel } from "./panel.js";
import { S } from "./strings.js";
import { showGrounds } from "./work.js";

const ROOM = { left: 46, right: 10, top: 8, bottom: 34 };

export const LEARN = {
  name: "learn",
  title: S.learn,
  drawn: false,
  panes: [learnPanes],
  splits: [
    { key: "learn-columns", vertical: true, at: 1, usual: 0.5 },
    { key: "learn-rows", vertical: false, at: 2, usual: 0.63 },
  ],
};

/**
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function learnPanes(store, hand) {
  return new LearnPanes(store, hand).panes;
}

class LearnPanes {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand} hand
   */
  constructor(store, hand) {
    this.store = store;
    this.hand = hand;

    this.facts = null; // what may be trained where
    this.job = null; // the training; one that is stopped is kept, to be saved
    this.begin = null; // of the training: axes, levels
    this.news = null; // its last word
    this.errors = []; // RMS of each pass, for each axis
    this.axis = 0;
    this.cell = null; // [row, column] that is read out
    this.stale = true; // whether the facts are those of an older text

    // --- what may be asked ---

    this.top = pane("learning", S.learn);
    this.form = new Form({
      changed: (name) => {
        if (name === "controller") this.choosePlants();
        if (name === "plant") this.chooseGrounds();
      },
      judge: (values) => this.hand.askNow("judge", { form: "learn", values }),
    });
    this.makeActions();
    this.makePictures();
    this.listen();
  }

  makeActions() {
    this.speed = el("select", { onchange: () => this.job?.say({ speed: this.speed.value }) });
    refill(this.speed, [
      ["watch", S.watch],
      ["fast", S.fast],
    ]);
    this.go = el("button", { class: "main", textContent: S.start, onclick: () => this.pressed() });
    this.step = el("button", { textContent: S.onePass, title: S.onePassHint, onclick: () => this.stepped() });
    this.stop = el("button", { textContent: S.stop, disabled: true, onclick: () => this.job?.say({ go: "stop" }) });
    const name = el("input", { type: "text", value: "learned.lut", size: 14, "aria-label": S.tableName });
    this.save = el("button", {
      textContent: S.saveTable,
      disabled: true,
      onclick: () => this.job?.say({ save: name.value }),
    });
    this.said = el("p", { class: "said", role: "status" });
    const actions = el(
      "div",
      { class: "actions" },
      this.go,
      this.step,
      this.stop,
      field(S.speed, this.speed),
      el("span", { class: "space" }),
      name,
      this.save,
    );
    this.top.body.append(this.form.view, actions, this.said);
  }

  makePictures() {
    // --- pictures ---

    this.left = pane("table", S.table);
    this.right = pane("visits", S.visits);
    this.below = pane("errors", S.errorOfPasses);
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
    this.left.bar.append(el("span", { class: "space" }), this.moment, this.whichLabel);
    this.right.bar.append(el("span", { class: "space" }), this.readout);
    this.values = stage(this.store, this.left.body, (paper) => this.cells(paper, this.paintValue));
    this.visits = stage(this.store, this.right.body, (paper) => this.cells(paper, this.paintVisits));
    this.curve = stage(this.store, this.below.body, () => this.news && drawPanel(this.curve.canvas, this.news.panel));
    for (const { canvas } of [this.values, this.visits]) {
      canvas.tabIndex = 0;
      canvas.addEventListener("keydown", this.moved);
      canvas.addEventListener("pointermove", this.pointed);
      canvas.addEventListener("focus", () => {
        this.cell ??= [0, 0];
        this.readOut();
      });
    }

    this.STEPS = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] };
  }

  listen() {
    this.store.on("view", this.ask);
    this.store.on("text", () => {
      this.stale = true;
      this.ask();
    });
    this.show();
    this.panes = new DocumentFragment();
    this.panes.append(this.top.section, this.left.section, this.right.section, this.below.section);
  }

  // --- the training ---

  mode = () => (this.job ? (this.news?.mode ?? "run") : "none");

  shape = () => [this.begin.down?.levels.length ?? 1, this.begin.across.levels.length];

  text = () => this.facts?.texts.find((each) => each.name === this.form.shown("controller"));

  choosePlants = () => {
    this.form.choices(
      "plant",
      (this.text()?.plants ?? []).map((each) => [each.name, each.name]),
    );
    this.chooseGrounds();
  };

  chooseGrounds = () => {
    showGrounds(
      this.form,
      this.text()?.plants.find((each) => each.name === this.form.shown("plant")),
    );
  };

  ask = () => {
    if (this.store.view !== LEARN.name || !this.stale) return;
    this.stale = false;
    this.hand.start("learnable", {}, (message) => {
      if (message.end === "failed") this.said.textContent = clean(message.field ? "" : message.message);
      if (message.end) return;
      this.facts = message;
      this.form.open(this.facts.form);
      this.form.choices(
        "controller",
        this.facts.texts.map((each) => [each.name, each.name || S.thisText]),
      );
      this.form.choices("begin", [["zero", S.asTheText], ...this.facts.tables.map((each) => [each, each])]);
      this.choosePlants();
      if (!this.job) this.said.textContent = clean(this.facts.own ? S.learnsItself : S.learnsNot);
    });
  };

  pressed = () => {
    if (this.mode() === "run") this.job.say({ go: "pause" });
    else if (this.mode() === "pause") this.job.say({ go: "run" });
    else this.train(false);
  };

  stepped = () => {
    if (this.mode() === "pause") this.job.say({ go: "step" });
    else this.train(true);
  };

  train = (oneByOne) => {
    this.job?.stop();
    this.begin = this.news = this.cell = null;
    this.errors = [];
    this.said.textContent = S.preparing;
    this.form.mark("");
    const mine = (this.job = this.hand.start(
      "learn",
      { form: this.form.values(), step: oneByOne, speed: this.speed.value },
      (message) => {
        if (this.job === mine) this.hear(message); // an older one may still speak
      },
    ));
    this.show();
  };

  hear = (message) => {
    if (message.end) {
      this.job = null;
      if (message.end === "failed") this.said.textContent = clean(message.field ? "" : message.message);
    } else if (message.begin) {
      this.begin = message.begin;
      this.axis = 0;
      refill(
        this.which,
        this.begin.axes.map((each, i) => [String(i), each]),
      );
      this.whichLabel.hidden = this.begin.axes.length < 2;
      this.which.value = "0";
    } else if (message.saved) this.said.textContent = clean(S.tableSaved(message.saved));
    else if (message.unsaved) this.said.textContent = clean(message.unsaved);
    else if (message.exists) this.replace(message.exists);
    else if (message.mode) this.take(message);
    this.show();
    if (message.end === "failed") this.form.mark(message.field ?? "", message.message);
  };

  replace = async (existing) => {
    const sure = await confirm(S.replaceFile(existing), S.replace);
    if (sure) this.job?.say({ save: existing, replace: true });
    this.save.focus();
  };

  take = (message) => {
    const turned = message.mode !== this.mode();
    this.news = message;
    this.errors.push(...message.errors);
    // A line for each pass is enough to listen to; pictures change oftener.
    if (message.complete || turned) this.said.textContent = clean(S.learning(message, this.begin));
  };

  show = () => {
    const now = this.mode();
    this.go.textContent = clean(now === "run" ? S.pause : now === "pause" ? S.goOn : S.start);
    this.stop.disabled = now !== "run" && now !== "pause";
    this.step.disabled = now === "run";
    this.save.disabled = !this.job || !this.news || now === "run";
    this.form.lock(now === "run" || now === "pause");
    this.describe();
    for (const each of [this.values, this.visits, this.curve]) each.redraw();
  };

  describe = () => {
    const table = this.news?.tables[this.axis];
    this.moment.textContent = clean(this.news ? S.moment(this.news) : "");
    const label = table
      ? S.tableLabel(this.begin.axes[this.axis], table, this.shape()[0] * this.shape()[1])
      : S.noTraining;
    this.values.canvas.setAttribute("aria-label", clean(label));
    this.visits.canvas.setAttribute(
      "aria-label",
      clean(table ? S.visitsLabel(this.begin.axes[this.axis], Math.max(...table.visits)) : S.noTraining),
    );
    this.curve.canvas.setAttribute("aria-label", clean(S.errorsLabel(this.errors, this.begin, this.news)));
    this.readOut();
  };

  readOut = () => {
    const table = this.news?.tables[this.axis];
    if (!table || !this.cell) {
      this.readout.textContent = "";
      return;
    }
    const at = this.cell[0] * this.shape()[1] + this.cell[1];
    const down = this.begin.down
      ? `${this.begin.down.name} = ${shortNumber(this.begin.down.levels[this.cell[0]])}, `
      : "";
    const place = `${down}${this.begin.across.name} = ${shortNumber(this.begin.across.levels[this.cell[1]])}`;
    this.readout.textContent = clean(S.cell(place, shortNumber(table.values[at]), table.visits[at]));
    this.values.redraw();
    this.visits.redraw();
  };

  moved = (event) => {
    const way = this.STEPS[event.key];
    if (!way || !this.begin) return;
    event.preventDefault();
    const [rows, columns] = this.shape();
    this.cell = [
      Math.min(rows - 1, Math.max(0, (this.cell?.[0] ?? 0) + way[0])),
      Math.min(columns - 1, Math.max(0, (this.cell?.[1] ?? 0) + way[1])),
    ];
    this.readOut();
  };

  pointed = (event) => {
    if (!this.begin) return;
    const box = event.currentTarget.getBoundingClientRect();
    const { x0, y0, w, h } = this.grid(box.width, box.height);
    const [rows, columns] = this.shape();
    const found = [Math.floor((event.clientY - box.top - y0) / h), Math.floor((event.clientX - box.left - x0) / w)];
    if (found[0] < 0 || found[1] < 0 || found[0] >= rows || found[1] >= columns) return;
    if (this.cell && found[0] === this.cell[0] && found[1] === this.cell[1]) return;
    this.cell = found;
    this.readOut();
  };

  grid = (width, height) => {
    const [rows, columns] = this.shape();
    return {
      x0: ROOM.left,
      y0: ROOM.top,
      w: (width - ROOM.left - ROOM.right) / columns,
      h: (height - ROOM.top - ROOM.bottom) / rows,
    };
  };

  /** Draw a cell for each pair of levels; those that were never visited are hatched. */
  cells = ({ g, width, height }, paint) => {
    const colours = inks();
    g.font = "11px system-ui, sans-serif";
    if (!this.begin || !this.news) {
      g.fillStyle = colours.soft;
      g.fillText(S.noTraining, 12, 22);
      return;
    }
    const [rows, columns] = this.shape();
    const { x0, y0, w, h } = this.grid(width, height);
    const table = this.news.tables[this.axis];
    const most = Math.max(1, ...table.visits);
    for (let i = 0; i < rows; i++) {
      for (let j = 0; j < columns; j++) {
        const at = i * columns + j;
        const box = { x: x0 + j * w, y: y0 + i * h, w: w - 1, h: h - 1 };
        const never = table.visits[at] === 0;
        if (never) this.hatch(g, box, colours);
        const [fill, ink, text] = paint(table.values[at], table.visits[at], most, never, colours);
        if (fill) {
          g.fillStyle = fill;
          g.fillRect(box.x, box.y, box.w, box.h);
        }
        if (h > 11) {
          g.fillStyle = ink;
          g.textAlign = "center";
          g.textBaseline = "middle";
          const fits = text.find((each) => g.measureText(each).width <= w - 2);
          if (fits) g.fillText(fits, box.x + w / 2, box.y + h / 2);
        }
      }
    }
    if (this.cell) {
      g.strokeStyle = colours.lines[1];
      g.lineWidth = 2;
      g.strokeRect(x0 + this.cell[1] * w, y0 + this.cell[0] * h, w - 1, h - 1);
    }
    this.labels(g, width, height, colours);
  };

  labels = (g, width, height, colours) => {
    const { x0, y0, w, h } = this.grid(width, height);
    g.fillStyle = colours.soft;
    g.textBaseline = "middle";
    g.textAlign = "right";
    const every = (count, room, wanted) => Math.max(1, Math.ceil((count * wanted) / Math.max(room, 1)));
    if (this.begin.down) {
      const skip = every(this.begin.down.levels.length, height - ROOM.top - ROOM.bottom, 13);
      this.begin.down.levels.forEach((level, i) => {
        if (i % skip === 0) g.fillText(shortNumber(level, 3), x0 - 5, y0 + (i + 0.5) * h);
      });
      g.save();
      g.translate(9, (height - ROOM.bottom) / 2);
      g.rotate(-Math.PI / 2);
      g.textAlign = "center";
      g.fillText(clean(this.begin.down.name), 0, 0);
      g.restore();
    }
    g.textAlign = "center";
    g.textBaseline = "top";
    const skip = every(this.begin.across.levels.length, width - ROOM.left - ROOM.right, 30);
    this.begin.across.levels.forEach((level, j) => {
      if (j % skip === 0) g.fillText(shortNumber(level, 3), x0 + (j + 0.5) * w, height - ROOM.bottom + 4);
    });
    g.fillText(clean(this.begin.across.name), (x0 + width) / 2, height - 14);
  };

  hatch = (g, box, colours) => {
    g.save();
    g.beginPath();
    g.rect(box.x, box.y, box.w, box.h);
    g.clip();
    g.strokeStyle = colours.soft;
    g.globalAlpha = 0.4;
    g.lineWidth = 1;
    g.beginPath();
    // Along the whole canvas, so that the lines of neighbours meet.
    const first = Math.floor((box.x - box.y - box.h) / 6) * 6;
    for (let c = first; c < box.x - box.y + box.w; c += 6) {
      g.moveTo(box.y + c, box.y);
      g.lineTo(box.y + box.h + c, box.y + box.h);
    }
    g.stroke();
    g.restore();
  };

  paintValue = (value, _visits, _most, never, colours) => {
    const words = [shortNumber(value, 2), shortNumber(value, 1), value.toFixed(1)];
    if (never) return [null, colours.soft, value === 0 ? [] : words];
    const span = this.begin.high - this.begin.low;
    const [fill, ink] = heat(span > 0 ? (value - this.begin.low) / span : 0.5);
    return [fill, ink, words];
  };

  paintVisits = (_value, count, most, never) => {
    if (never) return [null, "", []];
    const share = Math.log10(1 + count) / Math.log10(1 + most);
    const [r, g, b] = SHADES[Math.round(255 * share)];
    return [
      `rgb(${r} ${g} ${b})`,
      share > 0.6 ? "#000" : "#fff",
      [String(count), `${(count / 1000).toFixed(count < 10000 ? 1 : 0)}k`],
    ];
  };
}
