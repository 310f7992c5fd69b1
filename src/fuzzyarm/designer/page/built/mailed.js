// @ts-nocheck: built by editors/designer/build.js from exported.js and what it imports
(() => {
  // draw.js
  var UNSEEN = /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u200e\u200f\u2028-\u202e\u2066-\u2069]/g;
  function clean(text) {
    return String(text).replace(UNSEEN, "\uFFFD");
  }
  var cleaned = (children) => children.map((each) => typeof each === "string" ? clean(each) : each);
  function el(name, properties = {}, ...children) {
    const made = document.createElement(name);
    for (const [key2, value] of Object.entries(properties)) {
      if (key2 === "class") made.className = value;
      else if (key2.startsWith("on")) made.addEventListener(key2.slice(2), value);
      else if (key2 === "textContent" || key2 === "title") made[key2] = clean(value);
      else if (key2 in made && key2 !== "list") made[key2] = value;
      else made.setAttribute(key2, typeof value === "string" ? clean(value) : value);
    }
    made.append(...cleaned(children));
    return made;
  }
  function svg(name, attributes = {}, ...children) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key2, value] of Object.entries(attributes)) {
      if (key2.startsWith("on")) made.addEventListener(key2.slice(2), value);
      else if (key2 === "style")
        made.style.cssText = value;
      else made.setAttribute(key2, value);
    }
    made.append(...cleaned(children));
    return made;
  }
  function keepFocus(root2) {
    const held = (
      /** @type {HTMLInputElement} */
      document.activeElement
    );
    if (!held || held === document.body || !root2.contains(held)) return () => {
    };
    const { key: key2 } = held.dataset;
    const chosen = typeof held.selectionStart === "number" ? [held.selectionStart, held.selectionEnd] : null;
    return () => {
      const same = () => [...root2.querySelectorAll("[data-key]")].find((each) => each.dataset.key === key2);
      const next = held.isConnected ? held : key2 && same();
      if (!next || next === document.activeElement) return;
      next.focus({ preventScroll: true });
      if (chosen) next.setSelectionRange(...chosen);
    };
  }
  function pane(kind, title2) {
    const id = `title-${kind}`;
    const bar2 = el("div", { class: "bar" }, el("h2", { id, textContent: title2 }));
    const body = el("div", { class: "body" });
    const section = el("section", { class: `pane ${kind}`, "aria-labelledby": id, tabIndex: -1 }, bar2, body);
    return { section, bar: bar2, body };
  }
  function choice(label, options, chosen, onchange) {
    const select = el("select", { onchange: () => onchange(select.value) });
    for (const [value, text] of options) {
      select.append(el("option", { value, textContent: text, selected: value === chosen }));
    }
    return el("label", { class: "small" }, label, select);
  }
  function shortNumber(x, digits = 4) {
    if (!Number.isFinite(x)) return "\u2013";
    return String(Number(x.toPrecision(digits)));
  }
  var HUES = [
    ["#2563a8", "#74b3f7"],
    ["#b34e14", "#ff9e63"],
    ["#1f7a4a", "#66cf97"],
    ["#a23b8f", "#ec8fdc"],
    ["#7a6000", "#dcbf45"],
    ["#0b7484", "#58cfe0"],
    ["#b3343f", "#ff8e97"],
    ["#5f50c0", "#b3a8ff"]
  ].map((pair) => `light-dark(${pair.join(", ")})`);
  function hue(index) {
    return HUES[index % HUES.length];
  }
  var STOPS = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37]
  ];
  var SHADES = Array.from({ length: 256 }, (_, i) => {
    const at = i / 255 * (STOPS.length - 1);
    const low = Math.min(Math.floor(at), STOPS.length - 2);
    return STOPS[low].map((c, k) => Math.round(c + (at - low) * (STOPS[low + 1][k] - c)));
  });
  function heat(share) {
    const t = Math.max(-1, Math.min(1, 2 * share - 1));
    const [r, g, b] = t < 0 ? [33, 102, 172] : [178, 24, 43];
    const strength = 0.85 * Math.abs(t);
    const mixed = [r, g, b].map((c) => Math.round(247 + strength * (c - 247)));
    return [`rgb(${mixed.join(" ")})`, luminance(mixed) < 0.18 ? "#ffffff" : "#000000"];
  }
  function luminance(colour) {
    const [r, g, b] = colour.map((c) => c <= 10 ? c / 3294 : ((c / 255 + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  }
  function context(canvas, width, height) {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    return { g, width, height };
  }
  function colourOf(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }
  function eachFrame(draw) {
    let asked = 0;
    return () => {
      asked ||= requestAnimationFrame(() => {
        asked = 0;
        draw();
      });
    };
  }

  // geometry/chart.js
  function ticks(low, high, wanted = 5) {
    const raw = (high - low) / wanted;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((x) => x * power).find((x) => x >= raw) ?? raw;
    const found = [];
    for (let x = Math.ceil(low / step - 1e-9); x * step <= high + 1e-9 * step; x++) {
      found.push(Number((x * step).toPrecision(12)));
    }
    return found;
  }
  function decades(low, high) {
    const wide = high / low > 200;
    const found = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++) {
      for (const digit of wide ? [1] : [1, 2, 5]) {
        const v = digit * 10 ** power;
        if (v >= low * 0.9 && v <= high * 1.1) found.push(v);
      }
    }
    return found.length > 1 ? found : ticks(low, high, 3);
  }

  // strings.js
  var S = {
    designer: "fuzzyarm designer",
    file: "File",
    save: "Save",
    saved: "saved",
    unsaved: "not saved",
    format: "Format",
    undo: "Undo",
    redo: "Redo",
    revert: "Back to the file",
    revertHint: "The text as it is saved; one step back undoes it",
    dark: "Dark",
    light: "Light",
    theme: "Light or dark",
    gone: "The server does not answer. Your text is kept in this page, and is sent when it is back.",
    back: "connected again",
    conflict: "Another program has changed the file, and something here is not saved.",
    reread: "Another program has changed the file. This is its text now.",
    follows: "Another window writes this file; this one follows it.",
    behind: "Another window writes this file. What was typed here last is not in it.",
    writeHere: "Write here",
    fileGone: "The file is gone from the folder. Save writes it anew.",
    unreadable: (why) => `The file has changed on disk, and is not taken: ${why}.`,
    keepMine: "Keep mine",
    takeTheirs: "Take the file's",
    keepBoth: "Keep both",
    otherWindow: "Another window has had other lines here while the server was away.",
    keepThis: "Keep these",
    takeOther: "Take the other's",
    text: "Text",
    editor: "The text of the file",
    findings: "Findings",
    noFindings: "no findings",
    fix: "Fix \u2026",
    allow: "Choose \u2026",
    noFix: "No quick fix is known here.",
    fixes: "Quick fixes",
    rename: "Rename",
    renameTo: "New name of",
    cancel: "Cancel",
    ok: "OK",
    close: "Close",
    working: "working \u2026",
    report: "What is known of it",
    files: "Files",
    kind: "Kind",
    description: "Description",
    newFile: "New file \u2026",
    importFile: "Import \u2026",
    importHint: "Rule bases and tables of other programs: drop them anywhere on this page",
    onlyOne: "The designer has one file open; open its folder to write others. What is dropped takes the place of the text.",
    emptyFolder: "This folder has no rule base yet",
    emptyHint: "Begin with one of these; everything in it can be changed, by hand or in its text.",
    startTitles: {
      blank: "Blank",
      pd: "Two inputs, PD",
      pi: "Two inputs, PI",
      single: "One input",
      controller: "Controller"
    },
    startNames: { blank: "blank.frb", pd: "pd.frb", pi: "pi.frb", single: "single.frb", controller: "controller.frb" },
    around: "rule base",
    shippedRules: "pd7.frb, which comes with fuzzyarm",
    orImport: "Or drop a rule base or a table of another program anywhere on this page:",
    foreignFiles: "Rule bases of other programs in this folder; a click converts one:",
    convertHint: "Write it in the language, beside the file",
    notSound: "not sound",
    notThere: (name) => `${name} is not in this folder.`,
    duplicate: "Duplicate",
    duplicateOf: (name) => `Duplicate ${name}`,
    renameFile: "Rename",
    renameOf: (name) => `Rename ${name}`,
    deleteFile: "Delete",
    deleteOf: (name) => `Delete ${name}`,
    template: "made for",
    nameOfFile: "name",
    unnamed: "unnamed.frb",
    create: "Create",
    copyOf: (name) => name.replace(/(\.[^.]*)$/, "-copy$1"),
    usedBy: (names) => `It is used by ${names}.`,
    unsavedGoes: "What is not saved goes with it.",
    deleteForGood: "The file is deleted for good.",
    noScripts: "A script is not run from a page. fuzzyarm convert SCRIPT.py -o FOLDER runs it; the page shows what it makes.",
    tooLarge: (bytes, most) => `The file has ${bytes} bytes; at most ${most} are taken here. fuzzyarm convert has no such limit.`,
    converting: (name) => `${name} is converted \u2026`,
    notRead: (why) => `It cannot be read; a folder cannot be imported. (${why})`,
    notImported: (name) => `${name} is not imported`,
    importedAs: (name, made) => `${name} is now ${made}`,
    otherKind: (name) => `${name} is of another kind: a rule base is not a table.`,
    replaceText: (name, dropped) => `Replace the text of ${name} by what ${dropped} says? One step back undoes it.`,
    replaceIt: "Replace",
    dropHere: "Drop rule bases and tables here",
    exports: "Export",
    exportsNote: "Of the text as it is now, saved or not; the files that a controller uses are taken as they are saved.",
    exportGroups: {
      programs: "Program",
      tables: "Table",
      pictures: "Picture",
      pages: "Page",
      others: "For other programs"
    },
    exportKinds: {
      ".h": "C header",
      ".c": "C, two files",
      ".st": "Structured Text",
      ".xml": "PLCopen XML",
      ".fmu": "FMU",
      ".mjs": "JavaScript",
      ".lut": "Table .lut",
      ".csv": "CSV",
      ".tex": "LaTeX",
      ".json": "JSON",
      ".npz": "NumPy",
      ".png": "PNG",
      ".svg": "SVG",
      ".html": "Page without a server",
      ".fis": "FIS",
      ".fll": "FLL",
      ".fcl": "FCL",
      ".fml": "FML"
    },
    exportTitle: (kind, name) => `${kind} of ${name}`,
    exportNow: "Export",
    exported: "done",
    download: (name, bytes) => `${name}, ${bytes} bytes`,
    options: {
      way: "inference",
      output: "output",
      levels: "levels",
      mode: "looked up by",
      q: "numbers of the table",
      precision: "precision",
      name: "names begin with",
      tolerance: "smallest within",
      round: "rounded to",
      fmi: "version of FMI",
      what: "what is drawn"
    },
    levelsHint: "49, or -6 .. 6 step 1, or e = 49, ce = 25",
    asInFile: "as in the file",
    everyOutput: "every output",
    tables: "Table",
    cells: "Cells",
    tableOf: (output, cells2, mode) => `${cells2} cells of ${output}, looked up by ${mode}`,
    axisLevels: (name, count, low, high, bins) => `${name}: ${count} levels ${low} \u2026 ${high}${bins ? ", bins" : ""}`,
    thinned: "not every level is shown",
    tableError: "Table against direct inference",
    measure: "Measure",
    measureAgain: "Measure again",
    signed: "table \u2212 rules",
    provedCells: "proved per cell",
    provedSoFar: (done, all) => `${done} of ${all} cells proved \u2026`,
    provedAll: "Every cell is proved: between the points, too, its error is not larger.",
    worstAt: (output, mode, where, table, direct, difference, proved) => `Worst by ${mode}: at ${where} the table has ${output} = ${table}, the rules ${direct}: ${difference} apart. ` + (proved === null ? "This is the largest of many points, and not proved." : `Proved: nowhere more than ${proved}.`),
    errorTitle: (output, mode, held) => `${output} by ${mode}${held ? `, ${held}` : ""}`,
    compare: "Compare",
    with: "with",
    chooseOther: "Choose the file to compare with.",
    nothingToCompare: "There is no other file in this folder.",
    sideBySide: "side by side",
    onlyDifference: "difference",
    compareAgain: "Compare again",
    largestHere: (size, where) => `Largest difference here: ${size} at ${where}.`,
    largest: (size, where, points) => `Over all inputs: ${size} at ${where} (of ${points} points).`,
    oneSided: (count) => `At ${count} points only one of them has a value.`,
    nothingShared: "There is no point at which both have a value.",
    compareLabel: (before, after, words) => `${before} compared with ${after}. ${words}`,
    changed: { rules: "Rules", terms: "Terms", settings: "Settings", cells: "Cells" },
    marks: { changed: ["~", "changed"], added: ["+", "added"], removed: ["\u2212", "removed"], more: ["\u2026", "more"] },
    mixed: "A rule base and a table: only their surfaces are compared.",
    sameMeaning: "Both mean the same.",
    inMeaning: "What differs in meaning:",
    helpTitle: "Help and keys",
    helpHint: "Help and keys: ? or F1",
    help: [
      {
        title: "Everywhere",
        words: [
          "The text on the left is what counts: whatever you drag, choose or add is an edit of it, and one step back undoes it. Borders between panes can be dragged."
        ],
        rows: [
          ["? or F1", "this help (? where nothing is typed)"],
          ["F6 or Shift+F6", "to the next pane, or to the one before; Tab goes on within it"],
          ["Ctrl+Z or Ctrl+Shift+Z", "undo and redo"],
          ["Ctrl+S", "save"],
          ["\u2190 \u2192 \u2191 \u2193", "move a border that has the focus; Enter puts it back"]
        ]
      },
      {
        title: "Text",
        words: ["Point at a word to read what it means. Findings stand below."],
        rows: [
          ["Ctrl+Space", "what could stand here"],
          ["F2", "give the name under the cursor another one, everywhere"],
          ["Ctrl+.", "fixes for the finding of this line"],
          ["Shift+Alt+F", "format"],
          ["Ctrl+F", "search"]
        ]
      },
      {
        title: "Design: terms",
        view: "design",
        words: [
          "Drag a circle to move a corner, a diamond to change a width, the name to move a whole term. A term that is chosen shows its kind and its numbers below, to be typed. Above each plot: another term, the range, another name, remove it."
        ],
        rows: [
          ["Tab", "from handle to handle"],
          ["\u2190 \u2192", "move the handle; with Ctrl ten steps"],
          ["Alt", "neighbours that share the corner move along"],
          ["Shift", "the term on the other side moves as well"]
        ]
      },
      {
        title: "Design: rules, surface, inference",
        view: "design",
        words: [
          "A cell of the grid is a list. The name of a row or a column leads to what is done with it. Methods opens to the lists of and, or, implication, aggregation and defuzzifier.",
          "A click in the contour, or a slider, moves the point. Rules that fire there are framed; they are called by their place in the text."
        ],
        rows: [["\u2190 \u2192 \u2191 \u2193", "turn the surface, or move the point in a contour, a line or a section"]]
      },
      {
        title: "Run",
        view: "run",
        words: [
          "A controller on a plant. The run stands at its time with all of it in view; Go on, or a push, takes it further. What is changed then is run from the start."
        ],
        rows: [
          ["Space", "pause and go on, in the picture"],
          ["\u2190 \u2192 \u2191 \u2193", "push the plant, in the picture; with Shift harder"]
        ]
      },
      {
        title: "Table",
        view: "table",
        words: ["How far a lookup table is from the rules; of a .lut file its cells."],
        rows: [["\u2190 \u2192 \u2191 \u2193", "from cell to cell"]]
      },
      {
        title: "Learn and Tune",
        view: "tune",
        words: ["A table that learns while it runs; a search for better numbers, with its report."],
        rows: []
      },
      {
        title: "Sweep, Fit and Prove",
        view: "prove",
        words: [
          "Many runs over ranges, with a map; a rule base from samples; verdicts on `prove` lines, bounds, sectors and loops."
        ],
        rows: []
      },
      {
        title: "Compare",
        view: "compare",
        words: ["The file beside another one: surfaces, and what differs in meaning."],
        rows: []
      },
      {
        title: "Files",
        view: "files",
        words: ["New files, copies, other names, imports and exports. Files can be dropped anywhere."],
        rows: [["\u2191 \u2193", "from name to name"]]
      }
    ],
    split: "Drag it, or move it with the arrow keys; Enter or a double click puts it back",
    splitOf: (vertical) => vertical ? "Width of the panes beside" : "Height of the panes above and below",
    design: "Design",
    terms: "Terms",
    inputs: "input",
    outputs: "output",
    partition: "Partition",
    partitionHint: "Neighbours that share a corner move along (or hold Alt)",
    mirror: "Mirror",
    mirrorHint: "The term on the other side moves as well (or hold Shift)",
    snap: "Snap",
    snapHint: "Corners stop at round numbers",
    wholeTerm: (variable, term) => `${variable} ${term}: move the whole term`,
    corner: (variable, term, n) => `${variable} ${term}: corner ${n}`,
    lowerCorner: (variable, term, n) => `${variable} ${term}: lower corner ${n}`,
    width: (variable, term, name, lower) => `${variable} ${term}: ${lower ? "lower " : ""}${name}`,
    overShape: "over",
    height: "height",
    kindOf: (variable, term) => `${variable} ${term}: kind of its shape`,
    kindHint: "Another kind at the same place; what it cannot have is lost",
    addTerm: "Term \u2026",
    nameOfTerm: (variable) => `Name of a new term of ${variable}`,
    addTermHint: "Add a term",
    addRole: { input: "Add an input", output: "Add an output" },
    addVariableNote: "Its terms are triangles, evenly spaced from the first to the last name; each can be moved then.",
    addInput: "Input \u2026",
    addOutput: "Output \u2026",
    nameOfVariable: "name",
    lowEnd: "from",
    highEnd: "to",
    namesOfTerms: "terms, from low to high",
    threeTerms: "LOW MIDDLE HIGH",
    notARange: "The ends of a range are two numbers.",
    notANumber: "Where it stands is a number.",
    peak: "peak at",
    renameDots: "Rename \u2026",
    renameVariable: "Give it another name, wherever it stands",
    removeVariable: (name) => `Remove ${name}`,
    removeVariableNote: "Its terms go with it, and the rules, grids, expectations and properties that name it. One step back undoes it.",
    removeVariableHint: "Remove it with all that names it",
    noVariables: "There is no variable yet: add the inputs and outputs of the rule base.",
    methods: "Methods",
    newGrid: "A new grid of rules",
    gridDots: "Grid \u2026",
    gridHint: "Add a grid of rules over one input or two",
    concludes: "concludes",
    oneRow: "(one row)",
    fills: [
      ["rising", "rising with the inputs"],
      ["falling", "falling with the inputs"],
      ["empty", "empty"]
    ],
    removeGrid: (output) => `Remove the grid of ${output}`,
    removeRow: (term) => `Remove the row ${term}`,
    removeColumn: (term) => `Remove the column ${term}`,
    rowOf: (name, term) => `The row where ${name} is ${term}`,
    columnOf: (name, term) => `The column where ${name} is ${term}`,
    addRow: "Add a row \u2026",
    addColumn: "Add a column \u2026",
    rowDots: "Row \u2026",
    columnDots: "Column \u2026",
    addRowOf: (name) => `Add a row of ${name}`,
    addColumnOf: (name) => `Add a column of ${name}`,
    term: "term",
    newTerm: "a new term",
    newTermName: "name of the new term",
    join: "between the parts",
    compose: "Put a rule together",
    ifWord: "if",
    thenWord: "then",
    noRulesYet: "There are no rules yet.",
    missing: { "no-inputs": "an input", "no-outputs": "an output", "no-rules": "rules" },
    notYet: (parts) => `Nothing to draw yet: the rule base needs ${parts.join(", ")}.`,
    remove: "Remove",
    range: "Range \u2026",
    rangeHint: "Its range; evenly spaced terms follow",
    rangeOf: (variable) => `Range of ${variable}`,
    rules: "Rules",
    ruleOf: (row, column) => `rule for ${row}, ${column}`,
    noRule: "no rule",
    ruleAt: (place) => `the rule of ${place}`,
    newRule: "A new rule",
    ifThen: "if \u2026 then \u2026",
    add: "Add",
    change: "Edit",
    fires: (place, strength) => `${place}: ${strength}`,
    severity: { error: "error", warning: "warning", info: "note" },
    between: (low, high) => `${low} \u2026 ${high}`,
    surface: "Surface",
    horizontal: "across",
    vertical: "down",
    shown: "output",
    view: "view",
    solid: "3-D",
    contour: "contour",
    cut: "cut",
    noCut: "none",
    cutAt: (name, value) => `cut at ${name} = ${value}`,
    sectionLabel: (output, name, cut) => `${output} over ${name}, ${cut}. Arrow keys move the point.`,
    byServer: "computed by the server",
    coarse: "with few points: this takes long",
    asking: (reason) => `This page does not compute ${reason}. The server is asked \u2026`,
    surfaceLabel: (output, x, y) => `${output} over ${x}${y ? ` and ${y}` : ""}. Arrow keys turn it, or move the point in the contour.`,
    inference: "Inference",
    value: "value",
    because: "because",
    strength: "strength",
    silent: "does not fire",
    nothingFires: "no rule fires here",
    noValue: "no value",
    order: "rules",
    strongest: "strongest first",
    asWritten: "as in the text",
    interval: (left, right) => `(${left} \u2026 ${right})`,
    aggregate: "all rules together",
    run: "Run",
    runNotFitting: (name) => `${name} (does not fit)`,
    aloneRuns: (name, onArm) => `${name} is a rule base, not a controller: nothing in it says what its inputs measure and what its output drives.` + (onArm ? " As error and rate of its joints the arm takes the rules as they are; for any other plant a controller goes around them." : " A controller goes around it."),
    makeAround: "Make a controller \u2026",
    aroundTitle: (name) => `A controller around ${name}`,
    aroundName: (name) => name.replace(/(\.[^.]*)?$/, "-controller.frb"),
    unsavedUsed: (names) => names.length === 1 ? `${names[0]} has unsaved changes; the run uses the saved version.` : `${names.join(", ")} have unsaved changes; the run uses the saved versions.`,
    saveFile: (name) => `Save ${name}`,
    copyHere: (name) => `Copy ${name} here`,
    copyHereHint: "It comes with fuzzyarm; a copy in this folder can be changed",
    onlyOneAround: "Open the folder to make one.",
    usedIn: "It is used by",
    canRun: "These can run:",
    runFitsNone: "The text controls none of these plants.",
    runReference: "Reference",
    runSignals: ["step:1", "step:1,0.5", "ramp:0.5", "sine:1,0.5", "quintic:1,2"],
    runOpenEnded: "open end",
    runOpenEndedHint: "Until it is stopped; what is older than the time given leaves the picture",
    runSpeed: "Speed",
    runTimes: (times) => `\xD7 ${times}`,
    runFastest: "as fast as possible",
    runStart: "Start",
    runStartHint: "Run the text on the plant",
    runPause: "Pause",
    runResume: "Go on",
    runPauseHint: "Stand still, or go on (in the picture: space)",
    runStep: "Step",
    runStepHint: "One sample further",
    runAgain: "Restart",
    runAgainHint: "From the start, with the text and the settings of now",
    runStop: "Stop",
    runStopHint: "End the run",
    runTime: "Simulated time",
    runBehind: "slower than asked for",
    runStarting: "starting \u2026",
    runWaits: "It has waited while another file was shown.",
    runNextTime: "This counts from the next start on.",
    runTaken: "The text of now runs.",
    runRestart: "The text has another structure now: Restart runs it.",
    runReached: ({ at }) => `${at} s, the time asked for. 'Go on' continues, and so does a push of the plant; what is changed now is run from the start.`,
    runOver: {
      finished: ({ at }) => `Finished at ${at} s.`,
      ended: ({ at }) => `The plant ended the run at ${at} s.`,
      diverged: ({ at, port, value, bound, unit }) => port ? `Diverged: stopped at ${at} s with ${port} ${value === null ? "not a number" : `at ${value} ${unit}`}, beyond its bound of ${bound} ${unit}.` : `Diverged: stopped at ${at} s.`
    },
    runPicture: "Plant",
    runPictureLabel: "Picture of the plant. Drag it with the mouse to push it, or hold the arrow keys (with Shift harder); space pauses.",
    runPulled: ([x, y]) => `push ${Math.round(100 * x)} % \u2192, ${Math.round(100 * y)} % \u2191`,
    runNotYet: "Start runs the text on the plant.",
    runNoPicture: "This plant has no picture; it can be pushed here.",
    runCurves: "Over time",
    runCurvesLabel: "Reference, output, error and drives over time; the numbers stand under Metrics.",
    runOutputs: "output (reference dashed)",
    runError: "error",
    runDrives: "drive",
    runGains: "Gains",
    runGainsNote: "The gains of the controller, while it runs.",
    runNoGains: "This controller has no gains.",
    runGainElsewhere: "Not in this text: it counts for this run only.",
    runMetrics: "Metrics",
    runErrorOf: "error of",
    runMetric: { saturated: "saturated share", variation: "variation per second" },
    runMetricHint: {
      rms: "root mean square of the error",
      max: "error of largest magnitude",
      final: "last error",
      chatter: "root mean square of the change of the drive from period to period",
      settling: "until the error stays within 2 % of a step",
      rise: "from 10 to 90 % of a step",
      effort: "root mean square of the drives",
      saturated: "share of the samples with a drive at a limit"
    },
    runSame: "The same run as a command",
    start: "Start",
    stop: "Stop",
    pause: "Pause",
    goOn: "Go on",
    replace: "Replace it",
    replaceFile: (name) => `${name} exists already. Replace it?`,
    preparing: "preparing \u2026",
    usual: "usual",
    yes: "yes",
    no: "no",
    oneALine: "one a line",
    learn: "Learn",
    thisText: "this text",
    asTheText: "as the text says",
    speed: "Speed",
    watch: "to be watched",
    fast: "as fast as it goes",
    onePass: "One pass",
    onePassHint: "Train one pass, then wait",
    tableName: "Name of the file",
    saveTable: "Save the table",
    tableSaved: (name) => `${name} is written, with where it comes from.`,
    learnsItself: "This text has a table that learns.",
    learnsNot: "This text has no table that learns; shipped controllers that do can be chosen.",
    learning: (news, begin) => {
      const what = news.mode === "run" ? "" : news.mode === "pause" ? ", waiting" : ", stopped";
      const table = news.tables.map((each) => each.visited).join(" and ");
      const lost = news.diverged === null ? "" : ` Diverged at ${news.diverged.toFixed(3)} s.`;
      return `${begin.title} on ${begin.along}: pass ${news.pass} of ${news.limit}${what}; RMS error ${news.words}; ${table} cells visited.${lost}`;
    },
    moment: (news) => `pass ${news.pass}${news.complete ? "" : `, ${news.time.toFixed(2)} s`}`,
    table: "What is learned",
    visits: "Visits",
    errorOfPasses: "Error of each pass",
    axis: "axis",
    noTraining: "Nothing has been learned yet.",
    tableLabel: (axis, table, count) => `Table of ${axis}: ${table.visited} of ${count} cells visited, ${table.changed} changed, values from ${Math.min(...table.values)} to ${Math.max(...table.values)}. Arrow keys read the cells; those that were never visited are hatched.`,
    visitsLabel: (axis, most) => `How often each cell of ${axis} was used, ${most} times at most. Arrow keys read the cells.`,
    errorsLabel: (errors, begin, news) => errors.length ? `RMS error after ${errors.length} passes: ${news.words}; at first ${errors[0].map((x) => x.toPrecision(3)).join(" and ")}.` : "No pass is over yet.",
    cell: (place, value, visits) => visits ? `${place}: ${value}, used ${visits} ${visits === 1 ? "time" : "times"}` : `${place}: ${value}, never used`,
    prove: "Prove",
    proveIt: "Prove",
    proveLines: (count) => count === 1 ? "The text has one `prove` line." : `The text has ${count || "no"} \`prove\` lines.`,
    certificate: "Certificate",
    certificateHint: "Certify what is proved of a loop; fuzzyarm prove --check asks such a file whether it proves what it says",
    proveEnds: { done: "All is judged.", stopped: "Stopped." },
    toLoad: "To load:",
    savedAs: (name) => `Saved as ${name}.`,
    sweep: "Sweep",
    sweepEnds: { done: "All runs are made.", stopped: "Stopped." },
    sweepReady: (gains) => `NAME=A..B:N takes N values from A to B of a gain${gains.length ? ` (${gains.join(", ")})` : ""} or a parameter of the plant.`,
    fit: "Fit",
    fitIt: "Fit",
    fitEnds: { done: "It can be saved.", stopped: "Stopped." },
    fitReady: "A rule base is learned from samples of this folder; the last column is what is learned, unless a target is named.",
    noSamples: "There is no .csv file in this folder; a table or a rule base can be learned as well.",
    none: "none",
    tune: "Tune",
    needsConnect: (name) => `${name} (other axes)`,
    asCompared: "the usual ones",
    fifth: "a fifth of them",
    stopAndKeep: "Stop, keep the best",
    stopping: "Stopping; the best so far is judged \u2026",
    insertTune: "Write it into the text",
    whatMoves: ({ says, parameters, why, loop, plants, samples: samples2 }) => {
      if (why) return `${why[0].toUpperCase()}${why.slice(1)}.`;
      const names = parameters.length > 6 ? `${parameters.length} numbers` : parameters.join(", ");
      const where = loop && !plants.some((each) => each.fits) ? " No plant here has its axes; names can be joined to ports." : !loop && !samples2.length ? " A rule base alone is fitted to samples: there is no .csv file in this folder." : "";
      return `${says ? `What may move, as the text says: ${names}.` : `The text has no tune block and no gain with a range, so all peaks move that can: ${names}.`}${where}`;
    },
    searching: (phase, count, best, evals) => phase === "linear" ? `The linear PD is tuned on the same: ${count} trials.` : `${count} of ${evals} trials; the best costs ${best === null ? "nothing known" : best.toPrecision(4)}.`,
    stopped: (report) => `Stopped after ${report.trials} trials; the best is kept.`,
    tuned: (report) => `${report.trials} trials in ${report.seconds.toFixed(1)} s.`,
    searchState: (count, best, seconds) => `${count} trials, ${seconds.toFixed(0)} s, best ${best === null ? "\u2013" : best.toPrecision(4)}`,
    costOfTrials: "Cost of the trials",
    costLabel: (count, best) => count ? `Cost of ${count} trials; the best so far costs ${best === null ? "nothing known" : best.toPrecision(4)}.` : "No trial yet.",
    numbersThatMove: "Numbers that move, between their bounds",
    numberLabel: (name, value, low, high, start) => `${name}: ${value}, between ${low} and ${high}; ${start} in the file`,
    inTheFile: "in the file",
    more: (count) => `\u2026 and ${count} more.`,
    noSearch: "Nothing is being searched.",
    whatCameOfIt: "What came of it",
    waiting: "The report comes when the search is over.",
    noReport: "Start a search; its report stands here: cost on what it was tuned on, on unseen scenarios and with noise, and what changed.",
    costs: (report) => `${report.cost}, ${report.over} of ${report.scenarios.length === 1 ? "1 scenario" : `${report.scenarios.length} scenarios`}`,
    sets: { train: "train", unseen: "unseen", noisy: "noisy" },
    rmsOf: (set) => `rms (${set})`,
    chatterOf: (set) => `chatter (${set})`,
    diverge: (count) => `${count} diverge`,
    changes: "What changes",
    difference: "The lines that differ",
    takeIt: "Take it",
    takeItHint: "Write the new numbers into the text; one step back undoes it",
    taken: (written2) => `The text has the new numbers; one step back undoes them.${written2.length ? ` ${written2.join(", ")} is written.` : ""}`,
    notTaken: "The text has changed in the same lines meanwhile.",
    notDrawn: "The text has mistakes; nothing has been drawn yet.",
    noRules: "Pictures are drawn of rule bases and controllers. The cells of a table stand in the view Table.",
    diagram: "Block diagram",
    diagramLabel: (name, count) => `Block diagram of ${name}: ${count} blocks; each leads to its line of the text.`,
    blockKinds: { times: "product", plus: "sum", sum: "sum of", port: "", drive: "drive" },
    toRules: "Rule base",
    lookedUp: "What it looks up",
    openFile: (name) => `Open ${name}`,
    rulesOf: (count) => count === 1 ? "1 rule" : `${count} rules`,
    cellsOf: (count) => `table of ${count} cells`,
    sheetLabel: ({ name, output, x, y }) => `${name}: ${output} over ${x}${y ? ` and ${y}` : ""}`,
    notHere: (reason) => `This page does not compute ${reason}. fuzzyarm eval and fuzzyarm plot do.`,
    tooManyRules: "There are too many rules to be drawn.",
    readOnly: "This page needs no server. Corners can be dragged; the text follows.",
    madeBy: (version) => `made by fuzzyarm ${version}`,
    playground: {
      loading: "Python is being loaded; what you type is kept, and checked when it is there.",
      doing: {
        python: "Python is being started; what you type is kept, and checked when it is there.",
        fuzzyarm: "fuzzyarm is being loaded; what you type is kept, and checked when it is there."
      },
      failed: (why) => `Python does not run here: ${why}. Your text is kept in this browser; load the page again to try anew.`,
      notLoaded: "its files could not be loaded",
      noWebAssembly: "This browser has no WebAssembly, which checking and running need; here are your texts, and nothing is lost.",
      noWorker: "This browser has no workers, which checking and running need; here are your texts, and nothing is lost.",
      noServer: "A browser loads Python from a web server only, not from a file: type  python -m http.server  in this folder, and open the address that it prints.",
      damagedLink: "The link is damaged: the file that it carried cannot be read. Your own files are as they were.",
      notKept: "This browser's storage is full: the text lasts only as long as this page is open. Download it.",
      notLasting: "This browser keeps nothing: download what you want to keep.",
      link: "Link",
      linkHint: "an address that carries this file",
      linkNote: "Whoever opens this address has the file; it is not sent to a server.",
      linkTooLong: "The file is too long for an address. Download it, and send it as a file.",
      address: "Address",
      copy: "Copy",
      notCopied: "The browser does not let the page copy: copy the address by hand.",
      download: "Download",
      downloadHint: "save the text as a file"
    }
  };

  // geometry/shapes.js
  var CORNERS = {
    triangle: (p) => [p[0], 0, p[1], 1, p[2], 0],
    trapezoid: (p) => [p[0], 0, p[1], 1, p[2], 1, p[3], 0],
    rectangle: (p) => [p[0], 0, p[0], 1, p[1], 1, p[1], 0],
    ramp: (p) => p[0] <= p[1] ? [p[0], 0, p[1], 1] : [p[1], 1, p[0], 0],
    binary: (p) => p[1] > p[0] ? [p[0], 0, p[0], 1] : [p[0], 1, p[0], 0],
    singleton: (p) => [p[0], 0, p[0], 1, p[0], 0]
  };
  function cornersOf(shape, parameters, height = shape.height) {
    const points = shape.kind === "points" ? parameters : CORNERS[shape.kind]?.(parameters);
    if (!points) return null;
    const found = [];
    for (let i = 0; i < points.length; i += 2) {
      if (Number.isFinite(points[i])) found.push(points[i], points[i + 1] * height);
    }
    return found.length ? found : [0, height];
  }
  var LEVEL = Math.log(9);
  var beside = (centre, width, way = 1, share = 1) => ({
    at: (p) => p[centre] + way * share * p[width],
    to: (p, x) => Math.abs(x - p[centre]) / share
  });
  var slope = (inflection, own) => ({
    at: (p) => p[inflection] + LEVEL / p[own],
    to: (p, x) => LEVEL / (x - p[inflection])
  });
  var WIDTHS = {
    gaussian: { 1: beside(0, 1) },
    // where it is exp(-1/2)
    "two-sided-gaussian": { 1: beside(0, 1, -1), 3: beside(2, 3) },
    bell: {
      1: beside(0, 1),
      // where it is one half; its slope where it is 0.9
      2: {
        at: (p) => p[0] + p[1] * (1 / 9) ** (0.5 / p[2]),
        to: (p, x) => Math.min(50, Math.max(0.1, -0.5 * LEVEL / Math.log(Math.min(0.999, Math.abs(x - p[0]) / p[1]))))
      }
    },
    sigmoid: { 1: slope(0, 1) },
    "sigmoid-difference": { 1: slope(0, 1), 3: slope(2, 3) },
    "sigmoid-product": { 1: slope(0, 1), 3: slope(2, 3) },
    cosine: { 1: beside(0, 1, 1, 0.5) },
    // where it is 0
    spike: { 1: beside(0, 1, 1, 0.1) }
    // where it is exp(-1)
  };
  var sidesOf = (term) => term.lower ? [term, term.lower] : [term];
  var shapeKey = (variable, shape) => `${variable.name}
${shape.name}
${shape.side ?? 0}`;
  function piecesOf(corners, low, high) {
    const last = corners.length - 2;
    const ends = [Math.min(low, corners[0]), corners[1], ...corners, Math.max(high, corners[last]), corners[last + 1]];
    const pieces = [];
    for (let i = 0; i + 3 < ends.length; i += 2) {
      const [x0, y0, x1, y1] = ends.slice(i, i + 4);
      const [a, b] = [Math.max(x0, low), Math.min(x1, high)];
      if (!(b > a)) continue;
      const slope2 = (y1 - y0) / (x1 - x0);
      pieces.push(a, a === x0 ? y0 : y0 + slope2 * (a - x0), b, b === x1 ? y1 : y0 + slope2 * (b - x0));
    }
    return pieces;
  }
  var sendable = (x) => Number.isFinite(x) ? x : x > 0 ? "inf" : "-inf";
  function rangeOf(variable) {
    const known = variable.terms.flatMap((term) => term.parameters.map(Number)).filter(Number.isFinite);
    const low = variable.low ?? Math.min(0, ...known) - 1;
    const high = variable.high ?? Math.max(1, ...known) + 1;
    return [low, high];
  }
  function moved(shape, parameters, index, to, by) {
    const next = [...parameters];
    if (index === null) {
      for (const i of shape.handles) next[i] = parameters[i] + by;
      return next;
    }
    const place = shape.handles.indexOf(index);
    if (shape.ordered || shape.kind === "points") {
      const before = parameters[shape.handles[place - 1]] ?? -Infinity;
      const behind = parameters[shape.handles[place + 1]] ?? Infinity;
      to = Math.min(behind, Math.max(before, to));
    }
    next[index] = to;
    return next;
  }
  var SYMMETRIC = /* @__PURE__ */ new Set(["triangle", "trapezoid", "rectangle", "pi", "semi-ellipse", "s", "z", "singleton"]);
  var TURNED = { s: "z", z: "s" };
  function mirrorOf(kind, p, sum) {
    const flip = (x) => Number((sum - x).toPrecision(12));
    if (SYMMETRIC.has(kind)) return [...p].reverse().map(flip);
    if (kind === "two-sided-gaussian") return [flip(p[2]), p[3], flip(p[0]), p[1]];
    if (kind === "sigmoid") return [flip(p[0]), -p[1]];
    if (kind.startsWith("sigmoid-")) return [flip(p[2]), -p[3], flip(p[0]), -p[1]];
    if (["ramp", "concave", "arc"].includes(kind)) return p.map(flip);
    return WIDTHS[kind] ? [flip(p[0]), ...p.slice(1)] : null;
  }

  // variables.js
  function readEnds(low, high) {
    const ends = [low, high].map((text) => Number(String(text).trim().replace("inf", "Infinity") || NaN));
    return ends.some(Number.isNaN) ? null : ends;
  }
  function readNames(text) {
    return (text.match(/'[^']*'|"[^"]*"|[^\s,]+/g) ?? []).map((name) => name.replace(/^(['"])(.*)\1$/, "$2"));
  }
  var said = (x) => x === null ? "inf" : shortNumber(x, 12);
  var endsWords = ({ low, high }) => `${low === null ? "-inf" : said(low)} .. ${said(high)}`;
  function addVariable({ fill, attempt }, role) {
    return fill(
      S.addRole[role],
      [
        { name: "variable", label: S.nameOfVariable, value: "" },
        { name: "low", label: S.lowEnd, value: role === "input" ? "-1" : "0" },
        { name: "high", label: S.highEnd, value: "1" },
        { name: "terms", label: S.namesOfTerms, value: S.threeTerms }
      ],
      S.add,
      ({ variable, low, high, terms }) => {
        const ends = readEnds(low, high);
        if (!ends) return { error: S.notARange };
        return attempt("variable", {
          role,
          variable: variable.trim(),
          low: sendable(ends[0]),
          high: sendable(ends[1]),
          terms: readNames(terms)
        });
      },
      S.addVariableNote
    );
  }
  function stretch({ fill, attempt }, variable) {
    const [low, high] = endsWords(variable).split(" .. ");
    return fill(
      S.rangeOf(variable.name),
      [
        { name: "low", label: S.lowEnd, value: low },
        { name: "high", label: S.highEnd, value: high }
      ],
      S.ok,
      (values) => {
        const ends = readEnds(values.low, values.high);
        return ends ? attempt("range", { variable: variable.name, low: sendable(ends[0]), high: sendable(ends[1]) }) : { error: S.notARange };
      }
    );
  }
  function rename({ fill, attempt }, variable) {
    return fill(
      `${S.renameTo} ${variable.name}`,
      [{ name: "name", label: S.nameOfVariable, value: variable.name }],
      S.rename,
      ({ name }) => name.trim() === variable.name ? {} : attempt("variable", { variable: variable.name, name: name.trim() })
    );
  }
  function remove({ fill, attempt }, variable) {
    return fill(
      S.removeVariable(variable.name),
      [],
      S.remove,
      () => attempt("variable", { variable: variable.name }),
      S.removeVariableNote
    );
  }
  function newShape(variable, peak) {
    const [low, high] = rangeOf(variable);
    const half = (high - low) / (variable.terms.length + 1);
    const discrete = variable.terms.length && variable.terms.every((term) => term.kind === "singleton");
    const numbers = discrete ? [peak] : [peak - half, peak, peak + half];
    return { kind: discrete ? "singleton" : "triangle", parameters: numbers.map((x) => Number(x.toPrecision(6))) };
  }
  function addTerm({ fill, attempt }, variable, peak) {
    return fill(
      S.nameOfTerm(variable.name),
      [
        { name: "term", label: S.nameOfFile, value: "" },
        { name: "peak", label: S.peak, value: shortNumber(peak, 6) }
      ],
      S.add,
      ({ term, peak: at }) => {
        const number = Number(at.trim() || NaN);
        if (!Number.isFinite(number)) return { error: S.notANumber };
        return attempt("term", { variable: variable.name, term: term.trim(), shape: newShape(variable, number) });
      }
    );
  }
  function variableHead(hand, peakOf) {
    let variable = null;
    const name = el("strong");
    const words = el("span");
    const button = (text, label, act) => el("button", { textContent: text, title: label, onclick: () => act(hand, variable, peakOf(variable)) });
    const tools = !hand.attempt ? [] : [
      button(S.addTerm, S.addTermHint, addTerm),
      button(S.range, S.rangeHint, stretch),
      button(S.renameDots, S.renameVariable, rename),
      button("\xD7", S.removeVariableHint, remove)
    ];
    const element = el("div", { class: "head" }, name, words, el("span", { class: "space" }), ...tools);
    return {
      element,
      show(now, role) {
        variable = now;
        name.textContent = now.name;
        words.textContent = `${role} ${endsWords(now)}`;
        words.title = now.description;
        for (const tool of tools) {
          const label = `${now.name}: ${tool.title}`;
          tool.setAttribute("aria-label", label.includes(tool.textContent) ? label : `${label}: ${tool.textContent}`);
        }
      }
    };
  }

  // terms.js
  var [LEFT, RIGHT, TOP, BOTTOM] = [14, 14, 18, 15];
  var HEAD = 20;
  var DETAILS = 52;
  var [LEAST, MOST] = [60, 240];
  var SMOOTH = 161;
  var LEAST_HEIGHT = 0.05;
  var DIAMOND = 5.5;
  var plotHeight = (room, count) => Math.round(Math.min(MOST, Math.max(LEAST, (room - DETAILS) / Math.max(1, count) - HEAD)));
  function termsPane(store, hand) {
    return new TermsPane(store, hand).section;
  }
  var TermsPane = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store, hand) {
      this.store = store;
      this.hand = hand;
      this.edit = this.hand.edit;
      this.numbers = this.hand.numbers;
      this.change = this.hand.change;
      this.askFor = this.hand.askFor;
      const { section, bar: bar2, body: all } = pane("terms", S.terms);
      this.section = section;
      this.bar = bar2;
      this.all = all;
      this.body = el("div", { class: "plots" });
      this.details = el("div", { class: "details", hidden: true });
      this.all.append(this.body, this.details);
      if (this.hand.attempt) this.bar.append(this.adding(S.addInput, "input"), this.adding(S.addOutput, "output"));
      const toDiagram = el("button", {
        textContent: S.diagram,
        hidden: true,
        onclick: () => this.store.turnDiagram(true)
      });
      this.bar.append(toDiagram, el("span", { class: "space" }));
      this.partition = this.option(S.partition, S.partitionHint, false);
      this.mirror = this.option(S.mirror, S.mirrorHint, false);
      this.snap = this.option(S.snap, S.snapHint, true);
      this.plots = /* @__PURE__ */ new Map();
      this.heads = /* @__PURE__ */ new Map();
      this.tall = LEAST;
      this.chosen = "";
      this.fields = null;
      this.rebuilding = false;
      this.drag = null;
      this.moving = "";
      this.waiting = 0;
      this.wide = 0;
      this.partly = "";
      this.redraw = eachFrame(this.draw);
      this.store.on("scene", this.build);
      this.store.on("diagram", () => {
        toDiagram.hidden = !this.store.diagram;
      });
      this.store.on("reshaped", () => {
        this.partly = this.store.busy ? this.moving : "";
        this.redraw();
      });
      this.store.on("point", () => {
        this.partly = "";
        this.redraw();
      });
      const watch = new ResizeObserver(() => {
        this.wide = this.body.clientWidth;
        this.tall = plotHeight(this.all.clientHeight, this.plots.size);
        this.redraw();
      });
      watch.observe(this.body);
      watch.observe(this.all);
    }
    option = (text, title2, checked) => {
      const box = el("input", { type: "checkbox", checked });
      this.bar.append(el("label", { class: "small", title: title2 }, box, text));
      return box;
    };
    adding = (words, role) => el("button", { textContent: words, title: S.addRole[role], onclick: () => addVariable(this.hand, role) });
    each = () => [...this.store.scene.inputs, ...this.store.scene.outputs];
    termKey = (variable, term) => `${variable.name}
${term.name}`;
    roleOf = (v) => v < this.store.scene.inputs.length ? S.inputs : S.outputs;
    path = (points, at) => points.map(([x, y], i) => `${i ? "L" : "M"}${at.x(x).toFixed(1)} ${at.y(y).toFixed(1)}`).join("");
    peak = (shape, parameters) => {
      if (shape.kind === "triangle") return parameters[1];
      if (shape.kind === "trapezoid") return 0.5 * (parameters[1] + parameters[2]);
      return shape.handles.length === 1 ? parameters[shape.handles[0]] : null;
    };
    /** Whether the term has a place that another kind can take: a shape, or a number of an output. */
    canChange = (term) => this.store.scene.kinds && !["formula", "linear"].includes(term.kind);
    handleAt = (shape, parameters, index) => shape.handles.includes(index) ? parameters[index] : WIDTHS[shape.kind][index].at(parameters);
    plain = ({ parameters, height }) => ({ parameters, height });
    found = () => {
      for (const variable of this.each()) {
        for (const term of variable.terms) if (this.termKey(variable, term) === this.chosen) return { variable, term };
      }
      return null;
    };
    build = () => {
      const names = this.each().map((variable) => variable.name);
      if (this.body.firstChild && JSON.stringify(names) === JSON.stringify([...this.plots.keys()])) {
        if (this.store.busy) this.grip(this.each().find((variable) => variable.name === this.moving));
      } else {
        this.body.replaceChildren(...names.length ? [] : [el("p", { class: "note", textContent: S.noVariables })]);
        this.plots.clear();
        this.heads.clear();
        for (const variable of this.each()) {
          const plot = svg("svg", { role: "group", "aria-label": variable.name });
          const head = variableHead(this.hand, this.peakOfNew);
          this.plots.set(variable.name, plot);
          this.heads.set(variable.name, head);
          this.body.append(head.element, plot);
        }
      }
      this.tall = plotHeight(this.all.clientHeight, names.length);
      this.each().forEach((variable, v) => this.heads.get(variable.name).show(variable, this.roleOf(v)));
      this.describe();
      this.draw();
    };
    /** Where a new term of a variable stands: at the point, or in the middle. */
    peakOfNew = (variable) => {
      const [low, high] = rangeOf(variable);
      const input = this.store.scene.inputs.indexOf(variable);
      return this.rounded(input < 0 ? 0.5 * (low + high) : this.store.point[input], variable);
    };
    scale = (variable) => {
      const width = Math.max(160, this.wide);
      const [low, high] = rangeOf(variable);
      const x = (value) => LEFT + (value - low) / (high - low) * (width - LEFT - RIGHT);
      const back = (pixel) => low + (pixel - LEFT) / (width - LEFT - RIGHT) * (high - low);
      const y = (degree2) => this.tall - BOTTOM - degree2 * (this.tall - TOP - BOTTOM);
      const degree = (pixel) => (this.tall - BOTTOM - pixel) / (this.tall - TOP - BOTTOM);
      return { width, low, high, x, y, back, degree };
    };
    // --- pictures ---
    draw = () => {
      if (!this.store.scene) return;
      const focused = (
        /** @type {SVGElement} */
        document.activeElement?.dataset?.handle
      );
      const only = this.partly;
      this.partly = "";
      this.each().forEach((variable, v) => {
        if (!only || variable.name === only) this.drawOne(variable, v);
      });
      if (focused) {
        const same = [...this.body.querySelectorAll("[data-handle]")].find((e) => e.dataset.handle === focused);
        same?.focus({ preventScroll: true });
      }
      this.fill();
    };
    drawOne = (variable, v) => {
      const plot = this.plots.get(variable.name);
      const at = this.scale(variable);
      const parts = [];
      parts.push(svg("line", { class: "axis", x1: LEFT, x2: at.width - RIGHT, y1: at.y(0), y2: at.y(0) }));
      for (const tick of ticks(at.low, at.high, at.width / 80)) {
        parts.push(svg("text", { x: at.x(tick), y: this.tall - 4, "text-anchor": "middle" }, shortNumber(tick)));
      }
      if (v < this.store.scene.inputs.length) {
        const x = at.x(this.store.point[v]);
        parts.push(svg("line", { class: "at", x1: x, x2: x, y1: TOP, y2: at.y(0) }));
      }
      const handles = [];
      variable.terms.forEach((term, t) => {
        if (!term.curve) return;
        const isChosen = this.termKey(variable, term) === this.chosen;
        const own = isChosen ? "chosen" : "";
        const style = `stroke: ${hue(t)}`;
        const lines = sidesOf(term).map((shape) => this.curve(variable, shape, at));
        if (lines.length > 1) {
          const d = `${this.path(lines[0], at)}${this.path([...lines[1]].reverse(), at).replace("M", "L")}Z`;
          parts.push(svg("path", { d, class: "footprint", style: `fill: ${hue(t)}` }));
        }
        lines.forEach((points, side) => {
          parts.push(svg("path", { d: this.path(points, at), style, class: side ? `${own} lower` : own }));
        });
        handles.push(...this.handlesOf(variable, term, t, at, isChosen));
      });
      plot.setAttribute("width", at.width);
      plot.setAttribute("height", this.tall);
      plot.replaceChildren(...parts, ...handles);
    };
    curve = (variable, shape, at) => {
      const now = this.store.now(variable, shape);
      const corners = shape.straight ? cornersOf(shape, now.parameters, now.height) : null;
      if (!corners) {
        const xs = Float64Array.from({ length: SMOOTH }, (_, i) => at.low + (at.high - at.low) * i / (SMOOTH - 1));
        const ys = this.store.degrees(variable, shape, xs, now);
        return Array.from(xs, (x, i) => [x, ys[i]]);
      }
      const last = corners.length - 2;
      const points = [[Math.min(at.low, corners[0]), corners[1]]];
      for (let i = 0; i <= last; i += 2) points.push([corners[i], corners[i + 1]]);
      points.push([Math.max(at.high, corners[last]), corners[last + 1]]);
      return points;
    };
    handlesOf = (variable, term, t, at, isChosen) => {
      const made = [];
      const top = this.peak(term, this.store.now(variable, term).parameters) ?? term.centre;
      if (top !== null) {
        const x = at.x(Math.min(at.high, Math.max(at.low, top)));
        const half = 3.6 * term.name.length;
        const anchor = x < half ? "start" : x > at.width - half ? "end" : "middle";
        made.push(
          svg(
            "text",
            {
              x: anchor === "start" ? 3 : anchor === "end" ? at.width - 3 : x,
              y: TOP - 6,
              "text-anchor": anchor,
              class: "term",
              style: `fill: ${hue(t)}`,
              ...this.target(variable, term, term, null, S.wholeTerm(variable.name, term.name), top, at)
            },
            term.name
          )
        );
      }
      for (const shape of sidesOf(term)) {
        const now = this.store.now(variable, shape);
        const style = `stroke: ${hue(t)}`;
        shape.handles.forEach((index, place) => {
          const value = now.parameters[index];
          if (!isChosen && (shape.side || value !== top)) return;
          if (value < at.low || value > at.high) return;
          const label = (shape.side ? S.lowerCorner : S.corner)(variable.name, term.name, place + 1);
          const own = this.target(variable, term, shape, index, label, value, at);
          const [cx, cy] = [at.x(value), at.y(this.heightAt(variable, shape, now, index, value))];
          made.push(svg("circle", { cx, cy, r: isChosen && !shape.side ? 5.5 : 4, style, ...own }));
        });
        if (!isChosen) continue;
        for (const [index, width] of Object.entries(WIDTHS[shape.kind] ?? {})) {
          const value = width.at(now.parameters);
          if (!(value >= at.low && value <= at.high)) continue;
          const said2 = S.width(variable.name, term.name, shape.names[index], Boolean(shape.side));
          const own = this.target(variable, term, shape, Number(index), said2, value, at, now.parameters[index]);
          const [x, y] = [at.x(value), at.y(this.store.degrees(variable, shape, Float64Array.of(value), now)[0])];
          const d = `M${x - DIAMOND} ${y}L${x} ${y - DIAMOND}L${x + DIAMOND} ${y}L${x} ${y + DIAMOND}Z`;
          made.push(svg("path", { d, class: "width", style, ...own }));
        }
      }
      return made;
    };
    target = (variable, term, shape, index, label, value, at, said2 = value) => {
      return {
        tabindex: 0,
        role: "slider",
        "aria-label": label,
        "aria-valuenow": Math.min(at.high, Math.max(at.low, value)),
        "aria-valuemin": at.low,
        "aria-valuemax": at.high,
        "aria-valuetext": shortNumber(said2, 6),
        "data-handle": `${shapeKey(variable, shape)}
${index}`,
        "data-side": shape.side ?? 0,
        "data-variable": variable.name,
        "data-term": term.name,
        "data-index": index ?? "whole",
        onpointerdown: (event) => this.take(event, variable, term, shape, index),
        onkeydown: (event) => this.step(event, variable, term, shape, index),
        onfocus: () => this.choose(variable, term)
      };
    };
    choose = (variable, term) => {
      const key2 = this.termKey(variable, term);
      if (key2 !== this.chosen) {
        this.chosen = key2;
        this.describe();
        this.redraw();
      }
    };
    heightAt = (variable, shape, now, index, value) => {
      if (shape.kind === "points") return now.parameters[index + 1] * now.height;
      if (shape.kind === "triangle") return index === 1 ? now.height : 0;
      if (shape.kind === "trapezoid") return index % 3 ? now.height : 0;
      return this.store.degrees(variable, shape, Float64Array.of(value), now)[0];
    };
    // --- numbers beside, and what is done with whole terms ---
    /** Build the line below the plots for the term that is chosen. */
    describe = () => {
      const one = this.found();
      this.details.hidden = !one;
      this.fields = [];
      if (!one) {
        this.details.replaceChildren();
        return;
      }
      const { variable, term } = one;
      const parts = [el("strong", { textContent: `${variable.name} ${term.name}` })];
      for (const shape of sidesOf(term)) {
        if (this.change && !shape.side && this.canChange(term)) parts.push(this.kindOf(variable, term));
        else parts.push(el("span", { textContent: shape.side ? `${S.overShape} ${shape.kind}` : shape.kind }));
        if (term.kind !== "formula" && term.kind !== "linear") parts.push(...this.fieldsOf(variable, term, shape));
      }
      if (this.change) {
        const button = (text, act) => el("button", { textContent: text, onclick: act });
        parts.push(
          el("span", { class: "space" }),
          button(S.rename, () => this.rename(variable, term)),
          button(S.remove, () => this.change("term", { variable: variable.name, term: term.name }))
        );
      }
      const onKind = document.activeElement?.closest(".details .kind");
      const typed = document.activeElement?.closest(".details input");
      this.rebuilding = true;
      this.details.replaceChildren(...parts);
      this.rebuilding = false;
      this.fill();
      if (onKind) this.details.querySelector(".kind")?.focus();
      if (typed) this.goOnTyping(typed);
    };
    /** A number that is being typed while the terms are drawn anew stays, with its cursor. */
    goOnTyping = (typed) => {
      const label = typed.getAttribute("aria-label");
      const field = this.fields.find((each) => each.field.getAttribute("aria-label") === label)?.field;
      if (!field) return;
      field.value = typed.value;
      field.focus();
      field.setSelectionRange(typed.selectionStart, typed.selectionEnd);
    };
    /** Choose the kind of the shape; the text keeps place and width as far as the kinds allow. */
    kindOf = (variable, term) => {
      const kinds = this.store.scene.kinds.includes(term.kind) ? this.store.scene.kinds : [term.kind, ...this.store.scene.kinds];
      const select = el(
        "select",
        {
          class: "kind",
          title: S.kindHint,
          "aria-label": S.kindOf(variable.name, term.name),
          onchange: async () => {
            const taken = await this.change("term", { variable: variable.name, term: term.name, kind: select.value });
            if (!taken) select.value = term.kind;
          }
        },
        ...kinds.map((kind) => el("option", { value: kind, textContent: kind }))
      );
      select.value = term.kind;
      return select;
    };
    fieldsOf = (variable, term, shape) => {
      const side = shape.side ? `${S.overShape} ` : "";
      const count = shape.kind === "points" ? shape.parameters.length : shape.names.length;
      const name = (i) => shape.names[i] ?? `${i % 2 ? "y" : "x"}${Math.floor(i / 2) + 1}`;
      const made = Array.from({ length: count + 1 }, (_, i) => {
        const label = i < count ? name(i) : S.height;
        const field = el("input", {
          type: "text",
          inputMode: "decimal",
          title: label,
          readOnly: !this.edit,
          "aria-label": `${variable.name} ${term.name}, ${side}${label}`,
          onblur: () => commit(),
          onkeydown: (event) => event.key === "Enter" && commit()
        });
        const commit = () => {
          if (!this.rebuilding && field.value !== field.dataset.shown)
            this.put(variable, term, shape, i < count ? i : null, field);
        };
        this.fields.push({ field, variable, shape, index: i < count ? i : null });
        return field;
      });
      return made;
    };
    /** Show the numbers of the chosen term as they are now. */
    fill = () => {
      for (const { field, variable, shape, index } of this.fields ?? []) {
        const now = this.store.now(variable, shape);
        const value = index === null ? now.height : now.parameters[index];
        const said2 = Number.isFinite(value) ? shortNumber(value, 8) : value > 0 ? "inf" : "-inf";
        if (document.activeElement !== field || field.value === field.dataset.shown) field.value = said2;
        field.dataset.shown = said2;
      }
    };
    put = (variable, term, shape, index, field) => {
      const text = field.value.trim().replace(/^([+-]?)inf$/, "$1Infinity");
      const value = text === "" ? NaN : Number(text);
      if (Number.isNaN(value) || index === null && !(value > 0 && value <= 1)) {
        field.setAttribute("aria-invalid", "true");
        return;
      }
      field.removeAttribute("aria-invalid");
      this.begin(variable);
      const now = this.store.now(variable, shape);
      const parameters = index === null ? now.parameters : now.parameters.with(index, value);
      this.store.reshape(variable, shape, parameters, index === null ? value : now.height);
      this.drag = null;
      this.finish(variable.name);
    };
    rename = async (variable, term) => {
      const name = await this.askFor(`${S.renameTo} ${term.name}`, term.name, S.rename);
      if (!name || name === term.name) return;
      const taken = await this.change("term", { variable: variable.name, term: term.name, name });
      if (taken) this.chosen = `${variable.name}
${name}`;
    };
    // --- moving ---
    /** Remember every shape of a variable as it is, to move from there. */
    begin = (variable) => {
      this.drag = { variable, from: /* @__PURE__ */ new Map() };
      for (const shape of variable.terms.flatMap(sidesOf)) this.drag.from.set(shape, this.store.now(variable, shape));
    };
    take = (event, variable, term, shape, index) => {
      if (!this.edit) return;
      event.preventDefault();
      event.currentTarget.focus({ preventScroll: true });
      const at = this.scale(variable);
      const plot = this.plots.get(variable.name);
      const place = (each) => {
        const box = plot.getBoundingClientRect();
        return { x: at.back(each.clientX - box.left), degree: at.degree(each.clientY - box.top) };
      };
      this.begin(variable);
      const start = place(event);
      const old = this.drag.from.get(shape);
      const where = index === null ? 0 : this.handleAt(shape, old.parameters, index);
      plot.setPointerCapture(event.pointerId);
      this.grip(variable);
      plot.onpointermove = (each) => {
        const here = place(each);
        const rise = this.isRaised(shape, index) ? here.degree - start.degree : 0;
        this.shift(variable, term, shape, index, where + here.x - start.x, rise, each);
      };
      plot.onpointerup = plot.onpointercancel = () => {
        plot.onpointermove = plot.onpointerup = plot.onpointercancel = null;
        this.drag = null;
        this.finish(variable.name);
      };
    };
    /** Whether a handle moves up and down as well: corners of points, and tops of lower functions. */
    isRaised = (shape, index) => {
      if (index === null || !shape.handles.includes(index)) return false;
      if (shape.kind === "points") return true;
      const tops = { triangle: [1], trapezoid: [1, 2], pi: [1, 2], rectangle: [0, 1] }[shape.kind];
      return Boolean(shape.side) && (tops ? tops.includes(index) : shape.handles.length === 1);
    };
    /** Ask for the numbers of a variable that can be changed in place. */
    grip = (variable) => {
      this.store.busy = true;
      this.moving = variable.name;
      if (this.store.held?.variable === variable.name) return;
      this.numbers(variable.name).then((brought) => {
        if (brought) this.store.hold(variable, brought);
      });
    };
    step = (event, variable, term, shape, index) => {
      const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!sign || !this.edit) return;
      event.preventDefault();
      this.grip(variable);
      this.begin(variable);
      const steps = sign * (event.ctrlKey ? 10 : 1);
      const rises = this.isRaised(shape, index) && /Up|Down/.test(event.key);
      const old = this.drag.from.get(shape).parameters;
      const where = index === null ? 0 : this.handleAt(shape, old, index);
      const by = rises ? 0 : steps * this.unit(variable);
      this.shift(variable, term, shape, index, where + by, rises ? 0.05 * steps : 0, event);
      this.drag = null;
      clearTimeout(this.waiting);
      this.waiting = setTimeout(() => this.finish(variable.name), 350);
    };
    /** A round number, about a two-hundredth of the range. */
    unit = (variable) => {
      const [low, high] = rangeOf(variable);
      const power = 10 ** Math.floor(Math.log10((high - low) / 100));
      return power * ((high - low) / power > 400 ? 5 : (high - low) / power > 200 ? 2 : 1);
    };
    rounded = (value, variable) => {
      const step = this.snap.checked ? this.unit(variable) : this.unit(variable) / 100;
      return Number((Math.round(value / step) * step).toPrecision(12));
    };
    /** Move a handle to, or a whole term by, a number; neighbours and the mirror image as asked. */
    shift = (variable, term, shape, index, value, rise, event) => {
      const changed = /* @__PURE__ */ new Map();
      if (index === null) {
        const by = this.rounded(value, variable);
        for (const side of sidesOf(term)) {
          const old = this.drag.from.get(side);
          changed.set(side, { ...this.plain(old), parameters: moved(side, old.parameters, null, 0, by) });
        }
      } else changed.set(shape, this.one(variable, shape, index, value, rise));
      if (this.partition.checked || event.altKey) {
        for (const [side, next] of [...changed]) this.neighbours(variable, side, next.parameters, changed);
      }
      if (this.mirror.checked || event.shiftKey) this.mirrored(variable, changed);
      for (const each of variable.terms) this.keepBelow(variable, each, changed);
      for (const [each, next] of changed) this.store.reshape(variable, each, next.parameters, next.height);
    };
    /** Parameters and height of a shape after one of its handles has moved. */
    one = (variable, shape, index, value, rise) => {
      const old = this.drag.from.get(shape);
      const tidy = (x, step) => this.snap.checked ? Number((Math.round(x / step) * step).toPrecision(12)) : Number(x.toPrecision(6));
      if (!shape.handles.includes(index)) {
        const width = WIDTHS[shape.kind][index].to(old.parameters, this.rounded(value, variable));
        const sound = Number.isFinite(width) && Math.abs(width) > 1e-9;
        const said2 = Number(width.toPrecision(this.snap.checked ? 3 : 6));
        return { ...this.plain(old), parameters: sound ? old.parameters.with(index, said2) : old.parameters };
      }
      const parameters = moved(shape, old.parameters, index, this.rounded(value, variable));
      if (!rise) return { parameters, height: old.height };
      if (shape.kind === "points") {
        const y = tidy(old.parameters[index + 1] + rise / old.height, 0.05);
        parameters[index + 1] = Math.min(1, Math.max(0, y));
        return { parameters, height: old.height };
      }
      const height = Math.min(1, Math.max(LEAST_HEIGHT, tidy(old.height + rise, 0.05)));
      return { parameters, height };
    };
    neighbours = (variable, shape, next, changed) => {
      const old = this.drag.from.get(shape).parameters;
      for (const other of variable.terms.flatMap(sidesOf)) {
        if (changed.has(other) || (other.side ?? 0) !== (shape.side ?? 0) || other.kind === "points") continue;
        const from = this.drag.from.get(other);
        const to = from.parameters.map((x, i) => {
          const shared = other.handles.includes(i) ? shape.handles.findIndex((k) => old[k] === x) : -1;
          return shared < 0 ? x : next[shape.handles[shared]];
        });
        const sorted = other.handles.every((i, k) => !k || to[other.handles[k - 1]] <= to[i]);
        if (sorted && to.some((x, i) => x !== from.parameters[i]))
          changed.set(other, { ...this.plain(from), parameters: to });
      }
    };
    mirrored = (variable, changed) => {
      const [low, high] = rangeOf(variable);
      for (const [shape, next] of [...changed]) {
        const place = variable.terms.findIndex((term2) => sidesOf(term2).includes(shape));
        const term = variable.terms[variable.terms.length - 1 - place];
        const other = sidesOf(term)[shape.side ?? 0];
        if (!other || other === shape || other.kind !== (TURNED[shape.kind] ?? shape.kind)) continue;
        const parameters = mirrorOf(shape.kind, next.parameters, low + high);
        if (parameters) changed.set(other, { parameters, height: next.height });
      }
    };
    /** Stop where the lower function of a term would rise above the upper one. */
    keepBelow = (variable, term, changed) => {
      if (!term.lower || !term.curve) return;
      const sides = sidesOf(term);
      if (!sides.some((side) => changed.has(side))) return;
      const from = sides.map((side) => this.drag.from.get(side));
      const to = sides.map((side, i) => changed.get(side) ?? from[i]);
      if (this.isBelow(variable, sides, to)) return;
      const between = (share) => from.map((start, i) => ({
        parameters: start.parameters.map((x, k) => Number.isFinite(x) ? x + share * (to[i].parameters[k] - x) : x),
        height: start.height + share * (to[i].height - start.height)
      }));
      let [reach, beyond] = [0, 1];
      for (let i = 0; i < 12; i++) {
        const middle = 0.5 * (reach + beyond);
        if (this.isBelow(variable, sides, between(middle))) reach = middle;
        else beyond = middle;
      }
      const kept2 = between(reach);
      const short = kept2.map(({ parameters, height }) => ({
        parameters: parameters.map((x) => Number(x.toPrecision(4))),
        height: Number(height.toPrecision(3))
      }));
      const best = this.isBelow(variable, sides, short) ? short : kept2;
      sides.forEach((side, i) => {
        if (changed.has(side)) changed.set(side, best[i]);
      });
    };
    isBelow = (variable, sides, numbers) => {
      const [[upper, lower], [high, low]] = [sides, numbers];
      const [start, end] = rangeOf(variable);
      const corners = [cornersOf(upper, high.parameters), cornersOf(lower, low.parameters)];
      const bends = corners.flatMap((found) => (found ?? []).filter((_, i) => i % 2 === 0));
      const even = Array.from({ length: SMOOTH }, (_, i) => start + (end - start) * i / (SMOOTH - 1));
      const xs = Float64Array.from([...even, ...bends.filter((x) => x >= start && x <= end)]);
      const above = this.store.degrees(variable, upper, xs, high);
      return this.store.degrees(variable, lower, xs, low).every((y, i) => y <= above[i] + 1e-12);
    };
    finish = (name) => {
      const variable = this.each().find((other) => other.name === name);
      this.store.busy = false;
      const isSame = (shape) => {
        const now = this.store.now(variable, shape);
        return now.height === shape.height && now.parameters.every((x, i) => x === shape.parameters[i]);
      };
      const said2 = (shape) => {
        const { parameters, height } = this.store.now(variable, shape);
        return { kind: shape.kind, parameters: parameters.map(sendable), height };
      };
      const shapes = variable.terms.flatMap(
        (term) => sidesOf(term).every(isSame) ? [] : [{ variable: variable.name, term: term.name, ...said2(term), lower: term.lower ? said2(term.lower) : null }]
      );
      if (!shapes.length) return;
      Promise.resolve(this.edit(shapes)).then((taken) => {
        if (taken === false) this.store.forget();
      });
    };
  };

  // help.js
  function showHelp(views) {
    if (document.querySelector("dialog[open]")) return;
    const close = el("button", { value: "", textContent: S.close, type: "submit" });
    const keys = (rows) => el(
      "table",
      { class: "keys" },
      el(
        "tbody",
        {},
        ...rows.map(
          ([key2, words]) => el(
            "tr",
            {},
            el(
              "th",
              { scope: "row" },
              ...key2.split(" ").flatMap((each, i) => [
                ...i ? [" "] : [],
                /^[a-z]+$/.test(each) ? each : el("kbd", { textContent: each })
              ])
            ),
            el("td", { textContent: words })
          )
        )
      )
    );
    const parts = S.help.filter(({ view }) => !view || views.includes(view)).map(
      ({ title: title2, words, rows }) => el(
        "section",
        {},
        el("h3", { textContent: title2 }),
        ...words.map((line) => el("p", { textContent: line })),
        ...rows.length ? [keys(rows)] : []
      )
    );
    const body = el("div", { class: "parts", tabIndex: 0, role: "group", "aria-label": S.helpTitle }, ...parts);
    const dialog = el(
      "dialog",
      { class: "help", "aria-label": S.helpTitle },
      el(
        "form",
        { method: "dialog" },
        el("div", { class: "row" }, el("strong", { textContent: S.helpTitle }), el("span", { class: "space" }), close),
        body
      )
    );
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
    body.focus();
  }
  var isTyped = (target) => Boolean(target.closest?.(".cm-editor, textarea, select, input:not([type='range'], [type='checkbox'])"));
  function helpButton(views, gone) {
    const button = el("button", {
      class: "help",
      textContent: "?",
      title: S.helpHint,
      "aria-label": S.helpTitle,
      onclick: () => showHelp(views)
    });
    window.addEventListener(
      "keydown",
      (event) => {
        if (!button.isConnected || event.ctrlKey || event.metaKey || event.altKey) return;
        if (event.key !== "F1" && (event.key !== "?" || isTyped(event.target))) return;
        event.preventDefault();
        showHelp(views);
      },
      { signal: gone }
    );
    return button;
  }

  // gridtools.js
  var pairs = (names) => names.map((name) => [name, name]);
  var named = (variables) => variables.filter((each) => each.terms.length).map((each) => each.name);
  var canConclude = ({ inputs, outputs }) => named(inputs).length > 0 && named(outputs).length > 0;
  function addGrid({ fill, attempt }, { inputs, outputs }) {
    const across = named(inputs);
    return fill(
      S.newGrid,
      [
        { name: "output", label: S.concludes, options: pairs(named(outputs)) },
        {
          name: "row",
          label: S.vertical,
          options: [["", S.oneRow], ...pairs(across)],
          value: across.length > 1 ? across[0] : ""
        },
        { name: "column", label: S.horizontal, options: pairs(across), value: across[1] ?? across[0] },
        { name: "fill", label: S.cells, options: S.fills }
      ],
      S.add,
      (values) => attempt("grid", values)
    );
  }
  function headDialog({ choose, attempt, change, fill }, scene, head) {
    const words = head.row ? [S.removeRow(head.term), S.addRow] : [S.removeColumn(head.term), S.addColumn];
    return choose(head.row ? S.rowOf(head.variable, head.term) : S.columnOf(head.variable, head.term), words).then(
      (chosen) => {
        if (chosen === 0) return change("head", { ...head, remove: true });
        return chosen === 1 ? addHead({ attempt, fill }, scene, head) : null;
      }
    );
  }
  function addHead({ fill, attempt }, { inputs }, { line, row, variable: name, present }) {
    const variable = inputs.find((each) => each.name === name);
    const [low, high] = rangeOf(variable);
    const absent = variable.terms.map((each) => each.name).filter((each) => !present.includes(each));
    const isNew = absent.length ? { when: { chosen: "" } } : {};
    return fill(
      row ? S.addRowOf(name) : S.addColumnOf(name),
      [
        ...absent.length ? [{ name: "chosen", label: S.term, options: [...pairs(absent), ["", S.newTerm]] }] : [],
        { name: "name", label: S.newTermName, value: "", ...isNew },
        { name: "peak", label: S.peak, value: shortNumber(0.5 * (low + high)), ...isNew }
      ],
      S.add,
      ({ chosen = "", name: given2, peak }) => {
        if (chosen) return attempt("head", { line, row, term: chosen });
        const at = Number((peak ?? "").trim() || NaN);
        if (!Number.isFinite(at)) return { error: S.notANumber };
        return attempt("head", { line, row, term: given2.trim(), shape: newShape(variable, at) });
      }
    );
  }
  function composer(attempt, { inputs, outputs }) {
    const choices = (variable, none) => el(
      "select",
      { "aria-label": variable.name, "data-variable": variable.name },
      ...none ? [el("option", { value: "", textContent: "\u2026" })] : [],
      ...variable.terms.map(({ name }) => el("option", { value: name, textContent: name }))
    );
    const asked = inputs.filter((each) => each.terms.length).map((each) => choices(each, true));
    const concluded = outputs.filter((each) => each.terms.length).map((each) => choices(each, outputs.length > 1));
    const join = el(
      "select",
      { "aria-label": S.join },
      ...["and", "or"].map((word) => el("option", { value: word, textContent: word }))
    );
    const wrong = el("span", { class: "wrong", role: "alert" });
    const part = (select) => el("label", {}, `${select.dataset.variable} is`, select);
    const values = (selects) => selects.filter((each) => each.value).map((each) => [each.dataset.variable, each.value]);
    const between = asked.flatMap(
      (each, i) => i === 0 ? [part(each)] : i === 1 ? [join, part(each)] : [el("span", { class: "again", textContent: join.value }), part(each)]
    );
    const form = el(
      "form",
      {
        class: "composer",
        "aria-label": S.compose,
        onsubmit: async (event) => {
          event.preventDefault();
          const answer = await attempt("compose", { if: values(asked), then: values(concluded), join: join.value });
          wrong.textContent = answer.error ?? "";
          if (!answer.error) for (const each of asked) each.value = "";
        }
      },
      el("span", { textContent: S.ifWord }),
      ...between,
      el("span", { textContent: S.thenWord }),
      ...concluded.map(part),
      el("button", { class: "small", type: "submit", textContent: S.add }),
      wrong
    );
    join.addEventListener("change", () => {
      for (const each of form.querySelectorAll(".again")) each.textContent = join.value;
    });
    return form;
  }

  // methods.js
  function methodLines(change) {
    const summary = el("summary");
    const body = el("div", { class: "fields" });
    const element = el("details", { class: "methods" }, summary, body);
    function list(row) {
      const label = row.target ? `${row.target}: ${row.key}` : row.key;
      const select = el(
        "select",
        {
          "aria-label": label,
          "data-key": `method ${label}`,
          disabled: !change,
          onchange: async () => {
            const taken = await change("setting", { key: row.key, value: select.value, target: row.target });
            if (!taken) select.value = row.value;
          }
        },
        ...row.options.map((value) => el("option", { value, textContent: value, selected: value === row.value }))
      );
      return el("label", { class: "field" }, el("span", { textContent: label }), select);
    }
    return {
      element,
      show(rows) {
        const lists = rows.filter((row) => row.key);
        const refocus = keepFocus(body);
        summary.textContent = clean(
          `${S.methods}: ${lists.map(({ key: key2, value, target }) => `${target ? `${target} ` : ""}${key2} ${value}`).join(", ")}`
        );
        body.replaceChildren(
          ...lists.map(list),
          ...rows.filter((row) => row.block).map(({ block }) => el("span", { class: "small", textContent: block }))
        );
        refocus();
      }
    };
  }

  // rules.js
  var MOST_CELLS = 700;
  var MOST_SENTENCES = 400;
  function rulesPane(store, hand) {
    return new RulesPane(store, hand).section;
  }
  var RulesPane = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store, hand) {
      this.store = store;
      this.hand = hand;
      this.setCell = this.hand.setCell;
      this.goTo = this.hand.goTo;
      this.change = this.hand.change;
      this.attempt = this.hand.attempt;
      const { section, bar: bar2, body } = pane("rules", S.rules);
      this.section = section;
      this.body = body;
      this.methods = methodLines(this.change);
      this.grid = el("button", {
        textContent: S.gridDots,
        title: S.gridHint,
        onclick: () => addGrid(this.hand, this.store.scene)
      });
      if (this.attempt) bar2.append(el("span", { class: "space" }), this.grid);
      this.lit = [];
      this.shown = [];
      this.fresh = { rule: null, text: "" };
      this.drafts = /* @__PURE__ */ new Set();
      this.composed = { names: "", form: null };
      const relight = eachFrame(this.light);
      this.store.on("scene", this.build);
      this.store.on("point", relight);
      this.store.on("told", relight);
      this.store.on("reshaped", relight);
    }
    // --- findings ---
    before = (one, other) => one[0] < other[0] || one[0] === other[0] && one[1] < other[1];
    words = (finding) => `${S.severity[finding.severity] ?? finding.severity}: ${finding.message}`;
    /** A sign with the findings as its name. */
    sign = (found) => el("span", {
      class: `sign ${found[0].severity}`,
      role: "img",
      textContent: "\u25B2",
      title: found.map(this.words).join("\n"),
      "aria-label": found.map(this.words).join("; ")
    });
    present = (grid, row) => row ? grid.rows.map((each) => each.label) : grid.columns;
    said = (cell) => cell.term === null ? "\xB7" : cell.weight ? `${cell.term} \xD7${cell.weight}` : cell.term;
    build = () => {
      const { grids, rules, outputs } = this.store.scene;
      const isReady = canConclude(this.store.scene);
      this.grid.disabled = !isReady;
      this.methods.show(this.store.scene.methods);
      const refocus = keepFocus(this.section);
      this.findAgain(rules);
      this.lit = [];
      this.shown = [];
      const seen = this.body.scrollTop;
      this.body.replaceChildren(...outputs.length ? [this.methods.element] : []);
      const cells2 = grids.reduce((sum, grid) => sum + grid.rows.length * grid.columns.length, 0);
      grids.forEach((grid, k) => this.body.append(this.table(grid, outputs, this.setCell && cells2 <= MOST_CELLS, k)));
      const sentences = rules.map((rule, number) => (
        /** @type {const} */
        [rule, number]
      )).filter(([rule]) => !rule.inGrid);
      if (sentences.length) {
        const list = el("ol");
        for (const [rule, number] of sentences.slice(0, MOST_SENTENCES)) list.append(this.item(rule, number));
        this.body.append(list);
      }
      if (!rules.length)
        this.body.append(
          el("p", {
            class: "note",
            textContent: grids.length || !this.store.scene.missing.includes("no-rules") ? S.tooManyRules : S.noRulesYet
          })
        );
      if (this.attempt && isReady) this.body.append(this.composing());
      if (this.change && isReady) this.body.append(this.writer(this.fresh, S.newRule));
      this.body.scrollTop = seen;
      refocus();
      this.light();
    };
    /**
     * Find the rules again that are being changed, in a text that may have other lines now: one that says what it
     * said, the nearest; else the one in its place, where there are as many. What has no rule any more may be a new one.
     */
    findAgain = (rules) => {
      for (const draft of this.drafts) {
        const same = rules.flatMap((rule2, number) => rule2.written === draft.written ? [number] : []);
        same.sort((a, b) => Math.abs(a - draft.rule) - Math.abs(b - draft.rule));
        const inPlace = rules.length === draft.of && rules[draft.rule]?.written ? draft.rule : null;
        const rule = same[0] ?? inPlace;
        if (rule === null) {
          this.fresh.text ||= draft.text;
          this.drafts.delete(draft);
        } else Object.assign(draft, { rule, of: rules.length });
      }
    };
    /** The lists of a new rule: what has been chosen stays while the variables do. */
    composing = () => {
      const { inputs, outputs } = this.store.scene;
      const names = JSON.stringify(
        [inputs, outputs].map((each) => each.map(({ name, terms }) => [name, terms.map((term) => term.name)]))
      );
      if (names !== this.composed.names) this.composed = { names, form: composer(this.attempt, this.store.scene) };
      return this.composed.form;
    };
    /** Findings that lie within a stretch of the text, or cover it in its own line. */
    findingsOf = ([start, end]) => {
      return this.store.findings.filter(
        ({ range: [from, to] }) => from[0] === start[0] && !this.before(to, start) && (from[0] !== end[0] || this.before(from, end))
      );
    };
    /** Mark an element with its findings, for the eye, the pointer and the screen reader. */
    mark = (element, named2, found) => {
      if (!found.length) return;
      const said2 = found.map(this.words).join("; ");
      element.classList.add("found", found[0].severity);
      named2.title = said2;
      named2.setAttribute("aria-label", `${named2.getAttribute("aria-label") ?? named2.textContent}. ${said2}`);
    };
    // --- sentences ---
    item = (rule, number) => {
      const said2 = this.goTo ? el("button", { class: "said", textContent: rule.text, onclick: () => this.goTo(rule.at) }) : rule.text;
      const li = el("li", {}, el("span", { class: "place", textContent: rule.place }), said2);
      const found = this.findingsOf(rule.range);
      if (found.length) {
        li.classList.add("found", found[0].severity);
        li.append(this.sign(found));
      }
      const draft = [...this.drafts].find((each) => each.rule === number);
      if (draft) li.replaceChildren(this.writer(draft, S.ruleAt(rule.place)));
      else if (this.change && rule.written) {
        const edit = () => {
          const line = { rule: number, of: this.store.scene.rules.length, written: rule.written, text: rule.written };
          this.drafts.add(line);
          this.build();
          this.body.querySelector(`[data-key="write ${number}"]`).focus();
        };
        li.append(
          el("button", {
            class: "small",
            textContent: S.change,
            "aria-label": `${S.change} ${S.ruleAt(rule.place)}`,
            "data-key": `edit ${number}`,
            onclick: edit
          }),
          el("button", {
            class: "small",
            textContent: "\xD7",
            title: S.remove,
            "aria-label": `${S.remove} ${S.ruleAt(rule.place)}`,
            "data-key": `remove ${number}`,
            onclick: () => this.change("rule", { line: rule.line, sentence: "" })
          })
        );
      }
      this.lit[number] = li;
      return li;
    };
    /** A line to write a rule in; one that is changed may be left with Escape. */
    writer = (draft, label) => {
      const isNew = draft === this.fresh;
      const key2 = `write ${isNew ? "new" : draft.rule}`;
      const field = el("input", {
        type: "text",
        class: "write",
        value: draft.text,
        "aria-label": label,
        placeholder: S.ifThen,
        "data-key": key2,
        spellcheck: false
      });
      const leave = () => {
        this.drafts.delete(draft);
        const isHeld = this.body.querySelector(`[data-key="${key2}"]`)?.closest("form").contains(document.activeElement);
        this.build();
        if (isHeld) this.body.querySelector(`[data-key="edit ${draft.rule}"]`)?.focus();
      };
      const send = async (event) => {
        event.preventDefault();
        const sentence = draft.text;
        if (!sentence.trim()) return;
        const line = isNew ? null : this.store.scene.rules[draft.rule].line;
        const taken = await this.change("rule", { line, sentence });
        if (!taken) field.setAttribute("aria-invalid", "true");
        else if (!isNew) leave();
        else if (this.fresh.text === sentence) {
          this.fresh.text = field.value = "";
          if (!field.isConnected) this.build();
        }
      };
      field.addEventListener("input", () => {
        draft.text = field.value;
        field.removeAttribute("aria-invalid");
      });
      field.addEventListener("keydown", (event) => {
        if (event.key === "Escape" && !isNew) leave();
      });
      return el(
        "form",
        { class: "sentence", onsubmit: send },
        field,
        el("button", { class: "small", type: "submit", textContent: isNew ? S.add : S.ok, "data-key": `done ${key2}` })
      );
    };
    // --- grids ---
    table = (grid, outputs, editable, k) => {
      const output = outputs.find((each) => each.name === grid.output);
      const when = grid.condition ? ` when ${grid.condition}` : "";
      const corner = grid.row ? `${grid.row} \\ ${grid.column}` : grid.column;
      const head = el("tr", {}, el("th", { scope: "col", textContent: corner }));
      for (const name of grid.columns) head.append(el("th", { scope: "col" }, this.label(grid, name, false, k)));
      const caption = el("caption", {}, el("span", { textContent: `${grid.output}${when}` }), ...this.tools(grid, k));
      const found = this.findingsOf(grid.range);
      if (found.length) caption.append(" ", this.sign(found));
      const made = el("table", {}, caption, el("thead", {}, head));
      const rows = el("tbody");
      for (const row of grid.rows) {
        const line = el(
          "tr",
          {},
          el("th", { scope: "row" }, grid.row ? this.label(grid, row.label, true, k) : row.label)
        );
        row.cells.forEach((cell, i) => {
          const label = S.ruleOf(row.label, grid.columns[i]);
          const change = editable && !(grid.joined && cell.term === null);
          const content = change ? this.picker(cell, output, label, grid.joined) : this.plain(cell);
          content.dataset.key = `cell ${k} ${row.label}, ${grid.columns[i]}`;
          this.paint(content, cell.term, output);
          const td = el("td", {}, content);
          this.mark(td, content, this.findingsOf(cell.range));
          if (cell.rule !== null) this.lit[cell.rule] = td;
          line.append(td);
        });
        rows.append(line);
      }
      made.append(rows);
      return made;
    };
    /** What names a row or a column, and leads to what is done with it. */
    label = (grid, term, row, k) => {
      if (!this.attempt) return el("span", { textContent: term, title: term });
      const variable = row ? grid.row : grid.column;
      return el("button", {
        textContent: term,
        "data-key": `head ${k} ${row} ${term}`,
        title: row ? S.rowOf(variable, term) : S.columnOf(variable, term),
        onclick: () => headDialog(this.hand, this.store.scene, {
          line: grid.line,
          row,
          variable,
          term,
          present: this.present(grid, row)
        })
      });
    };
    /** Buttons of a grid: another row or column, and its removal. */
    tools = (grid, k) => {
      if (!this.attempt) return [];
      const adding = (words, title2, row) => el("button", {
        class: "small",
        textContent: words,
        title: title2,
        "data-key": `add ${k} ${row}`,
        onclick: () => addHead(this.hand, this.store.scene, {
          line: grid.line,
          row,
          variable: row ? grid.row : grid.column,
          present: this.present(grid, row)
        })
      });
      return [
        ...grid.row ? [adding(S.rowDots, S.addRowOf(grid.row), true)] : [],
        adding(S.columnDots, S.addColumnOf(grid.column), false),
        el("button", {
          class: "small",
          textContent: "\xD7",
          title: S.removeGrid(grid.output),
          "aria-label": S.removeGrid(grid.output),
          onclick: () => this.change("grid", { line: grid.line })
        })
      ];
    };
    plain = (cell) => {
      return el("span", { textContent: this.said(cell), title: cell.term ?? S.noRule });
    };
    picker = (cell, output, label, joined) => {
      const select = el("select", { "aria-label": label, title: label });
      const names = output.terms.map((term) => term.name);
      for (const name of names) {
        const text = name === cell.term ? this.said(cell) : name;
        select.append(el("option", { value: name, textContent: text, selected: name === cell.term }));
      }
      if (!joined) select.append(el("option", { value: "", textContent: "\xB7", selected: cell.term === null }));
      select.addEventListener("change", () => {
        const chosen = select.selectedIndex < names.length ? names[select.selectedIndex] : null;
        this.paint(select, chosen, output);
        this.setCell(cell.at, chosen);
      });
      return select;
    };
    paint = (element, name, output) => {
      const term = output.terms.find((each) => each.name === name);
      const [low, high] = rangeOf(output);
      const value = term && (term.centre ?? term.parameters[term.parameters.length - 1]);
      if (value === void 0 || value === null) {
        element.style.background = element.style.color = "";
        return;
      }
      [element.style.background, element.style.color] = heat((value - low) / (high - low));
    };
    light = () => {
      const found = this.store.fired();
      this.lit.forEach((element, number) => {
        const strength = found?.strengths[number] ?? 0;
        if (this.shown[number] === strength) return;
        this.shown[number] = strength;
        element.classList.toggle("lit", strength > 0);
        const lower = found?.lower[number] ?? strength;
        const range = lower === strength ? shortNumber(strength, 3) : S.between(shortNumber(lower, 3), shortNumber(strength, 3));
        const said2 = strength > 0 ? `${S.strength} ${range}` : S.silent;
        element.title = S.fires(this.store.scene.rules[number].place, said2);
      });
    };
  };

  // split.js
  var LEAST_SHARE = 0.08;
  var STEPS = { ArrowLeft: -0.02, ArrowUp: -0.02, ArrowRight: 0.02, ArrowDown: 0.02, PageUp: -0.1, PageDown: 0.1 };
  var bounded = (share) => Math.min(1 - LEAST_SHARE, Math.max(LEAST_SHARE, share));
  var shareAt = (position, start, first, handle, second) => bounded((position - start - handle / 2) / Math.max(1, first + second));
  function shareBy(key2, share, usual, vertical) {
    if (key2 === "Home") return LEAST_SHARE;
    if (key2 === "End") return 1 - LEAST_SHARE;
    if (key2 === "Enter") return usual;
    const isAcross = /Left|Right/.test(key2);
    const step = /^Arrow/.test(key2) && isAcross !== vertical ? void 0 : STEPS[key2];
    return step === void 0 ? null : bounded(share + step);
  }
  var sizesOf = (tracks) => tracks.split(" ").map(parseFloat).filter(Number.isFinite);
  var kept = {
    read: (key2) => {
      try {
        return Number(localStorage.getItem(`fuzzyarm.split.${key2}`)) || null;
      } catch {
        return null;
      }
    },
    write: (key2, share) => {
      try {
        if (share === null) localStorage.removeItem(`fuzzyarm.split.${key2}`);
        else localStorage.setItem(`fuzzyarm.split.${key2}`, share.toFixed(4));
      } catch {
      }
    }
  };
  function splitter({ key: key2, vertical, at, usual }) {
    const root2 = document.documentElement;
    const now = () => parseFloat(root2.style.getPropertyValue(`--${key2}-a`)) || null;
    let share = now() ?? kept.read(key2) ?? usual;
    const handle = el("div", {
      class: `split ${vertical ? "columns" : "rows"}`,
      role: "separator",
      tabIndex: 0,
      title: S.split,
      "aria-label": S.splitOf(vertical),
      "aria-orientation": vertical ? "vertical" : "horizontal",
      "aria-valuemin": Math.round(100 * LEAST_SHARE),
      "aria-valuemax": Math.round(100 - 100 * LEAST_SHARE)
    });
    function put(next, isDone = true) {
      share = next;
      root2.style.setProperty(`--${key2}-a`, `${share}fr`);
      root2.style.setProperty(`--${key2}-b`, `${1 - share}fr`);
      tell();
      if (isDone) kept.write(key2, share === usual ? null : share);
    }
    const tell = () => handle.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    function tracks() {
      const grid = handle.parentElement;
      const style = getComputedStyle(grid);
      const sizes = sizesOf(vertical ? style.gridTemplateColumns : style.gridTemplateRows);
      const gap = parseFloat(vertical ? style.columnGap : style.rowGap) || 0;
      const box = grid.getBoundingClientRect();
      const pad = parseFloat(vertical ? style.paddingLeft : style.paddingTop) || 0;
      const start = (vertical ? box.left : box.top) + pad + sizes.slice(0, at - 1).reduce((sum, size) => sum + size + gap, 0);
      return [start, sizes[at - 1], sizes[at], sizes[at + 1]];
    }
    handle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      const [start, ...sizes] = tracks();
      handle.onpointermove = (move) => put(shareAt(vertical ? move.clientX : move.clientY, start, ...sizes), false);
      handle.onpointerup = handle.onpointercancel = () => {
        handle.onpointermove = handle.onpointerup = handle.onpointercancel = null;
        put(share);
      };
    });
    handle.addEventListener("dblclick", () => put(usual));
    handle.addEventListener("keydown", (event) => {
      const next = shareBy(event.key, now(), usual, vertical);
      if (next === null || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      put(next);
    });
    handle.addEventListener("focus", () => put(now(), false));
    put(share, false);
    return handle;
  }

  // geometry/surface.js
  function fillTriangle(pixels, width, height, x0, y0, x1, y1, x2, y2, colour) {
    if (y1 < y0) [x0, y0, x1, y1] = [x1, y1, x0, y0];
    if (y2 < y0) [x0, y0, x2, y2] = [x2, y2, x0, y0];
    if (y2 < y1) [x1, y1, x2, y2] = [x2, y2, x1, y1];
    const end = Math.min(height, Math.ceil(y2 - 0.5));
    for (let row = Math.max(0, Math.ceil(y0 - 0.5)); row < end; row++) {
      const y = row + 0.5;
      const a = x0 + (x2 - x0) * (y - y0) / (y2 - y0);
      const b = y < y1 ? x0 + (x1 - x0) * (y - y0) / (y1 - y0) : x1 + (x2 - x1) * (y - y1) / (y2 - y1);
      const from = row * width + Math.max(0, Math.ceil((a < b ? a : b) - 0.5));
      const to = row * width + Math.min(width, Math.ceil((a < b ? b : a) - 0.5));
      for (let at = from; at < to; at++) pixels[at] = colour;
    }
  }
  function limitsOf(z, output) {
    let [low, high] = [output.low, output.high];
    if (low === null || high === null) {
      [low, high] = [Infinity, -Infinity];
      for (const value of z) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    return low < high ? [low, high] : [low - 1, low + 1];
  }
  var axisOf = (words, [low, high]) => ({ words, low, high, logarithmic: false, whole: false });
  var numbersOf = (values) => Array.from(values, (value) => Number.isFinite(value) ? value : null);
  function linePanel({ xs, z }, input, output) {
    const parts = [
      { is: "line", x: Array.from(xs), y: numbersOf(z), tone: "accent", width: 1.6, dash: "-" },
      { is: "level", at: input.at, upright: true, tone: "soft", width: 0.6, dash: "--" },
      { is: "dots", x: [input.at], y: numbersOf([output.at]), sign: "o", size: 7, tone: "lit" }
    ];
    return { title: "", across: axisOf(input.name, input.range), up: axisOf(output.name, output.range), parts };
  }
  function planePanel({ xs, ys, z }, inputs, output) {
    const [across, up] = inputs.map(({ name, range }) => axisOf(name, range));
    const value = axisOf(output.name, output.range);
    const rulings = inputs.map(({ at, isCut }, k) => ({
      is: "level",
      at,
      upright: k === 0,
      tone: isCut ? "lit" : "#ffffff",
      width: isCut ? 1.6 : 0.7,
      dash: isCut ? "-" : "--"
    }));
    const parts = [
      { is: "cells", x: Array.from(xs), y: Array.from(ys), values: numbersOf(z), value, signed: false },
      ...rulings,
      { is: "dots", x: [inputs[0].at], y: [inputs[1].at], sign: "+", size: 6, tone: "mark" }
    ];
    return { title: "", across, up, parts };
  }
  function projectionOf(turned, width, height) {
    const [ca, sa] = [Math.cos(turned.azimuth), Math.sin(turned.azimuth)];
    const [ce, se] = [Math.cos(turned.elevation), Math.sin(turned.elevation)];
    const reach = Math.min(width * 0.58, height * 0.68);
    return {
      reach,
      /** @returns {Page.Pair} */
      project(u, v, w) {
        const [right, depth] = [u * ca - v * sa, u * sa + v * ca];
        return [width / 2 + reach * right, height * 0.5 - reach * (0.62 * w * ce + depth * se)];
      },
      /** Whether the far end of each axis is the one with the large numbers. */
      farIsHigh: { u: sa > 0, v: ca > 0 }
    };
  }
  var farToNear = (count, farIsHigh) => Array.from({ length: count }, (_, i) => farIsHigh ? count - 1 - i : i);
  function crossings(z, n, level, rows = n) {
    const segments = [];
    for (let j = 0; j + 1 < rows; j++) {
      for (let i = 0; i + 1 < n; i++) {
        const k = j * n + i;
        const [a, b, c, d] = [z[k] - level, z[k + 1] - level, z[k + n + 1] - level, z[k + n] - level];
        const found = [];
        if (a < 0 !== b < 0) found.push([i + a / (a - b), j]);
        if (b < 0 !== c < 0) found.push([i + 1, j + b / (b - c)]);
        if (d < 0 !== c < 0) found.push([i + d / (d - c), j + 1]);
        if (a < 0 !== d < 0) found.push([i, j + a / (a - d)]);
        for (let m = 0; m + 1 < found.length; m += 2) segments.push([found[m], found[m + 1]]);
      }
    }
    return segments;
  }
  function spotsOf(spots, { left, top, right, bottom }, taken) {
    const found = [];
    for (let i = 0; i < spots.length && found.length < 2; i++) {
      const spot = spots[Math.floor(i * 0.618034 % 1 * spots.length)];
      const [x, y] = spot;
      const isInside = x > left + 16 && x < right - 16 && y > top + 10 && y < bottom - 10;
      if (isInside && ![...taken, ...found].some(([u, v]) => Math.hypot(u - x, v - y) < 42)) found.push(spot);
    }
    return found;
  }

  // geometry/panel.js
  function scaleOf({ low, high, logarithmic = false }, from, to) {
    const measure = logarithmic ? Math.log10 : (value) => value;
    const [a, b] = [measure(low), measure(high)];
    return (value) => from + (to - from) * (measure(value) - a) / (b - a);
  }
  function valueAt({ low, high, logarithmic = false }, from, to) {
    return (pixel) => {
      const share = Math.min(1, Math.max(0, (pixel - from) / (to - from)));
      return logarithmic ? low * (high / low) ** share : low + share * (high - low);
    };
  }
  function ticksOf({ low, high, logarithmic = false, whole = false }, wanted) {
    const found = logarithmic ? decades(low, high) : ticks(low, high, wanted);
    return found.filter(
      (value) => (!whole || Number.isInteger(value)) && value >= low * (1 - 1e-9 * Math.sign(low)) && value <= high * (1 + 1e-9 * Math.sign(high))
    );
  }
  function edgesOf(places, count) {
    if (places.length === count + 1) return places;
    if (count === 1) return [places[0] - 0.5, places[0] + 0.5];
    const middles = places.slice(1).map((place, i) => (places[i] + place) / 2);
    return [2 * places[0] - middles[0], ...middles, 2 * places[count - 1] - middles[count - 2]];
  }
  function strokesOf(x, y, steps = false) {
    const strokes = [];
    let stroke = null;
    for (let i = 0; i < x.length; i++) {
      if (x[i] === null || y[i] === null) {
        stroke = null;
        continue;
      }
      if (!stroke) strokes.push(stroke = []);
      else if (steps) stroke.push([x[i], stroke.at(-1)[1]]);
      stroke.push([x[i], y[i]]);
    }
    return strokes;
  }
  function shareOf(value, axis) {
    return Math.min(1, Math.max(0, scaleOf(axis, 0, 1)(value)));
  }
  function layoutOf(panel, width, height, rows) {
    const cells2 = panel.parts.find((part) => part.is === "cells");
    const hasBar = Boolean(cells2) && width >= LEAST_WITH_BAR;
    const inside = {
      left: ROOM.left,
      top: ROOM.top + (panel.title ? ROOM.title : 0) + ROOM.row * rows,
      right: width - (hasBar ? ROOM.bar : ROOM.right),
      bottom: height - ROOM.bottom
    };
    const upward = cells2?.downward ? [inside.top, inside.bottom] : [inside.bottom, inside.top];
    return {
      inside,
      hasBar,
      toX: scaleOf(panel.across, inside.left, inside.right),
      toY: scaleOf(panel.up, upward[0], upward[1]),
      xAt: valueAt(panel.across, inside.left, inside.right),
      yAt: valueAt(panel.up, upward[0], upward[1])
    };
  }
  var ROOM = { left: 52, right: 12, top: 10, title: 16, bottom: 36, row: 15, bar: 74 };
  var LEAST_WITH_BAR = 300;

  // panel.js
  var LABELS = "11px system-ui, sans-serif";
  var DASHES = { "-": [], "--": [6, 4], "-.": [8, 3, 2, 3], ":": [2, 3] };
  var SMOOTH2 = 40;
  var POINT = 1.3;
  var BAR = 9;
  var LEVELS = 9;
  var numbersOf2 = (colour) => colour.match(/\d+/g).slice(0, 3).map(Number);
  var HEATS = Array.from({ length: 256 }, (_, i) => numbersOf2(heat(i / 255)[0]));
  function drawPanel(canvas, panel) {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    return width && height ? paintPanel(context(canvas, width, height), panel, tonesOf(canvas)) : null;
  }
  function tonesOf(canvas) {
    const probe = canvas.ownerDocument.createElement("i");
    canvas.after(probe);
    const known = /* @__PURE__ */ new Map();
    const find = (tone) => {
      if (tone.startsWith("#")) return tone;
      if (!tone.startsWith("series")) return colourOf(`--run-${tone}`) || colourOf(`--${tone}`) || colourOf("--ink");
      probe.style.color = hue(Number(tone.slice(6)));
      return getComputedStyle(probe).color;
    };
    const colours = (tone) => known.get(tone) ?? known.set(tone, find(tone)).get(tone);
    return Object.assign(colours, { done: () => probe.remove() });
  }
  function paintPanel({ g, width, height }, panel, tone) {
    const labels = legendOf(g, panel, width);
    const layout = layoutOf(panel, width, height, labels.length ? labels.at(-1).row + 1 : 0);
    const paper = { g, ...layout, panel, labels, width, tone };
    const { inside } = layout;
    const cells2 = panel.parts.find((part) => part.is === "cells");
    title(paper);
    axes(paper, !cells2);
    g.save();
    g.beginPath();
    g.rect(inside.left - 1, inside.top - 1, inside.right - inside.left + 2, inside.bottom - inside.top + 2);
    g.clip();
    for (const part of panel.parts) {
      g.globalAlpha = part.opacity ?? 1;
      PARTS[part.is](paper, part);
      g.globalAlpha = 1;
    }
    g.restore();
    if (layout.hasBar) bar(paper, cells2);
    legend(paper);
    tone.done();
    return layout;
  }
  function title({ g, inside, panel }) {
    g.fillStyle = colourOf("--ink");
    g.font = "600 12px system-ui, sans-serif";
    g.textAlign = "left";
    g.fillText(clean(panel.title), inside.left, 15, inside.right - inside.left);
  }
  function axes({ g, inside, panel, toX, toY }, ruled) {
    const { left, right, top, bottom } = inside;
    g.font = "11px system-ui, sans-serif";
    g.fillStyle = colourOf("--soft");
    g.strokeStyle = colourOf("--line");
    g.lineWidth = 1;
    g.textAlign = "right";
    for (const value of ticksOf(panel.up, Math.max(2, (bottom - top) / 40))) {
      const y = Math.round(toY(value)) + 0.5;
      if (ruled) g.strokeRect(left, y, right - left, 0);
      g.fillText(shortNumber(value), left - 5, y + 4);
    }
    g.textAlign = "center";
    for (const value of ticksOf(panel.across, Math.max(2, (right - left) / 70))) {
      g.fillText(shortNumber(value), toX(value), bottom + 14);
    }
    g.font = "600 12px system-ui, sans-serif";
    g.fillText(clean(panel.across.words), (left + right) / 2, bottom + 30, right - left);
    g.save();
    g.translate(11, (top + bottom) / 2);
    g.rotate(-Math.PI / 2);
    g.fillText(clean(panel.up.words), 0, 0, bottom - top);
    g.restore();
  }
  var PARTS = {
    line({ g, toX, toY, tone }, { x, y, steps, width, dash, tone: colour }) {
      g.strokeStyle = tone(colour);
      g.lineWidth = POINT * width;
      g.setLineDash(DASHES[dash] ?? []);
      g.beginPath();
      for (const stroke of strokesOf(x, y, steps)) trace(g, stroke, toX, toY);
      g.stroke();
      g.setLineDash([]);
    },
    area({ g, toX, toY, tone }, { x, y, tone: colour }) {
      g.fillStyle = tone(colour);
      g.beginPath();
      for (const stroke of strokesOf(x, y)) trace(g, stroke, toX, toY);
      g.fill();
    },
    band(paper, { x, low, high, ...part }) {
      const around = { x: [...x, ...x.toReversed()], y: [...high, ...low.toReversed()] };
      PARTS.area(
        paper,
        /** @type {any} */
        { ...part, ...around }
      );
    },
    level({ g, inside, toX, toY, tone }, { at, upright, width, dash, tone: colour }) {
      g.strokeStyle = tone(colour);
      g.lineWidth = POINT * width;
      g.setLineDash(DASHES[dash] ?? []);
      g.beginPath();
      g.moveTo(upright ? toX(at) : inside.left, upright ? inside.top : toY(at));
      g.lineTo(upright ? toX(at) : inside.right, upright ? inside.bottom : toY(at));
      g.stroke();
      g.setLineDash([]);
    },
    dots({ g, toX, toY, tone }, { x, y, sign, size, tone: colour }) {
      g.fillStyle = g.strokeStyle = tone(colour);
      g.lineWidth = 1.2;
      const draw = SIGNS[sign] ?? SIGNS["."];
      x.forEach((each, i) => each !== null && y[i] !== null && draw(g, toX(each), toY(y[i]), 0.5 * POINT * size));
    },
    cells(paper, part) {
      const columns = part.x.length;
      if (columns <= SMOOTH2 || part.y.length * columns !== part.values.length) cells(paper, part);
      else {
        samples(paper, part);
        if (!part.signed) levels(paper, part);
      }
    }
  };
  var SIGNS = {
    ".": (g, x, y, r) => g.fillRect(x - r, y - r, 2 * r, 2 * r),
    o(g, x, y, r) {
      g.beginPath();
      g.arc(x, y, r, 0, 2 * Math.PI);
      g.fill();
    },
    x: diagonal,
    X: diagonal,
    "+": (g, x, y) => cross(g, x, y)
  };
  function diagonal(g, x, y, r) {
    g.beginPath();
    g.moveTo(x - r, y - r);
    g.lineTo(x + r, y + r);
    g.moveTo(x - r, y + r);
    g.lineTo(x + r, y - r);
    g.stroke();
  }
  function cross(g, x, y) {
    for (const [width, colour] of [
      [4.5, "#ffffff"],
      [2, "#000000"]
    ]) {
      g.strokeStyle = colour;
      g.lineWidth = width;
      g.beginPath();
      g.arc(x, y, 6, 0, 2 * Math.PI);
      g.moveTo(x - 10, y);
      g.lineTo(x + 10, y);
      g.moveTo(x, y - 10);
      g.lineTo(x, y + 10);
      g.stroke();
    }
  }
  function trace(g, stroke, toX, toY) {
    stroke.forEach(([x, y], i) => i ? g.lineTo(toX(x), toY(y)) : g.moveTo(toX(x), toY(y)));
  }
  var shadeOf = (value, { value: axis, signed }) => (signed ? HEATS : SHADES)[Math.round(255 * shareOf(value, axis))];
  function samples({ g, toX, toY }, part) {
    const { x, y, values } = part;
    const [wide, tall] = [x.length, y.length];
    const colours = new ImageData(wide, tall);
    values.forEach((value, k) => {
      const row = part.downward ? Math.floor(k / wide) : tall - 1 - Math.floor(k / wide);
      if (value !== null) colours.data.set([...shadeOf(value, part), 255], 4 * (row * wide + k % wide));
    });
    const small = new OffscreenCanvas(wide, tall);
    small.getContext("2d").putImageData(colours, 0, 0);
    const [left, right] = [toX(x[0]), toX(x.at(-1))];
    const [top, bottom] = [toY(y[0]), toY(y.at(-1))].toSorted((a, b) => a - b);
    g.drawImage(small, 0.5, 0.5, wide - 1, tall - 1, left, top, right - left, bottom - top);
  }
  function levels({ g, inside, toX, toY }, { x, y, values, value }) {
    const last = [x.length - 1, y.length - 1];
    const spotOf = ([i, j]) => [
      toX(x[0] + (x[last[0]] - x[0]) * i / last[0]),
      toY(y[0] + (y[last[1]] - y[0]) * j / last[1])
    ];
    const numbers = values.map((each) => each ?? NaN);
    const named2 = [];
    g.strokeStyle = "rgb(255 255 255 / 0.75)";
    g.lineWidth = 1;
    g.beginPath();
    for (const level of ticksOf(value, LEVELS)) {
      if (level <= value.low || level >= value.high) continue;
      const segments = crossings(numbers, x.length, level, y.length).map((ends) => ends.map(spotOf));
      for (const [from, to] of segments) {
        g.moveTo(...from);
        g.lineTo(...to);
      }
      spotsOf(
        segments.map(([from]) => from),
        inside,
        named2.map(({ spot }) => spot)
      ).forEach((spot) => named2.push({ spot, level }));
    }
    g.stroke();
    g.font = "10.5px system-ui, sans-serif";
    g.textAlign = "center";
    g.lineWidth = 3;
    g.strokeStyle = "rgb(0 0 0 / 0.7)";
    g.fillStyle = "#ffffff";
    for (const { spot, level } of named2) {
      g.strokeText(shortNumber(level), spot[0], spot[1] + 4);
      g.fillText(shortNumber(level), spot[0], spot[1] + 4);
    }
  }
  function bar({ g, inside, width }, part) {
    const [left, top, tall] = [inside.right + 10, inside.top, inside.bottom - inside.top];
    const { value } = part;
    for (let row = 0; row < tall; row++) {
      const [r, g_, b] = (part.signed ? HEATS : SHADES)[Math.round(255 * (1 - row / tall))];
      g.fillStyle = `rgb(${r} ${g_} ${b})`;
      g.fillRect(left, top + row, BAR, 1.5);
    }
    const toY = scaleOf(value, inside.bottom, inside.top);
    g.fillStyle = colourOf("--soft");
    g.font = "11px system-ui, sans-serif";
    g.textAlign = "left";
    for (const tick of ticksOf(value, Math.max(2, tall / 40))) {
      g.fillText(shortNumber(tick, 3), left + BAR + 4, toY(tick) + 4);
    }
    g.save();
    g.translate(width - 5, (inside.top + inside.bottom) / 2);
    g.rotate(-Math.PI / 2);
    g.textAlign = "center";
    g.fillText(clean(value.words), 0, 0, tall);
    g.restore();
  }
  function hatch(g, x0, y0, x1, y1) {
    g.save();
    g.beginPath();
    g.rect(x0, y0, x1 - x0, y1 - y0);
    g.clip();
    g.strokeStyle = colourOf("--soft");
    g.globalAlpha = 0.4;
    g.lineWidth = 1;
    g.beginPath();
    for (let c = Math.floor((x0 - y1) / 6) * 6; c < x1 - y0; c += 6) {
      g.moveTo(y0 + c, y0);
      g.lineTo(y1 + c, y1);
    }
    g.stroke();
    g.restore();
  }
  function cells({ g, toX, toY }, part) {
    const { x, y, values } = part;
    const isEdged = values.length === (x.length - 1) * (y.length - 1);
    const [columns, rows] = isEdged ? [x.length - 1, y.length - 1] : [x.length, y.length];
    const [across, up] = [edgesOf(x, columns), edgesOf(y, rows)];
    g.font = "11px system-ui, sans-serif";
    g.textAlign = "center";
    values.forEach((value, k) => {
      const [i, j] = [k % columns, Math.floor(k / columns)];
      const [x0, x1] = [toX(across[i]), toX(across[i + 1])];
      const [y0, y1] = [toY(up[j]), toY(up[j + 1])].toSorted((a, b) => a - b);
      if (value === null) {
        if (part.missing) hatch(g, x0, y0, x1, y1);
        return;
      }
      const shade = shadeOf(value, part);
      g.fillStyle = `rgb(${shade.join(" ")})`;
      g.fillRect(x0, y0, x1 - x0 - 0.5, y1 - y0 - 0.5);
      const said2 = shortNumber(value, 2);
      if (x1 - x0 < 8 * said2.length || y1 - y0 < 13) return;
      g.fillStyle = inkOn(shade);
      g.fillText(said2, (x0 + x1) / 2, (y0 + y1) / 2 + 4);
    });
  }
  var inkOn = ([r, g, b]) => 0.2126 * r ** 2.2 + 0.7152 * g ** 2.2 + 0.0722 * b ** 2.2 < 0.18 * 255 ** 2.2 ? "#fff" : "#000";
  function legendOf(g, panel, width) {
    g.font = LABELS;
    let [x, row] = [ROOM.left, 0];
    return panel.parts.filter((part) => part.label || part.missing).map((part) => {
      const wide = 34 + g.measureText(clean(part.label || part.missing)).width + 10;
      if (x > ROOM.left && x + wide > width - ROOM.right) [x, row] = [ROOM.left, row + 1];
      const place = { part, x, row };
      x += wide;
      return place;
    });
  }
  function legend({ g, labels, panel, tone }) {
    g.font = LABELS;
    g.textAlign = "left";
    for (const { part, x, row } of labels) {
      const y = ROOM.top + (panel.title ? ROOM.title : 0) + ROOM.row * row + 4;
      key(g, part, x, y, tone);
      g.fillStyle = colourOf("--ink");
      g.fillText(clean(part.label || part.missing), x + 30, y + 4);
    }
  }
  function key(g, part, x, y, tone) {
    if (part.is === "cells") return hatch(g, x, y - 5, x + 24, y + 5);
    g.fillStyle = g.strokeStyle = tone(part.tone);
    g.globalAlpha = part.opacity ?? 1;
    if (part.is === "area" || part.is === "band") g.fillRect(x, y - 5, 24, 10);
    else if (part.is === "dots") (SIGNS[part.sign] ?? SIGNS["."])(g, x + 12, y, 0.5 * POINT * Math.max(4, part.size));
    else {
      g.lineWidth = 2;
      g.setLineDash(DASHES[part.dash] ?? []);
      g.beginPath();
      g.moveTo(x, y);
      g.lineTo(x + 24, y);
      g.stroke();
      g.setLineDash([]);
    }
    g.globalAlpha = 1;
  }

  // surface.js
  var packed = (share) => SHADES.map(([r, g, b]) => (255 << 24 | b * share << 16 | g * share << 8 | r * share) >>> 0);
  var FILLS = Uint32Array.from(packed(1));
  var DARKER = Uint32Array.from(packed(0.87));
  var MESH = 6;
  function surfacePane(store, { start }) {
    return new SurfacePane(store, { start }).section;
  }
  var SurfacePane = class {
    /**
     * @param {Page.Store} store
     */
    constructor(store, { start }) {
      this.store = store;
      this.start = start;
      const { section, bar: bar2, body } = pane("surface", S.surface);
      this.section = section;
      this.bar = bar2;
      this.canvas = el("canvas", { tabIndex: 0, role: "img" });
      const main = el("div", { class: "main" }, this.canvas);
      this.line = el("canvas", { tabIndex: 0, role: "img" });
      this.cutSlider = el("input", {
        type: "range",
        step: "any",
        oninput: () => this.store.setPoint(this.cutInput(), Number(this.cutSlider.value))
      });
      this.cutLabel = el("label", { class: "small" }, el("span"), this.cutSlider);
      this.below = el("div", { class: "below", hidden: true }, this.cutLabel, el("div", { class: "line" }, this.line));
      this.others = el("div", { class: "others" });
      this.turned = { azimuth: -0.65, elevation: 0.55 };
      this.flat = false;
      this.cut = "";
      this.image = null;
      this.layer = null;
      this.scale = null;
      this.size = { width: 0, height: 0 };
      this.plot = null;
      this.linePlot = null;
      this.handle = null;
      this.sliders = [];
      body.append(main, this.below, this.others);
      let held = false;
      this.canvas.addEventListener("pointerdown", (event) => {
        if (!this.store.scene) return;
        this.canvas.setPointerCapture(event.pointerId);
        held = Boolean(this.handle) && Math.hypot(event.offsetX - this.handle.at[0], event.offsetY - this.handle.at[1]) < 12;
        if (this.isPlane()) this.aim(event);
      });
      this.canvas.addEventListener("pointermove", (event) => {
        if (!this.store.scene || !event.buttons) return;
        if (this.isPlane()) this.aim(event);
        else if (held && this.handle) this.slide(event);
        else this.turn(0.01 * event.movementX, 0.01 * event.movementY);
      });
      this.canvas.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
        if (!step || !this.store.scene) return;
        event.preventDefault();
        if (this.isPlane()) this.nudge(step[0] ? this.store.axes.x : this.store.axes.y, step[0] + step[1]);
        else this.turn(0.1 * step[0], 0.1 * step[1]);
      });
      this.line.addEventListener("pointerdown", (event) => {
        this.line.setPointerCapture(event.pointerId);
        this.aimLine(event);
      });
      this.line.addEventListener("pointermove", (event) => {
        if (event.buttons) this.aimLine(event);
      });
      this.line.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 }[event.key];
        if (!step) return;
        event.preventDefault();
        this.nudge(this.otherInput(), step);
      });
      this.redraw = eachFrame(this.draw);
      this.store.on("scene", this.build);
      this.store.on("axes", this.build);
      for (const name of ["reshaped", "point", "theme", "told"]) this.store.on(name, this.redraw);
      const watch = new ResizeObserver(() => {
        this.size = { width: main.clientWidth, height: main.clientHeight };
        this.redraw();
      });
      watch.observe(main);
      watch.observe(this.line.parentElement);
    }
    cutInput = () => this.store.axes[this.cut];
    otherInput = () => this.store.axes[this.cut === "x" ? "y" : "x"];
    /** The side of the base, -0.5 or 0.5, that is nearer to the eye. */
    front = (axis) => {
      const depth = axis === "x" ? Math.sin(this.turned.azimuth) : Math.cos(this.turned.azimuth);
      return depth > 0 ? -0.5 : 0.5;
    };
    place = (variable, value) => {
      const [low, high] = rangeOf(variable);
      return (value - low) / (high - low);
    };
    isPlane = () => this.flat || this.store.axes.x === this.store.axes.y;
    build = () => {
      const focused = [...this.bar.querySelectorAll("select")].indexOf(document.activeElement);
      while (this.bar.childNodes.length > 1) this.bar.lastChild.remove();
      this.bar.append(el("span", { class: "space" }));
      const { inputs, outputs, missing } = this.store.scene;
      if (missing.length) {
        this.below.hidden = true;
        this.others.replaceChildren();
        this.redraw();
        return;
      }
      const names = inputs.map((each, i) => [String(i), each.name]);
      if (inputs.length > 2) {
        this.bar.append(
          choice(S.horizontal, names, String(this.store.axes.x), (i) => this.pick({ x: Number(i) })),
          choice(S.vertical, names, String(this.store.axes.y), (i) => this.pick({ y: Number(i) }))
        );
      }
      if (outputs.length > 1) {
        const shown = outputs.map((each, i) => [String(i), each.name]);
        this.bar.append(choice(S.shown, shown, String(this.store.axes.output), (i) => this.pick({ output: Number(i) })));
      }
      if (inputs.length > 1) {
        const views = [
          ["solid", S.solid],
          ["contour", S.contour]
        ];
        const cuts = [
          ["", S.noCut],
          ["x", inputs[this.store.axes.x].name],
          ["y", inputs[this.store.axes.y].name]
        ];
        this.bar.append(
          choice(S.view, views, this.flat ? "contour" : "solid", (view) => {
            this.flat = view === "contour";
            this.redraw();
          }),
          choice(S.cut, cuts, this.cut, (axis) => {
            this.cut = axis;
            this.prepare();
          })
        );
      } else this.cut = "";
      this.bar.querySelectorAll("select")[focused]?.focus();
      this.prepare();
    };
    /** Set up the line below for the cut, and the sliders beside for the inputs that are no axes. */
    prepare = () => {
      const { inputs } = this.store.scene;
      this.below.hidden = !this.cut;
      if (this.cut) {
        const [low, high] = rangeOf(inputs[this.cutInput()]);
        Object.assign(this.cutSlider, { min: low, max: high, step: (high - low) / 400 });
      }
      this.sliders = inputs.map((variable, i) => (
        /** @type {const} */
        [variable, i]
      )).filter(([, i]) => i !== this.store.axes.x && i !== this.store.axes.y).map(([variable, i]) => {
        const [low, high] = rangeOf(variable);
        const range = el("input", {
          type: "range",
          min: low,
          max: high,
          step: (high - low) / 400,
          oninput: () => this.store.setPoint(i, Number(range.value))
        });
        const said2 = el("output", {});
        return {
          i,
          range,
          said: said2,
          label: el("label", { class: "small" }, el("span", { textContent: variable.name }), range, said2)
        };
      });
      this.others.replaceChildren(...this.sliders.map(({ label }) => label));
      this.redraw();
    };
    pick = (axes2) => {
      const { x, y } = this.store.axes;
      if (axes2.x === y) axes2.y = x;
      else if (axes2.y === x) axes2.x = y;
      this.store.setAxes(axes2);
    };
    draw = () => {
      const { scene, axes: axes2 } = this.store;
      if (!scene || !this.size.width) return;
      if (scene.missing.length) {
        this.nothing(
          S.notYet(
            Object.keys(S.missing).filter((name) => scene.missing.includes(name)).map((name) => S.missing[name])
          )
        );
        return;
      }
      const [x, y] = [scene.inputs[axes2.x], scene.inputs[axes2.y]];
      const output = scene.outputs[axes2.output];
      for (const { i, range, said: said2 } of this.sliders) {
        range.value = this.store.point[i];
        said2.textContent = shortNumber(this.store.point[i]);
      }
      const { g, width, height } = context(this.canvas, this.size.width, this.size.height);
      this.handle = null;
      const found = this.store.surface();
      const label = S.surfaceLabel(output.name, x.name, x === y ? "" : y.name);
      const source = found?.isFar ? S.byServer : found && this.store.coarse ? S.coarse : "";
      this.canvas.setAttribute("aria-label", `${label} ${source}`.trim());
      if (!found) {
        this.nothing(this.store.refused || (this.start ? S.asking(scene.reason) : S.notHere(scene.reason)));
        return;
      }
      const [low, high] = limitsOf(found.z, output);
      const section = this.cut ? this.store.section(this.otherInput()) : null;
      const picture = { g, width, height, found, low, high, x, y, output, section };
      if (this.isPlane()) this.drawPlane(picture);
      else {
        this.drawSolid(picture);
        this.drawScale(picture);
      }
      if (source) {
        g.fillStyle = colourOf("--soft");
        g.font = "11px system-ui, sans-serif";
        g.textAlign = "left";
        g.fillText(source, 8, height - 6);
      }
      if (this.cut) this.drawSection(picture);
    };
    /** Say why nothing is drawn. */
    nothing = (words) => {
      const { g, width } = context(this.canvas, this.size.width, this.size.height);
      g.fillStyle = colourOf("--soft");
      g.font = "13px system-ui, sans-serif";
      this.wrapped(g, clean(words), 12, 24, width - 24);
      this.canvas.setAttribute("aria-label", clean(words));
    };
    scaleImage = () => {
      const colours = new ImageData(1, 256);
      SHADES.forEach((shade, i) => colours.data.set([...shade, 255], 4 * (255 - i)));
      const made = new OffscreenCanvas(1, 256);
      made.getContext("2d").putImageData(colours, 0, 0);
      return made;
    };
    /** What the colours stand for. */
    drawScale = ({ g, width, height, low, high }) => {
      const [right, top, tall, wide] = [width - 10, 26, Math.min(150, height - 70), 9];
      if (tall < 40) return;
      this.scale ??= this.scaleImage();
      g.drawImage(this.scale, right - wide, top, wide, tall);
      g.fillStyle = colourOf("--soft");
      g.font = "11px system-ui, sans-serif";
      g.textAlign = "right";
      for (const tick of ticks(low, high, tall / 34)) {
        g.fillText(shortNumber(tick), right - wide - 4, top + (tall - 1) * (1 - (tick - low) / (high - low)) + 4);
      }
    };
    // --- the solid ---
    drawSolid = ({ g, width, height, found, low, high, x, y, output }) => {
      const { z } = found;
      const n = found.xs.length;
      const { project, reach, farIsHigh } = projectionOf(this.turned, width, height);
      const px = new Float64Array(n * n);
      const py = new Float64Array(n * n);
      const share = new Float64Array(n * n);
      for (let j = 0, k = 0; j < n; j++) {
        for (let i = 0; i < n; i++, k++) {
          share[k] = (z[k] - low) / (high - low);
          const at = project(i / (n - 1) - 0.5, j / (n - 1) - 0.5, share[k] - 0.5);
          px[k] = at[0];
          py[k] = at[1];
        }
      }
      this.frame(g, project, { x, y, low, high, output, wanted: reach < 130 ? 2 : 4 });
      const is = farToNear(n - 1, farIsHigh.u);
      const js = farToNear(n - 1, farIsHigh.v);
      const ratio = 2;
      const [wide, tall] = [Math.round(ratio * width), Math.round(ratio * height)];
      if (this.image?.width !== wide || this.image?.height !== tall) {
        this.image = new ImageData(wide, tall);
        this.layer = new OffscreenCanvas(wide, tall);
      }
      const pixels = new Uint32Array(this.image.data.buffer);
      pixels.fill(0);
      for (let k = 0; k < n * n; k++) {
        px[k] *= ratio;
        py[k] *= ratio;
      }
      for (const j of js) {
        for (const i of is) {
          const [a, b] = [j * n + i, (j + 1) * n + i];
          const middle = 0.25 * (share[a] + share[a + 1] + share[b] + share[b + 1]);
          if (!(middle === middle)) continue;
          const fills = i % MESH && j % MESH ? FILLS : DARKER;
          const colour = fills[Math.max(0, Math.min(255, Math.round(255 * middle)))];
          const [c, d] = [a + 1, b + 1];
          fillTriangle(pixels, wide, tall, px[a], py[a], px[c], py[c], px[d], py[d], colour);
          fillTriangle(pixels, wide, tall, px[a], py[a], px[b], py[b], px[d], py[d], colour);
        }
      }
      this.layer.getContext("2d").putImageData(this.image, 0, 0);
      g.drawImage(this.layer, 0, 0, width, height);
      const value = this.store.value();
      if (this.cut) this.drawCut(g, project, low, high);
      if (Number.isFinite(value)) {
        const [u, v] = [x, y].map(
          (each, k) => this.place(each, this.store.point[k ? this.store.axes.y : this.store.axes.x])
        );
        this.dot(g, ...project(u - 0.5, v - 0.5, (value - low) / (high - low) - 0.5));
      }
    };
    /** The plane of the cut, where it meets the surface, and the handle that moves it. */
    drawCut = (g, project, low, high) => {
      const [one, other] = [this.cutInput(), this.otherInput()].map((i) => this.store.scene.inputs[i]);
      const at = this.place(one, this.store.point[this.cutInput()]) - 0.5;
      const corner = (along, w) => this.cut === "x" ? project(at, along, w) : project(along, at, w);
      g.fillStyle = g.strokeStyle = colourOf("--lit");
      g.globalAlpha = 0.12;
      g.beginPath();
      [
        [-0.5, -0.5],
        [0.5, -0.5],
        [0.5, 0.5],
        [-0.5, 0.5]
      ].forEach(([along, w], i) => i ? g.lineTo(...corner(along, w)) : g.moveTo(...corner(along, w)));
      g.closePath();
      g.fill();
      g.globalAlpha = 1;
      g.lineWidth = 1;
      g.stroke();
      const section = this.store.section(this.otherInput());
      g.lineWidth = 2;
      g.beginPath();
      let down = false;
      section?.z.forEach((value, i) => {
        const spot = corner(this.place(other, section.xs[i]) - 0.5, (value - low) / (high - low) - 0.5);
        if (Number.isFinite(value)) down ? g.lineTo(...spot) : g.moveTo(...spot);
        down = Number.isFinite(value);
      });
      g.stroke();
      const way = (share) => this.cut === "x" ? project(share, this.front("y"), -0.5) : project(this.front("x"), share, -0.5);
      this.handle = { at: way(at), from: way(-0.5), to: way(0.5) };
      g.fillStyle = colourOf("--pane");
      g.beginPath();
      g.arc(...this.handle.at, 6, 0, 2 * Math.PI);
      g.fill();
      g.stroke();
    };
    frame = (g, project, { x, y, low, high, output, wanted }) => {
      g.strokeStyle = colourOf("--line");
      g.fillStyle = colourOf("--soft");
      g.font = "11px system-ui, sans-serif";
      g.textAlign = "center";
      g.lineWidth = 1;
      const base = [
        [-0.5, -0.5],
        [0.5, -0.5],
        [0.5, 0.5],
        [-0.5, 0.5]
      ].map(([u, v]) => project(u, v, -0.5));
      g.beginPath();
      base.forEach((at, i) => i ? g.lineTo(...at) : g.moveTo(...at));
      g.closePath();
      g.stroke();
      const near = Math.cos(this.turned.azimuth) > 0 ? -0.5 : 0.5;
      const side = Math.sin(this.turned.azimuth) > 0 ? -0.5 : 0.5;
      const axis = (variable, at) => {
        const [a, b] = rangeOf(variable);
        for (const tick of ticks(a, b, wanted)) {
          g.fillText(shortNumber(tick), ...at((tick - a) / (b - a) - 0.5, 1.1));
        }
        g.font = "600 12px system-ui, sans-serif";
        g.fillText(clean(variable.name).slice(0, 24), ...at(0, 1.32));
        g.font = "11px system-ui, sans-serif";
      };
      axis(x, (t, out) => project(t, near * out, -0.5));
      axis(y, (t, out) => project(side * out, t, -0.5));
      g.textAlign = "left";
      g.fillText(`${clean(output.name).slice(0, 24)}: ${shortNumber(low)} \u2026 ${shortNumber(high)}`, 8, 15);
    };
    dot = (g, x, y) => {
      g.fillStyle = colourOf("--lit");
      g.strokeStyle = "#ffffff";
      g.lineWidth = 1.5;
      g.beginPath();
      g.arc(x, y, 4.5, 0, 2 * Math.PI);
      g.fill();
      g.stroke();
    };
    // --- seen from above, over one input, or the section of the cut ---
    drawPlane = ({ found, low, high, x, y, output }) => {
      const { axes: axes2 } = this.store;
      const whole = this.whole(output, low, high);
      const [across, up] = [this.along(axes2.x), this.along(axes2.y)];
      if (x === y) this.plot = drawPanel(this.canvas, linePanel(found, across, whole));
      else {
        const inputs = [
          { ...across, isCut: this.cut === "x" },
          { ...up, isCut: this.cut === "y" }
        ];
        this.plot = drawPanel(this.canvas, planePanel(found, inputs, whole));
      }
    };
    /**
     * The output as an axis, and its value at the point.
     *
     * @returns {{ name: string, range: Page.Pair, at: number }}
     */
    whole = ({ name }, low, high) => ({ name, range: [low, high], at: this.store.value() });
    /** An input as an axis, and where the point lies along it. */
    along = (input) => {
      const variable = this.store.scene.inputs[input];
      return { name: variable.name, range: rangeOf(variable), at: this.store.point[input] };
    };
    drawSection = ({ section: found, low, high, output }) => {
      const [at, other] = [this.cutInput(), this.otherInput()].map(this.along);
      this.cutSlider.value = at.at;
      const said2 = S.cutAt(at.name, shortNumber(at.at));
      this.cutLabel.firstChild.textContent = clean(said2);
      this.line.setAttribute("aria-label", S.sectionLabel(output.name, other.name, said2));
      if (!found) return;
      const whole = this.whole(output, low, high);
      this.linePlot = drawPanel(this.line, linePanel(found, other, whole));
    };
    wrapped = (g, text, x, y, width) => {
      let line = "";
      for (const word of text.split(" ")) {
        if (line && g.measureText(`${line} ${word}`).width > width) {
          g.fillText(line, x, y);
          [line, y] = [word, y + 18];
        } else line = line ? `${line} ${word}` : word;
      }
      g.fillText(line, x, y);
    };
    // --- hands ---
    aim = (event) => {
      if (!this.plot) return;
      const { x, y } = this.store.axes;
      this.store.setPoint(x, this.plot.xAt(event.offsetX));
      if (x !== y) this.store.setPoint(y, this.plot.yAt(event.offsetY));
    };
    nudge = (input, steps) => {
      const [low, high] = rangeOf(this.store.scene.inputs[input]);
      this.store.setPoint(input, this.store.point[input] + steps * 0.01 * (high - low));
    };
    /** Move the cut to where the pointer is along the edge that its handle runs on. */
    slide = (event) => {
      const { from, to } = this.handle;
      const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
      const share = ((event.offsetX - from[0]) * dx + (event.offsetY - from[1]) * dy) / (dx * dx + dy * dy);
      const [low, high] = rangeOf(this.store.scene.inputs[this.cutInput()]);
      this.store.setPoint(this.cutInput(), low + share * (high - low));
    };
    aimLine = (event) => {
      if (this.linePlot) this.store.setPoint(this.otherInput(), this.linePlot.xAt(event.offsetX));
    };
    turn = (azimuth, elevation) => {
      this.turned.azimuth -= azimuth;
      this.turned.elevation = Math.min(1.5, Math.max(0.05, this.turned.elevation + elevation));
      this.redraw();
    };
  };

  // viewer.js
  var SAMPLES = 121;
  var ROW = 27;
  var SPARE = 2;
  function viewerPane(store) {
    return new ViewerPane(store).section;
  }
  var ViewerPane = class {
    /**
     * @param {Page.Store} store
     */
    constructor(store) {
      this.store = store;
      const { section, bar: bar2, body } = pane("inference", S.inference);
      this.section = section;
      this.sliders = el("div", { class: "sliders" });
      this.why = el("div", { "aria-live": "polite" });
      this.head = el("div", { class: "fired head" });
      this.rows = el("div", { class: "rules-fired", tabIndex: 0, role: "group", "aria-label": S.rules });
      this.foot = el("div", { class: "fired foot" });
      this.inputs = [];
      this.order = "strength";
      bar2.append(
        el("span", { class: "space" }),
        choice(
          S.order,
          [
            ["strength", S.strongest],
            ["text", S.asWritten]
          ],
          this.order,
          (to) => {
            this.order = to;
            this.rows.scrollTop = 0;
            this.draw();
          }
        )
      );
      body.append(this.sliders, this.why, this.head, this.rows, this.foot);
      const redraw = eachFrame(this.draw);
      this.store.on("scene", this.build);
      for (const name of ["reshaped", "point", "told"]) this.store.on(name, redraw);
      this.rows.addEventListener("scroll", redraw);
      new ResizeObserver(redraw).observe(this.rows);
    }
    small = (x) => x > 0 && x < 1e-3 ? x.toExponential(0) : shortNumber(x, 3);
    degree = (found, number) => {
      const [high, low] = [found.strengths[number], found.lower[number]].map(this.small);
      return high === low ? high : S.between(low, high);
    };
    samples = (variable) => {
      const [low, high] = rangeOf(variable);
      return Float64Array.from({ length: SAMPLES }, (_, i) => low + (high - low) * i / (SAMPLES - 1));
    };
    across = (i) => (100 * i / (SAMPLES - 1)).toFixed(2);
    line = (y) => Array.from(y, (v, i) => `${i ? "L" : "M"}${this.across(i)} ${(-v).toFixed(3)}`).join("");
    area = (y) => `${this.line(y)}L100 0L0 0Z`;
    filled = (y, side) => svg("path", { class: side ? "cut lower" : "cut", d: this.area(y) });
    outline = (y, side) => svg("path", { class: side ? "set lower" : "set", d: this.line(y) });
    share = (variable, value) => {
      const [low, high] = rangeOf(variable);
      return 100 * (value - low) / (high - low);
    };
    build = () => {
      this.sliders.replaceChildren();
      this.inputs = this.store.scene.inputs.map((variable, i) => {
        const [low, high] = rangeOf(variable);
        const set = (value) => {
          if (Number.isFinite(value)) this.store.setPoint(i, value);
        };
        const label = el("label", { textContent: variable.name, title: variable.description || variable.name });
        const range = el("input", {
          type: "range",
          min: low,
          max: high,
          step: (high - low) / 400,
          id: `input-${i}`,
          oninput: () => set(Number(range.value))
        });
        label.htmlFor = range.id;
        const number = el("input", {
          type: "text",
          inputMode: "decimal",
          "aria-label": `${variable.name}: ${S.value}`,
          onchange: () => set(Number(number.value))
        });
        this.sliders.append(el("div", { class: "slider" }, label, range, number));
        return { range, number };
      });
      const { scene } = this.store;
      const first = scene.rules.some((rule) => rule.readings.length > 1) ? "8.4em" : "5.4em";
      const columns = `${first} repeat(${scene.inputs.length + scene.outputs.length}, minmax(0, 1fr))`;
      for (const part of [this.head, this.foot]) part.style.gridTemplateColumns = columns;
      this.rows.style.setProperty("--columns", columns);
      this.head.replaceChildren(
        el("span"),
        ...[...scene.inputs, ...scene.outputs].map(
          (variable) => el("strong", { class: "cell", textContent: variable.name })
        )
      );
      this.draw();
    };
    draw = () => {
      if (!this.store.scene) return;
      this.inputs.forEach(({ range, number }, i) => {
        range.value = this.store.point[i];
        if (document.activeElement !== number) number.value = shortNumber(this.store.point[i], 6);
      });
      if (this.store.scene.missing.length) {
        this.why.replaceChildren();
        for (const part of [this.head, this.rows, this.foot]) part.hidden = true;
        return;
      }
      const found = this.store.fired();
      const isKnown = found || this.store.running;
      for (const part of [this.head, this.rows, this.foot]) part.hidden = !found;
      if (!isKnown) {
        this.why.replaceChildren(
          el("p", { class: "note", textContent: this.store.refused || S.notHere(this.store.scene.reason) })
        );
        return;
      }
      this.why.replaceChildren(...this.reasons(found));
      if (!found) return;
      this.list(found);
      this.foot.replaceChildren(
        el("span"),
        ...this.store.scene.inputs.map(() => el("span")),
        ...this.store.scene.outputs.map((output, o) => this.whole(output, o, found))
      );
    };
    reasons = (found) => {
      return this.store.scene.outputs.map((output, o) => {
        const value = found?.outputs[o];
        const line = el("p", { class: "why" });
        const ends = output.interval && found?.ends?.[o].every(Number.isFinite) ? found.ends[o] : null;
        const interval = ends ? ` ${S.interval(...ends.map((x) => shortNumber(x, 6)))}` : "";
        const said2 = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
        line.append(el("output", { textContent: `${output.name} = ${said2}${interval}` }));
        let first = -1;
        this.store.scene.rules.forEach((rule, number) => {
          const strength = found?.strengths[number] ?? 0;
          const concludes = rule.concludes.some(([k]) => k === o);
          if (concludes && strength > (first < 0 ? 0 : found.strengths[first])) first = number;
        });
        const reason = first >= 0 ? ` ${S.because} ${this.store.scene.rules[first].text} (${S.strength} ${this.degree(found, first)}, ${this.store.scene.rules[first].place})` : ` \u2013 ${S.nothingFires}`;
        line.append(clean(reason));
        return line;
      });
    };
    /** Draw the rules that are seen; those above and below are as much room. */
    list = (found) => {
      const { rules } = this.store.scene;
      let numbers = rules.map((_, number) => number);
      if (this.order === "strength") {
        numbers = numbers.filter((number) => found.strengths[number] > 0);
        numbers.sort((a, b) => found.strengths[b] - found.strengths[a]);
      }
      const first = Math.max(0, Math.floor(this.rows.scrollTop / ROW) - SPARE);
      const last = Math.min(numbers.length, first + Math.ceil((this.rows.clientHeight || 200) / ROW) + 2 * SPARE);
      const room = (count) => {
        const made = el("div");
        made.style.height = `${count * ROW}px`;
        return made;
      };
      this.rows.replaceChildren(
        room(first),
        ...numbers.slice(first, last).map((number) => this.row(found, number)),
        room(numbers.length - last)
      );
    };
    row = (found, number) => {
      const { scene } = this.store;
      const rule = scene.rules[number];
      const made = el("div", {
        class: found.strengths[number] > 0 ? "fired" : "fired silent",
        title: `${rule.place}: ${rule.text} (${S.strength} ${this.degree(found, number)})`
      });
      made.append(el("span", { class: "degree" }, el("span", { textContent: rule.place }), this.degree(found, number)));
      scene.inputs.forEach((variable, i) => made.append(this.premise(variable, i, rule)));
      scene.outputs.forEach((output, o) => made.append(this.conclusion(output, o, rule, found, number)));
      return made;
    };
    // --- pictures, 100 wide and 1 high ---
    picture = (label, kind, ...parts) => {
      const title2 = svg("title", {}, label);
      return svg(
        "svg",
        { viewBox: "0 -1.04 100 1.1", preserveAspectRatio: "none", role: "img", "aria-label": label, class: kind },
        title2,
        svg("line", { class: "base", x1: 0, x2: 100, y1: 0, y2: 0 }),
        ...parts
      );
    };
    mark = (variable, value) => {
      const x = this.share(variable, value);
      return svg("line", { x1: x, x2: x, y1: -1.04, y2: 0 });
    };
    premise = (variable, i, rule) => {
      const parts = [];
      const words = [];
      for (const [input, name, hedges] of rule.parts) {
        const term = variable.terms.find((each) => input === i && each.name === name);
        if (!term?.curve) continue;
        const degrees = sidesOf(term).map((shape) => {
          const y = this.store.degrees(variable, shape, this.samples(variable));
          const at = this.store.degrees(variable, shape, Float64Array.of(this.store.point[i]))[0];
          const side = shape.side ?? 0;
          parts.push(
            this.filled(
              y.map((v) => Math.min(v, at)),
              side
            ),
            this.outline(y, side)
          );
          return shortNumber(at, 3);
        });
        words.push(`${hedges} ${name}: ${degrees.length > 1 ? S.between(degrees[1], degrees[0]) : degrees[0]}`.trim());
      }
      if (!parts.length) return el("span");
      return this.picture(`${variable.name} ${words.join(", ")}`, "", ...parts, this.mark(variable, this.store.point[i]));
    };
    /** Degrees of a consequent at the samples, as it is now. */
    setOf = (output, member) => {
      const term = output.terms.find((each) => each.name === member.term);
      const shape = member.isLower ? term?.lower ?? term : term;
      if (shape?.curve && !member.hedged) return this.store.degrees(output, shape, this.samples(output));
      const numbers = Float64Array.from(member.curve.numbers);
      return this.store.curves.degrees(member.curve.address, numbers, this.samples(output));
    };
    conclusion = (output, o, rule, found, number) => {
      const parts = [];
      const words = [];
      const sides = [
        [rule.concludes, found.strengths],
        [rule.concludesLower, found.lower]
      ];
      sides.forEach(([concludes, strengths], side) => {
        for (const [k, index] of concludes) {
          const member = output.members[index];
          if (k !== o) continue;
          if (!side) words.push(member.words);
          if (member.curve === null) {
            if (member.value !== null) parts.push(this.stem(output, member.value, strengths[number]));
            continue;
          }
          const y = this.setOf(output, member);
          const cut = new Float64Array(SAMPLES);
          this.store.curves.cut(member.implication, 2, strengths[number], y, cut);
          parts.push(this.filled(cut, side), this.outline(y, side));
        }
      });
      return words.length ? this.picture(`${output.name} ${words.join(", ")}`, "", ...parts) : el("span");
    };
    stem = (output, value, height) => {
      const x = this.share(output, value);
      return svg("line", { x1: x, x2: x, y1: -height, y2: 0 });
    };
    whole = (output, o, found) => {
      const parts = [];
      for (const side of output.twoSided ? [0, 1] : [0]) {
        const aggregate = new Float64Array(SAMPLES);
        output.members.forEach((member, index) => {
          const height = found.heights[o][index];
          if (!(height > 0) || member.side !== side) return;
          if (member.curve !== null) {
            this.store.curves.cut(member.implication, output.aggregation, height, this.setOf(output, member), aggregate);
          } else if (member.value !== null) parts.push(this.stem(output, member.value, height));
        });
        if (aggregate.some((v) => v > 0)) parts.unshift(this.filled(aggregate, side));
      }
      const value = found.outputs[o];
      let said2 = Number.isFinite(value) ? shortNumber(value, 6) : S.noValue;
      const ends = output.interval ? found.ends?.[o] : null;
      if (ends?.every(Number.isFinite)) {
        const [left, right] = ends.map((end) => this.share(output, end));
        parts.push(
          svg("rect", { class: "interval", x: left, width: Math.max(0.2, right - left), y: -1.04, height: 1.04 })
        );
        said2 += ` ${S.interval(...ends.map((x) => shortNumber(x, 6)))}`;
      }
      if (Number.isFinite(value)) parts.push(this.mark(output, value));
      return this.picture(`${S.aggregate}: ${output.name} = ${said2}`, "whole", ...parts);
    };
  };

  // frame.js
  var DESIGN = {
    name: "design",
    title: S.design,
    drawn: true,
    panes: [termsPane, surfacePane, rulesPane, viewerPane],
    splits: [
      { key: "design-columns", vertical: true, at: 1, usual: 0.5 },
      { key: "design-rows", vertical: false, at: 1, usual: 0.5 }
    ]
  };
  var DARK = "(prefers-color-scheme: dark)";
  function frame(store, hand, text, controls, shownViews = [DESIGN]) {
    return new Frame(store, hand, text, controls, shownViews).api();
  }
  var Frame = class {
    /**
     * @param {Page.Store} store
     * @param {Page.Hand} hand
     */
    constructor(store, hand, text, controls, shownViews = [DESIGN]) {
      this.store = store;
      this.shownViews = shownViews;
      this.note = el("p", { class: "note" });
      this.views = this.shownViews.map(({ name, title: title2, drawn, panes, splits = [] }) => {
        const made = [...panes.map((make) => make(this.store, hand)), ...splits.map(splitter)];
        const panel = this.shownViews.length > 1 ? { role: "tabpanel", "aria-label": title2 } : {};
        return el(
          "div",
          { class: `pictures view-${name}${drawn ? " drawn" : ""}`, id: `view-${name}`, hidden: true, ...panel },
          ...made
        );
      });
      this.area = el("div", { class: "area" }, this.note, ...this.views);
      const between = text ? [text, splitter({ key: "text", vertical: true, at: 1, usual: 0.35 })] : [];
      const main = el("main", { class: text ? "design" : "design alone" }, ...between, this.area);
      const gone = new AbortController();
      const help = helpButton(
        this.shownViews.map((view) => view.name),
        gone.signal
      );
      const header = el(
        "header",
        {},
        el("h1", { textContent: S.designer }),
        ...controls,
        el("span", { class: "last" }, help, themeButton(this.store))
      );
      this.shown = 0;
      this.tabs = this.shownViews.map(
        ({ name, title: title2 }, i) => el("button", { role: "tab", textContent: title2, "aria-controls": `view-${name}`, onclick: () => this.turn(i) })
      );
      if (this.tabs.length > 1) header.lastChild.before(el("div", { role: "tablist", class: "tabs" }, ...this.tabs));
      this.root = el("div", { class: "desk" }, header, main);
      this.turn(0);
      window.addEventListener(
        "keydown",
        (event) => {
          if (event.key === "F6" && this.root.isConnected) this.step(event);
        },
        gone
      );
      matchMedia(DARK).addEventListener("change", () => this.store.emit("theme"), gone);
      this.store.on("closed", () => gone.abort());
      this.store.on("scene", this.sound);
      this.store.on("diagram", this.sound);
      this.store.on("stale", () => {
        this.note.textContent = this.store.why === "other" ? S.noRules : S.notDrawn;
        this.area.classList.add("stale");
      });
    }
    api() {
      return { root: this.root, turn: (name) => this.turn(this.shownViews.findIndex((view) => view.name === name)) };
    }
    sound = () => {
      this.area.classList.remove("stale");
      this.area.classList.toggle("as-diagram", Boolean(this.store.diagram) && this.store.asDiagram);
      this.turn(this.shown);
    };
    turn = (to) => {
      this.shown = to;
      this.note.hidden = !this.shownViews[this.shown].drawn || Boolean(this.store.scene ?? this.store.diagram);
      this.views.forEach((view, i) => {
        view.hidden = i !== this.shown || !this.note.hidden;
      });
      this.tabs.forEach((tab, i) => tab.setAttribute("aria-selected", String(i === this.shown)));
      if (this.store.view === this.shownViews[this.shown].name) return;
      this.store.view = this.shownViews[this.shown].name;
      this.store.emit("view");
    };
    /** Go to the next pane, or with Shift to the one before: there are many stops of Tab between. */
    step = (event) => {
      if (document.querySelector("dialog[open]")) return;
      const panes = [...this.root.querySelectorAll(".pane")].filter((each) => each.offsetParent);
      const at = panes.findIndex((each) => each.contains(document.activeElement));
      const next = event.shiftKey ? Math.max(at, 0) - 1 : at + 1;
      event.preventDefault();
      panes.at(next % panes.length).focus();
    };
  };
  function themeButton(store) {
    const root2 = document.documentElement;
    const dark = () => root2.dataset.theme ? root2.dataset.theme === "dark" : matchMedia(DARK).matches;
    const button = el("button", { title: S.theme, textContent: dark() ? S.light : S.dark });
    button.addEventListener("click", () => {
      root2.dataset.theme = dark() ? "light" : "dark";
      store.emit("theme");
    });
    store.on("theme", () => {
      button.textContent = dark() ? S.light : S.dark;
    });
    return button;
  }

  // listing.js
  function written(x) {
    return String(x);
  }
  function shapeText({ kind, parameters, height, lower }) {
    const numbers = parameters.map(written);
    const body = kind === "points" ? numbers.flatMap((x, i) => i % 2 ? [] : [`(${x}, ${numbers[i + 1]})`]).join(" ") : numbers.join(" ");
    const below = lower ? ` over ${shapeText(lower)}` : "";
    return `${kind} ${body}${height === 1 ? "" : ` height ${written(height)}`}${below}`;
  }
  function listingPane({ text, colours, places }) {
    const { section, bar: bar2, body } = pane("text", S.text);
    const area = el("pre", { class: "listing", tabIndex: 0, "aria-label": S.editor });
    const edits = /* @__PURE__ */ new Map();
    bar2.append(el("span", { class: "space" }), el("span", { class: "small", textContent: S.readOnly }));
    body.append(area);
    const starts = [0];
    for (let i = text.indexOf("\n"); i >= 0; i = text.indexOf("\n", i + 1)) starts.push(i + 1);
    const words = colours.map(([line, from, to, colour]) => [starts[line] + from, starts[line] + to, colour]);
    function draw() {
      const changes = [...edits.values()].sort((a, b) => a.from - b.from);
      const parts = [];
      let at = 0;
      const plain = (end) => {
        for (const [from, to, colour] of words) {
          if (to <= at || from >= end) continue;
          if (from > at) parts.push(clean(text.slice(at, from)));
          parts.push(
            el("span", { class: `colour-${colour}`, textContent: text.slice(Math.max(at, from), Math.min(to, end)) })
          );
          at = Math.min(to, end);
        }
        if (end > at) parts.push(clean(text.slice(at, end)));
        at = Math.max(at, end);
      };
      for (const change of changes) {
        plain(change.from);
        parts.push(el("mark", { textContent: change.text }));
        at = Math.max(at, change.to);
      }
      plain(text.length);
      area.replaceChildren(...parts);
    }
    draw();
    return {
      section,
      reshape(shapes) {
        for (const shape of shapes) {
          const place = places.find((each) => each.variable === shape.variable && each.term === shape.term);
          if (!place) continue;
          const said2 = place.before + shapeText(shape);
          edits.set(`${shape.variable}
${shape.term}`, { from: place.from, to: place.to, text: said2 });
        }
        draw();
      }
    };
  }

  // front:engine
  var { Engine } = globalThis.fuzzyarm;

  // store.js
  var ACROSS = 61;
  var evenly = ([low, high], points) => Float64Array.from({ length: points }, (_, k) => low + (high - low) * k / (points - 1));
  var Store = class {
    constructor() {
      this.listeners = {};
      this.scene = null;
      this.engine = null;
      this.held = null;
      this.reshaped = /* @__PURE__ */ new Map();
      this.busy = false;
      this.point = [];
      this.axes = { x: 0, y: 1, output: 0 };
      this.stale = false;
      this.sound = false;
      this.findings = [];
      this.far = null;
      this.told = null;
      this.view = "";
      this.diagram = null;
      this.refused = "";
      this.why = "";
      this.coarse = null;
      this.cost = null;
      this.asDiagram = true;
    }
    on(name, listener) {
      (this.listeners[name] ??= []).push(listener);
    }
    emit(name) {
      for (const listener of this.listeners[name] ?? []) listener();
    }
    /**
     * Take a rule base; the point and the axes stay where they fit.
     *
     * @param {Messages.Scene} scene
     */
    show(scene) {
      const same = this.scene && JSON.stringify(this.scene.inputs.map((v) => [v.name, v.low, v.high])) === JSON.stringify(scene.inputs.map((v) => [v.name, v.low, v.high]));
      for (const variable of [...scene.inputs, ...scene.outputs]) {
        for (const term of variable.terms) {
          for (const shape of sidesOf(term)) {
            shape.parameters = shape.parameters.map(Number);
            if (shape.curve) shape.curve.numbers = shape.curve.numbers.map(Number);
          }
          if (term.lower) Object.assign(term.lower, { name: term.name, side: 1 });
        }
      }
      for (const output of scene.outputs) {
        for (const { curve } of output.members) if (curve) curve.numbers = curve.numbers.map(Number);
      }
      this.scene = scene;
      this.engine = scene.numbers ? new Engine(scene.numbers) : null;
      const none = { whole: "", floats: "", functions: scene.functions };
      this.curves = this.engine ?? new Engine(none);
      this.held = this.far = this.told = this.cost = null;
      if (!this.busy) this.reshaped.clear();
      this.stale = false;
      if (!same) {
        this.point = scene.inputs.map((variable) => {
          const [low, high] = rangeOf(variable);
          return low + 0.6 * (high - low);
        });
        this.axes = { x: 0, y: Math.max(0, Math.min(1, scene.inputs.length - 1)), output: 0 };
      }
      this.axes.output = Math.max(0, Math.min(this.axes.output, scene.outputs.length - 1));
      this.emit("scene");
    }
    /**
     * Take the block diagram of a controller, or that there is none.
     *
     * @param {Messages.SceneDiagram | null} diagram
     */
    draw(diagram) {
      this.diagram = diagram;
      if (diagram) this.stale = false;
      this.emit("diagram");
    }
    /** Show the block diagram or the rules, of a file that has both. */
    turnDiagram(shown) {
      this.asDiagram = shown;
      this.emit("diagram");
    }
    /** Keep what is drawn, as of an earlier text; `why` says what the text is now. */
    mistaken(why) {
      this.why = why;
      if (!this.stale) {
        this.stale = true;
        this.emit("stale");
      }
    }
    /** Take whether the text of now is sound. */
    judge(sound) {
      this.sound = sound;
      this.emit("judged");
    }
    /** The value of the output shown at the point; NaN where there is none, or it is not known. */
    value() {
      const outputs = this.running ? this.running.at(this.point) : this.told?.outputs;
      return outputs?.[this.axes.output] ?? NaN;
    }
    /** The engine whose numbers are those of the picture. */
    get running() {
      return this.held?.engine ?? this.engine;
    }
    setPoint(index, value) {
      const [low, high] = rangeOf(this.scene.inputs[index]);
      this.point[index] = Math.min(high, Math.max(low, value));
      this.emit("point");
    }
    setAxes(axes2) {
      Object.assign(this.axes, axes2);
      this.emit("axes");
    }
    // --- terms ---
    /** Parameters and height of a shape as they are drawn: what a hand holds, or the text's. */
    now(variable, shape) {
      return this.reshaped.get(shapeKey(variable, shape)) ?? shape;
    }
    /** Degrees of a shape at some positions, as it is drawn, or with other numbers. */
    degrees(variable, shape, x, now = this.now(variable, shape)) {
      const numbers = Float64Array.from(this.numbersOf(shape, now));
      const found = this.curves.degrees(shape.curve.address, numbers, x);
      const factor = shape.height === 1 && !cornersOf(shape, now.parameters) ? now.height : 1;
      if (factor !== 1) for (let i = 0; i < found.length; i++) found[i] *= factor;
      return found;
    }
    /** What the row function of a shape takes: corners, or numbers and the height that the text has. */
    numbersOf(shape, now) {
      if (now === shape) return shape.curve.numbers;
      const corners = cornersOf(shape, now.parameters, now.height);
      if (corners) return corners;
      return shape.height === 1 ? now.parameters : [...now.parameters, now.height];
    }
    /** Have the numbers of a variable's terms changed in place from now on. */
    hold(variable, numbers) {
      this.held = numbers ? { variable: variable.name, engine: new Engine(numbers) } : null;
      for (const shape of variable.terms.flatMap(sidesOf)) {
        const now = this.now(variable, shape);
        if (now !== shape && this.held) this.patch(variable, shape, now);
      }
      this.emit("reshaped");
    }
    reshape(variable, shape, parameters, height = this.now(variable, shape).height) {
      const now = { parameters, height };
      this.reshaped.set(shapeKey(variable, shape), now);
      if (this.held?.variable === variable.name) this.patch(variable, shape, now);
      this.emit("reshaped");
    }
    /** Draw the terms as the text has them: a change was not taken. */
    forget() {
      this.held = null;
      this.reshaped.clear();
      this.emit("reshaped");
    }
    patch(variable, shape, now) {
      const engine = this.held.engine;
      for (const mark of engine.data.marks) {
        if (!shape.marks.includes(mark.term)) continue;
        if (mark.sort === "curve") {
          const numbers = this.numbersOf(shape, now);
          if (numbers.length === mark.room) engine.patch(mark.floats, numbers);
        } else if (mark.sort === "value") engine.patch(mark.floats, [now.parameters[0]]);
        else if (mark.sort === "samples") {
          const output = this.scene.outputs.findIndex((each) => each.name === variable.name);
          engine.patch(mark.floats, this.degrees(variable, shape, engine.positions(output), now));
        } else {
          const corners = cornersOf(shape, now.parameters, now.height);
          const pieces = piecesOf(corners, ...rangeOf(variable));
          engine.patch(mark.floats, pieces.slice(0, 4 * mark.room));
          engine.patchWhole(mark.row, Math.min(mark.room, pieces.length / 4));
        }
      }
    }
    // --- values ---
    /** Which surface is shown: what else it depends on than the point within it. */
    surfaceKey() {
      const { x, y, output } = this.axes;
      return JSON.stringify([x, y, output, this.point.filter((_, i) => i !== x && i !== y)]);
    }
    /** How many points along an axis are computed within a tenth of a second. */
    across() {
      const few = this.scene.functions.some((each) => /^integrated_|_integral$/.test(each.program ?? "")) ? 15 : ACROSS;
      const known = this.cost ? Math.floor(Math.sqrt(100 / this.cost)) : few;
      return Math.min(ACROSS, Math.max(9, known));
    }
    /**
     * The output shown over the two inputs of the axes, row by row; NaN where there is no value. It
     * is the server's (`far`) where the page does not compute it, or not as finely; null before.
     */
    surface(points = this.across()) {
      const isFar = this.far?.key === this.surfaceKey() && !this.reshaped.size;
      const isCoarse = points < ACROSS;
      if (isCoarse !== this.coarse) {
        this.coarse = isCoarse;
        this.emit("coarse");
      }
      if (isFar && (this.coarse || !this.running)) return this.far;
      if (!this.running) return null;
      const { x, y, output } = this.axes;
      const flat = x === y;
      const rows = flat ? 1 : points;
      const columns = this.scene.inputs.map((_, i) => new Float64Array(points * rows).fill(this.point[i]));
      const [xs, ys] = [x, y].map((i) => evenly(rangeOf(this.scene.inputs[i]), points));
      for (let j = 0; j < rows; j++) {
        for (let i = 0; i < points; i++) {
          columns[x][j * points + i] = xs[i];
          if (!flat) columns[y][j * points + i] = ys[j];
        }
      }
      const start = performance.now();
      const z = this.running.many(columns)[output];
      const cost = (performance.now() - start) / (points * rows);
      this.cost = Math.min(cost, this.cost ?? cost);
      return { xs, ys, z, rows };
    }
    /** The output shown along one input through the point; of the server's surface by its lines. */
    section(input, points = 2 * ACROSS - 1) {
      const xs = evenly(rangeOf(this.scene.inputs[input]), points);
      if (this.running) {
        const few = this.coarse ? ACROSS : points;
        const at = few === points ? xs : evenly([xs[0], xs[points - 1]], few);
        const columns = this.scene.inputs.map((_, i) => i === input ? at : new Float64Array(few).fill(this.point[i]));
        return { xs: at, z: this.running.many(columns)[this.axes.output] };
      }
      const found = this.surface();
      if (!found) return null;
      const { x, y } = this.axes;
      if (x === y) return { xs: found.xs, z: found.z };
      const other = input === x ? y : x;
      const lines = other === x ? found.xs : found.ys;
      const n = lines.length;
      const share = (this.point[other] - lines[0]) / (lines[n - 1] - lines[0]) * (n - 1);
      const low = Math.min(n - 2, Math.max(0, Math.floor(share)));
      const value = (i, k) => other === x ? found.z[i * n + k] : found.z[k * n + i];
      const z = Float64Array.from(
        { length: n },
        (_, i) => value(i, low) + (share - low) * (value(i, low + 1) - value(i, low))
      );
      return { xs: input === x ? found.xs : found.ys, z };
    }
    /**
     * What fires at the point: the strength of each rule (`strengths`) and of its lower reading
     * (`lower`), heights of the sets of each output, outputs and the ends of each; null where it is
     * not known. What the page does not compute is what the server said of this point.
     */
    fired() {
      const { scene } = this;
      let found;
      if (this.running) {
        const read = this.running.fired(this.point);
        if (!read) return null;
        const of = (rule, side) => read.strengths[rule.readings[Math.min(side, rule.readings.length - 1)]];
        found = {
          outputs: read.outputs,
          ends: scene.outputs.some((each) => each.interval) ? this.running.ends(this.point) : null,
          strengths: scene.rules.map((rule) => of(rule, 0)),
          lower: scene.rules.map((rule) => of(rule, 1)),
          all: read.strengths
        };
      } else {
        if (!this.told) return null;
        found = { ...this.told, ends: null, lower: this.told.strengths, all: this.told.strengths };
      }
      found.heights = scene.outputs.map((output) => {
        const heights = new Float64Array(output.members.length);
        for (const [member, reading] of output.asserted) {
          heights[member] = this.curves.joined(output.aggregation, heights[member], found.all[reading]);
        }
        return heights;
      });
      return found;
    }
  };

  // exported.js
  var given = JSON.parse(document.getElementById("start").textContent);
  var model = new Store();
  var listing = listingPane(given);
  var actions = {
    edit: (shapes) => listing.reshape(shapes),
    numbers: async (variable) => given.held[variable],
    setCell: null,
    goTo: null
  };
  var { root } = frame(
    model,
    /** @type {Page.Hand} */
    actions,
    listing.section,
    [
      el("strong", { textContent: given.scene.name }),
      el("span", { id: "status", textContent: given.scene.description }),
      el("span", { class: "space" }),
      el("small", { textContent: S.madeBy(given.version) })
    ]
  );
  document.body.append(root);
  model.show(given.scene);
  window.designer = { store: model };
})();
