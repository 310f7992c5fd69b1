"""Kernels as they stand: bindings, the switch, laziness, threads."""

import itertools
import json
import os
import subprocess
import sys
import threading
import time

import pytest

from fuzzyarm.symbolic import kernels
from fuzzyarm.symbolic.kernels import has_machine_code, in_threads, kernel, with_names


@kernel
def doubled(x):
    return 2.0 * x


@kernel
def added(x, y):
    return doubled(x) + y


def test_bindings_replace_functions_deep_down():
    @kernel
    def tripled(x):
        return 3.0 * x

    assert with_names(added, {})(2.0, 1.0) == 5.0
    assert with_names(added, {"doubled": tripled})(2.0, 1.0) == 7.0
    assert added(2.0, 1.0) == 5.0


@pytest.mark.parametrize(
    ("value", "wanted"), [("0", False), ("off", False), ("1", True), (None, True)]
)
def test_environment_switches_machine_code(monkeypatch, value, wanted):
    if value is None:
        monkeypatch.delenv(kernels.SWITCH, raising=False)
    else:
        monkeypatch.setenv(kernels.SWITCH, value)
    assert has_machine_code() is wanted


def in_new_process(code, **environment):
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **environment}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


def test_importing_does_not_load_scipy_or_matplotlib():
    code = (
        "import sys, json, fuzzyarm.plant, fuzzyarm.control.controllers, fuzzyarm.control.loop, "
        "fuzzyarm.apps.study, "
        "fuzzyarm.apps.study.identify, fuzzyarm.apps.study.figures;"
        "heavy = ('numba', 'scipy', 'matplotlib', 'rich');"
        "print(json.dumps([m for m in heavy if m in sys.modules]))"
    )
    assert in_new_process(code) == []


def test_threads_share_what_there_is_to_do():
    parts = in_threads(list, range(1000), 4)
    assert len(parts) <= 4
    assert sorted(itertools.chain(*parts)) == list(range(1000))
    assert in_threads(lambda _: threading.get_ident(), [], 1) == [threading.get_ident()]


def test_threads_work_at_the_same_time():
    together = threading.Barrier(2, timeout=60)
    assert sorted(in_threads(lambda _: together.wait(), [], 2)) == [0, 1]


def test_what_a_thread_raises_comes_back():
    together = threading.Barrier(2, timeout=60)

    def fail_elsewhere(_):
        together.wait()
        if threading.current_thread() is not threading.main_thread():
            raise ValueError("elsewhere")

    with pytest.raises(ValueError, match="elsewhere"):
        in_threads(fail_elsewhere, [], 2)


def test_after_an_exception_nothing_more_is_begun():
    together = threading.Barrier(2, timeout=60)
    taken = []

    def fail_here(numbers):
        together.wait()
        if threading.current_thread() is threading.main_thread():
            raise KeyboardInterrupt
        for number in numbers:
            taken.append(number)
            time.sleep(0.01)

    with pytest.raises(KeyboardInterrupt):
        in_threads(fail_here, range(1_000_000), 2)
    assert len(taken) < 1_000_000


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_a_forked_process_has_threads_of_its_own():
    code = (
        "import json, os, threading, warnings; from fuzzyarm.symbolic.kernels import in_threads;"
        "warnings.simplefilter('ignore');"
        "work = lambda: in_threads(lambda _, b=threading.Barrier(2, timeout=60): b.wait(), [], 2);"
        "work(); child = os.fork(); found = sorted(work());"
        "child or os._exit(7 if found == [0, 1] else 1);"
        "print(json.dumps([found, os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])]))"
    )
    assert in_new_process(code) == [[0, 1], 7]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
@pytest.mark.parametrize("wait", [0.0, 0.02])
def test_a_process_forked_beside_a_first_call_of_another_thread_does_not_hang(wait):
    # The other thread imports what the call needs; the child must not wait for its locks.
    code = (
        "import faulthandler, json, os, threading, time, warnings; warnings.simplefilter('ignore');"
        "import fuzzyarm; pd7 = fuzzyarm.load(fuzzyarm.shipped('pd7.frb'));"
        "call = lambda: fuzzyarm.infer(pd7, e=1.0, ce=0.5)['u'];"
        "other = threading.Thread(target=call); other.start();"
        f"time.sleep({wait}); child = os.fork();"
        "child or faulthandler.dump_traceback_later(60, exit=True);"
        "child or os._exit(7 if call() == 1.0 else 1);"
        "other.join(); print(json.dumps(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])))"
    )
    assert in_new_process(code) == 7


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_a_lock_that_another_thread_held_is_free_in_a_forked_process():
    code = (
        "import json, os, threading, time, warnings; warnings.simplefilter('ignore');"
        "from fuzzyarm.symbolic.kernels import lock; held = lock(); taken = threading.Event();"
        "hold = lambda: (held.acquire(), taken.set(), time.sleep(0.5), held.release());"
        "other = threading.Thread(target=hold); other.start(); taken.wait(); child = os.fork();"
        "child or os._exit(7 if held.acquire(timeout=30) else 1);"
        "other.join(); print(json.dumps(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])))"
    )
    assert in_new_process(code) == 7
