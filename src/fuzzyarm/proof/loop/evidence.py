"""What a certificate says of a loop beside its function V: records, to be checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

__all__ = ["Evidence", "Gains"]


class Gains(NamedTuple):
    """What is claimed of one output of a rule base, or of a table, for its inputs in a region.

    Attributes
    ----------
    region : dict of str to (Fraction, Fraction)
        Of the inputs that move.
    between : (Fraction, Fraction)
        Where the output lies there.
    weights : dict of str to Fraction
        Of the inputs in σ, where the output is σ times one gain; empty: it has slopes.
    gains : dict of str to (Fraction, Fraction)
        The gain along σ, by ``""``; or the slopes, by input.
    """

    region: Mapping[str, tuple[Fraction, Fraction]]
    between: tuple[Fraction, Fraction]
    weights: Mapping[str, Fraction]
    gains: Mapping[str, tuple[Fraction, Fraction]]


@dataclass(frozen=True)
class Evidence:
    """What a certificate says of a loop, to be checked.

    Attributes
    ----------
    memory : dict of str to str
        By the name of a row of P, the symbol of the program that it is; states of the plant are
        not there.
    rest : dict of str to (Fraction, Fraction)
        By the name of a row of P, the middle and the radius of an interval that holds its rest.
    gains : tuple of Gains
        In the order of the program.
    spread : tuple of (int, int, Fraction, Fraction)
        Which entries of the plant's matrix are uncertain gains, and between what they are.
    grip : Fraction
        What limits leave of a signal's deviation at least; 1: they are not reached.
    box : dict of str to Fraction
        By state of a plant that is not affine, how far it may be from rest.
    """

    memory: Mapping[str, str]
    rest: Mapping[str, tuple[Fraction, Fraction]]
    gains: tuple[Gains, ...]
    spread: tuple[tuple[int, int, Fraction, Fraction], ...]
    grip: Fraction
    box: Mapping[str, Fraction]
