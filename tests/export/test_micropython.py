"""Modules for MicroPython: the bits of the model where floats have 64 bits."""

from __future__ import annotations

import ast
import runpy
import struct
from pathlib import Path

import numpy as np
import pytest
from controller_programs import (
    EVERYTHING,
    model_drives,
    ports,
    recorded,
    scattered,
    shipped_text,
    text_of,
)
from micropython_programs import run_micropython

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.exchange.export import ControllerProgram, export_controller, export_files, routines_of
from fuzzyarm.language import load_rulebase, parse
from fuzzyarm.table import read_table

PD7, TIPPER = (str(shipped(f"{name}.frb")) for name in ("pd7", "tipper"))
TABLE = str(shipped("thesis-6.1.lut"))

CURVED = """rulebase curved
input x -4 .. 4
output y -1 .. 1
output z -1 .. 1
term x A: sigmoid 0.3 900
term x B: bell 0.7 1.3 0.1
term x C: gaussian -1.1 0.9
term x D: s -1.3 0.7
term y P: triangle -1 -0.3 0.1
term y Q: triangle 0 0.7 1
term z P: singleton -0.7
term z Q: singleton 0.3
inference y: defuzzifier centroid(57), aggregation sum, no-rule 0.25
inference implication product
inference z: defuzzifier weighted-average, no-rule -0.1
rule if x is A and x is not B then y is P and z is Q with 0.9
rule if x is very C or x is somewhat D then y is Q and z is P
"""


def of_text(text):
    parsed = parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    return parsed.rulebase


CASES = {
    "pd7": lambda: routines_of(load_rulebase(PD7), precision="float64"),
    "tipper": lambda: routines_of(load_rulebase(TIPPER), precision="float64"),
    "curved": lambda: routines_of(of_text(CURVED), precision="float64"),
    "bins": lambda: routines_of(read_table(TABLE), mode="bins", precision="float64"),
    "linear": lambda: routines_of(read_table(TABLE), mode="linear", precision="float64"),
    "q15": lambda: routines_of(read_table(TABLE), mode="linear", q=15),
    "q7": lambda: routines_of(read_table(TABLE), mode="linear", q=7),
    "nearest": lambda: routines_of(read_table(TABLE), mode="nearest", q=15),
}


def points_of(routine, count=150):
    draw = np.random.default_rng(5)
    columns = [np.asarray(column, routine.kind) for column in routine.vectors().inputs]
    if np.issubdtype(routine.kind, np.integer):
        info = np.iinfo(routine.kind)
        more = [draw.integers(info.min, info.max, count, endpoint=True) for _ in columns]
    else:
        more = [draw.uniform(a.low - 1, a.high + 1, count) for a in routine.arguments]
    return [np.concatenate(pair).astype(routine.kind) for pair in zip(columns, more, strict=True)]


def asked(routines):
    """Return a script that prints the bits of every result, and what they are in the model."""
    lines, expected = ["import made, struct"], []
    for routine in routines:
        columns = points_of(routine)
        rows = list(zip(*(column.tolist() for column in columns), strict=True))
        results = routine.evaluate(*columns)
        # Bits, not decimals: a reader of decimals may round.
        data = b"".join(struct.pack("<d", float(x)) for row in rows for x in row)
        whole = np.issubdtype(routine.kind, np.integer)
        lines += [
            f"data = {data!r}",
            f"for k in range({len(rows)}):",
            f"    row = struct.unpack_from('<{len(columns)}d', data, k * {8 * len(columns)})",
            f"    row = [int(x) for x in row] if {whole} else row",
            f"    value = made.{routine.output.name}(*row)",
            "    print(''.join('%02x' % b for b in struct.pack('<d', value)))",
        ]
        expected += [struct.pack("<d", float(x)).hex() for x in results]
    return "\n".join([*lines, "print('test', made.self_test())", ""]), expected


@pytest.mark.parametrize("name", CASES)
def test_the_module_gives_the_bits_of_the_model(tmp_path, name):
    routines = CASES[name]()
    (file,) = export_files(routines, tmp_path / "made.py").files
    file[0].write_text(file[1], "utf-8")
    script, expected = asked(routines)
    # Here first: what no port is needed for.
    names = runpy.run_path(str(file[0]))
    assert names["self_test"]() == 0
    imported = {
        (node.module if isinstance(node, ast.ImportFrom) else node.names[0].name)
        for node in ast.walk(ast.parse(file[1]))
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    assert imported <= {"math", "array"}
    for routine in routines:
        columns = points_of(routine)
        rows = zip(*(column.tolist() for column in columns), strict=True)
        here = [struct.pack("<d", names[routine.output.name](*row)).hex() for row in rows]
        assert here == [struct.pack("<d", float(x)).hex() for x in routine.evaluate(*columns)]
    *found, last = run_micropython(file[0], script, tmp_path).split("\n")[:-1]
    assert last == "test 0"
    if name == "curved":  # its port has another library of mathematics
        ours, theirs = (np.array([struct.unpack("<d", bytes.fromhex(x))[0] for x in each])
                        for each in (expected, found))  # fmt: skip
        np.testing.assert_allclose(theirs, ours, rtol=1e-13, atol=1e-14)
    else:
        assert found == expected


def test_the_self_test_can_fail(tmp_path):
    (file,) = export_files(routines_of(load_rulebase(PD7), precision="float64"), "made.py").files
    path = tmp_path / "made.py"
    path.write_text(file[1].replace("    return ", "    return 1.0 + ", 3), "utf-8")
    assert runpy.run_path(str(path))["self_test"]() == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([str(shipped("servo.frb")), "--precision", "mixed"], "computes in the floats of its port"),
        ([PD7, "--precision", "float32"], "computes in the floats of its port"),
    ],
)
def test_what_micropython_does_not_get_is_said(tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", *words, "-o", "made.py"]) == 1
    assert message in capsys.readouterr().err
    assert not Path("made.py").exists()


def test_what_matlab_writes_becomes_a_module(tmp_path, monkeypatch):
    """Its 101 samples are an array with the name of the term, which a variable has, too."""
    monkeypatch.chdir(tmp_path)
    assert main(["convert", TIPPER, "tip.fis"]) == 0
    assert main(["compile", "tip.fis", "-o", "made.py"]) == 0
    assert runpy.run_path("made.py")["self_test"]() == 0


# --- Controllers ---

DRIVEN = """import made, struct
controller = made.Controller()
data = open(DATA, "rb").read()
width = WIDTH
for k in range(len(data) // (8 * width)):
    row = struct.unpack_from("<%dd" % width, data, k * 8 * width)
    drives = controller.step(*row)
    drives = drives if isinstance(drives, tuple) else (drives,)
    print("".join("%02x" % b for b in struct.pack("<%dd" % len(drives), *drives)))
print("test", made.self_test())
"""


def module_of(text, path):
    program = ControllerProgram(text, "float64")
    export_controller(program, path).write()
    return program.steps


def drives_here(path, rows):
    controller = runpy.run_path(str(path))["Controller"]()
    driven = [controller.step(*row) for row in rows.tolist()]
    return np.array([d if isinstance(d, tuple) else (d,) for d in driven])


@pytest.mark.parametrize("name", ["servo", "soc-zero", "heater"])
def test_a_controller_drives_the_bits_of_the_model(tmp_path, name):
    text = shipped_text(name)
    steps = module_of(text, tmp_path / "made.py")
    if name == "heater":
        rows = scattered(steps, 2_000)
        expected = model_drives(text, steps, rows)
    else:
        rows, expected = recorded(text, steps, 2_000)
    assert len(rows) == 2_000
    assert np.ptp(expected) > 0.0
    assert drives_here(tmp_path / "made.py", rows).tobytes() == expected.tobytes()
    data = np.ascontiguousarray(rows, "<f8").tobytes()
    script = DRIVEN.replace('open(DATA, "rb").read()', repr(data))
    script = script.replace("WIDTH", str(len(ports(steps))))
    *found, last = run_micropython(tmp_path / "made.py", script, tmp_path).split("\n")[:-1]
    assert last == "test 0"
    assert found == [row.astype("<f8").tobytes().hex() for row in expected]


@pytest.mark.slow
def test_every_source_and_limit_has_the_bits_of_the_model(tmp_path):
    text = text_of(EVERYTHING)
    steps = module_of(text, tmp_path / "made.py")
    rows = scattered(steps, 400)
    expected = model_drives(text, steps, rows)
    assert drives_here(tmp_path / "made.py", rows).tobytes() == expected.tobytes()
    assert runpy.run_path(str(tmp_path / "made.py"))["self_test"]() == 0


def test_tables_in_whole_numbers_stand_in_a_controller(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = [str(shipped("heater.frb")), "--table", "--q", "15"]
    assert main(["compile", *words, "-o", "made.py"]) == 0
    made = runpy.run_path("made.py")
    assert made["self_test"]() == 0
    controller = made["Controller"]()
    assert isinstance(controller.step(21.0, 15.0), float)
