r"""Where the solutions of an ordinary differential equation go: one step, over affine forms.

``x' = f(t, x, u, p)`` with u and p constant. A step of length h takes three walks over the expression
of f.

1. A box X̂ that no solution leaves during the step: one with X₀ + [0, h] f(X̂) inside (Picard).
2. The Taylor coefficients over X̂ as intervals. The last of them, xₖ₊₁ hᵏ⁺¹, is what a solution differs
   from its Taylor polynomial (Lagrange), each state at a time of its own within the step.
3. The Taylor coefficients of the solutions from X₀ as forms, so that what two states owe to one
   symbol stays together:  x(h) = x₀ + x₁ h + … + xₖ hᵏ + xₖ₊₁ hᵏ⁺¹.

Coefficients of a product are sums of products, those of functions follow from their differential
equations (s = sin x and c = cos x: s' = c x', c' = -s x'). Between the ends of the step a solution is
within ⅛ h² |x''| of the straight line between them, and x'' is twice a coefficient that is there.

Where a corner (of ``max``, of a choice) lies within X̂ there are no coefficients. Such a step takes the
mean of f over the step, which lies in f of the form X₀ + [0, h] f(X̂).

Sources: R. E. Moore, *Interval Analysis*, 1966, chapter 11; R. Lohner, "Enclosing the solutions of
ordinary initial and boundary value problems", *Computerarithmetic*, 1987; M. Althoff, O. Stursberg
and M. Buss, "Reachability analysis of nonlinear systems with uncertain parameters using conservative
linearization", CDC 2008.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.closed_loop.enclosure import EnclosureError, Intervals, square_root
from fuzzyarm.closed_loop.zonotope import Forms, aligned, dot, larger, smaller
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.expression.nodes import (
    Apply,
    Constant,
    Node,
    Symbol,
    apply,
    constant,
    postorder,
    symbol,
)

__all__ = ["CornerError", "Flow", "Step", "UnreadableError", "read", "readable"]


class UnreadableError(FuzzyarmError, ValueError):
    """An expression has an operation of which nothing is enclosed; the message names it."""


class CornerError(EnclosureError):
    """A corner of an expression lies within what is to be developed into a series."""


# ── what is read ─────────────────────────────────────────────────────────────────────


def readable(root: Node) -> Node:
    """Return an expression in the operations that forms have.

    Raises
    ------
    UnreadableError
        If it has another one.
    """
    made: dict[Node, Node] = {}
    for node in postorder(root):
        if not isinstance(node, Apply):
            made[node] = node
            continue
        arguments = tuple(made[argument] for argument in node.arguments)
        made[node] = _rewritten(node.operation, arguments)
    return made[root]


def _rewritten(operation: str, arguments: tuple[Node, ...]) -> Node:
    if operation in _READINGS:
        return apply(operation, *arguments)
    if operation == "where":
        return _choice(*arguments)
    if operation == "power":
        return _power(*arguments)
    made = _IN_OTHERS.get(operation)
    if made is None:
        raise UnreadableError(f"nothing is enclosed of '{operation}'")
    return readable(made(*arguments))


def _choice(condition: Node, then: Node, otherwise: Node) -> Node:
    """Return a choice; the smaller or the larger of two where it is that."""
    if isinstance(condition, Apply) and condition.operation in ("less", "less_equal"):
        if condition.arguments == (then, otherwise):
            return apply("minimum", then, otherwise)
        if condition.arguments == (otherwise, then):
            return apply("maximum", then, otherwise)
    return apply("where", condition, then, otherwise)


def _power(base: Node, exponent: Node) -> Node:
    if not isinstance(exponent, Constant):
        raise UnreadableError("nothing is enclosed of 'power' with an exponent that changes")
    number = exponent.value
    if number == 0.5:
        return apply("sqrt", base)
    if number % 1.0 == 0.0 and 0.0 < abs(number) <= 16.0:
        result = base
        for _ in range(int(abs(number)) - 1):
            result = apply("multiply", result, base)
        return result if number > 0 else apply("divide", constant(1.0), result)
    return apply("exp", apply("multiply", exponent, apply("log", base)))


def _exp(x: Node) -> Node:
    return apply("exp", x)


_IN_OTHERS: dict[str, Callable[..., Node]] = {
    "tan": lambda x: apply("sin", x) / apply("cos", x),
    "sinh": lambda x: (_exp(x) - _exp(-x)) * 0.5,
    "cosh": lambda x: (_exp(x) + _exp(-x)) * 0.5,
    "asin": lambda x: apply("atan", x / apply("sqrt", 1.0 - x * x)),
}
"""Operations that are made of others."""


# ── conditions: intervals of 0 and 1 ─────────────────────────────────────────────────


def _less(a: Forms, b: Forms) -> Intervals:
    gap = (a - b).bounds
    return Intervals((gap.high < 0.0).astype(float), (gap.low < 0.0).astype(float))


def _less_equal(a: Forms, b: Forms) -> Intervals:
    gap = (a - b).bounds
    return Intervals((gap.high <= 0.0).astype(float), (gap.low <= 0.0).astype(float))


def _equal(a: Forms, b: Forms) -> Intervals:
    one, two = a.bounds, b.bounds
    exactly = (a.radius == 0.0) & (b.radius == 0.0) & (a.centre == b.centre)
    apart = (one.high < two.low) | (two.high < one.low)
    return Intervals(exactly.astype(float), 1.0 - apart)


_CONDITIONS: dict[str, Callable[..., Intervals]] = {
    "less": _less,
    "less_equal": _less_equal,
    "equal": _equal,
    "both": lambda a, b: Intervals(np.minimum(a.low, b.low), np.minimum(a.high, b.high)),
    "either": lambda a, b: Intervals(np.maximum(a.low, b.low), np.maximum(a.high, b.high)),
    "negation": lambda a: Intervals(1.0 - a.high, 1.0 - a.low),
}


def _where(condition: Intervals, then: Forms, otherwise: Forms) -> Forms:
    """Return a choice; where the condition is open, what holds both."""
    yes, no = condition.low > 0.0, condition.high < 1.0
    if yes.all():
        return then
    if no.all():
        return otherwise
    half = (then - otherwise).scaled(0.5)
    middle = then - half
    both = Forms(middle.centre, middle.parts, middle.rest).within(half.radius)
    then, otherwise = aligned(then, otherwise)
    then, both = aligned(then, both)
    return Forms(
        *(
            np.where(yes, a, np.where(no, b, c))
            for a, b, c in zip(*map(_arrays, (then, otherwise, both)), strict=True)
        )
    )


def _arrays(forms: Forms) -> tuple[Any, ...]:
    return forms.centre, forms.parts, forms.rest


def _absolute(x: Forms) -> Forms:
    return larger(x, -x)


def _root(x: Forms) -> Forms:
    """Return the root of what is positive."""
    if np.any(x.bounds.low <= 0.0):
        raise EnclosureError("the root of an interval that holds 0 or negative numbers")
    return x.function("sqrt")


def _steep_root(x: Forms) -> Forms:
    """Return the root of what is known not to be negative, though its form may hold such numbers.

    √x - a x rises from 0 to its top 1/(4a) and falls: the least is at 0 or at the end.
    """
    bounds = x.bounds
    if (bounds.low > 0.0).all():
        return x.function("sqrt")
    high = np.maximum(bounds.high, 1e-290)
    steep = Intervals.at(1.0 / np.sqrt(high))
    end = square_root(Intervals.at(high)) - steep * Intervals.at(high)
    top = 0.25 / steep
    return x.scaled(steep.low) + Forms.between(np.minimum(end.low, 0.0), top.high)


def _is_never_negative(node: Node, value: Callable[[Node], Any]) -> bool:
    """Tell whether an expression cannot be negative, whatever its symbols are."""
    if isinstance(node, Constant):
        return node.value >= 0.0
    if isinstance(node, Symbol):
        return bool(np.all(value(node).bounds.low >= 0.0))
    assert isinstance(node, Apply)
    arguments = node.arguments
    if node.operation == "maximum":
        return any(_is_never_negative(each, value) for each in arguments)
    if node.operation == "multiply" and arguments[0] is arguments[1]:
        return True
    if node.operation in ("multiply", "divide", "add", "minimum"):
        return all(_is_never_negative(each, value) for each in arguments)
    return node.operation in ("absolute", "exp", "sqrt")


_READINGS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "negative": lambda a: -a,
    "sin": lambda a: a.function("sin"),
    "cos": lambda a: a.function("cos"),
    "exp": lambda a: a.function("exp"),
    "log": lambda a: a.function("log"),
    "tanh": lambda a: a.function("tanh"),
    "atan": lambda a: a.function("atan"),
    "sqrt": _root,
    "absolute": _absolute,
    "minimum": smaller,
    "maximum": larger,
    "where": _where,
    **_CONDITIONS,
}
"""What each operation is over forms."""


def read(roots: Sequence[Node], values: Mapping[str, Forms]) -> list[Forms]:
    """Return expressions over forms.

    Parameters
    ----------
    roots : sequence of Node
        Readable ones, see :func:`readable`.
    values : mapping of str to Forms
        Of the symbols.
    """
    made: dict[Node, Any] = {}
    shape = next(iter(values.values())).shape
    for node in postorder(*roots):
        if isinstance(node, Constant):
            made[node] = node.value
        elif isinstance(node, Symbol):
            made[node] = values[node.name]
        else:
            assert isinstance(node, Apply)
            arguments = [made[each] for each in node.arguments]
            made[node] = _applied(node, arguments, shape, made.__getitem__)
    return [_as_forms(made[root], shape) for root in roots]


def _as_forms(value: Any, shape: tuple[int, ...]) -> Any:
    return Forms.at(np.full(shape, value)) if isinstance(value, float) else value


def _applied(
    node: Apply, arguments: list[Any], shape: tuple[int, ...], value: Callable[[Node], Any]
) -> Any:
    """Return an operation; a product or a sum with a number is one with a number."""
    if node.operation == "sqrt" and _is_never_negative(node.arguments[0], value):
        return _steep_root(_as_forms(arguments[0], shape))
    if node.operation in ("add", "multiply", "subtract"):
        a, b = arguments
        if isinstance(a, float) and not isinstance(b, float):
            if node.operation == "subtract":
                return -b + a
            return b + a if node.operation == "add" else b.scaled(a)
        if isinstance(b, float) and not isinstance(a, float):
            if node.operation == "subtract":
                return a + (-b)
            return a + b if node.operation == "add" else a.scaled(b)
    if node.operation == "divide" and isinstance(arguments[1], float):
        return _as_forms(arguments[0], shape) / arguments[1]
    return _READINGS[node.operation](*(_as_forms(each, shape) for each in arguments))


# ── series ───────────────────────────────────────────────────────────────────────────


class _Buffer:
    """The coefficients of one node, filled in one after the other."""

    __slots__ = ("centre", "forms", "parts", "rest", "spread")

    def __init__(self, symbols: int, orders: int, batch: int) -> None:
        self.centre = np.zeros((orders, batch))
        self.parts = np.zeros((symbols, orders, batch))
        self.rest = np.zeros((orders, batch))
        self.spread = np.zeros((orders, batch))
        self.forms = Forms(self.centre, self.parts, self.rest, self.spread)

    def put(self, k: int, value: Forms) -> None:
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
        self.before: _Series | None = None
        self.filled: dict[Node, int] = {}

    def buffer(self, key: Any) -> _Buffer:
        """Return where the coefficients of a node stand."""
        found = self.buffers.get(key)
        if found is None:
            found = self.buffers[key] = _Buffer(self.symbols, self.orders, self.shape[0])
        return found

    def coefficient(self, node: Node, k: int) -> Any:
        """Return one coefficient: forms, a number, or a condition."""
        if isinstance(node, Constant):
            return node.value if k == 0 else 0.0
        if node in self.conditions:
            return self.conditions[node]
        if node in self.flow.steady and k > 0:
            return 0.0
        return self.buffer(node)[k]

    def advance(self, k: int) -> None:
        """Fill in the coefficients of order k."""
        for node in self.flow.order:
            if k > 0 and node in self.flow.steady:
                continue
            self._fill(node, k)

    def _fill(self, node: Apply, k: int) -> None:
        operation = node.operation
        if operation in _CONDITIONS:
            if k == 0:
                arguments = [
                    _as_forms(self.coefficient(each, 0), self.shape)
                    if each not in self.conditions
                    else self.conditions[each]
                    for each in node.arguments
                ]
                self.conditions[node] = _CONDITIONS[operation](*arguments)
            return
        if k == 0 and operation not in ("sin", "cos"):
            arguments = [self.coefficient(each, 0) for each in node.arguments]
            made = _applied(node, arguments, self.shape, lambda each: self.coefficient(each, 0))
            self.buffer(node).put(0, _as_forms(made, self.shape))
            return
        value = _RULES[operation](self, node, k)
        self.buffer(node).put(k, _as_forms(value, self.shape))

    def steps(self, x: Node, y: _Buffer, k: int) -> Forms:
        """Return (1/k) Σ j xⱼ yₖ₋ⱼ, the coefficient of what has the derivative y x'."""
        weights = np.arange(1, k + 1) / k  # within two roundings, as what is scaled allows for
        return dot(self.buffer(x)[1 : k + 1].scaled(weights[:, None]), y[k - 1 :: -1][:k])

    def choice(self, node: Node, first: Node, second: Node, k: int) -> Any:
        """Return the coefficient of one of two, where it is decided for the whole step."""
        decided = (self.before or self).decisions[node]
        a, b = self.coefficient(first, k), self.coefficient(second, k)
        if decided.all():
            return a
        if not decided.any():
            return b
        a, b = (_as_forms(each, self.shape) for each in (a, b))
        return _where(Intervals.at(decided.astype(float)), a, b)

    @property
    def decisions(self) -> _Decisions:
        """Which of two is chosen over the whole step."""
        return _Decisions(self)


class _Decisions:
    """Of each choice between two nodes: whether it is the first; CornerError where that is open."""

    def __init__(self, series: _Series) -> None:
        self.series = series

    def __getitem__(self, node: Node) -> NDArray[np.bool_]:
        assert isinstance(node, Apply)
        series = self.series
        if node.operation == "where":
            condition = series.conditions[node.arguments[0]]
        else:
            a, b = (
                _as_forms(series.coefficient(each, 0), series.shape)
                for each in (*node.arguments, constant(0.0))[:2]
            )
            first_is_less = node.operation == "minimum"
            condition = _less_equal(a, b) if first_is_less else _less_equal(b, a)
        if np.any(condition.low != condition.high):
            raise CornerError(f"a corner of '{node.operation}' within a step")
        return np.asarray(condition.low > 0.0)


Rule = Callable[[_Series, Apply, int], Any]


def _sum_rule(sign: float) -> Rule:
    def rule(series: _Series, node: Apply, k: int) -> Any:
        a, b = (series.coefficient(each, k) for each in node.arguments)
        if isinstance(b, float):
            return a + sign * b if isinstance(a, float) or b != 0.0 else a
        if isinstance(a, float):
            own = b if sign > 0 else -b
            return own + a if a != 0.0 else own
        return a + b if sign > 0 else a - b

    return rule


def _product_rule(series: _Series, node: Apply, k: int) -> Any:
    a, b = node.arguments
    steady = series.flow.steady
    if a in steady or isinstance(a, Constant):
        a, b = b, a
    if isinstance(b, Constant):
        own = series.coefficient(a, k)
        return own * b.value if isinstance(own, float) else own.scaled(b.value)
    if b in steady:
        return series.coefficient(b, 0) * _as_forms(series.coefficient(a, k), series.shape)
    return dot(series.buffer(a)[: k + 1], series.buffer(b)[k::-1])


def _quotient_rule(series: _Series, node: Apply, k: int) -> Any:
    a, b = node.arguments
    upper = _as_forms(series.coefficient(a, k), series.shape)
    if isinstance(b, Constant):
        return upper / b.value
    below = series.coefficient(b, 0)
    if b not in series.flow.steady:  # q b = a: qₖ b₀ = aₖ - Σ bⱼ qₖ₋ⱼ
        own = series.buffer(node)
        upper = upper - dot(series.buffer(b)[1 : k + 1], own[k - 1 :: -1][:k])
    return upper / below


def _negative_rule(series: _Series, node: Apply, k: int) -> Any:
    return -series.coefficient(node.arguments[0], k)


def _wave_rule(series: _Series, node: Apply, k: int) -> Any:
    (x,) = node.arguments
    names = ("sin", "cos") if node.operation == "sin" else ("cos", "sin")
    own, other = (series.buffer((name, x)) for name in names)
    if k == 0 and x not in series.filled:
        value = _as_forms(series.coefficient(x, 0), series.shape)
        own.put(0, value.function(names[0]))
        other.put(0, value.function(names[1]))
        series.filled[x] = 0
    elif series.filled[x] < k:
        sine, cosine = series.buffer(("sin", x)), series.buffer(("cos", x))
        sine.put(k, series.steps(x, cosine, k))
        cosine.put(k, -series.steps(x, sine, k))
        series.filled[x] = k
    return own[k]


def _exp_rule(series: _Series, node: Apply, k: int) -> Any:
    return series.steps(node.arguments[0], series.buffer(node), k)


def _root_rule(series: _Series, node: Apply, k: int) -> Any:
    # y y = x: 2 y₀ yₖ = xₖ - Σ yⱼ yₖ₋ⱼ, 0 < j < k.
    own = series.buffer(node)
    if np.any(series.coefficient(node.arguments[0], 0).bounds.low <= 0.0):
        raise CornerError("the root of 0 within a step")
    upper = series.coefficient(node.arguments[0], k)
    if k > 1:
        upper = upper - dot(own[1:k], own[k - 1 : 0 : -1])
    return upper.scaled(0.5) / own[0]


def _derived(slope: Callable[[_Series, Apply, int], Forms]) -> Rule:
    """Return the rule of y with y' = s x': `slope` gives the coefficients of s, below order k."""

    def rule(series: _Series, node: Apply, k: int) -> Any:
        held = series.buffer(("slope", node))
        held.put(k - 1, slope(series, node, k - 1))
        return series.steps(node.arguments[0], held, k)

    return rule


def _slope_of_log(series: _Series, node: Apply, k: int) -> Forms:
    x, held = series.buffer(node.arguments[0]), series.buffer(("slope", node))
    if k == 0:
        return x[0].function("reciprocal")
    return -(dot(x[1 : k + 1], held[k - 1 :: -1][:k]) * held[0])


def _slope_of_tanh(series: _Series, node: Apply, k: int) -> Forms:
    own = series.buffer(node)
    square = dot(own[: k + 1], own[k::-1])
    return -square + 1.0 if k == 0 else -square


def _slope_of_atan(series: _Series, node: Apply, k: int) -> Forms:
    x, held = series.buffer(node.arguments[0]), series.buffer(("slope", node))
    square = series.buffer(("square", node))
    square.put(k, dot(x[: k + 1], x[k::-1]))
    if k == 0:
        return (square[0] + 1.0).function("reciprocal")
    return -(dot(square[1 : k + 1], held[k - 1 :: -1][:k]) * held[0])


def _two_rule(series: _Series, node: Apply, k: int) -> Any:
    return series.choice(node, *node.arguments, k)


def _where_rule(series: _Series, node: Apply, k: int) -> Any:
    return series.choice(node, *node.arguments[1:], k)


def _absolute_rule(series: _Series, node: Apply, k: int) -> Any:
    (x,) = node.arguments
    positive = (series.before or series).decisions[node]
    own = _as_forms(series.coefficient(x, k), series.shape)
    return own.scaled(np.where(positive, 1.0, -1.0))


_RULES: dict[str, Rule] = {
    "add": _sum_rule(1.0),
    "subtract": _sum_rule(-1.0),
    "multiply": _product_rule,
    "divide": _quotient_rule,
    "negative": _negative_rule,
    "sin": _wave_rule,
    "cos": _wave_rule,
    "exp": _exp_rule,
    "log": _derived(_slope_of_log),
    "tanh": _derived(_slope_of_tanh),
    "atan": _derived(_slope_of_atan),
    "sqrt": _root_rule,
    "absolute": _absolute_rule,
    "minimum": _two_rule,
    "maximum": _two_rule,
    "where": _where_rule,
}
"""How a coefficient of order k follows from those below."""


# ── a step ───────────────────────────────────────────────────────────────────────────


class Step(NamedTuple):
    """What came of a step.

    Attributes
    ----------
    end : Forms
        The states afterwards, shape (states, batch).
    between : Intervals
        The states at all times of the step.
    bend : Intervals or None
        How far they are from the straight line between the ends; None where that is not known.
    remainder : ndarray
        How far the last term of the series may be off, shape (states, batch).
    """

    end: Forms
    between: Intervals
    bend: Intervals | None
    remainder: NDArray[np.float64]


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
        If they have an operation that forms have not.
    """

    rates: Sequence[Node]

    def __post_init__(self) -> None:
        self.rates = [readable(root) for root in self.rates]
        self.states = [f"x{i}" for i in range(len(self.rates))]
        nodes = list(postorder(*self.rates))
        moving = {*self.states, "t"}
        self.order = [node for node in nodes if isinstance(node, Apply)]
        self.symbols = [node for node in nodes if isinstance(node, Symbol)]
        self.steady: set[Node] = set()
        for node in nodes:
            if isinstance(node, Symbol) and node.name not in moving:
                self.steady.add(node)
            elif isinstance(node, Apply) and all(
                each in self.steady or isinstance(each, Constant) for each in node.arguments
            ):
                self.steady.add(node)

    def step(
        self, start: Forms, constants: Mapping[str, Forms], time: float, length: float, order: int
    ) -> Step:
        """Take one step.

        Parameters
        ----------
        start : Forms, shape (states, batch)
            The states.
        constants : mapping of str to Forms
            What does not change, each of shape (batch,).
        time, length : float
            When it begins and how long it is, s.
        order : int
            The highest power of h but one.

        Raises
        ------
        EnclosureError
            If no box is found that holds the solutions: the step is too long.
        """
        held = {name: Forms.of(value.bounds) for name, value in constants.items()}
        box = self._box(start.bounds, held, time, length)
        try:
            return self._taylor(start, constants, held, box, time, length, order)
        except CornerError:
            return self._mean(start, constants, box, time, length)

    # ── the box ──────────────────────────────────────────────────────────────────────

    def rates_over(self, states: Forms, constants: Mapping[str, Forms], time: Intervals) -> Forms:
        """Return the rates, shape (states, batch)."""
        batch = states.shape[1:]
        values = {**constants, **{name: states[i] for i, name in enumerate(self.states)}}
        values["t"] = Forms.between(np.full(batch, time.low), np.full(batch, time.high))
        return stacked(read(self.rates, values))

    def _box(
        self, start: Intervals, held: Mapping[str, Forms], time: float, length: float
    ) -> Intervals:
        times = Intervals.between(time, np.nextafter(time + length, np.inf))
        span = Intervals.between(np.zeros(start.shape), np.full(start.shape, length))
        box, grown = start, 1.05
        for _ in range(14):
            moved = start + self.rates_over(Forms.of(box), held, times).bounds * span
            if not np.isfinite(moved.size).all():
                break
            if np.all((box.low < moved.low) & (moved.high < box.high)):
                again = start + self.rates_over(Forms.of(moved), held, times).bounds * span
                return again.meet(moved)
            reach = moved.hull(start)
            extra = (grown - 1.0) * (reach.high - reach.low) + 1e-12 * (1.0 + reach.size)
            box, grown = Intervals(reach.low - extra, reach.high + extra), grown + 0.1
        raise EnclosureError("no box was found that holds the solutions of a step")

    # ── the series ───────────────────────────────────────────────────────────────────

    def _taylor(
        self,
        start: Forms,
        constants: Mapping[str, Forms],
        held: Mapping[str, Forms],
        box: Intervals,
        time: float,
        length: float,
        order: int,
    ) -> Step:
        times = Intervals.between(time, np.nextafter(time + length, np.inf))
        over = self._series(Forms.of(box), held, times, order + 1, None)
        last = stacked([over.buffer(_state(i))[order + 1] for i in range(len(self.states))])
        own = self._series(start, constants, Intervals.at(time), order, over)
        power = Intervals.at(1.0)
        for _ in range(order + 1):
            power = power * length
        tail = last.bounds * power
        total = stacked([own.buffer(_state(i))[order] for i in range(len(self.states))])
        for k in range(order - 1, -1, -1):
            lower = stacked([own.buffer(_state(i))[k] for i in range(len(self.states))])
            total = total.scaled(length) + lower
        end = total + Forms.of(tail)
        # On the way: the straight line between the ends, less ½ s (h - s) x''.
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
        """Return the coefficients of the solutions up to an order; `before`: over the box."""
        batch = start.shape[1]
        count = max(len(start.parts), *(len(each.parts) for each in constants.values()), 0)
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
                rate = _as_forms(series.coefficient(root, k), (batch,))
                # 1/(k+1) is rounded once more; what is scaled allows for two roundings.
                series.buffer(_state(i)).put(k + 1, rate.scaled(1.0 / (k + 1)))
        return series

    # ── where there is a corner ──────────────────────────────────────────────────────

    def _mean(
        self,
        start: Forms,
        constants: Mapping[str, Forms],
        box: Intervals,
        time: float,
        length: float,
    ) -> Step:
        times = Intervals.between(time, np.nextafter(time + length, np.inf))
        held = {name: Forms.of(value.bounds) for name, value in constants.items()}
        rates = self.rates_over(Forms.of(box), held, times).bounds
        span = Intervals.between(np.zeros(box.shape), np.full(box.shape, length))
        on_the_way = start + Forms.of(rates * span)
        mean = self.rates_over(on_the_way, constants, times)
        end = start + mean.scaled(length)
        return Step(end, box, None, (mean.rest + mean.spread) * 0.0 + length * rates.radius)


def _state(index: int) -> Symbol:
    return symbol(f"x{index}")


def stacked(forms: Sequence[Forms]) -> Forms:
    """Return forms of one shape along a new first axis."""
    count = max(len(each.parts) for each in forms)
    every = [each if len(each.parts) == count else each.with_symbols(count) for each in forms]
    return Forms(
        np.stack([each.centre for each in every]),
        np.stack([each.parts for each in every], axis=1),
        np.stack([each.rest for each in every]),
        np.stack([each.spread for each in every]),
    )
