"""Every writer writes or refuses every kind by name: the built-in ones and a user's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import pytest
from budget import crossed
from strategies import numbers_of

from fuzzyarm.exchange.formats import FOREIGN, PRODUCERS, parse, write
from fuzzyarm.exchange.live.skfuzzy import to_skfuzzy
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Hedge,
    Hedged,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.symbolic import kinds, op
from fuzzyarm.symbolic.records import Kind

PROGRAMS = [(suffix, producer) for suffix in FOREIGN for producer in (None, *PRODUCERS[suffix])]
OWN = "own-kind"
TRIANGLE = Shape("triangle", (0.0, 0.5, 1.0))


def built_in(registry: Mapping[str, Kind]) -> list[str]:
    return [name for name, kind in registry.items() if not kind.own]


def words(registry: Mapping[str, Kind]) -> list[str]:
    return [*built_in(registry), OWN]


@pytest.fixture(autouse=True)
def own_kinds() -> Iterator[None]:
    kinds.tnorm(OWN, lambda a, b: 1 - op.minimum(1, op.sqrt((1 - a) ** 2 + (1 - b) ** 2)))
    kinds.snorm(OWN, lambda a, b: op.minimum(1, op.sqrt(a**2 + b**2)))
    kinds.hedge(OWN, lambda d: d * d * d * d)
    kinds.shape(
        OWN,
        ("centre", "width"),
        lambda x, centre, width: op.maximum(0, 1 - ((x - centre) / width) ** 2),
    )
    yield
    for registry in (kinds.TNORMS, kinds.SNORMS, kinds.HEDGES, kinds.SHAPES):
        registry.remove(OWN)


def rulebase(
    of_input: Shape = TRIANGLE,
    of_output: Shape = TRIANGLE,
    hedges: tuple[Hedge, ...] = (),
    around: tuple[Hedge, ...] = (),
    on_set: tuple[Hedge, ...] = (),
    aggregation: str = "max",
    defuzzifier: str = "centroid",
    **norms: str,
) -> RuleBase:
    x = Input("x", 0.0, 1.0, (Term("a", of_input),))
    z = Input("z", 0.0, 1.0, (Term("b", TRIANGLE),))
    y = Output(
        "y", 0.0, 1.0, (Term("c", of_output),), aggregation=aggregation,
        defuzzifier=Defuzzifier(defuzzifier), no_rule=0.5,
    )  # fmt: skip
    both = And((Is("x", "a", hedges), Is("z", "b")))
    antecedent = Hedged(around, both) if around else both
    block = RuleBlock((Rule(antecedent, (Consequent("y", "c", on_set),)),), **norms)
    return RuleBase("r", (x, z), (y,), (block,))


def answers(model: RuleBase, suffix: str, producer: str | None, word: str) -> None:
    """Whether a writer writes what its reader reads, or refuses the kind by its name."""
    exported = write(model, suffix, producer=producer)
    assert (exported.text is None) == bool(exported.errors)
    lossy = write(model, suffix, producer=producer, lossy=True)
    for text in filter(None, (exported.text, lossy.text)):
        again = parse(text, suffix, producer=producer, lossy=True)
        assert {d.name for d in again.errors} <= {"not-monotonic", "set-as-value", "value-as-set"}
    if word == OWN:
        assert any(OWN in d.message for d in exported.errors), [str(d) for d in exported.errors]
        assert sum(OWN in d.message for d in lossy.diagnostics) >= 1


@pytest.mark.parametrize(("word", "program"), crossed(words(kinds.SHAPES), PROGRAMS), ids=str)
def test_every_shape(word: str, program: tuple[str, str | None]) -> None:
    suffix, producer = program
    shape = Shape(
        word, numbers_of(word, 0.0, 1.0), 1.0, "2 * x + exp(z)" if word == "formula" else ""
    )
    if kinds.SHAPES[word].fuzzy:
        answers(rulebase(of_input=shape), suffix, producer, word)
    answers(rulebase(of_output=shape), suffix, producer, word)
    answers(rulebase(of_output=shape, defuzzifier="weighted-average"), suffix, producer, word)


@pytest.mark.parametrize(("word", "program"), crossed(words(kinds.TNORMS), PROGRAMS), ids=str)
def test_every_tnorm(word: str, program: tuple[str, str | None]) -> None:
    suffix, producer = program
    answers(rulebase(conjunction=word), suffix, producer, word)
    answers(rulebase(implication=word), suffix, producer, word)


@pytest.mark.parametrize(("word", "program"), crossed(words(kinds.SNORMS), PROGRAMS), ids=str)
def test_every_snorm(word: str, program: tuple[str, str | None]) -> None:
    suffix, producer = program
    answers(rulebase(disjunction=word), suffix, producer, word)
    answers(rulebase(aggregation=word), suffix, producer, word)


@pytest.mark.parametrize(("word", "program"), crossed(words(kinds.HEDGES), PROGRAMS), ids=str)
def test_every_hedge(word: str, program: tuple[str, str | None]) -> None:
    suffix, producer = program
    hedge = (Hedge(word, 1.5 if word == "power" else None),)
    answers(rulebase(hedges=hedge), suffix, producer, word)
    for model in (rulebase(around=hedge), rulebase(on_set=hedge)):
        exported = write(model, suffix, producer=producer)
        assert (exported.text is None) == bool(exported.errors)
        assert word != OWN or exported.errors


def test_every_kind_goes_to_scikit_fuzzy_or_is_refused() -> None:
    hedges = [(Hedge(name, 1.5 if name == "power" else None),) for name in kinds.HEDGES]
    models = {f"and {name}": rulebase(conjunction=name) for name in kinds.TNORMS}
    models |= {f"or {name}": rulebase(disjunction=name) for name in kinds.SNORMS}
    models |= {f"sum {name}": rulebase(aggregation=name) for name in kinds.SNORMS}
    models |= {f"hedge {hedge[0].name}": rulebase(hedges=hedge) for hedge in hedges}
    for name in (*built_in(kinds.SHAPES), OWN):
        formula = "x" if name == "formula" else ""
        models[f"term {name}"] = rulebase(
            of_output=Shape(name, numbers_of(name, 0.0, 1.0), 1.0, formula)
        )
    written = set()
    for what, model in models.items():
        system, diagnostics = to_skfuzzy(model)
        assert (system is None) == any(d.is_error for d in diagnostics)
        if OWN in what and not what.startswith("term"):
            assert any(OWN in d.message for d in diagnostics if d.is_error)
        written |= {what} if system is not None else set()
    # Terms are sampled, so a shape of one's own goes there like any other.
    assert {"and min", "and product", "or probor", "hedge not", f"term {OWN}"} <= written
    assert not written & {f"and {OWN}", f"or {OWN}", f"sum {OWN}", f"hedge {OWN}", "term linear"}


def test_a_name_for_a_program_in_the_record_is_enough() -> None:
    names = {"fll": "Bump width centre", "fis": "bumpmf", "matlab": "bumpmf"}
    kinds.shape(
        "bump",
        ("centre", "width"),
        lambda x, centre, width: op.maximum(0, 1 - ((x - centre) / width) ** 2),
        names=names,
    )
    kinds.tnorm("root", lambda a, b: op.sqrt(a * b) * op.minimum(a, b), names={"fll": "Root"})
    kinds.hedge("fully", lambda d: d**4, names={"fll": "fully"})
    try:
        bump = Shape("bump", (0.25, 0.5))
        model = rulebase(of_input=bump, conjunction="root", hedges=(Hedge("fully"),))
        exported = write(model, ".fll", lossy=True)
        assert exported.text is not None
        assert "term: a Bump 0.5 0.25\n" in exported.text
        assert "conjunction: Root\n" in exported.text
        again = parse(exported.text, ".fll").rulebase
        assert again is not None
        assert again.inputs[0].terms[0].shape == bump
        assert again.blocks[0].conjunction == "root"
        assert again.rules[0].antecedent == model.rules[0].antecedent
        fis = write(rulebase(of_input=bump), ".fis", producer="matlab", lossy=True).text
        assert fis is not None
        assert "'bumpmf',[0.25 0.5]" in fis
    finally:
        kinds.SHAPES.remove("bump")
        kinds.TNORMS.remove("root")
        kinds.HEDGES.remove("fully")
