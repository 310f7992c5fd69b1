"""FML, the Fuzzy Markup Language of IEEE 1855: read.

An FML file is XML: a knowledge base of variables with their terms, then rule bases. The definitions
are those of the standard (equations A.1 to A.47); where its reference program JFML departs from
them, the standard applies.
"""

from __future__ import annotations

import math
import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from xml.parsers import expat

from fuzzyarm.base.diagnostic import MAX_NESTING, Span
from fuzzyarm.exchange.formats.composed import POINTS, Degree, composed, norm_of
from fuzzyarm.exchange.formats.dialects import FML, Dialect, all_spellings, words
from fuzzyarm.exchange.formats.drafts import VariableDraft, all_invertible, imported
from fuzzyarm.exchange.formats.findings import (
    MAX_RULES,
    FaultError,
    Findings,
    Imported,
    TextPiece,
    not_a_number,
    number,
)
from fuzzyarm.exchange.formats.meaning import BlockDraft, around, hedged_weight
from fuzzyarm.exchange.formats.sentences import NOT, RuleText
from fuzzyarm.exchange.formats.shapes import make_shape, range_of_values, spelled_shape
from fuzzyarm.exchange.formats.system_reader import SystemReader
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Hedge,
    Is,
    Or,
    RuleBase,
    Shape,
)
from fuzzyarm.language.model.shapes import membership_function
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES

_ROOT = re.compile(r"<(?![?!])(?:[\w.-]+:)?([\w.-]+)")
_ROOTS = ("fuzzysystem", "fuzzycontroller", "fuzzycontrol", "fml")


def is_fml(text: str) -> bool:
    """Whether an XML text (its beginning suffices) has a root element of FML."""
    root = _ROOT.search(re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
    return root is not None and root[1].lower() in _ROOTS


# --- XML, with the position of every element ---


@dataclass(slots=True)
class _Element:
    """An element: tag without namespace, text without that of the children."""

    tag: TextPiece
    attributes: dict[str, str]
    children: list[_Element] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The stripped text."""
        return "".join(self.pieces).strip()

    def get(self, key: str, default: str = "") -> TextPiece:
        """Return an attribute, at the position of the element."""
        return TextPiece(self.attributes.get(key, default).strip(), self.tag.span)

    def all(self, *tags: str) -> Iterator[_Element]:
        """Yield the children with one of the tags."""
        return (child for child in self.children if child.tag.text in tags)

    def child(self, tag: str) -> _Element:
        """Return the only child with a tag."""
        element = next(self.all(tag), None)
        if element is None:
            raise FaultError(f"<{self.tag.text}> has no <{tag}>", self.tag)
        return element

    def word(self, tag: str) -> TextPiece:
        """Return the text of the only child with a tag."""
        element = self.child(tag)
        return TextPiece(element.text, element.tag.span)


def _parsed(text: str) -> _Element:
    """Return the root of an XML text; a document type (which could define entities) is refused."""
    parser = expat.ParserCreate("utf-8", "}")
    root = _Element(TextPiece(""), {})
    stack = [root]

    def here(length: int) -> Span:
        line, column = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
        return Span(line, column, line, column + length)

    def start(tag: str, attributes: dict[str, str]) -> None:
        name = tag.rpartition("}")[2]
        if len(stack) > MAX_NESTING:
            message = f"elements may nest at most {MAX_NESTING} deep"
            raise FaultError(message, TextPiece(name, here(len(name) + 1)), "too-deep")
        element = _Element(TextPiece(name, here(len(name) + 1)), attributes)
        stack[-1].children.append(element)
        stack.append(element)

    def add_text(data: str) -> None:
        stack[-1].pieces.append(data)

    def refuse(*_: object) -> None:
        message = "a document type (<!DOCTYPE …>) is not supported"
        raise FaultError(message, TextPiece("", here(9)), "unsupported-type")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.CharacterDataHandler = add_text
    parser.StartDoctypeDeclHandler = refuse
    parser.buffer_text = True
    try:
        parser.Parse(text.encode("utf-8", "replace"), True)
    except expat.ExpatError as error:
        line = min(error.lineno, text.count("\n") + 1)
        span = Span(line, error.offset + 1, line, error.offset + 2)
        message = f"not well-formed XML: {expat.ErrorString(error.code)}"
        raise FaultError(message, TextPiece("", span)) from None
    return root.children[0]


# --- Vocabulary of the standard ---

MODIFIERS = {
    "more_or_less": (Hedge("power", 1.0 / 3.0),),
    "plus": (Hedge("power", 1.25),),
    "norm": (),  # divides by the height, which is 1
}
"""Modifiers without a hedge of that name; `above`, `below` and `slightly` have no equivalent."""

_PAIRS = {
    "leftGaussianShape": "mean, deviation",
    "rightGaussianShape": "mean, deviation",
    "piShape": "start, top",
}
"""Shapes of two parameters with another shape here, and these parameters."""

_TNORMS_OF_SCHEMA = {"BSUM": "bounded", "DRS": "drastic"}
"""T-norms in the misspelling of the standard's schema."""

_DEFINED_ELSEWHERE = ("customShape", "customMonotonicShape")
"""Shapes defined by code outside the file."""

_CIRCULAR = "circularDefinition"
"""A term composed of other terms of its variable."""

RULE_BASES = {
    "mamdaniRuleBase": ("rule", "consequent", "then", "else", "clause"),
    "tsukamotoRuleBase": ("rule", "consequent", "then", "else", "clause"),
    "tskRuleBase": ("tskRule", "tskConsequent", "tskThen", "tskElse", "tskClause"),
}
"""Rule base → tags of its rules, consequents, their two halves and clauses."""

VARIABLES = {
    "fuzzyVariable": "fuzzyTerm",
    "tskVariable": "tskTerm",
    "tsukamotoVariable": "tsukamotoTerm",
}
"""Variable → tags of its terms."""


def parse_fml(
    text: str, path: str = "<text>", *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Read a fuzzy system: :func:`~fuzzyarm.exchange.formats.registry.parse` of ``.fml``.

    Parameters
    ----------
    text, path, lossy, strict
        As there.

    Returns
    -------
    Imported
        The rule base, if there is no error, and every finding.
    """

    def read(plain: str, findings: Findings) -> tuple[RuleBase | None, Dialect]:
        try:
            return _Reader(_parsed(plain), findings).read(), FML
        except FaultError as fault:
            findings.fault(fault)
            return None, FML

    return imported(text, path, read, lossy=lossy, strict=strict)


class _Reader(SystemReader):
    def __init__(self, root: _Element, findings: Findings) -> None:
        super().__init__(FML, findings)
        self.root = root
        self.elements: dict[str, _Element] = {}  # of outputs, by their names
        self.complements: set[tuple[str, str]] = set()  # variables and terms
        self.refused: set[str] = set()  # unsupported tags, names of such variables

    def read(self) -> RuleBase:
        if self.root.tag.text != "fuzzySystem":
            message = f"<{self.root.tag.text[:40]}> is not the <fuzzySystem> of an FML file"
            raise FaultError(message, self.root.tag, "no-engine")
        knowledge = list(self.root.child("knowledgeBase").children)
        self._refuse_others(knowledge, VARIABLES)
        self._refuse_others(self.root.children, ("knowledgeBase", *RULE_BASES))
        # The length of a linear consequent depends on the number of inputs.
        elements = [child for child in knowledge if child.tag.text in VARIABLES]
        input_names = {child.get("name").text for child in elements if not _is_output(child)}
        inputs = len(input_names - {""})
        for element in elements:
            self._variable(element, inputs)
        self.settle()
        self._estimate_ranges()
        blocks = [
            block
            for element in self.root.all(*RULE_BASES)
            for block in self._blocks(element, RULE_BASES[element.tag.text])
        ]
        if not self.outputs:
            self.findings.error("no-engine", "this file has no output", self.root.tag)
        elif not blocks and not self.findings.failed:
            self.findings.error("no-rules", "this file has no rule base", self.root.tag)
        return self.rulebase(self.root.get("name").text, self.in_model(blocks))

    def _estimate_ranges(self) -> None:
        """Estimate the range of an output of values, which has no domain, from these."""
        if self.findings.failed:
            return
        ends = {draft.name: (draft.low, draft.high) for draft in self.inputs}
        for draft in self.outputs:
            if draft.bounded or draft.integrates:
                continue
            values = range_of_values((term.shape for term in draft.terms), ends)
            if values is None:
                continue
            draft.low, draft.high = values
            message = (
                f"'{draft.name}' has no domain; its values span {draft.low:g} to {draft.high:g}"
            )
            self.findings.info("estimated-range", message, draft.word)

    def _refuse_others(self, elements: list[_Element], tags: Container[str]) -> None:
        for element in elements:
            if element.tag.text not in tags:
                self._refuse(element.tag, "unsupported-type")
                self.refused.add(element.get("name").text)

    def _refuse(self, tag: TextPiece, name: str) -> None:
        """Report an unsupported element, once for each tag."""
        if tag.text not in self.refused:
            self.refused.add(tag.text)
            self.findings.error(name, f"<{tag.text[:40]}> is not supported", tag)

    # --- Variables and terms ---

    def _variable(self, element: _Element, inputs: int) -> None:
        word = element.get("name")
        if not word.text:
            self.findings.error("missing-name", "the variable has no name", word)
            return
        draft = self.variable(word, is_output=_is_output(element))
        if draft is not self.variables.get(word.text):
            return
        self.elements[word.text] = element
        if element.tag.text != "tskVariable":
            ends = [element.get("domainleft"), element.get("domainright")]
            text = TextPiece(" ".join(end.text for end in ends), element.tag.span)
            draft.set_range(ends, text, self.findings, "two numbers, domainleft and domainright")
        draft.settle_range(self.findings)
        for term in self._by_dependence(list(element.all(VARIABLES[element.tag.text]))):
            name = term.get("name")
            shape = self._shape(term, draft, inputs)
            self.term(draft, name, shape)
            if shape is not None and term.get("complement").text.lower() == "true":
                self.complements.add((draft.name, name.text))

    def _by_dependence(self, terms: list[_Element]) -> list[_Element]:
        """Return the terms of a variable, each after its parts; a circular term stays."""
        parts = {term.get("name").text: _parts(term) for term in terms}
        places = {name: place for place, name in enumerate(parts)}
        depth: dict[str, int] = {}
        try:
            for name in TopologicalSorter(parts).static_order():
                below = [depth[part] for part in parts.get(name, ())]
                depth[name] = 1 + max(below) if below else 0
        except CycleError:
            depth = {name: int(bool(parts[name])) for name in parts}
        return sorted(terms, key=lambda term: (depth[name := term.get("name").text], places[name]))

    def _shape(self, term: _Element, draft: VariableDraft, inputs: int) -> Shape | None:
        if term.tag.text == "tskTerm":
            return self._value(term, inputs)
        if not term.children:
            message = f"the term '{term.get('name').text}' has no shape"
            self.findings.error("unknown-shape", message, term.tag)
            return None
        element = term.children[0]
        if element.tag.text in ("pointSetShape", "pointSetMonotonicShape"):
            return self._points(element)
        if element.tag.text == _CIRCULAR:
            return self._circular(element, draft)
        values = self._numbers(element, [f"param{index}" for index in range(1, 5)])
        return None if values is None else self._of_numbers(element.tag, values, draft, inputs)

    def _circular(self, element: _Element, draft: VariableDraft) -> Shape | None:
        """Return a set composed of other terms by norms."""
        if not draft.bounded:
            if not self.findings.failed:
                message = "a circularDefinition needs a variable with a range"
                self.findings.error("bad-range", message, element.tag)
            return None
        parts: list[Shape] = []
        norms: list[str] = []
        for operation in element.all("and", "or"):
            degree = self._joined(operation, draft, parts, norms)
            if degree is None:
                return None
            shape, exact = composed(degree, parts, norms, draft.low, draft.high)
            if not exact:
                message = f"a term that is composed of others is taken at {POINTS} points"
                self.findings.loss("unsupported-shape", message, element.tag, slight=True)
            return shape
        raise FaultError(f"<{_CIRCULAR}> has no <and> or <or>", element.tag)

    def _joined(
        self, element: _Element, draft: VariableDraft, parts: list[Shape], norms: list[str]
    ) -> Degree | None:
        """Return the degree below an *and* or an *or*; None if a term is invalid."""
        if element.tag.text == "and":
            norm = f"t:{self.tnorm(element.get('t-norm', 'MIN')) or 'min'}"
        else:
            norm = f"s:{self.snorm(element.get('t-conorm', 'MAX')) or 'max'}"
        norms.append(norm)
        operands: list[Degree | None] = []
        for child in element.all("termName", "and", "or"):
            if child.tag.text == "termName":
                operands.append(self._named_degree(child, draft, parts))
            else:
                operands.append(self._joined(child, draft, parts, norms))
        degrees = [degree for degree in operands if degree is not None]
        if len(operands) < 2:
            raise FaultError(f"<{element.tag.text}> joins two terms", element.tag)
        return norm_of(norm, degrees) if len(degrees) == len(operands) else None

    def _named_degree(
        self, element: _Element, draft: VariableDraft, parts: list[Shape]
    ) -> Degree | None:
        word = TextPiece(element.text, element.tag.span)
        term = draft.term(word.text)
        if term is None:
            if word.text not in draft.refused:
                names = [declared_term.name for declared_term in draft.terms]
                self.findings.no_term(draft.name, word, names)
            return None
        parts.append(term.shape)
        degree = membership_function(term.shape)
        if (draft.name, word.text) in self.complements:
            return lambda x: 1.0 - degree(x)
        return degree

    def _of_numbers(
        self, kind: TextPiece, values: list[float], draft: VariableDraft, inputs: int
    ) -> Shape | None:
        if kind.text in _PAIRS and len(values) != 2:
            message = f"{kind.text} takes 2 numbers ({_PAIRS[kind.text]}), not {len(values)}"
            self.findings.error("parameter-count", message, kind)
            return None
        if kind.text in ("leftGaussianShape", "rightGaussianShape"):
            return self._one_sided(kind, values, draft)
        if kind.text == "piShape":
            start, top = values  # flanks of equal width
            parameters = [start, top, top, top + abs(top - start)]
            return make_shape("pi", parameters, kind, self.findings)
        spellings = all_spellings(SHAPES, FML.kinds)
        if kind.text not in spellings:
            if kind.text in _DEFINED_ELSEWHERE:
                self._refuse(kind, "unsupported-shape")
            else:
                self.findings.unknown("unknown-shape", "the shape", kind, (*spellings, *_PAIRS))
            return None
        return spelled_shape(spellings[kind.text], values, inputs, kind, self.findings, FML)

    def _one_sided(
        self, kind: TextPiece, values: list[float], draft: VariableDraft
    ) -> Shape | None:
        """Return a gaussian flank that stays at 1 up to the end of the range."""
        mean, deviation = values
        ends = (draft.low, mean) if kind.text == "leftGaussianShape" else (mean, draft.high)
        left, right = min(ends), max(ends)
        if not (math.isfinite(left) and math.isfinite(right)):
            if not self.findings.failed:  # else the range has its own finding
                message = f"a {kind.text} needs a variable with a range"
                self.findings.error("bad-range", message, kind)
            return None
        parameters = [left, deviation, right, deviation]
        return make_shape("two-sided-gaussian", parameters, kind, self.findings)

    def _points(self, element: _Element) -> Shape | None:
        method = element.get("interpolationMethod", "linear")
        if method.text.lower() != "linear":
            message = f"points with the interpolation '{method.text[:40]}' are not supported"
            self.findings.error("unsupported-shape", message, method)
            return None
        values: list[float] = []
        for point in element.all("point"):
            pair = self._numbers(point, ["x", "y"])
            if pair is None:
                return None
            values += pair
        return make_shape("points", values, element.tag, self.findings)

    def _value(self, term: _Element, inputs: int) -> Shape | None:
        """Return a TSK consequent: a constant, or a constant and a factor for each input."""
        values = []
        for element in term.all("tskValue"):
            value = number(element.text)
            if value is None:
                message = f"'{element.text[:40]}' is not a number"
                self.findings.error("not-a-number", message, element.tag)
                return None
            values.append(value)
        if term.get("order", "0").text == "0":
            return make_shape("singleton", values[:1], term.tag, self.findings)
        if not 1 <= len(values) <= inputs + 1:
            message = (
                f"a linear term has a constant and a factor for each of the {inputs} inputs, "
                f"not {len(values)} numbers"
            )
            self.findings.error("parameter-count", message, term.tag)
            return None
        factors = [*values[1:], *[0.0] * (inputs + 1 - len(values))]
        return make_shape("linear", [*factors, values[0]], term.tag, self.findings)

    def _numbers(self, element: _Element, keys: list[str]) -> list[float] | None:
        """Return the values of attributes in this order, without the missing ones."""
        values: list[float] = []
        for key in keys:
            text = element.attributes.get(key)
            if text is None:
                continue
            value = number(text.strip())
            if value is None:
                message = f"{key}: {not_a_number(text.strip())}"
                self.findings.error("not-a-number", message, element.tag)
                return None
            values.append(value)
        return values

    def method_name(self, draft: VariableDraft) -> str:
        """Return the method of an output in the standard's case."""
        element = self.elements[draft.name]
        is_set = element.tag.text == "fuzzyVariable"
        key, usual = ("defuzzifier", "COG") if is_set else ("combination", "WA")
        draft.method = element.get(key, usual)
        return draft.method.text

    def finish_output(self, draft: VariableDraft, name: str) -> None:
        """Set the value without rules, and the defuzzifier of this kind of variable."""
        element = self.elements[draft.name]
        default = number(element.get("defaultValue", "0").text)
        if default is None:
            message = "the defaultValue is not a number"
            self.findings.error("not-a-number", message, element.tag)
        draft.no_rule = math.nan if default is None else default
        assert draft.method is not None
        if element.tag.text == "fuzzyVariable":
            draft.aggregation = self.snorm(element.get("accumulation", "MAX")) or "max"
            if draft.kinds == {"singleton"} and name in FML.integral:
                self._finish_singletons(draft, draft.method)
            elif self._is_known(draft.method, FML.integral):
                super().finish_output(draft, name)
            return
        self._is_known(draft.method, FML.weighted)
        draft.aggregation = "sum"  # every rule counts for itself
        is_tsk = element.tag.text == "tskVariable"
        draft.defuzzifier = Defuzzifier("weighted-average" if is_tsk else "tsukamoto")
        if not is_tsk and not all_invertible(draft.kinds):
            message = f"'{draft.name}' has terms that cannot be inverted"
            self.findings.error("not-monotonic", message, element.tag)

    def _finish_singletons(self, draft: VariableDraft, method: TextPiece) -> None:
        """Read the average of singletons as their centre of gravity, the highest as the winner."""
        draft.defuzzifier = Defuzzifier(FML.integral[method.text])
        if draft.defuzzifier.record.of == "top":
            return
        draft.defuzzifier = Defuzzifier("weighted-average")
        if method.text != "COG":
            message = f"{method.text} of singletons is not supported; their average is taken"
            self.findings.loss("unsupported-defuzzifier", message, method)

    def _is_known(self, method: TextPiece, table: Mapping[str, str]) -> bool:
        if method.text not in table:
            self.findings.unknown("unknown-defuzzifier", "the method", method, table)
        return method.text in table

    # --- Rules ---

    def _blocks(self, element: _Element, tags: tuple[str, ...]) -> list[BlockDraft]:
        """Return a block for each pair of norms among the rules of a rule base."""
        implication = element.get("activationMethod", "MIN")
        tnorm = "min" if tags[0] == "tskRule" else self.tnorm(implication)
        blocks: dict[tuple[str, str], BlockDraft] = {}
        for index, rule in enumerate(element.all(tags[0])):
            if not self.findings.room(index, MAX_RULES, "rules", rule.tag):
                break
            conjunction = rule.get("andMethod", element.get("andMethod", "MIN").text)
            disjunction = rule.get("orMethod", element.get("orMethod", "MAX").text)
            is_or = rule.get("connector", "and").text.lower() == "or"
            norms = (
                self.tnorm(conjunction if not is_or else element.get("andMethod", "MIN")) or "min",
                self.snorm(disjunction if is_or else element.get("orMethod", "MAX")) or "max",
            )
            if norms not in blocks:
                name = element.get("name").text if not blocks else ""
                blocks[norms] = BlockDraft(name, rule.tag.span, True, *norms, implication=tnorm)
            try:
                blocks[norms].rules += self._rules(rule, tags, is_or=is_or)
            except FaultError as fault:
                self.findings.fault(fault)
        return list(blocks.values())

    def tnorm(self, word: TextPiece, role: str = "the T-norm") -> str | None:
        """Return the T-norm of a word, also in the misspelling of the schema."""
        return _TNORMS_OF_SCHEMA.get(word.text.upper()) or super().tnorm(word, role)

    def _rules(self, rule: _Element, tags: tuple[str, ...], *, is_or: bool) -> Iterator[RuleText]:
        """Yield a rule, then one for its *else*, with the complement of the antecedent."""
        _, consequent, then, other, clause = tags
        antecedent = self._antecedent(rule, is_or=is_or)
        weight = number(rule.get("weight", "1").text)
        if weight is None or math.isnan(weight):
            raise FaultError("the weight is not a number", rule.tag, "not-a-number")
        for half in rule.child(consequent).all(then, other):
            hedges = () if half.tag.text == then else (NOT,)
            if hedged_weight(weight, hedges) is None:
                message = "an else with a weight cannot be converted"
                self.findings.loss("hedged-weight", message, half.tag)
            conclusions = self._conclusions(half, clause)
            yield RuleText(around(hedges, antecedent), conclusions, weight, rule.tag.span)

    def _antecedent(self, rule: _Element, *, is_or: bool) -> Expression:
        parts = tuple(
            Is(variable.text, term, hedges, variable.span)
            for variable, term, hedges in self._clauses(rule.child("antecedent"), "clause")
        )
        if not parts:
            raise FaultError("the rule has no condition", rule.tag, "empty-rule")
        for part in parts:
            if part.variable in self.variables and self.variables[part.variable].is_output:
                message = f"'{part.variable}' is an output; a condition on it is not supported"
                self.findings.error("chained-output", message, part.span)
        if len(parts) == 1:
            return parts[0]
        return Or(parts) if is_or else And(parts)

    def _conclusions(self, half: _Element, tag: str) -> tuple[Consequent, ...]:
        conclusions = tuple(
            Consequent(variable.text, term, hedges, variable.span)
            for variable, term, hedges in self._clauses(half, tag)
        )
        if not conclusions:
            raise FaultError("the rule has no conclusion", half.tag, "empty-rule")
        for conclusion in conclusions:
            draft = self.variables.get(conclusion.variable)
            if draft is not None and not draft.is_output:
                message = f"'{conclusion.variable}' is an input; a rule cannot conclude on it"
                self.findings.error("not-an-output", message, conclusion.span)
        return conclusions

    def _clauses(
        self, element: _Element, tag: str
    ) -> Iterator[tuple[TextPiece, str, tuple[Hedge, ...]]]:
        """Yield variable, term and hedges of each clause."""
        for clause in element.all(tag):
            variable, term = clause.word("variable"), clause.word("term")
            draft = self.variables.get(variable.text)
            if variable.text in self.refused:
                pass
            elif draft is None:
                self.findings.unknown(
                    "undefined-variable", "the variable", variable, self.variables
                )
            elif draft.term(term.text) is None and term.text not in draft.refused:
                names = [declared_term.name for declared_term in draft.terms]
                self.findings.no_term(draft.name, term, names)
            hedges = self._hedges(clause.get("modifier"))
            if (variable.text, term.text) in self.complements:
                hedges = (*hedges, NOT)
            yield variable, term.text, hedges

    def _hedges(self, word: TextPiece) -> tuple[Hedge, ...]:
        if not word.text:
            return ()
        plain_hedges = {key: (Hedge(name),) for key, name in words(HEDGES, FML.kinds).items()}
        hedges = plain_hedges | MODIFIERS
        if word.text not in hedges:
            message = f"the modifier '{word.text[:40]}' is not supported"
            self.findings.loss("unsupported-hedge", message, word)
        return hedges.get(word.text, ())


def _parts(term: _Element) -> list[str]:
    """Return the names of the component terms of a term."""
    names: list[str] = []
    waiting = list(term.all(_CIRCULAR))
    while waiting:
        element = waiting.pop()
        names += [child.text for child in element.all("termName")]
        waiting += element.all("and", "or")
    return names


def _is_output(element: _Element) -> bool:
    usual = "input" if element.tag.text == "fuzzyVariable" else "output"
    return element.get("type", usual).text.lower() == "output"
