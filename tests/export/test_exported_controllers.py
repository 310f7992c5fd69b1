"""Exported controllers: C, Structured Text and units drive what the controller drives."""

from __future__ import annotations

import json
import math
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from c_programs import compile_c, execute, need
from controller_programs import (
    EVERYTHING,
    SHIPPED,
    model_drives,
    ports,
    recorded,
    run_in_c,
    scattered,
    shipped_text,
    text_of,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from st_programs import Program

from fuzzyarm import load_controller
from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.exchange import compiled
from fuzzyarm.exchange.export import (
    ControllerProgram,
    ExportError,
    export_controller,
    with_tables,
    write,
)
from fuzzyarm.exchange.export.controller_lowering import controller_program
from fuzzyarm.exchange.export.trial import EvaluatedController
from fuzzyarm.exchange.export.walk_of_steps import steps_of
from fuzzyarm.symbolic.identifiers import identifier
from fuzzyarm.table import compile_table

ONE_OF_EACH = ("cfaf", "hfie", "soc-table", "fuzzy-fine", "fuzzy-lut")


@pytest.mark.slow
def test_shipped_controllers_drive_the_same_bits_in_c(tmp_path):
    # One program for all of them: 2,000 periods each on masses that the drives push.
    programs, expected = {}, {}
    for name in SHIPPED:
        text = shipped_text(name)
        for precision in ("float64", "mixed") if name in ONE_OF_EACH else ("float64",):
            steps = steps_of(text, precision)
            key = f"{identifier(name)}_{precision}"
            rows, expected[key] = recorded(text, steps, single=precision == "mixed")
            programs[key] = (steps, rows)
    found = run_in_c(programs, tmp_path, "-O0", "-fno-sanitize=all")
    for key, drives in found.items():
        if key.endswith("mixed"):  # the ports of C are float
            expected[key] = expected[key].astype(np.float32).astype(float)
        np.testing.assert_array_equal(drives, expected[key], key)
        assert np.abs(drives).max() > 1.0


def test_every_kind_of_line_drives_the_same_bits_in_c(tmp_path):
    text = text_of(EVERYTHING)
    programs, expected = {}, {}
    for precision in ("float64", "mixed", "float32"):
        steps = steps_of(text, precision)
        rows = scattered(steps)
        programs[precision] = (steps, rows)
        if precision == "float32":
            evaluated = EvaluatedController(controller_program(steps))
            expected[precision] = [list(evaluated.step(*row)) for row in np.array(rows).tolist()]
            truth = model_drives(text, steps, rows)
            assert np.abs(np.array(expected[precision]) - truth).max() < 1e-4 * np.abs(truth).max()
        else:
            drives = model_drives(text, steps, rows, single=precision == "mixed")
            outside = np.float32 if precision == "mixed" else np.float64
            expected[precision] = drives.astype(outside).astype(float)
    for precision, drives in run_in_c(programs, tmp_path).items():
        np.testing.assert_array_equal(drives, expected[precision], precision)


def compiled_with(**options):
    return lambda rulebase, output: compile_table(rulebase, output, **options)


@pytest.mark.parametrize("mode", ["bins", "linear"])
def test_tables_in_place_of_rules_drive_the_same_bits_in_c(tmp_path, mode):
    text = with_tables(shipped_text("cfaf"), compiled_with(mode=mode))
    programs, expected = {}, {}
    for precision in ("float64", "mixed"):
        steps = steps_of(text, precision)
        rows = scattered(steps)
        single = precision == "mixed"
        drives = model_drives(text, steps, rows, single=single)
        expected[precision] = drives.astype(np.float32).astype(float) if single else drives
        programs[precision] = (steps, rows)
    for precision, drives in run_in_c(programs, tmp_path).items():
        np.testing.assert_array_equal(drives, expected[precision], precision)


TWO_OUTPUTS = """
rulebase sched
input e -6 .. 6
output Kp 0 .. 4
output Ki 0 .. 2
terms e, Kp, Ki: triangles S M L
rule if e is S then Kp is L and Ki is S
rule if e is M then Kp is M and Ki is M
rule if e is L then Kp is S and Ki is L

controller scheduled
period 10 ms
axis a
  e = error of x
  Kp, Ki = rules sched(e) * 2
  i = integral of e
  drive u = e * Kp + i * Ki
"""


def test_a_rule_base_of_several_outputs_becomes_a_table_for_each(tmp_path):
    text = text_of(TWO_OUTPUTS)
    tables = with_tables(text, compiled_with(levels=25, mode="linear"))
    assert sorted(tables.sheets) == ["sched", "sched_Ki", "sched_Kp"]
    programs = {"rules": steps_of(text), "tables": steps_of(tables)}
    rows = scattered(programs["rules"])
    found = run_in_c({k: (steps, rows) for k, steps in programs.items()}, tmp_path)
    for name, whole in (("rules", text), ("tables", tables)):
        np.testing.assert_array_equal(found[name], model_drives(whole, programs[name], rows))
    assert np.abs(found["rules"] - found["tables"]).max() < 0.2 * np.abs(found["rules"]).max()


LINES = st.sampled_from(
    [
        "{n} = error of x * K", "{n} = error of x, weight 0.3", "{n} = change of {s}",
        "{n} = rate of {s} * 0.01", "{n} = rate of {s}, filter 30 ms",
        "{n} = lag of {s}, time 0.1 s",
        "{n} = integral of {s}", "{n} = integral of {s}, within -0.5 .. 2, anti-windup hold",
        "{n} = integral of {s}, anti-windup back 0.2 s, start 0.1", "{n} = sum of error of x",
        "{n} = sum of error of x, cleared each set-point", "{n} = {s} * K / 3 - 2 * {s} + 1",
        "{n} = -{s}", "zoom {s}, e by 3 inside 1", "zoom {s} by K inside 2, edge wait",
        "drive u = {s}, within -2 .. 1", "drive u = {s} - e, slew 40",
        "drive v = {s} * 2, within -1 .. 1, slew 10",
    ]
)  # fmt: skip


@st.composite
def controllers(draw):
    """Any lines, each on a signal that is there."""
    signals, lines = ["e"], ["e = error of x"]
    for number, line in enumerate(draw(st.lists(LINES, min_size=1, max_size=8))):
        lines.append(line.format(n=f"s{number}", s=draw(st.sampled_from(signals))))
        if line.startswith("{n}"):
            signals.append(f"s{number}")
    head = ["controller c", "period 10 ms", "set-point every 3", "gain K = 1.7, 0.4", "axis a, b"]
    return "\n".join([*head, *(f"  {line}" for line in [*lines, f"drive u = {signals[-1]}"])])


@given(controllers(), st.booleans())
@settings(max_examples=cases(8, 25), deadline=None)
def test_the_steps_are_the_instructions_of_any_controller(text, single):
    whole = text_of(text)
    steps = steps_of(whole, "mixed" if single else "float64")
    rows = scattered(steps, 12)
    evaluated = EvaluatedController(controller_program(steps))
    found = [list(evaluated.step(*row)) for row in rows.tolist()]
    expected = model_drives(whole, steps, rows, single=single)
    outside = np.float32 if single else np.float64
    np.testing.assert_array_equal(found, expected.astype(outside))


# --- The files ---


@pytest.mark.parametrize(
    ("name", "suffix", "options"),
    [
        ("stfc", ".h", {}),
        ("soc-zero", ".c", {"precision": "float32"}),
        ("hfie", ".c", {"precision": "float64"}),
        ("fuzzy-lut", ".h", {"q": 15}),
        ("fuzzy-lut-x10", ".c", {"q": 7, "precision": "float32"}),
    ],
)
def test_an_exported_controller_passes_its_own_test(tmp_path, name, suffix, options):
    program = ControllerProgram(shipped_text(name), **options)
    exported = export_controller(program, tmp_path / f"made{suffix}")
    exported.write()
    source = [*(["-x", "c"] if suffix == ".h" else []), tmp_path / f"made{suffix}"]
    compile_c(source, tmp_path / "test", "gcc", "-pedantic", "-DFUZZYARM_SELF_TEST")
    assert execute(tmp_path / "test") == 0
    # It can fail: another gain is another controller.
    text = (tmp_path / f"made{suffix}").read_text()
    gain = "s->gains.supply = 20.0"
    assert gain in text
    (tmp_path / "wrong.c").write_text(text.replace(gain, "s->gains.supply = 20.1"))
    compile_c([tmp_path / "wrong.c"], tmp_path / "wrong", "gcc", "-DFUZZYARM_SELF_TEST")
    assert execute(tmp_path / "wrong") == 1


MAIN = r"""
#include <stdio.h>
#include "made.h"
int main(void)
{
    static made_state s, again;
    static float values[MADE_LEARNED_CELLS];
    static unsigned long visits[MADE_LEARNED_CELLS];
    static made_reference r;
    static made_measured m;
    static made_drives u, v;
    unsigned k;
    made_init(&s);
    r.joint1.position = 0.002f;
    for (k = 0u; k < 5u; k++) {
        made_step(&s, &r, &m, &u);
    }
    made_save(&s, values, visits);
    made_init(&again);
    made_load(&again, values, 0);
    made_step(&again, &r, &m, &v);
    made_step(&s, &r, &m, &u);
    printf("%.6g %.6g ", (double)u.joint1.voltage, (double)v.joint1.voltage);
    printf("%lu\n", visits[8 * 13 + 6]);
    return 0;
}
"""


def run_program(program):
    return subprocess.run([program], capture_output=True, text=True, check=True).stdout


def test_a_table_that_learned_is_saved_and_loaded(tmp_path):
    need("gcc")
    text = shipped_text("soc-zero")
    export_controller(ControllerProgram(text), tmp_path / "made.h").write()
    (tmp_path / "main.c").write_text(MAIN)
    compile_c([tmp_path / "main.c"], tmp_path / "main")
    said = run_program(tmp_path / "main")
    u, v, visits = map(float, said.split())
    run = text.run(single=True, compiled=False)
    still = dict.fromkeys(run.inputs, 0.0)
    moved = still | {"joint1.position": float(np.float32(0.002))}
    *_, before, after = [run.step(still, moved)["joint1.voltage"] for _ in range(6)]
    assert u == pytest.approx(after, rel=1e-5)
    # Loaded, it has not yet a cell that was in use: the first period corrects none.
    assert v == pytest.approx(before, rel=1e-5)
    assert visits == 5


def test_the_end_of_a_set_point_can_come_off_the_count(tmp_path):
    need("gcc")
    export_controller(
        ControllerProgram(shipped_text("hfie"), "float64"), tmp_path / "made.h"
    ).write()
    (tmp_path / "main.c").write_text(r"""
#include <stdio.h>
#include "made.h"
int main(void)
{
    static made_state s;
    static made_reference r;
    static made_measured m;
    static made_drives u;
    unsigned k;
    made_init(&s);
    r.joint1.position = 1.0;
    for (k = 0u; k < 9u; k++) {
        if (k == 1u) {
            s.until_set_point = 1u;
        }
        made_step(&s, &r, &m, &u);
        printf("%g ", u.joint1.torque / s.gains.K_I);
    }
    return 0;
}
""")
    compile_c([tmp_path / "main.c"], tmp_path / "main")
    said = run_program(tmp_path / "main")
    assert said.split() == ["1", "2", "1", "2", "3", "4", "5", "1", "2"]


ODD = {
    "constant": ["axis a", "  drive y = 3"],
    "measured only": ["axis a", "  u = measured x", "  drive y = u"],
    "reserved words": [
        "gain 'int' = 2 \"/* a */\"", "axis 'double', 'ä b'", "  u = reference 'for' * 'int'",
        "  drive 'if' = u",
    ],
    "names of ours": [
        "gain s = 1, 2", "axis gains, drive", "  first = error of x * s",
        "  reference = change of first", "  t = lag of reference, time 1 s", "  drive s = t",
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", ODD)
def test_odd_names_and_missing_parts_are_no_trouble(tmp_path, name):
    text = text_of("\n".join(["controller c", "period 1 ms", *ODD[name]]))
    for precision in ("mixed", "float64"):
        path = tmp_path / f"step_{precision}.h"
        export_controller(ControllerProgram(text, precision), path).write()
        compile_c(["-x", "c", path], tmp_path / "test", "gcc", "-DFUZZYARM_SELF_TEST")
        assert execute(tmp_path / "test") == 0
    exported = export_controller(ControllerProgram(text, "float32"), tmp_path / "plc.st")
    Program(exported.files[0][1]).instance(exported.calls[0]).run()


# --- Structured Text ---


def st_name(steps, port):
    axis = "" if len(steps.model.axis_names) == 1 else f"{port.axis}_"
    front = "" if port.sort == "drive" else f"{port.sort}_"
    return identifier(f"{front}{axis}{port.name}").lower()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "precision"),
    [
        ("everything", "float64"), ("everything", "mixed"), ("everything", "float32"),
        ("soc-table", "mixed"), ("cfaf", "mixed"), ("fuzzy-fine", "float32"),
        ("fuzzy-lut", "mixed"),
    ],
)  # fmt: skip
def test_a_function_block_drives_the_same_bits(tmp_path, name, precision):
    text = text_of(EVERYTHING) if name == "everything" else shipped_text(name)
    program = ControllerProgram(text, precision)
    exported = export_controller(program, tmp_path / "plc.st")
    ((_, content),) = exported.files
    block = Program(content).instance(exported.calls[0])
    steps, vectors = program.steps, program.tried.vectors
    for row, expected in list(zip(vectors.inputs, vectors.expected, strict=True))[:40]:
        names = [st_name(steps, port) for port in ports(steps)]
        block.run(**dict(zip(names, row, strict=True)))
        found = block.outputs()
        assert [float(found[st_name(steps, p)]) for p in steps.of_sort("drive")] == expected


@pytest.mark.slow
def test_a_gain_of_a_function_block_changes_between_calls_and_stays(tmp_path):
    text = shipped_text("servo")
    exported = export_controller(ControllerProgram(text, "float64"), tmp_path / "plc.st")
    block = Program(exported.files[0][1]).instance(exported.calls[0])
    for row, more in enumerate([{}, {"g_u": 2.0}, {}, {"g_u": 4.5, "g_e": 8.0}, {}]):
        gains = {"G_u": 2.0} if row in (1, 2) else {"G_e": 8.0} if row > 2 else {}
        sides = {"position": 0.02 + 0.001 * row, "velocity": -0.1}
        block.run(**more, **{f"measured_{name}": value for name, value in sides.items()},
                  reference_position=0.0, reference_velocity=0.0)  # fmt: skip
        drives = text.run(gains=gains).step(sides, {"position": 0.0, "velocity": 0.0})
        assert float(block.outputs()["voltage"]) == next(iter(drives.values())) != 0.0


def test_fixed_point_tables_in_a_function_block(tmp_path):
    program = ControllerProgram(shipped_text("fuzzy-lut"), "float32", 15)
    exported = export_controller(program, tmp_path / "plc.st")
    block = Program(exported.files[0][1]).instance("plc")
    steps, vectors = program.steps, program.tried.vectors
    for row, expected in zip(vectors.inputs, vectors.expected, strict=True):
        names = [st_name(steps, port) for port in ports(steps)]
        block.run(**dict(zip(names, row, strict=True)))
        *drives, error = block.outputs().values()
        assert [float(x) for x in drives] == expected
        assert error is any(map(math.isnan, row))


# --- What cannot be exported, and the command ---


def test_what_cannot_be_exported_is_named(tmp_path):
    with pytest.raises(ExportError, match="partner 'base' is the law 'ffid'") as caught:
        steps_of(shipped_text("ffid+fuzzy"))
    assert caught.value.hint
    with pytest.raises(ExportError, match="learns is exported in floating point"):
        ControllerProgram(shipped_text("soc-zero"), q=15).steps  # noqa: B018
    held = TWO_OUTPUTS.replace("terms e", "inference no-rule hold\nterms e")
    with pytest.raises(ExportError, match="holds its value where no rule fires"):
        steps_of(text_of(held))
    with pytest.raises(ExportError, match="has no suffix of an export"):
        export_controller(ControllerProgram(shipped_text("stfc")), tmp_path / "x.zig")
    with pytest.raises(ExportError, match="cannot begin an identifier"):
        export_controller(ControllerProgram(shipped_text("stfc")), tmp_path / "x.h", "int")


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["--levels", "9"], 2, "without --table"),
        (["--q", "15"], 1, "--q 15 does not apply"),
        (["--table", "--direct"], 2, "exclude each other"),
        (["--fmi", "3"], 2, "not an FMU"),
        (["--output", "u"], 2, "as a whole"),
        (["--table", "--levels", "x"], 2, "--levels 'x'"),
    ],
)
def test_options_that_do_not_fit_are_refused(tmp_path, capsys, words, status, message):
    out = tmp_path / "made.h"
    assert main(["compile", str(shipped("stfc.frb")), "-o", str(out), *words]) == status
    assert message in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_controller_writes_nothing(tmp_path, capsys):
    damaged = tmp_path / "damaged.frb"
    damaged.write_text(EVERYTHING.replace("lag of du", "lag of nothing"))
    assert main(["compile", str(damaged), "-o", str(tmp_path / "made.h")]) == 1
    assert "nothing" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["damaged.frb"]


@pytest.mark.slow
def test_the_command_says_what_it_wrote(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    stfc = str(shipped("stfc.frb"))
    assert main(["compile", stfc, "-o", "stfc.h"]) == 0
    said = capsys.readouterr().out
    assert "void stfc_step(stfc_state *s, const stfc_reference *reference" in said
    words = ["--table", "--mode", "linear", "--name", "mine", "--json"]
    assert main(["compile", stfc, "-o", "made.c", *words]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["files"] == ["made.c", "made.h"]
    assert found["drives"] == ["joint1.voltage", "joint2.voltage"]
    assert [table["mode"] for table in found["tables"]] == ["linear", "linear"]
    assert "mine_step" in Path("made.h").read_text()


def test_options_of_source_text_do_not_apply_to_a_table(tmp_path, capsys):
    assert main(["compile", str(shipped("pd7.frb")), "-o", str(tmp_path / "x.lut"), "--table"]) == 2
    assert "--table does not apply" in capsys.readouterr().err


@pytest.mark.slow
def test_the_difference_that_is_reported_is_that_of_the_text(tmp_path, monkeypatch):
    """A text that drives otherwise than the controller says so, whatever the steps are."""
    program = ControllerProgram(shipped_text("servo"), "float64")
    exact = export_controller(program, tmp_path / "made.py")
    assert exact.program.tried.worst == 0.0
    whole = write.module_of
    monkeypatch.setattr(
        write, "module_of", lambda *parts: whole(*parts).replace("* self.G_u", "* 4.4")
    )
    wrong = export_controller(program, tmp_path / "made.py")
    assert 0.1 < wrong.program.tried.worst < 10.0
    assert f"double precision: {wrong.program.tried.worst:.3g}" in wrong.files[0][1]


@pytest.mark.slow
def test_the_test_of_many_axes_runs_the_program_once_in_a_period(monkeypatch):
    # Errors that are chosen move each port by itself: 5,000 axes took 25 million steps of an axis.
    axis = "axis a{}\n  e = error of position\n  drive voltage = 2 * e\n"
    lines = ["controller many", "period 1 ms", *(axis.format(i) for i in range(200))]
    steps, calls = [], EvaluatedController.step
    monkeypatch.setattr(
        EvaluatedController, "step", lambda self, *ports: (steps.append(1), calls(self, *ports))[1]
    )
    program = ControllerProgram(text_of("\n".join(lines)), "float64")
    assert len(program.tried.vectors.inputs) == len(steps) > 20


BESIDE_RULES = """controller c
use pd7 from "pd7.frb"
period 1 ms
gain K = 2.5
axis shaft
  e  = error of position
  ce = error of velocity
  u  = rules pd7(e, ce) * K
  v  = u / 2 - {}
  drive voltage = v * -3 + 1, within -20 .. 20
"""


def test_the_drive_is_as_near_to_that_of_the_rules_as_the_head_says(tmp_path):
    text = text_of(BESIDE_RULES.format("e * 0"))
    how = compiled.Making(levels=9, mode="linear", table=True)
    program, (report,) = compiled.controller_program(text, how, "float64")
    said = re.search(r"voltage by at most (\S+)$", program.beside_rules)
    (line,) = [line for line in program.head() if "with rules" in line]
    assert said
    assert line == program.beside_rules
    bound = float(said[1])
    worst = 0.0
    rng = np.random.default_rng(3)
    (fidelity,) = [each for each in report.fidelities if each.mode == "linear"]
    points = [*rng.uniform(-7.0, 7.0, (100, 2)), [x for _, x in fidelity.at]]
    for e, ce in points:
        measured, zero = {"position": -e, "velocity": -ce}, {"position": 0.0, "velocity": 0.0}
        ours, rules = (c.run().step(measured, zero)["voltage"] for c in (program.text, text))
        worst = max(worst, abs(ours - rules))
    assert 0.9 * bound <= worst <= bound


@pytest.mark.parametrize(
    "body", ["lag of u, time 1 s", "integral of u", "u * e", "e * 0 + w"], ids=str.split
)
def test_without_a_constant_gain_nothing_is_said_of_the_rules(body):
    more = "  w = rules pd7(u, ce)\n" if "w" in body else ""
    text = text_of(BESIDE_RULES.format("e").replace("  v  = u / 2 - e", f"{more}  v = {body}"))
    program, _ = compiled.controller_program(text, compiled.Making(table=True), "float64")
    assert program.beside_rules == ""


WAYS_FROM_RULES = {
    "a factor": "  drive voltage = w - u * 3",
    "nothing": "  drive voltage = w",
    "another axis": "axis rotor\n  s = shaft.u * 3\n  drive voltage = s",
    "a zoom": "  zoom u, w by 2 inside 3\n  drive voltage = w",
    "a zoom of another axis": (
        "  zoom u, w by 2 inside 3\naxis rotor\n  s = shaft.w * 2\n  drive voltage = s"
    ),
    "a table that learns": (
        "  learn F by P(u, ce), delay 0\n  f = table F(e, ce)\n  drive voltage = f"
    ),
    "a choice": "  v = w where u > 1 else e\n  drive voltage = v",
}
"""Ways from rules to a drive."""


@pytest.mark.parametrize("way", WAYS_FROM_RULES)
def test_a_drive_with_tables_is_as_near_to_that_with_rules_as_is_stated(way, tmp_path):
    performance = f'from "{shipped("performance-yamazaki.lut")}"'
    (tmp_path / "law.frb").write_text(
        f'controller law\nuse pd7 from "pd7.frb"\nuse F {performance}\nuse P {performance}\n'
        "period 1 ms\naxis shaft\n  e = error of position\n  ce = error of velocity\n"
        f"  w = error of current\n  u = rules pd7(e, ce)\n{WAYS_FROM_RULES[way]}\n"
    )
    rules = load_controller(tmp_path / "law.frb")
    program, _ = compiled.controller_program(rules, compiled.Making(table=True, levels=3), "mixed")
    generator, worst = np.random.default_rng(1), 0.0
    for errors in generator.uniform(-7.0, 7.0, (100, 3)):
        values = dict(zip(("position", "velocity", "current"), errors, strict=True))
        drives = []
        for controller in (rules, program.text):
            run = controller.run()
            measured = {name: values[name.rpartition(".")[2]] for name in run.inputs}
            drives += run.step(measured, dict.fromkeys(run.inputs, 0.0)).values()
        worst = max(worst, abs(drives[0] - drives[1]))
    assert (worst > 0.0) == (way != "nothing")
    stated = re.search(r"voltage by at most (\S+)", program.beside_rules)
    assert (stated is not None) == (way in ("a factor", "nothing"))
    assert stated is None or worst <= float(stated[1])
