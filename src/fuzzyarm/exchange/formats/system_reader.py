"""From the words of a format to a rule base, in the dialect of a program.

A reader of a format finds the words of variables, terms, norms, methods and rules in its text and
passes them with their positions to a :class:`SystemReader`. Their meaning depends on the
:class:`~fuzzyarm.exchange.formats.dialects.Dialect` alone. Constants and formulas of integrated
outputs, which fuzzylite takes for sets, become terms here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from fuzzyarm.base.diagnostic import MAX_TERMS
from fuzzyarm.exchange.formats.dialects import METHODS_MEANT, Dialect, words
from fuzzyarm.exchange.formats.drafts import (
    INFERENCES,
    VALUES,
    VariableDraft,
    all_invertible,
    maximum_of_nothing,
)
from fuzzyarm.exchange.formats.findings import MAX_VARIABLES, Findings, TextPiece, number
from fuzzyarm.exchange.formats.meaning import BlockDraft, blocks_in_model
from fuzzyarm.exchange.formats.recovery import joined, shape_of
from fuzzyarm.exchange.formats.shapes import estimated_range
from fuzzyarm.language.model.rulebase import (
    POSITION,
    Defuzzifier,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    without_range,
)
from fuzzyarm.symbolic.formulas import Formula, FormulaError, read_formula, write_formula
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SNORMS, TNORMS
from fuzzyarm.symbolic.nodes import replace as put_in
from fuzzyarm.symbolic.nodes import symbol
from fuzzyarm.symbolic.records import Norm

# ── constants and formulas as sets ───────────────────────────────────────────────────
#
# To fuzzylite every term is a function of x: a constant is a set of that height over the whole
# range, a formula in x is its own graph.


def formulas_of_input(draft: VariableDraft, findings: Findings) -> None:
    """Replace the formulas of an input by the shapes they draw.

    A formula may call the input by its name. One without a shape stays a formula in x.
    """
    for index, term in enumerate(draft.terms):
        if term.shape.kind != "formula":
            continue
        formula = read_formula(term.shape.formula)
        if draft.name in formula.names:
            root = put_in(formula.root, {draft.name: symbol(POSITION)})
            formula = read_formula(write_formula(root))
        shape = Shape("formula", (), 1.0, write_formula(formula.root))
        recovered = _drawn(formula, draft)
        if recovered is not None:
            message = (
                f"the formula of '{term.name}' of '{draft.name}' is taken as the {recovered.kind} "
                "that it draws"
            )
            findings.info("formula-as-set", message, term.span)
        draft.put(index, Term(term.name, recovered or shape, term.span))


def _drawn(formula: Formula, draft: VariableDraft) -> Shape | None:
    """Return the shape with the graph of a formula in x, also beyond the range, or None."""
    if set(formula.names) != {POSITION} or not draft.bounded:
        return None

    def degree(x: float) -> float:
        value = formula.evaluate({POSITION: x})
        if not 0.0 <= value <= 1.0:
            raise FormulaError("a degree goes from 0 to 1", draft.name)
        return value

    try:
        return shape_of(degree, draft.low, draft.high)
    except FormulaError:
        return None


def values_as_sets(
    draft: VariableDraft, implication: str | None, at: TextPiece, findings: Findings
) -> None:
    """Replace an output's values by sets, as fuzzylite does; report the impossible ones."""
    for index, term in enumerate(draft.terms):
        if term.shape.kind not in VALUES:
            continue
        shape = None
        if draft.bounded and term.shape.kind == "singleton":
            shape = _constant(draft, term, implication, findings)
        elif draft.bounded and term.shape.kind == "formula":
            shape = _formula(draft, term, implication, findings)
        if shape is not None:
            draft.put(index, Term(term.name, shape, term.span))
        else:
            message = f"'{term.name}' of '{draft.name}' is a value, which cannot be integrated"
            findings.loss("value-as-set", message, at)


def _constant(
    draft: VariableDraft, term: Term, implication: str | None, findings: Findings
) -> Shape | None:
    (value,) = term.shape.parameters
    # min also cuts a set higher than 1 at the firing strength; no other norm does.
    height = value if value <= 1.0 else float(implication == "min")
    if not height > 0.0:
        return None
    message = (
        f"fuzzylite integrates the constant '{term.name}' as a set of that height over the whole "
        "range"
    )
    findings.warn("value-as-set", message, term.span)
    return Shape("rectangle", (draft.low, draft.high), height)


def _formula(
    draft: VariableDraft, term: Term, implication: str | None, findings: Findings
) -> Shape | None:
    """Return the set of a formula in x: its shape, or its sampled degrees."""
    formula = read_formula(term.shape.formula)
    if set(formula.names) - {POSITION}:
        return None
    # max with 0 removes the negative part; min with a strength cuts values above 1.
    cut = implication == "min" and draft.aggregation == "max"

    def degree(x: float) -> float:
        value = formula.evaluate({POSITION: x})
        if not math.isfinite(value) or not (cut or 0.0 <= value <= 1.0):
            raise FormulaError("a degree goes from 0 to 1", term.shape.formula)
        return min(1.0, max(0.0, value))

    count = draft.defuzzifier.resolution or 1000
    step = (draft.high - draft.low) / count
    xs = [draft.low + (i + 0.5) * step for i in range(count)]
    try:
        degrees = [degree(x) for x in xs]
    except FormulaError:
        return None
    try:
        shape = shape_of(degree, draft.low, draft.high)
    except FormulaError:  # beyond the range
        shape = None
    if shape is None and count < 2:
        return None
    drawn = f"the {shape.kind} that it draws" if shape else f"its degrees at the {count} samples"
    message = f"the formula of '{term.name}' of '{draft.name}' is taken as {drawn}"
    findings.info("formula-as-set", message, term.span)
    return shape or joined(xs, degrees)


# ── the reader ───────────────────────────────────────────────────────────────────────


class SystemReader:
    """Builds a rule base from words; the reader of a format inherits from it.

    Parameters
    ----------
    dialect : Dialect
        The program whose semantics apply.
    findings : Findings
        Collector of the diagnostics.
    """

    def __init__(self, dialect: Dialect, findings: Findings) -> None:
        self.dialect = dialect
        self.findings = findings
        self.variables: dict[str, VariableDraft] = {}
        self.blocks: list[BlockDraft] = []

    # --- Variables, terms and norms, word by word ---

    def variable(self, word: TextPiece, *, is_output: bool) -> VariableDraft:
        """Return a new variable; a duplicate or one too many is left out of the rule base."""
        draft = VariableDraft(word, is_output)
        if not is_output:
            draft.outside = self.dialect.outside
        if word.text in self.variables:
            message = f"there are two variables called '{word.text}'"
            self.findings.error("duplicate-variable", message, word)
        elif self.findings.room(len(self.variables), MAX_VARIABLES, "variables", word):
            self.variables[word.text] = draft
        return draft

    @property
    def outputs(self) -> list[VariableDraft]:
        """The outputs so far."""
        return [draft for draft in self.variables.values() if draft.is_output]

    @property
    def inputs(self) -> list[VariableDraft]:
        """The inputs so far."""
        return [draft for draft in self.variables.values() if not draft.is_output]

    def term(self, draft: VariableDraft, word: TextPiece, shape: Shape | None) -> None:
        """Add a term; the dialect decides which of two with the same name applies.

        A term without a shape, which has its finding, is still a known name in the rules.
        """
        if shape is None:
            draft.refused.add(word.text)
            return
        term = Term(word.text, shape, word.span)
        earlier = draft.term(word.text)
        if earlier is None:
            if self.findings.room(len(draft.terms), MAX_TERMS, "terms of a variable", word):
                draft.add(term)
            else:
                draft.refused.add(term.name)
            return
        which = self.dialect.repeated_term
        message = f"'{draft.name}' has two terms called '{word.text}'; the {which} counts"
        self.findings.duplicate("duplicate-term-name", message, word, earlier.span)
        if which == "last":
            draft.put(draft.terms.index(earlier), term)

    def default(self, draft: VariableDraft, word: TextPiece) -> None:
        """Set the value of an output for no rule; a held value stays."""
        value = number(word.text)
        if value is None:
            self.findings.error("not-a-number", f"'{word.text[:40]}' is not a number", word)
        elif draft.no_rule != "hold":
            draft.no_rule = value

    def tnorm(self, word: TextPiece, role: str = "the T-norm") -> str | None:
        """Return the T-norm of a word; None for an unknown word or one that means none."""
        return self._norm(TNORMS, word, role)

    def snorm(self, word: TextPiece, role: str = "the S-norm") -> str | None:
        """Return the S-norm of a word; None for an unknown word or one that means none."""
        return self._norm(SNORMS, word, role)

    def _norm(self, kinds: Mapping[str, Norm], word: TextPiece, role: str) -> str | None:
        text = word.text.strip()
        table = words(kinds, *(self.dialect.norms or (self.dialect.kinds,)))
        if text not in table:
            text = self.dialect.folded(text)
        return None if text in self.dialect.no_norm else self.findings.norm(role, word, table, text)

    # --- Variables as a whole ---

    def settle(self) -> None:
        """Settle ranges, defuzzifiers and values without rules, after the last word."""
        for draft in self.variables.values():
            self.settle_variable(draft)

    def settle_variable(self, draft: VariableDraft) -> None:
        """Settle one variable."""
        name = self.method_name(draft) if draft.is_output else ""
        if self.dialect.estimates and math.isinf(draft.low) and math.isinf(draft.high):
            self._estimate(draft, integrated=name in self.dialect.integral)
        draft.settle_range(self.findings)
        if draft.is_output:
            self.finish_output(draft, name)
        else:
            formulas_of_input(draft, self.findings)

    def _estimate(self, draft: VariableDraft, *, integrated: bool) -> None:
        """Estimate a missing range from the terms."""
        estimate = estimated_range([term.shape for term in draft.terms])
        if estimate is not None and all(map(math.isfinite, estimate)):
            draft.low, draft.high = estimate
            if integrated:
                message = (
                    f"'{draft.name}' has no RANGE; its terms reach from {estimate[0]} to "
                    f"{estimate[1]}"
                )
                self.findings.info("estimated-range", message, draft.word)
        elif integrated and draft.terms:
            message = f"the output '{draft.name}' needs a RANGE to be integrated over"
            self.findings.error("bad-range", message, draft.word)
        elif integrated:
            draft.low, draft.high = -0.5, 0.5

    # --- The defuzzifier of an output ---

    def finish_output(self, draft: VariableDraft, name: str) -> None:
        """Set the defuzzifier of a word, and the value without rules."""
        dialect = self.dialect
        at = draft.method or draft.word
        # Integrated or weighted? MATLAB takes the middle for both.
        if dialect.no_rule == "middle" and _is_nan(draft.no_rule) and draft.bounded:
            draft.no_rule = 0.5 * (draft.low + draft.high)
        if name in dialect.weighted:
            self._weigh(draft, name, at)
        elif name in dialect.integral:
            self._integrate(draft, name, at)
        elif not name:
            message = f"the output '{draft.name}' has no defuzzifier"
            self.findings.error("no-defuzzifier", message, at)
        elif (meant := METHODS_MEANT.get(name)) in dialect.integral:
            message = f"the method '{at.text}' is not known"
            self.findings.error("unknown-defuzzifier", message, at, f"write {meant}")
        else:
            methods = (*dialect.integral, *dialect.weighted)
            self.findings.unknown("unknown-defuzzifier", "the method", at, methods)

    def method_name(self, draft: VariableDraft) -> str:
        """Return the word for the method of an output, translated if it is another program's."""
        dialect = self.dialect
        if draft.method is None:
            return dialect.method
        name = dialect.folded(draft.method.text)
        other = dialect.methods_of_others.get(name)
        if other is None or name in dialect.integral:
            return name
        message = f"{dialect.program} has no method {name}; it is read as {other}"
        self.findings.warn("guessed-defuzzifier", message, draft.method)
        return other

    def note_method(self, draft: VariableDraft, name: str, at: TextPiece) -> None:
        """Report a difference between a method of the program and the model's."""
        if self.dialect.has_ties and draft.defuzzifier.record.of == "top":
            self.note_ties(draft, at)

    def note_ties(self, draft: VariableDraft, at: TextPiece) -> None:
        """Report that rounding decides between equally high samples of a product."""
        message = (
            f"'{draft.name}' takes a maximum: of samples that are equally high the last bit "
            "decides, so that single points may fall on another one"
        )
        self.findings.loss("ties-of-maxima", message, at, slight=True)

    def _weigh(self, draft: VariableDraft, name: str, at: TextPiece) -> None:
        """Set a defuzzifier of values."""
        method, dialect = self.dialect.weighted[name], self.dialect
        invertible = bool(draft.kinds) and all_invertible(draft.kinds)
        if dialect.sums_values:
            draft.aggregation = "sum"  # every rule counts for itself
        kind = INFERENCES[0] if draft.inference is None else draft.inference.text
        if draft.inference is not None and kind not in INFERENCES:
            self.findings.unknown("unknown-defuzzifier", "the type", draft.inference, INFERENCES)
            return
        if dialect.inverts and (kind == "Tsukamoto" or (kind == "Automatic" and invertible)):
            if DEFUZZIFIERS[method].of == "sum" and dialect.activates:
                message = "a weighted sum of Tsukamoto terms cannot be carried"
                self.findings.loss("weighted-sum-of-tsukamoto", message, at)
            draft.defuzzifier = Defuzzifier("tsukamoto")
            return
        if not draft.kinds <= VALUES:
            self._refuse_sets(draft, name, at)
        draft.defuzzifier = Defuzzifier(method)

    def _refuse_sets(self, draft: VariableDraft, name: str, at: TextPiece) -> None:
        """Report sets in a method for values; fuzzylite continues with them."""
        if self.dialect.activates:
            message = (
                f"'{draft.name}' has sets where values are needed; fuzzylite takes the membership "
                "of the firing strength, which cannot be converted"
            )
            self.findings.loss("set-as-value", message, at)
        else:
            message = f"'{draft.name}' has sets where {name} needs values"
            self.findings.error("set-as-value", message, at)

    def _integrate(self, draft: VariableDraft, name: str, at: TextPiece) -> None:
        """Set a defuzzifier of sets."""
        resolution, sampling = self.dialect.samples
        sampling = self.dialect.samplings.get(name, sampling)
        draft.defuzzifier = Defuzzifier(self.dialect.integral[name])
        # 0 samples: the exact integral.
        if resolution:
            resolution = draft.resolution or resolution
            draft.defuzzifier = Defuzzifier(draft.defuzzifier.method, resolution, sampling)
        self.note_method(draft, name, at)
        if self.dialect.no_rule == "nothing":
            self._take_maximum_of_nothing(draft, at)
        elif self.dialect.no_rule in ("middle", "maximum") and _is_nan(draft.no_rule):
            draft.no_rule = maximum_of_nothing(draft)
        if self.dialect.activates:
            values_as_sets(draft, self.implication(), at, self.findings)
        else:
            self._refuse_values(draft, at)

    def _refuse_values(self, draft: VariableDraft, at: TextPiece) -> None:
        for term in draft.terms:
            if term.shape.kind in VALUES:
                message = f"'{term.name}' of '{draft.name}' is a value, which cannot be integrated"
                self.findings.loss("value-as-set", message, at, self.dialect.values_hint)

    def _take_maximum_of_nothing(self, draft: VariableDraft, at: TextPiece) -> None:
        """Set fuzzylite's (C++) value of an output that no rule concludes.

        It is the maximum of nothing, a number, so that neither a default nor the previous value
        ever applies.
        """
        if draft.defuzzifier.record.of != "top" or not draft.bounded:
            return
        value = maximum_of_nothing(draft)
        if draft.no_rule == "hold" or not _is_nan(draft.no_rule):
            rule = "holds" if draft.no_rule == "hold" else "has a default"
            message = (
                f"'{draft.name}' {rule}, but the maximum of an empty set is {value:g} in fuzzylite "
                "7, which is used here; version 6 follows the file"
            )
            self.findings.loss("maximum-of-nothing", message, at, slight=True)
        draft.no_rule = value

    def implication(self) -> str | None:
        """Return the implication of all enabled blocks, if they agree."""
        implications = {block.implication for block in self.blocks if block.enabled}
        return implications.pop() if len(implications) == 1 else None

    # --- Rules, and the rule base ---

    def is_on(self, block: BlockDraft) -> bool:
        """Whether a block is enabled; report it if not."""
        if not block.enabled:
            message = f"the block '{block.name}' is switched off; its rules are left out"
            self.findings.warn("disabled-block", message, block.span)
        return block.enabled

    def in_model(self, blocks: Iterable[BlockDraft]) -> tuple[RuleBlock, ...]:
        """Return the blocks of the model, with the rules' meaning in the program."""
        return blocks_in_model(list(blocks), self.variables, self.dialect, self.findings)

    def rulebase(self, name: str, blocks: tuple[RuleBlock, ...], description: str = "") -> RuleBase:
        """Return the rule base of all variables and the finished blocks."""
        inputs = tuple(draft.input() for draft in self.inputs)
        outputs = tuple(draft.output() for draft in self.outputs)
        made = RuleBase(name, inputs, outputs, blocks, description)
        for output in () if self.findings.failed else without_range(made):
            message = f"the output '{output.name}' needs a finite range to be integrated over"
            self.findings.error("bad-range", message, self.variables[output.name].word)
        return made


def _is_nan(value: float | str) -> bool:
    return isinstance(value, float) and math.isnan(value)
