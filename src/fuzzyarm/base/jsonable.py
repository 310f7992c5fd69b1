"""Data for JSON: records as objects, arrays as lists, null for NaN and infinity.

A data class is an object of its fields, without positions in a text (``span``). Any other choice is
a line above the class, which can also make a named tuple an object instead of a list::

    @json_properties("property=statement verdict seconds lower? file=source.path")

Each word is a field, a property, or a method without parameters; ``name=`` gives it another name,
dots lead into records, and with ``?`` it is left out if None or empty. ``*`` means
all fields, from which ``-name`` takes one. ``tools/make_schemas.py`` makes JSON Schemas of the
same lines, with the types and the words of the classes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import field, fields, is_dataclass
from functools import cache
from types import MethodType, MethodWrapperType
from typing import Any, NamedTuple, TypeVar

T = TypeVar("T")

_METHODS = (MethodType, MethodWrapperType)


class JsonProperty(NamedTuple):
    """A property of a record in JSON.

    Attributes
    ----------
    name : str
        In JSON.
    path : tuple of str
        Names of the attributes that lead to it; a method is called.
    optional : bool
        Whether it is left out if None or empty.
    words : str
        Properties of the records in it, instead of their own.
    """

    name: str
    path: tuple[str, ...]
    optional: bool = False
    words: str = ""

    def of(self, record: Any) -> Any:
        """Return the value."""
        for name in self.path:
            if record is None:
                return None
            record = getattr(record, name)
            record = record() if isinstance(record, _METHODS) else record
        return record


def json_properties(words: str) -> Callable[[type[T]], type[T]]:
    """Choose the properties of a record in JSON.

    Parameters
    ----------
    words : str
        As above.
    """

    def chosen(kind: type[T]) -> type[T]:
        kind.__json__ = words  # type: ignore[attr-defined]
        return kind

    return chosen


@cache
def properties_of(kind: type, words: str = "") -> tuple[JsonProperty, ...]:
    """Return the properties of a record in JSON; none if it is not an object there.

    Parameters
    ----------
    kind : type
        Any.
    words : str
        Instead of its own.
    """
    own = getattr(kind, "__json__", "*" if is_dataclass(kind) else "")
    inner = dict.fromkeys(getattr(kind, "_fields", ()), "")
    if is_dataclass(kind):
        inner = {each.name: each.metadata.get("words", "") for each in fields(kind)}
    found: dict[str, JsonProperty] = {}
    for word in (own and (words or own)).split():
        if word == "*":
            public = [name for name in inner if name != "span" and not name.startswith("_")]
            found |= {name: JsonProperty(name, (name,)) for name in public}
        elif word.startswith("-"):
            del found[word[1:]]
        else:
            name, _, path = word.removesuffix("?").partition("=")
            found[name] = JsonProperty(name, tuple((path or name).split(".")), word.endswith("?"))
    return tuple(each._replace(words=inner.get(each.path[0], "")) for each in found.values())


def entry(about: str, words: str = "", **options: Any) -> Any:
    """Return a field of a data class for JSON alone, described in place.

    Parameters
    ----------
    about : str
        What it is, for the schema.
    words : str
        Properties of the records in it, instead of their own.
    **options
        As for :func:`dataclasses.field`.
    """
    return field(metadata={"about": about, "words": words}, **options)


def jsonable(data: Any, words: str = "", infinite: Callable[[float], Any] = lambda _: None) -> Any:
    """Convert data to JSON types.

    Parameters
    ----------
    data : object
        Records, mappings, sequences, text, numbers, booleans and None, nested; arrays and scalars
        of NumPy, fractions.
    words : str
        Properties of the records, instead of their own.
    infinite : callable
        The replacement of an infinite number.

    Returns
    -------
    dict, list, str, int, float, bool or None
        NaN becomes None, which is ``null`` in JSON, and so do infinite numbers by default.
    """
    if data is None or isinstance(data, str | int):
        return data
    if hasattr(data, "as_integer_ratio"):  # a float of any kind, or a fraction
        number = float(data)
        return number if math.isfinite(number) else infinite(number) if math.isinf(number) else None
    if isinstance(data, Mapping):
        return {key: jsonable(item, words, infinite) for key, item in data.items()}
    kind: type = type(data)
    if properties := properties_of(kind, words):
        values = [(each, each.of(data)) for each in properties]
        return {
            each.name: jsonable(value, each.words, infinite)
            for each, value in values
            if not (each.optional and (value is None or (isinstance(value, tuple) and not value)))
        }
    if hasattr(data, "tolist"):
        return jsonable(data.tolist(), words, infinite)
    return [jsonable(item, words, infinite) for item in data]


class JsonRecord:
    """A record with a JSON form."""

    __slots__ = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the properties in JSON types; None for NaN and infinity."""
        data: dict[str, Any] = jsonable(self)
        return data


def script_json(data: object) -> str:
    """Return JSON that is safe inside an HTML script: it can end neither the script nor a line."""
    import json

    text = json.dumps(data, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
