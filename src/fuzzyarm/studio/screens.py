"""What opens over the studio: the keys, completion, find."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from fuzzyarm.language.queries import Candidate

KEYS = (
    ("everywhere", (
        ("F2 to F5", "surface, rules, terms, firing (of a table: map, numbers)"),
        ("F6", "run it beside the text, on the arm or its plant"),
        ("F8, F9", "next finding; repair what is certain at the cursor"),
        ("Ctrl+S, Ctrl+Q", "format and save; leave"),
        ("Tab, Shift+Tab", "text, drawing, findings"),
    )),
    ("in the text", (
        ("Ctrl+Space, F7", "what can stand here"),
        ("Ctrl+F, Ctrl+G", "find; find the next"),
        ("Ctrl+Z, Ctrl+Y", "undo; redo"),
    )),
    ("in the drawing", (
        ("← → ↑ ↓", "move the crisp inputs (with Shift: further)"),
        ("c", "put them in the middle"),
        ("x, y, o", "another input across, another upward, another output"),
        ("Enter", "go to the strongest rule in the text"),
    )),
    ("in the findings", (("Enter, f", "go there; repair it"),)),
)  # fmt: skip
"""What the keys do, by where the focus is."""


class KeysScreen(ModalScreen[None]):
    """All keys; any key closes it."""

    def compose(self) -> ComposeResult:
        """Return the one text."""
        text = Text()
        for place, keys in KEYS:
            text.append(f"{place}\n", "bold underline")
            for key, what in keys:
                text.append(f"  {key:<17}", "bold cyan")
                text.append(f"{what}\n")
        text.append("any key closes this", "dim")
        with Vertical(id="keys", classes="box"):
            yield Static(text, markup=False)

    def on_key(self) -> None:
        """Close it."""
        self.dismiss(None)

    def on_click(self) -> None:
        """Close it."""
        self.dismiss(None)


class CompletionScreen(ModalScreen[Candidate | None]):
    """What can stand at the cursor.

    Parameters
    ----------
    candidates : sequence of Candidate
        As the editor's server gives them.
    at : (int, int)
        Column and row on the screen, below which the list opens.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,left,right", "close", show=False),
        Binding("tab", "take", show=False),
    ]

    def __init__(self, candidates: Sequence[Candidate], at: tuple[int, int]) -> None:
        super().__init__()
        self.candidates, self._at = list(candidates), at

    def compose(self) -> ComposeResult:
        """Return the list."""
        width = max(len(each.label) for each in self.candidates)
        options = []
        for each in self.candidates:
            line = Text(no_wrap=True, overflow="ellipsis")
            line.append(f"{each.label:<{width}}  ", "bold")
            line.append(each.detail, "dim")
            options.append(Option(line))
        yield OptionList(*options, id="completion", classes="box")

    def on_mount(self) -> None:
        """Place the list at the cursor, inside the screen."""
        listed = self.query_one(OptionList)
        height = min(10, len(self.candidates)) + 2
        width = min(60, self.app.size.width - 2)
        column, row = self._at
        below = row + 1 + height <= self.app.size.height
        listed.styles.width, listed.styles.height = width, height
        listed.styles.offset = (
            max(0, min(column, self.app.size.width - width)),
            row + 1 if below else max(0, row - height),
        )
        listed.highlighted = 0

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Take the one that was chosen."""
        event.stop()
        self.dismiss(self.candidates[event.option_index])

    def action_take(self) -> None:
        """Take the highlighted one."""
        chosen = self.query_one(OptionList).highlighted
        self.dismiss(None if chosen is None else self.candidates[chosen])

    def action_close(self) -> None:
        """Take nothing."""
        self.dismiss(None)


class FindScreen(ModalScreen[str]):
    """Asks for what is to be found.

    Parameters
    ----------
    words : str
        What was looked for before.
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "close", show=False)]

    def __init__(self, words: str) -> None:
        super().__init__()
        self._words = words

    def compose(self) -> ComposeResult:
        """Return the line to type into."""
        yield Input(self._words, placeholder="find", id="find", classes="box")

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Look for what was typed."""
        event.stop()
        self.dismiss(event.value)

    def action_close(self) -> None:
        """Look for nothing."""
        self.dismiss("")
