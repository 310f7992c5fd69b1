"""The texts of a figure as they are drawn: their boxes, and which of them run into each other."""

from __future__ import annotations

from itertools import combinations
from unittest import mock

from matplotlib.text import Text


def drawn_boxes(figure):
    """Draw `figure` (no file is made of it) and return each text with its box in pixels."""
    boxes = []
    draw = Text.draw

    def noted(self, renderer):
        draw(self, renderer)
        if self.get_visible() and self.get_text().strip():
            boxes.append((self.get_text(), Text.get_window_extent(self, renderer)))

    with mock.patch.object(Text, "draw", noted):
        figure.canvas.draw()
    return boxes


def faults(figure, slack=1.0):
    """Return pairs of texts whose boxes overlap by more than `slack` pixels, and texts outside."""
    boxes, edge = drawn_boxes(figure), figure.bbox
    found = [
        text
        for text, box in boxes
        if min(box.x0 - edge.x0, edge.x1 - box.x1, box.y0 - edge.y0, edge.y1 - box.y1) < -slack
    ]
    for (one, a), (other, b) in combinations(boxes, 2):
        across, up = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        if min(across, up) > slack:
            found.append((one, other))
    return found
