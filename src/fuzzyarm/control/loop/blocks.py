"""Blocks of runs on any executor: how large they are, in which order they come back, what travels.

What goes to another process is bytes, in which a user's file is its text, a law of the package is
its name and a controller as text is its text: there is no address in it, and nothing that the
other machine would have to have.
"""

from __future__ import annotations

import copyreg
import importlib
import io
import math
import os
import pickle
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import contextmanager
from functools import cache, cached_property
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.controllers.controller import CompiledController
from fuzzyarm.control.controllers.law import Law
from fuzzyarm.control.controllers.on_plant import TextLaw, make_law
from fuzzyarm.plant.equations import TRACED
from fuzzyarm.plant.own import BEGUN, OWN, SOURCE, module_again, plant_again, plant_class
from fuzzyarm.plant.plain_python import HOME, Home
from fuzzyarm.plant.plant import Plant

Rows = NDArray[np.float64]
"""What came of some runs, one in each row."""

Block = tuple[Rows, float]
"""The rows of a block, and how long it took, s."""

BLOCK_SECONDS = 1.0
"""How long a block should take: its message costs nothing beside it, and little is lost with it."""


# --- Sizes and order ---


def in_order(
    submit: Callable[[int, int], Future[Block]], begin: int, end: int, workers: int
) -> Iterator[tuple[int, Rows]]:
    """Submit blocks of runs; yield their rows in the order of the runs.

    Parameters
    ----------
    submit : callable
        Takes the first run of a block and the one behind its last.
    begin, end : int
        First run, and the one behind the last.
    workers : int
        How many blocks run at a time. Twice as many wait or run.

    Yields
    ------
    int
        First run of a block.
    ndarray
        Its rows.
    """
    under_way: dict[Future[Block], int] = {}
    blocks: dict[int, Rows] = {}
    delivered = submitted = begin
    size = 1
    try:
        while delivered < end:
            while submitted < end and len(under_way) < 2 * workers:
                # At the end small ones, so that all workers finish together.
                share = math.ceil((end - submitted) / (2 * workers))
                last = submitted + max(1, min(size, share))
                under_way[submit(submitted, last)] = submitted
                submitted = last
            for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                first = under_way.pop(future)
                with workers_watched():
                    rows, seconds = future.result()
                blocks[first] = rows
                if seconds > 0.0:
                    size = max(1, round(BLOCK_SECONDS * len(rows) / seconds))
            while delivered in blocks:
                rows = blocks.pop(delivered)
                yield delivered, rows
                delivered += len(rows)
    finally:
        for future in under_way:
            future.cancel()


class WorkersError(FuzzyarmError, RuntimeError):
    """Worker processes cannot be started, or have gone."""


HERE = "--workers 1, or workers=1, runs in this process"


def default_processes(workers: int) -> Executor:
    """Start processes of this machine: loky's where it is installed."""
    with _safe_path():
        pool = _processes(workers)
        try:
            pool.submit(os.getpid).result()
        except (BrokenExecutor, OSError) as error:
            end_processes(pool)
            raise WorkersError("no worker process can be started", hint=HERE) from error
    return pool


def _processes(workers: int) -> Executor:
    try:
        from loky import ProcessPoolExecutor as Loky
    except ImportError:
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        # A fork would copy locks of threads that it does not copy.
        return ProcessPoolExecutor(workers, get_context("spawn"), initializer=deaf)
    executor: Executor = Loky(workers, initializer=deaf, env={_SAFE_PATH: "1"})
    return executor


_SAFE_PATH = "PYTHONSAFEPATH"
"""With it a process does not look for modules in the folder that it is started in: there may be a
``control.py`` or a ``signal.py`` of the user's."""


@contextmanager
def _safe_path() -> Iterator[None]:
    before = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[_SAFE_PATH]
        else:
            os.environ[_SAFE_PATH] = before


@contextmanager
def workers_watched() -> Iterator[None]:
    """Make one clear sentence of it where a worker process has gone."""
    try:
        yield
    except BrokenExecutor as error:
        message = "a worker process has ended unexpectedly"
        raise WorkersError(message, hint=HERE) from error


def end_processes(pool: Executor) -> None:
    """End processes of :func:`default_processes`, with what they are at."""
    if type(pool).__module__.startswith("loky"):
        pool.shutdown(wait=True, kill_workers=True)  # type: ignore[call-arg]
        return
    for process in list((getattr(pool, "_processes", None) or {}).values()):
        process.terminate()
    pool.shutdown(wait=True, cancel_futures=True)


def deaf() -> None:
    """Ignore Ctrl-C in a worker: who started it ends it."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


# --- What travels ---


class TravelError(FuzzyarmError, TypeError):
    """Something of an experiment cannot go to another process."""


def packed(thing: object) -> bytes:
    """Return the bytes of a thing; TravelError if something in it has none."""
    buffer = io.BytesIO()
    try:
        _pickler()(buffer, protocol=5).dump(thing)
    except (pickle.PicklingError, TypeError, AttributeError, ValueError) as error:
        hint = "workers=1 keeps it here"
        message = f"the experiment cannot go to another process: {error}"
        raise TravelError(message, hint=hint) from error
    return buffer.getvalue()


def unpacked(content: bytes) -> Any:
    """Return the thing of which these are the bytes."""
    return pickle.loads(content)


@cache
def _pickler() -> type[pickle.Pickler]:
    """Return the pickler; what a session defined travels where cloudpickle is installed."""
    base: Any = pickle.Pickler
    try:
        import cloudpickle

        base = cloudpickle.Pickler
    except ImportError:
        pass

    class Packer(base):  # type: ignore[misc]
        def reducer_override(self, thing: Any) -> Any:
            reduction = recipe(thing)
            if reduction is not None:
                return reduction
            above = getattr(super(), "reducer_override", None)
            return above(thing) if above is not None else NotImplemented

    return Packer


def recipe(thing: Any) -> tuple[Any, ...] | None:
    """Return how another process makes a thing again, where pickle does not know it."""
    if isinstance(thing, TextLaw):
        return make_law, (thing.text, thing.find_law, thing.site)
    if isinstance(thing, Law):
        return _law_of, _name_of(thing)
    if isinstance(thing, Plant) and HOME in vars(thing):
        return _recipe_of_plant(thing)
    if type(thing) is CompiledController:  # without the arrays of its last run
        return _controller_of, (thing.law, dict(thing.gains), thing.name)
    # A function that was printed has no module at all.
    if callable(thing) and (getattr(thing, "__module__", None) or "").startswith(OWN):
        return _recipe_of_own(thing)
    return _recipe_of_fields(thing)


def _recipe_of_fields(thing: Any) -> tuple[Any, ...] | None:
    """Return how a thing with cached properties is made again: without what they have cached.

    That may be anything, such as a compiled function, and is computed again where it is needed.
    """
    kind: Any = type(thing)
    derived = _cached_names(kind)
    if not derived.intersection(getattr(thing, "__dict__", ())) or not _is_plain(kind):
        return None
    state = {name: value for name, value in vars(thing).items() if name not in derived}
    return copyreg.__newobj__, (kind,), state  # type: ignore[attr-defined]


@cache
def _cached_names(kind: Any) -> frozenset[str]:
    """Return the cached properties of a class."""
    names = (name for base in kind.__mro__ for name in vars(base))
    return frozenset(n for n in names if isinstance(getattr(kind, n, None), cached_property))


def _is_plain(kind: type) -> bool:
    """Whether a class leaves it to pickle how its things are taken apart."""
    ways = ("__reduce_ex__", "__reduce__", "__getstate__", "__setstate__", "__getnewargs_ex__")
    return all(getattr(kind, way, None) is getattr(object, way, None) for way in ways)


def _name_of(law: Law) -> tuple[str, str]:
    home = law.kernel.__module__
    for name, value in vars(sys.modules[home]).items():
        if value is law:
            return home, name
    raise pickle.PicklingError(f"law '{law.name}' has no name in {home}")


def _law_of(home: str, name: str) -> Any:
    return getattr(importlib.import_module(home), name)


def _controller_of(law: Law, gains: Any, name: str) -> CompiledController:
    controller = CompiledController(law, gains)
    controller.name = name
    return controller


def _recipe_of_own(thing: Any) -> tuple[Any, ...] | None:
    """Return how a class or function of a user's file is made again."""
    name = getattr(thing, "__qualname__", "")
    module = sys.modules[thing.__module__]
    if not name or not hasattr(module, SOURCE):
        return None
    # A file that was loaded twice has two of each; a function knows its own.
    target: Any = thing.__globals__ if isinstance(thing, FunctionType) else vars(module)
    first, *rest = name.split(".")
    target = target.get(first)
    for part in rest:
        target = getattr(target, part, None)
    if target is not thing and isinstance(thing, type) and thing.__bases__[1:] == (Plant,):
        return plant_class, thing.__bases__[:1]
    if target is not thing and not _same_class(target, thing):
        return None  # made in a function, or under a decorator: its name does not lead to it
    return _own_thing, (module.__file__, getattr(module, SOURCE), name)


def _same_class(value: Any, thing: Any) -> bool:
    """Whether two classes come from the same text; the name of their module says so."""
    both = isinstance(value, type) and isinstance(thing, type)
    return both and (value.__module__, value.__qualname__) == (thing.__module__, thing.__qualname__)


def _own_thing(path: str, source: str, name: str) -> Any:
    thing: Any = module_again(path, source)
    for part in name.split("."):
        thing = getattr(thing, part)
    return thing


def _recipe_of_plant(plant: Plant) -> tuple[Any, ...]:
    """Return how a plant of a user's file is made again: from its text, then what was changed.

    So whatever the class keeps for itself, a function or a lock, need not travel.
    """
    home: Home = vars(plant)[HOME]
    kind: Any = type(plant)
    excluded = {HOME, BEGUN, TRACED, *_cached_names(kind)}
    state = {
        name: value
        for name, value in vars(plant).items()
        if name not in excluded and (name not in home.begun or home.begun[name] is not value)
    }
    return plant_again, (home.path, home.source, home.key), state
