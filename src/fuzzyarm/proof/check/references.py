"""Moving references, enclosed by the checker: its own reading of their formulas.

At a rational time a value is rational, or a ball if its formula has a sine. Over a time h it is
within h²/8 max |r''| of the chord between both ends, or constant before a jump.
"""

from __future__ import annotations

from fuzzyarm.control.loop.reference import Signal
from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.check.numbers import Number, around, between, exact, hull, magnitude
from fuzzyarm.proof.check.slopes import Slope, slopes_of
from fuzzyarm.proof.claim.problem import LoopProblem


def _value(signal: Signal, order: int, time: Number) -> Number:
    """Return the value (0), rate or acceleration at a time, or over all times of a ball."""
    roots, numbers = signal.traced
    values = {name: Slope(exact(x), {}) for name, x in numbers.items()}
    return slopes_of([roots[order]], {"t": Slope(time, {}), **values})[0].value


def sampled_references(problem: LoopProblem, period: int) -> dict[Address, Number]:
    """Return the moving references in a period, by their exact formula and as in ``simulate``."""
    time = exact(problem.time_of(problem.held_since(period)))
    return {
        address: hull(
            _value(moved.signal, moved.order, time), exact(problem.simulated(moved, period))
        )
        for address, moved in problem.moved.items()
    }


def reference_between(problem: LoopProblem, address: Address, period: int) -> Number:
    """Return the range of a reference between two samples, and its value held since before."""
    if address not in problem.moved:
        return exact(problem.set_point[address])
    way = _way_between(problem, address, period)
    if problem.held_since(period) == period:
        return way
    return hull(way, sampled_references(problem, period)[address])


def _way_between(problem: LoopProblem, address: Address, period: int) -> Number:
    """Return the range of a reference between two samples, by its formula."""
    signal, order = problem.moved[address]
    begin, end = problem.time_of(period), problem.time_of(period + 1)
    # Constant up to a jump at the end.
    times = [begin] if signal.jump == end else [begin, end]
    ends = [_value(signal, order, exact(time)) for time in times]
    bend = _value(signal, 2, between(exact(begin), exact(end)))
    if order > 1:
        return hull(*ends, bend)
    h = exact(end - begin)
    return around(hull(*ends), magnitude(bend) * (h / 2 if order else h * h / 8))
