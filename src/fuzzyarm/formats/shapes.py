"""Shapes and norms of the model under the names of each format."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.formats.findings import Findings, Word
from fuzzyarm.model.rulebase import Shape

# --- Make a Shape of a foreign term, or say what is wrong with its numbers ---

_EITHER_WAY = frozenset({"rectangle"})
_SQUARED = frozenset({"gaussian", "two-sided-gaussian"})


def make_shape(
    kind: str,
    parameters: list[float],
    at: Word,
    findings: Findings,
    *,
    height: float = 1.0,
    ties: str = "larger",
) -> Shape | None:
    """Return the shape, or None with a finding.

    Parameters
    ----------
    kind : str
        A kind of the registry.
    parameters : list of float
        In the order of the registry.
    at : Word
        What a finding points at.
    findings : Findings
        Where it goes.
    height : float
        Factor on the function.
    ties : str
        What the other program takes at a doubled x of ``points``: ``first``, ``last`` or
        ``larger``.
    """
    known = SHAPES[kind]
    if known.parameters and len(parameters) != len(known.parameters):
        names = ", ".join(known.parameters)
        message = f"{kind} takes {len(known.parameters)} numbers ({names}), not {len(parameters)}"
        findings.error("parameter-count", message, at)
        return None
    if any(map(math.isnan, (*parameters, height))):
        findings.error("not-a-number", f"{kind} cannot have nan among its numbers", at)
        return None
    if kind == "linear":
        return Shape(kind, tuple(parameters), height)
    if kind == "triangle" and any(map(math.isinf, (parameters[0], parameters[2]))):
        # A foot at infinity is a shoulder, which only a trapezoid has in the model.
        kind, parameters = "trapezoid", [*parameters[:2], *parameters[1:]]
    if kind == "points":
        return _points(parameters, at, findings, height, ties)
    return _checked(kind, parameters, at, findings, height)


def _checked(
    kind: str, parameters: list[float], at: Word, findings: Findings, height: float
) -> Shape | None:
    known = SHAPES[kind]
    if kind in _EITHER_WAY:
        parameters = sorted(parameters)
    elif known.ordered and any(a > b for a, b in pairwise(parameters)):
        names = " <= ".join(known.parameters)
        message = f"the corners of a {kind} must not decrease ({names})"
        findings.error("unordered-corners", message, at)
        return None
    values = dict(zip(known.parameters, parameters, strict=True))
    for name in known.positive:
        if values[name] < 0.0 and kind in _SQUARED:
            values[name] = -values[name]  # it is only ever squared
        if values[name] <= 0.0:
            findings.error("not-positive", f"the {name} of a {kind} must be positive", at)
            return None
    if kind == "bell" and values["width"] == 0.0:
        findings.error("not-positive", "the width of a bell must not be zero", at)
        return None
    if not _finite_enough(kind, parameters):
        findings.error("not-finite", f"a {kind} needs finite numbers", at)
        return None
    return Shape(kind, tuple(values.values()), height)


def _finite_enough(kind: str, parameters: list[float]) -> bool:
    if kind == "trapezoid":  # an infinite corner makes a shoulder that never ends
        return parameters[1] < math.inf and parameters[2] > -math.inf
    if kind == "binary":
        return math.isfinite(parameters[0])
    if kind in {"rectangle", "linear", "singleton"}:
        return True
    return all(map(math.isfinite, parameters))


def _points(
    parameters: list[float], at: Word, findings: Findings, height: float, ties: str
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
    """Move one of two points with the same x by the smallest step there is.

    The model takes the larger value at a doubled x; a program that takes the first or the
    last gets that value at exactly x, and the step right beside it.
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


def estimated_range(shapes: list[Shape]) -> tuple[float, float] | None:
    """Return the range that jFuzzyLogic takes where a file names none.

    From the lowest foot to the highest of all terms; four deviations of a gaussian, nine
    over the slope of a sigmoid, a membership of 0.001 of a bell.
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


# --- The same function in fuzzylite, where it treats the edge of a shape in its own way ---

_STEPS = frozenset({"ramp", "s", "arc", "concave"})


def fuzzylite_shape(shape: Shape) -> Shape:
    """Return a shape with which fuzzylite gives the value of the model everywhere.

    A step (a ramp from a number to itself) is its ``Binary``; at a doubled x of points it
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
        return replace(shape, parameters=_last_wins(p))
    return shape


def _last_wins(parameters: tuple[float, ...]) -> tuple[float, ...]:
    values = list(parameters)
    for i in range(2, len(values), 2):
        if values[i] == values[i - 2] and values[i - 1] > values[i + 1]:
            values[i] = math.nextafter(values[i], math.inf)
    return tuple(values)


# --- What each format calls the norms of the model, and back ---

FLL_CONJUNCTIONS = {
    "Minimum": "min",
    "AlgebraicProduct": "product",
    "BoundedDifference": "bounded",
    "DrasticProduct": "drastic",
    "HamacherProduct": "hamacher",
    "EinsteinProduct": "einstein",
    "NilpotentMinimum": "nilpotent",
}
"""Class names of fuzzylite's T-norms."""

FLL_DISJUNCTIONS = {
    "Maximum": "max",
    "AlgebraicSum": "probor",
    "BoundedSum": "bounded",
    "DrasticSum": "drastic",
    "HamacherSum": "hamacher",
    "EinsteinSum": "einstein",
    "NilpotentMaximum": "nilpotent",
    "UnboundedSum": "sum",
    "NormalizedSum": "normalized",
}
"""Class names of fuzzylite's S-norms."""

FIS_CONJUNCTIONS = {
    "min": "min",
    "prod": "product",
    "bounded_difference": "bounded",
    "drastic_product": "drastic",
    "hamacher_product": "hamacher",
    "einstein_product": "einstein",
    "nilpotent_minimum": "nilpotent",
}
"""MATLAB has the first two, Octave all but the last, fuzzylite all."""

FIS_DISJUNCTIONS = {
    "max": "max",
    "probor": "probor",
    "sum": "sum",
    "bounded_sum": "bounded",
    "drastic_sum": "drastic",
    "hamacher_sum": "hamacher",
    "einstein_sum": "einstein",
    "nilpotent_maximum": "nilpotent",
    "normalized_sum": "normalized",
}
"""MATLAB has the first three, Octave all but the last two, fuzzylite all."""

FCL_CONJUNCTIONS = {
    "MIN": "min",
    "PROD": "product",
    "BDIF": "bounded",
    "DPROD": "drastic",
    "DMIN": "drastic",
    "HPROD": "hamacher",
    "HAMACHER": "hamacher",
    "EPROD": "einstein",
    "NMIN": "nilpotent",
    "NIPMIN": "nilpotent",
}
"""The words of IEC 61131-7, fuzzylite and jFuzzyLogic together; no word has two meanings."""

FCL_DISJUNCTIONS = {
    "MAX": "max",
    "ASUM": "probor",
    "PROBOR": "probor",
    "BSUM": "bounded",
    "DSUM": "drastic",
    "DMAX": "drastic",
    "HSUM": "hamacher",
    "ESUM": "einstein",
    "EINSTEIN": "einstein",
    "NMAX": "nilpotent",
    "NIPMAX": "nilpotent",
    "NSUM": "normalized",
    "SUM": "sum",
}
"""As above, for OR and ACCU."""

JFUZZYLOGIC_PAIRS = {
    "min": "max",
    "product": "probor",
    "bounded": "bounded",
    "drastic": "drastic",
    "nilpotent": "nilpotent",
    "hamacher": "einstein",
}
"""jFuzzyLogic sets OR by AND and AND by OR: T-norm → the S-norm that goes with it."""


def reverse(table: dict[str, str], prefer: tuple[str, ...] = ()) -> dict[str, str]:
    """Return model name → format's word; of several words the first, or one of `prefer`."""
    back: dict[str, str] = {}
    for word, name in table.items():
        if name not in back or word in prefer:
            back[name] = word
    return back
