"""Machine code of kernels: how it is compiled, kept in files and loaded.

A file is a line with a checksum and behind it an object file of the platform, in which one symbol
takes a pointer and a length for each array. It lies beside the module of its function (where that
folder cannot be written, in a folder of the user) under a name that carries a digest. A file that
is damaged is made again, and one that cannot be written is gone without.

Compiling needs numba; loading needs llvmlite alone, which takes a tenth of the time.
"""

from __future__ import annotations

import contextlib
import functools
import importlib.util
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

# --- Files ---

_VERSIONS = 8
"""Files of one function that stay: other sources, other processors on a shared disk."""


def folders_of(function: Callable[..., Any]) -> list[Path]:
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


def read_code(path: Path) -> bytes | None:
    """Return the code in a file; None where there is no such file or it is damaged."""
    try:
        head, line_end, code = path.read_bytes().partition(b"\n")
    except OSError:
        return None
    return code if head + line_end == checksum_of(code) else None


def checksum_of(code: bytes) -> bytes:
    """Return the first line of a file with this code."""
    from hashlib import sha256

    return f"fuzzyarm-code 1 {sha256(code).hexdigest()}\n".encode()


def keep_code(code: bytes, folders: Sequence[Path], label: str, digest: str) -> None:
    """Write a file into the first folder that takes it; of old ones only some stay."""
    from fuzzyarm.text.files import write_atomically

    for folder in folders:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            write_atomically(folder / f"{label}.{digest}.code", checksum_of(code) + code)
        except OSError:  # read-only, or the disk is full
            continue
        with contextlib.suppress(OSError):  # another process may tidy up, too
            known = sorted(folder.glob(f"{label}.*.code"), key=lambda each: each.stat().st_mtime)
            for old in known[:-_VERSIONS]:
                old.unlink()
        return


def made_by() -> str:
    """Return what machine code depends on beside its source: compiler and processor."""
    import platform

    import llvmlite.binding as llvm

    processor = f"{llvm.get_host_cpu_name()};{llvm.get_host_cpu_features().flatten()}"
    return f"{platform.python_version()};{llvm.get_default_triple()};{processor};{_numba_version()}"


@functools.cache
def _numba_version() -> str:
    """Return what tells one numba from another, without importing it."""
    spec = importlib.util.find_spec("numba")
    folders = spec.submodule_search_locations if spec is not None else None
    return (Path(next(iter(folders))) / "_version.py").read_text("utf-8") if folders else ""


def load_code(code: bytes, symbol: str) -> tuple[int, Any]:
    """Return the address of a symbol in an object file, and what must live as long.

    Each file gets an engine of its own: numba numbers the functions inside a file anew in every
    process, so two files may call different functions by one name; in one engine the second
    would get those of the first.
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


def tell_begun(name: str) -> None:
    """Tell who watches that a function is begun, here or elsewhere, and count it."""
    _tell(name)
    if _program:
        _program[0] += 1


@contextlib.contextmanager
def telling(name: str, functions: int) -> Iterator[None]:
    """Count functions while they are compiled; within another count they are part of that."""
    if _program:
        yield
        return
    _program[:] = [0, functions]
    _tell(name)  # importing the compiler takes a second, too
    try:
        yield
    finally:
        _program.clear()
        _tell(None)


@functools.cache
def numba_itself() -> Any:
    """Import numba, and have it tell who watches what it compiles."""
    import numba
    from numba.core import event

    class Told(event.Listener):  # type: ignore[misc]
        depth = 0

        def on_start(self, happened: Any) -> None:
            self.depth += 1
            function = happened.data["dispatcher"].py_func
            if not function.__module__.startswith("numba"):
                tell_begun(function.__name__)

        def on_end(self, happened: Any) -> None:
            self.depth -= 1
            if not self.depth and not _program:
                _tell(None)

    event.register("numba:compile", Told())
    return numba


def inner_compiler(inline: bool = False) -> Any:
    """Return the compiler of functions that only machine code calls.

    Kernels make no arrays, so nothing has to count who holds one (which cost as much as a
    closed loop itself).
    """
    return numba_itself().njit(
        error_model="numpy",
        nogil=True,
        _nrt=False,
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
        forceinline=inline,
        pipeline_class=_short_pipeline(),
    )


_LEFT_OUT = {
    "AnnotateTypes",
    "DeadBranchPrune",
    "DumpParforDiagnostics",
    "InlineInlinables",
    "InlineOverloads",
    "LiteralPropagationSubPipelinePass",
    "LiteralUnroll",
    "MakeFunctionToJitFunction",
    "NopythonRewrites",
    "WithLifting",
}
"""Passes of numba for what no kernel has: arguments that are None, array expressions, ``with``."""


@functools.cache
def _short_pipeline() -> Any:
    from numba.core.compiler import CompilerBase, DefaultPassBuilder
    from numba.core.compiler_machinery import PassManager

    class Short(CompilerBase):  # type: ignore[misc]
        def define_pipelines(self) -> list[Any]:
            manager = PassManager("kernels")
            for each, what in DefaultPassBuilder.define_nopython_pipeline(self.state).passes:
                if each.__name__ not in _LEFT_OUT:
                    manager.add_pass(each, what)
            manager.finalize()
            return [manager]

    return Short


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
    """Have numba take every index as it is: our kernels never count from the end of an array.

    It would look at each whether it is negative, and bring both ends of each slice into the
    array; three instructions an element are a third of the time of a rule base at a point. Only
    the end of a slice may lie behind the array. The tests run kernels on arrays that refuse the
    rest. In the equations of a user indices mean what they mean in Python.
    """
    from numba.core import types
    from numba.cpython import slicing
    from numba.np import arrayobj

    before = arrayobj.fix_integer_index, slicing.fix_slice

    def as_it_is(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
        if not _is_ours(builder.function.name):
            return before[0](context, builder, kind, index, size)
        return context.cast(builder, index, kind, types.intp)

    def ended(builder: Any, part: Any, size: Any) -> None:
        if not _is_ours(builder.function.name):
            before[1](builder, part, size)
            return
        part.stop = builder.select(builder.icmp_signed(">=", part.stop, size), size, part.stop)

    arrayobj.fix_integer_index, slicing.fix_slice = as_it_is, ended
    try:
        yield
    finally:
        arrayobj.fix_integer_index, slicing.fix_slice = before


def _is_ours(symbol: str) -> bool:
    """Whether a function, by its name as numba mangles it, stands in a module of this package."""
    return symbol.startswith("_ZN8fuzzyarm")


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


@contextlib.contextmanager
def _loops_as_they_are(codegen: Any) -> Iterator[None]:
    """Have LLVM neither unroll loops nor take several numbers at a time for now."""
    import llvmlite.binding as llvm
    from numba import config

    def builder(**options: Any) -> Any:
        # Whether numba wants them vectorised is among the options, and is not asked.
        tuning = llvm.create_pipeline_tuning_options(int(options.get("opt", config.OPT)))
        tuning.loop_unrolling = tuning.loop_vectorization = tuning.slp_vectorization = False
        return llvm.create_pass_builder(codegen._tm, tuning)

    codegen._pass_builder = builder
    try:
        yield
    finally:
        del codegen._pass_builder


def compile_entry(
    inner: Any, letters: str, symbol: str, *, scalar: bool = False
) -> tuple[bytes, bool]:
    """Compile a function behind an entry of C: a pointer and a length for each array.

    Parameters
    ----------
    inner : numba dispatcher
        Made by :func:`inner_compiler`.
    letters : str
        Of each array: ``f`` for float64, ``i`` for int64.
    symbol : str
        What the entry is called.
    scalar : bool, optional
        Whether its loops are short, see :func:`fuzzyarm.kernels.scalar`.

    Returns
    -------
    bytes
        The object file.
    bool
        Whether it is complete without numba.
    """
    from llvmlite import ir
    from numba import types as numba_types
    from numba.core.compiler_lock import global_compiler_lock
    from numba.np.arrayobj import populate_array

    scalars = {"f": numba_types.float64, "i": numba_types.int64}
    signature = tuple(numba_types.Array(scalars[letter], 1, "C") for letter in letters)
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
        codegen = context.codegen()
        with _loops_as_they_are(codegen) if scalar else contextlib.nullcontext():
            library.finalize()
        outside = [each.name for each in library._final_module.functions if each.is_declaration]
        return library._get_compiled_object(), not any(map(_only_with_numba, outside))


def _only_with_numba(symbol: str) -> bool:
    """Whether a symbol is one that the process has only after numba is imported."""
    return symbol.lower().startswith(("numba", "nrt_", "py", "_py", "__svml"))


@functools.cache
def call_of_machine() -> Any:
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


# --- Functions that numba keeps by itself ---


def forgive(cache: Any) -> None:
    """Have numba compile again where its file is damaged, and go on where it cannot write one.

    Its files get the checksum of ours: damaged machine code can be unpickled, and would run.
    """
    import pickle

    file = cache._cache_file

    def load_data(name: str) -> Any:
        code = read_code(Path(file._data_path(name)))
        if code is None:
            raise ValueError(f"{name} is damaged")
        return pickle.loads(code)

    def save_data(name: str, data: Any) -> None:
        code = file._dump(data)
        with file._open_for_write(file._data_path(name)) as opened:
            opened.write(checksum_of(code) + code)

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
