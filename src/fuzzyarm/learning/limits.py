"""How long a model may be looked for, and how large it may be."""

from __future__ import annotations

import math
import time

MOST_COEFFICIENTS = 2000
"""Of the conclusions of all rules on one output: one least-squares problem, whose matrix grows
with the square of it, and its time with the cube."""


class TimeIsUpError(KeyboardInterrupt):
    """The time is spent; a search ends as with Ctrl-C, and keeps what it has."""


class Deadline:
    """Says when it is time to end.

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
        """Let it end what takes longer than a share of the time; before, nothing is ended."""
        self.end = self.begin + share * self.seconds

    def begin_to_end(self, share: float) -> None:
        """Do the same, where nothing is ended yet."""
        if self.end == math.inf:
            self.run_until(share)

    def check(self) -> None:
        """Raise TimeIsUpError when the time is over."""
        if time.monotonic() > self.end:
            self.up = True
            raise TimeIsUpError
