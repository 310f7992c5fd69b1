"""What is known while a file is given its meaning: variables, their terms, findings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from fuzzyarm.rulebase.diagnostic import Diagnostic, Related, Severity, Span
from fuzzyarm.rulebase.limits import MAX_DIAGNOSTICS
from fuzzyarm.rulebase.model import Defuzzifier, Term
from fuzzyarm.rulebase.near import near_hint
from fuzzyarm.rulebase.printing.words import name_text
from fuzzyarm.rulebase.syntax.nodes import VariableNode, Word

_MOST_HINTS = 200
"""Findings beyond these are told without a guess at what was meant."""


@dataclass(slots=True)
class Draft:
    """A variable under construction."""

    node: VariableNode
    terms: dict[str, Term] = field(default_factory=dict)
    spread: set[str] = field(default_factory=set)
    outside: str = "clamp"
    aggregation: str = "max"
    defuzzifier: Defuzzifier = field(default_factory=Defuzzifier)
    no_rule: float | str = "error"

    @property
    def name(self) -> str:
        """Name of the variable."""
        return self.node.name.text

    @property
    def is_input(self) -> bool:
        """Whether it is an input."""
        return self.node.role == "input"


@dataclass(slots=True)
class Scope:
    """The variables of a file by name, and the findings so far."""

    drafts: dict[str, Draft] = field(default_factory=dict)
    diagnostics: list[Diagnostic] = field(default_factory=list)
    broken_variables: bool = False
    full: set[str] = field(default_factory=set)

    @property
    def overflows(self) -> bool:
        """Whether there are more findings than one run reports: looking on is useless."""
        return len(self.diagnostics) > MAX_DIAGNOSTICS

    def report(
        self,
        name: str,
        message: str,
        span: Span,
        *,
        hint: str = "",
        replacement: str | None = None,
        severity: Severity = Severity.ERROR,
        related: tuple[Related, ...] = (),
    ) -> None:
        """Add a finding."""
        self.diagnostics.append(
            Diagnostic(name, message, span, severity, hint, replacement, related=related)
        )

    def variable(self, word: Word, role: str = "") -> Draft | None:
        """Return the variable called by `word`; report it where there is none of that role."""
        draft = self.drafts.get(word.text)
        if draft is None:
            # A broken `input` line is reported once, not at every use of its name.
            if not self.broken_variables:
                self._unknown("unknown-variable", "variable", word, self.names(role))
            return None
        if role and draft.node.role != role:
            article = "an input" if draft.is_input else "an output"
            self.report(
                f"not-an-{role}",
                f"'{word.text}' is {article}, not an {role}",
                word.span,
                related=(Related(f"'{word.text}' is declared here", draft.node.name.span),),
            )
            return None
        return draft

    def term(self, draft: Draft | None, word: Word) -> Term | None:
        """Return the term of `draft` called by `word`; report it where there is none."""
        if draft is None:
            return None
        term = draft.terms.get(word.text)
        if term is None:
            self._unknown("unknown-term", f"term of '{draft.name}'", word, draft.terms)
        return term

    def names(self, role: str = "") -> list[str]:
        """Return the names of the variables of `role`, or of all."""
        return [name for name, draft in self.drafts.items() if role in ("", draft.node.role)]

    def _unknown(self, name: str, what: str, word: Word, choices: Iterable[str]) -> None:
        options = list(choices)
        hint, replacement = "", None
        if len(self.diagnostics) < _MOST_HINTS:
            hint, replacement = near_hint(word.text, options)
        if not hint and options:
            shown = ", ".join(options[:10]) + (", …" if len(options) > 10 else "")
            hint = f"there are {shown}"
        self.report(
            name, f"no {what} is called '{word.text}'", word.span, hint=hint,
            replacement=None if replacement is None else name_text(replacement),
        )  # fmt: skip
