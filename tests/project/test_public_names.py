"""What `import fuzzyarm` offers."""

import ast
import collections.abc
import dataclasses
import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
import typing
from pathlib import Path

import numpy as np
import pytest
from offenders import check_all

import fuzzyarm

ROOT = Path(__file__).parents[2]
PACKAGES = sorted(
    each.name
    for each in pkgutil.walk_packages(fuzzyarm.__path__, "fuzzyarm.")
    if each.ispkg or each.name.removeprefix("fuzzyarm.") in fuzzyarm.PACKAGES
)
"""What has public names: every package, and the modules that are public themselves."""


def test_dir_lists_the_public_names_only():
    assert set(dir(fuzzyarm)) == {*fuzzyarm.__all__, *fuzzyarm.PACKAGES, "__version__"}
    assert {"RuleBase", "infer", "kinds", "load", "op"} <= set(fuzzyarm.__all__)


def first_line(name):
    """Return the first line on a name, without the marks of markup."""
    line = inspect.getdoc(getattr(fuzzyarm, name)).splitlines()[0]
    return re.sub(r":\w+:`~?([^`]*)`", r"\1", line).replace("`", "")


def test_help_has_every_name_with_its_first_line():
    told = " ".join(fuzzyarm.__doc__.split()).replace("- ", "-")
    lines = [f" {name} {first_line(name)}" for name in (*fuzzyarm.__all__, *fuzzyarm.PACKAGES)]
    assert [line for line in lines if line.replace("- ", "-") not in told] == []


def test_every_public_name_is_there():
    assert [name for name in fuzzyarm.__all__ if getattr(fuzzyarm, name) is None] == []


@pytest.mark.parametrize("package", ["fuzzyarm", "fuzzyarm.table", "fuzzyarm.learning"])
def test_a_name_is_looked_up_once(package):
    """What is loaded is kept: every later access is that of any module, without a call."""
    code = (
        f"import {package} as package\n"
        "look, asked = package.__getattr__, []\n"
        "package.__getattr__ = lambda name: (asked.append(name), look(name))[1]\n"
        "first = [getattr(package, name) for name in package.__all__]\n"
        "count = len(asked)\n"
        "again = [getattr(package, name) for name in package.__all__]\n"
        "print(count > 0, len(asked) - count, all(a is b for a, b in zip(first, again)))\n"
        "print(sorted(package.__all__) == sorted(set(package.__all__) & set(vars(package))))\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "True 0 True\nTrue\n"


def test_a_name_that_is_not_there():
    with pytest.raises(AttributeError, match="has no attribute 'kind'"):
        _ = fuzzyarm.kind


def test_kinds_and_operations_are_reached_without_anything_heavy():
    code = "import sys; from fuzzyarm import kinds, op; print(op.pi, 'numpy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "3.141592653589793 False\n"


def holds_arrays(hint):
    """Whether a field's type is an array, or a container of arrays."""
    origin = typing.get_origin(hint)
    return origin is np.ndarray or (
        origin is not collections.abc.Callable and any(map(holds_arrays, typing.get_args(hint)))
    )


def has_arrays(kind):
    try:
        return any(map(holds_arrays, typing.get_type_hints(kind).values()))
    except NameError:  # a type imported for annotations only
        return False


def test_what_holds_arrays_is_compared_by_identity():
    modules = map(importlib.import_module, ("fuzzyarm", *PACKAGES))
    public = {getattr(module, name) for module in modules for name in module.__all__
              if isinstance(getattr(module, name), type)}  # fmt: skip
    holders = {each for each in public if dataclasses.is_dataclass(each) and has_arrays(each)}
    assert {fuzzyarm.control.loop.Run, fuzzyarm.learning.Snapshot} <= holders
    assert [kind.__name__ for kind in holders if kind.__dataclass_params__.eq] == []


def lists_what_is_public(package):
    module = importlib.import_module(package)
    names = module.__all__
    assert len(set(names)) == len(names)
    for name in names:
        value = getattr(module, name)
        assert not name.startswith("_")
        assert not callable(value) or inspect.getdoc(value), name
    assert not hasattr(module, "__path__") or set(dir(module)) == set(names)


def test_packages_list_what_is_public():
    check_all(PACKAGES, lists_what_is_public)


LISTED_FOR_OTHERS = {
    "fuzzyarm.symbolic.records", "fuzzyarm.symbolic.defuzzifiers",  # kinds has all of their names
    "fuzzyarm.apps.playground.arrays.kinds",  # the types of its numpy
    "fuzzyarm.plant.adapters",  # a face for plants of other packages, which loads them
}  # fmt: skip


def lists_no_names(name):
    module, room = (importlib.import_module(each) for each in (name, name.rpartition(".")[0]))
    leaf = name.rpartition(".")[2]
    public = leaf in getattr(room, "__all__", ()) and getattr(room, leaf) is module
    assert public or not hasattr(module, "__all__")


def test_private_modules_list_no_names():
    modules = {each.name for each in pkgutil.walk_packages(fuzzyarm.__path__, "fuzzyarm.")}
    private = {name for name in modules - {*PACKAGES} if not name.endswith("_kernels")}
    check_all(sorted(private - LISTED_FOR_OTHERS), lists_no_names)


def described(function):
    """Return the parameters that a docstring speaks of."""
    found = re.findall(r"(?m)^([*\w][*\w, ]*)(?: : |$)", inspect.getdoc(function))
    return {name.strip("* ") for group in found for name in group.split(",")}


OF_THE_LANGUAGE = ("fuzzyarm.language", "fuzzyarm.apps.lsp", "fuzzyarm.symbolic")
"""Packages whose functions other tools call: their first lines say it."""


def test_public_functions_describe_their_parameters():
    packages = [name for name in ("fuzzyarm", *PACKAGES) if not name.startswith(OF_THE_LANGUAGE)]
    functions = {
        f"{package}.{name}": getattr(importlib.import_module(package), name)
        for package in packages
        for name in importlib.import_module(package).__all__
    }
    missing = {
        name: set(inspect.signature(function).parameters) - described(function)
        for name, function in functions.items()
        if inspect.isfunction(function)
    }
    assert len(missing) > 100
    assert {name: parameters for name, parameters in missing.items() if parameters} == {}


def imports(text):
    """Yield (module, name) for every name that a text imports from fuzzyarm."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fuzzyarm"):
            yield from ((node.module, alias.name) for alias in node.names)


def shown_code():
    """Yield what pages and examples show."""
    for path in sorted((ROOT / "examples").glob("*.py")):
        yield path.name, path.read_text("utf-8")
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        for block in re.findall(r"(?ms)^```python\n(.*?)^```", path.read_text("utf-8")):
            yield path.name, block


def test_pages_and_examples_import_what_is_public():
    private = [
        (path, module, name)
        for path, text in shown_code()
        for module, name in imports(text)
        if name not in importlib.import_module(module).__dict__.get("__all__", ())
        and f"{module}.{name}" not in PACKAGES
    ]
    assert private == []
