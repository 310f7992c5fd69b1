// A controller or a rule base as a block diagram, and the rule bases and tables that a controller looks up.

import { clean, eachFrame, el, space, svg } from "./draw.js";
import { drawPanel } from "./panel.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";

const ROOM = 14; // around the picture
const TIP = 7; // of a wire
const SIGNS = { "+": "+", "-": "−", "*": "×", "/": "÷" };
const GREATEST = 1.25; // scale
const LEAST = 0.75; // below, letters are too small: the picture scrolls

/** The corners of a block as a path; a gain has a point. */
export function outline({ kind, round, x, y, width, height }) {
  const [right, bottom] = [x + width, y + height];
  if (round)
    return `M${x} ${y + width / 2}a${width / 2} ${width / 2} 0 0 1 ${width} 0V${bottom - width / 2}a${width / 2} ${width / 2} 0 0 1 ${-width} 0Z`;
  if (kind !== "gain") return `M${x} ${y}H${right}V${bottom}H${x}Z`;
  return `M${x} ${y}H${right - 16}L${right} ${y + height / 2}L${right - 16} ${bottom}H${x}Z`;
}

/** The picture of a diagram; `goTo` leads from a block to its line of the text. */
export function diagramPicture(diagram, goTo) {
  const { width, height, blocks, strokes, tips, dots, words } = diagram;
  const line = ([x1, y1, x2, y2]) => svg("line", { x1, y1, x2, y2 });
  const tip = ([x, y]) => svg("path", { class: "tip", d: `M${x} ${y}l${-TIP} ${-TIP / 2}v${TIP}Z` });
  const word = ({ text, x, y, style }) => svg("text", { x, y, class: style }, text);
  const picture = svg(
    "svg",
    {
      viewBox: `${-ROOM} ${-ROOM} ${width + 2 * ROOM} ${height + 2 * ROOM}`,
      role: "group",
      "aria-label": S.diagramLabel(diagram.name, blocks.length),
      class: "wires",
    },
    ...strokes.map(line),
    ...tips.map(tip),
    ...dots.map(([cx, cy]) => svg("circle", { cx, cy, r: 3 })),
    ...words.map(word),
    ...blocks.map((block) => blockPicture(block, goTo)),
  );
  picture.style.width = `${Math.round(GREATEST * (width + 2 * ROOM))}px`;
  picture.style.minWidth = `${Math.round(LEAST * (width + 2 * ROOM))}px`;
  return picture;
}

function blockPicture(block, goTo) {
  const { kind, x, y, width, height, lines, pins, label, at } = block;
  const middle = x + (width - (kind === "gain" ? 16 : 0)) / 2;
  const top = y + (height - 16 * lines.length) / 2;
  const said = `${S.blockKinds[kind] ?? kind} ${label}`.trim();
  const leads =
    at && goTo
      ? {
          tabindex: 0,
          role: "button",
          onclick: () => goTo(at),
          onkeydown: (event) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), goTo(at)),
        }
      : {};
  return svg(
    "g",
    { class: `block ${kind}`, ...leads },
    svg("title", {}, said),
    svg("path", { d: outline(block) }),
    ...lines.map(([text, style], i) => svg("text", { x: middle, y: top + 16 * i + 12, class: style }, text)),
    ...pins.map(([sign, , at_]) => svg("text", { x: x + width / 2, y: at_ + 5, class: "sign" }, SIGNS[sign] ?? sign)),
  );
}

/**
 * What a rule base or a table of a controller does, as a small picture, and the way to its file.
 *
 * @param {Page.Hand} hand
 */
function sheetCard(sheet, hand, names) {
  const canvas = el("canvas", { role: "img", "aria-label": S.sheetLabel(sheet) });
  const open = sheetButton(sheet, hand, names);
  const words = sheet.kind === "rules" ? S.rulesOf(sheet.count) : S.cellsOf(sheet.count);
  const card = el(
    "div",
    { class: "sheet" },
    el(
      "div",
      { class: "row" },
      el("strong", { textContent: sheet.name }),
      el("span", { class: "small", textContent: words }),
      space(),
      ...open,
    ),
    sheet.panel ? canvas : el("p", { class: "note", textContent: sheet.why }),
  );
  const draw = () => {
    if (sheet.panel) drawPanel(canvas, sheet.panel);
  };
  return { card, draw };
}

/**
 * What leads to a file of the folder, or brings a shipped one there.
 *
 * @param {Page.Hand} hand
 */
function sheetButton({ file, shipped }, hand, names) {
  if (names.includes(file)) return [el("button", { textContent: S.openFile(file), onclick: () => hand.turnTo(file) })];
  if (!shipped) return [];
  return [
    el("button", {
      textContent: S.copyHere(file),
      title: S.copyHereHint,
      onclick: async (event) => {
        const made = await hand.folder({ what: "adopt", file });
        if (made.open) hand.turnTo(made.open);
        else event.target.after(el("span", { class: "error", role: "alert", textContent: made.error }));
      },
    }),
  ];
}

/** The pane: it is shown first where the text is a controller. */
export class DiagramPane extends Pane {
  constructor(store, hand) {
    super(store, hand, "diagram", S.diagram);
    const { bar, body } = this;
    this.said = el("span", { class: "small" });
    this.picture = el("div", { class: "canvas" });
    this.list = el("div", { class: "sheets", role: "group", "aria-label": S.lookedUp });
    this.cards = [];
    this.used = ""; // the names of the files that have been looked at
    this.asked = "";
    this.toRules = el("button", { textContent: S.toRules, onclick: () => store.turnDiagram(false) });
    bar.append(this.said, space(), this.toRules);
    body.append(this.picture, this.list);
    this.redraw = eachFrame(() => this.cards.forEach(({ draw }) => draw()));
    store.on("diagram", this.build);
    store.on("scene", this.build);
    this.on(["view", "shown", "unsaved", "files"], this.look);
    store.on("theme", this.redraw);
    new ResizeObserver(this.redraw).observe(this.list);
  }

  build = () => {
    const { diagram, scene } = this.store;
    this.toRules.hidden = !scene;
    if (!diagram) return;
    this.said.textContent = clean([diagram.name, diagram.description, diagram.period].filter(Boolean).join(", "));
    this.bar.querySelector("h2").textContent = diagram.isSystem ? S.system : S.diagram;
    this.picture.replaceChildren(diagramPicture(diagram, this.hand.goTo));
    if (this.uses() !== this.used) this.look();
  };

  uses = () => JSON.stringify(this.store.diagram?.uses ?? null);

  /** Ask what is looked up, when other files are used, or they have been written, or it has not been shown yet. */
  look = async () => {
    if (!this.store.diagram || this.store.view !== "design") return;
    this.list.hidden = this.store.diagram.isSystem;
    if (this.list.hidden) return;
    this.used = this.uses();
    const listing = await this.hand.folder({ what: "list" });
    if (!listing.files || this.used !== this.uses()) return;
    const names = listing.files.map((each) => each.name);
    const files = this.store.diagram.uses.flatMap(([, ...each]) => each);
    const stamps = listing.files.filter((each) => files.includes(each.name)).map((each) => [each.name, each.stamp]);
    const key = JSON.stringify([this.used, stamps]);
    if (key === this.asked) return;
    this.asked = key;
    this.hand.start("sheets", {}, (news) => {
      if (news.end === "failed") this.asked = this.used = "";
      if (!news.sheets || key !== this.asked) return;
      const { hand } = this;
      this.cards = news.sheets.map((sheet) =>
        sheetCard({ ...sheet, shipped: sheet.shipped && !listing.only }, hand, names),
      );
      this.list.replaceChildren(...this.cards.map(({ card }) => card));
      this.redraw();
    });
  };
}
