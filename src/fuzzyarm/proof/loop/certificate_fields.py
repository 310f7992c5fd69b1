"""Fields of a certificate's file: each read as what it has to be, and refused by its name if not.

A file may be anybody's. So nothing is converted that was not written so: a number of the proof is
a text of a rational, as ``"-3/4"``, within the range of floats.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn

from fuzzyarm.base.protected import note_source
from fuzzyarm.proof.claim.problem import LoopProofError

__all__ = ["CertificateError", "Field", "read_fields"]


class CertificateError(LoopProofError):
    """A file is not a certificate, or not of this controller."""


_RATIONAL = re.compile(r"-?[0-9]{1,4000}(/[0-9]{1,4000})?")


@dataclass(frozen=True)
class Field:
    """A value in a certificate's file, and where it stands.

    Attributes
    ----------
    file : str
        Whose it is.
    place : str
        As ``p[0][1]``; empty for the whole.
    value : object
        Of JSON.
    """

    file: str
    place: str
    value: Any

    def refuse(self, what: str) -> NoReturn:
        """Refuse the file, for what this field is or is not."""
        where = f"'{self.place}' {what}" if self.place else f"it {what}"
        raise CertificateError(f"{self.file} is not a certificate: {where}")

    def __getitem__(self, name: str) -> Field:
        """Return a field of an object."""
        value = self._of(dict, "an object")
        place = f"{self.place}.{name}" if self.place else name
        if name not in value:
            Field(self.file, place, None).refuse("is missing")
        return Field(self.file, place, value[name])

    def __iter__(self) -> Iterator[Field]:
        """Yield the entries of a list."""
        for k, value in enumerate(self._of(list, "a list")):
            yield Field(self.file, f"{self.place}[{k}]", value)

    def items(self) -> list[tuple[str, Field]]:
        """Return the fields of an object, with their names."""
        return [(name, self[name]) for name in self._of(dict, "an object")]

    def row(self, size: int) -> list[Field]:
        """Return the entries of a list of a size."""
        if len(self._of(list, "a list")) != size:
            self.refuse(f"is not a list of {size}")
        return list(self)

    @property
    def text(self) -> str:
        """As a text."""
        return str(self._of(str, "a text"))

    @property
    def flag(self) -> bool:
        """As true or false."""
        return bool(self._of(bool, "true or false"))

    @property
    def index(self) -> int:
        """As a whole number from 0 on."""
        if isinstance(self.value, bool) or not isinstance(self.value, int) or self.value < 0:
            self.refuse("is not a whole number")
        return self.value

    @property
    def rational(self) -> Fraction:
        """As a rational."""
        if not isinstance(self.value, str) or not _RATIONAL.fullmatch(self.value):
            self.refuse('is not a rational as a text, such as "3/4"')
        try:
            number = Fraction(self.value)
        except ZeroDivisionError:
            self.refuse("is a division by 0")
        try:
            is_near = bool(float(number)) == bool(number)
        except OverflowError:
            is_near = False
        if not is_near:
            self.refuse("is out of range")
        return number

    @property
    def number(self) -> float:
        """As a float, which may be infinite."""
        if self.value in ("inf", "-inf"):
            return float(self.value)
        return float(self.rational)

    @property
    def pair(self) -> tuple[Fraction, Fraction]:
        """As two rationals."""
        low, high = self.row(2)
        return low.rational, high.rational

    def one_of(self, choices: Sequence[str]) -> str:
        """Return a text that is one of some."""
        if self.value not in choices:
            self.refuse(f"is not {', '.join(choices[:-1])} or {choices[-1]}")
        return str(self.value)

    def _of(self, kind: type, words: str) -> Any:
        if not isinstance(self.value, kind):
            self.refuse(f"is not {words}")
        return self.value


def read_fields(path: str) -> Field:
    """Return what is in a file of JSON, which has to be an object."""
    note_source(path)
    try:
        value = json.loads(Path(path).read_text("utf-8"))
    except json.JSONDecodeError as error:
        Field(path, "", None).refuse(f"is not JSON at line {error.lineno}")
    except (ValueError, RecursionError):  # not UTF-8, a number without end, nested without end
        Field(path, "", None).refuse("is not JSON")
    whole = Field(path, "", value)
    whole.items()
    return whole
