"""Data as JSON has it."""

import json
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.base.jsonable import jsonable

numbers = st.one_of(
    st.floats(),
    st.integers(-(2**60), 2**60),
    st.booleans(),
    st.floats().map(np.float64),
    st.integers(-9, 9).map(np.int64),
    st.lists(st.floats(), max_size=3).map(np.array),
)
whole = st.recursive(
    st.one_of(st.none(), st.text(), numbers),
    lambda parts: st.one_of(
        st.lists(parts, max_size=3),
        st.lists(parts, max_size=3).map(tuple),
        st.dictionaries(st.text(), parts, max_size=3),
    ),
    max_leaves=12,
)


@given(whole)
def test_any_data_is_json_that_reads_back(data):
    written = jsonable(data)
    assert json.loads(json.dumps(written, allow_nan=False)) == written
    assert jsonable(written) == written


def test_what_is_not_finite_is_null_and_all_else_stays():
    data = {
        "a": (1, 2.5, math.nan),
        "b": {"c": -math.inf, "d": "nan"},
        "e": np.array([[1.0, np.inf]]),
    }
    assert jsonable(data) == {"a": [1, 2.5, None], "b": {"c": None, "d": "nan"}, "e": [[1.0, None]]}
