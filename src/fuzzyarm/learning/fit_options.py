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
        Of a Sugeno model: ``grid``, ``fcm`` or ``subtractive``.
    rules : int
        Of a Sugeno model, at most.
    terms : tuple of int or None
        Terms of each input of a grid; None: chosen by cross-validation.
    words : tuple of int
        The fewest and the most words of Wang and Mendel; cross-validation chooses.
    shrinkage : float or None
        Of consequents towards the linear model; None: chosen by cross-validation.
    move : bool or None
        Whether the terms are moved by variable projection; None: where cross-validation
        says that it pays.
    merge : float
        How much alike gaussians of clusters must be to become one, see
        :func:`~fuzzyarm.learning.starts.merged`.
    series : bool
        Whether the samples are in the order of time.
    parts : int
        Of the cross-validation.
    digits : int
        Of the numbers of terms; more are taken where rounding would show.
    outside : str
        ``extend``, ``clamp`` or ``error``: what a Sugeno model does beyond its ranges.
    evaluations : int
        Of the model while its terms are moved, at most.
    seed : int
        Of all that is drawn.
    nested : bool or None
        Whether the whole way is judged by a cross-validation around it; None: up to
        1000 samples, where the choice of a structure makes a difference.
    seconds : float
        Wall time, at most; the best until then is taken.
    name, description : str
        Of the rule base.
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
