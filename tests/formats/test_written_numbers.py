"""What is written without a warning gives the same numbers when its own reader takes it up."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from budget import cases, crossed, part
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from needs import CORPUS, requires
from strategies import odd_text, rulebases

from fuzzyarm.base.diagnostic import Diagnostic, Severity
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.exchange.formats import FOREIGN, PRODUCERS, parse, read, write
from fuzzyarm.inference import InferenceError
from fuzzyarm.language.model.rulebase import Expression, Hedged, Is, Rule, RuleBase, Shape, Variable
from fuzzyarm.symbolic.formulas import read_formula, write_formula
from tests.interpreted import interpreted

DATA = Path(__file__).parent / "data"
POINTS = 50
TARGETS = [(suffix, each) for suffix in FOREIGN for each in PRODUCERS[suffix]] + [(".frb", None)]
SOURCES = [
    *sorted(DATA.glob("*.f??")),
    *(shipped(name) for name in shipped_names() if name.endswith(".frb")),
]
OTHERS = sorted(p for p in (CORPUS / "files").glob("*") if p.suffix in FOREIGN)


Point = list[float]


def values(rulebase: RuleBase, points: list[Point]) -> list[list[float] | str]:
    """Outputs at every point, or the error there."""
    prepared = interpreted(rulebase)
    held = {output.name: 0.25 for output in rulebase.outputs}
    inputs = [variable.name for variable in rulebase.inputs]
    found: list[list[float] | str] = []
    for point in points:
        try:
            outputs = prepared.evaluate(dict(zip(inputs, point, strict=True)), held)
        except InferenceError as error:
            found.append(type(error).__name__)
        else:
            found.append([outputs[output.name] for output in rulebase.outputs])
    return found


def points_of(rulebase: RuleBase, seed: str) -> list[Point]:
    """Points in the range and a little beyond it; of an infinite range some around 0."""
    draw = random.Random(seed)

    def one(low: float, high: float) -> float:
        low, high = max(low, -10.0), min(high, 10.0) if math.isinf(high) else high
        reach = 0.1 * (high - low)
        return draw.choice([draw.uniform(low, high), draw.uniform(low - reach, high + reach)])

    return [[one(v.low, v.high) for v in rulebase.inputs] for _ in range(POINTS)]


def differences(path: Path, other: RuleBase) -> Iterator[str]:
    """Say where a rule base differs from that of a file by more than 1e-6 of a range."""
    one, points, before = numbers_of(path)
    if other == one:
        return
    for point, found, again in zip(points, before, values(other, points), strict=True):
        if isinstance(found, str) or isinstance(again, str):
            if found != again:
                yield f"{point}: {found} is now {again}"
            continue
        for output, a, b in zip(one.outputs, found, again, strict=True):
            width = output.high - output.low
            scale = width if math.isfinite(width) else max(abs(a), 1.0)
            same = a == b or (math.isnan(a) and math.isnan(b))
            if not same and not abs(a - b) <= 1e-6 * scale:
                yield f"{point}: {output.name} was {a} and is {b}"


@cache
def numbers_of(path: Path) -> tuple[RuleBase, list[Point], list[list[float] | str]]:
    rulebase = source(path)
    assert rulebase is not None
    points = points_of(rulebase, path.name)
    return rulebase, points, values(rulebase, points)


@cache
def source(path: Path) -> RuleBase | None:
    return read(path).rulebase


def check_written(path: Path, suffix: str, program: str | None) -> None:
    rulebase = source(path)
    if rulebase is None:
        return
    for lossy in (False, True):
        exported = write(rulebase, suffix, producer=program, lossy=lossy)
        if exported.text is None:
            continue
        imported = parse(exported.text, suffix, producer=program, lossy=lossy)
        assert imported.rulebase is not None, [str(d) for d in imported.errors]
        said = {d.name for d in (*exported.diagnostics, *imported.diagnostics) if is_warning(d)}
        if not said - {"renamed"}:
            found = list(differences(path, imported.rulebase))
            assert not found, found[:3]


def named(side: Path | tuple[str, str | None]) -> str:
    return side.name if isinstance(side, Path) else " ".join(map(str, side))


def is_warning(finding: Diagnostic) -> bool:
    return finding.severity is Severity.WARNING


@pytest.mark.parametrize(("path", "target"), crossed(SOURCES, TARGETS), ids=named)
def test_what_is_written_without_a_warning_keeps_its_numbers(
    path: Path, target: tuple[str, str | None]
) -> None:
    check_written(path, *target)


@pytest.mark.slow
@requires("corpus")
@pytest.mark.parametrize(("suffix", "program"), TARGETS)
def test_so_do_other_peoples_files(suffix: str, program: str | None) -> None:
    for path in part(OTHERS, 2):
        check_written(path, suffix, program)


# ── Whatever a rule base is, and whatever its names are ──────────────────────────────

ODD_NAMES = (
    "mf 1", "größe", "a-b", "x y (z)", "1st", "½", "IF", "if", "is", "Then", "with", "NOT", "very",
    "any", "RULE", "TERM", "END_RULEBLOCK", "FUZZIFY", "END_VAR", "AND : MIN", "RANGE", "Triangle",
    "COG", "sin", "pi", "nan", "%", "# no", "// no", "(* no", "/*", "a;b", "a:b", "'", '"', "\\",
    "x'y", "[Rules]", "=", "Name='x'", "a  b", "\u00a0x", "-", "_", ".", "..", "0", "1e5", "REAL",
    "x", "𝒳",
)  # fmt: skip
odd_names = st.one_of(st.sampled_from(ODD_NAMES), odd_text)


@st.composite
def oddly_named(draw: st.DrawFn) -> RuleBase:
    """Any rule base, with odd names of everything, sometimes without rules or outputs."""
    rulebase = draw(rulebases(odd_names=True, decorated=True))
    taken = [v.name for v in (*rulebase.inputs, *rulebase.outputs)]
    # A formula has no way to say a quote in a name.
    unquoted = odd_names.filter(lambda name: "'" not in name)
    found = draw(st.lists(unquoted, min_size=len(taken), max_size=len(taken), unique=True))
    names = dict(zip(taken, found, strict=True))
    terms = {
        (v.name, t.name): name
        for v in (*rulebase.inputs, *rulebase.outputs)
        for t, name in zip(
            v.terms,
            draw(
                st.lists(odd_names, min_size=len(v.terms), max_size=len(v.terms), unique=True)
            ),
            strict=True,
        )
    }  # fmt: skip
    renamed = with_names(rulebase, names, terms)
    blocks = tuple(replace(block, name=draw(odd_names)) for block in renamed.blocks)
    return replace(
        renamed,
        name=draw(odd_names),
        blocks=draw(st.sampled_from([blocks, blocks, blocks, ()])),
        outputs=renamed.outputs if blocks else draw(st.sampled_from([renamed.outputs, ()])),
    )


def with_names(
    rulebase: RuleBase, names: dict[str, str], terms: dict[tuple[str, str], str]
) -> RuleBase:
    """Give variables and terms other names, in formulas too."""

    def shape(old: Shape) -> Shape:
        if not old.formula:
            return old
        formula = write_formula(read_formula(old.formula).root, rename=names)
        return replace(old, formula=formula)

    def variable(old: Variable) -> Variable:
        own = tuple(
            replace(t, name=terms[old.name, t.name], shape=shape(t.shape)) for t in old.terms
        )
        return replace(old, name=names[old.name], terms=own)

    def expression(old: Expression) -> Expression:
        if isinstance(old, Is):
            return replace(old, variable=names[old.variable], term=terms[old.variable, old.term])
        if isinstance(old, Hedged):
            return replace(old, operand=expression(old.operand))
        return replace(old, operands=tuple(map(expression, old.operands)))

    def rule(old: Rule) -> Rule:
        consequents = tuple(
            replace(c, variable=names[c.variable], term=terms[c.variable, c.term])
            for c in old.consequents
        )
        return replace(old, antecedent=expression(old.antecedent), consequents=consequents)

    return replace(
        rulebase,
        inputs=tuple(map(variable, rulebase.inputs)),
        outputs=tuple(map(variable, rulebase.outputs)),
        blocks=tuple(replace(b, rules=tuple(map(rule, b.rules))) for b in rulebase.blocks),
        lookup=None,
        expectations=(),
    )


@pytest.mark.slow
@settings(max_examples=cases(10, 40), deadline=None, suppress_health_check=list(HealthCheck))
@given(oddly_named())
def test_whatever_is_written_is_read_back(rulebase: RuleBase) -> None:
    for suffix, program in TARGETS:
        for lossy in (False, True):
            exported = write(rulebase, suffix, producer=program, lossy=lossy)
            if exported.text is None:
                continue
            imported = parse(exported.text, suffix, producer=program, lossy=lossy)
            again = imported.rulebase
            if {d.name for d in imported.errors} == {"no-rules"}:
                assert lossy or not rulebase.rules  # the only rule was lost, or there was none
                continue
            assert again is not None, (suffix, program, [str(d) for d in imported.errors])
            assert [len(v.terms) for v in (*again.inputs, *again.outputs)] == [
                len(v.terms) for v in (*rulebase.inputs, *rulebase.outputs)
            ]
            said = {d.name for d in exported.diagnostics}
            assert again.name == rulebase.name or "changed-text" in said
