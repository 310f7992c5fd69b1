"""Shapes are found again from their samples."""

from __future__ import annotations

import math

import numpy as np
import pytest
import skfuzzy
from budget import cases
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from fuzzyarm.apps.show.terms import shape_words
from fuzzyarm.exchange.formats.composed import composed, norm_of
from fuzzyarm.exchange.formats.recovery import (
    TOLERANCE,
    beside_lines,
    constant_beyond,
    even_family,
    is_joined,
    joined,
    recovered,
    shape_of,
    straight_shape,
)
from fuzzyarm.inference import infer
from fuzzyarm.language import parse
from fuzzyarm.language.declarations import even_shapes
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import membership, membership_function

XS = np.linspace(-2.0, 3.0, 101)


@pytest.mark.parametrize(
    ("degrees", "expected"),
    [
        (skfuzzy.trimf(XS, [-1.07, 0.3, 2.2]), ("triangle", -1.07, 0.3, 2.2)),
        (skfuzzy.trimf(XS, [-2, -2, 1]), ("triangle", -2, -2, 1)),
        (skfuzzy.trapmf(XS, [-1.5, 0.11, 0.9, 2.03]), ("trapezoid", -1.5, 0.11, 0.9, 2.03)),
        (skfuzzy.trapmf(XS, [1.5, 2, 3, 3]), ("trapezoid", 1.5, 2, 3, 3)),
        (skfuzzy.gaussmf(XS, 0.4, 0.7), ("gaussian", 0.4, 0.7)),
        (skfuzzy.gaussmf(XS, 3, 0.25), ("gaussian", 3, 0.25)),
        (skfuzzy.gauss2mf(XS, -1, 0.2, 0.5, 0.9), ("two-sided-gaussian", -1, 0.2, 0.5, 0.9)),
        (skfuzzy.gbellmf(XS, 0.8, 2.5, 0.3), ("bell", 0.3, 0.8, 2.5)),
        (skfuzzy.sigmf(XS, 0.3, -4), ("sigmoid", 0.3, -4)),
        (skfuzzy.smf(XS, -1, 1.3), ("s", -1, 1.3)),
        (skfuzzy.zmf(XS, -1, 1.3), ("z", -1, 1.3)),
        (skfuzzy.pimf(XS, -1.5, -0.2, 0.6, 2.1), ("pi", -1.5, -0.2, 0.6, 2.1)),
    ],
    ids=lambda each: each[0] if isinstance(each, tuple) else "",
)
def test_what_scikit_fuzzy_has_sampled(degrees: np.ndarray, expected: tuple) -> None:
    kind, *numbers = expected
    assert recovered(XS.tolist(), degrees.tolist()) == Shape(kind, tuple(map(float, numbers)))


decimals = st.integers(-12, 12).map(lambda n: n / 4)  # a flank has 25 samples and more
positive = st.integers(2, 12).map(lambda n: n / 4)
SHAPES = st.one_of(
    st.tuples(st.just("triangle"), st.lists(decimals, min_size=3, max_size=3, unique=True)),
    st.tuples(st.just("trapezoid"), st.lists(decimals, min_size=4, max_size=4, unique=True)),
    st.tuples(st.just("pi"), st.lists(decimals, min_size=4, max_size=4, unique=True)),
    st.tuples(st.just("s"), st.lists(decimals, min_size=2, max_size=2, unique=True)),
).map(lambda pair: Shape(pair[0], tuple(sorted(pair[1])))) | st.one_of(
    st.builds(lambda c, d: Shape("gaussian", (c, d)), decimals, positive),
    st.builds(lambda c, d: Shape("sigmoid", (c, 4 / d)), decimals, positive),
    st.builds(lambda c, w, s: Shape("bell", (c, w, s)), decimals, positive, positive),
)


@settings(max_examples=cases(16, 50), deadline=None)
@given(shape=SHAPES, count=st.integers(2, 90), low=st.integers(-4, 0), width=st.integers(1, 8))
def test_what_is_recovered_has_every_sample(shape: Shape, count: int, low: int, width: int) -> None:
    """Whatever it is called; with few samples a plainer shape may have them too."""
    xs = [low + width * i / (count - 1) for i in range(count)]
    ys = [membership(shape, x) for x in xs]
    found = recovered(xs, ys)
    if found is not None:
        assert all(abs(membership(found, x) - y) <= TOLERANCE for x, y in zip(xs, ys, strict=True))


@settings(max_examples=cases(10, 30), deadline=None, phases=[Phase.generate])
@given(shape=SHAPES)
def test_a_shape_that_is_seen_whole_comes_back_as_it_was(shape: Shape) -> None:
    xs = [-6.0 + 12.0 * i / 600 for i in range(601)]
    found = recovered(xs, [membership(shape, x) for x in xs])
    assert found is not None
    assert found.kind == shape.kind
    assert found.parameters == pytest.approx(shape.parameters, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    "degrees",
    [np.zeros(101), np.random.default_rng(4).random(101), skfuzzy.dsigmf(XS, -1, 9, 1, 7)],
    ids=["nothing", "noise", "another shape"],
)
def test_what_is_no_shape_is_joined(degrees: np.ndarray) -> None:
    assert recovered(XS.tolist(), degrees.tolist()) is None
    made = joined(XS.tolist(), degrees.tolist())
    between = np.linspace(-2, 3, 777)
    found = [membership(made, float(x)) for x in between]
    assert np.allclose(found, np.interp(between, XS, degrees), atol=1e-12)


def test_few_points_are_kept_of_straight_lines() -> None:
    degrees = skfuzzy.trapmf(XS, [-1.0, 0.0, 0.5, 2.0])
    assert len(joined(XS.tolist(), degrees.tolist()).parameters) == 2 * 6


def test_which_shapes_are_straight_between_the_points() -> None:
    xs = [0.0, 1.0, 2.0, 3.0]
    assert is_joined(Shape("triangle", (-4.0, 1.0, 3.0)), xs)
    assert not is_joined(Shape("triangle", (0.0, 1.5, 3.0)), xs)
    assert not is_joined(Shape("gaussian", (1.0, 1.0)), xs)


def test_how_far_a_shape_is_from_straight_lines() -> None:
    triangle = Shape("triangle", (0.0, 1.5, 3.0))
    assert beside_lines(triangle, [0.0, 1.5, 3.0]) == 0.0
    assert beside_lines(triangle, [0.0, 1.0, 2.0, 3.0]) == pytest.approx(1 / 3)  # below its peak
    smooth = Shape("s", (0.0, 2.0))  # x²/2 up to 1, so 1/8 below the chord at its middle
    assert beside_lines(smooth, [0.0, 1.0, 2.0]) == pytest.approx(1 / 8)


def test_an_even_family_is_one() -> None:
    xs = [i / 4 for i in range(41)]
    clipped = [Shape("triangle", p) for p in ((0.0, 0.0, 5.0), (0.0, 5.0, 10.0), (5.0, 10.0, 10.0))]
    assert even_family(clipped, 0.0, 10.0, xs) == even_shapes("triangles", 3, 0.0, 10.0)
    assert even_family([*clipped[:2], Shape("ramp", (6.0, 10.0))], 0.0, 10.0, xs) is None


@pytest.mark.parametrize(
    "shape",
    [
        Shape("ramp", (3.3, 7.1)),
        Shape("ramp", (7.1, 3.3)),
        Shape("triangle", (-4.0, 2.0, 14.0)),
        Shape("rectangle", (2.5, 4.25)),
        Shape("binary", (6.125, -math.inf)),
        Shape("gaussian", (5.0, 1.0), 0.5),
        Shape("s", (1.0, 9.0)),
    ],
    ids=lambda shape: shape.kind,
)
def test_the_shape_of_a_function(shape: Shape) -> None:
    found = shape_of(lambda x: membership(shape, x), 0.0, 10.0)
    assert found is not None
    between = [-4.9 + 0.0777 * i for i in range(250)]
    assert all(abs(membership(found, x) - membership(shape, x)) <= TOLERANCE for x in between)


def test_a_function_that_is_another_between_its_samples_is_none() -> None:
    assert shape_of(lambda x: 1.0 if math.floor(x * 97) % 2 else 0.0, 0.0, 1.0) is None


def test_which_sets_go_on_as_they_end() -> None:
    assert constant_beyond(Shape("ramp", (2.0, 8.0)), 0.0, 10.0)
    assert constant_beyond(Shape("ramp", (0.0, 10.0)), 0.0, 10.0)
    assert not constant_beyond(Shape("triangle", (2.0, 8.0, 14.0)), 0.0, 10.0)


@pytest.mark.parametrize(
    ("corners", "expected"),
    [
        ((0, 0, 1, 1, 2, 0), ("triangle", 0, 1, 2)),
        ((0, 0, 0.5, 0.5, 1, 1, 2, 1, 4, 0), ("trapezoid", 0, 1, 2, 4)),
        ((0, 1, 1, 0), ("ramp", 1, 0)),
        ((-1, 0, 1, 1), ("ramp", -1, 1)),
        ((0, 0, 1, 0.3, 2, 1, 3, 0), ()),
        ((0, 0, 0, 1, 1, 0), ()),
        ((0, 0.2, 1, 1, 2, 0), ()),
        ((0, 0, 1, 1, 2, 1e-9), ()),
    ],
)
def test_points_that_are_a_straight_shape(corners: tuple, expected: tuple) -> None:
    points = Shape("points", tuple(map(float, corners)), 0.7)
    found = straight_shape(points)
    assert (found.kind, *found.parameters) == (expected or ("points", *corners))
    for x in np.linspace(-3.0, 5.0, 257).tolist():
        assert abs(membership(found, x) - membership(points, x)) <= TOLERANCE


@pytest.mark.parametrize("ys", [(1.0, 0.25, 0.25, 0.25), (0.25, 0.25, 0.25, 1.0)])
def test_a_level_stretch_is_not_a_flank_of_a_bell(ys):
    assert recovered([-6.0, -5.9375, -5.875, -5.8125], ys) is None


# --- Sets that are made of sets ---


@pytest.mark.slow
@pytest.mark.parametrize("norm", ["t:min", "t:bounded", "s:max", "s:bounded"])
def test_straight_sets_make_straight_sets(norm: str) -> None:
    generator = np.random.default_rng(2)
    exact = 0
    for _ in range(cases(12, 200)):
        parts = [
            Shape("trapezoid", tuple(np.sort(generator.uniform(0.0, 10.0, 4)).round(2).tolist()))
            for _ in range(generator.integers(2, 4))
        ]
        degree = norm_of(norm, [membership_function(part) for part in parts])
        shape, is_exact = composed(degree, parts, [norm], 0.0, 10.0)
        exact += is_exact
        xs = generator.uniform(0.0, 10.0, 200)
        off = max(abs(membership_function(shape)(x) - degree(x)) for x in xs)
        assert off <= (1e-7 if is_exact else 0.05), parts
    assert exact >= 0.8 * cases(12, 200)


@pytest.mark.parametrize("count", [11, 21])
def test_the_far_tail_of_a_gaussian_is_not_straight(count: int) -> None:
    """At 2 nothing but the tail of the second one fires, to 2e-22: 7.5 of 0 .. 10 is right."""
    xs = np.linspace(0.0, 10.0, count)
    shapes = []
    for mean in (0.0, 1.0):
        degrees = skfuzzy.gaussmf(xs, mean, 0.1)
        shape = recovered(xs.tolist(), degrees.tolist()) or joined(xs.tolist(), degrees.tolist())
        shapes.append(shape)
        for x, y in zip(xs, degrees, strict=True):
            assert membership(shape, x) == pytest.approx(y, rel=1e-9, abs=0.0)
    text = (
        "rulebase tails\n\ninput  x  0 .. 10\noutput y  0 .. 10\n\n"
        + "".join(
            f"term x {name}:  {shape_words(shape)}\n"
            for name, shape in zip("ab", shapes, strict=True)
        )
        + "term y l: trapezoid 0 0 2 5\nterm y h: trapezoid 5 8 10 10\n\n"
        "rule if x is a then y is l\nrule if x is b then y is h\n"
    )
    assert infer(parse(text).rulebase, {"x": 2.0})["y"] == pytest.approx(7.5, abs=0.01)
