"""Scenarios for tuning and for the judgement: moves, loads, noise, seeds.

Scenarios are drawn from a seed, so that a larger set begins with the same ones. Those of the
judgement come from another stream of the generator: none occurs in tuning.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.loop.along import FollowedPlant, way_of
from fuzzyarm.control.loop.course import Motion, Options, Sensor
from fuzzyarm.control.loop.reference import Signal
from fuzzyarm.control.loop.run import plant_motion, stepped
from fuzzyarm.control.loop.sweep import Range, drawn
from fuzzyarm.plant.following import (
    LARGEST,
    SMALLEST,
    at_rest,
    carries,
    compared_trajectories,
    drawn_trajectory,
)
from fuzzyarm.plant.plant import Plant, interface_of
from fuzzyarm.plant.trajectory import Trajectory

TRAIN, UNSEEN = 0, 1
"""Streams of the generator."""

HEAVIEST = 1.3
"""Largest random load, as a share of the plant's."""

NOISES = (1e-5, 1e-4, 1e-3, 1e-2)
"""Standard deviations of the noise in the judgement, as shares of the range of each sensor."""


@dataclass(frozen=True)
class Scenario:
    """One run of many.

    Attributes
    ----------
    name : str
        For reports.
    on : Trajectory, Plant or Motion
        A trajectory, a plant with references or a motion; a trajectory alone is the arm's.
    changes : mapping of str to float
        Load, parameters of the plant, noise, seed; see :func:`fuzzyarm.control.loop.simulate_many`.
    along : Trajectory, optional
        Trajectory of the plant; by default its first one.
    """

    name: str
    on: Trajectory | Plant | Motion
    changes: Mapping[str, float] = field(default_factory=dict)
    along: Trajectory | None = None

    @property
    def way(self) -> FollowedPlant | Motion:
        """Plant and trajectory, or set points."""
        return way_of(self.on, self.along)


@dataclass(frozen=True)
class Stage:
    """The common part of all scenarios, and the distribution of the rest.

    Attributes
    ----------
    plant : Plant
        Where the controller runs.
    first : tuple of Scenario
        Explicitly requested ones; random ones follow.
    options : Options
        Sensors, integrator, limits, seed.
    vary : tuple of Range
        Ranges of the random quantities, besides the move.
    references : mapping of str to Signal, optional
        References of a plant, scaled in random scenarios.
    duration : float, optional
        Duration of a run on a plant, s.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant.
    """

    plant: Plant
    first: tuple[Scenario, ...]
    options: Options = field(default_factory=Options)
    vary: tuple[Range, ...] = ()
    references: Mapping[str, Signal] | None = None
    duration: float | None = None
    connect: Mapping[str, str] | None = None

    @property
    def along(self) -> bool:
        """Whether scenarios follow trajectories of the plant, and not references."""
        ways = [scenario.way for scenario in self.first]
        return bool(ways) and all(isinstance(way, FollowedPlant) and way.trajectory for way in ways)

    def noisy(self, share: float = NOISES[0]) -> Stage:
        """Return the stage with noise on every noiseless sensor of known range.

        Parameters
        ----------
        share : float
            The standard deviation, by the range of the sensor.
        """
        given = self.options.sensors
        interface = interface_of(self.plant)
        # A sensor named by its port alone means that of every axis.
        sensors = {
            name: sensor
            for name, sensor in given.items()
            if all(name != port[1] for port in interface.outputs)
        }
        for port, output in interface.outputs.items():
            label, width = interface.label(port), output.high - output.low
            sensor = given.get(label, given.get(port[1]))
            if math.isfinite(width) and (sensor is None or sensor.noise == 0.0):
                sensors[label] = replace(sensor or Sensor(), noise=share * width)
            elif sensor is not None:
                sensors[label] = sensor
        return replace(self, options=replace(self.options, sensors=sensors))

    @property
    def has_noise(self) -> bool:
        """Whether its own sensors have any."""
        return any(sensor.noise > 0.0 for sensor in self.options.sensors.values())


def plant_scenarios(plant: Plant, payload: float = 1.0) -> tuple[Scenario, ...]:
    """Return the trajectories by which a plant has controllers compared, with its load."""
    return tuple(
        scenario_along(plant, trajectory, payload) for trajectory in compared_trajectories(plant)
    )


def scenario_along(plant: Plant, trajectory: Trajectory, payload: float = 1.0) -> Scenario:
    """Return a trajectory of a plant, with its load, if any."""
    changes = {"payload": payload} if payload and _is_loaded(plant, trajectory) else {}
    return Scenario(trajectory.name, plant, changes, trajectory)


def _is_loaded(plant: Plant, trajectory: Trajectory) -> bool:
    """Whether a plant that carries a load does so on a trajectory."""
    return carries(plant) and any(trajectory.loaded)


def train_scenarios(stage: Stage, count: int, controller: Controller) -> tuple[Scenario, ...]:
    """Return `count` scenarios: requested ones first, then random ones."""
    more = _drawn(stage, max(0, count - len(stage.first)), controller, TRAIN)
    return (*stage.first[: max(count, 1)], *more)


def unseen_scenarios(stage: Stage, count: int, controller: Controller) -> tuple[Scenario, ...]:
    """Return `count` scenarios that differ from all others."""
    return _drawn(stage, count, controller, UNSEEN)


def _drawn(stage: Stage, count: int, controller: Controller, stream: int) -> tuple[Scenario, ...]:
    if not count:
        return ()
    seed = stage.options.seed
    varied = drawn(stage.vary, count, seed + 1_000_003 * stream)
    scenarios = []
    for at in range(count):
        # A generator for each scenario: the first ones do not depend on their number.
        generator = np.random.default_rng([seed, stream, at])
        changes = {name: float(values[at]) for name, values in varied.items()}
        # Each run has its own seed of noise; the streams never coincide.
        changes.setdefault("seed", float(seed + 100_000 * (stream + 1) + at))
        if stage.along:
            scenarios.append(_move(stage.plant, generator, changes, at))
        else:
            scenarios.append(_scaled(stage, generator, changes, controller, at))
    return tuple(scenarios)


def _move(
    plant: Plant, generator: np.random.Generator, changes: dict[str, float], at: int
) -> Scenario:
    """Draw a trajectory of a plant, and a load, if it carries one."""
    way = replace(drawn_trajectory(plant, generator), name=f"move {at + 1}")
    name = f"{at + 1}: {way.words}"
    if _is_loaded(plant, way):
        changes.setdefault("payload", round(float(generator.uniform(0.0, HEAVIEST)), 3))
        name += f", load {changes['payload']:g}"
    return Scenario(name, plant, changes, way)


def _scaled(
    stage: Stage,
    generator: np.random.Generator,
    changes: dict[str, float],
    controller: Controller,
    at: int,
) -> Scenario:
    """Draw a scale of the references of a plant."""
    scale = float(np.round(generator.uniform(SMALLEST, LARGEST), 3))
    resting, interface = at_rest(stage.plant), interface_of(stage.plant)
    references = {
        name: scaled(signal, scale, resting.get(interface.port(name), 0.0))
        for name, signal in (stage.references or {}).items()
    }
    if not references:
        references = stepped(controller, stage.plant, scale, connect=stage.connect)
    motion = plant_motion(controller, stage.plant, references, stage.duration, stage.connect)
    text = ", ".join(f"{name} {value:.4g}" for name, value in changes.items() if name != "seed")
    return Scenario(f"{at + 1}: {motion.name}{', ' if text else ''}{text}", motion, changes)


def scaled(signal: Signal, scale: float, resting: float) -> Signal:
    """Return a reference with moves scaled about the plant's rest position.

    A file is unchanged, and of a sine only the amplitude is scaled.
    """
    numbers = list(signal.numbers)
    if signal.kind in ("step", "quintic"):
        begin = numbers[2] if len(numbers) > 2 else resting
        numbers[0] = begin + (numbers[0] - begin) * scale
    elif signal.kind in ("ramp", "sine"):
        numbers[0] *= scale
    return replace(signal, numbers=tuple(numbers))
