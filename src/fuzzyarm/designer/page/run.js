// Run: the text controls a plant. The loop of the server steps it; here it is drawn, pushed and tuned.

import { stage as canvasStage } from "./charts.js";
import { el, pane, shortNumber, colourOf, ticks, hue } from "./draw.js";
import { experimentFields, markField, optionsOf, textField, wordsOf } from "./experiment.js";
import { S } from "./strings.js";

const SPEEDS = [0.2, 1, 5, 60, 600];
const FIRST = ["rms", "max", "final", "chatter"];
const LEGEND = 18; // above each panel, px
const STEPS = 1000; // of a slider

const lasting = (seconds) => (seconds <= 30 ? 1 : seconds <= 1000 ? 60 : 600);

/** What of a command line needs quotes gets them. */
const quoted = (word) => (/^[\w./:=,+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

function runView(store, hand) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const state = { job: null, ready: null, paused: false, over: false, sent: "", described: "" };
  const picture = picturePane(store, (pull) => state.job?.say({ pull }));
  const curves = curvePane(store);
  const gains = gainPane(hand, (values) => state.job?.say({ gains: values }));
  const metrics = metricPane();
  const form = formPane(hand, changed);
  const view = el("div", { class: "run" }, form.section, picture.section, curves.section, gains.section, metrics.section);

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
      if (news.plants) form.offer(news);
      else if (news.end === "failed") form.note(news.message);
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
      if (before !== state.paused) form.running(state);
    },
    metrics: (news) => metrics.show(news.metrics),
    over(news) {
      state.over = true;
      form.note(S.runOver[news.how](news), news.how === "diverged");
      form.running(state);
    },
    text(news) {
      form.note(news.taken ? S.runTaken : S.runRestart);
      if (news.taken) gains.open(news.gains);
    },
    note: (news) => form.note(news.text),
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
    if (state.job && text !== state.sent) say({ text });
    state.sent = text;
    describe();
  });
  store.on("view", describe);
  let waits = false;
  store.on("left", () => { // nobody watches it
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

function formPane(hand, changed) {
  const { section, bar, body } = pane("run-form", S.run);
  let plants = [];
  let direct = ""; // the controller that asks the text, where it is a rule base
  let touched = false; // by a hand: what it chose stays
  const text = (label, hint, size) => textField(label, hint, size, changed);
  const plant = el("select", { onchange: () => chosen(true) });
  const reference = text(S.runReference, S.runReferenceHint, 22);
  const suggestions = el("datalist", { id: "run-signals" });
  reference.field.setAttribute("list", "run-signals");
  const duration = text(S.runFor, S.runForHint, 7);
  duration.field.placeholder = S.runOpenEnded;
  const trajectory = el("select", { onchange: changed });
  const payload = el("input", { type: "checkbox", onchange: changed });
  const speed = el("select", {},
    ...SPEEDS.map((each) => el("option", { value: each, textContent: S.runTimes(each) })),
    el("option", { value: "", textContent: S.runFastest }));
  const button = (words, hint) => el("button", { textContent: words, title: hint });
  const [start, pause, step, again, stop] = [
    button(S.runStart, S.runStartHint), button(S.runPause, S.runPauseHint), button(S.runStep, S.runStepHint),
    button(S.runAgain, S.runAgainHint), button(S.runStop, S.runStopHint),
  ];
  start.classList.add("main");
  start.disabled = true; // until it is known which plants there are
  const clock = el("output", { class: "clock", "aria-label": S.runTime });
  const said = el("p", { class: "said", role: "status" });
  const onArm = el("span", { class: "fields" },
    el("label", { class: "small" }, S.runTrajectory, trajectory), el("label", { class: "small" }, payload, S.runPayload));
  const elsewhere = el("span", { class: "fields" }, reference.shown, suggestions, duration.shown);
  const more = experimentFields(changed);
  const seed = text(S.runSeed, S.runSeedHint, 5);
  const line = el("code", { class: "command", tabIndex: 0 });
  const details = el("details", {}, el("summary", { textContent: S.runMoreTitle }),
    el("div", { class: "fields" }, ...more.shown, seed.shown),
    el("p", { class: "small" }, `${S.runSame} `, line));
  details.addEventListener("toggle", () => showLine());
  body.addEventListener("change", showLine);
  bar.append(start, pause, step, again, stop, el("label", { class: "small" }, S.runSpeed, speed), clock);
  body.append(
    el("div", { class: "fields" }, el("label", { class: "small" }, S.runPlant, plant), onArm, elsewhere), details, said);

  function chosen(byHand) {
    touched ||= byHand;
    const one = plants.find((each) => each.name === plant.value);
    if (!one) return;
    const arm = one.name === "arm";
    onArm.hidden = !arm;
    elsewhere.hidden = arm;
    reference.field.value = one.reference;
    const port = one.reference.split("=")[0];
    suggestions.replaceChildren(...S.runSignals.map((signal) => el("option", { value: `${port}=${signal}` })));
    speed.value = String(arm ? 1 : lasting(one.duration ?? 10));
    note(one.why, Boolean(one.why));
    if (byHand) changed();
    showLine();
  }

  function offer(news) {
    const before = JSON.stringify(plants);
    plants = news.plants;
    direct = news.direct;
    start.disabled = false;
    if (JSON.stringify(plants) === before) return;
    const kept = touched && plants.some((each) => each.name === plant.value) ? plant.value : news.chosen || plants[0].name;
    plant.replaceChildren(...plants.map((each) => el("option", {
      value: each.name, textContent: each.why ? S.runNotFitting(each.name) : each.name, title: each.why || each.summary,
    })));
    trajectory.replaceChildren(...news.trajectories.map((name) => el("option", { value: name, textContent: name })));
    if (news.trajectories.includes("pick-and-place")) trajectory.value = "pick-and-place";
    const same = kept === plant.value && before !== "[]";
    plant.value = kept;
    if (!same || !reference.field.value) chosen(false);
    if (!news.chosen) note(S.runFitsNone, true);
  }

  function asked() {
    const found = { plant: plant.value, speed: speed.value === "" ? null : Number(speed.value), ...more.asked() };
    if (plant.value === "arm") Object.assign(found, { trajectory: trajectory.value, payload: payload.checked });
    else Object.assign(found, { reference: wordsOf(reference.field.value), duration: duration.field.value.trim() });
    if (seed.field.value.trim()) found.seed = seed.field.value.trim();
    return found;
  }

  /** The same run on the command line. */
  function showLine() {
    if (!details.open) return;
    const want = asked();
    const words = ["fuzzyarm", "simulate", ...(direct ? [direct, "--rulebase", hand.file()] : [hand.file()])];
    if (want.plant !== "arm") words.push("--plant", want.plant);
    if (want.trajectory) words.push("--trajectory", want.trajectory, ...(want.payload ? ["--payload"] : []));
    words.push(...optionsOf(want));
    if (want.duration) words.push("--for", want.duration);
    if (want.seed !== undefined) words.push("--seed", String(want.seed));
    line.textContent = words.map(quoted).join(" ");
  }

  function note(words, bad = false) {
    said.textContent = words;
    said.classList.toggle("error", bad);
    said.hidden = !words;
  }

  /** Show which buttons do something. */
  function running({ job, paused, over }) {
    start.hidden = Boolean(job);
    again.hidden = !job;
    for (const each of [pause, step]) each.disabled = !job || over;
    stop.disabled = !job;
    pause.textContent = paused ? S.runResume : S.runPause;
  }

  function time(seconds, behind) {
    clock.textContent = `${shortNumber(seconds, 5)} s${behind ? ` (${S.runBehind})` : ""}`;
  }

  note("");
  const mark = (name, message) => markField({ reference: reference.field, ...more.inputs }, name, message);
  return { section, start, pause, step, again, stop, speed, offer, asked, note, mark, running, time };
}

// --- The plant ---

function picturePane(store, push) {
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
    return length > 1 ? [x / length, y / length] : [x, y];
  }

  let before = "";
  function tell() {
    const now = pull().map((each) => Number(each.toFixed(3)));
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
    if (x || y) arrow(g, at(grip()), [x, y], 0.5 * size * (top - bottom), colour("mark"));
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
    keys.set(event.key, way.map((each) => each * (event.shiftKey ? 1 : 0.4)));
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

// --- Curves over time ---

function curvePane(store) {
  const { section, bar, body } = pane("run-curves", S.runCurves);
  const { canvas, redraw } = canvasStage(store, body, draw);
  const key = el("span", { class: "key" });
  let panels = [];
  let ready = null;
  let t = [];
  let low = [];
  let high = [];
  bar.append(el("span", { class: "space" }), key);
  canvas.setAttribute("aria-label", S.runCurvesLabel);

  /** Outputs with their references, errors, and the drives of each unit. */
  function open(news) {
    ready = news;
    const count = news.tracked.length;
    const units = [...new Set(news.tracked.map((each) => each.unit))];
    panels = units.flatMap((unit) => {
      const own = news.tracked.map((each, i) => ({ ...each, i })).filter((each) => each.unit === unit);
      return [
        {
          title: S.runOutputs, unit,
          lines: own.flatMap(({ name, i }) => [
            { name: "", column: i, colour: null }, // wanted
            { name, column: count + i, colour: i },
          ]),
        },
        { title: S.runError, unit, lines: own.map(({ name, i }) => ({ name, column: 2 * count + i, colour: i })) },
      ];
    });
    const drives = news.drives.map((each, i) => ({ ...each, column: 3 * count + i, colour: i }));
    for (const unit of new Set(drives.map((each) => each.unit))) {
      panels.push({ title: S.runDrives, unit, lines: drives.filter((each) => each.unit === unit) });
    }
    t = [];
    low = Array.from({ length: 3 * count + drives.length }, () => []);
    high = low.map(() => []);
    redraw();
  }

  function add(news) {
    // A run that begins again begins at 0.
    t.push(...news.t);
    news.low.forEach((column, k) => {
      low[k].push(...column);
      high[k].push(...(news.high ?? news.low)[k]);
    });
    // What has left the window goes, now and then.
    const first = t[t.length - 1] - ready.window;
    if (t[0] < first - 0.5 * ready.window) {
      const gone = t.findIndex((each) => each >= first);
      for (const each of [t, ...low, ...high]) each.splice(0, gone);
    }
    redraw();
  }

  function draw({ g, width, height }) {
    if (!ready) return;
    const last = t[t.length - 1] ?? 0;
    const end = Math.max(ready.window, last);
    const [begin, foot, gap] = [end - ready.window, 18, 6];
    const each = (height - foot) / panels.length;
    const [left, right] = [52, width - 16];
    const x = (time) => left + ((time - begin) / ready.window) * (right - left);
    g.font = "11px system-ui, sans-serif";
    const first = Math.max(0, t.findIndex((time) => time >= begin) - 1);
    panels.forEach((panel, p) => drawPanel(g, panel, [left, right, p * each + LEGEND, (p + 1) * each - gap], x, first));
    g.fillStyle = colourOf("--soft");
    g.textAlign = "center";
    for (const tick of ticks(begin, end, width / 90)) g.fillText(`${shortNumber(tick)} s`, x(tick), height - 4);
  }

  function drawPanel(g, panel, [left, right, top, bottom], x, first) {
    const soft = colourOf("--soft");
    const [from, to] = span(panel, first);
    const y = (value) => bottom - ((value - from) / (to - from)) * (bottom - top);
    g.save();
    g.strokeStyle = colourOf("--line");
    g.lineWidth = 1;
    g.textAlign = "right";
    g.fillStyle = soft;
    for (const tick of ticks(from, to, Math.max(3, (bottom - top) / 24))) {
      g.beginPath();
      g.moveTo(left, y(tick));
      g.lineTo(right, y(tick));
      g.stroke();
      g.fillText(shortNumber(tick), left - 5, y(tick) + 4);
    }
    g.beginPath();
    g.rect(left, top - 2, right - left, bottom - top + 4);
    g.clip();
    for (const { low: floor, high: ceiling } of panel.lines) {
      for (const limit of [floor, ceiling]) {
        if (limit === null || limit === undefined) continue;
        stroke(g, colourOf("--lit"), 1, [5, 4], () => {
          g.moveTo(left, y(limit));
          g.lineTo(right, y(limit));
        });
      }
    }
    for (const line of panel.lines) {
      const wanted = line.colour === null;
      const tint = wanted ? soft : tone(line.colour);
      stroke(g, tint, wanted ? 1.2 : 1.7, wanted ? [4, 3] : [], () => curve(g, line.column, x, y, first));
    }
    g.restore();
    g.textAlign = "left";
    let at = left;
    for (const [words, tint] of [[`${panel.title}${panel.unit && panel.unit !== "1" ? `, ${panel.unit}` : ""}:`, soft],
      ...panel.lines.filter((line) => line.name).map((line) => [line.name, tone(line.colour)])]) {
      g.fillStyle = tint;
      g.fillText(words, at, top - 5);
      at += g.measureText(words).width + 8;
    }
  }

  /** The colours of lines: those of terms, as a canvas takes them. */
  function tone(index) {
    const probe = key;
    probe.style.color = hue(index);
    return getComputedStyle(probe).color;
  }

  function stroke(g, tint, width, dashes, way) {
    g.strokeStyle = tint;
    g.lineWidth = width;
    g.setLineDash(dashes);
    g.beginPath();
    way();
    g.stroke();
    g.setLineDash([]);
  }

  function curve(g, column, x, y, first) {
    let before = false;
    for (let i = first; i < t.length; i++) {
      const [a, b] = [low[column][i], high[column][i]];
      if (a === null || b === null) {
        before = false;
        continue;
      }
      const px = x(t[i]);
      if (before) g.lineTo(px, y(b));
      else g.moveTo(px, y(b));
      if (a !== b) g.lineTo(px, y(a));
      before = true;
    }
  }

  /** Between what a panel goes: what is seen, and the limits. */
  function span(panel, first) {
    let [from, to] = [Infinity, -Infinity];
    const take = (value) => {
      if (value === null || value === undefined) return;
      from = Math.min(from, value);
      to = Math.max(to, value);
    };
    for (const line of panel.lines) {
      for (let i = first; i < t.length; i++) {
        take(low[line.column][i]);
        take(high[line.column][i]);
      }
      take(line.low);
      take(line.high);
    }
    if (!(to >= from)) return [-1, 1];
    if (to - from < 1e-9 * Math.max(1, Math.abs(to))) return [from - 1, to + 1];
    const room = 0.08 * (to - from);
    return [from - room, to + room];
  }

  return { section, open, add };
}

// --- Gains ---

function gainPane(hand, move) {
  const { section, body } = pane("run-gains", S.runGains);
  const list = el("div", { class: "gains" });
  let shown = "";
  let rows = [];
  body.append(list);
  list.append(el("p", { class: "note", textContent: S.runGainsNote }));

  /** Between 0 and 1 where a value is in its range. */
  const share = ({ low, high, log }, value) => (log
    ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low));
  const back = ({ low, high, log }, at) => (log ? low * (high / low) ** at : low + (high - low) * at);

  function open(gains) {
    const names = JSON.stringify(gains.map(({ name, values, low, high, log }) => [name, values.length, low, high, log]));
    if (names !== shown) {
      shown = names;
      rows = gains.flatMap((gain) => gain.values.map((_, k) => row(gain, k)));
      list.replaceChildren(...(rows.length ? rows.map((each) => each.shown) : [
        el("p", { class: "note", textContent: S.runNoGains })]));
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
      type: "range", min: 0, max: STEPS, step: 1, "aria-label": name,
      oninput: () => moved(Number(back(gain, range.value / STEPS).toPrecision(4)), false),
      onchange: () => moved(Number(back(gain, range.value / STEPS).toPrecision(4)), true),
    });
    const number = el("input", {
      type: "text", inputMode: "decimal", "aria-label": `${name}: ${S.value}`,
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
      move({ [gain.name]: gain.values });
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
  let units = {};
  let drive = "";
  body.tabIndex = 0; // it scrolls
  body.append(table);

  function open(ready) {
    units = ready.tracked.map((each) => each.unit);
    drive = ready.drives[0]?.unit ?? "";
    table.replaceChildren();
  }

  function show(metrics) {
    const outputs = Object.keys(metrics);
    if (!outputs.length) return;
    const names = Object.keys(metrics[outputs[0]]);
    const sorted = [...FIRST, ...names.filter((name) => !FIRST.includes(name))];
    const unit = (name, i) => ({ rms: units[i], max: units[i], final: units[i], overshoot: units[i],
      rise: "s", settling: "s", chatter: drive, effort: drive })[name] ?? "";
    const cell = (name, output, i) => {
      const value = metrics[output][name];
      return el("td", { textContent: value === null ? "–" : `${shortNumber(value)} ${unit(name, i)}`.trim() });
    };
    table.replaceChildren(
      el("caption", { class: "unseen", textContent: S.runMetrics }),
      el("thead", {}, el("tr", {}, el("th", { scope: "col", textContent: S.runErrorOf }),
        ...outputs.map((output) => el("th", { scope: "col", textContent: output })))),
      el("tbody", {}, ...sorted.map((name) => el("tr", { class: FIRST.includes(name) ? "first" : "" },
        el("th", { scope: "row", textContent: S.runMetric[name] ?? name, title: S.runMetricHint[name] ?? "" }),
        ...outputs.map((output, i) => cell(name, output, i))))),
    );
  }

  return { section, open, show };
}
