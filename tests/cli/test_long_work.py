"""Commands that take a while say what they do, on a terminal or not, and lose nothing.

For ``tune`` see ``tests/tuning/test_nothing_is_lost.py``.
"""

import errno
import json
import os
from itertools import islice
from pathlib import Path

import pytest
from stopped_clock import StoppedClock

from fuzzyarm.apps.cli import command, main
from fuzzyarm.apps.cli.command import announced, busy, progress_bar
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.loop import sweeps
from fuzzyarm.learning.self_organizing import Trainee
from fuzzyarm.table import read_table


@pytest.fixture
def clock(monkeypatch):
    """A clock by which work is named after 2 s, and says how far it is every 10 s."""
    monkeypatch.setattr(command, "SOON", 2.0)
    monkeypatch.setattr(command, "TOLD_EVERY", 10.0)
    clock = StoppedClock()
    clock.put_into(command, monkeypatch)
    return clock


def test_what_takes_a_while_is_said_once(clock, capsys):
    with announced("tuning servo.frb"):
        clock.sleep(8)
    assert capsys.readouterr().err == "fuzzyarm: tuning servo.frb\n"
    with announced("tuning servo.frb"):
        clock.sleep(1)
    clock.sleep(8)
    with announced("tuning servo.frb", shown=False):
        clock.sleep(8)
    assert capsys.readouterr().err == ""


def test_long_work_says_now_and_then_how_far_it_is(clock, capsys):
    with busy("fitting") as tell:
        tell("2 terms of e")  # too early for another word
        clock.sleep(12)
        tell("2 terms of e, 2 of ce")
        tell("3 terms of e")
    assert capsys.readouterr().err == "fuzzyarm: fitting\nfuzzyarm: 2 terms of e, 2 of ce\n"
    with progress_bar("learning", 40) as advance:
        clock.sleep(12)
        advance(10)
        advance(10)
    assert capsys.readouterr().err == "fuzzyarm: learning\nfuzzyarm: learning, 25 %\n"


# --- Nothing is lost ---


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def raising(error):
    def fails(*_words, **_given):
        raise error

    return fails


LEARN = ("learn", "--segment", "0.1", "--trajectory", "pick-and-place", "-o")


@pytest.mark.slow
@pytest.mark.parametrize("error", [KeyboardInterrupt(), FuzzyarmError("the plant has gone")])
def test_a_training_that_ends_keeps_the_passes_until_then(error, folder, capsys, monkeypatch):
    assert main([*LEARN, "two.lut", "--passes", "2"]) == 0
    whole = Trainee.snapshots

    def until(self, *words):
        for snapshot in whole(self, *words):
            if snapshot.passage == 3 and snapshot.time > 0.2:
                raise error
            yield snapshot

    monkeypatch.setattr(Trainee, "snapshots", until)
    capsys.readouterr()
    status = main([*LEARN, "three.lut", "--passes", "9", "--plot", "x.svg"])
    said = capsys.readouterr()
    assert status == (130 if isinstance(error, KeyboardInterrupt) else 1)
    assert Path("three.lut").read_bytes() == Path("two.lut").read_bytes()
    assert Path("x.svg").exists()
    assert "pass 2: RMS error" in said.out
    assert ("interrupted in pass 3" if status == 130 else "the plant has gone") in said.err


def test_a_training_that_ends_in_its_first_pass_keeps_what_was_learned(folder, monkeypatch):
    whole = Trainee.snapshots

    def until(self, *words):
        yield from islice(whole(self, *words), 10)
        raise KeyboardInterrupt

    monkeypatch.setattr(Trainee, "snapshots", until)
    assert main([*LEARN, "part.lut"]) == 130
    table = read_table("part.lut")
    assert dict(table.provenance)["passes"].startswith("a part of 1, ")
    assert table.values.any()
    monkeypatch.setattr(Trainee, "snapshots", raising(KeyboardInterrupt()))
    assert main([*LEARN, "nothing.lut"]) == 130
    assert not Path("nothing.lut").exists()


def test_a_table_and_its_report_do_not_depend_on_a_figure(folder, capsys, monkeypatch):
    from fuzzyarm.apps.show.figures import learning

    monkeypatch.setattr(learning, "learning_figure", raising(ValueError("no such font")))
    assert main([*LEARN, "x.lut", "--plot", "x.svg", "--json"]) == 1
    said = capsys.readouterr()
    assert json.loads(said.out)["file"] == "x.lut"
    assert said.err == "fuzzyarm: ValueError: no such font\n"
    assert Path("x.lut").exists()


SAMPLES = "a,b,y\n" + "".join(f"{a},{b},{a * abs(b)}\n" for a in range(-3, 4) for b in range(-3, 4))


def test_a_model_that_cannot_be_written_goes_elsewhere(folder, capsys, monkeypatch):
    from fuzzyarm.base import files

    Path("set.csv").write_text(SAMPLES)
    write = files.write_atomically

    def full(path, content):
        if not os.path.isabs(path):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        write(path, content)

    monkeypatch.setattr(files, "write_atomically", full)
    assert main(["fit", "set.csv", "-o", "x.frb", "--json", "--rules", "2"]) == 1
    said = capsys.readouterr()
    file = json.loads(said.out)["file"]
    assert said.err == f"fuzzyarm: x.frb: No space left on device; {file} has the result\n"
    assert main(["check", file]) == 0


def test_a_model_and_its_report_do_not_depend_on_the_test_samples(folder, capsys, monkeypatch):
    Path("set.csv").write_text(SAMPLES)
    monkeypatch.setattr("fuzzyarm.learning.report.tested", raising(MemoryError()))
    assert main(["fit", "set.csv", "-o", "x.frb", "--test", "set.csv", "--rules", "2"]) == 1
    said = capsys.readouterr()
    assert "x.frb: " in said.out
    assert said.err == "fuzzyarm: MemoryError\n"


SWEEP = ("sweep", "pd", "--segment", "0.2", "--hold", "0.1", "--sweep", "payload=0..2:9")


@pytest.mark.parametrize("error", [KeyboardInterrupt(), FuzzyarmError("the plant has gone")])
def test_a_sweep_that_ends_reports_the_runs_until_then(error, folder, capsys, monkeypatch):
    whole = sweeps.stream

    def until(*words, **given):
        for at, part in enumerate(whole(*words, **given)):
            if at == 3:
                raise error
            yield part

    monkeypatch.setattr(sweeps, "stream", until)
    status = main([*SWEEP, "--workers", "1", "-o", "x.csv"])
    said = capsys.readouterr()
    rows = len(Path("x.csv").read_text().splitlines()) - 3
    assert 0 < rows < 9
    assert f"pd on reach-return: {rows} run" in said.out
    if isinstance(error, KeyboardInterrupt):
        assert status == 130
        assert f"interrupted after {rows} of 9 runs; x.csv has them, --resume goes on" in said.err
    else:
        assert (status, said.err) == (1, "fuzzyarm: the plant has gone\n")


def test_a_sweep_on_a_full_disk_and_one_without_a_figure(folder, capsys, monkeypatch):
    from fuzzyarm.apps.show.figures import sweep
    from fuzzyarm.control.loop.sweep import SweepFile

    append = SweepFile.append

    def full(self, first, rows):
        if first >= 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        append(self, first, rows)

    monkeypatch.setattr(SweepFile, "append", full)
    monkeypatch.setattr(sweep, "sweep_figure", raising(ValueError("no such font")))
    assert main([*SWEEP, "--workers", "1", "-o", "x.csv", "--plot", "x.svg"]) == 1
    said = capsys.readouterr()
    assert "9 runs" in said.out
    disk, font = said.err.splitlines()
    assert disk.startswith("fuzzyarm: x.csv: No space left on device; the file has the runs before")
    assert font == "fuzzyarm: ValueError: no such font"
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    assert main([*SWEEP, "-o", "x.csv", "--resume"]) == 0
    assert main([*SWEEP, "-o", "y.csv"]) == 0
    assert Path("x.csv").read_bytes() == Path("y.csv").read_bytes()
