"""A search is not lost, whatever fails in it or after it: the file is there, and one sentence."""

import errno
import json
import os

import pytest

from fuzzyarm import load, tune
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.show.figures import tuning as figure
from fuzzyarm.base import files
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.loop import Signal
from fuzzyarm.learning.tuning import Journal, judging, result
from fuzzyarm.learning.tuning.cost import CostFormulaError
from fuzzyarm.learning.tuning.search import Search

ROOM = ("--reference", "temperature=20", "--for", "600s")
QUICK = (*ROOM, "--workers", "1", "--evals", "8", "--unseen", "2", "-o", "mine.frb")

KILN = """
from fuzzyarm.plant import Plant, Port

class Kiln(Plant):
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"temperature": Port("°C", 0, 1200)}
    states = {"charge": "°C", "element": "°C"}
    parameters = {"to_charge": 300.0, "to_room": 900.0, "room": 20.0}
    duration = 600.0

    def start(self, rng):
        return [20.0, 20.0]

    def derivative(self, t, x, u, p):
        charge, element = x
        return [(element - charge) / p[0], (12.0 * u[0] - (element - p[2])) / p[1]]

def late(runs):
    return sum(abs(run.error_matrix[-1, 0]) for run in runs)
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = shipped("heater.frb").read_text().replace("axis room", "axis kiln")
    (tmp_path / "kiln.frb").write_text(text)
    (tmp_path / "roompi.frb").write_text(shipped("roompi.frb").read_text())
    (tmp_path / "mine.py").write_text(KILN)
    return tmp_path


def check(path):
    assert main(["check", "--strict", str(path)]) == 0


def raising(error):
    def fails(*_words, **_given):
        raise error

    return fails


# --- After the search ---


@pytest.mark.slow
def test_a_plant_of_ones_own_is_tuned_on_by_processes_beside_an_opponent(folder, capsys):
    words = ["tune", "kiln.frb", "--plant", "mine.py:Kiln", "--step", "200", "--evals", "6"]
    words += ["--unseen", "1", "--cost", "mine.py:late", "--workers"]
    for workers, out in (("2", "two.frb"), ("1", "one.frb")):
        assert main([*words, workers, "-o", out]) == 0
    assert "linear PD" in capsys.readouterr().out
    assert (folder / "two.frb").read_text() == (folder / "one.frb").read_text()


@pytest.mark.parametrize("error", [RuntimeError("gone"), MemoryError(), OSError(5, "no disk")])
@pytest.mark.parametrize("what", ["_linear", "_judge", "rounded"])
def test_what_follows_the_search_may_fail(what, error, folder, capsys, monkeypatch):
    if what == "rounded":
        monkeypatch.setattr(judging.ExaminerPool, "score_of", raising(error))
    elif what == "_judge":
        monkeypatch.setattr(judging, "panel", raising(error))
    else:
        monkeypatch.setattr(judging, what, raising(error))
    assert main(["tune", "heater", *QUICK, "--json"]) == 1
    said = capsys.readouterr()
    report = json.loads(said.out)
    assert report["trials"] == 8
    assert report["faults"]
    word = "no disk" if isinstance(error, OSError) else type(error).__name__
    assert all(word in fault and fault in said.err for fault in report["faults"])
    assert "Traceback" not in said.err
    check("mine.frb")
    written = load(folder / "mine.frb").model
    old = load(shipped("heater.frb")).model
    assert [gain.values for gain in written.gains] != [gain.values for gain in old.gains]


def test_a_figure_may_fail(folder, capsys, monkeypatch):
    monkeypatch.setattr(figure, "tuning_figure", raising(ValueError("no such font")))
    assert main(["tune", "heater", *QUICK, "--no-linear", "--plot", "x.svg"]) == 1
    said = capsys.readouterr()
    assert "wrote mine.frb" in said.out
    assert said.err == "fuzzyarm: ValueError: no such font\n"
    check("mine.frb")


@pytest.mark.parametrize("first", [0, 1])
def test_a_disk_that_is_full(first, folder, capsys, monkeypatch):
    """At once: the result goes elsewhere. When the notes are added: the numbers stay."""
    write, calls = result.write_atomically, []

    def full(path, content):
        if not path.is_absolute():
            calls.append(path)
            if len(calls) > first:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        write(path, content)

    monkeypatch.setattr(result, "write_atomically", full)
    assert main(["tune", "heater", *QUICK, "--no-linear", "--json"]) == 1
    said = capsys.readouterr()
    (written,) = json.loads(said.out)["files"]
    assert said.err.startswith("fuzzyarm: mine.frb: No space left on device; ")
    assert (written == "mine.frb") == (first == 1)
    check(written)
    assert ("unseen" in (folder / written).read_text()) == (first == 0)


def test_a_folder_that_cannot_be_written_is_told_before_the_search(capsys, monkeypatch):
    def refuses(folder):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))

    monkeypatch.setattr(files, "_part_in", refuses)
    monkeypatch.setattr(Search, "run", raising(AssertionError("it has begun")))
    for words in (QUICK, (*ROOM, "--plot", "x.png")):
        assert main(["tune", "heater", *words]) == 1
        assert "Permission denied" in capsys.readouterr().err


def test_what_somebody_has_changed_meanwhile_is_left(folder, capsys, monkeypatch):
    """The file is read once, and what is written over it is not what somebody has typed."""
    mine = folder / "kiln.frb"
    typed = mine.read_text() + "# typed meanwhile\n"

    def working(self, name, run=judging.ExaminerPool.scores):
        mine.write_text(typed)
        (folder / "roompi.frb").unlink(missing_ok=True)
        return run(self, name)

    monkeypatch.setattr(judging.ExaminerPool, "scores", working)
    words = ["tune", "kiln.frb", "--plant", "mine.py:Kiln", "--step", "200", "--workers", "1"]
    assert main([*words, "--evals", "6", "--unseen", "1", "--no-linear", "-o", "kiln.frb"]) == 1
    said = capsys.readouterr()
    assert mine.read_text() == typed
    assert "kiln.frb has changed since; it is left, and kiln-tuned.frb written" in said.err
    new = (folder / "kiln-tuned.frb").read_text()
    assert "# tuned: nelder-mead" in new
    assert "typed meanwhile" not in new


# --- In the search ---


def tuned_on(plant, **given):
    settings = {"reference": {"temperature": Signal("step", (200.0,))}, "workers": 1}
    settings |= {"evals": 20, "unseen": 0, "linear": False, **given}
    return tune("kiln.frb", plant, **settings)


@pytest.mark.slow
def test_candidates_at_which_a_plant_fails_are_left_behind(folder, capsys):
    """Of 20 candidates those with more power than the file end in an error of the plant's."""
    strict = "        if u[0] > 60.0: raise ValueError('the fuse has blown')\n"
    text = KILN.replace("        charge, element = x", f"{strict}        charge, element = x")
    (folder / "mine.py").write_text(text)
    made = tuned_on("mine.py:Kiln")
    faults = [trial.score.fault for trial in made.found.trials]
    assert faults[0] == ""
    assert 0 < made.found.failed == sum(map(bool, faults)) < 19
    assert "plant kiln failed" in made.found.failure
    assert "ValueError: the fuse has blown" in made.found.failure
    assert made.found.best.score.fault == ""
    assert any("failed, the first with: scenario" in line for line in made.remarks())
    together = tuned_on("mine.py:Kiln", workers=2, method="evolution", evals=16)
    alone = tuned_on("mine.py:Kiln", method="evolution", evals=16)
    assert repr(together.found.trials) == repr(alone.found.trials)
    # Where the file itself fails there is nothing to search from.
    (folder / "mine.py").write_text(text.replace("> 60.0", "> -1.0"))
    with pytest.raises(Exception, match=r"mine.py:\d+: plant kiln: ValueError: the fuse has blown"):
        tuned_on("mine.py:Kiln")


def test_a_search_that_breaks_off_keeps_what_it_has(folder):
    def watch(found):
        if len(found.trials) == 9:
            raise OSError(5, "the disk has gone")

    made = tuned_on("mine.py:Kiln", watch=watch, evals=500, unseen=1)
    assert len(made.found.trials) == 9
    assert made.faults == ("the disk has gone",)
    assert made.found.best.score.cost < made.found.trials[0].score.cost
    assert "unseen" in made.row("tuned").scores


def test_a_cost_that_is_never_a_number(folder):
    made = tuned_on("mine.py:Kiln", cost=lambda _runs: float("nan"))
    assert made.claim() == "no candidate has a cost that is a number: the file stays as it is"
    assert made.files[0].old == made.files[0].new
    (folder / "mine.py").write_text(
        KILN + "\ncalls = []\ndef worse(runs):\n    calls.append(1)\n"
        "    if len(calls) > 3: raise KeyError('x')\n    return 1.0\n"
    )
    made = tuned_on("mine.py:Kiln", cost="mine.py:worse")
    assert made.found.failed == 17
    assert "KeyError" in made.found.failure
    with pytest.raises(CostFormulaError, match="KeyError"):
        tuned_on("mine.py:Kiln", cost=lambda _runs: {}["x"])


def test_a_journal_that_cannot_grow_is_given_up(folder, monkeypatch):
    journal = Journal("trials", {"asked": 1}, resume=False)
    append = journal.append

    def full(trials, first):
        if first >= 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        append(trials, first)

    monkeypatch.setattr(journal, "append", full)
    made = tuned_on("mine.py:Kiln", journal=journal)
    assert len(made.found.trials) == 20
    assert made.found.unwritten == "trials: No space left on device"
    again = tuned_on("mine.py:Kiln", journal=Journal("trials", {"asked": 1}, resume=True))
    assert again.text == made.text


# --- Ctrl-C, wherever it comes ---


@pytest.mark.parametrize("where", ["scores", "score_of", "_judge", "_linear"])
def test_ctrl_c_loses_nothing(where, folder, capsys, monkeypatch):
    if where == "scores":
        run, calls = judging.ExaminerPool.scores, []

        def scores(self, points, digits=None):
            calls.append(1)
            if len(calls) > 5:
                raise KeyboardInterrupt
            return run(self, points, digits)

        monkeypatch.setattr(judging.ExaminerPool, "scores", scores)
    else:
        home = judging.ExaminerPool if where == "score_of" else judging
        monkeypatch.setattr(home, where, raising(KeyboardInterrupt()))
    assert main(["tune", "heater", *QUICK, "--journal", "trials"]) == 130
    said = capsys.readouterr()
    assert "interrupted: the best so far is kept; trials has all, --resume goes on" in said.err
    check("mine.frb")
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    assert main(["tune", "heater", *QUICK, "--journal", "trials", "--resume"]) == 0
    resumed = (folder / "mine.frb").read_text()
    assert main(["tune", "heater", *QUICK]) == 0
    assert (folder / "mine.frb").read_text() == resumed
