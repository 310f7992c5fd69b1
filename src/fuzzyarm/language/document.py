"""A whole file as a syntax tree: grouped into statements, read, and printed in canonical form.

Reading never raises: unreadable text becomes a diagnostic, and reading continues with the next
statement. A memory of the last reading makes editors fast.
"""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

from fuzzyarm.base.diagnostic import (
    MAX_CHARACTERS,
    MAX_DIAGNOSTICS,
    MAX_LINE,
    MAX_LINES,
    Diagnostic,
    Span,
    split_lines,
)
from fuzzyarm.base.names import near_hint
from fuzzyarm.language.model.rulebase import Rule
from fuzzyarm.language.phrases import NameKind, Occurrence, aligned
from fuzzyarm.language.rows import ROWS, StatementKind, lines_below, mentions, text_of
from fuzzyarm.language.statements import (
    CONTROLLER,
    STATEMENTS,
    BlockNode,
    Broken,
    StatementNode,
)
from fuzzyarm.language.tokens import (
    BlockLine,
    Cursor,
    Fault,
    SourceLine,
    Token,
    Trivia,
    tokenize_line,
)
from fuzzyarm.symbolic.kinds import HEDGES


class Statement(NamedTuple):
    """A statement and the comments around it; `names` are those in its unreadable part."""

    node: StatementNode
    trivia: Trivia = Trivia()
    names: tuple[Occurrence, ...] = ()


class Document(NamedTuple):
    """A whole file.

    Attributes
    ----------
    statements : tuple of Statement
        In order.
    ending : tuple of str
        Comments and blank lines after the last statement.
    allowed : mapping of int to frozenset of str
        Names that ``# allow`` silences, by line.
    diagnostics : tuple of Diagnostic
        Findings of lexer and parser.
    """

    statements: tuple[Statement, ...]
    ending: tuple[str, ...] = ()
    allowed: Mapping[int, frozenset[str]] = MappingProxyType({})
    diagnostics: tuple[Diagnostic, ...] = ()


# --- Lines as statements ---

_ALLOW = re.compile(r"#\s*allow\s+([\w-]+(?:\s*,\s*[\w-]+)*)")


Records = Mapping[str, StatementKind]

HEADINGS = ("rulebase", "controller")
"""The words that begin a section of a file; without one it is a rule base."""


@cache
def statements_below(heading: str) -> Records:
    """Return the statements below a heading by the words that start them.

    Those of a controller are imported on demand: they would take a third of the time of checking a
    rule base, some tens of milliseconds.
    """
    if heading == "rulebase":
        return ChainMap(STATEMENTS, {CONTROLLER.word: CONTROLLER})
    from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, SIGNAL

    words = {word: record for word, record in CONTROLLER_STATEMENTS.items() if word != SIGNAL}
    return {**words, "rulebase": STATEMENTS["rulebase"]}


def _signals() -> StatementKind:
    """Return the statement without a keyword, valid below ``axis``."""
    from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, SIGNAL

    return CONTROLLER_STATEMENTS[SIGNAL]


def section_at(lines: Sequence[SourceLine], number: int) -> str:
    """Return the heading, one of :data:`HEADINGS`, of a line."""
    for line in reversed(lines[: number - 1]):
        word = line.tokens[0].text if line.tokens and line.tokens[0].kind == "name" else ""
        if word in HEADINGS:
            return word
    return "rulebase"


class _StatementTokens:
    """The tokens of one statement and of the lines below it, if it takes any."""

    def __init__(
        self, record: StatementKind, tokens: tuple[Token, ...], before: tuple[str, ...], behind: str
    ) -> None:
        self.record = record
        self.tokens = list(tokens)
        self.before = before
        self.behind = behind
        self.lines: list[BlockLine] = []
        self.takes_lines = record.takes_lines

    def takes(self, line: SourceLine) -> bool:
        """Whether `line` belongs here: if indented, or below a grid if it looks like a row."""
        if line.indented:
            return True
        if not self.takes_lines:
            return False
        return self.is_grid_line(line) or not near_hint(line.tokens[0].text, STATEMENTS)[0]

    def is_grid_line(self, line: SourceLine) -> bool:
        """Whether a line looks like the header of a grid, or like a row below it."""
        if self.record.word != "rules":
            return False
        names = all(token.kind in ("name", "quoted") or token.text == "." for token in line.tokens)
        if not self.lines:
            return any(token.text == "\\" for token in line.tokens) or (
                names and len(line.tokens) > 1
            )
        header = self.lines[0].tokens
        corner = 2 if any(token.text == "\\" for token in header) else 0
        return names and len(line.tokens) == len(header) - corner

    def extend(self, line: SourceLine, waiting: list[str]) -> None:
        """Add a line; `waiting` are the comments and blank lines before it."""
        if self.takes_lines:
            self.lines.append(BlockLine(line.tokens, Trivia(tuple(waiting), line.comment)))
            return
        self.tokens.extend(line.tokens)
        comments = [comment for comment in (*waiting, line.comment) if comment]
        self.before = (*self.before, *comments)


def _group_lines(
    lines: list[SourceLine], diagnostics: list[Diagnostic]
) -> tuple[list[_StatementTokens], tuple[str, ...]]:
    """Return the statements of `lines` and the comments after the last one.

    A line with the keyword of a statement starts a statement. Any other line belongs to the
    statement above if that takes it; else it is an ``unknown-statement``, and so are the indented
    lines below it.
    """
    groups: list[_StatementTokens] = []
    waiting: list[str] = []
    heading = "rulebase"
    in_axis = False  # a line with an equals sign is a signal there
    below_unknown: Collection[str] = ()  # words of lines that go with an unknown statement
    for line in lines:
        if len(diagnostics) > MAX_DIAGNOSTICS:
            break
        if not line.tokens:
            if line.comment or (waiting[-1:] != [""] and (groups or waiting)):
                waiting.append(line.comment)
            continue
        first = line.tokens[0]
        record = _record_of(line, heading, groups, in_axis=in_axis)
        if below_unknown and line.indented and (record is None or record.word in below_unknown):
            continue  # part of the unknown statement: one finding
        below_unknown = ()
        if record is not None:
            groups.append(_StatementTokens(record, line.tokens, tuple(waiting), line.comment))
            heading = record.word if record.word in HEADINGS else heading
            in_axis = record.word == "axis" or (in_axis and record.word not in HEADINGS)
        elif groups and groups[-1].takes(line) and not _is_astray(line, heading, groups):
            groups[-1].extend(line, waiting)
        else:
            records = statements_below(heading)
            hint, replacement = _likely_statement(first.text, heading)
            diagnostics.append(
                Diagnostic(
                    "unknown-statement",
                    f"no statement starts with '{first.text}'",
                    first.span,
                    hint=hint or _signal_hint(line, heading) or _starters(records),
                    replacement=replacement,
                )
            )
            if replacement is None:
                groups += _name_above_axes(line, heading)
                elsewhere = STATEMENTS.get(first.text)
                below_unknown = {"", *(elsewhere.words if elsewhere is not None else ())}
                continue
            # Continue with the probable intention, so that one slip is one finding.
            name_token = first._replace(kind="name", text=replacement)
            tokens = (name_token, *line.tokens[1:])
            groups.append(
                _StatementTokens(records[replacement], tokens, tuple(waiting), line.comment)
            )
            heading = replacement if replacement in HEADINGS else heading
            in_axis = replacement == "axis" or (in_axis and replacement not in HEADINGS)
        waiting = []
    while waiting and waiting[-1] == "":
        waiting.pop()
    return groups, tuple(waiting)


def _is_astray(line: SourceLine, heading: str, groups: Sequence[_StatementTokens]) -> bool:
    """Whether a line below a grid is one of the controller above the rule base."""
    if line.indented or heading != "rulebase" or groups[-1].is_grid_line(line):
        return False
    has_controller = any(group.record is CONTROLLER for group in groups)
    return has_controller and line.tokens[0].text in statements_below("controller")


def _likely_statement(word: str, heading: str) -> tuple[str, str | None]:
    """Return the probable statement for an unknown word below a heading."""
    if word == "tune" and heading == "controller":
        return "a gain has its range behind it:  gain NAME = VALUE, tune LOW .. HIGH", None
    for other in HEADINGS:
        if other != heading and word in statements_below(other):
            return f"it belongs below a line  {other} NAME , above the next heading", None
    return near_hint(word, statements_below(heading))


def _name_above_axes(line: SourceLine, heading: str) -> list[_StatementTokens]:
    """Return the name defined by a line above the axes, to report the mistake once only."""
    if not _signal_hint(line, heading):
        return []
    return [_StatementTokens(_signals(), line.tokens[:1], (), "")]


def _signal_hint(line: SourceLine, heading: str) -> str:
    """Return a hint: the right position of a definition above the axes of a controller."""
    name = line.tokens[0].text
    if heading != "controller" or [token.text for token in line.tokens[1:2]] != ["="]:
        return ""
    return f"a signal belongs below a line  axis NAME , a number is  gain {name} = 1"


def _starters(records: Iterable[str]) -> str:
    return "statements start with " + ", ".join(records)


def _record_of(
    line: SourceLine, heading: str, groups: Sequence[_StatementTokens], *, in_axis: bool
) -> StatementKind | None:
    """Return the kind of statement that a line starts, or None."""
    first = line.tokens[0]
    record = statements_below(heading).get(first.text) if first.kind == "name" else None
    if in_axis and _is_signal(line, has_keyword=record is not None):
        return _signals()
    if record is None and heading == "controller" and _is_stray(line, groups):
        return _signals()  # only its axis is missing
    return record


def _is_signal(line: SourceLine, *, has_keyword: bool) -> bool:
    """Whether a line below ``axis`` defines signals, even if it begins with a keyword."""
    marks = [token.text for token in line.tokens if token.kind == "mark"]
    return "=" in marks and (not has_keyword or line.tokens[1].text in ("=", ","))


def _is_stray(line: SourceLine, groups: Sequence[_StatementTokens]) -> bool:
    """Whether a line defines a signal although no axis precedes it."""
    defines = len(line.tokens) > 1 and line.tokens[1].text == "="
    return defines and line.indented and bool(groups) and groups[-1].tokens[-1].text != ","


def _allowances(lines: list[SourceLine]) -> dict[int, frozenset[str]]:
    """Return the names that ``# allow NAME, NAME`` silences, by line."""
    allowed: dict[int, frozenset[str]] = {}
    for line in lines:
        match = _ALLOW.search(line.comment) if line.comment else None
        if match:
            allowed[line.number] = frozenset(re.split(r"\s*,\s*", match.group(1)))
    return allowed


# --- The memory of the last reading ---
#
# An editor reads the same file after every key stroke. Unchanged lines and statements are reused;
# the result is the same with and without a memory.

Found = tuple[Diagnostic, ...]


class ParseMemory:
    """The lines, statements and rules of one text as they were read last."""

    def __init__(self) -> None:
        self._lines: list[tuple[str, SourceLine, Found]] = []
        self._statements: dict[int, tuple[_StatementTokens, _Read]] = {}
        self._fresh: dict[int, tuple[_StatementTokens, _Read]] = {}
        self._scope: Hashable = None
        self._rules: dict[int, tuple[StatementNode, list[Rule], Found]] = {}
        self._fresh_rules: dict[int, tuple[StatementNode, list[Rule], Found]] = {}

    @property
    def lines(self) -> list[SourceLine]:
        """The lines of the last text as tokens."""
        return [line for _, line, _ in self._lines]

    def tokenize(self, text: str, diagnostics: list[Diagnostic]) -> list[SourceLine]:
        """Return the result of :func:`fuzzyarm.language.tokens.tokenize`."""
        before = self._lines
        self._lines = []
        for index, line in enumerate(split_lines(text)):
            entry = before[index] if index < len(before) else None
            if entry is None or entry[0] != line:
                findings: list[Diagnostic] = []
                entry = (line, tokenize_line(index + 1, line, findings), tuple(findings))
            diagnostics += entry[2]
            self._lines.append(entry)
            if len(diagnostics) > MAX_DIAGNOSTICS:
                break  # not a rule base; reading all of it would take too long
        return self.lines

    def read(self, group: _StatementTokens) -> _Read:
        """Return a statement; an unchanged one from memory."""
        line = group.tokens[0].line
        earlier = self._statements.get(line)
        if earlier is None or earlier[0].tokens != group.tokens or earlier[0].lines != group.lines:
            earlier = group, _read_group(group)
        self._fresh[line] = earlier
        return earlier[1]

    def finish(self) -> None:
        """Forget everything not in the text just read."""
        self._statements, self._fresh = self._fresh, {}

    def enter_scope(self, scope: Hashable) -> None:
        """Set the variables and terms for the meaning of rules."""
        rules_before = self._fresh_rules if scope == self._scope else {}
        self._scope, self._rules, self._fresh_rules = scope, rules_before, {}

    def recall_rules(self, node: StatementNode) -> tuple[list[Rule], Found] | None:
        """Return the rules of a statement from memory, if the scope is the same."""
        earlier = self._rules.get(id(node))
        if earlier is None or earlier[0] is not node:
            return None
        self._fresh_rules[id(node)] = earlier
        return earlier[1], earlier[2]

    def keep_rules(
        self, node: StatementNode, rules: list[Rule], findings: list[Diagnostic]
    ) -> None:
        """Store the meaning of a statement."""
        self._fresh_rules[id(node)] = (node, rules, tuple(findings))


# --- Reading ---


def parse_document(text: str, memory: ParseMemory | None = None) -> Document:
    """Return the syntax tree of `text` with every lexical and syntactic mistake.

    An unreadable statement is kept as :class:`Broken`. With a `memory`, unchanged parts are reused.
    """
    too_large = size_fault(text)
    if too_large is not None:
        return Document((), diagnostics=(too_large,))
    diagnostics: list[Diagnostic] = []
    memory = memory or ParseMemory()
    document = _read_lines(memory.tokenize(text, diagnostics), diagnostics, memory.read)
    memory.finish()
    return document


def parse_statements(text: str, line: int) -> Document:
    """Return the statements in `text`, more of a rule base that has been read up to `line`."""
    too_large = size_fault(text)
    if too_large is not None:
        return Document((), diagnostics=(too_large,))
    diagnostics: list[Diagnostic] = []
    numbered = enumerate(split_lines(text), line)
    lines = [tokenize_line(number, text_line, diagnostics) for number, text_line in numbered]
    return _read_lines(lines, diagnostics, _read_group)


def _read_lines(
    lines: list[SourceLine],
    diagnostics: list[Diagnostic],
    read: Callable[[_StatementTokens], _Read],
) -> Document:
    """Return the statements in `lines`; `diagnostics` are those of the lexer."""
    groups, ending = _group_lines(lines, diagnostics)
    statements = []
    for group in groups:
        node: StatementNode = Broken(group.record.word, group.tokens[0].span)
        names: tuple[Occurrence, ...] = ()
        if len(diagnostics) <= MAX_DIAGNOSTICS:
            node, line_diagnostics, names = read(group)
            diagnostics += line_diagnostics
        statements.append(Statement(node, Trivia(group.before, group.behind), names))
    # The lexer's finding on a token precedes the parser's.
    first: dict[tuple[int, int], Diagnostic] = {}
    strange = {d.line for d in diagnostics if d.name == "unexpected-character"}
    for diagnostic in diagnostics:
        if diagnostic.name == "unexpected-character" or diagnostic.line not in strange:
            first.setdefault((diagnostic.line, diagnostic.column), diagnostic)
    ordered = tuple(sorted(first.values(), key=lambda diagnostic: diagnostic.span))
    return Document(tuple(statements), ending, _allowances(lines), ordered)


class _Read(NamedTuple):
    """A statement, its findings, and the names in its unreadable part."""

    node: StatementNode
    found: Found
    names: tuple[Occurrence, ...]


def _read_group(group: _StatementTokens) -> _Read:
    # A token already reported by the lexer needs no second finding: it is read as the probable
    # name.
    is_reported = any(token.kind == "bad" for token in group.tokens)
    tokens = [t._replace(kind="name") if t.kind == "bad" else t for t in group.tokens]
    cursor = Cursor(tokens, group.lines, recovers=not is_reported)
    hedges = len(HEDGES.words)
    broken = Broken(group.record.word, cursor.whole)
    if len(tokens) == 1 and group.record.word == "signal":  # above the axes, and reported
        name = Occurrence(NameKind.SIGNAL, tokens[0].text, tokens[0].span, is_definition=True)
        return _Read(broken, (), (name,))
    try:
        node: StatementNode = group.record.row.read(cursor)
        if cursor.is_damaged or not cursor.at_end:
            cursor.mentioned += mentions(node)
        cursor.finish()
        if cursor.is_damaged:
            node = broken
    except Fault as fault:
        if len(HEDGES.words) > hedges:
            return _read_group(group)  # another package has registered the missing hedge
        cursor.damage(fault)
        node = broken
    return _Read(node, () if is_reported else tuple(cursor.forgiven), tuple(cursor.mentioned))


def size_fault(text: str) -> Diagnostic | None:
    """Return the finding on an oversized text; None for others."""
    if len(text) > MAX_CHARACTERS:
        return Diagnostic(
            "file-too-large",
            f"the text has {len(text):,} characters; the limit is {MAX_CHARACTERS:,}",
        )
    if text.count("\n") + text.count("\r") > MAX_LINES and len(split_lines(text)) > MAX_LINES:
        return Diagnostic(
            "file-too-large",
            f"the text has more than {MAX_LINES:,} lines",
            Span(MAX_LINES + 1, 1, MAX_LINES + 1, 2),
        )
    if len(text) > MAX_LINE:
        for number, line in enumerate(split_lines(text), start=1):
            if len(line) > MAX_LINE:
                return Diagnostic(
                    "line-too-long",
                    f"the line has {len(line):,} characters; the limit is {MAX_LINE:,}",
                    Span(number, MAX_LINE + 1, number, MAX_LINE + 2),
                )
    return None


# --- Printing, comments kept ---


def print_document(document: Document) -> str:
    """Return the canonical text of `document`, which must be free of broken statements.

    Neighbouring variables and neighbouring terms are aligned; a grid has blank lines around it;
    there is never more than one blank line in a row.
    """
    lines: list[str] = []
    previous: StatementNode | None = None
    aligned_lines = _aligned_lines(document)
    for index, (node, trivia, _) in enumerate(document.statements):
        if previous is not None and _is_set_apart(previous, node) and "" not in trivia.before:
            lines.append("")
        first, *rest = (aligned_lines.get(index) or text_of(node)).split("\n")
        margin = first[: len(first) - len(first.lstrip())]
        lines += [comment and margin + comment for comment in trivia.before]
        below = lines_below(node)
        if below is None and max(map(len, (_with_comment(first, trivia.behind), *rest))) > MAX_LINE:
            first, *rest = [part for line in (first, *rest) for part in _broken(line)]
        lines += [_with_comment(first, trivia.behind), *rest]
        for line, around in below or ():
            lines += [f"  {comment}" for comment in around.before if comment]
            lines.append(_with_comment(line, around.behind))
        previous = node
    lines += document.ending
    single = [line for i, line in enumerate(lines) if line or (i and lines[i - 1])]
    return "\n".join(single).rstrip("\n") + "\n" if any(lines) else ""


_WORDS = re.compile(r"""(?:'(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*"|[^\s'"])+""")
_WIDTH = 100


def _broken(line: str) -> list[str]:
    """Return an overlong line as several, all but the first indented."""
    margin = line[: len(line) - len(line.lstrip())]
    lines, words, length = [], list[str](), 0
    for match in _WORDS.finditer(line):
        if words and length + len(match[0]) > _WIDTH:
            lines.append(" ".join(words))
            words, length = [], 0
        words.append(match[0])
        length += len(match[0]) + 1
    first, *rest = [*lines, " ".join(words)]
    return [margin + first, *(f"{margin}  {continuation}" for continuation in rest)]


def _is_set_apart(previous: StatementNode, node: StatementNode) -> bool:
    around = lines_below(previous) is not None or lines_below(node) is not None
    return around or isinstance(node, BlockNode)


def _with_comment(line: str, comment: str) -> str:
    return f"{line}  {comment}" if comment else line


def _aligned_lines(document: Document) -> dict[int, str]:
    """Return the lines of variables and terms by statement; neighbours of a kind are aligned."""
    runs: list[list[int]] = []
    before: type | None = None
    for index, (node, trivia, _) in enumerate(document.statements):
        if ROWS[type(node)].in_columns:
            if type(node) is not before or "" in trivia.before:
                runs.append([])
            runs[-1].append(index)
        before = type(node)
    lines: dict[int, str] = {}
    for run in runs:
        nodes: list[Any] = [document.statements[index].node for index in run]
        row = ROWS[type(nodes[0])]
        texts = aligned([row.columns(node) for node in nodes], row.gap)
        lines.update(zip(run, (row.indent + line.strip() for line in texts), strict=True))
    return lines
