"""Docstrings and signatures stay together."""

import ast
import re

from sources import MODULES, SOURCE, tree


def is_overload(function):
    """Say whether a function is a signature of another only."""
    return any(isinstance(d, ast.Name) and d.id == "overload" for d in function.decorator_list)


def public_functions(tree):
    """Yield public functions and methods of a module."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            if not is_overload(node):  # the function itself has the docstring
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


def mistake(function):
    """Return what is wrong with the docstring of a function, or nothing."""
    text = ast.get_docstring(function)
    if not text:
        return "has no docstring"
    names = re.findall(r"(?m)^([*\w][*\w, ]*) : ", section(text, "Parameters") or "")
    documented = {name.strip("* ") for group in names for name in group.split(",")}
    arguments = function.args
    real = {a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)}
    real |= {a.arg for a in (arguments.vararg, arguments.kwarg) if a}
    return f"documents {documented - real}" if documented - real else ""


def test_documented_parameters_exist():
    functions = [(path, function) for path in MODULES for function in public_functions(tree(path))]
    assert len(functions) > len(MODULES)
    assert [
        f"{path.relative_to(SOURCE)}: {function.name} {said}"
        for path, function in functions
        if (said := mistake(function))
    ] == []


def test_a_mistake_is_seen():
    def of(text):
        return mistake(ast.parse(text).body[0])

    text = 'def f(x, *rest):\n    """Do.\n\n    Parameters\n    ----------\n    {} : int\n    """'
    assert not of(text.format("x, *rest"))
    assert of(text.format("x, *y")) == "documents {'y'}"
    assert of("def f(x):\n    return x") == "has no docstring"
