"""Expressions as short programs of operations: data that machine code walks.

A shape, a norm or a plant of a user's own is not known when fuzzyarm is built. As a program it is
an array of floats, and the walker is part of the machine code
(:mod:`fuzzyarm.apps.native.walker`), so nothing is compiled when it is met. In the order of memory:

============  ==============================================================================
head          how many rows, numbers, constants, instructions and results
constants     one float each
instructions  four floats each: the operation by its place in the table, and which values it
              takes
results       which values are asked for
============  ==============================================================================

Values are counted in this order: rows (element by element), numbers (the same for all elements),
constants, then what each instruction gives.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from fuzzyarm.symbolic.nodes import Apply, Constant, Node, postorder, symbol
from fuzzyarm.symbolic.operations import OPERATIONS

__all__ = ["HEAD", "INSTRUCTION", "program_of"]

HEAD = 5
"""Floats in front of the constants."""

INSTRUCTION = 4
"""Floats of an instruction."""

_CODES = {name: code for code, name in enumerate(OPERATIONS)}


def program_of(
    roots: Sequence[Node], rows: Sequence[str], numbers: Sequence[str] = ()
) -> array[float]:
    """Return expressions as one program; a part that several have is computed once.

    Parameters
    ----------
    roots : sequence of Node
        What is asked for; their symbols are among `rows` and `numbers`.
    rows : sequence of str
        Symbols that differ from element to element.
    numbers : sequence of str
        Symbols that are the same for all elements.

    Raises
    ------
    KeyError
        With the name of a symbol that has no value.
    """
    order = dict.fromkeys(node for root in roots for node in postorder(root))
    constants = [node for node in order if isinstance(node, Constant)]
    steps = [node for node in order if isinstance(node, Apply)]
    values: dict[Node, int] = {}
    for node in (*map(symbol, (*rows, *numbers)), *constants, *steps):
        values[node] = len(values)
    program = array("d", [len(rows), len(numbers), len(constants), len(steps), len(roots)])
    program.extend(node.value for node in constants)
    for step in steps:
        operands = [_value_of(argument, values) for argument in step.arguments]
        program.extend(
            [_CODES[step.operation], *operands, *([0] * (INSTRUCTION - 1 - len(operands)))]
        )
    program.extend(_value_of(root, values) for root in roots)
    return program


def _value_of(node: Node, values: dict[Node, int]) -> int:
    if node not in values:
        raise KeyError(getattr(node, "name", str(node)))
    return values[node]
