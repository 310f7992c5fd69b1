"""Tables as ``.lut`` text, read and written. No numpy.

Every mistake is found in one run, each at its place. Comments (``#`` to the end of the
line) are read over and not kept: what is worth keeping belongs into an ``origin`` line.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field

from fuzzyarm.language.tokens import Cursor, Fault, Figure, Token, Word, tokenize
from fuzzyarm.table.axis import MODES, Axis, PlainTable, TableError, TableHeader
from fuzzyarm.table.grid import KEYWORDS, Grid, page_conditions, read_grids, spelled
from fuzzyarm.text.diagnostic import (
    MAX_DIAGNOSTICS,
    MAX_LEVELS,
    Diagnostic,
    Related,
    Span,
    split_lines,
)
from fuzzyarm.text.names import is_plain_name, near_hint, quote
from fuzzyarm.text.numbers import (
    column_of_numbers,
    evenly,
    mirror,
    number_text,
    short_bins,
    short_levels,
)

# --- Reading the header: statements into a loose record; what they mean comes later ---

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


# --- Reading the whole text ---

MAX_CHARACTERS = 64_000_000
"""Longest table text that is read at all."""


@dataclass(frozen=True, slots=True)
class ParsedTable:
    """What came of a text.

    Attributes
    ----------
    table : PlainTable or None
        None if there is an error among the diagnostics.
    diagnostics : tuple of Diagnostic
        Every finding, in the order of the text.
    header : TableHeader or None
        Axes and output where at least these could be made out.
    """

    table: PlainTable | None
    diagnostics: tuple[Diagnostic, ...]
    header: TableHeader | None = None


def parse_lut(text: str, path: str = "<text>") -> ParsedTable:
    """Read the text of a ``.lut`` file.

    Parameters
    ----------
    text : str
        Anything at all; this function does not raise.
    path : str
        Named in the diagnostics.

    Returns
    -------
    ParsedTable
        The table, or what is wrong with the text.
    """
    diagnostics: list[Diagnostic] = []
    if len(text) > MAX_CHARACTERS:
        message = f"a table of more than {MAX_CHARACTERS:,} characters is not read"
        diagnostics.append(Diagnostic("too-large", message))
        return finish(None, None, diagnostics, path)
    header, grids = _scan(text, diagnostics)
    if header.version is None:
        return finish(None, None, [_no_format(text), *diagnostics][:20], path)
    head = resolve(header, diagnostics)
    values = read_grids(head, grids, diagnostics) if head else None
    return finish(head, values, diagnostics, path)


def finish(
    head: TableHeader | None,
    values: list[float] | None,
    diagnostics: list[Diagnostic],
    path: str,
) -> ParsedTable:
    """Sort the findings, name their file, and make the table if none is an error."""
    from dataclasses import replace

    unique = dict.fromkeys(sorted(diagnostics, key=lambda d: d.span))
    findings = tuple(replace(d, path=path) for d in list(unique)[:MAX_DIAGNOSTICS])
    if head is None or values is None or any(d.is_error for d in findings):
        return ParsedTable(None, findings, head)
    fields = {name: getattr(head, name) for name in TableHeader.__dataclass_fields__}
    return ParsedTable(PlainTable(**fields, values=tuple(values)), findings, head)


def _scan(text: str, diagnostics: list[Diagnostic]) -> tuple[Header, list[Grid]]:
    header = Header()
    grids: list[Grid] = []
    for number, line in enumerate(split_lines(text), start=1):
        bare = line.lstrip()
        if not bare or bare[0] == "#":
            continue
        first = bare.split(None, 1)[0].split("#", 1)[0]
        if grids and first not in KEYWORDS:
            grids[-1].lines.append((number, line))
            continue
        tokens = line_tokens(number, line, diagnostics)
        if not tokens:
            continue
        word = tokens[0].text if tokens[0].kind == "name" else ""
        if word == "grid":
            grids.append(Grid(tokens))
        elif word in KEYWORDS:
            read_statement(header, Cursor(tokens), diagnostics)
        else:
            diagnostics.append(_unknown_word(tokens))
    return header, grids


def line_tokens(number: int, line: str, diagnostics: list[Diagnostic]) -> tuple[Token, ...]:
    """Return the tokens of one line, with their place in the whole text."""
    found: list[Diagnostic] = []
    lines = tokenize(line, found)
    diagnostics += [_moved(fault, number) for fault in found]
    tokens = lines[0].tokens if lines else ()
    return tuple(token._replace(line=number) for token in tokens)


def _moved(diagnostic: Diagnostic, number: int) -> Diagnostic:
    from dataclasses import replace

    span = diagnostic.span
    return replace(diagnostic, span=Span(number, span.column, number, span.end_column))


def _unknown_word(tokens: tuple[Token, ...]) -> Diagnostic:
    word = tokens[0]
    hint, replacement = near_hint(word.text, KEYWORDS)
    return Diagnostic(
        "unknown-keyword",
        f"a line of a table cannot start with '{word.text[:40]}'",
        word.span,
        hint=hint or f"lines start with {', '.join(KEYWORDS)}",
        replacement=replacement,
    )


def _no_format(text: str) -> Diagnostic:
    return Diagnostic(
        "missing-format",
        "this is no table: the line 'fuzzyarm-table 1' is missing",
        Span(1, 1, 1, 2),
        hint="it stands at the top of every .lut file",
    )


def resolve(header: Header, diagnostics: list[Diagnostic]) -> TableHeader | None:
    """Turn the lines of a header into axes and an output; report what is missing."""
    end = header.version or Span(1, 1, 1, 2)
    complete = True
    if header.output is None:
        diagnostics.append(Diagnostic("missing-output", "no line names the output", end))
        complete = False
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
    check_names(header, diagnostics)
    axes = [_axis(header, name.text, diagnostics) for _, name in header.index]
    if not complete or header.output is None or any(axis is None for axis in axes):
        return None
    output = header.output
    return TableHeader(
        tuple(axis for axis in axes if axis is not None),
        output.name.text,
        low=output.low,
        high=output.high,
        description=output.description,
        rounding=header.rounding.value if header.rounding else None,
        mode=header.mode.text if header.mode else None,
        provenance=tuple(header.origin),
    )


def _axis(header: Header, name: str, diagnostics: list[Diagnostic]) -> Axis | None:
    levels = header.levels.get(name) or header.levels.get(None)
    bins = header.bins.get(name) or header.bins.get(None)
    line = header.inputs.get(name)
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
    if bins is not None and len(bins.values) != len(levels.values) - 1:
        diagnostics.append(
            Diagnostic(
                "wrong-bin-count",
                f"'{name}' has {len(levels.values)} levels and so needs "
                f"{len(levels.values) - 1} bins, not {len(bins.values)}",
                bins.span,
            )
        )
        return None
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


# --- Writing: a header and aligned grids, one row of cells to a line ---

FORMAT = "fuzzyarm-table"
VERSION = 1

_WIDTH = 78


def write_lut(table: PlainTable) -> str:
    """Return the text of `table`; :func:`fuzzyarm.table.parse_lut` reads back the same table."""
    lines = [*header_lines(table), ""]
    columns = len(table.axes[-1].levels)
    texts = column_of_numbers(table.values)
    if len(table.axes) == 1:
        labels = [spelled(table.axes[0].name), spelled(table.output)]
        cells = [[number_text(x) for x in table.axes[0].levels], texts]
        return "\n".join([*lines, "grid", *_aligned(labels, cells), ""])
    rows = len(table.axes[-2].levels)
    size = rows * columns
    row, column = table.axes[-2], table.axes[-1]
    corner = f"{spelled(row.name)} \\ {spelled(column.name)}"
    labels = [corner, *(number_text(x) for x in row.levels)]
    blocks = []
    for k, condition in enumerate(page_conditions(table)):
        page = texts[k * size : (k + 1) * size]
        cells = [[number_text(x) for x in column.levels]]
        cells += [page[i * columns : (i + 1) * columns] for i in range(rows)]
        blocks.append("\n".join([f"grid{condition}", *_aligned(labels, cells)]))
    return "\n".join([*lines, "\n\n".join(blocks), ""])


def header_lines(table: TableHeader) -> list[str]:
    """Return the lines of the header, from the format to the provenance."""
    lines = [f"{FORMAT} {VERSION}", ""]
    lines += _variable_lines(table)
    lines += ["", f"index   {', '.join(index_words(table))}"]
    lines += _axis_lines("levels", [(a.name, short_levels(a.levels)) for a in table.axes])
    binned = [(a.name, short_bins(a.bins)) for a in table.axes if a.bins]
    lines += _axis_lines("bins", binned, len(table.axes))
    if table.rounding is not None:
        lines.append(f"round   {number_text(table.rounding)}")
    if table.mode is not None:
        lines.append(f"mode    {table.mode}")
    if table.provenance:
        keys = [k if is_plain_name(k) else quote(k, "'") for k, _ in table.provenance]
        widest = max(map(len, keys))
        lines.append("")
        for key, (_, value) in zip(keys, table.provenance, strict=True):
            lines.append(f"origin  {key:<{widest}}  {quote(value, chr(34))}")
    return lines


def index_words(table: TableHeader) -> list[str]:
    """Return ``page a``, ``row e``, ``column ce``: the order of the indices by name."""
    names = [spelled(name) for name in table.names]
    places = ["page"] * max(0, len(names) - 2) + ["row", "column"][-len(names) :]
    return [f"{place} {name}" for place, name in zip(places, names, strict=True)]


def _variable_lines(table: TableHeader) -> list[str]:
    rows = [("input", spelled(a.name), _span(a.low, a.high), a.description) for a in table.axes]
    rows.append(("output", spelled(table.output), _span(table.low, table.high), table.description))
    names = max(len(name) for _, name, _, _ in rows)
    spans = max(len(span) for _, _, span, _ in rows)
    lines = []
    for word, name, span, description in rows:
        text = quote(description, chr(34)) if description else ""
        lines.append(f"{word:<6}  {name:<{names}}  {span:<{spans}}  {text}".rstrip())
    return lines


def _span(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return ""
    return f"{number_or_inf(low)} .. {number_or_inf(high)}"


def number_or_inf(x: float) -> str:
    """Return `x` as the language writes it."""
    return number_text(x) if abs(x) != float("inf") else ("inf" if x > 0 else "-inf")


def _axis_lines(word: str, texts: list[tuple[str, str]], count: int | None = None) -> list[str]:
    """Return one line for each distinct text, without names where it holds for every axis."""
    groups: dict[str, list[str]] = {}
    for name, text in texts:
        groups.setdefault(text, []).append(spelled(name))
    if len(groups) == 1 and len(texts) == (count or len(texts)):
        return [f"{word:<6}  {text}" for text in groups]
    return [f"{word:<6}  {', '.join(names)}: {text}" for text, names in groups.items()]


def _aligned(labels: list[str], cells: list[list[str]]) -> list[str]:
    left = max(map(len, labels))
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    gap = "  " if left + sum(widths) + 2 * len(widths) <= _WIDTH else " "
    return [
        f"  {label:>{left}}  " + gap.join(f"{c:>{w}}" for c, w in zip(row, widths, strict=True))
        for label, row in zip(labels, cells, strict=True)
    ]
