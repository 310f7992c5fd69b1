// How rules are evaluated: and, or, implication, aggregation, defuzzifier, each as a list to choose from.

import { clean, el, keepFocus } from "./draw.js";
import { S } from "./strings.js";

/** A line that says them and opens to lists; `change` writes a choice into the text, or is missing. */
export function methodLines(change) {
  const summary = el("summary");
  const body = el("div", { class: "fields" });
  const element = el("details", { class: "methods" }, summary, body);

  function list(row) {
    const label = row.target ? `${row.target}: ${row.key}` : row.key;
    const select = el(
      "select",
      {
        "aria-label": label,
        "data-key": `method ${label}`,
        disabled: !change,
        onchange: async () => {
          const taken = await change("setting", { key: row.key, value: select.value, target: row.target });
          if (!taken) select.value = row.value; // the status says why
        },
      },
      ...row.options.map((value) => el("option", { value, textContent: value, selected: value === row.value })),
    );
    return el("label", { class: "field" }, el("span", { textContent: label }), select);
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
        ...lists.map(list),
        ...rows.filter((row) => row.block).map(({ block }) => el("span", { class: "small", textContent: block })),
      );
      refocus();
    },
  };
}
