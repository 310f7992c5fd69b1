"""Expressions as short programs of operations: data for an interpreter in machine code.

A user's shape, norm or plant is unknown when fuzzyarm is built. As a program it is an array of
floats, and its interpreter is part of the machine code (:mod:`fuzzyarm.apps.native.printing`), so
nothing is compiled at run time. In the order of memory:

============  ==============================================================================
head          numbers of rows, numbers, constants, instructions and results
constants     one float each
instructions  four floats each: index of the operation in the table, indices of its operands
results       indices of the results
============  ==============================================================================

Values are numbered in this order: rows (element by element), numbers (constant over the
elements), constants, then the value of each instruction.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from fuzzyarm.symbolic.nodes import Apply, Constant, Node, postorder, symbol
from fuzzyarm.symbolic.operations import OPERATIONS

HEAD = 5
"""Floats of the head."""

INSTRUCTION = 4
"""Floats of an instruction."""

_CODES = {name: code for code, name in enumerate(OPERATIONS)}


def program_of(
    roots: Sequence[Node], rows: Sequence[str], numbers: Sequence[str] = ()
) -> array[float]:
    """Return expressions as one program; common parts are computed once.

    Parameters
    ----------
    roots : sequence of Node
        The results; their symbols are among `rows` and `numbers`.
    rows : sequence of str
        Symbols that vary over the elements.
    numbers : sequence of str
        Symbols constant over all elements.

    Raises
    ------
    KeyError
        With the name of a symbol without a value.
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
