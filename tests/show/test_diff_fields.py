"""`diff` sees each changed number and word of a rule base or a table, down to the last bit."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from fuzzyarm.apps.show.diff import compare_rulebases
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.language import parse
from fuzzyarm.table import Axis, LookupTable, TableError, compare_tables

TEXT = """\
rulebase r "of all sorts"
input x -1 .. 1
input z 0 .. 1
output y -8 .. 8
term x A: triangle -1 -0.5 0.25
term x B: gaussian 0.3 0.7
term z A: trapezoid 0 0.1 0.2 1
term y P: triangle 0 1 2
term y Q: s 0 3
inference and min, or max, implication min, defuzzifier centroid(101), threshold 0.05
inference no-rule 0.3, outside clamp
rule if x is A and z is A then y is P with 0.7
rule if x is very B then y is Q
lookup
  levels x: -1 .. 1 count 5
  bins x: -0.6 -0.3 0.2 0.5
  round 0.1
"""

# Fields that mean nothing to inference or a table: places, forms, words for people, and demands.
ASIDE = {"span", "in_grid", "description", "expectations", "properties", "tuning", "provenance"}

Path = tuple[Any, ...]


def values(node: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yield all numbers and words of a model, and where each is."""
    if dataclasses.is_dataclass(node):
        for each in dataclasses.fields(node):
            if each.name not in ASIDE:
                yield from values(getattr(node, each.name), (*path, each.name))
    elif isinstance(node, tuple):
        for number, part in enumerate(node):
            yield from values(part, (*path, number))
    elif node is not None:
        yield path, node


def with_value(node: Any, path: Path, new: Any) -> Any:
    """Return a model with another value in one place."""
    if not path:
        return new
    first, *rest = path
    if dataclasses.is_dataclass(node) and not isinstance(node, type):
        part = with_value(getattr(node, first), tuple(rest), new)
        return dataclasses.replace(node, **{first: part})
    return (*node[:first], with_value(node[first], tuple(rest), new), *node[first + 1 :])


def changes(node: Any) -> Iterator[tuple[Path, Any]]:
    """Yield the model with each number and each word changed, where that makes sense."""
    for path, value in values(node):
        if path[-1] == "formula":  # of a shape that has none
            continue
        new = (
            math.nextafter(value, math.inf) if isinstance(value, float)
            else value + "x" if isinstance(value, str)
            else value + 1
        )  # fmt: skip
        try:
            yield path, with_value(node, path, new)
        except (RuleBaseError, TableError):  # no such shape, no such defuzzifier, no such mode
            continue


def test_each_number_and_each_word_counts() -> None:
    rulebase = parse(TEXT).rulebase
    assert rulebase is not None
    seen = [
        (path, compare_rulebases(rulebase, changed).same) for path, changed in changes(rulebase)
    ]
    assert [path for path, same in seen if same] == []
    assert len(seen) > 60


def test_each_setting_of_a_table_counts() -> None:
    axes = (Axis("e", (-1.0, 0.0, 2.0), (-0.5, 1.0), -2.0, 3.0), Axis("ce", (0.0, 1.0)))
    table = LookupTable(axes, "u", np.eye(3, 2), low=-6.0, high=6.0, rounding=0.5, mode="linear")
    seen = [(path, compare_tables(table, changed).same) for path, changed in changes(table)]
    assert [path for path, same in seen if same] == []
    parts = {part for path, _ in seen for part in path if isinstance(part, str)}
    named = {each.name for kind in (LookupTable, Axis) for each in dataclasses.fields(kind)}
    assert named - parts - ASIDE == {"mode"}
    assert not compare_tables(table, dataclasses.replace(table, mode="bins")).same
