"""Live objects of other libraries: recognition, rule base, evaluation.

A library is recognised by its module and the classes of its systems; it is not imported here.

To add a library: a module with ``from_<library>(object, name)``, which uses attributes only and
imports nothing of the library, and a function that evaluates the object itself; its `Library`
here; its classes in :mod:`.gather`, which runs a script in a process of its own.
:mod:`fuzzyarm.exchange.formats.recovery` finds shapes from samples. Add a line to
``tests/formats/test_live_objects.py`` and a page ``docs/howto/from-<library>.md``.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from fuzzyarm.base.diagnostic import NOWHERE, Diagnostic
from fuzzyarm.base.keywords import ArgumentError
from fuzzyarm.exchange.formats.comparison import comparison_points
from fuzzyarm.exchange.formats.findings import Imported, UnreadableError
from fuzzyarm.exchange.formats.fll import parse_fll
from fuzzyarm.exchange.live.fuzzylogic import from_fuzzylogic, fuzzylogic_numbers
from fuzzyarm.exchange.live.pyit2fls import KINDS, from_pyit2fls, pyit2fls_numbers
from fuzzyarm.exchange.live.simpful import from_simpful, simpful_numbers
from fuzzyarm.exchange.live.skfuzzy import from_skfuzzy, skfuzzy_numbers
from fuzzyarm.language.model.rulebase import RuleBase


@dataclass(frozen=True)
class Library:
    """A library with readable live objects."""

    name: str  # usual name
    module: str  # top-level module
    classes: tuple[str, ...]  # names of its system classes
    # ``read(object, name, lossy=…, strict=…)`` returns an :class:`Imported`.
    read: Callable[..., Imported]
    # ``numbers(object)`` returns a function from inputs by name to the outputs with a value,
    # evaluated by the library.
    numbers: Callable[[Any], Callable[[Mapping[str, float]], dict[str, float]]]


# --- pyfuzzylite: its own FLL text, read like any file ---


def _from_pyfuzzylite(
    engine: Any, name: str, *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Return the rule base of an engine, from its own exporter's text."""
    module = sys.modules[type(engine).__module__.partition(".")[0]]
    settings = module.settings
    before = {key: getattr(settings, key) for key in ("decimals", "atol")}
    # By default: three decimals, and no heights and weights within `atol` of 1.
    settings.decimals, settings.atol = 25, 0.0
    try:
        text = module.FllExporter().to_string(engine)
    finally:
        for key, value in before.items():
            setattr(settings, key, value)
    imported = parse_fll(text, lossy=lossy, strict=strict)
    # The user has no text for positions.
    diagnostics = tuple(replace(d, span=NOWHERE, path="") for d in imported.diagnostics)
    rulebase = imported.rulebase
    if rulebase is not None and not rulebase.name.strip():
        rulebase = replace(rulebase, name=name)
    return Imported(rulebase, diagnostics, "pyfuzzylite")


def _pyfuzzylite_numbers(engine: Any) -> Callable[[Mapping[str, float]], dict[str, float]]:
    """Return a function that evaluates an engine in pyfuzzylite."""

    def numbers(values: Mapping[str, float]) -> dict[str, float]:
        engine.restart()
        for variable in engine.input_variables:
            variable.value = values[variable.name]
        engine.process()
        outputs = {
            output_variable.name: float(output_variable.value)
            for output_variable in engine.output_variables
            if output_variable.enabled
        }
        return {name: value for name, value in outputs.items() if not math.isnan(value)}

    return numbers


# --- The libraries ---

LIBRARIES = (
    Library(
        "scikit-fuzzy",
        "skfuzzy",
        ("ControlSystem", "ControlSystemSimulation"),
        from_skfuzzy,
        skfuzzy_numbers,
    ),
    Library(
        "pyfuzzylite", "fuzzylite", ("Engine",), _from_pyfuzzylite, _pyfuzzylite_numbers
    ),
    Library("simpful", "simpful", ("FuzzySystem",), from_simpful, simpful_numbers),
    Library("fuzzylogic", "fuzzylogic", ("Rule",), from_fuzzylogic, fuzzylogic_numbers),
    Library("pyit2fls", "pyit2fls", KINDS, from_pyit2fls, pyit2fls_numbers),
)  # fmt: skip
"""Libraries with readable live objects."""


def library_of(system: object) -> Library | None:
    """Return the library of a system, or None for any other object."""
    for base in type(system).__mro__:
        module = str(base.__module__).partition(".")[0]
        for library in LIBRARIES:
            if library.module == module and base.__name__ in library.classes:
                return library
    return None


def read_object(
    system: object,
    name: str = "system",
    *,
    points: bool = False,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Return the rule base of a live object."""
    library = library_of(system)
    if library is None:
        raise ArgumentError(
            f"{type(system).__module__}.{type(system).__qualname__} is not a system of "
            f"{', '.join(record.name for record in LIBRARIES)}",
            argument="found",
        )
    options = {"points": points} if library.module == "skfuzzy" else {}
    try:
        return library.read(system, name, lossy=lossy, strict=strict, **options)
    except UnreadableError as error:
        return Imported(None, (Diagnostic("unreadable-object", str(error)[:500]),), library.name)
    except Exception as error:  # an unfinished object may raise anything
        message = f"the object cannot be read: {type(error).__name__}: {error}"
        return Imported(None, (Diagnostic("unreadable-object", message[:500]),), library.name)


# --- Evaluation at representative points ---

_SECONDS = 15.0
"""Processor time for the evaluation of an object; a slow one is compared at fewer points."""


def measured(
    system: object, rulebase: RuleBase, deadline: float = math.inf
) -> list[tuple[dict[str, float], dict[str, float] | None]]:
    """Return points with the outputs of a live object, None after an exception."""
    if not all(math.isfinite(v.low) and math.isfinite(v.high) for v in rulebase.inputs):
        return []
    library = library_of(system)
    assert library is not None
    numbers = library.numbers(system)
    until = min(deadline, time.process_time() + _SECONDS)
    results: list[tuple[dict[str, float], dict[str, float] | None]] = []
    for point in comparison_points(rulebase):
        if time.process_time() > until:
            break
        try:
            results.append((point, numbers(point)))
        except Exception:  # the library, or a user's function in it, may raise anything
            results.append((point, None))
    return results
