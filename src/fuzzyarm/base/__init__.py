"""What every room needs, and what knows of no fuzzy logic.

Read :mod:`.errors` first: what goes wrong is an error or a finding,
with its position in a text (:mod:`.diagnostic`). :mod:`.names` and :mod:`.numbers` read words,
:mod:`.files` replaces files atomically, and never one that a person wrote. :mod:`.picture` is a
drawing as data: terminal, figures and page draw it. :mod:`.lazy` loads names of a package when
they are used, :mod:`.extras` says how to install what is missing, :mod:`.shipped_files` finds the
files that come along.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
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
