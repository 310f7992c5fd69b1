// Tables: the cells of one as a grid, and how far a table is from direct inference.

import { choice, clean, el, eachFrame, heat, pane, shortNumber } from "./draw.js";
import { drawCells, drawLines, drawPlane, rangeOfValues } from "./plane.js";
import { S } from "./strings.js";

/** Whether a file, by its name, is a table. */
export const isTable = (name) => /\.lut$/i.test(name);

/**
 * The cells of a table, page by page; a cell leads to its number in the text.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function cellsPane(store, hand) {
  const { section, bar, body } = pane("cells", S.cells);
  let page = [];
  let asked = 0;
  section.hidden = true;

  async function look() {
    section.hidden = !isTable(hand.file());
    if (section.hidden || store.view !== "table") return;
    const mine = ++asked;
    const { table } = await hand.askNow("table", { page });
    if (mine !== asked) return;
    if (table) show(table);
    else section.classList.add("stale");
  }

  function show(table) {
    section.classList.remove("stale");
    ({ page } = table);
    while (bar.childNodes.length > 1) bar.lastChild.remove();
    bar.append(el("span", { class: "space" }));
    const outer = table.axes.slice(0, -2);
    outer.forEach((axis, k) => {
      const levels = axis.levels.map((x, i) => [String(i), shortNumber(x, 6)]);
      bar.append(
        choice(axis.name, levels, String(page[k]), (i) => {
          page = page.with(k, Number(i));
          look();
        }),
      );
    });
    body.replaceChildren(words(table), grid(table));
  }

  function words(table) {
    const axes = table.axes.map((axis) =>
      S.axisLevels(
        axis.name,
        axis.levels.length,
        shortNumber(axis.levels[0], 6),
        shortNumber(axis.levels.at(-1), 6),
        axis.bins,
      ),
    );
    const thin =
      table.columns.length < table.axes.at(-1).levels.length ||
      table.rows.length < (table.axes.at(-2)?.levels.length ?? 1);
    return el("p", {
      class: "note",
      textContent: [
        S.tableOf(table.output, table.cells, table.mode),
        table.description,
        ...axes,
        thin ? S.thinned : "",
        ...table.says
          .filter(([key]) => key === "source" || key.startsWith("error"))
          .map(([key, value]) => `${key}: ${value}`),
      ]
        .filter(Boolean)
        .join(" · "),
    });
  }

  function grid(table) {
    const across = table.axes.at(-1);
    const down = table.axes.at(-2);
    const corner = down ? `${down.name} \\ ${across.name}` : across.name;
    const head = el("tr", {}, el("th", { scope: "col", textContent: corner }));
    for (const j of table.columns)
      head.append(el("th", { scope: "col", textContent: shortNumber(across.levels[j], 5) }));
    const rows = table.rows.map((i, k) => {
      const label = down ? shortNumber(down.levels[i], 5) : table.output;
      const line = el("tr", {}, el("th", { scope: "row", textContent: label }));
      table.values[k].forEach((value, m) => {
        const cell = [...page, ...(down ? [i] : []), table.columns[m]];
        const shown = el("button", {
          textContent: shortNumber(value, 5),
          tabIndex: k || m ? -1 : 0,
          onclick: () => goTo(cell),
        });
        [shown.style.background, shown.style.color] = heat((value - table.low) / (table.high - table.low || 1));
        line.append(el("td", {}, shown));
      });
      return line;
    });
    const made = el(
      "table",
      { class: "cells" },
      el("caption", { class: "unseen", textContent: S.tableOf(table.output, table.cells, table.mode) }),
      el("thead", {}, head),
      el("tbody", {}, ...rows),
    );
    made.addEventListener("keydown", (event) => step(event, made));
    return made;
  }

  /** Arrow keys go from cell to cell; one of them is in the order of the Tab key. */
  function step(event, made) {
    const [dy, dx] = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key] ?? [];
    const held = /** @type {HTMLElement} */ (document.activeElement);
    const td = held.closest?.("td");
    if (dy === undefined || !td) return;
    event.preventDefault();
    const next =
      made.tBodies[0].rows[/** @type {HTMLTableRowElement} */ (td.parentElement).sectionRowIndex + dy]?.cells[
        td.cellIndex + dx
      ]?.querySelector("button");
    if (!next) return;
    held.tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
  }

  async function goTo(cell) {
    const { range } = await hand.askNow("table-cell", { cell });
    if (range) hand.goTo(range[0]);
  }

  store.on("view", look);
  store.on("text", look);
  return section;
}

/**
 * How far a table is from the rules: a map, the worst point, and what is proved of each cell.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function errorPane(store, hand) {
  const { section, bar, body } = pane("accuracy", S.tableError);
  const canvas = el("canvas", { role: "img", "aria-label": S.tableError });
  const state = el("p", { class: "note", role: "status" });
  const worst = el("p", { class: "worst" });
  const lines = el("pre", { class: "printed", tabIndex: 0, hidden: true, "aria-label": S.report });
  const wanted = { levels: "", mode: "", output: "", x: "", y: "" };
  const side = el("div", { class: "side" }, worst, state, lines);
  body.append(el("div", { class: "beside" }, canvas, side));
  let job = null;
  let found = null; // { map, cells, worst }
  let shown = "difference";
  let built = "";
  const go = el("button", { textContent: S.measure, onclick: run });

  function build() {
    const outputs = isTable(hand.file()) ? [] : (store.scene?.outputs ?? []).map((each) => each.name);
    const names = found?.map.names ?? [];
    const key = JSON.stringify([isTable(hand.file()), outputs, names, shown]);
    if (key === built) return;
    built = key;
    while (bar.childNodes.length > 1) bar.lastChild.remove();
    bar.append(el("span", { class: "space" }));
    const set = (name) => (value) => {
      wanted[name] = value;
      run();
    };
    if (outputs.length > 1)
      bar.append(
        choice(
          S.shown,
          outputs.map((n) => [n, n]),
          wanted.output || outputs[0],
          set("output"),
        ),
      );
    if (!isTable(hand.file())) {
      const levels = el("input", {
        type: "text",
        class: "short",
        value: wanted.levels,
        placeholder: S.asInFile,
        title: S.levelsHint,
        onchange: () => set("levels")(levels.value),
      });
      bar.append(el("label", { class: "small" }, S.options.levels, levels));
    }
    bar.append(
      choice(
        S.options.mode,
        [
          ["", S.asInFile],
          ["bins", "bins"],
          ["nearest", "nearest"],
          ["linear", "linear"],
        ],
        wanted.mode,
        set("mode"),
      ),
    );
    if (names.length > 2) {
      const axes = names.map((n) => [n, n]);
      bar.append(choice(S.horizontal, axes, found.map.x, set("x")), choice(S.vertical, axes, found.map.y, set("y")));
    }
    bar.append(
      choice(
        S.view,
        [
          ["difference", S.signed],
          ["proved", S.provedCells],
        ],
        shown,
        (value) => {
          shown = value;
          redraw();
        },
      ),
      go,
    );
  }

  async function run() {
    job?.stop();
    if (store.view !== "table" || !hand.file()) return;
    state.classList.remove("error");
    state.textContent = S.working;
    if (!(await hand.settled())) {
      state.textContent = S.gone;
      return;
    }
    const { levels, mode, output, x, y } = wanted;
    const at = Object.fromEntries((store.scene?.inputs ?? []).map((each, i) => [each.name, store.point[i]]));
    const mine = hand.start("table-error", { options: { levels, mode, output }, axes: { x, y, at } }, (news) => {
      if (mine === job || !job) hear(news);
    });
    job = mine;
  }

  function hear(news) {
    if (news.map) {
      found = { map: news.map, cells: [], worst: null };
      build();
    }
    if (news.doing) state.textContent = clean(`${news.doing} …`);
    if (news.cells) {
      found.cells.push(...news.cells);
      state.textContent = S.provedSoFar(news.done, news.of);
    }
    if (news.lines) {
      lines.textContent = clean(news.lines.join("\n"));
      lines.hidden = !news.lines.length;
      found.worst = news.worst;
      worst.textContent = clean(worstWords(news.worst, found.map.output));
    }
    if (news.unproved) found.unproved = news.unproved;
    if (news.end) ended(news);
    redraw();
  }

  function ended(news) {
    job = null;
    if (news.end === "failed") {
      state.textContent = clean(news.message);
      state.classList.add("error");
      if (!found?.worst) worst.textContent = "";
    } else if (news.end === "done") state.textContent = clean(found.unproved ?? S.provedAll);
  }

  function worstWords({ at, table, direct, difference, proved, mode }, output) {
    const where = Object.entries(at)
      .map(([name, x]) => `${name} = ${shortNumber(x, 5)}`)
      .join(", ");
    return S.worstAt(
      output,
      mode,
      where,
      shortNumber(table, 6),
      shortNumber(direct, 6),
      shortNumber(difference, 6),
      proved === null ? null : shortNumber(proved, 7),
    );
  }

  function draw() {
    if (!found || store.view !== "table") return;
    const { map } = found;
    const [across, up] = [map.levels[map.x], map.levels[map.y || map.x]];
    const place = found.worst && inSlice(map, found.worst.at);
    const title = S.errorTitle(
      map.output,
      map.mode,
      Object.entries(map.held)
        .map(([n, x]) => `${n} = ${shortNumber(x)}`)
        .join(", "),
    );
    if (shown === "proved" && found.cells.length) {
      const cells = found.cells.map(cellOf(map));
      const high = Math.max(...cells.map(([, , value]) => value)) || 1;
      drawCells(canvas, {
        title: `${title}: ${S.provedCells} (≤ ${shortNumber(high, 6)})`,
        across,
        up: map.y ? up : [0, 1],
        cells,
        high,
        x: map.x,
        y: map.y,
        worst: map.y ? place : null,
      });
    } else {
      const [low, high] = rangeOfValues([map.z], true);
      const words = {
        title: `${title}: ${S.signed}, ±${shortNumber(high)}`,
        low,
        high,
        x: map.x,
        y: map.y || map.output,
      };
      if (map.y) drawPlane(canvas, { ...words, ...map, y: map.y, signed: true, grid: [across, up], worst: place });
      else drawLines(canvas, { ...words, xs: map.xs, lines: [map.z], worst: found.worst?.at[map.x] ?? null });
    }
    canvas.setAttribute("aria-label", `${title}. ${worst.textContent}`);
  }

  /** A proved cell as column, row and value: its numbers come in the order of the axes. */
  const cellOf = (map) => (cell) => {
    const value = cell.at(-1);
    if (!map.y) return [cell[0], 0, value];
    const [column, row] = [map.x, map.y].map((name) => cell[map.names.indexOf(name)]);
    return [column, row, value];
  };

  /** @returns {Page.Pair | null} */
  const inSlice = (map, at) => (Object.keys(map.held).length ? null : [at[map.x], at[map.y]]);

  const redraw = eachFrame(() => {
    build();
    draw();
  });
  store.on("view", () => {
    build();
    if (store.view === "table" && !found && !job) run();
    else redraw();
  });
  store.on("text", () => {
    if (!found) return;
    go.textContent = S.measureAgain;
    section.classList.add("stale");
  });
  go.addEventListener("click", () => section.classList.remove("stale"));
  for (const name of ["theme", "scene"]) store.on(name, redraw);
  new ResizeObserver(redraw).observe(body);
  return section;
}

export const TABLE = {
  name: "table",
  title: S.tables,
  drawn: false,
  panes: [cellsPane, errorPane],
  splits: [{ key: "table-rows", vertical: false, at: 1, usual: 0.4 }],
};
