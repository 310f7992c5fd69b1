"""The built wheel works where there is no checkout."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Return a folder with the installed wheel and nothing else of the project."""
    folder = tmp_path_factory.mktemp("wheel")
    build = ["-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    subprocess.run([sys.executable, *build], check=True, capture_output=True)
    (wheel,) = folder.glob("fuzzyarm-*.whl")
    target = folder / "site"
    pip = ["-m", "pip", "install", "--quiet", "--no-deps", "--target", str(target), str(wheel)]
    subprocess.run([sys.executable, *pip], check=True, capture_output=True)
    return target


def run(installed, *words, cwd):
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    command = [sys.executable, "-m", "fuzzyarm", *words]
    return subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_the_demo_runs_from_the_wheel(installed, tmp_path):
    done = run(installed, "demo", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "13 x 13 cells of u over e, ce" in done.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_the_wheel_has_the_shipped_files_and_the_type_marker(installed):
    names = {path.name for path in (installed / "fuzzyarm" / "shipped").iterdir()}
    assert names == {path.name for path in (ROOT / "rulebases").iterdir()}
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
