"""Plain functions that run as they stand or as machine code.

A function marked with :func:`kernel` uses scalars, tuples, named tuples and arrays that it
is given (it makes none, and never counts from their end), and calls nothing but :mod:`math` and
other kernels by their bare names. It runs as plain Python, line by line, for a debugger; or as
machine code, which is printed from its source (:mod:`fuzzyarm.symbolic.translation`) and compiled
when fuzzyarm is built. Both give the same bits: the compiled code neither reorders nor fuses
floating-point operations.

- :func:`address_of` gives an address, under which another kernel may :func:`call` it. So what a
  program is asked to do with the rows that it holds (a norm, a shape, a control law) is one
  number in its data.
- :func:`routine` makes a function for Python of what such an address leads to.
- :func:`with_names` runs a kernel as plain Python with other functions under some of its names.

Nothing is compiled at run time. What is not known when fuzzyarm is built (a user's formulas and
kinds, the equations of a user's plant) is a program of operations
(:mod:`fuzzyarm.symbolic.programs`), which has an address, too.
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
"""Environment variable: ``0`` runs every kernel interpreted, ``baseline`` takes no instructions
that only newer processors have."""

_MARK = "__fuzzyarm_kernel__"
_Function = TypeVar("_Function", bound=Callable[..., Any])
_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_Bindings = Mapping[str, Callable[..., Any]]


class NotBuiltError(FuzzyarmError, LookupError):
    """A kernel is not part of the machine code.

    Attributes
    ----------
    key : str
        Of the kernel, see :func:`key_of`.
    """

    def __init__(self, key: str) -> None:
        self.key = key
        super().__init__(f"the machine code of fuzzyarm does not have {key}: build it anew")


def kernel(function: _Function) -> _Function:
    """Mark `function` as one that may run as machine code; it stays plain Python."""
    setattr(function, _MARK, True)
    return function


def is_kernel(function: object) -> bool:
    """Whether a function is marked as one that may run as machine code."""
    return hasattr(function, _MARK)


def whole_numbers(numbers: Any) -> Any:
    """Return memory of floats as whole numbers of 64 bits; for kernels, and their blocks."""
    if isinstance(numbers, memoryview):
        return numbers.cast("B").cast("q")
    import numpy as np

    return numbers.view(np.int64)


def short(number: float) -> int:
    """Return a number without its fraction, which is of 32 bits as machine code; for kernels."""
    return int(number)


# --- The machine code ---


def has_machine_code() -> bool:
    """Whether kernels run as machine code here: it was built, and the environment allows it."""
    return _switch() not in _OFF and _module() is not None


_OFF = {"0", "false", "no", "off"}


def _switch() -> str:
    return os.environ.get(SWITCH, "1").strip().lower()


@functools.cache
def _module() -> ModuleType | None:
    """Load the module that was built; None where there is none that fits, which is said once."""
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
"""Packages whose modules have kernels or decide how they are printed."""


def digest_of_c() -> str:
    """Return a digest of the C that the sources at hand are printed as.

    Printed once after an edit, by another process; then it is noted beside the package.
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
    """Note the digest of the C that the sources at hand are printed as."""
    unfinished = _note().with_name(f".{_note().name}.{os.getpid()}")
    with contextlib.suppress(OSError):  # a package that cannot be written to is printed anew
        unfinished.write_text(f"{digest_of_sources()} {digest}\n", encoding="ascii")
        unfinished.replace(_note())


def _note() -> Path:
    return _here() / "_kernels.digest"


def digest_of_sources() -> str:
    """Return a digest of the text that the C of kernels is printed from."""
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
    """Return the name of a kernel in the machine code: what it is, takes, and is bound to."""
    printed = _printed_key(function, types)
    if printed:
        return printed
    names = [_name(function), *(f"{name}={_name(bindings[name])}" for name in sorted(bindings))]
    return f"{names[0]}({', '.join([types, *names[1:]])})"


def _printed_key(function: Callable[..., Any], types: str) -> str:
    """Return the key of a function that was printed from an expression; empty for others."""
    digest = getattr(function, "__digest__", "")
    return f"{function.__name__}({types}) {digest}" if digest else ""


def _name(function: Callable[..., Any]) -> str:
    return f"{function.__module__}.{function.__qualname__}"


# --- Functions by address: arrays in, arrays out ---

_by_address: list[Callable[..., None]] = []
"""Functions that interpreted kernels call by address: -1 is the first, -2 the second …"""

_locks: WeakSet[Any] = WeakSet()
"""Those of :func:`lock`."""


def lock() -> Any:
    """Return a lock of a thread that is free again in a forked process, whoever held it."""
    made = RLock()
    _locks.add(made)
    return made


_addressing = lock()

_addresses: dict[tuple[Any, ...], tuple[int, Any]] = {}
"""Of a function, its bindings and whether it is machine code: its address, and what must live."""


def call(address: int, *arrays: Any) -> None:
    """Call the function at an address with some arrays; inside kernels only.

    Parameters
    ----------
    address : int
        From :func:`address_of`, made for the same sort of kernel (machine code or not).
    *arrays : ndarray of float64 or int64
        Contiguous, one axis each; of the types that :func:`address_of` was told.
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
        A kernel, or a function printed from an expression, with its text in ``__source__``
        and in ``__program__`` what gives it as a program of operations.
    arrays : int or str
        How many arrays of float64, or a letter for each array: ``f`` for float64, ``i`` for
        int64, ``s`` for int32.
    bindings : mapping of str to callable, optional
        Functions to put in the place of those that the kernel, or a kernel that it
        calls, knows under these names.
    compiled : bool
        For kernels that run as machine code, or as plain Python.

    Returns
    -------
    int
        Good as long as the process lives.

    Raises
    ------
    NotBuiltError
        If `compiled`, and the machine code does not have it.
    """
    bindings = bindings or {}
    letters = letters_of(arrays)
    # One that was printed from an expression may be printed again: it is what it computes.
    who = _printed_key(function, letters) or function
    key = (who, letters, tuple(sorted(bindings.items(), key=lambda pair: pair[0])), compiled)
    if key not in _addresses:
        with _addressing:  # a program that is made twice would be freed while one of two uses it
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
    """Return a printed function that gives NaN or an infinity where Python raises an error."""
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
    """Return a letter for each array of a named tuple of arrays, by its annotations."""
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
    if hasattr(function, "__address__"):  # compiled elsewhere
        return function.__address__, function
    if not hasattr(function, "__program__"):
        raise NotBuiltError(key)
    program: array[float] = function.__program__()
    # Floats begin at even addresses; an odd one says that a program of operations begins there.
    return program.buffer_info()[0] + 1, program


def routine(
    function: Callable[..., None],
    arrays: int | str,
    bindings: _Bindings | None = None,
    *,
    compiled: bool,
) -> Callable[..., None]:
    """Make a function for Python of a kernel that takes arrays; as machine code without the GIL.

    Parameters
    ----------
    function, arrays, bindings, compiled
        See :func:`address_of`.

    Returns
    -------
    callable
        Takes the arrays (contiguous); interpreted, anything that is indexed like them.
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
    """Return what runs machine code on the same arrays again and again; it keeps them alive.

    Parameters
    ----------
    function, types, bindings
        See :func:`address_of`.
    arrays : tuple of ndarray
        Contiguous.
    brief : bool
        Whether it takes less time than to give the interpreter's lock away and to get it back.
    """
    module: Any = _module()
    address = address_of(function, types, bindings, compiled=True)
    return cast(Callable[[], None], module.bind(address, types, arrays, brief))


def point_routines(
    function: Callable[..., None],
    block: Any,
    inputs: tuple[int, tuple[str, ...]],
    outputs: tuple[int, tuple[str, ...]],
    otherwise: Callable[..., tuple[float, ...]],
) -> tuple[Callable[..., tuple[float, ...]], Callable[[Any], dict[str, float] | None]]:
    """Return what evaluates one point as machine code: by position, and by name.

    Parameters
    ----------
    function : kernel
        Of one block.
    block : ndarray of float64
        Its numbers, for all threads.
    inputs, outputs : tuple
        Where they begin in the block, and their names.
    otherwise : callable
        Called with the values by position where one is not a number, or an output has none.

    Returns
    -------
    tuple of callable
        The second takes a dictionary, and returns None where the first goes elsewhere.

    Raises
    ------
    ValueError
        For more inputs than it has room for.
    """
    module: Any = _module()
    address = address_of(function, 1, compiled=True)
    at, named = module.point(address, block, *inputs, *outputs, otherwise)
    return at, named


def sweep_routine(
    function: Callable[..., None],
    block: Any,
    shape: tuple[int, int],
    inputs: tuple[int, int],
    outputs: tuple[int, int],
    counts: tuple[int, int],
) -> Callable[[tuple[Any, ...], int, int], int]:
    """Return what evaluates arrays of points as machine code, chunk by chunk.

    Parameters
    ----------
    function : kernel
        Of one block.
    block : ndarray of float64
        With room for a chunk of points.
    shape : tuple of int
        Points of a chunk, and numbers from one row of the block to the next.
    inputs, outputs : tuple of int
        How many they are, and where in the block their first row begins.
    counts : tuple of int
        Where in the block, as whole numbers, the number of points and that of outputs without a
        value are.

    Returns
    -------
    callable
        Takes the arrays (contiguous, of float64; the inputs, then the outputs), the first element
        and the one behind the last; returns how many outputs have no value. One at a time: there is
        one block.
    """
    module: Any = _module()
    address = address_of(function, 1, compiled=True)
    sweeper = module.sweeper(address, block, shape, inputs, outputs, counts)
    return cast(Callable[[tuple[Any, ...], int, int], int], sweeper)


# --- Several processors ---


@functools.cache
def processors() -> int:
    """Return how many processors this process may keep busy.

    Those it may run on, and no more than the share of them that a container grants it.
    """
    try:
        count = len(os.sched_getaffinity(0))
    except AttributeError:  # not on macOS and Windows
        count = os.cpu_count() or 1
    quota = _quota()
    return max(1, math.ceil(quota)) if quota < count else count


def _quota() -> float:
    """Return how many processors a control group of Linux grants; infinite without a limit."""
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
"""Of control groups of version 2, and of version 1: the time granted, and the period."""


def in_threads(
    job: Callable[[Iterator[_Item]], _Result], items: Iterable[_Item], workers: int
) -> list[_Result]:
    """Share items between this thread and others at the same time, which stay for the next call.

    Parameters
    ----------
    job : callable
        Takes items from the iterator that it is given, until nothing is left of it.
    items : iterable
        What there is to do; in parts so large that taking one costs nothing beside it.
    workers : int
        Threads, this one among them.

    Returns
    -------
    list
        What the jobs returned; one that had not begun when this thread was done is left out.
    """
    left = iter(list(items))
    others = [_threads().submit(job, left) for _ in range(workers - 1)]
    try:
        results = [job(left)]
    except BaseException:
        list(left)  # so that the others begin nothing more
        raise
    finally:
        elsewhere = [other.result() for other in others if not other.cancel()]
    return results + elsewhere


@functools.cache
def _threads() -> Any:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(processors(), "fuzzyarm")


def _begin_alone() -> None:
    """Forget other threads in a process that was forked: it has none of them."""
    _threads.cache_clear()
    for each in list(_locks):
        each._at_fork_reinit()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_begin_alone)


# --- Kernels as plain Python, with other functions under some of their names ---


def with_names(function: Callable[..., Any], bindings: _Bindings) -> Callable[..., Any]:
    """Return a kernel as plain Python that knows other functions under some names.

    Parameters
    ----------
    function : callable
        A kernel.
    bindings : mapping of str to callable
        Functions to put in the place of those that the kernel, or a kernel that it calls, knows
        under these names.
    """
    return cast(Callable[..., Any], copied(function, bindings))


def copied(
    function: Callable[..., Any],
    bindings: _Bindings,
    finish: Callable[[FunctionType], Any] | None = None,
    done: dict[Callable[..., Any], Any] | None = None,
) -> Any:
    """Copy a kernel and those it calls, each over globals that name the copies.

    Parameters
    ----------
    function, bindings
        See :func:`with_names`.
    finish : callable, optional
        What is done to each copy that another one calls.
    done : dict, optional
        Copies that were made before.
    """
    if not is_kernel(function):
        return function  # printed from an expression; or a user's, bound to a name
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
    """Return what a kernel calls, by the names under which it does."""
    functions = {}
    for name in function.__code__.co_names:
        value = bindings.get(name, function.__globals__.get(name))
        if is_kernel(value) or name in bindings:
            functions[name] = value
    return cast("dict[str, Callable[..., Any]]", functions)
