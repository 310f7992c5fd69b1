"""Names of a package loaded on first use; no others visible in it.

A package lists its public names twice: for type checkers as imports and ``__all__``, for the
program as a table of homes. A test compares them (``tests/project/test_public_names.py``).

A package binds the result of :func:`lazily` out of sight of type checkers
(``if not TYPE_CHECKING``): with a visible ``__getattr__`` every misspelt name would type-check.
"""

from __future__ import annotations

import importlib
import os
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any

from fuzzyarm.base.errors import MissingExtraError


def lazily(
    package: str,
    homes: Mapping[str, Sequence[str]],
    others: Sequence[str] = (),
    modules: Sequence[str] = (),
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a package.

    A name is looked up once and then kept in the package, as SPEC 1 of Scientific Python
    recommends. A name whose extra is missing raises AttributeError, because help, completion and
    ``hasattr`` go through all names; importing its module names the extra.
    """
    homes_of = {name: name for name in modules}
    homes_of |= {name: home for home, names in homes.items() for name in names}

    def get(name: str) -> Any:
        if name not in homes_of:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        home = homes_of[name]
        try:
            module = import_module(f"{package}.{home}")
        except MissingExtraError as error:
            raise AttributeError(str(error)) from error
        value = module if home.rpartition(".")[2] == name else getattr(module, name)
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*homes_of, *others})

    return get, names


# --- Threads that import ---


def load_packages(*packages: str) -> None:
    """Import packages that threads need, before there are any.

    A thread that imports a module locks it before its package, one that imports the package locks
    them the other way round: Python detects the deadlock, and gives one of them a partly
    initialised module.
    """
    for package in packages:
        import_module(package)


# --- Processes that fork ---

_LONGEST_WAIT = 10.0
"""Longest wait for imports of other threads before a fork, s: one of them may wait for the fork."""


def _await_imports() -> None:
    """Wait until no other thread imports: a forked child would wait for its import lock forever."""
    locks = getattr(getattr(importlib, "_bootstrap", None), "_module_locks", {})
    own, until = threading.get_ident(), time.monotonic() + _LONGEST_WAIT
    while time.monotonic() < until:
        owners = [getattr(made, "owner", None) for made in (of() for of in list(locks.values()))]
        if not any(owner not in (None, own) for owner in owners):
            return
        time.sleep(0.001)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_await_imports)
