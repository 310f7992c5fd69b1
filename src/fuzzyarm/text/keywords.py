"""Calls with many keywords, whose names stand in one `TypedDict` each."""

from __future__ import annotations

from collections.abc import Mapping

from fuzzyarm.text.names import near_hint

__all__ = ["demand_keywords"]


def demand_keywords(call: str, keywords: Mapping[str, object], kind: type) -> None:
    """Raise TypeError for a keyword that a call does not have.

    Parameters
    ----------
    call : str
        Name of the function.
    keywords : mapping
        What it was given.
    kind : type
        A `TypedDict` with the names.
    """
    known = kind.__annotations__
    for name in keywords:
        if name not in known:
            hint = near_hint(name, known)[0]
            message = f"{call}() got an unexpected keyword argument '{name}'"
            raise TypeError(f"{message} ({hint})" if hint else message)
