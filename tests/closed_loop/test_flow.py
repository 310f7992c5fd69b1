"""Steps of differential equations against closed forms and a fine integrator of somebody else."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.flow import Flow
from fuzzyarm.proof.loop.zonotope import Forms
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import symbol

x0, x1, u, t = map(symbol, ("x0", "x1", "u", "t"))

EQUATIONS = {
    "pendulum": ([x1, 2 * op.sin(x0) + 8 * u], lambda t, x, u: [x[1], 2 * math.sin(x[0]) + 8 * u]),
    "van der Pol": (
        [x1, (1 - x0 * x0) * x1 - x0 + u],
        lambda t, x, u: [x[1], (1 - x[0] ** 2) * x[1] - x[0] + u],
    ),
    "quotients": (
        [x1 / (2 + op.cos(x0)), op.exp(-x0) - op.tanh(x1) / (1 + x0 * x0) + u],
        lambda t, x, u: [
            x[1] / (2 + math.cos(x[0])), math.exp(-x[0]) - math.tanh(x[1]) / (1 + x[0] ** 2) + u
        ],
    ),
    "roots and logarithms": (
        [op.sqrt(2 + x0) - op.log(3 + x1), op.atan(x0) * u - x1 / 3],
        lambda t, x, u: [
            math.sqrt(2 + x[0]) - math.log(3 + x[1]), math.atan(x[0]) * u - x[1] / 3
        ],
    ),
    "hyperbolas": (
        [op.sinh(x0) - op.cosh(x1), op.tanh(x0 * x1) + u],
        lambda t, x, u: [math.sinh(x[0]) - math.cosh(x[1]), math.tanh(x[0] * x[1]) + u],
    ),
    "arcs": (
        [op.tan(x0) * op.asin(x1), op.acos(x0 * x1) - u],
        lambda t, x, u: [math.tan(x[0]) * math.asin(x[1]), math.acos(x[0] * x[1]) - u],
    ),
    "time": ([op.sin(t) + x1, u * t - x0], lambda t, x, u: [math.sin(t) + x[1], u * t - x[0]]),
    "corners": (
        [abs(x1) - x0, op.maximum(x0, 0.1) * u - op.where(x1 > 5.0, 1.0, x1)],
        lambda t, x, u: [abs(x[1]) - x[0], max(x[0], 0.1) * u - x[1]],
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", EQUATIONS)
@pytest.mark.parametrize("length", [0.02, 0.2])
def test_a_step_holds_the_solutions_at_its_end_and_on_the_way(name, length):
    rates, plain = EQUATIONS[name]
    flow = Flow(rates)
    generator = np.random.default_rng(8)
    low, high = np.array([0.3, -0.4]), np.array([0.5, -0.2])
    start = Forms.between(low[:, None], high[:, None]).with_symbols(2, [0, 1])
    drive = Forms.between([0.4], [0.6]).with_symbols(3, [2])
    step = flow.step(start, {"u": drive}, 1.0, length, 6)
    for _ in range(25):
        e = generator.uniform(-1, 1, 3)
        begin = 0.5 * (low + high) + 0.5 * (high - low) * e[:2]
        force = 0.5 + 0.1 * e[2]
        run = solve_ivp(
            lambda time, x, force=force: plain(time, x, force), (1.0, 1.0 + length), begin,
            rtol=1e-12, atol=1e-13, dense_output=True,
        )  # fmt: skip
        for share in (0.0, 0.2, 0.5, 0.9, 1.0):
            now = run.sol(1.0 + share * length)
            assert (step.between.low[:, 0] - 1e-10 <= now).all()
            assert (now <= step.between.high[:, 0] + 1e-10).all()
        middle = step.end.centre[:, 0] + np.einsum("mi,m->i", step.end.parts[:, :, 0], e)
        assert (np.abs(run.y[:, -1] - middle) <= step.end.rest[:, 0] + 1e-10).all()


def test_a_linear_step_is_exact_but_for_its_tail():
    flow = Flow([x1, -x0])
    start = Forms.between([[0.9], [-0.1]], [[1.1], [0.1]]).with_symbols(2, [0, 1])
    end = flow.step(start, {"u": Forms.at([0.0])}, 0.0, 0.1, 8).end
    c, s = math.cos(0.1), math.sin(0.1)
    assert np.allclose(end.radius[:, 0], [0.1 * (c + s)] * 2, rtol=1e-9)
    assert np.allclose(end.centre[:, 0], [c, -s], rtol=1e-12)
    assert end.rest.max() < 1e-11


def test_boxes_side_by_side_are_those_that_go_alone():
    flow = Flow(EQUATIONS["pendulum"][0])
    low, high = np.array([[0.1, 0.5], [0.0, -1.0]]), np.array([[0.3, 0.6], [0.1, 0.0]])
    both = Forms.between(low, high).with_symbols(2, [0, 1])
    together = flow.step(both, {"u": Forms.at([0.2, -0.3])}, 0.0, 0.05, 5).end
    for box, force in enumerate((0.2, -0.3)):
        alone = flow.step(both[:, box : box + 1], {"u": Forms.at([force])}, 0.0, 0.05, 5).end
        assert np.allclose(together.centre[:, box], alone.centre[:, 0], rtol=1e-14)
        assert np.allclose(together.parts[:, :, box], alone.parts[:, :, 0], rtol=1e-13)


def test_a_step_over_an_escape_is_refused():
    flow = Flow([x0 * x0])
    start = Forms.between([[1.0]], [[1.0]])
    with pytest.raises(EnclosureError), np.errstate(all="ignore"):  # infinite at 1 s
        flow.step(start, {"u": Forms.at([0.0])}, 0.0, 1.5, 5)
