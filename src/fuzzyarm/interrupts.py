"""Ctrl-C in the process of the command, from the first line of the package to the exit status.

While modules load there is nothing to undo, and an interrupted import may end in any error: the
process leaves at once (:func:`leave`). Once a command runs, Ctrl-C is a KeyboardInterrupt that
is recorded, in case the interrupted code swallows it (:func:`listen`). What comes earlier, the
start of the interpreter and its ``site``, is beyond reach: some 10 ms.

This module is imported before all others and imports nothing that is not loaded already;
``signal`` alone would load ``enum``.
"""

import atexit
import os
import sys

TYPE_CHECKING = False  # typing's own would load typing
if TYPE_CHECKING:
    import signal
    from types import FrameType
else:
    import _signal as signal

INTERRUPTED = 130

heard: list[int] = []
"""Signals so far: an interrupted import may end in another error."""


def is_command() -> bool:
    """Whether this process is the command: its script, or ``python -m fuzzyarm``."""
    words = sys.orig_argv
    if sys.argv[:1] == ["-m"]:  # the package of a module that Python looks for
        return words[words.index("-m") + 1 :][:1] == ["fuzzyarm"] if "-m" in words else False
    return os.path.basename(sys.argv[0] if sys.argv else "") in ("fuzzyarm", "fuzzyarm.exe")


def leave() -> None:
    """Let Ctrl-C end the process in one line, unless the caller handles or ignores it."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)


def listen() -> None:
    """Raise and record Ctrl-C from now on, where it has ended the process until now."""
    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, _interrupt)


def ignore() -> None:
    """Ignore Ctrl-C while the process ends, unless the caller handles it."""
    if signal.getsignal(signal.SIGINT) in (_leave, _interrupt):
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def end_interrupted() -> None:
    """Let the exit status be 130: Python forgets it after a KeyboardInterrupt inside ``exec``."""
    _ended.append(INTERRUPTED)


_ended: list[int] = []


def _leave(_number: int, _frame: "FrameType | None") -> None:
    os.write(2, b"fuzzyarm: interrupted\n")
    os._exit(INTERRUPTED)


def _interrupt(number: int, _frame: "FrameType | None") -> None:
    heard.append(number)
    raise KeyboardInterrupt


@atexit.register  # before all others, so called after them
def _end() -> None:
    if _ended:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        os._exit(_ended[-1])
