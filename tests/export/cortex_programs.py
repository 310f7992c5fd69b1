"""Controllers on a Cortex-M3: built with arm-none-eabi-gcc, run by qemu-system-arm.

The board is TI's Stellaris LM3S6965: 256 KB of flash at 0, 64 KB of RAM; files are those of the
host, by semihosting.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
from c_programs import STRICT
from controller_programs import driver
from needs import need

from fuzzyarm.exchange.export.c_files import controller_c

TOOLS = ("arm-none-eabi-gcc", "qemu-system-arm")

_LAYOUT = """MEMORY
{
    flash (rx) : ORIGIN = 0, LENGTH = 256K
    ram (rwx) : ORIGIN = 0x20000000, LENGTH = 64K
}
ENTRY(_start)
SECTIONS
{
    .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) *(.init) *(.fini) } > flash
    .exidx : { *(.ARM.exidx*) } > flash
    __exidx_start = 0;
    __exidx_end = 0;
    .data : { *(.data*) } > ram
    .bss : { __bss_start__ = .; *(.bss*) *(COMMON) __bss_end__ = .; } > ram
    end = .;
    __end__ = .;
    __stack = ORIGIN(ram) + LENGTH(ram);
}
"""

_START = """    .section .vectors, "a"
    .word __stack
    .word _start
"""


def need_cortex() -> None:
    """Skip where the compiler or the emulator is missing."""
    need(*TOOLS)


def run_on_cortex(name, steps, rows, folder: Path):
    """Run a controller over rows on the processor; return its drives, row by row, and its flash."""
    made = controller_c(steps, name, name, ".h", None, ["for a test"])
    (folder / f"{name}.h").write_text(made.files[".h"])
    (folder / "in.bin").write_bytes(np.ascontiguousarray(rows, np.float64).tobytes())
    main = [
        "#include <stdio.h>", f'#include "{name}.h"', driver(steps, name),
        "int main(void)", "{",
        '    FILE *in = fopen("in.bin", "rb"), *to = fopen("to.bin", "wb");',
        "    if (in == NULL || to == NULL) {", "        return 3;", "    }",
        f"    if (run_{name}(in, to, {len(rows)}L) != 0) {{", "        return 1;", "    }",
        "    fclose(in);", "    return fclose(to);", "}",
    ]  # fmt: skip
    (folder / "main.c").write_text("\n".join([*main, ""]))
    (folder / "start.s").write_text(_START)
    (folder / "layout.ld").write_text(_LAYOUT)
    target = ["-mcpu=cortex-m3", "-mthumb", "-O2", "-ffp-contract=off"]
    library = ["--specs=rdimon.specs", "-T", "layout.ld", "start.s", "main.c", "-lm", "-o", "made"]
    words = ["arm-none-eabi-gcc", *STRICT, *target, *library]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    machine = ["-M", "lm3s6965evb", "-nographic", "-semihosting", "-kernel", "made"]
    done = subprocess.run(
        ["qemu-system-arm", *machine], cwd=folder, capture_output=True, text=True, check=False,
        timeout=120, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    width = len(steps.of_sort("drive"))
    return np.frombuffer((folder / "to.bin").read_bytes()).reshape(len(rows), width)
