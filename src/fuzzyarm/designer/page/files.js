// Files: what stands in the folder, new files, other names, and what is dropped on the page.

import { clean, el, keepFocus, pane } from "./draw.js";
import { choose, fill, tellAll } from "./dialogs.js";
import { exportPane } from "./exports.js";
import { invitation, offers } from "./starts.js";
import { S } from "./strings.js";
import { isTable } from "./table.js";

/**
 * The pane of the folder; `hand` asks the server, and turns to another file.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function folderPane(store, hand) {
  const { section, bar, body } = pane("folder", S.files);
  const list = el("tbody");
  const said = el("p", { class: "note", role: "status" });
  const chosen = el("input", {
    type: "file",
    class: "unseen",
    tabIndex: -1,
    "aria-hidden": "true",
    accept: hand.imports.join(),
    onchange: () => {
      if (chosen.files.length) bring(chosen.files);
      chosen.value = "";
    },
  });
  let files = [];
  let starts = {};
  let standing = ""; // what is said where there is nothing else
  let round = 0; // of asking for findings
  const create = el("button", { textContent: S.newFile, onclick: () => begin() });
  bar.append(
    el("span", { class: "space" }),
    create,
    el("button", { textContent: S.importFile, title: S.importHint, onclick: () => chosen.click() }),
    chosen,
  );
  const heads = [S.file, S.kind, S.description, S.findings, ""].map((words) =>
    words ? el("th", { scope: "col", textContent: words }) : el("td"),
  );
  const table = el("table", { class: "files" }, el("thead", {}, el("tr", {}, ...heads)), list);
  const below = el("div", { class: "beginning" });
  body.append(said, table, below);

  async function ask(question) {
    const answer = await hand.folder(question);
    if (answer.files) show(answer);
    said.textContent = standing;
    // A dialog says itself what is wrong.
    if (answer.error && !document.querySelector("dialog[open]")) said.textContent = clean(answer.error);
    return answer;
  }

  function show(answer) {
    ({ files, starts } = answer);
    hand.listed(files.map((each) => each.name));
    create.disabled = answer.only;
    const refocus = keepFocus(list);
    list.replaceChildren(...files.map((each) => row(each, answer.only)));
    refocus();
    table.hidden = !files.length;
    const act = { begin, convert, choose: () => chosen.click() };
    const isBegun = answer.only || files.some((each) => each.kind !== "table");
    below.replaceChildren(...(isBegun ? offers(answer.foreign, act) : invitation(answer, act)));
    standing = [answer.trouble, answer.only ? S.onlyOne : ""].filter(Boolean).join(" ");
    check(++round);
  }

  function row(each, only) {
    const here = each.name === hand.file();
    const open = el("button", {
      class: "go",
      textContent: each.name,
      onclick: () => hand.turnTo(each.name),
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
        act(S.duplicate, S.duplicateOf, () => duplicate(each.name)),
        act(S.renameFile, S.renameOf, () => rename(each.name)),
        act(S.deleteFile, S.deleteOf, () => remove(each)),
      ),
    );
  }

  /** Ask for the findings of one file after the other, while they are looked at. */
  async function check(mine) {
    for (const each of files) {
      if (mine !== round || store.view !== "files") return;
      const found = await hand.folder({ what: "findings", file: each.name });
      const words = found.error ?? found.summary;
      each.findings.textContent = clean(found.sound ? words : `${S.notSound}: ${words}`);
      each.findings.classList.toggle("error", !found.sound);
    }
  }

  /** Make a file: its kind is chosen before, or in the dialog. */
  async function begin(kind = "") {
    const ruleBases = files.filter((each) => each.kind === "rule base").map((each) => [each.name, each.name]);
    const kinds = Object.entries(starts).map(([name, words]) => [name, `${S.startTitles[name]}: ${words}`]);
    const around = {
      name: "around",
      label: S.around,
      options: ruleBases.length ? ruleBases : [["", S.shippedRules]],
      when: { kind: "controller" },
    };
    const made = await fill(
      kind ? S.startTitles[kind] : S.newFile,
      [
        { name: "name", label: S.nameOfFile, value: S.startNames[kind] ?? S.unnamed },
        ...(kind ? [] : [{ name: "kind", label: S.template, options: kinds, value: "pd" }]),
        ...(kind && kind !== "controller" ? [] : [around]),
      ],
      S.create,
      (values) => ask({ what: "new", kind, ...values }),
      kind ? starts[kind] : "",
    );
    if (made?.open) hand.turnTo(made.open);
  }

  /** Bring a file of the folder, which another program wrote, into the language. */
  async function convert(name) {
    said.textContent = S.converting(clean(name));
    await taken(name, await ask({ what: "convert", name }), true);
  }

  async function duplicate(file) {
    const made = await fill(
      S.duplicateOf(file),
      [{ name: "name", label: S.nameOfFile, value: S.copyOf(file) }],
      S.duplicate,
      (values) => ask({ what: "duplicate", file, ...values }),
    );
    if (made?.open) hand.turnTo(made.open);
  }

  async function users(file) {
    const found = (await hand.folder({ what: "users", file })).users ?? [];
    return found.length ? S.usedBy(found.join(", ")) : "";
  }

  async function rename(file) {
    await fill(
      S.renameOf(file),
      [{ name: "name", label: S.nameOfFile, value: file }],
      S.renameFile,
      (values) => ask({ what: "rename", file, ...values }),
      await users(file),
    );
  }

  async function remove(each) {
    const words = [each.changed ? S.unsavedGoes : "", await users(each.name), S.deleteForGood]
      .filter(Boolean)
      .join(" ");
    await fill(S.deleteOf(each.name), [], S.deleteFile, () => ask({ what: "delete", file: each.name }), words);
  }

  async function bring(dropped) {
    for (const each of dropped) await bringOne(each, dropped.length === 1);
  }

  async function bringOne(each, alone) {
    if (/\.py$/i.test(each.name)) return tellAll(each.name, [S.noScripts]);
    if (each.size > hand.largest) return tellAll(each.name, [S.tooLarge(each.size, hand.largest)]);
    said.textContent = S.converting(clean(each.name));
    let data;
    try {
      data = await encoded(each);
    } catch (error) {
      // a folder, or a file that has gone
      said.textContent = standing;
      return tellAll(S.notImported(each.name), [S.notRead(error.message)]);
    }
    return taken(each.name, await ask({ what: "import", name: each.name, data }), alone);
  }

  /** Say what came of a conversion, and open what it has made. */
  async function taken(name, answer, alone) {
    if (answer.error) return tellAll(S.notImported(name), [answer.error]);
    if (answer.only) return instead(name, answer);
    if (answer.findings.length) await tellAll(S.importedAs(name, answer.open), answer.findings);
    if (alone) hand.turnTo(answer.open);
    return null;
  }

  /** With one file open nothing is written beside it: what was dropped takes the place of its text. */
  async function instead(name, { text, findings, name: made }) {
    const same = isTable(made) === isTable(hand.file());
    if (!same) return tellAll(S.notImported(name), [S.otherKind(hand.file())]);
    const words = [S.replaceText(hand.file(), name), ...findings];
    if ((await choose(words.join("\n"), [S.replaceIt])) === 0) hand.replace(text);
    return null;
  }

  list.addEventListener("keydown", (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const names = [...list.querySelectorAll("button.go")];
    const at = names.indexOf(document.activeElement);
    if (!step || at < 0) return;
    event.preventDefault();
    names[Math.min(names.length - 1, Math.max(0, at + step))].focus();
  });
  hand.onDrop(bring);
  store.on("view", look);
  store.on("files", look);

  function look() {
    if (store.view === "files") ask({ what: "list" });
    else round++;
  }

  return section;
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
  panes: [folderPane, exportPane],
  splits: [{ key: "files-rows", vertical: false, at: 1, usual: 0.6 }],
};
