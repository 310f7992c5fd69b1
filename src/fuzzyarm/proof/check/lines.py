"""Signals of a loop around its rest, derived by the checker from the program.

A signal is its value at rest, mostly exact, plus weights of states z and answers w. A condition of
its validity is noted as a row whose magnitude must stay below a limit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from flint import arb, fmpq

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.check.certificate import Evidence, Gains
from fuzzyarm.proof.check.numbers import (
    ONE,
    ZERO,
    Number,
    exact,
    greatest,
    is_point,
    is_zero,
    least,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, applied
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.table import LookupTable

Parts = Mapping[str, Number]

Row = tuple[Parts, Number, str]
"""Weights of a row, the limit of its magnitude, and its name in words."""

LINEAR = ("add", "subtract", "negative", "multiply", "divide")
"""Operations on moving signals."""


class LinearSignal(NamedTuple):
    """A signal around rest: its value there, and weights of states and answers (``w0``, ``w1`` …).

    `low` and `high` bound it for all states and answers, if known.
    """

    rest: Number
    parts: Parts
    low: Number | None = None
    high: Number | None = None


def number_line(rest: Number) -> LinearSignal:
    """Return a constant signal."""
    return LinearSignal(rest, {}, least(rest), greatest(rest))


def combined(terms: Iterable[tuple[Parts, Number]]) -> dict[str, Number]:
    """Return Σ factor · weights."""
    total: dict[str, Number] = {}
    for parts, factor in terms:
        for name, weight in parts.items():
            total[name] = total.get(name, ZERO) + weight * factor
    return {name: weight for name, weight in total.items() if not is_zero(weight)}


def _times(x: Number | None, factor: Number) -> Number | None:
    return None if x is None else x * factor


class LinearSignals:
    """Signals around rest, for a walk over the program; assumptions are noted."""

    def __init__(
        self, evidence: Evidence, surfaces: RuleSurfaces, *, in_cone: bool = False
    ) -> None:
        self.in_cone = in_cone
        # One claim for each look-up with an input that moves, in the order of the walk.
        self.gains = iter(evidence.gains)
        self.grip = exact(evidence.grip)
        self.surfaces = surfaces
        self.blocks: list[tuple[Parts, str]] = []
        self.bounds: list[Row] = []
        self.sides: list[Parts] = []  # at least 0, in a cone

    def number(self, value: float) -> LinearSignal:
        """Return a number of the program."""
        return number_line(exact(value))

    # --- arithmetic ---

    def apply(self, operation: str, arguments: list[LinearSignal]) -> Any:
        """Apply an operation, linear in the deviations; a comparison gives a bool."""
        if not any(x.parts for x in arguments) and operation not in LINEAR:
            line = applied(operation, [Slope(x.rest, {}) for x in arguments])
            return line if isinstance(line, bool) else number_line(line.value)
        if operation in ("less", "less_equal"):
            return self._is_less(*arguments, or_equal=operation == "less_equal")
        if operation in ("minimum", "maximum"):
            # The operand that wins at rest, while a row keeps the two in this order.
            a, b = arguments
            return a if self._is_less(a, b, or_equal=True) == (operation == "minimum") else b
        if operation not in LINEAR:
            raise LoopProofError(f"'{operation}' of a signal is not linear")
        return self._linear(operation, arguments)

    def _linear(self, operation: str, arguments: list[LinearSignal]) -> LinearSignal:
        if operation == "negative":
            return self._scaled(arguments[0], -ONE)
        a, b = arguments
        if operation in ("add", "subtract"):
            if a is b and operation == "subtract":  # exactly 0, even if its rest is an interval
                return number_line(ZERO)
            return self._sum(a, b, ONE if operation == "add" else -ONE)
        if operation == "multiply":
            return self._product(a, b) if not b.parts else self._product(b, a)
        if not b.parts and not (b.rest > 0 or b.rest < 0):
            raise LoopProofError("a division by an interval that contains 0")
        return self._product(a, b if b.parts else number_line(ONE / b.rest))

    def _sum(self, a: LinearSignal, b: LinearSignal, factor: fmpq) -> LinearSignal:
        b = self._scaled(b, factor)
        low, high = (
            None if x is None or y is None else x + y for x, y in ((a.low, b.low), (a.high, b.high))
        )
        return LinearSignal(a.rest + b.rest, combined([(a.parts, ONE), (b.parts, ONE)]), low, high)

    def _scaled(self, a: LinearSignal, factor: Number) -> LinearSignal:
        if factor == 0:
            return number_line(ZERO)
        parts = {name: weight * factor for name, weight in a.parts.items()}
        low, high = (a.low, a.high) if factor > 0 else (a.high, a.low)
        return LinearSignal(a.rest * factor, parts, _times(low, factor), _times(high, factor))

    def _product(self, a: LinearSignal, factor: LinearSignal) -> LinearSignal:
        if factor.parts:
            raise LoopProofError("two signals are multiplied, or one is divided by another")
        if is_point(factor.rest):
            return self._scaled(a, factor.rest)
        if a.parts:
            raise LoopProofError("a signal is multiplied by an inexact value")
        return number_line(a.rest * factor.rest)

    def _is_less(self, a: LinearSignal, b: LinearSignal, *, or_equal: bool) -> bool:
        """Return whether a is below b at rest, and note that it has to stay so."""
        way = self._sum(b, a, -ONE)
        if not way.parts:
            if way.rest > 0 or (or_equal and way.rest >= 0):
                return True
            if way.rest < 0 or (not or_equal and way.rest <= 0):
                return False
            raise LoopProofError("a choice is open at rest")
        room = least(way.rest) if way.rest > 0 else -greatest(way.rest)
        if not room > 0:
            raise LoopProofError(
                "at rest the two signals of a choice, a limit or a maximum are equal"
            )
        self.bounds.append((way.parts, room, "a choice"))
        return bool(way.rest > 0)

    # --- limits ---

    def limit(self, x: LinearSignal, low: float, high: float) -> LinearSignal:
        """Return ``min(max(x, low), high)``, exactly or by its least share."""
        lowest = None if math.isinf(low) else exact(low)
        highest = None if math.isinf(high) else exact(high)
        above = lowest is None or (x.low is not None and lowest <= x.low)
        below = highest is None or (x.high is not None and x.high <= highest)
        if above and below:
            return x
        if not x.parts:
            line = Slope(x.rest, {})
            for operation, end in (("maximum", lowest), ("minimum", highest)):
                line = line if end is None else applied(operation, [line, Slope(end, {})])
            return number_line(line.value)
        words = f"a limit, {low:g} .. {high:g}"
        share = self._share(x, lowest, highest, words)
        if share == 1:
            return x
        # The limit maps a deviation v into the interval from share · v to v: its middle, and an
        # answer for half of its width.
        middle = {name: weight * (share + 1) / 2 for name, weight in x.parts.items()}
        half = {name: weight * (ONE - share) / 2 for name, weight in x.parts.items()}
        return LinearSignal(x.rest, {**middle, self.block(half, words): ONE}, lowest, highest)

    def excess(self, value: LinearSignal, x: LinearSignal, low: float, high: float) -> LinearSignal:
        """Return the change of x by a limit."""
        return self._linear("subtract", [value, x])

    def _share(
        self, x: LinearSignal, lowest: fmpq | None, highest: fmpq | None, words: str
    ) -> Number:
        """Return the least share of a deviation from rest that passes a limit."""
        rooms, share = [], arb(1)
        for end, most, at, sign in (
            (lowest, x.low, least(x.rest), -1), (highest, x.high, greatest(x.rest), 1),
        ):  # fmt: skip
            if end is None:
                continue
            room = least(arb((end - at) * sign))
            if not room > 0:
                raise LoopProofError(f"at rest a signal is at {words}")
            rooms.append(room)
            # At least this share of the deviation passes, wherever the signal can be.
            if most is None:
                share = arb(0)
            elif not (most - at) * sign <= room:
                share = share.min(room / ((most - at) * sign)).lower()
        # If that share is too small, a row keeps the signal so close to rest that the share `grip`
        # of it passes.
        if not share >= self.grip:
            share = least(arb(self.grip))
            if not share > 0:
                raise LoopProofError(f"nothing is left of a signal at {words}")
            self.bounds.append((x.parts, least(min(rooms) / share), words))
        return share

    def block(self, v: Parts, words: str) -> str:
        """Add an uncertain gain; return the name of its answer."""
        self.blocks.append((v, words))
        return f"w{len(self.blocks) - 1}"

    # --- rule bases and tables ---

    def rules(
        self, rulebase: RuleBase, output: str, inputs: Mapping[str, LinearSignal]
    ) -> LinearSignal:
        """Return a conclusion of a rule base, from the claimed bounds."""
        surface = self.surfaces(rulebase, output)
        rest = {name: (_exactly(least(x.rest)), _exactly(greatest(x.rest)))
                for name, x in inputs.items()}  # fmt: skip
        if not any(x.parts for x in inputs.values()):
            return number_line(surface.value(rest))
        claim = self._claim()
        region = self._region(claim, inputs, rest, rulebase.name)
        between_ends = exact(claim.between[0]), exact(claim.between[1])
        if not surface.has_range(region, *between_ends):
            raise LoopProofError(f"'{rulebase.name}' leaves the range that is claimed of it")
        if claim.weights:
            if not all(inputs[name].rest == 0 for name in claim.weights):
                raise LoopProofError("a sector is of inputs that rest at 0")
            # The gain along the weighted sum σ has the empty name.
            low, high = map(exact, claim.gains[""])
            weights = {name: exact(weight) for name, weight in claim.weights.items()}
            if not surface.has_sector(region, weights, low, high):
                raise LoopProofError(f"'{rulebase.name}' leaves the sector that is claimed of it")
            total = combined((inputs[name].parts, weight) for name, weight in weights.items())
            parts = self._gain(total, low, high, f"{rulebase.name}, a gain in")
            return LinearSignal(ZERO, parts, *between_ends)
        terms = []
        for name, x in inputs.items():
            if x.parts:
                low, high = map(exact, claim.gains[name])
                if not surface.has_slope(region, name, low, high):
                    raise LoopProofError(f"'{rulebase.name}' is steeper than is claimed of it")
                words = f"{rulebase.name}, its slope along {name} in"
                terms.append((self._gain(x.parts, low, high, words), ONE))
        return LinearSignal(surface.value(rest), combined(terms), *between_ends)

    def table(self, table: LookupTable, inputs: Mapping[str, LinearSignal]) -> LinearSignal:
        """Return the value of a table, from the claimed bounds."""
        if table.default_mode != "linear":
            raise LoopProofError("a table with steps jumps")
        claim = self._claim() if any(x.parts for x in inputs.values()) else None
        values = np.asarray(table.values, float)
        index, terms = [], []
        for axis, (name, x) in enumerate(inputs.items()):
            levels = [exact(float(level)) for level in table.axes[axis].levels]
            if not is_point(x.rest) or not any(x.rest == level for level in levels):
                raise LoopProofError("at rest an input of a table is between two levels")
            index.append(next(k for k, level in enumerate(levels) if x.rest == level))
            if not x.parts:
                continue
            assert claim is not None
            # Beyond its outer levels a table is constant.
            low, high = map(exact, claim.region[name])
            rooms = (levels[-1] - x.rest, x.rest - levels[0], high - x.rest, x.rest - low)
            half = min(least(arb(room)) for room in rooms)
            if not half > 0:
                raise LoopProofError("at rest an input of a table is at its end")
            self.bounds.append((x.parts, half, f"'{name}' of a table"))
            slopes = exact(claim.gains[name][0]), exact(claim.gains[name][1])
            # Multilinear interpolation: the slope in a cell is a mean of those along its edges.
            if not _has_slopes(values, axis, levels, *slopes):
                raise LoopProofError("a table is steeper than is claimed of it")
            words = f"a table, its slope along {name} in"
            terms.append((self._gain(x.parts, *slopes, words), ONE))
        ends = exact(float(values.min())), exact(float(values.max()))
        return LinearSignal(exact(float(values[tuple(index)])), combined(terms), *ends)

    def _claim(self) -> Gains:
        claim = next(self.gains, None)
        if claim is None:
            raise LoopProofError("there is no claim about one of its rule bases")
        return claim

    def _region(
        self, claim: Gains, inputs: Mapping[str, LinearSignal],
        rest: Mapping[str, tuple[fmpq, fmpq]], of: str,
    ) -> dict[str, tuple[fmpq, fmpq]]:  # fmt: skip
        region = {}
        for name, x in inputs.items():
            if not x.parts:
                region[name] = rest[name]
                continue
            low, high = map(exact, claim.region[name])
            above, below = high - rest[name][1], rest[name][0] - low
            half = min(above, below)
            if self.in_cone and half == 0:  # the claim is about one side of the rest only
                half = max(above, below)
                sign = ONE if below == 0 else -ONE
                self.sides.append({key: weight * sign for key, weight in x.parts.items()})
            if not half > 0:
                raise LoopProofError(f"at rest '{name}' is outside the claim about {of}")
            self.bounds.append((x.parts, half, f"'{name}' of {of}"))
            region[name] = (low, high)
        return region

    def _gain(self, parts: Parts, low: fmpq, high: fmpq, words: str) -> Parts:
        if low > high:
            raise LoopProofError("a gain that is claimed ends before it begins")
        # A gain in [low, high] is its middle plus an answer w with |w| ≤ radius |v|.
        terms: list[tuple[Parts, Number]] = [(parts, (low + high) / 2)]
        if low < high:
            half = {name: weight * (high - low) / 2 for name, weight in parts.items()}
            words = f"{words} {float(low):.6g} .. {float(high):.6g}"
            terms.append(({self.block(half, words): ONE}, ONE))
        return combined(terms)


def _exactly(end: Number) -> fmpq:
    """Return the exact end of a ball as a rational."""
    return end if isinstance(end, fmpq) else end.fmpq()


def _has_slopes(values: Any, axis: int, levels: Any, least_slope: fmpq, most: fmpq) -> bool:
    """Return whether all slopes of a table along an axis lie between two numbers."""
    lines = np.moveaxis(values, axis, -1).reshape(-1, len(levels))
    return all(
        least_slope * (levels[k + 1] - levels[k]) <= step <= most * (levels[k + 1] - levels[k])
        for line in lines
        for k, step in enumerate(exact(float(b)) - exact(float(a)) for a, b in pairwise(line))
    )


class Unchecked(LinearSignals):
    """Signals for the memory alone: arguments of rule bases and limits are recorded, not checked.

    Two walks with equal questions get equal answers; any answer will do.
    """

    def __init__(self, evidence: Evidence, surfaces: RuleSurfaces) -> None:
        super().__init__(evidence, surfaces)
        self.record: list[Any] = []

    def rules(
        self, rulebase: RuleBase, output: str, inputs: Mapping[str, LinearSignal]
    ) -> LinearSignal:
        """Record the inputs of a rule base; answer with a sum of them."""
        self.record.append(dict(inputs))
        weighed = [(x, fmpq(1 + k)) for k, x in enumerate(inputs.values())]
        total = sum((x.rest * k for x, k in weighed), ZERO)
        return LinearSignal(total, combined((x.parts, k) for x, k in weighed))

    def limit(self, x: LinearSignal, low: float, high: float) -> LinearSignal:
        """Record a limited expression."""
        self.record.append(x)
        return x

    def table(self, table: LookupTable, inputs: Mapping[str, LinearSignal]) -> LinearSignal:
        """Record the inputs of a table."""
        return self.rules(table, "", inputs)  # type: ignore[arg-type]
