"""Calls with many keywords, whose names stand in one `TypedDict` each."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.text.names import near_hint

__all__ = ["ArgumentError", "demand_alone", "demand_keywords"]


class ArgumentError(FuzzyarmError, TypeError):
    """A call has no such argument, or lacks one.

    Attributes
    ----------
    argument : str
        Its name; empty where the arguments do not go together.
    """

    def __init__(self, message: str, *, argument: str = "", hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.argument = argument


RENAMED: Mapping[str, str] = MappingProxyType(
    {
        "on": "plant",
        "along": "trajectory",
        "references": "reference",
        "seconds": "time",
        "tuning": "tune",
    }
)
"""Earlier names of keywords; the options of the commands have the new ones."""


def demand_keywords(
    call: str,
    keywords: Mapping[str, object],
    kind: type,
    positional: tuple[str, ...] = (),
) -> None:
    """Raise ArgumentError for a keyword that a call does not have.

    Parameters
    ----------
    call : str
        Name of the function.
    keywords : mapping
        What it was given.
    kind : type
        A `TypedDict` with the names.
    positional : tuple of str, optional
        Names of the arguments before them.
    """
    accepted = (*positional, *kind.__annotations__)
    for name in keywords:
        if name not in kind.__annotations__:
            new = RENAMED.get(name)
            if new in accepted:
                raise ArgumentError(
                    f"{call}() has no argument '{name}'", argument=name, hint=f"it is now '{new}'"
                )
            raise unknown_argument(f"{call}()", name, accepted)


def unknown_argument(call: str, name: str, known: tuple[str, ...]) -> ArgumentError:
    """Return the error of an argument that a call does not have, with the nearest that it has."""
    hint = near_hint(name, known)[0] or f"it has {', '.join(known)}"
    return ArgumentError(f"{call} has no argument '{name}'", argument=name, hint=hint)


def demand_alone(call: str, *others: object) -> None:
    """Raise ArgumentError where anything is given beside a request.

    Parameters
    ----------
    call : str
        Name of the function.
    *others : object
        Its other arguments.
    """
    if any(other is not None and other != {} for other in others):
        raise ArgumentError(f"{call}() takes a request alone: it says all of the job")
