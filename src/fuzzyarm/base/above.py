"""Calls from lower packages to functions of higher ones.

A value has methods (``rulebase.table()``) that need packages above it, which it must not import.
So it looks the function up by name, and the package at the top registers where each function is
(:func:`register`).
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

__all__ = ["function", "register"]

_HOMES: dict[str, str] = {}


def register(homes: Mapping[str, str]) -> None:
    """Register the modules of functions.

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
