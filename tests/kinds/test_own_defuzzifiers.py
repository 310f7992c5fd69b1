"""A defuzzifier is one record: one that nothing else knows goes through every engine and format."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from needs import need

import fuzzyarm
from fuzzyarm import kinds, op
from fuzzyarm.apps.cli import main
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.exchange.export import routines_of
from fuzzyarm.exchange.formats import PRODUCERS, same_model, write
from fuzzyarm.exchange.formats import parse as parse_foreign
from fuzzyarm.exchange.live.skfuzzy import to_skfuzzy
from fuzzyarm.inference import explain
from fuzzyarm.inference.infer import infer_interval
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.edit import coloured, complete, hover, read
from fuzzyarm.language.model.rulebase import Defuzzifier, RuleBase
from fuzzyarm.symbolic.defuzzifiers import ASPECTS, DEFUZZIFIERS
from fuzzyarm.symbolic.records import KindError
from tests.export.c_programs import run_c
from tests.export.module_programs import javascript_of
from tests.inference import test_matrix as matrix
from tests.inference.test_matrix import BELLS, FORMULAS, INTERVALS, RAMPS, SETS, VALUES, Case

OWN = {
    "late-maximum": (lambda first, last, mean: 0.25 * first + 0.5 * mean + 0.25 * last, {}),
    "wide-or-first": (lambda first, last: op.where(last - first > 1.0, 0.5 * last, first), {}),
    "half-near": (lambda first, mean, nearest: 0.5 * nearest + 0.25 * (first + mean), {}),
    "shrunk-centroid": (lambda centroid: 0.5 * centroid, {"names": {"fll": "Shrunk"}}),
    "lifted-half": (lambda half: op.maximum(half, 0.25), {"like": "bisector"}),
    "cautious-ends": (lambda left, right: 0.75 * left + 0.25 * right, {}),
    "raised-both": (lambda centroid: centroid + 0.125, {"both": True}),
    "root-average": (lambda average: op.sqrt(abs(average)), {}),
    "half-sum": (lambda weighted: 0.5 * weighted, {}),
    "doubled-inverse": (lambda average: 2.0 * average, {"inverts": True}),
}
"""Of each aspect one or two, with what they say of themselves."""

CASES = [
    Case("late-maximum exact"), Case("late-maximum(51)", BELLS),
    Case("late-maximum exact", VALUES), Case("wide-or-first exact"),
    Case("half-near exact"), Case("half-near(51)"), Case("half-near exact", VALUES),
    Case("shrunk-centroid exact"), Case("shrunk-centroid(51, joined)"),
    Case("lifted-half(51)"), Case("lifted-half exact", BELLS),
    Case("cautious-ends exact", INTERVALS), Case("cautious-ends(51)", INTERVALS),
    Case("raised-both exact", INTERVALS), Case("root-average", FORMULAS),
    Case("half-sum", VALUES), Case("doubled-inverse", RAMPS),
]  # fmt: skip


@pytest.fixture(autouse=True)
def _own() -> Iterator[None]:
    for name, (value, facts) in OWN.items():
        kinds.defuzzifier(name, value, doc=f"the {name} of my own", **facts)
    yield
    for name in OWN:
        DEFUZZIFIERS.remove(name)


def test_every_aspect_is_tried() -> None:
    assert {DEFUZZIFIERS[name].of for name in OWN} == set(ASPECTS)


# ── numbers ──────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("case", CASES, ids=str)
def test_it_is_inferred_traced_and_run_in_a_loop(case: Case) -> None:
    matrix.test_arrays_kernel_and_loop_have_the_bits_of_a_point(case)
    rulebase = case.rulebase()
    point = {"v": 0.1, "w": 0.3}
    assert explain(rulebase, point).outputs[0].value == fuzzyarm.infer(rulebase, point)["u"]


def value_of(record: str, figures: dict[str, str], terms: str = SETS) -> None:
    """Demand that a record is what its function says of others, where these are known by name."""
    columns = matrix.points(40)
    others = {
        figure: np.asarray(fuzzyarm.infer(Case(way, terms).rulebase(), columns)["u"])
        for figure, way in figures.items()
    }
    way = next(iter(figures.values())).partition("(")[2]
    own = Case(f"{record}({way}" if way else f"{record} exact", terms).rulebase()
    np.testing.assert_array_equal(fuzzyarm.infer(own, columns)["u"], OWN[record][0](**others))


def test_its_value_is_made_of_what_the_built_in_ones_give() -> None:
    tops = {"first": "smallest", "last": "largest", "mean": "mean"}
    for how in (" exact", "(51)"):
        near = {"first": tops["first"], "mean": "mean", "nearest": "nearest"}
        value_of("half-near", {k: f"{each}-of-maximum{how}" for k, each in near.items()})
        value_of("late-maximum", {k: f"{each}-of-maximum{how}" for k, each in tops.items()})
    value_of("shrunk-centroid", {"centroid": "centroid exact"})
    ends = {end: f"karnik-mendel-{end} exact" for end in ("left", "right")}
    value_of("cautious-ends", ends, INTERVALS)


@pytest.mark.slow
def test_c_structured_text_and_javascript_have_its_bits(tmp_path: Path) -> None:
    columns = matrix.points(60)
    rulebases = [case.rulebase() for case in CASES]
    routines = [routines_of(each, precision="float64")[0] for each in rulebases]
    results = run_c(routines, [list(columns.values())] * len(routines), tmp_path, suffix=".c")
    for case, found in zip(CASES, results, strict=True):
        matrix.demand_same(case, found, matrix.truth(case, 60))
    for case in CASES[::3]:
        matrix.test_structured_text_has_the_bits_of_a_point(case)
    need("node")
    for index, rulebase in enumerate(rulebases):
        (tmp_path / f"case{index}.mjs").write_text(javascript_of(rulebase))
    (tmp_path / "run.mjs").write_text(matrix.NODE)
    asked = {name: column.tolist() for name, column in columns.items()}
    done = subprocess.run(
        ["node", str(tmp_path / "run.mjs")], capture_output=True, text=True, timeout=99, check=True,
        input=json.dumps({f"case{index}": asked for index in range(len(CASES))}),
    )  # fmt: skip
    for index, case in enumerate(CASES):
        close = 1e-12 if case.terms == BELLS else 0.0  # exponentials of another library
        found = np.array(json.loads(done.stdout)[f"case{index}"])
        matrix.demand_same(case, found, matrix.truth(case, 60), close)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_range_is_proved_that_holds_what_is_inferred(case: Case) -> None:
    rulebase = case.rulebase()
    verdict = fuzzyarm.prove(rulebase, "u in -2 .. 3", budget=3.0)
    assert verdict.verdict == "proved", verdict
    assert isinstance(verdict.bound, tuple)
    values = np.asarray(fuzzyarm.infer(rulebase, matrix.points(300))["u"])
    assert verdict.bound[0] - 1e-9 <= values.min()
    assert values.max() <= verdict.bound[1] + 1e-9


def test_both_ends_of_an_own_centroid_are_those_of_the_set() -> None:
    own, usual = (
        Case(f"{way} exact", INTERVALS).rulebase() for way in ("cautious-ends", "karnik-mendel")
    )
    assert infer_interval(own, v=0.1, w=0.3) == infer_interval(usual, v=0.1, w=0.3)


# ── texts ────────────────────────────────────────────────────────────────────────────


def test_the_language_reads_writes_offers_and_explains_it() -> None:
    text = matrix.BASE.format(
        terms=SETS, way="late-maximum(51)", family="triangles", conjunction="min",
        implication="min", union="max",
    )  # fmt: skip
    assert "defuzzifier late-maximum(51)" in format_text(text)
    line = next(i for i, each in enumerate(text.splitlines(), 1) if "late-maximum" in each)
    column = text.splitlines()[line - 1].index("late-maximum") + 1
    assert "the late-maximum of my own" in hover(read(text), line, column).markdown
    cut = text.splitlines()[line - 1][: column - 1]
    before = "\n".join([*text.splitlines()[: line - 1], cut])
    offered = {each.label: each.detail for each in complete(read(before), line, column)}
    assert offered["late-maximum"] == "the late-maximum of my own"
    assert offered["centroid"] == DEFUZZIFIERS["centroid"].doc
    at = [each for each in coloured(read(text)) if (each.line, each.column) == (line, column)]
    assert [each.colour for each in at] == ["type"]


def test_other_programs_get_its_word_what_it_is_like_or_a_finding() -> None:
    shrunk = Case("shrunk-centroid(100, midpoints)").rulebase()
    written = write(shrunk, ".fll")
    assert "defuzzifier: Shrunk 100" in (written.text or "")
    again = parse_foreign(written.text or "", ".fll").rulebase
    assert again is not None
    assert same_model(again, shrunk)
    lifted = Case("lifted-half(1000, midpoints)").rulebase()
    assert "unsupported-defuzzifier" in {each.name for each in write(lifted, ".fll").errors}
    lossy = write(lifted, ".fll", lossy=True)
    assert "defuzzifier: Bisector 1000" in (lossy.text or "")
    (finding,) = [each for each in lossy.diagnostics if each.name == "unsupported-defuzzifier"]
    assert finding.message == (
        "fuzzylite has no lifted-half for 'u'; Bisector, which it has, is bisector"
    )
    for case in CASES:
        assert to_skfuzzy(case.rulebase())[0] is None
        for suffix, producers in PRODUCERS.items():
            for producer in producers:
                if suffix == ".fll" and case.way.startswith("shrunk"):
                    continue
                found = write(case.rulebase(), suffix, producer=producer)
                assert (found.text is None) == bool(found.errors)
                assert found.errors


def test_commands_take_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "own.frb"
    path.write_text(write(Case("lifted-half(51)").rulebase(), ".frb").text or "")
    assert main(["check", str(path)]) == 0
    assert main(["eval", str(path), "v=0.1", "w=0.3", "--explain"]) == 0
    assert "lifted-half(51, endpoints)" in capsys.readouterr().out
    assert main(["eval", str(path), "v=0.1", "w=0.3", "--defuzzifier", "late-maximum"]) == 0


# ── what is said of mistakes ─────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("value", "facts", "message"),
    [
        (lambda middle: middle, {}, "no aggregate has the argument 'middle'"),
        (lambda: 0.0, {}, "uses no number of an aggregate"),
        (lambda centroid, mean: centroid + mean, {}, "centroid and mean, which cannot be"),
        (lambda half: half, {"both": True}, "is not a centroid"),
        (lambda mean: mean, {"inverts": True}, "weighs no numbers"),
        (lambda mean: mean, {"like": "middle"}, "like 'middle', which is not a defuzzifier"),
        (lambda mean: 2.0 * math.sqrt(mean), {}, "cannot be traced"),
    ],
)
def test_a_record_that_cannot_work_is_refused(value, facts, message) -> None:
    with pytest.raises(KindError, match=message):
        kinds.defuzzifier("wrong", value, **facts)
    assert "wrong" not in DEFUZZIFIERS


def test_a_built_in_defuzzifier_stays_what_it_is() -> None:
    with pytest.raises(KindError, match="'nie-tan' is a built-in defuzzifier"):
        kinds.defuzzifier("nie-tan", lambda centroid: centroid)


def test_what_is_not_there_is_an_error_by_name() -> None:
    with pytest.raises(RuleBaseError, match=r"Defuzzifier\(method\).*'middle-of-maxima'") as error:
        Defuzzifier("middle-of-maxima")
    assert error.value.diagnostics[0].replacement == "middle-of-maximum"
    with pytest.raises(RuleBaseError, match="unknown sampling 'middles'"):
        Defuzzifier("centroid", 11, "middles")
    kinds.defuzzifier("passing", lambda mean: mean)
    rulebase: RuleBase = Case("passing exact").rulebase()
    DEFUZZIFIERS.remove("passing")
    for ask in (
        lambda: fuzzyarm.infer(rulebase, v=0.1, w=0.3),
        lambda: fuzzyarm.compiled(rulebase),
        lambda: write(rulebase, ".fll"),
        lambda: routines_of(rulebase),
        lambda: fuzzyarm.prove(rulebase, "u in -2 .. 3"),
    ):
        with pytest.raises(KindError, match="no defuzzifier is called 'passing'"):
            ask()
    findings = parse("output u 0 .. 1\ninference u: defuzzifier mom\n").diagnostics
    assert "'mom' of other programs is 'mean-of-maximum' here" in [each.hint for each in findings]
