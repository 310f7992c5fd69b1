"""Affine forms hold what they are made of, by exact fractions and by the balls of Arb."""

import math
from fractions import Fraction

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.proof.loop import zonotope
from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals
from fuzzyarm.proof.loop.readings import CONDITIONS, UnenclosedError, pruned, read, readable
from fuzzyarm.proof.loop.zonotope import Forms, clip, dot, larger, smaller, stacked
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import constant, symbol

flint = pytest.importorskip("flint")

small = st.floats(-4, 4, allow_subnormal=False)
shares = st.floats(-1, 1)


def forms(values):
    """Return a form of one box: centre, parts, rest."""
    centre, *parts, rest = values
    return Forms(np.array([centre]), np.array(parts)[:, None], np.array([abs(rest)]))


def exactly(values, symbols, own):
    """Return the value that a form has for some symbols; `own` for its rest."""
    centre, *parts, rest = map(Fraction, values)
    total = centre + abs(rest) * Fraction(own)
    return total + sum(a * Fraction(e) for a, e in zip(parts, symbols, strict=True))


def holds(found, values):
    """Tell whether a form may be each of some values for the symbols that they belong to."""
    for value, symbols in values:
        known = Fraction(float(found.centre[0]))
        for part, e in zip(found.parts[:, 0], [*symbols] + [0.0] * len(found.parts), strict=False):
            known += Fraction(float(part)) * Fraction(e)
        if abs(value - known) > Fraction(float(found.rest[0])):
            return False
    return True


one_form = st.tuples(small, small, small, st.floats(0, 1))


@settings(max_examples=cases(60, 800), deadline=None)
@given(one_form, one_form, shares, shares, shares, shares)
def test_arithmetic_holds_the_exact_value_for_each_choice_of_symbols(a, b, e, f, g, h):
    x, y = exactly(a, (e, f), g), exactly(b, (e, f), h)
    first, second = forms(a), forms(b)
    results = [
        (first + second, x + y), (first - second, x - y), (first * second, x * y),
        (first.scaled(0.3), x * Fraction(0.3)), (first * first, x * x),
        (first + 0.7, x + Fraction(0.7)),
        (larger(first, second), max(x, y)), (smaller(first, second), min(x, y)),
        (clip(first, -1.0, 1.0), min(max(x, Fraction(-1)), Fraction(1))),
        (dot(stacked([first, second]), stacked([second, second])), x * y + y * y),
        (first / 0.7, x / Fraction(0.7)),
    ]  # fmt: skip
    for found, true in results:
        assert holds(found, [(true, (e, f))])
        assert found.bounds.low[0] <= true <= found.bounds.high[0]


FUNCTIONS = {"sin": (-4, 4), "cos": (-4, 4), "exp": (-4, 4), "tanh": (-4, 4), "atan": (-4, 4),
             "log": (0.01, 5), "sqrt": (0.01, 5), "reciprocal": (0.05, 5), "sinh": (-4, 4),
             "cosh": (-4, 4), "tan": (-1.4, 1.4), "asin": (-0.95, 0.95),
             "acos": (-0.95, 0.95)}  # fmt: skip


def test_every_smooth_function_of_forms_is_tried_below():
    assert set(FUNCTIONS) == set(zonotope.FUNCTIONS)


@settings(max_examples=cases(20, 300), deadline=None)
@given(st.sampled_from(sorted(FUNCTIONS)), st.floats(0, 1), st.floats(0.001, 1), st.floats(0, 1))
def test_a_function_holds_its_value_for_each_choice_of_symbols(name, at, width, tail):
    low, high = FUNCTIONS[name]
    radius = 0.5 * width * (high - low)
    centre = low + radius + at * (high - low - 2 * radius)
    values = (centre, radius * 0.5 * (1 - tail), radius * 0.49, radius * 0.5 * tail * 0.99)
    found = forms(values).function(name)
    flint.ctx.prec = 120
    for e in (-1.0, -0.3, 0.0, 0.6, 1.0):
        for f in (-1.0, 0.2, 1.0):
            for own in (-1.0, 1.0):
                x = exactly(values, (e, f), own)
                ball = flint.arb(flint.fmpq(x.numerator, x.denominator))
                y = 1 / ball if name == "reciprocal" else getattr(ball, name)()
                known = flint.arb(float(found.centre[0]))
                for part, s in zip(found.parts[:, 0], (e, f), strict=True):
                    known += flint.arb(float(part)) * flint.arb(s)
                assert not abs(y - known) > flint.arb(float(found.rest[0]))


def test_what_is_shared_cancels():
    x = Forms.between([1.0], [3.0]).with_symbols(1, [0])
    assert (x - x).radius[0] < 1e-11
    sine = Forms.between([-0.1], [0.1]).with_symbols(1, [0]).function("sin")
    assert sine.rest[0] < 5e-5  # 0.1³ / 24, and the sine is 0.1 to each side


def test_fewer_symbols_hold_as_much():
    generator = np.random.default_rng(5)
    whole = Forms(np.zeros((3, 1)), generator.normal(size=(40, 3, 1)), np.zeros((3, 1)))
    fewer = whole.reduced(2, 20)
    assert len(fewer.parts) == 20
    assert (fewer.parts[:2] == whole.parts[:2]).all()
    for _ in range(50):  # the support in a direction may only grow
        way = generator.normal(size=3)
        before = np.abs(np.einsum("mib,i->m", whole.parts, way)).sum()
        after = np.abs(np.einsum("mib,i->m", fewer.parts, way)).sum()
        assert after >= before * (1 - 1e-12)


def test_an_expression_is_read_and_what_has_no_reading_is_refused():
    x, y = symbol("x"), symbol("y")
    root = readable(op.tan(x) + op.power(y, 3.0) - op.sinh(x) / (1.0 + y * y))
    box = {"x": (0.1, 0.3), "y": (-0.5, 0.2)}
    values = {name: Forms.between([a], [b]) for name, (a, b) in box.items()}
    found = read([root], values)[0].bounds
    for a in np.linspace(*box["x"], 5):
        for b in np.linspace(*box["y"], 5):
            value = math.tan(a) + b**3 - math.sinh(a) / (1 + b * b)
            assert found.low[0] <= value <= found.high[0]
    with pytest.raises(UnenclosedError, match="'floor'"):
        readable(op.floor(x))


def test_a_root_from_0_on_is_held_and_of_what_may_be_negative_refused():
    x = symbol("x")
    root = readable(op.sqrt(op.maximum(x, 0.0)))
    found = read([root], {"x": Forms.between([-0.1], [0.4]).with_symbols(1, [0])})[0]
    for e in np.linspace(-1, 1, 21):
        value = math.sqrt(max(0.15 + 0.25 * e, 0.0))
        middle = found.centre[0] + found.parts[0, 0] * e
        assert abs(value - middle) <= found.rest[0]
    with pytest.raises(EnclosureError):
        read([readable(op.sqrt(x))], {"x": Forms.between([-0.1], [0.4])})


def test_intervals_without_end_are_no_forms():
    with pytest.raises(EnclosureError):
        Forms.of(Intervals.between(0.0, np.inf))


@settings(max_examples=cases(20, 300), deadline=None)
@given(one_form, one_form, one_form, shares, shares, shares, shares, shares)
def test_a_choice_holds_the_branch_that_is_taken(a, b, c, e, f, g, h, i):
    x, y, z = symbol("x"), symbol("y"), symbol("z")
    root = readable(op.where(x < 0.0, y, z * 2.0))
    found = read([root], {"x": forms(a), "y": forms(b), "z": forms(c)})[0]
    condition = exactly(a, (e, f), g) < 0
    true = exactly(b, (e, f), h) if condition else 2 * exactly(c, (e, f), i)
    assert holds(found, [(true, (e, f))])


def test_options_choose_before_forms_are_read():
    x, low, high, hold = symbol("x"), symbol("low"), symbol("high"), symbol("hold")
    limited = op.where(x > low, x, low)
    limited = op.where(limited < high, limited, high)
    root = op.where((hold < 0.0) & (x * 0.0 < 1.0), limited, 1.0 / low)
    assert pruned(root, {"low": -math.inf, "high": math.inf, "hold": 1.0}) == 1.0 / constant(
        -math.inf
    )
    assert pruned(limited, {"low": -math.inf, "high": math.inf}) == x
    assert pruned(limited, {"low": -math.inf, "high": 2.0}) == op.minimum(x, 2.0)


def test_a_condition_on_what_is_no_number_is_open():
    nothing, one = Forms.at(np.array([np.nan])), Forms.at(np.array([1.0]))
    for name in ("less", "less_equal", "equal"):
        for pair in ((nothing, one), (one, nothing)):
            found = CONDITIONS[name](*pair)
            assert (found.low[0], found.high[0]) == (0.0, 1.0), name
