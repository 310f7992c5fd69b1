"""Conversion between fuzzyarm's types and the protocol's."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from lsprotocol import types

from fuzzyarm.apps.lsp.session import to_place, to_position
from fuzzyarm.base.diagnostic import Diagnostic, Severity, Span
from fuzzyarm.language.edit import COLOURS, Coloured, Completion, Edit, OutlineSymbol

_SEVERITIES = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.INFO: types.DiagnosticSeverity.Information,
}
_COMPLETION_KINDS = {
    "keyword": types.CompletionItemKind.Keyword,
    "variable": types.CompletionItemKind.Variable,
    "term": types.CompletionItemKind.EnumMember,
    "shape": types.CompletionItemKind.Function,
    "hedge": types.CompletionItemKind.Operator,
    "value": types.CompletionItemKind.Value,
    "row": types.CompletionItemKind.Snippet,
}
_SYMBOL_KINDS = {
    "rulebase": types.SymbolKind.Module,
    "input": types.SymbolKind.Variable,
    "output": types.SymbolKind.Field,
    "term": types.SymbolKind.EnumMember,
    "block": types.SymbolKind.Namespace,
    "grid": types.SymbolKind.Array,
    "rule": types.SymbolKind.Function,
    "lookup": types.SymbolKind.Object,
    "expect": types.SymbolKind.Boolean,
    "prove": types.SymbolKind.Boolean,
}


@dataclass(frozen=True, slots=True)
class Converter:
    """Positions in a text under an encoding.

    Attributes
    ----------
    uri : str
        URI of the text.
    lines : sequence of str
        Its lines without their ends.
    encoding : str
        Unit of the protocol's columns.
    snippets : bool
        Whether the editor supports completions with placeholders.
    """

    uri: str
    lines: Sequence[str]
    encoding: str
    snippets: bool = False

    def line_and_column(self, position: types.Position) -> tuple[int, int]:
        """Return line and column, from 1."""
        return to_place(self.lines, position.line, position.character, self.encoding)

    def range(self, span: Span) -> types.Range:
        """Return a span as a range of the protocol."""
        start = to_position(self.lines, span.line, span.column, self.encoding)
        end = to_position(self.lines, span.end_line, span.end_column, self.encoding)
        return types.Range(types.Position(*start), types.Position(*max(start, end)))

    def span(self, where: types.Range) -> Span:
        """Return a range of the protocol as a span."""
        return Span(*self.line_and_column(where.start), *self.line_and_column(where.end))

    def location(self, span: Span) -> types.Location:
        """Return a span with its file."""
        return types.Location(self.uri, self.range(span))

    def diagnostic(self, finding: Diagnostic) -> types.Diagnostic:
        """Return a finding with its hint, its related positions and the data of its quick fix."""
        unused = finding.name in ("unused-term", "unused-variable", "duplicate-rule")
        return types.Diagnostic(
            range=self.range(finding.span),
            message=f"{finding.message}\nhint: {finding.hint}" if finding.hint else finding.message,
            severity=_SEVERITIES[finding.severity],
            code=finding.name,
            source="fuzzyarm",
            tags=[types.DiagnosticTag.Unnecessary] if unused else None,
            related_information=[
                types.DiagnosticRelatedInformation(self.location(related.span), related.message)
                for related in finding.related
            ]
            or None,
        )

    def workspace_edit(self, edits: Iterable[Edit]) -> types.WorkspaceEdit:
        """Return edits of the text as an edit of the workspace."""
        changes = [types.TextEdit(self.range(edit.span), edit.text) for edit in edits]
        return types.WorkspaceEdit(changes={self.uri: changes})

    def completion(self, candidate: Completion, rank: int) -> types.CompletionItem:
        """Return a candidate; `rank` determines the order."""
        snippet = candidate.snippet if self.snippets else ""
        text = snippet or candidate.insert
        edit = types.TextEdit(self.range(candidate.span), text) if candidate.span else None
        return types.CompletionItem(
            label=candidate.label,
            kind=_COMPLETION_KINDS[candidate.kind],
            detail=candidate.detail or None,
            sort_text=f"{rank:04}",
            filter_text=candidate.insert,
            text_edit=edit,
            insert_text=None if edit else text,
            insert_text_format=(
                types.InsertTextFormat.Snippet if snippet else types.InsertTextFormat.PlainText
            ),
        )

    def symbol(self, symbol: OutlineSymbol) -> types.DocumentSymbol:
        """Return a part of the outline."""
        return types.DocumentSymbol(
            name=symbol.name,
            detail=symbol.detail or None,
            kind=_SYMBOL_KINDS[symbol.kind],
            range=self.range(symbol.span),
            selection_range=self.range(symbol.selection),
            children=[self.symbol(child) for child in symbol.children] or None,
        )

    def semantic_tokens(self, words: Iterable[Coloured]) -> list[int]:
        """Return coloured words as protocol numbers, each relative to the previous one."""
        data: list[int] = []
        last_line = last_start = 0
        for word in words:
            line, start = to_position(self.lines, word.line, word.column, self.encoding)
            end = to_position(self.lines, word.line, word.end, self.encoding)[1]
            step = line - last_line
            data += [
                step,
                start - last_start if step == 0 else start,
                end - start,
                COLOURS.index(word.colour),
                int(word.declares),
            ]
            last_line, last_start = line, start
        return data
