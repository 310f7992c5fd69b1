"""A rule base as the numbers that the kernel reads: cells of the inputs, programs, outputs."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from itertools import accumulate, pairwise, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.defuzzify.aggregate import places, weights
from fuzzyarm.inference.kernel.point import (
    CLAMP,
    CLOSED,
    CODES,
    COLUMNS,
    COUNT,
    ENDS,
    ERROR,
    EXTEND,
    FLOATS,
    HEAD,
    INPUT_HEAD,
    INPUTS,
    LAYER,
    ONES,
    ORDER,
    ORDERED,
    OUTPUT_HEAD,
    OUTPUTS,
    POINTS,
    RESULTS,
    ROOM,
    SAMPLED,
    SIZE,
    WEIGHTED,
    WEIGHTED_SUM,
    WIDTH,
    WORK_ROWS,
)
from fuzzyarm.inference.overlap import Layers
from fuzzyarm.inference.plan import Member, OutputPlan, Plan, PlannedRule
from fuzzyarm.inference.point import is_straight, line_at
from fuzzyarm.inference.sets import term_function
from fuzzyarm.model.rulebase import And, Hedge, Is, Or, Output, Shape
from fuzzyarm.model.shapes import polyline

# --- The range of an input cut at the corners of its terms ---
#
# Between two corners every straight term is one line, so a cell lists the lines that are
# not zero there. A corner with a vertical edge gets a cell of its own, as narrow as floats
# are: the value there belongs to the set. Even buckets lead from a value to its cell.

Line = tuple[float, float, float]
"""y0, x0 and slope: y = y0 + (x − x0) slope."""

ZERO_LINE: Line = (0.0, 0.0, 0.0)
IDENTITY: Line = (0.0, 0.0, 1.0)

FINENESS = 8
"""Most buckets for each cell."""


class Cells(NamedTuple):
    """An input, cut up.

    Attributes
    ----------
    edges : tuple of float
        Ascending; cell i reaches from edge i up to, but not at, edge i + 1. The first and
        the last are infinite.
    lines : tuple of dict of int to Line
        For each cell, the propositions that are not zero there, by their number.
    first, scale : float
        ``int((x − first) scale)`` is the bucket of x, brought into 0 … buckets − 1.
    starts : tuple of int
        The cell where to begin to look, for each bucket.
    """

    edges: tuple[float, ...]
    lines: tuple[dict[int, Line], ...]
    first: float
    scale: float
    starts: tuple[int, ...]


def cut_into_cells(
    propositions: Sequence[tuple[int, Shape, Sequence[Hedge]]], low: float, high: float
) -> Cells:
    """Cut an input at the corners of its straight propositions.

    Parameters
    ----------
    propositions : sequence of (int, Shape, sequence of Hedge)
        Number, shape and hedges of each.
    low, high : float
        Values that can occur.

    Returns
    -------
    Cells
        All cells that hold values from `low` to `high`.
    """
    corners = [polyline(shape) for _, shape, _ in propositions]
    steps = {a[0] for line in corners for a, b in pairwise(line) if a[0] == b[0]}
    places = sorted({x for line in corners for x, _ in line})
    edges = [-math.inf]
    for x in places:
        if x in steps:
            edges += [x, math.nextafter(x, math.inf)]
        else:
            edges.append(x)
    edges = _within(sorted(set(edges[1:])), low, high, steps)
    lines = []
    for left, right in pairwise(edges):
        left, right = max(left, low), min(right, high)  # noqa: PLW2901
        at_step = left in steps and right in {left, math.nextafter(left, math.inf)}
        cell: dict[int, Line] = {}
        for line, (number, shape, hedges) in zip(corners, propositions, strict=True):
            if at_step:
                found: Line | None = (term_function(shape, tuple(hedges))(left), 0.0, 0.0)
            else:
                found = _line(line, hedges, _between(left, right))
            if found is not None and found != ZERO_LINE:
                cell[number] = found
        lines.append(cell)
    first, scale, starts = _buckets(edges)
    return Cells(tuple(edges), tuple(lines), first, scale, starts)


def identity_cell(number: int) -> Cells:
    """Return the one cell of an input whose value is a degree already."""
    return Cells((-math.inf, math.inf), ({number: IDENTITY},), 0.0, 0.0, (0,))


def _within(edges: list[float], low: float, high: float, steps: set[float]) -> list[float]:
    """Drop the edges that no value passes."""
    kept = [x for x in edges if low < x < high or (x == high and x in steps)]
    return [-math.inf, *kept, math.inf]


def _between(left: float, right: float) -> float:
    if math.isinf(left) and math.isinf(right):
        return 0.0
    if math.isinf(left):
        return right - 1.0 - abs(right)
    return left + 1.0 + abs(left) if math.isinf(right) else 0.5 * (left + right)


def _line(corners: list[tuple[float, float]], hedges: Sequence[Hedge], place: float) -> Line | None:
    found = line_at(corners, hedges, place)
    return None if found is None else (found[1], found[0], found[2])


def _buckets(edges: list[float]) -> tuple[float, float, tuple[int, ...]]:
    """Return the even buckets that need the fewest steps from there to the cell."""
    inner = edges[1:-1]
    if len(inner) < 2:
        return 0.0, 0.0, (0,)
    first, width = inner[0], inner[-1] - inner[0]
    if not math.isfinite(width / (FINENESS * len(inner))) or not width > 0.0:
        return 0.0, 0.0, (0,)

    def late(count: int) -> float:
        """How far edges stand from the left end of their bucket, in widths of the range."""
        shares = [(x - first) / width * count for x in inner[:-1]]
        rounded = [share - math.floor(share + 1e-9) for share in shares]
        return sum(max(share, 0.0) for share in rounded) / count

    count = min(range(len(inner) - 1, FINENESS * len(inner)), key=lambda n: (late(n), n))
    starts = [0]  # the first bucket holds all that is below, the last all that is above
    for bucket in range(count + 1):
        left = first + (bucket + 1e-9) / count * width
        starts.append(sum(1 for x in inner if x <= left))
    return first - width / count, count / width, tuple(starts)


# --- A rule base as the numbers that the kernel reads ---

MOST_PROGRAMS = 65_536
MOST_ENTRIES = 400_000
"""Programs, and rules in all programs together; beyond, inputs are left out of the index."""

Key = tuple[str, str, tuple[Hedge, ...]]


class NotCovered(Exception):  # noqa: N818
    """The kernel does not do this; the message says what."""


class Curved(NamedTuple):
    """A proposition that another one computes: its degree is one more input of the kernel."""

    variable: str
    shape: Shape
    hedges: tuple[Hedge, ...]


class Layout(NamedTuple):
    """The numbers of a rule base.

    Attributes
    ----------
    whole, floats : list
        What the kernel reads.
    programs : int
        How many cells of all inputs together there are.
    rows, samples : int
        How many rows the kernel needs to work in, and how long they have to be at least.
    curved : tuple of Curved
        Inputs behind those of the rule base.
    """

    whole: list[int]
    floats: list[float]
    programs: int
    rows: int
    samples: int
    curved: tuple[Curved, ...]


class _Rule(NamedTuple):
    number: int
    code: int
    conjunction: bool
    parts: tuple[int, ...]
    weight: float
    threshold: float


class Block(NamedTuple):
    """The numbers with room for some points.

    Attributes
    ----------
    numbers : ndarray of float64
        What the kernel takes.
    columns, results : ndarray of float64, shapes (inputs, points) and (outputs, points)
        Parts of it.
    points : ndarray of int64, shape (1,)
        How many points there are; a part of it, too.
    """

    numbers: NDArray[np.float64]
    columns: NDArray[np.float64]
    results: NDArray[np.float64]
    points: NDArray[np.int64]


def make_block(layout: Layout, points: int) -> Block:
    """Give the numbers of a rule base room for so many points."""
    inputs, outputs = layout.whole[INPUTS], layout.whole[OUTPUTS]
    width = max(points, layout.samples)
    lengths = {
        FLOATS: len(layout.whole),
        ROOM: len(layout.floats),
        COLUMNS: layout.rows * width,
        RESULTS: inputs * width,
        ORDERED: outputs * width,
        ORDER: inputs * width,
        ENDS: 2 * width,
        SIZE: layout.programs + 2,
    }
    places = dict(zip(lengths, accumulate(lengths.values()), strict=True))
    numbers = np.zeros(places[SIZE])
    whole = numbers.view(np.int64)
    whole[: len(layout.whole)] = layout.whole
    whole[POINTS], whole[WIDTH] = points, width
    for name, place in places.items():
        whole[name] = place
    numbers[places[FLOATS] : places[ROOM]] = layout.floats
    ones = places[ROOM] + ONES * width
    numbers[ones : ones + width] = 1.0
    columns = numbers[places[COLUMNS] : places[RESULTS]].reshape(inputs, width)
    results = numbers[places[RESULTS] : places[ORDERED]].reshape(outputs, width)
    return Block(numbers, columns, results, whole[POINTS : POINTS + 1])


def lay_out(plan: Plan) -> Layout:
    """Write a plan as numbers.

    Parameters
    ----------
    plan : Plan
        Of any rule base.

    Returns
    -------
    Layout
        For :func:`fuzzyarm.inference.kernel.point.sweep`.

    Raises
    ------
    NotCovered
        If the kernel cannot evaluate it.
    """
    return _Writer(plan).layout()


class _Writer:
    def __init__(self, plan: Plan) -> None:
        if not plan.rulebase.inputs or not plan.rulebase.outputs:
            raise NotCovered("there is nothing to evaluate")
        self.plan = plan
        self.numbers: dict[Key, int] = {}
        self.rules = [self._rule(i, planned) for i, planned in enumerate(plan.rules)]
        for name, output in plan.outputs.items():
            if name in {key[0] for key in self.numbers}:
                raise NotCovered(f"'{name}' is used by later rules")
            _check_output(output)
        self._cut_inputs()
        self.whole: list[int] = []
        self.floats: list[float] = []

    def _rule(self, index: int, planned: PlannedRule) -> _Rule:
        antecedent = planned.rule.antecedent
        parts: tuple[Is, ...]
        conjunction, code = True, CODES[f"and {planned.conjunction}"]
        if isinstance(antecedent, Is):
            parts, code = (antecedent,), CODES["and min"]
        elif isinstance(antecedent, And | Or):
            parts = tuple(part for part in antecedent.operands if isinstance(part, Is))
            if len(parts) < len(antecedent.operands):
                raise NotCovered("a rule has parentheses")
            if isinstance(antecedent, Or):
                conjunction, code = False, CODES[f"or {planned.disjunction}"]
        else:
            raise NotCovered("a rule has a hedge on parentheses")
        keys = [(part.variable, part.term, part.hedges) for part in parts]
        found = tuple(self.numbers.setdefault(key, len(self.numbers)) for key in keys)
        weight, threshold = planned.rule.weight, planned.threshold
        return _Rule(index, code, conjunction, found, weight, threshold)

    # ── inputs ───────────────────────────────────────────────────────────────────────

    def _cut_inputs(self) -> None:
        """Cut the inputs into cells; not all of them where that would make too many programs."""
        given: set[str] = set()
        while True:
            self.cells, self.curved = self._cut(given)
            self.known = [{n for lines in cells.lines for n in lines} for cells in self.cells]
            programs = math.prod(len(cells.lines) for cells in self.cells)
            if programs <= MOST_PROGRAMS and self._entries() <= MOST_ENTRIES:
                return
            inputs = self.plan.rulebase.inputs
            sizes = {v.name: len(cells.lines) for v, cells in zip(inputs, self.cells, strict=False)}
            largest = max(sizes, key=lambda name: sizes[name])
            if sizes[largest] == 1:
                return
            given.add(largest)

    def _cut(self, given: set[str]) -> tuple[list[Cells], tuple[Curved, ...]]:
        """Cut the inputs; all degrees of those in `given` are found elsewhere."""
        cells: list[Cells] = []
        curved: list[Curved] = []
        bent: list[int] = []
        for variable in self.plan.rulebase.inputs:
            straight = []
            for (name, term, hedges), number in self.numbers.items():
                if name != variable.name:
                    continue
                shape = variable.term(term).shape
                if name not in given and is_straight(shape, hedges):
                    straight.append((number, shape, hedges))
                else:
                    curved.append(Curved(name, shape, hedges))
                    bent.append(number)
            bounded = variable.outside != "extend"
            low, high = (variable.low, variable.high) if bounded else (-math.inf, math.inf)
            cells.append(cut_into_cells(straight, low, high))
        return cells + [identity_cell(number) for number in bent], tuple(curved)

    def _entries(self) -> int:
        return sum(math.prod(len(each) for each in self._alive(rule)) for rule in self.rules)

    def _alive(self, rule: _Rule) -> list[list[int]]:
        """Return for each input the cells in which a rule can fire."""
        found = []
        for cells, known in zip(self.cells, self.known, strict=True):
            own = [part for part in rule.parts if part in known] if rule.conjunction else []
            if not own:
                found.append(list(range(len(cells.lines))))
                continue
            found.append(
                [i for i, lines in enumerate(cells.lines) if all(part in lines for part in own)]
            )
        return found

    # ── writing ──────────────────────────────────────────────────────────────────────

    def layout(self) -> Layout:
        inputs, outputs = len(self.cells), list(self.plan.outputs.values())
        self.whole = [0] * (HEAD + INPUT_HEAD * inputs)
        self.floats = [0.0] * (4 * inputs)
        slot, stride = ONES + 2, 1
        self.slots: list[tuple[int, list[dict[int, int]]]] = []
        self.lines: list[list[tuple[int, int]]] = []
        strides = []
        for i, cells in enumerate(self.cells):
            self._input(i, cells, slot, stride)
            strides.append(stride)
            slot += max(len(places) for places in self.slots[i][1])
            stride *= len(cells.lines)
        self.operands = max([len(rule.parts) for rule in self.rules], default=1)
        self.one, self.zero = ONES, ONES + 1
        heads = len(self.whole)
        self.whole += [0] * (OUTPUT_HEAD * len(outputs))
        self.rule_floats = []
        for rule in self.rules:
            self.rule_floats.append(len(self.floats))
            self.floats += [rule.weight, rule.threshold]
        writers = [
            _OutputWriter(self, output, heads + OUTPUT_HEAD * o) for o, output in enumerate(outputs)
        ]
        programs = len(self.whole)
        self.whole += [0] * stride
        for number, active in enumerate(self._active(strides, stride)):
            self.whole[programs + number] = len(self.whole)
            cells_here = [
                (number // step) % len(cells.lines)
                for cells, step in zip(self.cells, strides, strict=True)
            ]
            for c, lines in zip(cells_here, self.lines, strict=True):
                self.whole += lines[c]
            for writer in writers:
                writer.write(active, cells_here)
        work = slot + max([writer.heights for writer in writers], default=0)
        self.whole[: POINTS] = [
            inputs, len(outputs), self.operands, slot, work, programs, heads, stride,
        ]  # fmt: skip
        samples = max([writer.samples for writer in writers], default=0)
        rows = work + WORK_ROWS + (1 if samples else 0)
        return Layout(self.whole, self.floats, stride, rows, samples, self.curved)

    def _input(self, i: int, cells: Cells, slot: int, stride: int) -> None:
        variables = self.plan.rulebase.inputs
        low, high, clamped = -sys.float_info.max, sys.float_info.max, False
        if i < len(variables) and variables[i].outside != "extend":
            low, high = variables[i].low, variables[i].high
            clamped = variables[i].outside == "clamp"
        self.floats[4 * i : 4 * i + 4] = [low, high, cells.first, cells.scale]
        starts = len(self.whole)
        self.whole += cells.starts
        edges = len(self.floats)
        self.floats += cells.edges
        listed = [sorted(lines) for lines in cells.lines]
        here: list[tuple[int, int]] = []
        for found, lines in zip(listed, cells.lines, strict=True):
            here.append((len(self.floats), len(found)))
            for part in found:
                self.floats += lines[part]
        self.slots.append(
            (slot, [{part: slot + j for j, part in enumerate(found)} for found in listed])
        )
        self.lines.append(here)
        head = HEAD + INPUT_HEAD * i
        self.whole[head : head + INPUT_HEAD] = [
            int(clamped), len(cells.starts), starts, edges, stride, slot, len(listed),
        ]  # fmt: skip

    def _active(self, strides: Sequence[int], programs: int) -> list[list[_Rule]]:
        active: list[list[_Rule]] = [[] for _ in range(programs)]
        for rule in self.rules:
            for combination in product(*self._alive(rule)):
                number = sum(c * step for c, step in zip(combination, strides, strict=True))
                active[number].append(rule)
        return active

    def record(self, rule: _Rule, cells: Sequence[int]) -> list[int]:
        """Return [norm, weight, operands …] of a rule in a cell."""
        places: dict[int, int] = {}
        for c, (_, listed) in zip(cells, self.slots, strict=True):
            places.update(listed[c])
        operands = [places.get(part, self.zero) for part in rule.parts]
        neutral = self.one if rule.conjunction else self.zero
        operands += [neutral] * (self.operands - len(operands))
        return [rule.code, self.rule_floats[rule.number], *operands]


class _OutputWriter:
    """Writes what one output adds to the programs."""

    def __init__(self, base: _Writer, plan: OutputPlan, head: int) -> None:
        self.base, self.plan = base, plan
        self.heights = self.samples = 0
        output, whole = plan.output, base.whole
        self.kind = _kind(plan)
        mode = {"clamp": CLAMP, "extend": EXTEND, "error": ERROR}[output.outside]
        floats = len(base.floats)
        silent = math.nan if isinstance(output.no_rule, str) else float(output.no_rule)
        base.floats += [output.low, output.high, silent, 0.0]
        whole[head : head + OUTPUT_HEAD] = [
            self.kind, floats, CODES[f"or {output.aggregation}"], mode, 0,
        ]  # fmt: skip
        self.members: dict[int, list[int]] = {}
        for member, rule in plan.contributions:
            self.members.setdefault(rule, []).append(member)
        self.info = [0] * len(plan.members)
        self.layers: dict[int, tuple[int, int]] = {}
        if self.kind == CLOSED:
            self._write_layers(floats)
        elif self.kind == SAMPLED:
            whole[head + COUNT] = self._write_samples()
        else:
            whole[head + COUNT] = self._write_values()

    def _write_layers(self, floats: int) -> None:
        form = self.plan.closed
        assert form is not None
        self.base.floats[floats + 3] = form.centre
        self.own = [self._put(layers, 1.0) for layers in form.own]
        self.overlaps = [
            (overlap.member, overlap.others, self._put(overlap.layers, -1.0))
            for overlap in form.overlaps
        ]

    def _put(self, layers: Layers, sign: float) -> tuple[int, int]:
        place = len(self.base.floats)
        for start, depth, *rest in layers:
            self.base.floats += [start, depth, *(sign * number for number in rest)]
        return len(layers), place

    def _write_samples(self) -> int:
        output, floats = self.plan.output, self.base.floats
        count = output.defuzzifier.resolution
        assert count is not None
        where = places(output.low, output.high, count, output.defuzzifier.sampling)
        floats += where
        floats += weights(count, output.defuzzifier.sampling)
        self.samples = count
        for i, member in enumerate(self.plan.members):
            degrees = sampled_degrees(member, where)
            held = [j for j, degree in enumerate(degrees) if degree > 0.0]
            begin, end = (held[0], held[-1] + 1) if held else (0, 0)
            self.info[i] = len(self.base.whole)
            self.base.whole += [begin, end, len(floats), CODES[f"and {member.implication}"]]
            floats += degrees[begin:end]
        return count

    def _write_values(self) -> int:
        linear = any(member.value is None for member in self.plan.members)
        count = len(self.base.plan.rulebase.inputs) if linear else 0
        for i, member in enumerate(self.plan.members):
            self.info[i] = len(self.base.floats)
            if member.value is not None:
                self.base.floats += [member.value, *[0.0] * count]
            else:
                *coefficients, constant = member.term.shape.parameters
                self.base.floats += [constant, *coefficients]
        return count

    def write(self, active: Sequence[_Rule], cells: Sequence[int]) -> None:
        """Append what is to be done for this output in one cell."""
        whole = self.base.whole
        groups = list(self._groups(active))
        whole.append(len(groups))
        self.heights = max(self.heights, len(groups))
        for member, rules in groups:
            whole += [len(rules), self.info[member]]
            for rule in rules:
                whole += self.base.record(rule, cells)
        if self.kind == CLOSED:
            self._write_terms([member for member, _ in groups])

    def _groups(self, active: Sequence[_Rule]) -> Iterator[tuple[int, list[_Rule]]]:
        entries = [(m, rule) for rule in active for m in self.members.get(rule.number, ())]
        aggregation = self.plan.output.aggregation
        if aggregation == "max" or self.kind in {WEIGHTED, WEIGHTED_SUM}:
            grouped: dict[int, list[_Rule]] = {}
            for member, rule in entries:
                grouped.setdefault(member, []).append(rule)
            yield from grouped.items()
        else:
            for member, rule in entries:
                yield member, [rule]

    def _write_terms(self, members: Sequence[int]) -> None:
        terms = [(g, g, self.own[member]) for g, member in enumerate(members)]
        unions: list[list[int]] = []
        if self.plan.output.aggregation == "max":
            place = {member: g for g, member in enumerate(members)}
            for member, others, layers in self.overlaps:
                above = [place[other] for other in others if other in place]
                if member not in place or not above:
                    continue
                if len(above) > 1 and above not in unions:
                    unions.append(above)
                top = above[0] if len(above) == 1 else len(members) + unions.index(above)
                terms.append((place[member], top, layers))
        whole = self.base.whole
        whole.append(len(unions))
        for union in unions:
            whole += [len(union), *union]
        entries = [
            (own, other, floats + LAYER * i)
            for own, other, (count, floats) in terms
            for i in range(count)
        ]
        whole.append(len(entries))
        for own, other, floats in entries:
            whole += [own, other, floats]
        self.heights = max(self.heights, len(members) + len(unions))


def sampled_degrees(member: Member, where: Sequence[float]) -> list[float]:
    """Return the degrees of a set at the samples, as the engine for arrays finds them."""
    from fuzzyarm.inference.defuzzify.arrays import member_at

    return [float(degree) for degree in member_at(member, np.array(where))]


def _kind(plan: OutputPlan) -> int:
    if plan.discrete:
        method = plan.output.defuzzifier.method
        return WEIGHTED_SUM if method == "weighted-sum" else WEIGHTED
    return SAMPLED if plan.output.defuzzifier.resolution is not None else CLOSED


def _check_output(plan: OutputPlan) -> None:
    output: Output = plan.output
    method = output.defuzzifier.method
    if plan.discrete and method in {"centroid", "weighted-average", "weighted-sum"}:
        formulas = [member.term.name for member in plan.members if member.formula is not None]
        if formulas:
            raise NotCovered(f"'{output.name} is {formulas[0]}' is a formula")
        return
    if method != "centroid" or plan.discrete:
        raise NotCovered(f"the {method} of '{output.name}'")
    if output.defuzzifier.resolution is None and plan.closed is None and plan.members:
        raise NotCovered(f"the exact centroid of '{output.name}' has no closed form")
