"""Cut a text into lines of tokens. Every character ends up in a token or a diagnostic."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

from fuzzyarm.rulebase.diagnostic import Diagnostic, Span

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
_LINE_END = re.compile(r"\r\n|\r|\n")
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


def split_lines(text: str) -> list[str]:
    r"""Return the lines of `text`; only ``\n``, ``\r\n`` and ``\r`` end a line."""
    lines = _LINE_END.split(text)
    if lines and lines[-1] == "":
        lines.pop()
    return lines


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


def quote(text: str, mark: str) -> str:
    """Return `text` between two `mark` characters, with everything unprintable escaped."""
    out = [mark]
    for character in text:
        if character in (mark, "\\"):
            out.append("\\" + character)
        elif character.isprintable():
            out.append(character)
        else:
            code = ord(character)
            out.append(f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}")
    return "".join([*out, mark])


_PLAIN_NAME = re.compile(r"[^\W\d]\w*(?:-[^\W\d]\w*)*\Z")


def is_plain_name(text: str) -> bool:
    """Whether `text` can stand in a file as a name without quotes."""
    return _PLAIN_NAME.match(text) is not None
