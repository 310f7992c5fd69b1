"""Building the machine code: compilers that are there, fail, or are missing."""

import shutil
import subprocess
import sys

import numpy as np
import pytest

from fuzzyarm.apps.native import build as building
from fuzzyarm.apps.native import printing
from fuzzyarm.apps.native.build import BuildError, Compiler, build, find_compiler
from fuzzyarm.apps.native.printing import kernels_in_c
from fuzzyarm.apps.native.roots import Root, roots
from fuzzyarm.control.loop.loop import LoopBlock
from fuzzyarm.symbolic.kernels import call, kernel
from fuzzyarm.table import lookup

ONE = [Root(lookup.gather, "fsf", over_rows=True)]


def test_the_c_of_a_kernel():
    texts = kernels_in_c(ONE)
    assert "static inline void gather(reals values_, shorts index_, reals out_) {" in texts["rows"]
    row = '{"fuzzyarm.table.lookup.gather(fsf)", (void (*)(void))entry_0, spread_0, 4u},'
    assert row in texts["rows"]
    assert "gather" not in texts["numbers"]
    assert "const table_row TABLE[] = {" in texts["numbers"]


# --- Which arrays a kernel fills in ---


@kernel
def filled_through_a_name(a, b, c):
    part, other = b[1:3], a
    part[0] = other[0] + c[0]


@kernel
def filled_by_what_it_calls(a, b, c):
    filled_through_a_name(b, c, a)


@kernel
def filled_by_address(a, b, c, k):
    call(k[0], c, a, b)


@kernel
def filled_as_whole_numbers(a):
    k = a.view(np.int64)
    k[0] = 1


def test_which_arrays_a_kernel_fills_in():
    named = {
        function.__name__: Root(function, types)
        for function, types in (
            (filled_through_a_name, "fff"),
            (filled_by_what_it_calls, "fff"),
            (filled_by_address, "fffi"),
            (filled_as_whole_numbers, "f"),
        )
    }
    unit = printing._Unit()
    for root in named.values():
        unit.add(root)
    filled = dict(printing.filled_arrays(unit.entries))
    found = {name: filled[root.key] for name, root in named.items()}
    assert found["filled_through_a_name"] == {1}
    assert found["filled_by_what_it_calls"] == {2}
    # At the address may stand either of the two above, or a program, which fills in the last.
    assert found["filled_by_address"] == {0, 1}
    assert found["filled_as_whole_numbers"] == {0}


def test_a_loop_fills_in_what_is_its_own_run_s_and_nothing_that_runs_share():
    unit = printing._Unit()
    loop = next(root for root in roots() if root.block is not None)
    unit.add(loop)
    positions = dict(printing.filled_arrays(unit.entries))[loop.key]
    filled = {LoopBlock._fields[position] for position in positions}
    # The memory is what laws fill in, which this unit does not have.
    assert filled == {
        "sensors",
        "limits",
        "dead_times",
        "board",
        "state",
        "clock",
        "record",
        "progress",
    }


def test_a_named_compiler_comes_first(monkeypatch):
    monkeypatch.setenv("CC", f"{sys.executable} -q")
    assert find_compiler().words == (sys.executable, "-q")


@pytest.mark.slow
def test_a_compiler_that_fails_says_what_it_said(tmp_path):
    words = (sys.executable, "-c", "import sys; sys.exit('no such flag')")
    compiler = Compiler(words, "x", "linux")
    with pytest.raises(BuildError, match="no such flag"):
        build(tmp_path, compiler)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_compiler_that_is_not_there(tmp_path):
    with pytest.raises(BuildError, match="could not be started"):
        build(tmp_path, Compiler(("no-such-compiler",), "x86_64", "linux"))


def test_without_any_compiler_it_says_what_to_do(monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setitem(sys.modules, "ziglang", None)
    with pytest.raises(BuildError, match="no C compiler: install one, or `pip install ziglang`"):
        find_compiler()


def test_where_there_is_no_compiler_that_of_the_wheel_is_taken(monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setitem(sys.modules, "ziglang", sys)
    assert find_compiler().words[:4] == (sys.executable, "-m", "ziglang", "cc")
    assert "-target" in find_compiler().words


@pytest.mark.slow
def test_the_module_is_built_into_any_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(building, "roots", lambda: ONE)  # the others take a while
    monkeypatch.setattr(building, "note_digest", lambda _: None)  # which is not that of one
    module = build(tmp_path)
    code = "import _kernels; print(*_kernels.addresses('baseline'))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == ONE[0].key
    assert [module] == list(tmp_path.iterdir())
