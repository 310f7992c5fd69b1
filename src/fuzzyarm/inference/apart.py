"""The greatest difference between the outputs of two rule bases, and its point: by search.

`fuzzyarm.proof.map.difference` proves an upper bound, where both are exact. The points of
the search are the corners of all terms, points beside and between them, and points
spread evenly; from the best of them it goes on, along the axes, in ever smaller steps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.inference.infer import infer, with_nan_for_no_rule
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.symbolic.kinds import SHAPES

SPREAD = 20_000
"""Evenly spread points, from which the mean square is."""

AT_CORNERS = 40_000
"""Most points at corners and between them."""

_STARTS = 256
"""Number of starts of the search."""

_ROUNDS = 60

Array = NDArray[np.float64]


class UnlikeRuleBasesError(FuzzyarmError, ValueError):
    """Two rule bases have inputs or outputs that do not correspond."""


@json_properties("output worst at before after rms points missing proved")
@dataclass(frozen=True, slots=True)
class Apart:
    """The difference of an output between two rule bases.

    Attributes
    ----------
    output : str
        Its name in the second one.
    worst : float
        Greatest magnitude found.
    at : dict of str to float
        Its point, by the names of the second rule base.
    before, after : float
        Both values there.
    rms : float
        The root of the mean square of the difference, over the ranges of the inputs.
    points : int
        Points of the search.
    missing : dict of str to float or None
        A point at which only one of them has a value.
    proved : float or None
        Proved upper bound of the magnitude; None without a proof.
    """

    output: str
    worst: float
    at: Mapping[str, float]
    before: float
    after: float
    rms: float
    points: int
    missing: Mapping[str, float] | None = None
    proved: float | None = None


def apart(before: RuleBase, after: RuleBase) -> tuple[Apart, ...]:
    """Return the greatest difference of each output.

    Inputs and outputs correspond by name, or by their order where the names differ;
    UnlikeRuleBasesError if their numbers differ, or an input has no bounds.
    """
    return tuple(_Search(before, after).found())


class _Search:
    """Both rule bases over points: an array with a column for each input of the second one."""

    def __init__(self, before: RuleBase, after: RuleBase) -> None:
        self.before, self.after = with_nan_for_no_rule(before), with_nan_for_no_rule(after)
        self.inputs = paired(before.inputs, after.inputs, "input")
        self.outputs = paired(before.outputs, after.outputs, "output")
        self.low = np.array([min(one.low, two.low) for one, two in self.inputs])
        self.high = np.array([max(one.high, two.high) for one, two in self.inputs])
        for (_, variable), low, high in zip(self.inputs, self.low, self.high, strict=True):
            if not math.isfinite(high - low):
                raise UnlikeRuleBasesError(f"the input '{variable.name}' has no bounds")

    def found(self) -> Iterator[Apart]:
        """Yield the results, output by output."""
        spread, corners = self._spread(), self._corners()
        points = np.concatenate([corners, spread])
        values = self._values(points)
        for number, (_, output) in enumerate(self.outputs):
            one, two = (each[number] for each in values)
            gap, lone = _gap(one, two), np.isnan(one) != np.isnan(two)
            tail = gap[len(corners) :]
            rms = math.sqrt(float(np.mean(tail * tail)))
            best, size, asked = self._climbed(points[np.argsort(-gap)[:_STARTS]], number)
            (first,), (second,) = (each[number] for each in self._values(best[None, :]))
            missing = self._named(points[np.argmax(lone)]) if lone.any() else None
            yield Apart(output.name, size, self._named(best), float(first), float(second), rms,
                        len(points) + asked, missing)  # fmt: skip

    def _named(self, point: Array) -> dict[str, float]:
        names = (two.name for _, two in self.inputs)
        return dict(zip(names, map(float, point), strict=True))

    def _values(self, points: Array) -> tuple[list[Array], list[Array]]:
        """Return the outputs of both, in the order of the pairs."""
        results = []
        for side, rulebase in enumerate((self.before, self.after)):
            columns = {
                pair[side].name: np.ascontiguousarray(points[:, k])
                for k, pair in enumerate(self.inputs)
            }
            values = infer(rulebase, columns)
            results.append([np.asarray(values[pair[side].name]) for pair in self.outputs])
        return results[0], results[1]

    def _spread(self) -> Array:
        """Return points spread evenly: multiples of the golden ratio in each dimension."""
        count = len(self.inputs)
        ratio = 2.0
        for _ in range(60):  # the root of x^(d + 1) = x + 1
            ratio = (1.0 + ratio) ** (1.0 / (count + 1))
        steps = ratio ** -np.arange(1.0, count + 1)
        shares = (0.5 + np.outer(np.arange(1, SPREAD + 1), steps)) % 1.0
        return np.asarray(self.low + shares * (self.high - self.low))

    def _corners(self) -> Array:
        """Return points at corners of terms, beside and between them."""
        each = AT_CORNERS ** (1.0 / len(self.inputs))
        if each < 2.0:  # many inputs have too many corners
            return np.stack([self.low, 0.5 * self.low + 0.5 * self.high, self.high])
        axes = []
        for pair, low, high in zip(self.inputs, self.low, self.high, strict=True):
            corners = np.unique([low, high, *_corners_of(pair, low, high)])
            between = 0.5 * (corners[1:] + corners[:-1])
            beside = np.concatenate([np.nextafter(corners, end) for end in (-math.inf, math.inf)])
            rows = [corners, between, beside[(beside >= low) & (beside <= high)]]
            axis = np.unique(np.concatenate(rows))
            if len(axis) > each:
                axis = np.unique(np.concatenate(rows[:2]))
            if len(axis) > each:
                axis = axis[np.linspace(0, len(axis) - 1, max(2, int(each))).astype(int)]
            axes.append(axis)
        return np.array(list(product(*axes)), float)

    def _climbed(self, starts: Array, number: int) -> tuple[Array, float, int]:
        """Return the point of the greatest gap near the starts, the gap, and the evaluations."""
        size = self._gap_at(starts, number)
        step = np.tile((self.high - self.low) / 8.0, (len(starts), 1))
        count, asked = len(self.inputs), 0
        moves = np.concatenate([np.eye(count), -np.eye(count)])
        for _ in range(_ROUNDS):
            near = np.clip(starts[:, None, :] + moves * step[:, None, :], self.low, self.high)
            gaps = self._gap_at(near.reshape(-1, count), number).reshape(len(starts), -1)
            asked += gaps.size
            best = gaps.argmax(axis=1)
            rows = np.arange(len(starts))
            better = gaps[rows, best] > size
            starts = np.where(better[:, None], near[rows, best], starts)
            size = np.where(better, gaps[rows, best], size)
            step = np.where(better[:, None], step, 0.5 * step)
        top = int(size.argmax())
        return starts[top], float(size[top]), asked

    def _gap_at(self, points: Array, number: int) -> Array:
        return _gap(*(each[number] for each in self._values(points)))


def _gap(one: Array, two: Array) -> Array:
    """Return magnitudes of differences, 0 without a value in one of them."""
    with np.errstate(invalid="ignore"):
        return np.nan_to_num(np.abs(two - one), nan=0.0)


_Side = TypeVar("_Side", Input, Output)


def paired(one: Sequence[_Side], two: Sequence[_Side], what: str) -> list[tuple[_Side, _Side]]:
    """Return corresponding variables, in the order of the second: by name, else by position."""
    if len(one) != len(two):
        raise UnlikeRuleBasesError(f"one has {len(one)} {what}s, the other {len(two)}")
    by_name = {variable.name: variable for variable in one}
    if all(variable.name in by_name for variable in two):
        return [(by_name[variable.name], variable) for variable in two]
    return list(zip(one, two, strict=True))


def _corners_of(pair: Sequence[Input], low: float, high: float) -> Iterator[float]:
    """Yield the corners of the terms of two variables; for curves their parameters."""
    for term in (term for variable in pair for term in variable.terms):
        for shape in (term.shape, term.lower):
            if shape is None:
                continue
            straight = SHAPES[shape.kind].straight if shape.kind in SHAPES else False
            numbers = (x for x, _ in polyline(shape)) if straight else shape.parameters
            yield from (float(x) for x in numbers if isinstance(x, int | float) and low < x < high)
