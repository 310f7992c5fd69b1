"""One output as numbers, for a caller with its own strengths: exported programs.

No inputs, no rules: after the head and the output come the groups; the caller fills in their
heights.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from fuzzyarm.inference import block as at
from fuzzyarm.inference import type_reduction_kernel
from fuzzyarm.inference.block import NotCoveredError, TermNumbers
from fuzzyarm.inference.output_layout import (
    LaidRule,
    OutputWriter,
    post_processing,
    requested_number,
)
from fuzzyarm.inference.plan import OutputPlan, Plan
from fuzzyarm.inference.programs import (
    CHOICE_OF_ROWS,
    ENDS_OF_ROWS,
    DefuzzifierProgram,
    demand_covered,
    program_of,
)
from fuzzyarm.inference.row_functions import Addresses
from fuzzyarm.symbolic.kinds import TNORMS

if TYPE_CHECKING:
    from fuzzyarm.inference.maxima import SearchedMaxima


class OutputLayout(NamedTuple):
    """The numbers of one output, for a defuzzifier with given strengths."""

    # Numbers of the defuzzifier. After the head and the output come the groups, without rules.
    whole: list[int]
    floats: list[float]
    program: DefuzzifierProgram
    # Indices by group: of its members where strengths are folded, else of its contributions.
    groups: tuple[int, ...]
    # Rows of scratch filled by the caller: a strength for each group, unless the program differs.
    rows: int
    samples: int  # half of the work floats after these rows and the work rows


def lay_out_output(plan: Plan, name: str, addresses: Addresses) -> OutputLayout:
    """Write the tables of one output, for a caller with its own strengths.

    Under ``max`` its rules are folded by the caller, else every rule is a group. NotCoveredError if
    the kernel has no defuzzifier for it.
    """
    return _OneOutput(plan, plan.outputs[name], addresses).output_layout()


class _OneOutput:
    """The base of an output alone: no inputs, no rules."""

    def __init__(self, plan: Plan, output: OutputPlan, addresses: Addresses) -> None:
        self.plan, self.output, self.addresses = plan, output, addresses
        self.editable, self.point_only = "", False
        self.marks: list[TermNumbers] = []
        self.searches: list[SearchedMaxima] = []
        self.rules: Sequence[LaidRule] = ()
        self.operands = 0
        self.whole = [0] * (at.HEAD + at.OUTPUT_HEAD)
        self.floats: list[float] = []
        if not output.discrete:
            demand_covered(output, ())
            _demand_known_implications(output)

    def record(self, rule: LaidRule, rows: Mapping[int, int]) -> list[int]:
        """Raise an error: there are no rules."""
        raise NotImplementedError

    def output_layout(self) -> OutputLayout:
        output = self.output
        if output.discrete:
            return self._of_numbers()
        writer = OutputWriter(self, output, at.HEAD)
        united = output.output.aggregation == "max"
        members = (
            sorted({member for member, _ in output.contributions})
            if united
            else [member for member, _ in output.contributions]
        )
        groups = members if united else list(range(len(output.contributions)))
        self._finish(len(groups), [writer.consequents[member] for member in members], len(groups))
        return OutputLayout(
            self.whole, self.floats, writer.program, tuple(groups), len(groups), writer.samples
        )

    def _of_numbers(self) -> OutputLayout:
        """Write the head of a choice among numbers, or of the ends of an average."""
        if self.output.record.of == "ends":
            program, count = ENDS_OF_ROWS, len(self.output.pairs)
            rows = heap = type_reduction_kernel.PAIR_ROWS * count
            groups = tuple(member for pair in self.output.pairs for member in pair)
        else:
            program = CHOICE_OF_ROWS
            groups = tuple(sorted({member for member, _ in self.output.contributions}))
            count = len(groups)
            rows = heap = 2 * count
        self.floats += [0.0, 0.0, 0.0, requested_number(self.output)]
        self.whole[at.HEAD + at.DETAIL] = count
        self.whole[at.HEAD + at.CHOICE] = post_processing(self.output, self.addresses)[1]
        self._finish(count, [0] * count, rows)
        samples = (heap + at.CHOICE_ROOM + 1) // 2
        return OutputLayout(self.whole, self.floats, program, groups, rows, samples)

    def _finish(self, groups: int, consequents: Sequence[int], rows: int) -> None:
        whole = self.whole
        whole[at.WIDTH], whole[at.OUTPUT], whole[at.WORK] = 1, at.HEAD, rows
        whole[at.GROUPS] = len(whole)
        whole.append(groups)
        for consequent in consequents:
            whole += [0, consequent]
        # A language may evaluate an operand before its condition: the index stays inside.
        self.floats += [0.0, 0.0]


def _demand_known_implications(plan: OutputPlan) -> None:
    """Refuse exact integrals under a user's implication: a program may lack its norms."""
    if program_of(plan).takes_long:
        for member in plan.members:
            if TNORMS[member.implication].own:
                what = f"{plan.record.name} of '{plan.output.name}'"
                raise NotCoveredError(f"the exact {what} under implication {member.implication}")
