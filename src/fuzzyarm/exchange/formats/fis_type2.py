"""FIS of interval type 2: the files of the toolbox of Taskin and Kumbasar, ``.t2fis`` or ``.fis``.

The keys of a type-1 file, with an upper and a lower function for each term of an input; a constant
of an output is two numbers, a linear term two rows.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from fuzzyarm.exchange.formats.dialects import words
from fuzzyarm.exchange.formats.findings import Findings, TextPiece, numbers
from fuzzyarm.exchange.formats.fis_text import BRACKETED
from fuzzyarm.exchange.formats.meaning import BlockDraft
from fuzzyarm.exchange.formats.sentences import NOT
from fuzzyarm.exchange.formats.shapes import make_shape
from fuzzyarm.language.model.rulebase import Shape, propositions
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS

MEMBERSHIP_KEY = re.compile(r"MF(\d{1,6})U?\Z", re.IGNORECASE)
LOWER_KEY = re.compile(r"MF(\d{1,6})L\Z", re.IGNORECASE)
"""With U the upper, with L the lower function of a term (spelling of the type-2 toolbox)."""

_OF_TOOLBOX = re.compile(
    r"^[^\S\n]*(MF\d+[UL]|TypeRedMethod|CrispInterval)\s*=", re.IGNORECASE | re.MULTILINE
)


def reductions() -> dict[str, str]:
    """Return the toolbox's words for type reduction, with the model's (some have several)."""
    return {"": "karnik-mendel"} | words(DEFUZZIFIERS, "t2fis")


def is_of_toolbox(text: str) -> bool:
    """Whether a text has keys of the toolbox alone."""
    return _OF_TOOLBOX.search(text) is not None


def interval_shapes(
    kind: TextPiece, rest: TextPiece, inputs: int, findings: Findings
) -> tuple[Shape, Shape | None] | None:
    """Return a constant ``[a b]`` or a linear term of two rows as its larger and smaller value.

    None for every other shape.
    """
    name = kind.text.lower()
    size = {"constant": 1, "linear": inputs + 1}.get(name)
    if size is None:
        return None
    words = rest.parts(BRACKETED)
    if len(words) != 2 * size:
        return None
    values = numbers(words, findings)
    if values is None:
        return None
    rows = values[:size], values[size:]
    shapes = [make_shape("singleton" if size == 1 else "linear", r, kind, findings) for r in rows]
    first, second = shapes
    if first is None or second is None:
        return None
    if first == second:
        return first, None
    # The model's lower value is the lesser of the two at each point.
    return (second, first) if first.parameters < second.parameters else (first, second)


def note_toolbox(block: BlockDraft, settings: Mapping[str, TextPiece], findings: Findings) -> None:
    """Set *and* to the product, as the toolbox does whatever the file says; refuse a *not*."""
    word = settings.get("andmethod")
    if block.conjunction != "product" and word is not None:
        message = f"the toolbox multiplies degrees, whatever AndMethod says ('{word.text[:20]}')"
        findings.warn("unsupported-norm", message, word)
    block.conjunction = "product"
    for text in block.rules:
        if any(NOT in part.hedges for part in propositions(text.antecedent)):
            message = "the toolbox divides by a degree with a minus sign, which cannot be converted"
            findings.loss("unsupported-hedge", message, text.span)
