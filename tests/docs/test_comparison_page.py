"""The page that compares controllers: its tables are what the commands print, its prose theirs.

``pytest tests/docs --update-golden`` writes the tables of today; the prose is a person's to mend.
"""

import json
import re
import sys
from pathlib import Path

import pytest

from fuzzyarm.cli import main
from fuzzyarm.text.files import write_atomically

DOCS = Path(__file__).parents[2] / "docs"
sys.path.insert(0, str(DOCS))

from make_comparison import PAGE, TABLE, page, printed  # noqa: E402

TEXT = PAGE.read_text("utf-8")
TABLES = TABLE.findall(TEXT)

CONSTANTS = {"2.32", "0.066", "0.002", "55.44", "48.51", "0.24", "3.142857"}
"""Of the motors, of options and of the study: what is asked for, not what comes out."""


@pytest.mark.parametrize(("command", "shown"), TABLES, ids=[table[0][17:70] for table in TABLES])
def test_a_table_is_what_its_command_prints(command, shown, update_golden):
    if update_golden:
        write_atomically(PAGE, page(PAGE.read_text("utf-8")))
        return
    assert printed(command) == shown


def prose():
    """Return the page without its tables, blocks and commands."""
    text = TABLE.sub("", TEXT)
    text = re.sub(r"(?ms)^```.*?^```", "", text)
    return re.sub(r"(?m)^    .*$|`fuzzyarm [^`]*`|!\[.*?\]\(.*?\)", "", text)


def test_every_number_of_the_prose_stands_in_a_table(capsys):
    assert main(["compare", "hfie", "stfc", "cfaf", "--no-load-in-hold", "--markdown"]) == 0
    tables = [shown for _, shown in TABLES] + [capsys.readouterr().out]
    cells = {cell.strip() for table in tables for cell in re.split(r"[|\n]", table)}
    found = re.findall(r"\d+\.\d{2,}", prose())
    assert len(found) > 40
    assert [number for number in found if number not in cells | CONSTANTS] == []
    counts = re.findall(
        r"(?:takes?|up to|and|costs) (\d+)\b(?! controllers| narrow|\.|°| N m)", prose()
    )
    assert len(counts) > 10
    assert [number for number in counts if number not in cells | {"48", "20", "2", "10"}] == []


def test_led_set_points_make_one_error_of_three(capsys):
    assert main(["compare", "--interpolate", "--json"]) == 0
    for row in json.loads(capsys.readouterr().out):
        for other in ("rms", "rms_periods"):
            assert row[other] == pytest.approx(row["rms_path"], rel=6e-3), row["controller"]


def test_the_page_has_all_controllers_and_conditions():
    from fuzzyarm.study.comparison import compared_names

    whole = [shown for command, shown in TABLES if "cdid acdid+ie" not in command]
    assert len(whole) == 4
    for shown in whole:
        names = [line.split("|")[1].strip() for line in shown.splitlines()[2:]]
        assert names == compared_names()
