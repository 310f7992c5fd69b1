// Run: the text controls a plant. The loop of the server steps it; here are its form, its gains and its metrics.

import { aroundLine, unsavedLine } from "./around.js";
import { refill } from "./charts.js";
import { curvePane } from "./curves.js";
import { el, pane, shortNumber } from "./draw.js";
import { experimentFields, markField, optionsOf, textField, wordsOf } from "./experiment.js";
import { picturePane } from "./plant.js";
import { splitter } from "./split.js";
import { S } from "./strings.js";

const SPEEDS = [0.2, 1, 5, 60, 600];
const FIRST = ["rms", "max", "final", "chatter"];
const STEPS = 1000; // of a slider

/** A time in seconds as the words of the command line have it. */
const timeWords = (seconds) =>
  seconds % 3600 === 0 ? `${seconds / 3600}h` : seconds % 60 === 0 ? `${seconds / 60}min` : `${seconds}s`;

const lasting = (seconds) => (seconds <= 30 ? 1 : seconds <= 1000 ? 60 : 600);

/** What of a command line needs quotes gets them. */
const quoted = (word) => (/^[\w./:=,+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

/**
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function runView(store, hand) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const state = { job: null, ready: null, paused: false, over: false, sent: "", described: "", reached: "" };
  const picture = picturePane(store, (pull) => state.job?.say({ pull }));
  const curves = curvePane(store);
  const gains = gainPane(hand, (values, done) => {
    say({ gains: values });
    if (done && state.over) say({ restart: true, asked: asked(), pause: false });
  });
  const metrics = metricPane();
  const form = formPane(store, hand, changed);
  const view = el(
    "div",
    { class: "run" },
    form.section,
    picture.section,
    curves.section,
    gains.section,
    metrics.section,
    splitter({ key: "run-columns", vertical: true, at: 1, usual: 0.4 }),
    splitter({ key: "run-rows", vertical: false, at: 2, usual: 0.6 }),
  );

  form.start.addEventListener("click", start);
  form.pause.addEventListener("click", () => say({ pause: !state.paused }));
  form.step.addEventListener("click", () => say({ step: 1 }));
  form.again.addEventListener("click", again);
  form.stop.addEventListener("click", () => state.job?.stop());
  form.speed.addEventListener("change", () => say({ speed: form.asked().speed }));
  const calmed = () => say({ calm: calm.matches });
  calm.addEventListener("change", calmed);
  store.on("closed", () => calm.removeEventListener("change", calmed));
  view.addEventListener("keydown", (event) => {
    if (event.key === " " && event.target === picture.canvas && state.job) {
      event.preventDefault();
      say({ pause: !state.paused });
    }
  });

  const say = (words) => state.job?.say(words);

  /** Ask which plants there are, and which of them the text fits. */
  function describe() {
    const text = hand.text();
    if (store.view !== RUN.name || !store.sound || text === state.described) return;
    state.described = text;
    hand.start("plants", { text }, (news) => {
      if (news.uses) form.uses(news.uses);
      if (news.plants) form.offer(news);
      if (news.end !== "failed") return;
      form.note(news.message);
      state.described = ""; // it may be asked again
    });
  }

  function asked() {
    return { ...form.asked(), calm: calm.matches };
  }

  function start() {
    if (state.job) {
      again();
      return;
    }
    state.over = false;
    state.sent = hand.text();
    form.note(S.runStarting);
    state.job = hand.start("run", asked(), hear);
    form.running(state);
  }

  function again() {
    state.sent = hand.text();
    say({ text: state.sent });
    say({ restart: true, asked: asked(), pause: false });
  }

  /** Something of the form has changed: it counts from the next start on. */
  function changed() {
    if (state.job && state.ready) form.note(S.runNextTime);
  }

  const HEARD = {
    ready(news) {
      Object.assign(state, { ready: news, over: false });
      form.note("");
      form.mark("");
      curves.open(news);
      picture.open(news);
      gains.open(news.gains);
      metrics.open(news);
    },
    samples(news) {
      const before = state.paused;
      state.paused = news.paused;
      form.time(news.time, news.behind);
      if (news.low.length) curves.add(news);
      if (news.drawing) picture.show(news.drawing);
      if (before === state.paused) return;
      if (!state.paused) {
        state.over = false;
        form.unsay(state.reached); // it goes on; what else is said stays
      }
      form.running(state);
    },
    metrics: (news) => metrics.show(news.metrics),
    reached(news) {
      state.over = true; // what is changed now is seen from the start
      state.reached = S.runReached(news);
      form.note(state.reached);
    },
    over(news) {
      state.over = true;
      form.note(S.runOver[news.how](news), news.how === "diverged");
      form.running(state);
    },
    text(news) {
      form.note(news.taken ? S.runTaken : S.runRestart);
      if (news.taken) gains.open(news.gains);
    },
    note(news) {
      form.note(news.text, Boolean(news.field));
      form.mark(news.field ?? "", news.text);
    },
  };

  function hear(news) {
    if (news.end) {
      Object.assign(state, { job: null, ready: null, paused: false });
      picture.close();
      if (news.end === "failed") form.note(news.message, true);
      form.mark(news.field ?? "", news.message);
    } else HEARD[news.news]?.(news);
    if (news.end || news.news === "ready") form.running(state);
  }

  // What is typed or dragged counts at once, where it is sound.
  store.on("judged", () => {
    if (!store.sound) return;
    const text = hand.text();
    const isNew = text !== state.sent;
    if (state.job && isNew && state.over) rerun();
    else if (state.job && isNew) say({ text });
    if (!state.over) state.sent = text;
    describe();
  });
  store.on("view", () => {
    describe();
    rerun();
  });

  /** A run that has ended shows what has been changed since: it runs again where one looks at it. */
  function rerun() {
    if (state.job && state.over && store.view === RUN.name && store.sound && hand.text() !== state.sent) again();
  }

  let waits = false;
  store.on("left", () => {
    // nobody watches it
    waits = Boolean(state.job) && !state.paused && !state.over;
    if (waits) say({ pause: true });
  });
  store.on("shown", () => {
    if (waits && state.job) form.note(S.runWaits);
    waits = false;
  });
  form.running(state);
  return view;
}

export const RUN = { name: "run", title: S.run, drawn: false, panes: [runView] };

// --- What is to be run, and the buttons ---

/**
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function formPane(store, hand, changed) {
  const { section, bar, body } = pane("run-form", S.run);
  let plants = [];
  let direct = ""; // the controller that asks the text, where it is a rule base
  let likely = ""; // the plant on which the command runs it by itself
  let touched = false; // by a hand: what it chose stays
  const text = (label, hint, size) => textField(label, hint, size, changed);
  const plant = el("select", { onchange: () => chosen(true) });
  const reference = text(S.runReference, S.runReferenceHint, 22);
  const suggestions = el("datalist", { id: "run-signals" });
  reference.field.setAttribute("list", "run-signals");
  const duration = text(S.runFor, S.runForHint, 7);
  const endless = el("input", { type: "checkbox", onchange: () => open(true) });
  const trajectory = el("select", { onchange: changed });
  const payload = el("input", { type: "checkbox", onchange: changed });
  const speed = el(
    "select",
    {},
    ...SPEEDS.map((each) => el("option", { value: each, textContent: S.runTimes(each) })),
    el("option", { value: "", textContent: S.runFastest }),
  );
  const button = (words, hint) => el("button", { textContent: words, title: hint });
  const [start, pause, step, again, stop] = [
    button(S.runStart, S.runStartHint),
    button(S.runPause, S.runPauseHint),
    button(S.runStep, S.runStepHint),
    button(S.runAgain, S.runAgainHint),
    button(S.runStop, S.runStopHint),
  ];
  start.classList.add("main");
  start.disabled = true; // until it is known which plants there are
  const clock = el("output", { class: "clock", "aria-label": S.runTime });
  const said = el("p", { class: "said", role: "status" });
  const load = el("label", { class: "small" }, payload, S.runPayload);
  const along = el("span", { class: "fields" }, el("label", { class: "small" }, S.runTrajectory, trajectory), load);
  const elsewhere = el(
    "span",
    { class: "fields" },
    reference.shown,
    suggestions,
    duration.shown,
    el("label", { class: "small", title: S.runOpenEndedHint }, endless, S.runOpenEnded),
  );
  const around = aroundLine(hand);
  const unsaved = unsavedLine(store, hand);
  const more = experimentFields(changed);
  const seed = text(S.runSeed, S.runSeedHint, 5);
  const line = el("code", { class: "command", tabIndex: 0 });
  const details = el(
    "details",
    {},
    el("summary", { textContent: S.runMoreTitle }),
    el("div", { class: "fields" }, ...more.shown, seed.shown),
    el("p", { class: "small" }, `${S.runSame} `, line),
  );
  details.addEventListener("toggle", () => showLine());
  body.addEventListener("change", showLine);
  bar.append(start, pause, step, again, stop, el("label", { class: "small" }, S.runSpeed, speed), clock);
  const choice = el("div", { class: "fields" }, el("label", { class: "small" }, S.runPlant, plant), along, elsewhere);
  body.append(around.line, unsaved.line, choice, details, said);

  function open(byHand) {
    if (byHand) changed();
    showLine();
  }

  const one = () => plants.find((each) => each.name === plant.value);

  function chosen(byHand) {
    touched ||= byHand;
    if (!one()) return;
    show(one());
    if (byHand) changed();
    showLine();
  }

  /** Show the fields of a plant: its trajectories, or references. */
  function show(one) {
    const moves = one.trajectories.length > 0;
    along.hidden = !moves;
    elsewhere.hidden = moves;
    load.hidden = !one.carries;
    const kept = one.trajectories.includes(trajectory.value) ? trajectory.value : one.shown;
    refill(
      trajectory,
      one.trajectories.map((name) => [name, name]),
      kept,
    );
    reference.field.value = one.reference;
    const port = one.reference.split("=")[0];
    suggestions.replaceChildren(...S.runSignals.map((signal) => el("option", { value: `${port}=${signal}` })));
    speed.value = String(moves ? 1 : lasting(one.duration ?? 10));
    endless.checked = !one.duration;
    duration.field.value = one.duration ? timeWords(one.duration) : "";
    open(false);
    note(one.why, Boolean(one.why));
  }

  function offer(news) {
    const before = JSON.stringify(plants);
    plants = news.plants;
    direct = news.direct;
    likely = news.likely;
    start.disabled = !plants.length;
    choice.hidden = details.hidden = !plants.length;
    around.show(news.alone, Boolean(direct));
    if (!plants.length) {
      note("");
      return;
    }
    if (JSON.stringify(plants) === before) return;
    const kept =
      touched && plants.some((each) => each.name === plant.value) ? plant.value : news.chosen || plants[0].name;
    plant.replaceChildren(
      ...plants.map((each) =>
        el("option", {
          value: each.name,
          textContent: each.why ? S.runNotFitting(each.name) : each.name,
          title: each.why || each.summary,
        }),
      ),
    );
    const same = kept === plant.value && before !== "[]";
    plant.value = kept;
    if (!same || !reference.field.value) chosen(false);
    if (!news.chosen) note(S.runFitsNone, true);
  }

  function asked() {
    /** @type {Messages.RunWork} */
    const found = { plant: plant.value, speed: speed.value === "" ? null : Number(speed.value), ...more.asked() };
    const { trajectories, carries } = one() ?? {};
    if (trajectories?.length)
      Object.assign(found, { trajectory: trajectory.value, payload: carries && payload.checked });
    else {
      const lasts = duration.field.value.trim();
      Object.assign(found, {
        reference: wordsOf(reference.field.value),
        [endless.checked ? "window" : "until"]: lasts,
      });
    }
    if (seed.field.value.trim()) found.seed = seed.field.value.trim();
    return found;
  }

  /** The same run on the command line. */
  function showLine() {
    if (!details.open) return;
    const want = asked();
    const words = ["fuzzyarm", "simulate", ...(direct ? [direct, "--rulebase", hand.file()] : [hand.file()])];
    if (want.plant !== likely) words.push("--plant", want.plant);
    if (want.trajectory) words.push("--trajectory", want.trajectory, ...(want.payload ? ["--payload"] : []));
    words.push(...optionsOf(want));
    if (want.until) words.push("--for", want.until);
    if (want.seed !== undefined) words.push("--seed", String(want.seed));
    line.textContent = words.map(quoted).join(" ");
  }

  function note(words, bad = false) {
    said.textContent = words;
    said.classList.toggle("error", bad);
    said.hidden = !words;
  }

  /** Take back a note, where it is still there. */
  function unsay(words) {
    if (said.textContent === words) note("");
  }

  /** Show which buttons do something. */
  function running({ job, paused, over }) {
    start.hidden = Boolean(job);
    again.hidden = !job;
    for (const each of [pause, step]) each.disabled = !job || (over && !paused);
    stop.disabled = !job;
    pause.textContent = paused ? S.runResume : S.runPause;
  }

  function time(seconds, behind) {
    clock.textContent = `${shortNumber(seconds, 5)} s${behind ? ` (${S.runBehind})` : ""}`;
  }

  note("");
  const mark = (name, message) =>
    markField({ reference: reference.field, duration: duration.field, ...more.inputs }, name, message);
  return {
    section,
    start,
    pause,
    step,
    again,
    stop,
    speed,
    offer,
    uses: unsaved.show,
    asked,
    note,
    unsay,
    mark,
    running,
    time,
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
    const number = el("input", {
      type: "text",
      inputMode: "decimal",
      "aria-label": `${name}: ${S.value}`,
      onchange: () => moved(Number(number.value), true),
    });
    const unit = el("span", { class: "unit", textContent: gain.unit });
    const label = el("span", { class: "name", textContent: name, title: gain.written ? "" : S.runGainElsewhere });
    const shownRow = el("div", { class: "gain" }, label, range, number, unit);

    function set(value) {
      const at = Math.round(STEPS * Math.min(1, Math.max(0, share(gain, value))));
      if (document.activeElement !== range || Math.abs(range.value - at) > 1) range.value = at;
      range.setAttribute("aria-valuetext", `${shortNumber(value)} ${gain.unit}`);
      if (document.activeElement !== number) number.value = shortNumber(value, 6);
    }

    /** The running loop hears of it at once; letting go makes it an edit of the text. */
    function moved(value, done) {
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

  return { section, open };
}

// --- Metrics ---

function metricPane() {
  const { section, body } = pane("run-metrics", S.runMetrics);
  const table = el("table", { class: "metrics" });
  let units = {}; // by output and metric
  body.tabIndex = 0; // it scrolls
  body.append(table);

  function open(ready) {
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
        textContent: value === null ? "–" : `${shortNumber(value)} ${units[output]?.[name] ?? ""}`.trim(),
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
          ...outputs.map((output) => el("th", { scope: "col", textContent: output })),
        ),
      ),
      el(
        "tbody",
        {},
        ...sorted.map((name) =>
          el(
            "tr",
            { class: FIRST.includes(name) ? "first" : "" },
            el("th", { scope: "row", textContent: S.runMetric[name] ?? name, title: S.runMetricHint[name] ?? "" }),
            ...outputs.map((output) => cell(name, output)),
          ),
        ),
      ),
    );
  }

  return { section, open, show };
}
