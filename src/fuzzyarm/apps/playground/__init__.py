"""The designer as a folder of files for any web server: a page with its own Python.

:mod:`fuzzyarm.apps.playground.folder` writes it; in the page :mod:`fuzzyarm.apps.playground.host`
answers, by the handlers of the designer. Where the page's Python has no NumPy,
:mod:`fuzzyarm.apps.playground.arrays` replaces it.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

__all__: list[str] = []

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)

if sys.platform == "emscripten":
    from fuzzyarm.apps.playground.arrays.module import install

    install()  # before anything imports NumPy
