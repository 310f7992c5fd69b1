"""What a compiled module is: its format, its machine, what it needs, and so the tag of its wheel.

Read of the file itself, not asked of the platform that compiled it: a module may be for another.
Formats: System V ABI, "Object files" (ELF); Apple, ``mach-o/loader.h``; Microsoft, "PE format". The
build of the package (``hatch_build.py``) loads this file alone: it imports nothing of fuzzyarm.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

__all__ = ["Binary", "platform_tag", "read_binary"]


class Binary(NamedTuple):
    """A shared library, as its file tells it.

    Attributes
    ----------
    format : str
        ``ELF``, ``Mach-O`` or ``PE``.
    machine : str
        ``x86_64`` or ``aarch64``; of others the number of the format.
    oldest : tuple of int
        The oldest system that it runs on: of Linux the version of glibc, of macOS its own; empty
        where the file does not say.
    needs : tuple of str
        The libraries that it loads.
    signed : bool
        Whether it carries a signature, as macOS demands on arm64; of other formats false.
    """

    format: str
    machine: str
    oldest: tuple[int, ...]
    needs: tuple[str, ...]
    signed: bool = False


def read_binary(path: Path) -> Binary:
    """Read the header of a shared library.

    Parameters
    ----------
    path : path
        A file in one of the three formats, little-endian and of 64 bits.

    Raises
    ------
    ValueError
        If it has another format.
    """
    data = path.read_bytes()
    for magic, read in ((b"\x7fELF\x02\x01", _elf), (b"\xcf\xfa\xed\xfe", _mach_o), (b"MZ", _pe)):
        if data.startswith(magic):
            return read(data)
    raise ValueError(f"{path.name} is not a shared library of 64 bits: ELF, Mach-O or PE")


def platform_tag(path: Path) -> str:
    """Return the platform in the name of a wheel with this module.

    Of Linux with the oldest glibc that the module runs on (PEP 600), of macOS with its oldest
    version; a Linux without glibc has the tag ``linux``, which no index takes.
    """
    binary = read_binary(path)
    if binary.format == "PE":
        return {"x86_64": "win_amd64", "aarch64": "win_arm64"}.get(binary.machine, "win32")
    if binary.format == "Mach-O":
        machine = {"aarch64": "arm64"}.get(binary.machine, binary.machine)
        major, minor = binary.oldest or (11, 0)
        # Since macOS 11 a tag has no minor version.
        return f"macosx_{major}_{minor if major < 11 else 0}_{machine}"
    linux = "manylinux_{}_{}".format(*binary.oldest) if binary.oldest else "linux"
    return f"{linux}_{binary.machine}"


def _text_at(data: bytes, start: int) -> str:
    """Return the text from here to the next zero."""
    return data[start : data.index(b"\0", start)].decode()


# --- ELF ---

_ELF_MACHINES = {62: "x86_64", 183: "aarch64"}
_DYNAMIC, _NEEDED = 6, 1  # the type of a section, the tag of an entry


def _elf(data: bytes) -> Binary:
    """Read an ELF file by its sections: what the dynamic one needs, and the names it uses."""
    (machine,) = struct.unpack_from("<H", data, 18)
    (start,) = struct.unpack_from("<Q", data, 40)
    size, count = struct.unpack_from("<HH", data, 58)
    # name, type, flags, address, offset, size, link, info, alignment, size of an entry
    sections = [struct.unpack_from("<IIQQQQIIQQ", data, start + k * size) for k in range(count)]
    needs: list[str] = []
    versions: list[tuple[int, ...]] = []
    for section in sections:
        if section[1] != _DYNAMIC:
            continue
        names = sections[section[6]]
        for entry in range(section[4], section[4] + section[5], 16):
            tag, value = struct.unpack_from("<QQ", data, entry)
            if tag == _NEEDED:
                needs.append(_text_at(data, names[4] + value))
        # The versions of symbols are texts among the names of the dynamic section.
        text = data[names[4] : names[4] + names[5]]
        versions += [
            tuple(map(int, version.split(b".")))[:2]
            for version in re.findall(rb"\0GLIBC_(\d+\.\d+[.\d]*)(?=\0)", text)
        ]
    oldest = max(versions, default=())
    return Binary("ELF", _ELF_MACHINES.get(machine, str(machine)), oldest, tuple(needs))


# --- Mach-O ---

_MACH_MACHINES = {0x01000007: "x86_64", 0x0100000C: "aarch64"}
_LOAD_DYLIB, _CODE_SIGNATURE, _VERSION_MIN, _BUILD_VERSION = 0x0C, 0x1D, 0x24, 0x32


def _mach_o(data: bytes) -> Binary:
    """Read a Mach-O file by its load commands."""
    (machine,) = struct.unpack_from("<I", data, 4)
    oldest: tuple[int, ...] = ()
    needs, signed = [], False
    for command, start in _load_commands(data):
        if command == _LOAD_DYLIB:
            (name,) = struct.unpack_from("<I", data, start + 8)
            needs.append(_text_at(data, start + name))
        elif command in {_VERSION_MIN, _BUILD_VERSION}:
            # The platform stands in front of the version, where there is one.
            (version,) = struct.unpack_from(
                "<I", data, start + (8 if command == _VERSION_MIN else 12)
            )
            oldest = (version >> 16, version >> 8 & 0xFF)
        signed = signed or command == _CODE_SIGNATURE
    return Binary("Mach-O", _MACH_MACHINES.get(machine, str(machine)), oldest, tuple(needs), signed)


def _load_commands(data: bytes) -> Iterator[tuple[int, int]]:
    """Iterate over the commands of a Mach-O file: which, and where."""
    (count,) = struct.unpack_from("<I", data, 16)
    start = 32  # after the header of 64 bits
    for _ in range(count):
        command, size = struct.unpack_from("<II", data, start)
        yield command, start
        start += size


# --- PE ---

_PE_MACHINES = {0x8664: "x86_64", 0xAA64: "aarch64"}
_IMPORTS = 1  # of the directories of data


def _pe(data: bytes) -> Binary:
    """Read a PE file by its table of imports."""
    (head,) = struct.unpack_from("<I", data, 60)
    if data[head : head + 4] != b"PE\0\0":
        raise ValueError("a program of DOS, not a PE file")
    machine, count = struct.unpack_from("<HH", data, head + 4)
    (optional,) = struct.unpack_from("<H", data, head + 20)
    # size in memory, address in memory, size in the file, offset in the file
    sections = [
        struct.unpack_from("<IIII", data, head + 24 + optional + 40 * k + 8) for k in range(count)
    ]

    def offset(address: int) -> int:
        for size, begin, _, place in sections:
            if begin <= address < begin + size:
                return int(address - begin + place)
        raise ValueError("an import lies in no section")

    # Of 64 bits the directories begin 112 bytes after the optional header.
    (imports,) = struct.unpack_from("<I", data, head + 24 + 112 + 8 * _IMPORTS)
    needs = []
    at = offset(imports)
    while name := struct.unpack_from("<I", data, at + 12)[0]:
        needs.append(_text_at(data, offset(name)))
        at += 20
    return Binary("PE", _PE_MACHINES.get(machine, str(machine)), (), tuple(needs))
