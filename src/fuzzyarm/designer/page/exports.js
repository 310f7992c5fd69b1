// Exports of the text as it is now: a dialog for each kind, with what the command has as options.

import { clean, el, pane } from "./draw.js";
import { S } from "./strings.js";

/** @type {Array<[string, string[]]>} */
const GROUPS = [
  ["programs", [".h", ".c", ".st", ".fmu", ".mjs"]],
  ["tables", [".lut", ".csv", ".tex", ".json", ".npz"]],
  ["pictures", [".png", ".svg"]],
  ["pages", [".html"]],
  ["others", [".fis", ".fll", ".fcl", ".fml"]],
];
const SOURCES = [".h", ".c", ".st", ".xml"];

/**
 * The pane of the exports of the file that is open.
 *
 * @param {Page.Store} store
 * @param {Page.Hand} hand
 */
export function exportPane(store, hand) {
  const { section, body } = pane("exports", S.exports);
  const note = el("p", { class: "note", textContent: S.exportsNote });
  const groups = el("div", { class: "groups" });
  body.append(note, groups);

  async function build() {
    if (store.view !== "files" || !hand.file()) return;
    const { kinds = [] } = await hand.askNow("exports");
    groups.replaceChildren(
      ...GROUPS.flatMap(([name, suffixes]) => {
        const shown = suffixes.filter((suffix) => kinds.includes(suffix));
        if (!shown.length) return [];
        const buttons = shown.map((suffix) =>
          el("button", { textContent: S.exportKinds[suffix], title: suffix, onclick: () => openDialog(suffix, kinds) }),
        );
        return [
          el(
            "div",
            { role: "group", "aria-label": S.exportGroups[name] },
            el("h3", { textContent: S.exportGroups[name] }),
            ...buttons,
          ),
        ];
      }),
    );
  }

  function openDialog(suffix, kinds) {
    exportDialog(hand, suffix, fieldsOf(suffix, kinds, store));
  }

  store.on("view", build);
  store.on("text", build);
  return section;
}

/**
 * The fields that matter for a kind; an empty one is as without the option of the command.
 *
 * @param {Page.Store} store
 */
function fieldsOf(suffix, kinds, store) {
  const controller = kinds.includes(".fmu");
  const ofTable = kinds.includes(".npz");
  const outputs = controller || ofTable ? [] : (store.scene?.outputs ?? []).map((each) => each.name);
  const one =
    outputs.length > 1 ? [{ name: "output", options: [["", S.everyOutput], ...outputs.map((n) => [n, n])] }] : [];
  const named = outputs.length > 1 ? [{ name: "output", options: outputs.map((n) => [n, n]) }] : [];
  const mode = {
    name: "mode",
    options: [
      ["", S.asInFile],
      ["bins", "bins"],
      ["nearest", "nearest"],
      ["linear", "linear"],
    ],
  };
  const made = [{ name: "levels", hint: S.levelsHint }, mode];
  const precision = {
    name: "precision",
    options: [
      ["", S.usualOne],
      ["mixed", "mixed"],
      ["float32", "float32"],
      ["float64", "float64"],
    ],
  };
  const whole = {
    name: "q",
    options: [
      ["", S.floats],
      ["15", "int16 (q15)"],
      ["7", "int8 (q7)"],
    ],
  };
  const ways = controller
    ? [
        ["direct", S.direct],
        ["table", S.byTable],
      ]
    : [
        ["", S.asInFile], // the rules, unless the file has settings of a table
        ["direct", S.direct],
        ["table", S.byTable],
      ];
  const way = { name: "way", options: ways };
  const name = { name: "name", hint: S.nameHint };
  if (suffix === ".fmu")
    return [
      way,
      ...made,
      whole,
      {
        name: "fmi",
        options: [
          ["2", "2.0"],
          ["3", "3.0"],
        ],
      },
    ];
  if (SOURCES.includes(suffix)) {
    return ofTable ? [mode, whole, precision, name] : [way, ...one, ...made, whole, precision, name];
  }
  if ([".lut", ".csv", ".tex"].includes(suffix) && !ofTable) {
    return [...named, ...made, { name: "tolerance" }, { name: "round" }];
  }
  if ([".png", ".svg"].includes(suffix) && !ofTable) {
    return [
      {
        name: "what",
        options: [
          ["all", S.wholeFile],
          ["terms", S.terms],
          ["surface", S.surface],
        ],
      },
      ...one,
    ];
  }
  return [];
}

const field = ({ name, options, hint }) => {
  const label = S.options[name];
  const control = options
    ? el("select", { name }, ...options.map(([value, words]) => el("option", { value, textContent: words })))
    : el("input", { type: "text", name, placeholder: hint ?? "", autocomplete: "off" });
  return el("label", { class: "field" }, el("span", { textContent: label }), control);
};

/** What was chosen: of fields that do not apply to the way nothing. */
/**
 * @param {HTMLFormElement} form
 * @returns {Record<string, any>}
 */
function valuesOf(form) {
  const values = Object.fromEntries([...new FormData(form)].filter(([, value]) => value !== ""));
  const direct = values.way === "direct";
  for (const name of direct ? ["levels", "mode", "q"] : []) delete values[name];
  return values;
}

/**
 * @param {Page.Hand} hand
 */
function exportDialog(hand, suffix, fields) {
  const state = el("p", { class: "state", role: "status" });
  const found = el("ul", { class: "made" });
  const lines = el("pre", { class: "printed", tabIndex: 0, hidden: true, "aria-label": S.report });
  const go = el("button", { type: "submit", textContent: S.exportNow });
  const close = el("button", { type: "button", textContent: S.close, onclick: () => dialog.close() });
  const form = el(
    "form",
    { class: "exporting" },
    el("strong", { textContent: S.exportTitle(S.exportKinds[suffix], hand.file()) }),
    ...fields.map(field),
    state,
    found,
    lines,
    el("div", { class: "row" }, close, go),
  );
  const dialog = el("dialog", { "aria-label": S.exports }, form);
  let job = null;
  const chosenWay = form.elements.way;
  const dim = () => {
    const direct = chosenWay?.value === "direct";
    for (const name of ["levels", "mode", "q"]) if (form.elements[name]) form.elements[name].disabled = direct;
    if (form.elements.precision) form.elements.precision.disabled = Boolean(form.elements.q?.value) && !direct;
  };
  form.addEventListener("change", dim);
  dim();
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (job) return;
    const options = valuesOf(form);
    go.disabled = true;
    found.replaceChildren();
    lines.hidden = true;
    state.textContent = S.working;
    state.classList.remove("error");
    await hand.settled(); // what is typed is exported
    job = hand.start("export", { suffix, options }, hear);
  });

  function hear(news) {
    if (news.doing) state.textContent = clean(`${news.doing} …`);
    if (news.files) show(news);
    if (!news.end) return;
    job = null;
    go.disabled = false;
    if (news.end === "failed") {
      state.textContent = clean(news.message);
      state.classList.add("error");
    } else if (news.end === "done") state.textContent = S.exported;
  }

  function show(news) {
    const links = news.files.map(({ name, bytes, href }) =>
      el("a", { href, download: name, textContent: S.download(clean(name), bytes) }),
    );
    found.replaceChildren(...links.map((link) => el("li", {}, link)));
    lines.textContent = clean(news.lines.join("\n"));
    lines.hidden = !news.lines.length;
    if (links.length === 1) links[0].click();
  }

  dialog.addEventListener("close", () => {
    job?.stop();
    dialog.remove();
  });
  document.body.append(dialog);
  dialog.showModal();
  if (!fields.length) form.requestSubmit();
}
