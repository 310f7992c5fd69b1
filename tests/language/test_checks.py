"""Each check finds what it is for, and is silent where nothing is wrong."""

import itertools
import re
import sys
import textwrap
from dataclasses import replace
from pathlib import Path

import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import rulebases

from fuzzyarm.base.diagnostic import Severity
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.exchange.files import check_text
from fuzzyarm.inference import infer
from fuzzyarm.language import parse
from fuzzyarm.language.check import CHECKS, check
from fuzzyarm.language.check.coverage import uncovered_point
from fuzzyarm.language.check.search import GapSearch, Need, VariableStretch
from fuzzyarm.language.check.subject import Subject
from fuzzyarm.language.document import Document
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    propositions,
)

DOCS = Path(__file__).parents[2] / "docs" / "reference" / "checks.md"
TESTS = Path(__file__).parents[1]
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


@pytest.mark.parametrize(("settings", "fires"), [("", True), (", threshold 1e-5", False)])
def test_a_rule_fires_with_any_strength_above_the_threshold(settings, fires):
    text = (
        textwrap.dedent("""\
        rulebase dimmer
        input  ambient  0 .. 1
        output power    0 .. 1
        term ambient bright:  bell 0.75 0.2 3
        term power low:   triangle 0 0.25 0.5
        inference aggregation max, defuzzifier centroid, no-rule error, outside extend
        """)
        + f"block all: and product{settings}\nrule if ambient is very bright then power is low\n"
    )
    bell = 1 / (1 + (0.75 / 0.2) ** 6)
    assert 0 < bell**2 < 1e-6  # the least strength, at ambient = 0
    assert ("no-rule-fires" in names(text)) is not fires
    if fires:
        infer(check_text(text).rulebase, {"ambient": 0.0})


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
    assert names(text) == ["crossed-terms", "unused-term"]


def test_a_shared_name_that_one_variable_uses_is_used():
    text = (
        "rulebase t\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles L M H\n"
        "rules u\n  a L M H\n  u L L H\n"
    )
    assert names(text) == ["short-reach"]


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
    for name, record in CHECKS.items():
        assert f"| `{name}` | {record.severity} | {record.doc} |" in page
    rows = re.findall(r"^\| `([\w-]+)` \| (?:error|warning|info) \|", page, re.MULTILINE)
    assert rows == list(CHECKS)


def test_every_check_is_found_by_a_test():
    tests = "\n".join(path.read_text("utf-8") for path in TESTS.rglob("test_*.py"))
    assert [name for name in CHECKS if f'"{name}"' not in tests] == []


def test_every_diagnostic_of_the_language_is_in_the_docs():
    page = DOCS.read_text()
    files = [
        path for room in ("base", "language", "control") for path in (SOURCES / room).rglob("*.py")
    ]
    source = "\n".join(path.read_text() for path in files)
    used = set(re.findall(r'(?:Diagnostic|report)\(\s*"([a-z-]+)"', source))
    assert len(used) > 100
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


def rising(low, high, rows, columns, cells, terms="A B C D"):
    """Return a grid over two inputs of one range that rises from corner to corner."""
    body = "".join(f"  {row}  {line}\n" for row, line in zip(rows, cells, strict=True))
    return (
        f"rulebase t\ninput a {low} .. {high}\ninput b {low} .. {high}\noutput u 0 .. 1\n"
        f"terms a: triangles {' '.join(rows)}\nterms b: triangles {' '.join(columns)}\n"
        f"terms u: triangles {terms}\nrules u\n  a \\ b  {'  '.join(columns)}\n{body}"
    )


FAN = (
    ("KMWH", "DFW", ["A A B", "A B B", "B C D", "C D D"]),
    ("KMH", "DFW", ["A B B", "B C D", "C D E"], "A B C D E"),
)
"""Two fans of which five pairs of six, and four of five, happen to mirror each other."""


@pytest.mark.parametrize("fan", FAN)
@pytest.mark.parametrize("ends", [(0, 40), (10, 30), (-10, 50), (-40, 0)])
def test_a_grid_over_inputs_without_opposites_has_no_slip_of_symmetry(fan, ends):
    assert of_symmetry(rising(*ends, *fan)) == []


@pytest.mark.parametrize("fan", FAN)
@pytest.mark.parametrize("ends", [(-1, 1), (-40, 38), (-3, 3.2)])
def test_the_same_grid_about_zero_has_one(fan, ends):
    (found,) = of_symmetry(rising(*ends, *fan))
    assert found.name == "broken-antisymmetry"


def test_one_input_without_opposites_is_enough():
    text = rising(-1, 1, *FAN[0]).replace("input b -1 .. 1", "input b 0 .. 1")
    assert of_symmetry(text) == []


def test_a_condition_without_opposites_stays_as_it_is():
    """What is on either side of `p` need not mirror; each grid by itself may."""
    slip = two_grids({**mirrored_cells(), ("P", "P", "Z"): "NB"})
    assert len(of_symmetry(slip)) == 1
    assert of_symmetry(slip.replace("input p -1 .. 1", "input p 0 .. 1")) == []


# --- Points at which no rule fires, whatever the shapes and however many the inputs ---

ALL_BUT_THE_MIDDLE = "".join(
    f"rule if a is {x} and b is {y} and c is {z} then u is M\n"
    for x, y, z in itertools.product("LMH", repeat=3)
    if (x, y, z) != ("M", "M", "M")
)


@pytest.mark.parametrize(
    ("left", "middle", "right"),
    [
        ("z 0 0.5", "triangle 0 0.5 1", "s 0.5 1"),
        ("ramp 0.5 0", "triangle 0 0.5 1", "ramp 0.5 1"),
        ("cosine 0 1", "pi 0 0.5 0.5 1", "cosine 1 1"),
        ("semi-ellipse -0.5 0.5", "points (0, 0) (0.5, 1) (1, 0)", "arc 0.5 1"),
    ],
)
def test_one_empty_cell_of_three_inputs_is_found_whatever_the_shapes(left, middle, right):
    terms = "".join(
        f"term {v} L: {left}\nterm {v} M: {middle}\nterm {v} H: {right}\n" for v in "abc"
    )
    text = (
        "rulebase t\ninput a 0 .. 1\ninput b 0 .. 1\ninput c 0 .. 1\noutput u 0 .. 1\n"
        f"terms u: singletons L M\ninference defuzzifier weighted-average\n{terms}"
    )
    found = {d.name: d.message for d in check_text(text + ALL_BUT_THE_MIDDLE).diagnostics}
    assert "fires at a = 0.5, b = 0.5, c = 0.5" in found["no-rule-fires"]
    assert "covers a is M and b is M and c is M" in found["missing-rule"]


def many_inputs(count, rules):
    names = [f"x{i}" for i in range(count)]
    inputs = "".join(f"input {name} 0 .. 1\n" for name in names)
    terms = f"terms {', '.join(names)}, u: triangles L H\n"
    return f"rulebase t\n{inputs}output u 0 .. 1\n{terms}{rules}"


@pytest.mark.parametrize("count", [4, 12, 32])
def test_a_hole_among_many_inputs_is_found(count):
    everything = " and ".join(f"x{i} is H" for i in range(count))
    rules = f"rule if {everything} then u is H\nrule if x0 is not H then u is L\n"
    found = {d.name: d.message for d in check_text(many_inputs(count, rules)).diagnostics}
    assert "x0 = 1, x1 = 0" in found["no-rule-fires"]


@pytest.mark.parametrize("count", [4, 12, 32])
def test_rules_that_leave_nothing_open_are_seen_to(count):
    rules = "".join(
        f"rule if {''.join(f'x{j} is H and ' for j in range(i))}x{i} is L then u is L\n"
        for i in range(count)
    )
    everything = " and ".join(f"x{i} is H" for i in range(count))
    text = many_inputs(count, rules + f"rule if {everything} then u is H\n")
    assert not {"no-rule-fires", "missing-rule", "undecided"} & set(names(text))


def test_a_search_that_gives_up_says_so():
    # Pairs of pigeons in one hole: a hard proof that no point is free, for any such search.
    holes, pigeons = 7, 8
    names_of = [[f"x{p * holes + h}" for h in range(holes)] for p in range(pigeons)]
    rules = [" and ".join(f"'{n}' is L" for n in row) for row in names_of]
    rules += [
        f"'{names_of[p][h]}' is H and '{names_of[q][h]}' is H"
        for h in range(holes)
        for p, q in itertools.combinations(range(pigeons), 2)
    ]
    inputs = tuple(
        Input(n, 0.0, 1.0, (Term("L", Shape("ramp", (1, 0))), Term("H", Shape("ramp", (0, 1)))))
        for row in names_of
        for n in row
    )
    output = Output("u", 0.0, 1.0, (Term("A", Shape("triangle", (0, 0.5, 1))),))
    made = tuple(
        Rule(
            And(tuple(Is(p.split("'")[1], p[-1]) for p in each.split(" and "))),
            (Consequent("u", "A"),),
        )
        for each in rules
    )
    found = check(RuleBase("pigeons", inputs, (output,), (RuleBlock(made),)))
    undecided = [d for d in found if d.name == "undecided"]
    assert [d.severity for d in undecided] == [Severity.INFO] * 2
    assert not {"no-rule-fires", "missing-rule"} & {d.name for d in found}


@pytest.mark.slow
@settings(max_examples=cases(10, 40))
@given(rulebases())
def test_a_point_without_a_rule_is_one(rulebase):
    from fuzzyarm.inference import infer
    from fuzzyarm.inference.errors import NoRuleFiredError

    stated = replace(rulebase, outputs=tuple(replace(o, no_rule="error") for o in rulebase.outputs))
    subject = Subject(stated, Document(()))
    for output in stated.outputs:
        rules = [rule for _, rule in subject.rules_for(output) if rule.weight > 0]
        asked = {p.variable for rule in rules for p in propositions(rule.antecedent)}
        if not rules or not asked <= {v.name for v in stated.inputs}:
            continue
        point = uncovered_point(output, subject)
        if point is None:
            continue
        alone = replace(
            stated,
            outputs=(output,),
            blocks=tuple(
                replace(block, rules=tuple(r for r in block.rules if r in rules))
                for block in stated.blocks
            ),
        )
        with pytest.raises(NoRuleFiredError):
            infer(alone, point)


@given(st.lists(st.lists(st.integers(0, 8), min_size=1, max_size=3), min_size=1, max_size=12))
def test_the_search_finds_a_hole_wherever_there_is_one(rules):
    # Three variables with three literals each, which hold one at a time.
    cells = {n: [VariableStretch(i, {(str(i), ()): 1.0}) for i in range(3)] for n in "abc"}
    needs = []
    for rule in rules:
        wanted = {}
        for number in rule:
            name = "abc"[number // 3]
            wanted[name] = wanted.get(name, frozenset()) | {(str(number % 3), ())}
        needs.append(Need(wanted))
    found = {
        point
        for each in GapSearch(needs, cells).uncovered()
        for point in itertools.product(
            *([int(each[n].x)] if n in each else range(3) for n in "abc")
        )
    }
    brute = {
        point
        for point in itertools.product(range(3), repeat=3)
        if not any(
            all(wanted == {(str(point["abc".index(n)]), ())} for n, wanted in need.literals.items())
            for need in needs
        )
    }
    assert found == brute


# --- What is linear stays linear: steps are counted, not seconds ---


def steps_of(text):
    """Return how many lines of Python a check runs: a measure that no other process disturbs."""
    parsed = parse(text)
    count = 0

    def trace(frame, event, argument):
        nonlocal count
        count += 1
        return trace

    sys.settrace(trace)
    try:
        check(parsed.rulebase, parsed.document)
    finally:
        sys.settrace(None)
    return count


def a_points_term(size):
    pairs = " ".join(f"({i}, {0.5 + i % 2 / 2})" for i in range(size))
    lines = "\n  ".join(textwrap.wrap(pairs, 5000))
    return f"rulebase t\ninput a 0 .. {size}\noutput u 0 .. 1\nterms u: triangles A B\n" + (
        f"term a T: points\n  {lines}\nrule if a is T then u is A\n"
    )


def a_grid(size):
    terms = " ".join(f"t{i}" for i in range(size))
    rows = "".join(
        f"  t{i} " + " ".join(f"t{(i + j) // 2}" for j in range(size)) + "\n" for i in range(size)
    )
    return (
        "rulebase t\ninput a 0 .. 1\ninput b 0 .. 1\noutput u 0 .. 1\n"
        f"terms a, b, u: triangles {terms}\nrules u\n  a \\ b {terms}\n{rows}"
    )


def many_grids(size):
    grid = "rules u\n  a L H\n  u L H\n"
    return "rulebase t\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles L H\n" + "".join(
        f"block b{i}\n{grid}" for i in range(size)
    )


def many_holes(size):
    rules = "".join(f"rule if x{i} is not L then u is H\n" for i in range(size))
    return many_inputs(size, rules)


@pytest.mark.parametrize(
    ("make", "size", "growth"),
    [(a_points_term, 200, 1), (a_grid, 8, 2), (many_grids, 40, 1), (many_holes, 8, 1)],
)
def test_the_work_of_a_check_grows_with_the_file(make, size, growth):
    steps_of(make(4))  # what is worked out at the first use only
    small, large = steps_of(make(size)), steps_of(make(4 * size))
    assert large < 1.6 * 4**growth * small


# --- Terms, conclusions and reach ---


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("term u FAST: singleton 0.2", "core-outside-range"),
        ("term u FAST: singleton 0.1", None),
        ("inference u: outside extend\nterm u FAST: singleton 0.2", None),
        ("term a X: triangle 1 2 3", "core-outside-range"),
        ("term a X: gaussian 1.5 1", "core-outside-range"),
        ("term a X: sigmoid 0.9 5", None),
        ("term a X: sigmoid 1.9 5", "core-outside-range"),
        ("term a X: trapezoid -inf -inf 0 1", None),
        ("term a X: trapezoid -2 -1 3 4", None),
        ("inference a: outside extend\nterm a X: triangle 1 2 3", None),
    ],
)
def test_a_term_that_is_fullest_outside_its_range_is_told(line, name):
    text = (
        "rulebase t\ninput a 0 .. 1\noutput u 0 .. 0.1\nterms a: triangles L H\n"
        f"term u SLOW: singleton 0\ninference defuzzifier weighted-average\n{line}\n"
        "rule if a is L then u is SLOW\nrule if a is H then u is SLOW\n"
    )
    found = {d.name: d for d in check_text(text).diagnostics}
    assert ("core-outside-range" in found) == (name is not None)
    if "singleton 0.2" in line and name:
        assert "the output is cut to 0.1" in found[name].message


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("sqrt(x - 3) / 3", "has no value at x = 0, where its degree counts as 0"),
        ("log(x - 5)", "has no value at x = 0"),
        ("2 * sqrt(x)", "is 6.325 at x = 10; a degree lies in 0 .. 1"),
        ("x / 5 - 1", "is -1 at x = 0"),
        ("exp(-x)", ""),
        ("min(1, sqrt(abs(x - 3)))", ""),
    ],
)
def test_a_formula_that_is_no_degree_is_told(formula, message):
    text = (
        "rulebase t\ninput a 0 .. 1\noutput u 0 .. 10\nterms a: triangles L H\n"
        f'term u SLOW: triangle 0 1 2\nterm u FAST: formula "{formula}"\n'
        "rule if a is L then u is SLOW\nrule if a is H then u is FAST\n"
    )
    found = [each for each in check_text(text).diagnostics if each.name == "formula-degrees"]
    assert [message in each.message and each.line == 6 for each in found] == [True] * bool(message)


def test_a_linear_consequent_that_is_cut_is_an_info():
    text = (
        "rulebase t\ninput a 0 .. 2\noutput u 0 .. 5\nterms a: triangles L H\n"
        "term u F: linear 2*a + 3\nterm u G: linear a\n"
        "inference defuzzifier weighted-average, aggregation sum\n"
        "rule if a is L then u is G\nrule if a is H then u is F\n"
    )
    (found,) = check_text(text).diagnostics
    assert (found.name, found.line, found.severity) == ("clamped-output", 5, Severity.INFO)
    assert names(text.replace("0 .. 5", "0 .. 7")) == []
    assert "clamped-output" not in names(text.replace("sum", "sum, outside extend"))


def test_a_claim_may_reach_to_the_ends_of_a_range():
    claims = ("e in -6 .. 6 -> u in -6 .. 6", "e in -6 .. 0 -> u <= 6", "e in 0 .. 6 -> u >= -6")
    for claim in claims:
        assert names(f"{PD7}\nprove {claim}\n") == names(PD7)
    for claim in ("e in -6.5 .. 0 -> u <= 6", "e in 0 .. 7 -> u >= -6"):
        assert "bad-range" in names(f"{PD7}\nprove {claim}\n")


def test_an_output_that_stays_away_from_its_ends_is_told_once_with_its_reach():
    text = (
        "rulebase t\ninput a 0 .. 1\noutput u 0 .. 100\nterms a, u: triangles OFF HALF ON\n"
        "rules u\n  a OFF HALF ON\n  u OFF HALF ON\n"
    )
    (found,) = check_text(text).diagnostics
    assert (found.name, found.severity) == ("short-reach", Severity.INFO)
    assert "16.67 .. 83.33" in found.message
    assert names(text.replace("0 .. 100\n", "0 .. 100  # allow short-reach\n")) == []
    wide = text + "inference u: defuzzifier largest-of-maximum\n"
    assert names(wide) == []


@pytest.mark.parametrize("method", ["centroid exact", "centroid(101)", "bisector(50)"])
def test_a_set_without_area_is_told_where_an_area_counts(method):
    text = (
        "rulebase t\ninput a 0 .. 1\noutput u -30 .. 30\nterms a: triangles L H\n"
        "term u lo: triangle 10 10 10\nterm u hi: trapezoid 30 30 30 30\n"
        "rules u\n  a L  H\n  u lo hi\n"
    )
    checked = check_text(f"{text}inference u: defuzzifier {method}\n").diagnostics
    assert [found.message for found in checked if found.name == "no-area"] == [
        f"'lo' of 'u' has no area: the {method.split()[0].split('(')[0]} does not count it"
    ]
    assert "short-reach" not in [found.name for found in checked]
    assert names(f"{text}inference u: defuzzifier mean-of-maximum\n") == []
    single = text.replace("triangle 10 10 10", "singleton 10").replace(
        "trapezoid 30 30 30 30", "singleton 30"
    )
    assert "no-area" not in names(single)


# --- Conflicts within one rule; conditions of grids ---


@pytest.mark.parametrize(
    ("second", "name", "words"),
    [
        ("H", "contradictory-rules", "says both u is L and u is H"),
        ("L", "duplicate-rule", "says u is L twice"),
    ],
)
def test_a_rule_that_contradicts_itself_is_not_called_another(second, name, words):
    text = (
        "rulebase t\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles L H\n"
        f"rule if a is L then u is L and u is {second}\nrule if a is H then u is H\n"
    )
    found = {d.name: d for d in check_text(text).diagnostics}[name]
    assert words in found.message
    assert "other rule" not in found.related[0].message


TERMS = ["N", "Z", "P"]


def two_grids(cells):
    """Return a file with a grid under each of `p is N` and `p is P`, of 3 by 3 cells each."""
    grids = "".join(
        f"rules u when p is {p}\n  a \\ b N Z P\n"
        + "".join(f"  {a} " + " ".join(cells[p, a, b] for b in TERMS) + "\n" for a in TERMS)
        for p in ("N", "P")
    )
    return (
        "rulebase t\ninput a -1 .. 1\ninput b -1 .. 1\ninput p -1 .. 1\noutput u -1 .. 1\n"
        "terms a, b: triangles N Z P\nterms p: triangles N P\n"
        f"terms u: triangles NB NM Z PM PB\n{grids}"
    )


def mirrored_cells():
    order, cells = ["NB", "NM", "Z", "PM", "PB"], {}
    for i, a in enumerate(TERMS):
        for j, b in enumerate(TERMS):
            cells["N", a, b] = order[min(i + j, 2) + (i == 2)]
            cells["P", TERMS[2 - i], TERMS[2 - j]] = order[4 - min(i + j, 2) - (i == 2)]
    return cells


def of_symmetry(text):
    return [d for d in check_text(text).diagnostics if "symmetry" in d.name]


def test_a_grid_under_a_condition_mirrors_its_twin():
    assert of_symmetry(two_grids(mirrored_cells())) == []


def test_a_slip_across_two_grids_is_found():
    cells = mirrored_cells()
    assert cells["P", "P", "Z"] != "NB"
    (found,) = of_symmetry(two_grids({**cells, ("P", "P", "Z"): "NB"}))
    lines = {found.line, found.related[0].span.line}
    assert found.name == "broken-antisymmetry"
    assert len({line > 15 for line in lines}) == 2, "one of the two cells stands in each grid"


def test_grids_that_mirror_themselves_need_no_twin():
    cells = {(p, a, b): c for p in "NP" for (q, a, b), c in mirrored_cells().items() if q == "N"}
    plain = ["NB", "NM", "NM", "NM", "Z", "PM", "PM", "PM", "PB"]
    for (a, b), term in zip(itertools.product(TERMS, TERMS), plain, strict=True):
        cells["N", a, b] = cells["P", a, b] = term
    assert of_symmetry(two_grids(cells)) == []


def test_the_mirror_counts_terms_that_the_grid_does_not_use():
    # No cell says NB: without it PM would be taken for the mirror of Z.
    text = (
        "rulebase t\ninput a -1 .. 1\ninput b -1 .. 1\noutput u -1 .. 1\n"
        "terms a, b: triangles N Z P\nterms u: triangles NB NM Z PM PB\n"
        "rules u\n  a \\ b N Z P\n  N NM NM Z\n  Z NM Z PM\n  P Z PM PM\n"
    )
    assert of_symmetry(text) == []
    assert of_symmetry(text.replace("P Z PM PM", "P Z PM PB"))[0].hint.startswith(
        "the mirror of 'NM' is 'PM'"
    )


def test_a_missing_rule_under_a_condition_names_it():
    text = two_grids({**mirrored_cells(), ("N", "Z", "P"): "."})
    (found,) = [d for d in check_text(text).diagnostics if d.name == "missing-rule"]
    assert found.message == "no rule for a is Z and b is P when p is N"


@pytest.mark.parametrize(
    ("name", "formula", "method", "fits"),
    [
        ("x", "x + 0.5", "weighted-average", True),  # a value: the variable of that name
        ("x", "2 * x", "weighted-sum", True),
        ("a", "x + 0.5", "weighted-average", False),
        ("a", "a + 0.5", "weighted-average", True),
        ("a", "x / 2", "centroid", True),
        ("x", "x / 2", "centroid", False),
        ("a", "x / 2 + a", "centroid", False),
        ("a", "a / 2", "centroid", False),
        ("a", "0.5", "weighted-sum", True),
    ],
)
def test_what_is_wrong_with_a_formula_is_found_before_it_is_evaluated(name, formula, method, fits):
    from fuzzyarm.inference import infer

    text = (
        f"rulebase t\ninput {name} 0 .. 1\noutput u 0 .. 2\nterms {name}: triangles L H\n"
        f'term u A: formula "{formula}"\ninference defuzzifier {method}\n'
        f"rule if {name} is L then u is A\nrule if {name} is H then u is A\n"
    )
    assert ("defuzzifier-does-not-fit" in names(text)) == (not fits)
    rulebase = parse(text).partial
    if fits:
        assert infer(rulebase, {name: 0.3})
    elif "x" in formula:
        with pytest.raises((ValueError, KeyError)):
            infer(rulebase, {name: 0.3})


# --- Terms that lie unlike all others ---


def moved_term(term, shape):
    return PD7.replace("\ninference", f"\nterm e {term}: {shape}\n\ninference")


@pytest.mark.parametrize(
    ("term", "shape", "expected"),
    [
        # The partition is broken on both sides of a peak that has moved alone.
        ("PS", "triangle 0 2.5 4", {"broken-partition", "uneven-mirror"}),
        ("PS", "triangle 0 4.5 5", {"crossed-terms"}),
        ("PM", "triangle 2 -4 6", {"bad-shape"}),
        ("ZE", "triangle -2 0 2.5", {"broken-partition", "uneven-mirror"}),
        ("NS", "triangle -4 -2 0", set()),
    ],
)
def test_a_term_that_lies_elsewhere_than_its_neighbours(term, shape, expected):
    assert set(names(moved_term(term, shape))) == expected


def test_terms_without_order_symmetry_or_partition_have_none_to_break():
    one = Shape("triangle", (0.0, 0.1, 0.3))
    # Peaks at random, as other programs list them.
    peaks = [0.7, 0.2, 0.9, 0.4, 0.1]
    terms = tuple(
        Term(name, replace(one, parameters=(x - 0.05, x, x + 0.02)))
        for name, x in zip("ABCDE", peaks, strict=True)
    )
    variable = Input("x", 0.0, 1.0, terms)
    output = Output("y", 0.0, 1.0, (Term("A", one),))
    rules = tuple(Rule(Is("x", t.name), (Consequent("y", "A"),)) for t in terms)
    found = {d.name for d in check(RuleBase("r", (variable,), (output,), (RuleBlock(rules),)))}
    assert not found & {"crossed-terms", "broken-partition", "uneven-mirror"}


def test_what_a_tune_block_promises_has_to_hold():
    text = PD7.replace("\ninference", "\nterm e PB: triangle 3.5 6 8\n\ninference")
    asked = text + "tune\n  peaks e mirrored, partition\n"
    assert set(names(asked)) == {"broken-partition", "uneven-mirror"}
    two = "rulebase r\ninput e -1 .. 1\noutput u -1 .. 1\nterm e N: triangle -2 -1 0.5\n"
    two += "term e P: triangle -1 1 2\nterms u: triangles N P\n"
    two += "rule if e is N then u is N\nrule if e is P then u is P\n"
    assert not {"broken-partition", "uneven-mirror"} & set(names(two))
    promised = names(two + "tune\n  peaks e mirrored, partition\n")
    assert {"broken-partition", "uneven-mirror"} <= set(promised)


VALUES = ("singleton 0", "singleton 1")
RAMPS = ("ramp 1 0", "ramp 0 0.4")


@pytest.mark.parametrize(
    ("settings", "terms", "value"),
    [
        ("defuzzifier weighted-average", VALUES, 0.6),
        ("defuzzifier weighted-average, aggregation max", VALUES, 0.75),
        ("aggregation max, defuzzifier weighted-average", VALUES, 0.75),
        ("defuzzifier weighted-sum", VALUES, 0.75),
        ("defuzzifier karnik-mendel", VALUES, 0.6),
        ("defuzzifier tsukamoto", RAMPS, 0.4125),
    ],
)
def test_weighted_rules_add_up_unless_the_file_says_otherwise(settings, terms, value):
    """Σ wᵢ zᵢ / Σ wᵢ over two rules of strength 0.25 and one of 0.75."""
    text = (
        "rulebase t\ninput a 0 .. 1\ninput b 0 .. 1\noutput u 0 .. 1\nterms a, b: triangles L H\n"
        f"term u Z: {terms[0]}\nterm u O: {terms[1]}\ninference u: {settings}\n"
        "rule if a is H then u is Z\nrule if b is H then u is Z\nrule if a is L then u is O\n"
    )
    assert check_text(text).diagnostics == ()
    assert infer(parse(text).rulebase, a=0.25, b=0.25)["u"] == pytest.approx(value, abs=1e-12)
