"""Machine code of the kernels: their list, compilation, and the Python module.

:mod:`fuzzyarm.apps.native.roots` lists the kernels, :mod:`fuzzyarm.apps.native.build` prints them
in C (:mod:`fuzzyarm.symbolic.translation`) and compiles them with ``module.c`` when fuzzyarm
itself is built. A running fuzzyarm needs nothing of this package;
:mod:`fuzzyarm.symbolic.kernels` loads the module.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

__all__: list[str] = []

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
