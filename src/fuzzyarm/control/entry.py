"""What an entry of the catalogue is, and what its maker is asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from fuzzyarm.arm.conventions import STUDY_CONVENTIONAL, Conventions
from fuzzyarm.control.controller import CompiledController, Controller
from fuzzyarm.control.gains import Origin
from fuzzyarm.control.law import Law
from fuzzyarm.control.sources import Sources

Start = Literal["warm", "cold"]
Variant = Literal["as-printed", "as-described"]


@dataclass(frozen=True)
class Choice:
    """Which of the controllers of one name.

    Parameters
    ----------
    start : {"warm", "cold"}, optional
        What adaptive controllers know at the start.
    variant : {"as-printed", "as-described"}, optional
        By the study's figures or by its text, where they disagree.
    sources : Sources, optional
        Rule bases and tables in place of the shipped ones.
    """

    start: Start = "warm"
    variant: Variant = "as-printed"
    sources: Sources = field(default_factory=Sources)

    @property
    def described(self) -> bool:
        """Whether the text is followed."""
        return self.variant == "as-described"


Maker = Callable[[Choice], Controller]


@dataclass(frozen=True)
class Entry:
    """One controller of the catalogue.

    Parameters
    ----------
    name : str
        As commands take it.
    summary : str
        One line.
    make : callable
        From a choice to the controller.
    conventions : Conventions
        How the study counted where it used this controller.
    adaptive : bool
        Whether warm and cold start differ.
    takes : tuple of str
        Which of the :class:`Sources` it reads.
    """

    name: str
    summary: str
    make: Maker
    conventions: Conventions = STUDY_CONVENTIONAL
    adaptive: bool = False
    takes: tuple[str, ...] = ()


def changed(law: Law, values: dict[str, float], origin: Origin = "printed") -> CompiledController:
    """Make the controller of a law with some gains set."""
    made = CompiledController(law)
    return made.with_origin(
        **{name: made.gains[name].with_value([value], origin) for name, value in values.items()}
    )
