"""Enclosures of the plant's motion over a control period, with its inputs held."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from flint import arb, fmpq

from fuzzyarm.proof.check.numbers import (
    ONE,
    ZERO,
    Matrix,
    Number,
    around,
    ball,
    between,
    exact,
    float_above,
    greatest,
    holds,
    identity,
    is_same,
    least,
    product,
)
from fuzzyarm.proof.check.slopes import Slope, slopes_of
from fuzzyarm.proof.check.spans import Matrices, Spans
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError

FAR = exact(1e308)
"""Half-width of the box that stands for all states: a plant affine on it counts as affine."""

SMALL, LESS = 2.0**-120, 2.0**-60
"""Bounds of the truncated terms of a motion's series: for one motion, and for many at once."""

SHORT = 12
"""Largest norm of h J for a single series; a longer motion is halved."""

STEPS = 4
"""Second-order steps in a period, for a motion from one point."""

MOST_HALVINGS = 14
"""Most halvings of a period."""


def parameters_of(problem: LoopProblem) -> dict[str, Number]:
    """Return the plant's parameters by symbol."""
    spans = zip(problem.equations.parameters, problem.parameters.values(), strict=True)
    return {key: between(exact(span.low), exact(span.high)) for key, span in spans}


def jacobian_of(problem: LoopProblem, ranges: Mapping[str, Number]) -> Matrix:
    """Return the Jacobian of the plant's rates by states and inputs, over their ranges."""
    equations = problem.equations
    variables = (*equations.states, *equations.inputs)
    one = fmpq(1)
    values = {k: Slope(x, {k: one} if k in variables else {}) for k, x in ranges.items()}
    rates = slopes_of(equations.rates, values)
    return [[rate.along.get(key, ZERO) for key in variables] for rate in rates]


def is_affine(problem: LoopProblem, jacobian: Matrix) -> bool:
    """Return whether a Jacobian over a box is the one everywhere."""
    equations, far = problem.equations, between(-FAR, FAR)
    ranges = parameters_of(problem) | dict.fromkeys((*equations.states, *equations.inputs), far)
    try:
        return is_same(jacobian, jacobian_of(problem, ranges))
    except LoopProofError:  # no value somewhere
        return False


def flow_over(jacobian: Sequence[Sequence[Number]], h: Number) -> Matrix:
    """Return 1 + ∫J + ∬J J + … over a time (Peano–Baker): the k-th term lies in hᵏ/k! Jᵏ.

    J may vary in time within its intervals; for a constant J this is its matrix exponential.
    """
    count, size = len(jacobian), len(jacobian[0])
    step = [[ball(x) * h for x in row] for row in jacobian]
    step += [[arb(0)] * size for _ in range(size - count)]
    if any(isinstance(x, Spans) for row in step for x in row):
        return _flows(step)[:count]
    norm = max(float_above(sum((x.abs_upper() for x in row), arb(0))) for row in step)
    halvings, last, tail = _terms(norm, SMALL)
    step = [[x / 2**halvings for x in row] for row in step]
    total: Matrix = identity(size)
    term = total
    for k in range(1, last + 1):
        term = [[x / k for x in row] for row in product(term, step)]
        total = [[x + y for x, y in zip(a, b, strict=True)]
                 for a, b in zip(total, term, strict=True)]  # fmt: skip
    total = [[around(x, tail) for x in row] for row in total]
    for _ in range(halvings):
        total = product(total, total)
    return total[:count]


def _terms(norm: float, small: float) -> tuple[int, int, Number]:
    """Return the halvings of a period, the last power, and a bound of the truncated terms."""
    norm *= 1.0 + 1e-9
    # Over halves of a period, one after another: the flow over both is their product.
    halvings = max(0, math.ceil(norm / SHORT) - 1).bit_length() if math.isfinite(norm) else 99
    if halvings > MOST_HALVINGS:
        raise LoopProofError("a period is long compared with the plant's motion")
    norm /= 2**halvings
    last = 4 * math.ceil(norm)  # from here on each term is less than half of the one before
    while arb(norm) ** (last + 1) * 2 > math.factorial(last + 1) * arb(small):
        last += 1
    return halvings, last, arb(norm) ** (last + 1) * 2 / math.factorial(last + 1)


def _flows(step: Matrix) -> Matrix:
    """Return the same sum for many motions at once, grouped by their norms, rounded up."""
    way = Matrices.of(step)
    norms = ((np.abs(way.near) + way.far).sum(axis=-1).max(axis=-1) * (1.0 + 1e-9)).ravel()
    norms = np.exp2(np.ceil(np.log2(np.maximum(norms, 2.0**-6)))) * (1.0 + 1e-9)
    total = Matrices(np.full_like(way.near, np.nan), np.full_like(way.far, np.nan))
    for norm in np.unique(norms[norms < SHORT * 2.0**MOST_HALVINGS]):  # others stay unknown
        which = (norms == norm).reshape(way.near.shape[:-2])
        found = _flows_of(Matrices(way.near[which], way.far[which]), *_terms(float(norm), LESS))
        total.near[which], total.far[which] = found.near, found.far
    return total.rows


def _flows_of(way: Matrices, halvings: int, last: int, tail: Number) -> Matrices:
    size = way.near.shape[-1]
    total = term = Matrices(np.eye(size), np.zeros((size, size)))
    way = way.divided(2**halvings)
    for k in range(1, last + 1):
        term = (term @ way).divided(k)
        total = total + term
    total = Matrices(total.near, total.far * (1.0 + 1e-12) + float_above(tail))
    for _ in range(halvings):
        total = total @ total
    return total


def around_motion(
    problem: LoopProblem, ranges: Mapping[str, Number], time: Number | None = None
) -> dict[str, Number]:
    """Return an a-priori enclosure: a box that no motion from `ranges` leaves within a time.

    Of many boxes: NaN for those without one.
    """
    equations = problem.equations
    h = exact(problem.period) if time is None else time

    def moved(box: Mapping[str, Number]) -> dict[str, Number]:
        rates = slopes_of(equations.rates, {key: Slope(x, {}) for key, x in box.items()})
        after = {
            # x + t f lies between x and x + h f.
            key: between(ball(ranges[key]), ranges[key] + h * rate.value)
            for key, rate in zip(equations.states, rates, strict=True)
        }
        return {**box, **after}

    wide = dict(ranges)
    stay: Any = None
    for count in range(20):
        box = moved(wide)
        # Picard's operator maps `wide` into itself, so no motion leaves its image.
        if count and all(holds(wide[key], box[key]) for key in equations.states):
            return moved(box) if stay is None else box
        stay = _enclosed(wide, box, equations.states)
        if stay is not None and (stay | _is_unknown(box, equations.states)).all():
            break
        for key in equations.states:
            # Wider by a share of the motion itself: narrow states beside wide ones, too.
            added = _width(box[key]) - _width(ranges[key])
            wider = around(box[key], added / 4 + fmpq(1, 10**12))
            wide[key] = wider if stay is None else Spans.of(wide[key]).chosen(stay, wider)
    if stay is None:
        raise LoopProofError("the motion within a period was not enclosed")
    nothing = Spans(np.nan, np.nan)
    return {**box, **{key: Spans.of(box[key]).chosen(stay, nothing) for key in equations.states}}


def end_of_motion(
    problem: LoopProblem, ranges: Mapping[str, Number], steps: int = STEPS
) -> list[Number]:
    """Return the end of a motion from one point after a period, by steps x + h f + ½ h² f' f."""
    equations = problem.equations
    h = exact(problem.period) / steps
    at = [ranges[key] for key in equations.states]
    for _ in range(steps):
        here = {**ranges, **dict(zip(equations.states, at, strict=True))}
        over = slopes_of(equations.rates, {
            k: Slope(s, {k: ONE} if k in equations.states else {})
            for k, s in around_motion(problem, here, h).items()
        })  # fmt: skip
        begin = slopes_of(equations.rates, {k: Slope(s, {}) for k, s in here.items()})
        # x'' = f'(x) f(x), over the box: the remainder of second order in Lagrange's form.
        bends = product([[s.along.get(k, ZERO) for k in equations.states] for s in over],
                        [[s.value] for s in over])  # fmt: skip
        at = [
            a + rate.value * h + bend[0] * (h * h / 2)
            for a, rate, bend in zip(at, begin, bends, strict=True)
        ]
    return at


def _enclosed(wide: Mapping[str, Number], box: Mapping[str, Number], keys: Sequence[str]) -> Any:
    """Return which of many boxes are enclosed already; None for a single one."""
    if not any(isinstance(box[key], Spans) for key in keys):
        return None
    pairs = [(Spans.of(wide[key]), Spans.of(box[key])) for key in keys]
    return np.logical_and.reduce(
        np.broadcast_arrays(*((a.low <= b.low) & (b.high <= a.high) for a, b in pairs))
    )


def _is_unknown(box: Mapping[str, Number], keys: Sequence[str]) -> Any:
    """Return which of many boxes have no bounds."""
    spans = [Spans.of(box[key]) for key in keys]
    return ~np.logical_and.reduce(
        np.broadcast_arrays(*(np.isfinite(x.low) & np.isfinite(x.high) for x in spans))
    )


def _width(x: Number) -> Number:
    return greatest(x) - least(x)


def output_between_samples(
    problem: LoopProblem, states: Mapping[str, Number], output: str
) -> Number:
    """Return the range of an output between two samples."""
    equations, interface = problem.equations, problem.site.interface
    ranges = parameters_of(problem)
    for key, name in zip(equations.states, problem.states, strict=True):
        ranges[key] = states[name]
    for key, port in zip(equations.inputs, interface.inputs.values(), strict=True):
        if math.isinf(port.high - port.low):
            raise LoopProofError("an input of the plant has no bound")
        ranges[key] = between(exact(port.low), exact(port.high))
    moving = around_motion(problem, ranges)
    root = equations.outputs[list(interface.outputs).index(interface.port(output))]
    return slopes_of([root], {key: Slope(x, {}) for key, x in moving.items()})[0].value
