// Small questions to a person: a line of text, one of several.

import { el, keepFocus } from "./draw.js";
import { S } from "./strings.js";

function opened(name, ...content) {
  const form = el("form", { method: "dialog" }, ...content);
  const dialog = el("dialog", { "aria-label": name }, form);
  const refocus = keepFocus(document.body);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      refocus();
      resolve(dialog.returnValue);
    });
  });
}

/** A line of text, or null. */
export async function ask(question, text, button) {
  const field = el("input", { type: "text", value: text, "aria-label": question });
  const row = el(
    "div",
    { class: "row" },
    el("button", { value: "", textContent: S.cancel, type: "submit", formNoValidate: true }),
    el("button", { value: "ok", textContent: button, type: "submit" }),
  );
  // The first button of a form is what Enter presses.
  const enter = el("button", { value: "ok", class: "unseen", tabIndex: -1, type: "submit", "aria-hidden": "true" });
  setTimeout(() => field.select());
  return (await opened(question, enter, el("label", {}, question), field, row)) === "ok" ? field.value : null;
}

/** The index of one of several texts, or null. */
export async function choose(title, texts) {
  const choices = el("div", { class: "choices", role: "group", "aria-label": title });
  texts.forEach((text, i) => choices.append(el("button", { value: String(i), textContent: text, type: "submit" })));
  const row = el("div", { class: "row" }, el("button", { value: "", textContent: S.cancel, type: "submit" }));
  const found = await opened(title, el("strong", {}, title), choices, row);
  return found === "" ? null : Number(found);
}

/** What several lines of text say, to be closed. */
export async function tellAll(title, lines) {
  const list = el("ul", { class: "choices" }, ...lines.map((line) => el("li", { textContent: line })));
  const row = el("div", { class: "row" }, el("button", { value: "", textContent: S.close, type: "submit" }));
  await opened(title, el("strong", {}, title), list, row);
}

/**
 * Fields to be filled in: `{ name, label, value }`, or with `options` as pairs of value and words;
 * one with `when` counts only where other fields have these values.
 * `act` takes their values and answers; while that has an `error` the dialog stays. Null if nothing is done.
 */
export function fill(title, fields, button, act, note = "") {
  const wrong = el("p", { class: "error", role: "alert" });
  const controls = fields.map(({ name, value, options, hint }) =>
    options
      ? el(
          "select",
          { name },
          ...options.map(([key, words]) => el("option", { value: key, textContent: words, selected: key === value })),
        )
      : el("input", { type: "text", name, value, placeholder: hint ?? "", autocomplete: "off", spellcheck: false }),
  );
  const labels = fields.map(({ label }, i) =>
    el("label", { class: "field" }, el("span", { textContent: label }), controls[i]),
  );
  const go = el("button", { type: "submit", textContent: button });
  const stop = el("button", { type: "button", textContent: S.cancel, onclick: () => dialog.close() });
  const form = el(
    "form",
    {},
    el("strong", {}, title),
    ...(note ? [el("p", { textContent: note })] : []),
    ...labels,
    wrong,
    el("div", { class: "row" }, stop, go),
  );
  const dialog = el("dialog", { "aria-label": title }, form);
  const refocus = keepFocus(document.body);
  let done = null;
  const dim = () =>
    fields.forEach(({ when = {} }, i) => {
      labels[i].hidden = controls[i].disabled = Object.entries(when).some(
        ([name, value]) => (form.elements[name]?.value ?? value) !== value,
      );
    });
  form.addEventListener("change", dim);
  dim();
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    go.disabled = true;
    const answer = await act(Object.fromEntries(new FormData(form)));
    go.disabled = false;
    wrong.textContent = answer.error ?? "";
    if (answer.error) return;
    done = answer;
    dialog.close();
  });
  document.body.append(dialog);
  dialog.showModal();
  const text = controls.find((each) => each.tagName === "INPUT");
  (text ?? go).focus();
  if (text) text.setSelectionRange(0, text.value.length - suffixOf(text.value).length);
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      refocus(); // what it stood on may have been built anew meanwhile
      resolve(done);
    });
  });
}

/** The suffix of a file's name, which stays when another name is typed; of an address or a number nothing. */
const suffixOf = (value) => (/^[^/:]*[^/:.](\.[a-z][a-z0-9]*)$/i.exec(value) ?? ["", ""])[1];

/** Whether a person wants it. */
export async function confirm(question, button) {
  const row = el(
    "div",
    { class: "row" },
    el("button", { value: "", textContent: S.cancel, type: "submit" }),
    el("button", { value: "ok", textContent: button, type: "submit" }),
  );
  return (await opened(question, el("p", {}, question), row)) === "ok";
}
