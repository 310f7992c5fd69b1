"""A rule base as the numbers that the kernel reads: its picture is in :mod:`.block`.

The writer goes through a plan once: inputs are cut into cells, each combination of cells becomes a
program with the rules that can fire in it, and every output adds the tables of its defuzzifier.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from fuzzyarm.inference import block as at
from fuzzyarm.inference.block import Layout, NotCoveredError, TermNumbers
from fuzzyarm.inference.cells import InputCells, cut_into_cells
from fuzzyarm.inference.output_layout import LaidRule, OutputWriter
from fuzzyarm.inference.plan import Plan, PlannedRule
from fuzzyarm.inference.plan import plan as plan_of
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.inference.programs import RUN, demand_covered
from fuzzyarm.inference.row_functions import (
    Addresses,
    Curve,
    InMemory,
    asserted_degree,
    degree_above_one,
    norm_number,
    weighed_strength,
)
from fuzzyarm.inference.stages import stages
from fuzzyarm.language.model.rulebase import And, Expression, Hedge, Hedged, Is, Or, RuleBase
from fuzzyarm.language.model.shapes import apply_hedges, straight_lines
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS, Norm

if TYPE_CHECKING:
    from fuzzyarm.inference.maxima import SearchedMaxima

MOST_PROGRAMS = 65_536
MOST_ENTRIES = 400_000
"""Programs, and rules in all programs together; beyond, inputs are left out of the index."""

Proposition = tuple[str, str, tuple[Hedge, ...]]
"""Variable, term and hedges."""


# ── the writer ───────────────────────────────────────────────────────────────────────


class _Truth(NamedTuple):
    """An expression in parentheses, numbered below 0; propositions are numbered from 0."""

    number: int
    norm: int
    operands: tuple[int, ...]
    hedges: int


class _NumberedRules(NamedTuple):
    """Rules of a plan, the numbers of their propositions, and the numbered rules."""

    planned: tuple[PlannedRule, ...]
    numbers: dict[Proposition, int]
    rules: list[LaidRule]


_last_numbered: list[_NumberedRules] = []
"""Those of the last few plans, the newest first."""


def lay_out(
    plan: Plan,
    *,
    compiled: bool = False,
    addresses: Addresses | None = None,
    editable: str = "",
    point_only: bool = False,
    plain: bool = False,
) -> Layout:
    """Write a plan as numbers; NotCoveredError if the kernel cannot evaluate it.

    `compiled` kernels have other addresses of row functions; `addresses` are by default those in
    this process. The terms of the variable `editable` keep numbers of their own, which can be
    changed in place: an input without cells, an output without closed forms; evaluation is slower,
    and last bits differ. A layout for one point only has 0 as addresses of built-in functions. A
    `plain` one is for the interpreted kernel: it may contain plain Python (a user's inverse, a
    search for exact maxima).
    """
    addresses = addresses or InMemory(compiled)
    return _Writer(plan, addresses, editable=editable, point_only=point_only, plain=plain).layout()


@remembered
def uncovered_feature(rulebase: RuleBase) -> str:
    """Return why the kernel cannot evaluate a rule base; empty if it can."""
    try:
        for stage in stages(rulebase):
            lay_out(plan_of(stage), compiled=False)
    except NotCoveredError as error:
        return str(error)
    return ""


_programs: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {}
"""Programs by their content, with the number of heights of each output."""

MOST_CACHED, LARGEST_CACHED = 16, 50_000
"""Number of programs before the cache is cleared, and the largest size of one."""


class _Writer:
    def __init__(
        self, plan: Plan, addresses: Addresses, *, editable: str, point_only: bool, plain: bool
    ) -> None:
        if not plan.rulebase.inputs or not plan.rulebase.outputs:
            raise NotCoveredError("a rule base without inputs or outputs")
        self.plan = plan
        self.searches: list[SearchedMaxima] = []
        self.addresses = addresses
        self.editable = editable
        self.point_only = point_only
        self.marks: list[TermNumbers] = []
        self._number_rules()
        for name, output in plan.outputs.items():
            if name in {key[0] for key in self.numbers}:
                raise NotCoveredError(f"'{name}' is used by later rules")
            inputs = [variable.name for variable in plan.rulebase.inputs]
            demand_covered(output, inputs, plain=plain)
        self._cut_inputs()
        self.whole: list[int] = []
        self.floats: list[float] = []

    def _number_rules(self) -> None:
        """Assign numbers to propositions; rules of the last plan, as in tuning, keep theirs."""
        self.numbers: dict[Proposition, int] = {}
        self.truths: dict[tuple[Expression, str, str], _Truth] = {}  # inner ones first
        for numbered in _last_numbered:
            if numbered.planned is self.plan.rules:
                self.numbers, self.rules = numbered.numbers, numbered.rules
                return
        self.rules = [self._rule(i, planned) for i, planned in enumerate(self.plan.rules)]
        # Norms and hedges by address belong to one process, or to the text of one export.
        if not self.truths and all(rule.norm in at.BUILT_IN for rule in self.rules):
            numbering = _NumberedRules(self.plan.rules, self.numbers, self.rules)
            _last_numbered[:] = [numbering, *_last_numbered[:3]]

    def _rule(self, index: int, planned: PlannedRule) -> LaidRule:
        antecedent = planned.rule.antecedent
        norm, operands = self._joined(antecedent, planned)
        conjunction = not isinstance(antecedent, Or)
        return LaidRule(index, norm, conjunction, operands, planned.rule.weight, planned.threshold)

    def _joined(self, expression: Expression, planned: PlannedRule) -> tuple[int, tuple[int, ...]]:
        """Return the norm of an expression, and the numbers of its operands."""
        if not isinstance(expression, And | Or):
            return at.MIN, (self._number(expression, planned),)
        conjunction = isinstance(expression, And)
        sort, norms = ("T", TNORMS) if conjunction else ("S", SNORMS)
        record = norms[planned.conjunction if conjunction else planned.disjunction]
        operands = tuple(self._number(operand, planned) for operand in expression.operands)
        return self.norm(record, sort), operands

    def norm(self, norm: Norm, sort: str) -> int:
        return norm_number(norm, sort, self.addresses)

    def _number(self, expression: Expression, planned: PlannedRule) -> int:
        if isinstance(expression, Is):
            if expression.variable in planned.degrees:
                return self._activation(expression)
            proposition = (expression.variable, expression.term, expression.hedges)
            return self.numbers.setdefault(proposition, len(self.numbers))
        key = (expression, planned.conjunction, planned.disjunction)
        if key not in self.truths:
            hedges = 0
            if isinstance(expression, Hedged):
                if planned.disjunction == "sum" and _lacks_values(expression.hedges):
                    hedges = self.addresses.expression(degree_above_one(expression.hedges), ())
                else:
                    hedges = self.addresses.hedged(expression.hedges)
                expression = expression.operand
            norm, operands = self._joined(expression, planned)
            self.truths[key] = _Truth(-1 - len(self.truths), norm, operands, hedges)
        return self.truths[key].number

    def _activation(self, part: Is) -> int:
        """Return the number of the assertion of a term: strengths folded like those of a set."""
        key = (part, "", "")
        if key not in self.truths:
            output = self.plan.outputs[part.variable]
            terms = {i for i, member in enumerate(output.members) if member.term.name == part.term}
            rules = [rule for member, rule in output.contributions if member in terms]
            strengths = tuple(self._strength(rule) for rule in rules)
            norm = self.norm(SNORMS[output.output.aggregation], "S")
            hedges = self.addresses.expression(asserted_degree(part.hedges), ())
            self.truths[key] = _Truth(-1 - len(self.truths), norm, strengths, hedges)
        return self.truths[key].number

    def _strength(self, index: int) -> int:
        """Return the number of the strength of a rule."""
        planned = self.plan.rules[index]
        rule = planned.rule
        key = (rule.antecedent, f"rule {index}", "")
        if key not in self.truths:
            norm, operands = self._joined(rule.antecedent, planned)
            weighs = rule.weight != 1.0 or planned.threshold > 0.0
            weighing = weighed_strength(rule.weight, planned.threshold)
            address = self.addresses.expression(weighing, ()) if weighs else 0
            # A single operand has no expression.
            operands = operands * 2 if len(operands) == 1 and norm == at.MIN else operands
            self.truths[key] = _Truth(-1 - len(self.truths), norm, operands, address)
        return self.truths[key].number

    # ── inputs ───────────────────────────────────────────────────────────────────────

    def _cut_inputs(self) -> None:
        """Cut the inputs into cells; not all of them if that makes too many programs."""
        inputs = self.plan.rulebase.inputs
        uncut = {self.editable}
        while True:
            self._cut(uncut)
            self.nonzero_cells = [_nonzero_cells(cells) for cells in self.cells]
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
        """Cut the inputs into cells; row functions compute all degrees of those in `uncut`."""
        self.alive: dict[int, list[Sequence[int]]] = {}
        self.cells: list[InputCells] = []
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
        rules = sum(math.prod(map(len, alive)) for alive in map(self._firing_cells, self.rules))
        return rules + programs * len(self.truths)

    def _firing_cells(self, rule: LaidRule) -> list[Sequence[int]]:
        """Return for each input the cells in which a rule can fire."""
        if rule.number in self.alive:
            return self.alive[rule.number]
        alive: list[Sequence[int]] = []
        for cells, nonzero in zip(self.cells, self.nonzero_cells, strict=True):
            parts = rule.parts if rule.conjunction else ()
            cells_of_parts = [nonzero[part] for part in parts if part in nonzero]
            if len(cells_of_parts) < 2:
                alive.append(cells_of_parts[0] if cells_of_parts else range(len(cells.lines)))
            else:
                alive.append(sorted(set(cells_of_parts[0]).intersection(*cells_of_parts[1:])))
        self.alive[rule.number] = alive
        return alive

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
        self.truth_rows = {truth.number: row + i for i, truth in enumerate(self.truths.values())}
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
            OutputWriter(self, output, heads + at.OUTPUT_HEAD * o)
            for o, output in enumerate(outputs)
        ]
        programs = len(self.whole)
        self._write_programs(writers, strides, stride)
        # After the programs: the number of buckets depends on the numbers, not on the form.
        for i, cells in enumerate(self.cells):
            self.whole[at.HEAD + at.INPUT_HEAD * i + at.STARTS_AT] = len(self.whole)
            self.whole += cells.starts
        work = row + max([writer.heights for writer in writers], default=0)
        samples = max([writer.samples for writer in writers], default=0)
        self.whole[: at.POINTS] = [
            inputs, len(outputs), self.operands, row, work, programs, heads, stride, samples,
        ]  # fmt: skip
        self.whole[at.RUN] = 0 if self.point_only else self.addresses.program(RUN)
        rows = work + at.WORK_ROWS
        searches = tuple(self.searches)
        return Layout(self.whole, self.floats, stride, rows, samples, tuple(self.marks), searches)

    def _write_programs(
        self, writers: Sequence[OutputWriter], strides: Sequence[int], count: int
    ) -> None:
        """Write the programs, or reuse those of a layout with the same form.

        They are nearly all of the work, and contain only indices: they are equal if the same terms
        meet in the same cells, with their numbers at the same indices. So a rule base with slightly
        moved terms, as in tuning, costs a fraction.
        """
        first = len(self.whole)
        indices = (first, count, self.operands, self.rule_floats[:1], self.lines)
        rules = [rule[:4] for rule in self.rules]
        key = repr(
            (
                indices,
                rules,
                self.rows,
                self.truths,
                [writer.indices() for writer in writers],
            )
        )
        earlier = _programs.get(key)
        if earlier is None:
            self._write_each_program(writers, strides, count)
            if len(self.whole) - first <= LARGEST_CACHED:
                if len(_programs) >= MOST_CACHED:
                    _programs.clear()  # in one step: other threads write, too
                rows = tuple(writer.heights for writer in writers)
                _programs[key] = (tuple(self.whole[first:]), rows)
            return
        programs, rows = earlier
        self.whole += programs
        for writer, heights in zip(writers, rows, strict=True):
            writer.heights = heights

    def _write_each_program(
        self, writers: Sequence[OutputWriter], strides: Sequence[int], count: int
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

    def _write_input(self, i: int, cells: InputCells, row: int, stride: int) -> None:
        variable = self.plan.rulebase.inputs[i]
        low, high, clamped = -sys.float_info.max, sys.float_info.max, False
        if variable.outside != "extend":
            low, high = variable.low, variable.high
            clamped = variable.outside == "clamp"
        self.floats[at.RANGE * i : at.RANGE * (i + 1)] = [low, high, cells.first, cells.scale]
        edges = len(self.floats)
        # An infinite value lies in no cell, though its lines have degrees there: other engines
        # serve it.
        self.floats += [-sys.float_info.max, *cells.edges[1:]]
        listed = [sorted(lines) for lines in cells.lines]
        most = max(map(len, listed))
        lines_of_cells: list[tuple[int, int]] = []
        for parts_here, lines in zip(listed, cells.lines, strict=True):
            lines_of_cells.append((len(self.floats), len(parts_here)))
            for part in parts_here:
                self.floats += lines[part]
        self.lines.append(lines_of_cells)
        curves = len(self.whole)
        terms = {number: (term, hedges) for (_, term, hedges), number in self.numbers.items()}
        for j, (number, curve) in enumerate(self.curves[i]):
            begin, (term, hedges) = len(self.floats), terms[number]
            self.whole += [curve.address, begin, len(curve.numbers)]
            self.floats += curve.numbers
            if variable.name == self.editable and not hedges:
                mark = ("curve", variable.name, term, row + most + j, begin, len(curve.numbers))
                self.marks.append(TermNumbers(*mark))
        always = {part: row + most + j for j, (part, _) in enumerate(self.curves[i])}
        self.rows.append(
            [{part: row + j for j, part in enumerate(parts_here)} | always for parts_here in listed]
        )
        head = at.HEAD + at.INPUT_HEAD * i
        self.whole[head : head + at.INPUT_HEAD] = [
            int(clamped), len(cells.starts), 0, edges, stride, row, most, len(always), curves, 0,
        ]  # fmt: skip

    def _active(self, strides: Sequence[int], programs: int) -> list[list[LaidRule]]:
        active: list[list[LaidRule]] = [[] for _ in range(programs)]
        for rule in self.rules:
            numbers = [0]
            for cells, step in zip(self._firing_cells(rule), strides, strict=True):
                numbers = [number + c * step for number in numbers for c in cells]
            for number in numbers:
                active[number].append(rule)
        return active

    def _write_truths(self, rows: Mapping[int, int]) -> None:
        self.whole.append(len(self.truths))
        for number, norm, operands, hedges in self.truths.values():
            self.whole += [self.truth_rows[number], norm, hedges, len(operands)]
            self.whole += [rows.get(part, self.zero) for part in operands]

    def record(self, rule: LaidRule, rows: Mapping[int, int]) -> list[int]:
        """Return [norm, weight, operands …] of a rule; the row of zeros for a zero term."""
        zero = self.zero
        record = [rule.norm, self.rule_floats[rule.number]]
        record += [rows.get(part, zero) for part in rule.parts]
        missing = self.operands - len(rule.parts)
        if missing:
            by_address = rule.norm not in at.BUILT_IN  # such a norm skips a row of ones
            neutral = self.one if rule.conjunction or by_address else zero
            if rule.norm == at.MIN and max(rule.parts) < 0:  # a sum in parentheses may exceed 1
                neutral = record[-1]
            record += [neutral] * missing
        return record


def _lacks_values(hedges: tuple[Hedge, ...]) -> bool:
    """Whether hedges are undefined for a sum of degrees above 1."""
    return any(math.isnan(apply_hedges(hedges, 1.0 + i / 8)) for i in range(1, 17))


def _nonzero_cells(cells: InputCells) -> dict[int, list[int]]:
    """Return the nonzero cells of each straight proposition."""
    nonzero: dict[int, list[int]] = {}
    for cell, lines in enumerate(cells.lines):
        for part in lines:
            nonzero.setdefault(part, []).append(cell)
    return nonzero
