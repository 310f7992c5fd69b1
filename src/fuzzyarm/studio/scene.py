"""What the studio shows: a model, the crisp inputs, and a drawing of them in a few views."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING

from fuzzyarm.rulebase import Diagnostic, Span
from fuzzyarm.show.words import name_words, number_words

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.text import Text

FINE, COARSE = 60, 12
"""Steps from one end of a range to the other, with an arrow key and with shift."""


class Scene(ABC):
    """A model with crisp inputs that can be moved.

    Attributes
    ----------
    point : dict of str to float
        The crisp inputs.
    across, down : str
        The inputs that the arrow keys move; `down` is empty where there is one input.
    """

    VIEWS: tuple[str, ...] = ()

    def __init__(self) -> None:
        self.point: dict[str, float] = {}
        self.across = ""
        self.down = ""

    @property
    @abstractmethod
    def ranges(self) -> dict[str, tuple[float, float]]:
        """The inputs and the stretch that is shown of each."""

    @abstractmethod
    def draw(self, view: str, width: int, height: int) -> RenderableType:
        """Return the drawing of a view in a given room."""

    @abstractmethod
    def result(self) -> str:
        """Return what comes out at the crisp inputs, in words."""

    @abstractmethod
    def place(self) -> Span | None:
        """Return where in the text the strongest rule or the chosen cell stands."""

    @abstractmethod
    def place_at(self, view: str, x: int, y: int, line: str) -> Span | None:
        """Return the place of what is drawn at column `x` of drawn line `y`, which reads `line`."""

    def set_inputs(self, before: Mapping[str, float], across: str, down: str) -> None:
        """Take over the crisp inputs of an earlier model as far as they fit this one."""
        names = list(self.ranges)
        for name, (low, high) in self.ranges.items():
            middle = 0.5 * (low + high)
            self.point[name] = min(high, max(low, before.get(name, middle)))
        self.across = across if across in names else ""
        self.down = down if down in names and down != self.across else ""
        free = [name for name in names if name not in (self.across, self.down)]
        if not self.across and free:
            self.across = free.pop() if len(names) > 1 and not self.down else free.pop(0)
        if not self.down and free:
            self.down = free.pop(0)
        if len(names) > 2 and not across:
            self.down, self.across = names[0], names[1]

    def move(self, name: str, steps: int, *, coarse: bool = False) -> None:
        """Move a crisp input by some steps, to its ends at most."""
        if name not in self.point:
            return
        low, high = self.ranges[name]
        width = (high - low) / (COARSE if coarse else FINE)
        # Steps lie on a lattice from the lower end, so that round numbers are met again.
        place = round((self.point[name] - low) / width) + steps
        # Twelve digits are more than anybody reads, and hide the noise of the last ones.
        self.point[name] = min(high, max(low, float(f"{low + place * width:.12g}")))

    def centre(self) -> None:
        """Put every crisp input in the middle of its range."""
        for name, (low, high) in self.ranges.items():
            self.point[name] = 0.5 * (low + high)

    def turn(self, *, across: bool) -> None:
        """Let the arrow keys move the next input, across or down."""
        names = list(self.ranges)
        other = self.down if across else self.across
        mine = self.across if across else self.down
        if len(names) < 2 or not mine:
            return
        choices = [name for name in names if name != other]
        chosen = choices[(choices.index(mine) + 1) % len(choices)]
        if len(names) == 2:
            self.across, self.down = self.down, self.across
        elif across:
            self.across = chosen
        else:
            self.down = chosen

    def caption(self, *, keys: bool = True) -> Text:
        """Return the crisp inputs, with `keys` those that move them, and what comes out."""
        from rich.text import Text

        text = Text(no_wrap=False)
        for name, value in self.point.items():
            moves = "←→" if name == self.across else "↑↓" if name == self.down else ""
            text.append(f"{name_words(name)} ", "bold")
            text.append(f"{number_words(value, 4)}", "cyan")
            text.append(f" {moves}  " if moves and keys else "  ", "dim")
        text.append("→ ", "dim")
        text.append(self.result(), "bold")
        return text


def findings_text(found: tuple[Diagnostic, ...]) -> str:
    """Return how many findings there are of each gravity."""
    counts: dict[str, int] = {}
    for diagnostic in found:
        counts[str(diagnostic.severity)] = counts.get(str(diagnostic.severity), 0) + 1
    words = [f"{n} {kind}{'s' if n > 1 and kind != 'info' else ''}" for kind, n in counts.items()]
    return ", ".join(words) if words else "no findings"
