"""What a beginner writes: one finding, with the line as it should be and a fix."""

from __future__ import annotations

import pytest

from fuzzyarm.base.diagnostic import Diagnostic
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.edit import apply_edits, fixes

TEXT = """\
rulebase tip "the tip"
input e -8.5 .. 8.5 "food, of the day"
input ce -1 .. 1
output u 0 .. 100
terms e: triangles NB NS PS PB
terms ce, u: triangles N Z P
term u X: triangle 0 0.5 1
inference defuzzifier centroid
rules u
  ce \\ e  NB  NS  PS  PB
  N        N   N   Z   P
  Z        N   Z   P   P
  P        Z   P   P   P
rule if e is NB and ce is N then u is N
expect e = 0, ce = 0 -> u > 1
"""

SLIPS = [
    ("rule if e", "if e"),
    ("rule if e is NB and ce is N then u is N", "IF e IS NB AND ce IS N THEN u IS N;"),
    ("rule if e is NB and ce is N then u is N", "RULE 1: IF e is NB AND ce is N THEN u is N;"),
    ("rule if e is NB and ce is N", "rule if e == NB && ce = N"),
    ("rule if e is NB and ce is N then", "rule if e is NB and ce is N ->"),
    ("  N        N   N   Z   P", "  N        N,  N,  Z,  P"),
    ("  N        N   N   Z   P", "  N        N;  N;  Z;  P;"),
    ("  N        N   N   Z   P", "| N      | N | N | Z | P |"),
    ("  ce \\ e  NB  NS  PS  PB", "  ce \\ e  NB, NS, PS, PB"),
    ("ce \\ e", "e \\ ce"),
    ("-8.5 .. 8.5", "-8,5 .. 8,5"),
    ("-8.5 .. 8.5", "−8.5 .. 8.5"),
    ("0 .. 100", "0 - 100"),
    ("0 .. 100", "0 to 100"),
    ("0 .. 100", "[0, 100]"),
    ("0 .. 100", "[0 100]"),
    ("0 .. 100", "0 ... 100"),
    ("0 .. 100", "0 … 100"),
    ("0 .. 100", "100 .. 0"),
    ("0 .. 100", "0 .. 100;"),
    ("0 0.5 1", "0, 0.5, 1"),
    ("0 0.5 1", "[0 0.5 1]"),
    ("0 0.5 1", "(0, 0.5, 1)"),
    ("0 0.5 1", "0 0,5 1"),
    ("X: tri", "X = tri"),
    ('"the tip"', "“the tip”"),
    ('"the tip"', "'the tip'"),
    ("centroid", "COG"),
    ("centroid", "Centroid"),
    ("rules u", "rules u:"),
    ("rules u", "rules for u"),
    ("output u", "Output u"),
]


def mended(text: str) -> str:
    (finding,) = check_text(text).diagnostics
    first = next(fix for fix in fixes(finding, text) if fix.preferred)
    return apply_edits(text, first.edits)


def words(text: str) -> list[list[str]]:
    return [line.split() for line in text.splitlines()]


def test_the_text_itself_is_sound() -> None:
    assert not [d for d in check_text(TEXT).diagnostics if d.is_error]


@pytest.mark.parametrize(("right", "wrong"), SLIPS)
def test_one_slip_is_one_finding_with_the_line_as_it_should_be(right: str, wrong: str) -> None:
    text = TEXT.replace(right, wrong, 1)
    pairs = zip(text.split("\n"), TEXT.split("\n"), strict=True)
    number = next(i for i, (before, after) in enumerate(pairs) if before != after)
    (finding,) = check_text(text).diagnostics
    assert finding.line == number + 1
    assert finding.is_error
    assert words(mended(text)) == words(TEXT)
    after = " ".join(TEXT.split("\n")[number].partition('"')[0].split())
    if not finding.hint.startswith("did you mean") and "of other programs" not in finding.hint:
        assert finding.hint.removeprefix("write  ") in after or after in finding.hint


@pytest.mark.parametrize("mark", [";", ","])
def test_every_line_with_a_mark_behind_it_is_one_finding(mark: str) -> None:
    text = "\n".join(f"{line}{mark}" for line in TEXT.splitlines())
    found = check_text(text).diagnostics
    assert [d.line for d in found] == list(range(1, len(TEXT.splitlines()) + 1))
    for finding in reversed(found):
        text = apply_edits(text, fixes(finding, text)[0].edits)
    assert words(text) == words(TEXT)


def test_a_missing_output_is_the_only_finding_and_has_its_name() -> None:
    text = TEXT.replace("output u 0 .. 100\n", "")
    (finding,) = check_text(text).diagnostics
    assert (finding.name, finding.line) == ("no-outputs", 5)
    assert "output u" in finding.hint


def test_missing_inputs_are_one_finding() -> None:
    text = "rulebase r\noutput u 0 .. 1\nterms e, u: triangles A B\nrule if e is A then u is B\n"
    (finding,) = check_text(text).diagnostics
    assert (finding.name, finding.line) == ("no-inputs", 3)


def test_a_family_that_is_not_known_lists_those_that_are() -> None:
    (finding,) = check_text(TEXT.replace("terms e: triangles", "terms e: bells")).diagnostics
    for family in ("triangles", "gaussians", "singletons"):
        assert family in finding.message


def test_a_line_full_of_strange_marks_is_one_finding() -> None:
    (finding,) = check_text(TEXT + "[Input1] {} ;\n").diagnostics
    assert "brackets" in finding.hint


@pytest.mark.parametrize("name", [n for n in shipped_names() if n.endswith(".frb")])
def test_what_is_sound_means_what_it_meant(name: str) -> None:
    text = shipped(name).read_text()
    assert parse(text).diagnostics == ()


def test_the_rest_of_a_file_is_judged_as_it_was_meant() -> None:
    text = TEXT.replace("rule if", "IF").replace("Z        N   Z", "Z        N   ZZ")
    assert [d.line for d in check_text(text).diagnostics] == [12, 14]
    assert check_text(text).diagnostics[0].name == "unknown-term"


def test_a_missing_family_is_one_finding_and_the_terms_are_known():
    text = (
        "rulebase r\ninput e -1 .. 1\noutput u -1 .. 1\nterms e: N Z P\nterms u: triangles N Z P\n"
        "rules u\n  e N Z P\n  u N Z P\n"
    )
    (finding,) = parse(text).diagnostics
    assert "triangles, gaussians, singletons" in finding.message
    assert finding.replacement == "triangles N"


# --- What engineers bring from elsewhere ---

FAN = """\
rulebase fan "speed of a fan"
input temp 0 .. 40 "temperature"
input h 0 .. 100
output v 0 .. 10
terms temp: triangles COLD OK HOT
terms h: triangles DRY WET
term v LOW: triangle 0 2 5
term v HIGH: triangle 5 8 10
inference and min, or max, aggregation max, defuzzifier centroid
rules v
  temp \\ h  DRY  WET
  COLD       LOW  .
  OK         LOW  HIGH
  HOT        HIGH HIGH*0.5
rules v when h is WET
  temp  COLD  OK  HOT
  v     LOW   .   HIGH
rule if temp is not HOT then v is LOW with 0.5
expect temp = 40, h = 100 -> v > 5
prove v in 0 .. 10
prove v rises with temp
"""

MORE_SLIPS = [
    ("input temp 0", "input temp := 0"),
    ("input temp 0", "input temp: 0"),
    ("input temp 0", "input temp range 0"),
    ("input temp 0 .. 40", "input temp in [0, 40]"),
    ("LOW: triangle 0 2 5", "LOW triangle 0 2 5"),
    ("LOW: triangle 0 2 5", "LOW: trimf 0 2 5"),
    ("LOW: triangle 0 2 5", "LOW = trimf([0 2 5])"),
    ("LOW: triangle 0 2 5", "LOW: triangle 5 2 0"),
    ("and min, or max", "and = min, or = max"),
    ("and min, or max", "AND : MIN, OR : MAX"),
    ("LOW  .", "LOW  -"),
    ("rules v when h is WET", "rules v when h = WET"),
    ("rules v\n", "rules v =\n"),
    ("temp is not HOT", "not temp is HOT"),
    ("with 0.5", "(0.5)"),
    ("with 0.5", "weight 0.5"),
    ("with 0.5", "with 0,5"),
    ("->", "=>"),
    ("->", "→"),
]


def errors(text: str) -> list[Diagnostic]:
    return [each for each in check_text(text).diagnostics if each.is_error]


def test_the_fan_itself_is_sound() -> None:
    assert parse(FAN).diagnostics == ()


@pytest.mark.parametrize(("right", "wrong"), MORE_SLIPS)
def test_one_slip_of_elsewhere_is_one_finding(right: str, wrong: str) -> None:
    text = FAN.replace(right, wrong, 1)
    assert text != FAN
    (finding,) = parse(text).diagnostics
    first = next(fix for fix in fixes(finding, text) if fix.preferred)
    assert format_text(apply_edits(text, first.edits)) == format_text(FAN)
    assert finding.hint.removeprefix("write  ") in " ".join(FAN.split()) or "here" in finding.hint


HINTS = {
    "expect temp = 0 -> v > 5": ("missing: h", "add  h = 0"),
    "drive v = u": ("no statement", "below a line  controller NAME"),
    "gain K = 3": ("no statement", "below a line  controller NAME"),
    "period 1 ms": ("no statement", "below a line  controller NAME"),
}


@pytest.mark.parametrize("line", HINTS)
def test_a_line_that_needs_more_says_what(line: str) -> None:
    said, hint = HINTS[line]
    (finding,) = parse(f"{FAN}{line}\n").diagnostics
    assert finding.line == FAN.count("\n") + 1
    assert said in finding.message
    assert hint in finding.hint


LIKE_EXAMPLES = {
    "term LOW: triangle 0 2 5": "a term belongs to a variable",
    "rule if temp is HOT and h is WET then v is HIGH else v is LOW": "a rule has no else",
    "rule if temp is HOT and h > 80.5 then v is HIGH": "a rule tests terms, not numbers",
}


@pytest.mark.parametrize("line", LIKE_EXAMPLES)
def test_a_line_like_an_example_gets_its_sentence(line: str) -> None:
    (finding,) = parse(f"{FAN}{line}\n").diagnostics
    assert (finding.line, finding.message) == (FAN.count("\n") + 1, LIKE_EXAMPLES[line])
    assert finding.hint


def test_a_line_that_stops_elsewhere_keeps_the_words_of_the_parser() -> None:
    (finding,) = parse(f"{FAN}rule if temp is HOT then v is viery HIGH\n").diagnostics
    assert "viery" in finding.message
    (finding,) = parse(f"{FAN}rule if temp + 3 is HOT then v is HIGH\n").diagnostics
    assert finding.message == "expected 'is' after the variable 'temp', found '+'"


@pytest.mark.parametrize(
    ("variable", "terms"),
    [("temp", "COLD OK HOT"), ("input1", "NB ZE PB"), ("out", "IN MID OUT"), ("e", "low mid top"),
     ("rate", "ON OFF ANY"), ("tuned", "A B C")],
)  # fmt: skip
def test_a_grid_may_stand_without_indentation_whatever_its_names(variable: str, terms: str) -> None:
    text = FAN.replace("temp", variable)
    for new, old in zip(terms.split(), ("COLD", "OK", "HOT"), strict=True):
        text = text.replace(old, new)
    assert parse(text).diagnostics == ()
    flat = "\n".join(line.lstrip() for line in text.split("\n"))
    parsed = parse(flat)
    assert parsed.diagnostics == ()
    assert parsed.rulebase == parse(text).rulebase
    assert format_text(flat) == format_text(text)


def test_a_grid_without_a_header_is_one_finding_and_has_it() -> None:
    text = FAN.replace("LOW  .", "LOW  LOW").replace("  temp \\ h  DRY  WET\n", "", 1)
    (finding,) = parse(text).diagnostics
    assert finding.name == "missing-header"
    assert finding.hint == "write  temp \\ h  DRY  WET  above"


def test_a_name_that_starts_with_a_digit_is_one_finding() -> None:
    sound = FAN.replace("HOT", "'1HOT'").replace("prove v rises with temp\n", "")
    assert errors(sound) == []
    (finding,) = errors(sound.replace("triangles COLD OK '1HOT'", "triangles COLD OK 1HOT"))
    assert finding.name == "bad-number"


def test_terms_without_a_finite_range_are_one_finding() -> None:
    (finding,) = errors(FAN.replace("0 .. 40", "0 .. inf"))
    assert finding.name == "bad-range"


def test_a_swapped_range_is_one_finding_whatever_counts_on_it() -> None:
    text = FAN.replace("0 .. 40", "40 .. 0") + "lookup\n  levels 0 .. 40 step 1\n"
    (finding,) = parse(text).diagnostics
    assert finding.name == "bad-range"


TEXTS_OF_OTHERS = {
    "FUNCTION_BLOCK a\nVAR_INPUT\n t : REAL;\nEND_VAR\nFUZZIFY t\nEND_FUZZIFY\n": "FCL",
    "[System]\nName='a'\nType='mamdani'\n[Input1]\nName='x'\n": "a FIS of MATLAB",
    "Engine: a\nInputVariable: x\n  enabled: true\n  range: 0 1\n": "FLL",
    "<?xml version='1.0'?>\n<fuzzySystem>\n<a/>\n</fuzzySystem>\n": "FML",
    "PROGRAM main\nVAR\n x : REAL;\nEND_VAR\nx := 1;\nEND_PROGRAM\n": "Structured Text",
    "import numpy as np\nimport skfuzzy as fuzz\nx = fuzz.trimf(np.arange(9), [0, 1, 2])\n": (
        "a program in Python"
    ),
}


@pytest.mark.parametrize("text", TEXTS_OF_OTHERS)
def test_a_text_of_another_program_is_called_that_once(text: str) -> None:
    (finding,) = check_text(text).diagnostics
    assert finding.message == f"this is {TEXTS_OF_OTHERS[text]}, not the language of .frb files"
    assert finding.hint


def test_a_name_in_double_quotes_is_shown_in_single_ones_once():
    text = (
        'rulebase a\ninput "Grad-Zahl Ü" 0 .. 1\noutput y 0 .. 4\nterm "Grad-Zahl Ü" a: ramp 1 0\n'
        'term y p: triangle 0 1 2\nrule if "Grad-Zahl Ü" is a then y is p\n'
    )
    (finding,) = parse(text).diagnostics
    assert (finding.name, finding.line) == ("double-quoted-name", 2)
    assert finding.hint == "write  'Grad-Zahl Ü'"
    assert finding.replacement == "'Grad-Zahl Ü'"
    assert not parse(text.replace('"', "'")).diagnostics


def test_an_unknown_statement_is_one_finding_with_the_lines_below_it():
    text = (
        "rulebase rb\ninput e -1 .. 1\noutput u -1 .. 1\nterms e, u: triangles N Z P\n"
        "matrix u by e\n  e N Z P\n  u N Z P\nrule if e is N then u is N\n"
    )
    (finding,) = parse(text).diagnostics
    assert (finding.name, finding.span.line) == ("unknown-statement", 5)
