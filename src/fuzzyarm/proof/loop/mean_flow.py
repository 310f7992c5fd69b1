"""The motion of a set over a period, by the mean value theorem.

With φ(c) the end of the solution from the centre c, and Φ the slopes of φ over the set,

    x(h) = φ(c) + Φ (x₀ − c),   inputs among the coordinates.

φ and Φ are those of :mod:`fuzzyarm.proof.check.motion`, over intervals alone, and the symbols of a
set are multiplied once; :class:`fuzzyarm.proof.loop.flow.Flow` carries them through a series, which
takes several times as long.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fuzzyarm.proof.check.motion import (
    around_motion,
    end_of_motion,
    flow_over,
    jacobian_of,
    parameters_of,
)
from fuzzyarm.proof.check.numbers import Number, exact, precisely
from fuzzyarm.proof.check.spans import Spans
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.loop.zonotope import ENLARGED, ROUNDING, TINY, Forms, joined, stacked

STEPS = 1
"""Steps of the motion from the centre. The checker's four narrow its end, but the slopes dominate
the width of a set."""


class MeanFlow:
    """The plant of a loop over its control period.

    Parameters
    ----------
    problem : LoopProblem
        The loop; its plant's equations are time-invariant.
    """

    def __init__(self, problem: LoopProblem) -> None:
        self.problem = problem
        self.parameters = parameters_of(problem)

    @precisely
    def ends(self, states: Forms, inputs: Forms) -> Forms:
        """Return the states one period later, unbounded if no enclosure is found.

        LoopProofError: the equations have an operation without slopes in the checker.
        """
        equations = self.problem.equations
        names = (*equations.states, *equations.inputs)
        whole = joined(states, inputs)
        bounds = whole.bounds
        ranges = [Spans(low, high) for low, high in zip(bounds.low, bounds.high, strict=True)]
        moving = around_motion(self.problem, self._at(names, ranges))
        flow = flow_over(jacobian_of(self.problem, moving), exact(self.problem.period))
        middles = [Spans(x, x) for x in whole.centre]
        ends = end_of_motion(self.problem, self._at(names, middles), STEPS)
        return stacked(
            [_ended(whole, row, Spans.of(end)) for row, end in zip(flow, ends, strict=True)]
        )

    def _at(self, names: Sequence[str], values: Sequence[Spans]) -> dict[str, Any]:
        return {**self.parameters, **dict(zip(names, values, strict=True))}


def _ended(whole: Forms, slopes: Sequence[Number], end: Spans) -> Forms:
    """Return the ends of the centres plus slopes times deviations."""
    spans = [Spans.of(slope) for slope in slopes]
    near = np.stack([np.broadcast_to(x.mid().low, end.low.shape) for x in spans])
    off = np.stack([np.broadcast_to(x.rad().low, end.low.shape) for x in spans])
    parts = (whole.parts * near).sum(axis=1)
    size = (np.abs(near) * whole.radius).sum(axis=0)
    rest = (np.abs(near) * whole.rest + off * whole.radius).sum(axis=0)
    rest = rest + end.rad().low + (len(spans) + 2) * ROUNDING * size + TINY
    known = np.isfinite(rest) & np.isfinite(end.mid().low)
    return Forms(
        np.where(known, end.mid().low, 0.0), np.where(known, parts, 0.0),
        np.where(known, rest * ENLARGED, np.inf),
    )  # fmt: skip
