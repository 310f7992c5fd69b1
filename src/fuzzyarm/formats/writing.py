"""What writers of foreign formats share: legal names, losses, and rules as fuzzylite reads them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from fuzzyarm.formats.findings import Exported, Findings, unique_name, written
from fuzzyarm.formats.rules import NOT, POWERS, hedged, hedged_weight
from fuzzyarm.model.rulebase import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
)
from fuzzyarm.text.diagnostic import Severity

# --- What every writer needs: names that the format allows, and what it must leave out ---

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


# --- Write rules as fuzzylite reads them, in FLL and in its dialect of FCL ---

_HEDGES = {
    "any": "any",
    "intensify": "extremely",
    "not": "not",
    "seldom": "seldom",
    "somewhat": "somewhat",
    "very": "very",
}
DUALS = {
    "min": "max",
    "product": "probor",
    "bounded": "bounded",
    "drastic": "drastic",
    "hamacher": "hamacher",
    "einstein": "einstein",
    "nilpotent": "nilpotent",
}
"""T-norm → S-norm with not (a and b) = not a or not b."""


@dataclass(frozen=True, slots=True)
class Said:
    """A rule as fuzzylite says it: each conclusion with the hedges that stand before it."""

    antecedent: Expression
    conclusions: tuple[tuple[Consequent, tuple[Hedge, ...]], ...]
    weight: float
    rule: Rule
    hedges: tuple[Hedge, ...]


def said_rules(block: RuleBlock, order: dict[str, int] | None = None) -> list[Said]:
    """Return the rules of a block; those that differ in outer hedges alone become one again.

    Hedges of a conclusion carry on to the conclusions after it, so that rules over one
    antecedent whose hedges grow can be said as one. With `order`, the place of every
    output, only where the conclusions then stand in that order.
    """
    found: list[Said] = []
    for rule in block.rules:
        antecedent, hedges, weight = split_hedges(rule)
        conclusions = tuple((c, hedges if i == 0 else ()) for i, c in enumerate(rule.consequents))
        last = found[-1] if found else None
        if last is not None and _grows(last, antecedent, hedges, weight, rule, order):
            new = hedges[: len(hedges) - len(last.hedges)]
            conclusions = ((conclusions[0][0], new), *conclusions[1:])
            conclusions = (*last.conclusions, *conclusions)
            found[-1] = Said(antecedent, conclusions, weight, last.rule, hedges)
        else:
            found.append(Said(antecedent, conclusions, weight, rule, hedges))
    return found


def _grows(
    last: Said,
    antecedent: Expression,
    hedges: tuple[Hedge, ...],
    weight: float,
    rule: Rule,
    order: dict[str, int] | None,
) -> bool:
    count = len(last.hedges)
    suffix = hedges[len(hedges) - count :] if count else ()
    if len(hedges) <= count or suffix != last.hedges or last.antecedent != antecedent:
        return False
    if order is not None:
        before = order[last.conclusions[-1][0].variable]
        if order[rule.consequents[0].variable] <= before:
            return False
    return last.weight == weight


def rule_text(said: Said, block: RuleBlock, names: Names, findings: Findings) -> str:
    """Return ``if … then …``; report hedges that cannot be said."""
    condition = _condition(said.antecedent, block, names, findings)
    conclusions = []
    for consequent, hedges in said.conclusions:
        if consequent.hedges:
            message = "hedges on the set of a conclusion have another meaning to fuzzylite"
            findings.loss("set-hedge", message, said.rule.span)
        term = names.term(consequent.variable, consequent.term)
        words = _hedge_words(hedges, findings)
        conclusions.append(" ".join([names.variable(consequent.variable), "is", *words, term]))
    ending = "" if said.weight == 1.0 else f" with {written(said.weight)}"
    return f"if {condition} then {' and '.join(conclusions)}{ending}"


def split_hedges(rule: Rule) -> tuple[Expression, tuple[Hedge, ...], float]:
    """Take the hedges around a whole antecedent off, with the weight they then need."""
    if not isinstance(rule.antecedent, Hedged):
        return rule.antecedent, (), rule.weight
    hedges, operand = rule.antecedent.hedges, rule.antecedent.operand
    weight = weight_before(rule.weight, hedges)
    if weight is None:
        return rule.antecedent, (), rule.weight
    return operand, hedges, weight


def weight_before(weight: float, hedges: tuple[Hedge, ...]) -> float | None:
    """Return w with ``hedged_weight(w, hedges) == weight`` to the last bit, or None."""
    if weight == 1.0:
        return 1.0
    guess = weight
    for hedge in hedges:
        if hedge.name not in POWERS or guess <= 0.0:
            return None
        guess = guess ** (1.0 / (hedge.exponent or POWERS[hedge.name]))
    for candidate in (guess, math.nextafter(guess, math.inf), math.nextafter(guess, 0.0)):
        if hedged_weight(candidate, hedges) == weight:
            return candidate
    return None


def _hedge_words(hedges: tuple[Hedge, ...], findings: Findings) -> list[str]:
    words = []
    for hedge in hedges:
        if hedge.name not in _HEDGES:
            said = hedge.name if hedge.exponent is None else f"power({hedge.exponent})"
            findings.loss("unsupported-hedge", f"fuzzylite has no hedge '{said}'")
            continue
        words.append(_HEDGES[hedge.name])
    return words


def _condition(expression: Expression, block: RuleBlock, names: Names, findings: Findings) -> str:
    if isinstance(expression, Is):
        return _proposition(expression, names, findings)
    if isinstance(expression, Hedged):
        return _condition(_pushed_in(expression, block, findings), block, names, findings)
    word = " and " if isinstance(expression, And) else " or "
    parts = []
    for operand in expression.operands:
        inner = _pushed_in(operand, block, findings) if isinstance(operand, Hedged) else operand
        text = _condition(inner, block, names, findings)
        closed = isinstance(inner, Or) or type(inner) is type(expression)
        parts.append(f"( {text} )" if closed else text)
    return word.join(parts)


def _pushed_in(expression: Hedged, block: RuleBlock, findings: Findings) -> Expression:
    """Return the same without hedges on an ``and`` or ``or``, where that can be."""
    operand = expression.operand
    if isinstance(operand, Is | Hedged):
        return hedged(expression.hedges, operand)
    negations = len(expression.hedges)
    dual = DUALS.get(block.conjunction) == block.disjunction
    if all(hedge == NOT for hedge in expression.hedges):
        if negations % 2 == 0:
            return operand
        if dual:
            kind = Or if isinstance(operand, And) else And
            return kind(tuple(hedged((NOT,), inner) for inner in operand.operands))
    message = "fuzzylite has no hedges on expressions in parentheses"
    findings.loss("hedged-expression", message)
    return operand


def _proposition(proposition: Is, names: Names, findings: Findings) -> str:
    hedges, any_term = without_any(proposition.hedges)
    words = [names.variable(proposition.variable), "is", *_hedge_words(hedges, findings)]
    if not any_term:
        words.append(names.term(proposition.variable, proposition.term))
    return " ".join(words)
