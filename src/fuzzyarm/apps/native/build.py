"""The module with machine code: the kernels printed in C and compiled.

``python -m fuzzyarm.apps.native.build FOLDER`` writes ``_kernels`` into a folder, as the build of
the package and `make native` do. The compiler is the platform's, or else that of the
``ziglang`` wheel, which also compiles for other platforms, with headers and symbols of Python that
are written here.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from fuzzyarm.apps.native.printing import UNITS, kernels_in_c
from fuzzyarm.apps.native.roots import roots
from fuzzyarm.symbolic.kernels import note_digest, processors

# ── cross-compilation: headers and symbols of Python ─────────────────────────────────
#
# The headers of the stable ABI are the same everywhere except for ``pyconfig.h``, which describes
# the platform of an installation. Windows looks up every symbol in a named library at link time;
# its import library is made of the names in the headers.

_PYCONFIG = """\
/* What Python's headers ask of a platform, from the compiler itself. */
#ifndef Py_PYCONFIG_H
#define Py_PYCONFIG_H
#define SIZEOF_SHORT __SIZEOF_SHORT__
#define SIZEOF_INT __SIZEOF_INT__
#define SIZEOF_LONG __SIZEOF_LONG__
#define SIZEOF_LONG_LONG __SIZEOF_LONG_LONG__
#define SIZEOF_SIZE_T __SIZEOF_SIZE_T__
#define SIZEOF_VOID_P __SIZEOF_POINTER__
#define SIZEOF_WCHAR_T __SIZEOF_WCHAR_T__
#define SIZEOF_DOUBLE __SIZEOF_DOUBLE__
#define HAVE_STDINT_H 1
#define HAVE_INTTYPES_H 1
#define HAVE_SSIZE_T 1
#ifdef _WIN32
/* Symbols of python3.dll are imported, data as well. */
#define MS_WINDOWS 1
#define Py_ENABLE_SHARED 1
#define HAVE_DECLSPEC_DLL 1
#endif
#endif
"""

_DECLARED = re.compile(r"PyAPI_(FUNC|DATA)\s*\([^()]*\)\s*(_?Py\w+)")
_RENAMED = re.compile(r"^# *define +Py\w+ +(_Py\w+_SizeT)$", re.MULTILINE)
"""With ``PY_SSIZE_T_CLEAN``, functions that read formats have other names."""


def headers_for_any_platform(folder: Path) -> Path:
    """Write Python's headers for every platform into a folder."""
    headers = Path(sysconfig.get_path("include"))
    shutil.copytree(headers, folder, ignore=shutil.ignore_patterns("internal", "pyconfig*"))
    (folder / "pyconfig.h").write_text(_PYCONFIG, encoding="ascii")
    return folder


def declared_names(headers: Path) -> dict[str, bool]:
    """Return the names that Python's public headers declare, each with whether it is data.

    Some belong to later versions or to no stable ABI: a module that uses one fails to load, as on
    every platform.
    """
    names: dict[str, bool] = {}
    for header in sorted(headers.glob("*.h")):
        text = header.read_text(encoding="utf-8")
        names |= {match[2]: match[1] == "DATA" for match in _DECLARED.finditer(text)}
        names |= dict.fromkeys(_RENAMED.findall(text), False)
    return names


def definition_of_python3(headers: Path) -> str:
    """Return the definition file of ``python3.dll`` for the import library."""
    names = declared_names(headers)
    lines = [f"  {name} DATA" if data else f"  {name}" for name, data in names.items()]
    return "\n".join(["LIBRARY python3.dll", "EXPORTS", *lines, ""])


FLAGS = (
    # Bits as in Python: nothing is fused or reordered. Without errno and traps no result changes,
    # but square roots and comparisons can be vectorised.
    "-std=gnu99", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math",
    # GCC 12 drops a rounding to single precision when it packs two numbers into a vector.
    "-fno-tree-slp-vectorize",
    # The block of a rule base is read as integers and as floats.
    "-fno-strict-aliasing", "-fPIC", "-fvisibility=hidden",
)  # fmt: skip

OF_GCC_ALONE = frozenset(
    {"-fno-tree-loop-distribute-patterns", "--param=max-completely-peel-times=32"}
)
"""Flags unknown to clang: it warns, and that of the ``ziglang`` wheel refuses them."""

LEVELS = {"baseline": "", "v3": "x86-64-v3"}
"""Processors by level; the second for x86-64 only."""


# ── the compiler ─────────────────────────────────────────────────────────────────────


class BuildError(RuntimeError):
    """No compiler was found, or it failed."""


class Compiler(NamedTuple):
    """A compiler of C.

    Attributes
    ----------
    words : tuple of str
        Command line.
    machine : str
        Target machine: ``x86_64``, ``aarch64`` …
    system : str
        ``linux``, ``macos``, ``windows``, or ``emscripten`` for Python in a page (Pyodide).
    """

    words: tuple[str, ...]
    machine: str
    system: str

    @property
    def levels(self) -> dict[str, tuple[str, ...]]:
        """Flags of each level of the machine."""
        if self.machine != "x86_64":
            return {"baseline": ()}
        # The compiler of the wheel has its own spelling of processors.
        flags = {
            name: f"-mcpu={processor.replace('-', '_')}" if self.is_zig else f"-march={processor}"
            for name, processor in LEVELS.items()
            if processor
        }
        return {name: (flags[name],) if name in flags else () for name in LEVELS}

    @property
    def is_zig(self) -> bool:
        """Whether it is the compiler of the ``ziglang`` wheel."""
        return "ziglang" in self.words

    def compile(self, source: Path, result: Path, *flags: str) -> None:
        """Compile one file."""
        words = [word for word in (*FLAGS, *flags) if not (self.is_zig and word in OF_GCC_ALONE)]
        self.run("-c", str(source), "-o", str(result), *words)

    def link(self, objects: Sequence[Path], result: Path) -> None:
        """Link object files and libraries into an extension module."""
        if self.system == "emscripten":
            self._link_for_a_page(objects, result)
            return
        more = {
            "linux": ["-shared", "-lm"],
            "macos": ["-shared", "-undefined", "dynamic_lookup"],
            "windows": ["-shared"],
        }[self.system]
        if self.is_zig and self.system == "linux":
            more.append("-s")  # debug symbols would be three quarters of the size
        self.run(*map(str, objects), "-o", str(result), *more)

    def _link_for_a_page(self, objects: Sequence[Path], result: Path) -> None:
        """Link a WebAssembly module for Python in a page (Pyodide)."""
        # Undefined functions of C and of Python are resolved by that Python.
        flags = ("-shared", "--experimental-pic", "--import-memory", "--strip-all",
                 "--unresolved-symbols=import-dynamic", "--export=PyInit__kernels")  # fmt: skip
        linker = Compiler((*self.words[:3], "wasm-ld"), self.machine, self.system)
        linker.run(*flags, *map(str, objects), "-o", str(result))

    @property
    def is_for_here(self) -> bool:
        """Whether the target is the platform at hand."""
        return (self.machine, self.system) == (_own_machine(), _own_system())

    def import_library(self, definition: Path, result: Path) -> None:
        """Make the import library with the symbols of ``python3.dll`` for Windows."""
        tool = (*self.words[:3], "dlltool") if self.is_zig else ("dlltool",)
        machine = {"aarch64": "arm64"}.get(self.machine, "i386:x86-64")
        flags = ("-m", machine, "-d", str(definition), "-l", str(result))
        Compiler(tool, self.machine, self.system).run(*flags)

    def run(self, *words: str) -> None:
        """Run the compiler; BuildError, with its output, if it fails or cannot be started."""
        try:
            process = subprocess.run(
                [*self.words, *words], capture_output=True, text=True, check=False
            )
        except OSError as error:
            raise BuildError(f"{self.words[0]} could not be started: {error}") from None
        if process.returncode:
            raise BuildError(f"{shlex.join(self.words)} failed:\n{process.stderr.strip()}")


def find_compiler() -> Compiler:
    """Return the platform's compiler, or that of the ``ziglang`` wheel.

    ``CC`` overrides it, as usual.
    """
    machine, system = _own_machine(), _own_system()
    preferred = shlex.split(os.environ.get("CC", ""))
    for words in (preferred, ["cc"], ["gcc"], ["clang"]):
        if words and shutil.which(words[0]):
            return Compiler(tuple(words), machine, system)
    try:
        import ziglang  # noqa: F401
    except ImportError:
        raise BuildError("no C compiler: install one, or `pip install ziglang`") from None
    return zig(machine, system)


def zig(machine: str, system: str) -> Compiler:
    """Return the compiler of the ``ziglang`` wheel for any machine and system."""
    # With an explicit target, or it would compile for the processor at hand; with an old glibc and
    # macOS. The wheel has no headers of Emscripten, but those of WASI declare the same mathematics.
    target = {
        "linux": "linux-gnu.2.28",
        "macos": "macos.11.0",
        "windows": "windows-gnu",
        "emscripten": "wasi",
    }[system]
    words = [sys.executable, "-m", "ziglang", "cc", "-target", f"{machine}-{target}"]
    if system == "emscripten":  # supported by every browser with Pyodide
        words.append("-mcpu=mvp+bulk_memory+mutable_globals+nontrapping_fptoint+sign_ext+simd128")
    return Compiler(tuple(words), machine, system)


def _own_machine() -> str:
    """Return the machine at hand, by its name for compilers."""
    machine = platform.machine()
    return {"AMD64": "x86_64", "amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)


def _own_system() -> str:
    return {"darwin": "macos", "win32": "windows"}.get(sys.platform, "linux")


def build(folder: Path, compiler: Compiler | None = None) -> Path:
    """Build the module into a folder."""
    compiler = compiler or find_compiler()
    result = folder / f"_kernels{SUFFIXES[compiler.system]}"
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder_name:
        work = Path(folder_name)
        jobs = list(_jobs(work, compiler))
        with ThreadPoolExecutor(processors()) as pool:  # the compiler is another process
            list(pool.map(lambda job: compiler.compile(job.source, job.result, *job.flags), jobs))
        linked = work / result.name
        libraries = [_python3(work, compiler)] if compiler.system == "windows" else []
        compiler.link([*(job.result for job in jobs), *libraries], linked)
        unfinished = result.with_name(f".{result.name}.{os.getpid()}")
        shutil.copy2(linked, unfinished)
        unfinished.replace(result)  # a process with it open keeps the old one
    return result


class Compilation(NamedTuple):
    """A compilation: source, object file and additional flags."""

    source: Path
    result: Path
    flags: tuple[str, ...]


def _jobs(work: Path, compiler: Compiler) -> Iterator[Compilation]:
    """Write the source files; iterate over their compilations."""
    units = kernels_in_c(roots())
    for unit, text in units.items():
        source = work / f"{unit}.c"
        source.write_text(text, encoding="utf-8")
        for level, flags in compiler.levels.items():
            words = (f"-DTABLE={level}_{unit}", f"-DRUN_PROGRAM={level}_{unit}_program")
            yield Compilation(source, work / f"{level}_{unit}.o", (*flags, *UNITS[unit], *words))
    module = work / "module.c"
    digest = digest_of(units)
    note_digest(digest)
    sources = f'const char fuzzyarm_sources[] = "{digest}";\n'
    module.write_text(_module_source() + sources, encoding="utf-8")
    v3 = ["-DFUZZYARM_V3"] if "v3" in compiler.levels else []
    yield Compilation(module, work / "module.o", (f"-I{_headers(work, compiler)}", *v3))


def digest_of(units: Mapping[str, str]) -> str:
    """Return a digest of the build's inputs: C of the kernels, the module, the flags."""
    whole = [*sorted(units.items()), _module_source(), FLAGS, sorted(LEVELS.items()), UNITS]
    return sha256(repr(whole).encode()).hexdigest()


def _module_source() -> str:
    return Path(__file__).with_name("module.c").read_text(encoding="utf-8")


def _headers(work: Path, compiler: Compiler) -> Path:
    """Return the folder of Python's headers."""
    if compiler.is_for_here:
        return Path(sysconfig.get_path("include"))
    folder = work / "include"
    return folder if folder.exists() else headers_for_any_platform(folder)


def _python3(work: Path, compiler: Compiler) -> Path:
    """Write the import library of ``python3.dll``."""
    definition, library = work / "python3.def", work / "python3.lib"
    definition.write_text(definition_of_python3(_headers(work, compiler)), encoding="ascii")
    compiler.import_library(definition, library)
    return library


SUFFIXES = {"linux": ".abi3.so", "macos": ".abi3.so", "windows": ".pyd", "emscripten": ".so"}
"""Suffixes of modules with the stable ABI."""


def main() -> None:
    """Build into the given folder."""
    parser = argparse.ArgumentParser(description="build the machine code of fuzzyarm")
    parser.add_argument("folder", type=Path, nargs="?", default=Path(__file__).parents[2])
    parser.add_argument(
        "--platform", metavar="MACHINE-SYSTEM", help="by ziglang for another: aarch64-macos"
    )
    parser.add_argument(
        "--note", action="store_true", help="note the digest of the C, and build nothing"
    )
    arguments = parser.parse_args()
    if arguments.note:
        note_digest(digest_of(kernels_in_c(roots())))
        return
    platform_named = arguments.platform
    build(arguments.folder, zig(*platform_named.split("-")) if platform_named else None)


if __name__ == "__main__":
    main()
