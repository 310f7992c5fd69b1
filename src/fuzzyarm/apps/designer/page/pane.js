// What all panes are: a title bar and a body, of the store and of what a hand may do; canvases that fill them.

import { context, eachFrame, el, keepFocus, pane } from "./draw.js";

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

/**
 * A canvas that fills its pane and is drawn again when its size or the theme changes.
 *
 * @param {Page.Store} store
 */
export function stage(store, body, draw) {
  const canvas = el("canvas", { role: "img" });
  const size = { width: 0, height: 0 };
  const redraw = eachFrame(() => {
    if (size.width > 4 && size.height > 4) draw(context(canvas, size.width, size.height));
  });
  new ResizeObserver(([entry]) => {
    size.width = entry.contentRect.width;
    size.height = entry.contentRect.height;
    redraw();
  }).observe(body);
  store.on("theme", redraw);
  body.append(canvas);
  return { canvas, redraw };
}
