"""Structured Text: it means what the C means, and other people's parser reads it."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import table_definition as definition
from budget import part
from needs import need
from st_programs import Program

from fuzzyarm import load, load_controller
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.exchange.compiled import Making, program_of, source_of
from fuzzyarm.exchange.export import (
    ControllerProgram,
    ExportError,
    export_controller,
    export_files,
    routines_of,
)
from fuzzyarm.language import load_rulebase, parse
from fuzzyarm.symbolic.identifiers import identifier
from fuzzyarm.table import Axis, LookupTable, read_table

PRINTED = read_table(Path(__file__).parents[2] / "rulebases" / "thesis-6.1.lut")
UNEVEN = LookupTable(
    (
        Axis("LOAD", (-1.5, 0.1, 0.7), bins=(-0.3, 0.3)),
        Axis("load", (0.0, 0.3, 1.0, 7.7)),
        Axis("alone", (4.0,)),
        Axis("if", (-2.2, -0.1, 0.2, 9.9), bins=(-1.1, 0.0, 1.7)),
    ),
    "real",
    np.random.default_rng(7).uniform(-3e-9, 5.0, (3, 4, 1, 4)),
    description="(* a *) comment",
)
OPTIONS = [
    {"mode": "bins", "precision": "float32"},
    {"mode": "linear", "precision": "float32"},
    {"mode": "linear", "precision": "mixed"},
    {"mode": "nearest", "precision": "float64"},
    {"mode": "bins", "q": 7},
    {"mode": "linear", "q": 15},
]


class FunctionBlock:
    """One block of a file; it is given its inputs in order and returns its first output."""

    def __init__(self, text, name="", real="LREAL"):
        program = Program(text)
        blocks = [unit.name for unit in program.units.values() if unit.sort != "FUNCTION"]
        self.instance = program.instance(name or blocks[0])
        self.inputs = self.instance.unit.inputs

    def call(self, *inputs):
        self.instance.run(**dict(zip(self.inputs, inputs, strict=True)))
        return next(iter(self.instance.outputs().values()))


def sample_points(routine, count=150):
    random = np.random.default_rng(2)
    vectors = routine.vectors().inputs
    points = []
    for column in vectors:
        low, high = float(column.min()), float(column.max())
        more = random.uniform(low, high, count)
        between = np.round(more) if column.dtype.kind == "i" else more
        points.append(np.concatenate([column, between.astype(column.dtype)]))
    return points


@pytest.mark.parametrize("options", OPTIONS, ids=str)
@pytest.mark.parametrize("table", [PRINTED, UNEVEN], ids=["printed", "uneven"])
def test_the_block_computes_what_the_model_computes(table, options, tmp_path):
    (routine,) = routines_of(table, **options)
    (file,) = export_files([routine], tmp_path / "plc.st").files
    block = FunctionBlock(file[1])
    points = sample_points(routine)
    with np.errstate(all="ignore"):
        found = [block.call(*point) for point in zip(*(p.tolist() for p in points), strict=True)]
    expected = routine.evaluate(*points)
    if getattr(routine.core, "linear", False) and options.get("precision") == "float32":
        # Products of REAL with literals are rounded once less here than in a PLC.
        np.testing.assert_allclose(found, expected, rtol=0, atol=4e-6)
    else:
        np.testing.assert_array_equal(np.array(found, expected.dtype), expected)


def block_of(table, folder, **options):
    (routine,) = routines_of(table, **options)
    (file,) = export_files([routine], folder / "plc.st").files
    return routine, FunctionBlock(file[1])


def test_exact_ties_of_fixed_point_are_rounded_away_from_zero(tmp_path):
    # At e = 0 the share is one half: 16384 of 32768. Values are steps of the output, and one
    # half of an odd difference is a tie.
    for near, far, expected in ((3, 8, 6), (8, 3, 5), (-3, -8, -6), (-8, -3, -5), (0, 1, 1)):
        values = np.array([near, far]) / 32768
        table = LookupTable((Axis("e", (-1.0, 1.0)),), "u", values, low=-1.0, high=1.0)
        routine, block = block_of(table, tmp_path, mode="linear", q=15)
        half = Fraction(far - near, 2)
        assert near + definition.half_away(half) == expected
        assert block.call(0) == expected
        for e in (-32768, -32767, -1, 1, 12345, 32767):
            levels, cells = routine.core.points[0].tolist(), routine.core.values.tolist()
            assert block.call(e) == definition.in_fixed_point([levels], cells, [e])


@pytest.mark.parametrize("mode", ["bins", "nearest", "linear"])
def test_thresholds_midpoints_and_levels_are_those_of_the_definition(mode, tmp_path):
    axes = (Axis("e", (-2.0, -1.0, 1.0, 3.0), (-1.0, 0.0, 2.5)), Axis("ce", (0.0, 0.5, 1.0)))
    table = LookupTable(axes, "u", np.arange(12.0).reshape(4, 3) ** 2)
    _, block = block_of(table, tmp_path, mode=mode, precision="float64")
    for e in (-3, -2, -1.5, -1, -0.0, 0, 0.5, 1, 2, 2.5, 3, 4):
        for ce in (-1, 0, 0.25, 0.5, 0.75, 1, 2):
            wanted = (
                definition.interpolated(axes, table.values, (e, ce))
                if mode == "linear"
                else definition.picked(axes, table.values, (e, ce), mode)
            )
            assert block.call(e, ce) == float(wanted)


@pytest.mark.slow
@pytest.mark.parametrize("options", [OPTIONS[0], OPTIONS[5]], ids=str)
def test_a_parser_of_other_people_reads_it(options, tmp_path):
    need("blark")
    import blark

    axes = (Axis("e", (-1.0, 0.0, 2.5)), Axis("if", (0.0, 1e-9), bins=(5e-10,)))
    table = LookupTable(axes, "real", [[1.0, 2.0], [3.0, -4.0], [5.5, 6.0]])
    (file,) = export_files(routines_of(table, **options), tmp_path / "plc.st").files
    parsed = blark.parse_source_code(file[1])
    assert parsed.exception is None
    *helpers, block = parsed.transform().items
    assert {type(item).__name__ for item in helpers} <= {"Function"}
    assert (type(block).__name__, str(block.name)) == ("FunctionBlock", "plc_real")
    if options is OPTIONS[0]:  # the parser does refuse what is wrong; it takes its time
        wrong = blark.parse_source_code(file[1].replace("END_WHILE;", "END_FOR;", 1))
        assert wrong.exception is not None


@pytest.mark.parametrize("precision", ["float64", "mixed", "float32"])
@pytest.mark.parametrize("name", ["pd7-study", "fine7", "alpha7", "fan"])
def test_direct_inference_is_what_the_model_computes(tmp_path, name, precision):
    (routine,) = routines_of(load_rulebase(shipped(f"{name}.frb")), precision=precision)
    (file,) = export_files([routine], tmp_path / "plc.st").files
    real = "REAL" if precision == "float32" else "LREAL"
    output = identifier(routine.output.name)
    block = FunctionBlock(file[1], f"plc_{output}", real)
    points = [column[:40] for column in sample_points(routine, 20)]
    found = [block.call(*point) for point in zip(*(p.tolist() for p in points), strict=True)]
    expected = routine.evaluate(*points)
    np.testing.assert_array_equal(np.array(found, expected.dtype), expected)


SILENT = """rulebase silent
input  a 0 .. 4
output u 0 .. 10
term a L: triangle 0 1 2
term u D: triangle 2 3 4
inference no-rule error
rule if a is L then u is D
"""


def test_where_no_rule_fires_the_block_keeps_its_value_and_says_so(tmp_path):
    model = parse(SILENT).rulebase
    (file,) = export_files(routines_of(model), tmp_path / "plc.st").files
    block = Program(file[1]).instance("plc_u")
    for a, fired in ((1.0, True), (3.5, False), (0.5, True), (2.0, False)):
        before = block.values["u"]
        block.run(a=a)
        assert block.outputs()["fired"] is fired
        assert block.values["u"] == (pytest.approx(3.0) if fired else before)


def test_what_the_language_lacks_is_named(tmp_path):
    curved = SILENT.replace("term u D: triangle 2 3 4", 'term u D: formula "tanh(a)"')
    curved = curved.replace("no-rule error", "defuzzifier weighted-average, no-rule error")
    model = parse(curved).rulebase
    assert model is not None
    with pytest.raises(ExportError, match="no function for 'tanh'"):
        export_files(routines_of(model), tmp_path / "plc.st")


ROOT = Path(__file__).parents[2]
FILES = sorted([*(ROOT / "rulebases").glob("*.frb"), *ROOT.glob("examples/controllers/*.frb")])
"""Shipped files and examples."""


@pytest.mark.slow(seconds=20)
@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_a_strict_compiler_takes_every_file_that_is_shipped(tmp_path, precision):
    taken, refused = 0, []
    for path in part(FILES, 3):
        out = tmp_path / f"{identifier(path.stem)}.st"
        try:
            sheet = load(path)
            how = Making(source=str(path), precision=precision)
            if isinstance(sheet, ControllerText):
                exported, _ = program_of(sheet, out, how)
            else:
                exported, _ = source_of(sheet, out, how)
        except ExportError as error:
            refused.append(error.message)
            continue
        Program(exported.files[0][1])
        taken += 1
    reasons = ("is not text and cannot be exported", "has no infinite number", "double precision")
    assert all(any(reason in message for reason in reasons) for message in refused), refused
    assert taken > len(refused)


def test_what_a_compiler_refuses_the_interpreter_refuses():
    head = "FUNCTION_BLOCK b\nVAR_INPUT\n    x : LREAL;\n    n : INT;\nEND_VAR\nVAR_OUTPUT\n"
    for outputs, statement in {
        "    d : DINT;": "d := n;",
        "    y : LREAL;": "y := x * 2.0;",
        "    y : REAL;": "y := x;",
        "    eno : BOOL;": "eno := TRUE;",
        "    end_if : LREAL;": "end_if := x;",
        "    ok : BOOL;": "ok := x > 1;",
    }.items():
        text = f"{head}{outputs}\nEND_VAR\n\n{statement}\nEND_FUNCTION_BLOCK\n"
        with pytest.raises(AssertionError):
            Program(text)
    Program(f"{head}    y : LREAL;\nEND_VAR\n\ny := x * LREAL#2.0;\nEND_FUNCTION_BLOCK\n")
    array = (
        "FUNCTION f : BOOL\nVAR_IN_OUT\n    a : {};\nEND_VAR\n\nf := a[0] > 1.0;\nEND_FUNCTION\n"
    )
    with pytest.raises(AssertionError, match="has no name"):
        Program(array.format("ARRAY [0..1] OF REAL"))
    Program(f"TYPE\n    two : ARRAY [0..1] OF REAL;\nEND_TYPE\n{array.format('two')}")


def test_the_block_of_a_controller_tells_a_period_that_it_skips(tmp_path):
    (tmp_path / "two.frb").write_text(
        "controller two\nperiod 10 ms\naxis a, b\n  error = error of position\n"
        "  drive voltage = error * 2\n"
    )
    program = ControllerProgram(load_controller(tmp_path / "two.frb"), "float64")
    (file,) = export_controller(program, tmp_path / "two.st").files
    block = Program(file[1]).instance("two")
    nan = float("nan")
    for a, b, drives, error in (
        (0.25, 0.5, (0.5, 1.0), False), (nan, 1.0, (0.5, 2.0), True),
        (1.0, nan, (2.0, 2.0), True), (0.0, 0.0, (0.0, 0.0), False),
    ):  # fmt: skip
        zeros = {"measured_a_position": 0.0, "measured_b_position": 0.0}
        block.run(reference_a_position=a, reference_b_position=b, **zeros)
        found = block.outputs()
        assert (found["a_voltage"], found["b_voltage"]) == drives
        assert found["error"] is error
