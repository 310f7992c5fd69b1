"""An output of a rule base over its inputs: a line, or cells of a plane.

A figure, the terminal and a page draw the same :class:`Response`, each at its own points.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.terms import visible_range
from fuzzyarm.base.picture import Axis, Cells, ChartPart, Dots, Level, Line, Panel
from fuzzyarm.language.model.rulebase import Output, RuleBase, Variable

if TYPE_CHECKING:
    from fuzzyarm.proof.map import Verdict


@dataclass(frozen=True)
class Failure:
    """A visible point that violates a property.

    Attributes
    ----------
    point : tuple of float
        The varied inputs, in the order of the rule base.
    height : float
        The output there.
    number : int
        Number of the property, from 1.
    """

    point: tuple[float, ...]
    height: float
    number: int


class Response:
    """One output of a rule base over one or two of its inputs.

    Parameters
    ----------
    rulebase : RuleBase
        Rule base with the output.
    output : Output
        The output to draw.
    at : mapping of str to float
        Values of inputs, fixed or marked.
    fails : sequence of Verdict
        Refuted properties, of any output.
    free : sequence of str
        The varied inputs, the vertical one first; by default the first two outside `at`.

    Attributes
    ----------
    free : list of Variable
        The varied inputs: one horizontal, or one vertical and one horizontal.
    fixed : dict of str to float
        The values of the others.
    fails : list of Verdict
        The refuted properties of this output.
    """

    def __init__(
        self,
        rulebase: RuleBase,
        output: Output,
        at: Mapping[str, float],
        fails: Sequence[Verdict] = (),
        free: Sequence[str] = (),
    ) -> None:
        from fuzzyarm.inference.plan import part_for

        self.part = part_for(rulebase, [output.name])
        inputs = self.part.inputs or rulebase.inputs
        self.rulebase, self.output = rulebase, output
        self.fails = [
            verdict for verdict in fails if verdict.output == output.name and verdict.points
        ]
        hidden = [variable.name for variable in inputs[2:]]
        if self.fails and hidden and not at:  # the slice of the first counterexample
            at = {name: self.fails[0].points[0][name] for name in hidden}
        self.at = {
            input_variable.name: at[input_variable.name]
            for input_variable in inputs
            if input_variable.name in at
        }
        self.free, self.fixed = _free_and_fixed(inputs, self.at)
        if free:
            self.free = [rulebase.variable(name) for name in free]
            self.fixed = {name: x for name, x in self.at.items() if name not in free}

    @property
    def is_line(self) -> bool:
        """Whether one input varies."""
        return len(self.free) == 1

    def values(self, points: Sequence[Any]) -> Any:
        """Return the output over the points of each varied input, NaN if no rule fires."""
        import numpy as np

        names = [variable.name for variable in self.free]
        inputs = {**self.fixed, **dict(zip(names, np.ix_(*points), strict=True))}
        values = with_gaps(self.rulebase, self.output, inputs)
        return np.broadcast_to(values, [len(x) for x in points])

    def panel(self, points: Sequence[Any]) -> Panel:
        """Return the picture: a line or cells, the marked point, and violations.

        Parameters
        ----------
        points : sequence of ndarray
            Samples of each varied input, in increasing order.
        """
        values = self.values(points)
        output = self.output
        target = Axis(output.name, "", output.low, output.high, about=output.description)
        *up, across = (Axis(v.name, "", *visible_range(v), about=v.description) for v in self.free)
        failures = self.failures()
        marks = [self.at[v.name] for v in self.free if v.name in self.at]
        title = ", ".join(f"{name} = {number_words(x, 4)}" for name, x in self.fixed.items())
        parts: list[ChartPart]
        if self.is_line:
            parts = [Line(points[0], values, "first", 1.8)]
            parts += [Level(x, upright=True) for x in marks]
            parts.append(Dots([f.point[0] for f in failures], [f.height for f in failures], "X"))
            return Panel(parts, across, target, title)
        parts = [Cells(points[1], points[0], values, target)]
        if len(marks) == 2:
            parts.append(Dots([marks[1]], [marks[0]], "o"))
        parts.append(Dots([f.point[1] for f in failures], [f.point[0] for f in failures], "X"))
        return Panel(parts, across, up[0], title)

    def failures(self) -> list[Failure]:
        """Return the visible violations of properties."""
        import numpy as np

        names = [variable.name for variable in self.free]
        failures = []
        every = [(point, k) for k, verdict in enumerate(self.fails, 1) for point in verdict.points]
        for point, number in every:
            if any(point[name] != x for name, x in self.fixed.items()):
                continue
            inputs = {name: np.array([point[name]]) for name in (*names, *self.fixed)}
            value = float(np.ravel(with_gaps(self.rulebase, self.output, inputs))[0])
            height = value if math.isfinite(value) else self.output.low
            failures.append(Failure(tuple(point[name] for name in names), height, number))
        return failures


def with_gaps(rulebase: RuleBase, output: Output, inputs: Mapping[str, Any]) -> Any:
    """Return the inference, NaN if no rule fires and the file states no value."""
    from fuzzyarm.inference import infer

    if not isinstance(output.no_rule, str):
        return infer(rulebase, inputs, outputs=[output.name])[output.name]
    gaps = tuple(replace(o, no_rule=math.nan) if o is output else o for o in rulebase.outputs)
    last_values = {o.name: 0.5 * (o.low + o.high) for o in gaps if o.no_rule == "hold"}
    model = replace(rulebase, outputs=gaps)
    return infer(model, inputs, held=last_values, outputs=[output.name])[output.name]


def _free_and_fixed(
    inputs: Sequence[Variable], at: Mapping[str, float]
) -> tuple[list[Variable], dict[str, float]]:
    if len(inputs) <= 2:
        return list(inputs), {}
    free = [variable for variable in inputs if variable.name not in at][:2]
    for variable in inputs:  # `at` has all: the first two vary nevertheless
        if len(free) < 2 and variable not in free:
            free.append(variable)
    free.sort(key=inputs.index)
    fixed = {}
    for variable in inputs:
        if variable not in free:
            low, high = visible_range(variable)
            fixed[variable.name] = at.get(variable.name, 0.5 * (low + high))
    return free, fixed
