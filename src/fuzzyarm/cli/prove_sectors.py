"""Sectors of rule bases and the static part of controllers; what ``fuzzyarm prove`` shares."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fuzzyarm.api import controller_if_any, load_rules
from fuzzyarm.cli.command import print_json, say
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.prove import ProveRequest

if TYPE_CHECKING:
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.proof.controllers import DriveProof, DriveSector
    from fuzzyarm.proof.sector import Sector

EXIT_REFUTED = 1
EXIT_UNDECIDED = 4


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """What a command writes and draws of proofs."""

    certificate: str | None = option(
        "--certificate OUT", "write the certificate of what is proved of a loop", None
    )
    plot: str | None = option(
        "--plot FIG", "with --sector, or of a loop: draw it as .png, .svg or .pdf", None
    )
    json: bool = option("--json", "print the verdicts, or the bounds, as JSON", False)


@dataclass(frozen=True, kw_only=True)
class ProveWords(ProveRequest, _Output):
    """All that ``fuzzyarm prove`` takes."""


@contextmanager
def progress() -> Iterator[Callable[[str, int, float], None]]:
    """Show the open pieces and the gap in one line of the terminal; wipe it afterwards."""
    is_terminal = sys.stderr.isatty()
    last = 0.0

    def tell(statement: str, count: int, gap: float) -> None:
        nonlocal last
        now = time.monotonic()
        # An empty statement wipes the line, and is never held back.
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


def print_sectors(asked: ProveWords) -> int:
    """Do what ``--sector`` says."""
    path = asked.files[0]
    controller = controller_if_any(path)
    if controller is None:
        return _of_rulebase(asked, path)
    data = print_drives(asked, path, controller)
    if asked.json:
        print_json(data, 2)
    return 0


# ── rule bases ───────────────────────────────────────────────────────────────────────


def _of_rulebase(asked: ProveWords, path: str) -> int:
    from fuzzyarm.closed_loop.orders import only_output, sectors_of

    rulebase = load_rules(path, "prove")
    with progress() as tell:
        sectors, failed = sectors_of(asked, rulebase, tell)
    name = only_output(rulebase, asked.output)
    if asked.plot is not None and sectors:
        from fuzzyarm.figure_files import save_figure
        from fuzzyarm.show.figures.panels import chart_figure
        from fuzzyarm.show.sector import rulebase_sectors, sector_chart

        save_figure(
            chart_figure(sector_chart(rulebase_sectors(rulebase, name, sectors))), asked.plot
        )
    if asked.json:
        print_json({"sectors": [_sector_data(sector) for sector in sectors], "open": failed}, 2)
    else:
        for sector in sectors:
            say(*_sector_lines(name, sector))
        for words in failed:
            say(f"no sector {words}")
        if asked.plot is not None and sectors:
            say(f"{asked.plot}: drawn from {path}")
    return 0 if sectors and all(sector.complete for sector in sectors) else EXIT_UNDECIDED


def _sector_data(found: Sector) -> dict[str, Any]:
    return {
        "weights": {name: float(weight) for name, weight in found.weights.items()},
        "low": found.low,
        "high": found.high,
        "at_low": found.at_low,
        "at_high": found.at_high,
        "slack": found.slack,
        "pieces": found.pieces,
    }


def _sector_lines(output: str, found: Sector) -> list[str]:
    from fuzzyarm.proof.prover import written
    from fuzzyarm.proof.sector import form_text

    slack = f", to {found.slack:g}" if found.slack else ""
    lines = [
        f"{output} between {_bounds(found.low, found.high)} times"
        f" {form_text(found.weights)} (proved{slack})"
    ]
    for word, at in (("lowest", found.at_low), ("highest", found.at_high)):
        if at:
            lines.append(f"  {word} near {written(at)}")
    if not found.complete:
        lines.append("  time ran out before the bounds were tight")
    return [*lines, f"  {found.pieces:,} pieces, in exact arithmetic"]


def _bounds(low: float, high: float) -> str:
    from fuzzyarm.text.numbers import outward_text

    return f"{outward_text(low, up=False)} and {outward_text(high, up=True)}"


# ── controllers ──────────────────────────────────────────────────────────────────────


def print_drives(asked: ProveWords, path: str, controller: ControllerText) -> list[dict[str, Any]]:
    """Prove the static part of a controller, print it unless as data, and return the data."""
    from fuzzyarm.closed_loop.orders import drives_of
    from fuzzyarm.plant import find_plant

    plant = find_plant(asked.plant) if asked.plant is not None else None
    with progress() as tell:
        proofs = drives_of(asked, controller, tell)
    if asked.plot is not None:
        from fuzzyarm.figure_files import save_figure
        from fuzzyarm.show.figures.panels import chart_figure
        from fuzzyarm.show.sector import controller_sectors, sector_chart

        pictures = controller_sectors(controller, proofs, plant)
        if pictures:
            save_figure(chart_figure(sector_chart(pictures)), asked.plot)
    if not asked.json:
        for each, axes in _grouped(proofs):
            say(*_drive_lines(path, each, axes, sectors_only=asked.sector))
        if asked.plot is not None:
            drawn = any(proof.sectors for proof in proofs)
            say(f"{asked.plot}: drawn from {path}" if drawn else "no sector to draw")
    return [_drive_data(proof) for proof in proofs]


def _grouped(found: list[DriveProof]) -> list[tuple[DriveProof, list[str]]]:
    """Return each proof once, with the drives that it is about."""
    from dataclasses import replace

    groups: dict[str, tuple[DriveProof, list[str]]] = {}
    for proof in found:
        # By its text: a proof holds dictionaries, which have no hash.
        key = repr(replace(proof, axis=""))
        groups.setdefault(key, (proof, []))[1].append(f"{proof.axis}.{proof.port}")
    return list(groups.values())


def _drive_lines(
    path: str, found: DriveProof, names: list[str], *, sectors_only: bool
) -> list[str]:
    unit = f" {found.unit}" if found.unit else ""
    lines = [f"{path}: {', '.join(names)} in {_interval(found.low, found.high)}{unit} (proved)"]
    if not sectors_only:
        lines += _limit_lines(found)
        lines += _gain_lines(found)
    for drive_sector in found.sectors:
        lines += _drive_sector(drive_sector, found)
    return [*lines, *(f"  not proved: {words}" for words in found.open)]


def _limit_lines(found: DriveProof) -> list[str]:
    if found.limits is None:
        return []
    limits = f"limits {_number(found.limits[0])} .. {_number(found.limits[1])}"
    free = _interval(*found.free)
    if found.reached == "never":
        return [f"  its {limits} are never reached: {free}"]
    if found.reached == "open":
        return [f"  whether its {limits} are reached is open: within {free} without them"]
    at = ", ".join(f"{name} = {_number(x)}" for name, x in found.at.items())
    return [f"  its {limits} are reached, at {at}"]


def _gain_lines(found: DriveProof) -> list[str]:
    lines = []
    for gain in found.gains:
        size = _number(gain.low) if gain.low == gain.high else _span(gain.low, gain.high)
        around = ""
        if (gain.least, gain.most) != (gain.low, gain.high):
            around = f" (slopes around it {_span(gain.least, gain.most)})"
        unit = f" {gain.unit}" if gain.unit else ""
        lines.append(f"  at the origin {size}{unit} of {gain.source}{around}")
    return lines


def _drive_sector(each: DriveSector, found: DriveProof) -> list[str]:
    from fuzzyarm.proof.sector import form_text

    slack = f", to {each.slack:g}" if each.slack else ""
    between = _interval(each.low, each.high)
    within = [f"{name} in {_span(*ends)}" for name, ends in each.within.items()]
    if len(each.weights) == 1:
        (name,) = each.weights
        unit = next((g.unit for g in found.gains if g.source == name and g.unit), "")
        return [f"  sector along {within[0]}: {between}{f' {unit}' if unit else ''}{slack}"]
    head = f"  sector along {form_text(each.weights)}: {between}{slack}"
    return [head, *(f"    {words}" for words in within)]


def _number(x: float) -> str:
    return f"{x:.7g}"


def _span(low: float, high: float) -> str:
    return f"{_number(low)} .. {_number(high)}"


def _interval(low: float, high: float) -> str:
    from fuzzyarm.proof.verdicts import bound_text

    return bound_text((low, high))


def _drive_data(found: DriveProof) -> dict[str, Any]:
    from dataclasses import asdict

    data = asdict(found)
    head = {"drive": f"{found.axis}.{found.port}"}
    data.pop("axis"), data.pop("port")
    return head | data
