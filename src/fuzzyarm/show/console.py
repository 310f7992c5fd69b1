"""The console that drawings are made for."""

from __future__ import annotations

from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console, RenderableType


def make_console(file: IO[str] | None = None, **options: Any) -> Console:
    """Return a rich console that leaves numbers and brackets as they are.

    Where the output is no terminal it has no colours and is 80 columns wide, unless the
    environment (COLUMNS, FORCE_COLOR, NO_COLOR) says otherwise.

    Parameters
    ----------
    file : file, optional
        Where to write; the standard output by default.
    **options
        Passed on to :class:`rich.console.Console`.
    """
    from rich.console import Console

    settings: dict[str, Any] = {"highlight": False, "markup": False, "emoji": False}
    return Console(file=file, **(settings | options))


def plain_text(drawing: RenderableType, width: int = 80) -> str:
    """Return a drawing as text without colours, for logs, hovers and reports."""
    import io

    out = io.StringIO()
    console = make_console(out, width=width, no_color=True, force_terminal=False)
    console.print(drawing)
    return "\n".join(line.rstrip() for line in out.getvalue().splitlines()) + "\n"
