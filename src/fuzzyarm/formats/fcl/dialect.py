"""Which of the two dialects an FCL text is written in, and what each takes for granted."""

from __future__ import annotations

import re

from fuzzyarm.formats.draft import VALUES, Draft
from fuzzyarm.formats.fll.outputs import settle_weighted
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.rule_text import Dialect
from fuzzyarm.rulebase.model import Defuzzifier

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
