"""A controller proved with its plant: stable, inside, reached."""

from fuzzyarm.closed_loop.problem import LoopProofError, loop_problem
from fuzzyarm.closed_loop.tube import Demand, Tube, tube

__all__ = ["Demand", "LoopProofError", "Tube", "loop_problem", "tube"]
