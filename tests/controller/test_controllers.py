"""Names, sums, gains, and controllers of one's own."""

import textwrap

import numpy as np
import pytest

from fuzzyarm import shipped
from fuzzyarm.control.controllers import (
    CATALOGUE,
    Controller,
    GainError,
    OwnControllerError,
    UnknownControllerError,
    controller,
    find_controller,
)
from fuzzyarm.control.controllers.catalogue import TextEntry
from fuzzyarm.control.loop import Options, simulate
from fuzzyarm.plant import Clock, Reference, State, reach

CLOCK = Clock(0.0006, False, False)
REFERENCE = Reference((0.3, -0.2), (0.5, 0.1), (1.0, 2.0))
STATE = State((0.1, 0.1), (0.2, -0.3))
INTERPRETED = Options(compiled=False)


class Spring(Controller):
    name = "spring"

    def torque(self, reference, state, clock):
        return tuple(
            70.0 * (d - q) for d, q in zip(reference.position, state.position, strict=True)
        )


def torque(made):
    made.start()
    return np.array(made.torque(REFERENCE, STATE, CLOCK))


def test_every_name_of_the_catalogue_makes_a_controller_of_that_name():
    for name in CATALOGUE:
        assert controller(name).name == name


def test_the_conventional_and_adaptive_controllers_are_there():
    wanted = "pd pid pid-modified ct ffid cdid ct+ie ffid+ie cdid+ie acdid acdid+ie mrac mrac+ie"
    assert set((wanted + " dac dac+ie").split()) <= set(CATALOGUE)


@pytest.mark.parametrize(
    ("name", "near"),
    [("cidd", "cdid"), ("acidd", "acdid"), ("pid-modifed", "pid-modified"), ("CDID", "cdid")],
)
def test_unknown_name_suggests_a_near_one(name, near):
    with pytest.raises(UnknownControllerError, match=f"'{near}'") as caught:
        controller(name)
    assert caught.value.name == name
    assert near in caught.value.near


def test_unknown_name_far_from_all_suggests_the_list():
    with pytest.raises(UnknownControllerError, match="--list"):
        controller("zzzzzzzz")


@pytest.mark.parametrize("name", ["pd+", "+pd", "pd++ct", "", "pd+nothing"])
def test_sums_with_a_hole_are_unknown(name):
    with pytest.raises(UnknownControllerError):
        controller(name)


def test_sums_add_torques_whatever_they_are_made_of():
    both = controller("pd") + Spring() + controller("cdid")
    assert both.name == "pd+spring+cdid"
    parts = torque(controller("pd")) + torque(Spring()) + torque(controller("cdid"))
    np.testing.assert_allclose(torque(both), parts)
    named = controller("pd + cdid")
    np.testing.assert_allclose(torque(named), torque(controller("pd")) + torque(controller("cdid")))


@pytest.mark.slow
def test_sum_with_own_part_runs_and_equals_the_compiled_part_plus_nothing():
    class Nothing(Controller):
        def torque(self, reference, state, clock):
            return 0.0, 0.0

    path = reach((30.0, -30.0), 0.2)
    mixed = simulate(controller("cdid+ie") + Nothing(), path)
    alone = simulate(controller("cdid+ie"), path, options=INTERPRETED)
    assert not mixed.compiled
    np.testing.assert_array_equal(mixed.error_matrix, alone.error_matrix)


def test_gains_are_data():
    gains = controller("mrac+ie").gains
    assert gains["K_1"].value == (500.0, 500.0)
    assert gains["K_1"].origin == "identified"
    assert gains["K_I"].origin == "identified"
    assert gains["model.m_1"].unit == "kg"
    assert controller("cdid").gains["Lambda"].origin == "printed"
    assert controller("stfc").gains["G_e"].origin == "printed"
    assert controller("hfie").gains["K_I"].origin == "identified"
    assert controller("pd-motor").gains["G_e"].origin == "own"
    assert find_controller(str(shipped("stfc.frb"))).gains["G_e"].origin == "own"
    for name in CATALOGUE:
        for gain in controller(name).gains.values():
            assert gain.unit
            # In a text its name says it.
            assert gain.meaning or isinstance(CATALOGUE[name], TextEntry)


def test_overriding_gains():
    made = controller("pd").with_gains({"K_P": [200.0], "K_D": [1.0, 2.0]})
    assert made.gains["K_P"].value == (200.0, 200.0)
    assert made.gains["K_D"].value == (1.0, 2.0)
    assert made.gains["K_D"].origin == "given"
    np.testing.assert_allclose(torque(made), [200 * 0.2 + 0.3, 200 * -0.3 + 2 * 0.4])
    # The original is untouched.
    assert controller("pd").gains["K_P"].value == (100.0, 100.0)


def test_overriding_gains_of_sums():
    both = controller("pd+cdid")
    assert {"pd:K_D", "cdid:K_D", "K_P", "Lambda"} <= set(both.gains)
    one = both.with_gains({"cdid:K_D": [7.0]})
    assert one.gains["pd:K_D"].value == (50.0, 50.0)
    assert one.gains["cdid:K_D"].value == (7.0, 7.0)
    every = both.with_gains({"K_D": [7.0]})
    assert every.gains["pd:K_D"].value == every.gains["cdid:K_D"].value == (7.0, 7.0)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"K_Q": [1.0]}, "did you mean .K_P."),
        ({"K_P": [1.0, 2.0, 3.0]}, "1 or 2 numbers"),
        ({"K_P": [float("nan")]}, "out of range"),
        ({"K_P": [1e13]}, "out of range"),
        ({"ct:K_P": [1.0]}, "no gain"),
    ],
)
def test_gains_out_of_sense_are_refused(values, message):
    for made in (controller("pd"), controller("pd+ie")):
        with pytest.raises(GainError, match=message):
            made.with_gains(values)


def test_gains_that_must_be_positive():
    with pytest.raises(GainError, match="positive"):
        controller("mrac").with_gains({"K_1": [0.0]})


def test_cold_start_forgets_the_arm():
    assert controller("acdid", start="cold").gains["model.m_1"].value == (0.0,)
    assert controller("acdid", start="cold").gains["model.J_1"].value == (0.1498,)
    assert controller("mrac", start="cold").gains["model.J_1"].value == (0.0,)
    assert controller("acdid").gains["model.m_1"].value == (1.0,)


OWN = """
from fuzzyarm.control.controllers import Controller

class Mine(Controller):
    def start(self, single=False):
        self.sums = [0.0, 0.0]

    def torque(self, reference, state, clock):
        out = []
        for joint in (0, 1):
            error = reference.position[joint] - state.position[joint]
            self.sums[joint] += error
            rate = reference.velocity[joint] - state.velocity[joint]
            out.append(100.0 * error + 50.0 * rate + 0.25 * self.sums[joint])
        return out
"""


@pytest.mark.slow
def test_own_controller_from_a_file(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(OWN)
    made = find_controller(f"{file}:Mine")
    assert made.name == "mine"
    path = reach((30.0, -30.0), 0.3)
    ours = simulate(controller("pid"), path, options=INTERPRETED)
    np.testing.assert_allclose(simulate(made, path).error_matrix, ours.error_matrix, atol=1e-9)
    both = find_controller(f"{file} + ie")
    assert both.name == "mine+ie"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("def (", r"mine\.py:1: "),
        ("x = 1", "no classes derived from Controller"),
        ("raise ValueError('oops')", r"mine\.py:1: ValueError: oops"),
        (OWN + "\nclass Other(Mine): pass", "2 classes"),
        (
            "from fuzzyarm.control.controllers import Controller\nclass A(Controller):\n"
            "    def __init__(self, x): pass\n",
            "TypeError",
        ),
    ],
)
def test_unusable_files_say_one_sentence(tmp_path, text, message):
    file = tmp_path / "mine.py"
    file.write_text(text)
    with pytest.raises(OwnControllerError, match=message) as caught:
        find_controller(str(file))
    assert "\n" not in str(caught.value)
    assert caught.value.path == str(file)


def test_missing_class_and_missing_file(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(OWN)
    with pytest.raises(OwnControllerError, match="its controllers: Mine"):
        find_controller(f"{file}:Yours")
    with pytest.raises(FileNotFoundError):
        find_controller(str(tmp_path / "none.py"))


def test_own_controller_that_fails_while_running_names_its_line(tmp_path):
    file = tmp_path / "bad.py"
    file.write_text(
        textwrap.dedent("""\
        from fuzzyarm.control.controllers import Controller
        class Bad(Controller):
            def torque(self, reference, state, clock):
                return 1.0 / 0.0, 0.0
        """)
    )
    with pytest.raises(OwnControllerError, match=r"bad\.py:4: ZeroDivisionError"):
        simulate(find_controller(str(file)), reach(segment=0.1, hold=0.1))


def test_controller_without_torque_says_so():
    with pytest.raises(TypeError, match="torque"):
        Controller().torque(REFERENCE, STATE, CLOCK)


def test_fuzzy_in_a_sum_is_the_table_controller():
    from fuzzyarm.control.controllers import controller

    assert controller("cdid+ie+fuzzy").name == controller("cdid+ie+fuzzy-lut").name
