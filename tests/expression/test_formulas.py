from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import array_function
from fuzzyarm.symbolic.formulas import (
    FRB,
    FUZZYLITE,
    JFUZZYLOGIC,
    FormulaError,
    read_formula,
    write_formula,
)
from fuzzyarm.symbolic.nodes import symbol
from fuzzyarm.symbolic.operations import OPERATIONS

VALUES = {"e": 1.5, "ce": -2.0, "the load": 3.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("2 ** 3", 8.0),
        ("-2 ^ 2", -4.0),
        ("2 ^ -1", 0.5),
        ("--e", 1.5),
        ("7 - 2 - 1", 4.0),
        ("12 / 3 / 2", 2.0),
        ("-7 % 3", -1.0),
        ("e * ce + 'the load'", 0.0),
        ("max(1, e, 0.5) + min(ce, 4)", -0.5),
        ("pow(2, 3) + atan2(0, 1) + fmod(7, 4)", 11.0),
        ("2e-3 + .5", 0.502),
        ("cos(pi)", -1.0),
        ("floor(e) + ceil(e) + round(ce) + abs(ce)", 3.0),
        ("log(exp(e)) + log10(100) + sqrt(4)", 5.5),
    ],
)
def test_values(text: str, value: float) -> None:
    assert read_formula(text).evaluate(VALUES) == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "position"),
    [
        ("", 0),
        ("1 +", 3),
        ("(1 + 2", 6),
        ("1 2", 2),
        ("sin()", 4),
        ("sin(1, 2)", 0),
        ("2 * nothere(1)", 4),
        ("neg(1)", 0),
        ("e ? 1", 2),
        ("__import__('os')", 0),
        ("e == 1", 2),
        ("(" * 5000 + "1", 100),
    ],
)
def test_mistakes_have_a_position(text: str, position: int) -> None:
    with pytest.raises(FormulaError) as caught:
        read_formula(text)
    assert caught.value.position == position


def test_names_once_in_order() -> None:
    assert read_formula("ce + e * ce - pi").names == ("ce", "e", "pi")


def test_a_name_without_a_value() -> None:
    with pytest.raises(FormulaError, match="unknown variable 'q'"):
        read_formula("q").evaluate(VALUES)


@given(st.text("0123456789.+-*/%^(), esincox'", max_size=30))
def test_any_text_is_a_tree_or_a_located_error(text: str) -> None:
    position = 0
    try:
        read_formula(text)
    except FormulaError as error:
        position = error.position
    assert 0 <= position <= len(text)


@pytest.mark.parametrize("name", sorted(n for n, o in OPERATIONS.items() if not o.is_condition))
def test_arrays_equal_numbers(name: str) -> None:
    arity, function = OPERATIONS[name].arity, OPERATIONS[name].scalar
    first = np.array([-800.0, -2.5, -1.0, -0.0, 0.0, 0.5, 1.0, 2.0, 800.0])
    arguments = np.array(np.meshgrid(*[first] * arity)).reshape(arity, -1)
    with np.errstate(all="ignore"):
        found = array_function(name)(*arguments)
    plain = [function(*column) for column in arguments.T.tolist()]
    np.testing.assert_allclose(found, plain, rtol=1e-13)


def test_division_by_zero_is_infinite_in_both() -> None:
    formula = read_formula("1 / (e - 1.5)")
    assert formula.evaluate(VALUES) == math.inf
    assert formula.evaluate_arrays({"e": np.array([1.5])})[0] == math.inf


@pytest.mark.parametrize("dialect", [FUZZYLITE, JFUZZYLOGIC], ids=lambda d: d.name)
@pytest.mark.parametrize(
    "text",
    ["2 ^ 3 ^ 2", "-(x ^ 2)", "a - (b - c)", "a / (b / c)", "(a % b) % c", "2 * (-x)", "~a + b"],
)
def test_what_is_written_reads_back(dialect, text):
    root = read_formula(text, dialect).root
    assert read_formula(write_formula(root, dialect), dialect).root is root


@pytest.mark.parametrize(
    "text",
    [
        "a + b - c", "a - (b + c)", "a - (b - c)", "a * b / c", "a / (b * c)", "a / (b / c)",
        "a * b + c / d", "(a + b) * (c - d)", "(a * b) ^ c", "a ^ (b * c)", "a * b ^ c",
        "(a ^ b) ^ c", "a * (b % c)", "(a % b) * c", "-(a + b)", "(-a) + b", "-sin(a)", "a + (-b)",
        "a / b / c", "a * b * c", "(a / b) ^ 2", "a + b * c", "(a + b) / c",
        "lt(a, b)", "eq(a, b)", "le(a, b)",
    ],
)  # fmt: skip
def test_parentheses_stand_where_they_are_needed_and_nowhere_else(text):
    assert write_formula(read_formula(text).root) == text


def test_a_choice_that_is_no_comparison_is_not_written_as_one():
    root = op.where(symbol("a") < symbol("b"), 1.0, 2.0)
    with pytest.raises(FormulaError, match="has no function for 'where'"):
        write_formula(root)
    with pytest.raises(FormulaError, match="jFuzzyLogic has no function for"):
        write_formula(read_formula("lt(a, b)").root, JFUZZYLOGIC)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sin(1, 2)", "'sin' takes one argument"),
        ("pow(1)", "'pow' takes 2 arguments"),
        ("1 + )", r"expected a number, a name or '\(' but found '\)'"),
    ],
)
def test_mistakes_in_words(text, message):
    with pytest.raises(FormulaError, match=message):
        read_formula(text)


def test_closing_parentheses_and_powers_give_their_depth_back():
    text = " + ".join(["((x)) ^ ((2))"] * 300)
    assert read_formula(text).evaluate({"x": 2.0}) == 1_200.0


def test_capitals_are_functions_where_the_program_has_them_so():
    assert read_formula("SIN(0) + 2", FUZZYLITE).evaluate({}) == 2.0
    assert read_formula("SIN(0) + 2", JFUZZYLOGIC).evaluate({}) == 2.0
    with pytest.raises(FormulaError, match="unknown function 'SIN'"):
        read_formula("SIN(0) + 2", FRB)
    with pytest.raises(FormulaError, match="unknown function 'lt'"):
        read_formula("lt(1, 2)", JFUZZYLOGIC)


def test_powers_go_from_the_left_in_jfuzzylogic():
    """Its grammar has ``a ^ b ^ c`` as a chain, evaluated in the order of the text."""
    assert read_formula("2 ^ 3 ^ 2", JFUZZYLOGIC).evaluate({}) == (2.0**3.0) ** 2.0
    assert read_formula("2 ^ 3 ^ 2", FUZZYLITE).evaluate({}) == 2.0 ** (3.0**2.0)
    assert read_formula("2 * 7 % 4", JFUZZYLOGIC).evaluate({}) == 2.0 * (7.0 % 4.0)
    assert read_formula("2 * 7 % 4", FUZZYLITE).evaluate({}) == (2.0 * 7.0) % 4.0


def test_comparisons_are_functions():
    formula = read_formula("lt(x, 0.3) + 10 * ge(x, 0.3)", FUZZYLITE)
    assert formula.evaluate({"x": 0.2}) == 1.0
    assert formula.evaluate({"x": 0.3}) == 10.0
    assert write_formula(formula.root) == "lt(x, 0.3) + 10 * le(0.3, x)"


def test_a_long_formula_is_no_deep_one():
    formula = read_formula(" + ".join(["x"] * 2_000))
    assert formula.evaluate({"x": 1.0}) == 2_000.0
