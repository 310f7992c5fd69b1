"""A rule base as the flat numbers that :mod:`fuzzyarm.control.fuzzy_kernel` reads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fuzzyarm.control import fuzzy_kernel as kernel
from fuzzyarm.control.sources import SourceError
from fuzzyarm.inference.plan import Member, OutputPlan, Plan, plan
from fuzzyarm.inference.profile import Piece, profile
from fuzzyarm.inference.sampling import places, weights
from fuzzyarm.rulebase.membership import apply_hedge, membership
from fuzzyarm.rulebase.model import And, Expression, Input, Is, RuleBase
from fuzzyarm.rulebase.shapes import SHAPES


@dataclass(frozen=True)
class RuleNumbers:
    """A rule base for the kernel.

    Attributes
    ----------
    numbers : tuple of float
        What the kernel reads.
    room : int
        How many numbers it needs to work in, inputs included.
    """

    numbers: tuple[float, ...]
    room: int


def rule_numbers(rulebase: RuleBase, output: str | None = None) -> RuleNumbers:
    """Write a rule base down for the kernel.

    Parameters
    ----------
    rulebase : RuleBase
        Rules that are conjunctions, piecewise-linear terms, ``min`` or ``product``, aggregation
        ``max``, the exact or a sampled centroid; any number of inputs, terms and rules.
    output : str, optional
        Which output; may be left out where there is one.

    Raises
    ------
    SourceError
        If the rule base is of another kind; it says in what.
    """
    planned = plan(rulebase)
    name = output or _only_output(rulebase)
    target = planned.outputs[name]
    keys = _propositions(planned, rulebase)
    rules = _rules(planned, target, keys)
    sets = _output(target)
    inputs: list[float] = []
    at = kernel.HEAD + kernel.INPUT_HEAD * len(rulebase.inputs)
    heads: list[float] = []
    for variable in rulebase.inputs:
        head, body = _input(variable, keys, at + len(inputs))
        heads += head
        inputs += body
    rules_at = at + len(inputs)
    output_at = rules_at + len(rules(rules_at))
    norms = {planned_rule.conjunction for planned_rule in planned.rules}
    implications = {member.implication for member in target.members}
    samples = target.output.defuzzifier.resolution or 0
    silent = target.output.no_rule
    front = [
        len(rulebase.inputs),
        len(keys),
        _norm(rulebase, norms, "'and'"),
        _norm(rulebase, implications, "implication"),
        len(target.members),
        samples,
        float(silent) if not isinstance(silent, str) else math.nan,
        kernel.HEAD,
        rules_at,
        output_at,
    ]
    numbers = [*front, *heads, *inputs, *rules(rules_at), *sets(output_at)]
    pieces = sum(len(member.pieces) for member in target.members)
    # Cutting may split a piece in two; each end is an event.
    work = samples or 2 * kernel.LINE * pieces + 4 * pieces + 1
    room = len(rulebase.inputs) + len(keys) + len(target.members) + work
    return RuleNumbers(tuple(float(each) for each in numbers), room)


def _refuse(rulebase: RuleBase, what: str) -> SourceError:
    return SourceError(
        f"a controller cannot evaluate '{rulebase.name}' at every step: {what}",
        hint="compile it to a table and run fuzzy-lut with that",
    )


def _only_output(rulebase: RuleBase) -> str:
    if len(rulebase.outputs) != 1:
        raise _refuse(rulebase, f"it has {len(rulebase.outputs)} outputs, one is needed")
    return rulebase.outputs[0].name


Key = tuple[str, str, tuple[object, ...]]


def _parts(rulebase: RuleBase, expression: Expression) -> list[Is]:
    """Return the propositions of a conjunction."""
    if isinstance(expression, Is):
        return [expression]
    if isinstance(expression, And):
        return [part for each in expression.operands for part in _parts(rulebase, each)]
    raise _refuse(rulebase, "a rule is no plain conjunction")


def _key(part: Is) -> Key:
    return part.variable, part.term, part.hedges


def _propositions(planned: Plan, rulebase: RuleBase) -> dict[Key, tuple[int, Is]]:
    found: dict[Key, tuple[int, Is]] = {}
    known = {variable.name for variable in rulebase.inputs}
    for rule in planned.rules:
        for part in _parts(rulebase, rule.rule.antecedent):
            if part.variable not in known:
                raise _refuse(rulebase, f"a rule reads the output '{part.variable}'")
            found.setdefault(_key(part), (len(found), part))
    return found


def _norm(rulebase: RuleBase, names: set[str], what: str) -> int:
    codes = {"min": 0, "product": 1}
    if len(names) != 1 or not names <= set(codes):
        raise _refuse(rulebase, f"its {what} is {' and '.join(sorted(names))}, not min or product")
    return codes[names.pop()]


def _input(
    variable: Input, keys: Mapping[Key, tuple[int, Is]], at: int
) -> tuple[list[float], list[float]]:
    """Return the head of an input and, from `at` on, its breaks and the lines over its pieces."""
    if variable.outside != "clamp" or not math.isfinite(variable.high - variable.low):
        raise SourceError(
            f"input '{variable.name}' has to be bounded and clamped for a controller",
            hint="outside clamp",
        )
    sets = [
        (number, part, _straight(variable, part))
        for (name, _, _), (number, part) in keys.items()
        if name == variable.name
    ]
    breaks = sorted(
        {
            variable.low,
            variable.high,
            *(x for _, _, all_ in sets for p in all_ for x in (p.x0, p.x1)),
        }
    )
    table: list[float] = []
    lines: list[float] = []
    lines_at = at + len(breaks) + 2 * (2 * len(breaks) - 1)
    for k in range(2 * len(breaks) - 1):
        found = list(_lines(variable, sets, breaks, k))
        table += [lines_at + len(lines), len(found)]
        lines += [number for line in found for number in line]
    return [variable.low, variable.high, len(breaks), at], [*breaks, *table, *lines]


Sets = Sequence[tuple[int, Is, tuple[Piece, ...]]]


def _lines(
    variable: Input, sets: Sets, breaks: Sequence[float], k: int
) -> list[tuple[float, float, float, float]]:
    """Return (degree, x0, y0, slope) of the terms that hold on piece `k`: a break or between."""
    lines = []
    for number, part, pieces in sets:
        if k % 2 == 0:
            x = breaks[k // 2]
            y, slope = _degree(variable, part, x), 0.0
        else:
            x, end = breaks[k // 2], breaks[k // 2 + 1]
            piece = next(p for p in pieces if p.x0 <= x and p.x1 >= end)
            slope = (piece.y1 - piece.y0) / (piece.x1 - piece.x0)
            y = piece.y0 + slope * (x - piece.x0) if x > piece.x0 else piece.y0
        if y != 0.0 or slope != 0.0:
            lines.append((float(number), x, y, slope))
    return lines


def _degree(variable: Input, part: Is, x: float) -> float:
    degree = membership(variable.term(part.term).shape, x)
    for hedge in reversed(part.hedges):
        degree = apply_hedge(hedge, degree)
    return degree


def _straight(variable: Input, part: Is) -> tuple[Piece, ...]:
    shape = variable.term(part.term).shape
    if not SHAPES[shape.kind].piecewise_linear or shape.kind == "singleton":
        raise SourceError(
            f"term {part.term} of '{variable.name}' is not piecewise linear",
            hint="compile the rule base to a table and run fuzzy-lut with that",
        )
    found = profile(
        shape, part.hedges, lambda x: _degree(variable, part, x), variable.low, variable.high
    )
    if not all(piece.straight for piece in found):
        raise SourceError(f"a hedge bends term {part.term} of '{variable.name}'")
    return found


class _Sections:
    """Numbers with places in them that depend on where they will stand."""

    def __init__(self, parts: Sequence[Sequence[float]], heads: Sequence[Sequence[float]]) -> None:
        self.parts = parts
        self.heads = heads

    def __call__(self, at: int) -> list[float]:
        """Return all heads, each ended by the place of its part, then the parts."""
        place = at + sum(len(head) + 1 for head in self.heads)
        front: list[float] = []
        for head, part in zip(self.heads, self.parts, strict=True):
            front += [*head, place]
            place += len(part)
        return front + [number for part in self.parts for number in part]


class _Rules:
    """Rules in groups that share their first proposition."""

    def __init__(self, groups: Mapping[int, Sequence[Sequence[float]]]) -> None:
        self.groups = groups

    def __call__(self, at: int) -> list[float]:
        """Return the groups, each with the place behind it."""
        out: list[float] = [len(self.groups)]
        for first, rules in self.groups.items():
            flat = [number for rule in rules for number in rule]
            out += [first, len(rules), at + len(out) + 3 + len(flat), *flat]
        return out


def _rules(planned: Plan, target: OutputPlan, keys: Mapping[Key, tuple[int, Is]]) -> _Rules:
    groups: dict[int, list[list[float]]] = {}
    for member, index in target.contributions:
        rule = planned.rules[index]
        degrees = [keys[_key(part)][0] for part in _parts(planned.rulebase, rule.rule.antecedent)]
        numbers = [len(degrees) - 1, rule.rule.weight, rule.threshold, member, *degrees[1:]]
        groups.setdefault(degrees[0], []).append([float(each) for each in numbers])
    return _Rules(groups)


def _output(target: OutputPlan) -> _Sections:
    output = target.output
    if output.aggregation != "max" or output.defuzzifier.method != "centroid" or target.discrete:
        raise SourceError(
            f"output '{output.name}' needs sets, aggregation max and a centroid for a controller",
            hint="compile the rule base to a table and run fuzzy-lut with that",
        )
    if not output.defuzzifier.resolution:
        parts = [_ends(member) for member in target.members]
        return _Sections(parts, [[len(part) // kernel.LINE] for part in parts])
    count, sampling = output.defuzzifier.resolution, output.defuzzifier.sampling
    x = places(output.low, output.high, count, sampling)
    w = weights(count, sampling)
    sampled = [[member.membership(each) for each in x] for member in target.members]
    spans = [_span(values) for values in sampled]
    cut = [values[a:b] for values, (a, b) in zip(sampled, spans, strict=True)]
    moments = [a * b for a, b in zip(x, w, strict=True)]
    return _Sections([moments, w, *cut], [[], [], *([a, b] for a, b in spans)])


def _ends(member: Member) -> list[float]:
    if not all(piece.straight for piece in member.pieces):
        raise SourceError(
            f"term {member.term.name} is not piecewise linear",
            hint="ask for a sampled centroid, as in centroid(101, endpoints)",
        )
    return [number for p in member.pieces for number in (p.x0, p.y0, p.x1, p.y1)]


def _span(values: Sequence[float]) -> tuple[int, int]:
    held = [i for i, value in enumerate(values) if value != 0.0]
    return (held[0], held[-1] + 1) if held else (0, 0)
