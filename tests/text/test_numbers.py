"""Bounds as text: rounded outward, and short."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.base.numbers import outward_text


@pytest.mark.parametrize(
    ("value", "up", "text"),
    [(2.00021e-8, True, "2.00021e-08"), (-2.00021e-8, False, "-2.00021e-08"),
     (1.5e-5, True, "0.000015"), (5.33333333333, True, "5.333334"),
     (5.33333333333, False, "5.333333"),
     (0.0, True, "0"), (math.inf, True, "inf")],
)  # fmt: skip
def test_a_small_bound_has_an_exponent(value, up, text):
    assert outward_text(value, up=up) == text


@given(st.floats(allow_nan=False, allow_infinity=False), st.booleans())
def test_a_bound_is_rounded_outward(value, up):
    read = float(outward_text(value, up=up))
    assert (read >= value) if up else (read <= value)
