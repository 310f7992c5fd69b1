"""A controller proved with its plant: stable, inside, reached."""

from typing import TYPE_CHECKING

from fuzzyarm.closed_loop.problem import LoopProofError, loop_problem
from fuzzyarm.closed_loop.tube import Demand, Tube, tube
from fuzzyarm.lazy import lazily

__all__ = ["Demand", "LoopProofError", "Tube", "loop_problem", "tube"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
