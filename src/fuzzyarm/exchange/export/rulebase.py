"""The direct inference of one output of a rule base as a routine to export."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.exchange.export.listing import Listing, uses_functions
from fuzzyarm.exchange.export.numbers import Kind, Precision, precision_named, rounded
from fuzzyarm.exchange.export.program import OutputProgram, make_program
from fuzzyarm.exchange.export.routine import Accuracy, CallCost, RoutineArgument, TestPoints
from fuzzyarm.exchange.export.sets import refuse
from fuzzyarm.inference.engine import cached_engine
from fuzzyarm.inference.plan import part_for
from fuzzyarm.language.model.rulebase import Input, RuleBase
from fuzzyarm.language.model.shapes import corner_points, polyline
from fuzzyarm.symbolic.identifiers import Names
from fuzzyarm.symbolic.kinds import SHAPES
from fuzzyarm.symbolic.nodes import Constant
from fuzzyarm.table.compiler import choose_output
from fuzzyarm.version import __version__

_DENSE_POINTS = 60_000
_DENSE_HEIGHTS = 120_000_000
"""Points times samples times sets: above it a point takes long."""

_FEWEST_POINTS = 1_024
_MOST_POINTS = 6_000_000
_VECTORS, _SCATTERED = 160, 80
_SHARES = (0.02, 0.09, 0.37, 0.91, 0.98)
"""Where points of the self-test lie in a piece between two edges."""

_FAR = 100.0
"""Widths beyond a range, for no rule: a Gaussian is 0 there, not a subnormal number."""

_AT_ONCE = 16_384
"""Points at which a program runs at a time: its arrays stay in the cache."""


@dataclass(frozen=True, eq=False)
class DirectRoutine:
    """One output of a rule base, inferred without a table.

    Attributes
    ----------
    rulebase : RuleBase
        The model.
    name : str
        The output.
    precision : Precision
        Types outside and inside.
    program : OutputProgram
        The arithmetic.
    source : str
        Its file, for the head.
    """

    rulebase: RuleBase
    name: str
    precision: Precision
    program: OutputProgram
    source: str = ""

    @cached_property
    def listing(self) -> Listing:
        """The arithmetic as statements."""
        return Listing(self.program)

    @property
    def calls_functions(self) -> bool:
        """Whether functions of the mathematical library are called."""
        return bool(self.program.walks) or uses_functions(self.program.nodes)

    @property
    def output(self) -> RoutineArgument:
        """The result."""
        output = self.rulebase.output(self.name)
        return RoutineArgument(output.name, output.low, output.high, output.description)

    @property
    def arguments(self) -> Sequence[RoutineArgument]:
        """The inputs, and the value to hold for an output that holds."""
        parameters = [
            RoutineArgument(v.name, v.low, v.high, v.description) for v in self.rulebase.inputs
        ]
        if self.program.holds:
            output = self.rulebase.output(self.name)
            words = "the last value, returned where no rule fires"
            parameters.append(
                RoutineArgument(f"last {output.name}", output.low, output.high, words, holds=True)
            )
        return parameters

    @property
    def kind(self) -> Kind:
        """The type of arguments and result."""
        return self.precision.outside

    def evaluate(self, *inputs: Any) -> NDArray[Any]:
        """Return the function's result at arguments in order, bit for bit."""
        outside, inside, _ = self.precision
        with np.errstate(over="ignore"):
            arrays = [np.atleast_1d(np.asarray(x, dtype=outside)) for x in inputs]
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
        # Arrays keep their axes: functions of one input are evaluated once for its values.
        columns = [
            array.reshape((1,) * (len(shape) - array.ndim) + array.shape) for array in arrays
        ]
        result = np.empty(shape, outside)
        most = min(_AT_ONCE, 64 * _AT_ONCE // self._samples)
        step = max(1, most // max(1, math.prod(shape[1:])))
        for start in range(0, shape[0], step):
            stretch = slice(start, start + step)
            values = {
                name: (column[stretch] if len(column) > 1 else column).astype(inside)
                for name, column in zip(self.program.symbols, columns, strict=True)
            }
            with np.errstate(over="ignore"):
                result[stretch] = self.program.over_arrays(values, inside)
        return result.reshape(np.broadcast_shapes(*(np.shape(x) for x in inputs)))

    @property
    def _samples(self) -> int:
        return max((sums.count for sums in self.program.sums), default=1)

    @property
    def _heights(self) -> int:
        """Number of evaluations of a set at a sample, of a call."""
        counts = [sums.count * len(sums.steps) for sums in self.program.sums]
        return max([*counts, *(walk.steps for walk in self.program.walks)], default=1)

    def cost(self) -> CallCost:
        """Return the cost of one call."""
        counted = {
            f"{sort} of math.h" if sort == "functions" else sort: count
            for sort, count in self.listing.operations().items()
        }
        names = {*self.listing.variables, *self.program.symbols}
        size = np.dtype(self.precision.inside).itemsize
        walks = list(self.program.walks)
        stack = size * (len(names) + sum(walk.scratch for walk in walks))
        methods = (str(self.rulebase.output(walk.output).defuzzifier) for walk in walks)
        unbounded = " and ".join(dict.fromkeys(methods))
        return CallCost(tuple(sorted(counted.items())), stack, unbounded)

    @property
    def silence(self) -> str:
        """The result of a function if no rule fires, in words."""
        no_rule = self.rulebase.output(self.name).no_rule
        value = {"error": "NaN", "hold": "the last argument"}.get(str(no_rule), no_rule)
        return f"the result is {value} where no rule fires"

    def remarks(self) -> list[str]:
        """Return the header comment's lines on inference, borders and arithmetic."""
        output = self.rulebase.output(self.name)
        blocks = "; ".join(
            f"and {b.conjunction}, or {b.disjunction}, implication {b.implication}"
            for b in self.rulebase.blocks
        )
        return [
            f"direct inference of {len(self.rulebase.rules)} rules: {blocks},"
            f" aggregation {output.aggregation}, {output.defuzzifier}",
            *(_border_words(variable) for variable in self.rulebase.inputs),
            "an input that is not a number (NaN) counts as the lower border",
            self.silence,
            self.precision.words,
            *_single_words(self.precision.inside),
        ]

    def provenance(self) -> Sequence[tuple[str, str]]:
        """Return the provenance of the rule base."""
        from fuzzyarm.language import write

        pairs = [("rulebase", self.rulebase.name)]
        if self.source:
            pairs.append(("source", self.source))
        pairs.append(("sha256", hashlib.sha256(write(self.rulebase).encode()).hexdigest()))
        return [*pairs, ("engine", f"fuzzyarm {__version__}")]

    @cached_property
    def accuracy(self) -> Accuracy:
        """The difference to the inference in double precision over a dense grid."""
        axes = self._grid()
        if math.prod(axis.size for axis in axes) <= _MOST_POINTS:
            points = list(np.ix_(*axes))
        else:  # too many inputs for all corners: random ones
            draw = np.random.default_rng(len(axes))
            points = [draw.choice(axis, _DENSE_POINTS) for axis in axes]
        result = self.evaluate(*points, *self._held(points[0])).astype(np.float64)
        truth = self.model(*points)
        difference = np.abs(result - truth)
        difference = difference[~np.isnan(difference)]
        worst = float(difference.max()) if difference.size else 0.0
        words = f"the inference of {self.name} in double precision"
        return Accuracy(worst, int(difference.size), words)

    def model(self, *inputs: NDArray[Any], held: float | None = None) -> NDArray[np.float64]:
        """Return the inference of the engine in double precision, NaN if no rule fires.

        Inputs outside a range that forbids it are clamped, as in the exported function.
        """
        columns = {
            variable.name: np.asarray(x, dtype=np.float64)
            for variable, x in zip(self.rulebase.inputs, inputs, strict=True)
        }
        last = self._last() if held is None else held
        # Other outputs may take far longer than this one.
        part = part_for(_without_errors(self.rulebase), (self.name,))
        part_inputs = {variable.name: columns[variable.name] for variable in part.inputs}
        holding = {o.name: last for o in part.outputs if o.no_rule == "hold"}
        values = cached_engine(part).evaluate(part_inputs, holding)[self.name]
        return np.broadcast_to(np.asarray(values), np.broadcast_shapes(*(x.shape for x in inputs)))

    def _last(self) -> float:
        output = self.rulebase.output(self.name)
        return output.low if math.isfinite(output.low) else 0.0

    def _held(self, like: NDArray[Any]) -> list[NDArray[Any]]:
        return [np.full_like(like, self._last())] if self.program.holds else []

    def _grid(self) -> list[NDArray[Any]]:
        inputs = self.rulebase.inputs
        points = max(_FEWEST_POINTS, min(_DENSE_POINTS, _DENSE_HEIGHTS // self._heights))
        count = max(3, round(points ** (1.0 / len(inputs))))
        return [self._axis_points(variable, count) for variable in inputs]

    def _probing_points(self, variable: Input) -> NDArray[Any]:
        """Return points of an input: inside its pieces, close to edges, and outside its range."""
        corners = corners_of(variable)
        low = variable.low if math.isfinite(variable.low) else corners[0]
        high = variable.high if math.isfinite(variable.high) else corners[-1]
        edges = np.unique([low, *(x for x in corners if low < x < high), high])
        pieces = edges[:-1, None] + np.diff(edges)[:, None] * np.array(_SHARES)
        return np.unique(
            [*pieces.ravel(), 2 * low - pieces[0, 1], 2 * high - pieces[-1, -2]]
        ).astype(self.precision.outside)

    def _axis_points(self, variable: Input, count: int) -> NDArray[Any]:
        """Return even points, the corners of the terms and their neighbours."""
        corners = corners_of(variable)
        low = variable.low if math.isfinite(variable.low) else corners[0]
        high = variable.high if math.isfinite(variable.high) else corners[-1]
        outside = self.precision.outside
        inside = [x for x in corners if low <= x <= high][: max(3, count // 4)]
        close = np.array(inside, dtype=outside)
        around = [np.nextafter(close, outside(way)) for way in (-np.inf, np.inf)]
        even = np.linspace(low, high, max(3, count - 3 * len(inside))).astype(outside)
        return np.unique(np.concatenate([even, close, *around]))

    def vectors(self) -> TestPoints:
        """Return points inside every piece and on both sides of every edge, and scattered ones.

        Scattered points find the steps of sampled sets, which lie anywhere, and far outside a
        range that inputs may leave no rule fires.
        """
        inputs = []
        for k, mixed in enumerate(self._mixed()):
            variable = self.rulebase.inputs[k]
            inside = mixed[(mixed >= variable.low) & (mixed <= variable.high)]
            shares = np.sqrt(_PRIMES[k % len(_PRIMES)]) * np.arange(1, 1 + _SCATTERED) % 1.0
            low, width = inside.min(), np.ptp(inside)
            far = [low - _FAR * width, low + _FAR * width] if variable.outside == "extend" else []
            scattered = [*(low + shares * width), *(far or [low, low])]
            inputs.append(np.array([*mixed, *scattered], mixed.dtype))
        return self._tested(inputs)

    def pieces(self) -> TestPoints:
        """Return those of them inside the pieces and on both sides of every edge."""
        return self._tested(self._mixed())

    def _mixed(self) -> list[NDArray[Any]]:
        """Return points of every piece of each input, mixed over the inputs.

        A corner of a term shows little of the lines that meet there: a constant wrong by a tenth
        changes the result between corners.
        """
        number = np.arange(_VECTORS)
        inputs = []
        for k, variable in enumerate(self.rulebase.inputs):
            points = self._probing_points(variable)
            # Two inputs have all pairs, in an order that soon covers every point of each.
            shift = number // points.size if k else 0
            inputs.append(points[(number * _stride(k, points.size) + shift) % points.size])
        return inputs

    def _tested(self, inputs: list[NDArray[Any]]) -> TestPoints:
        columns = [*inputs, *self._held(inputs[0])]
        expected = self.evaluate(*columns)
        finite = ~np.isnan(expected)
        if not finite.any():
            columns, expected = [c[:0] for c in columns], expected[:0]
        else:
            columns, expected = [c[finite] for c in columns], expected[finite]
        step = float(np.finfo(self.precision.outside).eps)
        output = self.rulebase.output(self.name)
        ends = [abs(x) for x in (output.low, output.high) if math.isfinite(x)]
        scale = max([*ends, *np.abs(expected).tolist(), 1e-30])
        loose = 256.0 if self.precision.inside is np.float32 else 4.0
        if self.calls_functions:  # another machine has another library
            loose *= 16.0
        return TestPoints(tuple(columns), expected, loose * step * scale)


def direct_routine(
    rulebase: RuleBase,
    output: str | None = None,
    precision: str = "mixed",
    source: str | Path | None = None,
    *,
    widened: bool = False,
) -> DirectRoutine:
    """Prepare the direct inference of one output; an ExportError names an obstacle.

    With `widened` results that need double precision are computed so within, whatever the
    precision.
    """
    target = choose_output(rulebase, output)
    names = Names()
    arguments = [variable.name for variable in rulebase.inputs]
    if target.no_rule == "hold":
        arguments.append(f"last {target.name}")
    parameters = [names.new(argument) for argument in arguments]
    program = make_program(rulebase, target.name, parameters)
    types = precision_named(precision, arithmetic=True)
    if program.walks and widened:
        types = precision_named("mixed" if precision == "float32" else precision, arithmetic=True)
    if program.walks and types.inside is not np.float64:
        way = target.defuzzifier
        raise refuse(
            f"the {way} of '{program.walks[0].output}' is found in double precision only",
            rulebase.output(program.walks[0].output).span,
            "take --precision mixed or float64",
        )
    constants = [n.value for n in program.nodes if isinstance(n, Constant)]
    finite = [value for value in constants if math.isfinite(value)]
    rounded(finite, types.inside, f"the direct inference of '{target.name}'")
    where = Path(source).name if source is not None else ""
    return DirectRoutine(rulebase, target.name, types, program, where)


_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19)


def _stride(number: int, count: int) -> int:
    """Return a step that reaches each of `count` points, another one for each input."""
    stride = (1, 7, 11, 13, 17, 19, 23, 29)[number % 8]
    while math.gcd(stride, count) > 1:
        stride += 1
    return stride


def corners_of(variable: Input) -> list[float]:
    """Return the ends of a variable and the corners and bends of its terms, in order."""
    values = {x for x in (variable.low, variable.high) if math.isfinite(x)}
    for term in variable.terms:
        straight = SHAPES[term.shape.kind].straight
        edges = [x for x, _ in polyline(term.shape)] if straight else corner_points(term.shape)
        values |= {x for x in edges if math.isfinite(x)}
    return sorted(values) or [0.0]


def _without_errors(rulebase: RuleBase) -> RuleBase:
    """Return the rule base without errors at run time, as in the exported function."""
    inputs = tuple(
        replace(v, outside="clamp") if v.outside == "error" else v for v in rulebase.inputs
    )
    outputs = tuple(
        replace(
            output,
            no_rule=math.nan if output.no_rule == "error" else output.no_rule,
            outside="clamp" if output.outside == "error" else output.outside,
        )
        for output in rulebase.outputs
    )
    return replace(rulebase, inputs=inputs, outputs=outputs)


def _single_words(inside: Kind) -> list[str]:
    """Explain single precision next to a corner; doubles have the bits of the model."""
    if inside is not np.float32:
        return []
    return [
        "corners, thresholds and degrees are rounded to float: within a few 1e-7 of the range of an"
        " input of a corner another rule may fire than in the model, or none"
    ]


def _border_words(variable: Input) -> str:
    if variable.outside == "extend":
        return f"{variable.name} is used as it is beyond its range"
    if variable.outside == "error":
        return f"{variable.name} outside its range is an error in the model, clamped here"
    return f"{variable.name} outside its range is clamped to the border (saturation)"
