"""Terms stored as functions by libraries: their shapes, inputs and averaged outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from fuzzyarm.exchange.formats.findings import Findings
from fuzzyarm.exchange.formats.recovery import constant_beyond, even_family, joined, shape_of
from fuzzyarm.exchange.formats.shapes import range_of_values
from fuzzyarm.language.model.rulebase import Defuzzifier, Input, Output, Shape, Term

_SAMPLED_AT = 1001
"""Samples over a range of a function without a shape of the language."""

_ENDS = 97
"""Points for the comparison of an input's terms with an evenly spread family."""


def shape_or_points(
    function: Callable[[float], float], low: float, high: float, words: str, findings: Findings
) -> Shape:
    """Return the shape of a function, or straight lines through its degrees, a slight loss.

    `words` are the subject of the message *taken at 1001 points*.
    """
    shape = shape_of(function, low, high)
    if shape is not None:
        return shape
    message = f"{words} taken at {_SAMPLED_AT} points"
    findings.loss("unsupported-shape", message, slight=True)
    xs = [low + (high - low) * i / (_SAMPLED_AT - 1) for i in range(_SAMPLED_AT)]
    return joined(xs, [min(1.0, max(0.0, function(x))) for x in xs])


def terms_of(shapes: Mapping[str, Shape]) -> tuple[Term, ...]:
    """Return terms from shapes by name."""
    return tuple(Term(name, shape) for name, shape in shapes.items())


def input_of(
    name: str,
    low: float,
    high: float,
    shapes: Mapping[str, Shape],
    description: str = "",
    *,
    read_beyond: bool = False,
) -> Input:
    """Return an input, clamped if that makes no difference to its terms.

    It does if conclusions read its value (`read_beyond`). An evenly spread family gets its numbers.
    """
    outside = "extend"
    if not read_beyond and all(constant_beyond(shape, low, high) for shape in shapes.values()):
        outside = "clamp"
        xs = [low + (high - low) * i / (_ENDS - 1) for i in range(_ENDS)]
        even = even_family(list(shapes.values()), low, high, xs)
        shapes = dict(zip(shapes, even, strict=True)) if even else shapes
    return Input(name, low, high, terms_of(shapes), description, outside)


def output_of_values(
    name: str,
    terms: tuple[Term, ...],
    inputs: Iterable[Input],
    findings: Findings,
    defuzzifier: Defuzzifier | None = None,
    no_rule: float = 0.0,
) -> Output:
    """Return an output with the weighted average of values, over their range."""
    ends = {variable.name: (variable.low, variable.high) for variable in inputs}
    low, high = range_of_values((term.shape for term in terms), ends) or (0.0, 1.0)
    message = f"'{name}' has no universe of discourse; {low:g} to {high:g} by its values"
    findings.info("estimated-range", message)
    return Output(
        name,
        low,
        high,
        terms,
        outside="extend",
        aggregation="sum",
        defuzzifier=defuzzifier or Defuzzifier("weighted-average"),
        no_rule=no_rule,
    )
