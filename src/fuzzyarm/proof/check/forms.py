"""Zonotopes, many at once: a centre, weights of symbols that are anywhere in -1 .. 1, and a rest.

What is linear keeps its symbols, so that sets turn and shrink with the motion. What is not adds a
symbol of its own for how far it may be from a line: a product, a function (mean value theorem), a
corner (the chord), a rule base (:mod:`.bands`).

Floats: a sum of n products is off by at most n 2⁻⁵³ times the sum of their magnitudes (N. J.
Higham, *Accuracy and Stability of Numerical Algorithms*, section 3.1), which goes into the rest;
what is computed of rests themselves is enlarged.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.language.model.rulebase import RuleBase, Variable
from fuzzyarm.proof.check.bands import RuleBands
from fuzzyarm.proof.check.numbers import ONE, SpanError
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, applied
from fuzzyarm.proof.check.spans import Spans
from fuzzyarm.table import LookupTable

__all__ = ["Form", "FormNumbers"]

Vector = NDArray[np.float64]

ENLARGED = 1.0 + 2.0**-40
"""By which sums of magnitudes are enlarged: 4,000 roundings, where nothing cancels."""

ROUNDING = 2.0**-52
"""Twice the largest relative error of a rounding."""

TINY = 1e-300
"""More than what a thousand results below the smallest normal float are off."""


@dataclass(frozen=True, eq=False)
class Form:
    """Values that are affine in symbols, one for each set.

    Attributes
    ----------
    centre : ndarray, shape (sets,)
        c.
    weights : ndarray, shape (symbols, sets)
        Of as many symbols as it is over.
    rest : ndarray, shape (sets,)
        Of what nothing more is known, not negative.
    ends : (float, float)
        What a limit does not let it leave.
    """

    centre: Vector
    weights: Vector
    rest: Vector
    ends: tuple[float, float] = (-math.inf, math.inf)

    @cached_property
    def reach(self) -> Vector:
        """How far values may be from the centre, rounded up."""
        return np.asarray((np.abs(self.weights).sum(axis=0) + self.rest) * ENLARGED)

    @cached_property
    def size(self) -> Vector:
        """The largest magnitudes, rounded up."""
        return np.asarray((np.abs(self.centre) + self.reach) * ENLARGED)

    @cached_property
    def span(self) -> Spans:
        """Where values are."""
        centre, far = self.centre, self.reach
        low, high = np.nextafter(centre - far, -np.inf), np.nextafter(centre + far, np.inf)
        return Spans(np.where(far == 0.0, centre, low), np.where(far == 0.0, centre, high))

    @property
    def moves(self) -> bool:
        """Whether it is anything but numbers."""
        return bool(self.rest.any() or self.weights.any())

    def of(self, which: Any) -> Form:
        """Return those of some sets."""
        return Form(self.centre[which], self.weights[:, which], self.rest[which], self.ends)

    def over(self, symbols: int) -> Vector:
        """Return the weights of so many symbols."""
        if len(self.weights) == symbols:
            return self.weights
        weights = np.zeros((symbols, self.weights.shape[1]))
        weights[: len(self.weights)] = self.weights
        return weights


def combined(*terms: tuple[Form, Any]) -> Form:
    """Return Σ factor · form; a factor is a float, an array of them, or intervals."""
    count = max(len(form.weights) for form, _ in terms)
    centre = weights = rest = size = np.asarray(0.0)
    for form, factor in terms:
        if isinstance(factor, Spans):
            near, off = factor.mid().low, factor.rad().low
            rest = rest + off * form.size
        else:
            near = np.asarray(factor, float)
        if not np.any(near) and np.isfinite(form.size).all():  # a value that is unknown stays so
            continue
        far = np.abs(near)
        centre = centre + form.centre * near
        weights = weights + form.over(count) * near
        rest = rest + form.rest * far
        size = size + form.size * far
    shape = np.broadcast_shapes(*(form.centre.shape for form, _ in terms))
    # Each product and each sum is rounded: two for each term, over the sum of magnitudes.
    rest = (rest + (2 * len(terms)) * ROUNDING * size + np.where(size > 0.0, TINY, 0.0)) * ENLARGED
    form, factor = terms[0]
    if len(terms) == 1 and not isinstance(factor, Spans) and np.all(np.abs(near) == 1.0):
        rest = form.rest  # a sign rounds nothing
    return Form(
        np.broadcast_to(centre, shape), np.broadcast_to(weights, (count, *shape)),
        np.broadcast_to(rest, shape),
    )  # fmt: skip


class FormNumbers:
    """Zonotopes, for a walk over the program.

    Attributes
    ----------
    sets : int
        How many there are at once.
    symbols : int
        How many are in use.
    lost : ndarray of bool, shape (sets,)
        Which sets a rule base may have no value for, since that was last set to none.
    why : str
        And why, of those that were lost last.
    """

    def __init__(self, surfaces: RuleSurfaces) -> None:
        self.surfaces = surfaces
        self.sets, self.symbols, self.why = 1, 0, ""
        self.lost: NDArray[np.bool_] = np.zeros(1, dtype=bool)
        self._bands: dict[tuple[int, str], RuleBands] = {}

    def at(self, centre: Any, far: Any = 0.0) -> Form:
        """Return what is no further from centres than that."""
        shape = (self.sets,)
        return Form(
            np.broadcast_to(np.asarray(centre, float), shape), np.zeros((0, *shape)),
            np.broadcast_to(np.asarray(far, float), shape),
        )  # fmt: skip

    def of(self, x: Any) -> Form:
        """Return a number of the checker."""
        x = Spans.of(x)
        return self.at(x.mid().low, x.rad().low)

    def number(self, value: float) -> Form:
        """Return a number of the program."""
        return self.at(value)

    def kept(self, form: Form) -> Form:
        """Return a form whose rest is a symbol: what it does to several values stays together."""
        if not form.rest.any():
            return form
        self.symbols += 1
        weights = form.over(self.symbols).copy()
        weights[-1] += form.rest
        return Form(form.centre, weights, np.zeros_like(form.rest), form.ends)

    def apply(self, operation: str, arguments: list[Form]) -> Any:
        """Return an operation; of a condition a bool, the same of all sets."""
        if operation in ("add", "subtract"):
            a, b = arguments
            return combined((a, 1.0), (b, 1.0 if operation == "add" else -1.0))
        if operation == "negative":
            return combined((arguments[0], -1.0))
        if operation == "multiply":
            return self._multiplied(*arguments)
        if operation in ("minimum", "maximum"):
            a, b = arguments
            sign = 1.0 if operation == "maximum" else -1.0
            gap = combined((a, sign), (b, -sign))
            if np.all(gap.span.low >= 0.0):
                return a
            return combined((b, 1.0), (self._positive(gap), sign))
        return self._by_slopes(operation, arguments)

    def _multiplied(self, a: Form, b: Form) -> Form:
        if not b.moves or not a.moves:
            a, b = (a, b) if a.moves else (b, a)
            return combined((a, b.centre))
        count = max(len(a.weights), len(b.weights))
        weights = a.over(count) * b.centre + b.over(count) * a.centre
        off = 4 * ROUNDING * a.size * b.size + TINY
        rest = np.abs(a.centre) * b.rest + np.abs(b.centre) * a.rest + a.reach * b.reach + off
        return self.kept(Form(a.centre * b.centre, weights, rest * ENLARGED))

    def _positive(self, x: Form) -> Form:
        """Return max(x, 0): between λ x and λ (x − low), where λ = high/(high − low)."""
        low, high = x.span.low, x.span.high
        if np.all(low >= 0.0):
            return x
        known = np.isfinite(low) & np.isfinite(high)
        open_ = known & (low < 0.0) & (high > 0.0)
        share = np.where(open_, high / np.where(open_, high - low, 1.0), low >= 0.0)
        share = np.clip(share, 0.0, 1.0)
        # Whatever the share: max(x, 0) − λ x is from 0 to the larger of −λ low and (1 − λ) high.
        most = np.maximum(-share * low, (1.0 - share) * high)
        half = np.where(open_, 0.5 * most * ENLARGED, np.where(known, 0.0, np.inf))
        return self.kept(combined((x, share), (self.at(half, half), 1.0)))

    def _by_slopes(self, operation: str, arguments: list[Form]) -> Any:
        if not any(x.moves for x in arguments):
            plain = applied(operation, [Slope(Spans(x.centre, x.centre), {}) for x in arguments])
            return plain if isinstance(plain, bool) else self.of(plain.value)
        spans = [Slope(x.span, {str(k): ONE} if x.moves else {}) for k, x in enumerate(arguments)]
        over = applied(operation, spans)
        if isinstance(over, bool):
            return over
        at = applied(operation, [Slope(Spans(x.centre, x.centre), {}) for x in arguments]).value
        terms: list[tuple[Form, Any]] = [(self.of(at), 1.0)]
        for k, x in enumerate(arguments):
            slope = over.along.get(str(k))
            if slope is not None:
                away = Form(np.zeros_like(x.centre), x.weights, x.rest)
                terms.append((away, Spans.of(slope)))
        return self.kept(combined(*terms))

    def limit(self, x: Form, low: float, high: float) -> Form:
        """Return ``min(max(x, low), high)``."""
        ends = min(max(x.ends[0], low), high), min(max(x.ends[1], low), high)
        for operation, end in (("maximum", low), ("minimum", high)):
            if math.isfinite(end):
                x = self.apply(operation, [x, self.number(end)])
        return Form(x.centre, x.weights, x.rest, ends)

    def rules(self, sheet: RuleBase, output: str, inputs: Mapping[str, Form]) -> Form:
        """Return the conclusion of a rule base: a plane, and a band around it."""
        key = id(sheet), output
        if key not in self._bands:
            self._bands[key] = RuleBands(self.surfaces(sheet, output))
        brought = [self._brought(inputs[v.name], v) for v in sheet.inputs]
        slopes, low, high = self._bands[key].band([x.span for x in brought])
        known = np.isfinite(low) & np.isfinite(high)
        if not known.all():
            self.why = self._bands[key].why
            self.lost = self.lost | ~known
        band = Spans(low, high)
        base = self.at(band.mid().low, band.rad().low)
        return self.kept(combined(*zip(brought, slopes, strict=True), (base, 1.0)))

    def _brought(self, x: Form, variable: Variable) -> Form:
        """Return an input as a rule base takes it."""
        if variable.outside == "clamp":
            return self.limit(x, variable.low, variable.high)
        return x

    def table(self, sheet: LookupTable, inputs: Mapping[str, Form]) -> Form:
        """Refuse a table."""
        raise SpanError("a table is not followed")

    def fewer(self, forms: Sequence[Form], most: int) -> list[Form]:
        """Return sets of fewer symbols: those that count least become a box."""
        forms = [self.kept(form) for form in forms]
        weights = np.stack([form.over(self.symbols) for form in forms])  # (values, symbols, sets)
        size, count = weights.shape[:2]
        if count > most * size:
            sizes = np.abs(weights)
            share = np.nan_to_num(sizes / np.maximum(sizes.sum(axis=1, keepdims=True), TINY))
            # Of each set its own, so that it does not matter beside which others it is followed.
            order = np.argsort(share.max(axis=0) - share.sum(axis=0), axis=0, kind="stable")
            weights = np.take_along_axis(weights, order[None], axis=1)
            stay = (most // 2) * size
            box = np.abs(weights[:, stay:]).sum(axis=1) * ENLARGED
            sides = np.zeros((size, size, box.shape[1]))
            sides[np.arange(size), np.arange(size)] = box
            weights = np.concatenate([weights[:, :stay], sides], axis=1)
        self.symbols = weights.shape[1]
        return [
            Form(form.centre, row, np.zeros_like(form.rest))
            for form, row in zip(forms, weights, strict=True)
        ]
