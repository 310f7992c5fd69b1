"""Co-simulation units: valid by FMPy, and to the bits of the controller when FMPy runs them."""

from __future__ import annotations

import ctypes
import os
import platform
import re
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from controller_programs import EVERYTHING, model_drives, ports, scattered, shipped_text, text_of
from needs import need

from fuzzyarm import compile_table, infer, load
from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.exchange.export import ControllerProgram, ExportError, export_controller
from fuzzyarm.exchange.export.fmu import find_compiler
from fuzzyarm.inference.engine import cached_engine

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")


@pytest.fixture(autouse=True)
def _compiler():
    try:
        find_compiler()
    except ExportError as error:
        pytest.skip(str(error))


def made(text, folder, version):
    program = ControllerProgram(text, "float64")
    path = folder / f"made{version}.fmu"
    export_controller(program, path, fmi=version).write()
    return program.steps, str(path)


def input_names(steps):
    return [f"{port.sort}.{steps.port_name(port)}" for port in ports(steps)]


def simulated(steps, path, rows, **options):
    """Return the outputs at the end of each step."""
    period = steps.model.period
    names = input_names(steps)
    signals = np.array(
        [(k * period, *row) for k, row in enumerate(rows.tolist())],
        dtype=[("time", float), *((name, float) for name in names)],
    )
    outputs = [steps.port_name(port) for port in steps.of_sort("drive")]
    options = {"step_size": period, "output_interval": period, **options}
    result = fmpy.simulate_fmu(
        path, stop_time=len(rows) * period, input=signals, output=outputs, **options
    )
    return np.array([[row[name] for name in outputs] for row in result])[1 : len(rows) + 1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "version"), [("cfaf", 2), ("soc-table", 3), ("everything", 2), ("everything", 3)]
)
def test_a_unit_is_valid_and_drives_the_same_bits(tmp_path, name, version):
    from fmpy.validation import validate_fmu

    text = text_of(EVERYTHING.replace("'cooling air'", "air")) if name == "everything" else None
    text = text or shipped_text(name)
    steps, path = made(text, tmp_path, version)
    assert validate_fmu(path) == []
    rows = scattered(steps, 2_000)
    np.testing.assert_array_equal(simulated(steps, path, rows), model_drives(text, steps, rows))


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_gains_are_set_before_a_run_and_have_units(tmp_path, version):
    text = shipped_text("fuzzy-lut")
    steps, path = made(text, tmp_path, version)
    variables = {v.name: v for v in fmpy.read_model_description(path).modelVariables}
    assert variables["G_e"].unit == "1/rad"
    assert (variables["G_e"].causality, variables["G_e"].variability) == ("parameter", "tunable")
    assert float(variables["supply"].start) == 20.0
    assert variables["measured.joint1.position"].causality == "input"
    assert variables["joint1.voltage"].causality == "output"
    assert variables["signal.joint1.e"].causality == "local"
    rows = scattered(steps, 50)
    found = simulated(steps, path, rows, start_values={"supply": 10.0})
    run = text.run(gains={"supply": 10.0})
    for row, drives in zip(rows.tolist(), found, strict=True):
        sides = {"measured": {}, "reference": {}}
        for value, port in zip(row, ports(steps), strict=True):
            sides[port.sort][steps.port_name(port)] = value
        assert list(run.step(*sides.values()).values()) == drives.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_a_step_of_the_host_is_as_many_periods(tmp_path, version):
    text = shipped_text("hfie")
    steps, path = made(text, tmp_path, version)
    rows = scattered(steps, 40)
    rows = rows[~np.isnan(rows).any(axis=1)]  # this host interpolates between values and NaN
    rows = np.repeat(rows, 5, axis=0)  # held for five periods, as the host does
    fine = model_drives(text, steps, rows)[4::5]
    coarse = simulated(
        steps, path, rows, step_size=5 * text.model.period, output_interval=5 * text.model.period
    )
    np.testing.assert_array_equal(coarse[: len(fine)], fine)


HOLDING = """rulebase valve "a valve that stays where it was"
input level 1 .. 9 "m"
input 'flow in' -2 .. 2
output u 0 .. 5 "position"
output v -4 .. 4
term level LOW: triangle 0 2 4
term level HIGH: triangle 6 8 10
term 'flow in' IN: trapezoid -1 0 3 3
term u SHUT: triangle 0 0 2
term u OPEN: triangle 3 5 5
term v A: singleton -3
term v B: singleton 2.5
inference and min, or max, implication min, aggregation max, defuzzifier centroid exact
inference u: no-rule hold
inference v: defuzzifier weighted-average, no-rule 1.5
rule if level is LOW then u is OPEN, v is A
rule if level is HIGH and 'flow in' is IN then u is SHUT, v is B
"""


def compiled_unit(folder, source, *words):
    """Return the path of a unit that the command made."""
    path = folder / "unit.fmu"
    assert main(["compile", str(source), "-o", str(path), *words]) == 0
    return path


def at_steps(path, inputs, outputs, points, **options):
    """Return the outputs of a unit at the end of steps of 1 s, with a row of inputs in each."""
    signals = np.array(
        [(float(k), *row) for k, row in enumerate(points.tolist())],
        dtype=[("time", float), *((name, float) for name in inputs)],
    )
    found = fmpy.simulate_fmu(
        str(path), stop_time=float(len(points)), step_size=1.0, output_interval=1.0,
        input=signals, output=outputs, **options,
    )  # fmt: skip
    return np.array([[row[name] for name in outputs] for row in found])[1:]


@pytest.mark.slow
@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("name", ["pd7", "tipper", "fan"])
def test_a_unit_of_rules_is_valid_and_infers_the_same_bits(tmp_path, name, version):
    from fmpy.validation import validate_fmu

    source = shipped(f"{name}.frb")
    path = compiled_unit(tmp_path, source, "--direct", "--fmi", version)
    assert validate_fmu(str(path)) == []
    rulebase = load(source)
    inputs, outputs = ([v.name for v in side] for side in (rulebase.inputs, rulebase.outputs))
    low, high = ([getattr(v, end) for v in rulebase.inputs] for end in ("low", "high"))
    points = np.random.default_rng(4).uniform(low, high, (300, len(inputs)))
    found = at_steps(path, inputs, outputs, points)
    right = infer(rulebase, **dict(zip(inputs, points.T, strict=True)))
    np.testing.assert_array_equal(found, np.stack([right[name] for name in outputs], 1))


@pytest.mark.parametrize("version", ["2", "3"])
def test_an_output_of_a_unit_is_held_from_step_to_step(tmp_path, version):
    from fmpy.validation import validate_fmu

    source = tmp_path / "valve.frb"
    source.write_text(HOLDING)
    path = compiled_unit(tmp_path, source, "--fmi", version)
    assert validate_fmu(str(path)) == []
    variables = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
    assert list(variables)[:5] == ["level", "'flow in'", "first.u", "u", "v"]
    assert variables["level"].description == "m"
    assert float(variables["level"].start) == 1.0  # within its range, nearest to 0
    points = np.random.default_rng(2).uniform([1, -2], [9, 2], (200, 2))
    points[:3] = 5.0, 0.0  # no rule fires
    options = {"start_values": {"first.u": 4.25}, "apply_default_start_values": True}
    found = at_steps(path, ["level", "'flow in'"], ["u", "v"], points, **options)
    rulebase, last = load(source), 4.25
    for (level, flow), values in zip(points.tolist(), found.tolist(), strict=True):
        right = cached_engine(rulebase)({"level": level, "flow in": flow}, held={"u": last})
        assert values == [right["u"], right["v"]]
        last = right["u"]
    assert found[:3].tolist() == [[4.25, 1.5]] * 3


def test_a_unit_of_a_table_looks_it_up(tmp_path):
    path = compiled_unit(tmp_path, shipped("pd7.frb"), "--table", "--levels", "9")
    points = np.random.default_rng(4).uniform(-6, 6, (100, 2))
    table = compile_table(load(shipped("pd7.frb")), levels=9)
    found = at_steps(path, ["e", "ce"], ["u"], points)
    np.testing.assert_allclose(found[:, 0], table.lookup(*points.T), rtol=0, atol=1e-12)


def library_of(path, folder):
    with zipfile.ZipFile(path) as archive:
        (name,) = (n for n in archive.namelist() if n.startswith("binaries/"))
        archive.extractall(folder)
    return ctypes.CDLL(str(folder / name))


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_every_function_of_the_standard_is_there(tmp_path, version):
    header = Path(fmpy.__file__).parent / "c-code" / f"fmi{version}FunctionTypes.h"
    names = set(re.findall(rf"\b(fmi{version}\w+)TYPE\b", header.read_text()))
    assert len(names) > 40
    _, path = made(shipped_text("fuzzy-lut"), tmp_path, version)
    library = library_of(path, tmp_path / "unit")
    assert [name for name in sorted(names) if not hasattr(library, name)] == []


@pytest.mark.slow
def test_a_state_is_kept_and_restored(tmp_path):
    text = shipped_text("soc-zero")
    steps, path = made(text, tmp_path, 2)
    library = library_of(path, tmp_path / "unit")
    library.fmi2Instantiate.restype = ctypes.c_void_p
    guid = fmpy.read_model_description(path).guid
    assert library.fmi2Instantiate(b"x", 1, b"another", None, None, 0, 0) is None
    assert library.fmi2Instantiate(b"x", 0, guid.encode(), None, None, 0, 0) is None
    unit = ctypes.c_void_p(library.fmi2Instantiate(b"x", 1, guid.encode(), None, None, 0, 0))
    count = len(ports(steps))
    references = (ctypes.c_uint * count)(*range(count))
    drive = (ctypes.c_uint * 1)(count + len(steps.of_sort("gain")))
    out = (ctypes.c_double * 1)()
    period = text.model.period
    rows = scattered(steps, 30).tolist()

    def step(k):
        values = (ctypes.c_double * count)(*rows[k])
        assert library.fmi2SetReal(unit, references, ctypes.c_size_t(count), values) == 0
        now, size = ctypes.c_double(k * period), ctypes.c_double(period)
        assert library.fmi2DoStep(unit, now, size, 1) == 0
        assert library.fmi2GetReal(unit, drive, ctypes.c_size_t(1), out) == 0
        return out[0]

    for k in range(10):
        step(k)
    state = ctypes.c_void_p()
    assert library.fmi2GetFMUstate(unit, ctypes.byref(state)) == 0
    first = [step(k) for k in range(10, 30)]
    assert library.fmi2SetFMUstate(unit, state) == 0
    assert [step(k) for k in range(10, 30)] == first
    assert library.fmi2FreeFMUstate(unit, ctypes.byref(state)) == 0
    assert state.value is None
    assert library.fmi2SetReal(unit, drive, ctypes.c_size_t(1), out) == 3  # an output
    library.fmi2FreeInstance(unit)


@pytest.mark.slow
def test_a_unit_comes_out_the_same_again(tmp_path):
    program = ControllerProgram(shipped_text("fuzzy-lut"), "float64")
    one, two = (export_controller(program, tmp_path / "made.fmu").files[0][1] for _ in range(2))
    assert one == two


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["no-such-compiler", "false"])
def test_without_a_compiler_that_works_nothing_is_written(tmp_path, monkeypatch, capsys, compiler):
    monkeypatch.setenv("CC", compiler)
    out = tmp_path / "made.fmu"
    assert main(["compile", str(shipped("fuzzy-lut.frb")), "-o", str(out)]) == 1
    assert "C compiler" in capsys.readouterr().err
    assert os.listdir(tmp_path) == []


def test_a_machine_without_a_compiler_is_told_so(tmp_path, monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ExportError, match="needs a C compiler") as caught:
        find_compiler()
    assert "CC" in caught.value.hint


HEADS = {"linux64": b"\x7fELF", "win64": b"MZ", "darwin64": b"\xcf\xfa\xed\xfe"}


def built_for(platforms, folder):
    need("ziglang")
    out = folder / "servo.fmu"
    words = ["compile", str(shipped("servo.frb")), "-o", str(out), "--platforms", platforms]
    assert main(words) == 0
    with zipfile.ZipFile(out) as archive:
        names = [name for name in archive.namelist() if name.startswith("binaries/")]
        assert [name.split("/")[1] for name in names] == platforms.split(",")
        for name in names:
            assert archive.read(name).startswith(HEADS[name.split("/")[1]])
    return out


@pytest.mark.slow
def test_a_unit_holds_libraries_for_other_platforms(tmp_path):

    out = built_for("linux64,darwin64", tmp_path)
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(out)) == []
    if sys.platform == "linux" and platform.machine() == "x86_64":
        assert fmpy.simulate_fmu(str(out), stop_time=0.01, step_size=0.001) is not None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--platforms", "amiga"], "no platform 'amiga' (there are linux64"),
        (["--platforms", "aarch64-linux"], "version 2 of FMI does not know 'aarch64-linux'"),
    ],
)
def test_platforms_that_are_not_known_are_named(tmp_path, capsys, words, message):
    out = tmp_path / "servo.fmu"
    assert main(["compile", str(shipped("servo.frb")), "-o", str(out), *words]) == 1
    assert message in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.slow
def test_without_the_wheel_it_says_what_to_install(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("fuzzyarm.exchange.export.fmu.find_spec", lambda name: None)
    words = ["compile", str(shipped("servo.frb")), "-o", str(tmp_path / "servo.fmu")]
    assert main([*words, "--platforms", "linux64"]) == 1
    err = capsys.readouterr().err
    assert "the ziglang wheel, which is not installed" in err
    assert "platforms]" in err
