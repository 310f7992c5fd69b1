"""Controllers that the study does not have, beside those that it has.

They run under the conditions of its summary table: the same set points, held for five control
periods, the same arm and load, the same motors at the same supply.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fuzzyarm.apps.study.published import RMS_PLACES, Eight, PublishedRow, published_rows
from fuzzyarm.apps.study.reproduce import TRAJECTORIES, four
from fuzzyarm.control.controllers.catalogue import controller
from fuzzyarm.control.loop.run import Run
from fuzzyarm.control.loop.simulation import simulate
from fuzzyarm.plant.setting import STUDY

NAMES = ("fuzzy-fine", "fuzzy-smooth", "pd-motor", "pd-motor-tuned", "pid-smooth")
"""In the catalogue: rule bases first, then straight lines on the same motors."""

SUMMARY_TABLE = "7.1.1"
"""The table of all controllers with payload."""

MODEL_FREE = frozenset(
    {
        "pd",
        "pid-modified",
        "dac",
        "dac+ie",
        "fuzzy-lut",
        "dac+fuzzy",
        "soc-zero",
        "soc-table",
        "stfc",
        "hfie",
        "cfaf",
    }
)
"""Controllers of the summary table that use neither a model of the arm nor an estimate of one."""


@dataclass(frozen=True)
class Beyond:
    """A controller that the study does not have, and what it has to beat."""

    name: str  # in the catalogue
    figures: Eight  # its eight figures under the conditions of the summary table, degrees
    # The smallest of each RMS figure among the published rows without a model, and among all
    # rows, misprints corrected, degrees.
    best_without_model: tuple[float, ...]
    best_of_all: tuple[float, ...]
    runs: tuple[Run, Run]  # on both trajectories

    @property
    def rms(self) -> tuple[float, ...]:
        """The four RMS figures, degrees."""
        return tuple(self.figures[place] for place in RMS_PLACES)

    @property
    def rms_periods(self) -> tuple[float, ...]:
        """The same of all control periods, from the set point that is held in each, degrees."""
        return tuple(float(value) for run in self.runs for value in run.rms_periods)

    @property
    def rms_path(self) -> tuple[float, ...]:
        """The same from the path on which the set points lie, degrees."""
        return tuple(float(value) for run in self.runs for value in run.rms_path)

    @property
    def beats_those_without_model(self) -> bool:
        """Whether every RMS figure at the set points is below those of all rows without a model."""
        return _all_below(self.rms, self.best_without_model)

    @property
    def beats_all(self) -> bool:
        """Whether every RMS figure at the set points is below all published ones."""
        return _all_below(self.rms, self.best_of_all)


def _all_below(values: tuple[float, ...], best: tuple[float, ...]) -> bool:
    return all(mine < other for mine, other in zip(values, best, strict=True))


def run_beyond() -> Iterator[Beyond]:
    """Run the controllers under the conditions of the summary table."""
    rows = [row for row in published_rows() if row.table == SUMMARY_TABLE]
    without_model = smallest([row for row in rows if row.controller in MODEL_FREE])
    of_all = smallest(rows)
    for name in NAMES:
        first, second = (
            simulate(
                controller(name),
                TRAJECTORIES[trajectory](),
                payload=True,
                conventions=STUDY,
            )
            for trajectory in rows[0].trajectories
        )
        figures = (*four(first), *four(second))
        yield Beyond(name, figures, without_model, of_all, (first, second))


def smallest(rows: list[PublishedRow]) -> tuple[float, ...]:
    """Return the smallest of each RMS figure of some rows, misprints corrected, degrees."""
    return tuple(min(row.corrected[place] for row in rows) for place in RMS_PLACES)
