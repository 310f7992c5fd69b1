"""Run published rows again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import cast

from fuzzyarm.arm.conventions import Conventions
from fuzzyarm.arm.trajectory import Trajectory, pick_and_place, reach, reach_return
from fuzzyarm.control.catalogue import CATALOGUE, controller
from fuzzyarm.control.controller import CompiledController, Controller, Sum
from fuzzyarm.control.entry import Start, Variant
from fuzzyarm.control.law import Arithmetic
from fuzzyarm.control.run import Options, Run, simulate
from fuzzyarm.study.bounds import Judgement, judge
from fuzzyarm.study.ensemble import Ensemble, run_ensemble
from fuzzyarm.study.published import MAXIMUM_ON, Eight, PublishedRow

TRAJECTORIES: dict[str, Callable[[], Trajectory]] = {
    "reach": reach,
    "reach-return": reach_return,
    "pick-and-place": pick_and_place,
}
"""The study's trajectories by name."""


@dataclass(frozen=True)
class Reproduced:
    """One published row, run again.

    Attributes
    ----------
    published : PublishedRow
        What was printed.
    variant : str
        ``as-printed`` or ``as-described``.
    figures : tuple of float
        The eight numbers that came out, degrees.
    runs : tuple of Run
        On the first and the second trajectory.
    judgement : Judgement
        Against the bounds.
    ensemble : Ensemble or None
        Of the rows that are chaotic.
    """

    published: PublishedRow
    variant: Variant
    figures: Eight
    runs: tuple[Run, Run]
    judgement: Judgement
    ensemble: Ensemble | None = None


def runnable(row: PublishedRow) -> bool:
    """Tell whether this version has the controller of a row."""
    return row.controller in CATALOGUE


def chaotic(row: PublishedRow) -> bool:
    """Tell whether a row switches between the cells of a table."""
    return "table" in CATALOGUE[row.controller].takes


def variants(row: PublishedRow) -> tuple[Variant, ...]:
    """Return the variants that differ: both where the study's text and figures do."""
    arithmetic = Arithmetic()
    printed, described = (
        [
            (block.kind, block.numbers, block.memory)
            for part in row_controller(row, variant).parts()
            if isinstance(part, CompiledController)
            for block in (part.block(arithmetic),)
        ]
        for variant in ("as-printed", "as-described")
    )
    return ("as-printed",) if printed == described else ("as-described", "as-printed")


def row_controller(row: PublishedRow, variant: str = "as-printed") -> Controller:
    """Make the controller of a row, with the model that it had."""
    start = cast(Start, row.start or "warm")
    made = controller(row.controller, start=start, variant=cast(Variant, variant))
    return made if row.model_mass is None else _with_mass(made, row.model_mass)


def _with_mass(made: Controller, mass: float) -> Controller:
    if isinstance(made, Sum):
        return Sum([_with_mass(each, mass) for each in made.addends], made.name)
    if isinstance(made, CompiledController) and "model.m_1" in made.gains:
        return made.with_origin(
            **{
                name: replace(made.gains[name], value=(mass,))
                for name in ("model.m_1", "model.m_2")
            }
        )
    return made


def row_conventions(row: PublishedRow) -> Conventions:
    """Return how the study counted in a row."""
    return CATALOGUE[row.controller].conventions


def reproduce_row(
    row: PublishedRow,
    variant: Variant = "as-printed",
    *,
    made: Controller | None = None,
    options: Options | None = None,
    runs: int = 0,
    watch: Callable[[int], None] | None = None,
) -> Reproduced:
    """Run one row on both trajectories, in the study's conventions.

    Parameters
    ----------
    row : PublishedRow
        Which.
    variant : {"as-printed", "as-described"}, optional
        Which of the two, where they differ.
    made : Controller, optional
        Another controller in its place.
    options : Options, optional
        See :func:`fuzzyarm.control.run.simulate`.
    runs : int, optional
        Disturbed runs on each trajectory if the row is chaotic; none by default.
    watch : callable, optional
        Called with the number of disturbed runs just finished.
    """
    made = made or row_controller(row, variant)
    there, back = (TRAJECTORIES[name]() for name in row.trajectories)
    conventions = row_conventions(row)
    first, second = (
        simulate(made, trajectory, payload=row.payload, conventions=conventions, options=options)
        for trajectory in (there, back)
    )
    figures = (*four(first), *four(second))
    ensemble = None
    if runs and chaotic(row):
        ensemble = run_ensemble(
            made, (there, back), conventions, payload=row.payload, runs=runs, watch=watch
        )
    judgement = judge(row, figures, ensemble)
    return Reproduced(row, variant, figures, (first, second), judgement, ensemble)


def four(run: Run) -> tuple[float, float, float, float]:
    """Return RMS and last figure of both links as the tables have them."""
    last = run.maximum if run.trajectory == MAXIMUM_ON else run.final
    return float(run.rms[0]), float(last[0]), float(run.rms[1]), float(last[1])


def reproduce(rows: list[PublishedRow], runs: int = 0) -> Iterator[Reproduced]:
    """Run rows in every variant, one after the other; chaotic ones `runs` times more."""
    for row in rows:
        for variant in variants(row):
            yield reproduce_row(row, variant, runs=runs)
