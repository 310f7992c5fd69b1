// The text of a page without a server: to be read, with the numbers that a hand has changed.

import { clean, el, pane, space } from "./draw.js";
import { S } from "./strings.js";

/** A number as the language writes it. */
function written(x) {
  return String(x);
}

/** The words of a shape as the language writes them, over those of its lower function. */
function shapeText({ kind, parameters, height, lower }) {
  const numbers = parameters.map(written);
  const body =
    kind === "points"
      ? numbers.flatMap((x, i) => (i % 2 ? [] : [`(${x}, ${numbers[i + 1]})`])).join(" ")
      : numbers.join(" ");
  const below = lower ? ` over ${shapeText(lower)}` : "";
  return `${kind} ${body}${height === 1 ? "" : ` height ${written(height)}`}${below}`;
}

/** The pane of a text; `reshape` puts the shapes of terms into it. */
export function listingPane({ text, colours, places }) {
  const { section, bar, body } = pane("text", S.text);
  const area = el("pre", { class: "listing", tabIndex: 0, "aria-label": S.editor });
  const edits = new Map();
  bar.append(space(), el("span", { class: "small", textContent: S.readOnly }));
  body.append(area);

  const starts = [0];
  for (let i = text.indexOf("\n"); i >= 0; i = text.indexOf("\n", i + 1)) starts.push(i + 1);
  const words = colours.map(([line, from, to, colour]) => [starts[line] + from, starts[line] + to, colour]);

  function draw() {
    // Edits are those of the first text, in its positions; several may stand at one place.
    const changes = [...edits.values()].sort((a, b) => a.from - b.from);
    const parts = [];
    let at = 0;
    const plain = (end) => {
      for (const [from, to, colour] of words) {
        if (to <= at || from >= end) continue;
        if (from > at) parts.push(clean(text.slice(at, from)));
        parts.push(
          el("span", { class: `colour-${colour}`, textContent: text.slice(Math.max(at, from), Math.min(to, end)) }),
        );
        at = Math.min(to, end);
      }
      if (end > at) parts.push(clean(text.slice(at, end)));
      at = Math.max(at, end);
    };
    for (const change of changes) {
      plain(change.from);
      parts.push(el("mark", { textContent: change.text }));
      at = Math.max(at, change.to);
    }
    plain(text.length);
    area.replaceChildren(...parts);
  }

  draw();
  return {
    section,
    reshape(shapes) {
      for (const shape of shapes) {
        const place = places.find((each) => each.variable === shape.variable && each.term === shape.term);
        if (!place) continue;
        const said = place.before + shapeText(shape);
        edits.set(`${shape.variable}\n${shape.term}`, { from: place.from, to: place.to, text: said });
      }
      draw();
    },
  };
}
