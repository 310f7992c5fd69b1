"""FIS files as people have them: padded, cut off, of type 2, large, or not a text at all."""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import replace
from pathlib import Path

import pytest
from fis import system

from fuzzyarm import FileWarning, check_file, load
from fuzzyarm.base.diagnostic import RuleBaseError, Severity
from fuzzyarm.exchange.formats import Imported, parse, parse_fis, parse_fll, read, same_model, write
from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import Defuzzifier, RuleBase, Shape
from fuzzyarm.language.model.shapes import membership
from tests.interpreted import interpreted

DATA = Path(__file__).parent / "data"
PROGRAMS = ("matlab", "octave", "fuzzylite")

HEAD = """[System]
Name='s'
Type='{type}'
NumInputs=1
NumOutputs=1
NumRules={count}
AndMethod='min'
OrMethod='max'
ImpMethod='min'
AggMethod='max'
DefuzzMethod='{method}'
[Input1]
Name='x'
Range=[-10 10]
MF1='a':{term}
[Output1]
Name='y'
Range=[{low} {high}]
MF1='b':{result}
MF2='c':{result2}
[Rules]
"""


def fis(*rules: str, **changes: str) -> str:
    """Return a file of one input and one output; `changes` are the words in braces."""
    usual = {
        "type": "mamdani", "method": "centroid", "term": "'trimf',[-5 0 5]", "low": "0",
        "high": "10", "result": "'trimf',[0 2 4]", "result2": "'trimf',[6 8 10]",
    }  # fmt: skip
    return HEAD.format(**usual | {"count": str(len(rules))} | changes) + "\n".join(rules) + "\n"


def good(imported: Imported) -> RuleBase:
    assert imported.rulebase is not None, [str(d) for d in imported.errors]
    return imported.rulebase


def term_of(text: str, producer: str) -> tuple[Shape, list[str]]:
    imported = parse_fis(text, producer=producer)
    names = [d.name for d in imported.diagnostics if d.severity is Severity.WARNING]
    return good(imported).inputs[0].terms[0].shape, names


# ── numbers that are too many ────────────────────────────────────────────────────────


@pytest.mark.parametrize("producer", ["matlab", "octave"])
@pytest.mark.parametrize("zeros", range(1, 5))
@pytest.mark.parametrize(
    "term",
    [
        "trimf -5 0 5", "trapmf -5 -1 1 5", "gaussmf 2 1", "gauss2mf 2 -1 3 1", "gbellmf 2 3 1",
        "sigmf 2 1", "dsigmf 5 -2 5 3", "psigmf 2 -3 -2 3", "smf -3 4", "zmf -3 4",
        "pimf -5 -1 1 5", "rectmf -1 4", "linsmf -1 4",
    ],
)  # fmt: skip
def test_zeros_behind_the_numbers_are_padding(term: str, zeros: int, producer: str) -> None:
    word, _, numbers = term.partition(" ")
    plain, nothing = term_of(fis("1, 1 (1) : 1", term=f"'{word}',[{numbers}]"), producer)
    text = fis("1, 1 (1) : 1", term=f"'{word}',[{numbers}{' 0' * zeros}]")
    padded, names = term_of(text, producer)
    assert (padded, names, nothing) == (plain, ["padded-numbers"], [])
    found = next(d for d in parse_fis(text).diagnostics if d.name == "padded-numbers")
    assert text.split("\n")[found.line - 1].startswith("MF1='a'")


def test_a_number_too_many_is_a_height_to_fuzzylite_alone() -> None:
    text = fis("1, 1 (1) : 1", term="'trimf',[-5 0 5 0.5]")
    assert term_of(text, "fuzzylite") == (Shape("triangle", (-5.0, 0.0, 5.0), 0.5), [])
    # MATLAB takes the first three.
    three = Shape("triangle", (-5.0, 0.0, 5.0))
    assert term_of(text, "matlab") == (three, ["extra-numbers"])
    errors = parse_fis(text, producer="octave").errors
    assert [d.name for d in errors] == ["parameter-count"]


@pytest.mark.parametrize(
    ("numbers", "value"), [("7", 7.0), ("7 0 0", 7.0), ("0 7", 7.0), ("0 0", 0.0), ("-2 0", -2.0)]
)
def test_a_padded_constant(numbers: str, value: float) -> None:
    text = fis("1, 1 (1) : 1", type="sugeno", method="wtaver", result=f"'constant',[{numbers}]",
               result2="'linear',[1 2 0 0]")  # fmt: skip
    rulebase = good(parse_fis(text))
    assert infer(rulebase, x=0.5)["y"] == value
    assert rulebase.outputs[0].terms[1].shape == Shape("linear", (1.0, 2.0))
    assert parse_fis(text.replace(f"[{numbers}]", "[7 8]")).errors[0].name == "parameter-count"


# ── what is not a system of type 1 ───────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("text", "name", "word"),
    [
        (fis("1, 1 (1) : 1", type="banana"), "unknown-type", "banana"),
        (fis("1, 1 (1) : 1", term="'gaussmf',[1 2],[1],[0.1 0.1]"), "unsupported-shape", "lags"),
        (fis("1, 1 (1) : 1", term="'trapmf',[0 1 2 3],[1.5],[0.1 0.1]"), "bad-height", "scale"),
        ("[FISTree]\nName='t'\nNumFIS=2\n[Connections]\n'a/b' 'c/d'\n", "unsupported-type", "tree"),
    ],
)  # fmt: skip
def test_what_is_not_of_type_1_is_refused_by_name_and_once(text: str, name: str, word: str) -> None:
    (error,) = parse_fis(text).errors
    assert error.name == name
    assert word in error.message


TYPE_2 = (
    system("t")
    + """\
TypeRedMethod='KM'
[Input1]
Name='x'
Range=[0 10]
NumMFs=2
MF1U='low':'trimf',[-5 0 10]
MF1L='low':'trimf',[-4 0 8 0.9]
MF2U='high':'gaussmf',[3 10]
MF2L='high':'gaussmf',[2 10 0.8]
[Output1]
Name='y'
Range=[0 4]
NumMFs=2
MF1U='one':'trimf',[0 1 2]
MF1L='one':'trimf',[0.5 1 1.5]
MF2U='three':'trimf',[2 3 4]
MF2L='three':'trimf',[2.5 3 3.5]
[Rules]
1, 1 (1) : 1
2, 2 (1) : 1
"""
)


def test_the_keys_of_the_type_2_toolbox() -> None:
    rulebase = good(parse_fis(TYPE_2))
    low, high = rulebase.inputs[0].terms
    assert (low.shape, low.lower) == (
        Shape("triangle", (-5.0, 0.0, 10.0)), Shape("triangle", (-4.0, 0.0, 8.0), 0.9),
    )  # fmt: skip
    assert high.lower == Shape("gaussian", (10.0, 2.0), 0.8)
    assert rulebase.outputs[0].defuzzifier == Defuzzifier("karnik-mendel", 101)
    assert 1.0 < infer(rulebase, x=3.0)["y"] < 3.0
    other = good(parse_fis(TYPE_2.replace("'KM'", "'NT'")))
    assert other.outputs[0].defuzzifier.method == "nie-tan"
    errors = parse_fis(TYPE_2.replace("'KM'", "'BMM'")).errors
    assert [each.name for each in errors] == ["unknown-defuzzifier"]
    errors = parse_fis(TYPE_2.replace("[-4 0 8 0.9]", "[-6 0 8 0.9]")).errors
    assert [each.name for each in errors] == []  # below 0 there is no x
    errors = parse_fis(TYPE_2.replace("[-4 0 8 0.9]", "[-4 0 12]")).errors
    assert [each.name for each in errors] == ["lower-above-upper"]


def test_scale_and_lag_of_matlab() -> None:
    text = fis("1, 1 (1) : 1", type="sugfistype2", method="wtaver", result="'constant',[7]",
               term="'trapmf',[0 1 2 4],[0.8],[0.1 0.2]", result2="'constant',[8]")  # fmt: skip
    parsed = parse_fis(text)
    rulebase = good(parsed)
    assert rulebase.inputs[0].terms[0].lower == Shape("trapezoid", (0.1, 1.0, 2.0, 3.6), 0.8)
    assert rulebase.outputs[0].defuzzifier == Defuzzifier("karnik-mendel")
    assert "guessed-type-2" in [each.name for each in parsed.diagnostics]


@pytest.mark.parametrize("kind", ["mamdani", "Sugeno", "tsukamoto", "hybrid", "unknown", ""])
def test_words_for_type_1(kind: str) -> None:
    good(parse_fis(fis("1, 1 (1) : 1", type=kind)))


# ── files that are cut off ───────────────────────────────────────────────────────────


@pytest.mark.parametrize("path", sorted(DATA.glob("*.fis")), ids=lambda path: path.name)
def test_a_file_that_is_cut_off_is_said_wherever_it_is_cut(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    whole = good(parse_fis(text))
    producer = parse_fis(text).producer
    for end in range(0, len(text), 3):
        imported = parse_fis(text[:end], producer=producer)
        if imported.errors:
            continue
        assert imported.rulebase is not None
        if not same_model(imported.rulebase, whole):  # between two rules, which it says
            assert re.search(r": *\d\s*(#[^\n]*)?\Z", text[:end]), text[:end][-60:]
            assert "wrong-count" in {d.name for d in imported.diagnostics}


def test_a_cut_is_one_finding() -> None:
    text = (DATA / "tipper_matlab.fis").read_text(encoding="utf-8")
    for section in ("[Input2]", "[Output1]", "[Rules]"):
        assert len(parse_fis(text.partition(section)[0]).errors) == 1


def test_a_system_with_a_number_is_one() -> None:
    text = (DATA / "tipper_matlab.fis").read_text(encoding="utf-8")
    numbered = text.replace("[System]", "[System1]")
    assert same_model(good(parse_fis(numbered)), good(parse_fis(text)))
    (finding,) = parse_fis(numbered.partition("[Input1]")[0]).errors
    assert finding.name in {"no-engine", "wrong-count"}
    (finding,) = parse_fis("[System1]\nName='y'\n").errors
    assert (finding.name, finding.message) == ("no-engine", "there is no input in this file")


def test_more_than_a_file_says_is_read_with_a_warning() -> None:
    imported = parse_fis(fis("1, 1 (1) : 1", "1, 2 (1) : 1", count="1"))
    assert len(good(imported).rules) == 2
    assert [d.name for d in imported.diagnostics if d.severity is Severity.WARNING] == [
        "wrong-count"
    ]


def test_rules_of_another_length_are_one_finding() -> None:
    errors = parse_fis(fis(*["1 1, 1 (1) : 1"] * 50)).errors
    assert [(d.name, d.line) for d in errors] == [("wrong-count", 22)]


# ── load and check ───────────────────────────────────────────────────────────────────


def test_load_hands_out_warnings(tmp_path: Path) -> None:
    path = tmp_path / "a.fis"
    path.write_text(fis("1, 1 (1) : 1", term="'trimf',[-5 0 5 0]"))
    with pytest.warns(FileWarning, match="padded-numbers") as caught:
        load(path)
    finding = caught[0].message.diagnostic  # type: ignore[union-attr]
    assert (finding.name, finding.line, finding.path) == ("padded-numbers", 15, str(path))


@pytest.mark.parametrize(
    "text",
    [
        fis("1, 1 (1) : 1", "1, 2 (1) : 1"),  # a contradiction, which every program computes
        fis("1, 1 (1) : 1", result="'constant',[3]"),
        fis("1, 1 (1) : 1")[:60],
        fis("1, 9 (1) : 1"),
        fis("1, -1 (1) : 1", type="sugeno", method="wtaver", result="'constant',[3]",
            result2="'constant',[4]"),
    ],
)  # fmt: skip
def test_load_and_check_agree_on_errors(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.fis"
    path.write_text(text)
    review = check_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if review.failed:
            with pytest.raises(RuleBaseError):
                load(path)
        else:
            rulebase = load(path)
            assert isinstance(rulebase, RuleBase)
            interpreted(rulebase).point({"x": 0.0}, {})


def test_bytes_are_not_shown(tmp_path: Path) -> None:
    path = tmp_path / "a.fis"
    path.write_bytes(b"a fuzzy system\x00\x01\xff\xfe" * 9)
    review = check_file(path)
    assert [(d.name, d.message) for d in review.diagnostics] == [("not-text", "not a text file")]
    assert review.text == ""
    path.write_bytes(fis("1, 1 (1) : 1").encode("utf-16"))
    assert good(read(path)) == good(parse_fis(fis("1, 1 (1) : 1")))


def test_unknown_keys_warn_and_misspelt_ones_are_errors() -> None:
    text = fis("1, 1 (1) : 1").replace("Range=[-10 10]", "Range=[-10 10]\nUnit='m'", 1)
    imported = parse_fis(text)
    good(imported)
    assert [d.line for d in imported.diagnostics if d.name == "unknown-key"] == [15]
    (error,) = parse_fis(text.replace("DefuzzMethod", "DefuzMethod")).errors
    assert error.hint == "did you mean 'defuzzmethod'?"


# ── numbers ──────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("producer", PROGRAMS)
def test_a_negated_conclusion_that_is_a_value(producer: str) -> None:
    # At x = 1 the rules fire with 0.8: (0.2 × 3 + 0.8 × 7) / (0.2 + 0.8).
    text = fis("1, -1 (1) : 1", "1, 2 (1) : 1", type="sugeno", method="wtaver",
               result="'constant',[3]", result2="'constant',[7]")  # fmt: skip
    rulebase = good(parse_fis(text, producer=producer))
    assert infer(rulebase, x=1.0)["y"] == pytest.approx(0.2 * 3 + 0.8 * 7, rel=1e-12)
    again = good(parse_fis(text.replace("1, -1 (1)", "0, 1 (1)"), producer=producer))
    assert len(again.rules) == 1


def test_a_rule_that_does_not_fire_has_nothing_to_negate() -> None:
    # eval_rules_sugeno.m skips a rule of strength 0: at x = 6 only the second fires.
    text = fis("1, -1 (1) : 1", "-1, 2 (1) : 1", type="sugeno", method="wtaver",
               result="'constant',[3]", result2="'constant',[7]")  # fmt: skip
    assert infer(good(parse_fis(text, producer="octave")), x=6.0)["y"] == 7.0


@pytest.mark.parametrize(("method", "value"), [("mom", 3.0), ("som", -4.0), ("lom", 10.0)])
def test_maxima_of_an_empty_output_to_octave(method: str, value: float) -> None:
    # defuzz.m compares with the maximum, which all samples of -4 … 10 are.
    text = fis("1, 1 (1) : 1", method=method, low="-4")
    assert infer(good(parse_fis(text, producer="octave")), x=9.0)["y"] == value


MAXIMUM = {
    "matlab": {"som": "nearest-of-maximum", "lom": "farthest-of-maximum"},
    "octave": {"som": "smallest-of-maximum", "lom": "largest-of-maximum"},
}


@pytest.mark.parametrize("method", ["som", "lom"])
@pytest.mark.parametrize("producer", ["matlab", "octave"])
def test_matlab_compares_the_magnitudes_of_maxima(producer: str, method: str) -> None:
    # Octave's defuzz.m takes the least and the greatest maximal sample, with their signs.
    text = fis("1, 1 (1) : 1", method=method, low="-10", high="10")
    imported = parse_fis(text, producer=producer)
    rulebase = good(imported)
    assert rulebase.outputs[0].defuzzifier == Defuzzifier(MAXIMUM[producer][method], 101)
    assert not [each for each in imported.diagnostics if each.severity is Severity.WARNING]
    written = write(rulebase, ".fis", producer=producer)
    assert f"DefuzzMethod='{method}'" in (written.text or "")
    other = {"matlab": "octave", "octave": "matlab"}[producer]
    refused = write(rulebase, ".fis", producer=other)
    assert "unsupported-defuzzifier" in {each.name for each in refused.errors}


@pytest.mark.parametrize(
    ("low", "high", "method", "word"),
    [
        ("0", "10", "smallest-of-maximum", "som"), ("0", "10", "largest-of-maximum", "lom"),
        ("-10", "0", "smallest-of-maximum", "lom"), ("-10", "-1", "largest-of-maximum", "som"),
    ],
)  # fmt: skip
def test_on_one_side_of_0_the_maxima_of_others_have_a_word_in_matlab(
    low: str, high: str, method: str, word: str
) -> None:
    rulebase = good(parse_fis(fis("1, 1 (1) : 1", method="mom", low=low, high=high)))
    (output,) = rulebase.outputs
    changed = replace(output, defuzzifier=Defuzzifier(method, 101))
    written = write(replace(rulebase, outputs=(changed,)), ".fis", producer="matlab")
    assert f"DefuzzMethod='{word}'" in (written.text or "")
    again = good(parse_fis(written.text or "", producer="matlab"))
    for x in (0.1, 0.5, 0.9):
        here = replace(rulebase, outputs=(changed,))
        assert infer(again, x=x) == infer(here, x=x)


FLL_OUTPUT = (
    "OutputVariable: y\nrange: 0 1\naggregation: Maximum\ndefuzzifier: Centroid\n"
    "term: b Triangle 0 1 1\n"
    "RuleBlock: r\nimplication: Minimum\nrule: if x is a then y is b\n"
)


def numbers_of_fuzzylite(term: str, x: float) -> float:
    """The formulas of fuzzylite's manual, which look at the corners one after the other."""
    word, *texts = term.split()
    p = [float(text) for text in texts]
    if word == "SShape":
        return float(x > p[0])
    if word == "ZShape":
        return float(x <= p[0])
    a, b, c, d = (p[0], p[1], p[1], p[2]) if word == "Triangle" else p
    if x < a or x > d:
        return 0.0
    if b <= x <= c:
        return 1.0
    return (x - a) / (b - a) if x < b else (d - x) / (d - c)


@pytest.mark.parametrize(
    "term",
    [
        "Triangle 0 5 3", "Triangle 4 1 6", "Trapezoid 0 6 4 10", "Trapezoid 2 0 4 8",
        "Trapezoid 0 6 4 5", "Trapezoid 0 5 -1 9", "SShape 6 2", "ZShape 6 2",
    ],
)  # fmt: skip
def test_corners_out_of_order_that_fuzzylite_computes(term: str) -> None:
    text = f"InputVariable: x\nrange: 0 10\nterm: a {term}\n"
    imported = parse_fll(text + FLL_OUTPUT)
    shape = good(imported).inputs[0].terms[0].shape
    for step in range(-50, 250):
        x = step / 20 + 0.011
        assert membership(shape, x) == pytest.approx(numbers_of_fuzzylite(term, x), abs=1e-12), x
    edges = [float(corner) for corner in term.split()[1:]]
    outside = min(edges) - 1.0
    assert membership(shape, outside) == numbers_of_fuzzylite(term, outside)


@pytest.mark.parametrize("suffix", [".fll", ".fis", ".fcl"])
def test_corners_out_of_order_are_nothing_at_all(suffix: str) -> None:
    text = {
        ".fll": "InputVariable: x\nrange: 0 10\nterm: a Triangle 5 3 1\n" + FLL_OUTPUT,
        ".fis": fis("1, 1 (1) : 1", term="'trapmf',[5 3 2 1]"),
        ".fcl": "FUNCTION_BLOCK f VAR_INPUT x : REAL; END_VAR FUZZIFY x TERM a := TRIAN 5 3 1; "
        "END_FUZZIFY DEFUZZIFY y RANGE := (0 .. 1); TERM b := TRIAN 0 1 1; END_DEFUZZIFY "
        "RULEBLOCK r RULE 1 : IF x IS a THEN y IS b; END_RULEBLOCK END_FUNCTION_BLOCK",
    }[suffix]
    imported = parse(text, suffix)
    term = good(imported).inputs[0].terms[0]
    assert [membership(term.shape, x) for x in (0.0, 1.0, 2.5, 3.0, 4.0, 5.0, 9.0)] == [0.0] * 7
    assert "unordered-corners" in {
        d.name for d in imported.diagnostics if d.severity is Severity.WARNING
    }


# ── large files ──────────────────────────────────────────────────────────────────────


def anfis(terms: int) -> str:
    """A file as ANFIS writes it for 2 inputs: a linear term for each rule."""
    head = f"[System]\nName='a'\nType='sugeno'\nNumInputs=2\nNumOutputs=1\nNumRules={terms**2}\n"
    head += "AndMethod='prod'\nDefuzzMethod='wtaver'\n"
    inputs = "".join(
        f"[Input{i}]\nName='in{i}'\nRange=[0 1]\nNumMFs={terms}\n"
        + "".join(f"MF{k}='mf{k}':'gaussmf',[0.1 {k / terms!r}]\n" for k in range(1, terms + 1))
        for i in (1, 2)
    )
    output = f"[Output1]\nName='out'\nRange=[0 1]\nNumMFs={terms**2}\n" + "".join(
        f"MF{k}='out1mf{k}':'linear',[{math.sin(k)!r} {math.cos(k)!r} 0.1]\n"
        for k in range(1, terms**2 + 1)
    )
    rules = "".join(
        f"{a} {b}, {(a - 1) * terms + b} (1) : 1\n"
        for a in range(1, terms + 1)
        for b in range(1, terms + 1)
    )
    return f"{head}{inputs}{output}[Rules]\n{rules}"


@pytest.mark.slow
def test_a_large_anfis_file_is_read() -> None:
    rulebase = good(parse_fis(anfis(49)))
    assert len(rulebase.rules) == 2_401
    at = {"in1": 0.3, "in2": 0.8}
    weights = {
        (a, b): math.exp(-((0.3 - a / 49) ** 2 + (0.8 - b / 49) ** 2) / 0.02)
        for a in range(1, 50)
        for b in range(1, 50)
    }
    values = {
        (a, b): math.sin(k) * 0.3 + math.cos(k) * 0.8 + 0.1
        for a, b in weights
        for k in [(a - 1) * 49 + b]
    }
    expected = sum(w * values[ab] for ab, w in weights.items()) / sum(weights.values())
    assert infer(rulebase, at)["out"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_too_many_terms_are_one_finding() -> None:
    assert [d.name for d in parse_fis(anfis(75)).errors] == ["too-many"]


def test_a_refused_term_is_known_to_the_rules() -> None:
    errors = parse_fis(fis("1, 1 (1) : 1", "-1, 2 (1) : 1", term="'mymf',[1 2]")).errors
    assert [d.name for d in errors] == ["unknown-shape"]


EXTRA = """{before}[System]
Name='a'
Type='mamdani'
NumInputs=1
NumOutputs=1
NumRules=2

[Input1]
Name='x'
Range=[0 2]
NumMFs=2
MF1='A':'trimf',[0 0.4 1{more}]
MF2='B':'linsmf',[1 1.5]

[Output1]
Name='y'
Range=[0 4]
NumMFs=2
MF1='A':'trimf',[0 1 2]
MF2='B':'trimf',[3 3.5 4]

[Rules]
1, 1 (1) : 1
2, 2 (1) : 1
"""


def test_matlab_takes_the_first_of_too_many_numbers() -> None:
    imported = parse_fis(EXTRA.format(before="", more=" 1.5"), producer="matlab")
    assert [d.name for d in imported.diagnostics if d.severity != "info"] == ["extra-numbers"]
    assert imported.rulebase is not None
    for x, y in ((0.4, 1.0), (1.2, 3.5)):
        assert infer(imported.rulebase, x=x)["y"] == pytest.approx(y, abs=1e-12)
    octave = parse_fis(EXTRA.format(before="", more=" 1.5"), producer="octave")
    assert [d.name for d in octave.errors] == ["parameter-count"]


def test_the_first_header_may_stand_behind_other_text() -> None:
    plain, behind = (parse_fis(EXTRA.format(before=b, more="")) for b in ("", "ab"))
    assert plain.rulebase is not None
    assert behind.rulebase == plain.rulebase


def test_double_quotes_are_quotes():
    single = fis("1, 1 (1) : 1  % 'first'")
    double = single.replace("'", '"')
    assert good(parse_fis(double)) == good(parse_fis(single))
    name = (
        good(parse_fis(single.replace("MF1='b'", """MF1="b's 50 % \""""))).outputs[0].terms[0].name
    )
    assert name == "b's 50 % "
