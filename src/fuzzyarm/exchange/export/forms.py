"""Properties of an expression by its form: NaN propagation, sign, common parts."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Sequence

from fuzzyarm.symbolic.evaluation import specialise
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, Symbol, children, postorder, rebuilt
from fuzzyarm.symbolic.operations import OPERATIONS

_CARRYING = {"add", "subtract", "multiply", "divide", "negative", "absolute"}
"""Operations that propagate NaN."""


def nan_sources(value: Node) -> set[str]:
    """Return the symbols whose NaN makes a value NaN."""
    if isinstance(value, Symbol):
        return {value.name}
    if isinstance(value, Apply) and value.operation in _CARRYING:
        return set[str]().union(*map(nan_sources, value.arguments))
    return set()


NOT_A_NUMBER, _LOW, _HIGH = "nan", "-inf", "inf"


def endless(value: Node, states: Collection[str]) -> set[str]:
    """Return which of NaN, -inf and inf a value may be, by its form; states are finite."""
    if isinstance(value, Constant):
        return set() if math.isfinite(value.value) else {NOT_A_NUMBER, _LOW, _HIGH}
    if isinstance(value, Symbol):
        # Signals and inputs are numbers, intermediate results need not be.
        ways = {NOT_A_NUMBER, _LOW, _HIGH} if value.name.startswith("local:") else {_LOW, _HIGH}
        return set() if value.name in states else ways
    if not isinstance(value, Apply) or value.operation != "where":
        return {NOT_A_NUMBER, _LOW, _HIGH}
    condition, then, otherwise = value.arguments
    ways = endless(then, states)
    # Of two compared values the smaller one is not inf, and neither is NaN.
    if isinstance(condition, Apply) and condition.operation in {"less", "less_equal"}:
        small, large = condition.arguments
        if then is small:
            ways -= {NOT_A_NUMBER, _HIGH}
        elif then is large:
            ways -= {NOT_A_NUMBER, _LOW}
    return ways | endless(otherwise, states)


def folded(node: Node) -> Node:
    """Return the number for an operation on numbers."""
    assert isinstance(node, Apply)
    known = all(isinstance(argument, Constant) for argument in node.arguments)
    return specialise(node, {}) if known else node


def without_endless_limits(root: Node) -> Node:
    """Return an expression without limits at infinity, which change no number."""

    def limited(node: Node, new: Node) -> Node:
        if isinstance(node, Apply) and node.operation == "where":
            condition, value, limit = node.arguments
            endless = isinstance(limit, Constant) and math.isinf(limit.value)
            compared = condition.arguments if isinstance(condition, Apply) else ()
            if endless and set(compared) == {value, limit}:
                assert isinstance(new, Apply)
                return new.arguments[1]
        return new

    return rebuilt(root, limited)


def shared(roots: Sequence[Node]) -> Node | None:
    """Return an innermost part used more than once; a condition does not become a variable."""
    nodes = list(postorder(*roots))
    uses = Counter(child for node in nodes for child in children(node))
    uses.update(roots)
    for node in nodes:
        condition = isinstance(node, Apply) and OPERATIONS[node.operation].is_condition
        if isinstance(node, Apply) and uses[node] > 1 and not condition:
            return node
    return None
