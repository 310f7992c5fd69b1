r"""Rule bases and tables over a zonotope: a plane through their values, and the band around it.

An output u of a rule base is a quotient of polynomials on each of its pieces
(:mod:`fuzzyarm.proof.surface`), which are cut once. Over a set of inputs the plane k·x + d is
chosen by least squares, then drawn towards the largest distances (Lawson's weights); whichever it
is, the band around it is proved: on a piece with vertices vⱼ

    u - k·x - d  =  (N - L D) / D,      L = k·x + d - centre, with the values Lⱼ at the vertices,

whose Bernstein coefficients are averages of those of N and D,

    (N - L D)_γ = Σⱼ γⱼ / (n+1) · (N - Lⱼ D)_{γ - eⱼ},   |γ| = n + 1,

and no value is beyond the largest quotient of coefficients. Pieces are cut at the faces of the box
around the set, and halved where that makes the band narrower.

A table is linear in each input on each cell of its grid: u - k·x has its extremes at the corners.

Source: G. Farin, *Triangular Bernstein–Bézier patches*, 1986; C. L. Lawson, *Contributions to the
theory of linear least maximum approximation*, 1961.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise, product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.closed_loop.enclosure import EnclosureError
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.proof.arithmetic import FLOATS, Stop
from fuzzyarm.proof.bernstein import Quotients, lattice, vertices_of
from fuzzyarm.proof.bounds import WIDENED, UnprovableError
from fuzzyarm.proof.prover import Prover, QuotientProblem
from fuzzyarm.proof.surface import Surface
from fuzzyarm.table import LookupTable

__all__ = ["PlaneBand", "RulePlanes", "TablePlanes", "Zonotope"]

Vector = NDArray[np.float64]

ROUNDS = 4
"""Times that pieces are halved for one question at most."""

MOST = 3000
"""Pieces that one question may have."""

SHARE = 0.1
"""Of the width of a band: what one more halving has to promise."""

OFF = 2.0**-44
"""Of the largest coefficient of a piece: 500 roundings, more than cutting and halving it take."""

BEYOND = 1e-9
"""Of the width of a box: how far outside it pieces are cut, so that no rounding leaves a gap."""


MOST_CORNERS = 1_000_000
"""Corners of cells of a table within one set of inputs."""


class Zonotope(NamedTuple):
    """A set of inputs: a centre and generators, shapes (n,) and (n, m)."""

    centre: Vector
    generators: Vector

    @property
    def radius(self) -> Vector:
        """Half the widths of the box around it."""
        return np.asarray(np.abs(self.generators).sum(axis=1) * (1.0 + 1e-12) + 1e-300)


class PlaneBand(NamedTuple):
    """Between which planes a value lies: ``k·x + low`` and ``k·x + high``."""

    slopes: Vector
    low: float
    high: float


# ── rule bases ───────────────────────────────────────────────────────────────────────


@cache
def _raised(dimension: int, degree: int) -> tuple[Any, Any]:
    """Return, for each coefficient one degree higher and each vertex, its source and share.

    Shapes (coefficients, vertices): the coefficient below, and γⱼ / (n + 1), 0 where there is none.
    """
    below = {index: i for i, index in enumerate(lattice(dimension, degree))}
    above = lattice(dimension, degree + 1)
    sources = np.zeros((len(above), dimension + 1), dtype=int)
    shares = np.zeros((len(above), dimension + 1))
    for row, index in enumerate(above):
        for vertex, count in enumerate(index):
            if count:
                lower = list(index)
                lower[vertex] -= 1
                sources[row, vertex] = below[tuple(lower)]
                shares[row, vertex] = count / (degree + 1)
    return sources, shares


@dataclass(frozen=True, eq=False)
class RulePlanes:
    """One output of a rule base, cut once and asked often.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    output : str
        Which output.

    Raises
    ------
    UnprovableError
        If it cannot be evaluated everywhere, or an input has no end.
    """

    rulebase: RuleBase
    output: str

    def __post_init__(self) -> None:
        prover = self.prover
        silent = prover.without_value({})
        if silent is not None:
            at = ", ".join(f"{name} = {float(x):.6g}" for name, x in silent.items())
            raise UnprovableError(f"no rule of '{self.output}' fires at {at}")

    @cached_property
    def prover(self) -> Prover:
        """Of the output; it remembers what it has cut."""
        return Prover(self.rulebase, self.output)

    @property
    def has_pieces(self) -> bool:
        """Whether it is made of straight pieces; otherwise only its range over a box is known."""
        return self.prover.model is not None

    @property
    def range(self) -> tuple[float, float]:
        """What no value leaves; infinite where nothing is known."""
        output = self.prover.output
        inside = self.prover.stays_inside or output.outside == "clamp"
        return (output.low, output.high) if inside else (-math.inf, math.inf)

    @property
    def clamps(self) -> bool:
        """Whether the value is brought into the range of the output, which it may leave."""
        model = self.prover.model
        free = model is not None and not math.isfinite(float(model.low))
        return free and self.prover.output.outside == "clamp"

    @cached_property
    def _whole(self) -> tuple[Quotients, float]:
        """All pieces, their corners as inputs, and the centre."""
        prover = self.prover
        surface = prover.surface(QuotientProblem(prover.box({}), Surface.value), FLOATS)
        quotients = surface.value()
        grid = surface.pieces.grid
        corners = quotients.corners.copy()
        for axis, cells in enumerate(grid.cells):
            corner = np.array([float(cell.left) for cell in cells])
            width = np.array([float(cell.right - cell.left) for cell in cells])
            cell_of_piece = surface.pieces.cell[quotients.owner, axis]
            corners[:, :, axis] = (
                corner[cell_of_piece, None] + width[cell_of_piece, None] * corners[:, :, axis]
            )
        quotients.corners = corners
        assert quotients.error is not None
        largest = np.maximum(
            np.abs(quotients.lower).max(axis=1),
            np.abs(quotients.upper).max(axis=1) / quotients.reach,
        )
        quotients.error = quotients.error + OFF * largest[:, None]
        return quotients, float(surface.centre)

    @cached_property
    def _boxes(self) -> tuple[Vector, Vector]:
        corners = self._whole[0].corners
        slack = 1e-12 * (1.0 + np.abs(corners).max(initial=0.0))
        return corners.min(axis=1) - slack, corners.max(axis=1) + slack

    def band(self, inputs: Zonotope) -> PlaneBand:
        """Return a plane and the band around it over a set of inputs, which lie in their ranges."""
        if not self.has_pieces:
            return self._plain(inputs)
        centre, radius = inputs.centre, inputs.radius
        low, high = centre - radius, centre + radius
        least, most = self._boxes
        some = np.flatnonzero(((most >= low) & (least <= high)).all(axis=1))
        quotients, middle = self._whole
        pieces = _clipped(self._near(quotients.take(some), inputs), centre, radius)
        slopes, offset = np.zeros(len(centre)), 0.0
        for round_number in range(ROUNDS + 1):
            slopes, offset = self._plane(pieces, centre, radius, middle)
            lows, highs = _bands(pieces, slopes, offset, centre, middle)
            if round_number == ROUNDS or pieces.count > MOST:
                break
            deciding = self._deciding(pieces, slopes, offset, centre, middle, lows, highs)
            if not deciding.any():
                break
            part = pieces.take(np.flatnonzero(deciding))
            part.corners = part.corners / radius  # the longest edge is that of the box
            halves = part.halved(Stop())
            halves.corners = halves.corners * radius
            pieces = pieces.take(np.flatnonzero(~deciding)).joined(self._near(halves, inputs))
        return self._banded(slopes, offset, centre, radius, lows, highs)

    def _banded(
        self, slopes: Vector, offset: float, centre: Vector, radius: Vector, lows: Vector,
        highs: Vector,
    ) -> PlaneBand:  # fmt: skip
        low, high = float(lows.min()), float(highs.max())
        if not (math.isfinite(low) and math.isfinite(high)):
            ends = self.range
            if not math.isfinite(ends[1] - ends[0]):
                raise EnclosureError(f"'{self.output}' has no bound here")
            return PlaneBand(np.zeros_like(slopes), *ends)
        # k·(x - c) + offset, written as k·x: the products are rounded.
        shift = offset - float(slopes @ centre)
        size = abs(offset) + float(np.abs(slopes) @ (np.abs(centre) + radius))
        more = WIDENED * (self.prover.range + size) + OFF * (abs(low) + abs(high))
        return PlaneBand(slopes, shift + low - more, shift + high + more)

    def _plain(self, inputs: Zonotope) -> PlaneBand:
        radius = inputs.radius
        region = {
            name: (float(c - r), float(c + r))
            for name, c, r in zip(self.prover.names, inputs.centre, radius, strict=True)
        }
        self.prover.stop = Stop(1.0)
        bounds = self.prover.value(region)
        return PlaneBand(np.zeros(len(radius)), bounds.low, bounds.high)

    def _near(self, pieces: Quotients, inputs: Zonotope) -> Quotients:
        """Return the pieces that a set may meet: along its axes and those of its box."""
        radius = inputs.radius
        scaled = inputs.generators / radius[:, None]
        axes = [*np.eye(len(radius))]
        if len(radius) > 1:
            axes += [*np.linalg.eigh(scaled @ scaled.T)[1].T]
        keep = np.ones(pieces.count, dtype=bool)
        for axis in axes:
            # Any direction separates, so it matters little how exact it is.
            way = axis / radius
            shares = (pieces.corners - inputs.centre) @ way
            reach = np.abs(way @ inputs.generators).sum() * (1.0 + 1e-9) + 1e-9
            reach += 1e-12 * float(np.abs(way) @ np.abs(inputs.centre))
            keep &= (shares.min(axis=1) <= reach) & (shares.max(axis=1) >= -reach)
        return pieces.take(np.flatnonzero(keep))

    @staticmethod
    def _values(pieces: Quotients, middle: float) -> Vector:
        """Return the values at the vertices, NaN where nothing fires."""
        at = list(vertices_of(pieces.corners.shape[2], pieces.degree))
        upper, lower = pieces.upper[:, at], pieces.lower[:, at]
        return np.asarray(
            np.divide(upper, lower, out=np.full(upper.shape, np.nan), where=lower > 1e-9) + middle
        )

    def _plane(
        self, pieces: Quotients, centre: Vector, radius: Vector, middle: float
    ) -> tuple[Vector, float]:
        """Return slopes and the value at the centre of a plane near the values."""
        values = self._values(pieces, middle).ravel()
        places = ((pieces.corners - centre) / radius).reshape(-1, len(centre))
        finite = np.isfinite(values)
        places, values = places[finite], values[finite]
        weights = np.ones(len(values))
        if not len(values):
            return np.zeros(len(centre)), middle
        rows = np.column_stack([places, np.ones(len(places))])
        # Lawson: weights grow with the gaps. How near it comes matters only for how wide the band
        # is.
        for _ in range(4):
            root = np.sqrt(weights)
            solution = np.linalg.lstsq(rows * root[:, None], values * root, rcond=1e-9)[0]
            gaps = np.abs(rows @ solution - values)
            largest = gaps.max()
            if largest < 1e-12:
                break
            weights = weights * (gaps + 0.05 * largest)
            weights /= weights.max()
        return solution[:-1] / radius, float(solution[-1])

    def _deciding(
        self, pieces: Quotients, slopes: Vector, offset: float, centre: Vector, middle: float,
        lows: Vector, highs: Vector,
    ) -> NDArray[np.bool_]:  # fmt: skip
        """Tell the pieces that make the band wide and of which halves may be narrower."""
        low, high = float(lows.min()), float(highs.max())
        if not (math.isfinite(low) and math.isfinite(high)):
            return np.asarray(~(np.isfinite(lows) & np.isfinite(highs)))
        step = SHARE * (high - low)
        if high - low < 1e-9 * self.prover.range:
            return np.zeros(pieces.count, dtype=bool)
        gaps = self._values(pieces, middle) - (pieces.corners - centre) @ slopes - offset
        top, bottom = np.nanmax(gaps, axis=1), np.nanmin(gaps, axis=1)
        above, below = highs > high - step, lows < low + step
        crude = (above & (highs - top > step)) | (below & (bottom - lows > step))
        return np.asarray(crude | np.isnan(top))


def _bands(
    pieces: Quotients, slopes: Vector, offset: float, centre: Vector, middle: float
) -> tuple[Vector, Vector]:
    """Return for each piece between what the value less the plane lies."""
    dimension = len(centre)
    sources, shares = _raised(dimension, pieces.degree)
    # N − k D with a plane k has the degree n + 1 and the coefficients Σⱼ γⱼ/(n + 1) (N − kⱼ D),
    # those of N and D at γ − eⱼ and k at vertex j.
    planes = (pieces.corners - centre) @ slopes + (offset - middle)
    upper, lower = pieces.upper[:, sources], pieces.lower[:, sources]
    assert pieces.error is not None
    error = pieces.error[:, sources]
    tall = np.abs(planes)[:, None, :]
    differences = ((upper - planes[:, None, :] * lower) * shares).sum(axis=2)
    below = (lower * shares).sum(axis=2)
    off_below = (error * shares).sum(axis=2) + OFF * np.abs(below)
    sizes = ((np.abs(upper) + tall * np.abs(lower)) * shares).sum(axis=2)
    # How far a corner is off moves the plane: a share of the sizes again.
    off = ((pieces.reach + tall) * error * shares).sum(axis=2) + OFF * (
        sizes + np.abs(slopes).sum() * np.abs(centre).max() * below
    )
    top, bottom = differences + off, differences - off
    room, more = below - off_below, below + off_below
    with np.errstate(all="ignore"):
        highs = np.where(room > 0, top / np.where(top > 0, room, more), np.inf)
        lows = np.where(room > 0, bottom / np.where(bottom < 0, room, more), -np.inf)
    # Where all coefficients of the area are 0 and known to be, there is nothing of the piece.
    highs, lows = highs.max(axis=1), lows.min(axis=1)
    return lows - OFF * np.abs(lows), highs + OFF * np.abs(highs)


@cache
def _moves(dimension: int, degree: int) -> list[tuple[Any, Any]]:
    """Return, pass by pass, which coefficients change as vertex 1 moves towards 0, and by which.

    With the new vertex (1-s) v₀ + s v₁ instead of v₁: c_γ ← (1-s) c_{γ - e₁ + e₀} + s c_γ, for
    all γ₁ ≥ r, for r = 1 … n (de Casteljau).
    """
    indices = lattice(dimension, degree)
    number = {index: i for i, index in enumerate(indices)}
    passes = []
    for r in range(1, degree + 1):
        changed = [index for index in indices if index[1] >= r]
        sources = [number[index[0] + 1, index[1] - 1, *index[2:]] for index in changed]
        passes.append((np.array([number[vertex] for vertex in changed]), np.array(sources)))
    return passes


@cache
def _orders(dimension: int, degree: int) -> tuple[Any, Any]:
    """Return the coefficients in the order in which two vertices come first, and the way back.

    By the number ``i (d + 1) + j`` of the first two, i and j.
    """
    indices = lattice(dimension, degree)
    number = {index: k for k, index in enumerate(indices)}
    there = np.zeros(((dimension + 1) ** 2, len(indices)), dtype=int)
    for i in range(dimension + 1):
        for j in range(dimension + 1):
            order = [i, j, *(k for k in range(dimension + 1) if k not in (i, j))]
            if i == j:
                continue
            for k, index in enumerate(indices):
                exponents = [0] * (dimension + 1)
                for vertex, power in zip(order, index, strict=True):
                    exponents[vertex] = power
                there[i * (dimension + 1) + j, k] = number[tuple(exponents)]
    return there, np.argsort(there, axis=1)


def _cut_at(pieces: Quotients, heights: Vector) -> Quotients:
    """Return the parts of pieces on which a linear function is not positive, given at vertices."""
    parts: list[Quotients] = []
    while pieces.count:
        low, high = heights.min(axis=1), heights.max(axis=1)
        slack = 1e-13 * np.maximum(-low, high)
        inside, outside = high <= slack, low >= -slack
        parts.append(pieces.take(np.flatnonzero(inside)))
        crossing = np.flatnonzero(~inside & ~outside)
        if not crossing.size:
            break
        pieces, heights = pieces.take(crossing), heights[crossing]
        rows = np.arange(len(crossing))
        top, bottom = heights.argmax(axis=1), heights.argmin(axis=1)
        upper, lower = heights[rows, top], heights[rows, bottom]
        share = -lower / (upper - lower)  # of the way from the lowest vertex to the highest
        halves = [
            _moved(pieces, heights, bottom, top, share),
            _moved(pieces, heights, top, bottom, 1.0 - share),
        ]
        pieces = halves[0][0].joined(halves[1][0])
        heights = np.concatenate([half[1] for half in halves])
    return parts[0].joined(*parts[1:]) if len(parts) > 1 else parts[0] if parts else pieces


def _moved(
    pieces: Quotients, heights: Vector, stays: Vector, moves: Vector, share: Vector
) -> tuple[Quotients, Vector]:
    """Return pieces with one vertex moved along an edge to where a linear function is 0."""
    dimension = pieces.corners.shape[2]
    every = np.arange(pieces.count)
    s = share[:, None]
    quotients = pieces.take(every)
    assert quotients.error is not None
    quotients.corners = quotients.corners.copy()
    quotients.corners[every, moves] = (1.0 - s) * quotients.corners[
        every, stays
    ] + s * quotients.corners[every, moves]
    heights = heights.copy()
    heights[every, moves] = 0.0
    there, back = _orders(dimension, quotients.degree)
    code = stays * (dimension + 1) + moves
    values = np.stack([quotients.upper, quotients.lower, quotients.error], axis=1)
    values = np.take_along_axis(values, there[code][:, None, :], axis=2)
    part, rest = s[:, :, None], (1.0 - s)[:, :, None]
    for changed, sources in _moves(dimension, quotients.degree):
        values[:, :, changed] = rest * values[:, :, sources] + part * values[:, :, changed]
    values = np.take_along_axis(values, back[code][:, None, :], axis=2)
    quotients.upper, quotients.lower, quotients.error = (values[:, k] for k in range(3))
    return quotients, heights


def _clipped(pieces: Quotients, centre: Vector, radius: Vector) -> Quotients:
    """Return the parts of pieces within a box."""
    for axis in range(len(centre)):
        # More than what is taken for touching, whatever the size of a piece.
        largest = float(np.abs(pieces.corners[:, :, axis]).max(initial=0.0)) + abs(centre[axis])
        reach = radius[axis] * (1.0 + BEYOND) + 1e-12 * largest
        for sign in (1.0, -1.0):
            heights = sign * (pieces.corners[:, :, axis] - centre[axis]) - reach
            if (heights > 0.0).any():
                pieces = _cut_at(pieces, heights)
    return pieces


# ── tables ───────────────────────────────────────────────────────────────────────────


@dataclass(frozen=True, eq=False)
class TablePlanes:
    """A lookup table, asked often.

    Parameters
    ----------
    table : LookupTable
        Over real inputs, those of other axes fixed.
    """

    table: LookupTable

    def band(self, inputs: Zonotope) -> PlaneBand:
        """Return a plane and the band around it over a set of inputs."""
        table, mode = self.table, self.table.default_mode
        centre, radius = inputs.centre, inputs.radius
        slack = 1e-12 * (1.0 + np.abs(centre) + radius)
        low, high = centre - radius - slack, centre + radius + slack
        corners, values = [], []
        stretches = [
            self._stretches(axis, mode, float(a), float(b))
            for axis, a, b in zip(table.axes, low, high, strict=True)
        ]
        # Each of 2ⁿ corners of a cell is interpolated from 2ⁿ of the table.
        count = math.prod(map(len, stretches)) << 2 * len(stretches)
        if count > MOST_CORNERS:
            raise EnclosureError(f"a set of inputs covers too many cells of '{table.output}'")
        for parts in product(*stretches):
            for ends in product((0, 1), repeat=len(parts)):
                corners.append([part.places[end] for part, end in zip(parts, ends, strict=True)])
                values.append(self._value(parts, ends))
        points, heights = np.array(corners), np.array(values)
        rows = np.column_stack([(points - centre) / radius, np.ones(len(points))])
        solution = np.linalg.lstsq(rows, heights, rcond=1e-9)[0]
        slopes = solution[:-1] / radius
        gaps = heights - points @ slopes
        size = np.abs(heights).max() + float(np.abs(slopes) @ np.abs(points).max(axis=0))
        more = 1e-12 * size
        return PlaneBand(slopes, float(gaps.min()) - more, float(gaps.max()) + more)

    def _value(self, parts: Any, ends: Any) -> float:
        """Return what the table says at a corner of a cell, seen from within the cell."""
        total = 0.0
        for nodes in product((0, 1), repeat=len(parts)):
            share = math.prod(
                part.shares[end] if node else 1.0 - part.shares[end]
                for part, end, node in zip(parts, ends, nodes, strict=True)
            )
            if share:
                at = tuple(part.nodes[node] for part, node in zip(parts, nodes, strict=True))
                total += share * float(self.table.values[at])
        return total

    @staticmethod
    def _stretches(axis: Any, mode: str, low: float, high: float) -> list[_Stretch]:
        """Return the stretches of an axis on which the table is one formula."""
        levels = list(axis.levels)
        if mode != "linear":
            cuts = [-math.inf, *axis.thresholds(mode), math.inf]
            slack = 1e-9 * (1.0 + abs(low) + abs(high))
            return [
                _Stretch((max(a, low), min(b, high)), (i, i), (0.0, 0.0))
                for i, (a, b) in enumerate(pairwise(cuts))
                if a <= high + slack and b >= low - slack
            ]
        stretches = []
        ends = [-math.inf, *levels, math.inf]
        for i, (a, b) in enumerate(pairwise(ends)):
            if a > high or b < low:
                continue
            places = max(a, low), min(b, high)
            if i == 0 or i == len(levels):
                node = 0 if i == 0 else len(levels) - 1
                stretches.append(_Stretch(places, (node, node), (0.0, 0.0)))
            else:
                shares = tuple(min(max((x - a) / (b - a), 0.0), 1.0) for x in places)
                stretches.append(_Stretch(places, (i - 1, i), shares))
        return stretches


class _Stretch(NamedTuple):
    """Part of an axis: from where to where, between which levels, and how far between them."""

    places: tuple[float, float]
    nodes: tuple[int, int]
    shares: tuple[float, float]
