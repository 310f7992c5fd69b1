"""Every figure that proofs have to reach, beside its time and its target.

    python benchmarks/proofs.py [--quick]

Times of floats on pd7 are of a second run in the same process; the first fills the matrices of
the Bernstein form. The time of the processor is what counts on a busy machine. --quick leaves
out four inputs and the rationals.
"""

from __future__ import annotations

import itertools
import random
import sys
import time
from collections.abc import Callable
from typing import Any

import fuzzyarm
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map import Prover


def timed(what: str, target: str, run: Callable[[], Any]) -> None:
    """Run twice and print the result and the second time."""
    run()
    once(what, target, run)


def once(what: str, target: str, run: Callable[[], Any]) -> None:
    """Run once and print the result, the time of the clock and that of the processor."""
    start, used = time.perf_counter(), time.process_time()
    found = run()
    clock, cpu = time.perf_counter() - start, time.process_time() - used
    print(
        f"{what:<46} {found!s:<26} {clock:7.3f} s ({cpu:7.3f} s CPU)  target {target}", flush=True
    )


def even(inputs: int, terms: int) -> RuleBase:
    """Return a rule base of even triangles, with conclusions near the mean of the inputs."""
    draw = random.Random(1)
    names = " ".join(f"t{i}" for i in range(terms))
    variables = [f"x{i}" for i in range(inputs)]
    lines = ["rulebase r", *(f"input {name} -1 .. 1" for name in variables), "output u -1 .. 1"]
    lines.append(f"terms {', '.join([*variables, 'u'])}: triangles {names}")
    for place in itertools.product(range(terms), repeat=inputs):
        term = round(sum(place) / inputs + 0.4 * draw.choice([-1, 0, 0, 1]))
        parts = " and ".join(f"x{i} is t{k}" for i, k in enumerate(place))
        lines.append(f"rule if {parts} then u is t{min(terms - 1, max(0, term))}")
    found = parse("\n".join(lines) + "\n").rulebase
    assert found is not None
    return found


def irregular(seed: int) -> RuleBase:
    """Return two inputs with overlapping trapezoids, and conclusions drawn at random."""
    draw = random.Random(seed)
    lines = ["rulebase r", "input x -1 .. 1", "input y -1 .. 1", "output u -1 .. 1"]
    counts = []
    for name in ("x", "y", "u"):
        counts.append(draw.randint(4, 7))
        for k in range(counts[-1]):
            middle, width = draw.uniform(-1, 1), 2.5 / counts[-1]
            ends = (
                middle - width * draw.uniform(0.5, 1.2), middle - width * draw.uniform(0, 0.4),
                middle + width * draw.uniform(0, 0.4), middle + width * draw.uniform(0.5, 1.2),
            )  # fmt: skip
            lines.append(f"term {name} t{k}: trapezoid {' '.join(f'{x:.3f}' for x in ends)}")
    lines.append("inference no-rule 0")
    lines += [
        f"rule if x is t{i} and y is t{j} then u is t{draw.randrange(counts[2])}"
        for i, j in itertools.product(range(counts[0]), range(counts[1]))
    ]
    found = parse("\n".join(lines) + "\n").rulebase
    assert found is not None
    return found


def pd7_numbers(*, exact: bool, target: str) -> None:
    """Print the numbers of pd7 on the page, each with its own pieces."""
    pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    rounded, plain = (fuzzyarm.compile_table(pd7, rounding=step) for step in (None, 0.0))
    run = once if exact else timed
    name = "rationals" if exact else "floats"

    def prover() -> Prover:
        return Prover(pd7, "u", exact=exact, tolerance=1e-7)

    def worst(table: Any, mode: str) -> str:
        bounds = prover().table(table, mode)
        return f"{max(bounds.high, -bounds.low):.9f}"

    def interval(bounds: Any) -> str:
        return f"{bounds.low:.7f} .. {bounds.high:.7f}"

    run(f"pd7 range, {name} (±16/3)", target, lambda: interval(prover().value({})))
    run(f"pd7 slope, {name} (-0.427808 .. 13/3)", target, lambda: interval(prover().slope({}, "e")))
    run(f"pd7 gradient, {name} (4.921608)", target, lambda: f"{prover().steepness({}).high:.7f}")
    run(f"pd7 linear, {name} (0.543485453)", target, lambda: worst(rounded, "linear"))
    run(f"pd7 linear --round 0, {name} (0.58017)", target, lambda: worst(plain, "linear"))
    run(f"pd7 bins, {name} (1031/516 = 1.998062)", target, lambda: worst(rounded, "bins"))
    for line in ("u odd", "u rises with e"):
        run(
            f"pd7 {line}, {name}",
            target,
            lambda line=line: fuzzyarm.prove(pd7, line, exact=exact).verdict,
        )


def spread(rulebase: RuleBase, tolerance: float) -> Callable[[], str]:
    """Return what bounds a rule base to a tolerance and writes the bounds down."""

    def run() -> str:
        bounds = Prover(rulebase, "u", tolerance=tolerance).value({})
        mark = "" if bounds.complete else " (incomplete)"
        return f"{bounds.low:.6f} .. {bounds.high:.6f}{mark}"

    return run


def main() -> None:
    """Print all figures."""
    quick = "--quick" in sys.argv
    pd7_numbers(exact=False, target="0.2 s")
    if not quick:
        pd7_numbers(exact=True, target="5 s")
    for seed in (1, 2, 3):
        once(f"two irregular inputs ({seed}), 1e-6", "10 s", spread(irregular(seed), 1e-6))
    three = even(3, 7)
    once("3 x 7 terms, range to 1e-3", "5 s", spread(three, 1e-3))
    once(
        "3 x 7 terms, slope to 1e-3", "5 s",
        lambda: f"{Prover(three, 'u', tolerance=1e-3).slope({}, 'x0').high:.4f}",
    )  # fmt: skip
    table = fuzzyarm.compile_table(three, levels=13)
    once(
        "3 x 7 terms, table (13 levels) to 1e-3", "5 s",
        lambda: f"{Prover(three, 'u', tolerance=1e-3).table(table, 'linear').high:.4f}",
    )  # fmt: skip
    if not quick:
        once("4 x 5 terms, range", "15 s", spread(even(4, 5), 1e-3))
    text = fuzzyarm.shipped("pd7.frb").read_text()
    product = parse(text.replace("implication min", "implication product")).rulebase
    assert product is not None
    once("pd7 by product implication, 1e-3 of the range", "2 s", spread(product, 12e-3))
    sugeno = parse(
        text.replace("terms e, ce, u: triangles", "terms e, ce: triangles")
        .replace("terms e, ce:", "terms u: singletons NB NM NS ZE PS PM PB\nterms e, ce:")
        .replace("and min", "and product")
        .replace("aggregation max", "aggregation sum")
        .replace("centroid exact", "weighted-average")
    ).rulebase
    assert sugeno is not None
    once("pd7 as Sugeno, exact", "exact",
         lambda: f"{Prover(sugeno, 'u', exact=True).value({}).reached_high}")  # fmt: skip


if __name__ == "__main__":
    main()
