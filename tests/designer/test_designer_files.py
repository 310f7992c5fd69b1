"""Files, imports, exports, tables and comparison of the designer, without a browser."""

import asyncio
import base64
import json
import math
import re
import shutil
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from needs import requires

import fuzzyarm
from fuzzyarm.apps.builder.starting import PURPOSES
from fuzzyarm.apps.cli import compile as compile_command
from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.designer.comparison import compare
from fuzzyarm.apps.designer.exports import files_of, kinds_of
from fuzzyarm.apps.designer.folder import LARGEST_IMPORT, Workspace, converted_file
from fuzzyarm.apps.designer.jobs import Downloads, WindowJob
from fuzzyarm.apps.designer.names import OutsideError, clean_name, demand_name
from fuzzyarm.apps.designer.records import read_record
from fuzzyarm.apps.designer.requests import CompareWork, SurfaceAxes, TableErrorWork
from fuzzyarm.apps.designer.tables import cell_place, error_map, table_error, table_page
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.files import confined
from fuzzyarm.base.folders import EXPORTS
from fuzzyarm.base.numbers import outward_text
from fuzzyarm.base.protected import marked
from fuzzyarm.base.shipped_files import shipped, shipped_folder
from fuzzyarm.inference import infer
from fuzzyarm.proof.map.tables import cell_errors
from fuzzyarm.table import compile_table, read_table, write_table

TOKEN = "b" * 32
PD7 = shipped("pd7.frb").read_text()

HOSTILE = [
    "../x.frb", "..\\x.frb", "/etc/x.frb", "C:x.frb", ".frb", "..", "", "x\0.frb", "x\n.frb",
    "a\u202eb.frb", "CON.frb", "nul.lut", "com1.frb", "x .frb", "x..frb", "<b>.frb", 'a".frb',
    "x" * 130 + ".frb", ".hidden.frb", "x?.frb",
]  # fmt: skip


@pytest.fixture
def folder(tmp_path):
    inside = tmp_path / "inside"
    inside.mkdir()
    for name in ("pd7.frb", "servo.frb", "slide7.frb"):
        shutil.copy(shipped(name), inside / name)
    (tmp_path / "outside.frb").write_text(PD7)
    (inside / "link.frb").symlink_to(tmp_path / "outside.frb")
    return inside


def session(path):
    return Session(str(path), path.read_text())


# --- names ---


@pytest.mark.parametrize("name", HOSTILE)
def test_names_that_lead_out_or_that_no_system_takes_are_refused(name, folder):
    workspace = Workspace(folder)
    before = sorted(each.name for each in folder.parent.rglob("*"))
    with pytest.raises(OutsideError):
        demand_name(name)
    for asked in (
        {"what": "new", "kind": "pd", "name": name},
        {"what": "duplicate", "file": "pd7.frb", "name": name},
        {"what": "rename", "file": "pd7.frb", "name": name},
        {"what": "rename", "file": name, "name": "y.frb"},
        {"what": "delete", "file": name},
        {"what": "duplicate", "file": name, "name": "y.frb"},
    ):
        assert workspace.answer(asked).get("error"), asked
    assert sorted(each.name for each in folder.parent.rglob("*")) == before


@pytest.mark.parametrize("name", [*HOSTILE, "fine.fis", "日本語.fis", "a/b/c.fis", "naïve é.fis"])
def test_a_name_that_is_dropped_becomes_a_sound_one(name):
    found = clean_name(name, ".frb")
    assert demand_name(found) == found
    assert found.endswith(".frb")


# --- the folder ---


def test_the_listing_says_what_each_file_is_and_what_is_changed(folder):
    workspace = Workspace(folder)
    workspace.text("pd7.frb").replace("tern\n" + PD7, "me")
    rows = {each["name"]: each for each in workspace.answer({"what": "list"})["files"]}
    assert sorted(rows) == ["pd7.frb", "servo.frb", "slide7.frb"]  # no link that leads out
    assert rows["servo.frb"]["kind"] == "controller"
    assert rows["pd7.frb"]["description"] == "PD-type joint controller"
    assert [name for name in rows if rows[name]["changed"]] == ["pd7.frb"]
    assert workspace.findings("pd7.frb") == {"summary": "2 errors", "sound": False}
    assert workspace.findings("slide7.frb")["sound"]
    with pytest.raises(OutsideError):
        workspace.findings("link.frb")


def test_new_files_are_those_of_the_command(folder, monkeypatch):
    monkeypatch.chdir(folder.parent)
    for kind in ("pd", "single"):
        assert main(["new", "fresh", "--kind", kind, "--force"]) == 0
        answer = Workspace(folder).answer({"what": "new", "name": "fresh", "kind": kind})
        assert answer["open"] == "fresh.frb"
        assert (folder / "fresh.frb").read_text() == (folder.parent / "fresh.frb").read_text()
        (folder / "fresh.frb").unlink()


def test_copies_and_other_names_keep_what_is_not_saved(folder):
    workspace = Workspace(folder)
    workspace.text("pd7.frb").replace("# mine\n" + PD7, "me")
    assert workspace.answer({"what": "users", "file": "pd7.frb"})["users"] == ["servo.frb"]
    copied = workspace.answer({"what": "duplicate", "file": "pd7.frb", "name": "copy"})
    assert copied["open"] == "copy.frb"
    assert (folder / "copy.frb").read_text() == "# mine\n" + PD7
    for taken in ("copy.frb", "COPY.frb", "link.frb"):
        renamed = workspace.answer({"what": "rename", "file": "pd7.frb", "name": taken})
        assert "already exists" in renamed["error"] or "not a file" in renamed["error"]
    workspace.answer({"what": "rename", "file": "pd7.frb", "name": "other"})
    assert not (folder / "pd7.frb").exists()
    assert (folder / "other.frb").read_text() == PD7
    shared = workspace.text("other.frb")
    assert shared.text == "# mine\n" + PD7
    shared.save()
    assert (folder / "other.frb").read_text() == "# mine\n" + PD7
    workspace.answer({"what": "delete", "file": "copy.frb"})
    assert not (folder / "copy.frb").exists()
    assert (folder.parent / "outside.frb").read_text() == PD7


def test_with_one_file_open_nothing_stands_beside_it(folder):
    workspace = Workspace(folder / "pd7.frb")
    assert workspace.files() == ["pd7.frb"]
    for asked in (
        {"what": "new", "kind": "pd", "name": "x"},
        {"what": "duplicate", "file": "pd7.frb", "name": "x"},
        {"what": "rename", "file": "pd7.frb", "name": "x"},
        {"what": "delete", "file": "pd7.frb"},
        {"what": "delete", "file": "servo.frb"},
    ):
        assert workspace.answer(asked)["error"], asked
    assert (folder / "pd7.frb").exists()


# --- exports ---

OF_RULES = [
    (".h", {}, []),
    (".h", {"way": "rules", "precision": "float64", "name": "joint"},
     ["--direct", "--precision", "float64", "--name", "joint"]),
    (".c", {"q": "15", "levels": "e = 9, ce = -6 .. 6 step 2", "mode": "linear"},
     ["--q", "15", "--levels", "e = 9, ce = -6 .. 6 step 2", "--mode", "linear"]),
    (".st", {}, []),
    (".lut", {"tolerance": "1", "round": ""}, ["--tolerance", "1"]),
    (".csv", {"round": "0.5"}, ["--round", "0.5"]),
    (".tex", {}, []),
    (".mjs", {}, []),
]  # fmt: skip


def exported(path, suffix, options):
    return {each.name: each.content for each in
            files_of(session(path), suffix, options, lambda _: None)[0]}  # fmt: skip


def of_command(folder, monkeypatch, *words):
    """Run a command on a folder of its own; the files that it has made."""
    made = folder.parent / "made"
    made.mkdir()
    monkeypatch.chdir(folder)
    assert main([word.replace("OUT", str(made)) for word in words]) == 0
    return {each.name: each.read_bytes() for each in made.iterdir()}


@pytest.mark.slow
@pytest.mark.parametrize(("suffix", "options", "words"), OF_RULES)
def test_an_export_is_the_file_of_the_command(folder, monkeypatch, suffix, options, words):
    found = exported(folder / "pd7.frb", suffix, options)
    expected = of_command(
        folder, monkeypatch, "compile", "pd7.frb", "-o", f"OUT/pd7{suffix}", *words
    )
    assert found == expected


@pytest.mark.slow
@pytest.mark.parametrize(("suffix", "options", "words"), [
    (".h", {"way": "rules"}, []),
    (".c", {"way": "table", "levels": "9", "mode": "linear"},
     ["--table", "--levels", "9", "--mode", "linear"]),
    (".st", {}, []),
])  # fmt: skip
def test_an_exported_controller_is_the_file_of_the_command(
    folder, monkeypatch, suffix, options, words
):
    found = exported(folder / "servo.frb", suffix, options)
    words = ["compile", "servo.frb", "-o", f"OUT/servo{suffix}", *words]
    assert found == of_command(folder, monkeypatch, *words)


@pytest.mark.slow
@requires("C compiler")
def test_an_exported_unit_is_the_file_of_the_command(folder, monkeypatch):
    found = exported(folder / "servo.frb", ".fmu", {"fmi": "3"})
    words = ["compile", "servo.frb", "-o", "OUT/servo.fmu", "--fmi", "3"]
    assert found == of_command(folder, monkeypatch, *words)


@pytest.mark.slow
@pytest.mark.parametrize(("suffix", "options", "words"), [
    (".png", {"what": "terms"}, ["plot", "slide7.frb", "-o", "OUT/slide7.png", "--what", "terms"]),
    (".svg", {}, ["plot", "slide7.frb", "-o", "OUT/slide7.svg"]),
    (".fis", {}, ["convert", "slide7.frb", "OUT/slide7.fis", "-q"]),
    (".fll", {}, ["convert", "slide7.frb", "OUT/slide7.fll", "-q"]),
])  # fmt: skip
def test_pictures_and_conversions_are_the_files_of_the_commands(
    folder, monkeypatch, suffix, options, words
):
    found = exported(folder / "slide7.frb", suffix, options)
    assert found == of_command(folder, monkeypatch, *words)


def test_a_table_is_exported_as_it_is(folder, monkeypatch):
    write_table(compile_table(fuzzyarm.load(folder / "pd7.frb")), folder / "u.lut")
    for suffix in (".h", ".csv", ".tex", ".npz"):
        found = exported(folder / "u.lut", suffix, {})
        shutil.rmtree(folder.parent / "made", ignore_errors=True)
        words = ["compile", "u.lut", "-o", f"OUT/u{suffix}"]
        assert found == of_command(folder, monkeypatch, *words), suffix


def test_what_is_exported_is_the_text_as_it_is_now(folder):
    text = PD7.replace("round   0.1", "round   1")
    changed = Session(str(folder / "pd7.frb"), text)
    made = files_of(changed, ".lut", {}, lambda _: None)[0]
    (folder / "other.lut").write_bytes(made[0].content)
    assert read_table(folder / "other.lut").rounding == 1.0


def test_what_cannot_be_exported_is_refused_in_words(folder, monkeypatch):
    def refused(text, suffix, options=None):
        with pytest.raises(fuzzyarm.FuzzyarmError) as error:
            files_of(Session(str(folder / "x.frb"), text), suffix, options or {}, lambda _: None)
        assert str(folder.parent) not in str(error.value)
        return str(error.value)

    assert "mistakes: line 1" in refused("tern\n" + PD7, ".h")
    assert "not exported as .exe" in refused(PD7, ".exe")
    assert "levels 'x'" in refused(PD7, ".lut", {"levels": "x"})
    assert "exclude each other" in refused(PD7, ".lut", {"levels": "9", "tolerance": "1"})
    assert refused(PD7, ".lut", {"round": "<b>"}) == "round must be a number, not '<b>'"
    assert "mode must be bins, nearest or linear" in refused(PD7, ".h", {"mode": "cubic"})
    assert "cannot begin an identifier" in refused(PD7, ".h", {"name": "int"})
    inputs = [f"x{k}" for k in range(12)]
    wide = "rulebase wide\n" + "".join(f"input {n} 0 .. 1\n" for n in inputs) + "output y 0 .. 1\n"
    wide += f"terms {', '.join([*inputs, 'y'])}: triangles A B\n"
    wide += f"rule if {' and '.join(f'{n} is A' for n in inputs)} then y is A\n"
    assert "cells; at most" in refused(wide, ".h", {"way": "table"})
    servo = (folder / "servo.frb").read_text()
    with confined(folder):
        assert "outside the folder" in refused(servo.replace("pd7.frb", "../outside.frb"), ".h")
    # An .mjs is the same as a .js; a network has no memory.
    offered = [kind for kind in EXPORTS if kind not in {".js", ".onnx"}]
    assert kinds_of(Session("x.frb", servo)) == offered
    monkeypatch.setattr("fuzzyarm.apps.designer.exports.IN_PAGE", True)
    assert kinds_of(Session("x.frb", servo)) == [each for each in offered if each != ".fmu"]


def test_every_export_has_a_name_in_the_page_and_in_the_help():
    strings = (files("fuzzyarm.apps.designer") / "page" / "strings.js").read_text("utf-8")
    named = re.findall(r'"(\.\w+)":', strings.partition("exportKinds")[2].partition("}")[0])
    assert {*EXPORTS} - {".js"} <= {*named}
    assert [suffix for suffix in EXPORTS if suffix not in compile_command.__doc__] == []


def test_the_numbers_of_latex_are_those_of_the_table(folder):
    model = fuzzyarm.load(shipped("thermostat.frb"))
    table = compile_table(model)
    path = folder / "t.tex"
    write_table(table, path)
    rows = [line for line in path.read_text().splitlines() if line.endswith("\\\\") and "&" in line]
    rows = [line for line in rows if "backslash" not in line]
    cells = [[float(x) for x in re.findall(r"\$([^$]*)\$", row)][1:] for row in rows]
    assert np.array(cells).reshape(table.shape).tolist() == table.values.tolist()


# --- imports ---


@pytest.mark.parametrize("suffix", [".fis", ".fll", ".fcl", ".fml"])
def test_an_import_is_what_convert_writes(folder, monkeypatch, suffix, capsys):
    monkeypatch.chdir(folder)
    assert main(["convert", "pd7.frb", f"a b{suffix}", "--lossy", "-q"]) == 0
    assert main(["convert", f"a b{suffix}", "direct.frb"]) == 0
    said = capsys.readouterr().out
    found = converted_file(f"a b{suffix}", (folder / f"a b{suffix}").read_bytes())
    assert found["name"] == "a b.frb"
    # In the designer it becomes a file of the person's: it has no mark.
    assert marked("x.frb", found["text"].encode()) == (folder / "direct.frb").read_bytes()
    for finding in found["findings"]:
        assert finding.split(": ")[-1] in said


def test_tables_and_texts_of_the_language_are_imported_as_they_are(folder):
    table = compile_table(fuzzyarm.load(folder / "pd7.frb"))
    for suffix in (".csv", ".json", ".npz"):
        write_table(table, folder / f"t{suffix}")
        found = converted_file(f"t{suffix}", (folder / f"t{suffix}").read_bytes())
        (folder / found["name"]).write_text(found["text"])
        assert found["name"] == "t.lut"
        assert read_table(folder / "t.lut") == table
    assert converted_file("x/y.frb", PD7.encode()) == {
        "name": "y.frb", "text": PD7, "findings": [],
    }  # fmt: skip


def test_samples_are_put_into_the_folder_for_fit(client, folder):
    data = b"lift,pressure,flow\n1,2,3\n2,2,4.5\n"
    with socket_of(client) as socket:
        asked = {"what": "import", "name": "valve.csv", "data": base64.b64encode(data).decode()}
        socket.send_text(json.dumps({"do": "folder", "id": 7, **asked}))
        answer = heard(socket, lambda each: each["is"] == "answer")
    assert (answer["samples"], "open" in answer) == ("valve.csv", False)
    assert (folder / "valve.csv").read_bytes() == data


def test_scripts_large_files_and_other_things_are_not_imported():
    for name, data, words in (
        ("x.py", b"import os", "script is not run"),
        ("x.exe", b"MZ", "not converted"),
        ("x", b"", "not converted"),
        ("x.fis", b"[System]\n" + b" " * LARGEST_IMPORT, "at most"),
        ("x.fis", b"\0\1\2", "not a text file"),
        ("x.fll", b"nothing of the kind", "not of the form 'key: value'"),
        ("x.json", b"[]", "not a lookup table"),
        ("x.npz", b"PK\3\4", "not an archive"),
        ("x.frb", b"\xff\xfe\xfa", "not UTF-8"),
    ):
        with pytest.raises(fuzzyarm.FuzzyarmError, match=words):
            converted_file(name, data)


def test_what_is_dropped_gets_a_free_name(folder):
    workspace = Workspace(folder)
    assert workspace.put("pd7.frb", "a\n")["open"] == "pd7-2.frb"
    assert workspace.put("PD7.frb", "b\n")["open"] == "PD7-3.frb"
    assert workspace.put("link.frb", "c\n")["open"] == "link-2.frb"
    assert (folder / "pd7.frb").read_text() == PD7


# --- tables and comparison ---


def told(work, of, asked, folder):
    """Run a work to its end; everything that it has told, as one record."""
    heard = []
    record = {compare: CompareWork, table_error: TableErrorWork}[work]

    async def take(news):
        heard.append(news)

    async def run():
        job = WindowJob(1, take, Workspace(folder), Downloads())
        await job.run(work, of, read_record(record, asked))

    asyncio.run(run())
    found = {"cells": []}
    for news in heard:
        found["cells"] += news.pop("cells", [])
        found.update(json.loads(json.dumps(news)))
    return found


def test_an_error_map_has_the_axes_that_are_asked_for():
    rulebase = fuzzyarm.load(shipped("thermostat.frb"))
    table = compile_table(rulebase)
    a, b, c = table.names
    for x, y, wanted in (
        (None, None, (c, b)),
        (a, None, (a, b)),
        (a, c, (a, c)),
        (None, a, (c, a)),
    ):
        found = error_map(table, rulebase, "linear", SurfaceAxes(x=x, y=y))
        assert (found["x"], found["y"]) == wanted
        assert set(found["held"]) == {a, b, c} - set(wanted)


def test_a_table_is_shown_page_by_page(folder):
    table = compile_table(fuzzyarm.load(shipped("thermostat.frb")))
    write_table(table, folder / "t.lut")
    of = session(folder / "t.lut")
    found = table_page(of, [3])
    assert found["values"] == table.values[3].tolist()
    assert [each["levels"] for each in found["axes"]] == [list(each.levels) for each in table.axes]
    assert table_page(of, [99])["page"] == [8]
    span = cell_place(of, [3, 1, 4])
    word = of.lines[span.line - 1][span.column - 1 : span.end_column - 1]
    assert float(word) == table.values[3, 1, 4]
    assert cell_place(of, [9, 9, 9]) is None
    assert table_page(Session("x.lut", "nothing"), []) is None
    assert table_page(session(folder / "pd7.frb"), []) is None


@pytest.mark.slow
def test_every_cell_is_proved_and_no_point_of_it_is_worse(folder):
    model = fuzzyarm.load(folder / "pd7.frb")
    found = told(
        table_error, session(folder / "pd7.frb"), {"options": {"levels": "5", "mode": "linear"}},
        folder,
    )  # fmt: skip
    assert found["end"] == "done"
    table = compile_table(model, levels=5, rounding=None, mode="linear")
    cells = {(i, j): bound for i, j, bound in found["cells"]}
    assert len(cells) == 16
    assert max(cells.values()) == pytest.approx(found["worst"]["proved"], abs=1e-9)
    across = np.linspace(-6, 6, 97)
    e, ce = np.meshgrid(across, across, indexing="ij")
    error = np.abs(table.lookup(e, ce, mode="linear") - infer(model, {"e": e, "ce": ce})["u"])
    for (i, j), bound in cells.items():
        part = error[24 * i : 24 * i + 25, 24 * j : 24 * j + 25]
        assert part.max() <= bound + 1e-12
        assert bound <= part.max() + 0.1
    at = found["worst"]["at"]
    assert found["worst"]["direct"] == infer(model, at)["u"]
    assert found["worst"]["table"] == table.lookup(**at, mode="linear")
    small = found["map"]
    cells = small["panel"]["parts"][0]
    k = 7 * 121 + 30
    point = {"ce": cells["x"][30], "e": cells["y"][7]}
    there = table.lookup(**point, mode="linear") - infer(model, point)["u"]
    assert cells["values"][k] == pytest.approx(there, abs=1e-8)


def test_cells_of_one_input_are_proved_too():
    model = fuzzyarm.load(shipped("slide7.frb"))
    table = compile_table(model, "u", levels=4)
    bounds = [max(b.high, -b.low) for _, b in cell_errors(table, model, "linear")]
    assert len(bounds) == 3
    assert all(map(math.isfinite, bounds))


@pytest.mark.slow
def test_a_table_finds_its_rules_in_the_folder(folder, monkeypatch):
    monkeypatch.chdir(folder)
    assert main(["compile", "pd7.frb", "-o", "pd7.lut", "--levels", "4", "--mode", "bins"]) == 0
    found = told(table_error, session(folder / "pd7.lut"), {}, folder)
    assert found["worst"]["mode"] == "bins"
    said = dict(read_table("pd7.lut").provenance)["error-bins"]  # as compile printed it
    assert said.startswith(f"worst {outward_text(found['worst']['proved'], up=True, digits=6)} (pr")
    (folder / "pd7.frb").write_text(PD7.replace("  ZE      NB  NM", "  ZE      NM  NM"))
    found = told(table_error, session(folder / "pd7.lut"), {}, folder)
    assert "has been changed" in found["lines"][0]
    (folder / "pd7.frb").unlink()
    found = told(table_error, session(folder / "pd7.lut"), {}, folder)
    assert found["end"] == "failed"
    words = "the table says that it comes from 'pd7.frb', which is not in this folder"
    assert found["message"] == words
    outside = (folder / "pd7.lut").read_text().replace('"pd7.frb"', '"../outside.frb"')
    (folder / "pd7.lut").write_text(outside)
    assert told(table_error, session(folder / "pd7.lut"), {}, folder)["end"] == "failed"


def test_two_files_are_compared_where_both_have_values(folder):
    changed = PD7.replace("  ZE      NB  NM", "  ZE      NM  NM")
    (folder / "changed.frb").write_text(changed)
    found = told(compare, session(folder / "pd7.frb"), {"other": "changed.frb"}, folder)
    assert found["end"] == "done"
    assert found["changes"]["parts"] == [
        ["rules", [["changed", "if e is ZE and ce is NB: u is NB -> u is NM"]]],
    ]  # fmt: skip
    surfaces = [np.array(panel["parts"][0]["values"]) for panel in found["both"]]
    apart = found["difference"]["parts"][0]["values"]
    assert apart == pytest.approx(surfaces[1] - surfaces[0], abs=1e-8)
    assert found["worst"]["difference"] == pytest.approx(max(map(abs, apart)), abs=1e-8)
    at = found["largest"]["at"]
    one, two = (infer(fuzzyarm.load(folder / name), at)["u"] for name in ("pd7.frb", "changed.frb"))
    assert found["largest"]["difference"] == pytest.approx(abs(two - one), abs=1e-12)

    write_table(compile_table(fuzzyarm.load(folder / "pd7.frb")), folder / "u.lut")
    mixed = told(compare, session(folder / "pd7.frb"), {"other": "u.lut"}, folder)
    assert mixed["changes"]["mixed"]
    assert mixed["largest"]["difference"] > 0.1
    same = told(compare, session(folder / "pd7.frb"), {"other": "pd7.frb"}, folder)
    assert same["changes"]["same"]
    assert same["largest"]["difference"] == 0
    for other, words in (("slide7.frb", "no input of the same name"), ("servo.frb", "surfaces are"),
                         ("link.frb", "not a file"), ("../outside.frb", "not a file")):  # fmt: skip
        found = told(compare, session(folder / "pd7.frb"), {"other": other}, folder)
        assert words in found["message"], other


# --- through the server ---


@pytest.fixture
def client(folder):
    from starlette.testclient import TestClient

    from fuzzyarm.apps.designer.server import Designer

    app = Designer(Workspace(folder), TOKEN).app()
    with TestClient(app, base_url="http://127.0.0.1:8000") as found:
        yield found


def socket_of(client):
    headers = {"origin": "http://127.0.0.1:8000"}
    return client.websocket_connect(f"ws://127.0.0.1:8000/{TOKEN}/socket", headers=headers)


def heard(socket, wanted):
    while not wanted(message := json.loads(socket.receive_text())):
        pass
    return message


def test_a_folder_begins_with_the_first_sound_rule_base(tmp_path):
    workspace = Workspace(tmp_path / "new")
    assert (workspace.first(), workspace.files(), workspace.trouble) == ("", [], "")
    for name, text in {
        "a.lut": shipped("thesis-6.1.lut").read_text(),
        "b.frb": shipped("servo.frb").read_text(),
        "c.frb": "rulebase c\ninput\n",
        "d.frb": PD7,
    }.items():
        (tmp_path / name).write_text(text)
        expected = {"a.lut": "a.lut", "b.frb": "b.frb", "c.frb": "b.frb", "d.frb": "d.frb"}[name]
        assert Workspace(tmp_path).first() == expected
    (tmp_path / "aa.frb").write_bytes(b"\xff")
    assert Workspace(tmp_path).first() == "d.frb"


def test_a_folder_that_cannot_be_written_says_so(tmp_path, monkeypatch):
    (tmp_path / "d.frb").write_text(PD7)
    monkeypatch.setattr("fuzzyarm.apps.designer.folder.os.access", lambda *_: False)
    assert "cannot be written" in Workspace(tmp_path).listing()["trouble"]
    monkeypatch.undo()

    def refused(*_args, **_more):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refused)
    answer = Workspace(tmp_path).answer({"what": "new", "name": "e", "kind": "pd"})
    assert "Permission denied" in answer["error"]
    monkeypatch.setattr(Path, "iterdir", refused)
    assert Workspace(tmp_path).files() == []
    assert "cannot be read" in Workspace(tmp_path).trouble


def test_new_files_of_every_purpose_are_those_of_the_command(tmp_path):
    workspace = Workspace(tmp_path / "class")
    for kind in PURPOSES:
        answer = workspace.answer({"what": "new", "name": kind, "kind": kind, "around": "pd.frb"})
        assert answer["open"] == f"{kind}.frb", answer
        words = ["new", str(tmp_path / kind), "--kind", kind]
        around = ["--around", str(tmp_path / "class" / "pd.frb")] if kind == "controller" else []
        assert main([*words, *around]) == 0
        written = (tmp_path / f"{kind}.frb").read_text().replace("class/pd.frb", "pd.frb")
        assert (tmp_path / "class" / f"{kind}.frb").read_text() == written
    asked = {"what": "new", "name": "c", "kind": "controller", "around": "blank.frb"}
    answer = workspace.answer(asked)
    assert "has mistakes" in answer["error"]
    assert "error" in workspace.answer({"what": "new", "name": "c", "kind": "nonsense"})


def test_a_new_file_concludes_sets_or_values_as_the_command_does(tmp_path):
    workspace = Workspace(tmp_path / "class")
    workspace.answer({"what": "new", "name": "s", "kind": "pd", "method": "sugeno"})
    assert main(["new", str(tmp_path / "s"), "--kind", "pd", "--sugeno"]) == 0
    written = (tmp_path / "s.frb").read_text()
    assert (tmp_path / "class" / "s.frb").read_text() == written
    assert "defuzzifier weighted-average" in written
    assert main(["new", str(tmp_path / "c"), "--kind", "controller", "--sugeno"]) == 1


def test_examples_come_with_what_they_use_and_replace_nothing(tmp_path):
    for name, words in Workspace(tmp_path).answer({"what": "list"})["examples"].items():
        folder = tmp_path / f"of {name}"
        answer = Workspace(folder).answer({"what": "new", "name": f"my-{name}", "kind": name})
        assert answer["open"] == f"my-{name}"
        assert words
        made = {path.name: path.read_text() for path in folder.iterdir()}
        assert made.pop(f"my-{name}") == shipped(name).read_text()
        assert all(text == shipped(used).read_text() for used, text in made.items())
        assert main(["check", *map(str, folder.iterdir())]) == 0
    (tmp_path / "pd7.frb").write_text("# mine\n")
    Workspace(tmp_path).answer({"what": "new", "name": "servo", "kind": "servo.frb"})
    assert (tmp_path / "pd7.frb").read_text() == "# mine\n"


def test_the_samples_of_the_lesson_are_written_where_none_are(tmp_path, monkeypatch):
    page = Path(__file__).parents[2] / "docs/tutorial/8-learn-it-from-data.md"
    code = re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)[0]
    lesson, mine = tmp_path / "lesson", tmp_path / "mine"
    lesson.mkdir()
    monkeypatch.chdir(lesson)
    exec(code, {})
    mine.mkdir()
    (mine / "later.csv").write_text("a,b\n")
    Workspace(mine).answer({"what": "samples"})
    assert (mine / "valve.csv").read_bytes() == (lesson / "valve.csv").read_bytes()
    assert (mine / "later.csv").read_text() == "a,b\n"


def test_the_shipped_folder_opens_its_plain_rule_base():
    workspace = Workspace(shipped_folder())
    assert workspace.first() == "pd7.frb"
    assert not [name for name in workspace.files() if "as-described" in name]
    assert fuzzyarm.load(shipped("stfc-as-described.frb"))


def test_foreign_rule_bases_are_offered_and_nothing_else(tmp_path):
    (tmp_path / "a.fis").write_text("[System]\n")
    (tmp_path / "b.xml").write_text("<?xml version='1.0'?><project/>")
    (tmp_path / "c.xml").write_text("<?xml version='1.0'?><FuzzyController/>")
    (tmp_path / "d.csv").write_text("1,2\n")
    workspace = Workspace(tmp_path)
    assert workspace.foreign() == ["a.fis", "c.xml"]
    with pytest.raises(OutsideError):
        workspace.foreign_data("../a.fis")
    assert Workspace(tmp_path / "a.fis").foreign() == []


def test_an_export_is_loaded_by_an_address_with_the_token(client, folder):
    name = "a 'b'é.frb"
    (folder / name).write_text(PD7)
    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": name}))
        start = {"do": "start", "file": name, "what": "export", "id": 1, "suffix": ".csv"}
        start["options"] = {}
        socket.send_text(json.dumps(start))
        (file,) = heard(socket, lambda each: "files" in each)["files"]
        start = {**start, "id": 2, "suffix": ".exe"}
        socket.send_text(json.dumps(start))
        assert "not exported" in heard(socket, lambda each: each.get("id") == 2)["message"]
    assert client.get(f"/{'c' * 32}/{file['href']}").status_code == 403
    assert client.get(f"/{TOKEN}/download/none/{file['name']}").status_code == 404
    found = client.get(f"/{TOKEN}/{file['href']}")
    assert found.status_code == 200
    assert found.content == exported(folder / name, ".csv", {})[file["name"]]
    said = found.headers["content-disposition"]
    assert said == """attachment; filename="a 'b'_.csv"; filename*=UTF-8''a%20%27b%27%C3%A9.csv"""
    assert found.headers["content-type"] == "application/octet-stream"
    assert found.headers["x-content-type-options"] == "nosniff"


def test_files_are_dropped_and_windows_hear_of_other_names(client, folder):
    def ask(socket, **asked):
        socket.send_text(json.dumps({"do": "folder", "id": 7, **asked}))
        return heard(socket, lambda each: each["is"] == "answer")

    def drop(socket, name, data):
        return ask(socket, what="import", name=name, data=base64.b64encode(data).decode())

    fis = exported(folder / "slide7.frb", ".fis", {})["slide7.fis"]
    with socket_of(client) as socket, socket_of(client) as other:
        for each in (socket, other):
            each.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        answer = drop(socket, "../slide7.fis", fis)
        assert answer["open"] == "slide7-2.frb"
        assert fuzzyarm.load(folder / "slide7-2.frb").inputs[0].name == "s"
        assert "not run" in drop(socket, "x.py", b"import os")["error"]
        assert "at most" in drop(socket, "x.fis", b" " * 10_000_000)["error"]
        assert "not understood" in ask(socket, what="import", name="x.fis", data="<b>")["error"]
        assert "error" in ask(socket, what="nothing")
        assert "error" in ask(socket, what="findings", file="../outside.frb")
        ask(socket, what="rename", file="pd7.frb", name="new.frb")
        moved = heard(other, lambda each: each["is"] == "moved")
        assert (moved["file"], moved["to"]) == ("pd7.frb", "new.frb")
        ask(socket, what="delete", file="new.frb")
        moved = heard(other, lambda each: each["is"] == "moved")
        assert (moved["file"], moved["to"]) == ("new.frb", "")
    assert sorted(each.name for each in folder.iterdir()) == [
        "link.frb", "servo.frb", "slide7-2.frb", "slide7.frb",
    ]  # fmt: skip


@pytest.mark.slow
def test_a_page_says_what_it_was_opened_for(folder):
    from starlette.testclient import TestClient

    from fuzzyarm.apps.designer.server import Designer

    app = Designer(Workspace(folder / "pd7.frb"), TOKEN).app()
    with TestClient(app, base_url="http://127.0.0.1:8000") as client:
        assert '"only": true' in client.get(f"/{TOKEN}/").text.replace('":true', '": true')
        with socket_of(client) as socket:
            data = base64.b64encode((folder / "slide7.frb").read_bytes()).decode()
            asked = {"do": "folder", "id": 1, "what": "import", "name": "s.frb", "data": data}
            socket.send_text(json.dumps(asked))
            answer = heard(socket, lambda each: each["is"] == "answer")
    assert answer["only"]
    assert answer["text"] == (folder / "slide7.frb").read_text()
    assert not (folder / "s.frb").exists()


@pytest.mark.parametrize("file", ["../outside.frb", "link.frb", "{parent}/outside.frb"])
def test_a_controller_uses_no_file_outside_the_folder(client, folder, file):
    text = (folder / "servo.frb").read_text()
    named = file.format(parent=folder.parent)
    (folder / "servo.frb").write_text(text.replace('"pd7.frb"', f'"{named}"'))
    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "servo.frb"}))
        found = heard(socket, lambda each: each["is"] == "findings")["findings"]
        reason = f"cannot read '{named}': it is outside the folder that is open"
        assert [each["message"] for each in found] == [reason]
        works = {"plants": {}, "run": {"form": {"plant": "motor"}}, "learn": {}, "tune": {},
                 "export": {"suffix": ".h"}, "compare": {"other": "pd7.frb"}}  # fmt: skip
        for what, more in works.items():
            start = {"do": "start", "file": "servo.frb", "what": what, "id": 3}
            socket.send_text(json.dumps({**start, **more}))
            end = heard(socket, lambda each: "end" in each)
            assert end["end"] == "failed", what
            assert reason in end["message"], what


def test_a_circle_of_links_is_no_file_of_the_folder(folder):
    (folder / "a.frb").symlink_to(folder / "b.frb")
    (folder / "b.frb").symlink_to(folder / "a.frb")
    workspace = Workspace(folder)
    assert "a.frb" not in workspace.files()
    for asked in (
        {"what": "rename", "file": "a.frb", "name": "y.frb"},
        {"what": "duplicate", "file": "a.frb", "name": "y.frb"},
        {"what": "delete", "file": "a.frb"},
        {"what": "duplicate", "file": "pd7.frb", "name": "a.frb"},
    ):
        error = workspace.answer(asked).get("error", "")
        assert error, asked
        assert str(folder) not in error
    with pytest.raises(OutsideError):
        workspace.text("a.frb")
    assert workspace.beside("a.frb", ".frb").name == "a.frb"
