// Two files compared: their surfaces over the same inputs, their difference, and what it means.

import { choice, clean, eachFrame, el, pairsOf, placeWords, shortNumber, space } from "./draw.js";
import { drawPanel } from "./panel.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { Task } from "./task.js";

/** The pane; the file that is open comes first. */
class ComparePane extends Pane {
  constructor(store, hand) {
    super(store, hand, "compare", S.compare);
    const { body } = this;
    this.canvases = [0, 1].map(() => el("canvas", { role: "img" }));
    this.state = el("p", { class: "note", role: "status" });
    this.changes = el("div", { class: "differing" });
    this.pictures = el("div", { class: "three", hidden: true }, ...this.canvases);
    body.append(this.state, this.pictures, this.changes);
    this.wanted = { other: "", output: "", x: "", y: "", view: "both" };
    this.found = null;
    this.task = new Task(hand, "compare");
    this.names = [];

    this.redraw = eachFrame(this.draw);
    this.on(["view", "files"], this.look);
    this.store.on("text", () => {
      if (this.found) this.section.classList.add("stale");
    });
    this.store.on("theme", this.redraw);
    new ResizeObserver(this.redraw).observe(body);
  }

  /** Ask which files there are to compare with. */
  look = async () => {
    if (this.store.view !== "compare") return;
    const { files, error } = await this.hand.folder({ what: "list" });
    if (files) this.names = files.map((each) => each.name);
    if (!this.found && !this.task.job) {
      this.say(error ?? (this.names.length < 2 ? S.nothingToCompare : S.chooseOther), Boolean(error));
    }
    this.build();
    this.redraw();
  };

  say(words, isWrong = false) {
    this.state.textContent = clean(words);
    this.state.classList.toggle("error", isWrong);
  }

  build = () => {
    const others = this.names.filter((name) => name !== this.hand.file());
    const set = (name) => (value) => {
      this.wanted[name] = value;
      if (name === "view") this.redraw();
      else this.run();
    };
    const { outputs = [], shared = [], output, x, y } = this.found ?? {};
    const views = [
      ["both", S.sideBySide],
      ["difference", S.onlyDifference],
    ];
    this.setTools(
      choice(S.with, [["", "…"], ...pairsOf(others)], this.wanted.other, set("other")),
      space(),
      ...(outputs.length > 1 ? [choice(S.shown, pairsOf(outputs), output, set("output"))] : []),
      ...(shared.length > 2
        ? [choice(S.horizontal, pairsOf(shared), x, set("x")), choice(S.vertical, pairsOf(shared), y, set("y"))]
        : []),
      choice(S.view, views, this.wanted.view, set("view")),
      el("button", { textContent: S.compareAgain, onclick: this.run }),
    );
  };

  run = () => {
    if (!this.wanted.other || this.store.view !== "compare") return;
    this.say(S.working);
    this.section.classList.remove("stale");
    const { other, output, x, y } = this.wanted;
    this.task.beginSettled(() => ({ other, output, axes: { x, y, at: this.store.place() } }), this.hear);
  };

  hear = (news) => {
    if (news.outputs) {
      this.found = { ...news, other: this.wanted.other };
      this.pictures.hidden = false;
      this.build();
    }
    if (news.changes) this.showChanges(news.changes);
    if ("largest" in news) this.found.largest = news.largest;
    if (news.end === "failed") this.say(news.message, true);
    else if (news.end) this.say(news.end === "done" ? this.largestWords() : "");
    this.redraw();
  };

  largestWords = () => {
    const { worst, largest, held } = this.found;
    const parts = [];
    if (worst) parts.push(S.largestHere(shortNumber(worst.difference, 6), placeWords({ ...held, ...worst.at })));
    if (largest) parts.push(S.largest(shortNumber(largest.difference, 6), placeWords(largest.at), largest.points));
    if (largest?.alone) parts.push(S.oneSided(largest.alone));
    return parts.join(" ") || S.nothingShared;
  };

  showChanges = ({ same, mixed, summary, parts }) => {
    const lists = parts.flatMap(([title, rows]) => [
      el("h3", { textContent: S.changed[title] ?? title }),
      el(
        "ul",
        {},
        ...rows.map(([kind, words]) =>
          el(
            "li",
            { class: kind },
            el("span", { class: "mark", "aria-label": S.marks[kind][1], textContent: S.marks[kind][0] }),
            ` ${words}`,
          ),
        ),
      ),
    ]);
    const head = mixed ? S.mixed : same ? S.sameMeaning : (summary ?? S.inMeaning);
    this.changes.replaceChildren(el("p", { class: "note", textContent: head }), ...lists);
  };

  draw = () => {
    if (!this.found || this.store.view !== "compare") return;
    const panels = this.wanted.view === "both" ? this.found.both : [this.found.difference];
    this.canvases.forEach((canvas, i) => {
      canvas.hidden = i >= panels.length;
      canvas.setAttribute("aria-label", S.compareLabel(this.hand.file(), this.found.other, this.state.textContent));
      if (!canvas.hidden) drawPanel(canvas, panels[i]);
    });
  };
}

export const COMPARE = { name: "compare", title: S.compare, drawn: false, further: true, panes: [ComparePane] };
