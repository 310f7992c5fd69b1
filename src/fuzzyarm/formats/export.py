"""What every writer needs: names that the format allows, and what it must leave out."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from fuzzyarm.formats.draft import unique_name
from fuzzyarm.formats.imported import Exported, Findings
from fuzzyarm.rulebase.diagnostic import Severity
from fuzzyarm.rulebase.model import Expression, Hedge, Hedged, Input, Is, Output, RuleBase

ERROR, WARNING = Severity.ERROR, Severity.WARNING
HEADER = "Written by fuzzyarm"

_IDENTIFIER = re.compile(r"[^\W\d]\w*\Z")

FUZZYLITE_WORDS = frozenset(
    [
        "if",
        "is",
        "then",
        "and",
        "or",
        "with",
        "any",
        "extremely",
        "not",
        "seldom",
        "somewhat",
        "very",
        "gt",
        "ge",
        "eq",
        "neq",
        "le",
        "lt",
        "min",
        "max",
        "acos",
        "asin",
        "atan",
        "ceil",
        "cos",
        "cosh",
        "exp",
        "abs",
        "fabs",
        "floor",
        "log",
        "log10",
        "round",
        "sin",
        "sinh",
        "sqrt",
        "tan",
        "tanh",
        "log1p",
        "acosh",
        "asinh",
        "atanh",
        "pow",
        "atan2",
        "fmod",
        "pi",
    ]
)
"""Names that fuzzylite's rule parser takes for itself."""


@dataclass(slots=True)
class Names:
    """What variables and terms are called in the written file.

    Attributes
    ----------
    variables : dict
        Name in the model → name in the file.
    terms : dict
        (variable, term) in the model → name in the file.
    """

    variables: dict[str, str] = field(default_factory=dict)
    terms: dict[tuple[str, str], str] = field(default_factory=dict)

    def variable(self, name: str) -> str:
        """Return the name of a variable in the file."""
        return self.variables.get(name, name)

    def term(self, variable: str, name: str) -> str:
        """Return the name of a term in the file."""
        return self.terms.get((variable, name), name)


def identifiers(
    rulebase: RuleBase,
    findings: Findings,
    reserved: frozenset[str],
    *,
    ignore_case: bool = False,
) -> Names:
    """Return names that are identifiers and not reserved; report every change."""
    names = Names()
    taken: set[str] = set()
    for variable in (*rulebase.inputs, *rulebase.outputs):
        names.variables[variable.name] = _fitted(
            variable.name, taken, reserved, findings, "variable", ignore_case=ignore_case
        )
        used: set[str] = set()
        for term in variable.terms:
            names.terms[variable.name, term.name] = _fitted(
                term.name, used, reserved, findings, "term", ignore_case=ignore_case
            )
    return names


def _fitted(
    name: str,
    taken: set[str],
    reserved: frozenset[str],
    findings: Findings,
    what: str,
    *,
    ignore_case: bool,
) -> str:
    # A fraction or a raised digit is a word character, but no reader takes it for a letter.
    plain = "".join(c if f"_{c}".isidentifier() else " " for c in name)
    fitted = re.sub(r"\W+", "_", plain).strip("_") or "_"
    if _IDENTIFIER.match(name) and name.isidentifier():
        fitted = name
    elif fitted[0].isnumeric():
        fitted = f"_{fitted}"
    if (fitted.lower() if ignore_case else fitted) in reserved:
        fitted = f"{fitted}_"
    fitted = unique_name(fitted, taken)
    taken.add(fitted)
    if fitted != name:
        findings.warn("renamed", f"the {what} '{name}' is written as {fitted}")
    return fitted


def note_left_out(rulebase: RuleBase, findings: Findings, *, descriptions: bool) -> None:
    """Report the parts that none of the formats has."""
    if rulebase.lookup is not None:
        findings.info("dropped-lookup", "the lookup settings are left out")
    if rulebase.expectations:
        count = len(rulebase.expectations)
        findings.info("dropped-expectations", f"{count} expectation(s) are left out")
    variables = (*rulebase.inputs, *rulebase.outputs)
    described = any(v.description for v in variables) or bool(rulebase.description)
    if described and not descriptions:
        findings.info("dropped-description", "descriptions are left out")
    for variable in variables:
        if variable.outside == "error":
            message = f"'{variable.name}' refuses values outside its range; the file cannot"
            findings.warn("outside-range", message)


def note_outside(variables: tuple[Input | Output, ...], findings: Findings, program: str) -> None:
    """Report ranges that clamp, for a program that does not."""
    for variable in variables:
        if variable.outside == "clamp":
            message = f"'{variable.name}' is clamped to its range, which {program} does not do"
            findings.loss("outside-range", message)


def note_chaining(rulebase: RuleBase, findings: Findings, program: str, *, own: bool) -> None:
    """Report outputs in antecedents, but where `own` those that their own block concludes.

    fuzzylite takes their activation so far; that is the same only where all rules that
    conclude the output stand in the block, before those that use it.
    """
    outputs = {output.name for output in rulebase.outputs}
    last: dict[str, tuple[int, int]] = {}
    for number, block in enumerate(rulebase.blocks):
        for index, rule in enumerate(block.rules):
            last |= {consequent.variable: (number, index) for consequent in rule.consequents}
    for number, block in enumerate(rulebase.blocks):
        for index, rule in enumerate(block.rules):
            for name in sorted(variables_in(rule.antecedent) & outputs):
                writer = last.get(name, (number, -1))
                if own and writer[0] == number and writer[1] < index:
                    continue
                message = f"a rule uses the output '{name}' in a way that {program} does not"
                findings.loss("chained-output", message, rule.span)


def note_threshold(rulebase: RuleBase, findings: Findings, program: str, usual: float) -> None:
    """Report blocks whose threshold is not the one that the program has."""
    for block in rulebase.blocks:
        if block.threshold == usual:
            continue
        message = (
            f"rules of the block '{block.name}' fire above {block.threshold}, to {program} "
            f"above {usual}"
        )
        if max(block.threshold, usual) > 1e-6:
            findings.loss("threshold", message)
        else:
            findings.info("threshold", message)


def variables_in(expression: Expression) -> set[str]:
    """Return the names of the variables in an antecedent."""
    if isinstance(expression, Is):
        return {expression.variable}
    if isinstance(expression, Hedged):
        return variables_in(expression.operand)
    return set().union(*map(variables_in, expression.operands))


def one_line(text: str, forbidden: str, findings: Findings) -> str:
    """Return `text` on one line and without `forbidden` characters; report a change."""
    cleaned = "".join(" " if c in forbidden or not c.isprintable() else c for c in text).strip()
    if cleaned != text:
        findings.info("changed-text", f"'{text[:40]}' is written without special characters")
    return cleaned


def without_any(hedges: tuple[Hedge, ...]) -> tuple[tuple[Hedge, ...], bool]:
    """Cut hedges after the outermost ``any``, inside of which nothing matters."""
    for index, hedge in enumerate(hedges):
        if hedge.name == "any":
            return hedges[: index + 1], True
    return hedges, False


def best(attempts: list[Exported]) -> Exported:
    """Return the first attempt with the fewest errors, then warnings, then remarks."""

    def cost(attempt: Exported) -> tuple[int, int, int]:
        graves = [d.severity for d in attempt.diagnostics]
        return graves.count(ERROR), graves.count(WARNING), len(graves)

    return min(attempts, key=cost)
