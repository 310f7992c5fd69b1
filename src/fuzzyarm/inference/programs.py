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


AT_POINT: dict[Callable[..., Any], Callable[..., Any]] = {
    enveloped.enveloped_centroid: enveloped.whole_envelope,
    integrated.integrated_centroid: integrated.integral_of_point,
    integrated.integrated_bisector: integrated.bisector_of_point,
    positions.sampled_position: positions.position_of_samples,
    positions.joined_samples: positions.position_of_joined,
    positions.exact_maxima: positions.position_of_maxima,
    positions.position_of_rows: positions.choice_of_values,
    reduced.ends_of_rows: reduced.ends_of_values,
    reduced.karnik_mendel_samples: reduced.ends_of_samples,
    reduced.karnik_mendel_envelope: reduced.ends_of_envelopes,
    reduced.karnik_mendel_integral: reduced.ends_of_integrals,
    reduced.nie_tan_envelope: reduced.sum_of_envelopes,
    reduced.nie_tan_integral: reduced.sum_of_integrals,
}
"""What defuzzifiers do at one point: numbers of the layout and of the room in, total and value (or
moment) out. Exported programs are printed from these."""

IN_ROWS: tuple[Callable[..., Any], ...] = (positions.position_of_rows, reduced.ends_of_rows)
"""Defuzzifiers of values that somebody else has found: exported programs alone have them."""
