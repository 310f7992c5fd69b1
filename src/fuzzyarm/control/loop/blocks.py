"""Blocks of runs on any executor: their size, their order, and pickling.

Objects go to another process as bytes without addresses: a user's file as its text, a law of the
package by name, a controller as its text. The other machine needs nothing but fuzzyarm.
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
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)  # fmt: skip
from contextlib import contextmanager
from functools import cache, cached_property
from types import FunctionType
from typing import Any, TypeVar

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
from fuzzyarm.symbolic.kernels import processors

T = TypeVar("T")

Rows = NDArray[np.float64]
"""Results of runs, one in each row."""

Block = tuple[Rows, float]
"""The rows of a block, and its time, s."""

BLOCK_SECONDS = 1.0
"""Target time of a block, s: long beside its message, short enough to lose."""


# --- Workers ---


class Workers:
    """Workers for the pieces of a job: an executor, or own workers, started with the first piece.

    Any executor of :mod:`concurrent.futures` will do: of loky, Dask, mpi4py. Own workers are
    processes, or `threads`, as for machine code; closing ends them.
    """

    def __init__(
        self, count: int | None = None, executor: Executor | None = None, *, threads: bool = False
    ) -> None:
        self.count = count or getattr(executor, "_max_workers", None) or processors()
        self.executor = executor
        self.in_threads = threads and executor is None
        self._own: Executor | None = None

    def submit(self, work: Callable[..., T], *arguments: Any) -> Future[T]:
        """Submit a piece."""
        if self.executor is None and self._own is None:
            threads = self.in_threads
            self._own = ThreadPoolExecutor(self.count) if threads else _processes(self.count)
        pool = self.executor or self._own
        assert pool is not None
        with workers_watched():
            return pool.submit(work, *arguments)

    def close(self) -> None:
        """End own workers, processes with their work."""
        pool, self._own = self._own, None
        if pool is not None:
            _end(pool)

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


# --- Sizes and order ---


def in_order(
    submit: Callable[[int, int], Future[Block]], begin: int, end: int, workers: int
) -> Iterator[tuple[int, Rows]]:
    """Submit blocks of runs; yield their rows in the order of the runs.

    Parameters
    ----------
    submit : callable
        Called with the first run of a block and the one after its last.
    begin, end : int
        First run, and the one after the last.
    workers : int
        Blocks running at a time. Up to twice as many are submitted.

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
                # Smaller blocks near the end, so that all workers finish together.
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
    """Worker processes cannot be started, or have died."""


HERE = "--workers 1, or workers=1, runs in this process"


def _processes(workers: int) -> Executor:
    """Start processes on this machine, by loky if installed."""
    with _safe_path():
        pool: Executor
        try:
            from loky import ProcessPoolExecutor as Loky

            pool = Loky(workers, initializer=ignore_interrupt, env={_SAFE_PATH: "1"})
        except ImportError:
            from concurrent.futures import ProcessPoolExecutor
            from multiprocessing import get_context

            # A fork would copy the locks of threads, but not the threads: deadlock.
            pool = ProcessPoolExecutor(workers, get_context("spawn"), initializer=ignore_interrupt)
        try:
            pool.submit(os.getpid).result()
        except (BrokenExecutor, OSError) as error:
            _end(pool)
            raise WorkersError("no worker process can be started", hint=HERE) from error
    return pool


_SAFE_PATH = "PYTHONSAFEPATH"
"""Keeps the start folder off the module path: it may hold a ``control.py`` or ``signal.py`` of
the user."""


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
    """Turn the loss of a worker process into a `WorkersError`."""
    try:
        yield
    except BrokenExecutor as error:
        message = "a worker process has ended unexpectedly"
        raise WorkersError(message, hint=HERE) from error


def _end(pool: Executor) -> None:
    """End threads after their piece, processes at once."""
    if type(pool).__module__.startswith("loky"):
        pool.shutdown(wait=True, kill_workers=True)  # type: ignore[call-arg]
        return
    for process in list((getattr(pool, "_processes", None) or {}).values()):
        process.terminate()
    pool.shutdown(wait=True, cancel_futures=True)


def ignore_interrupt() -> None:
    """Ignore Ctrl-C in a worker: its parent ends it."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


# --- Pickled parts ---


class TravelError(FuzzyarmError, TypeError):
    """An object of an experiment cannot be pickled."""


def packed(thing: object) -> bytes:
    """Return the pickle of an object; TravelError if a part of it has none."""
    buffer = io.BytesIO()
    try:
        _pickler()(buffer, protocol=5).dump(thing)
    except (pickle.PicklingError, TypeError, AttributeError, ValueError) as error:
        hint = "workers=1 keeps it here"
        message = f"the experiment cannot go to another process: {error}"
        raise TravelError(message, hint=hint) from error
    return buffer.getvalue()


def unpacked(content: bytes) -> Any:
    """Unpickle an object."""
    return pickle.loads(content)


@cache
def _pickler() -> type[pickle.Pickler]:
    """Return the pickler; with cloudpickle, objects of an interactive session are picklable."""
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
    """Return a constructor and its arguments for an object that pickle cannot handle."""
    if isinstance(thing, TextLaw):
        return make_law, (thing.text, thing.find_law, thing.site)
    if isinstance(thing, Law):
        return _law_of, _name_of(thing)
    if isinstance(thing, Plant) and HOME in vars(thing):
        return _recipe_of_plant(thing)
    if type(thing) is CompiledController:  # without the arrays of its last run
        return _controller_of, (thing.law, dict(thing.gains), thing.name)
    # A function compiled from printed source has no module at all.
    if callable(thing) and (getattr(thing, "__module__", None) or "").startswith(OWN):
        return _recipe_of_own(thing)
    return _recipe_of_fields(thing)


def _recipe_of_fields(thing: Any) -> tuple[Any, ...] | None:
    """Return the reconstruction of an object without its cached properties."""
    kind: Any = type(thing)
    derived = _cached_names(kind)
    if not derived.intersection(getattr(thing, "__dict__", ())) or not _is_plain(kind):
        return None
    state = {name: value for name, value in vars(thing).items() if name not in derived}
    return copyreg.__newobj__, (kind,), state  # type: ignore[attr-defined]


@cache
def _cached_names(kind: Any) -> frozenset[str]:
    """Return the names of the cached properties of a class."""
    names = (name for base in kind.__mro__ for name in vars(base))
    return frozenset(n for n in names if isinstance(getattr(kind, n, None), cached_property))


def _is_plain(kind: type) -> bool:
    """Whether a class leaves pickling to the default protocol."""
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
    """Return the reconstruction of a class or function of a user's file."""
    name = getattr(thing, "__qualname__", "")
    module = sys.modules[thing.__module__]
    if not name or not hasattr(module, SOURCE):
        return None
    # A file loaded twice has two modules of the same name; a function knows its own.
    target: Any = thing.__globals__ if isinstance(thing, FunctionType) else vars(module)
    first, *rest = name.split(".")
    target = target.get(first)
    for part in rest:
        target = getattr(target, part, None)
    if target is not thing and isinstance(thing, type) and thing.__bases__[1:] == (Plant,):
        return plant_class, thing.__bases__[:1]
    if target is not thing and not _same_class(target, thing):
        return None  # local or decorated: not reachable by its name
    return _own_thing, (module.__file__, getattr(module, SOURCE), name)


def _same_class(value: Any, thing: Any) -> bool:
    """Whether two classes come from the same text; their module's name contains its hash."""
    both = isinstance(value, type) and isinstance(thing, type)
    return both and (value.__module__, value.__qualname__) == (thing.__module__, thing.__qualname__)


def _own_thing(path: str, source: str, name: str) -> Any:
    thing: Any = module_again(path, source)
    for part in name.split("."):
        thing = getattr(thing, part)
    return thing


def _recipe_of_plant(plant: Plant) -> tuple[Any, ...]:
    """Return the reconstruction of a user's plant: its text, then the changed attributes."""
    home: Home = vars(plant)[HOME]
    kind: Any = type(plant)
    excluded = {HOME, BEGUN, TRACED, *_cached_names(kind)}
    state = {
        name: value
        for name, value in vars(plant).items()
        if name not in excluded and (name not in home.begun or home.begun[name] is not value)
    }
    return plant_again, (home.path, home.source, home.key), state
