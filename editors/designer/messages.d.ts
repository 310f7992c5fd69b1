// What the designer's page says and hears. Printed by tools/message_types.py from the records of
// fuzzyarm.apps.designer.requests and fuzzyarm.apps.designer.messages; `make types` prints it anew.

declare namespace Messages {
  /** A question without fields. */
  interface BareMessage {
  }

  /** A window shows a file; with its own text, if it had the file open before. */
  interface Open {
    file: string;
    epoch?: string;
    version?: number;
    text?: string | null;
    saved?: string;
    wrote?: boolean;
    asked?: Array<string>;
  }

  /** Messages about a file: `close`, `write`, and `ask` and `start` before their own fields. */
  interface OfFile {
    file: string;
  }

  /** Changes of a text, made for a version. */
  interface Push {
    file: string;
    version: number;
    updates: Array<Record<string, any>>;
  }

  /** A question about a text, with the number of its answer. */
  interface TextQuestion {
    file: string;
    id: number;
    what: string;
  }

  /** Save a file; with an `id` it is answered. */
  interface Save {
    file: string;
    id?: number | null;
  }

  /** End a conflict: with the text of the windows, the other one, or the lines of both. */
  interface Settle {
    file: string;
    keep: "mine" | "theirs" | "both";
  }

  /** Long work on a text, with the page's own number of it. */
  interface StartWork {
    file: string;
    id: number;
    what: string;
  }

  /** Messages to long work: `stop`, and `say` before its words. */
  interface OfJob {
    id: number;
  }

  /** A question about the folder, with the number of its answer. */
  interface FolderQuestion {
    id: number;
    what: string;
  }

  /** `complete` and `hover`. */
  interface At {
    at: [number, number];
  }

  /** The name at a position; with another name, the edit that renames it. */
  interface Rename {
    at: [number, number];
    name?: string | null;
  }

  /** The repairs of a finding, or of all in a line. */
  interface Fixes {
    at: [number, number];
    name?: string | null;
  }

  /** The change from one text to another, for the present text. */
  interface Merge {
    old: string;
    new: string;
  }

  /** The shape of a term. */
  interface ShapeOf {
    kind: string;
    parameters: Array<number | "inf" | "-inf">;
    height?: number | "inf" | "-inf";
  }

  /** The new shape of a term; of interval type 2 with the lower one. */
  interface TermShape {
    kind: string;
    parameters: Array<number | "inf" | "-inf">;
    height?: number | "inf" | "-inf";
    variable: string;
    term: string;
    lower?: ShapeOf | null;
  }

  /** Terms moved by the user. */
  interface Shapes {
    shapes: Array<TermShape>;
  }

  /** Another kind or name of a term, a new one with its shape; else it is removed. */
  interface TermEdit {
    variable: string;
    term: string;
    kind?: string | null;
    shape?: ShapeOf | null;
    name?: string | null;
  }

  /** A new variable with its role, range and terms, or another name; else it is removed. */
  interface VariableEdit {
    variable: string;
    role?: string | null;
    low?: number | "inf" | "-inf";
    high?: number | "inf" | "-inf";
    terms?: Array<string>;
    name?: string | null;
  }

  /** A method of inference, of one output or of all. */
  interface SettingEdit {
    key: string;
    value: string;
    target: string;
  }

  /** A new grid; with `line` the one there is removed. */
  interface GridEdit {
    line?: number | null;
    output?: string;
    column?: string;
    row?: string;
    fill?: string;
  }

  /** A row or a column of a grid, maybe of a new term; or it is removed. */
  interface HeadEdit {
    line: number;
    term: string;
    row: boolean;
    remove?: boolean;
    shape?: ShapeOf | null;
  }

  /** A rule of pairs of variables and terms. */
  interface Compose {
    if: Array<[string, string]>;
    then: Array<[string, string]>;
    join?: string;
  }

  /** The range of a variable. */
  interface RangeEdit {
    variable: string;
    low: number | "inf" | "-inf";
    high: number | "inf" | "-inf";
  }

  /** A term of a cell, by line and column from 1; none removes its rule. */
  interface CellEdit {
    cell: [number, number];
    term?: string | null;
  }

  /** The numbers of a gain. */
  interface GainEdit {
    name: string;
    values: Array<number | "inf" | "-inf">;
  }

  /** A sentence in a line; a new one without a line; removal if empty. */
  interface RuleEdit {
    sentence: string;
    line?: number | null;
  }

  /** The numbers of a rule base while the user moves the terms of a variable. */
  interface OfVariable {
    variable: string;
  }

  /** A page of a table: a level of each axis but the last two. */
  interface TablePage {
    page?: Array<number>;
  }

  /** The position of a number in a table, by its indices. */
  interface TableCell {
    cell: Array<number>;
  }

  /** A new file of a kind, or of an example; a controller around a rule base. */
  interface NewFile {
    name: string;
    kind: string;
    around?: string;
    method?: "mamdani" | "sugeno";
  }

  /** A file, and the name of its copy or its own new one. */
  interface Naming {
    file: string;
    name: string;
  }

  /** A file of another program, in base 64. */
  interface Import {
    name: string;
    data: string;
  }

  /** A file of another program in the folder. */
  interface Convert {
    name: string;
  }

  /** A partly filled form, to judge, and its file. */
  interface FormQuestion {
    file: string;
    form: string;
    values: Record<string, boolean | number | "inf" | "-inf" | string | Array<string> | null>;
  }

  /** Which inputs lie across and up, by name, and the values of the others. */
  interface SurfaceAxes {
    x?: string | null;
    y?: string | null;
    at?: Record<string, number | "inf" | "-inf" | null>;
  }

  /** Another file for the comparison. */
  interface CompareWork {
    other: string;
    output?: string;
    axes?: SurfaceAxes;
  }

  /** The suffix of an export; the fields of its dialog by name. */
  interface ExportWork {
    suffix: string;
    options?: Record<string, boolean | number | "inf" | "-inf" | string | Array<string> | null>;
  }

  /** A surface through a point. */
  interface SurfaceWork {
    point: Array<number | "inf" | "-inf">;
    x: number;
    y: number;
    ends: [[number | "inf" | "-inf", number | "inf" | "-inf"], [number | "inf" | "-inf", number | "inf" | "-inf"]];
    output: number;
    across: number;
    fired?: boolean;
  }

  /** A training. */
  interface LearnWork {
    form?: Record<string, boolean | number | "inf" | "-inf" | string | Array<string> | null>;
    step?: boolean;
    speed?: "watch" | "fast";
  }

  /** How a table is made of a rule base, and over which inputs it is compared. */
  interface TableErrorWork {
    options?: Record<string, boolean | number | "inf" | "-inf" | string | Array<string> | null>;
    axes?: SurfaceAxes;
  }

  /** Work from a form alone; see `fuzzyarm.apps.designer.forms`. */
  interface FormWork {
    form?: Record<string, boolean | number | "inf" | "-inf" | string | Array<string> | null>;
  }

  /** A statement to prove; see `fuzzyarm.apps.designer.forms.PROVE`. */
  interface ProveWork {
    form?: Record<string, boolean | number | "inf" | "-inf" | string | Array<string> | null>;
    certificate?: boolean;
  }

  /** A run. */
  interface RunWork {
    form?: Record<string, boolean | number | "inf" | "-inf" | string | Array<string> | null>;
    until?: string;
    window?: string;
    speed?: number | "inf" | "-inf" | null;
    paused?: boolean;
    calm?: boolean;
  }

  /** Which plants a text fits: that of now, if it is another one than the session's. */
  interface PlantsWork {
    text?: string | null;
  }

  /** Actions of the user on a run. */
  interface RunWord {
    speed?: number | "inf" | "-inf" | null;
    pause?: boolean | null;
    calm?: boolean | null;
    pull?: [number | "inf" | "-inf", number | "inf" | "-inf"] | null;
    gains?: Record<string, Array<number | "inf" | "-inf">> | null;
    text?: string | null;
    step?: number | null;
    restart?: boolean;
    asked?: RunWork | null;
  }

  /** Actions of the user on a training; `save` is the name of a table. */
  interface LearnWord {
    go?: "run" | "pause" | "step" | "stop" | null;
    speed?: "watch" | "fast" | null;
    save?: string | null;
    replace?: boolean;
  }

  /** Actions of the user on a search: end it, or take its result. */
  interface TuneWord {
    enough?: boolean;
    take?: boolean;
    replace?: boolean;
  }

  /** Actions of the user on a fit: end it; `save` is the name of a rule base. */
  interface FitWord {
    enough?: boolean;
    save?: string | null;
    replace?: boolean;
  }

  /** Actions of the user on a sweep: end it, and keep its runs. */
  interface SweepWord {
    enough?: boolean;
  }

  interface Opened {
    is: "opened";
    file: string;
    text: string;
    saved: string;
    version: number;
    epoch: string;
    writes: boolean;
  }

  interface Reopened {
    is: "reopened";
    file: string;
    version: number;
    updates: Array<Record<string, any>>;
    saved: string;
    writes: boolean;
  }

  interface Updates {
    is: "updates";
    file: string;
    version: number;
    updates: Array<Record<string, any>>;
  }

  interface Writer {
    is: "writer";
    file: string;
    writes: boolean;
  }

  /** A finding; `fixes` says of each repair whether it is the preferred one. */
  interface Finding {
    name: string;
    severity: string;
    message: string;
    hint: string;
    range: Array<Array<number>>;
    fixes: Array<boolean>;
  }

  interface Findings {
    is: "findings";
    file?: string;
    version: number | null;
    summary: string;
    findings: Array<Finding>;
    more: number;
    colours: Array<Array<any>>;
    verdicts: Array<Array<any>>;
  }

  /** A row function of the engine, and its numbers. */
  interface SceneCurve {
    address: number;
    numbers: Array<number | string>;
  }

  /** The lower function of a term of interval type 2. */
  interface LowerShape {
    kind: string;
    parameters: Array<number | string>;
    names: Array<string>;
    height: number;
    centre: number | null;
    curve: SceneCurve | null;
    ordered: boolean;
    straight: boolean;
    handles: Array<number>;
    marks: Array<string>;
  }

  /** A term; `marks` are the names of its numbers. */
  interface SceneTerm {
    kind: string;
    parameters: Array<number | string>;
    names: Array<string>;
    height: number;
    centre: number | null;
    curve: SceneCurve | null;
    ordered: boolean;
    straight: boolean;
    handles: Array<number>;
    name: string;
    at: Array<number>;
    marks: Array<string>;
    lower: LowerShape | null;
  }

  /** A variable; an end that is not finite is null. */
  interface SceneVariable {
    name: string;
    description: string;
    low: number | null;
    high: number | null;
    outside: string;
    terms: Array<SceneTerm>;
  }

  /** A set or a value that rules conclude. */
  interface SceneMember {
    term: string;
    isLower: boolean;
    side: number;
    hedged: boolean;
    words: string;
    value: number | null;
    curve: SceneCurve | null;
    implication: number;
  }

  /** An output, with its aggregated sets. */
  interface SceneOutput {
    name: string;
    description: string;
    low: number | null;
    high: number | null;
    outside: string;
    terms: Array<SceneTerm>;
    defuzzifier: string;
    aggregation: number;
    discrete: boolean;
    interval: boolean;
    twoSided: boolean;
    noRule: number | string | null;
    members: Array<SceneMember>;
    asserted: Array<Array<number>>;
  }

  /** A rule; `parts` are input, term, hedges. */
  interface SceneRule {
    text: string;
    place: string;
    written: string;
    line: number;
    range: Array<Array<number>>;
    weight: number;
    at: Array<number>;
    inGrid: boolean;
    parts: Array<Array<any>>;
    readings: Array<number>;
    concludes: Array<Array<number>>;
    concludesLower: Array<Array<number>>;
  }

  /** A cell of a grid; `rule` is the index of its rule. */
  interface GridCell {
    term: string | null;
    weight: string | null;
    at: Array<number>;
    range: Array<Array<number>>;
    rule: number | null;
  }

  /** A row of a grid. */
  interface GridRow {
    label: string;
    cells: Array<GridCell>;
  }

  /** A grid of rules, as written in the text. */
  interface SceneGrid {
    line: number;
    output: string;
    condition: string;
    row: string | null;
    column: string;
    columns: Array<string>;
    joined: boolean;
    range: Array<Array<number>>;
    rows: Array<GridRow>;
  }

  /** A setting of inference with its choices, or the settings of a block (`block`). */
  interface Method {
    key?: string;
    value?: string;
    options?: Array<string>;
    target?: string;
    block?: string;
  }

  /** The picture of a rule base. */
  interface Scene {
    name: string;
    description: string;
    inputs: Array<SceneVariable>;
    outputs: Array<SceneOutput>;
    rules: Array<SceneRule>;
    grids: Array<SceneGrid>;
    methods: Array<Method>;
    missing: Array<string>;
    numbers: Record<string, any> | null;
    kinds: Array<string>;
    functions: Array<any>;
    reason: string;
  }

  /** A block of a diagram; `lines` are text and style, `pins` sign and position. */
  interface SceneBlock {
    kind: string;
    round: boolean;
    x: number;
    y: number;
    width: number;
    height: number;
    lines: Array<Array<string>>;
    label: string;
    pins: Array<Array<any>>;
    at: Array<number> | null;
  }

  /** A word in a diagram. */
  interface Caption {
    text: string;
    x: number;
    y: number;
    style: string;
  }

  /** The block diagram of a controller, or of rules alone; lengths are pixels. */
  interface SceneDiagram {
    name: string;
    description: string;
    period: string;
    width: number;
    height: number;
    blocks: Array<SceneBlock>;
    strokes: Array<Array<number>>;
    tips: Array<Array<number>>;
    dots: Array<Array<number>>;
    words: Array<Caption>;
    uses: Array<Array<string>>;
    isSystem: boolean;
  }

  interface SceneMessage {
    is: "scene";
    file?: string;
    version: number | null;
    scene: Scene | null;
    why: "mistakes" | "other";
    diagram: SceneDiagram | null;
  }

  interface Status {
    is: "status";
    file: string;
    dirty: boolean;
    gone: boolean;
    conflict: boolean;
    unreadable: string;
    elsewhere: boolean;
    mergeable: boolean;
    version: number;
    saved?: string;
    reread?: boolean;
  }

  interface Moved {
    is: "moved";
    file: string;
    to: string;
  }

  interface Names {
    is: "names";
    names: Array<string>;
    first: string;
  }

  interface Unsaved {
    is: "unsaved";
    names: Array<string>;
  }

  interface Stored {
    is: "stored";
    file: string;
    text: string;
  }

  interface Answer {
    is: "answer";
    id: number;
    error?: string;
    internal?: boolean;
    [key: string]: any;
  }

  interface JobNews {
    is: "job";
    id: number;
    doing?: string;
    end?: "done" | "stopped" | "failed";
    message?: string;
    field?: string;
    internal?: boolean;
    [key: string]: any;
  }

  interface Failed {
    is: "failed";
    file?: string;
    message: string;
    internal?: boolean;
  }

  /** A field of a form, by its JSON Schema; see `fuzzyarm.requests.schema.form_fields`. */
  interface FormField {
    name?: string;
    title?: string;
    description?: string;
    option?: string;
    placeholder?: string;
    group?: string;
    unit?: string;
    type?: string | Array<string>;
    enum?: Array<any>;
    items?: Record<string, any>;
    default?: any;
    minItems?: number;
    repeated?: boolean;
    negatable?: boolean;
  }

  /** An axis for a page, with both ends. */
  interface AxisData {
    words: string;
    low: number;
    high: number;
    logarithmic: boolean;
    whole: boolean;
  }

  interface PartData {
    is?: string;
    x?: Array<number | null>;
    y?: Array<number | null>;
    low?: Array<number | null>;
    high?: Array<number | null>;
    tone?: string;
    width?: number;
    dash?: string;
    label?: string;
    steps?: boolean;
    opacity?: number;
    sign?: string;
    size?: number;
    edge?: number;
    at?: number | null;
    upright?: boolean;
    values?: Array<number | null>;
    value?: AxisData;
    downward?: boolean;
    signed?: boolean;
    missing?: string;
  }

  /** A panel for a page. */
  interface PanelData {
    title: string;
    across: AxisData;
    up: AxisData;
    parts: Array<PartData>;
    equal: boolean;
  }

  interface Commands {
    "hello": BareMessage;
    "open": Open;
    "close": OfFile;
    "push": Push;
    "ask": TextQuestion;
    "save": Save;
    "settle": Settle;
    "write": OfFile;
    "start": StartWork;
    "say": OfJob;
    "stop": OfJob;
    "folder": FolderQuestion;
  }

  interface TextQuestions {
    "complete": At;
    "hover": At;
    "rename": Rename;
    "fixes": Fixes;
    "format": BareMessage;
    "merge": Merge;
    "movable": BareMessage;
    "shapes": Shapes;
    "term": TermEdit;
    "variable": VariableEdit;
    "setting": SettingEdit;
    "grid": GridEdit;
    "head": HeadEdit;
    "compose": Compose;
    "range": RangeEdit;
    "cell": CellEdit;
    "gain": GainEdit;
    "rule": RuleEdit;
    "numbers": OfVariable;
    "table": TablePage;
    "table-cell": TableCell;
    "exports": BareMessage;
  }

  interface FolderQuestions {
    "list": BareMessage;
    "new": NewFile;
    "adopt": OfFile;
    "samples": BareMessage;
    "duplicate": Naming;
    "rename": Naming;
    "delete": OfFile;
    "users": OfFile;
    "carried": OfFile;
    "findings": OfFile;
    "import": Import;
    "convert": Convert;
    "judge": FormQuestion;
  }

  interface Works {
    "compare": CompareWork;
    "export": ExportWork;
    "surface": SurfaceWork;
    "learnable": BareMessage;
    "learn": LearnWork;
    "table-error": TableErrorWork;
    "tunable": BareMessage;
    "tune": FormWork;
    "sheets": BareMessage;
    "sweepable": BareMessage;
    "sweep": FormWork;
    "fittable": BareMessage;
    "fit": FormWork;
    "opened-loop": BareMessage;
    "margins": FormWork;
    "provable": BareMessage;
    "prove": ProveWork;
    "run": RunWork;
    "plants": PlantsWork;
  }

  interface Words {
    "run": RunWord;
    "learn": LearnWord;
    "tune": TuneWord;
    "fit": FitWord;
    "sweep": SweepWord;
  }

  type Heard =
    | Opened
    | Reopened
    | Updates
    | Writer
    | Findings
    | SceneMessage
    | Status
    | Moved
    | Names
    | Unsaved
    | Stored
    | Answer
    | JobNews
    | Failed
    | FormField
    | PanelData;
}
