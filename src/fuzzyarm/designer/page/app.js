// The page of the server: one connection, and which of the folder's files is shown.

import { COMPARE } from "./compare.js";
import { connect } from "./connection.js";
import { makeDesk } from "./desk.js";
import { diagramPane } from "./diagram.js";
import { clean } from "./draw.js";
import { FILES, dropped } from "./files.js";
import { DESIGN } from "./frame.js";
import { LEARN } from "./learn.js";
import { RUN } from "./run.js";
import { TABLE, isTable } from "./table.js";
import { TUNE } from "./tune.js";
import { S } from "./strings.js";

const DRAWN = { ...DESIGN, panes: [...DESIGN.panes, diagramPane] };
const VIEWS = [DRAWN, RUN, TABLE, LEARN, TUNE, COMPARE, FILES];
const WRITTEN_IN = ".cm-editor, textarea, input[type='text'], input[type='number']";
const MOST_DESKS = 8; // of the files of late: each holds its pictures

const start = JSON.parse(document.getElementById("start").textContent);
const desks = new Map(); // by file, the one shown last at the end
const renamed = new Map(); // old names → those of now, for steps back
const { first } = start; // the file to begin with
let names = start.files;
let unsaved = []; // the files of which a window has more than what is saved
/** @type {ReturnType<typeof makeDesk>} */
let shown = null;

const connection = connect({
  opened() {
    connection.send({ do: "hello" }); // files may have come and gone meanwhile
    for (const desk of desks.values()) desk.open();
  },
  closed() {
    for (const desk of desks.values()) desk.lose();
  },
  take(message) {
    if (message.is === "moved") moved(message);
    else if (message.is === "names") changedFiles(message);
    else if (message.is === "unsaved") changedTexts(message);
    else (desks.get(message.file) ?? (message.file ? null : shown))?.take(message);
  },
});

const page = {
  connection,
  nonce: start.nonce,
  only: start.only,
  largest: start.largest,
  imports: start.imports,
  unsaved: () => unsaved,
  turnTo: (name) => turnTo(name),
  listed,
  marked() {
    if (shown) document.title = clean(`${shown.isDirty() ? "● " : ""}${shown.file()} – ${S.designer}`);
  },
};

/** Offer these files. */
function listed(found) {
  names = found;
  for (const desk of desks.values()) desk.offer(names);
}

/** Files have come or gone by themselves; a page that has none shows the first that comes. */
function changedFiles({ names: found, first: likeliest }) {
  listed(found);
  if (!shown.file() && likeliest && !document.querySelector("dialog[open]")) turnTo(likeliest);
  else shown.store.emit("files");
}

/** Other files than before have unsaved changes: one of them has been edited, or saved. */
function changedTexts({ names: changed }) {
  unsaved = changed;
  for (const desk of desks.values()) desk.store.emit("unsaved");
}

// --- which file is shown ---

const address = (name) => `#${new URLSearchParams({ file: name })}`;
const fromAddress = () => new URLSearchParams(location.hash.slice(1)).get("file");

/** Show the desk of a file: as it was left, or a new one in the view of the one before. */
function show(name) {
  const before = shown;
  const onChooser = document.activeElement === before?.root.querySelector("header select");
  before?.leave();
  let desk = desks.get(name);
  if (desk)
    desks.delete(name); // to the end
  else {
    desk = makeDesk(name, page, name ? VIEWS : [FILES]);
    desk.offer(names);
    if (isTable(name)) desk.turn(TABLE.name);
    else if (before && ![FILES.name, TABLE.name].includes(before.view())) desk.turn(before.view());
    if (connection.isOpen()) desk.open();
    else if (before) desk.lose();
  }
  desks.set(name, desk);
  shown = desk;
  if (before !== desk) desk.show(before);
  if (before && before !== desk) desk.focus(onChooser);
  page.marked();
  tidy();
}

/** Close the desks that have not been shown for longest, where nothing is lost with them. */
function tidy() {
  for (const [name, desk] of desks) {
    if (desks.size <= MOST_DESKS) return;
    if (desk === shown || !desk.isIdle()) continue;
    desk.close();
    desks.delete(name);
  }
}

/** Turn to another file, as a step that can be taken back. */
function turnTo(name) {
  if (shown.file() !== name) {
    history.pushState(null, "", address(name));
    show(name);
  }
  if (name && shown.view() === FILES.name) shown.turn(isTable(name) ? TABLE.name : DESIGN.name);
}

/** Show the file of the address: after a step back, or when the address was written by hand. */
async function turnBack() {
  const begun = first || names[0] || "";
  const asked = fromAddress() ?? begun;
  let name = asked;
  while (renamed.has(name) && !names.includes(name)) name = renamed.get(name);
  if (!names.includes(name)) {
    const found = await connection.folder({ what: "list" });
    if ((fromAddress() ?? begun) !== asked) return; // one has turned to another meanwhile
    listed((found.files ?? []).map((each) => each.name));
  }
  if (!names.includes(name)) {
    name = shown.file();
    shown.say(S.notThere(asked));
  }
  if (name !== asked) history.replaceState(null, "", address(name));
  if (name !== shown.file()) show(name);
}

/** A file has another name, or none. */
function moved({ file, to }) {
  const desk = desks.get(file);
  renamed.set(file, to);
  renamed.delete(to);
  listed(
    names.includes(to) || !to
      ? names.filter((name) => name !== file)
      : names.map((name) => (name === file ? to : name)),
  );
  if (!desk) return;
  desks.delete(file);
  if (to) {
    desk.move(to);
    desks.set(to, desk);
    desk.offer(names);
  }
  if (desk !== shown) {
    if (!to) desk.close();
    return;
  }
  const view = desk.view();
  if (!to) show(names.includes(first) ? first : (names[0] ?? ""));
  if (!to) desk.close();
  if (view === FILES.name) shown.turn(view);
  history.replaceState(null, "", address(shown.file()));
}

// --- the whole window ---

dropped((files) => shown.bring(files));
window.addEventListener("popstate", turnBack);
window.addEventListener("beforeunload", (event) => {
  if ([...desks.values()].some((desk) => desk.isDirty())) event.preventDefault();
});
window.addEventListener("keydown", (event) => {
  if (!event.ctrlKey && !event.metaKey) return;
  const key = event.key.toLowerCase();
  const { target } = event;
  const act = { s: shown.save, y: shown.redo, z: event.shiftKey ? shown.redo : shown.undo }[key];
  // What is written in has its own steps back.
  if (act && (key === "s" || !(target instanceof Element && target.closest(WRITTEN_IN)))) {
    event.preventDefault();
    act();
  }
});

const wanted = fromAddress();
show(names.includes(wanted) ? wanted : first);
if (wanted && shown.file() !== wanted) history.replaceState(null, "", address(shown.file()));
connection.open();
window.designer = {
  // for tests and the curious
  get store() {
    return shown.store;
  },
  get text() {
    return shown.text;
  },
  desks,
  drop: connection.drop,
};
