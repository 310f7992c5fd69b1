// Small questions to a person: fields to be filled in, one of several, yes or no.

import { el, field, keepFocus, select } from "./draw.js";
import { S } from "./strings.js";

/** Show a dialog until it is closed, and put the focus back then; what it returns. */
export function showDialog(name, properties, ...content) {
  const dialog = el("dialog", { "aria-label": name, ...properties }, ...content);
  const refocus = keepFocus(document.body);
  document.body.append(dialog);
  dialog.showModal();
  const closed = new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      refocus(); // what it stood on may have been built anew meanwhile
      resolve(dialog.returnValue);
    });
  });
  return { dialog, closed };
}

/** Show what a button closes; the value of that button. */
const choiceOf = (name, ...content) => showDialog(name, {}, el("form", { method: "dialog" }, ...content)).closed;

const button = (value, textContent) => el("button", { value, textContent, type: "submit" });
const row = (...buttons) => el("div", { class: "row" }, ...buttons);

/** The index of one of several texts, or null. */
export async function choose(title, texts) {
  const buttons = texts.map((text, i) => button(String(i), text));
  const choices = el("div", { class: "choices", role: "group", "aria-label": title }, ...buttons);
  const chosen = await choiceOf(title, el("strong", {}, title), choices, row(button("", S.cancel)));
  return chosen === "" ? null : Number(chosen);
}

/** What several lines of text say, to be closed. */
export async function tellAll(title, lines) {
  const list = el("ul", { class: "choices" }, ...lines.map((line) => el("li", { textContent: line })));
  await choiceOf(title, el("strong", {}, title), list, row(button("", S.close)));
}

/** Whether a person wants it. */
export const confirm = async (question, words) =>
  (await choiceOf(question, el("p", {}, question), row(button("", S.cancel), button("ok", words)))) === "ok";

/** Ask for another name; `act` takes one that differs. */
export const rename = (old, act) =>
  fill(`${S.renameTo} ${old}`, [{ name: "name", label: S.name, value: old }], S.rename, ({ name }) =>
    ["", old].includes(name.trim()) ? {} : act(name.trim()),
  );

/**
 * Fields to be filled in: `{ name, label, value }`, or with `options` as pairs of value and words;
 * one with `when` counts only where other fields have these values, and one with `follow` makes its value of theirs
 * until it is typed in.
 * `act` takes their values and answers; while that has an `error` the dialog stays. Null if nothing is done.
 */
export async function fill(title, fields, words, act, note = "") {
  const wrong = el("p", { class: "error", role: "alert" });
  const controls = fields.map(({ name, value, options }) =>
    options
      ? select(options, value, { name })
      : el("input", { type: "text", name, value, autocomplete: "off", spellcheck: false }),
  );
  const labels = fields.map(({ label }, i) => field(label, controls[i]));
  const go = button("", words);
  const stop = el("button", { type: "button", textContent: S.cancel, onclick: () => dialog.close() });
  const notes = note ? [el("p", { textContent: note })] : [];
  const form = el("form", {}, el("strong", {}, title), ...notes, ...labels, wrong, row(stop, go));
  let done = null;
  const dim = () =>
    fields.forEach(({ when = {} }, i) => {
      labels[i].hidden = controls[i].disabled = Object.entries(when).some(
        ([name, values]) => form.elements[name] && ![values].flat().includes(form.elements[name].value),
      );
    });
  const followed = () => {
    fields.forEach(({ follow }, i) => {
      const chosen = fields.filter(({ options }) => options).map(({ name }) => [name, form.elements[name].value]);
      if (follow && !controls[i].dataset.typed) controls[i].value = follow(Object.fromEntries(chosen));
    });
  };
  form.addEventListener("input", ({ target }) => target.tagName === "INPUT" && (target.dataset.typed = "yes"));
  form.addEventListener("change", ({ target }) => {
    dim();
    if (target.tagName === "SELECT") followed();
  });
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
  const { dialog, closed } = showDialog(title, {}, form);
  const text = controls.find((each) => each.tagName === "INPUT");
  (text ?? go).focus();
  if (text) text.setSelectionRange(0, text.value.length - suffixOf(text.value).length);
  await closed;
  return done;
}

/** The suffix of a file's name, which stays when another name is typed; of an address or a number nothing. */
const suffixOf = (value) => (/^[^/:]*[^/:.](\.[a-z][a-z0-9]*)$/i.exec(value) ?? ["", ""])[1];
