// Where to begin: what a folder without rule bases invites to, and files of other programs.

import { clean, el } from "./draw.js";
import { S } from "./strings.js";

/** A card for each kind of a new file, and what else one may do in a folder that has none. */
export function invitation({ starts, examples, foreign, trouble }, { begin, convert, choose }) {
  const cards = (title, files) =>
    el(
      "div",
      { class: "starts", role: "group", "aria-label": title },
      ...Object.entries(files).map(([kind, words]) =>
        el(
          "button",
          { disabled: Boolean(trouble), onclick: () => begin(kind) },
          el("strong", { textContent: S.startTitles[kind] ?? kind }),
          el("span", { textContent: words }),
        ),
      ),
    );
  return [
    el("h3", { textContent: S.emptyFolder }),
    el("p", { textContent: S.emptyHint }),
    cards(S.emptyFolder, starts),
    el("h3", { textContent: S.examples }),
    cards(S.examples, examples),
    ...offers(foreign, { convert }),
    el(
      "p",
      {},
      S.orImport,
      " ",
      el("button", { textContent: S.importFile, disabled: Boolean(trouble), onclick: choose }),
    ),
  ];
}

/** Files of other programs that stand in the folder: each is converted by a click. */
export function offers(foreign, { convert }) {
  if (!foreign.length) return [];
  const buttons = foreign.map((name) =>
    el("button", { textContent: clean(name), title: S.convertHint, onclick: () => convert(name) }),
  );
  return [
    el("p", {}, S.foreignFiles),
    el("div", { class: "foreign", role: "group", "aria-label": S.foreignFiles }, ...buttons),
  ];
}
