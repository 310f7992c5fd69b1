"""A run in parts: the bits of a whole one, pushes as loads, gains and texts while it goes on."""

import numpy as np
import pytest

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers import find_controller
from fuzzyarm.control.controllers.catalogue import controller_in
from fuzzyarm.control.loop import Options, Sensor, Signal
from fuzzyarm.control.loop.along import trajectory_motion
from fuzzyarm.control.loop.open_run import StructureError
from fuzzyarm.control.loop.run import ClosedLoop, plant_motion
from fuzzyarm.plant import Arm, find_plant, reach_return

NOISY = Options(
    sensors={
        "position": Sensor(noise=1e-3, delay=3e-3, resolution=1e-4),
        "velocity": Sensor(difference=2e-3),
    },
    disturbance=1e-4,
    interpolate=True,
    loads={"voltage": Signal("sine", (0.5, 3.0))},
)


def loop_of(name, plant, options=None, duration=None, reference=None):
    controller = find_controller(str(shipped(f"{name}.frb")))
    made = find_plant(plant)
    followed = plant_motion(controller, made, reference, duration)
    return controller, ClosedLoop(controller, followed, options=options)


def bits(run):
    columns = [run.time, run.error_matrix, *run.columns().values()]
    return [np.asarray(each).tobytes() for each in columns], run.chatter, run.memory


def in_parts(loop, controller, sizes=(1, 7, 2, 31), **given):
    found = loop.open(**given)
    turn = 0
    while not found.over:
        found.advance(found.next + sizes[turn % len(sizes)])
        if turn % 5 == 0:
            found.take_over(controller)
        turn += 1
    return loop.answer(found)


@pytest.mark.parametrize(
    ("name", "plant", "options", "duration"),
    [
        ("servo", "motor", NOISY, 0.3),
        ("servo", "motor", Options(compiled=False), 0.02),
        ("tanks", "tanks", None, 60.0),  # with an integral
        ("heater", "room", None, 3600.0),
        ("ball-and-beam", "ball-and-beam", None, 2.0),  # falls off
    ],
)
def test_a_run_in_parts_has_the_bits_of_a_whole_one(name, plant, options, duration):
    controller, loop = loop_of(name, plant, options, duration)
    whole = bits(loop.run())
    assert bits(in_parts(loop, controller, loaded=True)) == whole
    assert bits(in_parts(loop, controller)) == whole


def test_so_has_a_run_of_the_arm_with_its_load():
    way = reach_return(segment=0.3, hold=0.2)
    controller = find_controller("soc-table")
    loop = ClosedLoop(controller, trajectory_motion(Arm(), way, payload=True))
    assert bits(in_parts(loop, controller, loaded=True)) == bits(loop.run())


def test_a_push_is_a_load():
    _, still = loop_of("servo", "motor", None, 0.2)
    _, loaded = loop_of(
        "servo", "motor", Options(loads={"voltage": Signal("step", (5.0, 0.1))}), 0.2
    )
    found = still.open(loaded=True)
    found.advance(100)
    found.push({("shaft", "voltage"): 5.0})
    found.advance(150)
    found.advance()
    assert bits(still.answer(found)) == bits(loaded.run())
    with pytest.raises(ValueError, match="pushed"):
        still.open().push({})


def test_a_gain_counts_from_the_next_period_on():
    controller, loop = loop_of("servo", "motor", None, 0.1)
    found = loop.open()
    found.advance(60)
    found.take_over(controller.with_gains({"G_u": [9.0]}))
    found.advance()
    changed, before = loop.answer(found).drives["voltage"], loop.run().drives["voltage"]
    assert changed[:60].tobytes() == before[:60].tobytes()
    assert changed[60] == pytest.approx(2.0 * before[60], abs=1e-12)
    assert abs(before[60]) > 0.1


SERVO = shipped("servo.frb").read_text()


def test_a_text_of_the_same_structure_is_taken_up_and_another_is_not():
    _, loop = loop_of("servo", "motor", None, 0.1)
    path = str(shipped("servo.frb"))
    found = loop.open()
    found.advance(60)
    for other in (
        SERVO.replace("period 1 ms", "period 2 ms"),
        SERVO.replace("e  = error of position * G_e", "e  = error of position * G_e * 0.5"),
        SERVO.replace("gain G_u", "gain G_v").replace("* G_u", "* G_v"),
        SERVO.replace("drive voltage = u", "v = integral of u\n  drive voltage = v"),
    ):
        with pytest.raises(StructureError):
            found.take_over(controller_in(other, path))
    found.take_over(controller_in(SERVO.replace("= 4.5", "= 9  # twice"), path))
    found.advance()
    assert loop.answer(found).drives["voltage"][60] != loop.run().drives["voltage"][60]


def test_terms_and_rules_change_while_an_integral_stays(tmp_path):
    text = shipped("tanks.frb").read_text()
    rules = shipped("roompi.frb").read_text()
    path = str(tmp_path / "tanks.frb")
    (tmp_path / "roompi.frb").write_text(rules)
    controller = controller_in(text, path)
    level = {"level2": Signal("step", (0.1,))}
    loop = ClosedLoop(controller, plant_motion(controller, find_plant("tanks"), level, 400.0))
    found = loop.open()
    found.advance(580)
    for number, (old, new) in enumerate(
        (
            ("  Z       NM  Z   PM", "  Z       NM  Z   PB"),
            ("\n\ninference", "\nterm e Z: triangle -0.5 0 0.5\n\ninference"),
            ("triangles N Z P", "gaussians N Z P"),
        )
    ):
        rules = rules.replace(old, new)
        (tmp_path / f"rules{number}.frb").write_text(rules)
        changed = text.replace("roompi.frb", f"rules{number}.frb")
        before = len(found.program.memory)
        found.take_over(controller_in(changed, path))
        found.advance(found.next + 20)
        assert len(found.program.memory) != before or number == 0
    drives = loop.answer(found).drives["pump"]
    # It goes on holding the level; wider sets act before the integral has made up for them.
    assert drives[580:] == pytest.approx(drives[579], abs=1.5)
    assert drives[579] > 5.0


def test_what_an_integral_has_summed_stays_when_a_gain_moves():
    controller, loop = loop_of("tanks", "tanks", None, 300.0, {"level2": Signal("step", (0.1,))})
    found = loop.open()
    found.advance(580)  # at rest: the integral holds the level
    found.take_over(controller.with_gains({"G_p": [12.0]}))
    found.advance()
    drives = loop.answer(found).drives["pump"]
    assert drives[580:] == pytest.approx(drives[579], abs=0.05)
    assert drives[579] > 5.0
