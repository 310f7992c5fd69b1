"""Kernels in other languages: read from their own source, printed for a target.

:mod:`fuzzyarm.symbolic.translation.functions` reads a kernel and finds the type of every name; a
:class:`~fuzzyarm.symbolic.translation.targets.Target` says how a language spells what was read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

__all__: list[str] = []

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
