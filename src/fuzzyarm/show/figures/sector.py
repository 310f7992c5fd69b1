"""The sector that an output or a drive lies in: its values beside two straight lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.model.units import product, read_unit, unit_text
from fuzzyarm.picture import COLOURS
from fuzzyarm.proof.sector import form_text
from fuzzyarm.show.drawing import number_words
from fuzzyarm.show.figures.labels import wrapped
from fuzzyarm.show.figures.style import LABEL, label_axes, new_figure, safe, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.plant.plant import Plant
    from fuzzyarm.proof.controllers import DriveProof, DriveSector
    from fuzzyarm.proof.sector import Sector

_LINE, _PLANE = 801, 201


@dataclass(frozen=True)
class SectorPicture:
    """Points of one sector.

    Attributes
    ----------
    across, up : str
        What σ and u are.
    form, values : ndarray
        σ and u at points.
    low, high : float
        The gains of the sector.
    one : bool
        Whether the points are along one input, in order.
    """

    across: str
    up: str
    form: Any
    values: Any
    low: float
    high: float
    one: bool


def rulebase_sectors(
    rulebase: RuleBase, output: str, found: Sequence[Sector]
) -> list[SectorPicture]:
    """Return the pictures of sectors of a rule base: inputs that are not in σ are 0."""
    from fuzzyarm.inference import infer

    pictures = []
    for sector in found:
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
    found: Sequence[DriveProof],
    plant: Plant | None = None,
    points: int = 2000,
) -> list[SectorPicture]:
    """Return the pictures of the sectors of a controller's first drive that has some.

    Of a source the stretch inside the universes is drawn, not the one beyond, which is 0 .. k₂.
    """
    from fuzzyarm.proof.controllers import sampled_drive

    drive = next((proof for proof in found if proof.sectors), None)
    if drive is None:
        return []
    pictures = []
    inner = {tuple(sector.weights): sector for sector in reversed(drive.sectors)}
    for each in reversed(inner.values()):
        form, values = sampled_drive(text, drive, each, plant, points=points)
        up = f"{drive.port}, {drive.unit}" if drive.unit else drive.port
        pictures.append(
            SectorPicture(
                _form_words(drive, each), up, form, values, each.low, each.high,
                len(each.weights) == 1,
            )
        )  # fmt: skip
    return pictures


def _form_words(drive: DriveProof, sector: DriveSector) -> str:
    """Return σ, with its unit where it is one source: that of the drive over that of its gain."""
    words = form_text(sector.weights, 4)
    gain = next(
        (drive_gain for drive_gain in drive.gains if [drive_gain.source] == list(sector.weights)),
        None,
    )
    unit = product(read_unit(drive.unit), read_unit(gain.unit) if gain else None, -1)
    return words if unit is None else f"{words}, {unit_text(unit)}"


def sector_figure(pictures: Sequence[SectorPicture]) -> Figure:
    """Return each sector beside its values: a line, or the band that they fill over σ.

    Parameters
    ----------
    pictures : sequence of SectorPicture
        At least one.
    """
    columns = min(len(pictures), 3)
    rows = -(-len(pictures) // columns)
    figure = new_figure(3.6 * columns if columns > 1 else 5.6, 3.4 * rows)
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for part, picture in zip(axes, pictures, strict=False):
        _draw(part, picture)
    for part in axes[len(pictures) :]:
        part.set_visible(False)
    return figure


def _draw(axes: Axes, picture: SectorPicture) -> None:
    sound = np.isfinite(picture.values)
    form, values = picture.form[sound], picture.values[sound]
    far = float(np.abs(form).max())
    top = 1.15 * max(float(np.abs(values).max()), 1e-300)
    ends = np.array([-far, 0.0, far])
    axes.fill_between(
        ends, np.minimum(picture.low * ends, picture.high * ends),
        np.maximum(picture.low * ends, picture.high * ends), color=COLOURS[5], alpha=0.22, lw=0,
    )  # fmt: skip
    for gain, colour in ((picture.low, COLOURS[2]), (picture.high, COLOURS[3])):
        label = f"{number_words(gain, 5)} σ" if gain else "0"
        axes.plot(ends, gain * ends, color=colour, linewidth=1.3, linestyle="--", label=label)
    if picture.one:
        axes.plot(form, values, color=COLOURS[0], linewidth=1.8, label=safe(picture.up))
    else:
        _band(axes, form, values, far, picture.up)
    tidy(axes)
    axes.set_ylim(-top, top)
    axes.set_xlim(-1.02 * far, 1.02 * far)
    axes.axhline(0.0, color="#999999", linewidth=0.6)
    axes.axvline(0.0, color="#999999", linewidth=0.6)
    label_axes(axes, safe(wrapped(f"σ = {picture.across}", LABEL, 2.9)), safe(picture.up))
    axes.legend(fontsize=8, frameon=False, loc="upper left")


def _band(axes: Axes, form: Any, values: Any, far: float, name: str) -> None:
    """Fill what the values cover: the least and the greatest u / σ over each stretch of σ."""
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
    ends = np.clip(np.stack([least[some], most[some]]) * middles, values.min(), values.max())
    axes.fill_between(
        middles, *ends,
        color=COLOURS[0], alpha=0.55, lw=0, label=safe(name),
    )  # fmt: skip
