"""What a FIS means to the three programs that read it, and the sections that it consists of."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

from fuzzyarm.formats.findings import VALUES, Draft, Findings, Word, same_value
from fuzzyarm.formats.fll.reader import MONOTONIC, settle_weighted
from fuzzyarm.formats.rules import (
    MACHINE_EPSILON,
    POWERS,
    Norms,
    RuleBuilder,
    RuleText,
    around,
    hedged_weight,
)
from fuzzyarm.formats.shapes import FIS_CONJUNCTIONS, FIS_DISJUNCTIONS
from fuzzyarm.model.rulebase import (
    Consequent,
    Defuzzifier,
    Hedge,
    Output,
    Rule,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.text.diagnostic import NOWHERE, Span

# --- FIS text: sections in brackets, `key=value` lines, rules of numbers ---

_SECTION = re.compile(r"\[\s*(system|input|output|rules)\s*(\d*)\s*\]\s*\Z", re.IGNORECASE)


@dataclass(slots=True)
class Section:
    """One section of a file.

    Attributes
    ----------
    kind : str
        ``system``, ``input``, ``output`` or ``rules``.
    number : int
        The number in ``[Input2]``; 0 where there is none.
    span : Span
        The header.
    lines : list of Word
        What stands in it, without comments and space around.
    """

    kind: str
    number: int = 0
    span: Span = NOWHERE
    lines: list[Word] = field(default_factory=list)


def fis_sections(text: str, findings: Findings) -> list[Section]:
    """Split a text into sections; report lines outside of any."""
    sections: list[Section] = []
    for number, raw in enumerate(text.split("\n"), 1):
        content = _without_comment(raw)
        stripped = content.strip()
        if not stripped:
            continue
        start = len(content) - len(content.lstrip()) + 1
        word = Word(stripped, Span(number, start, number, start + len(stripped)))
        match = _SECTION.match(stripped) if len(stripped) < 100 else None
        if match:
            digits = match.group(2)[:6]
            sections.append(Section(match.group(1).lower(), int(digits or 0), word.span))
        elif sections:
            sections[-1].lines.append(word)
        else:
            message = f"'{stripped[:40]}' stands before any section"
            findings.error("syntax", message, word)
    return sections


def _without_comment(raw: str) -> str:
    """Cut a comment: ``%`` or ``#`` first on a line, or after a space outside quotes; ``//``."""
    if raw.lstrip()[:1] in ("%", "#"):
        return ""
    if "%" not in raw and "#" not in raw and "//" not in raw:
        return raw
    quoted = False
    for index, letter in enumerate(raw):
        if letter == "'":
            quoted = not quoted
        elif not quoted and (letter in "%#" or raw.startswith("//", index)):
            return raw[:index]
    return raw


def key_and_value(line: Word) -> tuple[Word, Word] | None:
    """Split ``key = value``; None where there is no equals sign."""
    key, equals, value = line.text.partition("=")
    if not equals:
        return None
    span = line.span
    name = key.rstrip()
    at = span.column + len(key) + 1 + len(value) - len(value.lstrip())
    return (
        Word(name, Span(span.line, span.column, span.line, span.column + len(name))),
        Word(value.strip(), Span(span.line, at, span.line, span.end_column)),
    )


def unquoted(word: Word) -> Word:
    """Return the text between quotes, where it stands in quotes."""
    text = word.text
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "'\"":
        return Word(text[1:-1], word.span)
    return word


_NUMBER = re.compile(r"[^\s,;\[\]]+")


def bracketed(value: Word) -> list[Word]:
    """Return the words between ``[`` and ``]``, split at space, commas and semicolons."""
    span = value.span
    return [
        Word(m.group(), Span(span.line, span.column + m.start(), span.line, span.column + m.end()))
        for m in _NUMBER.finditer(value.text)
    ]


_MEMBERSHIP = re.compile(
    r"\s*(?:'(?P<quoted>[^']*)'|(?P<bare>[^:']*?))\s*:\s*'?(?P<kind>[\w.]*)'?\s*,\s*"
    r"(?P<rest>.*?)\s*\Z",
    re.DOTALL,
)


def membership_parts(value: Word) -> tuple[Word, Word, Word] | None:
    """Split ``'name':'kind',[numbers]``; None where it does not look like that."""
    match = _MEMBERSHIP.match(value.text)
    if match is None:
        return None
    span = value.span

    def word(group: str) -> Word:
        start, end = match.span(group)
        return Word(
            match.group(group),
            Span(span.line, span.column + start, span.line, span.column + end),
        )

    name = word("quoted") if match.group("quoted") is not None else word("bare")
    return name, word("kind"), word("rest")


# --- What a FIS means to the three programs that read it ---

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
