"""What each built-in kind is, in numbers worked out by hand: the definitions have no twin."""

import math

import pytest

from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, SNORMS, TNORMS

INF = math.inf
HALF = math.exp(-0.5)

SHAPE_VALUES = [
    ("triangle", (1, 2, 4), {0.5: 0, 1: 0, 1.5: 0.5, 2: 1, 3: 0.5, 4: 0, 5: 0}),
    ("triangle", (1, 1, 2), {0.999: 0, 1: 1, 1.5: 0.5, 2: 0}),
    ("triangle", (1, 2, 2), {1.5: 0.5, 2: 1, 2.001: 0}),
    ("trapezoid", (0, 1, 2, 4), {-1: 0, 0: 0, 0.5: 0.5, 1: 1, 1.5: 1, 2: 1, 3: 0.5, 4: 0, 5: 0}),
    ("trapezoid", (-INF, 0, 1, 2), {-1e9: 1, 0: 1, 1: 1, 1.5: 0.5, 2: 0}),
    ("trapezoid", (0, 2, 3, INF), {0: 0, 1: 0.5, 2: 1, 1e9: 1}),
    ("rectangle", (1, 2), {0.999: 0, 1: 1, 1.5: 1, 2: 1, 2.001: 0}),
    ("ramp", (1, 3), {0: 0, 1: 0, 1.5: 0.25, 2: 0.5, 3: 1, 4: 1}),
    ("ramp", (3, 1), {0: 1, 1: 1, 1.5: 0.75, 3: 0, 4: 0}),
    ("ramp", (2, 2), {1.999: 0, 2: 1, 3: 1}),
    ("binary", (1, INF), {0.999: 0, 1: 1, 2: 1}),
    ("binary", (1, -INF), {0: 1, 1: 1, 1.001: 0}),
    ("singleton", (2,), {1.999: 0, 2: 1, 2.001: 0}),
    ("points", (0, 0.2, 1, 1, 1, 0.5, 3, 0), {-1: 0.2, 0.5: 0.6, 1: 1, 2: 0.25, 3: 0, 4: 0}),
    ("gaussian", (1, 2), {1: 1, 3: HALF, -1: HALF, 5: math.exp(-2)}),
    ("two-sided-gaussian", (-1, 1, 2, 0.5), {-2: HALF, -1: 1, 0: 1, 2: 1, 2.5: HALF}),
    ("two-sided-gaussian", (2, 1, -1, 1), {0.5: math.exp(-2.25)}),
    ("bell", (0, 2, 3), {0: 1, 2: 0.5, -2: 0.5, 4: 1 / 65}),
    ("sigmoid", (1, 2), {1: 0.5, 2: 1 / (1 + math.exp(-2)), 0: 1 / (1 + math.exp(2))}),
    ("sigmoid-difference", (0, 1, 2, 1), {1: math.tanh(0.5)}),
    ("sigmoid-product", (0, 1, 2, -1), {1: 1 / (1 + math.exp(-1)) ** 2}),
    ("s", (0, 4), {-1: 0, 0: 0, 1: 0.125, 2: 0.5, 3: 0.875, 4: 1, 5: 1}),
    ("s", (1, 1), {0.999: 0, 1: 1}),
    ("z", (0, 4), {-1: 1, 0: 1, 1: 0.875, 2: 0.5, 3: 0.125, 4: 0, 5: 0}),
    ("z", (1, 1), {1: 1, 1.001: 0}),
    ("pi", (0, 2, 4, 8), {0: 0, 0.5: 0.125, 1: 0.5, 2: 1, 4: 1, 5: 0.875, 6: 0.5, 8: 0}),
    ("concave", (1, 3), {-1: 1 / 3, 1: 0.5, 2: 2 / 3, 3: 1, 4: 1}),
    ("concave", (3, 1), {0: 1, 1: 1, 2: 2 / 3, 3: 0.5, 5: 1 / 3}),
    ("cosine", (0, 4), {0: 1, 1: 0.5, -1: 0.5, 2: 0, 2.5: 0}),
    ("spike", (1, 2), {1: 1, 1.2: math.exp(-1), 0.6: math.exp(-2)}),
    ("arc", (0, 1), {-1: 0, 0: 0, 0.4: 0.8, 1: 1, 2: 1}),
    ("arc", (1, 0), {0.6: 0.8, 0: 1, 1: 0}),
    ("semi-ellipse", (0, 2), {-0.5: 0, 0: 0, 0.4: 0.8, 1: 1, 1.6: 0.8, 2: 0, 3: 0}),
]

T_VALUES = {
    "min": {(0.3, 0.8): 0.3, (0.8, 0.3): 0.3},
    "product": {(0.3, 0.8): 0.24},
    "bounded": {(0.3, 0.8): 0.1, (0.3, 0.6): 0},
    "drastic": {(0.3, 0.8): 0, (1, 0.4): 0.4, (0.4, 1): 0.4},
    "hamacher": {(0.3, 0.8): 0.24 / 0.86, (0, 0): 0, (0, 0.5): 0},
    "einstein": {(0.3, 0.8): 0.24 / 1.14},
    "nilpotent": {(0.3, 0.8): 0.3, (0.3, 0.6): 0, (0.5, 0.5): 0},
}

S_VALUES = {
    "max": {(0.3, 0.8): 0.8, (0.8, 0.3): 0.8},
    "probor": {(0.3, 0.8): 0.86},
    "bounded": {(0.3, 0.8): 1, (0.3, 0.6): 0.9},
    "drastic": {(0.3, 0.8): 1, (0, 0.4): 0.4, (0.4, 0): 0.4},
    "hamacher": {(0.3, 0.8): 0.62 / 0.76, (0, 0.4): 0.4, (1, 0.2): 1, (1, 1 - 2**-53): 1},
    "einstein": {(0.3, 0.8): 1.1 / 1.24},
    "nilpotent": {(0.3, 0.8): 1, (0.3, 0.6): 0.6, (0.5, 0.5): 1},
    "sum": {(0.3, 0.8): 1.1},
    "normalized": {(0.3, 0.8): 1, (0.3, 0.6): 0.9},
}

HEDGE_VALUES = {
    "not": {0.4: 0.6},
    "very": {0.4: 0.16},
    "somewhat": {0.49: 0.7},
    "extremely": {0.4: 0.064},
    "intensify": {0.4: 0.32, 0.5: 0.5, 0.8: 0.92},
    "seldom": {0.18: 0.3, 0.5: 0.5, 0.82: 0.7},
    "any": {0: 1, 0.4: 1},
    "power": {0.4: 0.064},
}


@pytest.mark.parametrize(("kind", "parameters", "values"), SHAPE_VALUES, ids=lambda v: str(v)[:40])
def test_shapes(kind, parameters, values):
    for x, degree in values.items():
        found = SHAPES[kind].scalar(float(x), *map(float, parameters))
        assert found == pytest.approx(degree, abs=1e-14), x


def test_every_shape_is_here():
    fuzzy = {name for name, kind in SHAPES.items() if kind.fuzzy and not kind.own}
    assert fuzzy == {kind for kind, _, _ in SHAPE_VALUES}


@pytest.mark.parametrize(
    ("registry", "table"), [(TNORMS, T_VALUES), (SNORMS, S_VALUES)], ids=["T", "S"]
)
def test_norms(registry, table):
    assert {name for name, kind in registry.items() if not kind.own} == set(table)
    for name, values in table.items():
        for (a, b), degree in values.items():
            assert registry[name].scalar(float(a), float(b)) == pytest.approx(degree, abs=1e-15)


def test_hedges():
    assert {name for name, kind in HEDGES.items() if not kind.own} == set(HEDGE_VALUES)
    for name, values in HEDGE_VALUES.items():
        numbers = (3.0,) if HEDGES[name].parameters else ()
        for d, degree in values.items():
            assert HEDGES[name].scalar(float(d), *numbers) == pytest.approx(degree, abs=1e-15)
