"""The two dialects of FCL: how to tell them apart, and what each takes for granted."""

from __future__ import annotations

import math
import re
from dataclasses import replace

from fuzzyarm.formats.findings import VALUES, Draft, Findings, Word
from fuzzyarm.formats.fll.reader import settle_weighted
from fuzzyarm.formats.rules import Dialect
from fuzzyarm.model.rulebase import Defuzzifier, Shape, Term

# --- Which of the two dialects an FCL text is written in, and what each takes for granted ---

RULES = {
    "jfuzzylogic": Dialect(equal_precedence=True, ignore_case=True, separators=(",", "and")),
    "fuzzylite": Dialect(ignore_case=True, separators=("and", ",")),
}

SAMPLINGS = {"jfuzzylogic": (1000, "left"), "fuzzylite": (1000, "midpoints")}

INTEGRAL = {
    "COG": "centroid",
    "COA": "bisector",
    "LM": "smallest-of-maximum",
    "RM": "largest-of-maximum",
    "MM": "mean-of-maximum",
}
WEIGHTED = {"COGS": "weighted-average", "COGF": "weighted-average", "COGSS": "weighted-sum"}
METHODS = (*INTEGRAL, *WEIGHTED)

_ONLY_FUZZYLITE = re.compile(
    r"[:=]\s*(EPROD|DPROD|HPROD|ESUM|DSUM|HSUM|NMIN|NMAX|COGSS|Triangle|Trapezoid|Bell|Gaussian|"
    r"Sigmoid|Ramp|Rectangle|ZShape|SShape|PiShape|Linear|Concave|Spike|Discrete)\b"
    r"|^\s*(ENABLED|LOCK)\s*:",
    re.MULTILINE,
)


def detect(text: str) -> str:
    """Return the dialect of a text: jFuzzyLogic's unless something says fuzzylite."""
    head = text[:2000].lower()
    if "fuzzylite" in head:
        return "fuzzylite"
    if "jfuzzylogic" in head:
        return "jfuzzylogic"
    plain = re.sub(r"//[^\n]*|#[^\n]*", "", text)
    if _ONLY_FUZZYLITE.search(plain) or _has_accu_in_defuzzify(plain):
        return "fuzzylite"
    return "jfuzzylogic"


def _has_accu_in_defuzzify(text: str) -> bool:
    inside = False
    for match in re.finditer(r"\b(END_DEFUZZIFY|DEFUZZIFY|ACCU)\b", text, re.IGNORECASE):
        word = match.group().upper()
        if word == "ACCU" and inside:
            return True
        if word != "ACCU":
            inside = word == "DEFUZZIFY"
    return False


def finish_output(draft: Draft, method: Word | None, dialect: str, findings: Findings) -> None:
    """Set the defuzzifier of an output from its ``METHOD``."""
    name = method.text.upper() if method is not None else "COG"
    at = method if method is not None else draft.word
    if name in WEIGHTED:
        if dialect == "fuzzylite":
            settle_weighted(draft, WEIGHTED[name], "Automatic", at, findings)
            return
        if not {term.shape.kind for term in draft.terms} <= VALUES:
            message = f"'{draft.name}' has sets where {name} needs singletons or functions"
            findings.error("set-as-value", message, at)
        draft.defuzzifier = Defuzzifier(WEIGHTED[name])
        return
    if name not in INTEGRAL:
        findings.unknown("unknown-defuzzifier", "the method", Word(name, at.span), METHODS)
        return
    resolution, sampling = SAMPLINGS[dialect]
    draft.defuzzifier = Defuzzifier(INTEGRAL[name], resolution, sampling)
    if name == "COA" and dialect == "jfuzzylogic":
        message = "jFuzzyLogic finds the middle of the area one sample coarser than the model"
        findings.info("bisector-rule", message, at)
    if any(term.shape.kind in VALUES for term in draft.terms):
        _singletons_integrated(draft, dialect, at, findings)


def _singletons_integrated(draft: Draft, dialect: str, at: Word, findings: Findings) -> None:
    singletons = all(term.shape.kind == "singleton" for term in draft.terms)
    message = f"'{draft.name}' has values for terms but integrates sets"
    if dialect == "jfuzzylogic" and singletons:
        findings.warn("value-as-set", message, at, "METHOD : COGS is for singletons")
    else:
        findings.loss("value-as-set", message, at, "METHOD : COGS is for singletons")


# --- Where jFuzzyLogic takes its samples, to the last bit ---
#
# It walks along the range by adding up steps; the model multiplies them. The two differ by
# some 1e-16, which matters only to a vertical edge that stands exactly on a sample: there
# the one may see 1 and the other 0.


def settle_edges(draft: Draft, findings: Findings) -> None:
    """Move vertical edges by one step of the machine where that makes the samples agree.

    Parameters
    ----------
    draft : Draft
        A sampled output; its terms are changed in place.
    findings : Findings
        Where each change is told.
    """
    count = draft.defuzzifier.resolution
    if count is None:
        return
    places: list[tuple[float, float]] = []
    for index, term in enumerate(draft.terms):
        if not any(_edges(term.shape)):
            continue
        places = places or _places(draft.low, draft.high, count)
        moved = _moved(term.shape, places, draft.low, draft.high)
        if moved != term.shape:
            message = (
                f"an edge of '{term.name}' stands on a sample that jFuzzyLogic takes right "
                "beside it; it is moved by the smallest step there is"
            )
            findings.info("edge-on-sample", message, term.span)
            draft.put(index, Term(term.name, moved, term.span))


def _places(low: float, high: float, count: int) -> list[tuple[float, float]]:
    """Return the samples of the model and of jFuzzyLogic, pairwise."""
    step = (high - low) / count
    pairs = []
    x = low
    for index in range(count):
        pairs.append((low + index * step, x))
        x += step
    return pairs


def _edges(shape: Shape) -> tuple[bool, bool]:
    """Return whether the left and the right flank are vertical."""
    p = shape.parameters
    match shape.kind:
        case "triangle":
            return p[0] == p[1], p[1] == p[2]
        case "trapezoid":
            return p[0] == p[1], p[2] == p[3]
        case "rectangle" | "singleton":
            return True, True
    return False, False


def _moved(shape: Shape, places: list[tuple[float, float]], low: float, high: float) -> Shape:
    left, right = _edges(shape)
    p = list(shape.parameters)
    if left and _seen_from(p[0], places) < 0:
        up = math.nextafter(p[0], high)
        p = [up if value == shape.parameters[0] else value for value in p]
    if right and _seen_from(p[-1], places) > 0:
        down = math.nextafter(p[-1], low)
        p = [down if value == p[-1] else value for value in p]
    return replace(shape, parameters=tuple(p))


def _seen_from(edge: float, places: list[tuple[float, float]]) -> int:
    """Return -1 or 1 where a sample on the edge is taken before or behind it, else 0."""
    for model, walked in places:
        if model == edge:
            return (walked > edge) - (walked < edge)
    return 0
