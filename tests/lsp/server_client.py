"""A client that talks to the real server process, and short ways to ask it."""

from __future__ import annotations

import asyncio
import sys
from typing import Any

from lsprotocol import types
from pytest_lsp import ClientServerConfig, LanguageClient, client_capabilities

CONFIG = ClientServerConfig(server_command=[sys.executable, "-m", "fuzzyarm", "lsp"])
PUBLISH = types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS
PATIENCE = 120.0  # s: other tests run beside
CHANGE = types.TextDocumentContentChangeWholeDocument


async def start(client: LanguageClient, encodings: list[str] | None = None) -> dict[str, Any]:
    """Say hello as Visual Studio Code would, with the position encodings that are asked for."""
    capabilities = client_capabilities("visual-studio-code")
    if encodings is not None:
        capabilities.general = types.GeneralClientCapabilities(position_encodings=encodings)
    result = await client.initialize_session(types.InitializeParams(capabilities=capabilities))
    return {"capabilities": result.capabilities, "info": result.server_info}


def published(client: LanguageClient) -> asyncio.Queue[Any]:
    """Return what the server publishes, from the first call on; none of it is missed."""
    if not hasattr(client, "published"):
        client.published = asyncio.Queue()

        def hear(params: Any) -> None:
            client.published.put_nowait(params)
            client.protocol.wait_for_notification(PUBLISH, hear)

        client.protocol.wait_for_notification(PUBLISH, hear)
    return client.published


class File:
    """A file that is open in the server under test."""

    count = 0

    def __init__(self, client: LanguageClient, uri: str) -> None:
        self.client = client
        self.uri = uri
        self.version = 1

    @classmethod
    async def open(cls, client: LanguageClient, text: str, name: str = "test.frb") -> File:
        cls.count += 1
        file = cls(client, f"file:///rules/{cls.count}/{name}")
        language = "fuzzyarm-table" if name.endswith(".lut") else "fuzzyarm"
        item = types.TextDocumentItem(file.uri, language, 1, text)
        published(client)
        client.text_document_did_open(types.DidOpenTextDocumentParams(item))
        await file._arrived()
        return file

    async def change(self, *changes: Any) -> list[types.Diagnostic]:
        self.version += 1
        published(self.client)
        identifier = types.VersionedTextDocumentIdentifier(self.version, self.uri)
        params = types.DidChangeTextDocumentParams(identifier, list(changes))
        self.client.text_document_did_change(params)
        return await self._arrived()

    async def _arrived(self) -> list[types.Diagnostic]:
        while True:
            params = await asyncio.wait_for(published(self.client).get(), PATIENCE)
            if params.uri == self.uri and params.version == self.version:
                return list(params.diagnostics)

    @property
    def found(self) -> list[types.Diagnostic]:
        return list(self.client.diagnostics[self.uri])

    @property
    def identifier(self) -> types.TextDocumentIdentifier:
        return types.TextDocumentIdentifier(self.uri)

    async def ask(self, what: str, line: int, character: int, **more: Any) -> Any:
        """Ask a question about a position, from 0."""
        kinds = {
            "completion": types.CompletionParams,
            "hover": types.HoverParams,
            "definition": types.DefinitionParams,
            "references": types.ReferenceParams,
            "document_highlight": types.DocumentHighlightParams,
            "prepare_rename": types.PrepareRenameParams,
            "rename": types.RenameParams,
        }
        question = kinds[what](
            text_document=self.identifier, position=types.Position(line, character), **more
        )
        return await getattr(self.client, f"text_document_{what}_async")(question)


def partial(start: tuple[int, int], end: tuple[int, int], text: str) -> Any:
    """Return one incremental change."""
    where = types.Range(types.Position(*start), types.Position(*end))
    return types.TextDocumentContentChangePartial(range=where, text=text)
