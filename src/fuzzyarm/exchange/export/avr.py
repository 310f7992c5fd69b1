"""A library measured on an AVR: built with avr-gcc, run in simavr, cycles and bytes counted.

At the end the period of a controller on a board: the clock that counts it, and whether a call fits.
"""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.boards import Board, Footprint
from fuzzyarm.exchange.export.document import filled_text
from fuzzyarm.exchange.export.numbers import ExportError

FLAGS = ("-Os", "-std=gnu11", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections")
"""Those of the Arduino IDE, without its link-time optimisation."""

TOOLS = "gcc-avr avr-libc binutils-avr simavr"
"""Packages of Debian and Ubuntu that measuring needs."""

_SECONDS = 120.0

_ROOMY = "atmega1284p"
"""An Uno's instructions and cycles, and 128 KB: runs programs that fit without their self-test."""


@dataclass(frozen=True)
class MeasuredStep:
    """A step to measure, as parts of a C program."""

    header: str  # its includes
    # Text outside of functions: variables, and the numbers of the calls.
    declarations: Sequence[str]
    start: Sequence[str]  # statements executed once
    load: Sequence[str]  # statements that set the numbers of call `k`
    call: str  # the measured statement
    count: int  # how many calls there are
    arrays: int  # bytes of variables of the program around the library, not part of its cost
    self_test: str  # the function that tests the library


@json_properties(
    "compiler=program flash=footprint.flash object ram=footprint.static stack cycles"
    " self_test=passes"
)
@dataclass(frozen=True)
class Measured:
    """The cost of a library on a processor.

    Attributes
    ----------
    compiler : str
        Which avr-gcc.
    footprint : Footprint
        Bytes of a program with this call alone, less those of an empty program.
    object : int
        Bytes of the library's own object file, tables included.
    cycles : tuple of int or None
        Of the calls; None without a simulator.
    passes : bool or None
        Whether the self-test passes.
    """

    compiler: str
    footprint: Footprint
    object: int
    cycles: tuple[int, ...] | None
    passes: bool | None

    @property
    def program(self) -> str:
        """The compiler and its version."""
        return f"avr-gcc {self.compiler}"

    @property
    def stack(self) -> int | None:
        """Greatest stack of a call; None if no simulator measured it."""
        return self.footprint.stack if self.cycles else None


def has_compiler() -> bool:
    """Return whether AVR programs can be built here."""
    return all(shutil.which(name) for name in ("avr-gcc", "avr-size"))


def has_simulator() -> bool:
    """Return whether AVR programs can be run here."""
    return shutil.which("simavr") is not None


def measure(board: Board, files: Mapping[str, str], stem: str, call: MeasuredStep) -> Measured:
    """Build a library for a board and measure its cost."""
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as name:
        folder = Path(name)
        for file, text in files.items():
            (folder / file).write_text(text, "utf-8")
        blocks = vars(call)
        (folder / "size.c").write_text(filled_text(_SIZE, blocks), "utf-8")
        target = [f"-mmcu={board.processor}", f"-DF_CPU={board.clock}UL", *FLAGS]
        compiler = _say(["avr-gcc", "-dumpversion"], folder).strip()
        _say(["avr-gcc", *target, "-c", f"{stem}.c", "-o", "own.o"], folder)
        size = sum(_sizes("own.o", folder)[:2])
        # With room for an oversized program, whose size is then known.
        roomy = "-Wl,--defsym=__TEXT_REGION_LENGTH__=8192K"
        for flag, program in (("-DNOTHING", "nothing"), ("-DCALL", "calling")):
            sources = ["size.c", f"{stem}.c", "-o", program, "-lm", roomy]
            _say(["avr-gcc", *target, flag, *sources], folder)
        without, calling = _sizes("nothing", folder), _sizes("calling", folder)
        code, data, bss = (a - b for a, b in zip(calling, without, strict=True))
        flash, static = code + data, data + bss - call.arrays
        parts = "code, tables and arithmetic"
        fits = flash <= board.flash and static < board.ram
        if not has_simulator() or not fits:
            return Measured(compiler, Footprint(flash, static, 0, parts), size, None, None)
        (folder / "run.c").write_text(filled_text(_RUN, blocks), "utf-8")
        sources = ["run.c", f"{stem}.c", f"{stem}_self_test.c", "-o", "run", "-lm"]
        _say(["avr-gcc", *target, *sources, roomy], folder)
        processor = board.processor
        if sum(_sizes("run", folder)[:2]) > board.flash:  # with the self-test
            processor = _ROOMY
            _say(["avr-gcc", f"-mmcu={_ROOMY}", *target[1:], *sources], folder)
        output = _say(["simavr", "-m", processor, "-f", str(board.clock), "run"], folder)
        figures = _figures(output)
        stack = max(figures.get("stack", [0])) - min(figures.get("empty", [0]))
        # One more than the calls: the first is that of an empty one.
        if len(figures.get("low", [])) != call.count + 1 or "test" not in figures:
            raise ExportError(f"simavr ended early: {output.strip()[-200:]}")
        footprint = Footprint(flash, static, stack, parts)
        return Measured(compiler, footprint, size, _cycles(figures), figures["test"] == [0])


def _say(words: Sequence[str], folder: Path) -> str:
    """Run a program and return its output."""
    process = run_tool(words, folder, _SECONDS, to="measure with")
    return process.stdout + process.stderr


_ERROR = re.compile(r"error\b", re.IGNORECASE)
"""Mark of the line with the cause in a tool's output; lines before it name the position."""


def run_tool(
    words: Sequence[str], folder: Path, seconds: float, *, to: str = "run"
) -> subprocess.CompletedProcess[str]:
    """Run a compiler, a simulator or the like in a folder; ExportError if it fails or takes longer.

    `to` is its purpose, for the message: *cannot run gcc*.
    """
    try:
        process = subprocess.run(
            words, cwd=folder, capture_output=True, text=True, check=False, timeout=seconds
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ExportError(f"cannot {to} {words[0]}: {error}") from None
    if process.returncode != 0:
        said = process.stderr.strip().splitlines()
        text = next((line.strip() for line in [*filter(_ERROR.search, said), *said]), "no message")
        raise ExportError(f"{words[0]} failed: {text}")
    return process


def _sizes(file: str, folder: Path) -> tuple[int, int, int]:
    """Return text, data and bss of a file."""
    numbers = _say(["avr-size", file], folder).splitlines()[1].split()
    return int(numbers[0]), int(numbers[1]), int(numbers[2])


_SIZE = """
#include "<header>"
#ifdef CALL
<declarations>
int main(void)
{
    int k = 0;
    <start>
    for (;;) {
        <load>
        <call>
    }
}
#else
int main(void)
{
    for (;;) {
    }
}
#endif
"""

# Timer 1 counts 16 bits: first every cycle, then every 1,024th. A call takes the same cycles each
# time, so both readings determine them; the time of an empty call is subtracted.
_RUN = """#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include "<header>"

<declarations>

extern uint8_t _end;
static volatile int k;

static void letter(char letter)
{
    while (!(UCSR0A & (1 << UDRE0))) {
    }
    UDR0 = (uint8_t)letter;
}

static void say(const char *word, unsigned long number)
{
    char digits[12];
    int n = 0;
    while (*word) {
        letter(*word++);
    }
    do {
        digits[n++] = (char)('0' + number % 10);
        number /= 10;
    } while (number);
    while (n) {
        letter(digits[--n]);
    }
    letter('\\n');
}

static void __attribute__((noinline)) nothing(void)
{
    __asm__ volatile("");
}

static void __attribute__((noinline)) step(void)
{
    <call>
}

static uint16_t __attribute__((noinline)) ticks(void (*call)(void), uint8_t clock)
{
    TCCR1B = 0;
    TCNT1 = 0;
    GTCCR = 1 << PSRSYNC;
    TCCR1B = clock;
    call();
    {
        const uint16_t count = TCNT1;
        TCCR1B = 0;
        return count;
    }
}

static uint16_t __attribute__((noinline)) depth(void (*call)(void))
{
    uint8_t *at;
    uint8_t *const top = (uint8_t *)SP + 1; /* nothing interrupts: all below is free */
    for (at = &_end; at < top; at++) {
        *at = 0xA5;
    }
    call();
    for (at = &_end; at < top && *at == 0xA5; at++) {
    }
    return (uint16_t)(top - at);
}

int main(void)
{
    UBRR0 = 8;
    UCSR0B = 1 << TXEN0;
    TCCR1A = 0;
    say("test=", (unsigned long)<self_test>());
    <start>
    say("low=", ticks(nothing, 1));
    say("empty=", depth(nothing));
    for (k = 0; k < <count>; k++) {
        <load>
        say("low=", ticks(step, 1));
    }
    <start>
    for (k = 0; k < <count>; k++) {
        <load>
        say("high=", ticks(step, 5));
    }
    <start>
    for (k = 0; k < <count>; k++) {
        <load>
        say("stack=", depth(step));
    }
    letter('\\n');
    letter('\\n'); /* what was said before is out */
    cli();
    sleep_enable();
    sleep_cpu();
    return 0;
}
"""


def _figures(output: str) -> dict[str, list[int]]:
    """Return the numbers printed by a program, by their words."""
    figures: dict[str, list[int]] = {}
    for word, number in re.findall(r"(low|high|stack|empty|test)=(\d+)", output):
        figures.setdefault(word, []).append(int(number))
    return figures


def _cycles(figures: dict[str, list[int]]) -> tuple[int, ...]:
    empty, *lows = figures["low"]
    cycles = []
    for low, high in zip(lows, figures["high"], strict=True):
        # How often the 16 bits of the quick count went round.
        turns = round((high * 1024 - low) / 65536)
        cycles.append(low + 65536 * turns - empty)
    return tuple(cycles)


SHORTEST = 100
"""The shortest period of a board, in µs: half of one is 0.5 % of it."""

_MOST_COUNTS = 2**31
"""Half of the 32-bit range: a delay of the loop below it is recognised."""

SHARE = 0.9
"""Share of a period that a call may take."""

PIN_SECONDS = 112e-6
"""Time of ``analogRead`` on an AVR, as the Arduino core sets its converter up."""


@dataclass(frozen=True, slots=True)
class Clock:
    """A function of the Arduino core, and the period in its counts."""

    function: str
    count: int
    unit: str


def clock_of(period: float) -> Clock:
    """Return the counter of a period, rounded to whole counts; ExportError if it is too short.

    The longest period of the language, an hour, is within the milliseconds.
    """
    micros = round(period * 1e6)
    if micros < SHORTEST:
        raise ExportError(
            f"a period of {number_text(period)} s is too short for a board, which counts"
            f" microseconds: at least {SHORTEST} µs",
            hint=f"period {SHORTEST} us; or plain C, as in -o law.c, called by a timer interrupt",
        )
    if micros <= _MOST_COUNTS:
        return Clock("micros", micros, "µs")
    return Clock("millis", round(period * 1e3), "ms")


@dataclass(frozen=True, slots=True)
class Pace:
    """Time of a turn of the sketch, in s: the slowest measured call, and its pins."""

    call: float
    pins: float

    @property
    def whole(self) -> float:
        """Both."""
        return self.call + self.pins


def pace_of(measured: Measured | None, board: Board, inputs: int) -> Pace | None:
    """Return the cost of a turn; None if no cycles were counted."""
    if measured is None or not measured.cycles:
        return None
    return Pace(max(measured.cycles) / board.clock, min(inputs, board.pins) * PIN_SECONDS)


def demand_pace(
    pace: Pace | None,
    period: float,
    name: str,
    board: Board,
    others: Mapping[str, Callable[[], Pace | None]],
) -> None:
    """Raise `ExportError` if a turn takes over 90 % of the period, with feasible options."""
    if pace is None or pace.whole <= SHARE * period:
        return
    reading = f" and {_short(pace.pins)} to read its pins" if pace.pins else ""
    raise ExportError(
        f"'{name}' takes {_short(pace.call)} a call{reading} on {board.named},"
        f" {100.0 * pace.whole / period:.0f} % of its period of {_short(period)}, and"
        f" {100.0 * SHARE:.0f} % is the most",
        hint=_fitting(pace, period, others),
    )


def _fitting(pace: Pace, period: float, others: Mapping[str, Callable[[], Pace | None]]) -> str:
    """Return the feasible options: the first one that fits, and a longer period."""
    words = [f"a period of {_short(_rounded_up(pace.whole / SHARE))} holds it"]
    for option, made in others.items():
        other = made()
        if other is not None and other.whole <= SHARE * period:
            return f"with {option} it takes {_short(other.whole)}; {words[0]} as it is"
        if other is not None and other.whole < 0.8 * pace.whole:
            longer = _short(_rounded_up(other.whole / SHARE))
            words.append(f"with {option} {longer} does")
    return ", ".join(words)


def unchecked(measured: Measured | None, board: Board, period: float) -> str:
    """Return a sentence on a period that could not be checked; empty after a check."""
    if measured is not None and measured.cycles:
        return ""
    why = f"that needs {TOOLS}" if board.avr else "cycles are counted for AVR boards"
    return f"Not checked: whether a call fits into the period of {_short(period)}; {why}."


def _rounded_up(seconds: float) -> float:
    """Return a time rounded up to two digits."""
    step = 10.0 ** (math.floor(math.log10(seconds)) - 1)
    return math.ceil(seconds / step) * step


def _short(seconds: float) -> str:
    """Return a time in three digits, in its unit."""
    for factor, unit in ((1.0, "s"), (1e-3, "ms")):
        if seconds >= factor:
            return f"{seconds / factor:.3g} {unit}"
    return f"{seconds * 1e6:.3g} µs"
