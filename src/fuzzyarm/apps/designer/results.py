"""What long work tells of its results: lines, pictures, files to load, a file beside the text."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from fuzzyarm.apps.designer.jobs import WindowJob
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.picture import Chart, chart_data

__all__ = ["save_beside", "tell_result"]


def tell_result(
    job: WindowJob,
    lines: Sequence[str],
    charts: Iterable[Chart] = (),
    *,
    verdict: str = "",
    files: Mapping[str, bytes] | None = None,
    so_far: bool = False,
) -> None:
    """Tell a result; another one takes the place of what is so far."""
    job.tell({
        "so_far": so_far,
        "verdict": verdict,
        "lines": list(lines),
        "panels": [panel for chart in charts for panel in chart_data(chart)],
        "files": [
            {"name": name, "address": job.offer(name, content)}
            for name, content in (files or {}).items()
        ],
    })  # fmt: skip


def save_beside(
    job: WindowJob, name: str, suffix: str, write: Callable[[Path], object], *, replace: bool
) -> None:
    """Write a file of the folder, and tell so; one that is there only where a page says so."""
    try:
        path = job.folder.beside(name, suffix)
        if path.exists() and not replace:
            job.tell({"exists": name})
            return
        write(path)
    except (FuzzyarmError, OSError) as error:
        job.check()
        job.tell({"unsaved": str(error)})
    else:
        job.tell({"saved": name})
