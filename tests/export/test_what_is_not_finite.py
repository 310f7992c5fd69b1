"""Values that are not finite, and rule bases without one: the bits of Python in each language."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from controller_programs import EVERYTHING, model_drives, ports, run_in_c, shipped_text, text_of
from own_tests import failing
from scl_reader import Reader
from st_programs import Program

from fuzzyarm.base.folders import MODULES
from fuzzyarm.exchange.export import ControllerProgram, export_controller
from fuzzyarm.exchange.export.c_files import TestSequence as Sequence
from fuzzyarm.exchange.export.walk_of_steps import steps_of

GAP = """
rulebase gap
input h -10 .. 10
output u -1 .. 1
term h low: trapezoid -10 -10 -2 -1
term h high: trapezoid 1 2 10 10
term u fill: singleton 1
term u drain: singleton -1
inference defuzzifier weighted-average
rule if h is low then u is fill
rule if h is high then u is drain

controller level
period 1 s
axis tank
  h = error of level
  v = rate of h, filter 2 s
  l = lag of h, time 3 s
  b = delayed of h, time 3 s
  u = rules gap(h)
  i = integral of u, start 3
  k = integral of l, within -5 .. 5
  w = integral of b, anti-windup back 4 s
  drive valve = i + k + u - b * 0.1 + w, within -20 .. 20, slew 3
  drive valve = v, within -20 .. 20
  drive pump = l + b, within -30 .. 30, on nan 2
"""

RELAYS = """
controller relays
period 1 s
axis tank
  h = error of level
  z = deadband of h, width 0.5
  p = hysteresis of h, width 0.5
  y = relay of h, width 1, levels -2 .. 3
  d = change of h
  s = sum of error of level
  drive valve = z + p, within -20 .. 20
  drive pump = y + d, within -20 .. 20
  drive heat = s, within -20 .. 20
"""

WITHOUT_LIMITS = f"""{GAP[: GAP.index("controller")]}controller plain
period 1 s
axis tank
  h = error of level
  v = rules gap(h) * 10
  u = v * 2
  drive valve = u
  drive pump = h, within -9 .. 9
"""

TEXTS = {
    "gap": GAP,
    "without-limits": WITHOUT_LIMITS,
    "relays": RELAYS,
    "everything": EVERYTHING,
    "soc-table": None,
    "cfaf": None,
}

ODD = (math.nan, math.inf, -math.inf, 1.7e308, -1.7e308)


def text_called(name):
    return shipped_text(name) if TEXTS[name] is None else text_of(TEXTS[name])


def rows_of(steps, count=400):
    """Return values of all ports; every sixth row has some that are odd, the largest ones late."""
    draw = np.random.default_rng(11)
    rows = draw.uniform(-4.0, 4.0, (count, len(ports(steps))))
    for k in np.flatnonzero(draw.uniform(size=count) < 0.17):
        chosen = draw.uniform(size=rows.shape[1]) < 0.6
        odd = ODD if k > 0.7 * count else ODD[:3]
        rows[k, chosen] = draw.choice(odd, int(chosen.sum()))
    return rows


def expected_of(name):
    text = text_called(name)
    steps = steps_of(text, "float64")
    rows = rows_of(steps)
    return text, steps, rows, model_drives(text, steps, rows)


def program_over(name):
    """Return a program whose self-test is over these rows, without a tolerance."""
    text, _, rows, drives = expected_of(name)
    program = ControllerProgram(text, "float64")
    vectors = Sequence(rows.tolist(), drives.tolist(), 0.0)
    vars(program)["tried"] = replace(program.tried, vectors=vectors, truths=drives.tolist())
    return program


@pytest.mark.parametrize("name", TEXTS)
def test_drives_are_finite_whatever_is_read(name):
    _, _, rows, drives = expected_of(name)
    assert np.isfinite(drives).all()
    assert np.isinf(rows).any()
    assert len({tuple(row) for row in drives.tolist()}) > 100


def test_c_drives_the_same_bits(tmp_path):
    programs, expected = {}, {}
    for name in TEXTS:
        _, steps, rows, drives = expected_of(name)
        programs[name.replace("-", "_")] = steps, rows
        expected[name.replace("-", "_")] = drives
    for name, found in run_in_c(programs, tmp_path, "-fno-sanitize=all").items():
        np.testing.assert_array_equal(found, expected[name], name)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", sorted({*MODULES} - {".js"}))
def test_modules_drive_the_same_bits(tmp_path, suffix):
    paths = []
    for name in TEXTS:
        path = tmp_path / f"m_{name.replace('-', '_')}{suffix}"
        ((file, content),) = export_controller(program_over(name), path).files
        assert file == path
        path.write_text(content)
        paths.append(path)
    assert failing(paths, tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".st", ".scl"])
@pytest.mark.parametrize("name", TEXTS)
def test_blocks_drive_the_same_bits(tmp_path, name, suffix):
    text, _, rows, drives = expected_of(name)
    exported = export_controller(ControllerProgram(text, "float64"), tmp_path / f"plc{suffix}")
    content = exported.files[0][1]
    block = Program(content if suffix == ".st" else Reader(content).text())
    block = block.instance(exported.calls[0].split("(")[0])
    names = list(block.unit.inputs)[: rows.shape[1]]
    with np.errstate(all="ignore"):
        for row, expected in zip(rows.tolist(), drives.tolist(), strict=True):
            block.run(**dict(zip(names, row, strict=True)))
            found = [float(value) for value in block.outputs().values()]
            assert found[: len(expected)] == expected
