"""Messages of a page, a record each: commands, questions, long work, and messages to such work.

Messages are JSON objects, in both directions. ``do`` of an object names its record in `COMMANDS`;
``what`` of a question or of work names one more, in `TEXT_QUESTIONS`, `FOLDER_QUESTIONS` or
`WORKS`.
`fuzzyarm.apps.designer.records` reads them, `tools/message_types.py` prints them as types for the
page.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from fuzzyarm.apps.designer.records import ABSENT, Absent

Position = tuple[int, int]
"""Line and UTF-16 unit, from 0."""

Pair = tuple[str, str]
"""A variable and a term."""

FormValue = bool | float | str | tuple[str, ...] | None
"""A value of a form; the request's reader reports a mistake at its field."""

FormValues = Mapping[str, FormValue]
"""The fields of a request by name (`fuzzyarm.apps.designer.forms`)."""


@dataclass(frozen=True)
class BareMessage:
    """A question without fields."""


# --- Commands ---


@dataclass(frozen=True)
class Open:
    """A window shows a file; with its own text, if it had the file open before.

    `wrote` is whether it was the writer then, and `asked` are texts to save without a known result.
    """

    file: str
    epoch: str = ""
    version: int = 0
    text: str | None = None
    saved: str = ""
    wrote: bool = False
    asked: tuple[str, ...] = ()


@dataclass(frozen=True)
class OfFile:
    """Messages about a file: `close`, `write`, and `ask` and `start` before their own fields."""

    file: str


@dataclass(frozen=True)
class Push:
    """Changes of a text, made for a version."""

    file: str
    version: int
    updates: tuple[Mapping[str, Any], ...]


@dataclass(frozen=True)
class Save:
    """Save a file; with an `id` it is answered."""

    file: str
    id: int | None = None


@dataclass(frozen=True)
class Settle:
    """End a conflict: with the text of the windows, the other one, or the lines of both."""

    file: str
    keep: Literal["mine", "theirs", "both"]


@dataclass(frozen=True)
class TextQuestion:
    """A question about a text, with the number of its answer."""

    file: str
    id: int
    what: str


@dataclass(frozen=True)
class FolderQuestion:
    """A question about the folder, with the number of its answer."""

    id: int
    what: str


@dataclass(frozen=True)
class StartWork:
    """Long work on a text, with the page's own number of it."""

    file: str
    id: int
    what: str


@dataclass(frozen=True)
class OfJob:
    """Messages to long work: `stop`, and `say` before its words."""

    id: int


COMMANDS: Mapping[str, type] = {
    "hello": BareMessage,
    "open": Open,
    "close": OfFile,
    "push": Push,
    "ask": TextQuestion,
    "save": Save,
    "settle": Settle,
    "write": OfFile,
    "start": StartWork,
    "say": OfJob,
    "stop": OfJob,
    "folder": FolderQuestion,
}


# --- Questions about a text ---


@dataclass(frozen=True)
class At:
    """`complete` and `hover`."""

    at: Position


@dataclass(frozen=True)
class Rename:
    """The name at a position; with another name, the edit that renames it."""

    at: Position
    name: str | None = None


@dataclass(frozen=True)
class Fixes:
    """The repairs of a finding, or of all in a line."""

    at: Position
    name: str | None = None


@dataclass(frozen=True)
class Merge:
    """The change from one text to another, for the present text."""

    old: str
    new: str


@dataclass(frozen=True)
class ShapeOf:
    """The shape of a term."""

    kind: str
    parameters: tuple[float, ...]
    height: float = 1.0


@dataclass(frozen=True)
class TermShape(ShapeOf):
    """The new shape of a term; of interval type 2 with the lower one."""

    variable: str = field(kw_only=True)
    term: str = field(kw_only=True)
    lower: ShapeOf | None = field(default=None, kw_only=True)


@dataclass(frozen=True)
class Shapes:
    """Terms moved by the user."""

    shapes: tuple[TermShape, ...]


@dataclass(frozen=True)
class TermEdit:
    """Another kind or name of a term, a new one with its shape; else it is removed."""

    variable: str
    term: str
    kind: str | None = None
    shape: ShapeOf | None = None
    name: str | None = None


@dataclass(frozen=True)
class VariableEdit:
    """A new variable with its role, range and terms, or another name; else it is removed."""

    variable: str
    role: str | None = None
    low: float = 0.0
    high: float = 1.0
    terms: tuple[str, ...] = ()
    name: str | None = None


@dataclass(frozen=True)
class SettingEdit:
    """A method of inference, of one output or of all."""

    key: str
    value: str
    target: str


@dataclass(frozen=True)
class GridEdit:
    """A new grid; with `line` the one there is removed."""

    line: int | None = None
    output: str = ""
    column: str = ""
    row: str = ""
    fill: str = ""


@dataclass(frozen=True)
class HeadEdit:
    """A row or a column of a grid, maybe of a new term; or it is removed."""

    line: int
    term: str
    row: bool
    remove: bool = False
    shape: ShapeOf | None = None


@dataclass(frozen=True)
class Compose:
    """A rule of pairs of variables and terms."""

    if_: tuple[Pair, ...]
    then: tuple[Pair, ...]
    join: str = "and"


@dataclass(frozen=True)
class RangeEdit:
    """The range of a variable."""

    variable: str
    low: float
    high: float


@dataclass(frozen=True)
class CellEdit:
    """A term of a cell, by line and column from 1; none removes its rule."""

    cell: Position
    term: str | None = None


@dataclass(frozen=True)
class GainEdit:
    """The numbers of a gain."""

    name: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class RuleEdit:
    """A sentence in a line; a new one without a line; removal if empty."""

    sentence: str
    line: int | None = None


@dataclass(frozen=True)
class OfVariable:
    """The numbers of a rule base while the user moves the terms of a variable."""

    variable: str


@dataclass(frozen=True)
class TablePage:
    """A page of a table: a level of each axis but the last two."""

    page: tuple[int, ...] = ()


@dataclass(frozen=True)
class TableCell:
    """The position of a number in a table, by its indices."""

    cell: tuple[int, ...]


TEXT_QUESTIONS: Mapping[str, type] = {
    "complete": At,
    "hover": At,
    "rename": Rename,
    "fixes": Fixes,
    "format": BareMessage,
    "merge": Merge,
    "movable": BareMessage,
    "shapes": Shapes,
    "term": TermEdit,
    "variable": VariableEdit,
    "setting": SettingEdit,
    "grid": GridEdit,
    "head": HeadEdit,
    "compose": Compose,
    "range": RangeEdit,
    "cell": CellEdit,
    "gain": GainEdit,
    "rule": RuleEdit,
    "numbers": OfVariable,
    "table": TablePage,
    "table-cell": TableCell,
    "exports": BareMessage,
}


# --- Questions about the folder ---


@dataclass(frozen=True)
class NewFile:
    """A new file of a kind, or of an example; a controller around a rule base."""

    name: str
    kind: str
    around: str = ""
    method: Literal["mamdani", "sugeno"] = "mamdani"


@dataclass(frozen=True)
class Naming:
    """A file, and the name of its copy or its own new one."""

    file: str
    name: str


@dataclass(frozen=True)
class Import:
    """A file of another program, in base 64."""

    name: str
    data: str


@dataclass(frozen=True)
class Convert:
    """A file of another program in the folder."""

    name: str


@dataclass(frozen=True)
class FormQuestion:
    """A partly filled form, to judge, and its file."""

    file: str
    form: str
    values: FormValues


FOLDER_QUESTIONS: Mapping[str, type] = {
    "list": BareMessage,
    "new": NewFile,
    "adopt": OfFile,
    "samples": BareMessage,
    "duplicate": Naming,
    "rename": Naming,
    "delete": OfFile,
    "users": OfFile,
    "carried": OfFile,
    "findings": OfFile,
    "import": Import,
    "convert": Convert,
    "judge": FormQuestion,
}


# --- Long work ---


@dataclass(frozen=True)
class SurfaceAxes:
    """Which inputs lie across and up, by name, and the values of the others."""

    x: str | None = None
    y: str | None = None
    at: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True)
class SurfaceWork:
    """A surface through a point.

    Attributes
    ----------
    point : tuple of float
        The inputs in their order.
    x, y : int
        Which inputs vary; equal for a line.
    ends : tuple
        Of both axes.
    output : int
        Which output.
    across : int
        Points along an axis.
    fired : bool
        Whether to return the point too.
    """

    point: tuple[float, ...]
    x: int
    y: int
    ends: tuple[tuple[float, float], tuple[float, float]]
    output: int
    across: int
    fired: bool = False


@dataclass(frozen=True)
class CompareWork:
    """Another file for the comparison."""

    other: str
    output: str = ""
    axes: SurfaceAxes = field(default_factory=SurfaceAxes)


@dataclass(frozen=True)
class ExportWork:
    """The suffix of an export; the fields of its dialog by name."""

    suffix: str
    options: FormValues = field(default_factory=dict)


@dataclass(frozen=True)
class TableErrorWork:
    """How a table is made of a rule base, and over which inputs it is compared."""

    options: FormValues = field(default_factory=dict)
    axes: SurfaceAxes = field(default_factory=SurfaceAxes)


@dataclass(frozen=True)
class RunWork:
    """A run.

    Attributes
    ----------
    form : mapping
        See `fuzzyarm.apps.designer.forms.RUN`.
    until, window : str
        The time to stop at, or how much stays in view; for forms without a duration.
    speed : float or None
        Simulated for real time; None is as fast as possible.
    calm : bool
        Whether to send few pictures.
    """

    form: FormValues = field(default_factory=dict)
    until: str = ""
    window: str = ""
    speed: float | None = None
    paused: bool = False
    calm: bool = False


@dataclass(frozen=True)
class PlantsWork:
    """Which plants a text fits: that of now, if it is another one than the session's."""

    text: str | None = None


@dataclass(frozen=True)
class LearnWork:
    """A training.

    Attributes
    ----------
    form : mapping
        See `fuzzyarm.apps.designer.forms.LEARN`; without a controller it is that of the text.
    step : bool
        Whether to wait after the first pass.
    speed : str
        How it is watched.
    """

    form: FormValues = field(default_factory=dict)
    step: bool = False
    speed: Literal["watch", "fast"] = "watch"


@dataclass(frozen=True)
class FormWork:
    """Work from a form alone; see `fuzzyarm.apps.designer.forms`."""

    form: FormValues = field(default_factory=dict)


@dataclass(frozen=True)
class ProveWork:
    """A statement to prove; see `fuzzyarm.apps.designer.forms.PROVE`.

    Attributes
    ----------
    certificate : bool
        Whether proofs about a loop get a certificate for the page to load.
    """

    form: FormValues = field(default_factory=dict)
    certificate: bool = False


WORKS: Mapping[str, type] = {
    "compare": CompareWork,
    "export": ExportWork,
    "surface": SurfaceWork,
    "learnable": BareMessage,
    "learn": LearnWork,
    "table-error": TableErrorWork,
    "tunable": BareMessage,
    "tune": FormWork,
    "sheets": BareMessage,
    "sweepable": BareMessage,
    "sweep": FormWork,
    "fittable": BareMessage,
    "fit": FormWork,
    "opened-loop": BareMessage,
    "margins": FormWork,
    "provable": BareMessage,
    "prove": ProveWork,
    "run": RunWork,
    "plants": PlantsWork,
}


# --- Words to long work ---


@dataclass(frozen=True)
class RunWord:
    """Actions of the user on a run.

    Attributes
    ----------
    speed : float or None
        As of `RunWork`.
    step : int
        Samples.
    pull : tuple of float or None
        To the right and up, -1 to 1.
    gains : mapping
        Values by name.
    text : str
        The present text.
    restart : bool
        To begin anew, with what is `asked` for, if it says so.
    """

    # None says something here, as fast as possible or that the hand lets go: what is not said needs
    # a value of its own.
    speed: float | Absent | None = ABSENT
    pause: bool | None = None
    calm: bool | None = None
    pull: tuple[float, float] | Absent | None = ABSENT
    gains: Mapping[str, tuple[float, ...]] | None = None
    text: str | None = None
    step: int | None = None
    restart: bool = False
    asked: RunWork | None = None


@dataclass(frozen=True)
class LearnWord:
    """Actions of the user on a training; `save` is the name of a table."""

    go: Literal["run", "pause", "step", "stop"] | None = None
    speed: Literal["watch", "fast"] | None = None
    save: str | None = None
    replace: bool = False


@dataclass(frozen=True)
class TuneWord:
    """Actions of the user on a search: end it, or take its result."""

    enough: bool = False
    take: bool = False
    replace: bool = False


@dataclass(frozen=True)
class FitWord:
    """Actions of the user on a fit: end it; `save` is the name of a rule base."""

    enough: bool = False
    save: str | None = None
    replace: bool = False


@dataclass(frozen=True)
class SweepWord:
    """Actions of the user on a sweep: end it, and keep its runs."""

    enough: bool = False


WORDS: Mapping[str, type] = {
    "run": RunWord, "learn": LearnWord, "tune": TuneWord, "fit": FitWord, "sweep": SweepWord,
}  # fmt: skip
