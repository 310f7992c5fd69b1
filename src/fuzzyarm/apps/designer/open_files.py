"""The open files and their windows: messages about them, and their handlers.

Messages are carried elsewhere: by a socket to this machine's server
(`fuzzyarm.apps.designer.server`), or within a page with its own Python
(`fuzzyarm.apps.playground`). A message is a JSON object, in both directions. A window may have
several files open: a message about one names it, under ``file``. Messages of a window are the
records of `fuzzyarm.apps.designer.requests`, each read by `fuzzyarm.apps.designer.records`: an
invalid one is refused, and a later failure of its handler is an internal error
(`fuzzyarm.apps.designer.faults`). Messages to a window are the records of
`fuzzyarm.apps.designer.messages`.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
from collections.abc import Awaitable, Callable, Coroutine, Iterator, Mapping
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.designer import requests
from fuzzyarm.apps.designer.faults import LOG, error_of, internal_words
from fuzzyarm.apps.designer.folder import SAMPLES, Workspace, converted_file
from fuzzyarm.apps.designer.jobs import Downloads, WindowJob, Work
from fuzzyarm.apps.designer.messages import Moved, Names, Opened, Reopened, Unsaved, Updates, Writer
from fuzzyarm.apps.designer.names import OutsideError, in_words
from fuzzyarm.apps.designer.records import MessageError, read_record
from fuzzyarm.apps.designer.shared import SharedText
from fuzzyarm.apps.designer.threads import aside
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import jsonable

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.run import Running
    from fuzzyarm.apps.designer.stage import Plants
    from fuzzyarm.apps.lsp.session import Session


def _later(module: str, function: str) -> Work:
    """Return work with its module loaded at its begin: few pages need all of them."""

    def work(session: Session, request: Any, job: WindowJob) -> None:
        getattr(import_module(f"fuzzyarm.apps.designer.{module}"), function)(session, request, job)

    work.__name__ = function
    return work


WORKS: dict[str, Work] = {
    "compare": _later("comparison", "compare"),
    "export": _later("exports", "export"),
    "surface": _later("surfaces", "surface"),
    "learnable": _later("learning", "learnable"),
    "learn": _later("learning", "learn"),
    "table-error": _later("tables", "table_error"),
    "tunable": _later("tuning", "tunable"),
    "tune": _later("tuning", "tune"),
    "sweepable": _later("sweeping", "sweepable"),
    "sweep": _later("sweeping", "sweep"),
    "fittable": _later("fitting", "fittable"),
    "fit": _later("fitting", "fit"),
    "opened-loop": _later("proving", "opened_loop"),
    "margins": _later("proving", "margins"),
    "provable": _later("proving", "provable"),
    "prove": _later("proving", "prove"),
    "sheets": _later("diagram", "sheets"),
}
"""Long work → its function; `OpenFiles` adds those that need its plants."""


class Window:
    """A connected page.

    Parameters
    ----------
    send : callable
        Sends a text; without effect on a closed window.
    """

    def __init__(self, send: Callable[[str], Awaitable[None]]) -> None:
        self._send = send
        self.files: set[str] = set()
        """Those that it has open."""
        self.jobs: dict[int, WindowJob] = {}
        self.follows = False
        """Whether it hears which files have unsaved changes."""

    def stop(self) -> None:
        """End all its work."""
        for job in self.jobs.values():
            job.stop()

    async def tell(self, message: Mapping[str, Any]) -> None:
        """Send a message."""
        await self._send(json.dumps(jsonable(message)))


LOOK_EVERY = 0.4
"""Seconds between two looks at the open files."""

MOST_JOBS = 32
"""Works of one window at a time; each is a thread, and all of them slow the answering."""


def _too_many(window: Window) -> str:
    """Return why a window may begin no more work; empty if it may."""
    if len(window.jobs) < MOST_JOBS:
        return ""
    return f"{len(window.jobs)} works of this window are going on, no more are begun: stop some"


class OpenFiles:
    """The open files and the windows on them.

    Parameters
    ----------
    workspace : Workspace
        The files.
    plants : Plants, optional
        The plants; the shipped ones by default.
    """

    learns = True
    """Whether its pages have the view Fit."""

    def __init__(self, workspace: Workspace, plants: Plants | None = None) -> None:
        self._plants = plants
        self.works: dict[str, Work] = {"run": self._run, "plants": self._describe}
        self.workspace = workspace
        self.downloads = Downloads()
        self.windows: list[Window] = []
        self._writers: dict[str, Window] = {}
        """The window that writes each open file; the others on it follow."""
        self._checks: dict[str, asyncio.Task[None]] = {}
        self._running: set[asyncio.Task[None]] = set()
        self._unsaved: list[str] = []  # as the windows know them
        self._logged_faults: set[tuple[str, str]] = set()  # of repeated tasks

    # --- Runs ---

    @cached_property
    def plants(self) -> Plants:
        """The plants; they import the loop, which a page may not need."""
        from fuzzyarm.apps.designer.stage import Plants

        return self._plants or Plants()

    @cached_property
    def _runs(self) -> Running:
        from fuzzyarm.apps.designer.run import Running

        return Running(self.plants)

    def _run(self, session: Session, request: requests.RunWork, job: WindowJob) -> None:
        self._runs(session, request, job)

    def _describe(self, session: Session, request: requests.PlantsWork, job: WindowJob) -> None:
        self._runs.describe(session, request, job)

    async def hear(self, window: Window, text: str | None) -> None:
        """Handle a message of a window; a mistake in it is answered, and ends nothing."""
        message: dict[str, Any] = {}
        try:
            message = _object_of(text)
            do = str(message.get("do"))
            if do not in _COMMANDS:
                raise MessageError(f"must be one of {', '.join(_COMMANDS)}", "do")
            await _COMMANDS[do](self, window, read_record(requests.COMMANDS[do], message), message)
        except Exception as error:
            wrong = error_of(error, f"the message {message.get('do')!r}")
            await window.tell(_refusal(message, wrong))

    # The handlers of a window's messages: a record, and the message itself, of which the record of
    # a question or of work is one more reading.

    async def _close(self, window: Window, request: requests.OfFile, _: dict[str, Any]) -> None:
        await self._leave(window, request.file)

    async def _leave(self, window: Window, name: str) -> None:
        """Close a file in a window; the next window with it becomes the writer."""
        window.files.discard(name)
        if self._writers.get(name) is window:
            del self._writers[name]
            for heir in self._on(name)[:1]:
                await self._give(name, heir)

    async def _write(self, window: Window, request: requests.OfFile, _: dict[str, Any]) -> None:
        """Make a reading window the writer of a file."""
        if request.file in window.files:
            await self._give(request.file, window)

    async def _give(self, name: str, writer: Window) -> None:
        """Let a window write a file, and have the one that did so follow."""
        before = self._writers.get(name)
        self._writers[name] = writer
        for window in (before, writer):
            if window is not None:
                await window.tell(self._right(window, name))

    async def _return(self, name: str, writer: Window) -> None:
        """Let a returning window write again as before; it is notified once it has the text."""
        before = self._writers.get(name)
        self._writers[name] = writer
        if before not in (None, writer):
            assert before is not None
            await before.tell(self._right(before, name))

    def _right(self, window: Window, name: str) -> Writer:
        return {"is": "writer", "file": name, "writes": self._writers.get(name) is window}

    async def _ask(
        self, window: Window, request: requests.TextQuestion, message: dict[str, Any]
    ) -> None:
        shared = self.workspace.text(request.file)
        await window.tell({"is": "answer", "id": request.id, **shared.answer(message)})

    async def _settle(self, _window: Window, request: requests.Settle, _: dict[str, Any]) -> None:
        shared = self.workspace.text(request.file)
        before = shared.version
        try:
            shared.settle(request.keep)
        finally:  # the window that asked shows the conflict no more
            await self._changed(request.file, shared, before, disk=True)

    async def _say(self, window: Window, request: requests.OfJob, message: dict[str, Any]) -> None:
        """Give words to work that still runs."""
        if request.id in window.jobs:
            window.jobs[request.id].hear(message)

    async def _stop(self, window: Window, request: requests.OfJob, _: dict[str, Any]) -> None:
        if request.id in window.jobs:
            window.jobs[request.id].stop()

    def _why_not(self, _what: str) -> str:
        """Return why long work is not possible here; empty if it is."""
        return ""

    async def _start(
        self, window: Window, request: requests.StartWork, message: dict[str, Any]
    ) -> None:
        """Begin long work on the present text, beside the answers."""
        shared, works = self.workspace.text(request.file), {**WORKS, **self.works}
        if request.what not in works:
            raise MessageError("is not a kind of work", "what")
        if why := self._why_not(request.what) or _too_many(window):
            await window.tell({"is": "job", "id": request.id, "end": "failed", "message": why})
            return
        job = WindowJob(
            request.id, window.tell, self.workspace, self.downloads, lambda: self.plants
        )
        try:
            record: Any = read_record(requests.WORKS[request.what], message)
        except MessageError as error:
            await job.refuse(error)
            return
        window.jobs[request.id] = job

        async def run() -> None:
            await job.run(works[request.what], shared.session.copy(), record)
            window.jobs.pop(request.id, None)

        self._hold(run())

    def _on(self, name: str) -> list[Window]:
        """Return the windows with a file open."""
        return [window for window in self.windows if name in window.files]

    def _hold(self, work: Coroutine[Any, Any, None]) -> None:
        """Run something beside the answers; asyncio drops a task without a reference."""
        task = asyncio.create_task(work)
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    async def _folder(
        self, window: Window, request: requests.FolderQuestion, message: dict[str, Any]
    ) -> None:
        self._hold(self._answered(window, request, message))

    async def _answered(
        self, window: Window, request: requests.FolderQuestion, message: dict[str, Any]
    ) -> None:
        """Answer a question about the folder."""
        try:
            answer = await self._act(request.what, message)
        except Exception as error:  # the page waits for an answer
            answer = error_of(error, f"the question {request.what!r} about the folder")
        await self._moved(answer)
        await window.tell({"is": "answer", "id": request.id, **answer})

    async def _act(self, what: str, message: dict[str, Any]) -> dict[str, Any]:
        """Act on the folder for a page; long acts run beside the answering."""
        if what == "findings":
            file = read_record(requests.OfFile, message).file
            return await aside(self.workspace.findings, file)
        if what == "judge":
            return await aside(self._judged, read_record(requests.FormQuestion, message))
        if what == "import":
            dropped = read_record(requests.Import, message)
            return await self._imported(dropped.name, _decoded(dropped.data))
        if what == "convert":  # a foreign file in the folder
            name = read_record(requests.Convert, message).name
            return await self._imported(name, self.workspace.foreign_data(name))
        return self.workspace.answer(message)

    def _judged(self, form: requests.FormQuestion) -> dict[str, Any]:
        """Return the mistake in a partly filled form."""
        from fuzzyarm.apps.designer.forms import judged

        folder = Path(self.workspace.text(form.file).session.path).parent
        return judged(form.form, form.values, folder, self.plants)

    async def _moved(self, answer: dict[str, Any]) -> None:
        """Send the new name of a file, or its removal, and continue with its check."""
        moved = [(old, new) for old, new in [answer.get("renamed", ("", ""))] if old]
        moved += [(answer["deleted"], "")] if "deleted" in answer else []
        messages_sent = []
        for old, new in moved:
            check = self._checks.pop(old, None)
            if check is not None:
                check.cancel()  # no window has the old name open any more
            writer = self._writers.pop(old, None)
            if writer is not None and new:
                self._writers[new] = writer
            for window in self._on(old):
                window.files = (window.files - {old}) | ({new} if new else set())
                news: Moved = {"is": "moved", "file": old, "to": new}
                messages_sent.append(window.tell(news))
        await asyncio.gather(*messages_sent)
        for _, new in moved:
            shared = self.workspace.opened(new)
            if shared is not None:
                self._check(new, shared)
        await self._tell_unsaved()

    async def _imported(self, name: str, data: bytes) -> dict[str, Any]:
        """Convert a file, and write it; with one file open it is to replace its text."""
        answer = await aside(converted_file, name, data)
        if self.workspace.only is not None:
            return {**answer, "only": True}
        is_samples = answer["name"].endswith(SAMPLES)  # not opened, but learned from
        if is_samples and not self.learns:
            raise OutsideError("samples are learned from by `fuzzyarm fit` and by the designer")
        put = self.workspace.put(answer["name"], answer["text"])
        if is_samples:
            put = {"samples": put["open"]}
        return {"findings": answer["findings"], **put, **self.workspace.listing()}

    async def _open(self, window: Window, request: requests.Open, _: dict[str, Any]) -> None:
        name = request.file
        try:
            shared = self.workspace.text(name)
        except OutsideError:
            if request.text is None:
                raise
            shared = self.workspace.revived(name, request.text)
        window.files.add(name)
        before = shared.version
        if request.wrote and (request.epoch != shared.epoch or request.version == before):
            await self._return(name, window)  # no edit meanwhile, or on the window's decision
        writes = self._writers.setdefault(name, window) is window
        if request.epoch == shared.epoch:  # the connection was lost, not the server
            missed = shared.since(request.version)
            if missed is not None:
                again: Reopened = {
                    "is": "reopened",
                    "file": name,
                    "version": request.version,
                    "updates": missed,
                    "saved": shared.saved,
                    "writes": writes,
                }
                await window.tell(again)
                await window.tell({"is": "status", "file": name, **shared.status})
                self._check(name, shared)
                return
        elif request.text is not None and request.wrote:
            shared.resume(request.text, (request.saved, *request.asked))
        elif request.text is not None:
            shared.remember(request.text, request.saved)
        opened: Opened = {
            "is": "opened",
            "file": name,
            "text": shared.text,
            "saved": shared.saved,
            "version": shared.version,
            "epoch": shared.epoch,
            "writes": writes,
        }
        await window.tell(opened)
        await self._changed(name, shared, before)
        self._check(name, shared)

    async def _push(self, window: Window, request: requests.Push, nothing: dict[str, Any]) -> None:
        version, name = request.version, request.file
        shared = self.workspace.text(name)
        if self._writers.get(name) is not window:  # its typed text stays there until it writes
            await window.tell(self._right(window, name))
            return
        if shared.push(version, request.updates):
            shared.is_typed = True
            await self._changed(name, shared, version)
            return
        missed = shared.since(version)
        if missed is None:
            await self._open(window, requests.Open(name), nothing)
        else:
            late: Updates = {"is": "updates", "file": name, "version": version, "updates": missed}
            await window.tell(late)

    async def _save(self, window: Window, request: requests.Save, _: dict[str, Any]) -> None:
        """Save a file; reply to a window that sent a number."""
        name, number = request.file, request.id
        shared = self.workspace.text(name)
        before, wrong = shared.version, ""
        try:
            shared.save()
        except (FuzzyarmError, OSError) as error:
            wrong = in_words(error)
        await self._changed(name, shared, before, disk=True)
        wrong = f"{name} is not saved: {wrong}" if wrong and number is not None else wrong
        if number is not None:
            answer = {"is": "answer", "id": number}
            await window.tell({**answer, "error": wrong} if wrong else answer)
        elif wrong:  # last: the state of the file would replace it
            await window.tell({"is": "failed", "file": name, "message": f"not saved: {wrong}"})

    async def _changed(
        self,
        name: str,
        shared: SharedText,
        before: int,
        *,
        disk: bool = False,
        reread: bool = False,
    ) -> None:
        """Send the changes of a file since a version to its windows, and check it again."""
        updates = shared.since(before) or []
        news: Updates = {"is": "updates", "file": name, "version": before, "updates": updates}
        shared.forget()
        for window in self._on(name):
            if updates:
                await window.tell(news)
            status = {"is": "status", "file": name, **shared.status, "reread": reread}  # of now
            if disk:  # the text on disk may be long, and changes rarely
                status["saved"] = shared.saved
            await window.tell(status)
        if updates:
            self._check(name, shared)
        await self._tell_unsaved()

    def _check(self, name: str, shared: SharedText) -> None:
        """Check a text beside the answers; a newer text replaces it."""
        running = self._checks.get(name)
        if running is not None and not running.done():
            return  # it looks at the version again when it is done
        self._checks[name] = asyncio.create_task(self._checked(name, shared))

    async def _checked(self, name: str, shared: SharedText) -> None:
        while True:
            copy = shared.session.copy()
            copy.version = shared.version
            for question in (shared.findings, shared.scene):
                message: Mapping[str, Any]
                try:
                    message = await aside(question, copy)
                except Exception as error:  # the only report of why nothing is drawn
                    words = internal_words(error, f"checking {name}")
                    message = {"is": "failed", "message": words, "internal": True}
                if copy.version != shared.version:
                    break
                shared.session.adopt(copy)
                for window in self._on(name):
                    await window.tell({**message, "file": name})
            if copy.version == shared.version:
                return

    async def _tell_names(self, names: list[str], windows: list[Window]) -> None:
        """Send the names of the files after one has appeared or gone."""
        first = "" if not names else await aside(self.workspace.first)
        news: Names = {"is": "names", "names": names, "first": first}
        for window in windows:
            await window.tell(news)

    async def _tell_unsaved(self) -> None:
        """Send the names of the files with unsaved changes, if they have changed."""
        names = self.workspace.unsaved()
        if names == self._unsaved:
            return
        self._unsaved = names
        news: Unsaved = {"is": "unsaved", "names": names}
        for window in [candidate for candidate in self.windows if candidate.follows]:
            await window.tell(news)

    async def watch(self) -> None:
        """Look at the open files now and then, and which there are."""
        stamp, names = self.workspace.stamp(), self.workspace.files()
        while True:
            await asyncio.sleep(LOOK_EVERY)
            # Whatever fails may succeed at the next look; without one no window would hear more.
            with self._logged("looking at the folder"):
                now = self.workspace.stamp()
                if now != stamp:
                    before, names = names, self.workspace.files()
                    stamp = now
                    if names != before:
                        await self._tell_names(names, list(self.windows))
            for name in {name for window in self.windows for name in window.files}:
                with self._logged(f"looking at {name}"):
                    await self._look_at(name)

    @contextlib.contextmanager
    def _logged(self, doing: str) -> Iterator[None]:
        """Go on whatever fails; a fault of the program is in the log, once."""
        try:
            yield
        except (FuzzyarmError, OSError):
            LOG.debug("failed: %s", doing, exc_info=True)
        except Exception as error:
            if (doing, repr(error)) not in self._logged_faults:
                self._logged_faults.add((doing, repr(error)))
                internal_words(error, doing)

    async def _look_at(self, name: str) -> None:
        """Send a text written by another program to the windows on its file."""
        shared = self.workspace.opened(name)
        before = shared.version if shared else 0
        if shared and shared.look():
            reread = shared.version != before
            await self._changed(name, shared, before, disk=True, reread=reread)

    async def _hello(
        self, window: Window, _request: requests.BareMessage, _: dict[str, Any]
    ) -> None:
        self._hold(self._welcome(window))

    async def _welcome(self, window: Window) -> None:
        """Send a window the names of the files, and which are unsaved."""
        window.follows = True
        await self._tell_names(self.workspace.files(), [window])
        await window.tell({"is": "unsaved", "names": self.workspace.unsaved()})


_COMMANDS: Mapping[str, Callable[[OpenFiles, Window, Any, dict[str, Any]], Awaitable[None]]] = {
    "hello": OpenFiles._hello,
    "open": OpenFiles._open,
    "close": OpenFiles._close,
    "push": OpenFiles._push,
    "ask": OpenFiles._ask,
    "save": OpenFiles._save,
    "settle": OpenFiles._settle,
    "write": OpenFiles._write,
    "start": OpenFiles._start,
    "say": OpenFiles._say,
    "stop": OpenFiles._stop,
    "folder": OpenFiles._folder,
}
"""Command of a window → its handler."""


def _object_of(text: str | None) -> dict[str, Any]:
    """Return the object in a message."""
    try:
        message = json.loads(text or "")
    except (ValueError, RecursionError):
        raise MessageError("is not JSON") from None
    if not isinstance(message, dict):
        raise MessageError("must be an object")
    return message


def _decoded(data: str) -> bytes:
    try:
        return base64.b64decode(data, validate=True)
    except ValueError:
        raise MessageError("must be base 64", "data") from None


def _refusal(message: dict[str, Any], wrong: dict[str, Any]) -> dict[str, Any]:
    """Return the refusal of a message, for the sender that waits for its answer."""
    if message.get("do") in ("ask", "save", "folder") and "id" in message:
        return {"is": "answer", "id": message["id"], **wrong}
    of_file = {"file": message["file"]} if "file" in message else {}
    words = wrong.pop("error")
    return {"is": "failed", **of_file, "message": words, **wrong}
