"""The centroid over samples: sums that C computes in a loop over constant arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.aggregate import positions, sampled_set, weights
from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.symbolic.evaluation import evaluate_arrays
from fuzzyarm.symbolic.identifiers import Names
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS
from fuzzyarm.symbolic.nodes import Node, replace, symbol
from fuzzyarm.symbolic.printing import Assign

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class SampleSums:
    """The sums of an output over its samples, from the first to the last.

    At each sample the aggregate is built up step by step; ``area`` is the sum of its
    values, ``moment`` the sum of its products with the positions.
    """

    # Names of the two sums, of the aggregate at a sample, and of the number of a sample. The
    # program reads the sums as symbols.
    area: str
    moment: str
    height: str
    index: str
    # Numbers for each sample, by the symbol of the current one.
    columns: Mapping[str, tuple[float, ...]]
    stems: Mapping[str, str]  # names of the arrays of the columns
    # Parts of the program, by their symbol in `steps`.
    parts: Mapping[str, Node]
    # Set `height` again and again, of itself, of columns and of parts.
    steps: tuple[Assign, ...]

    @property
    def count(self) -> int:
        """The number of samples."""
        return len(self.columns["position"])

    @property
    def body(self) -> tuple[Assign, ...]:
        """The statements at each sample."""
        height = symbol(self.height)
        weighing = (
            (Assign(self.height, height * symbol("weight")),) if "weight" in self.columns else ()
        )
        return (
            *self.steps,
            *weighing,
            Assign(self.area, symbol(self.area) + height),
            Assign(self.moment, symbol(self.moment) + height * symbol("position")),
        )

    def over_arrays(self, values: Mapping[str, Array], real: type) -> dict[str, Array]:
        """Return the sums by name over arrays that broadcast, in the order of the loop."""
        # The samples have their own axis before those of the points.
        ones = (1,) * max(map(np.ndim, values.values()))
        columns: dict[str, Array] = {
            name: np.array(column, real).reshape(-1, *ones) for name, column in self.columns.items()
        }
        in_doubles = np.dtype(real) == np.float64
        operands: dict[str, Any] = {
            name: evaluate_arrays(p, values, real, as_floats=in_doubles)
            for name, p in self.parts.items()
        }
        operands |= columns
        for step in self.body[:-2]:
            operands[self.height] = evaluate_arrays(
                step.value, operands, real, as_floats=in_doubles
            )
        height = operands[self.height]
        terms = {self.area: height, self.moment: height * columns["position"]}
        # accumulate() adds from first to last; sum() may go about it in another order.
        return {
            name: np.add.accumulate(term, axis=0, dtype=real)[-1] for name, term in terms.items()
        }


def sample_sums(
    output: OutputPlan, fired: Sequence[tuple[int, Node, str]], names: Names
) -> SampleSums:
    """Return the sums of an output whose defuzzifier is the centroid over samples.

    `fired` has a member, the strength at which it is cut, and a remark, in the order in which
    the sets are aggregated.
    """
    model, way = output.output, output.output.defuzzifier
    assert way.resolution is not None
    samples = positions(model.low, model.high, way.resolution, way.sampling)
    columns = {"position": tuple(samples)}
    column_names = {"position": f"{model.name}_samples", "weight": f"{model.name}_weights"}
    if way.sampling == "trapezoid":
        columns["weight"] = tuple(weights(way.resolution, way.sampling))
    height = names.new("height")
    parts: dict[str, Node] = {}
    steps: list[Assign] = []
    for member, strength, remark in fired:
        consequent = output.members[member]
        degree, cut = f"degree {member}", f"strength {len(parts)}"
        sampled = sampled_set(consequent.term.shape, consequent.hedges, model.low, model.high, way)
        columns[degree] = sampled.over(way.resolution)
        column_names[degree] = f"{model.name}_{consequent.term.name}"
        parts[cut] = strength
        implied = {"a": symbol(cut), "b": symbol(degree)}
        value = replace(TNORMS[consequent.implication].expression, implied)
        if steps:
            both = {"a": symbol(height), "b": value}
            value = replace(SNORMS[model.aggregation].expression, both)
        steps.append(Assign(height, value, remark))
    found_names = names.new("area"), names.new("moment"), height, names.new("k")
    return SampleSums(*found_names, columns, column_names, parts, tuple(steps))
