"""Updates of sources as functions by address, and the layout of their numbers in the cells.

Each line with a source has a **frame** of cells, in this order: the value of the source, its
states, and the other arguments of its update: its operand, the period, then constants of its
options and values fetched from other cells in every period. The function takes the arguments as
one array and overwrites value and states, the beginning of the frame.

Updates of built-in sources are part of the machine code; any other one is a program of operations
(:mod:`fuzzyarm.symbolic.programs`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

from fuzzyarm.symbolic.evaluation import bounds, evaluate
from fuzzyarm.symbolic.functions import row_function
from fuzzyarm.symbolic.intervals import hull
from fuzzyarm.symbolic.kernels import address_of
from fuzzyarm.symbolic.nodes import Node, replace, substituted, symbol
from fuzzyarm.symbolic.operations import EVERYTHING, Interval
from fuzzyarm.symbolic.printing import PYTHON, setting, statements, variables
from fuzzyarm.symbolic.programs import program_of
from fuzzyarm.symbolic.sources import VALUE, SourceKind, Surroundings, unseen

UPDATE_ARRAYS = "ff"
"""Arguments; value and states."""


def update_address(kind: SourceKind, *, compiled: bool) -> int:
    """Return the address of the update of a source."""
    function = update_function(kind) if compiled else _interpreted(kind)
    return address_of(function, UPDATE_ARRAYS, compiled=compiled)


@cache
def update_function(kind: SourceKind) -> Callable[[Any, Any], None]:
    """Return the update of a source as a function from its arguments to value and states."""
    name = f"{kind.name.replace('-', '_')}_update"
    function: Any = row_function(_source(kind, name), name)
    function.__program__ = lambda: program_of(_roots(kind), (), kind.symbols)
    return function  # type: ignore[no-any-return]


def _roots(kind: SourceKind) -> list[Node]:
    """Return value and next states, as expressions over the arguments."""
    nodes = {VALUE: kind.expression}
    return [kind.expression, *(replace(root, nodes) for root in kind.nexts)]


def _source(kind: SourceKind, name: str) -> str:
    """Return the text of an update; everything is computed before any result is stored."""
    body = [f"{symbol} = arguments[{index}]" for index, symbol in enumerate(kind.symbols)]
    results = [VALUE, *(f"next_{state.name}" for state in kind.states)]
    names = {*kind.symbols, *results, "arguments", "into"}
    for into, root in zip(results, (kind.expression, *kind.nexts), strict=True):
        parts, result = statements(root, reserved=names)
        names |= set(variables(parts))
        body += PYTHON.lines(setting(into, parts, result))
    body += (f"into[{index}] = {result}" for index, result in enumerate(results))
    return "\n".join([f"def {name}(arguments, into):", *(f"    {line}" for line in body)]) + "\n"


@cache
def _interpreted(kind: SourceKind) -> Callable[[Any, Any], None]:
    """Return the update as plain Python, NaN where arithmetic is undefined."""
    function, roots = update_function(kind), _roots(kind)

    def interpreted(arguments: Any, into: Any) -> None:
        try:
            function(arguments, into)
        except (ArithmeticError, ValueError):
            values = {name: float(arguments[i]) for i, name in enumerate(kind.symbols)}
            results = [evaluate(root, values) for root in roots]
            for index, value in enumerate(results):
                into[index] = value

    return interpreted


# ── ranges ─────────────────────────────────────────────────────────────────────

MOST_PERIODS = 32
"""Periods followed one by one; bounds that still grow after these are widened to infinity."""


def range_of_source(
    kind: SourceKind, near: Surroundings, settings: dict[str, Interval], starts: list[float]
) -> Interval:
    """Return an interval around all values of a source."""
    if kind.bounds is not None:
        return kind.bounds(near)
    period = Interval(near.period, near.period)
    ranges = {
        "x": near.at, "period": period, "last": Interval(0.0, 1.0), "excess": EVERYTHING,
        "gain": EVERYTHING, **settings,
    }  # fmt: skip
    roots = [_first_known(root, kind) for root in _roots(kind)]
    for state, start in zip(kind.states, starts, strict=True):
        begins_unset = math.isnan(start)
        ranges[state.name] = EVERYTHING if begins_unset else Interval(start, start)
        ranges[_unseen(state.name)] = Interval(float(begins_unset), float(begins_unset))
    value: Interval | None = None
    for period_number in range(2 * MOST_PERIODS):
        result, *nexts = (bounds(root, ranges) for root in roots)
        before = value, dict(ranges)
        value = result if value is None else hull(value, result)
        for state, start, after in zip(kind.states, starts, nexts, strict=True):
            first = period_number == 0 and math.isnan(start)
            interval = after if first else hull(ranges[state.name], after)
            if period_number >= MOST_PERIODS:
                interval = _widened(ranges[state.name], interval)
            ranges[state.name] = interval
            ranges[_unseen(state.name)] = Interval(0.0, 0.0)
        if before == (value, ranges):
            break
    else:
        return EVERYTHING
    return value


def _unseen(state: str) -> str:
    """Return the symbol of the condition that a state has no value yet."""
    return f"unseen {state}"


def _first_known(root: Node, kind: SourceKind) -> Node:
    """Return an expression with that condition as a symbol, which has an interval."""
    for state in kind.states:
        root = substituted(root, unseen(symbol(state.name)), symbol(_unseen(state.name)))
    return root


def _widened(before: Interval, after: Interval) -> Interval:
    """Return an interval without bound on the side of its growth."""
    low = after.low if after.low >= before.low else -math.inf
    return Interval(low, after.high if after.high <= before.high else math.inf)
