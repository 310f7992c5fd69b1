"""Zonotopes, many at once: a centre, weights of symbols anywhere in -1 .. 1, and a remainder.

Linear operations keep the symbols, so that sets turn and shrink with the motion. Others add a
new symbol for the distance from a line: a product, a function (mean value theorem), a corner (the
chord), a rule base (:mod:`.bands`).

Floats: a sum of n products is off by at most n 2⁻⁵³ times the sum of their magnitudes (N. J.
Higham, *Accuracy and Stability of Numerical Algorithms*, section 3.1), which goes into the
remainder; sums of remainders are enlarged.

The result for a set does not depend on the sets beside it, to the last bit: decisions are arrays,
sums over symbols run in their order, and a symbol that a set lacks is zero. So a certificate holds
whatever the groups in which its boxes are followed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.language.model.rulebase import RuleBase, Variable
from fuzzyarm.proof.check.bands import RuleBands
from fuzzyarm.proof.check.numbers import ONE, SpanError
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, applied
from fuzzyarm.proof.check.spans import Spans, Vector
from fuzzyarm.table import LookupTable

Flags = NDArray[np.bool_]

ENLARGED = 1.0 + 2.0**-40
"""Enlargement of sums of magnitudes: 4,000 roundings, without cancellation."""

ROUNDING = 2.0**-52
"""Twice the unit roundoff: the largest relative error of a rounding, doubled."""

TINY = 1e-300
"""More than the error of a thousand subnormal results."""


def _total(rows: Vector) -> Vector:
    """Return the sum of rows in order: zeros between them change nothing."""
    if not len(rows):
        return np.zeros(rows.shape[1:])
    return np.asarray(np.add.accumulate(rows, axis=0)[-1])


class Truth(NamedTuple):
    """A condition by set: certainly true, certainly false."""

    yes: Flags
    no: Flags

    def both(self, other: Truth | bool) -> Truth:
        """Return the conjunction of two conditions."""
        yes, no = (other.yes, other.no) if isinstance(other, Truth) else (other, not other)
        return Truth(self.yes & yes, self.no | no)

    def negated(self) -> Truth:
        """Return the negation."""
        return Truth(self.no, self.yes)

    def chosen(self, numbers: FormNumbers, a: Form, b: Form) -> Form:
        """Return a where it holds, b where it fails, and a hull of both where it is open."""
        apart = combined((a, 0.5), (b, -0.5)).size
        hull = combined((a, 0.5), (b, 0.5), (numbers.at(0.0, apart), 1.0))
        hull = numbers.with_rest_symbol(hull, ~(self.yes | self.no))
        return _selected(self.yes, a, _selected(self.no, b, hull))


@dataclass(frozen=True, eq=False)
class Form:
    """Affine forms over shared symbols, one for each set."""

    centre: Vector  # c; shape (sets,)
    weights: Vector  # of its symbols; shape (symbols, sets)
    rest: Vector  # remainder: radius of a further interval, not negative; shape (sets,)
    ends: tuple[float, float] = (-math.inf, math.inf)  # bounds set by a limit

    @cached_property
    def reach(self) -> Vector:
        """The largest distance from the centre, rounded up."""
        return np.asarray((_total(np.abs(self.weights)) + self.rest) * ENLARGED)

    @cached_property
    def size(self) -> Vector:
        """The largest magnitudes, rounded up."""
        return np.asarray((np.abs(self.centre) + self.reach) * ENLARGED)

    @cached_property
    def span(self) -> Spans:
        """The intervals of the values."""
        centre, far = self.centre, self.reach
        low, high = np.nextafter(centre - far, -np.inf), np.nextafter(centre + far, np.inf)
        return Spans(np.where(far == 0.0, centre, low), np.where(far == 0.0, centre, high))

    @property
    def moves(self) -> bool:
        """Whether it is anything but numbers."""
        return bool(self.rest.any() or self.weights.any())

    def of(self, which: Any) -> Form:
        """Return the forms of selected sets."""
        return Form(self.centre[which], self.weights[:, which], self.rest[which], self.ends)

    def over(self, symbols: int) -> Vector:
        """Return the weights of the first `symbols` symbols, padded with zeros."""
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
        if not np.any(near) and np.isfinite(form.size).all():  # an unknown value stays unknown
            continue
        far = np.abs(near)
        centre = centre + form.centre * near
        weights = weights + form.over(count) * near
        rest = rest + form.rest * far
        size = size + form.size * far
    shape = np.broadcast_shapes(*(form.centre.shape for form, _ in terms))
    # One product and one sum are rounded for each term: two errors, over the sum of magnitudes.
    rest = (rest + (2 * len(terms)) * ROUNDING * size + np.where(size > 0.0, TINY, 0.0)) * ENLARGED
    form, factor = terms[0]
    if len(terms) == 1 and not isinstance(factor, Spans):
        rest = np.where(np.abs(near) == 1.0, form.rest, rest)  # a change of sign rounds nothing
    return Form(
        np.broadcast_to(centre, shape), np.broadcast_to(weights, (count, *shape)),
        np.broadcast_to(rest, shape),
    )  # fmt: skip


def _selected(which: Flags, a: Form, b: Form) -> Form:
    """Return `a` for some sets and `b` for the others."""
    if which.all() or not which.any():
        found = a if which.all() else b
        return Form(found.centre, found.weights, found.rest)
    count = max(len(a.weights), len(b.weights))
    return Form(
        np.where(which, a.centre, b.centre),
        np.where(which, a.over(count), b.over(count)),
        np.where(which, a.rest, b.rest),
    )


class FormNumbers:
    """Zonotopes, for a walk over the program.

    Attributes
    ----------
    sets : int
        Number of sets.
    symbols : int
        Number of symbols in use.
    lost : ndarray of bool, shape (sets,)
        Sets for which a rule base may have had no value, since the last reset.
    why : str
        Why, for those lost last.
    """

    def __init__(self, surfaces: RuleSurfaces) -> None:
        self.surfaces = surfaces
        self.sets, self.symbols, self.why = 1, 0, ""
        self.lost: NDArray[np.bool_] = np.zeros(1, dtype=bool)
        self._bands: dict[tuple[int, str], RuleBands] = {}

    def at(self, centre: Any, far: Any = 0.0) -> Form:
        """Return boxes with the given radii around centres."""
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

    def with_rest_symbol(self, form: Form, which: Any = True) -> Form:
        """Return a form with its remainder as a symbol, shared by all values computed from it."""
        rest = np.where(which, form.rest, 0.0)
        if not rest.any():
            return form
        self.symbols += 1
        weights = form.over(self.symbols).copy()
        weights[-1] += rest
        return Form(form.centre, weights, np.where(which, 0.0, form.rest), form.ends)

    def apply(self, operation: str, arguments: list[Form]) -> Any:
        """Apply an operation; a condition is a bool if it is the same for all sets."""
        if operation in ("add", "subtract"):
            a, b = arguments
            return combined((a, 1.0), (b, 1.0 if operation == "add" else -1.0))
        if operation == "negative":
            return combined((arguments[0], -1.0))
        if operation == "multiply":
            return self._multiplied(*arguments)
        if operation in ("minimum", "maximum"):
            a, b = arguments
            return self._extreme(a, b, 1.0 if operation == "maximum" else -1.0)
        if operation in ("less", "less_equal", "equal"):
            return self._compared(operation, *arguments)
        return self._by_slopes(operation, arguments)

    def _multiplied(self, a: Form, b: Form) -> Form:
        if not b.moves or not a.moves:
            a, b = (a, b) if a.moves else (b, a)
            return combined((a, b.centre))
        count = max(len(a.weights), len(b.weights))
        weights = a.over(count) * b.centre + b.over(count) * a.centre
        off = 4 * ROUNDING * a.size * b.size + TINY
        rest = np.abs(a.centre) * b.rest + np.abs(b.centre) * a.rest + a.reach * b.reach + off
        product = Form(a.centre * b.centre, weights, rest * ENLARGED)
        still = a.reach == 0.0, b.reach == 0.0
        for x, factor, fixed in ((a, b, still[1]), (b, a, still[0])):
            if fixed.any():
                product = _selected(fixed, combined((x, factor.centre)), product)
        return self.with_rest_symbol(product, ~(still[0] | still[1]))

    def _extreme(self, a: Form, b: Form, sign: float) -> Form:
        """Return max(a, b) or min(a, b): the operand itself where a set decides which."""
        gap = combined((a, sign), (b, -sign))
        above = gap.span.low >= 0.0
        below = (gap.span.high <= 0.0) & ~above
        found = b
        if not (above | below).all():
            found = _selected(below, b, combined((b, 1.0), (self._positive(gap), sign)))
        return _selected(above, a, found)

    def _positive(self, x: Form) -> Form:
        """Return max(x, 0): between λ x and λ (x − low), where λ = high/(high − low)."""
        low, high = x.span.low, x.span.high
        known = np.isfinite(low) & np.isfinite(high)
        open_ = known & (low < 0.0) & (high > 0.0)
        share = np.where(open_, high / np.where(open_, high - low, 1.0), low >= 0.0)
        share = np.clip(share, 0.0, 1.0)
        # For any λ: max(x, 0) − λ x is from 0 to the larger of −λ low and (1 − λ) high.
        most = np.maximum(-share * low, (1.0 - share) * high)
        half = np.where(open_, 0.5 * most * ENLARGED, np.where(known, 0.0, np.inf))
        return self.with_rest_symbol(combined((x, share), (self.at(half, half), 1.0)))

    def _compared(self, operation: str, a: Form, b: Form) -> Truth | bool:
        """Return a < b, a ≤ b or a = b, for each set."""
        first, second, gap = a.span, b.span, combined((b, 1.0), (a, -1.0)).span
        above = (gap.low > 0.0) | (first.high < second.low)
        below = (gap.high < 0.0) | (second.high < first.low)
        if operation == "equal":
            point = (first.low == first.high) & (second.low == second.high)
            truth = Truth(point & (first.low == second.low), above | below)
        elif operation == "less_equal":
            truth = Truth(above | (first.high <= second.low), below)
        else:
            truth = Truth(above, below | (second.high <= first.low))
        if truth.yes.all() or truth.no.all():
            return bool(truth.yes.all())
        return truth

    def _by_slopes(self, operation: str, arguments: list[Form]) -> Form:
        """Return a function by the mean value theorem; at points its values."""
        points = [Slope(Spans(x.centre, x.centre), {}) for x in arguments]
        at = applied(operation, points).value
        still = np.all([x.reach == 0.0 for x in arguments], axis=0)
        if still.all():
            return self.of(at)
        over = applied(operation, [Slope(x.span, {str(k): ONE}) for k, x in enumerate(arguments)])
        terms: list[tuple[Form, Any]] = [(self.of(at), 1.0)]
        for k, x in enumerate(arguments):
            slope = over.along.get(str(k))
            if slope is not None:
                away = Form(np.zeros_like(x.centre), x.weights, x.rest)
                terms.append((away, Spans.of(slope)))
        return self.with_rest_symbol(_selected(still, self.of(at), combined(*terms)), ~still)

    def limit(self, x: Form, low: float, high: float) -> Form:
        """Return ``min(max(x, low), high)``."""
        ends = min(max(x.ends[0], low), high), min(max(x.ends[1], low), high)
        for operation, end in (("maximum", low), ("minimum", high)):
            if math.isfinite(end):
                x = self.apply(operation, [x, self.number(end)])
        return Form(x.centre, x.weights, x.rest, ends)

    def excess(self, value: Form, x: Form, low: float, high: float) -> Form:
        """Return the change of x by a limit: exactly 0 inside the limits."""
        nothing = total = self.number(0.0)
        for end, sign in ((low, 1.0), (high, -1.0)):  # max(low − x, 0) − max(x − high, 0)
            if math.isfinite(end):
                beyond = combined((self.number(end), sign), (x, -sign))
                total = combined((total, 1.0), (self._extreme(beyond, nothing, 1.0), sign))
        return total

    def rules(self, rulebase: RuleBase, output: str, inputs: Mapping[str, Form]) -> Form:
        """Return the conclusion of a rule base: a plane, and a band around it."""
        key = id(rulebase), output
        if key not in self._bands:
            self._bands[key] = RuleBands(self.surfaces(rulebase, output))
        brought = [self._into_range(inputs[v.name], v) for v in rulebase.inputs]
        slopes, low, high = self._bands[key].band([x.span for x in brought])
        known = np.isfinite(low) & np.isfinite(high)
        if not known.all():
            self.why = self._bands[key].why
            self.lost = self.lost | ~known
        band = Spans(low, high)
        base = self.at(band.mid().low, band.rad().low)
        return self.with_rest_symbol(combined(*zip(brought, slopes, strict=True), (base, 1.0)))

    def _into_range(self, x: Form, variable: Variable) -> Form:
        """Return an input brought into its universe."""
        if variable.outside == "clamp":
            return self.limit(x, variable.low, variable.high)
        return x

    def table(self, table: LookupTable, inputs: Mapping[str, Form]) -> Form:
        """Refuse a table."""
        raise SpanError("a table is not followed")

    def fewer(self, forms: Sequence[Form], most: int) -> list[Form]:
        """Return sets with fewer symbols: the smallest become a box (order reduction of Girard)."""
        forms = [self.with_rest_symbol(form) for form in forms]
        weights = np.stack([form.over(self.symbols) for form in forms])  # (values, symbols, sets)
        if not self.symbols:
            return forms
        size, sets = len(weights), weights.shape[2]
        used = (weights != 0.0).any(axis=0)
        count = used.sum(axis=0)
        many = count > most * size
        stay = (most // 2) * size
        rows = max(int(count[~many].max(initial=0)), (stay + size) * bool(many.any()))
        # Each set has its own choice: symbols in their order, those of most values first if many.
        sizes = np.abs(weights)
        all_of_them = np.stack(list(map(_total, sizes)))[:, None]
        share = np.nan_to_num(sizes / np.maximum(all_of_them, TINY))
        key = np.where(many, share.max(axis=0) - _total(share), -1.0 * used)
        order = np.argsort(key, axis=0, kind="stable")
        weights = np.take_along_axis(weights, order[None], axis=1)
        fewer = np.zeros((size, rows, sets))
        fewer[:, : weights.shape[1]] = weights[:, :rows]
        if many.any():
            fewer[:, stay:, many] = 0.0
            for k, rest in enumerate(np.abs(weights[:, stay:])):
                fewer[k, stay + k, many] = (_total(rest) * ENLARGED)[many]
        self.symbols = rows
        return [
            Form(form.centre, row, np.zeros_like(form.rest))
            for form, row in zip(forms, fewer, strict=True)
        ]
