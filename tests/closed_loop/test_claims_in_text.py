"""Claims about loops as text: what an editor offers and says of them, findings, canonical form."""

import pytest

import fuzzyarm
from fuzzyarm.control.controllers.findings import doubts_of, plants_in_words, ports_in_words
from fuzzyarm.language import format_text
from fuzzyarm.language.edit import NameKind, complete, hover, read

SERVO = fuzzyarm.shipped("servo.frb").read_text(encoding="utf-8")

FACTS = {(NameKind.PORT, name): words for name, words in ports_in_words(["shaft"]).items()} | {
    (NameKind(kind), name): words for (kind, name), words in plants_in_words(["shaft"]).items()
}


def with_line(line):
    """Return a controller with one more line, where a mark | stands in it."""
    text = f"{SERVO}\n{line}"
    before = text.partition("|")[0]
    return read(text.replace("|", "")), before.count("\n") + 1, len(before) - before.rfind("\n")


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("prove |", "stable"),
        ("prove stable on |", "cartpole"),
        ("prove on motor at |", "position"),
        ("prove on motor with |", "J"),
        ("prove on motor from |", "current"),
        ("prove on motor from position in 0 .. 1, |", "velocity"),
        ("prove on motor from position in 0 .. 1: |", "position"),
        ("prove on motor from position in 0 .. 1: position in -1 .. 1 |", "during"),
        ("prove on motor from position in 0 .. 1: position in -1 .. 1 after 2 |", "ms"),
    ],
)
def test_what_may_follow_is_offered(line, offered):
    assert offered in [each.label for each in complete(*with_line(line), FACTS)]


def test_states_that_are_no_ports_are_known():
    reading, line, column = with_line(
        "prove on motor with J in 0.009 .. 0.011 from c|urrent in 0 .. 1: position in 0 .. 1"
    )
    assert "motor" in hover(reading, line, column, FACTS).markdown
    assert "state" in hover(reading, line, column, {}).markdown


@pytest.mark.parametrize(
    ("claim", "words"),
    [
        ("on motor from positon in 0 .. 1: position in 0 .. 1", "no state 'positon'"),
        ("on motor from position in 0 .. 1: psition in 0 .. 1", "no port 'psition'"),
        ("stable on motor with Jj in 0 .. 1", "no parameter 'Jj'"),
        ("stable on motor at sped = 1", "no port 'sped'"),
    ],
)
def test_what_a_shipped_plant_does_not_have_is_found(tmp_path, claim, words):
    for name in ("servo.frb", "pd7.frb"):
        text = fuzzyarm.shipped(name).read_text(encoding="utf-8")
        (tmp_path / name).write_text(text, encoding="utf-8")
    path = tmp_path / "servo.frb"
    path.write_text(f"{SERVO}\nprove {claim}\n", encoding="utf-8")
    found = [each for each in doubts_of(fuzzyarm.load(path)) if each.name == "unknown-port"]
    assert [words in each.message for each in found] == [True]


def test_a_claim_is_printed_as_it_was_written():
    lines = [
        "prove stable on motor",
        "prove on motor at position = 0.1 with J in 0.009 .. 0.011 from position in -0.3 .. 0.3:"
        " position in -0.35 .. 0.35 during 0 .. 0.5 s",
        "prove on motor from position in -0.3 .. 0.3: position in -0.01 .. 0.01 after 500 ms",
    ]
    text = format_text("\n".join([SERVO, *lines, ""]))
    assert text.splitlines()[-len(lines) :] == lines
    always = format_text(f"{SERVO}\n{lines[1].partition(' during')[0]} always\n")
    assert always.splitlines()[-1] == lines[1].partition(" during")[0]
