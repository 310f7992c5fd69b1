"""The exact centroid against closed forms worked out by hand and against SciPy."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from fuzzyarm.inference import infer
from fuzzyarm.inference.block import make_block
from fuzzyarm.inference.kernel import evaluate
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.overlap import closed_form
from fuzzyarm.inference.plan import OutputPlan, plan
from fuzzyarm.inference.sets import degrees as array_membership
from fuzzyarm.inference.sets import stretches
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import (
    Consequent,
    Defuzzifier,
    Is,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
)
from fuzzyarm.language.model.shapes import membership
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS
from tests.inference import small
from tests.strategies import SMOOTH, STRAIGHT, plain_mamdani


def fired_somehow(output: OutputPlan, seed: int) -> list[tuple[int, float]]:
    """Strengths of all members, ties and full strength among them."""
    random = np.random.default_rng(seed)
    choices = [0.0, 0.25, 0.5, 1.0, *random.uniform(0.0, 1.0, 4)]
    drawn = [(i, float(random.choice(choices))) for i in range(len(output.members))]
    return [(i, strength) for i, strength in drawn if strength > 0.0]


def centroid(
    output: OutputPlan, fired: list[tuple[int, float]], *, integrated: bool = False
) -> float | None:
    """What the kernel makes of members that are asserted this strongly; None where it is nothing.

    With `integrated` by the quadrature, whatever form the sets have.
    """
    names = [f"s{i}" for i in range(len(output.members))]
    rules = tuple(
        Rule(Is(name, "high"), (Consequent("u", member.term.name, member.hedges),))
        for name, member in zip(names, output.members, strict=True)
    )
    whole = plan(
        RuleBase(
            "asserted",
            small.inputs(*names),
            (dataclasses.replace(output.output, name="u", no_rule=math.nan),),
            (RuleBlock(rules, implication=output.members[0].implication),),
        )
    )
    if integrated:
        pieces = [member.pieces for member in output.members]
        panels = whole.outputs["u"]._replace(
            closed=None, enveloped=False, stretches=stretches(pieces)
        )
        whole = whole._replace(outputs={"u": panels})
    block = make_block(lay_out(whole), 1)
    for i, strength in fired:
        block.numbers[block.columns + i] = strength
    evaluate(block.numbers)
    value = block.numbers[block.results]
    return None if math.isnan(value) else value


def integrals(
    function: Callable[[float], float], edges: list[float], parts: int
) -> tuple[float, float]:
    """Area and moment by a rule of 4th order on many panels; jumps only at the edges."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    area = moment = 0.0
    for a, b in itertools.pairwise(edges):
        borders = np.linspace(a, b, parts + 1)
        middle, half = 0.5 * (borders[1:] + borders[:-1]), 0.5 * (borders[1:] - borders[:-1])
        xs = middle[:, None] + half[:, None] * nodes
        ys = np.vectorize(function)(xs) * weights * half[:, None]
        area, moment = area + ys.sum(), moment + (ys * xs).sum()
    return area, moment


def brute_force(output: OutputPlan, fired: list[tuple[int, float]], parts: int) -> float | None:
    """Integrate the definition itself: no fold, no pieces, no shared code but the shapes."""
    norm = SNORMS[output.output.aggregation].scalar

    def aggregate(y: float) -> float:
        total = 0.0
        for index, strength in fired:
            member = output.members[index]
            total = norm(
                total, TNORMS[member.implication].scalar(strength, membership(member.term.shape, y))
            )
        return total

    low, high = output.output.low, output.output.high
    corners = {x for m in output.members for x in m.term.shape.parameters[:: _stride(m.term.shape)]}
    edges = sorted({low, high, *(x for x in corners if low < x < high)})
    area, moment = integrals(aggregate, edges, parts)
    return moment / area if area > 1e-12 else None


def _stride(shape: Shape) -> int:
    return 2 if shape.kind in {"points", "gaussian", "two-sided-gaussian", "sigmoid"} else 1


@pytest.mark.slow
@given(plain_mamdani(), st.integers(0, 1000))
@settings(max_examples=cases(20, 60))
def test_closed_form_equals_brute_force(rulebase: RuleBase, seed: int) -> None:
    output = plan(rulebase).outputs["u"]
    fired = fired_somehow(output, seed)
    assert output.closed is not None
    expected = brute_force(output, fired, 200)
    if expected is not None:
        width = output.output.high - output.output.low
        assert centroid(output, fired) == pytest.approx(expected, abs=2e-5 * width)


@given(
    plain_mamdani(aggregations=("max", "sum")),
    st.integers(0, 1000),
)
@settings(max_examples=cases(20, 60))
def test_closed_form_equals_adaptive_quadrature(rulebase: RuleBase, seed: int) -> None:
    output = plan(rulebase).outputs["u"]
    fired = fired_somehow(output, seed)
    width = output.output.high - output.output.low
    closed = centroid(output, fired)
    integrated = centroid(output, fired, integrated=True)
    assert (closed is None) == (integrated is None)
    if closed is not None:
        assert closed == pytest.approx(integrated, abs=1e-11 * width)


CONTINUOUS = tuple(kind for kind in SMOOTH if kind not in {"pi", "arc", "semi-ellipse"})
"""Shapes without vertical edges or tangents: the sums below converge fast for them."""


def fine_sum(output: OutputPlan, fired: list[tuple[int, float]], count: int) -> float | None:
    """Sum the definition over very many midpoints, with array norms and memberships."""
    low, high = output.output.low, output.output.high
    places = low + (high - low) * (np.arange(count) + 0.5) / count
    total = np.zeros(count)
    for index, strength in fired:
        member = output.members[index]
        degree = array_membership(member.term.shape, places)
        cut = TNORMS[member.implication].array(np.full(count, strength), degree)
        total = SNORMS[output.output.aggregation].array(total, cut)
    return float((total * places).sum() / total.sum()) if total.max() > 1e-9 else None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kinds", "implications", "share"),
    [
        (CONTINUOUS, ("min", "product", "bounded", "einstein", "hamacher"), 2e-9),
        # Jumps cost the sums, not the quadrature, up to one of their steps.
        (STRAIGHT + SMOOTH, ("nilpotent", "drastic", "product", "min"), 2e-5),
    ],
    ids=["continuous", "jumps"],
)
@given(st.data())
@settings(max_examples=cases(8, 25))
def test_quadrature_equals_very_many_samples(
    kinds: tuple[str, ...], implications: tuple[str, ...], share: float, data: st.DataObject
) -> None:
    rulebase = data.draw(
        plain_mamdani(
            aggregations=("max", "sum", "probor", "bounded", "einstein", "hamacher"),
            implications=implications,
            kinds=kinds,
        )
    )
    output = plan(rulebase).outputs["u"]
    fired = fired_somehow(output, data.draw(st.integers(0, 1000)))
    expected = fine_sum(output, fired, 200_000)
    if expected is not None:
        width = output.output.high - output.output.low
        assert centroid(output, fired, integrated=True) == pytest.approx(
            expected, abs=share * width
        )


def test_two_clipped_triangles_by_hand() -> None:
    # min(1/2, triangle -1 0 1) has corners at ±1/2; area 3/4. With its twin at 1 clipped
    # at 1/4 beside it the union is computed here by SciPy between all corners.
    first, second = Shape("triangle", (-1.0, 0.0, 1.0)), Shape("triangle", (0.0, 1.0, 2.0))

    def union(y: float) -> float:
        return max(min(0.5, membership(first, y)), min(0.25, membership(second, y)))

    corners = [-1.0, -0.5, 0.0, 0.25, 0.5, 0.75, 1.0, 1.75, 2.0]
    area = sum(quad(union, a, b)[0] for a, b in itertools.pairwise(corners))
    moment = sum(quad(lambda y: y * union(y), a, b)[0] for a, b in itertools.pairwise(corners))
    output = _bare_output([first, second], -1.0, 2.0)
    assert centroid(output, [(0, 0.5), (1, 0.25)]) == pytest.approx(moment / area)
    alone = centroid(output, [(1, 0.25)])
    assert alone == pytest.approx(1.0)


def test_vertical_edges_and_the_range_cut_a_set() -> None:
    # min(0.4, rectangle 1 .. 9) inside 0 .. 5: a box from 1 to 5.
    output = _bare_output([Shape("rectangle", (1.0, 9.0))], 0.0, 5.0)
    assert centroid(output, [(0, 0.4)]) == pytest.approx(3.0)


@pytest.mark.parametrize("height", [1e-300, 1e-100, 1e-12, 1e-6])
def test_a_faint_rule_keeps_its_digits(height: float) -> None:
    output = _bare_output([Shape("triangle", (0.0, 1.0, 4.0))], 0.0, 4.0)
    # A sliver of a set is a box over its support.
    assert centroid(output, [(0, height)]) == pytest.approx(2.0, abs=1e-5)


@pytest.mark.slow
def test_many_overlapping_sets_fall_back_to_quadrature() -> None:
    wide = [Shape("triangle", (0.0, 0.5 + 0.01 * i, 1.0)) for i in range(12)]
    output = _bare_output(wide, 0.0, 1.0)
    assert closed_form([m.pieces for m in output.members], 0.0, 1.0) is None
    assert output.closed is None
    fired = [(i, 0.1 * (i % 7) + 0.1) for i in range(12)]
    assert centroid(output, fired, integrated=True) == pytest.approx(
        brute_force(output, fired, 400), abs=1e-7
    )


@pytest.mark.slow
def test_fine_samples_approach_the_exact_value(pd7: RuleBase) -> None:
    output = dataclasses.replace(
        pd7.outputs[0], defuzzifier=Defuzzifier("centroid", 100_000, "midpoints")
    )
    sampled = dataclasses.replace(pd7, outputs=(output,))
    e, ce = np.random.default_rng(3).uniform(-6.0, 6.0, (2, 30))
    np.testing.assert_allclose(
        infer(pd7, e=e, ce=ce)["u"], infer(sampled, e=e, ce=ce)["u"], rtol=0, atol=1e-8
    )


def _bare_output(shapes: list[Shape], low: float, high: float) -> OutputPlan:
    from fuzzyarm.language.model.rulebase import Input, Output, Term

    terms = tuple(Term(f"T{i}", shape) for i, shape in enumerate(shapes))
    rules = tuple(Rule(Is("e", "A"), (Consequent("u", term.name),)) for term in terms)
    rulebase = RuleBase(
        "bare",
        (Input("e", 0.0, 1.0, (Term("A", Shape("ramp", (0.0, 1.0))),)),),
        (Output("u", low, high, terms),),
        (RuleBlock(rules),),
    )
    return plan(rulebase).outputs["u"]


@pytest.mark.parametrize("order", list(itertools.permutations("ABC")))
def test_three_sets_over_one_another_in_any_order(order):
    shapes = {"A": "0 4 10", "B": "1 5 9", "C": "2 7 8"}
    text = (
        "rulebase over\ninput x 0 .. 1\noutput u 0 .. 10\nterms x: triangles L M H\n"
        + "".join(f"term u {name}: triangle {shapes[name]}\n" for name in order)
        + "inference u: defuzzifier {method}\n"
        + "".join(f"rule if x is {x} then u is {u} with {w}\n"
                  for x, u, w in (("L", "A", 0.9), ("M", "B", 0.8), ("H", "C", 0.7)))
        + "rule if x is L then u is C with 0.4\nrule if x is H then u is A with 0.3\n"
    )  # fmt: skip
    exact, sampled = (
        parse(text.replace("{method}", method)).rulebase
        for method in ("centroid exact", "centroid(20001)")
    )
    for x in (0.1, 0.3, 0.45, 0.6, 0.8):
        assert infer(exact, x=x)["u"] == pytest.approx(infer(sampled, x=x)["u"], abs=1e-4)
