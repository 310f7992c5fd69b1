"""The kernels over a block: its evaluators, and the defuzzifiers, numbered by a layout.

A defuzzifier of the kernel is a record, :class:`DefuzzifierProgram`: its function at one point, its
inputs and its results. It is selected by the aspect of the aggregate that a record of
:mod:`fuzzyarm.symbolic.defuzzifiers` requests, and by the form of that aggregate (numbers, samples,
straight lines, panels of curves).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any, Literal, NamedTuple

from fuzzyarm.inference import kernel
from fuzzyarm.inference.block import NotCoveredError
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.plan import Member, OutputPlan, has_envelope
from fuzzyarm.inference.weighted import is_rising
from fuzzyarm.symbolic.kinds import SHAPES


class DefuzzifierProgram(NamedTuple):
    """A defuzzifier of the kernel."""

    where: str  # module and name of its function, imported on first use
    # Its tables in a layout: a method of :class:`fuzzyarm.inference.output_layout.OutputWriter`.
    reads: str
    # Centre of its moment: ``zero``, the ``middle`` of the range, or one of its tables (``own``).
    # Empty: it gives the value itself.
    centre: Literal["", "zero", "middle", "own"] = ""
    whole: bool = False  # whether the function takes a block, and loops over its points itself

    @property
    def function(self) -> Callable[..., Any]:
        """Its function at one point: numbers of the layout and scratch in, value out.

        A total and a value, or a moment. Exported programs are printed from it.
        """
        module, _, name = self.where.rpartition(".")
        function: Callable[..., Any] = getattr(import_module(f"fuzzyarm.inference.{module}"), name)
        return function

    @property
    def name(self) -> str:
        """Its name in other languages."""
        return self.where.rpartition(".")[2]

    @property
    def block(self) -> Callable[[Any], None]:
        """The kernel over a block, in which `bindings` hold."""
        return self.function if self.whole else kernel.point_by_point

    @property
    def bindings(self) -> Mapping[str, Callable[..., Any]]:
        """See :func:`fuzzyarm.symbolic.kernels.address_of`."""
        return {} if self.whole else {"at_point": self.function}

    @property
    def takes_long(self) -> bool:
        """Whether it uses the quadrature."""
        return self.reads == "panels"


RUN = DefuzzifierProgram("kernel.run", "", whole=True)

CLOSED = DefuzzifierProgram("closed_form.closed_centroid", "layers", "own", whole=True)
WEIGHTED = DefuzzifierProgram("closed_form.weighted", "values", "zero", whole=True)
WEIGHTED_NUMBERS = DefuzzifierProgram("positions.weighted_values", "numbers", "zero", whole=True)
POSITION_OF_NUMBERS = DefuzzifierProgram("positions.position_of_values", "numbers", whole=True)
ENDS_OF_PAIRS = DefuzzifierProgram(
    "type_reduction_kernel.karnik_mendel_values", "pairs", whole=True
)

CHOICE_OF_ROWS = DefuzzifierProgram("positions.choice_of_values", "rows")
ENDS_OF_ROWS = DefuzzifierProgram("type_reduction_kernel.ends_of_values", "rows")
"""For values computed by the caller: exported programs alone have these two."""

SAMPLES = {
    "gravity": DefuzzifierProgram(
        "centroid_kernel.sampled_centroid", "samples", "zero", whole=True
    ),
    "area": DefuzzifierProgram("positions.position_of_samples", "samples"),
    "top": DefuzzifierProgram("positions.position_of_samples", "samples"),
    "ends": DefuzzifierProgram("type_reduction_kernel.ends_of_samples", "samples"),
}
JOINED = DefuzzifierProgram("positions.position_of_joined", "samples")
LEVELS = DefuzzifierProgram("positions.position_of_maxima", "levels")
SEARCHED = DefuzzifierProgram("maxima.position_of_searched", "search")
"""Of the interpreted kernel alone: exact maxima under other aggregations than ``max``."""

LINES = {
    "gravity": DefuzzifierProgram("centroid_kernel.whole_envelope", "pieces", "zero"),
    "ends": DefuzzifierProgram("type_reduction_kernel.ends_of_envelopes", "pieces"),
}
PANELS = {
    "gravity": DefuzzifierProgram("quadrature_kernel.integral_of_point", "panels", "middle"),
    "area": DefuzzifierProgram("quadrature_kernel.bisector_of_point", "panels"),
    "ends": DefuzzifierProgram("type_reduction_kernel.ends_of_integrals", "panels"),
}
"""By the view of an aggregate (`of` of its record)."""

BOTH_SAMPLES = DefuzzifierProgram(
    "type_reduction_kernel.nie_tan_samples", "samples", "zero", whole=True
)
BOTH_LINES = DefuzzifierProgram("type_reduction_kernel.sum_of_envelopes", "pieces", "middle")
BOTH_PANELS = DefuzzifierProgram("type_reduction_kernel.sum_of_integrals", "panels", "middle")
"""Of the upper and the lower set of interval type 2 together."""

PROGRAMS = (
    RUN, CLOSED, WEIGHTED, WEIGHTED_NUMBERS, POSITION_OF_NUMBERS, ENDS_OF_PAIRS,
    SAMPLES["gravity"], SAMPLES["top"], SAMPLES["ends"], JOINED, LEVELS, *LINES.values(),
    *PANELS.values(), BOTH_SAMPLES, BOTH_LINES, BOTH_PANELS,
)  # fmt: skip
"""Programs that a layout calls by number."""

IN_ROWS = (CHOICE_OF_ROWS, ENDS_OF_ROWS)

EVALUATORS: tuple[Callable[..., Any], ...] = (kernel.evaluate, kernel.sweep)
"""Evaluators of a block, see :mod:`fuzzyarm.inference.kernel`."""


# ── the defuzzifier of an output ─────────────────────────────────────────────────────


def program_of(plan: OutputPlan, *, editable: bool = False) -> DefuzzifierProgram:
    """Return the defuzzifier of an output; for an `editable` one without a closed form."""
    record, way = plan.record, plan.output.defuzzifier
    if plan.discrete:
        return _of_numbers(plan)
    if way.joined:
        return JOINED
    if way.resolution is not None:
        return BOTH_SAMPLES if record.both else SAMPLES[record.of]
    if record.of == "top":
        return LEVELS if plan.output.aggregation == "max" else SEARCHED
    return _of_areas(plan, editable=editable)


def _of_areas(plan: OutputPlan, *, editable: bool) -> DefuzzifierProgram:
    """Return the program for the area of a set."""
    record = plan.record
    if not plan.members:
        return CLOSED
    # An editable one takes the general form.
    straight = plan.enveloped or (editable and has_envelope(plan.output, plan.members))
    if plan.closed is not None and not (editable and (straight or record.both)):
        return CLOSED
    if record.both:
        return BOTH_LINES if straight else BOTH_PANELS
    return LINES[record.of] if straight and record.of in LINES else PANELS[record.of]


def _of_numbers(plan: OutputPlan) -> DefuzzifierProgram:
    """Return the program for values, or for sets with one representative each."""
    record = plan.record
    if record.of == "ends":
        return ENDS_OF_PAIRS
    if record.of in ("top", "area"):
        return POSITION_OF_NUMBERS
    is_found = record.inverts or any(member.formula is not None for member in plan.members)
    return WEIGHTED_NUMBERS if is_found else WEIGHTED


def demand_covered(plan: OutputPlan, inputs: Sequence[str], *, plain: bool = False) -> None:
    """Refuse by name an output that the kernel (if `plain`, the interpreted one) does not cover."""
    output, what = plan.output, f"{plan.record.name} of '{plan.output.name}'"
    if plan.discrete:
        for member in plan.members:
            _demand_number(plan, member, inputs, plain=plain)
        return
    if output.defuzzifier.joined and not plan.record.joins:
        raise NotCoveredError(f"joined samples of '{output.name}', which is a {plan.record.name}")
    if program_of(plan) is SEARCHED and not plain:
        raise NotCoveredError(f"the exact {what} under aggregation {output.aggregation}")


def _demand_number(plan: OutputPlan, member: Member, inputs: Sequence[str], *, plain: bool) -> None:
    """Refuse a value that depends on more than the inputs, or a set without a unique position."""
    what = f"'{plan.output.name} is {member.term.name}'"
    if member.value is not None:
        return
    if member.formula is not None and not member.pieces:
        from fuzzyarm.symbolic.formulas import CONSTANTS

        outside = {*member.formula.names} - {*inputs} - CONSTANTS.keys()
        if outside:
            raise NotCoveredError(f"{what} is a formula of '{min(outside)}'")
    elif member.pieces:
        inverse = SHAPES[member.term.shape.kind].inverse_expression
        if inverse is None or member.hedges:
            is_plain = inverse is None and SHAPES[member.term.shape.kind].inverse is not None
            if is_plain and plain and not member.hedges:
                return
            if is_plain:
                raise NotCoveredError(f"{what}, whose inverse is plain Python")
            try:
                is_rising(plan, member)
            except InferenceError as error:
                raise NotCoveredError(str(error)) from None
