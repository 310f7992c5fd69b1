"""Tables back to rules: the grid with the nearest terms, and its error."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.numbers import evenly
from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Input,
    Is,
    Lookup,
    LookupAxis,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.table.axis import Axis, TableError
from fuzzyarm.table.table import LookupTable

SEVEN = ("NB", "NM", "NS", "ZE", "PS", "PM", "PB")
"""The usual names of seven sets around zero."""

TERMS = 13
"""Sets of the output by default."""

MOST_RULES = 100_000


@dataclass(frozen=True)
class RulesOfTable:
    """A rule base approximating a table."""

    rulebase: RuleBase  # one rule for each combination of input terms
    residual: NDArray[np.float64]  # table minus inference at the levels of the table; its shape

    @property
    def worst(self) -> float:
        """Largest magnitude of the residual."""
        return float(np.abs(self.residual).max())

    @property
    def rms(self) -> float:
        """Root mean square of the residual."""
        return float(np.sqrt(np.mean(np.square(self.residual))))


def rules_of_table(table: LookupTable, name: str = "", *, terms: int = TERMS) -> RulesOfTable:
    """Return the rules whose consequents are nearest to a table.

    Every input gets a triangle at each of its levels, each foot under its neighbour's peak, so that
    at a level one rule alone fires; the output gets evenly spaced triangles over its range. A rule
    concludes the term with the value nearest to the table there.

    Parameters
    ----------
    table : LookupTable
        With any number of inputs.
    name : str, optional
        Name of the rule base.
    terms : int, optional
        Number of output terms; 2 at least.

    Raises
    ------
    TableError
        If `terms` is out of range or there would be too many rules.
    """
    if not 2 <= terms <= 99:
        raise TableError(f"number of terms must be 2 to 99, not {terms}")
    inputs = tuple(_input(axis) for axis in table.axes)
    rules = int(np.prod([len(variable.terms) for variable in inputs]))
    if rules > MOST_RULES:
        raise TableError(f"{rules:,} rules are too many", hint=f"at most {MOST_RULES:,}")
    output = _output(table, terms)
    values = _own_values(output)
    block = RuleBlock(
        tuple(
            Rule(
                _conjunction(inputs, labels),
                (Consequent(output.name, _nearest(values, target)),),
                in_grid=True,
            )
            for labels, target in zip(
                product(*(variable.terms for variable in inputs)),
                table.values.ravel().tolist(),
                strict=True,
            )
        )
    )
    lookup = Lookup(
        tuple(LookupAxis(axis.name, axis.levels, axis.bins) for axis in table.axes), table.rounding
    )
    rulebase = RuleBase(
        name or table.output,
        inputs,
        (output,),
        (block,),
        description=f"nearest rules to a table of {table.output}",
        lookup=lookup,
    )
    return RulesOfTable(rulebase, table.values - _inferred(rulebase, table))


def _input(axis: Axis) -> Input:
    if len(axis.levels) == 1:
        # One level: the input does not matter, and its only set holds everywhere.
        low, high = axis.levels[0] - 1.0, axis.levels[0] + 1.0
        wide = Term("ANY", Shape("rectangle", (low, high)))
        return Input(axis.name, low, high, (wide,), axis.description)
    terms = _triangles(axis.levels)
    return Input(axis.name, axis.levels[0], axis.levels[-1], terms, axis.description)


def _output(table: LookupTable, terms: int) -> Output:
    low, high = table.reach
    if not high > low:
        low, high = low - 1.0, high + 1.0
    return Output(
        table.output,
        low,
        high,
        _triangles(evenly(low, high, terms)),
        table.description,
        defuzzifier=Defuzzifier("centroid"),
    )


def _triangles(peaks: tuple[float, ...]) -> tuple[Term, ...]:
    """Return triangles with these peaks, each foot under its neighbour's peak."""
    before = (2.0 * peaks[0] - peaks[1], *peaks[:-1])
    after = (*peaks[1:], 2.0 * peaks[-1] - peaks[-2])
    corners = zip(before, peaks, after, strict=True)
    return tuple(
        Term(name, Shape("triangle", shape))
        for name, shape in zip(_names(peaks), corners, strict=True)
    )


def _names(peaks: tuple[float, ...]) -> tuple[str, ...]:
    """Return the usual names around zero; N2 N1 ZE P1 P2 for other counts, else T1, T2, T3."""
    count = len(peaks)
    middle = count // 2
    if count % 2 == 0 or abs(peaks[middle]) > 1e-9 * (peaks[-1] - peaks[0]):
        return tuple(f"T{k + 1}" for k in range(count))
    if count == len(SEVEN):
        return SEVEN
    below = tuple(f"N{k}" for k in range(middle, 0, -1))
    return (*below, "ZE", *(f"P{k}" for k in range(1, middle + 1)))


def _own_values(output: Output) -> list[tuple[str, float]]:
    """Return the value of each term when it alone is concluded, fully."""
    values = []
    for term in output.terms:
        left, peak, right = term.shape.parameters
        # The centroid of the part of the triangle that lies within the range.
        if peak <= output.low:
            value = peak + (right - peak) / 3.0
        elif peak >= output.high:
            value = peak - (peak - left) / 3.0
        else:
            value = peak
        values.append((term.name, value))
    return values


def _nearest(values: list[tuple[str, float]], value: float) -> str:
    return min(values, key=lambda pair: abs(pair[1] - value))[0]


def _conjunction(inputs: tuple[Input, ...], chosen: tuple[Term, ...]) -> Expression:
    parts = tuple(Is(v.name, term.name) for v, term in zip(inputs, chosen, strict=True))
    # Row and column first, the inputs of the page after them: so a grid is written.
    parts = (*parts[-2:], *parts[:-2])
    return parts[0] if len(parts) == 1 else And(parts)


def _inferred(rulebase: RuleBase, table: LookupTable) -> NDArray[np.float64]:
    mesh = np.meshgrid(*(np.array(axis.levels) for axis in table.axes), indexing="ij")
    points = dict(zip(table.names, mesh, strict=True))
    return np.asarray(infer(rulebase, points)[table.output], dtype=np.float64)
