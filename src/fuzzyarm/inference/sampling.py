"""Where a sampled defuzzifier looks, in plain Python and over arrays alike."""

from __future__ import annotations

from fuzzyarm.inference.errors import InferenceError


def places(low: float, high: float, count: int, sampling: str) -> list[float]:
    """Return the sample points over a range.

    Parameters
    ----------
    low, high : float
        The range.
    count : int
        Number of samples N.
    sampling : str
        ``endpoints`` and ``trapezoid``: N points with both ends; ``midpoints``: the
        middles of N equal stretches; ``left``: their left ends.

    Returns
    -------
    list of float
        In order.

    Raises
    ------
    InferenceError
        If there are too few samples.
    """
    both_ends = sampling in {"endpoints", "trapezoid"}
    if count < (2 if both_ends else 1):
        raise InferenceError(f"a defuzzifier cannot work with {count} samples at {sampling}")
    width = high - low
    if both_ends:
        return [low + width * (i / (count - 1)) for i in range(count - 1)] + [high]
    shift = 0.5 if sampling == "midpoints" else 0.0
    return [low + width * ((i + shift) / count) for i in range(count)]


def weights(count: int, sampling: str) -> list[float]:
    """Return the weight of each sample in a sum: 1, or ½ at the ends of ``trapezoid``."""
    if sampling != "trapezoid":
        return [1.0] * count
    return [0.5, *[1.0] * (count - 2), 0.5]
