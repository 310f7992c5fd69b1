"""A closed loop around its rest: a linear part, uncertain gains, and where both are the loop.

    z' = A z + B w (each period, or as a rate),   |wₖ| ≤ |Cₖ z + Dₖ w|,   low ≤ g z + h w ≤ high

z is how far states and memory are from rest, w are the answers of the blocks. All matrices are
rational; what a matrix exponential leaves unknown is a radius beside A and B. That this is the
loop, within the bounds, is the basis of a certificate; the search reads the same numbers as
floats and is not trusted.

It is made in :mod:`fuzzyarm.proof.loop.form_maker`.
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
    """The assumptions of a form; the smaller they are, the nearer to linear it is."""

    share: Fraction = ONE  # of the universes of rule bases: how far their inputs may go
    grip: Fraction = ONE  # what limits leave of a signal's deviation; 1: they are not reached
    # By state of the plant, how far it may be from rest; empty for a plant that is affine
    box: Mapping[str, Fraction] = field(default_factory=dict)
    # Whether a rule base is a gain times the sum of its inputs that its linear law has, or a sum of
    # its own slopes along each input
    along: bool = True
    # Of the inputs of rule bases that move, in the order of the program: on which side of its rest
    # each is, 0 for both; empty: all are on both
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
    rest: Mapping[str, Fraction]  # of each of them
    a: Matrix  # a, b: of the next z, or of its rate; shapes (n, n) and (n, m)
    b: Matrix
    radius: Matrix  # how far the true ``[a b]`` may be from these numbers; shape (n, n + m)
    blocks: Matrix  # ``[Cₖ Dₖ]`` of each block; Dₖ reads the answers of blocks before it only
    words: tuple[str, ...]  # what each block is
    bounds: tuple[SignalBound, ...]  # where the form is the loop
    outputs: Mapping[Address, Affine]  # outputs and inputs of the plant, by axis and port
    seeds: Mapping[str, Affine]  # initial memory as a function of the plant's states
    period: float  # s; 0 for a loop in continuous time
    evidence: Evidence | None = None  # what a certificate says of it
    # ``[g h]`` of the inputs of rule bases that move, in the order of the program
    inputs: Matrix = ()
    edges: tuple[bool, ...] = ()  # whether the rules may have an edge where each of them rests
    # On which side of its rest each of them is, see :class:`Assumptions`
    signs: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        """How many states."""
        return len(self.names)

    def is_same_loop(self, other: Form) -> bool:
        """Tell whether another form differs in what it grants at most."""
        return replace(self, evidence=None) == replace(other, evidence=None)

    @cached_property
    def system(self) -> System:
        """The same for the checker."""
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
        """Return rows g over z alone with |g z| ≤ limit, which say that all bounds hold.

        An answer is linear in its gain δ, so the largest value is at δ = -1 or 1 of each block.
        """
        rows = []
        for bound in self.bounds:
            rows += [(row, bound.limit, bound.words) for row in self.rows_of(bound.signal)]
        return list(dict.fromkeys(rows))

    def rows_of(self, signal: Affine) -> list[tuple[Fraction, ...]]:
        """Return rows g over z alone: a signal is as far from its constant as the largest |g z|."""
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
