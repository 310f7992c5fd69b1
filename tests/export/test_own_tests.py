"""Every shipped and every example file, exported: its own test passes in each language."""

from __future__ import annotations

import subprocess
from pathlib import Path

import c_programs
import pytest
from budget import part
from own_tests import LANGUAGES, failing, failing_in_rust, tried_once  # noqa: F401

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.base.folders import MODULES
from fuzzyarm.exchange.export import languages
from fuzzyarm.symbolic.formulas import FRB
from fuzzyarm.symbolic.operations import OPERATIONS

ROOT = Path(__file__).parents[2]
FILES = sorted(
    [*shipped("pd7.frb").parent.glob("*.frb"), *(ROOT / "examples").rglob("*.frb")],
)
WRONG = {"carl.frb", "hidden.frb"}
"""Of the course example: a submission with a mistake, and lines for the grader alone."""


pytestmark = pytest.mark.usefixtures("tried_once")


def every_function(folder: Path) -> Path:
    """Write a rule base that has each function of formulas in an output of its own."""
    lines = ["rulebase functions", "input x 0.1 .. 0.9", "input y 0.2 .. 1.7",
             "term x ON: rectangle 0.1 0.9"]  # fmt: skip
    for word, operation in sorted(FRB.functions.items()):
        arguments = ", ".join("xy"[: OPERATIONS[operation].arity])
        lines += [f"output of_{word} -100 .. 100",
                  f'term of_{word} F: formula "{word}({arguments})"',
                  f"inference of_{word}: defuzzifier weighted-average",
                  f"rule if x is ON then of_{word} is F"]  # fmt: skip
    path = folder / "functions.frb"
    path.write_text("\n".join(lines))
    return path


def exported(folder: Path, suffix: str, capsys) -> tuple[list[Path], dict[str, str]]:
    """Return the files that were written, and what the command says of the others."""
    written, refused = [], {}
    for number, path in enumerate([*FILES, every_function(folder)]):
        out = folder / f"made_{number}_{path.stem.replace('-', '_').replace('+', '_')}{suffix}"
        words = ["compile", str(path), "-o", str(out), "--precision", "float64"]
        if main(words) == 0:
            written.append(out)
        elif path.name not in WRONG:
            refused[path.name] = capsys.readouterr().err
    return written, refused


def without_partners(refused: dict[str, str]) -> list[str]:
    """Return the files that are refused for another reason than a law that is not text."""
    return [name for name, why in refused.items() if "which is not text" not in why]


def test_every_language_of_modules_is_run():
    assert {*MODULES} == {*languages.MODULES} <= {*LANGUAGES, ".js"}  # a .js is an .mjs


REFUSED = {".scl": ["functions.frb"]}
"""SCL has no atan2."""


@pytest.mark.slow(seconds=30)  # what is tried for one language is known to the others
def test_the_tests_of_all_files_pass(tmp_path, capsys):
    for suffix in LANGUAGES:
        written, others = exported(tmp_path, suffix, capsys)
        assert without_partners(others) == REFUSED.get(suffix, []), suffix
        assert len(written) > 50
        assert failing(written, tmp_path) == [], suffix


@pytest.mark.parametrize("option", ["-ffast-math", "-ffinite-math-only"])
@pytest.mark.parametrize("source", ["examples/controllers/pd-heater.frb", "rulebases/pd7.frb"])
def test_c_is_refused_by_a_compiler_for_which_nothing_is_nan(tmp_path, capfd, source, option):
    c_programs.need(c_programs.HOST)
    assert main(["compile", str(ROOT / source), "-o", str(tmp_path / "it.c")]) == 0
    command = [c_programs.HOST, "-std=c99", "-c", "it.c", "-o", "it.o"]
    assert subprocess.run(command, cwd=tmp_path, check=False).returncode == 0
    assert subprocess.run([*command, option], cwd=tmp_path, check=False).returncode != 0
    assert "this code compares with NaN" in capfd.readouterr().err


DEFAULTS = (*LANGUAGES, ".c", ".st", ".xml")


@pytest.mark.slow(seconds=15)
def test_every_file_has_every_target_without_an_option(tmp_path, capsys, monkeypatch):
    # What is tried is run by nothing here: a short sequence will do.
    monkeypatch.setattr("fuzzyarm.exchange.export.controllers.PERIODS", 20)
    refused = {}
    for number, path in enumerate(FILES):
        at = number % len(DEFAULTS)
        for suffix in part([*DEFAULTS[at:], *DEFAULTS[:at]], len(DEFAULTS)):
            status = main(["compile", str(path), "-o", str(tmp_path / f"made_{number}{suffix}")])
            said = capsys.readouterr().err
            if status and path.name not in WRONG and "which is not text" not in said:
                refused[path.name, suffix] = said
    assert refused == {}


@pytest.mark.slow
def test_rust_needs_core_alone(tmp_path):
    paths = []
    for name in ("pd7", "servo", "fan", "soc-zero"):
        paths.append(tmp_path / f"{name.replace('-', '_')}.rs")
        assert main(["compile", str(shipped(f"{name}.frb")), "-o", str(paths[-1])]) == 0
    assert failing_in_rust(paths, tmp_path, core_alone=True) == []


@pytest.mark.parametrize("name", ["a b.h", "it's.c"])
def test_the_command_in_the_head_runs_whatever_the_name(tmp_path, name):
    c_programs.need(c_programs.HOST)
    assert main(["compile", str(shipped("pd7.frb")), "-o", str(tmp_path / name)]) == 0
    text = " ".join((tmp_path / name).read_text("utf-8").split("*/")[0].split())
    command = text.partition("returns 0 if all is well): ")[2].partition("./self_test")[0]
    command = command.replace(" * ", " ").replace("gcc", c_programs.HOST)
    subprocess.run(f"{command}./self_test", shell=True, cwd=tmp_path, check=True)
