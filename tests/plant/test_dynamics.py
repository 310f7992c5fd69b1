"""The equations of motion against closed forms and an independent rigid-body library."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.plant import ESTIMATE, INEXACT, LOADED, UNLOADED, ArmError, ArmParameters, State
from fuzzyarm.plant.arm import (
    constants,
    coriolis_matrix,
    forward_dynamics,
    friction_matrix,
    gravity_torque,
    inverse_dynamics,
    joint_acceleration,
    kinetic_energy,
    mass_matrix,
    model_torque,
    parameter_vector,
    potential_energy,
    regressor,
)
from fuzzyarm.plant.setting import Reference, pose_of

ARMS = [UNLOADED, LOADED, ESTIMATE, INEXACT]

angles = st.floats(-10.0, 10.0)
speeds = st.floats(-20.0, 20.0)
pairs = st.tuples(angles, angles)
motions = st.tuples(speeds, speeds)


def states(count, seed):
    random = np.random.default_rng(seed)
    return (
        random.uniform(-np.pi, np.pi, (count, 2)),
        random.uniform(-5.0, 5.0, (count, 2)),
        random.uniform(-50.0, 50.0, (count, 2)),
    )


@given(pairs)
def test_mass_matrix_is_symmetric_and_positive_definite(position):
    for arm in ARMS:
        matrix = mass_matrix(arm, position)
        assert matrix[0, 1] == matrix[1, 0]
        assert np.linalg.eigvalsh(matrix)[0] > 0.1


@given(pairs, motions, motions)
def test_regressor_form_equals_matrix_form(position, velocity, acceleration):
    for arm in ARMS:
        linear = regressor(position, velocity, acceleration) @ parameter_vector(arm)
        linear = linear + np.array([arm.J_1, arm.J_2]) * acceleration
        matrix = inverse_dynamics(arm, position, velocity, acceleration)
        np.testing.assert_allclose(linear, matrix, rtol=1e-12, atol=1e-10)


@given(pairs, motions)
def test_mass_matrix_rate_minus_twice_coriolis_does_no_work(position, velocity):
    # The printed V is not the skew-symmetric choice, but v'(Ṁ − 2V)v vanishes all the same.
    step = 1e-6
    ahead = np.add(position, step * np.array(velocity))
    behind = np.subtract(position, step * np.array(velocity))
    rate = (mass_matrix(UNLOADED, ahead) - mass_matrix(UNLOADED, behind)) / (2 * step)
    middle = rate - 2 * coriolis_matrix(UNLOADED, position, velocity)
    v = np.array(velocity)
    scale = 1.0 + np.abs(v).max() ** 3
    assert abs(v @ middle @ v) < 1e-5 * scale


@given(pairs, motions, motions)
def test_kernels_equal_matrix_form(position, velocity, torque):
    for arm in ARMS:
        numbers = [7.0, *constants(arm)]
        got = joint_acceleration(velocity, torque, pose_of(position), numbers, 1, False)
        want = forward_dynamics(arm, position, velocity, torque)
        np.testing.assert_allclose(got, want, rtol=1e-9, atol=1e-9)
        motion = Reference(position, velocity, torque)
        got = model_torque(motion, velocity, pose_of(position), numbers, 1)
        want = inverse_dynamics(arm, position, velocity, torque)
        np.testing.assert_allclose(got, want, rtol=1e-10, atol=1e-9)


def test_gravity_torque_is_the_slope_of_potential_energy():
    for position in states(20, 3)[0]:
        slope = []
        for joint in range(2):
            step = np.zeros(2)
            step[joint] = 1e-6
            up, down = (State(tuple(position + s), (0.0, 0.0)) for s in (step, -step))
            slope.append((potential_energy(LOADED, up) - potential_energy(LOADED, down)) / 2e-6)
        np.testing.assert_allclose(gravity_torque(LOADED, position), slope, atol=1e-7)


def test_arrays_of_states_are_taken_at_once():
    q, v, a = states(7, 5)
    together = inverse_dynamics(LOADED, q, v, a)
    for index in range(7):
        np.testing.assert_allclose(
            together[index], inverse_dynamics(LOADED, q[index], v[index], a[index]), rtol=1e-14
        )
    assert mass_matrix(LOADED, q).shape == (7, 2, 2)
    assert friction_matrix(LOADED).tolist() == [[2.5, 0.0], [0.0, 2.5]]


def mujoco_model(arm):
    import mujoco

    text = f"""
    <mujoco>
      <option gravity="0 {-arm.g} 0"/>
      <compiler inertiafromgeom="false"/>
      <worldbody>
        <body>
          <joint type="hinge" axis="0 0 1" armature="{arm.J_1!r}" damping="{arm.F_1!r}"/>
          <inertial pos="{arm.x_1!r} 0 0" mass="{arm.m_1!r}"
                    diaginertia="{arm.I_1!r} {arm.I_1!r} {arm.I_1!r}"/>
          <body pos="{arm.l_1!r} 0 0">
            <joint type="hinge" axis="0 0 1" armature="{arm.J_2!r}" damping="{arm.F_2!r}"/>
            <inertial pos="{arm.x_2!r} 0 0" mass="{arm.m_2!r}"
                      diaginertia="{arm.I_2!r} {arm.I_2!r} {arm.I_2!r}"/>
          </body>
        </body>
      </worldbody>
    </mujoco>"""
    return mujoco.MjModel.from_xml_string(text)


@pytest.mark.parametrize("arm", [UNLOADED, LOADED])
def test_forward_dynamics_agree_with_an_independent_library(arm):
    import mujoco

    model = mujoco_model(arm)
    data = mujoco.MjData(model)
    q, v, torque = states(1000, 11)
    theirs = np.empty_like(q)
    for index in range(len(q)):
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q[index], v[index], torque[index]
        mujoco.mj_forward(model, data)
        theirs[index] = data.qacc
    ours = forward_dynamics(arm, q, v, torque)
    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9)
    numbers = list(constants(arm))
    kernel = [
        joint_acceleration(tuple(s), tuple(t), pose_of(tuple(p)), numbers, 0, False)
        for p, s, t in zip(q, v, torque, strict=True)
    ]
    np.testing.assert_allclose(kernel, theirs, rtol=1e-9, atol=1e-9)


def test_kinetic_energy_agrees_with_an_independent_library():
    import mujoco

    model = mujoco_model(LOADED)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    q, v, _ = states(50, 12)
    for index in range(len(q)):
        data.qpos[:], data.qvel[:] = q[index], v[index]
        mujoco.mj_forward(model, data)
        ours = kinetic_energy(LOADED, State(tuple(q[index]), tuple(v[index])))
        assert ours == pytest.approx(data.energy[1], rel=1e-9)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0])
def test_parameters_out_of_sense_are_refused(value):
    with pytest.raises(ArmError, match="m_1") as caught:
        ArmParameters(m_1=value)
    assert caught.value.name == "m_1"


def test_constants_are_those_of_the_definitions():
    # P1 … P7 by hand for the unloaded arm.
    want = [
        0.09 + 0.09 + 2 * (0.14**2 + 0.26**2) + 2 * 0.13**2,
        2 * 2 * 0.26 * 0.14,
        2 * 0.14**2 + 0.09,
        2.5,
        2.5,
        9.8 * (2 * 0.13 + 2 * 0.26),
        9.8 * 2 * 0.14,
    ]
    np.testing.assert_allclose(parameter_vector(UNLOADED), want, rtol=1e-15)
    assert constants(UNLOADED)[7:].tolist() == [0.1498, 0.1498]
    single = constants(UNLOADED, single=True)[:7]
    assert (single == single.astype(np.float32)).all()
