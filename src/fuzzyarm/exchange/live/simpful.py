"""simpful: from a ``FuzzySystem`` to a rule base.

Mamdani systems are summed over 1000 points, both ends included, and are 0 if no rule fires.
Sugeno systems divide the sum of strength × value × weight by the sum of the strengths, so a weight
is a factor on the value. Objects are recognised by their attributes; simpful itself is not
imported.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import Any

from fuzzyarm.exchange.formats.drafts import blocks_by_norms
from fuzzyarm.exchange.formats.findings import Findings, Imported, TextPiece, reading, written
from fuzzyarm.exchange.formats.recovery import even_family, shape_of
from fuzzyarm.exchange.formats.sentences import NOT, hedged
from fuzzyarm.exchange.formats.shapes import estimated_range
from fuzzyarm.exchange.live.functions import input_of, output_of_values, shape_or_points, terms_of
from fuzzyarm.exchange.live.python_formulas import text_shape
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Hedge,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    Shape,
    propositions,
)
from fuzzyarm.symbolic.formulas import FormulaError

SUBDIVISIONS = 1000
"""Default number of points of ``inference()``."""

_NORMS = {"AND": "min", "AND_p": "product", "OR": "max", "OR_p": "probor"}


def simpful_numbers(system: Any) -> Callable[[Mapping[str, float]], dict[str, float]]:
    """Return a function that evaluates a system in simpful and restores its values."""
    system = copy(system)
    system._variables = dict(system._variables)

    def numbers(values: Mapping[str, float]) -> dict[str, float]:
        for name, value in values.items():
            system.set_variable(name, value)
        results = system.inference(ignore_warnings=True)
        return {name: float(value) for name, value in results.items()}

    return numbers


def from_simpful(
    system: Any, name: str = "system", *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Return the rule base of a fuzzy system, with the semantics of ``inference()``."""
    findings = Findings(lossy=lossy, strict=strict)
    reader = _Reader(system, findings)
    rulebase = reader.rulebase(name)
    return findings.imported(rulebase, "simpful")


class _Reader:
    """Reader of one system."""

    def __init__(self, system: Any, findings: Findings) -> None:
        self.system = system
        self.findings = findings
        self.variables: dict[str, Any] = dict(system._lvs)
        self.sugeno = system._detected_type == "Sugeno"

    def rulebase(self, name: str) -> RuleBase | None:
        if self.system._detected_type not in (None, "Sugeno"):
            message = f"to simpful the type of this system is '{self.system._detected_type}'"
            self.findings.error("unknown-type", message)
            return None
        rules = [self._rule(number, *rule) for number, rule in enumerate(self.system._rules, 1)]
        readings = [rule for rule in rules if rule is not None]
        if not rules:
            self.findings.error("no-rules", "the system has no rules")
        if not readings or self.findings.failed:
            return None
        names = [part.variable for _, rule in readings for part in propositions(rule.antecedent)]
        inputs = [n for n in self.variables if n in set(names)]
        concluded = list(dict.fromkeys(rule.consequents[0].variable for _, rule in readings))
        self._note_both(inputs, concluded)
        variables = tuple(self._input(variable) for variable in inputs)
        output = self._values if self.sugeno else self._sets
        outputs = tuple(
            output(label, variables, [rule for _, rule in readings]) for label in concluded
        )
        return RuleBase(name, variables, outputs, blocks_by_norms(readings))

    def _note_both(self, inputs: list[str], concluded: list[str]) -> None:
        for name in concluded:
            if name in inputs:
                message = (
                    f"'{name}' is concluded and asked for: simpful asks for the value that was "
                    "set, not for the one it computes"
                )
                self.findings.error("chained-output", message)
            if name in self.system._constants:
                message = f"'{name}' is set constant: simpful returns that whatever the rules say"
                self.findings.loss("constant-output", message)
        for name in self.variables:
            if name not in inputs and name not in concluded:
                self.findings.info("unused-variable", f"no rule uses '{name}'; it is left out")

    # --- Rules ---

    def _rule(
        self, number: int, antecedent: Any, consequent: Sequence[str]
    ) -> tuple[tuple[str, str], Rule] | None:
        connectives: set[str] = set()
        if len(consequent) not in (2, 3):
            message = f"rule {number} concludes {len(consequent) // 2} outputs; simpful takes one"
            self.findings.error("rule-too-rich", message)
            return None
        variable, term, *weight = consequent
        expression = self._expression(antecedent, connectives, number)
        is_known = self._known_conclusion(variable, term, number)
        if expression is None or not is_known:
            return None
        if len(connectives & {"AND", "AND_p"}) > 1 or len(connectives & {"OR", "OR_p"}) > 1:
            message = f"rule {number} mixes norms, which one rule cannot do here"
            self.findings.error("mixed-norms", message)
        norms = (
            "product" if "AND_p" in connectives else "min",
            "probor" if "OR_p" in connectives else "max",
        )
        factor = float(weight[0]) if weight else 1.0
        if self.sugeno and factor != 1.0:
            # A factor on the value makes another value; `_value` splits its name.
            return norms, Rule(expression, (Consequent(variable, f"{term}*{written(factor)}"),))
        if self.sugeno:
            return norms, Rule(expression, (Consequent(variable, term),))
        conclusion = Consequent(variable, *self._term(variable, term))
        return norms, Rule(expression, (conclusion,), factor)

    def _term(self, variable: str, term: str) -> tuple[str, tuple[Hedge, ...]]:
        """Return a term and hedges as in rules: an inverse gaussian is a complement."""
        inverse = (
            fuzzy_set for fuzzy_set in self.variables[variable]._FSlist if fuzzy_set._term == term
        )
        return (_complement(term), (NOT,)) if any(map(_is_inverse, inverse)) else (term, ())

    def _known_conclusion(self, variable: str, term: str, number: int) -> bool:
        if self.sugeno:
            names = [*self.system._crispvalues, *self.system._outputfunctions]
            if term not in names:
                where = f"in rule {number}, the value"
                self.findings.unknown("undefined-term", where, TextPiece(term), names)
            return term in names
        return self._known(variable, term, number)

    def _known(self, variable: str, term: str, number: int) -> bool:
        if variable not in self.variables:
            where = f"in rule {number}, the variable"
            self.findings.unknown("undefined-variable", where, TextPiece(variable), self.variables)
            return False
        terms = [fuzzy_set._term for fuzzy_set in self.variables[variable]._FSlist]
        if term not in terms:
            self.findings.no_term(variable, TextPiece(term), terms, f"in rule {number}, ")
        return term in terms

    def _expression(self, part: Any, used: set[str], number: int) -> Expression | None:
        if hasattr(part, "_term"):
            if not self._known(part._variable, part._term, number):
                return None
            return Is(part._variable, *self._term(part._variable, part._term))
        function = getattr(part, "_fun", None)
        if function == "NOT":
            inner = self._expression(part._B, used, number)
            return hedged((NOT,), inner) if inner is not None else None
        if function not in _NORMS:
            message = f"rule {number} has the operator '{function}'" if function else (
                f"rule {number} has no condition"
            )  # fmt: skip
            self.findings.error("unknown-norm" if function else "empty-rule", message)
            return None
        used.add(function)
        joined_by = And if function.startswith("AND") else Or
        operands: list[Expression] = []
        for operand in (part._A, part._B):
            inner = self._expression(operand, used, number)
            if inner is None:
                return None
            operands += inner.operands if isinstance(inner, joined_by) else (inner,)
        return joined_by(tuple(operands))

    # --- Variables ---

    def _input(self, name: str) -> Input:
        low, high, shapes = self._range_and_shapes(name)
        is_read = bool(self.system._outputfunctions)  # functions read inputs without a clamp
        return input_of(name, low, high, shapes, self._description(name), read_beyond=is_read)

    def _sets(self, name: str, _inputs: tuple[Input, ...], _rules: list[Rule]) -> Output:
        low, high, shapes = self._range_and_shapes(name)
        points = [low + (high - low) * i / (SUBDIVISIONS - 1) for i in range(SUBDIVISIONS)]
        even = even_family(list(shapes.values()), low, high, points)
        shapes = dict(zip(shapes, even, strict=True)) if even else shapes
        return Output(
            name, low, high, terms_of(shapes), self._description(name), "extend",
            defuzzifier=Defuzzifier("centroid", SUBDIVISIONS, "endpoints"), no_rule=0.0,
        )  # fmt: skip

    def _description(self, name: str) -> str:
        concept = str(self.variables[name]._concept or "")
        return "" if concept == name else concept

    def _range_and_shapes(self, name: str) -> tuple[float, float, dict[str, Shape]]:
        variable = self.variables[name]
        try:
            low, high = map(float, variable.get_universe_of_discourse())
        except Exception:  # simpful's own exception, or that of an index
            low, high = -math.inf, math.inf
        finite = -math.inf < low < high < math.inf
        shapes: dict[str, Shape] = {}
        for fuzzy_set in variable._FSlist:
            with reading(f"the term '{fuzzy_set._term}' of '{name}'"):
                shape = self._shape(fuzzy_set, name, *((low, high) if finite else (-1e3, 1e3)))
            if fuzzy_set._term in shapes:
                message = f"'{name}' has two terms called '{fuzzy_set._term}'"
                self.findings.error("duplicate-term-name", message)
            shapes[_complement(fuzzy_set._term) if _is_inverse(fuzzy_set) else fuzzy_set._term] = (
                shape
            )
        if not finite:
            low, high = estimated_range(list(shapes.values())) or (0.0, 1.0)
            message = f"'{name}' has no universe of discourse; {low:g} to {high:g} by its terms"
            self.findings.info("estimated-range", message)
        return low, high, shapes

    def _shape(self, term: Any, variable: str, low: float, high: float) -> Shape:
        """Return the shape of a set by the class of its function, or from samples."""
        function = getattr(term, "_funpointer", None)
        maker = _CLASSES.get(type(function).__name__)
        shape = maker(function) if maker else None
        if shape is not None:
            return shape
        if function is None:  # a set of points
            return shape_of(term.get_value, low, high) or _polygon(term)
        words = f"'{term._term}' of '{variable}' is a user-defined function,"
        return shape_or_points(lambda x: float(term.get_value(x)), low, high, words, self.findings)

    # --- Values of Sugeno systems ---

    def _values(self, name: str, inputs: tuple[Input, ...], rules: list[Rule]) -> Output:
        term_names = [c.term for rule in rules for c in rule.consequents if c.variable == name]
        shapes = {term: self._value(term, inputs) for term in dict.fromkeys(term_names)}
        return output_of_values(name, terms_of(shapes), inputs, self.findings)

    def _value(self, term: str, inputs: tuple[Input, ...]) -> Shape:
        name, _, weight = term.partition("*")
        factor = float(weight) if weight else 1.0
        if name in self.system._crispvalues:
            return Shape("singleton", (factor * float(self.system._crispvalues[name]),))
        text = str(self.system._outputfunctions.get(name, "0"))
        names = [variable.name for variable in inputs]
        try:
            return text_shape(text, names, factor)
        except (SyntaxError, ValueError, FormulaError) as error:
            message = f"the function '{text[:60]}' of '{name}': {error}"
            self.findings.error("bad-formula", message)
            return Shape("singleton", (0.0,))


# --- Sets by the class of their function ---


def _triangle(f: Any) -> Shape:
    return _shoulders(f._a, f._b, f._b, f._c)


def _shoulders(a: float, b: float, c: float, d: float) -> Shape:
    """Return a trapezoid; equal numbers are an endless shoulder in simpful."""
    left, right = (-math.inf if a == b else float(a)), (math.inf if c == d else float(d))
    if left > -math.inf and right == math.inf:
        return Shape("ramp", (left, float(b)))
    if left == -math.inf and right < math.inf:
        return Shape("ramp", (right, float(c)))
    if b == c and math.isfinite(right):
        return Shape("triangle", (left, float(b), right))
    top = (-math.inf, math.inf) if right == math.inf else (float(b), float(c))
    return Shape("trapezoid", (left, *top, right))


def _two_sided(f: Any) -> Shape | None:
    numbers = (f._mu1, abs(f._sigma1), f._mu2, abs(f._sigma2))
    return Shape("two-sided-gaussian", tuple(map(float, numbers))) if f._mu1 <= f._mu2 else None


def _singleton(f: Any) -> Shape | None:
    if len(f._pairs) != 1:
        return None
    ((x, degree),) = f._pairs
    return Shape("singleton", (float(x),), float(degree))


def _is_inverse(term: Any) -> bool:
    return type(getattr(term, "_funpointer", None)).__name__ == "InvGaussian_MF"


def _complement(term: str) -> str:
    return f"complement of {term}"


def _gaussian(f: Any) -> Shape:
    return Shape("gaussian", (float(f._mu), abs(float(f._sigma))))


_CLASSES: dict[str, Callable[[Any], Shape | None]] = {
    "Triangular_MF": _triangle,
    "Trapezoidal_MF": lambda f: _shoulders(f._a, f._b, f._c, f._d),
    "Sigmoid_MF": lambda f: Shape("sigmoid", (float(f._c), float(f._a))),
    "InvSigmoid_MF": lambda f: Shape("sigmoid", (float(f._c), -float(f._a))),
    "Gaussian_MF": _gaussian,
    "InvGaussian_MF": _gaussian,
    "DoubleGaussian_MF": _two_sided,
    "Crisp_MF": lambda f: Shape("rectangle", (float(f._left), float(f._right))),
    "Singletons_MF": _singleton,
}


def _polygon(term: Any) -> Shape:
    """Return piecewise-linear points, constant beyond them."""
    points = [(float(x), float(y)) for x, y in term._points]
    first, last = map(float, term.boundary_values)
    if first != points[0][1]:
        points.insert(0, (math.nextafter(points[0][0], -math.inf), first))
    if last != points[-1][1]:
        points.append((math.nextafter(points[-1][0], math.inf), last))
    return Shape("points", tuple(value for point in points for value in point))
