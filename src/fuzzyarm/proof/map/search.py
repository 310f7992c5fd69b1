"""Bounds of quotients over the pieces of one output: floats first, rationals where they fail.

Floats decide nearly everything, with a margin for their rounding. Cells that they leave open (an
attained bound, a slope of exactly 0) are cut again in rationals.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Self

import numpy as np

from fuzzyarm.language.model.rulebase import Output, RuleBase
from fuzzyarm.proof.map.arithmetic import (
    FLOATS,
    Arithmetic,
    Array,
    as_fraction,
    nearest_float,
    rationals,
)
from fuzzyarm.proof.map.bernstein import SMALLEST, Extremum, Quotients, maximise
from fuzzyarm.proof.map.bounds import (
    GAP,
    WIDENED,
    Bounds,
    Claim,
    NothingFiresError,
    Point,
    UnprovableError,
)
from fuzzyarm.proof.map.pieces import Cut, TooManyPiecesError, cut
from fuzzyarm.proof.map.straight import Straight
from fuzzyarm.proof.map.surface import Surface
from fuzzyarm.proof.stop import Stop, TimeOverError

WIDEST = 1e100
"""A tolerance that any bounds meet: no range has a larger end."""

Make = Callable[[Surface], Quotients]

Box = tuple[tuple[Fraction, Fraction], ...]
"""An interval of each input."""


@dataclass(frozen=True)
class QuotientProblem:
    """A quotient over a box, and the cuts of the inputs that it needs.

    `steep`: for slopes, always in rationals: floats may take the wrong one of two heights that
    differ by rounding, with any other slope.
    `steps`: as in :class:`Cut`.
    """

    box: Box
    make: Make
    positions: tuple[Any, ...] = ()
    mirrored: bool = False
    steep: bool = False
    form: tuple[Fraction, ...] = ()
    other: Straight | None = None
    steps: bool = False


class QuotientSearch:
    """The search for bounds of quotients, with a cache of cut pieces.

    Its parameters are those of :class:`.prover.Prover`.

    Attributes
    ----------
    model : Straight or None
        The rule base in straight pieces; None if it has none.
    inputs : tuple of Variable
        Inputs that are not fixed.
    fixed : dict of str to Fraction
        Inputs with one value.
    """

    def __init__(
        self,
        rulebase: RuleBase,
        output: str,
        *,
        tolerance: float | None = None,
        stop: Stop | None = None,
        exact: bool = False,
    ) -> None:
        self.rulebase = rulebase
        self.output: Output = rulebase.output(output)
        self.stop = stop or Stop()
        self.exact = exact
        low, high = self.output.low, self.output.high
        self.range = high - low if math.isfinite(high - low) else 1.0
        self.tolerance = tolerance
        # Finite, so that multiples of it are numbers.
        self.gap = min(tolerance, WIDEST) if tolerance is not None else GAP * self.range
        self.inputs = rulebase.inputs
        self.names = tuple(variable.name for variable in self.inputs)
        self.fixed: dict[str, Fraction] = {}
        self.model: Straight | None = None
        self._surfaces: dict[tuple[Any, ...], Surface] = {}

    @property
    def pieces_cut(self) -> int:
        """Number of pieces in the largest cut so far."""
        return max((surface.pieces.count for surface in self._surfaces.values()), default=0)

    # ── bounds ───────────────────────────────────────────────────────────────────────

    def bounds_of(
        self,
        problem: QuotientProblem,
        *,
        shifted: bool = False,
        both: bool = True,
        share: float = 1.0,
    ) -> Bounds:
        """Return both bounds of a quotient, to the tolerance; in rationals where floats fail."""
        arithmetic = self.first_arithmetic(problem)
        surface = self.surface(problem, arithmetic)
        gap = arithmetic.number(Fraction(self.gap * share))
        quotients = problem.make(surface)
        shift = surface.centre if shifted else arithmetic.number(Fraction(0))
        doubtful = surface.unsure(quotients)
        searched = {
            sign: maximise(
                (quotients if sign == 1 else quotients.negated()).without(doubtful), gap, self.stop
            )
            for sign in ((-1, 1) if both else (1,))
        }
        owners = [search.left.owner for search in searched.values()]
        undecided = np.concatenate([*owners, np.flatnonzero(doubtful)])
        if any(search.reached is None for search in searched.values()):
            if arithmetic.exact or not undecided.size:
                raise NothingFiresError(f"no rule fires anywhere for '{self.output.name}'")
            rational = self.in_rationals()
            return rational.bounds_of(problem, shifted=shifted, both=both, share=share)
        # Cells that floats leave open are cut once in rationals, for both bounds.
        exact = (
            self._in_rationals(problem, surface, undecided)
            if undecided.size and not arithmetic.exact
            else None
        )
        pieces, complete, ends = 0, True, []
        for sign, search in searched.items():
            pieces = max(pieces, search.pieces)
            reached, bound = search.reached, search.bound
            at: dict[str, Fraction] = {}
            if search.corner is not None:
                at = self.named(surface.pieces.position(search.owner, search.corner))
            if exact is not None and (search.left.count or doubtful.any()):
                again = self._search_in_rationals(exact, sign, reached)
                bound = max(nearest_float(reached) + float(gap), nearest_float(again.bound))
                if again.corner is not None:
                    coordinates = exact[0].pieces.position(again.owner, again.corner)
                    reached, at = again.reached, self.named(coordinates)
                pieces += again.pieces
            elif exact is None and doubtful.any():
                bound = math.inf
            complete &= nearest_float(bound) <= nearest_float(reached) + 2.0 * float(gap)
            ends.append((sign, reached, bound, at))
        return self._as_bounds(ends, shift, pieces, complete=complete, exact=arithmetic.exact)

    def without_memory(self) -> Self:
        """Return the same search with its own pieces, freed together with it."""
        other = copy(self)
        other._surfaces = {}
        return other

    def in_rationals(self) -> Self:
        """Return the same search without floats, for strengths too small for them."""
        other = self.without_memory()
        other.exact = True
        return other

    def _in_rationals(
        self, problem: QuotientProblem, surface: Surface, left: Array
    ) -> tuple[Surface, Quotients] | None:
        """Return in rationals the cells that floats have left open; None if time is over."""
        if self.stop.now:
            return None
        try:
            exact = self.surface(problem, rationals(), np.unique(surface.pieces.flat_cells[left]))
            return exact, problem.make(exact)
        except TimeOverError:
            return None  # the bounds from floats hold

    def _search_in_rationals(
        self, exact: tuple[Surface, Quotients], sign: int, least: Any
    ) -> Extremum:
        number, quotients = rationals().number, exact[1]
        oriented = quotients if sign == 1 else quotients.negated()
        floor = number(Fraction(float(least)))
        return maximise(oriented, number(Fraction(self.gap)), self.stop, least=floor)

    def at_most(
        self,
        problem: QuotientProblem,
        bound: Fraction,
        *,
        negated: bool,
        strict: bool = False,
        shifted: bool = False,
    ) -> Claim:
        """Return whether a quotient (or minus the quotient) is at most a bound everywhere."""
        count = 0
        cells: Array | None = None
        for arithmetic in dict.fromkeys((self.first_arithmetic(problem), rationals())):
            try:
                surface = self.surface(problem, arithmetic, cells)
                quotients = problem.make(surface)
            except TimeOverError:
                break
            centre = surface.exact_centre if shifted else Fraction(0)
            limit = bound + centre if negated else bound - centre
            doubtful = surface.unsure(quotients)
            oriented = (quotients.negated() if negated else quotients).without(doubtful)
            margin = 0.0 if arithmetic.exact else 1e3 * WIDENED * self.range
            least = arithmetic.number(limit) + arithmetic.number(Fraction(margin))
            start = arithmetic.number(limit)
            # Floats discard simplices clearly below the bound. They never decide those near it,
            # which go to rationals after a few halvings.
            smallest = SMALLEST if arithmetic.exact else 1 / 16
            touch = strict and arithmetic.exact
            extremum = maximise(
                oriented, start - start, self.stop,
                least=start, decide=arithmetic.exact, strict=touch, smallest=smallest,
            )  # fmt: skip
            count += extremum.pieces
            fails = extremum.owner >= 0 and (extremum.reached > least or touch)
            if fails:
                if problem.steep:  # the worst point is the better evidence
                    gap = arithmetic.number(Fraction(self.gap))
                    worst = maximise(oriented, gap, self.stop, least=extremum.reached)
                    extremum = extremum if worst.corner is None else worst
                corner = extremum.corner
                assert corner is not None
                if problem.steep:  # a slope has two sides: move inside the piece
                    inside = surface.pieces.corners[extremum.owner].sum(axis=0) / (corner.size + 1)
                    corner = corner + (inside - corner) / 2**14
                at = self.named(surface.pieces.position(extremum.owner, corner))
                return Claim(False, at, count, arithmetic.exact)
            undecided = np.concatenate([extremum.left.owner, np.flatnonzero(doubtful)])
            if not undecided.size and extremum.owner < 0:
                return Claim(True, {}, count, arithmetic.exact)
            if self.stop.now or arithmetic.exact:
                break
            owners = undecided
            if extremum.owner >= 0:  # above the bound by less than the error of floats
                above = ~(oriented.excess(start, self.stop) <= 0)
                owners = np.concatenate([owners, oriented.owner[above]])
            cells = np.unique(surface.pieces.flat_cells[owners])
        return Claim(None, {}, count, False)

    def _as_bounds(
        self, ends: list[tuple[int, Any, Any, dict[str, Fraction]]], shift: Any, pieces: int, *,
        complete: bool, exact: bool,
    ) -> Bounds:  # fmt: skip
        bounds: dict[int, tuple[float, float, Point]] = {}
        for sign, reached, bound, at in ends:
            if exact:
                outer = sign * math.inf  # time ran out before any bound
                if math.isfinite(nearest_float(bound)):
                    outer = _outward(as_fraction(bound) * sign + as_fraction(shift), sign)
                inner = nearest_float(as_fraction(reached) * sign + as_fraction(shift))
            else:
                outer = nearest_float(bound) * sign + float(shift)
                outer += sign * WIDENED * max(self.range, abs(outer))
                inner = nearest_float(reached) * sign + float(shift)
            bounds[sign] = outer, inner, {name: float(x) for name, x in at.items()}
        low, reached_low, at_low = bounds.get(-1, (-math.inf, math.nan, {}))
        most, reached_high, at_high = bounds[1]
        way = "exact" if exact else "widened"
        return Bounds(low, most, reached_low, reached_high, at_low, at_high, pieces, way, complete)

    def first_arithmetic(self, problem: QuotientProblem) -> Arithmetic:
        """Return floats, if they may decide a problem: slopes they cannot."""
        return rationals() if self.exact or problem.steep else FLOATS

    # ── cached surfaces ──────────────────────────────────────────────────────────────

    def surface(
        self, problem: QuotientProblem, arithmetic: Arithmetic, cells: Array | None = None
    ) -> Surface:
        """Return the pieces for a problem; whole cuts are cached."""
        assert self.model is not None
        positions = tuple(tuple(position) for position in problem.positions)
        # The other rule base belongs to the problem only: its pieces are not cached.
        remembers = cells is None and problem.other is None
        steps = problem.steps
        key = (problem.box, positions, problem.mirrored, problem.form, steps, arithmetic.exact)
        if remembers and key in self._surfaces:
            surface = self._surfaces[key]
            surface.pieces.stop = self.stop
            return surface
        what = Cut(problem.box, positions, problem.mirrored, problem.form, problem.other, steps)
        try:
            pieces = cut(self.model, what, arithmetic, cells, self.stop)
            new_surface = Surface(self.model, pieces)
        except TooManyPiecesError as error:
            raise UnprovableError(str(error)) from None
        if remembers:
            self._surfaces[key] = new_surface
        return new_surface

    def named(self, position: list[Fraction]) -> dict[str, Fraction]:
        """Return inputs by name, fixed ones included, in the order of the rule base."""
        values = {**self.fixed, **dict(zip(self.names, position, strict=True))}
        return {variable.name: values[variable.name] for variable in self.rulebase.inputs}


def _outward(number: Fraction, sign: int) -> float:
    """Return the nearest float on the outer side."""
    value = float(number)
    if sign * (Fraction(value) - number) < 0:
        value = math.nextafter(value, sign * math.inf)
    return value
