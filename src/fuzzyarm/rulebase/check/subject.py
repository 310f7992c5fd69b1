"""What a check looks at."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.rulebase.model import RuleBase
from fuzzyarm.rulebase.syntax.nodes import Document, GridNode


@dataclass(frozen=True, slots=True)
class Subject:
    """A rule base and, where it came from a text, its syntax tree."""

    rulebase: RuleBase
    document: Document

    @property
    def grids(self) -> list[GridNode]:
        """The rule grids of the file."""
        nodes = (statement.node for statement in self.document.statements)
        return [node for node in nodes if isinstance(node, GridNode)]
