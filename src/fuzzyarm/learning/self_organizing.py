"""Train self-organizing control on a plant, and watch its tables grow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.controller import CompiledController
from fuzzyarm.controller.on_plant import (
    Learned,
    TextLaw,
    controller_on,
    driven_by,
    learned,
    site_of,
)
from fuzzyarm.loop.course import Course, Motion, Options, arm_motion
from fuzzyarm.loop.loop import rms
from fuzzyarm.loop.program import (
    Program,
    Record,
    error_taps,
    loop_for,
    shown_errors,
    shown_units,
)
from fuzzyarm.loop.run import checked_arms
from fuzzyarm.plant.plant import is_compiled
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Schedule, Trajectory

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Snapshot:
    """Training at some moment.

    Attributes
    ----------
    passage : int
        Of the set points, counted from 1.
    time : float
        In that pass, s.
    points : int
        Set points since the start of the training.
    learned : Learned
        The tables, and the visits since the start of the training.
    errors : ndarray, shape (n, k)
        Of this pass so far, as they are shown.
    complete : bool
        Whether the pass is over.
    diverged : float or None
        When the run was stopped because it had diverged, s; the training ends there.
    units : tuple of str
        Of the errors.
    """

    passage: int
    time: float
    points: int
    learned: Learned
    errors: Vector
    complete: bool
    diverged: float | None
    units: tuple[str, ...]

    @property
    def rms(self) -> Vector:
        """Root mean square of each tracked error in this pass so far."""
        return rms(self.errors)


def train(
    controller: CompiledController,
    on: Trajectory | Motion,
    *,
    passes: int = 1,
    every: int | None = None,
    payload: bool = False,
    arms: Schedule | None = None,
    conventions: Conventions = PLAIN,
    options: Options | None = None,
    connect: Mapping[str, str] | None = None,
) -> Iterator[Snapshot]:
    """Run self-organizing control again and again; the plant begins each pass anew.

    Parameters
    ----------
    controller : CompiledController
        Of a text with a table that learns.
    on : Trajectory or Motion
        What the arm is to follow, or set points of any plant, see
        :func:`fuzzyarm.loop.run.plant_motion`.
    passes : int, optional
        How often.
    every : int, optional
        Set points from one snapshot to the next; by default one snapshot for each pass.
    payload, arms, conventions, options, connect
        See :func:`fuzzyarm.loop.run.simulate`.

    Yields
    ------
    Snapshot
        The last one of each pass is complete.
    """
    options = options or Options()
    motion = on
    if isinstance(motion, Trajectory):
        arms = checked_arms(motion, arms, payload=payload, conventions=conventions)
        motion = arm_motion(motion, arms, conventions, options)
    site = site_of(motion.plants[0], connect)
    chosen = controller_on(controller, site)
    assert isinstance(chosen, CompiledController)
    law = chosen.law
    assert isinstance(law, TextLaw)
    arithmetic = options.arithmetic(conventions)
    program = Program(chosen, arithmetic)
    rings = law.program(arithmetic).rings
    compiled = program.compiled and is_compiled(motion.plants[0])
    driven = driven_by(chosen, site)
    course = Course(motion, conventions, options, driven=driven, as_array=compiled)
    own = program.inputs(as_array=compiled)
    memory = program.memory
    count = len(motion.time)
    step = every or count
    for passage in range(1, passes + 1):
        record = Record(course, memory, error_taps(course))
        loop = loop_for(program, course, record)
        for begin, end in rings:
            record.memory[begin:end] = program.memory[begin:end]  # no cell is responsible yet
        # Each pass is disturbed in its own way.
        seed = options.seed + count * (passage - 1) if options.disturbance else None
        inputs = course.inputs(seed)
        for end in [*range(step, count, step), count]:
            record.go_on(end)
            with np.errstate(all="ignore"):
                loop(*inputs, *own, *record.outputs)
            lost = record.lost
            yield Snapshot(
                passage,
                float(motion.time[end - 1]),
                end + count * (passage - 1),
                learned(law, arithmetic, record.memory),
                shown_errors(course, record.samples),
                end == count or lost is not None,
                None if lost is None else float(motion.time[lost]),
                shown_units(course),
            )
            if lost is not None:
                return
        memory = record.memory
