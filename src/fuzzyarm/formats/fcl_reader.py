"""FCL, the language of IEC 61131-7, as jFuzzyLogic, fuzzylite and others write it: read."""

from __future__ import annotations

import re

from fuzzyarm.formats.dialects import FCL, Dialect
from fuzzyarm.formats.drafts import imported
from fuzzyarm.formats.fcl_blocks import Reader
from fuzzyarm.formats.fcl_scikit import ScikitReader
from fuzzyarm.formats.findings import Findings, Imported
from fuzzyarm.model.rulebase import RuleBase

# --- Which program a text was written for ---

_ONLY_FUZZYLITE = re.compile(
    r"[:=]\s*(EPROD|DPROD|HPROD|ESUM|DSUM|HSUM|NMIN|NMAX|COGSS|Triangle|Trapezoid|Bell|Gaussian|"
    r"Sigmoid|Ramp|Rectangle|ZShape|SShape|PiShape|Linear|Concave|Spike|Discrete)\b"
    r"|^[^\S\n]*(ENABLED|LOCK)\s*:",
    re.MULTILINE,
)


_STEP = re.compile(r"\bRANGE\b[\s:=]*\([^()]*\)\s*WITH\b", re.IGNORECASE)
_COMMENT = re.compile(r"//[^\n]*|#[^\n]*|/\*.*?(?:\*/|\Z)|\(\*.*?(?:\*\)|\Z)", re.DOTALL)
_IN_INPUT = re.compile(r"\b(?:FUZZIFY|END_FUZZIFY|RANGE)\b", re.IGNORECASE)


def detect(text: str) -> str:
    """Return the program of a text: jFuzzyLogic unless something says another.

    A range inside FUZZIFY is refused by jFuzzyLogic, its step by fuzzylite as well.
    """
    plain = _COMMENT.sub("", text)
    if _STEP.search(plain):
        return "scikit-fuzzy"
    head = text[:2000].lower()
    if "fuzzylite" in head or _ONLY_FUZZYLITE.search(plain) or _has_accu_in_defuzzify(plain):
        return "fuzzylite"
    if _has_range_in_fuzzify(plain):
        # The words of a rule are in small letters to fuzzylite, and in no other case.
        return "fuzzylite" if re.search(r"\bif\b", plain) else "scikit-fuzzy"
    return "jfuzzylogic"


def _has_range_in_fuzzify(text: str) -> bool:
    has_range: bool | None = None  # outside of a section
    for match in _IN_INPUT.finditer(text):
        match match.group().upper():
            case "FUZZIFY":
                has_range = bool(has_range)
            case "RANGE":
                has_range = None if has_range is None else True
            case _:
                if has_range:
                    return True
                has_range = None
    return False


def _has_accu_in_defuzzify(text: str) -> bool:
    inside = False
    for match in re.finditer(r"\b(END_DEFUZZIFY|DEFUZZIFY|ACCU)\b", text, re.IGNORECASE):
        word = match.group().upper()
        if word == "ACCU" and inside:
            return True
        if word != "ACCU":
            inside = word == "DEFUZZIFY"
    return False


# --- Read FCL ---


def parse_fcl(
    text: str,
    path: str = "<text>",
    *,
    dialect: str | None = None,
    block: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Read a function block: :func:`~fuzzyarm.formats.registry.parse` of ``.fcl``.

    The `dialect` is the producer there, ``jfuzzylogic``, ``fuzzylite`` or ``scikit-fuzzy``.

    Parameters
    ----------
    text, path, dialect, block, lossy, strict
        As there.

    Returns
    -------
    Imported
        The rule base, if there is no error, and every finding.
    """

    def read(plain: str, findings: Findings) -> tuple[RuleBase | None, Dialect]:
        found = FCL[dialect or detect(plain)]
        reader = ScikitReader if found.producer == "scikit-fuzzy" else Reader
        return reader(plain, found, findings).read(block), found

    return imported(text, path, read, lossy=lossy, strict=strict)
