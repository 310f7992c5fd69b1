"""What `import fuzzyarm` offers."""

import importlib
import subprocess
import sys

import pytest

import fuzzyarm


def test_dir_lists_the_public_names_only():
    assert set(dir(fuzzyarm)) == {*fuzzyarm.__all__, "__version__"}
    assert {"infer", "kinds", "load", "op"} <= set(fuzzyarm.__all__)


@pytest.mark.parametrize("name", fuzzyarm.__all__)
def test_every_public_name_is_there(name):
    assert getattr(fuzzyarm, name) is not None


def test_a_name_that_is_not_there():
    with pytest.raises(AttributeError, match="has no attribute 'kind'"):
        _ = fuzzyarm.kind


def test_kinds_and_operations_are_reached_without_anything_heavy():
    code = "import sys; from fuzzyarm import kinds, op; print(op.pi, 'numpy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "3.141592653589793 False\n"


@pytest.mark.parametrize("package", ["cli", "show", "show.figures", "lsp", "studio"])
def test_packages_list_what_is_public(package):
    module = importlib.import_module(f"fuzzyarm.{package}")
    assert module.__all__ == sorted(module.__all__)
    assert all(hasattr(module, name) and not name.startswith("_") for name in module.__all__)
