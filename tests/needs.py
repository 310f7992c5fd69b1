"""Programs, packages and data that some tests need: whether they are here, and how to get them.

``python tests/needs.py`` prints what is missing, one line each; with ``--debian`` or ``--pip`` the
names of the packages alone.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import re
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SHARED = ROOT.parent / "shared"
PAGE_TOOLS = ROOT / "editors" / "designer" / "node_modules"
CORPUS = Path(os.environ.get("FUZZYARM_CORPUS", SHARED / "corpus"))
"""Rule files of others."""
DATA = Path(os.environ.get("FUZZYARM_DATA", SHARED / "data"))
"""Data sets of others."""
ARDUINO_CORE = Path("/usr/share/arduino/hardware/arduino/avr")
"""Where Debian's arduino-core-avr is."""


@dataclass(frozen=True)
class Need:
    """One of `programs` on the PATH, or a Python `module`, or a `folder`; and how to get it."""

    programs: tuple[str, ...] = ()
    module: str = ""
    folder: Path | None = None
    debian: str = ""
    pip: str = ""
    otherwise: str = ""

    @property
    def how(self) -> str:
        """The command or the words that bring it."""
        if self.debian:
            return f"apt-get install {self.debian}"
        return f"pip install {self.pip}" if self.pip else self.otherwise

    def is_here(self) -> bool:
        """Whether a test can use it."""
        return (
            any(map(shutil.which, self.programs))
            or (bool(self.module) and importlib.util.find_spec(self.module) is not None)
            or (self.folder is not None and self.folder.is_dir())
        )


def _program(name: str, debian: str = "") -> Need:
    return Need((name,), debian=debian or name)


_ZIG = re.findall(r"(?m)^ZIG *:= *([\d.]+)", (ROOT / "Makefile").read_text("utf-8"))[0]


def _page_tool(name: str) -> Need:
    return Need(folder=PAGE_TOOLS / name, otherwise="make page-tools")


NEEDS: dict[str, Need] = {
    "C compiler": Need(("gcc", "cc"), debian="gcc libc6-dev"),
    "g++": _program("g++"),
    "gcov": _program("gcov", "gcc"),
    "git": _program("git"),
    "node": _program("node", "nodejs npm"),
    "rustc": _program("rustc"),
    "npm": _program("npm", "nodejs npm"),
    "chromium": Need(
        ("chromium-headless-shell", "chromium", "chromium-browser"),  # the first is the fastest
        debian="chromium-headless-shell",
    ),
    "avr-gcc": _program("avr-gcc", "gcc-avr avr-libc"),
    "simavr": _program("simavr"),
    "arduino-core-avr": Need(folder=ARDUINO_CORE / "cores", debian="arduino-core-avr"),
    "arm-none-eabi-gcc": _program("arm-none-eabi-gcc", "gcc-arm-none-eabi libnewlib-arm-none-eabi"),
    "qemu-system-arm": _program("qemu-system-arm"),
    "arm-linux-gnueabihf-gcc": _program(
        "arm-linux-gnueabihf-gcc", "gcc-arm-linux-gnueabihf libc6-dev-armhf-cross"
    ),
    "qemu-arm": _program("qemu-arm", "qemu-user"),
    "cppcheck": _program("cppcheck"),
    "micropython": Need(
        ("micropython",),
        otherwise="apt-get install micropython, or "
        "npm install --global @micropython/micropython-webassembly-pyscript",
    ),
    "nvim": _program("nvim", "neovim"),
    "ziglang": Need(module="ziglang", pip=f"ziglang=={_ZIG}"),
    "blark": Need(module="blark", pip="blark"),
    "pyright": Need(("pyright",), module="pyright", pip="pyright"),
    "pyfuzzylite": Need(module="fuzzylite", otherwise="an environment with a NumPy below 2"),
    "axe-core": _page_tool("axe-core"),
    "pyodide": _page_tool("pyodide"),
    "tools of the extension": Need(
        folder=ROOT / "editors" / "vscode" / "node_modules", otherwise="npm ci in editors/vscode"
    ),
    "corpus": Need(folder=CORPUS, otherwise="rule files of others: FUZZYARM_CORPUS=FOLDER"),
    "data": Need(folder=DATA, otherwise="data sets of others: FUZZYARM_DATA=FOLDER"),
}


@functools.cache
def is_here(name: str) -> bool:
    """Whether what is called `name` in `NEEDS` can be used."""
    return NEEDS[name].is_here()


def lacking(name: str) -> str:
    """Return the reason of a skip, the same for all tests that need it."""
    return f"no {name} here ({NEEDS[name].how})"


def need(*names: str) -> None:
    """Skip a test where one of these is missing."""
    for name in names:
        if not is_here(name):
            pytest.skip(lacking(name))


def requires(name: str) -> pytest.MarkDecorator:
    """Mark tests that are skipped where this is missing."""
    return pytest.mark.skipif(not is_here(name), reason=lacking(name))


def program(name: str) -> str | None:
    """Return the path of the first program of a need that is on the PATH."""
    return next(filter(None, map(shutil.which, NEEDS[name].programs)), None)


def main(words: list[str]) -> None:
    """Print what is missing."""
    missing = [name for name in NEEDS if not is_here(name)]
    kind = words[0].removeprefix("--") if words else ""
    lines = [getattr(NEEDS[name], kind) if kind else lacking(name) for name in missing]
    print("\n".join(filter(None, lines)))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
