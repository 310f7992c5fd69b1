"""Suggestions for mistyped names: slips and beginnings, not whatever shares letters."""

import os

import pytest

from fuzzyarm.base.names import nearest, several_nearest
from fuzzyarm.base.shipped_files import missing_file_hint

OPTIONS = ("quantise", "noise", "for", "from", "set", "stable", "precision", "output", "mode")


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("stabel", "stable"), ("precison", "precision"), ("outputs", "output"), ("moed", "mode"),
        ("frmo", "from"), ("prec", "precision"), ("SET", "set"), ("quantize", "quantise"),
    ],
)  # fmt: skip
def test_a_slip_or_a_beginning_is_found(typed, meant):
    assert nearest(typed, OPTIONS) == meant


@pytest.mark.parametrize(
    "typed", ["duration", "optimiser", "point", "metric", "xyz", "", "q" * 101]
)
def test_what_only_shares_letters_is_not_suggested(typed):
    assert nearest(typed, OPTIONS) is None
    assert several_nearest(typed, OPTIONS) == []


def test_the_same_in_other_letters_is_the_only_answer():
    assert several_nearest("pd7", ("PD7", "pd7-study")) == ["PD7"]


@pytest.mark.parametrize(
    ("missing", "hint"),
    [
        ("hovr.frb", "did you mean 'hover.frb'?"),
        ("hover", "did you mean 'hover.frb'?"),
        ("hover.frbb", "did you mean 'hover.frb'?"),
        ("xyz.frb", ""),
        ("lost.frb", ""),
        ("servo.frb", "fuzzyarm shipped servo.frb -o .  copies the shipped one"),
        ("servo", "fuzzyarm shipped servo.frb -o .  copies the shipped one"),
        (os.path.join("nowhere", "servo.frb"), ""),
    ],
)
def test_a_missing_file_is_one_beside_it_or_a_shipped_one(tmp_path, monkeypatch, missing, hint):
    monkeypatch.chdir(tmp_path)
    for name in ("hover.csv", "hover.frb", "rb.frb"):
        (tmp_path / name).touch()
    (tmp_path / "lost.frb").symlink_to("lost.frb")
    assert missing_file_hint(missing) == hint
