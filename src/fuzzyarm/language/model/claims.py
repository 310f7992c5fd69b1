"""A claim about a controller in its loop: ``prove stable on PLANT``, ``prove on PLANT from …``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from fuzzyarm.base.diagnostic import NOWHERE, Span

Stretch = tuple[str, float, float]
"""A name and an interval."""

When = Literal["always", "during", "after"]
"""The time in which a claim must hold."""


@dataclass(frozen=True, slots=True)
class LoopClaim:
    """A claim about a closed loop.

    Parameters
    ----------
    plant : str
        A shipped plant, or a user's in the notation of commands.
    stable : bool
        That the loop converges to rest from every start.
    at : tuple of (str, float)
        Constant set points, by port; 0 for others.
    parameters, start : tuple of Stretch
        Parameters and initial states of the plant; the others have their defaults.
    output : str
        Output of the plant claimed to stay between `low` and `high`; empty for no such claim.
    when : str
        ``always``; ``during`` from `begin` to `end`; ``after`` `begin`, s.
    low, high : float
        The bounds of the output.
    begin, end : float
        When it does, s; infinite for ever.
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
