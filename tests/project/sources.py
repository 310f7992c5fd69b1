"""The modules of the package, each read once for all tests that look at its text."""

import ast
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "fuzzyarm"
MODULES = sorted(SOURCE.rglob("*.py"))


@cache
def tree(path):
    """Return the syntax tree of a module."""
    return ast.parse(path.read_text("utf-8"))


@cache
def nodes_of(path):
    """Return all nodes of the tree of a module."""
    return list(ast.walk(tree(path)))
