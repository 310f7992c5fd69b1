"""Where a name is declared and where it is used."""

from __future__ import annotations

from fuzzyarm.rulebase.queries.occurrences import Kind, Occurrence
from fuzzyarm.rulebase.queries.reading import Reading, contains


def occurrence_at(reading: Reading, line: int, column: int) -> Occurrence | None:
    """Return the name that a cursor touches, or None."""
    touched = [o for o in reading.occurrences if contains(o.span, line, column)]
    return touched[-1] if touched else None


def definitions(reading: Reading, occurrence: Occurrence) -> list[Occurrence]:
    """Return where the thing that `occurrence` names is declared; several if the file does."""
    return [o for o in references(reading, occurrence) if o.is_definition]


def references(reading: Reading, occurrence: Occurrence) -> list[Occurrence]:
    """Return every place that names the same thing as `occurrence`, in order."""
    return [o for o in reading.occurrences if _same(o, occurrence)]


def _same(one: Occurrence, other: Occurrence) -> bool:
    if one.kind is not other.kind or one.name != other.name:
        return False
    return one.kind is not Kind.TERM or not set(one.owners).isdisjoint(other.owners)


def family(reading: Reading, occurrence: Occurrence) -> list[Occurrence]:
    """Return every place that must change if the name at `occurrence` does.

    A line that declares a term of several variables ties their terms together.
    """
    owners = set(occurrence.owners)
    while True:
        found = [
            o
            for o in reading.occurrences
            if o.kind is occurrence.kind
            and o.name == occurrence.name
            and (o.kind is not Kind.TERM or not owners.isdisjoint(o.owners))
        ]
        wider = owners.union(*(o.owners for o in found)) if found else owners
        if wider == owners:
            return found
        owners = wider
