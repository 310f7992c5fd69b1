// Rules: grids coloured by what they conclude, cells that fire lit; sentences as a list.

import { el, pane, heat, shortNumber, eachFrame } from "./draw.js";
import { rangeOf } from "./store.js";
import { S } from "./strings.js";

const MOST_CELLS = 700; // of choices; beyond, cells are plain text
const MOST_SENTENCES = 400;

/** The pane; `setCell` writes a term into a cell, `goTo` shows a position of the text. */
export function rulesPane(store, { setCell, goTo }) {
  const { section, body } = pane("rules", S.rules);
  let lit = []; // for each rule its element
  let shown = []; // and the strength that it shows

  function build() {
    const { grids, rules, outputs } = store.scene;
    lit = [];
    shown = [];
    body.replaceChildren();
    const cells = grids.reduce((sum, grid) => sum + grid.rows.length * grid.columns.length, 0);
    for (const grid of grids) body.append(table(grid, outputs, setCell && cells <= MOST_CELLS));
    const sentences = rules.map((rule, number) => [rule, number]).filter(([rule]) => !rule.inGrid);
    if (sentences.length) {
      const list = el("ol");
      for (const [rule, number] of sentences.slice(0, MOST_SENTENCES)) {
        const words = el("button", { textContent: rule.text, onclick: () => goTo?.(rule.at) });
        const item = el("li", { value: number + 1 }, goTo ? words : rule.text);
        lit[number] = item;
        list.append(item);
      }
      body.append(list);
    }
    if (!rules.length) body.append(el("p", { class: "note", textContent: S.tooManyRules }));
    light();
  }

  function table(grid, outputs, editable) {
    const output = outputs.find((each) => each.name === grid.output);
    const when = grid.condition ? ` when ${grid.condition}` : "";
    const corner = grid.row ? `${grid.row} \\ ${grid.column}` : grid.column;
    const head = el("tr", {}, el("th", { scope: "col", textContent: corner }));
    for (const name of grid.columns) head.append(el("th", { scope: "col", textContent: name, title: name }));
    const made = el("table", {}, el("caption", { textContent: `${grid.output}${when}` }), el("thead", {}, head));
    const rows = el("tbody");
    for (const row of grid.rows) {
      const line = el("tr", {}, el("th", { scope: "row", textContent: row.label, title: row.label }));
      row.cells.forEach((cell, i) => {
        const label = S.ruleOf(row.label, grid.columns[i]);
        const change = editable && !(grid.joined && cell.term === null);
        const content = change ? picker(cell, output, label, grid.joined) : plain(cell);
        paint(content, cell.term, output);
        const td = el("td", {}, content);
        if (cell.rule !== null) lit[cell.rule] = td;
        line.append(td);
      });
      rows.append(line);
    }
    made.append(rows);
    return made;
  }

  const said = (cell) => (cell.term === null ? "·" : cell.weight ? `${cell.term} ×${cell.weight}` : cell.term);

  function plain(cell) {
    return el("span", { textContent: said(cell), title: cell.term ?? S.noRule });
  }

  function picker(cell, output, label, joined) {
    const select = el("select", { "aria-label": label, title: label });
    const names = output.terms.map((term) => term.name);
    for (const name of names) {
      const text = name === cell.term ? said(cell) : name;
      select.append(el("option", { value: name, textContent: text, selected: name === cell.term }));
    }
    if (!joined) select.append(el("option", { value: "", textContent: "·", selected: cell.term === null }));
    select.addEventListener("change", () => {
      const chosen = select.selectedIndex < names.length ? names[select.selectedIndex] : null;
      paint(select, chosen, output);
      setCell(cell.at, chosen);
    });
    return select;
  }

  function paint(element, name, output) {
    const term = output.terms.find((each) => each.name === name);
    const [low, high] = rangeOf(output);
    const value = term && (term.centre ?? term.parameters[term.parameters.length - 1]);
    if (value === undefined || value === null) {
      element.style.background = element.style.color = "";
      return;
    }
    [element.style.background, element.style.color] = heat((value - low) / (high - low));
  }

  function light() {
    const found = store.fired();
    lit.forEach((element, number) => {
      const strength = found?.strengths[number] ?? 0;
      if (shown[number] === strength) return;
      shown[number] = strength;
      element.classList.toggle("lit", strength > 0);
      element.title = strength > 0 ? `${S.strength} ${shortNumber(strength, 3)}` : "";
    });
  }

  const relight = eachFrame(light);
  store.on("scene", build);
  store.on("point", relight);
  store.on("reshaped", relight);
  return section;
}
