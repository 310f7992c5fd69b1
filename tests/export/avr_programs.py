"""Programs for AVR boards: built with avr-gcc, with the Arduino core or bare, and run in simavr."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from needs import ARDUINO_CORE as CORE
from needs import need

STRICT = ["-Wall", "-Wextra", "-Werror"]
_OF_OTHER_BOARDS = {"CDC", "PluggableUSB", "USBCore", "IPAddress", "Tone"}

TARGET = ["-mmcu=atmega328p", "-DF_CPU=16000000UL", "-Os", "-ffunction-sections", "-fdata-sections"]


def need_avr(*, simulated: bool = True, core: bool = False) -> None:
    """Skip where avr-gcc, simavr or the Arduino core is missing."""
    need("avr-gcc", *(["simavr"] if simulated else []), *(["arduino-core-avr"] if core else []))


def build(folder: Path, *words: str | Path) -> None:
    """Call avr-gcc; fail with what it says, warnings included."""
    done = subprocess.run(
        ["avr-gcc", *map(str, words)], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def simulate(program: Path, seconds: float = 300.0) -> str:
    """Run a program until it sleeps without interrupts; return what it said on its serial line."""
    words = ["simavr", "-m", "atmega328p", "-f", "16000000", str(program)]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=seconds)
    return re.sub(r"\x1b\[\d*m", "", done.stdout + done.stderr)


def arduino_core(folder: Path) -> Path:
    """Return the Arduino core for the Uno as an archive, built in a folder."""
    archive = folder / "core.a"
    if archive.exists():
        return archive
    sources = [
        each
        for each in sorted((CORE / "cores" / "arduino").iterdir())
        if each.suffix in (".c", ".cpp", ".S") and each.stem not in _OF_OTHER_BOARDS
    ]
    objects = []
    for kind in (".c", ".cpp", ".S"):
        chosen = [each for each in sources if each.suffix == kind]
        language = {".c": "-std=gnu11", ".cpp": "-std=gnu++11", ".S": "-x"}[kind]
        extra = ["-fno-exceptions", "-fno-threadsafe-statics"] if kind == ".cpp" else []
        flags = [language, *(["assembler-with-cpp"] if kind == ".S" else []), *extra]
        build(folder, *TARGET, "-w", *flags, *core_paths(), "-c", *chosen)
        objects += [f"{each.stem}.o" for each in chosen]
    subprocess.run(["avr-ar", "rcs", archive.name, *objects], cwd=folder, check=True)
    return archive


def core_paths() -> list[str]:
    """Return what a sketch needs to find the core."""
    return [
        "-DDECIMAL_DIG=9",  # which <float.h> of Debian's old avr-gcc lacks in C++
        "-DARDUINO=10819", "-DARDUINO_AVR_UNO", "-DARDUINO_ARCH_AVR",
        f"-I{CORE / 'cores' / 'arduino'}", f"-I{CORE / 'variants' / 'standard'}",
    ]  # fmt: skip


def run_sketch(library: Path, sketch: Path, folder: Path) -> str:
    """Build a sketch as the Arduino IDE does, run it, and return the first lines that it says.

    A program that sleeps without interrupts ends the simulation, which a sketch never does: the
    sketch is built with a `delay` that does, after the first turn of its loop.
    """
    ending = (
        "#include <Arduino.h>\n#include <avr/sleep.h>\n"
        "static void stop(unsigned long) { Serial.flush(); cli(); sleep_enable(); sleep_cpu(); }\n"
        "#define delay stop\n"
    )
    text = sketch.read_text("utf-8")
    if "delay(" not in text:
        text = text.replace("void loop()\n{\n", "void loop()\n{\n    delay(1);\n")
    return run_sketch_text(library, f"{ending}{text}", folder)


def run_sketch_text(library: Path, text: str, folder: Path) -> str:
    """Build a sketch that ends as the Arduino IDE does, and run it."""
    archive = arduino_core(folder)
    (folder / "sketch.cpp").write_text(text, "utf-8")
    sources = [each for each in sorted((library / "src").iterdir()) if each.suffix == ".c"]
    include = f"-I{library / 'src'}"
    build(folder, *TARGET, *STRICT, "-std=gnu11", include, "-c", *sources)
    build(
        folder, *TARGET, "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter", "-std=gnu++11",
        "-fno-exceptions", "-fno-threadsafe-statics", include, *core_paths(), "-c", "sketch.cpp",
    )  # fmt: skip
    objects = ["sketch.o", *(f"{each.stem}.o" for each in sources)]
    build(
        folder, *TARGET, "-Wl,--gc-sections", *objects, archive, "-lm", "-o", "sketch",
    )  # fmt: skip
    return simulate(folder / "sketch")


_CYCLES = """#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdio.h>
#include "HEADER"

static volatile unsigned turns;

ISR(TIMER1_OVF_vect)
{
    turns++;
}

static int put(char letter, FILE *stream)
{
    (void)stream;
    while (!(UCSR0A & (1 << UDRE0))) {
    }
    UDR0 = (uint8_t)letter;
    return 0;
}

static FILE serial = FDEV_SETUP_STREAM(put, 0, _FDEV_SETUP_WRITE);

POINTS

int main(void)
{
    int k;
    UBRR0 = 8;
    UCSR0B = 1 << TXEN0;
    TIMSK1 = 1 << TOIE1;
    stdout = &serial;
    for (k = 0; k < COUNT; k++) {
        volatile KIND a = points[k][0], b = points[k][1], result;
        unsigned long ticks;
        turns = 0;
        TCCR1A = 0;
        TCNT1 = 0;
        sei();
        TCCR1B = 1 << CS11;
        result = CALL(a, b);
        ticks = TCNT1;
        TCCR1B = 0;
        cli();
        (void)result;
        printf("cycles=%lu\\n", 8ul * ticks + 8ul * 65536ul * turns);
    }
    printf("\\n\\n");
    sleep_enable();
    sleep_cpu();
    return 0;
}
"""


def cycles_by_eighths(folder: Path, header: str, kind: str, call: str, points) -> list[int]:
    """Return the cycles of calls to within some ten: timer 1 counts every eighth, with overflows.

    `folder` has the sources of the library.
    """
    rows = ", ".join(f"{{{a}, {b}}}" for a, b in points)
    words = {
        "HEADER": header, "KIND": kind, "CALL": call, "COUNT": str(len(points)),
        "POINTS": f"static const {kind} points[{len(points)}][2] = {{{rows}}};",
    }  # fmt: skip
    text = re.sub(r"\b(" + "|".join(words) + r")\b", lambda match: words[match[0]], _CYCLES)
    (folder / "count.c").write_text(text)
    source = header.replace(".h", ".c")
    build(folder, *TARGET, "-std=gnu11", "count.c", source, "-lm", "-o", "count")
    return [int(each) for each in re.findall(r"cycles=(\d+)", simulate(folder / "count"))]
