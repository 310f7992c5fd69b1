"""What the build of the package adds: machine code of the kernels, made for this platform."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PURE = "FUZZYARM_PURE"
"""Environment variable: ``1`` builds a wheel without machine code, for every platform."""


class KernelBuildHook(BuildHookInterface):
    """Builds the extension module into the package; without a compiler there is none."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what the build needs: the kernels use NumPy, and somebody has to compile."""
        if _is_pure():
            return []
        compilers = [*os.environ.get("CC", "").split()[:1], "cc", "gcc", "clang"]
        needed = ["numpy>=2.0"]
        return needed if any(map(shutil.which, compilers)) else [*needed, "ziglang>=0.13"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the module in front of the wheel; of an sdist the sources are all."""
        if self.target_name != "wheel" or _is_pure():
            return
        source = Path(self.root) / "src"
        # The environment of the build may stand on the path of this process only.
        path = os.pathsep.join([str(source), *filter(None, sys.path)])
        done = subprocess.run(
            [sys.executable, "-m", "fuzzyarm.native.build", str(source / "fuzzyarm")],
            env={**os.environ, "PYTHONPATH": path, "FUZZYARM_NATIVE": "0"},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            self.app.display_warning(
                f"fuzzyarm is built without machine code and will be slow:\n{done.stderr.strip()}"
            )
            return
        (module,) = (source / "fuzzyarm").glob("_kernels.*")
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{platform_tag(module)}"
        build_data["artifacts"].append(f"/src/fuzzyarm/{module.name}")


def _is_pure() -> bool:
    return os.environ.get(PURE, "") not in {"", "0"}


def platform_tag(module: Path) -> str:
    """Return the tag of this platform: of Linux with the oldest glibc that the module runs on."""
    tag = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    needed = re.findall(rb"GLIBC_(\d+)\.(\d+)", module.read_bytes())
    if not tag.startswith("linux_") or not needed:
        return tag
    major, minor = max((int(major), int(minor)) for major, minor in needed)
    return tag.replace("linux_", f"manylinux_{major}_{minor}_")
