"""Functions in a plant's equations, as the checker encloses them, and bounds that a plant has."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.control.controllers import ControllerText
from fuzzyarm.language import parse
from fuzzyarm.plant import Plant, Port
from fuzzyarm.proof.check.numbers import (
    FUNCTIONS,
    ONE,
    SpanError,
    between,
    ends,
    exact,
    function,
    precisely,
    radius,
)
from fuzzyarm.proof.check.slopes import Slope, applied
from tests.budget import cases

OWN = {"absolute": abs, **{n: getattr(math, n) for n in FUNCTIONS if n != "absolute"}}
DOMAINS = {"sqrt": (0.01, 9.0), "log": (0.01, 9.0), "asin": (-0.99, 0.99), "acos": (-0.99, 0.99),
           "tan": (-1.5, 1.5)}  # fmt: skip


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
@precisely
def test_a_function_and_its_slope_hold_those_of_points(name):
    generator = np.random.default_rng(7)
    low, high = DOMAINS.get(name, (-4.0, 4.0))
    for _ in range(cases(20, 200)):
        a, b = sorted(generator.uniform(low, high, 2))
        x = Slope(between(exact(a), exact(b)), {"x": ONE})
        found = applied(name, [x])
        along = found.along["x"]
        for at in np.linspace(a, b, 9)[1:-1].tolist():
            value = OWN[name](at)
            slack = 1e-14 * (1.0 + abs(value))
            assert ends(found.value)[0] - slack <= value <= ends(found.value)[1] + slack
            step = 1e-6
            slope = (OWN[name](at + step) - OWN[name](at - step)) / (2.0 * step)
            slack = 1e-5 * (1.0 + abs(slope))
            assert ends(along)[0] - slack <= slope <= ends(along)[1] + slack
        # Of a point both are narrow.
        point = applied(name, [Slope(exact(a), {"x": ONE})])
        assert float(radius(point.value)) <= 2.0**-120
        assert float(radius(point.along["x"])) <= 2.0**-100


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
@precisely
def test_a_function_of_a_point_is_narrow(name):
    found = function(name, exact(0.375))
    assert float(radius(found)) <= 2.0**-140


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("log", 0.0, 1.0), ("sqrt", -1e-9, 1.0), ("asin", 0.5, 1.1), ("tan", 1.0, 2.0),
     ("exp", 0.0, 1e6), ("sinh", -1e6, 0.0)],
)  # fmt: skip
def test_where_a_function_has_no_value_or_bound_nothing_is_said(name, low, high):
    with pytest.raises(SpanError):
        function(name, between(exact(low), exact(high)))


@pytest.mark.parametrize("exponent", [2.0, 3.0, -1.0, 0.5, 1.5, -2.5])
def test_a_power_holds_those_of_points(exponent):
    x = Slope(between(exact(0.5), exact(1.5)), {"x": ONE})
    found = applied("power", [x, Slope(exact(exponent), {})])
    for at in np.linspace(0.5, 1.5, 11):
        assert ends(found.value)[0] - 1e-12 <= at**exponent <= ends(found.value)[1] + 1e-12
        slope = exponent * at ** (exponent - 1.0)
        assert ends(found.along["x"])[0] - 1e-12 <= slope <= ends(found.along["x"])[1] + 1e-12


LINE = """
controller line
period 5 ms
axis pendulum
  e  = error of angle
  ce = error of rate
  u  = e + ce * 0.5
  drive torque = u, within -5 .. 5
"""


class Pendulum(Plant):
    """θ'' = -θ'/2 + 8 u, which others pull."""

    inputs = {"torque": Port("N m", -10.0, 10.0)}
    outputs = {
        "angle": Port("rad", -2.0, 2.0, bound=10.0),
        "rate": Port("rad/s", -4.0, 4.0, rate_of="angle", bound=100.0),
    }
    states = {"angle": "rad", "rate": "rad/s"}
    longest_step = 0.01

    def derivative(self, t, x, u, p):
        return [x[1], -0.5 * x[1] + 8.0 * u[0]]


class OfMany(Pendulum):
    """Pulled by an arc tangent, a hyperbolic sine and a logarithm."""

    def derivative(self, t, x, u, p):
        pull = 0.7 * (math.atan(x[0]) + math.sinh(x[0]) + math.log(3.0 + x[0]) - math.log(3.0))
        return [x[1], pull - 0.5 * x[1] + 8.0 * u[0]]


class OfSine(Pendulum):
    """Pulled by a sine: its region would go beyond the bound of 10 rad."""

    def derivative(self, t, x, u, p):
        return [x[1], 2.0 * math.sin(x[0]) - 0.5 * x[1] + 8.0 * u[0]]


@pytest.mark.slow
@pytest.mark.parametrize("plant", [OfMany, OfSine])
def test_a_loop_with_a_function_is_proved_within_the_bounds_of_its_plant(tmp_path, plant):
    (tmp_path / "line.frb").write_text(LINE)
    controller = fuzzyarm.load_controller(tmp_path / "line.frb")
    verdict = fuzzyarm.prove(controller, "stable", plant=plant(), budget=40.0)
    assert verdict.proved, verdict.reason
    low, high = verdict.region["angle"]
    assert -10.0 <= low < -0.5
    assert 0.5 < high <= 10.0


class Open(Pendulum):
    """Its run never counts as diverged."""

    outputs = {
        "angle": Port("rad", -2.0, 2.0, bound=math.inf),
        "rate": Port("rad/s", -4.0, 4.0, rate_of="angle", bound=math.inf),
    }


@pytest.mark.slow
def test_a_loop_is_proved_whose_plant_leaves_the_bounds_of_its_outputs_open(tmp_path):
    (tmp_path / "line.frb").write_text(LINE)
    controller = fuzzyarm.load_controller(tmp_path / "line.frb")
    verdict = fuzzyarm.prove(controller, "stable", plant=Open(), budget=40.0)
    assert verdict.proved, verdict.reason


# ── ends of domains ──────────────────────────────────────────────────────────────────


class Leaking(Plant):
    """A level whose outflow has the factor 0; below 0.5 its root has no value."""

    inputs = {"u": Port("V", -50.0, 50.0)}
    outputs = {"y": Port("m", -10.0, 10.0)}
    states = {"y": "m"}
    parameters = {"flow": 0.0}
    duration = 2.0

    def derivative(self, t, x, u, p):
        return [u[0] + math.sqrt(x[0] - 0.5) * p[0]]


class Logging(Leaking):
    def derivative(self, t, x, u, p):
        return [u[0] + 0.0 * math.log(x[0] - 0.5)]


@pytest.mark.slow
@pytest.mark.parametrize("kind", [Leaking, Logging])
def test_a_factor_of_0_does_not_hide_the_end_of_a_domain(kind):
    controller = parse(
        "controller c\nperiod 10 ms\naxis a\n  e = error of y\n  drive u = e * 5\n"
    ).controller
    claim = "from y in 0.99 .. 1: y in -0.1 .. 1.1 during 0 .. 0.2 s"  # 0.5 is passed at 0.14 s
    verdict = fuzzyarm.prove(ControllerText(controller), claim, plant=kind(), budget=2)
    assert not verdict.proved, str(verdict)
    claim = "from y in 0.99 .. 1: y in 0.5 .. 1.1 during 0 .. 0.1 s"
    assert fuzzyarm.prove(ControllerText(controller), claim, plant=kind(), budget=20).proved


class Filling(Leaking):
    """y' = u."""

    parameters = {}

    def derivative(self, t, x, u, p):
        return [u[0]]


BACK = """
controller c
period 10 ms
axis a
  e = error of y
  i = integral of e, anti-windup back 0.59 s, start 0.12
  s = e * 0.5 + i * 0.86
  z = s where s < 0.24 else 0.1
  drive u = z, within -4 .. 4
"""


def test_a_choice_by_an_integral_without_limits_is_that_of_its_value():
    controller = ControllerText(parse(BACK).controller)
    for bounds, expected in (("0.2 .. 0.21", "proved"), ("0.09 .. 0.11", "refuted")):
        # By hand in the first period: 0.5 · 0.2 + 0.86 (0.12 + 0.2 · 0.01) = 0.20492 < 0.24.
        claim = f"from y in -0.2 .. -0.2: u in {bounds} during 0 .. 0.04 s"
        verdict = fuzzyarm.prove(controller, claim, plant=Filling())
        assert verdict.verdict == expected, str(verdict)
