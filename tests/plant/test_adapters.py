"""Gymnasium environments and FMUs as plants, against the real packages."""

import copy
import json
import math
import pickle
import re
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest
from needs import need, program

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.control.controllers.catalogue import controller_of
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.control.loop import Options, Signal, simulate
from fuzzyarm.language import parse
from fuzzyarm.plant import PlantError, find_plant
from fuzzyarm.plant.adapters import EnvironmentPlant, UnitPlant
from fuzzyarm.plant.plant import with_actuators, with_parameters

STILL = {"x": Signal("step", (0.0,))}


def controller(*lines, period="20 ms"):
    text = "\n".join(["controller c", f"period {period}", "axis a", *(f"  {x}" for x in lines)])
    made, faults = with_files(parse(text + "\n").controller, Path())
    assert not faults
    return made


# --- Gymnasium ---


@pytest.fixture
def gymnasium():
    return pytest.importorskip("gymnasium", reason="Gymnasium is not installed")


def test_the_shipped_controller_holds_the_pole(gymnasium):
    plant, text = find_plant("gym:CartPole-v1"), load(shipped("cartpole.frb"))
    assert plant.duration == 10.0
    for seed in range(4):
        run = simulate(text, plant, reference=STILL, options=Options(seed=seed))
        assert (run.samples, run.ended, run.diverged) == (500, None, None)
    assert set(run.drives) == {"f"}
    assert np.abs(run.drives["f"]).max() < 10.0


@pytest.mark.slow
def test_four_inputs_hold_it_ten_times_as_long_and_two_do_not(gymnasium):
    plant, text = find_plant("gym:CartPole-v1"), load(shipped("cartpole.frb"))
    whole = controller_of(text)
    pole_only = whole.with_gains({"G_x": [0.0], "G_v": [0.0]})

    def steps(chosen, seed):
        options = Options(seed=seed)
        run = simulate(chosen, plant, reference=STILL, duration=100.0, options=options)
        return run.samples

    assert [steps(whole, seed) for seed in range(4)] == [5_000] * 4
    assert min(steps(pole_only, seed) for seed in range(3, 7)) < 2_500


def test_an_environment_gives_what_it_gives_without_us(gymnasium):
    plant, text = find_plant("gym:CartPole-v1"), load(shipped("cartpole.frb"))
    run = simulate(text, plant, reference=STILL, duration=1.0, options=Options(seed=5))
    other = gymnasium.make("CartPole-v1")
    seen, _ = other.reset(seed=5)
    law = text.run()
    for index in range(50):
        measured = dict(zip(("x", "v", "theta", "omega"), map(float, seen), strict=True))
        assert all(run.outputs[name][index] == value for name, value in measured.items())
        force = law.step(measured, {"x": 0.0, "v": 0.0})["f"]
        seen, *_ = other.step(int(force >= 0))


def test_an_episode_that_ends_ends_the_run(gymnasium):
    plant = find_plant("gym:CartPole-v1")
    law = controller("a = measured x", "f = a * 0", "drive f = f", "drive f = 10")
    run = simulate(law, plant, reference=STILL)
    assert run.diverged is None
    assert run.ended == pytest.approx(0.02 * run.samples)
    assert run.samples < 20
    # The next run begins a new episode.
    assert simulate(load(shipped("cartpole.frb")), plant, reference=STILL).samples == 500


def test_a_period_that_the_environment_does_not_have(gymnasium):
    with pytest.raises(PlantError, match=r"steps every 0\.02 s, not every 0\.01 s"):
        simulate(controller("a = measured x", "drive f = a", period="10 ms"),
                 find_plant("gym:CartPole-v1"), reference=STILL)  # fmt: skip
    # A multiple repeats the action.
    run = simulate(controller("a = measured x", "drive f = a", period="40 ms"),
                   find_plant("gym:CartPole-v1"), reference=STILL, duration=0.2)  # fmt: skip
    assert run.samples == 5


def test_actions_that_are_numbers_or_choices(gymnasium):
    plant = find_plant("gym:Pendulum-v1")
    assert list(plant.outputs) == ["cos", "sin", "omega", "theta"]
    run = simulate(controller("a = measured theta", "w = measured omega", "t = -a * 10 - w * 2",
                              "drive torque = t", period="50 ms"), plant, duration=2.0,
                   reference={"theta": Signal("step", (0.0,))})  # fmt: skip
    np.testing.assert_allclose(
        np.tan(run.outputs["theta"]), run.outputs["sin"] / run.outputs["cos"]
    )
    assert np.abs(run.drives["torque"]).max() <= 2.0
    choice = EnvironmentPlant("MountainCar-v0")._actions
    assert [choice([u]) for u in (-9.0, -0.4, -0.3, 0.3, 0.4, 9.0)] == [0, 0, 1, 1, 2, 2]
    two = EnvironmentPlant("CartPole-v1")._actions
    assert [two([u]) for u in (-10.0, -1e-9, 0.0, 1e-9)] == [0, 0, 1, 1]


def test_environments_of_ones_own_and_those_that_do_not_serve(gymnasium):
    class Own(gymnasium.Env):
        observation_space = gymnasium.spaces.Box(-1.0, 1.0, (2,))
        action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,))
        dt = 0.1

        def reset(self, *, seed=None, options=None):
            super().reset(seed=seed)
            self.x = np.zeros(2)
            return self.x, {}

        def step(self, action):
            self.x = self.x + 0.1 * np.array([self.x[1], action[0]])
            return self.x, 0.0, False, bool(self.x[0] > 0.9), {}

    plant = EnvironmentPlant(Own())
    assert (plant.name, list(plant.inputs)) == ("Own", ["action"])
    law = controller("a = measured observation1", "u = a * 0", "drive action = u",
                     "drive action = 1", period="100 ms")  # fmt: skip
    run = simulate(law, plant, duration=5.0)
    assert run.ended == pytest.approx(1.4)
    for name, said in (("Nope-v1", "no environment 'Nope-v1'"), ("FrozenLake-v1", "not numbers")):
        with pytest.raises(PlantError, match=said):
            find_plant(f"gym:{name}")


# --- FMUs ---

DESCRIPTION = {
    2: """<fmiModelDescription fmiVersion="2.0" modelName="lag" guid="{{lag}}">{kinds}
<UnitDefinitions><Unit name="K"/></UnitDefinitions><ModelVariables>
<ScalarVariable name="power" valueReference="1" causality="input" variability="continuous">
<Real start="0" min="-5" max="5"/></ScalarVariable>
<ScalarVariable name="heat" valueReference="2" causality="output" variability="continuous"
 initial="exact"><Real unit="K" start="0"/></ScalarVariable>
<ScalarVariable name="gain" valueReference="3" causality="parameter" variability="fixed">
<Real start="2"/></ScalarVariable>
<ScalarVariable name="der(heat)" valueReference="4" causality="local" variability="continuous">
<Real derivative="2"/></ScalarVariable></ModelVariables><ModelStructure>
<Outputs><Unknown index="2"/></Outputs><Derivatives><Unknown index="4"/></Derivatives>
<InitialUnknowns><Unknown index="4"/></InitialUnknowns></ModelStructure></fmiModelDescription>""",
    3: """<fmiModelDescription fmiVersion="3.0" modelName="lag" instantiationToken="lag">{kinds}
<UnitDefinitions><Unit name="K"/></UnitDefinitions><ModelVariables>
<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
<Float64 name="power" valueReference="1" causality="input" start="0" min="-5" max="5"/>
<Float64 name="heat" valueReference="2" causality="output" initial="exact" unit="K" start="0"/>
<Float64 name="gain" valueReference="3" causality="parameter" variability="fixed" start="2"/>
<Float64 name="der(heat)" valueReference="4" causality="local" derivative="2"/></ModelVariables>
<ModelStructure><Output valueReference="2"/><ContinuousStateDerivative valueReference="4"/>
<InitialUnknown valueReference="4"/></ModelStructure></fmiModelDescription>""",
}


@pytest.fixture(scope="session")
def unit(tmp_path_factory):
    """Return what makes an FMU of a version and kind with the C compiler at hand."""
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
    need("C compiler")
    compiler = program("C compiler")
    folder = tmp_path_factory.mktemp("units")
    built = {}

    def make(version, *kinds):
        if version not in built:
            library = folder / f"lag{version}{fmpy.sharedLibraryExtension}"
            headers = Path(fmpy.__file__).parent / "c-code"
            # FMPy wants every function of the standard, also those that it never calls.
            names = re.findall(
                r"TYPE +(fmi\d\w+);", (headers / f"fmi{version}Functions.h").read_text()
            )
            stubs = folder / f"stubs{version}.c"
            weak = [f"__attribute__((weak)) int {name}(void) {{ return 0; }}" for name in names]
            stubs.write_text("\n".join(weak))
            source = Path(__file__).parent / "data" / "lag.c"
            command = [compiler, "-shared", "-fPIC", "-w", f"-DFMI={version}", f"-I{headers}"]
            subprocess.run([*command, source, stubs, "-o", library], check=True)
            built[version] = library
        path = folder / f"lag{version}{''.join(kinds)}.fmu"
        words = "".join(f'<{kind} modelIdentifier="lag"/>' for kind in kinds)
        system = fmpy.platform if version == 2 else fmpy.platform_tuple
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", DESCRIPTION[version].format(kinds=words))
            archive.write(built[version], f"binaries/{system}/lag{fmpy.sharedLibraryExtension}")
        return str(path)

    return make


LAW = ("e = error of heat * 2", "drive power = e")
WANTED = {"heat": Signal("step", (1.0,))}


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_for_co_simulation_moves_itself(unit, version):
    plant = find_plant(unit(version, "ModelExchange", "CoSimulation"))
    assert (plant.name, plant.inputs["power"].high, plant.outputs["heat"].unit) == ("lag", 5.0, "K")
    for gain in (2.0, 1.0):
        chosen = with_parameters(plant, {"gain": gain})
        run = simulate(controller(*LAW), chosen, reference=WANTED, duration=0.4)
        y = 0.0
        for shown in run.outputs["heat"]:
            assert shown == y
            u = min(2.0 * (1.0 - y), 5.0)
            for _ in range(8):
                y += (gain * u - y) / 0.5 * 0.02 / 8


@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
@pytest.mark.parametrize(("whole", "part"), [(0, 0.013), (1, 0.0), (2, 0.004)])
def test_the_actuator_of_a_unit_is_late_to_the_instant(unit, kind, whole, part):
    late = with_actuators(find_plant(unit(3, kind)), {}, {"power": whole * 0.02 + part})
    found = simulate(controller(*LAW), copy.copy(late), reference=WANTED, duration=0.4)
    y, line = 0.0, [0.0] * (whole + 1)

    def moved(y, u, h):
        if kind == "CoSimulation":  # by eight steps, as the unit itself
            for _ in range(8):
                y += (2.0 * u - y) / 0.5 * h / 8
            return y
        return 2.0 * u + (y - 2.0 * u) * math.exp(-h / 0.5)

    for shown in found.outputs["heat"]:
        assert shown == pytest.approx(y, rel=1e-12 if kind == "CoSimulation" else 1e-6)
        line.append(min(2.0 * (1.0 - y), 5.0))
        before = line.pop(0)
        y = moved(y, before, part) if part else y
        y = moved(y, line[0], 0.02 - part)


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_for_model_exchange_moves_by_our_steps(unit, version):
    control = pytest.importorskip("control", reason="python-control is not installed")
    from fuzzyarm.plant.adapters import ControlPlant

    plant = find_plant(unit(version, "ModelExchange"))
    assert list(plant.states) == ["state1"]
    same = control.nlsys(lambda t, x, u, p: [(2.0 * u[0] - x[0]) / 0.5], lambda t, x, u, p: x,
                         inputs="power", outputs="heat", states=1)  # fmt: skip
    here = simulate(controller(*LAW), plant, reference=WANTED, duration=0.4).outputs["heat"]
    there = simulate(controller(*LAW), ControlPlant(same), reference=WANTED, duration=0.4)
    np.testing.assert_array_equal(here, there.outputs["heat"])


def test_a_unit_may_say_that_it_is_over(unit):
    plant = find_plant(unit(3, "CoSimulation"))
    run = simulate(controller("e = reference heat * 2", "drive power = e"), plant,
                   reference=WANTED, duration=5.0)  # fmt: skip
    # x = 4 (1 - exp(-t / 0.5)) passes 1.9 after 0.32 s.
    assert run.diverged is None
    assert run.ended == pytest.approx(0.34, abs=0.021)


def test_copies_of_a_unit_run_side_by_side(unit):
    plant = find_plant(unit(2, "CoSimulation"))
    first = simulate(controller(*LAW), plant, reference=WANTED, duration=0.4).outputs["heat"]
    for other in (copy.copy(plant), pickle.loads(pickle.dumps(plant)), plant):
        run = simulate(controller(*LAW), other, reference=WANTED, duration=0.4)
        np.testing.assert_array_equal(run.outputs["heat"], first)


def test_damaged_units_and_those_of_other_machines_are_errors(unit, tmp_path):
    whole = Path(unit(2, "CoSimulation"))
    cut = tmp_path / "cut.fmu"
    cut.write_bytes(whole.read_bytes()[:900])
    with pytest.raises(PlantError, match="is not an FMU"):
        UnitPlant(str(cut))
    with pytest.raises(FileNotFoundError):
        find_plant("no/such.fmu")
    bare = tmp_path / "bare.fmu"
    kinds = '<CoSimulation modelIdentifier="lag"/>'
    with zipfile.ZipFile(bare, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION[2].format(kinds=kinds))
    with pytest.raises(PlantError, match="cannot be started"):
        simulate(controller(*LAW), find_plant(str(bare)), reference=WANTED, duration=0.1)
    eventful = tmp_path / "eventful.fmu"
    words = DESCRIPTION[2].format(kinds='<ModelExchange modelIdentifier="lag"/>')
    with zipfile.ZipFile(eventful, "w") as archive:
        archive.writestr("modelDescription.xml",
                         words.replace('guid=', 'numberOfEventIndicators="2" guid='))  # fmt: skip
    with pytest.raises(PlantError, match="has events"):
        find_plant(str(eventful))


def test_the_command_runs_an_environment_and_says_when_it_ended(gymnasium, capsys):
    words = ["simulate", str(shipped("cartpole.frb")), "--plant", "gym:CartPole-v1", "--step", "0"]
    assert main(words) == 0
    assert "500 samples" in capsys.readouterr().out
    assert main([*words, "--set", "G_theta=-1"]) == 0
    assert "ended by the plant at" in capsys.readouterr().out
    assert main([*words, "--set", "G_theta=-1", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["ended"] == pytest.approx(0.02 * data["samples"])
    assert data["diverged"] is None
    assert main(["simulate", words[1], "--plant", "gym:Nope-v1"]) == 1
    assert "no environment 'Nope-v1'" in capsys.readouterr().err
