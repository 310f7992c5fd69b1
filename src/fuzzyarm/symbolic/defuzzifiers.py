"""Defuzzifiers: one record each, the single definition of a defuzzifier.

``defuzzifier middle-of-maximum`` is one record: its word, its value as one expression, its names
in other programs, one line of help. The reader, checks, completion and help, foreign formats,
inference at a point, over arrays and as machine code, C, Structured Text, JavaScript, traces and
proofs all read that record.

The value is an expression over figures of the aggregate, found by their names:

====================  ==============================================================================
``centroid``          the centre of gravity of the set; for numbers their average
``half``              the position that halves the area; for numbers the sum of strengths
``first``, ``last``   the first and the last position of the maximum; for numbers those of the
                      greatest strength
``mean``              the mean of the positions of the maximum
``nearest``           the position of the maximum nearest to 0; of two the negative one
``left``, ``right``   the ends of the centroid of an interval type-2 set (Karnik and Mendel)
``average``           average of the consequents' numbers, weighted by strength
``weighted``          the sum of these numbers times their strengths
====================  ==============================================================================

All evaluators of aggregates (:mod:`fuzzyarm.inference`, :mod:`fuzzyarm.proof.map`) provide these
figures for values, samples, straight lines and panels of curves.

To add a defuzzifier
--------------------
One over the figures above is a record here, a row in
``tests/inference/test_defuzzifiers.py`` with a value worked out by hand (``tests/kinds`` compares
engines with each other), and its name in ``docs/explanation/inference.md``
(``tests/inference/test_inference_page.py``); ``pytest --update-golden tests/language tests/lsp``
renews the table and the editor's grammar.

A new figure is a name in ``ASPECTS``; a ``DefuzzifierProgram`` of the kernel
(:mod:`fuzzyarm.inference.programs`), from which the exports print it; a record in ``WAYS`` of
:mod:`fuzzyarm.proof.map.crisp` with its bounds, or it is refused by name; and a row of
``tests/inference/test_matrix.py`` and ``tests/proof/test_every_defuzzifier.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from fuzzyarm.symbolic.evaluation import evaluate, gradient
from fuzzyarm.symbolic.nodes import Constant, Node, Symbol, argument_names, symbols
from fuzzyarm.symbolic.op import where
from fuzzyarm.symbolic.records import Kind, KindError, Registry

__all__ = ["ASPECTS", "DEFUZZIFIERS", "Aspect", "DefuzzifierKind", "defuzzifier"]

X = Any
"""An expression or a number."""


class Aspect(NamedTuple):
    """A view of an aggregate: a group of figures.

    Attributes
    ----------
    figures : tuple of str
        Its figures.
    integrates : bool
        Whether they depend on the area of a set, so that linear interpolation between samples
        matters.
    weighs : bool
        Whether consequents are reduced to numbers first.
    jumps : bool
        Whether they are discontinuous in the strengths.
    """

    figures: tuple[str, ...]
    integrates: bool = False
    weighs: bool = False
    jumps: bool = False


ASPECTS = {
    "gravity": Aspect(("centroid",), integrates=True),
    "area": Aspect(("half",), integrates=True),
    "top": Aspect(("first", "last", "mean", "nearest"), jumps=True),
    "ends": Aspect(("left", "right"), integrates=True),
    "average": Aspect(("average",), weighs=True),
    "sum": Aspect(("weighted",), weighs=True),
}
"""All aspects; a defuzzifier uses figures of one of them."""

# The argument names of a definition determine its aspect.
_ASPECT_OF = {figure: name for name, aspect in ASPECTS.items() for figure in aspect.figures}


@dataclass(frozen=True, eq=False)
class DefuzzifierKind(Kind):
    """A defuzzifier.

    Attributes
    ----------
    both : bool
        For a centroid: whether it is the mean of the lower and the upper set of an interval type-2
        set taken together.
    inverts : bool
        Whether the number of a set is the position at which it reaches its strength (Tsukamoto),
        not the middle of its core.
    like : str
        The most similar one, for programs that lack this one.
    elsewhere : str
        Synonyms in other programs, in lower case, separated by blanks.
    """

    both: bool = False
    inverts: bool = False
    like: str = ""
    elsewhere: str = ""

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """The figures in its value, in the order of its arguments."""
        assert self.function is not None
        return argument_names(self.function)

    @cached_property
    def of(self) -> str:
        """Its view of an aggregate: a key of :data:`ASPECTS`."""
        return _ASPECT_OF[self.symbols[0]]

    @property
    def aspect(self) -> Aspect:
        """The aspect's properties."""
        return ASPECTS[self.of]

    @cached_property
    def figure(self) -> str:
        """The figure that is its value; empty if the value is an expression of figures."""
        return self.expression.name if isinstance(self.expression, Symbol) else ""

    @property
    def type2(self) -> bool:
        """Whether it is for interval type-2 sets, with a lower and an upper membership function."""
        return self.both or self.of == "ends"

    @property
    def joins(self) -> bool:
        """Whether it supports linearly joined samples."""
        return self.aspect.integrates and not self.type2

    @property
    def weighs(self) -> bool:
        """Whether consequents are reduced to numbers first."""
        return self.aspect.weighs

    @cached_property
    def rises(self) -> bool:
        """Whether its value is known to increase with each of its figures."""
        return all(isinstance(slope, Constant) and slope.value >= 0.0 for slope in self._slopes)

    @cached_property
    def is_between(self) -> bool:
        """Whether its value is known to lie between its smallest and its largest figure."""
        if not self.rises or self.of == "sum" or self.inverts:
            return False
        # Constant slopes of at least 0 that sum to 1, and value 0 at 0: a weighted mean.
        nothing = evaluate(self.expression, dict.fromkeys(self.symbols, 0.0))
        return nothing == 0.0 and sum(slope.value for slope in self._slopes) == 1.0  # type: ignore[attr-defined]

    @cached_property
    def _slopes(self) -> tuple[Node, ...]:
        return gradient(self.expression, self.symbols)

    def value(self, figures: Mapping[str, X]) -> X:
        """Return the value from figures by name: floats or arrays."""
        if self.figure:
            return figures[self.figure]
        arguments = [figures[name] for name in self.symbols]
        if all(isinstance(figure, float) for figure in arguments):
            return self.scalar(*arguments)
        return self.array(*arguments)


class Defuzzifiers(Registry[DefuzzifierKind]):
    """All defuzzifiers by their words; an unknown word raises `KindError`."""

    def __getitem__(self, name: str) -> DefuzzifierKind:
        # `in` loads the kinds of other packages, so test it last.
        kind = self._kinds.get(name)
        if kind is None and name not in self:
            raise KindError(f"no defuzzifier is called '{name}'", name)
        return kind or super().__getitem__(name)

    @property
    def foreign(self) -> dict[str, tuple[str, str]]:
        """Synonyms in lower case → the name here."""
        names = {word: (kind.name, "") for kind in self.values() for word in kind.elsewhere.split()}
        return super().foreign | names

    def plain(self, figure: str) -> str:
        """Return the name of the built-in defuzzifier whose value is this figure alone."""
        return next(n for n, kind in self.items() if kind.figure == figure and not kind.own)


DEFUZZIFIERS = Defuzzifiers("defuzzifier")
"""Every defuzzifier by its word."""


def defuzzifier(name: str, value: Callable[..., X], **facts: Any) -> DefuzzifierKind:
    """Register a defuzzifier: from an aggregated set, or weighted numbers, to one number.

    Parameters
    ----------
    name : str
        The word in a file: small letters, digits and hyphens.
    value : callable
        Its value over figures of the aggregate: ``centroid``; ``half``; ``first``, ``last``,
        ``mean`` and ``nearest`` of the maximum; ``left`` and ``right`` of an interval type-2 set;
        ``average`` or ``weighted`` of numbers. With arithmetic, comparisons and
        :mod:`fuzzyarm.op`.
    **facts
        Further fields of :class:`DefuzzifierKind`: ``doc``, ``names``, ``like`` …

    Returns
    -------
    DefuzzifierKind
        The record.

    Raises
    ------
    KindError
        If the name is taken or not a word, an argument is not a figure, figures belong to
        different aspects, or the value cannot be traced.

    Examples
    --------
    >>> from fuzzyarm import kinds
    >>> late = kinds.defuzzifier("late-maximum", lambda first, last: 0.25 * first + 0.75 * last)
    >>> late.of
    'top'
    """
    kind = DefuzzifierKind(name, (), value, **{"own": True, **facts})
    unknown = [symbol for symbol in kind.symbols if symbol not in _ASPECT_OF]
    if unknown:
        raise KindError(f"no aggregate has the argument '{unknown[0]}' of '{name}'", name)
    if not kind.symbols:
        raise KindError(f"the value of '{name}' uses no number of an aggregate", name)
    others = [symbol for symbol in kind.symbols if _ASPECT_OF[symbol] != kind.of]
    if others:
        both = f"{kind.symbols[0]} and {others[0]}"
        raise KindError(f"'{name}' takes {both}, which cannot be combined", name)
    if kind.both and kind.of != "gravity":
        raise KindError(
            f"'{name}' is not a centroid; only a centroid can be taken of both sets", name
        )
    if kind.inverts and not kind.weighs:
        raise KindError(f"'{name}' inverts sets, and weighs no numbers", name)
    if kind.like and kind.like not in DEFUZZIFIERS:
        raise KindError(f"'{name}' is like '{kind.like}', which is not a defuzzifier", name)
    try:
        names = set(symbols(kind.expression))
    except (TypeError, AttributeError) as error:
        raise KindError(f"the value of '{name}' cannot be traced: {error}", name) from error
    if not names <= set(kind.symbols):
        raise KindError(f"the value of '{name}' uses '{min(names - set(kind.symbols))}'", name)
    return DEFUZZIFIERS.add(kind)


# ── the defuzzifiers ─────────────────────────────────────────────────────────────────


def _register() -> None:
    """Register the built-in defuzzifiers, in display order."""

    def kind(name: str, value: Callable[..., X], **facts: Any) -> None:
        defuzzifier(name, value, own=False, **facts)

    kind(
        "centroid",
        lambda centroid: centroid,
        doc="the centre of gravity of the aggregated set",
        names={"fll": "Centroid", "fcl": "COG", "jfl": "COG", "fcl-scikit": "COG, COGS"}
        | {"fis": "centroid, centroid_integral", "matlab": "centroid, centroid_integral"}
        | {"octave": "centroid, centroid_integral", "skfuzzy": "centroid", "fml": "COG"},
        elsewhere="cog coa cofg cogf centerofgravity",
    )
    kind(
        "bisector",
        lambda half: half,
        doc="the position that halves the area of the aggregated set",
        names={"fll": "Bisector", "fcl": "COA", "jfl": "COA", "fcl-scikit": "COA"}
        | {"fis": "bisector", "matlab": "bisector", "octave": "bisector"}
        | {"skfuzzy": "bisector", "fml": "COA"},
        elsewhere="boa bisectorofarea",
    )
    kind(
        "mean-of-maximum",
        lambda mean: mean,
        doc="the mean of all positions at which the set is greatest",
        names={"fll": "MeanOfMaximum", "fcl": "MM", "jfl": "MM", "fcl-scikit": "MM, MOM"}
        | {"fis": "mom", "matlab": "mom", "octave": "mom", "skfuzzy": "mom", "fml": "MOM"},
        elsewhere="mom mm meanofmaximum",
    )
    kind(
        "smallest-of-maximum",
        lambda first: first,
        doc="the first position at which the set is greatest",
        names={"fll": "SmallestOfMaximum", "fcl": "LM", "jfl": "LM", "fcl-scikit": "LM"}
        | {"fis": "som", "octave": "som", "skfuzzy": "som", "fml": "LM"},
        elsewhere="som lm smallestofmaximum",
    )
    kind(
        "largest-of-maximum",
        lambda last: last,
        doc="the last position at which the set is greatest",
        names={"fll": "LargestOfMaximum", "fcl": "RM", "jfl": "RM", "fcl-scikit": "RM"}
        | {"fis": "lom", "octave": "lom", "skfuzzy": "lom", "fml": "RM"},
        elsewhere="lom rm largestofmaximum",
    )
    kind(
        "middle-of-maximum",
        lambda first, last: 0.5 * (first + last),
        doc="the middle between the first and the last position at which the set is greatest",
        like="mean-of-maximum",
        elsewhere="middleofmaximum",
    )
    kind(
        "nearest-of-maximum",
        lambda nearest: nearest,
        doc="the position nearest to 0 at which the set is greatest",
        like="smallest-of-maximum",
        names={"matlab": "som"},
    )
    kind(
        "farthest-of-maximum",
        lambda first, last: where(abs(last) > abs(first), last, first),
        doc="the position farthest from 0 at which the set is greatest",
        like="largest-of-maximum",
        names={"matlab": "lom"},
    )
    kind(
        "weighted-average",
        lambda average: average,
        doc="the average of the values of the consequents, weighed by their strengths",
        names={"fll": "WeightedAverage", "fcl": "COGS, COGF", "jfl": "COGS, COGF", "fml": "WA"}
        | {"fis": "wtaver", "matlab": "wtaver", "octave": "wtaver"},
        elsewhere="wtaver cogs weightedaverage",
        sources=("takagi1985",),
    )
    kind(
        "weighted-sum",
        lambda weighted: weighted,
        doc="the sum of the values of the consequents, each times its strength",
        names={"fll": "WeightedSum", "fcl": "COGSS", "jfl": "COGSS"}
        | {"fis": "wtsum", "matlab": "wtsum", "octave": "wtsum"},
        elsewhere="wtsum weightedsum",
    )
    kind(
        "tsukamoto",
        lambda average: average,
        doc="the average of the positions at which monotonic sets reach their strengths",
        inverts=True,
        names={"fll": "WeightedAverage", "fcl": "COGS", "fis": "wtaver"},  # of monotonic sets
        sources=("tsukamoto1979",),
    )
    kind(
        "karnik-mendel",
        lambda left, right: 0.5 * (left + right),
        doc="the middle of the centroid of an interval type-2 set",
        names={"pyit2fls": "KM_algorithm, EKM_algorithm, EIASC_algorithm"}
        | {"t2fis": "km, ekm, iasc, eiasc, eods, karnikmendel, karnik-mendel"},
        sources=("karnik2001",),
    )
    kind(
        "karnik-mendel-left",
        lambda left: left,
        doc="the left end of the centroid of an interval type-2 set",
        sources=("karnik2001",),
    )
    kind(
        "karnik-mendel-right",
        lambda right: right,
        doc="the right end of the centroid of an interval type-2 set",
        sources=("karnik2001",),
    )
    kind(
        "nie-tan",
        lambda centroid: centroid,
        doc="the centroid of the lower and the upper set of interval type 2 together",
        both=True,
        names={"pyit2fls": "NT_algorithm", "t2fis": "nt, nietan, nie-tan"},
    )


_register()
