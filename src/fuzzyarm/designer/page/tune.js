// Tune: the search of `fuzzyarm tune` on the text that is open, its cost as it falls, what came of it.

import { clean, el, pane, shortNumber } from "./draw.js";
import { drawChart, field, number, refill, stage } from "./charts.js";
import { confirm } from "./dialogs.js";
import { experimentFields, markField, wordsOf } from "./experiment.js";
import { S } from "./strings.js";

const MOST_ROWS = 120; // of numbers that move
const LOST = 1e6; // what a run that diverges costs, at least

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
  let facts = null; // whether the text can be tuned, and on what
  let job = null; // the search; when it is over it is kept, until its change has been taken
  let running = false;
  let ending = false; // a hand has said that it is enough
  let moving = []; // the numbers that move
  let costs = { search: [], linear: [] };
  let state = null; // the last word of the search
  let phase = "search";
  let report = null;
  let stale = true;

  // --- what may be asked ---

  const top = pane("tuning", S.tune);
  const plant = el("select", { onchange: () => fit() });
  const reference = el("input", { type: "text", size: 16 });
  const seconds = el("input", { type: "number", min: 0.001, step: "any", placeholder: S.usual });
  const data = el("select");
  const cost = el("input", { type: "text", size: 18, spellcheck: false });
  const scenarios = el("input", { type: "number", min: 1, max: 1000, placeholder: S.usual });
  const evals = number(500, 1, 100000);
  const unseen = number(24, 0, 1000);
  const seed = number(1, 0, 100000);
  const method = el("select");
  const over = el("select");
  refill(over, [
    ["mean", S.mean],
    ["worst", S.worst],
  ]);
  const linear = el("input", { type: "checkbox", checked: true });
  const trajectory = el("select");
  const payload = el("input", { type: "checkbox", checked: true });
  const test = el("select");
  const target = el("input", { type: "text", size: 10, spellcheck: false, placeholder: S.usual });
  const vary = el("input", { type: "text", size: 18, spellcheck: false, autocomplete: "off" });
  const longest = el("input", { type: "text", size: 7, spellcheck: false, placeholder: S.noLimit });
  const digits = number(3, 1, 12);
  const experiment = experimentFields();
  const lines = el("textarea", { rows: 2, cols: 34, spellcheck: false, placeholder: S.linesExample });
  const load = el("label", { class: "check" }, payload, S.payload);
  const along = [field(S.trajectory, trajectory), load];
  const elsewhere = [field(S.reference, reference, S.referenceHint), field(S.seconds, seconds)];
  const inLoop = [
    field(S.plant, plant),
    ...elsewhere,
    ...along,
    field(S.scenarios, scenarios, S.scenariosHint),
    field(S.vary, vary, S.varyHint),
    field(S.overScenarios, over),
    el("label", { class: "check", title: S.linearHint }, linear, S.linear),
  ];
  const onSamples = [
    field(S.samples, data),
    field(S.testedOn, test, S.testedOnHint),
    field(S.target, target, S.targetHint),
  ];
  const inputs = { ...experiment.inputs, reference, cost, vary, lines, time: longest };
  const fields = el(
    "div",
    { class: "fields" },
    ...inLoop.slice(0, 5),
    ...onSamples,
    field(S.cost, cost, S.costHint),
    ...inLoop.slice(5),
    field(S.evals, evals),
    field(S.longest, longest, S.longestHint),
    field(S.unseen, unseen, S.unseenHint),
    field(S.seed, seed),
    field(S.digits, digits, S.digitsHint),
    field(S.method, method),
    field(S.lines, lines, S.linesHint),
  );
  const more = el(
    "details",
    { class: "experiment" },
    el("summary", { textContent: S.runMoreTitle }),
    el("div", { class: "fields" }, ...experiment.shown),
  );
  const start = el("button", { class: "main", textContent: S.start, onclick: () => begin() });
  const stop = el("button", { textContent: S.stopAndKeep, disabled: true, onclick: () => enough() });
  const insert = el("button", { textContent: S.insertTune, hidden: true, onclick: () => hand.change("movable", {}) });
  const says = el("span", { class: "says" });
  const said = el("p", { class: "said", role: "status" });
  const actions = el("div", { class: "actions" }, start, stop, says, insert);
  top.body.append(fields, more, actions, said);

  function fit() {
    const known = facts?.plants.find((each) => each.name === plant.value);
    const moves = Boolean(facts?.loop && known?.trajectories.length);
    for (const each of [...inLoop, more]) each.hidden = !facts?.loop;
    for (const each of elsewhere) each.hidden = !facts?.loop || moves;
    for (const each of along) each.hidden = !moves;
    load.hidden = !moves || !known.carries;
    refill(trajectory, [["", S.asCompared], ...(known?.trajectories ?? []).map((each) => [each, each])]);
    for (const each of onSamples) each.hidden = !facts || facts.loop;
    reference.placeholder = known?.reference ?? "";
  }

  function ask() {
    if (store.view !== TUNE.name || !stale || running) return;
    stale = false;
    hand.start("tunable", {}, (message) => {
      if (message.end === "failed") {
        facts = null;
        says.textContent = clean(message.message);
        insert.hidden = true;
        start.disabled = true;
      }
      if (message.end) return;
      const first = !facts;
      facts = message;
      refill(
        plant,
        facts.plants.map((each) => [each.name, each.fits ? each.name : S.needsConnect(each.name)]),
      );
      refill(
        data,
        facts.samples.map((each) => [each, each]),
      );
      refill(test, [["", S.fifth], ...facts.samples.map((each) => [each, each])]);
      refill(
        method,
        facts.methods.map((each) => [each, each]),
      );
      if (first) cost.placeholder = facts.defaults.cost;
      says.textContent = clean(S.whatMoves(/** @type {any} */ (facts)));
      insert.hidden = facts.says || facts.parameters.length === 0;
      start.disabled = running || (facts.loop ? !facts.plants.length : !facts.samples.length);
      fit();
    });
  }

  // --- the search ---

  function begin() {
    job?.stop();
    moving = [];
    costs = { search: [], linear: [] };
    state = report = null;
    phase = "search";
    running = true;
    ending = false;
    said.textContent = S.preparing;
    markField(inputs, "");
    const known = facts?.plants.find((each) => each.name === plant.value);
    const where = !facts?.loop
      ? { data: data.value, test: test.value, target: target.value }
      : known?.trajectories.length
        ? { trajectory: trajectory.value, payload: payload.checked }
        : { reference: wordsOf(reference.value), seconds: seconds.value };
    const mine = (job = hand.start(
      "tune",
      {
        ...where,
        ...(facts?.loop ? { plant: plant.value, vary: wordsOf(vary.value), ...experiment.asked() } : {}),
        time: longest.value.trim(),
        digits: digits.value,
        cost: cost.value.trim(),
        scenarios: facts?.loop ? scenarios.value : "",
        evals: evals.value,
        unseen: unseen.value,
        seed: seed.value,
        method: method.value,
        over: over.value,
        linear: linear.checked,
        lines: lines.value,
      },
      (message) => {
        if (job === mine) hear(message);
      },
    ));
    show();
  }

  function enough() {
    job?.say({ enough: true });
    ending = true;
    said.textContent = S.stopping;
    show();
  }

  function hear(message) {
    if (message.end) {
      job = null;
      running = false;
      if (message.end === "failed") said.textContent = clean(message.field ? "" : message.message);
      ask();
    } else if (message.moving) moving = message.moving;
    else if (message.phase) take(message);
    else if (message.report) {
      report = message.report;
      running = false;
      said.textContent = clean(report.interrupted ? S.stopped(report) : S.tuned(report));
      ask();
    } else if (message.exists) replace(message.exists);
    else if (message.untaken) said.textContent = clean(message.untaken);
    else if (message.taken) edit(message.taken);
    show();
    if (message.end === "failed") markField(inputs, message.field ?? "", message.message);
  }

  let told = 0;

  function take(message) {
    costs[message.phase].push(...message.costs);
    if (message.phase === "search") state = message;
    const turned = phase !== message.phase;
    phase = message.phase;
    // The line is read out: every five seconds is enough.
    if (!ending && (turned || performance.now() - told > 5000)) {
      told = performance.now();
      said.textContent = clean(S.searching(phase, costs[phase].length, message.best, Number(evals.value)));
    }
  }

  async function replace(names) {
    if (await confirm(S.replaceFile(names.join(", ")), S.replace)) job?.say({ take: true, replace: true });
  }

  async function edit({ old, new: changed, written }) {
    const done = await hand.change("merge", { old, new: changed });
    said.textContent = clean(done ? S.taken(written) : S.notTaken);
    show();
  }

  function show() {
    start.disabled = running || !facts || (facts.loop ? !facts.plants.length : !facts.samples.length);
    stop.disabled = !running || ending;
    for (const form of [fields, more]) {
      for (const input of form.querySelectorAll("input, select, textarea")) input.disabled = running;
    }
    counted.textContent = clean(state ? S.searchState(costs.search.length, state.best, state.seconds) : "");
    curve.canvas.setAttribute("aria-label", clean(S.costLabel(costs.search.length, state?.best ?? null)));
    curve.redraw();
    drawNumbers();
    drawReport();
  }

  // --- pictures ---

  const left = pane("cost", S.costOfTrials);
  const right = pane("numbers", S.numbersThatMove);
  const below = pane("report", S.whatCameOfIt);
  const counted = el("span", { class: "readout" });
  left.bar.append(el("span", { class: "space" }), counted);
  const curve = stage(store, left.body, (paper) => {
    const best = falling(costs.search);
    const least = best.filter((v) => v !== null).at(-1) ?? 1;
    const shown = (v) => (v !== null && v < LOST && v <= 20 * least ? v : null);
    const spread = Math.max(...best.filter((v) => v !== null && v < LOST), least) / least;
    const others = falling(costs.linear).map(shown);
    drawChart(
      paper,
      [
        { dots: true, values: costs.search.map(shown), line: 0 },
        { name: S.best, steps: true, values: best.map(shown), line: 0 },
        ...(others.length ? [{ name: S.linearPd, steps: true, values: others, line: 1 }] : []),
      ],
      { across: S.trials, up: S.cost, logarithmic: least > 0 && spread > 5 },
    );
  });

  /** The best cost after each trial. */
  function falling(trials) {
    let best = null;
    return trials.map((v) => {
      if (v !== null && (best === null || v < best)) best = v;
      return best;
    });
  }

  let rows = [];

  function drawNumbers() {
    if (!moving.length) {
      rows = [];
      right.body.replaceChildren(el("p", { class: "note", textContent: S.noSearch }));
      return;
    }
    if (rows.length !== Math.min(moving.length, MOST_ROWS) || rows[0].of !== moving) build();
    rows.forEach(({ number: each, track, best, now, value }, i) => {
      const at = state?.best_shares?.[i] ?? each.share;
      best.style.left = `${100 * at}%`;
      now.style.left = `${100 * (state?.shares?.[i] ?? each.share)}%`;
      now.hidden = !running || phase !== "search";
      const shown = shortNumber(state?.values?.[i] ?? each.start);
      value.textContent = clean(shown);
      track.setAttribute(
        "aria-label",
        clean(S.numberLabel(each.name, shown, shortNumber(each.low), shortNumber(each.high), shortNumber(each.start))),
      );
      track.classList.toggle("bound", Math.min(at, 1 - at) < 1e-3);
    });
  }

  function build() {
    const list = el("div", { class: "moving" });
    rows = moving.slice(0, MOST_ROWS).map((each) => {
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
      return { of: moving, number: each, track, best, now, value };
    });
    right.body.replaceChildren(list);
    if (moving.length > MOST_ROWS)
      right.body.append(el("p", { class: "note", textContent: S.more(moving.length - MOST_ROWS) }));
  }

  // --- what came of it ---

  const takeIt = el("button", {
    class: "main",
    textContent: S.takeIt,
    title: S.takeItHint,
    onclick: () => job?.say({ take: true }),
  });
  below.bar.append(el("span", { class: "space" }), takeIt);
  let drawn = null;

  function drawReport() {
    takeIt.disabled = !report?.changes.length || !job;
    if (drawn === report && drawn !== null) return;
    drawn = report;
    if (!report) {
      below.body.replaceChildren(el("p", { class: "note", textContent: running ? S.waiting : S.noReport }));
      return;
    }
    const found = el("div", {}, table(), el("p", { textContent: report.claim }));
    for (const line of [...report.remarks, ...report.faults]) found.append(el("p", { textContent: line }));
    if (report.changes.length) found.append(difference());
    const changed = report.changes.length ? [el("div", { class: "listed" }, changes())] : [];
    below.body.replaceChildren(el("div", { class: "two" }, found, ...changed));
  }

  function table() {
    const columns = ["train", "unseen", "noisy"].filter((name) => report.rows.tuned[name]);
    const loop = Object.values(report.rows).some((row) => row.train.chatter !== null);
    const last = columns[Math.min(1, columns.length - 1)];
    const head = [
      ...columns.map((name) => S.sets[name]),
      ...(loop ? [S.rmsOf(S.sets[last]), S.chatterOf(S.sets[last])] : []),
    ];
    const body = Object.entries(report.rows).map(([name, row]) => {
      const score = row[last] ?? row.train;
      const cells = columns.map((each) =>
        row[each] ? (row[each].diverged ? S.diverge(row[each].diverged) : shown(row[each].cost)) : "–",
      );
      if (loop) cells.push(shown(score.rms), shown(score.chatter));
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
      el("caption", { textContent: S.costs(report) }),
      el("thead", {}, el("tr", {}, el("td"), ...head.map((text) => el("th", { scope: "col", textContent: text })))),
      el("tbody", {}, ...body),
    );
  }

  const shown = (value) => (value === null ? "–" : shortNumber(value));

  function changes() {
    const body = report.changes.map((each) =>
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
  }

  function difference() {
    const listing = report.diff
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
  }

  store.on("view", ask);
  store.on("text", () => {
    stale = true;
    ask();
  });
  show();
  const found = new DocumentFragment();
  found.append(top.section, left.section, right.section, below.section);
  return found;
}
