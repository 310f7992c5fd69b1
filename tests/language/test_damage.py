"""Damaged files: a located diagnostic or a valid parse, never an exception, never a slip."""

import random
import string

import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.base.diagnostic import render_all
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.check import check

FILES = [name for name in shipped_names() if name.endswith(".frb")]
PER_FILE = cases(24, 48)
ODD = [
    "\x00",
    "\ufffd",
    "é",
    "'",
    '"',
    "\\",
    "#",
    "(",
    ")",
    "..",
    "->",
    ",",
    ":",
    "*",
    "-",
    ".",
    " and ",
    " is ",
    "\n",
    "\t",
    "9e999",
    "nan",
    "inf",
    "\u2028",
    "ｅ",
    "rules ",
    "when ",
]


def damage(text, rng):
    """Return `text` with one to three injuries of the kind that editing makes."""
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(text) + 1)
        length = rng.choice([1, 1, 1, 2, 5, 20])
        kind = rng.randrange(6)
        lines = text.split("\n")
        if kind == 0:
            text = text[:at] + text[at + length :]
        elif kind == 1:
            text = text[:at] + rng.choice(ODD) + text[at:]
        elif kind == 2:
            text = text[:at] + rng.choice(string.printable) + text[at + 1 :]
        elif kind == 3:
            del lines[rng.randrange(len(lines))]
            text = "\n".join(lines)
        elif kind == 4:
            lines.insert(rng.randrange(len(lines)), rng.choice(lines))
            text = "\n".join(lines)
        else:
            words = text.split(" ")
            i, j = rng.randrange(len(words)), rng.randrange(len(words))
            words[i], words[j] = words[j], words[i]
            text = " ".join(words)
        text = text or " "
    return text


def assert_sound(text):
    """Demand what holds for any text whatever."""
    parsed = parse(text, "damaged.frb")
    lines = max(1, text.count("\n") + text.count("\r") + 1)
    assert [d.span for d in parsed.diagnostics] == sorted(d.span for d in parsed.diagnostics)
    for diagnostic in parsed.diagnostics:
        assert 1 <= diagnostic.line <= lines
        assert diagnostic.column >= 1
        assert diagnostic.name
        assert diagnostic.message
    render_all(parsed.diagnostics, text)
    if any(d.is_error for d in parsed.diagnostics):
        assert parsed.rulebase is None
        assert parsed.controller is None
        return
    assert parsed.rulebase is not None or parsed.controller is not None
    if parsed.rulebase is not None:
        check(parsed.rulebase, parsed.document)
    formatted = format_text(text)
    again = parse(formatted)
    assert again.rulebase == parsed.rulebase
    assert again.controller == parsed.controller
    assert format_text(formatted) == formatted


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_damaged_shipped_files_are_diagnosed_or_valid(name):
    whole = shipped(name).read_text()
    rng = random.Random(name)
    for _ in range(PER_FILE):
        assert_sound(damage(whole, rng))


def test_there_are_at_least_two_thousand_ways():
    assert PER_FILE * len(FILES) >= cases(1000, 2000)


@pytest.mark.slow
@settings(max_examples=cases(50, 150), deadline=None)
@given(st.text(max_size=300))
def test_any_text_is_diagnosed_or_valid(text):
    assert_sound(text)


@settings(max_examples=cases(33, 100), deadline=None)
@given(st.binary(max_size=400))
def test_binary_noise_is_diagnosed_or_valid(noise):
    assert_sound(noise.decode("latin-1"))


WORDS = [
    "rulebase",
    "input",
    "output",
    "terms",
    "term",
    "inference",
    "rules",
    "rule",
    "lookup",
    "expect",
    "block",
    "if",
    "then",
    "is",
    "and",
    "or",
    "not",
    "very",
    "with",
    "when",
    "e",
    "ce",
    "u",
    "NB",
    "ZE",
    "PB",
    "triangle",
    "triangles",
    "points",
    "0",
    "-6",
    "6",
    "0.5",
    "..",
    ":",
    ",",
    "->",
    "=",
    "(",
    ")",
    "\\",
    "*",
    ".",
    "\n",
    "\n  ",
    "levels",
    "bins",
    "round",
    "centroid",
    "linear",
    "formula",
    '"x"',
    "'y z'",
    "inf",
    "nan",
    "# c",
]


@settings(max_examples=cases(100, 300), deadline=None)
@given(st.lists(st.sampled_from(WORDS), max_size=60))
def test_any_order_of_the_words_of_the_language_is_diagnosed_or_valid(words):
    assert_sound(" ".join(words))


@settings(max_examples=cases(20, 60), deadline=None)
@given(st.sampled_from(FILES), st.data())
def test_cutting_a_file_off_anywhere_is_diagnosed_or_valid(name, data):
    whole = shipped(name).read_text()
    assert_sound(whole[: data.draw(st.integers(0, len(whole)))])
