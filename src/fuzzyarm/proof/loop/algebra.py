"""One control period over zonotopes: the arithmetic of :class:`Zonotopes`.

Lines, sources and limits of a controller are walked by
:class:`fuzzyarm.control.controllers.period.ControlPeriod`; this module defines the numbers.
Constants of the file stay floats until they meet a form, so that a gain is an exact multiple.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache

import numpy as np

from fuzzyarm.language.model.rulebase import RuleBase, Variable
from fuzzyarm.proof.loop.enclosure import EnclosureError, Vector
from fuzzyarm.proof.loop.period import LoopAlgebra
from fuzzyarm.proof.loop.planes import PlaneBand, RulePlanes, TablePlanes, Zonotope
from fuzzyarm.proof.loop.readings import pruned, read, readable
from fuzzyarm.proof.loop.zonotope import Forms, chosen, clip, larger, smaller, stacked
from fuzzyarm.symbolic.nodes import Constant, Node
from fuzzyarm.table import LookupTable

Number = Forms | float


class Zonotopes(LoopAlgebra[Number]):
    """The algebra of forms, shape (batch,), and floats of the file."""

    def __init__(
        self, batch: int, planes: Callable[[RuleBase, str], RulePlanes], *, by_cells: bool = False
    ) -> None:
        self.batch = batch
        self.planes = planes
        self.by_cells = by_cells
        self.count = 0

    def forms(self, x: Number) -> Forms:
        """Return a number as forms."""
        return x if isinstance(x, Forms) else Forms.at(np.full(self.batch, x))

    def fresh(self, x: Forms) -> Forms:
        """Return forms with each remainder as a new symbol."""
        if np.isnan(x.centre).any() or np.isnan(x.rest).any():
            raise EnclosureError("an enclosure is not a number")
        if not x.rest.any():
            return x
        self.count += 1
        return x.with_symbols(self.count, [self.count - 1])

    def number(self, value: float) -> Number:
        """Return a number of the file."""
        return float(value)

    def _both(self, a: Number, b: Number) -> tuple[Forms, Number]:
        if isinstance(a, Forms):
            return a, b
        return self.forms(a), b if isinstance(b, Forms) else self.forms(b)

    def add(self, a: Number, b: Number) -> Number:
        """Return a sum."""
        if not isinstance(a, Forms) and isinstance(b, Forms):
            a, b = b, a
        first, second = self._both(a, b)
        return first + second

    def subtract(self, a: Number, b: Number) -> Number:
        """Return a difference; 0 of a number and itself."""
        return 0.0 if a is b else self.add(a, -b)

    def multiply(self, a: Number, b: Number) -> Number:
        """Return a product."""
        if not isinstance(a, Forms) and isinstance(b, Forms):
            a, b = b, a
        first, second = self._both(a, b)
        return first * second

    def divide(self, a: Number, b: Number) -> Number:
        """Return a quotient."""
        if isinstance(a, float) and a == 0.0 and isinstance(b, float) and b != 0.0:
            return 0.0
        first, second = self._both(a, b)
        return first / second

    def limit(self, x: Number, low: float, high: float) -> Number:
        """Return ``min(max(x, low), high)``."""
        forms = self.forms(x)
        bounds = forms.bounds
        if (bounds.low >= low).all() and (bounds.high <= high).all():
            return x
        return self.fresh(clip(forms, low, high))

    def excess(self, value: Number, x: Number, low: float, high: float) -> Number:
        """Return the change of x by a limit: exactly 0 for boxes within it."""
        moved = self.subtract(value, x)
        if not isinstance(moved, Forms):
            return moved
        bounds = self.forms(x).bounds
        inside = (bounds.low >= low) & (bounds.high <= high)
        return chosen(inside, Forms.at(np.zeros(self.batch)), moved)

    def rate_limited(self, x: Number, before: Number, most: float) -> Number:
        """Return ``min(max(x, before - most), before + most)``."""
        forms, last = self.forms(x), self.forms(before)
        # `most` is a rounded product of floats in the loop: widened by a neighbour each way.
        size = Forms.between(
            np.full(self.batch, math.nextafter(most, 0.0)),
            np.full(self.batch, math.nextafter(most, math.inf)),
        )
        return self.fresh(smaller(larger(forms, last - size), last + size))

    def expression(self, root: Node, values: Mapping[str, Number]) -> Number:
        """Return the value of an expression."""
        numbers = {name: x for name, x in values.items() if not isinstance(x, Forms)}
        forms_by_name = {name: x for name, x in values.items() if isinstance(x, Forms)}
        reading = _readable(root, tuple(sorted(numbers.items())))
        if isinstance(reading, Constant):
            return reading.value
        return self.fresh(read([reading], forms_by_name or {"": self.forms(0.0)})[0])

    def error(self, x: Number, size: float) -> Number:
        """Return ``x`` plus an unknown error of at most `size`."""
        return self.fresh(self.forms(x).within(size))

    def rules(self, rulebase: RuleBase, inputs: Mapping[str, Number]) -> list[Number]:
        """Return the conclusions of a rule base, output by output."""
        results: list[Number] = []
        for output in rulebase.outputs:
            planes: RulePlanes = self.planes(rulebase, output.name)
            value = self._concluded(planes, [inputs[variable.name] for variable in rulebase.inputs])
            if planes.clamps:
                value = self.fresh(clip(value, output.low, output.high))
            elif output.outside == "error" and not planes.prover.lies_between:
                _demand_inside(value, output)
            results.append(value)
        return results

    def table(self, table: LookupTable, inputs: Mapping[str, Number]) -> Number:
        """Return the value of a lookup table."""
        return self._banded(
            TablePlanes(table).band, [self.forms(inputs[name]) for name in table.names]
        )

    def _concluded(self, planes: RulePlanes, arguments: Sequence[Number]) -> Forms:
        """Return an output: by the planes of cells if known, else box by box."""
        variables = planes.prover.inputs
        grid = planes.grid if self.by_cells else None
        if grid is None:
            every = zip(arguments, variables, strict=True)
            return self._banded(planes.band, [self._inside(x, variable) for x, variable in every])
        for x, variable in zip(arguments, variables, strict=True):
            if variable.outside == "error":
                _demand_inside(self.forms(x), variable)
        inputs = stacked([self.forms(x) for x in arguments])
        symbols, rest = inputs.parts, inputs.rest
        sides = np.concatenate([symbols, np.eye(len(rest))[:, :, None] * rest])
        bands = grid.bands(inputs.centre, sides)
        if bands is None:
            every = zip(arguments, variables, strict=True)
            return self._banded(planes.band, [self._inside(x, variable) for x, variable in every])
        return self._on(inputs, bands.slopes, Forms.between(bands.low, bands.high))

    def _inside(self, x: Number, variable: Variable) -> Forms:
        forms = self.forms(x)
        if variable.outside == "extend":
            return forms
        if variable.outside == "error":
            _demand_inside(forms, variable)
            return forms
        return self.fresh(clip(forms, variable.low, variable.high))

    def _banded(self, band: Callable[[Zonotope], PlaneBand], arguments: Sequence[Forms]) -> Forms:
        """Return a value from the plane and the band of each box."""
        inputs = stacked(arguments)
        bands = [
            band(
                Zonotope(
                    inputs.centre[:, box],
                    np.column_stack([inputs.parts[:, :, box].T, np.diag(inputs.rest[:, box])]),
                )
            )
            for box in range(self.batch)
        ]
        slopes = np.array([plane.slopes for plane in bands])
        band_of = Forms.between([plane.low for plane in bands], [plane.high for plane in bands])
        return self._on(inputs, slopes, band_of)

    def _on(self, inputs: Forms, slopes: Vector, value: Forms) -> Forms:
        """Return a band around planes as forms."""
        for row in range(inputs.shape[0]):
            value = value + inputs[row].scaled(slopes[:, row])
        return self.fresh(value)


def _demand_inside(x: Forms, variable: Variable) -> None:
    """Refuse an input that may leave its range, where the rule base has no value."""
    bounds, where = x.bounds, f"outside the range of '{variable.name}', where there is no value"
    if not ((bounds.low >= variable.low) & (bounds.high <= variable.high)).all():
        raise EnclosureError(f"a run may be {where}")


@cache
def _readable(root: Node, numbers: tuple[tuple[str, float], ...]) -> Node:
    return readable(pruned(root, dict(numbers)))
