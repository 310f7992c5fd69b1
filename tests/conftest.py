"""Shared fixtures and options of the test suite."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

os.environ["FUZZYARM_PROGRESS"] = "0"  # a machine under load must not say more than another

import budget
import pytest
from hypothesis import settings

from fuzzyarm.kernels import digest_of_sources
from fuzzyarm.model.rulebase import RuleBase

ROOT = Path(__file__).resolve().parent.parent


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden",
        action="store_true",
        help="rewrite golden files with what the code prints now",
    )
    parser.addoption(
        "--thorough", action="store_true", help="take all random cases, not the first ones"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Say how many cases are wanted, before modules with settings are imported."""
    budget.take_all(bool(config.getoption("--thorough")))
    examples = budget.cases(33, 100)
    settings.register_profile(
        "fuzzyarm", deadline=None, derandomize=True, print_blob=True, max_examples=examples
    )
    settings.load_profile("fuzzyarm")
    if not hasattr(config, "workerinput"):  # before there are several processes
        build_kernels()


def build_kernels() -> None:
    """Build the machine code anew after an edit of a kernel; without a compiler it stays away."""
    module = importlib.util.find_spec("fuzzyarm._kernels")
    # Its bytes are looked at: a module that is loaded stays what it is.
    there = module and module.origin and Path(module.origin).read_bytes()
    if there and digest_of_sources().encode() in there:
        return
    command = [sys.executable, "-m", "fuzzyarm.native.build"]
    subprocess.run(command, env={**os.environ, "FUZZYARM_NATIVE": "0"}, check=False)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run what is marked slow last."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is not None)


@pytest.fixture
def update_golden(request: pytest.FixtureRequest) -> bool:
    """Whether golden files are to be rewritten."""
    return bool(request.config.getoption("--update-golden"))


@pytest.fixture(scope="session")
def pd7() -> RuleBase:
    """The PD-type rule base with exact centroid, as shipped."""
    from fuzzyarm.language import load_rulebase

    return load_rulebase(ROOT / "rulebases" / "pd7.frb")
