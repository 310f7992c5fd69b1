"""Cross-compilation beside the compiler: headers and symbols of Python.

The headers of the stable ABI are the same everywhere except for ``pyconfig.h``, which describes the
platform of an installation. Windows looks up every symbol in a named library at link time; its
import library is made of the names in the headers.
"""

from __future__ import annotations

import re
import shutil
import sysconfig
from pathlib import Path

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
    """Return the declarations of Python's public headers: names, and whether each is data.

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
