"""What a writer only warns about is measured, and refused where numbers change by over 1 %."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.base.diagnostic import RuleBaseError, Severity
from fuzzyarm.exchange.formats import parse
from fuzzyarm.exchange.formats.conversion import text_in, written
from fuzzyarm.inference import infer
from fuzzyarm.language import parse as parse_own
from fuzzyarm.language import write as write_own
from fuzzyarm.language.model.rulebase import RuleBase

ENDS = """\
rulebase ends

input  x  0 .. 10
output y  -30 .. 30

term x a:  triangle 0 0 10
term x b:  triangle 0 10 10
term y l:  triangle -30 -30 -30
term y h:  triangle 30 30 30

inference defuzzifier centroid(101, endpoints), no-rule 0, outside extend

rule if x is a then y is l
rule if x is b then y is h
"""
"""Sets that only samples at the very ends of the range see."""

TARGETS = [
    (".fll", None, 0.0),
    (".fml", None, 0.0),
    (".fcl", "fuzzylite", 0.0),
    (".fis", "fuzzylite", 0.0),
]


def ends(text: str = ENDS) -> RuleBase:
    rulebase = parse_own(text).rulebase
    assert rulebase is not None
    return rulebase


def test_a_refusal_has_the_figure_of_what_would_be_written() -> None:
    text = ENDS.replace("centroid(101, endpoints)", "farthest-of-maximum(101, endpoints)")
    exported = written(ends(text), ".fll")
    assert exported.text is None
    figure = exported.diagnostics[-1]
    assert (figure.name, figure.severity) == ("numbers-differ", Severity.INFO)
    assert figure.message.startswith("with --lossy 'y' differs by up to ")
    anyway = written(ends(text), ".fll", lossy=True)
    assert figure.message.removeprefix("with --lossy ") in [d.message for d in anyway.diagnostics]
    assert not any("--lossy" in d.message for d in anyway.diagnostics)


@pytest.mark.parametrize(("x", "expected"), [(0.0, -30.0), (2.5, -15.0), (8.0, 18.0)])
def test_the_right_numbers(x: float, expected: float) -> None:
    assert infer(ends(), {"x": x})["y"] == pytest.approx(expected)


@pytest.mark.parametrize(("suffix", "producer", "instead"), TARGETS)
def test_a_loss_of_half_the_range_is_an_error(
    suffix: str, producer: str | None, instead: float
) -> None:
    exported = written(ends(), suffix, producer=producer)
    assert exported.text is None
    (error,) = exported.errors
    assert error.name == "numbers-differ"
    assert re.search(r"by up to 0\.5 of its range at 100 points: 0 in .*, -30 here", error.message)
    assert error.hint == "--lossy continues anyway"
    lossy = written(ends(), suffix, producer=producer, lossy=True)
    assert lossy.text is not None
    assert error.message in [d.message for d in lossy.diagnostics]
    read_back = parse(lossy.text, suffix, producer=producer).rulebase
    assert read_back is not None
    assert infer(read_back, {"x": 0.0})["y"] == pytest.approx(instead, abs=1e-9)


def test_what_samples_as_matlab_does_is_written() -> None:
    exported = written(ends(), ".fis", producer="matlab")
    assert exported.text is not None
    assert "numbers-differ" not in {d.name for d in exported.diagnostics}


def test_a_small_loss_is_a_warning_with_the_figure() -> None:
    text = ENDS.replace("-30 -30 -30", "-30 -30 0").replace("30 30 30\n", "0 30 30\n", 1)
    exported = written(ends(text), ".fll")
    assert exported.text is not None
    (found,) = [d for d in exported.diagnostics if d.name == "numbers-differ"]
    assert found.severity is Severity.WARNING
    share = float(re.search(r"by up to (\S+) of its range", found.message)[1])  # type: ignore[index]
    read_back = parse(exported.text, ".fll").rulebase
    assert read_back is not None
    gaps = [
        abs(infer(ends(text), {"x": x / 10})["y"] - infer(read_back, {"x": x / 10})["y"]) / 60
        for x in range(101)
    ]
    assert share == pytest.approx(max(gaps), rel=0.05)
    assert 1e-9 < share < 1e-2
    assert written(ends(text), ".fll", strict=True).text is None


def test_the_difference_inside_the_ranges_counts() -> None:
    """A program that does not clamp is warned about; within the ranges nothing changes."""
    text = ENDS.replace("outside extend", "outside clamp")
    exported = written(ends(text), ".fis", producer="matlab")
    assert exported.text is not None
    assert {d.name for d in exported.diagnostics} == {"outside-range"}


def test_renamed_variables_are_compared_all_the_same() -> None:
    text = re.sub(r"\bx\b", "'my x'", re.sub(r"\by\b", "'the y'", ENDS))
    exported = written(ends(text), ".fll")
    assert [d.name for d in exported.errors] == ["numbers-differ"]
    assert "my x = 0" in exported.errors[0].message


def test_a_file_of_a_rule_base_is_measured_too(tmp_path: Path) -> None:
    with pytest.raises(RuleBaseError, match=r"0\.5 of its range"):
        text_in(ends(), "ends.fll")
    with pytest.raises(RuleBaseError, match=r"0\.5 of its range"):
        ends().to_file(tmp_path / "ends.fll")
    assert not list(tmp_path.iterdir())


def test_the_command_refuses_and_says_by_how_much(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / "ends.frb", tmp_path / "ends.fll"
    source.write_text(write_own(ends()), encoding="utf-8")
    assert main(["convert", str(source), str(target)]) == 1
    assert not target.exists()
    assert "error[numbers-differ]: 'y' differs by up to 0.5 of its range" in capsys.readouterr().err
    assert main(["convert", str(source), str(target), "--lossy"]) == 0
    assert target.exists()
