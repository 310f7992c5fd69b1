"""A mistake hides no other one: neither the next in its line nor those in the lines that follow."""

import pytest

from fuzzyarm.language import parse

RULEBASE = """rulebase r
input e -1 .. 1
input ce -1 .. 1
output u -1 .. 1
terms e, ce, u: triangles N Z P
rule if e is N then u is N
{}
"""
CONTROLLER = """controller c
use pd7 from "pd7.frb"
period 1 ms
gain K = 2
axis shaft
  e = error of position
  ce = rate of e
  u = rules pd7(e, ce)
{}
  drive voltage = u * K
"""

# Each word or number in quotes is a mistake of its own.
LINES = [
    (RULEBASE, "rule if e «iss» N and ce is «Q» then «uu» is N with «x»"),
    (RULEBASE, "rule if e is «QQ» and ce is N then u is «RR» with «3»"),
    (RULEBASE, "term e X: «trangle» 0 1 2 height «x» over «triangl» 0 1 2 «foo»"),
    (RULEBASE, "term «w» X: triangle 0 1 2 height «y»"),
    (RULEBASE, "inference «andd» min, or «maxx», defuzzifier «centroidd», «foo» bar"),
    (RULEBASE, "expect «f» = «x», e = «y» -> «v» = 3 within «z»"),
    (RULEBASE, "prove «f» in «x» .. 1 -> u in -1 .. «y»"),
    (RULEBASE, "lookup\n  levels «f»: -1 0 1 «x»\n  bins «g»: 0 «y»"),
    (RULEBASE, "tune\n  peaks «f» «mirored», gap «x» %\n  keep «g» N"),
    (CONTROLLER, "  x = integral of «f» * «L», within «a» .. 4, «anti-windupp» hold"),
    (CONTROLLER, "  x = lag of «f» * «L», time 5 «ks»"),
    (CONTROLLER, "  x = rules «pd8»(e, «f»)"),
    (CONTROLLER, "  drive voltage = e * «f» - «g», within 0 .. «a», «slwe» 3, on nan «b»"),
    (CONTROLLER, "  zoom e, «f» by «L» «insid» 3, edge «wat»"),
    (
        CONTROLLER,
        "prove stable on motor at position = «a» with J in «b» .. 1 from position in 0 .. «x»",
    ),
]


def marked(text: str) -> tuple[str, list[tuple[int, int]]]:
    """Return a text without its quotes, and the position of each."""
    spots, lines = [], []
    for number, line in enumerate(text.split("\n"), start=1):
        first, *others = line.split("«")
        for other in others:
            spots.append((number, len(first) + 1))
            first += other.replace("»", "")
        lines.append(first)
    return "\n".join(lines), spots


@pytest.mark.parametrize(("whole", "line"), LINES, ids=[line for _, line in LINES])
def test_every_mistake_of_a_line_is_reported(whole: str, line: str) -> None:
    text, spots = marked(whole.format(line))
    found = [(d.line, d.column) for d in parse(text).diagnostics if d.is_error]
    assert found == spots


@pytest.mark.parametrize(("whole", "line"), LINES, ids=[line for _, line in LINES])
def test_a_line_without_its_first_mistake_keeps_the_others(whole: str, line: str) -> None:
    text, spots = marked(whole.format(line.replace("«", "", 1).replace("»", "", 1)))
    found = [(d.line, d.column) for d in parse(text).diagnostics if d.is_error]
    assert set(spots) <= set(found)


@pytest.mark.parametrize(
    "line",
    [
        'input f "error" -1 .. 1',
        "input f «x» .. 1",
        "term e LOW 0 1 2",
        "rule if e is N the u is P",
        "lookup\n  levels e: x",
    ],
)
def test_one_mistake_is_one_finding(line: str) -> None:
    text, _ = marked(RULEBASE.format(line))
    assert len([d for d in parse(text).diagnostics if d.is_error]) == 1
