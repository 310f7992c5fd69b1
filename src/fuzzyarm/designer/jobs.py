"""Long work that a page watches: it runs beside the answering of questions, and can be stopped.

A piece of work is a function that is given the text as it was, what the page asked for, and a
`Job`. It runs in a thread of its own, which may wait for a hand as long as it likes: the threads
that answer questions are others. What it tells waits until the window has been sent it, so that
a slow window slows the work and not the server.
"""

from __future__ import annotations

import asyncio
import contextlib
import queue
import threading
from collections.abc import Awaitable, Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any, Protocol

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.lsp.session import Session

Tell = Callable[[dict[str, Any]], Awaitable[None]]

LOOK_EVERY = 0.25
"""Seconds after which work that waits for a word notices that it has been stopped."""


class StoppedError(FuzzyarmError, RuntimeError):
    """The page wants no more of this work."""


class Folder(Protocol):
    """The files that a page may name."""

    def beside(self, name: str, suffix: str) -> Path:
        """Return where a file of the folder stands that may be written."""

    def listed(self, *suffixes: str) -> list[str]:
        """Return the names of the folder's files of some kinds."""


class Work(Protocol):
    """What runs as a job."""

    def __call__(self, session: Session, asked: dict[str, Any], job: Job) -> None:
        """Do it; `asked` comes from the page, and is not to be trusted."""


class Job:
    """A piece of work of one window.

    Parameters
    ----------
    number : int
        The page's own number of it, which goes with all that is told.
    tell : callable
        Sends a message to the window.
    folder : Folder
        Whose files it may read and write.
    """

    def __init__(self, number: int, tell: Tell, folder: Folder) -> None:
        self.number = number
        self.folder = folder
        self._tell = tell
        self._loop = asyncio.get_running_loop()
        self._said: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self.stopped = False

    # --- From the server ---

    async def run(self, work: Work, session: Session, asked: dict[str, Any]) -> None:
        """Do the work, and tell how it ended: done, stopped, or failed with a sentence."""
        ended: Future[dict[str, Any]] = Future()

        def run() -> None:
            ended.set_result(self._end(work, session, asked))

        threading.Thread(target=run, name="fuzzyarm-job", daemon=True).start()
        await self._send(await asyncio.wrap_future(ended))

    def _end(self, work: Work, session: Session, asked: dict[str, Any]) -> dict[str, Any]:
        try:
            work(session, asked, self)
        except StoppedError:
            return {"end": "stopped"}
        except (FuzzyarmError, OSError) as error:
            return {"end": "failed", "message": str(error)}
        except (KeyError, TypeError, ValueError, IndexError):
            return {"end": "failed", "message": "a question that is not understood"}
        except Exception as error:  # the window must hear that nothing more comes
            return {"end": "failed", "message": f"a fault of the program: {error!r}"}
        return {"end": "done"}

    def hear(self, said: dict[str, Any]) -> None:
        """Take what a hand does."""
        self._said.put(said)

    def stop(self) -> None:
        """Have the work end at its next word."""
        self.stopped = True

    # --- From the work ---

    def tell(self, news: dict[str, Any]) -> None:
        """Tell the window, and wait until it has been sent.

        Raises
        ------
        StoppedError
            If the page wants no more.
        """
        self.check()
        sent: Future[None] = asyncio.run_coroutine_threadsafe(self._send(news), self._loop)
        sent.result()
        self.check()

    def heard(self, wait: float = 0.0) -> list[dict[str, Any]]:
        """Return what the page has said since the last look, the oldest first.

        Parameters
        ----------
        wait : float, optional
            How long to wait for a word where there is none, s.
        """
        found = []
        if wait > 0.0:
            with contextlib.suppress(queue.Empty):
                found.append(self._said.get(timeout=wait))
        while not self._said.empty():
            found.append(self._said.get())
        return found

    def word(self) -> dict[str, Any]:
        """Wait for what the page says next.

        Raises
        ------
        StoppedError
            If the page wants no more.
        """
        while True:
            self.check()
            try:
                return self._said.get(timeout=LOOK_EVERY)
            except queue.Empty:
                continue

    def check(self) -> None:
        """Raise `StoppedError` if the page wants no more."""
        if self.stopped:
            raise StoppedError("stopped")

    async def _send(self, news: dict[str, Any]) -> None:
        await self._tell({"is": "job", "id": self.number, **news})
