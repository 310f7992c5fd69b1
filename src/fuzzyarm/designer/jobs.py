"""Long work that a page watches: it runs beside the answering of questions, and can be stopped.

A piece of work is a function that is given the text as it was, what the page asked for, and a
`Job`. It runs in a thread of its own. What it tells waits until the window has been sent it, so
that a slow window slows the work and not the server.
"""

from __future__ import annotations

import asyncio
import contextlib
import queue
from collections.abc import Awaitable, Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Protocol

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.lsp.session import Session

Tell = Callable[[dict[str, Any]], Awaitable[None]]


class StoppedError(FuzzyarmError, RuntimeError):
    """The page wants no more of this work."""


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
    """

    def __init__(self, number: int, tell: Tell) -> None:
        self.number = number
        self._tell = tell
        self._loop = asyncio.get_running_loop()
        self._said: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self.stopped = False

    # --- From the server ---

    async def run(self, work: Work, session: Session, asked: dict[str, Any]) -> None:
        """Do the work, and tell how it ended: done, stopped, or failed with a sentence."""
        end: dict[str, Any] = {"end": "done"}
        # Not one of the threads that answer questions: a run may last as long as the window.
        thread = ThreadPoolExecutor(1, "job")
        try:
            await self._loop.run_in_executor(thread, work, session, asked, self)
        except StoppedError:
            end = {"end": "stopped"}
        except (FuzzyarmError, OSError) as error:
            end = {"end": "failed", "message": str(error)}
        except (KeyError, TypeError, ValueError, IndexError):
            end = {"end": "failed", "message": "a question that is not understood"}
        finally:
            thread.shutdown(wait=False)
        await self._send(end)

    def hear(self, said: dict[str, Any]) -> None:
        """Take what a hand does."""
        self._said.put(said)

    def stop(self) -> None:
        """Have the work end at its next word."""
        self.stopped = True
        self._said.put({})  # what waits for a word wakes up

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
        with contextlib.suppress(queue.Empty):
            found.append(self._said.get(wait > 0.0, wait if wait > 0.0 else None))
        while not self._said.empty():
            found.append(self._said.get())
        return [said for said in found if said]

    def check(self) -> None:
        """Raise `StoppedError` if the page wants no more."""
        if self.stopped:
            raise StoppedError("stopped")

    async def _send(self, news: dict[str, Any]) -> None:
        await self._tell({"is": "job", "id": self.number, **news})
