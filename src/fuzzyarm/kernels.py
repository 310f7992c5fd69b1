"""Plain functions that run as they stand or as machine code.

A function marked with :func:`kernel` uses scalars, tuples, named tuples and
arrays that it is given (it makes none), and calls nothing but :mod:`math` and
other kernels by their bare names. :func:`build` makes a callable of such a
function and of everything it calls: machine code by numba, or the very same
Python, line by line, for a debugger. Both give the same bits: the compiled code
neither reorders nor fuses floating-point operations.

A kernel may also call a function that it knows by its address only: :func:`address_of`
gives an address, and :func:`call` calls what is there. So a program is compiled once, and
what it is asked to do with the rows that it holds (a norm, a shape, a law) is compiled apart,
when it is used first; another one is other data.

numba is imported by the first call of :func:`build` that needs it. The machine
code is kept on disk beside the module (where that folder cannot be written, in
numba's own folder of the user), under a name that carries a digest of the source
of every kernel in it; numba itself would watch one of the files only.
"""

from __future__ import annotations

import functools
import hashlib
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar, cast

SWITCH = "FUZZYARM_JIT"
"""Environment variable: ``0`` runs every kernel interpreted."""

_MARK = "__fuzzyarm_kernel__"
_Function = TypeVar("_Function", bound=Callable[..., Any])


def kernel(function: _Function) -> _Function:
    """Mark `function` as one that :func:`build` may compile; it stays plain Python."""
    setattr(function, _MARK, True)
    return function


def jit_wanted() -> bool:
    """Whether kernels are to be compiled, by the environment."""
    return os.environ.get(SWITCH, "1").strip().lower() not in {"0", "false", "no", "off"}


_by_address: list[Callable[..., None]] = []
"""Functions that interpreted kernels call by address: -1 is the first, -2 the second …"""

_addresses: dict[tuple[Callable[..., None], bool], tuple[int, Any]] = {}
"""Address of each function, machine code or not, and what must live as long as it."""


def call(address: int, *arrays: Any) -> None:
    """Call the function at an address with some arrays; inside kernels only.

    Parameters
    ----------
    address : int
        From :func:`address_of`, made for the same sort of kernel (machine code or not).
    *arrays : ndarray of float64
        Contiguous, one axis each.
    """
    _by_address[-1 - address](*arrays)


def address_of(function: Callable[..., None], arrays: int, *, compiled: bool) -> int:
    """Return an address under which kernels may :func:`call` a function.

    Parameters
    ----------
    function : callable
        A kernel, or a function printed from an expression (with its text in
        ``__source__``), of `arrays` arrays of float64; it returns nothing.
    arrays : int
        How many there are.
    compiled : bool
        For kernels that run as machine code, or as plain Python.

    Returns
    -------
    int
        Good as long as the process lives. Machine code is kept on disk like that of
        :func:`build`.
    """
    known = _addresses.get((function, compiled))
    if known is None:
        known = _machine_address(function, arrays) if compiled else _plain_address(function)
        _addresses[function, compiled] = known
    return known[0]


def _plain_address(function: Callable[..., None]) -> tuple[int, Any]:
    _by_address.append(function)
    return -len(_by_address), None


def _machine_address(function: Callable[..., None], arrays: int) -> tuple[int, Any]:
    """Compile `function` behind an entry of C: a pointer and a length for each array."""
    from numba import carray, cfunc, types

    inner = _compiled_inner(function)
    pairs = [f"p{i}, n{i}" for i in range(arrays)]
    views = [f"carray(p{i}, n{i})" for i in range(arrays)]
    source = f"def entry({', '.join(pairs)}):\n    inner({', '.join(views)})\n"
    space: dict[str, Any] = {"carray": carray, "inner": inner}
    exec(compile(source, __file__, "exec"), space)
    entry = space["entry"]
    entry.__module__, entry.__qualname__ = __name__, f"entry_{_source_digest(function)}"
    pointer = types.CPointer(types.float64)
    signature = types.void(*[pointer, types.int64] * arrays)
    made = _cached(lambda **options: cfunc(signature, error_model="numpy", **options)(entry))
    return int(made.address), made


def _compiled_inner(function: Callable[..., None]) -> Any:
    if hasattr(function, _MARK):
        return _clone(function, {}, {}, _inner_machine())
    return _inner_machine()(function)


def _inner_machine() -> Any:
    """Return the compiler of functions that only machine code calls."""
    import numba

    return numba.njit(
        error_model="numpy", nogil=True, _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True
    )


def _cached(make: Callable[..., Any]) -> Any:
    try:
        return make(cache=True)
    except RuntimeError:  # neither the package folder nor the user's can be written
        return make()


def _source_digest(function: Callable[..., Any]) -> str:
    source = getattr(function, "__source__", None)
    if source is None:
        return _digest(function, {})
    return hashlib.sha256(f"{source}{Path(__file__).read_text()}".encode()).hexdigest()[:16]


@functools.cache
def _machine_call() -> Any:
    """Return what :func:`call` is to the compiler: an indirect call of C."""
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.extending import intrinsic

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, values = arguments
        word, pointer = ir.IntType(64), ir.DoubleType().as_pointer()
        passed = []
        pairs = zip(signature.args[1], cgutils.unpack_tuple(builder, values), strict=True)
        for kind, value in pairs:
            array = context.make_array(kind)(context, builder, value)
            passed += [array.data, cgutils.unpack_tuple(builder, array.shape, 1)[0]]
        entry = ir.FunctionType(ir.VoidType(), [pointer, word] * len(signature.args[1]))
        builder.call(builder.inttoptr(address, entry.as_pointer()), passed)
        return context.get_dummy_value()

    def typed(context: Any, address: Any, *arrays: Any) -> Any:
        return types.void(types.int64, types.StarArgTuple(arrays)), generate

    return intrinsic(typed)


def build(
    function: Callable[..., Any],
    bindings: Mapping[str, Callable[..., Any]] | None = None,
    *,
    compiled: bool,
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

    import numba

    # Kernels make no arrays, so nothing has to count who holds one (which cost as much as a
    # closed loop itself). Only the root can be called from Python.
    root = _clone(function, bindings, {}, _inner_machine(), root=True)
    root.__qualname__ = f"{root.__qualname__}_{_digest(function, bindings)}"
    machine: Any = functools.partial(numba.njit, error_model="numpy", nogil=True, _nrt=False)
    return cast(Callable[..., Any], _cached(lambda **options: machine(root, **options)))


def _as_it_is(function: FunctionType) -> FunctionType:
    return function


def _clone(
    function: Callable[..., Any],
    bindings: Mapping[str, Callable[..., Any]],
    done: dict[Callable[..., Any], Callable[..., Any]],
    finish: Callable[[FunctionType], Callable[..., Any]],
    *,
    root: bool = False,
) -> Any:
    """Copy a kernel and those it calls, each over globals that name the copies."""
    if function is call:
        return call if finish is _as_it_is else _machine_call()
    if not hasattr(function, _MARK):
        return function  # a callable of the user's, bound to a name of an interpreted kernel
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


def _called(
    function: FunctionType, bindings: Mapping[str, Callable[..., Any]]
) -> dict[str, Callable[..., Any]]:
    found = {}
    for name in function.__code__.co_names:
        value = bindings.get(name, function.__globals__.get(name))
        if hasattr(value, _MARK) or name in bindings or value is call:
            found[name] = value
    return cast("dict[str, Callable[..., Any]]", found)


def _digest(function: Callable[..., Any], bindings: Mapping[str, Callable[..., Any]]) -> str:
    """Hash what is bound, the source files of all kernels reached, and this one."""
    reached: set[Callable[..., Any]] = set()
    waiting = [function]
    while waiting:
        current = waiting.pop()
        if current not in reached:
            reached.add(current)
            called = _called(cast(FunctionType, current), bindings).values()
            waiting += [each for each in called if each is not call]
    files = sorted({__file__, *(cast(FunctionType, each).__code__.co_filename for each in reached)})
    whole = hashlib.sha256()
    for name, bound in sorted(bindings.items()):
        whole.update(f"{name}={bound.__module__}.{bound.__qualname__};".encode())
    for file in files:
        whole.update(Path(file).read_bytes())
    return whole.hexdigest()[:16]
