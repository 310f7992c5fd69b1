"""Controllers in plain Python on any plant: by the names of its ports, alone and in sums."""

import math

import pytest

from fuzzyarm.control.controllers import Controller, controller
from fuzzyarm.control.controllers.catalogue import controller_in
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.own import find_controller
from fuzzyarm.control.loop import Options, Sensor, simulate, simulate_many
from fuzzyarm.plant import reach_return
from fuzzyarm.plant.own import find_plant

PI = """
controller pi
period 10 s
axis room
  e = error of temperature
  i = integral of e
  u = e * 2 + i * 0.02
  drive power = u
"""

WARM = {"reference": {"temperature": 25.0}, "duration": "2h"}


def text(words):
    return controller_in(words, "own.frb")


class Pi(Controller):
    name = "mine"
    period = 10.0

    def start(self, single=False):
        self.sum = 0.0

    def step(self, measured, reference):
        error = reference["temperature"] - measured["temperature"]
        self.sum += error * self.period
        return {"power": 2.0 * error + 0.02 * self.sum}


class One(Pi):
    def step(self, measured, reference):
        return super().step(measured, reference)["power"]


@pytest.mark.parametrize("kind", [Pi, One])
def test_a_controller_in_python_does_what_its_text_does(kind):
    own, written = simulate(kind(), "room", **WARM), simulate(text(PI), "room", **WARM)
    assert own.outputs["temperature"] == pytest.approx(written.outputs["temperature"], abs=1e-9)
    assert simulate(kind(), "room", **WARM).rms == own.rms  # each run starts it anew


def test_what_it_notes_is_there_after_the_run():
    class Noting(Pi):
        def start(self, single=False):
            super().start(single)
            self.notes = []

        def step(self, measured, reference):
            self.notes.append(measured["temperature"])
            return super().step(measured, reference)

    noting = Noting()
    runs = [simulate(noting, "room", **WARM) for _ in range(2)]
    assert runs[0].rms == runs[1].rms
    assert noting.notes[1:] == runs[1].outputs["temperature"][1:].tolist()


def test_sensors_and_limits_are_those_of_every_controller():
    options = Options(sensors={"temperature": Sensor(0.1, 0.5, 20.0)}, seed=4)
    own = simulate(Pi(), "room", options=options, **WARM)
    written = simulate(text(PI), "room", options=options, **WARM)
    assert own.outputs["temperature"] == pytest.approx(written.outputs["temperature"], abs=1e-9)
    assert own.drives["power"].max() == 100.0


def test_texts_and_python_add_up():
    both = simulate(text(PI) + Pi(), "room", **WARM)
    twice = PI.replace("e * 2 + i * 0.02", "e * 4 + i * 0.04")
    whole = simulate(text(twice), "room", **WARM)
    assert both.outputs["temperature"] == pytest.approx(whole.outputs["temperature"], abs=1e-9)
    changed = text(PI.replace("axis", "gain K = 2\naxis").replace("e * 2", "e * K"))
    sum_of = (changed + Pi()).with_gains({"K": [0.0]})
    apart = simulate(text(PI.replace("e * 2 + i * 0.02", "e * 2 + i * 0.04")), "room", **WARM)
    found = simulate(sum_of, "room", **WARM)
    assert found.outputs["temperature"] == pytest.approx(apart.outputs["temperature"], abs=1e-9)


def test_names_are_joined():
    class Other(Pi):
        def step(self, measured, reference):
            named = {"temperature": measured["T"]}, {"temperature": reference["T"]}
            return {"heat": super().step(*named)["power"]}

    connect = {"T": "temperature", "heat": "power"}
    run = simulate(Other(), "room", connect=connect, **WARM)
    assert run.rms == simulate(Pi(), "room", **WARM).rms
    assert run.notes == ()
    with pytest.raises(SourceError, match="the room has no port 'temp'"):
        simulate(Other(), "room", connect={"T": "temp"}, **WARM)


def test_on_the_arm_it_drives_torques():
    class Ports(Controller):
        period = 0.0006
        every = 5

        def step(self, measured, reference):
            return {
                f"{joint}.torque": 100.0
                * (reference[f"{joint}.position"] - measured[f"{joint}.position"])
                - 20.0 * measured[f"{joint}.velocity"]
                for joint in ("joint1", "joint2")
            }

    class Torques(Controller):
        def torque(self, reference, state, clock):
            return [
                100.0 * (reference.position[k] - state.position[k]) - 20.0 * state.velocity[k]
                for k in (0, 1)
            ]

    path = reach_return((20.0, -10.0), segment=0.05, hold=0.02)
    runs = [simulate(kind(), path) for kind in (Ports, Torques)]
    assert runs[0].error_matrix.tolist() == runs[1].error_matrix.tolist()
    sums = [simulate(controller("ie") + kind(), path) for kind in (Ports, Torques)]
    assert sums[0].error_matrix == pytest.approx(sums[1].error_matrix, abs=1e-12)


def test_many_runs_take_it():
    many = simulate_many(Pi(), "room", {"C_a": [1e5, 2e5]}, workers=1, **WARM)
    assert many.rms[0, 0] < many.rms[1, 0]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"powr": 1.0}, "the room has no drive 'powr'"),
        ({"power": "a lot"}, "mine gives 'a lot' for 'power', not a number"),
        (None, "mine gives None for 'power', not a number"),
        (math.nan, "mine gives nan for 'power', not a number"),
    ],
)
def test_what_it_gives_is_judged(given, message):
    class Wrong(Pi):
        def step(self, measured, reference):
            return given

    with pytest.raises(SourceError, match=message):
        simulate(Wrong(), "room", **WARM)


def test_which_input_is_meant_must_be_said():
    class Single(Controller):
        period = 0.001

        def step(self, measured, reference):
            return 1.0

    with pytest.raises(SourceError, match="does not name the input that it drives"):
        simulate(Single(), reach_return((20.0, -10.0), segment=0.05, hold=0.02))


def test_a_period_must_be_said():
    class Timeless(Pi):
        period = None

    with pytest.raises(SourceError, match="has no control period"):
        simulate(Timeless(), "room", **WARM)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"period": 0.0}, "period of mine is 0.0"),
        ({"period": "10 ms"}, "period of mine is '10 ms'"),
        ({"period": -1.0}, "period of mine is -1.0"),
        ({"every": 0}, "every of mine is 0"),
        ({"every": 2.5}, "every of mine is 2.5"),
    ],
)
def test_how_often_it_runs_is_judged(changes, message):
    with pytest.raises(SourceError, match=message):
        simulate(type("Own", (Pi,), changes)(), "room", **WARM)


def test_a_failure_is_that_of_the_controller():
    class Broken(Pi):
        def step(self, measured, reference):
            return 1.0 / 0.0

    class BrokenTorque(Controller):
        def torque(self, reference, state, clock):
            return 1.0 / 0.0

    with pytest.raises(SourceError, match=r"controller mine failed: .*ZeroDivisionError"):
        simulate(Broken(), "room", **WARM)
    with pytest.raises(SourceError, match=r"controller own failed: .*ZeroDivisionError"):
        simulate(BrokenTorque(), reach_return((20.0, -10.0), segment=0.05, hold=0.02))


def test_a_class_in_a_file_and_what_it_does_wrong(tmp_path):
    path = tmp_path / "thermostat.py"
    path.write_text(
        "from fuzzyarm.control.controllers import Controller\n"
        "class Bang(Controller):\n"
        "    period = 10.0\n"
        "    def step(self, measured, reference):\n"
        "        return 100.0 * (measured['temperature'] < reference['temp'])\n"
    )
    with pytest.raises(RuntimeError, match=r"thermostat.py:5: KeyError: \"no 'temp' among temp"):
        simulate(find_controller(path), "room", **WARM)
    path.write_text(path.read_text().replace("'temp'", "'temperature'"))
    run = simulate(find_controller(path), "room", **WARM)
    assert set(run.drives["power"]) == {0.0, 100.0}


@pytest.mark.parametrize("name", ["pd", "cdid"])
def test_a_law_of_the_arm_says_what_it_misses(name):
    message = f"{name} measures joint1.position, which the room does not have"
    with pytest.raises(SourceError, match=message):
        simulate(controller(name), find_plant("room"), **WARM)
