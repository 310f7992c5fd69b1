"""Plants by name: shipped ones, and those in a Python file of the user's."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.library import LIBRARY
from fuzzyarm.plant.plant import Plant, PlantError, interface_of
from fuzzyarm.text.names import near_hint

PLANTS: dict[str, type[Plant]] = {Arm.name: Arm, **LIBRARY}
"""Every shipped plant by its name."""


def find_plant(name: str) -> Plant:
    """Make a plant from a name or a file.

    Parameters
    ----------
    name : str
        A shipped plant, ``FILE.py`` or ``FILE.py:CLASS``; a file is executed.

    Raises
    ------
    PlantError
        If there is no such plant, or it is not complete.
    """
    if name in PLANTS:
        return PLANTS[name]()
    if ".py" in name:
        return own_plant(name)
    hint = near_hint(name, PLANTS)[0] or f"{', '.join(PLANTS)}, or FILE.py:CLASS"
    raise PlantError(f"no plant '{name}'", name=name, hint=hint)


def own_plant(place: str) -> Plant:
    """Load ``FILE.py`` or ``FILE.py:CLASS``: a class with ports, states and equations.

    Raises
    ------
    PlantError
        If the file cannot be read or run, or has no such plant.
    """
    path, _, wanted = place.partition(":")
    module = executed(path, PlantError)
    found = {
        key: value
        for key, value in vars(module).items()
        if isinstance(value, type)
        and value.__module__ == module.__name__
        and hasattr(value, "outputs")
        and (hasattr(value, "derivative") or hasattr(value, "step"))
    }
    if wanted and wanted not in found:
        hint = near_hint(wanted, found)[0] or f"its plants: {', '.join(found) or 'none'}"
        raise PlantError(f"{path} has no plant '{wanted}'", name=wanted, hint=hint)
    if not wanted and len(found) != 1:
        hint = f"name one, as in {path}:{next(iter(found))}" if found else ""
        raise PlantError(f"{path} has {len(found) or 'no'} plants", name=path, hint=hint)
    kind = found[wanted] if wanted else next(iter(found.values()))
    try:
        plant = as_plant(kind())
    except PlantError:
        raise
    except Exception as error:
        raise PlantError(failure(path, error), name=kind.__name__) from error
    if not plant.name:
        plant.name = kind.__name__.lower()
    interface_of(plant)  # tells what is missing
    return plant


def as_plant(thing: Any) -> Plant:
    """Return a thing with the attributes of a plant as one; it need not be derived from it."""
    if isinstance(thing, Plant):
        return thing
    kind = type(thing)
    joined: Any = type(kind.__name__, (kind, Plant), {"__module__": kind.__module__})
    made = joined.__new__(joined)
    made.__dict__.update(vars(thing))
    assert isinstance(made, Plant)
    return made


# --- Python files of the user's ---


def executed(path: str, fault: Callable[[str], Exception]) -> ModuleType:
    """Execute a file and return what it defines.

    Parameters
    ----------
    path : str
        Of a Python file.
    fault : callable
        Makes the error of a message that says what went wrong.
    """
    try:
        source = Path(path).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise fault(f"{path} is not UTF-8 text") from error
    module = ModuleType(f"fuzzyarm_own_{Path(path).stem}")
    module.__file__ = path
    # dataclasses and others look the module of a class up.
    sys.modules[module.__name__] = module
    try:
        exec(compile(source, path, "exec"), vars(module))
    except Exception as error:
        raise fault(failure(path, error)) from error
    return module


def failure(path: str, error: Exception) -> str:
    """Say what a user's file raised, and where in it."""
    if isinstance(error, SyntaxError):
        return f"{path}:{error.lineno}: {error.msg}"
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename == path
    ]
    place = f"{path}:{lines[-1]}" if lines else path
    return f"{place}: {type(error).__name__}: {error}"
