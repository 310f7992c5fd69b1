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
"""How long a proof of one table may take before the error is only sampled."""


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
        For each table; after that nothing is known.

    Returns
    -------
    callable
        From a table and a mode of look-up to what the error nowhere exceeds: between sample
        points, at both sides of thresholds, inputs outside the levels included. None where it
        cannot be proved in exact pieces: boxes take longer than compiling may.
    """
    provers: dict[bool, Prover] = {}
    last: list[tuple[LookupTable, Stop]] = []  # the modes of a table share its time

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
    """Prove the error of a table cell by cell: yield lower levels, and what it is above the output.

    UnprovableError: it cannot be proved in exact pieces.
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
    # Over fewer inputs there are far fewer pieces; a table may have more axes all the same.
    part = part_for(rulebase, [output])
    return set(table.names) <= {variable.name for variable in part.inputs}


def _prover(table: LookupTable, rulebase: RuleBase, output: str) -> Prover:
    enough = _covers(table, rulebase, output)
    return Prover(part_for(rulebase, [output]) if enough else rulebase, output)
