"""The defuzzifiers of fuzzylite."""

from __future__ import annotations

from fuzzyarm.formats.draft import VALUES, Draft
from fuzzyarm.formats.fll.lines import Line
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.numerals import number
from fuzzyarm.rulebase.model import Defuzzifier

INTEGRAL = {
    "Bisector": "bisector",
    "Centroid": "centroid",
    "LargestOfMaximum": "largest-of-maximum",
    "MeanOfMaximum": "mean-of-maximum",
    "SmallestOfMaximum": "smallest-of-maximum",
}
WEIGHTED = {"WeightedAverage": "weighted-average", "WeightedSum": "weighted-sum"}
TYPES = ("Automatic", "TakagiSugeno", "Tsukamoto")
DEFAULT_RESOLUTION = 1000
"""Of fuzzylite 7 and 8; version 6 took 100 and always wrote it."""

MAX_RESOLUTION = 10_000_000
MONOTONIC = frozenset({"arc", "concave", "ramp", "sigmoid", "s", "z"})


def settle_defuzzifier(draft: Draft, line: Line | None, findings: Findings) -> None:
    """Set the defuzzifier of an output from its line."""
    words = line.words() if line is not None else []
    if line is None or not words or words[0].text == "none":
        message = f"the output '{draft.name}' has no defuzzifier"
        at = line.key if line is not None else draft.word
        findings.error("no-defuzzifier", message, at)
        return
    method = words[0].text
    if method in INTEGRAL:
        resolution = _resolution(words, findings)
        draft.defuzzifier = Defuzzifier(INTEGRAL[method], resolution, "midpoints")
        _check_sets(draft, line.value, findings)
    elif method in WEIGHTED:
        kind = words[1].text if len(words) > 1 else "Automatic"
        if kind not in TYPES:
            findings.unknown("unknown-defuzzifier", "the type", words[1], TYPES)
            return
        settle_weighted(draft, WEIGHTED[method], kind, line.value, findings)
    else:
        findings.unknown("unknown-defuzzifier", "the method", words[0], (*INTEGRAL, *WEIGHTED))


def _resolution(words: list[Word], findings: Findings) -> int:
    if len(words) < 2:
        return DEFAULT_RESOLUTION
    value = number(words[1].text)
    if value is None or not value.is_integer() or not 1 <= value <= MAX_RESOLUTION:
        message = f"'{words[1].text[:40]}' is no resolution (1 to {MAX_RESOLUTION})"
        findings.error("bad-resolution", message, words[1])
        return DEFAULT_RESOLUTION
    return int(value)


def _check_sets(draft: Draft, at: Word, findings: Findings) -> None:
    if any(term.shape.kind in VALUES for term in draft.terms):
        message = (
            f"'{draft.name}' has terms that are values, which fuzzylite integrates as if "
            "they were sets; that cannot be carried"
        )
        findings.loss("value-as-set", message, at)


def settle_weighted(draft: Draft, method: str, kind: str, at: Word, findings: Findings) -> None:
    """Set a weighted defuzzifier, Takagi-Sugeno or Tsukamoto by `kind` or by the terms."""
    kinds = {term.shape.kind for term in draft.terms}
    if kind == "Automatic":
        kind = "Tsukamoto" if kinds and kinds <= MONOTONIC else "TakagiSugeno"
    if kind == "Tsukamoto":
        if not kinds <= MONOTONIC:
            message = f"'{draft.name}' has terms without an inverse, which Tsukamoto needs"
            findings.error("not-monotonic", message, at)
        if method == "weighted-sum":
            message = "a weighted sum of Tsukamoto terms cannot be carried"
            findings.loss("weighted-sum-of-tsukamoto", message, at)
        draft.defuzzifier = Defuzzifier("tsukamoto")
        return
    if not kinds <= VALUES:
        message = (
            f"'{draft.name}' has sets where values are needed; fuzzylite takes the membership "
            "of the firing strength, which cannot be carried"
        )
        findings.loss("set-as-value", message, at)
    draft.defuzzifier = Defuzzifier(method)
