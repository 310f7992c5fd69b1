"""Fuzzy control from a text file to a robot arm.

The packages stand on each other in one direction::

    text  →  model  →  language, formats  →  inference  →  table  →  export
    plant  →  controller  →  proof, loop  →  learning, study
    show  →  lsp, studio  →  cli

:mod:`fuzzyarm.language` reads, checks and prints rule files; :mod:`fuzzyarm.inference`
evaluates them; :mod:`fuzzyarm.table` compiles them to lookup tables; :mod:`fuzzyarm.plant` is
the arm, :mod:`fuzzyarm.controller` has the controllers and :mod:`fuzzyarm.loop` closes the
loop; :mod:`fuzzyarm.proof` says what holds everywhere; :mod:`fuzzyarm.learning` makes rule bases
from samples, :mod:`fuzzyarm.sklearn` as estimators; :mod:`fuzzyarm.study` has the published
experiments; :mod:`fuzzyarm.show` draws.
Importing this page is instant: what a name needs is loaded when the name is used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fuzzyarm.version import __version__ as __version__

if TYPE_CHECKING:
    from fuzzyarm.api import FileWarning, check_file, check_text, load
    from fuzzyarm.errors import FuzzyarmError
    from fuzzyarm.expression import kinds, op
    from fuzzyarm.inference import compiled, explain, infer, infer_interval
    from fuzzyarm.language import parse, write
    from fuzzyarm.loop import simulate, simulate_many
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.proof import prove
    from fuzzyarm.shipped_files import shipped
    from fuzzyarm.table import (
        LookupTable,
        compile_table,
        compile_with_report,
        read_table,
        write_table,
    )
    from fuzzyarm.text.diagnostic import RuleBaseError

__all__ = [
    "FileWarning",
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
    "infer_interval",
    "kinds",
    "load",
    "op",
    "parse",
    "prove",
    "read_table",
    "shipped",
    "simulate",
    "simulate_many",
    "write",
    "write_table",
]

_HOMES = {
    "api": ("FileWarning", "check_file", "check_text", "load"),
    "errors": ("FuzzyarmError",),
    "expression.kinds": ("kinds",),
    "expression.op": ("op",),
    "inference": ("compiled", "explain", "infer", "infer_interval"),
    "language": ("RuleBase", "RuleBaseError", "parse", "write"),
    "loop": ("simulate", "simulate_many"),
    "proof": ("prove",),
    "shipped_files": ("shipped",),
    "table": ("LookupTable", "compile_table", "compile_with_report", "read_table", "write_table"),
}
"""Module → the names that it has, or the one that it is."""


def __getattr__(name: str) -> Any:
    import importlib

    for home, names in _HOMES.items():
        if name in names:
            module = importlib.import_module(f"fuzzyarm.{home}")
            return module if home.endswith(f".{name}") else getattr(module, name)
    raise AttributeError(f"module 'fuzzyarm' has no attribute '{name}'")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
