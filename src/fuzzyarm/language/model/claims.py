"""A claim about a controller in its loop: ``prove stable on PLANT``, ``prove on PLANT from …``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from fuzzyarm.base.diagnostic import NOWHERE, Span

__all__ = ["LoopClaim", "Stretch", "When"]

Stretch = tuple[str, float, float]
"""A name and an interval."""

When = Literal["always", "during", "after"]
"""In what time a claim is to hold."""


@dataclass(frozen=True, slots=True)
class LoopClaim:
    """What is claimed of a closed loop.

    Parameters
    ----------
    plant : str
        A shipped plant, or a user's as a command takes it.
    stable : bool
        That the loop goes to rest from wherever it starts.
    at : tuple of (str, float)
        Constant set points, by port; 0 for others.
    parameters, start : tuple of Stretch
        Of the plant: its parameters and its states at the start; others are as the plant has them.
    output : str
        Of the plant, which is claimed to stay between `low` and `high`; empty for no such claim.
    when : str
        ``always``; ``during`` from `begin` to `end`; ``after`` `begin`, s.
    """

    plant: str
    stable: bool = False
    at: tuple[tuple[str, float], ...] = ()
    parameters: tuple[Stretch, ...] = ()
    start: tuple[Stretch, ...] = ()
    output: str = ""
    low: float = 0.0
    high: float = 0.0
    when: When = "always"
    begin: float = 0.0
    end: float = float("inf")
    span: Span = field(default=NOWHERE, compare=False, repr=False)
