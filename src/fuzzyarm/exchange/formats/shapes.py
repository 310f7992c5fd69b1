"""Shapes of other programs: conversion from and to their words and numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, product

from fuzzyarm.exchange.formats.dialects import Dialect, Spelling, spellings
from fuzzyarm.exchange.formats.findings import Findings, TextPiece, written
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.symbolic import formulas
from fuzzyarm.symbolic.formulas import FormulaError, read_formula, write_formula
from fuzzyarm.symbolic.kinds import SHAPES
from fuzzyarm.symbolic.nodes import replace as put_in

# --- From words and numbers to a shape ---

_EITHER_WAY = frozenset({"rectangle"})
_SQUARED = frozenset({"gaussian", "two-sided-gaussian"})


def spelled_shape(
    spelling: Spelling,
    values: list[float],
    inputs: int,
    at: TextPiece,
    findings: Findings,
    dialect: Dialect,
) -> Shape | None:
    """Return the shape of a word and its numbers, in the program's order.

    In a program with heights an additional number is the height, except for fuzzylite's
    ``Constant``, which has none. The other parameters are those of :func:`make_shape`.
    """
    kind, word, order = spelling
    if kind == "linear":
        return _linear_shape(values, inputs, at, findings)
    has_height = False
    if kind == "points":
        has_height = dialect.heights and len(values) % 2 == 1
    elif dialect.heights and word != "Constant":
        has_height = len(values) == len(order) + 1
    else:
        values = _without_padding(values, len(order), at, findings)
        if dialect.drops_numbers and kind != "singleton" and len(values) > len(order):
            message = f"{at.text} takes the first {len(order)} of these {len(values)} numbers"
            findings.warn("extra-numbers", f"{message}; {dialect.program} drops the others", at)
            values = values[: len(order)]
    height = values[-1] if has_height else 1.0
    parameters = values[:-1] if has_height else list(values)
    if len(parameters) == len(order):
        for index, value in zip(order, values, strict=False):
            parameters[index] = value
    unordered = _unordered(kind, parameters) if dialect.unordered else None
    if unordered is not None:
        kind, parameters = "points", unordered
    return make_shape(kind, parameters, at, findings, height=height, ties=dialect.ties)


def _without_padding(
    values: list[float], count: int, at: TextPiece, findings: Findings
) -> list[float]:
    """Drop the zeros that pad the numbers of a shape in old files."""
    if len(values) <= count or any(values[count:]):
        return values
    message = f"{at.text} takes {count} of these {len(values)} numbers; the zeros are padding"
    findings.warn("padded-numbers", message, at)
    return values[:count]


def _unordered(kind: str, p: list[float]) -> list[float] | None:
    """Return fuzzylite's values for unordered corners, as points.

    None for ordered corners, and where the result is 0 throughout. The later of two values at one
    x wins, as for fuzzylite's own points.
    """
    if not all(map(math.isfinite, p)) or all(a <= b for a, b in pairwise(p)):
        return None
    match kind, p:
        case "s", [zero, _]:
            return [zero, 0.0, _after(zero), 1.0]
        case "z", [one, _]:
            return [one, 1.0, _after(one), 0.0]
        case "triangle", [left, peak, right] if left < right:
            return _unordered_trapezoid(left, peak, peak, right)
        case "trapezoid", [a, b, c, d] if a < d:
            return _unordered_trapezoid(a, b, c, d)
    return None


def _unordered_trapezoid(a: float, b: float, c: float, d: float) -> list[float]:
    """Evaluate as fuzzylite does: 0 outside a to d, 1 from b to c, rising flank, falling flank."""
    points = [a, 0.0]
    for start, end in pairwise(sorted({x for x in (a, b, c, d) if a <= x <= d})):
        middle = 0.5 * (start + end)
        for x in (start, end):
            if b <= middle <= c:
                degree = 1.0
            elif middle < b:
                degree = (x - a) / (b - a)
            else:
                degree = (d - x) / (d - c)
            points += [x, degree]
    return [*points, _after(d), 0.0]


def _after(x: float) -> float:
    return math.nextafter(x, math.inf)


def _linear_shape(
    values: list[float], inputs: int, at: TextPiece, findings: Findings
) -> Shape | None:
    """Return a linear consequent; a missing constant is 0."""
    values = _without_padding(values, inputs + 1, at, findings)
    if len(values) == inputs:
        values = [*values, 0.0]
    if len(values) != inputs + 1:
        message = (
            f"a linear term needs a factor for each of the {inputs} inputs and a constant, "
            f"not {len(values)} numbers"
        )
        findings.error("parameter-count", message, at)
        return None
    return make_shape("linear", values, at, findings)


def formula_shape(
    formula: TextPiece, dialect: formulas.FormulaDialect, findings: Findings
) -> Shape | None:
    """Return a formula in a form with one reading."""
    try:
        # fuzzylite's pi is not a variable, whatever their names.
        root = put_in(read_formula(formula.text, dialect).root, formulas.CONSTANTS)
        text = write_formula(root)
        read_formula(text)  # the added parentheses may nest too deep
    except FormulaError as fault:
        findings.error("bad-formula", f"in '{formula.text[:60]}': {fault}", formula)
        return None
    if dialect is formulas.FUZZYLITE and _has_plain_sign(formula.text):
        message = "a sign before an operand is refused by fuzzylite, which has '~' for the minus"
        findings.warn("bad-formula", message, formula, "write ~x for -x, and x for +x")
    return Shape("formula", (), 1.0, text)


def _has_plain_sign(text: str) -> bool:
    """Whether a `-` or `+` has no operand before it."""
    before = "("
    for match in formulas.FUZZYLITE.token.finditer(text):
        sign = match["sign"] or ""
        if sign in ("-", "+") and before and before != ")":
            return True
        before = sign
    return False


def make_shape(
    kind: str,
    parameters: list[float],
    at: TextPiece,
    findings: Findings,
    *,
    height: float = 1.0,
    ties: str = "larger",
) -> Shape | None:
    """Return the shape of numbers in the order of its record, or None with a finding.

    `height` scales the function; `ties` is the value at a doubled x of ``points``: ``first``,
    ``last`` or ``larger``.
    """
    shape = SHAPES[kind]
    if shape.parameters and len(parameters) != len(shape.parameters):
        names = ", ".join(shape.symbols[1:])
        message = f"{kind} takes {len(shape.parameters)} numbers ({names}), not {len(parameters)}"
        findings.error("parameter-count", message, at)
        return None
    if any(map(math.isnan, (*parameters, height))):
        findings.error("not-a-number", f"{kind} cannot have nan among its numbers", at)
        return None
    if math.isinf(height):
        findings.error("not-finite", f"the height of {with_article(kind)} must be finite", at)
        return None
    if kind == "linear":
        return Shape(kind, tuple(parameters), height)
    if kind == "triangle" and any(map(math.isinf, (parameters[0], parameters[2]))):
        # A foot at infinity is a shoulder; in the model only a trapezoid has one.
        kind, parameters = "trapezoid", [*parameters[:2], *parameters[1:]]
    if kind == "points":
        return _points(parameters, at, findings, height, ties)
    return _checked(kind, parameters, at, findings, height)


def _checked(
    kind: str, parameters: list[float], at: TextPiece, findings: Findings, height: float
) -> Shape | None:
    shape = SHAPES[kind]
    if kind in _EITHER_WAY:
        parameters = sorted(parameters)
    if kind in _SQUARED:  # the sign of a deviation is lost in its square
        pairs = zip(shape.parameters, parameters, strict=True)
        parameters = [abs(value) if name in shape.positive else value for name, value in pairs]
    misfits = {misfit.why: misfit for misfit in reversed(list(shape.misfits(parameters)))}
    if "order" in misfits:
        names = " <= ".join(shape.symbols[1:])
        message = (
            f"the corners of {with_article(kind)} must not decrease ({names}): it is 0 everywhere"
        )
        findings.warn("unordered-corners", message, at)
        return nothing(parameters)
    for why, must in (("positive", "be positive"), ("nonzero", "not be zero")):
        if why in misfits:
            name = shape.parameters[misfits[why].which].replace("-", "_")
            findings.error("not-positive", f"the {name} of {with_article(kind)} must {must}", at)
            return None
    if ("infinite" in misfits and kind != "singleton") or _without_inside(kind, parameters):
        findings.error("not-finite", f"{with_article(kind)} needs finite numbers", at)
        return None
    return Shape(kind, tuple(parameters), height)


def with_article(kind: str) -> str:
    """Return a kind of shape with its article; the letters s and z are in quotes."""
    if len(kind) == 1:
        return f"{'an' if kind == 's' else 'a'} '{kind}'"
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def nothing(parameters: Sequence[float]) -> Shape:
    """Return the empty set, with its corners in place."""
    corners = [parameter for parameter in parameters if math.isfinite(parameter)] or [0.0]
    low, high = min(corners), max(corners)
    return Shape("points", (low, 0.0, high, 0.0) if low < high else (low, 0.0))


def _without_inside(kind: str, parameters: list[float]) -> bool:
    """Whether all of a trapezoid lies beyond the largest number."""
    return kind == "trapezoid" and not (parameters[1] < math.inf and parameters[2] > -math.inf)


def _points(
    parameters: list[float], at: TextPiece, findings: Findings, height: float, ties: str
) -> Shape | None:
    xs, ys = parameters[0::2], parameters[1::2]
    if len(xs) != len(ys) or not xs:
        findings.error("parameter-count", "points need pairs of x and y", at)
        return None
    if any(map(math.isinf, parameters)):
        findings.error("not-finite", "points need finite numbers", at)
        return None
    if any(a > b for a, b in pairwise(xs)):
        findings.error("unordered-points", "the x of points must not decrease", at)
        return None
    _settle_ties(xs, ys, ties)
    pairs = [value for pair in zip(xs, ys, strict=True) for value in pair]
    return Shape("points", tuple(pairs), height)


def _settle_ties(xs: list[float], ys: list[float], ties: str) -> None:
    """Move one of two points with the same x by one ulp.

    The model takes the larger value at a doubled x; a program that takes the first or the last one
    gets it at exactly x, and the step right beside it.
    """
    if ties == "larger":
        return
    for i in range(1, len(xs)):
        if xs[i] != xs[i - 1]:
            continue
        if ties == "first" and ys[i - 1] < ys[i]:
            xs[i] = math.nextafter(xs[i], math.inf)
        elif ties == "last" and ys[i - 1] > ys[i] and (i < 2 or xs[i - 2] < xs[i - 1]):
            xs[i - 1] = math.nextafter(xs[i - 1], -math.inf)


def range_of_values(
    shapes: Iterable[Shape], inputs: Mapping[str, tuple[float, float]]
) -> tuple[float, float] | None:
    """Return the range of an output's values over the ranges of the inputs.

    A formula is evaluated at the corners and the middle of the inputs. None without a finite value;
    a range without width gets half a unit on either side.
    """
    values = [x for shape in shapes for x in _values(shape, inputs) if math.isfinite(x)]
    if not values:
        return None
    low, high = min(values), max(values)
    return (low, high) if low < high else (low - 0.5, high + 0.5)


def _values(shape: Shape, inputs: Mapping[str, tuple[float, float]]) -> list[float]:
    """Return values of a consequent: the extremes of a constant or a linear sum."""
    if shape.kind == "singleton":
        return list(shape.parameters)
    if shape.kind == "linear":
        *factors, constant = shape.parameters
        parts = [(f * a, f * b) for f, (a, b) in zip(factors, inputs.values(), strict=True) if f]
        return [constant + sum(map(end, parts)) for end in (min, max)]
    ends = list(inputs.values())
    corners = [*(product(*ends) if len(ends) <= 10 else []), [0.5 * (a + b) for a, b in ends]]
    try:
        formula = read_formula(shape.formula)
    except FormulaError:
        return []  # reported by the check of the rule base
    return [formula.evaluate(dict(zip(inputs, corner, strict=True))) for corner in corners]


def estimated_range(shapes: list[Shape]) -> tuple[float, float] | None:
    """Return the range that jFuzzyLogic assumes for a variable without one.

    From the lowest foot to the highest of all terms; the foot is at four deviations of a gaussian,
    nine over the slope of a sigmoid, a membership of 0.001 of a bell.
    """
    ends = [pair for pair in map(_support, shapes) if pair is not None]
    if not ends:
        return None
    return min(low for low, _ in ends), max(high for _, high in ends)


def _support(shape: Shape) -> tuple[float, float] | None:  # noqa: PLR0911
    p = shape.parameters
    match shape.kind:
        case "gaussian":
            return p[0] - 4.0 * p[1], p[0] + 4.0 * p[1]
        case "two-sided-gaussian":
            return p[0] - 4.0 * p[1], p[2] + 4.0 * p[3]
        case "sigmoid":
            reach = _over(9.0, p[1])
            return p[0] - reach, p[0] + reach
        case "sigmoid-difference" | "sigmoid-product":
            first, second = _over(9.0, p[1]), _over(9.0, p[3])
            return min(p[0] - first, p[2] - second), max(p[0] + first, p[2] + second)
        case "bell":
            reach = 999.0 ** _over(0.5, p[2]) * p[1] if abs(p[2]) > 1e-3 else math.inf
            return p[0] - abs(reach), p[0] + abs(reach)
        case "cosine" | "spike":
            return p[0] - 0.5 * p[1], p[0] + 0.5 * p[1]
        case "points":
            return p[0], p[-2]
        case "linear" | "formula":
            return None
        case _:
            return min(p), max(p)


def _over(numerator: float, slope: float) -> float:
    return numerator / abs(slope) if slope else math.inf


# --- From a shape to words and numbers ---


def word_and_numbers(shape: Shape, key: str) -> tuple[str, tuple[float, ...]] | None:
    """Return a program's word for a shape, and its numbers in that program's order.

    `key` selects the names in the records; None if the program lacks the shape.
    """
    variants = spellings(SHAPES[shape.kind], key) if shape.kind in SHAPES else []
    if not variants:
        return None
    p = shape.parameters
    # A ramp with two words has one for each direction: MATLAB's linsmf and linzmf.
    falls = shape.kind == "ramp" and len(variants) == 2 and p[0] > p[1]
    spelling = variants[falls]
    numbers = tuple(p[index] for index in spelling.order) or p
    return spelling.word, numbers if shape.height == 1.0 else (*numbers, shape.height)


def fuzzylite_formula(text: str, rename: Mapping[str, str] | None = None) -> str:
    """Return a formula with fuzzylite's unary minus."""
    return write_formula(read_formula(text).root, formulas.FUZZYLITE, rename, minus="~")


def class_and_numbers(shape: Shape, key: str, rename: Mapping[str, str]) -> str | None:
    """Return fuzzylite's class and numbers for a shape, or None without such a class."""
    if shape.kind == "formula":
        return f"Function {fuzzylite_formula(shape.formula, rename)}"
    word_numbers = word_and_numbers(shape, key)
    return (
        " ".join([word_numbers[0], *map(written, word_numbers[1])])
        if word_numbers is not None
        else None
    )


_STEPS = frozenset({"ramp", "s", "arc", "concave"})


def fuzzylite_shape(shape: Shape) -> Shape:
    """Return a shape with the model's values everywhere in fuzzylite.

    A step (a ramp from a number to itself) is its ``Binary``; at a doubled x of points fuzzylite
    takes the last value, the model the larger one.
    """
    p = shape.parameters
    if shape.kind in _STEPS and p[0] == p[1]:
        return replace(shape, kind="binary", parameters=(p[1], math.inf))
    if shape.kind == "z" and p[0] == p[1]:
        return replace(shape, kind="binary", parameters=(p[1], -math.inf))
    if shape.kind == "pi":
        left = math.nextafter(p[0], -math.inf) if p[0] == p[1] else p[0]
        right = math.nextafter(p[3], math.inf) if p[2] == p[3] else p[3]
        return replace(shape, parameters=(left, p[1], p[2], right))
    if shape.kind == "points":
        return replace(shape, parameters=larger_wins(p, "last"))
    return shape


def larger_wins(parameters: tuple[float, ...], ties: str) -> tuple[float, ...]:
    """Move points so that a program uses the larger of two values at one x, like the model.

    `ties` is the program's choice of the two, ``first`` or ``last``.
    """
    values = list(parameters)
    for i in range(2, len(values), 2):
        if values[i] != values[i - 2]:
            continue
        if ties == "last" and values[i - 1] > values[i + 1]:
            values[i] = math.nextafter(values[i], math.inf)
        elif ties == "first" and values[i - 1] < values[i + 1]:
            values[i - 2] = math.nextafter(values[i - 2], -math.inf)
    return tuple(values)
