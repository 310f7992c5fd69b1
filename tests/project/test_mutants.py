"""What `tools/mutants.py` goes by: the table of tests, the functions of mutants, its record."""

import sys
from types import CodeType

import pytest
from sources import MODULES, SOURCE

ROOT = SOURCE.parents[1]
sys.path.insert(0, str(ROOT / "tools"))

import mutants  # noqa: E402


def test_every_module_has_tests_that_ought_to_notice():
    files = [str(path.relative_to(ROOT)) for path in MODULES]
    used = {tuple(mutants.tests_of(file)) for file in files}
    assert [name for tests in used for name in tests if not (ROOT / name).exists()] == []
    names = [path.relative_to(SOURCE).as_posix() for path in MODULES]
    idle = [part for part in mutants.TESTS if not any(name.startswith(part) for name in names)]
    assert idle == []


def test_a_mutant_is_one_change_of_one_line():
    chosen = mutants.mutants_of(mutants.PACKAGE / "table" / "axis.py")
    assert len(chosen) > 20
    source = (SOURCE / "table" / "axis.py").read_bytes()
    for mutant in chosen:
        changed = mutant.applied(source)
        assert changed != source
        lines = zip(source.splitlines(), changed.splitlines(), strict=True)
        assert sum(old != new for old, new in lines) == 1


def codes(code):
    """Return a code object and those inside."""
    inside = [codes(constant) for constant in code.co_consts if isinstance(constant, CodeType)]
    return [code, *(each for part in inside for each in part)]


def test_the_function_of_a_mutant_is_the_innermost_that_runs_its_line():
    path = SOURCE / "kernels.py"
    whole = compile(path.read_text("utf-8"), str(path), "exec")
    functions = {
        code.co_firstlineno: code
        for code in codes(whole)
        if code.co_flags & 2 and not code.co_name.endswith("comp>")  # 2: it has local names
    }
    chosen = mutants.mutants_of(mutants.PACKAGE / "kernels.py")
    assert {mutant.scope for mutant in chosen} - {0} <= set(functions)
    assert len({mutant.scope for mutant in chosen}) > 10
    for mutant in chosen:
        lines = [line for _, _, line in functions.get(mutant.scope, whole).co_lines() if line]
        assert min(lines) <= mutant.line <= max(lines)


def test_an_interrupted_run_goes_on(tmp_path):
    first, second = mutants.mutants_of(mutants.PACKAGE / "table" / "axis.py")[:2]
    record = mutants.Record(mutants.Log(tmp_path / "record"))
    record.add(first, 1, None)
    record.add(first, 2, "tests/table/test_table.py::test_a[1]")
    record.add(second, 1, None)
    again = mutants.Record(mutants.Log(tmp_path / "record"))
    assert not any(again.is_open(first, number) for number in (1, 2, 3))
    assert [again.is_open(second, number) for number in (1, 2, 3)] == [False, True, True]
    assert again.noticing[first.file] == ["tests/table/test_table.py::test_a"]


def test_the_record_of_another_source_is_refused(tmp_path, monkeypatch):
    mutants.Log(tmp_path / "record")
    monkeypatch.setattr(mutants, "digest_of_project", lambda: "another")
    with pytest.raises(SystemExit, match="of another source"):
        mutants.Log(tmp_path / "record")


def test_what_noticed_before_comes_first_and_a_file_stays_in_one_piece():
    tests = ["a::1", "b::1", "a::2", "b::2", "c::1"]
    assert mutants.in_turn(tests, ["b::2", "d::1"]) == ["b::2", "a::1", "a::2", "b::1", "c::1"]
