"""The picture of a proved region: its outline, runs in it, and their rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Options
from fuzzyarm.control.loop.run import Run
from fuzzyarm.control.loop.simulation import simulate
from fuzzyarm.plant.own import starting_at
from fuzzyarm.plant.plant import Plant, with_actuators
from fuzzyarm.proof.check.certificate import RegionProof
from fuzzyarm.proof.check.loop import CheckedLoop
from fuzzyarm.proof.check.region import has_known_start, start_quadric, verified
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.claim.text import claimed_plant, problem_of
from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.loop.verdicts import LoopVerdict

RUNS, GRID = 10, 13


@dataclass(frozen=True, eq=False)
class RegionPlane:
    """A proved region in the plane of two states of the plant."""

    names: tuple[str, str]  # names, units: of both states
    units: tuple[str, str]
    shadow: Vector  # outline of the region's projection; shape (n, 2)
    # Outline of the proved starts, with the other states at rest. Empty if the region contains
    # none, or does not cover the initial memory of the controller; shape (n, 2)
    start: Vector
    runs: tuple[Vector, ...]  # runs from the border of those starts; shape (m, 2)
    # settled, lost: starts on a grid with runs that settle within the duration, and the others;
    # shape (k, 2)
    settled: Vector
    lost: Vector
    # Proved share of the settled ones; None if memory has its own start
    covered: float | None


def region_planes(
    text: ControllerText, verdict: LoopVerdict, plant: Plant | None = None
) -> list[RegionPlane]:
    """Return the planes of a proved region: of the first two states, and of the next two."""
    certificate = verdict.certificate
    if certificate is None or not certificate.regions:
        return []
    plant = claimed_plant(certificate.claim) if plant is None else plant
    problem = problem_of(
        text,
        certificate.claim,
        plant=with_actuators(plant, {}, certificate.delays) if certificate.delays else plant,
        sensors=certificate.sensors,
        connect=certificate.connect,
    )
    against, _, loop = verified(problem, certificate.claim, certificate.region)
    if against or loop is None:
        return []
    states = list(problem.states)
    pairs = [(0, 1), (2, 3)] if len(states) > 3 else [(0, 1), (1, 2)][: max(1, len(states) - 1)]
    return [_plane(problem, loop, verdict, *pair) for pair in pairs if len(states) > 1]


def _plane(
    problem: LoopProblem, loop: CheckedLoop, verdict: LoopVerdict, first: int, second: int
) -> RegionPlane:
    certificate = verdict.certificate
    assert certificate is not None
    region = certificate.region
    names = (problem.states[first], problem.states[second])
    rest = np.array([float(loop.rest[name]) for name in problem.states])
    middle = rest[[first, second]]
    p = np.array([[float(x) for x in row] for row in region.p])
    # The projection of zᵀ P z ≤ 1 on two coordinates has the inverse of their block of P⁻¹.
    shadow = np.linalg.inv(np.linalg.inv(p)[np.ix_([first, second], [first, second])])
    angle = np.linspace(0.0, 2.0 * math.pi, 181)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    root = np.linalg.inv(np.linalg.cholesky(shadow)).T
    outline = (root @ circle).T + middle
    start, within = _starts(problem, loop, region, (first, second), circle)
    runs = []
    for way in start[:: max(1, len(start) // RUNS)][:RUNS]:
        run = _run(problem, _at(rest, first, second, middle + 0.999 * way))
        runs.append(np.stack([_state(problem, run, name) for name in names], axis=1))
    half = _window(problem, names, outline - middle)
    ticks = np.linspace(-1.0, 1.0, GRID)
    grid = np.array([(x, y) for x in ticks for y in ticks]) * half
    settled = np.array(
        [_settles(problem, _at(rest, first, second, middle + z), rest) for z in grid], bool
    )
    covered = None
    if within is not None:
        proved = np.array([within(z) for z in grid])
        covered = float((proved & settled).sum() / max(1, settled.sum()))
    units = [problem.plant.states[name] for name in names]
    return RegionPlane(
        names, (units[0], units[1]), outline, start + middle, tuple(runs),
        grid[settled] + middle, grid[~settled] + middle, covered,
    )  # fmt: skip


def _starts(
    problem: LoopProblem,
    loop: CheckedLoop,
    region: RegionProof,
    plane: tuple[int, int],
    circle: Vector,
) -> tuple[Vector, Callable[[Vector], bool] | None]:
    """Return the outline of the proved starts in a plane, and a test of a single start."""
    if not has_known_start(problem, loop):
        return np.zeros((0, 2)), None
    quadratic, linear, constant = start_quadric(problem, loop, region.p, plane)

    def within(z: Vector) -> bool:
        return bool(z @ quadratic @ z + linear @ z + constant <= 0.0)

    return _outline(quadratic, linear, constant, circle), within


def _outline(quadratic: Vector, linear: Vector, constant: float, circle: Vector) -> Vector:
    """Return the border of ``zᵀQz + l z + c ≤ 0``; no points if that is empty."""
    # By completing the square; L⁻ᵀ with Q = L Lᵀ maps the unit circle to the border.
    centre = -0.5 * np.linalg.solve(quadratic, linear)
    level = -(constant + 0.5 * float(linear @ centre))
    if level <= 0.0:
        return np.zeros((0, 2))
    root = np.linalg.inv(np.linalg.cholesky(quadratic)).T
    return np.asarray(centre + math.sqrt(level) * (root @ circle).T)


def _at(rest: Vector, first: int, second: int, values: Vector) -> Vector:
    states = rest.copy()
    states[[first, second]] = values
    return states


def _window(problem: LoopProblem, names: tuple[str, str], outline: Vector) -> Vector:
    """Return the half-width of the picture for each state: the sensors' range, within reason."""
    far = np.abs(outline).max(axis=0)
    ports = {name: port for (_, name), port in problem.site.interface.outputs.items()}
    window = []
    for name, reach in zip(names, far, strict=True):
        port = ports.get(name)
        half = 0.5 * (port.high - port.low) if port is not None else math.inf
        window.append(min(half, 2.5 * reach) if half > reach else 1.1 * reach)
    return np.array(window)


def _run(problem: LoopProblem, states: Vector) -> Run:
    plant = starting_at(problem.plant, [float(x) for x in states])
    sensors = {".".join(port): sensor for port, sensor in problem.sensors.items()}
    return simulate(
        problem.text,
        plant,
        reference=problem.signals_by_name,
        duration=plant.duration or 1000 * problem.period,
        options=Options(sensors=sensors),
        connect=problem.site.connect,
    )


def _state(problem: LoopProblem, run: Run, name: str) -> Vector:
    interface = problem.site.interface
    for address in interface.outputs:
        if address[1] == name:
            return np.asarray(run.outputs[interface.label(address)])
    return np.full(len(run.time), np.nan)


def _settles(problem: LoopProblem, states: Vector, rest: Vector) -> bool:
    """Return whether a run covers 9/10 of its way to rest, or comes within 0.001 of the ranges."""
    run = _run(problem, states)
    if run.diverged is not None:
        return False
    distance = begun = 0.0
    for (_, name), port in problem.site.interface.outputs.items():
        if name not in problem.states:
            continue
        k = problem.states.index(name)
        wide = port.high - port.low if math.isfinite(port.high - port.low) else 1.0
        values = _state(problem, run, name)
        distance = max(distance, abs(values[-1] - rest[k]) / wide)
        begun = max(begun, abs(states[k] - rest[k]) / wide)
    return distance <= max(0.1 * begun, 1e-3)
