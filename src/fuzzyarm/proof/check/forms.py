"""Affine forms: a centre and weights of symbols that are anywhere in -1 .. 1, in balls.

What is linear keeps its symbols, so that sets turn and shrink with the motion. What is not adds a
symbol of its own for how far it may be from a line: a product, a function (mean value theorem), a
corner (the chord), a rule base (the band around a plane through its values, on its exact pieces).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from flint import arb

from fuzzyarm.language.model.rulebase import RuleBase, Variable
from fuzzyarm.proof.check.numbers import (
    ONE,
    Number,
    SpanError,
    around,
    exact,
    is_zero,
    magnitude,
    middle,
    radius,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, applied
from fuzzyarm.table import LookupTable

__all__ = ["Form", "FormNumbers", "combined"]


class Form(NamedTuple):
    """A value that is affine in symbols; `ends` are what a limit does not let it leave."""

    centre: Number
    weights: Mapping[int, Number]
    ends: tuple[float, float] = (-math.inf, math.inf)

    @property
    def reach(self) -> Number:
        """How far it may be from its centre."""
        return sum((magnitude(x) for x in self.weights.values()), arb(0))

    @property
    def span(self) -> Number:
        """Where it is."""
        return around(self.centre, self.reach) if self.weights else self.centre


def combined(*terms: tuple[Form, Number]) -> Form:
    """Return Σ factor · form."""
    centre, weights = arb(0), dict[int, Number]()
    for form, factor in terms:
        centre = centre + form.centre * factor
        for symbol, x in form.weights.items():
            part = x * factor
            weights[symbol] = weights[symbol] + part if symbol in weights else part
    return Form(centre, {symbol: x for symbol, x in weights.items() if not is_zero(x)})


LINEAR = {"add": ONE, "subtract": -ONE}


class FormNumbers:
    """Affine forms, for a walk over the program."""

    def __init__(self, surfaces: RuleSurfaces) -> None:
        self.surfaces = surfaces
        self.symbols = 0

    def symbol(self, far: Number) -> Form:
        """Return a new symbol of a weight: anything that is not further from 0."""
        self.symbols += 1
        return Form(arb(0), {} if is_zero(far) else {self.symbols: arb(far)})

    def number(self, value: float) -> Form:
        """Return a number of the program."""
        return Form(exact(value), {})

    def apply(self, operation: str, arguments: list[Form]) -> Any:
        """Return an operation; of a condition a bool."""
        if not any(x.weights for x in arguments):
            plain = applied(operation, [Slope(x.centre, {}) for x in arguments])
            return plain if isinstance(plain, bool) else Form(plain.value, {})
        if operation in LINEAR:
            a, b = arguments
            return combined((a, ONE), (b, LINEAR[operation]))
        if operation == "negative":
            return combined((arguments[0], -ONE))
        if operation == "multiply":
            a, b = arguments
            product = combined((b, a.centre), (a, b.centre), (Form(a.centre * b.centre, {}), -ONE))
            return combined((product, ONE), (self.symbol(a.reach * b.reach), ONE))
        if operation in ("minimum", "maximum"):
            a, b = arguments
            sign = ONE if operation == "maximum" else -ONE
            return combined((b, ONE), (self._positive(combined((a, sign), (b, -sign))), sign))
        return self._by_slopes(operation, arguments)

    def _positive(self, x: Form) -> Form:
        """Return max(x, 0): between λ x and λ (x − low), where λ = high/(high − low)."""
        span = x.span
        if span <= 0:
            return Form(arb(0), {})
        if span >= 0:
            return x
        low, high = arb(span).lower(), arb(span).upper()
        share = high / (high - low)
        half = share * low / -2
        raised = combined((x, share), (Form(half, {}), ONE))
        return combined((raised, ONE), (self.symbol(magnitude(half)), ONE))

    def _by_slopes(self, operation: str, arguments: list[Form]) -> Any:
        spans = [Slope(x.span, {str(k): ONE} if x.weights else {}) for k, x in enumerate(arguments)]
        over = applied(operation, spans)
        if isinstance(over, bool):
            return over
        at = applied(operation, [Slope(x.centre, {}) for x in arguments]).value
        terms, far = [(Form(at, {}), ONE)], arb(0)
        for k, x in enumerate(arguments):
            slope = over.along.get(str(k))
            if slope is not None:
                away = Form(arb(0), x.weights)
                terms.append((away, middle(slope)))
                far = far + radius(slope) * x.reach
        return combined(*terms, (self.symbol(magnitude(far)), ONE))

    def limit(self, x: Form, low: float, high: float) -> Form:
        """Return ``min(max(x, low), high)``."""
        ends = max(x.ends[0], low), min(x.ends[1], high)
        for operation, end in (("maximum", low), ("minimum", high)):
            if math.isfinite(end):
                x = self.apply(operation, [x, self.number(end)])
        return x._replace(ends=ends)

    def rules(self, sheet: RuleBase, output: str, inputs: Mapping[str, Form]) -> Form:
        """Return the conclusion of a rule base: a plane, and a band around it."""
        inputs = {v.name: self._brought(inputs[v.name], v) for v in sheet.inputs}
        band, plane = self.surfaces(sheet, output).band({n: x.span for n, x in inputs.items()})
        terms = [(inputs[name], slope) for name, slope in plane.items()]
        base = Form(middle(band), {})
        return combined(*terms, (base, ONE), (self.symbol(radius(band)), ONE))

    def _brought(self, x: Form, variable: Variable) -> Form:
        """Return an input as a rule base takes it."""
        if variable.outside == "clamp":
            return self.limit(x, variable.low, variable.high)
        if variable.outside == "error" and not (
            arb(variable.low) <= x.span and x.span <= arb(variable.high)
        ):
            raise SpanError(f"'{variable.name}' may be outside its range, where there is no value")
        return x

    def table(self, sheet: LookupTable, inputs: Mapping[str, Form]) -> Form:
        """Refuse a table."""
        raise SpanError("a table is not followed")
