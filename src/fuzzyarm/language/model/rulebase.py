"""The meaning of a rule base: plain frozen data, without text and numerics.

All higher packages work on these classes. They compare by meaning: the position of a rule or a term
in a file (its `span`) is not part of equality.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import TYPE_CHECKING

from fuzzyarm.base.diagnostic import NOWHERE, RuleBaseError, Span
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint, shortened
from fuzzyarm.base.numbers import counted, number_text
from fuzzyarm.base.shown import Plotted, one_line
from fuzzyarm.base.value_kinds import RULE_BASE, wrong_kind
from fuzzyarm.language.model.rulebase_methods import RuleBaseMethods, new_or_begun, of_builder
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SHAPES, DefuzzifierKind

SAMPLINGS = ("endpoints", "midpoints", "left", "trapezoid", "joined")
"""The N sample points of a defuzzifier over the range of an output. ``joined`` is for the centroid
and the bisector: integrals of straight lines between the samples instead of sums.
"""

POSITION = "x"
"""Variable of the position in a formula as a membership function."""


class NotInModelError(FuzzyarmError, KeyError):
    """A variable or a term unknown to a model.

    Attributes
    ----------
    name : str
        The requested name.
    known : tuple of str
        The names of the model.
    """

    def __init__(self, what: str, name: str, known: Sequence[str]) -> None:
        hint = near_hint(name, known)[0]
        listing = ", ".join(known[:10]) + (", …" if len(known) > 10 else "")
        message = f"no {what} is called '{name}'"
        super().__init__(message, hint=hint or (f"there are {listing}" if known else ""))
        self.name = name
        self.known = tuple(known)


@dataclass(frozen=True, slots=True, repr=False)
class Shape:
    """The membership function of a term, or the value of a consequent.

    Attributes
    ----------
    kind : str
        Its name, a key of :data:`fuzzyarm.symbolic.kinds.SHAPES`.
    parameters : tuple of float
        Its numbers in the order of the registry. For ``points``: x1, y1, x2, y2, …;
        for ``linear``: one coefficient for each input in order, then the constant.
    height : float
        Factor on the whole function, usually 1.
    formula : str
        The text of a ``formula``; empty otherwise.

    Raises
    ------
    RuleBaseError
        For an unknown kind, or a wrong number of parameters or invalid ones; its finding names the
        argument.

    Examples
    --------
    >>> Shape("triangle", (0, 1))
    Traceback (most recent call last):
    fuzzyarm.base.diagnostic.RuleBaseError: Shape(parameters): error[wrong-parameter-count]: \
triangle takes 3 numbers (left, peak, right), found 2
    """

    kind: str
    parameters: tuple[float, ...] = ()
    height: float = 1.0
    formula: str = ""

    def __post_init__(self) -> None:
        if type(self.parameters) is not tuple:
            # The record is frozen, and a list has no hash.
            object.__setattr__(self, "parameters", _numbers(self.parameters))
        # A tuple is kept: the numbers of a file carry their positions.
        elif not all(isinstance(number, Real) for number in self.parameters):
            raise _not_numbers(self.parameters)
        fault = _shape_fault(self.kind, self.parameters)
        if fault is not None:
            raise fault

    def __repr__(self) -> str:
        numbers = f", {self.parameters!r}" if self.parameters else ""
        formula = f", formula={self.formula!r}" if self.formula else ""
        height = f", height={self.height!r}" if self.height != 1.0 else ""
        return f"Shape({self.kind!r}{numbers}{height}{formula})"


def _numbers(parameters: Iterable[float]) -> tuple[float, ...]:
    """Return the parameters of a shape, given as anything but a tuple."""
    try:
        return tuple(map(float, parameters))
    except (TypeError, ValueError):
        raise _not_numbers(parameters) from None


def _not_numbers(parameters: object) -> RuleBaseError:
    message = f"expected the numbers of a shape, found {shortened(repr(parameters))}"
    return RuleBaseError.of_argument("bad-shape", message, "Shape(parameters)")


def _shape_fault(kind: str, parameters: tuple[float, ...]) -> RuleBaseError | None:
    """Return the fault in the arguments of a shape."""
    if kind not in SHAPES:
        hint, near = near_hint(kind, SHAPES)
        message = f"expected the shape of the term, found '{kind}'"
        return RuleBaseError.of_argument(
            "unknown-shape", message, "Shape(kind)", hint=hint, replacement=near
        )
    record = SHAPES[kind]
    # The number of parameters of `linear` depends on the inputs, unknown here.
    if not record.fuzzy:
        return None
    count = len(record.parameters) or 2 * max(1, len(parameters) // 2)
    if len(parameters) != count:
        names = ", ".join(name.replace("-", "_") for name in record.parameters) or "x, y, x, y, …"
        message = f"{kind} takes {count} numbers ({names}), found {len(parameters)}"
        return RuleBaseError.of_argument("wrong-parameter-count", message, "Shape(parameters)")
    fault = record.fault(parameters)
    if fault is None:
        return None
    return RuleBaseError.of_argument("bad-shape", fault[1], f"Shape(parameters[{fault[0]}])")


@dataclass(frozen=True, slots=True)
class Term:
    """A named fuzzy set (or consequent value) of one variable.

    Attributes
    ----------
    name : str
        Any text.
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
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    lower: Shape | None = None


@dataclass(frozen=True, slots=True)
class Defuzzifier:
    """The method from a fuzzy output to a number.

    Attributes
    ----------
    method : str
        A key of :data:`fuzzyarm.symbolic.kinds.DEFUZZIFIERS`.
    resolution : int or None
        None for the exact integral; else the number of samples N.
    sampling : str
        One of :data:`SAMPLINGS`; without meaning where `resolution` is None.

    Raises
    ------
    RuleBaseError
        For an unknown method or sampling; its finding names the argument.
    """

    method: str = "centroid"
    resolution: int | None = None
    sampling: str = "endpoints"

    def __post_init__(self) -> None:
        for what, word, names in (
            ("defuzzifier", self.method, DEFUZZIFIERS),
            ("sampling", self.sampling, SAMPLINGS),
        ):
            if word not in names:
                hint, near = near_hint(word, names)
                argument = "method" if what == "defuzzifier" else what
                raise RuleBaseError.of_argument(
                    f"unknown-{what}", f"unknown {what} '{word}'", f"Defuzzifier({argument})",
                    hint=hint, replacement=near,
                )  # fmt: skip

    @property
    def record(self) -> DefuzzifierKind:
        """The record of its method."""
        return DEFUZZIFIERS[self.method]

    @property
    def joined(self) -> bool:
        """Whether straight lines between samples are integrated."""
        return self.resolution is not None and self.sampling == "joined"

    def __str__(self) -> str:
        """Return the words of the language."""
        if self.resolution is None:
            return f"{self.method} exact" if self.method == "centroid" else self.method
        return f"{self.method}({self.resolution}, {self.sampling})"


@dataclass(frozen=True, slots=True, repr=False)
class Variable(Plotted):
    """The common part of inputs and outputs: a name, a range and terms.

    Attributes
    ----------
    name : str
        Any text; a name that is not an identifier is in single quotes in a file.
    low, high : float
        The range (universe of discourse), ``low < high``; infinite where unbounded.
    terms : tuple of Term
        In the order of the file.
    description : str
        Free text.
    outside : str
        Treatment of a value outside the range: ``clamp``, ``extend`` (use it unchanged) or
        ``error``.
    """

    name: str
    low: float
    high: float
    terms: tuple[Term, ...] = ()
    description: str = ""
    outside: str = "clamp"
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    def __post_init__(self) -> None:
        # Written so that NaN fails as well.
        if not self.low < self.high:
            message = f"the range of '{self.name}' must go from a lower to a higher number"
            argument = f"{type(self).__name__}(low, high)"
            raise RuleBaseError.of_argument("bad-range", message, argument)

    def __repr__(self) -> str:
        ends = f"{number_text(self.low)} .. {number_text(self.high)}"
        terms = shortened(" ".join(term.name for term in self.terms)) or "no terms"
        return f"<{type(self).__name__} {shortened(self.name)} {ends}: {terms}>"

    def term(self, name: str) -> Term:
        """Return the term `name`; raise NotInModelError if there is none."""
        for term in self.terms:
            if term.name == name:
                return term
        raise NotInModelError(f"term of '{self.name}'", name, [term.name for term in self.terms])


@dataclass(frozen=True, slots=True, repr=False)
class Input(Variable):
    """An input variable."""


@dataclass(frozen=True, slots=True, repr=False)
class Output(Variable):
    """An output variable and the way to its crisp value.

    Attributes
    ----------
    aggregation : str
        The union of the clipped sets of several rules: an S-norm. By default that of the
        defuzzifier: the sum for weighted values, the maximum for sets.
    defuzzifier : Defuzzifier
        The way from the aggregate to a number.
    no_rule : float or str
        The value where no rule fires, maybe NaN; ``"error"`` to raise, ``"hold"`` to keep the last
        value, passed by the caller.
    """

    aggregation: str = ""
    defuzzifier: Defuzzifier = Defuzzifier()
    no_rule: float | str = "error"

    def __post_init__(self) -> None:
        """Set the default aggregation."""
        Variable.__post_init__(self)
        if not self.aggregation:
            object.__setattr__(self, "aggregation", "sum" if self._weighs() else "max")

    def _weighs(self) -> bool:
        record, kinds = self.defuzzifier.record, {term.shape.kind for term in self.terms}
        if record.type2:
            return bool(kinds) and kinds <= {"singleton", "linear"}
        return record.weighs and not record.inverts  # a sum of strengths has no inverse


@dataclass(frozen=True, slots=True)
class Hedge:
    """A modifier of a membership: ``very`` (square), ``power(1.3)``, ``not`` and so on.

    Attributes
    ----------
    name : str
        A key of :data:`fuzzyarm.symbolic.kinds.HEDGES`.
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
    span: Span = field(default=NOWHERE, compare=False, repr=False)


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
    """*output is [hedges] term*; the hedges modify the output set.

    Attributes
    ----------
    variable : str
        The output.
    term : str
        Its term, or the word of a function.
    hedges : tuple of Hedge
        From left to right as written.
    """

    variable: str
    term: str
    hedges: tuple[Hedge, ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


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
        Factor on the truth of the antecedent, usually from 0 to 1.
    span : Span
        The grid cell or the ``rule`` statement.
    in_grid : bool
        Whether it came from a grid; not part of the meaning.
    """

    antecedent: Expression
    consequents: tuple[Consequent, ...]
    weight: float = 1.0
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    in_grid: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True, repr=False)
class RuleBlock:
    """Rules that share their norms. Blocks are evaluated in order.

    A later block may use an output of an earlier one as an input (chaining).

    Attributes
    ----------
    rules : tuple of Rule
        In order.
    name : str
        Any text; empty where a file has one block.
    conjunction, disjunction, implication : str
        Names of norms: of ``and``, of ``or``, of the implication.
    threshold : float
        A rule fires only where its firing strength is greater than this.
    """

    rules: tuple[Rule, ...] = ()
    name: str = ""
    conjunction: str = "min"
    disjunction: str = "max"
    implication: str = "min"
    threshold: float = 0.0

    def __repr__(self) -> str:
        norms = f"and {self.conjunction}, or {self.disjunction}, implication {self.implication}"
        return one_line(self, f"{self.name or '(unnamed)'}: {len(self.rules)} rules, {norms}")


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
    """The ``lookup`` settings of a file.

    Attributes
    ----------
    axes : tuple of LookupAxis
        Levels and thresholds of inputs.
    round : float or None
        The step of rounded values.
    """

    axes: tuple[LookupAxis, ...] = ()
    round: float | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """The demand of an ``expect`` line on one output.

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
    """An ``expect`` line: every input by name, and the demands on the outputs.

    Attributes
    ----------
    inputs : tuple of (str, float)
        Every input by name.
    outcomes : tuple of Outcome
        The demands on the outputs.
    """

    inputs: tuple[tuple[str, float], ...]
    outcomes: tuple[Outcome, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Property:
    """The claim of a ``prove`` line about one output, at every point of a box of the inputs.

    Attributes
    ----------
    kind : str
        ``value``, ``rises``, ``falls``, ``slope``, ``odd``, ``covered`` or ``table``.
    output : str
        Which output.
    region : tuple of (str, float, float)
        Inputs with a stretch of their range; the others have all of theirs.
    outcome : Outcome or None
        Required value; of ``value`` only.
    input : str
        The input of ``rises``, ``falls`` and ``slope``.
    low, high : float
        Bounds of the slope; `high` is the largest error of a ``table``.
    mode : str
        The lookup mode of a table: ``linear``, ``nearest`` or ``bins``.
    """

    kind: str
    output: str
    region: tuple[tuple[str, float, float], ...] = ()
    outcome: Outcome | None = None
    input: str = ""
    low: float = 0.0
    high: float = 0.0
    mode: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class PeakTuning:
    """Variables whose terms are movable in tuning.

    Attributes
    ----------
    variables : tuple of str
        Each by itself.
    mirrored : bool
        Whether opposite terms stay opposite about the middle of the range.
    ordered : bool
        Whether no peak may cross its neighbour's.
    partition : bool
        Whether feet are under the neighbours' peaks.
    gap : float
        Least distance of neighbouring peaks, as a share of the range.
    """

    variables: tuple[str, ...]
    mirrored: bool = False
    ordered: bool = False
    partition: bool = False
    gap: float = 0.001


@dataclass(frozen=True, slots=True)
class GainTuning:
    """Gains of a controller that may move when it is tuned.

    Attributes
    ----------
    names : tuple of str
        Names of the gains.
    low, high : float
        The range in which they may move.
    times : bool
        Whether the ends are multiples of the value in the file.
    log : bool
        Whether the scale is logarithmic; it always is for multiples.
    per_axis : bool
        Whether each axis gets its own value.
    """

    names: tuple[str, ...]
    low: float
    high: float
    times: bool = False
    log: bool = False
    per_axis: bool = False
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Tuning:
    """The ``tune`` block of a file; inference does not read it.

    Attributes
    ----------
    peaks : tuple of PeakTuning
        The terms that may move in the rule base.
    gains : tuple of GainTuning
        The gains that may move in the controller that uses it.
    kept : tuple of (str, str)
        Fixed terms with their variables; an empty term means all of the variable.
    """

    peaks: tuple[PeakTuning, ...] = ()
    gains: tuple[GainTuning, ...] = ()
    kept: tuple[tuple[str, str], ...] = ()


class AnyRuleBase(RuleBaseMethods):
    """A rule base: the immutable value of a file, or one under construction.

    Loading a file gives the value (:class:`fuzzyarm.RuleBase`), Python builds one statement by
    statement (:class:`fuzzyarm.RuleBaseBuilder`). Both can be called, drawn, checked, compiled and
    written, and every function with a rule base as argument accepts both.
    """

    __slots__ = ()

    @property
    @abstractmethod
    def model(self) -> RuleBase:
        """The value: immutable, with equality and hash."""


def model_of(rulebase: AnyRuleBase) -> RuleBase:
    """Return the value of a rule base passed to a public function."""
    if not isinstance(rulebase, AnyRuleBase):
        raise wrong_kind(rulebase, RULE_BASE)
    return rulebase.model


@dataclass(frozen=True, slots=True, repr=False)
class RuleBase(AnyRuleBase):
    """A whole fuzzy system as a value: variables, rules, and how the rules are evaluated.

    Immutable; two are equal if they mean the same, wherever their rules were written. The result of
    :func:`fuzzyarm.load`, and the `model` of a :class:`fuzzyarm.RuleBaseBuilder`, which builds one
    in Python.

    Parameters
    ----------
    name : str
        Any text.
    inputs : tuple of Input
        In the order of the file.
    outputs : tuple of Output
        In the order of the file.
    blocks : tuple of RuleBlock
        Rules that share their norms, evaluated in order.
    description : str
        Free text.
    lookup : Lookup or None
        The sampling of its table.
    expectations : tuple of Expectation
        Its ``expect`` lines.
    properties : tuple of Property
        Its ``prove`` lines.
    tuning : Tuning or None
        Its ``tune`` block.
    """

    name: str
    inputs: tuple[Input, ...] = ()
    outputs: tuple[Output, ...] = ()
    blocks: tuple[RuleBlock, ...] = ()
    description: str = ""
    lookup: Lookup | None = None
    expectations: tuple[Expectation, ...] = ()
    properties: tuple[Property, ...] = ()
    tuning: Tuning | None = None

    if not TYPE_CHECKING:  # older code builds one by this name
        __new__ = new_or_begun
        from_text = of_builder("from_text")
        of = of_builder("of")

    @property
    def model(self) -> RuleBase:
        """The value: itself."""
        return self

    def __repr__(self) -> str:
        return one_line(self, outline(self))

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules of all blocks, in order."""
        return tuple(rule for block in self.blocks for rule in block.rules)

    def variable(self, name: str) -> Input | Output:
        """Return the input or output `name`; raise NotInModelError if there is none."""
        variables: tuple[Input | Output, ...] = (*self.inputs, *self.outputs)
        for variable in variables:
            if variable.name == name:
                return variable
        raise NotInModelError("variable", name, [variable.name for variable in variables])

    @property
    def is_type2(self) -> bool:
        """Whether it has interval type-2 terms, or a type-2 defuzzifier."""
        variables: tuple[Input | Output, ...] = (*self.inputs, *self.outputs)
        return any(term.lower is not None for v in variables for term in v.terms) or any(
            output.defuzzifier.record.type2 for output in self.outputs
        )

    def output(self, name: str) -> Output:
        """Return the output `name`; raise NotInModelError if there is none."""
        for output in self.outputs:
            if output.name == name:
                return output
        raise NotInModelError("output", name, [output.name for output in self.outputs])


def outline(rulebase: RuleBase) -> str:
    """Return a rule base on one line: ``pd7: e, ce → u, 49 rules``."""
    count = len(rulebase.rules)
    names = [
        shortened(", ".join(variable.name for variable in variables)) or "nothing"
        for variables in (rulebase.inputs, rulebase.outputs)
    ]
    words = f"{names[0]} → {names[1]}, {counted(count, 'rule')}"
    return f"{shortened(rulebase.name)}: {words}"


def with_propositions(expression: Expression, change: Callable[[Is], Is]) -> Expression:
    """Return an expression with other propositions.

    Parameters
    ----------
    expression : Expression
        An antecedent.
    change : callable
        From a proposition to the one in its place.
    """
    if isinstance(expression, Is):
        return change(expression)
    if isinstance(expression, Hedged):
        return replace(expression, operand=with_propositions(expression.operand, change))
    operands = (with_propositions(operand, change) for operand in expression.operands)
    return replace(expression, operands=tuple(operands))


def propositions(expression: Expression) -> Iterator[Is]:
    """Yield every proposition in `expression`, from left to right."""
    if isinstance(expression, Is):
        yield expression
    elif isinstance(expression, Hedged):
        yield from propositions(expression.operand)
    else:
        # The reader limits how deep parentheses nest, so this may recurse.
        for operand in expression.operands:
            yield from propositions(operand)


def without_range(rulebase: RuleBase) -> Iterator[Output]:
    """Yield the outputs with infinite range and sets as conclusions: integration is impossible."""
    concluded = {
        (consequent.variable, consequent.term)
        for block in rulebase.blocks
        for rule in block.rules
        for consequent in rule.consequents
    }
    for output in rulebase.outputs:
        if math.isinf(output.low) or math.isinf(output.high):
            terms = (term for term in output.terms if (output.name, term.name) in concluded)
            if any(term.shape.kind not in _VALUES for term in terms):
                yield output


_VALUES = frozenset({"singleton", "linear", "formula"})
"""Kinds of shape that are (a formula: may be) numbers."""


def last_conclusions(rulebase: RuleBase) -> dict[str, int]:
    """Return for each output the index of the last block that concludes it.

    Only after that block is the output complete: rules that read it earlier are an error
    in the language, a cycle to inference, and in other programs they read its last value.
    """
    return {
        # Later entries replace earlier ones, so the last block wins.
        consequent.variable: index
        for index, block in enumerate(rulebase.blocks)
        for rule in block.rules
        for consequent in rule.consequents
    }
