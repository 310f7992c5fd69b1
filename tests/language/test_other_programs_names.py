"""A word of another program leads to ours; where its numbers mean others, nothing is replaced."""

import pytest

from fuzzyarm.language import parse
from fuzzyarm.symbolic.kinds import SHAPES, SNORMS, TNORMS

TEXT = (
    "rulebase t\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles L H\n{}\n"
    "rule if a is L then u is H\n"
)


def fault(line):
    return next(d for d in parse(TEXT.format(line)).diagnostics if d.line == 5)


@pytest.mark.parametrize(
    ("registry", "line", "skipped"),
    [
        (SHAPES, "term u X: {} 1 2 3", ("linear", "formula")),
        (TNORMS, "inference and {}", ()),
        (SNORMS, "inference aggregation {}", ()),
    ],
)
def test_every_name_in_the_records_leads_to_the_kind(registry, line, skipped):
    assert len(registry.foreign) > 10
    for word, (name, order) in registry.foreign.items():
        if name in skipped or word in registry:
            continue
        found = fault(line.format(word))
        assert found.name in ("unknown-shape", "unknown-choice"), word
        assert f"'{name}'" in found.hint
        assert found.replacement == (None if order else name)


def test_another_order_of_numbers_is_shown_and_not_replaced():
    found = fault("term u X: gaussmf 0.1 0.5")
    assert found.hint.endswith("gaussian mean deviation")
    assert found.replacement is None
    assert fault("term u X: TriMF 0 1 2").replacement == "triangle"
