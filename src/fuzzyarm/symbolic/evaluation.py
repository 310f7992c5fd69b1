"""Evaluation of an expression: numbers, arrays and bounds; its derivative.

Each is one walk over the graph, arguments first, with a look-up of every operation in
:data:`~fuzzyarm.symbolic.operations.OPERATIONS`. Frequent evaluations use compiled source text
instead, see :mod:`fuzzyarm.symbolic.printing`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

from fuzzyarm.symbolic.nodes import (
    Apply,
    Constant,
    Node,
    Number,
    apply,
    as_node,
    children,
    constant,
    postorder,
    replace,
    symbol,
)
from fuzzyarm.symbolic.operations import EVERYTHING, OPERATIONS, Interval


def evaluate(root: Node, values: Mapping[str, float]) -> float:
    """Return the value of an expression at one point.

    Parameters
    ----------
    root : Node
        The expression.
    values : mapping of str to float
        A value for every symbol.

    Returns
    -------
    float
        NaN or infinite as in IEEE arithmetic (1 / 0, the root of -1); never raises for these.

    Raises
    ------
    KeyError
        With the name of a symbol that has no value.
    """
    values_of_nodes: dict[Node, Any] = {}
    for node in postorder(root):
        if isinstance(node, Apply):
            arguments = (values_of_nodes[argument] for argument in node.arguments)
            values_of_nodes[node] = OPERATIONS[node.operation].scalar(*arguments)
        elif isinstance(node, Constant):
            values_of_nodes[node] = node.value
        else:
            values_of_nodes[node] = values[node.name]  # type: ignore[attr-defined]
    return float(values_of_nodes[root])


def specialise(root: Node, values: Mapping[str, float]) -> Node:
    """Return an expression with numbers for some symbols, constants folded.

    A part without symbols becomes its value, with the bits of :func:`evaluate`, and a choice with a
    constant condition its branch. Nothing else is simplified: x + 0 stays.
    """
    nodes: dict[Node, Node] = {}
    for node in postorder(replace(root, values)):
        nodes[node] = _folded(node, nodes) if isinstance(node, Apply) else node
    return nodes[node]


def _folded(node: Apply, nodes: Mapping[Node, Node]) -> Node:
    arguments = [nodes[argument] for argument in node.arguments]
    if node.operation == "where" and isinstance(arguments[0], Constant):
        return arguments[1] if arguments[0].value else arguments[2]
    constants = [argument.value for argument in arguments if isinstance(argument, Constant)]
    if len(constants) == len(arguments):
        return constant(float(OPERATIONS[node.operation].scalar(*constants)))
    if node.operation in {"both", "either"} and constants:
        decides = bool(constants[0]) == (node.operation == "either")
        rest = next(argument for argument in arguments if not isinstance(argument, Constant))
        return constant(constants[0]) if decides else rest
    return apply(node.operation, *arguments)


@cache
def array_function(name: str) -> Callable[..., Any]:
    """Return an operation over arrays; of equal arguments it returns the first, as over floats."""
    import numpy as np

    if name == "minimum":
        return lambda a, b: np.where(np.less(b, a), b, a)
    if name == "maximum":
        return lambda a, b: np.where(np.greater(b, a), b, a)
    if name == "where":
        return _where
    function: Callable[..., Any] = getattr(np, OPERATIONS[name].array)
    return function


@cache
def library_function(name: str) -> Callable[..., Any]:
    """Return a function of the C library over arrays, element by element, with its bits.

    NumPy's vectorised functions differ in the last bit for one value in twenty.
    """
    import numpy as np

    scalar = OPERATIONS[name].scalar
    plain = getattr(scalar, "__wrapped__", scalar)  # raises outside the domain

    def function(*arguments: Any) -> Any:
        arrays = [np.asarray(argument, dtype=float) for argument in arguments]
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
        columns = [
            np.broadcast_to(array, shape).ravel().tolist()
            if array.ndim
            else [float(array)] * math.prod(shape)
            for array in arrays
        ]
        try:
            values = np.fromiter(map(plain, *columns), float, math.prod(shape))
        except (ArithmeticError, ValueError):
            values = np.fromiter(map(scalar, *columns), float, math.prod(shape))
        return values.reshape(shape)

    return function


def _where(condition: Any, then: Any, otherwise: Any) -> Any:
    import numpy as np

    if np.ndim(condition) == 0:  # a scalar condition: only its branch is valid
        return then if condition else otherwise
    return np.where(condition, then, otherwise)


Schedule = Sequence[tuple[Node, tuple[Node, ...]]]


def schedule(root: Node) -> Schedule:
    """Return the nodes in order, arguments first, each with the nodes last used by it.

    An array freed at once is still in the cache when its memory is reused.
    """
    order = list(postorder(root))
    last = {argument: node for node in order for argument in children(node)}
    last_uses: dict[Node, list[Node]] = {node: [] for node in order}
    for argument, node in last.items():
        last_uses[node].append(argument)
    return [(node, tuple(arguments)) for node, arguments in last_uses.items()]


def evaluate_arrays(
    root: Node,
    values: Mapping[str, Any],
    real: type = float,
    order: Schedule | None = None,
    *,
    as_floats: bool = False,
) -> Any:
    """Return the value of an expression over arrays that broadcast.

    Parameters
    ----------
    root : Node
        The expression.
    values : mapping of str to array_like
        A value for every symbol.
    real : type
        Of the constants: ``float``, or ``numpy.float32`` for arithmetic in single precision.
    order : sequence, optional
        The result of :func:`schedule`, shared by many calls with large arrays.
    as_floats : bool
        Evaluate functions such as ``exp`` element by element, fifty times slower.

    Returns
    -------
    ndarray
        Bitwise equal to :func:`evaluate` at each point where an operation is exact or correctly
        rounded (+ − × ÷, roots, min, max), within about 1e-16 of the value elsewhere; with
        `as_floats` everywhere. Both branches of a choice are evaluated; NumPy does not warn of
        the one not taken.
    """
    import numpy as np

    values_of_nodes: dict[Node, Any] = {}
    with np.errstate(all="ignore"):
        for node, last_uses in ((node, ()) for node in postorder(root)) if order is None else order:
            if isinstance(node, Apply):
                arguments = (values_of_nodes[argument] for argument in node.arguments)
                is_of_library = as_floats and OPERATIONS[node.operation].of_library
                function = (library_function if is_of_library else array_function)(node.operation)
                values_of_nodes[node] = function(*arguments)
            elif isinstance(node, Constant):
                values_of_nodes[node] = np.dtype(real).type(node.value)
            else:
                values_of_nodes[node] = values[node.name]  # type: ignore[attr-defined]
            for argument in last_uses:
                del values_of_nodes[argument]
    return values_of_nodes[root]


# ── derivative ───────────────────────────────────────────────────────────────────────

_ZERO, _ONE = constant(0.0), constant(1.0)


def derivative(root: Node, name: str) -> Node:
    """Return the derivative of an expression by one of its symbols, as an expression.

    At a corner it is a one-sided derivative; at a jump that of the branch taken there.
    """
    return gradient(root, (name,))[0]


def gradient(root: Node, names: tuple[str, ...]) -> tuple[Node, ...]:
    """Return the derivatives of an expression by several of its symbols.

    Reverse accumulation: every node is visited once, whatever the number of names.
    """
    order = list(postorder(root))
    adjoint: dict[Node, Node] = {root: _ONE}
    for node in reversed(order):
        if node not in adjoint or not isinstance(node, Apply):
            continue
        partials = OPERATIONS[node.operation].partials
        if partials is None:  # a condition or a step: derivative 0 almost everywhere
            continue
        for argument, partial in zip(node.arguments, partials(*node.arguments), strict=True):
            share = _product(adjoint[node], partial)
            if share is not _ZERO:
                earlier = adjoint.get(argument)
                adjoint[argument] = share if earlier is None else earlier + share
    return tuple(adjoint.get(symbol(name), _ZERO) for name in names)


def _product(a: Number, b: Number) -> Node:
    """Return a b without factors 0 and 1, frequent in derivatives.

    A choice between a value and 0 stays a choice: 0 times the other branch may be NaN.
    """
    for choice, factor in ((a, b), (b, a)):
        if isinstance(choice, Apply) and choice.operation == "where":
            condition, then, otherwise = choice.arguments
            return apply("where", condition, _product(then, factor), _product(otherwise, factor))
    if a is _ZERO or b is _ZERO:
        return _ZERO
    if a is _ONE:
        return as_node(b)
    return as_node(a) if b is _ONE else as_node(a) * b


# ── bounds ───────────────────────────────────────────────────────────────────────────


def bounds(root: Node, ranges: Mapping[str, tuple[float, float]]) -> Interval:
    """Return an enclosure of an expression over a box (interval arithmetic).

    Safe, not tight: repeated symbols count as independent, except that a choice takes only the
    branches that can hold.

    Parameters
    ----------
    root : Node
        The expression.
    ranges : mapping of str to (float, float)
        Lower and upper end of each symbol.

    Returns
    -------
    Interval
        Rounded outwards: it encloses values of floats and of real numbers. Undefined values (the
        root of -1) need not be contained.

    References
    ----------
    R. E. Moore, *Interval Analysis*, 1966: natural interval extension, operation by operation.
    """
    return _bounds_of_nodes(root, ranges)[root]


def _bounds_of_nodes(root: Node, ranges: Mapping[str, tuple[float, float]]) -> dict[Node, Interval]:
    intervals: dict[Node, Interval] = {}
    for node in postorder(root):
        if isinstance(node, Constant):
            intervals[node] = Interval(node.value, node.value)
        elif isinstance(node, Apply):
            operation = OPERATIONS[node.operation]
            arguments = [intervals[argument] for argument in node.arguments]
            intervals[node] = _rounded(operation.bounds(*arguments), exact=operation.exact)
        else:
            intervals[node] = Interval(*ranges[node.name])  # type: ignore[attr-defined]
    return intervals


_DOMAINS: dict[str, Callable[..., bool]] = {
    "divide": lambda a, b: not b.low <= 0.0 <= b.high,
    "remainder": lambda a, b: not b.low <= 0.0 <= b.high,
    "power": lambda a, b: a.low > 0.0 or (b.low == b.high >= 0.0 and b.low % 1.0 == 0.0),
    "sqrt": lambda a: a.low >= 0.0,
    "log": lambda a: a.low > 0.0,
    "log10": lambda a: a.low > 0.0,
    "asin": lambda a: a.low >= -1.0 and a.high <= 1.0,
    "acos": lambda a: a.low >= -1.0 and a.high <= 1.0,
}
"""For partial operations: whether they are defined everywhere on given intervals."""


def may_lack_values(root: Node) -> bool:
    """Whether a part of an expression is undefined for some arguments, overflow aside."""
    return any(isinstance(node, Apply) and node.operation in _DOMAINS for node in postorder(root))


def has_value(root: Node, ranges: Mapping[str, tuple[float, float]]) -> bool:
    """Whether interval arithmetic shows that an expression is finite everywhere in a box."""
    intervals = _bounds_of_nodes(root, ranges)
    for node, interval in intervals.items():
        if not (math.isfinite(interval.low) and math.isfinite(interval.high)):
            return False
        domain = _DOMAINS.get(node.operation) if isinstance(node, Apply) else None
        if domain and not domain(*(intervals[argument] for argument in children(node))):
            return False
    return True


def _rounded(interval: Interval, *, exact: bool) -> Interval:
    low, high = interval
    if math.isnan(low) or math.isnan(high):
        return EVERYTHING
    if exact:
        return interval
    # Two units in the last place: the error of functions of a C library.
    for _ in range(2):
        low, high = math.nextafter(low, -math.inf), math.nextafter(high, math.inf)
    return Interval(low, high)
