"""The integral of an aggregate without a closed form, adaptively.

The range is cut at all corners and bends of the sets; each panel takes eight Gauss–Lobatto nodes
(with the ends: a bend close to one would otherwise be overlooked) and is halved until the halves
agree with the whole to :data:`TOLERANCE` of the area, of the panel or of all. Curves that are
clipped or cross each other are found by the halving. The kernel is :mod:`.quadrature_kernel`; the
error is below 1e-11 of the range (tested against closed forms and SciPy).
"""

from __future__ import annotations

from fuzzyarm.inference.plan import OutputPlan

NODES = (0.20929921790247888, 0.5917001814331423, 0.8717401485096066, 1.0)
"""Positive nodes of the eight-point rule on −1 … 1; exact to the 13th degree."""

WEIGHTS = (0.4124587946587038, 0.34112269248350435, 0.2107042271435061, 1.0 / 28.0)
"""Their weights."""

TOLERANCE = 1e-15
"""Of the area."""

DEEPEST = 52
"""Halvings of a panel; a jump is then narrower than the spacing of floats."""

MOST_PANELS = 20_000
"""Panels of one point: no set is worth more; the rest is used unrefined."""

SAME_HALF = 1e-12
"""Shares of an area closer to one half than this are one half."""

HALVINGS = 60
"""Of a panel, to where half of the area is reached."""

ROUNDING = 2.0**-52
"""Of one operation on a degree near 1."""


def noise_of(plan: OutputPlan, strongest: float) -> float:
    """Return the rounding error that a height of the aggregate may have.

    A smaller disagreement must not halve a panel, or halving would not end. The error is
    proportional to the strongest rule, except under ``bounded``, which subtracts 1.
    """
    subtracts = any(member.implication == "bounded" for member in plan.members)
    return ROUNDING * (1.0 if subtracts else min(1.0, strongest))


CLIPPING: dict[str, tuple[tuple[float, float], ...]] = {
    "min": ((0.0, 1.0),),
    "bounded": ((1.0, -1.0),),
    "nilpotent": ((0.0, 1.0), (1.0, -1.0)),
}
"""Implications that bend a set where it passes a + b × strength: their (a, b)."""


def panels(plan: OutputPlan) -> list[float]:
    """Return the possible bends of the sets of an output, in order."""
    edges = {piece.x0 for member in plan.members for piece in member.pieces}
    return sorted(edges | {plan.output.low, plan.output.high})
