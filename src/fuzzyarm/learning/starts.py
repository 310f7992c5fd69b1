"""Where a Takagi–Sugeno model begins: a partition of the inputs into terms, and rules over them.

- a **grid**: two or more terms of each relevant input, a rule for each combination. Neighbouring
  terms share the number at which they cross, so that LOW and HIGH always sum to 1;
- **fuzzy c-means** (J. C. Bezdek, 1981): clusters of the samples, each a rule with a gaussian
  of each input;
- **subtractive clustering** (S. L. Chiu, 1994): samples with many neighbours as centres; their
  number follows from the radius.

To add a start, write a function that returns `Premises` of any smooth kinds: their derivatives are
read from the expressions. :mod:`.structure` chooses by cross-validation, :mod:`.fit` is the whole
way, and the score is that of the text read back. ``benchmarks/learning.py`` measures a change of
methods.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.learning.sugeno import Array, Premises, TermOf

STEEPEST = 40.0
"""Slope of a crossing times the width of its input; then it is nearly a step."""

FLATTEST = 1.0
"""The same for a crossing that is hardly one."""

EVEN_SLOPE = 8.0 * math.log(2.0)
"""Slope times distance at which a partition equals that of gaussians that cross at one half."""

NARROWEST, WIDEST = 0.08, 2.0
"""Deviations of gaussians, in widths of their input."""


def widths_of(inputs: Array) -> tuple[Array, Array]:
    """Return the lowest value of each input, and its range of variation (1 if constant)."""
    low = inputs.min(axis=0)
    width = inputs.max(axis=0) - low
    return low, np.where(width > 1e-12 * np.abs(low), width, 1.0)


def grid_premises(inputs: Array, counts: Sequence[int]) -> Premises:
    """Return evenly spread terms, and a rule for each combination of them.

    Parameters
    ----------
    inputs : ndarray, shape (samples, inputs)
        Inputs whose ranges are divided.
    counts : sequence of int
        Terms of each input; with 1 it occurs in the consequents only.

    Returns
    -------
    Premises
        The outer terms are sigmoids, those between products of two; a crossing has two
        numbers, where and how steep, which both neighbours use.
    """
    low, width = widths_of(inputs)
    terms: list[TermOf] = []
    numbers: list[float] = []
    bounds: list[tuple[float, float, float]] = []  # lower, upper, scale
    groups: list[range] = []
    for k, count in enumerate(counts):
        if count < 2:
            continue
        # Terms have their middles at even steps, and cross half-way between them.
        step = float(width[k]) / (count - 1)
        start = len(numbers)
        for i in range(count - 1):
            numbers += [float(low[k]) + (i + 0.5) * step, EVEN_SLOPE / step]
            # Each crossing in its own part: terms keep their order by construction.
            bounds.append((float(low[k]) + i * step, float(low[k]) + (i + 1) * step, step))
            steepest = max(STEEPEST, 1.5 * EVEN_SLOPE * (count - 1)) / float(width[k])
            bounds.append((FLATTEST / float(width[k]), steepest, EVEN_SLOPE / step))
        groups.append(range(len(terms), len(terms) + count))
        terms += [_between(k, start, i, count) for i in range(count)]
    lower, upper, scale = np.array(bounds).reshape(-1, 3).T
    rules = tuple(product(*groups))
    return Premises(tuple(terms), rules, np.array(numbers), lower, upper, scale)


def _between(variable: int, start: int, index: int, count: int) -> TermOf:
    """Return the term after crossing `index` - 1 and before crossing `index`."""
    rises = ((start + 2 * index - 2, 1.0), (start + 2 * index - 1, 1.0))
    falls = ((start + 2 * index, 1.0), (start + 2 * index + 1, -1.0))
    if index == 0:
        return TermOf(variable, "sigmoid", falls)
    if index == count - 1:
        return TermOf(variable, "sigmoid", rises)
    return TermOf(variable, "sigmoid-product", (*rises, *falls))


def cluster_premises(inputs: Array, centres: Array, deviations: Array) -> Premises:
    """Return a rule for each cluster, with a gaussian of each input that varies.

    Parameters
    ----------
    inputs : ndarray, shape (samples, inputs)
        Inputs whose ranges bound the numbers.
    centres, deviations : ndarray, shape (clusters, inputs)
        Means and standard deviations of the gaussians.
    """
    low, width = widths_of(inputs)
    varying = [k for k in range(inputs.shape[1]) if np.ptp(inputs[:, k]) > 0.0]
    order = [(k, c) for k in varying for c in np.argsort(centres[:, k], kind="stable").tolist()]
    index = {key: i for i, key in enumerate(order)}
    terms = tuple(
        TermOf(k, "gaussian", ((2 * i, 1.0), (2 * i + 1, 1.0))) for (k, _), i in index.items()
    )
    rules = tuple(tuple(index[k, c] for k in varying) for c in range(len(centres)))
    numbers = np.array([[centres[c, k], deviations[c, k]] for k, c in order]).ravel()
    lower = np.array([[low[k], NARROWEST * width[k]] for k, _ in order]).ravel()
    upper = np.array([[low[k] + width[k], WIDEST * width[k]] for k, _ in order]).ravel()
    scale = np.array([[width[k], 0.3 * width[k]] for k, _ in order]).ravel()
    return Premises(terms, rules, np.clip(numbers, lower, upper), lower, upper, scale)


def fuzzy_c_means(
    inputs: Array, count: int, seed: int = 0, rounds: int = 100
) -> tuple[Array, Array]:
    """Return the centres of `count` clusters and their deviations, in the units of the inputs.

    Parameters
    ----------
    inputs : ndarray, shape (samples, inputs)
        Each input is scaled to its width; the fuzzifier is 2.
    count : int
        Clusters, fewer than samples.
    seed : int
        Seed of the initial centres (k-means++: samples far from each other).
    rounds : int
        At most.
    """
    low, width = widths_of(inputs)
    scaled = (inputs - low) / width
    centres = _spread_out(scaled, count, np.random.default_rng(seed))
    weights = np.empty((len(scaled), count))
    for _ in range(rounds):
        apart = np.maximum(_squared_distances(scaled, centres), 1e-18)
        # Membership with the fuzzifier m = 2: 1/d² as a share of its sum, squared as a weight.
        share = 1.0 / apart
        weights = (share / share.sum(axis=1, keepdims=True)) ** 2
        new_centres = weights.T @ scaled / weights.sum(axis=0)[:, None]
        if np.abs(new_centres - centres).max() < 1e-6:
            break
        centres = new_centres
    mass = weights.sum(axis=0)[:, None]
    # E x² − (E x)², which rounding may take below 0.
    variance = (weights.T @ scaled**2 / mass) - centres**2
    return low + centres * width, np.sqrt(np.maximum(variance, 0.0)) * width


def _squared_distances(points: Array, centres: Array) -> Array:
    values: Array = ((points[:, None, :] - centres[None, :, :]) ** 2).sum(axis=2)
    return values


def _spread_out(points: Array, count: int, draw: np.random.Generator) -> Array:
    """Return points drawn with probabilities proportional to squared distances from those drawn."""
    indices = [int(draw.integers(len(points)))]
    for _ in range(count - 1):
        apart = _squared_distances(points, points[indices]).min(axis=1)
        total = apart.sum()
        shares: NDArray[np.float64] | None = apart / total if total > 0.0 else None
        indices.append(int(draw.choice(len(points), p=shares)))
    return points[indices]


def subtractive_clusters(inputs: Array, radius: float, most: int) -> tuple[Array, Array]:
    """Return centres among the samples, and their deviations, in the units of the inputs.

    Parameters
    ----------
    inputs : ndarray, shape (samples, inputs)
        Each input is scaled to its width.
    radius : float
        Radius of neighbourhood, in widths; a smaller one gives more clusters.
    most : int
        Clusters.

    Notes
    -----
    With Chiu's numbers: a centre lowers the potential around it within 1.5 radii; a
    candidate with more than 0.5 of the first potential is taken, with less than 0.15 the
    search ends, and between the two it must be far enough from the others.
    """
    low, width = widths_of(inputs)
    scaled = (inputs - low) / width
    potential = np.zeros(len(scaled))
    # By rows: all distances at once would be samples² numbers.
    for rows in np.array_split(np.arange(len(scaled)), max(1, len(scaled) // 512)):
        near = np.exp(-4.0 / radius**2 * _squared_distances(scaled[rows], scaled))
        potential[rows] = near.sum(axis=1)
    first = potential.max()
    centres: list[int] = []
    while len(centres) < most:
        best = int(potential.argmax())
        share = potential[best] / first
        if share < 0.15:
            break
        if share < 0.5 and centres:
            apart = math.sqrt(_squared_distances(scaled[[best]], scaled[centres]).min())
            # Chiu's test between the two limits: far from the other centres, or enough potential.
            if apart / radius + share < 1.0:
                potential[best] = 0.0
                continue
        centres.append(best)
        distance = _squared_distances(scaled, scaled[[best]])[:, 0]
        potential -= potential[best] * np.exp(-4.0 / (1.5 * radius) ** 2 * distance)
    # The potential exp(-4 d²/r²) is a gaussian of standard deviation r/√8.
    deviations = np.full((len(centres), inputs.shape[1]), radius / math.sqrt(8.0)) * width
    return inputs[centres], deviations


# --- Fewer terms, fewer rules ---


def merged(premises: Premises, similarity: float = 0.7) -> Premises:
    """Return premises with very similar gaussians of an input merged."""
    while True:
        pair = _most_alike(premises)
        if pair is None or pair[0] < similarity:
            return premises
        premises = _with_one_term(premises, pair[1], pair[2])


def _most_alike(premises: Premises) -> tuple[float, int, int] | None:
    pairs = [
        (_overlap(premises.parameters(a), premises.parameters(b)), i, j)
        for i, a in enumerate(premises.terms)
        for j, b in enumerate(premises.terms[i + 1 :], i + 1)
        if a.input == b.input and a.kind == b.kind == "gaussian"
    ]
    return max(pairs, default=None)


def _overlap(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    """Return the common share of two gaussians: the area below both by that below either."""
    reach = 4.0 * max(a[1], b[1])
    x = np.linspace(min(a[0], b[0]) - reach, max(a[0], b[0]) + reach, 201)
    one, other = (np.exp(-(((x - mean) / deviation) ** 2) / 2.0) for mean, deviation in (a, b))
    return float(np.minimum(one, other).sum() / np.maximum(one, other).sum())


def _with_one_term(premises: Premises, survivor: int, dropped: int) -> Premises:
    numbers = premises.numbers.copy()
    for (k, _), (d, _) in zip(
        premises.terms[survivor].numbers, premises.terms[dropped].numbers, strict=True
    ):
        numbers[k] = 0.5 * (numbers[k] + numbers[d])
    rules = [
        tuple(survivor if term == dropped else term for term in rule) for rule in premises.rules
    ]
    return _tidied(premises, list(dict.fromkeys(rules)), numbers)


def pruned(premises: Premises, inputs: Array, least: float = 1.0) -> Premises:
    """Return premises without the rules that have too few samples.

    Parameters
    ----------
    premises : Premises
        Terms and rules.
    inputs : ndarray, shape (samples, inputs)
        Inputs of the samples.
    least : float
        Minimum sum of a rule's firing strengths, in samples.
    """
    # Strengths of a sample add up to 1 over the rules, so a sum counts samples.
    support = premises.strengths(inputs).sum(axis=0)
    rules = [rule for rule, share in zip(premises.rules, support, strict=True) if share >= least]
    if not rules or len(rules) == len(premises.rules):
        return premises
    return _tidied(premises, rules, premises.numbers)


def _tidied(premises: Premises, rules: list[tuple[int, ...]], numbers: Array) -> Premises:
    """Return the rules with their terms, and the numbers of these, in order."""
    term_indices = {term for rule in rules for term in rule}

    def position(index: int) -> tuple[int, float]:
        term = premises.terms[index]
        return term.input, float(numbers[term.numbers[0][0]])

    order = sorted(sorted(term_indices), key=position)
    index = {term: i for i, term in enumerate(order)}
    # Neighbours of a partition share numbers, so numbers are renumbered by use, not by term.
    stay = sorted({k for term in order for k, _ in premises.terms[term].numbers})
    new_index = {k: i for i, k in enumerate(stay)}
    terms = tuple(
        premises.terms[term]._replace(
            numbers=tuple((new_index[k], sign) for k, sign in premises.terms[term].numbers)
        )
        for term in order
    )
    return Premises(
        terms,
        tuple(tuple(index[term] for term in rule) for rule in rules),
        numbers[stay],
        premises.lower[stay],
        premises.upper[stay],
        premises.scale[stay],
    )
