"""Sectors of rule bases and of a controller's static part; common parts of ``fuzzyarm prove``."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.apps.cli.command import print_json, say
from fuzzyarm.exchange.files import controller_if_any, load_rules
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.prove import ProveRequest

if TYPE_CHECKING:
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.proof.map.controllers import DriveProof

EXIT_REFUTED = 1
EXIT_UNDECIDED = 4


def exit_status(verdict: str) -> int:
    """Return the exit status of one verdict."""
    return {"refuted": EXIT_REFUTED, "undecided": EXIT_UNDECIDED}.get(verdict, 0)


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output of proofs."""

    certificate: str | None = option(
        "--certificate OUT", "write the certificate of a proof about a loop", None
    )
    plot: str | None = option(
        "--plot FIG", "with --sector, or of a loop: draw it as .png, .svg or .pdf", None
    )
    json: bool = option("--json", "print the verdicts, or the bounds, as JSON", False)


@dataclass(frozen=True, kw_only=True)
class ProveWords(ProveRequest, _Output):
    """All arguments of ``fuzzyarm prove``."""


@contextmanager
def progress() -> Iterator[Callable[[str, int, float], None]]:
    """Show the open pieces and the gap in one line of the terminal; wipe it at the end."""
    is_terminal = sys.stderr.isatty()
    last = 0.0

    def tell(statement: str, count: int, gap: float) -> None:
        nonlocal last
        now = time.monotonic()
        # An empty statement wipes the line at once.
        if not is_terminal or (statement and now - last < 0.1):
            return
        last = now
        text = ""
        if statement:
            so_far = f"{count:,} pieces" if count else "reading"
            text = f"{statement}: {so_far}"
            text += "" if math.isnan(gap) else f" open, gap {gap:.3g}"
        sys.stderr.write(f"\r\x1b[2K{text[:100]}")
        sys.stderr.flush()

    try:
        yield tell
    finally:
        tell("", 0, 0.0)


def print_sectors(request: ProveWords) -> int:
    """Carry out ``--sector``."""
    path = request.files[0]
    controller = controller_if_any(path)
    if controller is None:
        return _of_rulebase(request, path)
    proofs = print_drives(request, path, controller)
    if request.json:
        print_json(proofs, 2)
    return status_of_drives(proofs)


def status_of_drives(proofs: Sequence[DriveProof]) -> int:
    """Return the exit status: undecided if a drive may be NaN."""
    return EXIT_UNDECIDED if any(proof.hole for proof in proofs) else 0


# ── rule bases ───────────────────────────────────────────────────────────────────────


def _of_rulebase(request: ProveWords, path: str) -> int:
    from fuzzyarm.apps.show.proofs import sector_lines
    from fuzzyarm.proof.loop.orders import only_output, sectors_of

    rulebase = load_rules(path, "prove")
    with progress() as tell:
        sectors, failed = sectors_of(request, rulebase, tell)
    name = only_output(rulebase, request.output)
    if request.plot is not None and sectors:
        from fuzzyarm.apps.show.figures.panels import chart_figure
        from fuzzyarm.apps.show.sector import rulebase_sectors, sector_chart
        from fuzzyarm.base.figure_files import save_figure

        save_figure(
            chart_figure(sector_chart(rulebase_sectors(rulebase, name, sectors))), request.plot
        )
    if request.json:
        print_json({"sectors": sectors, "open": failed}, 2)
    else:
        for sector in sectors:
            say(*sector_lines(name, sector))
        for words in failed:
            say(f"no sector {words}")
        if request.plot is not None and sectors:
            say(f"{request.plot}: drawn from {path}")
    return 0 if sectors and all(sector.complete for sector in sectors) else EXIT_UNDECIDED


# ── controllers ──────────────────────────────────────────────────────────────────────


def print_drives(
    request: ProveWords, path: str, controller: ControllerText
) -> Sequence[DriveProof]:
    """Prove the static part of a controller; print it, except for JSON."""
    from fuzzyarm.apps.show.proofs import drive_lines, grouped_drives
    from fuzzyarm.proof.loop.orders import drives_of, plant_of_drives

    plant = plant_of_drives(request, controller)
    with progress() as tell:
        proofs = drives_of(request, controller, tell)
    if request.plot is not None:
        from fuzzyarm.apps.show.figures.panels import chart_figure
        from fuzzyarm.apps.show.sector import controller_sectors, sector_chart
        from fuzzyarm.base.figure_files import save_figure

        pictures = controller_sectors(controller, proofs, plant)
        if pictures:
            save_figure(chart_figure(sector_chart(pictures)), request.plot)
    if not request.json:
        for drive_proof, axes in grouped_drives(proofs):
            say(*drive_lines(path, drive_proof, axes, sectors_only=request.sector))
        if request.plot is not None:
            has_sectors = any(proof.sectors for proof in proofs)
            say(f"{request.plot}: drawn from {path}" if has_sectors else "no sector to draw")
    return proofs
