// Canvases that fill their panes, their colours, and fields with labels.

import { el, context, colourOf, eachFrame } from "./draw.js";

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

/** The colours of canvases, as the theme has them now. */
export function inks() {
  return {
    ink: colourOf("--ink"),
    soft: colourOf("--soft"),
    line: colourOf("--line"),
    pane: colourOf("--pane"),
    lines: [colourOf("--accent"), colourOf("--lit"), colourOf("--number"), colourOf("--keyword")],
  };
}

/** A field with its label, for the bar of a view. */
export function field(label, input, hint = "") {
  if (hint) input.title = hint;
  return el("label", { class: "field" }, el("span", { textContent: label }), input);
}
