"""Fields of requests, from which everything else is derived.

`option` declares a field: its spelling on the command line, its description, its limits. From it
follow the options of a command and their help, the form of a page and its JSON Schema, the part of
a journal that identifies the work, and the sentence about an invalid value.
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

_KEY = "request"
"""Key in the metadata of a dataclass field."""

LONGEST_SHOWN = 60
"""Characters of an invalid value in a message."""


class RequestError(WordError):
    """A field of a request has an invalid value.

    Attributes
    ----------
    field : str
        Its name.
    why : str
        The fault, to follow the name.
    is_usage : bool
        Whether the value has the wrong type or is not a choice; else it is out of range.
    """

    def __init__(self, field: str, why: str, *, hint: str = "", is_usage: bool = False) -> None:
        super().__init__(f"{field} {why}", hint=hint)
        self.field, self.why, self.is_usage = field, why, is_usage

    def called(self, name: str) -> RequestError:
        """Return the error under another name of the field, as the option of a command."""
        error = RequestError(name, self.why, hint=self.hint, is_usage=self.is_usage)
        error.field = self.field
        return error


# --- Declaration of a field ---


class Limits(NamedTuple):
    """The range of a number; `low` itself is excluded if `is_open`."""

    low: float = -math.inf
    high: float = math.inf
    is_open: bool = False

    def hold(self, value: float) -> bool:
        """Whether a number is in range."""
        return value <= self.high and (value > self.low if self.is_open else value >= self.low)

    def words(self, unit: str) -> str:
        """Return the range in words."""
        unit = f" {unit}" if unit else ""
        if math.isfinite(self.high) and math.isfinite(self.low):
            return f"{'above ' if self.is_open else ''}{self.low:.15g} to {self.high:.15g}{unit}"
        if math.isfinite(self.low):
            return f"{'above' if self.is_open else 'at least'} {self.low:.15g}{unit}"
        return f"at most {self.high:.15g}{unit}"


_ANY = Limits()


class _Spec(NamedTuple):
    """The declaration by `option`, beside type and default."""

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
        the placeholder of its values, as in ``-o --out FILE``.
    text : str
        Description, one line.
    default : object, optional
        Without one the field is mandatory.
    limits : tuple of float, optional
        Range of a number.
    unit : str, optional
        Unit of a number.
    **more
        ``group``: a title on the help page. ``either``: fields of a group with the same word
        exclude each other. ``idle``: results do not depend on it. ``negatable``: its option has a
        ``--no-`` form. ``repeated``: its option is repeated for each value.
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
    """A field of a request.

    Attributes
    ----------
    name : str
        Name in Python.
    spec : tuple
        See `option`.
    default : object
        `dataclasses.MISSING` if mandatory.
    kind : {"text", "whole", "number", "truth"}
        Type of its value, or of each of its values.
    choices : tuple
        All values, if there are few.
    is_optional : bool
        Whether None is a value: unset.
    count : int or None
        Number of its values; 0 for any, None for a scalar.
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
        """Name in JSON, without the trailing underscore of Python keywords."""
        return self.name.rstrip("_")

    @property
    def is_required(self) -> bool:
        """Whether it has no default."""
        return self.default is MISSING

    @property
    def spelling(self) -> str:
        """The user's spelling: its longest option, or its name."""
        options: list[str] = [word for word in self.spec.words.split() if word.startswith("-")]
        return max(options, key=len, default=self.name)

    def read(self, value: Any) -> Any:
        """Convert a value to the type of the field."""
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
        """Convert one element; errors as :meth:`read`."""
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
        # Without an upper end infinity is in range, for instance as no limit of time.
        if math.isnan(number) or (math.isinf(number) and not math.isinf(limits.high)):
            self.refuse(f"must be finite, not {number}")
        if not limits.hold(number):
            unit = f" {self.spec.unit}" if self.spec.unit else ""
            self.refuse(f"must be {limits.words(self.spec.unit)}, not {number:.15g}{unit}")

    def refuse(self, why: str, *, hint: str = "", is_usage: bool = False) -> None:
        """Raise RequestError for this field."""
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
    """Return the error for a value that is not among the choices of a field."""
    names = list(map(str, choices))
    why, hint = f"must be {one_of(names)}, not {shown(value)}", near_hint(str(value), names)[0]
    return RequestError(field, why, hint=hint, is_usage=True)


# --- Types of values ---


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
    if isinstance(value, float) and value.is_integer():  # JSON does not distinguish 3 from 3.0
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
    """Names the intended field if the constructor of a request is called with a wrong one."""

    if not TYPE_CHECKING:  # type checkers see the constructor itself

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
    """A request. Its values are converted and checked on construction.

    Raises
    ------
    RequestError
        If a value is invalid, a field unknown, or a mandatory one missing.
    """

    withheld: ClassVar[frozenset[str]] = frozenset()
    """Inherited fields that this request does not have: they keep their defaults."""

    def __post_init__(self) -> None:
        for record in fields_of(type(self)):
            object.__setattr__(self, record.name, record.read(getattr(self, record.name)))

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """Return a request from values of a form or a page; an empty one is unset.

        Parameters
        ----------
        values : mapping
            By field name, in JSON; unknown ones are ignored. Several values may be one text with
            blanks between.
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
        """Return the first of some fields that differs from its default; None if none does."""
        for name in names:
            record = _known(cast(Hashable, type(self))).get(name)
            if record is not None and getattr(self, name) != record.default:
                return record
        return None

    def question(self) -> dict[str, Any]:
        """Return all non-default fields on which results depend, for JSON."""
        return {
            record.name: value
            for record in fields_of(type(self))
            if not record.spec.is_idle and (value := getattr(self, record.name)) != record.default
        }

    def as_kind(self, kind: type[AnyRequest], **values: Any) -> AnyRequest:
        """Return a request of another kind with the common fields, and other values."""
        shared = {record.name: getattr(self, record.name) for record in fields_of(kind)
                  if record.name in _known(cast(Hashable, type(self)))}  # fmt: skip
        return kind(**shared | values)

    def replaced(self, **values: Any) -> Self:
        """Return a copy with other values of some fields."""
        current = {record.name: getattr(self, record.name) for record in fields_of(type(self))}
        return type(self)(**current | values)


def fields_of(kind: type[Request]) -> tuple[RequestField, ...]:
    """Return the fields of a record without withheld ones: its own, then its bases'."""
    return tuple(_known(cast(Hashable, kind)).values())


@cache
def _known(record: Hashable) -> Mapping[str, RequestField]:
    """Return the fields of a record by name."""
    kind = cast(type[Request], record)
    hints = get_type_hints(kind)
    by_name = {data_field.name: data_field for data_field in fields(kind)}
    annotations = [tuple(get_annotations(base)) for base in kind.__mro__]
    # A field redefined in a subclass keeps its position.
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
    """Return the error for an unknown field of a request.

    A user of the command may write its option, whose name in Python differs.
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
    """Return the values of some fields, checked; the default if missing."""
    records = _known(cast(Hashable, kind))
    return {
        name: records[name].read(values[name]) if name in values else records[name].default
        for name in names
    }


def _field(name: str, annotation: Any, default: Any, entry: _Spec) -> RequestField:
    """Return the record of a field from its annotation."""
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
