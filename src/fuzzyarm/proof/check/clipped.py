"""Piecewise linear terms, and sets clipped at a height: area and moment."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from itertools import product as every

from flint import fmpq

from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.proof.check.numbers import ONE, ZERO, exact
from fuzzyarm.proof.check.polynomials import Vector
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.symbolic.kinds import SHAPES

Corners = tuple[tuple[fmpq, fmpq], ...]
Segment = tuple[fmpq, fmpq, fmpq, fmpq]


class UndecidedError(Exception):
    """A difference of two heights has both signs at the corners of a simplex."""

    def __init__(self, gap: Vector) -> None:
        self.gap = gap


def corners_of(shape: Shape, of: str) -> Corners:
    """Return the corners of a shape; LoopProofError if it is not piecewise linear."""
    if shape.kind == "formula" or not SHAPES[shape.kind].straight:
        raise LoopProofError(f"{of} is not made of straight pieces: a {shape.kind}")
    return tuple((exact(x), exact(y)) for x, y in polyline(shape))


def height_beside(corners: Corners, x: fmpq, *, right: bool) -> fmpq:
    """Return the one-sided limit of a line's height at a point."""
    after = sum(a <= x if right else a < x for a, _ in corners)
    if after in (0, len(corners)):
        return corners[0][1] if not after else corners[-1][1]
    (x0, y0), (x1, y1) = corners[after - 1], corners[after]
    return y0 + (y1 - y0) / (x1 - x0) * (x - x0)


def height_at(corners: Corners, x: fmpq) -> fmpq:
    """Return the height at a point; on a vertical edge the greatest."""
    return max((y for a, y in corners if a == x), default=height_beside(corners, x, right=True))


class ClippedSet:
    """Area and moment of a piecewise linear set clipped at a height, as polynomials of it."""

    def __init__(self, segments: Sequence[Segment]) -> None:
        self.segments = segments
        heights = {y for _, y0, _, y1 in segments for y in (y0, y1)}
        self.levels = sorted(heights | {ZERO})
        self.is_empty = not any(y0 > 0 or y1 > 0 for _, y0, _, y1 in segments)

    @lru_cache(maxsize=256)  # noqa: B019
    def polynomials(self, layer: int) -> tuple[Vector, Vector]:
        """Return coefficients of powers of the height, in the layer above a level."""
        level = self.levels[layer]
        area, moment = [ZERO] * 3, [ZERO] * 4
        for x0, y0, x1, y1 in self.segments:
            width = x1 - x0
            (a, low), (b, high) = ((x0, y0), (x1, y1)) if y0 <= y1 else ((x1, y1), (x0, y0))
            way, rise = b - a, high - low
            if level >= high:  # all of it, a trapezium
                area[0] += width * (low + high) / 2
                moment[0] += width * (a * (low + high) / 2 + way * (low + 2 * high) / 6)
                continue
            # ∫ min(h, μ) = h, and of the moment a h + (b − a) h/2, times the width.
            area[1] += width
            moment[1] += width * (a + way / 2)
            if level >= low and rise:
                # Less rise s²/2 and a rise s²/2 + (b − a) rise s³/6, where s = (h − low)/rise.
                for k, weight in enumerate((low * low, -2 * low, ONE)):
                    area[k] -= width * weight / (2 * rise)
                    moment[k] -= width * a * weight / (2 * rise)
                cube = (-low * low * low, 3 * low * low, -3 * low, ONE)
                for k, weight in enumerate(cube):
                    moment[k] -= width * way * weight / (6 * rise * rise)
        return tuple(area), tuple(moment)

    def layer_of(self, height: Vector) -> int:
        """Return the layer of a height; UndecidedError if it is in several."""
        low, high = min(height), max(height)
        for number, level in enumerate(self.levels):
            if low < level < high:
                raise UndecidedError(tuple(x - level for x in height))
            if level >= high and number:
                return number - 1
        return len(self.levels) - 1


def lower_of(first: ClippedSet, second: ClippedSet) -> ClippedSet:
    """Return the pointwise minimum of two sets."""
    segments = []
    for (a0, p0, a1, p1), (b0, q0, b1, q1) in every(first.segments, second.segments):
        low, high = max(a0, b0), min(a1, b1)
        if low >= high:
            continue
        steep, other = (p1 - p0) / (a1 - a0), (q1 - q0) / (b1 - b0)
        cuts = [low, high]
        if steep != other:
            meet = (q0 - other * b0 - p0 + steep * a0) / (steep - other)
            cuts = [low, meet, high] if low < meet < high else cuts
        for x0, x1 in pairwise(cuts):
            y0, y1 = (min(p0 + steep * (x - a0), q0 + other * (x - b0)) for x in (x0, x1))
            if y0 > 0 or y1 > 0:
                segments.append((x0, y0, x1, y1))
    return ClippedSet(segments)
