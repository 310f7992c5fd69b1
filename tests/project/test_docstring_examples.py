"""The examples of docstrings are executed, all of them in one process."""

import doctest
import importlib
from pathlib import Path

import pytest

import fuzzyarm
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS

SOURCE = Path(fuzzyarm.__file__).parent
MODULES = sorted(
    ".".join(("fuzzyarm", *path.relative_to(SOURCE).with_suffix("").parts)).removesuffix(
        ".__init__"
    )
    for path in SOURCE.rglob("*.py")
    if ">>> " in path.read_text("utf-8")
)


@pytest.fixture(autouse=True)
def _kinds_of_examples():
    """Take back the kinds that an example registers: other tests list all there are."""
    registries = (SHAPES, TNORMS, SNORMS, HEDGES, DEFUZZIFIERS)
    before = [set(registry) for registry in registries]
    yield
    for registry, names in zip(registries, before, strict=True):
        for name in set(registry) - names:
            registry.remove(name)


def test_there_are_examples():
    assert {"fuzzyarm", "fuzzyarm.apps.builder.rulebase", "fuzzyarm.inference.infer"} <= set(
        MODULES
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", MODULES)
def test_examples_say_what_comes_out(name, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    module = importlib.import_module(name)
    done = doctest.testmod(module, optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    assert done.attempted > 0
    assert done.failed == 0


def test_no_example_is_skipped():
    skipped = [path for path in SOURCE.rglob("*.py") if "doctest: +SKIP" in path.read_text("utf-8")]
    assert skipped == []
