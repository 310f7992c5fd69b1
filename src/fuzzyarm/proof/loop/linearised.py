"""A sampled loop linearised about its rest: matrices in floats, opened at one drive.

The walk over a control period (:class:`fuzzyarm.proof.loop.period.LoopPeriod`) runs over values
with gradients, so that every source and sensor is differentiated without code here. The plant's
slopes at rest are sampled by the matrix exponential, exactly for held inputs.

A rule base is the sum of its slopes at rest times its inputs. At an edge of its surface a slope is
the mean of both sides along its input; in directions between the inputs the surface may differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

import numpy as np

from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.actuators import dead_time
from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.loop.period import LoopAlgebra, LoopPeriod
from fuzzyarm.proof.loop.resting import rest_in_floats
from fuzzyarm.proof.loop.sampled_plant import require_still
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.map.sector import slopes_at
from fuzzyarm.proof.stop import Stop, TimeOverError
from fuzzyarm.symbolic.evaluation import evaluate, gradient
from fuzzyarm.symbolic.nodes import Node, symbols
from fuzzyarm.table import LookupTable

STEP = 1e-4
"""Half step of a central difference, as a share of the range."""


EXACTLY = 5.0
"""Processor seconds for the exact slopes of an output, before differences replace them."""


@dataclass(frozen=True)
class RuleSlope:
    """The slope of a rule base or table at rest."""

    sheet: RuleBase | LookupTable
    output: str  # output, input: of the output, along the input
    input: str
    at: Mapping[str, float]  # all inputs at rest
    value: float  # the slope


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """A loop opened at one drive: ``z⁺ = A z + b u``, return ``-c z``.

    The loop transfer function is ``L(q) = c (q I - A)⁻¹ b``; the closed loop has ``u = -c z``.
    """

    a: Vector  # a, b, c: Sampled; shapes (n, n), (n,), (n,)
    b: Vector
    c: Vector
    # ``[J, g]``: rates of the plant by its states and by this drive, the others closed, for dead
    # times within a period; the first m of z are the states of the plant; shape (m, m + 1)
    ahead: Vector
    period: float  # s
    # Part of a period after which the drive acts, s, if its dead time ends inside one
    part: float = 0.0
    before: int = -1  # index in z of the previous drive, if there is such a part

    def at(self, omega: Vector) -> Vector:
        """Return L at frequencies in rad/s."""
        q = np.exp(1j * np.asarray(omega, float) * self.period)
        unit = np.eye(len(self.a))
        answers = np.linalg.solve(q[..., None, None] * unit - self.a, self.b[:, None])
        return np.asarray((answers[..., 0] * self.c).sum(axis=-1))

    @property
    def radius(self) -> float:
        """The spectral radius of the closed loop."""
        return float(np.abs(np.linalg.eigvals(self.a - np.outer(self.b, self.c))).max(initial=0.0))


@dataclass(frozen=True)
class LinearisedLoop:
    """A loop near its rest.

    Attributes
    ----------
    problem : LoopProblem
        The loop.
    rest : dict of str to float
        States of the plant, then memory.
    names : tuple of str
        Of z, in this order.
    slopes : tuple of RuleSlope
        Of its rule bases and tables.
    held : tuple of str
        Inputs of rule bases and tables that rest at or beyond an end of their range, in words.
    """

    problem: LoopProblem
    rest: Mapping[str, float]
    slopes: tuple[RuleSlope, ...]
    held: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """States of the plant, then memory."""
        return tuple(self.rest)

    @property
    def drives(self) -> tuple[Address, ...]:
        """Inputs of the plant."""
        return tuple(self.problem.site.interface.inputs)

    @cached_property
    def _rates(self) -> Vector:
        """Slopes of the plant's rates by states and inputs, at rest."""
        return _plant_slopes(self.problem, self._inputs_at_rest, self.rest)

    def _over(self, time: float) -> Vector:
        """Return the matrix from states and held inputs to states after a time."""
        from scipy.linalg import expm

        count, size = self._rates.shape
        whole = np.zeros((size, size))
        whole[:count] = self._rates
        return np.asarray(expm(whole * time)[:count])

    @cached_property
    def _sampled(self) -> Vector:
        """The matrix from states and held inputs to the next states."""
        return self._over(self.problem.period)

    @cached_property
    def _parts(self) -> list[float]:
        """For each input, the part of a period after which it changes, s."""
        ports = self.problem.site.interface.inputs.values()
        return [dead_time(port.dead_time, self.problem.period)[1] for port in ports]

    def _pending(self, index: int) -> int:
        """Return the index in z of the previous drive, for one that changes inside a period."""
        label = f"{'.'.join(self.drives[index])} pending "
        return max(k for k, name in enumerate(self.names) if name.startswith(label))

    @cached_property
    def _inputs_at_rest(self) -> Vector:
        return np.array([form.value for form in self._walk({})[0]])

    def _walk(self, changed: Mapping[int, float]) -> tuple[list[_Slope], list[_Slope]]:
        """Return inputs of the plant and next memory, with some slopes changed."""
        values = [slope.value for slope in self.slopes]
        for index, value in changed.items():
            values[index] = value
        return _walked(self.problem, self.rest, _Slopes(values))

    def opened(self, drive: Address, changed: Mapping[int, float] | None = None) -> OpenLoop:
        """Return the loop opened at a drive, with changed values of `slopes` by index."""
        inputs, after = self._walk(changed or {})
        count, size = len(self.problem.states), len(self.rest)
        index = self.drives.index(drive)
        a, b = np.zeros((size, size)), np.zeros(size)
        a[:count, :count] = self._sampled[:, :count]
        a[count:] = np.array([form.by for form in after]).reshape(size - count, size)
        before = -1
        for k, part in enumerate(self._parts):
            gain = inputs[k].by
            acts = self._sampled[:, count + k]
            if part:
                # In the first part of the period the previous drive acts, then this one.
                before = self._pending(k)
                late = self._over(self.problem.period - part)[:, count + k]
                a[:count, before] += acts - late
                acts, gain = late, a[before].copy()
                if k == index:
                    a[before], b[before] = 0.0, 1.0
            if k == index:
                b[:count], c = acts, -gain
            else:
                a[:count] += np.outer(acts, gain)
        ahead = self._rates[:, [*range(count), count + index]]
        return OpenLoop(
            a, b, c, ahead, self.problem.period, self._parts[index],
            self._pending(index) if self._parts[index] else -1,
        )  # fmt: skip


def linearised(problem: LoopProblem) -> LinearisedLoop:
    """Linearise a loop about its rest, with parameters in the middle of their intervals.

    LoopProofError: no rest was found, or it is at a limit or a switch.
    """
    require_still(problem)
    period = LoopPeriod[float](problem, LoopAlgebra())
    memory = [name for name in period.memory if " excess " not in name]
    rest = rest_in_floats(problem, memory, lambda sheet, output, at: infer(sheet, at)[output])
    scale = max(map(abs, rest.values()), default=0.0)
    rest = {name: 0.0 if abs(x) <= 1e-12 * scale else x for name, x in rest.items()}
    algebra = _Slopes(None)
    _walked(problem, rest, algebra)
    held = tuple(dict.fromkeys(algebra.at_ends))
    return LinearisedLoop(problem, rest, tuple(algebra.found), held)


# --- values with gradients ---


@dataclass(frozen=True)
class _Slope:
    """A value at rest, and its gradient by the states of the loop."""

    value: float
    by: Vector = field(default_factory=lambda: np.zeros(1))

    def plus(self, other: _Slope, sign: float = 1.0) -> _Slope:
        return _Slope(self.value + sign * other.value, self.by + sign * other.by)


class _Slopes(LoopAlgebra[_Slope]):
    """The algebra of values with gradients; rule bases have given slopes, or those at rest."""

    def __init__(self, given: Sequence[float] | None) -> None:
        self.given = given
        self.found: list[RuleSlope] = []
        self.at_ends: list[str] = []

    def number(self, value: float) -> _Slope:
        """Return a constant."""
        return _Slope(float(value))

    def add(self, a: _Slope, b: _Slope) -> _Slope:
        """Return a sum."""
        return a.plus(b)

    def subtract(self, a: _Slope, b: _Slope) -> _Slope:
        """Return a difference."""
        return a.plus(b, -1.0)

    def multiply(self, a: _Slope, b: _Slope) -> _Slope:
        """Return a product."""
        return _Slope(a.value * b.value, a.by * b.value + a.value * b.by)

    def divide(self, a: _Slope, b: _Slope) -> _Slope:
        """Return a quotient; NaN for a divisor of 0."""
        if not b.value:
            return _Slope(math.nan)
        return _Slope(a.value / b.value, a.by / b.value - a.value / b.value**2 * b.by)

    def error(self, x: _Slope, size: float) -> _Slope:
        """Return it unchanged: steps of a sensor have no slope."""
        return x

    def limit(self, x: _Slope, low: float, high: float) -> _Slope:
        """Return it unchanged where the limits are not reached."""
        if x.by.any() and not low < x.value < high:
            raise LoopProofError(
                f"at rest a signal is {x.value:.6g}, at a limit, {low:g} .. {high:g}"
            )
        return _Slope(min(max(x.value, low), high), x.by)

    def rate_limited(self, x: _Slope, before: _Slope, most: float) -> _Slope:
        """Return it unchanged: at rest no rate limit is active."""
        return x

    def expression(self, root: Node, values: Mapping[str, _Slope]) -> _Slope:
        """Return an expression by the chain rule."""
        names = tuple(name for name in symbols(root) if values[name].by.any())
        at = {name: values[name].value for name in symbols(root)}
        by = np.zeros(1)
        for name, node in zip(names, gradient(root, names), strict=True):
            by = by + float(evaluate(node, at)) * values[name].by
        return _Slope(float(evaluate(root, at)), by)

    def rules(self, rulebase: RuleBase, inputs: Mapping[str, _Slope]) -> list[_Slope]:
        """Return the outputs of a rule base."""
        ranges = {v.name: (v.low, v.high) for v in rulebase.inputs}
        clamped = [v.name for v in rulebase.inputs if v.outside == "clamp"]
        self._note_held(inputs, {name: ranges[name] for name in clamped})

        def value_of(output: str) -> Callable[[dict[str, float]], float]:
            return lambda at: float(infer(rulebase, at)[output])

        return [
            self._sheet(rulebase, output.name, inputs, ranges, value_of(output.name))
            for output in rulebase.outputs
        ]

    def table(self, table: LookupTable, inputs: Mapping[str, _Slope]) -> _Slope:
        """Return the value of a table."""
        if table.default_mode != "linear":
            raise LoopProofError(f"a table with steps ('{table.default_mode}') has no slope")
        ranges = {axis.name: (axis.levels[0], axis.levels[-1]) for axis in table.axes}
        self._note_held(inputs, ranges)
        return self._sheet(
            table, table.output, inputs, ranges, lambda at: table.lookup(*at.values())
        )

    def _note_held(
        self, inputs: Mapping[str, _Slope], ranges: Mapping[str, tuple[float, float]]
    ) -> None:
        """Record the moving inputs held at an end of their range."""
        for name, (low, high) in ranges.items():
            value = inputs[name].value
            if inputs[name].by.any() and not low < value < high:
                is_end = value in (low, high)
                side, gap = ("at the end of", "on one side") if is_end else ("beyond", "there")
                where = f"{side} its range {low:.4g} .. {high:.4g}"
                self.at_ends.append(f"'{name}' rests at {value:.4g}, {where}: no gain {gap}")

    def _sheet(
        self,
        sheet: RuleBase | LookupTable,
        output: str,
        inputs: Mapping[str, _Slope],
        ranges: Mapping[str, tuple[float, float]],
        value_at: Callable[[dict[str, float]], float],
    ) -> _Slope:
        at = {name: _without_rounding(form.value, ranges[name]) for name, form in inputs.items()}
        value, by = float(value_at(at)), np.zeros(1)
        if math.isnan(value):
            raise LoopProofError(f"at rest '{output}' has no value")
        moving = [name for name, form in inputs.items() if form.by.any()]
        if self.given is None:
            slopes = _exact_slopes(sheet, output, at, moving) or [
                _slope(value_at, at, name, ranges[name]) for name in moving
            ]
        else:
            slopes = list(self.given[len(self.found) : len(self.found) + len(moving)])
        for name, slope in zip(moving, slopes, strict=True):
            self.found.append(RuleSlope(sheet, output, name, at, slope))
            by = by + slope * inputs[name].by
        return _Slope(value, by)


def _without_rounding(x: float, ends: tuple[float, float]) -> float:
    """Return 0 for a rounding error of a rest at 0, where a surface may have an edge."""
    wide = ends[1] - ends[0]
    return 0.0 if math.isfinite(wide) and abs(x) <= 1e-12 * wide else x


def _exact_slopes(
    sheet: RuleBase | LookupTable, output: str, at: Mapping[str, float], names: Sequence[str]
) -> list[float] | None:
    """Return slopes of a piecewise linear rule base; None for another."""
    if not isinstance(sheet, RuleBase):
        return None
    try:
        with Stop(EXACTLY):
            slopes = slopes_at(Prover(sheet, output), at)
    except (UnprovableError, TimeOverError):
        return None
    found = []
    for name in names:
        above, below = (slopes.along({name: Fraction(sign)}) for sign in (1, -1))
        if above is None or below is None:
            return None
        found.append(float(above - below) / 2.0)
    return found


def _slope(
    value_at: Callable[[dict[str, float]], float],
    at: dict[str, float],
    name: str,
    ends: tuple[float, float],
) -> float:
    """Return a slope by two central differences, extrapolated to fourth order (Richardson)."""
    wide = STEP * (ends[1] - ends[0] if math.isfinite(ends[1] - ends[0]) else 1.0)

    def over(half: float) -> float:
        above, below = at | {name: at[name] + half}, at | {name: at[name] - half}
        return float(value_at(above) - value_at(below)) / (above[name] - below[name])

    return (4.0 * over(0.5 * wide) - over(wide)) / 3.0


# --- the plant, and a walk ---


def _walked(
    problem: LoopProblem, rest: Mapping[str, float], algebra: _Slopes
) -> tuple[list[_Slope], list[_Slope]]:
    """Return inputs of the plant and next memory at rest, with gradients by `rest`."""
    period = LoopPeriod(problem, algebra)
    size, count = len(rest), len(problem.states)
    unit = np.eye(size)
    z = {name: _Slope(x, unit[k]) for k, (name, x) in enumerate(rest.items())}
    equations = problem.equations
    values = {k: _Slope(x) for k, x in problem.constants.items()}
    values |= {k: z[n] for k, n in zip(equations.states, problem.states, strict=True)}
    outputs = {
        address: algebra.expression(root, values)
        for address, root in zip(problem.site.interface.outputs, equations.outputs, strict=True)
    }
    memory = {
        name: z.get(name, _Slope(0.0 if math.isnan(start) else start))
        for name, start in period.memory.items()
    }
    inputs, after = period.run(outputs, memory)
    wide = np.zeros(size)
    whole = [_Slope(form.value, form.by + wide) for form in inputs.values()]
    return whole, [_Slope(after[n].value, after[n].by + wide) for n in list(rest)[count:]]


def _plant_slopes(problem: LoopProblem, inputs: Vector, rest: Mapping[str, float]) -> Vector:
    equations = problem.equations
    values = problem.constants
    values |= {k: rest[n] for k, n in zip(equations.states, problem.states, strict=True)}
    values |= dict(zip(equations.inputs, inputs.tolist(), strict=True))
    every = (*equations.states, *equations.inputs)
    return np.array(
        [[float(evaluate(node, values)) for node in gradient(r, every)] for r in equations.rates]
    )
