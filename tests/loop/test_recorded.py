"""A recorded run through the controller that drove it, and through others; damaged logs."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from fuzzyarm.apps.cli import main

SERVO = Path(__file__).parents[2] / "rulebases" / "servo.frb"


@pytest.fixture
def log(tmp_path, capsys):
    path = tmp_path / "log.csv"
    words = ["simulate", str(SERVO), "--step", "1", "--for", "0.1s", "--csv", str(path)]
    assert main(words) == 0
    capsys.readouterr()
    return path


def changed(path, change):
    """Write a log with changed rows; `change` takes the list of rows, names first."""
    with path.open() as file:
        rows = list(csv.reader(file))
    change(rows)
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(rows)
    return path


OWN = ("position=position", "velocity=velocity", "voltage=voltage",
       "reference.position=position wanted", "reference.velocity=0")  # fmt: skip


def judged(capsys, *words, columns=OWN):
    status = main(["validate", *map(str, words), "--json", "--columns", *columns])
    return status, json.loads(capsys.readouterr().out)


def test_a_run_of_its_own_is_what_it_would_have_driven(log, capsys):
    status, found = judged(capsys, SERVO, log)
    assert status == 0
    assert found["periods"] == 100
    assert found["gap"] is None
    (drive,) = found["drives"]
    assert (drive["drive"], drive["parts_at"]) == ("voltage", None)
    assert drive["worst"] < 1e-12


def test_the_period_is_told_from_which_they_part(log, capsys):
    def change(rows):
        for row in rows[41:]:
            row[5] = str(float(row[5]) + 0.5)

    _, found = judged(capsys, SERVO, changed(log, change))
    (drive,) = found["drives"]
    assert drive["parts_at"] == 40
    assert drive["was"] - drive["would"] == pytest.approx(0.5)
    assert drive["worst"] == pytest.approx(0.5)
    _, found = judged(capsys, SERVO, log, "--tolerance", "0.6")
    assert found["drives"][0]["parts_at"] is None


def test_another_controller_parts_at_once(log, tmp_path, capsys):
    other = tmp_path / "other.frb"
    other.write_text(SERVO.read_text().replace("gain G_u  = 4.5", "gain G_u  = 4.4"))
    assert other.read_text() != SERVO.read_text()
    _, found = judged(capsys, other, log)
    assert found["drives"][0]["parts_at"] == 0


def test_columns_have_any_names_and_a_set_point_may_be_a_number(log, capsys):
    def change(rows):
        rows[0] = ["t", "ref", "enc", "tacho", "amps", "u"]

    columns = ["reference.position=1", "measured.position=enc", "velocity=tacho", "voltage=u",
               "reference.velocity=0"]  # fmt: skip
    _, found = judged(capsys, SERVO, changed(log, change), columns=columns)
    assert found["drives"][0]["parts_at"] is None
    assert main(["validate", str(SERVO), str(log), "--columns", "voltage=v"]) == 1
    assert "no column 'v'" in capsys.readouterr().err


def test_a_lost_sample_is_skipped_and_a_gap_is_told(log, capsys):
    def change(rows):
        rows[21][2] = ""
        del rows[51:53]

    _, found = judged(capsys, SERVO, changed(log, change))
    assert found["skipped"] == {"shaft": 1}
    assert found["gap"] == 50


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda rows: rows[7].__setitem__(2, "fast"), "'fast' is not a finite number"),
        (lambda rows: rows[9].pop(), "5 cells, the first line has 6"),
        (lambda rows: rows.__delitem__(slice(1, None)), "no samples"),
    ],
)
def test_a_damaged_log_is_refused_with_its_line(log, change, said, capsys):
    words = [str(SERVO), str(changed(log, change)), "--columns", *OWN]
    assert main(["validate", *words]) == 1
    assert said in capsys.readouterr().err


def emptied(rows):
    for row in rows[1:]:
        row[5] = ""


def beyond(rows):
    rows[31][5] = "inf"


def in_milliseconds(rows):
    rows[0][0] = "time [ms]"
    for row in rows[1:]:
        row[0] = str(1000.0 * float(row[0]))


def test_a_drive_that_was_not_recorded_is_not_as_driven(log, capsys):
    assert main(["validate", str(SERVO), str(changed(log, emptied)), "--columns", *OWN]) == 0
    said = capsys.readouterr().out
    assert "voltage: not recorded in 100 periods" in said
    assert "as driven" not in said


def test_an_infinite_drive_parts(log, capsys):
    _, found = judged(capsys, SERVO, changed(log, beyond))
    assert [(d["compared"], d["parts_at"]) for d in found["drives"]] == [(100, 30)]


def test_times_may_be_in_another_unit(log, capsys):
    _, found = judged(capsys, SERVO, changed(log, in_milliseconds))
    assert found["gap"] is None


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--tolerance", "nan"), "tolerance of nan is out of range"),
        (("--tolerance", "-1"), "tolerance of -1 is out of range"),
        (("--all",), "--all is of samples"),
        (("--plot", "a.png"), "--plot is of samples"),
    ],
)
def test_what_does_not_go_with_a_log_is_refused(log, capsys, words, said):
    assert main(["validate", str(SERVO), str(log), *words, "--columns", *OWN]) in {1, 2}
    assert said in capsys.readouterr().err


def test_a_log_without_columns_names_the_option(log, capsys):
    assert main(["validate", str(SERVO), str(log)]) in {1, 2}
    err = capsys.readouterr().err
    assert "has no column 'e', an input of pd7" in err
    assert "--columns PORT=COLUMN" in err


def test_a_column_that_could_be_two_is_refused(log, capsys):
    def change(rows):
        rows[0][4], rows[0][5] = "voltage [V]", "voltage [mV]"

    words = ["validate", str(SERVO), str(changed(log, change)), "--columns", *OWN]
    assert main(words) == 1
    assert "has 2 columns 'voltage'" in capsys.readouterr().err
    assert main(["validate", str(SERVO), str(log), "--columns", *OWN, "voltage=position"]) == 1
    assert "'voltage' has two columns" in capsys.readouterr().err
