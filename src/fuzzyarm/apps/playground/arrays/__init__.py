"""The part of NumPy for a page, in plain Python, for a Python without NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

__all__: list[str] = []

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
