"""Programs in the styles in which people write them, and what `convert` makes of each.

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
from fuzzyarm.exchange.formats.comparison import SLIGHT
from fuzzyarm.exchange.live import ScriptError, System, read_script
from tests.formats.forked_python import forked_python

PROGRAMS = Path(__file__).parent / "programs"


class Outcome(NamedTuple):
    """What of a program becomes a file, what is warned of, what differs."""

    systems: tuple[str, ...]
    warnings: frozenset[str] = frozenset()
    difference: float = 0.0  # greatest, in parts of the range; 0 where all numbers are the same


def outcome(*systems: str, warnings: str = "", difference: float = 0.0) -> Outcome:
    return Outcome(systems, frozenset(warnings.split()), difference)


OUTCOMES = {
    "01_tip_control": outcome("tipping"),
    "08_class_in_main": outcome("controllers_force"),
    "12_coffee_simpful": outcome("FS", warnings="failed-script"),  # no answer to its input()
    "13_pump_simpful_sugeno": outcome("FS"),
    "14_cart_t1_mamdani": outcome("cart"),
    "15_plane_t1_tsk": outcome("plane"),
    "16_valve_it2fls": outcome("valve"),
    "17_robot_it2": outcome("robot"),
    "18_blinds_fuzzylogic": outcome("rules"),
    "19_coarse_universe": outcome("heart"),
    "21_drone_axes": outcome("axes_roll", "axes_pitch", "axes_yaw"),
    # Its figure goes into a folder that is not there.
    "22_surface_savefig": outcome("control_surface", warnings="failed-script"),
    "27_fails_after": outcome("filling", warnings="failed-script"),
}
"""Programs that systems come from."""

REFUSED = {
    "02_fan_menu": "input() has no answer",
    "03_raw_interp": "interp_membership leave no object that holds rules",
    "05_irrigation_flask": "pip install flask",
    "06_heater_argparse": "the script gets no arguments",
    "07_library_class": "call the function that builds it",
    "11_driver_cv2": "pip install opencv-python",
    "28_fails_before": "the script ends with FileNotFoundError",
}
"""Programs that make nothing, and what is said of them."""


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Yield the Python that runs scripts."""
    with forked_python(tmp_path_factory.mktemp("python")) as path:
        yield path


def run(stem: str, folder: Path, python: str) -> tuple[tuple[System, ...], tuple[Diagnostic, ...]]:
    script = Path(shutil.copy(PROGRAMS / f"{stem}.py", folder))
    return read_script(script, seconds=120.0, python=python)


def test_every_program_has_an_outcome() -> None:
    stems = {path.stem for path in PROGRAMS.glob("*.py")}
    assert len(stems) >= 20
    assert stems == set(OUTCOMES) | set(REFUSED)


@pytest.mark.slow
@pytest.mark.parametrize("stem", OUTCOMES)
def test_what_a_program_makes(stem: str, tmp_path: Path, python: str) -> None:
    expected = OUTCOMES[stem]
    systems, diagnostics = run(stem, tmp_path, python)
    assert tuple(system.name for system in systems) == expected.systems
    assert {d.name for d in diagnostics} == expected.warnings
    assert all(d.severity is Severity.WARNING for d in diagnostics)
    assert [path.name for path in tmp_path.iterdir()] == [f"{stem}.py"]
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
    found = caught.value.diagnostics
    said = [str(caught.value), *(f"{d.message} {d.hint}" for d in found)]
    assert any(REFUSED[stem] in text for text in said), said
