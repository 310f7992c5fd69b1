"""Bounds of one output that hold at every point: value, slope, error of a table, coverage.

Each statement is a quotient of polynomials (:mod:`.surface`), whose bounds :mod:`.search` finds. A
rule base that is not piecewise linear is bounded over boxes (:mod:`.boxes`): always sound, mostly
wider.

To add a property: a quotient of polynomials in :mod:`.surface`, its problem here, a verb of
``ProveNode`` in :mod:`fuzzyarm.language.statements` (its demands on ranges in
:mod:`fuzzyarm.language.demands`) and its judge in :mod:`.verdicts`. By hand besides: the kinds of
``Property`` in :mod:`fuzzyarm.language.model.rulebase`, its quotient in ``QUOTIENTS`` of
``tests/proof/test_soundness.py`` (its rounding against rationals), the statement in
``tests/fuzz/attacked_proofs.py``, ``docs/reference/metrics.md``; then ``tools/make_schemas.py`` and
``pytest --update-golden tests/language tests/lsp``. ``tests/proof/test_every_verb.py`` names a
missing part.
New features of rule bases are refused by name in :mod:`.straight` and :mod:`.boxes` until
``tests/proof/test_soundness.py`` covers them; ``tests/fuzz/random_proofs.py`` tries to refute
proofs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import copy
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference.plan import plan
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map.arithmetic import as_fraction, rationals
from fuzzyarm.proof.map.bernstein import Quotients
from fuzzyarm.proof.map.bounds import Bounds, Claim, Missing, NothingFiresError, UnprovableError
from fuzzyarm.proof.map.pieces import Cut, cut
from fuzzyarm.proof.map.search import Box, QuotientProblem, QuotientSearch
from fuzzyarm.proof.map.straight import NotStraightError, straight, with_fixed
from fuzzyarm.proof.map.surface import Surface, TableValues
from fuzzyarm.proof.stop import Stop

if TYPE_CHECKING:
    from fuzzyarm.proof.map.boxes import Boxes
    from fuzzyarm.table import LookupTable


class Prover(QuotientSearch):
    """Proves statements about one output of a rule base, with a cache of cut pieces.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    output : str
        Name of the output.
    tolerance : float, optional
        Largest gap between bounds and attained values, in their units; 1e-8 of the range of the
        output by default.
    stop : Stop, optional
        Time budget and callback for progress.
    exact : bool
        Compute everything in rationals.
    sampled : bool
        Cut a centroid of samples into pieces, too, see :func:`.straight.straight`.

    Attributes
    ----------
    reason : str
        Why boxes are used; empty for exact pieces.
    """

    def __init__(
        self,
        rulebase: RuleBase,
        output: str,
        *,
        tolerance: float | None = None,
        stop: Stop | None = None,
        exact: bool = False,
        sampled: bool = False,
    ) -> None:
        super().__init__(rulebase, output, tolerance=tolerance, stop=stop, exact=exact)
        self._any_boxes: Boxes | None = None
        self.reason = ""
        try:
            self.model = straight(rulebase, output, sampled=sampled)
        except NotStraightError as error:
            self.reason = str(error)

    @cached_property
    def stays_inside(self) -> bool:
        """Whether no value but the one for *no rule* can leave the range of the output."""
        return self.output.outside != "extend" or self.lies_between

    @cached_property
    def lies_between(self) -> bool:
        """Whether all conclusions of rules lie in the range of the output."""
        output_plan = plan(self.rulebase).outputs[self.output.name]
        if not output_plan.discrete or not output_plan.record.is_between:
            return output_plan.record.is_between
        low, high = self.output.low, self.output.high
        return all(m.value is not None and low <= m.value <= high for m in output_plan.members)

    # ── the box ──────────────────────────────────────────────────────────────────────

    def box(self, region: Mapping[str, tuple[float, float]]) -> Box:
        """Return the interval of each input, by default its range.

        Raises
        ------
        UnprovableError
            If an input is unbounded and the region does not bound it.
        """
        ranges = []
        for variable in self.inputs:
            low, high = region.get(variable.name, (variable.low, variable.high))
            if variable.outside != "extend":  # beyond its range an input is clamped
                low, high = (min(max(x, variable.low), variable.high) for x in (low, high))
            if not (math.isfinite(low) and math.isfinite(high)):
                raise UnprovableError(
                    f"'{variable.name}' is unbounded",
                    hint=f"say in which part:  {variable.name} in LOW .. HIGH -> …",
                )
            ranges.append((Fraction(low), Fraction(high)))
        return tuple(ranges)

    def with_fixed(self, values: Mapping[str, Fraction]) -> Prover:
        """Return the prover of a piecewise linear rule base with some inputs fixed.

        Pieces then have the dimension of the other inputs, at least one.
        """
        values = {name: values[name] for name in self.names if name in values}
        if self.model is None or not 0 < len(values) < len(self.names):
            return self
        prover = copy(self)
        axes = {self.names.index(name): x for name, x in values.items()}
        prover.model = with_fixed(self.model, axes)
        prover.inputs = tuple(variable for variable in self.inputs if variable.name not in values)
        prover.names = tuple(variable.name for variable in prover.inputs)
        prover.fixed = {**self.fixed, **values}
        prover._surfaces = {}
        return prover

    # ── statements ────────────────────────────────────────────────────────────────────

    def value(self, region: Mapping[str, tuple[float, float]]) -> Bounds:
        """Return bounds of the output over a region, ``no-rule`` values included."""
        box = self.box(region)
        if self.model is None:
            return self._boxes(box).value(self.gap)
        no_rule = self.no_rule
        try:
            bounds = self._clamped(
                self.bounds_of(QuotientProblem(box, Surface.value), shifted=True)
            )
        except NothingFiresError:
            if no_rule is None:
                raise
            corner = {name: float(low) for name, (low, _) in zip(self.names, box, strict=True)}
            ends = (no_rule, no_rule, no_rule, no_rule)
            return Bounds(*ends, corner, corner, self.pieces_cut, "exact", True)
        if no_rule is not None:  # not clamped to the range
            at = self.without_value(region)
            if at is not None:
                bounds = _including(bounds, no_rule, at)
        return bounds

    @property
    def no_rule(self) -> float | None:
        """The value where no rule fires; None if that is not a number."""
        no_rule = self.output.no_rule
        is_number = isinstance(no_rule, int | float) and not math.isnan(no_rule)
        return float(no_rule) if is_number else None

    def slope(self, region: Mapping[str, tuple[float, float]], name: str) -> Bounds:
        """Return bounds of the slope along an input, wherever the output has one."""
        problem = self._slope_problem(region, name)
        return self.bounds_of(problem)

    def steepness(self, region: Mapping[str, tuple[float, float]]) -> Bounds:
        """Return bounds of the gradient's norm: the upper one is a Lipschitz constant."""
        self.demand_pieces("slopes")
        problem = QuotientProblem(self.box(region), Surface.gradient_squared, steep=True)
        for axis in range(len(self.names)):
            self._demand_no_jumps(problem, axis)
        # Squares: a gap g of the norm ℓ is a gap 2 ℓ g of ℓ².
        bounds = self.bounds_of(problem, both=False, share=2.0 * self.range)
        low, high = 0.0, math.nextafter(math.sqrt(bounds.high), math.inf)
        return bounds._replace(
            low=low, high=high, reached_low=low, reached_high=math.sqrt(bounds.reached_high)
        )

    def table(
        self,
        table: LookupTable,
        mode: str,
        region: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    ) -> Bounds:
        """Return bounds of table minus output (negative: table below output) over a region."""
        box = self.box(region)
        table = self._fitting(table)
        if self.model is None:
            at = self.outside_range(region)
            if at is not None:
                raise UnprovableError(f"the error of a table: {self.beyond_range(at)}")
            if self.no_rule is None:  # boxes bound the value for no rule, too
                self._demand_value_everywhere("the error of a table", region)
            return self._boxes(box).table(table, mode, self.gap)
        self._demand_value_everywhere("the error of a table", region)
        self.demand_inside_range("the error of a table", box)
        return self.bounds_of(self._table_problem(table, mode, box))

    def demand_bounds(self) -> None:
        """Refuse a rule base without provable bounds, before any long work."""
        if self.model is None:
            self._boxes(self.box({}))

    def table_at_most(
        self,
        region: Mapping[str, tuple[float, float]],
        table: LookupTable,
        mode: str,
        bound: float,
    ) -> Claim:
        """Return whether a table's error in a region is at most `bound`."""
        problem = self._table_problem(self._fitting(table), mode, self.box(region))
        above = self.at_most(problem, Fraction(bound), negated=False)
        return above if not above.holds else self.at_most(problem, Fraction(bound), negated=True)

    def boxes_at_most(
        self, region: Mapping[str, tuple[float, float]], bound: float, *, negated: bool
    ) -> tuple[bool, int]:
        """Return whether boxes show the output to be at most `bound`, and their number."""
        return self._boxes(self.box(region)).at_most(bound, negated=negated)

    def value_at_most(
        self,
        region: Mapping[str, tuple[float, float]],
        bound: float,
        *,
        negated: bool,
        strict: bool,
    ) -> Claim:
        """Return whether the output (or its negative) is at most `bound`, below it if strict."""
        assert self.model is not None
        claim = self.at_most(
            QuotientProblem(self.box(region), Surface.value),
            Fraction(bound),
            negated=negated,
            strict=strict,
            shifted=True,
        )
        if claim.holds is False and not claim.exact:
            value = self._concluded(claim.at)
            if value is None or (-value if negated else value) <= bound:  # beyond by rounding alone
                exact = self.in_rationals()
                return exact.value_at_most(region, bound, negated=negated, strict=strict)
        return claim

    def slope_at_most(
        self,
        region: Mapping[str, tuple[float, float]],
        name: str,
        bound: Fraction,
        *,
        negated: bool,
    ) -> Claim:
        """Return whether the slope (or minus the slope) is at most `bound`."""
        problem = self._slope_problem(region, name)
        return self.at_most(problem, bound, negated=negated)

    def odd_within(self, region: Mapping[str, tuple[float, float]], bound: float) -> Claim:
        """Return whether ``|u(x) + u(−x)|`` is at most `bound` everywhere."""
        self.demand_pieces("symmetry")
        self._demand_value_everywhere("symmetry")
        self.demand_inside_range("symmetry", self.box({}))
        problem = QuotientProblem(self.box(region), Surface.odd, mirrored=True)
        above = self.at_most(problem, Fraction(bound), negated=False)
        return above if not above.holds else self.at_most(problem, Fraction(bound), negated=True)

    def apart(self, other: Prover) -> Bounds:
        """Return bounds of this output minus another rule base's over the same inputs.

        Raises
        ------
        UnprovableError
            If either is not piecewise linear, has points without a value, or leaves its range; or
            if the inputs differ in number, order, range or treatment outside.
        """
        for each in (self, other):
            each.demand_pieces("a difference")
            each._demand_value_everywhere("a difference")
            each.demand_inside_range("a difference", each.box({}))
        box, second = self.box({}), other.model
        if box != other.box({}):
            raise UnprovableError("a difference: the inputs have different ranges")
        assert second is not None
        return self.bounds_of(
            QuotientProblem(box, lambda surface: surface.apart(second), other=second)
        )

    def uncovered(self, region: Mapping[str, tuple[float, float]]) -> dict[str, Fraction] | None:
        """Return a point at which no rule fires; None if there is none.

        Raises
        ------
        UnprovableError
            If it cannot be decided.
        """
        return self._point_without_rule(region, valued=False)

    def without_value(
        self, region: Mapping[str, tuple[float, float]]
    ) -> dict[str, Fraction] | None:
        """Return a point at which no rule fires, or only rules without area in the range.

        Raises
        ------
        UnprovableError
            If it cannot be decided.
        """
        return self._point_without_rule(region, valued=True)

    def _point_without_rule(
        self, region: Mapping[str, tuple[float, float]], *, valued: bool
    ) -> dict[str, Fraction] | None:
        box = self.box(region)
        if self.model is None:
            return self._boxes(box).point_without_rule(valued=valued)
        problem = QuotientProblem(box, Surface.value)
        surface = self.surface(problem, self.first_arithmetic(problem))
        if not self.exact:
            doubtful_cells = surface.nearly_without_rule(valued=valued)
            if not doubtful_cells.size:
                return None
            cells = np.unique(surface.pieces.flat_cells[doubtful_cells])
            surface = self.surface(problem, rationals(), cells)
        corner = surface.point_without_rule(valued=valued)
        return None if corner is None else self.named(surface.pieces.position(*corner))

    def outside_range(
        self, region: Mapping[str, tuple[float, float]]
    ) -> dict[str, Fraction] | None:
        """Return a point at which the output leaves its range and has no value; None: nowhere.

        Only an output with ``outside error`` has no value there.

        Raises
        ------
        UnprovableError
            If it cannot be decided.
        """
        if self.output.outside != "error" or self.lies_between:
            return None
        for sign, limit in ((-1, self.output.low), (1, self.output.high)):
            if math.isinf(limit):
                continue
            claim = self._inside_at(region, sign, limit)
            if claim.holds is None:
                where = f"outside its range, where '{self.output.name}' has no value"
                raise UnprovableError(f"whether it may be {where}, is open")
            if not claim.holds:
                return claim.at
        return None

    def missing(self, region: Mapping[str, tuple[float, float]]) -> Missing | None:
        """Return a point without a value of its own; None if there is none.

        Raises
        ------
        UnprovableError
            If it cannot be decided.
        """
        at = self.without_value(region) if self.no_rule is None else None
        if at is not None:
            held = self.output.no_rule == "hold"
            then = f": '{self.output.name}' holds its last value" if held else ""
            return Missing(at, f"no rule fires at {point_text(at)}{then}", no_rule=True, held=held)
        at = self.outside_range(region)
        return None if at is None else Missing(at, self.beyond_range(at), no_rule=False)

    def hole(self, region: Mapping[str, tuple[float, float]]) -> str:
        """Return where the output has no value of its own, or why that is open; else nothing."""
        try:
            missing = self.missing(region)
        except FuzzyarmError as error:
            return str(error)
        return "" if missing is None else missing.reason

    def _inside_at(
        self, region: Mapping[str, tuple[float, float]], sign: int, limit: float
    ) -> Claim:
        """Return whether the output, before any clamp, stays on one side of its range."""
        if self.model is None:
            holds, pieces = self.boxes_at_most(region, sign * limit, negated=sign < 0)
            return Claim(holds or None, {}, pieces, False)
        return self.value_at_most(region, sign * limit, negated=sign < 0, strict=False)

    def beyond_range(self, at: Mapping[str, Fraction]) -> str:
        """Return the sentence about a point where the output leaves its range, without a value."""
        value = self._concluded(at)
        number = "" if value is None else f" is {float(value):.10g},"
        ends = f"{self.output.low:g} .. {self.output.high:g}"
        return (
            f"'{self.output.name}'{number} outside its range {ends}, at {point_text(at)}: "
            "it has no value there"
        )

    # ── quotients and boxes ──────────────────────────────────────────────────────────

    def _slope_problem(
        self, region: Mapping[str, tuple[float, float]], name: str
    ) -> QuotientProblem:
        self.demand_pieces("slopes")
        axis = self.names.index(name)
        problem = QuotientProblem(self.box(region), lambda surface: surface.slope(axis), steep=True)
        self._demand_no_jumps(problem, axis)
        return problem

    def _table_problem(self, table: LookupTable, mode: str, box: Box) -> QuotientProblem:
        names = self.names

        def make(surface: Surface) -> Quotients:
            return surface.difference(TableValues(table, mode, surface.pieces, names))

        positions = TableValues.positions(table, mode, names)
        return QuotientProblem(box, make, positions, steps=mode != "linear")

    def _boxes(self, box: Box) -> Boxes:
        from fuzzyarm.proof.map.boxes import Boxes

        ends = [(float(low), float(high)) for low, high in box]
        if self._any_boxes is None:
            self._any_boxes = Boxes(self.rulebase, self.output.name, ends, self.stop)
        return self._any_boxes.over(ends, self.stop)

    # ── single points ────────────────────────────────────────────────────────────────

    def exactly(self, at: Mapping[str, float | Fraction]) -> Fraction | None:
        """Return the output at a point in exact arithmetic; None without a value."""
        value = self._concluded(at)
        if value is None:
            return None if self.no_rule is None else Fraction(self.no_rule)
        low, high = (
            Fraction(end) if math.isfinite(end) else None
            for end in (self.output.low, self.output.high)
        )
        least = value if low is None else max(value, low)
        inside = least if high is None else min(least, high)
        if self.output.outside == "error" and inside != value:
            return None
        return inside if self.output.outside == "clamp" else value

    def _concluded(self, at: Mapping[str, float | Fraction]) -> Fraction | None:
        """Return the conclusion of the rules at a point, without the clamp to the range."""
        assert self.model is not None
        box = tuple((Fraction(at[name]), Fraction(at[name])) for name in self.names)
        surface = Surface(self.model, cut(self.model, Cut(box), rationals()))
        quotients = surface.value()
        if not quotients.lower[0, 0] > 0 or surface.point_without_rule(valued=True) is not None:
            return None
        return as_fraction(quotients.upper[0, 0] / quotients.lower[0, 0] + surface.centre)

    # ── refusals ─────────────────────────────────────────────────────────────────────────

    def demand_pieces(self, kind: str) -> None:
        """Refuse a rule base that is not piecewise linear."""
        if self.model is None:
            raise UnprovableError(f"proofs of {kind} need straight pieces: {self.reason}")

    def _demand_no_jumps(self, problem: QuotientProblem, axis: int) -> None:
        surface = self.surface(problem, self.first_arithmetic(problem))
        if surface.pieces.grid.jumps[axis]:
            raise UnprovableError(f"a term of '{self.names[axis]}' has a vertical edge: jumps")
        low, high = problem.box[axis]
        region = {
            name: (float(a), float(b)) for name, (a, b) in zip(self.names, problem.box, strict=True)
        }
        at = self.without_value(region) if low < high else None
        if at is not None:
            raise UnprovableError(f"slopes: no rule fires at {point_text(at)}")
        self.demand_inside_range("slopes", problem.box)

    def _demand_value_everywhere(
        self, statement: str, region: Mapping[str, tuple[float, float]] = MappingProxyType({})
    ) -> None:
        at = self.without_value(region)
        if at is not None:
            raise UnprovableError(f"{statement}: no rule fires at {point_text(at)}")

    def _fitting(self, table: LookupTable) -> LookupTable:
        """Return a table over all inputs; refuse one with other inputs."""
        if not set(table.names) <= set(self.names):
            raise UnprovableError(
                f"the table is over {', '.join(table.names)},"
                f" and the rule base over {', '.join(self.names)}"
            )
        from fuzzyarm.table.compiler import over_inputs

        return over_inputs(table, self.rulebase.inputs)

    def demand_inside_range(self, statement: str, box: Box) -> None:
        """Refuse an output that leaves its range, where it is clamped or has no value."""
        assert self.model is not None
        if math.isfinite(self.model.low) or self.output.outside == "extend":
            return
        bounds = self.bounds_of(QuotientProblem(box, Surface.value), shifted=True)
        if bounds.low < self.output.low or bounds.high > self.output.high:
            then = "is clamped" if self.output.outside == "clamp" else "has no value there"
            raise UnprovableError(f"{statement}: '{self.output.name}' leaves its range and {then}")

    def _clamped(self, bounds: Bounds) -> Bounds:
        """Clamp bounds of the value to the range, as inference does; a centroid lies in it."""
        low, high = self.output.low, self.output.high
        free = self.model is not None and not math.isfinite(self.model.low)
        if self.output.outside != "clamp" and free:
            return bounds
        return bounds._replace(
            low=min(max(bounds.low, low), high),
            high=min(max(bounds.high, low), high),
            reached_low=min(max(bounds.reached_low, low), high),
            reached_high=min(max(bounds.reached_high, low), high),
        )


def _including(bounds: Bounds, value: float, at: dict[str, Fraction]) -> Bounds:
    point = {name: float(x) for name, x in at.items()}
    if value < bounds.reached_low:
        bounds = bounds._replace(low=min(value, bounds.low), reached_low=value, at_low=point)
    if value > bounds.reached_high:
        bounds = bounds._replace(high=max(value, bounds.high), reached_high=value, at_high=point)
    return bounds


def point_text(at: Mapping[str, Any]) -> str:
    """Return a point as ``e = 1, ce = 2``."""
    return ", ".join(f"{name} = {float(x):.10g}" for name, x in at.items())
