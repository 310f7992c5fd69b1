"""The table of tests that ``tools/mutants.py`` goes by is whole and names what there is."""

import sys

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
