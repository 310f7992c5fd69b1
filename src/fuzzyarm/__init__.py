"""Fuzzy control from a text file to a robot arm.

The packages stand on each other in one direction::

    rulebase, formats  →  inference  →  lut  →  arm  →  control  →  study, show  →  cli, lsp

:mod:`fuzzyarm.rulebase` reads, checks and prints rule files; :mod:`fuzzyarm.inference`
evaluates them; :mod:`fuzzyarm.lut` compiles them to lookup tables; :mod:`fuzzyarm.arm` is
the plant; :mod:`fuzzyarm.control` has the controllers; :mod:`fuzzyarm.study` has the
published experiments; :mod:`fuzzyarm.show` draws. Importing this page is instant: what a
name needs is loaded when the name is used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fuzzyarm.api import check_file, check_text, load
    from fuzzyarm.errors import FuzzyarmError
    from fuzzyarm.inference import compiled, explain, infer
    from fuzzyarm.lut import (
        LookupTable,
        compile_table,
        compile_with_report,
        read_table,
        write_table,
    )
    from fuzzyarm.rulebase import RuleBase, RuleBaseError, parse, write
    from fuzzyarm.shipped_files import shipped

__version__ = "0.1.0"

__all__ = [
    "FuzzyarmError",
    "LookupTable",
    "RuleBase",
    "RuleBaseError",
    "check_file",
    "check_text",
    "compile_table",
    "compile_with_report",
    "compiled",
    "explain",
    "infer",
    "load",
    "parse",
    "read_table",
    "shipped",
    "write",
    "write_table",
]

_HOMES = {
    "FuzzyarmError": "errors",
    "LookupTable": "lut",
    "RuleBase": "rulebase",
    "RuleBaseError": "rulebase",
    "check_file": "api",
    "check_text": "api",
    "compile_table": "lut",
    "compile_with_report": "lut",
    "compiled": "inference",
    "explain": "inference",
    "infer": "inference",
    "load": "api",
    "parse": "rulebase",
    "read_table": "lut",
    "shipped": "shipped_files",
    "write": "rulebase",
    "write_table": "lut",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'fuzzyarm' has no attribute '{name}'")
    import importlib

    return getattr(importlib.import_module(f"fuzzyarm.{_HOMES[name]}"), name)
