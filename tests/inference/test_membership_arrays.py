from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.inference.sets import degrees as membership
from fuzzyarm.inference.sets import hedged as apply_hedges
from fuzzyarm.language.model.rulebase import Hedge, Shape
from fuzzyarm.language.model.shapes import apply_hedge
from fuzzyarm.language.model.shapes import membership as plain_membership
from fuzzyarm.symbolic.kinds import HEDGES
from tests.strategies import SMOOTH, STRAIGHT, shapes

any_shape = st.sampled_from(STRAIGHT + SMOOTH).flatmap(lambda kind: shapes(kind, -6.0, 6.0))

EDGES = [
    Shape("triangle", (-1.0, -1.0, 2.0)),
    Shape("triangle", (-1.0, 2.0, 2.0)),
    Shape("trapezoid", (-6.0, -6.0, -5.0, -3.0)),
    Shape("trapezoid", (-math.inf, -6.0, -5.0, -3.0)),
    Shape("trapezoid", (3.0, 4.0, 6.0, math.inf)),
    Shape("rectangle", (1.0, 2.0)),
    Shape("ramp", (2.0, 2.0)),
    Shape("ramp", (3.0, -1.0)),
    Shape("binary", (1.0, math.inf)),
    Shape("binary", (1.0, -math.inf)),
    Shape("points", (0.0, 0.0, 1.0, 0.25, 1.0, 1.0, 1.0, 0.5, 3.0, 0.0)),
    Shape("singleton", (1.5,)),
    Shape("two-sided-gaussian", (2.0, 1.0, -1.0, 0.5)),
    Shape("two-sided-gaussian", (-1.0, 1.0, 2.0, 0.5)),
    Shape("bell", (0.0, 0.01, 200.0)),
    Shape("sigmoid", (0.0, -1000.0)),
    Shape("s", (1.0, 1.0)),
    Shape("z", (1.0, 1.0)),
    Shape("pi", (-1.0, -1.0, 2.0, 2.0)),
    Shape("concave", (1.0, 1.0)),
    Shape("arc", (1.0, 1.0)),
    Shape("semi-ellipse", (2.0, -2.0)),
    Shape("semi-ellipse", (2.0, 2.0)),
]


def compare(shape: Shape, xs: np.ndarray) -> None:
    plain = [plain_membership(shape, x) for x in xs.tolist()]
    np.testing.assert_allclose(membership(shape, xs), plain, rtol=0, atol=1e-14)


@given(any_shape)
def test_arrays_equal_single_numbers(shape: Shape) -> None:
    corners = [x + d for x in shape.parameters for d in (-1e-9, 0.0, 1e-9)]
    xs = np.array([*np.linspace(-8.0, 8.0, 33), *corners])
    compare(shape, xs)
    square = xs[: xs.size // 3 * 3].reshape(-1, 3)
    assert membership(shape, square).shape == square.shape


@pytest.mark.parametrize("shape", EDGES, ids=lambda s: f"{s.kind} {s.parameters}")
def test_arrays_equal_single_numbers_on_vertical_edges(shape: Shape) -> None:
    finite = [p for p in shape.parameters if math.isfinite(p)]
    compare(shape, np.array([*finite, *np.linspace(-9.0, 9.0, 37), -300.0, 300.0]))


@given(any_shape)
def test_degrees_are_between_0_and_the_height(shape: Shape) -> None:
    degree = membership(shape, np.linspace(-20.0, 20.0, 101))
    assert (degree >= 0.0).all()
    assert (degree <= shape.height + 1e-15).all()


@pytest.mark.parametrize("name", list(HEDGES))
def test_hedges_of_arrays_equal_hedges_of_numbers(name: str) -> None:
    hedge = Hedge(name, 1.7 if name == "power" else None)
    degrees = np.linspace(0.0, 1.0, 41)
    plain = [apply_hedge(hedge, d) for d in degrees.tolist()]
    np.testing.assert_allclose(apply_hedges((hedge,), degrees), plain, rtol=0, atol=1e-15)


def test_the_hedge_next_to_the_term_acts_first() -> None:
    degrees = np.array([0.3])
    both = apply_hedges((Hedge("not"), Hedge("very")), degrees)
    assert both[0] == pytest.approx(1.0 - 0.09)


def test_a_formula_is_a_membership_function_of_x() -> None:
    shape = Shape("formula", formula="max(0, 1 - abs(x) / 2)")
    np.testing.assert_allclose(membership(shape, np.array([-3.0, 1.0, 0.0])), [0.0, 0.5, 1.0])
