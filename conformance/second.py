"""The same numbers a second way: in decimals of 50 digits, by what an integral and a maximum are.

It shares no line with `exact`: membership is written as the formulas of textbooks, integrals are
found by halving panels until Boole's rule agrees with itself, maxima by narrowing the cells of a
grid, the ends of an interval type-2 centroid by Karnik and Mendel's iteration. It knows no corner
and no crossing.
"""

from __future__ import annotations

import decimal
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from typing import Any

decimal.getcontext().prec = 50

Case = Mapping[str, Any]
Curve = Callable[[Decimal], Decimal]

D = Decimal
ZERO, ONE, TWO = D(0), D(1), D(2)
PANELS = 96  # of a range to begin with
NARROWEST = D(10) ** -24  # of a range: a jump within counts nothing
AGREED = D(10) ** -22
CELLS = 600  # of a range, in which a maximum is looked for


# --- degrees


def slope(x: Decimal, foot: Decimal, top: Decimal) -> Decimal:
    """Return the straight rise (or fall) from 0 at foot to 1 at top, without limits."""
    if foot == top:
        return ONE if x == top else D("Infinity") * (1 if x > top else -1)
    return (x - foot) / (top - foot)


def edge(x: Decimal, a: Decimal, b: Decimal, c: Decimal, d: Decimal) -> Decimal:
    """Return a trapezoid as the least of its two sides and 1."""
    rising = slope(x, a, b) if a < b else (ONE if x >= b else ZERO)
    falling = (d - x) / (d - c) if c < d else (ONE if x <= c else ZERO)
    return max(ZERO, min(ONE, rising, falling))


def polyline(x: Decimal, points: Sequence[Sequence[Decimal]]) -> Decimal:
    """Return the height of a polyline: the greatest of the segments that reach x."""
    heights = [D(p[1]) for p in points if p[0] == x]
    for (x0, y0), (x1, y1) in zip(points, points[1:], strict=False):
        if x0 < x < x1:
            heights.append((y0 * (x1 - x) + y1 * (x - x0)) / (x1 - x0))
    if not heights:
        heights = [points[0][1] if x < points[0][0] else points[-1][1]]
    return max(heights)


def parabolas(x: Decimal, a: Decimal, b: Decimal) -> Decimal:
    """Return MATLAB's smf."""
    if x <= a:
        return ZERO
    if x <= (a + b) / 2:
        return 2 * ((x - a) / (b - a)) ** 2
    return ONE - 2 * ((x - b) / (b - a)) ** 2 if x <= b else ONE


SHAPES: dict[str, Callable[..., Decimal]] = {
    "triangle": lambda x, a, b, c: edge(x, a, b, b, c),
    "trapezoid": edge,
    "rectangle": lambda x, a, b: ONE if a <= x <= b else ZERO,
    "ramp": lambda x, a, b: max(ZERO, min(ONE, slope(x, a, b))),
    "points": lambda x, *points: polyline(x, points),
    "s": parabolas,
    "z": lambda x, a, b: ONE - parabolas(x, a, b),
    "pi": lambda x, a, b, c, d: parabolas(x, a, b) * (ONE - parabolas(x, c, d)),
    "gaussian": lambda x, m, s: (-(((x - m) / s) ** 2) / 2).exp(),
    "sigmoid": lambda x, i, s: ONE / (ONE + (s * (i - x)).exp()),
    "bell": lambda x, c, w, s: ONE / (ONE + abs((x - c) / w) ** (2 * s)),
}


def membership(term: Case, x: Decimal) -> Decimal:
    """Return the degree of a term."""
    return D(term.get("height", ONE)) * SHAPES[term["shape"]](x, *term["parameters"])


def tnorm(name: str, a: Decimal, b: Decimal) -> Decimal:  # noqa: PLR0911 - one to a norm
    """Return a T-norm."""
    if name == "minimum":
        return min(b, a)
    if name == "product":
        return a * b
    if name == "lukasiewicz":
        return a + b - ONE if a + b > ONE else ZERO
    if name == "drastic":
        return b if a == ONE else a if b == ONE else ZERO
    if name == "nilpotent":
        return (min(b, a)) if a + b > ONE else ZERO
    if name == "hamacher":
        return ZERO if a == b == ZERO else a * b / (a + b - a * b)
    return a * b / (ONE + (ONE - a) * (ONE - b))


def snorm(name: str, a: Decimal, b: Decimal) -> Decimal:
    """Return an S-norm: the dual of the T-norm of its name, or a sum."""
    if name == "sum":
        return a + b
    dual = {"maximum": "minimum", "probabilistic sum": "product"}.get(name, name)
    if name == "nilpotent":
        return (max(b, a)) if a + b < ONE else ONE
    return ONE - tnorm(dual, ONE - a, ONE - b)


def held(case: Case, tree: Case, point: Mapping[str, Decimal], side: str) -> Decimal:
    """Return the degree of a condition, of the lower or the upper functions."""
    word = next(iter(tree))
    parts = tree[word]
    if word == "is":
        name, label = parts
        term = case["inputs"][name]["terms"][label]
        lower = side == "lower" and "lower" in term
        return membership(term["lower"] if lower else term, point[name])
    if word == "not":
        return ONE - held(case, parts, point, "upper" if side == "lower" else "lower")
    if word == "very":
        return held(case, parts, point, side) ** 2
    total = held(case, parts[0], point, side)
    for part in parts[1:]:
        other = held(case, part, point, side)
        join = tnorm if word == "and" else snorm
        total = join(case["settings"][word], total, other)
    return total


def fired(
    case: Case, output: str, point: Mapping[str, Decimal], side: str
) -> list[tuple[Case, Decimal]]:
    """Return the terms that rules conclude, and how strongly; those of strength 0 too."""
    return [
        (
            case["outputs"][output]["terms"][rule["then"][output]],
            held(case, rule["if"], point, side) * D(rule.get("weight", ONE)),
        )
        for rule in case["rules"]
        if output in rule["then"]
    ]


def aggregate(case: Case, rules: Sequence[tuple[Case, Decimal]], side: str) -> Curve:
    """Return the aggregated set as a function."""
    settings = case["settings"]
    listed = [
        (term["lower"] if side == "lower" and "lower" in term else term, s)
        for term, s in rules
        if s
    ]

    def at(y: Decimal) -> Decimal:
        total = ZERO
        for term, s in listed:
            height = tnorm(settings["implication"], membership(term, y), s)
            total = snorm(settings["aggregation"], total, height)
        return total

    return at


# --- integrals and maxima


BOOLE = (D(7), D(32), D(12), D(32), D(7))


def integrals(f: Curve, low: Decimal, high: Decimal) -> tuple[Decimal, Decimal]:
    """Return the area of f and its moment about 0."""
    area = moment = ZERO
    step = (high - low) / PANELS
    todo = [(low + k * step, low + (k + 1) * step, None) for k in range(PANELS)]
    while todo:
        a, b, known = todo.pop()
        h = (b - a) / 8
        xs = [a + k * h for k in range(9)]
        ys = [f(x) for x in xs] if known is None else _between(f, xs, known)
        whole = _boole(xs[::2], ys[::2])
        left, right = _boole(xs[:5], ys[:5]), _boole(xs[4:], ys[4:])
        halves = left[0] + right[0], left[1] + right[1]
        off = max(abs(halves[0] - whole[0]), abs(halves[1] - whole[1]))
        if off <= AGREED * (b - a) or b - a <= NARROWEST * (high - low):
            area, moment = area + halves[0], moment + halves[1]
        else:
            todo += [(a, xs[4], ys[:5]), (xs[4], b, ys[4:])]
    return area, moment


def _between(f: Curve, xs: Sequence[Decimal], known: Sequence[Decimal]) -> list[Decimal]:
    return [known[k // 2] if k % 2 == 0 else f(x) for k, x in enumerate(xs)]


def _boole(xs: Sequence[Decimal], ys: Sequence[Decimal]) -> tuple[Decimal, Decimal]:
    step = (xs[-1] - xs[0]) / 90
    area = sum((w * y for w, y in zip(BOOLE, ys, strict=True)), ZERO) * step
    moment = sum((w * y * x for w, y, x in zip(BOOLE, ys, xs, strict=True)), ZERO) * step
    return area, moment


def bisector(f: Curve, low: Decimal, high: Decimal, first: bool = False) -> Decimal:
    """Return the middle between the first and the last place with half of the area on either side.

    Of `first` only the first.
    """
    wanted = integrals(f, low, high)[0] / 2
    close = D(10) ** -16
    found = []
    for shift in (-close, close):
        a, b = low, high
        for _ in range(56):
            middle = (a + b) / 2
            if integrals(f, low, middle)[0] < wanted + shift:
                a = middle
            else:
                b = middle
        found.append((a + b) / 2)
    return found[0] if first else (found[0] + found[1]) / 2


def plateaus(f: Curve, low: Decimal, high: Decimal) -> list[tuple[Decimal, Decimal]]:
    """Return the stretches on which f is greatest, by narrowing the cells of a grid."""
    step = (high - low) / CELLS
    xs = [low + k * step for k in range(CELLS + 1)]
    ys = [f(x) for x in xs]
    tops = []
    for k in range(CELLS):
        a, b = xs[k], xs[k + 1]
        if max(ys[k], ys[k + 1]) + D("0.1") < max(ys):
            continue
        for _ in range(90):  # a set has one top in a cell
            c, d = a + (b - a) / 3, b - (b - a) / 3
            if f(c) < f(d):
                a = c
            else:
                b = d
        tops.append((max(ys[k], ys[k + 1], f(a)), k, max((a, xs[k], xs[k + 1]), key=f)))
    height = max(top for top, _, _ in tops) - D(10) ** -14
    stretches: list[tuple[Decimal, Decimal]] = []
    for top, k, x in tops:
        if top < height:
            continue
        first = _limit(f, x, xs[k], height)
        last = _limit(f, x, xs[k + 1], height)
        if stretches and first - stretches[-1][1] < D(10) ** -12 * (high - low):
            stretches[-1] = (stretches[-1][0], last)
        else:
            stretches.append((first, last))
    return stretches


def _limit(f: Curve, inside: Decimal, outside: Decimal, height: Decimal) -> Decimal:
    """Return how far towards `outside` f stays at a height."""
    if f(outside) >= height:
        return outside
    for _ in range(90):
        middle = (inside + outside) / 2
        if f(middle) >= height:
            inside = middle
        else:
            outside = middle
    return inside


# --- numbers


def grid(low: Decimal, high: Decimal, count: int, sampling: str) -> list[Decimal]:
    """Return the samples of a range."""
    if sampling == "midpoints":
        return [low + (high - low) * (2 * k + 1) / (2 * count) for k in range(count)]
    last = count if sampling == "left" else count - 1
    return [(low * (last - k) + high * k) / last for k in range(count)]


def polygon(rules: Sequence[tuple[Case, Decimal]], xs: Sequence[Decimal]) -> Curve:
    """Return what scikit-fuzzy integrates: polylines, cut and united, joined at all knots."""
    cuts: dict[str, tuple[list[tuple[Decimal, Decimal]], Decimal]] = {}
    for term, s in rules:
        key = repr(term)
        line = [(x, membership(term, x)) for x in xs]
        cuts[key] = (line, max(s, cuts[key][1] if key in cuts else ZERO))
    knots = set(xs)
    for line, s in cuts.values():
        for (x0, y0), (x1, y1) in zip(line, line[1:], strict=False):
            if min(y0, y1) < s < max(y0, y1):
                knots.add((x0 * (y1 - s) + x1 * (s - y0)) / (y1 - y0))
    ordered = sorted(knots)
    ys = [max(min(s, polyline(x, line)) for line, s in cuts.values()) for x in ordered]
    return lambda x: polyline(x, list(zip(ordered, ys, strict=True)))


def from_set(case: Case, output: str, point: Mapping[str, Decimal]) -> Decimal:
    """Return the number that a defuzzifier makes of the set of an output."""
    low, high = case["outputs"][output]["range"]
    way = case["settings"]["defuzzifier"]
    rules = fired(case, output, point, "upper")
    f = aggregate(case, rules, "upper")
    if "samples" in way:
        xs = grid(low, high, int(way["samples"]), way["sampling"])
        if way["sampling"] != "joined":
            return from_samples(way, xs, [f(x) for x in xs])
        f = polygon(rules, xs)
        if way["method"] == "centroid":  # the trapezoids of a polygon, between its own knots
            return _of_polygon(f, low, high, rules, xs)
    if way["method"] == "centroid":
        area, moment = integrals(f, low, high)
        return moment / area
    if way["method"] == "bisector":
        return bisector(f, low, high, first="samples" in way)
    return middle_of(way["method"], plateaus(f, low, high))


def _of_polygon(
    f: Curve, low: Decimal, high: Decimal, rules: Any, xs: Sequence[Decimal]
) -> Decimal:
    area = moment = ZERO
    for a, b in zip(xs, xs[1:], strict=False):
        part = integrals_between(f, a, b)
        area, moment = area + part[0], moment + part[1]
    return moment / area


def integrals_between(f: Curve, low: Decimal, high: Decimal) -> tuple[Decimal, Decimal]:
    """Return area and moment of a stretch that has few bends, from fewer panels."""
    global PANELS  # noqa: PLW0603 - the one knob of `integrals`
    before, PANELS = PANELS, 2
    try:
        return integrals(f, low, high)
    finally:
        PANELS = before


def from_samples(way: Case, xs: Sequence[Decimal], ys: Sequence[Decimal]) -> Decimal:
    """Return the number that sums over samples give."""
    method, sampling = way["method"], way["sampling"]
    if method == "centroid":
        weights = list(ys)
        if sampling == "trapezoid":
            weights[0], weights[-1] = weights[0] / 2, weights[-1] / 2
        return sum((x * w for x, w in zip(xs, weights, strict=True)), ZERO) / sum(weights, ZERO)
    if method == "bisector":
        sums = [sum(ys[: k + 1], ZERO) for k in range(len(ys))]
        if sampling == "midpoints":
            off = [abs(2 * s - sums[-1]) for s in sums]
            near = [x for x, o in zip(xs, off, strict=True) if o - min(off) < D(10) ** -30]
            return sum(near, ZERO) / len(near)
        return next(x for x, s in zip(xs, sums, strict=True) if s * 2 >= sums[-1] - D(10) ** -30)
    top = max(ys) - D(10) ** -30
    return middle_of(method, [(x, x) for x, y in zip(xs, ys, strict=True) if y >= top])


def middle_of(method: str, stretches: Sequence[tuple[Decimal, Decimal]]) -> Decimal:
    """Return a place of the maximum by its name."""
    word = method.split(maxsplit=1)[0]
    ends = [x for stretch in stretches for x in stretch]
    if word in {"smallest", "largest"}:
        return min(ends) if word == "smallest" else max(ends)
    if word == "middle":
        return (min(ends) + max(ends)) / 2
    if word == "nearest":
        return ZERO if any(a <= 0 <= b for a, b in stretches) else min(ends, key=abs)
    if word == "farthest":
        return max(ends, key=abs)
    lengths = [b - a for a, b in stretches]
    if sum(lengths) < D(10) ** -10:
        return sum(ends, ZERO) / len(ends)
    return sum((n * (a + b) / 2 for n, (a, b) in zip(lengths, stretches, strict=True)), ZERO) / sum(
        lengths
    )


def solved(term: Case, s: Decimal) -> Decimal:
    """Return where a monotonic set has a degree, by halving."""
    a, b = sorted(term["parameters"])
    rises = membership(term, a) < membership(term, b)
    for _ in range(150):
        middle = (a + b) / 2
        if (membership(term, middle) < s) == rises:
            a = middle
        else:
            b = middle
    return (a + b) / 2


def from_values(case: Case, output: str, point: Mapping[str, Decimal]) -> Decimal:
    """Return the weighted average or sum of values."""
    way = case["settings"]["defuzzifier"]["method"]
    groups: dict[str, list[Any]] = {}
    for term, s in fired(case, output, point, "upper"):
        group = groups.setdefault(repr(term), [term, ZERO])
        group[1] = snorm(case["settings"]["aggregation"], group[1], s)
    top = bottom = ZERO
    for term, s in groups.values():
        if s:
            z = solved(term, s) if way == "tsukamoto" else _value(term, point)
            top, bottom = top + s * z, bottom + s
    return top if way == "weighted sum" else top / bottom


def _value(term: Case, point: Mapping[str, Decimal]) -> Decimal:
    if term["shape"] == "constant":
        return D(term["parameters"][0])
    return sum((c * (point[v] if v else ONE) for v, c in term["parameters"].items()), ZERO)


def from_interval(case: Case, output: str, point: Mapping[str, Decimal]) -> Decimal:
    """Return what Karnik and Mendel's iteration, or Nie and Tan's average, gives."""
    way = case["settings"]["defuzzifier"]
    low, high = case["outputs"][output]["range"]
    sides = [fired(case, output, point, side) for side in ("lower", "upper")]
    if sides[0][0][0]["shape"] in {"constant", "linear"}:
        xs = [_value(term, point) for term, _ in sides[0]]
        both = [[s for _, s in side] for side in sides]
    else:
        curves = [
            aggregate(case, rules, side)
            for rules, side in zip(sides, ("lower", "upper"), strict=True)
        ]
        if "samples" not in way:
            return _exact_interval(way["method"], curves, low, high)
        xs = grid(low, high, int(way["samples"]), way["sampling"])
        both = [[f(x) for x in xs] for f in curves]
        if way["sampling"] == "trapezoid":
            for side in both:
                side[0], side[-1] = side[0] / 2, side[-1] / 2

    def average(weights: Sequence[Decimal]) -> Decimal:
        return sum((x * w for x, w in zip(xs, weights, strict=True)), ZERO) / sum(weights, ZERO)

    if way["method"] == "nie-tan":
        return average([a + b for a, b in zip(*both, strict=True)])
    ends = []
    for left in (True, False):
        c = average([(a + b) / 2 for a, b in zip(*both, strict=True)])
        for _ in range(100):
            c = average([b if (x <= c) == left else a for x, a, b in zip(xs, *both, strict=True)])
        ends.append(c)
    return _end(way["method"], ends)


def _end(method: str, ends: Sequence[Decimal]) -> Decimal:
    return {"karnik-mendel left": ends[0], "karnik-mendel right": ends[1]}.get(
        method, sum(ends) / 2
    )


def _exact_interval(method: str, curves: Sequence[Curve], low: Decimal, high: Decimal) -> Decimal:
    lower, upper = curves
    sums = [integrals(f, low, high) for f in curves]
    c = (sums[0][1] + sums[1][1]) / (sums[0][0] + sums[1][0])
    if method == "nie-tan":
        return c
    ends = []
    for left in (True, False):
        at = c
        for _ in range(7):
            f, g = (upper, lower) if left else (lower, upper)
            one, other = integrals(f, low, at), integrals(g, at, high)
            at = (one[1] + other[1]) / (one[0] + other[0])
        ends.append(at)
    return _end(method, ends)


def number(case: Case, output: str, point: Mapping[str, Decimal]) -> Decimal | None:
    """Return what an output must be at a point; None where there is no number.

    Parameters
    ----------
    case : mapping
        The system of a case, with its numbers as decimals.
    output : str
        One of its outputs.
    point : mapping of str to Decimal
        The value of each input.
    """
    default = case["settings"].get("no rule", "nothing")
    nothing = None if default == "nothing" else D(default)
    if case["settings"].get("outside", "clamp") == "clamp":
        point = {n: sorted((*case["inputs"][n]["range"], x))[1] for n, x in point.items()}
    if all(s == 0 for _, s in fired(case, output, point, "upper")):
        return nothing
    method = case["settings"]["defuzzifier"]["method"]
    try:
        if method in {"weighted average", "weighted sum", "tsukamoto"}:
            return from_values(case, output, point)
        if method.startswith("karnik") or method == "nie-tan":
            return from_interval(case, output, point)
        return from_set(case, output, point)
    except (decimal.DivisionUndefined, decimal.InvalidOperation, decimal.DivisionByZero):
        return nothing
