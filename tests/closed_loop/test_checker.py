"""The checker: its numbers against Arb, its pieces at points, and that it is not the search."""

import random
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check.certificate import Evidence
from fuzzyarm.proof.check.lines import LinearSignal, LinearSignals, number_line
from fuzzyarm.proof.check.loop import checked_loop
from fuzzyarm.proof.check.motion import flow_over
from fuzzyarm.proof.check.numbers import (
    ONE,
    around,
    between,
    ends,
    exact,
    is_positive_definite,
    precisely,
    radius,
    square,
)
from fuzzyarm.proof.check.region import verified
from fuzzyarm.proof.check.rules import RuleSurface
from fuzzyarm.proof.check.slopes import Slope, slopes_of
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import read_claim, write_certificate
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.map.sector import sector
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import symbol

flint = pytest.importorskip("flint")


# ── numbers ──────────────────────────────────────────────────────────────────────────


@precisely
def test_a_ball_holds_what_it_is_made_of():
    generator = random.Random(3)
    for _ in range(cases(50, 1000)):
        low, high = sorted(generator.uniform(-3, 3) for _ in range(2))
        x = between(exact(low), exact(high))
        assert ends(x)[0] <= Fraction(low) <= Fraction(high) <= ends(x)[1]
        assert ends(square(x))[0] >= -1e-7
        for at in (low, high, 0.5 * (low + high)):
            assert ends(square(x))[0] <= Fraction(at) ** 2 <= ends(square(x))[1]
        far = ends(around(exact(low), exact(0.1)))
        assert far[0] <= Fraction(low) - Fraction(0.1) <= Fraction(low) + Fraction(0.1) <= far[1]


@precisely
def test_a_matrix_of_balls_is_positive_where_all_in_it_are():
    """[[1, x], [x, 1]] is where |x| < 1."""
    for far, expected in ((0.99, True), (1.01, False)):
        x = around(exact(0), exact(far))
        assert is_positive_definite([[ONE, x], [x, ONE]]) == expected


@precisely
def test_slopes_are_those_of_difference_quotients():
    x, y = symbol("x"), symbol("y")
    root = op.sin(x) * y / (x * x + 2.0) + op.maximum(x, y) * op.exp(-y) - op.sqrt(y) + abs(x)
    generator = random.Random(4)
    for _ in range(cases(20, 500)):
        at = {"x": generator.uniform(-2, 2), "y": generator.uniform(0.1, 2)}
        far = generator.choice([0.0, 1e-3, 0.05])
        values = {
            name: Slope(between(exact(v - far), exact(v + far)), {name: ONE})
            for name, v in at.items()
        }
        (slope,) = slopes_of([root], values)

        for name, v in at.items():
            if abs(at["x"] - at["y"]) < 1e-5:
                continue
            both = [value_of(root, {**at, name: v + off}) for off in (1e-6, -1e-6)]
            quotient = (both[0] - both[1]) / 2e-6
            low, high = ends(slope.along[name])
            assert float(low) - 1e-6 <= quotient <= float(high) + 1e-6


def value_of(root, at):
    points = {name: Slope(exact(x), {}) for name, x in at.items()}
    return float(slopes_of([root], points)[0].value)


@precisely
def test_a_motion_is_the_matrix_exponential():
    from scipy.linalg import expm

    a = [[0.0, 1.0, 0.0], [0.0, -2.0, 35.0]]
    found = flow_over([[exact(x) for x in row] for row in a], exact(0.1))
    whole = expm(0.1 * np.array([*a, [0.0, 0.0, 0.0]]))
    for row, expected in zip(found, whole[:2], strict=True):
        for span, x in zip(row, expected, strict=True):
            assert float(ends(span)[0]) - 1e-12 <= x <= float(ends(span)[1]) + 1e-12
            assert radius(span) < 1e-15


@pytest.mark.parametrize("rate", [0.25, 1.0, 5.0])
@precisely
def test_what_is_left_of_the_series_of_a_motion_is_enclosed(rate):
    ((span,),) = flow_over([[exact(rate)]], exact(1))
    assert span.contains(flint.arb(rate).exp())


# ── signals around rest ──────────────────────────────────────────────────────────────


@pytest.fixture
def lines():
    return LinearSignals(Evidence({}, {}, (), (), Fraction(1), {}), None)


def moving(rest, weight, far):
    rest, weight, far = (exact(Fraction(x)) for x in (rest, weight, far))
    return LinearSignal(rest, {"z": weight}, rest - far, rest + far)


A, B = moving(1, 2, "0.5"), moving(-3, "0.25", 4)


@pytest.mark.parametrize(
    ("operation", "arguments", "value"),
    [
        ("add", (A, B), lambda a, b: a + b),
        ("subtract", (A, B), lambda a, b: a - b),
        ("negative", (B,), lambda a: -a),
        *(("multiply", (B, number_line(exact(by))), lambda a, b: a * b) for by in (0.5, -3)),
        *(("divide", (B, number_line(exact(by))), lambda a, b: a / b) for by in (4, -0.25)),
    ],
)
def test_a_linear_operation_of_signals_is_that_of_their_values(lines, operation, arguments, value):
    signal = lines.apply(operation, list(arguments))
    corners = [value(*at) for at in product(*((x.low, x.high) for x in arguments))]
    assert (signal.low, signal.high) == (min(corners), max(corners))
    at = [x.rest for x in arguments]
    assert signal.rest == value(*at)
    # Along z it is linear, so its weight is a difference of values.
    moved = [x + arguments[i].parts.get("z", 0) for i, x in enumerate(at)]
    assert signal.parts["z"] == value(*moved) - value(*at)


@pytest.mark.parametrize(("first", "second"), [(A, B), (B, A), (moving(-5, 1, 1), B)])
def test_a_choice_between_signals_is_that_at_rest_and_has_to_stay_so(lines, first, second):
    way = second.rest - first.rest
    assert lines.apply("less", [first, second]) is (way > 0)
    assert lines.apply("maximum", [first, second]) == (second if way > 0 else first)
    ((parts, room, _), _) = lines.bounds
    assert (parts["z"], room) == (second.parts["z"] - first.parts["z"], abs(way))


def test_a_table_is_between_its_least_and_its_largest_value(lines):
    rulebase = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    table = replace(fuzzyarm.compile_table(rulebase, "u"), mode="linear")
    inputs = {axis.name: number_line(exact(axis.levels[2])) for axis in table.axes}
    signal = lines.table(table, inputs)
    assert signal.rest == exact(float(table.values[2, 2]))
    assert (float(signal.low), float(signal.high)) == (table.values.min(), table.values.max())


# ── pieces ───────────────────────────────────────────────────────────────────────────


@pytest.fixture(scope="module")
def pd7():
    rulebase = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    whole = {v.name: (exact(v.low), exact(v.high)) for v in rulebase.inputs}
    return rulebase, RuleSurface(rulebase, "u"), whole


@pytest.mark.slow
def test_what_the_search_finds_of_a_rule_base_is_confirmed_and_no_more(pd7):
    rulebase, pieces, whole = pd7
    prover = Prover(rulebase, "u")
    ones = {"e": ONE, "ce": ONE}
    gains = sector(prover, {"e": Fraction(1), "ce": Fraction(1)})
    low, high = exact(gains.low), exact(gains.high)
    slack = (high - low) / 1000
    assert pieces.has_sector(whole, ones, low, high)
    assert not pieces.has_sector(whole, ones, low + slack, high)
    assert not pieces.has_sector(whole, ones, low, high - slack)
    half = {name: (exact(-0.25), exact(0.25)) for name in whole}
    slopes = prover.slope(dict.fromkeys(whole, (-0.25, 0.25)), "e")
    steep = exact(slopes.low), exact(slopes.high)
    assert pieces.has_slope(half, "e", *steep)
    assert not pieces.has_slope(half, "e", steep[0], steep[1] * exact(0.99))
    bounds = prover.value({})
    assert pieces.has_range(whole, exact(bounds.low), exact(bounds.high))
    assert not pieces.has_range(whole, exact(bounds.low), exact(bounds.high) * exact(0.99))


@pytest.mark.parametrize("name", ["pd7.frb", "balance.frb", "roompi.frb"])
@pytest.mark.parametrize("far", [0.002, 0.05])
@precisely
def test_values_and_slopes_hold_at_points(name, far):
    rulebase = fuzzyarm.load(fuzzyarm.shipped(name))
    (output,) = (output.name for output in rulebase.outputs)
    surface = RuleSurface(rulebase, output)
    generator = random.Random(5)

    def value_at(at):
        return fuzzyarm.infer(rulebase, **at)[output]

    for _ in range(cases(8, 200)):
        centre = {v.name: generator.uniform(0.9 * v.low, 0.9 * v.high) for v in rulebase.inputs}
        box = {n: between(exact(x - far), exact(x + far)) for n, x in centre.items()}
        value, slopes = surface.over(box, list(box))
        point, _ = surface.over({n: flint.arb(x) for n, x in centre.items()}, [])
        assert float(point) == pytest.approx(value_at(centre), abs=1e-11)
        assert radius(point) < 1e-12
        off = 1e-4
        for _ in range(6):
            at = {n: x + generator.uniform(-0.9, 0.9) * far for n, x in centre.items()}
            low, high = ends(value)
            assert float(low) - 1e-12 <= value_at(at) <= float(high) + 1e-12
            for n, slope in slopes.items():
                both = [value_at({**at, n: at[n] + way}) for way in (off, -off)]
                low, high = ends(slope)
                steep = (both[0] - both[1]) / (2 * off)
                assert float(low) - 1e-6 <= steep <= float(high) + 1e-6


# ── the rest of the tanks ────────────────────────────────────────────────────────────


@pytest.fixture(scope="module")
def tanks():
    text = fuzzyarm.load(fuzzyarm.shipped("tanks.frb"))
    return text, fuzzyarm.prove(text, "stable at level2 = 0.2", plant="tanks")


@pytest.mark.slow
def test_a_loop_whose_rest_is_a_root_is_proved(tanks):
    text, verdict = tanks
    assert verdict.proved, str(verdict)
    # k u = a √(2 g h) at rest, and all of u is the integral's.
    power = 1.8e-5 * np.sqrt(2 * 9.81 * 0.2) / 4.5e-6
    assert verdict.rest["tanks.i total"] == pytest.approx(power, abs=1e-8)
    assert verdict.rest["level1"] == pytest.approx(0.2, abs=1e-8)
    assert check_certificate(verdict.certificate, text).proved


@pytest.mark.slow
@pytest.mark.parametrize("change", ["moved", "narrow", "elsewhere"])
def test_a_rest_that_is_not_there_is_refused(tanks, change):
    text, verdict = tanks
    region = verdict.certificate.region
    rest = dict(region.evidence.rest)
    middle, radius = rest["tanks.i total"]
    rest["tanks.i total"] = {
        "moved": (middle + 3 * radius, radius),
        "narrow": (middle, Fraction(1, 10**30)),
        "elsewhere": (middle + 1, radius),
    }[change]
    damaged = replace(region, evidence=replace(region.evidence, rest=rest))
    claim = verdict.certificate.claim
    against, *_ = verified(problem_of(text, claim), claim, damaged)
    assert "rest" in against


# ── it is not the search ─────────────────────────────────────────────────────────────

CALL = """
from fuzzyarm.proof.check import check_certificate
checked = check_certificate(sys.argv[1])
assert checked.proved, checked
"""

COMMAND = """
from fuzzyarm.apps.cli.main import main
assert main(["prove", "--check", sys.argv[1], "--json"]) == 0
"""

SEARCH = ("fuzzyarm.proof.loop", "fuzzyarm.proof.map", "fuzzyarm.learning", "scipy")
"""What finds proofs; a checker that needs it is none."""

LOADED = f"""
print([name for name in sys.modules if name.startswith({SEARCH})], file=sys.stderr)
"""


@pytest.mark.slow
@pytest.mark.parametrize("way", [CALL, COMMAND], ids=["call", "command"])
def test_the_checker_loads_nothing_of_the_search(servo_verdict, tmp_path, way):
    path = str(tmp_path / "servo.json")
    write_certificate(servo_verdict.certificate, path)
    command = [sys.executable, "-c", "import sys" + way + LOADED, path]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert run.stderr.splitlines()[-1] == "[]"


@pytest.mark.slow
def test_the_checker_says_what_it_does_not_read(servo, servo_verdict):
    certificate = servo_verdict.certificate.region
    problem = problem_of(servo, read_claim("stable", "motor"))
    evidence = certificate.evidence
    for changed, words in (
        (replace(evidence, gains=()), "no claim about"),
        (replace(evidence, gains=evidence.gains * 2), "not there"),
        (replace(evidence, memory={"x": "state:shaft:voltage_excess"}), "other states"),
        (replace(evidence, rest={}), "other states"),
    ):
        with pytest.raises(LoopProofError, match=words):
            checked_loop(problem, certificate.states, changed)
