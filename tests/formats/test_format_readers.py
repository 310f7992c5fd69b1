"""What each reader makes of good files and what it says about bad ones."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.exchange.formats import Imported, parse, parse_fcl, parse_fis, parse_fll, read, write
from fuzzyarm.exchange.formats.findings import MAX_CHARACTERS
from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import (
    And,
    Defuzzifier,
    Hedge,
    Hedged,
    Is,
    Or,
    RuleBase,
    Shape,
)
from fuzzyarm.language.model.shapes import membership_function

DATA = Path(__file__).parent / "data"


def good(imported: Imported) -> RuleBase:
    assert imported.rulebase is not None, [str(d) for d in imported.errors]
    return imported.rulebase


def ours(name: str) -> RuleBase:
    return good(read(DATA / name))


def names(imported: Imported) -> set[str]:
    return {d.name for d in imported.diagnostics}


def shape(rulebase: RuleBase, variable: str, term: str) -> Shape:
    return rulebase.variable(variable).term(term).shape


# ── FLL ──────────────────────────────────────────────────────────────────────────────

FLL = """Engine: e
InputVariable: x
  range: 0 1
  term: a Ramp 0 1
OutputVariable: y
  range: 0 1
  aggregation: Maximum
  defuzzifier: Centroid
  default: nan
  term: low Triangle 0 0.25 0.5
  term: high Triangle 0.5 0.75 1
RuleBlock: b
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: RULE
"""


def fll(rule: str = "if x is a then y is low", **changes: str) -> Imported:
    text = FLL.replace("RULE\n", f"{rule}\n")
    for line, new in changes.items():
        key = line.replace("_", "-")
        head, _, rest = text.partition(f"  {key}: ")
        text = f"{head}  {key}: {new}\n{rest.partition(chr(10))[2]}"
    return parse_fll(text)


def test_fll_has_a_thousand_midpoints_when_unstated() -> None:
    assert good(fll()).outputs[0].defuzzifier == Defuzzifier("centroid", 1000, "midpoints")
    assert good(fll(defuzzifier="Bisector 77")).outputs[0].defuzzifier.resolution == 77


def test_fll_does_not_clamp_unless_the_range_is_locked() -> None:
    assert good(fll()).inputs[0].outside == "extend"
    shapes = ours("shapes.fll")
    assert shapes.inputs[0].outside == "clamp"
    assert shapes.outputs[0].outside == "extend"


def test_fll_extremely_is_intensify_and_the_hedge_next_to_the_term_acts_first() -> None:
    rule = good(fll("if x is not extremely a then y is low")).rules[0]
    assert rule.antecedent == Is("x", "a", (Hedge("not"), Hedge("intensify")))


def test_fll_binds_and_tighter_than_or() -> None:
    rule = good(fll("if x is a or x is a and ( x is a or x is any ) then y is low")).rules[0]
    a = Is("x", "a")
    assert rule.antecedent == Or((a, And((a, Or((a, Is("x", "a", (Hedge("any"),))))))))


def test_fll_hedges_of_conclusions_change_the_degree_and_carry_on() -> None:
    rulebase = good(fll("if x is a then y is low and y is very high and y is somewhat low"))
    a = Is("x", "a")
    very = Hedge("very")
    assert [rule.antecedent for rule in rulebase.rules] == [
        a,
        Hedged((very,), a),
        Hedged((Hedge("somewhat"), very), a),
    ]


@pytest.mark.parametrize(("hedge", "power"), [("very", 2.0), ("somewhat", 0.5)])
def test_fll_weight_goes_through_hedges_that_are_powers(hedge: str, power: float) -> None:
    rule = good(fll(f"if x is a then y is {hedge} low with 0.64")).rules[0]
    assert rule.weight == pytest.approx(0.64**power, rel=1e-15)


def test_fll_weight_does_not_go_through_not() -> None:
    assert "hedged-weight" in {d.name for d in fll("if x is a then y is not low with 0.5").errors}


def test_fll_output_in_an_antecedent_means_its_activation() -> None:
    rulebase = ours("chain.fll")
    # At 0.6 dark is 0, medium 0.6 and bright 0.4. When the fan is asked for, power is low
    # to the degree max(bright, medium²) = 0.4 and high to 0, so that half of not high is
    # 0.5; the very before low goes on to the fan: medium² = 0.36.
    fan = infer(rulebase, light=0.6)["fan"]
    assert fan == pytest.approx(_bisector(0.4, 0.5), abs=2e-3)


def _bisector(off: float, on: float) -> float:
    """Half of the area of two clipped triangles on 0 … ½ and ½ … 1, off <= on."""
    area = [0.25 * (1 - (1 - h) ** 2) for h in (off, on)]
    rest = 0.5 * (area[0] + area[1]) - area[0]
    # the rising flank of the second is 4 (x - ½) up to the height `on`
    flank = on * on / 8
    return 0.5 + (math.sqrt(rest / 2) if rest <= flank else on / 4 + (rest - flank) / on)


def test_fll_threshold_is_carried_and_other_activations_are_not() -> None:
    assert ours("values.fll").blocks[0].threshold == 0.05
    assert "unsupported-activation" in {d.name for d in fll(activation="Highest 2").errors}
    lossy = parse_fll(FLL.replace("General", "First 1 0.5").replace("RULE", ""), lossy=True)
    assert "unsupported-activation" in names(lossy)


def test_fll_values_are_grouped_by_term_under_the_aggregation() -> None:
    rulebase = ours("values.fll")
    plane, total, steps = rulebase.outputs
    assert plane.aggregation == "sum"
    assert total.aggregation == "max"
    assert [o.defuzzifier.method for o in rulebase.outputs] == [
        "weighted-average", "weighted-sum", "tsukamoto",
    ]  # fmt: skip
    assert steps.no_rule == "hold"
    assert total.no_rule == 7.0


@pytest.mark.parametrize(
    ("text", "name", "line"),
    [
        (FLL.replace("Ramp 0 1", "Rampe 0 1"), "unknown-shape", 4),
        (FLL.replace("Ramp 0 1", "Ramp 0 1 2 3"), "parameter-count", 4),
        (FLL.replace("Ramp 0 1", "Ramp 0 x"), "not-a-number", 4),
        (FLL.replace("Ramp 0 1", "Gaussian 0 0"), "not-positive", 4),
        (FLL.replace("Ramp 0 1", "Function sin("), "bad-formula", 4),
        (FLL.replace("range: 0 1", "range: 0"), "bad-range", 3),
        (FLL.replace("Maximum\n  def", "Maximal\n  def"), "unknown-norm", 7),
        (FLL.replace("Centroid", "Centre"), "unknown-defuzzifier", 8),
        (FLL.replace("Centroid", "Centroid 0"), "bad-resolution", 8),
        (FLL.replace("RULE", "if x is b then y is low"), "undefined-term", 17),
        (FLL.replace("RULE", "if z is a then y is low"), "undefined-variable", 17),
        (FLL.replace("RULE", "if x is a then x is a"), "not-an-output", 17),
        (FLL.replace("RULE", "if x is verry a then y is low"), "unknown-hedge", 17),
        (FLL.replace("RULE", "if x is a y is low"), "syntax", 17),
        (FLL.replace("RULE", "if (x is a then y is low"), "syntax", 17),
        (FLL.replace("RULE", "if x is a then y is low with much"), "not-a-number", 17),
        (FLL.replace("RULE", "if x is a then y is low with 1.5"), "bad-weight", 17),
        (FLL.replace("lock", "luck").replace("RuleBlock: b", "RuleBlock: b\n  what: 1"),
         "unknown-key", 13),
        ("what: ever", "syntax", 1),
        ("", "no-engine", 1),
        ("Engine: a\nno colon", "syntax", 2),
    ],
)  # fmt: skip
def test_fll_faults_have_a_name_and_a_place(text: str, name: str, line: int) -> None:
    imported = parse_fll(text)
    assert imported.rulebase is None
    assert (name, line) in {(d.name, d.line) for d in imported.errors}


def test_every_mistake_of_a_file_in_one_run_with_what_was_meant() -> None:
    text = FLL.replace("Ramp", "Rampp").replace("Maximum\n  def", "Maximun\n  def")
    errors = parse_fll(text.replace("RULE", "if x is a then y is lo")).errors
    assert [d.name for d in errors] == ["unknown-shape", "unknown-norm", "undefined-term"]
    assert errors[0].replacement == "Ramp"
    assert errors[1].replacement == "Maximum"
    assert errors[-1].replacement == "low"


FIS_WITHOUT_RULES = """[System]
Name='a'
Type='mamdani'
[Input1]
Name='x'
Range=[0 10]
MF1='a':'trimf',[0 5 10]
[Output1]
Name='y'
Range=[0 10]
MF1='b':'trimf',[0 5 10]
[Rules]
"""


def test_a_stub_and_a_file_without_rules_are_errors() -> None:
    engine, _, _ = FLL.partition("OutputVariable")
    assert [d.name for d in parse_fll(engine).errors] == ["no-engine"]
    for without in (
        parse_fll(FLL.partition("RuleBlock")[0]),
        parse_fcl(FCL.partition("RULEBLOCK")[0] + "END_FUNCTION_BLOCK"),
        parse_fis(FIS_WITHOUT_RULES),
    ):
        assert [d.name for d in without.errors] == ["no-rules"]


def test_fll_norms_that_a_rule_needs_must_be_there() -> None:
    text = FLL.replace("conjunction: Minimum", "conjunction: none")
    errors = parse_fll(text.replace("RULE", "if x is a and x is a then y is low")).errors
    assert [(d.name, d.hint) for d in errors] == [
        ("missing-norm", "write conjunction: Minimum"),
    ]
    assert good(parse_fll(text.replace("RULE", "if x is a then y is low")))


def test_fll_what_is_switched_off_is_said() -> None:
    text = FLL.replace("RuleBlock: b", "RuleBlock: off\n  enabled: false\nRuleBlock: b")
    assert "disabled-block" in names(parse_fll(text.replace("RULE", "if x is a then y is low")))
    text = FLL.replace("OutputVariable: y", "OutputVariable: y\n  enabled: false")
    imported = parse_fll(text.replace("RULE", "if x is a then y is low"))
    assert "disabled-output" in names(imported)
    assert [d.name for d in imported.errors] == ["no-rules"]


def test_fll_of_two_terms_with_one_name_the_last_counts() -> None:
    imported = parse_fll(
        FLL.replace("Ramp 0 1", "Ramp 0 1\n  term: a Ramp 1 0").replace(
            "RULE", "if x is a then y is low"
        )
    )
    assert "duplicate-term-name" in names(imported)
    assert shape(good(imported), "x", "a") == Shape("ramp", (1.0, 0.0))


def test_fll_of_two_points_at_one_x_the_last_counts_there_alone() -> None:
    text = FLL.replace("low Triangle 0 0.25 0.5", "low Discrete 0 0 0.25 1 0.25 0 0.5 0 0.5 1 1 1")
    low = shape(good(parse_fll(text.replace("RULE\n", "if x is a then y is low\n"))), "y", "low")
    degree = membership_function(low)
    assert (degree(0.25), degree(0.5)) == (0.0, 1.0)
    assert degree(math.nextafter(0.25, 0.0)) == pytest.approx(1.0)
    assert degree(0.25 - 1e-9) == pytest.approx(1.0, abs=1e-8)
    assert degree(math.nextafter(0.5, 0.0)) == pytest.approx(0.0)


def test_fll_older_spellings_are_read() -> None:
    text = FLL.replace("aggregation:", "accumulation:").replace("General", "AlgebraicProduct")
    rulebase = good(parse_fll(text.replace("RULE", "if x is a then y is low")))
    assert rulebase.blocks[0].implication == "product"
    assert rulebase.outputs[0].aggregation == "max"


def test_fll_a_triangle_with_a_foot_at_infinity_is_a_shoulder() -> None:
    text = FLL.replace("Ramp 0 1", "Triangle -inf 0.25 0.75").replace(
        "RULE", "if x is a then y is low"
    )
    assert shape(good(parse_fll(text)), "x", "a") == Shape(
        "trapezoid", (-math.inf, 0.25, 0.25, 0.75)
    )


# ── FIS ──────────────────────────────────────────────────────────────────────────────

FIS = (DATA / "tipper_matlab.fis").read_text()


def test_fis_of_matlab_sums_101_points_and_takes_the_middle_where_no_rule_fires() -> None:
    tip, smile = ours("tipper_matlab.fis").outputs
    assert tip.defuzzifier == Defuzzifier("centroid", 101, "endpoints")
    assert (tip.no_rule, smile.no_rule) == (15.0, 0.5)


def test_fis_names_are_kept_and_ranges_may_be_products_of_pi() -> None:
    rulebase = ours("tipper_matlab.fis")
    assert [v.name for v in rulebase.inputs] == ["how good, really?", "food"]
    assert rulebase.inputs[0].terms[1].name == "good: fine"
    assert rulebase.inputs[1].low == -math.pi / 4


def test_fis_numbers_of_functions_come_in_the_order_of_the_model() -> None:
    rulebase = ours("tipper_matlab.fis")
    assert shape(rulebase, "how good, really?", "so-so") == Shape("gaussian", (0.0, 1.75))
    assert shape(rulebase, "how good, really?", "good: fine") == Shape("bell", (5.0, 2.0, 2.5))
    assert shape(rulebase, "food", "hot") == Shape("ramp", (-0.25, 0.5))
    assert shape(rulebase, "tip", "much") == Shape("sigmoid-product", (20.0, 2.0, 28.0, -3.0))


def test_fis_rules_by_number() -> None:
    rules = ours("tipper_matlab.fis").rules
    first, second = Is("how good, really?", "so-so"), Is("food", "cold")
    assert rules[0].antecedent == Or((first, second))
    assert rules[1].antecedent == Is("how good, really?", "good: fine")
    assert rules[1].weight == 0.5
    assert rules[2].antecedent == And(
        (Is("how good, really?", "so-so", (Hedge("not"),)), Is("food", "hot"))
    )
    assert rules[4].consequents[0].hedges == (Hedge("not"),)


@pytest.mark.parametrize(
    ("producer", "hedge"), [("octave", Hedge("extremely")), ("fuzzylite", Hedge("intensify"))]
)
def test_fis_fractions_are_hedges_of_the_program(producer: str, hedge: Hedge) -> None:
    text = FIS.replace("1 1, 1 1 (1) : 2", "1.30 1, 1 1 (1) : 2")
    rule = good(parse_fis(text, producer=producer, lossy=True)).rules[0]
    assert rule.antecedent.operands[0].hedges == (hedge,)  # type: ignore[union-attr]


def test_fis_of_octave_takes_roots_where_a_value_is_hedged() -> None:
    rules = ours("sugeno_octave.fis").rules
    assert isinstance(rules[2].antecedent, Hedged)
    assert rules[2].antecedent.hedges == (Hedge("somewhat"),)
    assert rules[2].weight == 0.5**0.5


def test_fis_programs_are_told_apart() -> None:
    for name in ("tipper_matlab.fis", "sugeno_octave.fis", "lamp_fuzzylite.fis"):
        assert read(DATA / name).producer == name.partition("_")[2].removesuffix(".fis")


def test_fis_of_fuzzylite_fires_above_a_millionth_and_has_the_mean_of_nothing() -> None:
    rulebase = ours("lamp_fuzzylite.fis")
    assert rulebase.blocks[0].threshold == 1e-6
    lamp, hum = rulebase.outputs
    # The Default of 12.5 never counts: fuzzylite 7 gives 24.9999… where no rule fires.
    assert (lamp.no_rule, hum.no_rule) == (0.5, 25.0)
    assert (lamp.outside, hum.outside) == ("clamp", "extend")


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("NumRules=5", "NumRules=4", "wrong-count"),
        ("1 1, 1 1 (1) : 2", "4 1, 1 1 (1) : 2", "undefined-term"),
        ("1 1, 1 1 (1) : 2", "1, 1 1 (1) : 2", "wrong-count"),
        ("1 1, 1 1 (1) : 2", "1 1, 1 1 (1) : 3", "bad-connective"),
        ("1 1, 1 1 (1) : 2", "1 1, 1 1 (x) : 2", "not-a-number"),
        ("1 1, 1 1 (1) : 2", "1 1, 1 1 (-0.5) : 2", "bad-weight"),
        ("1 1, 1 1 (1) : 2", "0 0, 1 1 (1) : 2", "empty-rule"),
        ("1 1, 1 1 (1) : 2", "1 1, 1 1", "missing-weight"),
        ("1 1, 1 1 (1) : 2", "1 1 1 1 (1) : 2", "syntax"),
        ("'trapmf'", "'mymf'", "unknown-shape"),
        ("'trapmf'", "'trampmf'", "unknown-shape"),
        ("'trapmf',[-1 -0.8 -0.5 0]", "'trapmf',[-1 -0.8 -0.5]", "parameter-count"),
        ("'prod'", "'prd'", "unknown-norm"),
        ("'centroid'", "'center'", "unknown-defuzzifier"),
        ("Range=[0 30]", "Range=[30 0]", "bad-range"),
        ("Range=[0 30]", "Range=[30]", "bad-range"),
        ("MF2='middling'", "MF2='little'", "duplicate-term-name"),
        ("[Output2]", "[Output1]", "duplicate-section"),
        ("Name='food'", "Nme='food'", "unknown-key"),
        ("Name='food'", "Name='food", "syntax"),
        ("Name='food'", "Name='", "syntax"),
        ("[Rules]", "[Rule]", "syntax"),
    ],
)
def test_fis_findings_have_a_name_and_a_place(old: str, new: str, name: str) -> None:
    assert old in FIS
    imported = parse_fis(FIS.replace(old, new, 1))
    assert name in names(imported)
    found = next(d for d in imported.diagnostics if d.name == name)
    assert found.line > 1


def test_fis_sections_go_by_number() -> None:
    first, second = FIS.index("[Input1]"), FIS.index("[Input2]")
    end = FIS.index("[Output1]")
    swapped = FIS[:first] + FIS[second:end] + FIS[first:second] + FIS[end:]
    assert good(parse_fis(swapped)) == ours("tipper_matlab.fis")


def test_fis_terms_with_one_name_are_told_apart_by_number() -> None:
    rulebase = good(parse_fis(FIS.replace("MF2='middling'", "MF2='little'")))
    assert [t.name for t in rulebase.outputs[0].terms] == ["little", "little_2", "much"]
    assert rulebase.rules[1].consequents[0].term == "little_2"


# ── FCL ──────────────────────────────────────────────────────────────────────────────

FCL = (DATA / "pump_jfuzzylogic.fcl").read_text()


def test_fcl_of_jfuzzylogic_takes_a_thousand_left_points() -> None:
    power, valve = ours("pump_jfuzzylogic.fcl").outputs
    assert power.defuzzifier == Defuzzifier("centroid", 1000, "left")
    assert (power.low, power.high) == (0.0, 100.0)
    assert valve.no_rule == "hold"
    assert power.aggregation == valve.aggregation == "bounded"


def test_fcl_of_jfuzzylogic_sets_or_by_and_and_adds_up_unless_told() -> None:
    block = ours("pump_jfuzzylogic.fcl").blocks[0]
    assert (block.conjunction, block.disjunction) == ("product", "probor")
    text = FCL.replace("  ACCU : BSUM;\n", "")
    assert {o.aggregation for o in good(parse_fcl(text)).outputs} == {"sum"}


@pytest.mark.parametrize(
    ("norms", "said"),
    [
        ("AND : MIN; OR : ASUM;", True),
        ("AND : PROD; OR : MAX;", True),
        ("AND : MIN; OR : MAX;", False),
    ],
)
def test_fcl_of_jfuzzylogic_says_where_one_norm_overrides_the_other(norms: str, said: bool) -> None:
    text = re.sub(r"AND : \w+;", norms, FCL, count=1)
    assert text != FCL
    assert ("paired-norms" in names(parse_fcl(text))) is said


@settings(max_examples=cases(8, 25))
@given(
    st.sampled_from([(0.0, 1.0), (-1.0, 11.0), (-0.3, 0.4), (2.5, 102.5), (-6.0, 4.0)]),
    st.lists(st.integers(0, 100), min_size=2, max_size=2, unique=True).map(sorted),
    st.sampled_from(["TRAPE {0} {0} {1} {1}", "TRIAN {0} {0} {1}", "TRIAN {0} {1} {1}"]),
)
def test_fcl_edges_are_seen_from_the_side_of_jfuzzylogic(
    ends: tuple[float, float], percents: list[int], kind: str
) -> None:
    """It goes from sample to sample by adding up steps; so does this test."""
    low, high = ends
    first, last = (round(low + (high - low) * each / 100, 6) for each in percents)
    text = FCL.replace("TRIAN 0 0 30;", f"{kind.format(first, last)};")
    text = text.replace("METHOD : COG;", f"METHOD : COG; RANGE := ({low} .. {high});")
    output = good(parse_fcl(text)).outputs[0]
    assert (output.low, output.high) == (low, high)
    degree = membership_function(output.term("off").shape)
    step = (output.high - output.low) / 1000
    walked = output.low
    for k in range(1000):
        if not first <= walked <= last:
            wanted = 0.0
        elif kind.startswith("TRAPE"):
            wanted = 1.0
        else:
            way = last - walked if kind == "TRIAN {0} {0} {1}" else walked - first
            wanted = way / (last - first)
        assert degree(output.low + k * step) == pytest.approx(wanted, abs=1e-9)
        walked += step


def test_fcl_of_jfuzzylogic_binds_and_and_or_alike() -> None:
    rule = ours("pump_jfuzzylogic.fcl").rules[2]
    assert rule.antecedent == And(
        (Or((Is("level", "low"), Is("flow", "back"))), Is("level", "wave"))
    )


def test_fcl_prefix_not() -> None:
    rules = ours("pump_jfuzzylogic.fcl").rules
    assert isinstance(rules[1].antecedent, Hedged)
    assert rules[3].antecedent.operands[0] == Is("level", "soft", (Hedge("not"),))  # type: ignore[union-attr]


def test_fcl_functions_come_in_the_order_of_the_model() -> None:
    rulebase = ours("pump_jfuzzylogic.fcl")
    assert shape(rulebase, "level", "wave") == Shape("cosine", (5.0, 4.0))
    assert shape(rulebase, "level", "soft") == Shape("bell", (5.0, 2.0, 3.0))
    assert shape(rulebase, "flow", "back") == Shape("sigmoid", (0.0, -4.0))
    assert shape(rulebase, "flow", "slow") == Shape("sigmoid-difference", (-1.0, 4.0, 1.0, 4.0))
    assert shape(rulebase, "valve", "same").formula == "2 * level - sin(flow) ^ 2 / (1 + 1)"


def test_fcl_of_fuzzylite() -> None:
    rulebase = ours("oven_fuzzylite.fcl")
    gas, lamp = rulebase.outputs
    assert gas.defuzzifier == Defuzzifier("bisector", 1000, "midpoints")
    assert (gas.aggregation, gas.no_rule, gas.outside) == ("normalized", "hold", "clamp")
    assert (lamp.defuzzifier.method, lamp.no_rule) == ("weighted-average", 0.25)
    assert rulebase.blocks[0].conjunction == "einstein"
    hedged = rulebase.blocks[1]  # it fires where `very cold` is above 1e-6, then is intensified
    assert isinstance(hedged.rules[0].antecedent, Hedged)
    assert hedged.threshold == pytest.approx(2e-12)


def test_fcl_of_fuzzylite_in_capitals() -> None:
    text = (DATA / "oven_fuzzylite.fcl").read_text()
    loud = re.sub(r"\b(if|is|and|or|then|with)\b", lambda word: word.group().upper(), text)
    assert loud != text
    assert good(parse_fcl(loud)) == good(parse_fcl(text))


@pytest.mark.parametrize(
    ("function", "end", "degree"),
    [
        ("GBELL 2 3 5", "high", 1e-3),
        ("GBELL 2 0.75 5", "low", 1e-3),
        ("GAUSS 1 0.5", "low", math.exp(-8.0)),
        ("GAUSS2 1 0.5 2 0.75", "high", math.exp(-8.0)),
        ("SIGM -4 1", "high", 1.0 / (1.0 + math.exp(9.0))),
        ("SIGM 3 1", "low", 1.0 / (1.0 + math.exp(9.0))),
        ("COSINE 2 5", "high", 0.0),
    ],
)
def test_fcl_without_a_range_goes_as_far_as_the_terms(
    function: str, end: str, degree: float
) -> None:
    level = FCL[FCL.index("  TERM low") : FCL.index("END_FUZZIFY")]
    text = FCL.replace(level, f"  TERM low := {function};\n")
    text = re.sub(r"  RULE (2|three|4) .*\n", "", text)
    variable = good(parse_fcl(text)).inputs[0]
    found = membership_function(variable.terms[0].shape)(getattr(variable, end))
    assert found == pytest.approx(degree, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("TRIAN 2 5 8", "TRAIN 2 5 8", "unknown-shape"),
        ("TRIAN 2 5 8", "TRIAN 2 5", "parameter-count"),
        ("TRIAN 2 5 8", "TRIAN 2 flow 8", "moving-corner"),
        ("(0, 1) (2, 1)", "(0, 1) (2, flow)", "moving-corner"),
        ("(0, 1) (2, 1)", "(3, 1) (2, 1)", "unordered-points"),
        ("METHOD : COG;", "METHOD : COX;", "unknown-defuzzifier"),
        ("METHOD : COG;", "METHOD : CM;", "unknown-defuzzifier"),
        ("ACCU : BSUM;", "ACCU : BSM;", "unknown-norm"),
        ("THEN power IS max,", "THEN power IS most,", "undefined-term"),
        ("THEN power IS max,", "THEN pwr IS max,", "undefined-variable"),
        ("IF level IS low AND", "IF level low AND", "syntax"),
        ("END_RULEBLOCK", "", "missing-end"),
        ("END_FUZZIFY", "END_FUZIFY", "syntax"),
        ("FUZZIFY flow", "FUZZIFY flew", "undeclared-variable"),
        ("(* norms by pairs *)", "(* norms by pairs", "open-comment"),
        ("FUNCTION 2 * level", "FUNCTION 2 * (level", "bad-formula"),
        ("DEFAULT := 0", "DEFAULT := zero", "not-a-number"),
        ("IS low AND flow IS", "IS Low AND flow IS", "case-differs"),
    ],
)
def test_fcl_findings_have_a_name_and_a_place(old: str, new: str, name: str) -> None:
    assert old in FCL
    imported = parse_fcl(FCL.replace(old, new, 1))
    assert name in names(imported)
    assert next(d for d in imported.diagnostics if d.name == name).line > 1


def test_fcl_block_is_chosen_by_name_and_the_others_are_said() -> None:
    text = f"{FCL}\n{FCL.replace('FUNCTION_BLOCK pump', 'FUNCTION_BLOCK spare', 1)}"
    assert good(parse_fcl(text)).name == "pump"
    assert "several-blocks" in names(parse_fcl(text))
    assert good(parse_fcl(text, block="spare")).name == "spare"
    assert "unknown-block" in names(parse_fcl(text, block="spore"))


def test_fcl_semicolons_may_be_missing() -> None:
    text = (DATA / "oven_fuzzylite.fcl").read_text()
    assert good(parse_fcl(text.replace(";", ""))) == good(parse_fcl(text))


# ── all ──────────────────────────────────────────────────────────────────────────────


def test_latin_1_is_read_and_said(tmp_path: Path) -> None:
    path = tmp_path / "a.fis"
    path.write_bytes(FIS.replace("food", "früh").encode("latin-1"))
    imported = read(path)
    assert good(imported).inputs[1].name == "früh"
    finding = next(d for d in imported.diagnostics if d.name == "not-utf-8")
    assert (finding.line, finding.column) == (FIS[: FIS.index("food")].count("\n") + 1, 9)


@pytest.mark.parametrize("suffix", [".fll", ".fcl", ".fis"])
def test_absurd_length_is_refused(suffix: str) -> None:
    assert names(parse("x" * (MAX_CHARACTERS + 1), suffix)) == {"too-long"}


@pytest.mark.parametrize("suffix", [".fll", ".fcl", ".fis"])
def test_line_ends_of_other_systems_do_not_matter(suffix: str) -> None:
    path = next(DATA.glob(f"*{suffix}"))
    text = path.read_text()
    for end in ("\r\n", "\r"):
        assert parse(text.replace("\n", end), suffix).rulebase == parse(text, suffix).rulebase


# ── FCL as people write it ───────────────────────────────────────────────────────────

DIMMER = """FUNCTION_BLOCK simple-dimmer (new, 2) // a name to the end of the line
VAR_INPUT v : REAL; END_VAR
VAR_OUTPUT y : REAL; END_VAR
FUZZIFY v
 RANGE := (0 .. 1) WITH 0.01;
 TERM a := (0, 1) (1, 0);
 TERM b := (0, 0) (1, 1);
END_FUZZIFY
DEFUZZIFY y
 RANGE := (0 .. 8) WITH 0.01;
 TERM lo := 0; TERM hi := 8;
 METHOD : COGS;
 DEFAULT := 0;
END_DEFUZZIFY
RULEBLOCK No-1 of two
 AND : MIN;
 RULE 1 : IF v IS a THEN (y IS lo);
 RULE 2 : IF (v IS b) THEN ((y IS hi)) WITH 0.5;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""
SETS = {"lo := 0;": "lo := (0, 1) (4, 0);", "hi := 8;": "hi := (4, 0) (8, 1);"}


def dimmer(changes: dict[str, str], **options: bool) -> Imported:
    text = DIMMER
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return parse(text, ".fcl", producer="jfuzzylogic", **options)


def test_fcl_names_of_blocks_reach_to_the_end_of_the_line() -> None:
    rulebase = good(dimmer({}))
    assert rulebase.name == "simple-dimmer (new, 2)"
    assert rulebase.blocks[0].name == "No-1 of two"
    one_line = good(
        parse(DIMMER.replace("// a name to the end of the line", "").replace("\n", " "), ".fcl")
    )
    assert one_line.name == "simple-dimmer (new, 2)"


def test_fcl_steps_of_ranges_and_conclusions_in_parentheses() -> None:
    imported = dimmer({})
    # at 0.25 lo fires with 0.75 and hi with 0.5 * 0.25
    assert infer(good(imported), v=0.25)["y"] == pytest.approx(8 * 0.125 / 0.875)
    assert [d.line for d in imported.diagnostics if d.name == "dropped-step"] == [5, 10]


def test_fcl_text_behind_the_end_is_one_warning() -> None:
    imported = dimmer(
        {"END_FUNCTION_BLOCK": "END_FUNCTION_BLOCK;\nThat is: FUZZIFY all of it\n(ok)"}
    )
    assert good(imported).name == "simple-dimmer (new, 2)"
    assert [d.line for d in imported.diagnostics if d.name == "trailing-text"] == [21]


def test_fcl_integral_of_singletons_is_read_as_their_average() -> None:
    imported = dimmer({"COGS": "COG"})
    assert good(imported).outputs[0].defuzzifier == Defuzzifier("weighted-average")
    assert "value-as-set" in {d.name for d in imported.diagnostics if d.severity == "warning"}


@pytest.mark.parametrize("word", ["MM", "MOM"])
def test_fcl_mean_of_maximum_says_where_it_differs(word: str) -> None:
    changes = {**SETS, "COGS": word}
    imported = dimmer(changes)
    assert good(imported).outputs[0].defuzzifier.method == "mean-of-maximum"
    assert "mean-of-maximum" in {d.name for d in imported.diagnostics if d.severity == "warning"}
    strict = dimmer(changes, strict=True)
    assert {d.name for d in strict.errors} == {"mean-of-maximum"}
    assert dimmer(changes, strict=True, lossy=True).rulebase is not None


def test_a_refused_term_is_one_finding() -> None:
    for number in ("1.5.5", "x", "(1, y)"):
        assert len(dimmer({"hi := 8;": f"hi := {number};"}).errors) == 1
    assert len(fll(term="a Ramp 0.1.2 1").errors) == 1


@pytest.mark.parametrize("number", ["1.52.5", ".5.5", "1e1.5", "0.5.", "1.5e"])
def test_adjacent_numbers_are_not_two(number: str) -> None:
    data = {
        ".fll": (DATA / "chain.fll").read_text(),
        ".fcl": DIMMER,
        ".fis": (DATA / "tipper_matlab.fis").read_text(),
    }
    place = {".fll": " 0.5 ", ".fcl": " 0.5;", ".fis": " -0.5 "}
    for suffix, old in place.items():
        assert parse(data[suffix], suffix).rulebase is not None
        text = data[suffix].replace(old, old.replace("0.5", number), 1)
        errors = parse(text, suffix).errors
        assert errors, (suffix, number)
        assert errors[0].line == data[suffix][: data[suffix].index(old)].count("\n") + 1


def test_jfuzzylogic_takes_powers_from_the_left() -> None:
    # Its grammar: fun_mp : fun_atom ((HAT^ | PERCENT^) fun_atom)*, so (2 ^ 3) ^ 2 = 64, not 2 ^ 9.
    for text, value in (
        ("2 ^ 3 ^ 2", 64.0), ("2 ^ (3 ^ 2)", 512.0), ("7 % 4 ^ 2", 9.0), ("2 * 3 ^ 2", 18.0),
        ("8 / 2 / 2", 2.0), ("8 - 4 - 2", 2.0), ("v ^ 2 ^ 2", 0.0625),
    ):  # fmt: skip
        rulebase = good(
            dimmer({"lo := 0;": f"lo := FUNCTION {text};", "hi := 8;": f"hi := FUNCTION {text};"})
        )
        assert infer(rulebase, v=0.5)["y"] == pytest.approx(value), text
        again = good(parse(str(write(rulebase, ".fcl", producer="jfuzzylogic").text), ".fcl"))
        assert infer(again, v=0.5)["y"] == pytest.approx(value), text


CIRCLE = "RULE 3 : IF y IS hi THEN y IS lo;\nEND_RULEBLOCK"


def test_outputs_that_wait_for_themselves_are_refused_even_with_losses() -> None:
    changes = {**SETS, "COGS": "COG", "END_RULEBLOCK": CIRCLE}
    for lossy in (False, True):
        imported = dimmer(changes, lossy=lossy)
        assert {d.name for d in imported.errors} == {"chained-output"}
        assert {d.line for d in imported.errors} == {19}
    later = {**changes, "END_RULEBLOCK": "END_RULEBLOCK\nRULEBLOCK b\n" + CIRCLE}
    assert {d.name for d in dimmer(later, lossy=True).errors} == {"chained-output"}
    itself = dimmer({"hi := 8;": "hi := FUNCTION y + 1;"}, lossy=True)
    assert {d.name for d in itself.errors} == {"chained-output"}


def test_formulas_ask_for_variables_that_are_there() -> None:
    errors = dimmer({"hi := 8;": "hi := FUNCTION v + q;"}).errors
    assert [(d.name, d.line) for d in errors] == [("undefined-variable", 11)]


def test_tsukamoto_needs_the_inverse_of_what_rules_conclude() -> None:
    text = FLL.replace("defuzzifier: Centroid", "defuzzifier: WeightedAverage Tsukamoto")
    text = text.replace("low Triangle 0 0.25 0.5", "low Ramp 0 1")
    assert good(parse_fll(text.replace("RULE", "if x is a then y is low")))
    errors = parse_fll(text.replace("RULE", "if x is a then y is high")).errors
    assert [d.name for d in errors] == ["not-monotonic"]
