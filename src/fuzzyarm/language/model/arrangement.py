"""How the terms of a variable lie: their cores, their order, mirror images, partitions."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from fuzzyarm.language.model.rulebase import Term, Variable
from fuzzyarm.language.model.shapes import centre, corner_points, membership_function, polyline
from fuzzyarm.symbolic.kinds import SHAPES

NEAR = 1e-9
"""Positions and memberships that differ by less, of the range or of 1, count as equal."""


class Core(NamedTuple):
    """Where a term is fullest, within the range of its variable; one position for a peak."""

    left: float
    right: float

    @property
    def middle(self) -> float:
        """The peak, or the middle of a plateau."""
        return 0.5 * (self.left + self.right)


def core_of(term: Term, variable: Variable) -> Core | None:
    """Return the core of a term; None for a linear consequent or a formula.

    A singleton has its core at its position, a curved set in its middle.
    """
    shape, low, high = term.shape, variable.low, variable.high
    if shape.kind == "singleton":
        return Core(shape.parameters[0], shape.parameters[0])
    if not SHAPES[shape.kind].fuzzy:
        return None
    if not SHAPES[shape.kind].straight:
        middle = centre(shape, low, high)
        return None if middle is None else Core(middle, middle)
    corners = polyline(shape)
    top = max(y for _, y in corners)
    full = [x for x, y in corners if y >= top - NEAR]
    left = -math.inf if corners[0][1] >= top - NEAR else full[0]
    right = math.inf if corners[-1][1] >= top - NEAR else full[-1]
    return Core(min(max(left, low), high), max(min(right, high), low))


def cores(variable: Variable) -> dict[str, Core] | None:
    """Return the core of each term, ordered by middles; None if a term has none."""
    cores_of_terms = {term.name: core_of(term, variable) for term in variable.terms}
    cores_found = {name: core for name, core in cores_of_terms.items() if core is not None}
    if len(cores_found) < len(cores_of_terms):
        return None
    return dict(sorted(cores_found.items(), key=lambda item: item[1].middle))


# --- Order ---


def crossing(variable: Variable) -> tuple[str, str, str] | None:
    """Return the term out of order, and its neighbours in the text.

    All others must be in order, rising or falling, and be three at least: randomly listed terms
    have no order to break.
    """
    cores_of_terms = cores(variable)
    if cores_of_terms is None or len(cores_of_terms) < 4:
        return None
    names = [term.name for term in variable.terms]
    middles = [cores_of_terms[name].middle for name in names]
    for sign in (1.0, -1.0):
        if _rises(middles, sign):
            return None
    for sign in (1.0, -1.0):
        for at, name in enumerate(names):
            if _rises(middles[:at] + middles[at + 1 :], sign):
                return name, names[at - 1] if at else "", names[at + 1] if names[at + 1 :] else ""
    return None


def _rises(middles: list[float], sign: float) -> bool:
    return all(sign * first <= sign * second for first, second in pairwise(middles))


# --- Partitions ---


class Unlike(NamedTuple):
    """Where the memberships of neighbouring terms do not add up to one."""

    left: str
    right: str
    position: float
    total: float


def partition_faults(variable: Variable) -> list[Unlike] | None:
    """Return the pairs of neighbours whose memberships do not add up to 1.

    None where no partition is expected: values, curved or lowered terms, fewer than two terms.
    """
    cores_of_terms = cores(variable)
    straight = all(
        SHAPES[member.shape.kind].fuzzy
        and SHAPES[member.shape.kind].straight
        and member.shape.kind != "singleton"
        and member.shape.height == 1.0
        for member in variable.terms
    )
    if cores_of_terms is None or len(cores_of_terms) < 2 or not straight:
        return None
    degrees = [membership_function(term.shape) for term in variable.terms]
    corners = sorted({x for term in variable.terms for x in corner_points(term.shape)})
    faults = []
    for (left, first), (right, second) in pairwise(cores_of_terms.items()):
        begin, end = first.right, second.left
        inside = [begin, *(x for x in corners if begin < x < end), end]
        # Between two corners a line is determined by ends and midpoint.
        inside += [0.5 * (a + b) for a, b in pairwise(inside)]
        totals = {x: sum(degree(x) for degree in degrees) for x in inside}
        worst = max(totals, key=lambda x: abs(totals[x] - 1.0))
        if abs(totals[worst] - 1.0) > NEAR:
            faults.append(Unlike(left, right, worst, totals[worst]))
    return faults


# --- Mirror images ---


def mirror_pairs(variable: Variable) -> list[tuple[str, str]] | None:
    """Return opposite terms from outside in, by their order; the middle one is its own."""
    cores_of_terms = cores(variable)
    if cores_of_terms is None or not (math.isfinite(variable.low) and math.isfinite(variable.high)):
        return None
    names = list(cores_of_terms)
    return [(names[at], names[-1 - at]) for at in range((len(names) + 1) // 2)]


def mirror_faults(variable: Variable) -> Iterator[tuple[str, str]]:
    """Yield the opposite terms that are not mirror images about the middle of the range."""
    for first, second in mirror_pairs(variable) or ():
        if not _mirrored(variable.term(first), variable.term(second), variable):
            yield first, second


def _mirrored(first: Term, second: Term, variable: Variable) -> bool:
    turn, width = variable.low + variable.high, variable.high - variable.low
    if "singleton" in (first.shape.kind, second.shape.kind):
        if first.shape.kind != second.shape.kind:
            return False
        return abs(first.shape.parameters[0] + second.shape.parameters[0] - turn) <= NEAR * width
    one, other = membership_function(first.shape), membership_function(second.shape)
    positions = {*corner_points(first.shape), *(turn - x for x in corner_points(second.shape))}
    positions |= {variable.low + width * share / 16 for share in range(17)}
    inside = [x for x in positions if variable.low <= x <= variable.high]
    # A corner off by its last bits is amplified by the slope beside it.
    return all(abs(one(x) - other(turn - x)) <= 1e-6 for x in inside)
