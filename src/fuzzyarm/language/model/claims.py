"""A claim about a controller in its loop: ``prove stable on PLANT``, ``prove on PLANT from …``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, Span

Stretch = tuple[str, float, float]
"""A name and an interval."""

When = Literal["always", "during", "after"]
"""The time in which a claim must hold."""


class FollowedReference(NamedTuple):
    """A reference that moves.

    Attributes
    ----------
    port : str
        Output of the plant.
    kind : str
        ``step``, ``ramp``, ``sine`` or ``quintic``.
    numbers : tuple of float
        In the order of ``simulate --reference``, times in s: TO, AT, FROM of a step; RATE, AT, FROM
        of a ramp; AMPLITUDE, HERTZ, OFFSET of a sine; TO, SECONDS, FROM of a quintic move, then TO
        and SECONDS of each further one.
    """

    port: str
    kind: str
    numbers: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class LoopClaim:
    """A claim about a closed loop.

    Parameters
    ----------
    plant : str
        A shipped plant, or a user's in the notation of commands.
    stable : bool
        Whether the loop is claimed to converge to rest from every start.
    at : tuple of (str, float)
        Constant set points, by port; 0 for others.
    parameters, start : tuple of Stretch
        Parameters and initial states of the plant; the others have their defaults.
    follows : tuple of FollowedReference
        References that move, by port.
    output : str
        Output of the plant claimed to stay between `low` and `high`; empty for no such claim.
    error : bool
        Whether the claim is about its error, reference less output.
    when : str
        ``always``; ``during`` from `begin` to `end`; ``after`` `begin`, s.
    low, high : float
        The bounds of the output.
    begin, end : float
        Start and end of the bounds, s; infinite for ever.
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
    follows: tuple[FollowedReference, ...] = ()
    error: bool = False

    @property
    def subject(self) -> str:
        """The quantity claimed to stay between `low` and `high`."""
        return f"error of {self.output}" if self.error else self.output


def reference_fault(claim: LoopClaim) -> tuple[str, str]:
    """Return the contradiction in a claim's references, and a hint; empty texts for none."""
    if not claim.follows:
        return "", ""
    ports = [*(name for name, _ in claim.at), *(each.port for each in claim.follows)]
    twice = next((each.port for each in claim.follows if ports.count(each.port) > 1), None)
    if twice is not None:
        return f"'{twice}' has two references", "one after 'at' or 'while'"
    if claim.stable:
        hint = "as in  prove on motor while position follows ...: position in -0.1 .. 1.1"
        return "a loop is stable at rest, not while a reference moves", hint
    kind = next((each.kind for each in claim.follows if each.kind in ("ramp", "sine")), None)
    if kind and claim.end == float("inf"):
        return f"a {kind} never comes to rest: the claim needs an end", "as in  during 0 .. 4 s"
    return "", ""
