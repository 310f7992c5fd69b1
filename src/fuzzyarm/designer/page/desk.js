// A desk: one file of the folder, with its text, its views, and what of it is not saved.
//
// Every file that is looked at has a desk of its own, of which one is shown. So what belongs to a file
// stays with it: steps back, the cursor, the point, the view, what a search or a run has found.

import { ask, choose, fill } from "./dialogs.js";
import { clean, el } from "./draw.js";
import { frame } from "./frame.js";
import { askServer } from "./remote.js";
import { Store } from "./store.js";
import { textPane } from "./text.js";
import { S } from "./strings.js";

const FILES = "files"; // the view of the folder

/** Make the desk of a file; `page` is what all desks share, `views` which views it has. */
export function makeDesk(file, page, views) {
  const { connection } = page;
  const store = new Store();
  const status = el("span", { id: "status", role: "status" });
  const save = el("button", { textContent: S.save, title: "Ctrl+S", disabled: true, onclick: () => link.save() });
  const files = el("select", {
    "aria-label": S.file,
    onchange() {
      const to = files.value;
      files.value = file; // here it says what is shown here
      page.turnTo(to);
    },
  });
  let saved = null; // the text on disk, as the server knows it
  let apart = false; // whether the file says something else than what was saved, or is gone
  let dirty = false;
  let lost = false;
  let latest = null; // findings, which come in front of the picture of the same text
  const working = new Set(); // long works that go on
  let bring = null; // takes files that are dropped
  let left = []; // what was scrolled, and the focus, when another desk was shown

  const send = (message) => connection.send({ ...message, file });

  const link = {
    push: (version, updates) => send({ do: "push", version, updates }),
    ask: (question) => connection.ask(file, question),
    save() {
      const trySave = () => {
        if (!text.settled()) setTimeout(trySave, 20);
        else send({ do: "save" });
      };
      trySave();
      return true;
    },
    say(words) {
      status.textContent = clean(words);
    },
    edited(now) {
      mark(saved !== null && (apart || now !== saved));
    },
    saved: () => saved,
  };

  function mark(changed) {
    dirty = changed;
    save.disabled = !changed;
    text.revertible(changed);
    if (!lost) status.textContent = changed ? S.unsaved : S.saved;
    page.marked();
  }

  function start(what, asked_for, hear) {
    const job = connection.start(file, what, asked_for, (news) => {
      if (news.end) working.delete(job);
      hear(news);
    });
    working.add(job);
    return job;
  }

  const text = textPane(link, page.nonce);
  const hand = {
    edit: (shapes) => text.edit("shapes", { shapes }),
    change: (what, details) => text.edit(what, details), // an edit that the server makes
    attempt: (what, details) => text.attempt(what, details), // the same, of a dialog that says what is wrong
    askFor: ask,
    choose,
    fill,
    numbers: (variable) => text.numbers(variable),
    ask: link.ask,
    start,
    setCell: (cell, term) => text.edit("cell", { cell, term }),
    setGain: (name, values) => text.edit("gain", { name, values }),
    text: () => text.state().text,
    goTo: (at) => text.goTo(at),
    save: () => saveNow(),
    saveFile: connection.save,
    unsaved: page.unsaved,
    askNow: (what, details) => text.question(what, details), // of the text as it is typed
    settled: () => text.sent(),
    replace: (words) => text.replace(words),
    folder: connection.folder,
    file: () => file,
    onDrop(act) {
      bring = act;
    },
    largest: page.largest,
    imports: page.imports,
    listed: page.listed,
    turnTo: page.turnTo,
  };
  /** Save, and wait until the server has; whether what is here is saved. */
  async function saveNow() {
    if (!dirty) return true;
    const { error } = (await text.sent()) ? await connection.save(file) : { error: S.gone };
    if (error) link.say(error);
    return !error;
  }

  askServer(store, start);
  const banner = el("div", { class: "banner", role: "alert", hidden: true });
  const chooser = page.only ? el("strong", { textContent: file }) : files;
  // Where there is no file there is nothing to be typed and saved.
  const controls = [...(file ? [chooser, save, status] : [status]), el("span", { class: "space" })];
  const { root, turn } = frame(store, hand, file ? text.section : null, controls, views);
  root.querySelector("main").before(banner);

  function tell(words, ...buttons) {
    banner.replaceChildren(clean(words), ...buttons);
    banner.hidden = !words;
  }

  /** Tell the server that this file is open, and what has been typed without it. */
  function open() {
    if (!file) {
      // the folder is empty
      back();
      return;
    }
    const { epoch, text: now } = text.state();
    send(epoch ? { do: "open", epoch, version: text.version(), text: now, saved } : { do: "open" });
  }

  function back() {
    const before = lost;
    lost = false;
    tell("");
    if (!before) return;
    if (file) link.say(S.back);
    store.emit("view"); // what was asked for meanwhile has not been answered
  }

  const TAKEN = {
    opened(message) {
      saved = message.saved;
      back();
      text.open(message);
    },
    reopened(message) {
      saved = message.saved;
      back();
      text.receive(message); // and what was typed meanwhile is sent
      mark(text.state().text !== saved);
    },
    updates: (message) => text.receive(message),
    findings(message) {
      text.show(message);
      latest = message;
      store.emit("text"); // what was asked of an older text may be asked again
    },
    scene(message) {
      if (message.version !== text.version()) return;
      store.findings = latest?.version === message.version ? latest.findings : [];
      if (message.scene) store.show(message.scene);
      if (message.diagram || message.why !== "mistakes") store.draw(message.diagram);
      if (!message.scene && !message.diagram) store.mistaken(message.why);
      store.judge(message.why !== "mistakes");
    },
    status(message) {
      saved = message.saved ?? saved;
      apart = message.gone || message.conflict;
      mark(apart || text.state().text !== saved);
      if (!message.conflict) {
        tell(message.gone ? S.fileGone : "");
        return;
      }
      const settle = (words, mine) => el("button", { textContent: words, onclick: () => send({ do: "settle", mine }) });
      if (message.unreadable) tell(S.unreadable(message.unreadable), settle(S.keepMine, true));
      else if (message.elsewhere) tell(S.otherWindow, settle(S.keepThis, true), settle(S.takeOther, false));
      else tell(S.conflict, settle(S.keepMine, true), settle(S.takeTheirs, false));
    },
    failed(message) {
      if (text.state().epoch && !lost) link.say(message.message);
      else tell(message.message);
      if (!text.state().epoch) turn(FILES); // the file cannot be opened; from there others can
    },
  };

  /** Put this desk in the place of another one, as it was left. */
  function show(other) {
    if (other) other.root.replaceWith(root);
    else document.body.append(root);
    for (const [element, top, across] of left) element.scrollTo(across, top);
    store.emit("theme"); // it may be another one now
    store.emit("view"); // and what is asked for a view may have changed meanwhile
    store.emit("shown");
  }

  /** Remember what goes when elements leave the document; call it before another desk is shown. */
  function leave() {
    const scrolled = [...root.querySelectorAll("*")].filter((each) => each.scrollTop || each.scrollLeft);
    left = scrolled.map((each) => [each, each.scrollTop, each.scrollLeft]);
    store.emit("left");
  }

  return {
    root,
    store,
    text,
    show,
    leave,
    open,
    turn,
    file: () => file,
    view: () => store.view,
    isDirty: () => dirty,
    /** Whether nothing is lost with this desk but the steps back: an unsaved text asks before the page is left. */
    isIdle: () => text.settled() && !dirty && !working.size && banner.hidden,
    focus: (onChooser) => (onChooser || !file ? files : text.view).focus(),
    take: (message) => TAKEN[message.is]?.(message),
    undo: text.undo,
    redo: text.redo,
    save: link.save,
    say: link.say,
    bring: (dropped) => bring(dropped),
    offer(names) {
      const all = names.includes(file) ? names : [file, ...names]; // one that has gone is still shown
      files.replaceChildren(...all.map((name) => el("option", { value: name, textContent: name })));
      files.value = file;
    },
    move(to) {
      file = to;
      mark(dirty);
      if (text.state().epoch) open(); // what was on its way under the old name has not arrived
    },
    lose() {
      if (!lost) tell(S.gone);
      lost = true;
    },
    close() {
      store.emit("closed");
      for (const job of working) job.stop();
      text.close();
      send({ do: "close" });
    },
  };
}
