"""Calls from lower packages to functions of higher ones.

A value has methods (``rulebase.table()``) from packages above its own, which it must not import.
It looks the function up by name; the top package registers the module of each function
(:func:`register`).
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

_HOMES: dict[str, str] = {}


def register(homes: Mapping[str, str]) -> None:
    """Register functions by their modules."""
    _HOMES.update(homes)


def function(name: str) -> Any:
    """Return a registered function."""
    if name not in _HOMES:
        raise LookupError(f"no module above has registered '{name}'")
    return getattr(import_module(_HOMES[name]), name)
