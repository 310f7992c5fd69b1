// Text: CodeMirror over the socket. Findings, completion, hover, renaming, quick fixes and colours
// are the answers of the language server's queries; nothing of the language is known here.

import {
  EditorState,
  EditorView,
  Compartment,
  StateEffect,
  StateField,
  Decoration,
  ChangeSet,
  keymap,
  lineNumbers,
  highlightActiveLine,
  highlightSpecialChars,
  drawSelection,
  hoverTooltip,
  history,
  historyKeymap,
  defaultKeymap,
  undo,
  redo,
  autocompletion,
  completionKeymap,
  setDiagnostics,
  searchKeymap,
  highlightSelectionMatches,
  collab,
  sendableUpdates,
  receiveUpdates,
  getSyncedVersion,
} from "./vendor/codemirror.js";
import { el, pane } from "./draw.js";
import { ask, choose } from "./dialogs.js";
import { S } from "./strings.js";

const WAIT = 15; // ms after a key stroke before changes are sent
const [TRIES, BETWEEN] = [300, 20]; // how often, and every how many ms, it is looked whether they have come

/** The words of a hover as elements: pictures and code in the font of the text, nothing as markup. */
export function explained(markdown) {
  const parts = markdown.split(/^```\w*\n([\s\S]*?)\n```$/m);
  return parts.flatMap((part, i) => (i % 2 ? [el("pre", { textContent: part })] : words(part.trim())));
}

function words(text) {
  const found = [];
  let at = 0;
  for (const match of text.matchAll(/(`+)(.+?)\1(?!`)|\*\*(.+?)\*\*|\\(.)/gs)) {
    const [all, , code, strong, plain] = match;
    found.push(
      text.slice(at, match.index),
      code
        ? el("code", { textContent: code })
        : strong
          ? el("strong", { textContent: strong.replace(/\\(.)/g, "$1") })
          : plain,
    );
    at = match.index + all.length;
  }
  return [...found, text.slice(at)].filter((each) => each !== "");
}

const setColours = StateEffect.define();
const colourField = StateField.define({
  create: () => Decoration.none,
  update(colours, transaction) {
    colours = colours.map(transaction.changes);
    for (const effect of transaction.effects) if (effect.is(setColours)) colours = effect.value;
    return colours;
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** What has to change from one text to another: all between the ends that they share. */
export function difference(old, now) {
  const most = Math.min(old.length, now.length);
  let [from, end] = [0, 0];
  while (from < most && old[from] === now[from]) from++;
  while (end < most - from && old[old.length - 1 - end] === now[now.length - 1 - end]) end++;
  // A character of two units stays whole.
  if (from && /[\ud800-\udbff]/.test(old[from - 1])) from--;
  if (end && /[\udc00-\udfff]/.test(old[old.length - end])) end--;
  return { from, to: old.length - end, insert: now.slice(from, now.length - end) };
}

/** The pane and its editor; `link` talks to the server. */
export function textPane(link, nonce) {
  const { section, bar, body } = pane("text", S.text);
  const shared = new Compartment();
  const frozen = new Compartment(); // until the file is open there is nothing to write in
  const revert = el("button", {
    textContent: S.revert,
    title: S.revertHint,
    disabled: true,
    onclick: () => replace(link.saved()),
  });
  const list = el("ul", { class: "findings", "aria-label": S.findings });
  const host = el("div", { class: "editor" });
  let epoch = "";
  let findings = [];
  let sending = false;
  let waiting = 0;
  const quick = (text, title, act) => el("button", { textContent: text, title, onclick: act });
  bar.append(
    el("span", { class: "space" }),
    quick(S.undo, "Ctrl+Z", () => undo(view)),
    quick(S.redo, "Ctrl+Shift+Z", () => redo(view)),
    revert,
    quick(S.format, "Shift+Alt+F", format),
  );
  body.append(host, list);

  const view = new EditorView({
    parent: host,
    state: EditorState.create({
      doc: "",
      extensions: [
        lineNumbers(),
        highlightSpecialChars(),
        history(),
        drawSelection(),
        highlightActiveLine(),
        highlightSelectionMatches(),
        EditorView.cspNonce.of(nonce),
        EditorState.lineSeparator.of("\n"),
        colourField,
        EditorView.contentAttributes.of({ "aria-label": S.editor, tabindex: "0" }),
        autocompletion({ override: [completions] }),
        hoverTooltip(hovered),
        shared.of([]),
        frozen.of([EditorState.readOnly.of(true), EditorView.editable.of(false)]),
        keymap.of([
          { key: "Mod-s", run: () => link.save() ?? true },
          { key: "F2", run: () => rename() ?? true },
          { key: "Mod-.", run: () => fixes(head()) ?? true },
          { key: "Shift-Alt-f", run: () => format() ?? true },
          ...completionKeymap,
          ...defaultKeymap,
          ...historyKeymap,
          ...searchKeymap,
        ]),
        EditorView.updateListener.of((update) => {
          if (update.docChanged) {
            link.edited(view.state.doc.toString());
            clearTimeout(waiting);
            waiting = setTimeout(send, WAIT);
          }
        }),
      ],
    }),
  });

  // --- positions: line and unit from 0 on the wire, offsets in the editor ---

  const offset = ([line, unit]) => {
    const doc = view.state.doc;
    if (line >= doc.lines) return doc.length;
    const found = doc.line(line + 1);
    return Math.min(found.from + unit, found.to);
  };
  const position = (at) => {
    const line = view.state.doc.lineAt(at);
    return [line.number - 1, at - line.from];
  };
  const head = () => view.state.selection.main.head;

  // --- changes ---

  function send() {
    if (sending || !epoch) return;
    const updates = sendableUpdates(view.state);
    if (!updates.length) return;
    sending = link.push(
      getSyncedVersion(view.state),
      updates.map((update) => ({ clientID: update.clientID, changes: update.changes.toJSON() })),
    );
  }

  /** Take the changes of all windows from a version on; our own are confirmed by it. */
  function receive({ version, updates }) {
    sending = false;
    const known = getSyncedVersion(view.state) - version;
    const news = updates.slice(Math.max(0, known));
    if (known >= 0 && news.length) {
      view.dispatch(
        receiveUpdates(
          view.state,
          news.map((update) => ({ clientID: update.clientID, changes: ChangeSet.fromJSON(update.changes) })),
        ),
      );
    }
    send();
  }

  /** Start from the server's text. It comes as the change of somebody else, so that undo does not take it back. */
  function open(message) {
    epoch = message.epoch;
    sending = false;
    const change = difference(view.state.doc.toString(), message.text);
    // Without an old state of `collab` in between, the new one starts at its version.
    view.dispatch({ effects: shared.reconfigure([]) });
    view.dispatch({
      effects: [shared.reconfigure(collab({ startVersion: message.version - 1 })), frozen.reconfigure([])],
    });
    const changes = ChangeSet.of(change, view.state.doc.length);
    view.dispatch(receiveUpdates(view.state, [{ clientID: epoch, changes }]));
    link.edited(message.text);
  }

  /** Whether the server has everything that is here. */
  const settled = () => Boolean(epoch) && !sending && sendableUpdates(view.state).length === 0;

  /** Ask something of the text as it is: what is typed first goes first. */
  async function question(what, details = {}) {
    for (let tries = 0; tries < TRIES; tries++) {
      send();
      if (settled()) {
        const version = getSyncedVersion(view.state);
        const answer = await link.ask({ what, ...details });
        if (
          answer.version === undefined ||
          (settled() && version === answer.version && getSyncedVersion(view.state) === version)
        )
          return answer;
      }
      await new Promise((resolve) => setTimeout(resolve, BETWEEN));
    }
    return { error: S.gone };
  }

  /** Put the edits of an answer into the text: one step back undoes them. */
  function apply(answer, label) {
    if (answer.error) {
      link.say(answer.error);
      return false;
    }
    const changes = answer.edits
      ? answer.edits.map((edit) => ({ from: offset(edit.range[0]), to: offset(edit.range[1]), insert: edit.text }))
      : ChangeSet.fromJSON(answer.changes);
    view.dispatch({ changes, userEvent: label, scrollIntoView: false });
    send();
    return true;
  }

  async function format() {
    apply(await question("format"), "input.format");
  }

  async function rename() {
    const at = position(head());
    const found = await question("rename", { at });
    if (!found.name) return;
    const name = await ask(`${S.renameTo} ${found.name}`, found.name, S.rename);
    if (name && name !== found.name) apply(await question("rename", { at, name }), "input.rename");
    view.focus();
  }

  /** Offer the repairs of a finding; without its name those of all in the line. */
  async function fixes(offsetOfFinding, name = null) {
    const found = await question("fixes", { at: position(offsetOfFinding), name });
    if (!found.fixes?.length) {
      link.say(S.noFix);
      return;
    }
    const picked = await choose(
      S.fixes,
      found.fixes.map((fix) => fix.title),
    );
    if (picked !== null) apply(found.fixes[picked], "input.fix");
    view.focus();
  }

  async function completions(context) {
    const word = context.matchBefore(/[\w'-]*$/);
    if (!context.explicit && !word?.text && !/[ :\\']$/.test(context.state.doc.lineAt(context.pos).text)) return null;
    const answer = await question("complete", { at: position(context.pos) });
    if (!answer.options?.length || context.aborted) return null;
    const ranges = answer.options.map((each) => each.range).filter(Boolean);
    const from = ranges.length ? offset(ranges[0][0]) : (word?.from ?? context.pos);
    return {
      from,
      options: answer.options.map((each, rank) => ({
        label: each.label,
        detail: each.detail.slice(0, 60),
        apply: each.insert,
        boost: -rank,
        type: { term: "enum", shape: "function", value: "constant", row: "text" }[each.kind] ?? each.kind,
      })),
    };
  }

  async function hovered(_view, at) {
    const answer = await question("hover", { at: position(at) });
    if (!answer.markdown) return null;
    return {
      pos: offset(answer.range[0]),
      end: offset(answer.range[1]),
      above: true,
      create: () => ({ dom: el("div", { class: "hover" }, ...explained(answer.markdown)) }),
    };
  }

  // --- findings ---

  function show(message) {
    if (message.version !== getSyncedVersion(view.state) || !settled()) return;
    const doc = view.state.doc;
    const marks = [];
    for (const [line, start, end, colour] of message.colours) {
      const [from, to] = [offset([line, start]), offset([line, end])];
      if (to > from) marks.push(Decoration.mark({ class: `colour-${colour}` }).range(from, to));
    }
    findings = message.findings.map((each) => {
      const from = offset(each.range[0]);
      const to = Math.max(from, offset(each.range[1]));
      return { ...each, from, to: to > from ? to : Math.min(doc.length, from + 1) };
    });
    view.dispatch({ effects: setColours.of(Decoration.set(marks, true)) });
    view.dispatch(
      setDiagnostics(
        view.state,
        findings.map((each) => ({
          from: each.from,
          to: each.to,
          severity: each.severity,
          source: each.name,
          message: each.hint ? `${each.message}\n${each.hint}` : each.message,
        })),
      ),
    );
    list.replaceChildren(
      ...(findings.length ? findings.map(item) : [el("li", { class: "none", textContent: S.noFindings })]),
    );
  }

  function item(each) {
    const place = view.state.doc.lineAt(each.from).number;
    const text = `${place}: ${each.message}${each.hint ? ` (${each.hint})` : ""}`;
    // What only silences a finding does not mend it.
    const fix = el("button", {
      textContent: each.fixes.some(Boolean) ? S.fix : S.allow,
      onclick: () => fixes(each.from, each.name),
    });
    return el(
      "li",
      {},
      el("span", { class: each.severity, textContent: each.severity }),
      el("button", { class: "go", textContent: text, onclick: () => select(each.from, each.to) }),
      ...(each.fixes.length ? [fix] : []),
    );
  }

  function select(from, to) {
    view.dispatch({ selection: { anchor: from, head: to }, scrollIntoView: true });
    view.focus();
  }

  /** Wait until the server has everything that is here; whether it has. */
  async function sent() {
    for (let tries = 0; tries < TRIES && !settled(); tries++) {
      send();
      await new Promise((resolve) => setTimeout(resolve, BETWEEN));
    }
    return settled();
  }

  /** Put another text in the place of this one: one step back undoes it. */
  function replace(words) {
    view.dispatch({ changes: difference(view.state.doc.toString(), words), userEvent: "input.replace" });
    send();
  }

  return {
    section,
    view,
    question,
    sent,
    replace,
    close: () => view.destroy(),
    open,
    revertible(changed) {
      revert.disabled = !changed;
    },
    receive,
    show,
    settled,
    state: () => ({ text: view.state.doc.toString(), epoch }),
    undo: () => undo(view),
    redo: () => redo(view),
    version: () => getSyncedVersion(view.state),
    goTo: (at) => select(offset(at), offset(at)),
    edit: async (what, details) => apply(await question(what, details), `input.${what}`),
    /** Make an edit; what is wrong with it is in the answer. */
    async attempt(what, details) {
      const answer = await question(what, details);
      if (!answer.error) apply(answer, `input.${what}`);
      return answer;
    },
    numbers: async (variable) => (await question("numbers", { variable })).numbers ?? null,
  };
}
