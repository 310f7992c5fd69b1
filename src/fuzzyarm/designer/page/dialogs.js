// Small questions to a person: a line of text, one of several.

import { el } from "./draw.js";
import { S } from "./strings.js";

function opened(...content) {
  const form = el("form", { method: "dialog" }, ...content);
  const dialog = el("dialog", {}, form);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue);
    });
  });
}

/** A line of text, or null. */
export async function ask(question, text, button) {
  const field = el("input", { type: "text", value: text, "aria-label": question });
  const row = el("div", { class: "row" },
    el("button", { value: "", textContent: S.cancel, type: "submit", formNoValidate: true }),
    el("button", { value: "ok", textContent: button, type: "submit" }));
  // The first button of a form is what Enter presses.
  const enter = el("button", { value: "ok", class: "unseen", tabIndex: -1, type: "submit", "aria-hidden": "true" });
  setTimeout(() => field.select());
  return (await opened(enter, el("label", {}, question), field, row)) === "ok" ? field.value : null;
}

/** The index of one of several texts, or null. */
export async function choose(title, texts) {
  const choices = el("div", { class: "choices", role: "group", "aria-label": title });
  texts.forEach((text, i) => choices.append(el("button", { value: String(i), textContent: text, type: "submit" })));
  const row = el("div", { class: "row" }, el("button", { value: "", textContent: S.cancel, type: "submit" }));
  const found = await opened(el("strong", {}, title), choices, row);
  return found === "" ? null : Number(found);
}

/** Whether a person wants it. */
export async function confirm(question, button) {
  const row = el("div", { class: "row" },
    el("button", { value: "", textContent: S.cancel, type: "submit" }),
    el("button", { value: "ok", textContent: button, type: "submit" }));
  return (await opened(el("p", {}, question), row)) === "ok";
}
