// Help: what is where, and every key, in a dialogue of the page.

import { el, space, tableOf } from "./draw.js";
import { showDialog } from "./dialogs.js";
import { S } from "./strings.js";

/** Show the help; `views` are the names of those that the page has. */
function showHelp(views) {
  if (document.querySelector("dialog[open]")) return;
  const close = el("button", { value: "", textContent: S.close, type: "submit" });
  const key = (each) => (/^[a-z]+$/.test(each) ? each : el("kbd", { textContent: each }));
  const words = (keys) => keys.split(" ").flatMap((each, i) => [...(i ? [" "] : []), key(each)]);
  const code = (line) => [el("code", { textContent: line })];
  const keys = (rows, shown) =>
    tableOf({ class: "keys", rows: rows.map(([first, does]) => [el("th", { scope: "row" }, ...shown(first)), does]) });
  const parts = S.help
    .filter(({ view }) => !view || views.includes(view))
    .map(({ title, words: lines, rows, isCode }) =>
      el(
        "section",
        {},
        el("h3", { textContent: title }),
        ...lines.map((line) => el("p", { textContent: line })),
        ...(rows.length ? [keys(rows, isCode ? code : words)] : []),
      ),
    );
  const body = el("div", { class: "parts", tabIndex: 0, role: "group", "aria-label": S.helpTitle }, ...parts);
  const title = el("div", { class: "row" }, el("strong", { textContent: S.helpTitle }), space(), close);
  showDialog(S.helpTitle, { class: "help" }, el("form", { method: "dialog" }, title, body));
  body.focus();
}

/** Whether a key is typed into something, and so says nothing to the page. */
const isTyped = (target) =>
  Boolean(target.closest?.(".cm-editor, textarea, select, input:not([type='range'], [type='checkbox'])"));

/** The button of the help, and the keys that open it while the page that has the button is shown. */
export function helpButton(views, gone) {
  const button = el("button", {
    class: "help",
    textContent: "?",
    title: S.helpHint,
    "aria-label": S.helpTitle,
    onclick: () => showHelp(views),
  });
  window.addEventListener(
    "keydown",
    (event) => {
      if (!button.isConnected || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key !== "F1" && (event.key !== "?" || isTyped(event.target))) return;
      event.preventDefault();
      showHelp(views);
    },
    { signal: gone },
  );
  return button;
}
