"""The kernels that take a block: what evaluates one, and what a layout names in it by number."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fuzzyarm.inference import enveloped, integrated, kernel, positions, reduced

BLOCKS: tuple[Callable[..., Any], ...] = (
    kernel.evaluate,
    kernel.sweep,
    kernel.run,
    kernel.closed_centroid,
    kernel.weighted,
    enveloped.sampled_centroid,
    enveloped.enveloped_centroid,
    integrated.integrated_centroid,
    integrated.integrated_bisector,
    positions.sampled_position,
    positions.joined_samples,
    positions.exact_maxima,
    positions.weighted_values,
    positions.position_of_values,
    reduced.karnik_mendel_values,
    reduced.karnik_mendel_samples,
    reduced.karnik_mendel_envelope,
    reduced.karnik_mendel_integral,
    reduced.nie_tan_samples,
    reduced.nie_tan_envelope,
    reduced.nie_tan_integral,
)
"""The first two evaluate a block, see :mod:`fuzzyarm.inference.kernel`; the others are called."""
