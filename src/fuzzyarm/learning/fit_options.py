"""How a model is found."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzyarm.base.keywords import demand_arguments


@dataclass(frozen=True)
class Options:
    """How a model is found.

    Attributes
    ----------
    method : str
        ``sugeno`` or ``wang-mendel``.
    start : str
        Start of a Sugeno model: ``grid``, ``fcm`` or ``subtractive``.
    rules : int
        Largest number of rules of a Sugeno model.
    terms : tuple of int or None
        Terms of each input of a grid; None: chosen by cross-validation.
    words : tuple of int
        The fewest and the most words of Wang and Mendel; cross-validation chooses.
    shrinkage : float or None
        Of consequents towards the linear model; None: by cross-validation.
    move : bool or None
        Whether the terms are moved by variable projection; None: if cross-validation favours it.
    merge : float
        Similarity from which gaussians of clusters are merged, see
        :func:`~fuzzyarm.learning.starts.merged`.
    series : bool
        Whether the samples are in the order of time.
    parts : int
        Number of parts of the cross-validation.
    digits : int
        Digits of the numbers of terms; more if rounding matters.
    outside : str
        ``extend``, ``clamp`` or ``error``: treatment of inputs outside the ranges by a Sugeno
        model.
    evaluations : int
        Largest number of evaluations of the model while terms move.
    seed : int
        Seed of all random numbers.
    nested : bool or None
        Whether the whole way is judged by a cross-validation around it; None: up to
        1000 samples, where the choice of a structure makes a difference.
    seconds : float
        Wall time, at most; the best until then is taken.
    name, description : str
        Name and description of the rule base.
    """

    method: str = "sugeno"
    start: str = "grid"
    rules: int = 16
    terms: tuple[int, ...] | None = None
    words: tuple[int, int] = (7, 7)
    shrinkage: float | None = None
    move: bool | None = None
    merge: float = 0.7
    series: bool = False
    parts: int = 5
    digits: int = 4
    outside: str = "extend"
    evaluations: int = 80
    seed: int = 0
    nested: bool | None = None
    seconds: float = math.inf
    name: str = "model"
    description: str = ""

    def __post_init__(self) -> None:
        demand_arguments("Options", vars(self), type(self))
