"""What of a script would build a fuzzy system if it were called.

Told from its text alone, by the names of the classes of the libraries. Loaded by its path (see
:mod:`fuzzyarm.exchange.live.gather`): nothing but the standard library is used.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any, NamedTuple

SYSTEMS = frozenset({
    "ControlSystem", "ControlSystemSimulation", "FuzzySystem", "Engine",
    "IT2Mamdani", "IT2TSK", "IT2FLS", "T1Mamdani", "T1TSK",
})  # fmt: skip
"""Classes whose objects are systems."""

BY_HAND = frozenset({"interp_membership", "defuzz", "fuzzy_or", "fuzzy_and", "centroid"})
"""Functions with which a script computes by itself."""


class Builder(NamedTuple):
    """A function, a class or a method that builds a system when it is called."""

    name: str
    parameters: tuple[str, ...]  # those without a default

    @property
    def call(self) -> str:
        """How it is called."""
        return f"{self.name}({', '.join(self.parameters)})"


Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def builders(tree: ast.Module) -> list[Builder]:
    """Return what in a script builds a system, in the order of the text.

    A class counts where its constructor builds one; a method where it alone does. What calls one
    that counts, counts.
    """
    definitions = {node.name: node for node in tree.body if isinstance(node, Definition)}
    parts = dict(_parts(definitions))
    calls = {name: _called_names(body) for name, body in parts.items()}
    building = {name for name, words in calls.items() if words & SYSTEMS}
    while True:
        short = {_short(name) for name in building}
        more = {name for name, words in calls.items() if words & short} - building
        if not more:
            break
        building |= more
    candidates = [_builder(name, parts, building) for name in parts if name in building]
    return [candidate for candidate in candidates if candidate is not None]


def is_by_hand(tree: ast.Module) -> bool:
    """Whether a script computes with functions of scikit-fuzzy and makes no system."""
    words = _called_names(tree)
    return bool(words & BY_HAND) and not words & SYSTEMS


def _parts(definitions: dict[str, Definition]) -> Iterator[tuple[str, Any]]:
    """Yield functions, and methods as ``Class.method``."""
    for name, node in definitions.items():
        if not isinstance(node, ast.ClassDef):
            yield name, node
            continue
        for inner in node.body:
            if isinstance(inner, ast.FunctionDef | ast.AsyncFunctionDef):
                yield f"{name}.{inner.name}", inner


def _called_names(tree: ast.AST) -> set[str]:
    """Return the last words of everything that is called."""
    heads = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    attributes = {head.attr for head in heads if isinstance(head, ast.Attribute)}
    return attributes | {head.id for head in heads if isinstance(head, ast.Name)}


def _short(name: str) -> str:
    """Return the word by which something is called: a constructor by that of its class."""
    owner, _, last = name.rpartition(".")
    return owner if last == "__init__" else last


def _builder(name: str, parts: dict[str, Any], building: set[str]) -> Builder | None:
    owner, _, method = name.rpartition(".")
    if method == "__init__":
        return Builder(owner, _required(parts[name]))
    constructor = f"{owner}.__init__"
    if owner and (constructor in building or _required(parts.get(constructor))):
        return None  # an object has built one already, or asks for its own arguments
    return Builder(name, _required(parts[name]))


def _required(function: ast.FunctionDef | ast.AsyncFunctionDef | None) -> tuple[str, ...]:
    """Return the parameters without a default, except for that of the object itself."""
    if function is None:
        return ()
    arguments = function.args
    names = [argument.arg for argument in (*arguments.posonlyargs, *arguments.args)]
    names = names[: len(names) - len(arguments.defaults)]
    return tuple(name for name in names if name not in ("self", "cls"))
