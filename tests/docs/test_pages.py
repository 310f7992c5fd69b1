"""The README and the pages are followed literally: every command and every block of Python.

``pytest tests/docs --update-golden`` writes what the program prints today into the pages.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest
from needs import need

from fuzzyarm.apps.cli.main import COMMANDS, find_command

ROOT = Path(__file__).parents[2]
README, LANDING = ROOT / "README.md", ROOT / "docs" / "index.md"
PAGES = [README, *sorted((ROOT / "docs").rglob("*.md"))]
ELSEWHERE = {
    "from-fuzzylite.md": "formats/test_coming_pages.py",
    "from-matlab.md": "formats/test_coming_pages.py",
    "from-scikit-fuzzy.md": "formats/test_coming_pages.py",
    "from-pyit2fls.md": "formats/test_coming_pages.py",
    "from-simpful.md": "formats/test_coming_pages.py",
    "proofs.md": "proof/test_proofs_page.py",
    "python.md": "python/test_python_page.py",
    "type2.md": "inference/test_type2_page.py",
}
"""Pages whose blocks go on from one another or need files of their own, and what runs them."""

NEEDED = {"safety-case.md": ("gcov",)}
"""Tools that the commands of a page call."""

IN_A_CLONE = ("source .venv/", ".venv/bin/")
"""How commands of the README begin that only a clone with its environment knows."""

RUNNER = Path(__file__).with_name("run_page.py")

FENCE = re.compile(r"(?ms)^(?P<indent> *)```(?P<kind>\w+)\n(?P<body>.*?)^ *```")
NAMED = re.compile(r"(?:#|//|/\*) ?([\w./-]+\.(?:frb|py|csv|lut))(?: \*/)?\n")
STATUS = re.compile(r"\s+# exit status (\d+)$")


class Step(NamedTuple):
    """A block, or one command of a console block: what is run and what the page shows."""

    kind: str
    text: str
    path: str = ""
    expected: str = ""
    status: int = 0
    indent: str = ""


def page_id(page):
    return str(page.relative_to(ROOT))


def blocks(page, kind):
    return [body for _, found, body in all_blocks(page.read_text("utf-8")) if found == kind]


def all_blocks(text):
    """Yield (indentation, kind, body without it) of the blocks of a page."""
    for match in FENCE.finditer(text):
        indent = match["indent"]
        yield indent, match["kind"], re.sub(rf"(?m)^{indent}", "", match["body"])


def console_steps(body, indent=""):
    """Yield the commands of a console block, each with the output that it shows."""
    for part in re.split(r"(?m)^\$ ", body)[1:]:
        command, _, expected = part.partition("\n")
        status = STATUS.search(command)
        wanted = int(status[1]) if status else 0
        yield Step("command", STATUS.sub("", command), "", expected, wanted, indent)


def steps_of(page):
    """Return the steps of a page; the files that it names are there from the beginning."""
    steps = []
    for indent, kind, body in all_blocks(page.read_text("utf-8")):
        named = NAMED.match(body)
        if kind == "console":
            steps += console_steps(body, indent)
        elif named and kind in {"frb", "python", "csv", "lut"}:
            steps.append(Step("file", body, named[1]))
        elif kind == "python":
            steps.append(Step("python", body))
        elif kind == "yaml":
            lines = re.findall(r"(?m)^ *- run: (fuzzyarm .*)$", body)
            steps += [Step("command", line, expected="...") for line in lines]
        elif kind == "pycon":
            steps.append(Step("session", body))
    files = {step.path: step for step in reversed(steps) if step.kind == "file"}
    return [*files.values(), *steps]


def matches(expected, actual):
    """Whether `actual` is what the page shows; three dots stand for anything."""
    expected, actual = (re.sub(r"(?m) +$", "", text.strip()) for text in (expected, actual))
    pattern = re.escape(expected).replace(r"\.\.\.", ".*")
    return re.fullmatch(pattern, actual, re.DOTALL) is not None


@pytest.fixture
def workplace(tmp_path):
    shutil.copytree(ROOT / "rulebases", tmp_path / "rulebases")
    for folder in ("controllers", "closed_loop", "assignments", "robots"):
        shutil.copytree(ROOT / "examples" / folder, tmp_path / "examples" / folder)
    for text in blocks(ROOT / "README.md", "frb"):
        name = re.match(r"rulebase (\w+)", text).group(1)
        (tmp_path / f"{name}.frb").write_text(text, "utf-8")
    return tmp_path


@pytest.fixture(scope="module")
def runner(tmp_path_factory):
    """What runs pages, and the file of what they say past the streams of Python."""
    environment = {**os.environ, "COLUMNS": "80", "NO_COLOR": "1"}
    said = tmp_path_factory.mktemp("pages") / "said.txt"
    with said.open("w", encoding="utf-8") as errors:
        process = subprocess.Popen(
            [sys.executable, str(RUNNER)], env=environment, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors,
        )  # fmt: skip
        yield process, said
        process.communicate()


def run_all(runner, steps, folder, target):
    """Return (status, output, errors, seconds) of each step."""
    process, said = runner
    process.stdin.write(json.dumps([[step[:3] for step in steps], str(folder), str(target)]) + "\n")
    process.stdin.flush()
    assert process.stdout.readline() == "0\n", said.read_text("utf-8")
    return json.loads(target.read_text("utf-8"))


def faults(steps, results):
    """Yield the steps that did not do what the page shows, and what they printed."""
    for step, (status, out, err, _) in zip(steps, results, strict=True):
        shown = out + err if step.status else out
        if status != step.status:
            yield step, f"exit status {status}\n{err}"
        elif step.kind == "command" and not matches(step.expected, shown):
            yield step, shown


@pytest.mark.slow
def test_pages_that_are_run_elsewhere_are():
    for page, test in ELSEWHERE.items():
        assert page.removeprefix("from-").removesuffix(".md") in (ROOT / "tests" / test).read_text(
            "utf-8"
        )


@pytest.mark.parametrize("page", [p for p in PAGES if p.name not in ELSEWHERE], ids=page_id)
def test_every_block_does_what_the_page_shows(page, workplace, runner, update_golden):
    need(*NEEDED.get(page.name, ()))
    steps = steps_of(page)
    targets = re.findall(r"(?m)^(\w+):", (ROOT / "Makefile").read_text("utf-8"))
    made = [step for step in steps if step.text.startswith("make ")]
    assert all(step.text.split()[1] in targets for step in made)
    if page in (README, LANDING):  # test_readme.py types these in a clone
        made += [step for step in steps if step.text.startswith(IN_A_CLONE)]
    steps = [step for step in steps if step not in made]
    assert all(step.text.startswith("fuzzyarm ") for step in steps if step.kind == "command")
    if all(step.kind == "file" for step in steps):
        return
    results = run_all(runner, steps, workplace, workplace.with_suffix(".json"))
    if os.environ.get("PAGE_TIMES"):
        for step, result in zip(steps, results, strict=True):
            sys.stderr.write(f"{result[-1]:8.2f} s  {step.text.splitlines()[0]}\n")
    found = list(faults(steps, results))
    if update_golden:
        found = [fault for fault in found if not updated(page, *fault)]
    for step, shown in found:
        pytest.fail(f"{page_id(page)}: {step.text}\n--- the page ---\n{step.expected}"
                    f"--- the program ---\n{shown}")  # fmt: skip


def updated(page, step, shown):
    """Write what the program prints into the page; False where a person has to."""
    if step.kind != "command" or shown.startswith("exit status"):
        return False
    lines = shown.strip().splitlines()
    expected = step.expected.strip().splitlines()
    if "..." in step.expected:
        # Lines at the beginning, then dots: as many lines of what is printed today.
        if any("..." in line for line in expected[:-1]) or expected[-1] != "...":
            return False
        lines = [*lines[: len(expected) - 1], "..."]
    before, after = (
        "".join(f"{step.indent}{line}".rstrip() + "\n" for line in part)
        for part in (expected, lines)
    )
    text = page.read_text("utf-8")
    command = re.escape(f"{step.indent}$ {step.text}") + r"(?: +# exit status \d+)?\n"
    new = re.sub(f"({command}){re.escape(before)}", lambda found: found[1] + after, text, count=1)
    page.write_text(new, "utf-8")
    return new != text


def mentioned(page):
    """Yield the words of each command that a page mentions, in a block or within a line."""
    text = page.read_text("utf-8")
    lines = re.findall(r"(?m)(?:^ {4,}|`)(fuzzyarm [a-z][^`\n]*)", text)
    for _, _, body in all_blocks(text):
        lines += re.findall(r"(?m)^(?:\$ |.*run: )?(fuzzyarm [a-z].*)", body)
    for line in lines:
        yield re.split(r" +#| {3,}", line)[0].split()


@cache
def options_of(command):
    parser = argparse.ArgumentParser()
    find_command(command).add_to(parser)
    return set(parser._option_string_actions)


def unknown(words):
    """Return what of a command line is neither a command nor one of its options."""
    _, command, *others = words
    if command not in COMMANDS:
        return {command}
    options = {word.partition("=")[0] for word in others if re.match("--[a-z]", word)}
    return options - options_of(command)


def test_every_command_that_is_mentioned_has_its_options():
    lines = [(page_id(page), words) for page in PAGES for words in mentioned(page)]
    assert len(lines) > 2 * len(PAGES)
    assert [(page, words, unknown(words)) for page, words in lines if unknown(words)] == []
    assert unknown(["fuzzyarm", "chek"]) == {"chek"}
    assert unknown(["fuzzyarm", "check", "--loud"]) == {"--loud"}


def test_every_link_and_picture_exists():
    links = [
        (page, target)
        for page in PAGES
        for target in re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", page.read_text("utf-8"))
        if "://" not in target
    ]
    assert len(links) > len(PAGES)
    assert [
        (page_id(page), target) for page, target in links if not (page.parent / target).exists()
    ] == []


@pytest.fixture(scope="module")
def pd7_of_the_readme():
    return next(text for text in blocks(ROOT / "README.md", "frb") if "pd7" in text)


def test_the_landing_page_begins_as_the_readme_does(pd7_of_the_readme):
    assert blocks(LANDING, "frb") == [pd7_of_the_readme]
    typed = [
        [step.text for body in blocks(page, "console") for step in console_steps(body)]
        for page in (README, LANDING)
    ]
    assert [line for line in typed[0] if line in typed[1]] == typed[1] != []


def test_the_rule_base_of_the_readme_is_what_is_shipped(pd7_of_the_readme):
    shipped = (ROOT / "rulebases" / "pd7.frb").read_text("utf-8")
    without_comments = re.sub(r"(?m)^#.*\n|\s*#.*$", "", shipped)
    assert pd7_of_the_readme.strip() == without_comments.strip()


def test_the_mistake_of_the_readme_is_told_as_the_program_tells_it(pd7_of_the_readme):
    from fuzzyarm.base.diagnostic import render_all
    from fuzzyarm.language import parse

    broken = pd7_of_the_readme.replace("NB  NM  NM", "NB  NX  NM", 1)
    told = render_all(parse(broken, "broken.frb").diagnostics, broken)
    assert told.strip() in (ROOT / "README.md").read_text("utf-8")
