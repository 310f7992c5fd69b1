"""One control period of the arm under a constant torque.

:func:`semi_implicit` is what the study's programs do; :func:`runge_kutta` checks it.
"""

from __future__ import annotations

from fuzzyarm.arm.dynamics import joint_acceleration
from fuzzyarm.arm.signals import Pair, Pose, State, pose_of, stored
from fuzzyarm.kernels import kernel


@kernel
def semi_implicit(
    state: State,
    torque: Pair,
    pose: Pose,
    numbers: list[float],
    at: int,
    step: float,
    single: bool,
) -> State:
    """Advance by ``v ← v + a·dt``, then ``q ← q + v·dt + ½·a·dt²`` with the new v.

    Parameters
    ----------
    state : State
        Before the step.
    torque : pair of float
        N m, constant over the step.
    pose : Pose
        Of `state`.
    numbers, at
        The constants of the arm, see :func:`fuzzyarm.arm.dynamics.joint_acceleration`.
    step : float
        dt, s.
    single : bool
        Round velocity and position to single precision.

    Returns
    -------
    State
        After the step.
    """
    acceleration = joint_acceleration(state.velocity, torque, pose, numbers, at, single)
    v_1 = stored(acceleration[0] * step + state.velocity[0], single)
    v_2 = stored(acceleration[1] * step + state.velocity[1], single)
    q_1 = stored(state.position[0] + v_1 * step + 0.5 * acceleration[0] * step * step, single)
    q_2 = stored(state.position[1] + v_2 * step + 0.5 * acceleration[1] * step * step, single)
    return State((q_1, q_2), (v_1, v_2))


@kernel
def runge_kutta(
    state: State,
    torque: Pair,
    numbers: list[float],
    at: int,
    step: float,
    parts: int,
    single: bool,
) -> State:
    """Advance by `parts` classical fourth-order steps; arguments as above."""
    h = step / parts
    now = state
    for _ in range(parts):
        a = joint_acceleration(now.velocity, torque, pose_of(now.position), numbers, at, False)
        second = _moved(now, now.velocity, a, 0.5 * h)
        b = joint_acceleration(
            second.velocity, torque, pose_of(second.position), numbers, at, False
        )
        third = _moved(now, second.velocity, b, 0.5 * h)
        c = joint_acceleration(third.velocity, torque, pose_of(third.position), numbers, at, False)
        fourth = _moved(now, third.velocity, c, h)
        d = joint_acceleration(
            fourth.velocity, torque, pose_of(fourth.position), numbers, at, False
        )
        speed = _weighted(now.velocity, second.velocity, third.velocity, fourth.velocity)
        now = _moved(now, speed, _weighted(a, b, c, d), h)
    return State(
        (stored(now.position[0], single), stored(now.position[1], single)),
        (stored(now.velocity[0], single), stored(now.velocity[1], single)),
    )


@kernel
def _moved(state: State, speed: Pair, acceleration: Pair, h: float) -> State:
    return State(
        (state.position[0] + h * speed[0], state.position[1] + h * speed[1]),
        (state.velocity[0] + h * acceleration[0], state.velocity[1] + h * acceleration[1]),
    )


@kernel
def _weighted(a: Pair, b: Pair, c: Pair, d: Pair) -> Pair:
    return (
        (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0]) / 6.0,
        (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1]) / 6.0,
    )
