"""The server of the designer: one folder, on this machine only, for those who know the token.

Every address begins with the token, so that every request of the page carries it; without it
the answer is 403. The names in `Host` and `Origin` are checked, against pages of other sites
that reach this machine through the browser. The content policy lets nothing be loaded from
elsewhere and runs no text. What is said over the socket is answered in
`fuzzyarm.apps.designer.open_files`.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import hmac
import os
import secrets
import socket
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote, urlsplit

import anyio
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from fuzzyarm.apps.designer.assets import asset, index_page
from fuzzyarm.apps.designer.folder import IMPORTS, LARGEST_IMPORT, Workspace
from fuzzyarm.apps.designer.open_files import OpenFiles, Window
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import confined, real_path
from fuzzyarm.base.shipped_files import shipped_folder

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.stage import Plants


class AccessGuard:
    """Admits requests with the token that address this machine by its own names."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        self.app, self.token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 403 to everybody else."""
        if scope["type"] == "lifespan" or self._welcome(scope):
            await self.app(scope, receive, _with_headers(send))
            return
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
            return
        await PlainTextResponse("forbidden", 403)(scope, receive, send)

    def _welcome(self, scope: Scope) -> bool:
        headers = dict(scope["headers"])
        host = headers.get(b"host", b"").decode("latin-1")
        token = scope["path"].split("/")[1] if "/" in scope["path"] else ""
        names = {"127.0.0.1", "localhost", "::1"}
        if _host_name(host) not in names or not secrets.compare_digest(
            token.encode(), self.token.encode()
        ):
            return False
        origin = headers.get(b"origin")
        if origin is None:
            return bool(scope["type"] == "http" and scope["method"] in {"GET", "HEAD"})
        return bool(origin.decode("latin-1") == f"http://{host}")


def _host_name(host: str) -> str | None:
    """Return the name in a `Host`; None for an invalid one."""
    try:
        return urlsplit(f"//{host}").hostname
    except ValueError:
        return None


def _with_headers(send: Send) -> Send:
    """Add the headers of every answer."""
    fixed = [
        (b"x-content-type-options", b"nosniff"),
        (b"referrer-policy", b"no-referrer"),
        (b"cross-origin-resource-policy", b"same-origin"),
        (b"cache-control", b"no-store"),
    ]

    async def sending(message: Any) -> None:
        if message["type"] == "http.response.start":
            message = {**message, "headers": [*message["headers"], *fixed]}
        await send(message)

    return sending


def token_for(folder: Path) -> str:
    """Return the token of a folder: the same after a restart, so that open pages find back.

    It is made from a random key in a file of the user's own; without one it is random each time.
    """
    base = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA")
    home = Path(base) if base else Path.home() / ".local" / "state"
    key = home / "fuzzyarm" / "designer.key"
    try:
        key.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileExistsError):
            handle = os.open(key, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(handle, "w") as file:
                file.write(secrets.token_hex(32))
        secret = key.read_bytes()
    except OSError:
        secret = b""
    if len(secret) < 64:
        return secrets.token_urlsafe(24)
    return hmac.new(secret, str(folder).encode(), hashlib.sha256).hexdigest()[:32]


LARGEST_MESSAGE = 32 * 1024 * 1024
OWN_PORTS = range(20_000, 30_000)
"""Ports of folders: below those that systems assign to connections."""


class ServerPortError(FuzzyarmError, OSError):
    """A port that is taken or forbidden."""


class Designer(OpenFiles):
    """The open files of a folder, served.

    Parameters
    ----------
    workspace : Workspace
        The files.
    token : str
        The secret part of an address.
    plants : Plants, optional
        The plants; the shipped ones by default.
    farewell : callable, optional
        Takes the names of the files with unsaved changes, if there are any when it ends.
    """

    def __init__(
        self,
        workspace: Workspace,
        token: str,
        plants: Plants | None = None,
        farewell: Callable[[list[str]], None] | None = None,
    ) -> None:
        super().__init__(workspace, plants)
        self._farewell = farewell
        self.token = token

    def app(self) -> ASGIApp:
        """Return the application."""
        routes = [
            Route("/{token}/", self._index),
            Route("/{token}/page/{name:path}", self._asset),
            Route("/{token}/download/{key}/{name:path}", self._download),
            WebSocketRoute("/{token}/socket", self._socket),
        ]
        return AccessGuard(Starlette(routes=routes, lifespan=self._lifespan), self.token)

    @contextlib.asynccontextmanager
    async def _lifespan(self, _app: Starlette) -> Any:
        task = asyncio.create_task(self.watch())
        with confined(self.workspace.folder, shipped_folder()):
            yield
        task.cancel()
        for window in self.windows:
            window.stop()
        unsaved = self.workspace.unsaved()
        if unsaved and self._farewell is not None:
            self._farewell(unsaved)

    # --- Pages ---

    async def _index(self, _request: Request) -> Response:
        nonce = secrets.token_urlsafe(16)
        policy = (
            "default-src 'none'; script-src 'self'; connect-src 'self'; img-src 'self' data:;"
            f" style-src 'self' 'nonce-{nonce}'; base-uri 'none'; form-action 'none';"
            " frame-ancestors 'none'"
        )
        folder = self.workspace
        page = index_page(
            {
                "files": folder.files(),
                "first": await asyncio.to_thread(folder.first),
                "only": folder.only is not None,
                "largest": LARGEST_IMPORT,
                "imports": IMPORTS,
            },
            nonce,
        )
        headers = {"Content-Security-Policy": policy}
        return Response(page, media_type="text/html; charset=utf-8", headers=headers)

    async def _asset(self, request: Request) -> Response:
        asset_file = asset(request.path_params["name"])
        if asset_file is None:
            return PlainTextResponse("not found", 404)
        content, kind = asset_file
        return Response(content, media_type=kind)

    async def _download(self, request: Request) -> Response:
        """Answer with an exported file, which a browser saves and never shows."""
        download = self.downloads.find(request.path_params["key"])
        if download is None:
            return PlainTextResponse("not found", 404)
        name, content = download
        plain = "".join(c if c.isascii() and c not in '"\\%' else "_" for c in name)
        text = f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"
        headers = {"Content-Disposition": text, "Content-Security-Policy": "default-src 'none'"}
        return Response(content, media_type="application/octet-stream", headers=headers)

    # --- The socket ---

    async def _socket(self, socket: WebSocket) -> None:
        await socket.accept()

        async def send(text: str) -> None:  # nothing to a closed window
            with contextlib.suppress(WebSocketDisconnect, RuntimeError, anyio.ClosedResourceError):
                await socket.send_text(text)

        window = Window(send)
        self.windows.append(window)
        try:
            while (event := await socket.receive())["type"] == "websocket.receive":
                await self.hear(window, event.get("text"))
        finally:
            window.stop()
            self.windows.remove(window)
            for name in window.files.copy():
                await self._leave(window, name)


def _bound(listening: socket.socket, port: int | None, token: str) -> None:
    """Bind to a port; by default to the one of the token, so that open pages reconnect."""
    usual_port = OWN_PORTS.start + int(hashlib.sha256(token.encode()).hexdigest(), 16) % len(
        OWN_PORTS
    )
    try:
        listening.bind(("127.0.0.1", usual_port if port is None else port))
    except OSError as error:
        if port is not None:
            raise ServerPortError(f"port {port} cannot be used: {error.strerror}") from None
        listening.bind(("127.0.0.1", 0))


def serve(
    path: Path,
    port: int | None,
    announce: Callable[[str], None],
    plants: Sequence[str] = (),
    farewell: Callable[[list[str]], None] | None = None,
) -> None:
    """Serve a folder or a file until it is interrupted."""
    import uvicorn

    plant_catalogue = None
    if plants:
        from fuzzyarm.apps.designer.stage import Plants

        plant_catalogue = Plants(tuple(plants))
    workspace = Workspace(path, plant_catalogue.own if plant_catalogue is not None else ())
    token = token_for(real_path(path))
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as listening:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        _bound(listening, port, token)
        address = f"http://127.0.0.1:{listening.getsockname()[1]}/{token}/"
        config = uvicorn.Config(
            Designer(workspace, token, plant_catalogue, farewell).app(),
            log_level="error",
            ws="websockets-sansio",
            ws_max_size=LARGEST_MESSAGE,
            proxy_headers=False,  # no proxy between
            server_header=False,
            timeout_graceful_shutdown=1,
        )
        server = uvicorn.Server(config)

        async def main() -> None:
            serving = asyncio.create_task(server.serve(sockets=[listening]))
            while not server.started and not serving.done():
                await asyncio.sleep(0.01)
            announce(address)
            await serving

        asyncio.run(main())
