// Rules: grids coloured by what they conclude, cells that fire lit; sentences as a list; findings
// of the check where they are.

import {
  clean,
  eachFrame,
  el,
  field,
  heat,
  keepFocus,
  pairsOf,
  sayWrong,
  select,
  shortNumber,
  space,
  tableOf,
} from "./draw.js";
import { addGrid, addHead, canConclude, composer, headDialog } from "./gridtools.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { rangeOf } from "./geometry/shapes.js";

const MOST_CELLS = 700; // of choices; beyond, cells are plain text
const MOST_SENTENCES = 400;

/**
 * The pane; a page without a server has no `setCell` that writes a term into a cell, no `goTo` a position of the text, and no
 * `change` and `attempt` that write sentences.
 */
export class RulesPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "rules", S.rules);
    this.setCell = this.hand.setCell;
    this.goTo = this.hand.goTo;
    this.change = this.hand.change;
    this.attempt = this.hand.attempt;
    const { bar } = this;
    this.methods = methodLines(this.change);
    this.grid = el("button", {
      textContent: S.gridDots,
      title: S.gridHint,
      onclick: () => addGrid(this.hand, this.store.scene),
    });
    const toSystem = el("button", { textContent: S.system, hidden: true, onclick: () => this.store.turnDiagram(true) });
    bar.append(space(), toSystem);
    if (this.attempt) bar.append(this.grid);
    this.store.on("diagram", () => {
      toSystem.hidden = !this.store.diagram?.isSystem;
    });
    this.lit = []; // for each rule its element
    this.shown = []; // and the strength that it shows
    this.fresh = { rule: null, text: "" }; // what stands in the line of a new rule
    this.drafts = new Set(); // sentences that are being changed: which rule, what it said, and what is typed

    this.composed = { names: "", form: null };

    const relight = eachFrame(this.light);
    this.store.on("scene", this.build);
    this.store.on("point", relight);
    this.store.on("told", relight);
    this.store.on("reshaped", relight);
  }

  // --- findings ---

  before = (one, other) => one[0] < other[0] || (one[0] === other[0] && one[1] < other[1]);

  words = (finding) => `${S.severity[finding.severity] ?? finding.severity}: ${finding.message}`;

  /** A sign with the findings as its name. */
  sign = (found) =>
    el("span", {
      class: `sign ${found[0].severity}`,
      role: "img",
      textContent: "▲",
      title: found.map(this.words).join("\n"),
      "aria-label": found.map(this.words).join("; "),
    });

  present = (grid, row) => (row ? grid.rows.map((each) => each.label) : grid.columns);

  said = (cell) => (cell.term === null ? "·" : cell.weight ? `${cell.term} ×${cell.weight}` : cell.term);

  build = () => {
    const { grids, rules, outputs } = this.store.scene;
    const isReady = canConclude(this.store.scene);
    this.grid.disabled = !isReady;
    this.methods.show(this.store.scene.methods);
    const refocus = keepFocus(this.section);
    this.findAgain(rules);
    this.lit = [];
    this.shown = [];
    const seen = this.body.scrollTop;
    this.body.replaceChildren(...(outputs.length ? [this.methods.element] : []));
    const cells = grids.reduce((sum, grid) => sum + grid.rows.length * grid.columns.length, 0);
    grids.forEach((grid, k) => this.body.append(this.table(grid, outputs, cells <= MOST_CELLS, k)));
    const sentences = rules
      .map((rule, number) => /** @type {const} */ ([rule, number]))
      .filter(([rule]) => !rule.inGrid);
    if (sentences.length) {
      const list = el("ol");
      for (const [rule, number] of sentences.slice(0, MOST_SENTENCES)) list.append(this.item(rule, number));
      this.body.append(list);
    }
    if (!rules.length)
      this.body.append(
        el("p", {
          class: "note",
          textContent: this.store.scene.missing.includes("no-rules") ? S.noRulesYet : S.tooManyRules,
        }),
      );
    if (isReady) this.body.append(this.composing(), this.writer(this.fresh, S.newRule));
    this.body.scrollTop = seen;
    refocus();
    this.light();
  };

  /**
   * Find the rules again that are being changed, in a text that may have other lines now: one that says what it
   * said, the nearest; else the one in its place, where there are as many. What has no rule any more may be a new one.
   */
  findAgain = (rules) => {
    for (const draft of this.drafts) {
      const same = rules.flatMap((rule, number) => (rule.written === draft.written ? [number] : []));
      same.sort((a, b) => Math.abs(a - draft.rule) - Math.abs(b - draft.rule));
      const inPlace = rules.length === draft.of && rules[draft.rule]?.written ? draft.rule : null;
      const rule = same[0] ?? inPlace;
      if (rule === null) {
        this.fresh.text ||= draft.text;
        this.drafts.delete(draft);
      } else Object.assign(draft, { rule, of: rules.length });
    }
  };

  /** The lists of a new rule: what has been chosen stays while the variables do. */
  composing = () => {
    const { inputs, outputs } = this.store.scene;
    const names = JSON.stringify(
      [inputs, outputs].map((each) => each.map(({ name, terms }) => [name, terms.map((term) => term.name)])),
    );
    if (names !== this.composed.names) this.composed = { names, form: composer(this.attempt, this.store.scene) };
    return this.composed.form;
  };

  /** Findings that lie within a stretch of the text, or cover it in its own line. */
  findingsOf = ([start, end]) => {
    return this.store.findings.filter(
      ({ range: [from, to] }) =>
        from[0] === start[0] && !this.before(to, start) && (from[0] !== end[0] || this.before(from, end)),
    );
  };

  /** Mark an element with its findings, for the eye, the pointer and the screen reader. */
  mark = (element, named, found) => {
    if (!found.length) return;
    const said = found.map(this.words).join("; ");
    element.classList.add("found", found[0].severity);
    named.title = said;
    named.setAttribute("aria-label", `${named.getAttribute("aria-label") ?? named.textContent}. ${said}`);
  };

  // --- sentences ---

  item = (rule, number) => {
    const said = this.goTo
      ? el("button", { class: "said", textContent: rule.text, onclick: () => this.goTo(rule.at) })
      : rule.text;
    const li = el("li", {}, el("span", { class: "place", textContent: rule.place }), said);
    const found = this.findingsOf(rule.range);
    if (found.length) {
      li.classList.add("found", found[0].severity);
      li.append(this.sign(found));
    }
    const draft = [...this.drafts].find((each) => each.rule === number);
    if (draft) li.replaceChildren(this.writer(draft, S.ruleAt(rule.place)));
    else if (this.change && rule.written) {
      const edit = () => {
        const line = { rule: number, of: this.store.scene.rules.length, written: rule.written, text: rule.written };
        this.drafts.add(line);
        this.build();
        this.body.querySelector(`[data-key="write ${number}"]`).focus();
      };
      li.append(
        el("button", {
          class: "small",
          textContent: S.change,
          "aria-label": `${S.change} ${S.ruleAt(rule.place)}`,
          "data-key": `edit ${number}`,
          onclick: edit,
        }),
        el("button", {
          class: "small",
          textContent: "×",
          title: S.remove,
          "aria-label": `${S.remove} ${S.ruleAt(rule.place)}`,
          "data-key": `remove ${number}`,
          onclick: () => this.change("rule", { line: rule.line, sentence: "" }),
        }),
      );
    }
    this.lit[number] = li;
    return li;
  };

  /** A line to write a rule in; one that is changed may be left with Escape. */
  writer = (draft, label) => {
    const isNew = draft === this.fresh;
    const key = `write ${isNew ? "new" : draft.rule}`;
    const field = el("input", {
      type: "text",
      class: "write",
      value: draft.text,
      "aria-label": label,
      placeholder: S.ifThen,
      "data-key": key,
      spellcheck: false,
    });
    /** Be done with it; of a rule that has been changed the way to change it gets the focus. */
    const leave = () => {
      this.drafts.delete(draft);
      const isHeld = this.body.querySelector(`[data-key="${key}"]`)?.closest("form").contains(document.activeElement);
      this.build();
      if (isHeld) this.body.querySelector(`[data-key="edit ${draft.rule}"]`)?.focus();
    };
    const send = async (event) => {
      event.preventDefault();
      const sentence = draft.text;
      if (!sentence.trim()) return;
      const line = isNew ? null : this.store.scene.rules[draft.rule].line;
      const { error } = await this.attempt("rule", { line, sentence });
      if (error) sayWrong(field, error);
      else if (!isNew) leave();
      else if (this.fresh.text === sentence) {
        this.fresh.text = field.value = "";
        if (!field.isConnected) this.build(); // a scene has come meanwhile
      }
    };
    field.addEventListener("input", () => {
      draft.text = field.value;
      sayWrong(field);
    });
    field.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && !isNew) leave();
    });
    return el(
      "form",
      { class: "sentence", onsubmit: send },
      field,
      el("button", { class: "small", type: "submit", textContent: isNew ? S.add : S.ok, "data-key": `done ${key}` }),
    );
  };

  // --- grids ---

  table = (grid, outputs, editable, k) => {
    const output = outputs.find((each) => each.name === grid.output);
    const when = grid.condition ? ` when ${grid.condition}` : "";
    const corner = grid.row ? `${grid.row} \\ ${grid.column}` : grid.column;
    const caption = el("caption", {}, el("span", { textContent: `${grid.output}${when}` }), ...this.tools(grid, k));
    const found = this.findingsOf(grid.range);
    if (found.length) caption.append(" ", this.sign(found));
    return tableOf({
      caption,
      head: [corner, ...grid.columns.map((name) => this.label(grid, name, false, k))],
      rows: grid.rows.map((row) => [
        grid.row ? this.label(grid, row.label, true, k) : row.label,
        ...row.cells.map((cell, i) => this.cell(cell, grid, output, editable, [k, row.label, grid.columns[i]])),
      ]),
    });
  };

  cell = (cell, grid, output, editable, [k, row, column]) => {
    const change = editable && !(grid.joined && cell.term === null);
    const content = change ? this.picker(cell, output, S.ruleOf(row, column), grid.joined) : this.plain(cell);
    content.dataset.key = `cell ${k} ${row}, ${column}`;
    this.paint(content, cell.term, output);
    const td = el("td", {}, content);
    this.mark(td, content, this.findingsOf(cell.range));
    if (cell.rule !== null) this.lit[cell.rule] = td;
    return td;
  };

  /** What names a row or a column, and leads to what is done with it. */
  label = (grid, term, row, k) => {
    if (!this.attempt) return el("span", { textContent: term, title: term });
    const variable = row ? grid.row : grid.column;
    return el("button", {
      textContent: term,
      "data-key": `head ${k} ${row} ${term}`,
      title: row ? S.rowOf(variable, term) : S.columnOf(variable, term),
      onclick: () =>
        headDialog(this.hand, this.store.scene, {
          line: grid.line,
          row,
          variable,
          term,
          present: this.present(grid, row),
        }),
    });
  };

  /** Buttons of a grid: another row or column, and its removal. */
  tools = (grid, k) => {
    if (!this.attempt) return [];
    const adding = (words, title, row) =>
      el("button", {
        class: "small",
        textContent: words,
        title,
        "data-key": `add ${k} ${row}`,
        onclick: () =>
          addHead(this.hand, this.store.scene, {
            line: grid.line,
            row,
            variable: row ? grid.row : grid.column,
            present: this.present(grid, row),
          }),
      });
    return [
      ...(grid.row ? [adding(S.rowDots, S.addRowOf(grid.row), true)] : []),
      adding(S.columnDots, S.addColumnOf(grid.column), false),
      el("button", {
        class: "small",
        textContent: "×",
        title: S.removeGrid(grid.output),
        "aria-label": S.removeGrid(grid.output),
        onclick: () => this.change("grid", { line: grid.line }),
      }),
    ];
  };

  plain = (cell) => {
    return el("span", { textContent: this.said(cell), title: cell.term ?? S.noRule });
  };

  picker = (cell, output, label, joined) => {
    const names = output.terms.map((term) => term.name);
    const options = names.map((name) => [name, name === cell.term ? this.said(cell) : name]);
    const list = select([...options, ...(joined ? [] : [["", "·"]])], cell.term ?? "", {
      "aria-label": label,
      title: label,
      onchange: () => {
        const chosen = names[list.selectedIndex] ?? null;
        this.paint(list, chosen, output);
        this.setCell(cell.at, chosen);
      },
    });
    return list;
  };

  paint = (element, name, output) => {
    const term = output.terms.find((each) => each.name === name);
    const [low, high] = rangeOf(output);
    const value = term && (term.centre ?? term.parameters[term.parameters.length - 1]);
    if (value === undefined || value === null) {
      element.style.background = element.style.color = "";
      return;
    }
    [element.style.background, element.style.color] = heat((value - low) / (high - low));
  };

  light = () => {
    const found = this.store.fired();
    this.lit.forEach((element, number) => {
      const strength = found?.strengths[number] ?? 0;
      if (this.shown[number] === strength) return;
      this.shown[number] = strength;
      element.classList.toggle("lit", strength > 0);
      const lower = found?.lower[number] ?? strength;
      const range =
        lower === strength ? shortNumber(strength, 3) : S.between(shortNumber(lower, 3), shortNumber(strength, 3));
      const said = strength > 0 ? `${S.strength} ${range}` : S.silent;
      element.title = S.fires(this.store.scene.rules[number].place, said);
    });
  };
}

// --- How they are evaluated: and, or, implication, aggregation, defuzzifier, each as a list to choose from ---

/** A line that says them and opens to lists; `change` writes a choice into the text, or is missing. */
function methodLines(change) {
  const summary = el("summary");
  const body = el("div", { class: "fields" });
  const element = el("details", { class: "methods" }, summary, body);

  function choiceOf(row) {
    const label = row.target ? `${row.target}: ${row.key}` : row.key;
    const list = select(pairsOf(row.options), row.value, {
      "aria-label": label,
      "data-key": `method ${label}`,
      disabled: !change,
      onchange: async () => {
        const taken = await change("setting", { key: row.key, value: list.value, target: row.target });
        if (!taken) list.value = row.value; // the status says why
      },
    });
    return field(label, list);
  }

  return {
    element,
    show(rows) {
      const lists = rows.filter((row) => row.key);
      const refocus = keepFocus(body);
      summary.textContent = clean(
        `${S.methods}: ${lists.map(({ key, value, target }) => `${target ? `${target} ` : ""}${key} ${value}`).join(", ")}`,
      );
      body.replaceChildren(
        ...lists.map(choiceOf),
        ...rows.filter((row) => row.block).map(({ block }) => el("span", { class: "small", textContent: block })),
      );
      refocus();
    },
  };
}
