"""Constants and formulas of integrated outputs, which fuzzylite takes for sets.

To fuzzylite every term is a function of x: a constant is a set of that height over the whole
range, a formula in x is its own graph.
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
