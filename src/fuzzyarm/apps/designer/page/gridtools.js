// Grids by hand: a new one, its rows and columns, and a rule put together from lists.

import { el, pairsOf, readNumber, select, shortNumber } from "./draw.js";
import { S } from "./strings.js";
import { newShape } from "./variables.js";
import { rangeOf } from "./geometry/shapes.js";

const named = (variables) => variables.filter((each) => each.terms.length).map((each) => each.name);

/** Whether there is something to conclude from something. */
export const canConclude = ({ inputs, outputs }) => named(inputs).length > 0 && named(outputs).length > 0;

/** Ask what a new grid is over, and add it. */
export function addGrid({ fill, attempt }, { inputs, outputs }) {
  const across = named(inputs);
  return fill(
    S.newGrid,
    [
      { name: "output", label: S.concludes, options: pairsOf(named(outputs)) },
      {
        name: "row",
        label: S.vertical,
        options: [["", S.oneRow], ...pairsOf(across)],
        value: across.length > 1 ? across[0] : "",
      },
      { name: "column", label: S.horizontal, options: pairsOf(across), value: across[1] ?? across[0] },
      { name: "fill", label: S.cells, options: S.fills },
    ],
    S.add,
    (values) => attempt("grid", values),
  );
}

/** What is done with a row or a column: `head` has the grid's line, which way, and the term. */
export function headDialog({ choose, attempt, change, fill }, scene, head) {
  const words = head.row ? [S.removeRow(head.term), S.addRow] : [S.removeColumn(head.term), S.addColumn];
  return choose(head.row ? S.rowOf(head.variable, head.term) : S.columnOf(head.variable, head.term), words).then(
    (chosen) => {
      if (chosen === 0) return change("head", { ...head, remove: true });
      return chosen === 1 ? addHead({ attempt, fill }, scene, head) : null;
    },
  );
}

/** Ask for the term of a new row or column, which may be a new one. */
export function addHead({ fill, attempt }, { inputs }, { line, row, variable: name, present }) {
  const variable = inputs.find((each) => each.name === name);
  const [low, high] = rangeOf(variable);
  const absent = variable.terms.map((each) => each.name).filter((each) => !present.includes(each));
  const isNew = absent.length ? { when: { chosen: "" } } : {};
  return fill(
    row ? S.addRowOf(name) : S.addColumnOf(name),
    [
      ...(absent.length ? [{ name: "chosen", label: S.term, options: [...pairsOf(absent), ["", S.newTerm]] }] : []),
      { name: "name", label: S.newTermName, value: "", ...isNew },
      { name: "peak", label: S.peak, value: shortNumber(0.5 * (low + high)), ...isNew },
    ],
    S.add,
    ({ chosen = "", name: given, peak }) => {
      if (chosen) return attempt("head", { line, row, term: chosen });
      const at = readNumber(peak ?? "");
      if (!Number.isFinite(at)) return { error: S.noNumber(peak ?? "") };
      return attempt("head", { line, row, term: given.trim(), shape: newShape(variable, at) });
    },
  );
}

/** Lists to put a rule together: a term of each input or none, and what follows. */
export function composer(attempt, { inputs, outputs }) {
  const choices = ({ name, terms }, none) =>
    select([...(none ? [["", "…"]] : []), ...pairsOf(terms.map((term) => term.name))], "", {
      "aria-label": name,
      "data-variable": name,
    });
  const asked = inputs.filter((each) => each.terms.length).map((each) => choices(each, true));
  const concluded = outputs.filter((each) => each.terms.length).map((each) => choices(each, outputs.length > 1));
  const join = select(pairsOf(["and", "or"]), "and", { "aria-label": S.join });
  const wrong = el("span", { class: "wrong", role: "alert" });
  const part = (select) => el("label", {}, `${select.dataset.variable} is`, select);
  const values = (selects) => selects.filter((each) => each.value).map((each) => [each.dataset.variable, each.value]);
  const between = asked.flatMap((each, i) =>
    i === 0
      ? [part(each)]
      : i === 1
        ? [join, part(each)]
        : [el("span", { class: "again", textContent: join.value }), part(each)],
  );
  const form = el(
    "form",
    {
      class: "composer",
      "aria-label": S.compose,
      onsubmit: async (event) => {
        event.preventDefault();
        const answer = await attempt("compose", { if: values(asked), then: values(concluded), join: join.value });
        wrong.textContent = answer.error ?? "";
        if (!answer.error) for (const each of asked) each.value = "";
      },
    },
    el("span", { textContent: S.ifWord }),
    ...between,
    el("span", { textContent: S.thenWord }),
    ...concluded.map(part),
    el("button", { class: "small", type: "submit", textContent: S.add }),
    wrong,
  );
  join.addEventListener("change", () => {
    for (const each of form.querySelectorAll(".again")) each.textContent = join.value;
  });
  return form;
}
