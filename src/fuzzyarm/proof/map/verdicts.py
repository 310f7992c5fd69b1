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
from functools import cached_property
from itertools import islice, product
from typing import TYPE_CHECKING, Any

from fuzzyarm.base.diagnostic import NOWHERE, RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import outward_text
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.language import parse, write
from fuzzyarm.language.model.rulebase import AnyRuleBase, Property, RuleBase, model_of
from fuzzyarm.language.writer import property_node
from fuzzyarm.proof.map.bounds import LIKE_EXPECT, Bounds, Claim
from fuzzyarm.proof.map.evidence import Evidence
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.stop import Stop, TimeOverError

if TYPE_CHECKING:
    from fuzzyarm.language.statements import ProveNode

PROVED, REFUTED, UNDECIDED = "proved", "refuted", "undecided"

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

    @cached_property
    def evidence(self) -> Evidence:
        """Points at which the statement fails."""
        return Evidence(self.prover, self.claim)

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
            return self._result(UNDECIDED, reason=str(error))

    def _result(self, verdict: str, bounds: Bounds | None = None, **facts: Any) -> Verdict:
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
            facts["points"] = tuple(self.evidence.failing)
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
                return self._result(REFUTED, evidence=evidence, way="boxes")
        open_reason = ""
        try:
            no_rule = self._without_value()
        except FuzzyarmError as error:  # the bounds may still refute it
            no_rule, open_reason = None, str(error)
        if no_rule is not None:
            return no_rule
        bounds = self.prover.value(self.region)
        for sign, limit in sides:
            result, bounds = self._side(bounds, sign, limit, strict=strict)
            if result == UNDECIDED:
                return self._result(UNDECIDED, bounds)
            if isinstance(result, tuple):
                return self._result(REFUTED, bounds, evidence=result, reason=self.evidence.remark)
        if open_reason:
            return self._result(UNDECIDED, bounds, reason=open_reason)
        return self._result(PROVED, bounds)

    def _at_corners(self, conditions: Iterable[_Beyond]) -> tuple[str, ...] | None:
        """Return the first corner of the region, or middle of its sides, at which it fails."""
        conditions = tuple(conditions)
        ends = [(float(low), float(high)) for low, high in self.prover.box(self.region)]
        middles = [(low, high, 0.5 * low + 0.5 * high) for low, high in ends]
        levels = middles if 3 ** len(ends) <= MOST_CORNERS else ends
        for values in islice(product(*levels), MOST_CORNERS):
            at = dict(zip(self.prover.names, values, strict=True))
            value = self.evidence.inferred(at)
            for beyond in conditions:
                if value is not None and self.evidence.fails_clearly(beyond, value):
                    return self.evidence.confirmed(at, beyond)
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
                return self.evidence.shown(without_rule, beyond), bounds
        if at and sign * (reached - limit) > LIKE_EXPECT * prover.range:
            confirmed = self.evidence.confirmed(at, beyond)
            if confirmed is not None:
                return confirmed, bounds
        if prover.output.outside == "clamp":  # no value lies outside its range
            nearest = prover.output.low if sign > 0 else prover.output.high
            if math.isfinite(nearest) and beyond(Fraction(nearest)):
                return self.evidence.shown(at, beyond) if at else UNDECIDED, bounds
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
        return self.evidence.shown(claim.at, beyond), bounds

    def _without_value(self) -> Verdict | None:
        """Refute a statement where the output has no value; leave it open where it holds one."""
        prover = self.prover
        prover.stop = self.stop.half()  # the second half is for the bounds
        missing = prover.missing(self.region)
        if missing is None:
            return None
        if missing.held:
            return self._result(UNDECIDED, reason=missing.reason)
        if missing.no_rule:
            return self._result(REFUTED, reason=self.evidence.without_rule(missing.at))
        self.evidence.note(missing.at)
        return self._result(REFUTED, reason=missing.reason)

    # ── slopes ───────────────────────────────────────────────────────────────────────

    def _rises(self) -> Verdict:
        claim, prover = self.claim, self.prover
        falls = claim.kind == "falls"
        # The slope is at least −0: the supremum of minus the slope is at most 0.
        bound = prover.slope_at_most(self.region, claim.input, Fraction(0), negated=not falls)
        facts: dict[str, Any] = {"pieces": bound.pieces, "way": _way(bound)}
        if bound.holds:
            return self._result(PROVED, **facts)
        if bound.holds is False:
            pair = self.evidence.falling_pair(bound.at, -1 if falls else 1)
            if pair is not None:
                return self._result(REFUTED, evidence=self.evidence.points(list(pair)), **facts)
        return self._result(UNDECIDED, **facts)

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
                return self._result(UNDECIDED, bounds, **facts)
            if not outcome.holds:
                pair = self.evidence.steep_pair(outcome.at, sign, limit)
                if pair is None:
                    reason = "a limit of slopes is beyond, but no pair of floats shows it"
                    return self._result(UNDECIDED, bounds, reason=reason, **facts)
                return self._result(
                    REFUTED, bounds, evidence=self.evidence.points(list(pair)), **facts
                )
            bounds = _at_most(bounds, sign, limit)
        return self._result(PROVED, bounds, **facts)

    # ── the others ───────────────────────────────────────────────────────────────────

    def _odd(self) -> Verdict:
        prover = self.prover
        limit = LIKE_EXPECT * prover.range
        claim = prover.odd_within(self.region, limit)
        facts: dict[str, Any] = {"pieces": claim.pieces, "way": _way(claim)}
        if claim.holds:
            return self._result(PROVED, **facts)
        if claim.holds is False:
            at = {name: float(x) for name, x in claim.at.items()}
            opposite = {name: -x for name, x in at.items()}
            both = prover.exactly(at), prover.exactly(opposite)
            if both[0] is not None and both[1] is not None and abs(both[0] + both[1]) > limit:
                return self._result(REFUTED, evidence=self.evidence.points([at, opposite]), **facts)
        return self._result(UNDECIDED, **facts)

    def _covered(self) -> Verdict:
        prover = self.prover
        at = prover.uncovered(self.region)
        pieces = prover.pieces_cut
        way = "boxes" if prover.model is None else "exact"
        if at is None:
            return self._result(PROVED, pieces=pieces, way=way)
        return self._result(REFUTED, pieces=pieces, way=way, reason=self.evidence.without_rule(at))

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
            return self._result(PROVED, **facts)
        above = bounds.reached_high >= -bounds.reached_low
        at = bounds.at_high if above else bounds.at_low
        if max(bounds.reached_high, -bounds.reached_low) > claim.high + LIKE_EXPECT * prover.range:
            inputs = [at[name] for name in table.names]
            # Next to a threshold the supremum belongs to the neighbouring cell.
            there = Fraction(float(table.lookup(*inputs, mode=claim.mode)))
            far = claim.high

            def fails(value: Fraction) -> bool:
                return abs(value - there) > Fraction(far)

            value = self.evidence.inferred(at)
            shows = value is not None and fails(Fraction(value))
            confirmed = (self.evidence.expect(at, value),) if shows and value is not None else None
            if confirmed is not None or claim.mode != "linear":
                if confirmed is None:
                    self.evidence.note(at)
                reason = f"the error is {max(bounds.reached_high, -bounds.reached_low):.10g}"
                return self._result(REFUTED, evidence=confirmed or (), reason=reason, **facts)
        if prover.model is not None:
            bound = prover.table_at_most(self.region, table, claim.mode, claim.high)
            if bound.holds:
                return self._result(PROVED, **{**facts, "bound": claim.high})
        return self._result(UNDECIDED, **facts)

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
