"""A rule base as the numbers that the kernel reads: the picture of the block is there.

The writer goes through a plan once: inputs are cut into cells, each combination of cells
becomes a program with the rules that can fire in it, and every output adds what its
defuzzifier reads.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from fuzzyarm.expression.formulas import CONSTANTS
from fuzzyarm.expression.kinds import SHAPES, SNORMS, TNORMS, Norm
from fuzzyarm.expression.nodes import Node, replace, symbol
from fuzzyarm.inference import (
    envelope,
    enveloped,
    firing_intervals,
    integrated,
    positions,
    reduced,
)
from fuzzyarm.inference import kernel as at
from fuzzyarm.inference.aggregate import sample_positions, sampled_set, weights
from fuzzyarm.inference.block import Layout, Mark, NotCoveredError
from fuzzyarm.inference.cells import Cells, cut_into_cells
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.overlap import Layers
from fuzzyarm.inference.plan import (
    CENTROIDS,
    Member,
    OutputPlan,
    Plan,
    PlannedRule,
    has_envelope,
)
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
from fuzzyarm.inference.row_functions import Addresses, Curve, InMemory, norm_number
from fuzzyarm.inference.sets import Piece, cut_lines, formula_of, peak, plateaus
from fuzzyarm.inference.weighted import is_rising
from fuzzyarm.model.rulebase import (
    JOINED,
    KARNIK_MENDEL,
    MAXIMA,
    TYPE_2,
    WEIGHTED,
    And,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Output,
)
from fuzzyarm.model.shapes import polyline, straight_lines

MOST_PROGRAMS = 65_536
MOST_ENTRIES = 400_000
"""Programs, and rules in all programs together; beyond, inputs are left out of the index."""

Proposition = tuple[str, str, tuple[Hedge, ...]]
"""Variable, term and hedges."""


REDUCED_INTEGRALS = (reduced.karnik_mendel_integral, reduced.nie_tan_integral)

INTEGRATED = (
    integrated.integrated_centroid, integrated.integrated_bisector, *REDUCED_INTEGRALS,
)  # fmt: skip
"""Defuzzifiers that go by the quadrature."""


SAMPLED = (
    enveloped.sampled_centroid, reduced.karnik_mendel_samples, reduced.nie_tan_samples,
    positions.sampled_position, positions.joined_samples,
)  # fmt: skip
"""Defuzzifiers that go by samples."""

FOUND_VALUES = (positions.weighted_values, positions.position_of_values)
"""Defuzzifiers of values that are found: by formulas, where a set reaches its strength."""

PLACED = (
    positions.sampled_position, positions.joined_samples, positions.exact_maxima,
    positions.position_of_values,
)  # fmt: skip
"""Defuzzifiers that answer with one of several positions."""

WAYS = {
    "bisector": positions.HALF,
    "mean-of-maximum": positions.MEAN,
    "smallest-of-maximum": positions.SMALLEST,
    "largest-of-maximum": positions.LARGEST,
    "centroid": positions.CENTROID,
}
"""Which position is wanted, by the defuzzifier."""

ENVELOPED = (enveloped.enveloped_centroid, reduced.karnik_mendel_envelope, reduced.nie_tan_envelope)
"""Defuzzifiers that go by the upper envelope of straight sets."""

WHICH_END = {"karnik-mendel-left": -1.0, "karnik-mendel": 0.0, "karnik-mendel-right": 1.0}
"""Which end of the centroid is wanted: the left, the middle of both, the right."""


# ── the writer ───────────────────────────────────────────────────────────────────────


class _Truth(NamedTuple):
    """An expression in parentheses, under a number below 0: propositions have the others."""

    number: int
    norm: int
    operands: tuple[int, ...]
    hedges: int


class _Rule(NamedTuple):
    number: int
    norm: int
    conjunction: bool
    parts: tuple[int, ...]
    weight: float
    threshold: float


class _Numbered(NamedTuple):
    """Rules of a plan, the numbers of their propositions, and the rules in these."""

    planned: tuple[PlannedRule, ...]
    numbers: dict[Proposition, int]
    rules: list[_Rule]


_last_numbered: list[_Numbered] = []
"""Those of the last few plans, the newest in front."""


def lay_out(
    plan: Plan,
    *,
    compiled: bool = False,
    addresses: Addresses | None = None,
    loose: str = "",
    alone: bool = False,
) -> Layout:
    """Write a plan as numbers.

    Parameters
    ----------
    plan : Plan
        Of any rule base.
    compiled : bool
        Whether the kernel will run as machine code: row functions have other addresses then.
    addresses : Addresses, optional
        Who numbers the functions; by default they are addresses in this process.
    loose : str
        A variable whose terms are to have numbers of their own, so that they can be changed in
        place: an input without cells, an output without closed forms. It takes longer to
        evaluate, and its last bits differ.
    alone : bool
        For :func:`fuzzyarm.inference.kernel.evaluate` only: the address of what it does by itself
        is 0.

    Returns
    -------
    Layout
        For :func:`fuzzyarm.inference.kernel.sweep`, too, unless `alone`.

    Raises
    ------
    NotCoveredError
        If the kernel cannot evaluate it.
    """
    return _Writer(plan, addresses or InMemory(compiled), loose=loose, alone=alone).layout()


def what_is_not_covered(plan: Plan) -> str:
    """Return what the kernel cannot evaluate of a rule base; empty where it covers it."""
    try:
        lay_out(plan, compiled=False)
    except NotCoveredError as error:
        return str(error)
    return ""


class OutputLayout(NamedTuple):
    """The numbers of one output, for a defuzzifier that is given the strengths.

    Attributes
    ----------
    whole, floats : list
        What the defuzzifier reads. Behind the head and the output stand the groups, which list no
        rules.
    defuzzifier : callable
        A kernel of :data:`fuzzyarm.inference.programs.AT_POINT`.
    groups : tuple of int
        Indices of what asserts each group: members where strengths are folded, else contributions.
    rows : int
        Rows of the room that the caller fills: a strength for each group, or as it says.
    samples : int
        Half of the floats that it works in behind these rows and the work rows.
    """

    whole: list[int]
    floats: list[float]
    defuzzifier: Callable[[Any], None]
    groups: tuple[int, ...]
    rows: int
    samples: int


def lay_out_output(plan: Plan, name: str, addresses: Addresses) -> OutputLayout:
    """Write down what one output reads, for a caller that finds the strengths itself.

    Parameters
    ----------
    plan : Plan
        Of any rule base.
    name : str
        An output; under ``max`` its rules are folded by the caller, else every rule is a group.
    addresses : Addresses
        Who numbers the functions.

    Raises
    ------
    NotCoveredError
        If the kernel has no defuzzifier for it.
    """
    return _OneOutput(plan, plan.outputs[name], addresses).output_layout()


_programs: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {}
"""Programs by what they are written from, with how many heights each output has."""

MOST_KNOWN, MOST_KEPT = 16, 50_000
"""How many are kept before all make room; and the whole numbers of the longest."""


class _Writer:
    def __init__(self, plan: Plan, addresses: Addresses, *, loose: str, alone: bool) -> None:
        if not plan.rulebase.inputs or not plan.rulebase.outputs:
            raise NotCoveredError("there is nothing to evaluate")
        self.plan = plan
        self.addresses = addresses
        self.loose = loose
        self.alone = alone
        self.marks: list[Mark] = []
        self._number_rules()
        for name, output in plan.outputs.items():
            if name in {key[0] for key in self.numbers}:
                raise NotCoveredError(f"'{name}' is used by later rules")
            _check_output(output, [variable.name for variable in plan.rulebase.inputs])
        self._cut_inputs()
        self.whole: list[int] = []
        self.floats: list[float] = []

    def _number_rules(self) -> None:
        """Give propositions numbers; rules that a plan before had, as in tuning, keep theirs."""
        self.numbers: dict[Proposition, int] = {}
        self.truths: dict[tuple[Expression, str, str], _Truth] = {}  # inner ones first
        for known in _last_numbered:
            if known.planned is self.plan.rules:
                self.numbers, self.rules = known.numbers, known.rules
                return
        self.rules = [self._rule(i, planned) for i, planned in enumerate(self.plan.rules)]
        # Norms and hedges by address belong to one process, or to the text of one export.
        if not self.truths and all(rule.norm in at.BY_ITSELF for rule in self.rules):
            made = _Numbered(self.plan.rules, self.numbers, self.rules)
            _last_numbered[:] = [made, *_last_numbered[:3]]

    def _rule(self, index: int, planned: PlannedRule) -> _Rule:
        antecedent = planned.rule.antecedent
        norm, operands = self._joined(antecedent, planned)
        conjunction = not isinstance(antecedent, Or)
        return _Rule(index, norm, conjunction, operands, planned.rule.weight, planned.threshold)

    def _joined(self, expression: Expression, planned: PlannedRule) -> tuple[int, tuple[int, ...]]:
        """Return the norm of an expression, and the numbers of its operands."""
        if not isinstance(expression, And | Or):
            return at.MIN, (self._number(expression, planned),)
        conjunction = isinstance(expression, And)
        sort, norms = ("T", TNORMS) if conjunction else ("S", SNORMS)
        record = norms[planned.conjunction if conjunction else planned.disjunction]
        operands = tuple(self._number(each, planned) for each in expression.operands)
        return self.norm(record, sort), operands

    def norm(self, norm: Norm, sort: str) -> int:
        return norm_number(norm, sort, self.addresses)

    def _number(self, expression: Expression, planned: PlannedRule) -> int:
        if isinstance(expression, Is):
            proposition = (expression.variable, expression.term, expression.hedges)
            return self.numbers.setdefault(proposition, len(self.numbers))
        key = (expression, planned.conjunction, planned.disjunction)
        if key not in self.truths:
            hedges = 0
            if isinstance(expression, Hedged):
                hedges = self.addresses.hedged(expression.hedges)
                expression = expression.operand
            norm, operands = self._joined(expression, planned)
            self.truths[key] = _Truth(-1 - len(self.truths), norm, operands, hedges)
        return self.truths[key].number

    # ── inputs ───────────────────────────────────────────────────────────────────────

    def _cut_inputs(self) -> None:
        """Cut the inputs into cells; not all of them where that would make too many programs."""
        inputs = self.plan.rulebase.inputs
        uncut = {self.loose}
        while True:
            self._cut(uncut)
            self.homes = [_homes(cells) for cells in self.cells]
            programs = math.prod(len(cells.lines) for cells in self.cells)
            few = programs * (len(self.rules) + len(self.truths)) <= MOST_ENTRIES
            if programs <= MOST_PROGRAMS and (few or self._entries() <= MOST_ENTRIES):
                return
            sizes = {v.name: len(cells.lines) for v, cells in zip(inputs, self.cells, strict=True)}
            largest = max(sizes, key=lambda name: sizes[name])
            if sizes[largest] == 1:
                return
            uncut.add(largest)

    def _cut(self, uncut: set[str]) -> None:
        """Cut the inputs; all degrees of those in `uncut` are found by row functions."""
        self.cells: list[Cells] = []
        self.curves: list[list[tuple[int, Curve]]] = []
        for variable in self.plan.rulebase.inputs:
            straight = []
            curves = []
            for (name, term, hedges), number in self.numbers.items():
                if name != variable.name:
                    continue
                shape = variable.term(term).shape
                lines = None if name in uncut else straight_lines(shape, hedges)
                if lines is not None:
                    straight.append((number, lines))
                else:
                    curves.append((number, self.addresses.curve(shape, hedges)))
            bounded = variable.outside != "extend"
            low, high = (variable.low, variable.high) if bounded else (-math.inf, math.inf)
            self.cells.append(cut_into_cells(straight, low, high))
            self.curves.append(curves)

    def _entries(self) -> int:
        programs = math.prod(len(cells.lines) for cells in self.cells)
        rules = sum(math.prod(map(len, self._alive(rule))) for rule in self.rules)
        return rules + programs * len(self.truths)

    def _alive(self, rule: _Rule) -> list[Sequence[int]]:
        """Return for each input the cells in which a rule can fire."""
        found: list[Sequence[int]] = []
        for cells, homes in zip(self.cells, self.homes, strict=True):
            own = [homes[part] for part in rule.parts if part in homes] if rule.conjunction else []
            if len(own) < 2:
                found.append(own[0] if own else range(len(cells.lines)))
            else:
                found.append(sorted(set(own[0]).intersection(*own[1:])))
        return found

    # ── writing ──────────────────────────────────────────────────────────────────────

    def layout(self) -> Layout:
        inputs, outputs = len(self.cells), list(self.plan.outputs.values())
        self.whole = [0] * (at.HEAD + at.INPUT_HEAD * inputs)
        self.floats = [0.0] * (at.RANGE * inputs)
        row, stride = at.ONES + 2, 1
        self.rows: list[list[dict[int, int]]] = []
        self.lines: list[list[tuple[int, int]]] = []
        strides = []
        for i, cells in enumerate(self.cells):
            self._write_input(i, cells, row, stride)
            strides.append(stride)
            row += max(map(len, cells.lines)) + len(self.curves[i])
            stride *= len(cells.lines)
        self.truth_rows = {each.number: row + i for i, each in enumerate(self.truths.values())}
        row += len(self.truths)
        self.operands = max([len(rule.parts) for rule in self.rules], default=1)
        self.one, self.zero = at.ONES, at.ONES + 1
        heads = len(self.whole)
        self.whole += [0] * (at.OUTPUT_HEAD * len(outputs))
        self.rule_floats = []
        for rule in self.rules:
            self.rule_floats.append(len(self.floats))
            self.floats += [rule.weight, rule.threshold]
        writers = [
            _OutputWriter(self, output, heads + at.OUTPUT_HEAD * o)
            for o, output in enumerate(outputs)
        ]
        programs = len(self.whole)
        self._write_programs(writers, strides, stride)
        # Behind the programs, for how many buckets there are depends on numbers, not on the form.
        for i, cells in enumerate(self.cells):
            self.whole[at.HEAD + at.INPUT_HEAD * i + at.STARTS_AT] = len(self.whole)
            self.whole += cells.starts
        work = row + max([writer.heights for writer in writers], default=0)
        samples = max([writer.samples for writer in writers], default=0)
        self.whole[: at.POINTS] = [
            inputs, len(outputs), self.operands, row, work, programs, heads, stride, samples,
        ]  # fmt: skip
        self.whole[at.RUN] = 0 if self.alone else self.addresses.program(at.run)
        rows = work + at.WORK_ROWS
        return Layout(self.whole, self.floats, stride, rows, samples, tuple(self.marks))

    def _write_programs(
        self, writers: Sequence[_OutputWriter], strides: Sequence[int], count: int
    ) -> None:
        """Write the programs, or take over those of a layout that differs in its floats only.

        They are nearly all of the work, and name nothing but places: where the same terms meet
        in the same cells, and the same numbers of them stand in the same places, they are equal.
        So a rule base whose terms are moved a little, as in tuning, costs a fraction.
        """
        first = len(self.whole)
        places = (first, count, self.operands, self.rule_floats[:1], self.lines)
        rules = [each[:4] for each in self.rules]
        key = repr((places, rules, self.rows, self.truths, [each.places() for each in writers]))
        known = _programs.get(key)
        if known is None:
            self._write_each_program(writers, strides, count)
            if len(self.whole) - first <= MOST_KEPT:
                if len(_programs) >= MOST_KNOWN:
                    _programs.clear()  # in one step, for other threads write, too
                rows = tuple(writer.heights for writer in writers)
                _programs[key] = (tuple(self.whole[first:]), rows)
            return
        programs, rows = known
        self.whole += programs
        for writer, heights in zip(writers, rows, strict=True):
            writer.heights = heights

    def _write_each_program(
        self, writers: Sequence[_OutputWriter], strides: Sequence[int], count: int
    ) -> None:
        first = len(self.whole)
        self.whole += [0] * count
        for number, active in enumerate(self._active(strides, count)):
            self.whole[first + number] = len(self.whole)
            cells_here = [
                (number // step) % len(cells.lines)
                for cells, step in zip(self.cells, strides, strict=True)
            ]
            rows = dict(self.truth_rows)  # of degrees in this cell
            for c, lines, listed in zip(cells_here, self.lines, self.rows, strict=True):
                self.whole += lines[c]
                rows |= listed[c]
            self._write_truths(rows)
            for writer in writers:
                writer.write(active, rows)

    def _write_input(self, i: int, cells: Cells, row: int, stride: int) -> None:
        variable = self.plan.rulebase.inputs[i]
        low, high, clamped = -sys.float_info.max, sys.float_info.max, False
        if variable.outside != "extend":
            low, high = variable.low, variable.high
            clamped = variable.outside == "clamp"
        self.floats[at.RANGE * i : at.RANGE * (i + 1)] = [low, high, cells.first, cells.scale]
        edges = len(self.floats)
        # An infinite value lies in no cell: to other engines its lines have degrees, too.
        self.floats += [-sys.float_info.max, *cells.edges[1:]]
        listed = [sorted(lines) for lines in cells.lines]
        most = max(map(len, listed))
        here: list[tuple[int, int]] = []
        for found, lines in zip(listed, cells.lines, strict=True):
            here.append((len(self.floats), len(found)))
            for part in found:
                self.floats += lines[part]
        self.lines.append(here)
        curves = len(self.whole)
        terms = {number: (term, hedges) for (_, term, hedges), number in self.numbers.items()}
        for j, (number, curve) in enumerate(self.curves[i]):
            begin, (term, hedges) = len(self.floats), terms[number]
            self.whole += [curve.address, begin, len(curve.numbers)]
            self.floats += curve.numbers
            if variable.name == self.loose and not hedges:
                mark = ("curve", variable.name, term, row + most + j, begin, len(curve.numbers))
                self.marks.append(Mark(*mark))
        always = {part: row + most + j for j, (part, _) in enumerate(self.curves[i])}
        self.rows.append(
            [{part: row + j for j, part in enumerate(found)} | always for found in listed]
        )
        head = at.HEAD + at.INPUT_HEAD * i
        self.whole[head : head + at.INPUT_HEAD] = [
            int(clamped), len(cells.starts), 0, edges, stride, row, most, len(always), curves, 0,
        ]  # fmt: skip

    def _active(self, strides: Sequence[int], programs: int) -> list[list[_Rule]]:
        active: list[list[_Rule]] = [[] for _ in range(programs)]
        for rule in self.rules:
            numbers = [0]
            for cells, step in zip(self._alive(rule), strides, strict=True):
                numbers = [number + c * step for number in numbers for c in cells]
            for number in numbers:
                active[number].append(rule)
        return active

    def _write_truths(self, rows: Mapping[int, int]) -> None:
        self.whole.append(len(self.truths))
        for number, norm, operands, hedges in self.truths.values():
            self.whole += [self.truth_rows[number], norm, hedges, len(operands)]
            self.whole += [rows.get(part, self.zero) for part in operands]

    def record(self, rule: _Rule, rows: Mapping[int, int]) -> list[int]:
        """Return [norm, weight, operands …] of a rule; that of zeros for a term that is 0 there."""
        found = [rule.norm, self.rule_floats[rule.number]]
        found += [rows.get(part, self.zero) for part in rule.parts]
        own = rule.norm not in at.BY_ITSELF  # which passes over a row of ones
        neutral = self.one if rule.conjunction or own else self.zero
        return found + [neutral] * (self.operands - len(rule.parts))


def _homes(cells: Cells) -> dict[int, list[int]]:
    """Return of each straight proposition in which cells it is not zero."""
    found: dict[int, list[int]] = {}
    for cell, lines in enumerate(cells.lines):
        for part in lines:
            found.setdefault(part, []).append(cell)
    return found


class _OneOutput(_Writer):
    """The base of an output that stands alone: no inputs, no rules."""

    def __init__(self, plan: Plan, output: OutputPlan, addresses: Addresses) -> None:
        self.plan, self.output, self.addresses = plan, output, addresses
        self.loose, self.alone = "", False
        self.marks: list[Mark] = []
        self.rules: list[_Rule] = []
        self.operands = 0
        self.whole = [0] * (at.HEAD + at.OUTPUT_HEAD)
        self.floats: list[float] = []
        if not output.discrete:
            _check_output(output, ())

    def output_layout(self) -> OutputLayout:
        output = self.output
        defuzzifier = _defuzzifier(output)
        if output.discrete:
            return self._of_values()
        writer = _OutputWriter(self, output, at.HEAD)
        united = output.output.aggregation == "max"
        members = (
            sorted({member for member, _ in output.contributions})
            if united
            else [member for member, _ in output.contributions]
        )
        groups = members if united else list(range(len(output.contributions)))
        self._finish(len(groups), [writer.consequents[member] for member in members], len(groups))
        return OutputLayout(
            self.whole, self.floats, defuzzifier, tuple(groups), len(groups), writer.samples
        )

    def _of_values(self) -> OutputLayout:
        """Write what a choice among values reads, or the ends of an average: no value is in it."""
        method = self.output.output.defuzzifier.method
        if method in KARNIK_MENDEL:
            count, samples = len(self.output.pairs), reduced.PAIR_ROWS * len(self.output.pairs)
            way, rows = WHICH_END[method], reduced.PAIR_ROWS * count
            groups = tuple(member for pair in self.output.pairs for member in pair)
            defuzzifier: Callable[[Any], None] = reduced.ends_of_rows
        else:
            groups = tuple(sorted({member for member, _ in self.output.contributions}))
            count, samples = len(groups), 2 * len(groups)
            way, rows = float(way_of(self.output)), 2 * count
            defuzzifier = positions.position_of_rows
        self.floats += [0.0, 0.0, 0.0, way]
        self.whole[at.HEAD + at.DETAIL] = count
        self._finish(count, [0] * count, rows)
        return OutputLayout(self.whole, self.floats, defuzzifier, groups, rows, (samples + 1) // 2)

    def _finish(self, groups: int, consequents: Sequence[int], rows: int) -> None:
        whole = self.whole
        whole[at.WIDTH], whole[at.OUTPUT], whole[at.WORK] = 1, at.HEAD, rows
        whole[at.GROUPS] = len(whole)
        whole.append(groups)
        for consequent in consequents:
            whole += [0, consequent]
        # What reads ahead of a condition, as some languages do, stays inside.
        self.floats += [0.0, 0.0]


class _OutputWriter:
    """Writes what one output adds to the programs."""

    def __init__(self, base: _Writer, plan: OutputPlan, head: int) -> None:
        self.base, self.plan = base, plan
        self.heights = self.samples = 0
        output, whole = plan.output, base.whole
        self.loose = output.name == base.loose
        self.defuzzifier = _defuzzifier(plan, loose=self.loose)
        mode = {"clamp": at.CLAMP, "extend": at.EXTEND, "error": at.ERROR}[output.outside]
        floats = len(base.floats)
        silent = math.nan if isinstance(output.no_rule, str) else float(output.no_rule)
        base.floats += [output.low, output.high, silent, 0.0]
        self.members: dict[int, list[int]] = {}
        for member, rule in plan.contributions:
            self.members.setdefault(rule, []).append(member)
        self.consequents = [0] * len(plan.members)
        self.terms: dict[tuple[int, ...], list[int]] = {}  # by the sets that may fire
        detail = self._write_detail(floats)
        base.floats[floats + 3] = self._last_float(base.floats[floats + 3])
        is_mean = self.defuzzifier not in PLACED and output.defuzzifier.method not in {
            "weighted-sum", "bisector", *KARNIK_MENDEL
        }  # fmt: skip
        fold = base.norm(SNORMS[output.aggregation], "S")
        is_closed = self.defuzzifier is at.closed_centroid
        address = 0
        if not (is_closed and base.alone):
            address = base.addresses.program(self.defuzzifier)
        whole[head : head + at.OUTPUT_HEAD] = [
            address, floats, fold, mode, detail,
            int(is_mean), int(is_closed), int(self._is_max_min),
        ]  # fmt: skip

    def _write_detail(self, floats: int) -> int:
        """Write what the defuzzifier reads of its own; return its number."""
        if self.defuzzifier is at.closed_centroid:
            self._write_layers(floats)
            return 0
        if self.defuzzifier is positions.exact_maxima:
            self._write_levels()
            return 0
        if self.defuzzifier in FOUND_VALUES:
            self._write_found_values()
            return 0
        write = self._write_values
        if self.defuzzifier in SAMPLED:
            write = self._write_samples
        elif self.defuzzifier in ENVELOPED:
            write = self._write_pieces
        elif self.defuzzifier in INTEGRATED:
            write = self._write_integral
        elif self.defuzzifier is reduced.karnik_mendel_values:
            write = self._write_pairs
        return write()

    def _last_float(self, centre: float) -> float:
        """Return the last float of an output: the centre of the moments, or what is wanted."""
        output = self.plan.output
        if self.defuzzifier in PLACED:
            return float(way_of(self.plan))
        if output.defuzzifier.method in KARNIK_MENDEL:
            return WHICH_END[output.defuzzifier.method]
        about_middle = {*INTEGRATED, reduced.nie_tan_envelope}
        return 0.5 * (output.low + output.high) if self.defuzzifier in about_middle else centre

    @property
    def _is_max_min(self) -> bool:
        """Whether its rules are conjunctions under min that count in full, united by max."""
        rules = [each for each in self.base.rules if each.number in self.members]
        return (
            self.plan.output.aggregation == "max"
            and self.base.operands > 1
            and all(each.norm == at.MIN and each.conjunction for each in rules)
            and all(each.weight == 1.0 and each.threshold == 0.0 for each in rules)
        )

    def _write_layers(self, floats: int) -> None:
        form = self.plan.closed
        if form is None:  # an output that no rule concludes
            self.own: list[tuple[int, int]] = []
            self.overlaps: list[tuple[int, tuple[int, ...], tuple[int, int]]] = []
            return
        self.base.floats[floats + 3] = form.centre
        self.own = [self._put(layers, 1.0) for layers in form.own]
        self.overlaps = [
            (overlap.member, overlap.others, self._put(overlap.layers, -1.0))
            for overlap in form.overlaps
        ]

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
        # Two rows, or three, where both sides of an interval type-2 set are sampled.
        self.samples = count if not self.plan.sides else (3 * count + 1) // 2
        if self.defuzzifier is positions.joined_samples:
            self.samples = 2 * (2 + self._most_groups)
        for i, member in enumerate(self.plan.members):
            found = sampled_set(
                member.term.shape, member.hedges, output.low, output.high, output.defuzzifier
            )
            begin, heights = found.first, found.heights
            if self.loose:  # a sample for each position, also where the set is 0 now
                begin, heights = 0, found.over(count)
            self.consequents[i] = len(self.base.whole)
            cut = self.base.norm(TNORMS[member.implication], "T")
            end, first = begin + len(heights), self._floats(heights)
            self.base.whole += [begin, end, first, cut, self._side(i)]
            self._mark("samples", i, len(floats) - len(heights), len(heights))
        return count

    @property
    def _most_groups(self) -> int:
        """The most groups of a cell: under other unions than ``max`` every rule is one."""
        return max(len(self.plan.members), len(self.plan.contributions))

    def _side(self, member: int) -> int:
        return self.plan.sides[member] if self.plan.sides else firing_intervals.UPPER

    def _mark(self, sort: str, member: int, begin: int, room: int) -> None:
        """Note where the numbers of a consequent without hedges stand in a loose layout."""
        found, output = self.plan.members[member], self.plan.output
        if self.loose and not found.hedges:
            counted, scaled = self.consequents[member], found.implication == "product"
            mark = Mark(sort, output.name, found.term.name, counted, begin, room, scaled)
            self.base.marks.append(mark)

    def _write_pieces(self) -> int:
        pieces = 0
        for i, member in enumerate(self.plan.members):
            self.consequents[i] = len(self.base.whole)
            scaled = int(member.implication == "product")
            head = [len(member.pieces), len(self.base.floats), scaled, self._side(i)]
            self.base.whole += head
            room = len(member.pieces)
            if self.loose:  # a corner may move into the range, or off another one
                room = max(room, len(polyline(member.term.shape)) + 1)
            ends = [end for piece in member.pieces for end in piece[:4]]
            self._floats([*ends, *[0.0] * (envelope.PIECE * room - len(ends))])
            self._mark("pieces", i, len(self.base.floats) - envelope.PIECE * room, room)
            pieces += room
        begin, end = envelope.heap_size(pieces)
        self.samples = end // 2 + 1  # there are two rows of samples
        return begin

    def _write_integral(self) -> int:
        """Write what the quadrature reads; see :mod:`fuzzyarm.inference.integrated`."""
        plan, whole = self.plan, self.base.whole
        for i, member in enumerate(plan.members):
            curve = self.base.addresses.curve(member.term.shape, member.hedges)
            cut = self.base.norm(TNORMS[member.implication], "T")
            sloping = [each for each in member.pieces if each.straight and each.y0 != each.y1]
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
            (self.consequents[each.first], self.consequents[each.second], self._floats(each[2:]))
            for each in plan.stretches
            if lines_of(plan.members[each.first].implication)
            and lines_of(plan.members[each.second].implication)
        ]
        begin = len(whole)
        whole += [number for stretch in crossing for number in stretch]
        subtracts = noise_of(plan, 0.0) > 0.0
        constants = [TOLERANCE, DEEPEST, MOST_PANELS, ROUNDING, subtracts, *NODES, *WEIGHTS]
        edges = panels(plan)
        detail = len(whole)
        whole += [self._floats(constants), len(plan.members), len(edges), self._floats(edges)]
        whole += [len(crossing), begin]
        # At most two clips and four crossings of lines; under other norms than max every rule.
        each_rule = 1 if plan.output.aggregation == "max" else len(plan.contributions)
        most = len(edges) + 4 * len(crossing)
        most += 2 * each_rule * sum(len(member.pieces) for member in plan.members)
        deepest = integrated.PANEL * (most + DEEPEST + 2)
        self.samples = (4 * integrated.ROW + len(plan.members) + most + deepest) // 2 + 1
        return detail

    def _floats(self, numbers: Iterable[float]) -> int:
        """Append numbers; return where they begin."""
        begin = len(self.base.floats)
        self.base.floats += map(float, numbers)
        return begin

    def _write_values(self) -> int:
        linear = any(member.value is None for member in self.plan.members)
        count = len(self.base.plan.rulebase.inputs) if linear else 0
        for i, member in enumerate(self.plan.members):
            self.consequents[i] = len(self.base.floats)
            if member.value is not None:
                self.base.floats += [member.value, *[0.0] * count]
                self._mark("value", i, self.consequents[i], 1)
            else:
                *coefficients, constant_term = member.term.shape.parameters
                self.base.floats += [constant_term, *coefficients]
        return count

    def _write_pairs(self) -> int:
        """Write values between two; see :mod:`fuzzyarm.inference.reduced`."""
        count = len(self.base.plan.rulebase.inputs)
        for number, pair in enumerate(self.plan.pairs):
            upper, lower = (self._value(member, count) for member in pair)
            for side, member in enumerate(pair):
                self.consequents[member] = len(self.base.whole)
                self.base.whole += [number, side, lower, upper]
                self._mark("value", member, upper if side == firing_intervals.UPPER else lower, 1)
        self.samples = reduced.PAIR_ROWS * len(self.plan.pairs) // 2 + 1
        return len(self.plan.pairs)

    def _value(self, member: int, count: int) -> int:
        """Append the constant and the coefficients of a value; return where they begin."""
        value, shape = self.plan.members[member].value, self.plan.members[member].term.shape
        if value is not None:
            return self._floats([value, *[0.0] * count])
        *coefficients, constant_term = shape.parameters
        return self._floats([constant_term, *coefficients])

    def _write_levels(self) -> None:
        """Write what exact maxima read of a set; see :mod:`fuzzyarm.inference.positions`."""
        pieces = 0
        for i, member in enumerate(self.plan.members):
            cut = self.base.norm(TNORMS[member.implication], "T")
            clips = CLIPPING.get(member.implication, ())
            own = [self._piece(member, each, inside=True) for each in member.pieces]
            head = self._set(member, own)
            levels = [len(clips), self._floats(number for clip in clips for number in clip)]
            top = self._floats([peak(member.pieces)])
            self.consequents[i] = len(self.base.whole)
            self.base.whole += [*head, cut, *levels, top, int(member.implication != "bounded")]
            pieces += len(member.pieces)
        self.samples = positions.HEAP // 2 + pieces

    def _set(self, member: Member, pieces: Sequence[Sequence[float]]) -> list[int]:
        """Return the function of a set and its pieces, as :data:`positions.FUNCTION` begins."""
        address, numbers = Curve(0, ())
        if any(piece[-1] != 0.0 for piece in pieces):
            address, numbers = self.base.addresses.curve(member.term.shape, member.hedges)
        return [
            address, self._floats(numbers), len(numbers),
            len(pieces), self._floats(number for piece in pieces for number in piece),
        ]  # fmt: skip

    def _piece(self, member: Member, piece: Piece, *, inside: bool) -> list[float]:
        """Return the numbers of a piece; a search of a curve may begin just inside its ends."""
        ends = [piece.x0, piece.y0, piece.x1, piece.y1]
        if piece.straight:
            return [*ends, 0.0, 0.0, 0.0]
        a, b = piece.x0, piece.x1
        if inside:
            a, b = math.nextafter(a, b), math.nextafter(b, a)
        rises = member.membership(b) > member.membership(a)
        return [*ends, a, b, 1.0 if rises else -1.0]

    def _write_found_values(self) -> None:
        inputs = [variable.name for variable in self.base.plan.rulebase.inputs]
        for i, member in enumerate(self.plan.members):
            sort, head, own = self._found_value(member, inputs)
            own_at = self._floats(own)
            self.consequents[i] = len(self.base.whole)
            self.base.whole += [*head, sort, own_at]
            if sort == positions.CONSTANT:
                self._mark("value", i, own_at, 1)
        self.samples = (positions.HEAP + len(inputs)) // 2 + 1 + self._most_groups

    def _found_value(
        self, member: Member, inputs: Sequence[str]
    ) -> tuple[int, list[int], Sequence[float]]:
        """Return how a value is found, what for, and the numbers of its own."""
        shape, addresses = member.term.shape, self.base.addresses
        none = [0, 0, 0, 0, 0]
        if member.value is not None:
            return positions.CONSTANT, none, [member.value]
        if self.plan.output.defuzzifier.method == "tsukamoto" and member.pieces:
            inverse = SHAPES[shape.kind].inverse_expression
            if inverse is not None and not member.hedges:
                names = [f"number {i}" for i in range(len(shape.parameters))]
                root = _renamed(inverse, SHAPES[shape.kind].inverse_symbols, ["x", *names])
                numbers = [addresses.expression(root, names), self._floats(shape.parameters)]
                head = [*numbers, len(shape.parameters), 0, 0]
                return positions.INVERSE, head, [shape.height]
            rising = is_rising(self.plan, member)
            pieces = [self._piece(member, each, inside=False) for each in member.pieces]
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

    def places(self) -> tuple[object, ...]:
        """Return all that :meth:`write` reads of this output."""
        united = self.plan.output.aggregation == "max"
        values = self._has_values
        closed = self.defuzzifier is at.closed_centroid
        layers = (self.own, self.overlaps) if closed else None
        return self.members, self.consequents, united, values, layers

    def write(self, active: Sequence[_Rule], rows: Mapping[int, int]) -> None:
        """Append what is to be done for this output in one cell."""
        whole = self.base.whole
        groups = list(self._groups(active))
        whole.append(len(groups))
        self.heights = max(self.heights, len(groups))
        for member, rules in groups:
            whole += [len(rules), self.consequents[member]]
            for rule in rules:
                whole += self.base.record(rule, rows)
        if self.defuzzifier is at.closed_centroid:
            members = tuple(member for member, _ in groups)
            if members not in self.terms:
                self.terms[members] = self._terms(members)
            whole += self.terms[members]

    def _groups(self, active: Sequence[_Rule]) -> Iterator[tuple[int, list[_Rule]]]:
        entries = [(m, rule) for rule in active for m in self.members.get(rule.number, ())]
        if self.plan.output.aggregation == "max" or self._has_values:
            grouped: dict[int, list[_Rule]] = {}
            for member, rule in entries:
                grouped.setdefault(member, []).append(rule)
            # In the order of the sets, whatever the cell: exported programs add them up so, too.
            yield from sorted(grouped.items())
        else:
            for member, rule in entries:
                yield member, [rule]

    @property
    def _has_values(self) -> bool:
        """Whether the strengths of a value are folded, whatever the aggregation."""
        return self.defuzzifier in {at.weighted, reduced.karnik_mendel_values, *FOUND_VALUES}

    def _terms(self, members: Sequence[int]) -> list[int]:
        """Return unions of heights and terms of the closed form, where these sets may fire."""
        terms = [(g, g, self.own[member]) for g, member in enumerate(members)]
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
        found = [len(unions)]
        for union in unions:
            found += [len(union), *union]
        found.append(sum(count for _, _, (count, _) in terms))
        for own, other, (count, floats) in terms:
            for layer in range(floats, floats + at.LAYER * count, at.LAYER):
                found += (own, other, layer)
        return found


def way_of(plan: OutputPlan) -> int:
    """Return which of several positions an output wants."""
    way = plan.output.defuzzifier
    nearest = way.method == "bisector" and way.sampling == "midpoints" and not plan.discrete
    if nearest and way.resolution is not None:
        return positions.NEAREST_HALF
    return WAYS[way.method]


def _renamed(root: Node, names: Sequence[str], others: Sequence[str]) -> Node:
    """Return an expression with other names for its symbols."""
    return replace(root, dict(zip(names, map(symbol, others), strict=True)))


def _defuzzifier(plan: OutputPlan, *, loose: bool = False) -> Callable[[Any], None]:
    has_form = plan.closed is not None and not loose
    way = plan.output.defuzzifier
    if way.method in TYPE_2 and plan.members and not has_form:
        return _type_reduction(plan)
    if plan.discrete:
        return _of_values(plan)
    if way.resolution is not None:
        return _of_samples(plan)
    if way.method in MAXIMA:
        return positions.exact_maxima
    return _of_areas(plan, loose=loose)


def _of_samples(plan: OutputPlan) -> Callable[[Any], None]:
    """Return what makes a number of samples."""
    way = plan.output.defuzzifier
    if way.joined:
        return positions.joined_samples
    centroid = way.method in CENTROIDS
    return enveloped.sampled_centroid if centroid else positions.sampled_position


def _of_areas(plan: OutputPlan, *, loose: bool) -> Callable[[Any], None]:
    """Return what makes a number of the area of a set."""
    if plan.output.defuzzifier.method == "bisector" and plan.members:
        return integrated.integrated_bisector
    # A loose one takes any form that numbers can have, where there are numbers.
    in_general = loose and plan.members and has_envelope(plan.output, plan.members)
    if not in_general and (plan.closed is not None or not plan.members):
        return at.closed_centroid
    lines = in_general or plan.enveloped
    return enveloped.enveloped_centroid if lines else integrated.integrated_centroid


def _of_values(plan: OutputPlan) -> Callable[[Any], None]:
    """Return what makes a number of values, or of sets that stand for one each."""
    if plan.output.defuzzifier.method not in CENTROIDS | WEIGHTED:
        return positions.position_of_values
    is_found = plan.output.defuzzifier.method == "tsukamoto" or any(
        member.formula is not None for member in plan.members
    )
    return positions.weighted_values if is_found else at.weighted


def _type_reduction(plan: OutputPlan) -> Callable[[Any], None]:
    """Return what reduces an interval type-2 set; of one with a closed form it is the centroid."""
    ends = plan.output.defuzzifier.method in KARNIK_MENDEL
    if plan.discrete:
        return reduced.karnik_mendel_values if ends else at.weighted
    if plan.output.defuzzifier.resolution is not None:
        return reduced.karnik_mendel_samples if ends else reduced.nie_tan_samples
    if has_envelope(plan.output, plan.members):
        return reduced.karnik_mendel_envelope if ends else reduced.nie_tan_envelope
    return reduced.karnik_mendel_integral if ends else reduced.nie_tan_integral


def lines_of(implication: str) -> list[tuple[float, float, float, float]]:
    """Return the lines of a cut set as (α₀, α₁, β₀, β₁): (α₀ + α₁ w) + (β₀ + β₁ w) μ."""
    at_0, at_1 = cut_lines(implication, 0.0), cut_lines(implication, 1.0)
    return [
        (alpha_0, alpha_1 - alpha_0, beta_0, beta_1 - beta_0)
        for (alpha_0, beta_0), (alpha_1, beta_1) in zip(at_0 or (), at_1 or (), strict=True)
    ]


def _check_output(plan: OutputPlan, inputs: Sequence[str]) -> None:
    output: Output = plan.output
    method = output.defuzzifier.method
    defuzzifier = _defuzzifier(plan)
    if plan.discrete:
        for member in plan.members:
            _check_value(plan, member, inputs)
        return
    if output.defuzzifier.joined and method not in JOINED:
        raise NotCoveredError(f"joined samples of '{output.name}', which is a {method}")
    if defuzzifier is positions.exact_maxima and output.aggregation != "max":
        raise NotCoveredError(
            f"the exact {method} of '{output.name}' under aggregation {output.aggregation}"
        )
    if defuzzifier in INTEGRATED:
        for member in plan.members:
            if TNORMS[member.implication].own:
                what = f"implication {member.implication}"
                raise NotCoveredError(f"the exact {method} of '{output.name}' under {what}")


def _check_value(plan: OutputPlan, member: Member, inputs: Sequence[str]) -> None:
    """Refuse a value that is not found from inputs alone, or a set that has no one position."""
    what = f"'{plan.output.name} is {member.term.name}'"
    if member.value is not None:
        return
    if member.formula is not None and not member.pieces:
        outside = {*member.formula.names} - {*inputs} - CONSTANTS.keys()
        if outside:
            raise NotCoveredError(f"{what} is a formula of '{min(outside)}'")
    elif member.pieces:
        inverse = SHAPES[member.term.shape.kind].inverse_expression
        if inverse is None or member.hedges:
            if inverse is None and SHAPES[member.term.shape.kind].inverse is not None:
                raise NotCoveredError(f"{what}, whose inverse is plain Python")
            try:
                is_rising(plan, member)
            except InferenceError as error:
                raise NotCoveredError(str(error)) from None
