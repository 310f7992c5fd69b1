"""Lessons as notebooks and marimo files: made from the pages, and executed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import types
from pathlib import Path

import make_lessons
import nbformat
import pytest
from budget import part

PAGES = make_lessons.PAGES
CHEAP = [page for page in PAGES if page.stem[:2] in {"1-", "2-", "3-"}]


def code_of(page: Path) -> str:
    """Return the code cells of a notebook, as one program."""
    made = json.loads(make_lessons.notebook(page))
    return "\n".join(
        "".join(cell["source"]) for cell in made["cells"] if cell["cell_type"] == "code"
    )


def execute(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    (folder / "lesson_program.py").write_text(code, "utf-8")
    environment = {**os.environ, "COLUMNS": "80", "NO_COLOR": "1", "MPLBACKEND": "agg"}
    words = [sys.executable, "lesson_program.py"]
    return subprocess.run(
        words, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=300
    )


def expected_endings(page: Path) -> int:
    """Return how many commands of a page end with a status, as it says."""
    return page.read_text("utf-8").count("# exit status")


@pytest.mark.slow
@pytest.mark.parametrize("page", part(PAGES, 5), ids=lambda page: page.stem)
def test_a_notebook_runs_from_an_empty_folder(page, tmp_path):
    done = execute(code_of(page), tmp_path)
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.count("(exit status ") == expected_endings(page), done.stdout[-2000:]


class App:
    """Stands in for marimo: cells run in their order, with the names that they ask for."""

    def __init__(self) -> None:
        self.names: dict[str, object] = {}

    def cell(self, function=None, **options):
        def take(given):
            code = given.__code__
            wanted = code.co_varnames[: code.co_argcount]
            returned = given(*(self.names[name] for name in wanted)) or ()
            self.names.update(zip(self.gives(given), returned, strict=False))
            return given

        return take if function is None else take(function)

    @staticmethod
    def gives(function) -> list[str]:
        import inspect

        last = inspect.getsource(function).rstrip().splitlines()[-1].strip()
        return [
            name.strip() for name in last.removeprefix("return").strip(" ()").split(",") if name
        ]

    def run(self) -> None:
        pass


def test_a_marimo_file_runs_cell_by_cell(tmp_path, monkeypatch, capsys):
    page = next(page for page in PAGES if page.stem == "2-a-first-file")
    said: list[str] = []
    stand_in = types.ModuleType("marimo")
    stand_in.App, stand_in.md = App, said.append
    monkeypatch.setitem(sys.modules, "marimo", stand_in)
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "lesson.py"
    path.write_text(make_lessons.marimo(page), "utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    __import__("lesson")
    del sys.modules["lesson"]
    assert "room.frb: written" in capsys.readouterr().out
    assert (tmp_path / "room.frb").read_text("utf-8").startswith("# room.frb\nrulebase room")
    assert said[0].startswith("# 2. A first file")


def test_every_lesson_is_a_sound_notebook_and_sound_python():
    for page in PAGES:
        nbformat.validate(nbformat.reads(make_lessons.notebook(page), as_version=4))
        compile(code_of(page), page.stem, "exec")
        compile(make_lessons.marimo(page), page.stem, "exec")


def test_files_and_prose_of_a_page_are_in_its_lesson():
    for page in CHEAP:
        listed = list(make_lessons.cells(page))
        text = page.read_text("utf-8")
        heads = [line for line in text.splitlines() if line.startswith("## ")]
        prose = "\n".join(cell.body for cell in listed if cell.kind == "text")
        assert all(head in prose for head in heads)
        assert "](" not in prose.replace("](http", "")


@pytest.mark.parametrize("body", ["plain\n", "back\\slash\n", "three ''' quotes \\\n"])
def test_a_file_is_written_as_it_stands(body):
    assert eval(make_lessons.quoted(body)) == body


def test_without_fuzzyarm_a_lesson_says_so_in_a_sentence(tmp_path):
    code = "import sys\nsys.modules['fuzzyarm'] = None\n" + make_lessons.PREPARE
    done = execute(code, tmp_path)
    assert done.returncode == 1
    assert done.stderr == "fuzzyarm is not installed here: pip install fuzzyarm\n"


def test_the_script_names_the_pages_that_there_are(tmp_path, capsys):
    assert make_lessons.main([str(tmp_path / "out"), "nowhere"]) == 1
    assert capsys.readouterr().err.startswith("no such page: nowhere; there are 1-what-a-rule-is")
    assert not (tmp_path / "out").exists()
    assert make_lessons.main([str(tmp_path / "out"), "4-a-table"]) == 0
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"4-a-table.ipynb", "4_a_table.py"}
