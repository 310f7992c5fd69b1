"""Failures for a page: a mistake in words, or a fault of the program.

A mistake (`FuzzyarmError`, `OSError`) is a sentence for the person at the page. Anything else is an
internal error: the page reports it, and the trace is in the log ``fuzzyarm.apps.designer``, written
to the standard error of ``fuzzyarm designer``.
"""

from __future__ import annotations

import logging
from typing import Any

from fuzzyarm.apps.designer.names import in_words
from fuzzyarm.apps.designer.threads import IN_A_PAGE
from fuzzyarm.base.errors import FuzzyarmError

LOG = logging.getLogger("fuzzyarm.apps.designer")


class TextRefusedError(FuzzyarmError, ValueError):
    """A text that cannot be run, drawn or tuned as requested."""


def error_of(error: Exception, doing: str) -> dict[str, Any]:
    """Return the fields of an answer about an error; ``internal`` marks a fault of the program."""
    if isinstance(error, FuzzyarmError | OSError):
        return {"error": in_words(error)}
    return {"error": internal_words(error, doing), "internal": True}


def internal_words(error: BaseException, doing: str) -> str:
    """Write the trace of a fault into the log; return a sentence for the page."""
    if IN_A_PAGE and isinstance(error, ModuleNotFoundError):  # no fault: a page has few packages
        return f"{error.name} is needed here, and this page does not have it; a computer has"
    LOG.error("internal error: %s", doing, exc_info=error)
    return f"internal error: {error!r}; the log of the designer has its trace"
