"""The start of a plant by its own code, and the parameters that its code reads by name.

A claim has intervals for some parameters. Equations get them by their argument ``p``; by its name a
parameter has one value. A plant in plain Python is watched while its equations are traced and its
start is computed; its instructions decide whether the start may store values for the equations.
"""

from __future__ import annotations

import builtins
import dis
import math
from collections.abc import Mapping
from copy import copy
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.plant.equations import Watched, expressions_of
from fuzzyarm.plant.own import start_of
from fuzzyarm.plant.plant import Plant, parameter, with_parameters
from fuzzyarm.symbolic.nodes import symbols
from fuzzyarm.symbolic.operations import Interval


class Reads(NamedTuple):
    """Parameters of a plant."""

    unread: frozenset[str]  # by nothing: one that `__init__` has copied, for instance
    by_name: frozenset[str]  # whose one value may enter the equations


def reads_of(plant: Plant) -> Reads:
    """Return the parameters that nothing of a plant reads, and those that it reads by name."""
    at = copy(plant)
    at.parameters = watched = Watched(plant.parameters)
    for ports in (at.inputs, at.outputs, at.states):  # they may read a parameter by name, too
        tuple(ports.items())
    _, roots = at.longest_step, expressions_of(at)
    by_equations = set(watched.read)
    start_of(at, np.random.default_rng(0))
    unread = set[str]()
    if roots is not None:
        used = set(symbols(*roots[0], *(roots[1] or ())))
        numbered = enumerate(plant.parameters)
        unread = {name for k, name in numbered if f"p{k}" not in used} - set(watched.read)
    # A start may store what it reads, for equations to use.
    by_name = by_equations if _only_computes(plant) else set(watched.read)
    return Reads(frozenset(unread), frozenset(by_name))


def own_start(plant: Plant, values: Mapping[str, Interval]) -> tuple[list[float], str]:
    """Return a plant's own start, and why it is not a single point (empty: it is)."""
    points = {name: span.low for name, span in values.items()}
    at = with_parameters(plant, points) if points else copy(plant)
    at.parameters = watched = Watched(at.parameters)
    generator = np.random.default_rng(0)
    before = _drawn_from(generator)
    start = start_of(at, generator)
    if _drawn_from(generator) != before or start_of(at, np.random.default_rng(0)) != start:
        return start, f"{plant.name} draws where it starts, and a claim is about all starts"
    free = [n for n, span in values.items() if span.low < span.high and n in watched.read]
    if free:
        return start, f"{plant.name} makes its start of '{free[0]}', of which only bounds are known"
    return start, ""


def _drawn_from(generator: np.random.Generator) -> tuple[str, int]:
    """Return the state of a random generator, which changes on each draw."""
    bits: Any = generator.bit_generator
    return repr(bits.state), bits.seed_seq.n_children_spawned


_HARMLESS = (
    math, np, parameter, float, int, abs, min, max, sum, range, len, list, tuple, dict, zip,
)  # fmt: skip
"""Globals that a start may use, numbers apart."""

_ATTRIBUTES = {"parameters", "value", "get", "copy", "items", "keys", "values"} | {
    name for name in (*dir(math), *dir(np.random.Generator)) if not name.startswith("_")
}
"""Attributes that a start may read."""

_LASTING = ("STORE", "DELETE", "MAKE_FUNCTION", "IMPORT", "LOAD_CLOSURE", "LOAD_DEREF")
"""Beginnings of instructions that may keep something."""


def _only_computes(plant: Plant) -> bool:
    """Return whether a start keeps nothing: no attribute stored, no call that may store one."""
    start = getattr(plant.start, "__func__", plant.start)
    if not isinstance(start, FunctionType):
        return False
    steps = [(step.opname, step.argval) for step in dis.get_instructions(start)]
    return all(_is_harmless(start, *steps[k : k + 3]) for k in range(len(steps)))


def _is_harmless(start: FunctionType, step: tuple[str, Any], *later: tuple[str, Any]) -> bool:
    """Return whether an instruction of a start keeps nothing, judged with the two after it."""
    kind, name = step
    if kind == "LOAD_GLOBAL":
        value = start.__globals__.get(name, getattr(builtins, name, None))
        return isinstance(value, int | float) or any(value is x for x in _HARMLESS)
    if kind in ("LOAD_ATTR", "LOAD_METHOD"):
        return name in _ATTRIBUTES
    names = name if isinstance(name, tuple) else (name,)
    if kind.startswith("LOAD_FAST") and start.__code__.co_varnames[0] in names:
        # Of the plant only `self.parameters` or `parameter(self, "q")`: no operator of its own.
        (after, read), (last, _) = (*later, ("", None), ("", None))[:2]
        return read == "parameters" or (after == "LOAD_CONST" and "CALL" in last)
    return kind.startswith("STORE_FAST") or not kind.startswith(_LASTING)
