"""Robots of MuJoCo as plants: against our own arm, published figures, and the laws on both."""

from __future__ import annotations

import pickle
import sys
from copy import copy
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install fuzzyarm[plants]")

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.picture import Line
from fuzzyarm.control.controllers.catalogue import controller_in
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.own import find_controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.control.loop.along import trajectory_motion
from fuzzyarm.control.loop.course import Options
from fuzzyarm.control.loop.run import ClosedLoop
from fuzzyarm.plant.arm import UNLOADED, coriolis_matrix, forward_dynamics, inverse_dynamics
from fuzzyarm.plant.drawings import PlantScene, drawing_of
from fuzzyarm.plant.following import trajectory_of, way_points
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import PlantError, with_parameters
from fuzzyarm.plant.robots import RobotPlant
from fuzzyarm.plant.trajectory import reach_return

ROBOTS = Path(__file__).parents[2] / "examples" / "robots"
ARM = str(ROBOTS / "two-link-arm.xml")
PUMA = str(ROBOTS / "puma560.xml")

TWO_JOINTS = """
<mujoco>
  <worldbody>
    <body name="upper"><joint name="hip" axis="0 1 0" range="-1 1" limited="true"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03" mass="1"/>
      <body name="lower" pos="0 0 -.3"><joint name="{second}" type="{kind}" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03" mass="0.5"/></body></body>
  </worldbody>
  <actuator>{actuators}</actuator>
</mujoco>
"""


def robot(folder: Path, actuators: str = "", second: str = "knee", kind: str = "hinge") -> str:
    path = folder / "my robot ü.xml"
    path.write_text(TWO_JOINTS.format(actuators=actuators, second=second, kind=kind), "utf-8")
    return str(path)


@pytest.mark.parametrize("law", ["pd", "fuzzy-direct"])
def test_the_arm_of_mujoco_runs_as_our_own(law: str) -> None:
    trajectory = reach_return((40.0, -60.0), 0.6, 0.2)
    fine = Options(runge_kutta=1)
    ours = simulate(law, "arm", trajectory=trajectory, options=fine)
    theirs = simulate(law, ARM, trajectory=trajectory)
    # Both by Runge-Kutta steps of 0.6 ms; of the two, ours has the motor's torque held in a step.
    for name, angles in ours.outputs.items():
        bound = 1e-9 if law == "pd" else 2e-4 if "position" in name else 5e-3
        np.testing.assert_allclose(theirs.outputs[name], angles, atol=bound, rtol=0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "gains", "seconds"),
    [
        ("mrac", {}, 1.5),
        ("mrac", {"inertia_times_u": [1.0], "gravity": [0.0]}, 1.5),
        ("dac", {"C": [1.1]}, 3.0),  # it diverges on fast moves
    ],
)
def test_an_adaptive_law_on_a_robot_is_that_of_the_arm(
    law: str, gains: dict[str, list[float]], seconds: float
) -> None:
    trajectory, fine = reach_return((30.0, -40.0), seconds, 0.2), Options(runge_kutta=1)
    controller = find_controller(law).with_gains(gains)
    # The model on the robot is that of the file: the arm without its load.
    numbers = {f"model.{name}": [value] for name, value in asdict(UNLOADED).items()}
    known = {name: value for name, value in numbers.items() if name in controller.gains}
    ours = simulate(controller.with_gains(known), "arm", trajectory=trajectory, options=fine)
    theirs = simulate(controller, ARM, trajectory=trajectory)
    assert ours.diverged is None
    for name in ("joint1.position", "joint2.position"):
        np.testing.assert_allclose(theirs.outputs[name], ours.outputs[name], atol=1e-7, rtol=0.0)


def test_the_inverse_dynamics_of_the_arm_are_ours() -> None:
    plant, generator = RobotPlant(ARM), np.random.default_rng(3)
    for q, v, a, w in generator.normal(size=(20, 4, 2)):
        exact = inverse_dynamics(UNLOADED, q, v, a)
        np.testing.assert_allclose(plant.inverse_dynamics(q, v, a), exact, atol=1e-12)
        # The study's V(q, v) w is not symmetric in v and w: it differs by an antisymmetric part.
        swapped = 0.5 * coriolis_matrix(UNLOADED, q, v) @ w
        swapped += 0.5 * coriolis_matrix(UNLOADED, q, w) @ v
        along = inverse_dynamics(UNLOADED, q, np.zeros(2), a) + swapped + 2.5 * w
        np.testing.assert_allclose(plant.inverse_dynamics(q, v, a, w), along, atol=1e-12)


# Corke, "Robotics, Vision and Control" (Springer 2011), chapter 9: gravity loads at three
# postures, and the inertia at the nominal one.
GRAVITY = {
    (0.0, np.pi / 4, np.pi, 0.0, np.pi / 4, 0.0): (0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0),
    (0.0, 0.0, -np.pi / 2, 0.0, 0.0, 0.0): (0.0, 46.0069, 8.7722, 0.0, 0.0283, 0.0),
    (0.0, np.pi / 2, -np.pi / 2, 0.0, 0.0, 0.0): (0.0, -0.7752, 0.2489, 0.0, 0.0, 0.0),
}
INERTIA = np.array([
    [3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0],
    [-0.4044, 4.4137, 0.3509, 0.0, 0.0024, 0.0],
    [0.1006, 0.3509, 0.9378, 0.0, 0.0015, 0.0],
    [-0.0025, 0.0, 0.0, 0.1925, 0.0, 0.0],
    [0.0, 0.0024, 0.0015, 0.0, 0.1713, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.1941],
])  # fmt: skip


def test_puma_has_the_published_gravity_and_inertia() -> None:
    plant, still = RobotPlant(PUMA), np.zeros(6)
    for posture, published in GRAVITY.items():
        torque = plant.inverse_dynamics(np.array(posture), still, still)
        np.testing.assert_allclose(torque, published, atol=5.1e-5)
    nominal = np.array(next(iter(GRAVITY)))
    gravity = plant.inverse_dynamics(nominal, still, still)
    columns = [plant.inverse_dynamics(nominal, still, unit) - gravity for unit in np.eye(6)]
    published = INERTIA.copy()
    # 0.086 kg m² of the third link violates A + B >= C: the file has 0.0785.
    published[1:3, 1:3] -= 0.0075
    np.testing.assert_allclose(np.array(columns).T, published, atol=5.1e-5)


@pytest.mark.slow
def test_computed_torque_with_an_exact_model_tracks_to_the_error_of_the_integrator() -> None:
    plant = find_plant(PUMA)
    rest = plant.trajectories["reach"].keywords["start"]  # type: ignore[attr-defined, union-attr]
    trajectory = reach_return(tuple(x + 20.0 for x in rest), 1.0, 0.2, start=rest)
    error = {}
    for period in ("2 ms", "1 ms"):
        law = find_controller("ct") + _silent(period)
        error[period] = simulate(law, plant, trajectory=trajectory).rms.max()
    assert error["1 ms"] < 5e-3
    # Torques are held over a period: the error falls with it.
    assert error["1 ms"] < 0.6 * error["2 ms"]


def _silent(period: str) -> Controller:
    """Return a controller that drives nothing, every period."""
    axes = ", ".join(f"joint{k}" for k in range(1, 7))
    lines = f"period {period}\naxis {axes}\n  e = error of position\n  drive torque = e * 0\n"
    return controller_in(f"controller silent\n{lines}", "silent.frb")


def test_a_load_pulls_at_its_site_and_masses_scale() -> None:
    plant, still = RobotPlant(ARM), np.zeros(2)

    def sag(values: dict[str, float]) -> float:
        """Return the acceleration of the first joint from rest, rad/s²."""
        at = with_parameters(plant, values)
        numbers = [p.value for p in at.parameters.values()]  # type: ignore[union-attr]
        after = at.step(0.0, [0.0] * 4, [0.0] * 4, [*numbers, 0.0, 0.0], 1e-4)
        return float(after[2]) / 1e-4

    def exact(load: float, factor: float) -> float:
        arm = UNLOADED.with_values(
            m_1=2.0 * factor, m_2=2.0 * factor + load, I_1=0.09 * factor,
            x_2=(2.0 * factor * 0.14 + load * 0.28) / (2.0 * factor + load),
            I_2=0.09 * factor + 2.0 * factor * load / (2.0 * factor + load) * 0.14**2,
        )  # fmt: skip
        return float(forward_dynamics(arm, still, still, still)[0])

    for load, factor in ((0.0, 1.0), (2.5, 1.0), (0.0, 1.2), (0.7, 0.5)):
        assert sag({"load": load, "masses": factor}) == pytest.approx(exact(load, factor), rel=2e-3)
    # The model of the controllers stays that of the file.
    heavy = with_parameters(plant, {"masses": 2.0})
    assert isinstance(heavy, RobotPlant)
    np.testing.assert_array_equal(
        heavy.inverse_dynamics(still, still, still), plant.inverse_dynamics(still, still, still)
    )


def test_copies_and_other_processes_have_the_parameters() -> None:
    plant = with_parameters(find_plant(PUMA), {"load": 1.5, "gravity": 3.7})
    for other in (copy(plant), pickle.loads(pickle.dumps(plant))):
        assert other.parameters == plant.parameters
        law = find_controller("pd")
        trajectory = way_points(plant, [(10.0, 60.0, -170.0, 5.0, 40.0, 3.0)], 0.1)
        one, two = (simulate(law, each, trajectory=trajectory) for each in (plant, other))
        for name, values in one.outputs.items():
            np.testing.assert_array_equal(values, two.outputs[name])


@pytest.mark.slow
def test_a_file_without_actuators_is_driven_at_its_joints(tmp_path: Path) -> None:
    plant = find_plant(robot(tmp_path))
    assert list(plant.inputs) == ["hip.torque", "knee.torque"]
    assert plant.inputs["hip.torque"].high == np.inf
    assert (plant.outputs["hip.position"].low, plant.outputs["hip.position"].high) == pytest.approx(
        np.radians([-1.0, 1.0])
    )
    sliding = find_plant(robot(tmp_path, kind="slide"))
    assert list(sliding.inputs) == ["hip.torque", "knee.force"]
    strong = find_controller("ct").with_gains({"K_P": [400.0], "K_D": [40.0]})
    run = simulate(strong, sliding, trajectory=trajectory_of(sliding, "reach", segment=0.5))
    assert set(run.driven) == {"hip.torque", "knee.force"}
    assert run.wanted["knee.position"][-1] == pytest.approx(0.1)
    assert abs(run.error_matrix[-1]).max() < 1e-2
    assert sliding.outputs["knee.position"].unit == "m"


def test_actuators_give_limits_and_servos_are_left_out(tmp_path: Path) -> None:
    servo = '<position joint="hip" kp="500" forcelimited="true" forcerange="-7 7"/>'
    motor = '<motor joint="knee" gear="5" ctrllimited="true" ctrlrange="-2 2"/>'
    plant = find_plant(robot(tmp_path, servo + motor))
    assert (plant.inputs["hip.torque"].low, plant.inputs["hip.torque"].high) == (-7.0, 7.0)
    assert (plant.inputs["knee.torque"].low, plant.inputs["knee.torque"].high) == (-10.0, 10.0)
    bare = find_plant(robot(tmp_path))
    numbers = [p.value for p in bare.parameters.values()]  # type: ignore[union-attr]
    start = [0.4, 0.1, 0.0, 0.0]
    # A servo would hold the joint at 0; its place is the controller's.
    assert plant.step(0.0, start, [0.0, 0.0], numbers, 0.01) == pytest.approx(
        bare.step(0.0, start, [0.0, 0.0], numbers, 0.01), abs=1e-12
    )


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "my robot"),
        ("<mujoco>\n<worldbody>\n<body>\n</worldbody>", "Line number"),
        (
            '<mujoco><worldbody><body name="a"><joint axs="1"/></body></worldbody></mujoco>',
            "line 1",
        ),
        ("<mujoco><worldbody/></mujoco>", "no hinge or slide joint"),
        ('<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody></mujoco>', "no"),
    ],
)
def test_a_damaged_robot_is_one_sentence(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "my robot.xml"
    path.write_text(content)
    with pytest.raises(PlantError, match=message):
        find_plant(str(path))
    with pytest.raises(OSError, match="missing"):
        find_plant(str(tmp_path / "missing.xml"))


def test_what_a_law_of_the_study_cannot_do_on_a_robot_is_said(tmp_path: Path) -> None:
    plant = find_plant(ARM)
    with pytest.raises(FuzzyarmError, match="adapts the parameters of the study's arm"):
        simulate("acdid", plant)
    uneven = find_controller("pd").with_gains({"K_P": [100.0, 50.0]})
    with pytest.raises(FuzzyarmError, match="K_P differs between joints"):
        simulate(uneven, plant)
    modelled = find_controller("ct").with_gains({"model.m_1": [3.0]})
    with pytest.raises(FuzzyarmError, match=r"model\.m_1 is of the two-link arm"):
        simulate(modelled, plant)
    loose = find_plant(robot(tmp_path, '<motor joint="hip"/>'))
    with pytest.raises(FuzzyarmError, match="joints without a drive"):
        simulate("ct", loose, trajectory=way_points(loose, [(10.0,)], 0.1))


def test_a_run_that_diverges_ends_as_one() -> None:
    wild = find_controller("pd").with_gains({"K_P": [-1e6]})
    run = simulate(wild, find_plant(ARM), trajectory=reach_return((5.0, 5.0), 1.0, 0.1))
    assert run.diverged is not None


def test_a_robot_is_drawn_with_its_set_point() -> None:
    plant = find_plant(PUMA)
    run = simulate("pd", plant, trajectory=way_points(plant, [(10.0,) * 6], 0.05))
    drawing = drawing_of(plant, PlantScene(run, run.samples - 1))
    assert drawing is not None
    tones = [part.tone for part in drawing.parts if isinstance(part, Line)]
    assert tones.count("first") == tones.count("wanted") >= 6
    left, right, low, high = drawing.stage
    assert all(
        left <= x <= right and low <= y <= high
        for part in drawing.parts
        if isinstance(part, Line)
        for x, y in zip(part.x, part.y, strict=True)
    )


@pytest.mark.parametrize("value", [{"masses": 0.0}, {"mass_link2": -1.0}, {"load": -0.5}])
def test_a_mass_is_positive(value: dict[str, float]) -> None:
    with pytest.raises(PlantError, match="out of range"):
        simulate("pd", with_parameters(find_plant(ARM), value))


def test_mujoco_writes_no_file_and_prints_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    test_a_run_that_diverges_ends_as_one()
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")


def test_robots_of_menagerie_have_its_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = (
        "class MenagerieError(Exception):\n    pass\n"
        "class Robot:\n    def xml(self):\n        return ARM\n"
        "def names():\n    return ['two_link_arm', 'other']\n"
        "def get(name):\n    if name == 'other':\n        raise MenagerieError('no line')\n"
        f"    return Robot()\nARM = {ARM!r}\n"
    )
    if find_spec("mujoco_menagerie") is None:
        with pytest.raises(PlantError, match="needs the package") as error:
            find_plant("menagerie:arm")
        assert error.value.hint == "pip install mujoco-menagerie"
    (tmp_path / "mujoco_menagerie.py").write_text(package)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "mujoco_menagerie", raising=False)
    assert find_plant("menagerie:two_link_arm").name == "two_link_arm"
    with pytest.raises(PlantError, match="has no 'arm'") as error:
        find_plant("menagerie:arm")
    assert error.value.hint == "did you mean 'two_link_arm'?"
    with pytest.raises(PlantError, match="no line"):
        find_plant("menagerie:other")
    monkeypatch.delitem(sys.modules, "mujoco_menagerie")


@pytest.mark.slow
def test_a_run_leaves_no_sum_behind() -> None:
    plant, law = find_plant(ARM), find_controller("ffid+ie").with_gains({"whole_run": [1.0]})
    loop = ClosedLoop(law, trajectory_motion(plant, reach_return((20.0, 10.0), 0.3, 0.1), law))
    first, second = loop.run(), loop.run()
    np.testing.assert_array_equal(first.error_matrix, second.error_matrix)
