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

Machine code is kept on disk beside the module (where that folder cannot be written, in a
folder of the user) under a name that carries a digest of the source of every kernel in it, of
the compiler and of the processor. For the first two ways a later process needs llvmlite alone,
which loads in a tenth of the time of numba. A file that is damaged is made again, and one that
cannot be written is gone without.
"""

from __future__ import annotations

import contextlib
import functools
import importlib.util
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple, TypeVar, cast

SWITCH = "FUZZYARM_JIT"
"""Environment variable: ``0`` runs every kernel interpreted."""

_MARK = "__fuzzyarm_kernel__"
_Function = TypeVar("_Function", bound=Callable[..., Any])
_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_Bindings = Mapping[str, Callable[..., Any]]


def kernel(function: _Function) -> _Function:
    """Mark `function` as one that may be compiled; it stays plain Python."""
    setattr(function, _MARK, True)
    return function


def is_kernel(function: object) -> bool:
    """Whether a function is marked as one that may be compiled."""
    return hasattr(function, _MARK)


def jit_wanted() -> bool:
    """Whether kernels are to be compiled, by the environment."""
    return os.environ.get(SWITCH, "1").strip().lower() not in {"0", "false", "no", "off"}


# --- Functions by address: arrays in, arrays out ---

_by_address: list[Callable[..., None]] = []
"""Functions that interpreted kernels call by address: -1 is the first, -2 the second …"""

_addresses: dict[tuple[Any, ...], tuple[int, Any]] = {}
"""Of each function, arrays, bindings and way to run: its address, and what must live as long."""

_making = threading.RLock()


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
    types = "f" * arrays if isinstance(arrays, int) else arrays
    bound = dict(bindings or {})
    key = (function, types, *bound.items(), compiled, inline)
    with _making:
        if key not in _addresses:
            if compiled:
                _addresses[key] = _machine_address(function, types, bound, inline)
            else:
                _by_address.append(_clone(function, bound, {}, _as_it_is))
                _addresses[key] = -len(_by_address), None
        return _addresses[key][0]


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
    types = "f" * arrays if isinstance(arrays, int) else arrays
    return (function, types, True, False) in _addresses or _is_on_disk(function, types)


@functools.cache
def _is_on_disk(function: Callable[..., None], types: str) -> bool:
    label, digest = _label_and_digest(function, types, {}, inline=False)
    # Unlike that of a path, this question has an answer where a folder cannot be searched.
    return any(os.path.isfile(folder / f"{label}.{digest}.code") for folder in _folders(function))


def _label_and_digest(
    function: Callable[..., None], types: str, bindings: _Bindings, inline: bool
) -> tuple[str, str]:
    names = [function.__name__, *(bound.__name__ for bound in bindings.values())]
    label = f"{function.__module__.rpartition('.')[2]}.{'-'.join(names)}"
    return label, _code_digest(function, f"{types}{inline}", bindings)


def _machine_address(
    function: Callable[..., None], types: str, bindings: _Bindings, inline: bool
) -> tuple[int, Any]:
    """Load the machine code of a function, or make it and keep it."""
    label, digest = _label_and_digest(function, types, bindings, inline)
    symbol = f"fuzzyarm_{digest}"
    folders = _folders(function)
    for folder in folders:
        code = _read_code(folder / f"{label}.{digest}.code")
        if code is not None:
            return _load(code, symbol)
    with _told(function, bindings):
        code, complete = _compile(function, types, bindings, symbol, inline)
    if complete:
        _keep(code, folders, label, digest)
    return _load(code, symbol)


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


# --- Machine code on disk ---
#
# A file is a line with a checksum and behind it an object file of the platform, in which one
# symbol, `fuzzyarm_` and the digest, takes a pointer and a length for each array.

_VERSIONS = 8
"""Files of one function that stay: other sources, other processors on a shared disk."""


def _folders(function: Callable[..., Any]) -> list[Path]:
    """Return where machine code may lie, the best one first."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        return [Path(chosen)]
    own = Path(function.__code__.co_filename).parent / "__pycache__"
    # A function printed from an expression has no file.
    found = own if own.parent.is_dir() and own.parent.is_absolute() else _HERE / "__pycache__"
    user = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))
    # Without a home (a container may run under any number) the "~" stays as it is.
    return [found, user / "fuzzyarm"] if user.is_absolute() else [found]


_HERE = Path(__file__).resolve().parent


def _read_code(path: Path) -> bytes | None:
    """Return the code in a file; None where there is no such file or it is damaged."""
    try:
        head, line_end, code = path.read_bytes().partition(b"\n")
    except OSError:
        return None
    return code if head + line_end == _head(code) else None


def _head(code: bytes) -> bytes:
    from hashlib import sha256

    return f"fuzzyarm-code 1 {sha256(code).hexdigest()}\n".encode()


def _keep(code: bytes, folders: Sequence[Path], label: str, digest: str) -> None:
    """Write a file into the first folder that takes it; of old ones only some stay."""
    from fuzzyarm.text.files import write_atomically

    for folder in folders:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            write_atomically(folder / f"{label}.{digest}.code", _head(code) + code)
        except OSError:  # read-only, or the disk is full
            continue
        with contextlib.suppress(OSError):  # another process may tidy up, too
            known = sorted(folder.glob(f"{label}.*.code"), key=lambda each: each.stat().st_mtime)
            for old in known[:-_VERSIONS]:
                old.unlink()
        return


def _code_digest(function: Callable[..., Any], form: str, bindings: _Bindings) -> str:
    import platform
    from hashlib import sha256

    import llvmlite.binding as llvm

    whole = sha256(f"{form};{_source_digest(function, bindings)};".encode())
    whole.update(f"{platform.python_version()};{llvm.get_default_triple()};".encode())
    whole.update(f"{llvm.get_host_cpu_name()};{llvm.get_host_cpu_features().flatten()};".encode())
    whole.update(_numba_version())
    return whole.hexdigest()[:16]


@functools.cache
def _numba_version() -> bytes:
    """Return what tells one numba from another, without importing it."""
    spec = importlib.util.find_spec("numba")
    folders = spec.submodule_search_locations if spec is not None else None
    return (Path(next(iter(folders))) / "_version.py").read_bytes() if folders else b""


def _load(code: bytes, symbol: str) -> tuple[int, Any]:
    """Give an object file of this process its address, in an engine of its own.

    numba numbers the functions inside a file anew in every process, so two files may call
    different functions by one name; in one engine the second would get those of the first.
    """
    import llvmlite.binding as llvm

    machine = _target().create_target_machine(jit=True)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return int(engine.get_function_address(symbol)), engine


@functools.cache
def _target() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple()


# --- Compiling ---


class Compiling(NamedTuple):
    """What is being compiled.

    Attributes
    ----------
    name : str
        Of the function.
    done, total : int
        Functions of its program that were begun before, and how many there are; a function that
        is compiled for several types counts again. `total` is 0 where that is not known.
    """

    name: str
    done: int
    total: int


Watch = Callable[[Compiling | None], None]

_watch: list[Watch] = []
"""Who is told what is being compiled."""

_program: list[int] = []
"""Of the program that is being compiled: functions that were begun, and how many there are."""


def watch_compiling(watch: Watch | None) -> Watch | None:
    """Have `watch` called with each function that is being compiled.

    Parameters
    ----------
    watch : callable or None
        Takes a `Compiling`, or None when compiling is over for now. Nothing is said while
        machine code is loaded only.

    Returns
    -------
    callable or None
        Who was told before.
    """
    before = _watch[0] if _watch else None
    _watch[:] = [] if watch is None else [watch]
    return before


def _tell(name: str | None) -> None:
    """Tell who watches that a function is begun, or that all is over for now."""
    told = None if name is None else Compiling(name, *(_program or (0, 0)))
    for each in _watch:
        each(told)


@contextlib.contextmanager
def _told(function: Callable[..., Any], bindings: _Bindings) -> Iterator[None]:
    """Count the functions of a program while it is compiled."""
    _program[:] = [0, len(_reached(function, bindings))]
    _tell(function.__name__)  # importing the compiler takes a second, too
    try:
        yield
    finally:
        _program.clear()
        _tell(None)


@functools.cache
def _numba() -> Any:
    """Import numba, and have it tell who watches what it compiles."""
    import numba
    from numba.core import event

    class Told(event.Listener):  # type: ignore[misc]
        depth = 0

        def on_start(self, happened: Any) -> None:
            self.depth += 1
            function = happened.data["dispatcher"].py_func
            if not function.__module__.startswith("numba"):
                _tell(function.__name__)
                if _program:
                    _program[0] += 1

        def on_end(self, happened: Any) -> None:
            self.depth -= 1
            if not self.depth and not _program:
                _tell(None)

    event.register("numba:compile", Told())
    return numba


def _inner_machine(inline: bool = False) -> Any:
    """Return the compiler of functions that only machine code calls.

    Kernels make no arrays, so nothing has to count who holds one (which cost as much as a
    closed loop itself).
    """
    return _numba().njit(
        error_model="numpy",
        nogil=True,
        _nrt=False,
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
        forceinline=inline,
    )


@contextlib.contextmanager
def _linked_only(codegen: Any) -> Iterator[None]:
    """Have numba neither optimise functions nor make native code of them for now.

    They are linked into others, which it is done for anyway: a third of the time of compiling.
    """
    library = _library_without_native_code()
    codegen._library_class = library
    codegen.set_env = lambda *_: None  # belongs to native code
    try:
        yield
    finally:
        del codegen._library_class, codegen.set_env


@contextlib.contextmanager
def _counted_from_the_front() -> Iterator[None]:
    """Have numba take every index as it is: kernels never count from the end of an array.

    It would look at each whether it is negative, and bring both ends of each slice into the
    array; three instructions an element are a third of the time of a rule base at a point. Only
    the end of a slice may lie behind the array. The tests run kernels on arrays that refuse the
    rest.
    """
    from numba.core import types
    from numba.cpython import slicing
    from numba.np import arrayobj

    def as_it_is(context: Any, builder: Any, kind: Any, index: Any, _size: Any) -> Any:
        return context.cast(builder, index, kind, types.intp)

    def ended(builder: Any, part: Any, size: Any) -> None:
        part.stop = builder.select(builder.icmp_signed(">=", part.stop, size), size, part.stop)

    before = arrayobj.fix_integer_index, slicing.fix_slice
    arrayobj.fix_integer_index, slicing.fix_slice = as_it_is, ended
    try:
        yield
    finally:
        arrayobj.fix_integer_index, slicing.fix_slice = before


@functools.cache
def _library_without_native_code() -> Any:
    from numba.core.codegen import JITCodeLibrary

    class Linked(JITCodeLibrary):  # type: ignore[misc]
        def _finalize_final_module(self) -> None:
            self._finalize_dynamic_globals()
            self._verify_declare_only_symbols()
            self._finalized = True

        def _optimize_final_module(self) -> None:
            pass  # what it is linked into is optimised as a whole

        def get_pointer_to_function(self, name: str) -> int:
            return 0

    return Linked


def _compile(
    function: Callable[..., None], types: str, bindings: _Bindings, symbol: str, inline: bool
) -> tuple[bytes, bool]:
    """Compile a function behind an entry of C: a pointer and a length for each array.

    Returns the object file, and whether it is complete without numba.
    """
    machine = _inner_machine(inline)
    from llvmlite import ir
    from numba import types as numba_types
    from numba.core.compiler_lock import global_compiler_lock
    from numba.np.arrayobj import populate_array

    inner = machine(_clone(function, bindings, {}, machine, root=True))
    scalars = {"f": numba_types.float64, "i": numba_types.int64}
    signature = tuple(numba_types.Array(scalars[letter], 1, "C") for letter in types)
    context = inner.targetctx
    with global_compiler_lock, _linked_only(context.codegen()), _counted_from_the_front():
        inner.compile(signature)
    made = inner.overloads[signature]
    word, eight = ir.IntType(64), ir.Constant(ir.IntType(64), 8)
    pointers = [context.get_value_type(kind.dtype).as_pointer() for kind in signature]

    with global_compiler_lock:
        library = context.codegen().create_library(symbol)
        library.enable_object_caching()
        module = context.create_module(symbol)
        kind = ir.FunctionType(ir.VoidType(), [each for p in pointers for each in (p, word)])
        entry = ir.Function(module, kind, symbol)
        builder = ir.IRBuilder(entry.append_basic_block())
        arrays = []
        for array_type, data, size in zip(
            signature, entry.args[::2], entry.args[1::2], strict=True
        ):
            array = context.make_array(array_type)(context, builder)
            populate_array(array, data, [size], [eight], eight, None)
            arrays.append(array._getvalue())
        conventions = context.call_conv
        called = ir.Function(
            module,
            conventions.get_function_type(numba_types.none, signature),
            made.fndesc.llvm_func_name,
        )
        conventions.call_function(builder, called, numba_types.none, signature, arrays)
        builder.ret_void()
        library.add_ir_module(module)
        whole = library._final_module
        whole.link_in(made.library._get_module_for_linking(), preserve=True)
        # Inner functions of other files may have the same names, bound to other kernels.
        for each in (*whole.functions, *whole.global_variables):
            if not each.is_declaration and each.name != symbol:
                each.linkage = "internal"
        library.finalize()
        outside = [each.name for each in library._final_module.functions if each.is_declaration]
        return library._get_compiled_object(), not any(map(_only_with_numba, outside))


def _only_with_numba(symbol: str) -> bool:
    """Whether a symbol is one that the process has only after numba is imported."""
    return symbol.lower().startswith(("numba", "nrt_", "py", "_py", "__svml"))


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
            data = builder.bitcast(array.data, pointer)
            passed += [data, cgutils.unpack_tuple(builder, array.shape, 1)[0]]
        entry = ir.FunctionType(ir.VoidType(), [pointer, word] * len(signature.args[1]))
        builder.call(builder.inttoptr(address, entry.as_pointer()), passed)
        return context.get_dummy_value()

    def typed(context: Any, address: Any, *arrays: Any) -> Any:
        return types.void(types.int64, types.StarArgTuple(arrays)), generate

    return intrinsic(typed)


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

    numba = _numba()
    # Only the root can be called from Python.
    root = _clone(function, bindings, {}, _inner_machine(), root=True)
    root.__qualname__ = f"{root.__qualname__}_{_source_digest(function, bindings)}"
    machine = functools.partial(numba.njit, error_model="numpy", nogil=True, _nrt=False)
    try:
        made = machine(root, cache=True)
    except RuntimeError:  # neither the package folder nor the user's can be written
        return cast(Callable[..., Any], machine(root))
    _forgive(made._cache)
    return cast(Callable[..., Any], made)


def _forgive(cache: Any) -> None:
    """Have numba compile again where its file is damaged, and go on where it cannot write one.

    Its files get the checksum of ours: damaged machine code can be unpickled, and would run.
    """
    import pickle

    file = cache._cache_file

    def load_data(name: str) -> Any:
        code = _read_code(Path(file._data_path(name)))
        if code is None:
            raise ValueError(f"{name} is damaged")
        return pickle.loads(code)

    def save_data(name: str, data: Any) -> None:
        code = file._dump(data)
        with file._open_for_write(file._data_path(name)) as opened:
            opened.write(_head(code) + code)

    file._load_data, file._save_data = load_data, save_data
    load, save = cache.load_overload, cache.save_overload

    def load_overload(*given: Any) -> Any:
        try:
            return load(*given)
        except Exception:  # whatever unpickling nonsense may raise
            try:
                cache.flush()
            except OSError:
                cache.disable()
            return None

    def save_overload(*given: Any) -> None:
        try:
            save(*given)
        except Exception:  # the index may be damaged, too
            cache.disable()

    cache.load_overload, cache.save_overload = load_overload, save_overload


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
        return call if finish is _as_it_is else _machine_call()
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
    if not hasattr(function, _MARK):
        whole.update(vars(function)["__source__"].encode())
        return whole.hexdigest()[:16]
    for name, bound in sorted(bindings.items()):
        whole.update(f"{name}={bound.__module__}.{bound.__qualname__};".encode())
    reached = _reached(function, bindings)
    for file in sorted({cast(FunctionType, each).__code__.co_filename for each in reached}):
        whole.update(Path(file).read_bytes())
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
