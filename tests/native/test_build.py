"""Building the machine code: compilers that are there, fail, or are missing."""

import shutil
import subprocess
import sys

import pytest

from fuzzyarm.native import build as building
from fuzzyarm.native.build import BuildError, Compiler, build, find_compiler, kernels_in_c
from fuzzyarm.native.roots import Root
from fuzzyarm.table import lookup

ONE = [Root(lookup.gather, "fsf", over_rows=True)]


def test_the_c_of_a_kernel():
    text = kernels_in_c("baseline", "rows", ONE)
    assert "static inline void gather(reals values_, shorts index_, reals out_) {" in text
    assert '{"fuzzyarm.table.lookup.gather(fsf)", (void (*)(void))entry_0, spread_0},' in text


def test_a_kernel_stands_in_one_unit_only():
    texts = {unit: kernels_in_c("v3", unit, ONE) for unit in building.UNITS}
    assert {unit for unit, text in texts.items() if ONE[0].key in text} == {"rows"}
    assert all(f"const table_row fuzzyarm_v3_{unit}[]" in text for unit, text in texts.items())


def test_a_named_compiler_comes_first(monkeypatch):
    monkeypatch.setenv("CC", f"{sys.executable} -q")
    assert find_compiler().words == (sys.executable, "-q")


def test_a_compiler_that_fails_says_what_it_said(tmp_path):
    words = (sys.executable, "-c", "import sys; sys.exit('no such flag')")
    compiler = Compiler(words, "x", "linux")
    with pytest.raises(BuildError, match="no such flag"):
        build(tmp_path, compiler)
    assert list(tmp_path.iterdir()) == []


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
    module = build(tmp_path)
    code = "import _kernels; print(*_kernels.addresses('baseline'))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == ONE[0].key
    assert [module] == list(tmp_path.iterdir())
