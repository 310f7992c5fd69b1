"""Nothing that happens lies outside a proved bound, and nothing false is called proved."""

from __future__ import annotations

import dataclasses
import math
import random
from collections.abc import Callable
from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzzyarm
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.positions import half_of, nearest_half_of
from fuzzyarm.inference.type_reduction_kernel import end_of_average
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import Defuzzifier, RuleBase
from fuzzyarm.proof.map import Prover, UnprovableError, prove
from fuzzyarm.proof.map.arithmetic import FLOATS, as_fraction, rationals
from fuzzyarm.proof.map.bernstein import Quotients, from_values, halving, lattice
from fuzzyarm.proof.map.centroid_bounds import (
    average_bounds,
    centroid_bounds,
    ends_of_average_bounds,
    ends_of_centroid_bounds,
)
from fuzzyarm.proof.map.pieces import Cut, cut
from fuzzyarm.proof.map.position_bounds import (
    bisector_bounds,
    halving_bounds,
    nearest_half_bounds,
)
from fuzzyarm.proof.map.search import QuotientProblem
from fuzzyarm.proof.map.straight import NotStraightError, straight
from fuzzyarm.proof.map.surface import Surface
from fuzzyarm.proof.stop import Stop
from tests import strategies
from tests.fuzz import random_proofs
from tests.fuzz.random_proofs import OTHERS, Told, irregular, judged, points

PD7 = fuzzyarm.shipped("pd7.frb").read_text()


def test_a_million_points_of_pd7_are_inside() -> None:
    pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    bounds = Prover(pd7, "u").value({})
    inputs = points(pd7, random.Random(0), 1_000_000)
    values = np.asarray(fuzzyarm.infer(pd7, inputs)["u"])
    assert bounds.low <= values.min()
    assert values.max() <= bounds.high


@pytest.mark.parametrize("seed", range(cases(8, 24)))
def test_random_rule_bases_stay_inside(seed: int) -> None:
    """Bounds, slopes, tables, sectors and planted falsehoods, on one input."""
    draw = random.Random(seed)
    judged(irregular(draw, 1), draw, Told(), 3_000)


@pytest.mark.slow
@pytest.mark.parametrize("way", OTHERS)
def test_random_rule_bases_of_other_defuzzifiers_stay_inside(
    way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(random_proofs, "SECONDS", 0.1 * cases(1, 3))
    for seed in range(cases(2, 20)):
        draw = random.Random(f"{way} {seed}")
        judged(irregular(draw, 1 + seed % 2, way), draw, Told(), 1_000)


@pytest.mark.parametrize("seed", range(cases(6, 12)))
def test_bounds_over_two_inputs_are_tight(seed: int) -> None:
    draw = random.Random(seed)
    rulebase = irregular(draw)
    bounds = Prover(rulebase, "u").value({})
    values = np.asarray(fuzzyarm.infer(rulebase, points(rulebase, draw, 5_000))["u"])
    assert bounds.low - 1e-11 <= values.min()
    assert values.max() <= bounds.high + 1e-11
    assert bounds.complete
    assert bounds.high - bounds.reached_high < 1e-6


@pytest.mark.slow
@given(strategies.rulebases(), st.integers(0, 10**6))
@settings(max_examples=12, deadline=None)
def test_rule_bases_of_any_kind_stay_inside_or_are_refused(rulebase: RuleBase, seed: int) -> None:
    name = rulebase.outputs[0].name
    silent = dataclasses.replace(
        rulebase,
        outputs=tuple(dataclasses.replace(each, no_rule=each.low) for each in rulebase.outputs),
    )
    draw = np.random.default_rng(seed)
    inputs = {each.name: draw.uniform(each.low, each.high, 60) for each in rulebase.inputs}
    try:
        bounds = Prover(silent, name, tolerance=1e-2, stop=Stop(0.2)).value({})
        values = np.asarray(fuzzyarm.infer(silent, inputs)[name], dtype=float)
    except (UnprovableError, InferenceError, TimeoutError):
        return
    slack = 1e-9 * (1.0 + abs(bounds.low) + abs(bounds.high))
    finite = values[np.isfinite(values)]
    assert bounds.low - slack <= finite.min(initial=math.inf)
    assert finite.max(initial=-math.inf) <= bounds.high + slack


def of_opposites(prover: Prover) -> QuotientProblem:
    ((low, high),) = prover.box({})
    size = min(-low, high)
    return QuotientProblem(((-size, size),), Surface.odd, mirrored=True)


def of_another(prover: Prover) -> QuotientProblem:
    (block,) = prover.rulebase.blocks
    first = dataclasses.replace(block.rules[0], weight=0.4)
    block = dataclasses.replace(block, rules=(first, *block.rules[1:]))
    second = Prover(dataclasses.replace(prover.rulebase, blocks=(block,)), "u").model
    assert second is not None
    return QuotientProblem(prover.box({}), lambda s: s.apart(second), other=second)


def of_a_table(prover: Prover) -> QuotientProblem:
    table = fuzzyarm.compile_table(prover.rulebase, levels=6)
    return prover._table_problem(table, "linear", prover.box({}))


QUOTIENTS: dict[str, Callable[[Prover], QuotientProblem]] = {
    "value": lambda p: QuotientProblem(p.box({}), Surface.value),
    "odd": of_opposites,
    "apart": of_another,
    "difference": of_a_table,
}
"""The questions of a surface, by its method."""


def test_every_quotient_of_floats_is_here() -> None:
    made = {
        name
        for name, method in vars(Surface).items()
        if not name.startswith("_")
        and getattr(method, "__annotations__", {}).get("return") == "Quotients"
    }
    assert made - {"over_form", "slope", "gradient_squared"} == set(QUOTIENTS)  # of rationals alone


@pytest.mark.parametrize("seed", range(cases(3, 8)))
@pytest.mark.parametrize("name", QUOTIENTS)
def test_coefficients_of_floats_are_off_by_no_more_than_they_say(name: str, seed: int) -> None:
    prover = Prover(irregular(random.Random(seed), 1), "u")
    question = QUOTIENTS[name](prover)
    rounded, exact = (question.make(prover.surface(question, way)) for way in (FLOATS, rationals()))
    of_floats = np.asarray(rounded.corners, dtype=float)
    same = np.abs(of_floats - exact.corners.astype(float)).max(axis=(1, 2)) < 1e-12
    assert same.mean() > 0.9  # where two cuts tie, pieces come in another order
    assert rounded.error is not None
    exactly = rationals().number
    error = np.broadcast_to(rounded.error.reshape(len(of_floats), -1), rounded.upper.shape)[same]
    off = False
    pairs = (rounded.upper, exact.upper, rounded.reach), (rounded.lower, exact.lower, 1.0)
    rational = np.vectorize(lambda x: exactly(Fraction(x)), otypes=[object])
    for ours, theirs, reach in pairs:
        distance = np.abs((rational(ours) - theirs).astype(float))[same]
        assert (distance <= error * reach).all()
        off |= bool(distance.any())
    assert off  # some are rounded: without a margin this fails


def test_a_bound_that_was_proved_is_proved_again() -> None:
    for seed in range(4):
        rulebase = irregular(random.Random(seed), 1)
        value = Prover(rulebase, "u").value({})
        assert prove(rulebase, f"u in {value.low!r} .. {value.high!r}").proved


def test_a_bump_of_a_billionth_is_not_called_monotone() -> None:
    text = (
        "rulebase r\ninput x 0 .. 2\noutput u 0 .. 1\n"
        "term x A: points (0, 1) (1, 0) (2, {})\nterm x B: points (0, 0) (1, 1) (2, 1)\n"
        "term u N: singleton 0\nterm u P: singleton 1\ninference defuzzifier weighted-average\n"
        "rule if x is A then u is N\nrule if x is B then u is P\n"
    )
    flat, bump = (parse(text.format(height)).rulebase for height in ("0", "1e-9"))
    assert flat is not None
    assert bump is not None
    assert prove(flat, "u rises with x").proved
    assert not prove(bump, "u rises with x").proved


def test_nearly_odd_is_not_odd() -> None:
    off = parse(PD7.replace("NB      NB", "NB      NB*0.9999")).rulebase
    assert off is not None
    assert prove(off, "u odd").verdict == "refuted"


@pytest.mark.parametrize("seed", range(4))
def test_floats_and_rationals_agree(seed: int) -> None:
    rulebase = irregular(random.Random(seed), 1)
    floats = Prover(rulebase, "u").value({})
    exact = Prover(rulebase, "u", exact=True).value({})
    assert exact.way == "exact"
    assert floats.reached_low == pytest.approx(exact.reached_low, abs=1e-9)
    assert floats.reached_high == pytest.approx(exact.reached_high, abs=1e-9)
    assert floats.low <= exact.reached_low
    assert exact.reached_high <= floats.high


@pytest.mark.parametrize("seed", range(6))
def test_pieces_give_the_value_of_inference_everywhere(seed: int) -> None:
    """On every piece the quotient is the centroid, at points inside and not at vertices alone."""
    rulebase = irregular(random.Random(seed), 2)
    model = straight(rulebase, "u")
    pieces = cut(model, Cut(model.ranges), FLOATS)  # type: ignore[arg-type]
    surface = Surface(model, pieces)
    quotients = surface.value()
    draw = np.random.default_rng(seed)
    shares = draw.dirichlet(np.ones(3), pieces.count)
    indices = np.array(lattice(2, quotients.degree))
    multinomial = np.array(
        [math.factorial(quotients.degree) / math.prod(map(math.factorial, i)) for i in indices]
    )
    basis = multinomial * np.prod(shares[:, None, :] ** indices[None], axis=2)
    upper, lower = (basis * quotients.upper).sum(axis=1), (basis * quotients.lower).sum(axis=1)
    some = np.flatnonzero(lower > 1e-4)[:400]
    points = [
        pieces.position(int(i), (shares[i][:, None] * pieces.corners[i]).sum(axis=0)) for i in some
    ]
    inputs = {name: np.array([float(p[k]) for p in points]) for k, name in enumerate(model.names)}
    found = np.asarray(fuzzyarm.infer(rulebase, inputs)["u"])
    assert np.allclose(found, upper[some] / lower[some] + float(surface.centre), atol=1e-9)


def test_halves_and_values_of_polynomials_are_exact() -> None:
    """Coefficients from values, and of halves, against the polynomial itself, in rationals."""
    number = rationals().number
    indices = lattice(2, 3)

    def polynomial(x: Fraction, y: Fraction) -> Fraction:
        return 3 * x**3 - 2 * x * y + y**2 * x - Fraction(1, 3)

    values = np.array(
        [number(polynomial(Fraction(i[1], 3), Fraction(i[2], 3))) for i in indices], dtype=object
    )
    coefficients = from_values(2, 3, exact=True) @ values
    half = halving(2, 3, 0, 1, exact=True) @ coefficients  # vertex 1 moves to (1/2, 0)
    corner = half[indices.index((0, 3, 0))]
    assert as_fraction(corner) == polynomial(Fraction(1, 2), Fraction(0))
    assert as_fraction(half[indices.index((0, 0, 3))]) == polynomial(Fraction(0), Fraction(1))


def test_a_crude_bound_of_rationals_is_rounded_up() -> None:
    """Numerator, denominator and quotient are each rounded on the way to a float."""
    number, draw = rationals().number, random.Random(1)

    def rational() -> Fraction:
        return Fraction(draw.randrange(1, 10**25), draw.randrange(1, 10**25))

    for _ in range(400):
        above, below = rational(), rational()
        ratio = above / below
        upper, lower = (np.array([[number(x)] * 2], dtype=object) for x in (above, below))
        corners = np.array([[[number(Fraction(0))], [number(Fraction(1))]]], dtype=object)
        piece = Quotients(upper, lower, None, 0.0, corners, np.array([0]), 1)
        assert ratio <= Fraction(piece.bound()) <= ratio * (1 + Fraction(1, 2**48))


@given(st.integers(0, 10**6))
@settings(max_examples=cases(8, 15), deadline=None)
def test_centroids_between_two_curves(seed: int) -> None:
    """Memberships drawn between two curves have no centroid outside, and some come close."""
    draw = np.random.default_rng(seed)
    edges = np.sort(np.concatenate([[0.0, 10.0], draw.uniform(0, 10, 8)]))
    upper = draw.uniform(0, 1, (9, 2))
    lower = upper * draw.uniform(0, 1, (9, 1))
    low, high = centroid_bounds(edges, lower, upper)
    fine = np.linspace(0, 10, 4001)
    panel = np.clip(np.searchsorted(edges, fine, side="right") - 1, 0, 8)
    share = (fine - edges[panel]) / (edges[panel + 1] - edges[panel])
    least, most = (c[panel, 0] + share * (c[panel, 1] - c[panel, 0]) for c in (lower, upper))
    for switch in np.linspace(0, 10, 101):
        mu = np.where(fine < switch, least, most)
        assert (fine * mu).sum() / mu.sum() <= float(high) + 2e-2
    best = max(
        (fine * mu).sum() / mu.sum()
        for mu in (np.where(fine < switch, least, most) for switch in np.linspace(0, 10, 401))
    )
    assert float(high) == pytest.approx(best, abs=2e-2)
    assert float(low) <= float(high)


@given(st.integers(0, 10**6))
@settings(max_examples=cases(10, 30), deadline=None)
def test_averages_between_two_weights(seed: int) -> None:
    """The exact bounds are those over all choices of the ends of the weights."""
    draw = np.random.default_rng(seed)
    numbers, lower = draw.uniform(-1, 1, 6), draw.uniform(0, 1, 6)
    upper = lower + draw.uniform(0.01, 1, 6)
    low, high = average_bounds(numbers, numbers, lower, upper)
    choices = [np.where([(bits >> k) & 1 for k in range(6)], upper, lower) for bits in range(64)]
    averages = [(numbers * weights).sum() / weights.sum() for weights in choices]
    assert float(low) == pytest.approx(min(averages), abs=1e-12)
    assert float(high) == pytest.approx(max(averages), abs=1e-12)


@pytest.mark.parametrize(
    "change",
    [
        ("implication min", "implication product"),
        ("inference and min", "inference and product"),
        ("centroid exact", "centroid(101, endpoints)"),
        ("inference and min", "inference and einstein"),
    ],
    ids=lambda change: change[1],
)
def test_boxes_hold(change: tuple[str, str]) -> None:
    rulebase = parse(PD7.replace(*change)).rulebase
    assert rulebase is not None
    bounds = Prover(rulebase, "u", tolerance=0.1).value({"e": (0.0, 4.0), "ce": (0.0, 4.0)})
    assert bounds.way == "boxes"
    assert bounds.complete
    draw = np.random.default_rng(0)
    inputs = {name: draw.uniform(0.0, 4.0, 20_000) for name in ("e", "ce")}
    values = np.asarray(fuzzyarm.infer(rulebase, inputs)["u"])
    assert bounds.low <= values.min()
    assert values.max() <= bounds.high
    assert bounds.high - values.max() < 0.12


def test_what_is_not_straight_says_why() -> None:
    pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    bisector = dataclasses.replace(
        pd7,
        outputs=(dataclasses.replace(pd7.outputs[0], defuzzifier=Defuzzifier("bisector")),),
    )
    with pytest.raises(NotStraightError, match="bisector"):
        straight(bisector, "u")


@pytest.mark.parametrize("method", ["weighted-average", "weighted-sum"])
def test_averages_of_linear_forms(method: str) -> None:
    text = (
        "rulebase r\ninput x 0 .. 1\ninput y 0 .. 1\noutput u -9 .. 9\n"
        "terms x, y: triangles L H\nterm u A: linear 2*x - 1*y + 0.5\nterm u B: singleton 1\n"
        f"inference and product, aggregation sum, defuzzifier {method}, no-rule 0\n"
        "rules u\n  x \\ y  L  H\n  L      A  B\n  H      B  A\n"
    )
    rulebase = parse(text).rulebase
    assert rulebase is not None
    prover = Prover(rulebase, "u")
    assert not prover.reason
    grid = np.linspace(0, 1, 401)
    found = fuzzyarm.infer(rulebase, {"x": grid[:, None], "y": grid[None, :]})["u"]
    bounds = prover.value({})
    assert bounds.low <= np.min(found)
    assert np.max(found) <= bounds.high
    assert bounds.high == pytest.approx(float(np.max(found)), abs=1e-3)
    slopes = np.diff(np.asarray(found), axis=0) * 400
    slope = prover.slope({}, "x")
    assert slope.low - 1e-9 <= slopes.min()
    assert slopes.max() <= slope.high + 1e-9
    assert slope.high == pytest.approx(slopes.max(), abs=0.05)


# --- Positions and ends between two ---


def _between(draw: np.random.Generator, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return something between: at an end as often as not."""
    share = np.clip(draw.uniform(-0.5, 1.5, lower.shape), 0.0, 1.0)
    return lower + share * (upper - lower)


def _weights(draw: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return bounds of weights, many of them 0 or equal."""
    upper = draw.choice([0.0, 0.25, 0.5, 1.0], count) * draw.choice([1.0, draw.uniform()])
    return upper * draw.choice([0.0, 0.5, 0.9, 1.0], count), upper


@given(st.integers(0, 10**6))
@settings(max_examples=cases(13, 40), deadline=None)
def test_bisectors_between_two_curves(seed: int) -> None:
    """Of memberships that are level on each panel, between two such curves."""
    draw = np.random.default_rng(seed)
    edges = np.concatenate([[0.0], np.cumsum(draw.choice([0.25, 0.5, 1.0], 9))])
    lower, upper = (np.stack([side, side], axis=1) for side in _weights(draw, 9))
    low, high = bisector_bounds(edges, lower, upper)
    for _ in range(30):
        heights = _between(draw, lower[:, 0], upper[:, 0])
        area = np.concatenate([[0.0], np.cumsum(heights * np.diff(edges))])
        if not area[-1] > 0.0:
            continue
        half = 0.5 * area[-1]
        first, last = np.searchsorted(area, half), np.searchsorted(area, half, side="right") - 1
        i = max(first - 1, 0)
        start = edges[i] + (half - area[i]) / max(heights[i], 1e-300)
        assert low - 1e-9 <= min(start, edges[first])
        assert max(start, edges[last] if area[last] == half else start) <= high + 1e-9
    same_low, same_high = bisector_bounds(edges, upper + 0.1, upper + 0.1)
    assert 0.0 <= float(same_high - same_low) < 1e-8


@given(st.integers(0, 10**6))
@settings(max_examples=cases(20, 60), deadline=None)
def test_halves_of_running_sums_between_two(seed: int) -> None:
    draw = np.random.default_rng(seed)
    count = int(draw.integers(1, 9))
    positions = np.sort(draw.choice(np.arange(20.0), count, replace=False))
    lower, upper = _weights(draw, count)
    one = halving_bounds(positions, positions, lower, upper)
    other = nearest_half_bounds(positions, lower, upper)
    for _ in range(30):
        weights = _between(draw, lower, upper).tolist()
        halves = [
            (one, *half_of(positions.tolist(), weights, count, next_to)) for next_to in (0, 1)
        ]
        halves.append((other, *nearest_half_of(positions.tolist(), weights, count)))
        for bounds, total, found in halves:
            assert not total > 0.0 or bounds[0] <= found <= bounds[1]
    exact = halving_bounds(positions, positions, upper + 0.1, upper + 0.1)
    total, found = half_of(positions.tolist(), (upper + 0.1).tolist(), count, 0)
    assert total > 0.0
    assert float(exact[0]) <= found <= float(exact[1])


@given(st.integers(0, 10**6))
@settings(max_examples=cases(20, 60), deadline=None)
def test_ends_of_averages_whose_weights_lie_between_uncertain_ends(seed: int) -> None:
    draw = np.random.default_rng(seed)
    count = int(draw.integers(1, 7))
    least = np.sort(draw.choice(np.arange(20.0), count, replace=False))[None, :] * np.ones((2, 1))
    greatest = least + draw.choice([0.0, 1.0])
    greatest[1] += draw.choice([0.0, 0.5])
    (upper_0, upper_1), share = _weights(draw, count), draw.choice([0.0, 0.5, 1.0], (2, count))
    lower_1 = upper_1 * share.max(axis=0)
    lower_0 = np.minimum(upper_0, lower_1) * share.min(axis=0)
    (left_0, left_1), (right_0, right_1) = ends_of_average_bounds(
        tuple(least), tuple(greatest), (lower_0, lower_1), (upper_0, upper_1)
    )
    for _ in range(30):
        upper = _between(draw, upper_0, upper_1)
        lower = np.minimum(_between(draw, lower_0, lower_1), upper)
        numbers = least[0].tolist(), _between(draw, *greatest).tolist()
        left = end_of_average(numbers[0], lower.tolist(), upper.tolist(), count, -1.0)
        right = end_of_average(numbers[1], lower.tolist(), upper.tolist(), count, 1.0)
        if sum(upper) > 0.0:
            assert left_0 - 1e-11 <= left <= left_1 + 1e-11
            assert right_0 - 1e-11 <= right <= right_1 + 1e-11


@given(st.integers(0, 10**6))
@settings(max_examples=cases(13, 40), deadline=None)
def test_ends_of_centroids_between_four_curves(seed: int) -> None:
    """Between certain curves they are the centroids between two; others lie in between."""
    draw = np.random.default_rng(seed)
    edges = np.concatenate([[0.0], np.cumsum(draw.choice([0.25, 0.5, 1.0], 7))])
    upper_0, upper_1 = (np.stack([side, side], axis=1) for side in _weights(draw, 7))
    lower_1 = upper_1 * draw.choice([0.0, 0.5, 1.0], (7, 1))
    lower_0 = np.minimum(lower_1, upper_0) * draw.choice([0.0, 0.5, 1.0], (7, 1))
    ends = ends_of_centroid_bounds(edges, (lower_0, lower_1), (upper_0, upper_1))
    (left_0, left_1), (right_0, right_1) = ends
    for _ in range(20):
        upper = np.repeat(_between(draw, upper_0[:, :1], upper_1[:, :1]), 2, axis=1)
        lower = np.repeat(_between(draw, lower_0[:, :1], lower_1[:, :1]), 2, axis=1)
        lower = np.minimum(lower, upper)
        left, right = centroid_bounds(edges, lower, upper)
        if not np.isnan(left):
            assert left_0 - 1e-9 <= left <= left_1 + 1e-9
            assert right_0 - 1e-9 <= right <= right_1 + 1e-9


NEXT_TO = """rulebase sliver
input  e 0 .. 1
output w 0 .. 1
term e DOWN: trapezoid -1 -1 0 1
term e UP: trapezoid 0 1 1 2
term e LATE: trapezoid {late!r} {end!r} 2 3
term e ALL: trapezoid -2 -2 3 3
term w O: singleton 0
term w P: singleton 1
inference defuzzifier weighted-average, aggregation sum
rule if e is DOWN and e is UP then w is P
rule if e is LATE then w is P
rule if e is ALL then w is O
"""
"""With s = min(1 - e, e) + LATE, w = s / (s + 1): it falls between one half, where the minimum
changes, and `late`, where LATE begins; elsewhere it rises."""


@pytest.mark.parametrize("late", [math.nextafter(0.5, 1.0), 0.5 + 2.0**-52, 0.5 + 2.0**-50])
def test_a_sliver_between_two_corners_counts(late: float) -> None:
    """Heights that floats take for equal at a corner cross beside it, where a slope is another."""
    model = parse(NEXT_TO.format(late=late, end=late + 0.5)).rulebase
    assert model is not None

    def value(e: Fraction) -> Fraction:
        total = min(1 - e, e) + max(Fraction(0), (e - Fraction(late)) / Fraction(0.5))
        return total / (total + 1)

    assert value(Fraction(late)) < value(Fraction(1, 2))
    assert prove(model, "w rises with e").verdict != "proved"
    secant = (value(Fraction(late)) - value(Fraction(1, 2))) / (Fraction(late) - Fraction(1, 2))
    bounds = Prover(model, "w").slope({}, "e")
    assert bounds.low <= secant <= bounds.high


@pytest.mark.parametrize("power", [1, 2])
def test_slopes_of_a_thin_cell_are_those_of_its_corners(power: int) -> None:
    """Both ends of a membership in a cell of a few floats are rounded; their difference is not."""
    low, high = 0.3, 0.1 + 0.2
    text = f"""rulebase thin
input  e 0 .. 1
output w 0 .. 1
term e UP: trapezoid -0.5 1.1 2 3
term e LATE: trapezoid {high!r} 0.7 2 3
term e ALL: trapezoid -2 -2 3 3
term w O: singleton 0
term w P: singleton 1
inference and product, defuzzifier weighted-average, aggregation sum
rule if {" and ".join(["e is UP"] * power)} then w is P
rule if e is LATE then w is P
rule if e is ALL then w is O
"""
    model = parse(text).rulebase
    assert model is not None
    bounds = Prover(model, "w").slope({"e": (low, high)}, "e")
    steep = 1 / (Fraction(1.1) + Fraction(0.5))
    at = [steep * (Fraction(x) + Fraction(0.5)) for x in (low, high)]
    slopes = [power * up ** (power - 1) * steep / (1 + up**power) ** 2 for up in at]
    assert bounds.low <= min(slopes)
    assert max(slopes) <= bounds.high
    assert bounds.high - bounds.low < 1e-6


STEEPER = """rulebase steeper
input  e 0.3333333321492007 .. 0.33333333570159857
output w -1 .. 1
term e A: trapezoid -1.7473864541414427e-17 1 3 4
term e B: trapezoid -4.0202429494273956e-11 1.0000000000804048 3 4
term w N: singleton -1
term w Z: singleton 0
term w P: singleton 1
inference defuzzifier weighted-average, aggregation sum
rule if e is A then w is Z
rule if e is A or e is B then w is N with 0.5
rule if e is B then w is N
rule if e is A and e is not A then w is P
"""
"""A cell so thin that floats cannot order two heights, of which one is 8e-11 steeper."""

LEVEL = """rulebase level
input  e 0.3 .. 0.31055410030144714
output w 0 .. 1
term e A: trapezoid 0 2.147652315679961 30 40
term e B: trapezoid -0.1 8.600798639342232 30 40
term e C: trapezoid -2 -1 0 1.7224846591943848
term e ALL: trapezoid -5 -4 40 50
term w Z: singleton 0
term w P: singleton 1
inference defuzzifier weighted-average, aggregation sum
rule if e is A then w is P
rule if e is B then w is P
rule if e is C then w is P
rule if e is ALL then w is Z
"""
"""Three slopes of one height cancel but for less than the rounding of their sum."""


def steeper(e: Fraction) -> Fraction:
    low = [Fraction(-1.7473864541414427e-17), Fraction(-4.0202429494273956e-11)]
    a, b = (e - low[0]) / (1 - low[0]), (e - low[1]) / (Fraction(1.0000000000804048) - low[1])
    most, least = max(a, b) / 2, min(a, 1 - a)
    return (least - most - b) / (a + most + b + least)


def level(e: Fraction) -> Fraction:
    first, second, third = map(Fraction, (2.147652315679961, 8.600798639342232, 1.7224846591943848))
    total = e / first + (e + Fraction(0.1)) / (second + Fraction(0.1)) + 1 - e / third
    return total / (total + 1)


@pytest.mark.parametrize(("text", "value"), [(STEEPER, steeper), (LEVEL, level)])
def test_slopes_that_nearly_cancel_are_not_proved_by_their_rounding(
    text: str, value: Callable[[Fraction], Fraction]
) -> None:
    model = parse(text).rulebase
    assert model is not None
    low, high = Fraction(model.inputs[0].low), Fraction(model.inputs[0].high)
    near = low + (high - low) / 16
    steepest = (value(near) - value(low)) / (near - low)
    bound = float(steepest - Fraction(abs(steepest)) / 10**8)
    assert Fraction(bound) < steepest
    claim = "w falls with e" if steepest < 1e-16 else f"w slope e in -1 .. {bound!r}"
    assert prove(model, claim).verdict != "proved"
    assert prove(model, f"w slope e in -1 .. {float(steepest) * 1.01!r}").verdict == "proved"


SETS = ((-1.0, -0.5, 0.5), (-0.25, 0.0, 0.5), (0.0, 0.5, 1.0))
"""Triangles of the output of :func:`crossing`."""


def crossing(low: float, high: float, rise: float, fall: float, steep: float) -> str:
    """Return a rule base of which two heights cross at 0.5, in a thin cell where a third is steep.

    Nowhere else have the slopes of all three the values that they have on both sides of 0.5.
    """
    terms = [
        f"(0, {0.5 - 0.5 * rise!r}) (1, {0.5 + 0.5 * rise!r})",
        f"(0, {0.5 + 0.5 * fall!r}) (1, {0.5 - 0.5 * fall!r})",
        f"(0, 0.25) ({low!r}, 0.25) ({high!r}, {0.25 + steep * (high - low)!r}) (1, 0.25)",
    ]
    lines = ["rulebase crossing", "input e 0 .. 1", "output u -1 .. 1"]
    lines += [f"term e T{i}: points {term}" for i, term in enumerate(terms)]
    lines += [f"term u U{i}: triangle {a!r} {b!r} {c!r}" for i, (a, b, c) in enumerate(SETS)]
    lines += [f"rule if e is T{i} then u is U{i}" for i in range(3)]
    return "\n".join([*lines, "inference defuzzifier centroid", ""])


def exact_height(corners: list[tuple[Fraction, Fraction]], x: Fraction) -> Fraction:
    for (x0, y0), (x1, y1) in pairwise(corners):
        if x0 <= x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return Fraction(0)


def exact_centroid(heights: list[Fraction]) -> Fraction:
    """Return the centroid of the union of clipped :data:`SETS`, cut at every crossing."""
    cut_sets = []
    for corners, h in zip(SETS, heights, strict=True):
        a, b, c = map(Fraction, corners)
        nothing = Fraction(0)
        cut_sets.append([(a, nothing), (a + (b - a) * h, h), (c - (c - b) * h, h), (c, nothing)])
    ends = sorted({x for corners in cut_sets for x, _ in corners})
    area = moment = Fraction(0)
    for start, end in pairwise(ends):
        at = [[exact_height(corners, x) for x in (start, end)] for corners in cut_sets]
        shares = {Fraction(0), Fraction(1)}
        for (p0, p1), (q0, q1) in combinations(at, 2):
            if (p0 - q0) * (p1 - q1) < 0:
                shares.add((p0 - q0) / (p0 - q0 - p1 + q1))
        for s, t in pairwise(sorted(shares)):
            x0, x1 = (start + (end - start) * share for share in (s, t))
            y0, y1 = (max(p + (q - p) * share for p, q in at) for share in (s, t))
            area += (x1 - x0) * (y0 + y1) / 2
            moment += (x1 - x0) * (y0 * (2 * x0 + x1) + y1 * (x0 + 2 * x1)) / 6
    return moment / area


@given(
    below=st.integers(1, 40),
    above=st.integers(1, 40),
    rise=st.sampled_from([0.5, 0.25, 0.125]),
    fall=st.sampled_from([0.5, 0.25, 0.125]),
    steep=st.sampled_from([-10.0, -3.0, -0.5, 0.5, 3.0, 10.0]),
)
@settings(max_examples=cases(15, 60), deadline=None)
def test_two_heights_that_cross_in_a_thin_cell_have_both_slopes(
    below: int, above: int, rise: float, fall: float, steep: float
) -> None:
    low, high = 0.5 - below * 2.0**-53, 0.5 + above * 2.0**-52
    model = parse(crossing(low, high, rise, fall, steep)).rulebase
    assert model is not None
    start, middle, end = Fraction(low), Fraction(1, 2), Fraction(high)
    third = Fraction(0.25 + steep * (high - low)) - Fraction(1, 4)

    def value(e: Fraction) -> Fraction:
        first, second = (e - middle) * Fraction(rise), (middle - e) * Fraction(fall)
        share = (e - start) / (end - start)
        return exact_centroid([middle + first, middle + second, Fraction(1, 4) + third * share])

    bounds = Prover(model, "u").slope({}, "e")
    for a, b in ((start, middle), (middle, end)):
        secant = (value(b) - value(a)) / (b - a)
        assert bounds.low <= secant <= bounds.high
