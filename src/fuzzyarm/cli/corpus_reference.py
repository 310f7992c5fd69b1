"""Reference outputs of other programs, and whether a rule base gives the same.

A reference is a JSON file ``NAME.json`` for the rule file ``NAME``: one object with
``inputs`` (rows of numbers) and ``outputs`` (rows of numbers, null for no value), maybe
``input_names`` and ``output_names`` (else both are in the order of the file). Other keys
that begin with ``outputs_`` name their program: ``outputs_octave_toolkit_1001pts`` is
Octave's at 1001 points. ``blocks`` lists several such objects, one for each function block,
with a ``name``.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fuzzyarm.inference import InferenceError, prepare
from fuzzyarm.rulebase import RuleBase

TOLERANCE = 1e-6
"""Largest relative difference that counts as equal."""

FLOOR = 1e-9
"""Absolute difference below which two values are equal, for outputs around zero."""

_PROGRAMS = ("octave", "fuzzylite", "matlab", "jfuzzylogic")
_IGNORED = re.compile(r"outputs_resolution_\d+\Z")


@dataclass(frozen=True, slots=True)
class Reference:
    """One program's outputs for one file.

    Attributes
    ----------
    program : str
        ``octave``, ``fuzzylite`` and so on; empty where the file does not say.
    block : str or None
        The function block of an FCL file.
    resolution : int or None
        Number of samples where it was not the program's usual one.
    input_names, output_names : tuple of str or None
        None where the numbers are in the order of the file.
    inputs, outputs : sequence of rows
        NaN where there is no value.
    """

    program: str
    block: str | None
    resolution: int | None
    input_names: tuple[str, ...] | None
    output_names: tuple[str, ...] | None
    inputs: tuple[tuple[float, ...], ...]
    outputs: tuple[tuple[float, ...], ...]


def read_references(path: Path) -> list[Reference]:
    """Return the references in a JSON file.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is no such file.
    """
    data = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(data, dict):
        raise ValueError(f"{path}: a reference is a JSON object")
    found: list[Reference] = []
    for part in data.get("blocks", [data]):
        columns = [k for k in part if k.startswith("outputs") and not _IGNORED.match(k)]
        found += [_reference(part, key, named="blocks" in data) for key in columns]
    return found


def _reference(part: Mapping[str, Any], key: str, *, named: bool) -> Reference:
    program = next((name for name in _PROGRAMS if name in key), "")
    points = re.search(r"_(\d+)pts", key)
    names = part.get("input_names")
    results = part.get("output_names") if key == "outputs" else None
    return Reference(
        program,
        part.get("name") if named else None,
        int(points.group(1)) if points else None,
        None if names is None else tuple(names),
        None if results is None else tuple(results),
        tuple(tuple(map(float, row)) for row in part["inputs"]),
        tuple(tuple(map(_number, row)) for row in part[key]),
    )


def _number(value: float | str | None) -> float:
    return math.nan if value is None else float(value)


def sampled(rulebase: RuleBase, resolution: int | None) -> RuleBase:
    """Return the rule base with another number of samples, where it samples at all."""
    if resolution is None:
        return rulebase
    outputs = tuple(
        output
        if output.defuzzifier.resolution is None
        else replace(output, defuzzifier=replace(output.defuzzifier, resolution=resolution))
        for output in rulebase.outputs
    )
    return replace(rulebase, outputs=outputs)


def worst_difference(rulebase: RuleBase, reference: Reference) -> float:
    """Return the greatest relative difference to a reference, over all points and outputs.

    An output that holds has no value before; a value where there should be none, or none
    where there should be one, is an infinite difference.

    Raises
    ------
    InferenceError
        If the rule base cannot be evaluated.
    """
    prepared = prepare(sampled(rulebase, reference.resolution))
    inputs = reference.input_names or tuple(v.name for v in rulebase.inputs)
    outputs = reference.output_names or tuple(o.name for o in rulebase.outputs)
    held = {output.name: math.nan for output in rulebase.outputs}
    worst = 0.0
    for row, expected in zip(reference.inputs, reference.outputs, strict=True):
        try:
            found = prepared.evaluate(dict(zip(inputs, row, strict=True)), held)
        except (KeyError, ValueError) as error:
            raise InferenceError(str(error)) from error
        worst = max(worst, _row_difference([found[name] for name in outputs], expected))
    return worst


def _row_difference(found: Sequence[float], expected: Sequence[float]) -> float:
    return max(map(difference, found, expected), default=0.0)


def difference(found: float, expected: float) -> float:
    """Return the relative difference of two values; infinite where one has none."""
    if math.isnan(found) or math.isnan(expected):
        return 0.0 if math.isnan(found) and math.isnan(expected) else math.inf
    if found == expected or abs(found - expected) < FLOOR:
        return 0.0
    if math.isinf(found) or math.isinf(expected):
        return math.inf
    return abs(found - expected) / max(abs(found), abs(expected))
