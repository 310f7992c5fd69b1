"""What the build of the package adds: machine code of the kernels, made for this platform."""

from __future__ import annotations

import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PURE = "FUZZYARM_PURE"
"""Environment variable: ``1`` builds a wheel without machine code, for every platform."""

PLATFORM = "FUZZYARM_PLATFORM"
"""Environment variable: another platform, ``aarch64-linux`` …, for which ziglang compiles."""


class KernelBuildHook(BuildHookInterface):
    """Builds the extension module into the package; without a compiler there is none."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what the build needs: the kernels use NumPy, and somebody has to compile."""
        if _is_pure():
            return []
        compilers = [*os.environ.get("CC", "").split()[:1], "cc", "gcc", "clang"]
        needed = ["numpy>=2.0"]
        is_there = not os.environ.get(PLATFORM) and any(map(shutil.which, compilers))
        return needed if is_there else [*needed, "ziglang>=0.13"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the module in front of the wheel; of an sdist the sources are all."""
        if self.target_name != "wheel" or _is_pure():
            return
        source = Path(self.root) / "src"
        # What is installed to be edited finds the module beside its sources.
        self._room = tempfile.TemporaryDirectory(prefix="fuzzyarm-")
        folder = source / "fuzzyarm" if version == "editable" else Path(self._room.name)
        # The environment of the build may stand on the path of this process only.
        path = os.pathsep.join([str(source), *filter(None, sys.path)])
        words = [sys.executable, "-m", "fuzzyarm.apps.native.build", str(folder)]
        other = os.environ.get(PLATFORM, "")
        done = subprocess.run(
            [*words, "--platform", other] if other else words,
            env={**os.environ, "PYTHONPATH": path, "FUZZYARM_NATIVE": "0"},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode and other:
            raise RuntimeError(f"no machine code for {other}:\n{done.stderr.strip()}")
        if done.returncode:
            self.app.display_warning(
                f"fuzzyarm is built without machine code and will be slow:\n{done.stderr.strip()}"
            )
            return
        # Beside the module lies the digest of its C.
        (module,) = (path for path in folder.glob("_kernels.*") if path.suffix != ".digest")
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{_tag_of(module, other)}"
        if version != "editable":
            build_data["force_include"][str(module)] = f"fuzzyarm/{module.name}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove the module that went into the wheel."""
        if room := getattr(self, "_room", None):
            room.cleanup()


def _is_pure() -> bool:
    return os.environ.get(PURE, "") not in {"", "0"}


def _tag_of(module: Path, other: str) -> str:
    """Return the platform of a module in the name of its wheel; `other` is where it is foreign.

    Of Linux with the newest glibc that a symbol asks for (PEP 600); without glibc it is ``linux``,
    which no index takes.
    """
    here = {"win32": "windows", "darwin": "macos"}.get(sys.platform, sys.platform)
    machine, _, system = (other or f"{platform.machine().lower()}-{here}").partition("-")
    if system == "windows":
        return {"x86_64": "win_amd64", "amd64": "win_amd64"}.get(machine, "win_arm64")
    if system == "macos":
        return f"macosx_11_0_{machine.replace('aarch64', 'arm64')}"
    versions = re.findall(rb"\0GLIBC_(\d+)\.(\d+)", module.read_bytes())
    newest = max((tuple(map(int, version)) for version in versions), default=())
    return "_".join(["manylinux" if newest else "linux", *map(str, newest), machine])
