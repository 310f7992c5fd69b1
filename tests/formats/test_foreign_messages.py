"""Files that are not quite right: read with a warning where the meaning is clear, else said why."""

from __future__ import annotations

from pathlib import Path

import pytest

from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.diagnostic import Severity
from fuzzyarm.exchange.files import UnknownKindError, load
from fuzzyarm.exchange.formats import FormatError, Imported, parse_fcl, parse_fis, parse_fll, read
from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import RuleBase

DATA = Path(__file__).parent / "data"
PUMP = (DATA / "pump_jfuzzylogic.fcl").read_text(encoding="utf-8")
TIPPER = (DATA / "tipper_matlab.fis").read_text(encoding="utf-8")


def good(imported: Imported) -> RuleBase:
    assert imported.rulebase is not None, [str(d) for d in imported.errors]
    return imported.rulebase


def of_name(imported: Imported, name: str) -> list[str]:
    return [d.message for d in imported.diagnostics if d.name == name]


# ── FIS ──────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("[Input1]", "[Inpt1]", "syntax"),
        (":'trimf',[0 5 10]", ":'trimf',[0 5 10", "syntax"),
        ("[6 9]", "[6 9", "syntax"),
        ("Range=[0 30]", "Range=[0 30", "syntax"),
        ("[Output1]\n", "", "wrong-count"),
    ],
)
def test_damage_in_one_line_is_one_error(old: str, new: str, name: str) -> None:
    text = TIPPER.replace(old, new, 1)
    assert text != TIPPER
    assert [d.name for d in parse_fis(text).errors] == [name]


def test_fewer_rules_than_the_file_says_are_a_warning() -> None:
    count = TIPPER.partition("[Rules]")[2].count(":")
    text = TIPPER.replace(f"NumRules={count}", f"NumRules={count + 12}")
    assert text != TIPPER
    imported = parse_fis(text)
    assert good(imported).rules == good(parse_fis(TIPPER)).rules
    (finding,) = [d for d in imported.diagnostics if d.name == "wrong-count"]
    assert finding.severity is Severity.WARNING
    assert finding.hint == "is the file cut off?"


def test_rules_that_are_glued_to_the_comment_of_their_block() -> None:
    imported = read(DATA / "glued_jfuzzylite.fis")
    rulebase = good(imported)
    assert imported.producer == "fuzzylite"
    assert len(rulebase.rules) == 4
    assert [d.line for d in imported.diagnostics if d.name == "glued-rule"] == [38, 40]
    first = rulebase.rules[0]
    assert (first.antecedent.variable, first.antecedent.term) == ("a", "low")  # type: ignore[union-attr]
    assert rulebase.rules[2].weight == 0.5
    assert "wrong-count" not in {d.name for d in imported.diagnostics}


def test_a_comment_of_a_block_without_a_rule_stays_one() -> None:
    text = (
        (DATA / "glued_jfuzzylite.fis")
        .read_text()
        .replace("# RuleBlock 11.000 0.000", "# RuleBlock 1\n1.000 0.000")
    )
    assert len(good(parse_fis(text)).rules) == 4
    odd = text.replace("# RuleBlock 1\n", "# RuleBlock 17: a comment, with signs\n")
    assert len(good(parse_fis(odd)).rules) == 4


def test_functions_with_one_number_are_counted_as_they_stand() -> None:
    """fuzzylite counts them so, whatever their numbers."""
    imported = read(DATA / "glued_jfuzzylite.fis")
    (message,) = of_name(imported, "duplicate-index")
    assert message == (
        "'b' has two functions with the number 1; its terms are numbered in their order, 1 to 2"
    )
    second = good(imported).rules[1].antecedent.operands[1]  # type: ignore[union-attr]
    assert (second.variable, second.term) == ("b", "high")


# ── FCL ──────────────────────────────────────────────────────────────────────────────


def test_rules_without_variables_say_so() -> None:
    text = "RULE 1: IF (pain IS strong) THEN (health IS bad);\nRULE 2: IF a THEN b;\n"
    (error,) = parse_fcl(text).errors
    assert (error.name, error.line) == ("no-variables", 1)
    assert "there are rules here but no variables" in error.message


def test_a_condition_without_a_variable_says_so() -> None:
    text = PUMP.replace("IF level IS low AND", "IF low AND")
    messages = of_name(parse_fcl(text), "lone-word")
    assert messages == [
        "'low' alone is not a condition, which is 'variable IS term': it is a term of level"
    ]
    lone = parse_fcl(PUMP.replace("IF level IS low AND", "IF level AND"))
    assert "it is a variable, and no term is named" in of_name(lone, "lone-word")[0]
    other = parse_fcl(PUMP.replace("THEN power IS max,", "THEN max,"))
    assert "'max' alone is not a conclusion" in of_name(other, "lone-word")[0]


@pytest.mark.parametrize("end", ["END_VAR", "END_FUZZIFY", "END_DEFUZZIFY", "END_RULEBLOCK"])
def test_a_missing_end_is_said_and_read_over(end: str) -> None:
    """jFuzzyLogic says so too, and goes on."""
    imported = parse_fcl(PUMP.replace(end, "", 1))
    assert good(imported) == good(parse_fcl(PUMP)) or good(imported).rules
    (message,) = of_name(imported, "missing-end")
    assert message.startswith(f"'{end}' is missing before '")


def test_another_end_is_taken_for_the_one_that_is_missing() -> None:
    imported = parse_fcl(PUMP.replace("END_FUZZIFY", "END_DEFUZZIFY", 1))
    assert "'END_DEFUZZIFY' is taken for 'END_FUZZIFY', which is missing" in of_name(
        imported, "missing-end"
    )
    good(imported)


def test_a_file_that_ends_within_a_section_is_cut_off() -> None:
    for end in ("END_VAR", "END_FUZZIFY", "END_RULEBLOCK"):
        (error, *_) = parse_fcl(PUMP.partition(end)[0]).errors
        assert f"'{end}' is missing: is the file cut off?" in error.message


@pytest.mark.parametrize("term", ["TERM odd := ;", "TERM odd :=", "TERM odd ;"])
def test_an_empty_term_says_so(term: str) -> None:
    imported = parse_fcl(PUMP.replace("END_FUZZIFY", f"  {term}\nEND_FUZZIFY", 1))
    assert [d.message for d in imported.errors] == [
        "the term has no membership function after ':='"
    ]
    used = PUMP.replace("END_FUZZIFY", f"  {term}\nEND_FUZZIFY", 1)
    used = used.replace("IF level IS low AND", "IF level IS odd AND")
    assert len(parse_fcl(used).errors) == 1  # the rule that uses it adds nothing


# ── names ────────────────────────────────────────────────────────────────────────────


def test_an_unknown_name_is_said_once_with_those_there_are() -> None:
    fll = "Engine: e\nInputVariable: warmth\nrange: 0 1\nterm: cold Ramp 1 0\nterm: hot Ramp 0 1\n"
    fll += "OutputVariable: y\nrange: 0 1\naggregation: Maximum\ndefuzzifier: Centroid\n"
    fll += "term: on Ramp 0 1\nRuleBlock:\nimplication: Minimum\n"
    fll += (
        "rule: if warmht is hot then y is on\n" * 40 + "rule: if warmth is icy then y is on\n" * 3
    )
    first, second = parse_fll(fll).errors
    assert first.message == "the variable 'warmht' is not known (here and 39 more times)"
    assert first.hint == "did you mean 'warmth'?; known: warmth, y"
    assert second.message == "'warmth' has no term 'icy' (here and 2 more times)"
    assert second.hint == "known: cold, hot"


def test_many_names_are_not_all_listed() -> None:
    terms = "".join(f"term: t{i} Ramp 0 1\n" for i in range(40))
    fll = f"InputVariable: x\nrange: 0 1\n{terms}OutputVariable: y\nrange: 0 1\nterm: on Ramp 0 1\n"
    fll += "aggregation: Maximum\ndefuzzifier: Centroid\nRuleBlock:\nimplication: Minimum\n"
    (error,) = parse_fll(fll + "rule: if x is unheard then y is on\n").errors
    assert error.hint.startswith("known: t0, t1, ")
    assert error.hint.endswith(", t11, …")


# ── files that are no text ───────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("name", "what", "helps"),
    [
        ("fan.mat", "a MAT-file", "writeFIS"),
        ("fan.pkl", "a pickle", "a script that loads it"),
        ("fan.joblib", "a pickle", "a script that loads it"),
    ],
)
def test_what_is_not_a_text_is_called_what_it_is(
    name: str, what: str, helps: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    path.write_bytes(b"\x80\x04\x95whatever\0")
    with pytest.raises(FormatError, match=f"this is {what}, not a text") as caught:
        read(path)
    assert helps in caught.value.hint
    with pytest.raises(UnknownKindError, match=f"this is {what}"):
        load(path)
    for words in (["check", str(path)], ["convert", str(path), str(tmp_path / "a.frb")]):
        assert main(words) == 1
        assert f"this is {what}, not a text" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("data", "what"),
    [
        (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + b"\0" * 90, "a MAT-file"),
        (b"\x80\x04\x95\x10\0\0\0\0\0\0\0}\x94.", "a pickle"),
        (b"PK\x03\x04\x14\0\0\0", "an archive"),
    ],
)
def test_whatever_a_file_is_called(data: bytes, what: str, tmp_path: Path) -> None:
    path = tmp_path / "fan.fis"
    path.write_bytes(data)
    (error,) = read(path).errors
    assert (error.name, error.message) == ("not-text", f"this is {what}, not a text")


def test_a_t2fis_is_read_by_its_suffix(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["eval", str(DATA / "observer.t2fis"), "x1=-0.3", "x2=0.6"]) == 0
    value = float(capsys.readouterr().out.split("=")[1])
    assert value == infer(good(read(DATA / "observer.t2fis")), x1=-0.3, x2=0.6)["y"]


BLIND = """FUNCTION_BLOCK blind
VAR_INPUT
 light : REAL;
 k : REAL;
END_VAR
VAR_OUTPUT
 mid : REAL;
 shade : REAL;
END_VAR
FUZZIFY light
 TERM dark := (0, 1) (10, 0);
 TERM bright := (0, 0) (10, 1);
END_FUZZIFY
DEFUZZIFY mid
 TERM lo := (0, 1) (1, 0);
 METHOD : COG;
 DEFAULT := 0;
 RANGE := (0 .. 1);
END_DEFUZZIFY
DEFUZZIFY shade
 TERM lo := (0, 0) (5, 1) (10, 0);
 TERM hi := (20, 0) (25, 1) (30, 0);
 METHOD : COG;
 DEFAULT := 0;
 RANGE := (0 .. 30);
END_DEFUZZIFY
RULEBLOCK a
 AND : MIN;
 ACT : MIN;
 RULE 1 : IF light IS dark THEN mid IS lo WITH 0.5;
 RULE 2 : IF light IS bright THEN shade IS hi;
 RULE 3 : IF light IS dark THEN shade IS lo;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def test_a_corner_that_moves_is_reported_once() -> None:
    text = BLIND.replace("(0, 1) (10, 0)", "(0, 1) (k, 0)").replace("(10, 1)", "(k, 1)")
    errors = parse_fcl(text).errors
    assert [d.name for d in errors] == ["moving-corner"]
    assert "'k' is a variable" in errors[0].message
    assert "1 more time" in errors[0].message


def test_an_accumulation_of_an_output_names_the_programs_that_have_it() -> None:
    text = BLIND.replace("METHOD : COG;", "METHOD : COG;\n ACCU : MAX;")
    errors = parse_fcl(text, dialect="jfuzzylogic").errors
    assert [d.name for d in errors] == ["mixed-accumulation"] * 2  # once for each output
    assert all("--from fuzzylite" in d.hint for d in errors)
    assert not parse_fcl(text).errors


def test_a_rule_that_cannot_be_put_in_is_named_and_scikits_activation_is_a_loss() -> None:
    text = BLIND.replace("IF light IS dark THEN shade", "IF mid IS lo THEN shade")
    second = "END_RULEBLOCK\nRULEBLOCK b\n AND : MIN;\n ACT : MIN;\n RULE 3"
    text = text.replace("RULE 3", second).replace("ACT : MIN;", "ACT : MIN;\n ACCU : MAX;")
    (error,) = parse_fcl(text, dialect="fuzzylite").errors
    assert error.name == "chained-output"
    line = next(n for n, row in enumerate(text.split("\n"), 1) if "WITH 0.5" in row)
    assert error.message.endswith(f"the rule in line {line} has the weight 0.5")
    ranged = text.replace("FUZZIFY light", "FUZZIFY light\n RANGE := (0 .. 10);")
    ranged = ranged.replace(" k : REAL;\n", "")
    assert {d.name for d in parse_fcl(ranged, dialect="scikit-fuzzy").errors} == {"chained-output"}


def test_the_method_cm_has_the_one_that_is_meant() -> None:
    errors = parse_fcl(BLIND.replace("METHOD : COG", "METHOD : CM")).errors
    assert [(d.name, d.hint) for d in errors] == [("unknown-defuzzifier", "write COG")] * 2


@pytest.mark.parametrize(
    ("formula", "refused"),
    [("-light*2 + 1", True), ("2*(-light)", True), ("pow(+2, light)", True), ("2*-light", True),
     ("~light*2 + 1", False), ("1 - light", False), ("2*(light) - 1", False)],
)  # fmt: skip
def test_a_sign_that_fuzzylite_refuses_is_a_warning(formula: str, refused: bool) -> None:
    text = (
        "InputVariable: light\nrange: 0 1\nterm: dark Ramp 1 0\nOutputVariable: y\nrange: -3 3\n"
        f"defuzzifier: WeightedAverage\nterm: f Function {formula}\nRuleBlock:\n"
        "rule: if light is dark then y is f\n"
    )
    imported = parse_fll(text)
    good(imported)
    assert bool(of_name(imported, "bad-formula")) is refused


# ── what is wrong in every format ────────────────────────────────────────────────────

ENDS = {
    ".fll": "range: 0 {}", ".fml": 'domainright="{}"', ".fcl": "(0 .. {})", ".fis": "[0 {}]",
    ".frb": "output y 0 .. {}",
}  # fmt: skip
RAMPS = """rulebase a
input x 0 .. 1
output y 0 .. 4
term x a: ramp 1 0
term x b: ramp 0 1
term y p: {}
term y q: {}
inference defuzzifier {}, no-rule 0
rule if x is a then y is p
rule if x is b then y is q
"""
SETS = RAMPS.format("triangle 0 1 2", "triangle 1 2 3", "centroid(101)")
VALUES = RAMPS.format("singleton 1", "singleton 2", "weighted-average")


def _checked(text: str, suffix: str, end: str, folder: Path, capsys) -> tuple[int, str]:
    """Return the status and the findings of `check`, of a file whose output ends at `end`."""
    source, path = folder / "made.frb", folder / f"made{suffix}"
    source.write_text(text, "utf-8")
    if suffix != ".frb":
        assert main(["convert", str(source), str(path), "--lossy"]) == 0
    made, place = path.read_text("utf-8"), ENDS[suffix]
    assert made.count(place.format("4")) == 1
    path.write_text(made.replace(place.format("4"), place.format(end)), "utf-8")
    capsys.readouterr()
    status = main(["check", str(path)])
    return status, "".join(capsys.readouterr())


@pytest.mark.parametrize("suffix", ENDS)
def test_an_output_without_a_range_is_an_error_where_sets_are_integrated(suffix, tmp_path, capsys):
    status, said = _checked(SETS, suffix, "inf", tmp_path, capsys)
    assert status == 1
    assert said.count("error[") == 1
    assert "error[bad-range]: the output 'y' needs a finite range to be integrated over" in said


@pytest.mark.parametrize("suffix", [".fll", ".fis", ".frb"])
def test_values_need_no_range(suffix, tmp_path, capsys):
    status, said = _checked(VALUES, suffix, "inf", tmp_path, capsys)
    assert status == 0, said


@pytest.mark.parametrize("suffix", ENDS)
def test_a_number_that_overflows_is_an_error_at_its_place(suffix, tmp_path, capsys):
    status, said = _checked(SETS, suffix, "1e4000", tmp_path, capsys)
    assert status == 1
    assert said.count("error[") == 1
    assert "'1e4000' is too large for a number" in said
    row = next(line for line in said.splitlines() if " | " in line and "1e4000" in line)
    text = (tmp_path / f"made{suffix}").read_text("utf-8").splitlines()
    number = int(row.split("|")[0])
    assert "1e4000" in text[number - 1]


def test_a_number_of_a_term_that_overflows():
    imported = parse_fll("InputVariable: x\n  range: 0 1\n  term: a Ramp 0 1e4000\n")
    assert of_name(imported, "not-a-number") == ["'1e4000' is too large for a number"]


@pytest.mark.parametrize(
    ("shape", "names"),
    [
        ("piShape", "start, top"), ("leftGaussianShape", "mean, deviation"),
        ("rightGaussianShape", "mean, deviation"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("count", [1, 3, 4])
def test_a_wrong_count_of_numbers_is_called_that(shape, names, count, tmp_path, capsys):
    source, path = tmp_path / "made.frb", tmp_path / "made.fml"
    source.write_text(SETS, "utf-8")
    assert main(["convert", str(source), str(path), "--lossy"]) == 0
    numbers = " ".join(f'param{i}="{i}"' for i in range(1, count + 1))
    before = '<triangularShape param1="0" param2="1" param3="2"/>'
    made = path.read_text("utf-8")
    assert before in made
    path.write_text(made.replace(before, f"<{shape} {numbers}/>"), "utf-8")
    capsys.readouterr()
    assert main(["check", str(path)]) == 1
    said = "".join(capsys.readouterr())
    assert f"error[parameter-count]: {shape} takes 2 numbers ({names}), not {count}" in said
    assert "did you mean" not in said


@pytest.mark.parametrize(("word", "hint"), [("gausmf", "did you mean 'gaussmf'?"), ("mymf", "")])
def test_a_misspelt_function_gets_its_hint(word: str, hint: str) -> None:
    text = TIPPER.replace("'gaussmf'", f"'{word}'", 1)
    (finding,) = parse_fis(text).errors
    assert (finding.name, finding.hint) == ("unknown-shape", hint)
