"""Names and numbers that carry their position in a text.

They are strings and floats: a model made of them equals one built in Python, and computes the
same.
"""

from __future__ import annotations

from typing import Any

from fuzzyarm.base.diagnostic import NOWHERE, Span

__all__ = ["Figure", "Word", "span_of"]


class Word(str):
    """A name, or a word of the language, without quotes."""

    __slots__ = ("span",)

    span: Span

    def __new__(cls, text: str, span: Span = NOWHERE) -> Word:
        """Return a name with its position."""
        word = super().__new__(cls, text)
        word.span = span
        return word

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.span)


class Figure(float):
    """A number."""

    __slots__ = ("span",)

    span: Span

    def __new__(cls, value: float, span: Span = NOWHERE) -> Figure:
        """Return a number with its position."""
        figure = super().__new__(cls, value)
        figure.span = span
        return figure

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (float(self), self.span)


def span_of(value: object) -> Span:
    """Return the position of a name or a number; NOWHERE for one built in Python."""
    span = getattr(value, "span", NOWHERE)
    return span if isinstance(span, Span) else NOWHERE
