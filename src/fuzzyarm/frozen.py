"""Frozen data classes and named tuples whose methods are written when they are first called.

What :mod:`dataclasses` and :mod:`typing` do, for the modules that a short command imports. A check
of a rule base takes some sixty milliseconds, and the standard library's way took as long again:
it compiles six methods of each data class, most of which such a command never calls, it compiles
the text of each annotation of a named tuple, and it imports :mod:`inspect`. Here a class gets a
place holder for each method (:class:`_Unwritten`), which compiles it when it is looked up.

To a type checker these are the standard library's. So they are to ``dataclasses.fields``,
``replace`` and ``asdict``, which ask for ``__dataclass_fields__``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

try:
    from _collections import _tuplegetter as _item  # type: ignore[import-not-found]
except ImportError:  # as the standard library does where its C is missing

    def _item(index: int, doc: str) -> Any:
        from operator import itemgetter

        return property(itemgetter(index), doc=doc)


__all__ = ["NamedTuple", "dataclass", "field", "replace"]

if TYPE_CHECKING:
    from dataclasses import dataclass, field, replace
    from typing import NamedTuple
else:
    _Class = TypeVar("_Class", bound=type)
    _Record = TypeVar("_Record")

    def dataclass(
        *,
        frozen: bool,
        slots: bool = False,
        eq: bool = True,
        repr: bool = True,  # noqa: A002
    ) -> Callable[[_Class], _Class]:
        """Return what makes a frozen data class of a class; as ``dataclasses.dataclass``.

        Parameters
        ----------
        frozen : bool
            True: nothing else is made here.
        slots : bool
            Whether objects have room for the fields only.
        eq : bool
            Whether objects with equal fields are equal, and have a hash of them.
        repr : bool
            Whether a representation is written.
        """
        assert frozen
        compared = ("__eq__", "__hash__") if eq else ()
        methods = ("__repr__",) if repr else ()
        return lambda cls: _frozen(cls, ("__init__", *compared, *methods), slots=slots)

    def field(**of: Any) -> Any:
        """Return what stands behind a field: `default`, `default_factory`, `compare`, `repr`."""
        return _Settings(of)

    def replace(record: _Record, /, **changes: Any) -> _Record:
        """Return a record with other values in some fields."""
        fields = ((name, getattr(record, name)) for name in record.__match_args__)
        return type(record)(**(dict(fields) | changes))

    class _TupleType(type):
        """Makes a tuple with names of what is written below ``class X(NamedTuple)``."""

        def __new__(cls, name: str, bases: tuple[type, ...], space: dict[str, Any]) -> type:
            if not bases:
                return super().__new__(cls, name, bases, space)
            return _named_tuple(name, space)

    class NamedTuple(metaclass=_TupleType):
        """As ``typing.NamedTuple``, without the call that makes a class of a list."""


class _Settings(dict[str, Any]):
    """The settings of a field behind its equals sign."""


class _Field:
    """One field: its name, its type as written, and its settings."""

    __slots__ = ("annotation", "name", "settings")

    def __init__(self, name: str, annotation: str, settings: _Settings) -> None:
        self.name = name
        self.annotation = annotation
        self.settings = settings


_ABSENT = object()
"""Marks a missing default and a missing argument."""


def _frozen(cls: Any, written: Sequence[str], *, slots: bool) -> Any:
    """Return the data class of a class: another object where its fields become slots."""
    foreign = [b for b in cls.__mro__ if "__dataclass_params__" in vars(b) and not _own_fields(b)]
    assert not foreign, "what a data class inherits from is made here, too"
    declared_fields = tuple(_fields_in(vars(cls)))
    fields = {field.name: field for base in reversed(cls.__mro__) for field in _own_fields(base)}
    fields |= {field.name: field for field in declared_fields}
    added: dict[str, Any] = {name: _Unwritten(name) for name in written} | _FREEZING
    added |= _STATE if slots else {}
    added = {name: value for name, value in added.items() if not _defines(cls, name)}
    added |= {name: _Unwritten(name) for name in _OF_LIBRARY}
    added |= {"_own_fields": declared_fields, "_all_fields": tuple(fields.values())}
    added |= {"__match_args__": tuple(fields)}
    whole = (
        _with_slots(cls, declared_fields, added)
        if slots
        else _with_defaults(cls, declared_fields, added)
    )
    # With slots this is a new class, so the methods learn only now whose they are.
    for value in added.values():
        if isinstance(value, _Unwritten):
            value.cls = whole
    return whole


def _defines(cls: Any, name: str) -> bool:
    """Whether the body of a class has a method; Python's ``__hash__ = None`` does not count."""
    return vars(cls).get(name) is not None


def _with_defaults(cls: Any, own_fields: Sequence[_Field], added: Mapping[str, Any]) -> Any:
    """Add to a class, which has the defaults of its fields as attributes."""
    for field in own_fields:
        if isinstance(vars(cls).get(field.name), _Settings):
            delattr(cls, field.name)
        if "default" in field.settings:
            setattr(cls, field.name, field.settings["default"])
    for name, value in added.items():
        setattr(cls, name, value)
    return cls


def _with_slots(cls: Any, own_fields: Sequence[_Field], added: dict[str, Any]) -> Any:
    """Return a class as another that has slots, which are there from the beginning or never."""
    names = {field.name for field in own_fields}
    left_out = {"__dict__", "__weakref__", *names}
    space = {name: value for name, value in vars(cls).items() if name not in left_out}
    above = {name for base in cls.__mro__ for name in getattr(base, "__slots__", ())}
    space["__slots__"] = tuple(field.name for field in own_fields if field.name not in above)
    whole = type(cls)(cls.__name__, cls.__bases__, space | added)
    whole.__qualname__ = cls.__qualname__
    return whole


def _own_fields(cls: type) -> tuple[_Field, ...]:
    fields: tuple[_Field, ...] = vars(cls).get("_own_fields", ())
    return fields


def _fields_in(space: Mapping[str, Any]) -> Iterator[_Field]:
    """Yield the fields that the body of a class names; its annotations are texts."""
    for name, annotation in space.get("__annotations__", {}).items():
        if annotation.startswith("ClassVar"):
            continue
        value = space.get(name, _ABSENT)
        if not isinstance(value, _Settings):
            value = _Settings() if value is _ABSENT else _Settings(default=value)
        yield _Field(name, annotation, value)


def _named_tuple(name: str, space: dict[str, Any]) -> type:
    """Return the class of tuples with the fields that the body of a class names."""
    declared_fields = tuple(_fields_in(space))
    names = tuple(field.name for field in declared_fields)
    space |= {
        field.name: _item(index, f"Field {index}") for index, field in enumerate(declared_fields)
    }
    space |= {
        "__slots__": (),
        "__match_args__": names,
        "_fields": names,
        "_field_defaults": {
            field.name: field.settings["default"]
            for field in declared_fields
            if "default" in field.settings
        },
        "_own_fields": declared_fields,
        "__new__": _Unwritten("__new__"),
    }
    whole = type(name, (tuple,), _OF_TUPLES | space)
    space["__new__"].cls = whole
    return whole


# --- Methods that are written when they are looked up ---


class _Unwritten:
    """Stands for a method of a class until it is looked up, and then writes it."""

    cls: Any

    def __init__(self, name: str) -> None:
        self.name = name

    def __get__(self, record: object, owner: type) -> Any:
        written = _WRITERS[self.name](self.cls)
        # The method takes the place of this descriptor: the next call finds it directly.
        setattr(self.cls, self.name, written)
        return getattr(owner if record is None else record, self.name)


def _method(
    cls: Any, name: str, arguments: Sequence[str], lines: Sequence[str], **names: Any
) -> Any:
    """Return a method of some lines, which know the names."""
    # Source text, as in the standard library: signature, errors and speed are those of a method
    # written by hand.
    text = f"def {name}({', '.join(arguments)}):\n  " + "\n  ".join(lines)
    exec(text, names)
    method = names[name]
    method.__qualname__ = f"{cls.__qualname__}.{name}"
    method.__module__ = cls.__module__
    return method


def _init(cls: Any) -> Any:
    """Write ``__init__``: each argument into its field, then ``__post_init__``."""
    names: dict[str, Any] = {"_put": object.__setattr__, "_ABSENT": _ABSENT}
    arguments, lines = ["self"], []
    for entry in cls._all_fields:
        value, argument = entry.name, entry.name
        if "default" in entry.settings:
            names[f"_default_{entry.name}"] = entry.settings["default"]
            argument += f"=_default_{entry.name}"
        elif "default_factory" in entry.settings:
            names[f"_make_{entry.name}"] = entry.settings["default_factory"]
            argument += "=_ABSENT"
            value = f"_make_{entry.name}() if {entry.name} is _ABSENT else {entry.name}"
        arguments.append(argument)
        lines.append(f"_put(self, {entry.name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    init = _method(cls, "__init__", arguments, lines or ["pass"], **names)
    init.__annotations__ = {entry.name: entry.annotation for entry in cls._all_fields}
    init.__annotations__["return"] = None
    return init


def _new(cls: Any) -> Any:
    """Write ``__new__`` of a named tuple."""
    names: dict[str, Any] = {"_new_tuple": tuple.__new__}
    arguments = ["_cls"]
    for entry in cls._own_fields:
        arguments.append(entry.name)
        if "default" in entry.settings:
            names[f"_default_{entry.name}"] = entry.settings["default"]
            arguments[-1] += f"=_default_{entry.name}"
    items = "".join(f"{name}, " for name in cls._fields)
    new = _method(cls, "__new__", arguments, [f"return _new_tuple(_cls, ({items}))"], **names)
    new.__annotations__ = {entry.name: entry.annotation for entry in cls._own_fields}
    return staticmethod(new)


def _values(cls: Any, record: str) -> str:
    """Return the text of a tuple of what is compared of a record."""
    compared = (entry.name for entry in cls._all_fields if entry.settings.get("compare", True))
    return f"({''.join(f'{record}.{name}, ' for name in compared)})"


def _eq(cls: Any) -> Any:
    lines = [
        "if other.__class__ is self.__class__:",
        f"  return {_values(cls, 'self')} == {_values(cls, 'other')}",
        "return NotImplemented",
    ]
    return _method(cls, "__eq__", ["self", "other"], lines)


def _hash(cls: Any) -> Any:
    return _method(cls, "__hash__", ["self"], [f"return hash({_values(cls, 'self')})"])


def _repr(cls: Any) -> Any:
    from reprlib import recursive_repr

    shown = [entry.name for entry in cls._all_fields if entry.settings.get("repr", True)]
    words = ", ".join(f"{name}={{self.{name}!r}}" for name in shown)
    lines = [f"return self.__class__.__qualname__ + f'({words})'"]
    return recursive_repr()(_method(cls, "__repr__", ["self"], lines))


def _of_library(name: str) -> Callable[[Any], Any]:
    """Return what reads an attribute of the class that the standard library would have made."""

    def read(cls: Any) -> Any:
        import dataclasses

        fields = [
            (entry.name, entry.annotation, dataclasses.field(**entry.settings))
            for entry in cls._all_fields
        ]
        return getattr(dataclasses.make_dataclass(cls.__name__, fields, frozen=True), name)

    return read


_OF_LIBRARY = ("__dataclass_fields__", "__dataclass_params__")

_WRITERS: dict[str, Callable[[Any], Any]] = {
    "__new__": _new,
    "__init__": _init,
    "__eq__": _eq,
    "__hash__": _hash,
    "__repr__": _repr,
    **{name: _of_library(name) for name in _OF_LIBRARY},
}


# --- Methods that are the same for all ---


def _refuse_to_set(self: Any, name: str, value: object) -> None:
    if _is_frozen(self, name):
        _refuse("assign to", name)
    object.__setattr__(self, name, value)


def _refuse_to_delete(self: Any, name: str) -> None:
    if _is_frozen(self, name):
        _refuse("delete", name)
    object.__delattr__(self, name)


def _is_frozen(self: Any, name: str) -> bool:
    """Whether an attribute is a field; a plain class below may have attributes of its own."""
    return name in self.__match_args__ or "_all_fields" in vars(type(self))


def _refuse(what: str, name: str) -> NoReturn:
    from dataclasses import FrozenInstanceError

    raise FrozenInstanceError(f"cannot {what} field {name!r}")


_FREEZING = {"__setattr__": _refuse_to_set, "__delattr__": _refuse_to_delete}


def _state(self: Any) -> list[Any]:
    return [getattr(self, name) for name in self.__match_args__]


def _set_state(self: Any, state: list[Any]) -> None:
    for name, value in zip(self.__match_args__, state, strict=True):
        object.__setattr__(self, name, value)


_STATE = {"__getstate__": _state, "__setstate__": _set_state}
"""How objects with slots are pickled; it is for frozen ones to say."""


def _make(cls: Any, values: Iterable[Any]) -> Any:
    """Return a named tuple of the items of something."""
    whole = tuple.__new__(cls, values)
    if len(whole) != len(cls._fields):
        raise TypeError(f"Expected {len(cls._fields)} arguments, got {len(whole)}")
    return whole


def _replace(self: Any, /, **changes: Any) -> Any:
    """Return a named tuple with other values in some fields."""
    whole = self._make(
        [changes.pop(name, item) for name, item in zip(self._fields, self, strict=True)]
    )
    if changes:
        raise ValueError(f"Got unexpected field names: {list(changes)!r}")
    return whole


def _asdict(self: Any) -> dict[str, Any]:
    """Return the items by the names of the fields."""
    return dict(zip(self._fields, self, strict=True))


def _tuple_repr(self: Any) -> str:
    words = (f"{name}={item!r}" for name, item in zip(self._fields, self, strict=True))
    return f"{self.__class__.__name__}({', '.join(words)})"


def _new_arguments(self: Any) -> tuple[Any, ...]:
    """Return itself as a plain tuple: what pickle and copy make it of again."""
    return tuple(self)


_OF_TUPLES: dict[str, Any] = {
    "_make": classmethod(_make),
    "_replace": _replace,
    "_asdict": _asdict,
    "__repr__": _tuple_repr,
    "__getnewargs__": _new_arguments,
}
