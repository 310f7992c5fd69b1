"""Long work watched by a page: it runs beside the answers to questions, and can be stopped.

A piece of work is a function of the text at its start, of the request, and of a `WindowJob`. It
runs in its own thread, which may wait for the user indefinitely: other threads answer questions. It
waits until its news are sent to the window, so that a slow window slows the work and not the
server.
"""

from __future__ import annotations

import asyncio
import secrets
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar
from urllib.parse import quote

from fuzzyarm.apps.designer.faults import internal_words
from fuzzyarm.apps.designer.names import in_words
from fuzzyarm.apps.designer.records import read_record
from fuzzyarm.apps.designer.threads import Mailbox, run_to_its_end, wait_for
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.picture import Chart, chart_data

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.stage import Plants

Word = TypeVar("Word")

Tell = Callable[[dict[str, Any]], Awaitable[None]]

TELL_EVERY = 0.1
"""Seconds between two reports of progress."""

LOOK_EVERY = 0.25
"""Seconds between two looks of waiting work at its stop flag."""


MOST_KEPT, LARGEST_KEPT = 64, 200_000_000
"""Files for download, and their bytes, beyond which the oldest are dropped."""


class StoppedError(FuzzyarmError, RuntimeError):
    """The page has cancelled this work."""


class Folder(Protocol):
    """The files that a page may name."""

    def beside(self, name: str, suffix: str) -> Path:
        """Return the path of a writable file of the folder."""

    def listed(self, *suffixes: str) -> list[str]:
        """Return the names of the folder's files of some kinds."""

    def session(self, name: str) -> Session:
        """Return the present text of a file of the folder."""


class Downloads:
    """Files for download by a page, each under its own key; the oldest are dropped."""

    def __init__(self) -> None:
        self._files: OrderedDict[str, tuple[str, bytes]] = OrderedDict()

    def offer(self, name: str, content: bytes) -> str:
        """Keep a file; return its address below the page."""
        key = secrets.token_urlsafe(12)
        self._files[key] = name, content
        while len(self._files) > MOST_KEPT or sum(map(_size, self._files.values())) > LARGEST_KEPT:
            self._files.popitem(last=False)
        return f"download/{key}/{quote(name)}"

    def find(self, key: str) -> tuple[str, bytes] | None:
        """Return the name and the content of a stored file."""
        return self._files.get(key)


def _size(download: tuple[str, bytes]) -> int:
    return len(download[1])


class Work(Protocol):
    """A function that runs as a job."""

    def __call__(self, session: Session, request: Any, job: WindowJob) -> None:
        """Do it; `request` is a record of `fuzzyarm.apps.designer.requests.WORKS`."""


class WindowJob:
    """A piece of work of one window.

    Parameters
    ----------
    number : int
        The page's number of the job, which all its messages carry.
    tell : callable
        Sends a message to the window.
    folder : Folder
        Whose files it may read and write.
    downloads : Downloads, optional
        Where files for the page to load are put.
    plants : callable, optional
        Returns the plants; the shipped ones by default.
    """

    def __init__(
        self,
        number: int,
        tell: Tell,
        folder: Folder,
        downloads: Downloads | None = None,
        plants: Callable[[], Plants] | None = None,
    ) -> None:
        self.number = number
        self.folder = folder
        self._plants = plants
        self._downloads = downloads or Downloads()
        self._tell = tell
        self._loop = asyncio.get_running_loop()
        self._messages: Mailbox[dict[str, Any]] = Mailbox()
        self.stopped = False
        self._paced = 0.0  # time of the last paced word

    @cached_property
    def plants(self) -> Plants:
        """The plants; they import the loop, which few works need."""
        if self._plants is not None:
            return self._plants()
        from fuzzyarm.apps.designer.stage import Plants

        return Plants()

    # --- From the server ---

    async def refuse(self, error: FuzzyarmError) -> None:
        """Report that it does not begin."""
        await self._send({"end": "failed", "message": str(error), "field": ""})

    async def run(self, work: Work, session: Session, request: Any) -> None:
        """Do the work, and report its end: done, stopped, or failed with a sentence."""
        await self._send(await run_to_its_end(lambda: self._end(work, session, request)))

    def _end(self, work: Work, session: Session, request: Any) -> dict[str, Any]:
        try:
            work(session, request, self)
        except StoppedError:
            return {"end": "stopped"}
        except (FuzzyarmError, OSError) as error:
            field = getattr(error, "field", "")  # of the page, with the mistake
            return {"end": "failed", "message": in_words(error), "field": field}
        except BaseException as error:  # also SystemExit: the window must learn of the end
            words = internal_words(error, f"the work {getattr(work, '__name__', work)!r}")
            return {"end": "failed", "message": words, "internal": True}
        return {"end": "done"}

    def hear(self, message: dict[str, Any]) -> None:
        """Receive an action of the user."""
        self._messages.put(message)

    def stop(self) -> None:
        """Have the work end at its next word."""
        self.stopped = True

    # --- From the work ---

    def tell(self, news: dict[str, Any]) -> None:
        """Send news to the window, and wait until they are sent."""
        self.check()
        wait_for(self._send(news), self._loop)
        self.check()  # it may have been stopped while a slow window was waited for

    def heard(self, kind: type[Word], wait: float = 0.0) -> list[Word]:
        """Return the words of the page since the last look, the oldest first."""
        words: list[Word] = []
        # It waits for the first word only.
        while (message := self._messages.take(0.0 if words else wait)) is not None:
            words.append(read_record(kind, message))
        return words

    def word(self, kind: type[Word]) -> Word:
        """Wait for the next word of the page; as `heard`."""
        while True:
            self.check()
            message = self._messages.take(LOOK_EVERY)
            if message is not None:
                return read_record(kind, message)

    def check(self) -> None:
        """Raise `StoppedError` if the page has cancelled."""
        if self.stopped:
            raise StoppedError("stopped")

    def progress(self, words: str) -> None:
        """Report the progress."""
        self.tell({"doing": words})

    def paced_progress(self, words: str) -> None:
        """Report the progress, at most every `TELL_EVERY` seconds."""
        if time.monotonic() - self._paced >= TELL_EVERY:
            self._paced = time.monotonic()
            self.progress(words)

    def offer(self, name: str, content: bytes) -> str:
        """Keep a file for the page to load; return its address."""
        return self._downloads.offer(name, content)

    async def _send(self, news: dict[str, Any]) -> None:
        await self._tell({"is": "job", "id": self.number, **news})


# --- Results: lines, pictures, files to load, a file beside the text ---


def tell_result(
    job: WindowJob,
    lines: Sequence[str],
    charts: Iterable[Chart] = (),
    *,
    verdict: str = "",
    files: Mapping[str, bytes] | None = None,
    so_far: bool = False,
) -> None:
    """Send a result; the next one replaces a provisional one."""
    job.tell({
        "so_far": so_far,
        "verdict": verdict,
        "lines": list(lines),
        "panels": [panel for chart in charts for panel in chart_data(chart)],
        "files": [
            {"name": name, "address": job.offer(name, content)}
            for name, content in (files or {}).items()
        ],
    })  # fmt: skip


def save_beside(
    job: WindowJob, name: str, suffix: str, write: Callable[[Path], object], *, replace: bool
) -> None:
    """Write a file of the folder, and report it; overwrite only on the page's request."""
    try:
        path = job.folder.beside(name, suffix)
        if path.exists() and not replace:
            job.tell({"exists": name})
            return
        write(path)
    except (FuzzyarmError, OSError) as error:
        job.check()
        job.tell({"unsaved": str(error)})
    else:
        job.tell({"saved": name})
