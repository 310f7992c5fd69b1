"""What a compiled module is, read of its file: of ours, and of files laid out by hand."""

import struct
import sys
from pathlib import Path

import pytest

from fuzzyarm.apps.native.binaries import Binary, platform_tag, read_binary


def elf(names, needed, machine=62):
    """Lay out an ELF file with the names and the dynamic section alone."""
    names = b"\0" + b"\0".join(names) + b"\0"
    places = [names.index(b"\0" + name + b"\0") + 1 for name in needed]
    dynamic = b"".join(struct.pack("<QQ", 1, place) for place in places) + bytes(16)
    start = 64 + len(names) + len(dynamic)
    head = b"\x7fELF\x02\x01\x01" + bytes(9) + struct.pack("<HHIQQQ", 3, machine, 1, 0, 0, start)
    head += struct.pack("<IHHHHHH", 0, 64, 0, 0, 64, 2, 0)
    sections = struct.pack("<IIQQQQIIQQ", 0, 3, 0, 0, 64, len(names), 0, 0, 1, 0)
    sections += struct.pack("<IIQQQQIIQQ", 0, 6, 0, 0, 64 + len(names), len(dynamic), 0, 0, 8, 16)
    return head + names + dynamic + sections


def mach_o(machine, version, *, signed, platform=True):
    """Lay out a Mach-O file with load commands alone."""
    name = b"/usr/lib/libSystem.B.dylib\0"
    name += bytes(-len(name) % 8)
    commands = [struct.pack("<IIIIII", 0x0C, 24 + len(name), 24, 0, 0, 0) + name]
    number = version[0] << 16 | version[1] << 8
    if platform:
        commands.append(struct.pack("<IIIIII", 0x32, 24, 1, number, 0, 0))
    else:
        commands.append(struct.pack("<IIII", 0x24, 16, number, 0))
    if signed:
        commands.append(struct.pack("<IIII", 0x1D, 16, 0, 0))
    body = b"".join(commands)
    return (
        struct.pack("<IIIIIIII", 0xFEEDFACF, machine, 0, 6, len(commands), len(body), 0, 0) + body
    )


def pe(libraries, machine=0x8664):
    """Lay out a PE file with a table of imports alone."""
    begin, place = 0x1000, 512  # in memory, in the file
    table = 20 * (len(libraries) + 1)
    rows, names = b"", b""
    for library in libraries:
        rows += struct.pack("<IIIII", 0, 0, 0, begin + table + len(names), 0)
        names += library + b"\0"
    data = rows + bytes(20) + names
    optional = struct.pack("<H", 0x20B) + bytes(110) + struct.pack("<IIII", 0, 0, begin, len(data))
    head = b"MZ" + bytes(58) + struct.pack("<I", 64) + b"PE\0\0"
    head += struct.pack("<HHIIIHH", machine, 1, 0, 0, 0, len(optional), 0) + optional
    head += b".rdata\0\0" + struct.pack("<IIII", len(data), begin, len(data), place) + bytes(16)
    return head.ljust(place, b"\0") + data


@pytest.mark.parametrize(
    ("data", "binary", "tag"),
    [
        (
            elf([b"GLIBC_2.4", b"libm.so.6", b"GLIBC_2.17", b"pow", b"libc.so.6"], [b"libm.so.6"]),
            Binary("ELF", "x86_64", (2, 17), ("libm.so.6",)),
            "manylinux_2_17_x86_64",
        ),
        (
            elf([b"libc.musl.so", b"GLIBC_2.99x"], [b"libc.musl.so"], machine=183),
            Binary("ELF", "aarch64", (), ("libc.musl.so",)),
            "linux_aarch64",
        ),
        (
            mach_o(0x0100000C, (11, 3), signed=True),
            Binary("Mach-O", "aarch64", (11, 3), ("/usr/lib/libSystem.B.dylib",), True),
            "macosx_11_0_arm64",
        ),
        (
            mach_o(0x01000007, (10, 15), signed=False, platform=False),
            Binary("Mach-O", "x86_64", (10, 15), ("/usr/lib/libSystem.B.dylib",)),
            "macosx_10_15_x86_64",
        ),
        (
            pe([b"python3.dll", b"KERNEL32.dll"]),
            Binary("PE", "x86_64", (), ("python3.dll", "KERNEL32.dll")),
            "win_amd64",
        ),
    ],
)
def test_what_a_file_says_of_itself(data, binary, tag, tmp_path):
    file = tmp_path / "_kernels"
    file.write_bytes(data)
    assert read_binary(file) == binary
    assert platform_tag(file) == tag


@pytest.mark.parametrize("data", [b"", b"MZ" + bytes(80), b"\x7fELF\x01\x01" + bytes(80)])
def test_what_is_no_library_of_64_bits_is_refused(data, tmp_path):
    file = tmp_path / "_kernels"
    file.write_bytes(data)
    with pytest.raises(ValueError, match=r"is not a shared library|not a PE file"):
        platform_tag(file)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names the libraries of Linux")
def test_our_own_module():
    module = pytest.importorskip("fuzzyarm._kernels", reason="no machine code was built")
    binary = read_binary(Path(module.__file__))
    assert binary.format == "ELF"
    assert "libc.so.6" in binary.needs
    assert binary.oldest >= (2, 14)  # its memcpy
