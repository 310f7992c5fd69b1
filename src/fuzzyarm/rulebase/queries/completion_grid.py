"""What could stand in a line below ``rules``: the header row, row labels and cells."""

from __future__ import annotations

from itertools import permutations

from fuzzyarm.rulebase.model import Variable
from fuzzyarm.rulebase.printing.words import name_text
from fuzzyarm.rulebase.queries.candidates import Candidate, terms, variables
from fuzzyarm.rulebase.queries.reading import Reading
from fuzzyarm.rulebase.syntax.tokens import Token

_MOST_HEADERS = 12


def complete_grid_line(
    reading: Reading, line: int, first_line: int, tokens: tuple[Token, ...]
) -> list[Candidate]:
    """Return what could follow `tokens` in line `line` of the grid that starts at `first_line`."""
    header_line = next(
        (n for n in range(first_line + 1, line) if reading.tokens_of(n)), None
    )  # fmt: skip
    if header_line is None:
        return _header(reading, tokens)
    row, column, columns = _read_header(reading, reading.tokens_of(header_line))
    output = _output(reading, first_line)
    if not tokens:
        return _labels(reading, row, output, header_line, line)
    if len(tokens) - 1 >= len(columns) or column is None:
        return []
    if tokens[-1].text == "*":
        return []
    return [*terms(output), Candidate(".", "value", ".", "no rule for this cell")]


def _output(reading: Reading, first_line: int) -> Variable | None:
    tokens = reading.tokens_of(first_line)
    return reading.variable(tokens[1].text) if len(tokens) > 1 else None


def _read_header(
    reading: Reading, tokens: tuple[Token, ...]
) -> tuple[Variable | None, Variable | None, list[str]]:
    names = [token.text for token in tokens if token.kind in ("name", "quoted")]
    if len(tokens) > 2 and tokens[1].text == "\\":
        return reading.variable(names[0]), reading.variable(tokens[2].text), names[2:]
    return None, reading.variable(names[0]) if names else None, names[1:]


def _header(reading: Reading, tokens: tuple[Token, ...]) -> list[Candidate]:
    inputs = reading.model.inputs
    if not tokens:
        return [*_whole_headers(reading), *variables(inputs)]
    if tokens[-1].text == "\\":
        return variables([v for v in inputs if v.name != tokens[0].text])
    names = [token.text for token in tokens if token.kind in ("name", "quoted")]
    with_rows = len(tokens) > 1 and tokens[1].text == "\\"
    across = reading.variable(names[1] if with_rows and len(names) > 1 else names[0])
    used = names[2:] if with_rows else names[1:]
    offered = terms(across, without=used)
    if len(offered) > 1:
        rest = "  ".join(candidate.insert for candidate in offered)
        offered.insert(0, Candidate(rest, "row", rest, "the header row"))
    if len(tokens) == 1:
        offered.insert(0, Candidate("\\", "keyword", "\\ ", "then the variable across"))
    return offered


def _whole_headers(reading: Reading) -> list[Candidate]:
    inputs = [v for v in reading.model.inputs if v.terms]
    pairs = list(permutations(inputs, 2))[:_MOST_HEADERS]
    rows = [
        (f"{name_text(down.name)} \\ {name_text(across.name)}  {_names(across)}",
         f"{down.name} down, {across.name} across")
        for down, across in pairs
    ]  # fmt: skip
    if len(inputs) == 1:
        rows = [(f"{name_text(inputs[0].name)}  {_names(inputs[0])}", "one input")]
    return [Candidate(text, "row", text, detail) for text, detail in rows]


def _names(variable: Variable) -> str:
    return "  ".join(name_text(term.name) for term in variable.terms)


def _labels(
    reading: Reading, row: Variable | None, output: Variable | None, header_line: int, line: int
) -> list[Candidate]:
    if row is None:
        return variables([output]) if output is not None else []
    extent = reading.statement_at(header_line)
    last = extent[2] if extent else line
    used = {
        reading.tokens_of(n)[0].text
        for n in range(header_line + 1, last + 1)
        if n != line and reading.tokens_of(n)
    }
    return terms(row, without=used)
