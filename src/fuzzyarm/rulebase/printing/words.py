"""Print names, numbers and strings so that they read back to the same value."""

from __future__ import annotations

import math

from fuzzyarm.rulebase.syntax.nodes import Figure, HedgeNode, Word
from fuzzyarm.rulebase.syntax.tokens import is_plain_name, quote
from fuzzyarm.rulebase.syntax.words import QUOTED


def name_text(name: str) -> str:
    """Return a name as it stands in a file, in single quotes where it must."""
    return name if is_plain_name(name) and name not in QUOTED else quote(name, "'")


def word_text(word: Word) -> str:
    """Return the name of `word` as it stands in a file."""
    return name_text(word.text)


def number_text(value: float) -> str:
    """Return the shortest text that reads back to `value` exactly."""
    if not math.isfinite(value):
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf")
    if value == int(value) and abs(value) < 1e15 and not _is_negative_zero(value):
        return str(int(value))
    return repr(float(value))


def _is_negative_zero(value: float) -> bool:
    return value == 0.0 and math.copysign(1.0, value) < 0.0


def figure_text(figure: Figure) -> str:
    """Return a number as it stands in a file."""
    return number_text(figure.value)


def string_text(text: str) -> str:
    """Return a description in double quotes."""
    return quote(text, '"')


def hedges_text(hedges: tuple[HedgeNode, ...]) -> str:
    """Return hedges with a space behind each."""
    out = ""
    for hedge in hedges:
        exponent = f"({figure_text(hedge.exponent)})" if hedge.exponent else ""
        out += f"{hedge.word.text}{exponent} "
    return out
