"""Laws of the study on a robot with any number of joints.

The kernels of :mod:`.conventional` and :mod:`.adaptive` are for the two-link arm, where every
product is written out for machine code. Here the model is the plant's `inverse_dynamics`, and a law
is a few lines over arrays. Gains are those of the study, one number for all joints.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import UsageError
from fuzzyarm.control.controllers.controller import CompiledController, Controller
from fuzzyarm.control.controllers.law import Gain, GainError, unknown_gain

Vector = NDArray[np.float64]

EFFORTS = ("torque", "force")
"""Ports of a joint that a law drives."""


class InverseDynamics(Protocol):
    """The model of a robot in a controller."""

    def __call__(
        self, position: Vector, velocity: Vector, acceleration: Vector, along: Vector | None = None
    ) -> Vector:
        """Return ``M(q) a + C(q, v) w + D w + g(q)``; see `RobotPlant.inverse_dynamics`."""


class JointMoment(NamedTuple):
    """The observation of a law in one control period; arrays by joint, SI.

    Attributes
    ----------
    wanted, wanted_velocity, wanted_acceleration : ndarray, shape (n,)
        The set point.
    position, velocity : ndarray, shape (n,)
        As measured.
    last : bool
        Whether this is the last period of the set point.
    step : float
        The control period, s.
    """

    setpoint: Vector
    setpoint_velocity: Vector
    setpoint_acceleration: Vector
    position: Vector
    velocity: Vector
    last: bool
    step: float

    @property
    def error(self) -> Vector:
        """Position error."""
        return self.setpoint - self.position

    @property
    def rate(self) -> Vector:
        """Velocity error."""
        return self.setpoint_velocity - self.velocity


Numbers = Mapping[str, float]
Torques = Callable[[InverseDynamics, JointMoment, Numbers, Vector], Vector]
"""From model, observation, gains and memory to the torque of each joint, N m."""


class JointLaw(NamedTuple):
    """A law on all joints.

    Attributes
    ----------
    torques : callable
        See ``Torques``.
    memory : callable
        From the number of joints to the shape of the memory; it begins with zeros.
    """

    torques: Torques
    memory: Callable[[int], tuple[int, ...]] = lambda joints: (joints,)


def _pd(model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector) -> Vector:
    return k["K_D"] * now.rate + k["K_P"] * now.error


def _computed_torque(
    model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector
) -> Vector:
    feedback = now.setpoint_acceleration + _pd(model, now, k, memory)
    return model(now.position, now.velocity, feedback)


def _feed_forward_inverse(
    model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector
) -> Vector:
    ahead = model(now.position, now.velocity, now.setpoint_acceleration, now.setpoint_velocity)
    return ahead + _pd(model, now, k, memory)


def _critically_damped(
    model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector
) -> Vector:
    velocity = now.setpoint_velocity + k["Lambda"] * now.error
    acceleration = now.setpoint_acceleration + k["Lambda"] * now.rate
    ahead = model(now.position, now.velocity, acceleration, velocity)
    return ahead + k["K_D"] * (velocity - now.velocity)


def _pure_feed_forward(
    model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector
) -> Vector:
    ahead = model(now.setpoint, now.setpoint_velocity, now.setpoint_acceleration)
    error = now.error
    return ahead + _pd(model, now, k, memory) + k["sigma"] * (error @ error) * error


def _integral(model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector) -> Vector:
    memory += now.error
    torque = k["K_I"] * memory
    if now.last and k["whole_run"] == 0.0:
        memory[:] = 0.0
    return torque


def _decentralised(model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector) -> Vector:
    # (5.6.10); memory: ∫ r s dt of each joint with s = 1, e, ė, θ̈d.
    r = k["p_2"] * now.error + k["p_3"] * now.rate
    signals = np.stack([np.ones_like(r), now.error, now.rate, now.setpoint_acceleration])
    memory += r * signals * now.step
    gains = k["C"] * memory + k["k"] * np.abs(r) * r * signals
    return np.asarray((gains * signals).sum(axis=0))


def _model_reference(
    model: InverseDynamics, now: JointMoment, k: Numbers, memory: Vector
) -> Vector:
    # (5.5.11) to (5.5.15); memory: the matrices Δ₁, Δ₂ and Δv.
    into = k["acceleration_in_v"] * now.setpoint_acceleration
    into = into + k["K_2"] * now.setpoint_velocity + k["K_1"] * now.setpoint
    moved = into - k["K_1"] * now.position - k["K_2"] * now.velocity
    moved += memory[2] @ into - memory[0] @ now.position - memory[1] @ now.velocity
    still = np.zeros_like(moved)
    if k["inertia_times_u"] == 0.0:
        model_torque = model(now.position, still, now.setpoint_acceleration, now.setpoint_velocity)
        torque = k["unit_mass"] * moved + model_torque
    else:
        torque = model(now.position, still, moved, now.velocity)
    torque = torque - (1.0 - k["gravity"]) * model(now.position, still, still)
    # Q = I in the Lyapunov equation.
    second = 0.5 / k["K_1"]
    third = (1.0 + 2.0 * second) / (2.0 * k["K_2"])
    weighted = (second * now.error + third * now.rate) * now.step
    memory[0] -= k["a"] * np.outer(weighted, now.position)
    memory[1] -= k["a"] * np.outer(weighted, now.velocity)
    memory[2] += k["b"] * np.outer(weighted, into)
    return torque


JOINT_LAWS: Mapping[str, JointLaw] = {
    "pd": JointLaw(_pd),
    "ct": JointLaw(_computed_torque),
    "ffid": JointLaw(_feed_forward_inverse),
    "cdid": JointLaw(_critically_damped),
    "feedforward": JointLaw(_pure_feed_forward),
    "ie": JointLaw(_integral),
    "dac": JointLaw(_decentralised, lambda joints: (4, joints)),
    "mrac": JointLaw(_model_reference, lambda joints: (3, joints, joints)),
}
"""By the name of the law; `acdid` estimates the seven parameters of the two-link arm."""


class RobotLaw(Controller):
    """A law of the study on a robot.

    Parameters
    ----------
    controller : CompiledController
        Law and gains.
    model : InverseDynamics
        The model of the robot.

    Raises
    ------
    GainError
        If a gain has different values for the joints, or is one of the model of the two-link arm.
    """

    takes_ports = True

    def __init__(self, controller: CompiledController, model: InverseDynamics) -> None:
        self.name, self.controller, self.model = controller.name, controller, model
        self.law = JOINT_LAWS[controller.law.name]
        self._gains: dict[str, Gain] = {}
        for name, gain in controller.gains.items():
            if not name.startswith("model."):
                self._gains[name] = gain
            elif gain.origin == "given":
                message = f"{name} is of the two-link arm, and a robot has its model in its file"
                raise GainError(message, name=name, value=gain.value)
        self._numbers = {name: _number(gain) for name, gain in self._gains.items()}
        self.start()

    @property
    def gains(self) -> Mapping[str, Gain]:
        """Gains by name."""
        return self._gains

    def with_gains(self, values: Mapping[str, Sequence[float]]) -> RobotLaw:
        """Return the law with some gains replaced."""
        for name in values:
            if name not in self._gains:
                raise unknown_gain(self.name, self._gains, name)
        return RobotLaw(self.controller.with_gains(values), self.model)

    def start(self, single: bool = False) -> None:
        """Reset the state; called once before each run."""
        self._memory: Vector | None = None
        self._torque: Vector | None = None

    def torques(self, now: JointMoment) -> Vector:
        """Return the torque of each joint; without a measurement the last one."""
        joints = len(now.setpoint)
        if self._memory is None or self._torque is None:
            self._memory, self._torque = np.zeros(self.law.memory(joints)), np.zeros(joints)
        if not any(np.isnan(part).any() for part in now[:5]):
            self._torque = self.law.torques(self.model, now, self._numbers, self._memory)
        return self._torque


def robot_law(controller: CompiledController, model: InverseDynamics) -> RobotLaw:
    """Return a law of the study for a robot.

    Raises
    ------
    UsageError
        If it is a law of the two-link arm alone.
    """
    if controller.law.name not in JOINT_LAWS:
        message = f"{controller.name} adapts the parameters of the study's arm, not of a robot"
        raise UsageError(message, hint=f"on a robot run {', '.join(JOINT_LAWS)}, and texts")
    return RobotLaw(controller, model)


def _number(gain: Gain) -> float:
    # The first of the study's numbers for its two joints.
    if len(set(gain.value)) > 1 and gain.origin == "given":
        message = f"gain {gain.name} differs between joints, and a robot takes one number for all"
        raise GainError(message, name=gain.name, value=gain.value)
    return gain.value[0]
