"""Text of any kind: positions, diagnostics, names, numbers, and files that are replaced whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.text.diagnostic import (
        Diagnostic,
        Related,
        RuleBaseError,
        Severity,
        Span,
        render_all,
    )
    from fuzzyarm.text.files import write_atomically

__all__ = [
    "Diagnostic",
    "Related",
    "RuleBaseError",
    "Severity",
    "Span",
    "render_all",
    "write_atomically",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "diagnostic": (
                "Diagnostic",
                "Related",
                "RuleBaseError",
                "Severity",
                "Span",
                "render_all",
            ),
            "files": ("write_atomically",),
        },
    )
