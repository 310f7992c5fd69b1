"""Types of the values in a kernel: numbers, arrays of numbers, and tuples of these."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple


class Scalar(Enum):
    """A number type; the wider of two, further down, holds values of both.

    Integers have 64 bits; short ones have 32, so a vector holds twice as many.
    """

    TRUTH = "truth"
    SHORT = "short"
    WHOLE = "whole"
    REAL = "real"


class Array(Enum):
    """A one-dimensional array, by its elements; constants are read-only reals."""

    REALS = "reals"
    CONSTANTS = "constants"
    WHOLES = "wholes"
    SHORTS = "shorts"

    @property
    def element(self) -> Scalar:
        """The type of an element."""
        return _ELEMENTS[self]


_ELEMENTS = {
    Array.REALS: Scalar.REAL,
    Array.CONSTANTS: Scalar.REAL,
    Array.WHOLES: Scalar.WHOLE,
    Array.SHORTS: Scalar.SHORT,
}


class TupleType(NamedTuple):
    """A tuple; with names for a named tuple.

    Attributes
    ----------
    parts : tuple of Type
        Types of its parts, in order.
    names : tuple of str
        Names of its parts; empty for a plain tuple.
    """

    parts: tuple[Type, ...]
    names: tuple[str, ...] = ()

    @property
    def uniform(self) -> bool:
        """Whether all parts are numbers of one type, so that an index may be computed."""
        return len(set(self.parts)) == 1 and isinstance(self.parts[0], Scalar)


class Nothing(Enum):
    """The result of a function without one."""

    NOTHING = "nothing"


Type = Scalar | Array | TupleType | Nothing


class TypedText(NamedTuple):
    """The text of an expression in some language, its type, and the memory it may alias.

    Attributes
    ----------
    text : str
        Text in the language.
    type : Type
        Type of the value.
    memory : frozenset of str
        Arguments of the function whose arrays the value may alias.
    """

    text: str
    type: Type
    memory: frozenset[str] = frozenset()


_WIDTH = list(Scalar)


def wider(one: Type | None, other: Type) -> Type:
    """Return the common type of two; None is the empty type."""
    if one is None or one == other:
        return other
    if isinstance(one, Scalar) and isinstance(other, Scalar):
        return max(one, other, key=_WIDTH.index)
    if not (isinstance(one, TupleType) and isinstance(other, TupleType)):
        raise TypeError(f"{_word(one)} and {_word(other)} under one name")
    if len(one.parts) == len(other.parts):
        parts = (wider(a, b) for a, b in zip(one.parts, other.parts, strict=True))
        return TupleType(tuple(parts), one.names or other.names)
    raise TypeError(f"{_word(one)} and {_word(other)} under one name")


def widest(types: Sequence[Type]) -> Type:
    """Return the common type of all."""
    result = types[0]
    for one in types[1:]:
        result = wider(result, one)
    return result


def _word(one: Type) -> str:
    return "a tuple" if isinstance(one, TupleType) else one.value


ARRAYS = {"f": Array.REALS, "i": Array.WHOLES, "s": Array.SHORTS}
"""Types by the letters of :func:`fuzzyarm.symbolic.kernels.address_of`."""
