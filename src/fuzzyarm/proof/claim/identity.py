"""The identity of a loop: digests of controller and plant, and changes from those named.

A claim names a plant, a controller has a file; a program may pass others in their place. So a
proof depends on the objects in memory: the lines, gains, rule bases and tables of the controller,
the traced equations, ports, parameters and start of the plant.

"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from hashlib import sha256
from typing import Any

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.numbers import number_text
from fuzzyarm.control.controllers.text import ControllerText, read_controller
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.language.model.controller import ControllerModel, GainModel
from fuzzyarm.language.tokens import name_text
from fuzzyarm.plant.equations import expressions_of
from fuzzyarm.plant.own import PLANTS, named_again, start_of
from fuzzyarm.plant.plant import Plant, Port, parameter
from fuzzyarm.symbolic.nodes import symbol
from fuzzyarm.symbolic.programs import program_of

# ── digests ──────────────────────────────────────────────────────────────────────────


def loop_digests(text: ControllerText, plant: Plant) -> dict[str, str]:
    """Return the SHA-256 of controller and plant, as they are in memory."""
    return {
        "controller": _digest(_controller_parts(text)),
        "plant": _digest(_plant_parts(plant)),
    }


def _digest(value: object) -> str:
    return sha256(_canonical(value).encode()).hexdigest()


def _canonical(value: object) -> str:
    """Return a text that is equal for equal values only; spans are left out."""
    if is_dataclass(value) and not isinstance(value, type):
        compared = [field.name for field in fields(value) if field.compare]
        value = [type(value).__name__, *(getattr(value, name) for name in compared)]
    elif isinstance(value, Mapping):
        value = [*value.items()]
    elif isinstance(value, np.ndarray):
        value = [value.shape, *value.ravel().tolist()]
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_canonical, value))})"
    # A text with an address equals no other: a certificate of such an object is refused.
    return value.hex() if isinstance(value, float) else repr(value)


def _controller_parts(text: ControllerText) -> dict[str, object]:
    return {"lines": _lines(text), "gains": text.model.gains, "sheets": text.sheets}


def _lines(text: ControllerText) -> ControllerModel:
    return replace(text.model, gains=(), claim_lines=(), rulebases=(), description="")


def _plant_parts(plant: Plant) -> dict[str, object]:
    return {
        "states": tuple(plant.states),
        "inputs": dict(plant.inputs),
        "outputs": dict(plant.outputs),
        "parameters": {name: parameter(plant, name).value for name in plant.parameters},
        "equations": _equations(plant),
        "start": _own_start(plant),
    }


def _equations(plant: Plant) -> str:
    """Return the traced equations as a program; nothing if they cannot be traced."""
    roots = expressions_of(plant)
    if roots is None:
        return ""
    rates, outputs = roots
    sizes = zip("xup", (plant.states, plant.inputs, plant.parameters), strict=True)
    names = ["t", *(f"{letter}{k}" for letter, group in sizes for k in range(len(group)))]
    seen = [symbol(f"x{k}") for k in range(len(plant.outputs))] if outputs is None else outputs
    return program_of([*rates, *seen], (), names).tobytes().hex()


def _own_start(plant: Plant) -> tuple[float, ...] | None:
    """Return the plant's default start; None if it is drawn at random."""
    first, second = (tuple(start_of(plant, np.random.default_rng(seed))) for seed in (0, 1))
    return first if first == second else None


# ── differences from the named controller and plant ──────────────────────────────────


def controller_changes(text: ControllerText) -> Iterator[str]:
    """Yield the changes of a controller from its file."""
    if not text.path:
        return
    try:
        written = read_controller(text.path)
    except (OSError, FuzzyarmError):
        if text.source:
            return
        written = ControllerText(replace(text.model, gains=()))
    for gain in text.model.gains:
        if gain not in written.model.gains:
            yield f"{name_text(gain.name)} = {gain_words(gain)}"
    if _canonical(_lines(text)) != _canonical(_lines(written)):
        yield "lines other than those of its file"
    for name, used in text.sheets.items():
        if written.sheets and _canonical(used) != _canonical(written.sheets.get(name)):
            yield f"{name_text(name)} is not as in its file"


def gain_words(gain: GainModel) -> str:
    """Return a gain in words: one number, or one for each axis."""
    return " ".join(number_text(amount.value(math.pi)) for amount in gain.values)


def plant_changes(claim: LoopClaim, plant: Plant) -> Iterator[str]:
    """Yield the changes of a plant from the one that the claim names."""
    named = _named(claim.plant) if claim.plant in PLANTS else named_again(claim.plant, plant)
    if named is None:
        yield f"a plant given in Python, {_digest(_plant_parts(plant))[:12]}"
        return
    before, after = _plant_parts(named), _plant_parts(plant)
    if _canonical(before) == _canonical(after):
        return
    stated = {name for name, _, _ in claim.parameters}
    for name, value in _parameters(after).items():
        if name not in stated and value != _parameters(before).get(name):
            yield f"{name_text(name)} = {number_text(value)}"
    for kind, kind_of_port in (("inputs", "actuator"), ("outputs", "sensor")):
        yield from _port_changes(kind_of_port, getattr(named, kind), getattr(plant, kind))
    begun = {name for name, _, _ in claim.start}
    if not begun >= set(plant.states) and before["start"] != after["start"]:
        start = _own_start(plant)
        pairs = [] if start is None else zip(plant.states, start, strict=True)
        words = ", ".join(f"{name_text(name)} = {number_text(x)}" for name, x in pairs)
        yield f"start {words or 'that is drawn'}"
    if any(before[part] != after[part] for part in ("states", "equations")):
        yield f"equations other than those of {name_text(claim.plant)}, {_digest(after)[:12]}"


@cache
def _named(name: str) -> Plant:
    return PLANTS[name]()


def _parameters(parts: Mapping[str, Any]) -> dict[str, float]:
    return dict(parts["parameters"])


def _port_changes(
    kind: str, before: Mapping[str, Port], after: Mapping[str, Port]
) -> Iterator[str]:
    for name, port in after.items():
        if port != before.get(name):
            yield f"{kind} {name_text(name)}: {_port_words(port)}"
    for name in before:
        if name not in after:
            yield f"no {kind} {name_text(name)}"


def _port_words(port: Port) -> str:
    words = [f"{number_text(port.low)} .. {number_text(port.high)}"]
    words += [] if math.isinf(port.slew) else [f"slew {number_text(port.slew)}"]
    words += [] if port.start is None else [f"start {number_text(port.start)}"]
    words += [f"delay {number_text(port.dead_time)} s"] if port.dead_time else []
    words += [] if port.bound == Port.bound else [f"bound {number_text(port.bound)}"]
    return ", ".join(words)
