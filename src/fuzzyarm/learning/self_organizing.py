"""Train self-organizing control along a trajectory, and watch its tables grow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.controller import CompiledController
from fuzzyarm.controller.on_arm import Learned, TextLaw, learned
from fuzzyarm.loop.loop import rms
from fuzzyarm.loop.run import Course, Options, Program, Record, checked_arms
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Schedule, Trajectory

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Snapshot:
    """Training at some moment.

    Attributes
    ----------
    passage : int
        Of the trajectory, counted from 1.
    time : float
        In that pass, s.
    points : int
        Set points since the start of the training.
    learned : Learned
        The tables, and the visits since the start of the training.
    errors : ndarray, shape (n, 2)
        Of this pass so far, degrees.
    complete : bool
        Whether the pass is over.
    diverged : float or None
        When the run was stopped because it had diverged, s; the training ends there.
    """

    passage: int
    time: float
    points: int
    learned: Learned
    errors: Vector
    complete: bool
    diverged: float | None

    @property
    def rms(self) -> Vector:
        """Root mean square error of each joint in this pass so far, degrees."""
        return rms(self.errors)


def train(
    controller: CompiledController,
    trajectory: Trajectory,
    *,
    passes: int = 1,
    every: int | None = None,
    payload: bool = False,
    arms: Schedule | None = None,
    conventions: Conventions = PLAIN,
    options: Options | None = None,
) -> Iterator[Snapshot]:
    """Run self-organizing control again and again; the arm begins each pass at rest.

    Parameters
    ----------
    controller : CompiledController
        Of a text with a table that learns.
    trajectory : Trajectory
        What to follow.
    passes : int, optional
        How often.
    every : int, optional
        Set points from one snapshot to the next; by default one snapshot for each pass.
    payload, arms, conventions, options
        See :func:`fuzzyarm.loop.run.simulate`.

    Yields
    ------
    Snapshot
        The last one of each pass is complete.
    """
    options = options or Options()
    arms = checked_arms(trajectory, arms, payload=payload, conventions=conventions)
    arithmetic = options.arithmetic(conventions)
    program = Program(controller, arithmetic)
    law = controller.law
    assert isinstance(law, TextLaw)
    rings = law.program(arithmetic).rings
    loop, own = program.loop(options), program.inputs()
    course = Course(trajectory, arms, conventions, options, as_array=program.compiled)
    memory = program.memory
    count = len(course.points.time)
    step = every or count
    for passage in range(1, passes + 1):
        record = Record(course, memory)
        for begin, end in rings:
            record.memory[begin:end] = program.memory[begin:end]  # no cell is responsible yet
        errors = np.zeros((0, 2))
        for begin in range(0, count, step):
            end = min(begin + step, count)
            setting = course.setting(options.seed + begin + count * (passage - 1))
            with np.errstate(all="ignore"):
                loop(*course.stretch(begin, end), setting, *own, *record.outputs)
            errors = np.concatenate([errors, record.degrees(course)])
            stopped = int(record.progress[1]) >= 0
            yield Snapshot(
                passage,
                float(course.points.time[end - 1]),
                end + count * (passage - 1),
                learned(law, arithmetic, record.memory),
                errors,
                end == count or stopped,
                float(course.points.time[begin + int(record.progress[1])]) if stopped else None,
            )
            if stopped:
                return
        memory = record.memory
