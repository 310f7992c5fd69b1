"""Texts and file names of users in exported files: whatever they hold, each file is read."""

from __future__ import annotations

import ast
import io
import re
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
from c_programs import HOST
from own_tests import LANGUAGES, failing
from st_programs import Program

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.base.names import quote

NASTY = (
    "one\nimport os\r\nraise SystemExit\u2028x()\x85y()",
    "nul \x00 bell \x07 escape \x1b[2J",
    "*/ int evil; /* ]]> <!-- (* *) ??/",
    "\"quotes\" 'both' \\ back\\",
    "non-BMP \U0001f600 \ufffe \uffff",
)

PROPERTIES = [
    "name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url",
    "architectures", "includes",
]  # fmt: skip


def written(text: str, kind: str, folder: Path) -> Path:
    """Write a shipped file with another description, under a name that breaks lines."""
    base = shipped("pd7.frb" if kind == "rules" else "servo.frb")
    lines = Path(base).read_text("utf-8").splitlines()
    word = "rulebase" if kind == "rules" else "controller"
    at = next(i for i, line in enumerate(lines) if line.startswith(f"{word} "))
    lines[at] = f"{word} {lines[at].split()[1]} {quote(text, chr(34))}"
    (folder / "pd7.frb").write_bytes(Path(base).with_name("pd7.frb").read_bytes())
    path = folder / "file\nimport os  # x.frb"
    path.write_text("\n".join([*lines, ""]), "utf-8")
    return path


@pytest.mark.slow
@pytest.mark.parametrize("text", NASTY)
@pytest.mark.parametrize("kind", ["rules", "controller"])
def test_every_target_reads_what_was_written(tmp_path, monkeypatch, text, kind):
    monkeypatch.chdir(tmp_path)
    path = str(written(text, kind, tmp_path))
    for out in ("x.py", "x.st", "x.xml", "x.scl", "x.c"):
        assert main(["compile", path, "-o", out]) == 0, out
        found = Path(out).read_text("utf-8")
        assert not set(found) & {"\x00", "\x07", "\x1b", "\x85", "\u2028"}, out
    tree = ast.parse(Path("x.py").read_text("utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import)
                for alias in node.names}  # fmt: skip
    assert imported <= {"math"}
    Program(Path("x.st").read_text("utf-8"))
    Xml.parse("x.xml")
    command = [HOST, "-std=c99", "-Wall", "-Werror", "-fsyntax-only", "x.c"]
    assert subprocess.run(command, check=False).returncode == 0
    if kind == "controller":
        assert main(["compile", path, "-o", "x.fmu"]) == 0
        with zipfile.ZipFile(io.BytesIO(Path("x.fmu").read_bytes())) as archive:
            Xml.fromstring(archive.read("modelDescription.xml"))
    for suffix in LANGUAGES:
        assert main(["compile", path, "-o", f"x{suffix}"]) == 0
        assert failing([tmp_path / f"x{suffix}"], tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("text", NASTY)
@pytest.mark.parametrize("kind", ["rules", "controller"])
def test_a_folder_for_a_board_says_what_was_written(tmp_path, monkeypatch, text, kind):
    monkeypatch.chdir(tmp_path)
    path = str(written(text, kind, tmp_path))
    assert main(["compile", path, "--for", "arduino", "--board", "esp32", "-o", "x"]) == 0
    for file in (file for file in Path("x").rglob("*") if file.is_file()):
        assert all(c.isprintable() or c in "\n\t" for c in file.read_text("utf-8")), file
    properties = Path("x/library.properties").read_text("utf-8").splitlines()
    assert [line.split("=")[0] for line in properties] == PROPERTIES
    readme = Path("x/README.md").read_text("utf-8")
    assert not re.search(r"(?<!\\)<[a-zA-Z!/?]", readme)
