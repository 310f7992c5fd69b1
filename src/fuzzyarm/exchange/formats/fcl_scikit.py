"""FCL as read for scikit-fuzzy (James Power's fcl-for-scikit-fuzzy).

A RANGE belongs into FUZZIFY and may have a step: ``RANGE := (0 .. 10) WITH 0.5;``. It becomes
the points of a universe, without its upper end; every term is linear between them. Implication
is the minimum, aggregation the maximum.
"""

from __future__ import annotations

import math
from dataclasses import replace

from fuzzyarm.base.diagnostic import MAX_TERMS
from fuzzyarm.exchange.formats.dialects import Dialect, words
from fuzzyarm.exchange.formats.drafts import VariableDraft
from fuzzyarm.exchange.formats.fcl_blocks import BlockText, FunctionBlock
from fuzzyarm.exchange.formats.fcl_scikit_terms import (
    MORE_HEDGES,
    closed,
    hedged_degrees,
    is_at_points_only,
    least_difference,
    widest_gap,
)
from fuzzyarm.exchange.formats.findings import Findings, TextPiece, unique_name
from fuzzyarm.exchange.formats.recovery import NEAR_LINES, beside_lines, is_joined, joined
from fuzzyarm.exchange.formats.sentences import NOT, RuleText, read_sentences
from fuzzyarm.language.model.rulebase import (
    And,
    Defuzzifier,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Shape,
    Term,
)
from fuzzyarm.language.model.shapes import membership_function
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

MEAN_OF_POINTS = (
    "scikit-fuzzy takes the mean of the points that are greatest, and of the cuts between them; "
    "here it is the middle of the maximum"
)

MAX_POINTS = 1_000_000
"""Most points of a universe."""

_WORDS = {hedge: word for word, hedge in MORE_HEDGES.items()}

_MINIMUM = "the reader for scikit-fuzzy clips by the minimum"

_NAMES = {
    "DRP": "drastic", "DMIN": "drastic", "NILMIN": "nilpotent", "NIPMIN": "nilpotent",
    "HAMACHER": "hamacher", "PROBOR": "probor", "DRS": "drastic", "DMAX": "drastic",
    "EINSTEIN": "einstein", "NILMAX": "nilpotent", "NIPMAX": "nilpotent",
}  # fmt: skip
"""Words of IEEE 1855 and of jFuzzyLogic for norms, beside those of fuzzylite."""


def universe(low: float, high: float, step: float | None) -> list[float]:
    """Return the points of a range, without its upper end.

    The default step is a power of ten that gives some thousand points.
    """
    if not step:
        step = 10.0 ** round(math.log10((1.0 + (high - low)) / 1000.0))
    count = math.ceil(min((high - low) / step, MAX_POINTS))
    return [low + step * index for index in range(count)]


class ScikitBlock(FunctionBlock):
    """A function block with the meaning of fcl-for-scikit-fuzzy."""

    def __init__(self, word: TextPiece, dialect: Dialect, findings: Findings) -> None:
        super().__init__(word, dialect, findings)
        self._universes: dict[str, list[float]] = {}
        self._hedged_terms: dict[tuple[str, str, tuple[Hedge, ...]], str] = {}

    def step(self, draft: VariableDraft, word: TextPiece, value: float) -> None:
        """Read the step between the points of a universe."""
        if 0.0 < value < math.inf:
            draft.step = value
        else:
            self.findings.error("bad-range", "the step of a range must be positive", word)

    def note_default(self, draft: VariableDraft, word: TextPiece) -> None:
        """Report that scikit-fuzzy has no value if no rule fires."""
        message = f"the DEFAULT of '{draft.name}' is left out: no rule is an error to scikit-fuzzy"
        self.findings.info("dropped-options", message, word)

    def _norms(self, text: BlockText) -> dict[str, str]:
        """Return the norms of a block; one norm of a pair sets the other to its dual."""
        norms: dict[str, str] = {}
        for key, word in text.norms:
            kinds = TNORMS if key in ("AND", "ACT") else SNORMS
            table = words(kinds, "fcl") | {k: n for k, n in _NAMES.items() if n in kinds}
            norm = self.findings.norm(f"the norm for {key}", word, table, word.text.upper())
            if norm is None:
                continue
            if key == "ACT" and norm != "min":
                self.findings.warn("unsupported-norm", f"{_MINIMUM}, whatever ACT says", word)
            elif key == "ACCU" and norm != "max":
                message = "ACCU of a rule block is left out; that of an output counts"
                self.findings.warn("unsupported-norm", message, word)
            else:
                norms[key] = norm
        if "AND" in norms and "OR" not in norms:
            norms["OR"] = TNORMS[norms["AND"]].dual
        elif "OR" in norms and "AND" not in norms:
            norms["AND"] = SNORMS[norms["OR"]].dual
        return {key: norm for key, norm in norms.items() if key in ("AND", "OR")}

    def _accumulate(self, rules: list[RuleText], accumulation: str | None) -> None:
        """Do nothing: aggregation belongs to the outputs, not to the block."""

    def settle_variable(self, draft: VariableDraft) -> None:
        """Sample the terms of a variable at the points of its universe."""
        if draft.is_output:
            draft.no_rule = "error"
            if self.accumulations.setdefault(draft.name, "max") != "max":
                message = f"'{draft.name}' accumulates by something other than the maximum"
                self.findings.loss("unsupported-norm", message, draft.word)
                self.accumulations[draft.name] = "max"
        if not draft.low < draft.high or not math.isfinite(draft.high - draft.low):
            message = f"'{draft.name}' needs a RANGE of two numbers, the first below the second"
            self.findings.error("bad-range", message, draft.word)
            draft.low, draft.high = 0.0, 1.0
            return
        xs = universe(draft.low, draft.high, draft.step)
        if not (2 <= len(xs) < MAX_POINTS and xs[0] < xs[-1]):
            size = f"{len(xs):,} points{' or more' if len(xs) == MAX_POINTS else ''}"
            message = f"the RANGE of '{draft.name}' has {size.replace('1 points', '1 point')}"
            self.findings.error("bad-range", message, draft.word)
            return
        # Inputs are clamped to the points, the last of which lies below the upper end.
        draft.low, draft.high = xs[0], xs[-1]
        self._universes[draft.name] = xs
        for index, term in enumerate(draft.terms):
            shape = self._on_points(draft, replace(term, shape=closed(term.shape, xs)), xs)
            draft.put(index, Term(term.name, shape, term.span))
        if draft.is_output:
            # Sets the dialect's samples, although each output has its own universe.
            self.finish_output(draft, self.method_name(draft))
            method = draft.defuzzifier.method
            draft.defuzzifier = Defuzzifier(method)
            if draft.defuzzifier.record.joins:
                draft.defuzzifier = Defuzzifier(method, len(xs), "joined")

    def method_name(self, draft: VariableDraft) -> str:
        """Return the method as written: words of other programs are refused."""
        return "COG" if draft.method is None else draft.method.text.upper()

    def note_method(self, draft: VariableDraft, name: str, at: TextPiece) -> None:
        """Report that scikit-fuzzy has its own mean of maxima."""
        if self.dialect.integral[name] == "mean-of-maximum":
            self.findings.loss("mean-of-maximum", MEAN_OF_POINTS, at, slight=True)

    # --- Hedges ---

    def sentences(self, rules: list[list[TextPiece]]) -> list[RuleText]:
        """Read rules; a hedge becomes a term of its own where the samples cannot express it."""
        variables = self.variables
        texts = read_sentences(rules, variables, self.findings, self.dialect, MORE_HEDGES)
        return [
            replace(
                text,
                antecedent=self._hedged(text.antecedent),
                conclusions=tuple(
                    replace(end, term=term, hedges=hedges)
                    for end in text.conclusions
                    for term, hedges in [self._hedged_term(end.variable, end.term, end.hedges)]
                ),
            )
            for text in texts
        ]

    def _hedged(self, expression: Expression) -> Expression:
        match expression:
            case Is(variable=variable, term=name, hedges=hedges):
                term, remaining = self._hedged_term(variable, name, hedges)
                return replace(expression, term=term, hedges=remaining)
            case Hedged(operand=operand):
                return replace(expression, operand=self._hedged(operand))
            case And(operands=operands) | Or(operands=operands):
                return replace(expression, operands=tuple(map(self._hedged, operands)))

    def _hedged_term(
        self, variable: str, name: str, hedges: tuple[Hedge, ...]
    ) -> tuple[str, tuple[Hedge, ...]]:
        """Return a term and its remaining hedges."""
        draft = self.variables.get(variable)
        term = draft.term(name) if draft is not None else None
        xs = self._universes.get(variable)
        if draft is None or term is None or not xs or set(hedges) <= {NOT}:
            return name, hedges
        is_own = is_at_points_only(hedges)
        if draft.is_output and not is_own:
            return name, hedges  # the defuzzifier reads the points only
        degrees = list(map(membership_function(term.shape), xs))
        if not is_own and widest_gap(degrees, hedges) <= NEAR_LINES:
            return name, hedges
        key = (variable, name, hedges)
        if key not in self._hedged_terms:
            if not self.findings.room(
                len(draft.terms), MAX_TERMS, "terms of a variable", draft.word
            ):
                return name, hedges
            words = [_WORDS.get(hedge, hedge.name) for hedge in hedges]
            title = unique_name("_".join([*words, name]), {other.name for other in draft.terms})
            shape = joined(xs, hedged_degrees(degrees, hedges))
            draft.add(Term(title, shape, term.span))
            self._hedged_terms[key] = title
        return self._hedged_terms[key], ()

    def _on_points(self, draft: VariableDraft, term: Term, xs: list[float]) -> Shape:
        """Return the piecewise-linear set through a term's degrees at the points."""
        shape = _extended(term.shape, xs)
        if shape.kind == "sigmoid-difference" and (least := least_difference(shape, xs)) < -1e-12:
            message = (
                f"'{term.name}' of '{draft.name}' is a difference of sigmoids that goes down to "
                f"{least:.2g}: a negative degree to scikit-fuzzy, whose magnitude the model takes"
            )
            slight = least > -NEAR_LINES
            self.findings.loss("negative-difference", message, term.span, slight=slight)
        if shape.kind == "singleton":
            nearest = min(range(len(xs)), key=lambda i: abs(xs[i] - shape.parameters[0]))
            return joined(xs, [float(i == nearest) for i in range(len(xs))])
        if is_joined(shape, xs):
            return shape
        degree = membership_function(shape)
        if draft.is_output or beside_lines(shape, xs) > NEAR_LINES:
            # Defuzzification reads the degrees at the points only.
            return shape if draft.is_output else joined(xs, [degree(x) for x in xs])
        message = (
            f"'{term.name}' of '{draft.name}' is straight between {len(xs)} points to "
            "scikit-fuzzy; here it is the whole shape"
        )
        self.findings.info("between-samples", message, term.span)
        return shape


def _extended(shape: Shape, xs: list[float]) -> Shape:
    """Extend points by the line from 0 that scikit-fuzzy's reader puts before them."""
    if shape.kind != "points" or shape.parameters[0] <= xs[0]:
        return shape
    return Shape("points", (xs[0], 0.0, *shape.parameters), shape.height)
