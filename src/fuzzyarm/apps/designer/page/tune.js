// Tune: the search of `fuzzyarm tune` on the text that is open, its cost as it falls, what came of it.

import { clean, el, pairsOf, pane, shortNumber, tableOf, space } from "./draw.js";
import { stage } from "./pane.js";
import { drawPanel } from "./panel.js";
import { S } from "./strings.js";
import { noTables } from "./table.js";
import { showGrounds, Work } from "./work.js";

const MOST_ROWS = 120; // of numbers that move
/** Fields of a controller in its loop, beside those that are folded away, and of a rule base on samples. */
const IN_LOOP = ["plant", "scenarios", "vary", "over", "linear"];
const ON_SAMPLES = ["data", "test", "target"];

const shown = (value) => (value === null ? "–" : shortNumber(value));

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "tune",
  title: S.tune,
  go: S.start,
  stop: S.stopAndKeep,
  facts: "tunable",
  form: () => "tune",
  isEnough: true,
  ofFolder: true,
};

class TuneWork extends Work {
  constructor(store, hand) {
    super(store, hand, KIND);
    this.forget();
    this.rows = [];
    this.drawn = null; // the report that is drawn
    this.insert = el("button", {
      textContent: S.insertTune,
      hidden: true,
      onclick: () => this.hand.change("movable", {}),
    });
    this.told = el("span", { class: "says" });
    this.actions.append(this.told, this.insert);
    this.makePictures();
    this.show();
    // A step back takes the change back, and what was said of it.
    this.store.on("edited", () => {
      if (this.taken) this.say(this.hand.text() === this.taken.text ? this.taken.words : this.overWords());
    });
  }

  makePictures() {
    const left = pane("cost", S.costOfTrials);
    const [right, below] = [pane("numbers", S.numbersThatMove), pane("report", S.whatCameOfIt)];
    this.counted = el("span", { class: "readout" });
    left.bar.append(space(), this.counted);
    this.curve = stage(this.store, left.body, () => this.panel && drawPanel(this.curve.canvas, this.panel));
    this.numbers = right.body;
    this.outcome = below.body;
    this.keep = el("button", {
      class: "main",
      textContent: S.takeIt,
      title: S.takeItHint,
      onclick: () => this.task.say({ take: true }),
    });
    below.bar.append(space(), this.keep);
    const panes = new DocumentFragment();
    panes.append(this.section, left.section, right.section, below.section);
    this.section = panes;
  }

  // --- what may be asked for ---

  canStart() {
    return super.canStart() && (this.facts.loop ? this.facts.plants : this.facts.samples).length > 0;
  }

  refuse(words) {
    super.refuse(words);
    this.insert.hidden = true;
  }

  fill({ plants, samples, cost, says, parameters }) {
    this.form.choices(
      "plant",
      plants.map((each) => [each.name, each.fits ? each.name : S.needsConnect(each.name)]),
    );
    this.form.choices("data", pairsOf(samples));
    this.form.choices("test", [["", S.fifth], ...pairsOf(samples)]);
    this.form.input("cost").placeholder = cost;
    this.insert.hidden = says || parameters.length === 0;
    this.changed("plant");
  }

  changed(name) {
    if (name !== "plant") return;
    const { loop, plants, form } = this.facts;
    const folded = form.filter((field) => field.group).map((field) => field.name);
    this.form.show([...IN_LOOP, ...folded], loop);
    this.form.show(ON_SAMPLES, !loop);
    const plant = loop ? plants.find((each) => each.name === this.form.shown("plant")) : undefined;
    showGrounds(this.form, plant, [["", S.asCompared]]);
  }

  ready(facts) {
    return S.whatMoves(facts);
  }

  // --- the search ---

  /** Forget the search before. */
  forget() {
    this.moving = []; // the numbers that move
    this.counts = { search: 0, linear: 0 }; // of trials
    this.panel = null; // the picture of their costs
    this.state = null; // the last word of the search
    this.phase = "";
    this.report = null;
    this.taken = null; // the text that its change has made, and what was said of it
  }

  begin() {
    this.forget();
    super.begin();
  }

  take(news) {
    if (news.panel) this.panel = news.panel;
    if (news.moving) this.moving = news.moving;
    if (news.phase) this.progress(news);
    if (news.report) {
      this.report = news.report;
      this.counts.search = this.report.trials;
      this.isOver = true; // it waits until its change has been taken
      this.say(this.overWords());
    }
    if (news.untaken) this.say(news.untaken);
    if (news.taken) this.edit(news.taken);
  }

  overWords() {
    return this.report.interrupted ? S.stopped(this.report) : S.tuned(this.report);
  }

  progress(news) {
    this.counts[news.phase] = news.count;
    if (news.phase === "search") this.state = news;
    const turned = this.phase !== news.phase;
    this.phase = news.phase;
    if (this.isEnding || !turned) return; // the count stands above the picture
    this.say(S.searching[this.phase](this.form.shown("evals")));
  }

  keeping() {
    return { take: true };
  }

  async edit({ old, new: changed, written }) {
    const done = await this.hand.change("merge", { old, new: changed });
    this.taken = done ? { text: this.hand.text(), words: S.taken(written) } : null;
    this.say(done ? this.taken.words : S.notTaken);
  }

  show() {
    super.show();
    this.keep.disabled = !this.report?.changes.length || !this.task.job;
    this.counted.textContent = clean(
      this.state ? S.searchState(this.counts.search, this.state.best, this.state.seconds) : "",
    );
    this.curve.canvas.setAttribute("aria-label", clean(S.costLabel(this.counts.search, this.state?.best ?? null)));
    this.curve.redraw();
    this.drawNumbers();
    this.drawReport();
  }

  drawNumbers = () => {
    if (!this.moving.length) {
      this.rows = [];
      this.numbers.replaceChildren(el("p", { class: "note", textContent: S.noSearch }));
      return;
    }
    if (this.rows.length !== Math.min(this.moving.length, MOST_ROWS) || this.rows[0].of !== this.moving) this.build();
    this.rows.forEach(({ number: each, track, best, now, value }, i) => {
      const at = this.state?.best_shares?.[i] ?? each.share;
      best.style.left = `${100 * at}%`;
      now.style.left = `${100 * (this.state?.shares?.[i] ?? each.share)}%`;
      now.hidden = this.isOver || this.phase !== "search";
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
    this.numbers.replaceChildren(list);
    if (this.moving.length > MOST_ROWS)
      this.numbers.append(el("p", { class: "note", textContent: S.more(this.moving.length - MOST_ROWS) }));
  };

  drawReport = () => {
    if (this.drawn === this.report && this.drawn !== null) return;
    this.drawn = this.report;
    if (!this.report) {
      this.outcome.replaceChildren(el("p", { class: "note", textContent: !this.isOver ? S.waiting : S.noReport }));
      return;
    }
    const found = el("div", {}, this.table(), el("p", { textContent: this.report.claim }));
    for (const line of [...this.report.remarks, ...this.report.faults]) found.append(el("p", { textContent: line }));
    if (this.report.changes.length) found.append(this.difference());
    const changed = this.report.changes.length ? [el("div", { class: "listed" }, this.changes())] : [];
    this.outcome.replaceChildren(el("div", { class: "two" }, found, ...changed));
  };

  table = () => {
    const { rows } = this.report;
    const columns = ["train", "unseen", "noisy"].filter((name) => rows.tuned[name]);
    const loop = Object.values(rows).some((row) => row.train.chatter !== null);
    const last = columns[Math.min(1, columns.length - 1)];
    const cost = (score) => (score ? (score.diverged ? S.diverge(score.diverged) : shown(score.cost)) : "–");
    return tableOf({
      class: "scores",
      caption: S.costs(this.report),
      head: [
        "",
        ...columns.map((name) => S.sets[name]),
        ...(loop ? [S.rmsOf(S.sets[last]), S.chatterOf(S.sets[last])] : []),
      ],
      rows: Object.entries(rows).map(([name, row]) => {
        const { rms, chatter } = row[last] ?? row.train;
        return [name, ...columns.map((each) => cost(row[each])), ...(loop ? [shown(rms), shown(chatter)] : [])];
      }),
    });
  };

  changes = () =>
    tableOf({
      class: "changes",
      caption: S.changes,
      rows: this.report.changes.map((each) => [each.what, each.old, "→", each.new]),
    });

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

export const TUNE = {
  name: "tune",
  title: S.tune,
  drawn: false,
  further: true,
  why: noTables,
  panes: [TuneWork],
  splits: [
    { key: "tune-columns", vertical: true, at: 1, usual: 0.5 },
    { key: "tune-rows", vertical: false, at: 2, usual: 0.44 },
  ],
};
