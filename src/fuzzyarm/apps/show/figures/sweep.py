"""A metric of many runs over the swept values: a curve, or a map with the border of divergence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.figures.panels import chart_figure
from fuzzyarm.apps.show.sweep import sweep_chart

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzyarm.control.loop.many import Many
    from fuzzyarm.control.loop.sweep import Range


def sweep_figure(results: Sequence[Many], over: Sequence[Range], metric: str = "rms") -> Figure:
    """Draw a metric over one or two of the swept names; see :func:`sweep_chart`."""
    return chart_figure(sweep_chart(results, over, metric))
