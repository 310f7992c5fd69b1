// Two files compared: their surfaces over the same inputs, their difference, and what it means.

import { choice, clean, el, eachFrame, pane, shortNumber } from "./draw.js";
import { drawLines, drawPlane, rangeOfValues } from "./plane.js";
import { S } from "./strings.js";

/**
 * The pane; the file that is open comes first.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
function comparePane(store, hand) {
  const { section, bar, body } = pane("compare", S.compare);
  const canvases = [0, 1, 2].map(() => el("canvas", { role: "img" }));
  const state = el("p", { class: "note", role: "status", textContent: S.chooseOther });
  const changes = el("div", { class: "differing" });
  const pictures = el("div", { class: "three", hidden: true }, ...canvases);
  body.append(state, pictures, changes);
  const wanted = { other: "", output: "", x: "", y: "", view: "both" };
  let found = null;
  let job = null;
  let names = [];

  function build() {
    while (bar.childNodes.length > 1) bar.lastChild.remove();
    const others = names.filter((name) => name !== hand.file());
    const set = (name) => (value) => {
      wanted[name] = value;
      if (name === "view") redraw();
      else run();
    };
    bar.append(choice(S.with, [["", "…"], ...others.map((n) => [n, n])], wanted.other, set("other")));
    bar.append(el("span", { class: "space" }));
    if (found?.outputs.length > 1) {
      bar.append(
        choice(
          S.shown,
          found.outputs.map((n) => [n, n]),
          found.output,
          set("output"),
        ),
      );
    }
    if (found?.shared.length > 2) {
      const axes = found.shared.map((n) => [n, n]);
      bar.append(choice(S.horizontal, axes, found.x, set("x")), choice(S.vertical, axes, found.y, set("y")));
    }
    const views = [
      ["both", S.sideBySide],
      ["difference", S.onlyDifference],
    ];
    bar.append(
      choice(S.view, views, wanted.view, set("view")),
      el("button", { textContent: S.compareAgain, onclick: run }),
    );
  }

  async function run() {
    job?.stop();
    if (!wanted.other || store.view !== "compare") return;
    state.classList.remove("error");
    section.classList.remove("stale");
    state.textContent = S.working;
    if (!(await hand.settled())) {
      state.textContent = S.gone;
      return;
    }
    const { other, output, x, y } = wanted;
    const at = Object.fromEntries((store.scene?.inputs ?? []).map((each, i) => [each.name, store.point[i]]));
    const mine = hand.start("compare", { other, output, axes: { x, y, at } }, (news) => {
      if (mine === job || !job) hear(news);
    });
    job = mine;
  }

  function hear(news) {
    if (news.outputs) {
      found = { ...news, other: wanted.other };
      pictures.hidden = false;
      build();
    }
    if (news.changes) showChanges(news.changes);
    if ("largest" in news) found.largest = news.largest;
    if (news.end) {
      job = null;
      state.classList.toggle("error", news.end === "failed");
      state.textContent = clean(news.end === "failed" ? news.message : news.end === "done" ? largestWords() : "");
    }
    redraw();
  }

  const where = (at) =>
    Object.entries(at)
      .map(([name, x]) => `${name} = ${shortNumber(x, 5)}`)
      .join(", ");

  function largestWords() {
    const parts = [];
    if (found.worst)
      parts.push(S.largestHere(shortNumber(found.worst.difference, 6), where({ ...found.held, ...found.worst.at })));
    if (found.largest)
      parts.push(S.largest(shortNumber(found.largest.difference, 6), where(found.largest.at), found.largest.points));
    if (found.largest?.alone) parts.push(S.oneSided(found.largest.alone));
    return parts.join(" ") || S.nothingShared;
  }

  function showChanges({ same, mixed, summary, parts }) {
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
    changes.replaceChildren(el("p", { class: "note", textContent: head }), ...lists);
  }

  function draw() {
    if (!found || store.view !== "compare") return;
    const both = wanted.view === "both";
    const [first, second, third] = canvases;
    const { xs, ys, x, y, before, after, output } = found;
    const range = rangeOfValues([before, after]);
    const [low, high] = range;
    const flat = !y;
    const ends = `${shortNumber(low)} … ${shortNumber(high)}`;
    first.hidden = !both;
    second.hidden = !both || flat;
    third.hidden = both;
    const words = { low, high, x, y: y || output };
    const title = (file) => `${file}: ${output}, ${ends}`;
    if (both && flat) {
      drawLines(first, {
        ...words,
        title: S.twoLines(hand.file(), found.other),
        xs,
        lines: [before, after],
        worst: found.worst?.at[x],
      });
    } else if (both) {
      drawPlane(first, { ...words, title: title(hand.file()), xs, ys, z: before });
      drawPlane(second, { ...words, title: title(found.other), xs, ys, z: after });
    } else difference(third, words);
    for (const each of canvases)
      each.setAttribute("aria-label", S.compareLabel(hand.file(), found.other, state.textContent));
  }

  function difference(canvas, words) {
    const { xs, ys, x, y, before, after, worst } = found;
    const z = before.map((value, i) => (value === null || after[i] === null ? null : after[i] - value));
    const [low, high] = rangeOfValues([z], true);
    const title = S.differenceOf(found.other, hand.file(), shortNumber(high));
    const place = worst && (y ? [worst.at[x], worst.at[y]] : worst.at[x]);
    if (y) drawPlane(canvas, { ...words, title, xs, ys, z, low, high, signed: true, worst: place });
    else drawLines(canvas, { ...words, title, xs, lines: [z], low, high, worst: place });
  }

  const redraw = eachFrame(draw);
  store.on("view", async () => {
    if (store.view !== "compare") return;
    names = ((await hand.folder({ what: "list" })).files ?? []).map((each) => each.name);
    if (names.length < 2) state.textContent = S.nothingToCompare;
    build();
    redraw();
  });
  store.on("text", () => {
    if (found) section.classList.add("stale");
  });
  store.on("theme", redraw);
  new ResizeObserver(redraw).observe(body);
  return section;
}

export const COMPARE = { name: "compare", title: S.compare, drawn: false, panes: [comparePane] };
