"""Whatever the text, a reader gives a model or located findings, and never raises."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from mutation import mutated
from needs import CORPUS, requires

from fuzzyarm.exchange.formats import FOREIGN, parse, write

DATA = Path(__file__).parent / "data"
OWN = {path: path.read_text(encoding="utf-8") for path in sorted(DATA.glob("*.f??"))}


def check(text: str, suffix: str) -> bool:
    imported = parse(text, suffix)
    lines = text.count("\n") + text.count("\r") + 1
    for diagnostic in imported.diagnostics:
        assert 1 <= diagnostic.line <= lines
        assert diagnostic.column >= 1
        assert diagnostic.message
    if imported.rulebase is None:
        assert imported.errors
        return False
    assert not imported.errors
    return True


@pytest.mark.slow
@pytest.mark.parametrize("path", OWN, ids=lambda path: path.name)
def test_damage_to_our_files(path: Path) -> None:
    others = list(OWN.values())
    survived, count = 0, cases(300, 2_500)
    for seed in range(count):
        random_ = random.Random(f"{path.name} {seed}")
        text = mutated(OWN[path], others, random_)
        if check(text, path.suffix):
            survived += 1
            if seed % 20 == 0:
                rulebase = parse(text, path.suffix).rulebase
                assert rulebase is not None
                for suffix in FOREIGN:
                    write(rulebase, suffix, lossy=True)
    assert survived > count // 50  # or the damage would never get behind the first check


@pytest.mark.slow
@requires("corpus")
def test_damage_to_other_peoples_files() -> None:
    texts = {
        path: path.read_text(encoding="utf-8", errors="replace")
        for path in sorted((CORPUS / "files").iterdir())
        if path.suffix in FOREIGN and path.stat().st_size < 4_000
    }
    paths, others = list(texts), list(texts.values())
    for seed in range(cases(300, 3_000)):
        random_ = random.Random(seed)
        path = paths[seed % len(paths)]
        check(mutated(texts[path], others, random_), path.suffix)


@pytest.mark.slow
@settings(max_examples=cases(50, 150), deadline=None)
@given(st.text(max_size=200), st.sampled_from((*FOREIGN, ".fml")))
def test_any_text(text: str, suffix: str) -> None:
    check(text, suffix)


@settings(max_examples=cases(33, 100), deadline=None)
@given(st.binary(max_size=200), st.sampled_from((*FOREIGN, ".fml")))
def test_any_bytes(data: bytes, suffix: str) -> None:
    check(data.decode("latin-1"), suffix)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "text"),
    [
        (".fcl", "(" * 150_000),
        (".fcl", "FUNCTION_BLOCK a FUZZIFY x TERM t := FUNCTION " + "sin(" * 30_000),
        (".fcl", "FUNCTION_BLOCK a RULEBLOCK b RULE 1: IF " + "(" * 100_000),
        (".fis", "[Input1]\n" + "".join(f"MF{i}='a':'trimf',[0 1 2]\n" for i in range(6_000))),
        (".fis", "".join(f"[Input{i}]\nName='x'\n" for i in range(6_000))),
        (".fis", "[Rules]\n" + "1 " * 90_000),
        (".fll", "InputVariable: x\n" + "".join(f" term: t{i} Ramp 0 1\n" for i in range(8_000))),
        (".fll", "RuleBlock:\n rule: if " + "( " * 90_000),
        (".fml", "<a>" * 100_000),
        (".fml", "<fuzzySystem>" + "a<!---->" * 200_000 + "</fuzzySystem>"),
        (".fml", "<fuzzySystem><knowledgeBase>" + "<fuzzyVariable name='x'/>" * 20_000),
    ],
    ids=range(11),
)
def test_absurd_files_are_refused(suffix: str, text: str) -> None:
    assert not check(text, suffix)


@pytest.mark.slow
def test_outputs_that_are_put_in_do_not_grow_without_end() -> None:
    head = (DATA / "chain.fll").read_text().partition("  rule:")[0]
    doubling = "  rule: if power is low and power is low then power is low\n"
    text = f"{head}  rule: if light is dark then power is low\n{doubling * 500}"
    imported = parse(text, ".fll")
    assert {"too-many", "too-large"} & {d.name for d in imported.errors}
