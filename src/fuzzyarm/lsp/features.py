"""Each feature of the protocol as a small function of a server and its question."""

from __future__ import annotations

import gc
from collections.abc import Callable
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from fuzzyarm.language import format_text
from fuzzyarm.language.queries import (
    COLOURS,
    RenameError,
    coloured,
    complete,
    definitions,
    fixes,
    folds,
    hover,
    occurrence_at,
    references,
    rename,
    symbols,
)
from fuzzyarm.lsp.protocol import Converter, encoded
from fuzzyarm.lsp.server import FuzzyarmServer
from fuzzyarm.lsp.session import Session
from fuzzyarm.lsp.tables import TableText, formatted_table
from fuzzyarm.text.diagnostic import RuleBaseError, Span

LEGEND = types.SemanticTokensLegend(list(COLOURS), ["declaration"])


def initialized(server: FuzzyarmServer, params: types.InitializedParams) -> None:
    """Load what the first check of a sound file needs, so that it is as quick as the others."""
    import fuzzyarm.inference
    import fuzzyarm.language.check  # noqa: F401


def did_open(server: FuzzyarmServer, params: types.DidOpenTextDocumentParams) -> None:
    """Take an opened file and check it."""
    server.open(params.text_document)


def did_change(server: FuzzyarmServer, params: types.DidChangeTextDocumentParams) -> None:
    """Take changes and check the file again."""
    server.change(params)


def did_close(server: FuzzyarmServer, params: types.DidCloseTextDocumentParams) -> None:
    """Forget a file."""
    server.close(params.text_document.uri)


def _at(server: FuzzyarmServer, params: types.HoverParams) -> tuple[Session, Converter, int, int]:
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    return session, converter, *converter.place(params.position)


def completion(server: FuzzyarmServer, params: types.CompletionParams) -> types.CompletionList:
    """Return what could stand at a place."""
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    line, column = converter.place(params.position)
    if session.is_table:
        offered = TableText(session.text).complete(line, column)
    else:
        offered = complete(session.quick_reading, line, column)
    snippets = _takes_snippets(server)
    items = [converter.completion(c, rank, snippets=snippets) for rank, c in enumerate(offered)]
    return types.CompletionList(is_incomplete=False, items=items)


def _takes_snippets(server: FuzzyarmServer) -> bool:
    text = server.client_capabilities.text_document
    item = text.completion.completion_item if text and text.completion else None
    return bool(item and item.snippet_support)


def show_hover(server: FuzzyarmServer, params: types.HoverParams) -> types.Hover | None:
    """Return what stands at a place, explained."""
    session, converter, line, column = _at(server, params)
    if session.is_table:
        found = TableText(session.text).hover(line, column)
    else:
        found = hover(session.reading, line, column)
    if found is None:
        return None
    content = types.MarkupContent(types.MarkupKind.Markdown, found.markdown)
    return types.Hover(content, converter.range(found.span))


def _spans(
    session: Session, line: int, column: int, *, defining: bool, declared: bool = True
) -> list[Span]:
    if session.is_table:
        table = TableText(session.text)
        named = table.name_at(line, column)
        if named is None:
            return []
        homes = table.definitions(named[0])
        every = homes if defining else table.occurrences(named[0])
        return [span for span in every if declared or span not in homes]
    occurrence = occurrence_at(session.reading, line, column)
    if occurrence is None:
        return []
    found = definitions if defining else references
    places = found(session.reading, occurrence)
    return [o.span for o in places if declared or not o.is_definition]


def definition(server: FuzzyarmServer, params: types.DefinitionParams) -> list[types.Location]:
    """Return where the name at a place is declared."""
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    spans = _spans(session, *converter.place(params.position), defining=True)
    return [types.Location(params.text_document.uri, converter.range(span)) for span in spans]


def find_references(server: FuzzyarmServer, params: types.ReferenceParams) -> list[types.Location]:
    """Return every place of the name at a place."""
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    spans = _spans(
        session,
        *converter.place(params.position),
        defining=False,
        declared=params.context.include_declaration,
    )
    return [types.Location(params.text_document.uri, converter.range(span)) for span in spans]


def highlight(
    server: FuzzyarmServer, params: types.DocumentHighlightParams
) -> list[types.DocumentHighlight]:
    """Return every place of the name at a place, to be marked in the file."""
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    spans = _spans(session, *converter.place(params.position), defining=False)
    return [types.DocumentHighlight(converter.range(span)) for span in spans]


def prepare_rename(
    server: FuzzyarmServer, params: types.PrepareRenameParams
) -> types.PrepareRenamePlaceholder | None:
    """Return the name at a place, if it can have another."""
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    line, column = converter.place(params.position)
    if session.is_table:
        named = TableText(session.text).name_at(line, column)
    else:
        occurrence = occurrence_at(session.reading, line, column)
        named = None if occurrence is None else (occurrence.name, occurrence.span)
    if named is None:
        return None
    return types.PrepareRenamePlaceholder(converter.range(named[1]), named[0])


def do_rename(server: FuzzyarmServer, params: types.RenameParams) -> types.WorkspaceEdit:
    """Return the edits that give the name at a place another one."""
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    line, column = converter.place(params.position)
    try:
        if session.is_table:
            edits = TableText(session.text).rename(line, column, params.new_name)
        else:
            edits = rename(session.reading, line, column, params.new_name)
    except RenameError as error:
        raise JsonRpcInvalidParams(message=str(error)) from error
    return encoded(converter.edits(edits), params.text_document.uri)


def document_symbols(
    server: FuzzyarmServer, params: types.DocumentSymbolParams
) -> list[types.DocumentSymbol]:
    """Return the outline of a file."""
    session = server.session(params.text_document.uri)
    converter = server.converter(session)
    found = TableText(session.text).symbols() if session.is_table else symbols(session.reading)
    return [converter.symbol(symbol) for symbol in found]


def folding(server: FuzzyarmServer, params: types.FoldingRangeParams) -> list[types.FoldingRange]:
    """Return what can be folded away."""
    session = server.session(params.text_document.uri)
    found = TableText(session.text).folds() if session.is_table else folds(session.reading)
    return [
        types.FoldingRange(
            fold.first - 1,
            fold.last - 1,
            kind=types.FoldingRangeKind.Comment if fold.is_comment else None,
        )
        for fold in found
    ]


def formatting(
    server: FuzzyarmServer, params: types.DocumentFormattingParams
) -> list[types.TextEdit] | None:
    """Return the canonical text as one edit; nothing for a file with mistakes."""
    session = server.session(params.text_document.uri)
    if session.is_table:
        text = formatted_table(session.text)
    else:
        try:
            text = format_text(session.text, session.path)
        except RuleBaseError:
            text = None
    if text is None or text == session.text:
        return None if text is None else []
    lines = session.lines
    end = types.Position(len(lines) + 1, 0)
    return [types.TextEdit(types.Range(types.Position(0, 0), end), text)]


def semantic_tokens(
    server: FuzzyarmServer, params: types.SemanticTokensParams
) -> types.SemanticTokens:
    """Return the kind of every word."""
    session = server.session(params.text_document.uri)
    words = TableText(session.text).coloured() if session.is_table else coloured(session.reading)
    return types.SemanticTokens(data=server.converter(session).semantic_tokens(words))


def code_actions(server: FuzzyarmServer, params: types.CodeActionParams) -> list[types.CodeAction]:
    """Return the repairs for the findings at a place."""
    uri = params.text_document.uri
    session = server.session(uri)
    converter = server.converter(session)
    wanted = converter.span(params.range)
    grids = [] if session.is_table else session.grids
    return [
        types.CodeAction(
            title=fix.title,
            kind=types.CodeActionKind.QuickFix,
            diagnostics=[converter.diagnostic(finding, uri)],
            edit=encoded(converter.edits(fix.edits), uri),
            is_preferred=fix.preferred or None,
        )
        for finding in session.review().diagnostics
        if _overlap(finding.span, wanted)
        for fix in fixes(finding, session.text, grids)
    ]


def _overlap(one: Span, other: Span) -> bool:
    starts_before = (one.line, one.column) <= (other.end_line, other.end_column)
    return starts_before and (other.line, other.column) <= (one.end_line, one.end_column)


def register(server: FuzzyarmServer) -> None:
    """Tell `server` which function answers which question."""
    triggers = types.CompletionOptions(trigger_characters=[" ", ":", "'", "\\"])
    handlers: list[tuple[str, Callable[..., Any], Any]] = [
        (types.INITIALIZED, initialized, None),
        (types.TEXT_DOCUMENT_DID_OPEN, did_open, None),
        (types.TEXT_DOCUMENT_DID_CHANGE, did_change, None),
        (types.TEXT_DOCUMENT_DID_CLOSE, did_close, None),
        (types.TEXT_DOCUMENT_COMPLETION, completion, triggers),
        (types.TEXT_DOCUMENT_HOVER, show_hover, None),
        (types.TEXT_DOCUMENT_DEFINITION, definition, None),
        (types.TEXT_DOCUMENT_REFERENCES, find_references, None),
        (types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT, highlight, None),
        (types.TEXT_DOCUMENT_PREPARE_RENAME, prepare_rename, None),
        (types.TEXT_DOCUMENT_RENAME, do_rename, types.RenameOptions(prepare_provider=True)),
        (types.TEXT_DOCUMENT_DOCUMENT_SYMBOL, document_symbols, None),
        (types.TEXT_DOCUMENT_FOLDING_RANGE, folding, None),
        (types.TEXT_DOCUMENT_FORMATTING, formatting, None),
        (types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, semantic_tokens, LEGEND),
        (
            types.TEXT_DOCUMENT_CODE_ACTION,
            code_actions,
            types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix]),
        ),
    ]
    for name, function, options in handlers:
        server.feature(name, options)(function)


def make_server() -> FuzzyarmServer:
    """Return a server with every feature."""
    server = FuzzyarmServer()
    register(server)
    # What has been imported lives as long as the process: never look through it again.
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 50)
    return server
