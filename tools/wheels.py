"""Make wheels for this platform and for others, and check what is in them.

    python tools/wheels.py [--out dist] [PLATFORM …]

Without a platform all are made: first that at hand, by its own compiler, then the others by the
compiler of the ``ziglang`` wheel. Of each wheel the name, the format and the machine of its module,
the libraries that this needs and the glibc that it asks for are compared with what they must
be; where auditwheel is installed it is asked as well. A wheel for another platform is not run.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
HERE = "here"
GLIBC = (2, 31)
"""The newest glibc that a wheel may ask for: that of Ubuntu 20.04 and Debian 11."""


class Platform(NamedTuple):
    """What a wheel for a platform has to be, as regular expressions.

    Attributes
    ----------
    head : bytes
        How its module begins: format and machine.
    tag : str
        Of the name of the wheel.
    named : bytes
        How a library is named in the module.
    libraries : str
        Those that the platform has.
    """

    head: bytes
    tag: str
    named: bytes
    libraries: str


ELF, MACH, PE = rb"\x7fELF\x02\x01.{12}", rb"\xcf\xfa\xed\xfe", rb"MZ.{58,1024}?PE\0\0"
LINUX = rb"\0([\w.+-]+\.so\.\d+)(?=\0)", r"lib(c|m|pthread|dl|rt)\.so\.\d|ld-linux.*\.so\.\d"
MAC = rb"(/[\w/.]+\.dylib)\0", r"/usr/lib/libSystem\.B\.dylib"
DLL = (
    rb"([\w-]+\.dll)\0",
    r"(?i)python3\.dll|kernel32\.dll|api-ms-win-crt-[a-z0-9-]+\.dll|ucrtbase\.dll",
)
PLATFORMS = {
    "x86_64-linux": Platform(ELF + rb"\x3e\0", r"manylinux_2_\d+_x86_64", *LINUX),
    "aarch64-linux": Platform(ELF + rb"\xb7\0", r"manylinux_2_\d+_aarch64", *LINUX),
    "x86_64-macos": Platform(MACH + rb"\x07\0\0\x01", r"macosx_11_0_x86_64", *MAC),
    "aarch64-macos": Platform(MACH + rb"\x0c\0\0\x01", r"macosx_11_0_arm64", *MAC),
    "x86_64-windows": Platform(PE + rb"\x64\x86", "win_amd64", *DLL),
}
SIGNATURE = b"\xfa\xde\x0c\xc0"
"""How a signature begins: macOS on arm64 runs nothing that is not signed, if only by itself."""


def build(name: str, out: Path, source: Path = ROOT) -> Path:
    """Make the wheel for a platform, or for the one at hand; return it.

    Parameters
    ----------
    name : str
        One of `PLATFORMS`, or `HERE`.
    out : path
        Where it is put.
    source : path
        The folder of the sources.
    """
    environment = {key: value for key, value in os.environ.items() if key != "FUZZYARM_PURE"}
    environment["FUZZYARM_PLATFORM"] = "" if name == HERE else name
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out, prefix=".wheel-") as room:
        words = ["-m", "build", "--wheel", "--no-isolation", "--outdir", room, str(source)]
        done = subprocess.run(
            [sys.executable, *words], env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise SystemExit(f"no wheel for {name}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
        (wheel,) = Path(room).glob("*.whl")
        return wheel.replace(out / wheel.name)


def faults(wheel: Path, name: str) -> list[str]:
    """Return what is wrong with a wheel for a platform, a sentence each.

    Parameters
    ----------
    wheel : path
        The file.
    name : str
        The platform that it is for, of `PLATFORMS`.
    """
    wanted = PLATFORMS[name]
    *_, python, abi, tag = wheel.stem.split("-")
    with zipfile.ZipFile(wheel) as opened:
        modules = [each for each in opened.namelist() if "/_kernels." in each]
        (fields,) = (each for each in opened.namelist() if each.endswith(".dist-info/WHEEL"))
        written = opened.read(fields).decode()
        if len(modules) != 1:
            return [f"it has {len(modules)} modules with machine code"]
        data = opened.read(modules[0])
    suffix = ".pyd" if name.endswith("windows") else ".abi3.so"
    return [
        *([] if (python, abi) == ("cp311", "abi3") else [f"its tags are {python}-{abi}"]),
        *([] if re.fullmatch(wanted.tag, tag) else [f"its platform is {tag}"]),
        *(
            []
            if f"Tag: {python}-{abi}-{tag}\n" in written
            else ["its tags are not those of its name"]
        ),
        *([] if "Root-Is-Purelib: false" in written else ["it says that it has no machine code"]),
        *([] if modules[0] == f"fuzzyarm/_kernels{suffix}" else [f"its module is {modules[0]}"]),
        *([] if b"PyInit__kernels" in data else ["Python would not find the module's beginning"]),
        *_faults_of(data, tag, wanted),
    ]


def _faults_of(data: bytes, tag: str, wanted: Platform) -> list[str]:
    """Return what is wrong with a module."""
    needs = sorted({name.decode() for name in re.findall(wanted.named, data)})
    foreign = [name for name in needs if not re.fullmatch(wanted.libraries, name)]
    glibc = re.fullmatch(r"manylinux_(\d+)_(\d+)_.*", tag)
    return [
        *([] if re.match(wanted.head, data, re.DOTALL) else ["its module is for another machine"]),
        *(f"it needs {name}" for name in foreign),
        *(["it needs a newer glibc"] if glibc and (int(glibc[1]), int(glibc[2])) > GLIBC else []),
        *(["it is not signed"] if tag.endswith("arm64") and SIGNATURE not in data else []),
        *(
            ["it does not load python3.dll"]
            if tag.startswith("win") and "python3.dll" not in needs
            else []
        ),
    ]


def here() -> str:
    """Return the platform at hand, by its name in `PLATFORMS`."""
    system = {"darwin": "macos", "win32": "windows"}.get(sys.platform, sys.platform)
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    return f"{machine}-{system}"


def audited(wheel: Path) -> str:
    """Return what auditwheel says of a wheel for Linux, in one line."""
    if find_spec("auditwheel") is None:
        return "auditwheel is not installed"
    words = [sys.executable, "-m", "auditwheel", "show", str(wheel)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    said = " ".join((done.stdout or done.stderr).split())
    told = re.search(r'platform tag: "([^"]+)"', said)
    return f"auditwheel: {told[1]}" if told else f"auditwheel: {said[:200]}"


def main() -> int:
    """Make the wheels that were asked for; 1 if one of them is not what it must be."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument(
        "platforms", metavar="PLATFORM", nargs="*", help=f"{HERE}, {', '.join(PLATFORMS)}"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="where they are put (dist)")
    chosen = parser.parse_args()
    others = [name for name in PLATFORMS if name != here()]
    bad = 0
    for name in chosen.platforms or [HERE, *others]:
        if name not in {HERE, *PLATFORMS}:
            parser.error(f"unknown platform '{name}': {HERE}, {', '.join(PLATFORMS)}")
        wheel = build(name, chosen.out)
        wrong = faults(wheel, here() if name == HERE else name)
        bad += bool(wrong)
        size = wheel.stat().st_size / 1e6
        print(f"{wheel.name}, {size:.1f} MB: {'; '.join(wrong) or 'as it must be'}", flush=True)
        if name == HERE and sysconfig.get_platform().startswith("linux"):
            print(f"  {audited(wheel)}")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
