"""Signals of a loop around its rest, as the checker reads them off the program.

A signal is its value at rest, an interval that is mostly a point, and exact weights of states z and
answers w. What it takes to be so is noted as a row that has to stay below a limit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.loop.evidence import Evidence, Gains
from fuzzyarm.proof.loop.rule_pieces import RulePieces
from fuzzyarm.proof.loop.slopes import Slope, applied
from fuzzyarm.proof.loop.spans import RationalInterval, exactly
from fuzzyarm.proof.stop import Stop
from fuzzyarm.table import LookupTable

__all__ = ["LinearSignal", "LinearSignals", "PiecesOfRules", "Unchecked", "combined", "number_line"]

NOTHING, UNIT = Fraction(0), Fraction(1)

LINEAR = ("add", "subtract", "negative", "multiply", "divide")
"""Operations of signals that move."""


class LinearSignal(NamedTuple):
    """A signal around rest: its value there, and weights of states and answers (``w0``, ``w1`` …).

    `low` and `high` are what it cannot leave, whatever they are, where that is known.
    """

    rest: RationalInterval
    parts: Mapping[str, Fraction]
    low: Fraction | None = None
    high: Fraction | None = None


def number_line(rest: RationalInterval) -> LinearSignal:
    """Return a signal that does not move."""
    return LinearSignal(rest, {}, rest.low, rest.high)


class LinearSignals:
    """Signals around rest, for a walk over the program; what is taken for granted is noted."""

    def __init__(self, evidence: Evidence, pieces: PiecesOfRules) -> None:
        # One claim for each look-up with an input that moves, in the order of the walk.
        self.gains = iter(evidence.gains)
        self.grip = evidence.grip
        self.pieces = pieces
        self.blocks: list[tuple[Mapping[str, Fraction], str]] = []
        self.bounds: list[tuple[Mapping[str, Fraction], Fraction, str]] = []

    def number(self, value: float) -> LinearSignal:
        """Return a number of the program."""
        return number_line(exactly(value))

    # --- arithmetic ---

    def apply(self, operation: str, arguments: list[LinearSignal]) -> Any:
        """Return an operation, linear in what moves; of a comparison a bool."""
        if not any(x.parts for x in arguments) and operation not in LINEAR:
            line = applied(operation, [Slope(x.rest, {}) for x in arguments])
            return line if isinstance(line, bool) else number_line(line.value)
        if operation in ("less", "less_equal", "minimum", "maximum"):
            return self._chosen(operation, *arguments)
        if operation not in LINEAR:
            raise LoopProofError(f"'{operation}' of a signal is not linear")
        return self._linear(operation, arguments)

    def _linear(self, operation: str, arguments: list[LinearSignal]) -> LinearSignal:
        if operation == "negative":
            return self._scaled(arguments[0], -UNIT)
        a, b = arguments
        if operation in ("add", "subtract"):
            if a is b and operation == "subtract":  # exactly, where it is known by an interval
                return number_line(exactly(NOTHING))
            return self._sum(a, b, UNIT if operation == "add" else -UNIT)
        if operation == "multiply":
            return self._times(a, b) if not b.parts else self._times(b, a)
        return self._times(a, number_line(exactly(UNIT).over(b.rest)), by=b)

    def _chosen(self, operation: str, a: LinearSignal, b: LinearSignal) -> Any:
        """Return a comparison, or the smaller or larger of two, as it is at rest."""
        if operation in ("less", "less_equal"):
            return self._is_less(a, b, or_equal=operation == "less_equal")
        # The one that counts at rest, as long as a row keeps the two in this order.
        return a if self._is_less(a, b, or_equal=True) == (operation == "minimum") else b

    def _sum(self, a: LinearSignal, b: LinearSignal, factor: Fraction) -> LinearSignal:
        parts = dict(a.parts)
        for name, weight in b.parts.items():
            total = parts.pop(name, NOTHING) + factor * weight
            if total:
                parts[name] = total
        ends = (b.low, b.high) if factor > 0 else (b.high, b.low)
        low, high = (
            None if x is None or y is None else x + factor * y
            for x, y in zip((a.low, a.high), ends, strict=True)
        )
        other = b.rest.times(exactly(factor))
        return LinearSignal(a.rest.plus(other), parts, low, high)

    def _scaled(self, a: LinearSignal, factor: Fraction) -> LinearSignal:
        if not factor:
            return number_line(exactly(NOTHING))
        ends = (a.low, a.high) if factor > 0 else (a.high, a.low)
        low, high = (None if end is None else end * factor for end in ends)
        parts = {name: weight * factor for name, weight in a.parts.items()}
        return LinearSignal(a.rest.times(exactly(factor)), parts, low, high)

    def _times(
        self, a: LinearSignal, factor: LinearSignal, by: LinearSignal | None = None
    ) -> LinearSignal:
        if factor.parts or (by is not None and by.parts):
            raise LoopProofError("two signals are multiplied, or one is divided by another")
        if factor.rest.is_point:
            return self._scaled(a, factor.rest.low)
        if a.parts:
            raise LoopProofError("a signal is multiplied by an inexact value")
        return number_line(a.rest.times(factor.rest))

    def _is_less(self, a: LinearSignal, b: LinearSignal, *, or_equal: bool) -> bool:
        """Tell whether a is below b at rest; it has to stay so."""
        way = self._sum(b, a, -UNIT)
        if not way.parts:
            if way.rest.low > 0 or (or_equal and way.rest.low >= 0):
                return True
            if way.rest.high < 0 or (not or_equal and way.rest.high <= 0):
                return False
            raise LoopProofError("a choice is open at rest")
        room = way.rest.low if way.rest.low > 0 else -way.rest.high
        if room <= 0:
            raise LoopProofError("at rest two signals are equal, of which the greater one counts")
        self.bounds.append((way.parts, room, "a choice"))
        return way.rest.low > 0

    # --- limits ---

    def limit(self, x: LinearSignal, low: float, high: float) -> LinearSignal:
        """Return ``min(max(x, low), high)``, or what is left of it at least."""
        lowest = None if math.isinf(low) else Fraction(low)
        highest = None if math.isinf(high) else Fraction(high)
        above = lowest is None or (x.low is not None and lowest <= x.low)
        below = highest is None or (x.high is not None and x.high <= highest)
        if above and below:
            return x
        if not x.parts:
            span = x.rest
            if lowest is not None:
                span = RationalInterval(max(span.low, lowest), max(span.high, lowest))
            if highest is not None:
                span = RationalInterval(min(span.low, highest), min(span.high, highest))
            return number_line(span)
        words = f"a limit, {low:g} .. {high:g}"
        rooms, share = [], UNIT
        for end, most, at, sign in (
            (lowest, x.low, x.rest.low, -1),
            (highest, x.high, x.rest.high, 1),
        ):
            if end is None:
                continue
            room = sign * (end - at)
            if room <= 0:
                raise LoopProofError(f"at rest a signal is at {words}")
            rooms.append(room)
            # What is cut off is still this share of the deviation, wherever the signal can go.
            far = None if most is None else sign * (most - at)
            share = min(share, NOTHING if far is None else room / far if far > room else UNIT)
        # Where the limit may pass too small a share, the signal has to stay so close to rest that
        # `grip` of it passes, and a row says so.
        if share < self.grip:
            share = self.grip
            self.bounds.append((x.parts, min(rooms) / share, words))
        if share == UNIT:
            return x
        # The limit turns a deviation v into something between share · v and v: the middle, and an
        # answer for half the width.
        middle = {name: weight * (UNIT + share) / 2 for name, weight in x.parts.items()}
        answer = self.block(
            {name: weight * (UNIT - share) / 2 for name, weight in x.parts.items()}, words
        )
        return LinearSignal(x.rest, {**middle, answer: UNIT}, lowest, highest)

    def block(self, v: Mapping[str, Fraction], words: str) -> str:
        """Add an unknown gain; return the name of its answer."""
        self.blocks.append((v, words))
        return f"w{len(self.blocks) - 1}"

    # --- rule bases and tables ---

    def rules(
        self, sheet: RuleBase, output: str, inputs: Mapping[str, LinearSignal]
    ) -> LinearSignal:
        """Return what a rule base concludes, by what is claimed of it."""
        if not any(x.parts for x in inputs.values()):
            region = {name: (x.rest.low, x.rest.high) for name, x in inputs.items()}
            return number_line(self.pieces(sheet, output).value(region))
        claim = self._claim()
        pieces = self.pieces(sheet, output)
        region = self._region(claim, inputs, sheet.name)
        if not pieces.has_range(region, *claim.between):
            raise LoopProofError(f"'{sheet.name}' leaves the range that is claimed of it")
        value = pieces.value({name: (x.rest.low, x.rest.high) for name, x in inputs.items()})
        if claim.weights:
            if any(inputs[name].rest != exactly(NOTHING) for name in claim.weights):
                raise LoopProofError("a sector is of inputs that rest at 0")
            # The gain along the weighted sum has the empty name.
            low, high = claim.gains[""]
            if not pieces.has_sector(region, claim.weights, low, high):
                raise LoopProofError(f"'{sheet.name}' leaves the sector that is claimed of it")
            parts = self._gain(
                combined([(inputs[n].parts, w) for n, w in claim.weights.items()]), low, high,
                f"{sheet.name}, a gain in",
            )  # fmt: skip
            return LinearSignal(exactly(NOTHING), parts, *claim.between)
        terms = []
        for name, x in inputs.items():
            if x.parts:
                low, high = claim.gains[name]
                if not pieces.has_slope(region, name, low, high):
                    raise LoopProofError(f"'{sheet.name}' is steeper than is claimed of it")
                words = f"{sheet.name}, its slope along {name} in"
                terms.append((self._gain(x.parts, low, high, words), UNIT))
        return LinearSignal(value, combined(terms), *claim.between)

    def table(self, sheet: LookupTable, inputs: Mapping[str, LinearSignal]) -> LinearSignal:
        """Return what a table says, by what is claimed of it."""
        if sheet.default_mode != "linear":
            raise LoopProofError("a table with steps jumps")
        claim = self._claim() if any(x.parts for x in inputs.values()) else None
        values = np.asarray(sheet.values, float)
        index, terms = [], []
        for axis, (name, x) in enumerate(inputs.items()):
            levels = [Fraction(float(level)) for level in sheet.axes[axis].levels]
            if not x.rest.is_point or x.rest.low not in levels:
                raise LoopProofError("at rest an input of a table is between two levels")
            index.append(levels.index(x.rest.low))
            if not x.parts:
                continue
            assert claim is not None
            # Beyond its outer levels a table is constant, and its steps say nothing.
            room = min(levels[-1] - x.rest.low, x.rest.low - levels[0])
            low, high = claim.region[name]
            half = min(high - x.rest.low, x.rest.low - low, room)
            if half <= 0:
                raise LoopProofError("at rest an input of a table is at its end")
            self.bounds.append((x.parts, half, f"'{name}' of a table"))
            least, most = claim.gains[name]
            # Multilinear interpolation: the slope in a cell is a mean of those along its edges.
            if not _has_slopes(values, axis, levels, least, most):
                raise LoopProofError("a table is steeper than is claimed of it")
            words = f"a table, its slope along {name} in"
            terms.append((self._gain(x.parts, least, most, words), UNIT))
        rest = exactly(float(values[tuple(index)]))
        ends = Fraction(float(values.min())), Fraction(float(values.max()))
        return LinearSignal(rest, combined(terms), *ends)

    def _claim(self) -> Gains:
        claim = next(self.gains, None)
        if claim is None:
            raise LoopProofError("there is no claim about one of its rule bases")
        return claim

    def _region(
        self, claim: Gains, inputs: Mapping[str, LinearSignal], of: str
    ) -> dict[str, tuple[Fraction, Fraction]]:
        region = {}
        for name, x in inputs.items():
            if not x.parts:
                region[name] = (x.rest.low, x.rest.high)
                continue
            low, high = claim.region[name]
            half = min(high - x.rest.high, x.rest.low - low)
            if half <= 0:
                raise LoopProofError(f"at rest '{name}' is outside the claim about {of}")
            self.bounds.append((x.parts, half, f"'{name}' of {of}"))
            region[name] = (low, high)
        return region

    def _gain(
        self, parts: Mapping[str, Fraction], low: Fraction, high: Fraction, words: str
    ) -> Mapping[str, Fraction]:
        if low > high:
            raise LoopProofError("a gain that is claimed ends before it begins")
        # A gain in [low, high] is its middle plus an answer w with |w| ≤ radius |v|.
        terms = [(parts, (low + high) / 2)]
        if low < high:
            radius = {name: weight * (high - low) / 2 for name, weight in parts.items()}
            words = f"{words} {float(low):.6g} .. {float(high):.6g}"
            terms.append(({self.block(radius, words): UNIT}, UNIT))
        return combined(terms)


def combined(terms: Sequence[tuple[Mapping[str, Fraction], Fraction]]) -> dict[str, Fraction]:
    """Return Σ factor · weights."""
    total: dict[str, Fraction] = {}
    for parts, factor in terms:
        for name, weight in parts.items():
            total[name] = total.get(name, NOTHING) + factor * weight
    return {name: weight for name, weight in total.items() if weight}


def _has_slopes(
    values: Any, axis: int, levels: Sequence[Fraction], least: Fraction, most: Fraction
) -> bool:
    """Tell whether all steps of a table along an axis are between two slopes."""
    lines = np.moveaxis(values, axis, -1).reshape(-1, len(levels))
    return all(
        least * (levels[k + 1] - levels[k]) <= step <= most * (levels[k + 1] - levels[k])
        for line in lines
        for k, step in enumerate(Fraction(float(b)) - Fraction(float(a)) for a, b in pairwise(line))
    )


class PiecesOfRules:
    """The pieces of the rule bases of a loop, cut once; TimeOverError when time is over."""

    def __init__(self, stop: Stop | None = None) -> None:
        self.stop = stop
        self._pieces_by_output: dict[tuple[int, str], RulePieces] = {}

    def __call__(self, sheet: RuleBase, output: str) -> RulePieces:
        """Return those of an output."""
        key = id(sheet), output
        if key not in self._pieces_by_output:
            self._pieces_by_output[key] = RulePieces(sheet, output, self.stop)
        return self._pieces_by_output[key]


class Unchecked(LinearSignals):
    """Lines that lead to what is remembered: what rule bases and limits are asked is noted.

    Where both of two walks ask the same, they are answered the same: any answer will do.
    """

    def __init__(self, evidence: Evidence, pieces: PiecesOfRules) -> None:
        super().__init__(evidence, pieces)
        self.record: list[Any] = []

    def rules(
        self, sheet: RuleBase, output: str, inputs: Mapping[str, LinearSignal]
    ) -> LinearSignal:
        """Return what a rule base concludes, by what is claimed of it."""
        self.record.append(dict(inputs))
        terms = [(x.parts, Fraction(1 + k)) for k, x in enumerate(inputs.values())]
        total = exactly(NOTHING)
        for k, x in enumerate(inputs.values()):
            total = total.plus(x.rest.times(exactly(Fraction(1 + k))))
        return LinearSignal(total, combined(terms))

    def limit(self, x: LinearSignal, low: float, high: float) -> LinearSignal:
        """Return ``min(max(x, low), high)``, or what is left of it at least."""
        self.record.append(x)
        return x

    def table(self, sheet: LookupTable, inputs: Mapping[str, LinearSignal]) -> LinearSignal:
        """Return what a table says, by what is claimed of it."""
        return self.rules(sheet, "", inputs)  # type: ignore[arg-type]
