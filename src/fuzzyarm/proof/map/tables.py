"""Proved worst errors of lookup tables, for the compiler and for exported programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import TYPE_CHECKING

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference.plan import part_for
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map.bounds import Bounds
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.stop import Stop

if TYPE_CHECKING:
    from fuzzyarm.table import LookupTable

SECONDS = 10.0
"""Time budget for the proof of one table; then the error is only sampled."""


def table_proof(
    rulebase: RuleBase, output: str, *, seconds: float = SECONDS
) -> Callable[[LookupTable, str], float | None]:
    """Return the function that proves the worst error of tables of one output.

    Parameters
    ----------
    rulebase : RuleBase
        The rule base that the tables replace.
    output : str
        The output.
    seconds : float
        Time budget for each table.

    Returns
    -------
    callable
        From a table and a mode of look-up to an upper bound of the error: between sample points, on
        both sides of thresholds, and for inputs outside the levels. None without a proof in exact
        pieces: boxes take longer than a compilation may.
    """
    provers: dict[bool, Prover] = {}
    last: list[tuple[LookupTable, Stop]] = []  # the modes of a table share its budget

    def stop_for(table: LookupTable) -> Stop:
        if not last or last[0][0] is not table:
            last[:] = [(table, Stop(seconds))]
        return last[0][1]

    def prover_for(table: LookupTable) -> Prover:
        enough = _covers(table, rulebase, output)
        if enough not in provers:
            provers[enough] = _prover(table, rulebase, output)
        return provers[enough]

    def prove(table: LookupTable, mode: str) -> float | None:
        try:
            prover = prover_for(table)
            if prover.model is None:
                return None
            prover.stop = stop_for(table)
            bounds = prover.table(table, mode)
        except FuzzyarmError:
            return None
        return max(bounds.high, -bounds.low) if bounds.complete else None

    return prove


def cell_errors(
    table: LookupTable, rulebase: RuleBase, mode: str, stop: Stop | None = None
) -> Iterator[tuple[tuple[int, ...], Bounds]]:
    """Yield the error of a table by cell: indices of lower levels, bounds of table minus output.

    UnprovableError: no proof in exact pieces.
    """
    prover = _prover(table, rulebase, table.output)
    prover.demand_pieces("the error in each cell")
    prover.stop = stop or prover.stop
    for cell in product(*(range(len(axis.levels) - 1) for axis in table.axes)):
        region = {
            axis.name: (axis.levels[k], axis.levels[k + 1])
            for axis, k in zip(table.axes, cell, strict=True)
        }
        yield cell, prover.table(table, mode, region)


def _covers(table: LookupTable, rulebase: RuleBase, output: str) -> bool:
    # Fewer inputs have far fewer pieces; a table may have more axes than that.
    part = part_for(rulebase, [output])
    return set(table.names) <= {variable.name for variable in part.inputs}


def _prover(table: LookupTable, rulebase: RuleBase, output: str) -> Prover:
    enough = _covers(table, rulebase, output)
    return Prover(part_for(rulebase, [output]) if enough else rulebase, output)
