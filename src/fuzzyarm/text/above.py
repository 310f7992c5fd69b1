"""Functions that stand above whoever calls them.

A value answers questions (``rulebase.table()``) by packages that know the value, and which the
value must not know. So it asks by the name of the function, and the package at the top, which
knows them all, has said where each is (:func:`register`).
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

__all__ = ["function", "register"]

_HOMES: dict[str, str] = {}


def register(homes: Mapping[str, str]) -> None:
    """Say where functions are.

    Parameters
    ----------
    homes : mapping of str to str
        From the name of a function to its module, which is loaded when the function is asked for.
    """
    _HOMES.update(homes)


def function(name: str) -> Any:
    """Return a function that was registered."""
    if name not in _HOMES:
        raise LookupError(f"no module above has registered '{name}'")
    return getattr(import_module(_HOMES[name]), name)
