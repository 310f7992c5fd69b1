"""FML (IEEE 1855): numbers worked out by hand from the standard's equations, and faults."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import exp, sqrt
from pathlib import Path

import pytest

from fuzzyarm import check_file, load
from fuzzyarm.apps.cli.main import main
from fuzzyarm.exchange.formats import Imported, parse, read, write
from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import Defuzzifier, RuleBase, Shape
from fuzzyarm.language.model.shapes import membership

DATA = Path(__file__).parent / "data"
FAN = (DATA / "fan_ieee1855.fml").read_text(encoding="utf-8")
HEATER = (DATA / "heater_ieee1855.fml").read_text(encoding="utf-8")


def good(imported: Imported) -> RuleBase:
    assert imported.rulebase is not None, [str(d) for d in imported.errors]
    return imported.rulebase


def changed(text: str, *pairs: tuple[str, str]) -> str:
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return text


# ── numbers ──────────────────────────────────────────────────────────────────────────

SHAPES: dict[str, Callable[[float], float]] = {
    '<triangularShape param1="1" param2="4" param3="9"/>': lambda x: max(
        min((x - 1) / 3, (9 - x) / 5), 0.0
    ),
    '<trapezoidShape param1="1" param2="4" param3="5" param4="9"/>': lambda x: max(
        min((x - 1) / 3, 1.0, (9 - x) / 4), 0.0
    ),
    '<rightLinearShape param1="2" param2="8"/>': lambda x: min(max((x - 2) / 6, 0.0), 1.0),
    '<leftLinearShape param1="2" param2="8"/>': lambda x: min(max((8 - x) / 6, 0.0), 1.0),
    '<gaussianShape param1="5" param2="2"/>': lambda x: exp(-((x - 5) ** 2) / 8),
    '<rightGaussianShape param1="6" param2="2"/>': lambda x: exp(-((min(x, 6) - 6) ** 2) / 8),
    '<leftGaussianShape param1="4" param2="2"/>': lambda x: exp(-((max(x, 4) - 4) ** 2) / 8),
    '<rectangularShape param1="2.5" param2="7.5"/>': lambda x: float(2.5 <= x <= 7.5),
    '<zShape param1="1" param2="9"/>': lambda x: (
        1 - 2 * ((max(x, 1) - 1) / 8) ** 2 if x <= 5 else 2 * ((9 - min(x, 9)) / 8) ** 2
    ),
    '<sShape param1="1" param2="9"/>': lambda x: (
        2 * ((max(x, 1) - 1) / 8) ** 2 if x <= 5 else 1 - 2 * ((9 - min(x, 9)) / 8) ** 2
    ),
    # From 0 at 1 up to 1 at 5, and down to 0 at 9.
    '<piShape param1="1" param2="5"/>': lambda x: (
        2 * (max(4 - abs(x - 5), 0.0) / 4) ** 2
        if abs(x - 5) >= 2
        else 1 - 2 * (abs(x - 5) / 4) ** 2
    ),
    '<pointSetShape><point x="1" y="0.5"/><point x="5" y="1"/><point x="9" y="0"/></pointSetShape>':
        lambda x: 0.5 + max(x - 1, 0.0) / 8 if x <= 5 else max((9 - x) / 4, 0.0),
}  # fmt: skip


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes(shape: str) -> None:
    text = changed(HEATER, ('<leftLinearShape param1="2" param2="8"/>', shape))
    term = good(parse(text, ".fml")).inputs[0].terms[0]
    for step in range(81):
        x = step / 8 + 0.01 * (step < 80)
        assert membership(term.shape, x) == pytest.approx(SHAPES[shape](x), abs=1e-12), x


def test_a_mamdani_rule_base() -> None:
    # At 5 and 0.25 cold is ½, dry ¾, wet ½. Slow gets min(½, ¾) = ½ and is 1 wide around ½;
    # fast gets 0.8 × (1 − ½) × ½² = 0.1 and is 2 wide around 3.
    rulebase = good(parse(FAN, ".fml"))
    expected = (0.5 * 0.5 + 0.2 * 3.0) / (0.5 + 0.2)
    found = infer(rulebase, temperature=5.0, damp=0.25)["fan"]
    assert found == pytest.approx(expected, rel=1e-12)
    assert [block.conjunction for block in rulebase.blocks] == ["min", "product"]
    assert rulebase.outputs[0].defuzzifier == Defuzzifier("centroid")


def test_the_default_value_where_no_rule_fires() -> None:
    assert infer(good(parse(FAN, ".fml")), temperature=8.0, damp=0.0)["fan"] == 1.5
    text = changed(FAN, (' defaultValue="1.5"', ""))
    assert infer(good(parse(text, ".fml")), temperature=8.0, damp=0.0)["fan"] == 0.0


def test_a_tsk_rule_base() -> None:
    # At 5 and ¼: max(½, ¾²) × ½ of 1 + 2 × 5 + 3 × ¼, and min(½, 1 − ½) of 2.
    found = infer(good(parse(HEATER, ".fml")), t=5.0, h=0.25)["power"]
    assert found == pytest.approx((0.28125 * 11.75 + 0.5 * 2) / 0.78125, rel=1e-12)


def test_a_linear_term_without_numbers_is_refused() -> None:
    """One made in Python may have none; no text has."""
    rulebase = good(parse(HEATER, ".fml"))
    (output,) = rulebase.outputs
    empty = replace(output.terms[0], shape=Shape("linear"))
    output = replace(output, terms=(empty, *output.terms[1:]))
    written = write(replace(rulebase, outputs=(output,)), ".fml")
    assert [d.name for d in written.errors] == ["unsupported-shape"]


def test_a_tsukamoto_rule_base() -> None:
    text = changed(
        HEATER.replace("tskRule", "rule").replace("tskClause", "clause").replace("tskThen", "then")
        .replace("tskConsequent", "consequent").replace("ruleBase", "tsukamotoRuleBase"),
        ('<tskVariable name="power" ',
         '<tsukamotoVariable name="power" domainleft="0" domainright="10" type="output" '),
        ('<tskTerm name="low" order="0"><tskValue>2</tskValue></tskTerm>',
         '<tsukamotoTerm name="low"><leftLinearShape param1="0" param2="10"/></tsukamotoTerm>'),
        ('<tskTerm name="mixed" order="1">', '<tsukamotoTerm name="mixed">'),
        ("<tskValue>1</tskValue><tskValue>2</tskValue><tskValue>3</tskValue>",
         '<rightLinearShape param1="0" param2="10"/>'),
        ("</tskTerm>", "</tsukamotoTerm>"),
        ("</tskVariable>", "</tsukamotoVariable>"),
    )  # fmt: skip
    # The strengths are 0.28125, where mixed has 2.8125, and ½, where low has 5.
    found = infer(good(parse(text, ".fml")), t=5.0, h=0.25)["power"]
    assert found == pytest.approx((0.28125 * 2.8125 + 0.5 * 5) / 0.78125, rel=1e-12)


@pytest.mark.parametrize(
    ("modifier", "degree"),
    [
        ("any", 1.0), ("extremely", 0.3**3), ("intensify", 2 * 0.3**2), ("more_or_less",
        0.3 ** (1 / 3)), ("norm", 0.3), ("not", 0.7), ("plus", 0.3**1.25),
        ("seldom", sqrt(0.15)), ("somewhat", sqrt(0.3)), ("very", 0.09),
    ],
)  # fmt: skip
def test_modifiers(modifier: str, degree: float) -> None:
    # At t = 3.8 hot is 0.3, and rule b has nothing else; the power is its share of 2 and 12.
    text = changed(
        HEATER,
        ('<clause modifier="not"><variable>h</variable><term>wet</term></clause>', ""),
        ("<clause><variable>t</variable><term>hot</term>",
         f'<clause modifier="{modifier}"><variable>t</variable><term>hot</term>'),
        ("<clause><variable>t</variable><term>cold</term></clause>", ""),
    )  # fmt: skip
    # dry is 0.5 at h = ½: rule a has 0.5² × 0.5 of 1 + 7.6 + 1.5.
    found = infer(good(parse(text, ".fml")), t=3.8, h=0.5)["power"]
    assert found == pytest.approx((0.125 * 10.1 + degree * 2) / (0.125 + degree), rel=1e-9)


def test_else_is_the_complement() -> None:
    other = "<else><clause><variable>fan</variable><term>fast</term></clause></else></consequent>"
    text = changed(FAN, ("</consequent>", other))
    rulebase = good(parse(text, ".fml"))
    # Rule r1 fires with ½, so that fast gets max(½, 0.1).
    found = infer(rulebase, temperature=5.0, damp=0.25)["fan"]
    assert found == pytest.approx((0.5 * 0.5 + 1.0 * 3.0) / 1.5, rel=1e-12)


def test_singletons_are_averaged() -> None:
    text = changed(
        FAN,
        ('<rectangularShape param1="0" param2="1"/>', '<singletonShape param1="1"/>'),
        ('<rectangularShape param1="2" param2="4"/>', '<singletonShape param1="3"/>'),
    )
    found = infer(good(parse(text, ".fml")), temperature=5.0, damp=0.25)["fan"]
    assert found == pytest.approx((0.5 * 1 + 0.1 * 3) / 0.6, rel=1e-12)


# ── faults ───────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("old", "new", "name", "line"),
    [
        ("<leftLinearShape", "<leftLinearShap", "unknown-shape", 6),
        ('<leftLinearShape param1="2" param2="8"/>', '<leftLinearShape param1="2"/>',
         "parameter-count", 6),
        ('param1="5"', 'param1="five"', "not-a-number", 7),
        ('<gaussianShape param1="5" param2="2"/>', "<customShape name='custom_a'/>",
         "unsupported-shape", 7),
        ("<pointSetShape>", "<pointSetShape interpolationMethod='spline'>", "unsupported-shape",
         16),
        ('defuzzifier="COG"', 'defuzzifier="COGS"', "unknown-defuzzifier", 19),
        ('accumulation="MAX"', 'accumulation="MAXI"', "unknown-norm", 19),
        ('andMethod="PROD"', 'andMethod="custom_x"', "unknown-norm", 35),
        ('domainleft="0"', "", "bad-range", 5),
        ('weight="0.8"', 'weight="x"', "not-a-number", 35),
        ('weight="0.8"', 'weight="1.8"', "bad-weight", 35),
        ("<term>cold</term>", "<term>cool</term>", "undefined-term", 28),
        ("<variable>damp</variable>", "<variable>dump</variable>", "undefined-variable", 29),
        ("<variable>fan</variable>", "<variable>damp</variable>", "not-an-output", 32),
        ("<variable>temperature</variable>", "", "syntax", 28),
        ('modifier="very"', 'modifier="slightly"', "unsupported-hedge", 38),
        ("</knowledgeBase>", "", "syntax", 45),
        ("<fuzzySystem", "<!DOCTYPE a [<!ENTITY b 'c'>]>\n<fuzzySystem", "unsupported-type", 3),
        ("<mamdaniRuleBase", "<anYaRuleBase name='x'/><mamdaniRuleBase", "unsupported-type", 25),
    ],
)  # fmt: skip
def test_faults_have_a_name_and_a_line(old: str, new: str, name: str, line: int) -> None:
    imported = parse(changed(FAN, (old, new)), ".fml")
    assert imported.rulebase is None
    assert (name, line) in {(d.name, d.line) for d in imported.errors}
    places = {(d.name, d.line) for d in imported.errors}
    assert len(places) == 1 or name in ("undefined-variable", "not-an-output"), places


@pytest.mark.parametrize("text", ["<project/>", "<fuzzySystem/>", "plain words", ""])
def test_other_xml_is_refused_once(text: str) -> None:
    assert len(parse(text, ".xml").errors) == 1


def test_a_file_that_is_cut_off_is_an_error() -> None:
    for end in range(len(FAN.rstrip()) - 1):
        assert parse(FAN[:end], ".fml").errors


def test_what_is_not_supported_is_said_once() -> None:
    cloud = "<anYaDataCloud name='c'/>" * 5
    text = changed(FAN, ("</knowledgeBase>", f"{cloud}</knowledgeBase>"))
    assert [d.name for d in parse(text, ".fml").errors] == ["unsupported-type"]


# ── commands ─────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("suffix", [".fml", ".xml"])
def test_every_command_takes_it(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"a{suffix}"
    path.write_text(HEATER)
    rulebase = load(path)
    assert rulebase == good(read(DATA / "heater_ieee1855.fml"))
    assert not check_file(path).failed
    assert main(["eval", str(path), "t=5", "h=0.25"]) == 0
    assert "5.51" in capsys.readouterr().out
    assert main(["convert", str(path), str(tmp_path / "a.frb")]) == 0
    own = load(tmp_path / "a.frb")
    assert isinstance(own, RuleBase)
    assert infer(own, t=5.0, h=0.25)["power"] == pytest.approx(5.51, rel=1e-12)
    status = main(["convert", str(tmp_path / "a.frb"), str(path), "--force"])
    assert (status == 0) == (suffix == ".fml")  # what is read of .xml is written as .fml
    assert load(path) == rulebase
