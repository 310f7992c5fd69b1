"""A model that a format can express comes back as it was, and gives the same numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, fields, replace
from pathlib import Path

import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import input_points, plain_mamdani, rulebases

from fuzzyarm.base.diagnostic import Severity
from fuzzyarm.exchange.formats import SUFFIXES, Exported, parse, read, same_model, write
from fuzzyarm.exchange.formats.dialects import MACHINE_EPSILON, PRODUCERS
from fuzzyarm.exchange.formats.drafts import maximum_of_nothing
from fuzzyarm.exchange.formats.recovery import straight_shape
from fuzzyarm.exchange.formats.shapes import fuzzylite_shape
from fuzzyarm.inference import InferenceError, infer
from fuzzyarm.language import parse as frb
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Hedge,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    Variable,
)
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SNORMS, TNORMS, Norm

DATA = Path(__file__).parent / "data"
FILES = sorted(DATA.glob("*.f??"))
VALUES = ("singleton", "linear", "formula")

slow_draws = settings(
    max_examples=cases(12, 60),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


def said_by_fuzzylite(expression: Expression) -> Expression:
    """Keep what fuzzylite has words for: six hedges, on propositions alone."""
    names = {"extremely": "very", "power": "somewhat"}
    if isinstance(expression, Is):
        hedges = tuple(Hedge(names.get(h.name, h.name)) for h in expression.hedges)
        if any(h.name == "any" for h in hedges):
            hedges = ()
        return replace(expression, hedges=hedges)
    if isinstance(expression, Hedged):
        return said_by_fuzzylite(expression.operand)
    return type(expression)(tuple(map(said_by_fuzzylite, expression.operands)))


def inputs_only(rulebase: RuleBase) -> RuleBase:
    """Leave out the rules that read an output."""
    outputs = {output.name for output in rulebase.outputs}

    def reads(expression: Expression) -> bool:
        if isinstance(expression, Is):
            return expression.variable in outputs
        parts = (expression.operand,) if isinstance(expression, Hedged) else expression.operands
        return any(map(reads, parts))

    blocks = tuple(
        replace(block, rules=tuple(rule for rule in block.rules if not reads(rule.antecedent)))
        for block in rulebase.blocks
    )
    return replace(rulebase, blocks=blocks)


SPARED = ("middle-of-maximum", "nearest-of-maximum", "farthest-of-maximum")
"""Maxima that fuzzylite does not have: the one that each is like comes back."""


def fitted(output: Output, samples: tuple[int, str]) -> Output:
    """Sample an output as a program does; settle what it cannot say."""
    method = output.defuzzifier.method
    if method in SPARED:
        method = DEFUZZIFIERS[method].like
    kinds = {term.shape.kind for term in output.terms}
    if method == "tsukamoto" or kinds & set(VALUES):
        if kinds & set(VALUES) and method not in ("weighted-average", "weighted-sum"):
            method = "weighted-average"
        defuzzifier = Defuzzifier(method)
    else:
        method = "centroid" if method.startswith("weighted") else method
        defuzzifier = Defuzzifier(method, *samples)
    no_rule = math.nan if output.no_rule == "error" else output.no_rule
    return replace(output, defuzzifier=defuzzifier, no_rule=no_rule)


def for_fuzzylite(rulebase: RuleBase, resolution: int, threshold: float) -> RuleBase:
    plain = inputs_only(rulebase)
    blocks = tuple(
        replace(
            block,
            threshold=threshold,
            conjunction=known(TNORMS, block.conjunction, "min"),
            disjunction=known(SNORMS, block.disjunction, "max"),
            implication=known(TNORMS, block.implication, "min"),
            rules=tuple(
                Rule(
                    said_by_fuzzylite(rule.antecedent),
                    tuple(replace(c, hedges=()) for c in rule.consequents),
                    rule.weight,
                )
                for rule in block.rules
            ),
        )
        for block in plain.blocks
    )
    inputs = tuple(map(edged, plain.inputs))
    outputs = tuple(edged(fitted(each, (resolution, "midpoints"))) for each in plain.outputs)
    if threshold == MACHINE_EPSILON:  # the C++ program takes the maximum of nothing
        outputs = tuple(
            replace(each, no_rule=maximum_of_nothing(each))
            if each.defuzzifier.method.endswith("of-maximum")
            else each
            for each in outputs
        )
    return replace(plain, inputs=inputs, blocks=blocks, outputs=outputs)


def known(registry: Mapping[str, Norm], name: str, otherwise: str) -> str:
    """Return a norm that fuzzylite has; another one in its place."""
    return name if "fll" in registry[name].names else otherwise


def edged(variable: Variable) -> Variable:
    """Have shapes already as they come back: edges by the smallest step, no straight points."""

    def shape(old: Shape) -> Shape:
        made = fuzzylite_shape(old)
        return straight_shape(made) if made.kind == "points" else made

    return replace(variable, terms=tuple(replace(t, shape=shape(t.shape)) for t in variable.terms))


def same_numbers(one: RuleBase, other: RuleBase, points: dict[str, list[float]]) -> bool:
    """Whether two rule bases agree to the last bit at every point."""
    held = {output.name: 0.25 for output in one.outputs}
    for row in zip(*points.values(), strict=True):
        at = dict(zip(points, row, strict=True))
        try:
            found = infer(one, at, held=held)
        except InferenceError as error:
            with pytest.raises(type(error)):
                infer(other, at, held=held)
            continue
        again = infer(other, at, held=held)
        pairs = [(found[name], again[name]) for name in found]
        if any(a != b and not (math.isnan(a) and math.isnan(b)) for a, b in pairs):
            return False
    return True


def comes_back(rulebase: RuleBase, suffix: str, exported: Exported) -> RuleBase:
    assert exported.text is not None, [str(d) for d in exported.errors]
    imported = parse(exported.text, suffix)
    assert imported.rulebase is not None, [str(d) for d in imported.errors]
    return imported.rulebase


@pytest.mark.slow
@slow_draws
@given(st.data())
def test_fll_keeps_whatever_fuzzylite_can_say(data: st.DataObject) -> None:
    rulebase = for_fuzzylite(data.draw(rulebases()), 40, 0.125)
    again = comes_back(rulebase, ".fll", write(rulebase, ".fll"))
    assert same_model(again, rulebase)
    assert same_numbers(rulebase, again, data.draw(input_points(rulebase, 3)))


@pytest.mark.slow
@slow_draws
@given(st.data())
def test_fcl_keeps_whatever_fuzzylite_can_say(data: st.DataObject) -> None:
    drawn = for_fuzzylite(data.draw(rulebases()), 1000, 1e-6)
    inputs = tuple(replace(each, outside="extend") for each in drawn.inputs)
    rulebase = replace(drawn, inputs=inputs)
    again = comes_back(rulebase, ".fcl", write(rulebase, ".fcl", producer="fuzzylite"))
    assert same_model(again, rulebase)


@pytest.mark.slow
@slow_draws
@given(st.data(), st.sampled_from([("matlab", 101), ("octave", 101), ("fuzzylite", 1000)]))
def test_fis_keeps_plain_mamdani_for_each_program(
    data: st.DataObject, program: tuple[str, int]
) -> None:
    name, samples = program
    sampling = "midpoints" if name == "fuzzylite" else "endpoints"
    kinds = ("triangle", "trapezoid", "gaussian", "bell", "s", "z", "pi", "sigmoid-product")
    drawn = data.draw(
        plain_mamdani(kinds=kinds, aggregations=("max", "sum"), implications=("min", "product"))
    )
    output = drawn.outputs[0]
    edge = edged if name == "fuzzylite" else lambda variable: variable
    usual = 0.5 * (output.low + output.high) if name == "matlab" else math.nan
    outside = "error" if name == "octave" else "extend"
    rulebase = replace(
        drawn,
        inputs=tuple(replace(edge(_low(each)), outside=outside) for each in drawn.inputs),
        outputs=(
            replace(
                edge(_low(output)),
                defuzzifier=Defuzzifier("centroid", samples, sampling),
                no_rule=usual,
                outside="extend",
            ),
        ),
        blocks=tuple(
            replace(block, threshold=1e-6 if name == "fuzzylite" else 0.0) for block in drawn.blocks
        ),
    )
    again = comes_back(rulebase, ".fis", write(rulebase, ".fis", producer=name))
    assert same_model(again, rulebase)
    assert same_numbers(rulebase, again, data.draw(input_points(rulebase, 3)))


@pytest.mark.slow
@slow_draws
@given(st.data())
def test_fml_keeps_plain_mamdani(data: st.DataObject) -> None:
    kinds = ("triangle", "trapezoid", "rectangle", "points", "gaussian", "s", "z")
    drawn = data.draw(
        plain_mamdani(
            kinds=kinds,
            aggregations=("max", "probor", "bounded", "normalized"),
            implications=("min", "product", "hamacher"),
        )
    )
    rulebase = replace(
        drawn,
        inputs=tuple(replace(_low(each), outside="extend") for each in drawn.inputs),
        outputs=(replace(_low(drawn.outputs[0]), outside="extend"),),
    )
    exported = write(rulebase, ".fml")
    assert not exported.diagnostics
    again = comes_back(rulebase, ".fml", exported)
    assert same_model(again, rulebase)
    assert same_numbers(rulebase, again, data.draw(input_points(rulebase, 3)))


@slow_draws
@given(st.data(), st.booleans())
def test_fml_keeps_values_and_hedges(data: st.DataObject, linear: bool) -> None:
    numbers = st.floats(-9.0, 9.0)
    drawn = data.draw(plain_mamdani(kinds=("triangle",)))
    inputs = tuple(replace(_low(each), outside="extend") for each in drawn.inputs)
    terms = tuple(
        Term(
            each.name,
            Shape("linear", tuple(data.draw(numbers) for _ in (*inputs, 0)))
            if linear
            else Shape("singleton", (data.draw(numbers),)),
        )
        for each in drawn.outputs[0].terms
    )
    output = replace(
        drawn.outputs[0],
        terms=terms,
        aggregation="sum",
        defuzzifier=Defuzzifier("weighted-average"),
        outside="extend",
    )
    hedge = data.draw(st.sampled_from(["not", "very", "somewhat", "extremely", "seldom"]))

    def hedged(expression: Expression) -> Expression:
        if isinstance(expression, Is):
            return replace(expression, hedges=(Hedge(hedge),))
        assert isinstance(expression, And)
        return Or(tuple(map(hedged, expression.operands)))

    blocks = tuple(
        replace(
            block, rules=tuple(replace(r, antecedent=hedged(r.antecedent)) for r in block.rules)
        )
        for block in drawn.blocks
    )
    rulebase = replace(drawn, inputs=inputs, outputs=(output,), blocks=blocks)
    exported = write(rulebase, ".fml")
    assert not exported.diagnostics
    again = comes_back(rulebase, ".fml", exported)
    assert again.rules == rulebase.rules
    assert same_numbers(rulebase, again, data.draw(input_points(rulebase, 3)))


def _low(variable: Output) -> Output:
    """Heights of terms have no place in a FIS of MATLAB."""
    terms = tuple(replace(t, shape=replace(t.shape, height=1.0)) for t in variable.terms)
    return replace(variable, terms=terms)


@pytest.mark.slow
@slow_draws
@given(st.data())
def test_fcl_keeps_plain_mamdani_for_jfuzzylogic(data: st.DataObject) -> None:
    kinds = ("triangle", "trapezoid", "gaussian", "two-sided-gaussian", "bell", "sigmoid", "points")
    drawn = data.draw(plain_mamdani(kinds=kinds, aggregations=("max", "sum", "probor")))
    pairs = {"min": "max", "product": "probor"}
    rulebase = replace(
        drawn,
        inputs=tuple(replace(_low(each), outside="extend") for each in drawn.inputs),
        outputs=(
            replace(
                _gentle(_low(drawn.outputs[0])),
                defuzzifier=Defuzzifier("centroid", 1000, "left"),
                outside="extend",
            ),
        ),
        blocks=tuple(replace(b, disjunction=pairs[b.conjunction]) for b in drawn.blocks),
    )
    again = comes_back(rulebase, ".fcl", write(rulebase, ".fcl", producer="jfuzzylogic"))
    assert same_numbers(rulebase, again, data.draw(input_points(rulebase, 3)))


def _gentle(output: Output) -> Output:
    """Without vertical edges, which jFuzzyLogic may see from the other side of a sample."""

    def slanted(term: Term) -> Term:
        if term.shape.kind not in ("triangle", "trapezoid"):
            return term
        p = [value + 0.001 * index for index, value in enumerate(term.shape.parameters)]
        return Term(term.name, Shape(term.shape.kind, tuple(p)))

    return replace(output, terms=tuple(map(slanted, output.terms)))


@pytest.mark.slow
@slow_draws
@given(st.data(), st.sampled_from([".fll", ".fcl", ".fis", ".fml"]))
def test_any_model_is_written_or_refused_and_what_is_written_is_read(
    data: st.DataObject, suffix: str
) -> None:
    rulebase = data.draw(rulebases(odd_names=True, decorated=True))
    exported = write(rulebase, suffix)
    assert (exported.text is None) == bool(exported.errors)
    lossy = write(rulebase, suffix, lossy=True)
    for text in filter(None, (exported.text, lossy.text)):
        imported = parse(text, suffix)
        names = {d.name for d in imported.errors}
        assert names <= {
            *(["no-rules"] if text is lossy.text else []),  # all of them may be lost
            "set-as-value",
            "value-as-set",
            "not-monotonic",
            "chained-output",
            "weighted-sum-of-tsukamoto",
        }


@pytest.mark.parametrize("suffix", [".fll", ".fcl"])
@pytest.mark.parametrize("name", ["¼", "x²", "½ full"])
def test_numbers_that_are_no_digits_do_not_spoil_a_name(name: str, suffix: str) -> None:
    triangle = Shape("triangle", (0.0, 0.5, 1.0))
    text = write(_one_term(name, triangle), suffix, lossy=True).text
    assert text is not None
    assert not parse(text, suffix).errors


def _one_term(name: str, shape: Shape) -> RuleBase:
    rule = Rule(Is("x", name), (Consequent("y", name),))
    terms = (Term(name, shape),)
    outputs = (Output("y", 0.0, 1.0, terms),)
    return RuleBase("r", (Input("x", 0.0, 1.0, terms),), outputs, (RuleBlock((rule,)),))


FOR_SCIKIT_FUZZY = DATA / "spray_scikit.fcl"
"""In a dialect that is read and not written: FCL goes out for fuzzylite or jFuzzyLogic."""

WRITTEN = [path for path in FILES if path.suffix in SUFFIXES and path != FOR_SCIKIT_FUZZY]


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: path.name)
def test_our_files_survive_their_own_format(path: Path) -> None:
    rulebase = read(path).rulebase
    assert rulebase is not None
    exported = write(rulebase, path.suffix)
    again = comes_back(rulebase, path.suffix, exported)
    points = {v.name: [v.low, 0.3 * v.low + 0.7 * v.high, v.high + 1] for v in rulebase.inputs}
    terms = (t for v in (*rulebase.inputs, *rulebase.outputs) for t in v.terms)
    # FML has no heights: a straight term with one is written as its points.
    redrawn = path.suffix == ".fml" and any(term.shape.height != 1.0 for term in terms)
    if not redrawn and not any(d.name == "renamed" for d in exported.diagnostics):
        assert same_model(again, rulebase)
    assert same_numbers(rulebase, again, points)


def test_a_file_for_scikit_fuzzy_does_not_come_back_and_that_is_said() -> None:
    """Its universe of points and its clamped inputs have no words in the FCL of others."""
    rulebase = read(FOR_SCIKIT_FUZZY).rulebase
    assert rulebase is not None
    exported = write(rulebase, ".fcl")
    warnings = {d.name for d in exported.diagnostics if d.severity is Severity.WARNING}
    assert warnings == {"no-rule", "outside-range", "sampling", "threshold"}
    assert write(rulebase, ".fcl", strict=True).text is None
    again = comes_back(rulebase, ".fcl", exported)
    assert [rule.antecedent for rule in again.rules] == [r.antecedent for r in rulebase.rules]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_our_files_survive_the_way_through_the_language(path: Path) -> None:
    rulebase = read(path).rulebase
    assert rulebase is not None
    exported = write(rulebase, ".frb")
    assert same_model(comes_back(rulebase, ".frb", exported), rulebase)


def test_a_nested_expression_keeps_its_parentheses() -> None:
    source = read(DATA / "shapes.fll").rulebase
    assert source is not None
    a, b, c = (Is("x", name) for name in ("tri", "trap", "bell"))
    antecedents = [
        And((a, Or((b, c)))),
        Or((And((a, b)), c)),
        And((And((a, b)), c)),
        And((a, And((b, c)))),
        Or((a, Or((b, c)))),
        Hedged((Hedge("very"),), And((a, Or((b, c))))),
    ]
    consequents = source.rules[0].consequents
    block = RuleBlock(tuple(Rule(each, consequents) for each in antecedents), "nested")
    rulebase = replace(source, blocks=(block,))
    for suffix in (".fll", ".fcl"):
        text = write(rulebase, suffix, lossy=True).text
        assert text is not None
        again = parse(text, suffix).rulebase
        assert again is not None
        assert [rule.antecedent for rule in again.rules] == antecedents


FOREIGN_TEXTS = (
    "one\nRULE 1 : IF a IS b THEN c IS d;\r\n[Input9]\u2028Rule: x\x85y",
    "nul \x00 bell \x07 escape \x1b[2J",
    "*/ evil /* ]]> <!-- (* *) ??/ --> {{ % // # ;",
    "\"quotes\" 'both' \\ back\\",
    "non-BMP \U0001f600 \ufffe \uffff",
    "END_RULEBLOCK; Name='x' [Rules] : = | ,",
    "<a b='&amp;'>&lt;",
    "\u202e \ud800 ",
)


def named_by(text: str) -> RuleBase:
    """Return a rule base in which `text` is every name and every description that it may be."""
    sides = {"low": Shape("trapezoid", (0.0, 0.0, 2.0, 5.0)), text: Shape("ramp", (2.0, 5.0))}
    terms = tuple(Term(name, shape) for name, shape in sides.items())
    variables = Input(text, 0.0, 10.0, terms, text), Output("y", 0.0, 10.0, terms, text)
    rules = tuple(Rule(Is(text, name), (Consequent("y", name),)) for name in sides)
    return RuleBase(text, variables[:1], variables[1:], (RuleBlock(rules, name=text),), text)


@pytest.mark.parametrize("text", FOREIGN_TEXTS)
@pytest.mark.parametrize(("suffix", "producer"), [
    (suffix, producer) for suffix, producers in PRODUCERS.items() for producer in producers
])  # fmt: skip
def test_foreign_texts_stay_text_in_every_format(text, suffix, producer):
    model = named_by(text)
    exported = write(model, suffix, producer=producer, lossy=True)
    assert exported.text is not None
    assert all(letter.isprintable() or letter in "\n\t" for letter in exported.text)
    found = parse(exported.text, suffix, producer=producer, lossy=True).rulebase
    assert found is not None
    counts = [len(found.inputs), len(found.outputs), len(found.rules), len(found.inputs[0].terms)]
    assert counts == [1, 1, 2, 2]
    for x in (0.5, 3.0, 4.5, 9.0):
        values = [infer(m, {m.inputs[0].name: x})[m.outputs[0].name] for m in (model, found)]
        assert values[1] == pytest.approx(values[0], abs=0.05)  # 101 samples of others
    if found.name != text:
        assert "changed-text" in {diagnostic.name for diagnostic in exported.diagnostics}


FILLED = """rulebase r "all that may be left out"
input a 0 .. 1
output u 0 .. 1
terms a, u: triangles L H
rule if a is L then u is H
rule if a is H then u is L
lookup
  levels 0 1
expect a = 0 -> u > 0
prove u covered
tune
  peaks a
"""
MAY_LACK = {
    each.name: each.default
    for each in fields(RuleBase)
    if each.default is not MISSING and each.name not in ("inputs", "outputs", "blocks")
}
"""Field of a rule base → its value without it."""


@pytest.mark.parametrize(("suffix", "producer"), [
    (suffix, producer) for suffix, producers in PRODUCERS.items() for producer in producers
])  # fmt: skip
@pytest.mark.parametrize("field", MAY_LACK)
def test_a_part_of_a_rule_base_is_written_or_left_out_by_name(suffix, producer, field):
    whole = frb(FILLED).rulebase
    assert getattr(whole, field) != MAY_LACK[field], "FILLED lacks it"
    bare = replace(whole, **MAY_LACK)
    one = replace(bare, **{field: getattr(whole, field)})
    said = [write(model, suffix, producer=producer, lossy=True) for model in (bare, one)]
    found = parse(said[1].text, suffix, producer=producer, lossy=True).rulebase
    is_named = len(said[1].diagnostics) > len(said[0].diagnostics)
    assert is_named == (getattr(found, field) != getattr(one, field))
