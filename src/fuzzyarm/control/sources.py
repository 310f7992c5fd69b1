"""The files that fuzzy controllers take their rules and tables from."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.shipped_files import shipped

if TYPE_CHECKING:
    from fuzzyarm.lut import LookupTable
    from fuzzyarm.rulebase import RuleBase


class SourceError(FuzzyarmError, ValueError):
    """A rule base or a table does not serve a controller."""

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message, hint=hint)


@dataclass(frozen=True)
class Sources:
    """Rule bases and tables to use in place of the shipped ones.

    Parameters
    ----------
    rulebase : RuleBase, optional
        Of the control, over e and ce.
    alpha : RuleBase, optional
        Of the factor on the control, over e and ce.
    table : LookupTable, optional
        Of the control, over e and ce; with a third input ``joint`` one for each joint.
        SOC starts from it.
    performance : LookupTable, optional
        By which SOC judges.
    """

    rulebase: RuleBase | None = None
    alpha: RuleBase | None = None
    table: LookupTable | None = None
    performance: LookupTable | None = None

    def given(self) -> tuple[str, ...]:
        """Return the names of those that are given."""
        return tuple(each.name for each in fields(self) if getattr(self, each.name) is not None)


NONE_GIVEN = Sources()
"""Everything as shipped."""


def shipped_rulebase(name: str) -> RuleBase:
    """Return a shipped rule base."""
    path = shipped(name)
    return _rulebase(path, path.stat().st_mtime_ns)


def shipped_table(name: str) -> LookupTable:
    """Return a shipped table."""
    path = shipped(name)
    return _table(path, path.stat().st_mtime_ns)


# Keyed by the time of the last change, so that an edited file counts in a long process.
@lru_cache(maxsize=16)
def _rulebase(path: Path, _changed: int) -> RuleBase:
    from fuzzyarm.rulebase import load_rulebase

    return load_rulebase(path)


@lru_cache(maxsize=16)
def _table(path: Path, _changed: int) -> LookupTable:
    from fuzzyarm.lut import read_table

    return read_table(path)
