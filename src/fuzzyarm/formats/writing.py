"""What all writers of foreign formats share: their frame, legal names, losses, and rules.

:class:`Writer` is the frame, :func:`written_sentences` writes rules as FLL and FCL have them, and
:func:`as_sentences` undoes what :mod:`fuzzyarm.formats.meaning` does with hedges.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from fuzzyarm.expression import formulas
from fuzzyarm.expression.formulas import FormulaError
from fuzzyarm.expression.kinds import DEFUZZIFIERS, HEDGES, SNORMS, TNORMS
from fuzzyarm.expression.records import Norm
from fuzzyarm.formats.dialects import MACHINE_EPSILON, Dialect, word_of, words
from fuzzyarm.formats.drafts import VALUES, maximum_of_nothing, same_number
from fuzzyarm.formats.findings import Exported, Findings, unique_name, written
from fuzzyarm.formats.meaning import (
    POWERS,
    hedged_weight,
    hedges_of_conclusion,
    threshold_under,
    without_hedges,
)
from fuzzyarm.formats.sentences import NOT, hedged
from fuzzyarm.formats.shapes import class_and_numbers, fuzzylite_shape
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
    Shape,
    Term,
    propositions,
)
from fuzzyarm.text.diagnostic import Severity

HEADER = "Written by fuzzyarm"

FUZZYLITE_WORDS = frozenset(
    {"if", "is", "then", "and", "or", "with", "pi"}
    | set(words(HEDGES, "fll"))
    | set(formulas.FUZZYLITE.functions)
    | {"gt", "ge", "eq", "neq", "le", "lt", "log1p", "acosh", "asinh", "atanh"}
)
"""Names that fuzzylite's rule parser takes for itself."""

# --- The frame ---


class Writer:
    """Writes one rule base for one program; a format fills in :meth:`lines`.

    Attributes
    ----------
    file : str
        What messages call the file.
    descriptions : bool
        Whether the file has descriptions.
    """

    file = "the file"
    descriptions = False

    def __init__(self, rulebase: RuleBase, dialect: Dialect, *, lossy: bool, strict: bool) -> None:
        self.rulebase = rulebase
        self.dialect = dialect
        self.program = dialect.program
        self.findings = Findings(lossy=lossy, strict=strict)
        self.names = Names()

    def lines(self) -> list[str]:
        """Return the lines of the file, and report what they leave out."""
        raise NotImplementedError

    def export(self) -> Exported:
        """Return the text, unless something is in the way, and what was found."""
        rulebase, dialect, findings = self.rulebase, self.dialect, self.findings
        if refuse_type_2(rulebase, findings, self.program):
            return Exported(None, findings.all())
        if not rulebase.outputs:
            findings.error("no-engine", "the rule base has no output")
        note_left_out(rulebase, findings, descriptions=self.descriptions, outside=dialect.outside)
        note_chaining(rulebase, findings, self.program, own=dialect.chains)
        if not dialect.thresholds:
            settled = _with_usual_thresholds(rulebase, dialect)
            note_threshold(settled, findings, self.program, dialect.threshold)
        if "inputs" not in dialect.clamps:
            self._note_outside(rulebase.inputs)
        if "outputs" not in dialect.clamps:
            self._note_outside(rulebase.outputs)
        lines = self.lines()
        text = None if findings.failed else "\n".join(lines) + "\n"
        return Exported(text, findings.all())

    def _note_outside(self, variables: tuple[Input | Output, ...]) -> None:
        for variable in variables:
            if variable.outside == "clamp":
                message = (
                    f"'{variable.name}' is clamped to its range, which {self.program} does not do"
                )
                self.findings.loss("outside-range", message, slight=True)
            elif isinstance(variable, Input) and self.dialect.outside not in (
                "extend",
                variable.outside,
            ):
                message = f"{self.program} refuses values of '{variable.name}' outside its range"
                self.findings.loss("outside-range", message, slight=True)

    def takes_maximum_of_nothing(self, output: Output) -> bool:
        """Whether the C++ program of fuzzylite has its own value where no rule concludes this."""
        if output.defuzzifier.record.of != "top":
            return False
        self.warn_of_error(output)
        value = maximum_of_nothing(output)
        if output.no_rule != "error" and not same_number(output.no_rule, value):
            message = (
                f"'{output.name}' is {output.no_rule} where no rule fires, to fuzzylite 7 {value:g}"
            )
            self.findings.loss("no-rule", message)
        return True

    def one_line(self, text: str, forbidden: str) -> str:
        """Return `text` on one line and without `forbidden` characters; report a change."""
        cleaned = "".join(" " if c in forbidden or not c.isprintable() else c for c in text)
        cleaned = cleaned.strip()
        if cleaned != text:
            message = f"'{text[:40]}' is written without special characters"
            self.findings.info("changed-text", message)
        return cleaned

    # --- Norms, hedges and shapes, or a refusal by name ---

    def tnorm(self, name: str, other: str = "") -> str:
        """Return the word for a T-norm; `other` is a key that is tried before min is taken."""
        return self._norm(TNORMS, name, "min", other)

    def snorm(self, name: str, other: str = "") -> str:
        """Return the word for an S-norm; `other` is a key that is tried before max is taken."""
        return self._norm(SNORMS, name, "max", other)

    def _norm(self, kinds: Mapping[str, Norm], name: str, usual: str, other: str) -> str:
        word = word_of(kinds, name, self.dialect.kinds)
        if word is not None:
            return word
        word = word_of(kinds, name, other)
        message = f"{self.program} has no norm '{word or name}'"
        self.findings.loss("unsupported-norm", message)
        return word or word_of(kinds, usual, self.dialect.kinds) or usual

    def nothing_like(self, variable: Input | Output, term: Term, *, lossy: bool = False) -> None:
        """Report a shape that the program does not have."""
        kind = term.shape.kind
        message = f"{self.program} has nothing like '{term.name}' of '{variable.name}' ({kind})"
        report = self.findings.loss if lossy else self.findings.error
        report("unsupported-shape", message, term.span)

    def bad_formula(self, shape: Shape, fault: FormulaError) -> None:
        """Report a formula of the model that cannot be read."""
        self.findings.error("bad-formula", f"in '{shape.formula[:60]}': {fault}")

    def without_height(self, variable: Input | Output, term: Term) -> Shape:
        """Return the shape of a term without a height; report that it has one."""
        if term.shape.height == 1.0:
            return term.shape
        what = f"the height of '{term.name}' of '{variable.name}'"
        message = f"{self.file} cannot hold {what}"
        self.findings.loss("unsupported-height", message, term.span)
        return replace(term.shape, height=1.0)

    def fuzzylite_term(self, variable: Input | Output, term: Term) -> str:
        """Return class and numbers of a term as fuzzylite has them in FLL and FCL."""
        shape = term.shape
        if shape.kind in VALUES:
            shape = self.without_height(variable, term)
        try:
            shape = fuzzylite_shape(shape)
            text = class_and_numbers(shape, self.dialect.kinds, self.names.variables)
        except FormulaError as fault:
            self.bad_formula(shape, fault)
            return ""
        if text is None:
            self.nothing_like(variable, term)
        return text or ""

    # --- Defuzzifiers ---

    def method(self, output: Output) -> str:
        """Return the word for a defuzzifier, or for that which it is like, or refuse it by name."""
        return word_of_method(output, self.dialect.methods, self.program, self.findings)

    def need_values(self, output: Output, *, refused: bool = False) -> None:
        """Report sets where a weighted defuzzifier needs values; some programs refuse them."""
        if not {term.shape.kind for term in output.terms} <= VALUES:
            method = output.defuzzifier.method
            message = f"'{output.name}' has sets where {self.program} needs values ({method})"
            report = self.findings.error if refused else self.findings.loss
            report("set-as-value", message)

    def need_sets(self, output: Output, why: str = "which cannot be integrated") -> None:
        """Report values where an integral needs sets."""
        if {term.shape.kind for term in output.terms} & VALUES:
            message = f"'{output.name}' has values among its terms, {why}"
            self.findings.loss("value-as-set", message)

    def warn_of_error(self, output: Output, instead: str = "the file cannot say so") -> None:
        """Report an output that is an error where no rule fires."""
        if output.no_rule == "error":
            message = f"'{output.name}' is an error where no rule fires; {instead}"
            self.findings.warn("no-rule", message)


def word_of_method(output: Output, key: str, program: str, findings: Findings) -> str:
    """Return the word for a defuzzifier, or that for what it is like, with a loss.

    Refused by name where a program has neither.
    """
    record = output.defuzzifier.record
    word, like = (word_of(DEFUZZIFIERS, name, key) for name in (record.name, record.like))
    if word is None:
        message = f"{program} has no {record.name} for '{output.name}'"
        if like is None:
            findings.error("unsupported-defuzzifier", message)
        else:
            message += f"; {like}, which it has, is {record.like}"
            findings.loss("unsupported-defuzzifier", message)
    return word or like or ""


def best(attempts: list[Exported]) -> Exported:
    """Return the first attempt with the fewest errors, then warnings, then remarks."""

    def cost(attempt: Exported) -> tuple[int, int, int]:
        return (*_lost(attempt, ("threshold",)), len(attempt.diagnostics))

    return min(attempts, key=cost)


def likeliest(attempts: list[Exported]) -> Exported:
    """Return the first attempt, or the best one if that loses less of the numbers inside ranges.

    The first is for the program whose format it is, as a reader takes it where nothing tells.
    """
    edges = ("threshold", "outside-range", "no-rule")
    first, other = attempts[0], best(attempts)
    return first if _lost(first, edges) <= _lost(other, edges) else other


def _lost(attempt: Exported, slight: tuple[str, ...]) -> tuple[int, int]:
    """Return the numbers of errors, and of warnings but for some."""
    # fuzzylite's threshold moves less than the coarser samples of another program.
    warned = [d for d in attempt.diagnostics if d.severity is Severity.WARNING]
    return len(attempt.errors), sum(d.name not in slight for d in warned)


# --- Names that a format allows ---


@dataclass(slots=True)
class Names:
    """What variables, and terms by (variable, term), are called in the written file."""

    variables: dict[str, str] = field(default_factory=dict)
    terms: dict[tuple[str, str], str] = field(default_factory=dict)

    def variable(self, name: str) -> str:
        """Return the name of a variable in the file."""
        return self.variables.get(name, name)

    def term(self, variable: str, name: str) -> str:
        """Return the name of a term in the file."""
        return self.terms.get((variable, name), name)


def identifier(name: str, reserved: frozenset[str], *, ignore_case: bool) -> str:
    """Return a name as an identifier that is not reserved."""
    # A fraction or a raised digit is a word character, but no reader takes it for a letter.
    plain = "".join(c if f"_{c}".isidentifier() else " " for c in name)
    found = re.sub(r"\W+", "_", plain).strip("_") or "_"
    if name.isidentifier() and re.fullmatch(r"\w+", name):
        found = name
    elif found[0].isnumeric():
        found = f"_{found}"
    if (found.lower() if ignore_case else found) in reserved:
        found = f"{found}_"
    return found


def identifiers(
    rulebase: RuleBase,
    findings: Findings,
    reserved: frozenset[str],
    *,
    ignore_case: bool = False,
) -> Names:
    """Return names that are identifiers and not reserved; report every change."""

    def fitted(name: str, taken: set[str], what: str) -> str:
        found = unique_name(identifier(name, reserved, ignore_case=ignore_case), taken)
        taken.add(found)
        if found != name:
            findings.warn("renamed", f"the {what} '{name}' is written as {found}")
        return found

    names = Names()
    variables: set[str] = set()
    for variable in (*rulebase.inputs, *rulebase.outputs):
        names.variables[variable.name] = fitted(variable.name, variables, "variable")
        terms: set[str] = set()
        for term in variable.terms:
            names.terms[variable.name, term.name] = fitted(term.name, terms, "term")
    return names


# --- What must be left out ---


def refuse_type_2(rulebase: RuleBase, findings: Findings, program: str) -> bool:
    """Refuse a rule base of interval type 2, by name: without its lower terms it is another."""
    if not rulebase.is_type2:
        return False
    variables = (*rulebase.inputs, *rulebase.outputs)
    what = [f"'{v.name} is {t.name}'" for v in variables for t in v.terms if t.lower is not None]
    ways = [o for o in rulebase.outputs if o.defuzzifier.record.type2]
    what += [f"{way.defuzzifier.method} of '{way.name}'" for way in ways]
    message = f"{what[0]} is of interval type 2, which is not written for {program}"
    findings.error("unsupported-type", message)
    return True


def note_left_out(
    rulebase: RuleBase, findings: Findings, *, descriptions: bool, outside: str = "extend"
) -> None:
    """Report the parts that none of the formats has; `outside` is the program's manner."""
    if rulebase.lookup is not None:
        findings.info("dropped-lookup", "the lookup settings are left out")
    if rulebase.expectations:
        count = len(rulebase.expectations)
        findings.info("dropped-expectations", f"{count} expectation(s) are left out")
    if rulebase.properties:
        count = len(rulebase.properties)
        findings.info("dropped-properties", f"{count} `prove` line(s) are left out")
    variables = (*rulebase.inputs, *rulebase.outputs)
    described = any(v.description for v in variables) or bool(rulebase.description)
    if described and not descriptions:
        findings.info("dropped-description", "descriptions are left out")
    for variable in variables:
        if variable.outside == "error" and outside != "error":
            message = f"'{variable.name}' refuses values outside its range; the file cannot"
            findings.warn("outside-range", message)


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
            used = {part.variable for part in propositions(rule.antecedent)}
            for name in sorted(used & outputs):
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
        slight = max(block.threshold, usual) <= MACHINE_EPSILON
        findings.loss("threshold", message, slight=slight)


def _with_usual_thresholds(rulebase: RuleBase, dialect: Dialect) -> RuleBase:
    """Give blocks the threshold of a program where hedges of conclusions make theirs of it."""
    if not dialect.activates:
        return rulebase
    blocks = tuple(
        replace(block, threshold=dialect.threshold)
        if block.rules and all(hedges_of_conclusion(r, block, dialect) for r in block.rules)
        else block
        for block in rulebase.blocks
    )
    return replace(rulebase, blocks=blocks)


# --- Rules ---


@dataclass(frozen=True, slots=True)
class Sentence:
    """A rule as fuzzylite says it: each conclusion with the hedges that stand before it."""

    antecedent: Expression
    conclusions: tuple[tuple[Consequent, tuple[Hedge, ...]], ...]
    weight: float
    rule: Rule
    hedges: tuple[Hedge, ...] = ()


def plain_sentence(rule: Rule) -> Sentence:
    """Return a rule as it stands, for programs that have no hedges before conclusions."""
    conclusions = tuple((consequent, ()) for consequent in rule.consequents)
    return Sentence(rule.antecedent, conclusions, rule.weight, rule)


def as_sentences(
    block: RuleBlock,
    dialect: Dialect,
    findings: Findings,
    order: dict[str, int] | None = None,
) -> list[Sentence]:
    """Return the rules of a block; those that differ in outer hedges alone become one again.

    Hedges of a conclusion carry on to the conclusions after it, so that rules over one
    antecedent whose hedges grow can be said as one. With `order`, the index of every
    output, only where the conclusions then stand in that order.
    """
    sentences: list[Sentence] = []
    for rule in block.rules:
        sentence = _as_sentence(rule, block, dialect, findings)
        last = sentences[-1] if sentences else None
        if last is not None and _carries_on(last, sentence, order):
            (first, _), *others = sentence.conclusions
            new = sentence.hedges[: len(sentence.hedges) - len(last.hedges)]
            conclusions = (*last.conclusions, (first, new), *others)
            sentences[-1] = replace(sentence, conclusions=conclusions, rule=last.rule)
        else:
            sentences.append(sentence)
    return sentences


def _as_sentence(rule: Rule, block: RuleBlock, dialect: Dialect, findings: Findings) -> Sentence:
    """Put the hedges around a whole antecedent before the first conclusion, where that can be.

    A hedge around a parenthesis has no other place; it then makes a threshold of its own.
    """
    antecedent, weight = rule.antecedent, rule.weight
    hedges = hedges_of_conclusion(rule, block, dialect)
    if not hedges and isinstance(antecedent, Hedged) and isinstance(antecedent.operand, And | Or):
        above = block.threshold if dialect.thresholds else dialect.threshold
        under = threshold_under(antecedent.hedges, above)
        if under is not None:
            hedges = antecedent.hedges
            message = f"the rule fires above {block.threshold:g}, to {dialect.program} {under:g}"
            slight = max(under, block.threshold) <= MACHINE_EPSILON
            findings.loss("threshold", message, rule.span, slight=slight)
    before = weight_before(weight, hedges) if hedges else None
    if before is None:
        hedges = ()
    else:
        weight, antecedent = before, without_hedges(antecedent, hedges)
    conclusions = tuple((c, () if i else hedges) for i, c in enumerate(rule.consequents))
    return Sentence(antecedent, conclusions, weight, rule, hedges)


def _carries_on(last: Sentence, sentence: Sentence, order: dict[str, int] | None) -> bool:
    """Whether a rule can be said as further conclusions of the last one."""
    more = len(sentence.hedges) - len(last.hedges)
    if more <= 0 or sentence.hedges[more:] != last.hedges:
        return False
    if order is not None:
        before = order[last.conclusions[-1][0].variable]
        if order[sentence.conclusions[0][0].variable] <= before:
            return False
    return last.antecedent == sentence.antecedent and last.weight == sentence.weight


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


def written_sentences(
    block: RuleBlock, dialect: Dialect, names: Names, findings: Findings
) -> list[str]:
    """Return the rules of a block as ``if … then …``; report what cannot be said so."""
    as_they_stand = map(plain_sentence, block.rules)
    sentences = as_sentences(block, dialect, findings) if dialect.activates else as_they_stand
    writer = _SentenceWriter(block, dialect, names, findings)
    return [writer.text(sentence) for sentence in sentences]


@dataclass(frozen=True, slots=True)
class _SentenceWriter:
    """Writes the rules of one block.

    fuzzylite has hedges behind *is* and nowhere else; jFuzzyLogic has *not* alone, before a
    proposition or a parenthesis, and writes key words in capitals.
    """

    block: RuleBlock
    dialect: Dialect
    names: Names
    findings: Findings

    def key(self, word: str) -> str:
        return word if self.dialect.activates else word.upper()

    def closed(self, text: str) -> str:
        return f"( {text} )" if self.dialect.activates else f"({text})"

    def text(self, sentence: Sentence) -> str:
        condition = self.condition(sentence.antecedent, sentence.rule)
        conclusions = [
            self.conclusion(*conclusion, sentence.rule) for conclusion in sentence.conclusions
        ]
        joint = " and " if self.dialect.activates else ", "
        ending = "" if sentence.weight == 1.0 else f" {self.key('with')} {written(sentence.weight)}"
        head, then = self.key("if"), self.key("then")
        return f"{head} {condition} {then} {joint.join(conclusions)}{ending}"

    def conclusion(self, consequent: Consequent, hedges: tuple[Hedge, ...], rule: Rule) -> str:
        if consequent.hedges:
            message = (
                "hedges on the set of a conclusion have another meaning to fuzzylite"
                if self.dialect.activates
                else "jFuzzyLogic has no hedges in conclusions"
            )
            self.findings.loss("set-hedge", message, rule.span)
        variable = self.names.variable(consequent.variable)
        term = self.names.term(consequent.variable, consequent.term)
        return " ".join([variable, self.key("is"), *self.hedge_words(hedges), term])

    def condition(self, expression: Expression, rule: Rule) -> str:
        if isinstance(expression, Is):
            return self.proposition(expression, rule)
        if isinstance(expression, Hedged):
            if self.dialect.activates:
                return self.condition(self.pushed_in(expression), rule)
            inner = self.closed(self.condition(expression.operand, rule))
            return " ".join([*self.negations(expression.hedges, rule), inner])
        parts = []
        for each in expression.operands:
            operand = each
            if isinstance(each, Hedged) and self.dialect.activates:
                operand = self.pushed_in(each)
            text = self.condition(operand, rule)
            # To fuzzylite `and` binds tighter than `or`, to jFuzzyLogic they bind alike.
            apart = isinstance(operand, Or) or type(operand) is type(expression)
            if not self.dialect.activates:
                apart = isinstance(operand, And | Or)
            parts.append(self.closed(text) if apart else text)
        return f" {self.key('and' if isinstance(expression, And) else 'or')} ".join(parts)

    def proposition(self, proposition: Is, rule: Rule) -> str:
        variable = self.names.variable(proposition.variable)
        term = self.names.term(proposition.variable, proposition.term)
        if not self.dialect.activates:
            return " ".join([*self.negations(proposition.hedges, rule), variable, "IS", term])
        names = [hedge.name for hedge in proposition.hedges]
        if "any" in names:  # inside of which nothing matters, and no term is named
            hedges = proposition.hedges[: names.index("any") + 1]
            return " ".join([variable, "is", *self.hedge_words(hedges)])
        return " ".join([variable, "is", *self.hedge_words(proposition.hedges), term])

    def hedge_words(self, hedges: tuple[Hedge, ...]) -> list[str]:
        found = []
        for hedge in hedges:
            word = word_of(HEDGES, hedge.name, self.dialect.kinds)
            if word is None:
                name = hedge.name if hedge.exponent is None else f"power({hedge.exponent})"
                message = f"{self.dialect.program} has no hedge '{name}'"
                self.findings.loss("unsupported-hedge", message)
            else:
                found.append(word)
        return found

    def negations(self, hedges: tuple[Hedge, ...], rule: Rule) -> list[str]:
        for hedge in hedges:
            if hedge != NOT:
                message = f"jFuzzyLogic has no hedge '{hedge.name}'"
                self.findings.loss("unsupported-hedge", message, rule.span)
        return ["NOT"] * (sum(hedge == NOT for hedge in hedges) % 2)

    def pushed_in(self, expression: Hedged) -> Expression:
        """Return the same without hedges on an ``and`` or ``or``, where that can be."""
        operand = expression.operand
        if isinstance(operand, Is | Hedged):
            return hedged(expression.hedges, operand)
        block = self.block
        if all(hedge == NOT for hedge in expression.hedges):
            if len(expression.hedges) % 2 == 0:
                return operand
            if block.conjunction in TNORMS and TNORMS[block.conjunction].dual == block.disjunction:
                kind = Or if isinstance(operand, And) else And
                return kind(tuple(hedged((NOT,), inner) for inner in operand.operands))
        message = "fuzzylite has no hedges on expressions in parentheses"
        self.findings.loss("hedged-expression", message)
        return operand
