"""FCL text as words; comments and line ends are no words."""

from __future__ import annotations

import re

from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.rulebase.diagnostic import Span

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
