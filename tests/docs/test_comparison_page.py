"""The pages that praise controllers: their tables are what commands print, their prose theirs.

``pytest tests/docs --update-golden`` writes the tables of today; the prose is a person's to mend.
"""

import json
import re
import runpy
import sys
from pathlib import Path

import pytest
from budget import cases

from fuzzyarm.apps.cli import main
from fuzzyarm.base.files import write_atomically

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from make_comparison import PAGES, TABLE, page, printed  # noqa: E402

COMPARISON, REPRODUCTION = (path.read_text("utf-8") for path in PAGES)
COMPARED = [
    (path.name, *table)
    for path, text in zip(PAGES, (COMPARISON, REPRODUCTION), strict=True)
    for table in TABLE.findall(text)
    if "fuzzyarm compare" in table[0]
]

CONSTANTS = {"2.32", "0.066", "0.002", "55.44", "48.51", "0.24", "3.142857"}
"""Of the motors, of options and of the study: what is asked for, not what comes out."""


@pytest.mark.parametrize(
    ("name", "command", "shown"), COMPARED, ids=[f"{each[0]} {each[1][17:60]}" for each in COMPARED]
)
def test_a_table_is_what_its_command_prints(name, command, shown, update_golden):
    if update_golden:
        path = ROOT / "docs" / "explanation" / name
        write_atomically(path, page(path.read_text("utf-8"), "fuzzyarm compare"))
        return
    assert printed(command) == shown


def test_rows_are_what_reproduce_prints():
    """The runs as they are; those that are disturbed 200 times take long, see below."""
    (shown,) = (table[1] for table in TABLE.findall(REPRODUCTION) if "reproduce" in table[0])
    of_runs = [line.split(" | ")[:4] for line in shown.splitlines() if " of 200 |" not in line]
    today = printed("fuzzyarm reproduce --markdown --runs 0").splitlines()
    assert [line.split(" | ")[:4] for line in today] == of_runs


@pytest.mark.slow
def test_disturbed_rows_are_what_reproduce_prints():
    (shown,) = (table[1] for table in TABLE.findall(REPRODUCTION) if "reproduce" in table[0])
    lines = printed("fuzzyarm reproduce 7.1.1/soc-zero 7.1.1/fuzzy-lut --markdown").splitlines()
    assert len(lines) == 10
    assert set(lines) <= set(shown.splitlines())


def prose(text):
    """Return a page without its tables, blocks and commands."""
    text = TABLE.sub("", text)
    text = re.sub(r"(?ms)^```.*?^```", "", text)
    return re.sub(r"(?m)^(?:    |\|).*$|`fuzzyarm [^`]*`|!\[.*?\]\(.*?\)", "", text)


def cells_of(*tables):
    return {cell.strip("' ()[],°{}") for table in tables for cell in re.split(r"[|\n ]", table)}


def test_every_number_of_the_comparison_stands_in_a_table(capsys):
    assert main(["compare", "hfie", "stfc", "cfaf", "--no-load-in-hold", "--markdown"]) == 0
    tables = [shown for name, _, shown in COMPARED if name == "comparison.md"]
    cells = cells_of(*tables, capsys.readouterr().out)
    found = re.findall(r"\d+\.\d{2,}", prose(COMPARISON))
    assert len(found) > 40
    assert [number for number in found if number not in cells | CONSTANTS] == []
    counts = re.findall(
        r"(?:takes|up to|costs|and) (\d{2,})[ .]?(?:operations|\(|exported)?", prose(COMPARISON)
    )
    assert {"2327", "847", "7162", "3594", "114", "65"} <= set(
        re.findall(r"\b\d+\b", prose(COMPARISON))
    )
    assert {number for number in counts if len(number) > 2} <= cells


@pytest.mark.slow
def test_every_number_past_the_study_stands_in_a_table_or_is_an_example_s(monkeypatch, capsys):
    """What the search for gains comes to is not cited: in the suite it ends at once."""
    begin, end = (REPRODUCTION.index(head) for head in ("## Going past", "## Rows\n"))
    part = REPRODUCTION[begin:end]
    said = [shown for _, _, shown in COMPARED]
    said += re.findall(r"(?ms)^```(?:console|pycon).*?^```", part)
    words = {"tune_linear_pd": [str(cases(5, 200))]}
    for name in ("best_without_a_model", "tune_linear_pd", "train_and_deploy"):
        monkeypatch.setattr("sys.argv", [f"{name}.py", *words.get(name, [])])
        runpy.run_path(str(ROOT / "examples" / f"{name}.py"), run_name="__main__")
        said.append(capsys.readouterr().out)
        assert said[-1].count("\n") >= 2
    found = re.findall(r"\d+\.\d{4}", prose(part))
    assert len(found) > 30
    known = cells_of(*said) | {"0.0055"}  # of a turn in 16 bits
    assert [number for number in found if number not in known] == []


def test_led_set_points_make_one_error_of_three(capsys):
    assert main(["compare", "--interpolate", "--json"]) == 0
    for row in json.loads(capsys.readouterr().out):
        for other in ("rms", "rms_periods"):
            assert row[other] == pytest.approx(row["rms_path"], rel=6e-3), row["controller"]


def test_the_page_has_all_controllers_and_conditions():
    from fuzzyarm.apps.study.comparison import compared_names

    whole = [
        shown
        for name, command, shown in COMPARED
        if name == "comparison.md" and "cdid acdid+ie" not in command
    ]
    assert len(whole) == 4
    for shown in whole:
        names = [line.split("|")[1].strip() for line in shown.splitlines()[2:]]
        assert names == compared_names()
