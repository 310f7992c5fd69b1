"""Interpreted and compiled kernels, laziness, and the cache on disk."""

import errno
import itertools
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_kernels import added, called_by_address, doubled, tripled_all

from fuzzyarm import kernels, machine_code
from fuzzyarm.kernels import address_of, build, in_threads, jit_wanted, kernel, routine

SMALL_KERNELS = str(Path(__file__).parent)
"""Where a process of its own finds `small_kernels`."""


def test_bindings_replace_functions_deep_down():
    @kernel
    def tripled(x):
        return 3.0 * x

    assert build(added, compiled=False)(2.0, 1.0) == 5.0
    assert build(added, {"doubled": tripled}, compiled=False)(2.0, 1.0) == 7.0
    assert added(2.0, 1.0) == 5.0


@pytest.mark.slow
def test_compiled_equals_interpreted():
    assert build(added, compiled=True)(0.1, 0.2) == added(0.1, 0.2)


@pytest.mark.parametrize(
    ("value", "wanted"), [("0", False), ("off", False), ("1", True), (None, True)]
)
def test_environment_switches_compilation(monkeypatch, value, wanted):
    if value is None:
        monkeypatch.delenv(kernels.SWITCH, raising=False)
    else:
        monkeypatch.setenv(kernels.SWITCH, value)
    assert jit_wanted() is wanted


def new_process(code, **environment):
    return subprocess.Popen(
        [sys.executable, "-c", code],
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def told_by(process):
    printed, errors = process.communicate()
    assert (process.returncode, errors) == (0, "")
    return json.loads(printed)


def in_new_process(code, **environment):
    return told_by(new_process(code, **environment))


def test_importing_does_not_load_numba_or_scipy_or_matplotlib():
    code = (
        "import sys, json, fuzzyarm.plant, fuzzyarm.controller, fuzzyarm.loop, fuzzyarm.study, "
        "fuzzyarm.study.identify, fuzzyarm.study.figures;"
        "heavy = ('numba', 'scipy', 'matplotlib', 'rich');"
        "print(json.dumps([m for m in heavy if m in sys.modules]))"
    )
    assert in_new_process(code) == []


def test_interpreted_run_does_not_load_numba():
    code = (
        "import sys, json;from fuzzyarm.plant import reach;"
        "from fuzzyarm.controller import *;from fuzzyarm.loop import *;"
        "run = simulate(controller('pd'), reach(segment=0.1, hold=0.1));"
        "print(json.dumps([run.compiled, 'numba' in sys.modules]))"
    )
    assert in_new_process(code, FUZZYARM_NATIVE="0") == [False, False]


def test_digest_tells_bindings_apart_that_live_in_one_file():
    from fuzzyarm.loop.loop import run_loop
    from fuzzyarm.plant.setting import stored_double, stored_single

    both = (stored_double, stored_single)
    digests = {kernels._source_digest(run_loop, {"stored": each}) for each in both}
    assert len(digests) == 2


ALL_WAYS = """
import json, sys
import numpy as np
from fuzzyarm import compiled, machine_code
from fuzzyarm.controller import controller
from fuzzyarm.language import load_rulebase
from fuzzyarm.shipped_files import shipped
from fuzzyarm.table import read_table
from fuzzyarm.loop import simulate
from fuzzyarm.plant import reach
from fuzzyarm.table import lookup
lookup.ONCE_LOADED = lookup.WORTH_LOADING = 0
told = []
machine_code.watch_compiling(told.append)
x = np.linspace(-6.0, 6.0, 7)
run = simulate(controller("pd"), reach(segment=0.1, hold=0.1))
control = compiled(load_rulebase(shipped("pd7.frb")))(e=x, ce=x[::-1])
light = "numba" not in sys.modules
table = read_table(shipped("thesis-6.1.lut")).lookup(x, x[::-1])
print(json.dumps([list(run.rms), control["u"].tolist(), table.tolist(), light, len(told)]))
"""
"""Runs a loop, a rule base and a table; tells whether the first two went without numba, and how
much was compiled."""


@pytest.mark.slow
def test_a_second_process_compiles_nothing_of_a_loop_a_rule_base_and_a_table():
    # In the folders that everybody has: what the first process compiles, other tests use.
    *first, _, _ = in_new_process(ALL_WAYS, FUZZYARM_NATIVE="1")
    assert in_new_process(ALL_WAYS, FUZZYARM_NATIVE="1") == [*first, True, 0]
    assert in_new_process(ALL_WAYS, FUZZYARM_NATIVE="0") == [*first, True, 0]


def small_process(code, folder, compiled=True):
    """Begin a process that keeps machine code of small kernels in a folder of its own.

    Such a folder stands for that of a package that cannot be written, too.
    """
    path = os.pathsep.join([SMALL_KERNELS, *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {"NUMBA_CACHE_DIR": str(folder), "FUZZYARM_NATIVE": str(int(compiled))}
    return new_process(code, **environment, PYTHONPATH=path)


def of_small_kernels(code, folder, compiled=True):
    return told_by(small_process(code, folder, compiled))


IN_ORDER = """
import json, sys
import numpy as np
from fuzzyarm.kernels import jit_wanted, routine
from fuzzyarm.plant.setting import stored_double, stored_single
from small_kernels import turned_all
found = []
for stored in {order}:
    values = np.array([1.0, 2.0, 3.0])
    routine(turned_all, "f", {{"stored": stored}}, compiled=jit_wanted())(values)
    found.append(values.tolist())
print(json.dumps([found, "numba" in sys.modules]))
"""


@pytest.mark.slow
def test_machine_code_of_two_processes_does_not_mix_in_a_third(tmp_path):
    # Both programs have inner functions that numba calls by the same names.
    alone = {}
    for stored in ("stored_single", "stored_double"):
        code = IN_ORDER.format(order=f"[{stored}]")
        (alone[stored],), compiled = of_small_kernels(code, tmp_path)
        assert compiled
    assert alone["stored_single"] == np.float32(alone["stored_single"]).tolist()
    assert alone["stored_single"] != alone["stored_double"]
    for order in (["stored_single", "stored_double"], ["stored_double", "stored_single"]):
        code = IN_ORDER.format(order=f"[{', '.join(order)}]")
        assert of_small_kernels(code, tmp_path) == [[alone[each] for each in order], False]


@pytest.mark.slow
def test_files_of_one_kernel_with_other_bindings_do_not_mix(tmp_path):
    code = IN_ORDER.format(order="[stored_double, stored_single, stored_double]")
    wanted, _ = of_small_kernels(code, tmp_path, compiled=False)
    assert wanted[0] != wanted[1]
    assert of_small_kernels(code, tmp_path) == [wanted, True]
    assert of_small_kernels(code, tmp_path) == [wanted, False]


SMALL_PROGRAMS = """
import json
import numpy as np
from fuzzyarm import machine_code
from fuzzyarm.kernels import address_of, build, jit_wanted, routine
from small_kernels import added, called_by_address, tripled_all
told, compiled = [], jit_wanted()
machine_code.watch_compiling(told.append)
values, counts = np.array([1.0, 2.0, 3.0]), np.array([4])
addresses = np.array([address_of(tripled_all, 1, compiled=compiled)])
routine(called_by_address, "fii", compiled=compiled)(values, counts, addresses)
total = build(added, compiled=compiled)(0.1, 0.2)
names = [each and each.name for each in told]
print(json.dumps([values.tolist(), counts.tolist(), total, names]))
"""
"""Runs small kernels by address and by numba itself; tells what was compiled."""

COMPUTED = [[1.0, 6.0, 9.0], [5], 0.1 * 2.0 + 0.2]


def truncated(files):
    for path in files:
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def emptied(files):
    for path in files:
        path.write_bytes(b"")


def overwritten(files):
    for path in files:
        path.write_bytes(b"\x80\x04nonsense" + bytes(path.stat().st_size))


def one_bit_flipped(files):
    for path in files:
        content = bytearray(path.read_bytes())
        content[-len(content) // 3] ^= 4  # among the instructions
        path.write_bytes(content)


@pytest.mark.slow
@pytest.mark.parametrize("damage", [truncated, emptied, overwritten, one_bit_flipped])
def test_a_damaged_cache_heals(tmp_path, kept_code, damage):
    cache = shutil.copytree(kept_code, tmp_path / "cache")
    damage([path for path in cache.rglob("*") if path.is_file()])
    *found, told = of_small_kernels(SMALL_PROGRAMS, cache)
    assert found == COMPUTED
    assert {"tripled_all", "called_by_address"} <= set(told)
    assert told[-1] is None
    assert of_small_kernels(SMALL_PROGRAMS, cache) == [*COMPUTED, []]


@pytest.fixture(scope="module")
def kept_code(tmp_path_factory):
    """Return a cache that two processes filled at the same time."""
    folder = tmp_path_factory.mktemp("cache")
    processes = [small_process(SMALL_PROGRAMS, folder) for _ in range(2)]
    for process in processes:
        assert told_by(process)[:-1] == COMPUTED
    return folder


@pytest.mark.slow
def test_two_processes_at_once_fill_one_cache(kept_code):
    assert of_small_kernels(SMALL_PROGRAMS, kept_code) == [*COMPUTED, []]
    assert len(list(kept_code.glob("*.code"))) == 2
    assert not list(kept_code.rglob("*.part"))
    assert of_small_kernels(SMALL_PROGRAMS, kept_code, compiled=False) == [*COMPUTED, []]


@pytest.mark.slow
def test_a_full_disk_under_the_cache(tmp_path):
    pytest.importorskip("resource")
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (99, 99))\n"
    for _ in range(2):
        *found, told = of_small_kernels(limit + SMALL_PROGRAMS, tmp_path)
        assert found == COMPUTED
        assert {"tripled_all", "called_by_address"} <= set(told)
    assert not [path for path in tmp_path.rglob("*") if path.is_file() and path.stat().st_size]


@pytest.mark.slow
def test_a_cache_that_cannot_be_written(tmp_path):
    # Permissions do not stop the superuser; a file in the place of a folder does.
    (tmp_path / "file").write_bytes(b"")
    *found, _ = of_small_kernels(SMALL_PROGRAMS, tmp_path / "file" / "cache")
    assert found == COMPUTED


@given(st.binary(max_size=300), st.data())
def test_code_is_read_as_it_was_written_or_not_at_all(code, data):
    whole = machine_code.checksum_of(code) + code
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.code"
        assert machine_code.read_code(path) is None
        path.write_bytes(whole)
        assert machine_code.read_code(path) == code
        begin = data.draw(st.integers(0, len(whole)))
        end = data.draw(st.integers(begin, len(whole)))
        damaged = whole[:begin] + data.draw(st.binary(max_size=20)) + whole[end:]
        path.write_bytes(damaged)
        assert machine_code.read_code(path) == (code if damaged == whole else None)
        path.unlink()
        path.mkdir()
        assert machine_code.read_code(path) is None


def test_without_a_home_only_the_folder_of_the_package_is_used(monkeypatch):
    for name in ("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    (only,) = machine_code.folders_of(doubled)
    assert only == Path(__file__).parent / "__pycache__"


@pytest.mark.slow
@pytest.mark.parametrize("compiled", [False, True])
def test_kernels_call_by_address(tmp_path, monkeypatch, compiled):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    addresses = np.array([address_of(tripled_all, 1, compiled=compiled)])
    values, counts = np.array([1.0, 2.0, 3.0]), np.array([4])
    routine(called_by_address, "fii", compiled=compiled)(values, counts, addresses)
    assert values.tolist() == [1.0, 6.0, 9.0]
    assert counts.tolist() == [5]


@pytest.mark.slow
def test_a_routine_refuses_arrays_that_machine_code_would_misread():
    run = routine(tripled_all, "f", compiled=True)
    with pytest.raises(TypeError, match="array of float64 is needed, not one of int64"):
        run(np.array([1, 2]))
    with pytest.raises(TypeError, match="contiguous"):
        run(np.zeros((3, 3))[:, 0])


@pytest.mark.slow
def test_what_cannot_be_kept_is_compiled_all_the_same(tmp_path, monkeypatch):
    @kernel
    def halved_all(values):
        for i in range(len(values)):
            values[i] = 0.5 * values[i]

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("fuzzyarm.text.files.write_atomically", full)
    values = np.array([1.0, 3.0])
    routine(halved_all, "f", compiled=True)(values)
    assert values.tolist() == [0.5, 1.5]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_damaged_files_of_numba_are_compiled_again(tmp_path):
    code = (
        "import json; from fuzzyarm.kernels import build; from small_kernels import doubled;"
        "run = build(doubled, compiled=True);"
        "print(json.dumps([run(3.0), sum(run.stats.cache_hits.values())]))"
    )
    assert of_small_kernels(code, tmp_path) == [6.0, 0]
    for suffix, damage in ((".nbi", emptied), (".nbc", overwritten), (".nbc", one_bit_flipped)):
        damage(list(tmp_path.rglob(f"*{suffix}")))
        assert of_small_kernels(code, tmp_path) == [6.0, 0]
        assert of_small_kernels(code, tmp_path) == [6.0, 1]


def test_digest_covers_every_kernel_file(monkeypatch):
    from fuzzyarm.controller.law import summed_drives
    from fuzzyarm.controller.on_plant import text_law
    from fuzzyarm.loop.loop import run_loop

    read = []
    real = kernels.Path.read_bytes

    def watched(path):
        read.append(path.name)
        return real(path)

    monkeypatch.setattr(kernels.Path, "read_bytes", watched)
    kernels._source_digest(run_loop, {"control": summed_drives})
    assert {"loop.py", "setting.py", "law.py", "kernels.py", "machine_code.py"} <= set(read)
    read.clear()
    kernels._source_digest(text_law, {})
    assert {"on_plant.py", "kernel.py", "lookup.py", "setting.py"} <= set(read)


def test_machine_code_of_what_was_imported_before_its_file_changed_is_nobody_elses(monkeypatch):
    from fuzzyarm.loop.loop import run_loop

    file = run_loop.__code__.co_filename
    before = kernels._source_digest(run_loop, {})
    monkeypatch.setitem(kernels._loaded, file, (0, 0))
    changed = kernels._source_digest(run_loop, {})
    assert changed == kernels._source_digest(run_loop, {}) != before
    monkeypatch.setattr(kernels, "_THIS_PROCESS", b"another")
    assert kernels._source_digest(run_loop, {}) not in {before, changed}


@pytest.mark.slow
def test_without_any_writable_folder_it_compiles_anew(monkeypatch):
    from numba.core.caching import CompileResultCacheImpl

    monkeypatch.setattr(CompileResultCacheImpl, "_locator_classes", [])
    assert build(added, compiled=True)(0.1, 0.2) == added(0.1, 0.2)


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
        "import json, os, threading, warnings; from fuzzyarm.kernels import in_threads;"
        "warnings.simplefilter('ignore');"
        "work = lambda: in_threads(lambda _, b=threading.Barrier(2, timeout=60): b.wait(), [], 2);"
        "work(); child = os.fork(); found = sorted(work());"
        "child or os._exit(7 if found == [0, 1] else 1);"
        "print(json.dumps([found, os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])]))"
    )
    assert in_new_process(code) == [[0, 1], 7]
