"""Plain functions that run as they stand or as machine code.

A function marked with :func:`kernel` uses scalars, tuples, named tuples and arrays that it
is given (it makes none, and never counts from their end), and calls nothing but :mod:`math` and
other kernels by their bare names. It becomes callable in one of three ways, as machine code or
as the very same Python, line by line, for a debugger; both give the same bits, for the compiled
code neither reorders nor fuses floating-point operations:

- :func:`address_of` gives an address, under which another kernel may :func:`call` it. So a
  program is compiled once, and what it is asked to do with the rows that it holds (a norm, a
  shape, a control law) is compiled apart, when it is used first.
- :func:`routine` makes a function for Python of what such an address leads to.
- :func:`build` leaves types open: numba compiles for those of the first call.

Machine code is kept on disk under a name that carries a digest of the source of every kernel in
it, of the compiler and of the processor (:mod:`fuzzyarm.machine_code`). For the first two ways a
later process needs no numba.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple, TypeVar, cast

from fuzzyarm.machine_code import __file__ as machine_code_file
from fuzzyarm.machine_code import (
    call_of_machine,
    compile_entry,
    folders_of,
    forgive,
    inner_compiler,
    keep_code,
    load_code,
    made_by,
    numba_itself,
    read_code,
    telling,
)

SWITCH = "FUZZYARM_JIT"
"""Environment variable: ``0`` runs every kernel interpreted."""

_MARK = "__fuzzyarm_kernel__"
_SCALAR = "__fuzzyarm_scalar__"
_Function = TypeVar("_Function", bound=Callable[..., Any])
_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_Bindings = Mapping[str, Callable[..., Any]]

_loaded: dict[str, tuple[int, int] | None] = {}
"""Source files of kernels, and their stamps when they were imported."""

_THIS_PROCESS = f"{os.getpid()} {time.time_ns()}".encode()


def kernel(function: _Function) -> _Function:
    """Mark `function` as one that may be compiled; it stays plain Python."""
    setattr(function, _MARK, True)
    file = function.__code__.co_filename
    _loaded.setdefault(file, _stamp(file))
    return function


def scalar(function: _Function) -> _Function:
    """Mark a kernel, called by address, that works number by number: its loops are short.

    They are then neither unrolled nor made to take several numbers at a time: the machine code
    is half as long, and is made and runs in less time.
    """
    setattr(function, _SCALAR, True)
    return function


def _stamp(file: str) -> tuple[int, int] | None:
    """Return what changes when a file is written; None where there is none."""
    try:
        status = os.stat(file)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def is_kernel(function: object) -> bool:
    """Whether a function is marked as one that may be compiled."""
    return hasattr(function, _MARK)


def jit_wanted() -> bool:
    """Whether kernels are to be compiled, by the environment."""
    return os.environ.get(SWITCH, "1").strip().lower() not in {"0", "false", "no", "off"}


# --- Functions by address: arrays in, arrays out ---

_by_address: list[Callable[..., None]] = []
"""Functions that interpreted kernels call by address: -1 is the first, -2 the second …"""

_addresses: dict[tuple[Wanted, bool], tuple[int, Any]] = {}
"""Of what is wanted, as machine code or not: its address, and what must live as long."""

_making = threading.RLock()


class Wanted(NamedTuple):
    """What machine code is made of.

    Attributes
    ----------
    function : callable
        See :func:`address_of`.
    types : str
        A letter for each array.
    bindings : tuple of (str, callable)
        See :func:`build`.
    inline : bool
        See :func:`address_of`.
    """

    function: Callable[..., None]
    types: str
    bindings: tuple[tuple[str, Callable[..., Any]], ...] = ()
    inline: bool = False


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
    inline: bool = False,
) -> int:
    """Return an address under which kernels may :func:`call` a function.

    Parameters
    ----------
    function : callable
        A kernel, or a function printed from an expression (with its text in
        ``__source__``), that takes arrays and returns nothing.
    arrays : int or str
        How many arrays of float64, or a letter for each array: ``f`` for float64, ``i`` for
        int64.
    bindings : mapping of str to callable, optional
        See :func:`build`.
    compiled : bool
        For kernels that run as machine code, or as plain Python.
    inline : bool, optional
        Whether the kernels that `function` calls are to become part of it; it then runs
        faster where they are many and small, and takes longer to compile.

    Returns
    -------
    int
        Good as long as the process lives.
    """
    wanted = Wanted(function, _types(arrays), tuple((bindings or {}).items()), inline)
    key = (wanted, compiled)
    with _making:
        if key not in _addresses:
            if not compiled:
                _by_address.append(_clone(function, bindings or {}, {}, _as_it_is))
                _addresses[key] = -len(_by_address), None
            elif _gathering:
                _gathering[-1].append(wanted)
                return 0
            else:
                _load_or_compile(wanted)
        return _addresses[key][0]


def _types(arrays: int | str) -> str:
    return "f" * arrays if isinstance(arrays, int) else arrays


def routine(
    function: Callable[..., None],
    arrays: str,
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
        return cast(Callable[..., None], _clone(function, bindings or {}, {}, _as_it_is))
    from ctypes import CFUNCTYPE, c_int64, c_void_p

    address = address_of(function, arrays, bindings, compiled=True)
    kinds = [c_void_p, c_int64] * len(arrays)
    entry = CFUNCTYPE(None, *kinds)(address)
    wanted = [_NAMES[letter] for letter in arrays]

    def words_of(*given: Any) -> list[int]:
        words: list[int] = []
        for array, name in zip(given, wanted, strict=True):
            # The name of a type takes Python to make, so it is asked for where types differ only.
            if array.dtype.str != _NATIVE[name] or not array.flags.c_contiguous:
                message = f"a contiguous array of {name} is needed, not one of {array.dtype.name}"
                raise TypeError(message)
            words += [array.ctypes.data, array.size]
        return words

    def run(*given: Any) -> None:
        entry(*words_of(*given))

    def bind(*given: Any) -> Callable[[], None]:
        """Return what runs it on the same arrays again and again; it keeps them alive."""
        words = [kind(word) for word, kind in zip(words_of(*given), kinds, strict=True)]

        def again(_arrays: Any = given) -> None:
            entry(*words)

        return again

    run.bind = bind  # type: ignore[attr-defined]
    return run


_NAMES = {"f": "float64", "i": "int64"}

_ORDER = "<" if sys.byteorder == "little" else ">"
_NATIVE = {"float64": f"{_ORDER}f8", "int64": f"{_ORDER}i8"}


def is_at_hand(function: Callable[..., None], arrays: int | str) -> bool:
    """Whether machine code of a kernel is in this process or on disk: nothing to compile."""
    wanted = Wanted(function, _types(arrays))
    return (wanted, True) in _addresses or _was_on_disk(wanted)


@functools.cache
def _was_on_disk(wanted: Wanted) -> bool:
    return _is_on_disk(wanted)


def _is_on_disk(wanted: Wanted) -> bool:
    name = _file_name(wanted)
    # Unlike that of a path, this question has an answer where a folder cannot be searched.
    return any(os.path.isfile(folder / name) for folder in folders_of(wanted.function))


def _label(wanted: Wanted) -> str:
    names = [wanted.function.__name__, *(bound.__name__ for _, bound in wanted.bindings)]
    return f"{wanted.function.__module__.rpartition('.')[2]}.{'-'.join(names)}"


def _file_name(wanted: Wanted) -> str:
    return f"{_label(wanted)}.{_code_digest(wanted)}.code"


def _load(wanted: Wanted, code: bytes) -> None:
    _addresses[wanted, True] = load_code(code, _symbol(_code_digest(wanted)))


def _load_or_compile(wanted: Wanted) -> None:
    """Give a function an address: load its machine code, or make it and keep it."""
    code = _code_on_disk(wanted)
    if code is not None:
        _load(wanted, code)
        return
    if _before_compiling:
        _before_compiling.pop()()
    if (wanted, True) not in _addresses:
        take_machine_code(wanted, machine_code(wanted))


def _code_on_disk(wanted: Wanted) -> bytes | None:
    name = _file_name(wanted)
    found = (read_code(folder / name) for folder in folders_of(wanted.function))
    return next((code for code in found if code is not None), None)


# --- Several functions at once: what :mod:`fuzzyarm.compilers` is made of ---

_gathering: list[list[Wanted]] = []
"""Where functions are listed that would be loaded or compiled."""

_before_compiling: list[Callable[[], None]] = []
"""What is called before the next function is compiled."""


@contextlib.contextmanager
def gathered() -> Iterator[list[Wanted]]:
    """Load and compile nothing: list what :func:`address_of` is asked for, which returns 0.

    Yields
    ------
    list of Wanted
        Grows by what is not in this process, whether on disk or not.
    """
    wanted: list[Wanted] = []
    with _making:
        _gathering.append(wanted)
        try:
            yield wanted
        finally:
            _gathering.pop()


@contextlib.contextmanager
def before_compiling(act: Callable[[], None]) -> Iterator[None]:
    """Have `act` called when something is to be compiled for the first time meanwhile."""
    with _making:
        _before_compiling[:] = [act]
    try:
        yield
    finally:
        _before_compiling.clear()


def to_compile(wanted: Iterable[Wanted]) -> list[Wanted]:
    """Return what is neither in this process nor on disk, each once."""
    once = dict.fromkeys(wanted)
    return [each for each in once if (each, True) not in _addresses and not _is_on_disk(each)]


class MachineCode(NamedTuple):
    """An object file of the platform.

    Attributes
    ----------
    code : bytes
        In which one symbol, ``fuzzyarm_`` and the digest, takes a pointer and a length for each
        array.
    complete : bool
        Whether it is complete without numba, and so can be kept.
    digest : str
        Of sources, compiler and processor.
    """

    code: bytes
    complete: bool
    digest: str


def machine_code(wanted: Wanted) -> MachineCode:
    """Compile a function."""
    digest = _code_digest(wanted)
    with telling(wanted.function.__name__, count_functions(wanted)):
        compiler = inner_compiler(wanted.inline)
        bindings = dict(wanted.bindings)
        inner = compiler(_clone(wanted.function, bindings, {}, compiler, root=True))
        scalar = hasattr(wanted.function, _SCALAR)
        code, complete = compile_entry(inner, wanted.types, _symbol(digest), scalar=scalar)
    return MachineCode(code, complete, digest)


def take_machine_code(wanted: Wanted, made: MachineCode) -> None:
    """Keep machine code and give the function its address; that of other sources is left."""
    if made.digest != _code_digest(wanted):
        return
    with _making:
        if made.complete:
            keep_code(made.code, folders_of(wanted.function), _label(wanted), made.digest)
        _load(wanted, made.code)


@functools.cache
def _code_digest(wanted: Wanted) -> str:
    from hashlib import sha256

    source = _source_digest(wanted.function, dict(wanted.bindings))
    whole = f"{wanted.types}{wanted.inline};{source};{made_by()}"
    return sha256(whole.encode()).hexdigest()[:16]


def _symbol(digest: str) -> str:
    return f"fuzzyarm_{digest}"


def count_functions(wanted: Wanted) -> int:
    """Return how many functions a program has, without those that it calls by address."""
    return len(_reached(wanted.function, dict(wanted.bindings)))


def size_of(wanted: Wanted) -> int:
    """Return the length of a program in bytes of Python's own code: what compiling it takes."""
    reached = _reached(wanted.function, dict(wanted.bindings))
    return sum(len(cast(FunctionType, each).__code__.co_code) for each in reached)


# --- Several processors ---


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
        found = [job(left)]
    except BaseException:
        list(left)  # so that the others begin nothing more
        raise
    finally:
        elsewhere = [each.result() for each in others if not each.cancel()]
    return found + elsewhere


@functools.cache
def _threads() -> Any:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(os.cpu_count() or 1, "fuzzyarm")


if hasattr(os, "register_at_fork"):  # a forked process has none of them
    os.register_at_fork(after_in_child=_threads.cache_clear)


# --- Functions whose types numba finds at the first call ---


def build(
    function: Callable[..., Any], bindings: _Bindings | None = None, *, compiled: bool
) -> Callable[..., Any]:
    """Make `function` callable with other functions under some of its names.

    Parameters
    ----------
    function : callable
        A kernel.
    bindings : mapping of str to callable, optional
        Functions to put in the place of those that the kernel, or a kernel that it
        calls, knows under these names. Compiled, they have to be kernels.
    compiled : bool
        Machine code, or plain Python.

    Returns
    -------
    callable
        With the signature of `function`.
    """
    bindings = dict(bindings or {})
    if not compiled:
        return cast(Callable[..., Any], _clone(function, bindings, {}, _as_it_is))

    numba = numba_itself()
    # Only the root can be called from Python.
    root = _clone(function, bindings, {}, inner_compiler(), root=True)
    root.__qualname__ = f"{root.__qualname__}_{_source_digest(function, bindings)}"
    machine = functools.partial(numba.njit, error_model="numpy", nogil=True, _nrt=False)
    try:
        made = machine(root, cache=True)
    except RuntimeError:  # neither the package folder nor the user's can be written
        return cast(Callable[..., Any], machine(root))
    forgive(made._cache)
    return cast(Callable[..., Any], made)


# --- Copies of kernels over the names that are bound ---


def _as_it_is(function: FunctionType) -> FunctionType:
    return function


def _clone(
    function: Callable[..., Any],
    bindings: _Bindings,
    done: dict[Callable[..., Any], Callable[..., Any]],
    finish: Callable[[FunctionType], Callable[..., Any]],
    *,
    root: bool = False,
) -> Any:
    """Copy a kernel and those it calls, each over globals that name the copies."""
    if function is call:
        return call if finish is _as_it_is else call_of_machine()
    if not hasattr(function, _MARK):
        # Printed from an expression; or a user's, bound to a name of an interpreted kernel.
        return function
    if function in done:
        return done[function]
    plain = cast(FunctionType, function)
    names = {
        name: _clone(called, bindings, done, finish)
        for name, called in _called(plain, bindings).items()
    }
    copy = FunctionType(
        plain.__code__, {**plain.__globals__, **names}, plain.__name__, plain.__defaults__
    )
    copy.__qualname__ = plain.__qualname__
    copy.__module__ = plain.__module__
    done[function] = copy if root else finish(copy)
    return done[function]


def _called(function: FunctionType, bindings: _Bindings) -> dict[str, Callable[..., Any]]:
    found = {}
    for name in function.__code__.co_names:
        value = bindings.get(name, function.__globals__.get(name))
        if hasattr(value, _MARK) or name in bindings or value is call:
            found[name] = value
    return cast("dict[str, Callable[..., Any]]", found)


def _source_digest(function: Callable[..., Any], bindings: _Bindings) -> str:
    """Hash what is bound, the source files of all kernels reached, and this one."""
    from hashlib import sha256

    whole = sha256(Path(__file__).read_bytes())
    whole.update(Path(machine_code_file).read_bytes())
    if not hasattr(function, _MARK):
        whole.update(vars(function)["__source__"].encode())
        return whole.hexdigest()[:16]
    for name, bound in sorted(bindings.items()):
        whole.update(f"{name}={bound.__module__}.{bound.__qualname__};".encode())
    reached = _reached(function, bindings)
    for file in sorted({cast(FunctionType, each).__code__.co_filename for each in reached}):
        whole.update(Path(file).read_bytes())
        if _stamp(file) != _loaded[file]:
            # What runs here is older than the file: no other process may take its machine code.
            whole.update(_THIS_PROCESS)
    return whole.hexdigest()[:16]


def _reached(function: Callable[..., Any], bindings: _Bindings) -> set[Callable[..., Any]]:
    """Return a kernel and all that it calls, and these call."""
    if not hasattr(function, _MARK):
        return {function}
    reached: set[Callable[..., Any]] = set()
    waiting = [function]
    while waiting:
        current = waiting.pop()
        if current not in reached:
            reached.add(current)
            called = _called(cast(FunctionType, current), bindings).values()
            waiting += [each for each in called if each is not call]
    return reached
