"""FML, the Fuzzy Markup Language of IEEE 1855: written.

A variable consists of terms, of values (``tskVariable``) or of Tsukamoto's terms, and each kind has
its own rule bases: a rule with conclusions of two kinds is split between them.
:mod:`fuzzyarm.exchange.formats.fml` reads the text back as the same model.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from xml.sax.saxutils import escape, quoteattr

from fuzzyarm.exchange.formats.dialects import FML, words
from fuzzyarm.exchange.formats.drafts import all_invertible
from fuzzyarm.exchange.formats.findings import Exported, unique_name, written
from fuzzyarm.exchange.formats.fml import MODIFIERS, RULE_BASES, VARIABLES
from fuzzyarm.exchange.formats.shapes import word_and_numbers
from fuzzyarm.exchange.formats.system_writer import HEADER, SystemWriter
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Expression,
    Hedge,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES

NAMESPACE = "http://www.ieee1855.org"

_OF_VARIABLES = {
    "fuzzyVariable": "mamdaniRuleBase",
    "tsukamotoVariable": "tsukamotoRuleBase",
    "tskVariable": "tskRuleBase",
}
"""Kind of an output → tag of its rule bases."""


def write_fml(rulebase: RuleBase, *, lossy: bool = False, strict: bool = False) -> Exported:
    """Write a fuzzy system of FML: :func:`~fuzzyarm.exchange.formats.registry.write` of ``.fml``.

    Parameters
    ----------
    rulebase, lossy, strict
        As there.

    Returns
    -------
    Exported
        The text, if there is no error, and every finding.
    """
    return _Writer(rulebase, FML, lossy=lossy, strict=strict).export()


class _Writer(SystemWriter):
    file = "an FML file"

    def head(self) -> list[str]:
        root = _attributes(xmlns=NAMESPACE, name=self._text(self.rulebase.name))
        lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<!-- {HEADER} -->"]
        return [*lines, f"<fuzzySystem{root}>", "  <knowledgeBase>"]

    def variable(self, variable: Input | Output, index: int) -> list[str]:
        return [f"    {line}" for line in self._variable(variable)]

    def between(self) -> list[str]:
        return ["  </knowledgeBase>"]

    def block(self, block: RuleBlock, index: int) -> list[str]:
        return [f"  {line}" for kind in _OF_VARIABLES for line in self._rule_base(block, kind)]

    def foot(self) -> list[str]:
        return ["</fuzzySystem>"]

    def settle_names(self) -> None:
        self.kinds = {output.name: self._kind(output) for output in self.rulebase.outputs}
        plain_hedges = {word: (Hedge(name),) for word, name in words(HEDGES, FML.kinds).items()}
        self.modifiers = {
            hedges: word for word, hedges in (*MODIFIERS.items(), *plain_hedges.items())
        }
        variables: set[str] = set()
        for variable in (*self.rulebase.inputs, *self.rulebase.outputs):
            name = unique_name(self._text(variable.name), variables)
            variables.add(name)
            self.names.variables[variable.name] = name
            terms: set[str] = set()
            for term in variable.terms:
                fitted = unique_name(self._text(term.name), terms)
                terms.add(fitted)
                self.names.terms[variable.name, term.name] = fitted

    def _text(self, text: str) -> str:
        return self.one_line(text, "") or "_"

    # --- Variables and terms ---

    def _kind(self, output: Output) -> str:
        record, kinds = output.defuzzifier.record, {term.shape.kind for term in output.terms}
        if record.inverts:
            if not all_invertible(kinds):
                message = f"'{output.name}' has terms that cannot be inverted"
                self.findings.error("not-monotonic", message)
            self._note_aggregation(output)
            return "tsukamotoVariable"
        average = record.name == "weighted-average"
        if average and kinds == {"singleton"} and output.aggregation != "sum":
            return "fuzzyVariable"  # their centre of gravity is their average
        if record.weighs:
            self.method(output)  # refuses a sum of values by name
            self.need_values(output, refused=True)
            self._note_aggregation(output)
            return "tskVariable"
        if not (kinds == {"singleton"} and record.of == "top"):  # the winner
            self.need_sets(output)
        return "fuzzyVariable"

    def _note_aggregation(self, output: Output) -> None:
        """Report that rules with the same conclusion are added up, unlike in the model."""
        counts = Counter(
            consequent.term
            for rule in self.rulebase.rules
            for consequent in rule.consequents
            if consequent.variable == output.name
        )
        if output.aggregation != "sum" and any(count > 1 for count in counts.values()):
            message = f"every rule of '{output.name}' counts for itself in {self.program}"
            self.findings.loss("unsupported-norm", message)

    def _variable(self, variable: Input | Output) -> Iterator[str]:
        kind = self.kinds.get(variable.name, "fuzzyVariable")
        values = {"name": self.names.variable(variable.name)}
        if kind != "tskVariable":
            values |= {"domainleft": written(variable.low), "domainright": written(variable.high)}
        values["type"] = "output" if isinstance(variable, Output) else "input"
        if isinstance(variable, Output):
            values |= self._evaluation(variable, kind)
        yield f"<{kind}{_attributes(**values)}>"
        for term in variable.terms:
            for line in self._term(variable, term, VARIABLES[kind]):
                yield f"  {line}"
        yield f"</{kind}>"

    def _evaluation(self, output: Output, kind: str) -> dict[str, str]:
        if kind == "fuzzyVariable":
            attributes = {
                "accumulation": self.snorm(output.aggregation),
                "defuzzifier": self._method(output),
            }
        else:
            attributes = {"combination": "WA"}
        no_rule = self.no_rule(output)
        default = no_rule if isinstance(no_rule, float) else math.nan
        return attributes | {"defaultValue": written(default)}

    def _method(self, output: Output) -> str:
        if output.defuzzifier.record.weighs:
            return "COG"
        self.note_sampling(output)
        return self.method(output)

    def _term(self, variable: Input | Output, term: Term, tag: str) -> Iterator[str]:
        name = {"name": self.names.term(variable.name, term.name)}
        shape = term.shape
        if tag == "tskTerm":
            shape = self.without_height(variable, term)
            order = str(int(shape.kind == "linear"))
            yield f"<tskTerm{_attributes(**name, order=order)}>"
            if shape.kind in ("linear", "singleton") and shape.parameters:
                *factors, constant = shape.parameters
                # IEEE 1855 has the constant first, the model last.
                for value in (constant, *factors):
                    yield f"  <tskValue>{written(value)}</tskValue>"
            else:
                self.nothing_like(variable, term)
            yield "</tskTerm>"
            return
        yield f"<{tag}{_attributes(**name, complement='false')}>"
        points = _points(shape)
        if points:
            yield "  <pointSetShape>"
            for x, y in points:
                yield f"    <point{_attributes(x=written(x), y=written(shape.height * y))}/>"
            yield "  </pointSetShape>"
        else:
            yield f"  {self._shape(variable, term)}"
        yield f"</{tag}>"

    def _shape(self, variable: Input | Output, term: Term) -> str:
        shape = self.without_height(variable, term)
        word, numbers = (
            _of_two_numbers(shape, variable) or word_and_numbers(shape, FML.kinds) or ("", ())
        )
        if not word or shape.kind not in SHAPES:
            self.nothing_like(variable, term)
        values = {f"param{i}": written(value) for i, value in enumerate(numbers, 1)}
        return f"<{word}{_attributes(**values)}/>"

    # --- Rules ---

    def _rule_base(self, block: RuleBlock, kind: str) -> Iterator[str]:
        """Yield the rules of a block about outputs of one kind, if any."""
        tag = _OF_VARIABLES[kind]
        rules = [
            (rule, [c for c in rule.consequents if self.kinds.get(c.variable) == kind])
            for rule in block.rules
        ]
        rules = [(rule, conclusions) for rule, conclusions in rules if conclusions]
        if not rules:
            return
        norms = {
            "andMethod": self.tnorm(block.conjunction),
            "orMethod": self.snorm(block.disjunction),
        }
        if kind != "tskVariable":
            norms = {"activationMethod": self.tnorm(block.implication)} | norms
        yield f"<{tag}{_attributes(name=self.one_line(block.name, ''), **norms)}>"
        for number, (rule, conclusions) in enumerate(rules, 1):
            for line in self._rule(rule, conclusions, number, RULE_BASES[tag]):
                yield f"  {line}"
        yield f"</{tag}>"

    def _rule(
        self, rule: Rule, conclusions: list[Consequent], number: int, tags: tuple[str, ...]
    ) -> Iterator[str]:
        element, consequent, then, _, clause = tags
        parts = _conditions(rule.antecedent)
        outputs = [part for part in parts or () if part.variable in self.kinds]
        if outputs:
            message = f"a condition on the output '{outputs[0].variable}' is not supported"
            self.findings.error("chained-output", message, rule.span)
        if parts is None:
            message = "a rule of FML is one list of conditions, joined by and or by or"
            self.findings.loss("rule-too-rich", message, rule.span)
            return
        connector = "or" if isinstance(rule.antecedent, Or) else "and"
        head = {"name": f"R{number}", "connector": connector, "weight": written(rule.weight)}
        yield f"<{element}{_attributes(**head)}>"
        yield "  <antecedent>"
        for part in parts:
            yield f"    {self._clause('clause', part, rule)}"
        yield "  </antecedent>"
        yield f"  <{consequent}>"
        yield f"    <{then}>"
        for conclusion in conclusions:
            yield f"      {self._clause(clause, conclusion, rule)}"
        yield f"    </{then}>"
        yield f"  </{consequent}>"
        yield f"</{element}>"

    def _clause(self, tag: str, part: Is | Consequent, rule: Rule) -> str:
        modifier = self.modifiers.get(part.hedges) if part.hedges else ""
        if modifier is None:
            names = " ".join(hedge.name for hedge in part.hedges)
            message = f"FML has no modifier '{names}'"
            self.findings.loss("unsupported-hedge", message, rule.span)
        variable = escape(self.names.variable(part.variable))
        term = escape(self.names.term(part.variable, part.term))
        content = f"<variable>{variable}</variable><term>{term}</term>"
        return f"<{tag}{_attributes(modifier=modifier or '')}>{content}</{tag}>"


def _attributes(**values: str) -> str:
    """Return the attributes of a tag, without the empty ones."""
    return "".join(f" {key}={quoteattr(value)}" for key, value in values.items() if value)


def _conditions(antecedent: Expression) -> list[Is] | None:
    """Return the propositions of a flat antecedent; None for any other."""
    parts = antecedent.operands if isinstance(antecedent, And | Or) else (antecedent,)
    propositions = [part for part in parts if isinstance(part, Is)]
    return propositions if len(propositions) == len(parts) else None


def _points(shape: Shape) -> list[tuple[float, float]]:
    """Return the corners of points, and of straight shapes with a height, which FML lacks."""
    kind = SHAPES[shape.kind]
    if kind.corners is None or (shape.kind != "points" and shape.height == 1.0):
        return []
    corners = list(kind.corners(*shape.parameters))
    return corners if all(math.isfinite(x) for x, _ in corners) else []


def _of_two_numbers(shape: Shape, variable: Input | Output) -> tuple[str, tuple[float, ...]] | None:
    """Return a π with equal flanks, or a gaussian flank that stays at 1 to the end of the range."""
    p = shape.parameters
    if shape.kind == "pi" and p[1] == p[2] and p[3] == p[1] + abs(p[1] - p[0]):
        return "piShape", p[:2]
    if shape.kind == "two-sided-gaussian" and p[1] == p[3]:
        if p[0] == variable.low:
            return "leftGaussianShape", p[2:]
        if p[2] == variable.high:
            return "rightGaussianShape", p[:2]
    return None
