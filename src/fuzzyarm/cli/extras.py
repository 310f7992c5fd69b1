"""What is installed only on request."""

from __future__ import annotations

import importlib.util

from fuzzyarm.errors import FuzzyarmError


class MissingExtraError(FuzzyarmError, ImportError):
    """A command needs an extra that is not installed.

    Attributes
    ----------
    extra : str
        Its name in ``fuzzyarm[...]``.
    """

    def __init__(self, extra: str, what: str) -> None:
        super().__init__(f'{what} needs an extra: pip install "fuzzyarm[{extra}]"')
        self.extra = extra


def demand_extra(module: str, extra: str, what: str) -> None:
    """Raise `MissingExtraError` unless `module` can be imported.

    Parameters
    ----------
    module : str
        The library that the extra brings.
    extra : str
        The name of the extra.
    what : str
        What needs it, for the message.
    """
    if importlib.util.find_spec(module) is None:
        raise MissingExtraError(extra, what)
