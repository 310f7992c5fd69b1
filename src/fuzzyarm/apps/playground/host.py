"""What answers the page of a playground, in the Python of that page.

The page sends the messages that it sends to a server, and they go to the same handlers
(:class:`fuzzyarm.apps.designer.open_files.OpenFiles`). The files are in memory; the page keeps
their texts in the browser and brings them along when it is opened.
"""

from __future__ import annotations

import asyncio
import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path

from fuzzyarm.apps.designer.folder import Workspace
from fuzzyarm.apps.designer.jobs import Downloads
from fuzzyarm.apps.designer.names import OutsideError, demand_name
from fuzzyarm.apps.designer.open_files import OpenFiles, Window
from fuzzyarm.apps.designer.shared import SharedText
from fuzzyarm.apps.designer.threads import can_take_turns

__all__ = ["LARGEST_TEXT", "PageFiles", "begin", "warm"]

FOLDER = Path("/playground")
"""Where the files are, in the memory of the page."""

FORESIGHT = 1.0
"""Seconds after which what the page will want is loaded."""

LARGEST_TEXT = 500_000
"""Characters of a text that is checked while it is typed."""

WAITING = frozenset({"run", "learn", "tune"})
"""Long work that listens to a hand."""

USED = (
    "apps.designer.scene", "apps.designer.exports", "apps.designer.run", "apps.designer.tables",
    "apps.designer.surfaces", "apps.designer.diagram", "exchange.export", "table",
    "table.fidelity", "exchange.formats", "plant.library", "control.controllers.findings",
    "control.controllers.catalogue", "control.loop.run", "control.loop.open_run",
)  # fmt: skip
"""Modules that a page will want sooner or later."""


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

    def __init__(self, workspace: Workspace, window: Window, downloads: Downloads) -> None:
        super().__init__(workspace)
        self.windows.append(window)
        self.downloads = downloads
        # Held, or they would be dropped.
        self.listening: asyncio.Future[None] | None = None
        self.foreseeing: asyncio.Future[None] | None = None

    def _why_not(self, what: str) -> str:
        if what not in WAITING or can_take_turns():
            return ""
        return (
            "a run needs a browser that lets WebAssembly wait (JSPI), such as Chrome from version"
            " 137 on; all else of this page works without"
        )

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
        """Return an address that is good as long as the page is open."""
        from js import Blob, Uint8Array, URL  # noqa: I001
        from pyodide.ffi import to_js

        data = Uint8Array.new(to_js(content))
        return str(URL.createObjectURL(Blob.new(to_js([data]))))


def begin(
    files: Mapping[str, str], send: Callable[[str], None], downloads: Downloads | None = None,
    folder: Path = FOLDER, *, can_load_more: bool = False,
) -> Callable[[str], None]:  # fmt: skip
    """Answer a page.

    Parameters
    ----------
    files : mapping of str to str
        What the page brings along: texts by name. A name that no file can have is left out.
    send : callable
        Takes what is said to the page.
    downloads : Downloads, optional
        Where exported files go; by default into addresses of the browser.
    folder : Path, optional
        Where the files are written.
    can_load_more : bool
        Whether what the page will want is loaded while it is idle.

    Returns
    -------
    callable
        Takes what the page says.
    """
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
    letters: asyncio.Queue[str] = asyncio.Queue()

    async def listen() -> None:
        while True:
            await page.hear(window, await letters.get())

    async def foresee() -> None:
        await asyncio.sleep(FORESIGHT)
        for name in USED:
            await asyncio.sleep(0.05)  # what the page says meanwhile comes first
            import_module(f"fuzzyarm.{name}")

    page.listening = asyncio.ensure_future(listen())
    if can_load_more:
        page.foreseeing = asyncio.ensure_future(foresee())
    return letters.put_nowait


def warm() -> None:
    """Load what a page will want sooner or later."""
    for name in USED:
        import_module(f"fuzzyarm.{name}")
