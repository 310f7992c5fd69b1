// The whole window: one connection, and which of the files is shown.

import { Connection } from "./connection.js";
import { Desk } from "./desk.js";
import { clean } from "./draw.js";
import { FILES, dropped } from "./files.js";
import { DESIGN } from "./frame.js";
import { TABLE, isTable } from "./table.js";
import { S } from "./strings.js";

const WRITTEN_IN = ".cm-editor, textarea, input[type='text'], input[type='number']";
const MOST_DESKS = 8; // of the files of late: each holds its pictures

const address = (name) => `#${new URLSearchParams({ file: name })}`;
const fromAddress = () => new URLSearchParams(location.hash.slice(1)).get("file");

/**
 * Open the window.
 *
 * @param {Page.Start} start what is known at once
 * @param {any[]} views of a file
 * @param {Page.Around} around what another page than that of the server has
 */
export function openWindow(start, views, around = {}) {
  return new Whole(start, views, around);
}

class Whole {
  /**
   * @param {Page.Start} start
   * @param {Page.Around} around
   */
  constructor(start, views, around) {
    this.views = views;
    this.around = around;
    this.desks = new Map(); // by file, the one shown last at the end
    this.renamed = new Map(); // old names → those of now, for steps back
    this.first = start.first; // the file to begin with
    this.names = start.files;
    this.unsaved = []; // the files of which a window has more than what is saved
    this.missing = ""; // a file of the address that is not there, until that is said
    /** @type {Desk} */
    this.shown = null;
    this.connection = new Connection(
      { opened: this.opened, closed: this.closed, take: this.take, gone: this.gone },
      around.line,
    );
    this.page = {
      connection: this.connection,
      nonce: start.nonce,
      only: start.only,
      largest: start.largest,
      imports: start.imports,
      gone: this.gone,
      buttons: around.buttons,
      writes: around.writes,
      write: around.write,
      isFree: around.isFree,
      unsaved: () => this.unsaved,
      turnTo: this.turnTo,
      listed: this.listed,
      marked: () => {
        if (!this.shown) return;
        document.title = clean(`${this.shown.dirty ? "● " : ""}${this.shown.file} – ${S.designer}`);
      },
    };
    this.listen();
    const wanted = fromAddress();
    this.show(this.names.includes(wanted) ? wanted : this.first);
    if (wanted && this.shown.file !== wanted) {
      history.replaceState(null, "", address(this.shown.file));
      this.missing = wanted;
    }
    this.connection.open();
  }

  // --- what comes ---

  opened = () => {
    this.connection.send({ do: "hello" }); // files may have come and gone meanwhile
    for (const desk of this.desks.values()) desk.open();
  };

  closed = () => {
    for (const desk of this.desks.values()) desk.lose();
  };

  take = (message) => {
    if (message.is === "moved") this.moved(message);
    else if (message.is === "names") this.changedFiles(message);
    else if (message.is === "unsaved") this.changedTexts(message);
    else if (message.is === "stored") this.around.stored(message);
    else (this.desks.get(message.file) ?? (message.file ? null : this.shown))?.take(message);
    if (message.is !== "status" || !this.missing) return;
    this.shown.link.say(S.notThere(this.missing));
    this.missing = "";
  };

  /** Offer these files. */
  listed = (found) => {
    this.names = found;
    for (const desk of this.desks.values()) desk.offer(this.names);
    this.around.listed?.(found);
  };

  /** Files have come or gone by themselves; a page that has none shows the first that comes. */
  changedFiles({ names: found, first: likeliest }) {
    this.listed(found);
    if (!this.shown.file && likeliest && !document.querySelector("dialog[open]")) this.turnTo(likeliest);
    else this.shown.store.emit("files");
  }

  /** Other files than before have unsaved changes: one of them has been edited, or saved. */
  changedTexts({ names: changed }) {
    this.unsaved = changed;
    for (const desk of this.desks.values()) desk.store.emit("unsaved");
  }

  /** Why nothing answers, and what becomes of what is typed. */
  gone = () => this.around.gone?.() ?? S.gone;

  // --- which file is shown ---

  /** Show the desk of a file: as it was left, or a new one in the view of the one before. */
  show = (name) => {
    const before = this.shown;
    const onChooser = document.activeElement === before?.root.querySelector("header select");
    before?.leave();
    let desk = this.desks.get(name);
    if (desk)
      this.desks.delete(name); // to the end
    else {
      desk = new Desk(name, this.page, name ? this.views : [FILES]);
      desk.offer(this.names);
      if (isTable(name)) desk.turn(TABLE.name);
      else if (before && ![FILES.name, TABLE.name].includes(before.store.view)) desk.turn(before.store.view);
      if (this.connection.isOpen()) desk.open();
      else if (before) desk.lose();
      this.around.begin?.(desk);
    }
    this.desks.set(name, desk);
    this.shown = desk;
    if (before !== desk) desk.show(before);
    if (before && before !== desk) desk.focus(onChooser);
    this.page.marked();
    this.tidy();
  };

  /** Close the desks that have not been shown for longest, where nothing is lost with them. */
  tidy() {
    for (const [name, desk] of this.desks) {
      if (this.desks.size <= MOST_DESKS) return;
      if (desk === this.shown || !desk.isIdle()) continue;
      desk.close();
      this.desks.delete(name);
    }
  }

  /** Turn to another file, as a step that can be taken back. */
  turnTo = (name) => {
    if (this.shown.file !== name) {
      history.pushState(null, "", address(name));
      this.show(name);
    }
    if (name && this.shown.store.view === FILES.name) this.shown.turn(isTable(name) ? TABLE.name : DESIGN.name);
  };

  /** Show the file of the address: after a step back, or when the address was written by hand. */
  turnBack = async () => {
    const begun = this.first || this.names[0] || "";
    const asked = fromAddress() ?? begun;
    let name = asked;
    while (this.renamed.has(name) && !this.names.includes(name)) name = this.renamed.get(name);
    if (!this.names.includes(name)) {
      const found = await this.connection.folder({ what: "list" });
      if ((fromAddress() ?? begun) !== asked) return; // one has turned to another meanwhile
      this.listed((found.files ?? []).map((each) => each.name));
    }
    if (!this.names.includes(name)) {
      name = this.shown.file;
      this.shown.link.say(S.notThere(asked));
    }
    if (name !== asked) history.replaceState(null, "", address(name));
    if (name !== this.shown.file) this.show(name);
  };

  /** A file has another name, or none. */
  moved({ file, to }) {
    const desk = this.desks.get(file);
    this.renamed.set(file, to);
    this.renamed.delete(to);
    this.listed(
      this.names.includes(to) || !to
        ? this.names.filter((name) => name !== file)
        : this.names.map((name) => (name === file ? to : name)),
    );
    if (!desk) return;
    this.desks.delete(file);
    if (to) {
      desk.move(to);
      this.around.moved?.(desk, file);
      this.desks.set(to, desk);
      desk.offer(this.names);
    }
    if (desk !== this.shown) {
      if (!to) desk.close();
      return;
    }
    const view = desk.store.view;
    if (!to) this.show(this.names.includes(this.first) ? this.first : (this.names[0] ?? ""));
    if (!to) desk.close();
    if (view === FILES.name) this.shown.turn(view);
    history.replaceState(null, "", address(this.shown.file));
  }

  // --- the whole window ---

  listen() {
    dropped((files) => this.shown.bring(files));
    window.addEventListener("popstate", this.turnBack);
    window.addEventListener("beforeunload", (event) => {
      if (!this.around.keeps && [...this.desks.values()].some((desk) => desk.dirty)) event.preventDefault();
    });
    window.addEventListener("keydown", (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      const key = event.key.toLowerCase();
      const { target } = event;
      const { shown } = this;
      const act = { s: shown.link.save, y: shown.text.redo, z: event.shiftKey ? shown.text.redo : shown.text.undo }[
        key
      ];
      // What is written in has its own steps back.
      if (act && (key === "s" || !(target instanceof Element && target.closest(WRITTEN_IN)))) {
        event.preventDefault();
        act();
      }
    });
  }
}

/** Let tests and the curious look at a window. */
export function expose(whole) {
  window.designer = {
    get store() {
      return whole.shown.store;
    },
    get text() {
      return whole.shown.text;
    },
    desks: whole.desks,
    connection: whole.connection,
    drop: whole.connection.drop,
  };
}
