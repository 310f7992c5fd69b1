"""Every control law against its equation, written with matrices."""

import numpy as np
import pytest

from fuzzyarm.control.controllers import controller
from fuzzyarm.control.controllers.controller import CompiledController
from fuzzyarm.control.controllers.own import find_controller
from fuzzyarm.plant import ESTIMATE, UNLOADED, Clock, Reference, State
from fuzzyarm.plant.arm import (
    coriolis_matrix,
    friction_matrix,
    gravity_torque,
    inverse_dynamics,
    mass_matrix,
    parameter_vector,
    regressor,
)
from fuzzyarm.plant.setting import RunArithmetic

MODEL = UNLOADED.with_values(J_1=0.0, J_2=0.0)
CLOCK = Clock(0.0006, False, False)
J = np.diag([0.1498, 0.1498])


def situations(count=25):
    random = np.random.default_rng(2)
    for _ in range(count):
        yield random.uniform(-2.0, 2.0, (5, 2))


def asked(made, numbers, clock=CLOCK):
    qd, vd, ad, q, v = (tuple(float(x) for x in pair) for pair in numbers)
    return np.array(made.torque(Reference(qd, vd, ad), State(q, v), clock))


def compare(name, law):
    made = controller(name)
    for numbers in situations():
        np.testing.assert_allclose(asked(made, numbers), law(*numbers), rtol=1e-11, atol=1e-10)


def test_pd():
    compare("pd", lambda qd, vd, ad, q, v: 100 * (qd - q) + 50 * (vd - v))


def test_ct():
    compare(
        "ct",
        lambda qd, vd, ad, q, v: inverse_dynamics(MODEL, q, v, ad + 100 * (qd - q) + 50 * (vd - v)),
    )


def test_ct_as_described_has_no_friction():
    made = controller("ct", variant="as-described")
    for qd, vd, ad, q, v in situations():
        law = mass_matrix(MODEL, q) @ (ad + 100 * (qd - q) + 50 * (vd - v))
        law = law + coriolis_matrix(MODEL, q, v) @ v + gravity_torque(MODEL, q)
        np.testing.assert_allclose(asked(made, (qd, vd, ad, q, v)), law, rtol=1e-11)


def model_based(q, v, velocity, acceleration, arm=MODEL):
    return (
        mass_matrix(arm, q) @ acceleration
        + (coriolis_matrix(arm, q, v) + friction_matrix(arm)) @ velocity
        + gravity_torque(arm, q)
    )


def test_ffid():
    compare(
        "ffid",
        lambda qd, vd, ad, q, v: model_based(q, v, vd, ad) + 100 * (qd - q) + 50 * (vd - v),
    )


def reference_motion(qd, vd, ad, q, v):
    return vd + 100 * (qd - q), ad + 100 * (vd - v)


def test_cdid():
    def law(qd, vd, ad, q, v):
        vr, ar = reference_motion(qd, vd, ad, q, v)
        return model_based(q, v, vr, ar) + 50 * (vr - v)

    compare("cdid", law)


def test_pure_feed_forward():
    def law(qd, vd, ad, q, v):
        e = qd - q
        return inverse_dynamics(MODEL, qd, vd, ad) + 100 * e + 50 * (vd - v) + 100 * (e @ e) * e

    compare("feedforward", law)


def test_acdid_first_torque_and_adaptation():
    made = controller("acdid", variant="as-described")
    assert isinstance(made, CompiledController)
    for numbers in situations():
        qd, vd, ad, q, v = numbers
        vr, ar = reference_motion(qd, vd, ad, q, v)
        s = v - vr
        made.start()
        np.testing.assert_allclose(
            asked(made, numbers), model_based(q, v, vr, ar, ESTIMATE) - 50 * s, rtol=1e-11
        )
        # Equation 5.4.7 with the skew-symmetric Coriolis terms the study adapts with.
        w = np.zeros((2, 7))
        w[:, [0, 2, 3, 4, 5, 6]] = regressor(q, v, ar)[:, [0, 2, 3, 4, 5, 6]]
        w[0, 3], w[1, 4] = vr
        sin_2, cos_2 = np.sin(q[1]), np.cos(q[1])
        w[0, 1] = cos_2 * (ar[0] + 0.5 * ar[1]) - 0.5 * sin_2 * (
            v[1] * vr[0] + v[1] * vr[1] + v[0] * vr[1]
        )
        w[1, 1] = 0.5 * (cos_2 * ar[0] + sin_2 * v[0] * vr[0])
        want = parameter_vector(ESTIMATE) - CLOCK.step * 100.0 * (w.T @ s)
        np.testing.assert_allclose(made._block.memory[:7], want, rtol=1e-10, atol=1e-10)


def test_acdid_as_printed_differs_in_one_entry_of_the_regressor():
    printed, theory = (
        controller("acdid", variant=variant) for variant in ("as-printed", "as-described")
    )
    numbers = next(situations())
    np.testing.assert_array_equal(asked(printed, numbers), asked(theory, numbers))
    changed = np.not_equal(printed._block.memory, theory._block.memory)
    assert np.flatnonzero(changed).tolist() == [1]


@pytest.mark.parametrize("start", ["warm", "cold"])
def test_mrac_over_three_calls(start):
    estimate = (
        ESTIMATE
        if start == "warm"
        else ESTIMATE.with_values(
            **dict.fromkeys(
                ("m_1", "m_2", "x_1", "x_2", "I_1", "I_2", "F_1", "F_2", "J_1", "J_2"), 0.0
            )
        )
    )
    made = controller("mrac", start=start)
    d1, d2, dv = np.zeros((3, 2, 2))
    p2 = 1 / (2 * 500.0)
    p3 = (1 + 2 * p2) / (2 * 100.0)
    h = CLOCK.step
    for qd, vd, ad, q, v in situations(3):
        drive = ad + 100 * vd + 500 * qd
        u = drive - 500 * q - 100 * v - d1 @ q - d2 @ v + dv @ drive
        want = (
            u
            + gravity_torque(estimate, q)
            + friction_matrix(estimate) @ vd
            + mass_matrix(estimate, q) @ ad
        )
        got = asked(made, (qd, vd, ad, q, v))
        np.testing.assert_allclose(got, want, rtol=1e-10, atol=1e-10)
        w = p2 * (qd - q) + p3 * (vd - v)
        d1 -= h * 100 * np.outer(w, q)
        d2 -= h * 100 * np.outer(w, v)
        dv += h * 2 * np.outer(w, drive)


def test_mrac_solves_its_lyapunov_equation():
    from scipy.linalg import solve_continuous_lyapunov

    made = controller("mrac")
    assert isinstance(made, CompiledController)
    packed = made.block(RunArithmetic()).numbers
    system = np.array([[0.0, 1.0], [-500.0, -100.0]])
    solution = solve_continuous_lyapunov(system.T, -np.eye(2))
    assert packed[4] == pytest.approx(solution[0, 1], rel=1e-9)
    assert packed[6] == pytest.approx(solution[1, 1], rel=1e-9)


def test_mrac_as_described_multiplies_the_model_inertia():
    made = controller("mrac", variant="as-described")
    qd, vd, ad, q, v = next(situations())
    u = ad + 100 * (vd - v) + 500 * (qd - q)
    want = (
        mass_matrix(ESTIMATE, q) @ u + friction_matrix(ESTIMATE) @ v + gravity_torque(ESTIMATE, q)
    )
    np.testing.assert_allclose(asked(made, (qd, vd, ad, q, v)), want, rtol=1e-10)


def test_dac_over_three_calls():
    made = controller("dac")
    c, k, h = np.array([1.1, 1.6]), 1.0, CLOCK.step
    sums = np.zeros((4, 2))
    for qd, vd, ad, q, v in situations(3):
        e, rate = qd - q, vd - v
        r = 1650 * e + 50 * rate
        signals = np.array([np.ones(2), e, rate, ad])
        sums += h * r * signals
        gains = c * sums + k * np.abs(r) * r * signals
        want = (gains * signals).sum(axis=0)
        np.testing.assert_allclose(asked(made, (qd, vd, ad, q, v)), want, rtol=1e-11)


def test_integral_over_a_set_point_is_cleared_after_its_sample():
    made = find_controller("ie")
    numbers = np.zeros((5, 2))
    numbers[0] = [0.1, -0.2]
    for expected in (1, 2, 3, 4):
        np.testing.assert_allclose(asked(made, numbers), [5.0 * expected, -10.0 * expected])
    last = CLOCK._replace(last=True)
    np.testing.assert_allclose(asked(made, numbers, last), [25.0, -50.0])
    np.testing.assert_allclose(asked(made, numbers), [5.0, -10.0])


def test_integral_over_the_whole_run_is_never_cleared():
    made = find_controller("ie").with_gains({"whole_run": [1]})
    numbers = np.zeros((5, 2))
    numbers[0] = [0.1, -0.2]
    for expected in range(1, 12):
        clock = CLOCK._replace(last=expected % 5 == 0)
        np.testing.assert_allclose(asked(made, numbers, clock), [5.0 * expected, -10.0 * expected])
