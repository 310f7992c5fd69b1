"""The part of an output in a layout: its head, and the tables of its defuzzifier.

The picture of each stretch of numbers is in the module of the kernel that reads it:
:mod:`.closed_form`, :mod:`.centroid_kernel`, :mod:`.quadrature_kernel`, :mod:`.positions`,
:mod:`.type_reduction_kernel`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, Protocol

from fuzzyarm.inference import block as at
from fuzzyarm.inference.aggregate import sample_positions, sampled_set, weights
from fuzzyarm.inference.block import TermNumbers
from fuzzyarm.inference.centroid_kernel import AT_ONCE
from fuzzyarm.inference.firing_intervals import UPPER
from fuzzyarm.inference.overlap import Layers
from fuzzyarm.inference.plan import Member, OutputPlan, Plan
from fuzzyarm.inference.programs import CLOSED, JOINED, SAMPLES, program_of
from fuzzyarm.inference.quadrature import (
    CLIPPING,
    DEEPEST,
    MOST_PANELS,
    NODES,
    ROUNDING,
    TOLERANCE,
    WEIGHTS,
    noise_of,
    panels,
)
from fuzzyarm.inference.row_functions import Addresses, Curve, norm_number, plain_inverse
from fuzzyarm.inference.sets import Piece, cut_lines, formula_of, peak, plateaus
from fuzzyarm.inference.weighted import is_rising
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.symbolic.kernels import address_of
from fuzzyarm.symbolic.kinds import SHAPES, SNORMS, TNORMS, Norm
from fuzzyarm.symbolic.nodes import Node, replace, symbol, trace

if TYPE_CHECKING:
    from fuzzyarm.inference.maxima import SearchedMaxima


MOST_PADDED = 1 << 16
"""Samples of all sets of an output up to which zeros are stored, too."""


class LaidRule(NamedTuple):
    """A rule as numbers: the norm and the operands of its antecedent."""

    number: int
    norm: int
    conjunction: bool
    parts: tuple[int, ...]
    weight: float
    threshold: float


class Base(Protocol):
    """The layout around an output.

    Attributes
    ----------
    plan : Plan
        Of the whole rule base.
    addresses : Addresses
        The numbering of functions.
    editable : str
        The variable whose terms can be changed in place.
    point_only : bool
        Whether the address of the closed form is 0.
    whole, floats : list
        The numbers so far.
    marks : list of TermNumbers
        Positions of the numbers of terms.
    searches : list of SearchedMaxima
        Plain Python that the interpreted kernel calls.
    operands : int
        Of the longest rule.
    """

    plan: Plan
    addresses: Addresses
    editable: str
    point_only: bool
    whole: list[int]
    floats: list[float]
    marks: list[TermNumbers]
    searches: list[SearchedMaxima]
    operands: int

    @property
    def rules(self) -> Sequence[LaidRule]:
        """All rules."""

    def record(self, rule: LaidRule, rows: Mapping[int, int]) -> list[int]:
        """Return the numbers of a rule in a program."""


@cache
def _requested_numbers() -> dict[Node, float]:
    """Return the values that defuzzifiers of the kernel compute themselves, from their records."""
    from fuzzyarm.inference import positions

    return {
        symbol("half"): positions.HALF,
        symbol("mean"): positions.MEAN,
        symbol("first"): positions.FIRST,
        symbol("last"): positions.LAST,
        symbol("nearest"): positions.NEAREST,
        symbol("centroid"): positions.CENTROID,
        symbol("left"): -1.0,
        symbol("right"): 1.0,
        trace(lambda left, right: 0.5 * (left + right), ("left", "right")): 0.0,
    }


def requested_number(plan: OutputPlan) -> float:
    """Return the last float of an output with values: the number of the requested position."""
    from fuzzyarm.inference import positions

    record, way = plan.record, plan.output.defuzzifier
    if record.of == "top":
        return _requested_numbers().get(record.expression, positions.SEVERAL)
    if record.of == "ends":
        return _requested_numbers().get(record.expression, 0.0)
    nearest = record.of == "area" and way.sampling == "midpoints" and not plan.discrete
    if nearest and way.resolution is not None:
        return positions.NEAREST_HALF
    return _requested_numbers()[symbol(record.symbols[0])]


def post_processing(plan: OutputPlan, addresses: Addresses) -> tuple[int, int]:
    """Return the post-processing functions of a defuzzifier: of one number, and of several.

    Row functions by number, 0 for none or a built-in one.
    """
    record = plan.record
    first, *rest = record.aspect.figures
    if record.figure or record.expression in _requested_numbers():
        return 0, 0
    root = replace(record.expression, {first: symbol("x")})
    if not rest:
        return addresses.expression(root, ()), 0
    return 0, addresses.expression(root, (*rest, "none", "nothing")[:3])  # the order of `made_of`


class OutputWriter:
    """Writes the part of one output in the programs.

    Parameters
    ----------
    base : Base
        The layout, which gets the numbers.
    plan : OutputPlan
        The output.
    head : int
        Position of its head among the whole numbers.

    Attributes
    ----------
    heights, samples : int
        Number of rows of heights in its programs, and half the length of its heap.
    """

    def __init__(self, base: Base, plan: OutputPlan, head: int) -> None:
        self.base, self.plan = base, plan
        self.heights = self.samples = 0
        output, whole = plan.output, base.whole
        self.editable = output.name == base.editable
        self.program = program_of(plan, editable=self.editable)
        mode = {"clamp": at.CLAMP, "extend": at.EXTEND, "error": at.ERROR}[output.outside]
        floats = len(base.floats)
        no_rule = math.nan if isinstance(output.no_rule, str) else float(output.no_rule)
        base.floats += [output.low, output.high, no_rule, 0.0]
        self.members: dict[int, list[int]] = {}
        for member, rule in plan.contributions:
            self.members.setdefault(rule, []).append(member)
        self.consequents = [0] * len(plan.members)
        self.terms: dict[tuple[int, ...], list[int]] = {}  # by firing sets
        detail = self._write_detail()
        base.floats[floats + 3] = self._last_float()
        fold = self._norm(SNORMS[output.aggregation], "S")
        is_closed = self.program is CLOSED
        address = 0
        if not (is_closed and base.point_only):
            address = base.addresses.program(self.program)
        is_mean = bool(self.program.centre) and plan.record.of != "sum"
        finish, choice = post_processing(plan, base.addresses)
        self.samples += at.CHOICE_ROOM if choice else 0
        whole[head : head + at.OUTPUT_HEAD] = [
            address, floats, fold, mode, detail,
            int(is_mean), int(is_closed), int(self._is_max_min), finish, choice,
        ]  # fmt: skip

    def _write_detail(self) -> int:
        """Write the tables of the defuzzifier; return its number."""
        write = {
            "layers": self._write_layers, "values": self._write_values,
            "numbers": self._write_numbers, "pairs": self._write_pairs,
            "samples": self._write_samples, "levels": self._write_levels,
            "pieces": self._write_pieces, "panels": self._write_panels,
            "search": self._write_search,
        }  # fmt: skip
        return write[self.program.reads]()

    def _last_float(self) -> float:
        """Return the last float of an output: centre of the moments, or requested position."""
        output, centre = self.plan.output, self.program.centre
        if not centre:
            return requested_number(self.plan)
        if centre == "own" and self.plan.closed is not None:
            return self.plan.closed.centre
        return 0.5 * (output.low + output.high) if centre == "middle" else 0.0

    def _norm(self, norm: Norm, sort: str) -> int:
        return norm_number(norm, sort, self.base.addresses)

    @property
    def _is_max_min(self) -> bool:
        """Whether its rules are conjunctions under min, of weight 1, united by max."""
        rules = [rule for rule in self.base.rules if rule.number in self.members]
        return (
            self.plan.output.aggregation == "max"
            and self.base.operands > 1
            and all(rule.norm == at.MIN and rule.conjunction for rule in rules)
            and all(rule.weight == 1.0 and rule.threshold == 0.0 for rule in rules)
        )

    def _write_layers(self) -> int:
        form = self.plan.closed
        if form is None:  # an output without rules
            self.set_layers: list[tuple[int, int]] = []
            self.overlaps: list[tuple[int, tuple[int, ...], tuple[int, int]]] = []
            return 0
        self.set_layers = [self._put(layers, 1.0) for layers in form.set_layers]
        self.overlaps = [
            (overlap.member, overlap.others, self._put(overlap.layers, -1.0))
            for overlap in form.overlaps
        ]
        return 0

    def _put(self, layers: Layers, sign: float) -> tuple[int, int]:
        begin = len(self.base.floats)
        for start, depth, *rest in layers:
            self.base.floats += [start, depth, *(sign * number for number in rest)]
        return len(layers), begin

    def _write_samples(self) -> int:
        output, floats = self.plan.output, self.base.floats
        count = output.defuzzifier.resolution
        assert count is not None
        floats += sample_positions(output.low, output.high, output.defuzzifier)
        floats += weights(count, output.defuzzifier.sampling)
        # Two rows; three where both sides of an interval type-2 set are sampled.
        self.samples = (3 * count + 1) // 2 if self.plan.record.type2 else max(AT_ONCE, count)
        if self.program is JOINED:
            self.samples = 2 * (2 + self._most_groups)
        # In one pass: faster as machine code, slower interpreted.
        padded = self.base.addresses.compiled and count * len(self.plan.members) <= MOST_PADDED
        for i, member in enumerate(self.plan.members):
            sampled = sampled_set(
                member.term.shape, member.hedges, output.low, output.high, output.defuzzifier
            )
            begin, heights = sampled.first, sampled.heights
            if self.editable:  # samples over the whole range, zeros too
                begin, heights = 0, sampled.over(count)
            self.consequents[i] = len(self.base.whole)
            cut = self._norm(TNORMS[member.implication], "T")
            end = begin + len(heights)
            is_gravity = self.program is SAMPLES["gravity"]
            if is_gravity and padded:
                first = self._floats(sampled.over(count)) + begin
            else:
                first = self._floats(heights)
            self.base.whole += [begin, end, first, cut, self._side(i)]
            if is_gravity:
                united = member.implication == "min" and output.aggregation == "max"
                self.base.whole.append(int(padded and united))
            self._mark("samples", i, first, len(heights))
        return count

    @property
    def _most_groups(self) -> int:
        """Return the most groups of a cell: under other unions than ``max`` every rule is one."""
        return max(len(self.plan.members), len(self.plan.contributions))

    def _side(self, member: int) -> int:
        return self.plan.sides[member] if self.plan.sides else UPPER

    def _mark(self, sort: str, member: int, begin: int, capacity: int) -> None:
        """Record the positions of an unhedged consequent's numbers in an editable layout."""
        term_member, output = self.plan.members[member], self.plan.output
        if self.editable and not term_member.hedges:
            counted, scaled = self.consequents[member], term_member.implication == "product"
            mark = TermNumbers(
                sort, output.name, term_member.term.name, counted, begin, capacity, scaled
            )
            self.base.marks.append(mark)

    def _write_pieces(self) -> int:
        from fuzzyarm.inference import envelope

        pieces = 0
        for i, member in enumerate(self.plan.members):
            self.consequents[i] = len(self.base.whole)
            scaled = int(member.implication == "product")
            head = [len(member.pieces), len(self.base.floats), scaled, self._side(i)]
            self.base.whole += head
            capacity = len(member.pieces)
            if self.editable:  # a corner may move into the range, or off another one
                capacity = max(capacity, len(polyline(member.term.shape)) + 1)
            ends = [end for piece in member.pieces for end in piece[:4]]
            self._floats([*ends, *[0.0] * (envelope.PIECE * capacity - len(ends))])
            self._mark("pieces", i, len(self.base.floats) - envelope.PIECE * capacity, capacity)
            pieces += capacity
        begin, end = envelope.heap_size(pieces)
        self.samples = end // 2 + 1  # there are two rows of samples
        return begin

    def _write_panels(self) -> int:
        """Write the tables of the quadrature; see :mod:`fuzzyarm.inference.quadrature_kernel`."""
        from fuzzyarm.inference import quadrature_kernel

        plan, whole = self.plan, self.base.whole
        for i, member in enumerate(plan.members):
            curve = self.base.addresses.curve(member.term.shape, member.hedges)
            cut = self._norm(TNORMS[member.implication], "T")
            sloping = [item for item in member.pieces if item.straight and item.y0 != item.y1]
            clips = CLIPPING.get(member.implication, ())
            lines = lines_of(member.implication)
            self.consequents[i] = len(whole)
            whole += [curve.address, self._floats(curve.numbers), len(curve.numbers), cut, i]
            whole += [len(sloping), self._floats(end for piece in sloping for end in piece[:4])]
            whole += [len(clips), self._floats(number for clip in clips for number in clip)]
            whole += [len(lines), self._floats(number for line in lines for number in line)]
            whole.append(self._side(i))
            flats = plateaus(member.pieces)
            leaves_ones = TNORMS[member.implication].leaves_ones
            whole.append(len(flats) if leaves_ones else -1)
            whole.append(self._floats(end for flat in flats for end in flat))
        crossing = [
            (self.consequents[item.first], self.consequents[item.second], self._floats(item[2:]))
            for item in plan.stretches
            if lines_of(plan.members[item.first].implication)
            and lines_of(plan.members[item.second].implication)
        ]
        begin = len(whole)
        whole += [number for stretch in crossing for number in stretch]
        subtracts = noise_of(plan, 0.0) > 0.0
        constants = [TOLERANCE, DEEPEST, MOST_PANELS, ROUNDING, subtracts, *NODES, *WEIGHTS]
        edges = panels(plan)
        detail = len(whole)
        whole += [self._floats(constants), len(plan.members), len(edges), self._floats(edges)]
        whole += [len(crossing), begin]
        # At most two clips and four crossings for each set; under other unions than max for each
        # rule.
        each_rule = 1 if plan.output.aggregation == "max" else len(plan.contributions)
        most = len(edges) + 4 * len(crossing)
        most += 2 * each_rule * sum(len(member.pieces) for member in plan.members)
        deepest = quadrature_kernel.PANEL * (most + DEEPEST + 2)
        self.samples = (4 * quadrature_kernel.ROW + len(plan.members) + most + deepest) // 2 + 1
        return detail

    def _floats(self, numbers: Iterable[float]) -> int:
        """Append numbers; return the index of the first."""
        begin = len(self.base.floats)
        self.base.floats += map(float, numbers)
        return begin

    def _write_values(self) -> int:
        linear = any(member.value is None for member in self.plan.members)
        count = len(self.base.plan.rulebase.inputs) if linear else 0
        for i, member in enumerate(self.plan.members):
            self.consequents[i] = self._value(i, count)
            if member.value is not None:
                self._mark("value", i, self.consequents[i], 1)
        return count

    def _write_pairs(self) -> int:
        """Write interval values; see :mod:`fuzzyarm.inference.type_reduction_kernel`."""
        from fuzzyarm.inference import type_reduction_kernel

        count = len(self.base.plan.rulebase.inputs)
        for number, pair in enumerate(self.plan.pairs):
            upper, lower = (self._value(member, count) for member in pair)
            for side, member in enumerate(pair):
                self.consequents[member] = len(self.base.whole)
                self.base.whole += [number, side, lower, upper]
                self._mark("value", member, upper if side == UPPER else lower, 1)
        self.samples = type_reduction_kernel.PAIR_ROWS * len(self.plan.pairs) // 2 + 1
        return len(self.plan.pairs)

    def _value(self, member: int, count: int) -> int:
        """Append the constant and the coefficients of a value; return the index of the first."""
        value, shape = self.plan.members[member].value, self.plan.members[member].term.shape
        if value is not None:
            return self._floats([value, *[0.0] * count])
        *coefficients, constant_term = shape.parameters
        return self._floats([constant_term, *coefficients])

    def _write_levels(self) -> int:
        """Write the tables of a set for exact maxima; see :mod:`fuzzyarm.inference.positions`."""
        from fuzzyarm.inference import positions

        pieces = 0
        for i, member in enumerate(self.plan.members):
            cut = self._norm(TNORMS[member.implication], "T")
            clips = CLIPPING.get(member.implication, ())
            piece_rows = [self._piece(member, piece, inside=True) for piece in member.pieces]
            head = self._set(member, piece_rows)
            levels = [len(clips), self._floats(number for clip in clips for number in clip)]
            top = self._floats([peak(member.pieces)])
            self.consequents[i] = len(self.base.whole)
            self.base.whole += [*head, cut, *levels, top, int(member.implication != "bounded")]
            pieces += len(member.pieces)
        self.samples = positions.HEAP // 2 + pieces
        return 0

    def _write_search(self) -> int:
        from fuzzyarm.inference.maxima import SearchedMaxima

        for i in range(len(self.plan.members)):
            self.consequents[i] = len(self.base.whole)
            self.base.whole.append(i)
        self.base.searches.append(SearchedMaxima(self.plan))
        return self.base.searches[-1].number

    def _set(self, member: Member, pieces: Sequence[Sequence[float]]) -> list[int]:
        """Return the row function of a set and its pieces, from :data:`positions.FUNCTION` on."""
        address, numbers = Curve(0, ())
        if any(piece[-1] != 0.0 for piece in pieces):
            address, numbers = self.base.addresses.curve(member.term.shape, member.hedges)
        return [
            address, self._floats(numbers), len(numbers),
            len(pieces), self._floats(number for piece in pieces for number in piece),
        ]  # fmt: skip

    def _piece(self, member: Member, piece: Piece, *, inside: bool) -> list[float]:
        """Return the numbers of a piece; the search on a curve may begin just inside its ends."""
        ends = [piece.x0, piece.y0, piece.x1, piece.y1]
        if piece.straight:
            return [*ends, 0.0, 0.0, 0.0]
        a, b = piece.x0, piece.x1
        if inside:
            a, b = math.nextafter(a, b), math.nextafter(b, a)
        rises = member.membership(b) > member.membership(a)
        return [*ends, a, b, 1.0 if rises else -1.0]

    def _write_numbers(self) -> int:
        from fuzzyarm.inference import positions

        inputs = [variable.name for variable in self.base.plan.rulebase.inputs]
        for i, member in enumerate(self.plan.members):
            sort, head, numbers_here = self._number(member, inputs)
            own_at = self._floats(numbers_here)
            self.consequents[i] = len(self.base.whole)
            self.base.whole += [*head, sort, own_at]
            if sort == positions.CONSTANT:
                self._mark("value", i, own_at, 1)
        self.samples = (positions.HEAP + len(inputs)) // 2 + 1 + self._most_groups
        return 0

    def _number(
        self, member: Member, inputs: Sequence[str]
    ) -> tuple[int, list[int], Sequence[float]]:
        """Return the kind of a value, its head, and its own numbers."""
        from fuzzyarm.inference import positions

        shape, addresses = member.term.shape, self.base.addresses
        none = [0, 0, 0, 0, 0]
        if member.value is not None:
            return positions.CONSTANT, none, [member.value]
        if self.plan.record.inverts and member.pieces:
            inverse = SHAPES[shape.kind].inverse_expression
            position_of = SHAPES[shape.kind].position_of
            if inverse is None and position_of is not None and not member.hedges:
                address = address_of(plain_inverse(position_of), 3, compiled=False)
                head = [address, self._floats(shape.parameters), len(shape.parameters), 0, 0]
                return positions.INVERSE, head, [shape.height]
            if inverse is not None and not member.hedges:
                names = [f"number {i}" for i in range(len(shape.parameters))]
                root = _renamed(inverse, SHAPES[shape.kind].inverse_symbols, ["x", *names])
                numbers = [addresses.expression(root, names), self._floats(shape.parameters)]
                head = [*numbers, len(shape.parameters), 0, 0]
                return positions.INVERSE, head, [shape.height]
            rising = is_rising(self.plan, member)
            pieces = [self._piece(member, piece, inside=False) for piece in member.pieces]
            if not rising:
                pieces = [[x1, y1, x0, y0, *rest] for x0, y0, x1, y1, *rest in pieces[::-1]]
            end = self.plan.output.high if rising else self.plan.output.low
            return positions.LEVEL, self._set(member, pieces), [end]
        if member.formula is not None:
            root = formula_of(shape).with_constants(inputs)
            return (
                positions.FORMULA,
                [addresses.expression(root, inputs), *none[1:]],
                [shape.height],
            )
        *coefficients, constant_term = shape.parameters
        return positions.LINEAR, none, [constant_term, *coefficients]

    def indices(self) -> tuple[object, ...]:
        """Return all data of this output on which :meth:`write` depends."""
        united = self.plan.output.aggregation == "max"
        values = self._has_values
        layers = (self.set_layers, self.overlaps) if self.program is CLOSED else None
        return self.members, self.consequents, united, values, layers

    def write(self, active: Sequence[LaidRule], rows: Mapping[int, int]) -> None:
        """Append the part of this output in one cell."""
        whole = self.base.whole
        groups = list(self._groups(active))
        whole.append(len(groups))
        self.heights = max(self.heights, len(groups))
        for member, rules in groups:
            whole += [len(rules), self.consequents[member]]
            for rule in rules:
                whole += self.base.record(rule, rows)
        if self.program is CLOSED:
            members = tuple(member for member, _ in groups)
            if members not in self.terms:
                self.terms[members] = self._terms(members)
            whole += self.terms[members]

    def _groups(self, active: Sequence[LaidRule]) -> Iterator[tuple[int, list[LaidRule]]]:
        entries = [(m, rule) for rule in active for m in self.members.get(rule.number, ())]
        if self.plan.output.aggregation == "max" or self._has_values:
            grouped: dict[int, list[LaidRule]] = {}
            for member, rule in entries:
                grouped.setdefault(member, []).append(rule)
            # In the order of the sets in every cell: exported programs have the same order of sums.
            yield from sorted(grouped.items())
        else:
            for member, rule in entries:
                yield member, [rule]

    @property
    def _has_values(self) -> bool:
        """Whether the strengths of a value are folded, whatever the aggregation."""
        return self.program.reads in ("values", "numbers", "pairs")

    def _terms(self, members: Sequence[int]) -> list[int]:
        """Return unions of heights and terms of the closed form for some firing sets."""
        terms = [(g, g, self.set_layers[member]) for g, member in enumerate(members)]
        unions: list[list[int]] = []
        if self.plan.output.aggregation == "max":
            group_of = {member: g for g, member in enumerate(members)}
            for member, others, layers in self.overlaps:
                above = [group_of[other] for other in others if other in group_of]
                if member not in group_of or not above:
                    continue
                if len(above) > 1 and above not in unions:
                    unions.append(above)
                top = above[0] if len(above) == 1 else len(members) + unions.index(above)
                terms.append((group_of[member], top, layers))
        self.heights = max(self.heights, len(members) + len(unions))
        numbers_flat = [len(unions)]
        for union in unions:
            numbers_flat += [len(union), *union]
        numbers_flat.append(sum(count for _, _, (count, _) in terms))
        for layer_number, other, (count, floats) in terms:
            for layer in range(floats, floats + at.LAYER * count, at.LAYER):
                numbers_flat += (layer_number, other, layer)
        return numbers_flat


def _renamed(root: Node, names: Sequence[str], others: Sequence[str]) -> Node:
    """Return an expression with other names for its symbols."""
    return replace(root, dict(zip(names, map(symbol, others), strict=True)))


def lines_of(implication: str) -> list[tuple[float, float, float, float]]:
    """Return the lines of a set cut at w as (α₀, α₁, β₀, β₁): (α₀ + α₁ w) + (β₀ + β₁ w) μ."""
    at_0, at_1 = cut_lines(implication, 0.0), cut_lines(implication, 1.0)
    return [
        (alpha_0, alpha_1 - alpha_0, beta_0, beta_1 - beta_0)
        for (alpha_0, beta_0), (alpha_1, beta_1) in zip(at_0 or (), at_1 or (), strict=True)
    ]
