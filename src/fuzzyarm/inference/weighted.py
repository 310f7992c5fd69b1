"""The position of a firing strength in a monotonic set: Tsukamoto's consequents."""

from __future__ import annotations

import math
from itertools import pairwise

from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.sets import bisect
from fuzzyarm.symbolic.kinds import SHAPES


def tsukamoto_position(plan: OutputPlan, member: Member, strength: float) -> float:
    """Return the position where the set of `member` reaches `strength`; else the nearest one."""
    shape = member.term.shape
    inverse = SHAPES[shape.kind].position_of
    if inverse is not None and not member.hedges:
        position = inverse(min(1.0, strength / shape.height), *shape.parameters)
        return position if math.isfinite(position) else _end(plan, position)
    return _on_pieces(plan, member, strength)


def _end(plan: OutputPlan, position: float) -> float:
    return plan.output.high if position > 0.0 else plan.output.low


def is_rising(plan: OutputPlan, member: Member) -> bool:
    """Return whether a set rises over the range of its output; it must rise or fall."""
    values = [value for piece in member.pieces for value in (piece.y0, piece.y1)]
    steps = [b - a for a, b in pairwise(values) if abs(b - a) > 1e-12]
    if steps and (min(steps) > 0.0 or max(steps) < 0.0):
        return steps[0] > 0.0
    raise InferenceError(
        f"'{plan.output.name} is {member.term.name}' neither rises nor falls over the range,"
        " so tsukamoto cannot invert it"
    )


def _on_pieces(plan: OutputPlan, member: Member, strength: float) -> float:
    pieces = member.pieces if is_rising(plan, member) else member.pieces[::-1]
    for piece in pieces:
        start, end = (piece.x0, piece.x1) if pieces is member.pieces else (piece.x1, piece.x0)
        first, last = (piece.y0, piece.y1) if pieces is member.pieces else (piece.y1, piece.y0)
        if first >= strength:
            return start
        if last >= strength:
            if piece.straight:
                return start + (end - start) * (strength - first) / (last - first)
            return bisect(member.membership, piece.x0, piece.x1, strength)
    return plan.output.high if pieces is member.pieces else plan.output.low
