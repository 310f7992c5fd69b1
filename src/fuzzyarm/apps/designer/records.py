"""Records read from messages: from JSON to a frozen dataclass, or an error with the reason.

Every message of the socket is judged here, before its handler. So a later failure of the handler is
a fault of the program (`fuzzyarm.apps.designer.faults`), never of the message.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import printable

Record = TypeVar("Record")

LONGEST_SHOWN = 40
"""Characters of a wrong value in a message."""


class Absent(Enum):
    """The value of a field missing from a message, if null has another meaning."""

    ABSENT = "absent"


ABSENT = Absent.ABSENT


class MessageError(FuzzyarmError, ValueError):
    """A message of a page in the wrong form for its record.

    Attributes
    ----------
    where : str
        The field, as in ``shapes[0].kind``; empty for the message as a whole.
    """

    def __init__(self, why: str, where: str = "") -> None:
        super().__init__(f"a message is not understood: {where or 'it'} {why}")
        self.where = where


def json_name(field: str) -> str:
    """Return the name of a field in JSON: words of Python end with an underscore here."""
    return field.rstrip("_")


def read_record(kind: type[Record], data: Any, where: str = "") -> Record:
    """Return data of JSON as a record."""
    if not isinstance(data, Mapping):
        raise MessageError("must be an object", where)
    values = {}
    for name, annotation, required in _fields_of(cast(Hashable, kind)):
        key = json_name(name)
        place = f"{where}.{key}" if where else key
        value = data.get(key)
        if key not in data or (value is None and NoneType not in get_args(annotation)):
            if required:
                raise MessageError("is missing", place)
        else:
            values[name] = _read(annotation, value, place)
    return kind(**values)


@cache
def _fields_of(kind: Hashable) -> tuple[tuple[str, Any, bool], ...]:
    """Return name, annotation and whether it is required, of all fields of a record."""
    record: Any = kind
    hints = get_type_hints(record)
    return tuple(
        (
            field.name,
            hints[field.name],
            field.default is MISSING and field.default_factory is MISSING,
        )
        for field in fields(record)
    )


def _read(annotation: Any, value: Any, where: str) -> Any:
    if annotation is Any:
        return value
    if isinstance(annotation, type) and is_dataclass(annotation):
        return read_record(annotation, value, where)
    if annotation in _SCALARS:
        return _SCALARS[annotation](value, where)
    return _GENERICS[get_origin(annotation)](get_args(annotation), value, where)


def _one_of(kinds: tuple[Any, ...], value: Any, where: str) -> Any:
    """Read a value by the first kind of a union that accepts it."""
    if value is None and NoneType in kinds:
        return None
    rest = [kind for kind in kinds if kind not in (NoneType, Absent)]
    for kind in rest[:-1]:
        try:
            return _read(kind, value, where)
        except MessageError:
            continue
    return _read(rest[-1], value, where)


def _literal(words: tuple[Any, ...], value: Any, where: str) -> Any:
    if not isinstance(value, str) or value not in words:
        raise MessageError(f"must be one of {', '.join(map(repr, words))}", where)
    return value


def _mapping(kinds: tuple[Any, ...], value: Any, where: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise MessageError("must be an object", where)
    return {key: _read(kinds[1], item, f"{where}.{key}") for key, item in value.items()}


def _tuple(kinds: tuple[Any, ...], value: Any, where: str) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple):
        raise MessageError("must be a list", where)
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        return tuple(_read(kinds[0], item, f"{where}[{i}]") for i, item in enumerate(value))
    if len(value) != len(kinds):
        raise MessageError(f"must have {len(kinds)} values", where)
    pairs = enumerate(zip(kinds, value, strict=True))
    return tuple(_read(kind, item, f"{where}[{i}]") for i, (kind, item) in pairs)


def _text(value: Any, where: str) -> str:
    if not isinstance(value, str):
        raise MessageError(f"must be text, not {_shown(value)}", where)
    return value


def _truth(value: Any, where: str) -> bool:
    if not isinstance(value, bool):
        raise MessageError(f"must be true or false, not {_shown(value)}", where)
    return value


def _whole(value: Any, where: str) -> int:
    # Beyond 2**53 JavaScript no longer has every whole number.
    if isinstance(value, bool) or not isinstance(value, int) or abs(value) > 2**53:
        raise MessageError(f"must be a whole number, not {_shown(value)}", where)
    return value


def _number(value: Any, where: str) -> float:
    """Read a number; JSON has no infinite ones, which are the words 'inf' and '-inf'."""
    if value in ("inf", "-inf"):
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise MessageError(f"must be a number, not {_shown(value)}", where)
    if isinstance(value, int) and abs(value) > 10**300:
        raise MessageError("is too large", where)
    if not math.isfinite(value):
        raise MessageError("must be finite", where)
    return float(value)


def _shown(value: Any) -> str:
    return printable(repr(value)[:LONGEST_SHOWN])


_SCALARS: Mapping[Any, Callable[[Any, str], Any]] = {
    str: _text,
    bool: _truth,
    int: _whole,
    float: _number,
}

_GENERICS: Mapping[Any, Callable[[tuple[Any, ...], Any, str], Any]] = {
    Union: _one_of,
    UnionType: _one_of,
    Literal: _literal,
    Mapping: _mapping,
    tuple: _tuple,
}
