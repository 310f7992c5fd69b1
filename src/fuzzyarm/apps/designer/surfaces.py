"""Surfaces, and the rules that fire at a point, for pages that cannot compute them fast enough."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

from fuzzyarm.apps.designer.jobs import WindowJob
from fuzzyarm.apps.designer.records import MessageError
from fuzzyarm.apps.designer.requests import SurfaceWork
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.inference.engine import compiled
from fuzzyarm.inference.strengths import firing_strengths
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase

Variable = TypeVar("Variable", Input, Output)

MOST_ACROSS = 201
"""Points of a surface along one axis."""


class NothingToComputeError(FuzzyarmError, ValueError):
    """The text is not a sound rule base now."""


def surface(session: Session, request: SurfaceWork, job: WindowJob) -> None:
    """Send the firing rules at a point, then an output over two inputs through it."""
    rulebase = getattr(session.reading.parsed, "rulebase", None)  # a table has none
    if not isinstance(rulebase, RuleBase):
        raise NothingToComputeError("the text is not a sound rule base")
    # Without a value there is a gap, unless the file states a number for no rule.
    gaps = (replace(o, no_rule=math.nan) if isinstance(o.no_rule, str) else o
            for o in rulebase.outputs)  # fmt: skip
    model = replace(rulebase, outputs=tuple(gaps))
    point = list(request.point)
    names = [variable.name for variable in model.inputs]
    if len(point) != len(names):
        raise MessageError(f"must have {len(names)} values, as the inputs", "point")
    if request.fired:
        strengths, _ = firing_strengths(model, dict(zip(names, point, strict=True)))
        values = compiled(model).at(*point)
        job.tell({"strengths": strengths.tolist(), "outputs": jsonable(values)})
    _tell_surface(model, point, request, job)


def _tell_surface(
    model: RuleBase, point: list[float], request: SurfaceWork, job: WindowJob
) -> None:
    import numpy as np

    x, y = (_at(model.inputs, getattr(request, axis), axis) for axis in ("x", "y"))
    output = _at(model.outputs, request.output, "output")
    across = min(MOST_ACROSS, max(2, request.across))
    run = compiled(model)
    constants = {variable.name: value for variable, value in zip(model.inputs, point, strict=True)}
    columns = {**constants, x.name: np.linspace(*_ends(x, request.ends[0]), across)}
    rows = [None] if x is y else np.linspace(*_ends(y, request.ends[1]), across)
    z: list[float | None] = []
    for row in rows:
        job.check()
        inputs = columns if row is None else {**columns, y.name: row}
        values = np.broadcast_to(run(inputs)[output.name], (across,))
        z += jsonable(values)
    job.tell({"z": z, "across": across})


def _at(variables: Sequence[Variable], index: int, field: str) -> Variable:
    """Return a variable by its index, which may be that of an older text."""
    if not 0 <= index < len(variables):
        raise MessageError(f"is {index}, of {len(variables)} variables", field)
    return variables[index]


def _ends(variable: Input, ends: tuple[float, float]) -> tuple[float, float]:
    """Return the ends of an axis: of an unbounded input those of its drawing."""
    low, high = ends
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise MessageError("must be a lower and an upper end", "ends")
    return max(low, variable.low), min(high, variable.high)
