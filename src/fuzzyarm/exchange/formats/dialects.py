"""Dialects: conventions and defaults of each program, a record for each.

The names of a shape, norm or hedge are in its own record (`names` of
:class:`fuzzyarm.symbolic.records.Kind`); a dialect has the key of these names, and
:func:`spellings` and :func:`words` look them up. Several words are separated by commas, and the
first is written: to read one more, append it, and to ``READ_ALONE`` of
``tests/formats/test_orders_of_numbers.py`` what its manual says.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import chain
from typing import NamedTuple

from fuzzyarm.symbolic import formulas
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS
from fuzzyarm.symbolic.records import Kind

MACHINE_EPSILON = 1e-6
"""Zero in fuzzylite's C++ program: a rule with a lower strength does not fire."""

JFUZZYLOGIC_PAIRS = {
    "min": "max",
    "product": "probor",
    "bounded": "bounded",
    "drastic": "drastic",
    "nilpotent": "nilpotent",
    "hamacher": "einstein",
}
"""jFuzzyLogic sets OR by AND and AND by OR: T-norm → its S-norm."""

JFUZZYLOGIC_ACCUMULATIONS = ("max", "bounded", "normalized", "probor", "sum")
"""S-norms of jFuzzyLogic for ACCU; its other words are for OR."""


@dataclass(frozen=True, kw_only=True)
class Dialect:
    """Syntax and semantics of one format in one program."""

    suffix: str  # suffix of the files
    producer: str  # short name of the program on the command line
    program: str  # name of the program in messages
    kinds: str  # key of the names of shapes, norms and hedges in their records
    hedges: str = ""  # key of the names of hedges in rules; that of `kinds` by default
    defuzzifiers: str = ""  # key of the names of defuzzifiers; that of `kinds` by default
    samples: tuple[int, str]  # number of samples of an output, and their position
    threshold: float = 0.0  # firing strength above which a rule fires
    # Whether hedges of a conclusion change the activation degree and carry on to the next
    # conclusions, and an output in a condition is its activation so far (fuzzylite).
    activates: bool = False
    # Whether a condition may be about an output that its own block has concluded.
    chains: bool = False
    thresholds: bool = False  # whether the file can have any threshold
    # Variables that the file can clamp to their range: ``inputs``, ``outputs``.
    clamps: tuple[str, ...] = ()
    # Treatment of an input outside its range, by default: ``extend`` or ``error``.
    outside: str = "extend"
    negates: bool = True  # whether a conclusion may be negated
    formula: formulas.FormulaDialect = formulas.FUZZYLITE  # syntax of formulas
    assumed: str = ""  # the reader's remark about assumed defaults
    # Whether *and* and *or* have equal precedence, from left to right.
    equal_precedence: bool = False
    commas: bool = False  # whether a comma between two conditions is an *and*
    any_case: bool = False  # whether keywords may be in upper case, and names may differ in case
    separators: tuple[str, ...] = ("and",)  # separators of conclusions
    ties: str = "last"  # which of two points at one x applies: ``first`` or ``last``
    heights: bool = False  # whether a number after those of a shape is its height (fuzzylite)
    drops_numbers: bool = False  # whether the program ignores surplus numbers of a shape
    unordered: bool = False  # whether the program accepts unordered corners and computes with them
    # Comparison of words of norms and methods: exact, or in ``lower`` or ``upper`` case.
    case: str = ""
    norms: tuple[str, ...] = ()  # keys of the names of norms in files; that of `kinds` by default
    no_norm: tuple[str, ...] = ()  # words for the absence of a norm
    repeated_term: str = "first"  # which of two terms with one name applies: ``first`` or ``last``
    method: str = ""  # default defuzzifier of an output
    # Other programs' words for defuzzifiers → the words for them here.
    methods_of_others: Mapping[str, str] = field(default_factory=dict)
    samplings: Mapping[str, str] = field(default_factory=dict)  # methods with their own sampling
    # Default value of an output for no rule: ``nan``, the ``middle`` of its range, the ``maximum``
    # of nothing, or that in spite of the file (``nothing``).
    no_rule: str = "nan"
    has_ties: bool = False  # whether rounding decides between equally high samples
    holds: bool = False  # whether the file can hold the value of an output for no rule
    defaults: bool = False  # whether the file can state another value
    instead_of_error: str = ""  # message about an output with an error for no rule
    resolutions: bool = False  # whether the file can have any number of samples
    says_inference: bool = False  # whether the file chooses Tsukamoto's method for values
    inverts: bool = False  # whether invertible values imply Tsukamoto's method
    # Whether all rules of a weighted output are summed, whatever the aggregation.
    sums_values: bool = False
    estimates: bool = False  # whether a missing range is estimated from the terms
    values_hint: str = ""  # hint for values that would be integrated

    def folded(self, word: str) -> str:
        """Return a word in the case of the names of norms and methods."""
        return {"": word, "lower": word.lower(), "upper": word.upper()}[self.case]

    @property
    def integral(self) -> dict[str, str]:
        """Words for defuzzifiers of sets → their names in the model."""
        return self._those_that(weighs=False)

    @property
    def weighted(self) -> dict[str, str]:
        """Words for defuzzifiers of values → their names in the model."""
        return self._those_that(weighs=True)

    def _those_that(self, *, weighs: bool) -> dict[str, str]:
        methods = words(DEFUZZIFIERS, self.methods)
        return {word: name for word, name in methods.items() if DEFUZZIFIERS[name].weighs == weighs}

    @property
    def methods(self) -> str:
        """Key of the names of defuzzifiers."""
        return self.defuzzifiers or self.kinds


# docs/reference/formats.md has these records as a table, with the measured releases.
FLL = Dialect(
    suffix=".fll", producer="fuzzylite", program="fuzzylite", kinds="fll",
    samples=(1000, "midpoints"),  # fuzzylite 7 and 8; version 6: 100, always written
    activates=True, chains=True, thresholds=True, clamps=("inputs", "outputs"), heights=True,
    unordered=True, no_norm=("", "none"), repeated_term="last", has_ties=True, inverts=True,
    holds=True, defaults=True, instead_of_error="fuzzylite gives nan", resolutions=True,
    says_inference=True,
)  # fmt: skip

_OF_OTHERS = {"MOM": "MM", "SOM": "LM", "LOM": "RM"}
"""Other programs' words for the methods of FCL."""

METHODS_MEANT = {"CM": "COG"}
"""Methods of no program → the likely one."""

FCL = {
    "jfuzzylogic": Dialect(
        suffix=".fcl", producer="jfuzzylogic", program="jFuzzyLogic", kinds="jfl",
        hedges="fcl",  # not jFuzzyLogic's, but fuzzylite's, with a warning
        samples=(1000, "left"),
        formula=formulas.JFUZZYLOGIC,
        assumed="read as jFuzzyLogic does: 1000 left samples, ACCU is SUM unless given",
        negates=False, equal_precedence=True, any_case=True, separators=(",", "and"),
        ties="first",
        case="upper", norms=("fcl", "jfl"), no_norm=("NONE",), repeated_term="last", method="COG",
        methods_of_others=_OF_OTHERS, estimates=True, holds=True, defaults=True,
        values_hint="METHOD : COGS is for singletons",
    ),
    "fuzzylite": Dialect(
        suffix=".fcl", producer="fuzzylite", program="fuzzylite", kinds="fcl",
        samples=(1000, "midpoints"),
        threshold=MACHINE_EPSILON, activates=True, chains=True, clamps=("outputs",),
        assumed="read as fuzzylite does: 1000 midpoints, nan where no rule fires and no DEFAULT is "
        "given",
        any_case=True, separators=("and", ","), heights=True, unordered=True,
        case="upper", norms=("fcl", "jfl"), no_norm=("NONE",), method="COG",
        methods_of_others=_OF_OTHERS, no_rule="nothing", has_ties=True, inverts=True,
        estimates=True, holds=True, defaults=True,
    ),
    "scikit-fuzzy": Dialect(
        suffix=".fcl", producer="scikit-fuzzy", program="fcl-for-scikit-fuzzy", kinds="fcl",
        hedges="fml", defuzzifiers="fcl-scikit", samples=(0, "joined"), outside="clamp",
        negates=False,
        assumed="read as fcl-for-scikit-fuzzy does: straight lines between the points of each "
        "RANGE, clamped inputs, min and max beneath the rules",
        commas=True, any_case=True, separators=("and", ","),
        case="upper", norms=("fcl", "jfl"), no_norm=("NONE",), repeated_term="last", method="COG",
        values_hint="METHOD : COGS is for singletons",
    ),
}  # fmt: skip

_FIS_NORMS = ("fis", "octave", "matlab")
"""Keys of norms: every reader knows the words of all programs."""

_FIS_SAMPLINGS = {"centroid_integral": "trapezoid"}

FIS = {
    "matlab": Dialect(
        suffix=".fis", producer="matlab", program="MATLAB", kinds="matlab",
        samples=(101, "endpoints"),
        assumed="read with the defaults of MATLAB: sums over 101 points, the middle of the "
        "range where no rule fires",
        case="lower", norms=_FIS_NORMS, no_norm=("",), method="centroid", no_rule="middle",
        inverts=True, samplings=_FIS_SAMPLINGS, sums_values=True,
        drops_numbers=True,
    ),
    "octave": Dialect(
        suffix=".fis", producer="octave", program="Octave's toolkit", kinds="octave",
        samples=(101, "endpoints"),
        outside="error",
        assumed="read with the defaults of Octave's toolkit: sums over 101 points, nan "
        "where no rule fires, no values outside a range",
        case="lower", norms=_FIS_NORMS, no_norm=("",), method="centroid", no_rule="maximum",
        inverts=True, samplings=_FIS_SAMPLINGS,
    ),
    "fuzzylite": Dialect(
        suffix=".fis", producer="fuzzylite", program="fuzzylite", kinds="fis",
        samples=(1000, "midpoints"),
        threshold=MACHINE_EPSILON, activates=True, clamps=("outputs",), heights=True,
        unordered=True,
        assumed="read with the defaults of fuzzylite: 1000 midpoints, nan where no rule "
        "fires and no Default is given",
        case="lower", norms=_FIS_NORMS, no_norm=("",), method="centroid", no_rule="nothing",
        holds=True, defaults=True, has_ties=True, inverts=True, samplings=_FIS_SAMPLINGS,
    ),
}  # fmt: skip

FML = Dialect(
    suffix=".fml", producer="ieee1855", program="the standard IEEE 1855", kinds="fml",
    samples=(0, "endpoints"), unordered=True,
    assumed="read as IEEE 1855 defines it: exact integrals (JFML takes sums over about 2000 "
    "points)",
    case="upper", method="COG", defaults=True, says_inference=True,
)  # fmt: skip


# --- Names of kinds ---


PRODUCERS = {
    ".fll": (FLL.producer,),
    ".fcl": ("jfuzzylogic", "fuzzylite"),
    ".fis": tuple(FIS),
    ".fml": (FML.producer,),
}
"""Programs to write a file of that suffix for."""

MEANINGS = PRODUCERS | {".fcl": tuple(FCL), ".t2fis": tuple(FIS)}
"""Programs whose semantics a file of that suffix can have."""


class Spelling(NamedTuple):
    """A program's word for a kind, and the parameter of each number in its text."""

    kind: str
    word: str
    order: tuple[int, ...]


@lru_cache(maxsize=1000)
def spellings(kind: Kind, key: str) -> tuple[Spelling, ...]:
    """Return the names of a kind under a key, first the one to write."""
    variants = []
    for text in filter(None, kind.names.get(key, "").split(",")):
        word, *numbers = text.split()
        order = map(kind.parameters.index, numbers or kind.parameters)
        variants.append(Spelling(kind.name, word, tuple(order)))
    return tuple(variants)


def all_spellings(kinds: Mapping[str, Kind], *keys: str) -> Mapping[str, Spelling]:
    """Return word → spelling of all kinds of a registry; the first of equal words wins."""
    return _table(tuple(kinds.values()), keys)


@lru_cache(maxsize=100)
def _table(kinds: tuple[Kind, ...], keys: tuple[str, ...]) -> Mapping[str, Spelling]:
    # From records, not from the registry: a user's own kind may replace another.
    table: dict[str, Spelling] = {}
    for key in keys:
        for spelling in chain.from_iterable(spellings(kind, key) for kind in kinds):
            table.setdefault(spelling.word, spelling)
    return table


def words(kinds: Mapping[str, Kind], *keys: str) -> dict[str, str]:
    """Return word → kind, for reading."""
    return {word: spelling.kind for word, spelling in all_spellings(kinds, *keys).items()}


def word_of(kinds: Mapping[str, Kind], name: str, key: str) -> str | None:
    """Return the word to write for a kind, or None if the program lacks it."""
    variants = spellings(kinds[name], key) if name in kinds else []
    return variants[0].word if variants else None
