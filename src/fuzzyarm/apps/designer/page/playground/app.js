// The page with its own Python: the designer's views, texts that stay in the browser, links that carry a file.

import { DiagramPane } from "../diagram.js";
import { fill, tellAll } from "../dialogs.js";
import { el } from "../draw.js";
import { FILES } from "../files.js";
import { DESIGN } from "../frame.js";
import { RUN } from "../run.js";
import { S } from "../strings.js";
import { TABLE } from "../table.js";
import { expose, openWindow } from "../window.js";
import { Kept } from "./kept.js";
import { carriedBy, fragmentOf } from "./link.js";
import { pythonLine, canRunPython } from "./python_line.js";
import { Tabs } from "./tabs.js";

const VIEWS = [{ ...DESIGN, panes: [...DESIGN.panes, DiagramPane] }, RUN, TABLE, FILES];
const LATER = 250; // ms after the last letter until a text is kept

const P = S.playground;
const start = JSON.parse(document.getElementById("start").textContent);
const kept = new Kept();
kept.begin(start.texts);
const desks = new Set(); // all that there are
const of = (file) => [...desks].find((desk) => desk.file === file);
const tabs = new Tabs(
  { kept: (file) => of(file)?.keep() ?? kept.get(file), turned: (file, text) => of(file)?.given(text) },
  kept.lasting ? globalThis : {},
);
/** @type {typeof P.loading | null} */
let state = P.loading; // what is said until Python is there
const line = pythonLine(start, () => kept.all(), {
  doing: (what) => say({ ...P.loading, why: P.doing[what] ?? what }),
  ready: () => {
    state = null;
  },
  failed: (why) => say(P.failed(why)),
});

function say(now) {
  state = now;
  for (const desk of desks) desk.tellLost();
}

/** Take the files of the address; what is to be said of them, and nothing is lost. */
async function arrived() {
  let carried;
  try {
    carried = await carriedBy(location.hash);
  } catch {
    history.replaceState(null, "", location.pathname);
    return [P.damagedLink];
  }
  if (!carried) return [];
  const { name, renamed, isKept } = kept.bring(carried);
  history.replaceState(null, "", `#${new URLSearchParams({ file: name })}`);
  return [...renamed.map(([old, now]) => P.renamed(old, now)), ...(isKept ? [] : [P.notKept])];
}

/** What a button of the desk does: the address with the file in it and those that it uses, to be copied. */
async function share(hand) {
  const { texts, error } = await hand.folder({ what: "carried", file: hand.file() });
  if (error) return tellAll(P.link, [error]);
  const fragment = await fragmentOf({ [hand.file()]: hand.text(), ...texts });
  const address = `${location.href.replace(/#.*/, "")}${fragment}`;
  const note = fragment ? P.linkNote(Object.keys(texts)) : P.linkTooLong;
  return fill(P.link, fragment ? [{ name: "address", label: P.address, value: address }] : [], P.copy, copy, note);

  async function copy() {
    if (!fragment) return {};
    try {
      await navigator.clipboard.writeText(address);
    } catch {
      return { error: P.notCopied };
    }
    return {};
  }
}

/** Save the text as a file of the computer. */
function download(hand) {
  const href = URL.createObjectURL(new Blob([hand.text()], { type: "text/plain" }));
  el("a", { href, download: hand.file() }).click();
  setTimeout(() => URL.revokeObjectURL(href), 1000);
}

/** Keep what is typed, a moment after it is; write, or read, as the tabs say. */
function keeping(desk) {
  let later = 0;
  let awaited = null; // what another tab has written of the file, until it is here
  const text = () => desk.text.state().text;
  desk.isOurs = () => tabs.writes(desk.file) && awaited === null;
  desk.keep = () => {
    clearTimeout(later);
    if (!desk.file || !desk.text.state().epoch || !desk.isOurs()) return null;
    if (!kept.put(desk.file, text())) desk.link.say(P.notKept);
    return text();
  };
  desk.given = (theirs) => {
    awaited = tabs.writes(desk.file) ? (theirs ?? kept.get(desk.file)) : null;
    if (awaited !== null) desk.hear(awaited);
    arrive();
    desk.turned();
  };
  /** Take what another tab has stored. */
  desk.hear = (theirs) => {
    if (state) desk.text.take(theirs);
    else line.store(desk.file, theirs);
  };
  const arrive = () => {
    if (awaited !== text()) return;
    awaited = null;
    desk.turned();
  };
  desk.store.on("edited", () => {
    arrive();
    clearTimeout(later);
    later = setTimeout(desk.keep, LATER);
  });
  desk.store.on("closed", () => {
    clearTimeout(later);
    tabs.close(desk.file);
  });
}

function open() {
  const whole = openWindow({ ...start, files: kept.names(), first: firstOf(kept.names()) }, VIEWS, {
    line,
    keeps: kept.lasting,
    gone: () => state,
    buttons: (hand) => [
      el("button", { textContent: P.link, title: P.linkHint, onclick: () => share(hand) }),
      el("button", { textContent: P.download, title: P.downloadHint, onclick: () => download(hand) }),
    ],
    begin: (desk) => {
      keeping(desk);
      desks.add(desk);
      tabs.open(desk.file);
      desk.store.on("closed", () => desks.delete(desk));
      const text = kept.get(desk.file);
      if (state) {
        // The text is there before Python is, which then takes it as that of a page which has lost its server.
        const opened = { is: "opened", file: desk.file, text, saved: text, version: 0, epoch: "kept", writes: true };
        if (text !== null) desk.take(opened);
        desk.lose();
      }
    },
    moved: (desk, before) => {
      tabs.close(before);
      tabs.open(desk.file);
    },
    listed: (names) => kept.offer(names),
    stored: ({ file, text }) => kept.put(file, text),
    writes: (file) => of(file)?.isOurs() ?? true,
    write: (file) => tabs.take(file),
    isFree: tabs.isFree,
  });
  expose(whole);
  // What another tab stores is here what another program writes.
  window.addEventListener("storage", ({ key, newValue }) => {
    const file = key && kept.nameOf(key);
    if (!file) return;
    tabs.stored(file);
    if (state && newValue !== null) of(file)?.hear(newValue);
    line.store(file, newValue);
  });
}

function firstOf(names) {
  return names.includes(start.first) ? start.first : (names[0] ?? "");
}

/** Show the texts as they are, where nothing can be done with them. */
function standing(words) {
  const texts = kept.names().map((name) => [el("h2", { textContent: name }), el("pre", {}, kept.get(name))]);
  document.body.append(el("main", { class: "standing" }, el("p", { role: "alert" }, words), ...texts.flat()));
}

window.addEventListener("pagehide", () => desks.forEach((desk) => desk.keep()));

async function main() {
  const words = await arrived();
  const why = canRunPython();
  if (why) standing(why);
  else open();
  if (words.length) await tellAll(P.link, words);
  if (!kept.lasting) desks.forEach((desk) => desk.link.say(P.notLasting));
}

main();
