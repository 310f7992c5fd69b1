"""A rule base written in Python is the file of the same lines: model, checks, findings."""

import copy
import dataclasses
import pickle
import subprocess
import sys

import pandas as pd
import pytest
from budget import cases
from hypothesis import given, settings

import fuzzyarm
from fuzzyarm import RuleBaseBuilder, RuleBaseError, Shape, parse, write
from fuzzyarm.apps.builder import BuilderArgumentError
from fuzzyarm.exchange.formats import FormatError
from fuzzyarm.exchange.formats.registry import same_model
from fuzzyarm.language.document import print_document
from fuzzyarm.language.model import Input, NotInModelError, Output
from fuzzyarm.language.model import RuleBase as Model
from fuzzyarm.language.rows import sentence
from fuzzyarm.language.writer import property_node, rule_node
from tests.strategies import rulebases


@pytest.fixture
def fan():
    made = RuleBaseBuilder("fan")
    made.input("temp", 0, 40, "°C", terms=["cold", "warm", "hot"])
    made.output("speed", 0, 100, "%", terms={"slow": (0, 0, 50), "fast": (50, 100, 100)})
    made.rule("if temp is hot then speed is fast")
    made.rule("if temp is cold or temp is warm then speed is slow")
    return made


AS_A_FILE = """\
rulebase fan

input temp 0 .. 40 "°C"
terms temp: triangles cold warm hot
output speed 0 .. 100 "%"
term speed slow: triangle 0 0 50
term speed fast: triangle 50 100 100

rule if temp is hot then speed is fast
rule if temp is cold or temp is warm then speed is slow
"""


def test_it_is_the_file_of_the_same_lines(fan):
    file = parse(AS_A_FILE)
    assert fan.model == file.rulebase
    assert str(fan) == print_document(file.document)
    assert fan(temp=30) == fuzzyarm.infer(file.rulebase, temp=30) == {"speed": 50.0}
    assert [r.span for r in fan.model.rules] == [r.span for r in parse(str(fan)).rulebase.rules]


def rebuilt(rulebase):
    """Write a rule base again, by the methods of the builder alone."""
    made = RuleBaseBuilder(rulebase.name, rulebase.description)
    common = ("name", "low", "high", "description")
    for each in rulebase.inputs:
        made.input(
            *(getattr(each, name) for name in common),
            terms={term.name: term.shape for term in each.terms},
            outside=each.outside,
        )
    for each in rulebase.outputs:
        made.output(
            *(getattr(each, name) for name in common),
            terms={term.name: term.shape for term in each.terms},
            aggregation=each.aggregation,
            defuzzifier=each.defuzzifier,
            no_rule=each.no_rule,
            outside=each.outside,
        )
    for index, block in enumerate(rulebase.blocks):
        norms = {
            name: getattr(block, name)
            for name in ("conjunction", "disjunction", "implication", "threshold")
        }
        if block.name or index:
            made.block(block.name, **norms)
        else:
            made.inference(**norms)
        for rule in block.rules:
            node = rule_node(dataclasses.replace(rule, weight=1.0))
            made.rule(sentence(node), rule.weight)
    if rulebase.lookup is not None:
        axes = rulebase.lookup.axes
        bins = {axis.variable: axis.bins for axis in axes if axis.bins is not None}
        levels = {axis.variable: axis.levels for axis in axes}
        made.lookup(levels, bins=bins, rounding=rulebase.lookup.round)
    for each in rulebase.expectations:
        inputs = ", ".join(f"{name} = {value!r}" for name, value in each.inputs)
        outcomes = write(dataclasses.replace(rulebase, expectations=(each,)))
        line = next(t for t in outcomes.splitlines() if t.startswith("expect "))
        assert inputs
        made.expect(line.removeprefix("expect "))
    for each in rulebase.properties:
        made.add(str(property_node(each, rulebase)))
    if rulebase.tuning is not None:
        block = write(rulebase).partition("\ntune\n")[2].partition("\n\n")[0]
        made.add("tune\n" + block)
    return made


@pytest.mark.slow
@settings(max_examples=cases(8, 25))
@given(rulebases(odd_names=True, decorated=True))
def test_every_rule_base_can_be_written_with_it(rulebase):
    made = rebuilt(rulebase)
    assert same_model(made.model, rulebase)
    assert same_model(parse(str(made)).rulebase, rulebase)


@pytest.mark.parametrize(
    ("call", "name", "argument"),
    [
        (lambda fan: fan.input("x", 4, 0), "bad-range", "input('x', low, high)"),
        (lambda fan: fan.input("temp", 0, 4), "duplicate-variable", "input('temp', name)"),
        (
            lambda fan: fan.output("y", 0, 1, terms={"a": (0, 2, 1)}),
            "bad-shape",
            "output('y', terms['a'][2])",
        ),
        (
            lambda fan: fan.output("y", 0, 1, terms={"a": "triangel 0 1 2"}),
            "unknown-shape",
            "output('y', terms['a'])",
        ),
        (
            lambda fan: fan.output("y", 0, 1, defuzzifier="cog"),
            "unknown-defuzzifier",
            "output('y', defuzzifier)",
        ),
        (lambda fan: fan.term("speed", "slow", 3), "duplicate-term", "term('speed', 'slow', name)"),
        (lambda fan: fan.term("sped", "x", 3), "unknown-variable", "term('sped', 'x', variable)"),
        (
            lambda fan: fan.rule("if tmp is hot then speed is fast"),
            "unknown-variable",
            "rule('if tmp is hot then speed is fast')",
        ),
        (
            lambda fan: fan.rule("if temp is hot then speed is fast", 2),
            "bad-weight",
            "rule('if temp is hot then speed is fast', weight)",
        ),
        (
            lambda fan: fan.grid("speed", ["slow", "slw", "fast"]),
            "unknown-term",
            "grid('speed', cells[0][1])",
        ),
        (lambda fan: fan.grid("sped", ["slow"] * 3), "unknown-variable", "grid('sped', output)"),
        (lambda fan: fan.grid("speed", ["slow"]), "wrong-cell-count", "grid('speed', cells[0][0])"),
        (lambda fan: fan.inference(conjunction="mim"), "unknown-choice", "inference(conjunction)"),
        (lambda fan: fan.block("b", threshold=1), "bad-threshold", "block('b', threshold)"),
        (lambda fan: fan.lookup("0 .. 40 step 7"), "bad-levels", "lookup(levels)"),
        (lambda fan: fan.lookup({"tmp": [0, 1]}), "unknown-variable", "lookup(levels['tmp'])"),
        (lambda fan: fan.expect("temp = 3 -> spd = 1"), "unknown-variable", "expect(text)"),
        (lambda fan: fan.add("# x\nprove speed raises"), "unexpected-token", "add(line 2 of text)"),
        (lambda fan: fan.add("controller c"), "not-a-rule-base", "add(line 1 of text)"),
        (
            lambda _: RuleBaseBuilder.from_text("input"),
            "incomplete-statement",
            "add(line 1 of text)",
        ),
    ],
)  # fmt: skip
def test_a_finding_names_the_argument_and_nothing_is_added(fan, call, name, argument):
    before = str(fan)
    with pytest.raises(RuleBaseError) as raised:
        call(fan)
    finding = raised.value.diagnostics[0]
    assert (finding.name, finding.argument) == (name, argument)
    assert str(raised.value).startswith(f"{argument}: error[{name}]: ")
    assert str(fan) == before
    fan.rule("if temp is hot then speed is fast")  # it goes on


@pytest.mark.parametrize(
    "line",
    [
        "rule if temp=hot then speed is fast",
        "rule IF temp IS hot THEN speed IS fast",
        "rule if temp is hot then speed is fasst",
        "input x 3,5 .. 7",
        "terms speed: triangle a b",
        "term temp icy: gaussian 3",
        "prove speed rises with tmp",
        "nonsense",
    ],
)
def test_a_line_has_the_finding_that_it_has_in_a_file(fan, line):
    in_file = parse(f"{fan}{line}\n").diagnostics
    with pytest.raises(RuleBaseError) as raised:
        fan.add(line)
    told = [(each.name, each.message, each.hint) for each in raised.value.diagnostics]
    assert told == [(each.name, each.message, each.hint) for each in in_file]


@pytest.mark.parametrize(
    "call",
    [
        lambda: RuleBaseBuilder("r").input("x", "0", 1),
        lambda: RuleBaseBuilder(3),
        lambda: RuleBaseBuilder("r").input("x", 0, 1, terms={"a": (1, 2, 3, 4, 5)}),
        lambda: RuleBaseBuilder("r").input("x", 0, 1, terms={"a": (1, "2", 3)}),
        lambda: RuleBaseBuilder("r").input("x", 0, 1, terms={"a": None}),
        lambda: RuleBaseBuilder("r").rule(None),
        lambda: RuleBaseBuilder("r").input("x", 0, 10**400),
        lambda: RuleBaseBuilder("r").grid("y", 3),
        lambda: RuleBaseBuilder("r").grid("y", [["A"]]),
    ],
)
def test_an_argument_of_another_type_is_named(call):
    with pytest.raises(BuilderArgumentError) as raised:
        call()
    assert isinstance(raised.value, TypeError)
    assert str(raised.value).startswith(raised.value.argument)


# --- Terms and grids ---


def test_terms_in_every_way():
    made = RuleBaseBuilder("r")
    x = made.input("x", 0, 10, terms="gaussians S M L")
    x.term("odd one", "bell 5 1 2")
    made.output(
        "y", 0, 10,
        terms={
            "one": 3, "two": (1, 2), "three": [1, 2, 3], "four": (1, 2, 3, 4),
            "pairs": [(0, 0), (5, 1), (10, 0)], "made": Shape("gaussian", (5, 1), 0.5),
        },
    )  # fmt: skip
    made.rule("if x is S then y is one")
    kinds = [term.shape.kind for term in made.model.outputs[0].terms]
    assert kinds == ["singleton", "rectangle", "triangle", "trapezoid", "points", "gaussian"]
    assert [term.name for term in x.model.terms] == ["S", "M", "L", "odd one"]
    assert made.model.outputs[0].term("made").shape == Shape("gaussian", (5.0, 1.0), 0.5)
    assert repr(x) == "<Input x 0 .. 10: S M L odd one>"


TWO = """\
rulebase r
input e 0 .. 1
input c 0 .. 1
output u 0 .. 1
terms e, c: triangles A B
terms u: triangles L M H
"""
AS_A_GRID = f"{TWO}rules u\n  e \\ c  A  B\n  A  L  M*0.5\n  B  .  H\n"


@pytest.mark.parametrize(
    "cells",
    [
        [["L", ("M", 0.5)], [None, "H"]],
        [["L", ("M", 0.5)], ["", "H"]],
        {"A": ["L", ("M", 0.5)], "B": [".", "H"]},
        pd.DataFrame({"A": ["L", float("nan")], "B": [("M", 0.5), "H"]}, index=["A", "B"]),
    ],
)
def test_a_grid_is_that_of_a_file(cells):
    made = RuleBaseBuilder.from_text(TWO)
    made.grid("u", cells)
    assert made.model == parse(AS_A_GRID).rulebase


def test_a_frame_names_its_variables():
    frame = pd.DataFrame([["L", "M"], ["M", "H"]], index=["A", "B"], columns=["A", "B"])
    frame = frame.rename_axis(index="c", columns="e")
    made, given = RuleBaseBuilder.from_text(TWO), RuleBaseBuilder.from_text(TWO)
    made.grid("u", frame)
    given.grid("u", frame.to_numpy(), rows="c", columns="e")
    assert made.model == given.model
    first = made.model.rules[0].antecedent.operands
    assert [each.variable for each in first] == ["c", "e"]


def test_rows_that_do_not_fit():
    made = RuleBaseBuilder.from_text(TWO)
    with pytest.raises(BuilderArgumentError, match=r"3 rows, but 'e' has 2 terms"):
        made.grid("u", [["L", "M"]] * 3)
    with pytest.raises(RuleBaseError, match="wrong-cell-count"):
        made.grid("u", [["L"], ["M"]])


# --- The builder and the value ---


def test_the_value_does_not_change_with_the_builder(fan):
    before = fan.model
    assert fan.model is before
    fan.rule("if temp is warm then speed is fast", 0.5)
    assert len(before.rules) == 2
    assert len(fan.model.rules) == 3
    assert hash(before) == hash(parse(AS_A_FILE).rulebase)
    with pytest.raises(dataclasses.FrozenInstanceError):
        before.name = "other"


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies_go_their_own_way(fan, way):
    other = way(fan)
    other.rule("if temp is warm then speed is fast")
    assert (len(fan.model.rules), len(other.model.rules)) == (2, 3)


def test_it_goes_on_behind_a_value(fan):
    other = RuleBaseBuilder.of(fan.model)
    assert other.model == RuleBaseBuilder.of(fan).model == fan.model
    other.rule("if temp is warm then speed is fast")
    assert other.model.blocks[0].rules[:2] == fan.model.rules


def test_only_line_ends_end_a_line():
    made = RuleBaseBuilder("odd\u2028name\x0b")
    made.add("# a\u2028comment\r\ninput 'x\\u2028' 0 .. 1\routput y 0 .. 1\n")
    made.term("y", "on\n", 1)
    made.term("x\u2028", "flat", "rectangle 0\n1")
    made.rule("if 'x\\u2028' is flat\nthen y is 'on\\n'")
    assert made.model.name == "odd\u2028name\x0b"
    assert made.model.rules[0].consequents[0].term == "on\n"
    assert parse(str(made)).rulebase == made.model


def test_comments_stay():
    text = "# a head\n" + AS_A_FILE + "# the end\n"
    made = RuleBaseBuilder.from_text(text)
    made.expect("temp = 40 -> speed > 50  # hot")
    lines = str(made).splitlines()
    assert lines[0] == "# a head"
    assert lines[-2:] == ["# the end", "expect temp = 40 -> speed > 50  # hot"]


def test_functions_take_a_builder_as_they_take_its_value(fan):
    assert fuzzyarm.compiled(fan)(temp=20) == fuzzyarm.infer(fan, temp=20)
    assert fuzzyarm.explain(fan, temp=20)
    assert fuzzyarm.write(fan) == write(fan.model)
    assert fuzzyarm.compile_table(fan, levels=3) == fan.table(levels=3)
    assert fuzzyarm.prove(fan, "speed covered").proved
    assert fan.explain(temp=30) == fuzzyarm.explain(fan.model, temp=30)
    assert fan.model(temp=30) == fan(temp=30)
    assert len(fan.plot().axes) >= 3


def test_checks_are_those_of_a_file(fan):
    fan.input("load", 0, 1, terms=["low", "high"])
    fan.expect("temp = 30, load = 0 -> speed = 3")
    mine, of_file = fan.check(), fuzzyarm.check_text(str(fan))
    assert mine.failed
    assert [each.name for each in mine.diagnostics] == [each.name for each in of_file.diagnostics]
    arguments = {each.name: each.argument for each in mine.diagnostics}
    assert arguments["unused-variable"] == "input('load', name)"
    assert arguments["failed-expectation"] == "expect(text)"
    assert "expect(text): error[failed-expectation]" in str(mine)


def test_what_is_missing_is_said_of_the_whole():
    made = RuleBaseBuilder("fan")
    with pytest.raises(RuleBaseError, match=r"RuleBaseBuilder\('fan'\): error\[no-inputs\]"):
        made(temp=3)
    assert [each.argument for each in made.check().diagnostics] == ["RuleBaseBuilder('fan')"] * 3
    assert repr(made) == "<RuleBaseBuilder fan: 1 statements, no rules yet>"


def test_a_continued_text_counts_its_rules():
    pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    for made in (RuleBaseBuilder.of(pd7), RuleBaseBuilder.from_text(str(pd7))):
        assert "49 rules" in repr(made)


def test_to_file(fan, tmp_path):
    fan.to_file(tmp_path / "fan.frb")
    assert (tmp_path / "fan.frb").read_text("utf-8") == str(fan)
    fan.to_file(tmp_path / "fan.fll")
    assert fuzzyarm.load(tmp_path / "fan.fll")(temp=30)["speed"] == pytest.approx(50.0, abs=1e-6)
    with pytest.raises(FormatError, match="a rule base ends in"):
        fan.to_file(tmp_path / "fan.lut")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fan.fll", "fan.frb"]


def test_many_rules_take_no_more_than_their_number():
    made = RuleBaseBuilder.from_text(TWO)
    for _ in range(300):
        made.rule("if e is A and c is B then u is M", 0.5)
    assert len(made.model.rules) == 300


def test_nothing_heavy_is_loaded():
    code = (
        "import sys, fuzzyarm; fan = fuzzyarm.RuleBaseBuilder('fan');"
        "fan.input('t', 0, 40, terms=['cold', 'hot']); fan.output('u', 0, 1, terms={'on': 1});"
        "fan.rule('if t is hot then u is on'); fan(t=30); fan.check(); str(fan);"
        "print([m for m in ('numpy', 'rich', 'matplotlib', 'pandas') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


# --- Values that cannot be ---


@pytest.mark.parametrize(
    ("make", "argument", "words"),
    [
        (lambda: Shape("triangel", (0, 1, 2)), "Shape(kind)", "did you mean 'triangle'?"),
        (lambda: Shape("triangle", (0, 1)), "Shape(parameters)", "takes 3 numbers"),
        (lambda: Shape("triangle", (0, 2, 1)), "Shape(parameters[2])", "must not decrease"),
        (lambda: Shape("gaussian", (0, 0)), "Shape(parameters[1])", "must be above 0"),
        (lambda: Shape("points", (0, 0, 1)), "Shape(parameters)", "takes 2 numbers"),
        (lambda: Shape("points", (0, float("nan"))), "Shape(parameters[1])", "number nan"),
        (lambda: Input("x", 1.0, 0.0), "Input(low, high)", "from a lower to a higher"),
        (lambda: Output("x", 1.0, 1.0), "Output(low, high)", "from a lower to a higher"),
    ],
)
def test_a_value_that_cannot_be_is_an_error_at_once(make, argument, words):
    with pytest.raises(RuleBaseError, match=r"error\[") as raised:
        make()
    assert raised.value.diagnostics[0].argument == argument
    assert words in str(raised.value)
    again = pickle.loads(pickle.dumps(raised.value))
    assert again.diagnostics == raised.value.diagnostics


def test_a_name_that_a_model_does_not_have(fan):
    with pytest.raises(NotInModelError, match=r"no variable is called 'tmp' \(did you mean 'temp'"):
        fan.model.variable("tmp")
    wrong = dataclasses.replace(fan.model, inputs=())
    grid = parse(AS_A_GRID).rulebase
    assert isinstance(wrong, Model)
    with pytest.raises(KeyError, match="no variable is called 'e'"):
        write(dataclasses.replace(grid, inputs=grid.inputs[1:]))
