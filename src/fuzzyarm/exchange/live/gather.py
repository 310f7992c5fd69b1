"""Run a script in its own process and gather its fuzzy systems.

This file is run by its path (see :mod:`fuzzyarm.exchange.live.systems`), perhaps by a Python
without fuzzyarm: the script's libraries may conflict with ours. Until the script has ended, only
the standard library is loaded; then the package beside this file, which reads live objects without
NumPy. The answer is a JSON file.
"""

from __future__ import annotations

import _thread
import builtins
import importlib.util
import json
import os
import re
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any, NamedTuple

MEASURING = 40.0
"""Processor seconds for the evaluation of all systems."""

MOST_MADE, DEEPEST = 1000, 3
"""Most systems kept alive after the script dropped them; search depth in its objects."""

CALL = "_fuzzyarm_call"
"""Attribute of a system with the arguments of its evaluation: of the last one, or of the first that
shows the order of its functions' arguments."""

# --- Recording of the libraries' objects ---

SYSTEMS = {
    "skfuzzy.control.controlsystem": {"ControlSystem": "", "ControlSystemSimulation": ""},
    "fuzzylite.engine": {"Engine": "process"},
    "simpful.simpful": {"FuzzySystem": "inference"},
    "fuzzylogic.classes": {"Rule": ""},
    "pyit2fls.pyit2fls": dict.fromkeys(
        ("IT2Mamdani", "IT2TSK", "IT2FLS", "T1Mamdani", "T1TSK"), "evaluate"
    ),
}
"""Module → class → its evaluation method, empty if an object is complete on construction."""


class _Made(NamedTuple):
    """A system and the frame that made it, for the variables assigned later."""

    system: Any
    frame: FrameType


_made: list[_Made] = []
_complete: set[int] = set()  # systems evaluated, or without need of evaluation


def watch_imports() -> None:
    """Wrap the import function: the classes of :data:`SYSTEMS` then record their objects."""
    plain, waiting = builtins.__import__, dict(SYSTEMS)

    def imports(*arguments: Any, **options: Any) -> Any:
        module = plain(*arguments, **options)
        for name in waiting.keys() & sys.modules.keys():
            loaded = sys.modules[name]
            if not getattr(loaded.__spec__, "_initializing", False):
                for kind, method in waiting.pop(name).items():
                    if hasattr(loaded, kind):
                        _remember(getattr(loaded, kind), method)
        return module

    builtins.__import__ = imports


def _remember(kind: Any, method: str) -> None:
    make, home = kind.__init__, _top_module(kind.__module__)

    def init(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        frame: FrameType | None = sys._getframe(1)
        while frame is not None and _top_module(frame.f_globals.get("__name__")) == home:
            frame = frame.f_back  # skip the library's own frames
        if frame is not None and len(_made) < MOST_MADE:
            _made.append(_Made(self, frame))
        if not method:
            _complete.add(id(self))
        elif method in vars(self):  # bound to the object by its constructor
            bound = vars(self)[method]
            vars(self)[method] = _noting(lambda _, *a, **k: bound(*a, **k)).__get__(self)

    kind.__init__ = init
    if method and hasattr(kind, method):
        setattr(kind, method, _noting(getattr(kind, method)))


def _noting(compute: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a method to record its object as evaluated, with the arguments."""

    def method(self: Any, *arguments: Any, **options: Any) -> Any:
        result = compute(self, *arguments, **options)
        _complete.add(id(self))
        if not _tells_order(*vars(self).get(CALL, ((), {}))):
            vars(self)[CALL] = (arguments, options)
        return result

    return method


def _tells_order(arguments: tuple[Any, ...], options: dict[str, Any]) -> bool:
    """Whether the arguments of an evaluation identify the inputs of functions."""
    inputs, params, *_ = (*arguments, None, None)
    inputs, params = options.get("inputs", inputs), options.get("params", params)
    if not isinstance(inputs, dict) or not isinstance(params, (tuple, list)):
        return False  # settings of another class: the last ones win
    try:
        return len(set(map(float, inputs.values()))) == len(inputs)
    except (TypeError, ValueError):
        return False


def _top_module(name: object) -> str:
    return str(name).partition(".")[0]


# --- The script ---

_NOTEBOOK = re.compile(rb"^([ \t]*)(?:[!%]|(?:pip|conda) install\b).*$", re.MULTILINE)
"""A line for a notebook or a shell, which people leave in their scripts."""


def _interrupt() -> None:
    if hasattr(signal, "pthread_kill"):  # wakes a sleep, too
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


def _as_data(error: BaseException, script: str) -> dict[str, Any]:
    """Return an exception as data, with the last line of the script in its traceback."""
    line, column = 0, 0
    if isinstance(error, SyntaxError) and error.filename == script:
        line, column = error.lineno or 0, error.offset or 0
    else:
        for frame in traceback.extract_tb(error.__traceback__):
            if frame.filename == script:
                line = frame.lineno or 0
    text = error.msg if isinstance(error, SyntaxError) else str(error)
    return {
        "kind": type(error).__name__,
        "message": " ".join(text.split())[:200],
        "line": line,
        "column": column,
    }


# --- The script's systems and their names ---


def _named(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """Yield names and objects: variables, their contents, local variables of functions."""
    own_modules = _own_modules(module)
    visited: set[int] = set()
    variables = {n: v for n, v in vars(module).items() if not n.startswith("__")}
    yield from _in_scope(variables, own_modules, visited)
    for made in reversed(_made):
        if made.frame.f_locals is not vars(module):
            yield from _in_scope(dict(made.frame.f_locals), own_modules, visited)


def _own_modules(module: ModuleType) -> frozenset[str]:
    """Return the names of the modules in the folder of the script."""
    home = os.path.join(os.path.dirname(os.path.realpath(str(module.__file__))), "")
    files = {name: getattr(loaded, "__file__", None) for name, loaded in list(sys.modules.items())}
    inside = {n for n, f in files.items() if f and os.path.realpath(f).startswith(home)}
    return frozenset({"__main__", *(n for n in inside if "site-packages" not in str(files[n]))})


def _in_scope(
    variables: dict[str, Any], modules: frozenset[str], visited: set[int], depth: int = 0
) -> Iterator[tuple[str, Any]]:
    yield from variables.items()
    if depth == DEEPEST:
        return
    for name, value in variables.items():
        inside = _inside(name, value, modules)
        if inside and id(value) not in visited:
            visited.add(id(value))
            yield from _in_scope(inside, modules, visited, depth + 1)


def _inside(name: str, value: Any, modules: frozenset[str]) -> dict[str, Any]:
    """Return the contents of a container or of an object of the script, by name."""
    if isinstance(value, dict):
        return {f"{name}_{key}": part for key, part in list(value.items())[:MOST_MADE]}
    if isinstance(value, list | tuple):
        return {f"{name}_{i}": part for i, part in enumerate(value[:MOST_MADE], 1)}
    if type(value).__module__ not in modules:
        return {}
    attributes = dict(getattr(value, "__dict__", {}))
    return {
        k if name == "self" else f"{name}_{k}": attribute for k, attribute in attributes.items()
    }


def _systems(
    module: ModuleType, stem: str, is_system: Callable[[Any], bool], *, whole: bool
) -> tuple[dict[str, Any], list[str]]:
    """Return the systems by name, each once under its first name, and those left out.

    Nameless systems are used only if none has a name. With `whole` only complete systems, that is
    evaluated ones, are returned.
    """
    systems: dict[int, tuple[str, Any]] = {}
    simulations: dict[int, tuple[str, Any]] = {}
    left_out: dict[int, str] = {}
    candidates = [(n, v) for n, v in _named(module) if not isinstance(v, type) and is_system(v)]
    for name, value in candidates or [(stem, made.system) for made in _made]:
        system = getattr(value, "ctrl", value)
        if whole and id(value) not in _complete and id(system) not in _complete:
            left_out.setdefault(id(system), name)
        elif system is not value:
            simulations.setdefault(id(system), (name, value))
        elif not hasattr(value, "conditions") or value.conditions:
            systems.setdefault(id(value), (name, value))
    for key, (name, simulation) in simulations.items():
        first_name = systems.get(key, (name, None))[0]
        clips = getattr(simulation, "clip_to_bounds", True)
        systems[key] = (first_name, simulation.ctrl if clips else simulation)
    return _with_names([*_without_parts(list(systems.values()))]), list(left_out.values())


def _without_parts(objects: list[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    """Leave out rules of fuzzylogic that are part of a sum of rules."""
    sums = [set(system.conditions) for _, system in objects if hasattr(system, "conditions")]
    for name, system in objects:
        conditions = set(getattr(system, "conditions", ()))
        if not conditions or not any(conditions < other for other in sums):
            yield name, system


def _with_names(objects: list[tuple[str, Any]]) -> dict[str, Any]:
    """Give each system a unique file name, also where case does not matter."""
    systems: dict[str, Any] = {}
    for name, system in objects:
        plain = "".join(c if c.isalnum() or c in "_-" else "_" for c in name)[:80].strip("-")
        plain = plain or "system"
        folded = {other.casefold() for other in systems}
        number, unique = 2, plain
        while unique.casefold() in folded:
            unique, number = f"{plain}_{number}", number + 1
        systems[unique] = system
    return systems


# --- Answer ---


def _load_fuzzyarm() -> None:
    """Load the package beside this file without the rest of its folder."""
    if "fuzzyarm" in sys.modules:
        return
    home = Path(__file__).parents[2]
    spec = importlib.util.spec_from_file_location(
        "fuzzyarm", home / "__init__.py", submodule_search_locations=[str(home)]
    )
    assert spec is not None
    assert spec.loader is not None
    package = importlib.util.module_from_spec(spec)
    sys.modules["fuzzyarm"] = package
    spec.loader.exec_module(package)


def _gathered(
    module: ModuleType, stem: str, options: dict[str, Any], *, whole: bool
) -> dict[str, Any]:
    _load_fuzzyarm()
    from fuzzyarm.exchange.live.objects import library_of

    _name_sets(module)
    systems, left_out = _systems(
        module, stem, lambda value: library_of(value) is not None, whole=whole
    )
    deadline = time.process_time() + MEASURING
    records = [_as_found(name, system, options, deadline) for name, system in systems.items()]
    return {"found": records, "left_out": left_out}


def _name_sets(module: ModuleType) -> None:
    """Name anonymous sets after their variables in the script."""
    from fuzzyarm.exchange.live.pyit2fls import NAME

    for name, value in _named(module):
        is_set = hasattr(value, "umf") or hasattr(value, "mf")
        if is_set and type(value).__module__.partition(".")[0] == "pyit2fls":
            vars(value).setdefault(NAME, name)


def _as_found(name: str, system: Any, options: dict[str, Any], deadline: float) -> dict[str, Any]:
    from fuzzyarm.exchange.formats import write
    from fuzzyarm.exchange.formats.tables import in_tables
    from fuzzyarm.exchange.live.objects import library_of, measured, read_object

    library = library_of(system)
    assert library is not None
    record: dict[str, Any] = {"name": name, "library": library.name, "text": None, "points": []}
    reading = {key: options[key] for key in ("points", "lossy", "strict")}
    imported = read_object(system, name, **reading)
    diagnostics = list(imported.diagnostics)
    if imported.rulebase is not None:
        rulebase = in_tables(imported.rulebase)
        exported = write(rulebase, ".frb", lossy=options["lossy"], strict=options["strict"])
        diagnostics += exported.diagnostics
        record["text"] = exported.text
        record["points"] = measured(system, rulebase, deadline)
    record["diagnostics"] = [(d.name, d.message, str(d.severity), d.hint) for d in diagnostics]
    return record


def main() -> None:
    """Run ``gather.py SCRIPT ANSWER OPTIONS`` and end the process."""
    script, target, options = Path(sys.argv[1]), Path(sys.argv[2]), json.loads(sys.argv[3])
    module = ModuleType("__main__")
    module.__dict__.update(__file__=str(script), __builtins__=builtins)
    sys.modules["__main__"] = module
    sys.argv, sys.path[0] = [str(script)], str(script.parent)
    watch_imports()
    raised: dict[str, Any] | None = None
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job ignores it
    timer = threading.Timer(options["seconds"], _interrupt)
    timer.daemon = True
    timer.start()
    try:
        text = _NOTEBOOK.sub(rb"\1pass", script.read_bytes())
        exec(compile(text, str(script), "exec", dont_inherit=True), vars(module))
    except BaseException as error:
        if not isinstance(error, SystemExit) or error.code not in (None, 0):
            raised = _as_data(error, str(script))
    timer.cancel()
    os.chdir(script.parent)
    failed = raised is not None and raised["kind"] not in HARMLESS
    answer: dict[str, Any] = {"raised": raised, "found": [], "left_out": []}
    try:
        answer |= _gathered(module, script.stem, options, whole=failed and not options["lossy"])
    except BaseException as error:
        answer["refused"] = f"{type(error).__name__}: {error}"[:500]
    target.write_text(json.dumps(answer), encoding="utf-8")
    os._exit(0)  # do not wait for threads of the script


HARMLESS = ("EOFError", "SystemExit", "KeyboardInterrupt")
"""Exceptions that end a script normally: no input, an exit, no more time."""

if __name__ == "__main__":
    main()
