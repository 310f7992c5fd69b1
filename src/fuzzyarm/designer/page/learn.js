// Learn: an SOC table that grows cell by cell while passes run, its visits, the error of each pass.

import { clean, el, pane, heat, shortNumber, SHADES } from "./draw.js";
import { drawChart, field, inks, number, refill, stage } from "./charts.js";
import { confirm } from "./dialogs.js";
import { markField } from "./experiment.js";
import { S } from "./strings.js";

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
  let facts = null; // what may be trained where
  let job = null; // the training; one that is stopped is kept, to be saved
  let begin = null; // of the training: axes, levels
  let news = null; // its last word
  let errors = []; // RMS of each pass, for each axis
  let axis = 0;
  let cell = null; // [row, column] that is read out
  let stale = true; // whether the facts are those of an older text

  // --- what may be asked ---

  const top = pane("learning", S.learn);
  const controller = el("select", { onchange: () => choosePlants() });
  const plant = el("select", { onchange: () => chooseGrounds() });
  const trajectory = el("select");
  const payload = el("input", { type: "checkbox" });
  const load = el("label", { class: "check" }, payload, S.payload);
  const reference = el("input", { type: "text", size: 16 });
  const seconds = el("input", { type: "number", min: 0.001, step: "any", placeholder: S.usual });
  const start = el("select");
  const passes = number(6, 1, 10000);
  const rate = el("input", { type: "number", min: 0, max: 10, step: "any", placeholder: S.usual });
  const fields = el("div", { class: "fields" });
  const grounds = {
    along: [field(S.trajectory, trajectory), load],
    other: [field(S.reference, reference, S.referenceHint), field(S.seconds, seconds)],
  };
  fields.append(
    field(S.controller, controller),
    field(S.plant, plant),
    ...grounds.along,
    ...grounds.other,
    field(S.beginWith, start),
    field(S.passes, passes),
    field(S.rate, rate, S.rateHint),
  );
  const speed = el("select", { onchange: () => job?.say({ speed: speed.value }) });
  refill(speed, [
    ["watch", S.watch],
    ["fast", S.fast],
  ]);
  const go = el("button", { class: "main", textContent: S.start, onclick: () => pressed() });
  const step = el("button", { textContent: S.onePass, title: S.onePassHint, onclick: () => stepped() });
  const stop = el("button", { textContent: S.stop, disabled: true, onclick: () => job?.say({ go: "stop" }) });
  const name = el("input", { type: "text", value: "learned.lut", size: 14, "aria-label": S.tableName });
  const save = el("button", {
    textContent: S.saveTable,
    disabled: true,
    onclick: () => job?.say({ save: name.value }),
  });
  const said = el("p", { class: "said", role: "status" });
  const actions = el(
    "div",
    { class: "actions" },
    go,
    step,
    stop,
    field(S.speed, speed),
    el("span", { class: "space" }),
    name,
    save,
  );
  top.body.append(fields, actions, said);

  function choosePlants() {
    const text = facts?.texts.find((each) => each.name === controller.value);
    refill(
      plant,
      (text?.plants ?? []).map((each) => [each.name, each.name]),
    );
    chooseGrounds();
  }

  function chooseGrounds() {
    const text = facts?.texts.find((each) => each.name === controller.value);
    const known = text?.plants.find((each) => each.name === plant.value);
    const moves = Boolean(known?.trajectories.length);
    for (const each of grounds.along) each.hidden = !moves;
    for (const each of grounds.other) each.hidden = moves;
    load.hidden = !known?.carries;
    refill(
      trajectory,
      (known?.trajectories ?? []).map((each) => [each, each]),
    );
    reference.placeholder = known?.reference ?? "";
  }

  function ask() {
    if (store.view !== LEARN.name || !stale) return;
    stale = false;
    hand.start("learnable", {}, (message) => {
      if (message.end === "failed") said.textContent = clean(message.field ? "" : message.message);
      if (message.end) return;
      facts = message;
      refill(
        controller,
        facts.texts.map((each) => [each.name, each.name || S.thisText]),
      );
      refill(start, [["", S.asTheText], ...facts.tables.map((each) => [each, each])]);
      choosePlants();
      if (!job) said.textContent = clean(facts.own ? S.learnsItself : S.learnsNot);
    });
  }

  // --- the training ---

  const mode = () => (job ? (news?.mode ?? "run") : "none");

  function pressed() {
    if (mode() === "run") job.say({ go: "pause" });
    else if (mode() === "pause") job.say({ go: "run" });
    else train(false);
  }

  function stepped() {
    if (mode() === "pause") job.say({ go: "step" });
    else train(true);
  }

  function train(oneByOne) {
    job?.stop();
    begin = news = cell = null;
    errors = [];
    said.textContent = S.preparing;
    markField({ reference }, "");
    const mine = (job = hand.start(
      "learn",
      {
        controller: controller.value,
        plant: plant.value,
        trajectory: trajectory.value,
        payload: payload.checked,
        reference: reference.value.trim(),
        seconds: seconds.value,
        start: start.value,
        passes: passes.value,
        step: oneByOne,
        rate: rate.value,
        speed: speed.value,
      },
      (message) => {
        if (job === mine) hear(message); // an older one may still speak
      },
    ));
    show();
  }

  function hear(message) {
    if (message.end) {
      job = null;
      if (message.end === "failed") said.textContent = clean(message.field ? "" : message.message);
    } else if (message.begin) {
      begin = message.begin;
      axis = 0;
      refill(
        which,
        begin.axes.map((each, i) => [String(i), each]),
      );
      whichLabel.hidden = begin.axes.length < 2;
      which.value = "0";
    } else if (message.saved) said.textContent = clean(S.tableSaved(message.saved));
    else if (message.unsaved) said.textContent = clean(message.unsaved);
    else if (message.exists) replace(message.exists);
    else if (message.mode) take(message);
    show();
    if (message.end === "failed") markField({ reference }, message.field ?? "", message.message);
  }

  async function replace(existing) {
    const sure = await confirm(S.replaceFile(existing), S.replace);
    if (sure) job?.say({ save: existing, replace: true });
    save.focus();
  }

  function take(message) {
    const turned = message.mode !== mode();
    news = message;
    errors.push(...message.errors);
    // A line for each pass is enough to listen to; pictures change oftener.
    if (message.complete || turned) said.textContent = clean(S.learning(message, begin));
  }

  function show() {
    const now = mode();
    go.textContent = clean(now === "run" ? S.pause : now === "pause" ? S.goOn : S.start);
    stop.disabled = now !== "run" && now !== "pause";
    step.disabled = now === "run";
    save.disabled = !job || !news || now === "run";
    for (const input of fields.querySelectorAll("input, select")) input.disabled = now === "run" || now === "pause";
    describe();
    for (const each of [values, visits, curve]) each.redraw();
  }

  // --- pictures ---

  const left = pane("table", S.table);
  const right = pane("visits", S.visits);
  const below = pane("errors", S.errorOfPasses);
  const which = el("select", {
    onchange: () => {
      axis = Number(which.value);
      cell = null;
      show();
    },
  });
  const whichLabel = el("label", { class: "small", hidden: true }, S.axis, which);
  const readout = el("span", { class: "readout", "aria-live": "polite" });
  const moment = el("span", { class: "readout" });
  left.bar.append(el("span", { class: "space" }), moment, whichLabel);
  right.bar.append(el("span", { class: "space" }), readout);
  const values = stage(store, left.body, (paper) => cells(paper, paintValue));
  const visits = stage(store, right.body, (paper) => cells(paper, paintVisits));
  const curve = stage(store, below.body, (paper) =>
    drawChart(
      paper,
      begin ? begin.axes.map((each, i) => ({ name: each, values: errors.map((row) => row[i] ?? null) })) : [],
      { across: S.pass, up: S.rms(news?.units[0] ?? ""), whole: true },
    ),
  );
  for (const { canvas } of [values, visits]) {
    canvas.tabIndex = 0;
    canvas.addEventListener("keydown", moved);
    canvas.addEventListener("pointermove", pointed);
    canvas.addEventListener("focus", () => {
      cell ??= [0, 0];
      readOut();
    });
  }

  const shape = () => [begin.down?.levels.length ?? 1, begin.across.levels.length];

  function describe() {
    const table = news?.tables[axis];
    moment.textContent = clean(news ? S.moment(news) : "");
    const label = table ? S.tableLabel(begin.axes[axis], table, shape()[0] * shape()[1]) : S.noTraining;
    values.canvas.setAttribute("aria-label", clean(label));
    visits.canvas.setAttribute(
      "aria-label",
      clean(table ? S.visitsLabel(begin.axes[axis], Math.max(...table.visits)) : S.noTraining),
    );
    curve.canvas.setAttribute("aria-label", clean(S.errorsLabel(errors, begin, news)));
    readOut();
  }

  function readOut() {
    const table = news?.tables[axis];
    if (!table || !cell) {
      readout.textContent = "";
      return;
    }
    const at = cell[0] * shape()[1] + cell[1];
    const down = begin.down ? `${begin.down.name} = ${shortNumber(begin.down.levels[cell[0]])}, ` : "";
    const place = `${down}${begin.across.name} = ${shortNumber(begin.across.levels[cell[1]])}`;
    readout.textContent = clean(S.cell(place, shortNumber(table.values[at]), table.visits[at]));
    values.redraw();
    visits.redraw();
  }

  const STEPS = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] };

  function moved(event) {
    const way = STEPS[event.key];
    if (!way || !begin) return;
    event.preventDefault();
    const [rows, columns] = shape();
    cell = [
      Math.min(rows - 1, Math.max(0, (cell?.[0] ?? 0) + way[0])),
      Math.min(columns - 1, Math.max(0, (cell?.[1] ?? 0) + way[1])),
    ];
    readOut();
  }

  function pointed(event) {
    if (!begin) return;
    const box = event.currentTarget.getBoundingClientRect();
    const { x0, y0, w, h } = grid(box.width, box.height);
    const [rows, columns] = shape();
    const found = [Math.floor((event.clientY - box.top - y0) / h), Math.floor((event.clientX - box.left - x0) / w)];
    if (found[0] < 0 || found[1] < 0 || found[0] >= rows || found[1] >= columns) return;
    if (cell && found[0] === cell[0] && found[1] === cell[1]) return;
    cell = found;
    readOut();
  }

  function grid(width, height) {
    const [rows, columns] = shape();
    return {
      x0: ROOM.left,
      y0: ROOM.top,
      w: (width - ROOM.left - ROOM.right) / columns,
      h: (height - ROOM.top - ROOM.bottom) / rows,
    };
  }

  /** Draw a cell for each pair of levels; those that were never visited are hatched. */
  function cells({ g, width, height }, paint) {
    const colours = inks();
    g.font = "11px system-ui, sans-serif";
    if (!begin || !news) {
      g.fillStyle = colours.soft;
      g.fillText(S.noTraining, 12, 22);
      return;
    }
    const [rows, columns] = shape();
    const { x0, y0, w, h } = grid(width, height);
    const table = news.tables[axis];
    const most = Math.max(1, ...table.visits);
    for (let i = 0; i < rows; i++) {
      for (let j = 0; j < columns; j++) {
        const at = i * columns + j;
        const box = { x: x0 + j * w, y: y0 + i * h, w: w - 1, h: h - 1 };
        const never = table.visits[at] === 0;
        if (never) hatch(g, box, colours);
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
    if (cell) {
      g.strokeStyle = colours.lines[1];
      g.lineWidth = 2;
      g.strokeRect(x0 + cell[1] * w, y0 + cell[0] * h, w - 1, h - 1);
    }
    labels(g, width, height, colours);
  }

  function labels(g, width, height, colours) {
    const { x0, y0, w, h } = grid(width, height);
    g.fillStyle = colours.soft;
    g.textBaseline = "middle";
    g.textAlign = "right";
    const every = (count, room, wanted) => Math.max(1, Math.ceil((count * wanted) / Math.max(room, 1)));
    if (begin.down) {
      const skip = every(begin.down.levels.length, height - ROOM.top - ROOM.bottom, 13);
      begin.down.levels.forEach((level, i) => {
        if (i % skip === 0) g.fillText(shortNumber(level, 3), x0 - 5, y0 + (i + 0.5) * h);
      });
      g.save();
      g.translate(9, (height - ROOM.bottom) / 2);
      g.rotate(-Math.PI / 2);
      g.textAlign = "center";
      g.fillText(clean(begin.down.name), 0, 0);
      g.restore();
    }
    g.textAlign = "center";
    g.textBaseline = "top";
    const skip = every(begin.across.levels.length, width - ROOM.left - ROOM.right, 30);
    begin.across.levels.forEach((level, j) => {
      if (j % skip === 0) g.fillText(shortNumber(level, 3), x0 + (j + 0.5) * w, height - ROOM.bottom + 4);
    });
    g.fillText(clean(begin.across.name), (x0 + width) / 2, height - 14);
  }

  function hatch(g, box, colours) {
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
  }

  function paintValue(value, _visits, _most, never, colours) {
    const words = [shortNumber(value, 2), shortNumber(value, 1), value.toFixed(1)];
    if (never) return [null, colours.soft, value === 0 ? [] : words];
    const span = begin.high - begin.low;
    const [fill, ink] = heat(span > 0 ? (value - begin.low) / span : 0.5);
    return [fill, ink, words];
  }

  function paintVisits(_value, count, most, never) {
    if (never) return [null, "", []];
    const share = Math.log10(1 + count) / Math.log10(1 + most);
    const [r, g, b] = SHADES[Math.round(255 * share)];
    return [
      `rgb(${r} ${g} ${b})`,
      share > 0.6 ? "#000" : "#fff",
      [String(count), `${(count / 1000).toFixed(count < 10000 ? 1 : 0)}k`],
    ];
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
