"""Runs that try to refute a claim about a loop, as ``simulate`` gives them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import islice, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.closed_loop.claimed_time import decimal
from fuzzyarm.closed_loop.claims import claimed_port
from fuzzyarm.closed_loop.enclosure import EnclosureError
from fuzzyarm.closed_loop.problem import LoopProblem
from fuzzyarm.closed_loop.tube import tube
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.expression.operations import Interval
from fuzzyarm.loop.course import Options
from fuzzyarm.loop.run import Run
from fuzzyarm.loop.simulation import simulate
from fuzzyarm.model.claims import LoopClaim
from fuzzyarm.plant.own import starting_at
from fuzzyarm.plant.plant import with_parameters
from fuzzyarm.proof.arithmetic import Stop
from fuzzyarm.text.numbers import number_text

__all__ = ["Breach", "converged", "refuting_run", "run_of", "sampled_runs"]


class Breach(NamedTuple):
    """A run that breaks a claim, and how, in words."""

    run: Run
    words: tuple[str, ...]


def refuting_run(
    problem: LoopProblem,
    claim: LoopClaim,
    rest: Mapping[str, float] | None = None,
    stop: Stop | None = None,
) -> Breach | None:
    """Return a run that breaks a claim, if one of some runs does.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    claim : LoopClaim
        What is claimed of it.
    rest : mapping of str to float, optional
        Where the plant rests, if the controller is at rest as it starts. That a loop is stable,
        with no word of where from, is refuted by runs from next to there only.
    stop : Stop, optional
        When to give up; the first run is made in any case.
    """
    at_rest = not claim.start and not claim.output
    if at_rest and rest is None:
        return None
    encloses = bool(claim.output)
    for number, (start, values) in enumerate(_starts(problem, claim, rest if at_rest else None)):
        if number and stop is not None and stop.now:
            return None
        run = run_of(problem, start, values, claim)
        if run is None:
            return None
        if not _breach(problem, claim, run, rest):
            continue
        free = {n: x for n, x in values.items() if len(set(problem.parameters[n])) > 1}
        words = ", ".join(f"{name} = {number_text(x)}" for name, x in {**start, **free}.items())
        if encloses:
            k = _first_outside(problem, claim, run)
            end = float(run.time[-1 if k is None else k]) + problem.period
            outside = _enclosed_outside(problem, claim, start, values, end, stop)
            if outside:
                return Breach(run, (f"from {words}", outside))
            encloses = outside is not None  # where one run is not enclosed, no other one will be
            if encloses:
                continue
        # It might be a breach of the integrator only.
        pair = converged(lambda steps: run_of(problem, start, values, claim, steps=steps))  # noqa: B023
        against = "" if pair is None else _breach(problem, claim, pair[1], rest, pair[0])
        if pair is not None and against:
            return Breach(pair[1], (f"from {words}", against))
    return None


ENCLOSING = 3.0
"""Seconds that the enclosure of one run may take."""


def _enclosed_outside(
    problem: LoopProblem,
    claim: LoopClaim,
    start: Mapping[str, float],
    values: Mapping[str, float],
    end: float,
    stop: Stop | None,
) -> str | None:
    """Return where a run is for certain outside the claimed interval in the claimed time.

    Empty where it is inside for certain until an end; None where no enclosure tells.
    """
    alone = replace(
        problem,
        start={name: Interval(x, x) for name, x in start.items()},
        parameters={name: Interval(x, x) for name, x in values.items()},
    )
    budget = ENCLOSING if stop is None else min(ENCLOSING, 0.25 * stop.left)
    try:
        way = tube(alone, end, budget=budget)
    except (FuzzyarmError, EnclosureError):
        return None
    if not way.complete:
        return None
    port, period = claimed_port(problem, claim), decimal(problem.period)
    k, begin = way.ports.index(port), decimal(claim.begin)
    last = math.inf if math.isinf(claim.end) else decimal(claim.end)
    # Outputs at the samples; drives, which jump there, from each sample on.
    jumps = port not in {*map(problem.site.interface.label, problem.site.interface.outputs)}
    bounds = (way.low, way.high) if jumps else (way.low_at, way.high_at)
    for n, (low, high) in enumerate(zip(*(x[:, k].tolist() for x in bounds), strict=True)):
        is_in_time = begin <= n * period and (n * period < last if jumps else n * period <= last)
        if is_in_time and (low > claim.high or high < claim.low):
            ends = dict.fromkeys(f"{x:.6g}" for x in (low, high))
            sign = "=" if len(ends) == 1 else "in"
            return f"{port} {sign} {' .. '.join(ends)} after {n * problem.period:.6g} s"
    inside = bool((way.low[:, k] >= claim.low).all() and (way.high[:, k] <= claim.high).all())
    return "" if inside else None


FINER = (1, 4, 16, 64, 256)
"""Into how many steps a period is cut, one after another, until two runs agree."""

AGREED = 1e-3
"""By what share of how far a run has been two runs of different steps may differ."""


def converged(run: Callable[[int], Run | None]) -> tuple[Run, Run] | None:
    """Return two runs of different steps that agree, the finer one last.

    Parameters
    ----------
    run : callable
        Makes a run, of so many times as many steps.
    """
    coarse: Run | None = None
    for steps in FINER:
        fine = run(steps)
        if fine is None:
            return None
        if coarse is not None and _agree(coarse, fine):
            return coarse, fine
        coarse = fine
    return None


def _agree(one: Run, other: Run) -> bool:
    """Tell whether two runs are the same except for what a finer integration changes."""
    count = min(len(one.time), len(other.time))
    is_lost = one.diverged is not None
    # One that diverges may leave a sample earlier or later.
    if is_lost != (other.diverged is not None) or abs(len(one.time) - len(other.time)) > 1:
        return False
    for name, values in one.outputs.items():
        first, second = (np.asarray(x, float)[:count] for x in (values, other.outputs[name]))
        finite = np.isfinite(first) & np.isfinite(second)
        if is_lost and count > 3:  # beyond all numbers the last sample may be anything
            finite[-1] = True
            first, second = (np.where(np.isfinite(x), x, 0.0)[:-1] for x in (first, second))
        size = np.maximum.accumulate(np.abs(second)) + 1e-12
        if not (finite.all() and (np.abs(first - second) <= AGREED * size).all()):
            return False
    return True


RUNS = 24
"""Random starts, beside the corners, from which a claim is attacked."""


def _starts(
    problem: LoopProblem, claim: LoopClaim, rest: Mapping[str, float] | None = None
) -> Iterator[tuple[dict[str, float], dict[str, float]]]:
    """Yield starts and parameters: corners, then drawn."""
    spans = dict(problem.start) if rest is None else _near(problem, rest)
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
    """Return runs from corners of the starts and from within them, as `simulate` gives them.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    duration : float
        s.
    count : int
        How many at most.
    """
    claim = LoopClaim("", output="", when="during", end=duration)
    begun = _starts(problem, claim)
    runs = (run_of(problem, *start, claim, duration=duration) for start in islice(begun, count))
    return [run for run in runs if run is not None]


def _near(problem: LoopProblem, rest: Mapping[str, float]) -> dict[str, Interval]:
    """Return starts next to rest: by a thousandth of what a sensor sees, where there is one."""
    interface = problem.site.interface
    spans = {name: Interval(rest[name], rest[name]) for name in problem.states}
    for (_, name), port in interface.outputs.items():
        if name in spans:
            wide = port.high - port.low
            off = 1e-3 * (wide if math.isfinite(wide) else 1.0)
            spans[name] = Interval(rest[name] - off, rest[name] + off)
    return spans


def run_of(
    problem: LoopProblem,
    start: Mapping[str, float],
    values: Mapping[str, float],
    claim: LoopClaim | None = None,
    *,
    steps: int = 1,
    duration: float = 0.0,
) -> Run | None:
    """Return a run of a loop; None if there is none.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    start, values : mapping of str to float
        By state and by parameter.
    claim : LoopClaim, optional
        Of which it is to tell something.
    steps : int, optional
        How many times as many steps the integrator takes, to confirm another run.
    duration : float, optional
        s; by default as long as the plant or the claim says.
    """
    plant = problem.plant
    if values:
        plant = with_parameters(plant, values)
    plant = starting_at(plant, [start[name] for name in problem.states])
    if steps > 1:
        plant.longest_step = min(plant.longest_step, problem.period) / steps
    interface = problem.site.interface
    references = {
        interface.label(port): value
        for port, value in problem.set_point.items()
        if not interface.references[port].order and port in interface.outputs
    }
    duration = duration or plant.duration or 1000 * problem.period
    if claim is None:
        pass
    elif claim.output and claim.when == "during" and math.isfinite(claim.end):
        duration = claim.end + problem.period  # the sample at the end counts
    elif claim.begin:
        duration = max(duration, 1.5 * claim.begin)
    try:
        return simulate(
            problem.text,
            plant,
            reference=references,
            duration=max(duration, 2 * problem.period * problem.text.model.every),
            options=Options(
                sensors={".".join(port): sensor for port, sensor in problem.sensors.items()}
            ),
            connect=problem.site.connect,
        )
    except FuzzyarmError:
        return None


def _breach(
    problem: LoopProblem,
    claim: LoopClaim,
    run: Run,
    rest: Mapping[str, float] | None,
    other: Run | None = None,
) -> str:
    """Return in words how a run breaks a claim, by more than it differs from another one."""
    divergence = f"the run diverges after {run.diverged or 0.0:.4g} s: {run.cause}"
    if claim.output:
        k = _first_outside(problem, claim, run, other)
        if k is not None:
            port = claimed_port(problem, claim)
            return f"{port} = {_values(run, port)[k]:.6g} after {run.time[k]:.6g} s"
        inside = run.diverged is not None and claim.begin <= run.diverged <= claim.end
        return divergence if inside else ""
    if run.diverged is not None:
        return divergence
    # Of a start that is not next to rest no run tells: it may be on its way.
    return "" if claim.start or rest is None else _unrest(problem, run, rest)


def _values(run: Run, port: str) -> NDArray[np.float64]:
    return np.asarray(run.outputs[port] if port in run.outputs else run.drives[port], float)


def _first_outside(
    problem: LoopProblem, claim: LoopClaim, run: Run, other: Run | None = None
) -> int | None:
    """Return the first sample outside the claimed interval in the claimed time."""
    port = claimed_port(problem, claim)
    values = _values(run, port)
    slack = np.full(len(values), 1e-9 * (claim.high - claim.low))
    if other is not None:
        near = _values(other, port)[: len(values)]
        slack[: len(near)] += np.abs(values[: len(near)] - near)
    in_time = (run.time >= claim.begin - 1e-9) & (run.time <= claim.end + 1e-9)
    wrong = in_time & ((values > claim.high + slack) | (values < claim.low - slack))
    return int(np.argmax(wrong)) if wrong.any() else None


def _unrest(problem: LoopProblem, run: Run, rest: Mapping[str, float]) -> str:
    """Return which output swings far from rest, next to which it began, and goes on doing so."""
    interface = problem.site.interface
    for address, port in interface.outputs.items():
        name, label = address[1], interface.label(address)
        if label not in run.outputs or name not in rest:
            continue
        wide = port.high - port.low
        far = 0.05 * (wide if math.isfinite(wide) else 50.0)
        off = np.abs(np.asarray(run.outputs[label]) - rest[name])
        third = len(off) // 3
        if not third:
            continue
        before, last = off[third : 2 * third].max(), off[-third:].max()
        # Far away and not fading: what comes to rest slowly is not held against the loop.
        if last > far and last > 0.9 * before:
            return (
                f"{label} is up to {last:.4g} away from rest in the last third of"
                f" {run.time[-1]:.4g} s, from {off[0]:.4g}"
            )
    return ""
