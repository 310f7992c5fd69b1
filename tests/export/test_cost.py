"""Operations of a control step, against counts by hand."""

from __future__ import annotations

import pytest
from controller_programs import SHIPPED, shipped_text, text_of

from fuzzyarm.exchange.export import ExportError
from fuzzyarm.exchange.export.cost import rule_cost, step_cost
from fuzzyarm.language import parse

SUMS, PRODUCTS, QUOTIENTS = "additions and subtractions", "multiplications", "divisions"
COMPARISONS = "comparisons"


def test_a_table_controller_by_hand():
    # Of each joint: two errors, two gains, twelve thresholds twice by halving, count and voltage.
    cost = step_cost(shipped_text("fuzzy-lut"))
    joint = {SUMS: 2, PRODUCTS: 4, COMPARISONS: 8, QUOTIENTS: 1}
    assert cost.least == cost.most == cost.exported == {k: 2 * n for k, n in joint.items()}
    # What it learns besides: one correction, and its bounds; none in the first period.
    learns = step_cost(shipped_text("soc-zero"))
    assert learns.most - cost.most == {SUMS: 2, PRODUCTS: 2, COMPARISONS: 8}
    assert learns.least - cost.least == {COMPARISONS: 4}


SMALL = """rulebase small
input  a  0 .. 1
output u  0 .. 1
terms a, u: triangles LO HI
rule if a is LO then u is HI
rule if a is HI then u is LO with 0.5
"""


def test_a_rule_base_by_hand():
    least, most = rule_cost(parse(SMALL).rulebase)
    # Between the two corners: the cell of the input; two lines; two rules, each with a neutral
    # second operand, one with a weight; two sets and their overlap, each one layer; the mean.
    assert most == {
        COMPARISONS: 8 + 2 + 2 + 1 + 3 * 3 + 4,
        SUMS: 1 + 2 * 2 + 3 * 6 + 1,
        PRODUCTS: 1 + 2 + 1 + 3 * 5,
        QUOTIENTS: 1,
    }
    assert least.total() <= most.total()


def test_samples_cost_what_they_are():
    def of(samples):
        way = f"inference defuzzifier centroid({samples}, midpoints)\n"
        return rule_cost(parse(SMALL.replace("rule if", way + "rule if", 1)).rulebase)[1]

    few, many = of(100), of(200)
    # At each of 100 more samples two sets are cut and folded; two products, two sums.
    assert many - few == {COMPARISONS: 4 * 100, SUMS: 2 * 100, PRODUCTS: 2 * 100}


@pytest.mark.parametrize("name", SHIPPED)
def test_the_kernel_takes_less_than_the_exported_program(name):
    cost = step_cost(shipped_text(name))
    assert 0 < cost.least.total() <= cost.most.total() <= cost.exported.total()


def test_sources_that_remember_and_choices():
    head = "controller c\nperiod 10 ms\naxis a\n  e = error of x\n"
    plain = step_cost(text_of(head + "  drive u = e\n"))
    assert plain.most == {SUMS: 1}
    limited = step_cost(text_of(head + "  drive u = e, within -1 .. 1\n"))
    assert limited.most - plain.most == {COMPARISONS: 2}
    integral = "  i = integral of e, anti-windup hold\n  drive u = i"
    ends = ("\n", ", within -1 .. 1\n")
    free, wound = (step_cost(text_of(head + integral + end)) for end in ends)
    assert (wound.most - free.most)[COMPARISONS] >= 2
    with pytest.raises(ExportError, match="partner"):
        step_cost(shipped_text("ffid+fuzzy"))
