"""The text of the studio, coloured by what each word is."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, ClassVar

from rich.style import Style
from textual import events
from textual.binding import Binding, BindingType
from textual.widgets import TextArea
from textual.widgets.text_area import TextAreaTheme

from fuzzyarm.rulebase import Diagnostic
from fuzzyarm.rulebase.queries import Coloured

THEME = TextAreaTheme(
    name="fuzzyarm",
    syntax_styles={
        "keyword": Style(color="bright_blue", bold=True),
        "namespace": Style(color="bright_magenta"),
        "variable": Style(color="bright_cyan"),
        "enumMember": Style(color="bright_green"),
        "modifier": Style(color="bright_magenta", italic=True),
        "type": Style(color="yellow"),
        "property": Style(color="blue"),
        "number": Style(color="bright_yellow"),
        "string": Style(color="green"),
        "comment": Style(color="bright_black", italic=True),
        "operator": Style(color="white"),
        "error": Style(underline=True, color="bright_red", bold=True),
        "warning": Style(underline=True, color="yellow"),
        "info": Style(underline=True),
    },
)
"""Colours of words and findings; those of the terminal itself, so that any palette works."""


class Editor(TextArea):
    """A text area whose words and findings have colours."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+z", "undo", "undo", show=False),
        Binding("ctrl+y", "redo", "redo", show=False),
    ]

    def __init__(self, text: str, **options: Any) -> None:
        self._coloured: list[Coloured] = []
        self._findings: tuple[Diagnostic, ...] = ()
        super().__init__(text, soft_wrap=False, tab_behavior="focus", **options)
        self.register_theme(THEME)
        self.theme = THEME.name

    async def _on_key(self, event: events.Key) -> None:
        # A key that moves the cursor would act after letters that arrive with it in one
        # packet, as they do over a slow line: the library lets it bubble up first.
        own = self._bindings.key_to_bindings.get(event.key)
        if own:
            event.stop()
            event.prevent_default()
            await self.run_action(own[0].action)

    def colour(self, words: Iterable[Coloured], findings: tuple[Diagnostic, ...]) -> None:
        """Show words and findings, whose places are those of the text as it is now."""
        self._coloured = list(words)
        self._findings = findings
        self._build_highlight_map()
        self.refresh()

    def _build_highlight_map(self) -> None:
        self._line_cache.clear()
        self._highlights.clear()
        lines = self.document.lines
        # The library's columns of a highlight count bytes.
        for word in self._coloured:
            if word.line <= len(lines):
                text = lines[word.line - 1]
                self._mark(word.line, text, word.column, word.end, word.colour)
        for found in self._findings:
            span = found.span
            if span.line <= len(lines):
                text = lines[span.line - 1]
                end = span.end_column if span.end_line == span.line else len(text) + 1
                self._mark(span.line, text, span.column, max(end, span.column + 1), found.severity)

    def _mark(self, line: int, text: str, column: int, end: int, name: str) -> None:
        start = len(text[: column - 1].encode("utf-8"))
        stop = len(text[: end - 1].encode("utf-8"))
        self._highlights[line - 1].append((start, stop, name))

    def go_to(self, line: int, column: int) -> None:
        """Put the cursor at a place that counts from 1, and look at it."""
        row = min(line, self.document.line_count) - 1
        self.move_cursor((row, min(column - 1, len(self.document.get_line(row)))), center=True)

    def replace_all(self, text: str) -> None:
        """Put another text in place of this one; undo brings it back, the cursor stays about."""
        row, column = self.cursor_location
        self.replace(text, (0, 0), self.document.end)
        self.go_to(row + 1, column + 1)
