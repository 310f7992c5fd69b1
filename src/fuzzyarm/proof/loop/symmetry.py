"""Odd loops: a result for a start holds for the opposite one, so that half of a map is enough.

A loop is odd if negating all states and memory negates the inputs of the plant, memory, rates and
outputs of a period. Every number of the walk is a constant, odd or even in them; any other number
makes the loop not odd.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from fractions import Fraction

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.language.model.rulebase import (
    And,
    Hedged,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    Shape,
    Variable,
)
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.loop.period import LoopAlgebra, LoopPeriod
from fuzzyarm.proof.loop.readings import pruned
from fuzzyarm.symbolic.kinds import SHAPES
from fuzzyarm.symbolic.nodes import Apply, Node, fold
from fuzzyarm.table import LookupTable

ODD, EVEN = "odd", "even"

Parity = Fraction | str
"""A constant, exact since rounding may give 0; or the parity of a number."""

ODD_FUNCTIONS = frozenset({"sin", "tan", "asin", "atan", "sinh", "tanh"})
EVEN_FUNCTIONS = frozenset({"cos", "cosh", "absolute"})


class _NotOddError(Exception):
    """A number is not known to be odd or even."""


def is_odd(problem: LoopProblem) -> bool:
    """Return whether a loop is known to be odd, its starts outside of a window included."""
    turned = all(-span.low == span.high for span in problem.start.values())
    if not turned or problem.moved or any(problem.set_point.values()):
        return False
    try:
        _demand_odd(problem)
    except (_NotOddError, FuzzyarmError):
        return False
    return True


def _demand_odd(problem: LoopProblem) -> None:
    equations, interface = problem.equations, problem.site.interface
    values: dict[str, Parity] = dict.fromkeys((*equations.states, *equations.inputs), ODD)
    spans = zip(equations.parameters, problem.parameters.values(), strict=True)
    values |= {name: _constant(x.low) if x.low == x.high else EVEN for name, x in spans}
    values["t"] = Fraction(0)
    algebra = _Parities()
    rates = [algebra.expression(root, values) for root in equations.rates]
    outputs = [algebra.expression(root, values) for root in equations.outputs]
    period = LoopPeriod[Parity](problem, algebra)
    if any(start for start in period.memory.values() if not math.isnan(start)):
        raise _NotOddError
    seen = dict(zip(interface.outputs, outputs, strict=True))
    for first in (True, False):
        memory = {} if first else dict.fromkeys(period.memory, ODD)
        inputs, after = period.run(seen, memory, first=first)
        for x in (*rates, *outputs, *inputs.values(), *after.values()):
            _demand(x)


def _demand(x: Parity) -> None:
    if x not in (ODD, 0):
        raise _NotOddError


class _Parities(LoopAlgebra[Parity]):
    """The algebra of constants and parities."""

    def number(self, value: float) -> Parity:
        """Return a number of the file."""
        return _constant(value)

    def add(self, a: Parity, b: Parity) -> Parity:
        """Return a sum of numbers with one parity."""
        if isinstance(a, Fraction) and isinstance(b, Fraction):
            return a + b
        if 0 in (a, b):
            return b if a == 0 else a
        if _kind(a) != _kind(b):
            raise _NotOddError
        return _kind(a)

    def subtract(self, a: Parity, b: Parity) -> Parity:
        """Return a difference."""
        return self.add(a, -b if isinstance(b, Fraction) else b)

    def multiply(self, a: Parity, b: Parity) -> Parity:
        """Return a product."""
        if isinstance(a, Fraction) and isinstance(b, Fraction):
            return a * b
        if 0 in (a, b):
            return Fraction(0)
        return EVEN if _kind(a) == _kind(b) else ODD

    def divide(self, a: Parity, b: Parity) -> Parity:
        """Return a quotient."""
        if isinstance(a, Fraction) and isinstance(b, Fraction) and b:
            return a / b
        return self.multiply(a, ODD if b == ODD else EVEN)

    def limit(self, x: Parity, low: float, high: float) -> Parity:
        """Return ``min(max(x, low), high)``."""
        if isinstance(x, Fraction):
            return _constant(min(max(float(x), low), high)) if not low <= x <= high else x
        if x == ODD and low != -high:
            raise _NotOddError
        return x

    def rate_limited(self, x: Parity, before: Parity, most: float) -> Parity:
        """Return ``min(max(x, before - most), before + most)``."""
        return self.add(x, before)

    def expression(self, root: Node, values: Mapping[str, Parity]) -> Parity:
        """Return the parity of an expression."""
        # Without branches that numbers rule out; the numbers themselves are exact.
        constants = {n: float(x) for n, x in values.items() if isinstance(x, Fraction)}
        root = pruned(root, constants)
        return fold([root], values, _constant, self._applied)[0]

    def _applied(self, node: Apply, of: list[Parity]) -> Parity:
        operation = node.operation
        if operation in ("add", "subtract", "multiply", "divide"):
            found: Parity = getattr(self, operation)(*of)
            return found
        if operation == "negative":
            return self.subtract(Fraction(0), of[0])
        if operation in ODD_FUNCTIONS and of[0] in (ODD, 0):
            return of[0]
        if operation in EVEN_FUNCTIONS or all(_kind(x) == EVEN for x in of):
            return EVEN
        if operation == "power" and isinstance(of[1], Fraction) and of[1].denominator == 1:
            return EVEN if of[1] % 2 == 0 else _kind(of[0])
        raise _NotOddError

    def rules(self, rulebase: RuleBase, inputs: Mapping[str, Parity]) -> list[Parity]:
        """Return the conclusions of an odd rule base."""
        for x in inputs.values():
            _demand(x)
        if not _is_odd_rulebase(rulebase):
            raise _NotOddError
        return [ODD for _ in rulebase.outputs]

    def table(self, table: LookupTable, inputs: Mapping[str, Parity]) -> Parity:
        """Refuse a table."""
        raise _NotOddError

    def error(self, x: Parity, size: float) -> Parity:
        """Refuse a sensor with a resolution."""
        raise _NotOddError


def _kind(x: Parity) -> str:
    return EVEN if isinstance(x, Fraction) else x


def _constant(value: float | Fraction) -> Fraction:
    if not math.isfinite(value):
        raise _NotOddError
    return Fraction(value)


# ── rule bases ───────────────────────────────────────────────────────────────────────


def _is_odd_rulebase(rulebase: RuleBase) -> bool:
    """Return whether a rule base with all of its terms mirrored is the same."""
    if rulebase.is_type2 or not all(_is_plain(output) for output in rulebase.outputs):
        return False
    names = {v.name: _opposites(v) for v in (*rulebase.inputs, *rulebase.outputs)}
    for block in rulebase.blocks:
        rules = Counter(_key(rule, {}) for rule in block.rules)
        try:
            if rules != Counter(_key(rule, names) for rule in block.rules):
                return False
        except KeyError:  # a term without a mirror image
            return False
    return True


def _is_plain(output: Output) -> bool:
    way = output.defuzzifier.record
    plain = way.figure in ("centroid", "average", "weighted") and not (way.inverts or way.both)
    # Another number, or the last value, is not odd.
    is_odd_without_rule = output.no_rule in ("error", 0.0)
    return plain and is_odd_without_rule and output.defuzzifier.resolution is None


def _opposites(variable: Variable) -> dict[str, str]:
    """Return the mirror image of each term of a variable."""
    if variable.low != -variable.high:
        return {}
    by_shape = {_corners(term.shape, 1.0): term.name for term in variable.terms}
    found = {term.name: by_shape.get(_corners(term.shape, -1.0)) for term in variable.terms}
    return {name: other for name, other in found.items() if other is not None}


def _corners(shape: Shape, sign: float) -> tuple[object, ...]:
    """Return the key of a shape, or of its mirror image."""
    if shape.kind in ("singleton", "linear"):
        *weights, constant = shape.parameters
        return shape.kind, *weights, sign * constant
    if shape.kind == "formula" or not SHAPES[shape.kind].straight:
        raise _NotOddError
    corners = [(sign * x + 0.0, y) for x, y in polyline(shape)]
    return tuple(corners if sign > 0 else corners[::-1])


def _key(rule: Rule, names: Mapping[str, Mapping[str, str]]) -> tuple[object, ...]:
    """Return a rule with its terms replaced by the given ones."""

    def term(variable: str, name: str) -> str:
        return names[variable][name] if names else name

    def key(node: object) -> tuple[object, ...]:
        if isinstance(node, Is):
            return node.variable, term(node.variable, node.term), node.hedges
        if isinstance(node, Hedged):
            return node.hedges, key(node.operand)
        assert isinstance(node, And | Or)
        return type(node).__name__, frozenset(Counter(map(key, node.operands)).items())

    then = frozenset((c.variable, term(c.variable, c.term), c.hedges) for c in rule.consequents)
    return key(rule.antecedent), then, rule.weight
