"""What can be wrong with an experiment on the arm."""

from __future__ import annotations

from fuzzyarm.errors import FuzzyarmError


class ArmError(FuzzyarmError, ValueError):
    """An angle, a time, a schedule or a parameter is out of sense.

    Parameters
    ----------
    message : str
        One sentence with the offending value in it.
    name : str, optional
        The quantity at fault.
    value : object, optional
        What was given for it.
    hint : str, optional
        What would be right.
    """

    def __init__(
        self, message: str, *, name: str = "", value: object = None, hint: str = ""
    ) -> None:
        super().__init__(message, hint=hint)
        self.name = name
        self.value = value
