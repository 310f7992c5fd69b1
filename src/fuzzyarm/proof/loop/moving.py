"""Moving references, enclosed by the search in rationals.

Except for sines they are exact at samples. Over a time h a value is within h²/8 max |r''| of the
chord between both ends, or constant before a jump.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from itertools import chain

import numpy as np

from fuzzyarm.control.loop.reference import Signal
from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.loop.enclosure import Intervals, cosine, sine
from fuzzyarm.proof.loop.outward import Ends, end_of, exact_bounds

_WAVES = {"sin": sine, "cos": cosine}


def _outward(low: Fraction, high: Fraction) -> Intervals:
    return Intervals(np.array(end_of(low, low=True)), np.array(end_of(high, low=False)))


def _wave(name: str, ends: Ends) -> Ends:
    found = _WAVES[name](_outward(*ends))
    return Fraction(float(found.low)), Fraction(float(found.high))


@lru_cache(maxsize=64)
def _bounds(signal: Signal, order: int, begin: Fraction, end: Fraction) -> Ends:
    """Return bounds of value (0), rate or acceleration over a time, by its formula."""
    roots, numbers = signal.traced
    ranges = {name: (x, x) for name, x in numbers.items()}
    return exact_bounds(roots[order], {**ranges, "t": (begin, end)}, _wave)


def sampled_references(problem: LoopProblem, period: int) -> dict[Address, Intervals]:
    """Return the moving references in a period, by their exact formula and as in ``simulate``."""
    time, found = problem.time_of(problem.held_since(period)), {}
    for address, moved in problem.moved.items():
        low, high = _bounds(moved.signal, moved.order, time, time)
        simulated = Fraction(problem.simulated(moved, period))
        found[address] = _outward(min(low, simulated), max(high, simulated))
    return found


def reference_between(
    problem: LoopProblem, address: Address, begin: Fraction, end: Fraction
) -> Intervals:
    """Return the range of a reference between two times; at one time with both sides of a jump."""
    if address not in problem.moved:
        return Intervals.at(problem.set_point[address])
    signal, order = problem.moved[address]
    times = [begin, end]
    if signal.jump == end:  # constant before the jump
        times[begin < end] = end / 2
    ends = [_bounds(signal, order, time, time) for time in times]
    h, far = end - begin, Fraction(0)
    if h:
        bend = _bounds(signal, 2, begin, end)
        far = max(map(abs, bend)) * (h * h / 8, h / 2, 0)[order]
        ends += [bend] * (order > 1)
    values = [*chain(*ends)]
    return _outward(min(values) - far, max(values) + far)
