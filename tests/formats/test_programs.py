"""Programs in the styles in which people write them, and what `convert --run` makes of each.

Every number is compared with that of the program's own library, at a hundred points.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import NamedTuple

import pytest

from fuzzyarm.live import ScriptError, System, read_script
from fuzzyarm.text.diagnostic import Diagnostic, Severity

PROGRAMS = Path(__file__).parent / "programs"


class Outcome(NamedTuple):
    """What of a program becomes a file, what is warned of, and what is called."""

    systems: tuple[str, ...]
    warnings: frozenset[str] = frozenset()
    call: str | None = None


def made(*systems: str, warnings: str = "", call: str | None = None) -> Outcome:
    return Outcome(systems, frozenset(warnings.split()), call)


OUTCOMES: dict[str, Outcome] = {}

REFUSED = {
    "03_raw_interp": "the script computes by itself, with interp_membership",
    "06_heater_argparse": "--call NAME calls what would build one: make_controller(), main()",
    "07_library_class": "--call NAME calls what would build one: BrakeController(top_speed)",
    "25_light_function": "--call NAME calls what would build one: brightness(",
    "28_fails_before": "the script ends with FileNotFoundError",
}


def run(stem: str, folder: Path, call: str | None = None) -> tuple[
    tuple[System, ...], tuple[Diagnostic, ...]
]:
    script = Path(shutil.copy(PROGRAMS / f"{stem}.py", folder))
    seconds = 8.0 if stem in ENDLESS else 120.0
    return read_script(script, seconds=seconds, call=call)


ENDLESS = {"10_greenhouse_serial", "24_car_pygame"}


def test_every_program_has_an_outcome() -> None:
    stems = {path.stem for path in PROGRAMS.glob("*.py")}
    assert len(stems) >= 25
    assert stems == set(OUTCOMES) | set(REFUSED)
