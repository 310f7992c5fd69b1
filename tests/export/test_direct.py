"""Direct inference: the straight-line program against the engine, and C against the program."""

from __future__ import annotations

import dataclasses
import gc
import itertools
import math
import time
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from c_programs import ARM, HOST, run_c, spread, ulps
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from strategies import (
    SMOOTH,
    STRAIGHT,
    blocks_of,
    input_points,
    inputs_of,
    numbers_of,
    plain_mamdani,
    term_lists,
    value_terms,
)

from fuzzyarm.exchange.export import ExportError, export_files, routines_of
from fuzzyarm.exchange.export.program import make_program
from fuzzyarm.exchange.export.rulebase import corners_of
from fuzzyarm.language import load_rulebase, parse
from fuzzyarm.language.model.rulebase import (
    SAMPLINGS,
    And,
    Consequent,
    Defuzzifier,
    Hedge,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.symbolic import kinds, op
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, SNORMS, TNORMS
from fuzzyarm.symbolic.nodes import Apply, postorder
from fuzzyarm.symbolic.operations import OPERATIONS

RULEBASES = Path(__file__).parents[2] / "rulebases"
TARGETS = [HOST, pytest.param(ARM, marks=pytest.mark.slow)]


def text(more="", **settings):
    chosen = {
        "and": "product", "or": "probor", "implication": "min", "aggregation": "max",
        "defuzzifier": "centroid exact", "no-rule": "0", **settings,
    }  # fmt: skip
    words = ", ".join(f"{key} {value}" for key, value in chosen.items())
    return f"""rulebase made
input  a  0 .. 4
input  b  -1 .. 1
output u  -5 .. 5
term a L: trapezoid -inf -inf 1 2
term a H: ramp 1 3.5
term b N: triangle -1 -1 0.25
term b P: points (-0.5, 0) (0, 0.4) (0, 0.9) (0.7, 1)
term u D: triangle -5 -3 0
term u M: triangle -2 0.5 2
term u U: trapezoid 0 3 4 5
inference {words}
{more}
"""


RULES = """
rule if a is L and b is N then u is D
rule if a is H or b is not P then u is M with 0.5
rule if a is very H and b is P then u is U
"""


def made(more=RULES, **settings):
    parsed = parse(text(more, **settings))
    assert parsed.rulebase is not None, [d.message for d in parsed.diagnostics]
    return parsed.rulebase


def points_for(rulebase, count, dtype=np.float32):
    parts = []
    for variable in rulebase.inputs:
        near = np.array(corners_of(variable), dtype)
        around = [np.nextafter(near, dtype(way)) for way in (-np.inf, np.inf)]
        beyond = np.array([near[0] - 1, near[-1] + 1, -1e30, 1e30], dtype)
        extra = [near, *around] + ([beyond] if variable.outside != "extend" else [])
        parts.append(np.unique(np.concatenate(extra)))
    return spread(parts, count, seed=6)


def assert_close(found, truth, span, steps=1):
    """One unit in the last place of float32, or the noise of double arithmetic about zero."""
    assert np.array_equal(np.isnan(found), np.isnan(truth))
    known = ~np.isnan(truth)
    off = np.abs(found.astype(float) - truth)[known]
    near = ulps(found[known], truth[known].astype(np.float32)) <= steps
    assert (near | (off <= 1e-12 * span)).all(), off.max()


@pytest.mark.parametrize("target", TARGETS)
def test_shipped_rule_bases_agree_over_100_000_points(tmp_path, target):
    models = [load_rulebase(RULEBASES / f"{name}.frb") for name in ("pd7", "fan", "alpha7")]
    routines = [routine for model in models for routine in routines_of(model)]
    columns = [points_for(model, 100_000) for model in models]
    results = run_c(routines, columns, tmp_path, target)
    for routine, points, found in zip(routines, columns, results, strict=True):
        np.testing.assert_array_equal(found, routine.evaluate(*points))
        output = routine.rulebase.output(routine.name)
        assert_close(found, routine.model(*points), output.high - output.low)


VARIETY = [
    {},
    {"implication": "product", "aggregation": "sum"},
    {"aggregation": "sum", "and": "min", "or": "max"},
    {"and": "bounded", "or": "bounded"},
    {"and": "drastic", "or": "drastic"},
    {"and": "hamacher", "or": "hamacher"},
    {"and": "einstein", "or": "einstein"},
    {"and": "nilpotent", "or": "nilpotent"},
    {"defuzzifier": "weighted-average"},
    {"defuzzifier": "weighted-sum", "aggregation": "sum"},
    {"defuzzifier": "weighted-average", "aggregation": "probor"},
    {"implication": "product"},
    {"outside": "error"},
    {"outside": "extend"},
    {"no-rule": "error"},
    {"defuzzifier": "centroid(101)"},
    {"defuzzifier": "centroid(50, midpoints)", "implication": "product"},
    {"defuzzifier": "centroid(33, left)", "aggregation": "sum", "no-rule": "error"},
    {
        "defuzzifier": "centroid(20, trapezoid)",
        "aggregation": "einstein",
        "implication": "hamacher",
    },
    {"defuzzifier": "weighted-average", "aggregation": "nilpotent"},
    {"defuzzifier": "weighted-average", "aggregation": "hamacher"},
]


@pytest.mark.slow
def test_norms_and_defuzzifiers_agree_in_c(tmp_path):
    models = [made(**settings) for settings in VARIETY]
    two_sets = RULES.replace("u is M", "u is D")
    models[11] = made(two_sets, implication="product")
    routines, columns = [], []
    for model in models:
        for precision in ("mixed", "float32", "float64"):
            routines += routines_of(model, precision=precision)
            dtype = np.float64 if precision == "float64" else np.float32
            columns.append(points_for(model, 3_000, dtype))
    results = run_c(routines, columns, tmp_path, suffix=".c")
    for routine, points, found in zip(routines, columns, results, strict=True):
        np.testing.assert_array_equal(found, routine.evaluate(*points))
        if routine.precision.inside is np.float64:
            assert_close(found, routine.model(*points), 10.0)


CHAIN = """
rulebase chain
input  a  0 .. 4
output mid 0 .. 10
output out -5 .. 5
term a L: triangle 0 0 1.5
term a H: ramp 1 3.5
term mid S: triangle 0 3 5
term mid T: trapezoid 4 8 10 10
term out D: singleton -5
term out U: linear 0.5*a - 1
inference and min, or max, implication min, aggregation max, defuzzifier centroid exact
inference out: defuzzifier weighted-average, no-rule hold
rule if a is L then mid is S
rule if a is H then mid is T
block second
rule if mid is S then out is D
rule if mid is T and a is very H then out is U
"""


def test_an_output_that_holds_takes_its_last_value_as_an_argument(tmp_path):
    rules = "rule if a is L and b is N then u is D"
    model = made(rules, **{"no-rule": "hold"})
    (routine,) = routines_of(model)
    a, b = points_for(model, 2_000)
    last = np.linspace(-4, 4, a.size, dtype=np.float32)
    (found,) = run_c([routine], [[a, b, last]], tmp_path)
    np.testing.assert_array_equal(found, routine.evaluate(a, b, last))
    silent = np.isnan(routine.model(a, b, held=math.nan))
    assert silent.any()
    np.testing.assert_array_equal(found[silent], last[silent])
    assert_close(found[~silent], routine.model(a, b)[~silent], 10.0)


def test_a_later_block_reads_the_number_of_an_earlier_output(tmp_path):
    model = parse(CHAIN).rulebase
    assert model is not None, [d.message for d in parse(CHAIN).diagnostics]
    (routine,) = routines_of(model, output="out")
    points = points_for(model, 2_000)
    last = np.full_like(points[0], 1.5)
    (found,) = run_c([routine], [[*points, last]], tmp_path)
    np.testing.assert_array_equal(found, routine.evaluate(*points, last))
    nowhere = (points[0] >= 1.5) & (points[0] <= 1.0)
    assert_close(found[~nowhere], routine.model(*points, held=1.5)[~nowhere], 10.0)


def test_nan_counts_as_the_lower_border(tmp_path, pd7):
    (routine,) = routines_of(pd7)
    columns = [np.float32([np.nan, 1.0]), np.float32([1.0, np.nan])]
    (found,) = run_c([routine], [columns], tmp_path)
    expected = routine.evaluate(np.float32([-6.0, 1.0]), np.float32([1.0, -6.0]))
    np.testing.assert_array_equal(found, expected)


@pytest.mark.slow
@settings(max_examples=cases(20, 60), suppress_health_check=[HealthCheck.filter_too_much])
@given(
    st.data(),
    plain_mamdani(kinds=STRAIGHT, aggregations=("max", "sum"), implications=("min", "product")),
)
def test_the_program_is_the_inference_for_any_straight_rule_base(data, model):
    try:
        (routine,) = routines_of(model, precision="float64")
    except ExportError:  # three sets overlap under product and max
        return
    points = [np.array(x) for x in data.draw(input_points(model)).values()]
    output = model.outputs[0]
    truth = routine.model(*points)
    np.testing.assert_allclose(
        routine.evaluate(*points), truth, atol=1e-9 * (output.high - output.low), rtol=0
    )


@st.composite
def systems(draw):
    """Any antecedents and norms; sets or values; what is exported as a rule."""
    inputs = draw(inputs_of(STRAIGHT + SMOOTH, ["e", "ce", "load"][: draw(st.integers(1, 3))]))
    low, high = -3.0, 8.0
    values = draw(st.booleans())
    samples = draw(st.sampled_from([None, 5, 40]))
    sets = term_lists(STRAIGHT if samples is None else STRAIGHT + SMOOTH, low, high)
    terms = draw(value_terms(inputs, low, high, odd=False) if values else sets)
    methods = ["weighted-average", "weighted-sum"] if values else ["centroid", "weighted-average"]
    method = draw(st.sampled_from(methods))
    exact = method == "centroid" and samples is None
    folds = ["max", "sum"] if exact else list(SNORMS)
    samplings = [each for each in SAMPLINGS if each != "joined"]  # which export refuses
    way = Defuzzifier(method, samples, draw(st.sampled_from(samplings)))
    way = way if method == "centroid" else Defuzzifier(method)
    output = Output(
        "u", low, high, terms,
        aggregation=draw(st.sampled_from(folds)), defuzzifier=way,
        no_rule=draw(st.sampled_from([1.5, "error", "hold"])),
        outside=draw(st.sampled_from(["clamp", "extend"])),
    )  # fmt: skip
    block = draw(blocks_of(inputs, [output]))
    if exact:
        block = dataclasses.replace(block, implication=draw(st.sampled_from(["min", "product"])))
    return RuleBase("made", inputs, (output,), (block,))


@pytest.mark.slow
@settings(
    max_examples=cases(26, 80), suppress_health_check=list(HealthCheck), phases=(Phase.generate,)
)
@given(st.data(), systems())
def test_what_is_exported_of_any_rule_base_agrees(data, model):
    routines = []
    for output in model.outputs:
        try:
            routines += routines_of(model, output=output.name, precision="float64")
        except ExportError:  # three overlapping sets, weighted sets that bend
            continue
    assume(routines)
    points = [np.array(x) for x in data.draw(input_points(model)).values()]
    for routine in routines:
        output = model.output(routine.name)
        given_last = [np.full(len(points[0]), routine._last())] if routine.program.holds else []
        found = routine.evaluate(*points, *given_last)
        truth = routine.model(*points)
        assert np.array_equal(np.isnan(found), np.isnan(truth))
        scale = max(output.high - output.low, float(np.nanmax(np.abs(truth), initial=0.0)))
        np.testing.assert_allclose(found, truth, atol=1e-9 * scale, rtol=0)


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"defuzzifier": "centroid(30000)"}, "the centroid of 'u' over 30,000 samples"),
        ({"defuzzifier": "bisector(30000)"}, "the bisector of 'u' over 30,000 samples"),
        ({"defuzzifier": "mean-of-maximum exact", "aggregation": "sum"},
         "the exact mean-of-maximum of 'u' under aggregation sum"),
        ({"defuzzifier": "tsukamoto"}, "'u is D' neither rises nor falls over the range"),
    ],
)  # fmt: skip
def test_what_cannot_be_exported_is_named(settings, what):
    with pytest.raises(ExportError, match="cannot be exported: ") as caught:
        routines_of(made(**settings))
    assert what in str(caught.value)
    assert str(caught.value).startswith("line ")


def overlapping(model):
    """Return a rule base whose three sets overlap everywhere."""
    output = model.outputs[0]
    wide = tuple(
        dataclasses.replace(term, shape=Shape("triangle", (-5 + i, 0, 5)))
        for i, term in enumerate(output.terms)
    )
    return dataclasses.replace(model, outputs=(dataclasses.replace(output, terms=wide),))


WALKED = [
    {"defuzzifier": "bisector exact"},
    {"aggregation": "einstein"},
    {"aggregation": "probor", "implication": "bounded"},
    {"implication": "hamacher"},
    {"implication": "product"},
    {"implication": "drastic", "defuzzifier": "bisector(41, midpoints)"},
    {"defuzzifier": "smallest-of-maximum exact", "implication": "nilpotent"},
    {"defuzzifier": "largest-of-maximum(33)", "aggregation": "normalized"},
    {"defuzzifier": "nearest-of-maximum(33)"},
    {"defuzzifier": "farthest-of-maximum exact"},
    {"defuzzifier": "bisector(21, joined)"},
]


def test_what_is_walked_over_tables_has_the_bits_of_the_model(tmp_path):
    models = [overlapping(made(**settings)) for settings in WALKED]
    routines = [
        routine
        for model in models
        for precision in ("float64", "mixed")
        for routine in routines_of(model, precision=precision)
    ]
    assert len(routines) == 2 * len(models)
    assert all(routine.program.walks for routine in routines)
    columns = points_for(models[0], 400)
    results = run_c(routines, [columns] * len(routines), tmp_path, suffix=".c")
    for routine, found in zip(routines, results, strict=True):
        np.testing.assert_array_equal(found, routine.evaluate(*columns))
    for routine, found in zip(routines[::2], results[::2], strict=True):
        np.testing.assert_array_equal(found, routine.model(*columns))


def test_an_output_without_rules_is_walked_as_well(tmp_path):
    model = dataclasses.replace(overlapping(made(defuzzifier="bisector(41)")), blocks=())
    (routine,) = routines_of(model)
    columns = points_for(model, 20)
    (found,) = run_c([routine], [columns], tmp_path)
    np.testing.assert_array_equal(found, routine.evaluate(*columns))


def test_what_is_walked_over_tables_needs_double_precision():
    with pytest.raises(ExportError, match="found in double precision only") as caught:
        routines_of(made(defuzzifier="bisector(41)"), precision="float32")
    assert "--precision mixed" in caught.value.hint


EXACT = {"sqrt", "absolute", "floor"}
"""Functions of the mathematical library that round correctly everywhere."""


def is_exact(nodes):
    used = {n.operation for n in nodes if isinstance(n, Apply)}
    return {name for name in used if OPERATIONS[name].sort == "functions"} <= EXACT


def degrees_of(shapes, hedges=()):
    """A rule base whose outputs are the degrees of one input in the shapes."""
    terms = tuple(Term(f"t{i}", shape) for i, shape in enumerate(shapes))
    one = (Term("one", Shape("singleton", (1.0,))),)
    way = Defuzzifier("weighted-sum")
    outputs = tuple(
        Output(f"y{i}", 0.0, 1.0, one, aggregation="sum", defuzzifier=way, no_rule=0.0)
        for i in range(len(shapes))
    )
    rules = tuple(
        Rule(Is("x", f"t{i}", hedges), (Consequent(f"y{i}", "one"),)) for i in range(len(shapes))
    )
    return RuleBase("degrees", (Input("x", -2.0, 2.0, terms),), outputs, (RuleBlock(rules),))


def compared_in_c(model, tmp_path, columns, *others):
    """Run all outputs in C, compare them with their models, return both in double precision.

    Those of all models that are given are in one program.
    """
    routines, models = [], (model, *others)
    for precision in ("float64", "mixed", "float32"):
        for each in models:
            routines += routines_of(each, precision=precision)
    results = run_c(routines, [columns] * len(routines), tmp_path)
    for routine, found in zip(routines, results, strict=True):
        expected = routine.evaluate(*columns)
        if is_exact(routine.program.nodes):
            assert found.tobytes() == expected.tobytes()
        else:
            single = routine.precision.inside is np.float32
            close = {"rtol": 1e-5, "atol": 1e-6} if single else {"rtol": 1e-7, "atol": 1e-15}
            np.testing.assert_allclose(found, expected, **close)
    outputs = sum(len(each.outputs) for each in models)
    return routines[:outputs], results[:outputs]


@pytest.mark.slow
@pytest.mark.parametrize("height", [1.0, 0.7])
def test_every_kind_of_term_is_the_same_in_c(tmp_path, height):
    built_in = [name for name, kind in SHAPES.items() if kind.fuzzy and not kind.own]
    shapes = [Shape(kind, numbers_of(kind, -2.0, 2.0), height) for kind in built_in]
    shapes.append(Shape("formula", (), height, "exp(-abs(x)) * (1 + min(x, 0, -0.1) / 2)"))
    model = degrees_of(shapes)
    beside = np.concatenate([*map(near, corners_of(model.inputs[0]))])
    x = np.unique([*np.linspace(-2, 2, 401), *np.clip(beside, -2, 2)])
    routines, results = compared_in_c(model, tmp_path, [x])
    for shape, routine, found in zip(shapes, routines, results, strict=True):
        if SHAPES[shape.kind].function is None:
            continue
        kind = SHAPES[shape.kind]
        expected = np.array([height * kind.scalar(v, *shape.parameters) for v in x.tolist()])
        exact = is_exact(routine.program.nodes)
        assert exact == (kind.straight or is_exact(postorder(kind.expression)))
        if kind.straight or not exact:
            np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-15)
        else:
            np.testing.assert_array_equal(found, expected)


def near(x):
    return [np.nextafter(x, -np.inf), x, np.nextafter(x, np.inf)]


BUILT_IN_HEDGES = [name for name in HEDGES if not HEDGES[name].own]


def test_every_hedge_is_the_same_in_c(tmp_path):
    rows = [
        *((Hedge(name, 1.7 if HEDGES[name].parameters else None),) for name in BUILT_IN_HEDGES),
        (Hedge("very"), Hedge("not"), Hedge("somewhat")),
    ]
    shapes = [Shape("trapezoid", (-1.5, -0.7, 0.1, 1.9)), Shape("s", (-1.3, 0.7))]
    x = np.linspace(-2, 2, 203)
    first, *others = [degrees_of(shapes, hedges) for hedges in rows]
    _, results = compared_in_c(first, tmp_path, [x], *others)
    cells = itertools.product(rows, shapes)
    for (hedges, shape), found in zip(cells, results, strict=True):
        degree = [SHAPES[shape.kind].scalar(v, *shape.parameters) for v in x.tolist()]
        for hedge in reversed(hedges):
            numbers = () if hedge.exponent is None else (hedge.exponent,)
            degree = [HEDGES[hedge.name].scalar(d, *numbers) for d in degree]
        np.testing.assert_allclose(found, degree, rtol=1e-12, atol=1e-12)


def test_consequents_under_any_are_compiled_without_a_warning(tmp_path):
    rules = """
term u C: gaussian 0 1
rule if a is L and b is N then u is any C
rule if a is L then u is any M
rule if a is H then u is U
"""
    models = [made(rules, implication=name) for name in ("min", "drastic")]
    routines = [routine for model in models for routine in routines_of(model)]
    points = [np.array([0.5, 1.5, 3.0, 3.9]), np.array([-0.9, -0.2, 0.3, 0.9])]
    for routine, found in zip(
        routines, run_c(routines, [points] * len(routines), tmp_path), strict=True
    ):
        np.testing.assert_allclose(found, routine.model(*points), rtol=1e-6)


@pytest.fixture
def own_kinds():
    kinds.shape(
        "parabola", ("centre", "width"), lambda x, c, w: op.maximum(0, 1 - ((x - c) / w) ** 2)
    )
    kinds.shape(
        "wave", ("phase",), lambda x, phase: op.where(x < phase, 0.5 * (1 + op.cos(3 * x)), 0.25)
    )
    kinds.tnorm("yager2", lambda a, b: 1 - op.minimum(1, op.sqrt((1 - a) ** 2 + (1 - b) ** 2)))
    kinds.snorm("yager2", lambda a, b: op.minimum(1, op.sqrt(a**2 + b**2)))
    kinds.hedge("slightly", lambda d: op.where(d < 0.5, 2 * d, 2 - 2 * d))
    yield
    for registry, names in (
        (SHAPES, ("parabola", "wave")), (TNORMS, ("yager2",)), (SNORMS, ("yager2",)),
        (HEDGES, ("slightly",)),
    ):  # fmt: skip
        for name in names:
            registry.remove(name)


def test_kinds_of_a_user_are_the_same_in_c(tmp_path, own_kinds):
    shapes = [Shape("parabola", (0.25, 1.5)), Shape("wave", (0.5,), 0.8)]
    model = degrees_of(shapes, (Hedge("slightly"),))
    both = [Is("x", "t0"), Is("x", "t1", (Hedge("slightly"),))]
    rules = (
        Rule(And((*both, *both)), (Consequent("y0", "one"),)),
        Rule(Or((*both, *both)), (Consequent("y1", "one"),)),
    )
    block = RuleBlock(rules, conjunction="yager2", disjunction="yager2")
    model = dataclasses.replace(model, blocks=(block,))
    x = np.linspace(-2, 2, 301)
    _routines, results = compared_in_c(model, tmp_path, [x])
    for k, norm in enumerate((TNORMS["yager2"].scalar, SNORMS["yager2"].scalar)):
        expected = []
        for v in x.tolist():
            a = SHAPES["parabola"].scalar(v, 0.25, 1.5)
            b = HEDGES["slightly"].scalar(0.8 * SHAPES["wave"].scalar(v, 0.5))
            expected.append(norm(norm(norm(a, b), a), b))
        np.testing.assert_allclose(results[k], expected, rtol=1e-12, atol=1e-15)


def test_smooth_terms_are_exported_with_the_mathematical_library(tmp_path):
    model = load_rulebase(RULEBASES / "tipper.frb")
    (routine,) = routines_of(model)
    points = points_for(model, 3_000)
    (found,) = run_c([routine], [points], tmp_path)
    assert_close(found, routine.model(*points), 30.0)
    (header,) = [text for _, text in export_files([routine], tmp_path / "x.h").files]
    assert "functions of math.h are called" in header
    assert "-o self_test -lm &&" in " ".join(header.replace(" * ", "").split())
    assert "3 functions of math.h" in routine.cost().in_words()


def test_terms_without_functions_do_without_the_library(pd7, tmp_path):
    (header,) = [text for _, text in export_files(routines_of(pd7), tmp_path / "x.h").files]
    assert "no function of a library is called" in header
    assert "-lm" not in header


def test_numbers_too_large_for_single_precision_are_named():
    model = degrees_of([Shape("gaussian", (1e39, 1.0))])
    with pytest.raises(ExportError, match=r"1e\+39, which is too large for single precision"):
        routines_of(model, precision="float32")
    assert routines_of(model)


def test_rules_and_inputs_that_do_not_count_leave_no_trace(tmp_path):
    model = made("rule if a is L then u is D\nrule if b is N then u is U with 0")
    (routine,) = routines_of(model)
    points = points_for(model, 500)
    (found,) = run_c([routine], [points], tmp_path)
    assert_close(found, routine.model(*points), 10.0)


@pytest.mark.slow
def test_long_rules_and_many_terms_are_no_trouble(tmp_path):
    places = " ".join(f"({k / 30 - 1:.4f}, {k % 2})" for k in range(61))
    many = "".join(f"term u X{k}: singleton {k / 60}\n" for k in range(300))
    many += "".join(f"rule if b is Z then u is X{k} with {k / 300}\n" for k in range(300))
    long = " or ".join(["a is L", "b is P"] * 600)
    # Apart: every rule of the kernel's numbers has room for the parts of the longest one.
    models = [
        made(f"term b Z: points {places}\n{more}", defuzzifier="weighted-average")
        for more in (
            many,
            f"term u X: singleton 1\nterm u Y: singleton -1\n"
            f"rule if {long} then u is X\nrule if b is Z then u is Y with 0.3\n",
        )
    ]
    routines = [routine for model in models for routine in routines_of(model)]
    columns = [points_for(model, 500) for model in models]
    results = run_c(routines, columns, tmp_path)
    for routine, points, found in zip(routines, columns, results, strict=True):
        np.testing.assert_array_equal(found, routine.evaluate(*points))
        assert_close(found, routine.model(*points), 10.0)
    many = " ".join(f"({k / 100 - 1}, {k % 2})" for k in range(150))
    with pytest.raises(ExportError, match="term 'Z' of 'b' has 150 corners"):
        routines_of(made(f"term b Z: points {many}\nrule if b is Z then u is D"))


@pytest.mark.parametrize("how", [[], ["--direct"]])
def test_unbounded_variables_and_rules_that_never_fire(tmp_path, monkeypatch, how):
    from c_programs import compile_c, execute

    from fuzzyarm.apps.cli import main

    monkeypatch.chdir(tmp_path)
    Path("odd.frb").write_text(
        "rulebase odd\ninput a -inf .. inf\ninput b 0 .. inf\noutput y -inf .. inf\n"
        "output z 0 .. 1\n"
        "term a L: ramp 1 -1\nterm a H: ramp -1 1\nterm b S: trapezoid 0 0 1 2\n"
        "term b N: triangle -5 -4 -3\n"
        "term y P: singleton 3\nterm y Q: linear 2*a + 1\nterm z Z: singleton 0.5\n"
        "inference defuzzifier weighted-average, no-rule 0\n"
        "inference z: no-rule " + ("nan" if how else "0.25") + "\n"
        "rule if a is L and b is S then y is P\nrule if a is H then y is Q\n"
        "rule if b is N then z is Z\n"
        "lookup\n  levels a: -2 .. 2 step 1\n  levels b: 0 .. 3 step 1\n"
    )
    assert main(["compile", "odd.frb", "-o", "odd.h", *how]) == 0
    compile_c(["-x", "c", "odd.h"], tmp_path / "odd", HOST, "-DFUZZYARM_SELF_TEST")
    assert execute(tmp_path / "odd") == 0


def grid_of(size):
    """Return a rule base with a rule in each of size² cells."""
    names = [f"T{i}" for i in range(size)]
    rows = (" ".join([names[i], *(names[(i + j) // 2] for j in range(size))]) for i in range(size))
    lines = ["rulebase grid", "input e -1 .. 1", "input ce -1 .. 1", "output u -1 .. 1"]
    lines += [
        f"terms e, ce, u: triangles {' '.join(names)}",
        "rules u",
        f"e \\ ce {' '.join(names)}",
    ]
    return parse("\n".join([*lines, *rows, "inference defuzzifier centroid exact"])).rulebase


@pytest.mark.slow
def test_the_time_of_a_program_grows_with_its_rules_and_not_with_their_square(request):
    def seconds(size):
        model, start = grid_of(size), time.process_time()
        make_program(model, "u", ("e", "ce"))
        return time.process_time() - start

    # A collection of garbage goes through all that other tests have left.
    gc.disable()
    request.addfinalizer(gc.enable)

    # 16 times the rules: 16 to 20 times the time, 60 where each rule walks all others.
    assert seconds(120) < 36 * min(seconds(30) for _ in range(3))
