"""The form of a loop, on which certificates stand, against the kernel that `simulate` runs."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise, product

import numpy as np
import pytest
from budget import cases
from scipy.optimize import linprog

from fuzzyarm.proof.check.loop import checked_loop
from fuzzyarm.proof.check.numbers import exact, is_zero
from fuzzyarm.proof.check.region import refutation
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import read_claim
from fuzzyarm.proof.loop.affine import AffineAlgebra, NotAffineError
from fuzzyarm.proof.loop.runs import run_of
from fuzzyarm.proof.loop.witnesses import contradiction
from fuzzyarm.symbolic.nodes import apply, constant


@pytest.fixture(scope="module")
def loop(servo, servo_verdict):
    certificate = servo_verdict.certificate.region
    problem = problem_of(servo, read_claim("stable", "motor"))
    form = checked_loop(problem, certificate.states, certificate.evidence)
    return servo, problem, form, certificate


def floats(matrix):
    return np.array([[float(x) for x in row] for row in matrix])


def samples(problem, certificate, count):
    """Return states of runs from within the region, and the states a period later."""
    p = floats(certificate.p)
    root = np.linalg.inv(np.linalg.cholesky(p)).T
    generator = np.random.default_rng(5)
    pairs = []
    for _ in range(count):
        way = generator.standard_normal(len(p))
        way *= generator.uniform() / np.linalg.norm(way)
        start = dict(zip(problem.states, map(float, root @ way), strict=True))
        run = run_of(problem, start, {}, steps=8, duration=4 * problem.period)
        z = np.array([run.outputs[name] for name in problem.states]).T
        pairs += list(pairwise(z[:3]))
    return pairs


def misfit(form, pairs):
    """Return how far, in shares of the states, the worst period is from all that a form allows."""
    size, blocks = form.size, floats(form.blocks)
    a, b = np.split(floats(form.move), [size], axis=1)
    count = len(blocks)
    worst = 0.0
    for z, after in pairs:
        scale = np.abs(a) @ np.abs(z)
        best = np.inf
        # |w| ≤ |v| with v = C z + D w is linear in w once the sign of each v is chosen.
        for signs in product((1.0, -1.0), repeat=count):
            rows, limits = [], []
            for k, sign in enumerate(signs):
                along = sign * blocks[k, size:]
                own = np.eye(count)[k]
                fixed = float(sign * (blocks[k, :size] @ z))
                rows += [[*(own - along), 0.0], [*(-own - along), 0.0]]
                limits += [fixed, fixed]
            left = after - a @ z
            for i in range(size):
                rows += [[*b[i], -scale[i]], [*(-b[i]), -scale[i]]]
                limits += [left[i], -left[i]]
            found = linprog(
                [*np.zeros(count), 1.0], rows, limits, bounds=[(None, None)] * count + [(0, None)]
            )
            if found.success:
                best = min(best, found.fun)
        worst = max(worst, best)
    return worst


def with_entry(matrix, i, j, factor):
    rows = [list(row) for row in matrix]
    rows[i][j] *= factor
    return rows


@pytest.mark.slow
def test_every_period_of_simulate_is_one_of_the_form(loop):
    _, problem, form, certificate = loop
    assert misfit(form, samples(problem, certificate, cases(15, 1000))) < 1e-7


@pytest.mark.slow
def test_a_damaged_form_is_seen(loop):
    _, problem, form, certificate = loop
    pairs = samples(problem, certificate, 10)
    size = form.size
    for i, j in product(range(size), range(size)):
        if not is_zero(form.move[i][j]):
            damaged = replace(form, move=with_entry(form.move, i, j, exact(1.125)))
            assert misfit(damaged, pairs) > 1e-5, ("a", i, j)
    narrow = [[*(x / 4 for x in row[:size]), *row[size:]] for row in form.blocks]
    assert misfit(replace(form, blocks=narrow), pairs) > 1e-5


@pytest.mark.slow
def test_a_form_of_another_loop_is_contradicted_by_runs(loop):
    text, problem, form, certificate = loop
    assert contradiction(problem, form, certificate) == ""
    slow = replace(text, model=replace(text.model, period=0.08))  # unstable
    assert refutation(form, certificate.p, certificate.multipliers) == ""  # as if it were this one
    other = problem_of(slow, read_claim("stable", "motor"))
    assert "the run from" in contradiction(other, form, certificate)


@pytest.mark.slow
def test_a_function_that_rises_is_contradicted(loop):
    _, problem, form, certificate = loop
    tilted = [list(row) for row in certificate.p]
    tilted[0][1] = tilted[1][0] = -tilted[0][1]  # V rises along most runs
    damaged = replace(certificate, p=tuple(map(tuple, tilted)))
    assert "lets V rise" in contradiction(problem, form, damaged)


@pytest.mark.parametrize(
    ("function", "at", "value"),
    [
        ("sqrt", 2.25, Fraction(3, 2)), ("sqrt", 0.0, 0), ("cos", 0.0, 1), ("sin", 0.0, 0),
        ("absolute", -0.25, Fraction(1, 4)), ("negation", 0.0, 1),
    ],
)  # fmt: skip
def test_a_function_of_a_number_is_exact_where_it_is_rational(function, at, value):
    form = AffineAlgebra(None, None).expression(apply(function, constant(at)), {})
    assert (form.constant, form.parts) == (value, {})


@pytest.mark.parametrize(("function", "at"), [("sqrt", 2.0), ("sqrt", -4.0), ("cos", 0.5)])
def test_a_function_that_is_not_rational_there_is_refused(function, at):
    with pytest.raises(NotAffineError, match="is not rational"):
        AffineAlgebra(None, None).expression(apply(function, constant(at)), {})
