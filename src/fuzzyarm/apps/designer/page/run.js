// Run: the text controls a plant. The loop of the server steps it; here are its form, its gains and its metrics.

import { aroundLine, unsavedLine } from "./around.js";
import { CurvePane } from "./curves.js";
import { el, numberInput, pane, readNumber, sayWrong, select, shortNumber, space, tableOf } from "./draw.js";
import { quoted } from "./fields.js";
import { Form } from "./form.js";
import { PicturePane } from "./plant.js";
import { splitter } from "./split.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { noTables } from "./table.js";
import { Task } from "./task.js";
import { showGrounds } from "./work.js";

const SPEEDS = [0.2, 1, 5, 60, 600];
const FIRST = ["rms", "max", "final", "chatter"];
const STEPS = 1000; // of a slider

/** A time in seconds as the words of the command line have it. */
const timeWords = (seconds) =>
  seconds % 3600 === 0 ? `${seconds / 3600}h` : seconds % 60 === 0 ? `${seconds / 60}min` : `${seconds}s`;

const lasting = (seconds) => (seconds <= 30 ? 1 : seconds <= 1000 ? 60 : 600);

class RunView {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand} hand
   */
  constructor(store, hand) {
    this.store = store;
    this.hand = hand;

    this.plants = new Task(hand, "plants");
    this.calm = matchMedia("(prefers-reduced-motion: reduce)");
    this.state = { job: null, ready: null, paused: false, over: false, sent: "", described: "", reached: "" };
    this.picture = new PicturePane(this.store, (pull) => this.state.job?.say({ pull }));
    this.curves = new CurvePane(this.store);
    this.gains = gainPane(this.hand, (values, done) => {
      this.say({ gains: values });
      if (done && this.state.over) this.say({ restart: true, asked: this.asked(), pause: false });
    });
    this.metrics = metricPane();
    this.form = new RunForm(this.store, this.hand, this.changed);
    this.section = el(
      "div",
      { class: "run" },
      this.form.section,
      this.picture.section,
      this.curves.section,
      this.gains.section,
      this.metrics.section,
      splitter({ key: "run-columns", vertical: true, at: 1, usual: 0.4 }),
      splitter({ key: "run-rows", vertical: false, at: 2, usual: 0.6 }),
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
    this.section.addEventListener("keydown", (event) => {
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
        this.picture.begin(news);
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
          this.form.unsay(this.state.reached); // it goes on; what else is said stays
        }
        this.form.running(this.state);
      },
      metrics: (news) => this.metrics.show(news.metrics, news.at),
      reached: (news) => {
        this.state.over = true; // what is changed now is seen from the start
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
      },
    };
  }

  follow() {
    // What is typed or dragged counts at once, where it is sound.
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
      // nobody watches it
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

  say = (words) => this.state.job?.say(words);

  /** Ask which plants there are, and which of them the text fits. */
  describe = () => {
    const text = this.hand.text();
    if (this.store.view !== RUN.name || !this.store.sound || text === this.state.described) return;
    this.state.described = text;
    this.plants.begin({ text }, (news) => {
      if (news.uses) this.form.unsaved.show(news.uses);
      if (news.plants) this.form.offer(news);
      if (news.end !== "failed") return;
      this.form.note(news.message);
      this.state.described = ""; // it may be asked again
    });
  };

  asked = () => {
    return { ...this.form.asked(), calm: this.calm.matches };
  };

  start = async () => {
    if (this.state.job) {
      this.again();
      return;
    }
    this.form.note(S.runStarting);
    await this.hand.settled(); // what is typed runs
    if (this.state.job) return; // two clicks
    this.state.over = false;
    this.state.sent = this.hand.text();
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
    this.store.work(RUN.name, !news.end && !this.state.paused && !this.state.over);
    if (news.end) {
      Object.assign(this.state, { job: null, ready: null, paused: false });
      this.picture.close();
      const isMarked = this.form.mark(news.field ?? "", news.message);
      if (news.end === "failed") this.form.note(isMarked ? "" : news.message, true);
    } else this.HEARD[news.news]?.(news);
    if (news.end || news.news === "ready") this.form.running(this.state);
  };

  /** A run that has ended shows what has been changed since: it runs again where one looks at it. */
  rerun = () => {
    if (
      this.state.job &&
      this.state.over &&
      this.store.view === RUN.name &&
      this.store.sound &&
      this.hand.text() !== this.state.sent
    )
      this.again();
  };
}

export const RUN = { name: "run", title: S.run, drawn: false, panes: [RunView], why: noTables };

// --- What is to be run, and the buttons ---

class RunForm extends Pane {
  constructor(store, hand, changed) {
    super(store, hand, "run-form", S.run);
    this.changed = changed;
    this.plants = [];
    this.direct = ""; // the controller that asks the text, where it is a rule base
    this.likely = ""; // the plant on which the command runs it by itself
    this.touched = false; // by a hand: what it chose stays
    this.endless = el("input", { type: "checkbox", onchange: () => this.open(true) });
    this.form = new Form({
      changed: (name) => (name === "plant" ? this.chosen(true) : this.changed()),
      judge: (values) => this.hand.folder({ what: "judge", file: this.hand.file(), form: "run", values }),
    });
    this.speed = select([...SPEEDS.map((each) => [String(each), S.runTimes(each)]), ["", S.runFastest]]);
    this.makeControls();
    this.arrange();
  }

  makeControls() {
    const button = (textContent, title) => el("button", { textContent, title });
    this.start = button(S.start, S.runStartHint);
    this.pause = button(S.pause, S.runPauseHint);
    this.step = button(S.runStep, S.runStepHint);
    this.again = button(S.runAgain, S.runAgainHint);
    this.stop = button(S.stop, S.runStopHint);
    this.start.classList.add("main");
    this.start.disabled = true; // until it is known which plants there are
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
    for (const name of ["input", "change"]) this.body.addEventListener(name, this.showLine);
    this.bar.append(
      this.start,
      this.pause,
      this.step,
      this.again,
      this.stop,
      el("label", { class: "small" }, S.speed, this.speed),
      this.clock,
    );
    this.body.append(this.around.line, this.unsaved.line, this.form.view, this.details, this.said);

    this.note("");
  }

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
    this.openEnd.hidden = moves;
    const before = this.form.shown("trajectory");
    showGrounds(this.form, one, [], one.trajectories.includes(before) ? before : one.shown);
    this.form.set("reference", one.reference);
    const port = one.reference.split("=")[0];
    this.form.suggest(
      "reference",
      S.runSignals.map((signal) => `${port}=${signal}`),
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
    const kept = stays ? chosen : news.chosen || this.plants[0].name;
    this.form.choices(
      "plant",
      this.plants.map((each) => [each.name, each.why ? S.runNotFitting(each.name) : each.name]),
      kept,
    );
    const same = kept === chosen && before !== "[]";
    if (!same || !this.form.shown("reference")) this.chosen(false);
    if (!news.chosen) this.note(S.runFitsNone, true);
  };

  /** @returns {Messages.RunWork} */
  asked = () => {
    const { duration = "", ...form } = this.form.values();
    return {
      form,
      speed: this.speed.value === "" ? null : Number(this.speed.value),
      ...(duration ? { [this.endless.checked ? "window" : "until"]: duration } : {}),
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

  note = (words, bad = false) => {
    this.said.textContent = words;
    this.said.classList.toggle("error", bad);
  };

  /** Take back a note, where it is still there. */
  unsay = (words) => {
    if (this.said.textContent === words) this.note("");
  };

  /** Show which buttons do something. */
  running = ({ job, paused, over }) => {
    this.start.hidden = Boolean(job);
    this.again.hidden = !job;
    for (const each of [this.pause, this.step]) each.disabled = !job || (over && !paused);
    this.stop.disabled = !job;
    this.pause.textContent = paused ? S.goOn : S.pause;
  };

  time = (seconds, behind) => {
    this.clock.textContent = `${shortNumber(seconds, 5)} s${behind ? ` (${S.runBehind})` : ""}`;
  };
}

// --- Gains ---

/**
 * @param {Page.Hand} hand
 */
function gainPane(hand, move) {
  const { section, body } = pane("run-gains", S.runGains);
  const list = el("div", { class: "gains" });
  let shown = "";
  let rows = [];
  body.append(list);
  list.append(el("p", { class: "note", textContent: S.runGainsNote }));

  /** Between 0 and 1 where a value is in its range. */
  const share = ({ low, high, log }, value) =>
    log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  const back = ({ low, high, log }, at) => (log ? low * (high / low) ** at : low + (high - low) * at);

  function open(gains) {
    const names = JSON.stringify(
      gains.map(({ name, values, low, high, log }) => [name, values.length, low, high, log]),
    );
    if (names !== shown) {
      shown = names;
      rows = gains.flatMap((gain) => gain.values.map((_, k) => row(gain, k)));
      list.replaceChildren(
        ...(rows.length ? rows.map((each) => each.shown) : [el("p", { class: "note", textContent: S.runNoGains })]),
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
      max: STEPS,
      step: 1,
      "aria-label": name,
      oninput: () => moved(Number(back(gain, range.value / STEPS).toPrecision(4)), false),
      onchange: () => moved(Number(back(gain, range.value / STEPS).toPrecision(4)), true),
    });
    const { input: number, typed } = numberInput({
      "aria-label": `${name}: ${S.value}`,
      onchange: () => moved(readNumber(number.value), true),
    });
    const unit = el("span", { class: "unit", textContent: gain.unit });
    const label = el("span", { class: "name", textContent: name, title: gain.written ? "" : S.runGainElsewhere });
    const shownRow = el("div", { class: "gain" }, label, range, typed, unit);

    function set(value) {
      const at = Math.round(STEPS * Math.min(1, Math.max(0, share(gain, value))));
      if (document.activeElement !== range || Math.abs(range.value - at) > 1) range.value = at;
      range.setAttribute("aria-valuetext", `${shortNumber(value)} ${gain.unit}`);
      if (document.activeElement === number) return;
      number.value = shortNumber(value, 6);
      sayWrong(number);
    }

    /** The running loop hears of it at once; letting go makes it an edit of the text. */
    function moved(value, done) {
      sayWrong(number, Number.isFinite(value) ? "" : S.noNumber(number.value));
      if (!Number.isFinite(value)) return;
      for (const each of rows) if (each.gain.name === gain.name) each.gain.values[k] = value;
      number.value = shortNumber(value, 6);
      range.setAttribute("aria-valuetext", `${shortNumber(value)} ${gain.unit}`);
      move({ [gain.name]: gain.values }, done && !gain.written);
      if (done && gain.written) hand.setGain(gain.name, gain.values);
    }

    return { gain, k, shown: shownRow, set };
  }

  return { section, open };
}

// --- Metrics ---

function metricPane() {
  const { section, bar, body } = pane("run-metrics", S.runMetrics);
  const until = el("span", { class: "readout" });
  bar.append(space(), until);
  const table = el("table", { class: "metrics" });
  let units = {}; // by output and metric
  body.tabIndex = 0; // it scrolls
  body.append(table);

  function open(ready) {
    units = ready.units;
    table.replaceChildren();
  }

  function show(metrics, at) {
    until.textContent = S.runUntil(shortNumber(at, 5));
    const outputs = Object.keys(metrics);
    if (!outputs.length) return;
    const names = Object.keys(metrics[outputs[0]]);
    const sorted = [...FIRST, ...names.filter((name) => !FIRST.includes(name))];
    const valueOf = (name, output) => {
      const value = metrics[output][name];
      return value === null ? "–" : `${shortNumber(value)} ${units[output]?.[name] ?? ""}`.trim();
    };
    const next = tableOf({
      caption: el("span", { class: "unseen", textContent: S.runMetrics }),
      head: [S.runErrorOf, ...outputs],
      rows: sorted.map((name) => {
        const head = el("th", { scope: "row", textContent: name, title: S.runMetricHint[name] ?? "" });
        const cells = outputs.map((output) => el("td", { textContent: valueOf(name, output) }));
        return el("tr", { class: FIRST.includes(name) ? "first" : "" }, head, ...cells);
      }),
    });
    table.replaceChildren(...next.childNodes);
  }

  return { section, open, show };
}
