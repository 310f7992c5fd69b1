"""Damage rule bases of every format; whatever the text, it is read or refused with a place.

    python tests/fuzz/damaged_texts.py --seed 1 --count 20000

What is still a rule base is evaluated, explained, written in every format and read again.
"""

from __future__ import annotations

import math
import random
import sys
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

from fuzzing import Told, demand_whole_files, folder, run  # noqa: E402

from fuzzyarm import infer  # noqa: E402
from fuzzyarm.base.diagnostic import RuleBaseError  # noqa: E402
from fuzzyarm.base.errors import FuzzyarmError  # noqa: E402
from fuzzyarm.exchange.files import check_text  # noqa: E402
from fuzzyarm.exchange.formats import PRODUCERS, SUFFIXES, parse, same_model, write  # noqa: E402
from fuzzyarm.inference import explain  # noqa: E402
from fuzzyarm.language import edit, format_text  # noqa: E402
from fuzzyarm.language.model.rulebase import RuleBase  # noqa: E402
from tests.formats.mutation import mutated  # noqa: E402

OWN_LINES = """rulebase everything
input a 0 .. 4
input b -1 .. 1
output u -5 .. 5
output k 0 .. 1
terms a, u: gaussians L M H
terms b: triangles N Z P
term b E: two-sided-gaussian -0.5 0.2 0.5 0.3
term b S: sigmoid-product -0.5 8 0.5 -8
term a P: points (0, 0) (1, 0.4) (1, 0.9) (4, 1)
terms k: singletons L H
term k F: formula "a / 4 + sin(b) ^ 2"
term k G: linear 0.1*a + 0.2*b + 0.3
term a T: trapezoid -inf -inf 1 2 height 0.8
inference and product, or probor, implication min, aggregation bounded, defuzzifier centroid(51)
inference k: defuzzifier weighted-average, no-rule hold
inference a: outside extend
rules u when b is Z
  a   L  M  H
  u   L  .  H
rule if a is very L or b is not power(1.3) N then u is H with 0.5
rule if not (a is P and b is E) and a is T then u is somewhat M
block second
rule if b is N then k is F
rule if b is S or u is L then k is G
lookup
  levels a: 0 .. 4 step 1
  levels b: -1 0 0.5 1
  bins   b: 0.25 0.75 0.9
  round  0.1
expect a = 1, b = 0 -> u > -5, k in 0 .. 1
"""


@cache
def originals() -> dict[str, list[str]]:
    """Return texts by suffix."""
    found: dict[str, list[str]] = {suffix: [] for suffix in SUFFIXES}
    found[".frb"].append(OWN_LINES)
    for home in (ROOT / "rulebases", ROOT / "tests" / "formats" / "data"):
        for path in sorted(home.iterdir()):
            if path.suffix in found:
                found[path.suffix].append(path.read_text(encoding="utf-8"))
    return found


def demand_places(diagnostics, text: str) -> None:
    """Every finding has a message and a place that the text has."""
    lines = text.count("\n") + text.count("\r") + 1
    for each in diagnostics:
        assert each.message
        assert 1 <= each.line <= lines + 1, each
        assert each.column >= 1, each


def values_at(rulebase: RuleBase, fraction: float) -> dict[str, float]:
    """Return a point by how far into the ranges it lies."""
    found = {}
    for each in rulebase.inputs:
        low = max(each.low, -1e6)
        found[each.name] = low + fraction * (min(each.high, 1e6) - low)
    return found


def outcome(rulebase: RuleBase, at: dict[str, float]) -> object:
    """Return what comes out at a point, or which error."""
    held = {output.name: 0.5 for output in rulebase.outputs}
    try:
        return infer(rulebase, at, held=held)
    except FuzzyarmError as error:
        return type(error).__name__


def same(one: object, other: object) -> bool:
    """Whether two outcomes are one, to nine digits."""
    if not (isinstance(one, dict) and isinstance(other, dict)):
        return one == other
    return list(one) == list(other) and all(
        math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-9)
        or a == b
        or (math.isnan(a) and math.isnan(b))
        for a, b in zip(one.values(), other.values(), strict=True)
    )


def use(rulebase: RuleBase, r: random.Random, told: Told) -> None:
    """Evaluate a rule base, explain it, write it and read it again."""
    at = values_at(rulebase, r.random())
    found = outcome(rulebase, at)
    try:
        explain(rulebase, at, held={output.name: 0.5 for output in rulebase.outputs})
    except FuzzyarmError:
        assert isinstance(found, str)
    own = write(rulebase, ".frb")
    assert (own.text is None) == bool(own.errors)
    if own.text is not None:
        again = parse(own.text, ".frb").rulebase
        assert again is not None
        if not own.diagnostics:
            assert same_model(again, rulebase)
            assert same(found, outcome(again, at)), (at, found)
    suffix = r.choice([each for each in SUFFIXES if each != ".frb"])
    producer, lossy = r.choice([None, *PRODUCERS[suffix]]), r.random() < 0.5
    exported = write(rulebase, suffix, producer=producer, lossy=lossy)
    assert (exported.text is None) == bool(exported.errors)
    if exported.text is None:
        return
    told.append(f"--- written as {suffix} for {producer}, lossy {lossy}\n{exported.text}")
    imported = parse(exported.text, suffix, producer=producer, lossy=lossy)
    lost = any(d.severity == "warning" for d in (*exported.diagnostics, *imported.diagnostics))
    if imported.rulebase is None:
        assert lost or exported.diagnostics, [str(each) for each in imported.errors]
    elif not lost and list(rulebase.inputs) and not exported.diagnostics:
        assert same(found, outcome(imported.rulebase, at)), (at, found)


def ask(text: str, r: random.Random) -> None:
    """Ask what editors ask, anywhere in the text."""
    reading = edit.read(text)
    lines = text.split("\n")
    line = r.randrange(len(lines))
    column = r.randint(0, len(lines[line])) + 1
    edit.complete(reading, line + 1, column)
    edit.hover(reading, line + 1, column)
    edit.symbols(reading)
    edit.folds(reading)
    edit.coloured(reading)
    try:
        formatted = format_text(text)
    except RuleBaseError:
        return
    assert format_text(formatted) == formatted


def case(r: random.Random, told: Told) -> None:
    """Damage one text and go through everything that reads it."""
    suffix = r.choice([".frb", ".frb", *PRODUCERS])
    texts = originals()
    others = texts[r.choice(list(texts))]
    text = mutated(r.choice(texts[suffix]), others, r)
    producer = r.choice([None, *PRODUCERS.get(suffix, ())])
    lossy = r.random() < 0.5
    told.append(f"--- read as {suffix} of {producer}, lossy {lossy}\n{text!r}")
    if suffix == ".frb":
        review = check_text(text)
        demand_places(review.diagnostics, text)
        rulebase = review.rulebase
        if r.random() < 0.1:
            ask(text, r)
    else:
        imported = parse(text, suffix, producer=producer, lossy=lossy)
        demand_places(imported.diagnostics, text)
        assert (imported.rulebase is None) == bool(imported.errors)
        rulebase = imported.rulebase
    if rulebase is not None and r.random() < 0.25:
        use(rulebase, r, told)
    if r.random() < 0.02:
        by_command(text, suffix, r)


def by_command(text: str, suffix: str, r: random.Random) -> None:
    """Convert or compile a damaged file by the command, now and then on a full disk."""
    with folder() as home:
        source = home / f"damaged{suffix}"
        source.write_text(text, encoding="utf-8", errors="replace")
        out = r.choice([*SUFFIXES, ".lut", ".npz", ".h", ".st"])
        target = home / f"out{out}"
        if out in SUFFIXES:
            words = ["convert", str(source), str(target), *r.choice([[], ["--lossy"]])]
        else:
            words = ["compile", str(source), "-o", str(target), "--levels", "3", "--round", "0"]
        demand_whole_files(words, target, full=r.random() < 0.3)


if __name__ == "__main__":
    sys.exit(run(__doc__, case))
