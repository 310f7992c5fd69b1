"""Common frame of all readers, and a variable while its file is read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from graphlib import CycleError, TopologicalSorter
from itertools import groupby
from operator import itemgetter

from fuzzyarm.base.diagnostic import MAX_MAGNITUDE, MIN_WIDTH, Span
from fuzzyarm.exchange.formats.dialects import Dialect
from fuzzyarm.exchange.formats.findings import (
    MAX_CHARACTERS,
    Findings,
    Imported,
    TextPiece,
    is_too_large,
    not_a_number,
    number,
    rounded,
    shortened,
)
from fuzzyarm.language.model.rulebase import (
    POSITION,
    Consequent,
    Defuzzifier,
    Input,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Term,
    last_conclusions,
    propositions,
)
from fuzzyarm.symbolic.formulas import read_formula
from fuzzyarm.symbolic.kinds import SHAPES

INFERENCES = ("Automatic", "TakagiSugeno", "Tsukamoto")
"""fuzzylite's inference of a weighted output; by default the terms decide."""

VALUES = frozenset({"singleton", "linear", "formula"})
"""Kinds of shape that are a number, not a set."""


def all_invertible(kinds: set[str]) -> bool:
    """Whether Tsukamoto's method can invert all the kinds of shape."""
    return all(SHAPES[kind].inverse is not None for kind in kinds)


# --- The frame of all readers ---


def imported(
    text: str,
    path: str,
    read: Callable[[str, Findings], tuple[RuleBase | None, Dialect]],
    *,
    lossy: bool,
    strict: bool,
) -> Imported:
    """Read a text with uniform line ends; refuse one that is too long."""
    findings = Findings(path, lossy=lossy, strict=strict)
    if len(text) > MAX_CHARACTERS:
        message = (
            f"the file has {len(text):,} characters, more than the {MAX_CHARACTERS:,} that are read"
        )
        findings.error("too-long", message)
        return Imported(None, findings.all())
    plain = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    rulebase, dialect = read(plain, findings)
    if rulebase is not None and not findings.failed:
        _refuse_unknown_names(rulebase, findings)
        _refuse_without_inverse(rulebase, findings)
        _refuse_circles(rulebase, dialect, findings)
    if rulebase is not None and not findings.failed and not rulebase.rules:
        findings.error("no-rules", "no rule of this file counts")
    if dialect.assumed:
        findings.info("assumed-producer", dialect.assumed)
    return findings.imported(rulebase, dialect.producer)


def _refuse_unknown_names(rulebase: RuleBase, findings: Findings) -> None:
    """Report formulas of values with unknown names, and of sets with any but x."""
    records = [(output, output.defuzzifier.record) for output in rulebase.outputs]
    values = [output for output, record in records if record.weighs and not record.inverts]
    names_there = {declaration.name for declaration in (*rulebase.inputs, *rulebase.outputs)}
    for variable in (*rulebase.inputs, *values):
        is_set = isinstance(variable, Input)
        for term in variable.terms:
            names = read_formula(term.shape.formula).names if term.shape.formula else ()
            for name in sorted(set(names) - ({POSITION} if is_set else names_there)):
                message = f"the formula of '{term.name}' reads '{shortened(name)}', "
                message += "but a set depends on x alone" if is_set else "an unknown variable"
                findings.error("undefined-variable", message, term.span)


def _refuse_without_inverse(rulebase: RuleBase, findings: Findings) -> None:
    """Report concluded terms that Tsukamoto's method cannot invert."""
    tsukamoto = {o.name for o in rulebase.outputs if o.defuzzifier.record.inverts}
    concluded = {(c.variable, c.term) for rule in rulebase.rules for c in rule.consequents}
    for name, word in sorted(pair for pair in concluded if pair[0] in tsukamoto):
        term = rulebase.variable(name).term(word)
        if not all_invertible({term.shape.kind}):
            message = f"'{word}' of '{name}' has no inverse, which Tsukamoto needs"
            findings.error("not-monotonic", message, term.span)


def _refuse_circles(rulebase: RuleBase, dialect: Dialect, findings: Findings) -> None:
    """Report outputs that depend on themselves: other programs read their last value."""
    outputs = {output.name: index for index, output in enumerate(rulebase.outputs)}
    formulas = {
        (output.name, term.name): set(read_formula(term.shape.formula).names) & outputs.keys()
        for output in rulebase.outputs
        for term in output.terms
        if term.shape.kind == "formula"
    }
    last = last_conclusions(rulebase)
    waits: dict[str, set[str]] = {}
    reader: dict[str, Rule] = {}
    late: list[str] = []
    for index, block in enumerate(rulebase.blocks):
        for rule in block.rules:
            dependencies = {
                part.variable for part in propositions(rule.antecedent)
            } & outputs.keys()
            for name, term in [(c.variable, c.term) for c in rule.consequents]:
                names_here = formulas.get((name, term), set())
                late += [other for other in names_here if outputs[other] >= outputs[name]]
                late += [
                    other for other in dependencies | names_here if last.get(other, -1) > index
                ]
                waits.setdefault(name, set()).update(dependencies, names_here)
                reader |= dict.fromkeys(dependencies | names_here, rule)
    try:
        TopologicalSorter(waits).prepare()
    except CycleError as error:
        late += error.args[1]
    if late:
        message = (
            f"'{late[0]}' is used before all rules that conclude it; {dialect.program} takes "
            "its last value, which the model does not have"
        )
        findings.error("chained-output", message, reader[late[0]].span)


def lines_of(text: str, without_comment: Callable[[str], str]) -> Iterator[TextPiece]:
    """Yield the non-empty lines of a text, stripped."""
    for row, raw in enumerate(text.split("\n"), 1):
        content = without_comment(raw)
        line = content.strip()
        if line:
            start = len(content) - len(content.lstrip()) + 1
            yield TextPiece(line, Span(row, start, row, start + len(line)))


def blocks_by_norms(
    rules: Iterable[tuple[tuple[str, str], Rule]],
) -> tuple[RuleBlock, ...]:
    """Return a block for each run of rules with the same conjunction and disjunction."""
    runs = groupby(rules, key=itemgetter(0))
    return tuple(
        RuleBlock(tuple(rule for _, rule in run), f"{number}" if number > 1 else "", *norms)
        for number, (norms, run) in enumerate(runs, 1)
    )


def note_rounding(text: str, findings: Findings) -> None:
    """Report a file in which all numbers have the three decimals that fuzzylite prints."""
    match = rounded(text)
    if match is None:
        return
    line = text.count("\n", 0, match.start()) + 1
    column = match.start() - text.rfind("\n", 0, match.start())
    span = Span(line, column, line, column + len(match.group()))
    message = "every number of this file has three decimals, so some may have been rounded"
    findings.info("rounded-number", message, span)


# --- A variable ---


@dataclass(slots=True)
class VariableDraft:
    """A variable under construction.

    The range is infinite until the file sets it; `enabled` is False where the file disables the
    variable, `aggregates` if it names no norm for its terms.
    """

    word: TextPiece
    is_output: bool
    low: float = -math.inf
    high: float = math.inf
    terms: list[Term] = field(default_factory=list)
    description: str = ""
    outside: str = "extend"
    enabled: bool = True
    aggregation: str = "sum"
    aggregates: bool = True
    defuzzifier: Defuzzifier = field(default_factory=Defuzzifier)
    no_rule: float | str = math.nan
    step: float | None = None  # between the points of its range, to scikit-fuzzy
    method: TextPiece | None = None  # the word for the defuzzifier
    inference: TextPiece | None = None  # fuzzylite's inference of values: one of INFERENCES
    resolution: int | None = None  # number of samples, if the file has one
    settled: bool = False  # whether the range is final
    _index: dict[str, Term] = field(default_factory=dict)
    refused: set[str] = field(default_factory=set)  # names of terms that have findings

    @property
    def name(self) -> str:
        """The name."""
        return self.word.text

    def term(self, name: str) -> Term | None:
        """Return the term called `name`, or None."""
        return self._index.get(name)

    def add(self, term: Term) -> None:
        """Add a term."""
        self.terms.append(term)
        self._index.setdefault(term.name, term)

    def put(self, index: int, term: Term) -> None:
        """Put a term, which replaces one with the same name."""
        self.terms[index] = term
        self._index[term.name] = term

    def input(self) -> Input:
        """Return the finished input."""
        return Input(
            self.name, self.low, self.high, tuple(self.terms), self.description, self.outside,
            span=self.word.span,
        )  # fmt: skip

    def output(self) -> Output:
        """Return the finished output."""
        return Output(
            self.name, self.low, self.high, tuple(self.terms), self.description, self.outside,
            span=self.word.span, aggregation=self.aggregation, defuzzifier=self.defuzzifier,
            no_rule=self.no_rule,
        )  # fmt: skip

    @property
    def integrates(self) -> bool:
        """Whether its value is integrated over samples of sets."""
        return self.defuzzifier.resolution is not None

    @property
    def bounded(self) -> bool:
        """Whether its range is finite."""
        return math.isfinite(self.low) and math.isfinite(self.high)

    @property
    def kinds(self) -> set[str]:
        """The kinds of shape of its terms."""
        return {term.shape.kind for term in self.terms}

    def set_range(
        self, words: list[TextPiece], at: TextPiece, findings: Findings, form: str
    ) -> None:
        """Set the range from two words."""
        values = [number(word.text) for word in words]
        if len(values) != 2 or values[0] is None or values[1] is None:
            large = [word for word in words if is_too_large(word.text)]
            message = f"a range is {form}, not '{at.text[:40]}'"
            if large:
                message = f"{not_a_number(large[0].text)}, in the range of '{self.name}'"
            findings.error("bad-range", message, large[0] if large else at)
            return
        self.low, self.high = values[0], values[1]

    def settle_range(self, findings: Findings) -> None:
        """Widen a range without width, turn a reversed one; once."""
        if self.settled:
            return
        self.settled = True
        if math.isnan(self.low) or math.isnan(self.high):
            findings.error("bad-range", f"the range of '{self.name}' has a nan", self.word)
            self.low, self.high = -math.inf, math.inf
        if self.low > self.high:
            message = f"the range of '{self.name}' runs from {self.low} down to {self.high}"
            findings.error("bad-range", message, self.word)
            self.low, self.high = self.high, self.low
        if self.low == self.high:
            message = f"the range of '{self.name}' has no width; half a unit is added either side"
            findings.warn("empty-range", message, self.word)
            self.low, self.high = self.low - 0.5, self.high + 0.5
        if any(MAX_MAGNITUDE < abs(end) < math.inf for end in (self.low, self.high)):
            message = f"the range of '{self.name}' goes beyond {MAX_MAGNITUDE:g}"
            findings.error("bad-range", message, self.word)
        if self.low == self.high:  # half a unit is below the resolution of doubles beyond 2**53
            self.high = math.nextafter(self.low, math.inf)
        if self.high - self.low < MIN_WIDTH:
            message = f"the range of '{self.name}' is narrower than {MIN_WIDTH:g}"
            findings.error("bad-range", message, self.word)
            self.low, self.high = self.low - 0.5, self.high + 0.5


def same_value(consequent: Consequent, variables: dict[str, VariableDraft]) -> Consequent:
    """Name the first term with the same value, for programs that aggregate by value."""
    draft = variables.get(consequent.variable)
    term = draft.term(consequent.term) if draft is not None else None
    if draft is None or term is None or term.shape.kind not in VALUES:
        return consequent
    first = next(t for t in draft.terms if t.shape == term.shape)
    return replace(consequent, term=first.name)


def same_number(value: float | str, other: float) -> bool:
    """Whether a value without rules equals a number; NaN equals NaN."""
    if isinstance(value, str):
        return False
    return value == other or (math.isnan(value) and math.isnan(other))


def maximum_of_nothing(output: VariableDraft | Output) -> float:
    """Return the maximum of nothing in fuzzylite 7 and Octave: every sample attains it."""
    defuzzifier = output.defuzzifier
    half_step = 0.0
    if defuzzifier.sampling == "midpoints":
        half_step = 0.5 * (output.high - output.low) / (defuzzifier.resolution or 1)
    if defuzzifier.record.of != "top":
        return math.nan
    figures = {"mean": 0.5 * (output.low + output.high)}
    figures |= {"first": output.low + half_step, "last": output.high - half_step}
    figures |= {"nearest": min(max(figures["first"], 0.0), figures["last"])}
    return float(defuzzifier.record.value(figures))
