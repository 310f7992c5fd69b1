// How rules are evaluated: and, or, implication, aggregation, defuzzifier, each as a list to choose from.

import { clean, el, field, keepFocus, pairsOf, select } from "./draw.js";
import { S } from "./strings.js";

/** A line that says them and opens to lists; `change` writes a choice into the text, or is missing. */
export function methodLines(change) {
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
