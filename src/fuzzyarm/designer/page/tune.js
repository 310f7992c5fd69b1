// Tune: the search of `fuzzyarm tune` on the text that is open, its cost as it falls, what came of it.

import { clean, el, pane, shortNumber } from "./draw.js";
import { stage } from "./charts.js";
import { confirm } from "./dialogs.js";
import { Form } from "./form.js";
import { drawPanel } from "./panel.js";
import { S } from "./strings.js";
import { showGrounds } from "./work.js";

const MOST_ROWS = 120; // of numbers that move
/** Fields of a controller in its loop, and of a rule base on samples. */
const AROUND = ["connect", "noise", "quantise", "sensor_delay", "difference", "actuator", "disturb", "interpolate"];
const IN_LOOP = ["plant", "scenarios", "vary", "over", "linear", ...AROUND];
const ON_SAMPLES = ["data", "test", "target"];

export const TUNE = {
  name: "tune",
  title: S.tune,
  drawn: false,
  panes: [tunePanes],
  splits: [
    { key: "tune-columns", vertical: true, at: 1, usual: 0.5 },
    { key: "tune-rows", vertical: false, at: 2, usual: 0.44 },
  ],
};

/**
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function tunePanes(store, hand) {
  return new TunePanes(store, hand).panes;
}

class TunePanes {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand} hand
   */
  constructor(store, hand) {
    this.store = store;
    this.hand = hand;

    this.facts = null; // whether the text can be tuned, and on what
    this.job = null; // the search; when it is over it is kept, until its change has been taken
    this.running = false;
    this.ending = false; // a hand has said that it is enough
    this.moving = []; // the numbers that move
    this.counts = { search: 0, linear: 0 }; // of trials
    this.panel = null; // the picture of their costs
    this.state = null; // the last word of the search
    this.phase = "search";
    this.report = null;
    this.stale = true;

    // --- what may be asked ---

    this.top = pane("tuning", S.tune);
    this.form = new Form({
      changed: (name) => name === "plant" && this.fit(),
      judge: (values) => this.hand.askNow("judge", { form: "tune", values }),
    });
    this.makeActions();
    this.makePictures();
    this.listen();
  }

  makeActions() {
    this.start = el("button", { class: "main", textContent: S.start, onclick: () => this.begin() });
    this.stop = el("button", { textContent: S.stopAndKeep, disabled: true, onclick: () => this.enough() });
    this.insert = el("button", {
      textContent: S.insertTune,
      hidden: true,
      onclick: () => this.hand.change("movable", {}),
    });
    this.says = el("span", { class: "says" });
    this.said = el("p", { class: "said", role: "status" });
    const actions = el("div", { class: "actions" }, this.start, this.stop, this.says, this.insert);
    this.top.body.append(this.form.view, actions, this.said);

    this.told = 0;
  }

  makePictures() {
    // --- pictures ---

    this.left = pane("cost", S.costOfTrials);
    this.right = pane("numbers", S.numbersThatMove);
    this.below = pane("report", S.whatCameOfIt);
    this.counted = el("span", { class: "readout" });
    this.left.bar.append(el("span", { class: "space" }), this.counted);
    this.curve = stage(this.store, this.left.body, () => this.panel && drawPanel(this.curve.canvas, this.panel));

    this.rows = [];

    // --- what came of it ---

    this.takeIt = el("button", {
      class: "main",
      textContent: S.takeIt,
      title: S.takeItHint,
      onclick: () => this.job?.say({ take: true }),
    });
    this.below.bar.append(el("span", { class: "space" }), this.takeIt);
    this.drawn = null;
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

  shown = (value) => (value === null ? "–" : shortNumber(value));

  fit = () => {
    const known = this.facts?.plants.find((each) => each.name === this.form.shown("plant"));
    this.form.show(IN_LOOP, Boolean(this.facts?.loop));
    this.form.show(ON_SAMPLES, Boolean(this.facts) && !this.facts.loop);
    showGrounds(this.form, this.facts?.loop ? known : undefined, [["", S.asCompared]]);
  };

  ask = () => {
    if (this.store.view !== TUNE.name || !this.stale || this.running) return;
    this.stale = false;
    this.hand.start("tunable", {}, (message) => {
      if (message.end === "failed") {
        this.facts = null;
        this.says.textContent = clean(message.message);
        this.insert.hidden = true;
        this.start.disabled = true;
      }
      if (message.end) return;
      this.facts = message;
      this.form.open(this.facts.form);
      const samples = this.facts.samples.map((each) => [each, each]);
      this.form.choices(
        "plant",
        this.facts.plants.map((each) => [each.name, each.fits ? each.name : S.needsConnect(each.name)]),
      );
      this.form.choices("data", samples);
      this.form.choices("test", [["", S.fifth], ...samples]);
      this.form.input("cost").placeholder = this.facts.cost;
      this.says.textContent = clean(S.whatMoves(/** @type {any} */ (this.facts)));
      this.insert.hidden = this.facts.says || this.facts.parameters.length === 0;
      this.start.disabled = this.running || (this.facts.loop ? !this.facts.plants.length : !this.facts.samples.length);
      this.fit();
    });
  };

  // --- the search ---

  begin = () => {
    this.job?.stop();
    this.moving = [];
    this.counts = { search: 0, linear: 0 };
    this.panel = null;
    this.state = this.report = null;
    this.phase = "search";
    this.running = true;
    this.ending = false;
    this.said.textContent = S.preparing;
    this.form.mark("");
    const mine = (this.job = this.hand.start("tune", { form: this.form.values() }, (message) => {
      if (this.job === mine) this.hear(message);
    }));
    this.show();
  };

  enough = () => {
    this.job?.say({ enough: true });
    this.ending = true;
    this.said.textContent = S.stopping;
    this.show();
  };

  hear = (message) => {
    if (message.panel) this.panel = message.panel;
    if (message.end) {
      this.job = null;
      this.running = false;
      if (message.end === "failed") this.said.textContent = clean(message.field ? "" : message.message);
      this.ask();
    } else if (message.moving) this.moving = message.moving;
    else if (message.phase) this.take(message);
    else if (message.report) {
      this.report = message.report;
      this.running = false;
      this.said.textContent = clean(this.report.interrupted ? S.stopped(this.report) : S.tuned(this.report));
      this.ask();
    } else if (message.exists) this.replace(message.exists);
    else if (message.untaken) this.said.textContent = clean(message.untaken);
    else if (message.taken) this.edit(message.taken);
    this.show();
    if (message.end === "failed") this.form.mark(message.field ?? "", message.message);
  };

  take = (message) => {
    this.counts[message.phase] = message.count;
    if (message.phase === "search") this.state = message;
    const turned = this.phase !== message.phase;
    this.phase = message.phase;
    // The line is read out: every five seconds is enough.
    if (!this.ending && (turned || performance.now() - this.told > 5000)) {
      this.told = performance.now();
      this.said.textContent = clean(
        S.searching(this.phase, this.counts[this.phase], message.best, Number(this.form.shown("evals"))),
      );
    }
  };

  replace = async (names) => {
    if (await confirm(S.replaceFile(names.join(", ")), S.replace)) this.job?.say({ take: true, replace: true });
  };

  edit = async ({ old, new: changed, written }) => {
    const done = await this.hand.change("merge", { old, new: changed });
    this.said.textContent = clean(done ? S.taken(written) : S.notTaken);
    this.show();
  };

  show = () => {
    this.start.disabled =
      this.running || !this.facts || (this.facts.loop ? !this.facts.plants.length : !this.facts.samples.length);
    this.stop.disabled = !this.running || this.ending;
    this.form.lock(this.running);
    this.counted.textContent = clean(
      this.state ? S.searchState(this.counts.search, this.state.best, this.state.seconds) : "",
    );
    this.curve.canvas.setAttribute("aria-label", clean(S.costLabel(this.counts.search, this.state?.best ?? null)));
    this.curve.redraw();
    this.drawNumbers();
    this.drawReport();
  };

  drawNumbers = () => {
    if (!this.moving.length) {
      this.rows = [];
      this.right.body.replaceChildren(el("p", { class: "note", textContent: S.noSearch }));
      return;
    }
    if (this.rows.length !== Math.min(this.moving.length, MOST_ROWS) || this.rows[0].of !== this.moving) this.build();
    this.rows.forEach(({ number: each, track, best, now, value }, i) => {
      const at = this.state?.best_shares?.[i] ?? each.share;
      best.style.left = `${100 * at}%`;
      now.style.left = `${100 * (this.state?.shares?.[i] ?? each.share)}%`;
      now.hidden = !this.running || this.phase !== "search";
      const shown = shortNumber(this.state?.values?.[i] ?? each.start);
      value.textContent = clean(shown);
      track.setAttribute(
        "aria-label",
        clean(S.numberLabel(each.name, shown, shortNumber(each.low), shortNumber(each.high), shortNumber(each.start))),
      );
      track.classList.toggle("bound", Math.min(at, 1 - at) < 1e-3);
    });
  };

  build = () => {
    const list = el("div", { class: "moving" });
    this.rows = this.moving.slice(0, MOST_ROWS).map((each) => {
      const first = el("i", { class: "first", title: S.inTheFile });
      first.style.left = `${100 * each.share}%`;
      const [now, best] = [el("i", { class: "now" }), el("i", { class: "best" })];
      const track = el("span", { class: "track", role: "img" }, first, now, best);
      const value = el("span", { class: "value" });
      list.append(
        el("span", { class: "name", textContent: each.name, title: each.name }),
        el("span", { class: "end", textContent: shortNumber(each.low, 3) }),
        track,
        el("span", { class: "end", textContent: shortNumber(each.high, 3) }),
        value,
      );
      return { of: this.moving, number: each, track, best, now, value };
    });
    this.right.body.replaceChildren(list);
    if (this.moving.length > MOST_ROWS)
      this.right.body.append(el("p", { class: "note", textContent: S.more(this.moving.length - MOST_ROWS) }));
  };

  drawReport = () => {
    this.takeIt.disabled = !this.report?.changes.length || !this.job;
    if (this.drawn === this.report && this.drawn !== null) return;
    this.drawn = this.report;
    if (!this.report) {
      this.below.body.replaceChildren(el("p", { class: "note", textContent: this.running ? S.waiting : S.noReport }));
      return;
    }
    const found = el("div", {}, this.table(), el("p", { textContent: this.report.claim }));
    for (const line of [...this.report.remarks, ...this.report.faults]) found.append(el("p", { textContent: line }));
    if (this.report.changes.length) found.append(this.difference());
    const changed = this.report.changes.length ? [el("div", { class: "listed" }, this.changes())] : [];
    this.below.body.replaceChildren(el("div", { class: "two" }, found, ...changed));
  };

  table = () => {
    const columns = ["train", "unseen", "noisy"].filter((name) => this.report.rows.tuned[name]);
    const loop = Object.values(this.report.rows).some((row) => row.train.chatter !== null);
    const last = columns[Math.min(1, columns.length - 1)];
    const head = [
      ...columns.map((name) => S.sets[name]),
      ...(loop ? [S.rmsOf(S.sets[last]), S.chatterOf(S.sets[last])] : []),
    ];
    const body = Object.entries(this.report.rows).map(([name, row]) => {
      const score = row[last] ?? row.train;
      const cells = columns.map((each) =>
        row[each] ? (row[each].diverged ? S.diverge(row[each].diverged) : this.shown(row[each].cost)) : "–",
      );
      if (loop) cells.push(this.shown(score.rms), this.shown(score.chatter));
      return el(
        "tr",
        {},
        el("th", { scope: "row", textContent: name }),
        ...cells.map((text) => el("td", { textContent: text })),
      );
    });
    return el(
      "table",
      { class: "scores" },
      el("caption", { textContent: S.costs(this.report) }),
      el("thead", {}, el("tr", {}, el("td"), ...head.map((text) => el("th", { scope: "col", textContent: text })))),
      el("tbody", {}, ...body),
    );
  };

  changes = () => {
    const body = this.report.changes.map((each) =>
      el(
        "tr",
        {},
        el("th", { scope: "row", textContent: each.what }),
        el("td", { textContent: each.old }),
        el("td", { textContent: "→" }),
        el("td", { textContent: each.new }),
      ),
    );
    return el("table", { class: "changes" }, el("caption", { textContent: S.changes }), el("tbody", {}, ...body));
  };

  difference = () => {
    const listing = this.report.diff
      .split("\n")
      .map((line) =>
        el("span", {
          class: line.startsWith("+") ? "added" : line.startsWith("-") ? "removed" : "",
          textContent: `${line}\n`,
        }),
      );
    return el(
      "details",
      {},
      el("summary", { textContent: S.difference }),
      el("pre", { class: "difference", tabIndex: 0, "aria-label": S.difference }, ...listing),
    );
  };
}
