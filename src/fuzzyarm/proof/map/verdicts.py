"""Verdicts on the statements of ``prove`` lines: proved, refuted or undecided.

A verdict carries its evidence: a bound and the number of pieces, or points ready to paste as
``expect`` lines, evaluated in exact arithmetic. *Refuted* is confirmed in exact arithmetic,
*proved* covers every piece; everything else is undecided, with the bounds so far and the reason why
the search stopped.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice, product
from typing import TYPE_CHECKING, Any

from fuzzyarm.base.diagnostic import NOWHERE, RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text, outward_text
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.language import parse, write
from fuzzyarm.language.model.rulebase import AnyRuleBase, Property, RuleBase, model_of
from fuzzyarm.language.writer import property_node
from fuzzyarm.proof.map.bounds import LIKE_EXPECT, Bounds, Claim
from fuzzyarm.proof.map.prover import Prover, point_text
from fuzzyarm.proof.stop import Stop, TimeOverError

if TYPE_CHECKING:
    from fuzzyarm.inference.trace import Trace
    from fuzzyarm.language.statements import ProveNode

PROVED, REFUTED, UNDECIDED = "proved", "refuted", "undecided"

_IN_EXACT_ARITHMETIC = "in exact arithmetic, by less than the rounding of inference"

Tell = Callable[[str, int, float], None]
"""Called with the statement, the number of open pieces and the gap between the bounds."""


@json_properties("property=statement verdict bound evidence pieces seconds way reason line")
@dataclass(frozen=True, repr=False, kw_only=True)
class Verdict(Shown):
    """The result of one statement.

    Attributes
    ----------
    statement : str
        The statement, as written after ``prove``.
    verdict : str
        ``proved``, ``refuted`` or ``undecided``.
    bound : tuple of float, float or None
        The proved bound, whatever the verdict: (low, high) of the value, the slope or the sum at
        opposite points, the worst error of a table. None without one.
    evidence : tuple of str
        ``expect`` lines with a point or a pair of points at which it fails.
    pieces : int
        Number of simplices or boxes examined.
    seconds : float
        Time taken.
    way : str
        ``exact`` (rationals), ``widened`` (floats, rounded outward), ``boxes`` or empty.
    reason : str
        Why it is undecided or refuted, or why boxes were used.
    line : int
        Line in the file; 0 for a statement from elsewhere.
    output : str
        Name of the output.
    points : tuple of dict of str to float
        Points at which a refuted statement fails: one or two.
    """

    statement: str
    verdict: str
    bound: tuple[float, float] | float | None = None
    evidence: tuple[str, ...] = ()
    pieces: int = 0
    seconds: float = 0.0
    way: str = ""
    reason: str = ""
    line: int = 0
    output: str = ""
    points: tuple[Mapping[str, float], ...] = ()

    @property
    def proved(self) -> bool:
        """Whether it holds at every point."""
        return self.verdict == PROVED

    def __repr__(self) -> str:
        bound = "" if self.bound is None else f", bound {bound_text(self.bound)}"
        return one_line(self, f"{self.verdict}: {self.statement}{bound}")

    def __str__(self) -> str:
        words = [f"{self.verdict}: {self.statement}"]
        if self.bound is not None:
            words.append(f"  bound {bound_text(self.bound)}")
        if self.reason:
            words.append(f"  {self.reason}")
        return "\n".join([*words, *(f"  {line}" for line in self.evidence)])


def bound_text(bound: tuple[float, float] | float) -> str:
    """Return a bound to seven digits, rounded outward."""
    if isinstance(bound, tuple):
        return f"{outward_text(bound[0], up=False)} .. {outward_text(bound[1], up=True)}"
    return outward_text(bound, up=True)


# ── statements ───────────────────────────────────────────────────────────────────────


def read_property(rulebase: RuleBase, text: str, argument: str = "") -> Property:
    """Return the statement in a text such as ``u rises with e``.

    Parameters
    ----------
    rulebase : RuleBase
        The rule base of the statement.
    text : str
        The statement, with or without ``prove`` in front.
    argument : str, optional
        Name of the argument with the text; an error begins with it.

    Raises
    ------
    RuleBaseError
        If it cannot be read, with the likely meaning.
    """
    statement = text if text.split(maxsplit=1)[:1] == ["prove"] else f"prove {text}"
    head = write(replace(rulebase, properties=rulebase.properties[:0], expectations=()))
    if "\n" in statement.strip() or statement.strip() == "prove":
        statement = "prove"
    parsed = parse(f"{head}{statement.strip()}\n", "<statement>")
    if parsed.rulebase is None or not parsed.rulebase.properties:
        last = head.count("\n") + 1
        mine = [diagnostic for diagnostic in parsed.diagnostics if diagnostic.line >= last]
        source = argument or f"'{text}'"
        raise RuleBaseError(
            tuple(
                replace(mistake, argument=source, span=NOWHERE)
                for mistake in mine or parsed.diagnostics
            )
        )
    return parsed.rulebase.properties[-1]


def property_text(claim: Property, rulebase: RuleBase) -> str:
    """Return a statement as written after ``prove``.

    Parameters
    ----------
    claim : Property
        The statement.
    rulebase : RuleBase
        The rule base of the statement.
    """
    node: ProveNode = property_node(claim, rulebase)
    return str(node).removeprefix("prove ")


def prove(
    rulebase: AnyRuleBase,
    statement: str | Property,
    *,
    tolerance: float | None = None,
    budget: float = math.inf,
    exact: bool = False,
    tell: Tell | None = None,
) -> Verdict:
    """Prove or refute one statement about a rule base.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    statement : str or Property
        As after ``prove`` in a file: ``"u rises with e"``.
    tolerance : float, optional
        Largest gap between bounds and attained values, in their units; 1e-8 of the range of the
        output by default.
    budget : float
        Seconds until the verdict is undecided.
    exact : bool
        Compute in rationals only, without widening.
    tell : callable, optional
        Called with the statement, the number of pieces and the gap between the bounds; NaN while
        pieces are still being cut.

    Returns
    -------
    Verdict
        With its evidence.

    Raises
    ------
    RuleBaseError
        If the statement cannot be read.

    Examples
    --------
    >>> import fuzzyarm
    >>> pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    >>> fuzzyarm.prove(pd7, "u odd").verdict
    'proved'
    """
    rulebase = model_of(rulebase)
    if isinstance(statement, str):
        claim = read_property(rulebase, statement, f"prove('{statement}')")
    else:
        claim = statement
    return _Case(rulebase, claim, tolerance, budget, tell, {}, exact=exact).verdict()


def prove_all(
    rulebase: AnyRuleBase,
    *,
    tolerance: float | None = None,
    budget: float = math.inf,
    exact: bool = False,
    tell: Tell | None = None,
) -> Iterator[Verdict]:
    """Yield a verdict on every ``prove`` line of a rule base, in order.

    Parameters
    ----------
    budget : float
        Seconds for each line.
    rulebase, tolerance, exact, tell
        As for :func:`prove`.
    """
    rulebase = model_of(rulebase)
    provers: dict[str, Prover] = {}
    for claim in rulebase.properties:
        yield _Case(rulebase, claim, tolerance, budget, tell, provers, exact=exact).verdict()


MOST_CORNERS = 729
"""Points of a first test before the search by boxes: three per input for six inputs, or the first
of these for more."""


class _Case:
    """The proof of one statement."""

    def __init__(
        self,
        rulebase: RuleBase,
        claim: Property,
        tolerance: float | None,
        budget: float,
        tell: Tell | None,
        provers: dict[str, Prover],
        *,
        exact: bool,
    ) -> None:
        self.rulebase = rulebase
        self.claim = claim
        self.text = property_text(claim, rulebase)
        self.region = {name: (low, high) for name, low, high in claim.region}
        self.started = time.monotonic()
        self.tolerance, self.exact = tolerance, exact
        self.provers = provers
        watch = None if tell is None else (lambda count, gap: tell(self.text, count, gap))
        self.stop = Stop(budget, watch)
        self.failing: list[dict[str, float]] = []
        self.remark = ""

    @property
    def prover(self) -> Prover:
        """The prover of the output, with its pieces cut for other statements."""
        prover = self.provers.get(self.claim.output)
        if prover is None:
            prover = Prover(
                self.rulebase, self.claim.output, tolerance=self.tolerance, exact=self.exact
            )
            self.provers[self.claim.output] = prover
        prover.stop = self.stop
        return prover

    def verdict(self) -> Verdict:
        judge = {
            "value": self._value,
            "rises": self._rises,
            "falls": self._rises,
            "slope": self._slope,
            "odd": self._odd,
            "covered": self._covered,
            "table": self._table,
        }[self.claim.kind]
        self.stop.say(0)  # before any long work
        try:
            return judge()
        except FuzzyarmError as error:  # no time left, unprovable, not a table
            return self._said(UNDECIDED, reason=str(error))

    def _said(self, verdict: str, bounds: Bounds | None = None, **facts: Any) -> Verdict:
        if bounds is not None:
            facts.setdefault("bound", (bounds.low, bounds.high))
            facts.setdefault("pieces", bounds.pieces)
            facts.setdefault("way", bounds.way)
        if verdict == UNDECIDED and not facts.get("reason"):
            over = "time ran out" if self.stop.now else "the bounds do not decide it"
            facts["reason"] = over + self._because_of_boxes(" (boxes: ", ")")
        elif facts.get("way") == "boxes" and not facts.get("reason"):
            facts["reason"] = self._because_of_boxes("by boxes: ", "")
        if verdict == REFUTED:
            facts["points"] = tuple(self.failing)
        seconds = time.monotonic() - self.started
        line, output = max(0, self.claim.span.line), self.claim.output
        return Verdict(
            statement=self.text, verdict=verdict, seconds=seconds, line=line, output=output, **facts
        )

    def _because_of_boxes(self, before: str, after: str) -> str:
        reason = self.provers[self.claim.output].reason if self.provers else ""
        return f"{before}{reason}{after}" if reason else ""

    # ── value ────────────────────────────────────────────────────────────────────────

    def _value(self) -> Verdict:
        outcome, prover = self.claim.outcome, self.prover
        assert outcome is not None
        low, high, strict = _interval(outcome.relation, outcome.value, outcome.other, prover.range)
        sides = [(-1, low), (1, high)]
        if prover.model is None:  # boxes take long, a point is cheap
            evidence = self._at_corners(
                _Beyond(sign, Fraction(limit), strict=strict)
                for sign, limit in sides
                if math.isfinite(limit)
            )
            if evidence is not None:
                return self._said(REFUTED, evidence=evidence, way="boxes")
        silence_open = ""
        try:
            no_rule = self._without_value()
        except FuzzyarmError as error:  # the bounds may still refute it
            no_rule, silence_open = None, str(error)
        if no_rule is not None:
            return no_rule
        bounds = self.prover.value(self.region)
        for sign, limit in sides:
            result, bounds = self._side(bounds, sign, limit, strict=strict)
            if result == UNDECIDED:
                return self._said(UNDECIDED, bounds)
            if isinstance(result, tuple):
                return self._said(REFUTED, bounds, evidence=result, reason=self.remark)
        if silence_open:
            return self._said(UNDECIDED, bounds, reason=silence_open)
        return self._said(PROVED, bounds)

    def _at_corners(self, conditions: Iterable[_Beyond]) -> tuple[str, ...] | None:
        """Return the first corner of the region, or middle of its sides, at which it fails."""
        conditions = tuple(conditions)
        ends = [(float(low), float(high)) for low, high in self.prover.box(self.region)]
        middles = [(low, high, 0.5 * low + 0.5 * high) for low, high in ends]
        levels = middles if 3 ** len(ends) <= MOST_CORNERS else ends
        for values in islice(product(*levels), MOST_CORNERS):
            at = dict(zip(self.prover.names, values, strict=True))
            value = self._inferred(at)
            for beyond in conditions:
                if value is not None and self._clearly(beyond, value):
                    return self._confirmed(at, beyond)
        return None

    def _side(
        self, bounds: Bounds, sign: int, limit: float, *, strict: bool
    ) -> tuple[str | tuple[str, ...], Bounds]:
        """Judge one end of an interval: proved, undecided or the evidence against it."""
        prover = self.prover
        bound, reached, at = (
            (bounds.high, bounds.reached_high, bounds.at_high)
            if sign > 0
            else (bounds.low, bounds.reached_low, bounds.at_low)
        )
        if sign * (limit - bound) > 0.0 or (not strict and limit == bound):
            return PROVED, bounds
        if math.isinf(limit):  # the open side of `<` and `>`
            return PROVED, bounds
        beyond = _Beyond(sign, Fraction(limit), strict=strict)
        no_rule = prover.no_rule
        if no_rule is not None and beyond(Fraction(no_rule)):
            # The bounds include the value for no rule, the pieces do not.
            without_rule = prover.without_value(self.region)
            if without_rule is not None:
                return self._shown(without_rule, beyond), bounds
        if at and sign * (reached - limit) > LIKE_EXPECT * prover.range:
            confirmed = self._confirmed(at, beyond)
            if confirmed is not None:
                return confirmed, bounds
        if prover.output.outside == "clamp":  # no value lies outside its range
            nearest = prover.output.low if sign > 0 else prover.output.high
            if math.isfinite(nearest) and beyond(Fraction(nearest)):
                return self._shown(at, beyond) if at else UNDECIDED, bounds
        return self._decided(bounds, sign, limit, beyond)

    def _decided(
        self, bounds: Bounds, sign: int, limit: float, beyond: _Beyond
    ) -> tuple[str | tuple[str, ...], Bounds]:
        """Decide an end that the bounds leave open, by a direct question."""
        prover, strict = self.prover, beyond.strict
        if prover.model is None:
            holds, boxes = prover.boxes_at_most(self.region, sign * limit, negated=sign < 0)
            bounds = bounds._replace(pieces=bounds.pieces + boxes)
            proved = holds and not strict
            return (PROVED, _at_most(bounds, sign, limit)) if proved else (UNDECIDED, bounds)
        claim = prover.value_at_most(self.region, sign * limit, negated=sign < 0, strict=strict)
        bounds = bounds._replace(pieces=bounds.pieces + claim.pieces)
        if claim.holds:
            return PROVED, _at_most(bounds, sign, limit)
        value = prover.exactly(claim.at) if claim.at else None
        if value is None or not beyond(value):
            return UNDECIDED, bounds
        return self._shown(claim.at, beyond), bounds

    def _without_value(self) -> Verdict | None:
        """Refute a statement where the output has no value; leave it open where it holds one."""
        prover = self.prover
        prover.stop = self.stop.half()  # the second half is for the bounds
        missing = prover.missing(self.region)
        if missing is None:
            return None
        if missing.held:
            return self._said(UNDECIDED, reason=missing.reason)
        if missing.no_rule:
            return self._said(REFUTED, reason=self._silence(missing.at))
        self._note(missing.at)
        return self._said(REFUTED, reason=missing.reason)

    def _silence(self, at: Mapping[str, Any]) -> str:
        """Report a point without a firing rule, and whether floats agree."""
        from fuzzyarm.inference import compiled, explain

        self._note(at)
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

    def _note(self, at: Mapping[str, Any]) -> None:
        """Record a point of failure, for a refutation."""
        self.failing.append({name: float(x) for name, x in at.items()})

    # --- evidence: floats at a point found in exact arithmetic ---

    def _inferred(self, at: Mapping[str, Any]) -> float | None:
        """Return the output at a point by inference; None without a value."""
        from fuzzyarm.inference import infer

        point = {name: float(x) for name, x in at.items()}
        try:
            value = infer(self.rulebase, point)[self.claim.output]
        except FuzzyarmError:
            return None
        return None if math.isnan(value) else value

    def _confirmed(
        self, at: Mapping[str, float], fails: Callable[[Fraction], bool]
    ) -> tuple[str, ...] | None:
        """Return a point as evidence, if the statement fails there in exact arithmetic.

        Preferred is the point with the fewest digits at which inference fails, too. Without exact
        pieces inference alone decides, by more than the tolerance of an `expect` line.
        """
        for digits in (0, 1, 2, 3, 6, None):
            near = self._rounded(at, digits)
            value = self._inferred(near)
            if value is None or not fails(Fraction(value)):
                continue
            if self.prover.model is None:
                outcome = self.prover.no_rule
                if value != outcome and not self._clearly(fails, value):
                    continue
            else:
                exact = self.prover.exactly(near)
                if exact is None or not fails(exact):
                    continue
            return (self._expect(near, value),)
        return None

    def _clearly(self, fails: Callable[[Fraction], bool], value: float) -> bool:
        """Return whether a statement fails for all values within the tolerance of `expect`."""
        slack = LIKE_EXPECT * self.prover.range
        return fails(Fraction(value - slack)) and fails(Fraction(value + slack))

    def _shown(
        self, at: Mapping[str, float | Fraction], fails: Callable[[Fraction], bool]
    ) -> tuple[str, ...]:
        """Return a point of failure as evidence, or a sentence if inference hides it."""
        near = {name: float(x) for name, x in at.items()}
        confirmed = self._confirmed(near, fails)
        if confirmed is not None:
            return confirmed
        self._note(at)
        self.remark = f"it fails at {point_text(at)}, {_IN_EXACT_ARITHMETIC}"
        return ()

    def _rounded(self, at: Mapping[str, float], digits: int | None) -> dict[str, float]:
        """Return a point rounded to `digits` decimals, inside the box."""
        ends = self.prover.box(self.region)
        return {
            name: x if digits is None else min(max(round(x, digits), float(low)), float(high))
            for (name, x), (low, high) in zip(at.items(), ends, strict=True)
        }

    def _points(self, points: list[Mapping[str, Any]]) -> tuple[str, ...]:
        """Return points as evidence, if inference has the values of exact arithmetic."""
        pairs = []
        for at in points:
            near = {name: float(x) for name, x in at.items()}
            value, exact = self._inferred(near), self.prover.exactly(near)
            if value is None or exact is None:
                return ()
            if abs(Fraction(value) - exact) > Fraction(LIKE_EXPECT * self.prover.range):
                return ()
            pairs.append((near, value))
        return tuple(self._expect(near, value) for near, value in pairs)

    def _expect(self, at: Mapping[str, float], value: float) -> str:
        from fuzzyarm.language.tokens import name_text

        self._note(at)
        inputs = ", ".join(f"{name_text(name)} = {number_text(x)}" for name, x in at.items())
        rounded = float(f"{value:.12g}")
        if abs(rounded - value) > 0.1 * LIKE_EXPECT * self.prover.range:
            rounded = value
        return f"expect {inputs} -> {name_text(self.claim.output)} = {number_text(rounded)}"

    # ── slopes ───────────────────────────────────────────────────────────────────────

    def _rises(self) -> Verdict:
        claim, prover = self.claim, self.prover
        falls = claim.kind == "falls"
        # The slope is at least −0: the supremum of minus the slope is at most 0.
        bound = prover.slope_at_most(self.region, claim.input, Fraction(0), negated=not falls)
        facts: dict[str, Any] = {"pieces": bound.pieces, "way": _way(bound)}
        if bound.holds:
            return self._said(PROVED, **facts)
        if bound.holds is False:
            pair = self._pair_along(bound.at, -1 if falls else 1)
            if pair is not None:
                return self._said(REFUTED, evidence=self._points(list(pair)), **facts)
        return self._said(UNDECIDED, **facts)

    def _pair_along(
        self, at: Mapping[str, Fraction], sign: int
    ) -> tuple[Mapping[str, float], Mapping[str, float]] | None:
        """Return two points along the input, the second one with a lower (or higher) output."""
        here = {name: float(x) for name, x in at.items()}
        for digits in (0, 1, 2, 3, 6, None):
            pair = self._pair_on_line(
                self._rounded(here, digits), float(at[self.claim.input]), sign
            )
            if pair is not None:
                return pair
        return None

    def _pair_on_line(
        self, fixed: dict[str, float], here: float, sign: int
    ) -> tuple[Mapping[str, float], Mapping[str, float]] | None:
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
        import numpy as np

        from fuzzyarm.inference import infer

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

    def _slope(self) -> Verdict:
        claim, prover = self.claim, self.prover
        bounds = prover.slope(self.region, claim.input)
        facts: dict[str, Any] = {}
        for sign, limit, bound in ((-1, claim.low, bounds.low), (1, claim.high, bounds.high)):
            if sign * (limit - bound) >= 0:
                continue
            outcome = prover.slope_at_most(
                self.region, claim.input, Fraction(sign * limit), negated=sign < 0
            )
            facts = {"pieces": bounds.pieces + outcome.pieces}
            if outcome.holds is None:
                return self._said(UNDECIDED, bounds, **facts)
            if not outcome.holds:
                pair = self._steep_pair(outcome.at, sign, limit)
                if pair is None:
                    reason = "a limit of slopes is beyond, but no pair of floats shows it"
                    return self._said(UNDECIDED, bounds, reason=reason, **facts)
                return self._said(REFUTED, bounds, evidence=self._points(list(pair)), **facts)
            bounds = _at_most(bounds, sign, limit)
        return self._said(PROVED, bounds, **facts)

    def _steep_pair(
        self, at: Mapping[str, Fraction], sign: int, limit: float
    ) -> tuple[Mapping[str, float], Mapping[str, float]] | None:
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

    # ── the others ───────────────────────────────────────────────────────────────────

    def _odd(self) -> Verdict:
        prover = self.prover
        limit = LIKE_EXPECT * prover.range
        claim = prover.odd_within(self.region, limit)
        facts: dict[str, Any] = {"pieces": claim.pieces, "way": _way(claim)}
        if claim.holds:
            return self._said(PROVED, **facts)
        if claim.holds is False:
            at = {name: float(x) for name, x in claim.at.items()}
            opposite = {name: -x for name, x in at.items()}
            both = prover.exactly(at), prover.exactly(opposite)
            if both[0] is not None and both[1] is not None and abs(both[0] + both[1]) > limit:
                return self._said(REFUTED, evidence=self._points([at, opposite]), **facts)
        return self._said(UNDECIDED, **facts)

    def _covered(self) -> Verdict:
        prover = self.prover
        at = prover.uncovered(self.region)
        pieces = prover.pieces_cut
        way = "boxes" if prover.model is None else "exact"
        if at is None:
            return self._said(PROVED, pieces=pieces, way=way)
        return self._said(REFUTED, pieces=pieces, way=way, reason=self._silence(at))

    def _table(self) -> Verdict:
        from fuzzyarm.table import compile_table

        claim, prover = self.claim, self.prover
        prover.demand_bounds()
        self._demand_time_for_table()
        table = compile_table(self.rulebase, claim.output)
        bounds = prover.table(table, claim.mode, self.region)
        worst = max(bounds.high, -bounds.low)
        facts: dict[str, Any] = {"bound": worst, "pieces": bounds.pieces, "way": bounds.way}
        if worst <= claim.high:
            return self._said(PROVED, **facts)
        above = bounds.reached_high >= -bounds.reached_low
        at = bounds.at_high if above else bounds.at_low
        if max(bounds.reached_high, -bounds.reached_low) > claim.high + LIKE_EXPECT * prover.range:
            inputs = [at[name] for name in table.names]
            # Next to a threshold the supremum belongs to the neighbouring cell.
            there = Fraction(float(table.lookup(*inputs, mode=claim.mode)))
            far = claim.high

            def fails(value: Fraction) -> bool:
                return abs(value - there) > Fraction(far)

            value = self._inferred(at)
            shows = value is not None and fails(Fraction(value))
            confirmed = (self._expect(at, value),) if shows and value is not None else None
            if confirmed is not None or claim.mode != "linear":
                if confirmed is None:
                    self._note(at)
                reason = f"the error is {max(bounds.reached_high, -bounds.reached_low):.10g}"
                return self._said(REFUTED, evidence=confirmed or (), reason=reason, **facts)
        if prover.model is not None:
            bound = prover.table_at_most(self.region, table, claim.mode, claim.high)
            if bound.holds:
                return self._said(PROVED, **{**facts, "bound": claim.high})
        return self._said(UNDECIDED, **facts)

    def _demand_time_for_table(self) -> None:
        """Refuse a table whose values alone take longer than the budget."""
        from fuzzyarm.inference.effort import microseconds
        from fuzzyarm.inference.plan import part_for
        from fuzzyarm.table.compiler import choose_axes

        axes = choose_axes(self.rulebase, None, self.claim.output)
        cells = math.prod(len(axis.levels) for axis in axes)
        part = part_for(self.rulebase, [self.claim.output])
        if 1e-6 * cells * microseconds(part) > 3.0 * self.stop.left:
            raise TimeOverError


class _Beyond:
    """Whether a value is above a limit (sign 1) or below it (-1), or equal if excluded."""

    def __init__(self, sign: int, limit: Fraction, *, strict: bool = False) -> None:
        self.sign, self.limit, self.strict = sign, limit, strict

    def __call__(self, value: Fraction) -> bool:
        over = self.sign * (value - self.limit)
        return over > 0 or (self.strict and over == 0)


def _interval(
    relation: str, value: float, other: float | None, width: float
) -> tuple[float, float, bool]:
    """Return the interval of a relation, and whether its ends are excluded."""
    if relation == "in":
        assert other is not None
        return value, other, False
    if relation == "=":
        slack = LIKE_EXPECT * width if other is None else other
        return value - slack, value + slack, False
    if relation.startswith("<"):
        return -math.inf, value, relation == "<"
    return value, math.inf, relation == ">"


def _at_most(bounds: Bounds, sign: int, limit: float) -> Bounds:
    return bounds._replace(high=limit) if sign > 0 else bounds._replace(low=limit)


def _way(claim: Claim) -> str:
    return "exact" if claim.exact else "widened"
