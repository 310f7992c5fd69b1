"""What is proved, in lines: bounds, sectors, the static part of drives."""

from __future__ import annotations

from dataclasses import replace

from fuzzyarm.proof import Bounds
from fuzzyarm.proof.controllers import DriveProof, DriveSector
from fuzzyarm.proof.prover import written
from fuzzyarm.proof.sector import Sector, form_text
from fuzzyarm.proof.verdicts import bound_text
from fuzzyarm.text.numbers import outward_text

__all__ = ["WAYS", "bound_lines", "drive_lines", "grouped_drives", "place_of_worst", "sector_lines"]

WAYS = {
    "exact": "in exact arithmetic",
    "widened": "rounded outward",
    "boxes": "by boxes",
}


def bound_lines(output: str, key: str, bounds: Bounds) -> list[str]:
    """Return what is bounded of an output: its ``range``, the ``worst`` of a table, or a slope."""
    work = f"{bounds.pieces:,} pieces, {WAYS[bounds.way]}"
    if not bounds.complete:
        work += "; time ran out before the bounds were tight"
    if key == "worst":
        first = f"worst {bound_text(max(bounds.high, -bounds.low))} (proved)"
        return [first, f"  near {written(place_of_worst(bounds))}", f"  {work}"]
    what = f"{output}" if key == "range" else f"slope of {output} along {key}"
    first = f"{what} in {bound_text((bounds.low, bounds.high))} (proved)"
    lines = [first]
    if bounds.at_low:
        lines.append(f"  lowest near {written(bounds.at_low)}")
    if bounds.at_high:
        lines.append(f"  highest near {written(bounds.at_high)}")
    return [*lines, f"  {work}"]


def place_of_worst(bounds: Bounds) -> dict[str, float]:
    """Return where an error is farthest from zero."""
    return bounds.at_high if bounds.reached_high >= -bounds.reached_low else bounds.at_low


def sector_lines(output: str, found: Sector) -> list[str]:
    """Return a sector of an output, and where its ends are reached."""
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
    return f"{outward_text(low, up=False)} and {outward_text(high, up=True)}"


def grouped_drives(found: list[DriveProof]) -> list[tuple[DriveProof, list[str]]]:
    """Return each proof once, with the drives that it is about."""
    groups: dict[str, tuple[DriveProof, list[str]]] = {}
    for proof in found:
        # By its text: a proof holds dictionaries, which have no hash.
        key = repr(replace(proof, axis=""))
        groups.setdefault(key, (proof, []))[1].append(f"{proof.axis}.{proof.port}")
    return list(groups.values())


def drive_lines(path: str, found: DriveProof, names: list[str], *, sectors_only: bool) -> list[str]:
    """Return what is proved of a drive; `path` is whose it is."""
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
    return bound_text((low, high))
