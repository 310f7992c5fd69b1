"""What a notebook shows of a value, as a drawing in place of its name."""

from __future__ import annotations


class Shown:
    """A value that notebooks draw.

    The drawings are written in :mod:`fuzzyarm.show.notebook`, above everything that is drawn;
    a value asks for it by name, and only when it is shown.
    """

    __slots__ = ()

    def _repr_html_(self) -> str:
        """Return what IPython shows: HTML without scripts, the names in it escaped."""
        from importlib import import_module

        drawing: str = import_module("fuzzyarm.show.notebook").html_of(self)
        return drawing
