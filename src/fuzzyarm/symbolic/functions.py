"""Expressions as Python functions: over floats, and over rows for a compiler.

The text comes from :mod:`fuzzyarm.symbolic.printing`. A function over floats uses the plain
operators of Python; where they raise, it falls back to the slow evaluation, which gives NaN or an
infinity. So the common case is as fast as a handwritten function.
"""

from __future__ import annotations

import builtins
import linecache
import math
from collections.abc import Callable, Sequence
from typing import Any

from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.nodes import Apply, Node, symbol, symbols
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.printing import PYTHON, printed

_STEPS = {"floor": "floor", "ceil": "ceil", "rint": "round", "trunc": "truncate"}
"""Operations by their names in the printed text, where these are not functions of :mod:`math`."""


_OWN: dict[str, Callable[..., float]] = {"minimum": min, "maximum": max}
"""Operations that are builtins of Python, for speed."""


def _namespace() -> dict[str, Any]:
    namespace: dict[str, Any] = {
        name: function for name, function in vars(math).items() if not name.startswith("_")
    }
    namespace |= {word: OPERATIONS[name].scalar for word, name in _STEPS.items()}
    namespace |= {name: getattr(builtins, name) for name in ("abs", "min", "max", "float")}
    return namespace


def python_function(root: Node, parameters: Sequence[str]) -> Callable[..., float]:
    """Return a Python function of floats that computes an expression.

    Parameters
    ----------
    root : Node
        The expression; its symbols are among `parameters`.
    parameters : sequence of str
        Names of the arguments, in order; Python identifiers.

    Returns
    -------
    callable
        Takes as many floats; returns a float, NaN or infinite as in IEEE arithmetic.
    """
    names = tuple(parameters)
    if isinstance(root, Apply) and root.arguments == tuple(symbol(name) for name in names):
        return _OWN.get(root.operation, OPERATIONS[root.operation].scalar)
    lines, result = printed(root, PYTHON, reserved=names)
    body = "\n".join(f"        {line}" for line in [*lines, f"return {result}"])
    arguments = ", ".join(names)
    source = (
        f"def _value({arguments}):\n    try:\n{body}\n"
        f"    except (ArithmeticError, ValueError):\n        return _quiet({arguments})\n"
    )

    def quiet(*values: float) -> float:
        return evaluate(root, dict(zip(names, values, strict=True)))

    space = _namespace() | {"_quiet": quiet}
    exec(source, space)
    function: Callable[..., float] = space["_value"]
    return function


def row_source(root: Node, rows: Sequence[str], numbers: Sequence[str], name: str) -> str:
    """Return the text of a function over rows, simple enough for a compiler.

    Parameters
    ----------
    root : Node
        The expression.
    rows : sequence of str
        Symbols read from rows, element by element.
    numbers : sequence of str
        Symbols constant over all elements, together in one array ``numbers``.
    name : str
        Name of the function.

    Returns
    -------
    str
        ``def name(rows …, numbers, into)``; it fills `into`.
    """
    lines, result = printed(root, PYTHON, reserved=(*rows, *numbers))
    names = symbols(root)
    head = [f"{number} = numbers[{i}]" for i, number in enumerate(numbers) if number in names]
    elements = [f"{row} = {row}_row[i]" for row in rows if row in names]
    body = [*elements, *lines, f"into[i] = {result}"]
    arguments = ", ".join([*(f"{row}_row" for row in rows), "numbers", "into"])
    # The count of numbers, used or not, is part of the identity: its program of operations counts
    # them all, and functions with equal text are treated as one.
    text = [f"def {name}({arguments}):  # numbers: {len(numbers)}"]
    text += [f"    {line}" for line in head]
    text += ["    for i in range(into.shape[0]):", *(f"        {line}" for line in body)]
    return "\n".join(text) + "\n"


def row_function(source: str, name: str) -> Callable[..., None]:
    """Return the function of a text by :func:`row_source`, for the interpreter.

    Roundings are those of NumPy, which return floats.
    """
    from hashlib import sha256

    space = _namespace() | {"__name__": __name__}
    if any(f"{word}(" in source for word in _STEPS):
        import numpy as np

        space |= {word: getattr(np, word) for word in _STEPS}
    file = f"<row {name}>"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    exec(compile(source, file, "exec"), space)
    function: Callable[..., None] = space[name]
    function.__source__ = source  # type: ignore[attr-defined]
    function.__digest__ = sha256(source.encode()).hexdigest()[:16]  # type: ignore[attr-defined]
    return function
