"""What a FIS means to the three programs that read it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

from fuzzyarm.formats.draft import VALUES, Draft, same_value
from fuzzyarm.formats.fis.lines import Section, key_and_value, unquoted
from fuzzyarm.formats.fll.outputs import MONOTONIC, settle_weighted
from fuzzyarm.formats.fuzzylite_rules import (
    MACHINE_EPSILON,
    POWERS,
    Norms,
    RuleBuilder,
    around,
    hedged_weight,
)
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.norms import FIS_CONJUNCTIONS, FIS_DISJUNCTIONS
from fuzzyarm.formats.rule_text import RuleText
from fuzzyarm.rulebase.model import (
    Consequent,
    Defuzzifier,
    Hedge,
    Output,
    Rule,
    RuleBlock,
    Shape,
    Term,
)

PRODUCERS = ("matlab", "octave", "fuzzylite")

SAMPLINGS = {
    "matlab": (101, "endpoints"),
    "octave": (101, "endpoints"),
    "fuzzylite": (1000, "midpoints"),
}
"""How each program samples an output unless told otherwise.

Octave's toolkit has a second method, ``centroid_integral``, by the trapezoid rule.
"""

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

_FUZZYLITE_KEYS = re.compile(
    r"^\s*(lockprevious|lockrange|enabled)\s*=", re.IGNORECASE | re.MULTILINE
)
_ONLY_OCTAVE = re.compile(
    r"'(einstein|hamacher|drastic|bounded)_(sum|product|difference)'|centroid_integral",
    re.IGNORECASE,
)
_FRACTION = re.compile(r"^\s*(-?\d+(\.\d+)?\s+)*-?\d+\.0*[1-9]\d*[\s,]", re.MULTILINE)


def detect(text: str) -> str:
    """Return the program that a text was most likely written for."""
    comments = "\n".join(
        line for line in text.split("\n")[:60] if line.lstrip()[:1] in ("#", "%", "/")
    ).lower()
    if "fuzzylite" in comments or _FUZZYLITE_KEYS.search(text):
        return "fuzzylite"
    if "for matlab" in comments:
        return "matlab"
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
            _weighted(draft, WEIGHTED[name], producer, at, findings)
    elif name in INTEGRAL:
        resolution, sampling = SAMPLINGS[producer]
        if name == "centroid_integral":
            sampling = "trapezoid"
        draft.defuzzifier = Defuzzifier(INTEGRAL[name], resolution, sampling)
        if producer == "fuzzylite" and _is_nan(draft.no_rule):
            draft.no_rule = maximum_of_nothing(draft)
        _values_as_sets(draft, system, producer, at, findings)
        if not _bounded(draft):
            message = f"the output '{draft.name}' needs a range to be integrated over"
            findings.error("bad-range", message, draft.word)
    else:
        word = system.values["defuzzmethod"]
        findings.unknown("unknown-defuzzifier", "the method", word, _DEFUZZIFIERS)


def _weighted(draft: Draft, method: str, producer: str, at: Word, findings: Findings) -> None:
    if producer == "matlab":  # every rule counts for itself, whatever AggMethod says
        draft.aggregation = "sum"
    kinds = {term.shape.kind for term in draft.terms}
    if kinds and kinds <= MONOTONIC:
        draft.defuzzifier = Defuzzifier("tsukamoto")
        return
    if not kinds <= VALUES:
        message = f"'{draft.name}' has sets where a weighted defuzzifier needs values"
        findings.error("set-as-value", message, at)
    draft.defuzzifier = Defuzzifier(method)


def maximum_of_nothing(draft: Draft | Output) -> float:
    """Return what fuzzylite 7 takes for the maximum of an empty output: all samples are it."""
    defuzzifier = draft.defuzzifier
    half_step = 0.5 * (draft.high - draft.low) / (defuzzifier.resolution or 1)
    match defuzzifier.method:
        case "mean-of-maximum":
            return 0.5 * (draft.low + draft.high)
        case "smallest-of-maximum":
            return draft.low + half_step
        case "largest-of-maximum":
            return draft.high - half_step
    return math.nan


def _values_as_sets(
    draft: Draft, system: System, producer: str, at: Word, findings: Findings
) -> None:
    """Express constants that are integrated: to fuzzylite a constant is a set of that height."""
    for index, term in enumerate(draft.terms):
        if term.shape.kind not in VALUES:
            continue
        height = _height(term, system, findings) if producer == "fuzzylite" else 0.0
        if height > 0.0 and _bounded(draft):
            message = (
                f"fuzzylite integrates the constant '{term.name}' as a set of that height "
                "over the whole range"
            )
            findings.warn("value-as-set", message, term.span)
            shape = Shape("rectangle", (draft.low, draft.high), height)
            draft.put(index, Term(term.name, shape, term.span))
            continue
        message = f"'{term.name}' of '{draft.name}' is a value, which cannot be integrated"
        findings.loss("value-as-set", message, at)


def _height(term: Term, system: System, findings: Findings) -> float:
    """Return the height of the set that a constant is to fuzzylite; 0 where it is none."""
    if term.shape.kind != "singleton":
        return 0.0
    value = term.shape.parameters[0]
    if value > 1.0:  # a higher set is cut at the firing strength all the same, but only by min
        implication = system.norm("impmethod", FIS_CONJUNCTIONS, "min", findings)
        return 1.0 if implication == "min" else 0.0
    return max(value, 0.0)


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
        norms = Norms(conjunction, disjunction, implication, MACHINE_EPSILON)
        return RuleBuilder(drafts, findings).block("", norms, texts)
    rules = [Rule(text.antecedent, text.conclusions, text.weight, text.span) for text in texts]
    if producer == "octave":
        rules = [each for rule in rules for each in _octave_rules(rule, drafts, findings)]
    return RuleBlock(tuple(rules), "", conjunction, disjunction, implication)


def _octave_rules(rule: Rule, drafts: dict[str, Draft], findings: Findings) -> list[Rule]:
    """Express two habits of Octave's toolkit.

    It aggregates values that are equal, whatever their names, and a hedge on a value takes
    the root of the firing strength.
    """
    plain: list[Consequent] = []
    hedged_ones: list[Consequent] = []
    for consequent in rule.consequents:
        weighted = drafts[consequent.variable].defuzzifier.method in WEIGHTED.values()
        named = same_value(consequent, drafts)
        (hedged_ones if weighted and named.hedges else plain).append(named)
    rules = [replace(rule, consequents=tuple(plain))] if plain else []
    for consequent in hedged_ones:
        hedges = tuple(map(root, consequent.hedges))
        weight = hedged_weight(rule.weight, hedges)
        if weight is None:
            message = "a negated value and a weight cannot be carried together"
            findings.loss("hedged-weight", message, consequent.span)
            weight = rule.weight
        antecedent = around(hedges, rule.antecedent)
        bare = (replace(consequent, hedges=()),)
        rules.append(Rule(antecedent, bare, weight, rule.span))
    return rules


def root(hedge: Hedge) -> Hedge:
    """Return the hedge that undoes a power; ``not`` stays."""
    swapped = {"very": "somewhat", "somewhat": "very"}.get(hedge.name)
    if swapped:
        return Hedge(swapped)
    if hedge.name in POWERS:
        return Hedge("power", 1.0 / (hedge.exponent or POWERS[hedge.name]))
    return hedge


def _bounded(draft: Draft) -> bool:
    return math.isfinite(draft.low) and math.isfinite(draft.high)


def _is_nan(value: float | str) -> bool:
    return isinstance(value, float) and math.isnan(value)
