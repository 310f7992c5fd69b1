"""Tables of every kind for the property-based tests."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from fuzzyarm.table import Axis, LookupTable

finite = st.floats(-1e6, 1e6, allow_nan=False, allow_infinity=False)
any_finite = st.floats(allow_nan=False, allow_infinity=False)
names = st.text(min_size=1, max_size=6) | st.sampled_from(["e", "ce", "ė", "index", "step", "a b"])
texts = st.text(max_size=20)


@st.composite
def axes(draw: st.DrawFn, name: str) -> Axis:
    levels = sorted(draw(st.lists(finite, min_size=1, max_size=5, unique=True)))
    levels = sorted({x + 0.0 for x in levels})
    bins = None
    if len(levels) > 1 and draw(st.booleans()):
        size = len(levels) - 1
        bins = sorted(draw(st.lists(finite, min_size=size, max_size=size, unique=True)))
        bins = bins if len({x + 0.0 for x in bins}) == size else None
    low, high = levels[0], levels[-1]
    if draw(st.booleans()):
        low, high = draw(st.sampled_from([(low - 1.0, high + 2.5), (-math.inf, math.inf)]))
    return Axis(name, tuple(levels), bins and tuple(bins), low, high, draw(texts))


@st.composite
def tables(draw: st.DrawFn, max_axes: int = 4) -> LookupTable:
    count = draw(st.integers(1, max_axes))
    labels = draw(st.lists(names, min_size=count + 1, max_size=count + 1, unique=True))
    parts = tuple(draw(axes(label)) for label in labels[1:])
    size = math.prod(len(axis.levels) for axis in parts)
    number = draw(st.sampled_from([any_finite, st.integers(-60, 60).map(lambda k: k / 10)]))
    values = draw(st.lists(number, min_size=size, max_size=size))
    import numpy as np

    bounded = draw(st.booleans())
    return LookupTable(
        parts,
        labels[0],
        np.array(values, dtype=float).reshape([len(axis.levels) for axis in parts]),
        low=-6.0 if bounded else None,
        high=draw(st.sampled_from([6.0, math.inf])) if bounded else None,
        description=draw(texts),
        rounding=draw(st.sampled_from([None, 0.1, 1 / 3])),
        mode=draw(st.sampled_from([None, "bins", "nearest", "linear"])),
        provenance=tuple(draw(st.lists(st.tuples(names, texts), max_size=3))),
    )
