"""Who is let in: addresses begin with a token, and only this machine's own names are answered."""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import os
import secrets
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send


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
    """Return the name in a `Host`; None where it is not one."""
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
