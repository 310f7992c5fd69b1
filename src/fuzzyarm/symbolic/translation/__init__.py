"""Kernels in other languages: parsed from their source, printed for a target.

:mod:`fuzzyarm.symbolic.translation.functions` parses a kernel and infers the type of every name; a
:class:`~fuzzyarm.symbolic.translation.targets.Target` has the spelling of a language.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

__all__: list[str] = []

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
