"""The mathematics of learning against independent computations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import check_grad

from fuzzyarm import infer, kinds
from fuzzyarm.learning.data import as_samples
from fuzzyarm.learning.model_text import WritingStyle, sugeno_rulebase, term_names
from fuzzyarm.learning.starts import (
    cluster_premises,
    fuzzy_c_means,
    grid_premises,
    merged,
    pruned,
    subtractive_clusters,
)
from fuzzyarm.learning.sugeno import Projection, consequents, optimised, predicted
from fuzzyarm.learning.wang_mendel import proposals, wang_mendel

RANDOM = np.random.default_rng(5)
X = RANDOM.uniform(-1.0, 2.0, (80, 2))
Y = np.sin(2.0 * X[:, 0]) * X[:, 1] + 0.1 * X[:, 1] ** 2


def some_premises():
    centres, deviations = fuzzy_c_means(X, 3)
    return [
        grid_premises(X, (2, 2)),
        grid_premises(X, (3, 1)),
        cluster_premises(X, centres, deviations),
    ]


@pytest.mark.parametrize("premises", some_premises(), ids=["sigmoids", "products", "gaussians"])
def test_gradients_are_those_of_differences_of_the_rule_base(premises):
    """Central differences of `infer` on the rule base as it would be written."""
    samples = as_samples(X, Y)
    weights, scaling = consequents(premises, X, Y[:, None], 1e-4)
    values = scaling.in_units(weights)[:, 0]
    at = X[:7]
    rows = np.column_stack([at, np.ones(len(at))]) @ values.T
    slopes = premises.jacobian(at, rows)
    exact = sugeno_rulebase(premises, samples, 1e-4, np.array([1e-9]), WritingStyle(digits=12))

    def outputs(numbers):
        moved = premises.with_numbers(numbers)
        inputs = []
        names = {k: iter(term_names(sum(t.input == k for t in moved.terms))) for k in range(2)}
        shapes = {(t.input, next(names[t.input])): moved.parameters(t) for t in moved.terms}
        for k, variable in enumerate(exact.inputs):
            terms = tuple(
                replace(t, shape=replace(t.shape, parameters=shapes[k, t.name]))
                for t in variable.terms
            )
            inputs.append(replace(variable, terms=terms))
        moved_base = replace(exact, inputs=tuple(inputs))
        return infer(moved_base, x1=at[:, 0], x2=at[:, 1])["y"]

    for k in range(len(premises.numbers)):
        step = np.zeros(len(premises.numbers))
        step[k] = 1e-5 * max(1.0, abs(premises.numbers[k]))
        difference = outputs(premises.numbers + step) - outputs(premises.numbers - step)
        assert np.allclose(slopes[:, k], difference / (2.0 * step[k]), rtol=1e-4, atol=2e-6)


def test_the_jacobian_of_the_projection_leads_downhill():
    """Kaufman's Jacobian gives the exact gradient of the cost."""
    projection = Projection(grid_premises(X, (2, 2)), X, Y[:, None], 1e-3)
    start = projection.premises.numbers * 1.1

    def cost(numbers):
        return 0.5 * float(np.sum(projection.residual(numbers) ** 2))

    def slope(numbers):
        return projection.jacobian(numbers).T @ projection.residual(numbers)

    assert check_grad(cost, slope, start) < 1e-5 * max(1.0, np.abs(slope(start)).max())


@pytest.mark.parametrize("shrinkage", [1e-6, 1e-2, 10.0])
def test_consequents_are_those_of_one_large_least_squares(shrinkage, monkeypatch):
    """The penalised problem written out, with the linear part free; rows taken in turns."""
    from fuzzyarm.learning import sugeno

    premises = grid_premises(X, (2, 2))
    monkeypatch.setattr(sugeno, "_ROWS", 17)
    weights, scaling = consequents(premises, X, Y[:, None], shrinkage)
    regressors, wanted = scaling.regressors(X), scaling.scaled(Y[:, None])
    strengths = premises.strengths(X)
    own = np.concatenate([strengths[:, [r]] * regressors for r in range(4)], axis=1)
    penalty = np.sqrt(shrinkage * len(X)) * np.eye(12)
    matrix = np.block([[regressors, own], [np.zeros((12, 3)), penalty]])
    found = np.linalg.lstsq(matrix, np.vstack([wanted, np.zeros((12, 1))]), rcond=None)[0]
    expected = regressors @ found[:3] + own @ found[3:]
    assert np.allclose(predicted(premises, weights, regressors, X), expected, atol=1e-6)


def test_much_shrinkage_is_linear_regression():
    weights, _ = consequents(grid_premises(X, (2, 2)), X, Y[:, None], 1e9)
    linear, _ = consequents(grid_premises(X, (1, 1)), X, Y[:, None], 0.0)
    assert np.allclose(weights, linear, atol=1e-6)


def test_a_partition_always_makes_one():
    premises = grid_premises(X, (2, 1))
    degrees = premises.degrees(X)
    assert np.allclose(degrees.sum(axis=1), 1.0)
    moved, finished = optimised(premises, X, Y[:, None], 1e-4)
    assert finished
    assert np.allclose(moved.degrees(X).sum(axis=1), 1.0)


def test_moving_terms_finds_a_corner():
    x = np.linspace(0.0, 1.0, 101)[:, None]
    y = np.abs(x - 0.3)
    moved, _ = optimised(grid_premises(x, (2,)), x, y, 1e-6)
    assert moved.numbers[0] == pytest.approx(0.3, abs=0.01)


def test_the_best_is_kept_when_the_search_is_interrupted():
    calls = []

    def interrupt(cost):
        calls.append(cost)
        if len(calls) == 4:
            raise KeyboardInterrupt

    start = grid_premises(X, (2, 2))
    moved, finished = optimised(start, X, Y[:, None], 1e-4, on_step=interrupt)
    assert not finished
    costs = [
        np.sum(Projection(each, X, Y[:, None], 1e-4).residual(each.numbers) ** 2)
        for each in (start, moved)
    ]
    assert costs[1] < costs[0]


def test_a_kind_of_the_users_own_can_be_moved():
    from fuzzyarm import op

    kinds.shape(
        "test-cauchy", ("centre", "width"), lambda x, c, w: 1 / (1 + ((x - c) / w) ** 2),
        positive=("width",),
    )  # fmt: skip
    try:
        centres, deviations = fuzzy_c_means(X, 3)
        start = cluster_premises(X, centres, deviations)
        start = replace(start, terms=tuple(t._replace(kind="test-cauchy") for t in start.terms))
        moved, _ = optimised(start, X, Y[:, None], 1e-4)
        assert not np.array_equal(moved.numbers, start.numbers)
        assert op.pi
    finally:
        kinds.SHAPES.remove("test-cauchy")


@pytest.mark.parametrize(
    "find", [lambda x: fuzzy_c_means(x, 3), lambda x: subtractive_clusters(x, 0.5, 9)]
)
def test_clusters_are_found(find):
    middles = np.array([[0.0, 0.0], [10.0, 1.0], [0.0, 2.0]])
    points = np.concatenate([m + RANDOM.normal(0, 0.05, (40, 2)) * [5.0, 1.0] for m in middles])
    centres, _ = find(points)
    assert len(centres) == 3
    apart = np.abs(centres[:, None] - middles[None]) / [10.0, 2.0]
    assert apart.max(axis=2).min(axis=0).max() < 0.06


def test_like_terms_become_one_and_rules_without_samples_go():
    centres = np.array([[0.0, 0.0], [0.02, 1.0], [1.0, 1.0]])
    premises = cluster_premises(X, centres, np.full((3, 2), 0.3))
    fewer = merged(premises, 0.8)
    assert [sum(t.input == k for t in fewer.terms) for k in range(2)] == [2, 2]
    assert len(fewer.rules) == 3
    far = cluster_premises(X, np.array([[0.0, 0.0], [2.0, 2.0]]), np.full((2, 2), 0.3))
    inside = X[np.hypot(*X.T) < 0.5]
    assert len(pruned(far, inside).rules) == 1


def test_the_strongest_proposal_stays():
    inputs = np.array([[0.0], [0.1], [1.0], [0.96]])
    found = proposals(inputs, np.array([0.0, 1.0, 1.0, 0.5]), [(0.0, 1.0), (0.0, 1.0)], 3)
    assert found.antecedents.tolist() == [[0], [2]]
    assert found.conclusions.tolist() == [0, 2]
    assert found.support.tolist() == [2, 2]


def test_a_rule_base_of_words_goes_through_the_middles_of_its_words():
    grid = np.linspace(0.0, 1.0, 5)
    rulebase, support = wang_mendel(as_samples(grid, 1.0 - grid), 5, WritingStyle())
    assert support.tolist() == [1] * 5
    assert np.allclose(infer(rulebase, x1=grid)["y"], 1.0 - grid)


@pytest.mark.parametrize("count", range(1, 40))
def test_names_of_terms_are_different(count):
    assert len(set(term_names(count))) == count
