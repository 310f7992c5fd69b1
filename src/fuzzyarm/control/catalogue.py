"""Every controller by its name.

The values here are those of the study where it prints them; the others were identified
from its figures (``fuzzyarm identify``) and say so. Where text and figures disagree a
controller exists in two variants: ``as-printed`` gives the published figures and is the
default, ``as-described`` follows the text.
"""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyarm.arm.conventions import STUDY_CONVENTIONAL, Conventions
from fuzzyarm.control.controller import Controller, Sum
from fuzzyarm.control.conventional import CONVENTIONAL
from fuzzyarm.control.entry import Choice, Entry, Start, Variant
from fuzzyarm.control.fuzzy import FUZZY
from fuzzyarm.control.sources import NONE_GIVEN, SourceError, Sources
from fuzzyarm.errors import FuzzyarmError


class UnknownControllerError(FuzzyarmError, LookupError):
    """No controller has this name; `name` is the one asked for, `near` the likely ones."""

    def __init__(self, name: str, near: list[str]) -> None:
        if near:
            hint = "did you mean " + " or ".join(f"'{each}'" for each in near) + "?"
        else:
            hint = "fuzzyarm simulate --list names all"
        super().__init__(f"no controller '{name}'", hint=hint)
        self.name = name
        self.near = near


def controller(
    name: str,
    *,
    start: Start = "warm",
    variant: Variant = "as-printed",
    sources: Sources = NONE_GIVEN,
) -> Controller:
    """Make a controller by name.

    Parameters
    ----------
    name : str
        A name of the catalogue, or several with plus signs between: their sum.
    start : {"warm", "cold"}, optional
        What adaptive controllers know at the start.
    variant : {"as-printed", "as-described"}, optional
        Which of the two, where the study's figures and text disagree.
    sources : Sources, optional
        Rule bases and tables in place of the shipped ones.

    Raises
    ------
    UnknownControllerError
        With near names.
    SourceError
        If a rule base or a table does not serve, or nothing reads it.
    """
    entries = entries_of(name)
    require_taken(name, entries, sources)
    choice = Choice(start, variant, sources)
    if len(entries) == 1:
        return entries[0].make(choice)
    return Sum([entry.make(choice) for entry in entries], "+".join(e.name for e in entries))


def require_taken(name: str, entries: Sequence[Entry], sources: Sources) -> None:
    """Raise SourceError if nothing in `entries`, which make up `name`, reads a given source."""
    for given in sources.given():
        if not any(given in entry.takes for entry in entries):
            taken = sorted({each for entry in entries for each in entry.takes})
            hint = f"it takes {', '.join(taken)}" if taken else ""
            raise SourceError(f"{name} takes no {given} from a file", hint=hint)


def entries_of(name: str) -> list[Entry]:
    """Return the entry of a name, or those of the addends of a sum.

    Raises
    ------
    UnknownControllerError
        With near names.
    """
    names = [part.strip() for part in name.split("+")]
    joined = "+".join(names)
    if joined in CATALOGUE:
        return [CATALOGUE[joined]]
    names = [ADDENDS.get(part, part) for part in names]
    for part in names:
        if part not in CATALOGUE:
            raise UnknownControllerError(part or name, near_names(part or name))
    return [CATALOGUE[part] for part in names]


def near_names(name: str) -> list[str]:
    """Return up to three names of the catalogue that look like `name`."""
    import difflib

    return difflib.get_close_matches(name.lower(), list(CATALOGUE), n=3, cutoff=0.5)


def study_conventions(name: str) -> Conventions:
    """Return how the study counted for a controller, or for the first part of a sum."""
    for part in (name, *name.split("+")):
        if part.strip() in CATALOGUE:
            return CATALOGUE[part.strip()].conventions
    return STUDY_CONVENTIONAL


ADDENDS = {"fuzzy": "fuzzy-lut"}
"""Short names in a sum, as the hybrids of the study have them (``cdid+fuzzy``)."""

CATALOGUE: dict[str, Entry] = {entry.name: entry for entry in (*CONVENTIONAL, *FUZZY)}
"""Every controller by its name."""
