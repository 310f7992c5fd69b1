"""A little of each fuzzer; by hand they run for hours."""

from __future__ import annotations

import random

import damaged_tables
import damaged_texts
import patience
import pytest
import random_commands
import random_loops
import random_rule_bases
from budget import cases
from drawn_commands import OFTEN
from fuzzing import run, search
from workers import HUNG, Outcome, Worker

from fuzzyarm.apps.cli.main import COMMANDS
from fuzzyarm.language import parse

LONG = {"plot", "sweep", "tune", "demo", "compare", "reproduce", "watch", "learn"}
"""Commands of which few are tried here: a run or a figure takes some tenths of a second."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fuzzer", "count"), [(damaged_texts, cases(150, 300)), (damaged_tables, cases(150, 300)),
                        (random_rule_bases, cases(15, 30)), (random_loops, cases(4, 200))],
    ids=["damaged texts", "damaged tables", "random rule bases", "random loops"],
)  # fmt: skip
def test_nothing_is_found(fuzzer, count):
    found = search(fuzzer.case, seed=0, count=count)
    assert not found, f"{found[0].told}\n{found[0].trace}"


def test_a_finding_has_its_input_and_its_place():
    def case(r, told):
        told.append(f"input {r.randrange(10)}")
        if told[0].endswith("3"):
            raise ZeroDivisionError("planted")

    found = search(case, seed=1, count=100)
    assert {each.told for each in found} == {"input 3"}
    assert {each.sort.split()[0] for each in found} == {"ZeroDivisionError"}
    again = search(case, seed=1, count=1, first=found[-1].number)
    assert again[0].told == "input 3"


def test_a_search_that_is_interrupted_reports_what_there_is(capsys):
    numbers = iter(range(100))

    def case(r, told):
        number = next(numbers)
        told.append(f"input {number}")
        if number == 3:
            raise ZeroDivisionError("planted")
        if number == 7:
            raise KeyboardInterrupt

    assert run("", case, ["--count", "50"]) == 1
    said = capsys.readouterr().out
    assert "case 3\ninput 3" in said
    assert "7 cases, 1 findings of 1 sorts" in said


# --- Random commands ---


@pytest.mark.slow
def test_random_commands_answer():
    often = {name: share * (0.1 if name in LONG else 1.0) for name, share in OFTEN.items()}
    statuses = set()

    def told(_number: int, outcome: Outcome) -> None:
        statuses.add(outcome.status)

    found = list(random_commands.search(4, cases(100, 150), limit=60.0, told=told, often=often))
    assert not found, f"{found[0].sort}: {found[0].outcome}"
    assert statuses >= {0, 1, 2}


def test_every_command_is_drawn():
    assert set(OFTEN) - {"help"} | {"identify", "designer", "playground"} == set(COMMANDS)


@pytest.mark.parametrize(
    ("outcome", "sort"),
    [
        (Outcome(("show",), 0, "{}", "", "", 0.1), None),
        (Outcome(("show", "--json"), 0, '{"u": null}', "", "", 0.1), None),
        (Outcome(("show", "--json"), 0, '{"u": NaN}', "", "", 0.1), "prints what is none"),
        (Outcome(("show",), 1, "", "", "", 0.1), "status 1 of show without a word"),
        (Outcome(("show",), 3, "", "diverged", "", 0.1), "status 3 of show"),
        (Outcome(("simulate",), 3, "", "diverged", "", 0.1), None),
        (Outcome(("show",), "raised", "", "", "E\nValueError: no", 0.1), "ValueError at ?"),
        (Outcome(("show",), HUNG, "", "", "", 20.0), "longer than the limit"),
        (Outcome(("show",), "ended with -11", "", "", "", 0.1), "ended with -11 at ?"),
    ],
)
def test_what_a_command_does_wrong_is_seen(outcome, sort, tmp_path):
    (tmp_path / ".stdout").write_text("")
    found = list(random_commands.faults(outcome, tmp_path, set()))
    assert [sort in each for each in found] == ([True] if sort else []), found


def test_files_that_cannot_be_read_are_seen(tmp_path):
    (tmp_path / "o.frb").write_text("rulebase\n")
    (tmp_path / "o.json").write_text('{"a": Infinity}')
    (tmp_path / "old.frb").write_text("rulebase\n")
    outcome = Outcome(("convert",), 0, "", "", "", 0.1)
    found = list(random_commands.faults(outcome, tmp_path, {"old.frb"}))
    assert len(found) == 2
    assert "writes JSON that is none" in found[0] + found[1]
    assert "writes what cannot be read" in found[0] + found[1]


@pytest.mark.slow
def test_a_command_that_hangs_is_ended_and_the_next_one_runs(tmp_path):
    (tmp_path / "x.frb").write_text("rulebase x\n")
    with Worker(0.5) as worker:
        hung = worker.run(["watch", "x.frb"], tmp_path)
        assert (hung.status, hung.words) == (HUNG, ("watch", "x.frb"))
        worker.limit = 60.0
        ordinary = worker.run(["--version"], tmp_path)
        assert (ordinary.status, ordinary.err) == (0, "")
        assert ordinary.out.startswith("fuzzyarm ")


# --- Small rule bases of every kind ---


def test_what_is_drawn_to_be_timed_is_sound():
    sound = [parse(patience.drawn(random.Random(f"0 {k}"))) for k in range(40)]
    mistakes = [each.diagnostics for each in sound if each.rulebase is None]
    assert len(mistakes) <= 4, mistakes  # three points of a polygon at one x, now and then
    text = "\n".join(patience.drawn(random.Random(f"0 {k}")) for k in range(40))
    for word in ("bisector", "maximum", "tsukamoto", "karnik", "formula", "threshold", "prove ",
                 "block second", " over ", "not ("):  # fmt: skip
        assert word in text
