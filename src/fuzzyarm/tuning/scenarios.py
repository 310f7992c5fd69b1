"""What a controller is tuned on, and what it is judged by afterwards: moves, loads, noise, seeds.

Scenarios are drawn by a seed, so that more of them begin with the same ones. Those of the
judgement come from another stream of the generator: nothing that was tuned on is among them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from fuzzyarm.controller.controller import Controller
from fuzzyarm.loop.course import Motion, Options, Sensor
from fuzzyarm.loop.reference import Signal
from fuzzyarm.loop.run import plant_motion
from fuzzyarm.loop.sweep import Range, drawn
from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.own import start_of
from fuzzyarm.plant.plant import Plant, interface_of
from fuzzyarm.plant.trajectory import Trajectory, pick_and_place, reach_return, through

TRAIN, UNSEEN = 0, 1
"""Streams of the generator."""

HEAVIEST = 1.3
"""Largest load that is drawn, as a share of the study's."""

NOISE = 1e-5
"""Standard deviation of the noise by which is judged, as a share of the range of each sensor."""


@dataclass(frozen=True)
class Scenario:
    """One run of many.

    Attributes
    ----------
    name : str
        For reports.
    on : Trajectory or Motion
        What is followed.
    changes : mapping of str to float
        Load, parameters of the plant, noise, seed; see :func:`fuzzyarm.loop.simulate_many`.
    """

    name: str
    on: Trajectory | Motion
    changes: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Stage:
    """What all scenarios share, and how they are drawn.

    Attributes
    ----------
    plant : Plant
        Where the controller runs.
    first : tuple of Scenario
        Those that were asked for by name; drawn ones stand behind them.
    options : Options
        Sensors, integrator, limits, seed.
    vary : tuple of Range
        What differs from drawn scenario to drawn scenario, besides the move.
    references : mapping of str to Signal, optional
        Of a plant; drawn scenarios scale them.
    duration : float, optional
        Of a run on a plant, s.
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

    def noisy(self) -> Stage:
        """Return it with noise on every sensor that has none, as far as its range is known."""
        sensors = dict(self.options.sensors)
        interface = interface_of(self.plant)
        for port, output in interface.outputs.items():
            label, width = interface.label(port), output.high - output.low
            known = sensors.get(label, sensors.get(port[1], Sensor()))
            if known.noise == 0.0 and math.isfinite(width):
                sensors.pop(port[1], None)
                sensors[label] = replace(known, noise=NOISE * width)
        return replace(self, options=replace(self.options, sensors=sensors))

    @property
    def has_noise(self) -> bool:
        """Whether its own sensors have any."""
        return any(sensor.noise > 0.0 for sensor in self.options.sensors.values())


def arm_scenarios(payload: float = 1.0) -> tuple[Scenario, ...]:
    """Return the two trajectories of the study, with load."""
    changes = {"payload": payload} if payload else {}
    return (
        Scenario("reach-return", reach_return(), changes),
        Scenario("pick-and-place", pick_and_place(), changes),
    )


def train_scenarios(stage: Stage, count: int, controller: Controller) -> tuple[Scenario, ...]:
    """Return `count` scenarios: those asked for first, then drawn ones."""
    more = _drawn(stage, max(0, count - len(stage.first)), controller, TRAIN)
    return (*stage.first[: max(count, 1)], *more)


def unseen_scenarios(stage: Stage, count: int, controller: Controller) -> tuple[Scenario, ...]:
    """Return `count` scenarios that none of the others is."""
    return _drawn(stage, count, controller, UNSEEN)


def _drawn(stage: Stage, count: int, controller: Controller, stream: int) -> tuple[Scenario, ...]:
    if not count:
        return ()
    seed = stage.options.seed
    varied = drawn(stage.vary, count, seed + 1_000_003 * stream)
    found = []
    for at in range(count):
        generator = np.random.default_rng([seed, stream, at])
        changes = {name: float(values[at]) for name, values in varied.items()}
        # Each run has a seed of its own for its noise; those of the streams never meet.
        changes.setdefault("seed", float(seed + 100_000 * (stream + 1) + at))
        if isinstance(stage.plant, Arm):
            found.append(_move(generator, changes, at))
        else:
            found.append(_scaled(stage, generator, changes, controller, at))
    return tuple(found)


FARTHEST = 60.0
"""Largest angle of a way point that is drawn, degrees."""

PACES = (15.0, 25.0)
"""Mean speeds of the longest part of a drawn move, degrees a second; the study's moves have 18 and
22.5. Faster ones ask for more voltage than the motors have, and tell nothing of a controller."""


def _move(generator: np.random.Generator, changes: dict[str, float], at: int) -> Scenario:
    """Draw a move of the arm: two or three way points, a pace, a load."""
    points = np.round(generator.uniform(-FARTHEST, FARTHEST, (int(generator.integers(2, 4)), 2)))
    longest = np.abs(np.diff(points, axis=0, prepend=np.zeros((1, 2)))).max()
    duration = round(max(float(longest / generator.uniform(*PACES)), 1.0), 2)
    changes.setdefault("payload", round(float(generator.uniform(0.0, HEAVIEST)), 3))
    way = [(float(first), float(second)) for first, second in points]
    shown = ", ".join(f"({first:g}, {second:g})" for first, second in way)
    return Scenario(
        f"{at + 1}: {shown} in {duration:g} s each, load {changes['payload']:g}",
        through(way, duration, hold=0.5, name=f"move {at + 1}"),
        changes,
    )


SMALLEST, LARGEST = 0.5, 1.5
"""Between what drawn references are scaled."""


def _scaled(
    stage: Stage,
    generator: np.random.Generator,
    changes: dict[str, float],
    controller: Controller,
    at: int,
) -> Scenario:
    """Draw a scale of the references of a plant."""
    scale = float(np.round(generator.uniform(SMALLEST, LARGEST), 3))
    resting = at_rest(stage.plant)
    references = {
        name: scaled(signal, scale, resting.get(name, 0.0))
        for name, signal in (stage.references or {}).items()
    }
    made = plant_motion(
        controller,
        stage.plant,
        references or None,
        stage.duration,
        stage.connect,
        Signal("step", (scale,)),
    )
    told = ", ".join(f"{name} {value:.4g}" for name, value in changes.items() if name != "seed")
    return Scenario(f"{at + 1}: {made.name}{', ' if told else ''}{told}", made, changes)


def at_rest(plant: Plant) -> dict[str, float]:
    """Return the outputs of a plant at its start, as far as they are states, by port."""
    states = dict(zip(plant.states, start_of(plant, np.random.default_rng(0)), strict=True))
    interface = interface_of(plant)
    found = {}
    for port in interface.outputs:
        label = interface.label(port)
        if port[1] in states:
            found[label] = found[port[1]] = states[port[1]]
    return found


def scaled(signal: Signal, scale: float, resting: float = 0.0) -> Signal:
    """Return a reference whose way, from where the plant rests, has another size.

    One from a file stays as it is, and so does a sine but for its amplitude.
    """
    numbers = list(signal.numbers)
    if signal.kind in ("step", "quintic"):
        begin = numbers[2] if len(numbers) > 2 else resting
        numbers[0] = begin + (numbers[0] - begin) * scale
    elif signal.kind in ("ramp", "sine"):
        numbers[0] *= scale
    return replace(signal, numbers=tuple(numbers))
