"""What the records of norms and hedges state beside the formula is true of the formula."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_definitions import SHAPE_VALUES

from fuzzyarm.symbolic.evaluation import has_value
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS
from fuzzyarm.symbolic.nodes import apply, symbol

degree = st.floats(0.0, 1.0)
TENTHS = [k / 10 for k in range(11)]
LINED = [name for name, kind in TNORMS.items() if kind.lines is not None]


def test_lines_are_stated():
    assert LINED == ["min", "product", "bounded"]


@pytest.mark.parametrize("name", LINED)
@given(strength=degree, membership=degree)
def test_an_implication_is_the_least_of_its_lines_and_never_negative(name, strength, membership):
    lines = TNORMS[name].lines(strength)
    least = min(offset + slope * membership for offset, slope in lines)
    found = TNORMS[name].scalar(strength, membership)
    assert found == pytest.approx(max(0.0, least), abs=1e-15)


@pytest.mark.parametrize("name", TNORMS)
def test_a_positive_norm_vanishes_only_with_an_operand(name):
    above = [TNORMS[name].scalar(a, b) > 0.0 for a in TENTHS[1:] for b in TENTHS[1:]]
    assert TNORMS[name].positive == all(above)


@pytest.mark.parametrize("name", TNORMS)
def test_a_norm_that_leaves_ones_vanishes_below_one(name):
    norm, below = TNORMS[name].scalar, [*TENTHS[:-1], 1.0 - 2.0**-53]
    vanishes = all(norm(cut, degree) == 0.0 for cut in below for degree in below)
    assert TNORMS[name].leaves_ones == vanishes


def test_what_is_for_aggregation_alone():
    assert [name for name, kind in SNORMS.items() if kind.aggregates] == ["sum", "normalized"]


def hedge_of(name):
    kind = HEDGES[name]
    numbers = (3.0,) if kind.parameters else ()
    return lambda d: kind.scalar(d, *numbers)


@pytest.mark.parametrize("name", HEDGES)
def test_a_straight_hedge_is_a_line(name):
    hedge = hedge_of(name)
    triples = itertools.combinations(TENTHS, 2)
    bent = [abs(hedge((a + b) / 2) - (hedge(a) + hedge(b)) / 2) for a, b in triples]
    assert HEDGES[name].straight == (max(bent) < 1e-12)


@pytest.mark.parametrize("name", HEDGES)
def test_the_curvature_jumps_at_the_bends_and_nowhere_else(name):
    hedge, step = hedge_of(name), 1e-3

    def curvature(d):
        return (hedge(d + step) - 2 * hedge(d) + hedge(d - step)) / step**2

    inner = [k / 20 for k in range(2, 19)]
    jumps = [d for d in inner if abs(curvature(d + 2 * step) - curvature(d - 2 * step)) > 0.5]
    assert jumps == list(HEDGES[name].bends)


SAMPLES = [(kind, numbers) for kind, numbers, _ in SHAPE_VALUES]
SAMPLES += [("sigmoid", (1, -50)), ("bell", (1, 2, 0.5))]
CASES = [pytest.param(SHAPES[kind], numbers, id=f"{kind} {numbers}") for kind, numbers in SAMPLES]


def on(x):
    """Return a position that formulas take: far out where it is infinite."""
    return min(1e6, max(-1e6, x))


@pytest.mark.parametrize(("kind", "numbers"), CASES)
def test_inverses_find_their_degree(kind, numbers):
    if kind.position_of is None:
        return
    for wanted in (0.0, 0.01, 0.25, 0.5, 0.75, 0.99, 1.0):
        x = kind.position_of(wanted, *map(float, numbers))
        found = kind.scalar(on(x), *map(float, numbers))
        # Beyond a step there is no degree between.
        assert found == pytest.approx(wanted, abs=1e-5) or numbers[0] == numbers[1]


@pytest.mark.parametrize(("kind", "numbers"), CASES)
def test_a_centre_is_the_middle_of_the_core(kind, numbers):
    if kind.centre is None or not all(map(math.isfinite, numbers)):
        return
    wide = 3.0 * max(map(abs, numbers))
    x = np.union1d(np.linspace(-wide, wide, 4001), numbers)
    degrees = np.array([kind.scalar(each, *map(float, numbers)) for each in x.tolist()])
    core = x[degrees >= degrees.max() - 1e-12]
    step = np.diff(x).max()
    assert kind.centre(*numbers) == pytest.approx(0.5 * (core[0] + core[-1]), abs=step)


@pytest.mark.parametrize(("kind", "numbers"), CASES)
def test_between_two_bends_a_curve_goes_half_its_way_at_most_and_none_beyond(kind, numbers):
    if kind.bends is None:
        return
    degree = [kind.scalar(x, *map(float, numbers)) for x in sorted(kind.bends(*numbers))]
    if kind.name == "cosine":  # it ends, and its bends are its ends and its centre
        assert degree == pytest.approx([0.0, 1.0, 0.0])
        return
    assert max(abs(a - b) for a, b in itertools.pairwise(degree)) < 0.505
    low, high = min(kind.bends(*numbers)), max(kind.bends(*numbers))
    for end, far in ((low, low - 1e4), (high, high + 1e4)):
        assert kind.scalar(far, *numbers) == pytest.approx(kind.scalar(end, *numbers), abs=0.13)


WITHOUT_CLOSED_FORM = {"sigmoid-difference", "sigmoid-product"}


@pytest.mark.parametrize(("kind", "numbers"), CASES)
def test_between_two_turns_a_shape_only_rises_or_only_falls(kind, numbers):
    if kind.name in WITHOUT_CLOSED_FORM or numbers == (2, 1, -1, 1):  # the last: crossed means
        return
    turns = numbers if kind.turns is None else kind.turns(*numbers)
    inner = sorted({on(x) for x in turns})
    for low, high in itertools.pairwise([inner[0] - 20.0, *inner, inner[-1] + 20.0]):
        beside = 1e-9 * (high - low)  # an edge belongs to the higher side
        x = np.linspace(low + beside, high - beside, 200)
        steps = np.diff([kind.scalar(each, *map(float, numbers)) for each in x.tolist()])
        assert (steps >= -1e-12).all() or (steps <= 1e-12).all(), (low, high)


def test_squares_and_cubes_are_products():
    x = symbol("x")
    assert x**2 is x * x
    assert x**3 is x * x * x
    assert x**4 is not x * x * x * x


IN_ORDER = {
    "triangle": (0, 2, 1), "trapezoid": (0, 2, 1, 3), "rectangle": (2, 1), "pi": (0, 2, 1, 3),
    "s": (2, 1), "z": (2, 1),
}  # fmt: skip


@pytest.mark.parametrize("kind", IN_ORDER)
def test_places_from_left_to_right_must_not_decrease(kind):
    which, message = SHAPES[kind].fault(IN_ORDER[kind])
    assert message == f"the numbers of a {kind} must not decrease"
    assert IN_ORDER[kind][which] < IN_ORDER[kind][which - 1]
    assert SHAPES[kind].fault(sorted(IN_ORDER[kind])) is None


@pytest.mark.parametrize("kind", ["ramp", "arc"])
def test_a_flank_may_fall(kind):
    assert SHAPES[kind].fault((2, 1)) is None


def test_only_what_is_no_mean_leaves_the_positions_of_its_sets():
    leaving = {name for name, kind in DEFUZZIFIERS.items() if not kind.is_between}
    assert leaving == {"weighted-sum", "tsukamoto", "farthest-of-maximum"}


@pytest.mark.parametrize("operation", ["divide", "remainder"])
def test_a_quotient_has_a_value_where_its_divisor_cannot_be_0(operation):
    root = apply(operation, 1.0, symbol("y"))
    for low, high in ((0.5, 1.0), (-1.0, -0.5)):
        assert has_value(root, {"y": (low, high)})
    for low, high in ((0.0, 1.0), (-1.0, 0.0), (-1.0, 1.0), (0.0, 0.0)):
        assert not has_value(root, {"y": (low, high)})
