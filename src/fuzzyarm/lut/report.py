"""Compile and say how good the table is; or find the smallest table that is good enough."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from fuzzyarm.lut.compiler import DEFAULT_LEVELS, Levels, compile_table
from fuzzyarm.lut.fidelity import Fidelity, measure_fidelity
from fuzzyarm.lut.table import LookupTable
from fuzzyarm.lut.tolerance import smallest_even_grid
from fuzzyarm.rulebase.model import RuleBase


@dataclass(frozen=True, slots=True)
class CompileReport:
    """A compiled table and what is known of its quality.

    Attributes
    ----------
    table : LookupTable
        With the differences in its provenance.
    fidelities : tuple of Fidelity
        The difference to direct inference, one for each lookup mode that was tried.
    default_levels : bool
        Whether an input got the 13 even levels because nothing else was said.
    tolerance : float or None
        What the table was asked to meet.
    """

    table: LookupTable
    fidelities: tuple[Fidelity, ...]
    default_levels: bool = False
    tolerance: float | None = None


def compile_with_report(
    rulebase: RuleBase,
    output: str | None = None,
    *,
    levels: Levels | Mapping[str, Levels] | None = None,
    rounding: float | None = None,
    mode: str | None = None,
    tolerance: float | None = None,
    source: str | Path | None = None,
    date: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> CompileReport:
    """Compile a table and measure it against direct inference.

    Parameters
    ----------
    tolerance : float, optional
        Instead of `levels`: find the smallest even grid, equally many levels for every
        input, whose linear interpolation differs nowhere on a dense grid by more than this.
        The levels, bins and rounding of the file are then not used.
    progress : callable, optional
        Called with a word on what is going on.
    rulebase, output, levels, rounding, mode, source, date
        As for :func:`fuzzyarm.lut.compile_table`.

    Returns
    -------
    CompileReport
        The table and its differences.

    Raises
    ------
    TableError
        As `compile_table`; also if no grid within the limits meets the tolerance.
    """
    if tolerance is not None:
        count = smallest_even_grid(rulebase, output, tolerance, progress=progress)
        levels, rounding, mode = count, 0.0, "linear"
    table = compile_table(
        rulebase,
        output,
        levels=levels,
        rounding=rounding,
        mode=mode,
        source=source,
        date=date,
    )
    fidelities = measure_fidelity(table, rulebase)
    provenance = dict(table.provenance)
    if tolerance is not None:
        provenance["sampled"] = f"at the fewest even levels within {tolerance:g} (linear)"
    for fidelity in fidelities:
        provenance[f"error-{fidelity.mode}"] = str(fidelity)
    asked = {axis.variable for axis in rulebase.lookup.axes} if rulebase.lookup else set()
    given = set(levels) if isinstance(levels, Mapping) else set(table.names if levels else ())
    return CompileReport(
        table.with_values(table.values, provenance),
        fidelities,
        default_levels=bool(set(table.names) - asked - given),
        tolerance=tolerance,
    )


__all__ = ["DEFAULT_LEVELS", "CompileReport", "compile_with_report"]
