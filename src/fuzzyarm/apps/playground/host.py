"""The server side of a playground, in the Python of its page.

The page sends the messages of a served page, to the same handlers
(:class:`fuzzyarm.apps.designer.open_files.OpenFiles`). The files are in memory; the page stores
their texts in the browser and sends them when it is opened.
"""

from __future__ import annotations

import asyncio
import warnings
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from fuzzyarm.apps.designer.folder import Workspace
from fuzzyarm.apps.designer.jobs import Downloads
from fuzzyarm.apps.designer.messages import Stored
from fuzzyarm.apps.designer.names import OutsideError, demand_name
from fuzzyarm.apps.designer.open_files import OpenFiles, Window
from fuzzyarm.apps.designer.shared import DISK, SharedText
from fuzzyarm.apps.designer.threads import can_take_turns
from fuzzyarm.base.errors import FuzzyarmError

FOLDER = Path("/playground")
"""Where the files are, in the memory of the page."""

FORESIGHT = 1.0
"""Seconds after which modules are loaded ahead."""

LARGEST_TEXT = 500_000
"""Characters of a text checked while typing."""

WAITING = frozenset({"run", "learn", "tune"})
"""Long work that listens to a hand."""

USED = (
    "apps.designer.scene", "apps.designer.exports", "apps.designer.run", "apps.designer.tables",
    "apps.designer.surfaces", "apps.designer.diagram", "exchange.export", "table",
    "table.fidelity", "exchange.formats", "plant.library", "control.controllers.findings",
    "control.controllers.catalogue", "control.loop.run", "control.loop.open_run",
)  # fmt: skip
"""Modules that a page will need sooner or later."""


class PageFiles(OpenFiles):
    """The files of a page.

    Parameters
    ----------
    workspace : Workspace
        The files.
    window : Window
        The page, the only one there is.
    downloads : Downloads
        Where exported files go.
    """

    learns = False

    def __init__(self, workspace: Workspace, window: Window, downloads: Downloads) -> None:
        super().__init__(workspace)
        self.windows.append(window)
        self.downloads = downloads
        self._stored = set(workspace.files())  # as the page knows them
        self.letters: asyncio.Queue[Callable[[], Awaitable[None]]] = asyncio.Queue()
        self.tasks: list[asyncio.Future[None]] = []
        """Held, or they would be dropped."""

    def _why_not(self, what: str) -> str:
        if what not in WAITING or can_take_turns():
            return ""
        return (
            "a run needs a browser that lets WebAssembly wait (JSPI), such as Chrome from version"
            " 137 on; all else of this page works without"
        )

    async def listen(self) -> None:
        """Handle the messages of the page and of its other tabs, one after the other."""
        while True:
            letter = await self.letters.get()
            with self._logged("hearing a page"):
                await letter()

    async def store(self, name: str, text: str | None) -> None:
        """Adopt the text of a file stored by another tab, or its removal."""
        shared = self.workspace.opened(name)
        if text is None:
            await self._moved(self.workspace.answer({"what": "delete", "file": name}))
        elif shared is None:
            (self.workspace.folder / demand_name(name)).write_bytes(text.encode())
            self._stored.add(name)
        else:
            before = shared.version
            shared.replace(text, DISK)
            shared.save()
            await self._changed(name, shared, before, disk=True)

    async def _tell_names(self, names: list[str], windows: list[Window]) -> None:
        await self._keep(names)
        await super()._tell_names(names, windows)

    async def _moved(self, answer: dict[str, Any]) -> None:
        await self._keep(self.workspace.files())  # before the page forgets an old name
        await super()._moved(answer)

    async def _keep(self, names: list[str]) -> None:
        """Have the page store new files."""
        for name in set(names) - self._stored:
            with suppress(FuzzyarmError, OSError):
                text = self.workspace.session(name).text
                news: Stored = {"is": "stored", "file": name, "text": text}
                for window in self.windows:
                    await window.tell(news)
        self._stored = set(names)

    def _check(self, name: str, shared: SharedText) -> None:
        size = len(shared.text)
        if size <= LARGEST_TEXT:
            super()._check(name, shared)
            return
        words = (
            f"the text has {size:,} characters: this page checks at most {LARGEST_TEXT:,}, and"
            " `fuzzyarm check` any number; nothing of it is lost"
        )
        for window in self._on(name):
            self._hold(window.tell({"is": "failed", "file": name, "message": words}))


class Blobs(Downloads):
    """Exported files as addresses of the browser."""

    def offer(self, name: str, content: bytes) -> str:
        """Return an address that is valid as long as the page is open."""
        from js import Blob, Uint8Array, URL  # noqa: I001
        from pyodide.ffi import to_js

        data = Uint8Array.new(to_js(content))
        return str(URL.createObjectURL(Blob.new(to_js([data]))))


def begin(
    files: Mapping[str, str], send: Callable[[str], None], downloads: Downloads | None = None,
    folder: Path = FOLDER, *, can_load_more: bool = False,
) -> tuple[Callable[[str], None], Callable[[str, str | None], None]]:  # fmt: skip
    """Answer a page."""
    # A folder without kernels was said to its writer; a visitor can do nothing about it.
    warnings.filterwarnings("ignore", "no machine code was built", RuntimeWarning)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        try:
            path, data = folder / demand_name(name), text.encode()
        except (OutsideError, UnicodeEncodeError):
            continue
        path.write_bytes(data)

    async def tell(text: str) -> None:
        send(text)

    window = Window(tell)
    page = PageFiles(Workspace(folder), window, downloads or Blobs())

    async def foresee() -> None:
        await asyncio.sleep(FORESIGHT)
        for name in USED:
            await asyncio.sleep(0.05)  # messages of the page first
            import_module(f"fuzzyarm.{name}")

    page.tasks += [asyncio.ensure_future(page.listen()), asyncio.ensure_future(page.watch())]
    if can_load_more:
        page.tasks.append(asyncio.ensure_future(foresee()))

    def hear(text: str) -> None:
        page.letters.put_nowait(partial(page.hear, window, text))

    def store(name: str, text: str | None) -> None:
        page.letters.put_nowait(partial(page.store, name, text))

    return hear, store


def warm() -> None:
    """Load modules that a page will need sooner or later."""
    for name in USED:
        import_module(f"fuzzyarm.{name}")
