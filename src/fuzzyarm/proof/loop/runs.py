"""Runs that refute a claim about a loop: found with ``simulate``, then enclosed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import islice, product
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.numbers import decimal, number_text
from fuzzyarm.control.loop.course import Options
from fuzzyarm.control.loop.run import Run
from fuzzyarm.control.loop.simulation import simulate
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.own import starting_at
from fuzzyarm.plant.plant import with_parameters
from fuzzyarm.proof.claim.problem import LoopProblem, LostRunError
from fuzzyarm.proof.claim.text import claimed_port, error_label
from fuzzyarm.proof.loop.enclosure import EnclosureError, Vector
from fuzzyarm.proof.loop.follower import Follower
from fuzzyarm.proof.stop import Stop, TimeOverError
from fuzzyarm.symbolic.operations import Interval


class Breach(NamedTuple):
    """A run that breaks a claim, and how, in words."""

    run: Run
    words: tuple[str, ...]


def refuting_run(problem: LoopProblem, claim: LoopClaim, stop: Stop | None = None) -> Breach | None:
    """Return a run that certainly breaks a claim, if one of the tried runs does.

    A run in floats is a hint only: the proof is its enclosure.
    """
    stop = stop or Stop()
    unknown = 0
    for start, values in _starts(problem):
        if stop.now or unknown == MOST_UNKNOWN:
            return None
        whole = _claimed_duration(problem, claim)
        run = run_in_time(
            problem, start, values, whole, stop, lambda run: _breach(problem, claim, run)
        )
        if run is None:
            return None
        end = _breach(problem, claim, run)
        if end is None:
            continue
        words = _enclosed_breach(problem, claim, start, values, end, stop)
        if words:
            free = {n: x for n, x in values.items() if len(set(problem.parameters[n])) > 1}
            begun = ", ".join(f"{n} = {number_text(x)}" for n, x in {**start, **free}.items())
            return Breach(run, (f"from {begun}", words))
        unknown += words is None
    return None


ENCLOSING = 3.0
"""Time budget of the enclosure of one run, seconds."""

MOST_UNKNOWN = 2
"""Most runs with an inconclusive enclosure."""

FIRST_STEPS, LONGER, SHARE = 20_000, 8, 0.1
"""Integrator steps of the first run; ratio of lengths of the next run; and its largest share of the
remaining time."""


def run_in_time(
    problem: LoopProblem,
    start: Mapping[str, float],
    values: Mapping[str, float],
    whole: float,
    stop: Stop,
    found: Callable[[Run], object],
) -> Run | None:
    """Return a run of duration `whole`, or as long as time permits, or until a finding.

    `found` returns the finding; None or empty: none.
    """
    steps = max(1, math.ceil(problem.period / problem.plant.longest_step))
    periods = max(1, FIRST_STEPS // steps)
    while True:
        begun = stop.spent
        run = run_of(problem, start, values, duration=min(whole, periods * problem.period))
        taken = stop.spent - begun
        if run is None or found(run) not in (None, ""):
            return run
        if periods * problem.period >= whole or LONGER * taken > SHARE * stop.left:
            return run
        periods *= LONGER


def _claimed_duration(problem: LoopProblem, claim: LoopClaim) -> float:
    """Return the duration of a run, s."""
    if claim.output and claim.when == "during":
        return claim.end + problem.period  # the sample at the end counts
    duration = problem.plant.duration or 1000 * problem.period
    return max(duration, 1.5 * claim.begin) + (problem.rests_from or 0) * problem.period


def _enclosed_breach(
    problem: LoopProblem,
    claim: LoopClaim,
    start: Mapping[str, float],
    values: Mapping[str, float],
    end: float,
    stop: Stop,
) -> str | None:
    """Return how a run certainly breaks a claim.

    Empty if it is certainly inside until an end; None if the enclosure is inconclusive.
    """
    alone = replace(
        problem,
        start={name: Interval(x, x) for name, x in start.items()},
        parameters={name: Interval(x, x) for name, x in values.items()},
    )
    try:
        follower = Follower(alone, end, stop=Stop(min(ENCLOSING, 0.25 * stop.left)))
    except (FuzzyarmError, EnclosureError):
        return None
    try:
        course = follower.follow([follower.first])
    except LostRunError as error:
        time = (follower.reached + 1) * decimal(problem.period)
        is_in_time = not claim.output or decimal(claim.begin) <= time < _last(claim)
        return f"the run is {error.where}, after {float(time):.6g} s" if is_in_time else None
    except (FuzzyarmError, EnclosureError):
        return None
    if not claim.output:
        return None
    low, high, *ends = course.by_period(follower.periods, follower.periods)
    port = claimed_port(problem, claim)
    k = follower.labels.index(port)
    # Outputs at the samples; drives, which jump there, from each sample on: both count at the end.
    jumps = 0 <= k - len(problem.site.interface.outputs) < len(problem.site.interface.inputs)
    period, last = decimal(problem.period), _last(claim)
    bounds = (low[:, k], high[:, k]) if jumps else (ends[0][:, k], ends[1][:, k])
    for n, (least, most) in enumerate(zip(*(x.tolist() for x in bounds), strict=True)):
        time = n * period
        if decimal(claim.begin) <= time <= last and (least > claim.high or most < claim.low):
            texts = dict.fromkeys(f"{x:.6g}" for x in (least, most))
            sign = "=" if len(texts) == 1 else "in"
            return f"{port} {sign} {' .. '.join(texts)} after {float(time):.6g} s"
    inside = bool((low[:, k] >= claim.low).all() and (high[:, k] <= claim.high).all())
    return "" if inside else None


def _last(claim: LoopClaim) -> Fraction | float:
    return claim.end if math.isinf(claim.end) else decimal(claim.end)


FINER = (1, 4, 16, 64, 256)
"""Steps per period, one after another, until two runs agree."""

AGREED = 1e-3
"""Largest difference of two runs with different steps, as a share of the distance travelled."""


def converged(run: Callable[[int], Run | None], stop: Stop) -> tuple[Run, Run] | None:
    """Return two agreeing runs with different steps, the finer one last; or TimeOverError.

    `run(n)` has n times as many steps.
    """
    coarse: Run | None = None
    taken = 0.0
    for steps in FINER:
        if coarse is not None and stop.left < 4.0 * taken:
            raise TimeOverError
        begun = stop.spent
        fine = run(steps)
        taken = stop.spent - begun
        if fine is None:
            return None
        if coarse is not None and _agree(coarse, fine):
            return coarse, fine
        coarse = fine
    return None


def _agree(one: Run, other: Run) -> bool:
    """Return whether two runs agree within the error of the coarser integration."""
    count = min(len(one.time), len(other.time))
    is_lost = one.diverged is not None
    # A diverging run may leave a sample earlier or later.
    if is_lost != (other.diverged is not None) or abs(len(one.time) - len(other.time)) > 1:
        return False
    for name, values in one.outputs.items():
        first, second = (np.asarray(x, float)[:count] for x in (values, other.outputs[name]))
        finite = np.isfinite(first) & np.isfinite(second)
        if is_lost and count > 3:  # on overflow the last sample may be anything
            finite[-1] = True
            first, second = (np.where(np.isfinite(x), x, 0.0)[:-1] for x in (first, second))
        size = np.maximum.accumulate(np.abs(second)) + 1e-12
        if not (finite.all() and (np.abs(first - second) <= AGREED * size).all()):
            return False
    return True


RUNS = 24
"""Random starts of attacks on a claim, besides the corners."""


def _starts(problem: LoopProblem) -> Iterator[tuple[dict[str, float], dict[str, float]]]:
    """Yield starts and parameters: corners, then random ones."""
    spans = dict(problem.start)
    generator = np.random.default_rng(0)
    free = sum(len(set(span)) > 1 for span in spans.values())
    # All corners of up to five uncertain states.
    corners = islice(product(*(dict.fromkeys(span) for span in spans.values())), 32)
    values = {name: span.low for name, span in problem.parameters.items()}
    other = {name: span.high for name, span in problem.parameters.items()}
    for corner in corners:
        start = dict(zip(spans, corner, strict=True))
        yield start, values
        if other != values:
            yield start, other
    if free or other != values:
        for _ in range(RUNS):
            yield (
                {n: float(generator.uniform(s.low, s.high)) for n, s in spans.items()},
                {n: float(generator.uniform(s.low, s.high)) for n, s in problem.parameters.items()},
            )


def sampled_runs(problem: LoopProblem, duration: float, count: int) -> list[Run]:
    """Return runs of `simulate` from corners of the starts and from inside, up to `count`."""
    runs = (run_of(problem, *start, duration=duration) for start in islice(_starts(problem), count))
    return [run for run in runs if run is not None]


def run_of(
    problem: LoopProblem,
    start: Mapping[str, float],
    values: Mapping[str, float],
    *,
    duration: float,
    steps: int = 1,
) -> Run | None:
    """Return a run of a loop with its steps divided by a number, or None: a confirmation."""
    plant = problem.plant
    if values:
        plant = with_parameters(plant, values)
    plant = starting_at(plant, [start[name] for name in problem.states])
    if steps > 1:
        plant.longest_step = min(plant.longest_step, problem.period) / steps
    try:
        return simulate(
            problem.text,
            plant,
            reference=problem.signals_by_name,
            duration=max(duration, 2 * problem.period * problem.text.model.every),
            options=Options(
                sensors={".".join(port): sensor for port, sensor in problem.sensors.items()}
            ),
            connect=problem.site.connect,
        )
    except FuzzyarmError:
        return None


def values_of(problem: LoopProblem, run: Run) -> dict[str, Vector]:
    """Return outputs, drives and errors of a run, by their names in tubes."""
    label, references = problem.site.interface.label, problem.site.interface.references
    values = {**run.outputs, **run.drives}
    for address in problem.errors:
        of, order = references[address].of, references[address].order
        setpoint = problem.signal_of(of).at(np.asarray(run.time, float))[order]
        values[error_label(label(address))] = setpoint - run.outputs[label(address)]
    return values


def _breach(problem: LoopProblem, claim: LoopClaim, run: Run) -> float | None:
    """Return the time at which a run breaks a claim in floats, s."""
    if claim.output:
        port = claimed_port(problem, claim)
        values = np.asarray(values_of(problem, run)[port], float)
        in_time = (run.time >= claim.begin - 1e-9) & (run.time <= claim.end + 1e-9)
        wrong = in_time & ((values > claim.high) | (values < claim.low))
        if wrong.any():
            return float(run.time[wrong.argmax()]) + problem.period
        if run.diverged is None or not claim.begin <= run.diverged <= claim.end + problem.period:
            return None
    return None if run.diverged is None else run.diverged + problem.period
