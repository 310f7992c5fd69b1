"""The functions of T1TSK, and its centres: what pyit2fls computes, or a finding where not."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pyit2fls
import pytest

from fuzzyarm.exchange.live.gather import _noting
from fuzzyarm.exchange.live.objects import read_object
from fuzzyarm.exchange.live.python_formulas import function_shape
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.symbolic.formulas import read_formula

DOMAIN = np.linspace(0.0, 100.0, 101)
LOW = pyit2fls.T1FS(DOMAIN, pyit2fls.tri_mf, [-1.0, 0.0, 100.0, 1.0])
HIGH = pyit2fls.T1FS(DOMAIN, pyit2fls.tri_mf, [0.0, 100.0, 101.0, 1.0])


def plane(*functions: Callable[..., float]) -> Any:
    """Return a system of two inputs with a function for low and one for high."""
    system = pyit2fls.T1TSK()
    for name in "ab":
        system.add_input_variable(name)
    system.add_output_variable("u")
    for used, function in zip((LOW, HIGH), functions, strict=False):
        system.add_rule([("a", used), ("b", used)], [("u", function)])
    return system


def evaluated(system: Any, inputs: dict[str, float], params: tuple[float, ...]) -> Any:
    """Note an evaluation as a script does that is gathered."""
    _noting(type(system).evaluate)(system, inputs, params)
    return system


@pytest.mark.parametrize(
    "function",
    [
        lambda a, b: min(a, 20.0) + b,
        lambda a, b: abs(a - 60.0) + b,
        lambda a, b: max(3 * a - b, -50),
    ],
)
def test_a_kink_anywhere_in_the_ranges_is_carried(function: Callable[..., float]) -> None:
    system = evaluated(plane(function, lambda a, b: a + b), {"a": 1.0, "b": 2.0}, (1.0, 2.0))
    imported = read_object(system, "s")
    assert {d.name for d in imported.diagnostics} == {"estimated-range"}
    for a, b in ((50.0, 50.0), (5.0, 10.0), (70.0, 3.0), (99.0, 98.0)):
        theirs = system.evaluate({"a": a, "b": b}, (a, b))["u"]
        assert imported.rulebase(a=a, b=b)["u"] == pytest.approx(theirs, rel=1e-12)


def test_a_function_of_many_lines_with_a_kink_is_refused() -> None:
    def bent(a: float, b: float) -> float:
        if a > 63.0:
            return 63.0 + b
        return a + b

    imported = read_object(evaluated(plane(bent), {"a": 1.0, "b": 2.0}, (1.0, 2.0)), "s")
    assert [d.name for d in imported.errors] == ["bad-formula"]


def test_a_sum_of_many_lines_is_linear() -> None:
    factor = 3.0

    def long(a: float, b: float) -> float:
        total = factor * a
        total -= 2.0 * b
        return total + 1.0

    assert function_shape(long, ["a", "b"], [(0, 100)] * 2).parameters == (3.0, -2.0, 1.0)


def test_functions_of_one_line_are_told_apart() -> None:
    pair = [lambda a, b: a * b, lambda a, b: a * a]
    nested = lambda a, b: (lambda c: c * c)(a) * b  # noqa: E731, PLC3002
    assert [function_shape(f, ["a", "b"]).formula for f in pair] == ["a * b", "a * a"]
    assert function_shape(lambda p, q: q * q / (1 + p * p), ["q", "p"]).formula
    with pytest.raises(ValueError, match="'c' is not one of its parameters"):
        function_shape(nested, ["a", "b"])


b = 5.0


def test_a_free_name_is_not_an_input() -> None:
    a = 4.0
    with pytest.raises(ValueError, match="'b' is not one of its parameters"):
        function_shape(lambda p, q: p * p * b + q, ["a", "b"])
    with pytest.raises(ValueError, match="'a' is not one of its parameters"):
        function_shape(lambda p, q: p * p * a + q, ["a", "b"])


def test_a_text_that_says_something_else_is_refused() -> None:
    def max(one: float, other: float) -> float:  # noqa: A001
        return one * other

    with pytest.raises(ValueError, match="does not say what it computes"):
        function_shape(lambda p, q: max(p, q), ["a", "b"])  # noqa: PLW0108


def test_text_of_several_lines_and_words_in_other_alphabets() -> None:
    # fmt: off
    pair = ("ä", lambda p, q: (p
                               + q) * p, lambda p, q: p - q * q)
    # fmt: on
    assert [function_shape(f, ["a", "b"]).formula for f in pair[1:]] == ["(a + b) * a", "a - b * b"]


def test_the_order_of_arguments_is_told_where_it_was_guessed() -> None:
    swapped = lambda b, a: 3.0 * b + a  # noqa: E731
    system = evaluated(plane(swapped), {"a": 1, "b": 1}, (1, 1))
    imported = read_object(system, "s")
    assert "b, a is assumed" in next(
        d.message for d in imported.diagnostics if d.name == "assumed-order"
    )
    assert imported.rulebase(a=50.0, b=40.0)["u"] == pytest.approx(170.0)
    never = read_object(plane(lambda p, q: 3.0 * p + q), "s")
    assert "a, b is assumed" in next(
        d.message for d in never.diagnostics if d.name == "assumed-order"
    )


def test_the_first_evaluation_that_tells_the_order_counts() -> None:
    system = plane(lambda p, q: 3.0 * p + q)
    for inputs, params in (((1, 1), (1, 1)), ((50.0, 40.0), (40.0, 50.0)), ((2, 2), (2, 2))):
        evaluated(system, dict(zip("ab", inputs, strict=True)), params)
    imported = read_object(system, "s")
    assert "assumed-order" not in {d.name for d in imported.diagnostics}
    assert imported.rulebase(a=50.0, b=40.0)["u"] == pytest.approx(170.0)


def test_an_argument_that_is_not_an_input_is_refused() -> None:
    system = evaluated(plane(lambda p: 3.0 * p), {"a": 50.0, "b": 40.0}, (90.0,))
    assert "(90.0) is not the value of an input" in read_object(system, "s").errors[0].message


def test_every_output_is_divided_by_the_sum_of_all_rules() -> None:
    system = pyit2fls.T1TSK()
    system.add_input_variable("a")
    for name in "uv":
        system.add_output_variable(name)
    system.add_rule([("a", LOW)], [("u", lambda a: 1.0)])
    system.add_rule([("a", HIGH)], [("v", lambda a: a * a)])
    rulebase = read_object(system, "s").rulebase
    for a in (3.0, 40.0, 95.0):
        assert rulebase(a=a) == pytest.approx(system.evaluate({"a": a}, (a,)), rel=1e-12)


def test_centres_without_a_value_are_told() -> None:
    system = pyit2fls.T1Mamdani("Product", "CoA")
    system.add_input_variable("a")
    system.add_output_variable("u")
    for corners in ([0.0, 20.0, 40.0, 1.0], [60.0, 80.0, 100.0, 1.0]):
        used = pyit2fls.T1FS(DOMAIN, pyit2fls.tri_mf, corners)
        system.add_rule([("a", used)], [("u", used)])
    with np.errstate(invalid="ignore"):
        assert math.isnan(system.evaluate({"a": 30.0})["u"])
    messages = [d.message for d in read_object(system, "s").diagnostics if d.name == "no-rule"]
    assert messages
    assert "no value by centres" in messages[0]


def test_formulas_are_read_back() -> None:
    shape = function_shape(lambda x, y: (x + y) ** 2 / 7 - abs(x), ["x", "y"])
    assert read_formula(shape.formula).function(["x", "y"])(3.0, 4.0) == pytest.approx(4.0)


def test_a_function_that_is_another_at_one_of_its_numbers_is_not_linear() -> None:
    def jumps(x: float) -> float:
        if x == 33.25:
            return 7.0
        return 2.0 * x + 1.0

    def goes_on(x: float) -> float:
        if x == 33.25:
            return 67.5
        return 2.0 * x + 1.0

    with pytest.raises(ValueError, match=r"."):
        function_shape(jumps, ["x"], [(0.0, 100.0)])
    assert function_shape(goes_on, ["x"], [(0.0, 100.0)]) == Shape("linear", (2.0, 1.0))
