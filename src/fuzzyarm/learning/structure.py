"""Selection of terms, number of rules and shrinkage by cross-validation.

A closer fit to the samples need not be better on others. Every candidate is therefore fitted to
some of the samples and tested on the rest; for a series the parts are blocks of time. Candidates
that differ in consequents alone are cheap, since one decomposition serves all amounts of shrinkage.
Among structures, and amounts of shrinkage, take the simplest that is not clearly worse than the
best: the mean difference of their squared errors, sample by sample, is within its standard error
(L. Breiman and others, 1984), or within a hundredth of the error. Every term has to pay for
itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.learning.fit_options import MOST_COEFFICIENTS
from fuzzyarm.learning.starts import (
    cluster_premises,
    fuzzy_c_means,
    grid_premises,
    subtractive_clusters,
)
from fuzzyarm.learning.sugeno import (
    LEAST_SHRINKAGE,
    Array,
    Premises,
    Scaling,
    consequents,
    designed,
    optimised,
    predicted,
)

SHRINKAGES = tuple(10.0**k for k in range(1, -11, -1))
"""Those tried, from nearly linear to nearly free."""

EARNED = 0.01
"""Part of the error by which a larger structure must be better."""

MOST_TERMS = 4
"""Largest number of terms of an input in a grid."""

RADII = (1.0, 0.8, 0.65, 0.5, 0.4, 0.3)
"""Radii of subtractive clustering."""

Parts = Sequence[tuple[NDArray[np.intp], NDArray[np.intp]]]


@dataclass(frozen=True)
class StructureCandidate:
    """A structure and its score.

    Attributes
    ----------
    words : str
        Description for a person.
    premises : Premises
        Its terms and rules, with their initial numbers.
    shrinkage : float
        The best of its consequents.
    squares : ndarray, shape (samples,)
        Squared errors of cross-validation, by which candidates are compared.
    optimised : bool
        Whether its terms are moved by variable projection.
    """

    words: str
    premises: Premises = field(compare=False)
    shrinkage: float
    squares: Array = field(compare=False)
    optimised: bool = False

    @property
    def error(self) -> float:
        """Root mean square error of cross-validation, in the units of the target."""
        return float(np.sqrt(self.squares.mean()))

    @property
    def size(self) -> int:
        """Number of rules, a measure of legibility."""
        return len(self.premises.rules)


class CrossValidation(NamedTuple):
    """Samples with the parts by which candidates are judged.

    `shrinkages` are the choices; `on_step` is called with the current candidate, and `check` often:
    an exception of it ends the search.
    """

    inputs: Array
    outputs: Array
    parts: Parts
    shrinkages: Sequence[float] = SHRINKAGES
    on_step: Callable[[str], None] = lambda _words: None
    check: Callable[[], None] = lambda: None

    def linear_error(self) -> float:
        """Return the error of linear regression."""
        errors = [_linear_residual(self.inputs, self.outputs, *part)[1] for part in self.parts]
        return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))

    def judged(self, words: str, premises: Premises) -> StructureCandidate:
        """Return a structure with its best shrinkage, without moving its terms."""
        squares = np.empty((len(self.shrinkages), len(self.inputs)))
        for train, test in self.parts:
            self.check()
            errors = self._errors_by_shrinkage(premises, train, test)
            squares[:, test] = np.mean(errors**2, axis=2)
        least = squares[squares.mean(axis=1).argmin()]
        # Sorted by shrinkage: the strongest (most linear) that is not clearly worse.
        best = next(k for k, square in enumerate(squares) if not clearly_worse(square, least))
        candidate = StructureCandidate(words, premises, self.shrinkages[best], squares[best])
        self.on_step(f"{words}: {candidate.error:.4g}")
        return candidate

    def _errors_by_shrinkage(
        self, premises: Premises, train: NDArray[np.intp], test: NDArray[np.intp]
    ) -> Array:
        """Return the errors on the test part, shape (shrinkages, samples, outputs)."""
        inputs, outputs = self.inputs, self.outputs
        residual, test_residual = _linear_residual(inputs, outputs, train, test)
        if len(premises.rules) < 2:
            return np.broadcast_to(test_residual, (len(self.shrinkages), *test_residual.shape))
        scaling = Scaling.of(inputs[train], outputs[train])
        regressors = scaling.regressors(inputs)
        strengths = premises.strengths(inputs)
        design_train = designed(strengths[train], regressors[train])
        design = designed(strengths[test], regressors[test])
        # The linear part is projected out of the deviations, in both parts alike.
        linear_part = np.linalg.lstsq(regressors[train], design_train, rcond=1e-10)[0]
        design_train -= regressors[train] @ linear_part
        design -= regressors[test] @ linear_part
        # The spectrum is accurate to 1e-16 of its largest value: far below the least shrinkage.
        values, axes = np.linalg.eigh(design_train.T @ design_train)
        turned = axes.T @ (design_train.T @ (residual / scaling.range))
        design = design @ axes
        # Ridge regression in the eigenbasis: one decomposition serves every shrinkage.
        residuals = []
        for shrinkage in self.shrinkages:
            least = max(shrinkage, LEAST_SHRINKAGE) * len(train)
            step = turned / (np.maximum(values, 0.0) + least)[:, None]
            residuals.append(test_residual - design @ step * scaling.range)
        return np.array(residuals)

    def moved(self, candidate: StructureCandidate, evaluations: int = 25) -> StructureCandidate:
        """Return a structure judged with its terms moved by variable projection."""
        squares = np.empty(len(self.inputs))
        for train, test in self.parts:
            inputs, outputs = self.inputs[train], self.outputs[train]
            shrinkage = candidate.shrinkage
            premises, finished = optimised(
                candidate.premises,
                inputs,
                outputs,
                shrinkage,
                evaluations,
                on_step=lambda _cost: self.check(),
            )
            if not finished:
                raise KeyboardInterrupt
            weights, scaling = consequents(premises, inputs, outputs, shrinkage)
            inputs_test = self.inputs[test]
            values = predicted(premises, weights, scaling.regressors(inputs_test), inputs_test)
            errors = self.outputs[test] - (scaling.middle + values * scaling.range)
            squares[test] = np.mean(errors**2, axis=1)
            self.on_step(f"{candidate.words}, terms moved")
        moved = replace(
            candidate, words=f"{candidate.words}, terms moved", squares=squares, optimised=True
        )
        self.on_step(f"{moved.words}: {moved.error:.4g}")
        return moved


def _linear_residual(
    inputs: Array, outputs: Array, train: NDArray[np.intp], test: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Return the residuals of linear regression in the training and the test part."""
    scaling = Scaling.of(inputs[train], outputs[train])
    regressors_train, regressors_test = (
        scaling.regressors(inputs[train]),
        scaling.regressors(inputs[test]),
    )
    weights = np.linalg.lstsq(regressors_train, outputs[train], rcond=1e-10)[0]
    return outputs[train] - regressors_train @ weights, outputs[test] - regressors_test @ weights


# --- Candidates ---


def clearly_worse(squares: Array, least: Array) -> bool:
    """Return whether squared errors are above others, sample by sample, by more than chance."""
    apart = squares - least
    mean = float(apart.mean())
    if mean <= 2.0 * EARNED * float(least.mean()):  # of squares: twice the part of the error
        return False
    return mean > float(apart.std()) / math.sqrt(len(apart))


def smallest_good(candidates: Iterable[StructureCandidate]) -> StructureCandidate:
    """Return the smallest candidate, then the most linear, not clearly worse than the best."""
    candidates_ = list(candidates)
    best = min(candidates_, key=lambda entry: entry.error)
    good = [
        candidate for candidate in candidates_ if not clearly_worse(candidate.squares, best.squares)
    ]
    return min(good, key=lambda entry: (entry.size, -entry.shrinkage, entry.error))


def grown_grids(
    judge: CrossValidation, most: int, names: Sequence[str]
) -> Iterator[StructureCandidate]:
    """Yield grids, each with one term more than the one before: the one that helps most."""
    counts = [1] * judge.inputs.shape[1]
    yield judge.judged("linear", grid_premises(judge.inputs, counts))
    varying = [k for k in range(len(counts)) if np.ptp(judge.inputs[:, k]) > 0.0]
    while True:
        following = []
        for k in varying:
            # An input begins with two terms; one term and two terms are one step apart.
            larger = [*counts[:k], counts[k] + 1, *counts[k + 1 :]]
            if larger[k] <= MOST_TERMS and math.prod(larger) <= most_rules(most, len(counts)):
                grid = grid_premises(judge.inputs, larger)
                following.append((judge.judged(grid_words(larger, names), grid), larger))
        if not following:
            return
        best, counts = min(following, key=lambda candidate: candidate[0].error)
        yield best


def most_rules(most: int, inputs: int) -> int:
    """Return the largest number of rules of a model with so many inputs."""
    return min(most, MOST_COEFFICIENTS // (inputs + 1))


def grid_words(counts: Sequence[int], names: Sequence[str]) -> str:
    """Return a grid in words: ``2 terms of a, 3 of b``."""
    parts = [(count, name) for count, name in zip(counts, names, strict=True) if count > 1]
    if not parts:
        return "linear"
    first, *others = parts
    return ", ".join([f"{first[0]} terms of {first[1]}", *(f"{c} of {n}" for c, n in others)])


def clustered(
    judge: CrossValidation, start: str, most: int, seed: int
) -> Iterator[StructureCandidate]:
    """Yield clusters as rules, from few to many."""
    linear = grid_premises(judge.inputs, [1] * judge.inputs.shape[1])
    yield judge.judged("linear", linear)
    counts = set()
    for centres, deviations in _clusterings(judge, start, most, seed):
        if len(centres) in counts or len(centres) < 2:
            continue
        counts.add(len(centres))
        premises = cluster_premises(judge.inputs, centres, deviations)
        yield judge.judged(f"{len(centres)} clusters", premises)


def _clusterings(
    judge: CrossValidation, start: str, most: int, seed: int
) -> Iterator[tuple[Array, Array]]:
    different = len(np.unique(judge.inputs, axis=0))
    most = most_rules(most, judge.inputs.shape[1])
    if start == "subtractive":
        for radius in RADII:
            yield subtractive_clusters(judge.inputs, radius, min(most, different))
        return
    for count in (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64):
        if count <= min(most, different):
            yield fuzzy_c_means(judge.inputs, count, seed)
