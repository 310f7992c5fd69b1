"""The part of NumPy for a page, in plain Python, for a Python without NumPy.

It exists because Pyodide's npm package has no NumPy: the wheel of its lock file lies on Pyodide's
own server alone, out of reach of npm and pip, and a playground works without a network. Without
arrays it would have no loops, tables, surfaces and proofs, which are most of it. The playground's
use of NumPy is small: some hundred functions over small arrays, since large ones go through
kernels, which are WebAssembly (:mod:`fuzzyarm.apps.native`) and read these arrays as they read
NumPy's. :func:`install` makes ``import numpy`` find this package; beside a NumPy it does nothing. A
missing name raises an error with one clear sentence.

``tests/playground/test_arrays.py`` compares all of it with NumPy itself, to the bit.
"""

from __future__ import annotations

import importlib.util
import sys
from types import ModuleType
from typing import Any

from fuzzyarm.base.errors import FuzzyarmError


class MissingNumPyError(FuzzyarmError, AttributeError):
    """Something of NumPy that this page does not have."""


class _Any:
    """A name for annotations, never read."""

    def __class_getitem__(cls, _of: Any) -> type:
        return cls


def _own_names(part: ModuleType) -> dict[str, Any]:
    """Return the names defined in a module itself."""
    return {
        name: value
        for name, value in vars(part).items()
        if not name.startswith("_")
        and not isinstance(value, ModuleType)
        and getattr(value, "__module__", part.__name__) == part.__name__
    }


def stand_in() -> tuple[ModuleType, ModuleType]:
    """Return this package as NumPy has it, and the module of its annotations."""
    from fuzzyarm.apps.playground.arrays import (
        array,
        elementwise,
        joining,
        kinds,
        making,
        operators,
        ordering,
        positions,
        random,
        reductions,
        shapes,
    )  # fmt: skip

    operators.give_operators()
    module, typing = ModuleType("numpy", __doc__), ModuleType("numpy.typing")
    for part in (making, shapes, elementwise, positions, reductions, ordering, joining):
        vars(module).update(_own_names(part))
    vars(module).update({name: getattr(kinds, name) for name in kinds.__all__})
    vars(module).update(broadcast_to=array.broadcast_to, broadcast_shapes=array.broadcast_shapes)
    vars(module).update(
        ndarray=array.ndarray,
        intp=kinds.int64,
        complex128=_Any,
        dtype=kinds.dtype,
    )

    def missing(name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise MissingNumPyError(f"numpy.{name} is needed here, and this page has no NumPy")

    vars(typing).update(NDArray=_Any, ArrayLike=_Any)
    vars(module).update(__getattr__=missing, __path__=[], __version__="2.0")
    vars(module).update(typing=typing, random=random)
    return module, typing


def install() -> bool:
    """Use this package instead of NumPy, if there is none; return whether it was."""
    if "numpy" in sys.modules or importlib.util.find_spec("numpy") is not None:
        return False
    module, typing = stand_in()
    sys.modules |= {"numpy": module, "numpy.typing": typing, "numpy.random": module.random}
    return True
