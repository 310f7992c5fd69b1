"""The built wheel works where there is no checkout."""

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from budget import cases
from machine_code import compiler_at_hand

import fuzzyarm

ROOT = Path(__file__).parents[2]


def build(kind, source, folder):
    """Return the archive that is built of a folder of sources: a wheel or an sdist."""
    words = ["-m", "build", f"--{kind}", "--no-isolation", "--outdir", str(folder), str(source)]
    subprocess.run([sys.executable, *words], check=True, capture_output=True)
    (archive,) = folder.glob("fuzzyarm-*")
    return archive


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Return the wheel that is built of the checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    with pytest.MonkeyPatch.context() as patch:
        for name, value in compiler_at_hand(folder).items():
            patch.setenv(name, value)
        return build("wheel", ROOT, folder)


@pytest.fixture(scope="module")
def installed(tmp_path_factory, wheel):
    """Return a folder with the installed wheel and nothing else of the project."""
    target = tmp_path_factory.mktemp("site")
    pip = ["-m", "pip", "install", "--quiet", "--no-deps", "--target", str(target), str(wheel)]
    subprocess.run([sys.executable, *pip], check=True, capture_output=True)
    return target


def run(installed, *words, cwd, **others):
    environment = {**os.environ, "PYTHONPATH": str(installed), **others}
    command = [sys.executable, "-m", "fuzzyarm", *words]
    return subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_the_demo_runs_from_the_wheel(installed, tmp_path):
    # Without machine code, which would be made anew in this folder; its bits are the same.
    done = run(installed, "demo", cwd=tmp_path, FUZZYARM_NATIVE="0")
    assert done.returncode == 0, done.stderr
    assert "13 x 13 cells of u over e, ce" in done.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_the_wheel_has_the_shipped_files_and_the_type_marker(installed):
    names = {path.name for path in (installed / "fuzzyarm" / "shipped").rglob("*")}
    assert names == {path.name for path in (ROOT / "rulebases").rglob("*")}
    assert (installed / "fuzzyarm" / "py.typed").exists()


@pytest.mark.slow
def test_the_code_that_runs_is_the_wheel_s(installed, tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    code = "import fuzzyarm; print(fuzzyarm.__file__); print(fuzzyarm.shipped('pd7.frb'))"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert all(line.startswith(str(installed)) for line in done.stdout.splitlines())


@pytest.mark.slow
def test_the_source_archive_builds_the_same_wheel(wheel, tmp_path, monkeypatch):
    """In the suite without machine code, which is made of the sources that are compared."""
    archive = build("sdist", ROOT, tmp_path / "sdist")
    with tarfile.open(archive) as opened:
        opened.extractall(tmp_path / "unpacked", filter="data")
    (source,) = (tmp_path / "unpacked").iterdir()
    pure = cases(1, 0)
    monkeypatch.setenv("FUZZYARM_PURE", str(pure))
    again, here = contents(build("wheel", source, tmp_path / "wheel")), contents(wheel)
    if pure:
        again, here = without_machine_code(again), without_machine_code(here)
        assert any(name.endswith(("kernels.py", "module.c")) for name in here)
    assert again == here


def without_machine_code(files):
    """Leave out the module, and the two files that name it or the platform."""
    return {
        name: data
        for name, data in files.items()
        if not name.endswith(("/WHEEL", "/RECORD")) and "/_kernels." not in name
    }


def contents(wheel):
    with zipfile.ZipFile(wheel) as opened:
        return {name: opened.read(name) for name in opened.namelist()}


@pytest.mark.slow
def test_the_wheel_is_ready_for_an_index(wheel):
    files = contents(wheel)
    (metadata,) = (text.decode() for name, text in files.items() if name.endswith("/METADATA"))
    head, _, description = metadata.partition("\n\n")
    fields = [line.partition(": ")[::2] for line in head.splitlines()]
    told = dict(fields)
    assert told["Version"] == fuzzyarm.__version__
    assert told["License-Expression"] == "MIT"
    assert told["License-File"] == "LICENSE"
    assert any(name.endswith("/licenses/LICENSE") for name in files)
    assert {"lsp"} <= {value for field, value in fields if field == "Provides-Extra"}
    assert description.startswith("# fuzzyarm")
