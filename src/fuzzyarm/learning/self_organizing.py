"""Train self-organizing control on a plant, watch its tables grow, and write them down."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.control.controllers.controller import CompiledController
from fuzzyarm.control.controllers.on_plant import (
    LearnedTables,
    controller_on,
    driven_by,
    learned,
    site_of,
    text_law_of,
)
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Course, Motion, Options
from fuzzyarm.control.loop.loop import rms
from fuzzyarm.control.loop.program import (
    LoopProgram,
    RunRecord,
    error_taps,
    loop_for,
    shown_errors,
    shown_units,
)
from fuzzyarm.control.loop.run import require_timing
from fuzzyarm.language.model.controller import Learn
from fuzzyarm.plant.plant import Plant, is_compiled
from fuzzyarm.plant.setting import PLAIN, Conventions, RunArithmetic
from fuzzyarm.table import LookupTable
from fuzzyarm.version import __version__

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Snapshot:
    """Training at some moment.

    Attributes
    ----------
    passage : int
        Number of the set points, from 1.
    time : float
        In that pass, s.
    points : int
        Set points since the start of the training.
    learned : LearnedTables
        The tables, and the visits since the start of the training.
    errors : ndarray, shape (n, k)
        Errors of this pass so far, in displayed units.
    complete : bool
        Whether the pass is over.
    diverged : float or None
        When the run was stopped because it had diverged, s; the training ends there.
    units : tuple of str
        Units of the errors.
    """

    passage: int
    time: float
    points: int
    learned: LearnedTables
    errors: Vector
    complete: bool
    diverged: float | None
    units: tuple[str, ...]

    @property
    def rms(self) -> Vector:
        """Root mean square of each tracked error in this pass so far."""
        return rms(self.errors)


def trained(
    controller: CompiledController,
    motion: Motion,
    passes: int = 1,
    every: int | None = None,
    conventions: Conventions = PLAIN,
    options: Options | None = None,
    connect: Mapping[str, str] | None = None,
) -> Iterator[Snapshot]:
    """Run self-organizing control along set points; see :func:`fuzzyarm.learning.train`."""
    options = options or Options()
    site = site_of(motion.plants[0], connect)
    chosen = controller_on(controller, site)
    require_timing(chosen, motion)
    law = text_law_of(chosen)
    assert law is not None
    arithmetic = options.arithmetic(conventions)
    program = LoopProgram(chosen, arithmetic)
    rings = law.program(arithmetic).rings
    compiled = program.compiled and is_compiled(motion.plants[0])
    driven = driven_by(chosen, site)
    course = Course(motion, conventions, options, driven=driven, as_array=compiled)
    memory = program.memory
    count = len(motion.time)
    step = every or count
    for passage in range(1, passes + 1):
        record = RunRecord(course, memory, error_taps(course))
        loop = loop_for(program, course, record)
        for begin, end in rings:
            # The ring of the last `delay` cells: at the start of a pass none is responsible yet.
            record.memory[begin:end] = program.memory[begin:end]
        # Each pass is disturbed in its own way.
        seed = options.seed + count * (passage - 1) if options.disturbance else None
        block = record.block(program, course.parts(seed))
        for end in [*range(step, count, step), count]:
            record.go_on(end)
            with np.errstate(all="ignore"):
                loop(block)
            lost = record.lost
            yield Snapshot(
                passage=passage,
                time=float(motion.time[end - 1]),
                points=end + count * (passage - 1),
                learned=learned(law, arithmetic, record.memory),
                errors=shown_errors(course, record.rows),
                complete=end == count or lost is not None,
                diverged=None if lost is None else float(motion.time[lost]),
                units=shown_units(course),
            )
            if lost is not None:
                return
        memory = record.memory


# --- A training from its beginning to the file ---


class NoTableError(FuzzyarmError, ValueError):
    """A controller without a learning table, or without one of that name."""


class Trainee:
    """A controller with a table that learns, ready on a plant.

    Parameters
    ----------
    controller : CompiledController
        Controller of a text with a line ``learn``.
    plant : Plant
        Where it runs.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant.
    name : str, optional
        For the message.

    Attributes
    ----------
    text : ControllerText
        The text.
    learner : Learn
        The line that teaches the table.
    start : LearnedTables
        The tables before the training.
    like : LookupTable
        Range and description of the learned tables.

    Raises
    ------
    NoTableError
        If no table learns.
    SourceError
        If the plant lacks a port of the controller.
    """

    def __init__(
        self,
        controller: CompiledController,
        plant: Plant,
        connect: Mapping[str, str] | None = None,
        name: str = "",
    ) -> None:
        law = text_law_of(controller)
        assert law is not None
        self.controller, self.plant, self.connect = controller, plant, connect
        self.text: ControllerText = law.text
        learners = list(self.text.learners())
        if not learners:
            raise NoTableError(f"{name or self.text.model.name} has no table that learns")
        self.learner: Learn = learners[0]
        sheet = self.text.sheets[self.learner.table][0]
        assert isinstance(sheet, LookupTable)
        bound = text_law_of(controller_on(controller, site_of(plant, connect)))
        assert bound is not None
        self.start = learned(bound, RunArithmetic())
        self.like = replace(
            sheet,
            output="u",
            description="control, normalised",
            rounding=None,  # learned values are not rounded
            provenance=(),
        )

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes of the controller, each with its own table."""
        return self.text.model.axis_names

    @property
    def rate(self) -> float:
        """The learning rate."""
        rate = self.learner.rate
        return self.controller.gains[rate].value[0] if isinstance(rate, str) else rate

    def snapshots(
        self,
        motion: Motion,
        passes: int,
        every: int | None = None,
        conventions: Conventions = PLAIN,
        options: Options | None = None,
    ) -> Iterator[Snapshot]:
        """Train; the last digits that only rounding made are left out."""
        for snapshot in trained(
            self.controller, motion, passes, every, conventions, options, self.connect
        ):
            # An unused cell must keep the value of its file, and 1.8 - 1 + 1 is not 1.8.
            yield replace(snapshot, learned=snapshot.learned.readable(single=conventions.single))

    def table(
        self, learned: LearnedTables, provenance: Mapping[str, str], axis: int | None = None
    ) -> LookupTable:
        """Return the table of an axis (from 1), or one over all of them."""
        if axis or len(self.axes) == 1:
            table = learned.tables(self.like)[(axis or 1) - 1]
        else:
            table = learned.table(self.like)
        return replace(table, provenance=tuple(provenance.items()))

    def provenance(
        self,
        along: str,
        passes: int | str,
        start: str,
        performance: str = "",
        conventions: str = "plain",
    ) -> dict[str, str]:
        """Return the provenance of a learned table."""
        files = {use.name: " ".join(use.files) for use in self.text.model.uses}
        judge = files[self.learner.judge].removeprefix("performance-").removesuffix(".lut")
        return {
            "made": "learned by self-organizing control",
            "start": start or files[self.learner.table],
            "performance": performance or Path(judge).name,
            "trajectory": along,
            "passes": str(passes),
            "learning": f"rate {self.rate:g}, delay {self.learner.delay}",
            "conventions": conventions,
            "engine": f"fuzzyarm {__version__}",
        }


@json_properties("*")
class TableState(NamedTuple):
    """A learning table.

    Attributes
    ----------
    visited : int
        Number of used cells.
    changed : int
        Cells that differ from the start.
    never_visited : int
        Number of unused cells.
    """

    visited: int
    changed: int
    never_visited: int


def state_of(snapshot: Snapshot, start: LearnedTables) -> list[TableState]:
    """Return for each axis the numbers of visited, changed and unvisited cells."""
    learned = snapshot.learned
    changed = learned.values != start.values
    return [
        TableState(int((visits > 0).sum()), int(changes.sum()), int((visits == 0).sum()))
        for visits, changes in zip(learned.visits, changed, strict=True)
    ]


def error_words(snapshot: Snapshot) -> str:
    """Return the errors of a pass as they are shown, ``0.9002° and 0.8000°``."""
    units = ["°" if unit == "degrees" else f" {unit}" for unit in snapshot.units]
    words = [f"{error:.4f}{unit}" for error, unit in zip(snapshot.rms, units, strict=True)]
    return " and ".join(words)


def reference_words(plant: str, references: Sequence[str], step: float = 1.0) -> str:
    """Describe the references of the training; the default is a step."""
    return f"{plant} {' '.join(references) or f'step {step:g}'}"


def trajectory_words(
    name: str, *, payload: bool = False, loaded: Sequence[int] = (), details: Sequence[str] = ()
) -> str:
    """Describe the trajectory of the training."""
    words = [name, *details]
    if payload:
        words.append("with payload")
    if loaded:
        words.append("loaded in segments " + " ".join(map(str, loaded)))
    return " ".join(words)
