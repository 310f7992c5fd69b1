"""Structured Text: it means what the C means, and other people's parser reads it."""

from __future__ import annotations

import importlib.util
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import table_definition as definition

from fuzzyarm.export import ExportError, export_files, routines_of
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

WIDTHS = {"INT": 16, "SINT": 8, "DINT": 32}
REALS = {"REAL": np.float32, "LREAL": np.float64}


DECLARATION = r"(\w+) : ((?:ARRAY \[0\.\.\d+\] OF )?\w+)(?: := \[(.*?)\])?;"
SECTION = r"VAR(_INPUT|_OUTPUT| CONSTANT|)\n(.*?)END_VAR"


class Whole(int):
    """An integer of Structured Text: its division drops the remainder towards zero."""

    def _of(self, value):
        assert -(2**31) <= value < 2**31, "DINT overflows"
        return Whole(value)

    def __add__(self, other):
        return self._of(int(self) + int(other))

    def __sub__(self, other):
        return self._of(int(self) - int(other))

    def __rsub__(self, other):
        return self._of(int(other) - int(self))

    def __mul__(self, other):
        return self._of(int(self) * int(other))

    def __truediv__(self, other):
        quotient = abs(int(self)) // abs(int(other))
        return self._of(quotient if (self >= 0) == (other >= 0) else -quotient)


def stored(kind, value):
    """Return a value as a variable of this type holds it."""
    if kind in REALS:
        return REALS[kind](value)
    width = WIDTHS[kind]
    assert -(2 ** (width - 1)) <= value < 2 ** (width - 1), f"{kind} overflows"
    return Whole(value)


class FunctionBlock:
    """A small interpreter: declarations, assignments, IF and WHILE, as the standard has them."""

    def __init__(self, text):
        code = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
        self.name = re.search(r"FUNCTION_BLOCK (\w+)", code)[1]
        self.kinds, self.values, self.inputs, self.outputs = {}, {}, [], []
        for section, body in re.findall(SECTION, code, re.DOTALL):
            for name, kind, numbers in re.findall(DECLARATION, body, re.DOTALL):
                element = kind.split()[-1]
                assert name.lower() not in self.kinds, "the language ignores case"
                self.kinds[name.lower()] = element
                if numbers:
                    size = int(re.search(r"\.\.(\d+)", kind)[1]) + 1
                    cells = [
                        stored(element, float(x) if "." in x else int(x))
                        for x in numbers.split(",")
                    ]
                    assert len(cells) == size
                    self.values[name.lower()] = cells
                elif section == "_INPUT":
                    self.inputs.append(name.lower())
                elif section == "_OUTPUT":
                    self.outputs.append(name.lower())
        statements = code.rpartition("END_VAR")[2].partition("END_FUNCTION_BLOCK")[0]
        self.program = compile(self.translate(statements), self.name, "exec")

    def translate(self, statements):
        lines, depth = [], 0
        for line in statements.split("\n"):
            words = line.strip()
            if not words:
                continue
            if words in {"END_IF;", "END_WHILE;"}:
                depth -= 1
                continue
            if words == "ELSE":
                lines.append("    " * (depth - 1) + "else:")
            elif match := re.fullmatch(r"(IF|WHILE) (.*) (THEN|DO)", words):
                lines.append("    " * depth + f"{match[1].lower()} {self.python(match[2])}:")
                depth += 1
            else:
                match = re.fullmatch(r"(\w+) := (.*);", words)
                name = match[1].lower()
                value = f"stored('{self.kinds[name]}', {self.python(match[2])})"
                lines.append("    " * depth + f"v['{name}'] = {value}")
        return "\n".join(lines)

    def python(self, expression):
        def word(match):
            token = match[0]
            if re.fullmatch(r"[A-Z]+_TO_[A-Z]+", token):
                return f"as_{token.rpartition('_')[2]}"
            if token[0].isdigit():
                return token
            assert token.lower() in self.kinds, token
            return f"v['{token.lower()}']"

        return re.sub(r"\d[\d.]*(?:E[+-]?\d+)?|\w+", word, expression)

    def call(self, *inputs):
        values = dict(self.values)
        for name, value in zip(self.inputs, inputs, strict=True):
            values[name] = stored(self.kinds[name], value)
        casts = {f"as_{k}": (lambda x, k=k: stored(k, x)) for k in [*WIDTHS, *REALS]}
        exec(self.program, {"v": values, "stored": stored, **casts})
        return values[self.outputs[0]]


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
    if importlib.util.find_spec("blark") is None:
        pytest.skip("blark, a parser of IEC 61131-3, is not installed")
    import blark

    axes = (Axis("e", (-1.0, 0.0, 2.5)), Axis("if", (0.0, 1e-9), bins=(5e-10,)))
    table = LookupTable(axes, "real", [[1.0, 2.0], [3.0, -4.0], [5.5, 6.0]])
    (file,) = export_files(routines_of(table, **options), tmp_path / "plc.st").files
    parsed = blark.parse_source_code(file[1])
    assert parsed.exception is None
    (block,) = parsed.transform().items
    assert (type(block).__name__, str(block.name)) == ("FunctionBlock", "plc_real")
    if options is OPTIONS[0]:  # the parser does refuse what is wrong; it takes its time
        wrong = blark.parse_source_code(file[1].replace("END_WHILE;", "END_FOR;", 1))
        assert wrong.exception is not None


def test_direct_inference_is_not_written(pd7, tmp_path):
    with pytest.raises(ExportError, match="for tables, not for direct inference"):
        export_files(routines_of(pd7), tmp_path / "plc.st")
