// Two files compared: their surfaces over the same inputs, their difference, and what it means.

import { choice, clean, el, eachFrame, pane, shortNumber } from "./draw.js";
import { drawPanel } from "./panel.js";
import { S } from "./strings.js";

/**
 * The pane; the file that is open comes first.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function comparePane(store, hand) {
  return new ComparePane(store, hand).section;
}

class ComparePane {
  /**
   * @param {Page.Store} store
   * @param {Page.Hand} hand
   */
  constructor(store, hand) {
    this.store = store;
    this.hand = hand;

    const { section, bar, body } = pane("compare", S.compare);
    this.section = section;
    this.bar = bar;
    this.canvases = [0, 1].map(() => el("canvas", { role: "img" }));
    this.state = el("p", { class: "note", role: "status", textContent: S.chooseOther });
    this.changes = el("div", { class: "differing" });
    this.pictures = el("div", { class: "three", hidden: true }, ...this.canvases);
    body.append(this.state, this.pictures, this.changes);
    this.wanted = { other: "", output: "", x: "", y: "", view: "both" };
    this.found = null;
    this.job = null;
    this.names = [];

    this.redraw = eachFrame(this.draw);
    this.store.on("view", async () => {
      if (this.store.view !== "compare") return;
      this.names = ((await this.hand.folder({ what: "list" })).files ?? []).map((each) => each.name);
      if (this.names.length < 2) this.state.textContent = S.nothingToCompare;
      this.build();
      this.redraw();
    });
    this.store.on("text", () => {
      if (this.found) this.section.classList.add("stale");
    });
    this.store.on("theme", this.redraw);
    new ResizeObserver(this.redraw).observe(body);
  }

  where = (at) =>
    Object.entries(at)
      .map(([name, x]) => `${name} = ${shortNumber(x, 5)}`)
      .join(", ");

  build = () => {
    while (this.bar.childNodes.length > 1) this.bar.lastChild.remove();
    const others = this.names.filter((name) => name !== this.hand.file());
    const set = (name) => (value) => {
      this.wanted[name] = value;
      if (name === "view") this.redraw();
      else this.run();
    };
    this.bar.append(choice(S.with, [["", "…"], ...others.map((n) => [n, n])], this.wanted.other, set("other")));
    this.bar.append(el("span", { class: "space" }));
    if (this.found?.outputs.length > 1) {
      this.bar.append(
        choice(
          S.shown,
          this.found.outputs.map((n) => [n, n]),
          this.found.output,
          set("output"),
        ),
      );
    }
    if (this.found?.shared.length > 2) {
      const axes = this.found.shared.map((n) => [n, n]);
      this.bar.append(
        choice(S.horizontal, axes, this.found.x, set("x")),
        choice(S.vertical, axes, this.found.y, set("y")),
      );
    }
    const views = [
      ["both", S.sideBySide],
      ["difference", S.onlyDifference],
    ];
    this.bar.append(
      choice(S.view, views, this.wanted.view, set("view")),
      el("button", { textContent: S.compareAgain, onclick: this.run }),
    );
  };

  run = async () => {
    this.job?.stop();
    if (!this.wanted.other || this.store.view !== "compare") return;
    this.state.classList.remove("error");
    this.section.classList.remove("stale");
    this.state.textContent = S.working;
    if (!(await this.hand.settled())) {
      this.state.textContent = S.gone;
      return;
    }
    const { other, output, x, y } = this.wanted;
    const at = Object.fromEntries((this.store.scene?.inputs ?? []).map((each, i) => [each.name, this.store.point[i]]));
    const mine = this.hand.start("compare", { other, output, axes: { x, y, at } }, (news) => {
      if (mine === this.job || !this.job) this.hear(news);
    });
    this.job = mine;
  };

  hear = (news) => {
    if (news.outputs) {
      this.found = { ...news, other: this.wanted.other };
      this.pictures.hidden = false;
      this.build();
    }
    if (news.changes) this.showChanges(news.changes);
    if ("largest" in news) this.found.largest = news.largest;
    if (news.end) {
      this.job = null;
      this.state.classList.toggle("error", news.end === "failed");
      this.state.textContent = clean(
        news.end === "failed" ? news.message : news.end === "done" ? this.largestWords() : "",
      );
    }
    this.redraw();
  };

  largestWords = () => {
    const parts = [];
    if (this.found.worst)
      parts.push(
        S.largestHere(
          shortNumber(this.found.worst.difference, 6),
          this.where({ ...this.found.held, ...this.found.worst.at }),
        ),
      );
    if (this.found.largest)
      parts.push(
        S.largest(
          shortNumber(this.found.largest.difference, 6),
          this.where(this.found.largest.at),
          this.found.largest.points,
        ),
      );
    if (this.found.largest?.alone) parts.push(S.oneSided(this.found.largest.alone));
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

export const COMPARE = { name: "compare", title: S.compare, drawn: false, panes: [comparePane] };
