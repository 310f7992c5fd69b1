"""Tables in a page: a page of cells, and the error of a table against its rules."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.apps.designer.exports import ExportRefusedError, making_on_page, model_of
from fuzzyarm.apps.designer.names import OutsideError
from fuzzyarm.apps.designer.requests import SurfaceAxes, TableErrorWork
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.apps.lsp.tables import TableText
from fuzzyarm.apps.show.compiled import fidelity_line, report_lines
from fuzzyarm.apps.show.plane import plane_panel
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import printable
from fuzzyarm.base.picture import Axis, panel_data
from fuzzyarm.exchange.compiled import compiled
from fuzzyarm.language import write
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.map.tables import cell_errors, table_proof
from fuzzyarm.proof.stop import Stop
from fuzzyarm.table import Fidelity, LookupTable, measure_fidelity
from fuzzyarm.table.axis import Axis as TableAxis
from fuzzyarm.table.compiler import evaluate

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.jobs import WindowJob

MOST_SHOWN = 120
"""Levels drawn of an axis; of more every second, third … one."""

ACROSS = 121
"""Points of an error map along each input."""

MOST_CELLS = 1_600
"""Cells whose errors are proved one by one."""

AT_ONCE = 24
"""Cells in one message."""

PROOF_SECONDS = 60.0


def table_page(session: Session, page: Sequence[int]) -> dict[str, Any] | None:
    """Return one page of a table as plain data; None unless the text is a sound table."""
    reading = session.reading
    table = reading.parsed.table if isinstance(reading, TableText) else None
    if table is None:
        return None
    shape = table.shape
    numbers = [min(max(0, int(k)), size - 1) for k, size in zip(page, shape[:-2], strict=False)]
    numbers += [0] * (len(shape[:-2]) - len(numbers))
    start = 0
    for k, size in zip(numbers, shape[:-2], strict=True):
        # Row-major: all inputs but the last two choose the page.
        start = start * size + k
    rows, columns = (shape[-2] if len(shape) > 1 else 1), shape[-1]
    shown = [_thinned(rows), _thinned(columns)]
    first = start * rows * columns
    return {
        "output": table.output,
        "description": table.description,
        "mode": table.default_mode,
        "low": min(table.values),
        "high": max(table.values),
        "cells": len(table.values),
        "axes": [_axis(axis) for axis in table.axes],
        "page": numbers,
        "rows": shown[0],
        "columns": shown[1],
        "values": [[table.values[first + i * columns + j] for j in shown[1]] for i in shown[0]],
        "says": [list(pair) for pair in table.provenance],
        "source": dict(table.provenance).get("source", ""),
    }


def _thinned(count: int) -> list[int]:
    step = math.ceil(count / MOST_SHOWN)
    return [*range(0, count, step)]


def _axis(axis: TableAxis) -> dict[str, Any]:
    return {
        "name": axis.name,
        "description": axis.description,
        "levels": list(axis.levels),
        "bins": None if axis.bins is None else list(axis.bins),
    }


def cell_place(session: Session, cell: Sequence[int]) -> Any:
    """Return the position of a cell's number in the text; None where unknown."""
    reading = session.reading
    if not isinstance(reading, TableText) or reading.parsed.table is None:
        return None
    shape = reading.parsed.table.shape
    if len(cell) != len(shape) or any(not 0 <= k < n for k, n in zip(cell, shape, strict=True)):
        return None
    return reading.cell_span([int(k) for k in cell])


# --- A table against its rules ---


def table_error(session: Session, request: TableErrorWork, job: WindowJob) -> None:
    """Report the error of a table against direct inference: a map, the worst point, proofs.

    The table of a rule base is compiled with the page's options; a table is compared with its
    source file in the folder.
    """
    model = model_of(session)
    options = request.options
    if isinstance(model, LookupTable):
        rulebase, words = _source_of(model, job)
        table, mode = model, str(options.get("mode") or model.default_mode)
        lines: list[str] = [words] if words else []
    elif isinstance(model, RuleBase):
        rulebase, how = model, making_on_page(session, options)
        report = compiled(rulebase, how.output, how, job.progress)
        table, mode, lines = report.table, how.mode or report.table.default_mode, []
    else:
        raise ExportRefusedError("a controller has no table of its own: open its rule base")
    job.tell({"map": error_map(table, rulebase, mode, request.axes)})
    if isinstance(model, LookupTable):
        job.progress("measuring the difference")
        fidelities = _fidelities(table, rulebase, mode)
        lines += [fidelity_line(fidelity) for fidelity in fidelities]
    else:
        fidelities = report.fidelities
        lines += report_lines(report, "table")
    chosen = next((fidelity for fidelity in fidelities if fidelity.mode == mode), fidelities[0])
    job.tell({"lines": lines, "worst": _worst(chosen, table, rulebase)})
    _prove_cells(table, rulebase, mode, job)


def _source_of(table: LookupTable, job: WindowJob) -> tuple[RuleBase, str]:
    """Return the rule base of a table, and whether it has changed since."""
    says = dict(table.provenance)
    name = says.get("source", "")
    if not name:
        raise ExportRefusedError("the table does not say which file it was compiled from")
    try:
        source = job.folder.session(name)
    except OutsideError:
        text = f"the table says that it comes from '{printable(name)}', which is not in this folder"
        raise ExportRefusedError(text) from None
    try:
        model = model_of(source)
    except FuzzyarmError as error:
        raise ExportRefusedError(f"{name}, which it was compiled from: {error}") from None
    if not isinstance(model, RuleBase):
        raise ExportRefusedError(f"{name} is not a rule base")
    missing = set(table.names) - {variable.name for variable in model.inputs}
    if missing or table.output not in {output.name for output in model.outputs}:
        raise ExportRefusedError(f"{name} has other inputs or another output by now")
    same = says.get("sha256") == hashlib.sha256(write(model).encode()).hexdigest()
    return model, "" if same else f"{name} has been changed since the table was compiled"


def _fidelities(table: LookupTable, rulebase: RuleBase, mode: str) -> tuple[Fidelity, ...]:
    """Measure and prove the error of a table, in its lookup mode and linearly."""
    from dataclasses import replace

    proof = table_proof(rulebase, table.output)
    fidelities = measure_fidelity(table, rulebase, (mode, "linear"))
    return tuple(replace(fidelity, proved=proof(table, fidelity.mode)) for fidelity in fidelities)


def _worst(fidelity: Fidelity, table: LookupTable, rulebase: RuleBase) -> dict[str, Any]:
    at = dict(fidelity.at)
    points = [np.array([at[name]]) for name in table.names]
    return {
        "at": at,
        "table": float(table.lookup(*at.values(), mode=fidelity.mode)),
        "direct": float(evaluate(rulebase, table.output, table.names, points)[0]),
        "difference": fidelity.worst,
        "proved": fidelity.proved,
        "mode": fidelity.mode,
    }


def error_map(
    table: LookupTable, rulebase: RuleBase, mode: str, axes: SurfaceAxes
) -> dict[str, Any]:
    """Return table − rules over two inputs, the others held."""
    names = list(table.names)
    x = axes.x or names[-1]
    y = axes.y or (names[-2] if len(names) > 1 else x)
    if x not in names or y not in names or (x == y and len(names) > 1):
        x, y = names[-1], names[-2] if len(names) > 1 else names[-1]
    constants = {axis.name: _held(axis, axes.at.get(axis.name)) for axis in table.axes}
    xs, ys = (np.linspace(*table.axis(name).ends, ACROSS) for name in (x, y))
    mesh = {**{name: np.array(value) for name, value in constants.items()}, x: xs[None, :]}
    if x != y:
        mesh[y] = ys[:, None]
    points = [mesh[name] for name in names]
    truth = evaluate(rulebase, table.output, names, points)
    # An output independent of y has one row for all.
    difference = np.broadcast_to(table.lookup(*points, mode=mode) - truth, truth.shape)
    return {
        "x": x,
        "y": y if x != y else "",
        "names": names,
        "held": {name: value for name, value in constants.items() if name not in (x, y)},
        "panel": panel_data(
            plane_panel(
                {x: xs, y: ys},
                {"": difference},
                Axis(table.output),
                signed=True,
                grid={name: table.axis(name).levels for name in (x, y)},
            )
        ),
        "mode": mode,
        "output": table.output,
        "levels": {name: list(table.axis(name).levels) for name in (x, y)},
        "shape": list(table.shape),
    }


def _held(axis: TableAxis, value: float | None) -> float:
    low, high = axis.ends
    return min(max(value, low), high) if value is not None else 0.5 * (low + high)


def _prove_cells(table: LookupTable, rulebase: RuleBase, mode: str, job: WindowJob) -> None:
    """Report a proved bound of the error of each cell, if there is one."""
    if len(table.axes) > 2:
        job.tell({"unproved": "cells of more than two inputs are not proved one by one"})
        return
    cells = math.prod(size - 1 for size in table.shape)
    if cells > MOST_CELLS:
        job.tell({"unproved": f"{cells:,} cells are too many to be proved one by one"})
        return
    job.progress("proving the error of each cell")
    try:
        errors = cell_errors(table, rulebase, mode, Stop(PROOF_SECONDS))
        done = 0
        while batch := [*islice(errors, AT_ONCE)]:
            done += len(batch)
            rows = [[*cell, max(bounds.high, -bounds.low)] for cell, bounds in batch]
            job.tell({"cells": rows, "done": done, "of": cells})
    except UnprovableError as error:
        job.tell({"unproved": str(error)})
