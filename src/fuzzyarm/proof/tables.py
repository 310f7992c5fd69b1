"""Proved worst errors of lookup tables, for the compiler and for exported programs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.inference.plan import part_for
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.proof.arithmetic import Stop
from fuzzyarm.proof.prover import Prover

if TYPE_CHECKING:
    from fuzzyarm.table import LookupTable

__all__ = ["table_proof"]

SECONDS = 10.0
"""How long a proof of one table may take before the error is only sampled."""


def table_proof(
    rulebase: RuleBase, output: str, *, seconds: float = SECONDS
) -> Callable[[LookupTable, str], float | None]:
    """Return what proves the worst error of tables of one output.

    Parameters
    ----------
    rulebase : RuleBase
        What the tables stand for.
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

    def prover_for(table: LookupTable) -> Prover:
        # Over fewer inputs there are far fewer pieces; a table may have more axes all the same.
        part = part_for(rulebase, [output])
        enough = set(table.names) <= {each.name for each in part.inputs}
        if enough not in provers:
            provers[enough] = Prover(part if enough else rulebase, output)
        return provers[enough]

    def prove(table: LookupTable, mode: str) -> float | None:
        try:
            prover = prover_for(table)
            if prover.model is None:
                return None
            prover.stop = Stop(seconds)
            bounds = prover.table(table, mode)
        except FuzzyarmError:
            return None
        return max(bounds.high, -bounds.low) if bounds.complete else None

    return prove
