"""Kinds that a user registers are words of the language: read, written, offered, explained."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from types import ModuleType

import pytest

from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text, parse, write
from fuzzyarm.language.edit import coloured, complete, hover, read
from fuzzyarm.language.model.rulebase import Hedge
from fuzzyarm.symbolic import kinds, op, records

TEXT = """\
rulebase own "kinds of one's own"
input  e  -2 .. 2
input  c  -2 .. 2
output u  -1 .. 1
terms  e, c: triangles N Z P
term   e   A: cosine-bell 0 2 height 0.9
terms  u: singletons LOW MID HIGH
inference and yager2, or yagers, aggregation yagers
inference u: defuzzifier weighted-average
rule if e is slightly A and c is Z then u is LOW
rule if e is softened(1.3) N or slightly (c is P) then u is MID
rule if e is not N or c is N then u is HIGH
"""


def register() -> None:
    kinds.tnorm("yager2", lambda a, b: 1 - op.minimum(1, op.sqrt((1 - a) ** 2 + (1 - b) ** 2)))
    kinds.snorm("yagers", lambda a, b: op.minimum(1, op.sqrt(a * a + b * b)), doc="Yager, w = 2")
    kinds.shape(
        "cosine-bell",
        ("centre", "width"),
        lambda x, centre, width: op.where(
            abs(x - centre) < width, 0.5 * (1 + op.cos(op.pi * (x - centre) / width)), 0
        ),
        doc="one period of a cosine",
        positive=("width",),
    )
    kinds.hedge("slightly", lambda d: op.minimum(d, 1 - d), doc="min(d, 1 − d)")
    kinds.hedge("softened", lambda d, p: d * p / (1 + p), parameters=("share",))


def withdraw() -> None:
    kinds.TNORMS.remove("yager2")
    kinds.SNORMS.remove("yagers")
    kinds.SHAPES.remove("cosine-bell")
    kinds.HEDGES.remove("slightly")
    kinds.HEDGES.remove("softened")


@pytest.fixture
def own_kinds() -> Iterator[None]:
    register()
    yield
    withdraw()


@pytest.mark.usefixtures("own_kinds")
def test_a_file_with_own_kinds_is_read_and_written() -> None:
    parsed = parse(TEXT)
    assert parsed.diagnostics == ()
    assert parsed.rulebase is not None
    block = parsed.rulebase.blocks[0]
    assert (block.conjunction, block.disjunction) == ("yager2", "yagers")
    assert parsed.rulebase.inputs[0].terms[-1].shape.kind == "cosine-bell"
    assert [p.hedges for p in block.rules[0].antecedent.operands] == [  # type: ignore[union-attr]
        (Hedge("slightly"),), (),
    ]  # fmt: skip
    formatted = format_text(TEXT)
    assert format_text(formatted) == formatted
    assert parse(formatted).rulebase == parsed.rulebase
    assert parse(write(parsed.rulebase)).rulebase == parsed.rulebase
    assert "e is softened(1.3) N or slightly (c is P)" in formatted


@pytest.mark.usefixtures("own_kinds")
def test_a_file_with_own_kinds_is_checked() -> None:
    names = {d.name for d in check_text(TEXT).diagnostics}
    assert names <= {"crossed-terms", "missing-rule", "no-rule-fires", "unused-term"}
    bad = check_text(TEXT.replace("cosine-bell 0 2", "cosine-bell 0 -2")).diagnostics
    assert [(d.name, d.line) for d in bad] == [("bad-shape", 6)]
    assert bad[0].message == "the width of a cosine-bell must be above 0"
    bad = check_text(TEXT.replace("cosine-bell 0 2", "cosine-bell 0")).diagnostics
    assert bad[0].message == "cosine-bell takes 2 numbers (centre, width), found 1"


@pytest.mark.usefixtures("own_kinds")
@pytest.mark.parametrize(
    ("written", "meant"),
    [("yager2", "yagr2"), ("cosine-bell", "cosinebell"), ("slightly A", "slihtly A")],
)
def test_a_misspelt_kind_is_hinted_at(written: str, meant: str) -> None:
    (found,) = parse(TEXT.replace(written, meant)).diagnostics
    assert found.hint == f"did you mean '{written.split(maxsplit=1)[0]}'?"


@pytest.mark.usefixtures("own_kinds")
@pytest.mark.parametrize(
    ("line", "label", "detail"),
    [
        ("inference and ", "yager2", ""),
        ("inference aggregation ", "yagers", "Yager, w = 2"),
        ("term e B: ", "cosine-bell", "centre width — one period of a cosine"),
        ("rule if e is ", "slightly", "min(d, 1 − d)"),
        ("rule if ", "softened", ""),
    ],
)
def test_own_kinds_are_offered(line: str, label: str, detail: str) -> None:
    text = TEXT + line
    offered = complete(read(text), text.count("\n") + 1, len(line) + 1)
    assert (label, detail) in [(c.label, c.detail) for c in offered]


@pytest.mark.usefixtures("own_kinds")
def test_own_kinds_are_coloured_and_explained() -> None:
    reading = read(TEXT)
    lines = TEXT.splitlines()
    colours = {lines[c.line - 1][c.column - 1 : c.end - 1]: c.colour for c in coloured(reading)}
    assert colours["yager2"] == colours["cosine-bell"] == "type"
    assert colours["slightly"] == colours["softened"] == "modifier"
    shown = hover(reading, 10, lines[9].index("slightly") + 2)
    assert shown is not None
    assert shown.markdown == "**slightly**: hedge: min(d, 1 − d)"
    shown = hover(reading, 8, lines[7].index("yagers") + 2)
    assert shown is not None
    assert "Yager, w = 2" in shown.markdown


def test_unknown_kinds_are_errors_again_when_they_are_withdrawn() -> None:
    assert {d.name for d in parse(TEXT).diagnostics} == {
        "unknown-choice", "unknown-shape", "unknown-hedge",
    }  # fmt: skip


@pytest.mark.parametrize("kept", range(5))
def test_kinds_of_a_package_are_found_where_a_file_uses_them(
    kept: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Whatever kind comes first, a shape, a norm or either form of hedge, brings the others.
    module = ModuleType("own_kinds_of_a_package")
    module.register = register  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, module.__name__, module)
    point = EntryPoint("own", f"{module.__name__}:register", records.ENTRY_POINT)
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: [point])
    monkeypatch.setattr(records, "_loaded", [])
    uses = [
        "term e A: cosine-bell 0 2\n",
        "inference and yager2\n",
        "rule if e is slightly N then u is LOW\n",
        "rule if slightly (c is P) then u is MID\n",
        "rule if c is softened(1.3) P then u is MID\n",
    ]
    plain = "\n".join(line for line in TEXT.splitlines() if not line.startswith(("rule ", "term ",
                      "inference and"))) + "\nrule if e is N then u is HIGH\n"  # fmt: skip
    try:
        assert parse(plain + uses[kept]).diagnostics == ()
    finally:
        withdraw()
