"""Two files side by side: their surfaces over the same inputs, and differences in meaning."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.apps.designer.exports import ExportRefusedError, model_of
from fuzzyarm.apps.designer.requests import CompareWork, SurfaceAxes
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.apps.show.diff import compare_rulebases, table_change_words, table_summary
from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.plane import plane_panel
from fuzzyarm.apps.show.response import with_gaps
from fuzzyarm.base.picture import Axis, panel_data
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.table import LookupTable, compare_tables

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.jobs import WindowJob

ACROSS = 61
"""Points of a surface along each input, as many as a page draws."""

EVERYWHERE = 60_000
"""Points over all inputs at which the largest difference is sought."""

MOST_CHANGES = 400

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ComparedSurface:
    """One output of a rule base or a table, by names of inputs."""

    ranges: Mapping[str, tuple[float, float]]
    at: Callable[[Mapping[str, Array]], Array]


def compare(session: Session, request: CompareWork, job: WindowJob) -> None:
    """Report the difference of two surfaces, its maximum, and the differences in meaning."""
    other = job.folder.session(request.other)
    one, two = model_of(session), model_of(other)
    for model in (one, two):
        if not isinstance(model, RuleBase | LookupTable):
            raise ExportRefusedError("surfaces are those of rule bases and tables")
    shared = [name for name in outputs_of(one) if name in outputs_of(two)]
    output = request.output if request.output in shared else shared[0] if shared else ""
    first = surface_of(one, output or outputs_of(one)[0])
    second = surface_of(two, output or outputs_of(two)[0])
    names = [name for name in first.ranges if name in second.ranges]
    if not names:
        raise ExportRefusedError("the two files have no input of the same name")
    ranges = {**second.ranges, **first.ranges, **_overlap(first, second, names)}
    output = output or f"{outputs_of(one)[0]}, {outputs_of(two)[0]}"
    files = Path(session.path).name, request.other
    job.tell({
        "outputs": shared,
        "output": output,
        "names": list(ranges),
        "shared": names,
        **_slice((first, second), files, output, names, ranges, request.axes),
    })  # fmt: skip
    job.tell({"changes": _changes(one, two)})
    job.progress("looking for the largest difference")
    job.tell({"largest": _largest(first, second, names, ranges)})


def outputs_of(model: RuleBase | LookupTable) -> list[str]:
    """Return the names of the outputs."""
    if isinstance(model, LookupTable):
        return [model.output]
    if not model.outputs:
        raise ExportRefusedError(f"'{model.name}' has no outputs")
    return [output.name for output in model.outputs]


def surface_of(model: RuleBase | LookupTable, output: str) -> ComparedSurface:
    """Return one output of a rule base or a table, over its inputs."""
    if isinstance(model, LookupTable):
        ends = {axis.name: axis.ends for axis in model.axes}
        table = model
        return ComparedSurface(
            ends, lambda at: np.asarray(table.lookup(*(at[n] for n in table.names)))
        )
    rulebase, target = model, model.output(output)
    ranges = {variable.name: (variable.low, variable.high) for variable in rulebase.inputs}
    unbounded = [name for name, ends in ranges.items() if not all(map(math.isfinite, ends))]
    if unbounded:
        raise ExportRefusedError(f"input '{unbounded[0]}' of '{rulebase.name}' is unbounded")

    def infer_at(at: Mapping[str, Array]) -> Array:
        return np.asarray(with_gaps(rulebase, target, {name: at[name] for name in ranges}))

    return ComparedSurface(ranges, infer_at)


def _overlap(
    first: ComparedSurface, second: ComparedSurface, names: list[str]
) -> dict[str, tuple[float, float]]:
    """Return the region where both have values."""
    overlap = {}
    for name in names:
        low = max(first.ranges[name][0], second.ranges[name][0])
        high = min(first.ranges[name][1], second.ranges[name][1])
        if not low < high:
            raise ExportRefusedError(f"the ranges of '{name}' in the two files do not overlap")
        overlap[name] = (low, high)
    return overlap


def _slice(
    surfaces: tuple[ComparedSurface, ComparedSurface],
    files: tuple[str, str],
    output: str,
    names: list[str],
    ranges: Mapping[str, tuple[float, float]],
    axes: SurfaceAxes,
) -> dict[str, Any]:
    """Return pictures over two of the inputs that both have; the others are held."""
    x = axes.x if axes.x in names else names[0]
    rest = [name for name in names if name != x]
    y = axes.y if axes.y in rest else rest[0] if rest else ""
    at: dict[str, Array] = {}
    for name, (low, high) in ranges.items():
        chosen_value = axes.at.get(name)
        value = 0.5 * (low + high) if chosen_value is None else chosen_value
        at[name] = np.array(min(max(value, low), high))
    constants = {name: float(value) for name, value in at.items() if name not in (x, y)}
    xs = np.linspace(*ranges[x], ACROSS)
    ys = np.linspace(*ranges[y], ACROSS) if y else np.zeros(1)
    at[x] = xs[None, :]
    if y:
        at[y] = ys[:, None]
    # A surface independent of an input has fewer axes.
    values = [np.broadcast_to(surface.at(at), (ys.size, xs.size)) for surface in surfaces]
    where = _where(np.abs(values[1] - values[0]), {y or "": ys, x: xs})
    return {
        "x": x,
        "y": y,
        "held": constants,
        "worst": where,
        **_pictures(files, output, {x: xs, **({y: ys} if y else {})}, values, where),
    }


def _pictures(
    files: tuple[str, str],
    output: str,
    points: Mapping[str, Array],
    values: list[Array],
    where: dict[str, Any] | None,
) -> dict[str, Any]:
    """Return the surfaces of two files as panels, and their difference as another."""
    at = where["at"] if where else {}
    finite_values = [x for surface in values for x in surface.ravel().tolist() if math.isfinite(x)]
    low, high = min(finite_values, default=0.0), max(finite_values, default=1.0)
    ends = f"{number_words(low, 4)} … {number_words(high, 4)}"
    axis = Axis(output, "", *((low, high) if low < high else (low - 1.0, high + 1.0)))
    difference = values[1] - values[0]
    most = where["difference"] if where else 0.0
    title = f"{files[1]} − {files[0]}, at most {number_words(most, 4)}"
    if len(points) == 1:
        both = [plane_panel(points, dict(zip(files, values, strict=True)), axis, at=at)]
    else:
        both = [
            plane_panel(points, {"": surface}, axis, title=f"{file}: {output}, {ends}")
            for file, surface in zip(files, values, strict=True)
        ]
    apart = plane_panel(points, {"": difference}, Axis(output), title=title, at=at, signed=True)
    return {"both": list(map(panel_data, both)), "difference": panel_data(apart)}


def _where(difference: Array, points: Mapping[str, Array]) -> dict[str, Any] | None:
    """Return the largest difference and its point; None without common values."""
    if np.isnan(difference).all():
        return None
    index = np.unravel_index(int(np.nanargmax(difference)), difference.shape)
    named = zip(points.items(), index, strict=True)
    at = {name: float(values[k]) for (name, values), k in named if name}
    return {"difference": float(difference[index]), "at": at}


def _largest(
    first: ComparedSurface,
    second: ComparedSurface,
    names: list[str],
    ranges: Mapping[str, tuple[float, float]],
) -> dict[str, Any] | None:
    """Return the largest difference over an even grid of all inputs."""
    count = max(3, round(EVERYWHERE ** (1.0 / len(ranges))))
    # Three points along each of many inputs are too many all the same.
    if count ** len(ranges) > 20 * EVERYWHERE:
        return None
    points = {name: np.linspace(*ends, count) for name, ends in ranges.items()}
    mesh = dict(zip(points, np.ix_(*points.values()), strict=True))
    shape = (count,) * len(points)
    values = [np.broadcast_to(surface.at(mesh), shape) for surface in (first, second)]
    largest = _where(np.abs(values[1] - values[0]), points)
    one_sided = int(np.sum(np.isnan(values[0]) != np.isnan(values[1])))
    return (
        None if largest is None else {**largest, "points": count ** len(ranges), "alone": one_sided}
    )


def _changes(one: RuleBase | LookupTable, two: RuleBase | LookupTable) -> dict[str, Any]:
    """Return the differences in meaning, in the words of ``fuzzyarm diff``."""
    if isinstance(one, RuleBase) and isinstance(two, RuleBase):
        diff = compare_rulebases(one, two)
        parts = {"rules": diff.rules, "terms": diff.terms, "settings": diff.settings}
        return {
            "same": diff.same,
            "parts": [
                [title, [[change.kind, str(change)] for change in changes]]
                for title, changes in parts.items()
                if changes
            ],
        }
    if isinstance(one, LookupTable) and isinstance(two, LookupTable):
        cells = compare_tables(one, two)
        header = [["changed", f"{what}: {a} -> {b}"] for what, a, b in cells.header]
        listed = [["changed", table_change_words(cells, change)] for change in cells.changes]
        rest = len(listed) - MOST_CHANGES
        listed = listed[:MOST_CHANGES] + ([["more", str(rest)]] if rest > 0 else [])
        parts_ = [["settings", header], ["cells", listed]]
        return {
            "same": cells.same,
            "summary": table_summary(cells),
            "parts": [part for part in parts_ if part[1]],
        }
    return {"same": False, "mixed": True, "parts": []}
