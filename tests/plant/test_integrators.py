"""Order of the integrators and the energy balance along a motion."""

import math
from itertools import pairwise

import numpy as np
import pytest

from fuzzyarm.plant import LOADED, UNLOADED, State
from fuzzyarm.plant.arm import (
    constants,
    kinetic_energy,
    potential_energy,
    runge_kutta,
    semi_implicit,
)
from fuzzyarm.plant.setting import pose_of

BEGIN = State((0.3, -0.8), (1.0, -2.0))
TORQUE = (12.0, 5.0)


def moved(steps, duration=0.3, parts=0, arm=UNLOADED):
    numbers = list(constants(arm))
    h = duration / steps
    state = BEGIN
    for _ in range(steps):
        if parts:
            state = runge_kutta(state, TORQUE, numbers, 0, h, parts, False)
        else:
            state = semi_implicit(state, TORQUE, pose_of(state.position), numbers, 0, h, False)
    return np.array([*state.position, *state.velocity])


def test_halving_the_step_halves_the_error_of_the_study_integrator():
    exact = moved(2000, parts=1)
    errors = [np.abs(moved(steps) - exact).max() for steps in (250, 500, 1000, 2000)]
    ratios = [coarse / fine for coarse, fine in pairwise(errors)]
    assert all(1.9 < ratio < 2.1 for ratio in ratios), ratios


def test_runge_kutta_is_of_fourth_order():
    exact = moved(400, parts=4)
    errors = [np.abs(moved(steps, parts=1) - exact).max() for steps in (40, 80, 160)]
    ratios = [coarse / fine for coarse, fine in pairwise(errors)]
    assert all(14 < ratio < 18 for ratio in ratios), ratios


def test_runge_kutta_parts_are_steps():
    np.testing.assert_allclose(moved(50, parts=4), moved(200, parts=1), rtol=1e-13)


def test_runge_kutta_agrees_with_an_adaptive_solver():
    from scipy.integrate import solve_ivp

    from fuzzyarm.plant.arm import forward_dynamics

    def rate(_, y):
        return [y[2], y[3], *forward_dynamics(UNLOADED, y[:2], y[2:], TORQUE)]

    begin = [*BEGIN.position, *BEGIN.velocity]
    solved = solve_ivp(rate, (0.0, 0.3), begin, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(moved(300, parts=1), solved.y[:, -1], rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("arm", [UNLOADED, LOADED])
def test_energy_balance_holds_to_integrator_order(arm):
    """Power of torques minus friction equals the rate of kinetic plus potential energy."""

    def imbalance(h, parts):
        numbers = list(constants(arm))
        state, work = BEGIN, 0.0
        before = kinetic_energy(arm, state) + potential_energy(arm, state)
        for index in range(round(0.3 / h)):
            torque = (12.0 * math.cos(9.0 * index * h), 5.0 * math.sin(7.0 * index * h))
            if parts:
                new = runge_kutta(state, torque, numbers, 0, h, parts, False)
            else:
                new = semi_implicit(state, torque, pose_of(state.position), numbers, 0, h, False)
            for joint, friction in ((0, arm.F_1), (1, arm.F_2)):
                turned = new.position[joint] - state.position[joint]
                v_0, v_1 = state.velocity[joint], new.velocity[joint]
                work += (
                    torque[joint] * turned - friction * h * (v_0 * v_0 + v_0 * v_1 + v_1 * v_1) / 3
                )
            state = new
        after = kinetic_energy(arm, state) + potential_energy(arm, state)
        return abs(after - before - work)

    coarse, fine = imbalance(6e-4, 0), imbalance(3e-4, 0)
    assert coarse < 0.05
    assert 1.8 < coarse / fine < 2.2
    # With exact integration what is left is the quadrature of friction, of second order.
    assert imbalance(6e-4, 4) < 1e-5


def test_single_precision_rounds_what_is_stored():
    numbers = list(constants(UNLOADED, single=True))
    state = semi_implicit(BEGIN, TORQUE, pose_of(BEGIN.position), numbers, 0, 6e-4, True)
    for value in (*state.position, *state.velocity):
        assert value == float(np.float32(value))
    state = runge_kutta(BEGIN, TORQUE, numbers, 0, 6e-4, 2, True)
    for value in (*state.position, *state.velocity):
        assert value == float(np.float32(value))
