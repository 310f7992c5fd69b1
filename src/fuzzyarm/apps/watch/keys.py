"""Keys of a terminal, one at a time, and their effect on a scene."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fuzzyarm.apps.watch.scenes import WatchScene

ARROWS = {"A": "up", "B": "down", "C": "right", "D": "left"}
"""The last character of a terminal's sequence for an arrow: ``ESC [ A``, ``ESC [ 1 ; 2 A``."""

WINDOWS_ARROWS = {"H": "up", "P": "down", "M": "right", "K": "left"}


def apply_key(scene: WatchScene, key: str) -> bool:
    """Change the crisp inputs or the axes of a scene; return whether it has changed."""
    arrow = key.removeprefix("shift-")
    across = arrow in ("left", "right")
    if across or arrow in ("up", "down"):
        steps = 1 if arrow in ("right", "up") else -1
        scene.step(across=across, steps=steps, coarse=key != arrow)
        return True
    actions = {
        "c": scene.centre,
        "x": lambda: scene.turn(across=True),
        "y": lambda: scene.turn(across=False),
        "o": scene.next_output,
    }
    action = actions.get(key)
    if action is not None:
        action()
    return action is not None


ReadKey = Callable[[float], str]
"""Returns the next key, or an empty text after some seconds without one."""


@contextmanager
def keys_of_terminal() -> Iterator[ReadKey]:
    """Read keys one by one without echo; the terminal is restored afterwards.

    Without a terminal there are no keys: the yielded reader only waits.
    """
    if not (sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()):
        yield _no_key
    elif sys.platform == "win32":
        yield _key_of_windows
    else:
        import termios
        import tty

        descriptor = sys.stdin.fileno()
        before = termios.tcgetattr(descriptor)
        tty.setcbreak(descriptor)
        try:
            yield partial(_key_of_posix, descriptor)
        finally:
            termios.tcsetattr(descriptor, termios.TCSADRAIN, before)


def _no_key(seconds: float) -> str:
    time.sleep(seconds)
    return ""


def _key_of_posix(descriptor: int, seconds: float) -> str:
    letter = _letter(descriptor, seconds)
    if letter != "\x1b":
        return letter
    # Characters that follow an escape at once belong to the same key.
    sequence = ""
    while not (len(sequence) > 1 and sequence[-1].isalpha()):
        letter = _letter(descriptor, 0.02)
        if not letter:
            return ""
        sequence += letter
    arrow = ARROWS.get(sequence[-1], "")
    return f"shift-{arrow}" if arrow and ";2" in sequence else arrow


def _letter(descriptor: int, seconds: float) -> str:
    import select

    if not select.select([descriptor], [], [], seconds)[0]:
        return ""
    data = os.read(descriptor, 1)
    if not data:  # the terminal has gone
        raise KeyboardInterrupt
    return data.decode("latin-1")


if sys.platform == "win32":

    def _key_of_windows(seconds: float) -> str:
        import msvcrt

        end = time.monotonic() + seconds
        while not msvcrt.kbhit():
            if time.monotonic() > end:
                return ""
            time.sleep(0.01)
        letter = msvcrt.getwch()
        if letter == "\x03":
            raise KeyboardInterrupt
        return WINDOWS_ARROWS.get(msvcrt.getwch(), "") if letter in "\x00\xe0" else letter
