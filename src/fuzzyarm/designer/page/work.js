// A view of one form: a request of Python, the work that it begins, and below what comes of it: lines as a command
// prints them, pictures, files to load.

import { stage } from "./charts.js";
import { confirm } from "./dialogs.js";
import { clean, el, pane } from "./draw.js";
import { Form } from "./form.js";
import { drawPanel } from "./panel.js";
import { S } from "./strings.js";

/** What views differ in: their names, and what they say. */
/**
 * @typedef {{ name: keyof Messages.Works, title: string, go: string, facts: keyof Messages.Works, ends: Record<string, string>,
 *   form: (facts: any) => string, fill: (form: Form, facts: any, boxes: Map<string, any>) => void, ready: (facts: any) => string,
 *   changed?: (form: Form, facts: any, name: string) => void, enough?: string, saves?: boolean,
 *   options?: Record<string, [string, string]> }} Kind
 *   `facts` is the work that tells the form; `fill` puts in what only the folder or the text knows; with `enough` the
 *   work may be ended and its best kept; with `saves` what came of it can be written into the folder; `options` are boxes to
 *   be checked beside the form, with their words.
 */

export class WorkPane {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand} hand
   * @param {Kind} kind
   */
  constructor(store, hand, kind) {
    this.store = store;
    this.hand = hand;
    this.kind = kind;
    this.job = null;
    this.isOver = true; // whether nothing is computed: a job may wait to write what it has
    this.stale = true; // whether the form is that of an older text
    this.known = null; // which form is shown
    this.facts = null;
    const { section, body } = pane(kind.name, kind.title);
    section.classList.add("asked");
    this.section = section;
    this.place = el("div");
    this.start = el("button", { class: "main", textContent: kind.go, disabled: true, onclick: () => this.begin() });
    this.stop = el("button", { textContent: kind.enough ?? S.stop, disabled: true, onclick: () => this.halt() });
    this.said = el("p", { class: "said", role: "status" });
    this.results = el("div", { class: "verdicts" });
    body.tabIndex = 0; // it scrolls
    this.boxes = new Map();
    const actions = el("div", { class: "actions" }, this.start, this.stop, ...this.choices(), ...this.saving());
    body.append(this.place, actions, this.said, this.results);
    store.on("view", this.ask);
    for (const name of ["text", "files"]) {
      store.on(name, () => {
        this.stale = true;
        this.ask();
      });
    }
  }

  /** Boxes to be checked beside the form. */
  choices() {
    return Object.entries(this.kind.options ?? {}).map(([name, [words, title]]) => {
      const box = el("input", { type: "checkbox" });
      this.boxes.set(name, box);
      return el("label", { class: "check", title }, box, words);
    });
  }

  /** The name of a file for what came of it, and the button that writes it. */
  saving() {
    if (!this.kind.saves) return [];
    this.name = el("input", { type: "text", size: 18, "aria-label": S.nameOfFile });
    this.save = el("button", {
      textContent: S.save,
      disabled: true,
      onclick: () => this.job?.say({ save: this.name.value }),
    });
    return [el("span", { class: "space" }), this.name, this.save];
  }

  /** Which form the text wants. */
  ask = () => {
    if (this.store.view !== this.kind.name || !this.stale || !this.isOver) return;
    this.stale = false;
    this.hand.start(this.kind.facts, {}, (news) => {
      if (news.end === "failed") {
        this.said.textContent = clean(news.message);
        this.start.disabled = true;
      }
      if (news.end) return;
      this.build(news);
      if (!this.job) this.said.textContent = clean(this.kind.ready(news));
      this.start.disabled = false;
    });
  };

  /** @param {any} facts */
  build(facts) {
    this.facts = facts;
    const known = this.kind.form(facts);
    if (known !== this.known) {
      this.known = known;
      this.form = new Form({
        changed: (name) => this.kind.changed?.(this.form, this.facts, name),
        judge: (values) => this.hand.askNow("judge", { form: known, values }),
      });
      this.form.open(facts.form);
      this.place.replaceChildren(this.form.view);
    }
    this.kind.fill(this.form, facts, this.boxes);
  }

  begin() {
    this.job?.stop();
    this.form.mark("");
    this.results.replaceChildren();
    this.said.textContent = S.working;
    this.isOver = false;
    const mine = (this.job = this.hand.start(this.kind.name, this.wanted(), (news) => {
      if (this.job === mine) this.hear(news); // an older one may still speak
    }));
    this.show();
  }

  /** What is asked for. */
  wanted() {
    const checked = [...this.boxes].filter(([, box]) => box.checked).map(([name]) => [name, true]);
    return { form: this.form.values(), ...Object.fromEntries(checked) };
  }

  halt() {
    if (!this.kind.enough) this.job?.stop();
    else this.job?.say({ enough: true });
  }

  hear = (news) => {
    if (news.doing) this.said.textContent = clean(news.doing);
    if (news.lines) this.add(news);
    if (news.name) this.written(news.name);
    if (news.saved) this.said.textContent = clean(S.savedAs(news.saved));
    if (news.unsaved) this.said.textContent = clean(news.unsaved);
    if (news.exists) this.replace(news.exists);
    if (news.end) this.ended(news);
    this.show();
    if (news.end) this.ask();
  };

  ended({ end, field = "", message = "" }) {
    this.job = null;
    this.isOver = true;
    const isSaid = end === "failed" && this.form.mark(field, message);
    this.said.textContent = clean(end === "failed" ? (isSaid ? "" : message) : this.kind.ends[end]);
  }

  /** It waits, and can be written. */
  written(name) {
    this.isOver = true;
    this.name.value = name;
    this.said.textContent = clean(this.kind.ends.done);
  }

  async replace(existing) {
    if (await confirm(S.replaceFile(existing), S.replace)) this.job?.say({ save: existing, replace: true });
    this.save.focus();
  }

  show() {
    this.start.disabled = !this.isOver;
    this.stop.disabled = this.isOver;
    if (this.save) this.save.disabled = !(this.isOver && this.job);
    this.form?.lock(!this.isOver);
  }

  /** A result: its lines, its pictures below them, and what can be loaded. */
  add({ verdict, lines, panels, files = [] }) {
    const pictures = panels.map((panel) => {
      const body = el("div", { class: "picture" });
      const { canvas } = stage(this.store, body, () => drawPanel(canvas, panel));
      canvas.setAttribute("aria-label", clean(`${panel.title}: ${panel.up.words}`));
      return body;
    });
    const label = verdict || this.kind.title;
    const words = el("pre", { class: "printed", tabIndex: 0, "aria-label": label, textContent: lines.join("\n") });
    const links = files.map(({ name, address }) => el("a", { href: address, download: name, textContent: name }));
    const row = links.length ? [el("p", { class: "loads" }, `${S.toLoad} `, ...links)] : [];
    const drawn = el("div", { class: "drawn" }, ...pictures);
    this.results.append(el("div", { class: `verdict ${verdict}`.trim() }, words, ...row, drawn));
  }
}

/**
 * Show the fields of a form that a plant understands, with what it may follow; `first` are further choices.
 *
 * @param {Form} form
 * @param {{ trajectories: string[], carries: boolean, reference: string } | undefined} plant
 * @param {Array<[string, string]>} first
 */
export function showGrounds(form, plant, first = []) {
  const moves = Boolean(plant?.trajectories.length);
  form.show(["trajectory"], moves);
  form.show(["payload"], moves && plant.carries);
  form.show(["reference", "duration"], Boolean(plant) && !moves);
  form.choices("trajectory", [...first, ...(plant?.trajectories ?? []).map((each) => pairOf(each))]);
  if (form.has("reference")) form.input("reference").placeholder = plant?.reference ?? "";
}

/** @returns {[string, string]} */
export const pairOf = (word) => [word, word];
