"""Defuzzifiers of exported programs as walks over tables, printed from those of the kernel.

Most outputs are exported as one expression (:mod:`fuzzyarm.exchange.export.program`). If that would
be long, or a loop depends on the inputs (maxima, bisectors, the ends of type-2 sets, integrals of
curves), the strengths are still expressions, and the rest is the kernel's own function for one
point, in the target language, over constant tables of this output.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference import block as at
from fuzzyarm.inference.plan import Plan
from fuzzyarm.inference.programs import DefuzzifierProgram
from fuzzyarm.inference.row_functions import (
    Curve,
    InMemory,
    corners_under,
    curved_row,
    expression_row,
    hedges_on_row,
    norm_row,
)
from fuzzyarm.inference.single_output import OutputLayout, lay_out_output
from fuzzyarm.language.model.rulebase import Hedge, Shape
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.symbolic.evaluation import evaluate_arrays
from fuzzyarm.symbolic.kernels import has_machine_code, routine
from fuzzyarm.symbolic.kinds import SHAPES, Norm
from fuzzyarm.symbolic.nodes import Node

Array = NDArray[Any]

STEPS_OF_AN_INTEGRAL = 15_000

_AT_ONCE = 4_096
"""Points evaluated together in a walk here."""


class Listed:
    """Numbers functions in the order in which they are met, after the kernel's own norms.

    Attributes
    ----------
    norms, curves : dict of int to callable
        Functions of two rows, and of one row and numbers.
    """

    compiled = False

    def __init__(self) -> None:
        self.norms: dict[int, Callable[..., None]] = {}
        self.curves: dict[int, Callable[..., None]] = {}
        self._kinds: dict[object, int] = {}

    def _number(
        self, key: object, kind: dict[int, Callable[..., None]], make: Callable[[], Any]
    ) -> int:
        if key not in self._kinds:
            self._kinds[key] = len(at.BUILT_IN) + len(self._kinds)
            kind[self._kinds[key]] = make()
        return self._kinds[key]

    def norm(self, norm: Norm, sort: str) -> int:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        return self._number((sort, norm.name), self.norms, lambda: norm_row(norm))

    def hedged(self, hedges: tuple[Hedge, ...]) -> int:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        return self._number(hedges, self.curves, lambda: hedges_on_row(hedges))

    def expression(self, root: Node, numbers: Sequence[str]) -> int:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        key = (root, tuple(numbers))
        return self._number(key, self.curves, lambda: expression_row(root, numbers))

    def curve(self, shape: Shape, hedges: tuple[Hedge, ...]) -> Curve:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        if SHAPES[shape.kind].straight:
            corners = tuple(number for corner in polyline(shape) for number in corner)
            return Curve(
                self._number(("corners", hedges), self.curves, lambda: corners_under(hedges)),
                corners,
            )
        function, numbers = curved_row(shape, hedges)
        return Curve(self._number(function, self.curves, lambda: function), numbers)

    def program(self, program: DefuzzifierProgram) -> int:
        """Nothing: the defuzzifier is called by its name."""
        return 0


@dataclass(frozen=True, eq=False)
class DefuzzifierWalk:
    """The two numbers from a defuzzifier and the strengths of an output."""

    # Names of the two: a number above 0 if a rule fires, and the value (or the moment). The program
    # reads them as symbols.
    total: str
    value: str
    plan: Plan  # of the whole rule base
    output: str
    # The rows of the scratch array, in order: strengths, and values, if any.
    parts: tuple[Node, ...]

    @cached_property
    def functions(self) -> Listed:
        """Functions numbered by the tables."""
        listed = Listed()
        vars(self)["layout"] = lay_out_output(self.plan, self.output, listed)
        return listed

    @cached_property
    def layout(self) -> OutputLayout:
        """The tables, with the numbers of :attr:`functions`."""
        self.functions  # noqa: B018  (they are numbered while the layout is written)
        output_layout: OutputLayout = vars(self)["layout"]
        return output_layout

    @property
    def function(self) -> Callable[..., Any]:
        """The kernel for one point, which is printed."""
        return self.layout.program.function

    @property
    def scratch(self) -> int:
        """How many floats a call works in."""
        return self.layout.rows + at.WORK_ROWS + 2 * self.layout.samples

    @property
    def heap(self) -> int:
        """Where in these the kernel's own begin."""
        return self.layout.rows + at.WORK_ROWS

    @property
    def steps(self) -> int:
        """Estimated number of heights of sets evaluated at one point."""
        # An export is compared at fewer points the more there are; interpreted, each takes a
        # hundred times as long.
        count = STEPS_OF_AN_INTEGRAL if self.layout.program.takes_long else self.scratch
        return count * max(1, len(self.layout.groups)) * (1 if has_machine_code() else 100)

    @property
    def flash(self) -> int:
        """How many constants there are."""
        return len(self.layout.whole) + len(self.layout.floats)

    # ── evaluated here ───────────────────────────────────────────────────────────────

    @cached_property
    def _in_memory(self) -> tuple[OutputLayout, Callable[..., None]]:
        compiled = has_machine_code()
        # The same tables once more, with addresses in this process where an export has numbers.
        layout = lay_out_output(self.plan, self.output, InMemory(compiled))
        program = layout.program
        return layout, routine(program.block, 1, program.bindings, compiled=compiled)

    def over_arrays(self, values: Mapping[str, Array], real: type) -> dict[str, Array]:
        """Return both numbers by name over arrays that broadcast."""
        rows = [evaluate_arrays(part, values, real, as_floats=True) for part in self.parts]
        shape = np.broadcast_shapes(*map(np.shape, rows), *map(np.shape, values.values()))
        flat = [np.broadcast_to(row, shape).ravel() for row in rows]
        size = int(np.prod(shape))
        total, value = np.zeros(size), np.zeros(size)
        for start in range(0, size, _AT_ONCE):
            part = slice(start, min(start + _AT_ONCE, size))
            total[part], value[part] = self._some([row[part] for row in flat], total[part].size)
        return {self.total: total.reshape(shape), self.value: value.reshape(shape)}

    def _some(self, rows: Sequence[Array], points: int) -> tuple[Array, Array]:
        # A block as in `inference.block`, without inputs: whole numbers, floats, scratch. Scratch
        # has the strengths, a row each; then total and moment among the rows to work in; then the
        # heap, for one point, since the kernel goes from point to point.
        layout, defuzzify = self._in_memory
        whole, floats = len(layout.whole), len(layout.floats)
        scratch = (layout.rows + at.WORK_ROWS) * points + 2 * layout.samples
        block = np.zeros(whole + floats + scratch)
        # One block holds all: whole numbers, each in the space of a float; the floats; and the
        # scratch in rows of one number for each point, the parts first.
        k = block.view(np.int64)
        k[:whole] = layout.whole
        k[at.POINTS] = k[at.WIDTH] = k[at.COUNT] = points
        k[at.FLOATS], k[at.SCRATCH], k[at.COLUMNS] = whole, whole + floats, block.size
        block[whole : whole + floats] = layout.floats
        for index, row in enumerate(rows):
            begin = whole + floats + index * points
            block[begin : begin + points] = row
        defuzzify(block)
        begin = whole + floats + (layout.rows + at.TOTAL) * points
        moment = begin + (at.MOMENT - at.TOTAL) * points
        return block[begin : begin + points].copy(), block[moment : moment + points].copy()
