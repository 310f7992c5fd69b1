"""Steps of linear equations by their matrix exponential, against the exact solution."""

import numpy as np
import pytest
from budget import cases
from scipy.linalg import expm

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
