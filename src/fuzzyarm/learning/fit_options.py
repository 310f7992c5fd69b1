"""Options and limits of fitting a model."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from fuzzyarm.base.keywords import demand_arguments


@dataclass(frozen=True)
class Options:
    """Options of the search for a model.

    Attributes
    ----------
    method : str
        ``sugeno`` or ``wang-mendel``.
    start : str
        Start of a Sugeno model: ``grid``, ``fcm`` or ``subtractive``.
    rules : int
        Largest number of rules of a Sugeno model.
    terms : tuple of int or None
        Terms of each input of a grid; None: chosen by cross-validation.
    words : tuple of int
        The fewest and the most words of Wang and Mendel; cross-validation chooses.
    shrinkage : float or None
        Of consequents towards the linear model; None: by cross-validation.
    move : bool or None
        Whether the terms are moved by variable projection; None: if cross-validation favours it.
    merge : float
        Similarity from which gaussians of clusters are merged, see
        :func:`~fuzzyarm.learning.starts.merged`.
    series : bool
        Whether the samples are in the order of time.
    parts : int
        Number of parts of the cross-validation.
    digits : int
        Digits of the numbers of terms; more if rounding matters.
    outside : str
        ``extend``, ``clamp`` or ``error``: treatment of inputs outside the ranges by a Sugeno
        model.
    evaluations : int
        Largest number of evaluations of the model while terms move.
    seed : int
        Seed of all random numbers.
    nested : bool or None
        Whether the whole way is judged by a cross-validation around it; None: up to 1000 samples,
        if there is a choice of structures.
    seconds : float
        Wall time, at most; the best until then is taken.
    name, description : str
        Name and description of the rule base.
    """

    method: str = "sugeno"
    start: str = "grid"
    rules: int = 16
    terms: tuple[int, ...] | None = None
    words: tuple[int, int] = (7, 7)
    shrinkage: float | None = None
    move: bool | None = None
    merge: float = 0.7
    series: bool = False
    parts: int = 5
    digits: int = 4
    outside: str = "extend"
    evaluations: int = 80
    seed: int = 0
    nested: bool | None = None
    seconds: float = math.inf
    name: str = "model"
    description: str = ""

    def __post_init__(self) -> None:
        demand_arguments("Options", vars(self), type(self))


# --- Limits ---

MOST_COEFFICIENTS = 2000
"""Largest number of coefficients of an output over all rules: one least-squares problem, with
memory quadratic and time cubic in it."""


class TimeIsUpError(KeyboardInterrupt):
    """The time is up; a search ends as with Ctrl-C, and keeps its results."""


class Deadline:
    """A deadline for long work.

    Parameters
    ----------
    seconds : float
        From now on.

    Attributes
    ----------
    up : bool
        Whether it has ended something.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self.begin, self.seconds = time.monotonic(), seconds
        self.end = math.inf
        self.up = False

    def run_until(self, share: float) -> None:
        """End work at a fraction of the time; until then, nothing is ended."""
        self.end = self.begin + share * self.seconds

    def begin_to_end(self, share: float) -> None:
        """Do the same, unless something has been ended already."""
        if self.end == math.inf:
            self.run_until(share)

    def check(self) -> None:
        """Raise TimeIsUpError when the time is over."""
        if time.monotonic() > self.end:
            self.up = True
            raise TimeIsUpError
