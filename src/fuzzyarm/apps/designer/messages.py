"""Messages to a page, a record each, and the picture of a rule base.

They are dictionaries, ready for JSON, whose keys mypy checks where they are made;
`tools/message_types.py` prints them as types for the page. News of long work carry fields beside
those of `JobNews`; the module of each work lists them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NotRequired, TypedDict

from fuzzyarm.base.picture import PanelData


class FormField(TypedDict, total=False):
    """A field of a form, by its JSON Schema; see `fuzzyarm.requests.schema.form_fields`."""

    name: str
    title: str
    description: str
    option: str
    placeholder: str
    group: str
    unit: str
    type: str | list[str]
    enum: list[Any]
    items: dict[str, Any]
    default: Any
    minItems: int
    repeated: bool
    negatable: bool


Place = list[int]
"""Line and UTF-16 unit, from 0."""

TextRange = list[Place]
"""Start and end."""

Number = float | str
"""A number of the text; the infinite ones are words, since JSON has none."""


# --- The picture of a rule base ---


class SceneCurve(TypedDict):
    """A row function of the engine, and its numbers."""

    address: int
    numbers: list[Number]


class SceneShape(TypedDict):
    """A shape of a term, as a page draws it and lets the user move it."""

    kind: str
    parameters: list[Number]
    names: list[str]
    height: float
    centre: float | None
    curve: SceneCurve | None
    ordered: bool
    straight: bool
    handles: list[int]


class LowerShape(SceneShape):
    """The lower function of a term of interval type 2."""

    marks: list[str]


class SceneTerm(SceneShape):
    """A term; `marks` are the names of its numbers."""

    name: str
    at: Place
    marks: list[str]
    lower: LowerShape | None


class SceneVariable(TypedDict):
    """A variable; an end that is not finite is null."""

    name: str
    description: str
    low: float | None
    high: float | None
    outside: str
    terms: list[SceneTerm]


class SceneMember(TypedDict):
    """A set or a value that rules conclude."""

    term: str
    isLower: bool
    side: int
    hedged: bool
    words: str
    value: float | None
    curve: SceneCurve | None
    implication: int


class SceneOutput(SceneVariable):
    """An output, with its aggregated sets."""

    defuzzifier: str
    aggregation: int
    discrete: bool
    interval: bool
    twoSided: bool
    noRule: float | str | None
    members: list[SceneMember]
    asserted: list[list[int]]


class SceneRule(TypedDict):
    """A rule; `parts` are input, term, hedges."""

    text: str
    place: str
    written: str
    line: int
    range: TextRange
    weight: float
    at: Place
    inGrid: bool
    parts: list[list[Any]]
    readings: list[int]
    concludes: list[list[int]]
    concludesLower: list[list[int]]


class GridCell(TypedDict):
    """A cell of a grid; `rule` is the index of its rule."""

    term: str | None
    weight: str | None
    at: Place
    range: TextRange
    rule: int | None


class GridRow(TypedDict):
    """A row of a grid."""

    label: str
    cells: list[GridCell]


class SceneGrid(TypedDict):
    """A grid of rules, as written in the text."""

    line: int
    output: str
    condition: str
    row: str | None
    column: str
    columns: list[str]
    joined: bool
    range: TextRange
    rows: list[GridRow]


class Method(TypedDict, total=False):
    """A setting of inference with its choices, or the settings of a block (`block`)."""

    key: str
    value: str
    options: list[str]
    target: str
    block: str


class Scene(TypedDict):
    """The picture of a rule base.

    ``numbers`` is null where the kernel does not evaluate it; then ``reason`` says what it does not
    do.
    """

    name: str
    description: str
    inputs: list[SceneVariable]
    outputs: list[SceneOutput]
    rules: list[SceneRule]
    grids: list[SceneGrid]
    methods: list[Method]
    missing: list[str]
    numbers: dict[str, Any] | None
    kinds: Sequence[str]
    functions: list[Any]
    reason: str


class SceneBlock(TypedDict):
    """A block of a diagram; `lines` are text and style, `pins` sign and position."""

    kind: str
    round: bool
    x: float
    y: float
    width: float
    height: float
    lines: list[list[str]]
    label: str
    pins: list[list[Any]]
    at: Place | None


class Caption(TypedDict):
    """A word in a diagram."""

    text: str
    x: float
    y: float
    style: str


class SceneDiagram(TypedDict):
    """The block diagram of a controller, or of rules alone; lengths are pixels."""

    name: str
    description: str
    period: str
    width: float
    height: float
    blocks: list[SceneBlock]
    strokes: list[list[float]]
    tips: list[list[float]]
    dots: list[list[float]]
    words: list[Caption]
    uses: list[list[str]]
    isSystem: bool


class Finding(TypedDict):
    """A finding; `fixes` says of each repair whether it is the preferred one."""

    name: str
    severity: str
    message: str
    hint: str
    range: TextRange
    fixes: list[bool]


# --- Messages ---

Changes = list[Any]
"""A change set of the editor."""

Opened = TypedDict(
    "Opened",
    {
        "is": Literal["opened"],
        "file": str,
        "text": str,
        "saved": str,
        "version": int,
        "epoch": str,
        "writes": bool,
    },
)
Reopened = TypedDict(
    "Reopened",
    {
        "is": Literal["reopened"],
        "file": str,
        "version": int,
        "updates": list[dict[str, Any]],
        "saved": str,
        "writes": bool,
    },
)
Updates = TypedDict(
    "Updates",
    {"is": Literal["updates"], "file": str, "version": int, "updates": list[dict[str, Any]]},
)
Findings = TypedDict(
    "Findings",
    {
        "is": Literal["findings"],
        "file": NotRequired[str],
        "version": int | None,
        "summary": str,
        "findings": list[Finding],
        "more": int,
        "colours": list[list[Any]],
        "verdicts": list[list[Any]],
    },
)
SceneMessage = TypedDict(
    "SceneMessage",
    {
        "is": Literal["scene"],
        "file": NotRequired[str],
        "version": int | None,
        "scene": Scene | None,
        "why": Literal["mistakes", "other"],
        "diagram": SceneDiagram | None,
    },
)
Status = TypedDict(
    "Status",
    {
        "is": Literal["status"],
        "file": str,
        "dirty": bool,
        "gone": bool,
        "conflict": bool,
        "unreadable": str,
        "elsewhere": bool,
        "mergeable": bool,
        "version": int,
        "saved": NotRequired[str],
        "reread": NotRequired[bool],
    },
)
Writer = TypedDict("Writer", {"is": Literal["writer"], "file": str, "writes": bool})
Moved = TypedDict("Moved", {"is": Literal["moved"], "file": str, "to": str})
Names = TypedDict("Names", {"is": Literal["names"], "names": list[str], "first": str})
Unsaved = TypedDict("Unsaved", {"is": Literal["unsaved"], "names": list[str]})
Stored = TypedDict("Stored", {"is": Literal["stored"], "file": str, "text": str})
Answer = TypedDict(
    "Answer",
    {"is": Literal["answer"], "id": int, "error": NotRequired[str], "internal": NotRequired[bool]},
)
JobNews = TypedDict(
    "JobNews",
    {
        "is": Literal["job"],
        "id": int,
        "doing": NotRequired[str],
        "end": NotRequired[Literal["done", "stopped", "failed"]],
        "message": NotRequired[str],
        "field": NotRequired[str],
        "internal": NotRequired[bool],
    },
)
Failed = TypedDict(
    "Failed",
    {
        "is": Literal["failed"],
        "file": NotRequired[str],
        "message": str,
        "internal": NotRequired[bool],
    },
)

HEARD = (
    Opened,
    Reopened,
    Updates,
    Writer,
    Findings,
    SceneMessage,
    Status,
    Moved,
    Names,
    Unsaved,
    Stored,
    Answer,
    JobNews,
    Failed,
    FormField,
    PanelData,
)
"""All messages that a page hears."""

OPEN = (Answer, JobNews)
"""Those with further fields."""
