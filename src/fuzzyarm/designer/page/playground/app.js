// The page with its own Python: the designer's views, texts that stay in the browser, links that carry a file.

import { DiagramPane } from "../diagram.js";
import { fill } from "../dialogs.js";
import { clean, el } from "../draw.js";
import { FILES } from "../files.js";
import { DESIGN } from "../frame.js";
import { RUN } from "../run.js";
import { S } from "../strings.js";
import { TABLE } from "../table.js";
import { expose, openWindow } from "../window.js";
import { Kept } from "./kept.js";
import { carriedBy, fragmentOf } from "./link.js";
import { pythonLine, canRunPython } from "./python_line.js";

const VIEWS = [{ ...DESIGN, panes: [...DESIGN.panes, DiagramPane] }, RUN, TABLE, FILES];
const LATER = 250; // ms after the last letter until a text is kept

const P = S.playground;
const start = JSON.parse(document.getElementById("start").textContent);
const kept = new Kept();
kept.begin(start.texts);

/** Take the file of the address; what is wrong with it is said, and nothing is lost. */
async function arrived() {
  let carried;
  try {
    carried = await carriedBy(location.hash);
  } catch {
    history.replaceState(null, "", location.pathname);
    return P.damagedLink;
  }
  if (!carried) return "";
  const named = /^[^/\\]{1,80}\.(frb|lut)$/i.test(carried.file) ? carried.file : "linked.frb";
  const name = kept.free(named, carried.text);
  const isKept = kept.put(name, carried.text);
  history.replaceState(null, "", `#${new URLSearchParams({ file: name })}`);
  return isKept ? "" : P.notKept;
}

/** What a button of the desk does: the address with the file in it, to be copied. */
async function share(hand) {
  const fragment = await fragmentOf(hand.file(), hand.text());
  const address = `${location.href.replace(/#.*/, "")}${fragment}`;
  const note = fragment ? P.linkNote : P.linkTooLong;
  await fill(P.link, fragment ? [{ name: "address", label: P.address, value: address }] : [], P.copy, copy, note);

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

/** Keep what is typed, a moment after it is. */
function keeping(desk) {
  let later = 0;
  const keep = () => {
    if (!desk.file || !desk.text.state().epoch) return;
    if (!kept.put(desk.file, desk.text.state().text)) desk.link.say(P.notKept);
  };
  const soon = () => {
    clearTimeout(later);
    later = setTimeout(keep, LATER);
  };
  desk.store.on("edited", soon);
  desk.store.on("closed", () => clearTimeout(later));
  window.addEventListener("pagehide", keep);
}

function open(words) {
  const desks = new Set(); // all that have been made
  let state = P.loading; // what is said until Python is there; then empty
  const say = (now) => {
    state = now;
    for (const desk of desks) desk.tell(now);
  };
  const line = pythonLine(start, () => kept.all(), {
    doing: (what) => say(P.doing[what] ?? what),
    ready: () => {
      state = "";
    },
    failed: (why) => say(clean(P.failed(why))),
  });
  const whole = openWindow({ ...start, files: kept.names(), first: firstOf(kept.names()) }, VIEWS, {
    line,
    keeps: kept.lasting,
    gone: () => state,
    buttons: (hand) => [
      el("button", { textContent: P.link, title: P.linkHint, onclick: () => share(hand) }),
      el("button", { textContent: P.download, title: P.downloadHint, onclick: () => download(hand) }),
    ],
    begin: (desk) => {
      desks.add(desk);
      const text = kept.get(desk.file);
      if (state) {
        // The text is there before Python is, which then takes it as that of a page which has lost its server.
        const opened = { is: "opened", file: desk.file, text, saved: text, version: 0, epoch: "kept", writes: true };
        if (text !== null) desk.take(opened);
        desk.lose();
      }
      keeping(desk);
    },
    listed: (names) => {
      for (const name of kept.names()) if (!names.includes(name)) kept.remove(name);
    },
  });
  expose(whole);
  if (words) whole.shown.link.say(words);
}

function firstOf(names) {
  return names.includes(start.first) ? start.first : (names[0] ?? "");
}

/** Show the texts as they are, where nothing can be done with them. */
function standing(words) {
  const texts = kept.names().map((name) => [el("h2", { textContent: name }), el("pre", {}, kept.get(name))]);
  document.body.append(el("main", { class: "standing" }, el("p", { role: "alert" }, words), ...texts.flat()));
}

arrived().then((words) => {
  const why = canRunPython();
  if (why) standing(why);
  else open(words);
  if (!kept.lasting) window.designer?.desks.forEach((desk) => desk.link.say(P.notLasting));
});
