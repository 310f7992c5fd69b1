"""Many runs of one row, each disturbed in the last bit: what of it is chance.

Control that switches between cells of a table is chaotic in single precision: a
difference in the last bit at every step spreads its figures over a band.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.arm.conventions import Conventions
from fuzzyarm.arm.trajectory import Trajectory
from fuzzyarm.control.batch import Batch, simulate_batch
from fuzzyarm.control.controller import Controller
from fuzzyarm.control.run import Options
from fuzzyarm.study.published import MAXIMUM_ON, RMS_PLACES, Eight

LAST_BIT = 6e-8
"""Relative size of the last bit of a number in single precision."""

RUNS = 200
"""In an ensemble, unless another number is asked for."""


@dataclass(frozen=True)
class Ensemble:
    """Where the eight figures of a row lie.

    Attributes
    ----------
    runs : int
        How many.
    median, band_low, band_high : tuple of float
        Of each figure; the band leaves out 5 % on either side.
    lowest, highest : tuple of float
        The extremes.
    """

    runs: int
    median: Eight
    band_low: Eight
    band_high: Eight
    lowest: Eight
    highest: Eight

    def inside(self, figures: Eight) -> tuple[bool, ...]:
        """Tell for each figure whether it lies between the extremes, to the printed digits."""
        half = 0.5e-4 + 1e-9
        return tuple(
            low - half <= figure <= high + half
            for low, figure, high in zip(self.lowest, figures, self.highest, strict=True)
        )

    def rms_inside(self, figures: Eight) -> bool:
        """Tell whether all four RMS figures do."""
        inside = self.inside(figures)
        return all(inside[place] for place in RMS_PLACES)


def run_ensemble(
    made: Controller,
    trajectories: tuple[Trajectory, Trajectory],
    conventions: Conventions,
    *,
    payload: bool,
    runs: int = RUNS,
    watch: Callable[[int], None] | None = None,
) -> Ensemble:
    """Run a controller many times on both trajectories of a row.

    Parameters
    ----------
    made : Controller
        A sum of compiled laws.
    trajectories : pair of Trajectory
        First and second.
    conventions : Conventions
        As the study counted.
    payload : bool
        Whether the load was carried.
    runs : int, optional
        On each trajectory, seeds 1 to `runs`.
    watch : callable, optional
        Called with the number of runs just finished.
    """
    columns = []
    for trajectory in trajectories:
        batch = simulate_batch(
            made,
            trajectory,
            seeds=np.arange(1, runs + 1),
            payload=payload,
            conventions=conventions,
            options=Options(disturbance=LAST_BIT),
            watch=watch,
        )
        columns += _columns(batch, trajectory)
    figures = np.array(columns)

    def eight(values: NDArray[np.float64]) -> Eight:
        return cast(Eight, tuple(float(value) for value in values))

    low, middle, high = np.percentile(figures, [5.0, 50.0, 95.0], axis=1)
    return Ensemble(
        runs, eight(middle), eight(low), eight(high), eight(figures.min(1)), eight(figures.max(1))
    )


def _columns(batch: Batch, trajectory: Trajectory) -> list[NDArray[np.float64]]:
    last = batch.maximum if trajectory.name == MAXIMUM_ON else batch.final
    return [batch.rms[:, 0], last[:, 0], batch.rms[:, 1], last[:, 1]]
