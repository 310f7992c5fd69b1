"""Kernels: plain functions that run interpreted or as machine code.

A function marked with :func:`kernel` uses scalars, tuples, named tuples and its array arguments
(it allocates none, and never indexes from the end), and calls only :mod:`math` and other kernels
by their bare names. It runs as plain Python, line by line, for a debugger; or as machine code,
printed from its source (:mod:`fuzzyarm.symbolic.translation`) and compiled when fuzzyarm is
built. Both give the same bits: the compiled code neither reorders nor fuses floating-point
operations.

- :func:`address_of` gives an address, under which another kernel may :func:`call` it. So a
  function to be applied to rows (a norm, a shape, a control law) is one number in the data.
- :func:`routine` makes a Python function of a kernel with array arguments.
- :func:`with_names` runs a kernel as plain Python with other functions under some of its names.

Nothing is compiled at run time. Functions unknown when fuzzyarm is built (a user's formulas and
kinds, the equations of a user's plant) are programs of operations
(:mod:`fuzzyarm.symbolic.programs`), which have addresses, too.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import math
import os
import sys
import warnings
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping
from threading import RLock
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any, TypeVar, cast, get_type_hints
from weakref import WeakSet

from fuzzyarm.base.errors import FuzzyarmError

if TYPE_CHECKING:
    from pathlib import Path

SWITCH = "FUZZYARM_NATIVE"
"""Environment variable: ``0`` runs every kernel interpreted, ``baseline`` avoids instructions of
newer processors."""

_MARK = "__fuzzyarm_kernel__"
_Function = TypeVar("_Function", bound=Callable[..., Any])
_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_Bindings = Mapping[str, Callable[..., Any]]


class NotBuiltError(FuzzyarmError, LookupError):
    """A kernel is missing from the machine code.

    Attributes
    ----------
    key : str
        Key of the kernel, see :func:`key_of`.
    """

    def __init__(self, key: str) -> None:
        self.key = key
        super().__init__(f"the machine code of fuzzyarm does not have {key}: build it anew")


def kernel(function: _Function) -> _Function:
    """Mark `function` as a kernel; it stays plain Python."""
    setattr(function, _MARK, True)
    return function


def is_kernel(function: object) -> bool:
    """Whether a function is marked as a kernel."""
    return hasattr(function, _MARK)


def whole_numbers(numbers: Any) -> Any:
    """Return an array of floats reinterpreted as 64-bit integers; for kernels and their blocks."""
    if isinstance(numbers, memoryview):
        return numbers.cast("B").cast("q")
    import numpy as np

    return numbers.view(np.int64)


def short(number: float) -> int:
    """Truncate a number, to 32 bits in machine code; for kernels."""
    return int(number)


# --- The machine code ---


def has_machine_code() -> bool:
    """Whether kernels run as machine code: built, and not disabled by the environment."""
    return _switch() not in _OFF and _module() is not None


_OFF = {"0", "false", "no", "off"}


def _switch() -> str:
    return os.environ.get(SWITCH, "1").strip().lower()


@functools.cache
def _module() -> ModuleType | None:
    """Load the compiled module; None if none fits, with one warning."""
    try:
        module = importlib.import_module("fuzzyarm._kernels")
    except ImportError:
        _warn("no machine code was built")
        return None
    if _is_checkout() and digest_of_c() != module.SOURCES:
        _warn("the machine code is of other sources; `make native` builds it anew")
        return None
    return module


def _warn(reason: str) -> None:
    message = f"{reason}: fuzzyarm runs as plain Python, with the same numbers but slowly"
    warnings.warn(message, RuntimeWarning, stacklevel=4)


def _is_checkout() -> bool:
    """Whether the sources may have been edited since the machine code was built."""
    return (_here().parents[1] / "pyproject.toml").is_file()


def _here() -> Path:
    from pathlib import Path

    return Path(__file__).resolve().parents[1]


SOURCE_FOLDERS = (
    "symbolic", "symbolic/translation", "inference", "table", "plant", "control/controllers",
    "control/loop", "apps/native",
)  # fmt: skip
"""Packages with kernels, or whose modules determine how kernels are printed."""


def digest_of_c() -> str:
    """Return a digest of the C printed from the present sources.

    After an edit it is printed once, by another process, and noted beside the package.
    """
    if noted := _noted_digest():
        return noted
    import subprocess

    command = [sys.executable, "-P", str(_here() / "apps" / "native" / "build.py"), "--note"]
    path = os.pathsep.join([str(_here().parent), *filter(None, sys.path)])
    environment = {**os.environ, "PYTHONPATH": path, SWITCH: "0"}
    subprocess.run(command, env=environment, capture_output=True, check=False)
    return _noted_digest()


def _noted_digest() -> str:
    try:
        sources, digest = _note().read_text(encoding="ascii").split()
    except (OSError, ValueError):
        return ""
    return digest if sources == digest_of_sources() else ""


def note_digest(digest: str) -> None:
    """Note the digest of the C printed from the present sources."""
    unfinished = _note().with_name(f".{_note().name}.{os.getpid()}")
    with contextlib.suppress(OSError):  # in a read-only package it is printed anew
        unfinished.write_text(f"{digest_of_sources()} {digest}\n", encoding="ascii")
        unfinished.replace(_note())


def _note() -> Path:
    return _here() / "_kernels.digest"


def digest_of_sources() -> str:
    """Return a digest of all sources that determine the C of the kernels."""
    from hashlib import sha256

    here = _here()
    whole = sha256()
    for folder in SOURCE_FOLDERS:
        for path in sorted((here / folder).glob("*.[pc]*")):
            if path.suffix in {".py", ".c"}:
                whole.update(path.read_bytes())
    return whole.hexdigest()


@functools.cache
def _addresses_of_keys() -> dict[str, int]:
    module: Any = _module()
    best = module.levels()
    level = _switch()
    return cast("dict[str, int]", module.addresses(level if level in best else best[0]))


def key_of(function: Callable[..., Any], types: str, bindings: _Bindings) -> str:
    """Return the key of a kernel in the machine code: name, types and bindings."""
    printed = _printed_key(function, types)
    if printed:
        return printed
    names = [_name(function), *(f"{name}={_name(bindings[name])}" for name in sorted(bindings))]
    return f"{names[0]}({', '.join([types, *names[1:]])})"


def _printed_key(function: Callable[..., Any], types: str) -> str:
    """Return the key of a function printed from an expression; empty for others."""
    digest = getattr(function, "__digest__", "")
    return f"{function.__name__}({types}) {digest}" if digest else ""


def _name(function: Callable[..., Any]) -> str:
    return f"{function.__module__}.{function.__qualname__}"


# --- Functions by address: arrays in, arrays out ---

_by_address: list[Callable[..., None]] = []
"""Functions called by address in interpreted kernels: -1 is the first, -2 the second …"""

_locks: WeakSet[Any] = WeakSet()
"""All locks made by :func:`lock`."""


def lock() -> Any:
    """Return a reentrant lock that is free again in a forked child, whichever thread held it."""
    made = RLock()
    _locks.add(made)
    return made


_addressing = lock()

_addresses: dict[tuple[Any, ...], tuple[int, Any]] = {}
"""By function, bindings and mode (compiled or not): the address, and an object to keep alive."""


def call(address: int, *arrays: Any) -> None:
    """Call the function at an address with some arrays; inside kernels only.

    Parameters
    ----------
    address : int
        From :func:`address_of`, for the same mode (machine code or not).
    *arrays : ndarray of float64 or int64
        Contiguous, one axis each; of the types declared to :func:`address_of`.
    """
    _by_address[-1 - address](*arrays)


def address_of(
    function: Callable[..., None],
    arrays: int | str,
    bindings: _Bindings | None = None,
    *,
    compiled: bool,
) -> int:
    """Return an address under which kernels may :func:`call` a function.

    Parameters
    ----------
    function : callable
        A kernel, or a function printed from an expression, with its text in ``__source__`` and a
        maker of its program of operations in ``__program__``.
    arrays : int or str
        Number of float64 arrays, or a letter for each array: ``f`` for float64, ``i`` for int64,
        ``s`` for int32.
    bindings : mapping of str to callable, optional
        Functions bound to these names in the kernel and in all kernels that it calls.
    compiled : bool
        For calls from machine code, or from plain Python.

    Returns
    -------
    int
        Valid for the life of the process.

    Raises
    ------
    NotBuiltError
        If `compiled`, and the machine code lacks it.
    """
    bindings = bindings or {}
    letters = letters_of(arrays)
    # A printed function may be printed again as a new object: its key is its text.
    who = _printed_key(function, letters) or function
    key = (who, letters, tuple(sorted(bindings.items(), key=lambda pair: pair[0])), compiled)
    if key not in _addresses:
        with _addressing:  # a second program would free the first one in use
            if key not in _addresses:
                _addresses[key] = _address(function, letters, bindings, compiled=compiled)
    return _addresses[key][0]


def _address(
    function: Callable[..., None], letters: str, bindings: _Bindings, *, compiled: bool
) -> tuple[int, Any]:
    if compiled:
        return _machine_address(function, letters, bindings)
    _by_address.append(_without_errors(with_names(function, bindings)))
    return -len(_by_address), None


def _without_errors(function: Callable[..., None]) -> Callable[..., None]:
    """Return a printed function with NaN or an infinity where Python raises."""
    quiet = getattr(function, "__quiet__", None)
    if quiet is None:
        return function

    def fill(*arrays: Any) -> None:
        try:
            function(*arrays)
        except (ArithmeticError, ValueError):
            quiet(*arrays)

    return fill


def is_built(function: Callable[..., None], arrays: int | str, bindings: _Bindings) -> bool:
    """Whether the machine code has a function; see :func:`address_of`."""
    return _module() is not None and (
        key_of(function, letters_of(arrays), bindings) in _addresses_of_keys()
    )


def letters_of(arrays: int | str) -> str:
    """Return a letter for each array."""
    return "f" * arrays if isinstance(arrays, int) else arrays


def letters_of_parts(block: type[tuple[Any, ...]]) -> str:
    """Return a letter for each array of a named tuple, from its annotations."""
    letters = {list[float]: "f", list[int]: "i"}
    return "".join(letters[kind] for kind in get_type_hints(block).values())


def _machine_address(
    function: Callable[..., None], types: str, bindings: _Bindings
) -> tuple[int, Any]:
    if _module() is None:
        raise NotBuiltError(key_of(function, types, bindings))
    key = key_of(function, types, bindings)
    address = _addresses_of_keys().get(key)
    if address is not None:
        return address, None
    if hasattr(function, "__address__"):  # compiled by another library
        return function.__address__, function
    if not hasattr(function, "__program__"):
        raise NotBuiltError(key)
    program: array[float] = function.__program__()
    # Floats have even addresses; an odd one marks a program of operations.
    return program.buffer_info()[0] + 1, program


def routine(
    function: Callable[..., None],
    arrays: int | str,
    bindings: _Bindings | None = None,
    *,
    compiled: bool,
) -> Callable[..., None]:
    """Return a Python function for a kernel over arrays; machine code releases the GIL.

    Parameters
    ----------
    function, arrays, bindings, compiled
        See :func:`address_of`.

    Returns
    -------
    callable
        Takes the arrays (contiguous); interpreted, any indexable buffers.
    """
    if not compiled:
        return with_names(function, bindings or {})
    module: Any = _module()
    address = address_of(function, arrays, bindings, compiled=True)
    return cast(Callable[..., None], module.routine(address, letters_of(arrays)))


def bound_routine(
    function: Callable[..., None],
    types: str,
    arrays: tuple[Any, ...],
    bindings: _Bindings | None = None,
    *,
    brief: bool = False,
) -> Callable[[], None]:
    """Return a call of machine code on fixed arrays, which it keeps alive.

    Parameters
    ----------
    function, types, bindings
        See :func:`address_of`.
    arrays : tuple of ndarray
        Contiguous.
    brief : bool
        Whether it takes less time than releasing and reacquiring the GIL.
    """
    module: Any = _module()
    address = address_of(function, types, bindings, compiled=True)
    return cast(Callable[[], None], module.bind(address, types, arrays, brief))


def point_functions(
    function: Callable[..., None],
    bindings: _Bindings,
    block: Any,
    inputs: tuple[int, tuple[str, ...]],
    outputs: tuple[int, tuple[str, ...]],
    at_otherwise: Callable[..., tuple[float, ...]],
    call_otherwise: Callable[..., Any],
) -> tuple[Callable[..., Any], ...]:
    """Return the evaluators of one point as machine code.

    Parameters
    ----------
    function, bindings
        A kernel of one block, see :func:`address_of`.
    block : ndarray of float64
        Its numbers, shared by all threads.
    inputs, outputs : tuple
        Index of the first one in the block, and their names.
    at_otherwise, call_otherwise : callable
        What `at` and `call` give way to at a point that is not ordinary.

    Returns
    -------
    tuple of callable
        See :class:`fuzzyarm.inference.stage.PointFunctions`.

    Raises
    ------
    ValueError
        If there are too many inputs for its buffer.
    """
    module: Any = _module()
    address = address_of(function, 1, bindings, compiled=True)
    functions: tuple[Callable[..., Any], ...] = module.point(
        address, block, *inputs, *outputs, at_otherwise, call_otherwise
    )
    return functions


def sweep_routine(
    function: Callable[..., None],
    block: Any,
    shape: tuple[int, int],
    inputs: tuple[int, int],
    outputs: tuple[int, int],
    counts: tuple[int, int],
) -> Callable[[tuple[Any, ...], int, int], int]:
    """Return an evaluator of arrays of points as machine code, chunk by chunk.

    Parameters
    ----------
    function : kernel
        A kernel of one block.
    block : ndarray of float64
        With room for a chunk of points.
    shape : tuple of int
        Points per chunk, and the stride between rows of the block.
    inputs, outputs : tuple of int
        Their number, and the index of their first row in the block.
    counts : tuple of int
        Indices in the block, as integers, of the number of points and of the number of undefined
        outputs.

    Returns
    -------
    callable
        Takes the arrays (contiguous, float64; the inputs, then the outputs), the first index and
        the one after the last; returns the number of undefined outputs. Not reentrant: there is
        one block.
    """
    module: Any = _module()
    address = address_of(function, 1, compiled=True)
    sweeper = module.sweeper(address, block, shape, inputs, outputs, counts)
    return cast(Callable[[tuple[Any, ...], int, int], int], sweeper)


# --- Several processors ---


@functools.cache
def processors() -> int:
    """Return the number of processors available to this process.

    Its affinity, limited by the quota of a container.
    """
    try:
        count = len(os.sched_getaffinity(0))
    except AttributeError:  # not on macOS and Windows
        count = os.cpu_count() or 1
    quota = _quota()
    return max(1, math.ceil(quota)) if quota < count else count


def _quota() -> float:
    """Return the processor quota of a Linux control group; infinite without a limit."""
    for limit, period in _QUOTA_FILES:
        try:
            with open(limit, encoding="ascii") as file:
                words = file.read().split()
            if period:
                with open(period, encoding="ascii") as file:
                    words += file.read().split()
            granted, of = float(words[0]), float(words[1])
        except (OSError, ValueError, IndexError):  # no such file, or the word "max"
            continue
        if granted > 0.0 and of > 0.0:
            return granted / of
    return math.inf


_QUOTA_FILES = (
    ("/sys/fs/cgroup/cpu.max", ""),
    ("/sys/fs/cgroup/cpu/cpu.cfs_quota_us", "/sys/fs/cgroup/cpu/cpu.cfs_period_us"),
)
"""Quota and period files of control groups version 2 and version 1."""


def in_threads(
    job: Callable[[Iterator[_Item]], _Result], items: Iterable[_Item], workers: int
) -> list[_Result]:
    """Share items between this thread and worker threads, which are kept for the next call.

    Parameters
    ----------
    job : callable
        Consumes the iterator until it is exhausted.
    items : iterable
        Work items, large enough to make taking one negligible.
    workers : int
        Number of threads, this one included.

    Returns
    -------
    list
        Results of the jobs; one that had not started when this thread finished is dropped.
    """
    left = iter(list(items))
    others = [_threads().submit(job, left) for _ in range(workers - 1)]
    try:
        results = [job(left)]
    except BaseException:
        list(left)  # exhausted: the others stop, too
        raise
    finally:
        elsewhere = [other.result() for other in others if not other.cancel()]
    return results + elsewhere


@functools.cache
def _threads() -> Any:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(processors(), "fuzzyarm")


def _begin_alone() -> None:
    """Forget the worker threads in a forked child: it has none."""
    _threads.cache_clear()
    for each in list(_locks):
        each._at_fork_reinit()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_begin_alone)


# --- Kernels as plain Python, with other functions under some of their names ---


def with_names(function: Callable[..., Any], bindings: _Bindings) -> Callable[..., Any]:
    """Return a kernel as plain Python with other functions under some names.

    Parameters
    ----------
    function : callable
        A kernel.
    bindings : mapping of str to callable
        Functions bound to these names in the kernel and in all kernels that it calls.
    """
    return cast(Callable[..., Any], copied(function, bindings))


def copied(
    function: Callable[..., Any],
    bindings: _Bindings,
    finish: Callable[[FunctionType], Any] | None = None,
    done: dict[Callable[..., Any], Any] | None = None,
) -> Any:
    """Copy a kernel and its callees, each with globals that name the copies.

    Parameters
    ----------
    function, bindings
        See :func:`with_names`.
    finish : callable, optional
        Applied to each copied callee.
    done : dict, optional
        Existing copies.
    """
    if not is_kernel(function):
        return function  # printed from an expression, or a user's function
    done = {} if done is None else done
    if function not in done:
        plain = cast(FunctionType, function)
        names = {}
        for name, called in called_by(plain, bindings).items():
            copy = copied(called, bindings, finish, done)
            names[name] = finish(copy) if finish and isinstance(copy, FunctionType) else copy
        space = {**plain.__globals__, **names}
        copy = FunctionType(plain.__code__, space, plain.__name__, plain.__defaults__)
        copy.__qualname__, copy.__module__ = plain.__qualname__, plain.__module__
        done[function] = copy
    return done[function]


def called_by(function: FunctionType, bindings: _Bindings) -> dict[str, Callable[..., Any]]:
    """Return the callees of a kernel, by name."""
    functions = {}
    for name in function.__code__.co_names:
        value = bindings.get(name, function.__globals__.get(name))
        if is_kernel(value) or name in bindings:
            functions[name] = value
    return cast("dict[str, Callable[..., Any]]", functions)
