"""Evidence against a statement: points and pairs of points at which it fails.

A point is found in exact arithmetic. As evidence it is an ``expect`` line: rounded to few digits,
with the value that inference computes there, if the statement fails there as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.model.rulebase import Property
from fuzzyarm.proof.map.bounds import LIKE_EXPECT
from fuzzyarm.proof.map.prover import Prover, point_text

if TYPE_CHECKING:
    from fuzzyarm.inference.trace import Trace

_IN_EXACT_ARITHMETIC = "in exact arithmetic, by less than the rounding of inference"

Pair = tuple[Mapping[str, float], Mapping[str, float]]
"""Two points of floats."""


class Evidence:
    """Points at which a statement fails.

    Parameters
    ----------
    prover : Prover
        The prover of its output.
    claim : Property
        The statement.

    Attributes
    ----------
    failing : list of dict of str to float
        The points noted so far.
    remark : str
        A sentence about a failure that inference hides by its rounding.
    """

    def __init__(self, prover: Prover, claim: Property) -> None:
        self.prover, self.claim = prover, claim
        self.rulebase = prover.rulebase
        self.region = {name: (low, high) for name, low, high in claim.region}
        self.failing: list[dict[str, float]] = []
        self.remark = ""

    def without_rule(self, at: Mapping[str, Any]) -> str:
        """Report a point without a firing rule, and whether floats agree."""
        from fuzzyarm.inference import compiled, explain

        self.note(at)
        text = f"no rule fires at {point_text(at)}"
        outputs = tuple(replace(output, no_rule=math.nan) for output in self.rulebase.outputs)
        unstated = replace(self.rulebase, outputs=outputs)
        point = {name: float(x) for name, x in at.items()}
        fires = self.claim.output not in compiled(unstated).outcome(point).without_value or (
            self.claim.kind == "covered" and self._is_asserted(explain(unstated, point))
        )
        return f"{text}, {_IN_EXACT_ARITHMETIC}" if fires else text

    def _is_asserted(self, trace: Trace) -> bool:
        """Whether a rule fires for the output."""
        outputs = {output.name: output for output in trace.outputs}
        return bool(outputs[self.claim.output].consequents)

    def note(self, at: Mapping[str, Any]) -> None:
        """Record a point of failure, for a refutation."""
        self.failing.append({name: float(x) for name, x in at.items()})

    def inferred(self, at: Mapping[str, Any]) -> float | None:
        """Return the output at a point by inference; None without a value."""
        from fuzzyarm.inference import infer

        point = {name: float(x) for name, x in at.items()}
        try:
            value = infer(self.rulebase, point)[self.claim.output]
        except FuzzyarmError:
            return None
        return None if math.isnan(value) else value

    def confirmed(
        self, at: Mapping[str, float], fails: Callable[[Fraction], bool]
    ) -> tuple[str, ...] | None:
        """Return a point as evidence, if the statement fails there in exact arithmetic.

        Preferred is the point with the fewest digits at which inference fails, too. Without exact
        pieces inference alone decides, by more than the tolerance of an `expect` line.
        """
        for digits in (0, 1, 2, 3, 6, None):
            near = self._rounded(at, digits)
            value = self.inferred(near)
            if value is None or not fails(Fraction(value)):
                continue
            if self.prover.model is None:
                outcome = self.prover.no_rule
                if value != outcome and not self.fails_clearly(fails, value):
                    continue
            else:
                exact = self.prover.exactly(near)
                if exact is None or not fails(exact):
                    continue
            return (self.expect(near, value),)
        return None

    def fails_clearly(self, fails: Callable[[Fraction], bool], value: float) -> bool:
        """Return whether a statement fails for all values within the tolerance of `expect`."""
        slack = LIKE_EXPECT * self.prover.range
        return fails(Fraction(value - slack)) and fails(Fraction(value + slack))

    def shown(
        self, at: Mapping[str, float | Fraction], fails: Callable[[Fraction], bool]
    ) -> tuple[str, ...]:
        """Return a point of failure as evidence, or a sentence if inference hides it."""
        near = {name: float(x) for name, x in at.items()}
        confirmed = self.confirmed(near, fails)
        if confirmed is not None:
            return confirmed
        self.note(at)
        self.remark = f"it fails at {point_text(at)}, {_IN_EXACT_ARITHMETIC}"
        return ()

    def _rounded(self, at: Mapping[str, float], digits: int | None) -> dict[str, float]:
        """Return a point rounded to `digits` decimals, inside the box."""
        ends = self.prover.box(self.region)
        return {
            name: x if digits is None else min(max(round(x, digits), float(low)), float(high))
            for (name, x), (low, high) in zip(at.items(), ends, strict=True)
        }

    def points(self, points: list[Mapping[str, Any]]) -> tuple[str, ...]:
        """Return points as evidence, if inference has the values of exact arithmetic."""
        pairs = []
        for at in points:
            near = {name: float(x) for name, x in at.items()}
            value, exact = self.inferred(near), self.prover.exactly(near)
            if value is None or exact is None:
                return ()
            if abs(Fraction(value) - exact) > Fraction(LIKE_EXPECT * self.prover.range):
                return ()
            pairs.append((near, value))
        return tuple(self.expect(near, value) for near, value in pairs)

    def expect(self, at: Mapping[str, float], value: float) -> str:
        """Note a point, and return its ``expect`` line."""
        from fuzzyarm.language.tokens import name_text

        self.note(at)
        inputs = ", ".join(f"{name_text(name)} = {number_text(x)}" for name, x in at.items())
        rounded = float(f"{value:.12g}")
        if abs(rounded - value) > 0.1 * LIKE_EXPECT * self.prover.range:
            rounded = value
        return f"expect {inputs} -> {name_text(self.claim.output)} = {number_text(rounded)}"

    def falling_pair(self, at: Mapping[str, Fraction], sign: int) -> Pair | None:
        """Return two points along the input, the second one with a lower (or higher) output."""
        here = {name: float(x) for name, x in at.items()}
        for digits in (0, 1, 2, 3, 6, None):
            pair = self._pair_on_line(
                self._rounded(here, digits), float(at[self.claim.input]), sign
            )
            if pair is not None:
                return pair
        return None

    def _pair_on_line(self, fixed: dict[str, float], here: float, sign: int) -> Pair | None:
        """Return the same with the other inputs fixed: among corners, even steps and neighbours."""
        import numpy as np

        from fuzzyarm.inference import infer

        prover, name = self.prover, self.claim.input
        assert prover.model is not None
        axis = prover.names.index(name)
        low, high = (float(x) for x in prover.box(self.region)[axis])
        corners = [
            float(x)
            for proposition in prover.model.propositions
            if proposition.input == axis
            for x, _ in proposition.corners
            if low <= x <= high
        ]
        steps = 400
        even = [low + (high - low) * i / steps for i in range(steps + 1)]
        near = [here + (high - low) * share for share in (-1e-3, -1e-5, 0.0, 1e-5, 1e-3)]
        positions = sorted({x for x in (*corners, *even, *near) if low <= x <= high})
        inputs = {other: np.full(len(positions), x) for other, x in fixed.items()}
        inputs[name] = np.array(positions)
        values = np.asarray(infer(self.rulebase, inputs)[self.claim.output]) * sign
        # The largest fall from any point to a later one: from the running maximum.
        before = np.maximum.accumulate(values)
        drop = before - values
        second = int(drop.argmax())
        first = int(values[: second + 1].argmax())
        pair = ({**fixed, name: positions[first]}, {**fixed, name: positions[second]})
        exact = [prover.exactly(point) for point in pair]
        if first >= second or exact[0] is None or exact[1] is None:
            return None
        return pair if sign * (exact[0] - exact[1]) > 0 else None

    def steep_pair(self, at: Mapping[str, Fraction], sign: int, limit: float) -> Pair | None:
        """Return two close points with a difference quotient beyond a limit."""
        prover, name = self.prover, self.claim.input
        axis = prover.names.index(name)
        low, high = prover.box(self.region)[axis]
        here = {other: float(x) for other, x in at.items()}
        for share in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7):
            for step in (share, -share):
                x = here[name] + step * float(high - low)
                if not low <= x <= high:
                    continue
                pair = sorted(({**here, name: x}, here), key=lambda point: point[name])
                exact = [prover.exactly(point) for point in pair]
                if exact[0] is None or exact[1] is None or pair[0][name] == pair[1][name]:
                    continue
                run = Fraction(pair[1][name]) - Fraction(pair[0][name])
                if sign * ((exact[1] - exact[0]) / run - Fraction(limit)) > 0:
                    return pair[0], pair[1]
        return None
