"""Commands in a process that has everything loaded, and that is ended where one hangs.

``Worker`` runs ``fuzzyarm.apps.cli.main.main`` again and again in one process of its own: what the
first command loaded or compiled serves all others, as in a test. Streams are files, so that
whatever writes to them (a compiler, a thread) is seen.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

HUNG = "hung"
"""The status of a command that was ended."""


class Outcome(NamedTuple):
    """What became of a command.

    `status` is what ``main`` returned, `HUNG`, or the signal that ended the process. `trace` is
    the traceback where ``main`` raised; where it hung, the stack at that time.
    """

    words: tuple[str, ...]
    status: int | str
    out: str
    err: str
    trace: str
    seconds: float


class Worker:
    """A process for commands; a new one takes over where one was ended.

    Parameters
    ----------
    limit : float
        Seconds that a command may take.
    environment : dict, optional
        Variables beside those of this process.
    """

    def __init__(self, limit: float, environment: dict[str, str] | None = None) -> None:
        self.limit = limit
        self._environment = {**os.environ, "PYTHONFAULTHANDLER": "1", **(environment or {})}
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def run(self, words: list[str], folder: Path, stdin: bytes = b"") -> Outcome:
        """Run a command in a folder."""
        process = self._process or self._start()
        assert process.stdin is not None
        (folder / ".stdin").write_bytes(stdin)
        task = {"words": words, "folder": str(folder)}
        start = time.monotonic()
        process.stdin.write(json.dumps(task).encode() + b"\n")
        process.stdin.flush()
        answer = self._answer(process, start + self.limit)
        seconds = time.monotonic() - start
        out, err = (_text(folder / name) for name in (".stdout", ".stderr"))
        if answer is None:
            return Outcome(tuple(words), self._end(process), out, err, self._stack(), seconds)
        return Outcome(tuple(words), answer["status"], out, err, answer["trace"], seconds)

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._end(self._process)

    def _start(self) -> subprocess.Popen[bytes]:
        self._process = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=self._environment,
            start_new_session=True,  # what it starts ends with it
        )
        return self._process

    def _answer(self, process: subprocess.Popen[bytes], until: float) -> dict[str, Any] | None:
        """Return what the process says; None where it says nothing in time, or is gone."""
        assert process.stdout is not None
        line = b""
        while not line.endswith(b"\n"):
            left = until - time.monotonic()
            if left <= 0 or not select.select([process.stdout], [], [], left)[0]:
                return None
            piece = os.read(process.stdout.fileno(), 1 << 16)
            if not piece:
                return None
            line += piece
        answer: dict[str, Any] = json.loads(line)
        return answer

    def _end(self, process: subprocess.Popen[bytes]) -> str:
        """End the process and all that it started; say why."""
        self._process = None
        status = process.poll()
        if status is None:
            process.send_signal(signal.SIGABRT)  # faulthandler tells where it was
            self._trace = _last(process)
            why = HUNG
        else:
            self._trace = _last(process)
            why = f"ended with {status}"
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        for stream in (process.stdin, process.stdout, process.stderr):
            assert stream is not None
            stream.close()
        return why

    def _stack(self) -> str:
        return self._trace


def _last(process: subprocess.Popen[bytes]) -> str:
    """Return what the process says at its end, for two seconds at most."""
    assert process.stderr is not None
    pieces, until = [], time.monotonic() + 2.0
    while select.select([process.stderr], [], [], max(0.0, until - time.monotonic()))[0]:
        piece = os.read(process.stderr.fileno(), 1 << 16)
        if not piece:
            break
        pieces.append(piece)
    return b"".join(pieces).decode("utf-8", "replace")


def _text(path: Path) -> str:
    return path.read_bytes().decode("utf-8", "replace") if path.exists() else ""


# --- The process itself ---


def _serve() -> None:
    """Run commands until there are no more."""
    import faulthandler
    import traceback

    tasks, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    faulthandler.enable(os.fdopen(os.dup(2), "wb", buffering=0))
    from fuzzyarm.apps.cli.main import main

    for line in tasks:
        task = json.loads(line)
        os.chdir(task["folder"])
        for number, name, mode in ((0, ".stdin", "rb"), (1, ".stdout", "wb"), (2, ".stderr", "wb")):
            with open(name, mode) as stream:
                os.dup2(stream.fileno(), number)
        sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        trace = ""
        try:
            status: int | str = main(task["words"])
        except BaseException:
            status, trace = "raised", traceback.format_exc()
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError):
                stream.flush()
        answers.write(json.dumps({"status": status, "trace": trace}).encode() + b"\n")
        answers.flush()


if __name__ == "__main__":
    _serve()
