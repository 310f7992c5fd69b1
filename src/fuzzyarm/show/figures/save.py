"""Write a figure whole or not at all."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".pdf")

_METADATA: dict[str, dict[str, str | None]] = {
    ".png": {"Software": "fuzzyarm"},
    ".svg": {"Date": None, "Creator": "fuzzyarm"},
    ".pdf": {"CreationDate": None, "Creator": "fuzzyarm"},
}


class FigureFileError(FuzzyarmError, ValueError):
    """A file name that tells no format for a figure."""

    def __init__(self, path: Path) -> None:
        self.path = path
        super().__init__(
            f"'{path.name}' does not tell a figure format", hint=f"known: {', '.join(SUFFIXES)}"
        )


def require_figure_suffix(path: str | Path) -> None:
    """Raise FigureFileError unless `path` ends in .png, .svg or .pdf."""
    if Path(path).suffix.lower() not in SUFFIXES:
        raise FigureFileError(Path(path))


def save_figure(figure: Figure, path: str | Path, *, dpi: int = 150) -> None:
    """Write `figure` to a ``.png``, ``.svg`` or ``.pdf`` file; the same figure, the same bytes.

    Raises
    ------
    FigureFileError
        For any other suffix.
    OSError
        If the folder cannot be written.
    """
    require_figure_suffix(path)
    import matplotlib as mpl

    suffix = Path(path).suffix.lower()
    out = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "fuzzyarm", "svg.fonttype": "none"}):
        figure.savefig(out, format=suffix[1:], dpi=dpi, metadata=_METADATA[suffix])
    write_atomically(path, out.getvalue())
