// Prove: what `fuzzyarm prove` says of the text that is open, with the region or the tube of a loop as a picture.

import { stage } from "./charts.js";
import { clean, el, pane } from "./draw.js";
import { Form } from "./form.js";
import { drawPanel } from "./panel.js";
import { S } from "./strings.js";

/**
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function provePane(store, hand) {
  return new ProvePane(store, hand).section;
}

class ProvePane {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand} hand
   */
  constructor(store, hand) {
    this.store = store;
    this.hand = hand;
    this.job = null;
    this.stale = true; // whether the form is that of an older text
    this.loop = null; // whether the form is that of a controller
    this.drawings = []; // of the verdicts that are shown
    const { section, body } = pane("prove", S.prove);
    this.section = section;
    this.place = el("div");
    this.start = el("button", { class: "main", textContent: S.proveIt, disabled: true, onclick: () => this.begin() });
    this.stop = el("button", { textContent: S.stop, disabled: true, onclick: () => this.job?.stop() });
    this.said = el("p", { class: "said", role: "status" });
    this.verdicts = el("div", { class: "verdicts" });
    body.tabIndex = 0; // it scrolls
    body.append(this.place, el("div", { class: "actions" }, this.start, this.stop), this.said, this.verdicts);
    store.on("view", this.ask);
    store.on("text", () => {
      this.stale = true;
      this.ask();
    });
  }

  /** Which form the text wants. */
  ask = () => {
    if (this.store.view !== PROVE.name || !this.stale || this.job) return;
    this.stale = false;
    this.hand.start("provable", {}, (news) => {
      if (news.end === "failed") {
        this.said.textContent = clean(news.message);
        this.start.disabled = true;
      }
      if (news.end) return;
      this.build(news);
      this.said.textContent = clean(S.proveLines(news.lines));
      this.start.disabled = false;
    });
  };

  /** @param {any} news */
  build({ loop, form, outputs, plants }) {
    if (loop !== this.loop) {
      this.loop = loop;
      this.form = new Form({
        judge: (values) => this.hand.askNow("judge", { form: loop ? "prove-loop" : "prove", values }),
      });
      this.form.open(form);
      this.place.replaceChildren(this.form.view);
    }
    this.form.choices(
      "output",
      outputs.map((each) => [each, each]),
    );
    this.form.choices("plant", [["", S.usual], ...plants.map((each) => [each, each])]);
    this.form.show(["output"], outputs.length > 1);
  }

  begin = () => {
    this.form.mark("");
    this.verdicts.replaceChildren();
    this.said.textContent = S.working;
    this.job = this.hand.start("prove", { form: this.form.values() }, this.hear);
    this.show();
  };

  hear = (news) => {
    if (news.doing) this.said.textContent = clean(news.doing);
    if (news.verdict) this.add(news);
    if (!news.end) return;
    this.job = null;
    const isSaid = news.end === "failed" && this.form.mark(news.field ?? "", news.message);
    this.said.textContent = clean(news.end === "failed" ? (isSaid ? "" : news.message) : S.proveEnds[news.end]);
    this.show();
    this.ask();
  };

  show() {
    this.start.disabled = Boolean(this.job);
    this.stop.disabled = !this.job;
    this.form.lock(Boolean(this.job));
  }

  /** A verdict, and its pictures below it. */
  add({ verdict, lines, panels }) {
    const pictures = panels.map((panel) => {
      const body = el("div", { class: "picture" });
      const { canvas } = stage(this.store, body, () => drawPanel(canvas, panel));
      canvas.setAttribute("aria-label", clean(`${panel.title}: ${panel.up.words}`));
      return body;
    });
    const words = el("pre", { class: "printed", tabIndex: 0, "aria-label": verdict, textContent: lines.join("\n") });
    this.verdicts.append(el("div", { class: `verdict ${verdict}` }, words, el("div", { class: "drawn" }, ...pictures)));
  }
}

export const PROVE = { name: "prove", title: S.prove, drawn: false, panes: [provePane] };
