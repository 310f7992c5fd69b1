"""Every defuzzifier on sets small enough to work out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.inference import InferenceError, infer
from fuzzyarm.language.model.rulebase import RuleBase, Shape
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SHAPES, SNORMS, TNORMS
from tests.inference.small import base, rule, terms
from tests.interpreted import interpreted
from tests.strategies import SMOOTH, STRAIGHT, shapes

BOXES = terms(left=Shape("rectangle", (1.0, 3.0)), right=Shape("rectangle", (6.0, 8.0)))
HILLS = terms(left=Shape("triangle", (0.0, 2.0, 4.0)), right=Shape("triangle", (5.0, 6.0, 7.0)))
RULES = [rule("a high", "u left"), rule("b high", "u right")]


def both(rulebase: RuleBase, **values: float) -> float:
    """Evaluate in both engines."""
    single = infer(rulebase, values)["u"]
    array = infer(rulebase, {name: np.array([value]) for name, value in values.items()})["u"][0]
    assert array == pytest.approx(single, abs=1e-12)
    assert isinstance(single, float)
    return single


@pytest.mark.parametrize("implication", ["min", "product", "einstein", "hamacher"])
def test_centroid_of_two_boxes(implication: str) -> None:
    rulebase = base(RULES, BOXES, implication=implication)
    assert both(rulebase, a=0.5, b=0.25) == pytest.approx((0.5 * 2 + 0.25 * 7) / 0.75)


@pytest.mark.parametrize(
    ("sampling", "expected"),
    [
        # u left at 1 over 0, 2, 4, … 10: samples 2 → 2; midpoints 1, 3, 5, 7, 9 → 2;
        # left 0, 2, 4, 6, 8 → 2. The hill is 1 at 2 and 0 at 0 and 4.
        ("endpoints", 2.0),
        ("trapezoid", 2.0),
        ("midpoints", 2.0),
        ("left", 2.0),
    ],
)
def test_sampled_centroid_of_a_hill(sampling: str, expected: float) -> None:
    count = 6 if sampling in {"endpoints", "trapezoid"} else 5
    rulebase = base(RULES, HILLS, resolution=count, sampling=sampling)
    assert both(rulebase, a=1.0, b=0.0) == pytest.approx(expected)


@pytest.mark.parametrize("fired", range(1, 8))
def test_few_sets_and_many_are_summed_up_in_one_order(fired: int) -> None:
    """Up to four are united in registers, more are not, nor any by the interpreted kernel."""
    peaks = np.linspace(1.0, 9.0, 7)
    sets = {f"s{k}": Shape("triangle", (x - 2.0, x, x + 2.0)) for k, x in enumerate(peaks)}
    names = [f"i{k}" for k in range(7)]
    rules = [rule(f"i{k} high", f"u s{k}") for k in range(7)]
    rulebase = base(rules, terms(**sets), names=names, resolution=101)
    given = np.random.default_rng(fired).uniform(0.05, 1.0, 7) * (np.arange(7) < fired)
    at = np.linspace(0.0, 10.0, 101)
    degrees = np.maximum(0.0, 1.0 - np.abs(at[:, None] - peaks) / 2.0)
    union = np.minimum(degrees, given).max(axis=1)
    expected = (union * at).sum() / union.sum()
    point = dict(zip(names, given.tolist(), strict=True))
    value = both(rulebase, **point)
    assert value == pytest.approx(expected, rel=1e-13)
    assert interpreted(rulebase)(**point)["u"] == value


def test_samplings_differ_at_the_ends() -> None:
    # min(1, z-like ramp 10 → 0): heights 1, 3/4, 1/2, 1/4, 0 at 0, 2.5, … 10.
    ramp = terms(down=Shape("ramp", (10.0, 0.0)))
    rules = [rule("a high", "u down")]
    heights, places = np.array([1.0, 0.75, 0.5, 0.25, 0.0]), np.arange(0.0, 11.0, 2.5)
    ends = base(rules, ramp, names=["a"], resolution=5)
    assert both(ends, a=1.0) == pytest.approx((heights * places).sum() / heights.sum())
    half_ends = base(rules, ramp, names=["a"], resolution=5, sampling="trapezoid")
    by_trapezoids = np.trapezoid(heights * places) / np.trapezoid(heights)
    assert both(half_ends, a=1.0) == pytest.approx(by_trapezoids)
    left = base(rules, ramp, names=["a"], resolution=4, sampling="left")
    assert both(left, a=1.0) == pytest.approx((heights * places)[:4].sum() / heights[:4].sum())
    middles = base(rules, ramp, names=["a"], resolution=2, sampling="midpoints")
    assert both(middles, a=1.0) == pytest.approx((2.5 * 0.75 + 7.5 * 0.25) / 1.0)
    exact = base(rules, ramp, names=["a"])
    assert both(exact, a=1.0) == pytest.approx(10.0 / 3.0)


# Two boxes 1 .. 3 and 6 .. 8 of one height.
PLATEAUS = {
    "smallest-of-maximum": 1.0,
    "largest-of-maximum": 8.0,
    "mean-of-maximum": 4.5,
    "middle-of-maximum": 4.5,
    "nearest-of-maximum": 1.0,
    "farthest-of-maximum": 8.0,
}


def test_every_defuzzifier_of_the_maximum_is_here() -> None:
    of_maximum = {name for name, kind in DEFUZZIFIERS.items() if kind.of == "top" and not kind.own}
    assert of_maximum == set(PLATEAUS)


@pytest.mark.parametrize(("method", "expected"), PLATEAUS.items())
def test_maxima_of_equally_high_plateaus(method: str, expected: float) -> None:
    assert both(base(RULES, BOXES, method), a=0.5, b=0.5) == pytest.approx(expected)
    assert both(base(RULES, BOXES, method), a=0.5, b=0.4) <= 3.0


def test_maxima_of_clipped_hills() -> None:
    # a = 1/2 cuts the left hill from 1 to 3, b = 1/2 the right one from 5.5 to 6.5.
    mean = base(RULES, HILLS, "mean-of-maximum")
    assert both(mean, a=0.5, b=0.5) == pytest.approx((2 * 2.0 + 1 * 6.0) / 3)
    assert both(mean, a=0.5, b=0.25) == pytest.approx(2.0)
    assert both(base(RULES, HILLS, "largest-of-maximum"), a=0.5, b=0.5) == pytest.approx(6.5)


def test_maxima_of_scaled_hills_are_their_peaks() -> None:
    mean = base(RULES, HILLS, "mean-of-maximum", implication="product")
    assert both(mean, a=0.5, b=0.5) == pytest.approx(4.0)
    assert both(mean, a=0.5, b=0.6) == pytest.approx(6.0)


POINTED = {
    "triangle": (0.0, 4.0, 6.0), "points": (1.0, 0.0, 4.0, 1.0, 7.0, 0.0), "gaussian": (4.0, 1.0),
    "bell": (4.0, 1.0, 3.5), "cosine": (4.0, 3.0), "spike": (4.0, 3.0), "semi-ellipse": (2.0, 6.0),
    "sigmoid-product": (2.0, 3.0, 6.0, -3.0),
}  # fmt: skip
FLAT = {
    "trapezoid": (1.0, 3.0, 5.0, 6.0), "rectangle": (3.0, 5.0), "pi": (1.0, 3.0, 5.0, 6.0),
    "z": (5.0, 8.0), "s": (2.0, 5.0), "ramp": (2.0, 5.0), "arc": (2.0, 5.0), "concave": (2.0, 5.0),
    "two-sided-gaussian": (3.0, 1.0, 5.0, 2.0),
}  # fmt: skip


@pytest.mark.parametrize("method", ["centroid", "bisector"])
@pytest.mark.parametrize("aggregation", ["max", "sum", "probor"])
@pytest.mark.parametrize("kind", [*POINTED, *FLAT])
def test_what_has_no_area_is_no_rule(kind: str, aggregation: str, method: str) -> None:
    """Below strength 1 drastic leaves a set its plateau at 1: a peak has no area, however round."""
    shape = Shape(kind, (POINTED | FLAT)[kind])
    rulebase = base(
        [rule("a high", "u A")], terms(A=shape), method, names=["a"],
        implication="drastic", aggregation=aggregation, no_rule=-1.0, outside="extend",
    )  # fmt: skip
    assert 0.0 < both(rulebase, a=1.0) < 10.0
    ends = {"z": (0.0, 5.0), "trapezoid": (3.0, 5.0), "rectangle": (3.0, 5.0), "pi": (3.0, 5.0)}
    ends |= {"two-sided-gaussian": (3.0, 5.0)}
    middle = sum(ends.get(kind, (5.0, 10.0))) / 2 if kind in FLAT else -1.0
    assert both(rulebase, a=0.5) == pytest.approx(middle)


def test_maxima_of_a_sum() -> None:
    # Two overlapping boxes add up where they overlap: 2 … 3.
    overlapping = terms(left=Shape("rectangle", (1.0, 3.0)), right=Shape("rectangle", (2.0, 8.0)))
    mean = base(RULES, overlapping, "mean-of-maximum", aggregation="sum")
    assert both(mean, a=0.5, b=0.25) == pytest.approx(2.5)


def test_maxima_of_a_bounded_sum_start_where_the_sum_reaches_one() -> None:
    lines = terms(A=Shape("ramp", (0.0, 7.3)), B=Shape("ramp", (1.0, 8.9)))
    smallest = base(
        [rule("a high", "u A"), rule("b high", "u B")], lines, "smallest-of-maximum",
        implication="product", aggregation="bounded",
    )  # fmt: skip
    # 0.9 y / 7.3 + 0.9 (y − 1) / 7.9 = 1
    reached = (1.0 + 0.9 / 7.9) / (0.9 / 7.3 + 0.9 / 7.9)
    assert both(smallest, a=0.9, b=0.9) == pytest.approx(reached, abs=1e-14)


@pytest.mark.parametrize("aggregation", ["max", "probor"])
def test_a_nilpotent_cut_begins_where_the_degrees_pass_one(aggregation: str) -> None:
    hill = terms(A=Shape("triangle", (0.0, 5.0, 10.0)))
    settings_ = {"names": ["a"], "implication": "nilpotent", "aggregation": aggregation}
    # min(0.3, y / 5) where 0.3 + y / 5 > 1
    smallest = base([rule("a high", "u A")], hill, "smallest-of-maximum", **settings_)
    assert both(smallest, a=0.3) == pytest.approx(3.5, abs=1e-12)
    largest = base([rule("a high", "u A")], hill, "largest-of-maximum", **settings_)
    assert both(largest, a=0.8) == pytest.approx(6.0, abs=1e-12)


@pytest.mark.slow
@settings(deadline=None, max_examples=cases(50, 300))
@given(st.data())
def test_nothing_is_above_the_maxima(data: st.DataObject) -> None:
    """Any norms: no position of a dense grid is higher, or as high and further out."""
    names = ["a", "b", "c"][: data.draw(st.integers(1, 3))]
    curved = data.draw(st.booleans())
    kind = st.sampled_from(STRAIGHT + SMOOTH if curved else STRAIGHT)
    sets = [data.draw(kind.flatmap(lambda k: shapes(k, 0.0, 10.0))) for _ in names]
    strengths = data.draw(
        st.lists(st.sampled_from([0.1, 0.3, 0.5, 0.9, 1.0]), min_size=3, max_size=3)
    )
    chosen = {
        "implication": data.draw(st.sampled_from(list(TNORMS))),
        "aggregation": data.draw(st.sampled_from([name for name in SNORMS if name != "max"])),
    }

    def height(y: np.ndarray) -> np.ndarray:
        total = np.zeros(y.shape)
        for strength, shape in zip(strengths, sets, strict=False):
            degree = SHAPES[shape.kind].array(y, *shape.parameters) * shape.height
            degree = np.broadcast_to(degree, y.shape)
            part = TNORMS[chosen["implication"]].array(np.full(y.shape, strength), degree)
            total = SNORMS[chosen["aggregation"]].array(total, part)
        return np.asarray(total)

    rules = [rule(f"{name} high", f"u {name}") for name in names]
    made = terms(**dict(zip(names, sets, strict=True)))
    point = dict(zip(names, strengths, strict=False))
    smallest, largest, mean = (
        both(base(rules, made, method, names=names, no_rule=-1.0, **chosen), **point)
        for method in ("smallest-of-maximum", "largest-of-maximum", "mean-of-maximum")
    )
    grid = np.linspace(0.0, 10.0, 2003)
    top = height(grid).max()
    if smallest == -1.0:
        assert top == 0.0
        return
    assert smallest <= mean <= largest
    for found in (smallest, largest):
        beside = np.array([found, found - 1e-8, found + 1e-8]).clip(0.0, 10.0)
        assert height(beside).max() >= top * (1.0 - 1e-9)
    if not curved and height(np.array([smallest]))[0] <= top * (1.0 + 1e-12):
        reached = grid[height(grid) >= top * (1.0 - 1e-14)]
        assert smallest <= reached[0] + 1e-9
        assert largest >= reached[-1] - 1e-9


def test_sampled_maxima() -> None:
    for method, expected in [
        ("smallest-of-maximum", 1.0),
        ("largest-of-maximum", 8.0),
        ("mean-of-maximum", np.mean([1, 2, 3, 6, 7, 8])),
    ]:
        rulebase = base(RULES, BOXES, method, resolution=11)
        assert both(rulebase, a=0.5, b=0.5) == pytest.approx(expected)


def test_bisector() -> None:
    exact = base(RULES, BOXES, "bisector")
    assert both(exact, a=1.0, b=0.5) == pytest.approx(2.5)
    assert both(exact, a=0.25, b=1.0) == pytest.approx(6.75)
    # Equal halves with nothing between: the middle of the gap.
    assert both(exact, a=0.5, b=0.5) == pytest.approx(4.5)
    hill = base(RULES, HILLS, "bisector")
    assert both(hill, a=1.0, b=0.0) == pytest.approx(2.0)


def test_bisector_halves_the_area() -> None:
    slope = terms(down=Shape("ramp", (10.0, 0.0)))
    rulebase = base([rule("a high", "u down")], slope, "bisector", names=["a"])
    assert both(rulebase, a=1.0) == pytest.approx(10.0 - 10.0 / math.sqrt(2.0))


def test_sampled_bisector() -> None:
    # Samples 0, 1, … 10; running sums 0 1 2 3 3 3 3.5 4 4.5 4.5: half of 4.5 at 3.
    assert both(base(RULES, BOXES, "bisector", resolution=11), a=1.0, b=0.5) == 3.0
    # Four samples of ½: half of 2 is reached at the second, and no gap follows.
    flat = Shape("points", (0, 0, 1, 0.5, 2, 0.5, 4, 0.5, 5, 0))
    hill = base([rule("a high", "u hill")], terms(hill=flat),
                "bisector", resolution=11, names=["a"])  # fmt: skip
    assert both(hill, a=1.0) == 2.0
    middles = base(RULES, BOXES, "bisector", resolution=10, sampling="midpoints")
    # Middles 0.5, 1.5, …: boxes over 1.5, 2.5 and 6.5, 7.5; half is reached at 2.5 and
    # stays up to 5.5, all equally near.
    assert both(middles, a=1.0, b=1.0) == pytest.approx((2.5 + 3.5 + 4.5 + 5.5) / 4)


def test_peaks_are_the_middles_of_the_cores() -> None:
    output_terms = terms(
        left=Shape("trapezoid", (-6.0, -6.0, -5.0, -3.0)), right=Shape("triangle", (3, 4, 9))
    )
    rulebase = base(RULES, output_terms, "weighted-average", low=-6.0, high=6.0)
    expected = (0.5 * -5.5 + 0.25 * 4.0) / 0.75
    assert both(rulebase, a=0.5, b=0.25) == pytest.approx(expected)
    total = base(RULES, output_terms, "weighted-sum", low=-6.0, high=6.0)
    assert both(total, a=0.5, b=0.25) == pytest.approx(0.5 * -5.5 + 0.25 * 4.0)


SPIKES = terms(left=Shape("singleton", (2.0,)), right=Shape("singleton", (7.0,)))


@pytest.mark.parametrize(
    ("method", "expected"),
    [
        ("centroid", (0.5 * 2 + 0.25 * 7) / 0.75),
        ("weighted-average", (0.5 * 2 + 0.25 * 7) / 0.75),
        ("weighted-sum", 0.5 * 2 + 0.25 * 7),
        ("bisector", 2.0),
        ("mean-of-maximum", 2.0),
        ("smallest-of-maximum", 2.0),
        ("largest-of-maximum", 2.0),
    ],
)
@pytest.mark.parametrize("resolution", [None, 101])
def test_singletons(method: str, expected: float, resolution: int | None) -> None:
    rulebase = base(RULES, SPIKES, method, resolution=resolution)
    assert both(rulebase, a=0.5, b=0.25) == pytest.approx(expected)


def test_ties_of_singletons() -> None:
    for method in ("mean-of-maximum", "bisector"):
        assert both(base(RULES, SPIKES, method), a=0.5, b=0.5) == pytest.approx(4.5)


def test_rules_of_one_singleton_fold_by_the_aggregation() -> None:
    rules = [rule("a high", "u left"), rule("b high", "u left"), rule("b low", "u right")]
    strongest = base(rules, SPIKES)
    assert both(strongest, a=0.5, b=0.25) == pytest.approx((0.5 * 2 + 0.75 * 7) / 1.25)
    added = base(rules, SPIKES, aggregation="sum")
    assert both(added, a=0.5, b=0.25) == pytest.approx((0.75 * 2 + 0.75 * 7) / 1.5)


def test_singletons_at_one_place_are_one_set_under_the_centroid() -> None:
    twins = terms(left=Shape("singleton", (2.0,)), right=Shape("singleton", (2.0,)),
                  far=Shape("singleton", (7.0,)))  # fmt: skip
    rules = [*RULES, rule("a low", "u far")]
    assert both(base(rules, twins), a=0.5, b=0.25) == pytest.approx((0.5 * 2 + 0.5 * 7) / 1.0)


def test_values_and_sets_do_not_mix() -> None:
    mixed = terms(left=Shape("singleton", (2.0,)), right=Shape("triangle", (0.0, 1.0, 2.0)))
    with pytest.raises(InferenceError, match="mixes values such as 'left' with sets"):
        infer(base(RULES, mixed), a=0.5, b=0.5)


@pytest.mark.parametrize(
    ("shape", "strength", "place"),
    [
        (Shape("ramp", (2.0, 6.0)), 0.25, 3.0),
        (Shape("ramp", (6.0, 2.0)), 0.25, 5.0),
        (Shape("sigmoid", (5.0, 2.0)), 0.5, 5.0),
        (Shape("sigmoid", (5.0, -2.0)), 1.0, 0.0),
        (Shape("s", (2.0, 6.0)), 0.125, 3.0),
        (Shape("s", (2.0, 6.0)), 0.875, 5.0),
        (Shape("z", (2.0, 6.0)), 0.125, 5.0),
        (Shape("concave", (2.0, 6.0)), 0.5, 2.0),
        (Shape("arc", (2.0, 6.0)), 0.6, 6.0 - 4.0 * 0.8),
        (Shape("triangle", (0.0, 10.0, 12.0)), 0.25, 2.5),
        (Shape("points", (0.0, 1.0, 5.0, 0.5, 10.0, 0.0)), 0.75, 2.5),
    ],
)
def test_tsukamoto_finds_the_place_of_a_strength(
    shape: Shape, strength: float, place: float
) -> None:
    rulebase = base([rule("a high", "u left")], terms(left=shape), "tsukamoto", names=["a"])
    assert both(rulebase, a=strength) == pytest.approx(place)


def test_tsukamoto_averages() -> None:
    slopes = terms(left=Shape("ramp", (10.0, 0.0)), right=Shape("ramp", (0.0, 10.0)))
    rulebase = base(RULES, slopes, "tsukamoto")
    assert both(rulebase, a=0.5, b=0.25) == pytest.approx((0.5 * 5.0 + 0.25 * 2.5) / 0.75)


def test_tsukamoto_needs_a_slope() -> None:
    with pytest.raises(InferenceError, match="neither rises nor falls"):
        infer(base(RULES, HILLS, "tsukamoto"), a=0.5, b=0.5)


@given(st.floats(0.05, 1.0), st.floats(0.05, 1.0))
def test_hedges_of_a_consequent_change_the_set(a: float, b: float) -> None:
    from fuzzyarm.language.model.rulebase import Consequent, Hedge, Is, Rule

    rules = [Rule(Is("a", "high"), (Consequent("u", "left", (Hedge("not"),)),)), RULES[1]]
    rulebase = base(rules, BOXES)
    # not left: height a over 0 … 1 and 3 … 10; right: height b over 6 … 8.
    heights = np.array([a, 0.0, a, max(a, b), a])
    widths, middles = np.array([1, 2, 3, 2, 2]), np.array([0.5, 2, 4.5, 7, 9])
    expected = (heights * widths * middles).sum() / (heights * widths).sum()
    assert both(rulebase, a=a, b=b) == pytest.approx(expected)


@pytest.mark.parametrize("method", ["centroid", "bisector", "mean-of-maximum"])
def test_a_set_needs_a_finite_range(method: str) -> None:
    rulebase = base(RULES, HILLS, method, low=-math.inf, high=math.inf)
    with pytest.raises(InferenceError, match=f"{method} needs a finite range, and that of 'u'"):
        infer(rulebase, a=0.5, b=0.5)


def test_values_need_no_finite_range() -> None:
    rulebase = base(RULES, SPIKES, "weighted-average", low=-math.inf, high=math.inf)
    assert both(rulebase, a=0.5, b=0.5) == pytest.approx(4.5)


def test_too_few_samples() -> None:
    with pytest.raises(InferenceError, match="cannot work with 1 samples"):
        infer(base(RULES, HILLS, resolution=1), a=0.5, b=0.5)


NINE = {
    name: Shape(kind, numbers)
    for name, kind, numbers in (
        ("A", "gaussian", (0.0, 1.2)), ("B", "bell", (1.5, 1.0, 2.0)),
        ("C", "pi", (1.0, 2.0, 3.0, 5.0)),
        ("D", "gaussian", (4.0, 0.8)), ("E", "cosine", (5.0, 3.0)), ("F", "sigmoid", (6.0, 4.0)),
        ("G", "spike", (7.0, 5.0)), ("H", "two-sided-gaussian", (8.0, 0.5, 8.5, 0.9)),
        ("I", "gaussian", (10.0, 1.0)),
    )
}  # fmt: skip


@pytest.mark.parametrize("aggregation", ["sum", "probor", "bounded", "drastic", "einstein"])
def test_maxima_of_nine_curved_sets_ask_for_few_heights(aggregation: str, monkeypatch) -> None:
    from fuzzyarm.inference import maxima

    asked = 0
    ordinary = maxima.aggregate

    def counted(plan, fired, **options):
        value = ordinary(plan, fired, **options)

        def height(y: float) -> float:
            nonlocal asked
            asked += 1
            return value(y)

        return height

    monkeypatch.setattr(maxima, "aggregate", counted)
    rules = [rule(f"{x} high", f"u {name}") for x, name in zip("ab" * 5, NINE, strict=False)]
    smallest = base(rules, terms(**NINE), "smallest-of-maximum", aggregation=aggregation)
    value = infer(smallest, a=0.4, b=0.7)["u"]
    assert asked < 1_500  # a search of all cells asks for 4,000 to 8,000
    heights = ordinary(maxima_plan(smallest), maxima_fired(smallest, 0.4, 0.7))
    grid = np.linspace(0.0, 10.0, 20_001)
    assert heights(value) >= max(map(heights, grid.tolist())) * (1.0 - 1e-9)
    lower = np.linspace(0.0, value - 1e-6, 2_001).tolist()
    assert all(heights(y) <= heights(value) for y in lower)


def maxima_plan(rulebase: RuleBase):
    from fuzzyarm.inference.plan import plan

    return plan(rulebase).outputs["u"]


def maxima_fired(rulebase: RuleBase, a: float, b: float):
    """Return members and strengths, by hand: each rule asks for one degree."""
    output = maxima_plan(rulebase)
    strengths = {"a": a, "b": b}
    return [
        (member, strengths[rulebase.rules[number].antecedent.variable])
        for member, number in output.contributions
    ]
