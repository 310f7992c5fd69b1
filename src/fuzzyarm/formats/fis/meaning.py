"""What a FIS means to the three programs that read it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

from fuzzyarm.formats.draft import Draft
from fuzzyarm.formats.fis.lines import Section, key_and_value, unquoted
from fuzzyarm.formats.fll.outputs import MONOTONIC, VALUES, settle_weighted
from fuzzyarm.formats.fuzzylite_rules import Norms, RuleBuilder
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.norms import FIS_CONJUNCTIONS, FIS_DISJUNCTIONS
from fuzzyarm.formats.propositions import RuleText
from fuzzyarm.rulebase.model import Defuzzifier, Rule, RuleBlock, Shape, Term

PRODUCERS = ("matlab", "octave", "fuzzylite")

SAMPLINGS = {
    "matlab": (101, "endpoints"),
    "octave": (101, "trapezoid"),
    "fuzzylite": (1000, "midpoints"),
}
"""How each program samples an output unless told otherwise."""

INTEGRAL = {
    "centroid": "centroid",
    "centroid_integral": "centroid",
    "bisector": "bisector",
    "mom": "mean-of-maximum",
    "som": "smallest-of-maximum",
    "lom": "largest-of-maximum",
}
WEIGHTED = {"wtaver": "weighted-average", "wtsum": "weighted-sum"}
_DEFUZZIFIERS = (*INTEGRAL, *WEIGHTED)
_KEYS = (
    "name", "type", "version", "numinputs", "numoutputs", "numrules", "andmethod", "ormethod",
    "impmethod", "aggmethod", "defuzzmethod", "nummfs",
)  # fmt: skip

_FUZZYLITE_KEYS = re.compile(r"^\s*(lockprevious|lockrange|enabled)\s*=", re.I | re.M)
_ONLY_OCTAVE = re.compile(
    r"'(einstein|hamacher|drastic|bounded)_(sum|product|difference)'|centroid_integral", re.I
)
_FRACTION = re.compile(r"^\s*(-?\d+(\.\d+)?\s+)*-?\d+\.0*[1-9]\d*[\s,]", re.M)


def detect(text: str) -> str:
    """Return the program that a text was most likely written for."""
    comments = "\n".join(
        line for line in text.split("\n")[:60] if line.lstrip()[:1] in ("#", "%", "/")
    ).lower()
    if "fuzzylite" in comments or _FUZZYLITE_KEYS.search(text):
        return "fuzzylite"
    if "octave" in comments or "fuzzy-logic-toolkit" in comments:
        return "octave"
    rules = text.lower().partition("[rules]")[2]
    if _ONLY_OCTAVE.search(text) or _FRACTION.search(rules):
        return "octave"
    return "matlab"


@dataclass(slots=True)
class System:
    """The settings of ``[System]`` by key in small letters."""

    values: dict[str, Word] = field(default_factory=dict)

    def read(self, section: Section, findings: Findings) -> None:
        """Read the lines of the section."""
        for line in section.lines:
            parts = key_and_value(line)
            if parts is None:
                findings.error("syntax", f"'{line.text[:40]}' is no 'key=value'", line)
                continue
            key, value = parts
            if key.text.lower() not in _KEYS:
                findings.unknown("unknown-key", "the key", key, _KEYS)
                continue
            self.values[key.text.lower()] = unquoted(value)

    def text(self, key: str) -> str:
        """Return the value of a key, empty where there is none."""
        word = self.values.get(key)
        return word.text.strip() if word is not None else ""

    def norm(self, key: str, table: dict[str, str], default: str, findings: Findings) -> str:
        """Return the norm that `key` names."""
        name = self.text(key)
        if not name:
            return default
        if name.lower() not in table:
            findings.unknown("unknown-norm", f"the {key}", self.values[key], table)
            return default
        return table[name.lower()]


def finish_output(draft: Draft, system: System, producer: str, findings: Findings) -> None:
    """Set aggregation, defuzzifier and the value without rules of an output."""
    name = system.text("defuzzmethod").lower()
    is_sugeno = system.text("type").lower() == "sugeno"
    if not name:
        name = "wtaver" if is_sugeno else "centroid"
    at = system.values.get("defuzzmethod", draft.word)
    draft.aggregation = system.norm("aggmethod", FIS_DISJUNCTIONS, "max", findings)
    if producer == "matlab" and _is_nan(draft.no_rule) and _bounded(draft):
        draft.no_rule = 0.5 * (draft.low + draft.high)
    if name in WEIGHTED:
        if producer == "fuzzylite":
            settle_weighted(draft, WEIGHTED[name], "Automatic", at, findings)
        else:
            _weighted(draft, WEIGHTED[name], at, findings)
    elif name in INTEGRAL:
        resolution, sampling = SAMPLINGS[producer]
        draft.defuzzifier = Defuzzifier(INTEGRAL[name], resolution, sampling)
        _values_as_sets(draft, producer, at, findings)
        if not _bounded(draft):
            message = f"the output '{draft.name}' needs a range to be integrated over"
            findings.error("bad-range", message, draft.word)
    else:
        word = system.values["defuzzmethod"]
        findings.unknown("unknown-defuzzifier", "the method", word, _DEFUZZIFIERS)


def _weighted(draft: Draft, method: str, at: Word, findings: Findings) -> None:
    # To MATLAB and Octave every rule counts for itself, whatever AggMethod says.
    draft.aggregation = "sum"
    kinds = {term.shape.kind for term in draft.terms}
    if kinds and kinds <= MONOTONIC:
        draft.defuzzifier = Defuzzifier("tsukamoto")
        return
    if not kinds <= VALUES:
        message = f"'{draft.name}' has sets where a weighted defuzzifier needs values"
        findings.error("set-as-value", message, at)
    draft.defuzzifier = Defuzzifier(method)


def _values_as_sets(draft: Draft, producer: str, at: Word, findings: Findings) -> None:
    """Express constants that are integrated: to fuzzylite a constant is a set of that height."""
    for index, term in enumerate(draft.terms):
        if term.shape.kind not in VALUES:
            continue
        if producer == "fuzzylite" and term.shape.kind == "singleton" and _bounded(draft):
            message = (
                f"fuzzylite integrates the constant '{term.name}' as a set of that height "
                "over the whole range"
            )
            findings.warn("value-as-set", message, term.span)
            height = term.shape.parameters[0]
            shape = Shape("rectangle", (draft.low, draft.high), height)
            draft.terms[index] = Term(term.name, shape, term.span)
            continue
        message = f"'{term.name}' of '{draft.name}' is a value, which cannot be integrated"
        findings.loss("value-as-set", message, at)


def rules_in_model(
    texts: list[RuleText],
    drafts: dict[str, Draft],
    system: System,
    producer: str,
    findings: Findings,
) -> RuleBlock:
    """Return the block of all rules."""
    conjunction = system.norm("andmethod", FIS_CONJUNCTIONS, "min", findings)
    disjunction = system.norm("ormethod", FIS_DISJUNCTIONS, "max", findings)
    implication = system.norm("impmethod", FIS_CONJUNCTIONS, "min", findings)
    if producer == "fuzzylite":
        norms = Norms(conjunction, disjunction, implication)
        return RuleBuilder(drafts, findings).block("", norms, texts)
    rules = [
        Rule(text.antecedent, text.conclusions, text.weight, text.span) for text in texts
    ]
    return RuleBlock(
        tuple(_value_hedges(rule, drafts, findings) for rule in rules),
        "",
        conjunction,
        disjunction,
        implication,
    )


def _value_hedges(rule: Rule, drafts: dict[str, Draft], findings: Findings) -> Rule:
    """Leave out hedges on values, which Octave ignores: a hedge needs a set."""
    plain = []
    for consequent in rule.consequents:
        draft = drafts[consequent.variable]
        weighted = draft.defuzzifier.method in ("weighted-average", "weighted-sum", "tsukamoto")
        if consequent.hedges and weighted:
            message = f"a hedge on the value '{consequent.term}' does nothing and is left out"
            findings.warn("dropped-hedge", message, consequent.span)
            plain.append(replace(consequent, hedges=()))
        else:
            plain.append(consequent)
    return replace(rule, consequents=tuple(plain))


def _bounded(draft: Draft) -> bool:
    return math.isfinite(draft.low) and math.isfinite(draft.high)


def _is_nan(value: float | str) -> bool:
    return isinstance(value, float) and math.isnan(value)
