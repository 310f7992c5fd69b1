"""Find the smallest even grid whose linear interpolation meets a tolerance.

Every number of levels is tried in turn, because the error does not fall evenly: a grid
whose levels meet the kinks of the surface beats larger ones. Trying is cheap: the
interpolation is first computed at a few thousand probes only, and each probe that proved
an earlier grid wrong is asked again first.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.lut.axis import TableError
from fuzzyarm.lut.compiler import choose_output, compile_table, even_levels
from fuzzyarm.lut.fidelity import measure_fidelity
from fuzzyarm.rulebase.model import RuleBase

LIMITS = {1: 20_001, 2: 1_001, 3: 101, 4: 33}
"""Most levels that are tried for each input, by the number of inputs; 17 for more."""

_PROBES = 2_048


def smallest_even_grid(
    rulebase: RuleBase,
    output: str | None,
    tolerance: float,
    *,
    progress: Callable[[str], None] | None = None,
) -> int:
    """Return the fewest levels (the same number for every input) that meet `tolerance`.

    The result is proved with :func:`fuzzyarm.lut.measure_fidelity`.

    Raises
    ------
    TableError
        If the tolerance is no positive number, or no grid within `LIMITS` meets it.
    """
    if not (tolerance > 0 and math.isfinite(tolerance)):
        raise TableError(f"a tolerance is a positive number, not {tolerance:g}")
    target = choose_output(rulebase, output)
    limit = LIMITS.get(len(rulebase.inputs), 17)
    probes = _Probes(rulebase, target.name)
    best = math.inf
    for count in range(2, limit + 1):
        if progress is not None:
            progress(f"trying {count} levels")
        worst = probes.worst(count, tolerance)
        if worst <= tolerance:
            table = compile_table(rulebase, target.name, levels=count, rounding=0.0)
            proof = measure_fidelity(table, rulebase, ("linear",))[0]
            worst = proof.worst
            if worst <= tolerance:
                return count
            probes.remember([x for _, x in proof.at])
        best = min(best, worst)
    raise TableError(
        f"no even grid of up to {limit} levels for each input meets {tolerance:g}; "
        f"the best differs by {best:.4g}",
        hint="the surface may have a jump, which no interpolation can follow",
    )


class _Probes:
    """Points at which a grid is tried before it is built."""

    def __init__(self, rulebase: RuleBase, output: str) -> None:
        self.rulebase = rulebase
        self.output = output
        self.names = [variable.name for variable in rulebase.inputs]
        ends = [even_levels(variable, 2) for variable in rulebase.inputs]
        self.low = np.array([low for low, _ in ends])
        self.high = np.array([high for _, high in ends])
        spread = np.random.default_rng(1).random((_PROBES, len(ends)))
        self.points = self.low + spread * (self.high - self.low)
        self.truth = self._infer(self.points.T)

    def remember(self, point: list[float]) -> None:
        """Put a point that proved a grid wrong in front of the others."""
        self.points = np.vstack([point, self.points])
        self.truth = self._infer(self.points.T)

    def worst(self, count: int, tolerance: float) -> float:
        """Return the worst difference of a grid of `count` levels; stop at the first part over."""
        worst = 0.0
        for part in (slice(0, 64), slice(64, None)):
            value = self._interpolate(self.points[part], count)
            worst = max(worst, float(np.max(np.abs(value - self.truth[part]), initial=0.0)))
            if worst > tolerance:
                break
        return worst

    def _interpolate(self, points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
        """Return the interpolation at `points` from the corners of their cells alone."""
        steps = (points - self.low) / (self.high - self.low) * (count - 1)
        lower = np.clip(np.floor(steps), 0, count - 2)
        share = steps - lower
        corners = np.array(list(product((0, 1), repeat=points.shape[1])))
        index = lower[None] + corners[:, None]
        levels = self.low + index * ((self.high - self.low) / (count - 1))
        weight = np.where(corners[:, None] == 1, share[None], 1.0 - share[None]).prod(axis=2)
        values = self._infer(np.moveaxis(levels, 2, 0))
        return np.asarray((weight * values).sum(axis=0))

    def _infer(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        from fuzzyarm.inference import infer

        inputs: dict[str, float | NDArray[np.float64]] = dict(zip(self.names, columns, strict=True))
        return np.asarray(infer(self.rulebase, inputs)[self.output], dtype=np.float64)
