"""Interval type-2: against published numbers, rationals, brute force and embedded sets."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import combinations, pairwise, product
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.diagnostic import Diagnostic
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.exchange.export.rulebase import direct_routine
from fuzzyarm.inference import InferenceError, compiled, infer, infer_interval
from fuzzyarm.inference.plan import plan
from fuzzyarm.language import parse, write
from fuzzyarm.language.check import check
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Hedge,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.proof.map.centroid_bounds import average_bounds, centroid_bounds
from fuzzyarm.symbolic.kinds import HEDGES, SNORMS, TNORMS
from tests.interpreted import interpreted

TIPPER = """\
rulebase tipper2
input service 0 .. 10
input food 0 .. 10
output tip 0 .. 30
term service poor:      gaussian 0 1.5  over gaussian 0 1.2 height 0.9
term service good:      gaussian 5 1.5  over gaussian 5 1.2 height 0.9
term service excellent: gaussian 10 1.5 over gaussian 10 1.2 height 0.9
term food rancid:       trapezoid -2 0 1 3  over trapezoid -1.8 0 1 2.8 height 0.9
term food delicious:    trapezoid 7 9 10 12 over trapezoid 8 9 10 12 height 0.9
term tip cheap:         triangle 0 5 10   over triangle 1 5 9 height 0.9
term tip average:       triangle 10 15 20 over triangle 11 15 19 height 0.9
term tip generous:      triangle 20 25 30 over triangle 22 25 29 height 0.9
inference tip: defuzzifier karnik-mendel exact
rule if service is poor or food is rancid then tip is cheap
rule if service is good then tip is average
rule if service is excellent or food is delicious then tip is generous
"""
"""Of the tests of FuzzyLogic.jl."""

SUGENO = """\
rulebase tipper2
input service 0 .. 10
input food 0 .. 10
output tip 0 .. 30
term service poor:      gaussian 0 1.5  over gaussian 0 1.5 height 0.6
term service good:      gaussian 5 1.5  over gaussian 5 1.5 height 0.6
term service excellent: gaussian 10 1.5 over gaussian 10 1.5 height 0.9
term food rancid:       trapezoid -2 0 1 4  over trapezoid -2 0 1 3 height 0.8
term food delicious:    trapezoid 7 9 10 12 over trapezoid 8 9 10 12 height 0.8
term tip cheap:         singleton 5.002
term tip average:       singleton 15
term tip generous:      singleton 24.998
inference and product, or probor
inference tip: defuzzifier karnik-mendel exact, aggregation sum
rule if service is poor or food is rancid then tip is cheap with 0.5
rule if service is good then tip is average
rule if service is excellent or food is delicious then tip is generous
"""


def _model(text: str) -> RuleBase:
    rulebase = parse(text).rulebase
    assert rulebase is not None
    return rulebase


def _errors(text: str) -> list[Diagnostic]:
    """Return what is wrong with a text: mistakes, and what a check says of the model."""
    parsed = parse(text)
    found = list(parsed.diagnostics) or check(parsed.partial, parsed.document)
    return [each for each in found if each.is_error]


def _by(rulebase: RuleBase, method: str, *samples: int, aggregation: str = "max") -> RuleBase:
    return replace(
        rulebase,
        outputs=tuple(
            replace(each, defuzzifier=Defuzzifier(method, *samples), aggregation=aggregation)
            for each in rulebase.outputs
        ),
    )


def _values(rulebase: RuleBase, service: float = 2.0, food: float = 3.0) -> list[float]:
    """Return the value by the point, the kernel and the arrays, which must agree."""
    given = {"service": service, "food": food}
    one = interpreted(rulebase).point(given)["tip"]
    fast = compiled(rulebase)
    assert fast.reason == ""
    many = interpreted(rulebase).evaluate({name: [value] for name, value in given.items()})
    return [one, fast.at(service, food)[0], float(many["tip"][0])]


# --- Published numbers ---


def test_the_tipper_has_its_ends_to_a_billionth() -> None:
    rulebase = _model(TIPPER)
    left, right = infer_interval(rulebase, service=2, food=3)["tip"]
    assert (left, right) == pytest.approx((5.4202799202, 9.4553511985), abs=1e-9)
    assert _values(rulebase) == pytest.approx([7.4378155594] * 3, abs=1e-9)
    assert _values(_by(rulebase, "karnik-mendel-left")) == pytest.approx([left] * 3, abs=1e-12)
    assert _values(_by(rulebase, "karnik-mendel-right")) == pytest.approx([right] * 3, abs=1e-12)
    assert _values(_by(rulebase, "nie-tan")) == pytest.approx([7.4516295] * 3, abs=1e-7)


def test_with_101_samples_the_tipper_is_what_its_package_expects() -> None:
    assert _values(_by(_model(TIPPER), "karnik-mendel", 101)) == pytest.approx(
        [7.439] * 3, abs=1e-3
    )


def test_values_have_the_finite_ends() -> None:
    left, right = infer_interval(_model(SUGENO), service=2, food=3)["tip"]
    assert (left, right) == pytest.approx((7.1112, 10.2330), abs=5e-5)
    assert _values(_model(SUGENO)) == pytest.approx([0.5 * (left + right)] * 3, abs=1e-13)


# --- Random rule bases, and oracles of our own ---


def _random(seed: int, *, implication: str = "min", aggregation: str = "max") -> RuleBase:
    """Two inputs of three terms, five output sets, all straight, without upright edges."""
    rng = np.random.default_rng(seed)

    def term(name: str, centre: float, width: float) -> Term:
        flat = width * rng.uniform(0.0, 0.3)
        corners = [centre - width, centre - flat, centre + flat, centre + width]
        inner = [corners[0] + rng.uniform(0.05, 0.4) * (width - flat), corners[1], corners[2]]
        inner.append(corners[3] - rng.uniform(0.05, 0.4) * (width - flat))
        lower = Shape("trapezoid", tuple(inner), rng.uniform(0.6, 1.0))
        return Term(name, Shape("trapezoid", tuple(corners)), lower=lower)

    def terms(count: int, low: float, high: float) -> tuple[Term, ...]:
        step = (high - low) / (count - 1)
        return tuple(
            term(f"t{i}", low + i * step, step * rng.uniform(0.8, 1.6)) for i in range(count)
        )

    inputs = tuple(Input(name, -1.0, 1.0, terms(3, -1.0, 1.0)) for name in "ab")
    output = Output(
        "y", 0.0, 10.0, terms(5, 1.0, 9.0), aggregation=aggregation,
        defuzzifier=Defuzzifier("karnik-mendel"),
    )  # fmt: skip
    rules = tuple(
        Rule(
            And((Is("a", f"t{i}"), Is("b", f"t{j}"))),
            (Consequent("y", f"t{rng.integers(5)}"),),
            float(rng.choice([1.0, 0.7])),
        )
        for i, j in product(range(3), repeat=2)
    )
    return RuleBase("r", inputs, (output,), (RuleBlock(rules, implication=implication),))


def _heights(
    rulebase: RuleBase, point: dict[str, float], *, lower: bool
) -> list[tuple[Shape, float]]:
    """Return each asserted set with its strength: rule by rule, for conjunctions under min."""

    def shape(variable: str, name: str) -> Shape:
        term = rulebase.variable(variable).term(name)
        return term.lower if lower and term.lower is not None else term.shape

    found = []
    for rule in rulebase.rules:
        assert isinstance(rule.antecedent, And)
        parts = [part for part in rule.antecedent.operands if isinstance(part, Is)]
        degrees = [
            np.interp(point[p.variable], *_corners(shape(p.variable, p.term))) for p in parts
        ]
        consequent = rule.consequents[0]
        found.append((shape("y", consequent.term), float(min(degrees)) * rule.weight))
    return found


def _corners(shape: Shape) -> tuple[list[float], list[float]]:
    heights = [0.0, shape.height, shape.height, 0.0]
    return list(shape.parameters), heights


Array = NDArray[np.float64]


def _sampled_ends(rulebase: RuleBase, point: dict[str, float], samples: int) -> tuple[float, float]:
    """Return Karnik and Mendel's ends over many samples: sums up to each switch point."""
    ys = np.linspace(0.0, 10.0, samples)
    curves: list[Array] = []
    for lower in (True, False):
        total = np.zeros(samples)
        for shape, height in _heights(rulebase, point, lower=lower):
            if height > 0.0:
                first, last = np.searchsorted(ys, [shape.parameters[0], shape.parameters[-1]])
                cut = np.minimum(height, np.interp(ys[first:last], *_corners(shape)))
                np.maximum(total[first:last], cut, out=total[first:last])
        total[[0, -1]] *= 0.5  # the trapezoid rule: sets may go on at the ends of the range
        curves.append(total)
    ends = []
    for sign in (-1.0, 1.0):
        low, high = (curve[:: int(sign)] for curve in curves)
        x = ys[:: int(sign)]
        area = high.sum() + np.cumsum(low - high)
        moment = (high * x).sum() + np.cumsum((low - high) * x)
        with np.errstate(all="ignore"):
            found = np.where(area > 0.0, moment / area, -sign * np.inf)
        ends.append(float(found.max() if sign > 0.0 else found.min()))
    return ends[0], ends[1]


@pytest.mark.parametrize("seed", range(30))
def test_ends_agree_with_a_hundred_thousand_samples(seed: int) -> None:
    rulebase = _random(seed)
    rng = np.random.default_rng(1000 + seed)
    a, b = rng.uniform(-0.9, 0.9, (2, 2))
    found = infer_interval(rulebase, a=a, b=b)["y"]
    for i in range(2):
        wanted = _sampled_ends(rulebase, {"a": float(a[i]), "b": float(b[i])}, 100_001)
        ends = [float(found[0][i]), float(found[1][i])]
        assert ends == pytest.approx(list(wanted), abs=1e-7)  # 1e-8 of the range


def _envelope(
    lines: list[tuple[Fraction, Fraction, Fraction, Fraction]], edges: list[Fraction]
) -> list[tuple[Fraction, Fraction]]:
    """Return the highest line at both ends of each panel; panels are cut at all crossings."""

    def height(line: tuple[Fraction, ...], y: Fraction) -> Fraction:
        x0, y0, x1, y1 = line
        return y0 + (y1 - y0) * (y - x0) / (x1 - x0)

    found = []
    for left, right in pairwise(edges):
        here = [line for line in lines if line[0] <= left and line[2] >= right]
        best = max(here, key=lambda each: height(each, (left + right) / 2), default=None)
        zero = Fraction(0)
        found.append((zero, zero) if best is None else (height(best, left), height(best, right)))
    return found


def _exact_lines(
    shapes: list[tuple[Shape, float]], implication: str
) -> list[tuple[Fraction, Fraction, Fraction, Fraction]]:
    lines = []
    for shape, strength in shapes:
        w = Fraction(strength)
        if w <= 0:
            continue
        xs, ys = ([Fraction(x) for x in each] for each in _corners(shape))
        for (x0, y0), (x1, y1) in pairwise(zip(xs, ys, strict=True)):
            if x0 == x1:
                continue
            if implication == "product":
                lines.append((x0, w * y0, x1, w * y1))
                continue
            stops = [(x0, y0), (x1, y1)]
            if (y0 - w) * (y1 - w) < 0:
                stops.insert(1, (x0 + (w - y0) * (x1 - x0) / (y1 - y0), w))
            lines += [(a, min(ya, w), b, min(yb, w)) for (a, ya), (b, yb) in pairwise(stops)]
    return lines


def _exact_end(
    edges: list[Fraction],
    below: list[tuple[Fraction, Fraction]],
    above: list[tuple[Fraction, Fraction]],
) -> Fraction:
    """Return the greatest centroid between two curves by bisection of F, in rationals."""

    def integral(c: Fraction) -> Fraction:
        total = Fraction(0)
        for (left, right), low, high in zip(pairwise(edges), below, above, strict=True):
            parts = [(left, right, low if right <= c else high)]
            if left < c < right:
                share = (c - left) / (right - left)
                parts = [
                    (left, c, (low[0], low[0] + share * (low[1] - low[0]))),
                    (c, right, (high[0] + share * (high[1] - high[0]), high[1])),
                ]
            for a, b, (ya, yb) in parts:
                total += (b - a) * ((a - c) * (2 * ya + yb) + (b - c) * (ya + 2 * yb)) / 6
        return total

    a, b = edges[0], edges[-1]
    while b - a > Fraction(1, 10**14):
        middle = (a + b) / 2
        a, b = (middle, b) if integral(middle) > 0 else (a, middle)
    return (a + b) / 2


@pytest.mark.parametrize(("seed", "implication"), [(1, "min"), (2, "product"), (3, "min")])
def test_ends_are_exact_in_rationals(seed: int, implication: str) -> None:
    """The strengths are floats of our own; everything behind them is rational."""
    rulebase = _random(seed, implication=implication)
    point = {"a": 0.3125, "b": -0.4375}
    lines = [
        _exact_lines(_heights(rulebase, point, lower=lower), implication) for lower in (True, False)
    ]
    edges = {Fraction(0), Fraction(10)}
    for side in lines:
        edges |= {x for line in side for x in (line[0], line[2])}
        for (a, ya, b, yb), (c, yc, d, yd) in combinations(side, 2):
            one, other = (yb - ya) / (b - a), (yd - yc) / (d - c)
            if one != other:
                x = (yc - other * c - ya + one * a) / (one - other)
                if max(a, c) < x < min(b, d):
                    edges.add(x)
    inside = sorted(x for x in edges if 0 <= x <= 10)
    below, above = (_envelope(side, inside) for side in lines)
    right = _exact_end(inside, below, above)
    mirrored = [-x for x in reversed(inside)]
    turned = [[(b, a) for a, b in reversed(curve)] for curve in (below, above)]
    left = -_exact_end(mirrored, *turned)
    wanted = pytest.approx([float(left), float(right)], abs=1e-11)  # 1e-12 of the range
    by_point = [interpreted(_by(rulebase, f"karnik-mendel-{s}")) for s in ("left", "right")]
    assert [each.evaluate(point)["y"] for each in by_point] == wanted
    by_kernel = [compiled(_by(rulebase, f"karnik-mendel-{s}")) for s in ("left", "right")]
    assert [each.at(*point.values())[0] for each in by_kernel] == wanted
    # The bounds of proofs are those of the same panels, from outside.
    panels = np.array(list(map(float, inside)))
    curves = [np.array([[float(a), float(b)] for a, b in curve]) for curve in (below, above)]
    assert [float(each) for each in centroid_bounds(panels, *curves)] == wanted


def test_values_between_two_have_the_ends_of_all_choices() -> None:
    text = """\
rulebase r
input a 0 .. 1
output y -10 .. 10
term a LOW:  ramp 1 0 over ramp 0.9 0 height 0.7
term a HIGH: ramp 0 1 over ramp 0.2 1 height 0.8
term y ONE:   singleton 2 over singleton -1
term y TWO:   linear 3*a + 2 over linear 2*a - 1
term y THREE: singleton 7
inference y: defuzzifier karnik-mendel, aggregation sum, outside extend
rule if a is LOW then y is ONE
rule if a is HIGH then y is TWO with 0.5
rule if a is not LOW then y is THREE
"""
    rulebase = _model(text)
    a = 0.375
    low, high = (max(0.0, (0.9 - a) / 0.9) * 0.7, 1 - a), ((a - 0.2) / 0.8 * 0.8, a)
    weights = [low, (0.5 * high[0], 0.5 * high[1]), (1 - low[1], 1 - low[0])]
    values = [(-1.0, 2.0), (2 * a - 1, 3 * a + 2), (7.0, 7.0)]
    averages = [
        sum(w * y for w, y in zip(ws, ys, strict=True)) / sum(ws)
        for ws in product(*weights)
        for ys in product(*values)
    ]
    wanted = pytest.approx([min(averages), max(averages)], abs=1e-13)
    assert list(infer_interval(rulebase, a=a)["y"]) == wanted
    ends = [
        compiled(_by(rulebase, f"karnik-mendel-{s}", aggregation="sum")) for s in ("left", "right")
    ]
    extended = [each.rulebase for each in ends]
    assert [compiled(each).at(a)[0] for each in extended] == wanted
    found = average_bounds(
        *(np.array(each) for each in zip(*values, strict=True)),
        *(np.array(each) for each in zip(*weights, strict=True)),
    )
    # Bounds of proofs, so from outside.
    assert [float(each) for each in found] == pytest.approx(
        [min(averages), max(averages)], abs=1e-12
    )


def test_a_set_that_no_rule_concludes_leaves_values_as_they_are() -> None:
    """Upper and lower strength of a value are two, whatever other terms the output has."""
    text = """\
rulebase r
input x 0 .. 1
output u 0 .. 10
term x A: triangle 0 0 1 over triangle 0 0 0.6 height 0.8
term x B: triangle 0 1 1 over triangle 0.4 1 1 height 0.8
term u P: singleton 2
term u Q: singleton 7
term u R: triangle 0 1 2
inference u: defuzzifier karnik-mendel exact
rule if x is A then u is P
rule if x is B then u is Q
"""
    rulebase = _model(text)
    alone = _model(text.replace("term u R: triangle 0 1 2\n", ""))
    assert infer_interval(rulebase, x=0.45) == infer_interval(alone, x=0.45)
    (left, right), value = infer_interval(alone, x=0.45)["u"], compiled(rulebase).at(0.45)[0]
    assert 2.0 < left < right < 7.0
    assert value == pytest.approx(0.5 * (left + right), abs=1e-12)


# --- What holds of every interval ---

_HEDGES = [(), (Hedge("not"),), (Hedge("very"),), (Hedge("not"), Hedge("somewhat"))]


def _family(share: float | None, conjunction: str, disjunction: str, *hedges: Hedge) -> RuleBase:
    """A rule base of gaussians: type 2, or of type 1 at a share of the way from lower to upper."""

    def term(name: str, mean: float, width: float) -> Term:
        if share is None:
            lower = Shape("gaussian", (mean, 0.6 * width), 0.8)
            return Term(name, Shape("gaussian", (mean, width)), lower=lower)
        return Term(name, Shape("gaussian", (mean, (0.6 + 0.4 * share) * width), 0.8 + 0.2 * share))

    inputs = tuple(
        Input(name, 0.0, 1.0, (term("lo", 0.0, 0.4), term("hi", 1.0, 0.4))) for name in "ab"
    )
    method = "karnik-mendel" if share is None else "centroid"
    output = Output(
        "y", 0.0, 4.0, (term("one", 1.0, 0.5), term("three", 3.0, 0.5)),
        defuzzifier=Defuzzifier(method, 81),
    )  # fmt: skip
    both = And((Is("a", "lo"), Is("b", "hi", hedges)))
    rules = (
        Rule(both, (Consequent("y", "one"),)),
        Rule(
            Hedged((Hedge("not"),), Or((Is("a", "lo"), Is("b", "lo")))),
            (Consequent("y", "three"),),
            0.9,
        ),
        Rule(Is("b", "lo"), (Consequent("y", "three", hedges),), 0.3),
    )
    block = RuleBlock(rules, conjunction=conjunction, disjunction=disjunction)
    return RuleBase("family", inputs, (output,), (block,))


@pytest.mark.parametrize("conjunction", list(TNORMS))
def test_every_embedded_rule_base_lies_between_the_ends(conjunction: str) -> None:
    dual = TNORMS[conjunction].dual or "max"
    disjunction = dual if dual in SNORMS else "max"
    rng = np.random.default_rng(5)
    given = {"a": rng.uniform(0, 1, 12), "b": rng.uniform(0, 1, 12)}
    for hedges in _HEDGES:
        left, right = infer_interval(_family(None, conjunction, disjunction, *hedges), given)["y"]
        for share in (0.0, 0.5, 1.0):
            inner = infer(_family(share, conjunction, disjunction, *hedges), given)["y"]
            assert np.all(left <= inner + 1e-12), (hedges, share)
            assert np.all(inner <= right + 1e-12), (hedges, share)


@pytest.mark.parametrize("method", ["karnik-mendel", "karnik-mendel-left", "nie-tan"])
def test_between_equal_ends_is_what_type_1_gives(method: str) -> None:
    rulebase = _family(0.5, "product", "max")
    given = {"a": np.linspace(0, 1, 7), "b": 0.3}
    for samples in ((), (41,)):
        wanted = infer(_by(rulebase, "centroid", *samples), given)["y"]
        found = infer(_by(rulebase, method, *samples), given)["y"]
        np.testing.assert_allclose(found, wanted, atol=1e-11)


@pytest.mark.parametrize("aggregation", ["max", "sum", "probor"])
@pytest.mark.parametrize("method", ["karnik-mendel", "nie-tan"])
def test_point_and_kernel_agree_on_curved_sets(method: str, aggregation: str) -> None:
    rulebase = _by(_family(None, "product", "max"), method, aggregation=aggregation)
    fast, slow = compiled(rulebase), interpreted(rulebase)
    assert fast.reason == ""
    for a, b in ((0.2, 0.7), (0.9, 0.1)):
        assert fast.at(a, b)[0] == pytest.approx(slow.evaluate({"a": a, "b": b})["y"], abs=1e-12)


def test_where_the_lower_set_is_nothing_the_ends_are_those_of_the_upper() -> None:
    text = TIPPER.replace("over gaussian 5 1.2 height 0.9", "over triangle 4 5 6")
    rulebase = _model(text.replace("trapezoid 7 9 10 12 over", "trapezoid 7 9 10 12  over"))
    only = replace(
        rulebase, blocks=(replace(rulebase.blocks[0], rules=rulebase.blocks[0].rules[1:2]),)
    )
    for method, end in (("left", 10.0), ("right", 20.0)):
        assert _values(_by(only, f"karnik-mendel-{method}"), 3.5, 5.0) == [end] * 3


def test_later_rules_read_the_middle() -> None:
    text = TIPPER.replace("output tip 0 .. 30", "output tip 0 .. 30\noutput mood 0 .. 1")
    text += "term tip good: ramp 0 30\nterm mood fine: singleton 1\nterm mood bad: singleton 0\n"
    text += "inference mood: defuzzifier weighted-average\nblock later\n"
    text += "rule if tip is good then mood is fine\nrule if tip is not good then mood is bad\n"
    rulebase = _model(text)
    found = infer(rulebase, service=2, food=3)
    assert found["mood"] == pytest.approx(found["tip"] / 30, abs=1e-12)
    ends = infer_interval(rulebase, service=2, food=3)
    assert ends["mood"] == (found["mood"], found["mood"])
    assert sum(ends["tip"]) / 2 == pytest.approx(found["tip"], abs=1e-12)


def test_some_outputs_need_only_their_inputs() -> None:
    rulebase = _model(TIPPER)
    part = replace(rulebase, outputs=(*rulebase.outputs, Output("more", 0, 1)))
    wanted = infer_interval(rulebase, service=2, food=3)
    assert infer_interval(part, service=2, food=3, outputs=["tip"]) == wanted


# --- What is refused ---


def test_a_hedge_that_neither_rises_nor_falls_is_refused_by_name() -> None:
    fuzzyarm.kinds.hedge("halfway", lambda d: fuzzyarm.op.minimum(d, 1 - d))
    rulebase = _family(None, "min", "max", Hedge("halfway"))
    try:
        with pytest.raises(InferenceError, match="'halfway' neither rises nor falls"):
            plan(rulebase)
    finally:
        HEDGES.remove("halfway")


@pytest.mark.parametrize("method", ["centroid", "bisector", "mean-of-maximum"])
def test_a_way_of_type_1_is_refused(method: str) -> None:
    errors = _errors(TIPPER.replace("karnik-mendel exact", method))
    assert [each.name for each in errors] == ["defuzzifier-does-not-fit"]
    with pytest.raises(InferenceError, match="interval type 2"):
        infer(_by(_model(TIPPER), method), service=2, food=3)


# --- The language ---


@pytest.mark.parametrize(
    ("shapes", "finding"),
    [
        ("triangle 0 5 10 over triangle 1 5 11", "lower-above-upper"),
        ("trapezoid 0 5 5 10 over triangle 0 5 10", ""),
        ("trapezoid 0 0 5 10 over rectangle 0 5", ""),
        ("trapezoid 0 0 5 10 over rectangle 0 5.5", "lower-above-upper"),
        ("triangle 0 5 10 height 0.8 over triangle 0 5 10 height 0.9", "lower-above-upper"),
        ("gaussian 5 2 over gaussian 5 1.5", ""),
        ("gaussian 5 2 over gaussian 6 2", "lower-above-upper"),
        ('formula "x / 30" over formula "x / 40"', ""),
        ('formula "x / 40" over formula "x / 30"', "lower-above-upper"),
        ("triangle 0 5 10 over singleton 5", "bad-interval"),
        ("triangle 0 5 10 over", "unknown-shape"),
        ("triangle 0 5 10 over over", "unknown-shape"),
    ],
)
def test_the_lower_one_has_to_be_below(shapes: str, finding: str) -> None:
    lines = [line for line in TIPPER.splitlines() if "tip cheap" not in line]
    lines.insert(4, f"term tip cheap: {shapes}")
    errors = _errors("\n".join(lines))
    assert [each.name for each in errors] == ([finding] if finding else [])
    if finding in {"lower-above-upper", "bad-interval"}:
        assert errors[0].span.line == 5
        assert errors[0].span.column > lines[4].index("over")


def test_a_file_is_written_as_it_was_read() -> None:
    for text in (TIPPER, SUGENO):
        rulebase = _model(text)
        assert _model(write(rulebase)) == rulebase
        assert write(rulebase).count(" over ") == text.count(" over ")


# --- What is made of it ---


@pytest.mark.parametrize(
    ("implication", "aggregation", "samples"),
    [("min", "max", ()), ("product", "max", ()), ("min", "sum", ()), ("min", "max", (41,))],
)
def test_exported_code_has_nie_and_tans_number(
    implication: str, aggregation: str, samples: tuple[int, ...]
) -> None:
    rulebase = _random(4, implication=implication)
    output = rulebase.outputs[0]
    apart = tuple(  # of scaled sets at most two may overlap
        replace(term, shape=_narrow(term.shape), lower=_narrow(term.lower)) for term in output.terms
    )
    rulebase = replace(rulebase, outputs=(replace(output, terms=apart),))
    rulebase = _by(rulebase, "nie-tan", *samples, aggregation=aggregation)
    routine = direct_routine(rulebase, "y", precision="float64")
    points = [np.array([-0.7, 0.1, 0.55]), np.array([0.3, -0.2, 0.8])]
    wanted = infer(rulebase, a=points[0], b=points[1])["y"]
    np.testing.assert_allclose(routine.evaluate(*points), wanted, atol=1e-12)
    for method in ("karnik-mendel", "karnik-mendel-left", "karnik-mendel-right"):
        ends = _by(rulebase, method, *samples, aggregation=aggregation)
        found = direct_routine(ends, "y", precision="float64").evaluate(*points)
        np.testing.assert_allclose(found, infer(ends, a=points[0], b=points[1])["y"], atol=1e-13)


def _narrow(shape: Shape | None) -> Shape:
    assert shape is not None
    middle = 0.5 * (shape.parameters[1] + shape.parameters[2])
    return replace(shape, parameters=tuple(middle + 0.6 * (x - middle) for x in shape.parameters))


def test_a_trace_shows_both_readings() -> None:
    trace = fuzzyarm.explain(_model(TIPPER), service=2, food=3)
    first, output = trace.rules[0], trace.outputs[0]
    upper, lower = np.exp(-4 / 4.5), 0.9 * np.exp(-4 / 2.88)
    assert (first.lower, first.strength) == pytest.approx((lower, upper))
    assert len(trace.rules) == 3
    assert [each.term for each in output.consequents] == ["cheap", "average", "generous"]
    assert (output.left, output.right) == pytest.approx((5.4202799202, 9.4553511985), abs=1e-9)
    written = trace.to_dict()
    assert written["outputs"][0]["left"] == output.left
    plain = fuzzyarm.explain(_by(_family(0.5, "min", "max"), "centroid"), a=0.5, b=0.5).to_dict()
    assert "lower" not in plain["rules"][0]
    assert "left" not in plain["outputs"][0]


def test_a_table_of_each_end(tmp_path: Path) -> None:
    out = tmp_path / "t.lut"
    argv = ["compile", str(shipped("tipper2.frb")), "-o", str(out), "--levels", "5", "--ends"]
    assert main(argv) == 0
    ends = infer_interval(_model(TIPPER), service=2.5, food=7.5)["tip"]
    for name, wanted in zip(("left", "right"), ends, strict=True):
        table = fuzzyarm.read_table(tmp_path / f"t-{name}.lut")
        assert table.lookup(service=2.5, food=7.5) == pytest.approx(wanted, abs=1e-9)
    assert main(["compile", str(shipped("pd7.frb")), "-o", str(out), "--ends"]) == 1
