"""What the site is built from: pages written from the program, and the list of all pages."""

import fnmatch
import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest
from needs import need

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def scripts():
    """The scripts of the pages, as modules."""
    sys.path[:0] = [str(DOCS), str(ROOT / "tools")]
    try:
        names = ("make_reference", "make_gallery", "highlighting")
        yield {name: importlib.import_module(name) for name in names}
    finally:
        del sys.path[:2]


@pytest.mark.parametrize(
    ("page", "script", "function"),
    [
        ("reference/commands.md", "make_reference", "commands_page"),
        ("reference/metrics.md", "make_reference", "metrics_page"),
        ("reference/formats.md", "make_reference", "formats_page"),
        ("reference/api.md", "make_reference", "api_index"),
        ("tutorial/gallery.md", "make_gallery", "gallery_page"),
    ],
)
def test_a_written_page_is_that_of_today(page, script, function, scripts, update_golden):
    text = getattr(scripts[script], function)()
    if update_golden:
        (DOCS / page).write_text(text, "utf-8")
    assert (DOCS / page).read_text("utf-8") == text


def test_the_page_of_commands_has_every_option(scripts):
    from fuzzyarm.apps.cli.main import COMMANDS, find_command

    text = scripts["make_reference"].commands_page()
    sections = dict(
        zip(re.findall(r"(?m)^### (\S+)$", text), re.split(r"(?m)^### \S+$", text)[1:], strict=True)
    )
    assert list(sections) == list(COMMANDS)
    for name, section in sections.items():
        for argument in find_command(name).arguments:
            if argument.names[0].startswith("-"):
                assert all(f"`{option}" in section for option in argument.names), (name, argument)


def test_the_python_api_has_every_name_and_package_once(scripts):
    import fuzzyarm

    reference = scripts["make_reference"]
    named = [name for names in reference.names_by_purpose().values() for name, _ in names]
    assert sorted(named) == sorted(fuzzyarm.__all__)
    packages = [name for group in reference.PURPOSES.values() for name in group]
    assert sorted(packages) == sorted(reference.public_packages())


def globs(page):
    """Return the patterns of the tables of contents of a page."""
    found = re.findall(r"(?ms)^```\{toctree\}\n(.*?)^```", page.read_text("utf-8"))
    lines = [line for body in found for line in body.splitlines() if line and line[0] != ":"]
    folder = page.parent.relative_to(DOCS)
    return [str(folder / line) for line in lines]


def test_every_page_is_in_a_table_of_contents():
    pages = [path.relative_to(DOCS).with_suffix("") for path in DOCS.rglob("*.md")]
    listed = [line for page in DOCS.rglob("*.md") for line in globs(page)]
    lost = [str(page) for page in pages if not any(fnmatch.fnmatch(str(page), x) for x in listed)]
    assert lost == ["index"]


def test_a_page_of_the_api_tells_every_name_once(scripts):
    told = {}
    for package in ("fuzzyarm", "fuzzyarm.inference", "fuzzyarm.table"):
        module = importlib.import_module(package)
        text = scripts["make_reference"].api_page(module, told)
        here = re.findall(rf"(?m)^\.\. auto\w+:: {re.escape(package)}\.(\w+)$", text)
        elsewhere = re.findall(r"``(\w+)`` \(:doc:", text)
        modules = [name for name in module.__all__ if inspect.ismodule(getattr(module, name))]
        assert sorted([*here, *elsewhere, *modules]) == sorted(module.__all__)
        assert ("infer" in elsewhere) == (package == "fuzzyarm.inference")


@pytest.mark.parametrize("text", ["", "rulebase x\r\n\ninput e 0 .. 1 # so\nrule if", "\x00\n'"])
def test_colours_leave_the_text_as_it_is(text, scripts):
    pieces = scripts["highlighting"].RuleBaseLexer().get_tokens_unprocessed(text)
    assert "".join(piece for _, _, piece in pieces) == text


def test_rule_bases_and_tables_are_coloured_as_in_an_editor(scripts):
    from pygments.token import Keyword, Name

    highlighting = scripts["highlighting"]
    text = (ROOT / "rulebases" / "pd7.frb").read_text("utf-8")
    words = {
        piece: kind for _, kind, piece in highlighting.RuleBaseLexer().get_tokens_unprocessed(text)
    }
    assert (words["rulebase"], words["e"], words["NB"]) == (Keyword, Name.Variable, Name.Constant)
    table = (ROOT / "rulebases" / "thesis-6.1.lut").read_text("utf-8")
    pieces = list(highlighting.LutLexer().get_tokens_unprocessed(table))
    assert "".join(piece for _, _, piece in pieces) == table
    assert (Keyword, "levels") in {(kind, piece) for _, kind, piece in pieces}


def test_the_sketch_of_the_arduino_page_compiles(tmp_path):
    """With the names that the board's core has, and every warning on."""
    need("g++")
    from fuzzyarm.apps.cli import main

    page = (DOCS / "howto" / "arduino.md").read_text("utf-8")
    for text in re.findall(r"(?ms)^```frb\n(.*?)^```", page):
        (tmp_path / re.match(r"# (\S+)", text).group(1)).write_text(text, "utf-8")
    words = "--table --levels 9 --q 7 --precision float32"
    out = str(tmp_path / "turn.h")
    assert main(["compile", str(tmp_path / "turn.frb"), "-o", out, *words.split()]) == 0
    core = (
        "#include <math.h>\nconst int A0 = 0, OUTPUT = 1, HIGH = 1, LOW = 0;\n"
        "void pinMode(int, int); void digitalWrite(int, int); void analogWrite(int, int);\n"
        "int analogRead(int); unsigned long micros();\n"
    )
    sketch = re.search(r"(?ms)^```cpp\n(.*?)^```", page).group(1)
    (tmp_path / "sketch.cpp").write_text(core + sketch, "utf-8")
    done = subprocess.run(
        ["g++", "-std=c++11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "sketch.cpp"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


SOURCES = (ROOT, ROOT / "src", ROOT / "src/fuzzyarm", ROOT / "tests", DOCS)


@pytest.mark.parametrize(
    "page", ["README.md", "CONTRIBUTING.md", "docs/explanation/architecture.md"]
)
def test_modules_that_a_page_names_exist(page):
    text = (ROOT / page).read_text("utf-8")
    rooms = [folder for base in SOURCES for folder in (base, *base.glob("*/"))]
    named = re.findall(r"`([\w/]+\.py)`", text)
    lost = [name for name in named if not any((room / name).is_file() for room in rooms)]
    inside = [path.name for path in (ROOT / "src").rglob("*.py")]
    assert [name for name in lost if "/" in name or name not in inside] == []
