"""Ctrl-C from the first import on, remembered whatever the code that it meets makes of it."""

from __future__ import annotations

import signal
from types import FrameType

heard: list[int] = []
"""The signals so far: an import that one ended may end in an error of another kind."""


def listen() -> None:
    """Remember Ctrl-C, unless the caller has a handler of its own or ignores it."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)


def ignore() -> None:
    """Ignore Ctrl-C while the process ends, unless the caller has a handler of its own."""
    if signal.getsignal(signal.SIGINT) is _interrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _interrupt(number: int, _frame: FrameType | None) -> None:
    heard.append(number)
    raise KeyboardInterrupt
