"""Programs in the styles in which people write them, and what `convert --run` makes of each.

Every number is compared with that of the program's own library, at a hundred points.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from fuzzyarm.base.diagnostic import Diagnostic, Severity
from fuzzyarm.exchange.live import ScriptError, System, read_script
from fuzzyarm.exchange.live.comparison import SLIGHT
from tests.formats.forked_python import forked_python

PROGRAMS = Path(__file__).parent / "programs"


class Outcome(NamedTuple):
    """What of a program becomes a file, what is warned of, what is called, what differs."""

    systems: tuple[str, ...]
    warnings: frozenset[str] = frozenset()
    call: str | None = None
    difference: float = 0.0  # greatest, in parts of the range; 0 where all numbers are the same


def outcome(
    *systems: str, warnings: str = "", call: str | None = None, difference: float = 0.0
) -> Outcome:
    return Outcome(systems, frozenset(warnings.split()), call, difference)


OUTCOMES = {
    "01_tip_control": outcome("tipping"),
    "02_fan_menu": outcome("system", warnings="answered-input failed-script"),
    "04_washer_tk": outcome("washing", warnings="stand-in"),
    "05_irrigation_flask": outcome("irrigation", warnings="stand-in"),
    "06_heater_argparse": outcome("make_controller", call="make_controller"),
    "07_library_class": outcome("BrakeController_sim", call="BrakeController(200)"),
    "08_class_in_main": outcome("controllers_force"),
    # Curves between the points of two inputs, which scikit-fuzzy joins by straight lines.
    "09_notebook": outcome("room", difference=0.0021),
    "10_greenhouse_serial": outcome("vent", warnings="endless-script stand-in"),
    "11_driver_cv2": outcome("alarm", warnings="stand-in"),
    "12_coffee_simpful": outcome("FS", warnings="answered-input"),
    "13_pump_simpful_sugeno": outcome("FS"),
    "14_cart_t1_mamdani": outcome("cart"),
    "15_plane_t1_tsk": outcome("plane"),
    "16_valve_it2fls": outcome("valve"),
    "17_robot_it2": outcome("robot"),
    "18_blinds_fuzzylogic": outcome("rules"),
    "19_coarse_universe": outcome("heart"),
    "20_students_table": outcome("grading", warnings="stand-in"),
    "21_drone_axes": outcome("axes_roll", "axes_pitch", "axes_yaw"),
    "22_surface_savefig": outcome("control_surface"),
    # Mean of maxima: points of the universe that are greatest, beside the exact plateau.
    "23_old_numpy": outcome("motor", difference=0.029),
    "24_car_pygame": outcome("car_pilot", warnings="endless-script stand-in"),
    "25_light_function": outcome("lighting", call="brightness(400, 10)"),
    "26_loan_streamlit": outcome("system", warnings="stand-in"),
    "27_fails_after": outcome("filling", warnings="failed-script"),
    "29_pip_views": outcome("shading", warnings="stand-in"),
}
"""Programs that systems come from, with what is called where they make none by themselves."""

REFUSED = {
    "03_raw_interp": "the script computes by itself, with interp_membership",
    "06_heater_argparse": "--call NAME calls what would build one: make_controller(), main()",
    "07_library_class": "--call NAME calls what would build one: BrakeController(top_speed)",
    "25_light_function": "--call NAME calls what would build one: brightness(",
    "28_fails_before": "the script ends with FileNotFoundError",
}
"""Programs that make nothing by themselves, and what is said of them."""

ENDLESS = {"10_greenhouse_serial", "24_car_pygame"}


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Yield the Python that runs scripts."""
    with forked_python(tmp_path_factory.mktemp("python")) as path:
        yield path


def run(
    stem: str, folder: Path, python: str, call: str | None = None
) -> tuple[tuple[System, ...], tuple[Diagnostic, ...]]:
    script = Path(shutil.copy(PROGRAMS / f"{stem}.py", folder))
    seconds = 1.0 if stem in ENDLESS else 120.0
    return read_script(script, seconds=seconds, python=python, call=call)


def test_every_program_has_an_outcome() -> None:
    stems = {path.stem for path in PROGRAMS.glob("*.py")}
    assert len(stems) >= 25
    assert stems == set(OUTCOMES) | set(REFUSED)
    assert {stem for stem, made in OUTCOMES.items() if made.call} == set(OUTCOMES) & set(REFUSED)


@pytest.mark.slow
@pytest.mark.parametrize("stem", OUTCOMES)
def test_what_a_program_makes(stem: str, tmp_path: Path, python: str) -> None:
    expected = OUTCOMES[stem]
    systems, diagnostics = run(stem, tmp_path, python, expected.call)
    assert tuple(system.name for system in systems) == expected.systems
    assert {d.name for d in diagnostics} == expected.warnings
    assert all(d.severity is Severity.WARNING for d in diagnostics)
    assert [path.name for path in tmp_path.iterdir()] == [f"{stem}.py"]  # no figures, no tables
    for system in systems:
        comparisons = [
            d for d in system.diagnostics if d.name in ("same-numbers", "numbers-differ")
        ]
        others = [d for d in system.diagnostics if d not in comparisons]
        assert all(d.severity is Severity.INFO for d in others), others
        assert comparisons
        assert greatest_difference(comparisons) == expected.difference
        assert (system.rulebase is None) == (expected.difference > SLIGHT)


def greatest_difference(comparisons: list[Diagnostic]) -> float:
    """Return the greatest of the differences that are said, in parts of the range."""
    sizes = [
        float(size)
        for each in comparisons
        for size in re.findall(r"differs by up to (\S+) of its range at 100 points", each.message)
    ]
    assert len(sizes) == sum(each.name == "numbers-differ" for each in comparisons)
    return max(sizes, default=0.0)


@pytest.mark.slow
@pytest.mark.parametrize("stem", REFUSED)
def test_what_is_said_of_a_program_that_makes_nothing(
    stem: str, tmp_path: Path, python: str
) -> None:
    with pytest.raises(ScriptError) as caught:
        run(stem, tmp_path, python)
    said = [str(caught.value), caught.value.hint, *(d.message for d in caught.value.diagnostics)]
    assert any(REFUSED[stem] in text for text in said), said
