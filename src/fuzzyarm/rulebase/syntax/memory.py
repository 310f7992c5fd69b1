"""What the last reading of a text found, so that the next one costs only what has changed.

An editor reads the same file again after every key stroke. Lines and statements that stand
where they stood are taken over; the result is the same with a memory and without.
"""

from __future__ import annotations

from collections.abc import Hashable

from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.limits import MAX_DIAGNOSTICS
from fuzzyarm.rulebase.model import Rule
from fuzzyarm.rulebase.syntax.lines import Group
from fuzzyarm.rulebase.syntax.nodes import StatementNode
from fuzzyarm.rulebase.syntax.tokens import Line, split_lines, tokenize_line

Found = tuple[Diagnostic, ...]


class ParseMemory:
    """The lines, statements and rules of one text as they were read last."""

    def __init__(self) -> None:
        self._lines: list[tuple[str, Line, Found]] = []
        self._statements: dict[int, tuple[Group, StatementNode, Found]] = {}
        self._fresh: dict[int, tuple[Group, StatementNode, Found]] = {}
        self._scope: Hashable = None
        self._rules: dict[int, tuple[StatementNode, list[Rule], Found]] = {}
        self._fresh_rules: dict[int, tuple[StatementNode, list[Rule], Found]] = {}

    @property
    def lines(self) -> list[Line]:
        """The lines of the last text as tokens."""
        return [line for _, line, _ in self._lines]

    def tokenize(self, text: str, diagnostics: list[Diagnostic]) -> list[Line]:
        """Return what :func:`fuzzyarm.rulebase.syntax.tokens.tokenize` returns."""
        before = self._lines
        self._lines = []
        for index, line in enumerate(split_lines(text)):
            entry = before[index] if index < len(before) else None
            if entry is None or entry[0] != line:
                found: list[Diagnostic] = []
                entry = (line, tokenize_line(index + 1, line, found), tuple(found))
            diagnostics += entry[2]
            self._lines.append(entry)
            if len(diagnostics) > MAX_DIAGNOSTICS:
                break  # this is no rule base; reading all of it would take for ever
        return self.lines

    def recall(self, group: Group) -> tuple[StatementNode, Found] | None:
        """Return the statement of `group` and its diagnostics if it was read here before."""
        known = self._statements.get(group.tokens[0].line)
        if known is None or known[0].tokens != group.tokens or known[0].lines != group.lines:
            return None
        self._fresh[group.tokens[0].line] = known
        return known[1], known[2]

    def keep(self, group: Group, node: StatementNode, found: list[Diagnostic]) -> None:
        """Remember the statement that `group` was read as."""
        self._fresh[group.tokens[0].line] = (group, node, tuple(found))

    def finish(self) -> None:
        """Forget what the text that has just been read does not have."""
        self._statements, self._fresh = self._fresh, {}

    def enter_scope(self, scope: Hashable) -> None:
        """Start to give rules their meaning under these variables and terms."""
        kept = self._fresh_rules if scope == self._scope else {}
        self._scope, self._rules, self._fresh_rules = scope, kept, {}

    def recall_rules(self, node: StatementNode) -> tuple[list[Rule], Found] | None:
        """Return the rules of a statement that was met last time under the same scope."""
        known = self._rules.get(id(node))
        if known is None or known[0] is not node:
            return None
        self._fresh_rules[id(node)] = known
        return known[1], known[2]

    def keep_rules(self, node: StatementNode, rules: list[Rule], found: list[Diagnostic]) -> None:
        """Remember what a statement means."""
        self._fresh_rules[id(node)] = (node, rules, tuple(found))
