// A rule base where a controller is wanted: what to do, and which files of the folder can run.

import { fill } from "./dialogs.js";
import { clean, el } from "./draw.js";
import { S } from "./strings.js";

/**
 * Ask for a name, make a controller around the rule base that is open, and turn to it.
 *
 * @param {Page.Hand} hand
 */
export async function makeAround(hand) {
  const file = hand.file();
  if (!(await hand.save())) return; // a controller uses what is saved
  const made = await fill(
    S.aroundTitle(file),
    [{ name: "name", label: S.name, value: S.aroundName(file) }],
    S.create,
    (values) => hand.folder({ what: "new", kind: "controller", around: file, ...values }),
  );
  if (made?.open) hand.turnTo(made.open);
}

/**
 * The line that says it; `show` takes whether it is wanted, and whether the arm takes the rules as they are.
 *
 * @param {Page.Hand} hand
 */
export function aroundLine(hand) {
  const line = el("p", { class: "around", hidden: true });
  const go = (name) => el("button", { textContent: clean(name), onclick: () => hand.turnTo(name) });
  let asked = 0;
  const links = (words, names) => (names.length ? [` ${words} `, ...names.slice(0, 8).map(go)] : []);

  async function show(wanted, onArm) {
    const mine = ++asked;
    if (!wanted) {
      line.hidden = true;
      return;
    }
    const listing = await hand.folder({ what: "list" });
    const using = (await hand.folder({ what: "users", file: hand.file() })).users ?? [];
    if (mine !== asked) return; // the text is another one by now
    const others = (listing.files ?? []).filter((each) => each.kind === "controller" && !using.includes(each.name));
    const make = el("button", { class: "main", textContent: S.makeAround, onclick: () => makeAround(hand) });
    line.replaceChildren(
      clean(S.aloneRuns(hand.file(), onArm)),
      " ",
      ...(listing.only ? [S.onlyOneAround] : [make]),
      ...links(S.usedIn, using),
      ...links(
        S.canRun,
        others.map((each) => each.name),
      ),
    );
    line.hidden = false;
  }

  return { line, show };
}

/**
 * Say which files of a controller have more in their windows than what is saved, which is what runs.
 * `show` takes the files that it uses; the line goes when they are saved.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
export function unsavedLine(store, hand) {
  const line = el("p", { class: "around", hidden: true });
  const wrong = el("span", { class: "error", role: "alert" });
  let uses = [];

  function draw() {
    const names = hand.unsaved().filter((name) => uses.includes(name));
    line.hidden = !names.length;
    wrong.textContent = "";
    const buttons = names.map((name) =>
      el("button", {
        textContent: S.saveFile(name),
        onclick: async () => {
          const { error } = await hand.saveFile(name);
          wrong.textContent = error ? ` ${clean(error)}` : "";
        },
      }),
    );
    line.replaceChildren(clean(S.unsavedUsed(names)), " ", ...buttons, wrong);
  }

  store.on("unsaved", draw);
  return {
    line,
    show(used) {
      uses = used;
      draw();
    },
  };
}
