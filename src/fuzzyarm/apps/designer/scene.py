"""The picture of a rule base as plain data: variables, terms, rules and numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from fuzzyarm.apps.designer.engine import Functions, numbers_of
from fuzzyarm.apps.designer.messages import (
    Method,
    Number,
    Scene,
    SceneCurve,
    SceneGrid,
    SceneMember,
    SceneOutput,
    SceneRule,
    SceneShape,
    SceneTerm,
    SceneVariable,
    TextRange,
)
from fuzzyarm.apps.lsp.session import UTF16, to_position
from fuzzyarm.base.diagnostic import Span
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.base.numbers import number_text
from fuzzyarm.inference.block import NotCoveredError
from fuzzyarm.inference.firing_intervals import UPPER, doubled, is_value
from fuzzyarm.inference.plan import Plan, plan
from fuzzyarm.inference.row_functions import norm_number
from fuzzyarm.inference.trace import place_of, sentence
from fuzzyarm.language.edit import INCOMPLETE, Reading
from fuzzyarm.language.model.alike import KINDS
from fuzzyarm.language.model.rulebase import (
    Input,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    propositions,
)
from fuzzyarm.language.model.shapes import centre
from fuzzyarm.language.phrases import SETTINGS, SettingNode
from fuzzyarm.language.rows import sentence as row_sentence
from fuzzyarm.language.rows import text_of
from fuzzyarm.language.rules import GridNode, RuleNode
from fuzzyarm.language.statements import BlockNode, InferenceNode
from fuzzyarm.symbolic.kinds import SHAPES, SNORMS, TNORMS

LowerNames = dict[tuple[str, str], str]
"""Variable and term → the name of its lower end."""

WIDTHS = frozenset({
    "deviation", "left-deviation", "right-deviation", "width", "slope", "slope1", "slope2",
    "direction",
})  # fmt: skip
"""Parameters of shapes that are not positions on the axis."""

MOST_RULES = 20_000
"""A page draws the rules of a file with no more than this."""


class Positions:
    """Positions of a text as a page counts them: line and UTF-16 unit, from 0."""

    def __init__(self, lines: list[str]) -> None:
        self.lines = lines

    def of(self, span: Span) -> TextRange:
        """Return start and end of a span."""
        start = to_position(self.lines, span.line, span.column, UTF16)
        end = to_position(self.lines, span.end_line, span.end_column, UTF16)
        return [list(start), list(max(start, end))]


def scene_of(rulebase: RuleBase, reading: Reading) -> Scene:
    """Return the picture of a rule base."""
    positions = Positions(reading.raw_lines)
    functions = Functions()
    whole = plan(rulebase)
    lower = doubled(rulebase).lower_names if rulebase.is_type2 else {}
    numbers, reason = None, ""
    try:
        numbers = numbers_of(rulebase, functions)
    except NotCoveredError as error:
        reason = str(error)
    return {
        "name": rulebase.name,
        "description": rulebase.description,
        "inputs": [
            _variable(variable, functions, positions, lower) for variable in rulebase.inputs
        ],
        "outputs": [
            _output(output, whole, functions, positions, lower) for output in rulebase.outputs
        ],
        "rules": _rules(rulebase, whole, reading, positions),
        "grids": _grids(rulebase, reading, positions),
        "methods": _methods(rulebase, reading),
        "missing": _missing(rulebase, reading),
        "numbers": numbers,
        "kinds": KINDS,
        "functions": functions.described,  # with those of drawn curves
        "reason": reason,
    }


def _missing(rulebase: RuleBase, reading: Reading) -> list[str]:
    """Return the parts missing from a picture; a grid of dots has no rules."""
    found = [diagnostic.name for diagnostic in reading.parsed.diagnostics]
    return [name for name in found if name in INCOMPLETE] or (
        [] if rulebase.rules else ["no-rules"]
    )


def held_numbers(rulebase: RuleBase, variable: str) -> dict[str, Any] | None:
    """Return the numbers of a rule base while the user moves the terms of a variable."""
    output = rulebase.variable(variable)
    middles = isinstance(output, Output) and output.defuzzifier.record.both
    if middles and any(term.lower and is_value(term.lower) for term in output.terms):
        return None  # the number stored is the middle of two
    try:
        return numbers_of(rulebase, editable=variable)
    except NotCoveredError:
        return None


def _number(value: float) -> Number:
    """Return a number for JSON, which has no infinite ones."""
    return value if math.isfinite(value) else "Infinity" if value > 0.0 else "-Infinity"


def _variable(
    variable: Input | Output, functions: Functions, positions: Positions, lower: LowerNames
) -> SceneVariable:
    return {
        "name": variable.name,
        "description": variable.description,
        "low": jsonable(variable.low),
        "high": jsonable(variable.high),
        "outside": variable.outside,
        "terms": [
            _term(term, variable, functions, positions, lower.get((variable.name, term.name), ""))
            for term in variable.terms
        ],
    }


def _term(
    term: Term, variable: Input | Output, functions: Functions, positions: Positions, lower: str
) -> SceneTerm:
    """Describe a term; `lower` is the name of its lower end in the numbers, if any."""
    term_scene: SceneTerm = {
        "name": term.name,
        "at": positions.of(term.span)[0],
        **_shape(term.shape, variable, functions),
        # In an output with two ends a term of type 1 is there twice; the user moves both.
        "marks": [term.name, *([lower] if lower and term.lower is None else [])],
        "lower": None,
    }
    if term.lower is not None:
        term_scene["lower"] = {**_shape(term.lower, variable, functions), "marks": [lower]}
    return term_scene


def _shape(shape: Shape, variable: Input | Output, functions: Functions) -> SceneShape:
    kind = SHAPES[shape.kind]
    shape_data: SceneShape = {
        "kind": shape.kind,
        "parameters": list(map(_number, shape.parameters)),
        "names": list(kind.parameters),
        "height": shape.height,
        "centre": None,
        "curve": None,
        "ordered": kind.ordered,
        "straight": kind.straight,
        "handles": [],
    }
    if not kind.fuzzy:
        return shape_data
    shape_data["centre"] = centre(shape, variable.low, variable.high)
    shape_data["curve"] = _curve(functions.curve(shape, ()))
    if shape.kind == "points":
        shape_data["handles"] = list(range(0, len(shape.parameters), 2))
    elif shape.kind != "formula":
        names = enumerate(zip(kind.parameters, shape.parameters, strict=True))
        shape_data["handles"] = [
            i for i, (name, value) in names if name not in WIDTHS and math.isfinite(value)
        ]
    return shape_data


def _curve(function: Any) -> SceneCurve:
    return {"address": function.address, "numbers": list(map(_number, function.numbers))}


def _output(
    output: Output, plan: Plan, functions: Functions, positions: Positions, lower: LowerNames
) -> SceneOutput:
    output_plan = plan.outputs[output.name]
    upper = {name: term for (of, term), name in lower.items() if of == output.name}
    members: list[SceneMember] = []
    for i, member in enumerate(output_plan.members):
        values = member.value is not None or not SHAPES[member.term.shape.kind].fuzzy
        curve = None if values else functions.curve(member.term.shape, member.hedges)
        members.append(
            {
                "term": upper.get(member.term.name, member.term.name),
                "isLower": member.term.name in upper,
                "side": output_plan.sides[i] if output_plan.sides else UPPER,
                "hedged": bool(member.hedges),
                "words": " ".join(
                    [
                        *(hedge.name for hedge in member.hedges),
                        upper.get(member.term.name, member.term.name),
                    ]
                ),
                "value": jsonable(member.value),
                "curve": None if curve is None else _curve(curve),
                "implication": norm_number(TNORMS[member.implication], "T", functions),
            }
        )
    return {
        **_variable(output, functions, positions, lower),
        "defuzzifier": str(output.defuzzifier),
        "aggregation": norm_number(SNORMS[output.aggregation], "S", functions),
        "discrete": output_plan.discrete,
        "interval": output.defuzzifier.record.of == "ends",
        "twoSided": bool(output_plan.sides),
        "noRule": jsonable(output.no_rule),
        "members": members,
        "asserted": [list(contribution) for contribution in output_plan.contributions],
    }


def _rules(
    rulebase: RuleBase, plan: Plan, reading: Reading, positions: Positions
) -> list[SceneRule]:
    if len(plan.rules) > MOST_RULES:
        return []
    concluded: dict[int, list[list[int]]] = {}
    for o, output in enumerate(plan.outputs.values()):
        for member, index in output.contributions:
            concluded.setdefault(index, []).append([o, member])
    names = [variable.name for variable in rulebase.inputs]
    nodes = (statement.node for statement in reading.document.statements)
    written = {node.span.line: row_sentence(node) for node in nodes if isinstance(node, RuleNode)}
    rules: list[SceneRule] = []
    for number, rule in enumerate(rulebase.rules):
        rules.append(
            {
                "text": sentence(rule),
                "place": place_of(number + 1, rule.span.line, rule.span.column),
                "written": "" if rule.in_grid else written.get(rule.span.line, ""),
                "line": rule.span.line,
                "range": positions.of(rule.span),
                "weight": rule.weight,
                "at": positions.of(rule.span)[0],
                "inGrid": rule.in_grid,
                "parts": list(_parts(rule, names)),
                # Of type 2 a rule is read twice: by its upper degrees, then by the lower ones.
                "readings": list(plan.readings[number]),
                "concludes": concluded.get(plan.readings[number][0], []),
                "concludesLower": [
                    block
                    for index in plan.readings[number][1:]
                    for block in concluded.get(index, [])
                ],
            }
        )
    return rules


def _parts(rule: Rule, names: list[str]) -> Iterable[list[Any]]:
    """Yield the propositions about inputs: which, the term, and hedges in words."""
    for part in propositions(rule.antecedent):
        if part.variable in names:
            hedges = " ".join(hedge.name for hedge in part.hedges)
            yield [names.index(part.variable), part.term, hedges]


def _methods(rulebase: RuleBase, reading: Reading) -> list[Method]:
    """Return the settings of inference with their choices, and those of variables and blocks."""
    nodes = [statement.node for statement in reading.document.statements]
    written = {
        ("" if node.target is None else str(node.target), str(setting.key)): _value(setting)
        for node in nodes
        if isinstance(node, InferenceNode)
        for setting in node.settings
    }
    norms = RuleBlock()
    usual = {"and": norms.conjunction, "or": norms.disjunction, "implication": norms.implication}
    methods = [_method(key, written.get(("", key), value)) for key, value in usual.items()]
    for key in ("aggregation", "defuzzifier"):
        with_line = [output for output in rulebase.outputs if (output.name, key) in written]
        others = [output for output in rulebase.outputs if output not in with_line]
        # Outputs without their own line share one row, which shows the first of them.
        for output in [*others[:1], *with_line]:
            target = output.name if output in with_line else ""
            methods.append(_method(key, str(getattr(output, key)).removesuffix(" exact"), target))
    settings = [text_of(node) for node in nodes if isinstance(node, BlockNode) and node.settings]
    return [*methods, *(Method(block=setting) for setting in settings)]


def _value(setting: SettingNode) -> str:
    return str(setting).removeprefix(f"{setting.key} ").removesuffix(" exact")


def _method(key: str, value: str, target: str = "") -> Method:
    values = SETTINGS[key].values
    options = [value, *values] if value not in values else list(values)
    return {"key": key, "value": value, "options": options, "target": target}


def _grids(rulebase: RuleBase, reading: Reading, positions: Positions) -> list[SceneGrid]:
    numbers = {
        (rule.span.line, rule.span.column, consequent.variable): number
        for number, rule in enumerate(rulebase.rules)
        for consequent in rule.consequents
        if rule.in_grid
    }
    nodes = [statement.node for statement in reading.document.statements]
    grids = [node for node in nodes if isinstance(node, GridNode)]
    return [
        {
            "line": grid.span.line,
            "output": part.output,
            "condition": "" if part.condition is None else str(part.condition),
            "row": None if part.row is None else part.row,
            "column": part.column,
            "columns": list(part.columns),
            "joined": bool(grid.joined),
            "range": positions.of(part.span),
            "rows": [
                {
                    "label": row.label,
                    "cells": [
                        {
                            "term": None if cell.term is None else cell.term,
                            "weight": None if cell.weight is None else number_text(cell.weight),
                            "at": [cell.span.line, cell.span.column],
                            "range": positions.of(cell.span),
                            "rule": numbers.get((cell.span.line, cell.span.column, part.output)),
                        }
                        for cell in row.cells
                    ],
                }
                for row in part.rows
            ],
        }
        for grid in grids
        for part in grid.parts
    ]
