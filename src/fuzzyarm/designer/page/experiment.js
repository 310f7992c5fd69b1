// The fields of an experiment: sensors, drives, disturbances, in the words of the command line.

import { el } from "./draw.js";
import { S } from "./strings.js";

const MORE = ["connect", "noise", "quantise", "sensor_delay", "difference", "actuator", "disturb"];

/** Words between blanks. */
export const wordsOf = (text) => text.trim().split(/\s+/).filter(Boolean);

/** A field for words, with its label; `hint` says how they look. */
export function textField(label, hint, size, onchange) {
  const field = el("input", { type: "text", title: hint, size, spellcheck: false, autocomplete: "off", onchange });
  return { field, shown: el("label", { class: "small" }, label, field) };
}

/** The fields; `asked` gives their words by the names of the options. */
export function experimentFields(onchange = () => {}) {
  const more = Object.fromEntries(
    MORE.map((name) => [name, textField(S.runMore[name], S.runMoreHint[name], 18, onchange)]),
  );
  const smooth = el("input", { type: "checkbox", onchange });
  const shown = [
    ...MORE.map((name) => more[name].shown),
    el("label", { class: "small", title: S.runSmoothHint }, smooth, S.runSmooth),
  ];
  return {
    shown,
    inputs: Object.fromEntries(MORE.map((name) => [name, more[name].field])),
    asked() {
      const found = { interpolate: smooth.checked };
      for (const name of MORE) found[name] = wordsOf(more[name].field.value);
      return found;
    },
  };
}

/** The options of a command that say the same as what is asked for. */
export function optionsOf(asked) {
  const words = [];
  for (const name of ["reference", ...MORE]) {
    for (const each of asked[name] ?? []) words.push(`--${name.replace("_", "-")}`, each);
  }
  return asked.interpolate ? [...words, "--interpolate"] : words;
}

/** Mark the field in which a mistake stands, and say it there; none where `name` is no field. */
export function markField(inputs, name, message) {
  for (const [each, input] of Object.entries(inputs)) {
    const wrong = each === name;
    if (wrong) input.setAttribute("aria-invalid", "true");
    else input.removeAttribute("aria-invalid");
    input.nextElementSibling?.matches(".wrong") && input.nextElementSibling.remove();
    if (!wrong) continue;
    input.closest("details")?.setAttribute("open", "");
    input.after(el("span", { class: "wrong", role: "alert", textContent: message }));
    input.focus();
  }
}
