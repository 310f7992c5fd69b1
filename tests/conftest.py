"""Shared fixtures and options of the test suite."""

from __future__ import annotations

import functools
import gc
import importlib.util
import inspect
import os
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

os.environ["FUZZYARM_PROGRESS"] = "0"  # a machine under load must not say more than another
# Tests fill all cores by themselves: threads of a BLAS would only wait for each other, busily.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import budget
import pytest
from hypothesis import settings

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.kernels import digest_of_c

# Tests that are collected and trees of syntax that are kept end with the process. To search them
# for cycles again and again takes longer than to make them.
gc.set_threshold(200_000)

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # What is run in the background ignores Ctrl-C, and each process that a test starts would, too.
    signal.signal(signal.SIGINT, signal.default_int_handler)

sys.modules["tests.budget"] = budget  # one module under both names, so that --thorough reaches all

ROOT = Path(__file__).resolve().parent.parent


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden",
        action="store_true",
        help="run only the tests of written files and pages, which rewrite them",
    )
    parser.addoption(
        "--thorough",
        action="store_true",
        help="take all random cases and all cells of a matrix, not some of them",
    )
    parser.addoption(
        "--quick",
        action="store_true",
        help="leave out what takes over 0.4 s, a browser, a compiler, a process or the pages",
    )
    parser.addoption("--write-skipped", metavar="FILE", help="list the tests that were skipped")
    parser.addoption("--run-skipped", metavar="FILE", help="run only the tests of such a list")


def pytest_configure(config: pytest.Config) -> None:
    """Say how many cases are wanted, before modules with settings are imported."""
    budget.take_all(bool(config.getoption("--thorough")))
    examples = budget.cases(20, 100)
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
    if there and digest_of_c().encode() in there:
        return
    command = [sys.executable, "-m", "fuzzyarm.apps.native.build"]
    subprocess.run(command, env={**os.environ, "FUZZYARM_NATIVE": "0"}, check=False)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Have every other worker read the folders backwards.

    In a fresh clone each file of tests has to be compiled first, some 18 s of a processor. Two
    workers that go towards each other compile half of the files each, and find the rest compiled.
    """
    report = yield
    if is_odd(collector.config) and isinstance(collector, pytest.Dir | pytest.Package):
        report.result.reverse()
    return report


def is_odd(config: pytest.Config) -> bool:
    """Whether this is a process of xdist with an odd number."""
    worker = getattr(config, "workerinput", {}).get("workerid", "gw0")
    return int(worker.removeprefix("gw")) % 2 == 1


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Do not even read files that hold nothing for ``--quick``, or for ``--run-skipped``."""
    if config.getoption("--quick") and is_of_pages(collection_path):
        return True
    listed = config.getoption("--run-skipped")
    if listed and collection_path.suffix == ".py":
        _, files = skipped_tests(listed)
        name = collection_path.relative_to(config.rootpath).as_posix()
        return None if name in files else True
    return None


@functools.cache
def skipped_tests(listed: str) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names in a list, of tests or of whole files, and the files that they are in."""
    names = frozenset(Path(listed).read_text("utf-8").splitlines())
    return names, frozenset(name.split("::")[0] for name in names)


def is_of_pages(path: Path) -> bool:
    """Whether a file of tests is about pages, of the documentation or in a browser."""
    return path.parent.name == "docs" or path.stem.endswith("_page")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Run what is marked slow last; leave out what the options do not ask for.

    Of what is slow that goes first which says how many seconds it takes: what another worker has
    begun cannot be taken from it, so a long test at the end would leave the other core idle.
    """
    if hasattr(config, "workerinput"):  # all of them with the same order, see above
        items.sort(key=lambda item: item.path.parts)
    items.sort(key=seconds_of)
    if config.getoption("--run-skipped"):
        skipped, _ = skipped_tests(config.getoption("--run-skipped"))
        keep(config, items, lambda item: {item.nodeid, item.nodeid.split("::")[0]} & skipped)
    if config.getoption("--update-golden"):
        keep(config, items, lambda item: "update_golden" in item.fixturenames)
    if config.getoption("--quick"):
        keep(config, items, lambda item: not is_long(item))


def keep(config: pytest.Config, items: list[pytest.Item], wanted: Callable[[Any], object]) -> None:
    """Leave out the tests that are not wanted."""
    chosen: dict[bool, list[pytest.Item]] = {True: [], False: []}
    for item in items:
        chosen[bool(wanted(item))].append(item)
    config.hook.pytest_deselected(items=chosen[False])
    items[:] = chosen[True]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say in one line for each reason how many tests, or whole modules, were skipped."""
    reports = terminalreporter.stats.get("skipped", [])
    skipped = {report.nodeid: report.longrepr[2].removeprefix("Skipped: ") for report in reports}
    for reason, count in Counter(skipped.values()).most_common():
        terminalreporter.write_line(f"skipped {count}: {reason}")
    written = terminalreporter.config.getoption("--write-skipped")
    if written:
        Path(written).write_text("".join(f"{each}\n" for each in skipped), "utf-8")


def pytest_collection_finish() -> None:
    """Keep what stays until the end, tests and modules, out of each search for cycles."""
    gc.collect()
    gc.freeze()


def seconds_of(item: pytest.Item) -> tuple[bool, float]:
    """Return the key of an order: whether a test is slow, and the seconds that it says it takes."""
    slow = item.get_closest_marker("slow")
    return slow is not None, -float(slow.kwargs.get("seconds", 0)) if slow else 0.0


STARTING = {"run_c", "compile_c", "need", "need_avr", "COMPILER", "NODE", "subprocess"}
"""What a test uses that compiles or starts a process: by itself or by a function beside it."""


def is_long(item: pytest.Item) -> bool:
    """Whether a test is slow, or of a browser, a compiler, another process or a page."""
    assert isinstance(item, pytest.Function)
    return (
        item.get_closest_marker("slow") is not None
        or bool({"browser", "runner"} & set(item.fixturenames))
        or is_of_pages(item.path)
        or starts(inspect.unwrap(item.function))
    )


@functools.cache
def starts(function: Callable[..., object]) -> bool:
    """Whether a function, or one of its module that it calls, reads one of `STARTING`."""
    seen = {function}
    for each in (waiting := [function]):  # it grows on the way
        called = starts_or_calls(each)
        if called is None:
            return True
        new = called - seen
        seen |= new
        waiting += new
    return False


@functools.cache
def starts_or_calls(function: Callable[..., object]) -> frozenset[Callable[..., object]] | None:
    """Return the functions of its module that a function calls; nothing if itself it starts."""
    code = function.__code__
    if STARTING & {*code.co_names, *code.co_varnames[: code.co_argcount]}:
        return None
    beside = (function.__globals__.get(name) for name in code.co_names)
    return frozenset(inspect.unwrap(each) for each in beside if inspect.isfunction(each))


@pytest.fixture
def update_golden(request: pytest.FixtureRequest) -> bool:
    """Whether golden files are to be rewritten."""
    return bool(request.config.getoption("--update-golden"))


@pytest.fixture(scope="session")
def pd7() -> RuleBase:
    """The PD-type rule base with exact centroid, as shipped."""
    from fuzzyarm.language import load_rulebase

    return load_rulebase(ROOT / "rulebases" / "pd7.frb")
