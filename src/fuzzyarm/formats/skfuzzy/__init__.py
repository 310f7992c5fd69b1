"""scikit-fuzzy: a ``ControlSystem`` to a rule base and back.

scikit-fuzzy keeps a term as numbers over the points of its universe and draws straight
lines between them, so a term comes over as ``points`` and is exactly the same function.
Its centroid is the exact one of the clipped terms, but joins their union between the points
of the universe (and of the cuts) by straight lines: where two terms cross between two
points, it differs from the integral by a triangle of that width. docs/formats.md has more.

This is the one part of the package that needs array libraries, inside its functions.
"""

from fuzzyarm.formats.skfuzzy.reader import from_skfuzzy
from fuzzyarm.formats.skfuzzy.writer import to_skfuzzy

__all__ = ["from_skfuzzy", "to_skfuzzy"]
