"""The root of all deliberate errors of fuzzyarm, and the error for a missing extra."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Self


class FuzzyarmError(Exception):
    """An error with one clear sentence for a person.

    Each subclass also inherits from the fitting builtin (``ValueError``, ``ArithmeticError``, …)
    and carries the data of the fault as attributes.

    Parameters
    ----------
    message : str
        One sentence with the offending value.
    hint : str, optional
        A remedy, if certain.
    """

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        return f"{self.message} ({self.hint})" if self.hint else self.message

    def at(self, where: str) -> Self:
        """Return the error with its context in front: a run, a scenario."""
        self.message = f"{where}: {self.message}"
        self.args = (self.message, *self.args[1:])
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        # Pickle calls the class with `args`, which subclasses do not accept.
        return _raised_elsewhere, (type(self), self.args), vars(self)


def _raised_elsewhere(kind: type[FuzzyarmError], words: tuple[Any, ...]) -> FuzzyarmError:
    """Rebuild an error from another process."""
    return kind.__new__(kind, *words)


def sentence_of(error: BaseException) -> str:
    """Return the message of an error; for unexpected ones with their type."""
    if isinstance(error, FuzzyarmError):
        return str(error)
    if isinstance(error, OSError) and error.strerror:
        return f"{f'{error.filename}: ' if error.filename else ''}{error.strerror}"
    return f"{type(error).__name__}{f': {error}' if str(error) else ''}"


class WordError(FuzzyarmError, ValueError):
    """A meaningless word on the command line or in a field of a page."""


class UsageError(WordError):
    """Unintelligible or incompatible words: wrong usage."""


@contextmanager
def of_the_command_line(*kinds: type[FuzzyarmError]) -> Iterator[None]:
    """Turn errors of these kinds into `UsageError`: the command line is at fault."""
    try:
        yield
    except kinds as error:
        raise UsageError(error.message, hint=error.hint) from None


class MissingExtraError(FuzzyarmError, ImportError):
    """A feature needs an extra that is not installed.

    Attributes
    ----------
    extra : str
        Its name in ``pyproject.toml``.
    """

    def __init__(self, extra: str, what: str) -> None:
        from fuzzyarm.base.extras import installing

        super().__init__(f"{what} needs an extra: {installing(extra)}")
        self.extra = extra


def demand_extra(module: str, extra: str, what: str) -> None:
    """Raise `MissingExtraError` unless `module` of the `extra` can be imported."""
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise MissingExtraError(extra, what)
