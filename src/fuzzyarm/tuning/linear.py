"""The opponent of every tuned rule base: straight lines in place of rules, tuned on the same cost.

On the arm it is the shipped ``pd-motor``, with a proportional and a derivative gain for each
joint. Elsewhere it is the controller itself with the plane that is nearest to each rule base, cut
off at the range of its output. On samples it is linear regression.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fuzzyarm.controller.program import Sheet
from fuzzyarm.controller.text import ControllerText, read_controller
from fuzzyarm.inference import infer
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.model.controller import (
    Amount,
    Axes,
    ControllerModel,
    Factor,
    GainModel,
    Line,
    Product,
    Signal,
    Source,
)
from fuzzyarm.model.rulebase import (
    Consequent,
    Defuzzifier,
    GainTuning,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    Tuning,
)
from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.plant import Plant
from fuzzyarm.shipped_files import shipped
from fuzzyarm.tuning.movement import TuneError

NAME = "linear PD"
"""What reports call it."""

SPAN = 50.0
"""Gains of the opponent move between a fiftieth and fifty times where they begin."""


def opponent(text: ControllerText, plant: Plant) -> tuple[ControllerText, Tuning]:
    """Return the linear controller that a fuzzy one has to beat, and what of it may move.

    Raises
    ------
    TuneError
        If the controller has no rule base that a plane could stand for.
    """
    if isinstance(plant, Arm):
        return read_controller(shipped("pd-motor.frb")), _moving(("K_p", "K_d"))
    return straightened(text)


def _moving(names: tuple[str, ...]) -> Tuning:
    return Tuning((), (GainTuning(names, 1.0 / SPAN, SPAN, times=True, per_axis=True),))


def straightened(text: ControllerText) -> tuple[ControllerText, Tuning]:
    """Return a controller with a plane in place of each rule base, and its slopes to be tuned."""
    model, sheets = text.model, dict(text.sheets)
    gains: dict[str, GainModel] = {}
    axes = []
    for part in model.axes:
        lines: list[Line] = []
        for line in part.lines:
            lines += _straight(line, sheets, gains) if _is_rules(line) else [line]
        axes.append(Axes(part.names, tuple(lines), part.span))
    slopes = tuple(name for name, gain in gains.items() if gain.unit == "slope")
    if not slopes:
        hint = "leave the linear controller out (--no-linear)"
        message = "no rule base of the controller has a plane near it"
        raise TuneError(message, name=model.name, hint=hint)
    made: ControllerModel = replace(
        model, axes=tuple(axes), gains=(*model.gains, *gains.values()), name=f"linear {model.name}"
    )
    return replace(text, model=made, sheets=sheets, path=""), _moving(slopes)


def _is_rules(line: Line) -> bool:
    return isinstance(line, Signal) and line.source is not None and line.source.kind == "rules"


def _straight(
    line: Line, sheets: dict[str, tuple[Sheet, ...]], gains: dict[str, GainModel]
) -> Iterator[Line]:
    """Yield lines for one signal of a rule base: a sum, and what cuts it off."""
    assert isinstance(line, Signal)
    assert line.source is not None
    rulebase = sheets[line.source.name][0]
    if not isinstance(rulebase, RuleBase) or len(line.source.inputs) != len(rulebase.inputs):
        raise TuneError(f"'{line.source.name}' is not the same for all axes", name=line.names[0])
    for name, output in zip(line.names, rulebase.outputs, strict=True):
        slopes, constant = nearest_plane(rulebase, output.name)
        products = []
        for signal, slope in zip(line.source.inputs, slopes, strict=True):
            if slope == 0.0:
                continue
            gain = f"slope of {name} along {signal}"
            gains[gain] = GainModel(gain, (Amount(((slope, False),)),), "slope")
            products.append(Product((Factor(gain), Factor(signal))))
        if constant != 0.0 or not products:
            offset = f"offset of {name}"
            gains[offset] = GainModel(offset, (Amount(((constant, False),)),), "offset")
            products.append(Product((Factor(offset),)))
        plane, cut = f"plane of {name}", f"cut of {name}"
        yield Signal((plane,), None, tuple(products), line.span)
        sheets[cut] = (cut_off(output),)
        yield Signal((name,), Source("rules", cut, (plane,)), line.products, line.span)


GRID = 9
"""Positions along each input at which the nearest plane is sought."""


def nearest_plane(rulebase: RuleBase, output: str) -> tuple[list[float], float]:
    """Return the slopes and the constant of the plane nearest to an output, by least squares."""
    ranges = [(each.low, each.high) for each in rulebase.inputs]
    if not all(math.isfinite(end) for ends in ranges for end in ends):
        raise TuneError(f"'{rulebase.name}' has an input without end", name=rulebase.name)
    lines = [np.linspace(low, high, GRID) for low, high in ranges]
    mesh = np.stack([each.ravel() for each in np.meshgrid(*lines, indexing="ij")], axis=1)
    names = [each.name for each in rulebase.inputs]
    try:
        found = infer(rulebase, dict(zip(names, mesh.T, strict=True)), outputs=(output,))[output]
    except InferenceError as error:
        raise TuneError(f"'{rulebase.name}': {error.message}", name=rulebase.name) from None
    columns = np.hstack([mesh, np.ones((len(mesh), 1))])
    *slopes, constant = np.linalg.lstsq(columns, np.asarray(found), rcond=None)[0].tolist()
    widths = [high - low for low, high in ranges]
    height = float(np.ptp(found)) or 1.0
    # What is left of a slope by rounding alone is none.
    slopes = [0.0 if abs(s) * w < 1e-9 * height else s for s, w in zip(slopes, widths, strict=True)]
    return slopes, 0.0 if abs(constant) < 1e-9 * height else constant


def cut_off(output: Output) -> RuleBase:
    """Return a rule base whose output is its input, kept within a range."""
    low, high = output.low, output.high
    whole = Term("ALL", Shape("rectangle", (low, high)))
    line = Term("LINE", Shape("linear", (1.0, 0.0)))
    rule = Rule(Is("s", "ALL"), (Consequent("v", "LINE"),))
    return RuleBase(
        "cut",
        (Input("s", low, high, (whole,)),),
        (Output("v", low, high, (line,), defuzzifier=Defuzzifier("weighted-average")),),
        (RuleBlock((rule,)),),
    )
