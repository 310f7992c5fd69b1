"""python-control systems as plants, and plants and controllers as python-control systems."""

import sys
from pathlib import Path

import numpy as np
import pytest

from fuzzyarm import load, shipped
from fuzzyarm.base.errors import MissingExtraError
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.control.loop import Options, Sensor, Signal, simulate
from fuzzyarm.language import parse
from fuzzyarm.plant import Plant, PlantError, Port, find_plant
from fuzzyarm.plant.adapters import ControlPlant, to_control
from fuzzyarm.plant.plant import with_parameters

control = pytest.importorskip("control", reason="python-control is not installed")

PERIOD, STEPS = 1e-3, 400
SERVO = shipped("servo.frb")
EXAMPLES = Path(__file__).parents[2] / "examples" / "controllers"


def motor_slope(x, u, p):
    _position, velocity, current = x
    acceleration = (p["k"] * current - p["b"] * velocity - p["T"]) / p["J"]
    return velocity, acceleration, (u - p["R"] * current - p["k"] * velocity) / p["L"]


def sampled_motor(p):
    """A motor as a user of python-control writes it: sampled by Runge-Kutta steps and a hold."""

    def update(_t, x, u, _params):
        h = PERIOD
        volts = min(max(u[0], -24.0), 24.0)
        one = motor_slope(x, volts, p)
        two = motor_slope([a + 0.5 * h * b for a, b in zip(x, one, strict=True)], volts, p)
        three = motor_slope([a + 0.5 * h * b for a, b in zip(x, two, strict=True)], volts, p)
        four = motor_slope([a + h * b for a, b in zip(x, three, strict=True)], volts, p)
        return [
            a + h / 6.0 * (s + 2.0 * m + 2.0 * n + e)
            for a, s, m, n, e in zip(x, one, two, three, four, strict=True)
        ]

    return control.nlsys(
        update, lambda _t, x, _u, _p: x, dt=PERIOD, inputs=["voltage"],
        outputs=["position", "velocity", "current"], states=3, name="plant",
    )  # fmt: skip


def closed(plant, controller, references, duration=STEPS * PERIOD):
    """Close the loop in python-control; return the outputs of the plant, one row for each."""
    loop = control.interconnect(
        [plant, controller], inputs=[f"reference_{name}" for name in references],
        outputs=plant.output_labels,
    )  # fmt: skip
    time = np.arange(round(duration / plant.dt)) * plant.dt
    wanted = np.array([np.full(len(time), value) for value in references.values()])
    return control.input_output_response(loop, time, wanted).outputs


@pytest.mark.parametrize("path", [SERVO, EXAMPLES / "pd-plus-i.frb"], ids=lambda p: p.stem)
@pytest.mark.parametrize("by_hand", [True, False])
def test_the_loop_of_the_motor_has_the_same_bits_here_and_there(path, by_hand):
    motor = with_parameters(find_plant("motor"), {"T": 0.2})
    text = load(path)
    here = simulate(
        text,
        motor,
        duration=STEPS * PERIOD,
        reference={"position": Signal("step", (1.0,))},
        options=Options(compiled=False),
    )
    numbers = {key: each.value for key, each in motor.parameters.items()}
    plant = sampled_motor(numbers) if by_hand else to_control(motor, PERIOD)
    there = closed(plant, to_control(text), {"position": 1.0, "velocity": 0.0})
    for row, output in zip(there, ("position", "velocity", "current"), strict=True):
        assert np.abs(row - here.outputs[output]).max() == 0.0


def test_a_controller_that_learns_keeps_its_tables_in_the_state():
    text = load(shipped("soc-zero.frb"))
    run, system = text.run(), to_control(text)
    rng = np.random.default_rng(3)
    state = np.zeros(system.nstates)
    for u in rng.normal(0.0, 1e-3, (40, system.ninputs)):
        named = dict(zip(system.input_labels, u, strict=True))
        measured = {name: named[name.replace(".", "_")] for name in run.inputs}
        wanted = {name: named["reference_" + name.replace(".", "_")] for name in run.references}
        drives = run.step(measured, wanted)
        assert list(system.output(0.0, state, u)) == list(drives.values())
        state = system.dynamics(0.0, state, u)
        assert tuple(state) == run.state
    assert np.count_nonzero(state) > 20
    # What it says hangs on nothing but the state: time may go back.
    assert list(system.output(0.0, state * 0.0, u)) == list(
        text.run().step(measured, wanted).values()
    )


def test_a_linear_system_moves_as_its_exact_solution():
    system = control.tf([2.0], [0.5, 1.0], inputs="power", outputs="heat", name="lag")
    plant = ControlPlant(system)
    assert (plant.name, list(plant.inputs), list(plant.outputs)) == ("lag", ["power"], ["heat"])
    text = controller("error of heat", "power", "2 ms")
    run = simulate(text, plant, duration=1.0, reference={"heat": Signal("step", (1.0,))})
    # u = r - y, so T y' + y = 2 (1 - y), held for 2 ms: sampled exactly.
    pole, y = np.exp(-2e-3 / 0.5), 0.0
    for shown in run.outputs["heat"]:
        assert shown == pytest.approx(y, abs=1e-9)
        y = pole * y + 2.0 * (1.0 - pole) * (1.0 - y)


def controller(source, drive, period):
    text = f"controller c\nperiod {period}\naxis a\n  u = {source}\n  drive {drive} = u\n"
    made, faults = with_files(parse(text).controller, Path())
    assert not faults
    return made


def test_nonlinear_discrete_and_unnamed_systems():
    pendulum = control.nlsys(
        lambda t, x, u, p: [x[1], -p["g"] * np.sin(x[0]) + u[0]], lambda t, x, u, p: [x[0], x[1]],
        inputs=1, outputs=["position", "velocity"], states=2, params={"g": 9.81, "name": "long"},
    )  # fmt: skip
    plant = ControlPlant(pendulum, start=[0.3, 0.0], limits={"u": (-1, 1)}, longest_step=0.01)
    assert plant.outputs["velocity"].rate_of == "position"
    assert list(plant.parameters) == ["g"]
    text = controller("measured position * 0", "u", "20 ms")
    slow = simulate(text, with_parameters(plant, {"g": 1.0}), duration=2.0).outputs["position"]
    # Small swings: cos(√g t), here within the third order of the amplitude.
    assert slow[-1] == pytest.approx(0.3 * np.cos(1.98), abs=0.01)
    sampled = ControlPlant(control.ss([[0.5]], [[1.0]], [[1.0]], 0, dt=0.1))
    assert (list(sampled.inputs), list(sampled.outputs)) == (["u"], ["y"])
    run = simulate(controller("reference y", "u", "100 ms"), sampled, duration=0.5)
    assert list(run.outputs["y"]) == [0.0, 1.0, 1.5, 1.75, 1.875]
    with pytest.raises(PlantError, match=r"sampled every 0\.1 s, not every 0\.01 s"):
        simulate(controller("reference y", "u", "10 ms"), sampled, duration=0.5)


def test_what_does_not_fit_is_said():
    with pytest.raises(PlantError, match="no states"):
        ControlPlant(control.ss([], [], [], [[2.0]]))
    with pytest.raises(PlantError, match="no state space"):
        ControlPlant(control.tf([1.0, 0.0, 0.0], [1.0, 1.0]))
    with pytest.raises(PlantError, match="no input 'v'"):
        ControlPlant(control.tf([1.0], [1.0, 1.0], inputs="u"), limits={"v": (0, 1)})
    with pytest.raises(PlantError, match="out of range: None"):
        to_control(find_plant("motor"))
    with pytest.raises(PlantError, match="integrator of its own"):
        to_control(find_plant("arm"), 1e-3)
    with pytest.raises(PlantError, match=r"runs every 0\.001 s"):
        to_control(load(shipped("servo.frb")), 0.01)
    with pytest.raises(PlantError, match="neither a plant nor"):
        to_control(3.0, 0.01)


def test_a_file_with_a_system_is_a_plant(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(
        "import control\nkiln = control.tf([1], [100, 1], inputs='power', outputs='temperature')\n"
        "other = control.tf([1], [1, 1])\n"
    )
    assert list(find_plant(f"{path}:kiln").outputs) == ["temperature"]
    with pytest.raises(PlantError, match="has 2 plants"):
        find_plant(str(path))
    with pytest.raises(PlantError, match="has no plant 'klin'"):
        find_plant(f"{path}:klin")


class Slow(Plant):
    """A valve that moves slowly, for a level that it feeds."""

    name = "slow"
    inputs = {"valve": Port("1", -1.0, 1.0, slew=2.0)}
    outputs = {"level": Port("m")}
    states = {"level": "m"}

    def derivative(self, t, x, u, p):
        return [u[0] - 0.5 * x[0]]


def test_limits_and_slew_of_actuators_are_those_of_the_loop_here():
    text = controller("error of level * 5", "valve", "50 ms")
    here = simulate(text, Slow(), duration=2.0, reference={"level": Signal("step", (1.0,))})
    there = closed(to_control(Slow(), 0.05), to_control(text), {"level": 1.0}, 2.0)
    assert np.abs(here.drives["valve"]).max() == 1.0
    assert np.diff(here.drives["valve"]).max() == pytest.approx(0.1)
    np.testing.assert_array_equal(np.ravel(there), here.outputs["level"])


@pytest.mark.parametrize(
    ("module", "use"),
    [
        ("control", lambda: to_control(Slow(), 0.1)),
        ("control", lambda: ControlPlant(None)),
        ("gymnasium", lambda: find_plant("gym:CartPole-v1")),
        ("fmpy", lambda: find_plant("model.fmu")),
    ],
)
def test_a_missing_package_names_the_extra(monkeypatch, module, use):
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.delitem(sys.modules, module)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setattr(
        "fuzzyarm.base.extras._pip", lambda: "pip"
    )  # whatever has made this environment
    with pytest.raises(MissingExtraError, match=r'pip install -e ".*\[plants\]"'):
        use()


def test_noise_of_a_run_hangs_on_its_seed():
    plant = ControlPlant(control.tf([1.0], [1.0, 1.0]))

    def run(seed):
        options = Options(seed=seed, sensors={"y": Sensor(noise=0.1)})
        return simulate(
            controller("error of y", "u", "10 ms"), plant, duration=0.5, options=options
        )

    np.testing.assert_array_equal(run(1).outputs["y"], run(1).outputs["y"])
    assert (run(1).outputs["y"] != run(2).outputs["y"]).any()
