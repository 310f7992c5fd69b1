"""Beyond the range of an input: what is taken as it is there, and what has no value."""

from __future__ import annotations

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.plant import Plant, Port
from fuzzyarm.proof.check.numbers import between, ends, exact, magnitude
from fuzzyarm.proof.check.rules import RuleSurface, RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, SlopeNumbers
from fuzzyarm.proof.claim.problem import LoopProofError, loop_problem
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.planes import RulePlanes, Zonotope
from fuzzyarm.proof.loop.tube import tube

TERMS = "terms e: triangles N Z P\n"
FAR = (
    "term e N: trapezoid -50 -49 -1 0\nterm e Z: triangle -1 0 1\n"
    "term e P: triangle 0 1 1.5\nterm e F: trapezoid 1 1.5 49 50\n"
)
BODY = """
rulebase rb
input e -1 .. 1
output u {output}
{terms}term u N: singleton -1
term u Z: singleton 0
term u P: singleton 1
inference u: defuzzifier weighted-average{more}
{e}
rule if e is N then u is N
rule if e is Z then u is Z
rule if e is P then u is P
{last}
"""
LOOP = """
controller c
use rb from "rb.frb"
period 10 ms
axis a
  e = error of y
  u = rules rb(e)
  drive u = u
"""


class Integrator(Plant):
    """y' = u."""

    inputs = {"u": Port("V", -5.0, 5.0)}
    outputs = {"y": Port("m", -10.0, 10.0)}
    states = {"y": "m"}
    duration = 1.0

    def derivative(self, t, x, u, p):
        return [u[0]]


class Lag(Integrator):
    """y' = u - y."""

    def derivative(self, t, x, u, p):
        return [u[0] - x[0]]


def text_of(terms=TERMS, e="", more="", output="-1 .. 1", last="") -> str:
    return BODY.format(terms=terms, e=e, more=more, output=output, last=last)


FAR_TEXT = text_of(FAR, "inference e: outside extend", last="rule if e is F then u is N")
# With nothing beyond ±2, as `convert` reads a .fis.
SMALL = "term e N: triangle -2 -1 0\nterm e Z: triangle -1 0 1\nterm e P: triangle 0 1 2\n"


def rulebase_of(text: str):
    parsed = fuzzyarm.parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    return parsed.rulebase


@pytest.fixture
def loop(tmp_path):
    """Return the loop of a rule base, a plant and starts of y."""

    def of(text: str):
        (tmp_path / "rb.frb").write_text(text)
        (tmp_path / "c.frb").write_text(LOOP)
        return fuzzyarm.load_controller(tmp_path / "c.frb")

    return of


def far_value(e):
    """Return the value of `FAR` in closed form: -1, a line up to (1, 1), a line down to -1."""
    return np.interp(e, [-49.0, -1.0, 0.0, 1.0, 1.5, 49.0], [-1.0, -1.0, 0.0, 1.0, -1.0, -1.0])


def own_run(value, y: float, seconds: float) -> list[float]:
    """Return the samples of y' = u(-y), u held over 10 ms."""
    course = [y]
    for _ in range(round(seconds / 0.01)):
        course.append(course[-1] + 0.01 * float(value(-course[-1])))
    return course


# ── inputs that are taken as they are ────────────────────────────────────────────────


def test_a_plane_holds_the_values_beyond_a_range():
    planes = RulePlanes(rulebase_of(FAR_TEXT), "u")
    generator = np.random.default_rng(1)
    for _ in range(40):
        centre, radius = generator.uniform(-40, 40), generator.uniform(0.01, 3)
        band = planes.band(Zonotope(np.array([centre]), np.array([[radius]])))
        e = np.linspace(centre - radius, centre + radius, 101)
        gaps = far_value(e) - band.slopes[0] * e
        assert band.low <= gaps.min() + 1e-12
        assert gaps.max() - 1e-12 <= band.high
    # Where the value is constant, so is the plane.
    band = planes.band(Zonotope(np.array([20.0]), np.array([[1.0]])))
    assert np.isclose(band.low, -1.0, atol=1e-6)
    assert np.isclose(band.high, -1.0, atol=1e-6)


def test_the_checker_cuts_beyond_a_range_too():
    surface = RuleSurface(rulebase_of(FAR_TEXT), "u")
    region = {"e": (exact(1.25), exact(1.375))}
    low, high = ends(surface.value(region))
    assert low <= far_value(1.375) + 1e-12
    assert float(high) == pytest.approx(far_value(1.25), abs=1e-8)
    assert surface.has_slope(region, "e", exact(-4), exact(-4))
    value, slopes = surface.over({"e": between(*region["e"])}, ["e"])
    assert ends(value) == pytest.approx((float(low), float(high)), abs=1e-6)
    assert slopes["e"] == -4
    clamped = RuleSurface(rulebase_of(text_of()), "u")
    with pytest.raises(LoopProofError, match="leaves its universe"):
        clamped.value(region)


@pytest.mark.parametrize("start", [(-1.9, -1.8), (-1.3, -1.2), (-0.9, 0.4)])
def test_a_tube_beyond_a_range_holds_all_runs(loop, start):
    problem = loop_problem(loop(FAR_TEXT), Integrator(), start={"y": start})
    found = tube(problem, 0.3)
    assert found.complete
    for y in np.linspace(*start, 7):
        for k, value in enumerate(own_run(far_value, float(y), 0.3)):
            low, high = found.bounds("y", 0.01 * k, 0.01 * k)
            assert low - 1e-9 <= value <= high + 1e-9


@pytest.mark.slow
def test_what_diverges_beyond_a_range_is_not_proved_stable(loop):
    assert own_run(far_value, -1.9, 3.0)[-1] < -4.8
    claim = "stable from y in -3 .. -0.5"
    found = fuzzyarm.prove(loop(FAR_TEXT), claim, plant=Integrator(), budget=0.5)
    assert not found.proved
    # The part that comes to rest still is.
    near = fuzzyarm.prove(loop(FAR_TEXT), "stable from y in -1.1 .. -0.5", plant=Integrator())
    assert near.proved


@pytest.mark.slow
def test_beyond_the_last_term_the_value_for_no_rule_counts(loop):
    text = text_of(SMALL, "inference e: outside extend", ", no-rule 0")
    problem = loop_problem(loop(text), Integrator(), start={"y": (-2.6, -2.4)})
    found = tube(problem, 0.2)
    low, high = found.bounds("y", 0.2, 0.2)
    assert low <= -2.6
    assert high >= -2.4
    assert high < -2.3
    claim = "stable from y in -3 .. -0.5"
    assert not fuzzyarm.prove(loop(text), claim, plant=Integrator(), budget=0.5).proved


def test_without_a_value_for_no_rule_nothing_is_said_beyond_the_last_term(loop):
    planes = RulePlanes(rulebase_of(text_of(SMALL, "inference e: outside extend")), "u")
    planes.band(Zonotope(np.array([1.5]), np.array([[0.4]])))
    with pytest.raises(EnclosureError, match="no rule of 'u' fires"):
        planes.band(Zonotope(np.array([2.0]), np.array([[0.4]])))


# ── inputs and outputs without a value ───────────────────────────────────────────────


@pytest.mark.slow
@pytest.mark.parametrize("claim", ["stable from y in 1.2 .. 1.5", "stable from y in 0.9 .. 1.2"])
def test_a_start_without_a_value_is_not_proved(loop, claim):
    # Periods are skipped there, and the drive stays: the run does not end, and nothing encloses it.
    text = text_of(e="inference e: outside error")
    assert fuzzyarm.prove(loop(text), claim, plant=Lag(), budget=0.5).verdict == "undecided"
    clamped = fuzzyarm.prove(loop(text_of()), claim, plant=Lag())
    assert clamped.proved
    within = fuzzyarm.prove(loop(text), "stable from y in -0.9 .. 0.9", plant=Lag())
    assert within.proved


@pytest.mark.slow
def test_a_tube_ends_where_an_input_has_no_value(loop):
    controller = loop(text_of(e="inference e: outside error"))
    found = tube(loop_problem(controller, Lag(), start={"y": (0.9, 1.0005)}), 0.1, most=1)
    assert not found.complete
    assert "where there is no value" in found.reason
    found = tube(loop_problem(controller, Lag(), start={"y": (1.2, 1.5)}), 0.1, most=64)
    assert not found.complete
    assert "where there is no value" in found.reason


@pytest.mark.slow
def test_a_tube_ends_where_an_output_has_no_value(loop):
    controller = loop(text_of(more=", outside error", output="-0.5 .. 0.5"))
    claim = "from y in 0.7 .. 0.8: y in -3 .. 3 during 0 .. 100 ms"
    verdict = fuzzyarm.prove(controller, f"on lag {claim}", plant=Lag(), budget=0.5)
    assert verdict.verdict == "undecided"
    found = tube(loop_problem(controller, Lag(), start={"y": (0.7, 0.8)}), 0.1, most=64)
    assert not found.complete
    assert "where there is no value" in found.reason
    assert tube(loop_problem(controller, Lag(), start={"y": (0.2, 0.4)}), 0.1).complete


def test_the_checker_has_no_value_in_a_hole_between_corners():
    """q = e - e² is 0 at both ends of 0 .. 1, and 0.25 between them."""
    rulebase = rulebase_of(
        "rulebase rbq\ninput q -1 .. 0.249999\noutput u -1 .. 1\nterm q N: ramp 0 -1\n"
        "term q P: ramp -1 0\nterm u N: singleton -0.1\nterm u P: singleton 0.1\n"
        "inference u: defuzzifier weighted-average\ninference q: outside error\n"
        "rule if q is N then u is N\nrule if q is P then u is P\n"
    )
    numbers = SlopeNumbers(RuleSurfaces())
    whole = between(exact(-1), exact(0.25))
    with pytest.raises(LoopProofError, match="there is no value"):
        numbers.rules(rulebase, "u", {"q": Slope(whole, {})})
    within = between(exact(-0.9375), exact(0.1875))
    assert magnitude(numbers.rules(rulebase, "u", {"q": Slope(within, {})}).value) < 1


def test_a_sum_without_a_rule_has_no_value_for_the_checker():
    text = text_of(SMALL, "inference e: outside extend").replace("weighted-average", "weighted-sum")
    surface = RuleSurface(rulebase_of(text), "u")
    assert ends(surface.value({"e": (exact(0), exact(1))}))[1] >= 1
    for low, high in ((1, 3), (-3, -2)):
        with pytest.raises(LoopProofError, match="may have no value"):
            surface.value({"e": (exact(low), exact(high))})
