"""Mamdani inference inside the control loop: the flat numbers of a rule base, and their kernel."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fuzzyarm.controller.sources import SourceError
from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.inference.defuzzify.aggregate import positions, weights
from fuzzyarm.inference.plan import Member, OutputPlan, Plan, plan
from fuzzyarm.inference.sets import Piece, profile
from fuzzyarm.kernels import address_of, kernel
from fuzzyarm.model.rulebase import And, Expression, Input, Is, RuleBase
from fuzzyarm.model.shapes import apply_hedge, membership

# --- Mamdani inference as a kernel: from numbers of inputs to the crisp output ---
#
# A rule base is data, a stretch of a flat list that `rule_numbers` (below) writes; another rule
# base is other data for the same machine code. Only the rules whose first proposition holds are
# visited, and only the sets that fired are integrated.

INPUTS, DEGREES, PRODUCT_AND, PRODUCT_THEN, MEMBERS, SAMPLES, SILENT = range(7)
INPUTS_AT, RULES_AT, OUTPUT_AT = range(7, 10)
HEAD = 10
"""Length of the head of a rule base; the places in it are named above."""

INPUT_HEAD = 4
"""Numbers per input: range, count of breaks, where its breaks are (behind them its pieces)."""

LINE = 4
"""Numbers of a straight piece: of an input term (degree, x0, y0, slope), of a set (two ends)."""


@kernel
def inferred(numbers: list[float], at: int, scratch: list[float], cell: int) -> float:
    """Return the crisp output of a rule base.

    Parameters
    ----------
    numbers : sequence of float
        Hold the rule base from index `at` on; all places in it are relative to `at`.
    at : int
        See `numbers`.
    scratch : sequence of float
        From index `cell` on the inputs, in order, and behind them room to work.
    cell : int
        See `scratch`.

    Returns
    -------
    float
        Where no rule fires the number that the rule base names (not a number for an error).
    """
    degrees = cell + int(numbers[at + INPUTS])
    strengths = degrees + int(numbers[at + DEGREES])
    members = int(numbers[at + MEMBERS])
    work = strengths + members
    for place in range(degrees, work):
        scratch[place] = 0.0
    fuzzify(numbers, at, scratch, cell, degrees)
    if not fire(numbers, at, scratch, degrees, strengths):
        return numbers[at + SILENT]
    if numbers[at + SAMPLES] > 0.0:
        return sampled_centroid(numbers, at, scratch, strengths, work)
    return exact_centroid(numbers, at, scratch, strengths, work)


@kernel
def concluded(numbers: list[float], scratch: list[float]) -> None:
    """Put the output of the rule base at the begin of `numbers` in the place of its inputs."""
    scratch[0] = inferred(numbers, 0, scratch, 0)


def inference_address(compiled: bool) -> int:
    """Return where kernels find :func:`concluded`."""
    return address_of(concluded, 2, compiled=compiled)


@kernel
def fuzzify(numbers: list[float], at: int, scratch: list[float], cell: int, degrees: int) -> None:
    """Write down how far each term of each input holds; inputs are clamped to their range."""
    head = at + int(numbers[at + INPUTS_AT])
    for place in range(cell, degrees):
        value = scratch[place]
        value = min(max(value, numbers[head]), numbers[head + 1])
        count = int(numbers[head + 2])
        breaks = at + int(numbers[head + 3])
        below = 0
        while below < count - 1 and numbers[breaks + below] < value:
            below += 1
        # Pieces alternate: a break, the stretch up to the next, and so on.
        piece = 2 * below
        if numbers[breaks + below] != value and below > 0:
            piece -= 1
        entry = breaks + count + 2 * piece
        line = at + int(numbers[entry])
        for _ in range(int(numbers[entry + 1])):
            scratch[degrees + int(numbers[line])] = numbers[line + 2] + numbers[line + 3] * (
                value - numbers[line + 1]
            )
            line += LINE
        head += INPUT_HEAD


@kernel
def fire(numbers: list[float], at: int, scratch: list[float], degrees: int, strengths: int) -> bool:
    """Raise the strength of each consequent to that of its strongest rule."""
    product = numbers[at + PRODUCT_AND] != 0.0
    any_fired = False
    place = at + int(numbers[at + RULES_AT])
    groups = int(numbers[place])
    place += 1
    for _ in range(groups):
        first = scratch[degrees + int(numbers[place])]
        rules = int(numbers[place + 1])
        after = at + int(numbers[place + 2])
        if first > 0.0:
            rule = place + 3
            for _ in range(rules):
                more = int(numbers[rule])
                strength = first
                for other in range(rule + 4, rule + 4 + more):
                    degree = scratch[degrees + int(numbers[other])]
                    strength = strength * degree if product else min(strength, degree)
                strength *= numbers[rule + 1]
                if strength > numbers[rule + 2]:
                    any_fired = True
                    member = strengths + int(numbers[rule + 3])
                    scratch[member] = max(scratch[member], strength)
                rule += 4 + more
        place = after
    return any_fired


@kernel
def sampled_centroid(
    numbers: list[float], at: int, scratch: list[float], strengths: int, work: int
) -> float:
    """Return the centroid over equally spaced samples; sets are zero outside their stretch."""
    samples = int(numbers[at + SAMPLES])
    head = at + int(numbers[at + OUTPUT_AT])
    moments = at + int(numbers[head])
    weights = at + int(numbers[head + 1])
    product = numbers[at + PRODUCT_THEN] != 0.0
    begin = samples
    end = 0
    entry = head + 2
    for member in range(strengths, work):
        if scratch[member] > 0.0:
            begin = min(begin, int(numbers[entry]))
            end = max(end, int(numbers[entry + 1]))
        entry += 3
    for i in range(begin, end):
        scratch[work + i] = 0.0
    entry = head + 2
    for member in range(strengths, work):
        strength = scratch[member]
        if strength > 0.0:
            start = int(numbers[entry])
            values = at + int(numbers[entry + 2]) - start
            if product:
                for i in range(start, int(numbers[entry + 1])):
                    scratch[work + i] = max(scratch[work + i], strength * numbers[values + i])
            else:
                for i in range(start, int(numbers[entry + 1])):
                    scratch[work + i] = max(scratch[work + i], min(strength, numbers[values + i]))
        entry += 3
    moment = 0.0
    area = 0.0
    for i in range(begin, end):
        moment += numbers[moments + i] * scratch[work + i]
        area += numbers[weights + i] * scratch[work + i]
    return moment / area if area > 0.0 else numbers[at + SILENT]


@kernel
def exact_centroid(
    numbers: list[float], at: int, scratch: list[float], strengths: int, work: int
) -> float:
    """Return the centroid of the upper envelope of the cut sets, integrated piece by piece."""
    lines = cut(numbers, at, scratch, strengths, work)
    events = work + LINE * lines
    count = 0
    for line in range(work, events, LINE):
        count = inserted(scratch, events, count, scratch[line])
        count = inserted(scratch, events, count, scratch[line + 2])
    moment = 0.0
    area = 0.0
    for k in range(events, events + count - 1):
        left = scratch[k]
        slope = -math.inf
        while left < scratch[k + 1]:
            best, slope, right = highest(scratch, work, events, left, scratch[k + 1], slope)
            width = right - left
            first = best
            last = best + slope * width
            part = 0.5 * width * (first + last)
            area += part
            moment += left * part + width * width * (first + 2.0 * last) / 6.0
            left = right
    return moment / area if area > 0.0 else numbers[at + SILENT]


@kernel
def cut(numbers: list[float], at: int, scratch: list[float], strengths: int, work: int) -> int:
    """Write down the straight pieces of all sets that fired, cut or scaled; return how many."""
    product = numbers[at + PRODUCT_THEN] != 0.0
    entry = at + int(numbers[at + OUTPUT_AT])
    place = work
    for member in range(strengths, work):
        strength = scratch[member]
        if strength > 0.0:
            piece = at + int(numbers[entry + 1])
            for _ in range(int(numbers[entry])):
                x_0, y_0 = numbers[piece], numbers[piece + 1]
                x_1, y_1 = numbers[piece + 2], numbers[piece + 3]
                piece += LINE
                if product:
                    place = put(scratch, place, x_0, strength * y_0, x_1, strength * y_1)
                elif max(y_0, y_1) <= strength:
                    place = put(scratch, place, x_0, y_0, x_1, y_1)
                elif min(y_0, y_1) >= strength:
                    place = put(scratch, place, x_0, strength, x_1, strength)
                else:
                    x = x_0 + (strength - y_0) * (x_1 - x_0) / (y_1 - y_0)
                    place = put(scratch, place, x_0, min(y_0, strength), x, strength)
                    place = put(scratch, place, x, strength, x_1, min(y_1, strength))
        entry += 2
    return (place - work) // LINE


@kernel
def put(scratch: list[float], place: int, x_0: float, y_0: float, x_1: float, y_1: float) -> int:
    """Append a piece unless it has no width or no height; return the place behind it."""
    if x_1 <= x_0 or (y_0 <= 0.0 and y_1 <= 0.0):
        return place
    scratch[place] = x_0
    scratch[place + 1] = y_0
    scratch[place + 2] = x_1
    scratch[place + 3] = y_1
    return place + LINE


@kernel
def inserted(scratch: list[float], events: int, count: int, x: float) -> int:
    """Insert a place into the sorted ones unless it is there; return how many there are."""
    k = events + count
    while k > events and scratch[k - 1] > x:
        k -= 1
    if k > events and scratch[k - 1] == x:
        return count
    for other in range(events + count, k, -1):
        scratch[other] = scratch[other - 1]
    scratch[k] = x
    return count + 1


@kernel
def highest(
    scratch: list[float], work: int, events: int, left: float, right: float, past: float
) -> tuple[float, float, float]:
    """Return height and slope of the envelope from `left` on, and up to where they hold.

    From one crossing to the next an envelope of lines gets steeper: only lines steeper
    than `past` count, so that rounding at a crossing does not bring the old line back.
    """
    best = 0.0
    steep = 0.0
    for line in range(work, events, LINE):
        if scratch[line] <= left and scratch[line + 2] >= right:
            slope = (scratch[line + 3] - scratch[line + 1]) / (scratch[line + 2] - scratch[line])
            y = scratch[line + 1] + slope * (left - scratch[line])
            if slope > past and (y > best or (y == best and slope > steep)):
                best = y
                steep = slope
    until = right
    for line in range(work, events, LINE):
        if scratch[line] <= left and scratch[line + 2] >= right:
            slope = (scratch[line + 3] - scratch[line + 1]) / (scratch[line + 2] - scratch[line])
            if slope > steep:
                y = scratch[line + 1] + slope * (left - scratch[line])
                x = left + (best - y) / (slope - steep)
                if left < x < until:
                    until = x
    return best, steep, until


# --- A rule base as the flat numbers that the kernel reads ---


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
    at = HEAD + INPUT_HEAD * len(rulebase.inputs)
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
        HEAD,
        rules_at,
        output_at,
    ]
    numbers = [*front, *heads, *inputs, *rules(rules_at), *sets(output_at)]
    pieces = sum(len(member.pieces) for member in target.members)
    # Cutting may split a piece in two; each end is an event.
    work = samples or 2 * LINE * pieces + 4 * pieces + 1
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
    if not SHAPES[shape.kind].straight or shape.kind == "singleton":
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
        return _Sections(parts, [[len(part) // LINE] for part in parts])
    count, sampling = output.defuzzifier.resolution, output.defuzzifier.sampling
    x = positions(output.low, output.high, count, sampling)
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
