"""Boards: their memory, and whether an exported file fits."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.base.names import near_hint
from fuzzyarm.exchange.export.numbers import ExportError


@dataclass(frozen=True, slots=True)
class Board:
    """A board of the Arduino world.

    Attributes
    ----------
    name : str
        Its name in commands.
    title : str
        Its usual name.
    processor : str
        Its chip; of an AVR as avr-gcc calls it.
    flash, ram : int
        Bytes for a program and for its variables, as the IDE has them.
    has_double : bool
        Whether ``double`` is more than ``float``.
    avr : bool
        Whether it is an AVR, with flash in a separate address space.
    platform, environment : str
        Of PlatformIO.
    pins : int
        Analogue inputs, A0 first.
    analog_top : int
        The largest value of ``analogRead`` after a reset.
    clock : int
        In Hz.
    """

    name: str
    title: str
    processor: str
    flash: int
    ram: int
    has_double: bool
    avr: bool
    platform: str
    environment: str
    pins: int
    analog_top: int
    clock: int

    @property
    def named(self) -> str:
        """The title with its article."""
        return f"{'an' if self.title[0] in 'AEIOU' else 'a'} {self.title}"

    @property
    def precision(self) -> str:
        """Default precision of programs for it."""
        return "mixed" if self.has_double else "float32"


_UNO = ("atmega328p", 32_256, 2_048, False, True, "atmelavr", "uno", 6, 1023, 16_000_000)
_NANO = ("atmega328p", 30_720, 2_048, False, True, "atmelavr", "nanoatmega328", 8, 1023, 16_000_000)
_MEGA = ("atmega2560", 253_952, 8_192, False, True, "atmelavr", "megaatmega2560", 16, 1023,
         16_000_000)  # fmt: skip
_DUE = ("SAM3X8E", 524_288, 98_304, True, False, "atmelsam", "due", 12, 1023, 84_000_000)
_PICO = ("RP2040", 2_097_152, 262_144, True, False, "raspberrypi", "pico", 3, 1023, 133_000_000)
_ESP32 = ("ESP32", 1_310_720, 327_680, True, False, "espressif32", "esp32dev", 6, 4095, 240_000_000)

BOARDS = {
    board.name: board
    for board in (
        Board("uno", "Arduino Uno", *_UNO),
        Board("nano", "Arduino Nano", *_NANO),
        Board("mega", "Arduino Mega 2560", *_MEGA),
        Board("due", "Arduino Due", *_DUE),
        Board("pico", "Raspberry Pi Pico", *_PICO),
        Board("esp32", "ESP32", *_ESP32),
    )
}
"""All boards, by name."""


def board_named(name: str) -> Board:
    """Return a board; ExportError if its name is unknown."""
    if name not in BOARDS:
        raise ExportError(
            f"no board '{name}'",
            hint=near_hint(name, BOARDS)[0] or f"there are {', '.join(BOARDS)}",
        )
    return BOARDS[name]


@dataclass(frozen=True, slots=True)
class Footprint:
    """The memory of a program on a board, in bytes.

    Attributes
    ----------
    flash : int
        Code and constants, or constants alone without a compiler.
    static : int
        Static variables.
    stack : int
        Further RAM of a call, at most.
    what : str
        The content of `flash`, in words.
    constants, largest : int
        Bytes of constants, and of the largest array of them.
    """

    flash: int
    static: int
    stack: int
    what: str
    constants: int = 0
    largest: int = 0


_REACH = 64_000
"""Bytes of constants that an AVR reads by 16 bits, less some for its vectors and the core's own."""

_LARGEST_ARRAY = 32_767
"""Bytes of an array of avr-gcc, whose `int` has 16 bits."""


def demand_fit(footprint: Footprint, board: Board, name: str) -> None:
    """Raise `ExportError` for a program larger than a board, with the numbers."""
    ram = footprint.static + footprint.stack
    if footprint.flash > board.flash:
        raise ExportError(
            f"'{name}' takes {footprint.flash:,} bytes of flash ({footprint.what}), and"
            f" {board.named} has {board.flash:,}",
            hint=f"--table --levels 9 --q 7 is small; {_larger(board, footprint)}",
        )
    if ram > board.ram:
        raise ExportError(
            f"'{name}' takes {ram:,} bytes of RAM ({footprint.static:,} of variables,"
            f" {footprint.stack:,} of stack), and {board.named} has {board.ram:,}",
            hint=f"fewer cells that learn; {_larger(board, footprint)}",
        )
    for size, limit, what in _reached(footprint, board):
        if size > limit:
            raise ExportError(
                f"'{name}' has {size:,} bytes {what}, and {board.named} reads at most {limit:,}"
                f" of its {board.flash:,} bytes of flash so",
                hint=f"--q 7 or fewer --levels; {_larger(board, footprint)}",
            )


def _reached(footprint: Footprint, board: Board) -> list[tuple[int, int, str]]:
    """Return sizes of constants beside the board's address limits."""
    if not board.avr:
        return []
    return [
        (footprint.largest, _LARGEST_ARRAY, "in one array"),
        (footprint.constants, _REACH, "of constants"),
    ]


def _larger(board: Board, footprint: Footprint) -> str:
    """Name the boards that hold so much."""
    ram = footprint.static + footprint.stack
    fitting = [
        larger.name
        for larger in BOARDS.values()
        if larger is not board
        and larger.flash >= footprint.flash
        and larger.ram >= ram
        and all(size <= limit for size, limit, _ in _reached(footprint, larger))
    ]
    return f"--board {' or '.join(fitting)} holds it" if fitting else "no board here holds it"
