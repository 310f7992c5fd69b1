"""FCL text as words, and a cursor that walks along them."""

from __future__ import annotations

import re

from fuzzyarm.formats.findings import Findings, Word, number
from fuzzyarm.text.diagnostic import NOWHERE, Span

# --- FCL text as words; comments and line ends are no words ---

_TOKEN = re.compile(
    r"(?P<space>[^\S\n]+)|(?P<newline>\n)"
    r"|(?P<line>(?://|#)[^\n]*)|(?P<block>/\*.*?\*/|\(\*.*?\*\))"
    r"|(?P<open>/\*|\(\*)"
    r"|(?P<number>(?:\d+(?:\.(?!\.)\d*)?|\.\d+)(?:[eE][+-]?\d+)?(?!\w))"
    r"|(?P<word>\w+)|(?P<sign>:=|\.\.|\*\*|\S)",
    re.DOTALL,
)
_PERCENT_LINE = re.compile(r"^[^\S\n]*%[^\n]*", re.MULTILINE)

KEYWORDS = frozenset(
    [
        "FUNCTION_BLOCK",
        "END_FUNCTION_BLOCK",
        "VAR_INPUT",
        "VAR_OUTPUT",
        "VAR",
        "END_VAR",
        "FUZZIFY",
        "END_FUZZIFY",
        "DEFUZZIFY",
        "END_DEFUZZIFY",
        "RULEBLOCK",
        "END_RULEBLOCK",
        "OPTIONS",
        "END_OPTIONS",
        "OPTION",
        "END_OPTION",
        "TERM",
        "RANGE",
        "METHOD",
        "DEFAULT",
        "ACCU",
        "ACT",
        "AND",
        "OR",
        "RULE",
        "ENABLED",
        "LOCK",
    ]
)
"""Words that begin a statement or end a section, in capitals."""

SECTIONS = ("FUNCTION_BLOCK", "VAR_INPUT", "VAR_OUTPUT", "FUZZIFY", "DEFUZZIFY", "RULEBLOCK")


def fcl_words(text: str, findings: Findings) -> list[Word]:
    """Return the words of a text, without its three kinds of comment."""
    text = _PERCENT_LINE.sub(lambda m: " " * len(m.group()), text)
    words: list[Word] = []
    line, line_start, position = 1, 0, 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:  # cannot be: the last alternative takes any character
            break
        kind, piece = match.lastgroup, match.group()
        column = position - line_start + 1
        position = match.end()
        if kind == "newline":
            line, line_start = line + 1, position
        elif kind == "block":
            line += piece.count("\n")
            if "\n" in piece:
                line_start = match.start() + piece.rfind("\n") + 1
        elif kind == "open":
            word = Word(piece, Span(line, column, line, column + 2))
            findings.error("open-comment", "the comment that begins here never ends", word)
            break
        elif kind in ("number", "word", "sign"):
            words.append(Word(piece, Span(line, column, line, column + len(piece))))
    return words


# --- A place among the words of an FCL text ---


class SyntaxFaultError(ValueError):
    """What is not as it should be, and at which word."""

    def __init__(self, message: str, word: Word, name: str = "syntax") -> None:
        super().__init__(message)
        self.word = word
        self.name = name


class Cursor:
    """Goes through words.

    Parameters
    ----------
    words : list of Word
        All of them.
    """

    def __init__(self, words: list[Word]) -> None:
        self.words = words
        self.at = 0

    @property
    def ended(self) -> bool:
        """Whether no word is left."""
        return self.at >= len(self.words)

    @property
    def word(self) -> Word:
        """The next word; an empty one at the end."""
        if self.at < len(self.words):
            return self.words[self.at]
        last = self.words[-1].span if self.words else NOWHERE
        return Word("", last)

    def key(self, ahead: int = 0) -> str:
        """Return a coming word in capitals."""
        index = self.at + ahead
        return self.words[index].text.upper() if index < len(self.words) else ""

    def take(self) -> Word:
        """Return the next word and go on."""
        word = self.word
        self.at += 1
        return word

    def skip(self, *keys: str) -> bool:
        """Go past the next word if it is one of `keys`."""
        if self.key() in keys and not self.ended:
            self.at += 1
            return True
        return False

    def expect(self, *keys: str) -> Word:
        """Return the next word, which must be one of `keys`."""
        if self.ended or self.key() not in keys:
            found = f"'{self.word.text[:40]}'" if not self.ended else "the end of the file"
            raise SyntaxFaultError(f"'{keys[0]}' is expected here, not {found}", self.word)
        return self.take()

    def name(self, what: str) -> Word:
        """Return the next word, which must be a name."""
        if self.ended or not (self.word.text[0].isalpha() or self.word.text[0] in "_0123456789"):
            raise SyntaxFaultError(f"the name of {what} is expected here", self.word)
        return self.take()

    def number(self) -> float:
        """Return the number that follows, with its signs."""
        first = self.word
        sign = 1.0
        while self.key() in ("+", "-"):
            if self.take().text == "-":
                sign = -sign
        value = number(self.word.text) if not self.ended else None
        if value is None:
            raise SyntaxFaultError("a number is expected here", first, "not-a-number")
        self.at += 1
        return sign * value

    def at_number(self) -> bool:
        """Whether a number follows."""
        ahead = 0
        while self.key(ahead) in ("+", "-"):
            ahead += 1
        text = self.key(ahead)
        return bool(text) and number(text) is not None

    def to_next_statement(self) -> None:
        """Skip to behind the next semicolon or before the next statement."""
        while not self.ended:
            if self.key() in KEYWORDS and self.key() not in ("AND", "OR"):
                return
            if self.take().text == ";":
                return
