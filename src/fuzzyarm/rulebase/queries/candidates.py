"""What can be offered at a place: words of the language, names, shapes with their numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from fuzzyarm.rulebase.diagnostic import Span
from fuzzyarm.rulebase.membership import FUNCTIONS
from fuzzyarm.rulebase.model import Variable
from fuzzyarm.rulebase.printing.words import name_text, number_text
from fuzzyarm.rulebase.shapes import SHAPES, ShapeKind
from fuzzyarm.rulebase.syntax.words import HEDGE_WORDS

HEDGE_EFFECTS: dict[str, str] = {
    "not": "1 − d",
    "very": "d²",
    "somewhat": "√d",
    "extremely": "d³",
    "intensify": "2d² up to one half, then 1 − 2(1 − d)²",
    "seldom": "√(d/2) up to one half, then 1 − √((1 − d)/2)",
    "any": "1",
    "power": "dᵖ",
}
"""What each hedge makes of a degree d."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One thing that could stand at a place.

    Attributes
    ----------
    label : str
        What a list shows.
    kind : str
        ``keyword``, ``variable``, ``term``, ``shape``, ``hedge``, ``value`` or ``row``.
    insert : str
        The text to put there.
    detail : str
        A few words beside the label.
    snippet : str
        The same text with places to fill in, as ``${1:left}``; empty where there are none.
    span : Span or None
        The text that has been typed already and is replaced; set by `complete`.
    """

    label: str
    kind: str
    insert: str
    detail: str = ""
    snippet: str = ""
    span: Span | None = None


def keywords(words: Iterable[str], details: dict[str, str] | None = None) -> list[Candidate]:
    """Return words of the language."""
    return [Candidate(word, "keyword", word, (details or {}).get(word, "")) for word in words]


def values(words: Iterable[str]) -> list[Candidate]:
    """Return the values of a setting."""
    return [Candidate(word, "value", word) for word in words]


def variables(them: Iterable[Variable], follow: str = "") -> list[Candidate]:
    """Return names of variables with `follow` behind each."""
    return [
        Candidate(v.name, "variable", name_text(v.name) + follow, variable_detail(v)) for v in them
    ]


def variable_detail(variable: Variable) -> str:
    """Return range and description in a few words."""
    text = f"{number_text(variable.low)} .. {number_text(variable.high)}"
    return f"{text}  {variable.description}".rstrip()


def terms(variable: Variable | None, without: Iterable[str] = ()) -> list[Candidate]:
    """Return the terms of a variable in their order."""
    if variable is None:
        return []
    left_out = set(without)
    return [
        Candidate(term.name, "term", name_text(term.name), term_detail(variable, term.name))
        for term in variable.terms
        if term.name not in left_out
    ]


def term_detail(variable: Variable, name: str) -> str:
    """Return the shape of a term as it would stand in a file."""
    shape = variable.term(name).shape
    if shape.kind in ("formula", "linear"):
        return shape.kind
    return " ".join([shape.kind, *(f"{x:.6g}" for x in shape.parameters)])


def hedges() -> list[Candidate]:
    """Return the hedges."""
    return [
        Candidate(
            word,
            "hedge",
            "power(2)" if word == "power" else word,
            HEDGE_EFFECTS[meaning],
            "power(${1:2})" if word == "power" else "",
        )
        for word, meaning in HEDGE_WORDS.items()
    ]


def shapes() -> list[Candidate]:
    """Return every shape with its numbers as places to fill in."""
    return [_shape(kind) for kind in SHAPES.values()]


def _shape(kind: ShapeKind) -> Candidate:
    special = {
        "points": "points (${1:0}, ${2:0}) (${3:1}, ${4:1})",
        "linear": "linear ${1:0}",
        "formula": 'formula "${1:0}"',
    }
    numbers = " ".join(f"${{{i}:{name}}}" for i, name in enumerate(kind.parameters, start=1))
    snippet = special.get(kind.name) or f"{kind.name} {numbers}"
    parameters = " ".join(kind.parameters)
    detail = f"{parameters} — {kind.summary}" if kind.name in FUNCTIONS else kind.summary
    return Candidate(kind.name, "shape", kind.name, detail.lstrip(" —"), snippet)
