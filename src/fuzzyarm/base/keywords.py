"""Checks of keyword arguments of public calls against a `TypedDict`."""

from __future__ import annotations

import collections.abc
import os
from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType, NoneType, UnionType
from typing import Any, TypeAlias, Union, get_args, get_origin, get_type_hints

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint, shortened


class ArgumentError(FuzzyarmError, TypeError):
    """An unknown or missing argument, or one of the wrong type.

    Attributes
    ----------
    argument : str
        Its name; empty if the arguments are incompatible.
    """

    def __init__(self, message: str, *, argument: str = "", hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.argument = argument


Kind: TypeAlias = type | Callable[..., object]
"""An annotated callable that declares the arguments: a `TypedDict`, a data class or a function."""

RENAMED: Mapping[str, str] = MappingProxyType(
    {
        "on": "plant",
        "along": "trajectory",
        "references": "reference",
        "seconds": "time",
        "tuning": "tune",
    }
)
"""Old names of keywords; the options of the commands have the new ones."""


def demand_keywords(
    call: str,
    keywords: Mapping[str, object],
    kind: Kind,
    positional: tuple[str, ...] = (),
) -> None:
    """Raise ArgumentError for an unknown keyword."""
    accepted = (*positional, *kind.__annotations__)
    for name in keywords:
        if name not in kind.__annotations__:
            new = RENAMED.get(name)
            if new in accepted:
                raise ArgumentError(
                    f"{call}() has no argument '{name}'", argument=name, hint=f"it is now '{new}'"
                )
            raise unknown_argument(f"{call}()", name, accepted)


def demand_arguments(
    call: str,
    keywords: Mapping[str, object],
    kind: Kind,
    positional: tuple[str, ...] = (),
    judged: tuple[str, ...] = (),
) -> None:
    """Raise ArgumentError for an unknown keyword or a value of the wrong type."""
    demand_keywords(call, keywords, kind, positional)
    expected = _annotations(kind)
    for name, value in keywords.items():
        if name not in judged and not any(_is_a(value, one) for one in expected[name]):
            kinds = (_words(one) for one in expected[name] if one is not NoneType)
            raise wrong_argument(call, name, " or ".join(dict.fromkeys(kinds)), value)


def wrong_argument(call: str, name: str, expected: str, value: object) -> ArgumentError:
    """Return the error for an argument of the wrong type."""
    message = f"{call}() takes {expected} as '{name}', not {shortened(repr(value), 60)}"
    return ArgumentError(message, argument=name, hint=EXAMPLES.get(name, ""))


EXAMPLES: Mapping[str, str] = MappingProxyType(
    {
        "reference": "as in {'position': 'step:1'}",
        "connect": "as in {'temperature': 'T'}, from names of the controller to ports of the plant",
        "options": "fuzzyarm.control.loop.Options(seed=3) for instance",
        "tune": "lines of a tune block, as in ['peaks of e']",
        "statement": "as in 'u odd'",
    }
)
"""Hints by argument name, which has one meaning in all calls."""


def demand_path(call: str, path: object, name: str = "path") -> str:
    """Return a path argument; raise ArgumentError for anything else."""
    text = os.fspath(path) if isinstance(path, str | os.PathLike) else None
    if not isinstance(text, str):
        raise wrong_argument(call, name, "a path", path)
    return str(text)


def demand_text(call: str, text: object, name: str = "text") -> str:
    """Return a text argument; raise ArgumentError for anything else."""
    if not isinstance(text, str):
        raise wrong_argument(call, name, "text", text)
    return text


# --- Types of values ---


@cache
def _annotations(kind: Kind) -> dict[str, tuple[Any, ...]]:
    """Return the accepted types of each keyword: the members of its union."""
    return {name: _members(hint) for name, hint in get_type_hints(kind).items()}


def _members(annotation: Any) -> tuple[Any, ...]:
    if get_origin(annotation) in (Union, UnionType):
        return tuple(member for part in get_args(annotation) for member in _members(part))
    return (annotation,)


def _is_a(value: object, annotation: Any) -> bool:
    """Whether a value has a type; true for types that cannot be checked."""
    origin = get_origin(annotation) or annotation
    if origin is float:  # numbers of NumPy among them
        is_single = not getattr(value, "ndim", 0)
        return hasattr(value, "__float__") and is_single and not isinstance(value, bool)
    if origin is int:
        return hasattr(value, "__index__") and not isinstance(value, bool)
    if origin is bool:
        return type(value).__name__ in ("bool", "bool_")  # of NumPy
    if origin in (collections.abc.Sequence, tuple):  # arrays of NumPy among them
        return isinstance(value, collections.abc.Iterable) and not isinstance(value, str)
    if isinstance(origin, type) and not getattr(origin, "_is_protocol", False):
        return isinstance(value, origin)
    return True


_NAMES: Mapping[object, str] = {
    float: "a number",
    int: "a whole number",
    bool: "a truth value",
    str: "text",
    os.PathLike: "a path",
    collections.abc.Mapping: "a mapping",
    tuple: "a tuple",
    collections.abc.Sequence: "a list",
    collections.abc.Callable: "a function",
}


def _words(annotation: Any) -> str:
    """Return a type in words."""
    origin = get_origin(annotation) or annotation
    return str(_NAMES.get(origin) or getattr(origin, "__name__", str(origin)))


def unknown_argument(call: str, name: str, keywords: tuple[str, ...]) -> ArgumentError:
    """Return the error for an unknown argument, with the nearest known one as hint."""
    hint = near_hint(name, keywords)[0] or f"it has {', '.join(keywords)}"
    return ArgumentError(f"{call} has no argument '{name}'", argument=name, hint=hint)


def demand_alone(call: str, *others: object) -> None:
    """Raise ArgumentError for other arguments beside one that excludes them."""
    if any(other is not None and other != {} for other in others):
        raise ArgumentError(f"{call}() takes a request alone: it holds the whole job")
