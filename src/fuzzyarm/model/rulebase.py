"""What a rule base *means*: plain frozen data, free of text and of numerics.

Everything above works on these classes. They compare by meaning: where a rule or a
term stood in a file (its `span`) takes no part in equality.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from fuzzyarm.text.diagnostic import NOWHERE, Span

SAMPLINGS = ("endpoints", "midpoints", "left", "trapezoid")
"""How a sampled defuzzifier spreads N points over the range of an output."""

DEFUZZIFIERS = (
    "centroid", "bisector", "mean-of-maximum", "smallest-of-maximum", "largest-of-maximum",
    "weighted-average", "weighted-sum", "tsukamoto",
    "karnik-mendel", "karnik-mendel-left", "karnik-mendel-right", "nie-tan",
)  # fmt: skip
"""Ways from a fuzzy output (or a list of fired consequents) to a number."""

KARNIK_MENDEL = frozenset({"karnik-mendel", "karnik-mendel-left", "karnik-mendel-right"})
"""Defuzzifiers that go by the ends of the centroid: its middle, or one of the two."""

TYPE_2 = KARNIK_MENDEL | {"nie-tan"}
"""Defuzzifiers that take an interval type-2 set: all between a lower and an upper one."""

TAKAGI_SUGENO = frozenset({"weighted-average", "weighted-sum"})
"""Defuzzifiers that weigh consequents which are values."""

WEIGHTED = TAKAGI_SUGENO | {"tsukamoto"}
"""Defuzzifiers that turn every consequent into a number first."""


POSITION = "x"
"""The name under which a formula that is a membership function knows where it is."""


@dataclass(frozen=True, slots=True)
class Shape:
    """The membership function of a term, or the value of a consequent.

    Attributes
    ----------
    kind : str
        A key of :data:`fuzzyarm.expression.kinds.SHAPES`.
    parameters : tuple of float
        Its numbers in the order of the registry. For ``points``: x1, y1, x2, y2, …;
        for ``linear``: one coefficient for each input in order, then the constant.
    height : float
        Factor on the whole function, 1 as a rule.
    formula : str
        The text of a ``formula``; empty otherwise.
    """

    kind: str
    parameters: tuple[float, ...] = ()
    height: float = 1.0
    formula: str = ""


@dataclass(frozen=True, slots=True)
class Term:
    """A named fuzzy set (or consequent value) of one variable.

    Attributes
    ----------
    name : str
        Free.
    shape : Shape
        Its membership function; of an interval type-2 term the upper one.
    span : Span
        Its name in the file.
    lower : Shape or None
        The lower membership function of an interval type-2 term, nowhere above `shape`; None
        for a term of type 1.
    """

    name: str
    shape: Shape
    span: Span = field(default=NOWHERE, compare=False)
    lower: Shape | None = None


@dataclass(frozen=True, slots=True)
class Defuzzifier:
    """How a fuzzy output becomes a number.

    Attributes
    ----------
    method : str
        One of :data:`DEFUZZIFIERS`.
    resolution : int or None
        None for the exact integral; else the number of samples N.
    sampling : str
        One of :data:`SAMPLINGS`; without meaning where `resolution` is None.
    """

    method: str = "centroid"
    resolution: int | None = None
    sampling: str = "endpoints"

    def __str__(self) -> str:
        """Return the words of the language."""
        if self.resolution is None:
            return f"{self.method} exact" if self.method == "centroid" else self.method
        return f"{self.method}({self.resolution}, {self.sampling})"


@dataclass(frozen=True, slots=True)
class Variable:
    """What inputs and outputs have in common: a name, a range and its terms.

    Attributes
    ----------
    name : str
        Any text; names that are not identifiers stand in single quotes in a file.
    low, high : float
        The range (universe of discourse), ``low < high``; infinite where unbounded.
    terms : tuple of Term
        In the order of the file.
    description : str
        Free text.
    outside : str
        What happens to a value outside the range: ``clamp``, ``extend`` (use as it is)
        or ``error``.
    """

    name: str
    low: float
    high: float
    terms: tuple[Term, ...] = ()
    description: str = ""
    outside: str = "clamp"
    span: Span = field(default=NOWHERE, compare=False)

    def term(self, name: str) -> Term:
        """Return the term called `name`; raise KeyError where there is none."""
        for term in self.terms:
            if term.name == name:
                return term
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class Input(Variable):
    """An input variable."""


@dataclass(frozen=True, slots=True)
class Output(Variable):
    """An output variable and the way to its crisp value.

    Attributes
    ----------
    aggregation : str
        How the clipped sets of several rules become one: an S-norm.
    defuzzifier : Defuzzifier
        The way from the aggregate to a number.
    no_rule : float or str
        The value where no rule fires; ``"error"`` to raise, ``"hold"`` to keep the value
        that the caller passes as the last one.
    """

    aggregation: str = "max"
    defuzzifier: Defuzzifier = Defuzzifier()
    no_rule: float | str = "error"


@dataclass(frozen=True, slots=True)
class Hedge:
    """A modifier of a membership: ``very`` (square), ``power(1.3)``, ``not`` and so on.

    Attributes
    ----------
    name : str
        A key of :data:`fuzzyarm.expression.kinds.HEDGES`.
    exponent : float or None
        The number of ``power``; None for the others.
    """

    name: str
    exponent: float | None = None


@dataclass(frozen=True, slots=True)
class Is:
    """The proposition *variable is [hedges] term*; the hedge next to the term acts first."""

    variable: str
    term: str
    hedges: tuple[Hedge, ...] = ()
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class And:
    """A conjunction of two or more expressions, taken from left to right."""

    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Or:
    """A disjunction of two or more expressions, taken from left to right."""

    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Hedged:
    """Hedges on a whole expression: ``not (…)``, ``very (…)``."""

    hedges: tuple[Hedge, ...]
    operand: Expression


Expression = Is | And | Or | Hedged


@dataclass(frozen=True, slots=True)
class Consequent:
    """*output is [hedges] term*; the hedges modify the output set."""

    variable: str
    term: str
    hedges: tuple[Hedge, ...] = ()
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule: where its antecedent holds, its consequents are asserted.

    Attributes
    ----------
    antecedent : Expression
        Its truth, times `weight`, is the firing strength.
    consequents : tuple of Consequent
        One or more.
    weight : float
        Factor on the truth of the antecedent, 0 to 1 as a rule.
    span : Span
        The grid cell or the ``rule`` statement.
    in_grid : bool
        Whether it stood in a grid; no part of the meaning.
    """

    antecedent: Expression
    consequents: tuple[Consequent, ...]
    weight: float = 1.0
    span: Span = field(default=NOWHERE, compare=False)
    in_grid: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class RuleBlock:
    """Rules that share their norms. Blocks are evaluated in order.

    A later block may use an output of an earlier one as an input (chaining).

    Attributes
    ----------
    rules : tuple of Rule
        In order.
    name : str
        Free; empty where a file has one block.
    conjunction, disjunction, implication : str
        Names of norms.
    threshold : float
        A rule fires only where its firing strength is greater than this.
    """

    rules: tuple[Rule, ...] = ()
    name: str = ""
    conjunction: str = "min"
    disjunction: str = "max"
    implication: str = "min"
    threshold: float = 0.0


@dataclass(frozen=True, slots=True)
class LookupAxis:
    """How one input is sampled by `compile` and found again at run time.

    Attributes
    ----------
    variable : str
        The input.
    levels : tuple of float
        Increasing sample points.
    bins : tuple of float or None
        Increasing thresholds between neighbouring levels, one fewer than levels; an input
        equal to a threshold belongs to the lower cell. None: the nearest level.
    """

    variable: str
    levels: tuple[float, ...]
    bins: tuple[float, ...] | None = None


@dataclass(frozen=True, slots=True)
class Lookup:
    """The ``lookup`` settings of a file."""

    axes: tuple[LookupAxis, ...] = ()
    round: float | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """What an ``expect`` line says of one output.

    Attributes
    ----------
    variable : str
        The output.
    relation : str
        ``=``, ``<``, ``<=``, ``>``, ``>=`` or ``in``.
    value : float
        The right side; the lower end of ``in``.
    other : float or None
        The tolerance of ``=`` (None: 1e-9 of the output's range); the upper end of ``in``.
    """

    variable: str
    relation: str
    value: float
    other: float | None = None


@dataclass(frozen=True, slots=True)
class Expectation:
    """An ``expect`` line: every input by name, and what must then hold."""

    inputs: tuple[tuple[str, float], ...]
    outcomes: tuple[Outcome, ...]
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Property:
    """What a ``prove`` line says of one output, at every point of a box of the inputs.

    Attributes
    ----------
    kind : str
        ``value``, ``rises``, ``falls``, ``slope``, ``odd``, ``covered`` or ``table``.
    output : str
        Which output.
    region : tuple of (str, float, float)
        Inputs with a stretch of their range; the others take all of theirs.
    outcome : Outcome or None
        What the value must be; of ``value`` only.
    input : str
        The input of ``rises``, ``falls`` and ``slope``.
    low, high : float
        Between what the slope must lie; `high` is the worst error of a ``table``.
    mode : str
        How the table is looked up: ``linear``, ``nearest`` or ``bins``.
    """

    kind: str
    output: str
    region: tuple[tuple[str, float, float], ...] = ()
    outcome: Outcome | None = None
    input: str = ""
    low: float = 0.0
    high: float = 0.0
    mode: str = ""
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class RuleBase:
    """A whole fuzzy system: variables, rules, and how the rules are evaluated."""

    name: str
    inputs: tuple[Input, ...] = ()
    outputs: tuple[Output, ...] = ()
    blocks: tuple[RuleBlock, ...] = ()
    description: str = ""
    lookup: Lookup | None = None
    expectations: tuple[Expectation, ...] = ()
    properties: tuple[Property, ...] = ()

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules of all blocks, in order."""
        return tuple(rule for block in self.blocks for rule in block.rules)

    def variable(self, name: str) -> Input | Output:
        """Return the input or output called `name`; raise KeyError where there is none."""
        variables: tuple[Input | Output, ...] = (*self.inputs, *self.outputs)
        for variable in variables:
            if variable.name == name:
                return variable
        raise KeyError(name)

    @property
    def is_type2(self) -> bool:
        """Whether it has interval type-2 terms, or an output that is defuzzified as such."""
        variables: tuple[Input | Output, ...] = (*self.inputs, *self.outputs)
        return any(term.lower is not None for v in variables for term in v.terms) or any(
            output.defuzzifier.method in TYPE_2 for output in self.outputs
        )

    def output(self, name: str) -> Output:
        """Return the output called `name`; raise KeyError where there is none."""
        for output in self.outputs:
            if output.name == name:
                return output
        raise KeyError(name)


def propositions(expression: Expression) -> Iterator[Is]:
    """Yield every proposition in `expression`, from left to right."""
    if isinstance(expression, Is):
        yield expression
    elif isinstance(expression, Hedged):
        yield from propositions(expression.operand)
    else:
        for operand in expression.operands:
            yield from propositions(operand)


def last_conclusions(rulebase: RuleBase) -> dict[str, int]:
    """Return for each output the index of the last block that concludes it.

    Only behind that block is the output complete: rules that read it earlier are a fault to the
    language, a circle to inference, and to other programs they take its last value.
    """
    return {
        consequent.variable: index
        for index, block in enumerate(rulebase.blocks)
        for rule in block.rules
        for consequent in rule.consequents
    }
