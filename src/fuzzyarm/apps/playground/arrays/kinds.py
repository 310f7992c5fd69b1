"""Kinds of numbers: type of an element, its layout in memory, and promotion of two kinds."""

from __future__ import annotations

import math
import operator
import struct
from collections.abc import Callable
from typing import Any

__all__ = [
    "DTYPES", "bool_", "dtype", "finfo", "float32", "float64", "floating", "int8", "int16", "int32",
    "int64", "integer", "issubdtype", "number", "promoted", "uint8", "uint32", "uintp",
]  # fmt: skip


class number:
    """The kind of all numbers."""


class integer(number):
    """Whole numbers."""


class floating(number):
    """Floating point."""


class float64(floating, float):
    """A float."""


def _single(value: float) -> float:
    try:
        return float(struct.unpack("f", struct.pack("f", value))[0])
    except OverflowError:
        return math.copysign(math.inf, value)


class float32(floating, float):
    """A float of 32 bits: its value is rounded, and so are results."""

    def __new__(cls, value: Any = 0.0) -> float32:
        """Round a value."""
        return super().__new__(cls, _single(float(value)))

    def __repr__(self) -> str:
        """Write it as briefly as it can be read back."""
        plain = float(self)
        if math.isinf(plain) or math.isnan(plain) or plain == 0.0:
            return float.__repr__(plain)
        brief = next(
            text for digits in range(1, 10)
            if _single(float(text := f"{plain:.{digits - 1}e}")) == plain
        )  # fmt: skip
        if 1e-4 <= abs(plain) < 1e6:
            digits = len(brief.split("e")[0].replace("-", "").replace(".", ""))
            places = max(digits - 1 - int(brief.split("e")[1]), 1)
            return f"{float(brief):.{places}f}"
        return brief

    __str__ = __repr__

    def __add__(self, other: Any) -> Any:
        """Round the sum."""
        return self._rounded(operator.add, other)

    def __sub__(self, other: Any) -> Any:
        """Round the difference."""
        return self._rounded(operator.sub, other)

    def __mul__(self, other: Any) -> Any:
        """Round the product."""
        return self._rounded(operator.mul, other)

    def __truediv__(self, other: Any) -> Any:
        """Round the quotient."""
        return self._rounded(operator.truediv, other)

    def _rounded(self, operation: Callable[[float, float], float], other: Any) -> Any:
        # Arrays have their own operations.
        if not isinstance(other, float | int):
            return NotImplemented
        return float32(operation(float(self), other))

    def __neg__(self) -> Any:
        """Turn the sign."""
        return float32(-float(self))


class int64(integer, int):
    """A whole number of 64 bits."""


class int32(integer, int):
    """A whole number of 32 bits."""


class int16(integer, int):
    """A whole number of 16 bits."""


class int8(integer, int):
    """A whole number of 8 bits."""


class uint8(integer, int):
    """A whole number of 8 bits without a sign."""


class uint32(integer, int):
    """A whole number of 32 bits without a sign."""


class uintp(integer, int):
    """A whole number that counts bytes of memory."""


class bool_(number):
    """True or false; unlike a bool of Python, turned by ``~``, and not a number."""

    def __init__(self, value: Any = False) -> None:
        self._is = bool(value)

    def __bool__(self) -> bool:
        """Return a bool of Python."""
        return self._is

    item = tolist = __index__ = __bool__

    def __invert__(self) -> Any:
        """Return the other one."""
        return bool_(not self)

    def __and__(self, other: Any) -> Any:
        """Whether both are true; element by element beside an array."""
        return bool_(self and other) if isinstance(other, bool | bool_) else NotImplemented

    def __or__(self, other: Any) -> Any:
        """Whether one is true; element by element beside an array."""
        return bool_(self or other) if isinstance(other, bool | bool_) else NotImplemented

    __rand__, __ror__ = __and__, __or__

    def __eq__(self, other: object) -> bool:
        """Whether it is as true as another one."""
        return self._is == (bool(other) if isinstance(other, bool_) else other)

    def __hash__(self) -> int:
        """Return a hash that agrees with equality."""
        return hash(self._is)

    def __repr__(self) -> str:
        """Write it as NumPy does."""
        return f"np.{self._is}"

    def __str__(self) -> str:
        """Write it as Python does."""
        return str(self._is)


class DType:
    """A kind of elements.

    Attributes
    ----------
    type : type
        Of one element.
    name : str
        As NumPy has it.
    code : str
        Of the element in :mod:`struct`.
    kind : str
        ``b``, ``i``, ``f``, or ``O`` for anything else, such as fractions.
    rank : int
        Of two kinds that of the higher rank can hold both.
    """

    def __init__(self, of: type, name: str, code: str, kind: str, rank: int) -> None:
        self.type, self.name, self.code, self.kind, self.rank = of, name, code, kind, rank
        # NumPy counts an object as a pointer.
        self.itemsize = struct.calcsize(code.replace("O", "P"))

    def newbyteorder(self, order: str) -> DType:
        """Return the kind itself: all that run a page have the lowest byte first."""
        if order != "<":
            raise TypeError("the highest byte first needs NumPy, which this page does not have")
        return self

    def __eq__(self, other: object) -> bool:
        """Whether it is the same kind, also by its type or name."""
        try:
            return self is dtype(other)
        except TypeError:
            return False

    def __hash__(self) -> int:
        """Return a hash that agrees with equality."""
        return hash(self.name)

    def __repr__(self) -> str:
        """Write it as NumPy does."""
        return f"dtype('{self.name}')"

    def __str__(self) -> str:
        """Return the name."""
        return self.name


DTYPES = tuple(
    DType(*entry)
    for entry in (
        (bool_, "bool", "?", "b", 0),
        (uint8, "uint8", "B", "i", 1),
        (int8, "int8", "b", "i", 1),
        (int16, "int16", "h", "i", 2),
        (int32, "int32", "i", "i", 3),
        (uint32, "uint32", "I", "i", 4),
        (int64, "int64", "q", "i", 4),
        (uintp, "uint64", "Q", "i", 4),
        (float32, "float32", "f", "f", 5),
        (float64, "float64", "d", "f", 6),
        (object, "object", "O", "O", 7),
    )
)
_BY_TYPE: dict[Any, DType] = {data_type.type: data_type for data_type in DTYPES}
_BY_TYPE |= {data_type.name: data_type for data_type in DTYPES}
_BY_TYPE |= {float: _BY_TYPE["float64"], int: _BY_TYPE["int64"], bool: _BY_TYPE["bool"]}
_BY_TYPE |= {"float": _BY_TYPE[float], "int": _BY_TYPE[int], "d": _BY_TYPE[float]}
# As in NumPy, the default kind is float64.
_BY_TYPE |= {None: _BY_TYPE[float]}


def dtype(of: Any) -> DType:
    """Return the kind of a type, a name or a kind; TypeError for an unsupported one."""
    if isinstance(of, DType):
        return of
    try:
        return _BY_TYPE[of]
    except (KeyError, TypeError):
        raise TypeError(f"arrays of {of!r} need NumPy, which this page does not have") from None


def promoted(a: DType, b: DType) -> DType:
    """Return the kind that two arrays make together."""
    high, low = (a, b) if a.rank >= b.rank else (b, a)
    # 24 bits hold every whole number of 16, not of 32.
    if high.name == "float32" and low.kind == "i" and low.itemsize > 2:
        return dtype(float)
    return high


def issubdtype(one: Any, family: type) -> bool:
    """Whether a kind belongs to a family."""
    return issubclass(dtype(one).type, family)


class finfo:
    """The limits of a floating type."""

    def __init__(self, of: Any) -> None:
        single = dtype(of).name == "float32"
        self.eps = float32(2.0**-23) if single else 2.0**-52
        self.max = float32((2.0 - 2.0**-23) * 2.0**127) if single else (2.0 - 2.0**-52) * 2.0**1023
        self.min = -self.max
        self.tiny = float32(2.0**-126) if single else 2.0**-1022
