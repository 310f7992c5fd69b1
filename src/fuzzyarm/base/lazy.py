"""Names of a package that are loaded when they are used, and no others to be seen in it.

A package writes its public names three times: type checkers read its imports and ``__all__`` as
they are written, and the program reads a table of where each name lives. They agree: a test
compares them (``tests/project/test_public_names.py``).

A package binds what :func:`lazily` returns where type checkers do not look
(``if not TYPE_CHECKING``): a ``__getattr__`` that they see has every name, a slip of the pen too.
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

    A name is looked up once: the package keeps what it loaded, as SPEC 1 of Scientific Python has
    it. A name whose extra is not installed raises AttributeError, for help, completion and
    ``hasattr`` go through all names of a package; importing its module says which extra it is.

    Parameters
    ----------
    package : str
        Its name.
    homes : mapping of str to sequence of str
        From a module of the package to the public names that it has. A module that is public
        itself has its own name among them.
    others : sequence of str
        Further public names, which the package has already.
    modules : sequence of str
        Modules of the package that are public themselves.
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


# --- Processes that fork ---

_LONGEST_WAIT = 10.0
"""Of a fork for the imports of other threads, s: one of them may wait for what forks."""


def _await_imports() -> None:
    """Wait until no other thread imports: a forked process would wait for its lock for ever."""
    locks = getattr(getattr(importlib, "_bootstrap", None), "_module_locks", {})
    own, until = threading.get_ident(), time.monotonic() + _LONGEST_WAIT
    while time.monotonic() < until:
        owners = [getattr(made, "owner", None) for made in (of() for of in list(locks.values()))]
        if not any(owner not in (None, own) for owner in owners):
            return
        time.sleep(0.001)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_await_imports)
