"""What every room needs, and what knows of no fuzzy logic.

Read :mod:`.errors` and :mod:`.diagnostic` first: an error, and a finding with its place in a text.
:mod:`.names` and :mod:`.numbers` read words, :mod:`.files` replaces files atomically, and never
one that a person wrote. :mod:`.picture` is a drawing as data: terminal, figures and page draw it.
:mod:`.lazy` loads names of a package when they are used, :mod:`.extras` says how to install a
missing library, :mod:`.shipped_files` finds the files that come along.
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
    "Diagnostic",
    "Related",
    "RuleBaseError",
    "Severity",
    "Span",
    "errors",
    "figure_files",
    "picture",
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
        modules=("errors", "figure_files", "picture"),
    )
