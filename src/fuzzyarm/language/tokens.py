"""A text as tokens, tokens as statements, and the reserved words.

:func:`tokenize` cuts lines, :func:`group_lines` joins them to statements, :class:`Cursor` walks
along the tokens of one statement.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import NamedTuple

from fuzzyarm.language.nodes import Figure, Trivia, Word
from fuzzyarm.text.diagnostic import MAX_DIAGNOSTICS, Diagnostic, Span, split_lines
from fuzzyarm.text.names import near_hint

# --- Tokens ---

_TOKEN = re.compile(
    r"""
      (?P<space>[ \t\f\v\u00a0\ufeff]+)
    | (?P<comment>\#.*)
    | (?P<string>"(?:[^"\\]|\\.)*")
    | (?P<quoted>'(?:[^'\\]|\\.)*')
    | (?P<open>["'].*)
    | (?P<name>[^\W\d]\w*(?:-[^\W\d]\w*)*)
    | (?P<number>(?:[0-9]+(?:\.(?!\.)[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?!\w))
    | (?P<bad>\.?[0-9][\w.]*)
    | (?P<mark>\.\.|->|<=|>=|[.,:()=<>\\*/^%+-])
    | (?P<stray>.)
    """,
    re.VERBOSE | re.DOTALL,
)
_ESCAPE = re.compile(r"\\(u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|.)", re.DOTALL)
_ESCAPES = {"n": "\n", "r": "\r", "t": "\t", "\\": "\\", '"': '"', "'": "'"}


class Token(NamedTuple):
    """One token.

    Attributes
    ----------
    kind : str
        ``name``, ``quoted``, ``string``, ``number`` or ``mark``.
    text : str
        As written; for names in quotes and strings, what they stand for.
    line, column, end : int
        Line and first column from 1, and the column after the last character.
    """

    kind: str
    text: str
    line: int
    column: int
    end: int

    @property
    def span(self) -> Span:
        """The place of the token."""
        return Span(self.line, self.column, self.line, self.end)


@dataclass(frozen=True, slots=True)
class Line:
    """One line of the text.

    Attributes
    ----------
    number : int
        From 1.
    tokens : tuple of Token
        Without white space and comment.
    comment : str
        With its ``#``, stripped at the end; empty where there is none.
    indented : bool
        Whether the first token stands behind white space.
    """

    number: int
    tokens: tuple[Token, ...]
    comment: str
    indented: bool


def tokenize(text: str, diagnostics: list[Diagnostic]) -> list[Line]:
    """Return the lines of `text` as tokens; what is no token goes to `diagnostics`."""
    return [
        tokenize_line(number, line, diagnostics)
        for number, line in enumerate(split_lines(text), start=1)
    ]


def tokenize_line(number: int, text: str, diagnostics: list[Diagnostic]) -> Line:
    """Return one line as tokens; `number` is its place from 1."""
    tokens: list[Token] = []
    comment = ""
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup or "stray"
        if kind == "space":
            continue
        if kind == "comment":
            comment = match.group().rstrip()
            break
        column, end = match.start() + 1, match.end() + 1
        if kind in ("name", "number", "mark"):
            tokens.append(Token(kind, match.group(), number, column, end))
        elif kind in ("string", "quoted"):
            span = Span(number, column, number, end)
            tokens.append(
                Token(kind, unescape(match.group()[1:-1], span, diagnostics), number, column, end)
            )
        else:
            diagnostics.append(_lexical_fault(kind, match.group(), number, column, end))
            if kind == "bad":
                tokens.append(Token("bad", match.group(), number, column, end))
    return Line(number, tuple(tokens), comment, bool(tokens) and tokens[0].column > 1)


def _lexical_fault(kind: str, text: str, line: int, column: int, end: int) -> Diagnostic:
    span = Span(line, column, line, end)
    if kind == "open":
        return Diagnostic(
            "unterminated-string", f"the quote {text[0]} is never closed on this line", span
        )
    if kind == "bad":
        return Diagnostic(
            "bad-number",
            f"'{text}' is neither a number nor a name",
            span,
            hint="put a name that starts with a digit in single quotes",
        )
    shown = text if text.isprintable() else f"U+{ord(text):04X}"
    return Diagnostic(
        "unexpected-character",
        f"the character '{shown}' has no meaning here",
        span,
        hint="a name with unusual characters stands in single quotes",
    )


def unescape(text: str, span: Span, diagnostics: list[Diagnostic]) -> str:
    r"""Resolve ``\n``, ``\t``, ``\\``, quotes and ``\uXXXX``; report any other escape."""
    if "\\" not in text:
        return text

    def replace(match: re.Match[str]) -> str:
        code = match.group(1)
        if code in _ESCAPES:
            return _ESCAPES[code]
        if len(code) > 1 and int(code[1:], 16) <= 0x10FFFF:
            return chr(int(code[1:], 16))
        diagnostics.append(Diagnostic("bad-escape", f"'\\{code}' is no escape sequence", span))
        return match.group()

    return _ESCAPE.sub(replace, text)


# --- Reserved words ---

STATEMENTS: dict[str, str] = {
    "rulebase": "the name of the rule base and what it is for",
    "input": "an input variable and its range",
    "output": "an output variable and its range",
    "terms": "evenly spaced terms of one or more variables",
    "term": "one term with its shape",
    "inference": "how rules are evaluated",
    "block": "start of a further block of rules",
    "rules": "a grid of rules",
    "rule": "one rule: if … then …",
    "lookup": "how the lookup table is sampled",
    "expect": "what must come out, checked by `fuzzyarm check`",
}
"""Words that start a statement, with one line for help."""

LOOKUP_ITEMS = ("levels", "bins", "round")
CONNECTIVES = ("if", "then", "is", "and", "or", "with", "when")
SETTINGS = (
    "and",
    "or",
    "implication",
    "aggregation",
    "defuzzifier",
    "outside",
    "no-rule",
    "threshold",
)

HEDGE_WORDS: dict[str, str] = {
    "not": "not",
    "very": "very",
    "somewhat": "somewhat",
    "more-or-less": "somewhat",
    "extremely": "extremely",
    "intensify": "intensify",
    "seldom": "seldom",
    "any": "any",
    "power": "power",
}
"""Hedges as written → the hedge they mean."""

RESERVED = frozenset({*CONNECTIVES, *HEDGE_WORDS, "inf", "nan"} - {"power"})
"""Words that a name must not be written as without quotes.

As few as possible: all others are told apart by their place. (`power` is a hedge only
before a parenthesis.)
"""

QUOTED = frozenset({*RESERVED, *STATEMENTS})
"""Words that are printed in quotes as names: at the start of a line they would mean more."""


# --- Statements with the lines that belong to them ---

_ALLOW = re.compile(r"#\s*allow\s+([\w-]+(?:\s*,\s*[\w-]+)*)")


@dataclass(frozen=True, slots=True)
class BlockLine:
    """A line below ``rules`` or ``lookup``."""

    tokens: tuple[Token, ...]
    trivia: Trivia


@dataclass(slots=True)
class Group:
    """The tokens of one statement; for ``rules`` and ``lookup`` also the lines below it."""

    tokens: list[Token]
    before: tuple[str, ...]
    behind: str
    lines: list[BlockLine] = field(default_factory=list)

    @property
    def keyword(self) -> str:
        """The first word, which is a key of STATEMENTS."""
        return self.tokens[0].text


def group_lines(
    lines: list[Line], diagnostics: list[Diagnostic]
) -> tuple[list[Group], tuple[str, ...]]:
    """Return the statements of `lines` and the comments after the last one.

    A line that starts with a statement word starts a statement. Any other line belongs to
    the statement above it if it is indented (or if that is a grid); else it is an
    ``unknown-statement``, read on as the nearest statement if there is a near one.
    """
    groups: list[Group] = []
    waiting: list[str] = []
    for line in lines:
        if len(diagnostics) > MAX_DIAGNOSTICS:
            break
        if not line.tokens:
            if line.comment or (waiting[-1:] != [""] and (groups or waiting)):
                waiting.append(line.comment)
            continue
        first = line.tokens[0]
        if first.kind == "name" and first.text in STATEMENTS:
            groups.append(Group(list(line.tokens), tuple(waiting), line.comment))
        elif groups and _belongs(line, groups[-1]):
            _extend(groups[-1], line, waiting)
        else:
            diagnostic = _unknown_statement(first)
            diagnostics.append(diagnostic)
            if diagnostic.replacement is None:
                continue
            # Read on as what was probably meant, so that one slip does not look like many.
            meant = first._replace(kind="name", text=diagnostic.replacement)
            groups.append(Group([meant, *line.tokens[1:]], tuple(waiting), line.comment))
        waiting = []
    while waiting and waiting[-1] == "":
        waiting.pop()
    return groups, tuple(waiting)


def _belongs(line: Line, group: Group) -> bool:
    if line.indented:
        return True
    # A grid or a lookup block is understood without its indentation too, unless the line
    # looks like a misspelt statement.
    return (
        group.keyword in ("rules", "lookup") and not near_hint(line.tokens[0].text, STATEMENTS)[0]
    )


def _extend(group: Group, line: Line, waiting: list[str]) -> None:
    if group.keyword in ("rules", "lookup"):
        group.lines.append(BlockLine(line.tokens, Trivia(tuple(waiting), line.comment)))
        return
    group.tokens.extend(line.tokens)
    comments = [comment for comment in (*waiting, line.comment) if comment]
    group.before = (*group.before, *comments)


def _unknown_statement(token: Token) -> Diagnostic:
    hint, replacement = near_hint(token.text, STATEMENTS)
    return Diagnostic(
        "unknown-statement",
        f"no statement starts with '{token.text}'",
        token.span,
        hint=hint or "statements start with " + ", ".join(STATEMENTS),
        replacement=replacement,
    )


def allowances(lines: list[Line]) -> dict[int, frozenset[str]]:
    """Return the names that ``# allow NAME, NAME`` silences, by line."""
    allowed: dict[int, frozenset[str]] = {}
    for line in lines:
        match = _ALLOW.search(line.comment) if line.comment else None
        if match:
            allowed[line.number] = frozenset(re.split(r"\s*,\s*", match.group(1)))
    return allowed


# --- A cursor in the tokens of one statement, and the faults found there ---


class Fault(Exception):  # noqa: N818 - it never leaves the parser
    """Reading the statement cannot go on; carries the diagnostic."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


class Cursor:
    """Tokens and a position.

    Parameters
    ----------
    tokens : sequence of Token
        At least one.
    """

    def __init__(self, tokens: tuple[Token, ...] | list[Token]) -> None:
        self.tokens = tokens
        self.position = 0
        self.forgiven: list[Diagnostic] = []

    @property
    def at_end(self) -> bool:
        """Whether every token has been taken."""
        return self.position >= len(self.tokens)

    @property
    def span(self) -> Span:
        """The place of the next token, or the place just behind the last one."""
        if not self.at_end:
            return self.tokens[self.position].span
        last = self.tokens[-1]
        return Span(last.line, last.end, last.line, last.end + 1)

    @property
    def whole(self) -> Span:
        """From the first to the last token."""
        return self.tokens[0].span.to(self.tokens[-1].span)

    def peek(self, ahead: int = 0) -> Token | None:
        """Return the next token (or one further `ahead`) without taking it."""
        index = self.position + ahead
        return self.tokens[index] if index < len(self.tokens) else None

    def next_is(self, text: str) -> bool:
        """Whether the next token is the unquoted word or mark `text`."""
        token = self.peek()
        return token is not None and token.kind in ("name", "mark") and token.text == text

    def take(self) -> Token:
        """Take the next token."""
        token = self.tokens[self.position]
        self.position += 1
        return token

    def accept(self, text: str) -> Token | None:
        """Take the next token if it is the word or mark `text`."""
        return self.take() if self.next_is(text) else None

    def expect(self, text: str, where: str) -> Token:
        """Take the word or mark `text`; a fault says that it is missing `where`."""
        if not self.next_is(text):
            self.fail(f"'{text}' {where}", (text,) if text.isalpha() else ())
        return self.take()

    def fail(self, wanted: str, choices: tuple[str, ...] = (), name: str = "") -> None:
        """Raise the fault *expected …, found …*, with a hint if one of `choices` is near."""
        raise Fault(self.fault(wanted, choices, name))

    def fault(self, wanted: str, choices: tuple[str, ...] = (), name: str = "") -> Diagnostic:
        """Return the diagnostic *expected …, found …*."""
        token = self.peek()
        found = "the end of the line" if token is None else f"'{token.text}'"
        hint, replacement = near_hint(token.text, choices) if token else ("", None)
        return Diagnostic(
            name or ("incomplete-statement" if token is None else "unexpected-token"),
            f"expected {wanted}, found {found}",
            self.span,
            hint=hint,
            replacement=replacement,
        )

    def forgive(self, fault: Fault) -> None:
        """Keep the diagnostic of `fault` and skip the rest of the line.

        For faults behind the name that a statement declares: the name is known all the same,
        so its uses are not reported as mistakes too.
        """
        self.forgiven.append(fault.diagnostic)
        self.position = len(self.tokens)

    def name(self, what: str) -> Word:
        """Take a name: a plain word that is not reserved, or one in single quotes."""
        token = self.peek()
        if token is None or token.kind not in ("name", "quoted"):
            self.fail(what)
        elif token.kind == "name" and token.text in RESERVED:
            raise Fault(
                Diagnostic(
                    "reserved-word",
                    f"expected {what}, found the reserved word '{token.text}'",
                    token.span,
                    hint=f"as a name it is written '{token.text}' with its quotes",
                    replacement=f"'{token.text}'",
                )
            )
        taken = self.take()
        return Word(taken.text, taken.span)

    def word(self, what: str, choices: tuple[str, ...], name: str) -> Word:
        """Take one of the words `choices`; a fault is called `name` and hints at the nearest."""
        token = self.peek()
        if token is None or token.kind != "name" or token.text not in choices:
            self.fail(what, choices, name)
        taken = self.take()
        return Word(taken.text, taken.span)

    def string(self) -> str | None:
        """Take a string in double quotes if there is one."""
        token = self.peek()
        if token is None or token.kind != "string":
            return None
        return self.take().text

    @property
    def at_figure(self) -> bool:
        """Whether a number comes next, maybe with a sign."""
        ahead = 1 if self.next_is("-") or self.next_is("+") else 0
        token = self.peek(ahead)
        return token is not None and (
            token.kind == "number" or (token.kind == "name" and token.text in ("inf", "nan"))
        )

    def figure(self, what: str, *, finite: bool = True) -> Figure:
        """Take a number with an optional sign; a fault if it is not finite but must be."""
        if not self.at_figure:
            self.fail(what)
        start = self.span
        sign = -1.0 if self.next_is("-") else 1.0
        if self.next_is("-") or self.next_is("+"):
            self.take()
        token = self.take()
        value = sign * float(token.text)
        span = start.to(token.span)
        if token.kind == "number" and math.isinf(value):
            raise Fault(Diagnostic("bad-number", f"'{token.text}' is too large for a number", span))
        if finite and not math.isfinite(value):
            raise Fault(Diagnostic("bad-number", f"expected {what}, a finite number", span))
        return Figure(value, span)

    def finish(self) -> None:
        """Demand that nothing is left."""
        if not self.at_end:
            self.fail("the end of the line", (), "trailing-text")
