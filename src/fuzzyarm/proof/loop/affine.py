"""Affine forms over rationals: a control period as a linear part, uncertain gains, and limits.

A signal is a constant plus a sum of state variables and of *answers* w of blocks. A block is an
uncertain gain: its answer is δ times a signal v, |δ| ≤ 1, whether it stands for a rule base within
its sector, a limit or a slope of the plant. All numbers of the file are taken as exact rationals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.check.certificate import Gains
from fuzzyarm.proof.check.numbers import FUNCTIONS, SpanError, ends, exact, function, is_point
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.loop.period import LoopAlgebra
from fuzzyarm.symbolic.nodes import Apply, Node, fold
from fuzzyarm.table import LookupTable

ZERO, ONE = Fraction(0), Fraction(1)

INFINITY, NO_VALUE = "infinity", "a division by 0"
VALUELESS = (INFINITY, NO_VALUE)
"""Variables of a NaN, which may occur in a comparison or in a branch not taken."""


class NotAffineError(LoopProofError):
    """A loop is not affine where a proof needs it."""


class MovingError(NotAffineError):
    """A state or memory moves at the supposed equilibrium."""


@dataclass(frozen=True)
class Affine:
    """A constant and a sum of variables."""

    constant: Fraction  # its value at rest
    # Weights of the variables; none is 0
    parts: Mapping[str, Fraction] = field(default_factory=dict)
    # low, high: bounds of the signal for all values of the variables, if known
    low: Fraction | None = None
    high: Fraction | None = None
    doubt: Fraction = ZERO  # largest distance of its true value at rest from the constant

    @property
    def is_constant(self) -> bool:
        """Whether it is a number."""
        return not self.parts

    def scaled(self, by: Fraction) -> Affine:
        """Return it times a number."""
        ends = self.low, self.high
        if by < 0:
            ends = self.high, self.low
        low, high = (None if end is None else end * by for end in ends)
        parts = {name: weight * by for name, weight in self.parts.items()}
        if not by:  # NaN times 0 is NaN
            parts = {name: ONE for name in self.parts if name in VALUELESS}
        low, high = (low, high) if by else (ZERO, ZERO)
        return Affine(self.constant * by, parts, low, high, self.doubt * abs(by))

    def plus(self, other: Affine) -> Affine:
        """Return the sum."""
        parts = dict(self.parts)
        for name, weight in other.parts.items():
            total = parts.get(name, ZERO) + weight
            if total:
                parts[name] = total
            else:
                parts.pop(name, None)
        low, high = (
            None if a is None or b is None else a + b
            for a, b in ((self.low, other.low), (self.high, other.high))
        )
        doubt = self.doubt + other.doubt
        return Affine(self.constant + other.constant, parts, low, high, doubt)

    @property
    def deviation(self) -> Affine:
        """The form without its constant."""
        return Affine(ZERO, self.parts)


def number(value: float | Fraction) -> Affine:
    """Return the form of a number."""
    if isinstance(value, float) and not math.isfinite(value):
        raise NotAffineError(f"{value} is not a number")
    exact = Fraction(value)
    return Affine(exact, {}, exact, exact)


def variable(name: str, rest: Fraction = ZERO, doubt: Fraction = ZERO) -> Affine:
    """Return the form of a state with its rest, known up to a doubt."""
    return Affine(rest, {name: ONE}, doubt=doubt)


@dataclass(frozen=True)
class UncertainGain:
    """An uncertain gain: the answer w of the variable `name` has |w| ≤ |v|."""

    name: str  # variable of its answer
    v: Affine  # its input times the radius of the gain; without a constant
    words: str  # description


@dataclass(frozen=True)
class SignalBound:
    """A condition of validity of the form: a signal must stay between two numbers."""

    signal: Affine  # without a constant
    low: Fraction | None  # low, high: below and above 0; None for unbounded
    high: Fraction | None
    words: str  # description

    @property
    def limit(self) -> Fraction:
        """The smaller distance of both ends from 0."""
        return min(abs(end) for end in (self.low, self.high) if end is not None)


Rules = Callable[["AffineAlgebra", RuleBase, Mapping[str, Affine]], list[Affine]]
"""Affine forms of rule bases."""


class AffineAlgebra(LoopAlgebra[Affine]):
    """A control period in affine forms; an :class:`~fuzzyarm.proof.loop.period.LoopAlgebra`.

    At a limit or a choice the branch at rest is taken, with its condition recorded as a
    :class:`SignalBound`; or, by `grip`, a limit passes at least that share of a deviation and
    becomes an :class:`UncertainGain`.

    Parameters
    ----------
    rules, table : callable
        Affine forms of rule bases and tables.
    grip : Fraction
        Least share of a deviation that passes a limit; 1: no limit is reached.
    is_search : bool
        During the search for the rest: nothing is recorded, and limits are ignored.

    Attributes
    ----------
    blocks, bounds : list
        The records.
    inputs : list of (Affine, bool)
        Moving inputs of rule bases, in the order of the walk, and whether the rules may have an
        edge at its rest.
    gains, spread : list
        The same for a certificate, see :class:`fuzzyarm.proof.check.certificate.Evidence`.
    """

    def __init__(
        self,
        rules: Rules,
        table: Callable[[AffineAlgebra, LookupTable, Mapping[str, Affine]], Affine],
        *,
        grip: Fraction = ONE,
        is_search: bool = False,
    ) -> None:
        self._rules, self._table = rules, table
        self.grip, self.is_search = grip, is_search
        self.blocks: list[UncertainGain] = []
        self.bounds: list[SignalBound] = []
        self.inputs: list[tuple[Affine, bool]] = []
        self.gains: list[Gains] = []
        self.spread: list[tuple[int, int, Fraction, Fraction]] = []

    # --- arithmetic ---

    def number(self, value: float) -> Affine:
        """Return the form of a number."""
        if math.isinf(value):  # the end of an unbounded range
            return Affine(Fraction(0), {INFINITY: Fraction(1 if value > 0 else -1)})
        return number(value)

    def add(self, a: Affine, b: Affine) -> Affine:
        """Return a sum."""
        return a.plus(b)

    def subtract(self, a: Affine, b: Affine) -> Affine:
        """Return a difference."""
        return a.plus(b.scaled(-ONE))

    def multiply(self, a: Affine, b: Affine) -> Affine:
        """Return a product with one constant factor."""
        for one, other in ((a, b), (b, a)):
            if one.is_constant:
                return other.scaled(one.constant)
        raise NotAffineError("two signals are multiplied")

    def divide(self, a: Affine, b: Affine) -> Affine:
        """Return a quotient by a number."""
        if not b.is_constant:
            raise NotAffineError("a signal is divided by one that is not constant")
        if not b.constant:  # no value, in a branch not taken
            return Affine(ZERO, {NO_VALUE: ONE})
        return a.scaled(ONE / b.constant)

    def error(self, x: Affine, size: float) -> Affine:
        """Refuse an error that does not vanish at rest."""
        raise NotAffineError(
            "a sensor with steps leaves a loop wandering between them: it is not asymptotically"
            " stable"
        )

    # --- limits ---

    def limit(self, x: Affine, low: float, high: float) -> Affine:
        """Return a signal between limits."""
        if x.is_constant:
            return number(min(max(x.constant, _end(low)), _end(high)))
        if self.is_search:
            return x
        ends = [None if math.isinf(end) else Fraction(end) for end in (low, high)]
        return self._held(x, ends[0], ends[1], f"a limit, {low:g} .. {high:g}")

    def rate_limited(self, x: Affine, before: Affine, most: float) -> Affine:
        """Return a signal whose change in one period is limited."""
        change = self.subtract(x, before)
        if change.is_constant or self.is_search:
            return x
        if change.constant:
            raise MovingError("a drive that is limited in its change moves")
        self._note(change, -Fraction(most), Fraction(most), f"a slew, {most:g} in a period")
        return x

    def _held(self, x: Affine, low: Fraction | None, high: Fraction | None, words: str) -> Affine:
        """Return a signal between limits: inside them, or with a share of its deviation."""
        inside = (low is None or (x.low is not None and low <= x.low)) and (
            high is None or (x.high is not None and x.high <= high)
        )
        if inside:
            return x
        rest = x.constant
        for end, sign in ((low, 1), (high, -1)):
            if end is not None and sign * (rest - end) <= x.doubt:
                raise NotAffineError(f"at rest a signal is {float(rest):.6g}, at {words}")
        # At least this share of the deviation passes, wherever the signal can be.
        least = ONE
        for end, most in ((low, x.low), (high, x.high)):
            if end is not None:
                room = abs(end - rest) - x.doubt
                if most is None:
                    least = ZERO
                elif _beyond(end, most, rest):
                    least = min(least, room / (abs(most - rest) - x.doubt))
        if least < self.grip:
            least = self.grip
            below, above = (
                None if end is None else (end - rest - sign * x.doubt) / least
                for end, sign in ((low, -1), (high, 1))
            )
            self._note(x.deviation, below, above, words)
        if least == ONE:
            return x
        answer = self.block(x.deviation.scaled((ONE - least) / 2), words)
        middle = x.deviation.scaled((ONE + least) / 2)
        form = middle.plus(answer)
        return Affine(rest, form.parts, low, high, x.doubt)

    def block(self, v: Affine, words: str) -> Affine:
        """Add a block with |w| ≤ |v|; return its answer."""
        name = f"w{len(self.blocks)}"
        self.blocks.append(UncertainGain(name, v, words))
        return variable(name)

    def _note(self, x: Affine, low: Fraction | None, high: Fraction | None, words: str) -> None:
        self.bounds.append(SignalBound(x.deviation, low, high, words))

    def require(self, x: Affine, low: Fraction | None, high: Fraction | None, words: str) -> None:
        """Record that the deviation of a signal stays between two numbers around 0."""
        self._note(x, low, high, words)

    # --- rule bases, tables, expressions ---

    def rules(self, rulebase: RuleBase, inputs: Mapping[str, Affine]) -> list[Affine]:
        """Return the conclusions of a rule base."""
        return self._rules(self, rulebase, inputs)

    def table(self, table: LookupTable, inputs: Mapping[str, Affine]) -> Affine:
        """Return the value of a table."""
        return self._table(self, table, inputs)

    def expression(self, root: Node, values: Mapping[str, Affine]) -> Affine:
        """Return an expression that is affine, apart from choices decided at rest."""
        return fold([root], values, self.number, self._applied)[0]

    def _applied(self, node: Apply, arguments: list[Affine]) -> Affine:
        operation = node.operation
        functions: dict[str, Callable[..., Affine]] = {
            "add": self.add,
            "subtract": self.subtract,
            "multiply": self.multiply,
            "divide": self.divide,
            "negative": lambda a: a.scaled(-ONE),
            "minimum": lambda a, b: a if self._is_less(a, b) else b,
            "maximum": lambda a, b: b if self._is_less(a, b) else a,
            "less": lambda a, b: number(float(self._is_less(a, b))),
            "less_equal": lambda a, b: number(float(self._is_less(a, b, or_equal=True))),
            "where": lambda condition, then, other: then if condition.constant else other,
        }
        if operation in functions:
            return functions[operation](*arguments)
        if all(argument.is_constant for argument in arguments):
            return number(_exactly(operation, [argument.constant for argument in arguments]))
        raise NotAffineError(f"'{operation}' of a signal is not linear")

    def _is_less(self, a: Affine, b: Affine, *, or_equal: bool = False) -> bool:
        """Return whether a is below b at rest, and record that it has to stay so."""
        way = self.subtract(b, a)
        endless = way.parts.get(INFINITY, ZERO)
        if endless:
            return endless > 0
        if way.is_constant:
            return way.constant > 0 or (or_equal and not way.constant)
        if self.is_search:
            # A limit, not active at rest, whichever side is a number.
            return a.is_constant or b.is_constant
        room = abs(way.constant) - way.doubt
        if room <= 0:
            raise NotAffineError(
                "at rest the two signals of a choice, a limit or a maximum are equal"
            )
        least, most = (-room, None) if way.constant > 0 else (None, room)
        self._note(way, least, most, "a choice")
        return way.constant > 0


def _beyond(end: Fraction, most: Fraction, rest: Fraction) -> bool:
    return abs(most - rest) > abs(end - rest)


def _end(value: float) -> Fraction:
    """Return a limit as a number for comparisons, a large one for infinity."""
    return (
        Fraction(value) if math.isfinite(value) else Fraction(10) ** 400 * (1 if value > 0 else -1)
    )


def _exactly(operation: str, values: list[Fraction]) -> Fraction:
    """Return an operation on numbers if the result is rational."""
    rational: dict[str, Callable[..., Fraction | bool]] = {
        "absolute": abs,
        "equal": lambda a, b: a == b,
        "both": lambda a, b: bool(a) and bool(b),
        "either": lambda a, b: bool(a) or bool(b),
        "negation": lambda a: not a,
    }
    if operation in rational:
        return Fraction(rational[operation](*values))
    if operation in FUNCTIONS:
        with suppress(SpanError):
            value = function(operation, exact(values[0]))
            if is_point(value):  # the sine of 0, the root of 4
                return ends(value)[0]
    if operation == "sqrt" and values[0] >= 0:
        root = Fraction(math.isqrt(values[0].numerator), math.isqrt(values[0].denominator))
        if root * root == values[0]:
            return root
    raise NotAffineError(f"'{operation}' of {float(values[0]):.6g} is not rational")
