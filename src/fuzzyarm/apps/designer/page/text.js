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
  MapMode,
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
  undoDepth,
  redoDepth,
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
import { el, pane, space } from "./draw.js";
import { choose, rename } from "./dialogs.js";
import { splitter } from "./split.js";
import { S } from "./strings.js";

const FROZEN = [EditorState.readOnly.of(true), EditorView.editable.of(false)];
const PATIENCE = 700; // ms until it is said that a text is being checked
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
export class TextPane {
  constructor(link, nonce) {
    this.link = link;

    const { section, bar, body } = pane("text", S.text);
    this.section = section;
    this.shared = new Compartment();
    this.frozen = new Compartment(); // until the file is open there is nothing to write in
    this.revert = el("button", {
      textContent: S.revert,
      title: S.revertHint,
      disabled: true,
      onclick: () => this.replace(this.link.saved()),
    });
    this.list = el("ul", { class: "findings", "aria-label": S.findings });
    const host = el("div", { class: "editor" });
    this.epoch = "";
    this.picture = null; // the text that is drawn, and its changes since
    this.followed = new Set(); // pictures in which places are looked up
    this.findings = [];
    this.sending = false;
    let waiting = 0;
    this.undoing = this.quick(S.undo, "Ctrl+Z", this.undo);
    this.redoing = this.quick(S.redo, "Ctrl+Shift+Z", this.redo);
    bar.append(space(), this.undoing, this.redoing, this.revert, this.quick(S.format, "Shift+Alt+F", this.format));
    body.append(host, splitter({ key: "findings", vertical: false, at: 1, usual: 0.88 }), this.list);

    this.view = new EditorView({
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
          EditorView.domEventHandlers({ keydown: this.typed }),
          autocompletion({ override: [this.completions] }),
          hoverTooltip(this.hovered),
          this.shared.of([]),
          this.frozen.of(FROZEN),
          keymap.of([
            { key: "Mod-s", run: () => this.link.save() ?? true },
            { key: "F2", run: () => this.rename() ?? true },
            { key: "Mod-.", run: () => this.fixes(this.head()) ?? true },
            { key: "Shift-Alt-f", run: () => this.format() ?? true },
            ...completionKeymap,
            ...defaultKeymap,
            ...historyKeymap,
            ...searchKeymap,
          ]),
          EditorView.updateListener.of((update) => {
            this.undoing.disabled = update.state.readOnly || !undoDepth(update.state);
            this.redoing.disabled = update.state.readOnly || !redoDepth(update.state);
            if (update.docChanged) {
              for (const each of this.followed) each.since = each.since.compose(update.changes);
              this.link.edited(this.view.state.doc.toString());
              clearTimeout(waiting);
              waiting = setTimeout(this.send, WAIT);
            }
          }),
        ],
      }),
    });
  }

  close = () => {
    clearTimeout(this.late);
    this.view.destroy();
  };

  revertible = (changed) => {
    this.revert.disabled = !changed;
  };

  state = () => ({ text: this.view.state.doc.toString(), epoch: this.epoch });
  version = () => getSyncedVersion(this.view.state);
  undo = () => undo(this.view);
  redo = () => redo(this.view);
  goTo = (at) => this.select(this.offset(at), this.offset(at));

  /** A key that would change a text which is only read here: it is told who writes. */
  typed = ({ key, ctrlKey, metaKey }) => {
    const isTyping = !ctrlKey && !metaKey && (key.length === 1 || ["Enter", "Backspace", "Delete"].includes(key));
    if (isTyping && this.epoch && this.view.state.readOnly) this.link.say(S.follows);
  };

  edit = async (what, details) => this.apply(await this.ofPicture(what, details), `input.${what}`);

  /** Make an edit; what is wrong with it is in the answer. */
  attempt = async (what, details) => {
    const answer = this.link.writes() ? await this.ofPicture(what, details) : { error: S.follows };
    if (!answer.error) this.apply(answer, `input.${what}`);
    return answer;
  };

  numbers = async (variable) => (await this.question("numbers", { variable })).numbers ?? null;

  quick = (text, title, act) => el("button", { textContent: text, title, onclick: act });

  // --- positions: line and unit from 0 on the wire, offsets in the editor ---

  offset = ([line, unit]) => {
    const doc = this.view.state.doc;
    if (line >= doc.lines) return doc.length;
    const found = doc.line(line + 1);
    return Math.min(found.from + unit, found.to);
  };
  position = (at) => {
    const line = this.view.state.doc.lineAt(at);
    return [line.number - 1, at - line.from];
  };
  head = () => this.view.state.selection.main.head;

  /** Whether the server has everything that is here. */
  settled = () => Boolean(this.epoch) && !this.sending && sendableUpdates(this.view.state).length === 0;

  // --- changes ---

  send = () => {
    if (this.sending || !this.epoch || !this.link.sends()) return;
    const updates = sendableUpdates(this.view.state);
    if (!updates.length) return;
    this.check();
    this.sending = this.link.push(
      this.version(),
      updates.map((update) => ({ clientID: update.clientID, changes: update.changes.toJSON() })),
    );
  };

  /** Say that the text is being checked, where that takes its time. */
  check = () => {
    clearTimeout(this.late);
    this.late = setTimeout(() => {
      this.list.prepend(el("li", { class: "none", textContent: S.checking }));
    }, PATIENCE);
  };

  /** Take the changes of all windows from a version on; our own are confirmed by it. */
  receive = ({ version, updates }) => {
    this.sending = false;
    const known = this.version() - version;
    const news = updates.slice(Math.max(0, known));
    if (known >= 0 && news.length) {
      this.view.dispatch(
        receiveUpdates(
          this.view.state,
          news.map((update) => ({ clientID: update.clientID, changes: ChangeSet.fromJSON(update.changes) })),
        ),
      );
    }
    this.send();
  };

  /**
   * Start from the server's text. It comes as the change of somebody else, so that undo does not take it back. What has
   * been typed since `sent`, the text that the server was told of, is typed again behind it.
   */
  open = (message, sent = this.view.state.doc.toString()) => {
    const now = this.view.state.doc.toString();
    const { selection } = this.view.state;
    this.epoch = message.epoch;
    this.sending = false;
    const change = difference(now, message.text);
    // Without an old state of `collab` in between, the new one starts at its version.
    this.view.dispatch({ effects: this.shared.reconfigure([]) });
    this.view.dispatch({ effects: this.shared.reconfigure(collab({ startVersion: message.version - 1 })) });
    this.follow(!this.link.writes());
    const changes = ChangeSet.of(change, this.view.state.doc.length);
    this.view.dispatch(receiveUpdates(this.view.state, [{ clientID: this.epoch, changes }]));
    if (now !== sent) {
      const theirs = ChangeSet.of(difference(sent, message.text), sent.length);
      const typed = ChangeSet.of(difference(sent, now), sent.length).map(theirs);
      this.view.dispatch({ changes: typed, ...(message.text === sent ? { selection } : {}) });
    }
    this.link.edited(this.view.state.doc.toString());
    this.check();
  };

  /** Write here, or only show what another window writes. */
  follow = (follows) => {
    if (!this.epoch) return; // not open yet
    this.sending = false;
    this.view.dispatch({ effects: this.frozen.reconfigure(follows ? FROZEN : []) });
    if (!follows) this.send();
  };

  /** Ask something of the text as it is: what is typed first goes first. Details may be a function of that text. */
  question = async (what, details = {}) => {
    for (let tries = 0; tries < TRIES; tries++) {
      this.send();
      if (this.settled()) {
        const version = this.version();
        const asked = typeof details === "function" ? details() : details;
        if (!asked) return { error: S.changedMeanwhile };
        const answer = await this.link.ask({ what, ...asked });
        if (
          answer.version === undefined ||
          (this.settled() && version === answer.version && this.version() === version)
        )
          return answer;
      }
      await new Promise((resolve) => setTimeout(resolve, BETWEEN));
    }
    return { error: this.link.gone() };
  };

  // --- places of the picture, which is that of an older text while one types ---

  /** The text of the server is drawn now. */
  drawn = () => {
    this.followed.delete(this.picture);
    const { doc } = this.view.state;
    this.picture = this.settled() ? { doc, since: ChangeSet.empty(doc.length) } : null;
    if (this.picture) this.followed.add(this.picture);
  };

  /** Ask what names a cell or a line of the picture: it is meant where it stands in the text of now. */
  ofPicture = async (what, details) => {
    if (!details.cell && !details.line) return this.question(what, details);
    if (!this.picture) return { error: S.changedMeanwhile };
    const seen = { ...this.picture };
    this.followed.add(seen);
    const answer = await this.question(what, () => {
      const place = this.placeNow(seen, details.cell ?? [details.line, 1]);
      return place && { ...details, ...(details.cell ? { cell: place } : { line: place[0] }) };
    });
    this.followed.delete(seen);
    return answer;
  };

  /** Line and column, from 1, of what stood there in a picture; null where it has gone. */
  placeNow = ({ doc, since }, [line, column]) => {
    const { from, text } = doc.line(Math.min(line, doc.lines));
    const before = [...text].slice(0, column - 1).join("");
    const at = since.mapPos(from + before.length, 1, MapMode.TrackDel);
    if (at === null) return null;
    const now = this.view.state.doc.lineAt(at);
    return [now.number, [...now.text.slice(0, at - now.from)].length + 1];
  };

  /** Put the edits of an answer into the text: one step back undoes them. */
  apply = (answer, label) => {
    const error = answer.error ?? (this.link.writes() ? "" : S.follows);
    if (error) {
      this.link.say(error);
      return false;
    }
    const changes = answer.edits
      ? answer.edits.map((edit) => ({
          from: this.offset(edit.range[0]),
          to: this.offset(edit.range[1]),
          insert: edit.text,
        }))
      : ChangeSet.fromJSON(answer.changes);
    this.view.dispatch({ changes, userEvent: label, scrollIntoView: false });
    this.send();
    return true;
  };

  format = async () => {
    this.apply(await this.question("format"), "input.format");
  };

  rename = async () => {
    const at = this.position(this.head());
    const found = await this.question("rename", { at });
    if (!found.name || !this.section.isConnected) return; // another file is shown by now
    await rename(found.name, async (name) => {
      const answer = await this.question("rename", { at, name });
      if (!answer.error) this.apply(answer, "input.rename");
      return answer;
    });
    this.view.focus();
  };

  /** Offer the repairs of a finding; without its name those of all in the line. */
  fixes = async (offsetOfFinding, name = null) => {
    const found = await this.question("fixes", { at: this.position(offsetOfFinding), name });
    if (!this.section.isConnected) return;
    if (!found.fixes?.length) {
      this.link.say(found.error ?? S.noFix);
      return;
    }
    const version = this.version();
    const picked = await choose(
      S.fixes,
      found.fixes.map((fix) => fix.title),
    );
    const isSame = version === this.version();
    if (picked !== null) this.apply(isSame ? found.fixes[picked] : { error: S.changedMeanwhile }, "input.fix");
    this.view.focus();
  };

  completions = async (context) => {
    const word = context.matchBefore(/[\w'-]*$/);
    if (!context.explicit && !word?.text && !/[ :\\']$/.test(context.state.doc.lineAt(context.pos).text)) return null;
    const answer = await this.question("complete", { at: this.position(context.pos) });
    if (!answer.options?.length || context.aborted) return null;
    const ranges = answer.options.map((each) => each.range).filter(Boolean);
    const from = ranges.length ? this.offset(ranges[0][0]) : (word?.from ?? context.pos);
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
  };

  hovered = async (_view, at) => {
    const answer = await this.question("hover", { at: this.position(at) });
    if (!answer.markdown) return null;
    return {
      pos: this.offset(answer.range[0]),
      end: this.offset(answer.range[1]),
      above: true,
      create: () => ({ dom: el("div", { class: "hover" }, ...explained(answer.markdown)) }),
    };
  };

  // --- findings ---

  show = (message) => {
    if (message.version !== this.version() || !this.settled()) return;
    const doc = this.view.state.doc;
    const marks = [];
    for (const [line, start, end, colour] of message.colours) {
      const [from, to] = [this.offset([line, start]), this.offset([line, end])];
      if (to > from) marks.push(Decoration.mark({ class: `colour-${colour}` }).range(from, to));
    }
    for (const [line, verdict] of message.verdicts)
      marks.push(Decoration.line({ attributes: { "data-verdict": verdict } }).range(this.offset([line, 0])));
    this.findings = message.findings.map((each) => {
      const from = this.offset(each.range[0]);
      const to = Math.max(from, this.offset(each.range[1]));
      return { ...each, from, to: to > from ? to : Math.min(doc.length, from + 1) };
    });
    this.view.dispatch({ effects: setColours.of(Decoration.set(marks, true)) });
    this.view.dispatch(
      setDiagnostics(
        this.view.state,
        this.findings.map((each) => ({
          from: each.from,
          to: each.to,
          severity: each.severity,
          source: each.name,
          message: each.hint ? `${each.message}\n${each.hint}` : each.message,
        })),
      ),
    );
    clearTimeout(this.late);
    const further = message.more ? [el("li", { class: "none", textContent: S.more(message.more) })] : [];
    this.list.replaceChildren(
      ...(this.findings.length
        ? [...this.findings.map(this.item), ...further]
        : [el("li", { class: "none", textContent: S.noFindings })]),
    );
  };

  item = (each) => {
    const place = this.view.state.doc.lineAt(each.from).number;
    const text = `${place}: ${each.message}${each.hint ? ` (${each.hint})` : ""}`;
    // What only silences a finding does not mend it.
    const fix = el("button", {
      textContent: each.fixes.some(Boolean) ? S.fix : S.allow,
      onclick: () => this.fixes(each.from, each.name),
    });
    return el(
      "li",
      {},
      el("span", { class: each.severity, textContent: each.severity }),
      el("button", { class: "go", textContent: text, onclick: () => this.select(each.from, each.to) }),
      ...(each.fixes.length ? [fix] : []),
    );
  };

  select = (from, to) => {
    this.view.dispatch({ selection: { anchor: from, head: to }, scrollIntoView: true });
    this.view.focus();
  };

  /** Wait until the server has everything that is here; whether it has. */
  sent = async () => {
    for (let tries = 0; tries < TRIES && !this.settled(); tries++) {
      this.send();
      await new Promise((resolve) => setTimeout(resolve, BETWEEN));
    }
    return this.settled();
  };

  /** Put another text in the place of this one: one step back undoes it. */
  replace = (words) => {
    if (!this.link.writes()) {
      this.link.say(S.follows);
      return;
    }
    this.take(words);
  };

  take = (words) => {
    const now = this.view.state.doc.toString();
    if (now === words) return;
    this.view.dispatch({ changes: difference(now, words), userEvent: "input.replace" });
    this.send();
  };
}
