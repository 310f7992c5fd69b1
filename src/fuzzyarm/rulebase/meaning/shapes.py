"""Judge the numbers of a shape."""

from __future__ import annotations

import math

from fuzzyarm.rulebase.formula import CONSTANTS, FormulaError, names, parse
from fuzzyarm.rulebase.limits import MAX_MAGNITUDE, MIN_WIDTH
from fuzzyarm.rulebase.meaning.scope import Draft, Scope
from fuzzyarm.rulebase.model import Shape
from fuzzyarm.rulebase.near import near_hint
from fuzzyarm.rulebase.shapes import SHAPES
from fuzzyarm.rulebase.syntax.nodes import ShapeNode


def elaborate_shape(node: ShapeNode, draft: Draft | None, scope: Scope) -> Shape | None:
    """Return the shape that `node` means, or None after a report."""
    height = node.height.value if node.height else 1.0
    if not 0.0 < height <= 1.0:
        assert node.height is not None
        scope.report("bad-height", "a height must be above 0 and at most 1", node.height.span)
        return None
    kind = node.kind.text
    if not SHAPES[kind].fuzzy and draft is not None and draft.is_input:
        scope.report(
            "not-a-fuzzy-set",
            f"'{kind}' is a value, not a set: it cannot be a term of the input '{draft.name}'",
            node.kind.span,
        )
        return None
    if kind == "linear":
        return _linear(node, scope)
    if kind == "formula":
        return _formula(node, scope)
    parameters = tuple(figure.value for figure in node.figures)
    fault = shape_fault(kind, parameters)
    if fault is not None:
        index, message = fault
        scope.report("bad-shape", message, node.figures[index].span)
        return None
    return Shape(kind, parameters, height)


def shape_fault(kind: str, parameters: tuple[float, ...]) -> tuple[int, str] | None:
    """Return what is wrong with the numbers of a shape, and which of them; None if nothing is.

    Parameters
    ----------
    kind : str
        A key of SHAPES.
    parameters : tuple of float
        As many as the kind takes.

    Returns
    -------
    tuple of (int, str) or None
        Index of the number at fault and one sentence.
    """
    return (
        _infinite_fault(kind, parameters)
        or _order_fault(kind, parameters)
        or _size_fault(kind, parameters)
    )


def _infinite_fault(kind: str, parameters: tuple[float, ...]) -> tuple[int, str] | None:
    for i, value in enumerate(parameters):
        if math.isnan(value):
            return i, f"a {kind} cannot have the number nan"
        shoulder = kind in ("trapezoid", "rectangle") or (kind, i) == ("binary", 1)
        if math.isinf(value) and not shoulder:
            return i, f"a {kind} cannot have an infinite number here"
        if MAX_MAGNITUDE < abs(value) < math.inf:
            return i, f"a {kind} cannot have numbers beyond {MAX_MAGNITUDE:g}"
    return None


def _order_fault(kind: str, parameters: tuple[float, ...]) -> tuple[int, str] | None:
    stride = 2 if kind == "points" else 1
    if not SHAPES[kind].ordered and kind != "points":
        return None
    for i in range(stride, len(parameters), stride):
        if parameters[i] < parameters[i - stride]:
            return i, f"the numbers of a {kind} must not decrease"
        if stride == 2 and i >= 4 and parameters[i] == parameters[i - 4]:
            return i, "at most two points may share an x"
    return None


def _size_fault(kind: str, parameters: tuple[float, ...]) -> tuple[int, str] | None:
    if kind == "points":
        for i in range(1, len(parameters), 2):
            if not 0.0 <= parameters[i] <= 1.0:
                return i, "a membership must lie between 0 and 1"
    info = SHAPES[kind]
    for i, parameter in enumerate(info.parameters):
        if parameter in info.positive and not parameters[i] > 0.0:
            return i, f"the {parameter.replace('_', ' ')} of a {kind} must be above 0"
        if parameter in info.positive and parameters[i] < MIN_WIDTH:
            return i, f"the {parameter.replace('_', ' ')} of a {kind} is below {MIN_WIDTH:g}"
    if kind in ("bell", "spike") and parameters[1] == 0.0:
        return 1, f"the width of a {kind} must not be 0"
    if kind in ("bell", "spike") and abs(parameters[1]) < MIN_WIDTH:
        return 1, f"the width of a {kind} is below {MIN_WIDTH:g}"
    return None


def _linear(node: ShapeNode, scope: Scope) -> Shape | None:
    inputs = scope.names("input")
    coefficients = dict.fromkeys(inputs, 0.0)
    constant = 0.0
    for part in node.parts:
        if part.variable is None:
            constant += part.factor
        elif scope.variable(part.variable, "input") is not None:
            coefficients[part.variable.text] += part.factor
    return Shape("linear", (*coefficients.values(), constant))


def _formula(node: ShapeNode, scope: Scope) -> Shape | None:
    try:
        tree = parse(node.formula)
    except FormulaError as error:
        scope.report("bad-formula", error.message, node.formula_span)
        return None
    for name in sorted(names(tree)):
        if name not in scope.drafts and name not in CONSTANTS and name != "x":
            hint, _ = near_hint(name, scope.drafts)
            scope.report(
                "unknown-variable",
                f"the formula uses '{name}', which is no variable",
                node.formula_span,
                hint=hint,
            )
    return Shape("formula", formula=node.formula)
