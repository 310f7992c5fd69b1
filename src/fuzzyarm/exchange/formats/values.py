"""Values that fuzzylite takes for sets: constants and formulas of an output that is integrated.

To it every term is a function of x. A constant is a set of that height over the whole range, a
formula in x the set that it draws.
"""

from __future__ import annotations

import math

from fuzzyarm.exchange.formats.drafts import VALUES, VariableDraft
from fuzzyarm.exchange.formats.findings import Findings, TextPiece
from fuzzyarm.exchange.formats.recovery import joined, shape_of
from fuzzyarm.language.model.rulebase import POSITION, Shape, Term
from fuzzyarm.symbolic.formulas import Formula, FormulaError, read_formula, write_formula
from fuzzyarm.symbolic.nodes import replace as put_in
from fuzzyarm.symbolic.nodes import symbol

__all__ = ["formulas_of_input", "values_as_sets"]


def formulas_of_input(draft: VariableDraft, findings: Findings) -> None:
    """Put the shapes that the formulas of an input draw in their place.

    A formula may ask for the input by its name. One that draws none of the shapes stays, of x.
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
    """Return the shape that a formula in x is, also beyond the range, or None."""
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
    """Put sets instead of an output's values, as fuzzylite has them; report the others."""
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
    # A higher set is cut at the firing strength all the same, but only by min.
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
    """Return the set that a formula in x is: its shape, or its degrees at the samples."""
    formula = read_formula(term.shape.formula)
    if set(formula.names) - {POSITION}:
        return None
    # The maximum of 0 and what is below it is 0, the minimum with a strength cuts above 1.
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
    what = f"the {shape.kind} that it draws" if shape else f"its degrees at the {count} samples"
    message = f"the formula of '{term.name}' of '{draft.name}' is taken as {what}"
    findings.info("formula-as-set", message, term.span)
    return shape or joined(xs, degrees)
