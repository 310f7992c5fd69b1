// Views of long work: a form of a request of Python, the work that it begins, what is said meanwhile, and its end. What
// comes of it is each view's own: lines as a command prints them with their pictures, tables that grow, a report.

import { confirm } from "./dialogs.js";
import { clean, el, pairsOf, printed, space } from "./draw.js";
import { Form } from "./form.js";
import { drawPanel } from "./panel.js";
import { Pane, stage } from "./pane.js";
import { S } from "./strings.js";
import { Task } from "./task.js";

/**
 * What views differ in.
 *
 * @typedef {{ name: keyof Messages.Works, title: string, go: string, facts: keyof Messages.Works, form: (facts: any) => string,
 *   stop?: string, ends?: Record<string, string>, isEnough?: boolean, ofFolder?: boolean }} Kind
 *   `facts` is the work that tells the form, and `form` its name; `ends` is what is said when it is over; with `isEnough`
 *   the work is ended by a word, and its best kept; with `ofFolder` the facts change with files that are not open here.
 */

export class Work extends Pane {
  constructor(store, hand, kind) {
    super(store, hand, kind.name, kind.title);
    this.kind = kind;
    this.task = new Task(hand, kind.name);
    this.asking = new Task(hand, kind.facts);
    this.isOver = true; // whether nothing is computed: work may wait to write what it has
    this.isEnding = false; // a hand has said that it is enough
    this.stale = true; // whether the facts are those of an older text or folder, or are not known
    this.facts = null; // what may be asked for
    this.form = new Form();
    this.known = ""; // which form is shown
    this.section.classList.add("asked");
    this.place = el("div");
    this.start = el("button", { class: "main", textContent: kind.go, disabled: true, onclick: () => this.press() });
    this.stop = el("button", { textContent: kind.stop ?? S.stop, disabled: true, onclick: () => this.halt() });
    this.keep = null; // the button that keeps what came of it
    this.actions = el("div", { class: "actions" }, this.start, this.stop);
    this.said = el("p", { class: "said", role: "status" });
    this.told = this.said; // where it is said what may be asked for
    this.body.append(this.place, this.actions, this.said);
    store.on("view", () => {
      this.stale ||= Boolean(kind.ofFolder);
      this.ask();
    });
    this.on(["text", "files"], () => {
      this.stale = true;
      this.ask();
    });
  }

  /** Have a name for what came of it, and a button that writes it. */
  saving(name, words) {
    this.name = el("input", { type: "text", value: name, size: 16, "aria-label": S.fileName });
    this.keep = el("button", {
      textContent: words,
      disabled: true,
      onclick: () => this.task.say({ save: this.name.value }),
    });
    this.actions.append(space(), this.name, this.keep);
  }

  say(words) {
    this.said.textContent = clean(words);
  }

  // --- what may be asked for ---

  /** Ask for it, where the view is looked at; what is not answered is asked for again. */
  ask() {
    if (this.store.view !== this.kind.name || !this.stale || !this.isOver) return;
    this.stale = false;
    if (!this.facts) this.told.textContent = S.working;
    this.asking.begin({}, (news) => {
      if (news.end === "failed") this.refuse(news.message);
      else if (!news.end) this.know(news);
    });
  }

  refuse(words) {
    this.stale = true;
    this.facts = null;
    this.told.textContent = clean(words);
    this.show();
  }

  know(facts) {
    this.facts = facts;
    const known = this.kind.form(facts);
    if (known !== this.known) {
      this.known = known;
      this.form = new Form({
        changed: (name) => this.changed(name),
        judge: (values) => this.hand.folder({ what: "judge", file: this.hand.file(), form: known, values }),
      });
      this.form.open(facts.form);
      this.place.replaceChildren(this.form.view);
    }
    this.fill(facts);
    if (!this.task.isBegun) this.told.textContent = clean(this.ready(facts));
    this.show();
  }

  /** Put in what only the folder or the text knows. */
  fill(_facts) {}

  /** A field of the form was changed. */
  changed(_name) {}

  /** What is said before anything is begun. */
  ready(_facts) {
    return "";
  }

  canStart() {
    return Boolean(this.facts) && this.isOver;
  }

  // --- the work ---

  press() {
    this.begin();
  }

  begin(further = {}) {
    this.form.mark("");
    this.say(S.working);
    this.isOver = this.isEnding = false;
    const form = this.form.values();
    this.task.beginSettled(
      () => ({ form, ...further }),
      (news) => this.hear(news),
    ); // what is typed counts
    this.show();
  }

  halt() {
    if (!this.kind.isEnough || !this.task.job) return this.task.stop();
    this.task.say({ enough: true });
    this.isEnding = true;
    this.say(S.stopping);
    return this.show();
  }

  hear(news) {
    if (news.end) this.isOver = true;
    if (news.saved) this.say(S.isWritten(news.saved));
    if (news.unsaved) this.say(news.unsaved);
    if (news.exists) this.replace([news.exists].flat());
    if (this.kind.ends?.[news.end]) this.say(this.kind.ends[news.end]);
    this.take(news);
    this.show();
    if (news.end === "failed")
      this.say(this.form.mark(news.field ?? "", news.message) ? "" : this.form.inWords(news.message));
    this.ask(); // the text may have changed meanwhile
  }

  /** Take what the work tells. */
  take(_news) {}

  async replace(names) {
    if (await confirm(S.replaceFile(names.join(", ")), S.replace))
      this.task.say({ ...this.keeping(names), replace: true });
    this.keep.focus();
  }

  /** What keeps what came of it. */
  keeping([save]) {
    return /** @type {any} */ ({ save });
  }

  /** Show what a hand may do now. */
  show() {
    this.start.disabled = !this.canStart();
    this.stop.disabled = this.isOver || this.isEnding;
    this.store.work(this.kind.name, !this.isOver);
    if (this.keep) this.keep.disabled = !(this.isOver && this.task.job);
    this.form.lock(!this.isOver);
  }
}

/** A view whose results are lines, pictures and files to load, one below the other. */
export class ResultWork extends Work {
  /** @param {Kind} kind */
  constructor(store, hand, kind) {
    super(store, hand, kind);
    this.results = el("div", { class: "verdicts" });
    this.isOld = false;
    this.body.tabIndex = 0; // it scrolls
    this.body.append(this.results);
  }

  begin(further) {
    this.isOld = true; // until new ones come: a refused start takes nothing away
    super.begin(further);
  }

  take(news) {
    if (this.isOld && (news.doing || news.lines || (news.end && news.end !== "failed"))) {
      this.results.replaceChildren();
      this.isOld = false;
    }
    if (news.doing) this.say(news.doing);
    if (!news.lines) return;
    this.results.querySelector(".so-far")?.remove();
    this.add(news);
  }

  /** A result: its lines, its pictures below them, and what can be loaded. */
  add({ verdict, lines, panels, files = [], so_far: isSoFar = false }) {
    const pictures = panels.map((panel) => {
      const body = el("div", { class: "picture" });
      const { canvas } = stage(this.store, body, () => drawPanel(canvas, panel));
      canvas.setAttribute("aria-label", clean(`${panel.title}: ${panel.up.words}`));
      return body;
    });
    const label = verdict || this.kind.title;
    const words = el("pre", { class: "printed", tabIndex: 0, "aria-label": label }, ...printed(lines.join("\n")));
    const links = files.map(({ name, address }) => el("a", { href: address, download: name, textContent: name }));
    const row = links.length ? [el("p", { class: "loads" }, `${S.toLoad} `, ...links)] : [];
    const drawn = el("div", { class: "drawn" }, ...pictures);
    const looks = `verdict ${verdict} ${isSoFar ? "so-far" : ""}`.trim();
    this.results.append(el("div", { class: looks }, ...(lines.length ? [words] : []), ...row, drawn));
  }
}

/**
 * Show the fields of a form that a plant understands, with what it may follow; `first` are further choices.
 *
 * @param {Form} form
 * @param {{ trajectories: string[], carries: boolean, reference: string } | undefined} plant
 * @param {Array<[string, string]>} first
 * @param {string} [chosen] what it follows
 */
export function showGrounds(form, plant, first = [], chosen = form.shown("trajectory")) {
  const moves = Boolean(plant?.trajectories.length);
  form.show(["trajectory"], moves);
  form.show(["payload"], moves && plant.carries);
  form.show(["reference", "duration"], Boolean(plant) && !moves);
  form.choices("trajectory", [...first, ...pairsOf(plant?.trajectories ?? [])], chosen);
  if (form.has("reference")) form.input("reference").placeholder = plant?.reference ?? "";
}
