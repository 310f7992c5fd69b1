from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

DEGREES = [0.0, 1e-300, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0]
PAIRS = np.array(list(itertools.product(DEGREES, DEGREES))).T
CONJUNCTIONS = tuple(name for name, norm in TNORMS.items() if not norm.own)
DISJUNCTIONS = tuple(name for name, norm in SNORMS.items() if not norm.own)
DUALS = [(name, TNORMS[name].dual) for name in CONJUNCTIONS if TNORMS[name].dual]
degree = st.floats(0.0, 1.0)


@pytest.mark.parametrize("name", CONJUNCTIONS)
def test_t_norms_of_arrays_equal_those_of_numbers(name: str) -> None:
    plain = [TNORMS[name].scalar(a, b) for a, b in PAIRS.T.tolist()]
    np.testing.assert_array_equal(TNORMS[name].array(*PAIRS), plain)


@pytest.mark.parametrize("name", DISJUNCTIONS)
def test_s_norms_of_arrays_equal_those_of_numbers(name: str) -> None:
    plain = [SNORMS[name].scalar(a, b) for a, b in PAIRS.T.tolist()]
    np.testing.assert_array_equal(SNORMS[name].array(*PAIRS), plain)


@pytest.mark.parametrize(("tnorm", "snorm"), DUALS)
@given(a=degree, b=degree)
def test_t_and_s_norms_are_duals(tnorm: str, snorm: str, a: float, b: float) -> None:
    if tnorm in {"drastic", "nilpotent"}:  # they jump: 1 − (1 − a) must be a itself
        a, b = round(a * 64) / 64, round(b * 64) / 64
    dual = 1.0 - TNORMS[tnorm].scalar(1.0 - a, 1.0 - b)
    assert SNORMS[snorm].scalar(a, b) == pytest.approx(dual, abs=1e-9)


@pytest.mark.parametrize("name", CONJUNCTIONS)
@given(a=degree, b=degree, c=degree)
def test_t_norms_are_norms(name: str, a: float, b: float, c: float) -> None:
    norm = TNORMS[name].scalar
    assert norm(a, 1.0) == pytest.approx(a, abs=1e-15)
    assert norm(a, 0.0) == 0.0
    assert norm(a, b) == norm(b, a)
    assert norm(a, b) <= min(a, b) + 1e-15
    low, high = sorted((b, c))
    assert norm(a, low) <= norm(a, high) + 1e-15


@pytest.mark.parametrize("name", DISJUNCTIONS)
@given(a=degree, b=degree)
def test_zero_changes_no_aggregate(name: str, a: float, b: float) -> None:
    norm = SNORMS[name].scalar
    assert norm(0.0, a) == a == norm(a, 0.0)
    assert norm(a, b) == norm(b, a)
    assert norm(a, b) >= max(a, b) - 1e-15
