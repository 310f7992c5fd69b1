"""Records of kinds: the whole definition of a shape, a norm or a hedge in one place.

The registries hold them by name, and the functions at the end put them there: the built-in
ones (:mod:`~fuzzyarm.symbolic.shapes`, :mod:`~fuzzyarm.symbolic.norms`) by the same
calls as a user's own (:mod:`~fuzzyarm.symbolic.kinds`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, pairwise, product
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

from fuzzyarm.base.diagnostic import MAX_MAGNITUDE, MIN_WIDTH
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.symbolic.lines import Corner, StraightShape, lines_through
from fuzzyarm.symbolic.nodes import Node, apply, symbol, symbols, trace

__all__ = [
    "HEDGES",
    "SHAPES",
    "SNORMS",
    "TNORMS",
    "HedgeKind",
    "KindError",
    "Norm",
    "Registry",
    "ShapeKind",
    "hedge",
    "shape",
    "snorm",
    "tnorm",
]

Definition = Callable[..., Any]

ENTRY_POINT = "fuzzyarm.kinds"
"""Group of entry points for modules that register kinds."""


class KindError(FuzzyarmError, ValueError):
    """An invalid kind.

    Attributes
    ----------
    kind : str
        Its name.
    """

    def __init__(self, message: str, kind: str) -> None:
        super().__init__(message)
        self.kind = kind


@dataclass(frozen=True, eq=False)
class Kind:
    """Common part of shapes, norms and hedges.

    Attributes
    ----------
    name : str
        The word in a file.
    parameters : tuple of str
        Names of its parameters, in order.
    function : callable
        The definition over nodes, see :attr:`expression`.
    doc : str
        One line for help, completion and the reference.
    names : mapping of str to str
        Its names in other programs: ``fll``, ``fcl``, ``fis`` (fuzzylite in each of these
        formats), ``jfl`` (jFuzzyLogic's FCL), ``matlab``, ``octave``, ``skfuzzy``, ``fml``.
        Alternatives are separated by commas, the one to be written first. A shape may add a
        different order of parameters after the word: ``"gaussmf deviation mean"``; a hedge of a
        FIS is the fraction of a term's index. A program not named lacks the kind.
    own : bool
        Whether a user registered it.
    sources : tuple of str
        Original publications: keys of :data:`fuzzyarm.base.sources.SOURCES`.
    """

    name: str
    parameters: tuple[str, ...]
    function: Definition | None
    doc: str = ""
    names: Mapping[str, str] = field(default_factory=dict)
    own: bool = False
    sources: tuple[str, ...] = ()

    arguments: ClassVar[tuple[str, ...]] = ("x",)

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """Symbols of the expression: the arguments, then the parameters as identifiers."""
        return (*self.arguments, *(name.replace("-", "_") for name in self.parameters))

    @cached_property
    def expression(self) -> Node:
        """The definition as an expression, traced on first use."""
        if self.function is None:
            raise TypeError(f"a {self.name} has no expression")
        return trace(self.function, self.symbols)

    @cached_property
    def scalar(self) -> Callable[..., float]:
        """The definition over floats: the arguments, then the parameters."""
        from fuzzyarm.symbolic.functions import python_function

        return python_function(self.expression, self.symbols)

    def array(self, *arguments: Any) -> Any:
        """Return the value over arrays, arguments before parameters; bits as over floats."""
        from fuzzyarm.symbolic.evaluation import evaluate_arrays

        values = dict(zip(self.symbols, arguments, strict=True))
        return evaluate_arrays(self.expression, values, as_floats=True)


class Misfit(NamedTuple):
    """The reason why a parameter of a shape is invalid.

    Attributes
    ----------
    which : int
        Index of the parameter.
    why : str
        ``nan``, ``infinite``, ``order``, ``positive`` and ``nonzero`` (a violated requirement),
        ``points`` or ``absurd``.
    message : str
        One sentence.
    """

    which: int
    why: str
    message: str


def _misfits_of_points(parameters: Sequence[float]) -> Iterator[Misfit]:
    for i in range(2, len(parameters), 2):
        if parameters[i] < parameters[i - 2]:
            yield Misfit(i, "points", "the x of points must not decrease")
        elif i >= 4 and parameters[i] == parameters[i - 4]:
            yield Misfit(i, "points", "at most two points may share an x")
    for i in range(1, len(parameters), 2):
        if not 0.0 <= parameters[i] <= 1.0:
            yield Misfit(i, "points", "a membership must lie between 0 and 1")


@dataclass(frozen=True, eq=False)
class ShapeKind(Kind):
    """A kind of membership function, or of a consequent that is a value.

    Attributes
    ----------
    ordered : bool
        Whether its parameters must not decrease.
    positive : tuple of str
        Parameters that must be greater than 0.
    nonzero : tuple of str
        Parameters that must not be 0.
    unbounded : tuple of str
        Parameters that may be infinite.
    corners : callable or None
        From the parameters to the corners (x, y) of a piecewise linear shape, left to right; a
        vertical edge is two corners at one x, and it is constant beyond the first and the last.
        None for a curved shape.
    bends : callable or None
        From the parameters to positions between which a curved shape is smooth, with some around
        its flanks. None: its parameters and the midpoints between them.
    turns : callable or None
        From the parameters to the positions at which it starts, ends or has an extremum, as far as
        they have a closed form: checks sample a curve between them. None: its parameters.
    centre : callable or None
        From the parameters to the middle of its core. None: found by search.
    inverse : callable or None
        For a monotone shape: from a degree, 0 to 1, and the parameters to the position with that
        degree (Tsukamoto's consequents). None: by search. Defined over nodes, as a definition
        is, it works in every engine and export.
    fuzzy : bool
        False for the consequents of Takagi and Sugeno, which are values, not sets.
    """

    ordered: bool = False
    positive: tuple[str, ...] = ()
    nonzero: tuple[str, ...] = ()
    unbounded: tuple[str, ...] = ()
    corners: Callable[..., Sequence[Corner]] | None = None
    bends: Callable[..., Sequence[float]] | None = None
    turns: Callable[..., Sequence[float]] | None = None
    centre: Callable[..., float] | None = None
    inverse: Callable[..., float] | None = None
    fuzzy: bool = True

    @property
    def straight(self) -> bool:
        """Whether it is piecewise linear."""
        return self.corners is not None

    @property
    def inverse_symbols(self) -> tuple[str, ...]:
        """Symbols of the expression of its inverse: the degree, then the parameters."""
        return ("degree", *self.symbols[1:])

    @cached_property
    def inverse_expression(self) -> Node | None:
        """The inverse as an expression; None if there is none, or it is plain Python."""
        if self.inverse is None:
            return None
        try:
            return trace(self.inverse, self.inverse_symbols)
        except TypeError:
            return None

    @cached_property
    def position_of(self) -> Callable[..., float] | None:
        """The inverse over floats: the degree, then the parameters."""
        from fuzzyarm.symbolic.functions import python_function

        expression = self.inverse_expression
        if expression is None:
            return self.inverse
        return python_function(expression, self.inverse_symbols)

    @cached_property
    def scalar(self) -> Callable[..., float]:
        """The degree of a float: x, then the parameters."""
        if self.straight:
            return lambda x, *parameters: self.lines(*parameters).at(x)
        return super().scalar

    def at(self, *parameters: float) -> Callable[[float], float]:
        """Return the degree as a function of x; lines are computed once."""
        if self.straight:
            return self.lines(*parameters).at
        scalar = self.scalar
        return lambda x: scalar(x, *parameters)

    def lines(self, *parameters: float, height: float = 1.0) -> StraightShape:
        """Return the lines of a piecewise linear shape, which define all its degrees.

        Parameters
        ----------
        *parameters : float
            Its parameters.
        height : float
            Height of the term: factor of the corner heights.
        """
        assert self.corners is not None
        return lines_through([(x, height * y) for x, y in self.corners(*parameters)])

    def fault(self, parameters: Sequence[float]) -> tuple[int, str] | None:
        """Return why these parameters are invalid; None if they are valid.

        Parameters
        ----------
        parameters : sequence of float
            As many as the kind has; for ``points`` x1, y1, x2, y2, ….

        Returns
        -------
        tuple of (int, str) or None
            Index of the parameter at fault and one sentence.
        """
        always = ("nan", "order", "positive", "nonzero")
        misfits = (misfit for misfit in self.misfits(parameters) if misfit.why in always)
        return next(((misfit.which, misfit.message) for misfit in misfits), None)

    def misfits(self, parameters: Sequence[float]) -> Iterator[Misfit]:
        """Yield all faults of parameters, the worst first.

        Parameters
        ----------
        parameters : sequence of float
            As for :meth:`fault`.
        """
        for i, value in enumerate(parameters):
            if math.isnan(value):
                yield Misfit(i, "nan", f"a {self.name} cannot have the number nan")
            elif math.isinf(value) and self._name_of(i) not in self.unbounded:
                yield Misfit(i, "infinite", f"a {self.name} cannot have an infinite number here")
        for i, (before, number) in enumerate(pairwise(parameters), start=1):
            if self.ordered and number < before:
                yield Misfit(i, "order", f"the numbers of a {self.name} must not decrease")
        yield from self._misfits_of_signs(parameters)
        if self.name == "points":
            yield from _misfits_of_points(parameters)
        yield from self._absurdities(parameters)

    def _misfits_of_signs(self, parameters: Sequence[float]) -> Iterator[Misfit]:
        for i, (name, value) in enumerate(zip(self.parameters, parameters, strict=False)):
            if name in self.positive and not value > 0.0:
                yield Misfit(i, "positive", f"{self.number_words(name)} must be above 0")
            if name in self.nonzero and value == 0.0:
                yield Misfit(i, "nonzero", f"{self.number_words(name)} must not be 0")

    def _absurdities(self, parameters: Sequence[float]) -> Iterator[Misfit]:
        """Yield parameters that make areas or moments overflow."""
        signed = (*self.positive, *self.nonzero)
        for i, value in enumerate(parameters):
            if MAX_MAGNITUDE < abs(value) < math.inf:
                message = f"a {self.name} cannot have numbers beyond {MAX_MAGNITUDE:g}"
                yield Misfit(i, "absurd", message)
            elif abs(value) < MIN_WIDTH and (name := self._name_of(i)) in signed:
                yield Misfit(i, "absurd", f"{self.number_words(name)} is below {MIN_WIDTH:g}")

    def _name_of(self, index: int) -> str:
        return self.parameters[index] if index < len(self.parameters) else ""

    def number_words(self, name: str) -> str:
        """Return the name of a parameter in a message: ``the deviation of a gaussian``."""
        return f"the {name.replace('-', ' ')} of a {self.name}"

    def array(self, *arguments: Any) -> Any:
        """Return the degrees over an array: x, then the parameters."""
        if self.straight:
            import numpy as np

            return self.lines(*arguments[1:]).over(np.asarray(arguments[0], dtype=float))
        return super().array(*arguments)


@dataclass(frozen=True, eq=False)
class Norm(Kind):
    """A T-norm (*and*, implication) or an S-norm (*or*, aggregation).

    Attributes
    ----------
    dual : str
        The dual norm: S(a, b) = 1 − T(1 − a, 1 − b). Empty if there is none.
    lines : callable or None
        For an implication that keeps piecewise linear sets so: from the strength w to lines
        α + β μ, as pairs (α, β), of which the implied set is the minimum. None: it may bend them.
    aggregates : bool
        Whether it is for aggregation only, as a sum that may exceed 1.
    positive : bool
        For a T-norm: whether it is known to be positive for positive operands.
    leaves_ones : bool
        For a T-norm: whether, of a set cut below 1, it keeps only the points of degree 1.
    """

    dual: str = ""
    lines: Callable[[Any], tuple[tuple[Any, Any], ...]] | None = None
    aggregates: bool = False
    positive: bool = False
    leaves_ones: bool = False

    arguments: ClassVar[tuple[str, ...]] = ("a", "b")

    def array(self, *arguments: Any) -> Any:
        """Return the norm of two arrays of degrees."""
        for name in ("minimum", "maximum"):
            if self.expression is apply(name, *map(symbol, self.symbols)):
                import numpy as np

                # NumPy's functions are faster; they differ for NaN and -0.0, which are not degrees.
                return getattr(np, name)(*arguments)
        return super().array(*arguments)


@dataclass(frozen=True, eq=False)
class HedgeKind(Kind):
    """A modifier of a degree.

    Attributes
    ----------
    straight : bool
        Whether it keeps straight pieces straight.
    bends : tuple of float
        Degrees at which it bends.
    aliases : tuple of str
        Synonyms.
    """

    straight: bool = False
    bends: tuple[float, ...] = ()
    aliases: tuple[str, ...] = ()

    arguments: ClassVar[tuple[str, ...]] = ("d",)


_Kind = TypeVar("_Kind", bound=Kind)


_emptied: list[Callable[[], object]] = []


def emptied_with_kinds(clear: Callable[[], object]) -> None:
    """Call `clear`, which empties a cache, whenever a kind is registered or removed."""
    _emptied.append(clear)


def _forget() -> None:
    for clear in _emptied:
        clear()


class Registry(Mapping[str, _Kind], Generic[_Kind]):
    """Kinds of one sort by name, in the order of registration.

    An unknown name is looked up among the entry points, once.

    Attributes
    ----------
    words : dict of str to str
        Every word for a kind, aliases included, and the name of that kind.
    """

    def __init__(self, sort: str) -> None:
        self.sort = sort
        self.words: dict[str, str] = {}
        self._kinds: dict[str, _Kind] = {}

    def __getitem__(self, name: str) -> _Kind:
        if name not in self._kinds:
            _load_entry_points()
        return self._kinds[name]

    def __contains__(self, name: object) -> bool:
        if name not in self._kinds:
            _load_entry_points()
        return name in self._kinds

    def __iter__(self) -> Iterator[str]:
        return iter(tuple(self._kinds))

    def __len__(self) -> int:
        return len(self._kinds)

    @property
    def foreign(self) -> dict[str, tuple[str, str]]:
        """Names in other programs, in lower case → the name here.

        With it comes the order of parameters here, if it differs there.
        """
        spellings: dict[str, tuple[str, str]] = {}
        for kind in self._kinds.values():
            for spelling in chain.from_iterable(text.split(",") for text in kind.names.values()):
                # As in "dsigmf slope1 inflection1 …": the word, then the parameters in the order of
                # the other program, if that differs.
                word, *order = spelling.casefold().split()
                if word not in self.words and not word[0].isdigit():
                    spellings.setdefault(
                        word, (kind.name, " ".join(kind.parameters) if order else "")
                    )
        return spellings

    def add(self, kind: _Kind) -> _Kind:
        """Register a kind; a user-defined one may be replaced."""
        earlier = self._kinds.get(kind.name)
        if earlier is not None and not earlier.own:
            raise KindError(f"'{kind.name}' is a built-in {self.sort}", kind.name)
        if not _WORD.fullmatch(kind.name):
            message = f"'{kind.name}' is not a word of small letters, digits and hyphens"
            raise KindError(message, kind.name)
        # A user-defined kind may replace an earlier one: drop everything compiled from it.
        self._kinds[kind.name] = kind
        _forget()
        self.words |= dict.fromkeys((kind.name, *getattr(kind, "aliases", ())), kind.name)
        return kind

    def remove(self, name: str) -> None:
        """Remove a user-defined kind; KeyError if there is none."""
        if not self._kinds[name].own:
            raise KeyError(name)
        del self._kinds[name]
        _forget()
        for word in [word for word, kind in self.words.items() if kind == name]:
            del self.words[word]


SHAPES: Registry[ShapeKind] = Registry("shape")
TNORMS: Registry[Norm] = Registry("T-norm")
SNORMS: Registry[Norm] = Registry("S-norm")
HEDGES: Registry[HedgeKind] = Registry("hedge")

_WORD = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
_PARAMETER = re.compile(r"[a-z][a-z0-9]*([_-][a-z0-9]+)*")

_loaded: list[str] = []
"""The group of entry points, once loaded."""


failures: list[str] = []
"""Failures to load kinds of other packages, a sentence each."""


def _load_entry_points() -> None:
    """Import the modules of entry points, once in a process; a failure is noted in `failures`."""
    if _loaded:
        return
    # Noted before the import: a module that looks a kind up while loading comes back here.
    _loaded.append(ENTRY_POINT)
    from importlib.metadata import entry_points

    for point in entry_points(group=ENTRY_POINT):
        try:
            registration = point.load()
            if callable(registration):
                registration()
        except (Exception, SystemExit) as error:  # foreign code may raise anything
            text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
            failures.append(f"the kinds '{point.name}' ({point.value}) cannot be loaded: {text}")


# ── registration ─────────────────────────────────────────────────────────────────────


def shape(
    name: str, parameters: Sequence[str], function: Definition | None, **facts: Any
) -> ShapeKind:
    """Register a kind of membership function.

    Parameters
    ----------
    name : str
        The word in a file: small letters, digits and hyphens.
    parameters : sequence of str
        Names of its parameters, in order.
    function : callable
        ``function(x, *parameters)``, written with arithmetic, comparisons and
        :mod:`fuzzyarm.op`; returns the degree, 0 to 1.
    **facts
        Further fields of :class:`ShapeKind`: ``doc``, ``ordered``, ``positive``, ``bends``,
        ``centre`` and so on.

    Returns
    -------
    ShapeKind
        The record.

    Raises
    ------
    KindError
        If the name is taken or not a word, or the function cannot be traced.

    Examples
    --------
    >>> from fuzzyarm import kinds, op
    >>> bump = kinds.shape(
    ...     "bump", ("centre", "width"),
    ...     lambda x, centre, width: op.maximum(0, 1 - ((x - centre) / width) ** 2),
    ... )
    >>> bump.scalar(0.5, 0.0, 1.0)
    0.75
    """
    for parameter in parameters:
        if not _PARAMETER.fullmatch(parameter):
            raise KindError(f"'{parameter}' is not the name of a parameter", name)
    kind = ShapeKind(name, tuple(parameters), function, **{"own": True, **facts})
    _check_expression(kind)
    return SHAPES.add(kind)


def tnorm(name: str, function: Definition, **facts: Any) -> Norm:
    """Register a T-norm: conjunction, and implication of a rule.

    Parameters
    ----------
    name : str
        The word in a file.
    function : callable
        ``function(a, b)`` of two degrees, written with arithmetic, comparisons and
        :mod:`fuzzyarm.op`.
    **facts
        Further fields of :class:`Norm`.

    Returns
    -------
    Norm
        The record.

    Raises
    ------
    KindError
        If the name is taken or not a word, or the function violates T(1, 1) = 1, T(0, 0) = 0 or
        the range 0 .. 1.
    """
    return TNORMS.add(_norm(name, function, facts))


def snorm(name: str, function: Definition, **facts: Any) -> Norm:
    """Register an S-norm: disjunction, and aggregation of rules.

    See :func:`tnorm`.
    """
    return SNORMS.add(_norm(name, function, facts))


def hedge(name: str, function: Definition, **facts: Any) -> HedgeKind:
    """Register a hedge: a modifier of a degree such as ``very``.

    Parameters
    ----------
    name : str
        The word in a file.
    function : callable
        ``function(d)`` of a degree, or ``function(d, number)`` with the number in
        ``name(number)``.
    **facts
        Further fields of :class:`HedgeKind`; ``parameters=("exponent",)`` names the number.

    Returns
    -------
    HedgeKind
        The record.

    Raises
    ------
    KindError
        If the name is taken or not a word, or a degree leaves 0 .. 1.
    """
    parameters = tuple(facts.pop("parameters", ()))
    kind = HedgeKind(name, parameters, function, **{"own": True, **facts})
    _check_expression(kind)
    if kind.own and not parameters:
        _check_degrees(kind)
    return HEDGES.add(kind)


def _norm(name: str, function: Definition, facts: dict[str, Any]) -> Norm:
    kind = Norm(name, (), function, **{"own": True, **facts})
    if kind.own:
        _check_expression(kind)
        _check_degrees(kind)
        # Only properties common to T- and S-norms; associativity is not tested.
        for end in (0.0, 1.0):
            if kind.scalar(end, end) != end:
                message = f"'{name}' of {end:g} and {end:g} is not {end:g}"
                raise KindError(message, name)
    return kind


def _check_expression(kind: Kind) -> None:
    """Trace a user's definition at once, so that the traceback leads to its mistake."""
    if not kind.own:
        return
    try:
        unknown = set(symbols(kind.expression)) - set(kind.symbols)
    except (TypeError, AttributeError) as error:
        message = f"the definition of '{kind.name}' cannot be traced: {error}"
        raise KindError(message, kind.name) from error
    if unknown:
        raise KindError(f"the definition of '{kind.name}' uses '{min(unknown)}'", kind.name)


def _check_degrees(kind: Kind) -> None:
    grid = [i / 8 for i in range(9)]
    # A grid proves nothing; it catches definitions that clearly leave 0 .. 1.
    for arguments in product(grid, repeat=len(kind.arguments)):
        degree = kind.scalar(*arguments)
        if not 0.0 <= degree <= 1.0 and not getattr(kind, "aggregates", False):
            where = ", ".join(f"{value:g}" for value in arguments)
            message = f"'{kind.name}' gives {degree:g} at ({where}), outside 0 .. 1"
            raise KindError(message, kind.name)
