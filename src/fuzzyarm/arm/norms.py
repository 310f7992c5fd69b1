"""Error norms of a run (section 3.4)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def rms(errors: Vector) -> Vector:
    """Return the root of the mean square of each column.

    Parameters
    ----------
    errors : ndarray, shape (n, 2)
        Samples of the tracking error; no samples give not a number.
    """
    return np.asarray(np.sqrt(np.mean(np.square(errors), axis=0))) if len(errors) else _none(errors)


def final(errors: Vector) -> Vector:
    """Return the last error of each column; without samples not a number."""
    return np.asarray(errors[-1]) if len(errors) else _none(errors)


def signed_maximum(errors: Vector, kind: Literal["magnitude", "positive"] = "magnitude") -> Vector:
    """Return the largest error of each column.

    Parameters
    ----------
    errors : ndarray, shape (n, 2)
        Samples of the tracking error; no samples give not a number.
    kind : {"magnitude", "positive"}
        The error of largest magnitude with its sign, or the most positive one.
    """
    if not len(errors):
        return _none(errors)
    if kind == "positive":
        return np.asarray(errors.max(axis=0))
    rows = np.abs(errors).argmax(axis=0)
    return np.asarray(errors[rows, np.arange(errors.shape[1])])


def _none(errors: Vector) -> Vector:
    return np.full(errors.shape[1], np.nan)
