"""Operations of a control step, against counts by hand."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from controller_programs import SHIPPED, shipped_text, text_of
from needs import requires

from fuzzyarm.exchange.export import ExportError, export_files
from fuzzyarm.exchange.export.cost import rule_cost, step_cost
from fuzzyarm.exchange.export.routine import CallCost
from fuzzyarm.exchange.export.rulebase import direct_routine
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


_COUNTED = """#include <cstdint>
#include <cmath>
#include <cstdio>
static long tally[4];
struct Counted {
    double v;
    constexpr Counted(double x = 0.0) : v(x) {}
    explicit operator double() const { return v; }
    explicit operator float() const { return static_cast<float>(v); }
    explicit operator int32_t() const { return static_cast<int32_t>(v); }
};
#define MAKE(sign, sort) static inline Counted operator sign(const Counted &a, const Counted &b) \\
    { ++tally[sort]; return Counted(a.v sign b.v); }
MAKE(+, 0) MAKE(-, 0) MAKE(*, 1) MAKE(/, 2)
static inline Counted operator-(const Counted &a) { return Counted(-a.v); }
#define COMPARE(sign) static inline bool operator sign(const Counted &a, const Counted &b) \\
    { ++tally[3]; return a.v sign b.v; }
COMPARE(<) COMPARE(>) COMPARE(<=) COMPARE(>=) COMPARE(==) COMPARE(!=)
static inline Counted fabs(const Counted &a) { ++tally[3]; return Counted(std::fabs(a.v)); }
#define CALL(name) static inline Counted name(const Counted &a) { return Counted(std::name(a.v)); }
CALL(exp) CALL(log) CALL(sqrt) CALL(floor) CALL(ceil) CALL(rint) CALL(tanh)
static inline Counted pow(const Counted &a, const Counted &b)
    { return Counted(std::pow(a.v, b.v)); }
#define double Counted
#include "counted.h"
#undef double
int main() {
    long most[4] = {0, 0, 0, 0};
    for (int i = 0; i <= 40; ++i) {
        for (int j = 0; j <= 40; ++j) {
            for (int k = 0; k < 4; ++k) tally[k] = 0;
            (void)counted_u(Counted(-7.0 + 14.0 * i / 40), Counted(-7.0 + 14.0 * j / 40));
            for (int k = 0; k < 4; ++k) most[k] = tally[k] > most[k] ? tally[k] : most[k];
        }
    }
    std::printf("%ld %ld %ld %ld\\n", most[0], most[1], most[2], most[3]);
    return 0;
}
"""


WAYS = ("implication", "aggregation", "defuzzifier")

BASE = """rulebase counted
input e -6 .. 6
input ce -6 .. 6
output u -6 .. 6
terms e, ce, u: triangles NB NS ZE PS PB
term u odd: gaussian 1 2
inference implication {implication}, aggregation {aggregation}, defuzzifier {defuzzifier}, no-rule 0
rule if e is NB and ce is NB then u is NB
rule if e is ZE or ce is ZE then u is odd
rule if e is PS and ce is very PS then u is PS
rule if e is PB then u is PB
"""


def _counted(text: str, folder: Path) -> tuple[CallCost, dict[str, int]]:
    """Return the cost in the header, and the most of each sort that its compiled code takes."""
    routine = direct_routine(parse(text).rulebase, "u", "float64")
    (folder / "count.cpp").write_text(_COUNTED)
    for path, content in export_files([routine], folder / "counted.h").files:
        Path(path).write_text(content)
    compiler = ["g++", "-std=c++17", "-w", "count.cpp", "-o", "count"]
    subprocess.run(compiler, cwd=folder, check=True)
    run = subprocess.run([folder / "count"], check=True, capture_output=True, text=True)
    counts = map(int, run.stdout.split())
    return routine.cost(), dict(zip((SUMS, PRODUCTS, QUOTIENTS, COMPARISONS), counts, strict=True))


STRAIGHT = BASE.replace("gaussian 1 2", "triangle -1 1 3")


@pytest.mark.slow
@requires("g++")
@pytest.mark.parametrize(
    ("text", "ways"),
    [
        (BASE, ("min", "max", "centroid(101)")),
        (BASE, ("product", "sum", "centroid(21)")),
        (BASE, ("min", "max", "centroid(51, joined)")),
        (STRAIGHT, ("min", "max", "centroid exact")),
        (STRAIGHT, ("product", "sum", "centroid exact")),
    ],
)
def test_a_header_bounds_the_operations_of_its_code(text, ways, tmp_path):
    cost, counted = _counted(text.format(**dict(zip(WAYS, ways, strict=True))), tmp_path)
    if cost.unbounded:
        assert cost.in_words().endswith("not bounded")
        return
    told = dict(cost.operations)
    assert counted[COMPARISONS] > 0
    for sort, most in counted.items():
        assert most <= told.get(sort, 0) <= 1.7 * most + 12, sort


@pytest.mark.slow
@requires("g++")
@pytest.mark.parametrize(
    "method",
    [
        "centroid exact", "nearest-of-maximum(101)", "mean-of-maximum", "smallest-of-maximum",
        "largest-of-maximum(51)", "bisector", "bisector(101)",
    ],
)  # fmt: skip
def test_a_header_says_what_has_no_bound(method, tmp_path):
    text = BASE.format(implication="min", aggregation="max", defuzzifier=method)
    cost, counted = _counted(text, tmp_path)
    assert counted[COMPARISONS] > dict(cost.operations)[COMPARISONS]  # the loops, not in the figure
    method = str(parse(text).rulebase.output("u").defuzzifier)
    assert cost.in_words().endswith(f", and those of {method}, not bounded")
    assert cost.by_sort()[method] is None
    assert f"{method}, not bounded" in " ".join(
        (tmp_path / "counted.h").read_text().replace(" * ", " ").split()
    )
