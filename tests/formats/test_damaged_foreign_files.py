"""Files that nobody writes: each has findings, and takes no longer than its length."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType

import pytest

from fuzzyarm.exchange.formats import Imported, parse_fcl, parse_fis, parse_fll, parse_fml
from fuzzyarm.exchange.formats.fcl_reader import detect as detect_fcl
from fuzzyarm.exchange.formats.findings import TextPiece, number
from fuzzyarm.exchange.formats.fis_text import detect as detect_fis
from fuzzyarm.exchange.formats.fis_text import membership_parts
from fuzzyarm.exchange.formats.fis_type2 import is_of_toolbox

SYSTEM = """<?xml version="1.0"?><fuzzySystem name="s"><knowledgeBase>
<fuzzyVariable name="x" domainleft="0" domainright="10" type="input">
<fuzzyTerm name="A"><triangularShape param1="0" param2="3" param3="10"/></fuzzyTerm>
<fuzzyTerm name="B"><triangularShape param1="0" param2="7" param3="10"/></fuzzyTerm>
{terms}</fuzzyVariable>{inputs}
<fuzzyVariable name="y" domainleft="0" domainright="10" type="output">
<fuzzyTerm name="P"><triangularShape param1="0" param2="3" param3="10"/></fuzzyTerm>
</fuzzyVariable>{outputs}</knowledgeBase>
<mamdaniRuleBase name="r"><rule name="1"><antecedent><clause><variable>x</variable><term>A</term>
</clause></antecedent><consequent><then><clause><variable>y</variable><term>P</term></clause>
</then></consequent></rule></mamdaniRuleBase></fuzzySystem>"""


def fml(terms: str = "", inputs: str = "", outputs: str = "") -> Imported:
    return parse_fml(SYSTEM.format(terms=terms, inputs=inputs, outputs=outputs))


def circular(name: str, inside: str) -> str:
    definition = f"<circularDefinition>{inside}</circularDefinition>"
    return f'<fuzzyTerm name="{name}">{definition}</fuzzyTerm>'


LINEAR = """<tskVariable name="z" combination="WA"><tskTerm name="T" order="1">
<tskValue>1</tskValue><tskValue>2</tskValue></tskTerm></tskVariable>"""


@pytest.mark.parametrize("name", ['name="x"', 'name=""', ""])
def test_inputs_without_a_name_of_their_own(name: str) -> None:
    second = f'<fuzzyVariable {name} domainleft="0" domainright="1" type="input"></fuzzyVariable>'
    found = {d.name for d in fml(inputs=second, outputs=LINEAR).errors}
    assert found == {"duplicate-variable" if "x" in name else "missing-name"}


@pytest.mark.parametrize(
    "inside", ['<and t-norm="XX"></and>', '<and t-norm="XX"><termName>A</termName></and>']
)
def test_a_circular_definition_of_too_little(inside: str) -> None:
    found = [d.message for d in fml(circular("C", inside)).errors]
    assert "<and> joins two terms" in found


@pytest.mark.slow
def test_a_circular_definition_of_many_terms() -> None:
    many = fml(circular("C", f"<and>{'<termName>A</termName>' * 1200}</and>"))
    few = fml(circular("C", "<and><termName>A</termName><termName>A</termName></and>"))
    assert many.rulebase == few.rulebase


def test_circular_definitions_stand_in_any_order() -> None:
    both = "<and><termName>{}</termName><termName>{}</termName></and>"
    terms = [
        ("C", both.format("D", "A")),
        ("D", both.format("E", "B")),
        ("E", both.format("A", "B")),
    ]
    forward = fml("".join(circular(*term) for term in terms)).rulebase
    backward = fml("".join(circular(*term) for term in reversed(terms))).rulebase
    for name in "CDE":
        one, other = (rb.inputs[0].term(name).shape for rb in (forward, backward))
        assert one == other
    itself = fml(circular("C", both.format("C", "A"))).errors
    assert [d.message for d in itself] == ["'x' has no term 'C'"]


FIS = """[System]
Name='t'
Type='{kind}'
NumInputs=1
NumOutputs=1
NumRules=1
DefuzzMethod='{method}'
{more}
[Input1]
Name='x'
Range=[0 10]
NumMFs=1
{terms}

[Output1]
Name='y'
Range=[0 10]
NumMFs=1
MF1='b':'constant',[1]

[Rules]
1, 1 (1) : 1
"""


@pytest.mark.parametrize("height", ["inf", "-inf", "nan"])
def test_a_height_is_finite(height: str) -> None:
    terms = f"MF1U='a':'trimf',[0 2 8 1]\nMF1L='a':'trimf',[1 2 8 {height}]"
    more = "TypeRedMethod='Karnik-Mendel'"
    text = FIS.format(kind="sugeno", method="wtaver", more=more, terms=terms)
    assert {d.name for d in parse_fis(text).errors} & {"not-finite", "not-a-number"}
    plain = FIS.format(
        kind="sugeno", method="wtaver", more="", terms=f"MF1='a':'trimf',[0 2 8 {height}]"
    )
    assert {d.name for d in parse_fis(plain, producer="fuzzylite").errors} & {
        "not-finite",
        "not-a-number",
    }


# --- Blocks that are switched off, and norms that are read once ---

FLL = """Engine: e
InputVariable: x
  range: 0.000 1.000
  term: a Ramp 0 1
OutputVariable: y
  range: 0.000 10.000
  aggregation: Maximum
  defuzzifier: Centroid 100
  term: b {term}
RuleBlock: one
  conjunction: none
  disjunction: none
  implication: Minimum
  activation: General
  rule: if x is a then y is b
{more}"""
OFF = """RuleBlock: off
  enabled: false
  implication: AlgebraicProduct
  activation: General
"""
FCL = """FUNCTION_BLOCK A
VAR_INPUT x : REAL; END_VAR
VAR_OUTPUT y : REAL; z : REAL; END_VAR
FUZZIFY x
  RANGE := (0 .. 1);
  TERM a := Ramp 0 1;
END_FUZZIFY
DEFUZZIFY y
  RANGE := (0 .. 10);
  TERM b := {term};
  METHOD : COG;
  ACCU : MAX;
END_DEFUZZIFY
DEFUZZIFY z
  RANGE := (0 .. 10);
  TERM b := Triangle 0 5 10;
  METHOD : COG;
  ACCU : MAX;
END_DEFUZZIFY
RULEBLOCK one
  AND : MIN; ACT : {norm};
  RULE 1 : if x is a then y is b;
END_RULEBLOCK
{more}
END_FUNCTION_BLOCK
"""
OFF_IN_FCL = """RULEBLOCK two
  ENABLED : FALSE;
  ACT : PROD;
END_RULEBLOCK
"""


@pytest.mark.parametrize("term", ["Constant 2", "Function x/5-0.5"])
def test_a_block_that_is_off_has_no_implication(term: str) -> None:
    with_it = parse_fll(FLL.format(term=term, more=OFF))
    assert not with_it.errors
    assert with_it.rulebase == parse_fll(FLL.format(term=term, more="")).rulebase


def test_a_block_that_is_off_has_none_in_fcl_either() -> None:
    texts = [
        FCL.format(term="Function x/5-0.5", norm="MIN", more=more) for more in (OFF_IN_FCL, "")
    ]
    one, other = (parse_fcl(text, dialect="fuzzylite") for text in texts)
    assert not one.errors
    assert one.rulebase == other.rulebase


def test_a_wrong_norm_is_said_once() -> None:
    text = FCL.format(term="Triangle 0 5 10", norm="FOO", more="")
    (error,) = parse_fcl(text, dialect="fuzzylite").errors
    assert error.message == "the norm for ACT 'FOO' is not known"


# --- Texts whose reading took the square of their length ---


@pytest.mark.slow
@pytest.mark.parametrize(
    ("read", "piece"),
    [
        (detect_fcl, "FUZZIFY "),
        (detect_fcl, "\n"),
        (detect_fcl, "(* "),
        (lambda text: membership_parts(TextPiece("a" + text + "b")), " "),
        (lambda text: membership_parts(TextPiece(f"a:b,[1{text}2]")), " "),
        (detect_fcl, "END_FUZZIFY FUZZIFY "),
        (is_of_toolbox, "\n"),
        (detect_fis, "\n"),
        (lambda text: detect_fis("[Rules]\n" + text), "1\n"),
        (lambda text: number(text + "x"), "1"),
    ],
)
def test_time_grows_with_the_length(read: Callable[[str], object], piece: str) -> None:
    """A million pieces: hours if a piece were compared with every other."""
    read(piece * 1_000_000)


def test_a_hedged_condition_is_sampled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    head = (
        FCL.partition("  RULE 1")[0]
        .format(term="Triangle 0 5 10", norm="MIN")
        .replace("Ramp 0 1", "Gaussian 0.5 0.02")
    )
    rules = "\n".join(f"RULE {i} : if x is very a then y is not b;" for i in range(20))
    asked = 0

    def count(frame: FrameType, event: str, _: object) -> None:
        nonlocal asked
        asked += event == "call" and frame.f_code.co_name == "_faint"

    sys.setprofile(count)
    try:
        parse_fcl(f"{head}{rules}\nEND_RULEBLOCK\nEND_FUNCTION_BLOCK\n", dialect="fuzzylite")
    finally:
        sys.setprofile(None)
    assert asked == 1
