"""What is measured: rule bases of seven terms each with the table of pd7.frb, and controllers."""

from __future__ import annotations

import dataclasses
import itertools
from pathlib import Path

import numpy as np

from fuzzyarm import load, shipped
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language import load_rulebase
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Input,
    Is,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    Variable,
)

LOW, HIGH = -6.0, 6.0

UNEVEN = {
    "e": ((-9, -6, -4.5), (-6, -4, -3.5, -1), (-4, -2.25, 0), (-1.5, 0, 0.5, 1.25),
          (0, 1, 3.5), (1.5, 3, 3.25, 5.5), (3, 6, 9)),
    "ce": ((-9, -6, -3), (-5.5, -4, -2), (-4, -2, -1.5, 0.5), (-2, -0.25, 1.75),
           (-0.5, 2, 2.5, 4.5), (1.75, 4.25, 6.5), (4, 6, 8)),
    "u": ((-8, -6, -5, -2.5), (-5.5, -3.75, -1.5), (-4, -1.75, 0.5), (-1, 0, 0.25, 2),
          (-0.5, 1.5, 4), (1.5, 4, 4.5, 6.25), (3.5, 6, 9)),
}  # fmt: skip
"""Triangles and trapezoids, uneven and overlapping: up to three hold at a place."""


def even() -> RuleBase:
    """Return the shipped controller: strong partitions of equal triangles."""
    return load_rulebase(shipped("pd7.frb"))


def uneven() -> RuleBase:
    """Return the same rules over other terms."""
    base = even()

    def terms(name: str) -> tuple[Term, ...]:
        kinds = {3: "triangle", 4: "trapezoid"}
        return tuple(
            Term(old.name, Shape(kinds[len(p)], tuple(map(float, p))))
            for old, p in zip(base.variable(name).terms, UNEVEN[name], strict=True)
        )

    return dataclasses.replace(
        base,
        inputs=tuple(dataclasses.replace(each, terms=terms(each.name)) for each in base.inputs),
        outputs=tuple(dataclasses.replace(each, terms=terms(each.name)) for each in base.outputs),
        expectations=(),
    )


def smooth() -> RuleBase:
    """Return the same rules over bell curves, with a centroid of 101 samples."""
    base = even()

    def terms(old: Variable) -> tuple[Term, ...]:
        centres = np.linspace(LOW, HIGH, len(old.terms)).tolist()
        pairs = zip(old.terms, centres, strict=True)
        return tuple(Term(term.name, Shape("gaussian", (centre, 0.8))) for term, centre in pairs)

    (output,) = base.outputs
    sampled = Defuzzifier("centroid", 101)
    return dataclasses.replace(
        base,
        inputs=tuple(dataclasses.replace(each, terms=terms(each)) for each in base.inputs),
        outputs=(dataclasses.replace(output, terms=terms(output), defuzzifier=sampled),),
        expectations=(),
    )


def many_inputs(count: int, inputs: int) -> RuleBase:
    """Return all rules on some inputs of even triangles: a conclusion has the mean index."""
    base = even()
    step = (HIGH - LOW) / (count - 1)
    peaks = [LOW + step * i for i in range(count)]
    shapes = [Shape("triangle", (peak - step, peak, peak + step)) for peak in peaks]
    terms = tuple(Term(f"T{i}", shape) for i, shape in enumerate(shapes))
    (output,) = base.outputs
    names = [f"x{i}" for i in range(inputs)]
    rules = []
    for indexes in itertools.product(range(count), repeat=inputs):
        parts = (Is(n, terms[i].name) for n, i in zip(names, indexes, strict=True))
        then = terms[round(sum(indexes) / inputs)].name
        rules.append(Rule(And(tuple(parts)), (Consequent(output.name, then),)))
    return dataclasses.replace(
        base,
        inputs=tuple(Input(name, LOW, HIGH, terms) for name in names),
        outputs=(dataclasses.replace(output, terms=terms),),
        blocks=(RuleBlock(tuple(rules)),),
        lookup=None,
        expectations=(),
    )


def exact_controller(folder: Path, name: str) -> ControllerText:
    """Return a shipped controller with the exact centroid in place of that of 101 samples."""
    for used in ("pd7-study", "alpha7-study"):
        rules = shipped(f"{used}.frb").read_text(encoding="utf-8")
        text = rules.replace("centroid(101, endpoints)", "centroid exact")
        (folder / f"{used}.frb").write_text(text, encoding="utf-8")
    (folder / f"{name}.frb").write_text(shipped(f"{name}.frb").read_text(encoding="utf-8"))
    found = load(folder / f"{name}.frb")
    assert isinstance(found, ControllerText)
    return found


def table(base: RuleBase) -> list[int]:
    """Return the index of the conclusion of each rule, row by row."""
    index = {term.name: i for i, term in enumerate(base.outputs[0].terms)}
    return [index[rule.consequents[0].term] for rule in base.blocks[0].rules]


def rule_file(rules: int) -> str:
    """Return a file of about so many rules, written out one by one."""
    side = max(2, round(rules**0.5))
    names = [f"T{i}" for i in range(side)]
    lines = ["rulebase large", ""]
    lines += [f"input {name} 0 .. {side - 1}" for name in ("a", "b")]
    lines += [f"output u 0 .. {side - 1}", "", f"terms a, b, u: triangles {' '.join(names)}", ""]
    for i, j in itertools.islice(itertools.product(range(side), repeat=2), rules):
        lines.append(f"rule if a is T{i} and b is T{j} then u is T{(i + j) // 2}")
    return "\n".join(lines) + "\n"
