"""The checker's arithmetic of many sets at once, beside Arb, inference and sampled points."""

from __future__ import annotations

import operator
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from flint import arb

import fuzzyarm
from fuzzyarm.proof.check.bands import RuleBands
from fuzzyarm.proof.check.forms import Form, FormNumbers, combined
from fuzzyarm.proof.check.numbers import function
from fuzzyarm.proof.check.rules import RuleSurface, RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, applied
from fuzzyarm.proof.check.spans import Matrices, Spans


def drawn_spans(generator: np.random.Generator, count: int, scale: float) -> Spans:
    middle = scale * generator.standard_normal(count)
    half = np.abs(scale * generator.standard_normal(count))
    half *= generator.choice([0.0, 1e-9, 0.3], count)
    return Spans(middle - half, middle + half)


def within(generator: np.random.Generator, spans: Spans) -> list[Fraction]:
    share = generator.choice([0.0, 0.25, 1.0], spans.low.shape)
    values = np.clip(spans.low + share * (spans.high - spans.low), spans.low, spans.high)
    return [Fraction(float(x)) for x in values]


def demand_held(spans: Spans, values: list[Fraction]) -> None:
    for low, high, x in zip(spans.low, spans.high, values, strict=True):
        assert low <= x <= high


@pytest.mark.parametrize("how", [operator.add, operator.sub, operator.mul, operator.truediv])
def test_results_of_operations_hold_those_of_rationals(how) -> None:
    generator = np.random.default_rng(1)
    for scale in (1.0, 1e-8, 1e9):
        a, b = drawn_spans(generator, cases(100, 2000), scale), drawn_spans(generator, 100, 1.0)
        a = a[:100]
        if how is operator.truediv:
            b = Spans(b.abs_lower().low + 0.1, b.abs_upper().low + 0.2)
        x, y = within(generator, a), within(generator, b)
        demand_held(how(a, b), [how(p, q) for p, q in zip(x, y, strict=True)])


@pytest.mark.parametrize("name", ["sin", "cos", "sqrt", "exp", "tanh", "atan", "absolute"])
def test_functions_hold_the_values_of_arb(name: str) -> None:
    generator = np.random.default_rng(2)
    x = drawn_spans(generator, cases(200, 4000), 2.0)
    if name == "sqrt":
        x = x.abs_lower().union(x.abs_upper())
    found = function(name, x)
    for k, value in enumerate(within(generator, x)):
        ball = arb(value.numerator) / value.denominator
        exact = abs(ball) if name == "absolute" else getattr(ball, name)()
        assert arb(float(found.low[k])) <= exact.upper()
        assert exact.lower() <= arb(float(found.high[k]))
        room = 1e4 * (x.high[k] - x.low[k]) + 1e-11 * (1.0 + np.abs(found.high[k]))
        assert found.high[k] - found.low[k] <= room


def test_a_division_by_an_interval_around_zero_is_known_of_the_others() -> None:
    a = Spans(np.array([1.0, 1.0]), np.array([2.0, 2.0]))
    b = Spans(np.array([-1.0, 4.0]), np.array([5.0, 5.0]))
    for found in (a / b, applied("divide", [Slope(a, {}), Slope(b, {})]).value):
        assert np.isnan([found.low[0], found.high[0]]).all()
        assert found.low[1] == pytest.approx(0.2)
        assert found.high[1] == pytest.approx(0.5)
        assert found.low[1] < 0.2
        assert found.high[1] > 0.5


def test_ends_go_at_least_as_far_as_the_next_float() -> None:
    exponents = np.arange(-1074.0, 1024.0)
    x = np.concatenate([[0.0], 2.0**exponents, 1.9 * 2.0 ** exponents[:-1], (2.0**exponents) * 1.1])
    x = x[np.isfinite(x)]
    for ends in (x, -x):
        total = Spans(ends, ends) + 0.0
        assert (total.low <= np.nextafter(ends, -np.inf)).all()
        assert (total.high >= np.nextafter(ends, np.inf)).all()
        assert (total.high - ends <= 2.0**-51 * np.abs(ends) + 2e-300).all()


def test_products_of_matrices_hold_those_of_rationals() -> None:
    generator = np.random.default_rng(3)
    for _ in range(cases(5, 100)):
        a, b = ([[drawn_spans(generator, 7, 1.0) for _ in range(3)] for _ in range(3)]
                for _ in range(2))  # fmt: skip
        found = (Matrices.of(a) @ Matrices.of(b)).rows
        x, y = ([[within(generator, s) for s in row] for row in m] for m in (a, b))
        for i in range(3):
            for j in range(3):
                sums = [sum(x[i][k][s] * y[k][j][s] for k in range(3)) for s in range(7)]
                demand_held(found[i][j], sums)


def test_a_comparison_holds_of_all_or_not() -> None:
    a = Spans(np.array([0.0, 1.0]), np.array([0.5, 2.0]))
    assert a < 3
    assert not a < 1
    assert not a > 1
    assert a >= 0


# ── forms ────────────────────────────────────────────────────────────────────────────


def value_of(form: Form, symbols: np.ndarray, rest: float) -> Fraction:
    """Return the value of the first set, for values of its symbols and a share of its rest."""
    parts = zip(form.weights[:, 0].tolist(), symbols.tolist(), strict=False)
    total = sum((Fraction(w) * Fraction(s) for w, s in parts), Fraction(float(form.centre[0])))
    return total + Fraction(float(form.rest[0])) * Fraction(rest)


def test_forms_hold_what_they_are_made_of() -> None:
    """Of linear ones with the same symbols; of others at the same symbols but for new ones."""
    generator = np.random.default_rng(4)
    for _ in range(cases(60, 2000)):
        numbers = FormNumbers(RuleSurfaces())
        a, b = (
            Form(generator.standard_normal(1), generator.standard_normal((3, 1)),
                 np.abs(generator.standard_normal(1)) * generator.choice([0.0, 1e-9, 0.1]))
            for _ in range(2)
        )  # fmt: skip
        numbers.symbols = 3
        symbols = generator.choice([-1.0, 1.0, 0.3], 3)
        x, y = (value_of(form, symbols, generator.choice([-1.0, 1.0])) for form in (a, b))
        near = Fraction(float(generator.standard_normal()))
        made = {
            "sum": (combined((a, 1.0), (b, float(near))), x + near * y),
            "product": (numbers.apply("multiply", [a, b]), x * y),
            "larger": (numbers.apply("maximum", [a, b]), max(x, y)),
            "smaller": (numbers.apply("minimum", [a, b]), min(x, y)),
            "limited": (numbers.limit(a, -0.5, 0.7), min(max(x, Fraction(-0.5)), Fraction(0.7))),
        }
        for name, (form, expected) in made.items():
            middle = value_of(form, symbols, 0.0)
            new = sum(Fraction(float(w)) for w in np.abs(form.weights[3:, 0]))
            assert abs(expected - middle) <= new + Fraction(float(form.rest[0])), name
            assert form.span.low[0] <= expected <= form.span.high[0], name


def test_a_factor_that_is_not_known_widens_a_single_term() -> None:
    numbers = FormNumbers(RuleSurfaces())
    found = combined((numbers.at(2.0), Spans(0.5, 1.5))).span
    assert found.low <= 1.0
    assert found.high >= 3.0


def test_a_limit_beyond_another_one_has_its_own_end() -> None:
    """min(max(x, -10), -5) between -1 and 1 is -1."""
    numbers = FormNumbers(RuleSurfaces())
    x = numbers.limit(numbers.limit(numbers.at(0.0, 3.0), -10.0, -5.0), -1.0, 1.0)
    assert x.ends == (-1.0, -1.0)


def test_fewer_symbols_hold_as_much() -> None:
    generator = np.random.default_rng(5)
    numbers = FormNumbers(RuleSurfaces())
    numbers.sets, numbers.symbols = 4, 90
    forms = [
        Form(generator.standard_normal(4), generator.standard_normal((90, 4)), np.zeros(4))
        for _ in range(3)
    ]
    fewer = numbers.fewer(forms, 10)
    assert len(fewer[0].weights) <= 30
    for _ in range(50):
        way = generator.standard_normal(3)
        wide, wider = (
            np.abs(sum(w * form.weights for w, form in zip(way, row, strict=True))).sum(axis=0)
            for row in (forms, fewer)
        )
        assert (wide <= wider * (1.0 + 1e-12)).all()


# ── bands ────────────────────────────────────────────────────────────────────────────

PRODUCTS = """rulebase products
input e -1 .. 1
input d -2 .. 2
output u -1 .. 1
terms e: triangles N Z P
terms d: triangles N Z P
term u N: singleton -1
term u Z: singleton 0
term u P: singleton 0.7
inference and product, aggregation sum, defuzzifier weighted-average, outside {outside}
rule if e is N and d is N then u is N
rule if e is N and d is Z then u is N
rule if e is N and d is P then u is Z
rule if e is Z and d is N then u is N
rule if e is Z and d is Z then u is Z
rule if e is Z and d is P then u is P
rule if e is P and d is N then u is Z
rule if e is P and d is Z then u is P
rule if e is P and d is P then u is P
"""


@pytest.mark.parametrize("base", ["pd7.frb", "balance.frb", "products", "extended"])
@pytest.mark.parametrize("size", [0.5, 0.02, 1e-5])
def test_bands_hold_what_is_inferred(base: str, size: float, tmp_path: Path) -> None:
    """At corners of boxes and inside them; a box is not much further than it is wide."""
    if base.endswith(".frb"):
        rules = fuzzyarm.load_rulebase(fuzzyarm.shipped(base))
    else:
        path = tmp_path / "r.frb"
        path.write_text(PRODUCTS.format(outside="clamp" if base == "products" else "extend"))
        rules = fuzzyarm.load_rulebase(path)
    output = rules.outputs[0]
    bands = RuleBands(RuleSurface(rules, output.name))
    generator = np.random.default_rng(6)
    count = cases(200, 4000)
    low = np.array([v.low for v in rules.inputs])[:, None]
    high = np.array([v.high for v in rules.inputs])[:, None]
    if base == "extended":  # beyond its range there is no value, and a box at its end meets that
        low, high = 0.98 * low, 0.98 * high
    middle = generator.uniform(low, high, (len(low), count))
    half = size * (high - low) * generator.uniform(0.0, 0.5, middle.shape)
    first, last = np.clip(middle - half, low, high), np.clip(middle + half, low, high)
    slopes, least, most = bands.band([Spans(a, b) for a, b in zip(first, last, strict=True)])
    assert np.isfinite(least).all()
    seen = []
    for k in range(12):
        share = generator.random(middle.shape) if k > 6 else generator.integers(0, 2, middle.shape)
        at = np.clip(first + share * (last - first), first, last)
        inputs = {v.name: row for v, row in zip(rules.inputs, at, strict=True)}
        value = np.asarray(fuzzyarm.infer(rules, inputs)[output.name])
        seen.append(value - sum(s * row for s, row in zip(slopes, at, strict=True)))
        room = 1e-12 * (1.0 + np.abs(value))
        assert (seen[-1] >= least - room).all()
        assert (seen[-1] <= most + room).all()
    wide = np.ptp(seen, axis=0)
    assert np.median(most - least) <= 4.0 * np.median(wide) + 1e-6


def test_a_box_with_an_edge_or_without_a_value_has_no_band(tmp_path: Path) -> None:
    path = tmp_path / "r.frb"
    path.write_text(
        "rulebase r\ninput e -1 .. 1\noutput u -1 .. 1\n"
        "term e N: trapezoid -1 -1 -0.5 -0.5\nterm e P: trapezoid 0 0 1 2\n"
        "term u N: singleton -1\nterm u P: singleton 1\n"
        "inference u: defuzzifier weighted-average\n"
        "rule if e is N then u is N\nrule if e is P then u is P\n"
    )
    bands = RuleBands(RuleSurface(fuzzyarm.load_rulebase(path), "u"))
    low, high = np.array([-0.9, -0.6, -0.3, 0.5]), np.array([-0.7, -0.4, 0.2, 0.6])
    _, least, most = bands.band([Spans(low, high)])
    assert np.isfinite(least).tolist() == np.isfinite(most).tolist() == [True, False, False, True]
