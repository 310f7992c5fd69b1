"""fuzzyarm compile to source text, as it is called; and the page that explains it."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from c_programs import HOST, compile_c, execute, need
from fis import system

from fuzzyarm import load
from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.exchange.export import EXPORTS
from fuzzyarm.inference import infer
from fuzzyarm.language import load_rulebase
from fuzzyarm.table import read_table

ROOT = Path(__file__).parents[2]
PD7 = str(ROOT / "rulebases" / "pd7.frb")
TABLE = str(ROOT / "rulebases" / "thesis-6.1.lut")
PAGE = (ROOT / "docs" / "reference" / "export.md").read_text("utf-8")

TWO = """rulebase two
input a 0 .. 1
output y 0 .. 1
output 'z z' -1 .. 1
terms a, y, 'z z': triangles LO HI
rule if a is LO then y is HI and 'z z' is LO
rule if a is HI then y is LO and 'z z' is HI
"""


def run_program(source, folder, words=()):
    path = folder / "mine.c"
    path.write_text(source, "utf-8")
    compile_c([path, *words], folder / "mine")
    return subprocess.run([folder / "mine"], capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("name", ["controller.h", "controller.c"])
@pytest.mark.parametrize(
    "options",
    [[], ["--mode", "linear"], ["--direct"], ["--q", "7"], ["--precision", "float32", "--direct"]],
    ids=" ".join,
)
def test_an_export_passes_its_own_test(tmp_path, monkeypatch, capsys, name, options):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", PD7, "-o", name, *options]) == 0
    assert "controller_u(" in capsys.readouterr().out
    source = [*(["-x", "c"] if name.endswith("h") else []), name]
    compile_c(source, tmp_path / "test", HOST, "-DFUZZYARM_SELF_TEST")
    assert execute(tmp_path / "test") == 0


def test_the_program_of_the_page_compiles_and_agrees(tmp_path, monkeypatch, capsys):
    example, _ = re.findall(r"```c\n(.*?)```", PAGE, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    assert main(["compile", PD7, "-o", "controller.h"]) == 0
    capsys.readouterr()
    assert main(["compile", PD7, "-o", "pd7.lut"]) == 0
    expected = read_table("pd7.lut").lookup(1.3, -2.2)
    assert run_program(example, tmp_path) == f"{expected:.1f}\n"


def test_the_controller_of_the_page_compiles_and_drives(tmp_path, monkeypatch, capsys):
    _, example = re.findall(r"```c\n(.*?)```", PAGE, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    stfc = str(ROOT / "rulebases" / "stfc.frb")
    assert main(["compile", stfc, "-o", "stfc.h"]) == 0
    run = load(stfc).run(gains={"G_u": 2.0}, single=True, compiled=False)
    still = dict.fromkeys(run.inputs, 0.0)
    drive = run.step(still, still | {"joint1.position": 0.001})["joint1.voltage"]
    said = f"{drive:.3f} V at an error of {run.signal('joint1', 'e'):.3f}\n"
    assert run_program(example, tmp_path) == said


def test_headers_of_several_controllers_live_in_one_program(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", PD7, "-o", "one.h"]) == 0
    assert main(["compile", PD7, "-o", "two.h", "--direct"]) == 0
    assert main(["compile", TABLE, "-o", "three.h", "--q", "15", "--name", "third"]) == 0
    source = (
        '#include "one.h"\n#include "two.h"\n#include "three.h"\n#include "one.h"\n'
        "#include <stdio.h>\nint main(void)\n{\n"
        '    printf("%.9g %.9g %d\\n", (double)one_u(1.0f, 2.0f), (double)two_u(1.0f, 2.0f),\n'
        "           third_u(5461, 10923));\n    return 0;\n}\n"
    )
    one, two, three = run_program(source, tmp_path).split()
    assert float(one) == pytest.approx(2.0, abs=2.0)
    direct = infer(load_rulebase(PD7), e=1.0, ce=2.0)["u"]
    assert np.float32(two) == np.float32(direct)
    assert int(three) * 6 / 32768 == pytest.approx(read_table(TABLE).lookup(1.0, 2.0), abs=2e-4)


def test_a_header_serves_cxx_too(tmp_path, monkeypatch):
    need("g++")
    monkeypatch.chdir(tmp_path)
    assert main(["compile", PD7, "-o", "pair.c", "--direct"]) == 0
    (tmp_path / "use.cpp").write_text(
        '#include "pair.h"\nint main() { return pair_u(0.0f, 0.0f) == 0.0f ? 0 : 1; }\n'
    )
    compile_c(["-c", "pair.c"], tmp_path / "pair.o")
    words = ["g++", "-Wall", "-Wextra", "-Werror", "-fsanitize=undefined,address"]
    subprocess.run([*words, "use.cpp", "pair.o", "-o", "use"], check=True)
    assert execute(tmp_path / "use") == 0


def test_every_output_gets_a_function(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("two.frb").write_text(TWO)
    for options in ([], ["--direct"], ["--table"]):
        assert main(["compile", "two.frb", "-o", "two.h", "--json", *options]) == 0
        data = json.loads(capsys.readouterr().out)
        assert data["files"] == ["two.h"]
        assert [f["call"] for f in data["functions"]] == [
            "float two_y(float a)",
            "float two_z_z(float a)",
        ]
        assert [len(f["operations"]) > 0 for f in data["functions"]] == [True, True]
        assert len(data["tables"]) == (2 if options == ["--table"] else 0)
    assert main(["compile", "two.frb", "-o", "two.h", "--output", "z z"]) == 0
    assert "two_y" not in Path("two.h").read_text()
    assert main(["compile", "two.frb", "-o", "two.st"]) == 0
    assert Path("two.st").read_text().count("FUNCTION_BLOCK two_") == 2


FIS = (
    system("tip")
    + """\
[Input1]
Name='service'
Range=[0 10]
NumMFs=2
MF1='poor':'gaussmf',[1.5 0]
MF2='good':'gaussmf',[1.5 10]
[Output1]
Name='tip'
Range=[0 30]
NumMFs=2
MF1='cheap':'trimf',[0 5 10]
MF2='generous':'trimf',[20 25 30]
[Rules]
1, 1 (1) : 1
2, 2 (1) : 1
"""
)


def test_a_foreign_file_is_inferred_and_a_table_has_to_be_asked_for(tmp_path, monkeypatch, capsys):
    """Thirteen even levels that nobody chose would be off by some units of the output."""
    monkeypatch.chdir(tmp_path)
    Path("tip.fis").write_text(FIS)
    assert main(["compile", "tip.fis", "-o", "tip.h"]) == 0
    said = capsys.readouterr().out
    assert "cells" not in said
    assert "float tip_tip(float service)" in said
    compile_c(["-x", "c", "tip.h"], tmp_path / "test", HOST, "-DFUZZYARM_SELF_TEST")
    assert execute(tmp_path / "test") == 0
    for options in (["--table"], ["--levels", "9"], ["--q", "7"], ["--mode", "linear"]):
        assert main(["compile", "tip.fis", "-o", "tip.h", *options]) == 0
        assert "cells of tip over service" in capsys.readouterr().out


def test_what_cannot_be_inferred_says_that_a_table_can(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("tip.fis").write_text(FIS.replace("DefuzzMethod='centroid'", "DefuzzMethod='mom'"))
    words = ["compile", "tip.fis", "-o", "tip.h"]
    assert main([*words, "--precision", "float32"]) == 1
    err = capsys.readouterr().err
    assert "double precision only" in err
    assert "--table" in err
    assert not Path("tip.h").exists()
    assert main([*words, "--precision", "float32", "--table"]) == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([PD7, "-o", "x.lut", "--q", "15"], "--q does not apply"),
        ([PD7, "-o", "x.lut", "--direct"], "--direct does not apply"),
        ([PD7, "-o", "x.h", "--direct", "--q", "7"], "--q does not apply"),
        ([PD7, "-o", "x.h", "--direct", "--levels", "7"], "--levels does not apply"),
        ([PD7, "-o", "x.fmu", "--q", "15"], "an FMU computes in double precision"),
        ([PD7, "-o", "x.h", "--table", "--direct"], "--table and --direct exclude each other"),
        ([PD7, "-o", "x.lut", "--table"], "--table does not apply"),
        ([PD7, "-o", "x.h", "--name", "int"], "'int' cannot begin an identifier"),
        ([PD7, "-o", "x.h", "--name", "a b"], "for instance a_b_x"),
        ([PD7, "-o", "x.h", "--q", "7", "--precision", "float32"], "--precision does not apply"),
        ([PD7, "-o", 'x"y.h'], "cannot be used in an #include"),
        ([PD7, "-o", "x.h", "--output", "v"], "no output 'v'"),
        ([PD7, "-o", "x.h", "--output", "v", "--direct"], "no output 'v'"),
        ([TABLE, "-o", "x.h", "--direct"], "is a table already"),
        ([PD7, "-o", "nowhere/x.h"], "no such folder: 'nowhere'"),
    ],
)
def test_it_complains_in_one_sentence_and_writes_nothing(
    tmp_path, monkeypatch, capsys, words, message
):
    monkeypatch.chdir(tmp_path)
    usage = "does not apply" in message or "exclude each other" in message
    usage |= message == "is a table already"
    assert main(["compile", *words]) == (2 if usage else 1)
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert message in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_compiling_twice_gives_the_same_bytes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for suffix in EXPORTS:
        files = []
        for _ in range(2):
            assert main(["compile", PD7, "-o", f"c{suffix}"]) == 0
            files.append(Path(f"c{suffix}").read_bytes())
        assert files[0] == files[1]


@pytest.mark.parametrize(
    "words", [["-o", "con.h"], ["-o", "Lpt1.scl"], ["--for", "arduino", "-o", "aux"]]
)
def test_devices_of_windows_are_no_names(tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", str(shipped("pd7.frb")), *words]) == 1
    assert "is the name of a device on Windows" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_the_tia_portal_does_not_take_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = re.sub(r"\bce\b", "c" * 130, shipped("pd7.frb").read_text("utf-8"))
    Path("long.frb").write_text(text)
    assert main(["compile", "long.frb", "--direct", "-o", "long.scl"]) == 1
    assert "has 130 letters, and the TIA Portal takes 125" in capsys.readouterr().err
    assert not Path("long.scl").exists()


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".h", ".c"])
def test_headers_under_one_name_do_not_hide_each_other(tmp_path, suffix):
    need(HOST)
    for stem, source in (("one", shipped("pd7.frb")), ("two", shipped("tipper.frb"))):
        words = ["compile", str(source), "-o", str(tmp_path / f"{stem}{suffix}"), "--name", "made"]
        assert main(words) == 0
    program = tmp_path / "program.c"
    program.write_text(
        '#include "one.h"\n#include "two.h"\n#include "one.h"\n#include "two.h"\n'
        "double both(void);\ndouble both(void) { return made_u(0, 0) + made_tip(1, 1); }\n"
    )
    ran = subprocess.run(
        [HOST, "-std=c99", "-Werror=implicit-function-declaration", "-c", "program.c"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if suffix == ".c":
        assert ran.returncode == 0, ran.stderr
    else:  # both have helpers of their own under that name: the compiler says it
        assert "redefinition" in ran.stderr
