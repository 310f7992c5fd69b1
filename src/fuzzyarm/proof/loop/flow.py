r"""Validated integration of an ordinary differential equation: one step, over affine forms.

``x' = f(t, x, u, p)`` with u and p constant. A step of length h takes three walks over the
expression of f.

1. An a-priori enclosure X̂ of the solutions during the step, X₀ + [0, h] f(X̂) ⊂ X̂ (Picard).
2. The Taylor coefficients over X̂ as intervals. The last of them, xₖ₊₁ hᵏ⁺¹, is the remainder of
   the Taylor polynomial (Lagrange), each state at its own time within the step.
3. The Taylor coefficients of the solutions from X₀ as forms, which keep the dependence of states
   on common symbols:  x(h) = x₀ + x₁ h + … + xₖ hᵏ + xₖ₊₁ hᵏ⁺¹.

Coefficients of a product are sums of products; those of a function y of x follow from y' = s x',
with the slope s as an expression from the record of the operation. Between the ends of the step a
solution is within ⅛ h² |x''| of its chord; x'' is twice the coefficient of order 2.

If a corner (of ``max``, of a choice) lies within X̂ there are no coefficients. Such a step uses the
mean of f over the step, which lies in f over the form X₀ + [0, h] f(X̂).

Sources: R. E. Moore, *Interval Analysis*, 1966, chapter 11; R. Lohner, "Enclosing the solutions of
ordinary initial and boundary value problems", *Computerarithmetic*, 1987; M. Althoff, O. Stursberg
and M. Buss, "Reachability analysis of nonlinear systems with uncertain parameters using
conservative linearization", CDC 2008.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals
from fuzzyarm.proof.loop.readings import (
    CONDITIONS,
    applied,
    as_forms,
    choice_of,
    is_less_equal,
    read,
    readable,
)
from fuzzyarm.proof.loop.zonotope import FUNCTIONS, Forms, dot, stacked
from fuzzyarm.symbolic.nodes import (
    Apply,
    Constant,
    Node,
    Symbol,
    as_node,
    constant,
    postorder,
    symbol,
)
from fuzzyarm.symbolic.operations import OPERATIONS


class CornerError(EnclosureError):
    """A corner of an expression is inside the domain of a series expansion."""


# ── series ───────────────────────────────────────────────────────────────────────────


class _Buffer:
    """The coefficients of one node, filled in order by order."""

    __slots__ = ("centre", "forms", "parts", "rest", "spread")

    def __init__(self, symbols: int, orders: int, batch: int) -> None:
        self.centre = np.zeros((orders, batch))
        self.parts = np.zeros((symbols, orders, batch))
        self.rest = np.zeros((orders, batch))
        self.spread = np.zeros((orders, batch))
        self.forms = Forms(self.centre, self.parts, self.rest, self.spread)

    def put(self, k: int, value: Forms) -> None:
        # A form may have fewer symbols than the buffer; other parts stay 0.
        count = len(value.parts)
        self.centre[k], self.rest[k], self.spread[k] = value.centre, value.rest, value.spread
        self.parts[:count, k] = value.parts

    def __getitem__(self, k: Any) -> Forms:
        return self.forms[k]


class _Series:
    """The Taylor coefficients of all nodes of an expression, order by order."""

    def __init__(self, flow: Flow, symbols: int, orders: int, batch: int) -> None:
        self.flow = flow
        self.shape = (batch,)
        self.orders = orders
        self.symbols = symbols
        self.buffers: dict[Any, _Buffer] = {}
        self.conditions: dict[Node, Intervals] = {}
        self.inverses: dict[Node, Forms] = {}
        # The series over the box X̂, whose choices hold for the whole step; None in that series
        # itself.
        self.before: _Series | None = None

    def buffer(self, key: Any) -> _Buffer:
        """Return the buffer of a node."""
        storage = self.buffers.get(key)
        if storage is None:
            storage = self.buffers[key] = _Buffer(self.symbols, self.orders, self.shape[0])
        return storage

    def coefficient(self, node: Node, k: int) -> Any:
        """Return one coefficient: forms, a number, or a condition."""
        if isinstance(node, Constant):
            return node.value if k == 0 else 0.0
        if node in self.conditions:
            return self.conditions[node]
        if node in self.flow.steady and k > 0:
            return 0.0
        return self.buffer(node)[k]

    def inverse(self, node: Node) -> Forms:
        """Return the reciprocal of the lowest coefficient of a node."""
        if node not in self.inverses:
            self.inverses[node] = self.coefficient(node, 0).function("reciprocal")
        return self.inverses[node]

    def advance(self, k: int) -> None:
        """Fill in the coefficients of order k."""
        for node in self.flow.order:
            if k > 0 and node in self.flow.steady:
                continue
            self._fill(node, k)

    def _fill(self, node: Apply, k: int) -> None:
        operation = node.operation
        if operation in CONDITIONS:
            if k == 0:
                arguments = [
                    as_forms(self.coefficient(argument, 0), self.shape)
                    if argument not in self.conditions
                    else self.conditions[argument]
                    for argument in node.arguments
                ]
                self.conditions[node] = CONDITIONS[operation](*arguments)
            return
        if k == 0:
            arguments = [self.coefficient(argument, 0) for argument in node.arguments]
            if operation == "sqrt" and node in self.flow.slopes:
                _require_positive(as_forms(arguments[0], self.shape))
            result = applied(
                node, arguments, self.shape, lambda operand: self.coefficient(operand, 0)
            )
            self.buffer(node).put(0, as_forms(result, self.shape))
            return
        value = _RULES[operation](self, node, k)
        self.buffer(node).put(k, as_forms(value, self.shape))

    def steps(self, x: Node, y: _Buffer, k: int) -> Forms:
        """Return (1/k) Σ j xⱼ yₖ₋ⱼ: Taylor coefficient k of a function with the derivative y x'."""
        weights = np.arange(1, k + 1) / k  # two roundings, covered by `scaled`
        return dot(self.buffer(x)[1 : k + 1].scaled(weights[:, None]), y[k - 1 :: -1][:k])

    def choice(self, node: Node, first: Node, second: Node, k: int) -> Any:
        """Return the coefficient of one of two, if decided for the whole step."""
        decided = (self.before or self).decisions[node]
        a, b = self.coefficient(first, k), self.coefficient(second, k)
        if decided.all():
            return a
        if not decided.any():
            return b
        a, b = (as_forms(operand, self.shape) for operand in (a, b))
        return choice_of(Intervals.at(decided.astype(float)), a, b)

    @property
    def decisions(self) -> _Decisions:
        """The choices over the whole step."""
        return _Decisions(self)


def _require_positive(x: Forms) -> None:
    if np.any(x.bounds.low <= 0.0):
        raise CornerError("the root of 0 within a step")


class _Decisions:
    """For each choice: whether it is the first of two nodes; CornerError if undecided."""

    def __init__(self, series: _Series) -> None:
        self.series = series

    def __getitem__(self, node: Node) -> NDArray[np.bool_]:
        assert isinstance(node, Apply)
        series = self.series
        if node.operation == "where":
            condition = series.conditions[node.arguments[0]]
        else:
            a, b = (
                as_forms(series.coefficient(argument, 0), series.shape)
                for argument in (*node.arguments, constant(0.0))[:2]
            )
            first_is_less = node.operation == "minimum"
            condition = is_less_equal(a, b) if first_is_less else is_less_equal(b, a)
        if np.any(condition.low != condition.high):
            raise CornerError(f"a corner of '{node.operation}' within a step")
        return np.asarray(condition.low > 0.0)


Rule = Callable[[_Series, Apply, int], Any]


def _sum_rule(sign: float) -> Rule:
    def rule(series: _Series, node: Apply, k: int) -> Any:
        a, b = (series.coefficient(argument, k) for argument in node.arguments)
        if isinstance(b, float):
            return a + sign * b if isinstance(a, float) or b != 0.0 else a
        if isinstance(a, float):
            addend = b if sign > 0 else -b
            return addend + a if a != 0.0 else addend
        return a + b if sign > 0 else a - b

    return rule


def _product_rule(series: _Series, node: Apply, k: int) -> Any:
    a, b = node.arguments
    steady = series.flow.steady
    if a in steady or isinstance(a, Constant):
        a, b = b, a
    if isinstance(b, Constant):
        factor = series.coefficient(a, k)
        return factor * b.value if isinstance(factor, float) else factor.scaled(b.value)
    if b in steady:
        return series.coefficient(b, 0) * as_forms(series.coefficient(a, k), series.shape)
    # Cauchy's product: (a b)ₖ = Σ aⱼ bₖ₋ⱼ.
    return dot(series.buffer(a)[: k + 1], series.buffer(b)[k::-1])


def _quotient_rule(series: _Series, node: Apply, k: int) -> Any:
    a, b = node.arguments
    upper = as_forms(series.coefficient(a, k), series.shape)
    if isinstance(b, Constant):
        return upper / b.value
    if b not in series.flow.steady:  # q b = a: qₖ b₀ = aₖ - Σ bⱼ qₖ₋ⱼ
        quotient = series.buffer(node)
        upper = upper - dot(series.buffer(b)[1 : k + 1], quotient[k - 1 :: -1][:k])
    return upper * series.inverse(b)


def _negative_rule(series: _Series, node: Apply, k: int) -> Any:
    return -series.coefficient(node.arguments[0], k)


def _function_rule(series: _Series, node: Apply, k: int) -> Any:
    # y' = s x', where s is the derivative in the record of the operation.
    return series.steps(node.arguments[0], series.buffer(series.flow.slopes[node]), k)


def _choice_rule(series: _Series, node: Apply, k: int) -> Any:
    first, second = node.arguments[-2:]
    return series.choice(node, first, second, k)


def _absolute_rule(series: _Series, node: Apply, k: int) -> Any:
    (x,) = node.arguments
    positive = (series.before or series).decisions[node]
    forms = as_forms(series.coefficient(x, k), series.shape)
    return forms.scaled(np.where(positive, 1.0, -1.0))


_RULES: dict[str, Rule] = {
    "add": _sum_rule(1.0),
    "subtract": _sum_rule(-1.0),
    "multiply": _product_rule,
    "divide": _quotient_rule,
    "negative": _negative_rule,
    **dict.fromkeys(FUNCTIONS, _function_rule),
    "absolute": _absolute_rule,
    "minimum": _choice_rule,
    "maximum": _choice_rule,
    "where": _choice_rule,
}
"""The recurrence of coefficient k, by operation."""


# ── a step ───────────────────────────────────────────────────────────────────────────


class Step(NamedTuple):
    """The result of one step."""

    end: Forms  # the states afterwards, shape (states, batch)
    between: Intervals  # the states at all times of the step
    # Their largest distance from the chord between the ends; None if unknown
    bend: Intervals | None
    # Radius of the remainder of the series, shape (states, batch)
    remainder: NDArray[np.float64]


def _slope_of(node: Apply) -> Node:
    """Return the derivative of a function by its argument, from its record."""
    partials = OPERATIONS[node.operation].partials
    assert partials is not None
    (slope,) = partials(*node.arguments)
    return readable(as_node(slope))


def _steady(nodes: Sequence[Node], moving: Collection[str]) -> set[Node]:
    """Return the constant nodes during a step, of a graph in order."""
    steady: set[Node] = set()
    for node in nodes:
        if isinstance(node, Symbol):
            stays = node.name not in moving
        else:
            parts = node.arguments if isinstance(node, Apply) else ()
            stays = bool(parts) and all(
                part in steady or isinstance(part, Constant) for part in parts
            )
        if stays:
            steady.add(node)
    return steady


@dataclass(eq=False)
class Flow:
    """An ordinary differential equation.

    Parameters
    ----------
    rates : sequence of Node
        Of the states, over ``t``, ``x0`` …, and symbols that are constant during a step.

    Raises
    ------
    UnreadableError
        If they have an operation without a reading over forms.
    """

    rates: Sequence[Node]

    def __post_init__(self) -> None:
        self.rates = [readable(root) for root in self.rates]
        self.states = [f"x{i}" for i in range(len(self.rates))]
        moving = {*self.states, "t"}
        self.slopes: dict[Node, Node] = {}
        before = -1
        while before != (before := len(self.slopes)):  # slopes contain functions, too
            nodes = list(postorder(*self.rates, *self.slopes.values()))
            self.steady = _steady(nodes, moving)
            for node in nodes:
                if node in self.steady or not isinstance(node, Apply):
                    continue
                if node.operation in FUNCTIONS:
                    self.slopes[node] = _slope_of(node)
        self.order = [node for node in nodes if isinstance(node, Apply)]
        self.symbols = [node for node in nodes if isinstance(node, Symbol)]

    def step(
        self, start: Forms, constants: Mapping[str, Forms], time: float, length: float, order: int
    ) -> Step:
        """Take one step of the states, shape (states, batch), from a time, s.

        `constants` have the shape (batch,); `order` is the highest power of h but one.
        EnclosureError: no a-priori enclosure was found, the step is too long.
        """
        inputs = {name: Forms.of(value.bounds) for name, value in constants.items()}
        box = self._box(start.bounds, inputs, time, length)
        try:
            return self._taylor(start, constants, inputs, box, time, length, order)
        except CornerError:
            return self._mean(start, constants, inputs, box, time, length)

    def step_of_first_order(
        self, start: Forms, constants: Mapping[str, Forms], time: float, length: float
    ) -> Step:
        """Take one step without slopes, as at a corner."""
        inputs = {name: Forms.of(value.bounds) for name, value in constants.items()}
        box = self._box(start.bounds, inputs, time, length)
        return self._mean(start, constants, inputs, box, time, length)

    # ── the box ──────────────────────────────────────────────────────────────────────

    def rates_over(self, states: Forms, constants: Mapping[str, Forms], time: Intervals) -> Forms:
        """Return the rates, shape (states, batch)."""
        batch = states.shape[1:]
        values = {**constants, **{name: states[i] for i, name in enumerate(self.states)}}
        values["t"] = Forms.between(np.full(batch, time.low), np.full(batch, time.high))
        return stacked(read(self.rates, values))

    def _box(
        self, start: Intervals, inputs: Mapping[str, Forms], time: float, length: float
    ) -> Intervals:
        times = Intervals.between(time, np.nextafter(time + length, np.inf))
        span = Intervals.between(np.zeros(start.shape), np.full(start.shape, length))
        # A guess is inflated until its image lies strictly inside: then solutions stay in the
        # image, and in the image of that, which is tighter.
        box, grown = start, 1.05
        for _ in range(14):
            image = start + self.rates_over(Forms.of(box), inputs, times).bounds * span
            if not np.isfinite(image.size).all():
                break
            if np.all((box.low < image.low) & (image.high < box.high)):
                again = start + self.rates_over(Forms.of(image), inputs, times).bounds * span
                return again.meet(image)
            reach = image.hull(start)
            extra = (grown - 1.0) * (reach.high - reach.low) + 1e-12 * (1.0 + reach.size)
            box, grown = Intervals(reach.low - extra, reach.high + extra), grown + 0.1
        raise EnclosureError("no box was found that contains the solutions of a step")

    # ── the series ───────────────────────────────────────────────────────────────────

    def _taylor(
        self,
        start: Forms,
        constants: Mapping[str, Forms],
        inputs: Mapping[str, Forms],
        box: Intervals,
        time: float,
        length: float,
        order: int,
    ) -> Step:
        times = Intervals.between(time, np.nextafter(time + length, np.inf))
        over = self._series(Forms.of(box), inputs, times, order + 1, None)
        last = stacked([over.buffer(_state(i))[order + 1] for i in range(len(self.states))])
        series = self._series(start, constants, Intervals.at(time), order, over)
        power = Intervals.at(1.0)
        for _ in range(order + 1):
            power = power * length
        tail = last.bounds * power
        # Horner's rule in h.
        total = stacked([series.buffer(_state(i))[order] for i in range(len(self.states))])
        for k in range(order - 1, -1, -1):
            lower = stacked([series.buffer(_state(i))[k] for i in range(len(self.states))])
            total = total.scaled(length) + lower
        end = total + Forms.of(tail)
        # During the step: the chord minus ½ s (h - s) x''. The coefficient of order 2 is ½ x'', and
        # s (h - s) is at most ¼ h².
        second = stacked([over.buffer(_state(i))[2] for i in range(len(self.states))]).bounds
        room = Intervals.between(0.0, np.nextafter(0.25 * length * length, np.inf))
        bend = -(second * room)
        return Step(end, (start.bounds.hull(end.bounds) + bend).meet(box), bend, tail.radius)

    def _series(
        self,
        start: Forms,
        constants: Mapping[str, Forms],
        time: Intervals,
        orders: int,
        before: _Series | None,
    ) -> _Series:
        """Return the coefficients of the solutions up to an order; `before`: those over the box."""
        batch = start.shape[1]
        count = max(len(start.parts), *(len(forms.parts) for forms in constants.values()), 0)
        series = _Series(self, count, orders + 1, batch)
        series.before = before
        for node in self.symbols:
            if node.name in constants:
                series.buffer(node).put(0, constants[node.name])
            elif node.name == "t":
                low, high = np.full(batch, time.low), np.full(batch, time.high)
                series.buffer(node).put(0, Forms.between(low, high))
                if orders > 0:
                    series.buffer(node).put(1, Forms.at(np.ones(batch)))
        for i in range(len(self.states)):
            series.buffer(_state(i)).put(0, start[i])
        for k in range(orders):
            series.advance(k)
            for i, root in enumerate(self.rates):
                rate = as_forms(series.coefficient(root, k), (batch,))
                # 1/(k+1) is rounded once more; `scaled` covers two roundings.
                series.buffer(_state(i)).put(k + 1, rate.scaled(1.0 / (k + 1)))
        return series

    # ── at a corner ──────────────────────────────────────────────────────────────────

    def _mean(
        self,
        start: Forms,
        constants: Mapping[str, Forms],
        inputs: Mapping[str, Forms],
        box: Intervals,
        time: float,
        length: float,
    ) -> Step:
        times = Intervals.between(time, np.nextafter(time + length, np.inf))
        rates = self.rates_over(Forms.of(box), inputs, times).bounds
        span = Intervals.between(np.zeros(box.shape), np.full(box.shape, length))
        # x(h) = x₀ + ∫ f, and the mean of f over the step lies in any convex set that contains f.
        on_the_way = start + Forms.of(rates * span)
        mean = self.rates_over(on_the_way, constants, times)
        end = start + mean.scaled(length)
        return Step(end, box, None, length * rates.radius)


def _state(index: int) -> Symbol:
    return symbol(f"x{index}")
