"""MISRA C:2012 as cppcheck's addon sees it: nothing but what the page lists.

The rules that may be reported are read from the table of `docs/howto/misra.md`.
"""

from __future__ import annotations

import re
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from budget import part
from needs import requires

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "misra.md"

CASES = {
    "cells": ["pd7.frb"],
    "linear": ["pd7.frb", "--mode", "linear"],
    "q15": ["pd7.frb", "--q", "15", "--mode", "linear"],
    "rules": ["tipper.frb", "--direct"],
    "walk": ["tipper2.frb"],
    "one axis": ["heater.frb"],
    "learning": ["soc-zero.frb"],
}
WALKS = {"walk"}
WAYS = {
    "tipper.frb": [
        "bisector", "bisector(101)", "mean-of-maximum", "smallest-of-maximum(101)",
        "bisector, implication product, aggregation sum",
    ],
    "tipper2.frb": ["karnik-mendel", "karnik-mendel(101)", "karnik-mendel-left"],
}  # fmt: skip
"""Rule bases with the defuzzifiers that become walks over their outputs."""
CONTROLLERS = {"one axis", "learning"}

_FINDING = re.compile(r"^(\S+?):(\d+):(\d+): .*\[misra-c2012-([\d.]+)\]$", re.MULTILINE)


def deviations():
    """Return the rules of the page, and of what each is reported."""
    rows = re.findall(r"^\| ([\d.]+) \| \w+ \| (\w+) \|", PAGE.read_text("utf-8"), re.MULTILINE)
    assert rows
    return dict(rows)


def findings(folder):
    """Return what the addon reports of the files of a folder: rule, line of source, column."""
    ran = subprocess.run(
        ["cppcheck", "--addon=misra", "--std=c99", "--quiet", *map(str, folder.glob("*.c"))],
        capture_output=True, text=True, timeout=600, check=True,
    )  # fmt: skip
    for path, line, column, rule in _FINDING.findall(ran.stderr):
        text = Path(path).read_text("utf-8").split("\n")[int(line) - 1]
        yield rule, text, int(column)


@pytest.mark.slow
@requires("cppcheck")
@pytest.mark.parametrize("name", part(list(CASES), 2))
def test_only_what_the_page_lists_is_reported(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    sheet, *words = CASES[name]
    assert main(["compile", str(shipped(sheet)), *words, "-o", "made.c"]) == 0
    listed, reported = deviations(), Counter()
    for rule, text, column in findings(tmp_path):
        reported[listed.get(rule, f"{rule}: {text.strip()}")] += 1
        if rule == "12.1":  # parentheses stand there: cppcheck drops those between ? and :
            assert text[column - 3 : column + 1] == ") : ", text
    allowed = {"choices"}
    allowed |= {"walks"} if name in WALKS else set()
    allowed |= {"macros"} if name in CONTROLLERS else set()
    assert set(reported) <= allowed, reported


@pytest.mark.slow(seconds=15)
@requires("cppcheck")
def test_of_walks_of_every_sort_nothing_else_is_reported(tmp_path):
    for sheet, ways in WAYS.items():
        for number, way in enumerate(ways):
            text = shipped(sheet).read_text("utf-8")
            changed = re.sub(
                r"(implication min, aggregation max, )?defuzzifier [a-z-]* exact",
                f"defuzzifier {way}" if "," in way else rf"\1defuzzifier {way}",
                text,
            )
            assert changed != text
            source = tmp_path / f"{Path(sheet).stem}_{number}.frb"
            source.write_text(changed, "utf-8")
            assert (
                main(["compile", str(source), "--direct", "-o", str(source.with_suffix(".c"))]) == 0
            )
    listed = deviations()
    reported = {listed.get(rule, f"{rule}: {text.strip()}") for rule, text, _ in findings(tmp_path)}
    assert reported <= {"choices", "walks"}


@pytest.mark.slow
@requires("cppcheck")
def test_the_addon_reports_what_is_wrong(tmp_path):
    (tmp_path / "wrong.c").write_text("int f(int a);\nint f(int a) { return a + a * 2; }\n")
    assert "12.1" in {rule for rule, _, _ in findings(tmp_path)}
