"""The sector of an output or a drive: its values beside two straight lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.base.picture import COLOURS, Axis, Band, Chart, ChartPart, Level, Line, Panel
from fuzzyarm.base.units import product, read_unit, unit_text
from fuzzyarm.proof.map.sector import form_text

if TYPE_CHECKING:
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.language.model.rulebase import RuleBase
    from fuzzyarm.plant.plant import Plant
    from fuzzyarm.proof.map.controllers import DriveProof, DriveSector
    from fuzzyarm.proof.map.sector import Sector

_LINE, _PLANE = 801, 201


@dataclass(frozen=True)
class SectorPicture:
    """Points of one sector.

    Attributes
    ----------
    across, up : str
        Names of σ and u.
    form, values : ndarray
        Samples of σ and u.
    low, high : float
        Gains of the sector.
    one : bool
        Whether the samples are along one input, in order.
    """

    across: str
    up: str
    form: Any
    values: Any
    low: float
    high: float
    one: bool


def rulebase_sectors(
    rulebase: RuleBase, output: str, sectors: Sequence[Sector]
) -> list[SectorPicture]:
    """Return the pictures of a rule base's sectors; inputs outside σ are 0."""
    from fuzzyarm.inference import infer

    pictures = []
    for sector in sectors:
        count = _LINE if len(sector.weights) == 1 else _PLANE
        free = [rulebase.variable(name) for name in list(sector.weights)[:3]]
        if len(free) > 2:
            count = 41
        grid = np.meshgrid(*(np.linspace(v.low, v.high, count) for v in free), indexing="ij")
        inputs: dict[str, Any] = {variable.name: 0.0 for variable in rulebase.inputs}
        inputs.update({v.name: values.ravel() for v, values in zip(free, grid, strict=True)})
        values = np.asarray(infer(rulebase, inputs)[output], dtype=float)
        form = sum(float(w) * inputs[name] for name, w in sector.weights.items())
        pictures.append(
            SectorPicture(
                form_text(sector.weights, 4), output, form, values, sector.low, sector.high,
                len(sector.weights) == 1,
            )
        )  # fmt: skip
    return pictures


def controller_sectors(
    text: ControllerText,
    proofs: Sequence[DriveProof],
    plant: Plant | None = None,
    points: int = 2000,
) -> list[SectorPicture]:
    """Return the pictures of the sectors of the controller's first drive with one.

    A source is drawn inside the universes only, not beyond them, where the sector is 0 .. k₂.
    """
    from fuzzyarm.proof.map.controllers import sampled_drive

    drive = next((proof for proof in proofs if proof.sectors), None)
    if drive is None:
        return []
    pictures = []
    inner = {tuple(sector.weights): sector for sector in reversed(drive.sectors)}
    for item in reversed(inner.values()):
        form, values = sampled_drive(text, drive, item, plant, points=points)
        up = f"{drive.port}, {drive.unit}" if drive.unit else drive.port
        pictures.append(
            SectorPicture(
                _form_words(drive, item), up, form, values, item.low, item.high,
                len(item.weights) == 1,
            )
        )  # fmt: skip
    return pictures


def _form_words(drive: DriveProof, sector: DriveSector) -> str:
    """Return σ, with a unit if it is one source: that of the drive over that of its gain."""
    words = form_text(sector.weights, 4)
    gain = next(
        (drive_gain for drive_gain in drive.gains if [drive_gain.source] == list(sector.weights)),
        None,
    )
    unit = product(read_unit(drive.unit), read_unit(gain.unit) if gain else None, -1)
    return words if unit is None else f"{words}, {unit_text(unit)}"


def sector_chart(pictures: Sequence[SectorPicture]) -> Chart:
    """Return each sector beside its values: a line, or the band of values over σ."""
    columns = min(len(pictures), 3)
    panels = [_panel(picture) for picture in pictures]
    rows = [panels[k : k + columns] for k in range(0, len(panels), columns)]
    return Chart(rows, (3.6 * columns if columns > 1 else 5.6, 3.4 * len(rows)))


def _panel(picture: SectorPicture) -> Panel:
    sound = np.isfinite(picture.values)
    form, values = picture.form[sound], picture.values[sound]
    far = float(np.abs(form).max())
    top = 1.15 * max(float(np.abs(values).max()), 1e-300)
    ends = np.array([-far, 0.0, far])
    edges = picture.low * ends, picture.high * ends
    parts: list[ChartPart] = [Band(ends, np.minimum(*edges), np.maximum(*edges), COLOURS[5], 0.22)]
    for gain, tone, edge in zip((picture.low, picture.high), COLOURS[2:4], edges, strict=True):
        label = f"{number_words(gain, 5)} σ" if gain else "0"
        parts.append(Line(ends, edge, tone, 1.3, "--", label))
    if picture.one:
        parts.append(Line(form, values, COLOURS[0], 1.8, label=picture.up))
    else:
        parts.append(_filled(form, values, far, picture.up))
    parts += [Level(0.0, tone="wanted"), Level(0.0, upright=True, tone="wanted")]
    across = Axis(f"σ = {picture.across}", low=-1.02 * far, high=1.02 * far)
    return Panel(parts, across, Axis(picture.up, low=-top, high=top), key="upper left")


def _filled(form: Any, values: Any, far: float, name: str) -> Band:
    """Return the least and greatest u over each interval of σ, from u / σ."""
    count = 2 * max(10, int(0.3 * len(form) ** 0.5))  # enough points for each stretch
    edges = np.linspace(-far, far, count + 1)
    away = np.abs(form) > 1e-6 * far
    number = np.clip(np.digitize(form[away], edges) - 1, 0, count - 1)
    ratio = values[away] / form[away]
    least, most = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(least, number, ratio)
    np.maximum.at(most, number, ratio)
    some = least <= most
    middles = (0.5 * (edges[1:] + edges[:-1]))[some]
    low, high = np.clip(np.stack([least[some], most[some]]) * middles, values.min(), values.max())
    return Band(middles, low, high, COLOURS[0], 0.55, name)
