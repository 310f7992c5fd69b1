"""Figures of describing functions and phase portraits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.apps.show.figures.style import (
    head,
    label_axes,
    line_style,
    new_figure,
    safe,
    tidy,
)
from fuzzyarm.base.picture import COLOURS
from fuzzyarm.control.loop.analysis import Portrait, describing_function
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzyarm.control.controllers.text import ControllerText


def describing_figure(
    thing: AnyRuleBase | ControllerText,
    amplitudes: Sequence[float] | None = None,
    frequencies: Sequence[float] | None = None,
) -> Figure:
    """Return gain and phase of the describing function over the amplitude of the error.

    Parameters
    ----------
    thing : RuleBase or ControllerText
        See :func:`fuzzyarm.control.loop.describing_function`.
    amplitudes : sequence of float, optional
        By default from a hundredth to twice the range of the error.
    frequencies : sequence of float, optional
        rad/s, a line for each; by default 0 for one input, otherwise four values.
    """
    if isinstance(thing, AnyRuleBase):
        thing = thing.model
    one = isinstance(thing, RuleBase) and len(thing.inputs) == 1
    if amplitudes is None:
        reach = max(abs(thing.inputs[0].low), abs(thing.inputs[0].high)) if isinstance(
            thing, RuleBase) else 1.0  # fmt: skip
        amplitudes = np.geomspace(0.01 * reach, 2.0 * reach, 60).tolist()
    if frequencies is None:
        frequencies = [0.0] if one else [0.0, 0.5, 1.0, 2.0]
    figure = new_figure(6.4, 5.0)
    gain, phase = figure.subplots(2, 1, sharex=True)
    for index, frequency in enumerate(frequencies):
        values = describing_function(thing, amplitudes, frequency)
        words = {"label": f"{frequency:g} rad/s", **line_style(index)}
        gain.semilogx(amplitudes, np.abs(values), linewidth=1.6, **words)
        phase.semilogx(amplitudes, np.degrees(np.angle(values)), linewidth=1.6, **words)
    for axes in (gain, phase):
        tidy(axes)
    label_axes(gain, "", "|N|")
    label_axes(phase, "amplitude of the error", "phase of N, degrees")
    if len(frequencies) > 1:
        gain.legend(fontsize=8, frameon=False)
    name = thing.name if isinstance(thing, RuleBase) else thing.model.name
    head(figure, f"Describing function of {name}", size=10, weight="normal")
    return figure


def portrait_figure(portrait: Portrait) -> Figure:
    """Return motions in the plane, each with its start, over the vector field.

    Parameters
    ----------
    portrait : Portrait
        From :func:`fuzzyarm.control.loop.phase_portrait`.
    """
    figure = new_figure(6.4, 5.2)
    axes = figure.subplots()
    if portrait.field is not None:
        axes.streamplot(*portrait.field, color="#cccccc", linewidth=0.7, arrowsize=0.7, density=1.1)
    for path in portrait.paths:
        axes.plot(path[:, 0], path[:, 1], color=COLOURS[0], linewidth=1.2)
        axes.plot(*path[0], "o", color=COLOURS[0], markersize=4)
    if np.isnan(portrait.target[1]):
        axes.axvline(portrait.target[0], color=COLOURS[3], linewidth=1.0, linestyle="--")
    else:
        axes.plot(*portrait.target, "+", color=COLOURS[3], markersize=11, markeredgewidth=2)
    tidy(axes)
    label_axes(axes, safe(portrait.x), safe(portrait.y))
    head(figure, f"Phase portrait: {portrait.name}", size=10, weight="normal")
    return figure
