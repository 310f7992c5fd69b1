"""Ctrl-C from the first import on, recorded even if the interrupted code swallows it."""

from __future__ import annotations

import signal
from types import FrameType

heard: list[int] = []
"""Signals so far: an interrupted import may end in another error."""


def listen() -> None:
    """Record Ctrl-C, unless the caller handles or ignores it."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)


def ignore() -> None:
    """Ignore Ctrl-C while the process ends, unless the caller handles it."""
    if signal.getsignal(signal.SIGINT) is _interrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _interrupt(number: int, _frame: FrameType | None) -> None:
    heard.append(number)
    raise KeyboardInterrupt
