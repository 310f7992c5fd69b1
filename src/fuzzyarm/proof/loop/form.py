"""A closed loop around its rest: a linear part, uncertain gains, and bounds of their validity.

    z' = A z + B w (each period, or as a rate),   |wₖ| ≤ |Cₖ z + Dₖ w|,   low ≤ g z + h w ≤ high

z is the deviation of states and memory from rest, w are the answers of the blocks. All matrices are
rational; the error of a matrix exponential is a radius beside A and B. A certificate rests on the
equality of form and loop within the bounds; the search uses the same numbers as floats and is not
trusted.

Forms are built in :mod:`fuzzyarm.proof.loop.form_maker`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.check.certificate import Evidence
from fuzzyarm.proof.check.loop import System
from fuzzyarm.proof.check.numbers import around, exact
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.loop.affine import ONE, ZERO, Affine, SignalBound

Matrix = tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Assumptions:
    """The assumptions of a form; the smaller they are, the closer it is to linear."""

    share: Fraction = ONE  # range of rule bases' inputs, as a share of their universes
    grip: Fraction = ONE  # least share of a deviation that passes a limit; 1: none is reached
    # Largest deviation of each state of the plant; empty for an affine plant
    box: Mapping[str, Fraction] = field(default_factory=dict)
    # Whether a rule base is one gain along the weighted input sum of its linear law, or has a slope
    # along each input
    along: bool = True
    # The side of its rest for each moving input of rule bases, in the order of the program; 0:
    # both; empty: both for all
    signs: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        halves = self.box.values()
        if not (0 < self.share <= 1 and 0 < self.grip <= 1 and all(half > 0 for half in halves)):
            raise LoopProofError("a share, a grip or a box that is out of range")


@dataclass(frozen=True)
class Form:
    """A loop as matrices; see the head of this module."""

    # Of z: states of the plant, then memory of controller, sensors and actuators
    names: tuple[str, ...]
    rest: Mapping[str, Fraction]  # of each
    a: Matrix  # a, b: of the next z, or of its rate; shapes (n, n) and (n, m)
    b: Matrix
    radius: Matrix  # error of ``[a b]``; shape (n, n + m)
    blocks: Matrix  # ``[Cₖ Dₖ]`` of each block; Dₖ uses answers of earlier blocks only
    words: tuple[str, ...]  # each block in words
    bounds: tuple[SignalBound, ...]  # conditions of validity
    outputs: Mapping[Address, Affine]  # outputs and inputs of the plant, by axis and port
    seeds: Mapping[str, Affine]  # initial memory as a function of the plant's states
    period: float  # s; 0 for a loop in continuous time
    evidence: Evidence | None = None  # its description in a certificate
    # ``[g h]`` of the moving inputs of rule bases, in the order of the program
    inputs: Matrix = ()
    edges: tuple[bool, ...] = ()  # whether the rules may have an edge at its rest
    # The side of its rest for each, see :class:`Assumptions`
    signs: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.names)

    def is_same_loop(self, other: Form) -> bool:
        """Return whether another form differs in its bounds at most."""
        return replace(self, evidence=None) == replace(other, evidence=None)

    @cached_property
    def system(self) -> System:
        """The system for the checker."""
        move = [
            [around(exact(x), exact(far)) if far else exact(x)
             for x, far in zip([*a, *b], radius, strict=True)]
            for a, b, radius in zip(self.a, self.b, self.radius, strict=True)
        ]  # fmt: skip
        return System(
            size=self.size,
            move=move,
            blocks=[list(map(exact, row)) for row in self.blocks],
            rows=tuple(
                (list(map(exact, self.row(bound.signal))), exact(bound.limit), bound.words)
                for bound in self.bounds
            ),
            period=self.period,
            sides=tuple(list(map(exact, row)) for row in self.sides),
        )

    @cached_property
    def sides(self) -> Matrix:
        """``[g h]`` of signals that are not negative."""
        signed = zip(self.inputs, self.signs, strict=False)
        return tuple(tuple(x * sign for x in row) for row, sign in signed if sign)

    def row(self, signal: Affine) -> tuple[Fraction, ...]:
        """Return the weights of z and w in a signal."""
        return row_of(signal, self.names, len(self.blocks))

    def rows_within(self) -> list[tuple[tuple[Fraction, ...], Fraction, str]]:
        """Return rows g over z alone: |g z| ≤ limit keeps all bounds.

        An answer is linear in its gain δ, so the largest value is at δ = -1 or 1 of each block.
        """
        rows = []
        for bound in self.bounds:
            rows += [(row, bound.limit, bound.words) for row in self.rows_of(bound.signal)]
        return list(dict.fromkeys(rows))

    def rows_of(self, signal: Affine) -> list[tuple[Fraction, ...]]:
        """Return rows g over z alone: the largest |g z| is the largest deviation of a signal."""
        return _without_answers(self.row(signal), self.size, self.blocks)


def row_of(signal: Affine, names: Sequence[str], answers: int) -> tuple[Fraction, ...]:
    """Return the weights of variables and of answers in a signal."""
    every = [*names, *(f"w{k}" for k in range(answers))]
    if unknown := set(signal.parts) - set(every):
        raise LoopProofError(f"a signal depends on {', '.join(sorted(unknown))}")
    return tuple(signal.parts.get(name, ZERO) for name in every)


def _without_answers(
    row: tuple[Fraction, ...], size: int, blocks: Matrix
) -> list[tuple[Fraction, ...]]:
    last = next((k for k in range(len(row) - 1, size - 1, -1) if row[k]), None)
    if last is None:
        return [row[:size]]
    answered = blocks[last - size]
    rows = []
    for sign in (-1, 1):
        weight = sign * row[last]
        with_it = [r + weight * v for r, v in zip(row[:last], answered[:last], strict=True)] + [
            ZERO
        ] * (len(row) - last)
        rows += _without_answers(tuple(with_it), size, blocks)
    return rows
