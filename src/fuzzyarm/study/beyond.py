"""One controller that the study does not have, beside those of the study that know no model."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.control.catalogue import CATALOGUE, controller
from fuzzyarm.control.run import Run, simulate
from fuzzyarm.study.published import RMS_PLACES, Eight, published_rows
from fuzzyarm.study.reproduce import TRAJECTORIES, four

NAME = "fuzzy-fine"
"""In the catalogue."""

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
    """The controller and what it has to beat.

    Attributes
    ----------
    name : str
        In the catalogue.
    figures : tuple of float
        Its eight figures under the conditions of the summary table, degrees.
    to_beat : tuple of float
        The smallest of each RMS figure among the published rows without a model, misprints
        corrected, degrees.
    runs : tuple of Run
        On both trajectories.
    """

    name: str
    figures: Eight
    to_beat: tuple[float, ...]
    runs: tuple[Run, Run]

    @property
    def rms(self) -> tuple[float, ...]:
        """The four RMS figures, degrees."""
        return tuple(self.figures[place] for place in RMS_PLACES)

    @property
    def better(self) -> bool:
        """Whether it is better in every RMS figure."""
        return all(own < best for own, best in zip(self.rms, self.to_beat, strict=True))


def run_beyond() -> Beyond:
    """Run the controller under the conditions of the summary table."""
    rows = [r for r in published_rows() if r.table == "7.1.1" and r.controller in MODEL_FREE]
    to_beat = tuple(min(row.corrected[place] for row in rows) for place in RMS_PLACES)
    first, second = (
        simulate(
            controller(NAME),
            TRAJECTORIES[name](),
            payload=True,
            conventions=CATALOGUE[NAME].conventions,
        )
        for name in rows[0].trajectories
    )
    return Beyond(NAME, (*four(first), *four(second)), to_beat, (first, second))
