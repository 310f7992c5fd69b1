"""What a beginner writes: one finding, with the line as it should be and a fix."""

from __future__ import annotations

import pytest

from fuzzyarm.api import check_text
from fuzzyarm.language import parse
from fuzzyarm.language.queries import apply_edits, fixes
from fuzzyarm.shipped_files import shipped, shipped_names

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
    ("ce \\ e", "ce / e"),
    ("ce \\ e", "ce/e"),
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
    if not finding.hint.startswith("did you mean"):
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
