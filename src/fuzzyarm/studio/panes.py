"""The two panes of the studio: the text, and the drawing that the arrow keys act on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar

from rich.style import Style
from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.message import Message
from textual.timer import Timer
from textual.widgets import Static, TextArea
from textual.widgets.text_area import TextAreaTheme

from fuzzyarm.language.queries import Coloured
from fuzzyarm.show.figures.live import RATE, LiveView, frames_of
from fuzzyarm.studio.scene import RULES, RulebaseScene, Scene
from fuzzyarm.text.diagnostic import Diagnostic, Span

if TYPE_CHECKING:
    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Plant

# --- The text of the studio, coloured by what each word is ---

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
        """Show words and findings, whose positions are those of the text as it is now."""
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
        """Put the cursor at a position that counts from 1, and look at it."""
        row = min(line, self.document.line_count) - 1
        self.move_cursor((row, min(column - 1, len(self.document.get_line(row)))), center=True)
        if column < self.content_size.width - 1:  # what fits is seen from its beginning
            self.scroll_to(x=0, animate=False)

    def replace_all(self, text: str) -> None:
        """Put another text in place of this one; undo brings it back, the cursor stays about."""
        row, column = self.cursor_location
        self.replace(text, (0, 0), self.document.end)
        self.go_to(row + 1, column + 1)


# --- The right side of the studio: a drawing that the arrow keys act on ---


class View(VerticalScroll, can_focus=True):
    """One drawing of a scene."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "move_across(-1)", "move inputs", show=False),
        Binding("right", "move_across(1)", "move inputs", show=False),
        Binding("up", "move_down(-1)", "move inputs", show=False),
        Binding("down", "move_down(1)", "move inputs", show=False),
        Binding("shift+left", "move_across(-1, True)", show=False),
        Binding("shift+right", "move_across(1, True)", show=False),
        Binding("shift+up", "move_down(-1, True)", show=False),
        Binding("shift+down", "move_down(1, True)", show=False),
        Binding("home,c", "centre", "middle", show=False),
        Binding("x", "turn(True)", "other input across", show=False),
        Binding("y", "turn(False)", "other input down", show=False),
        Binding("o", "next_output", "other output", show=False),
        Binding("enter", "jump", "to the text", show=False),
        Binding("1", "app.show_view(0)", show=False),
        Binding("2", "app.show_view(1)", show=False),
        Binding("3", "app.show_view(2)", show=False),
        Binding("4", "app.show_view(3)", show=False),
    ]

    class Moved(Message):
        """The crisp inputs have changed."""

    class Jump(Message):
        """A position in the text was pointed at."""

        def __init__(self, span: Span) -> None:
            super().__init__()
            self.span = span

    def __init__(self) -> None:
        super().__init__(id="view")
        self.scene: Scene | None = None
        self.view = ""
        self.is_current = True
        self.findings: tuple[Diagnostic, ...] = ()
        self._film: Timer | None = None

    def compose(self) -> ComposeResult:
        """Return the one drawing."""
        yield Static(id="drawing", markup=False)

    def show(self, scene: Scene | None, view: str, *, is_current: bool) -> None:
        """Draw a view of `scene`; a scene of an earlier text is drawn dimmed."""
        self._stop()
        self.scene, self.view, self.is_current = scene, view, is_current
        self.draw()

    def play(self, run: Run, plant: Plant) -> None:
        """Show a run from its beginning; it stays at its end until another view is shown."""
        self._stop()
        frames, live = iter(frames_of(run)), LiveView(run, plant)

        def step() -> None:
            index = next(frames, None)
            if index is None:
                self._stop()
                return
            region = self.scrollable_content_region
            drawn = live.at(index, max(20, region.width), max(6, region.height))
            self.query_one("#drawing", Static).update(drawn)

        self._film = self.set_interval(1.0 / RATE, step)

    def _stop(self) -> None:
        if self._film is not None:
            self._film.stop()
            self._film = None

    def draw(self) -> None:
        """Draw again, in the room there is."""
        drawing = self.query_one("#drawing", Static)
        if self.scene is None:
            broken = any(found.is_error for found in self.findings)
            words = "the text has mistakes" if broken else "F6 runs the controller"
            drawing.update(Text(f"There is nothing to show yet: {words}.", "dim"))
            return
        width = max(20, self.scrollable_content_region.width)
        height = max(6, self.scrollable_content_region.height)
        drawing.update(self.scene.draw(self.view, width, height))

    def on_resize(self) -> None:
        """Use the new room."""
        self.draw()

    def _moved(self) -> None:
        self.draw()
        self.post_message(self.Moved())

    def _step(self, name: str, steps: int, *, coarse: bool) -> None:
        if self.scene is None:
            return
        if self.view == RULES and isinstance(self.scene, RulebaseScene):
            self.scene.step_term(name, steps)
        else:
            self.scene.move(name, steps, coarse=coarse)
        self._moved()

    def action_move_across(self, steps: int, coarse: bool = False) -> None:
        """Move the input that goes across."""
        self._step(self.scene.across if self.scene else "", steps, coarse=coarse)

    def action_move_down(self, steps: int, coarse: bool = False) -> None:
        """Move the input that goes down; scroll where there is none."""
        if self.scene is not None and not self.scene.down:
            self.scroll_relative(y=steps, animate=False)
            return
        # Rules and tables are listed downward; on a surface the numbers rise upward.
        upward = isinstance(self.scene, RulebaseScene) and self.view != RULES
        self._step(
            self.scene.down if self.scene else "", -steps if upward else steps, coarse=coarse
        )

    def action_centre(self) -> None:
        """Put the inputs in the middle."""
        if self.scene is not None:
            self.scene.centre()
            self._moved()

    def action_turn(self, across: bool) -> None:
        """Give the arrow keys another input."""
        if self.scene is not None:
            self.scene.turn(across=across)
            self._moved()

    def action_next_output(self) -> None:
        """Show another output."""
        if isinstance(self.scene, RulebaseScene):
            self.scene.next_output()
            self._moved()

    def action_jump(self) -> None:
        """Go to the strongest rule, or the chosen cell, in the text."""
        span = self.scene.position() if self.scene is not None else None
        if span is not None:
            self.post_message(self.Jump(span))

    def on_click(self, event: events.Click) -> None:
        """Go to the grid cell under the pointer."""
        drawing = self.query_one("#drawing", Static)
        offset = event.get_content_offset(drawing)
        if self.scene is None or offset is None:
            return
        line = drawing.render_line(offset.y).text
        span = self.scene.position_at(self.view, offset.x, offset.y, line)
        if span is not None:
            self.post_message(self.Jump(span))
