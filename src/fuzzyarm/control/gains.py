"""Gains as data: name, value, unit, meaning, and where the value comes from."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from fuzzyarm.errors import FuzzyarmError

Origin = Literal["printed", "identified", "own", "given"]


class GainError(FuzzyarmError, ValueError):
    """A gain is unknown or its value is out of sense; `name` and `value` say which."""

    def __init__(self, message: str, *, name: str, value: object = None, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name
        self.value = value


@dataclass(frozen=True)
class Gain:
    """One gain of a control law.

    Parameters
    ----------
    name : str
        As ``--set`` takes it.
    value : tuple of float
        One number, or one for each joint, or one for each parameter.
    unit : str
        SI; "1" for none.
    meaning : str
        What it multiplies.
    origin : {"printed", "identified", "own", "given"}
        Printed in the study, identified from its figures, chosen here, or given by
        the user.
    positive : bool, optional
        Whether zero and below are out of sense.
    """

    name: str
    value: tuple[float, ...]
    unit: str
    meaning: str
    origin: Origin = "printed"
    positive: bool = False

    def with_value(self, value: Sequence[float], origin: Origin = "given") -> Gain:
        """Return the gain with another value; a single number goes for all places.

        Raises
        ------
        GainError
            If the count does not fit or a number is out of sense.
        """
        values = tuple(float(each) for each in value)
        if len(values) == 1:
            values *= len(self.value)
        if len(values) != len(self.value):
            raise GainError(
                f"gain {self.name} takes 1 or {len(self.value)} numbers, not {len(values)}",
                name=self.name,
                value=value,
            )
        for each in values:
            if not math.isfinite(each) or abs(each) > 1e12 or (self.positive and each <= 0):
                wanted = "a positive number" if self.positive else "a finite number"
                raise GainError(
                    f"gain {self.name} = {each} is out of sense",
                    name=self.name,
                    value=each,
                    hint=f"{wanted} below 1e12",
                )
        return replace(self, value=values, origin=origin)


Gains = Mapping[str, Gain]


def collect(gains: Iterable[Gain]) -> dict[str, Gain]:
    """Index gains by name, in order."""
    return {gain.name: gain for gain in gains}
