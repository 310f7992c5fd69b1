"""Where a name is declared and used, and giving it another name everywhere."""

from __future__ import annotations

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.language.edit.fixes import Edit
from fuzzyarm.language.edit.lines import realigned
from fuzzyarm.language.edit.reading import Reading, contains
from fuzzyarm.language.phrases import NameKind, Occurrence
from fuzzyarm.language.tokens import name_text

# --- Declarations and uses of a name ---


def occurrence_at(reading: Reading, line: int, column: int) -> Occurrence | None:
    """Return the name at a cursor, or None."""
    touched = [o for o in reading.occurrences if contains(o.span, line, column)]
    return touched[-1] if touched else None


def references(reading: Reading, occurrence: Occurrence) -> list[Occurrence]:
    """Return every occurrence that names the same thing as `occurrence`, in order."""
    return [o for o in reading.occurrences if _same(o, occurrence)]


def _same(one: Occurrence, other: Occurrence) -> bool:
    if one.kind is not other.kind or one.name != other.name:
        return False
    return one.kind is not NameKind.TERM or not set(one.owners).isdisjoint(other.owners)


def family(reading: Reading, occurrence: Occurrence) -> list[Occurrence]:
    """Return every occurrence that must change if the name at `occurrence` does.

    A line that declares a term of several variables ties their terms together.
    """
    owners = set(occurrence.owners)
    while True:
        occurrences = [
            o
            for o in reading.occurrences
            if o.kind is occurrence.kind
            and o.name == occurrence.name
            and (o.kind is not NameKind.TERM or not owners.isdisjoint(o.owners))
        ]
        wider = owners.union(*(o.owners for o in occurrences)) if occurrences else owners
        if wider == owners:
            return occurrences
        owners = wider


# --- Give a variable, a term or a block another name, everywhere ---


class RenameError(FuzzyarmError, ValueError):
    """A name that cannot be given, or a position without a name."""


def rename(reading: Reading, line: int, column: int, new_name: str) -> list[Edit]:
    """Return the edits that rename the object at a position to `new_name`.

    Parameters
    ----------
    reading : Reading
        The text.
    line, column : int
        A position on the old name.
    new_name : str
        With or without single quotes; the edits have quotes where the language needs them.

    Raises
    ------
    RenameError
        If there is no name, or the new one is empty or taken.
    """
    occurrence = occurrence_at(reading, line, column)
    if occurrence is None:
        raise RenameError("no variable, term or block at this position")
    name = _bare(new_name)
    if not name.strip():
        raise RenameError("the new name is empty")
    occurrences = family(reading, occurrence)
    _refuse_taken(reading, occurrence, occurrences, name)
    edits = [Edit(mention.span, _written(mention, name, reading)) for mention in occurrences]
    return realigned(reading, edits)


def _bare(name: str) -> str:
    name = name.strip()
    quoted = len(name) >= 2 and name[0] == name[-1] == "'"
    return name[1:-1] if quoted else name


def _refuse_taken(
    reading: Reading, occurrence: Occurrence, occurrences: list[Occurrence], name: str
) -> None:
    if name == occurrence.name:
        return
    owners = {owner for mention in occurrences for owner in mention.owners}
    for other in reading.occurrences:
        if other.kind is not occurrence.kind or other.name != name or not other.is_definition:
            continue
        if other.kind is not NameKind.TERM:
            raise RenameError(
                f"a {other.kind} is called '{name}' already, on line {other.span.line}"
            )
        shared = sorted(owners & set(other.owners))
        if shared:
            raise RenameError(
                f"'{shared[0]}' has a term '{name}' already, on line {other.span.line}"
            )


def _written(occurrence: Occurrence, name: str, reading: Reading) -> str:
    # Inside a formula, which is itself a quoted text, only unusual names have quotes.
    line = reading.raw_line(occurrence.span.line)
    inside_formula = any(
        token.kind == "string" and token.column < occurrence.span.column < token.end
        for token in reading.tokens_of(occurrence.span.line)
    )
    if inside_formula and line:
        return name if name.isidentifier() else f"'{name}'"
    return name_text(name)
