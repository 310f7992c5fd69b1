"""Steps of linear equations by their matrix exponential, against the exact solution."""

import numpy as np
import pytest
from budget import cases
from scipy.linalg import expm

from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.linear_flow import linear_flow
from fuzzyarm.proof.loop.zonotope import Forms
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import symbol

X0, X1, U = symbol("x0"), symbol("x1"), symbol("u0")


def whole(a, b, f, h):
    """Return the exponential of h [A B f; 0]."""
    matrix = np.zeros((len(a) + 2, len(a) + 2))
    matrix[: len(a)] = np.column_stack([a, b, f])
    return expm(h * matrix)


@pytest.mark.slow
def test_a_step_holds_the_exact_solutions_between_its_ends_and_at_them():
    generator = np.random.default_rng(7)
    for _ in range(cases(20, 500)):
        a = generator.normal(size=(2, 2)) * generator.choice([0.1, 1.0, 20.0])
        b, f = generator.normal(size=2), generator.normal(size=2)
        rates = [float(a[i, 0]) * X0 + float(a[i, 1]) * X1 + float(b[i]) * U + float(f[i])
                 for i in range(2)]  # fmt: skip
        flow = linear_flow(rates, ["u0"])
        centre, radius = generator.normal(size=2), abs(generator.normal(size=2)) * 0.1
        start = Forms.between((centre - radius)[:, None], (centre + radius)[:, None])
        u = generator.normal()
        h = float(generator.choice([1e-3, 0.05]))
        step = flow.step(start, {"u0": Forms.at(np.array([u]))}, 0.0, h, 4)
        for _ in range(10):
            x = centre + radius * generator.uniform(-1, 1, 2)
            for share in (0.0, 0.3, 0.7, 1.0):
                exact = whole(a, b, f, share * h)[:2] @ np.array([*x, u, 1.0])
                slack = 1e-12 * (1 + np.abs(exact))
                assert (step.between.low[:, 0] - slack <= exact).all()
                assert (exact <= step.between.high[:, 0] + slack).all()
            assert (step.end.bounds.low[:, 0] - slack <= exact).all()
            assert (exact <= step.end.bounds.high[:, 0] + slack).all()
        # It is no wider than the exponential makes of the box, but for roundings.
        spread = np.abs(whole(a, b, f, h)[:2, :2]) @ radius
        assert step.end.radius[:, 0] == pytest.approx(spread, rel=1e-9)


@pytest.mark.parametrize("root", [X0 * X1, op.sin(X0), op.maximum(X0, 0.0), X0 * symbol("p0")])
def test_what_is_not_linear_is_left_to_the_series(root):
    assert linear_flow([X1, root], ["u0"]) is None


def test_a_stiff_step_is_taken_in_halves_and_bounded_near_its_solutions():
    flow = linear_flow([-50.0 * X0 + 50.0 * U, X0 - X1], ["u0"])
    start = Forms.between(np.array([[0.6], [0.0]]), np.array([[0.8], [0.1]]))
    step = flow.step(start, {"u0": Forms.at(np.array([-0.5]))}, 0.0, 1.0, 4)
    a, b = np.array([[-50.0, 0.0], [1.0, -1.0]]), np.array([50.0, 0.0])
    ends = whole(a, b, np.zeros(2), 1.0)[:2]
    for x in ([0.6, 0.0], [0.8, 0.1], [0.7, 0.03]):
        first, last = np.array(x), ends @ np.array([*x, -0.5, 1.0])
        for share in np.linspace(0.0, 1.0, 23):
            exact = whole(a, b, np.zeros(2), share)[:2] @ np.array([*x, -0.5, 1.0])
            assert (step.between.low[:, 0] <= exact + 1e-12).all()
            assert (exact <= step.between.high[:, 0] + 1e-12).all()
            bend = exact - (1.0 - share) * first - share * last
            assert (step.bend.low[:, 0] <= bend + 1e-12).all()
            assert (bend <= step.bend.high[:, 0] + 1e-12).all()
    assert step.between.low[0, 0] > -0.7
    assert step.between.high[0, 0] < 1.0


def test_a_plant_that_is_too_fast_for_its_period_is_refused():
    flow = linear_flow([-1e4 * X0 + 1e4 * U], ["u0"])
    with pytest.raises(EnclosureError, match="too fast for a control period"):
        flow.step(Forms.at(np.ones((1, 1))), {"u0": Forms.at(np.zeros(1))}, 0.0, 1.0, 4)
