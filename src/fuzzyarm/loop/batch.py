"""Many runs at once, on all processors: gains, arms and disturbances as arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.controller.controller import Controller
from fuzzyarm.controller.on_plant import controller_on, driven_by, site_of
from fuzzyarm.kernels import in_threads
from fuzzyarm.loop.course import Course, Options, arm_motion
from fuzzyarm.loop.loop import final, rms, signed_maximum
from fuzzyarm.loop.run import (
    Program,
    Record,
    checked_arms,
    error_taps,
    loop_of_laws,
    shown_errors,
)
from fuzzyarm.plant.setting import PLAIN, ArmError, Conventions
from fuzzyarm.plant.trajectory import Schedule, Trajectory

Vector = NDArray[np.float64]

MOST_RUNS = 10_000_000

LONGEST_STRETCH = 64
"""Runs that a thread takes at a time."""

_Result = tuple[Vector, Vector, Vector, float]
"""Root mean square, last and largest errors, and when the run diverged."""


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
    arithmetic = options.arithmetic(conventions)
    program = Program(controller, arithmetic)
    if not program.compilable:
        raise ArmError(f"'{controller.name}' runs as plain Python; a batch takes compiled ones")
    compiled = program.compiled
    loop = loop_of_laws(compiled, conventions.single)
    rows = {name: np.asarray(values, float) for name, values in (gains or {}).items()}
    drawn = np.asarray(seeds) if seeds is not None else None
    arms_of = partial(checked_arms, trajectory, payload=payload, conventions=conventions)
    first_arms = arms_of(arms[0] if arms is not None else None)
    followed = arm_motion(trajectory, first_arms, conventions, options)
    site = site_of(followed.plants[0])
    controller = controller_on(controller, site)
    driven = driven_by(controller, site)
    shared = Course(followed, conventions, options, driven=driven, as_array=compiled)
    taps = error_taps(shared)
    shared_inputs = program.inputs()

    def one(run: int) -> tuple[Vector, Vector, Vector, float]:
        course = shared
        if arms is not None:
            own_arms = arms_of(arms[run])
            course = shared.with_plants(arm_motion(trajectory, own_arms, conventions, options))
        memory, inputs = program.memory, shared_inputs
        if rows:
            gains_of_run = {name: np.atleast_1d(values[run]) for name, values in rows.items()}
            changed = {name: values.tolist() for name, values in gains_of_run.items()}
            own = Program(controller.with_gains(changed), arithmetic)
            memory, inputs = own.memory, own.inputs()
        seed = int(drawn[run]) if drawn is not None else None
        record = Record(course, memory, taps, seed)
        loop(*course.inputs(seed), *inputs, *record.outputs)
        errors = shown_errors(course, record.samples)
        diverged = record.diverged()
        if watch is not None:
            watch(1)
        return (
            rms(errors),
            final(errors),
            signed_maximum(errors, conventions.maximum),
            np.nan if diverged is None else diverged,
        )

    results = _mapped(one, count, (workers or os.cpu_count() or 1) if compiled else 1)
    return Batch(*(np.array(column) for column in zip(*results, strict=True)))


def _mapped(job: Callable[[int], _Result], count: int, workers: int) -> list[_Result]:
    """Do a job for each number; threads take stretches of them, so that few wait for the GIL."""
    size = max(1, min(LONGEST_STRETCH, count // (4 * workers)))
    stretches = (range(begin, min(begin + size, count)) for begin in range(0, count, size))

    def run_some(some: Iterator[range]) -> dict[int, list[_Result]]:
        with np.errstate(all="ignore"):
            return {runs.start: [job(run) for run in runs] for runs in some}

    done: dict[int, list[_Result]] = {}
    for part in in_threads(run_some, stretches, workers):
        done |= part
    return [result for begin in sorted(done) for result in done[begin]]


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
