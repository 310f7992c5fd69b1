r"""Affine forms over arrays: sets of states as zonotopes, with every rounding included.

A form is ``c + Σ aᵢ εᵢ ± r``: a centre, a part of each **symbol** εᵢ in [-1, 1], and a **rest**, an
independent remainder. Several forms over the same symbols are a zonotope: a symbol keeps its
effects on all of them together. So sums and multiples of forms are exact except for rounding, and
only the nonlinear part of a product or function goes into the rest,

    x y     with   Σᵢ Σₗ aᵢ bₗ εᵢ εₗ   bounded, where εᵢ² lies in [0, 1];
    g(x)  =  g(c) + g'(c) d + ½ g''(c) d² + ⅙ g'''(ξ) d³,   d = x - c, ξ between c and x,
    d²    =  ½ ρ² ± ½ ρ²,   d³ = ¾ ρ² d ± ¼ ρ³   (a Chebyshev polynomial),   |d| ≤ ρ.

An array of forms has the shape of its centres, with one more axis in front for the symbols. The
last axis is the **batch**: boxes followed at the same time, each with its own symbols.

The relative error of a float operation is at most 2⁻⁵³, so that of a sum of products in any order
is at most γₙ = n 2⁻⁵³ / (1 - n 2⁻⁵³) times the sum of their magnitudes, with n operations on each
term (Higham, *Accuracy and Stability of Numerical Algorithms*, section 3.1). It is added to the
rest. Sums of rests themselves are enlarged by :data:`ENLARGED`.

Sources: J. L. D. Comba and J. Stolfi, "Affine arithmetic and its applications to computer
graphics", SIBGRAPI 1993; A. Girard, "Reachability of uncertain linear systems using zonotopes",
HSCC 2005 (fewer symbols).
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from fuzzyarm.proof.loop import enclosure
from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals, Vector, outward
from fuzzyarm.symbolic.evaluation import derivative, specialise
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, apply, constant, postorder, symbol

ENLARGED = 1.0 + 2.0**-40
"""Enlargement of sums of magnitudes: 4,000 roundings, without cancellation."""

ROUNDING = 2.0**-52
"""Twice the largest relative error of a rounding: γₙ ≤ n times this."""

TINY = 1e-300
"""More than the error of a thousand subnormal results."""


def _total(parts: Vector) -> Vector:
    """Return the sums of magnitudes over symbols, rounded up."""
    return np.asarray(np.abs(parts).sum(axis=0) * ENLARGED)


class Forms:
    """An array of affine forms over the same symbols.

    Parameters
    ----------
    centre : ndarray, shape S
        c.
    parts : ndarray, shape (m, *S)
        aᵢ, by symbol.
    rest : ndarray, shape S
        r, not negative.

    Examples
    --------
    >>> x = Forms.between([1.0], [3.0]).with_symbols(1, [0])
    >>> x - x
    <Forms 0 ± 0 with 1 symbol>
    """

    __slots__ = ("_spread", "centre", "parts", "rest")

    def __init__(
        self, centre: Vector, parts: Vector, rest: Vector, spread: Vector | None = None
    ) -> None:
        self.centre = centre
        self.parts = parts
        self.rest = rest
        self._spread = spread

    def __repr__(self) -> str:
        text = f"{self.centre.flat[0]:g} ± {self.radius.flat[0]:.3g}" if self.centre.size else ""
        count = len(self.parts)
        return f"<Forms {text} with {count} symbol{'s' * (count != 1)}>"

    @classmethod
    def at(cls, values: Any) -> Forms:
        """Return constant forms."""
        centre = np.asarray(values, float)
        zeros = np.zeros_like(centre)
        return cls(centre, np.zeros((0, *centre.shape)), zeros, zeros)

    @classmethod
    def between(cls, low: Any, high: Any) -> Forms:
        """Return forms of intervals, without symbols."""
        return cls.of(Intervals.between(low, high))

    @classmethod
    def of(cls, intervals: Intervals) -> Forms:
        """Return forms of intervals, without symbols."""
        centre = intervals.middle
        if not np.isfinite(intervals.size).all():
            raise EnclosureError("an interval without end")
        return cls(centre, np.zeros((0, *centre.shape)), intervals.radius, np.zeros_like(centre))

    # ── bounds ───────────────────────────────────────────────────────────────────────────

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the array."""
        return self.centre.shape

    @property
    def spread(self) -> Vector:
        """The sum of the magnitudes of the parts, rounded up."""
        if self._spread is None:
            self._spread = _total(self.parts)
        return self._spread

    @property
    def radius(self) -> Vector:
        """The largest distance of values from the centre, rounded up."""
        return np.asarray((self.spread + self.rest) * ENLARGED)

    @property
    def bounds(self) -> Intervals:
        """The smallest intervals around all values, rounded outward."""
        intervals = outward(self.centre - self.radius, self.centre + self.radius)
        exact = self.radius == 0.0
        return Intervals(
            np.where(exact, self.centre, intervals.low),
            np.where(exact, self.centre, intervals.high),
        )

    def __getitem__(self, index: Any) -> Forms:
        indices = index if isinstance(index, tuple) else (index,)
        spread = None if self._spread is None else np.asarray(self._spread[indices])
        return Forms(
            np.asarray(self.centre[indices]),
            self.parts[(slice(None), *indices)],
            np.asarray(self.rest[indices]),
            spread,
        )

    # ── symbols ──────────────────────────────────────────────────────────────────────

    def with_symbols(self, count: int, symbols: Sequence[int] | None = None) -> Forms:
        """Return the same forms over `count` symbols.

        `symbols`: for each form along the first axis (or the only one), the new symbol for its
        rest. No other form may use that symbol.
        """
        parts = np.zeros((count, *self.shape))
        parts[: len(self.parts)] = self.parts
        if symbols is None:
            return Forms(self.centre, parts, self.rest, self._spread)
        if self.centre.ndim == 1:
            (symbol,) = symbols
            parts[symbol] += self.rest
        else:
            for row, symbol in enumerate(symbols):
                parts[symbol, row] += self.rest[row]
        return Forms(self.centre, parts, np.zeros_like(self.rest))

    def reduced(self, columns: int, most: int) -> Forms:
        """Return forms, one for each state along the first axis, over fewer symbols.

        The smallest symbols become one for each state (Girard's method): the bounding box of the
        zonotope that they span. The first `columns` symbols stay.
        """
        states = self.shape[0]
        count = len(self.parts)
        if count <= most:
            return self
        sizes = np.abs(self.parts[columns:])
        scale = np.maximum(sizes.sum(axis=0), TINY)
        share = sizes / scale
        # A symbol of a single state is a box already.
        weight = (share.sum(axis=1) - share.max(axis=1)).sum(axis=1)
        order = np.argsort(weight, kind="stable")
        dropped = order[: count - columns - (most - columns - states)]
        stays = np.ones(count, dtype=bool)
        stays[columns + dropped] = False
        rest = (self.rest + np.abs(self.parts[columns + dropped]).sum(axis=0)) * ENLARGED
        forms = Forms(self.centre, self.parts[stays], rest)
        staying = int(stays.sum())
        return forms.with_symbols(staying + states, range(staying, staying + states))

    # ── sums and multiples ───────────────────────────────────────────────────────────

    def __neg__(self) -> Forms:
        return Forms(-self.centre, -self.parts, self.rest, self._spread)

    def __add__(self, other: Forms | float) -> Forms:
        if not isinstance(other, Forms):
            centre = self.centre + other
            rest = (self.rest + ROUNDING * np.abs(centre)) * ENLARGED
            return Forms(centre, self.parts, rest, self._spread)
        a, b = aligned(self, other)
        centre, parts = a.centre + b.centre, a.parts + b.parts
        spread = _total(parts)
        rest = (a.rest + b.rest + ROUNDING * (np.abs(centre) + spread)) * ENLARGED
        return Forms(centre, parts, rest, spread)

    __radd__ = __add__

    def __sub__(self, other: Forms | float) -> Forms:
        return self + (-other)

    def __rsub__(self, other: float) -> Forms:
        return -self + other

    def scaled(self, factor: Any) -> Forms:
        """Return a multiple: by one float, or one for each form."""
        factor = np.asarray(factor, float)
        size = np.abs(factor)
        centre, parts = self.centre * factor, self.parts * factor
        spread = self.spread * size * ENLARGED
        rest = (self.rest * size + ROUNDING * (np.abs(centre) + spread)) * ENLARGED
        some = (size > 0.0) & (np.abs(self.centre) + self.radius > 0.0)  # else it is 0
        rest = rest + np.where(some, TINY, 0.0)
        return Forms(centre, parts, rest, spread)

    def within(self, more: Any) -> Forms:
        """Return the same forms with larger rests."""
        return Forms(self.centre, self.parts, (self.rest + more) * ENLARGED, self._spread)

    # ── nonlinear operations ─────────────────────────────────────────────────────────────

    def __mul__(self, other: Forms | float) -> Forms:
        if not isinstance(other, Forms):
            return self.scaled(other)
        return dot(self[None], other[None])

    __rmul__ = __mul__

    def __truediv__(self, other: Forms | float) -> Forms:
        if isinstance(other, Forms):
            return self * other.function("reciprocal")
        if other == 0.0:
            raise EnclosureError("a division by 0")
        return self.scaled(1.0 / other)  # two roundings, as included there

    def function(self, name: str) -> Forms:
        """Return a function of :data:`FUNCTIONS`."""
        radius, zero = self.radius, Intervals.at(np.zeros(self.shape))
        start, slope, bend, *_ = _with_derivatives(name, Intervals.at(self.centre), 2)
        whole, _, bends, twist = _with_derivatives(name, self.bounds, 3)
        square = Intervals.at(radius).squared()
        # Two bounds: ½ g''(ξ) d²; or ½ g''(c) d² and the cube, which has a linear part.
        curved = (bends * square * 0.5).hull(zero)
        cube = square * Intervals.at(radius)
        sizes, radii = Intervals.at(twist.size), Intervals.at(twist.radius)
        whirl = cube * sizes / 24.0 + cube * radii / 6.0
        more = (bend * square * 0.5).hull(zero) + Intervals(-whirl.high, whirl.high)
        better = more.radius < curved.radius
        curved = Intervals(
            np.where(better, more.low, curved.low), np.where(better, more.high, curved.high)
        )
        tilted = slope + Intervals.at(twist.middle) * square * 0.125
        slope = Intervals(
            np.where(better, tilted.low, slope.low), np.where(better, tilted.high, slope.high)
        )
        steep = slope.middle
        linear = self.scaled(steep)
        linear = Forms(np.zeros_like(steep), linear.parts, linear.rest, linear._spread)
        # c is not in the scaled part: its rounding is included at most once too often, which is
        # sound.
        tilt = (slope.radius * radius) * ENLARGED
        forms = linear.within(tilt) + Forms.of(start + curved)
        plain = Forms.of(whole)
        # Dependence on symbols is dropped only if it is smaller than the nonlinear part.
        return chosen(plain.radius < forms.rest, plain, forms)


def aligned(a: Forms, b: Forms) -> tuple[Forms, Forms]:
    """Return two forms over the same symbols."""
    count = max(len(a.parts), len(b.parts))
    return (
        a if len(a.parts) == count else a.with_symbols(count),
        b if len(b.parts) == count else b.with_symbols(count),
    )


def joined(a: Forms, b: Forms, axis: int = 0) -> Forms:
    """Return two arrays of forms as one, along an axis."""
    a, b = aligned(a, b)
    pairs = (a.centre, b.centre), (a.parts, b.parts), (a.rest, b.rest)
    after = axis + 1 if axis >= 0 else axis  # symbols come first
    axes = (axis, after, axis)
    return Forms(*(np.concatenate(pair, axis=k) for pair, k in zip(pairs, axes, strict=True)))


def stacked(forms: Sequence[Forms]) -> Forms:
    """Return forms of one shape along a new first axis."""
    count = max(len(form.parts) for form in forms)
    every = [form if len(form.parts) == count else form.with_symbols(count) for form in forms]
    return Forms(
        np.stack([item.centre for item in every]),
        np.stack([item.parts for item in every], axis=1),
        np.stack([item.rest for item in every]),
        np.stack([item.spread for item in every]),
    )


def chosen(condition: Any, first: Forms, second: Forms) -> Forms:
    """Return the first form where a condition holds, else the second."""
    if not np.any(condition):
        return second
    first, second = aligned(first, second)
    return Forms(
        np.where(condition, first.centre, second.centre),
        np.where(condition, first.parts, second.parts),
        np.where(condition, first.rest, second.rest),
    )


def dot(a: Forms, b: Forms) -> Forms:
    """Return the sums of products along the first axis."""
    a, b = aligned(a, b)
    ca, cb, pa, pb, ra, rb = a.centre, b.centre, a.parts, b.parts, a.rest, b.rest
    sa, sb = a.spread, b.spread
    size_a, size_b = np.abs(ca), np.abs(cb)
    operations = (2 * len(ca) + len(pa) + 8) * ROUNDING
    if len(pa):
        products = pa * pb
        squares = products.sum(axis=1)  # of each symbol with itself
        parts = (ca * pb).sum(axis=1) + (cb * pa).sum(axis=1)
        magnitude = np.abs(products).sum(axis=(0, 1))
        centre = (ca * cb).sum(axis=0) + 0.5 * squares.sum(axis=0)
        both = (sa * sb).sum(axis=0)
        # Symbols with others, then each with itself: εᵢ² is ½ ± ½.
        curved = np.maximum(both * ENLARGED - magnitude / ENLARGED, 0.0)
        curved = curved + 0.5 * np.abs(squares).sum(axis=0)
    else:
        parts = np.zeros((0, *np.broadcast_shapes(ca.shape, cb.shape)[1:]))
        centre = (ca * cb).sum(axis=0)
        both = curved = np.zeros_like(centre)
    cross = (size_a * rb + size_b * ra + sa * rb + sb * ra + ra * rb).sum(axis=0)
    sizes = (size_a * size_b + size_a * sb + size_b * sa).sum(axis=0) + both
    some = (size_a + sa + ra > 0.0) & (size_b + sb + rb > 0.0)  # else the product is 0
    rest = (curved + cross + operations * sizes) * ENLARGED
    return Forms(centre, parts, rest + np.where(some.any(axis=0), TINY, 0.0))


# ── functions ────────────────────────────────────────────────────────────────────────


X, MINUS_ONE = symbol("x"), constant(-1.0)


@cache
def _derivatives_of(name: str) -> tuple[Node, ...]:
    """Return the first three derivatives of a function of `X`, from its record."""
    roots: list[Node] = [apply(name, X)]
    for _ in range(3):
        # Its constants are small multiples of powers of two: none is rounded.
        roots.append(specialise(derivative(roots[-1], X.name), {}))
    return tuple(roots[1:])


PAIRS: dict[str, Callable[[Intervals], tuple[Intervals, Intervals]]] = {
    "sin cos": enclosure.waves,
    "sinh cosh": enclosure.hyperbolics,
}
"""Functions enclosed together, which are each other's derivatives."""


def _with_derivatives(name: str, x: Intervals, count: int) -> tuple[Intervals, ...]:
    """Return a function's values and its first derivatives over intervals."""
    if name == "reciprocal":
        inverse = 1.0 / x
        square = inverse.squared()
        return inverse, -square, square * inverse * 2.0, -(square.squared() * 6.0)
    values: dict[Node, Intervals] = {X: x}
    for pair, together in PAIRS.items():
        if name in pair.split():
            first, second = (apply(word, X) for word in pair.split())
            values[first], values[second] = together(x)
    roots = (apply(name, X), *_derivatives_of(name)[:count])
    for node in postorder(*roots):
        if node not in values:
            values[node] = _enclosed(node, values)
    return tuple(values[root] for root in roots)


def _enclosed(node: Node, values: Mapping[Node, Intervals]) -> Intervals:
    if isinstance(node, Constant):
        return Intervals.at(node.value)
    assert isinstance(node, Apply)
    arguments = [values[argument] for argument in node.arguments]
    if node.operation == "multiply":
        first, second = node.arguments
        if first is second:
            return arguments[0].squared()
        if first is MINUS_ONE:  # no rounding
            return -arguments[1]
    if node.operation == "power":
        exponent = node.arguments[1]
        assert isinstance(exponent, Constant)
        return enclosure.power(arguments[0], exponent.value)
    return {**_ARITHMETIC, **enclosure.FUNCTIONS}[node.operation](*arguments)


_ARITHMETIC: dict[str, Callable[..., Intervals]] = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "negative": operator.neg,
}

FUNCTIONS = (*enclosure.FUNCTIONS, "reciprocal")
"""Smooth functions of forms: operations with values in :mod:`.enclosure`."""


# ── corners ──────────────────────────────────────────────────────────────────────────


def positive_part(x: Forms) -> Forms:
    """Return max(x, 0): for an undecided sign, a band around a straight line."""
    bounds = x.bounds
    low, high = bounds.low, bounds.high
    if (low >= 0.0).all():
        return x
    undecided = (low < 0.0) & (high > 0.0)
    # Any slope λ in [0, 1] is sound: max(x, 0) - λ x lies between 0 and the larger of -λ l and
    # (1 - λ) h.
    slope = np.where(
        undecided, high / np.where(undecided, high - low, 1.0), (low >= 0.0).astype(float)
    )
    slope = np.clip(slope, 0.0, 1.0)
    band = (
        Intervals.at(-slope) * Intervals.at(low),
        (1.0 - Intervals.at(slope)) * Intervals.at(high),
    )
    most = np.where(undecided, np.maximum(band[0].high, band[1].high), 0.0)
    return x.scaled(slope) + Forms.between(np.zeros_like(most), np.maximum(most, 0.0))


def larger(a: Forms, b: Forms) -> Forms:
    """Return the larger of two."""
    bounds = (a - b).bounds
    if (bounds.low >= 0.0).all():
        return a
    if (bounds.high <= 0.0).all():
        return b
    return b + positive_part(a - b)


def smaller(a: Forms, b: Forms) -> Forms:
    """Return the smaller of two."""
    return -larger(-a, -b)


def clip(x: Forms, low: float, high: float) -> Forms:
    """Return x within limits, either of which may be infinite."""
    bounds = x.bounds
    if np.isfinite(low) and np.any(bounds.low < low):
        x = positive_part(x - low) + low
    if np.isfinite(high) and np.any(bounds.high > high):
        x = -(positive_part(-x + high)) + high
    return x
