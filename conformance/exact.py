"""What a case must give, in rational numbers.

Nothing here is rounded but roots and exponentials, which are taken to 60 digits; integrals are
those of polynomials between breaks (`pieces`), samples are added up as fractions. What a setting
means is defined by these functions, and said in words in `conformance/README.md`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

from conformance import pieces
from conformance.pieces import DIGITS, NotStraightError, Pieces

Case = Mapping[str, Any]
Interval = tuple[Fraction, Fraction]
Degree = Callable[[Fraction], Fraction]

ZERO, ONE, HALF = Fraction(0), Fraction(1), Fraction(1, 2)

T_NORMS: dict[str, Callable[[Fraction, Fraction], Fraction]] = {
    "minimum": min,
    "product": lambda a, b: a * b,
    "lukasiewicz": lambda a, b: max(ZERO, a + b - 1),
    "drastic": lambda a, b: min(a, b) if max(a, b) == 1 else ZERO,
    "nilpotent": lambda a, b: min(a, b) if a + b > 1 else ZERO,
    "hamacher": lambda a, b: a * b / (a + b - a * b) if a or b else ZERO,
    "einstein": lambda a, b: a * b / (2 - (a + b - a * b)),
}
S_NORMS: dict[str, Callable[[Fraction, Fraction], Fraction]] = {
    "maximum": max,
    "probabilistic sum": lambda a, b: a + b - a * b,
    "lukasiewicz": lambda a, b: min(ONE, a + b),
    "drastic": lambda a, b: max(a, b) if min(a, b) == 0 else ONE,
    "nilpotent": lambda a, b: max(a, b) if a + b < 1 else ONE,
    "hamacher": lambda a, b: (a + b - 2 * a * b) / (1 - a * b) if a * b != 1 else ONE,
    "einstein": lambda a, b: (a + b) / (1 + a * b),
    "sum": lambda a, b: a + b,
}
POLYNOMIAL = {"product", "probabilistic sum", "sum"}


class NoNumberError(ValueError):
    """There is no number: no rule fires, or the set has no area."""


# --- terms


def exponential(x: Fraction) -> Fraction:
    """Return e to the power x, to `DIGITS` digits of itself."""
    halvings = 0
    while abs(x) > HALF:
        x, halvings = x / 2, halvings + 1
    total = power = ONE
    for k in range(1, 60):
        power = _rounded(power * x / k, DIGITS + 30)
        total += power
    for _ in range(halvings):
        total = _rounded(total * total, DIGITS + 30)
    return total


def _rounded(x: Fraction, digits: int) -> Fraction:
    return Fraction(round(x * 10**digits), 10**digits)


def corners(shape: str, p: Sequence[Any]) -> list[tuple[Fraction, Fraction]] | None:
    """Return the corners of a straight shape, from left to right; None of a curved one."""
    if shape == "triangle":
        return [(p[0], ZERO), (p[1], ONE), (p[2], ZERO)]
    if shape == "trapezoid":
        return [(p[0], ZERO), (p[1], ONE), (p[2], ONE), (p[3], ZERO)]
    if shape == "rectangle":
        return [(p[0], ZERO), (p[0], ONE), (p[1], ONE), (p[1], ZERO)]
    if shape == "ramp":
        return sorted([(p[0], ZERO), (p[1], ONE)])
    if shape == "points":
        return [(x, y) for x, y in p]
    return None


def on_corners(listed: Sequence[tuple[Fraction, Fraction]], x: Fraction) -> Fraction:
    """Return the height at x: at a vertical edge the greatest of its ends."""
    here = [height for corner, height in listed if corner == x]
    if here:
        return max(here)
    if x < listed[0][0]:
        return listed[0][1]
    for (x0, y0), (x1, y1) in zip(listed, listed[1:], strict=False):
        if x0 < x < x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return listed[-1][1]


def rise(x: Fraction, a: Fraction, b: Fraction) -> Fraction:
    """Return the smooth rise of two parabolas, 0 at a and 1 at b."""
    share = min(ONE, max(ZERO, (x - a) / (b - a)))
    return 2 * share**2 if share <= HALF else 1 - 2 * (1 - share) ** 2


def curved(shape: str, p: Sequence[Fraction], x: Fraction) -> Fraction:
    """Return the degree of a curved shape at x."""
    if shape == "s":
        return rise(x, p[0], p[1])
    if shape == "z":
        return 1 - rise(x, p[0], p[1])
    if shape == "pi":
        return min(rise(x, p[0], p[1]), 1 - rise(x, p[2], p[3]))
    if shape == "gaussian":
        return exponential(-((x - p[0]) ** 2) / (2 * p[1] ** 2))
    if shape == "sigmoid":
        return 1 / (1 + exponential(-p[1] * (x - p[0])))
    if shape == "bell" and (2 * p[2]).denominator == 1:
        return 1 / (1 + abs((x - p[0]) / p[1]) ** int(2 * p[2]))
    raise ValueError(f"no such shape here: {shape} {list(p)}")


def degree(term: Case, x: Fraction) -> Fraction:
    """Return the degree of a term at x."""
    listed = corners(term["shape"], term["parameters"])
    height = term.get("height", ONE)
    if listed is not None:
        return height * on_corners(listed, x)
    return height * curved(term["shape"], term["parameters"], x)


def both(term: Case, x: Fraction) -> Interval:
    """Return the degrees of the lower and the upper function; of type 1 they are one."""
    upper = degree(term, x)
    return (degree(term["lower"], x) if "lower" in term else upper), upper


# --- rules


def strength(case: Case, condition: Case, inputs: Mapping[str, Fraction]) -> Interval:
    """Return the lower and the upper degree of a condition, operands from left to right."""
    ((word, parts),) = condition.items()
    if word == "is":
        return both(case["inputs"][parts[0]]["terms"][parts[1]], inputs[parts[0]])
    if word in {"not", "very"}:
        low, high = strength(case, parts, inputs)
        return (1 - high, 1 - low) if word == "not" else (low**2, high**2)
    norm = (T_NORMS if word == "and" else S_NORMS)[case["settings"][word]]
    operands = [strength(case, part, inputs) for part in parts]
    lower, upper = ([each[side] for each in operands] for side in (0, 1))
    return reduce(norm, lower), reduce(norm, upper)


def conclusions(
    case: Case, output: str, inputs: Mapping[str, Fraction]
) -> list[tuple[Case, Interval]]:
    """Return, rule by rule, the term of an output that it concludes, and how strongly."""
    concluded = []
    for rule in case["rules"]:
        if output not in rule["then"]:
            continue
        weight = rule.get("weight", ONE)
        low, high = strength(case, rule["if"], inputs)
        if high * weight > 0:
            term = case["outputs"][output]["terms"][rule["then"][output]]
            concluded.append((term, (low * weight, high * weight)))
    return concluded


# --- sets


def positions(
    low: Fraction, high: Fraction, count: int, sampling: str
) -> list[tuple[Fraction, Fraction]]:
    """Return the samples of a range, each with what it counts."""
    if sampling in {"endpoints", "trapezoid", "joined"}:
        step = (high - low) / (count - 1)
        ends = HALF if sampling == "trapezoid" else ONE
        return [(low + k * step, ends if k in {0, count - 1} else ONE) for k in range(count)]
    offset = {"midpoints": HALF, "left": ZERO}[sampling]
    return [(low + (k + offset) * (high - low) / count, ONE) for k in range(count)]


def union_at(
    case: Case, cut: Sequence[tuple[Case, Fraction]], y: Fraction, lower: bool = False
) -> Fraction:
    """Return the degree of the aggregated set at y."""
    implication = T_NORMS[case["settings"]["implication"]]
    aggregation = S_NORMS[case["settings"]["aggregation"]]
    heights = [implication(s, both(term, y)[0 if lower else 1]) for term, s in cut]
    return reduce(aggregation, heights, ZERO)


def union(
    case: Case, cut: Sequence[tuple[Case, Fraction]], low: Fraction, high: Fraction
) -> Pieces:
    """Return the aggregated set as polynomials between breaks."""
    names = case["settings"]["implication"], case["settings"]["aggregation"]
    total = pieces.level(ZERO, low, high)
    for term, s in cut:
        listed = corners(term["shape"], term["parameters"])
        if listed is None:
            raise NotStraightError(f"{term['shape']} is curved")
        height = term.get("height", ONE)
        whole = pieces.through([(x, y * height) for x, y in listed], low, high)
        under = pieces.level(s, low, high)
        clipped = pieces.combined(
            under, whole, T_NORMS[names[0]], names[0] if names[0] in POLYNOMIAL else ""
        )
        total = pieces.combined(
            total, clipped, S_NORMS[names[1]], names[1] if names[1] in POLYNOMIAL else ""
        )
    return total


def joined(
    cut: Sequence[tuple[Case, Fraction]], low: Fraction, high: Fraction, count: int
) -> Pieces:
    """Return the union of polylines: sets joined between samples, cut, united at samples and cuts.

    Two polylines that cross between two of these positions are joined by a chord there.
    """
    samples = [x for x, _ in positions(low, high, count, "joined")]
    strongest: dict[int, tuple[Case, Fraction]] = {}
    for term, s in cut:
        strongest[id(term)] = (term, max(s, strongest.get(id(term), (term, ZERO))[1]))
    lines = [([(x, degree(term, x)) for x in samples], s) for term, s in strongest.values()]
    where = set(samples)
    for listed, s in lines:
        for (x0, y0), (x1, y1) in zip(listed, listed[1:], strict=False):
            if (y0 - s) * (y1 - s) < 0:
                where.add(x0 + (x1 - x0) * (s - y0) / (y1 - y0))
    heights = [
        (x, max(min(on_corners(listed, x), s) for listed, s in lines)) for x in sorted(where)
    ]
    return pieces.through(heights, low, high)


# --- numbers of sets


def centroid_of(weights: Sequence[tuple[Fraction, Fraction]]) -> Fraction:
    """Return the average of positions by their weights."""
    total = sum((w for _, w in weights), ZERO)
    if total == 0:
        raise NoNumberError("the set has no area")
    return sum((x * w for x, w in weights), ZERO) / total


def halved(weights: Sequence[tuple[Fraction, Fraction]], sampling: str) -> Fraction:
    """Return the sample at which the running sum reaches half; of middles that nearest to half."""
    total, running, sums = sum((w for _, w in weights), ZERO), ZERO, []
    if total == 0:
        raise NoNumberError("the set has no area")
    for x, w in weights:
        running += w
        sums.append((abs(running - total / 2) if sampling == "midpoints" else running, x))
    if sampling == "midpoints":
        nearest = min(off for off, _ in sums)
        near = [x for off, x in sums if off == nearest]
        return sum(near, ZERO) / len(near)
    return next(x for so_far, x in sums if 2 * so_far >= total)


def of_maxima(method: str, stretches: Sequence[Interval]) -> Fraction:
    """Return a place of the maximum by its name."""
    first, last = stretches[0][0], stretches[-1][1]
    places = {
        "smallest of maxima": first,
        "largest of maxima": last,
        "middle of maxima": (first + last) / 2,
        "nearest of maxima": min((max(a, min(b, ZERO)) for a, b in stretches), key=abs),
        "farthest of maxima": max(first, last, key=abs),
    }
    if method in places:
        return places[method]
    lengths = sum((b - a for a, b in stretches), ZERO)
    if lengths == 0:
        return sum((a for a, _ in stretches), ZERO) / len(stretches)
    return sum(((b - a) * (a + b) / 2 for a, b in stretches), ZERO) / lengths


def crisp_set(case: Case, output: str, cut: Sequence[tuple[Case, Fraction]]) -> Fraction:
    """Return the number that a defuzzifier makes of cut sets."""
    low, high = case["outputs"][output]["range"]
    way = case["settings"]["defuzzifier"]
    method, count = way["method"], way.get("samples")
    if count is None or way["sampling"] == "joined":
        whole = union(case, cut, low, high) if count is None else joined(cut, low, high, int(count))
        if pieces.area(whole) == 0:
            raise NoNumberError("the set has no area")
        if method == "centroid":
            return pieces.moment(whole) / pieces.area(whole)
        if method == "bisector":
            return pieces.half(whole, first=count is not None)
        return of_maxima(method, pieces.greatest(whole))
    samples = positions(low, high, int(count), way["sampling"])
    weights = [(x, w * union_at(case, cut, x)) for x, w in samples]
    if method == "centroid":
        return centroid_of(weights)
    if method == "bisector":
        return halved(weights, way["sampling"])
    heights = [union_at(case, cut, x) for x, _ in samples]
    if not any(heights):
        raise NoNumberError("the set has no area")
    tops = [(x, x) for (x, _), h in zip(samples, heights, strict=True) if h == max(heights)]
    return of_maxima(method, tops)


# --- numbers of values, and of monotonic sets


def constant(term: Case, inputs: Mapping[str, Fraction]) -> Fraction:
    """Return the value of a consequent of Takagi and Sugeno."""
    if term["shape"] == "constant":
        (number,) = term["parameters"]
        return Fraction(number)
    slopes = term["parameters"]
    return sum((slopes[name] * (inputs[name] if name else 1) for name in slopes), ZERO)


def inverse(term: Case, s: Fraction) -> Fraction:
    """Return where a monotonic set reaches a strength."""
    (a, b), shape = term["parameters"], term["shape"]
    share = s / term.get("height", ONE)
    if shape == "ramp":
        return a + (b - a) * share
    if shape == "z":
        share = 1 - share
    half_way = pieces.root(share / 2) if share <= HALF else 1 - pieces.root((1 - share) / 2)
    return a + (b - a) * half_way


def weighed(
    case: Case, output: str, cut: Sequence[tuple[Case, Fraction]], inputs: Mapping[str, Fraction]
) -> Fraction:
    """Return the average, or the sum, of values by strengths; rules of one term are folded."""
    method = case["settings"]["defuzzifier"]["method"]
    fold = S_NORMS[case["settings"]["aggregation"]]
    folded: dict[int, tuple[Case, Fraction]] = {}
    for term, s in cut:
        before = folded.get(id(term))
        folded[id(term)] = (term, s if before is None else fold(before[1], s))
    place = inverse if method == "tsukamoto" else lambda term, _s: constant(term, inputs)
    pairs = [(place(term, s), s) for term, s in folded.values()]
    if method == "weighted sum":
        return sum((z * s for z, s in pairs), ZERO)
    return centroid_of(pairs)


# --- interval type 2


def ends(weights: Sequence[tuple[Fraction, Interval]]) -> Interval:
    """Return both ends of all averages with weights between two: every switch point is tried."""
    listed = sorted(weights)
    averages = []
    for k in range(len(listed) + 1):
        for left, right in ((0, 1), (1, 0)):
            pairs = [(x, w[left if i < k else right]) for i, (x, w) in enumerate(listed)]
            if any(w for _, w in pairs):
                averages.append(centroid_of(pairs))
    if not averages:
        raise NoNumberError("the set has no area")
    return min(averages), max(averages)


def exact_end(lower: Pieces, upper: Pieces, right: bool) -> Fraction:
    """Return one end of the centroid of the sets between two, by halving to 60 digits.

    The left end is where the moments about it of the upper set on its left and of the lower set on
    its right balance; the right end is the other way round.
    """
    low, high = upper[0].low, upper[-1].high

    def balance(c: Fraction) -> Fraction:
        sides = (lower, upper) if right else (upper, lower)
        before = [pieces.Piece(p.low, min(p.high, c), p.polynomial) for p in sides[0] if p.low < c]
        behind = [pieces.Piece(max(p.low, c), p.high, p.polynomial) for p in sides[1] if p.high > c]
        whole = (*before, *behind)
        return pieces.moment(whole) - c * pieces.area(whole)

    for _ in range(DIGITS * 10 // 3):
        middle = _rounded((low + high) / 2, DIGITS + 10)
        if balance(middle) > 0:
            low = middle
        else:
            high = middle
    return _rounded((low + high) / 2, DIGITS)


def crisp_interval(
    case: Case,
    output: str,
    concluded: Sequence[tuple[Case, Interval]],
    inputs: Mapping[str, Fraction],
) -> Fraction:
    """Return an end, the middle of both, or the number of Nie and Tan."""
    way = case["settings"]["defuzzifier"]
    low, high = case["outputs"][output]["range"]
    lower = [(term, s[0]) for term, s in concluded]
    upper = [(term, s[1]) for term, s in concluded]
    if any(term["shape"] in {"constant", "linear"} for term, _ in concluded):
        pairs = [(constant(term, inputs), s) for term, s in concluded]
        if way["method"] == "nie-tan":
            return centroid_of([(z, s[0] + s[1]) for z, s in pairs])
        left, right = ends(pairs)
    elif "samples" in way:
        samples = positions(low, high, int(way["samples"]), way["sampling"])
        weights = [
            (x, (w * union_at(case, lower, x, lower=True), w * union_at(case, upper, x)))
            for x, w in samples
        ]
        if way["method"] == "nie-tan":
            return centroid_of([(x, w[0] + w[1]) for x, w in weights])
        left, right = ends(weights)
    else:
        below = [(term.get("lower", term), s) for term, s in lower]
        sets = union(case, below, low, high), union(case, upper, low, high)
        if way["method"] == "nie-tan":
            mass = pieces.area(sets[0]) + pieces.area(sets[1])
            return (pieces.moment(sets[0]) + pieces.moment(sets[1])) / mass
        left, right = exact_end(*sets, right=False), exact_end(*sets, right=True)
    return {"karnik-mendel left": left, "karnik-mendel right": right}.get(
        way["method"], (left + right) / 2
    )


# --- a case


def number(case: Case, output: str, inputs: Mapping[str, Fraction]) -> Fraction | None:
    """Return what an output must be at a point; None where there is no number.

    Parameters
    ----------
    case : mapping
        The system of a case, with its numbers as fractions.
    output : str
        One of its outputs.
    inputs : mapping of str to Fraction
        The value of each input.
    """
    settings = case["settings"]
    if settings.get("outside", "clamp") == "clamp":
        ranges = {name: case["inputs"][name]["range"] for name in inputs}
        inputs = {name: min(max(x, ranges[name][0]), ranges[name][1]) for name, x in inputs.items()}
    concluded = conclusions(case, output, inputs)
    method = settings["defuzzifier"]["method"]
    try:
        if not concluded:
            raise NoNumberError("no rule fires")
        if method in {"karnik-mendel", "karnik-mendel left", "karnik-mendel right", "nie-tan"}:
            return crisp_interval(case, output, concluded, inputs)
        cut = [(term, high) for term, (_, high) in concluded]
        if method in {"weighted average", "weighted sum", "tsukamoto"}:
            return weighed(case, output, cut, inputs)
        return crisp_set(case, output, cut)
    except NoNumberError:
        default = settings.get("no rule", "nothing")
        return None if default == "nothing" else Fraction(default)
