"""Machine code of the kernels: which are built, how they are compiled, and the module for Python.

:mod:`fuzzyarm.apps.native.roots` lists the kernels, :mod:`fuzzyarm.apps.native.build` prints them
in C (:mod:`fuzzyarm.symbolic.translation`) and compiles them with ``module.c``, when fuzzyarm
itself is built. A running fuzzyarm needs nothing of this package; :mod:`fuzzyarm.symbolic.kernels`
loads what it made.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

__all__: list[str] = []

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
