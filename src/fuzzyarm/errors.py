"""The root of every error that fuzzyarm raises on purpose."""

from __future__ import annotations


class FuzzyarmError(Exception):
    """What went wrong, in one clear sentence to a person.

    Each subclass also inherits from the builtin that fits it (``ValueError``,
    ``ArithmeticError``, …) and carries the data of the fault as attributes.

    Parameters
    ----------
    message : str
        One sentence: what is wrong, with the offending value in it.
    hint : str, optional
        What to do about it, where that is certain.
    """

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        return f"{self.message} ({self.hint})" if self.hint else self.message
