"""Read the statements of a ``.lut`` header into a loose record; what they mean comes later."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field

from fuzzyarm.lut.axis import MODES
from fuzzyarm.lut.numbers import evenly, mirror
from fuzzyarm.rulebase.diagnostic import Diagnostic, Related, Span
from fuzzyarm.rulebase.limits import MAX_LEVELS
from fuzzyarm.rulebase.near import near_hint
from fuzzyarm.rulebase.syntax.cursor import Cursor, Fault
from fuzzyarm.rulebase.syntax.nodes import Figure, Word

VERSIONS = (1.0,)


@dataclass(frozen=True, slots=True)
class VariableLine:
    """``input`` or ``output``: a name, maybe a range, maybe a description."""

    name: Word
    low: float | None = None
    high: float | None = None
    description: str = ""


@dataclass(frozen=True, slots=True)
class Numbers:
    """The numbers of one ``levels`` or ``bins`` line and their place."""

    values: tuple[float, ...]
    span: Span


@dataclass(slots=True)
class Header:
    """What the lines of a header say, each thing once.

    `levels` and `bins` are keyed by variable name; None stands for every input.
    """

    version: Span | None = None
    inputs: dict[str, VariableLine] = field(default_factory=dict)
    output: VariableLine | None = None
    index: list[tuple[str, Word]] = field(default_factory=list)
    index_span: Span | None = None
    levels: dict[str | None, Numbers] = field(default_factory=dict)
    bins: dict[str | None, Numbers] = field(default_factory=dict)
    named: list[Word] = field(default_factory=list)
    rounding: Figure | None = None
    mode: Word | None = None
    origin: list[tuple[str, str]] = field(default_factory=list)


def read_statement(header: Header, cursor: Cursor, diagnostics: list[Diagnostic]) -> None:
    """Read one line into `header`; a mistake goes to `diagnostics` and spoils that line alone."""
    word = cursor.take()
    try:
        _READERS[word.text](header, cursor, word.span)
        cursor.finish()
    except Fault as fault:
        diagnostics.append(fault.diagnostic)


def _read_format(header: Header, cursor: Cursor, span: Span) -> None:
    _once(header.version, span, "the format line")
    header.version = span
    version = cursor.figure("the version of the format")
    if version.value not in VERSIONS:
        raise Fault(
            Diagnostic(
                "unknown-version",
                f"this fuzzyarm reads version 1 of the format, not {version.value:g}",
                version.span,
            )
        )


def _read_input(header: Header, cursor: Cursor, span: Span) -> None:
    line = _read_variable(cursor, "the name of an input", need_range=True)
    name = line.name.text
    _once(header.inputs[name].name.span if name in header.inputs else None, span, f"input '{name}'")
    header.inputs[name] = line


def _read_output(header: Header, cursor: Cursor, span: Span) -> None:
    line = _read_variable(cursor, "the name of the output", need_range=False)
    _once(header.output.name.span if header.output else None, span, "the output")
    header.output = line


def _read_variable(cursor: Cursor, what: str, *, need_range: bool) -> VariableLine:
    name = cursor.name(what)
    low = high = None
    if need_range or cursor.at_figure:
        start = cursor.span
        low = cursor.figure("the lower end of the range", finite=False).value
        cursor.expect("..", "between the ends of the range")
        last = cursor.figure("the upper end of the range", finite=False)
        high = last.value
        if not low <= high:
            raise Fault(
                Diagnostic(
                    "bad-range",
                    f"the range of '{name.text}' must run upwards, not from {low:g} to {high:g}",
                    start.to(last.span),
                )
            )
    return VariableLine(name, low, high, cursor.string() or "")


def _read_index(header: Header, cursor: Cursor, span: Span) -> None:
    _once(header.index_span, span, "the index order")
    header.index_span = cursor.whole
    index: list[tuple[str, Word]] = []
    while True:
        choices = ("page", "row", "column")
        place = cursor.word("page, row or column", choices, "unexpected-token")
        index.append((place.text, cursor.name(f"the input that is the {place.text}")))
        if not cursor.accept(","):
            break
    wanted = ["page"] * (len(index) - 2) + ["row", "column"][-len(index) :]
    if [place for place, _ in index] != wanted:
        raise Fault(
            Diagnostic(
                "wrong-index-order",
                "the index order is any pages, then the row, then the column",
                cursor.whole,
                hint=f"with {len(index)} inputs: {', '.join(f'{w} NAME' for w in wanted)}",
            )
        )
    seen: dict[str, Word] = {}
    for _, name in index:
        if name.text in seen:
            _once(seen[name.text].span, name.span, f"input '{name.text}' in the index order")
        seen[name.text] = name
    header.index = index


def _read_levels(header: Header, cursor: Cursor, span: Span) -> None:
    _read_numbers(header, header.levels, cursor, "levels")


def _read_bins(header: Header, cursor: Cursor, span: Span) -> None:
    _read_numbers(header, header.bins, cursor, "bins")


def _read_numbers(
    header: Header, into: dict[str | None, Numbers], cursor: Cursor, word: str
) -> None:
    names: list[Word] = []
    if not cursor.at_figure:
        names.append(cursor.name(f"the {word} as numbers, or the inputs they belong to"))
        while cursor.accept(","):
            names.append(cursor.name("the name of an input"))
        cursor.expect(":", "after the inputs")
    start = cursor.span
    values = read_number_list(cursor, word)
    last = cursor.tokens[cursor.position - 1].span
    numbers = Numbers(values, start.to(last))
    for a, b in itertools.pairwise(values):
        if not a < b:
            raise Fault(
                Diagnostic(
                    "not-increasing", f"the {word} must increase, but {b:g} follows {a:g}",
                    numbers.span,
                )
            )  # fmt: skip
    header.named += names
    owners: list[Word | None] = [*names] or [None]
    for name in owners:
        key = name.text if name else None
        before = into.get(key)
        what = f"the {word} of '{key}'" if name else f"the {word}"
        _once(before.span if before else None, name.span if name else numbers.span, what)
        into[key] = numbers


def read_number_list(cursor: Cursor, word: str) -> tuple[float, ...]:
    """Read ``low .. high step s``, ``low .. high count n``, or numbers, maybe ``mirrored``."""
    start = cursor.span
    first = cursor.figure(f"the {word} as numbers")
    if cursor.accept(".."):
        last = cursor.figure("the last level")
        form = cursor.word("'step' or 'count'", ("step", "count"), "unexpected-token").text
        third = cursor.figure("the distance of the levels, or how many there are")
        return _even(first, last, form, third, start.to(third.span))
    values = [first.value]
    while cursor.at_figure:
        values.append(cursor.figure("a number").value)
    end = cursor.tokens[cursor.position - 1].span
    if not cursor.accept("mirrored"):
        return tuple(values)
    if values[0] < 0.0 or not all(a < b for a, b in itertools.pairwise(values)):
        message = f"the {word} before 'mirrored' must increase and not be negative"
        raise Fault(Diagnostic("not-increasing", message, start.to(end)))
    return mirror(values)


def _even(first: Figure, last: Figure, form: str, third: Figure, span: Span) -> tuple[float, ...]:
    low, high = first.value, last.value
    width = high - low
    if form == "count":
        intervals = third.value - 1.0
    else:
        intervals = width / third.value if third.value > 0 else 0.0
    if intervals > MAX_LEVELS:
        message = f"an input has at most {MAX_LEVELS:,} levels"
        raise Fault(Diagnostic("too-many-levels", message, span))
    if not (width > 0 and intervals >= 1 and abs(intervals - round(intervals)) < 1e-6):
        message = f"the {form} {third.value:g} does not divide the levels {low:g} .. {high:g}"
        raise Fault(Diagnostic("bad-levels", message, span))
    return evenly(low, high, round(intervals) + 1)


def _read_round(header: Header, cursor: Cursor, span: Span) -> None:
    _once(header.rounding.span if header.rounding else None, span, "the rounding")
    figure = cursor.figure("the step of the rounding")
    if figure.value <= 0:
        raise Fault(
            Diagnostic("bad-step", "the step of the rounding must be positive", figure.span)
        )
    header.rounding = figure


def _read_mode(header: Header, cursor: Cursor, span: Span) -> None:
    _once(header.mode.span if header.mode else None, span, "the lookup mode")
    header.mode = cursor.word(f"one of {', '.join(MODES)}", MODES, "unknown-choice")


def _read_origin(header: Header, cursor: Cursor, span: Span) -> None:
    token = cursor.peek()
    if token is None or token.kind not in ("name", "quoted"):
        cursor.fail("a key, such as source")
    key = cursor.take()
    value = cursor.string()
    if value is None:
        cursor.fail(f"what is known of '{key.text}', in double quotes")
    header.origin.append((key.text, value or ""))


def _once(before: Span | None, span: Span, what: str) -> None:
    if before is not None:
        raise Fault(
            Diagnostic(
                "duplicate-statement",
                f"{what} has been given already in line {before.line}",
                span,
                related=(Related("first given here", before),),
            )
        )


_READERS: dict[str, Callable[[Header, Cursor, Span], None]] = {
    "fuzzyarm-table": _read_format,
    "input": _read_input,
    "output": _read_output,
    "index": _read_index,
    "levels": _read_levels,
    "bins": _read_bins,
    "round": _read_round,
    "mode": _read_mode,
    "origin": _read_origin,
}


def check_names(header: Header, diagnostics: list[Diagnostic]) -> None:
    """Report inputs that the index order does not name."""
    known = [name.text for _, name in header.index]
    for name in [*(line.name for line in header.inputs.values()), *header.named]:
        if name.text not in known:
            hint, replacement = near_hint(name.text, known)
            diagnostics.append(
                Diagnostic(
                    "unknown-variable",
                    f"'{name.text}' is no input of the index order ({', '.join(known)})",
                    name.span,
                    hint=hint,
                    replacement=replacement,
                )
            )
