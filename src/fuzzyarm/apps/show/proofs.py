"""Proofs in lines: bounds, sectors, the static part of drives."""

from __future__ import annotations

from dataclasses import replace

from fuzzyarm.base.numbers import inward_interval, outward_text
from fuzzyarm.proof.map import Bounds
from fuzzyarm.proof.map.controllers import DriveProof, DriveSector
from fuzzyarm.proof.map.prover import point_text
from fuzzyarm.proof.map.sector import Sector, form_text
from fuzzyarm.proof.map.verdicts import bound_text

WAYS = {
    "exact": "in exact arithmetic",
    "widened": "rounded outward",
    "boxes": "by boxes",
}


def bound_lines(output: str, key: str, bounds: Bounds) -> list[str]:
    """Return the bounds of an output: its ``range``, the ``worst`` error of a table, or a slope."""
    work = f"{bounds.pieces:,} pieces, {WAYS[bounds.way]}"
    if not bounds.complete:
        work += "; time ran out before the bounds were tight"
    if key == "worst":
        first = f"worst {bound_text(max(bounds.high, -bounds.low))} (proved)"
        return [first, f"  near {point_text(bounds.at_worst)}", f"  {work}"]
    quantity = f"{output}" if key == "range" else f"slope of {output} along {key}"
    where = " where it has a value" if bounds.hole else " (proved)"
    lines = [f"{quantity} in {bound_text((bounds.low, bounds.high))}{where}"]
    if bounds.hole:
        lines.append(f"  not proved: {bounds.hole}")
    if bounds.at_low:
        lines.append(f"  lowest near {point_text(bounds.at_low)}")
    if bounds.at_high:
        lines.append(f"  highest near {point_text(bounds.at_high)}")
    return [*lines, f"  {work}"]


def sector_lines(output: str, sector: Sector) -> list[str]:
    """Return a sector of an output, and the points at its bounds."""
    slack = f", to {sector.slack:g}" if sector.slack else ""
    lines = [
        f"{output} between {_bounds(sector.low, sector.high)} times"
        f" {form_text(sector.weights)} (proved{slack})"
    ]
    for word, at in (("lowest", sector.at_low), ("highest", sector.at_high)):
        if at:
            lines.append(f"  {word} near {point_text(at)}")
    if not sector.complete:
        lines.append("  time ran out before the bounds were tight")
    return [*lines, f"  {sector.pieces:,} pieces, in exact arithmetic"]


def _bounds(low: float, high: float) -> str:
    return f"{outward_text(low, up=False)} and {outward_text(high, up=True)}"


def grouped_drives(proofs: list[DriveProof]) -> list[tuple[DriveProof, list[str]]]:
    """Return each proof once, with its drives."""
    groups: dict[str, tuple[DriveProof, list[str]]] = {}
    for proof in proofs:
        # Compared by text: a proof contains dictionaries, which are not hashable.
        key = repr(replace(proof, axis=""))
        groups.setdefault(key, (proof, []))[1].append(f"{proof.axis}.{proof.port}")
    return list(groups.values())


def drive_lines(path: str, proof: DriveProof, names: list[str], *, sectors_only: bool) -> list[str]:
    """Return the proofs about a drive of the controller at `path`."""
    unit = f" {proof.unit}" if proof.unit else ""
    where = " where it is a number" if proof.hole else " (proved)"
    lines = [f"{path}: {', '.join(names)} in {_interval(proof.low, proof.high)}{unit}{where}"]
    if proof.hole:
        lines.append(f"  not proved: {proof.hole}")
    if not sectors_only:
        lines += _limit_lines(proof)
        lines += _gain_lines(proof)
    for drive_sector in proof.sectors:
        lines += _drive_sector(drive_sector, proof)
    return [*lines, *(f"  not proved: {words}" for words in proof.open)]


def _limit_lines(proof: DriveProof) -> list[str]:
    if proof.limits is None:
        return []
    limits = f"limits {_number(proof.limits[0])} .. {_number(proof.limits[1])}"
    free = _interval(*proof.free)
    if proof.reached == "never":
        return [f"  its {limits} are never reached: {free}"]
    if proof.reached == "open":
        return [f"  whether its {limits} are reached is open: within {free} without them"]
    at = ", ".join(f"{name} = {_number(x)}" for name, x in proof.at.items())
    return [f"  its {limits} are reached" + f", at {at}" * bool(at)]


def _gain_lines(proof: DriveProof) -> list[str]:
    lines = []
    for gain in proof.gains:
        size = _number(gain.low) if gain.low == gain.high else _span(gain.low, gain.high)
        around = ""
        if (gain.least, gain.most) != (gain.low, gain.high):
            around = f" (slopes around it {_span(gain.least, gain.most)})"
        unit = f" {gain.unit}" if gain.unit else ""
        lines.append(f"  at the origin {size}{unit} of {gain.source}{around}")
    return lines


def _drive_sector(sector: DriveSector, proof: DriveProof) -> list[str]:
    slack = f", to {sector.slack:g}" if sector.slack else ""
    between = _interval(sector.low, sector.high)
    within = [f"{name} in {inward_interval(*ends, 7)}" for name, ends in sector.within.items()]
    if len(sector.weights) == 1:
        (name,) = sector.weights
        unit = next((g.unit for g in proof.gains if g.source == name and g.unit), "")
        return [f"  sector along {within[0]}: {between}{f' {unit}' if unit else ''}{slack}"]
    head = f"  sector along {form_text(sector.weights)}: {between}{slack}"
    return [head, *(f"    {words}" for words in within)]


def _number(x: float) -> str:
    return f"{x:.7g}"


def _span(low: float, high: float) -> str:
    return f"{_number(low)} .. {_number(high)}"


def _interval(low: float, high: float) -> str:
    return bound_text((low, high))
