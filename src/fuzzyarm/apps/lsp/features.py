"""The features of the protocol: a query about an open file, and its answer in protocol types."""

from __future__ import annotations

import gc
from collections.abc import Callable
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from fuzzyarm.apps.lsp.protocol import Converter
from fuzzyarm.apps.lsp.server import FuzzyarmServer
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.diagnostic import Span
from fuzzyarm.language.edit import COLOURS, RenameError


def _initialized(server: FuzzyarmServer, params: types.InitializedParams) -> None:
    """Preload the modules for the check of a sound file, so that the first check is fast."""
    import fuzzyarm.inference
    import fuzzyarm.language.check  # noqa: F401


def _did_open(server: FuzzyarmServer, params: types.DidOpenTextDocumentParams) -> None:
    server.open(params.text_document)


def _did_change(server: FuzzyarmServer, params: types.DidChangeTextDocumentParams) -> None:
    server.change(params)


def _did_close(server: FuzzyarmServer, params: types.DidCloseTextDocumentParams) -> None:
    server.close(params.text_document.uri)


def _completion(
    session: Session, to: Converter, params: types.CompletionParams
) -> types.CompletionList:
    offered = session.kind.complete(session.quick_reading, *to.line_and_column(params.position))
    items = [to.completion(candidate, rank) for rank, candidate in enumerate(offered)]
    return types.CompletionList(is_incomplete=False, items=items)


def _hover(session: Session, to: Converter, params: types.HoverParams) -> types.Hover | None:
    hover = session.hover(*to.line_and_column(params.position))
    if hover is None:
        return None
    content = types.MarkupContent(types.MarkupKind.Markdown, hover.markdown)
    return types.Hover(content, to.range(hover.span))


def _definition(
    session: Session, to: Converter, params: types.DefinitionParams
) -> list[types.Location]:
    occurrences = session.kind.occurrences(session.reading, *to.line_and_column(params.position))
    return [to.location(span) for span, declares in occurrences if declares]


def _references(
    session: Session, to: Converter, params: types.ReferenceParams
) -> list[types.Location]:
    occurrences = session.kind.occurrences(session.reading, *to.line_and_column(params.position))
    declared = params.context.include_declaration
    return [to.location(span) for span, declares in occurrences if declared or not declares]


def _highlight(
    session: Session, to: Converter, params: types.DocumentHighlightParams
) -> list[types.DocumentHighlight]:
    occurrences = session.kind.occurrences(session.reading, *to.line_and_column(params.position))
    return [types.DocumentHighlight(to.range(span)) for span, _ in occurrences]


def _prepare_rename(
    session: Session, to: Converter, params: types.PrepareRenameParams
) -> types.PrepareRenamePlaceholder | None:
    name_and_span = session.kind.name_at(session.reading, *to.line_and_column(params.position))
    return name_and_span and types.PrepareRenamePlaceholder(
        to.range(name_and_span[1]), name_and_span[0]
    )


def _rename(session: Session, to: Converter, params: types.RenameParams) -> types.WorkspaceEdit:
    try:
        edits = session.kind.rename(
            session.reading, *to.line_and_column(params.position), params.new_name
        )
    except RenameError as error:
        raise JsonRpcInvalidParams(message=str(error)) from error
    return to.workspace_edit(edits)


def _symbols(
    session: Session, to: Converter, params: types.DocumentSymbolParams
) -> list[types.DocumentSymbol]:
    return [to.symbol(symbol) for symbol in session.kind.symbols(session.reading)]


def _folding(
    session: Session, to: Converter, params: types.FoldingRangeParams
) -> list[types.FoldingRange]:
    return [
        types.FoldingRange(
            fold.first - 1,
            fold.last - 1,
            kind=types.FoldingRangeKind.Comment if fold.is_comment else None,
        )
        for fold in session.kind.folds(session.reading)
    ]


def _formatting(
    session: Session, to: Converter, params: types.DocumentFormattingParams
) -> list[types.TextEdit] | None:
    """Return the canonical text as one edit; None for a file with mistakes."""
    formatted = session.kind.formatted(session.reading)
    if formatted is None or formatted == session.text:
        return None if formatted is None else []
    # Behind the last line: the end of the text in the protocol.
    end = types.Position(len(session.lines) + 1, 0)
    return [types.TextEdit(types.Range(types.Position(0, 0), end), formatted)]


def _semantic_tokens(
    session: Session, to: Converter, params: types.SemanticTokensParams
) -> types.SemanticTokens:
    return types.SemanticTokens(data=to.semantic_tokens(session.kind.coloured(session.reading)))


def _code_actions(
    session: Session, to: Converter, params: types.CodeActionParams
) -> list[types.CodeAction]:
    span = to.span(params.range)
    return [
        types.CodeAction(
            title=fix.title,
            kind=types.CodeActionKind.QuickFix,
            diagnostics=[to.diagnostic(finding)],
            edit=to.workspace_edit(fix.edits),
            is_preferred=fix.preferred or None,
        )
        for finding in (session.review().diagnostics if session.reviewed else ())
        if _overlap(finding.span, span)
        for fix in session.kind.fixes(session.reading, finding)
    ]


def _overlap(one: Span, other: Span) -> bool:
    starts_before = (one.line, one.column) <= (other.end_line, other.end_column)
    return starts_before and (other.line, other.column) <= (one.end_line, one.end_column)


_EVENTS: tuple[tuple[str, Callable[..., None]], ...] = (
    (types.INITIALIZED, _initialized),
    (types.TEXT_DOCUMENT_DID_OPEN, _did_open),
    (types.TEXT_DOCUMENT_DID_CHANGE, _did_change),
    (types.TEXT_DOCUMENT_DID_CLOSE, _did_close),
)
"""Notifications of an editor → their handlers."""

_QUESTIONS: tuple[tuple[str, Callable[..., Any], Any], ...] = (
    (
        types.TEXT_DOCUMENT_COMPLETION,
        _completion,
        types.CompletionOptions(trigger_characters=[" ", ":", "'", "\\"]),
    ),
    (types.TEXT_DOCUMENT_HOVER, _hover, None),
    (types.TEXT_DOCUMENT_DEFINITION, _definition, None),
    (types.TEXT_DOCUMENT_REFERENCES, _references, None),
    (types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT, _highlight, None),
    (types.TEXT_DOCUMENT_PREPARE_RENAME, _prepare_rename, None),
    (types.TEXT_DOCUMENT_RENAME, _rename, types.RenameOptions(prepare_provider=True)),
    (types.TEXT_DOCUMENT_DOCUMENT_SYMBOL, _symbols, None),
    (types.TEXT_DOCUMENT_FOLDING_RANGE, _folding, None),
    (types.TEXT_DOCUMENT_FORMATTING, _formatting, None),
    (
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL,
        _semantic_tokens,
        types.SemanticTokensLegend(list(COLOURS), ["declaration"]),
    ),
    (
        types.TEXT_DOCUMENT_CODE_ACTION,
        _code_actions,
        types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix]),
    ),
)
"""Requests of an editor about an open file → handler and server capability."""


def _answered_by(function: Callable[..., Any]) -> Callable[..., Any]:
    def answer(server: FuzzyarmServer, params: Any) -> Any:
        uri = params.text_document.uri
        return function(server.session(uri), server.converter(uri), params)

    return answer


def _answered_when_checked(function: Callable[..., Any]) -> Callable[..., Any]:
    async def answer(server: FuzzyarmServer, params: Any) -> Any:
        uri = params.text_document.uri
        session = await server.checked(uri)
        return function(session, server.converter(uri), params)

    return answer


def make_server() -> FuzzyarmServer:
    """Return a server with every feature."""
    server = FuzzyarmServer()
    for name, function in _EVENTS:
        server.feature(name)(function)
    for name, function, options in _QUESTIONS:
        # Repairs belong to findings: they wait for the check.
        answered = _answered_when_checked if function is _code_actions else _answered_by
        server.feature(name, options)(answered(function))
    # Imported modules live as long as the process: exclude them from garbage collection.
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 50)
    return server
