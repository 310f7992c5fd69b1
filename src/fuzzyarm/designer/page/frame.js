// The frame of the page: the bar on top and the panes that draw.

import { el } from "./draw.js";
import { termsPane } from "./terms.js";
import { rulesPane } from "./rules.js";
import { surfacePane } from "./surface.js";
import { viewerPane } from "./viewer.js";
import { S } from "./strings.js";

/**
 * The panes of the pictures, in their order. Another pane is another line: a function of the
 * store and of what a hand may do, which returns its element.
 */
export const PICTURES = [termsPane, surfacePane, rulesPane, viewerPane];

/** Build the page around the text; `hand` says what a change in a picture does. */
export function frame(store, hand, text, controls) {
  const note = el("p", { class: "note", textContent: "" });
  const pictures = el("div", { class: "pictures" });
  const panes = PICTURES.map((make) => make(store, hand));
  const main = el("main", { class: "design" }, text, note);
  const header = el("header", {}, el("h1", { textContent: S.designer }), ...controls, themeButton(store));
  document.body.append(header, main);
  store.on("scene", () => {
    if (note.isConnected) {
      pictures.append(...panes);
      note.replaceWith(pictures);
    }
    pictures.style.opacity = "";
  });
  store.on("stale", () => {
    note.textContent = store.why === "other" ? S.noRules : S.notDrawn;
    pictures.style.opacity = "0.55"; // drawn from the last sound text
  });
  return { header, main };
}

function themeButton(store) {
  const root = document.documentElement;
  const dark = () => (root.dataset.theme
    ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches);
  const button = el("button", { title: S.theme, textContent: dark() ? S.light : S.dark });
  button.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    button.textContent = dark() ? S.light : S.dark;
    store.emit("theme");
  });
  return button;
}
