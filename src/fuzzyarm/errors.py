"""The root of every error that fuzzyarm raises on purpose, and that of a missing extra."""

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


class WordError(FuzzyarmError, ValueError):
    """A word on the command line, or in a field of a page, that says nothing sensible."""


class MissingExtraError(FuzzyarmError, ImportError):
    """Something needs an extra that is not installed.

    Attributes
    ----------
    extra : str
        Its name in ``pyproject.toml``.
    """

    def __init__(self, extra: str, what: str) -> None:
        from fuzzyarm.extras import installing

        super().__init__(f"{what} needs an extra: {installing(extra)}")
        self.extra = extra


def demand_extra(module: str, extra: str, what: str) -> None:
    """Raise `MissingExtraError` unless `module`, which the `extra` brings, can be imported."""
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise MissingExtraError(extra, what)
