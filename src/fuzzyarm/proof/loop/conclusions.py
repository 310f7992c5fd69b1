"""Rule bases and tables as known gains and blocks, around their inputs at rest.

A rule base that vanishes with the weighted input sum of its linear law is one gain along this sum,
within a proved sector (:mod:`fuzzyarm.proof.map.sector`); otherwise its deviation from rest is a
sum of its inputs with gains within its proved slopes (mean value theorem, on pieces).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import TypeVar

import numpy as np

from fuzzyarm.inference.engine import cached_engine
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.check.certificate import Gains
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.loop.affine import ONE, ZERO, Affine, AffineAlgebra, Rules, number
from fuzzyarm.proof.loop.enclosure import Intervals
from fuzzyarm.proof.loop.form import Assumptions
from fuzzyarm.proof.loop.outward import around, end_of
from fuzzyarm.proof.map.bounds import Bounds, UnprovableError
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.map.sector import NoSectorError, Slopes, sector, slopes_at
from fuzzyarm.proof.stop import Stop
from fuzzyarm.table import LookupTable

T = TypeVar("T")

Tables = Callable[[AffineAlgebra, LookupTable, Mapping[str, Affine]], Affine]


class Conclusions:
    """The rule bases and tables of one loop, with a cache of proved bounds.

    If the rest is not exact (`is_exact`), inputs are only near 0, and a sector proves nothing. With
    `at_zero`, the linear law is the one around 0, wherever the inputs rest.
    """

    def __init__(self, stop: Stop) -> None:
        self.stop = stop
        self.is_exact = self.at_zero = True
        self._cache: dict[object, object] = {}

    def _prover(self, rulebase: RuleBase, output: str) -> Prover:
        key = "prover", id(rulebase), output
        prover = self._cached(key, lambda: Prover(rulebase, output, sampled=True))
        prover.stop = self.stop
        if prover.model is None:
            raise LoopProofError(
                f"'{rulebase.name}' is not made of straight pieces: {prover.reason}",
                hint="compile it to a table, interpolated linearly",
            )
        return prover

    def resting(
        self, algebra: AffineAlgebra, rulebase: RuleBase, inputs: Mapping[str, Affine]
    ) -> list[Affine]:
        """Return the linear law of a rule base, around its inputs at rest."""
        forms = []
        moving = {name: form for name, form in inputs.items() if not form.is_constant}
        if not self.at_zero:
            moving = {name: form.deviation for name, form in moving.items()}
        for output in rulebase.outputs:
            prover = self._prover(rulebase, output.name)
            at = {name: form.constant for name, form in inputs.items()}
            if self.at_zero:
                at |= dict.fromkeys(moving, ZERO)
            total = number(self._value_at(prover, at))
            near = {name: float(x) for name, x in at.items()}
            for name, form in moving.items():
                low, high = self._slopes_at(prover, near).around(name)
                total = total.plus(form.scaled((low + high) / 2))
            forms.append(Affine(total.constant, total.parts))
        return forms

    def _slopes_at(self, prover: Prover, at: Mapping[str, float]) -> Slopes:
        return self._cached(
            ("slopes", id(prover), tuple(at.items())), lambda: slopes_at(prover, at)
        )

    def _value_at(self, prover: Prover, at: Mapping[str, Fraction]) -> Fraction:
        self._demand_inside(prover, at)
        value = self._cached(("value", id(prover), tuple(at.items())), lambda: prover.exactly(at))
        if value is None:
            raise LoopProofError("no rule fires at rest")
        return Fraction(value)

    def _cached(self, key: object, find: Callable[[], T]) -> T:
        """Return a cached value, computed on first use."""
        if key not in self._cache:
            self._cache[key] = find()
        return self._cache[key]  # type: ignore[return-value]

    def near(self, rulebase: RuleBase, output: str, inputs: Mapping[str, float]) -> float:
        """Return an output at a point, by inference."""
        self._demand_inside(self._prover(rulebase, output), inputs)
        return float(cached_engine(rulebase)(inputs)[output])

    def _demand_inside(self, prover: Prover, at: Mapping[str, float | Fraction]) -> None:
        for name, low, high in self._universes(prover):
            if not low <= at[name] <= high:
                raise LoopProofError(f"at rest '{name}' is outside its universe")

    @staticmethod
    def _universes(prover: Prover) -> list[tuple[str, Fraction, Fraction]]:
        universes = []
        for variable in prover.inputs:
            if not (math.isfinite(variable.low) and math.isfinite(variable.high)):
                raise LoopProofError(f"the input '{variable.name}' of a rule base has no end")
            universes.append((variable.name, Fraction(variable.low), Fraction(variable.high)))
        return universes

    def concluding(self, choice: Assumptions) -> Rules:
        """Return the function that bounds rule bases in a form."""

        def rules(
            algebra: AffineAlgebra, rulebase: RuleBase, inputs: Mapping[str, Affine]
        ) -> list[Affine]:
            signs = _noted(choice, algebra, rulebase, inputs)
            return [
                self._conclusion(choice, algebra, rulebase, output.name, inputs, signs)
                for output in rulebase.outputs
            ]

        return rules

    def _conclusion(
        self,
        choice: Assumptions,
        algebra: AffineAlgebra,
        rulebase: RuleBase,
        output: str,
        inputs: Mapping[str, Affine],
        signs: Mapping[str, int],
    ) -> Affine:
        """Return an output as a known gain and blocks, around its inputs at rest."""
        prover = self._prover(rulebase, output)
        rest = {name: variable.constant for name, variable in inputs.items()}
        value = self._value_at(prover, rest)
        region = self._region(choice, algebra, prover, inputs, signs)
        key = "without value", id(prover), tuple(region.items())
        if self._cached(key, lambda: prover.without_value(region)) is not None:
            raise LoopProofError(f"'{rulebase.name}' has no rule for some of its inputs near rest")
        along = None
        # One gain along the linear law is tighter than one along each input; it needs f(0) = 0.
        if choice.along and self.is_exact and not any(rest.values()) and value == 0:
            along = self._sector(prover, region, [n for n in inputs if not inputs[n].is_constant])
        if along is not None:
            weights, low, high = along
            gains = {"": (low, high)}
            sigma = Affine(ZERO)
            for name, weight in weights.items():
                sigma = sigma.plus(inputs[name].deviation.scaled(weight))
            parts = _gain(algebra, sigma, low, high, f"{rulebase.name}, a gain in")
        else:
            weights, gains = {}, {}
            parts = Affine(ZERO)
            for name, variable in inputs.items():
                if not variable.is_constant:
                    low, high = gains[name] = self._slopes(prover, region, name)
                    words = f"{rulebase.name}, its slope along {name} in"
                    parts = parts.plus(_gain(algebra, variable.deviation, low, high, words))
        # The range is kept as well: for large inputs it is tighter than gains times inputs.
        ends = self._range(prover, region)
        moving = [name for name in inputs if not inputs[name].is_constant]
        if moving:
            exact = {
                name: (max(Fraction(region[name][0]), low), min(Fraction(region[name][1]), high))
                for name, low, high in self._universes(prover)
                if name in moving
            }
            algebra.gains.append(Gains(exact, ends, weights, gains))
        doubt = sum((max(map(abs, gains[n])) * inputs[n].doubt for n in gains if n), ZERO)
        return Affine(value, parts.parts, *ends, doubt)

    def _region(
        self,
        choice: Assumptions,
        algebra: AffineAlgebra,
        prover: Prover,
        inputs: Mapping[str, Affine],
        signs: Mapping[str, int],
    ) -> dict[str, tuple[float, float]]:
        """Return the assumed region of the inputs, and record it."""
        rest = {name: variable.constant for name, variable in inputs.items()}
        region: dict[str, tuple[float, float]] = {}
        for name, low, high in self._universes(prover):
            if inputs[name].is_constant:
                region[name] = (float(rest[name]), float(rest[name]))
                continue
            # Symmetric about rest, so that it bounds the deviation alone.
            doubt = inputs[name].doubt
            half = choice.share * (min(high - rest[name], rest[name] - low) - doubt)
            half = half if half <= 0 else Fraction(end_of(half, low=True))
            if half <= 0 or not low <= rest[name] - half <= rest[name] + half <= high:
                raise LoopProofError(f"at rest '{name}' is at the end of its universe")
            region[name] = around(rest[name], half + doubt)
            if signs[name]:
                region[name] = _on_one_side(region[name], rest[name], signs[name])
            algebra.require(inputs[name], -half, half, f"'{name}' of {prover.rulebase.name}")
        return region

    def _sector(
        self, prover: Prover, region: Mapping[str, tuple[float, float]], names: Sequence[str]
    ) -> tuple[dict[str, Fraction], Fraction, Fraction] | None:
        """Return the sector along the linear law: weights, least and greatest gain; or None."""
        key = "sector", id(prover), tuple(region.items())
        return self._cached(key, lambda: self._new_sector(prover, region, names))

    def _new_sector(
        self, prover: Prover, region: Mapping[str, tuple[float, float]], names: Sequence[str]
    ) -> tuple[dict[str, Fraction], Fraction, Fraction] | None:
        try:
            slopes = self._slopes_at(prover, dict.fromkeys(prover.names, 0.0))
            weights = {}
            for name in names:
                low, high = slopes.around(name)
                side = -ONE if not region[name][1] else ONE
                ahead = slopes.along({name: side})
                weights[name] = ahead * side if ahead is not None else (low + high) / 2
            if not all(weights.values()):
                return None
            enclosure = sector(prover, weights, region)
        except (NoSectorError, UnprovableError):
            return None
        # With slack the output is not exactly 0 with the sum: then no gain along it is sound.
        if enclosure.slack or not enclosure.complete:
            return None
        return weights, Fraction(enclosure.low), Fraction(enclosure.high)

    def _slopes(
        self, prover: Prover, region: Mapping[str, tuple[float, float]], name: str
    ) -> tuple[Fraction, Fraction]:
        key = "slope", id(prover), name, tuple(region.items())
        return self._bounded(key, lambda: prover.slope(region, name))

    def _range(
        self, prover: Prover, region: Mapping[str, tuple[float, float]]
    ) -> tuple[Fraction, Fraction]:
        key = "range", id(prover), tuple(region.items())
        return self._bounded(key, lambda: self._value_everywhere(prover, region))

    @staticmethod
    def _value_everywhere(prover: Prover, region: Mapping[str, tuple[float, float]]) -> Bounds:
        hole = prover.hole(region)
        if hole:
            raise LoopProofError(hole)
        return prover.value(region)

    def _bounded(self, key: object, prove: Callable[[], Bounds]) -> tuple[Fraction, Fraction]:
        """Return proved ends, cached under a key; a prover without time left proves none."""
        bounds = self._cached(key, prove)
        if not (math.isfinite(bounds.low) and math.isfinite(bounds.high)):
            raise LoopProofError("time ran out before a rule base was bounded")
        return Fraction(bounds.low), Fraction(bounds.high)

    def resting_table(
        self, algebra: AffineAlgebra, table: LookupTable, inputs: Mapping[str, Affine]
    ) -> Affine:
        """Return a table at rest, as a number."""
        at = [
            float(variable.constant) if variable.is_constant else 0.0
            for variable in inputs.values()
        ]
        return number(float(table.lookup(*at)))

    def tabled(self, choice: Assumptions) -> Tables:
        """Return the function that bounds tables in a form."""

        def table(
            algebra: AffineAlgebra, table: LookupTable, inputs: Mapping[str, Affine]
        ) -> Affine:
            return _table_form(choice, algebra, table, inputs)

        return table


def _noted(
    choice: Assumptions, algebra: AffineAlgebra, rulebase: RuleBase, inputs: Mapping[str, Affine]
) -> dict[str, int]:
    """Record the moving inputs of a rule base; return the side of its rest for each."""
    signs = dict.fromkeys(inputs, 0)
    for name, x in inputs.items():
        if not x.is_constant:
            signs[name] = choice.signs[len(algebra.inputs)] if choice.signs else 0
            at = float(x.constant)
            corners = {c for term in rulebase.variable(name).terms for c in term.shape.parameters}
            edge = at in corners and Fraction(at) == x.constant
            algebra.inputs.append((x.deviation, edge))
    return signs


def _on_one_side(region: tuple[float, float], rest: Fraction, sign: int) -> tuple[float, float]:
    """Return the part of an interval on one side of a rest."""
    at = float(rest)
    if Fraction(at) != rest:
        raise LoopProofError("an input does not rest at a float")
    return (at, region[1]) if sign > 0 else (region[0], at)


def _gain(
    algebra: AffineAlgebra, signal: Affine, low: Fraction, high: Fraction, words: str
) -> Affine:
    """Return a signal times an uncertain gain between two numbers."""
    # gain = middle + radius δ with |δ| ≤ 1: the second part is a block of the form.
    middle, radius = (low + high) / 2, (high - low) / 2
    form = signal.scaled(middle)
    if radius:
        words = f"{words} {float(low):.6g} .. {float(high):.6g}"
        form = form.plus(algebra.block(signal.scaled(radius), words))
    return form


def _table_form(
    choice: Assumptions, algebra: AffineAlgebra, table: LookupTable, inputs: Mapping[str, Affine]
) -> Affine:
    """Return an interpolated table as slopes along each input, around rest."""
    if table.default_mode != "linear":
        raise LoopProofError(f"a table with steps ('{table.default_mode}') jumps at rest")
    rest = [float(variable.constant) for variable in inputs.values()]
    for axis, x, variable in zip(table.axes, rest, inputs.values(), strict=True):
        exactly = Fraction(x) == variable.constant and not variable.doubt
        if not exactly or x not in axis.levels:  # its value would be rounded
            raise LoopProofError(f"at rest '{axis.name}' of a table is between two levels")
    values = np.asarray(table.values, float)
    total = Affine(ZERO)
    region, gains = {}, {}
    for index, (axis, (name, form)) in enumerate(zip(table.axes, inputs.items(), strict=True)):
        if form.is_constant:
            continue
        levels = np.asarray(axis.levels, float)
        first, last = (Fraction(float(level)) for level in levels[[0, -1]])
        half = choice.share * min(last - form.constant, form.constant - first)
        if half <= 0:
            raise LoopProofError(f"at rest '{name}' is at the end of its table")
        algebra.require(form, -half, half, f"'{name}' of a table")
        steps = Intervals.at(np.moveaxis(values, index, -1))
        slopes = (steps[..., 1:] - steps[..., :-1]) / (
            Intervals.at(levels[1:]) - Intervals.at(levels[:-1])
        )
        low, high = Fraction(float(slopes.low.min())), Fraction(float(slopes.high.max()))
        region[name] = (form.constant - half, form.constant + half)
        gains[name] = (low, high)
        words = f"a table, its slope along {name} in"
        total = total.plus(_gain(algebra, form.deviation, low, high, words))
    value = Fraction(float(table.lookup(*rest)))
    ends = Fraction(float(values.min())), Fraction(float(values.max()))
    if gains:
        algebra.gains.append(Gains(region, ends, {}, gains))
    return Affine(value, total.parts, *ends)
