"""A point, arrays, machine code and C have the same bits: at random, at corners and beside them."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from budget import cases, crossed, part
from needs import CORPUS, requires

import fuzzyarm
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.exchange.export import routines_of
from fuzzyarm.inference import (
    compiled,
    engine,
    infer,
    output_layout,
    quadrature,
)
from fuzzyarm.inference.strengths import firing_strengths
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.model.shapes import corner_points
from tests.export.c_programs import run_c
from tests.interpreted import interpreted

SHIPPED = ("pd7", "pd7-study", "alpha7", "alpha7-study", "fine7", "slide7", "balance", "fan",
           "roompi", "thermostat", "tipper", "tipper2")  # fmt: skip
FOREIGN = sorted(CORPUS.glob("files/*")) if CORPUS.is_dir() else []

Columns = dict[str, np.ndarray]


def silent(rulebase: RuleBase) -> RuleBase:
    """Return a rule base that is NaN where no rule fires."""
    outputs = tuple(replace(each, no_rule=math.nan) for each in rulebase.outputs)
    return replace(rulebase, outputs=outputs)


def points(rulebase: RuleBase, count: int, seed: int = 0) -> Columns:
    """Return points: three of five at random, the others at corners, beside and between them."""
    rng = np.random.default_rng(seed)
    found = {}
    for variable in rulebase.inputs:
        corners = {x for term in variable.terms for x in corner_points(term.shape)} or {0.0}
        low = variable.low if math.isfinite(variable.low) else min(corners) - 1.0
        high = variable.high if math.isfinite(variable.high) else max(corners) + 1.0
        edges = sorted({low, high, *(x for x in corners if low <= x <= high)})
        near = [math.nextafter(x, way) for x in edges for way in (-math.inf, math.inf)]
        special = [*edges, *near, *(0.5 * (a + b) for a, b in pairwise(edges))]
        even = rng.uniform(low, high, count)
        found[variable.name] = np.where(rng.random(count) < 0.6, even, rng.choice(special, count))
    return found


def same(found: np.ndarray, wanted: np.ndarray, what: str) -> None:
    np.testing.assert_array_equal(found, wanted, err_msg=what)


def demand_same_bits(
    rulebase: RuleBase, columns: Columns, one_by_one: int, wanted: Columns | None = None
) -> None:
    """Compare the engines over all points, and single points with the first of them."""
    wanted = wanted or interpreted(rulebase).evaluate(columns)
    fast = compiled(rulebase)
    if not fast.reason:
        for name, values in fast(columns).items():
            same(values, wanted[name], f"machine code of {name}")
    for i in range(one_by_one):
        row = {name: float(column[i]) for name, column in columns.items()}
        for name, value in interpreted(rulebase).point(row).items():
            same(np.array(value), wanted[name][i], f"{name} at {row}")
        if not fast.reason:
            ordinary = fast.named_point(row)
            for name, value in (ordinary or {}).items():
                same(np.array(value), wanted[name][i], f"machine code of {name} at {row}")


@pytest.mark.parametrize("name", SHIPPED)
def test_engines_agree_on_shipped_rule_bases(name: str) -> None:
    rulebase = silent(fuzzyarm.load(fuzzyarm.shipped(f"{name}.frb")))
    demand_same_bits(rulebase, points(rulebase, cases(2_500, 100_000)), 200)


@pytest.mark.slow
def test_c_agrees_on_shipped_rule_bases(tmp_path: Path) -> None:
    routines, columns, wanted = [], [], []
    for name in SHIPPED[:-1]:
        rulebase = silent(fuzzyarm.load(fuzzyarm.shipped(f"{name}.frb")))
        at = points(rulebase, cases(5_000, 100_000), 1)
        values = interpreted(rulebase).evaluate(at)
        for output in rulebase.outputs:
            routines += routines_of(rulebase, output=output.name, precision="float64")
            columns.append(list(at.values()))
            wanted.append(values[output.name])
    results = run_c(routines, columns, tmp_path)
    for routine, at, values, found in zip(routines, columns, wanted, results, strict=True):
        what = f"C of {routine.rulebase.name}, {routine.name}"
        same(found, values, what)
        same(routine.evaluate(*at), found, f"the model of {what}")


@pytest.mark.slow
@requires("corpus")
def test_engines_agree_on_rule_files_of_others() -> None:
    compared, files = 0, part(FOREIGN, 4)
    for path in files:
        try:
            rulebase = silent(fuzzyarm.load(path))
            columns = points(rulebase, cases(300, 100_000))
            wanted = interpreted(rulebase).evaluate(columns)
        except FuzzyarmError:  # what is not read here, or has a formula without a value
            continue
        demand_same_bits(rulebase, columns, 25, wanted)
        compared += 1
    assert compared > 0.6 * len(files)


# ── where a rounding decides ─────────────────────────────────────────────────────────

DECIDING = """
rulebase decides
input x 0 .. 98
input y 0 .. 98
output u 0 .. 100
term x low:  triangle 0 49 98
term x edge: rectangle 10 49
term x odd:  points (0, 0.3) (49, 1) (98, 0.1)
term y low:  triangle 0 49 98
term y high: trapezoid 30 79 98 98
terms u: triangles A B C
inference and {norm}, or {either}, implication {cut}, threshold {threshold}
inference u: aggregation {union}, defuzzifier {way}, no-rule 0
rule if x is low and y is low then u is A
rule if x is edge and y is high then u is B
rule if x is odd or y is not low then u is C
rule if x is not odd then u is A with 0.7
rule if not (x is low and y is high) then u is B
"""

NORMS = [("min", "max"), ("product", "probor"), ("bounded", "bounded"), ("drastic", "drastic"),
         ("hamacher", "hamacher"), ("einstein", "einstein"),
         ("nilpotent", "nilpotent")]  # fmt: skip
WAYS = [("centroid exact", "max"), ("centroid exact", "sum"), ("centroid(41)", "max"),
        ("centroid(41, trapezoid)", "probor"), ("mean-of-maximum exact", "max"),
        ("smallest-of-maximum exact", "max"), ("largest-of-maximum(33)", "max"),
        ("nearest-of-maximum exact", "max"), ("farthest-of-maximum(33)", "probor"),
        ("bisector(50, midpoints)", "max"), ("centroid(21, joined)", "max"),
        ("bisector(21, joined)", "sum"), ("weighted-average", "sum"),
        ("bisector exact", "max")]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(NORMS)), ids=[norm for norm, _ in NORMS])
def test_norms_thresholds_and_edges_decide_alike(number: int) -> None:
    """Each way under each norm; the implications in turn, so that each meets both."""
    norm, either = NORMS[number]
    for k, (way, union) in enumerate(WAYS):
        threshold, cut = (0, 0.25, 1 / 3)[k % 3], ("min", "product")[(k + number) % 2]
        text = DECIDING.format(norm=norm, either=either, cut=cut, threshold=threshold, way=way,
                               union=union)  # fmt: skip
        rulebase = parse(text).rulebase
        assert rulebase is not None
        demand_same_bits(rulebase, points(rulebase, 40 if "exact" in way else 120, k), 12)


def test_a_peak_that_a_slope_misses_counts_in_full() -> None:
    """Under drastic a degree of 1 − 2⁻⁵³ would not fire."""
    text = DECIDING.format(norm="drastic", either="max", cut="min", threshold=0,
                           way="centroid exact", union="max")  # fmt: skip
    rulebase = parse(text.replace("rule if not", "# ").replace("rule if x is not", "# ")).rulebase
    assert rulebase is not None
    at = {"x": 49.0, "y": 49.0}
    (strength, *_), _ = firing_strengths(rulebase, at)
    assert strength == 1.0
    demand_same_bits(rulebase, {name: np.array([x]) for name, x in at.items()}, 1)


LEAST = """
rulebase least
input x 0 .. 2
output u -1 .. 40
term x A: ramp 1.5 0
term u B: singleton -1
term u C: singleton 39
term u F: linear -1.137*x
inference no-rule -1
inference u: defuzzifier bisector, outside extend
rule if x is A then u is B
rule if x is A then u is C
rule if x is A then u is F
"""


def test_the_middle_of_the_least_number_twice_is_that_number() -> None:
    """A bisector is half of a sum: the sum of two halves is 0 there."""
    rulebase = parse(LEAST).rulebase
    assert rulebase is not None
    columns = {"x": np.array([5e-324, 0.5, 3 * 5e-324])}
    assert interpreted(rulebase).evaluate(columns)["u"][0] == -5e-324
    demand_same_bits(rulebase, columns, 3)


FAINT = """
rulebase faint
input x 0 .. 1
output u -6 .. 74
term x A: ramp 0 1
term u C: sigmoid-difference 23.68 0.5 47 2
inference no-rule 0, defuzzifier {way} exact
rule if x is A then u is C
"""


@pytest.mark.parametrize("way", ["centroid", "bisector"])
def test_panels_run_out_alike_where_rounding_is_as_great_as_a_degree(
    way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A difference of sigmoids is rounded like 1; cut at 3e-8 its panels never agree."""
    for module in (quadrature, output_layout):
        monkeypatch.setattr(module, "MOST_PANELS", 400)
    rulebase = parse(FAINT.format(way=way)).rulebase
    assert rulebase is not None
    demand_same_bits(rulebase, {"x": np.array([3.16e-8, 0.5])}, 2)


FEWER = """
rulebase fewer
input x 0 .. 1
input y 0 .. 1
input z 0 .. 1
output u 0 .. 1
term x A: points (0, 0.05) (1, 0.95)
term y A: triangle 0 1 1
term z A: triangle 0 1 1
terms u: triangles P Q
inference and {norm}, or {either}, no-rule 0
rule if x is A and y is A then u is P
rule if x is A and y is A and z is A then u is Q
rule if x is A or y is A then u is Q
rule if z is A then u is P
"""


@pytest.mark.parametrize(("norm", "either"), NORMS, ids=str)
def test_a_rule_of_fewer_operands_is_not_rounded_more(norm: str, either: str) -> None:
    rulebase = parse(FEWER.format(norm=norm, either=either)).rulebase
    assert rulebase is not None
    demand_same_bits(rulebase, points(rulebase, 500), 100)


# ── the same bits on every call ──────────────────────────────────────────────────────

CURVED = """
rulebase curved
input x 0 .. 10
output u 0 .. 10
term x A: gaussian 2 1.7
term x B: bell 7 1.3 2.5
term u P: gaussian 3 1
term u Q: sigmoid 7 3
inference u: defuzzifier {way}, aggregation {union}, no-rule 0
rule if x is somewhat A then u is P
rule if x is power(0.3) B then u is Q
"""


def without_and_with(
    rulebase: RuleBase, columns: Columns, monkeypatch: pytest.MonkeyPatch
) -> list[np.ndarray]:
    """Return what `infer` says of arrays where there is no machine code, and where there is."""
    found = []
    for there in (False, True):
        monkeypatch.setattr(engine, "has_machine_code", lambda there=there: there)
        found.append(infer(rulebase, columns)["u"])
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("way", "union"),
    [*crossed(["centroid exact", "bisector exact", "centroid(31)"], ["max", "probor"])],
)
def test_infer_does_not_show_which_engine_it_takes(
    way: str, union: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rulebase = parse(CURVED.format(way=way, union=union)).rulebase
    assert rulebase is not None
    columns = points(rulebase, 60)
    same(*without_and_with(rulebase, columns, monkeypatch), "with machine code")
    demand_same_bits(rulebase, columns, 4)


@pytest.mark.slow
@pytest.mark.parametrize(
    "formula", ["sqrt(x - 3) / 3", "sqrt((x - 3) * (x - 6)) / 6", "log(x - 8)"]
)
def test_a_formula_has_the_degree_0_where_it_has_no_value(formula: str) -> None:
    text = CURVED.replace(" x ", " e ")
    text = text.replace("term u Q: sigmoid 7 3", f'term u Q: formula "{formula}"')
    found = {}
    for way in ("centroid exact", "centroid(2001, trapezoid)", "bisector exact"):
        rulebase = parse(text.format(way=way, union="max")).rulebase
        assert rulebase is not None
        columns = points(rulebase, 12)
        demand_same_bits(rulebase, columns, 6)
        found[way] = infer(rulebase, columns)["u"]
    np.testing.assert_allclose(*list(found.values())[:2], rtol=0.0, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("end", ["", "-left", "-right"])
def test_ends_of_curved_interval_sets(end: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = CURVED.format(way=f"karnik-mendel{end} exact", union="max")
    rulebase = parse(text.replace("gaussian 3 1", "gaussian 3 1 over gaussian 3 0.5")).rulebase
    assert rulebase is not None
    assert rulebase.outputs[0].defuzzifier.record.of == "ends"
    columns = points(rulebase, 4)
    same(*without_and_with(rulebase, columns, monkeypatch), "with machine code")
    demand_same_bits(rulebase, columns, 4)


def test_sums_go_from_left_to_right() -> None:
    """The `sum` of Python 3.12 and later keeps what is lost here."""
    from fuzzyarm.inference.aggregate import added_up

    assert added_up([1.0, 1e-16, 1e-16, 1e-16]) == 1.0
    assert added_up([]) == 0.0
