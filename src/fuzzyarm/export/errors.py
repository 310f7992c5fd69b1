"""What cannot be exported."""

from __future__ import annotations

from fuzzyarm.errors import FuzzyarmError


class ExportError(FuzzyarmError, ValueError):
    """A rule base, a table or an option that the target language cannot express."""
