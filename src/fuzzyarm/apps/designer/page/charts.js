// Canvases that fill their panes.

import { el, context, eachFrame } from "./draw.js";

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
