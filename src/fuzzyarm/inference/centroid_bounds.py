r"""Bounds of a centroid between two memberships: the one routine of proofs and of type-2 sets.

Let the membership lie between two curves, L ≤ μ ≤ U. Its centroid is greatest for the μ that
is L on the left of some c and U on the right of it, and c is that centroid (Karnik and
Mendel). So c is the root of

    F(c) = ∫_{y<c} (y − c) L(y) dy + ∫_{y>c} (y − c) U(y) dy,

which falls. Curves are given as lines on panels; prefix sums of area and moment find the panel
where F changes its sign, and steps c ← M / A, kept between brackets, find c inside. The
iterates are inner bounds: what is returned is the bracket outside. The least centroid is that
of the mirrored curves. Sums over samples or numbers are the same with weights for lines;
there the greatest over all switch points is exact.

References
----------
N. N. Karnik, J. M. Mendel, *Centroid of a type-2 fuzzy set*, 2001.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

__all__ = ["average_bounds", "centroid_bounds"]

_STEPS = 60
"""Most steps inside a panel; Newton's take five, halving takes over where they do not."""


def centroid_bounds(edges: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return the least and the greatest centroid of memberships between two curves.

    Parameters
    ----------
    edges : ndarray, shape (n + 1,)
        Ends of the panels, increasing.
    lower, upper : ndarray, shape (..., n, 2)
        The curves at the left and the right end of each panel, from within; straight between.

    Returns
    -------
    (ndarray, ndarray), shape (...)
        Rounded outward by about 1e-13 of the range. Where `lower` is 0 everywhere the ends of
        what `upper` covers; NaN where that is 0 too.
    """
    import numpy as np

    greatest = _greatest(edges, lower, upper)
    mirrored = -edges[::-1]
    least = -_greatest(mirrored, lower[..., ::-1, ::-1], upper[..., ::-1, ::-1])
    nothing = ~(upper > 0.0).any(axis=(-2, -1))
    return np.where(nothing, np.nan, least), np.where(nothing, np.nan, greatest)


def _greatest(edges: Array, lower: Array, upper: Array) -> Array:
    import numpy as np

    area_lower, moment_lower = _integrals(edges, lower)
    area_upper, moment_upper = _integrals(edges, upper)
    # What is left of each edge by the lower curve, right of it by the upper one.
    left_area, left_moment = _from_left(area_lower), _from_left(moment_lower)
    right_area, right_moment = _from_right(area_upper), _from_right(moment_upper)
    slope = left_moment - edges * left_area + right_moment - edges * right_area
    # F falls: the last edge at which it is above 0 is the left end of the panel.
    panel = np.clip((slope > 0.0).sum(axis=-1) - 1, 0, len(edges) - 2)

    def pick(values: Any) -> Array:
        return np.take_along_axis(values, panel[..., None], axis=-1)[..., 0]

    after = panel + 1
    base_area = pick(left_area) + np.take_along_axis(right_area, after[..., None], -1)[..., 0]
    base_moment = pick(left_moment) + np.take_along_axis(right_moment, after[..., None], -1)[..., 0]
    low, high = edges[panel], edges[after]
    ends = [pick(curve[..., side]) for curve in (lower, upper) for side in (0, 1)]
    return _root(low, high, base_area, base_moment, *ends)


def _root(
    left: Array,
    right: Array,
    area: Array,
    moment: Array,
    lower_left: Array,
    lower_right: Array,
    upper_left: Array,
    upper_right: Array,
) -> Array:
    """Find where F changes its sign inside a panel, from outside."""
    import numpy as np

    width = right - left
    low, high = left.copy(), right.copy()
    c = 0.5 * (low + high)
    slack = 1e-14 * (np.abs(left) + np.abs(right)) + 1e-300
    for _ in range(_STEPS):
        share = (c - left) / width
        lower_at = lower_left + share * (lower_right - lower_left)
        upper_at = upper_left + share * (upper_right - upper_left)
        a1, m1 = _trapezoid(left, c, lower_left, lower_at)
        a2, m2 = _trapezoid(c, right, upper_at, upper_right)
        whole, total = area + a1 + a2, moment + m1 + m2
        positive = total - c * whole > 0.0
        low, high = np.where(positive, c, low), np.where(positive, high, c)
        if np.all(high - low <= slack):
            break
        with np.errstate(all="ignore"):
            following = total / whole
        # A little beyond the step, so that both brackets close in.
        following = following + np.where(positive, 1.0, -1.0) * 0.25 * slack
        inside = (following > low) & (following < high)
        c = np.where(inside, following, 0.5 * (low + high))
    scale = np.abs(left) + np.abs(right) + width
    return np.asarray(high + 1e-13 * scale)


def _trapezoid(a: Array, b: Array, ya: Array, yb: Array) -> tuple[Array, Array]:
    """Return area and moment below a straight line."""
    width = b - a
    area = 0.5 * width * (ya + yb)
    return area, width * (a * (2.0 * ya + yb) + b * (ya + 2.0 * yb)) / 6.0


def _integrals(edges: Array, curve: Array) -> tuple[Array, Array]:
    return _trapezoid(edges[:-1], edges[1:], curve[..., 0], curve[..., 1])


def _from_left(values: Array) -> Array:
    """Return the sums of what is left of each edge."""
    import numpy as np

    total = np.cumsum(values, axis=-1)
    return np.concatenate([np.zeros_like(total[..., :1]), total], axis=-1)


def _from_right(values: Array) -> Array:
    """Return the sums of what is right of each edge."""
    import numpy as np

    total = np.cumsum(values[..., ::-1], axis=-1)[..., ::-1]
    return np.concatenate([total, np.zeros_like(total[..., :1])], axis=-1)


def average_bounds(
    least: Array, greatest: Array, lower: Array, upper: Array
) -> tuple[Array, Array]:
    """Return the least and the greatest weighted average of numbers with weights between bounds.

    Parameters
    ----------
    least, greatest : ndarray, shape (..., n)
        Between what each number lies; equal for constants.
    lower, upper : ndarray, shape (..., n)
        Between what each weight lies, not negative.

    Returns
    -------
    (ndarray, ndarray), shape (...)
        Exact up to rounding, then widened by 1e-13 of the numbers; NaN where all weights are 0.
    """
    import numpy as np

    def highest(numbers: Array) -> Array:
        order = np.argsort(numbers, axis=-1, kind="stable")
        x = np.take_along_axis(np.broadcast_to(numbers, upper.shape), order, -1)
        low = np.take_along_axis(lower, order, -1)
        high = np.take_along_axis(upper, order, -1)
        area = _from_left(low) + _from_right(high)
        moment = _from_left(low * x) + _from_right(high * x)
        with np.errstate(all="ignore"):
            found = np.where(area > 0.0, moment / area, -np.inf).max(axis=-1)
        return np.asarray(found + 1e-13 * np.abs(x).max(axis=-1))

    greatest, least = (np.broadcast_to(each, upper.shape) for each in (greatest, least))
    top, bottom = highest(greatest), -highest(-least)
    nothing = ~(upper > 0.0).any(axis=-1)
    return np.where(nothing, np.nan, bottom), np.where(nothing, np.nan, top)
