"""Averages and sums of numbers, a choice among them, and where a set reaches its firing strength.

For singletons, linear and formula consequents (Takagi and Sugeno) and for monotonic sets
(Tsukamoto).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from operator import itemgetter
from typing import TYPE_CHECKING

from fuzzyarm.inference.aggregate import Figures, Fired, fold_at_point
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.sets import bisect
from fuzzyarm.symbolic.kinds import SHAPES

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.aggregate_arrays import ArrayFigures, Strengths

    Array = NDArray[np.float64]


# --- Weighted average and weighted sum of numbers: constants, linear forms, peaks of sets ---
#
# The strength of the rules that share a consequent is folded by the aggregation first, so
# `aggregation sum` adds every rule by itself (Takagi and Sugeno), `max` takes the
# strongest. The centroid of singletons is the same average.


def weighted_at_point(
    plan: OutputPlan, fired: Fired, value_of: Callable[[int, float], float]
) -> Figures | None:
    """Return average and sum, or None where no rule fired.

    `value_of` gives the number of a member at its folded strength.
    """
    total = weighted = 0.0
    for member, strength in fold_at_point(plan, fired).items():
        total += strength
        weighted += strength * value_of(member, strength)
    if not total > 0.0:
        return None
    average = weighted / total
    return {"average": average, "centroid": average, "weighted": weighted}


def weighted_over_arrays(
    plan: OutputPlan, strengths: Strengths, value_of: Callable[[int, Array], Array | float]
) -> tuple[ArrayFigures, Array]:
    """Return averages and sums, and the sums of the strengths (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.aggregate_arrays import fold_over_arrays

    total, weighted = np.zeros(strengths.shape), np.zeros(strengths.shape)
    for member, strength in fold_over_arrays(plan, list(strengths)).items():
        total += strength
        value = value_of(member, strength)
        # A consequent without a value where its rule does not fire (1/0) must not spoil the sum.
        weighted += np.where(strength > 0.0, strength * value, 0.0)
    average = np.divide(weighted, total, out=np.zeros_like(total), where=total > 0.0)
    return {"average": average, "centroid": average, "weighted": weighted}, total


# --- One of several numbers, by their strengths ---


def chosen_at_point(
    plan: OutputPlan, fired: Fired, value_of: Callable[[int, float], float]
) -> Figures | None:
    """Return where the strengths are halved or greatest, or None where no rule fired."""
    from fuzzyarm.inference.bisector import halve
    from fuzzyarm.inference.maxima import greatest_of

    folded = fold_at_point(plan, fired)
    spikes = sorted(((value_of(m, w), w) for m, w in folded.items()), key=itemgetter(0))
    if not spikes:
        return None
    samples, heights = [y for y, _ in spikes], [w for _, w in spikes]
    if plan.record.of == "top":
        return greatest_of(samples, heights)
    half = halve(samples, heights)
    return None if half is None else {"half": half}


def chosen_over_arrays(
    plan: OutputPlan, strengths: Strengths, value_of: Callable[[int, Array], Array | float]
) -> tuple[ArrayFigures, Array]:
    """Return the same of many points, and the greatest strengths (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.aggregate_arrays import fold_over_arrays
    from fuzzyarm.inference.bisector import halve_many
    from fuzzyarm.inference.maxima import greatest_of_many

    size = int(np.prod(strengths.shape))
    positions_by_name = {name: np.zeros(size) for name in plan.record.symbols}
    folded = fold_over_arrays(plan, list(strengths))
    values, heights = np.empty((len(folded), size)), np.empty((len(folded), size))
    for row, (member, strength) in enumerate(folded.items()):
        values[row] = np.broadcast_to(value_of(member, strength), strengths.shape).ravel()
        heights[row] = np.broadcast_to(strength, strengths.shape).ravel()
    order = np.argsort(values, axis=0, kind="stable")
    values, heights = np.take_along_axis(values, order, 0), np.take_along_axis(heights, order, 0)
    # The order differs from point to point only where values depend on the inputs.
    for column in range(size) if (values != values[:, :1]).any() else [slice(None)]:
        some = slice(column, column + 1) if isinstance(column, int) else column
        numbers_and_heights = values[:, some][:, 0], heights[:, some]
        if plan.record.of == "top":
            choices = greatest_of_many(plan, *numbers_and_heights)[0]
        else:
            choices = {"half": halve_many(*numbers_and_heights)[0]}
        for name, positions in choices.items():
            positions_by_name[name][some] = positions
    shaped = {
        name: positions.reshape(strengths.shape) for name, positions in positions_by_name.items()
    }
    return shaped, heights.max(axis=0).reshape(strengths.shape)


# --- The position where a monotonic set reaches the firing strength (Tsukamoto's consequents) ---


def tsukamoto_at_point(plan: OutputPlan, member: Member, strength: float) -> float:
    """Return where the set of `member` reaches `strength`; the nearest it has otherwise."""
    shape = member.term.shape
    inverse = SHAPES[shape.kind].position_of
    if inverse is not None and not member.hedges:
        position = inverse(min(1.0, strength / shape.height), *shape.parameters)
        return position if math.isfinite(position) else _end(plan, position)
    return _on_pieces(plan, member, strength)


def _end(plan: OutputPlan, position: float) -> float:
    return plan.output.high if position > 0.0 else plan.output.low


def is_rising(plan: OutputPlan, member: Member) -> bool:
    """Return whether a set rises over the range of its output; it must rise or fall."""
    values = [value for piece in member.pieces for value in (piece.y0, piece.y1)]
    steps = [b - a for a, b in pairwise(values) if abs(b - a) > 1e-12]
    if steps and (min(steps) > 0.0 or max(steps) < 0.0):
        return steps[0] > 0.0
    raise InferenceError(
        f"'{plan.output.name} is {member.term.name}' neither rises nor falls over the range,"
        " so tsukamoto cannot invert it"
    )


def _on_pieces(plan: OutputPlan, member: Member, strength: float) -> float:
    pieces = member.pieces if is_rising(plan, member) else member.pieces[::-1]
    for piece in pieces:
        start, end = (piece.x0, piece.x1) if pieces is member.pieces else (piece.x1, piece.x0)
        first, last = (piece.y0, piece.y1) if pieces is member.pieces else (piece.y1, piece.y0)
        if first >= strength:
            return start
        if last >= strength:
            if piece.straight:
                return start + (end - start) * (strength - first) / (last - first)
            return bisect(member.membership, piece.x0, piece.x1, strength)
    return plan.output.high if pieces is member.pieces else plan.output.low


def tsukamoto_over_arrays(plan: OutputPlan, member: Member, strength: Array) -> Array:
    """Return where the set of `member` reaches each strength.

    The equal strengths of a chunk are few or cheap to tell apart, and an inverse by
    bisection has no array form that is not longer than it is fast: each distinct strength
    is inverted once.
    """
    import numpy as np

    distinct, back = np.unique(strength, return_inverse=True)
    positions = [
        tsukamoto_at_point(plan, member, height) if height > 0.0 else 0.0
        for height in distinct.tolist()
    ]
    return np.array(positions)[back].reshape(strength.shape)
