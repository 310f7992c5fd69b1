"""Wheels for every platform: `tools/wheels.py` makes and checks them, the build hook compiles."""

import importlib.util
import os
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest
import wheels
from budget import cases
from needs import requires

from fuzzyarm.apps.native.build import (
    declared_names,
    definition_of_python3,
    headers_for_any_platform,
    zig,
)

ROOT = Path(__file__).parents[2]

needs_zig = requires("ziglang")


def build_hook():
    """Return the module of the build's hook."""
    pytest.importorskip("hatchling")
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def hook(monkeypatch, **environment):
    """Return the hook of the build in some environment."""
    for name in ("CC", "FUZZYARM_PURE", "FUZZYARM_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    return build_hook().KernelBuildHook(str(ROOT), {}, None, None, str(ROOT), "wheel")


def tool(folder, name):
    """Write a program into a folder of programs."""
    file = folder / name
    file.write_text("#!/bin/sh\n")
    file.chmod(0o755)


@pytest.mark.skipif(os.name == "nt", reason="programs of a POSIX system")
def test_what_a_build_fetches(monkeypatch, tmp_path):
    numpy, ziglang = "numpy>=2.0", "ziglang>=0.13"
    assert hook(monkeypatch, PATH=str(tmp_path)).dependencies() == [numpy, ziglang]
    assert hook(monkeypatch, PATH=str(tmp_path), FUZZYARM_PURE="1").dependencies() == []
    tool(tmp_path, "clang")
    assert hook(monkeypatch, PATH=str(tmp_path)).dependencies() == [numpy]
    # For another platform the compiler at hand is none.
    other = hook(monkeypatch, PATH=str(tmp_path), FUZZYARM_PLATFORM="aarch64-macos")
    assert other.dependencies() == [numpy, ziglang]


def test_headers_for_any_platform(tmp_path):
    headers = headers_for_any_platform(tmp_path / "include")
    names = declared_names(headers)
    assert names["PyFloat_FromDouble"] is False
    assert names["PyExc_ValueError"] is True
    assert names["_Py_NoneStruct"] is True
    assert names["_PyArg_ParseTuple_SizeT"] is False
    lines = definition_of_python3(headers).splitlines()
    assert lines[:2] == ["LIBRARY python3.dll", "EXPORTS"]
    assert {"  PyExc_ValueError DATA", "  PyFloat_FromDouble", "  _Py_Dealloc"} <= set(lines)
    own = (Path(sysconfig.get_path("include")) / "pyconfig.h").read_bytes()
    assert (headers / "pyconfig.h").read_bytes() != own


def repacked(wheel, name, change):
    """Write a wheel again under another name, with files changed."""
    other = wheel.with_name(name)
    with zipfile.ZipFile(wheel) as source, zipfile.ZipFile(other, "w") as target:
        for entry in source.namelist():
            for renamed, data in change(entry, source.read(entry)):
                target.writestr(renamed, data)
    return other


@pytest.fixture
def small(tmp_path):
    """Return a wheel with the module of this installation and what describes it."""
    if wheels.here() not in wheels.PLATFORMS:
        pytest.skip("no wheels are made for this platform")
    module = pytest.importorskip("fuzzyarm._kernels", reason="no machine code was built").__file__
    tag = f"cp311-abi3-{build_hook()._tag_of(Path(module), '')}"
    wheel = tmp_path / f"fuzzyarm-1.0-{tag}.whl"
    with zipfile.ZipFile(wheel, "w") as target:
        target.write(module, f"fuzzyarm/{Path(module).name}")
        target.writestr("fuzzyarm-1.0.dist-info/WHEEL", f"Root-Is-Purelib: false\nTag: {tag}\n")
    return wheel


def test_a_wheel_is_what_it_says(small):
    assert wheels.faults(small, wheels.here()) == []


def test_a_wheel_for_another_platform_is_refused(small):
    for name in set(wheels.PLATFORMS) - {wheels.here()}:
        assert any("its platform is" in fault for fault in wheels.faults(small, name))
        assert "its module is for another machine" in wheels.faults(small, name)


def test_each_fault_of_a_wheel_is_told(small):
    tag = small.stem.split("-", 2)[2]
    here = wheels.here()
    bare = repacked(
        small, f"fuzzyarm-2.0-{tag}.whl",
        lambda entry, data: [] if "_kernels" in entry else [(entry, data)],
    )  # fmt: skip
    assert wheels.faults(bare, here) == ["it has 0 modules with machine code"]
    platform = tag.split("-")[2]
    newer = repacked(
        small, f"fuzzyarm-3.0-cp312-cp312-{platform}.whl", lambda entry, data: [(entry, data)]
    )
    assert wheels.faults(newer, here) == [
        "its tags are cp312-cp312", "its tags are not those of its name",
    ]  # fmt: skip
    pure = repacked(
        small, f"fuzzyarm-4.0-{tag}.whl",
        lambda entry, data: [(entry, data.replace(b"Purelib: false", b"Purelib: true"))],
    )  # fmt: skip
    assert "it says that it has no machine code" in wheels.faults(pure, here)


def test_what_a_module_may_not_need():
    elf = b"\x7fELF\x02\x01" + bytes(12) + b"\x3e\0\0libc.so.6\0libgfortran.so.5\0"
    wanted = wheels.PLATFORMS["x86_64-linux"]
    assert wheels._faults_of(elf, "manylinux_2_99_x86_64", wanted) == [
        "it needs libgfortran.so.5", "it needs a newer glibc",
    ]  # fmt: skip
    mach = b"\xcf\xfa\xed\xfe\x0c\0\0\x01/usr/lib/libSystem.B.dylib\0"
    wanted = wheels.PLATFORMS["aarch64-macos"]
    assert wheels._faults_of(mach, "macosx_11_0_arm64", wanted) == ["it is not signed"]
    pe = b"MZ" + bytes(62) + b"PE\0\0\x64\x86KERNEL32.dll\0"
    wanted = wheels.PLATFORMS["x86_64-windows"]
    assert wheels._faults_of(pe, "win_amd64", wanted) == ["it does not load python3.dll"]


@pytest.mark.parametrize(
    ("other", "data", "tag"),
    [
        ("x86_64-linux", b"\0GLIBC_2.4\0GLIBC_2.17\0", "manylinux_2_17_x86_64"),
        ("aarch64-linux", b"\0libc.musl.so\0", "linux_aarch64"),
        ("aarch64-macos", b"", "macosx_11_0_arm64"),
        ("x86_64-windows", b"", "win_amd64"),
    ],
)
def test_the_platform_in_the_name_of_a_wheel(other, data, tag, tmp_path):
    file = tmp_path / "_kernels"
    file.write_bytes(data)
    assert build_hook()._tag_of(file, other) == tag


def test_the_compiler_of_the_wheel_takes_its_own_flags(monkeypatch, tmp_path):
    """It stops at flags of GCC that it does not know."""
    seen = []
    compiler = zig("aarch64", "linux")
    monkeypatch.setattr(type(compiler), "run", lambda self, *words: seen.extend(words))
    compiler.compile(tmp_path / "a.c", tmp_path / "a.o", "-fno-tree-loop-distribute-patterns")
    assert "-fno-tree-loop-distribute-patterns" not in seen
    assert "-ffp-contract=off" in seen


@needs_zig
@pytest.mark.slow
@pytest.mark.skipif(not cases(0, 1), reason="minutes of another compiler: with --thorough")
@pytest.mark.parametrize("name", wheels.PLATFORMS)
def test_wheels_for_every_platform(name, tmp_path):
    assert wheels.faults(wheels.build(name, tmp_path), name) == []


@needs_zig
@pytest.mark.slow
@pytest.mark.skipif(not cases(0, 1), reason="minutes of another compiler: with --thorough")
def test_the_source_archive_builds_without_a_compiler_of_the_platform(tmp_path, monkeypatch):
    words = ["-m", "build", "--sdist", "--no-isolation", "--outdir", str(tmp_path), str(ROOT)]
    subprocess.run([sys.executable, *words], check=True, capture_output=True)
    with tarfile.open(next(tmp_path.glob("*.tar.gz"))) as opened:
        opened.extractall(tmp_path / "unpacked", filter="data")
    (source,) = (tmp_path / "unpacked").iterdir()
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    wheel = wheels.build(wheels.HERE, tmp_path / "wheel", source)
    assert wheels.faults(wheel, wheels.here()) == []
