"""Damage to texts, for fuzzing: the same seed gives the same damage."""

from __future__ import annotations

import random
import re

_WORDS = re.compile(r"\w+|\S")
_ODD = (
    "", "\x00", "\ufeff", "é", "💧", "'", '"', ";", ":", ":=", "[", "]", "(", ")", ",", "..", "#",
    "%", "/*", "*/", "(*", "//", "\r", "\n", "\t", "nan", "inf", "-inf", "1e999", "-0", "1e-320",
    "9" * 40, "-", "--", "not", "any", "very", "and", "or", "is", "if", "then", "with", "TERM",
    "RULE", "MF1=", "[Rules]", "RuleBlock:", "END_FUZZIFY", "term:", "0.99", "-1.3", "²", "١",
)  # fmt: skip


def mutated(text: str, others: list[str], random_: random.Random) -> str:
    """Return `text` with one or a few pieces of damage."""
    for _ in range(random_.choice((1, 1, 1, 2, 3, 6))):
        text = random_.choice(_KINDS)(text, others, random_)
    return text


def _cut(text: str, _: list[str], r: random.Random) -> str:
    i = r.randint(0, len(text))
    return text[:i] + text[i + r.choice((1, 1, 2, 5, 20, 200)) :]


def _insert(text: str, _: list[str], r: random.Random) -> str:
    i = r.randint(0, len(text))
    return text[:i] + r.choice(_ODD) + text[i:]


def _replace_word(text: str, _: list[str], r: random.Random) -> str:
    words = list(_WORDS.finditer(text))
    if not words:
        return text
    match = r.choice(words)
    new = r.choice((r.choice(_ODD), r.choice(words).group(), str(r.randint(-9, 99))))
    return text[: match.start()] + new + text[match.end() :]


def _swap_lines(text: str, _: list[str], r: random.Random) -> str:
    lines = text.split("\n")
    i, j = r.randrange(len(lines)), r.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return "\n".join(lines)


def _repeat(text: str, _: list[str], r: random.Random) -> str:
    i = r.randint(0, len(text))
    piece = text[i : i + r.choice((1, 8, 60))]
    return text[:i] + piece * r.choice((2, 2, 3, 30)) + text[i:]


def _graft(text: str, others: list[str], r: random.Random) -> str:
    donor = r.choice(others)
    i, j = r.randint(0, len(text)), r.randint(0, len(donor))
    return text[:i] + donor[j : j + r.choice((10, 80, 400))] + text[i:]


def _truncate(text: str, _: list[str], r: random.Random) -> str:
    return text[: r.randint(0, len(text))]


def _byte(text: str, _: list[str], r: random.Random) -> str:
    i = r.randint(0, len(text))
    return text[:i] + chr(r.randint(0, 255)) + text[i + 1 :]


_KINDS = (
    _cut, _cut, _insert, _insert, _replace_word, _replace_word, _replace_word, _swap_lines,
    _repeat, _graft, _byte, _truncate,
)  # fmt: skip
