"""Plants by name: shipped ones, and those in a user's Python file."""

from __future__ import annotations

import linecache
import os
import sys
import sysconfig
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from functools import cache
from hashlib import sha256
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from types import ModuleType
from typing import Any, cast

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.protected import note_source
from fuzzyarm.plant.adapters import (
    ControlPlant,
    EnvironmentPlant,
    RobotPlant,
    UnitPlant,
    is_control_system,
    menagerie,
)
from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.equations import (
    TRACED,
    USERS,
    apart,
    begins_by_itself,
    fill,
    is_of_package,
    keep_traced,
)
from fuzzyarm.plant.library import LIBRARY
from fuzzyarm.plant.plain_python import HOME, Home, lacks, require_sound
from fuzzyarm.plant.plant import Plant, PlantError, is_compiled, usual_name

PLANTS: dict[str, type[Plant]] = {Arm.name: Arm, **LIBRARY}
"""Every shipped plant by its name."""

ENVIRONMENT = "gym:"
"""Prefix of a Gymnasium id."""

PREFIXES: Mapping[str, Callable[[str], Plant]] = {
    ENVIRONMENT: EnvironmentPlant,
    "menagerie:": menagerie,
}
"""Plants of other packages by the prefix of their name."""

SUFFIXES: Mapping[str, Callable[[str], Plant]] = {
    ".fmu": UnitPlant,
    ".xml": RobotPlant,
    ".urdf": RobotPlant,
}
"""Plants of other packages by the suffix of their file."""


def find_plant(name: str | os.PathLike[str] | object) -> Plant:
    """Make a plant from a name, a file or an object.

    Parameters
    ----------
    name : str, path-like or object
        A shipped plant; ``FILE.py`` or ``FILE.py:NAME``, a user's class or a python-control
        system, with the file executed; ``gym:NAME``, a Gymnasium environment; ``FILE.fmu``;
        ``FILE.xml``, ``FILE.urdf`` or ``menagerie:NAME``, a robot of MuJoCo. Or the object itself:
        a class, an object with the attributes of a plant, a python-control system.

    Raises
    ------
    PlantError
        If there is no such plant, or it is incomplete.
    MissingExtraError
        If the package of a foreign plant is not installed.
    """
    if not isinstance(name, str | os.PathLike):
        return _plant_of(name)
    name = os.fspath(name)
    if name in PLANTS:
        return PLANTS[name]()
    for prefix, make in PREFIXES.items():
        if name.startswith(prefix):
            return make(name.removeprefix(prefix))
    is_path = "\0" not in name
    for suffix, make in SUFFIXES.items():
        if is_path and name.lower().endswith(suffix):
            return make(name)
    if is_path and ".py" in name:
        return own_plant(name)
    ways = f"{', '.join(PLANTS)}, FILE.py:NAME, FILE.fmu, FILE.xml or gym:NAME"
    hint = near_hint(name, PLANTS)[0] or ways
    raise PlantError(f"no plant '{name}'", name=name, hint=hint)


def beside(name: str, folder: str) -> str:
    """Return the name of a plant or file in a file of `folder`, for the working folder.

    Shipped plants, ``gym:NAME`` and absolute paths are unchanged.
    """
    if not is_relative_file(name):
        return name
    path = os.path.join(folder, name)
    plain = os.path.normpath(path)
    # `..` of a linked folder is not the folder that its name has before it.
    return plain if os.path.realpath(plain) == os.path.realpath(path) else path


def is_relative_file(name: str) -> bool:
    """Whether a name in a file is a relative path: not a shipped plant, nor ``gym:NAME``."""
    return _is_file(name) and not os.path.isabs(name)


def _is_file(name: str) -> bool:
    is_file = any(end in name.lower() for end in (".py", ".frb", *SUFFIXES))
    return is_file and not _has_prefix(name)


def _has_prefix(name: str) -> bool:
    """Whether a name is of another package, as ``gym:NAME``."""
    return name.startswith(tuple(PREFIXES))


def trusted_plant(name: str, named: str | None = None, *, trust: bool = False) -> Plant:
    """Make a plant named in a file: a shipped one, or one whose code may run.

    Parameters
    ----------
    name : str
        As in a `prove` line or a certificate.
    named : str, optional
        The plant of the command line, whose file may run.
    trust : bool, optional
        Whether all files may run.

    Raises
    ------
    PlantError
        If there is none, or it is code requested by the file alone.
    """
    if _is_file(name) and not os.path.exists(_place(name)):
        hint = "names in a controller or a certificate count from its folder"
        raise PlantError(f"there is no file '{_file(name)}'", name=name, hint=hint)
    is_code = _is_file(name) or _has_prefix(name)
    if not is_code or trust or (named is not None and same_file(name, named)):
        return find_plant(name)
    message = f"the plant '{name}' is code, which does not run because a file names it"
    raise PlantError(message, name=name, hint="--trust runs it")


def same_file(name: str, other: str) -> bool:
    """Whether two names of plants are of the same file, or the same name."""
    return _place(name) == _place(other)


def _place(name: str) -> str:
    """Return the canonical file of a plant, for comparison."""
    path = _file(name)
    return path if _has_prefix(path) or "\0" in path else os.path.realpath(path)


def _file(name: str) -> str:
    """Return the file of ``FILE.py:CLASS``."""
    path, with_class, _ = name.rpartition(".py:")
    return f"{path}.py" if with_class and not _has_prefix(name) else name


def own_plant(place: str) -> Plant:
    """Load ``FILE.py`` or ``FILE.py:NAME``.

    A class with ports, states and equations, an instance of one, or a python-control system.
    """
    path, _, class_name = place.partition(":")
    module = executed(path, PlantError)
    classes = {key: value for key, value in vars(module).items() if _is_plant_of(module, value)}
    whys = lacks({k: v for k, v in vars(module).items() if _is_class_of(module, v)})
    if class_name and class_name not in classes:
        why = next((reason for reason in whys if reason.startswith(f"class {class_name} ")), "")
        hint = why or near_hint(class_name, classes)[0]
        hint = hint or f"its plants: {', '.join(classes) or 'none'}"
        raise PlantError(f"{path} has no plant '{class_name}'", name=class_name, hint=hint)
    if not class_name and len(classes) != 1:
        hint = f"name one, as in {path}:{next(iter(classes))}" if classes else "; ".join(whys)
        raise PlantError(f"{path} has {len(classes) or 'no'} plants", name=path, hint=hint)
    return _made(module, class_name or next(iter(classes)))


def _made(module: ModuleType, key: str) -> Plant:
    """Make the plant of a name in a user's file."""
    path = str(module.__file__)
    thing = getattr(module, key)
    try:
        plant = _plant_of(thing if isinstance(thing, type) else copy(thing))
    except PlantError:
        raise
    except USERS as error:
        raise PlantError(failure(path, error), name=key) from error
    vars(plant)[HOME] = Home(path, getattr(module, SOURCE), key, dict(vars(plant)))
    require_sound(plant)  # raises if incomplete
    return plant


def plant_files(plant: Plant) -> dict[str, str]:
    """Return the SHA-256 of the file of Python that made a plant, by name; else nothing."""
    home = vars(plant).get(HOME)
    if not isinstance(home, Home) or not os.path.isfile(home.path):
        return {}
    return {home.path: sha256(Path(home.path).read_bytes()).hexdigest()}


def plant_again(path: str, source: str, key: str) -> Plant:
    """Make a plant of a file whose text came from another process."""
    return _made(module_again(path, source), key)


def named_again(name: str, plant: Plant) -> Plant | None:
    """Reload the plant of a file by its name, if `plant` came from that file; else None.

    No new code runs: the text is that of the existing plant.
    """
    module = sys.modules.get(type(plant).__module__)
    home = vars(plant).get(HOME)
    path, source = (home.path, home.source) if home else (
        getattr(module, "__file__", None), vars(module).get(SOURCE) if module else None
    )  # fmt: skip
    if not path or source is None:
        return None
    key = name.rpartition(".py:")[2] if ".py:" in name else ""
    if not same_file(name, path) and (not home or name != plant.name):
        return None
    key = key or (home.key if home else type(plant).__name__)
    try:
        # Anew, since Python may have changed a module that was executed before; and aside, since
        # the existing plant and its modules stay as they are.
        return _made(executed(path, PlantError, source, aside=True), key)
    except (PlantError, AttributeError):
        return None


@cache
def module_again(path: str, source: str) -> ModuleType:
    """Execute a text from another process, once."""
    return executed(path, PlantError, source)


def _is_class_of(module: ModuleType, value: Any) -> bool:
    return isinstance(value, type) and value.__module__ == module.__name__


def _is_plant_of(module: ModuleType, value: Any) -> bool:
    """Whether a value of a file is a plant: a class defined there, or an instance."""
    if not isinstance(value, type):
        return isinstance(value, Plant) or is_control_system(value)
    return value.__module__ == module.__name__ and _moves(value)


def _moves(thing: Any) -> bool:
    """Whether an object or a class has the attributes of a plant, or dataclass fields for them."""
    has = hasattr(thing, "outputs") or "outputs" in getattr(thing, "__dataclass_fields__", ())
    return has and (hasattr(thing, "derivative") or hasattr(thing, "step"))


def _plant_of(thing: Any) -> Plant:
    """Coerce to a Plant: an object or its class, a python-control system."""
    if is_control_system(thing):
        return ControlPlant(thing)
    if not _moves(thing):
        message = f"'{type(thing).__name__}' is not a plant"
        hint = "a name, a file, or an object with inputs, outputs, states and derivative"
        raise PlantError(message, hint=hint)
    plant = as_plant(thing() if isinstance(thing, type) else thing)
    if not plant.name:
        plant = copy(plant)
        plant.name = usual_name(plant)
    return plant


def as_plant(thing: Any) -> Plant:
    """Return an object with the attributes of a plant as a Plant, derived from it or not."""
    if isinstance(thing, Plant):
        return thing
    kind: Any = type(thing)
    subclass = plant_class(kind)
    plant = subclass.__new__(subclass)
    plant.__dict__.update(vars(thing))
    return plant


@cache
def plant_class(kind: Any) -> type[Plant]:
    """Return a class as a subclass of :class:`Plant`."""
    subclass: Any = type(kind.__name__, (kind, Plant), {"__module__": kind.__module__})
    return cast(type[Plant], subclass)


# --- Python files of users ---

SOURCE = "__fuzzyarm_source__"
"""Attribute of a user's module with its text."""


OWN = "fuzzyarm_own_"
"""Prefix of the modules of users' files; not importable."""


def executed(
    path: str,
    fault: Callable[[str], Exception],
    source: str | None = None,
    *,
    aside: bool = False,
) -> ModuleType:
    """Execute a file and return its module; it may import others of its folder.

    Parameters
    ----------
    path : str
        Path of a Python file.
    fault : callable
        Makes the error from a message.
    source : str, optional
        Its text, if the file may be on another machine.
    aside : bool, optional
        Whether the modules in memory, of this file and of its folder, stay as they are.
    """
    if source is None:
        note_source(path)
        try:
            source = Path(path).read_text(encoding="utf-8")
        except UnicodeDecodeError as error:
            raise fault(f"{path} is not UTF-8 text") from error
    else:  # for tracebacks and digests of kernels
        linecache.cache[path] = (len(source), None, source.splitlines(keepends=True), path)
    # Named by content, too: two files may both be called mine.py.
    module = ModuleType(f"{OWN}{Path(path).stem}_{sha256(source.encode()).hexdigest()[:12]}")
    module.__file__ = path
    vars(module)[SOURCE] = source
    # Dataclasses and others look the module of a class up in sys.modules.
    before = sys.modules.get(module.__name__)
    sys.modules[module.__name__] = module
    try:
        with _neighbours(os.path.dirname(os.path.abspath(path)), aside=aside):
            exec(compile(source, path, "exec"), vars(module))
    except USERS as error:
        raise fault(failure(path, error)) from error
    finally:
        if aside and before is not None:
            sys.modules[module.__name__] = before
    return module


_imported: dict[str, ModuleType] = {}
"""Modules imported by users' files from their folders, by name."""

INSTALLED = frozenset(sysconfig.get_paths().values())
"""Folders of packages, which are imported once."""


@contextmanager
def _neighbours(folder: str, *, aside: bool) -> Iterator[None]:
    """Let a file import modules of its folder, fresh each time, as when run by Python.

    Modules that the program itself had imported are restored afterwards.
    """
    again = {*_modules_of(folder), *_imported}
    before = {name: sys.modules.pop(name) for name in again if name in sys.modules}
    own = {name: found for name, found in before.items() if found is not _imported.get(name)}
    kept = before if aside else own
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
        if folder not in sys.path:  # for imports inside functions
            sys.path.append(folder)
        fresh = _modules_of(folder)
        if aside:
            for name in fresh:
                del sys.modules[name]
        else:
            _imported.clear()
            _imported.update((name, sys.modules[name]) for name in fresh)
        sys.modules.update(kept)


def _modules_of(folder: str) -> list[str]:
    """Return the names of the imported modules and packages of a folder, with their modules."""
    if folder in INSTALLED:
        return []
    modules = {name: module for name, module in sys.modules.copy().items() if name != "__main__"}
    tops = {name for name, module in modules.items() if "." not in name and _is_in(module, folder)}
    parts = {name: name.partition(".")[0] for name in modules}
    # Machine code is loaded once.
    machine = {parts[name] for name, module in modules.items() if _is_machine_code(module)}
    tops -= machine | {"fuzzyarm"}
    return [name for name, top in parts.items() if top in tops]


def _is_in(module: ModuleType, folder: str) -> bool:
    places = [*getattr(module, "__path__", ()), getattr(module, "__file__", None) or ""]
    return folder in map(os.path.dirname, places) and not module.__name__.startswith(OWN)


def _is_machine_code(module: ModuleType) -> bool:
    return str(getattr(module, "__file__", None) or "").endswith(tuple(EXTENSION_SUFFIXES))


def failure(path: str, error: BaseException) -> str:
    """Return the exception of a user's file in words, with its line."""
    if isinstance(error, SyntaxError):
        return f"{path}:{error.lineno}: {error.msg}"
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename == path
    ]
    place = f"{path}:{lines[-1]}" if lines else path
    return f"{place}: {type(error).__name__}: {error}"


def failure_of(thing: object, error: BaseException) -> str:
    """Return the exception of an object's class in words, with its line."""
    path = getattr(sys.modules.get(type(thing).__module__), "__file__", None) or ""
    return failure(path, error)


@contextmanager
def plain_errors(plant: Plant) -> Iterator[None]:
    """Turn exceptions of a plant in plain Python into one clear sentence."""
    try:
        yield
    except FuzzyarmError:
        raise
    except USERS as error:
        if is_compiled(plant):
            raise
        raise PlantError(f"plant {plant.name} failed: {failure_of(plant, error)}") from error


BEGUN = "_fuzzyarm_begun"
"""Attribute of a plant in a run with its state before any run."""

FIRST = "_fuzzyarm_first"
"""Attribute of a plant with initial states that replace its own."""


def for_runs(plant: Plant) -> Plant:
    """Return a copy of a user's plant for runs, reset at each start.

    So a run affects neither the user's object nor the next run, whatever it stores in attributes.
    Plants of the package reset themselves.
    """
    if is_of_package(type(plant)):
        return plant
    other: Plant = apart(plant)
    keep_traced(other, plant)
    if begins_by_itself(other) or not is_compiled(other):  # otherwise it has no state outside x
        vars(other)[BEGUN] = apart(plant)
    return other


def starting_at(plant: Plant, states: Sequence[float]) -> Plant:
    """Return a plant with other initial states."""
    other = copy(plant)
    vars(other)[FIRST] = tuple(states)
    return other


def start_of(plant: Plant, generator: np.random.Generator) -> list[float]:
    """Return the initial states of a plant."""
    begun = vars(plant).get(BEGUN)
    if begun is not None:
        state_kept = {name: vars(plant)[name] for name in (BEGUN, TRACED)}
        fill(plant, begun)
        vars(plant).update(state_kept)
    with plain_errors(plant):
        start = [float(value) for value in plant.start(generator)]
    if len(start) != len(plant.states):
        message = f"start gives {len(start)} values for {len(plant.states)} states"
        raise PlantError(f"plant {plant.name}: {message}", name="start")
    return list(vars(plant).get(FIRST, start))
