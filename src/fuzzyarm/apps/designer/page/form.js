// The form of a request: a field for each of its JSON Schemas, whatever the job. What a field takes, its words and its
// default are those of the record in Python; what is wrong with a value is said beside it, in the words of the command.

import { el, field as labelled, refill, sayWrong, select } from "./draw.js";
import { choicesOf, controlOf, isOptional, quoted, optionsOf, shownDefault, typeOf, valueOf } from "./fields.js";
import { S } from "./strings.js";

const WIDE = ["claim", "from", "with", "over"]; // sentences
const JUDGED = { check: "change", choice: "change", lines: "input", text: "input" };
/** @param {Messages.FormField} field */
const wordsOf = ({ name, placeholder }) => S.fields[`${name} ${placeholder}`] ?? S.fields[name] ?? [];
/** @param {Messages.FormField} field */
const titleOf = (field) => wordsOf(field)[0] ?? field.title;
let forms = 0; // each has ids of its own

export class Form {
  /**
   * @param {{ changed?: (name: string) => void, judge?: (values: Record<string, any>) => Promise<Page.Answer> }} ends
   *   `changed` hears which field was; `judge` asks what is wrong while a hand fills the form in.
   */
  constructor({ changed = () => {}, judge } = {}) {
    this.changed = changed;
    this.judge = judge;
    this.id = `form-${++forms}`;
    /** @type {Map<string, { field: Messages.FormField, input: any, label: HTMLElement }>} */
    this.rows = new Map();
    this.first = el("div", { class: "fields" });
    this.folded = el("div", { class: "folded" });
    this.view = el("div", { class: "request" }, this.first, this.folded);
    this.asked = 0;
  }

  /**
   * Build the fields, where they are not there yet.
   *
   * @param {Messages.FormField[]} fields
   */
  open(fields) {
    if (this.rows.size) return;
    const groups = new Map([["", this.first]]);
    for (const field of fields) {
      const group = field.group ?? "";
      if (!groups.has(group)) groups.set(group, this.fold(group));
      groups.get(group).append(this.row(field));
    }
  }

  fold(title) {
    const inside = el("div", { class: "fields" });
    const words = title.charAt(0).toUpperCase() + title.slice(1);
    this.folded.append(el("details", { class: "experiment" }, el("summary", { textContent: words }), inside));
    return inside;
  }

  /** @param {Messages.FormField} field */
  row(field) {
    const kind = controlOf(field);
    const input = this.control(field, kind);
    input.title = field.description ?? "";
    input.dataset.key = `${this.id}-${field.name}`;
    input.addEventListener(JUDGED[kind], () => this.touched(field.name));
    const words = field.unit ? `${titleOf(field)}, ${field.unit}` : titleOf(field);
    const label = kind === "check" ? el("label", { class: "check" }, input, words) : labelled(words, input);
    label.title = input.title;
    this.rows.set(field.name, { field, input, label });
    return label;
  }

  control(field, kind) {
    const shown = shownDefault(field);
    if (kind === "check") return el("input", { type: "checkbox", checked: shown });
    if (kind === "choice") return select(choicesOf(field, { usual: S.usual, yes: S.yes, no: S.no }), shown);
    const plain = { value: shown, spellcheck: false, autocomplete: "off" };
    const isNumber = ["integer", "number"].includes(typeOf(field));
    const [, example = ""] = wordsOf(field);
    const placeholder = example || (isOptional(field) ? S.usual : "");
    if (kind === "lines") return el("textarea", { ...plain, rows: 2, cols: 30, placeholder: S.oneALine });
    return el("input", {
      ...plain,
      type: "text",
      placeholder,
      size: isNumber ? 7 : WIDE.includes(field.name) ? 40 : typeOf(field) === "array" ? 18 : 12,
      inputMode: isNumber ? "decimal" : "text",
    });
  }

  /** A field has been changed by a hand; what is wrong with it is asked for once it rests. */
  touched(name) {
    this.changed(name);
    if (!this.judge) return;
    const mine = ++this.asked;
    setTimeout(async () => {
      if (mine !== this.asked) return;
      const { field = "", message = "" } = await this.judge(this.values());
      if (mine === this.asked) this.mark(field, message, false);
    }, 250);
  }

  has = (name) => this.rows.has(name);
  input = (name) => this.rows.get(name)?.input;
  isShown = (name) => this.rows.get(name)?.label.hidden === false;

  /** The value of a field as its control shows it; empty while it is not there. */
  shown = (name) => this.input(name)?.value ?? "";

  set(name, value) {
    const input = this.input(name);
    if (!input) return;
    if (input.type === "checkbox") input.checked = value;
    else input.value = value;
  }

  /** Give a field choices that only the page knows: files, plants. */
  choices(name, pairs, chosen = this.shown(name)) {
    const row = this.rows.get(name);
    if (!row) return;
    if (row.input.tagName !== "SELECT") {
      const { title, dataset } = row.input;
      const list = el("select", { title, "data-key": dataset.key, onchange: () => this.touched(name) });
      row.input.replaceWith(list);
      row.input = list;
    }
    refill(row.input, pairs, chosen);
  }

  /** Suggest values of a text. */
  suggest(name, values) {
    const row = this.rows.get(name);
    if (!row) return;
    const id = `${row.input.dataset.key}-list`;
    row.label.querySelector("datalist")?.remove();
    row.label.append(el("datalist", { id }, ...values.map((value) => el("option", { value }))));
    row.input.setAttribute("list", id);
  }

  /** Show some fields and hide others. */
  show(names, isShown) {
    for (const name of names) if (this.rows.has(name)) this.rows.get(name).label.hidden = !isShown;
    for (const details of this.folded.children)
      details.toggleAttribute("hidden", ![...details.querySelectorAll("label")].some((label) => !label.hidden));
  }

  /** Whether a hand may fill it in. */
  lock(isLocked) {
    for (const { input } of this.rows.values()) input.disabled = isLocked;
  }

  /**
   * What the fields say that are seen, by name.
   *
   * @returns {Record<string, any>}
   */
  values() {
    const found = {};
    for (const [name, { field, input, label }] of this.rows) {
      if (!label.hidden) found[name] = valueOf(field, input.type === "checkbox" ? input.checked : input.value);
    }
    return found;
  }

  /** The same in words of a command. */
  words(values = this.values()) {
    const fields = [...this.rows.values()].map(({ field }) => field);
    return optionsOf(fields, values).map(quoted);
  }

  /** A message in the words of the page: those of the command name its options, and fields. */
  inWords(message) {
    const fields = [...this.rows.values()].map(({ field }) => field).toSorted((a, b) => b.name.length - a.name.length);
    return fields.reduce((words, field) => {
      const named = words.startsWith(`${field.name} `) ? titleOf(field) + words.slice(field.name.length) : words;
      return field.option ? named.replace(new RegExp(`${field.option}(?![\\w-])`, "g"), titleOf(field)) : named;
    }, message);
  }

  /** Say a mistake beside its field, and nothing beside others; where no field has that name, say so. */
  mark(name, message = "", focus = true) {
    if (focus) this.asked++; // what is still being judged says no more than this
    const option = /^--[\w-]+/.exec(message)?.[0]; // it may be another field that the message begins with
    const [at = name] = [...this.rows.keys()].filter((own) => option && this.rows.get(own).field.option === option);
    for (const [own, { input }] of this.rows) {
      sayWrong(input, own === at ? this.inWords(message) : "");
      if (own !== at || !message) continue;
      input.closest("details")?.setAttribute("open", "");
      if (focus) input.focus();
    }
    return this.rows.has(at);
  }
}
