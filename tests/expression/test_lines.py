"""Straight lines through corners: one rounding, whoever reads them."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_definitions import SHAPE_VALUES

from fuzzyarm.language.model.rulebase import Hedge, Shape
from fuzzyarm.language.model.shapes import apply_hedges, polyline, straight_lines
from fuzzyarm.symbolic.kinds import SHAPES
from fuzzyarm.symbolic.lines import degree_on_corners, lines_through, sampled_degrees

position = st.one_of(
    st.sampled_from([0.0, 1.0, 1.5, 2.0]), st.integers(-500, 500).map(lambda i: i / 49)
)
height = st.one_of(st.sampled_from([0.0, 0.25, 0.5, 1.0]), st.floats(0.0, 1.0))
CORNERS = st.dictionaries(position, st.lists(height, min_size=1, max_size=3), min_size=1).map(
    lambda edges: [(x, y) for x in sorted(edges) for y in edges[x]]
)


def flat(corners):
    return [number for corner in corners for number in corner]


def places(corners):
    """Return corners, their neighbours, and positions between and beyond."""
    edges = sorted({x for x, _ in corners})
    near = [math.nextafter(x, way) for x in edges for way in (-math.inf, math.inf)]
    between = [a + (b - a) * share for a, b in pairwise(edges) for share in (1e-9, 0.3, 0.5, 0.99)]
    return sorted([*edges, *near, *between, edges[0] - 1.0, edges[-1] + 1.0])


def exact(corners, x):
    """Return the height at a position in rational numbers, the greatest on an upright edge."""
    at = [y for edge, y in corners if edge == x]
    if at:
        return Fraction(max(at))
    if x < corners[0][0]:
        return Fraction(corners[0][1])
    if x > corners[-1][0]:
        return Fraction(corners[-1][1])
    (a, y), (b, z) = next(p for p in pairwise(corners) if p[0][0] < x < p[1][0])
    share = (Fraction(x) - Fraction(a)) / (Fraction(b) - Fraction(a))
    return Fraction(y) + share * (Fraction(z) - Fraction(y))


@given(CORNERS)
def test_point_arrays_and_rows_have_the_same_bits(corners):
    lines, xs = lines_through(corners), places(corners)
    one = [lines.at(x) for x in xs]
    assert lines.over(np.array(xs)).tolist() == one
    assert [degree_on_corners(flat(corners), x) for x in xs] == one
    assert [lines.over(np.array(x)).item() for x in xs] == one


@given(CORNERS)
def test_they_are_the_rational_ones_within_a_few_roundings(corners):
    lines, xs = lines_through(corners), places(corners)
    for x, sampled in zip(xs, sampled_degrees(corners, xs), strict=True):
        wanted = float(exact(corners, x))
        assert lines.at(x) == pytest.approx(wanted, rel=1e-14, abs=1e-15)
        assert sampled == pytest.approx(wanted, rel=1e-14, abs=1e-15)


@given(CORNERS)
def test_at_a_corner_the_height_stands_as_it_is(corners):
    lines = lines_through(corners)
    edges = sorted({x for x, _ in corners})
    tops = [max(y for x, y in corners if x == edge) for edge in edges]
    assert [lines.at(edge) for edge in edges] == tops
    assert sampled_degrees(corners, edges) == tops


@given(CORNERS)
def test_next_to_a_foot_a_degree_is_neither_lost_nor_negative(corners):
    lines = lines_through(corners)
    for (a, y), (b, z) in pairwise(corners):
        inner = [x for x in (math.nextafter(a, b), math.nextafter(b, a)) if a < x < b]
        for x in inner:
            if 0.0 in (y, z) and abs(x) > 1e-300 and max(y, z) > 1e-290:
                assert lines.at(x) > 0.0


def test_a_peak_that_a_slope_misses_is_1():
    lines = lines_through([(0.0, 0.0), (49.0, 1.0), (98.0, 0.0)])
    assert lines.between[1].at(49.0) < 1.0
    assert lines.at(49.0) == 1.0
    assert lines.over(np.array([49.0])).tolist() == [1.0]
    assert degree_on_corners([0.0, 0.0, 49.0, 1.0, 98.0, 0.0], 49.0) == 1.0


def test_corners_closer_than_a_slope_can_be():
    corners = [(0.0, 0.0), (1e-310, 1.0), (1.0, 0.0)]
    lines = lines_through(corners)
    for x in (0.0, 5e-311, 1e-310, 0.5):
        assert 0.0 <= lines.at(x) <= 1.0
        assert degree_on_corners(flat(corners), x) == lines.at(x)


def rise(x, foot, top):
    if foot == -math.inf or x >= top:
        return 1.0
    return 0.0 if x <= foot else (x - foot) / (top - foot)


def trapezoid(x, left, top_left, top_right, right):
    if top_left <= x <= top_right:
        return 1.0
    return rise(x, left, top_left) if x < top_left else rise(-x, -right, -top_right)


FORMULAS = {
    "triangle": lambda x, left, peak, right: trapezoid(x, left, peak, peak, right),
    "trapezoid": trapezoid,
    "rectangle": lambda x, start, end: float(start <= x <= end),
    "ramp": lambda x, zero, one: rise(x, zero, one) if zero <= one else rise(-x, -zero, -one),
    "singleton": lambda x, value: float(x == value),
    "binary": lambda x, start, way: float(x >= start if way > start else x <= start),
}


@pytest.mark.parametrize(
    ("kind", "numbers"), [(k, n) for k, n, _ in SHAPE_VALUES if k in FORMULAS], ids=str
)
def test_corners_are_those_of_the_formula(kind, numbers):
    numbers = tuple(map(float, numbers))
    for x in np.linspace(-10, 10, 81).tolist():
        wanted = FORMULAS[kind](x, *numbers)
        assert SHAPES[kind].scalar(x, *numbers) == pytest.approx(wanted, abs=1e-14)


HEDGES = st.lists(
    st.sampled_from([Hedge("not"), Hedge("any"), Hedge("very"), Hedge("power", 0.3)]), max_size=2
)


@given(CORNERS, HEDGES, st.sampled_from([1.0, 0.75]))
def test_hedged_lines_have_the_bits_of_hedged_degrees(corners, hedges, top):
    shape = Shape("points", tuple(flat(corners)), height=top)
    lines = straight_lines(shape, hedges)
    if lines is None:
        assert hedges
        return
    plain = lines_through(polyline(shape))
    for x in places(corners):
        assert lines.at(x) == apply_hedges(hedges, plain.at(x)), x


def test_of_hedges_not_keeps_a_triangle_straight():
    triangle, box = Shape("triangle", (0.0, 1.0, 3.0)), Shape("rectangle", (0.0, 1.0))
    assert straight_lines(triangle, (Hedge("not"),)) is not None
    assert straight_lines(triangle, (Hedge("very"),)) is None
    assert straight_lines(triangle, (Hedge("not"), Hedge("not"))) is None  # rounded twice
    assert straight_lines(box, (Hedge("very"), Hedge("not"))) is not None
    assert straight_lines(Shape("gaussian", (0.0, 1.0))) is None
