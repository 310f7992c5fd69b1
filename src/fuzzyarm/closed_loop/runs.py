"""Runs that try to refute a claim about a loop, as ``simulate`` gives them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import islice, product
from typing import NamedTuple

import numpy as np

from fuzzyarm.closed_loop.claims import claimed_port
from fuzzyarm.closed_loop.problem import LoopProblem
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

__all__ = ["Breach", "refuting_run", "run_of", "sampled_runs"]


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
    for number, (start, values) in enumerate(_starts(problem, claim, rest if at_rest else None)):
        if number and stop is not None and stop.now:
            return None
        run = run_of(problem, start, values, claim)
        if run is None:
            return None
        if not _breach(problem, claim, run, rest):
            continue
        # It might be a breach of the integrator only.
        sure = _converged(problem, claim, start, values)
        against = "" if sure is None else _breach(problem, claim, sure, rest)
        if sure is None or not against:
            continue
        free = {n: x for n, x in values.items() if len(set(problem.parameters[n])) > 1}
        words = ", ".join(f"{name} = {number_text(x)}" for name, x in {**start, **free}.items())
        return Breach(sure, (f"from {words}", against))
    return None


FINER = (1, 4, 16, 64, 256)
"""Into how many steps a period is cut, one after another, until two runs agree."""

AGREED = 1e-3
"""By what share of how far a run has been two runs of different steps may differ."""


def _converged(
    problem: LoopProblem,
    claim: LoopClaim,
    start: Mapping[str, float],
    values: Mapping[str, float],
) -> Run | None:
    """Return a run whose integrator is right, as far as two of different steps can tell."""
    coarse: Run | None = None
    for steps in FINER:
        fine = run_of(problem, start, values, claim, steps=steps)
        if fine is None:
            return None
        if coarse is not None and _agree(coarse, fine):
            return fine
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
        duration = claim.end
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
    problem: LoopProblem, claim: LoopClaim, run: Run, rest: Mapping[str, float] | None
) -> str:
    """Return in words how a run breaks a claim; empty where it does not."""
    divergence = f"the run diverges after {run.diverged or 0.0:.4g} s: {run.cause}"
    if claim.output:
        return _outside(problem, claim, run, divergence)
    if run.diverged is not None:
        return divergence
    # Of a start that is not next to rest no run tells: it may be on its way.
    return "" if claim.start or rest is None else _unrest(problem, run, rest)


def _outside(problem: LoopProblem, claim: LoopClaim, run: Run, lost: str) -> str:
    """Return where an output is outside the claimed interval in the claimed time."""
    port = claimed_port(problem, claim)
    values = np.asarray(run.outputs[port] if port in run.outputs else run.drives[port])
    in_time = (run.time >= claim.begin - 1e-9) & (run.time <= claim.end + 1e-9)
    slack = 1e-9 * (claim.high - claim.low)
    wrong = in_time & ((values > claim.high + slack) | (values < claim.low - slack))
    if wrong.any():
        k = int(np.argmax(wrong))
        return f"{port} = {values[k]:.6g} after {run.time[k]:.6g} s"
    inside = run.diverged is not None and claim.begin <= run.diverged <= claim.end
    return lost if inside else ""


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
