// The frame of the page: the bar on top and the panes that draw.

import { el } from "./draw.js";
import { termsPane } from "./terms.js";
import { helpButton } from "./help.js";
import { rulesPane } from "./rules.js";
import { splitter } from "./split.js";
import { surfacePane } from "./surface.js";
import { viewerPane } from "./viewer.js";
import { S } from "./strings.js";

/**
 * A view stands beside the text, one at a time; from two on there are tabs. Its panes are functions
 * of the store and of what a hand may do, which return an element. A view that is `drawn` needs a
 * sound rule base. This one stands in the page without a server as well.
 */
export const DESIGN = {
  name: "design",
  title: S.design,
  drawn: true,
  panes: [termsPane, surfacePane, rulesPane, viewerPane],
  splits: [
    { key: "design-columns", vertical: true, at: 1, usual: 0.5 },
    { key: "design-rows", vertical: false, at: 1, usual: 0.5 },
  ],
};

const DARK = "(prefers-color-scheme: dark)";

/**
 * Build what is around the text; `hand` says what a change in a picture does. `root` is to be shown.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
export function frame(store, hand, text, controls, shownViews = [DESIGN]) {
  const note = el("p", { class: "note" });
  const views = shownViews.map(({ name, title, drawn, panes, splits = [] }) => {
    const made = [...panes.map((make) => make(store, hand)), ...splits.map(splitter)];
    const panel = shownViews.length > 1 ? { role: "tabpanel", "aria-label": title } : {};
    return el(
      "div",
      { class: `pictures view-${name}${drawn ? " drawn" : ""}`, id: `view-${name}`, hidden: true, ...panel },
      ...made,
    );
  });
  const area = el("div", { class: "area" }, note, ...views);
  const between = text ? [text, splitter({ key: "text", vertical: true, at: 1, usual: 0.35 })] : [];
  const main = el("main", { class: text ? "design" : "design alone" }, ...between, area);
  const gone = new AbortController();
  const help = helpButton(
    shownViews.map((view) => view.name),
    gone.signal,
  );
  const header = el(
    "header",
    {},
    el("h1", { textContent: S.designer }),
    ...controls,
    el("span", { class: "last" }, help, themeButton(store)),
  );
  let shown = 0;
  const tabs = shownViews.map(({ name, title }, i) =>
    el("button", { role: "tab", textContent: title, "aria-controls": `view-${name}`, onclick: () => turn(i) }),
  );
  if (tabs.length > 1) header.lastChild.before(el("div", { role: "tablist", class: "tabs" }, ...tabs));
  const root = el("div", { class: "desk" }, header, main);

  function turn(to) {
    shown = to;
    note.hidden = !shownViews[shown].drawn || Boolean(store.scene ?? store.diagram);
    views.forEach((view, i) => {
      view.hidden = i !== shown || !note.hidden;
    });
    tabs.forEach((tab, i) => tab.setAttribute("aria-selected", String(i === shown)));
    if (store.view === shownViews[shown].name) return;
    store.view = shownViews[shown].name;
    store.emit("view");
  }

  /** Go to the next pane, or with Shift to the one before: there are many stops of Tab between. */
  function step(event) {
    if (document.querySelector("dialog[open]")) return;
    const panes = [...root.querySelectorAll(".pane")].filter((each) => each.offsetParent);
    const at = panes.findIndex((each) => each.contains(document.activeElement));
    const next = event.shiftKey ? Math.max(at, 0) - 1 : at + 1;
    event.preventDefault();
    panes.at(next % panes.length).focus();
  }

  turn(0);
  window.addEventListener(
    "keydown",
    (event) => {
      if (event.key === "F6" && root.isConnected) step(event);
    },
    gone,
  );
  matchMedia(DARK).addEventListener("change", () => store.emit("theme"), gone);
  store.on("closed", () => gone.abort());
  const sound = () => {
    area.classList.remove("stale");
    area.classList.toggle("as-diagram", Boolean(store.diagram) && store.asDiagram);
    turn(shown);
  };
  store.on("scene", sound);
  store.on("diagram", sound);
  store.on("stale", () => {
    note.textContent = store.why === "other" ? S.noRules : S.notDrawn;
    area.classList.add("stale"); // what is drawn is that of the last sound text
  });
  return { root, turn: (name) => turn(shownViews.findIndex((view) => view.name === name)) };
}

/**
 * @param {Page.Store} store
 */
function themeButton(store) {
  const root = document.documentElement;
  const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : matchMedia(DARK).matches);
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
