"""The plant over a control period, its inputs held: enclosed in rationals, for the checker."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction

from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.loop.slopes import Slope, slopes_of
from fuzzyarm.proof.loop.spans import RationalInterval, exactly, hull
from fuzzyarm.proof.stop import check_time

__all__ = ["around_motion", "dot", "flow_over", "output_between_samples"]

NOTHING = Fraction(0)


def dot(row: Sequence[RationalInterval], column: Sequence[RationalInterval]) -> RationalInterval:
    """Return a sum of products."""
    check_time()
    total = exactly(NOTHING)
    for x, y in zip(row, column, strict=True):
        if x.low or x.high:
            total = total.plus(x.times(y))
    return total


LAST = 16
"""The highest power of the series of a motion at least."""

SHORT = 12
"""The norm up to which a motion is one series."""

MOST_HALVINGS = 14
"""How often a period is halved for that."""


def flow_over(
    jacobian: Sequence[Sequence[RationalInterval]], h: RationalInterval
) -> list[list[RationalInterval]]:
    """Return 1 + ∫J + ∬J J + … over a period: the k-th term lies in hᵏ/k! Jᵏ.

    Whatever J does within its intervals; where J is constant this is its matrix exponential.
    """
    count, size = len(jacobian), len(jacobian[0])
    zero = exactly(NOTHING)
    step = [[x.times(h) for x in row] for row in jacobian]
    step += [[zero] * size for _ in range(size - count)]
    norm = max(sum((x.size for x in row), NOTHING) for row in step)
    # Over halves of a period, one after another: the flow over both is their product.
    halvings = max(0, math.ceil(norm / SHORT) - 1).bit_length()
    if halvings > MOST_HALVINGS:
        raise LoopProofError("a period is long compared with the plant's motion")
    norm /= 2**halvings
    part = exactly(Fraction(1, 2**halvings))
    step = [[x.times(part) for x in row] for row in step]
    last = LAST + 4 * math.ceil(norm)
    total = [[exactly(Fraction(int(i == j))) for j in range(size)] for i in range(size)]
    term = total
    for k in range(1, last + 1):
        share = exactly(Fraction(1, k))
        columns = list(zip(*step, strict=True))
        term = [[dot(row, column).times(share) for column in columns] for row in term]
        total = [[x.plus(y) for x, y in zip(a, b, strict=True)]
                 for a, b in zip(total, term, strict=True)]  # fmt: skip
    # Terms fall by more than half from here on.
    tail = 2 * norm ** (last + 1) / math.factorial(last + 1)
    around = RationalInterval(-tail, tail)
    total = [[x.plus(around) for x in row] for row in total]
    for _ in range(halvings):
        columns = list(zip(*total, strict=True))
        total = [[dot(row, column) for column in columns] for row in total]
    return total[:count]


def around_motion(
    problem: LoopProblem, ranges: Mapping[str, RationalInterval], time: Fraction | None = None
) -> dict[str, RationalInterval]:
    """Return a box that no motion which begins in the given one leaves in a period, or a time."""
    equations = problem.equations
    whole = RationalInterval(NOTHING, Fraction(problem.period) if time is None else time)

    def moved(box: Mapping[str, RationalInterval]) -> dict[str, RationalInterval]:
        rates = slopes_of(equations.rates, {key: Slope(span, {}) for key, span in box.items()})
        after = {
            key: ranges[key].plus(whole.times(rate.value))
            for key, rate in zip(equations.states, rates, strict=True)
        }
        return {**box, **after}

    wide = dict(ranges)
    for _ in range(20):
        box = moved(wide)
        if all(wide[key].holds(box[key]) for key in equations.states):
            # Picard's operator takes `wide` into itself, so no motion leaves what it makes of it.
            return moved(box)
        for key in equations.states:
            both = hull(wide[key], box[key])
            more = both.radius / 100 + Fraction(1, 10**12)
            wide[key] = RationalInterval(both.low - more, both.high + more)
    raise LoopProofError("the motion within a period was not enclosed")


def output_between_samples(
    problem: LoopProblem, around: Mapping[str, RationalInterval], output: str
) -> RationalInterval:
    """Return where an output can be from one sample to the next."""
    equations, interface = problem.equations, problem.site.interface
    ranges = {
        key: RationalInterval(Fraction(span.low), Fraction(span.high))
        for key, span in zip(equations.parameters, problem.parameters.values(), strict=True)
    }
    for key, name in zip(equations.states, problem.states, strict=True):
        ranges[key] = around[name]
    for key, port in zip(equations.inputs, interface.inputs.values(), strict=True):
        if math.isinf(port.high - port.low):
            raise LoopProofError("an input of the plant has no bound")
        ranges[key] = RationalInterval(Fraction(port.low), Fraction(port.high))
    moving = around_motion(problem, ranges)
    root = equations.outputs[list(interface.outputs).index(interface.port(output))]
    values = {key: Slope(span, {}) for key, span in moving.items()}
    return slopes_of([root], values)[0].value
