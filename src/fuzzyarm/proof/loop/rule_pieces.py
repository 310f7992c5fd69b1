"""What a certificate says of a rule base, checked on its pieces: a sector, slopes, a range.

On each piece (a simplex) an output is N/D, two polynomials. Written in barycentric coordinates λ
that are homogeneous, a polynomial whose coefficients are all at least 0 is at least 0 on the
simplex. A claim is such a polynomial; where that does not show it the simplex is halved, up to
:data:`DEEPEST` times. Rationals throughout, and nothing of the code that found the claim.

    sector    k₁ σ² ≤ u σ ≤ k₂ σ²:   ± (N − k σ D) ≥ 0 on the side of σ = 0 where σ is ± positive
    slope     k₁ ≤ ∂u/∂x ≤ k₂:       (∂N D − N ∂D) − k₁ D² ≥ 0, k₂ D² − … ≥ 0
    range     k₁ ≤ u ≤ k₂:           N − k₁ D ≥ 0, k₂ D − N ≥ 0
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations
from math import comb, factorial, prod
from typing import NamedTuple

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.loop.spans import RationalInterval
from fuzzyarm.proof.map.arithmetic import as_fraction, rationals
from fuzzyarm.proof.map.bernstein import lattice
from fuzzyarm.proof.map.pieces import Cut, cut
from fuzzyarm.proof.map.straight import NotStraightError, Straight, straight, with_fixed
from fuzzyarm.proof.map.surface import Surface
from fuzzyarm.proof.stop import Stop

__all__ = ["RulePieces"]

Powers = tuple[int, ...]
Polynomial = dict[Powers, Fraction]
"""Coefficients by the powers of λ₀ … λ_d, which add up to the same degree in all of them."""

DEEPEST = 14
"""How often a simplex is halved before a claim is given up."""

Region = Mapping[str, tuple[Fraction, Fraction]]


class SimplexPiece(NamedTuple):
    """A simplex and an output on it, ``upper / lower``."""

    corners: tuple[tuple[Fraction, ...], ...]
    upper: Polynomial
    lower: Polynomial


class RulePieces:
    """One output of a rule base, for claims about it.

    Parameters
    ----------
    rulebase : RuleBase
        Which.
    output : str
        Its output.
    stop : Stop, optional
        When to give up.

    Raises
    ------
    LoopProofError
        If it is not made of straight pieces.
    """

    def __init__(self, rulebase: RuleBase, output: str, stop: Stop | None = None) -> None:
        self.rulebase = rulebase
        self.stop = stop or Stop()
        self.output = rulebase.output(output)
        self.names = tuple(variable.name for variable in rulebase.inputs)
        try:
            self.model: Straight = straight(rulebase, output)
        except NotStraightError as error:
            raise LoopProofError(f"'{rulebase.name}' is not made of straight pieces") from error
        self._pieces: dict[object, tuple[list[SimplexPiece], bool]] = {}

    # ── the pieces ───────────────────────────────────────────────────────────────────

    def _cut(self, region: Region) -> tuple[list[SimplexPiece], bool]:
        """Return the pieces over a region, and whether a term jumps in it."""
        key = tuple(region[name] for name in self.names)
        if key not in self._pieces:
            self._pieces[key] = self._newly_cut(key)
        return self._pieces[key]

    def _newly_cut(
        self, box: tuple[tuple[Fraction, Fraction], ...]
    ) -> tuple[list[SimplexPiece], bool]:
        for variable, (low, high) in zip(self.rulebase.inputs, box, strict=True):
            inside = variable.low <= low <= high <= variable.high
            if variable.outside != "extend" and not inside:
                raise LoopProofError(f"'{variable.name}' leaves its universe")
        points = {k: low for k, (low, high) in enumerate(box) if low == high}
        model, free = self.model, list(range(len(box)))
        if 0 < len(points) < len(box):  # pieces of the dimension of what moves
            model = with_fixed(model, points)
            free = [k for k in free if k not in points]
        cells = cut(model, Cut(tuple(box[k] for k in free)), rationals(), stop=self.stop)
        surface = Surface(model, cells)
        if surface.silent(valued=True) is not None:
            raise LoopProofError(f"'{self.rulebase.name}' may have no value somewhere")
        values = surface.value()
        indices = lattice(values.corners.shape[2], values.degree)
        weights = [
            Fraction(factorial(values.degree), prod(map(factorial, index))) for index in indices
        ]
        centre = as_fraction(surface.centre)
        pieces = []
        for owner, corners, above, below in zip(
            values.owner, values.corners, values.upper, values.lower, strict=True
        ):
            self.stop.check()
            lower = {i: as_fraction(b) * w for i, b, w in zip(indices, below, weights, strict=True)}
            upper = {
                i: as_fraction(a) * w + centre * lower[i]
                for i, a, w in zip(indices, above, weights, strict=True)
            }
            if not _is_positive(lower):
                raise LoopProofError(f"'{self.rulebase.name}' may have no value somewhere")
            # Corners are shares of a cell.
            cell_index = []
            for corner in corners:
                place = dict(points)
                place.update(zip(free, cells.position(int(owner), corner), strict=True))
                cell_index.append(tuple(place[k] for k in range(len(box))))
            pieces.append(SimplexPiece(tuple(cell_index), upper, lower))
        self._demand_unclamped(pieces)
        return pieces, any(cells.grid.jumps)

    def _demand_unclamped(self, pieces: Sequence[SimplexPiece]) -> None:
        """Refuse an output that is brought back into its range: it is not N/D there."""
        if self.output.outside == "extend":
            return
        low, high = Fraction(self.output.low), Fraction(self.output.high)
        if not all(_is_within(piece, low, high) for piece in pieces):
            raise LoopProofError(f"'{self.output.name}' leaves its range")

    # ── claims ───────────────────────────────────────────────────────────────────────

    def has_range(self, region: Region, low: Fraction, high: Fraction) -> bool:
        """Tell whether the output is proved to lie between two numbers over a region."""
        return all(_is_within(piece, low, high) for piece in self._cut(region)[0])

    def has_sector(
        self, region: Region, weights: Mapping[str, Fraction], low: Fraction, high: Fraction
    ) -> bool:
        """Tell whether the output is proved to be σ = Σ wᵢ xᵢ times a gain between two numbers."""
        row = [weights.get(name, Fraction(0)) for name in self.names]
        for piece in self._cut(region)[0]:
            self.stop.check()
            for side in _sides(piece, row):
                sums = _sums(side, row)
                sign = -1 if any(total < 0 for total in sums) else 1
                sigma = _linear(sums)
                along = _product(sigma, side.lower)
                value = _raised(side.upper, _degree(along) - _degree(side.upper))
                for gain, way in ((low, sign), (high, -sign)):
                    gap = _sum(value, along, -gain)
                    if not _is_not_negative(_scaled(gap, Fraction(way))):
                        return False
        return True

    def has_slope(self, region: Region, name: str, low: Fraction, high: Fraction) -> bool:
        """Tell whether the slope along an input is proved to lie between two numbers."""
        pieces, jumps = self._cut(region)
        if jumps:
            raise LoopProofError(f"a term of '{self.rulebase.name}' has a vertical edge: jumps")
        axis = self.names.index(name)
        moving = [k for k, other in enumerate(self.names) if region[other][0] < region[other][1]]
        for piece in pieces:
            self.stop.check()
            steep, square = _slope(piece, axis, moving)
            if not steep and not square:
                continue  # a piece without a volume
            if not (
                _is_not_negative(_sum(steep, square, -low))
                and _is_not_negative(_sum(_scaled(square, high), steep, Fraction(-1)))
            ):
                return False
        return True

    # ── enclosures ───────────────────────────────────────────────────────────────────

    def value(self, region: Region) -> RationalInterval:
        """Return where the output is over a region, from the coefficients."""
        spans = [_ratio(piece.upper, piece.lower) for piece in self._cut(region)[0]]
        return RationalInterval(min(s.low for s in spans), max(s.high for s in spans))

    def slope(self, region: Region, name: str) -> RationalInterval:
        """Return where the slope along an input is over a region, from the coefficients."""
        pieces, jumps = self._cut(region)
        if jumps:
            raise LoopProofError(f"a term of '{self.rulebase.name}' has a vertical edge: jumps")
        axis = self.names.index(name)
        moving = [k for k, other in enumerate(self.names) if region[other][0] < region[other][1]]
        spans = []
        for piece in pieces:
            self.stop.check()
            steep, square = _slope(piece, axis, moving)
            if square:
                spans.append(_ratio(steep, square))
        return RationalInterval(min(s.low for s in spans), max(s.high for s in spans))


# ── polynomials ──────────────────────────────────────────────────────────────────────


def _degree(p: Polynomial) -> int:
    return sum(next(iter(p)))


def _sum(p: Polynomial, q: Polynomial, factor: Fraction) -> Polynomial:
    """Return p + factor q, of the larger degree of both."""
    gap = _degree(p) - _degree(q)
    p, q = _raised(p, -gap), _raised(q, gap)
    total = dict(p)
    for powers, value in q.items():
        total[powers] = total.get(powers, Fraction(0)) + factor * value
    return total


def _scaled(p: Polynomial, factor: Fraction) -> Polynomial:
    return {powers: factor * value for powers, value in p.items()}


def _product(p: Polynomial, q: Polynomial) -> Polynomial:
    total: Polynomial = {}
    for a, x in p.items():
        for b, y in q.items():
            powers = tuple(i + j for i, j in zip(a, b, strict=True))
            total[powers] = total.get(powers, Fraction(0)) + x * y
    return total


def _linear(values: Sequence[Fraction]) -> Polynomial:
    """Return the polynomial with some values at the corners."""
    size = len(values)
    return {tuple(int(i == j) for i in range(size)): value for j, value in enumerate(values)}


def _raised(p: Polynomial, by: int) -> Polynomial:
    """Return p times (λ₀ + … + λ_d)ⁿ, which is p."""
    for _ in range(max(by, 0)):
        p = _product(p, _linear([Fraction(1)] * len(next(iter(p)))))
    return p


def _along(p: Polynomial, weights: Sequence[Fraction]) -> Polynomial:
    """Return Σ wᵢ ∂p/∂λᵢ."""
    total: Polynomial = {}
    for powers, value in p.items():
        for i, weight in enumerate(weights):
            if powers[i] and weight:
                less = (*powers[:i], powers[i] - 1, *powers[i + 1 :])
                total[less] = total.get(less, Fraction(0)) + value * powers[i] * weight
    zero = dict.fromkeys(lattice(len(weights) - 1, _degree(p) - 1), Fraction(0))
    return {**zero, **total}


def _is_positive(p: Polynomial) -> bool:
    """Tell whether a polynomial is positive on the whole simplex, corners included."""
    degree = _degree(p)
    return all(value > 0 or (value == 0 and max(powers) < degree) for powers, value in p.items())


def _is_not_negative(p: Polynomial, depth: int = DEEPEST) -> bool:
    """Tell whether a polynomial is shown to be at least 0 on its simplex, by halving it."""
    if all(value >= 0 for value in p.values()):
        return True
    degree = _degree(p)
    if not depth or any(value < 0 for powers, value in p.items() if max(powers) == degree):
        return False  # a corner where it is negative
    # The edge along which the coefficients bend most.
    size = len(next(iter(p)))
    edge = max(combinations(range(size), 2), key=lambda pair: _bend(p, *pair))
    return all(_is_not_negative(half, depth - 1) for half in _halves(p, *edge))


def _bend(p: Polynomial, i: int, j: int) -> Fraction:
    """Return how much of what is negative stands next to an edge."""
    return sum((-v * (k[i] + k[j]) for k, v in p.items() if v < 0), Fraction(0))


def _halves(p: Polynomial, i: int, j: int) -> tuple[Polynomial, Polynomial]:
    """Return p on both halves, cut in the middle of an edge."""
    return _split(p, i, j, Fraction(1, 2)), _split(p, j, i, Fraction(1, 2))


def _split(p: Polynomial, stays: int, moves: int, share: Fraction) -> Polynomial:
    """Return p on the simplex whose one corner moves to ``(1 - share) stays + share moves``.

    λ_stays = μ_stays + (1 - share) μ_moves and λ_moves = share μ_moves.
    """
    total: Polynomial = {}
    for powers, value in p.items():
        n, m = powers[stays], powers[moves]
        for k in range(n + 1):
            new = list(powers)
            new[stays], new[moves] = n - k, m + k
            weight = comb(n, k) * (1 - share) ** k * share**m
            key = tuple(new)
            total[key] = total.get(key, Fraction(0)) + value * weight
    return total


def _ratio(p: Polynomial, q: Polynomial) -> RationalInterval:
    """Return bounds of p/q, q positive: of a degree at which no coefficient of q is 0."""
    gap = _degree(q) - _degree(p)
    p, q = _raised(p, gap), _raised(q, -gap)
    for _ in range(3):
        if all(value > 0 for value in q.values()):
            ratios = [p.get(powers, Fraction(0)) / value for powers, value in q.items()]
            return RationalInterval(min(ratios), max(ratios))
        p, q = _raised(p, 1), _raised(q, 1)
    raise LoopProofError("a rule base may have no value somewhere")


# ── pieces ───────────────────────────────────────────────────────────────────────────


def _is_within(piece: SimplexPiece, low: Fraction, high: Fraction) -> bool:
    return _is_not_negative(_sum(piece.upper, piece.lower, -low)) and _is_not_negative(
        _sum(_scaled(piece.lower, high), piece.upper, Fraction(-1))
    )


def _sums(piece: SimplexPiece, row: Sequence[Fraction]) -> list[Fraction]:
    """Return σ at the corners."""
    return [
        sum((w * x for w, x in zip(row, corner, strict=True)), Fraction(0))
        for corner in piece.corners
    ]


def _sides(piece: SimplexPiece, row: Sequence[Fraction]) -> list[SimplexPiece]:
    """Return a piece, or its parts on both sides of σ = 0."""
    waiting, parts = [piece], []
    while waiting:
        part = waiting.pop()
        sums = _sums(part, row)
        low, high = min(sums), max(sums)
        if low >= 0 or high <= 0:
            parts.append(part)
            continue
        i, j = sums.index(low), sums.index(high)
        share = sums[i] / (sums[i] - sums[j])  # of the way from corner i to corner j
        waiting += [_moved(part, i, j, share), _moved(part, j, i, 1 - share)]
    return parts


def _moved(piece: SimplexPiece, stays: int, moves: int, share: Fraction) -> SimplexPiece:
    corners = list(piece.corners)
    corners[moves] = tuple(
        (1 - share) * a + share * b for a, b in zip(corners[stays], corners[moves], strict=True)
    )
    return SimplexPiece(
        tuple(corners),
        _split(piece.upper, stays, moves, share),
        _split(piece.lower, stays, moves, share),
    )


def _slope(piece: SimplexPiece, axis: int, moving: Sequence[int]) -> tuple[Polynomial, Polynomial]:
    """Return ∂N D − N ∂D and D² along an input; nothing of a piece without a volume."""
    gradient = _gradients(
        tuple(tuple(corner[k] for k in moving) for corner in piece.corners), moving.index(axis)
    )
    if gradient is None:
        return {}, {}
    up, down = _along(piece.upper, gradient), _along(piece.lower, gradient)
    steep = _sum(_product(up, piece.lower), _product(piece.upper, down), Fraction(-1))
    return steep, _product(piece.lower, piece.lower)


@cache
def _gradients(corners: tuple[tuple[Fraction, ...], ...], axis: int) -> tuple[Fraction, ...] | None:
    """Return ∂λᵢ/∂x along an axis: Σ λᵢ vᵢ = x and Σ λᵢ = 1; None of a flat simplex."""
    size = len(corners)
    if len(corners[0]) != size - 1:
        raise LoopProofError("a piece of another dimension than its inputs")
    rows = [[*(corner[k] for corner in corners), Fraction(int(k == axis))] for k in range(size - 1)]
    rows.append([Fraction(1)] * size + [Fraction(0)])
    for column in range(size):
        pivot = next((r for r in range(column, size) if rows[r][column]), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        head = rows[column]
        for r in range(size):
            if r != column and rows[r][column]:
                factor = rows[r][column] / head[column]
                rows[r] = [x - factor * y for x, y in zip(rows[r], head, strict=True)]
    return tuple(rows[k][size] / rows[k][k] for k in range(size))
