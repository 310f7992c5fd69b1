from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from st_programs import WORDS

from fuzzyarm.exchange.export.numbers import c_number, rounded_down, st_number
from fuzzyarm.symbolic.identifiers import C_RESERVED, ST_RESERVED, Names, identifier

words = st.text(max_size=8) | st.sampled_from(["int", "INT", "e", "E", "ė", "α", "9", "_", "a__b_"])


@pytest.mark.slow
@given(st.lists(words, max_size=12), st.sampled_from(["c", "st"]))
def test_names_are_valid_and_different(wanted, language):
    names = Names(language)
    found = [names.new(word) for word in wanted]
    keys = [name.lower() for name in found] if language == "st" else found
    assert len(set(keys)) == len(found)
    reserved = ST_RESERVED if language == "st" else C_RESERVED
    assert not reserved & set(keys)
    assert all(re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", name) for name in found)


def test_names_stay_readable():
    assert [identifier(x) for x in ("ė", "angle (rad)", "2nd", "", "κ", "Größe")] == [
        "e", "angle_rad", "x2nd", "x", "kappa", "Gro_e",
    ]  # fmt: skip
    names = Names()
    assert [names.new(x) for x in ("e", "e", "double", "double")] == [
        "e", "e_2", "double_x", "double_x_2",
    ]  # fmt: skip


@given(st.floats(allow_nan=False, allow_infinity=False, width=32))
def test_literals_read_back_exactly(x):
    literal = c_number(x, np.float32)
    assert np.float32(float(literal.removesuffix("f"))) == np.float32(x)
    assert re.fullmatch(r"-?\d+(\.\d+)?(e[+-]\d+)?f", literal)
    assert "." in literal or "e" in literal
    assert re.fullmatch(r"-?\d+\.\d+(E[+-]\d+)?", st_number(x, np.float32))
    assert np.float32(float(st_number(x, np.float32))) == np.float32(x)
    assert float(c_number(x, np.float64)) == x


@given(st.floats(-1e30, 1e30), st.floats(-(2.0**99), 2.0**99, width=32))
def test_a_threshold_rounded_down_decides_as_in_double_precision(threshold, x):
    (near,) = rounded_down([threshold], np.float32, "axis")
    for value in (np.float32(x), near, np.nextafter(near, np.float32(np.inf))):
        assert (value > near) == (float(value) > threshold)


@pytest.mark.parametrize("word", ["INT_TO_REAL", "TRUNC_DINT", "to_int", "Lreal_Trunc"])
def test_a_conversion_of_the_language_is_no_name_in_structured_text(word):
    assert Names("st").new(word) == f"{word}_x"
    assert Names("c").new(word) == word


def test_no_word_of_a_compiler_is_a_name_in_structured_text():
    # Names that are handed out are those that a block could declare.
    taken = [word for word in WORDS if Names("st").new(word.upper()).lower() == word]
    assert not taken
    assert Names("st").new("time_to_collision") == "time_to_collision"
