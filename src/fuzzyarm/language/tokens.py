"""A text as lines of tokens, and a cursor that reads the tokens of one statement.

A :class:`Cursor` offers questions about the next token: a name, a number, one of these words.
Statements are read through such questions (:mod:`fuzzyarm.language.statements`); at the end of the
tokens, the same questions are the completions of an editor
(:mod:`fuzzyarm.language.edit.completion`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, NamedTuple, NoReturn

from fuzzyarm.base.diagnostic import Diagnostic, Figure, Span, Word, split_lines
from fuzzyarm.base.names import is_plain_name, near_hint, quote
from fuzzyarm.symbolic.kinds import HEDGES

# --- Tokens ---

# The order matters: a closed quote before an open one, a valid number before `bad`. A hyphen in a
# name needs a letter after it; a number has no dot before another dot, so that `0..1` is a range.
_TOKEN = re.compile(
    r"""
      (?P<space>[ \t\f\v\u00a0\ufeff]+)
    | (?P<comment>\#.*)
    | (?P<string>"(?:[^"\\]|\\.)*")
    | (?P<quoted>'(?:[^'\\]|\\.)*')
    | (?P<open>["'].*)
    | (?P<name>[^\W\d]\w*(?:-[^\W\d]\w*)*)
    | (?P<number>(?:[0-9]+(?:\.(?!\.)[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?
        (?:(?!\w)|(?=(?:us|ms|s|min|h)(?!\w))))  # a unit of time may follow without a space
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
        ``name``, ``quoted``, ``string``, ``number``, ``mark``, or ``bad`` for anything else.
    text : str
        As written; for names in quotes and strings, the content.
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
        """Its position."""
        return Span(self.line, self.column, self.line, self.end)


class SourceLine(NamedTuple):
    """One line of the text: `tokens` without white space, `comment` with its ``#`` or empty."""

    number: int
    tokens: tuple[Token, ...]
    comment: str
    indented: bool


def tokenize(text: str, diagnostics: list[Diagnostic]) -> list[SourceLine]:
    """Return the lines of `text` as tokens; invalid characters go to `diagnostics`."""
    return [
        tokenize_line(number, line, diagnostics)
        for number, line in enumerate(split_lines(text), start=1)
    ]


def tokenize_line(number: int, text: str, diagnostics: list[Diagnostic]) -> SourceLine:
    """Return one line, the `number`-th from 1, as tokens."""
    tokens: list[Token] = []
    comment, stray = "", False
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
                Token(kind, _unescape(match.group()[1:-1], span, diagnostics), number, column, end)
            )
        elif kind == "bad" or not stray:
            stray |= kind == "stray"  # one finding for the whole line
            diagnostics.append(_lexical_fault(kind, match.group(), number, column, end))
            if kind == "bad":
                tokens.append(Token("bad", match.group(), number, column, end))
    return SourceLine(number, tuple(tokens), comment, bool(tokens) and tokens[0].column > 1)


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
    symbol = text if text.isprintable() else f"U+{ord(text):04X}"
    hint = "write a name with unusual characters in single quotes"
    if text in "[]{};":
        hint = "brackets and semicolons are not part of the language"
    return Diagnostic(
        "unexpected-character",
        f"the character '{symbol}' has no meaning here",
        span,
        hint=hint,
    )


def _unescape(text: str, span: Span, diagnostics: list[Diagnostic]) -> str:
    r"""Resolve ``\n``, ``\t``, ``\\``, quotes and ``\uXXXX``; report any other escape."""
    if "\\" not in text:
        return text

    def replace(match: re.Match[str]) -> str:
        code = match.group(1)
        if code in _ESCAPES:
            return _ESCAPES[code]
        if len(code) > 1 and int(code[1:], 16) <= 0x10FFFF:
            return chr(int(code[1:], 16))
        diagnostics.append(Diagnostic("bad-escape", f"unknown escape sequence '\\{code}'", span))
        return match.group()

    return _ESCAPE.sub(replace, text)


# --- Words, numbers, names ---

RESERVED = frozenset({"if", "then", "is", "and", "or", "with", "when", "inf", "nan"})
"""Words that a name must not be written as without quotes; hedges are reserved too.

As few as possible: all others are distinguished by position.
"""

STARTERS: set[str] = set()
"""Words that start a statement, filled by :mod:`fuzzyarm.language.statements`."""


def is_reserved(word: str) -> bool:
    """Whether a name must not be written so; a hedge with a number is one before ``(`` only."""
    hedge = HEDGES.words.get(word)
    return word in RESERVED or (hedge is not None and not HEDGES[hedge].parameters)


def name_text(name: str) -> str:
    """Return a name as written in a file, in single quotes if necessary."""
    plain = is_plain_name(name) and name not in STARTERS and not is_reserved(name)
    return name if plain else quote(name, "'")


class Trivia(NamedTuple):
    """Surroundings of a line: the comments and blank lines before it, the comment after it.

    `before` holds comment lines with their ``#``; an empty string is a blank line.
    """

    before: tuple[str, ...] = ()
    behind: str = ""


class BlockLine(NamedTuple):
    """A line below a statement that takes lines, as ``rules`` and ``lookup``."""

    tokens: tuple[Token, ...]
    trivia: Trivia


# --- A cursor in the tokens of one statement, and its faults ---


class Fault(Exception):  # noqa: N818 - it never leaves the parser
    """Reading the statement cannot go on; carries the diagnostic."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


class Cursor:
    """The tokens of a statement, at least one, and the progress of reading.

    Attributes
    ----------
    lines : sequence of BlockLine
        The lines below the statement.
    recovers : bool
        Whether reading continues after a mistake, to find further ones.
    forgiven : list of Diagnostic
        Mistakes that did not end reading.
    is_damaged : bool
        Whether one of them left a hole: the tokens after it are read for further mistakes only.
    mentioned : list
        Occurrences of names in the readable part of a damaged statement.
    """

    def __init__(
        self,
        tokens: tuple[Token, ...] | list[Token],
        lines: Sequence[BlockLine] = (),
        *,
        recovers: bool = False,
    ) -> None:
        self.tokens = tokens
        self.lines = lines
        self.recovers = recovers
        self.position = 0
        self.forgiven: list[Diagnostic] = []
        self.is_damaged = False
        self.mentioned: list[Any] = []
        self._hole = -2  # index of the last faulty token

    @property
    def at_end(self) -> bool:
        """Whether every token has been taken."""
        return self.position >= len(self.tokens)

    @property
    def span(self) -> Span:
        """Position of the next token; after the last one if there is none."""
        if not self.at_end:
            return self.tokens[self.position].span
        last = self.tokens[-1]
        return Span(last.line, last.end, last.line, last.end + 1)

    @property
    def whole(self) -> Span:
        """From the first to the last token."""
        first, last = self.tokens[0], self.tokens[-1]
        return Span(first.line, first.column, last.line, last.end)

    def peek(self, ahead: int = 0) -> Token | None:
        """Return the next token (or one further `ahead`) without taking it."""
        index = self.position + ahead
        return self.tokens[index] if index < len(self.tokens) else None

    def next_is(self, text: str, ahead: int = 0) -> bool:
        """Whether the next token (or one further `ahead`) is the word or mark `text`."""
        token = self.peek(ahead)
        return token is not None and token.text == text and token.kind in ("name", "mark")

    def take(self) -> Token:
        """Take the next token."""
        token = self.tokens[self.position]
        self.position += 1
        return token

    def accept(self, text: str, *, likely: bool = False) -> Token | None:
        """Take the next token if it is `text`; an editor offers words, and marks if `likely`."""
        return self.take() if self.next_is(text) else None

    def expect(self, text: str, where: str) -> Token:
        """Take the word or mark `text`; else raise a fault that it is missing `where`."""
        if not self.next_is(text):
            self._fail_or_mend(f"'{text}' {where}", (text,) if text.isalpha() else ())
        return self.take()

    def _fail_or_mend(self, expected: str, choices: Collection[str], name: str = "") -> str:
        """Note a misspelt word, and return the intended one of `choices`; else raise a fault."""
        try:
            self.fail(expected, choices, name)
        except Fault as fault:
            meant = fault.diagnostic.replacement
            if not self.recovers or meant is None or meant not in choices:
                raise
            self.forgiven.append(fault.diagnostic)
            return meant

    def damage(self, fault: Fault) -> None:
        """Note a fault that leaves a hole; one right behind another hole is the same mistake."""
        if self.position != self._hole + 1:
            self.forgiven.append(fault.diagnostic)
        self.is_damaged, self._hole = True, self.position

    @contextmanager
    def up_to(self, mark: str) -> Iterator[None]:
        """Read a part of a list; after a fault in it, continue with the next `mark`."""
        try:
            yield
        except Fault as fault:
            if not self.recovers:
                raise
            self.damage(fault)
            while not self.at_end and not self.next_is(mark):
                self.position += 1

    def fail(self, expected: str, choices: Collection[str] = (), name: str = "") -> NoReturn:
        """Raise the fault *expected …, found …*, with a hint if one of `choices` is near."""
        token = self.peek()
        text_there = "the end of the line" if token is None else f"'{token.text}'"
        hint, replacement = near_hint(token.text, choices) if token else ("", None)
        name = name or ("incomplete-statement" if token is None else "unexpected-token")
        message = f"expected {expected}, found {text_there}"
        raise Fault(Diagnostic(name, message, self.span, hint=hint, replacement=replacement))

    def forgive(self, fault: Fault) -> None:
        """Keep the diagnostic of `fault` and skip the rest of the line.

        For faults after the declared name of a statement: the name is known anyway, so its uses are
        not reported as mistakes, too.
        """
        self.damage(fault)
        self.position = len(self.tokens)

    def name(self, what: str) -> Word:
        """Take a name: a plain word that is not reserved, or one in single quotes."""
        token = self.peek()
        # Alone after the keyword it is the description, and the name is missing.
        described = self.position == 1 and self.peek(1) is None
        if token is not None and token.kind == "string" and not described:
            message = f"expected {what}, found text in double quotes"
            quoted = quote(token.text, "'")
            fault = Diagnostic("double-quoted-name", message, token.span)
            self.forgiven.append(replace(fault, hint=f"write  {quoted}", replacement=quoted))
        elif token is None or token.kind not in ("name", "quoted"):
            self._fail_at_digit(what)
            self.fail(what)
        if token.kind == "name" and is_reserved(token.text):
            raise Fault(
                Diagnostic(
                    "reserved-word",
                    f"expected {what}, found the reserved word '{token.text}'",
                    token.span,
                    hint=f"as a name it is written '{token.text}' with its quotes",
                    replacement=f"'{token.text}'",
                )
            )
        self.position += 1
        return Word(token.text, token.span)

    def _fail_at_digit(self, what: str) -> None:
        """Raise a fault if the next token is a name except for its first digit."""
        token, behind = self.peek(), self.peek(1)
        if token is None or behind is None or token.kind != "number" or token.end != behind.column:
            return
        if behind.kind == "name" and token.line == behind.line:
            name = f"'{token.text}{behind.text}'"
            raise Fault(
                Diagnostic(
                    "bad-number",
                    f"expected {what}, found {name}, which starts with a digit",
                    token.span.to(behind.span),
                    hint=f"as a name it is written {name} with its quotes",
                    replacement=name,
                )
            )

    def variable(self, what: str, role: str = "", follow: str = "") -> Word:
        """Take the name of a variable: an ``input``, an ``output`` or either.

        `follow` is the text that an editor adds after it.
        """
        return self.name(what)

    def term(self, what: str, variable: Word) -> Word:
        """Take the name of a term of `variable`."""
        return self.name(what)

    def suggest(self, what: str, *about: object) -> None:
        """Name a longer phrase possible here, for an editor to offer."""

    def word(self, what: str, choices: Collection[str], name: str) -> Word:
        """Take one of the words `choices`; a fault is called `name` and hints at the nearest."""
        token = self.peek()
        text = token.text if token is not None and token.kind == "name" else ""
        if text not in choices:
            text = self._fail_or_mend(what, choices, name)
        return Word(text, self.take().span)

    def string(self) -> Word | None:
        """Take a string in double quotes, or return None."""
        token = self.peek()
        if token is None or token.kind != "string":
            return None
        self.position += 1
        return Word(token.text, token.span)

    @property
    def at_figure(self) -> bool:
        """Whether a number is next, with or without a sign."""
        token = self.peek(1 if self.next_is("-") or self.next_is("+") else 0)
        return token is not None and (
            token.kind == "number" or (token.kind == "name" and token.text in ("inf", "nan"))
        )

    def figure(self, what: str, *, finite: bool = True) -> Figure:
        """Take a number with an optional sign; a fault if it is not finite but must be."""
        if not self.at_figure:
            return self._hole_for(what)
        start = self.span
        before = self.tokens[self.position - 1]
        where = before.line, before.end
        if self.position and before.kind == "number" and where == (start.line, start.column):
            message = f"a space is missing before '{self.tokens[self.position].text}'"
            raise Fault(Diagnostic("bad-number", message, start))
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

    def _hole_for(self, what: str) -> Figure:
        """Record a word in place of a number, and skip it; an error without one."""
        token = self.peek()
        try:
            self.fail(what)
        except Fault as fault:
            named = token is not None and token.kind != "mark" and not is_reserved(token.text)
            if not self.recovers or not named:
                raise
            self.damage(fault)
            return Figure(math.nan, self.take().span)

    def finish(self) -> None:
        """Require the end of the line."""
        if not self.at_end:
            self.fail("the end of the line", (), "trailing-text")
