"""A Gymnasium environment as a plant: observations are outputs, actions inputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from fuzzyarm.base.errors import demand_extra
from fuzzyarm.plant.plant import Plant, PlantError, Port

# --- Names missing in the environments ---


@dataclass(frozen=True)
class SpaceNames:
    """Names of the quantities of an environment.

    Attributes
    ----------
    outputs : mapping of str to str
        Name and unit of each observation, in order.
    inputs : mapping of str to Port
        Port of each action, in order; a discrete one has a range divided by thresholds.
    rates : mapping of str to str
        Outputs that are rates of other outputs.
    angles : mapping of str to (str, str)
        Additional outputs: the angle of a cosine and a sine.
    """

    outputs: Mapping[str, str]
    inputs: Mapping[str, Port]
    rates: Mapping[str, str] = field(default_factory=dict)
    angles: Mapping[str, tuple[str, str]] = field(default_factory=dict)


# Both poles have the names of the plant `cartpole`, so that a controller runs on all.
_POLE = {"v": "x", "omega": "theta"}
ENVIRONMENTS: dict[str, SpaceNames] = {
    "CartPole": SpaceNames(
        {"x": "m", "v": "m/s", "theta": "rad", "omega": "rad/s"},
        {"f": Port("N", -10.0, 10.0)},
        _POLE,
    ),
    "InvertedPendulum": SpaceNames(
        {"x": "m", "theta": "rad", "v": "m/s", "omega": "rad/s"},
        {"f": Port("100 N", -3.0, 3.0)},
        _POLE,
    ),
    "Pendulum": SpaceNames(
        {"cos": "1", "sin": "1", "omega": "rad/s"},
        {"torque": Port("N m", -2.0, 2.0)},
        {"omega": "theta"},
        {"theta": ("cos", "sin")},
    ),
    "Acrobot": SpaceNames(
        {"cos1": "1", "sin1": "1", "cos2": "1", "sin2": "1", "omega1": "rad/s", "omega2": "rad/s"},
        {"torque": Port("N m", -1.0, 1.0)},
        {"omega1": "theta1", "omega2": "theta2"},
        {"theta1": ("cos1", "sin1"), "theta2": ("cos2", "sin2")},
    ),
    "MountainCar": SpaceNames(
        {"position": "1", "velocity": "1"},
        {"force": Port("1", -1.0, 1.0)},
    ),
    "MountainCarContinuous": SpaceNames(
        {"position": "1", "velocity": "1"},
        {"force": Port("1", -1.0, 1.0)},
    ),
}
"""By the name of the environment without its version."""


# --- The plant ---


class EnvironmentPlant(Plant):
    """A Gymnasium environment as a plant.

    The end of an episode ends the run, but not a time limit: the run has the requested duration,
    by default that of the limit. A continuous action is a port with its limits. A discrete action
    is chosen by thresholds that divide the range of the port evenly: of two choices, the sign of
    the drive decides.

    Parameters
    ----------
    environment : str or gymnasium.Env
        An id, as ``CartPole-v1``, or an existing environment.

    Raises
    ------
    PlantError
        If there is no such environment, or its observations or actions are not numeric.
    MissingExtraError
        If Gymnasium is not installed.

    Examples
    --------
    >>> plant = EnvironmentPlant("CartPole-v1")
    >>> list(plant.outputs), list(plant.inputs), plant.longest_step
    (['x', 'v', 'theta', 'omega'], ['f'], 0.02)
    """

    def __init__(self, environment: Any) -> None:
        demand_extra("gymnasium", "plants", "a Gymnasium environment")
        self.environment = made(environment) if isinstance(environment, str) else environment
        unwrapped, spec = self.environment.unwrapped, self.environment.spec
        self.name = spec.id if spec is not None else type(unwrapped).__name__
        self.axis = "environment"
        size = _size(self.environment.observation_space, self.name)
        names = ENVIRONMENTS.get(self.name.rpartition("-v")[0]) or SpaceNames({}, {})
        observed = dict(names.outputs) or dict.fromkeys(_numbered("observation", size), "1")
        self._actions, self.inputs = _actions(self.environment.action_space, names, self.name)
        units = observed | dict.fromkeys(names.angles, "rad")
        self.outputs = {
            name: Port(unit, rate_of=names.rates.get(name, "")) for name, unit in units.items()
        }
        self.states = observed
        self._angles = [
            (list(observed).index(c), list(observed).index(s)) for c, s in names.angles.values()
        ]
        if self._angles:
            self.measure = self._with_angles
        self._period = _period(unwrapped)
        if self._period is not None:
            self.longest_step = self._period
        limit = _limit(spec)
        if limit is not None and self._period is not None:
            self.duration = limit * self._period
        self._observation: list[float] = []

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Begin an episode with the seed of the run; return the observation."""
        # The generator was created from that seed: `--seed 7` is `env.reset(seed=7)`.
        seed = getattr(rng.bit_generator.seed_seq, "entropy", None)
        random_seed = int(rng.integers(2**31))
        observed, _ = self.environment.reset(seed=seed if isinstance(seed, int) else random_seed)
        self.ended = False
        self._observation = _numbers(observed)
        return self._observation

    def step(self, t: float, x: Any, u: Any, p: Any, dt: float) -> Sequence[float]:
        """Advance by one step; return the observation."""
        if self._period is not None and not math.isclose(dt, self._period, rel_tol=1e-6):
            raise PlantError(
                f"{self.name} steps every {self._period:g} s, not every {dt:g} s",
                name=self.name,
                hint=f"period {1000 * self._period:g} ms, or a multiple of it",
            )
        if not self.ended:
            observed, _, terminated, truncated, _ = self.environment.step(self._actions(u))
            self.ended = bool(terminated or truncated)
            self._observation = _numbers(observed)
        return self._observation

    def _with_angles(self, t: float, x: Any, u: Any, p: Any) -> list[float]:
        return [*x, *(math.atan2(x[sine], x[cosine]) for cosine, sine in self._angles)]


def made(name: str) -> Any:
    """Make an environment by its id, without its time limit."""
    import gymnasium

    try:
        return gymnasium.make(name, max_episode_steps=-1)
    except (gymnasium.error.Error, ImportError) as error:
        message = str(error).strip().splitlines()[0].rstrip(".")
        raise PlantError(f"no environment '{name}': {message}", name=name) from error


def _limit(spec: Any) -> int | None:
    """Return the number of steps of an episode by its id."""
    import gymnasium

    is_registered = spec is not None and spec.id in gymnasium.registry
    return gymnasium.registry[spec.id].max_episode_steps if is_registered else None


def _period(unwrapped: Any) -> float | None:
    """Return the time step, s, under the names used by environments."""
    for name in ("tau", "dt"):
        period = getattr(unwrapped, name, None)
        if isinstance(period, (int, float)) and period > 0:
            return float(period)
    frames = unwrapped.metadata.get("render_fps")
    return 1.0 / frames if frames else None


def _numbered(word: str, count: int) -> list[str]:
    return [word] if count == 1 else [f"{word}{index + 1}" for index in range(count)]


def _numbers(observed: Any) -> list[float]:
    return cast(list[float], np.asarray(observed, float).ravel().tolist())


def _size(space: Any, name: str) -> int:
    import gymnasium

    if not isinstance(space, gymnasium.spaces.Box):
        raise PlantError(f"the observations of {name} are not numbers: {space}", name=name)
    return int(np.prod(space.shape))


def _actions(
    space: Any, names: SpaceNames, name: str
) -> tuple[Callable[[Sequence[float]], Any], dict[str, Port]]:
    """Return a function from drives to an action, and the driven ports."""
    import gymnasium

    if isinstance(space, gymnasium.spaces.Discrete):
        ports = dict(names.inputs) or {"action": Port("1", -1.0, 1.0)}
        ((low, high),) = ((port.low, port.high) for port in ports.values())
        first, count = int(space.start), int(space.n)

        def choice(u: Sequence[float]) -> int:
            share = math.floor((u[0] - low) / (high - low) * count)
            return first + min(max(share, 0), count - 1)

        return choice, ports
    if not isinstance(space, gymnasium.spaces.Box):
        raise PlantError(
            f"the actions of {name} are neither numbers nor choices: {space}", name=name
        )
    lows, highs = _numbers(space.low), _numbers(space.high)
    ports = dict(names.inputs) or {
        word: Port("1", low, high)
        for word, low, high in zip(_numbered("action", len(lows)), lows, highs, strict=True)
    }

    def values(u: Sequence[float]) -> Any:
        return np.array(u, space.dtype).reshape(space.shape)

    return values, ports
