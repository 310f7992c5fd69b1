"""Constraints of a tuned file: its ``expect`` and ``prove`` lines."""

from __future__ import annotations

from collections.abc import Mapping

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference import check_expectations
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.tuning.design import Candidate
from fuzzyarm.learning.tuning.movement import TuneError

PROOF_SECONDS = 2.0
"""How long one ``prove`` line may take for one candidate."""


class Promises:
    """The ``expect`` and ``prove`` lines of some rule bases.

    Parameters
    ----------
    rulebases : mapping of str to RuleBase
        As in their files.

    Raises
    ------
    TuneError
        If a file does not keep its own promises.
    """

    def __init__(self, rulebases: Mapping[str, RuleBase]) -> None:
        self.proved: dict[str, list[bool]] = {}
        for name, rulebase in rulebases.items():
            broken = self._expected(rulebase)
            if broken:
                hint = "fuzzyarm check shows it; tuning keeps what holds"
                raise TuneError(f"'{name}' breaks a promise of its own: {broken}", hint=hint)
            if rulebase.properties:
                self.proved[name] = self._proved(name, rulebase)

    def __bool__(self) -> bool:
        return True

    def _proved(self, name: str, rulebase: RuleBase) -> list[bool]:
        from fuzzyarm.proof.map import prove_all

        outcomes = []
        for verdict in prove_all(rulebase, budget=PROOF_SECONDS):
            if verdict.verdict == "refuted":
                raise TuneError(f"'{name}' breaks a promise of its own: {verdict.statement}")
            outcomes.append(bool(verdict.proved))
        return outcomes

    def expected(self, candidate: Candidate) -> str:
        """Return which ``expect`` line a candidate breaks; empty where it keeps all of them."""
        for rulebase in candidate.rulebases.values():
            broken = self._expected(rulebase)
            if broken:
                return broken
        return ""

    @staticmethod
    def _expected(rulebase: RuleBase) -> str:
        if not rulebase.expectations:
            return ""
        try:
            diagnostics = check_expectations(rulebase)
        except FuzzyarmError as error:  # no rule fires there
            return error.message
        return diagnostics[0].message if diagnostics else ""

    def proof(self, candidate: Candidate) -> str:
        """Return which ``prove`` line a candidate breaks; one that held must be proved again."""
        from fuzzyarm.proof.map import prove_all

        for name, rulebase in candidate.rulebases.items():
            outcomes = self.proved.get(name)
            if not outcomes:
                continue
            verdicts = prove_all(rulebase, budget=PROOF_SECONDS)
            for verdict, was_proved in zip(verdicts, outcomes, strict=True):
                if verdict.verdict == "refuted" or (was_proved and not verdict.proved):
                    return str(verdict.statement)
        return ""
