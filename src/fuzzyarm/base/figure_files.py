"""Figures of matplotlib as files, written atomically."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.base.errors import UsageError
from fuzzyarm.base.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "SUFFIXES", "FigureFileError", "figure_bytes", "plain_powers", "require_figure_suffix",
    "save_figure",
]  # fmt: skip

SUFFIXES = (".png", ".svg", ".pdf", ".jpg", ".webp")

_METADATA: dict[str, dict[str, str | None]] = {
    ".png": {"Software": "fuzzyarm"},
    ".svg": {"Date": None, "Creator": "fuzzyarm"},
    ".pdf": {"CreationDate": None, "Creator": "fuzzyarm"},
}


class FigureFileError(UsageError):
    """A file name without a known figure suffix."""

    def __init__(self, path: Path) -> None:
        self.path = path
        super().__init__(
            f"'{path.name}' does not have the suffix of a figure",
            hint=f"known: {', '.join(SUFFIXES)}",
        )


def require_figure_suffix(path: str | Path) -> None:
    """Raise FigureFileError unless `path` has the suffix of a figure."""
    if Path(path).suffix.lower() not in SUFFIXES:
        raise FigureFileError(Path(path))


def save_figure(figure: Figure, path: str | Path, *, dpi: int = 150) -> None:
    """Write `figure` in the format of the suffix; equal figures give equal bytes.

    Parameters
    ----------
    figure : Figure
        A matplotlib figure.
    path : path-like
        Its suffix, one of ``SUFFIXES``, is the format.
    dpi : int
        Resolution of pixel formats.

    Raises
    ------
    FigureFileError
        For any other suffix.
    OSError
        If the folder cannot be written.
    """
    require_figure_suffix(path)
    write_atomically(path, figure_bytes(figure, Path(path).suffix.lower(), dpi=dpi))


def figure_bytes(figure: Figure, suffix: str, *, dpi: int = 150) -> bytes:
    """Return the file content of `figure`; equal figures give equal bytes."""
    import matplotlib as mpl

    out = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "fuzzyarm", "svg.fonttype": "none"}), _settled(figure):
        figure.savefig(out, format=suffix[1:], dpi=dpi, metadata=_METADATA.get(suffix))
    return out.getvalue()


@contextlib.contextmanager
def _settled(figure: Figure) -> Iterator[None]:
    """Lay a figure out once, rounded to a millionth: the solver's last digits vary."""
    engine = figure.get_layout_engine()
    if engine is None:
        yield
        return
    engine.execute(figure)
    figure.set_layout_engine("none")
    for axes in figure.axes:
        axes.set_position([round(part, 6) for part in axes.get_position(original=True).bounds])  # type: ignore[arg-type]
        axes.set_in_layout(True)
    try:
        yield
    finally:
        figure.set_layout_engine(engine)


def plain_powers(axes: Axes, which: str, low: float, high: float) -> None:
    """Label a logarithmic axis with plain numbers, on a narrow one between powers of ten, too.

    Below two powers of ten 2 and 5 are labelled as well, below a third of one every digit: more
    would overlap.
    """
    from matplotlib.ticker import FuncFormatter

    axis = axes.xaxis if which == "x" else axes.yaxis

    def between(value: float, _position: int) -> str:
        is_round = f"{value:e}"[0] in "25"
        return f"{value:.4g}" if is_round or high < 2.5 * low else ""

    axis.set_major_formatter(FuncFormatter(lambda value, _position: f"{value:.4g}"))
    axis.set_minor_formatter(FuncFormatter(between if high < 100.0 * low else lambda *_: ""))
    axes.tick_params(axis=which, which="minor", labelsize=8)  # type: ignore[arg-type]
