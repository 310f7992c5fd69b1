"""The server: handlers of every feature, with a session for each open file."""

from __future__ import annotations

import asyncio
import re
import threading
from typing import Any, BinaryIO, NamedTuple

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams, JsonRpcInvalidRequest
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, default_converter
from pygls.protocol.language_server import lsp_method
from pygls.uris import to_fs_path

from fuzzyarm.apps.lsp.protocol import Converter
from fuzzyarm.apps.lsp.session import SLOW, UTF16, Session
from fuzzyarm.base.lazy import load_packages
from fuzzyarm.version import __version__


class Protocol(LanguageServerProtocol):
    """The protocol with texts in sessions, and an answer to every request.

    The library's own copies of the texts would break lines where the protocol does not (at
    form feeds and other separators), would apply every change a second time, and would leave
    a future behind for each.
    """

    @lsp_method(types.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(self, params: types.DidOpenTextDocumentParams) -> None:
        """Hand an opened file to its handler."""
        self.fm.features[types.TEXT_DOCUMENT_DID_OPEN](params)

    @lsp_method(types.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(self, params: types.DidChangeTextDocumentParams) -> None:
        """Hand a change to its handler."""
        self.fm.features[types.TEXT_DOCUMENT_DID_CHANGE](params)

    @lsp_method(types.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(self, params: types.DidCloseTextDocumentParams) -> None:
        """Hand a closed file to its handler."""
        self.fm.features[types.TEXT_DOCUMENT_DID_CLOSE](params)

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Answer a request with invalid parameters: the library only logs it."""
        try:
            return super().structure_message(data)
        except JsonRpcException:
            if "id" not in data or "method" not in data:
                raise
            error = JsonRpcInvalidParams(message=f"invalid parameters of {data['method']}")
            self._send_response(data["id"], error=error.to_response_error())
            return None

    def handle_message(self, message: Any) -> None:
        """Refuse anything but a message; None is a message with an answer already."""
        if hasattr(message, "jsonrpc"):
            super().handle_message(message)
        elif message is not None:
            self._send_response(None, error=JsonRpcInvalidRequest().to_response_error())  # type: ignore[arg-type]


def _strict_converter() -> Any:
    """Return the library's converter, made strict: it would accept 1.5 for a line, 5 for a name."""
    converter: Any = default_converter()  # type: ignore[no-untyped-call]

    def exactly(value: Any, kind: type) -> Any:
        if kind not in (int, str):  # a kind of enumeration
            return kind(value)
        if type(value) is not kind:
            raise ValueError(f"{value!r} is not of type {kind.__name__}")
        return value

    for kind in (int, str):
        converter.register_structure_hook(kind, exactly)
    return converter


class MessageStream:
    """The server's input, without malformed message headers.

    The library expects one header per line; after a malformed one it would take the following
    messages for headers.
    """

    _HEAD = re.compile(rb"Content-Length: *(\d{1,8})\r?\n\Z", re.IGNORECASE)

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def read(self, size: int) -> bytes:
        """Return the body of a message."""
        return self._stream.read(size)

    def readline(self) -> bytes:
        """Return the next line, reduced to the header at its end."""
        line = self._stream.readline()
        head = self._HEAD.search(line)
        if head is not None:
            return b"Content-Length: %d\r\n" % int(head[1])
        return b"-\r\n" if line.strip() else line  # no other line of a head is of interest


class _OutdatedError(Exception):
    """The text has changed during its check."""


class _Running(NamedTuple):
    """A running check, with the event that cancels it."""

    task: asyncio.Task[None]
    outdated: threading.Event


class FuzzyarmServer(LanguageServer):
    """The language server of ``.frb`` and ``.lut`` files."""

    def __init__(self) -> None:
        super().__init__(
            "fuzzyarm",
            __version__,
            protocol_cls=Protocol,
            converter_factory=_strict_converter,
        )
        self.sessions: dict[str, Session] = {}
        self._timers: dict[str, asyncio.TimerHandle] = {}
        self._running: dict[str, _Running] = {}

    # ── files ────────────────────────────────────────────────────────────────────────

    @property
    def encoding(self) -> str:
        """The code unit agreed with the editor."""
        agreed = self.workspace.position_encoding or UTF16
        return str(getattr(agreed, "value", agreed))

    def session(self, uri: str) -> Session:
        """Return the open file at `uri`."""
        if uri not in self.sessions:
            raise JsonRpcInvalidParams(message=f"the file {uri} is not open")
        return self.sessions[uri]

    def converter(self, uri: str) -> Converter:
        """Return the converter of positions in an open file."""
        capabilities = self.client_capabilities.text_document
        completion = capabilities.completion if capabilities else None
        item = completion.completion_item if completion else None
        snippets = bool(item and item.snippet_support)
        return Converter(uri, self.session(uri).lines, self.encoding, snippets)

    def open(self, document: types.TextDocumentItem) -> None:
        """Open a file."""
        path = to_fs_path(document.uri) or document.uri
        if document.language_id == "fuzzyarm-table" and not path.lower().endswith(".lut"):
            path += ".lut"
        self.sessions[document.uri] = Session(path, document.text, document.version)
        self._schedule(document.uri, pause=False)

    def change(self, params: types.DidChangeTextDocumentParams) -> None:
        """Apply the changes of a file."""
        session = self.session(params.text_document.uri)
        for change in params.content_changes:
            where = None
            if isinstance(change, types.TextDocumentContentChangePartial):
                start, end = change.range.start, change.range.end
                where = (start.line, start.character, end.line, end.character)
            session.change(where, change.text, self.encoding)
        session.version = params.text_document.version
        self._schedule(params.text_document.uri)

    def close(self, uri: str) -> None:
        """Forget a file and its findings."""
        self.sessions.pop(uri, None)
        self._cancel(uri)
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))

    # ── diagnostics ──────────────────────────────────────────────────────────────────
    #
    # A check runs in its own thread on a copy, while requests are answered. The next key stroke
    # cancels it: its findings would be about an old text.

    def _schedule(self, uri: str, *, pause: bool = True) -> None:
        """Schedule a check: at once if it is fast, else (with `pause`) when typing pauses."""
        self._cancel(uri)
        cost = self.sessions[uri].cost
        delay = 0.0 if cost < SLOW or not pause else min(1.5, 2.0 * cost)
        self._timers[uri] = asyncio.get_running_loop().call_later(delay, self._check, uri)

    def _cancel(self, uri: str) -> None:
        waiting, running = self._timers.pop(uri, None), self._running.pop(uri, None)
        if waiting is not None:
            waiting.cancel()
        if running is not None:
            running.outdated.set()

    def _check(self, uri: str) -> None:
        self._timers.pop(uri, None)
        if uri in self.sessions:
            outdated = threading.Event()
            task = asyncio.ensure_future(self._check_aside(uri, self.sessions[uri], outdated))
            self._running[uri] = _Running(task, outdated)

    async def _check_aside(self, uri: str, text: Session, outdated: threading.Event) -> None:
        def stop_if_outdated() -> None:
            if outdated.is_set():
                raise _OutdatedError

        copy = text.copy()
        load_packages("fuzzyarm.control.controllers")
        try:
            await asyncio.to_thread(copy.review, stop_if_outdated)
        except _OutdatedError:
            return
        if outdated.is_set():
            return
        del self._running[uri]
        if text.adopt(copy):
            self._publish(uri, text)

    async def checked(self, uri: str) -> Session:
        """Return the open file at `uri` after its check, or after another text has arrived."""
        session = self.session(uri)
        if not session.reviewed:
            if uri not in self._running:
                self._cancel(uri)
                self._check(uri)
            await asyncio.wait([self._running[uri].task])
        return session

    def _publish(self, uri: str, text: Session) -> None:
        """Send the findings of a file to the editor."""
        converter = self.converter(uri)
        diagnostics = [converter.diagnostic(d) for d in text.review().diagnostics]
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri, diagnostics, text.version)
        )
