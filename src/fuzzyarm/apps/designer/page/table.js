// Tables: the cells of one as a grid, and how far a table is from direct inference.

import {
  ARROWS,
  choice,
  clean,
  eachFrame,
  el,
  heat,
  pairsOf,
  placeWords,
  printed,
  shortNumber,
  space,
  tableOf,
} from "./draw.js";
import { axisOf, cellsPanel, gridOf } from "./geometry/panel.js";
import { drawPanel, levelAt, markAt } from "./panel.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { Task } from "./task.js";

/** Whether a file, by its name, is a table. */
export const isTable = (name) => /\.lut$/i.test(name);

/** Why a view has nothing to do with a file; empty where it has. */
export const noTables = ({ file }) => (isTable(file()) ? S.noTables : "");

/** The cells of a table, page by page; a cell leads to its number in the text. */
class CellsPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "cells", S.cells);
    this.page = [];
    this.asked = 0;
    this.section.hidden = true;

    this.store.on("view", this.look);
    this.store.on("text", this.look);
  }

  look = async () => {
    this.section.hidden = !isTable(this.hand.file());
    if (this.section.hidden || this.store.view !== "table") return;
    const mine = ++this.asked;
    const { table } = await this.hand.askNow("table", { page: this.page });
    if (mine !== this.asked) return;
    if (table) this.show(table);
    else this.section.classList.add("stale");
  };

  show = (table) => {
    this.section.classList.remove("stale");
    ({ page: this.page } = table);
    const pages = table.axes.slice(0, -2).map((axis, k) => {
      const levels = axis.levels.map((x, i) => [String(i), shortNumber(x, 6)]);
      return choice(axis.name, levels, String(this.page[k]), (i) => {
        this.page = this.page.with(k, Number(i));
        this.look();
      });
    });
    this.setTools(space(), ...pages);
    this.body.replaceChildren(this.words(table), this.grid(table));
  };

  words = (table) => {
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
  };

  grid = (table) => {
    const across = table.axes.at(-1);
    const down = table.axes.at(-2);
    const corner = down ? `${down.name} \\ ${across.name}` : across.name;
    const cell = (value, k, m) => {
      const at = [...this.page, ...(down ? [table.rows[k]] : []), table.columns[m]];
      const shown = el("button", {
        textContent: shortNumber(value, 5),
        tabIndex: k || m ? -1 : 0,
        onclick: () => this.goTo(at),
      });
      [shown.style.background, shown.style.color] = heat((value - table.low) / (table.high - table.low || 1));
      return shown;
    };
    const made = tableOf({
      class: "cells",
      caption: el("span", { class: "unseen", textContent: S.tableOf(table.output, table.cells, table.mode) }),
      head: [corner, ...table.columns.map((j) => shortNumber(across.levels[j], 5))],
      rows: table.rows.map((i, k) => [
        down ? shortNumber(down.levels[i], 5) : table.output,
        ...table.values[k].map((value, m) => cell(value, k, m)),
      ]),
    });
    made.addEventListener("keydown", (event) => this.step(event, made));
    return made;
  };

  /** Arrow keys go from cell to cell; one of them is in the order of the Tab key. */
  step = (event, made) => {
    const [right, up] = ARROWS[event.key] ?? [];
    const held = /** @type {HTMLElement} */ (document.activeElement);
    const td = held.closest?.("td");
    if (right === undefined || !td) return;
    event.preventDefault();
    const next =
      made.tBodies[0].rows[/** @type {HTMLTableRowElement} */ (td.parentElement).sectionRowIndex - up]?.cells[
        td.cellIndex + right
      ]?.querySelector("button");
    if (!next) return;
    held.tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
  };

  goTo = async (cell) => {
    const { range } = await this.hand.askNow("table-cell", { cell });
    if (range) this.hand.goTo(range[0]);
  };
}

/** How far a table is from the rules: a map, the worst point, and what is proved of each cell. */
class ErrorPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "accuracy", S.tableError);
    const { body } = this;
    this.canvas = el("canvas", { role: "img", "aria-label": S.tableError });
    this.state = el("p", { class: "note", role: "status" });
    this.worst = el("p", { class: "worst" });
    this.lines = el("pre", { class: "printed", tabIndex: 0, hidden: true, "aria-label": S.report });
    this.wanted = { levels: "", mode: "", output: "", x: "", y: "" };
    const side = el("div", { class: "side" }, this.worst, this.state, this.lines);
    body.append(el("div", { class: "beside" }, this.canvas, side));
    this.task = new Task(hand, "table-error");
    this.found = null; // { map, cells, worst }
    this.shown = "difference";
    this.built = "";
    this.go = el("button", { textContent: S.measure, onclick: this.run });

    this.redraw = eachFrame(() => {
      this.build();
      this.draw();
    });
    this.store.on("view", () => {
      this.build();
      if (this.store.view === "table" && !this.found && !this.task.job) this.run();
      else this.redraw();
    });
    this.store.on("text", () => {
      if (!this.found) return;
      this.go.textContent = S.measureAgain;
      this.section.classList.add("stale");
    });
    this.on(["theme", "scene"], this.redraw);
    new ResizeObserver(this.redraw).observe(body);
  }

  /** A proved cell as column, row and value: its numbers come in the order of the axes. */
  /** @returns {(cell: number[]) => [number, number, number]} */
  cellOf = (map) => (cell) => {
    const value = cell.at(-1);
    if (!map.y) return [cell[0], 0, value];
    const [column, row] = [map.x, map.y].map((name) => cell[map.names.indexOf(name)]);
    return [column, row, value];
  };

  /** @returns {Page.Pair | null} */
  inSlice = (map, at) => (Object.keys(map.held).length ? null : [at[map.x], at[map.y]]);

  build = () => {
    const outputs = isTable(this.hand.file()) ? [] : (this.store.scene?.outputs ?? []).map((each) => each.name);
    const names = this.found?.map.names ?? [];
    const key = JSON.stringify([isTable(this.hand.file()), outputs, names, this.shown]);
    if (key === this.built) return;
    this.built = key;
    const set = (name) => (value) => {
      this.wanted[name] = value;
      this.run();
    };
    const tools = [];
    if (outputs.length > 1)
      tools.push(choice(S.shown, pairsOf(outputs), this.wanted.output || outputs[0], set("output")));
    if (!isTable(this.hand.file())) {
      const levels = el("input", {
        type: "text",
        class: "short",
        value: this.wanted.levels,
        placeholder: S.asInFile,
        title: S.levelsHint,
        "data-key": "levels",
        onchange: () => set("levels")(levels.value),
      });
      tools.push(el("label", { class: "small" }, S.levels, levels));
    }
    const modes = [["", S.asInFile], ...pairsOf(["bins", "nearest", "linear"])];
    tools.push(choice(S.lookedUpBy, modes, this.wanted.mode, set("mode")));
    if (names.length > 2) {
      tools.push(choice(S.horizontal, pairsOf(names), this.found.map.x, set("x")));
      tools.push(choice(S.vertical, pairsOf(names), this.found.map.y, set("y")));
    }
    const views = [
      ["difference", S.signed],
      ["proved", S.provedCells],
    ];
    const show = (value) => {
      this.shown = value;
      this.redraw();
    };
    this.setTools(space(), ...tools, choice(S.view, views, this.shown, show), this.go);
  };

  run = () => {
    if (this.store.view !== "table" || !this.hand.file()) return;
    this.say(S.working);
    this.go.textContent = this.found ? S.measureAgain : S.measure;
    this.section.classList.remove("stale");
    const { levels, mode, output, x, y } = this.wanted;
    const asked = () => ({ options: { levels, mode, output }, axes: { x, y, at: this.store.place() } });
    this.task.beginSettled(asked, this.hear);
  };

  say(words, isWrong = false) {
    this.state.textContent = clean(words);
    this.state.classList.toggle("error", isWrong);
  }

  hear = (news) => {
    if (news.map) {
      this.found = { map: news.map, cells: [], worst: null };
      this.build();
    }
    if (news.doing) this.say(`${news.doing} …`);
    if (news.cells) {
      this.found.cells.push(...news.cells);
      this.say(S.provedSoFar(news.done, news.of));
    }
    if (news.lines) {
      this.lines.replaceChildren(...printed(clean(news.lines.join("\n"))));
      this.lines.hidden = !news.lines.length;
      this.found.worst = news.worst;
      this.worst.textContent = clean(this.worstWords(news.worst, this.found.map.output));
    }
    if (news.unproved) this.found.unproved = news.unproved;
    if (news.end) this.ended(news);
    this.redraw();
  };

  ended = ({ end, message }) => {
    if (end === "failed") {
      this.say(message, true);
      if (!this.found?.worst) this.worst.textContent = "";
    } else if (end === "done") this.say(this.found.unproved ?? S.provedAll);
  };

  worstWords = ({ at, table, direct, difference, proved, mode }, output) => {
    const where = placeWords(at);
    return S.worstAt(
      output,
      mode,
      where,
      shortNumber(table, 6),
      shortNumber(direct, 6),
      shortNumber(difference, 6),
      proved === null ? null : shortNumber(proved, 7),
    );
  };

  draw = () => {
    if (!this.found || this.store.view !== "table") return;
    const { map } = this.found;
    const place = this.found.worst && this.inSlice(map, this.found.worst.at);
    const title = S.errorTitle(map.output, map.mode, placeWords(map.held, 4));
    const isProved = this.shown === "proved" && this.found.cells.length > 0;
    const panel = isProved ? this.provedPanel(map) : map.panel;
    const high = Math.max(Math.abs(panel.parts[0].value?.high ?? panel.up.high));
    const words = isProved ? `${S.provedCells} (≤ ${shortNumber(high, 6)})` : `${S.signed}, ±${shortNumber(high)}`;
    const worst = place ? [map.y ? markAt(place) : levelAt(place[0])] : [];
    drawPanel(this.canvas, { ...panel, title: `${title}: ${words}`, parts: [...panel.parts, ...worst] });
    this.canvas.setAttribute("aria-label", `${title}. ${this.worst.textContent}`);
  };

  /** The cells whose error has been proved so far: they come one by one. */
  provedPanel(map) {
    const axis = (name) => ({ name, levels: map.levels[name] });
    const grid = gridOf(axis(map.x), map.y ? axis(map.y) : null, true);
    const columns = grid.x.length - 1;
    const values = Array(columns * (grid.y.length - 1)).fill(null);
    for (const [i, j, value] of this.found.cells.map(this.cellOf(map))) values[j * columns + i] = value;
    const high = Math.max(...values) || 1;
    return cellsPanel(grid, values, axisOf("", [-high, high]));
  }
}

export const TABLE = {
  name: "table",
  title: S.tables,
  drawn: false,
  further: true,
  why: (_hand, { diagram }) => (diagram && !diagram.isSystem ? S.ownTable : ""),
  panes: [CellsPane, ErrorPane],
  splits: [{ key: "table-rows", vertical: false, at: 1, usual: 0.4 }],
};
