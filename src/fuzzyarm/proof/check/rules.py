"""A rule base over a region, on its exact pieces: sectors, slopes, ranges, bounds.

For piecewise linear memberships the inputs fall into simplices on which an output is N/D, two
polynomials. Cells between the corners of terms are cut along Kuhn's diagonals, and again wherever
two heights change their order, or a height passes a level at which the aggregate changes form.
Clipped sets under ``max`` are counted by inclusion and exclusion: ∫ max min(hₖ, μₖ) is the sum over
groups T of sets, with the sign of their number, of the set min(μₖ: k ∈ T) clipped at
min(hₖ: k ∈ T). In barycentric coordinates a homogeneous polynomial without a negative coefficient
is nowhere negative on its simplex; if that does not show a claim the simplex is halved.

    sector    k₁ σ² ≤ u σ ≤ k₂ σ²:   ± (N − k σ D) ≥ 0 on the side of σ = 0 where σ is ± positive
    slope     k₁ ≤ ∂u/∂x ≤ k₂:       (∂N D − N ∂D) − k₁ D² ≥ 0, k₂ D² − … ≥ 0
    range     k₁ ≤ u ≤ k₂:           N − k₁ D ≥ 0, k₂ D − N ≥ 0

No code here is shared with the search for such claims. Source of the triangulation: H. W. Kuhn,
*Some combinatorial lemmas in topology*, 1960.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise, permutations
from itertools import product as every
from typing import Any, NamedTuple

from flint import fmpq

from fuzzyarm.inference.aggregate import sample_positions
from fuzzyarm.language.model.rulebase import And, Hedged, Input, Is, Output, RuleBase, Shape
from fuzzyarm.proof.check.clipped import (
    ClippedSet,
    Corners,
    Segment,
    UndecidedError,
    corners_of,
    height_at,
    height_beside,
    lower_of,
)
from fuzzyarm.proof.check.numbers import (
    ONE,
    ZERO,
    Number,
    SpanError,
    exact,
    float_above,
    float_below,
    hull,
)
from fuzzyarm.proof.check.pieces import (
    BoundedPiece,
    Piece,
    gradients_of,
    is_within,
    sides_of,
    slope_along,
)
from fuzzyarm.proof.check.polynomials import (
    Polynomial,
    Vector,
    dot,
    is_not_negative,
    is_positive,
    linear,
    plus,
    power_of_unit,
    ratio,
    ring_of,
)
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.stop import check_time

MOST_PIECES = 200_000
"""Most simplices of one region."""

BEYOND = 4
"""Distance from the range, in its widths, of an input that is not clamped."""

Region = Mapping[str, tuple[Number, Number]]


class _Rule(NamedTuple):
    antecedent: Any
    weight: fmpq
    column: int  # of its conclusion
    norms: tuple[str, str]  # of ``and``, of ``or``


class RuleSurface:
    """One output of a rule base, for claims about it.

    Raises
    ------
    LoopProofError
        If it is not piecewise linear.
    """

    def __init__(self, rulebase: RuleBase, output: str) -> None:
        self.rulebase, self.name = rulebase, rulebase.name
        self.output: Output = rulebase.output(output)
        self.names = tuple(variable.name for variable in rulebase.inputs)
        self.lines: dict[tuple[str, str], Corners] = {}
        self.adds = self.output.aggregation == "sum"
        self._read()
        self._claimed: dict[object, tuple[list[Piece], bool]] = {}
        self._cells: dict[tuple[int, ...], list[BoundedPiece]] = {}

    # --- reading ---

    def _refuse(self, reason: str) -> LoopProofError:
        return LoopProofError(f"'{self.name}' is not made of straight pieces: {reason}")

    def _read(self) -> None:
        output, defuzzifier = self.output, self.output.defuzzifier
        record = defuzzifier.record
        if self.rulebase.is_type2 or record.inverts or record.both:
            raise self._refuse(f"defuzzifier {defuzzifier}")
        if record.figure not in ("centroid", "average", "weighted"):
            raise self._refuse(f"defuzzifier {defuzzifier}")
        if output.aggregation not in ("max", "sum"):
            raise self._refuse(f"aggregation {output.aggregation}")
        conclusions = [
            (block, rule, consequent)
            for block in self.rulebase.blocks
            for rule in block.rules
            for consequent in rule.consequents
            if consequent.variable == output.name
        ]
        shapes = {c.term: output.term(c.term).shape for _, _, c in conclusions}
        numbers = [shape.kind in ("singleton", "linear") for shape in shapes.values()]
        self.of_sets = not (record.weighs or all(numbers))
        if self.of_sets and (any(numbers) or defuzzifier.joined):
            raise self._refuse(f"defuzzifier {defuzzifier} of these terms")
        clips = {block.implication for block, _, _ in conclusions} if self.of_sets else set()
        scaled = clips == {"product"}
        if clips and not (clips == {"min"} or (scaled and self.adds)):
            raise self._refuse(f"implication {' and '.join(sorted(clips))}")
        self._conclude(self._collect(conclusions, shapes, scaled=scaled), scaled=scaled)

    def _collect(
        self, conclusions: Sequence[Any], shapes: Mapping[str, Shape], *, scaled: bool
    ) -> list[Shape]:
        """Fill in the rules; return the concluded terms, a column each."""
        record = self.output.defuzzifier.record
        keys: dict[object, int] = {}
        terms: list[Shape] = []
        self.rules: list[_Rule] = []
        for number, (block, rule, consequent) in enumerate(conclusions):
            if block.threshold or consequent.hedges:
                raise self._refuse("a threshold, or a hedge on a conclusion")
            shape = shapes[consequent.term]
            key: object = consequent.term
            if not self.of_sets and not record.weighs:  # singletons at one position are one set
                key = shape.parameters if shape.kind == "singleton" else key
            if self.of_sets and self.adds and not scaled:
                key = number  # a sum of clipped sets is not linear in the sum of strengths
            if not rule.weight:
                continue
            if key not in keys:
                keys[key] = len(keys)
                terms.append(shape)
            self._note(rule.antecedent)
            norms = block.conjunction, block.disjunction
            self.rules.append(_Rule(rule.antecedent, exact(rule.weight), keys[key], norms))
        if not self.rules:
            raise self._refuse(f"no rule concludes '{self.output.name}'")
        return terms

    def _note(self, node: Any) -> None:
        """Record the lines of the terms in an antecedent."""
        if isinstance(node, Is):
            variable = self.rulebase.variable(node.variable)
            if not isinstance(variable, Input):
                raise self._refuse(f"'{node.variable}' is an output")
            where = f"'{node.variable} is {node.term}'"
            self.lines[node.variable, node.term] = corners_of(variable.term(node.term).shape, where)
        else:
            for part in (node.operand,) if isinstance(node, Hedged) else node.operands:
                self._note(part)

    def _conclude(self, terms: Sequence[Shape], *, scaled: bool) -> None:
        """Fill in the columns' consequents: affine numbers with areas, or groups of sets."""
        self.values: list[tuple[fmpq, Vector]] = []
        self.areas, self.groups = [ONE] * len(terms), list[tuple[tuple[int, ...], ClippedSet]]()
        none = (ZERO,) * len(self.names)
        for number, shape in enumerate(terms):
            if shape.kind == "linear":
                *weights, constant = map(exact, shape.parameters)
                self.values.append((constant, tuple(weights)))
                continue
            if shape.kind == "singleton":
                self.values.append((exact(shape.parameters[0]), none))
                continue
            whole = self._set_of(shape)
            if not self.of_sets:  # a term counts as the middle of its core
                top = max(y for _, y0, _, y1 in whole.segments for y in (y0, y1))
                at = [x for x0, y0, x1, y1 in whole.segments for x, y in ((x0, y0), (x1, y1))
                      if y == top]  # fmt: skip
                self.values.append((exact(0.5 * (float(min(at)) + float(max(at)))), none))
                continue
            area, moment = (p[0] for p in whole.polynomials(len(whole.levels) - 1))
            self.areas[number] = area if scaled else ONE
            self.values.append((moment / area if area else ZERO, none))
            if not scaled:
                self.groups.append(((number,), whole))
        if self.of_sets and not scaled and not self.adds:
            self._unite(len(terms))
        self.of_sets = self.of_sets and not scaled

    def _set_of(self, shape: Shape) -> ClippedSet:
        corners = corners_of(shape, f"a term of '{self.output.name}'")
        low, high = exact(self.output.low), exact(self.output.high)
        if self.output.defuzzifier.resolution is not None:
            return ClippedSet(self._stairs(corners, low, high))
        cuts = [low, *sorted({x for x, _ in corners if low < x < high}), high]
        return ClippedSet([
            (a, height_beside(corners, a, right=True), b, height_beside(corners, b, right=False))
            for a, b in pairwise(cuts)
        ])  # fmt: skip

    def _stairs(self, corners: Corners, low: fmpq, high: fmpq) -> list[Segment]:
        """Return a step around each sample, as wide as its weight: integrals equal sums."""
        defuzzifier = self.output.defuzzifier
        count, sampling = defuzzifier.resolution, defuzzifier.sampling
        assert count is not None
        # Beside a vertical edge the last bit of a position decides, so heights are taken there.
        rounded = sample_positions(self.output.low, self.output.high, defuzzifier)
        stretches = count if sampling in ("midpoints", "left") else count - 1
        step = (high - low) / stretches
        segments = []
        for k, at in enumerate(rounded):
            x = low + step * k + (step / 2 if sampling == "midpoints" else ZERO)
            half = step / 4 if sampling == "trapezoid" and k in (0, count - 1) else step / 2
            y = height_at(corners, exact(at))
            segments.append((x - half, y, x + half, y))
        return segments

    def _unite(self, count: int) -> None:
        """Add the groups of overlapping sets (inclusion and exclusion)."""
        last = [(members, whole) for members, whole in self.groups if not whole.is_empty]
        while last:
            wider = []
            for members, whole in last:
                for other in range(members[-1] + 1, count):
                    group = lower_of(whole, self.groups[other][1])
                    if not group.is_empty:
                        wider.append(((*members, other), group))
            if len(self.groups) + len(wider) > 4096:
                raise self._refuse("too many sets of the output overlap")
            self.groups += wider
            last = wider

    # --- cutting ---

    def _stretches(self, name: str, low: fmpq, high: fmpq) -> tuple[list[fmpq], list[bool]]:
        """Return the corners of an input in an interval, and flags of those with a jump."""
        lines = [corners for (owner, _), corners in self.lines.items() if owner == name]
        inner = {x for corners in lines for x, _ in corners if low < x < high}
        cuts = [low, *sorted(inner), high] if low < high else [low]
        jumps = []
        for x in cuts:
            sides = [[height_beside(c, x, right=right) for c in lines]
                     for right, end in ((False, low), (True, high)) if x != end]  # fmt: skip
            here = [height_at(c, x) for c in lines]
            jumps.append(any(side != here for side in sides))
            if sides and here not in sides:
                raise self._refuse(f"a term of '{name}' has a value of its own at a point")
        return cuts, jumps

    def _simplices(
        self, cell: Sequence[tuple[fmpq, fmpq]], free: Sequence[int]
    ) -> Iterator[tuple[Vector, ...]]:
        """Yield Kuhn's simplices of a cell: walks from its lowest corner, axis by axis."""
        first = tuple(low for low, _ in cell)
        for order in permutations(free):
            corners = [first]
            for axis in order:
                corner = list(corners[-1])
                corner[axis] = cell[axis][1]
                corners.append(tuple(corner))
            yield tuple(corners)

    def _cut_cell(self, cell: Sequence[tuple[fmpq, fmpq]]) -> Iterator[Piece]:
        """Yield the pieces of a cell between corners of terms."""
        free = [k for k, (low, high) in enumerate(cell) if low < high]
        lines = {}
        for (name, term), corners in self.lines.items():
            axis = self.names.index(name)
            low, high = cell[axis]
            if low < high:
                at = (
                    height_beside(corners, low, right=True),
                    height_beside(corners, high, right=False),
                )
                lines[name, term] = axis, at[0], (at[1] - at[0]) / (high - low), low
            else:
                lines[name, term] = axis, height_at(corners, low), ZERO, low
        rules = [rule for rule in self.rules if self._may_fire(rule.antecedent, lines, cell)]
        waiting, count = list(self._simplices(cell, free)), 0
        while waiting:
            corners = waiting.pop()
            count += 1
            if count > MOST_PIECES:
                raise self._refuse("too many pieces")
            check_time()
            try:
                yield self._piece(corners, rules, lines)
            except UndecidedError as undecided:
                gap = undecided.gap
                i, j = gap.index(max(gap)), gap.index(min(gap))
                share = gap[i] / (gap[i] - gap[j])
                new = tuple(
                    a + share * (b - a) for a, b in zip(corners[i], corners[j], strict=True)
                )
                waiting += [(*corners[:k], new, *corners[k + 1 :]) for k in (i, j)]

    def _may_fire(self, node: Any, lines: Mapping[Any, Any], cell: Any) -> bool:
        if isinstance(node, Is) and not node.hedges:
            axis, first, slope, low = lines[node.variable, node.term]
            return bool(first > 0 or first + slope * (cell[axis][1] - low) > 0)
        if isinstance(node, Is | Hedged):
            return True
        parts = [self._may_fire(part, lines, cell) for part in node.operands]
        return all(parts) if isinstance(node, And) else any(parts)

    def _piece(self, corners: tuple[Vector, ...], rules: Sequence[_Rule], lines: Any) -> Piece:
        heights: dict[int, Any] = {}
        for rule in rules:
            height = self._truth(rule.antecedent, rule.norms, corners, lines)
            height = _times(height, rule.weight)
            if not _is_nothing(height):
                earlier = heights.get(rule.column)
                if earlier is None:
                    heights[rule.column] = height
                elif self.adds:
                    heights[rule.column] = _add(earlier, height, ONE)
                else:
                    heights[rule.column] = self._chosen(earlier, height, larger=True)
        upper, lower = self._clipped(heights, corners) if self.of_sets else self._averaged(
            heights, corners)  # fmt: skip
        piece = Piece(corners, upper, lower)
        if not is_positive(lower):
            return piece._replace(fault=f"'{self.name}' may have no value somewhere")
        low, high = exact(self.output.low), exact(self.output.high)
        if self.output.outside != "extend" and not is_within(piece, low, high):
            return piece._replace(fault=f"'{self.output.name}' leaves its range")
        return piece

    def _averaged(self, heights: Mapping[int, Any], corners: tuple[Vector, ...]) -> Any:
        ring, units = ring_of(len(corners))
        upper = lower = ring.constant(ZERO)
        for column, height in heights.items():
            constant, weights = self.values[column]
            share = _polynomial(height) * self.areas[column]
            at = tuple(constant + dot(weights, corner) for corner in corners)
            upper = plus(upper, share * linear(at), ONE)
            lower = plus(lower, share, ONE)
        if self.output.defuzzifier.record.of == "sum" and is_positive(lower):
            return upper, sum(units)
        return upper, lower

    def _clipped(self, heights: Mapping[int, Any], corners: tuple[Vector, ...]) -> Any:
        size = len(corners)
        upper = lower = ring_of(size)[0].constant(ZERO)
        for members, group in self.groups:
            if not all(member in heights for member in members):
                continue
            height = heights[members[0]]
            for member in members[1:]:
                height = self._chosen(height, heights[member], larger=False)
            if not isinstance(height, tuple):
                raise self._refuse("sets that are clipped at products")
            area, moment = group.polynomials(group.layer_of(height))
            h = linear(height)
            sign = 1 if len(members) % 2 else -1
            lower += _homogeneous(area, h, size) * sign
            upper += _homogeneous(moment, h, size) * sign
        return upper, lower

    def _truth(
        self, node: Any, norms: tuple[str, str], corners: tuple[Vector, ...], lines: Any
    ) -> Any:
        """Return the truth of an antecedent: values at the corners, or a polynomial."""
        if isinstance(node, Is):
            axis, first, slope, low = lines[node.variable, node.term]
            value: Any = tuple(first + slope * (corner[axis] - low) for corner in corners)
        elif isinstance(node, Hedged):
            value = self._truth(node.operand, norms, corners, lines)
        else:
            norm = norms[0] if isinstance(node, And) else norms[1]
            value = self._truth(node.operands[0], norms, corners, lines)
            for part in node.operands[1:]:
                other = self._truth(part, norms, corners, lines)
                value = self._joined(norm, isinstance(node, And), value, other)
            return value
        for hedge in reversed(node.hedges):
            ones = (ONE,) * len(corners)
            if hedge.name not in ("not", "any"):
                raise self._refuse(f"the hedge '{hedge.name}'")
            value = ones if hedge.name == "any" else _add(ones, value, -ONE)
        return value

    def _joined(self, norm: str, conjunction: bool, a: Any, b: Any) -> Any:
        if norm == ("min" if conjunction else "max"):
            return self._chosen(a, b, larger=not conjunction)
        if norm == "product" and conjunction:
            if _is_nothing(a) or _is_nothing(b):
                return a if _is_nothing(a) else b
            return _polynomial(a) * _polynomial(b)
        if norm != "bounded":
            raise self._refuse(f"{'and' if conjunction else 'or'} {norm}")
        total = _add(a, b, ONE)
        limit = (ZERO if conjunction else ONE,) * len(a)
        total = _add(total, (ONE,) * len(a), -ONE) if conjunction else total
        return self._chosen(total, limit, larger=conjunction)

    def _chosen(self, a: Any, b: Any, *, larger: bool) -> Any:
        """Return the larger or smaller of two heights; UndecidedError if they cross."""
        if not isinstance(a, tuple) or not isinstance(b, tuple):
            raise self._refuse("products of memberships beside other norms")
        gap = tuple(x - y for x, y in zip(a, b, strict=True))
        low, high = min(gap), max(gap)
        if low < 0 < high:
            raise UndecidedError(gap)
        return a if (low >= 0) == larger else b

    # --- claims ---

    def _cut(self, region: Region) -> tuple[list[Piece], bool]:
        """Return the pieces over a region, and whether a term jumps in it."""
        box = tuple(region[name] for name in self.names)
        if box in self._claimed:
            return self._claimed[box]
        for variable, (low, high) in zip(self.rulebase.inputs, box, strict=True):
            inside = exact(variable.low) <= low <= high <= exact(variable.high)
            if variable.outside != "extend" and not inside:
                raise LoopProofError(f"'{variable.name}' leaves its universe")
        axes = [self._stretches(n, *ends) for n, ends in zip(self.names, box, strict=True)]
        stretches = [list(pairwise(cuts)) or [(cuts[0], cuts[0])] for cuts, _ in axes]
        pieces: list[Piece] = []
        for cell in every(*stretches):
            pieces += self._cut_cell(cell)
            if len(pieces) > MOST_PIECES:
                raise self._refuse("too many pieces")
        fault = next((piece.fault for piece in pieces if piece.fault), "")
        if fault:
            raise LoopProofError(fault)
        self._claimed[box] = pieces, any(any(jumps) for _, jumps in axes)
        return self._claimed[box]

    def has_range(self, region: Region, low: fmpq, high: fmpq) -> bool:
        """Return whether the output is proved to lie between two numbers over a region."""
        return all(is_within(piece, low, high) for piece in self._cut(region)[0])

    def has_sector(
        self, region: Region, weights: Mapping[str, fmpq], low: fmpq, high: fmpq
    ) -> bool:
        """Return whether the output is proved to be σ = Σ wᵢ xᵢ times a bounded gain."""
        row = tuple(weights.get(name, ZERO) for name in self.names)
        for piece in self._cut(region)[0]:
            for side in sides_of(piece, row):
                sums = tuple(dot(row, corner) for corner in side.corners)
                sign = fmpq(-1) if any(total < 0 for total in sums) else ONE
                along = linear(sums) * side.lower
                for gain, factor in ((low, sign), (high, -sign)):
                    if not is_not_negative(plus(side.upper, along, -gain) * factor):
                        return False
        return True

    def has_slope(self, region: Region, name: str, low: fmpq, high: fmpq) -> bool:
        """Return whether the slope along an input is proved to lie between two numbers."""
        pieces, jumps = self._cut(region)
        if jumps:
            raise LoopProofError(f"a term of '{self.name}' has a vertical edge: jumps")
        axis = self.names.index(name)
        moving = [k for k, other in enumerate(self.names) if region[other][0] < region[other][1]]
        for piece in pieces:
            gradient = gradients_of(piece, moving)
            if gradient is None:
                continue  # a piece without a volume
            steep, area = (
                slope_along(piece, gradient, moving.index(axis)),
                piece.lower * piece.lower,
            )
            if not (
                is_not_negative(plus(steep, area, -low))
                and is_not_negative(plus(area * high, steep, -ONE))
            ):
                return False
        return True

    def value(self, region: Region) -> Number:
        """Return bounds of the output over a region, from the coefficients."""
        return hull(*(ratio(piece.upper, piece.lower) for piece in self._cut(region)[0]))

    # --- bounds for tubes ---

    @cached_property
    def grid(self) -> list[tuple[list[fmpq], list[bool], list[float]]]:
        """For each input: corners of terms in its range, flags of jumps, the corners as floats."""
        axes = []
        for variable in self.rulebase.inputs:
            if math.isinf(variable.high - variable.low):
                raise LoopProofError(f"the input '{variable.name}' of a rule base has no end")
            low, high = exact(variable.low), exact(variable.high)
            more = (high - low) * BEYOND if variable.outside == "extend" else ZERO
            cuts, jumps = self._stretches(variable.name, low - more, high + more)
            axes.append((cuts, jumps, [float(x) for x in cuts]))
        return axes

    def over(
        self, inputs: Mapping[str, Number], moving: Sequence[str]
    ) -> tuple[Number, dict[str, Number]]:
        """Return bounds of the output over a box of inputs, and of slopes along some of them."""
        box = [inputs[name] for name in self.names]
        axes = [self.names.index(name) for name in moving]
        bounds = [piece.bounds(axes, shares, box) for piece, shares in self._touched(inputs)]
        values, slopes = zip(*bounds, strict=True)
        return hull(*values), {
            name: hull(*along)
            for name, along in zip(moving, zip(*slopes, strict=True), strict=True)
        }

    def _touched(
        self, inputs: Mapping[str, Number]
    ) -> Iterator[tuple[BoundedPiece, list[tuple[Number, Number]]]]:
        """Yield the pieces that meet a box of inputs, each with its shares there."""
        indices = []
        for name, (cuts, jumps, near) in zip(self.names, self.grid, strict=True):
            low = math.nextafter(float_below(inputs[name]), -math.inf)
            high = math.nextafter(float_above(inputs[name]), math.inf)
            first, last = bisect_left(near, low), bisect_right(near, high)
            variable = self.rulebase.variable(name)
            if variable.outside == "extend" and not (near[0] < low and high < near[-1]):
                raise SpanError(f"'{name}' is far outside its range")
            if any(jumps[first:last]):
                raise SpanError(f"a term of '{self.name}' has a vertical edge: jumps")
            indices.append(range(max(first - 1, 0), min(last, len(cuts) - 1)))
        box = [inputs[name] for name in self.names]
        nothing = True
        for cell in every(*indices):
            for piece in self.pieces_of(cell):
                shares = piece.shares(box)
                if shares is None:
                    continue
                if piece.piece.fault:
                    raise SpanError(piece.piece.fault)
                nothing = False
                yield piece, shares
        if nothing:
            raise SpanError(f"'{self.name}' is evaluated outside its range")

    def pieces_of(self, cell: tuple[int, ...]) -> list[BoundedPiece]:
        """Return the pieces of a cell between corners of terms, by its index along each axis."""
        if cell not in self._cells:
            ends = [(cuts[k], cuts[k + 1]) for k, (cuts, _, _) in zip(cell, self.grid, strict=True)]
            self._cells[cell] = [BoundedPiece(piece) for piece in self._cut_cell(ends)]
        return self._cells[cell]


# ── heights ──────────────────────────────────────────────────────────────────────────


def _polynomial(height: Any) -> Polynomial:
    return linear(height) if isinstance(height, tuple) else height


def _homogeneous(weights: Sequence[fmpq], h: Polynomial, size: int) -> Polynomial:
    """Return Σ wₖ hᵏ as a homogeneous polynomial."""
    total = weights[-1]
    for power, weight in enumerate(reversed(weights[:-1]), 1):
        total = total * h + power_of_unit(size, power) * weight
    return total


def _times(height: Any, weight: fmpq) -> Any:
    return tuple(x * weight for x in height) if isinstance(height, tuple) else height * weight


def _add(a: Any, b: Any, factor: fmpq) -> Any:
    if isinstance(a, tuple) and isinstance(b, tuple):
        return tuple(x + factor * y for x, y in zip(a, b, strict=True))
    return plus(_polynomial(a), _polynomial(b), factor)


def _is_nothing(height: Any) -> bool:
    return not any(height) if isinstance(height, tuple) else bool(height.is_zero())


class RuleSurfaces:
    """The surfaces of a loop's rule bases, each read once."""

    def __init__(self) -> None:
        self._surfaces: dict[tuple[int, str], RuleSurface] = {}

    def __call__(self, rulebase: RuleBase, output: str) -> RuleSurface:
        """Return the surface of an output."""
        key = id(rulebase), output
        if key not in self._surfaces:
            self._surfaces[key] = RuleSurface(rulebase, output)
        return self._surfaces[key]
