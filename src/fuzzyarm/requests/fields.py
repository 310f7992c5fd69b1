"""A request is a frozen record whose fields say what they take; all else is read from them.

`option` declares a field: how it is written on the command line, what it is, what it may be. From
that follow the options of a command and their help, the form of a page and its JSON Schema, what a
journal holds a search to, and the one sentence about a value that does not fit.
"""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from inspect import get_annotations
from types import NoneType
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Literal,
    NamedTuple,
    Self,
    TypeVar,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

from fuzzyarm.base.errors import WordError
from fuzzyarm.base.names import near_hint, printable

__all__ = ["Request", "RequestError", "RequestField", "fields_of", "option", "read_fields"]

_KEY = "request"
"""Of the metadata of a dataclass field."""

LONGEST_SHOWN = 60
"""Characters of a wrong value in a message."""


class RequestError(WordError):
    """A field of a request does not take a value.

    Attributes
    ----------
    field : str
        Its name.
    why : str
        What is wrong, to follow the name.
    is_usage : bool
        Whether the value is of another kind, or not one of the choices; else it is out of range.
    """

    def __init__(self, field: str, why: str, *, hint: str = "", is_usage: bool = False) -> None:
        super().__init__(f"{field} {why}", hint=hint)
        self.field, self.why, self.is_usage = field, why, is_usage

    def called(self, name: str) -> RequestError:
        """Return the error with another name of the field, as the option of a command."""
        error = RequestError(name, self.why, hint=self.hint, is_usage=self.is_usage)
        error.field = self.field
        return error


# --- What a field says ---


class Limits(NamedTuple):
    """Between what a number lies; `low` itself is out of range where it is `open`."""

    low: float = -math.inf
    high: float = math.inf
    is_open: bool = False

    def hold(self, value: float) -> bool:
        """Tell whether a number is in range."""
        return value <= self.high and (value > self.low if self.is_open else value >= self.low)

    def words(self, unit: str) -> str:
        """Return what a number must be."""
        unit = f" {unit}" if unit else ""
        if math.isfinite(self.high) and math.isfinite(self.low):
            return f"{'above ' if self.is_open else ''}{self.low:.15g} to {self.high:.15g}{unit}"
        if math.isfinite(self.low):
            return f"{'above' if self.is_open else 'at least'} {self.low:.15g}{unit}"
        return f"at most {self.high:.15g}{unit}"


_ANY = Limits()


class _Spec(NamedTuple):
    """What `option` says of a field beside its type and its default."""

    words: str
    help: str
    group: str
    either: str
    limits: Limits
    unit: str
    is_idle: bool
    is_negatable: bool
    is_repeated: bool


def option(
    words: str,
    text: str,
    default: Any = MISSING,
    limits: tuple[float, float] | Limits = _ANY,
    unit: str = "",
    **more: Any,
) -> Any:
    """Declare a field of a request.

    Parameters
    ----------
    words : str
        As on the help page: the spellings of an option or the name of a positional argument, then
        what its values are called, as in ``-o --out FILE``.
    text : str
        What it is, in a line.
    default : object, optional
        Without one it must be given.
    limits : tuple of float, optional
        Between which a number lies.
    unit : str, optional
        Of a number.
    **more
        ``group``: a title on the help page. ``either``: fields of a group with the same word
        exclude each other. ``idle``: no result depends on it. ``negatable``: its option has a
        ``--no-`` form. ``repeated``: its option is written once for each value.
    """
    description = _Spec(
        words,
        text,
        more.pop("group", ""),
        more.pop("either", ""),
        Limits(*limits),
        unit,
        more.pop("idle", False),
        more.pop("negatable", False),
        more.pop("repeated", False),
    )
    if more:
        raise TypeError(f"a field does not say {', '.join(more)}")
    return field(default=default, metadata={_KEY: description})


@dataclass(frozen=True)
class RequestField:
    """A field of a request, with what is known of it.

    Attributes
    ----------
    name : str
        In Python.
    spec : tuple
        See `option`.
    default : object
        `dataclasses.MISSING` where it must be given.
    kind : {"text", "whole", "number", "truth"}
        Of its value, or of each of its values.
    choices : tuple
        All values, where there are few.
    is_optional : bool
        Whether None is a value: nothing is said.
    count : int or None
        How many values it has; 0 for any number, None for one that is not in a list.
    """

    name: str
    spec: _Spec
    default: Any
    kind: Literal["text", "whole", "number", "truth"]
    choices: tuple[Any, ...]
    is_optional: bool
    count: int | None

    @property
    def json_name(self) -> str:
        """Its name in JSON; words of Python end with an underscore here."""
        return self.name.rstrip("_")

    @property
    def is_required(self) -> bool:
        """Whether it has no default."""
        return self.default is MISSING

    @property
    def spelling(self) -> str:
        """Return how a person writes it: its longest option, or its name."""
        options: list[str] = [word for word in self.spec.words.split() if word.startswith("-")]
        return max(options, key=len, default=self.name)

    def read(self, value: Any) -> Any:
        """Return a value as the field has it.

        Parameters
        ----------
        value : object
            Of Python, of JSON, or the text of a form.

        Raises
        ------
        RequestError
            If the field does not take it.
        """
        if value is None and self.is_optional:
            return None
        if self.count is None:
            return self.item(value)
        single = isinstance(value, str | os.PathLike) or not isinstance(value, Iterable)
        values = [value] if single else list(value)
        if self.count and len(values) != self.count:
            self.refuse(f"must have {self.count} values, not {len(values)}")
        return tuple(map(self.item, values))

    def item(self, value: Any) -> Any:
        """Return one value, or one of several; errors as :meth:`read`."""
        try:
            result = _READERS[self.kind](value)
        except (TypeError, ValueError, OverflowError):
            self.refuse(f"must be {_KINDS[self.kind]}, not {shown(value)}", is_usage=True)
        if self.choices:
            if result not in self.choices:
                raise unknown_choice(self.json_name, result, self.choices)
        elif self.kind in ("whole", "number"):
            self._require_range(result)
        return result

    def _require_range(self, number: float) -> None:
        limits = self.spec.limits
        # Without an upper end infinity is in range: no limit of time, for instance.
        if math.isnan(number) or (math.isinf(number) and not math.isinf(limits.high)):
            self.refuse(f"must be finite, not {number}")
        if not limits.hold(number):
            unit = f" {self.spec.unit}" if self.spec.unit else ""
            self.refuse(f"must be {limits.words(self.spec.unit)}, not {number:.15g}{unit}")

    def refuse(self, why: str, *, hint: str = "", is_usage: bool = False) -> None:
        """Raise RequestError: the field does not take a value."""
        raise RequestError(self.json_name, why, hint=hint, is_usage=is_usage) from None


def shown(value: Any) -> str:
    """Return a value for a message."""
    text = printable(str(value) if isinstance(value, os.PathLike) else repr(value))
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 2]} …"


def one_of(choices: Iterable[Any]) -> str:
    """Return ``a, b or c``."""
    *front, last = map(str, choices)
    return f"{', '.join(front)} or {last}" if front else last


def unknown_choice(field: str, value: Any, choices: Iterable[Any]) -> RequestError:
    """Return the error of a value that is not one of the choices of a field."""
    names = list(map(str, choices))
    why, hint = f"must be {one_of(names)}, not {shown(value)}", near_hint(str(value), names)[0]
    return RequestError(field, why, hint=hint, is_usage=True)


# --- Kinds of values ---


def _text(value: Any) -> str:
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if not isinstance(value, str):
        raise TypeError
    return value


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise TypeError
    return value


def _whole(value: Any) -> int:
    if isinstance(value, bool):
        raise TypeError
    if isinstance(value, float) and value.is_integer():  # JSON does not tell 3 from 3.0
        return int(value)
    return int(value) if isinstance(value, str) else operator.index(value)


def _number(value: Any) -> float:
    if isinstance(value, bool):
        raise TypeError
    return float(value)


_READERS: Mapping[str, Callable[[Any], Any]] = {
    "text": _text,
    "truth": _truth,
    "whole": _whole,
    "number": _number,
}
_KINDS = {"text": "text", "truth": "true or false", "whole": "a whole number", "number": "a number"}
_TYPES = {str: "text", bool: "truth", int: "whole", float: "number"}


# --- Records ---

AnyRequest = TypeVar("AnyRequest", bound="Request")


class _Constructor(type):
    """Says which field was meant where the constructor of a request is called amiss."""

    if not TYPE_CHECKING:  # who reads types sees the constructor itself

        def __call__(cls, *positional: Any, **values: Any) -> Any:
            records, name = _known(cls), cls.__name__
            if positional:
                example = next(iter(records))
                raise RequestError(
                    name,
                    f"takes keywords only, not {shown(positional[0])}",
                    hint=f"write, for instance, {name}({example}={positional[0]!r})",
                    is_usage=True,
                )
            for word in values:
                if word not in records:
                    raise unknown_field(cls, word)
            for option in records.values():
                if option.is_required and option.name not in values:
                    raise RequestError(option.name, f"of {name} is missing", is_usage=True)
            return super().__call__(**values)


@dataclass(frozen=True, kw_only=True)
class Request(metaclass=_Constructor):
    """What is asked for. Its values are read and judged when it is made.

    Raises
    ------
    RequestError
        If a field does not take its value, there is no such field, or one is missing.
    """

    withheld: ClassVar[frozenset[str]] = frozenset()
    """Fields of a base that this request does not have: they keep their defaults."""

    def __post_init__(self) -> None:
        for record in fields_of(type(self)):
            object.__setattr__(self, record.name, record.read(getattr(self, record.name)))

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """Return a request of the values that a form or a page has; an empty one says nothing.

        Parameters
        ----------
        values : mapping
            By the names of fields, in JSON; others are left out. Several values may stand in one
            text, with blanks between.
        """
        values_by_name = {}
        for record in fields_of(cls):
            value = values.get(record.json_name)
            if value is None or (isinstance(value, str) and not value.strip()):
                continue
            if record.count is not None and isinstance(value, str):
                value = value.split()
            values_by_name[record.name] = value.strip() if isinstance(value, str) else value
        return cls(**values_by_name)

    def given(self, names: Iterable[str]) -> RequestField | None:
        """Return the first of some fields that is not as by default; None where all are."""
        for name in names:
            record = _known(cast(Hashable, type(self))).get(name)
            if record is not None and getattr(self, name) != record.default:
                return record
        return None

    def question(self) -> dict[str, Any]:
        """Return all fields on which results depend and that are not as by default, for JSON."""
        return {
            record.name: value
            for record in fields_of(type(self))
            if not record.spec.is_idle and (value := getattr(self, record.name)) != record.default
        }

    def as_kind(self, kind: type[AnyRequest], **values: Any) -> AnyRequest:
        """Return a request of another kind with the fields that both have, and other values."""
        shared = {record.name: getattr(self, record.name) for record in fields_of(kind)
                  if record.name in _known(cast(Hashable, type(self)))}  # fmt: skip
        return kind(**shared | values)

    def replaced(self, **values: Any) -> Self:
        """Return the request with other values of some fields."""
        current = {record.name: getattr(self, record.name) for record in fields_of(type(self))}
        return type(self)(**current | values)


def fields_of(kind: type[Request]) -> tuple[RequestField, ...]:
    """Return the fields of a record without those that it withholds: its own, then its bases'."""
    return tuple(_known(cast(Hashable, kind)).values())


@cache
def _known(record: Hashable) -> Mapping[str, RequestField]:
    """Return the fields of a record by name."""
    kind = cast(type[Request], record)
    hints = get_type_hints(kind)
    by_name = {data_field.name: data_field for data_field in fields(kind)}
    annotations = [tuple(get_annotations(base)) for base in kind.__mro__]
    # What is said anew of a field of a base stays in its place.
    order = [
        name
        for depth, names in enumerate(annotations)
        for name in names
        if not any(name in others for others in annotations[depth + 1 :])
    ]
    return {
        name: _field(name, hints[name], by_name[name].default, by_name[name].metadata[_KEY])
        for name in order
        if name in by_name and name not in kind.withheld
    }


def unknown_field(kind: type[Request], name: str) -> RequestError:
    """Return the error of a field that a request does not have.

    Whoever knows the command may name its option, whose name in Python is another.
    """
    records = _known(cast(Hashable, kind))
    options = {
        record.spelling.lstrip("-").replace("-", "_"): record.name for record in records.values()
    }
    if name in options:
        hint = f"the field of {printable(records[options[name]].spelling)} is '{options[name]}'"
    else:
        hint = near_hint(name, records)[0]
    return RequestError(name, f"is not a field of {kind.__name__}", hint=hint, is_usage=True)


def read_fields(
    kind: type[Request], values: Mapping[str, Any], names: Iterable[str]
) -> dict[str, Any]:
    """Return the values of some fields, judged; the defaults of those that are not there."""
    records = _known(cast(Hashable, kind))
    return {
        name: records[name].read(values[name]) if name in values else records[name].default
        for name in names
    }


def _field(name: str, annotation: Any, default: Any, entry: _Spec) -> RequestField:
    """Return what is known of a field by its annotation."""
    parts = [part for part in get_args(annotation) if part is not NoneType]
    is_optional = len(parts) < len(get_args(annotation)) and get_origin(annotation) is not tuple
    if is_optional:
        (annotation,) = parts  # a union of one kind with None
    count: int | None = None
    if get_origin(annotation) is tuple:
        item, *others = get_args(annotation)
        count = 0 if others == [Ellipsis] else 1 + len(others)
        annotation = item
    choices = get_args(annotation) if get_origin(annotation) is Literal else ()
    kind: Any = _TYPES[type(choices[0]) if choices else annotation]
    return RequestField(name, entry, default, kind, choices, is_optional, count)
