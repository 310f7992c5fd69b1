"""Numbers of the exported languages: rounding, literals and refusals."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.diagnostic import NOWHERE, Span
from fuzzyarm.base.errors import FuzzyarmError

# --- Refusals ---


class ExportError(FuzzyarmError, ValueError):
    """A rule base, a table or an option that the target language cannot express.

    Attributes
    ----------
    span : Span
        The offending part in its file; `NOWHERE` if it is not one line.
    path : str
        The file, if known.
    """

    def __init__(
        self, message: str, *, hint: str = "", span: Span = NOWHERE, path: str = ""
    ) -> None:
        super().__init__(message, hint=hint)
        self.span, self.path = span, path

    def in_file(self, path: str, hint: str = "") -> ExportError:
        """Return the error with its file, and maybe another hint.

        Parameters
        ----------
        path : str
            Where nothing nearer is known.
        hint : str, optional
            An alternative.
        """
        return ExportError(
            self.message, hint=hint or self.hint, span=self.span, path=self.path or path
        )

    def __str__(self) -> str:
        if self.span == NOWHERE:
            return super().__str__()
        place = f"{self.path}:{self.span.line}" if self.path else f"line {self.span.line}"
        return f"{place}: {super().__str__()}"


# --- The types of numbers, and numbers as the two languages write them ---

LARGEST = float(np.finfo(np.float32).max)


def stand_ins(numbers: Iterable[float]) -> tuple[float, float]:
    """Return substitutes for infinity, and for the smallest number above 0, beside `numbers`.

    Unless the largest is extreme these are numbers of single precision: some compilers of
    Structured Text (matiec) take no other literal, not even for an LREAL.
    """
    finite = [abs(x) for x in numbers if abs(x) < sys.float_info.max]
    if 1e-30 <= max(finite, default=1.0) <= 1e30:
        return LARGEST, 1e-37
    return sys.float_info.max, 5e-324


Kind = type[Any]
"""A type of numbers of NumPy: floating point, or whole numbers of some width."""

C_TYPES: dict[Kind, str] = {
    np.float32: "float",
    np.float64: "double",
    np.int8: "int8_t",
    np.int16: "int16_t",
    np.int32: "int32_t",
}

ST_TYPES: dict[Kind, str] = {
    np.float32: "REAL",
    np.float64: "LREAL",
    np.int8: "SINT",
    np.int16: "INT",
    np.int32: "DINT",
}

PRECISIONS = ("mixed", "float32", "float64")
"""mixed: float outside, double where arithmetic is done; the others: one type throughout."""


class Precision(NamedTuple):
    """The types of a routine: of arguments and result, of constants, and of the arithmetic."""

    outside: Kind
    inside: Kind
    wide: Kind

    @property
    def words(self) -> str:
        """The arithmetic, in words, for the head of a file."""
        arithmetic = f"{C_TYPES[self.wide]} arithmetic"
        if self.outside is self.wide:
            return arithmetic
        return f"{arithmetic}, the result rounded to {C_TYPES[self.outside]}"


def precision_named(name: str, *, arithmetic: bool) -> Precision:
    """Return the types for a precision; mixed without `arithmetic` is float throughout."""
    if name not in PRECISIONS:
        raise ExportError(f"no precision '{name}'", hint=f"there are {', '.join(PRECISIONS)}")
    outside = np.float64 if name == "float64" else np.float32
    inside = np.float64 if name == "float64" or (name == "mixed" and arithmetic) else np.float32
    return Precision(outside, inside, inside)


def rounded(values: Iterable[float] | NDArray[np.float64], kind: Kind, name: str) -> NDArray[Any]:
    """Return `values` as numbers of `kind`; refuse those too large for single precision."""
    array = np.asarray(values, dtype=np.float64)
    if kind is np.float32 and array.size and not np.abs(array).max() <= LARGEST:
        raise ExportError(
            f"{name} has {float(array.flat[int(np.abs(array).argmax())])!r}, which is too large"
            " for single precision",
            hint="export with --precision float64",
        )
    return array.astype(kind)


def rounded_down(values: Sequence[float], kind: Kind, name: str) -> NDArray[Any]:
    """Return the greatest numbers of `kind` that do not exceed `values`.

    For an x of that kind, x is greater than the result exactly if it is greater than the value: a
    comparison in single precision decides as one in double precision does.
    """
    near = rounded(values, kind, name)
    too_large = near.astype(np.float64) > np.asarray(values, dtype=np.float64)
    return np.where(too_large, np.nextafter(near, kind(-math.inf)), near)


def c_number(value: float, kind: Kind) -> str:
    """Return the shortest literal that C reads as exactly this number."""
    return f"{_decimal(value, kind)}f" if kind is np.float32 else _decimal(value, kind)


def st_number(value: float, kind: Kind) -> str:
    """Return the shortest literal of Structured Text: a real has digits on both sides."""
    text = _decimal(value, kind)
    if not issubclass(kind, np.floating):
        return text
    mantissa, mark, exponent = text.partition("e")
    mantissa = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{mantissa}{mark.upper()}{exponent}"


def st_literal(value: float, kind: Kind) -> str:
    """Return a literal in a statement: one of an LREAL has its type, or some compilers round it."""
    text = st_number(value, kind)
    if kind is not np.float64:
        return text
    return f"-LREAL#{text[1:]}" if text.startswith("-") else f"LREAL#{text}"


def _decimal(value: float, kind: Kind) -> str:
    if not issubclass(kind, np.floating):
        return str(int(value))
    text = str(np.float32(value)) if kind is np.float32 else repr(float(value))
    return text if "." in text or "e" in text else f"{text}.0"
