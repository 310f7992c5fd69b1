"""The checker: its numbers against Arb, its pieces at points, and that it is not the search."""

import ast
import random
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import check_certificate, read_claim
from fuzzyarm.proof.loop.checked_lines import LinearSignal, LinearSignals, number_line
from fuzzyarm.proof.loop.checked_loop import checked_loop
from fuzzyarm.proof.loop.checked_motion import flow_over
from fuzzyarm.proof.loop.evidence import Evidence
from fuzzyarm.proof.loop.rule_pieces import RulePieces
from fuzzyarm.proof.loop.slopes import Slope, slopes_of
from fuzzyarm.proof.loop.spans import RationalInterval, exactly
from fuzzyarm.proof.loop.verification import verified
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.map.sector import sector
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import symbol

flint = pytest.importorskip("flint")


# ── numbers ──────────────────────────────────────────────────────────────────────────


def ball(x):
    return flint.fmpq(x.numerator, x.denominator)


def test_slopes_are_those_of_difference_quotients():
    x, y = symbol("x"), symbol("y")
    root = op.sin(x) * y / (x * x + 2.0) + op.maximum(x, y) * op.exp(-y) - op.sqrt(y) + abs(x)
    generator = random.Random(4)
    for _ in range(cases(20, 500)):
        at = {"x": generator.uniform(-2, 2), "y": generator.uniform(0.1, 2)}
        radius = generator.choice([0.0, 1e-3, 0.1])
        values = {
            name: Slope(
                RationalInterval(
                    Fraction(v) - Fraction(radius) / 2, Fraction(v) + Fraction(radius) / 2
                ),
                {name: exactly(1)},
            )
            for name, v in at.items()
        }
        (slope,) = slopes_of([root], values)

        for name, v in at.items():
            if abs(at["x"] - at["y"]) < 1e-5:
                continue
            ends = [value_of(root, {**at, name: v + off}) for off in (1e-6, -1e-6)]
            quotient = (ends[0] - ends[1]) / 2e-6
            assert float(slope.along[name].low) - 1e-6 <= quotient
            assert quotient <= float(slope.along[name].high) + 1e-6


def value_of(root, at):
    points = {name: Slope(exactly(x), {}) for name, x in at.items()}
    return float(slopes_of([root], points)[0].value.middle)


def test_a_motion_is_the_matrix_exponential():
    from scipy.linalg import expm

    a = [[0.0, 1.0, 0.0], [0.0, -2.0, 35.0]]
    found = flow_over([[exactly(x) for x in row] for row in a], exactly(0.1))
    whole = expm(0.1 * np.array([*a, [0.0, 0.0, 0.0]]))
    for row, expected in zip(found, whole[:2], strict=True):
        for span, x in zip(row, expected, strict=True):
            assert float(span.low) - 1e-12 <= x <= float(span.high) + 1e-12
            assert span.high - span.low < Fraction(1, 10**15)


@pytest.mark.parametrize("rate", [0.25, 1.0, 5.0])
def test_what_is_left_of_the_series_of_a_motion_is_enclosed(rate):
    ((span,),) = flow_over([[exactly(rate)]], exactly(1))
    with flint.ctx.workprec(300):
        value = flint.arb(rate).exp()
        assert flint.arb(ball(span.low)) < value < flint.arb(ball(span.high))


# ── signals around rest ──────────────────────────────────────────────────────────────


@pytest.fixture
def lines():
    return LinearSignals(Evidence({}, {}, (), (), Fraction(1), {}), None)


def moving(rest, weight, radius):
    rest, weight, radius = map(Fraction, (rest, weight, radius))
    return LinearSignal(exactly(rest), {"z": weight}, rest - radius, rest + radius)


A, B = moving(1, 2, "0.5"), moving(-3, "0.25", 4)


@pytest.mark.parametrize(
    ("operation", "arguments", "value"),
    [
        ("add", (A, B), lambda a, b: a + b),
        ("subtract", (A, B), lambda a, b: a - b),
        ("negative", (B,), lambda a: -a),
        *(("multiply", (B, number_line(exactly(by))), lambda a, b: a * b) for by in (0.5, -3)),
        *(("divide", (B, number_line(exactly(by))), lambda a, b: a / b) for by in (4, -0.25)),
    ],
)
def test_a_linear_operation_of_signals_is_that_of_their_values(lines, operation, arguments, value):
    signal = lines.apply(operation, list(arguments))
    corners = [value(*ends) for ends in product(*((x.low, x.high) for x in arguments))]
    assert (signal.low, signal.high) == (min(corners), max(corners))
    at = [x.rest.low for x in arguments]
    assert signal.rest.is_point
    assert signal.rest.low == value(*at)
    # Along z it is linear, so its weight is a difference of values.
    moved = [x + arguments[i].parts.get("z", 0) for i, x in enumerate(at)]
    assert signal.parts["z"] == value(*moved) - value(*at)


@pytest.mark.parametrize(("first", "second"), [(A, B), (B, A), (moving(-5, 1, 1), B)])
def test_a_choice_between_signals_is_that_at_rest_and_has_to_stay_so(lines, first, second):
    way = second.rest.low - first.rest.low
    assert lines.apply("less", [first, second]) is (way > 0)
    assert lines.apply("maximum", [first, second]) == (second if way > 0 else first)
    ((parts, room, _), _) = lines.bounds
    assert (parts["z"], room) == (second.parts["z"] - first.parts["z"], abs(way))


def test_a_table_is_between_its_least_and_its_largest_value(lines):
    rulebase = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    table = replace(fuzzyarm.compile_table(rulebase, "u"), mode="linear")
    inputs = {axis.name: number_line(exactly(axis.levels[2])) for axis in table.axes}
    signal = lines.table(table, inputs)
    assert signal.rest.low == signal.rest.high == Fraction(float(table.values[2, 2]))
    assert (signal.low, signal.high) == (table.values.min(), table.values.max())


# ── pieces ───────────────────────────────────────────────────────────────────────────


@pytest.fixture(scope="module")
def pd7():
    rulebase = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    whole = {v.name: (Fraction(v.low), Fraction(v.high)) for v in rulebase.inputs}
    return rulebase, RulePieces(rulebase, "u"), whole


@pytest.mark.slow
def test_what_the_search_finds_of_a_rule_base_is_confirmed_and_no_more(pd7):
    rulebase, pieces, whole = pd7
    prover = Prover(rulebase, "u")
    ones = {"e": Fraction(1), "ce": Fraction(1)}
    gains = sector(prover, ones)
    low, high = Fraction(gains.low), Fraction(gains.high)
    slack = (high - low) / 1000
    assert pieces.has_sector(whole, ones, low, high)
    assert not pieces.has_sector(whole, ones, low + slack, high)
    assert not pieces.has_sector(whole, ones, low, high - slack)
    half = {name: (Fraction(-1, 4), Fraction(1, 4)) for name in whole}
    slopes = prover.slope(dict.fromkeys(whole, (-0.25, 0.25)), "e")
    steep = Fraction(slopes.low), Fraction(slopes.high)
    assert pieces.has_slope(half, "e", *steep)
    assert not pieces.has_slope(half, "e", steep[0], steep[1] * Fraction(99, 100))
    bounds = prover.value({})
    assert pieces.has_range(whole, Fraction(bounds.low), Fraction(bounds.high))
    assert not pieces.has_range(whole, Fraction(bounds.low), Fraction(bounds.high) * Fraction(0.99))


def test_values_and_slopes_hold_at_points(pd7):
    rulebase, pieces, _ = pd7
    generator = random.Random(5)
    for _ in range(cases(8, 200)):
        at = {name: generator.uniform(-0.99, 0.99) for name in ("e", "ce")}
        around = {
            n: (Fraction(x) - Fraction(1, 200), Fraction(x) + Fraction(1, 200))
            for n, x in at.items()
        }
        value, slope = pieces.value(around), pieces.slope(around, "e")
        assert value.low <= Fraction(float(fuzzyarm.infer(rulebase, **at)["u"])) <= value.high
        off = 1e-4
        ends = [fuzzyarm.infer(rulebase, e=at["e"] + way, ce=at["ce"])["u"] for way in (off, -off)]
        assert (
            float(slope.low) - 1e-6 <= (ends[0] - ends[1]) / (2 * off) <= float(slope.high) + 1e-6
        )


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
    evidence = verdict.certificate.evidence
    rest = dict(evidence.rest)
    middle, radius = rest["tanks.i total"]
    rest["tanks.i total"] = {
        "moved": (middle + 3 * radius, radius),
        "narrow": (middle, Fraction(1, 10**30)),
        "elsewhere": (middle + 1, radius),
    }[change]
    damaged = replace(verdict.certificate, evidence=replace(evidence, rest=rest))
    against, *_ = verified(problem_of(text, damaged.claim), damaged)
    assert "rest" in against


# ── it is not the search ─────────────────────────────────────────────────────────────

SEARCH = {
    "affine", "conclusions", "enclosure", "form", "form_maker", "linear", "lmi", "outward",
    "resting", "sampled_plant", "search", "linear_flow", "tube", "tube_maker", "timed",
    "zonotope", "readings", "flow", "follower", "planes", "period",
}  # fmt: skip
CHECKER = {
    "checker", "checked_loop", "checked_lines", "checked_motion", "program_walk", "rule_pieces",
    "slopes", "spans", "evidence", "tube_checker",
}  # fmt: skip
NOT_READ = {
    "fuzzyarm.proof.map.prover", "fuzzyarm.proof.map.sector", "fuzzyarm.control.controllers.period",
    "fuzzyarm.exchange.export.steps",
}  # fmt: skip
FROM_THE_PROBLEM = {"LoopProblem", "LoopProofError"}


def test_the_checker_imports_nothing_of_the_search():
    folder = Path(fuzzyarm.__file__).parent / "proof" / "loop"
    for name in CHECKER:
        tree = ast.parse((folder / f"{name}.py").read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            module = node.module if isinstance(node, ast.ImportFrom) else ""
            if not module or not module.startswith("fuzzyarm"):
                continue
            last = module.rsplit(".", 1)[-1]
            if module.startswith("fuzzyarm.proof.loop"):
                assert last not in SEARCH, (name, module)
            if last == "problem":
                assert {alias.name for alias in node.names} <= FROM_THE_PROBLEM, name
            assert module not in NOT_READ, name
            assert module != "fuzzyarm.symbolic.evaluation", name


@pytest.mark.slow
def test_the_checker_says_what_it_does_not_read():
    text = fuzzyarm.load(fuzzyarm.shipped("servo.frb"))
    certificate = fuzzyarm.prove(text, "stable", plant="motor").certificate
    problem = problem_of(text, read_claim("stable", "motor"))
    evidence = certificate.evidence
    for changed, words in (
        (replace(evidence, gains=()), "no claim about"),
        (replace(evidence, gains=evidence.gains * 2), "not there"),
        (replace(evidence, memory={"x": "state:shaft:voltage_excess"}), "other states"),
        (replace(evidence, rest={}), "other states"),
    ):
        with pytest.raises(LoopProofError, match=words):
            checked_loop(problem, certificate.states, changed)
