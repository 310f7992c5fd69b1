// The frame of the page: the bar on top and the panes that draw.

import { el } from "./draw.js";
import { TermsPane } from "./terms.js";
import { helpButton } from "./help.js";
import { RulesPane } from "./rules.js";
import { splitter } from "./split.js";
import { SurfacePane } from "./surface.js";
import { ViewerPane } from "./viewer.js";
import { S } from "./strings.js";

/**
 * A view stands beside the text, one at a time; from two on there are tabs. Its panes are classes, made of the store and
 * of what a hand may do, with an element `section`. A view that is `drawn` needs a sound rule base.
 */
export const DESIGN = {
  name: "design",
  title: S.design,
  drawn: true,
  panes: [TermsPane, SurfacePane, RulesPane, ViewerPane],
  splits: [
    { key: "design-columns", vertical: true, at: 1, usual: 0.5 },
    { key: "design-rows", vertical: false, at: 1, usual: 0.5 },
  ],
};

const DARK = "(prefers-color-scheme: dark)";

/** What is around the text; `hand` says what a change in a picture does, and `root` is to be shown. */
export class Frame {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand} hand
   */
  constructor(store, hand, text, controls, shownViews) {
    this.store = store;
    this.hand = hand;
    this.shownViews = shownViews;

    this.note = el("p", { class: "note" });
    this.views = this.shownViews.map(({ name, title, drawn, panes, splits = [] }) => {
      const made = [...panes.map((Pane) => new Pane(this.store, hand).section), ...splits.map(splitter)];
      const panel = this.shownViews.length > 1 ? { role: "tabpanel", "aria-label": title } : {};
      return el(
        "div",
        { class: `pictures view-${name}${drawn ? " drawn" : ""}`, id: `view-${name}`, hidden: true, ...panel },
        ...made,
      );
    });
    this.area = el("div", { class: "area" }, this.note, ...this.views);
    const between = text ? [text, splitter({ key: "text", vertical: true, at: 1, usual: 0.35 })] : [];
    const main = el("main", { class: text ? "design" : "design alone" }, ...between, this.area);
    const gone = new AbortController();
    const help = helpButton(
      this.shownViews.map((view) => view.name),
      gone.signal,
    );
    const header = el(
      "header",
      {},
      el("h1", { textContent: S.designer }),
      ...controls,
      el("span", { class: "last" }, help, themeButton(this.store)),
    );
    this.shown = 0;
    this.tabs = this.shownViews.map(({ name }, i) =>
      el("button", { role: "tab", "aria-controls": `view-${name}`, onclick: () => this.press(i) }),
    );
    if (this.tabs.length > 1) header.lastChild.before(...this.tabLists());
    this.root = el("div", { class: "desk" }, header, main);

    this.turn(0);
    window.addEventListener(
      "keydown",
      (event) => {
        if (event.key === "F6" && this.root.isConnected) this.step(event);
      },
      gone,
    );
    matchMedia(DARK).addEventListener("change", () => this.store.emit("theme"), gone);
    this.store.on("closed", () => gone.abort());
    this.store.on("scene", this.sound);
    this.store.on("diagram", this.sound);
    this.store.on("stale", () => {
      this.note.textContent = this.store.why === "other" ? S.noRules : S.notDrawn;
      this.area.classList.add("stale"); // what is drawn is that of the last sound text
    });
  }

  /** Tabs of the views that everybody wants, and behind one word those that take their time. */
  tabLists() {
    const of = (isFurther) => this.tabs.filter((_, i) => Boolean(this.shownViews[i].further) === isFurther);
    const tabs = (name, list) => el("div", { role: "tablist", class: "tabs", "aria-label": name }, ...list);
    this.further = el("summary", {});
    const more = el("details", { class: "more" }, this.further, tabs(S.furtherViews, of(true)));
    more.addEventListener("focusout", ({ relatedTarget }) => {
      if (!more.contains(/** @type {Node} */ (relatedTarget))) more.open = false;
    });
    more.addEventListener("keydown", ({ key }) => {
      if (key !== "Escape") return;
      more.open = false;
      this.further.focus();
    });
    this.more = more;
    this.store.on("works", this.mark);
    return [tabs(S.views, of(false)), ...(of(true).length ? [more] : [])];
  }

  /** Say on the tabs which view is shown, which are at work, and which have nothing to do with this file. */
  mark = () => {
    const words = this.shownViews.map(({ name, title }) => (this.store.works.has(name) ? S.atWork(title) : title));
    this.tabs.forEach((tab, i) => {
      const why = this.shownViews[i].why?.(this.hand, this.store) ?? "";
      tab.textContent = words[i];
      tab.setAttribute("aria-selected", String(i === this.shown));
      tab.setAttribute("aria-disabled", String(Boolean(why)));
      tab.title = why;
    });
    if (!this.further) return;
    const shown = this.shownViews[this.shown].further ? words[this.shown] : "";
    const busy = this.shownViews.some(({ name, further }) => further && this.store.works.has(name));
    this.further.textContent = shown ? S.moreOf(shown) : busy ? S.atWork(S.moreViews) : S.moreViews;
    this.further.classList.toggle("chosen", Boolean(shown));
  };

  /** A hand has chosen a view: where panes are below each other, it is brought into sight. */
  press = (to) => {
    const why = this.shownViews[to].why?.(this.hand, this.store);
    if (why) return void this.hand.say(why);
    this.turn(to);
    if (this.more) this.more.open = false;
    if (matchMedia("(max-width: 950px)").matches) this.area.scrollIntoView();
  };

  /** Turn to a view by its name. */
  turnTo = (name) => this.turn(this.shownViews.findIndex((view) => view.name === name));

  sound = () => {
    this.area.classList.remove("stale");
    this.area.classList.toggle("as-diagram", this.store.asDiagram);
    this.turn(this.shown);
  };

  turn = (to) => {
    this.shown = to;
    this.note.hidden = !this.shownViews[this.shown].drawn || Boolean(this.store.scene ?? this.store.diagram);
    this.views.forEach((view, i) => {
      view.hidden = i !== this.shown || !this.note.hidden;
    });
    if (this.tabs.length > 1) this.mark();
    if (this.store.view === this.shownViews[this.shown].name) return;
    this.store.view = this.shownViews[this.shown].name;
    this.store.emit("view");
  };

  /** Go to the next pane, or with Shift to the one before: there are many stops of Tab between. */
  step = (event) => {
    if (document.querySelector("dialog[open]")) return;
    const panes = [...this.root.querySelectorAll(".pane")].filter((each) => each.offsetParent);
    const at = panes.findIndex((each) => each.contains(document.activeElement));
    const next = event.shiftKey ? Math.max(at, 0) - 1 : at + 1;
    event.preventDefault();
    panes.at(next % panes.length).focus();
  };
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
