"""Every source, one of a test's own too: the same bits in C and in Structured Text."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from controller_programs import model_drives, ports, run_in_c, scattered, text_of
from st_programs import Program

sys.path.append(str(Path(__file__).parents[1] / "controller"))

from own_source import WORD, controller, register, whole

from fuzzyarm.apps.cli import main
from fuzzyarm.exchange.export import ControllerProgram, export_controller
from fuzzyarm.exchange.export.walk_of_steps import steps_of
from fuzzyarm.symbolic.identifiers import identifier
from fuzzyarm.symbolic.sources import SOURCES

BUILT_IN = [word for word, kind in SOURCES.items() if kind.of != "call"]
WORDS = [*BUILT_IN, WORD]


@pytest.fixture(scope="module", autouse=True)
def _own():
    register()
    yield
    SOURCES.remove(WORD)


def test_every_source_drives_the_same_bits_in_c(tmp_path):
    programs, expected = {}, {}
    for word in WORDS:
        text = text_of(whole(word))
        for precision in ("float64", "mixed"):
            steps = steps_of(text, precision)
            key = f"{identifier(word)}_{precision}"
            rows = scattered(steps, 400)
            single = precision == "mixed"
            rows = rows.astype(np.float32).astype(float) if single else rows
            drives = model_drives(text, steps, rows, single=single)
            programs[key] = (steps, rows)
            expected[key] = drives.astype(np.float32).astype(float) if single else drives
    for key, drives in run_in_c(programs, tmp_path).items():
        np.testing.assert_array_equal(drives, expected[key], key)
        assert np.abs(drives).max() > 0.0


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_every_source_drives_the_same_bits_in_structured_text(tmp_path, word, precision):
    program = ControllerProgram(text_of(whole(word)), precision)
    exported = export_controller(program, tmp_path / "plc.st")
    ((_, content),) = exported.files
    block = Program(content)
    block = block.instance(exported.calls[0])
    steps, vectors = program.steps, program.tried.vectors
    names = [f"{port.sort}_{port.name}" for port in ports(steps)]
    for row, drives in zip(vectors.inputs, vectors.expected, strict=True):
        block.run(**dict(zip(names, row, strict=True)))
        found = {name: float(value) for name, value in block.outputs().items()}
        assert [value for name, value in found.items() if name != "error"] == list(drives)


@pytest.mark.parametrize("word", ["deadband", "hysteresis", WORD])
def test_the_command_exports_it(tmp_path, word, capsys):
    path = tmp_path / "c.frb"
    option = "width" if word != WORD else "share"
    line = f"y = {word} of e, {option} w"
    path.write_text(controller(line, "drive voltage = y, within -9 .. 9", head=["gain w = 0.4"]))
    for suffix in ("c", "h", "st", "fmu"):
        assert main(["compile", str(path), "-o", str(tmp_path / f"made.{suffix}")]) == 0
    assert "worst difference" in capsys.readouterr().out
    assert "s->gains.w" in (tmp_path / "made.c").read_text()
