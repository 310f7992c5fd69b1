"""Foundations of every room, without fuzzy logic.

Read :mod:`.errors` and :mod:`.diagnostic` first: an error, and a finding with its position in a
text. :mod:`.names`, :mod:`.numbers` and :mod:`.units` read words, :mod:`.files` replaces files
atomically, and never one written by a person. :mod:`.picture` is a drawing as data for terminal,
figures and page. :mod:`.lazy` loads names of a package on first use, :mod:`.extras` says how to
install a missing library, :mod:`.shipped_files` finds the shipped files.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.base import errors as errors
    from fuzzyarm.base import figure_files as figure_files
    from fuzzyarm.base import picture as picture
    from fuzzyarm.base.diagnostic import (
        Diagnostic,
        Related,
        RuleBaseError,
        Severity,
        Span,
        render_all,
    )
    from fuzzyarm.base.files import write_atomically

__all__ = [
    "Diagnostic", "Related", "RuleBaseError", "Severity", "Span", "errors", "figure_files",
    "picture", "render_all", "write_atomically",
]  # fmt: skip

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
        modules=("errors", "figure_files", "picture"),
    )
