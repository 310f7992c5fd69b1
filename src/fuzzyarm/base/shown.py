"""Display of values in notebooks, as a drawing in place of their name."""

from __future__ import annotations

from typing import Any

from fuzzyarm.base import above
from fuzzyarm.base.names import shortened


def one_line(value: object, words: str) -> str:
    """Return the one-line representation of a value: its type and some words."""
    return f"<{type(value).__name__} {shortened(words, 160)}>"


class Shown:
    """A value that notebooks draw.

    The drawings live in packages above the values; a value looks its own up when it is displayed.
    """

    __slots__ = ()

    def _repr_html_(self) -> str:
        """Return HTML for IPython, without scripts, names escaped."""
        drawing: str = above.function("html_of")(self)
        return drawing


class Plotted(Shown):
    """A value with a figure, which notebooks show."""

    __slots__ = ()

    def plot(self) -> Any:
        """Return the figure."""
        return above.function("figure_of")(self)


class Drawn(Shown):
    """A value that ``print`` draws as the terminal does."""

    __slots__ = ()

    def __str__(self) -> str:
        """Return the drawing as text, without colours."""
        drawing: str = above.function("text_of")(self)
        return drawing
