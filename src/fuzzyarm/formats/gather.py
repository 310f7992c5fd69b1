"""Run a script in a process of its own and gather the fuzzy systems that it makes.

This file is started by its path (see :mod:`fuzzyarm.live`), maybe by another Python than the one
that has fuzzyarm: the script may need libraries that do not go with ours. Until the script has
ended nothing but the standard library is loaded; then the package beside this file is, which
takes no array library to read live objects. What was found goes into a file as JSON.
"""

from __future__ import annotations

import builtins
import importlib.abc
import importlib.machinery
import importlib.util
import json
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any, NamedTuple

GRACE = 5.0
"""Seconds between the interrupt of a script that does not end and the end of its process."""

MOST_MADE = 1000
"""Systems that are kept alive though the script has dropped them."""

MEASURING = 40.0
"""Seconds for the numbers of all systems."""


# --- What happens at imports ---


class _Made(NamedTuple):
    """A system and the frame that made it, whose variables are still to come."""

    system: Any
    frame: FrameType


_made: list[_Made] = []


def _keep(*classes: str) -> Callable[[ModuleType], None]:
    """Return what makes some classes of a module remember their objects."""

    def change(module: ModuleType) -> None:
        for name in classes:
            _remember(getattr(module, name))

    return change


def _remember(kind: Any) -> None:
    make, home = kind.__init__, _top_module(kind.__module__)

    def init(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        frame: FrameType | None = sys._getframe(1)
        while frame is not None and _top_module(frame.f_globals.get("__name__")) == home:
            frame = frame.f_back  # the library itself: whoever has called it
        if frame is not None and len(_made) < MOST_MADE:
            _made.append(_Made(self, frame))

    init.__doc__ = make.__doc__
    kind.__init__ = init


def _top_module(name: object) -> str:
    return str(name).partition(".")[0]


def _no_windows(matplotlib: Any) -> None:
    """Let a figure have no window, whatever the script asks for."""
    matplotlib.rcParams["backend"] = "Agg"
    matplotlib.use = lambda *_, **__: None


_AFTER_IMPORT: dict[str, Callable[[ModuleType], None]] = {
    "matplotlib": _no_windows,
    "skfuzzy.control.controlsystem": _keep("ControlSystem", "ControlSystemSimulation"),
    "fuzzylite.engine": _keep("Engine"),
    "simpful.simpful": _keep("FuzzySystem"),
    "fuzzylogic.classes": _keep("Rule"),
    "pyit2fls.pyit2fls": _keep("IT2Mamdani", "IT2TSK"),
}
"""Module → what is changed in it as soon as it is loaded."""


class _Finder(importlib.abc.MetaPathFinder):
    """Finds the modules of :data:`_AFTER_IMPORT` where everybody does, and changes them."""

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        change = _AFTER_IMPORT.get(name)
        if change is None:
            return None
        found = importlib.machinery.PathFinder.find_spec(name, path, target)
        loader = found.loader if found is not None else None
        if found is None or loader is None:
            return None
        load = loader.exec_module

        def load_and_change(module: ModuleType) -> None:
            load(module)
            try:
                change(module)
            except Exception:  # another release: its objects are found by their names only
                traceback.print_exc()

        loader.exec_module = load_and_change  # type: ignore[method-assign]
        return found


# --- The script ---


class _Interrupt:
    """Interrupts the script after `seconds`, and ends the process if that does not help."""

    def __init__(self, seconds: float, end: Callable[[], None]) -> None:
        self.happened = False
        self._timers = [
            threading.Timer(seconds, self._interrupt),
            threading.Timer(seconds + GRACE, end),
        ]
        for timer in self._timers:
            timer.daemon = True
            timer.start()

    def _interrupt(self) -> None:
        import _thread

        self.happened = True
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
        else:
            _thread.interrupt_main()

    def cancel(self) -> None:
        """Let the process go on."""
        for timer in self._timers:
            timer.cancel()


def _run(script: Path, module: ModuleType) -> dict[str, Any] | None:
    """Run a script as Python would; return what ended it early, if anything did."""
    try:
        code = builtins.compile(script.read_bytes(), str(script), "exec", dont_inherit=True)
        exec(code, module.__dict__)
    except SystemExit:
        return None
    except BaseException as error:
        return _as_data(error, str(script))
    return None


def _as_data(error: BaseException, script: str) -> dict[str, Any]:
    """Return an exception with the last line of the script that it passed."""
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


# --- What it has made, and what that is called ---


def _named(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """Yield names and objects: variables, what they contain, variables of functions."""
    variables = {n: v for n, v in vars(module).items() if not n.startswith("__")}
    yield from _in_scope(variables)
    for made in reversed(_made):
        if made.frame.f_locals is not vars(module):
            yield from _in_scope(dict(made.frame.f_locals))


def _in_scope(variables: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    yield from variables.items()
    for name, value in variables.items():
        if isinstance(value, dict):
            yield from ((f"{name}_{key}", each) for key, each in list(value.items())[:MOST_MADE])
        elif isinstance(value, list | tuple):
            yield from ((f"{name}_{i}", each) for i, each in enumerate(value[:MOST_MADE], 1))
        elif type(value).__module__ == "__main__":
            inside = getattr(value, "__dict__", {})
            yield from ((k if name == "self" else f"{name}_{k}", v) for k, v in inside.items())


def _systems(module: ModuleType, stem: str, is_system: Callable[[Any], bool]) -> dict[str, Any]:
    """Return the systems by name, each once, however many names it has.

    What has no name at all counts where nothing has one.
    """
    found: dict[int, tuple[str, Any]] = {}
    simulations: dict[int, tuple[str, Any]] = {}
    named = [(n, v) for n, v in _named(module) if not isinstance(v, type) and is_system(v)]
    for name, value in named or [(stem, made.system) for made in _made]:
        system = getattr(value, "ctrl", value)
        if system is not value:
            simulations.setdefault(id(system), (name, value))
        elif not hasattr(value, "conditions") or value.conditions:
            found.setdefault(id(value), (name, value))
    for key, (name, simulation) in simulations.items():
        known = found.get(key, (name, None))[0]
        clips = getattr(simulation, "clip_to_bounds", True)
        found[key] = (known, simulation.ctrl if clips else simulation)
    return _with_names([*_without_parts(list(found.values()))])


def _without_parts(found: list[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    """Leave out rules of fuzzylogic that are part of a sum of rules."""
    sums = [set(each.conditions) for _, each in found if hasattr(each, "conditions")]
    for name, each in found:
        own = set(getattr(each, "conditions", ()))
        if not own or not any(own < other for other in sums):
            yield name, each


def _with_names(found: list[tuple[str, Any]]) -> dict[str, Any]:
    """Give every system a name that can be that of a file, also where case does not count."""
    named: dict[str, Any] = {}
    for name, each in found:
        plain = "".join(c if c.isalnum() or c in "_-" else "_" for c in name)[:80].strip("-")
        plain = plain or "system"
        taken = {other.casefold() for other in named}
        number, unique = 2, plain
        while unique.casefold() in taken:
            unique, number = f"{plain}_{number}", number + 1
        named[unique] = each
    return named


# --- The answer ---


def _load_fuzzyarm() -> None:
    """Load the package beside this file, and nothing else from its folder."""
    if "fuzzyarm" in sys.modules:
        return
    home = Path(__file__).parents[1]
    spec = importlib.util.spec_from_file_location(
        "fuzzyarm", home / "__init__.py", submodule_search_locations=[str(home)]
    )
    assert spec is not None
    assert spec.loader is not None
    package = importlib.util.module_from_spec(spec)
    sys.modules["fuzzyarm"] = package
    spec.loader.exec_module(package)


def _gathered(module: ModuleType, stem: str, options: dict[str, Any]) -> list[dict[str, Any]]:
    _load_fuzzyarm()
    from fuzzyarm.formats.objects import library_of

    _name_sets(module)
    systems = _systems(module, stem, lambda value: library_of(value) is not None)
    deadline = time.monotonic() + MEASURING
    return [_as_found(name, each, options, deadline) for name, each in systems.items()]


def _name_sets(module: ModuleType) -> None:
    """Tell sets that have no name of their own what the script calls them."""
    from fuzzyarm.formats.pyit2fls import NAME

    for name, value in _named(module):
        if type(value).__module__.partition(".")[0] == "pyit2fls" and hasattr(value, "umf"):
            vars(value).setdefault(NAME, name)


def _as_found(name: str, system: Any, options: dict[str, Any], deadline: float) -> dict[str, Any]:
    from fuzzyarm.formats import write
    from fuzzyarm.formats.objects import library_of, measured, read_object
    from fuzzyarm.formats.tables import in_tables

    library = library_of(system)
    assert library is not None
    found: dict[str, Any] = {"name": name, "library": library.name, "text": None, "points": []}
    reading = {key: options[key] for key in ("points", "lossy", "strict")}
    imported = read_object(system, name, **reading)
    diagnostics = list(imported.diagnostics)
    if imported.rulebase is not None:
        rulebase = in_tables(imported.rulebase)
        exported = write(rulebase, ".frb", lossy=options["lossy"], strict=options["strict"])
        diagnostics += exported.diagnostics
        found["text"] = exported.text
        found["points"] = measured(system, rulebase, deadline)
    found["diagnostics"] = [(d.name, d.message, str(d.severity), d.hint) for d in diagnostics]
    return found


def main() -> None:
    """Run ``gather.py SCRIPT ANSWER OPTIONS`` and end the process."""
    script, target, options = Path(sys.argv[1]), Path(sys.argv[2]), json.loads(sys.argv[3])

    def answer(data: dict[str, Any]) -> None:
        target.write_text(json.dumps(data), encoding="utf-8")
        os._exit(0)  # whatever threads the script has left behind

    if sys.version_info < (3, 11):  # noqa: UP036 - another Python may run this file
        answer({"refused": f"Python {sys.version.split()[0]} is too old; 3.11 is needed"})
    module = ModuleType("__main__")
    module.__dict__.update(__file__=str(script), __builtins__=builtins)
    sys.modules["__main__"] = module
    sys.argv = [str(script)]
    sys.path[0] = str(script.parent)
    sys.meta_path.insert(0, _Finder())
    interrupt = _Interrupt(options["seconds"], lambda: answer({"endless": True, "found": []}))
    ended_by = _run(script, module)
    interrupt.cancel()
    os.chdir(script.parent)
    data = {"raised": ended_by, "endless": interrupt.happened}
    if (ended_by or interrupt.happened) and not options["lossy"]:
        answer({**data, "found": []})  # what there is would not be used
    try:
        answer({**data, "found": _gathered(module, script.stem, options)})
    except BaseException as error:
        answer({**data, "found": [], "refused": f"{type(error).__name__}: {error}"[:500]})


if __name__ == "__main__":
    main()
