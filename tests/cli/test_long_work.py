"""Commands that take a while say what they do, on a terminal or not."""

import time

import pytest

from fuzzyarm.cli import command
from fuzzyarm.cli.command import announced, busy, progress_bar


@pytest.fixture(autouse=True)
def hasty(monkeypatch):
    monkeypatch.setattr(command, "SOON", 0.02)
    monkeypatch.setattr(command, "TOLD_EVERY", 0.1)


def waited(seconds=0.08):
    time.sleep(seconds)


def test_what_takes_a_while_is_said_once(capsys):
    with announced("tuning servo.frb"):
        waited()
    assert capsys.readouterr().err == "fuzzyarm: tuning servo.frb\n"
    with announced("tuning servo.frb"):
        pass
    waited()
    with announced("tuning servo.frb", shown=False):
        waited()
    assert capsys.readouterr().err == ""


def test_long_work_says_now_and_then_how_far_it_is(capsys):
    with busy("fitting") as tell:
        tell("2 terms of e")  # too early for another word
        waited(0.12)
        tell("2 terms of e, 2 of ce")
        tell("3 terms of e")
    assert capsys.readouterr().err == "fuzzyarm: fitting\nfuzzyarm: 2 terms of e, 2 of ce\n"
    with progress_bar("learning", 40) as advance:
        waited(0.12)
        advance(10)
        advance(10)
    assert capsys.readouterr().err == "fuzzyarm: learning\nfuzzyarm: learning, 25 %\n"
