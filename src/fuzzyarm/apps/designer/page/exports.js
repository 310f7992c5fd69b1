// Exports of the text as it is now: a dialog for each kind, with what the command has as options.

import { clean, el, pairsOf } from "./draw.js";
import { showDialog } from "./dialogs.js";
import { Form } from "./form.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { Task } from "./task.js";

const TABLES = [".lut", ".csv", ".tex", ".json", ".npz"];
const GROUPS = { programs: [], tables: TABLES, pictures: [".png", ".svg"], others: [".fis", ".fll", ".fcl", ".fml"] };

/**
 * Suffixes by the group in which they stand; every other one is a program.
 *
 * @param {string[]} suffixes
 */
export function groupsOf(suffixes) {
  const groupOf = (suffix) => Object.keys(GROUPS).find((name) => GROUPS[name].includes(suffix)) ?? "programs";
  return Object.keys(GROUPS)
    .map((name) => /** @type {const} */ ([name, suffixes.filter((suffix) => groupOf(suffix) === name)]))
    .filter(([, own]) => own.length);
}

/** The pane of the exports of the file that is open. */
export class ExportPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "exports", S.exports);
    const { body } = this;
    this.groups = el("div", { class: "groups" });
    body.append(el("p", { class: "note", textContent: S.exportsNote }), this.groups);
    store.on("view", this.build);
    store.on("text", this.build);
  }

  build = async () => {
    if (this.store.view !== "files" || !this.hand.file()) return;
    const { forms = {} } = await this.hand.askNow("exports");
    const groups = groupsOf(Object.keys(forms));
    this.groups.replaceChildren(...groups.map(([name, suffixes]) => this.group(name, suffixes, forms)));
  };

  group = (name, suffixes, forms) => {
    const buttons = suffixes.map((suffix) =>
      el("button", {
        textContent: S.exportKinds[suffix] ?? suffix,
        title: suffix,
        onclick: () => exportDialog(this.store, this.hand, suffix, forms[suffix]),
      }),
    );
    const title = S.exportGroups[name];
    return el("div", { role: "group", "aria-label": title }, el("h3", { textContent: title }), ...buttons);
  };
}

/**
 * The dialog of a kind, with what the command has as options.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function exportDialog(store, hand, suffix, fields) {
  const state = el("p", { class: "state", role: "status" });
  const links = el("ul", { class: "made" });
  const lines = el("pre", { class: "printed", tabIndex: 0, hidden: true, "aria-label": S.report });
  const go = el("button", { type: "submit", textContent: S.exports });
  const close = el("button", { type: "button", textContent: S.close, onclick: () => dialog.close() });
  const asked = new Form({ changed: (name) => name === "way" && showTable() });
  asked.open(fields);
  if (asked.has("way")) asked.choices("way", S.exportWays);
  const ofTables = ["levels", "mode", ...(store.scene ? ["q"] : [])]; // a controller may look up tables of integers
  const showTable = () => asked.show(ofTables, !asked.has("way") || asked.shown("way") === "table");
  showTable();
  const outputs = pairsOf((store.scene?.outputs ?? []).map((each) => each.name));
  const every = TABLES.includes(suffix) ? [] : [["", S.everyOutput]]; // a table has one output
  asked.choices("output", [...every, ...outputs]);
  asked.show(["output"], outputs.length > 1);
  const form = el(
    "form",
    { class: "exporting" },
    el("strong", { textContent: S.exportTitle(S.exportKinds[suffix] ?? suffix, hand.file()) }),
    asked.view,
    state,
    links,
    lines,
    el("div", { class: "row" }, close, go),
  );
  const task = new Task(hand, "export");
  let isMeasured = false; // whether the lines have the error of a table
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (go.disabled) return;
    asked.mark("");
    go.disabled = true;
    links.replaceChildren();
    lines.hidden = true;
    state.textContent = S.working;
    state.classList.remove("error");
    task.beginSettled(() => ({ suffix, options: asked.values() }), hear); // what is typed is exported
  });

  function hear(news) {
    if (news.doing) state.textContent = clean(`${news.doing} …`);
    if (news.files) show(news);
    if (!news.end) return;
    go.disabled = false;
    if (news.end === "failed") {
      state.textContent = asked.mark(news.field ?? "", news.message) ? "" : clean(news.message);
      state.classList.add("error");
    } else if (news.end === "done") state.textContent = isMeasured ? S.exportedTable : S.exported;
  }

  function show({ files, lines: said, measured }) {
    isMeasured = measured;
    const loads = files.map(({ name, bytes, href }) =>
      el("a", { href, download: name, textContent: S.download(clean(name), bytes) }),
    );
    links.replaceChildren(...loads.map((link) => el("li", {}, link)));
    lines.textContent = clean(said.join("\n"));
    lines.hidden = !said.length;
    if (loads.length === 1 && !measured) loads[0].click(); // the error of a table is read first
  }

  const { dialog, closed } = showDialog(S.exports, {}, form);
  closed.then(() => task.drop());
  if (!fields.length) form.requestSubmit();
}
