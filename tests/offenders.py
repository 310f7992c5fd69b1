"""One test about many things: it goes through all of them and names every one that fails."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable
from typing import TypeVar

Thing = TypeVar("Thing")


def check_all(
    things: Iterable[Thing], check: Callable[[Thing], object], name: Callable[[Thing], str] = str
) -> None:
    """Run a check of each of the things; fail with the names and the reasons of all that fail.

    An empty row of things fails, too: a test that looks at nothing holds nothing.
    """
    count, offenders = 0, []
    for thing in things:
        count += 1
        try:
            check(thing)
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            reason = str(error) or f"{type(error).__name__} in {place.line!r}"
            offenders.append(f"{name(thing)}: {reason}")
    assert count, "nothing to look at"
    assert not offenders, f"{len(offenders)} of {count}:\n" + "\n".join(offenders)
