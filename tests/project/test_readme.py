"""The README and the pages are followed literally: every command and every block of Python."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
COMMAND = Path(sys.executable).parent / "fuzzyarm"


def blocks(page, kind):
    text = page.read_text()
    found = re.findall(rf"(?ms)^( *)```{kind}\n(.*?)^ *```", text)
    return [re.sub(rf"(?m)^{indent}", "", body) for indent, body in found]


def console_steps(block):
    """Yield (command, expected output) of a console block."""
    for part in re.split(r"(?m)^\$ ", block)[1:]:
        command, _, expected = part.partition("\n")
        yield command, expected


def matches(expected, actual):
    """Whether `actual` is what the page shows; a line of dots stands for any lines."""
    pattern = re.escape(expected.strip()).replace(r"\.\.\.", ".*")
    return re.fullmatch(pattern, actual.strip(), re.DOTALL) is not None


def write_files(page, folder):
    """Write the blocks that begin with the name of a file, as in ``# mine.py``."""
    for text in (*blocks(page, "frb"), *blocks(page, "python")):
        named = re.match(r"# ([\w-]+\.(?:frb|py))\n", text)
        if named is not None:
            (folder / named.group(1)).write_text(text)


@pytest.fixture
def workplace(tmp_path):
    shutil.copytree(ROOT / "rulebases", tmp_path / "rulebases")
    shutil.copytree(ROOT / "examples" / "controllers", tmp_path / "examples" / "controllers")
    for text in blocks(ROOT / "README.md", "frb"):
        name = re.match(r"rulebase (\w+)", text).group(1)
        (tmp_path / f"{name}.frb").write_text(text)
    return tmp_path


def run(command, cwd):
    words = shlex.split(command)
    assert words[0] == "fuzzyarm", command
    environment = {**os.environ, "COLUMNS": "80", "NO_COLOR": "1"}
    return subprocess.run(
        [str(COMMAND), *words[1:]],
        cwd=cwd, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_console_command_does_what_the_page_shows(page, workplace):
    write_files(page, workplace)
    for block in blocks(page, "console"):
        for command, expected in console_steps(block):
            if command.startswith("make "):
                assert re.search(rf"(?m)^{command.split()[1]}:", (ROOT / "Makefile").read_text())
                continue
            done = run(command, workplace)
            assert done.returncode == 0, (command, done.stderr)
            assert matches(expected, done.stdout), (command, expected, done.stdout)


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_python_runs(page, workplace):
    write_files(page, workplace)
    for block in blocks(page, "python"):
        if any(find_spec(name) is None for name in re.findall(r"(?m)^import (\w+)", block)):
            continue  # an extra that is not installed
        done = subprocess.run(
            [sys.executable, "-c", block],
            cwd=workplace, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, (block, done.stderr)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_and_picture_exists(page):
    for target in re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", page.read_text()):
        if "://" not in target:
            assert (page.parent / target).exists(), target


def test_the_rule_base_of_the_readme_means_what_is_shipped():
    from fuzzyarm.language import load_rulebase, parse

    shown = parse(next(t for t in blocks(ROOT / "README.md", "frb") if "pd7" in t)).rulebase
    assert shown == load_rulebase(ROOT / "rulebases" / "pd7.frb")
