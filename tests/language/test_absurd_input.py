"""Input that no person writes: an answer all the same, with a reason, without recursion."""

import pytest

from fuzzyarm.base.diagnostic import MAX_CHARACTERS, MAX_DIAGNOSTICS, MAX_LINE, render_all
from fuzzyarm.language import parse
from fuzzyarm.language.check import check

HEAD = """rulebase t
input e -6 .. 6
input ce -6 .. 6
output u -6 .. 6
terms e, ce, u: triangles N Z P
"""
LONG = MAX_LINE - 100


def filled(piece, length):
    return (piece * (length // len(piece) + 1))[:length]


@pytest.mark.parametrize(
    "piece", ["a\n", "@\n", "\n", "\r", "#\n", "'\n", "input a 0 .. 1\n", "\x00"]
)
def test_a_text_of_the_greatest_size(piece):
    parsed = parse(filled(piece, MAX_CHARACTERS))
    assert parsed.diagnostics
    assert len(parsed.diagnostics) <= MAX_DIAGNOSTICS + 1
    assert parsed.rulebase is None


@pytest.mark.parametrize(
    ("start", "piece", "end"),
    [
        ("rule if ", "(", ""),
        ("rule if e is ", "very ", "N then u is N"),
        ("rule if e is N ", "or e is N and ce is P ", "or e is N then u is N"),
        ("rules u\n  e \\ ce ", "N ", ""),
        ("term u A: linear ", "- ", "1"),
        ("term u A: linear ", "1*e + ", "1"),
        ('term u A: formula "', "(", '"'),
        ('term u A: formula "', "-", '1"'),
        ("term u A: points ", "(0, 0) ", ""),
        ("terms u: triangles ", "A ", ""),
        ("input x 0 .. ", "9", ""),
        ("inference ", "and min, ", "and min"),
    ],
)
def test_a_line_of_the_greatest_length(start, piece, end):
    text = HEAD + "rule if e is N then u is N\n" + start + filled(piece, LONG // 2) + end
    parsed = parse(text)
    render_all(parsed.diagnostics, text)
    if parsed.rulebase is not None:
        check(parsed.rulebase, parsed.document)


@pytest.mark.slow
def test_many_mistakes_end_the_reading():
    text = HEAD + "".join(f"rule if e is T{k} then u is N\n" for k in range(20_000))
    parsed = parse(text)
    assert len(parsed.diagnostics) == MAX_DIAGNOSTICS + 1
    assert parsed.diagnostics[-1].name == "too-many-mistakes"


@pytest.mark.slow
def test_as_many_lines_as_there_may_be():
    assert parse("# c\n" * 150_000).diagnostics[0].name != "file-too-large"
    (finding,) = parse("# c\n" * 150_001).diagnostics
    assert (finding.name, finding.line, finding.span.end_line) == (
        "file-too-large",
        150_001,
        150_001,
    )


@pytest.mark.parametrize(
    "levels", ["-6 .. 6 step 1e-320", "-6 .. 6 count inf", "-inf .. 6 count 3"]
)
def test_levels_beyond_counting(levels):
    text = f"{HEAD}rule if e is N then u is N\nlookup\n  levels e: {levels}\n"
    assert parse(text).rulebase is None
