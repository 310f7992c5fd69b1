"""Run tests against a copy of the source, in processes forked from this one.

This one has imported what tests need beside fuzzyarm, which takes longer than most tests. A run
without any change tells which functions each test calls.
"""

from __future__ import annotations

import gc
import hashlib
import importlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Container, Sequence
from importlib.metadata import entry_points
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, NamedTuple

import pytest
from hypothesis import Phase, settings

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = Path("src") / "fuzzyarm"

LONGEST = 400
"""Seconds until a run is taken to hang."""

MEMORY = 6 << 30
"""Bytes that a process may take."""

HEAVY = (
    "numpy", "scipy.optimize", "scipy.integrate", "scipy.signal", "scipy.stats",
    "matplotlib.figure", "hypothesis.strategies", "hypothesis.extra.numpy", "rich.console",
)  # fmt: skip
"""What a test would import anew in each process."""

Write = Callable[[str, Any], None]
"""How a process reports: what kind of thing it says, and what."""


def import_what_is_heavy() -> None:
    """Import what tests need beside fuzzyarm, for all processes to come."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # threads do not survive a fork
    for name in HEAVY:
        importlib.import_module(name)
    for plugin in entry_points(group="pytest11"):
        plugin.load()
    assert "fuzzyarm" not in sys.modules
    gc.freeze()


class Outcome(NamedTuple):
    """What a process reported: the tests that failed, and rows of its own."""

    failed: list[str]
    rows: list[Any]


class SourceCopy:
    """A copy of the source in which one file at a time is changed."""

    def __init__(self, home: Path) -> None:
        self.home = home
        shutil.copytree(ROOT / "src", home / "src")  # with what is compiled, and its times
        for name in ("rulebases", "examples", "docs"):  # which the package looks for beside it
            (home / name).symlink_to(ROOT / name)
        self.machine_code = MachineCode(self)
        self.changes = 0

    def change(self, file: str, source: bytes) -> str | None:
        """Put another source into a file; return who refuses to compile it."""
        (self.home / file).write_bytes(source)
        # The compiled file of a module goes by the second of its source: each change has its own.
        self.changes += 1
        os.utime(self.home / file, (self.changes, self.changes))
        return self.machine_code.follow(Path(file).relative_to(PACKAGE).parts[0])

    def take_back(self, file: str) -> None:
        """Have a file as it was."""
        shutil.copy2(ROOT / file, self.home / file)
        self.machine_code.take_back()

    def run(self, plugin: TestRun, files: Sequence[str], seconds: float) -> Outcome:
        """Run tests of some files, for so many seconds of the processor at most."""

        def run_tests(write: Write) -> None:
            plugin.write = write
            status = pytest.main(["-q", "-n0", *plugin.words, *files], plugins=[plugin])
            is_over = status not in (pytest.ExitCode.INTERNAL_ERROR, pytest.ExitCode.USAGE_ERROR)
            write("end" if is_over else "failed", "before any test")

        return self.forked(run_tests, seconds)

    def forked(self, work: Callable[[Write], None], seconds: float) -> Outcome:
        """Do something in a process that has this copy as its fuzzyarm.

        Where it dies, or takes too long, the test that it was in has failed.
        """
        report = self.home / "report"
        report.write_bytes(b"")
        process = os.fork()
        if not process:
            self._work(work, report, int(seconds))
        deadline = time.monotonic() + max(LONGEST, 4 * seconds)
        while not os.waitpid(process, os.WNOHANG)[0]:
            if time.monotonic() > deadline:
                os.killpg(process, signal.SIGKILL)
            time.sleep(0.02)
        _end_group(process)
        rows = [json.loads(line) for line in report.read_text("utf-8").splitlines()]
        failed = [what for kind, what in rows if kind == "failed"]
        if rows and rows[-1][0] == "test":
            failed.append(rows[-1][1])
        return Outcome(failed, [what for kind, what in rows if kind == "row"])

    def _work(self, work: Callable[[Write], None], report: Path, seconds: int) -> None:
        try:
            os.setsid()
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
            resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
            nowhere = os.open(os.devnull, os.O_RDWR)
            for stream in range(3):
                os.dup2(nowhere, stream)
            os.chdir(ROOT)
            source = str(self.home / "src")
            sys.path.insert(0, source)
            os.environ["PYTHONPATH"] = source
            with report.open("a", encoding="utf-8", buffering=1) as lines:
                work(lambda kind, what: print(json.dumps([kind, what]), file=lines))
        finally:
            os._exit(0)


def _end_group(leader: int) -> None:
    """End what a process has left behind."""
    try:
        os.killpg(leader, signal.SIGKILL)
    except ProcessLookupError:
        return


class MachineCode:
    """The compiled kernels of a copy, which are those of its source at any time."""

    def __init__(self, copy: SourceCopy) -> None:
        self.copy = copy
        self.is_other = False
        self.path = next((copy.home / PACKAGE).glob("_kernels.*"), None)
        self.folders: list[str] = []
        if self.path is not None:  # otherwise there is no compiler: all kernels are interpreted
            self.folders, self.c, self.digest = self._printed()
            if self.digest.encode() not in self.path.read_bytes():
                self._compile()
            self.built = self.path.read_bytes()

    def follow(self, package: str) -> str | None:
        """Have the machine code of a changed package; return who refuses to compile it."""
        if package not in self.folders:
            return None
        printed = self._printed()
        if printed is None:
            return "the translation of kernels"
        _, c, digest = printed
        if c == self.c and package != "native":
            # It is the same machine code, and says from which sources it is.
            self._replace(self.built.replace(self.digest.encode(), digest.encode()))
            return None
        self.is_other = True
        return None if self._compile() else "the compiler of kernels"

    def take_back(self) -> None:
        """Have it as it was."""
        self.is_other = False
        if self.path is not None and self.path.read_bytes() != self.built:
            self._replace(self.built)

    def _replace(self, content: bytes) -> None:
        assert self.path is not None
        unfinished = self.path.with_suffix(".unfinished")
        unfinished.write_bytes(content)
        unfinished.replace(self.path)  # a process that has it open keeps the old one

    def _printed(self) -> Any:
        """Return the packages with kernels, a digest of their C and one of their source."""
        rows = self.copy.forked(_print_kernels, LONGEST).rows
        return rows[0] if rows else None

    def _compile(self) -> bool:
        source = str(self.copy.home / "src")
        environment = {**os.environ, "PYTHONPATH": source, "FUZZYARM_NATIVE": "0"}
        command = [sys.executable, "-m", "fuzzyarm.native.build"]
        done = subprocess.run(command, env=environment, capture_output=True, check=False)
        return done.returncode == 0


def _print_kernels(write: Write) -> None:
    from fuzzyarm.kernels import SOURCE_FOLDERS, digest_of_sources  # noqa: PLC0415, of the copy
    from fuzzyarm.native.printing import kernels_in_c  # noqa: PLC0415
    from fuzzyarm.native.roots import roots  # noqa: PLC0415

    c = hashlib.sha256(repr(kernels_in_c(roots())).encode()).hexdigest()
    write("row", [[*SOURCE_FOLDERS, "kernels.py"], c, digest_of_sources()])


class TestRun:
    """A plugin of pytest that runs some tests in their order, until one fails.

    Parameters
    ----------
    tests : sequence of str
        Names of functions.
    without : container of str
        Tests, with their parameters, that are left out.
    long : bool
        Whether those run that `--quick` leaves out, or the others.
    """

    __test__ = False
    words = ("-x",)

    def __init__(self, tests: Sequence[str], without: Container[str], *, long: bool) -> None:
        self.ranks = {name: rank for rank, name in enumerate(tests)}
        self.without, self.long = without, long
        self.write: Write

    @pytest.hookimpl(trylast=True)
    def pytest_configure(self) -> None:
        """Draw the same cases each time; what fails need not be made small."""
        settings.register_profile(
            "once", settings.get_profile("fuzzyarm"), derandomize=True, database=None,
            phases=(Phase.explicit, Phase.generate),
        )  # fmt: skip
        settings.load_profile("once")

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[Any]) -> None:
        conftest = config.pluginmanager.getplugin(str(ROOT / "tests" / "conftest.py"))
        assert conftest is not None
        items[:] = [item for item in items if conftest.is_long(item) == self.long]
        self.select(items)

    def select(self, items: list[Any]) -> None:
        """Take those that are wanted, in their order."""
        wanted = [item for item in items if name_of(item.nodeid) in self.ranks]
        items[:] = [item for item in wanted if item.nodeid not in self.without]
        items.sort(key=lambda item: self.ranks[name_of(item.nodeid)])

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.write("test", nodeid)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.write("failed", report.nodeid)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self.write("failed", report.nodeid)


class TracedRun(TestRun):
    """One of all tests, which tells which functions each of them calls and how long it takes.

    A row has the test, "" for the collection, its seconds, and for each file of the source the
    first lines of functions, 0 for the module itself.
    """

    words = ()

    def __init__(self, source: Path, *, long: bool) -> None:
        super().__init__((), (), long=long)
        self.prefix = f"{source}{os.sep}"
        self.codes: dict[int, CodeType] = {}

    def select(self, items: list[Any]) -> None:
        """Take all."""

    def _start(self) -> None:
        self.called: set[int] = set()
        self.since = time.process_time()
        sys.settrace(self._trace)  # which a test may have taken away

    def _trace(self, frame: FrameType, _event: str, _argument: object) -> None:
        code = frame.f_code
        if id(code) not in self.called:
            self.called.add(id(code))
            self.codes[id(code)] = code  # and keep it, or another would get its identity

    def _stop(self, test: str) -> None:
        seconds = time.process_time() - self.since
        called, self.called = self.called, set()  # which this function joins
        lines = defaultdict(set)
        for number in called:
            code = self.codes[number]
            if code.co_filename.startswith(self.prefix):
                line = 0 if code.co_name == "<module>" else code.co_firstlineno
                lines[code.co_filename.removeprefix(self.prefix)].add(line)
        self.write("row", [test, seconds, {file: sorted(of) for file, of in lines.items()}])

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection(self) -> None:
        threading.settrace(self._trace)
        self._start()

    def pytest_collection_finish(self) -> None:
        self._stop("")

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        super().pytest_runtest_logstart(nodeid)
        self._start()

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        self._stop(nodeid)


def name_of(test: str) -> str:
    """Return the function of a test, whatever its parameters."""
    return test.partition("[")[0]
