"""The numbers of a term mean what the manual of each program says, written out here.

The expected values are arithmetic in this file or come from scikit-fuzzy, never from the
package: an order of parameters that is wrong on the way in and on the way out would
otherwise cancel.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from math import exp

import numpy as np
import pytest
import skfuzzy

from fuzzyarm.exchange.formats import parse
from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import membership
from fuzzyarm.symbolic import kinds

# Words that are read and never written, as the manual of each program defines them.
READ_ALONE = {
    "centroid": {"COGS of fcl-scikit", "centroid_integral of fis", "centroid_integral of matlab",
                 "centroid_integral of octave"},
    "mean-of-maximum": {"MOM of fcl-scikit"},
    "weighted-average": {"COGF of fcl", "COGF of jfl"},
    "karnik-mendel": {"EKM_algorithm of pyit2fls", "EIASC_algorithm of pyit2fls", "ekm of t2fis",
                      "iasc of t2fis", "eiasc of t2fis", "eods of t2fis", "karnikmendel of t2fis",
                      "karnik-mendel of t2fis"},
    "nie-tan": {"nietan of t2fis", "nie-tan of t2fis"},
    "probor": {"ASUM of jfl"},
    "ramp": {"linzmf of matlab", "linzmf of octave", "leftLinearShape of fml"},
    "singleton": {"singletonmf of fis"},
}  # fmt: skip


def test_words_that_are_only_read_mean_what_their_manuals_say() -> None:
    found: dict[str, set[str]] = {}
    for registry in (kinds.SHAPES, kinds.TNORMS, kinds.SNORMS, kinds.HEDGES, kinds.DEFUZZIFIERS):
        for kind in registry.values():
            for program, spelled in kind.names.items():
                for word in spelled.split(",")[1:]:
                    found.setdefault(kind.name, set()).add(f"{word.split()[0]} of {program}")
    assert found == READ_ALONE


XS = (-3.0, 0.5, 1.0, 2.75, 4.0, 4.5, 5.0, 6.25, 9.0, 14.0)

Function = Callable[[float], float]


def gauss(x: float, sigma: float, c: float) -> float:
    return exp(-((x - c) ** 2) / (2 * sigma**2))


def gauss2(x: float, sigma1: float, c1: float, sigma2: float, c2: float) -> float:
    """gauss2mf of MATLAB: [sig1 c1 sig2 c2], c1 < c2."""
    left = gauss(x, sigma1, c1) if x <= c1 else 1.0
    return left * (gauss(x, sigma2, c2) if x >= c2 else 1.0)


def sig(x: float, a: float, c: float) -> float:
    return 1 / (1 + exp(-a * (x - c)))


def bell(x: float, a: float, b: float, c: float) -> float:
    return 1 / (1 + abs((x - c) / a) ** (2 * b))


def trapezoid(x: float, a: float, b: float, c: float, d: float) -> float:
    return max(min((x - a) / (b - a), 1.0, (d - x) / (d - c)), 0.0)


def s(x: float, a: float, b: float) -> float:
    if x <= (a + b) / 2:
        return 0.0 if x <= a else 2 * ((x - a) / (b - a)) ** 2
    return 1.0 if x >= b else 1 - 2 * ((x - b) / (b - a)) ** 2


def ramp(x: float, zero: float, one: float) -> float:
    return min(max((x - zero) / (one - zero), 0.0), 1.0)


MATLAB: dict[str, Function] = {
    "'trimf',[1 4 9]": lambda x: trapezoid(x, 1, 4, 4, 9) if x != 4 else 1.0,
    "'trapmf',[1 4 5 9]": lambda x: trapezoid(x, 1, 4, 5, 9),
    "'gaussmf',[2 5]": lambda x: gauss(x, 2, 5),
    "'gauss2mf',[2 4 3 6]": lambda x: gauss2(x, 2, 4, 3, 6),
    "'gbellmf',[2 3 5]": lambda x: bell(x, 2, 3, 5),
    "'sigmf',[2 4]": lambda x: sig(x, 2, 4),
    "'dsigmf',[5 2 3 7]": lambda x: abs(sig(x, 5, 2) - sig(x, 3, 7)),
    "'psigmf',[2 3 -5 8]": lambda x: sig(x, 2, 3) * sig(x, -5, 8),
    "'smf',[1 8]": lambda x: s(x, 1, 8),
    "'zmf',[1 8]": lambda x: 1 - s(x, 1, 8),
    "'pimf',[1 4 5 10]": lambda x: s(x, 1, 4) * (1 - s(x, 5, 10)),
    "'linsmf',[4 6]": lambda x: ramp(x, 4, 6),
    "'linzmf',[4 6]": lambda x: ramp(x, 6, 4),
}
"""Fuzzy Logic Toolbox User's Guide, by the page of each function."""

FUZZYLITE: dict[str, Function] = {
    "Gaussian 5 2": lambda x: gauss(x, 2, 5),
    "GaussianProduct 4 2 6 3": lambda x: gauss2(x, 2, 4, 3, 6),
    "Bell 5 2 3": lambda x: bell(x, 2, 3, 5),
    "Sigmoid 4 2": lambda x: sig(x, 2, 4),
    "SigmoidDifference 2 5 3 7": lambda x: abs(sig(x, 5, 2) - sig(x, 3, 7)),
    "SigmoidProduct 3 2 -5 8": lambda x: sig(x, 2, 3) * sig(x, -5, 8),
    "Ramp 6 4": lambda x: ramp(x, 6, 4),
    "Cosine 5 8": lambda x: 0.5 * (1 + math.cos(math.pi * (x - 5) / 4)) if 1 <= x <= 9 else 0.0,
    "Spike 5 8": lambda x: exp(-abs(10 / 8 * (x - 5))),
    "Triangle 1 4 9 0.5": lambda x: 0.5 * MATLAB["'trimf',[1 4 9]"](x),
}
"""The terms of fuzzylite by its class documentation."""

JFUZZYLOGIC: dict[str, Function] = {
    "TRIAN 1 4 9": MATLAB["'trimf',[1 4 9]"],
    "TRAPE 1 4 5 9": MATLAB["'trapmf',[1 4 5 9]"],
    "GAUSS 5 2": lambda x: gauss(x, 2, 5),
    "GAUSS2 4 2 6 3": lambda x: gauss2(x, 2, 4, 3, 6),
    "GBELL 2 3 5": lambda x: bell(x, 2, 3, 5),
    "SIGM 2 4": lambda x: sig(x, 2, 4),
    "DSIGM 3 2 3 7": lambda x: sig(x, 3, 2) - sig(x, 3, 7),
    "COSINE 4 5": FUZZYLITE["Cosine 5 8"],
    "(1, 0) (4, 1) (6, 0)": lambda x: max(min((x - 1) / 3, (6 - x) / 2), 0.0),
}
"""The manual of jFuzzyLogic: SIGM has its gain first, COSINE half its width."""


FIS_TERM = """[System]
Name='x'
ImpMethod='min'
AggMethod='max'
[Input1]
Name='x'
Range=[0 10]
MF1='a':TERM
[Output1]
Name='y'
Range=[0 1]
MF1='b':'trimf',[0 0.5 1]
[Rules]
1, 1 (1) : 1
"""
FLL_TERM = """InputVariable: x
range: 0 10
term: a TERM
OutputVariable: y
range: 0 1
aggregation: Maximum
defuzzifier: Centroid
term: b Triangle 0 0.5 1
RuleBlock: r
implication: Minimum
rule: if x is a then y is b
"""
FCL_TERM = """FUNCTION_BLOCK b FUZZIFY x TERM a := TERM; END_FUZZIFY
DEFUZZIFY y RANGE := (0 .. 1); METHOD : COG; TERM b := TRIAN 0 0.5 1; END_DEFUZZIFY
RULEBLOCK r ACT : MIN; ACCU : MAX; RULE 1 : IF x IS a THEN y IS b;
END_RULEBLOCK END_FUNCTION_BLOCK"""


def shape(text: str, suffix: str, producer: str | None = None) -> Shape:
    imported = parse(text, suffix, producer=producer)
    assert imported.rulebase is not None, [str(d) for d in imported.errors]
    return imported.rulebase.inputs[0].terms[0].shape


def agree(found: Shape, expected: Function) -> None:
    for x in XS:
        assert membership(found, x) == pytest.approx(expected(x), rel=1e-12, abs=1e-300), x


@pytest.mark.parametrize("term", MATLAB)
def test_functions_of_matlab(term: str) -> None:
    text = FIS_TERM.replace("TERM", term)
    for producer in ("matlab", "octave", "fuzzylite"):
        agree(shape(text, ".fis", producer), MATLAB[term])


@pytest.mark.parametrize("term", FUZZYLITE)
def test_terms_of_fuzzylite(term: str) -> None:
    agree(shape(FLL_TERM.replace("TERM", term), ".fll"), FUZZYLITE[term])
    text = FCL_TERM.replace("TERM a := TERM", f"RANGE := (0 .. 10); TERM a := {term}")
    agree(shape(text, ".fcl", "fuzzylite"), FUZZYLITE[term])


@pytest.mark.parametrize("term", JFUZZYLOGIC)
def test_functions_of_jfuzzylogic(term: str) -> None:
    text = FCL_TERM.replace(" a := TERM", f" a := {term}")
    agree(shape(text, ".fcl", "jfuzzylogic"), JFUZZYLOGIC[term])


@pytest.mark.parametrize(
    ("term", "oracle"),
    [
        ("'gaussmf',[2 5]", lambda x: skfuzzy.gaussmf(x, 5, 2)),
        ("'gauss2mf',[2 4 3 6]", lambda x: skfuzzy.gauss2mf(np.array([x]), 4, 2, 6, 3)[0]),
        ("'gbellmf',[2 3 5]", lambda x: skfuzzy.gbellmf(x, 2, 3, 5)),
        ("'sigmf',[2 4]", lambda x: skfuzzy.sigmf(x, 4, 2)),
        ("'dsigmf',[5 2 3 7]", lambda x: abs(skfuzzy.dsigmf(x, 2, 5, 7, 3))),
        ("'psigmf',[2 3 -5 8]", lambda x: skfuzzy.psigmf(x, 3, 2, 8, -5)),
    ],
)
def test_functions_of_matlab_are_those_of_scikit_fuzzy(term: str, oracle: Function) -> None:
    text = FIS_TERM.replace("TERM", term)
    agree(shape(text, ".fis"), oracle)


# ── formulas ─────────────────────────────────────────────────────────────────────────

FCL = """FUNCTION_BLOCK b
VAR_INPUT v : REAL; END_VAR
VAR_OUTPUT y : REAL; END_VAR
FUZZIFY v TERM a := (0, 1) (10, 1); END_FUZZIFY
DEFUZZIFY y TERM f := FUNCTION FORMULA; METHOD : COGF; END_DEFUZZIFY
RULEBLOCK r ACT : MIN; ACCU : MAX; RULE 1 : IF v IS a THEN y IS f; END_RULEBLOCK
END_FUNCTION_BLOCK
"""

FLL = """InputVariable: v
  range: 0 10
  term: a Rectangle 0 10
OutputVariable: y
  defuzzifier: WeightedAverage TakagiSugeno
  term: f Function FORMULA
RuleBlock:
  rule: if v is a then y is f
"""


@pytest.mark.parametrize(
    ("formula", "jfuzzylogic", "fuzzylite"),
    [
        # jFuzzyLogic has one level for ^ and %, from the left; fuzzylite is C's and FORTRAN's.
        ("v ^ 3 ^ 2", (2**3) ** 2, 2 ** (3**2)),
        ("v ^ 3 ^ v ^ 1", 64.0, 2.0**9),
        ("-v ^ 2", -4.0, -4.0),
        ("2 * 7 % 4", 2 * 3, 14 % 4),
        ("7 % 4 ^ v", 3**2, 7 % 16),
        ("7 - 4 - v", 1.0, 1.0),
        ("36 / 6 / v", 3.0, 3.0),
        ("log(100 * v / 2)", 2.0, math.log(100.0)),
        ("abs(0 - v) + exp(0)", 3.0, 3.0),
    ],
)
def test_operators_bind_as_in_the_program(
    formula: str, jfuzzylogic: float, fuzzylite: float
) -> None:
    for text, suffix, expected in ((FCL, ".fcl", jfuzzylogic), (FLL, ".fll", fuzzylite)):
        imported = parse(text.replace("FORMULA", formula), suffix)
        assert imported.rulebase is not None, [str(d) for d in imported.errors]
        assert infer(imported.rulebase, v=2.0)["y"] == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("suffix", [".fcl", ".fll"])
@pytest.mark.parametrize("opening", ["(", "-(", "1 + (", "v ^ (", "exp("])
def test_formulas_that_nest_are_read_or_refused(opening: str, suffix: str) -> None:
    text = FCL if suffix == ".fcl" else FLL
    for depth in (40, 99, 120, 3_000):
        formula = opening * depth + "v" + ")" * depth
        imported = parse(text.replace("FORMULA", formula), suffix)
        names = {d.name for d in imported.errors}
        assert "bad-formula" in names or (depth < 100 and not names)
        assert depth > 40 or not names
