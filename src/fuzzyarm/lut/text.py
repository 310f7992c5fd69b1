"""Read ``.lut`` text: every mistake in one run, each at its place. No numpy.

Comments (``#`` to the end of the line) are read over and not kept: what is worth keeping
belongs into an ``origin`` line.
"""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.lut.axis import Axis, TableError
from fuzzyarm.lut.header import PlainTable, TableHeader
from fuzzyarm.lut.text_grid import Grid, read_grids
from fuzzyarm.lut.text_header import Header, check_names, read_statement
from fuzzyarm.lut.words import KEYWORDS
from fuzzyarm.rulebase.diagnostic import Diagnostic, Span
from fuzzyarm.rulebase.limits import MAX_DIAGNOSTICS
from fuzzyarm.rulebase.near import near_hint
from fuzzyarm.rulebase.syntax.cursor import Cursor
from fuzzyarm.rulebase.syntax.tokens import Token, split_lines, tokenize

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
