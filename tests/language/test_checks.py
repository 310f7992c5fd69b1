"""Each check finds what it is for, and is silent where nothing is wrong."""

import re
from pathlib import Path

import pytest

from fuzzyarm.api import check_text
from fuzzyarm.language.check import CHECKS
from fuzzyarm.shipped_files import shipped, shipped_names
from fuzzyarm.text.diagnostic import Severity

DOCS = Path(__file__).parents[2] / "docs" / "checks.md"
SOURCES = Path(__file__).parents[2] / "src" / "fuzzyarm"
PD7 = shipped("pd7.frb").read_text()


def findings(text):
    return [(d.name, d.line, d.column) for d in check_text(text).diagnostics]


def names(text):
    return [name for name, _, _ in findings(text)]


def damaged(old, new):
    assert PD7.count(old) == 1, old
    return PD7.replace(old, new)


@pytest.mark.parametrize("name", [n for n in shipped_names() if n.endswith(".frb")])
def test_shipped_files_pass_without_any_finding(name):
    assert check_text(shipped(name).read_text()).diagnostics == ()


def test_an_empty_cell_is_a_missing_rule_at_its_place():
    text = damaged("NM      NB  NM  NM", "NM      .   NM  NM")
    assert ("missing-rule", 15, 11) in findings(text)
    assert "no-rule-fires" in names(text)


def test_an_absent_row_and_an_absent_column_are_missing_rules():
    row = damaged("  PB      ZE  PS  PS  PM  PB  PB  PB\n", "")
    assert names(row).count("missing-rule") == 1
    column = re.sub(r"(?m)^(  (?:e \\ ce|[NPZ][BMSE] {5}) .*?)  \w\w$", r"\1", PD7)
    found = [d for d in check_text(column).diagnostics if d.name == "missing-rule"]
    assert ["ce is PB" in d.message for d in found] == [True]


def test_no_rule_fires_gives_an_input_that_proves_it():
    from fuzzyarm.inference import infer

    text = damaged("ZE      NB  NM  NS  ZE", "ZE      NB  NM  NS  .")
    (found,) = [d for d in check_text(text).diagnostics if d.name == "no-rule-fires"]
    point = {k: float(v) for k, v in re.findall(r"(\w+) = (-?[\d.]+)", found.message)}
    with pytest.raises(ArithmeticError):
        infer(check_text(text).rulebase, point)


def test_a_stated_default_makes_it_an_info():
    text = damaged("ZE      NB  NM  NS  ZE", "ZE      NB  NM  NS  .")
    stated = text.replace("no-rule error", "no-rule 0")
    (found,) = [d for d in check_text(stated).diagnostics if d.name == "no-rule-fires"]
    assert found.severity is Severity.INFO


def test_rules_with_one_antecedent_contradict_or_repeat_each_other():
    text = damaged(
        "\nlookup",
        "rule if ce is NB and e is NB then u is PB\n"
        "rule if e is NM and ce is NB then u is NB\n\nlookup",
    )
    by_name = {d.name: d for d in check_text(text).diagnostics}
    contradiction, repeat = by_name["contradictory-rules"], by_name["duplicate-rule"]
    assert (contradiction.line, contradiction.related[0].span.line) == (21, 14)
    assert (contradiction.related[0].span.column, repeat.related[0].span.column) == (11, 11)
    assert contradiction.is_error
    assert not repeat.is_error


def test_two_grids_that_overlap_contradict_each_other_by_cell():
    text = damaged("\nlookup", "rules u\n  e \\ ce  NB\n  NB      PB\n\nlookup")
    assert ("contradictory-rules", 23, 11) in findings(text)


def test_unused_terms_and_variables():
    text = damaged('"control, normalised"', '"control, normalised"\noutput spare 0 .. 1')
    assert names(text)[0] == "unused-variable"
    text = damaged("\ninference", "term u X: triangle 0 1 2\n\ninference")
    assert names(text) == ["unused-term"]


def test_a_shared_name_that_one_variable_uses_is_used():
    text = (
        "rulebase t\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles L M H\n"
        "rules u\n  a L M H\n  u L L H\n"
    )
    assert names(text) == []


@pytest.mark.parametrize(
    ("terms", "where"),
    [
        (("triangle -6 -6 -2", "triangle 2 6 6"), "-2 .. 2"),
        (("trapezoid -6 -6 -3 0", "trapezoid 0 3 6 6"), "covers 0"),
        (("trapezoid -6 -6 -3 1", "triangle 0 2 4"), "4 .. 6"),
        (("rectangle -6 -1", "rectangle 1 6"), "-1 .. 1"),
    ],
)
def test_gaps_of_coverage_are_given_as_intervals(terms, where):
    text = (
        "rulebase t\ninput e -6 .. 6\noutput u 0 .. 1\nterms u: triangles A B\n"
        f"term e L: {terms[0]}\nterm e H: {terms[1]}\n"
        "rule if e is L then u is A\nrule if e is H then u is B\n"
    )
    (gap,) = [d for d in check_text(text).diagnostics if d.name == "coverage-gap"]
    assert where in gap.message


def test_a_cliff_in_the_grid_is_a_jump():
    text = damaged("PS      NM  NS  ZE  PS  PS", "PS      NM  NS  ZE  PS  NB")
    found = names(text)
    assert found.count("jump") == 4
    assert found.count("broken-antisymmetry") == 1


def test_one_wrong_cell_breaks_the_antisymmetry_and_the_mirror_is_named():
    text = damaged("NM      NB  NM  NM  NM  NS  ZE  PS", "NM      NB  NM  NM  NM  NS  NS  PS")
    (found,) = check_text(text).diagnostics
    assert (found.name, found.line, found.column) == ("broken-antisymmetry", 19, 15)
    assert found.related[0].span.line == 15
    assert "'PS'" in found.hint


def test_one_wrong_cell_breaks_the_symmetry():
    alpha = shipped("alpha7.frb").read_text()
    text = alpha.replace("PB      ZE  S   SB", "PB      VS  S   SB")
    assert "broken-symmetry" in names(text)


def test_a_failing_expectation_tells_what_came_out():
    text = damaged("expect e = 0, ce = 0 -> u = 0", "expect e = 1, ce = 0 -> u = 0")
    (found,) = check_text(text).diagnostics
    assert (found.name, found.line) == ("failed-expectation", 27)
    assert check_text(text).failed


def test_an_allow_comment_silences_its_line_and_only_that():
    text = damaged("NM      NB  NM  NM  NM  NS  ZE  PS", "NM      NB  .   NM  NM  NS  ZE  PS")
    assert "missing-rule" in names(text)
    silenced = text.replace("NS  ZE  PS\n", "NS  ZE  PS  # allow missing-rule\n", 1)
    assert "missing-rule" not in names(silenced)
    elsewhere = text.replace("rules u\n", "rules u  # allow missing-rule\n")
    assert "missing-rule" in names(elsewhere)


def test_allow_comments_that_do_nothing_are_named():
    assert names(PD7.replace("rules u\n", "rules u  # allow jump\n")) == ["useless-allow"]
    assert names(PD7.replace("rules u\n", "rules u  # allow jmp\n")) == ["unknown-allow"]


@pytest.mark.parametrize(
    ("terms", "defuzzifier", "name"),
    [
        ("linear 1*e", "centroid", "defuzzifier-does-not-fit"),
        ("singleton 0", "centroid", "mixed-output-terms"),
        ("triangle 0 1 2", "tsukamoto", "defuzzifier-does-not-fit"),
        ("singleton 0", "weighted-average", None),
        ("ramp 0 1", "tsukamoto", None),
    ],
)
def test_a_defuzzifier_must_fit_its_terms(terms, defuzzifier, name):
    other = "ramp 1 0" if defuzzifier == "tsukamoto" else "triangle 0 0.5 1"
    text = (
        "rulebase t\ninput e 0 .. 1\noutput u 0 .. 1\nterms e: triangles L H\n"
        f"term u A: {terms}\nterm u B: {other}\ninference defuzzifier {defuzzifier}\n"
        "rule if e is L then u is A\nrule if e is H then u is B\n"
    )
    assert (name in names(text)) if name else names(text) == []


def test_every_check_has_its_line_in_the_docs_with_its_severity():
    page = DOCS.read_text()
    for name, check in CHECKS.items():
        assert f"| `{name}` | {check.severity} | {check.doc} |" in page
    rows = re.findall(r"^\| `([\w-]+)` \| (?:error|warning|info) \|", page, re.MULTILINE)
    assert rows == list(CHECKS)


def test_every_diagnostic_of_the_language_is_in_the_docs():
    page = DOCS.read_text()
    files = [
        path for room in ("text", "model", "language") for path in (SOURCES / room).rglob("*.py")
    ]
    source = "\n".join(path.read_text() for path in files)
    used = set(re.findall(r'(?:Diagnostic|report)\(\s*"([a-z-]+)"', source))
    assert len(used) > 50
    assert sorted(name for name in used if f"`{name}`" not in page) == []


def test_a_nearly_empty_grid_is_not_symmetric_by_its_zeros():
    terms = "NB NM NS ZE PS PM PB"
    rows = "".join(
        f"  {label}  "
        + " ".join("PS" if (i, j) in ((1, 5), (2, 3)) else "ZE" for j in range(7))
        + "\n"
        for i, label in enumerate(terms.split())
    )
    text = (
        "rulebase t\ninput e -6 .. 6\ninput ce -6 .. 6\noutput u -6 .. 6\n"
        f"terms e, ce, u: triangles {terms}\nrules u\n  e \\ ce {terms}\n{rows}"
    )
    assert not {"broken-symmetry", "broken-antisymmetry"} & set(names(text))
