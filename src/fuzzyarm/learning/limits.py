"""How long a model may be looked for, and how large it may be."""

from __future__ import annotations

import math
import time

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
