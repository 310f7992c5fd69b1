r"""Rule bases and tables over a zonotope: a plane through their values, and the band around it.

An output u of a rule base is a quotient of polynomials on each of its pieces
(:mod:`fuzzyarm.proof.map.surface`), which are cut once. Over a set of inputs the plane k·x + d is
fitted by least squares, then reweighted towards the largest distances (Lawson); for any plane the
band around it is proved: on a piece with vertices vⱼ

    u - k·x - d  =  (N - L D) / D,      L = k·x + d - centre, with the values Lⱼ at the vertices,

whose Bernstein coefficients are averages of those of N and D,

    (N - L D)_γ = Σⱼ γⱼ / (n+1) · (N - Lⱼ D)_{γ - eⱼ},   |γ| = n + 1,

and no value exceeds the largest quotient of coefficients. Pieces are cut at the faces of the box
around the set, and halved where that narrows the band.

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

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.loop.enclosure import EnclosureError, Vector
from fuzzyarm.proof.loop.plane_grid import HALVINGS, PlaneGrid, cells_of
from fuzzyarm.proof.map.arithmetic import FLOATS
from fuzzyarm.proof.map.bernstein import Quotients, lattice, vertices_of
from fuzzyarm.proof.map.bounds import WIDENED, UnprovableError
from fuzzyarm.proof.map.prover import Prover, point_text
from fuzzyarm.proof.map.search import QuotientProblem
from fuzzyarm.proof.map.surface import Surface
from fuzzyarm.proof.stop import Stop
from fuzzyarm.table import LookupTable

ROUNDS = 4
"""Most halvings of pieces for one band."""

MOST = 3000
"""Most pieces for one band."""

SHARE = 0.1
"""Least gain of one more halving, as a share of the band's width."""

OFF = 2.0**-44
"""Error relative to a piece's largest coefficient: 500 roundings, more than cutting and halving."""

BEYOND = 1e-9
"""Margin of cuts outside a box, relative to its width, so that no rounding leaves a gap."""


MOST_CORNERS = 1_000_000
"""Most corners of a table's cells within one set of inputs."""


class Zonotope(NamedTuple):
    """A set of inputs: a centre and generators, shapes (n,) and (n, m)."""

    centre: Vector
    generators: Vector

    @property
    def radius(self) -> Vector:
        """The half-widths of its bounding box."""
        return np.asarray(np.abs(self.generators).sum(axis=1) * (1.0 + 1e-12) + 1e-300)


class PlaneBand(NamedTuple):
    """Parallel planes around a value: ``k·x + low`` and ``k·x + high``."""

    slopes: Vector
    low: float
    high: float


# ── rule bases ───────────────────────────────────────────────────────────────────────


@cache
def _raised(dimension: int, degree: int) -> tuple[Any, Any]:
    """Return sources and weights of degree elevation, for each new coefficient and vertex.

    Shapes (coefficients, vertices): the index of γ − eⱼ, and γⱼ / (n + 1), 0 where there is none.
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


class _WholeCut(NamedTuple):
    """All pieces over a box.

    `least` and `most` are the bounds of each piece, `middle` is the origin of values; if
    `is_silent`, some points of the box may have no value.
    """

    low: Vector
    high: Vector
    quotients: Quotients
    middle: float
    least: Vector
    most: Vector
    is_silent: bool


class RulePlanes:
    """One output of a rule base, cut once and evaluated often.

    Pieces cover the declared ranges, and more as soon as a set exceeds the range of an input that
    is not clamped (``outside extend``), or is unbounded.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    output : str
        Name of the output.
    """

    def __init__(self, rulebase: RuleBase, output: str) -> None:
        self.rulebase, self.output = rulebase, output
        self._cut: _WholeCut | None = None

    @cached_property
    def prover(self) -> Prover:
        """Bands of the output, with a cache of cut boxes."""
        return Prover(self.rulebase, self.output)

    @property
    def has_pieces(self) -> bool:
        """Whether the output is piecewise; otherwise only its range over a box is known."""
        return self.prover.model is not None

    @property
    def range(self) -> tuple[float, float]:
        """The range of all values; infinite if unknown."""
        output = self.prover.output
        return (output.low, output.high) if self.prover.stays_inside else (-math.inf, math.inf)

    @property
    def clamps(self) -> bool:
        """Whether values outside the output's range are clamped."""
        model = self.prover.model
        free = model is not None and not math.isfinite(float(model.low))
        return free and self.prover.output.outside == "clamp"

    # --- pieces, and the domain ---

    def _within_ranges(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Return the part of a box that inputs can reach: all of it for inputs without a clamp."""
        ends = [
            (variable.low, variable.high) if variable.outside != "extend" else (-np.inf, np.inf)
            for variable in self.prover.inputs
        ]
        least, most = np.transpose(ends)
        return np.clip(low, least, most), np.clip(high, least, most)

    def _whole(self, low: Vector, high: Vector) -> _WholeCut:
        """Return all pieces over a box that contains the given one."""
        cut = self._cut
        if cut is None or (low < cut.low).any() or (high > cut.high).any():
            self._cut = cut = self._newly_cut(*self._grown(low, high))
        return cut

    def _grown(self, low: Vector, high: Vector) -> tuple[Vector, Vector]:
        """Return a box to be cut: the declared one, and twice the width of any excess over it."""
        lows, highs = [], []
        before = self._cut
        for axis, variable in enumerate(self.prover.inputs):
            ends = [x for x in (variable.low, variable.high) if math.isfinite(x)]
            if before is not None:
                ends += [before.low[axis], before.high[axis]]
            first, last = min([low[axis], *ends]), max([high[axis], *ends])
            more = last - first
            is_open = variable.outside == "extend"
            below = low[axis] < min(ends, default=math.inf)
            above = high[axis] > max(ends, default=-math.inf)
            grows = (below and (is_open or math.isinf(variable.low)),
                     above and (is_open or math.isinf(variable.high)))  # fmt: skip
            lows.append(first - more * grows[0])
            highs.append(last + more * grows[1])
        return np.array(lows), np.array(highs)

    def _newly_cut(self, low: Vector, high: Vector) -> _WholeCut:
        prover, region = self.prover, self._region(low, high)
        surface = prover.surface(QuotientProblem(prover.box(region), Surface.value), FLOATS)
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
        slack = 1e-12 * (1.0 + np.abs(corners).max(initial=0.0))
        return _WholeCut(
            low, high, quotients, float(surface.centre),
            corners.min(axis=1) - slack, corners.max(axis=1) + slack,
            prover.without_value(region) is not None,
        )  # fmt: skip

    def _region(self, low: Vector, high: Vector) -> dict[str, tuple[float, float]]:
        ends = zip(low.tolist(), high.tolist(), strict=True)
        return dict(zip(self.prover.names, ends, strict=True))

    @cached_property
    def _has_value(self) -> bool:
        """Whether there is a value all over the declared ranges, as far as known."""
        try:
            return self.prover.without_value({}) is None
        except UnprovableError:
            return False

    def _is_silent(self, low: Vector, high: Vector) -> bool:
        """Return whether the value for no rule may occur in a box; refuse one without a value."""
        declared = [(variable.low, variable.high) for variable in self.prover.inputs]
        inside = all(a >= x and b <= y for a, b, (x, y) in zip(low, high, declared, strict=True))
        if inside and self._has_value:
            return False
        at = self.prover.without_memory().without_value(self._region(low, high))
        if at is not None and self.prover.no_rule is None:
            raise EnclosureError(f"no rule of '{self.output}' fires at {point_text(at)}")
        return at is not None

    # --- questions ---

    @cached_property
    def grid(self) -> PlaneGrid | None:
        """The planes of its cells, for many sets at once; None if it cannot be cut into them."""
        inputs = self.prover.inputs
        ends = np.array([(variable.low, variable.high) for variable in inputs])
        if len(ends) not in HALVINGS or not (self.has_pieces and np.isfinite(ends).all()):
            return None
        low, high = ends.T
        cut = self._whole(low, high)
        if cut.is_silent:
            return None
        middle = cut.middle

        def bands(
            pieces: Quotients, slopes: Vector, centre: Vector, at: Vector
        ) -> tuple[Vector, Vector]:
            positions = pieces.corners - centre[:, None, :]
            planes = (positions * slopes[:, None, :]).sum(axis=2) + (at - middle)[:, None]
            tilt = np.abs(slopes).sum(axis=1) * np.abs(pieces.corners).max(axis=(1, 2))
            return _bands(pieces, planes, tilt)

        return PlaneGrid(
            low, high, [variable.outside == "clamp" for variable in inputs],
            lambda edges: cells_of(
                cut.quotients, edges, _cut_at, lambda part: self._values(part, middle), bands
            ),
        )  # fmt: skip

    def band(self, inputs: Zonotope) -> PlaneBand:
        """Return a plane and the band around it over a set of inputs.

        Inputs that never leave their range lie in it, even if their zonotope exceeds it.
        EnclosureError: a point may have no value, or no bound is known; UnprovableError: no proof
        covers the rule base.
        """
        centre, radius = inputs.centre, inputs.radius
        low, high = self._within_ranges(centre - radius, centre + radius)
        if not self.has_pieces:
            self._is_silent(low, high)
            return self._plain(low, high)
        cut = self._whole(low, high)
        quotients, middle = cut.quotients, cut.middle
        some = np.flatnonzero(((cut.most >= low) & (cut.least <= high)).all(axis=1))
        pieces = _clipped(self._near(quotients.select(some), inputs), centre, radius)
        if not pieces.count:
            raise EnclosureError(f"an input of '{self.output}' is outside its range")
        assert pieces.error is not None
        if self.prover.no_rule is None and not (pieces.lower.any() or pieces.error.any()):
            raise EnclosureError(f"no rule of '{self.output}' fires, where its drive stays")
        slopes, offset = np.zeros(len(centre)), 0.0
        for round_number in range(ROUNDS + 1):
            slopes, offset = self._plane(pieces, centre, radius, middle)
            planes = (pieces.corners - centre) @ slopes + (offset - middle)
            tilt = np.full(pieces.count, np.abs(slopes).sum() * np.abs(centre).max())
            lows, highs = _bands(pieces, planes, tilt)
            if round_number == ROUNDS or pieces.count > MOST:
                break
            deciding = self._deciding(pieces, slopes, offset, centre, middle, lows, highs)
            if not deciding.any():
                break
            part = pieces.select(np.flatnonzero(deciding))
            part.corners = part.corners / radius  # the longest edge is relative to the box
            halves = part.halved(Stop())
            halves.corners = halves.corners * radius
            pieces = pieces.select(np.flatnonzero(~deciding)).joined(self._near(halves, inputs))
        if cut.is_silent and self._is_silent(low, high):
            return self._plain(low, high)
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
        # k·(x - c) + offset, rewritten as k·x + d: the products are rounded.
        shift = offset - float(slopes @ centre)
        size = abs(offset) + float(np.abs(slopes) @ (np.abs(centre) + radius))
        more = WIDENED * (self.prover.range + size) + OFF * (abs(low) + abs(high))
        return PlaneBand(slopes, shift + low - more, shift + high + more)

    def _plain(self, low: Vector, high: Vector) -> PlaneBand:
        """Return the range over a box, the value for no rule included."""
        prover = self.prover.without_memory()
        prover.stop = Stop(1.0)
        bounds = prover.value(self._region(low, high))
        return PlaneBand(np.zeros(len(low)), bounds.low, bounds.high)

    def _near(self, pieces: Quotients, inputs: Zonotope) -> Quotients:
        """Return the pieces that a set may meet: separation along its axes and those of its box."""
        radius = inputs.radius
        scaled = inputs.generators / radius[:, None]
        axes = [*np.eye(len(radius))]
        if len(radius) > 1:
            axes += [*np.linalg.eigh(scaled @ scaled.T)[1].T]
        keep = np.ones(pieces.count, dtype=bool)
        for axis in axes:
            # Any separating direction is sound, so its accuracy matters little.
            way = axis / radius
            shares = (pieces.corners - inputs.centre) @ way
            reach = np.abs(way @ inputs.generators).sum() * (1.0 + 1e-9) + 1e-9
            reach += 1e-12 * float(np.abs(way) @ np.abs(inputs.centre))
            keep &= (shares.min(axis=1) <= reach) & (shares.max(axis=1) >= -reach)
        return pieces.select(np.flatnonzero(keep))

    @staticmethod
    def _values(pieces: Quotients, middle: float) -> Vector:
        """Return the values at the vertices, NaN where no rule fires."""
        at = list(vertices_of(pieces.corners.shape[2], pieces.degree))
        upper, lower = pieces.upper[:, at], pieces.lower[:, at]
        return np.asarray(
            np.divide(upper, lower, out=np.full(upper.shape, np.nan), where=lower > 1e-9) + middle
        )

    def _plane(
        self, pieces: Quotients, centre: Vector, radius: Vector, middle: float
    ) -> tuple[Vector, float]:
        """Return slopes and centre value of a plane near the values."""
        values = self._values(pieces, middle).ravel()
        positions = ((pieces.corners - centre) / radius).reshape(-1, len(centre))
        finite = np.isfinite(values)
        positions, values = positions[finite], values[finite]
        weights = np.ones(len(values))
        if not len(values):
            return np.zeros(len(centre)), middle
        rows = np.column_stack([positions, np.ones(len(positions))])
        # Lawson: weights grow with the gaps. Convergence only affects the width of the band.
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
        """Return the pieces that make the band wide and whose halves may narrow it."""
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


def _bands(pieces: Quotients, planes: Vector, tilt: Vector) -> tuple[Vector, Vector]:
    """Return for each piece bounds of the value minus the plane.

    `planes`: its values at the vertices; `tilt`: its change for a relative error of a corner.
    """
    sources, shares = _raised(pieces.corners.shape[2], pieces.degree)
    # N − k D with a plane k has the degree n + 1 and the coefficients Σⱼ γⱼ/(n + 1) (N − kⱼ D),
    # those of N and D at γ − eⱼ and k at vertex j.
    upper, lower = pieces.upper[:, sources], pieces.lower[:, sources]
    assert pieces.error is not None
    error = pieces.error[:, sources]
    tall = np.abs(planes)[:, None, :]
    differences = ((upper - planes[:, None, :] * lower) * shares).sum(axis=2)
    below = (lower * shares).sum(axis=2)
    off_below = (error * shares).sum(axis=2) + OFF * np.abs(below)
    sizes = ((np.abs(upper) + tall * np.abs(lower)) * shares).sum(axis=2)
    # Errors of corners move the plane: again relative to the magnitudes.
    off = ((pieces.reach + tall) * error * shares).sum(axis=2) + OFF * (
        sizes + tilt[:, None] * below
    )
    top, bottom = differences + off, differences - off
    room, more = below - off_below, below + off_below
    with np.errstate(all="ignore"):
        highs = np.where(room > 0, top / np.where(top > 0, room, more), np.inf)
        lows = np.where(room > 0, bottom / np.where(bottom < 0, room, more), -np.inf)
    # If all coefficients of the area are exactly 0, the piece has no values.
    highs, lows = highs.max(axis=1), lows.min(axis=1)
    return lows - OFF * np.abs(lows), highs + OFF * np.abs(highs)


@cache
def _moves(dimension: int, degree: int) -> list[tuple[Any, Any]]:
    """Return by pass the coefficients that change as vertex 1 moves towards 0, and their sources.

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
    """Return the permutations that bring two vertices to the front, and their inverses.

    By the index ``i (d + 1) + j`` of the vertices i and j.
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
    """Return the parts of pieces with a linear function ≤ 0, given at vertices."""
    parts: list[Quotients] = []
    while pieces.count:
        low, high = heights.min(axis=1), heights.max(axis=1)
        slack = 1e-13 * np.maximum(-low, high)
        inside, outside = high <= slack, low >= -slack
        parts.append(pieces.select(np.flatnonzero(inside)))
        crossing = np.flatnonzero(~inside & ~outside)
        if not crossing.size:
            break
        pieces, heights = pieces.select(crossing), heights[crossing]
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
    """Return pieces with one vertex moved along an edge to the zero of a linear function."""
    dimension = pieces.corners.shape[2]
    every = np.arange(pieces.count)
    s = share[:, None]
    quotients = pieces.select(every)
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
        # More than the tolerance of touching, whatever the size of a piece.
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
    """A lookup table, evaluated often.

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
        # Each of the 2ⁿ corners of a cell is interpolated from 2ⁿ of the table.
        count = math.prod(map(len, stretches)) << 2 * len(stretches)
        if count > MOST_CORNERS:
            raise EnclosureError(f"a set of inputs covers too many cells of '{table.output}'")
        for parts in product(*stretches):
            for ends in product((0, 1), repeat=len(parts)):
                corners.append([part.positions[end] for part, end in zip(parts, ends, strict=True)])
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
        """Return the table's value at a corner of a cell, from inside the cell."""
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
        """Return the parts of an axis on which the table is one formula."""
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
            positions = max(a, low), min(b, high)
            if i == 0 or i == len(levels):
                node = 0 if i == 0 else len(levels) - 1
                stretches.append(_Stretch(positions, (node, node), (0.0, 0.0)))
            else:
                shares = tuple(min(max((x - a) / (b - a), 0.0), 1.0) for x in positions)
                stretches.append(_Stretch(positions, (i - 1, i), shares))
        return stretches


class _Stretch(NamedTuple):
    """Part of an axis: its ends, the levels around it, and the relative positions between them."""

    positions: tuple[float, float]
    nodes: tuple[int, int]
    shares: tuple[float, float]
