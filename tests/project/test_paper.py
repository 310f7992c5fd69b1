"""The draft of the paper: its figures, its citations and its numbers are those of today."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

from conformance.suite import read_all
from fuzzyarm.base.sources import SOURCES

PAPER = Path(__file__).parents[2] / "paper"
TEXT = (PAPER / "paper.md").read_text("utf-8")
BIB = (PAPER / "paper.bib").read_text("utf-8")


def figures():
    spec = importlib.util.spec_from_file_location("paper_figures", PAPER / "make_figures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_citation_has_an_entry_and_every_entry_is_cited():
    cited = set(re.findall(r"@([a-z]+\d+)", TEXT))
    assert cited == set(re.findall(r"^@\w+\{(\w+),", BIB, re.MULTILINE))


def test_entries_of_methods_are_those_of_cite():
    for key in ("mamdani1975", "takagi1985", "karnik2001"):
        assert SOURCES[key].bibtex(key) in BIB


def test_the_numbers_of_the_suite_are_those_of_today():
    cases = read_all(validated=False)
    points = sum(len(case.data["points"]) for case in cases)
    assert f"({len(cases)} of them, {points:,} points)" in TEXT


def test_every_figure_is_made_by_the_script(tmp_path):
    module = figures()
    named = set(re.findall(r"\]\((\w+\.png)\)", TEXT))
    assert named == {"tips.png", "conformance.png"} == {p.name for p in PAPER.glob("*.png")}
    module.draw_tips(tmp_path / "tips.png")
    assert (tmp_path / "tips.png").stat().st_size > 10_000
    assert module.counts("fuzzyarm-point")["wrong"] == 1
