"""Enclosures against the balls of Arb and exact fractions: they hold the truth, and are narrow."""

import math
from fractions import Fraction

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.proof.loop import enclosure
from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals, matrix_exponential

flint = pytest.importorskip("flint")

SEED = np.random.default_rng(27)

TURNS = np.concatenate(
    [SEED.uniform(-9, 9, 300), SEED.uniform(-5e5, 5e5, 100), np.arange(-8, 9) * math.pi / 4]
)
SIZES = np.exp(SEED.uniform(-300, 300, 300))
SLOPES = np.concatenate([SEED.uniform(-3, 3, 300), SEED.uniform(-1e9, 1e9, 50)])

POINTS = {
    "sine": (enclosure.sine, "sin", TURNS),
    "cosine": (enclosure.cosine, "cos", TURNS),
    "exponential": (enclosure.exponential, "exp", SEED.uniform(-690, 690, 400)),
    "tangent": (enclosure.tangent, "tan", SEED.uniform(-1.5, 1.5, 300)),
    "logarithm": (enclosure.logarithm, "log", SIZES),
    "arctangent": (enclosure.arctangent, "atan", SLOPES),
    "square_root": (enclosure.square_root, "sqrt", SIZES),
}


@pytest.fixture(autouse=True, scope="module")
def precision():
    with flint.ctx.workprec(200):
        yield


def ball(value: float):
    return flint.arb(value)


@pytest.mark.parametrize("name", POINTS)
def test_a_function_holds_the_ball_of_arb_and_is_narrow(name):
    function, arb, points = POINTS[name]
    found = function(Intervals.at(points))
    for x, low, high in zip(points, found.low, found.high, strict=True):
        true = getattr(ball(float(x)), arb)()
        assert ball(float(low)) <= true <= ball(float(high))
        scale = max(abs(float(true.mid())), 0.0 if name == "exponential" else 1.0)
        scale = 1.0 + scale**2 if name == "tangent" else scale  # its slope
        assert high - low <= 1e-13 * scale + 4e-300


@pytest.mark.parametrize("name", POINTS)
def test_a_function_over_an_interval_holds_its_values_inside(name):
    function, arb, points = POINTS[name]
    for centre in points[:40]:
        width = abs(centre) * 0.2 if name in ("logarithm", "square_root") else 0.04
        low, high = float(centre - width), float(centre + width)
        found = function(Intervals.at(low).hull(Intervals.at(high)))
        for x in np.linspace(low, high, 9):
            true = getattr(ball(float(x)), arb)()
            assert ball(float(found.low)) <= true <= ball(float(found.high))


def test_the_parts_of_pi_and_log_2_are_what_the_bounds_take_them_for():
    for (first, rest), true, error in (
        (enclosure.HALF_PI, flint.arb.pi() / 2, 7e-27),
        (enclosure.LOG_2, ball(2.0).log(), 1.2e-26),
    ):
        assert abs(true - ball(first) - ball(rest)) < error
        assert Fraction(first) * 2**33 % 1 == 0  # few bits: a whole multiple is exact


numbers = st.floats(-1e6, 1e6)


@settings(max_examples=cases(60, 600), deadline=None)
@given(st.tuples(numbers, numbers), st.tuples(numbers, numbers), st.floats(0, 1), st.floats(0, 1))
def test_arithmetic_holds_the_exact_results(a, b, s, t):
    first, second = (Intervals.between(min(pair), max(pair)) for pair in (a, b))
    x = Fraction(min(a)) + Fraction(s) * (Fraction(max(a)) - Fraction(min(a)))
    y = Fraction(min(b)) + Fraction(t) * (Fraction(max(b)) - Fraction(min(b)))
    results = [
        (first + second, x + y), (first - second, x - y), (first * second, x * y),
        (first.squared(), x * x), (enclosure.absolute(first), abs(x)),
    ]  # fmt: skip
    if not second.low <= 0 <= second.high:
        with np.errstate(over="ignore"):
            results.append((first / second, x / y))
    for found, true in results:
        # A fraction is compared with a float exactly; beyond the floats an end is infinite.
        assert float(found.low) <= true <= float(found.high)


def test_what_has_no_bound_is_refused():
    across = Intervals.between(-1.0, 1.0)
    for fails in (
        lambda: 1.0 / across,
        lambda: enclosure.square_root(across),
        lambda: enclosure.logarithm(across),
        lambda: enclosure.tangent(Intervals.between(1.0, 2.0)),
        lambda: Intervals.between(1.0, 0.0),
    ):
        with pytest.raises(EnclosureError):
            fails()


@pytest.mark.parametrize("size", [0.1, 1.0, 30.0])
@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_the_matrix_exponential_holds_that_of_arb(order, size):
    matrix = np.random.default_rng(order).normal(size=(order, order)) * size / order
    found = matrix_exponential(matrix, 0.5)
    flint.ctx.prec = 300
    true = (flint.arb_mat(order, order, matrix.ravel().tolist()) * flint.arb(0.5)).exp()
    for i in range(order):
        for j in range(order):
            assert flint.arb(float(found.low[i, j])) <= true[i, j]
            assert true[i, j] <= flint.arb(float(found.high[i, j]))
    largest = max(abs(float(true[i, j].mid())) for i in range(order) for j in range(order))
    assert found.radius.max() <= 1e-10 * largest


def test_the_exponential_of_intervals_holds_those_of_its_matrices():
    generator = np.random.default_rng(3)
    middle = generator.normal(size=(3, 3))
    box = Intervals.between(middle - 0.01, middle + 0.01)
    found = matrix_exponential(box)
    for _ in range(50):
        inside = matrix_exponential(generator.uniform(box.low, box.high))
        assert found.holds(inside).all()
