// The page of the server: one socket, one file at a time.

import { COMPARE } from "./compare.js";
import { ask } from "./dialogs.js";
import { clean, el } from "./draw.js";
import { FILES } from "./files.js";
import { DESIGN, frame } from "./frame.js";
import { LEARN } from "./learn.js";
import { RUN } from "./run.js";
import { askServer } from "./remote.js";
import { Store } from "./store.js";
import { TABLE } from "./table.js";
import { textPane } from "./text.js";
import { TUNE } from "./tune.js";
import { S } from "./strings.js";

const VIEWS = [DESIGN, RUN, TABLE, LEARN, TUNE, COMPARE, FILES];

const start = JSON.parse(document.getElementById("start").textContent);
const store = new Store();
const status = el("span", { id: "status", role: "status" });
const save = el("button", { textContent: S.save, title: "Ctrl+S", disabled: true, onclick: () => link.save() });
const files = el("select", { "aria-label": S.file, onchange: () => turnTo(files.value) });
listed(start.files);

let socket = null;
let file = new URLSearchParams(location.hash.slice(1)).get("file") ?? start.files[0] ?? "";
if (!start.files.includes(file)) file = start.files[0] ?? "";
files.value = file;

/** Offer these files; the one that is shown stays chosen. */
function listed(names) {
  const shown = files.value;
  files.replaceChildren(...names.map((name) => el("option", { value: name, textContent: name })));
  files.value = shown;
}

let saved = null; // the text on disk, as the server knows it
let gone = false; // whether the file is
let dirty = false;
let lost = false;
let turning = false; // to another file of this page
let asked = 0;
let latest = null; // findings, which come in front of the picture of the same text
const answers = new Map();
const jobs = new Map(); // what hears of long work, by its number

const link = {
  push: (version, updates) => send({ do: "push", version, updates }),
  ask(question) {
    const id = ++asked;
    return new Promise((resolve) => {
      if (send({ do: "ask", id, ...question })) answers.set(id, resolve);
      else resolve({ error: S.gone });
    });
  },
  /** Ask of the folder, or have something done in it. */
  folder(question) {
    const id = ++asked;
    return new Promise((resolve) => {
      if (send({ do: "folder", id, ...question })) answers.set(id, resolve);
      else resolve({ error: S.gone });
    });
  },
  /** Begin long work. `hear` takes its news, the last with `end`; it is told and stopped by what comes back. */
  start(what, asked_for, hear) {
    const id = ++asked;
    if (send({ do: "start", id, what, ...asked_for })) jobs.set(id, hear);
    else queueMicrotask(() => hear({ end: "failed", message: S.gone }));
    return {
      say: (words) => send({ do: "say", id, ...words }),
      stop: () => send({ do: "stop", id }),
    };
  },
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
    mark(saved !== null && (gone || now !== saved));
  },
};

function mark(changed) {
  dirty = changed;
  save.disabled = !changed;
  if (!lost) status.textContent = changed ? S.unsaved : S.saved;
  document.title = `${changed ? "● " : ""}${file} – ${S.designer}`;
}

const text = textPane(link, start.nonce);
const hand = {
  edit: (shapes) => text.edit("shapes", { shapes }),
  change: (what, details) => text.edit(what, details), // an edit that the server makes
  askFor: ask,
  numbers: (variable) => text.numbers(variable),
  ask: (question) => link.ask(question),
  start: (what, asked_for, hear) => link.start(what, asked_for, hear),
  setCell: (cell, term) => text.edit("cell", { cell, term }),
  setGain: (name, values) => text.edit("gain", { name, values }),
  text: () => text.state().text,
  goTo: (at) => text.goTo(at),
  askNow: (what, details) => text.question(what, details), // of the text as it is typed
  settled: () => text.sent(),
  replace: (words) => text.replace(words),
  folder: (question) => link.folder(question),
  file: () => file,
  largest: start.largest,
  listed,
  turnTo,
};
askServer(store, hand.start);
const banner = el("div", { class: "banner", role: "alert", hidden: true });
const chooser = start.only ? el("strong", { textContent: file }) : files;
const views = frame(store, hand, text.section, [chooser, save, status, el("span", { class: "space" })], VIEWS);
document.querySelector("main").before(banner);
if (/\.lut$/i.test(file)) views.turn(TABLE.name);

function tell(words, ...buttons) {
  banner.replaceChildren(clean(words), ...buttons);
  banner.hidden = !words;
}

// --- the socket ---

function send(message) {
  if (socket?.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify(message));
  return true;
}

function connect() {
  const address = new URL("socket", location.href);
  address.protocol = "ws:";
  address.hash = "";
  socket = new WebSocket(address);
  socket.onopen = () => {
    if (!file) { // the folder is empty
      lost = false;
      tell("");
      views.turn(FILES.name);
      return;
    }
    const { epoch, text: now } = text.state();
    send(epoch
      ? { do: "open", file, epoch, version: text.version(), text: now, saved }
      : { do: "open", file });
  };
  socket.onmessage = (event) => take(JSON.parse(event.data));
  socket.onclose = () => {
    for (const resolve of answers.values()) resolve({ error: S.gone });
    answers.clear();
    for (const hear of jobs.values()) hear({ end: "failed", message: S.gone });
    jobs.clear();
    if (!lost) {
      lost = true;
      tell(S.gone);
    }
    setTimeout(connect, 700);
  };
}

const TAKEN = {
  opened(message) {
    saved = message.saved;
    if (lost) link.say(S.back);
    lost = false;
    tell("");
    text.open(message);
  },
  reopened(message) {
    saved = message.saved;
    lost = false;
    tell("");
    text.receive(message); // and what was typed meanwhile is sent
    mark(text.state().text !== saved);
  },
  updates: (message) => text.receive(message),
  findings(message) {
    text.show(message);
    latest = message;
    store.emit("text"); // what was asked of an older text may be asked again
  },
  moved(message) {
    if (!message.file) text.drop(); // deleted: nothing of it is kept
    turnTo(message.file);
  },
  scene(message) {
    if (message.version !== text.version()) return;
    store.findings = latest?.version === message.version ? latest.findings : [];
    if (message.scene) store.show(message.scene);
    else store.mistaken(message.why);
    store.judge(message.why !== "mistakes");
  },
  answer(message) {
    answers.get(message.id)?.(message);
    answers.delete(message.id);
  },
  job(message) {
    const hear = jobs.get(message.id);
    if (message.end) jobs.delete(message.id);
    hear?.(message);
  },
  status(message) {
    saved = message.saved ?? saved;
    gone = message.gone;
    mark(gone || text.state().text !== saved);
    if (!message.conflict) {
      tell(gone ? S.fileGone : "");
      return;
    }
    const settle = (words, mine) => el("button", {
      textContent: words, onclick: () => send({ do: "settle", mine }),
    });
    if (message.unreadable) tell(S.unreadable(message.unreadable), settle(S.keepMine, true));
    else tell(S.conflict, settle(S.keepMine, true), settle(S.takeTheirs, false));
  },
  failed(message) {
    if (text.state().epoch && !lost) link.say(message.message);
    else tell(message.message); // the file cannot be opened
  },
};

function take(message) {
  TAKEN[message.is]?.(message);
}

/** Show another file, when the server has all that was typed; what is not saved stays with it. */
async function turnTo(name) {
  if (text.state().epoch && !(await text.sent())) {
    files.value = file;
    link.say(S.gone);
    return;
  }
  turning = true;
  location.hash = new URLSearchParams({ file: name });
  location.reload();
}

window.addEventListener("beforeunload", (event) => {
  if (dirty && !turning) event.preventDefault();
});
window.addEventListener("keydown", (event) => {
  if (!event.ctrlKey && !event.metaKey) return;
  const key = event.key.toLowerCase();
  const writing = event.target.closest?.(".cm-editor, input[type='text']"); // has its own steps back
  const act = key === "s" ? link.save
    : writing ? null
    : key === "y" || (key === "z" && event.shiftKey) ? text.redo
    : key === "z" ? text.undo
    : null;
  if (act) {
    event.preventDefault();
    act();
  }
});
connect();
window.designer = { store, text, drop: () => socket.close() }; // for tests and the curious
