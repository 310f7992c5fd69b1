"""The studio as a Textual application."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from rich.text import Text
from textual import events
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.timer import Timer
from textual.widgets import Footer, OptionList, Static, TextArea
from textual.widgets.option_list import Option

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.language.queries import Candidate, apply_edits
from fuzzyarm.studio.document import StudioDocument
from fuzzyarm.studio.panes import Editor, View
from fuzzyarm.studio.running import run_text
from fuzzyarm.studio.screens import CompletionScreen, FindScreen, KeysScreen
from fuzzyarm.text.diagnostic import Diagnostic, Severity, Span
from fuzzyarm.text.files import stamp_of, write_atomically

if TYPE_CHECKING:
    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Plant

_PAUSE = 0.05
_STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "yellow", Severity.INFO: "cyan"}


class Studio(App[int]):
    """A rule base and what it means, side by side.

    Parameters
    ----------
    document : StudioDocument
        The file.
    """

    CSS_PATH = "studio.tcss"
    ENABLE_COMMAND_PALETTE = False
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]  # noqa: RUF012 - as declared
    VERTICAL_BREAKPOINTS = [(0, "-short"), (34, "-tall")]  # noqa: RUF012 - in the library
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f1", "explain_keys", "keys"),
        Binding("f2", "show_view(0)", "surface"),
        Binding("f3", "show_view(1)", "rules"),
        Binding("f4", "show_view(2)", "terms"),
        Binding("f5", "show_view(3)", "firing"),
        Binding("f6", "run", "run", priority=True),
        Binding("f7,ctrl+@,ctrl+space", "complete", "complete", show=False, priority=True),
        Binding("f8", "next_finding", "next"),
        Binding("f9", "repair", "fix"),
        Binding("ctrl+f", "find", "find", show=False, priority=True),
        Binding("ctrl+g", "find_next", show=False, priority=True),
        Binding("ctrl+s", "save", "save", priority=True),
        Binding("ctrl+q", "leave", "quit", priority=True),
    ]

    def __init__(self, document: StudioDocument) -> None:
        super().__init__()
        self.document = document
        self.view_index = 0
        self._saved = document.text
        self._stamp = stamp_of(document.path)
        self._waiting: Timer | None = None
        self._warned_of = ""
        self._sought = ""
        self._run_is_made = False

    def compose(self) -> ComposeResult:
        """Return the parts, top to bottom."""
        yield Static(id="title", markup=False)
        with Horizontal(id="work"):
            yield Editor(self.document.text, id="editor")
            with Vertical(id="right"):
                yield Static(id="views", markup=False)
                yield View()
                yield Static(id="point", markup=False)
        yield OptionList(id="findings")
        yield Footer(compact=True, show_command_palette=False)

    def on_mount(self) -> None:
        """Show the file."""
        self.query_one(Editor).focus()
        self.show_everything()

    # ── showing ──────────────────────────────────────────────────────────────────────

    def show_everything(self) -> None:
        """Show text, drawing and findings as they are now."""
        self._show_colours()
        self._show_findings()
        self._show_scene()
        self._show_title()

    def _show_colours(self) -> None:
        session = self.document.session
        words = session.kind.coloured(session.reading)
        self.query_one(Editor).colour(words, self.document.findings)

    def _show_title(self) -> None:
        text = Text(f" {Path(self.document.path).name}", "bold", no_wrap=True)
        text.append(" • " if self.is_changed else "   ", "yellow")
        text.append(self.document.summary, "not bold")
        if not self.document.is_current and self.document.scene is not None:
            text.append("   the drawing shows the last sound text", "not bold yellow")
        self.query_one("#title", Static).update(text)

    def _show_scene(self) -> None:
        scene = self.document.scene
        names = scene.VIEWS if scene is not None else ("surface",)
        self.view_index = min(self.view_index, len(names) - 1)
        tabs = Text(no_wrap=True)
        for index, name in enumerate(names):
            style = "reverse" if index == self.view_index else "dim"
            tabs.append(f" {index + 1} {name} ", style)
        self.query_one("#views", Static).update(tabs)
        view = self.query_one(View)
        view.findings = self.document.findings
        view.show(scene, names[self.view_index], is_current=self.document.is_current)
        view.set_class(not self.document.is_current, "stale")
        self._show_point()

    def _show_point(self) -> None:
        scene = self.document.scene
        self.query_one("#point", Static).update(scene.caption() if scene else Text())

    def _show_findings(self) -> None:
        listed = self.query_one("#findings", OptionList)
        before = listed.highlighted
        listed.clear_options()
        for found in self.document.findings:
            line = Text(f"{found.line}:{found.column} ", "dim", no_wrap=True)
            line.append(f"{found.message}", _STYLES[found.severity])
            if found.hint:
                line.append(f"  {found.hint}", "italic")
            listed.add_option(Option(line))
        if not self.document.findings:
            listed.add_option(Option(Text("no findings", "dim green"), disabled=True))
        else:
            listed.highlighted = min(before or 0, len(self.document.findings) - 1)

    # ── the text changes ─────────────────────────────────────────────────────────────

    @property
    def is_changed(self) -> bool:
        """Whether the text differs from the file."""
        return self.query_one(Editor).text != self._saved

    def on_text_area_changed(self, event: TextArea.Changed) -> None:
        """Read the text again when the typing pauses for a moment."""
        if self._waiting is not None:
            self._waiting.stop()
        # A text that takes long to check waits until the typing does.
        pause = max(_PAUSE, 2.0 * self.document.session.cost)
        self._waiting = self.set_timer(pause, self.read_text)

    def read_text(self) -> None:
        """Read the text as it is now and show what it means."""
        if self._waiting is not None:
            self._waiting.stop()
            self._waiting = None
        text = self.query_one(Editor).text
        if text == self.document.text:  # a run that is shown goes on
            self._show_title()
            return
        self.document.update(text)
        self.show_everything()

    # ── keys ─────────────────────────────────────────────────────────────────────────

    def action_show_view(self, index: int) -> None:
        """Draw another view."""
        scene = self.document.scene
        if scene is not None and index < len(scene.VIEWS):
            self.view_index = index
            self._show_scene()
            self.query_one(View).scroll_home(animate=False)

    def action_explain_keys(self) -> None:
        """Show what the keys do."""
        self.push_screen(KeysScreen())

    # ── completion and find ──────────────────────────────────────────────────────────

    def action_complete(self) -> None:
        """Offer what can stand at the cursor, as the editor's server does."""
        self.read_text()
        editor, session = self.query_one(Editor), self.document.session
        row, column = editor.cursor_location
        found = session.kind.complete(session.reading, row + 1, column + 1)
        if not found:
            self.notify("Nothing is known to stand here.")
            return
        if len(found) == 1:
            self._take(found[0])
            return
        x, y = editor.cursor_screen_offset
        self.push_screen(CompletionScreen(found, (x, y)), self._take)

    def _take(self, chosen: Candidate | None) -> None:
        """Put a candidate in place of what was typed of it."""
        if chosen is None:
            return
        editor = self.query_one(Editor)
        row, column = editor.cursor_location
        start = end = (row, column)
        if chosen.span is not None:
            start = (chosen.span.line - 1, chosen.span.column - 1)
            end = (chosen.span.end_line - 1, chosen.span.end_column - 1)
        editor.replace(chosen.insert, start, end, maintain_selection_offset=False)
        editor.focus()

    def action_find(self) -> None:
        """Ask for what is to be found."""
        selected = self.query_one(Editor).selected_text
        words = selected if selected and "\n" not in selected else self._sought
        self.push_screen(FindScreen(words), self._find)

    def _find(self, words: str | None) -> None:
        if words:
            self._sought = words
            self.action_find_next()

    def action_find_next(self) -> None:
        """Go to the next place of what was looked for; from the last one to the first."""
        if not self._sought:
            self.action_find()
            return
        editor = self.query_one(Editor)
        text, words = editor.text.casefold(), self._sought.casefold()
        row, column = editor.cursor_location
        lines = editor.text.split("\n")
        here = sum(len(line) + 1 for line in lines[:row]) + column
        found = text.find(words, here + 1)
        found = text.find(words) if found < 0 else found
        if found < 0:
            self.notify(f"'{self._sought}' is not in the text.")
            return
        before = editor.text[:found].split("\n")
        editor.go_to(len(before), len(before[-1]) + 1)
        editor.focus()

    # ── the run ──────────────────────────────────────────────────────────────────────

    def action_run(self) -> None:
        """Run the controller, and show the run beside the text."""
        self.read_text()
        if self._run_is_made:
            return
        self._run_is_made = True
        self.notify("Running; the first run on a machine compiles for some seconds.", timeout=3)
        self.run_worker(self._run_text, thread=True, exit_on_error=False)

    def _run_text(self) -> None:
        try:
            run, plant = run_text(self.document.text, self.document.path)
        except (FuzzyarmError, OSError) as error:
            self.call_from_thread(self._run_failed, str(error))
            return
        self.call_from_thread(self._show_run, run, plant)

    def _run_failed(self, why: str) -> None:
        self._run_is_made = False
        self.notify(f"Not run: {why}", severity="warning")

    def _show_run(self, run: Run, plant: Plant) -> None:
        self._run_is_made = False
        if not run.samples:
            self.notify("The run diverged before its first sample.", severity="warning")
            return
        self.query_one("#views", Static).update(Text(" 6 run ", "reverse"))
        self.query_one(View).play(run, plant)
        worst = ", ".join(
            f"{name} {value:.4g} {unit}"
            for name, value, unit in zip(run.labels, run.rms, run.units, strict=True)
        )
        self.query_one("#point", Static).update(Text(f"RMS error: {worst}"))

    def on_view_moved(self, event: View.Moved) -> None:
        """Show the crisp inputs."""
        self._show_point()

    def on_view_jump(self, event: View.Jump) -> None:
        """Go to a position in the text."""
        self.go_to(event.span)

    def go_to(self, span: Span) -> None:
        """Put the cursor at a position and the focus on the text."""
        editor = self.query_one(Editor)
        editor.go_to(span.line, span.column)
        editor.focus()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Go to a finding."""
        self.go_to(self.document.findings[event.option_index].span)

    def action_next_finding(self) -> None:
        """Go to the first finding behind the cursor; from the last one to the first."""
        self.read_text()
        found = self.document.findings
        if not found:
            self.notify("There are no findings.")
            return
        row, column = self.query_one(Editor).cursor_location
        later = (d for d in found if (d.line, d.column) > (row + 1, column + 1))
        chosen = next(later, found[0])
        self.query_one("#findings", OptionList).highlighted = found.index(chosen)
        self.go_to(chosen.span)
        self.notify(_said(chosen), severity=_gravity(chosen))

    def on_key(self, event: events.Key) -> None:
        """Repair the chosen finding with f."""
        listed = self.query_one("#findings", OptionList)
        if event.key == "f" and listed.has_focus and listed.highlighted is not None:
            event.stop()
            self._repair(self.document.findings[listed.highlighted])

    def action_repair(self) -> None:
        """Repair the finding at the cursor."""
        self.read_text()
        row, column = self.query_one(Editor).cursor_location
        here = (row + 1, column + 1)
        on_line = [d for d in self.document.findings if d.span.line <= here[0] <= d.span.end_line]
        touched = [d for d in on_line if d.column <= here[1] <= d.span.end_column]
        for found in [*touched, *on_line]:
            if self._fix_of(found) is not None:
                self._repair(found)
                return
        self.notify("Nothing here has a certain repair.")

    def _fix_of(self, found: Diagnostic) -> Any:
        session = self.document.session
        repairs = session.kind.fixes(session.reading, found)
        certain = [fix for fix in repairs if fix.preferred]
        return certain[0] if certain else None

    def _repair(self, found: Diagnostic) -> None:
        fix = self._fix_of(found)
        if fix is None:
            self.notify("This has no certain repair: it is yours to decide.")
            return
        self.query_one(Editor).replace_all(apply_edits(self.document.text, fix.edits))
        self.read_text()
        self.notify(fix.title)

    def action_save(self) -> None:
        """Format the text and write the file; with mistakes it is written as it is."""
        self.read_text()
        if stamp_of(self.document.path) != self._stamp and self._warned_of != "disk":
            self._warned_of = "disk"
            self.notify(
                "The file has changed on disk. Ctrl+S again replaces it.", severity="warning"
            )
            return
        text = self.document.formatted()
        try:
            write_atomically(self.document.path, text)
        except OSError as error:
            self.notify(f"Not saved: {error.strerror or error}", severity="error")
            return
        if text != self.query_one(Editor).text:
            self.query_one(Editor).replace_all(text)
        self._saved, self._stamp, self._warned_of = text, stamp_of(self.document.path), ""
        self.read_text()
        mistakes = sum(d.is_error for d in self.document.findings)
        self.notify("Saved as it is, with mistakes." if mistakes else "Formatted and saved.")

    def action_leave(self) -> None:
        """Leave; with changes that are not saved only when asked twice."""
        if self.is_changed and self._warned_of != "loss":
            self._warned_of = "loss"
            self.notify("Not saved. Ctrl+S saves, Ctrl+Q again leaves without.", severity="warning")
            return
        self.exit(0)


def _said(found: Diagnostic) -> str:
    return f"{found.message} ({found.hint})" if found.hint else found.message


def _gravity(found: Diagnostic) -> Any:
    return "information" if found.severity is Severity.INFO else str(found.severity)
