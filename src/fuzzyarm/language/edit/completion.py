"""Completion at a position, from the words before it: a broken line does not matter.

The reader of the statement runs over the words before the position with a cursor that accepts
anything. At the end, the reader's expectations are the completions.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, permutations
from types import MappingProxyType
from typing import Any, NoReturn

from fuzzyarm.base.diagnostic import Diagnostic, Figure, Span, Word
from fuzzyarm.base.names import nearest
from fuzzyarm.base.numbers import TIMES, number_text
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, SIGNAL
from fuzzyarm.language.document import section_at, statements_below
from fuzzyarm.language.edit.reading import NOTHING, Facts, Reading, expected_variable
from fuzzyarm.language.model.rulebase import RuleBase, Shape, Variable
from fuzzyarm.language.model.shapes import EVEN_SHAPES
from fuzzyarm.language.phrases import SETTINGS, NameKind, Setting, parameter_names
from fuzzyarm.language.rules import GridNode, RowNode
from fuzzyarm.language.statements import LOOKUP_ROW, STATEMENTS
from fuzzyarm.language.tokens import (
    Cursor,
    Fault,
    Token,
    Trivia,
    is_reserved,
    name_text,
    tokenize_line,
)
from fuzzyarm.language.tune import TUNE_ROW
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, Registry, ShapeKind
from fuzzyarm.symbolic.sources import SOURCES

# --- Candidates: words of the language, names, shapes with their numbers ---


@dataclass(frozen=True, slots=True)
class Completion:
    """A completion.

    Attributes
    ----------
    label : str
        Label in a list.
    kind : str
        ``keyword``, ``variable``, ``term``, ``shape``, ``hedge``, ``value`` or ``row``.
    insert : str
        The text to put there.
    detail : str
        A short description beside the label.
    snippet : str
        The same text with placeholders, as ``${1:left}``; empty without any.
    span : Span or None
        The typed text to replace; set by `complete`.
    """

    label: str
    kind: str
    insert: str
    detail: str = ""
    snippet: str = ""
    span: Span | None = None


def _words(words: Iterable[str], kind: str = "keyword") -> list[Completion]:
    """Return words as candidates; those of a registry with their descriptions."""
    docs = (
        {record.name: record.doc for record in words.values()}
        if isinstance(words, Registry)
        else {}
    )
    return [Completion(word, kind, word, docs.get(word, "")) for word in words]


def variable_detail(variable: Variable) -> str:
    """Return range and description in a few words."""
    text = f"{number_text(variable.low)} .. {number_text(variable.high)}"
    return f"{text}  {variable.description}".rstrip()


def _terms(variable: Variable | None, without: Iterable[str] = ()) -> list[Completion]:
    if variable is None:
        return []
    left_out = set(without)
    return [
        Completion(term.name, "term", name_text(term.name), term_detail(variable, term.name))
        for term in variable.terms
        if term.name not in left_out
    ]


def term_detail(variable: Variable, name: str) -> str:
    """Return the shape of a term as in a file."""
    term = variable.term(name)
    if term.lower is None:
        return _numbers_of(term.shape)
    return " over ".join(
        _numbers_of(shape) + ("" if shape.height == 1.0 else f" height {number_text(shape.height)}")
        for shape in (term.shape, term.lower)
    )


def _numbers_of(shape: Shape) -> str:
    if shape.kind in ("formula", "linear"):
        return shape.kind
    return " ".join([shape.kind, *(f"{x:.6g}" for x in shape.parameters)])


def _hedge(word: str) -> Completion:
    record = HEDGES[HEDGES.words[word]]
    if not record.parameters:
        return Completion(word, "hedge", word, record.doc)
    return Completion(word, "hedge", f"{word}(2)", record.doc, f"{word}(${{1:2}})")


_SNIPPETS = {
    "points": "points (${1:0}, ${2:0}) (${3:1}, ${4:1})",
    "linear": "linear ${1:0}",
    "formula": 'formula "${1:0}"',
}


def _shape(kind: ShapeKind) -> Completion:
    names = parameter_names(kind.name)
    numbers = " ".join(f"${{{i}:{name}}}" for i, name in enumerate(names, start=1))
    snippet = _SNIPPETS.get(kind.name) or f"{kind.name} {numbers}"
    detail = f"{' '.join(names)} — {kind.doc}" if names else kind.doc
    return Completion(kind.name, "shape", kind.name, detail, snippet)


# --- The cursor that records expectations ---


class _Nothing(Exception):  # noqa: N818 - internal
    """The reader has named all possible continuations."""


class _RecordingCursor(Cursor):
    """A cursor that accepts any token and records what was expected at the end.

    Optional parts (``accept``, ``suggest``) are recorded and reading continues; a mandatory one
    (``expect``, a name, a word, a number) is recorded last.
    """

    def __init__(
        self, tokens: Sequence[Token], model: RuleBase, names: Mapping[NameKind, Mapping[str, str]]
    ) -> None:
        super().__init__(tuple(tokens))
        self.model = model
        self.names = names
        self.offered: list[Completion] = []
        self._stalled = -1

    def variable_called(self, name: str) -> Variable | None:
        """Return the declared variable of that name."""
        variables = (v for v in (*self.model.inputs, *self.model.outputs) if v.name == name)
        return next(variables, None)

    def _variables(self, role: str, follow: str = "") -> list[Completion]:
        inputs = self.model.inputs if role != "output" else ()
        outputs = self.model.outputs if role != "input" else ()
        # A list of variables does not name one twice.
        listed = {token.text for token in self.tokens} if self._in_a_list() else set()
        return [
            Completion(v.name, "variable", name_text(v.name) + follow, variable_detail(v))
            for v in (*inputs, *outputs)
            if v.name not in listed
        ]

    def _in_a_list(self) -> bool:
        texts = [token.text for token in self.tokens]
        named_once = texts[:1] in (["terms"], ["expect"]) or "\\" in texts
        return named_once and "->" not in texts

    def _last(self, completions: list[Completion]) -> NoReturn:
        self.offered += completions
        raise _Nothing

    # Mandatory parts.

    def fail(self, expected: str, choices: Collection[str] = (), name: str = "") -> NoReturn:
        raise _Nothing

    def finish(self) -> None:
        if self.at_end:
            raise _Nothing

    def expect(self, text: str, where: str) -> Token:
        if self.at_end:
            self._last(_words((text,)) if text not in (")", ",") else [])
        token = self.tokens[self.position]
        if token.text == text or (text.isalpha() and nearest(token.text, (text,))):
            self.position += 1
        return token

    def name(self, what: str) -> Word:
        if self.at_end:
            raise _Nothing
        token = self.tokens[self.position]
        # A reserved word is left to whom it belongs, unless the reader would not get on.
        name = token.kind == "quoted" or (token.kind == "name" and not is_reserved(token.text))
        if name or self._stalled == self.position:
            self.position += 1
        else:
            self._stalled = self.position
        return Word(token.text if name else "", token.span)

    def variable(self, what: str, role: str = "", follow: str = "") -> Word:
        if self.at_end:
            self._last(self._variables(role, follow))
        return self.name(what)

    def term(self, what: str, variable: Word) -> Word:
        if self.at_end:
            self._last(_terms(self.variable_called(variable)))
        return self.name(what)

    def word(self, what: str, choices: Collection[str], name: str) -> Word:
        if self.at_end:
            kind = "value" if name in ("unknown-choice", "unknown-defuzzifier") else "keyword"
            self._last([] if self.offered else _words(choices, kind))
        token = self.tokens[self.position]
        if token.text not in choices:
            raise _Nothing
        self.position += 1
        return Word(token.text, token.span)

    def figure(self, what: str, *, finite: bool = True) -> Figure:
        if self.at_end or not self.at_figure:
            raise _Nothing
        return super().figure(what, finite=finite)

    # Optional parts.

    def accept(self, text: str, *, likely: bool = False) -> Token | None:
        if self.at_end and (likely or text.isalpha()):
            self.offered += _words((text,))
        return super().accept(text)

    def suggest(self, what: str, *about: Any) -> None:
        if self.at_end:
            self.offered += getattr(self, f"_suggest_{what.replace(' ', '_')}")(*about)

    def _suggest_hedges(self) -> list[Completion]:
        return list(map(_hedge, HEDGES.words))

    def _suggest_shapes(self) -> list[Completion]:
        return list(map(_shape, SHAPES.values()))

    def _suggest_families(self) -> list[Completion]:
        return [Completion(name, "shape", name, what) for name, what in EVEN_SHAPES.items()]

    def _suggest_range(self) -> list[Completion]:
        snippet = '${1:-1} .. ${2:1}  "${3:description}"'
        return [Completion("range", "value", "-1 .. 1", "low .. high", snippet)]

    def _suggest_term_names(self) -> list[Completion]:
        return _words(
            ("NB NM NS ZE PS PM PB", "NB NS ZE PS PB", "N ZE P", "LOW MIDDLE HIGH"), "row"
        )

    def _suggest_settings(self, of: str) -> list[Completion]:
        words = {token.text for token in self.tokens}
        return _words(s.word for s in SETTINGS.values() if s.word not in words and of in ("", s.of))

    def _suggest_targets(self, role: str) -> list[Completion]:
        return self._variables(role, ":")

    def _suggest_values(self, setting: Setting) -> list[Completion]:
        return [*_words(setting.values, "value"), *_words(("0",), "value")]

    def _suggest_samples(self) -> list[Completion]:
        return [Completion("(101, endpoints)", "value", "(101, endpoints)", "a number of samples")]

    def _suggest_comma(self) -> list[Completion]:
        missing = [v for v in self.model.inputs if all(v.name != t.text for t in self.tokens)]
        if missing:
            self._last(_words((",",)))
        return []

    # In the lines of a controller.

    def _suggest_sources(self) -> list[Completion]:
        return [Completion(word, "keyword", word, kind.doc) for word, kind in SOURCES.items()]

    def _suggest_signals(self) -> list[Completion]:
        return self._named(NameKind.SIGNAL)

    def _suggest_sheets(self) -> list[Completion]:
        return self._named(NameKind.USE)

    def _suggest_ports(self) -> list[Completion]:
        return self._named(NameKind.PORT)

    def _suggest_plants(self) -> list[Completion]:
        return self._named(NameKind.PLANT)

    def _suggest_states(self) -> list[Completion]:
        return self._named(NameKind.STATE)

    def _suggest_parameters(self) -> list[Completion]:
        return self._named(NameKind.PARAMETER)

    def _suggest_times(self) -> list[Completion]:
        return _words(TIMES, "value")

    def _named(self, kind: NameKind) -> list[Completion]:
        names_there = self.names.get(kind, {})
        return [Completion(n, "variable", name_text(n), words) for n, words in names_there.items()]

    # In the lines of a grid.

    def _suggest_headers(self) -> list[Completion]:
        inputs = [v for v in self.model.inputs if v.terms]
        if len(inputs) == 1:
            text = f"{name_text(inputs[0].name)}  {_names(inputs[0])}"
            return [Completion(text, "row", text, "one input")]
        rows = []
        for down, across in islice(permutations(inputs, 2), _MOST_HEADERS):
            text = f"{name_text(down.name)} \\ {name_text(across.name)}  {_names(across)}"
            rows.append(Completion(text, "row", text, f"{down.name} down, {across.name} across"))
        return rows

    def _suggest_backslash(self) -> list[Completion]:
        return [Completion("\\", "keyword", "\\ ", "then the variable across")]

    def _suggest_columns(self, column: Word, named: Sequence[Word] = ()) -> NoReturn:
        candidates = _terms(self.variable_called(column), without=list(named))
        if len(candidates) > 1:
            rest = "  ".join(candidate.insert for candidate in candidates)
            candidates.insert(0, Completion(rest, "row", rest, "the header row"))
        self._last(candidates)

    def _suggest_terms(self, variable: Word, named: Sequence[Word]) -> NoReturn:
        record = self.variable_called(variable)
        self._last(_terms(record, without=list(named)))

    def _suggest_labels(self, grid: GridNode) -> NoReturn:
        if grid.row is None:
            output = self.variable_called(grid.output)
            self._last([c for c in self._variables("output") if output and c.label == output.name])
        labels = [row.label for row in grid.rows]
        self._last(_terms(self.variable_called(grid.row), without=labels))

    def _suggest_cells(self, grid: GridNode, count: int = 0) -> NoReturn:
        if count >= len(grid.columns):
            raise _Nothing
        candidates = _terms(self.variable_called(grid.output))
        self._last([*candidates, Completion(".", "value", ".", "no rule for this cell")])


_MOST_HEADERS = 12


def _names(variable: Variable) -> str:
    return "  ".join(name_text(term.name) for term in variable.terms)


def _expected_at_end(
    read: Any,
    tokens: Sequence[Token],
    model: RuleBase,
    *about: Any,
    names: Mapping[NameKind, Mapping[str, str]] = MappingProxyType({}),
) -> list[Completion]:
    """Return the expectations of `read` after `tokens`."""
    cursor = _RecordingCursor(tokens, model, names)
    try:
        read(cursor, *about)
    except (_Nothing, Fault):
        variable = None if cursor.at_end else expected_variable(tokens)
        if variable is not None:  # the reader stuck before, but so much is certain
            return [*_terms(cursor.variable_called(variable)), *map(_hedge, HEDGES.words)]
    return sorted(cursor.offered, key=_rank)


def _rank(candidate: Completion) -> int:
    # Hedges fit almost everywhere, and settings mostly belong to no single variable.
    return 2 if candidate.kind == "hedge" else 1 if candidate.insert.endswith(":") else 0


# --- Completions ---

OF_PLANTS = (NameKind.PORT, NameKind.PLANT, NameKind.STATE, NameKind.PARAMETER)
"""Names that mean something of a plant."""

_PARTIAL = re.compile(r"(?:'[^']*|[^\W\d][\w-]*)\Z")
_ALLOW = re.compile(r"#\s*allow\s+(?:[\w-]+\s*,\s*)*([\w-]*)\Z")


def complete(reading: Reading, line: int, column: int, facts: Facts = NOTHING) -> list[Completion]:
    """Return the completions at a position, the likeliest first.

    Parameters
    ----------
    reading : Reading
        The text, however broken.
    line, column : int
        Position of the cursor, from 1.
    facts : Facts, optional
        Names of plants (ports, states, parameters) to be offered.
    """
    text = reading.raw_line(line)[: column - 1]
    column = len(text) + 1
    comment = _in_comment(text, line, column)
    if comment is not None:
        return comment
    diagnostics: list[Diagnostic] = []
    tokenize_line(line, text, diagnostics)
    if any(d.name == "unterminated-string" and text[d.column - 1] == '"' for d in diagnostics):
        return []
    match = _PARTIAL.search(text)
    # A letter after a digit belongs to no name: `1e` is on its way to a number.
    start = match.start() + 1 if match else column
    if text[: start - 1][-1:].isdigit():
        return []
    prefix = text[start - 1 :].strip("'").casefold()
    span = Span(line, start, line, column)
    tokens = tokenize_line(line, text[: start - 1], []).tokens
    offered = _offered(reading, line, tokens, facts, indented=text[:1].isspace())
    ranked = sorted(offered, key=lambda c: not c.label.casefold().startswith(prefix))
    return [replace(candidate, span=span) for candidate in ranked]


def _in_comment(text: str, line: int, column: int) -> list[Completion] | None:
    if not tokenize_line(line, text, []).comment and not text.endswith("#"):
        return None
    match = _ALLOW.search(text)
    if match is None:
        return []
    from fuzzyarm.language.check import CHECKS

    span = Span(line, match.start(1) + 1, line, column)
    return [Completion(c.name, "value", c.name, c.doc, span=span) for c in CHECKS.values()]


def _offered(
    reading: Reading, line: int, tokens: tuple[Token, ...], facts: Facts, *, indented: bool
) -> list[Completion]:
    if section_at(reading.lines, line) == "controller":
        return _in_controller(reading, line, tokens, facts, indented=indented)
    if not tokens and not indented:
        return [Completion(r.word, "keyword", r.word, r.doc) for r in STATEMENTS.values()]
    if not indented or _starts_statement(tokens):
        # The line starts a statement, though its word may be misspelt.
        keyword = nearest(tokens[0].text, STATEMENTS)
        if keyword is not None:
            return _expected_at_end(STATEMENTS[keyword].row.read, tokens, reading.model)
    above: list[tuple[Token, ...]] = []
    for number in range(line - 1, 0, -1):
        earlier = reading.tokens_of(number)
        if not earlier:
            continue
        above.insert(0, earlier)
        if _starts_statement(earlier):
            record = STATEMENTS[earlier[0].text]
            if record.takes_lines:
                return _below(reading, record.word, above, tokens, line)
            context = [token for part in above for token in part]
            return _expected_at_end(record.row.read, (*context, *tokens), reading.model)
    return []


def _in_controller(
    reading: Reading, line: int, tokens: tuple[Token, ...], facts: Facts, *, indented: bool
) -> list[Completion]:
    records = statements_below("controller")
    if not tokens:
        keywords = ("zoom", "learn", "drive") if indented else tuple(records)
        return [Completion(word, "keyword", word, records[word].doc) for word in keywords]
    names: dict[NameKind, dict[str, str]] = {}
    for (kind, name), words in facts.items():
        if kind in OF_PLANTS:
            names.setdefault(kind, {})[name] = words
    for occurrence in reading.occurrences:
        above = occurrence.span.line < line and occurrence.is_definition
        if above or (occurrence.kind in OF_PLANTS and occurrence.span.line != line):
            names.setdefault(occurrence.kind, {}).setdefault(occurrence.name, occurrence.kind)
    record = records.get(tokens[0].text) or CONTROLLER_STATEMENTS[SIGNAL]
    return _expected_at_end(record.row.read, tokens, reading.model, names=names)


def _starts_statement(tokens: Sequence[Token]) -> bool:
    return bool(tokens) and tokens[0].kind == "name" and tokens[0].text in STATEMENTS


def _below(
    reading: Reading,
    word: str,
    above: list[tuple[Token, ...]],
    tokens: tuple[Token, ...],
    line: int,
) -> list[Completion]:
    """Return the completions of a line below a grid or ``lookup``, which begins in line `above`."""
    model = reading.model
    items = {"lookup": LOOKUP_ROW, "tune": TUNE_ROW}
    if word in items:
        return _expected_at_end(items[word].read_line, tokens, model, Trivia())
    if len(above) == 1:
        return _expected_at_end(GridNode.read_header, tokens, model)
    if len(above[0]) < 2:
        return []
    try:
        (output, *others), _ = GridNode.read_first(Cursor(above[0]))
        row, column, columns = GridNode.read_header(Cursor(above[1]))
    except Fault:
        return []
    extent = reading.statement_at(above[1][0].line)
    last = extent[2] if extent else line
    rows = [reading.tokens_of(n) for n in range(above[1][0].line + 1, last + 1) if n != line]
    labels = tuple(RowNode(Word(row[0].text), ()) for row in rows if row)
    grid = GridNode(output, None, row, column, columns, labels)
    grid = grid._replace(joined=tuple(grid._replace(output=other) for other in others))
    return _expected_at_end(RowNode.read, tokens, model, grid, Trivia())
