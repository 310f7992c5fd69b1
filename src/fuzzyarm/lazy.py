"""Names of a package that are loaded when they are used, and no others to be seen in it.

A package writes its public names three times: type checkers read its imports and ``__all__`` as
they are written, and the program reads a table of where each name lives. They agree: a test
compares them (``tests/project/test_public_names.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any

__all__ = ["lazily"]


def lazily(
    package: str,
    homes: Mapping[str, Sequence[str]],
    others: Sequence[str] = (),
    modules: Sequence[str] = (),
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a package.

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
    found = {name: name for name in modules}
    found |= {name: home for home, names in homes.items() for name in names}

    def get(name: str) -> Any:
        if name not in found:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        module = import_module(f"{package}.{found[name]}")
        return module if found[name].rpartition(".")[2] == name else getattr(module, name)

    def names() -> list[str]:
        return sorted({*found, *others})

    return get, names
