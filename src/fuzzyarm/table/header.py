"""The header of a table as text: one record for each statement, which reads and prints it.

The header lines of ``.lut`` and ``.csv`` files are these. No numpy.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from fuzzyarm.base.diagnostic import MAX_LEVELS, Diagnostic, Figure, Related, Span, Word
from fuzzyarm.base.names import is_plain_name, near_hint, quote
from fuzzyarm.base.numbers import evenly, mirror, number_text, short_bins, short_levels
from fuzzyarm.language.tokens import Cursor, Fault, is_reserved
from fuzzyarm.table.axis import MODES, Axis, TableError, TableHeader

FORMAT = "fuzzyarm-table"
VERSION = 1


def spelled(name: str) -> str:
    """Return `name` as written in a file: in single quotes if necessary."""
    plain = is_plain_name(name) and not is_reserved(name) and name not in KEYWORDS
    return name if plain else quote(name, "'")


# --- Single lines; their combined meaning comes later ---


@dataclass(frozen=True, slots=True)
class VariableLine:
    """``input`` or ``output``: a name, maybe a range, maybe a description."""

    name: Word
    low: float | None = None
    high: float | None = None
    description: str = ""


class HeaderNumbers(NamedTuple):
    """The numbers of one ``levels`` or ``bins`` line and their positions."""

    values: tuple[float, ...]
    span: Span


@dataclass(slots=True)
class Header:
    """The lines of a header.

    `levels` and `bins` are keyed by variable name; None is for every input. `first_spans` has the
    first position of each statement.
    """

    version: Span | None = None
    inputs: dict[str, VariableLine] = field(default_factory=dict)
    output: VariableLine | None = None
    index: list[Word] = field(default_factory=list)
    index_span: Span | None = None
    levels: dict[str | None, HeaderNumbers] = field(default_factory=dict)
    bins: dict[str | None, HeaderNumbers] = field(default_factory=dict)
    named: list[Word] = field(default_factory=list)
    rounding: float | None = None
    mode: str | None = None
    origin: list[tuple[str, str]] = field(default_factory=list)
    first_spans: dict[str, Span] = field(default_factory=dict)

    def once(self, what: str, span: Span, earlier: Span | None = None) -> None:
        """Note a statement at `span`; refuse its repetition."""
        if what in self.first_spans:
            before = self.first_spans[what]
            raise Fault(
                Diagnostic(
                    "duplicate-statement",
                    f"{what} has been given already in line {before.line}",
                    span,
                    related=(Related("first given here", before),),
                )
            )
        self.first_spans[what] = earlier or span


def _fault(name: str, message: str, span: Span, hint: str = "") -> Fault:
    return Fault(Diagnostic(name, message, span, hint=hint))


def read_statement(header: Header, cursor: Cursor, diagnostics: list[Diagnostic]) -> None:
    """Read one line into `header`; a mistake is a diagnostic and affects that line alone."""
    word = cursor.take()
    try:
        _STATEMENTS[word.text].read(header, cursor, word.span)
        cursor.finish()
    except Fault as fault:
        diagnostics.append(fault.diagnostic)


# --- The statements, read and printed ---


def _read_format(header: Header, cursor: Cursor, span: Span) -> None:
    header.once("the format line", span)
    header.version = span
    version = cursor.figure("the version of the format")
    if float(version) != VERSION:
        message = f"this fuzzyarm reads version 1 of the format, not {version:g}"
        raise _fault("unknown-version", message, version.span)


def _print_format(table: TableHeader) -> list[str]:
    return [f"{FORMAT} {VERSION}"]


def _read_input(header: Header, cursor: Cursor, span: Span) -> None:
    line = _read_variable(cursor, "the name of an input", need_range=True)
    header.once(f"input '{line.name}'", span, line.name.span)
    header.inputs[line.name] = line


def _read_output(header: Header, cursor: Cursor, span: Span) -> None:
    line = _read_variable(cursor, "the name of the output", need_range=False)
    header.once("the output", span, line.name.span)
    header.output = line


def _read_variable(cursor: Cursor, what: str, *, need_range: bool) -> VariableLine:
    name = cursor.name(what)
    low = high = None
    if need_range or cursor.at_figure:
        start = cursor.span
        low = float(cursor.figure("the lower end of the range", finite=False))
        cursor.expect("..", "between the ends of the range")
        last = cursor.figure("the upper end of the range", finite=False)
        high = float(last)
        if not low <= high:
            message = f"the range of '{name}' must run upwards, not from {low:g} to {high:g}"
            raise _fault("bad-range", message, start.to(last.span))
    return VariableLine(name, low, high, str(cursor.string() or ""))


def _print_variables(table: TableHeader) -> list[str]:
    """Return the lines of inputs and output, aligned."""
    rows = [
        ("input", spelled(a.name), range_text(a.low, a.high), a.description) for a in table.axes
    ]
    rows.append(
        ("output", spelled(table.output), range_text(table.low, table.high), table.description)
    )
    names = max(len(name) for _, name, _, _ in rows)
    ranges = max(len(ends) for _, _, ends, _ in rows)
    lines = []
    for word, name, ends, description in rows:
        text = quote(description, '"') if description else ""
        lines.append(f"{word:<6}  {name:<{names}}  {ends:<{ranges}}  {text}".rstrip())
    return lines


def range_text(low: float | None, high: float | None) -> str:
    """Return a range as a header has it; empty if there is none."""
    return "" if low is None or high is None else f"{number_text(low)} .. {number_text(high)}"


def _read_index(header: Header, cursor: Cursor, span: Span) -> None:
    header.once("the index order", span, cursor.whole)
    header.index_span = cursor.whole
    words: list[str] = []
    names: list[Word] = []
    while True:
        word = cursor.word("page, row or column", ("page", "row", "column"), "unexpected-token")
        words.append(word)
        names.append(cursor.name(f"the input that is the {word}"))
        if not cursor.accept(","):
            break
    expected = index_words(len(names))
    if words != expected:
        raise _fault(
            "wrong-index-order",
            "the index order is any pages, then the row, then the column",
            cursor.whole,
            hint=f"with {len(names)} inputs: {', '.join(f'{word} NAME' for word in expected)}",
        )
    for name in names:
        header.once(f"input '{name}' in the index order", name.span)
    header.index = names


def index_words(count: int) -> list[str]:
    """Return the names of the indices of `count` inputs, in order."""
    return ["page"] * (count - 2) + ["row", "column"][-count:]


def _print_index(table: TableHeader) -> list[str]:
    pairs = zip(index_words(len(table.axes)), table.names, strict=True)
    return [f"index   {', '.join(f'{word} {spelled(name)}' for word, name in pairs)}"]


def _read_levels(header: Header, cursor: Cursor, span: Span) -> None:
    _read_numbers(header, header.levels, cursor, "levels")


def _read_bins(header: Header, cursor: Cursor, span: Span) -> None:
    _read_numbers(header, header.bins, cursor, "bins")


def _read_numbers(
    header: Header, into: dict[str | None, HeaderNumbers], cursor: Cursor, word: str
) -> None:
    names: list[Word] = []
    if not cursor.at_figure:
        names.append(cursor.name(f"the {word} as numbers, or the inputs they belong to"))
        while cursor.accept(","):
            names.append(cursor.name("the name of an input"))
        cursor.expect(":", "after the inputs")
    start = cursor.span
    values = read_number_list(cursor, word)
    numbers = HeaderNumbers(values, start.to(cursor.tokens[cursor.position - 1].span))
    for a, b in itertools.pairwise(values):
        if not a < b:
            message = f"the {word} must increase, but {b:g} follows {a:g}"
            raise _fault("not-increasing", message, numbers.span)
    header.named += names
    if not names:
        header.once(f"the {word}", numbers.span)
        into[None] = numbers
    for name in names:
        header.once(f"the {word} of '{name}'", name.span, numbers.span)
        into[name] = numbers


def read_number_list(cursor: Cursor, word: str) -> tuple[float, ...]:
    """Read ``low .. high step s``, ``low .. high count n``, or numbers, maybe ``mirrored``."""
    start = cursor.span
    first = cursor.figure(f"the {word} as numbers")
    if cursor.accept(".."):
        last = cursor.figure("the last level")
        form = cursor.word("'step' or 'count'", ("step", "count"), "unexpected-token")
        third = cursor.figure("the distance of the levels, or how many there are")
        return _even(first, last, form, third, start.to(third.span))
    values = [float(first)]
    while cursor.at_figure:
        values.append(float(cursor.figure("a number")))
    end = cursor.tokens[cursor.position - 1].span
    if not cursor.accept("mirrored"):
        return tuple(values)
    if values[0] < 0.0 or not all(a < b for a, b in itertools.pairwise(values)):
        message = f"the {word} before 'mirrored' must increase and not be negative"
        raise _fault("not-increasing", message, start.to(end))
    return mirror(values)


def _even(first: Figure, last: Figure, form: str, third: Figure, span: Span) -> tuple[float, ...]:
    low, high = float(first), float(last)
    width = high - low
    intervals = third - 1.0 if form == "count" else width / third if third > 0 else 0.0
    if intervals > MAX_LEVELS:
        message = f"an input has at most {MAX_LEVELS:,} levels"
        raise _fault("too-many-levels", message, span)
    if not (width > 0 and intervals >= 1 and abs(intervals - round(intervals)) < 1e-6):
        message = f"the {form} {third:g} does not divide the levels {low:g} .. {high:g}"
        raise _fault("bad-levels", message, span)
    return evenly(low, high, round(intervals) + 1)


def _print_levels(table: TableHeader) -> list[str]:
    texts = [(axis.name, short_levels(axis.levels)) for axis in table.axes]
    return _print_numbers("levels", texts, len(table.axes))


def _print_bins(table: TableHeader) -> list[str]:
    texts = [(axis.name, short_bins(axis.bins)) for axis in table.axes if axis.bins]
    return _print_numbers("bins", texts, len(table.axes))


def _print_numbers(word: str, texts: list[tuple[str, str]], inputs: int) -> list[str]:
    """Return one line for each distinct text, without names if it holds for every input."""
    groups: dict[str, list[str]] = {}
    for name, text in texts:
        groups.setdefault(text, []).append(spelled(name))
    if len(groups) == 1 and len(texts) == inputs:
        return [f"{word:<6}  {text}" for text in groups]
    return [f"{word:<6}  {', '.join(names)}: {text}" for text, names in groups.items()]


def _read_round(header: Header, cursor: Cursor, span: Span) -> None:
    if header.rounding is not None:
        header.once("the rounding", span)
    figure = cursor.figure("the step of the rounding")
    if figure <= 0:
        raise _fault("bad-step", "the step of the rounding must be positive", figure.span)
    header.once("the rounding", span, figure.span)
    header.rounding = float(figure)


def _print_round(table: TableHeader) -> list[str]:
    return [] if table.rounding is None else [f"round   {number_text(table.rounding)}"]


def _read_mode(header: Header, cursor: Cursor, span: Span) -> None:
    if header.mode is not None:
        header.once("the lookup mode", span)
    mode = cursor.word(f"one of {', '.join(MODES)}", MODES, "unknown-choice")
    header.once("the lookup mode", span, mode.span)
    header.mode = str(mode)


def _print_mode(table: TableHeader) -> list[str]:
    return [] if table.mode is None else [f"mode    {table.mode}"]


def _read_origin(header: Header, cursor: Cursor, span: Span) -> None:
    token = cursor.peek()
    if token is None or token.kind not in ("name", "quoted"):
        cursor.fail("a key, such as source")
    key = cursor.take()
    value = cursor.string()
    if value is None:
        cursor.fail(f"what is known of '{key.text}', in double quotes")
    header.origin.append((key.text, str(value or "")))


def _print_origin(table: TableHeader) -> list[str]:
    keys = [key if is_plain_name(key) else quote(key, "'") for key, _ in table.provenance]
    widest = max(map(len, keys), default=0)
    return [
        f"origin  {key:<{widest}}  {quote(value, chr(34))}"
        for key, (_, value) in zip(keys, table.provenance, strict=True)
    ]


class _Statement(NamedTuple):
    help: str
    read: Callable[[Header, Cursor, Span], None]
    lines: Callable[[TableHeader], list[str]]
    apart: bool = False
    """Whether an empty line is written before it."""


# In the order in which a header is written.
_STATEMENTS: dict[str, _Statement] = {
    FORMAT: _Statement("the format and its version", _read_format, _print_format),
    "input": _Statement(
        "an input: name, range, description", _read_input, _print_variables, apart=True
    ),
    "output": _Statement(  # printed with the inputs
        "the output: name, range, description", _read_output, lambda table: []
    ),
    "index": _Statement(
        "which input is the row and which the column (and the page)",
        _read_index,
        _print_index,
        apart=True,
    ),
    "levels": _Statement("the sample points of the inputs", _read_levels, _print_levels),
    "bins": _Statement("thresholds between the cells", _read_bins, _print_bins),
    "round": _Statement("the step that the values were rounded to", _read_round, _print_round),
    "mode": _Statement(
        "how the table is looked up: bins, nearest or linear", _read_mode, _print_mode
    ),
    "origin": _Statement(
        "something about the making of the table", _read_origin, _print_origin, apart=True
    ),
}

KEYWORDS = {word: statement.help for word, statement in _STATEMENTS.items()}
"""Keyword → one line for help: the words that start a line of a `.lut` file."""

# Read and printed in `text.py`, with all that follows it.
KEYWORDS["grid"] = "the values"


def header_lines(table: TableHeader) -> list[str]:
    """Return the lines of the header, from the format to the provenance."""
    out: list[str] = []
    for statement in _STATEMENTS.values():
        lines = statement.lines(table)
        out += ["", *lines] if lines and statement.apart else lines
    return out


# --- The combined meaning of the lines ---


def resolve(header: Header, diagnostics: list[Diagnostic]) -> TableHeader | None:
    """Turn the lines of a header into axes and an output; report missing ones."""
    end = header.version or Span(1, 1, 1, 2)
    output = header.output
    if output is None:
        diagnostics.append(Diagnostic("missing-output", "no line names the output", end))
    if header.index_span is None:
        diagnostics.append(
            Diagnostic(
                "missing-index-order",
                "no line names the index order, so rows and columns could be swapped",
                end,
                hint="write, for instance: index row e, column ce",
            )
        )
    if not header.index:
        return None
    _check_names(header, diagnostics)
    axes = [_axis(header, str(name), diagnostics) for name in header.index]
    axes_known = tuple(axis for axis in axes if axis is not None)
    if output is None or len(axes_known) < len(axes):
        return None
    return TableHeader(
        axes_known,
        str(output.name),
        low=output.low,
        high=output.high,
        description=output.description,
        rounding=header.rounding,
        mode=header.mode,
        provenance=tuple(header.origin),
    )


def _check_names(header: Header, diagnostics: list[Diagnostic]) -> None:
    """Report inputs missing from the index order."""
    words = list(header.index)
    for name in [*(line.name for line in header.inputs.values()), *header.named]:
        if name not in words:
            hint, replacement = near_hint(name, words)
            message = f"'{name}' is not an input of the index order ({', '.join(words)})"
            diagnostics.append(
                Diagnostic(
                    "unknown-variable", message, name.span, hint=hint, replacement=replacement
                )
            )


def _axis(header: Header, name: str, diagnostics: list[Diagnostic]) -> Axis | None:
    levels = header.levels.get(name) or header.levels.get(None)
    bins = header.bins.get(name) or header.bins.get(None)
    if levels is None:
        diagnostics.append(
            Diagnostic(
                "missing-levels",
                f"no line gives the levels of '{name}'",
                header.index_span or Span(1, 1, 1, 2),
                hint=f"write, for instance: levels {name}: -6 .. 6 step 1",
            )
        )
        return None
    count, wanted_count = len(levels.values), len(levels.values) - 1
    if bins is not None and len(bins.values) != wanted_count:
        message = (
            f"'{name}' has {count} levels and so needs {wanted_count} bins, not {len(bins.values)}"
        )
        diagnostics.append(Diagnostic("wrong-bin-count", message, bins.span))
        return None
    line = header.inputs.get(name)
    try:
        return Axis(
            name,
            levels.values,
            None if bins is None else bins.values,
            low=levels.values[0] if line is None or line.low is None else line.low,
            high=levels.values[-1] if line is None or line.high is None else line.high,
            description="" if line is None else line.description,
        )
    except TableError as error:
        diagnostics.append(Diagnostic("bad-levels", error.message, levels.span))
        return None
