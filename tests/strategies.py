"""Hypothesis strategies for rule bases, shared by all packages.

`rulebases()` makes models of many kinds that can be evaluated; `plain_mamdani()` the
common kind (straight terms, min/max or product). `odd_names=True` draws names that are no
identifiers; `decorated=True` adds descriptions, lookup settings and expectations, for
round trips through text.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from hypothesis import strategies as st

from fuzzyarm.language.model.rulebase import (
    SAMPLINGS,
    And,
    Consequent,
    Defuzzifier,
    Expectation,
    Expression,
    GainTuning,
    Hedge,
    Hedged,
    Input,
    Is,
    Lookup,
    LookupAxis,
    Or,
    Outcome,
    Output,
    PeakTuning,
    Property,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    Tuning,
)
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SHAPES, SNORMS, TNORMS

CONJUNCTIONS, DISJUNCTIONS = tuple(TNORMS), tuple(SNORMS)
JUNCTIONS = tuple(name for name, norm in SNORMS.items() if not norm.aggregates)
"""S-norms that an *or* may have."""

Draw = Any

STRAIGHT = ("triangle", "trapezoid", "rectangle", "ramp", "points")
SMOOTH = tuple(
    name for name, kind in SHAPES.items() if kind.fuzzy and not (kind.straight or kind.own)
)
MONOTONIC = tuple(name for name, kind in SHAPES.items() if kind.inverse and not kind.own)
SET_METHODS = tuple(
    name for name, record in DEFUZZIFIERS.items() if not (record.type2 or record.inverts)
)
PLAIN_NAMES = tuple("ABCDEFGH")
VARIABLE_NAMES = ("e", "ce", "load", "u", "v", "speed", "w_1")
RESERVED = frozenset({"x", "pi"})

odd_text = st.text(
    st.characters(blacklist_categories=["C", "Z"], blacklist_characters="'\\\""),
    min_size=1,
    max_size=8,
)
gaps = st.sampled_from([0.0, 0.001, 0.02, 0.5])
descriptions = st.text(
    st.characters(blacklist_categories=["C", "Zl", "Zp"], blacklist_characters='"\\'), max_size=20
).map(str.strip)


@st.composite
def name_lists(
    draw: Draw, pool: Sequence[str], low: int, high: int, *, odd: bool = False
) -> list[str]:
    """Distinct names."""
    one = st.sampled_from(pool)
    source = st.one_of(one, odd_text) if odd else one
    return draw(st.lists(source, min_size=low, max_size=high, unique=True))


@functools.cache
def places(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers in a range: even fractions (so that things coincide) or any three digits."""
    width = high - low
    return st.one_of(
        st.integers(0, 16).map(lambda i: low + width * i / 16),
        st.integers(0, 1000).map(lambda i: round(low + width * i / 1000, 6)),
    )


ranges = st.tuples(
    st.sampled_from([-6.0, -1.0, 0.0, 10.0, -0.25]), st.sampled_from([1.0, 2.0, 12.0, 80.0])
).map(lambda pair: (pair[0], pair[0] + pair[1]))


def numbers_of(kind: str, low: float, high: float) -> tuple[float, ...]:
    """Numbers for a shape of any kind, also of a user's: what its record says of each parameter.

    Widths are a quarter of the range; positions follow one another in it, at no round places.
    """
    record, width = SHAPES[kind], high - low
    middle, steep, inner = low + 0.6 * width, 12.0 / width, low + 0.2 * width
    others: dict[str, tuple[float, ...]] = {
        "binary": (middle, math.inf),
        "points": (
            low + 0.1 * width,
            0.1,
            low + 0.3 * width,
            0.4,
            middle,
            1.0,
            high - 0.1 * width,
            0.2,
        ),
        "bell": (middle, 0.3 * width, 1.7),
        "sigmoid": (middle, steep),
        "sigmoid-difference": (inner, steep, middle, steep),
        "sigmoid-product": (inner, steep, middle, -steep),
        "linear": (0.5, -0.25, 1.0),  # of two inputs
    }
    wide, count = {*record.positive, *record.nonzero}, len(record.parameters)
    return others.get(kind) or tuple(
        0.25 * width if name in wide else low + width * (k + 0.65) / (count + 0.4)
        for k, name in enumerate(record.parameters)
    )


@st.composite
def shapes(draw: Draw, kind: str, low: float, high: float) -> Shape:
    """A shape of one kind that lives around a range."""
    place = places(low, high)
    width = (high - low) * draw(st.sampled_from([0.05, 0.1, 0.25, 0.5]))
    if SHAPES[kind].ordered:
        count = len(SHAPES[kind].parameters)
        numbers = sorted(draw(st.lists(place, min_size=count, max_size=count)))
        if kind in {"rectangle", "s", "z"} and numbers[0] == numbers[1]:
            numbers[1] += width
        if kind == "triangle" and numbers[0] == numbers[2]:
            numbers[0], numbers[2] = numbers[1] - width, numbers[1] + width
        if kind == "trapezoid" and numbers[0] == numbers[3]:
            numbers[0], numbers[3] = numbers[0] - width, numbers[3] + width
        return Shape(kind, tuple(numbers), height=draw(st.sampled_from([1.0, 1.0, 1.0, 0.75])))
    if kind == "points":
        xs = sorted(draw(st.lists(place, min_size=2, max_size=5, unique=True)))
        ys = draw(
            st.lists(st.sampled_from([0.0, 0.25, 0.5, 1.0]), min_size=len(xs), max_size=len(xs))
        )
        ys[draw(st.integers(0, len(xs) - 1))] = 1.0
        return Shape(kind, tuple(n for pair in zip(xs, ys, strict=True) for n in pair))
    centre, other = draw(place), draw(place)
    if kind in {"ramp", "arc", "concave", "semi-ellipse"}:
        return Shape(kind, (centre, other if other != centre else centre + width))
    steep = draw(st.sampled_from([-1.0, 1.0])) * 4.0 / width
    table: dict[str, tuple[float, ...]] = {
        "gaussian": (centre, width),
        "two-sided-gaussian": (centre, width, other, 0.5 * width),
        "bell": (centre, width, draw(st.sampled_from([1.0, 2.0, 3.5]))),
        "sigmoid": (centre, steep),
        "sigmoid-difference": (min(centre, other), abs(steep), max(centre, other) + width, 2.0),
        "sigmoid-product": (min(centre, other), abs(steep), max(centre, other), -abs(steep)),
        "cosine": (centre, 2.0 * width),
        "spike": (centre, width),
        "singleton": (centre,),
    }
    return Shape(kind, table.get(kind) or numbers_of(kind, low, high))


@st.composite
def term_lists(
    draw: Draw, kinds: Sequence[str], low: float, high: float, *, most: int = 4, odd: bool = False
) -> tuple[Term, ...]:
    """Terms of one variable."""
    names = draw(name_lists(PLAIN_NAMES, 1, most, odd=odd))
    return tuple(
        Term(name, draw(st.sampled_from(kinds).flatmap(lambda kind: shapes(kind, low, high))))
        for name in names
    )


hedges = st.one_of(
    st.sampled_from(["not", "very", "somewhat", "extremely", "intensify", "seldom", "any"]).map(
        Hedge
    ),
    st.sampled_from([0.5, 1.3, 2.0]).map(lambda p: Hedge("power", p)),
)
hedge_lists = st.lists(hedges, min_size=1, max_size=2).map(tuple)
few_hedges = st.one_of(st.just(()), st.just(()), hedge_lists)


def propositions_about(variables: Sequence[Input | Output]) -> st.SearchStrategy[Is]:
    """*variable is [hedges] term*."""
    return st.sampled_from(list(variables)).flatmap(
        lambda variable: st.builds(
            Is,
            st.just(variable.name),
            st.sampled_from([term.name for term in variable.terms]),
            few_hedges,
        )
    )


def expressions(variables: Sequence[Input | Output]) -> st.SearchStrategy[Expression]:
    """Antecedents: mostly conjunctions, some nested; shaped as a parser would shape them.

    (An operand of a conjunction is no conjunction, and likewise for disjunctions.)
    """
    atom = propositions_about(variables)

    def branch(
        kind: type[And] | type[Or], parts: st.SearchStrategy[Expression]
    ) -> st.SearchStrategy[Expression]:
        others = parts.filter(lambda part: not isinstance(part, kind))
        return st.lists(others, min_size=2, max_size=3).map(lambda found: kind(tuple(found)))

    # One hedge on a parenthesis or more; a single proposition carries its own.
    def hedged(parts: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
        inner = parts.filter(lambda part: isinstance(part, And | Or))
        return st.builds(Hedged, hedge_lists, inner)

    flat = branch(And, atom)
    inner = st.one_of(atom, flat, branch(Or, atom))
    return st.one_of(
        atom, flat, flat, branch(Or, st.one_of(atom, flat)), branch(And, inner), hedged(inner)
    )


@st.composite
def inputs_of(
    draw: Draw, kinds: Sequence[str], names: Sequence[str], *, odd: bool = False, most: int = 4
) -> tuple[Input, ...]:
    """Input variables."""
    found = []
    for name in names:
        low, high = draw(ranges)
        terms = draw(term_lists(kinds, low, high, odd=odd, most=most))
        outside = draw(st.sampled_from(["clamp", "clamp", "extend"]))
        found.append(Input(name, low, high, terms, outside=outside))
    return tuple(found)


@st.composite
def defuzzifiers(draw: Draw, methods: Sequence[str]) -> Defuzzifier:
    """A defuzzifier, exact or with a modest number of samples."""
    method = draw(st.sampled_from(methods))
    if method in {"weighted-average", "weighted-sum", "tsukamoto"} or draw(st.booleans()):
        return Defuzzifier(method)
    samples = draw(st.integers(5, 60))
    samplings = [each for each in SAMPLINGS if each != "joined" or "maximum" not in method]
    return Defuzzifier(method, samples, draw(st.sampled_from(samplings)))


@st.composite
def value_terms(
    draw: Draw, inputs: Sequence[Input], low: float, high: float, *, odd: bool
) -> tuple[Term, ...]:
    """Consequents of Takagi and Sugeno: constants, linear forms, formulas."""
    names = draw(name_lists(PLAIN_NAMES, 1, 4, odd=odd))
    terms = []
    for name in names:
        kind = draw(st.sampled_from(["singleton", "singleton", "linear", "formula"]))
        if kind == "singleton":
            shape = draw(shapes("singleton", low, high))
        elif kind == "linear":
            numbers = draw(
                st.lists(places(-2.0, 2.0), min_size=len(inputs) + 1, max_size=len(inputs) + 1)
            )
            shape = Shape("linear", tuple(numbers))
        else:
            plain = [each.name for each in inputs if re.fullmatch(r"[^\W\d]\w*", each.name)] or [
                "2.5"
            ]
            first, second = draw(st.sampled_from(plain)), draw(st.sampled_from(plain))
            pattern = draw(
                st.sampled_from(["{} + 0.5 * {}", "sin({}) - abs({}) / 3", "max({}, 2 - {} ^ 2)"])
            )
            shape = Shape("formula", formula=pattern.format(first, second))
        terms.append(Term(name, shape))
    return tuple(terms)


@st.composite
def outputs_of(
    draw: Draw, inputs: Sequence[Input], kinds: Sequence[str], name: str, *, odd: bool = False
) -> Output:
    """An output of sets, of values, or of monotonic sets for Tsukamoto."""
    low, high = draw(ranges)
    family = draw(st.sampled_from(["sets", "sets", "sets", "values", "tsukamoto"]))
    if family == "values":
        terms = draw(value_terms(inputs, low, high, odd=odd))
        constant = all(term.shape.kind == "singleton" for term in terms)
        usual = ["weighted-average", "weighted-sum"]
        methods = [*usual, "centroid", "bisector", "mean-of-maximum"] if constant else usual
        defuzzifier = Defuzzifier(draw(st.sampled_from(methods)))
    elif family == "tsukamoto":
        terms = draw(term_lists(MONOTONIC, low, high, odd=odd))
        defuzzifier = Defuzzifier("tsukamoto")
    else:
        terms = draw(term_lists(kinds, low, high, odd=odd))
        defuzzifier = draw(defuzzifiers(SET_METHODS))
    return Output(
        name,
        low,
        high,
        terms,
        outside=draw(st.sampled_from(["clamp", "extend"])),
        aggregation=draw(st.sampled_from(DISJUNCTIONS)),
        defuzzifier=defuzzifier,
        no_rule=draw(st.one_of(places(low, high), st.sampled_from(["error", "hold"]))),
    )


@st.composite
def consequents_for(draw: Draw, outputs: Sequence[Output]) -> tuple[Consequent, ...]:
    """One consequent for each of some outputs."""
    chosen = draw(st.lists(st.sampled_from(list(outputs)), min_size=1, max_size=2, unique_by=id))
    found = []
    for output in chosen:
        term = draw(st.sampled_from(output.terms))
        sets = term.shape.kind not in {"singleton", "linear", "formula"}
        hedges = sets and output.defuzzifier.method != "tsukamoto"
        found.append(Consequent(output.name, term.name, draw(few_hedges) if hedges else ()))
    return tuple(found)


weights = st.sampled_from([1.0, 1.0, 1.0, 0.5, 0.8])


@st.composite
def blocks_of(
    draw: Draw, readable: Sequence[Input | Output], outputs: Sequence[Output], name: str = ""
) -> RuleBlock:
    """A block of rules with norms of any kind."""
    rules = draw(
        st.lists(
            st.builds(Rule, expressions(readable), consequents_for(outputs), weights),
            min_size=1,
            max_size=6,
        )
    )
    return RuleBlock(
        tuple(rules),
        name,
        conjunction=draw(st.sampled_from(CONJUNCTIONS)),
        disjunction=draw(st.sampled_from(JUNCTIONS)),
        implication=draw(st.sampled_from(CONJUNCTIONS)),
        threshold=draw(st.sampled_from([0.0, 0.0, 0.0, 0.25])),
    )


@st.composite
def rulebases(draw: Draw, *, odd_names: bool = False, decorated: bool = False) -> RuleBase:
    """A rule base of any kind: several inputs, outputs and blocks, chained now and then."""
    names = draw(
        name_lists(VARIABLE_NAMES, 2, 5, odd=odd_names).filter(
            lambda found: not RESERVED & set(found)
        )
    )
    count = draw(st.integers(1, min(3, len(names) - 1)))
    inputs = draw(inputs_of(STRAIGHT + SMOOTH, names[:count], odd=odd_names))
    outputs = tuple(
        draw(outputs_of(inputs, STRAIGHT + SMOOTH, name, odd=odd_names))
        for name in names[count : count + 2]
    )
    blocks = [draw(blocks_of(inputs, outputs[:1]))]
    if len(outputs) > 1:
        first_is_a_set = outputs[0].terms[0].shape.kind not in {"singleton", "linear", "formula"}
        readable = (*inputs, outputs[0]) if first_is_a_set else inputs
        blocks.append(draw(blocks_of(readable, outputs[1:], "second")))
    made = RuleBase(draw(st.sampled_from(["made", "plant_2"])), inputs, outputs, tuple(blocks))
    return draw(_decorations(made)) if decorated else made


@st.composite
def _decorations(draw: Draw, rulebase: RuleBase) -> RuleBase:
    import dataclasses

    first = rulebase.inputs[0]
    levels = tuple(sorted(draw(st.sets(places(first.low, first.high), min_size=2, max_size=5))))
    bins = tuple(0.5 * (a + b) for a, b in pairwise(levels))
    lookup = Lookup(
        (LookupAxis(first.name, levels, draw(st.sampled_from([None, bins]))),),
        draw(st.sampled_from([None, 0.1])),
    )
    output = rulebase.outputs[0]
    value = draw(places(output.low, output.high))
    outcome = draw(
        st.sampled_from(
            [
                Outcome(output.name, "=", value),
                Outcome(output.name, "=", value, 0.25),
                Outcome(output.name, "<=", value),
                Outcome(output.name, "in", output.low, output.high),
            ]
        )
    )
    at = tuple((each.name, draw(places(each.low, each.high))) for each in rulebase.inputs)
    flags = st.booleans()
    tuning = Tuning(
        (PeakTuning((first.name,), draw(flags), draw(flags), draw(flags), draw(gaps)),),
        (GainTuning(("G_e", "G ce"), 0.5, 2.0, draw(flags), draw(flags), draw(flags)),),
        draw(st.sampled_from([(), ((first.name, ""),), ((first.name, first.terms[0].name),)])),
    )
    region = draw(st.sampled_from([(), ((first.name, first.low, first.high),)]))
    statements = (
        Property("value", output.name, region, outcome),
        Property("covered", output.name, region),
        Property("falls", output.name, region, input=first.name),
        Property("slope", output.name, region, input=first.name, low=-1.5, high=2.0),
        Property("table", output.name, region, high=0.5, mode="bins"),
    )
    return dataclasses.replace(
        rulebase,
        description=draw(descriptions),
        inputs=(dataclasses.replace(first, description=draw(descriptions)), *rulebase.inputs[1:]),
        outputs=(
            dataclasses.replace(output, description=draw(descriptions)),
            *rulebase.outputs[1:],
        ),
        lookup=draw(st.sampled_from([None, lookup])),
        expectations=draw(st.sampled_from([(), (Expectation(at, (outcome,)),)])),
        properties=draw(st.sampled_from([(), statements])),
        tuning=draw(st.sampled_from([None, tuning])),
    )


@st.composite
def plain_mamdani(
    draw: Draw,
    *,
    aggregations: Sequence[str] = ("max",),
    implications: Sequence[str] = ("min",),
    kinds: Sequence[str] = STRAIGHT,
    defuzzifier: Defuzzifier | None = None,
) -> RuleBase:
    """One or two inputs, one output of sets, conjunctions without hedges."""
    inputs = draw(inputs_of(kinds, ["e", "ce"][: draw(st.integers(1, 2))]))
    low, high = draw(ranges)
    terms = draw(term_lists(kinds, low, high, most=6))
    chosen = defuzzifier or Defuzzifier()
    output = Output(
        "u", low, high, terms,
        aggregation=draw(st.sampled_from(aggregations)), defuzzifier=chosen, no_rule=low,
    )  # fmt: skip
    atoms = [st.sampled_from([Is(each.name, term.name) for term in each.terms]) for each in inputs]
    antecedents = atoms[0] if len(atoms) == 1 else st.tuples(*atoms).map(And)
    consequents = st.sampled_from([(Consequent("u", term.name),) for term in terms])
    rules = draw(
        st.lists(st.builds(Rule, antecedents, consequents, weights), min_size=1, max_size=9)
    )
    block = RuleBlock(
        tuple(rules),
        conjunction=draw(st.sampled_from(["min", "product"])),
        implication=draw(st.sampled_from(implications)),
    )
    return RuleBase("plain", inputs, (output,), (block,))


@st.composite
def input_points(draw: Draw, rulebase: RuleBase, count: int = 8) -> dict[str, list[float]]:
    """Values for every input, a few outside the range."""
    return {
        each.name: draw(
            st.lists(
                st.one_of(places(each.low, each.high), st.just(each.high + 0.5)),
                min_size=count,
                max_size=count,
            )
        )
        for each in rulebase.inputs
    }
