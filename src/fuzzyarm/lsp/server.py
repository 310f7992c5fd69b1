"""The server: every feature, answered from the sessions of the open files."""

from __future__ import annotations

import asyncio
from collections.abc import Generator
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol
from pygls.protocol.language_server import lsp_method
from pygls.uris import to_fs_path

from fuzzyarm.lsp.protocol import Converter
from fuzzyarm.lsp.session import SLOW, UTF16, Session
from fuzzyarm.version import __version__


class Protocol(LanguageServerProtocol):
    """The protocol with the texts kept in sessions.

    The library's own copies of the texts would end lines where the protocol does not (at
    form feeds and other separators), and every change would be made twice.
    """

    @lsp_method(types.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(
        self, params: types.DidOpenTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Hand an opened file to its handler."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_OPEN], (params,), None

    @lsp_method(types.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(
        self, params: types.DidChangeTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Hand a change to its handler."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_CHANGE], (params,), None

    @lsp_method(types.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(
        self, params: types.DidCloseTextDocumentParams
    ) -> Generator[Any, Any, None]:
        """Hand a closed file to its handler."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_CLOSE], (params,), None


class FuzzyarmServer(LanguageServer):
    """The language server of ``.frb`` and ``.lut`` files."""

    def __init__(self) -> None:
        super().__init__("fuzzyarm", __version__, protocol_cls=Protocol)
        self.sessions: dict[str, Session] = {}
        self._timers: dict[str, asyncio.TimerHandle] = {}
        self._running: set[asyncio.Task[None]] = set()

    # ── files ────────────────────────────────────────────────────────────────────────

    @property
    def encoding(self) -> str:
        """The code unit that was agreed with the editor."""
        agreed = self.workspace.position_encoding or UTF16
        return str(getattr(agreed, "value", agreed))

    def session(self, uri: str) -> Session:
        """Return the open file at `uri`.

        Raises
        ------
        JsonRpcInvalidParams
            If it is not open: that is the editor's mistake, and it is told so.
        """
        if uri not in self.sessions:
            raise JsonRpcInvalidParams(message=f"the file {uri} is not open")
        return self.sessions[uri]

    def converter(self, uri: str) -> Converter:
        """Return what turns positions in an open file into lines and columns, and back."""
        capabilities = self.client_capabilities.text_document
        completion = capabilities.completion if capabilities else None
        item = completion.completion_item if completion else None
        snippets = bool(item and item.snippet_support)
        return Converter(uri, self.session(uri).lines, self.encoding, snippets)

    def open(self, document: types.TextDocumentItem) -> None:
        """Take an opened file."""
        path = to_fs_path(document.uri) or document.uri
        if document.language_id == "fuzzyarm-table" and not path.lower().endswith(".lut"):
            path += ".lut"
        self.sessions[document.uri] = Session(path, document.text, document.version)
        self._schedule(document.uri, pause=False)

    def change(self, params: types.DidChangeTextDocumentParams) -> None:
        """Take the changes of a file."""
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
        """Forget a file and what was found in it."""
        self.sessions.pop(uri, None)
        timer = self._timers.pop(uri, None)
        if timer is not None:
            timer.cancel()
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))

    # ── diagnostics ──────────────────────────────────────────────────────────────────

    def _schedule(self, uri: str, *, pause: bool = True) -> None:
        """Check a file soon: at once if that is quick, else (with `pause`) when typing pauses."""
        waiting = self._timers.pop(uri, None)
        if waiting is not None:
            waiting.cancel()
        cost = self.sessions[uri].cost
        delay = 0.0 if cost < SLOW or not pause else min(1.5, 2.0 * cost)
        self._timers[uri] = asyncio.get_running_loop().call_later(delay, self._check, uri)

    def _check(self, uri: str) -> None:
        self._timers.pop(uri, None)
        text = self.sessions.get(uri)
        if text is None:
            return
        if text.cost < SLOW:
            self._publish(uri, text)
            return
        task = asyncio.ensure_future(self._check_aside(uri, text))
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    async def _check_aside(self, uri: str, text: Session) -> None:
        copy = Session(text.path, text.text, text.version)
        await asyncio.to_thread(copy.review)
        if self.sessions.get(uri) is text and text.adopt(copy):
            self._publish(uri, text)

    def _publish(self, uri: str, text: Session) -> None:
        """Send the findings of a file to the editor."""
        converter = self.converter(uri)
        found = [converter.diagnostic(d) for d in text.review().diagnostics]
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri, found, text.version)
        )
