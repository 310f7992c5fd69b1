"""Runs as witnesses against a proved region, by independent code.

A certificate rests on the checker's derivation of the loop. The kernel of ``simulate`` shares only
the controller's instructions and the plant with it. So before a verdict *proved*, runs start at the
border of the region, and V must fall along them. They prove nothing; a contradiction is a fault of
fuzzyarm.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np

from fuzzyarm.control.loop.run import Run
from fuzzyarm.proof.check.certificate import RegionProof
from fuzzyarm.proof.check.loop import CheckedLoop
from fuzzyarm.proof.check.numbers import exact
from fuzzyarm.proof.check.region import has_known_start, start_quadric
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.loop.runs import converged, run_in_time, run_of
from fuzzyarm.proof.stop import Stop

RestWith = Callable[[Mapping[str, float]], Mapping[str, Fraction]]

WITNESSES = 12
"""Number of runs, from the border of the starts in random directions."""

PERIODS = 200
"""Control periods of each run."""

SLACK = 1e-6
"""Tolerance for the integrator of a run, as a share of the region."""


def contradiction(
    problem: LoopProblem,
    of_all: CheckedLoop,
    certificate: RegionProof,
    stop: Stop | None = None,
    rest_with: RestWith | None = None,
) -> str:
    """Return a run that contradicts a region accepted by the checker; empty if none did.

    Only a region of the sampled loop has runs. `rest_with` gives the rest for values of parameters,
    by default the middle for all. TimeOverError: `stop` is over.
    """
    stop = stop or Stop()
    if certificate.continuous:
        return ""
    p = np.array([[float(x) for x in row] for row in certificate.p])
    reach = np.sqrt(float(certificate.growth) * np.maximum(np.diag(np.linalg.inv(p)), 0.0))
    falls = certificate.growth == 1  # else the functions of cones fall
    duration = PERIODS * problem.period
    for start, values, loop in _starts(problem, of_all, certificate, rest_with):
        stop.check()
        run = run_in_time(
            problem, start, values, duration, stop,
            partial(_against, problem, loop, p=p, reach=reach, falls=falls),
        )  # fmt: skip
        if run is None:
            continue
        against = _against(problem, loop, run, p=p, reach=reach, falls=falls)
        if against:  # unless a finer integration agrees with V
            pair = converged(partial(_finer, problem, start, values, float(run.time[-1])), stop)
            if pair is not None:
                against = _against(problem, loop, pair[1], p=p, reach=reach, falls=falls)
        if against:
            words = ", ".join(f"{name} = {x:.6g}" for name, x in {**start, **values}.items())
            return f"the run from {words} {against}"
    return ""


def _finer(
    problem: LoopProblem,
    start: Mapping[str, float],
    values: Mapping[str, float],
    duration: float,
    steps: int,
) -> Run | None:
    return run_of(problem, start, values, steps=steps, duration=duration)


def _starts(
    problem: LoopProblem, loop: CheckedLoop, certificate: RegionProof,
    rest_with: RestWith | None,
) -> Iterator[tuple[dict[str, float], dict[str, float], CheckedLoop]]:  # fmt: skip
    """Yield starts at the border of the region's starts, parameters, and the loop with these."""
    names = problem.states
    if not has_known_start(problem, loop):
        return
    generator = np.random.default_rng(0)
    free = {n: span for n, span in problem.parameters.items() if span.low < span.high}
    for _ in range(WITNESSES):
        way = generator.standard_normal(len(names))
        way /= np.linalg.norm(way)
        values = {n: float(generator.choice([span.low, span.high])) for n, span in free.items()}
        if values and rest_with is not None:
            at_rest = {name: exact(x) for name, x in rest_with(values).items()}
            loop = replace(loop, rest=at_rest)
        quadratic, linear, constant = start_quadric(problem, loop, certificate.p, range(len(names)))
        centre = -0.5 * np.linalg.solve(quadratic, linear)
        level = -(constant + 0.5 * float(linear @ centre))
        if level <= 0.0:
            return
        root = np.linalg.inv(np.linalg.cholesky(quadratic)).T
        rest = np.array([float(loop.rest[name]) for name in names])
        at = rest + centre + 0.9999 * math.sqrt(level) * (root @ way)
        yield dict(zip(names, map(float, at), strict=True)), values, loop


def _against(
    problem: LoopProblem, loop: CheckedLoop, run: Run, *, p: Vector, reach: Vector, falls: bool
) -> str:
    """Return an event of a run that no run from the region can have."""
    if run.diverged is not None:
        return f"diverges after {run.diverged:.4g} s"
    course: Mapping[str, Vector] = _states_of(problem, run)
    for name, values in course.items():
        far = np.abs(values - float(loop.rest[name])).max() / reach[loop.names.index(name)]
        if not far <= 1.0 + SLACK:  # or NaN: its steps are too long
            return f"leaves the region: {name} goes {far:.4g} times beyond its reach"
    if not falls or set(course) != set(loop.names):  # a run does not show memory
        return ""
    z = np.array([course[name] - float(loop.rest[name]) for name in loop.names]).T
    level = np.einsum("ki,ij,kj->k", z, p, z)
    if (np.diff(level) > SLACK).any():
        return f"lets V rise from {level[int(np.argmax(np.diff(level)))]:.6g}"
    return ""


def _states_of(problem: LoopProblem, run: Run) -> dict[str, Vector]:
    """Return the plant's states that are outputs, at all samples."""
    interface = problem.site.interface
    key_of = dict(zip(problem.equations.states, problem.states, strict=True))
    states = {}
    for port, root in zip(interface.outputs, problem.equations.outputs, strict=True):
        state = key_of.get(getattr(root, "name", ""))
        if state is not None and not problem.sensors:
            states[state] = np.asarray(run.outputs[interface.label(port)])
    return states
