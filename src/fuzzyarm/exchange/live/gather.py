"""Run a script in a separate process and gather the fuzzy systems that it makes.

This file is started by its path (see :mod:`fuzzyarm.exchange.live`), maybe by another Python than
the one that has fuzzyarm: the script may need libraries that do not go with ours. Until the script
has ended nothing but the standard library is loaded; then the package beside this file is, which
takes no array library to read live objects. What was found goes into a file as JSON.
"""

from __future__ import annotations

import ast
import builtins
import importlib.abc
import importlib.machinery
import importlib.util
import inspect
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
"""Seconds between the interrupt of a script that does not end and the end of its process, at most;
a script that is given less than that waits no longer than it was given."""

LOADING = 30.0
"""Seconds for the libraries of a script, which do not count as its own, at most."""

GLANCE = 0.1
"""Seconds from one look at what the script does to the next."""

MOST_MADE = 1000
"""Systems that are kept alive though the script has dropped them."""

MEASURING = 40.0
"""Seconds for the numbers of all systems."""

DEEPEST = 3
"""How deep in objects of the script systems are looked for."""

CALL = "_fuzzyarm_call"
"""Attribute of a system whose settings are the arguments of its evaluation: the last of them, or
the first that tells the order of the arguments of its functions."""


def _beside(name: str) -> Any:
    """Load a module of this folder without its package."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


# --- What happens at imports ---


class _Made(NamedTuple):
    """A system and the frame that made it, whose variables are still to come."""

    system: Any
    frame: FrameType


_creations: list[_Made] = []
_computed: set[int] = set()  # systems that have computed something: they are complete


def _keep(**classes: str) -> Callable[[ModuleType], None]:
    """Return what makes some classes of a module remember their objects.

    The word of a class is its method that computes, empty where an object is complete as soon as
    it is made.
    """

    def change(module: ModuleType) -> None:
        for name, method in classes.items():
            kind = getattr(module, name, None)
            if kind is not None:
                _remember(kind, method)

    return change


def _remember(kind: Any, method: str) -> None:
    make, home = kind.__init__, _top_module(kind.__module__)

    def init(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        frame: FrameType | None = sys._getframe(1)
        while frame is not None and _top_module(frame.f_globals.get("__name__")) == home:
            frame = frame.f_back  # the library itself: whoever has called it
        if frame is not None and len(_creations) < MOST_MADE:
            _creations.append(_Made(self, frame))
        if not method:
            _computed.add(id(self))
        elif method in vars(self):  # bound to the object by its constructor
            vars(self)[method] = _noted(vars(self)[method], self)

    init.__doc__ = make.__doc__
    kind.__init__ = init
    if method and hasattr(kind, method):
        setattr(kind, method, _noting(getattr(kind, method)))


def _noting(compute: Callable[..., Any]) -> Callable[..., Any]:
    """Return a method that notes that its object has computed, and with which arguments."""

    def method(self: Any, *arguments: Any, **options: Any) -> Any:
        result = compute(self, *arguments, **options)
        _computed.add(id(self))
        if not _tells_order(*vars(self).get(CALL, ((), {}))):
            vars(self)[CALL] = (arguments, options)
        return result

    method.__doc__ = compute.__doc__
    return method


def _tells_order(arguments: tuple[Any, ...], options: dict[str, Any]) -> bool:
    """Whether arguments of an evaluation tell which input each argument of functions is."""
    inputs, params, *_ = (*arguments, None, None)
    inputs, params = options.get("inputs", inputs), options.get("params", params)
    if not isinstance(inputs, dict) or not isinstance(params, (tuple, list)):
        return False  # the settings of another class: the last of them count
    try:
        return len(set(map(float, inputs.values()))) == len(inputs)
    except (TypeError, ValueError):
        return False


def _noted(compute: Callable[..., Any], system: Any) -> Callable[..., Any]:
    def function(*arguments: Any, **options: Any) -> Any:
        result = compute(*arguments, **options)
        _computed.add(id(system))
        return result

    return function


def _top_module(name: object) -> str:
    return str(name).partition(".")[0]


def _no_windows(matplotlib: Any) -> None:
    """Let a figure have no window, whatever the script asks for."""
    matplotlib.rcParams["backend"] = "Agg"
    matplotlib.use = lambda *_, **__: None


def _old_names(numpy: Any) -> None:
    """Give NumPy the names back that it has dropped."""
    sys.modules["stand_ins"].old_names(numpy)


def _no_files(figures: Any) -> None:
    """Let a figure be saved nowhere: what the script shows is dropped."""
    figures.Figure.savefig = lambda *_, **__: None


def _no_views(pictures: Any) -> None:
    """Let rules and systems be shown nowhere: some releases of scikit-fuzzy fail at it."""
    stand_in = sys.modules["stand_ins"].StandIn("view()")
    for name in ("view", "view_n"):
        setattr(pictures.ControlSystemVisualizer, name, lambda *_: (stand_in, stand_in))


_AFTER_IMPORT: dict[str, Callable[[ModuleType], None]] = {
    "numpy": _old_names,
    "matplotlib": _no_windows,
    "matplotlib.figure": _no_files,
    "skfuzzy.control.visualization": _no_views,
    "skfuzzy.control.controlsystem": _keep(ControlSystem="", ControlSystemSimulation=""),
    "fuzzylite.engine": _keep(Engine="process"),
    "simpful.simpful": _keep(FuzzySystem="inference"),
    "fuzzylogic.classes": _keep(Rule=""),
    "pyit2fls.pyit2fls": _keep(
        IT2Mamdani="evaluate",
        IT2TSK="evaluate",
        IT2FLS="evaluate",
        T1Mamdani="evaluate",
        T1TSK="evaluate",
    ),
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
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        loader = spec.loader if spec is not None else None
        if spec is None or loader is None:
            return None
        load = loader.exec_module

        def load_and_change(module: ModuleType) -> None:
            load(module)
            try:
                change(module)
            except Exception:  # another release: its objects are found by their names only
                traceback.print_exc()

        loader.exec_module = load_and_change  # type: ignore[method-assign]
        return spec


# --- The script ---


class _Interrupt:
    """Interrupts the script after `seconds`; if that does not help, holds it and calls `end`.

    The time begins when the script has loaded its libraries: on a busy machine they alone may
    take it, and an interrupt among them leaves nothing to gather.
    """

    def __init__(self, seconds: float, end: Callable[[], None]) -> None:
        self.happened = False
        self._end = end
        self._seconds = seconds
        self._deadline = time.monotonic() + seconds
        self._loading_ends = time.monotonic() + LOADING
        self._over = False
        # A process started in the background of a shell ignores interrupts.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        self._released = threading.Event()
        if hasattr(signal, "pthread_kill"):
            signal.signal(signal.SIGUSR1, self._hold)
        self._watch()

    def _later(self, seconds: float, act: Callable[[], None]) -> None:
        self._timer = threading.Timer(seconds, act)
        self._timer.daemon = True
        self._timer.start()

    def _watch(self) -> None:
        now = time.monotonic()
        if _is_importing() and now < self._loading_ends:
            self._deadline = now + self._seconds
        if now < self._deadline:
            self._later(min(GLANCE, self._deadline - now), self._watch)
        elif not self._over:
            self._interrupt()

    def _interrupt(self) -> None:
        import _thread

        self.happened = True
        self._later(min(GRACE, self._seconds), self._take_over)
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
        else:
            _thread.interrupt_main()

    def _take_over(self) -> None:
        if self._over:
            return
        # The numbers of a system are false while the script computes with it in another thread.
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGUSR1)
            self._released.wait(1.0)
        self._end()

    def _hold(self, *_: object) -> None:
        self._released.set()
        while True:
            time.sleep(GRACE)

    def cancel(self) -> None:
        """Let the process go on."""
        self._over = True
        self._timer.cancel()


def _is_importing() -> bool:
    """Whether the script is within an import."""
    frame = sys._current_frames().get(threading.main_thread().ident or 0)
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _run(script: Path, module: ModuleType, call: str | None) -> dict[str, Any] | None:
    """Run a script as Python would, and call what was asked for; return what ended it early."""
    ended = _ending(lambda: exec(_code(script), module.__dict__), str(script))
    if call is None or (ended and ended["kind"] == "SyntaxError"):
        return ended
    outcome = _ending(lambda: _called(call, module), str(script))
    return {**outcome, "called": call} if outcome else ended


def _code(script: Path) -> Any:
    return sys.modules["stand_ins"].compiled(script.read_bytes(), str(script))


def _ending(act: Callable[[], None], script: str) -> dict[str, Any] | None:
    """Return what ended an act early, if anything did."""
    try:
        act()
    except SystemExit as error:
        if error.code in (None, 0):
            return None
        return {**_as_data(error, script), "kind": "SystemExit"}
    except BaseException as error:
        return _as_data(error, script)
    return None


def _called(call: str, module: ModuleType) -> None:
    """Call a function or a class of the script, and keep what it gives by its name.

    What asks for arguments gets ones, unless they stand in parentheses.
    """
    names = vars(module)
    if "(" in call:
        label = call.partition("(")[0].rpartition(".")[2]
        names[label] = eval(call, names)
        return
    head, *others = call.split(".")
    if head not in names:
        raise NameError(f"the script has no '{head}'")
    value, label = names[head], head
    for name in others:
        if isinstance(value, type):
            value = _with_ones(value)
            names[f"{label}_object"] = value
        value, label = getattr(value, name), name
    result = _with_ones(value)
    if result is not None:
        names[label] = result


def _with_ones(function: Any) -> Any:
    """Call a function with 1 for each argument that it demands."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return function()
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    demanded = [p for p in parameters if p.default is inspect.Parameter.empty]
    keywords = {p.name: 1 for p in demanded if p.kind is inspect.Parameter.KEYWORD_ONLY}
    return function(*[1 for p in demanded if p.kind in positional], **keywords)


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
    own_modules = _own_modules(module)
    visited: set[int] = set()
    variables = {n: v for n, v in vars(module).items() if not n.startswith("__")}
    yield from _in_scope(variables, own_modules, visited)
    for creation in reversed(_creations):
        if creation.frame.f_locals is not vars(module):
            yield from _in_scope(dict(creation.frame.f_locals), own_modules, visited)


def _own_modules(module: ModuleType) -> frozenset[str]:
    """Return the names of the modules that stand in the folder of the script."""
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
    """Return what a value contains, by names: of a container, or of an object of the script."""
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
    """Return the systems by name, each once, however many names it has, and those left out.

    What has no name at all counts where nothing has one. With `whole` only those count that have
    computed something, which are complete.
    """
    systems: dict[int, tuple[str, Any]] = {}
    simulations: dict[int, tuple[str, Any]] = {}
    left_out: dict[int, str] = {}
    candidates = [(n, v) for n, v in _named(module) if not isinstance(v, type) and is_system(v)]
    for name, value in candidates or [(stem, creation.system) for creation in _creations]:
        system = getattr(value, "ctrl", value)
        if whole and id(value) not in _computed and id(system) not in _computed:
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
    """Give every system a name that can be that of a file, also where case does not count."""
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


# --- The answer ---


def _load_fuzzyarm() -> None:
    """Load the package beside this file, and nothing else from its folder."""
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
    deadline = time.monotonic() + MEASURING
    records = [_as_found(name, system, options, deadline) for name, system in systems.items()]
    return {"found": records, "left_out": left_out}


def _name_sets(module: ModuleType) -> None:
    """Tell sets that have no name of their own what the script calls them."""
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


def _told_by_text(script: Path) -> dict[str, Any]:
    """Return what a script would build if it were called, and whether it computes by hand."""
    try:
        tree = ast.parse(script.read_bytes())
    except (SyntaxError, ValueError, RecursionError):
        return {"builders": [], "by_hand": False}
    module = _beside("builders")
    calls = [builder.call for builder in module.builders(tree)]
    return {"builders": calls, "by_hand": module.is_by_hand(tree)}


HARMLESS = ("EOFError", "SystemExit", "KeyboardInterrupt")
"""What ends a script that has done what it could: no answer, no time."""


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
    stand_ins = _beside("stand_ins")
    answers = stand_ins.prepare(str(script.parent))
    sys.meta_path.insert(0, _Finder())
    record_of_text = _told_by_text(script)

    def finish(ended_by: dict[str, Any] | None, *, endless: bool) -> None:
        os.chdir(script.parent)
        data = {
            "raised": None if endless else ended_by,
            "endless": endless,
            "stand_ins": sorted(set(stand_ins.used)),
            "answers": answers.count,
            **record_of_text,
        }
        failed = not endless and ended_by is not None and ended_by["kind"] not in HARMLESS
        try:
            whole = failed and not options["lossy"]
            answer({**data, **_gathered(module, script.stem, options, whole=whole)})
        except BaseException as error:
            answer({**data, "found": [], "refused": f"{type(error).__name__}: {error}"[:500]})

    # A script that catches every interrupt is held while its systems are gathered.
    interrupt = _Interrupt(options["seconds"], lambda: finish(None, endless=True))
    ended_by = _run(script, module, options.get("call"))
    interrupt.cancel()
    finish(ended_by, endless=interrupt.happened)


if __name__ == "__main__":
    main()
