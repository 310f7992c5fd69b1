"""Kernels in other languages: types of names, the order of assignments, what is refused."""

import math
import subprocess
from typing import NamedTuple

import pytest
from needs import need

from fuzzyarm.symbolic.kernels import kernel
from fuzzyarm.symbolic.translation.functions import NotTranslatedError, Translation
from fuzzyarm.symbolic.translation.targets import C99, JAVASCRIPT
from fuzzyarm.symbolic.translation.types import Array, Scalar


class Pair(NamedTuple):
    first: float
    second: float


@kernel
def swapped(a):
    """Use a tuple, a named one, and an assignment of several."""
    x, y = a[0], a[1]
    x, y = y, x
    both = Pair(x, y)
    return both.first - both[1]


@kernel
def summed(a):
    total = 0
    for i in range(len(a)):
        total += a[i]
    return total


@kernel
def named_as_temporaries(a):
    t1, t3 = a[0], a[1]
    t2 = 0.0
    for t4 in range(len(a)):
        t1, t3 = t3, t1 + a[t4]
        t2 += 10.0 * t1 + t3
    return t2


@kernel
def counted_down(n):
    last = 0
    for i in range(n, -1, -2):
        last = i
    return last


@kernel
def mixed(a):
    value = a[0]
    value = a
    return len(value)


@kernel
def powered(x):
    return x**2


def c_of(function, *types):
    translation = Translation(C99)
    translation.function(function, types)
    return translation.text()


def javascript_of(function, *types):
    translation = Translation(JAVASCRIPT)
    translation.function(function, types)
    return translation.text()


def test_a_name_that_becomes_a_real_number_was_one_from_the_start():
    text = c_of(summed, Array.REALS)
    assert "double total_;" in text
    assert "total_ = (double)0;" in text


def test_a_temporary_shadows_no_variable_of_a_kernel():
    text = javascript_of(named_as_temporaries, Array.REALS)
    found = run_javascript(f"{text}\nconsole.log(named_as_temporaries([1, 5, 7]));")
    assert float(found) == named_as_temporaries([1.0, 5.0, 7.0])


def test_values_of_an_assignment_come_before_what_they_are_assigned_to():
    text = javascript_of(swapped, Array.REALS)
    values = run_javascript(f"{text}\nconsole.log(swapped([1, 5]));")
    assert values == "4" == str(int(swapped([1.0, 5.0])))


def test_loops_count_down_and_keep_their_last_number():
    text = javascript_of(counted_down, Scalar.WHOLE)
    for n in (7, 8, 0):
        printed = run_javascript(f"{text}\nconsole.log(counted_down({n}));")
        assert int(printed) == counted_down(n)


def run_javascript(text):
    need("node")
    done = subprocess.run(["node", "-e", text], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_a_name_of_two_kinds_is_refused():
    with pytest.raises(TypeError, match="'value' of the kernel mixed: real and reals under one"):
        c_of(mixed, Array.REALS)


def test_what_is_not_known_is_refused_by_name():
    with pytest.raises(NotTranslatedError, match=r"'x \*\* 2', which is not translated to C"):
        c_of(powered, Scalar.REAL)


def test_numbers_keep_their_bits():
    for value in (0.1, 5e-324, 1e308, -0.0, math.pi):
        assert float(C99.real(value)) == value
