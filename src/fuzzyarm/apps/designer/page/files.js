// Files: what stands in the folder, new files, other names, and what is dropped on the page.

import { ARROWS, clean, el, keepFocus, pairsOf, space, tableOf } from "./draw.js";
import { choose, fill, tellAll } from "./dialogs.js";
import { ExportPane } from "./exports.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";

const WITH_RULES = ["pd", "pi", "single"]; // kinds of new files that have rules

/** The pane of the folder; `hand` asks the server, and turns to another file. */
class FolderPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "folder", S.files);
    const { bar, body } = this;
    this.said = el("p", { class: "note", role: "status" });
    this.chosen = el("input", {
      type: "file",
      class: "unseen",
      tabIndex: -1,
      "aria-hidden": "true",
      accept: this.hand.imports.join(),
      onchange: () => {
        if (this.chosen.files.length) this.bring(this.chosen.files);
        this.chosen.value = "";
      },
    });
    this.files = [];
    this.starts = {};
    this.examples = {};
    this.standing = ""; // what is said where there is nothing else
    this.round = 0; // of asking for findings
    // Until the folder is known there is nothing to choose from.
    this.create = el("button", { textContent: S.newFile, disabled: true, onclick: () => this.begin() });
    bar.append(
      space(),
      this.create,
      el("button", { textContent: S.importFile, title: S.importHint, onclick: () => this.chosen.click() }),
      this.chosen,
    );
    this.table = tableOf({ class: "files", head: [S.file, S.kind, S.description, S.findings, ""], rows: [] });
    this.list = this.table.tBodies[0];
    this.below = el("div", { class: "beginning" });
    body.append(this.said, this.table, this.below);

    this.list.addEventListener("keydown", (event) => {
      const step = -ARROWS[event.key]?.[1];
      const names = [...this.list.querySelectorAll("button.go")];
      const at = names.indexOf(document.activeElement);
      if (!step || at < 0) return;
      event.preventDefault();
      names[Math.min(names.length - 1, Math.max(0, at + step))].focus();
    });
    this.hand.onDrop(this.bring);
    this.store.on("view", this.look);
    this.store.on("files", this.look);
  }

  ask = async (question) => {
    const answer = await this.hand.folder(question);
    if (answer.files) this.show(answer);
    this.said.textContent = this.standing;
    // A dialog says itself what is wrong.
    if (answer.error && !document.querySelector("dialog[open]")) this.said.textContent = clean(answer.error);
    return answer;
  };

  show = (answer) => {
    ({ files: this.files, starts: this.starts, examples: this.examples } = answer);
    this.hand.listed(this.files.map((each) => each.name));
    this.create.disabled = answer.only;
    const refocus = keepFocus(this.list);
    this.list.replaceChildren(...this.files.map((each) => this.row(each, answer.only)));
    refocus();
    this.table.hidden = !this.files.length;
    const act = { begin: this.begin, convert: this.convert, choose: () => this.chosen.click() };
    const isBegun = answer.only || this.files.some((each) => each.kind !== "table");
    this.below.replaceChildren(...(isBegun ? offers(answer.foreign, act) : invitation(answer, act)));
    this.standing = [answer.trouble, answer.only ? S.onlyOne : ""].filter(Boolean).join(" ");
    this.check(++this.round);
  };

  row = (each, only) => {
    const here = each.name === this.hand.file();
    const open = el("button", {
      class: "go",
      textContent: each.name,
      onclick: () => this.hand.turnTo(each.name),
      "aria-current": here ? "true" : "false",
      "data-key": `open ${each.name}`,
    });
    const act = (words, label, doing) =>
      el("button", {
        textContent: words,
        "aria-label": label(each.name),
        onclick: doing,
        disabled: only,
        "data-key": label(each.name),
      });
    const findings = el("td", { class: "small", textContent: "…" });
    each.findings = findings;
    const head = el("th", { scope: "row" }, open);
    if (each.changed) head.append(el("span", { class: "small", textContent: ` ● ${S.unsaved}` }));
    return el(
      "tr",
      { class: here ? "here" : "" },
      head,
      el("td", { textContent: each.kind }),
      el("td", { textContent: each.description, title: each.description }),
      findings,
      el(
        "td",
        { class: "acts" },
        act(S.duplicate, S.duplicateOf, () => this.duplicate(each.name)),
        act(S.rename, S.renameOf, () => this.rename(each.name)),
        act(S.deleteFile, S.deleteOf, () => this.remove(each)),
      ),
    );
  };

  /** Ask for the findings of one file after the other, while they are looked at. */
  check = async (mine) => {
    for (const each of this.files) {
      if (mine !== this.round || this.store.view !== "files") return;
      const found = await this.hand.folder({ what: "findings", file: each.name });
      const words = found.sound ? found.summary : `${S.notSound}: ${found.summary}`;
      each.findings.textContent = clean(found.error ?? words);
      each.findings.classList.toggle("error", !found.sound);
    }
  };

  /** Make a file: its kind is chosen before, or in the dialog. */
  begin = async (kind = "") => {
    const ruleBases = pairsOf(this.files.filter((each) => each.kind === "rule base").map((each) => each.name));
    const kinds = Object.entries(this.starts).map(([name, words]) => [name, `${S.startTitles[name]}: ${words}`]);
    const shown = Object.entries(this.examples).map(([name, words]) => [name, S.exampleOf(name, words)]);
    const method = {
      name: "method",
      label: S.conclusions,
      options: Object.entries(S.methodsOfRules),
      value: "mamdani",
    };
    const around = {
      name: "around",
      label: S.around,
      options: ruleBases.length ? ruleBases : [["", S.shippedRules]],
      when: { kind: "controller" },
    };
    const made = await fill(
      kind ? (S.startTitles[kind] ?? S.exampleOf(kind, "")) : S.newFile,
      [
        {
          name: "name",
          label: S.name,
          value: S.startNames[kind] ?? (kind || S.unnamed),
          follow: kind ? null : this.named,
        },
        ...(kind ? [] : [{ name: "kind", label: S.template, options: [...kinds, ...shown], value: "pd" }]),
        ...(kind && !WITH_RULES.includes(kind) ? [] : [{ ...method, when: { kind: WITH_RULES } }]),
        ...(kind && kind !== "controller" ? [] : [around]),
      ],
      S.create,
      (values) => this.ask({ what: "new", kind, ...values }),
      this.starts[kind] ?? this.examples[kind] ?? "",
    );
    if (made?.open) this.hand.turnTo(made.open);
  };

  /** The name of a file of a kind that is chosen, where nobody has typed another: an example has its own. */
  named = ({ kind }) => (kind in this.examples ? kind : S.unnamed);

  /** Bring a file of the folder, which another program wrote, into the language. */
  convert = async (name) => {
    this.said.textContent = S.converting(clean(name));
    await this.taken(name, await this.ask({ what: "convert", name }), true);
  };

  duplicate = async (file) => {
    const made = await fill(
      S.duplicateOf(file),
      [{ name: "name", label: S.name, value: S.copyOf(file) }],
      S.duplicate,
      (values) => this.ask({ what: "duplicate", file, ...values }),
    );
    if (made?.open) this.hand.turnTo(made.open);
  };

  users = async (file) => {
    const found = (await this.hand.folder({ what: "users", file })).users ?? [];
    return found.length ? S.usedBy(found.join(", ")) : "";
  };

  rename = async (file) => {
    await fill(
      S.renameOf(file),
      [{ name: "name", label: S.name, value: file }],
      S.rename,
      (values) => this.ask({ what: "rename", file, ...values }),
      await this.users(file),
    );
  };

  remove = async (each) => {
    const words = [each.changed ? S.unsavedGoes : "", await this.users(each.name), S.deleteForGood]
      .filter(Boolean)
      .join(" ");
    await fill(S.deleteOf(each.name), [], S.deleteFile, () => this.ask({ what: "delete", file: each.name }), words);
  };

  bring = async (dropped) => {
    for (const each of dropped) await this.bringOne(each, dropped.length === 1);
  };

  bringOne = async (each, alone) => {
    if (/\.py$/i.test(each.name)) return tellAll(each.name, [S.noScripts]);
    if (each.size > this.hand.largest) return tellAll(each.name, [S.tooLarge(each.size, this.hand.largest)]);
    this.said.textContent = S.converting(clean(each.name));
    let data;
    try {
      data = await encoded(each);
    } catch (error) {
      // a folder, or a file that has gone
      this.said.textContent = this.standing;
      return tellAll(S.notImported(each.name), [S.notRead(error.message)]);
    }
    return this.taken(each.name, await this.ask({ what: "import", name: each.name, data }), alone);
  };

  /** Say what came of a conversion, and open what it has made. */
  taken = async (name, answer, alone) => {
    if (answer.error) return tellAll(S.notImported(name), [answer.error]);
    if (answer.only) return this.instead(name, answer);
    if (answer.samples) return void (this.said.textContent = clean(S.samplesHere(answer.samples)));
    if (answer.findings.length) await tellAll(S.importedAs(name, answer.open), answer.findings);
    if (alone) this.hand.turnTo(answer.open);
    return null;
  };

  /** With one file open nothing is written beside it: what was dropped takes the place of its text. */
  instead = async (name, { text, findings, name: made }) => {
    const kindOf = (file) => file.toLowerCase().match(/\.[^.]*$/)?.[0];
    const same = kindOf(made) === kindOf(this.hand.file());
    if (!same) return tellAll(S.notImported(name), [S.otherKind(this.hand.file())]);
    const words = [S.replaceText(this.hand.file(), name), ...findings];
    if ((await choose(words.join("\n"), [S.replaceIt])) === 0) this.hand.replace(text);
    return null;
  };

  look = () => {
    if (this.store.view === "files") this.ask({ what: "list" });
    else this.round++;
  };
}

// --- Where to begin: what a folder without rule bases invites to, and files of other programs ---

/** A card for each kind of a new file, and what else one may do in a folder that has none. */
function invitation({ starts, examples, foreign, trouble }, { begin, convert, choose }) {
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
function offers(foreign, { convert }) {
  if (!foreign.length) return [];
  const buttons = foreign.map((name) =>
    el("button", { textContent: clean(name), title: S.convertHint, onclick: () => convert(name) }),
  );
  return [
    el("p", {}, S.foreignFiles),
    el("div", { class: "foreign", role: "group", "aria-label": S.foreignFiles }, ...buttons),
  ];
}

/** The bytes of a file as text that JSON can have. */
async function encoded(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  const pieces = [];
  for (let i = 0; i < bytes.length; i += 0x8000) pieces.push(String.fromCharCode(...bytes.subarray(i, i + 0x8000)));
  return btoa(pieces.join(""));
}

/** Take files that are dropped anywhere on the page. */
export function dropped(bring) {
  const shade = el("div", { class: "shade", hidden: true }, el("strong", { textContent: S.dropHere }));
  document.body.append(shade);
  const carries = (event) => event.dataTransfer?.types.includes("Files");
  const take = (name, act) =>
    window.addEventListener(
      name,
      (event) => {
        if (!carries(event)) return;
        event.preventDefault();
        event.stopPropagation(); // the editor would take the text of the file
        act(event);
      },
      true,
    );
  take("dragenter", () => {
    shade.hidden = false;
  });
  take("dragover", () => {
    shade.hidden = false;
  });
  take("drop", (event) => {
    shade.hidden = true;
    bring([...event.dataTransfer.files]);
  });
  window.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) shade.hidden = true;
  });
}

export const FILES = {
  name: "files",
  title: S.files,
  drawn: false,
  panes: [FolderPane, ExportPane],
  splits: [{ key: "files-rows", vertical: false, at: 1, usual: 0.6 }],
};
