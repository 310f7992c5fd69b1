"""The engine of the page: any rule base in JavaScript, from numbers updated by every edit.

Three things make it: the kernel, translated from its own source
(:mod:`fuzzyarm.symbolic.translation`); shapes, norms and hedges, printed from their expressions by
the table of operations; and the rule base as the flat list of numbers that the kernel reads
(:mod:`fuzzyarm.inference.layout`). So a page that changes a rule base gets other numbers, not
another program: nothing is compiled, no text is run, and a strict content policy holds. Where only
+ − × ÷, min and max occur the bits are those of Python; functions such as ``exp`` may differ in
their last bits between engines.
"""

from __future__ import annotations

import base64
import json
import math
import struct
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from fuzzyarm.inference import block
from fuzzyarm.inference.block import Layout
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import Plan, plan
from fuzzyarm.inference.programs import EVALUATORS, PROGRAMS, DefuzzifierProgram
from fuzzyarm.inference.row_functions import Curve
from fuzzyarm.inference.sets import degree_formula
from fuzzyarm.language.model.rulebase import POSITION, Hedge, RuleBase, Shape
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, SNORMS, TNORMS, Norm
from fuzzyarm.symbolic.lines import degree_on_corners
from fuzzyarm.symbolic.nodes import Constant, Node, Symbol, children, replace, symbol
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.printing import JAVASCRIPT, printed
from fuzzyarm.symbolic.records import Kind


class KindNames(NamedTuple):
    """The kinds in a module."""

    shapes: Sequence[str]
    tnorms: Sequence[str]
    snorms: Sequence[str]
    hedges: Sequence[str]


def every_kind() -> KindNames:
    """Return all kinds registered now, those of users among them."""
    return KindNames(tuple(SHAPES), tuple(TNORMS), tuple(SNORMS), tuple(HEDGES))


# ── the numbers of a rule base ───────────────────────────────────────────────────────


class Functions:
    """The numbering of the functions in a layout, with descriptions for the engine."""

    compiled = False

    def __init__(self) -> None:
        self.described: list[dict[str, Any]] = []
        self._numbers: dict[str, int] = {}

    def _number(self, described: dict[str, Any]) -> int:
        key = json.dumps(described, sort_keys=True)
        if key not in self._numbers:
            # The first numbers are the norms built into the kernel.
            self._numbers[key] = len(block.BUILT_IN) + len(self.described)
            self.described.append(described)
        return self._numbers[key]

    def norm(self, norm: Norm, sort: str) -> int:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        return self._number({"norm": norm.name, "sort": sort})

    def hedged(self, hedges: tuple[Hedge, ...]) -> int:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        return self._number({"hedges": _hedges(hedges)})

    def expression(self, root: Node, numbers: Sequence[str]) -> int:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        # The engine hands the numbers over by their index.
        plain = {name: symbol(f"n{index}") for index, name in enumerate(numbers)}
        return self._number({"formula": _tree(replace(root, plain))})

    def program(self, program: DefuzzifierProgram) -> int:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        return self._number({"program": program.name})

    def curve(self, shape: Shape, hedges: tuple[Hedge, ...]) -> Curve:
        """See :class:`fuzzyarm.inference.row_functions.Addresses`."""
        described: dict[str, Any] = {"hedges": _hedges(hedges)} if hedges else {}
        if SHAPES[shape.kind].function is None and shape.kind != "formula":
            corners = tuple(number for corner in polyline(shape) for number in corner)
            return Curve(self._number({"shape": "points", **described}), corners)
        height = () if shape.height == 1.0 else (shape.height,)
        if height:
            described["height"] = True
        if shape.kind == "formula":
            root = replace(degree_formula(shape), {POSITION: symbol("x")})
            return Curve(self._number({"formula": _tree(root), **described}), height)
        return Curve(self._number({"shape": shape.kind, **described}), (*shape.parameters, *height))


def _hedges(hedges: tuple[Hedge, ...]) -> list[tuple[str, float | None]]:
    """Return hedges in the order in which they act."""
    return [(hedge.name, hedge.exponent) for hedge in reversed(hedges)]


def _tree(node: Node) -> Any:
    """Return an expression as nested lists, fit for JSON."""
    if isinstance(node, Constant):
        finite = math.isfinite(node.value)
        return node.value if finite else JAVASCRIPT.number(node.value)
    if isinstance(node, Symbol):
        return node.name
    return [getattr(node, "operation"), *map(_tree, children(node))]  # noqa: B009


def numbers_of(
    rulebase: RuleBase, functions: Functions | None = None, *, editable: str = ""
) -> dict[str, Any]:
    """Return the numbers of a rule base for an ``Engine``, fit for JSON."""
    functions = functions or Functions()
    evaluation_plan = plan(rulebase)
    layout = lay_out(evaluation_plan, addresses=functions, editable=editable)
    return {
        "whole": _base64("i", layout.whole),
        "floats": _base64("d", layout.floats),
        "programs": layout.programs,
        "rows": layout.rows,
        "samples": layout.samples,
        "rules": len(evaluation_plan.rules),
        "weights": _first_weight(evaluation_plan, layout),
        "intervals": [
            o
            for o, output in enumerate(rulebase.outputs)
            if output.defuzzifier.record.of == "ends"
            and evaluation_plan.outputs[output.name].members
        ],
        "functions": functions.described,
        "marks": [mark._asdict() for mark in layout.marks],
    }


def _first_weight(plan: Plan, layout: Layout) -> int:
    """Return the index of the first weight in the floats: before those of the first output."""
    first = layout.whole[layout.whole[block.OUTPUTS_AT] + block.FLOATS_AT]
    # Two floats for each rule: weight and threshold.
    return first - 2 * len(plan.rules)


def _base64(letter: str, numbers: Sequence[float]) -> str:
    return base64.b64encode(struct.pack(f"<{len(numbers)}{letter}", *numbers)).decode()


# ── the text ─────────────────────────────────────────────────────────────────────────


def engine_source(library: KindNames | None = None) -> str:
    """Return the engine as text: constants, kinds, the kernel and the class ``Engine``."""
    has = library or every_kind()
    parts = [
        _constants(),
        Path(__file__).with_name("engine.js").read_text(encoding="utf-8"),
        kernel_source(),
        _object("SHAPES", {name: _shape_row(name) for name in has.shapes if _is_set(name)}),
        _object("TNORMS", {name: _norm_row(TNORMS[name]) for name in has.tnorms}),
        _object("SNORMS", {name: _norm_row(SNORMS[name]) for name in has.snorms}),
        _object("HEDGES", {name: _function(HEDGES[name], "") for name in has.hedges}),
        _object("OPERATIONS", {name: _operation(name) for name in OPERATIONS}),
    ]
    return "\n".join(parts)


@cache
def kernel_source() -> str:
    """Return the kernel, translated from its own source."""
    from fuzzyarm.symbolic.translation.functions import Translation
    from fuzzyarm.symbolic.translation.targets import JAVASCRIPT as TARGET
    from fuzzyarm.symbolic.translation.types import Array, Scalar

    translation = Translation(TARGET)
    for evaluate in EVALUATORS:
        translation.function(evaluate, [Array.REALS])
    translation.function(degree_on_corners, [Array.REALS, Scalar.REAL])
    blocks = {
        program.name: translation.function(program.block, [Array.REALS], program.bindings).name
        for program in PROGRAMS
    }
    names = ", ".join(f"{name}: {block}" for name, block in blocks.items())
    return f"{translation.text()}\nconst PROGRAMS_BY_NAME = {{ {names} }};\n"


def _constants() -> str:
    """Return the positions in a block, by name."""
    # Positions for engine.js; the translated kernel has the numbers themselves in its text.
    names = (
        "INPUTS OUTPUTS OPERANDS PROGRAMS_AT OUTPUTS_AT POINTS WIDTH FLOATS SCRATCH COLUMNS RESULTS"
        " ORDERED ORDER ENDS SIZE AGGREGATION DEFUZZIFIER OUTPUT_HEAD GROUP_HEAD RULE_HEAD"
        " TRUTH_HEAD ONES PROGRAM FLOATS_AT DETAIL OUTPUT_RANGE"
    )
    listed = [f"{name} = {getattr(block, name)}" for name in names.split()]
    return f"const {', '.join(listed)};\n"


def _object(name: str, parts: dict[str, str]) -> str:
    lines = [f"  {json.dumps(key)}: {text}," for key, text in parts.items()]
    return "\n".join([f"const {name} = {{", *lines, "};", ""])


def _is_set(name: str) -> bool:
    """Whether a kind has its own row; those known by their corners share that of `points`."""
    kind = SHAPES[name]
    return kind.fuzzy and (kind.function is not None or name == "points")


def _shape_row(name: str) -> str:
    """Return a function that fills a row with the degrees of a kind of shape."""
    if name == "points":
        body = "into[i] = degree_on_corners(numbers, x_row[i]);"
        return f"(x_row, numbers, into) => {{ for (let i = 0; i < into.length; i++) {body} }}"
    kind = SHAPES[name]
    root = replace(kind.expression, _plain_names(kind, "x"))
    count = len(kind.symbols) - 1
    heads = [f"    const p{i} = numbers[{i}];" for i in range(count)]
    lines, result = printed(root, JAVASCRIPT, reserved=("x", "i", *(f"p{i}" for i in range(count))))
    loop_body = [
        f"      {line}" for line in ("const x = x_row[i];", *lines, f"into[i] = {result};")
    ]
    loop = ["    for (let i = 0; i < into.length; i++) {", *loop_body, "    }"]
    return "\n".join(["(x_row, numbers, into) => {", *heads, *loop, "  }"])


def _norm_row(norm: Norm) -> str:
    body = _function(norm, "b").replace("\n", "\n    ")
    loop = "for (let i = 0; i < into.length; i++) into[i] = norm(a_row[i], b_row[i]);"
    return f"((norm) => (a_row, b_row, numbers, into) => {{ {loop} }})({body})"


def _function(kind: Kind, second: str) -> str:
    """Return a function of floats: of one (a degree) or two (`second`), then of its numbers."""
    firsts = ["a", second] if second else ["a"]
    root = replace(kind.expression, _plain_names(kind, *firsts))
    numbers = [f"p{i}" for i in range(len(kind.symbols) - len(firsts))]
    lines, result = printed(root, JAVASCRIPT, reserved=(*firsts, *numbers))
    arguments = ", ".join([*firsts, *numbers])
    if not lines:
        return f"({arguments}) => {result}"
    return "\n".join([f"({arguments}) => {{", *(f"    {line}" for line in lines),
                      f"    return {result};", "  }"])  # fmt: skip


def _plain_names(kind: Kind, *firsts: str) -> dict[str, Node]:
    """Return new names for the symbols of a kind: its own may be words of the language."""
    names = [*firsts, *(f"p{i}" for i in range(len(kind.symbols) - len(firsts)))]
    return {old: symbol(new) for old, new in zip(kind.symbols, names, strict=True)}


def _operation(name: str) -> str:
    operation = OPERATIONS[name]
    names = ("a", "b", "c")[: operation.arity]
    return f"({', '.join(names)}) => {JAVASCRIPT.text(operation).format(*names)}"
