"""A plant over a control period by mean slopes, beside a fine integrator of somebody else."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from budget import cases
from scipy.integrate import solve_ivp

import fuzzyarm
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.check.motion import around_motion, end_of_motion, parameters_of
from fuzzyarm.proof.check.numbers import precisely
from fuzzyarm.proof.check.spans import Spans
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop.mean_flow import MeanFlow
from fuzzyarm.proof.loop.zonotope import Forms


def _cartpole(x: np.ndarray, u: float) -> list[float]:
    sine, cosine = math.sin(x[2]), math.cos(x[2])
    force = (u + 0.05 * x[3] ** 2 * sine) / 1.1
    angular = (9.8 * sine - cosine * force) / (0.5 * (4 / 3 - 0.1 * cosine**2 / 1.1))
    return [x[1], force - 0.05 * angular * cosine / 1.1, x[3], angular]


def _tanks(x: np.ndarray, u: float) -> list[float]:
    flows = [1.8e-5 * math.sqrt(2 * 9.81 * max(level, 0.0)) for level in x]
    return [(4.5e-6 * u - flows[0]) / 0.0015, (flows[0] - flows[1]) / 0.0015]


def _ball(x: np.ndarray, u: float) -> list[float]:
    return [x[1], (x[0] * u**2 + 9.81 * math.sin(x[2])) / 1.4, u]


PLANTS: dict[str, tuple[Callable[..., list[float]], list[float], list[float], float]] = {
    "cartpole": (_cartpole, [-1, -2, -0.4, -2], [1, 2, 0.4, 2], 10.0),
    "tanks": (_tanks, [0.01, 0.01], [0.3, 0.3], 12.0),
    "ball-and-beam": (_ball, [-0.5, -1, -0.5], [0.5, 1, 0.5], 2.0),
}
"""Equations written anew, between which states, and the largest input."""


def problem(name: str) -> LoopProblem:
    claim = LoopClaim(name, stable=True, at=(("level2", 0.2),) if name == "tanks" else ())
    text = fuzzyarm.load_controller(fuzzyarm.shipped(f"{name}.frb"))
    return problem_of(text, claim)


@pytest.mark.parametrize("name", PLANTS)
def test_a_period_holds_the_solutions_and_keeps_what_states_share(name: str) -> None:
    rates, low, high, most = PLANTS[name]
    loop = problem(name)
    generator = np.random.default_rng(11)
    count, sets = len(low), 20
    wide = np.array(high) - np.array(low)
    half = 0.03 * wide[:, None] * generator.uniform(0, 1, (count, sets))
    middle = (
        np.array(low)[:, None]
        + half
        + generator.uniform(0, 1, (count, sets)) * (wide[:, None] - 2 * half)
    )
    states = Forms.between(middle - half, middle + half).with_symbols(count + 1, range(count))
    held = most * generator.uniform(0 if name == "tanks" else -0.9, 0.9, sets)
    inputs = Forms.between(held[None] - 0.1, held[None] + 0.1)
    inputs = inputs.with_symbols(count + 1, [count])
    ends = MeanFlow(loop).ends(states, inputs)
    start = Forms(states.centre, states.parts, states.rest)
    for k in range(sets):
        for _ in range(cases(3, 100)):
            symbols = generator.choice([-1.0, 1.0, 0.0, 0.4], count + 1)
            x = start.centre[:, k] + (start.parts[:, :, k] * symbols[:, None]).sum(axis=0)
            u = float(held[k] + 0.1 * symbols[-1])
            run = solve_ivp(
                lambda _, x, u=u: rates(x, u), (0.0, loop.period), x, rtol=1e-11, atol=1e-13
            )
            # At the same symbols: within what has no symbol.
            line = ends.centre[:, k] + (ends.parts[:, :, k] * symbols[:, None]).sum(axis=0)
            assert (np.abs(run.y[:, -1] - line) <= ends.rest[:, k] + 1e-9).all()
    assert (ends.rest <= 0.25 * ends.spread + 2e-3 * wide[:, None]).all()


def test_a_set_is_as_it_is_alone_and_one_without_slopes_has_no_bound() -> None:
    """The root of a level has no slope at 0; the set beside it does not notice."""
    loop = problem("tanks")
    flow = MeanFlow(loop)
    low, high = np.array([[0.1, 0.0], [0.2, 0.1]]), np.array([[0.11, 0.01], [0.21, 0.11]])
    inputs = Forms.between(np.full((1, 2), 2.0), np.full((1, 2), 2.5))
    both = flow.ends(Forms.between(low, high), inputs)
    alone = flow.ends(Forms.between(low[:, :1], high[:, :1]), inputs[:, :1])
    assert not np.isfinite(both.radius[:, 1]).all()
    assert (both.centre[:, 0] == alone.centre[:, 0]).all()
    assert (both.rest[:, 0] == alone.rest[:, 0]).all()


@precisely
def test_of_many_motions_those_that_are_not_enclosed_are_told() -> None:
    """x' = x² is beyond all bounds soon after it begins at a large number."""
    loop = problem("cartpole")
    names = (*loop.equations.states, *loop.equations.inputs)
    at = {name: Spans(np.zeros(2), np.zeros(2)) for name in names}
    at[names[3]] = Spans(np.array([0.0, 1e200]), np.array([0.1, 1e200]))
    box = around_motion(loop, parameters_of(loop) | at)
    ends = end_of_motion(loop, parameters_of(loop) | at)
    for found in (*(box[name] for name in loop.equations.states), *ends):
        low, high = (np.broadcast_to(x, 2) for x in (found.low, found.high))
        assert np.isfinite([low[0], high[0]]).all()
    assert not all(np.isfinite(box[name].low).all() for name in loop.equations.states)
