"""Plain functions that run as they stand or as machine code.

A function marked with :func:`kernel` uses scalars, tuples, named tuples and
arrays that it is given (it makes none), and calls nothing but :mod:`math` and
other kernels by their bare names. :func:`build` makes a callable of such a
function and of everything it calls: machine code by numba, or the very same
Python, line by line, for a debugger. Both give the same bits: the compiled code
neither reorders nor fuses floating-point operations.

numba is imported by the first call of :func:`build` that needs it. The machine
code is kept on disk beside the module (where that folder cannot be written, in
numba's own folder of the user), under a name that carries a digest of the source
of every kernel in it; numba itself would watch one of the files only.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Mapping
from functools import partial
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
        return cast(Callable[..., Any], _clone(function, bindings, {}, lambda plain: plain))

    import numba

    # Inlining everything spares the copies of named tuples: twice as fast. Kernels make no
    # arrays, so nothing has to count who holds one (which cost as much as the loop itself).
    machine: Any = partial(
        numba.njit, error_model="numpy", nogil=True, forceinline=True, _nrt=False
    )
    root = _clone(function, bindings, {}, machine, root=True)
    root.__qualname__ = f"{root.__qualname__}_{_digest(function, bindings)}"
    try:
        return cast(Callable[..., Any], machine(root, cache=True))
    except RuntimeError:  # neither the package folder nor the user's can be written
        return cast(Callable[..., Any], machine(root))


def _clone(
    function: Callable[..., Any],
    bindings: Mapping[str, Callable[..., Any]],
    done: dict[Callable[..., Any], Callable[..., Any]],
    finish: Callable[[FunctionType], Callable[..., Any]],
    *,
    root: bool = False,
) -> Any:
    """Copy a kernel and those it calls, each over globals that name the copies."""
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
        if hasattr(value, _MARK) or name in bindings:
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
            waiting += _called(cast(FunctionType, current), bindings).values()
    files = sorted({__file__, *(cast(FunctionType, each).__code__.co_filename for each in reached)})
    whole = hashlib.sha256()
    for name, bound in sorted(bindings.items()):
        whole.update(f"{name}={bound.__module__}.{bound.__qualname__};".encode())
    for file in files:
        whole.update(Path(file).read_bytes())
    return whole.hexdigest()[:16]
