"""Many runs at once, on all processors: gains, arms and disturbances as arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.controller.controller import Controller
from fuzzyarm.controller.law import Arithmetic
from fuzzyarm.kernels import jit_wanted
from fuzzyarm.loop.loop import final, rms, signed_maximum
from fuzzyarm.loop.run import Course, Options, Program, Record, checked_arms
from fuzzyarm.plant.setting import PLAIN, ArmError, Conventions
from fuzzyarm.plant.trajectory import Schedule, Trajectory

Vector = NDArray[np.float64]

MOST_RUNS = 10_000_000


@dataclass(frozen=True)
class Batch:
    """What came of many runs.

    Attributes
    ----------
    rms, final, maximum : ndarray, shape (n, 2)
        Of each run, degrees.
    diverged : ndarray, shape (n,)
        When a run diverged, s; not a number where it did not.
    """

    rms: Vector
    final: Vector
    maximum: Vector
    diverged: Vector


def simulate_batch(
    controller: Controller,
    trajectory: Trajectory,
    *,
    gains: Mapping[str, ArrayLike] | None = None,
    arms: Sequence[Schedule] | None = None,
    seeds: ArrayLike | None = None,
    payload: bool = False,
    conventions: Conventions = PLAIN,
    options: Options | None = None,
    workers: int | None = None,
    watch: Callable[[int], None] | None = None,
) -> Batch:
    """Run a controller many times along a trajectory.

    The runs share the machine code and the set points; threads on all processors take
    them in turn. Whatever is given as an array has one entry for each run.

    Parameters
    ----------
    controller : Controller
        A sum of compiled laws.
    trajectory : Trajectory
        What to follow.
    gains : mapping of str to array_like, optional
        Of each gain the values: shape (n,), or (n, k) for a gain of k numbers.
    arms : sequence of tuple of ArmParameters, optional
        Of each run one arm for each segment.
    seeds : array_like of int, optional
        Of the disturbances that `options` asks for.
    payload, conventions, options
        See :func:`fuzzyarm.loop.run.simulate`.
    workers : int, optional
        Threads; by default one for each processor.
    watch : callable, optional
        Called with the number of runs just finished; for progress bars.

    Raises
    ------
    ArmError
        If the counts differ, nothing says how many runs there are, or a controller in
        plain Python is asked for.
    """
    options = options or Options()
    count = _count(gains or {}, arms, seeds)
    arithmetic = Arithmetic(conventions.single, conventions.pi)
    compiled = jit_wanted() if options.compiled is None else options.compiled
    program = Program(controller, arithmetic)
    if not program.compilable:
        raise ArmError(f"'{controller.name}' runs as plain Python; a batch takes compiled ones")
    loop = program.loop(compiled)
    rows = {name: np.asarray(values, float) for name, values in (gains or {}).items()}
    drawn = np.asarray(seeds) if seeds is not None else None
    courses: dict[Schedule, Course] = {}

    def course_of(run: int) -> Course:
        chosen = checked_arms(
            trajectory,
            arms[run] if arms is not None else None,
            payload=payload,
            conventions=conventions,
        )
        if chosen not in courses:
            courses[chosen] = Course(trajectory, chosen, conventions, options, as_array=compiled)
        return courses[chosen]

    def program_of(run: int) -> Program:
        if not rows:
            return program
        own = {name: np.atleast_1d(values[run]).tolist() for name, values in rows.items()}
        return Program(controller.with_gains(own), arithmetic)

    def one(run: int) -> tuple[Vector, Vector, Vector, float]:
        course, own = course_of(run), program_of(run)
        setting = course.setting(int(drawn[run]) if drawn is not None else None)
        record = Record(course, own.memory)
        loop(*course.inputs, setting, *own.inputs(compiled), *record.outputs)
        errors = record.degrees(course)
        diverged = record.diverged(course)
        if watch is not None:
            watch(1)
        return (
            rms(errors),
            final(errors),
            signed_maximum(errors, conventions.maximum),
            np.nan if diverged is None else diverged,
        )

    first = one(0)  # compiles, if that is still to be done, once
    rest = _mapped(one, range(1, count), workers if compiled else 1)
    columns = zip(first, *rest, strict=True)
    return Batch(*(np.array(column) for column in columns))


def _mapped(
    job: Callable[[int], tuple[Vector, Vector, Vector, float]],
    runs: range,
    workers: int | None,
) -> list[tuple[Vector, Vector, Vector, float]]:
    workers = workers or os.cpu_count() or 1
    if workers == 1:
        with np.errstate(all="ignore"):
            return [job(run) for run in runs]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(job, runs))


def _count(
    gains: Mapping[str, ArrayLike], arms: Sequence[Schedule] | None, seeds: ArrayLike | None
) -> int:
    counts = {f"gain {name}": len(np.atleast_1d(values)) for name, values in gains.items()}
    if arms is not None:
        counts["arms"] = len(arms)
    if seeds is not None:
        counts["seeds"] = len(np.atleast_1d(seeds))
    if not counts or min(counts.values()) < 1:
        raise ArmError("a batch needs gains, arms or seeds, and at least one of each")
    if len(set(counts.values())) > 1:
        told = ", ".join(f"{count} {name}" for name, count in counts.items())
        raise ArmError(f"the runs of a batch do not match: {told}")
    count = next(iter(counts.values()))
    if count > MOST_RUNS:
        raise ArmError(f"{count:,} runs are more than a batch takes", value=count)
    return count
