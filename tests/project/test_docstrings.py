"""Docstrings and signatures stay together."""

import ast
import re
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src" / "fuzzyarm"
MODULES = sorted(SOURCE.rglob("*.py"))


def public_functions(tree):
    """Yield public functions and methods of a module."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            yield node
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
                    yield inner


def section(docstring, title):
    """Return the lines of a numpydoc section."""
    pattern = rf"(?ms)^{title}\n-+\n(.*?)(?=^[A-Z]\w+\n-+\n|\Z)"
    match = re.search(pattern, docstring)
    return match.group(1) if match else None


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(SOURCE)))
def test_documented_parameters_exist(path):
    for function in public_functions(ast.parse(path.read_text())):
        text = ast.get_docstring(function)
        assert text, f"{path.name}: {function.name} has no docstring"
        described = section(text, "Parameters")
        if described is None:
            continue
        names = re.findall(r"(?m)^([*\w][*\w, ]*) : ", described)
        documented = {name.strip("* ") for group in names for name in group.split(",")}
        arguments = function.args
        real = {a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)}
        real |= {a.arg for a in (arguments.vararg, arguments.kwarg) if a}
        assert documented <= real, f"{path.name}: {function.name} documents {documented - real}"
