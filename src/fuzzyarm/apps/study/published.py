"""The published figures, as data.

One line of ``published.csv`` is one controller on one trajectory: the root mean square
error and the last figure of each link, degrees. The last figure is the final error,
on ``pick-and-place`` the maximum.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.names import did_you_mean, several_nearest
from fuzzyarm.plant.setting import (
    STUDY_CONVENTIONAL,
    STUDY_DIRECT,
    STUDY_TABLES,
    Conventions,
)

MAXIMUM_ON = "pick-and-place"
"""On this trajectory the last figure of a link is its maximum."""

Eight = tuple[float, float, float, float, float, float, float, float]
"""RMS and last figure of links 1 and 2 on the first trajectory, then on the second."""

RMS_PLACES = (0, 2, 4, 6)
"""Indices of the RMS figures among the eight."""

COUNTED = {
    "conventional": STUDY_CONVENTIONAL,
    "tables": STUDY_TABLES,
    "direct": STUDY_DIRECT,
}
"""Numerical conventions of the study, by their word in the file."""

MISPRINTS = {"7.1.1/hfie": (0, 0.0831)}
"""Rows with a misprint: the index of the figure, and its correct value.

0.0381 is 0.0831 with two digits swapped: the final error and the seven other figures
come out only with it.
"""


class UnknownRowError(FuzzyarmError, LookupError):
    """A name without a published row; `name`."""

    def __init__(self, name: str, near: list[str]) -> None:
        hint = did_you_mean(*near) if near else "fuzzyarm reproduce --list names all"
        super().__init__(f"no published row '{name}'", hint=hint)
        self.name = name
        self.near = near


@json_properties("identifier row condition")
@dataclass(frozen=True)
class PublishedRow:
    """One row of a published table.

    Attributes
    ----------
    row : str
        Label of the controller in the table.
    table : str
        Number of the table.
    controller : str
        Name in the catalogue of controllers.
    start : str
        ``warm``, ``cold`` or empty.
    model_mass : float or None
        Mass of both links in a controller's deliberately wrong model, kg.
    payload : bool
        Whether the load was carried.
    conventions : Conventions
        How the study counted in this row, as its figures prove.
    trajectories : tuple of str
        First and second.
    figures : tuple of float
        The eight numbers, degrees.
    """

    row: str
    table: str
    controller: str
    start: str
    model_mass: float | None
    payload: bool
    conventions: Conventions
    trajectories: tuple[str, str]
    figures: Eight

    @property
    def identifier(self) -> str:
        """Table and controller; no two rows share it."""
        return f"{self.table}/{self.controller}"

    @property
    def corrected(self) -> Eight:
        """The figures with their misprint corrected."""
        place, value = MISPRINTS.get(self.identifier, (0, self.figures[0]))
        figures = list(self.figures)
        figures[place] = value
        return tuple(figures)  # type: ignore[return-value]

    @property
    def condition(self) -> str:
        """Distinction from other rows of the same controller, in words."""
        parts = ["payload" if self.payload else "no payload"]
        if self.model_mass is not None:
            parts.append(f"model masses {self.model_mass:g} kg")
        if self.start:
            parts.append(f"{self.start} start")
        return ", ".join(parts)


@cache
def published_rows() -> tuple[PublishedRow, ...]:
    """Read every row, in the order of the tables."""
    text = files("fuzzyarm.apps.study").joinpath("published.csv").read_text(encoding="utf-8")
    lines = list(csv.DictReader(text.splitlines()))
    return tuple(_row(*pair) for pair in zip(lines[::2], lines[1::2], strict=True))


def _row(first: dict[str, str], second: dict[str, str]) -> PublishedRow:
    numbers = [
        float(line[column])
        for line in (first, second)
        for column in ("rms_1", "last_1", "rms_2", "last_2")
    ]
    return PublishedRow(
        row=first["row"],
        table=first["table"],
        controller=first["controller"],
        start=first["start"],
        model_mass=float(first["model_mass_kg"]) if first["model_mass_kg"] else None,
        payload=first["payload"] == "yes",
        conventions=COUNTED[first["counted"]],
        trajectories=(first["trajectory"], second["trajectory"]),
        figures=tuple(numbers),  # type: ignore[arg-type]
    )


def find_rows(names: list[str]) -> list[PublishedRow]:
    """Return the rows with these names, in the order of the tables.

    A name is a table (``7.1.1``), a controller (``cdid+ie``), a label (``CDID+IE``) or
    both of the first (``7.1.1/cdid+ie``); case does not matter. No names: every row.

    Parameters
    ----------
    names : list of str
        Any of these; may be empty.

    Raises
    ------
    UnknownRowError
        With near names.
    """
    rows = published_rows()
    if not names:
        return list(rows)
    identifiers = set()
    for name in names:
        hits = {row.identifier for row in rows if name.lower() in _names(row)}
        if not hits:
            aliases = dict.fromkeys(alias for row in rows for alias in sorted(_names(row)))
            raise UnknownRowError(name, several_nearest(name, aliases))
        identifiers |= hits
    return [row for row in rows if row.identifier in identifiers]


def _names(row: PublishedRow) -> set[str]:
    label = row.row.lower()
    return {row.identifier, row.table, row.controller, label, f"{row.table}/{label}"}
