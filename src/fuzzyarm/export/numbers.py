"""Numbers of the exported languages: rounding, literals, and what cannot be exported."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.errors import FuzzyarmError

# --- What cannot be exported ---


class ExportError(FuzzyarmError, ValueError):
    """A rule base, a table or an option that the target language cannot express."""


# --- Single precision: rounding, and numbers as the two languages write them ---

LARGEST = float(np.finfo(np.float32).max)

PRECISIONS = ("mixed", "float32", "float64")
"""mixed: float outside, double where arithmetic is done; the others: one type throughout."""


@dataclass(frozen=True, slots=True)
class Precision:
    """The floating-point types of a routine.

    Attributes
    ----------
    outside : type
        Of arguments and result: ``np.float32`` or ``np.float64``.
    inside : type
        Of the arithmetic.
    """

    outside: type[np.floating]
    inside: type[np.floating]

    @property
    def c_outside(self) -> str:
        """The type of arguments and result in C."""
        return C_TYPES[self.outside]

    @property
    def c_inside(self) -> str:
        """The type of the arithmetic in C."""
        return C_TYPES[self.inside]


C_TYPES: dict[type[np.floating], str] = {np.float32: "float", np.float64: "double"}


def precision_named(name: str, *, arithmetic: bool) -> Precision:
    """Return the types for a precision; mixed without `arithmetic` is float throughout."""
    if name not in PRECISIONS:
        raise ExportError(f"no precision '{name}'", hint=f"there are {', '.join(PRECISIONS)}")
    outside = np.float64 if name == "float64" else np.float32
    inside = np.float64 if name == "float64" or (name == "mixed" and arithmetic) else np.float32
    return Precision(outside, inside)


def rounded(
    values: Iterable[float] | NDArray[np.float64], kind: type[np.floating], what: str
) -> NDArray[np.floating]:
    """Return `values` as numbers of `kind`.

    Raises
    ------
    ExportError
        If one is too large for single precision.
    """
    array = np.asarray(values, dtype=np.float64)
    if kind is np.float32 and array.size and not np.abs(array).max() <= LARGEST:
        raise ExportError(
            f"{what} has {float(array.flat[int(np.abs(array).argmax())])!r}, which is too large"
            " for single precision",
            hint="export with --precision float64",
        )
    return array.astype(kind)


def rounded_down(
    values: Sequence[float], kind: type[np.floating], what: str
) -> NDArray[np.floating]:
    """Return the greatest numbers of `kind` that do not exceed `values`.

    For an x of that kind, x is greater than the result exactly where it is greater than the
    value: a comparison in single precision decides as one in double precision does.
    """
    near = rounded(values, kind, what)
    too_large = near.astype(np.float64) > np.asarray(values, dtype=np.float64)
    return np.where(too_large, np.nextafter(near, kind(-math.inf)), near)


def c_number(value: float | np.floating, kind: type[np.floating]) -> str:
    """Return the shortest literal that C reads as exactly this number."""
    if kind is np.float32:
        return f"{_decimal(str(np.float32(value)))}f"
    return _decimal(repr(float(value)))


def st_number(value: float | np.floating, kind: type[np.floating]) -> str:
    """Return the shortest real literal of Structured Text: digits on both sides of the point."""
    text = str(np.float32(value)) if kind is np.float32 else repr(float(value))
    mantissa, mark, exponent = _decimal(text).partition("e")
    mantissa = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{mantissa}{mark.upper()}{exponent}"


def _decimal(text: str) -> str:
    return text if "." in text or "e" in text else f"{text}.0"
