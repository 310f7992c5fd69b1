"""What a notebook shows of a value, as a drawing in place of its name."""

from __future__ import annotations

from typing import Any

from fuzzyarm.base import above
from fuzzyarm.base.names import shortened


def one_line(value: object, words: str) -> str:
    """Return how a value is shown among others: its kind and some words, on one line."""
    return f"<{type(value).__name__} {shortened(words, 160)}>"


class Shown:
    """A value that notebooks draw.

    The drawings stand above everything that is drawn; a value asks for its own when it is shown.
    """

    __slots__ = ()

    def _repr_html_(self) -> str:
        """Return what IPython shows: HTML without scripts, the names in it escaped."""
        drawing: str = above.function("html_of")(self)
        return drawing


class Plotted(Shown):
    """A value that has a figure; notebooks show that."""

    __slots__ = ()

    def plot(self) -> Any:
        """Return its figure."""
        return above.function("figure_of")(self)


class Drawn(Shown):
    """A value that ``print`` draws too, as it is drawn in the terminal."""

    __slots__ = ()

    def __str__(self) -> str:
        """Return the drawing as text, without colours."""
        drawing: str = above.function("text_of")(self)
        return drawing
