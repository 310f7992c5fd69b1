r"""An output beside a linear law: its slopes at a point, and its sector.

With σ = Σ wᵢ xᵢ an output u lies in the sector [k₁, k₂] where

    k₁ σ² ≤ u σ ≤ k₂ σ²,

so that u is σ times a gain between k₁ and k₂, whatever else it depends on: the premise of the
circle criterion. Along one input (the others at 0) σ is that input; over several it is a sum of
them, and u has to vanish with σ. On pieces cut at σ = 0, u / σ is a quotient of polynomials
(:mod:`fuzzyarm.proof.map.surface`). At σ = 0 both vanish, which floats cannot tell from nearly:
sectors are computed in rationals.

Source: H. K. Khalil, *Nonlinear Systems*, section 7.1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text
from fuzzyarm.proof.map.arithmetic import as_fraction, rationals
from fuzzyarm.proof.map.bernstein import Quotients, vertices_of
from fuzzyarm.proof.map.bounds import LIKE_EXPECT, Bounds, Point, UnprovableError
from fuzzyarm.proof.map.pieces import Cut, PieceGrid, cut
from fuzzyarm.proof.map.prover import Prover, point_text
from fuzzyarm.proof.map.search import QuotientProblem
from fuzzyarm.proof.map.surface import Surface

ZERO = Fraction(0)

Form = Mapping[str, float | Fraction]
"""Weights of the inputs in a sum."""


class NoSectorError(UnprovableError):
    """An output is not 0 at a zero of the weighted sum of its inputs: no gain bounds it."""


# ── sectors ──────────────────────────────────────────────────────────────────────────


@json_properties("weights low high at_low at_high slack pieces")
class Sector(NamedTuple):
    """The sector of an output.

    Attributes
    ----------
    weights : dict of str to Fraction
        Of the inputs in σ.
    low, high : float
        The least and the greatest u / σ, rounded outward.
    at_low, at_high : dict of str to float
        Points at which the gains are attained or, next to σ = 0, approached.
    slack : float
        Allowed excess of u over the sector: 0, or 1e-9 of the range if u vanishes with σ only up to
        that, as with terms at thirds.
    pieces : int
        Number of simplices examined.
    complete : bool
        Whether the gains are within the tolerance of attained values.
    """

    weights: dict[str, Fraction]
    low: float
    high: float
    at_low: Point
    at_high: Point
    slack: float
    pieces: int
    complete: bool


def sector(
    prover: Prover, weights: Form, region: Mapping[str, tuple[float, float]] | None = None
) -> Sector:
    """Return the least and the greatest u / σ.

    Parameters
    ----------
    prover : Prover
        Of the output u.
    weights : mapping of str to float or Fraction
        Of the inputs in σ = Σ wᵢ xᵢ; inputs without a weight are 0, unless `region` has them.
    region : mapping of str to (float, float), optional
        Intervals of the inputs; their ranges by default.

    Returns
    -------
    Sector
        In units of the output by units of σ, computed in rationals.

    Raises
    ------
    NoSectorError
        If u is not 0 at some zero of σ.
    UnprovableError
        If the rule base is not piecewise linear, or has points without a value.

    Examples
    --------
    >>> import fuzzyarm
    >>> pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    >>> found = sector(Prover(pd7, "u"), {"e": 1, "ce": 1})
    >>> round(found.low, 5), round(found.high, 5)
    (0.41644, 2.0)
    """
    prover.demand_pieces("sectors")
    region = dict(region or {})
    values = _fixed_inputs(prover, weights, region)
    prover = prover.with_fixed(values)
    exact = prover if prover.exact else prover.in_rationals()
    form = tuple(Fraction(weights.get(name, 0)) for name in exact.names)
    of_free = {name: region[name] for name in exact.names if name in region}
    box = exact.box(of_free)
    exact.demand_inside_range("sectors", box)
    without_rule = _has_point_without_rule(prover, of_free)
    if all(low <= 0 <= high for low, high in box):  # σ is 0 at the origin: a cheap first test
        _demand_zero(exact, dict.fromkeys(exact.names, Fraction(0)))
    made: dict[Fraction, Quotients] = {}

    def over(surface: Surface, more: Fraction) -> Quotients:
        if more not in made:  # `exact` uses one surface for all of these questions
            made[more] = surface.over_form(form, more)
        return made[more]

    slack = _slack(exact, QuotientProblem(box, lambda surface: over(surface, ZERO), form=form))
    # The tolerance is in units of u; that of u / σ is divided by the largest |σ|.
    far = sum(abs(w) * max(abs(low), abs(high)) for w, (low, high) in zip(form, box, strict=True))
    share = 1.0 if prover.tolerance is not None else 1.0 / max(float(far), 1e-300)

    def side(sign: int) -> Bounds:
        def make(surface: Surface) -> Quotients:
            # Within the slack u counts as inside: k₁ is that of u + slack, k₂ that of u − slack.
            quotients = over(surface, -sign * slack)
            return quotients if sign > 0 else quotients.negated()

        return exact.bounds_of(QuotientProblem(box, make, form=form), both=False, share=share)

    high, low = side(1), side(-1)
    ends = (-low.high, high.high)
    # Without a rule u is 0, whatever σ is: a gain of 0.
    if without_rule:
        ends = min(ends[0], 0.0), max(ends[1], 0.0)
    return Sector(
        {name: w for name, w in zip(exact.names, form, strict=True) if w},
        *ends,
        low.at_high,
        high.at_high,
        float(slack),
        max(low.pieces, high.pieces),
        low.complete and high.complete,
    )


def _fixed_inputs(
    prover: Prover, weights: Form, region: Mapping[str, tuple[float, float]]
) -> dict[str, Fraction]:
    """Return the values of inputs with a single value."""
    if not any(weights.get(name) for name in prover.names):
        raise UnprovableError("a sector needs an input with a weight other than 0")
    values = {}
    for variable in prover.inputs:
        low, high = region.get(variable.name, (0.0, 0.0))
        if low != high or (weights.get(variable.name) and variable.name not in region):
            continue
        if not variable.low <= low <= variable.high:
            raise UnprovableError(f"'{variable.name}' cannot be {low:g}: say where it is")
        values[variable.name] = Fraction(low)
    if all(weights.get(name, 0) == 0 or name in values for name in prover.names):
        raise UnprovableError("no input with a weight is free to move")
    return values


def _has_point_without_rule(prover: Prover, region: Mapping[str, tuple[float, float]]) -> bool:
    """Return whether there are points without a rule, with the output 0; refuse others."""
    at = prover.without_value(region)
    if at is None:
        return False
    no_rule = prover.no_rule
    if no_rule is None:
        raise UnprovableError(f"sectors: no rule fires at {point_text(at)}")
    if no_rule != 0.0:
        raise NoSectorError(f"no sector: the output is {no_rule:g} at {point_text(at)} (no rule)")
    return True


def _slack(prover: Prover, problem: QuotientProblem) -> Fraction:
    """Return the allowed excess of the output; refuse one that is not 0 at the zeros of σ."""
    surface = prover.surface(problem, rationals())
    quotients = problem.make(surface)
    dimension = surface.pieces.corners.shape[2]
    slack = Fraction(0)
    for vertex, position in enumerate(vertices_of(dimension, quotients.degree)):
        upper, lower = quotients.upper[:, position], quotients.lower[:, position]
        # σ is 0 here, u is not: no gain bounds u / σ, unless u is 0 up to rounding.
        for row in np.flatnonzero((lower == 0) & (upper != 0)):
            owner = int(quotients.owner[row])
            at = prover.named(surface.pieces.position(owner, surface.pieces.corners[owner, vertex]))
            _demand_zero(prover, at)
            slack = Fraction(LIKE_EXPECT * prover.range)
    return slack


def _demand_zero(prover: Prover, at: Mapping[str, Fraction]) -> None:
    value = prover.exactly(at)
    if value is None or abs(value) > Fraction(LIKE_EXPECT * prover.range):
        text = "not 0" if value is None else f"{float(value):.6g}"
        at = prover.named([at[name] for name in prover.names])
        raise NoSectorError(f"no sector: the output is {text} at {point_text(at)}")


def form_text(weights: Form, digits: int = 0) -> str:
    """Return a sum of inputs as ``1.5 e + 0.5 ce``, exactly or to `digits`."""
    text = ""
    for name, weight in weights.items():
        size = abs(float(weight))
        sign = " - " if weight < 0 else " + "
        sign = sign if text else sign.strip(" +")
        number = f"{size:.{digits}g}" if digits else _weight_text(weight)
        text += f"{sign}{'' if weight in (1, -1) else f'{number} '}{name}"
    return text


def _weight_text(weight: float | Fraction) -> str:
    """Return the magnitude of a weight such that it reads back: a float, else a quotient."""
    size = abs(Fraction(weight))
    return number_text(float(size)) if Fraction(float(size)) == size else str(size)


# ── slopes at a point ────────────────────────────────────────────────────────────────


class _Side(NamedTuple):
    """A simplex at a point: its edges from there, and the output's gradient in it."""

    edges: np.ndarray
    gradient: tuple[Fraction, ...]


class Slopes(NamedTuple):
    """The gradients of an output at a point: one for each piece around it.

    Attributes
    ----------
    names : tuple of str
        The inputs.
    value : Fraction
        The output at the point.
    sides : tuple
        The pieces with their gradients.
    """

    names: tuple[str, ...]
    value: Fraction
    sides: tuple[_Side, ...]

    def around(self, name: str) -> tuple[Fraction, Fraction]:
        """Return the least and the greatest slope along an input, over all pieces."""
        axis = self.names.index(name)
        gradients = [side.gradient[axis] for side in self.sides]
        return min(gradients), max(gradients)

    def along(self, direction: Mapping[str, Fraction]) -> Fraction | None:
        """Return the one-sided slope in a direction; None without a piece there."""
        weights = [direction.get(name, Fraction(0)) for name in self.names]
        plain = np.array([float(weight) for weight in weights])
        for side in self.sides:
            # A direction leads into a simplex if it is a sum of its edges with weights ≥ 0.
            shares = np.linalg.solve(side.edges.T, plain)
            if (shares >= -1e-9 * np.abs(shares).max(initial=1e-300)).all():
                return sum(
                    (a * b for a, b in zip(side.gradient, weights, strict=True)), start=Fraction(0)
                )
        return None


NEAR = 2**16
"""Size of the cells around a point, by that of the box in which slopes at the point are found."""


def slopes_at(prover: Prover, point: Mapping[str, float]) -> Slopes:
    """Return the gradients of an output at a point, in rationals.

    Parameters
    ----------
    prover : Prover
        Of the output.
    point : mapping of str to float
        The point; other inputs are 0.

    Raises
    ------
    UnprovableError
        If the rule base is not piecewise linear, an input is not a number, the point lies outside
        the ranges, no rule fires there, or the output jumps.
    """
    prover.demand_pieces("slopes at a point")
    assert prover.model is not None
    values = {name: point.get(name, 0.0) for name in prover.names}
    for name, x in values.items():
        if not math.isfinite(x):
            raise UnprovableError(f"'{name}' has no single value there")
    at = [Fraction(x) for x in values.values()]
    whole = prover.box({v.name: _finite(v.low, v.high) for v in prover.rulebase.inputs})
    if not all(low <= x <= high for x, (low, high) in zip(at, whole, strict=True)):
        raise UnprovableError(f"{_words(prover, at)} is out of range")
    value = prover.exactly(dict(zip(prover.names, at, strict=True)))
    if value is None:
        raise UnprovableError(f"no rule fires at {_words(prover, at)}")
    cuts = tuple([x] for x in at)
    box = _neighbourhood(prover, Cut(whole, cuts), at)
    pieces = cut(prover.model, Cut(box, cuts), rationals(), stop=prover.stop)
    if any(pieces.grid.jumps):
        raise UnprovableError(f"the output jumps at {_words(prover, at)}")
    surface = Surface(prover.model, pieces)
    slopes = [surface.slope(axis) for axis in range(len(prover.names))]
    wide = np.logical_and.reduce([pieces.widths(axis) > 0 for axis in range(len(at))])
    sides = []
    for owner in np.flatnonzero(wide):
        corners = [pieces.position(int(owner), corner) for corner in pieces.corners[owner]]
        if at not in corners:
            continue
        vertex = corners.index(at)
        gradient = []
        for slope in slopes:
            position = vertices_of(len(at), slope.degree)[vertex]
            row = int(np.flatnonzero(slope.owner == owner)[0])
            below = slope.lower[row, position]
            if not below > 0:
                raise UnprovableError(f"no rule fires with any strength at {_words(prover, at)}")
            gradient.append(as_fraction(slope.upper[row, position] / below))
        edges = np.array(
            [[float(a - b) for a, b in zip(corner, at, strict=True)]
             for k, corner in enumerate(corners) if k != vertex]
        )  # fmt: skip
        sides.append(_Side(edges, tuple(gradient)))
    return Slopes(prover.names, value, tuple(sides))


def _neighbourhood(
    prover: Prover, what: Cut, at: list[Fraction]
) -> tuple[tuple[Fraction, Fraction], ...]:
    """Return a small box around a point, within the cells that it touches."""
    assert prover.model is not None
    grid = PieceGrid(prover.model, what, rationals(), prover.stop)
    box = []
    for x, cells in zip(at, grid.cells, strict=True):
        near = [cell for cell in cells if cell.left <= x <= cell.right]
        low, high = min(cell.left for cell in near), max(cell.right for cell in near)
        # A whole cell may have a thousand levels of samples, which only its far pieces meet.
        box.append((x - (x - low) / NEAR, x + (high - x) / NEAR))
    return tuple(box)


def _finite(low: float, high: float) -> tuple[float, float]:
    return (low if math.isfinite(low) else -1e9), (high if math.isfinite(high) else 1e9)


def _words(prover: Prover, at: list[Fraction]) -> str:
    return point_text(dict(zip(prover.names, at, strict=True)))
