"""Runs as witnesses against a proved region: other code than that which proved it.

A certificate stands on the form of the loop (:mod:`fuzzyarm.closed_loop.form_maker`), which search
and checker read alike: a mistake there would not be seen by either. The kernel that ``simulate``
runs shares nothing with the form but the file of the controller and the plant. So before *proved*
is said of a region, runs begin at its border, and V must fall along them. They prove nothing; one
that contradicts says that fuzzyarm is wrong.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.closed_loop.certificate import Certificate
from fuzzyarm.closed_loop.form import Form
from fuzzyarm.closed_loop.form_maker import FormMaker
from fuzzyarm.closed_loop.runs import run_of
from fuzzyarm.closed_loop.verification import start_quadric
from fuzzyarm.loop.run import Run

__all__ = ["WITNESSES", "contradiction"]

Vector = NDArray[np.float64]

WITNESSES = 12
"""Runs; at the border of the starts, in directions that are drawn."""

PERIODS = 200
"""Control periods that each of them lasts."""

SLACK = 1e-6
"""Share of the region by which the integrator of a run may be off."""


def contradiction(maker: FormMaker, certificate: Certificate, count: int = WITNESSES) -> str:
    """Return which run contradicts a region that is as good as proved; empty: none of some did.

    Parameters
    ----------
    maker : FormMaker
        Of the loop.
    certificate : Certificate
        Of the loop as sampled; of continuous time nothing is asked.
    count : int, optional
        How many runs.
    """
    if certificate.continuous:
        return ""
    form = maker.form(certificate.choice)
    p = np.array([[float(x) for x in row] for row in certificate.p])
    reach = np.sqrt(np.maximum(np.diag(np.linalg.inv(p)), 0.0))
    for start, values in _starts(maker, form, certificate, count):
        run = run_of(maker.problem, start, values, duration=PERIODS * maker.problem.period)
        if run is None:
            continue
        against = _against(maker, form, run, p, reach)
        if against:
            words = ", ".join(f"{name} = {x:.6g}" for name, x in {**start, **values}.items())
            return f"the run from {words} {against}"
    return ""


def _starts(
    maker: FormMaker, form: Form, certificate: Certificate, count: int
) -> Iterator[tuple[dict[str, float], dict[str, float]]]:
    """Yield starts at the border of those that the region holds, and parameters."""
    names = maker.problem.states
    quadratic, linear, constant = start_quadric(maker, form, certificate.p, range(len(names)))
    centre = -0.5 * np.linalg.solve(quadratic, linear)
    level = -(constant + 0.5 * float(linear @ centre))
    if level <= 0.0:
        return
    root = np.linalg.inv(np.linalg.cholesky(quadratic)).T
    rest = np.array([float(form.rest[name]) for name in names])
    generator = np.random.default_rng(0)
    open_ = {n: span for n, span in maker.problem.parameters.items() if span.low < span.high}
    for _ in range(count):
        way = generator.standard_normal(len(names))
        way /= np.linalg.norm(way)
        at = rest + centre + 0.9999 * math.sqrt(level) * (root @ way)
        values = {n: float(generator.choice([span.low, span.high])) for n, span in open_.items()}
        yield dict(zip(names, map(float, at), strict=True)), values


def _against(maker: FormMaker, form: Form, run: Run, p: Vector, reach: Vector) -> str:
    """Return what a run did that no run from the region does."""
    if run.diverged is not None:
        return f"diverges after {run.diverged:.4g} s"
    course: Mapping[str, Vector] = _states_of(maker, run)
    for name, values in course.items():
        far = np.abs(values - float(form.rest[name])).max() / reach[form.names.index(name)]
        if far > 1.0 + SLACK:
            return f"leaves the region: {name} goes {far:.4g} times as far as it reaches"
    if set(course) != set(form.names):  # memory is not seen in a run
        return ""
    z = np.array([course[name] - float(form.rest[name]) for name in form.names]).T
    level = np.einsum("ki,ij,kj->k", z, p, z)
    if (np.diff(level) > SLACK).any():
        return f"lets V rise from {level[int(np.argmax(np.diff(level)))]:.6g}"
    return ""


def _states_of(maker: FormMaker, run: Run) -> dict[str, Vector]:
    """Return the states of the plant that are outputs, at all samples."""
    problem = maker.problem
    interface = problem.site.interface
    key_of = dict(zip(problem.equations.states, problem.states, strict=True))
    found = {}
    for port, root in zip(interface.outputs, problem.equations.outputs, strict=True):
        state = key_of.get(getattr(root, "name", ""))
        if state is not None and not problem.sensors:
            found[state] = np.asarray(run.outputs[interface.label(port)])
    return found
