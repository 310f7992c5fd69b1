"""Live objects of other libraries: whose one is, the rule base that it is, its own numbers.

A library is known by the name of its module and of the classes that are systems; nothing of it
is imported here.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from fuzzyarm.formats.findings import Imported
from fuzzyarm.formats.fll import parse_fll
from fuzzyarm.formats.fuzzylogic import from_fuzzylogic, numbers_of_fuzzylogic
from fuzzyarm.formats.simpful import from_simpful, numbers_of_simpful
from fuzzyarm.formats.skfuzzy import from_skfuzzy, numbers_of_skfuzzy
from fuzzyarm.text.diagnostic import NOWHERE

__all__ = ["LIBRARIES", "Library", "library_of", "numbers_of", "read_object"]


@dataclass(frozen=True)
class Library:
    """A library whose objects are read.

    Attributes
    ----------
    name : str
        As people call it.
    module : str
        Its top module.
    classes : tuple of str
        Names of the classes that are systems.
    read : callable
        ``read(object, name, lossy=…, strict=…)`` gives an :class:`Imported`.
    numbers : callable
        ``numbers(object, values)`` gives the value of each output that has one, as the library
        computes it.
    """

    name: str
    module: str
    classes: tuple[str, ...]
    read: Callable[..., Imported]
    numbers: Callable[[Any, Mapping[str, float]], dict[str, float]]


# --- pyfuzzylite: it writes its engine as FLL, which is read like any file ---


def _from_pyfuzzylite(
    engine: Any, name: str, *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Return the rule base of an engine, from the text that its own exporter makes."""
    module = sys.modules[type(engine).__module__.partition(".")[0]]
    settings = module.settings
    before = {key: getattr(settings, key) for key in ("decimals", "atol")}
    # Three decimals unless told otherwise; heights and weights within `atol` of 1 are left out.
    settings.decimals, settings.atol = 25, 0.0
    try:
        text = module.FllExporter().to_string(engine)
    finally:
        for key, value in before.items():
            setattr(settings, key, value)
    imported = parse_fll(text, lossy=lossy, strict=strict)
    # There is no text for the user to find a position in.
    found = tuple(replace(d, span=NOWHERE, path="") for d in imported.diagnostics)
    rulebase = imported.rulebase
    if rulebase is not None and not rulebase.name.strip():
        rulebase = replace(rulebase, name=name)
    return Imported(rulebase, found, "pyfuzzylite")


def _numbers_of_pyfuzzylite(engine: Any, values: Mapping[str, float]) -> dict[str, float]:
    engine.restart()
    for variable in engine.input_variables:
        variable.value = values[variable.name]
    engine.process()
    found = {each.name: float(each.value) for each in engine.output_variables if each.enabled}
    return {name: value for name, value in found.items() if value == value}


# --- The libraries ---

LIBRARIES = (
    Library(
        "scikit-fuzzy",
        "skfuzzy",
        ("ControlSystem", "ControlSystemSimulation"),
        from_skfuzzy,
        numbers_of_skfuzzy,
    ),
    Library(
        "pyfuzzylite", "fuzzylite", ("Engine",), _from_pyfuzzylite, _numbers_of_pyfuzzylite
    ),
    Library("simpful", "simpful", ("FuzzySystem",), from_simpful, numbers_of_simpful),
    Library("fuzzylogic", "fuzzylogic", ("Rule",), from_fuzzylogic, numbers_of_fuzzylogic),
)  # fmt: skip
"""Libraries whose live objects are read."""


def library_of(found: object) -> Library | None:
    """Return the library that an object is a system of, or None."""
    for each in type(found).__mro__:
        module = each.__module__.partition(".")[0]
        for library in LIBRARIES:
            if library.module == module and each.__name__ in library.classes:
                return library
    return None


def read_object(
    found: object,
    name: str = "system",
    *,
    points: bool = False,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Return the rule base that a live object of another library is.

    Parameters
    ----------
    found : object
        A ``ControlSystem`` or ``ControlSystemSimulation`` of scikit-fuzzy, an ``Engine`` of
        pyfuzzylite, a ``FuzzySystem`` of simpful, or a ``Rule`` of fuzzylogic.
    name : str
        What the rule base is called.
    points : bool
        Of scikit-fuzzy: whether terms stay straight lines between the points of their universe.
    lossy, strict : bool
        As for :func:`fuzzyarm.formats.read`.

    Raises
    ------
    TypeError
        If it is none of these.
    """
    library = library_of(found)
    if library is None:
        raise TypeError(
            f"{type(found).__module__}.{type(found).__qualname__} is not a system of "
            f"{', '.join(each.name for each in LIBRARIES)}"
        )
    options = {"points": points} if library.module == "skfuzzy" else {}
    return library.read(found, name, lossy=lossy, strict=strict, **options)


def numbers_of(found: object, values: Mapping[str, float]) -> dict[str, float]:
    """Return the outputs of a live object at one point, as its library computes them.

    An output without a value is left out.
    """
    library = library_of(found)
    assert library is not None
    return library.numbers(found, values)
