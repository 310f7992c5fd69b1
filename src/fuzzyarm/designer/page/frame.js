// The frame of the page: the bar on top and the panes that draw.

import { el } from "./draw.js";
import { termsPane } from "./terms.js";
import { rulesPane } from "./rules.js";
import { surfacePane } from "./surface.js";
import { viewerPane } from "./viewer.js";
import { S } from "./strings.js";

/**
 * A view stands beside the text, one at a time; from two on there are tabs. Its panes are functions
 * of the store and of what a hand may do, which return an element. A view that is `drawn` needs a
 * sound rule base. This one stands in the page without a server as well.
 */
export const DESIGN = {
  name: "design", title: S.design, drawn: true,
  panes: [termsPane, surfacePane, rulesPane, viewerPane],
};

/** Build what is around the text; `hand` says what a change in a picture does. `root` is to be shown. */
export function frame(store, hand, text, controls, shownViews = [DESIGN]) {
  const note = el("p", { class: "note" });
  const views = shownViews.map(({ name, drawn, panes }) => {
    const made = panes.map((make) => make(store, hand));
    return el("div", { class: `pictures view-${name}${drawn ? " drawn" : ""}`, id: `view-${name}`, hidden: true }, ...made);
  });
  const area = el("div", { class: "area" }, note, ...views);
  const main = el("main", { class: "design" }, text, area);
  const header = el("header", {}, el("h1", { textContent: S.designer }), ...controls, themeButton(store));
  let shown = 0;
  const tabs = shownViews.map(({ name, title }, i) => el("button", {
    role: "tab", textContent: title, "aria-controls": `view-${name}`, onclick: () => turn(i),
  }));
  if (tabs.length > 1) header.lastChild.before(el("div", { role: "tablist", class: "tabs" }, ...tabs));
  const root = el("div", { class: "desk" }, header, main);

  function turn(to) {
    shown = to;
    note.hidden = !shownViews[shown].drawn || Boolean(store.scene);
    views.forEach((view, i) => {
      view.hidden = i !== shown || !note.hidden;
    });
    tabs.forEach((tab, i) => tab.setAttribute("aria-selected", String(i === shown)));
    if (store.view === shownViews[shown].name) return;
    store.view = shownViews[shown].name;
    store.emit("view");
  }

  turn(0);
  store.on("scene", () => {
    area.classList.remove("stale");
    turn(shown);
  });
  store.on("stale", () => {
    note.textContent = store.why === "other" ? S.noRules : S.notDrawn;
    area.classList.add("stale"); // what is drawn is that of the last sound text
  });
  return { root, turn: (name) => turn(shownViews.findIndex((view) => view.name === name)) };
}

function themeButton(store) {
  const root = document.documentElement;
  const dark = () => (root.dataset.theme
    ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches);
  const button = el("button", { title: S.theme, textContent: dark() ? S.light : S.dark });
  button.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    store.emit("theme");
  });
  store.on("theme", () => {
    button.textContent = dark() ? S.light : S.dark;
  });
  return button;
}
