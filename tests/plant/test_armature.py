"""Motors with inductance and at a supply that ends."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fuzzyarm.apps.study.comparison import INDUCTANCE
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import Options, simulate
from fuzzyarm.plant import ArmError, through
from fuzzyarm.plant.arm import RATIOS, RESISTANCE, TORQUE_CONSTANT, motor_torque
from fuzzyarm.plant.driven_arm import Arm, armature_torque, armature_voltage

STEP = 0.0006
QUICK = through([(40.0, -30.0), (-20.0, 10.0)], segment=0.8, hold=0.3)


@pytest.mark.parametrize("inductance", [2e-4, INDUCTANCE, 0.05])
@pytest.mark.parametrize(("voltage", "velocity", "current"), [(20.0, 1.5, -3.0), (-7.0, 0.0, 4.0)])
def test_a_period_is_the_solution_of_the_circuit(inductance, voltage, velocity, current):
    ratio = RATIOS[0]

    def circuit(_time, i):
        emf = TORQUE_CONSTANT * ratio * velocity
        return [(voltage - emf - RESISTANCE * i[0]) / inductance, i[0]]

    oracle = solve_ivp(circuit, (0.0, STEP), [current, 0.0], rtol=1e-11, atol=1e-13).y[:, -1]
    x = [0.0] * 4 + [current, 0.0]
    torque = armature_torque(x, 4, voltage, velocity, ratio, inductance, STEP)
    assert x[4] == pytest.approx(oracle[0], rel=1e-8)
    assert torque == pytest.approx(TORQUE_CONSTANT * ratio * oracle[1] / STEP, rel=1e-8)


def test_without_inductance_it_is_the_motor_of_the_study():
    for voltage, velocity in ((20.0, 0.0), (-3.0, 2.0)):
        x = [0.0] * 4
        torque = armature_torque(x, 4, voltage, velocity, RATIOS[1], 0.0, STEP)
        assert torque == pytest.approx(motor_torque(voltage, velocity, RATIOS[1]), rel=1e-14)
        assert x == [0.0] * 4


def test_the_voltage_of_a_torque_makes_that_torque_and_ends_at_the_supply():
    ratio, velocity = RATIOS[0], 0.7
    voltage = armature_voltage(12.0, 0.0, velocity, ratio, 0.0, math.inf)
    assert motor_torque(voltage, velocity, ratio) == pytest.approx(12.0, rel=1e-14)
    # Beside a voltage of the controller's own it adds to that.
    both = armature_voltage(12.0, 5.0, velocity, ratio, 1.0, math.inf)
    assert motor_torque(both, velocity, ratio) == pytest.approx(
        12.0 + motor_torque(5.0, velocity, ratio), rel=1e-12
    )
    assert armature_voltage(1e3, 0.0, velocity, ratio, 0.0, 24.0) == 24.0
    assert armature_voltage(-1e3, 5.0, velocity, ratio, 1.0, 24.0) == -24.0


@pytest.mark.parametrize("name", ["cdid", "pd-motor", "cdid+fuzzy"])
def test_little_inductance_and_much_supply_change_nothing(name):
    ideal = simulate(controller(name), QUICK)
    nearly = simulate(controller(name), QUICK, options=Options(inductance=1e-9, supply=1e9))
    near = 1e-6 if name == "cdid" else 1e-2  # the others switch: last bits count
    np.testing.assert_allclose(nearly.rms, ideal.rms, rtol=near)


def test_off_is_what_it_was_to_the_bit():
    ideal = simulate(controller("acdid+fuzzy"), QUICK)
    off = simulate(controller("acdid+fuzzy"), QUICK, options=Options(inductance=0.0))
    np.testing.assert_array_equal(ideal.error_matrix, off.error_matrix)


def test_no_motor_gets_more_than_the_supply():
    run = simulate(controller("acdid+fuzzy"), QUICK, payload=True, options=Options(supply=9.0))
    for joint, ratio in enumerate(RATIOS):
        voltage = run.drives[f"joint{joint + 1}.voltage"]
        assert np.abs(voltage).max() == pytest.approx(9.0)
        stall = 9.0 * TORQUE_CONSTANT / RESISTANCE * ratio
        speed = np.abs(run.outputs[f"joint{joint + 1}.velocity"]).max()
        braking = TORQUE_CONSTANT**2 * ratio**2 / RESISTANCE * speed
        assert np.abs(run.torques[:, joint]).max() <= stall + braking + 1e-9


def test_inductance_smooths_the_torque_of_a_switching_controller():
    def changes(options):
        run = simulate(controller("pd-motor-tuned"), QUICK, options=options)
        return np.abs(np.diff(run.torques, axis=0)).mean()

    assert changes(Options(inductance=0.01)) < 0.5 * changes(Options())


def test_compiled_and_interpreted_have_the_same_bits():
    runs = [
        simulate(
            controller("cdid+fuzzy"),
            through([(3.0, -2.0)], segment=0.1),
            options=Options(inductance=INDUCTANCE, supply=12.0, compiled=compiled),
        )
        for compiled in (True, False)
    ]
    np.testing.assert_array_equal(runs[0].error_matrix, runs[1].error_matrix)


def test_currents_are_states_where_there_is_inductance():
    assert list(Arm().states) == ["q_1", "q_2", "v_1", "v_2"]
    assert Arm(inductance=0.002).states["i_2"] == "A"


@pytest.mark.parametrize(
    "options",
    [{"inductance": -1e-3}, {"inductance": math.nan}, {"inductance": 11.0}, {"supply": 0.0}],
)
def test_what_no_motor_has_is_out_of_range(options):
    with pytest.raises(ArmError, match="out of range"):
        Options(**options)
