// What all panes are: a title bar and a body, of the store and of what a hand may do.

import { keepFocus, pane } from "./draw.js";

export class Pane {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand | null} hand
   * @param {string} kind its class in the style sheet
   * @param {string} title
   */
  constructor(store, hand, kind, title) {
    const { section, bar, body } = pane(kind, title);
    this.store = store;
    this.hand = hand;
    /** @type {any} what a view shows: the pane, or with others beside it */
    this.section = section;
    this.bar = bar;
    this.body = body;
  }

  /** Put other tools into the bar, behind its title. */
  setTools(...tools) {
    const refocus = keepFocus(this.bar);
    this.bar.replaceChildren(this.bar.firstChild, ...tools);
    refocus();
  }

  /** Listen to several things of the store. */
  on(names, listener) {
    for (const name of names) this.store.on(name, listener);
  }
}
