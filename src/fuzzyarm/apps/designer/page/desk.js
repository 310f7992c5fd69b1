// A desk: one file of the folder, with its text, its views, and what of it is not saved.
//
// Every file that is looked at has a desk of its own, of which one is shown. So what belongs to a file
// stays with it: steps back, the cursor, the point, the view, what a search or a run has found.

import { choose, fill, rename } from "./dialogs.js";
import { clean, el, pairsOf, refill, space } from "./draw.js";
import { Frame } from "./frame.js";
import { askServer } from "./remote.js";
import { Store } from "./store.js";
import { TextPane } from "./text.js";
import { S } from "./strings.js";

const FILES = "files"; // the view of the folder
const CHANGES = ["rename", "delete"]; // what is done to a file of the folder

/** The desk of a file; `page` is what all desks share, `views` which views it has. */
export class Desk {
  constructor(file, page, views) {
    this.file = file;
    this.page = page;
    this.views = views;

    this.connection = this.page.connection;
    this.store = new Store();
    this.status = el("span", { id: "status", role: "status" });
    this.saving = el("button", {
      textContent: S.save,
      title: "Ctrl+S",
      disabled: true,
      onclick: () => this.link.save(),
    });
    this.files = el("select", {
      "aria-label": S.file,
      onchange: () => {
        const to = this.files.value;
        this.files.value = this.file; // here it says what is shown here
        this.page.turnTo(to);
      },
    });
    this.saved = null; // the text on disk, as the server knows it
    this.apart = false; // whether the file says something else than what was saved, or is gone
    this.dirty = false;
    this.lost = false;
    this.wants = false; // whether it is to be saved, once the server has the text
    this.told = undefined; // the text that the server was told of when the file was opened
    this.asked = []; // texts that were to be saved, of which it is not known whether they are
    this.writes = true; // as long as no other window does
    this.latest = null; // findings, which come in front of the picture of the same text
    this.working = new Set(); // long works that go on
    this.bring = null; // takes files that are dropped
    this.left = []; // what was scrolled, and the focus, when another desk was shown

    this.link = {
      push: (version, updates) => this.send({ do: "push", version, updates }),
      ask: (question) => this.connection.ask(this.file, question),
      save: () => {
        this.wants = true;
        this.trySave();
        return true;
      },
      say: (words) => {
        this.status.textContent = clean(words);
      },
      edited: (now) => {
        this.mark(this.saved !== null && (this.apart || now !== this.saved));
        this.store.emit("edited");
      },
      saved: () => this.saved,
      gone: () => this.page.gone().why,
      writes: () => this.mayWrite(),
      sends: () => this.writes,
    };

    this.text = new TextPane(this.link, this.page.nonce);
    this.makeHand();
    this.build();
    this.listen();
  }

  makeHand() {
    this.hand = {
      edit: (shapes) => this.text.edit("shapes", { shapes }),
      change: (what, details) => this.text.edit(what, details), // an edit that the server makes
      attempt: (what, details) => this.text.attempt(what, details), // the same, of a dialog that says what is wrong
      choose,
      fill,
      rename,
      numbers: (variable) => this.text.numbers(variable),
      ask: this.link.ask,
      start: this.start,
      setCell: (cell, term) => this.text.edit("cell", { cell, term }),
      setGain: (name, values) => this.text.edit("gain", { name, values }),
      text: () => this.text.state().text,
      goTo: (at) => this.text.goTo(at),
      say: (words) => this.link.say(words),
      save: () => this.saveNow(),
      saveFile: this.connection.save,
      unsaved: this.page.unsaved,
      askNow: (what, details) => this.text.question(what, details), // of the text as it is typed
      settled: () => this.text.sent(),
      gone: this.link.gone,
      replace: (words) => this.text.replace(words),
      folder: async (asked) =>
        !CHANGES.includes(asked.what) || ((await this.page.isFree?.(asked.file)) ?? true)
          ? this.connection.folder(asked)
          : { error: S.follows },
      file: () => this.file,
      onDrop: (act) => {
        this.bring = act;
      },
      largest: this.page.largest,
      imports: this.page.imports,
      listed: this.page.listed,
      turnTo: (name) => {
        if (this.root.isConnected) this.page.turnTo(name); // an answer that comes late turns nobody away
      },
    };
  }

  build() {
    askServer(this.store, this.start);
    this.banner = el("div", { class: "banner", role: "alert", hidden: true });
    const chooser = this.page.only ? el("strong", { textContent: this.file }) : this.files;
    // Where there is no file there is nothing to be typed and saved.
    const controls = [...(this.file ? [chooser, this.saving, ...(this.page.buttons?.(this.hand) ?? [])] : []), space()];
    const { root, turnTo } = new Frame(
      this.store,
      this.hand,
      this.file ? this.text.section : null,
      controls,
      this.views,
    );
    this.root = root;
    this.turn = turnTo;
    this.root.append(el("footer", {}, this.status, this.banner)); // what is said moves nothing
  }

  listen() {
    this.TAKEN = {
      opened: (message) => {
        this.saved = message.saved;
        this.writes = message.writes;
        this.back();
        this.text.open(message, this.told);
        this.trySave();
      },
      reopened: (message) => {
        this.saved = message.saved;
        this.writes = message.writes;
        this.back();
        this.text.follow(!this.mayWrite());
        this.text.receive(message); // and what was typed meanwhile is sent
        this.mark(this.text.state().text !== this.saved);
        this.trySave();
      },
      updates: (message) => this.text.receive(message),
      findings: (message) => {
        this.text.show(message);
        this.latest = message;
        this.store.emit("text"); // what was asked of an older text may be asked again
      },
      scene: (message) => {
        if (message.version !== this.text.version()) return;
        this.text.drawn();
        this.store.findings = this.latest?.version === message.version ? this.latest.findings : [];
        if (message.scene) this.store.show(message.scene);
        if (message.diagram || message.why !== "mistakes") this.store.draw(message.diagram);
        if (!message.scene && !message.diagram) this.store.mistaken(message.why);
        this.store.judge(message.why !== "mistakes");
      },
      writer: (message) => {
        this.writes = message.writes;
        this.turned(); // the state of the file comes after it
      },
      status: (message) => {
        if (message.saved !== undefined) {
          this.saved = message.saved;
          this.asked = [];
        }
        this.apart = message.gone || message.conflict;
        this.mark(this.apart || this.text.state().text !== this.saved);
        if (this.mayWrite() || message.elsewhere) this.tellState(message);
        else this.tellFollowing();
      },
      failed: (message) => {
        if (this.text.state().epoch && !this.lost) this.link.say(message.message);
        else this.tell(message.message);
        if (!this.text.state().epoch) this.turn(FILES); // the file cannot be opened; from there others can
      },
    };
  }

  /** Whether nothing is lost with this desk but the steps back: an unsaved text asks before the page is left. */
  isIdle = () => this.text.settled() && !this.dirty && !this.working.size && this.banner.hidden;

  focus = (onChooser) => (onChooser || !this.file ? this.files : this.text.view).focus();

  /** Whether this window writes the file; in a page that keeps files itself, one tab does. */
  mayWrite = () => this.writes && (this.page.writes?.(this.file) ?? true);

  /** Another tab writes from now on, or this one. */
  turned = () => {
    this.text.follow(!this.mayWrite());
    this.mark(this.dirty);
    if (this.lost) this.tellLost();
    else if (this.mayWrite()) this.tell("");
    else this.tellFollowing();
  };

  /** Save as soon as the server has the text; what is not saved is said. */
  trySave = () => {
    if (!this.wants) return;
    if (this.lost && this.mayWrite()) return void this.link.say(S.savedLater);
    if (!this.mayWrite()) {
      if (this.text.settled()) this.link.say(S.follows);
      else this.tellFollowing(S.notSavedHere);
    } else if (!this.text.settled()) return void setTimeout(this.trySave, 20);
    else {
      this.asked.push(this.text.state().text);
      this.send({ do: "save" });
    }
    this.wants = false;
  };

  take = (message) => this.TAKEN[message.is]?.(message);

  offer = (names) => {
    const all = names.includes(this.file) ? names : [this.file, ...names]; // one that has gone is still shown
    refill(this.files, pairsOf(all), this.file);
  };

  /** Go on under another name. */
  move = (to) => {
    this.file = to;
    this.mark(this.dirty);
    if (this.text.state().epoch) this.open(); // what was on its way under the old name has not arrived
  };

  lose = () => {
    const before = this.lost;
    this.lost = true;
    if (!before) this.tellLost();
  };

  close = () => {
    this.store.emit("closed");
    for (const job of this.working) job.stop();
    this.text.close();
    this.send({ do: "close" });
  };

  send = (message) => this.connection.send({ ...message, file: this.file });

  /** Say above all views what stands between the text and its file, and offer the ways out. */
  tellState = (message) => {
    const settle = (words, keep) =>
      el("button", {
        textContent: words,
        onclick: () => {
          this.tell(""); // what is asked is answered; the state of the file comes again
          this.send({ do: "settle", keep });
        },
      });
    if (message.unreadable) this.tell(S.unreadable(message.unreadable), settle(S.keepMine, "mine"));
    else if (message.elsewhere) this.tell(S.otherWindow, settle(S.keepThis, "mine"), settle(S.takeOther, "theirs"));
    else if (message.conflict) {
      const both = message.mergeable ? [settle(S.keepBoth, "both")] : [];
      this.tell(S.conflict, ...both, settle(S.keepMine, "mine"), settle(S.takeTheirs, "theirs"));
    } else if (message.gone) this.tell(S.fileGone);
    else if (message.reread) this.tell(S.reread, el("button", { textContent: S.close, onclick: () => this.tell("") }));
    else if (message.saved !== undefined || !this.rereadShown()) this.tell("");
  };

  /** Whether the banner only says that the file was read again: it stays while one types. */
  rereadShown = () => this.banner.firstChild?.textContent === S.reread;

  tellFollowing = (words = this.text.settled() ? S.follows : S.behind) => {
    if (this.banner.firstChild?.textContent === S.notSavedHere) return;
    // While nothing answers, only a page that keeps the files itself can say who writes.
    const own = this.page.write;
    const write = own ? () => own(this.file) : this.lost ? null : () => this.send({ do: "write" });
    const why = this.lost ? ` ${this.page.gone().why}` : "";
    this.tell(words + why, ...(write ? [el("button", { textContent: S.writeHere, onclick: write })] : []));
  };

  /** Say that nothing answers, and what becomes of the text. */
  tellLost = () => {
    const { why, kept } = this.page.gone();
    if (this.mayWrite()) this.tell(`${why} ${kept}`);
    else this.tellFollowing(S.follows);
  };

  mark = (changed) => {
    this.dirty = changed;
    this.saving.disabled = !changed || !this.mayWrite();
    this.text.revertible(changed && this.mayWrite());
    if (!this.lost || (changed && this.status.textContent === S.saved)) {
      this.status.textContent = changed ? S.unsaved : S.saved;
    }
    this.page.marked();
  };

  start = (what, asked_for, hear) => {
    const job = this.connection.start(this.file, what, asked_for, (news) => {
      if (news.end) this.working.delete(job);
      hear(news);
    });
    this.working.add(job);
    return job;
  };
  /** Save, and wait until the server has; whether what is here is saved. */
  saveNow = async () => {
    if (!this.dirty) return true;
    const isSent = await this.text.sent();
    if (isSent) this.asked.push(this.text.state().text);
    const { error } = isSent ? await this.connection.save(this.file) : { error: this.page.gone().why };
    if (error) this.link.say(error);
    return !error;
  };

  tell = (words, ...buttons) => {
    this.banner.replaceChildren(clean(words), ...buttons);
    this.banner.hidden = !words;
  };

  /** Tell the server that this file is open, and what has been typed without it. */
  open = () => {
    if (!this.file) {
      // the folder is empty
      this.back();
      return;
    }
    const { epoch, text } = this.text.state();
    this.told = text;
    const { saved, asked, writes: wrote } = this;
    this.send({ do: "open", ...(epoch ? { epoch, version: this.text.version(), text, saved, asked, wrote } : {}) });
  };

  back = () => {
    const before = this.lost;
    this.lost = false;
    this.tell("");
    if (!before) return;
    if (this.file) this.link.say(S.back);
    this.store.emit("view"); // what was asked for meanwhile has not been answered
  };

  /** Put this desk in the place of another one, as it was left. */
  show = (other) => {
    if (other) other.root.replaceWith(this.root);
    else document.body.append(this.root);
    for (const [element, top, across] of this.left) element.scrollTo(across, top);
    this.store.emit("theme"); // it may be another one now
    this.store.emit("view"); // and what is asked for a view may have changed meanwhile
    this.store.emit("shown");
  };

  /** Remember what goes when elements leave the document; call it before another desk is shown. */
  leave = () => {
    const scrolled = [...this.root.querySelectorAll("*")].filter((each) => each.scrollTop || each.scrollLeft);
    this.left = scrolled.map((each) => [each, each.scrollTop, each.scrollLeft]);
    this.store.emit("left");
  };
}
