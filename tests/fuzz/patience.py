"""Draw small valid rule bases of every kind, and time what commands take for them.

    python tests/fuzz/patience.py --seed 1 --count 300

One to four inputs with two to nine terms; all shapes, norms, hedges and defuzzifiers; Sugeno,
Tsukamoto, interval type 2, blocks in a chain, thresholds, weights, nested conditions. A command
that takes longer than ``--limit`` seconds, or says nothing for longer than `SILENCE`, is a finding.
"""

from __future__ import annotations

import argparse
import random
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

from workers import HUNG, Outcome, Worker  # noqa: E402

from fuzzyarm.language.model.rulebase import SAMPLINGS  # noqa: E402
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SNORMS, TNORMS  # noqa: E402

Range = tuple[float, float]

STRAIGHT = ("triangle", "trapezoid", "rectangle", "ramp", "points", "binary")
CURVED = (
    "gaussian", "two-sided-gaussian", "bell", "sigmoid", "sigmoid-difference", "sigmoid-product",
    "z", "s", "pi", "concave", "cosine", "spike", "arc", "semi-ellipse",
)  # fmt: skip
MONOTONIC = ("ramp", "sigmoid", "s", "z", "concave", "arc")
INTEGRALS = ("centroid", "bisector")
MAXIMA = tuple(name for name, record in DEFUZZIFIERS.items() if record.of == "top")
WEIGHTED = ("weighted-average", "weighted-sum")
KARNIK_MENDEL = ("karnik-mendel", "karnik-mendel-left", "karnik-mendel-right", "nie-tan")
WORDS = ("NB", "NM", "NS", "ZE", "PS", "PM", "PB", "LOW", "HIGH")
HEDGE_WORDS = tuple(HEDGES.words)


def number(value: float) -> str:
    """Return a number as a person would write it."""
    return f"{value:.4g}"


def shape(r: random.Random, kind: str, span: Range) -> str:
    """Return a shape of a kind around a range."""
    low, high = span
    width = high - low

    def at() -> float:
        share = r.random()
        return low + width * r.choice((share, round(8 * share) / 8))

    def places(count: int) -> list[float]:
        found = sorted(at() for _ in range(count))
        if found[-1] - found[0] < 1e-3 * width:
            found[0], found[-1] = found[0] - 0.1 * width, found[-1] + 0.1 * width
        return found

    spread = width * r.choice((0.02, 0.1, 0.2, 0.4))
    centre, way = at(), r.choice((-1.0, 1.0))
    steep, other = 5.0 / spread, centre + 2.0 * spread
    counts = {"triangle": 3, "rectangle": 2, "s": 2, "z": 2, "trapezoid": 4, "pi": 4}
    if kind in counts:
        numbers = places(counts[kind])
    elif kind == "points":
        xs = sorted(set(places(r.randint(2, 6))))
        ys = [r.choice((0.0, 0.25, 0.7, 1.0, r.random())) for _ in xs]
        ys[r.randrange(len(ys))] = 1.0
        pairs = zip(map(number, xs), map(number, ys), strict=True)
        return "points " + " ".join(f"({x}, {y})" for x, y in pairs)
    elif kind == "binary":
        return f"binary {number(centre)} {r.choice(('inf', '-inf'))}"
    elif kind in ("ramp", "arc", "concave", "semi-ellipse"):
        numbers = [centre, centre + way * spread]
    else:
        numbers = {
            "gaussian": [centre, spread],
            "cosine": [centre, spread],
            "spike": [centre, spread],
            "two-sided-gaussian": [centre, spread, centre + r.random() * spread, 0.5 * spread],
            "bell": [centre, spread, r.choice((1.0, 2.0, 0.5, 3.5))],
            "sigmoid": [centre, way * steep],
            "sigmoid-difference": [centre, steep, other, 0.8 * steep],
            "sigmoid-product": [centre, steep, other, -steep],
        }[kind]
    height = " height 0.8" if r.random() < 0.1 else ""
    return f"{kind} {' '.join(map(number, numbers))}{height}"


class Drawing:
    """One rule base while it is drawn."""

    def __init__(self, r: random.Random) -> None:
        self.r = r
        self.lines = ["rulebase drawn"]
        self.terms: dict[str, tuple[str, ...]] = {}
        curved = r.random()
        self.kinds = CURVED if curved < 0.3 else STRAIGHT if curved < 0.5 else STRAIGHT + CURVED

    def variable(self, name: str, what: str, kinds: tuple[str, ...] = ()) -> Range:
        """Declare a variable; with terms of `kinds`, or those of the rule base."""
        r = self.r
        low = r.choice((-6.0, -1.0, 0.0, 10.0, -0.5))
        span = low, low + r.choice((1.0, 2.0, 12.0, 80.0))
        self.lines.append(f"{what} {name} {number(span[0])} .. {number(span[1])}")
        names = WORDS[: r.choice((2, 3, 3, 5, 5, 7, 9))]
        self.terms[name] = names
        family = r.choice(("triangles", "gaussians"))
        if not kinds and r.random() < 0.35:
            self.lines.append(f"terms {name}: {family} {' '.join(names)}")
            return span
        usual = kinds or self.kinds
        for word in names:
            self.lines.append(f"term {name} {word}: {shape(r, r.choice(usual), span)}")
        return span

    def two_sided(self, name: str, what: str) -> None:
        """Declare a variable with terms of interval type 2."""
        r = self.r
        self.lines.append(f"{what} {name} -6 .. 6")
        names = self.terms[name] = WORDS[: r.choice((2, 3, 5, 7))]
        for i, word in enumerate(names):
            peak, step = -6 + 12 * i / (len(names) - 1), 12 / (len(names) - 1)
            kind = r.choice(("triangle", "gaussian"))
            sides = [
                f"triangle {peak - share * step:g} {peak:g} {peak + share * step:g}"
                if kind == "triangle"
                else f"gaussian {peak:g} {0.5 * share * step:g}"
                for share in (1.0, 0.7)
            ]
            self.lines.append(f"term {name} {word}: {sides[0]} over {sides[1]} height 0.9")

    def condition(self, names: list[str], depth: int = 2) -> str:
        """Return an antecedent."""
        r = self.r
        chance = r.random()
        if depth and chance < 0.5:
            word = r.choice((" and ", " and ", " or "))
            parts = [self.condition(names, depth - 1) for _ in range(r.choice((2, 2, 3)))]
            whole = "(" + word.join(parts) + ")"
            hedge = r.choice(("", "", "", "not ", "very ", "somewhat "))
            return hedge + whole
        name = r.choice(names)
        return f"{name} is {self.hedge()}{r.choice(self.terms[name])}"

    def hedge(self) -> str:
        r = self.r
        if r.random() < 0.75:
            return ""
        word = r.choice(HEDGE_WORDS)
        return f"power({r.choice((0.5, 1.3, 2))}) " if word == "power" else f"{word} "

    def rules(self, inputs: list[str], output: str, *, plain: bool) -> None:
        """Add a grid, or rules."""
        r = self.r
        terms = self.terms[output]
        if len(inputs) == 2 and r.random() < 0.6:
            down, across = inputs
            self.lines.append(f"rules {output}")
            self.lines.append(f"  {down} \\ {across} " + " ".join(self.terms[across]))
            for label in self.terms[down]:
                cells = " ".join(
                    r.choice(("", "", "", "", "*0.5")).join((r.choice(terms), ""))
                    if r.random() < 0.95
                    else "."
                    for _ in self.terms[across]
                )
                self.lines.append(f"  {label} {cells}")
            return
        for _ in range(r.choice((2, 4, 9, 9, 20))):
            condition = self.condition(inputs)
            hedge = "" if plain else r.choice(("", "", "", "", "not ", "very "))
            weight = r.choice(("", "", "", " with 0.5"))
            term = r.choice(terms)
            self.lines.append(f"rule if {condition} then {output} is {hedge}{term}{weight}")

    def promises(self, inputs: list[str]) -> None:
        """Add lines that a check judges, now and then."""
        r = self.r
        if r.random() < 0.3:
            at = ", ".join(f"{name} = {number(r.uniform(-1, 2))}" for name in inputs)
            self.lines.append(f"expect {at} -> u in -100 .. 100")
        while r.random() < 0.3:
            first, bound = inputs[0], number(r.uniform(0, 90))
            claims = (
                f"u in -{bound} .. {bound}", f"u rises with {first}", "u covered",
                f"u slope {first} in -{bound} .. {bound}", "u odd", f"u <= {bound}",
                f"table of u linear within {bound}", f"table of u nearest within {bound}",
            )  # fmt: skip
            self.lines.append(f"prove {r.choice(claims)}")

    def norms(self) -> str:
        """Return settings of a block."""
        r = self.r
        conjunctions, disjunctions = tuple(TNORMS), tuple(x for x in SNORMS if x in OR_WORDS)
        words = [f"and {r.choice(conjunctions)}", f"or {r.choice(disjunctions)}"]
        words.append(f"implication {r.choice(('min', 'product', r.choice(conjunctions)))}")
        if r.random() < 0.15:
            words.append(f"threshold {r.choice((0.05, 0.3))}")
        return ", ".join(words)

    def output(self, name: str, inputs: list[str], method: str) -> bool:
        """Declare an output for a method; return whether its terms take no hedges."""
        r = self.r
        settings = [f"defuzzifier {method}"]
        plain = True
        if method.partition("(")[0].split()[0] in WEIGHTED:
            span = self.variable(name, "output", ("gaussian",))
            del self.lines[-len(self.terms[name]) :]
            for word in self.terms[name]:
                value = number(r.uniform(*span))
                linear = "linear " + " + ".join(f"{r.uniform(-2, 2):.3g}*{x}" for x in inputs)
                curved = f'formula "{value} + sin({r.choice(inputs)}) * abs({r.choice(inputs)})"'
                what = r.choice((f"singleton {value}", linear.replace("+ -", "- "), curved))
                self.lines.append(f"term {name} {word}: {what}")
        elif method == "tsukamoto":
            self.variable(name, "output", MONOTONIC)
        elif method.partition("(")[0] in KARNIK_MENDEL:
            self.two_sided(name, "output")
        else:
            self.variable(name, "output")
            plain = False
        settings.append(f"no-rule {r.choice(('0', 'nan', 'hold', 'error'))}")
        if r.random() < 0.4 and method.partition("(")[0] not in KARNIK_MENDEL:
            settings.append(f"aggregation {r.choice(tuple(SNORMS))}")
        self.lines.append(f"inference {name}: {', '.join(settings)}")
        return plain


OR_WORDS = ("max", "probor", "bounded", "drastic", "hamacher", "einstein", "nilpotent")


def method_of(r: random.Random, *, two_sided: bool) -> str:
    """Return a defuzzifier, sampled or exact."""
    if two_sided:
        method = r.choice(KARNIK_MENDEL)
    else:
        method = r.choice((*INTEGRALS, *INTEGRALS, *MAXIMA, *WEIGHTED, "tsukamoto"))
    if method in (*WEIGHTED, "tsukamoto") or r.random() < 0.7:
        return method
    samplings = [x for x in SAMPLINGS if x != "joined" or method in INTEGRALS]
    return f"{method}({r.choice((11, 101, 1000))}, {r.choice(samplings)})"


def drawn(r: random.Random) -> str:
    """Return the text of a rule base."""
    drawing = Drawing(r)
    two_sided = r.random() < 0.12
    inputs = ["e", "ce", "load", "w"][: r.choice((1, 2, 2, 2, 3, 4))]
    for name in inputs:
        if two_sided:
            drawing.two_sided(name, "input")
        else:
            drawing.variable(name, "input")
    drawing.lines.append(f"inference {drawing.norms()}")
    method = method_of(r, two_sided=two_sided)
    plain = drawing.output("u", inputs, method)
    drawing.rules(inputs, "u", plain=plain or two_sided)
    if r.random() < 0.2 and not two_sided and method.partition("(")[0] in (*INTEGRALS, *MAXIMA):
        more = drawing.output("v", inputs, method_of(r, two_sided=False))
        drawing.lines.append(f"block second: {drawing.norms()}")
        drawing.rules(["u", *inputs[:1]], "v", plain=more)
    drawing.promises(inputs)
    return "\n".join(drawing.lines) + "\n"


def commands(r: random.Random, text: str) -> Iterator[list[str]]:
    """Yield what is asked of the file ``x.frb``."""
    inputs = [line.split()[1] for line in text.splitlines() if line.startswith("input ")]
    output = ["--output", "u"]
    point = [f"{name}={number(r.uniform(-1, 2))}" for name in inputs]
    yield ["check", "x.frb"]
    yield (
        ["eval", "x.frb", *point, "--held", "u=0", "--held", "v=0"]
        if ("output v" in text)
        else ["eval", "x.frb", *point, "--held", "u=0"]
    )
    yield ["eval", "x.frb", *point, "--held", "u=0", "--explain"]
    yield ["show", "x.frb"]
    yield ["plot", "x.frb", "-o", "x.svg"]
    yield ["compile", "x.frb", "-o", "x.h", "--direct", *output]
    yield ["compile", "x.frb", "-o", "x.h", *output]
    yield ["compile", "x.frb", "-o", "x.lut", *output]
    many = str(round(10_000 ** (1 / len(inputs))))
    yield ["compile", "x.frb", "-o", "x.csv", "--levels", many, *output]
    yield ["compile", "x.frb", "-o", "x.mjs"]
    yield ["compile", "x.frb", "-o", "y.lut", "--tolerance", "0.01", *output]
    yield ["convert", "x.frb", "x.fis", "--lossy"]
    yield ["convert", "x.frb", "x.fcl", "--lossy"]
    yield ["convert", "x.frb", "x.fll", "--lossy"]


def main() -> int:
    """Be a script."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--limit", type=float, default=20.0)
    parser.add_argument("--slow", type=float, default=2.0, help="seconds from which on it is told")
    parser.add_argument("--keep", type=Path, help="folder for the files of slow commands")
    chosen = parser.parse_args()
    slow = 0
    home = Path(tempfile.mkdtemp())
    with Worker(chosen.limit) as worker:
        for case in range(chosen.first, chosen.first + chosen.count):
            r = random.Random(f"{chosen.seed} {case}")
            text = drawn(r)
            (home / "x.frb").write_text(text)
            for words in commands(r, text):
                outcome = worker.run(words, home)
                fault = outcome.trace or outcome.status not in (0, 1)
                if outcome.seconds > chosen.slow or fault:
                    slow += 1
                    tell(case, outcome)
                    if chosen.keep:
                        chosen.keep.mkdir(exist_ok=True)
                        (chosen.keep / f"{case}.frb").write_text(text)
    shutil.rmtree(home)
    print(f"{chosen.count} rule bases, {slow} findings")
    return int(bool(slow))


def tell(case: int, outcome: Outcome) -> None:
    """Print a finding."""
    print(f"{case}: {outcome.seconds:.1f} s, {outcome.status}: {' '.join(outcome.words)}")
    lines = outcome.trace.splitlines()
    if lines:  # the innermost call stands first where it hung, and last where it was raised
        print("\n".join(lines[:12] if outcome.status == HUNG else lines[-8:]))
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
