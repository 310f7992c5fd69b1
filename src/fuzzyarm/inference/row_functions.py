"""Functions of rows by number: norms, curved terms, hedges and programs, as a layout names them.

A layout stores the number of each function from its :class:`Addresses`: an address of machine code
here (:class:`InMemory`), an index into a table in a program of another language.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple, Protocol, cast

from fuzzyarm.inference import block as at
from fuzzyarm.inference.programs import DefuzzifierProgram
from fuzzyarm.inference.sets import degree_formula
from fuzzyarm.language.model.rulebase import POSITION, Hedge, Shape
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.functions import row_function, row_source
from fuzzyarm.symbolic.kernels import address_of, call, kernel, whole_numbers
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, Norm
from fuzzyarm.symbolic.lines import degree_on_corners
from fuzzyarm.symbolic.nodes import Node, constant, replace, symbol, symbols
from fuzzyarm.symbolic.printing import PYTHON, printed
from fuzzyarm.symbolic.programs import program_of

_OWN_NORMS = {
    ("T", "min"): at.MIN, ("T", "product"): at.PRODUCT, ("S", "max"): at.MAX, ("S", "sum"): at.SUM,
}  # fmt: skip


@lru_cache(maxsize=512)
def _row_function(
    root: Node, rows: tuple[str, ...], numbers: tuple[str, ...], name: str
) -> Callable[..., None]:
    """Return the row function of an expression; the last ones are cached."""
    word = f"{name.replace('-', '_')}_row"
    function: Any = row_function(row_source(root, rows, numbers, word), word)
    function.__program__ = lambda: program_of([root], rows, numbers)

    def quiet(*arrays: Any) -> None:
        *columns, values, into = arrays
        known = dict(zip(numbers, values, strict=False))
        for i in range(into.shape[0]):
            here = {row: column[i] for row, column in zip(rows, columns, strict=True)}
            into[i] = evaluate(root, known | here)

    function.__quiet__ = quiet
    return cast("Callable[..., None]", function)


def norm_row(norm: Norm) -> Callable[..., None]:
    """Return a norm as a function of two rows."""
    return _row_function(norm.expression, norm.symbols, (), norm.name)


class Curve(NamedTuple):
    """A term with degrees by a row function, and its numbers."""

    address: int
    numbers: tuple[float, ...]


def curve_of(shape: Shape, hedges: tuple[Hedge, ...], *, compiled: bool) -> Curve:
    """Return the row function of a term under hedges.

    Terms that differ only in their numbers share it: a straight one is a list of corners; shape,
    height and hedges of a curved one become one expression of `x` and its numbers.
    """
    if SHAPES[shape.kind].straight:
        corners = [number for corner in polyline(shape) for number in corner]
        if not hedges:
            return Curve(address_of(corners_row, 3, compiled=compiled), tuple(corners))
        # An address among floats: only its bits count, not its value.
        address = address_of(hedges_on_row(hedges), 3, compiled=compiled)
        (modified,) = struct.unpack("d", struct.pack("q", address))
        return Curve(address_of(hedged_corners_row, 3, compiled=compiled), (modified, *corners))
    function, numbers = curved_row(shape, hedges)
    return Curve(address_of(function, 3, compiled=compiled), numbers)


def curved_row(
    shape: Shape, hedges: tuple[Hedge, ...]
) -> tuple[Callable[..., None], tuple[float, ...]]:
    """Return a curved term under hedges as a function of a row and of its numbers, and these."""
    names: list[str] = []
    numbers: list[float] = []

    def number(value: float) -> Node:
        names.append(f"n{len(names)}")
        numbers.append(value)
        return symbol(names[-1])

    if shape.kind == "formula":
        root = replace(degree_formula(shape), {POSITION: symbol("x")})
    else:
        kind = SHAPES[shape.kind]
        # Numbers are arguments, so that all bells share one function.
        parameters = [number(value) for value in shape.parameters]
        root = replace(kind.expression, dict(zip(kind.symbols[1:], parameters, strict=True)))
    root = number(shape.height) * root if shape.height != 1.0 else root
    root = _under(hedges, root, number)
    return _row_function(root, ("x",), tuple(names), shape.kind), tuple(numbers)


def _under(hedges: tuple[Hedge, ...], root: Node, number: Callable[[float], Node]) -> Node:
    """Return an expression under hedges; `number` makes symbols of their exponents."""
    for hedge in reversed(hedges):
        modifier = HEDGES[hedge.name]
        numbers = [] if hedge.exponent is None else [number(hedge.exponent)]
        root = replace(
            modifier.expression, dict(zip(modifier.symbols, [root, *numbers], strict=True))
        )
    return root


def hedges_on_row(hedges: tuple[Hedge, ...]) -> Callable[..., None]:
    """Return hedges as a function of a row, with their exponents as constants."""
    return _row_function(_under(hedges, symbol("x"), constant), ("x",), (), "hedged")


def asserted_degree(hedges: tuple[Hedge, ...]) -> Node:
    """Return the degree of an asserted term under hedges; its rules may add up to more than 1."""
    return _under(hedges, op.minimum(symbol("x"), 1.0), constant)


def degree_above_one(hedges: tuple[Hedge, ...]) -> Node:
    """Return a degree under hedges, of a sum that may exceed 1; 0 where undefined."""
    degree = _under(hedges, symbol("x"), constant)
    valued: Node = op.where(op.equal(degree, degree), degree, 0.0)
    return valued


@lru_cache(maxsize=64)
def plain_inverse(inverse: Callable[..., float]) -> Callable[..., None]:
    """Return an inverse in plain Python as a function of a row and of its numbers."""

    def inverse_row(degrees: Any, numbers: Any, into: Any) -> None:
        for point in range(into.shape[0]):
            into[point] = inverse(degrees[point], *numbers)

    return inverse_row


def weighed_strength(weight: float, threshold: float) -> Node:
    """Return a strength ``x`` times the weight of its rule; 0 up to the threshold."""
    part = symbol("x") * weight
    weighed: Node = op.where(part <= threshold, 0.0, part)
    return weighed


def expression_row(root: Node, numbers: Sequence[str]) -> Callable[..., None]:
    """Return an expression of ``x`` as a function of a row and of some numbers.

    The symbols are not read as Python identifiers: a variable may have any name.
    """
    plain = tuple(f"n{index}" for index in range(len(numbers)))
    replacements = dict(zip(numbers, map(symbol, plain), strict=True))
    return _row_function(replace(root, replacements), ("x",), plain, "expression")


def built_in_curve(name: str) -> Callable[..., None]:
    """Return a kind of shapes as a function of a row, with its numbers as arguments."""
    kind = SHAPES[name]
    names = [f"n{index}" for index in range(len(kind.symbols) - 1)]
    replacements = dict(zip(kind.symbols[1:], map(symbol, names), strict=True))
    return _row_function(replace(kind.expression, replacements), ("x",), tuple(names), name)


kernel(degree_on_corners)


# Straight terms are lines in the kernel. Rows of corners are for sets called by address: under
# hedges that bend them, in an integral, and in an editable layout.


@kernel
def corners_row(x: Any, corners: Any, into: Any) -> None:
    """Fill in the degrees of a straight term."""
    for point in range(into.shape[0]):
        into[point] = degree_on_corners(corners, x[point])


@kernel
def hedged_corners_row(x: Any, numbers: Any, into: Any) -> None:
    """Compute degrees under hedges, whose address is a whole number before the corners."""
    corners = numbers[1 : numbers.shape[0]]
    for point in range(into.shape[0]):
        into[point] = degree_on_corners(corners, x[point])
    call(whole_numbers(numbers)[0], into, numbers[0:0], into)


def corners_under(hedges: tuple[Hedge, ...]) -> Callable[..., None]:
    """Return a straight term under hedges as a function of a row and of its corners."""
    if not hedges:
        return corners_row
    root = _under(hedges, symbol("degree"), constant)
    lines, result = printed(root, PYTHON, reserved=("degree",))
    if "degree" in symbols(root):  # else constant, as `any` is
        lines = ["degree = degree_on_corners(corners, x_row[i])", *lines]
    head = "for i in range(into.shape[0]):"
    body = [head, *(f"    {line}" for line in lines), f"    into[i] = {result}"]
    source = "\n".join(
        ["def corners(x_row, corners, into):", *(f"    {line}" for line in body), ""]
    )
    function = row_function(source, "corners")
    function.__globals__["degree_on_corners"] = degree_on_corners
    return function


class Addresses(Protocol):
    """The numbering of the functions that a program calls."""

    @property
    def compiled(self) -> bool:
        """Whether the program runs as machine code in this process."""

    def norm(self, norm: Norm, sort: str) -> int:
        """Return the number of a norm that is not built in; `sort` is ``T`` or ``S``."""

    def curve(self, shape: Shape, hedges: tuple[Hedge, ...]) -> Curve:
        """Return the number of a term's row function, and its own numbers."""

    def hedged(self, hedges: tuple[Hedge, ...]) -> int:
        """Return the number of a row function of hedges."""

    def expression(self, root: Node, numbers: Sequence[str]) -> int:
        """Return the number of a row function of an expression of ``x`` and of some numbers."""

    def program(self, program: DefuzzifierProgram) -> int:
        """Return the number of a kernel over the block."""


def norm_number(norm: Norm, sort: str, addresses: Addresses) -> int:
    """Return the number of a norm in a program: built in, or another one."""
    registered = _OWN_NORMS.get((sort, norm.name))
    return addresses.norm(norm, sort) if registered is None else registered


class InMemory(NamedTuple):
    """Addresses in this process, of machine code or of plain Python."""

    compiled: bool

    def norm(self, norm: Norm, sort: str) -> int:
        """See :class:`Addresses`."""
        return address_of(norm_row(norm), 4, compiled=self.compiled)

    def curve(self, shape: Shape, hedges: tuple[Hedge, ...]) -> Curve:
        """See :class:`Addresses`."""
        return curve_of(shape, hedges, compiled=self.compiled)

    def hedged(self, hedges: tuple[Hedge, ...]) -> int:
        """See :class:`Addresses`."""
        return address_of(hedges_on_row(hedges), 3, compiled=self.compiled)

    def expression(self, root: Node, numbers: Sequence[str]) -> int:
        """See :class:`Addresses`."""
        function = expression_row(root, numbers)
        return address_of(function, 3, compiled=self.compiled)

    def program(self, program: DefuzzifierProgram) -> int:
        """See :class:`Addresses`."""
        return address_of(program.block, 1, program.bindings, compiled=self.compiled)
