"""The cases, by topic: what is asked. What must come out is found by `make_cases.py`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

Data = dict[str, Any]

# Which program takes which sums for an integral, unless it is told otherwise.
OF_SAMPLING = {
    "endpoints": ("MATLAB and simpful", "N samples with both ends, all of weight 1"),
    "trapezoid": (
        "Octave's fuzzy-logic-toolkit",
        "N samples with both ends, the ends of weight 1/2",
    ),
    "midpoints": ("fuzzylite", "the middles of N equal stretches"),
    "left": ("jFuzzyLogic", "the left ends of N equal stretches"),
    "joined": ("scikit-fuzzy", "polylines through N points, united at the points and the cuts"),
}
USUAL = (
    ("endpoints", 101),
    ("endpoints", 1000),
    ("trapezoid", 101),
    ("midpoints", 100),
    ("left", 1000),
    ("joined", 26),
)
T_NORMS = ("minimum", "product", "lukasiewicz", "drastic", "nilpotent", "hamacher", "einstein")
S_NORMS = (
    "maximum",
    "probabilistic sum",
    "lukasiewicz",
    "drastic",
    "nilpotent",
    "hamacher",
    "einstein",
)
AGGREGATIONS = (*S_NORMS, "sum")


def term(shape: str, *parameters: Any, **more: Any) -> Data:
    """Return a term."""
    return {"shape": shape, "parameters": list(parameters), **more}


def tri(*numbers: float, **more: Any) -> Data:
    """Return a triangle."""
    return term("triangle", *numbers, **more)


def constant(number: float) -> Data:
    """Return a value of Takagi and Sugeno."""
    return term("constant", number)


def variable(low: float, high: float, /, **terms: Data) -> Data:
    """Return a variable."""
    return {"range": [low, high], "terms": terms}


def fires(*propositions: str, word: str = "and") -> Data:
    """Return a condition of propositions such as "x low", "x not low", joined by one word."""
    parts: list[Data] = []
    for text in propositions:
        name, *hedges, label = text.split()
        part: Data = {"is": [name, label]}
        for hedge in reversed(hedges):
            part = {hedge: part}
        parts.append(part)
    return parts[0] if len(parts) == 1 else {word: parts}


def rule(condition: Data, weight: float | None = None, **then: str) -> Data:
    """Return a rule."""
    return {"if": condition, "then": then, **({} if weight is None else {"weight": weight})}


def sampled(method: str, sampling: str = "", count: int = 0) -> Data:
    """Return a defuzzifier."""
    return {"method": method, **({"samples": count, "sampling": sampling} if sampling else {})}


def settings(defuzzifier: Data, **more: Any) -> Data:
    """Return the settings of a case: the usual ones, with what differs."""
    usual = {
        "and": "minimum", "or": "maximum", "implication": "minimum", "aggregation": "maximum",
        "defuzzifier": defuzzifier, "outside": "clamp", "no rule": "nothing",
    }  # fmt: skip
    return {**usual, **{key.replace("_", " "): value for key, value in more.items()}}


def case(
    name: str, says: str, system: Mapping[str, Any], points: Sequence[Sequence[float]], **more: Any
) -> Data:
    """Return a case without its expected numbers."""
    chosen = more.get("settings", system.get("settings"))
    way = chosen["defuzzifier"]
    about = []
    if "sampling" in way:
        tool, setting = OF_SAMPLING[way["sampling"]]
        about = [{"tool": tool, "setting": setting.replace("N ", f"{way['samples']} ")}]
    inputs = list(system["inputs"])
    return {
        "name": name, "says": says, "about": about, "inputs": system["inputs"],
        "outputs": system["outputs"], "rules": system["rules"], "settings": chosen,
        "points": [{"inputs": dict(zip(inputs, point, strict=True))} for point in points],
    }  # fmt: skip


def ways(
    method: str = "centroid", exact: bool = True, only: Iterable[tuple[str, int]] = USUAL
) -> Iterator[tuple[str, Data]]:
    """Yield a suffix of names and a defuzzifier, for the integral and for each tool's sums."""
    if exact:
        yield "exact", sampled(method)
    for sampling, count in only:
        yield f"{sampling}-{count}", sampled(method, sampling, count)


# --- systems

TIPPER = {
    "inputs": {
        name: variable(0, 10, poor=tri(0, 0, 5), average=tri(0, 5, 10), good=tri(5, 10, 10))
        for name in ("quality", "service")
    },
    "outputs": {
        "tip": variable(0, 25, low=tri(0, 0, 13), medium=tri(0, 13, 25), high=tri(13, 25, 25))
    },
    "rules": [
        rule(fires("quality poor", "service poor", word="or"), tip="low"),
        rule(fires("service average"), tip="medium"),
        rule(fires("service good", "quality good", word="or"), tip="high"),
    ],
}

GRID = {
    "inputs": {
        "e": variable(-1, 1, N=tri(-2, -1, 0), Z=tri(-1, 0, 1), P=tri(0, 1, 2)),
        "ce": variable(-2, 2, N=term("ramp", 0, -2), Z=tri(-2, 0, 2), P=term("ramp", 0, 2)),
    },
    "outputs": {"u": variable(-10, 10, N=tri(-20, -10, 0), Z=tri(-10, 0, 10), P=tri(0, 10, 20))},
    "rules": [
        rule(fires(f"e {row}", f"ce {column}"), u=cell)
        for row, cells in zip("NZP", ("NNZ", "NZP", "ZPP"), strict=True)
        for column, cell in zip("NZP", cells, strict=True)
    ],
}

CLIPS = {
    "inputs": {"x": variable(0, 1, up=term("ramp", 0, 1), down=term("ramp", 1, 0))},
    "outputs": {"y": variable(0, 8, left=term("trapezoid", 0, 1, 3, 5), right=tri(3, 6, 8))},
    "rules": [rule(fires("x up"), y="left"), rule(fires("x down"), y="right")],
}

APART = {
    "inputs": {"x": variable(0, 1, up=term("ramp", 0, 1), down=term("ramp", 1, 0))},
    "outputs": {
        "y": variable(
            0, 10, left=term("trapezoid", 0, 1, 2, 3), right=term("trapezoid", 6, 7, 8, 9)
        )
    },
    "rules": [rule(fires("x up"), y="left"), rule(fires("x down"), y="right")],
}


def probe(shape: Data, low: float = 0, high: float = 10) -> Data:
    """Return a system whose output is the degree of a term: d · 1 + (1 − d) · 0 over 1."""
    return {
        "inputs": {"x": variable(low, high, it=shape)},
        "outputs": {"y": variable(0, 1, yes=constant(1), no=constant(0))},
        "rules": [rule(fires("x it"), y="yes"), rule(fires("x not it"), y="no")],
    }


def between_sets(shape: Data, low: float = 0, high: float = 10) -> Data:
    """Return a system like `probe` whose conclusions are sets."""
    return {
        "inputs": {"x": variable(low, high, it=shape)},
        "outputs": {"y": variable(0, 10, yes=tri(5, 7.5, 10), no=tri(0, 2.5, 5))},
        "rules": [rule(fires("x it"), y="yes"), rule(fires("x not it"), y="no")],
    }


AVERAGE = sampled("weighted average")


# --- topics


def shapes() -> Iterator[Data]:
    """Degrees at corners, between them and beyond."""
    listed = {
        "triangle": (tri(2, 5, 9), (2, 3.5, 5, 6.5, 9, 1, 10)),
        "triangle-left-edge": (tri(0, 0, 5), (0, 1.25, 5, 6)),
        "triangle-right-edge": (tri(5, 10, 10), (5, 8.75, 10, 4)),
        "triangle-inner-left-edge": (tri(4, 4, 8), (3.75, 4, 6, 8)),
        "triangle-inner-right-edge": (tri(2, 6, 6), (2, 4, 6, 6.25)),
        "trapezoid": (term("trapezoid", 1, 3, 6, 8), (1, 2, 3, 4.5, 6, 7.25, 8, 0, 9)),
        "trapezoid-left-edge": (term("trapezoid", 0, 0, 2, 4), (0, 1, 2, 3, 4)),
        "trapezoid-right-edge": (term("trapezoid", 6, 8, 10, 10), (6, 7, 8, 10)),
        "trapezoid-box": (term("trapezoid", 3, 3, 7, 7), (2.75, 3, 5, 7, 7.25)),
        "rectangle": (term("rectangle", 2.5, 7.5), (2.25, 2.5, 5, 7.5, 7.75)),
        "ramp-up": (term("ramp", 2, 6), (0, 2, 3, 6, 10)),
        "ramp-down": (term("ramp", 6, 2), (0, 2, 3, 6, 10)),
        "points": (term("points", [0, 0], [2, 0.75], [5, 0.25], [8, 1], [10, 0.5]), (0, 1, 2, 3.5, 5, 8, 9, 10)),
        "points-level-ends": (term("points", [2, 0.5], [4, 1], [6, 0.125]), (0, 2, 3, 4, 5, 6, 10)),
        "s": (term("s", 2, 8), (2, 3.5, 5, 6.5, 8, 0, 10)),
        "z": (term("z", 2, 8), (2, 3.5, 5, 6.5, 8, 0, 10)),
        "pi": (term("pi", 1, 4, 6, 10), (1, 2.5, 4, 5, 6, 8, 10)),
        "gaussian": (term("gaussian", 4, 1.5), (4, 2.5, 5.5, 8.5, 0)),
        "bell": (term("bell", 5, 2, 3), (5, 3, 7, 4, 9)),
        "bell-slope-1": (term("bell", 6, 1.5, 1), (6, 4.5, 7.5, 0)),
        "sigmoid-up": (term("sigmoid", 5, 2), (5, 4, 6, 0, 10)),
        "sigmoid-down": (term("sigmoid", 3, -1.5), (3, 2, 4, 0)),
    }  # fmt: skip
    for name, (shape, points) in listed.items():
        yield case(f"shape-{name}", "The output is the degree of the term.", probe(shape),
                   [(x,) for x in points], settings=settings(AVERAGE, aggregation="sum"))  # fmt: skip
    for name, (shape, points) in listed.items():
        if shape["shape"] in {"triangle", "trapezoid", "ramp", "points"}:
            yield case(f"shape-{name}-sets", "The degree shifts the centroid between two sets.", between_sets(shape),
                       [(x,) for x in points], settings=settings(sampled("centroid", "joined", 21)))  # fmt: skip
    beyond = {
        "triangle": tri(0, 0, 5), "right-edge": tri(5, 10, 10), "ramp": term("ramp", 2, 8),
        "sigmoid": term("sigmoid", 5, 1), "trapezoid": term("trapezoid", 6, 8, 10, 10),
    }  # fmt: skip
    for outside in ("clamp", "extend"):
        for name, shape in beyond.items():
            yield case(f"outside-{outside}-{name}", f"An input beyond its range: {outside}.", probe(shape),
                       [(-3,), (0,), (10,), (12.5,)],
                       settings=settings(AVERAGE, aggregation="sum", outside=outside))  # fmt: skip
    for hedges in ("not", "very", "not very", "very not"):
        system = probe(tri(0, 4, 10))
        system["rules"] = [rule(fires(f"x {hedges} it"), y="yes"), rule(fires("x it"), y="no")]
        yield case(f"hedge-{hedges.replace(' ', '-')}", "The hedge next to the term acts first.", system,
                   [(1,), (2,), (4.6,), (7,)], settings=settings(AVERAGE, aggregation="sum"))  # fmt: skip


def norms() -> Iterator[Data]:
    """T-norms and S-norms in conditions, implication and aggregation."""
    points = [(0.25, 0.5), (0.75, 0.5), (1, 0.375), (0.125, 1), (0.625, 0.875), (1, 1)]
    ramp = variable(0, 1, on=term("ramp", 0, 1))

    def system(count: int, word: str, weak: float = 0.5) -> Data:
        """An output d · 1 + ½ · 0 over d + ½, which tells the degree d."""
        names = [f"x{k}" for k in range(1, count + 1)]
        inputs: Data = dict.fromkeys(names, ramp)
        condition = fires(*(f"{name} on" for name in names), word=word)
        inputs["k"] = variable(0, 1, half=term("points", [0, weak], [1, weak]))
        return {
            "inputs": inputs,
            "outputs": {"y": variable(0, 1, yes=constant(1), no=constant(0))},
            "rules": [rule(condition, y="yes"), rule(fires("k half"), y="no")],
        }

    for word, listed in (("and", T_NORMS), ("or", S_NORMS)):
        for name in listed:
            chosen = settings(AVERAGE, aggregation="sum", **{word: name})
            slug = name.replace(" ", "-")
            yield case(f"{word}-{slug}", f"{word} is the {name} of two degrees.", system(2, word),
                       [(*p, 0.5) for p in points], settings=chosen)  # fmt: skip
            yield case(f"{word}-{slug}-three", f"{word} is the {name} of three degrees, from left to right.",
                       system(3, word), [(0.75, 0.5, 0.875, 0), (1, 0.625, 0.75, 0), (0.25, 0.125, 0.5, 0)],
                       settings=chosen)  # fmt: skip
            sets = system(2, word)
            sets["outputs"] = {"y": variable(0, 10, yes=tri(5, 7.5, 10), no=tri(0, 2.5, 5))}
            yield case(f"{word}-{slug}-sets", f"{word} is the {name} of two degrees, and the centroid tells.", sets,
                       [(*p, 0.5) for p in points],
                       settings=settings(sampled("centroid", "joined", 21), **{word: name}))  # fmt: skip
    nested = system(3, "and")
    nested["rules"][0]["if"] = {"or": [fires("x1 on", "x2 on"), fires("x2 not on", "x3 on")]}
    for t, s in (
        ("minimum", "maximum"),
        ("product", "probabilistic sum"),
        ("lukasiewicz", "lukasiewicz"),
    ):
        yield case(f"nested-{t}", "Conditions in parentheses.", nested,
                   [(0.25, 0.5, 0.75, 0), (0.875, 0.75, 0.5, 0), (1, 0, 1, 0)],
                   settings=settings(AVERAGE, aggregation="sum", **{"and": t, "or": s}))  # fmt: skip
    straight = {"minimum", "product", "lukasiewicz", "nilpotent"}
    inputs = [(0.25,), (0.5,), (0.75,), (0.375,)]
    some = (("endpoints", 101), ("trapezoid", 101), ("midpoints", 100))
    for name in T_NORMS:
        for suffix, way in ways(exact=name in straight, only=some):
            yield case(f"implication-{name}-{suffix}", f"A strength cuts a set by the {name}.", CLIPS,
                       inputs, settings=settings(way, implication=name))  # fmt: skip
    for name in AGGREGATIONS:
        straight_sums = {"maximum", "probabilistic sum", "lukasiewicz", "nilpotent", "sum"}
        for suffix, way in ways(exact=name in straight_sums, only=some):
            yield case(f"aggregation-{name.replace(' ', '-')}-{suffix}", f"Sets are united by the {name}.", CLIPS,
                       inputs, settings=settings(way, aggregation=name))  # fmt: skip


def no_rule() -> Iterator[Data]:
    """No rule fires, or what fires covers nothing."""
    sparse = {
        "inputs": {"x": variable(0, 10, low=tri(0, 0, 3), high=term("trapezoid", 7, 9, 10, 10))},
        "outputs": {"y": variable(0, 4, small=tri(0, 1, 2), large=tri(2, 3, 4))},
        "rules": [rule(fires("x low"), y="small"), rule(fires("x high"), y="large")],
    }
    values = {**sparse, "outputs": {"y": variable(0, 4, small=constant(1), large=constant(3))}}
    points = [(5,), (3,), (7,), (2.5,), (8,)]
    for default in ("nothing", 2, 0):
        slug = str(default)
        for suffix, way in ways():
            yield case(f"no-rule-{slug}-{suffix}", "Between the terms, and at their feet, no rule fires.", sparse,
                       points, settings=settings(way, no_rule=default))  # fmt: skip
        yield case(f"no-rule-{slug}-values", "The same of values.", values, points,
                   settings=settings(AVERAGE, aggregation="sum", no_rule=default))  # fmt: skip
    for suffix, way in ways(only=(("midpoints", 100), ("endpoints", 101))):
        yield case(f"no-area-{suffix}", "A rule fires, but its cut set has no area.", {
            **sparse, "outputs": {"y": variable(0, 4, small=tri(0, 1, 2, height=0.5), large=tri(2, 3, 4, height=0.5))},
        }, [(2.5,), (7.5,), (0,), (9,)], settings=settings(way, implication="lukasiewicz"))  # fmt: skip


def weights() -> Iterator[Data]:
    """Weights of rules."""
    for weight in (0.5, 0.25, 0):
        heavy = {
            **CLIPS,
            "rules": [rule(fires("x up"), weight, y="left"), rule(fires("x down"), y="right")],
        }
        for suffix, way in ways():
            yield case(f"weight-{weight}-{suffix}", "A weight scales the strength of its rule.", heavy,
                       [(0.5,), (0.75,), (0.25,)], settings=settings(way))  # fmt: skip
        values = {**heavy, "outputs": {"y": variable(0, 8, left=constant(1), right=constant(7))}}
        yield case(f"weight-{weight}-values", "The same of values.", values, [(0.5,), (0.75,), (0.25,)],
                   settings=settings(AVERAGE, aggregation="sum"))  # fmt: skip
    both = {
        **TIPPER,
        "rules": [
            {**one, "weight": w} for one, w in zip(TIPPER["rules"], (0.75, 0.5, 1), strict=True)
        ],
    }
    for suffix, way in ways():
        yield case(f"weights-tipper-{suffix}", "A weight to each rule.", both,
                   [(6.5, 9.8), (2, 3), (8, 4)], settings=settings(way))  # fmt: skip
    twice = {**CLIPS, "rules": [*CLIPS["rules"], rule(fires("x up"), 0.5, y="right")]}
    for suffix, way in ways():
        yield case(f"two-rules-{suffix}", "Two rules conclude one term: the stronger counts.", twice,
                   [(0.5,), (0.875,), (0.25,)], settings=settings(way))  # fmt: skip


def plateaus() -> Iterator[Data]:
    """Sets that are level where they are cut."""
    points = [(0.5,), (0.25,), (0.875,), (1,), (0,)]
    some = (("endpoints", 101), ("trapezoid", 101), ("midpoints", 100), ("left", 100))
    for suffix, way in ways():
        yield case(f"plateau-centroid-{suffix}", "Two cut sets that overlap.", CLIPS, points,
                   settings=settings(way))  # fmt: skip
    for suffix, way in ways("bisector", only=(*some, ("joined", 33))):
        yield case(f"plateau-bisector-{suffix}", "Half of the area lies on either side.", CLIPS, points,
                   settings=settings(way))  # fmt: skip


def gaps() -> Iterator[Data]:
    """Sets with nothing between them."""
    points = [(0.5,), (0.25,), (0.75,), (1,)]
    for suffix, way in ways():
        yield case(f"gap-centroid-{suffix}", "The centroid may lie where the set is 0.", APART, points,
                   settings=settings(way))  # fmt: skip
    for suffix, way in ways(
        "bisector", only=(("endpoints", 101), ("midpoints", 100), ("joined", 41))
    ):
        # Of polylines rounding decides a tie: the area up to the gap is half of it, or nearly.
        asked = [p for p in points if p != (0.5,) or "joined" not in suffix]
        yield case(f"gap-bisector-{suffix}", "Halves that a gap parts.", APART, asked,
                   settings=settings(way))  # fmt: skip


def sampled_centroids() -> Iterator[Data]:
    """One example, many sums."""
    counts = (("endpoints", 26), ("endpoints", 101), ("endpoints", 1000), ("trapezoid", 26), ("trapezoid", 101),
              ("midpoints", 100), ("midpoints", 200), ("midpoints", 1000), ("left", 1000), ("left", 101),
              ("joined", 26), ("joined", 101), ("joined", 251))  # fmt: skip
    for suffix, way in ways(only=counts):
        yield case(f"tipper-{suffix}", "The tipping problem of scikit-fuzzy's documentation.", TIPPER,
                   [(6.5, 9.8), (2, 3), (5, 5), (9.75, 0.5)], settings=settings(way))  # fmt: skip
    for suffix, way in ways(only=counts):
        yield case(f"grid-{suffix}", "Nine rules of error and rate.", GRID,
                   [(0.3, -0.7), (-0.55, 0.2), (0.9, 1.9), (0, 0), (-1, -2)], settings=settings(way))  # fmt: skip
    for suffix, way in ways(only=(("endpoints", 101), ("trapezoid", 101), ("midpoints", 100))):
        yield case(f"tipper-product-{suffix}", "Sets that are scaled, not cut.", TIPPER, [(6.5, 9.8), (2, 3)],
                   settings=settings(way, implication="product"))  # fmt: skip


def maxima() -> Iterator[Data]:
    """Where the set is greatest, and ties."""
    methods = ("mean of maxima", "smallest of maxima", "largest of maxima", "middle of maxima")
    some = (("endpoints", 101), ("midpoints", 100))
    for method in methods:
        slug = method.replace(" ", "-")
        for suffix, way in ways(method, only=some):
            yield case(f"{slug}-plateau-{suffix}", "One plateau.", CLIPS, [(0.75,), (0.25,), (1,)],
                       settings=settings(way))  # fmt: skip
            yield case(f"{slug}-tie-{suffix}", "Two sets of one height, apart.", APART, [(0.5,), (0.25,)],
                       settings=settings(way))  # fmt: skip
    uneven = {**APART, "outputs": {"y": variable(0, 10, left=term("trapezoid", 0, 1, 2, 3),
                                                 right=term("trapezoid", 4, 5, 8, 9))}}  # fmt: skip
    for method in methods:
        for suffix, way in ways(method, only=some):
            yield case(f"{method.replace(' ', '-')}-uneven-tie-{suffix}", "Two plateaus of different length.",
                       uneven, [(0.5,)], settings=settings(way))  # fmt: skip
    signed = {**APART, "outputs": {"y": variable(-4, 2, left=term("trapezoid", -3.4, -3, -1, -0.4),
                                                 right=term("trapezoid", 0.2, 0.5, 1, 1.6))}}  # fmt: skip
    around = {**APART, "outputs": {"y": variable(-4, 2, left=term("trapezoid", -3, -1.5, 1, 1.5),
                                                 right=term("trapezoid", -3.5, -3, -2, -1.75))}}  # fmt: skip
    for method in ("nearest of maxima", "farthest of maxima"):
        for suffix, way in ways(method, only=some):
            slug = f"{method.replace(' ', '-')}-{suffix}"
            yield case(f"signed-{slug}", "Plateaus on both sides of 0.", signed,
                       [(0.5,), (0.25,), (0.75,)], settings=settings(way))  # fmt: skip
            yield case(f"around-{slug}", "A plateau around 0.", around,
                       [(0.5,), (0.25,), (0.75,)], settings=settings(way))  # fmt: skip


def sugeno() -> Iterator[Data]:
    """Values and sums of the inputs as conclusions."""

    def line(offset: float, x: float, y: float) -> Data:
        return {"shape": "linear", "parameters": {"": offset, "x": x, "y": y}}

    inputs = {
        "x": variable(-2, 2, low=term("ramp", 2, -2), high=term("ramp", -2, 2)),
        "y": variable(0, 4, few=tri(-4, 0, 4), many=tri(0, 4, 8)),
    }
    outputs = {
        "z": variable(-20, 20, a=constant(-4), b=line(1, 2, -0.5), c=line(0, -1, 3), d=constant(6))
    }
    rules = [
        rule(fires("x low", "y few"), z="a"), rule(fires("x low", "y many"), z="b"),
        rule(fires("x high", "y few"), z="c"), rule(fires("x high", "y many"), z="d"),
    ]  # fmt: skip
    system = {"inputs": inputs, "outputs": outputs, "rules": rules}
    points = [(0, 2), (-1, 1), (1.5, 3.5), (2, 4), (-0.7, 0.3)]
    for norm in T_NORMS:
        yield case(f"sugeno-{norm}", f"Weighted average, strengths by the {norm}.", system, points,
                   settings=settings(AVERAGE, aggregation="sum", **{"and": norm}))  # fmt: skip
    for norm in ("minimum", "product"):
        yield case(f"sugeno-sum-{norm}", "Weighted sum.", system, points,
                   settings=settings(sampled("weighted sum"), aggregation="sum", outside="clamp", **{"and": norm}))  # fmt: skip
    shared = {
        "inputs": inputs, "outputs": {"z": variable(0, 1, no=constant(0), yes=constant(1))},
        "rules": [rule(fires("x low"), z="no"), rule(fires("y few"), z="no"), rule(fires("y many"), z="yes")],
    }  # fmt: skip
    for fold in ("sum", "maximum", "probabilistic sum"):
        yield case(f"sugeno-shared-{fold.replace(' ', '-')}", f"Rules that share a value are folded by the {fold}.",
                   shared, [(0, 2), (-1, 3), (1.5, 1)], settings=settings(AVERAGE, aggregation=fold))  # fmt: skip
    curves = {
        **shared,
        "inputs": {"x": variable(-2, 2, low=term("gaussian", -1, 0.8), high=term("gaussian", 1, 0.8)),
                   "y": variable(0, 4, few=term("sigmoid", 2, -3), many=term("bell", 4, 1.5, 2))},
    }  # fmt: skip
    yield case("sugeno-curves", "Curved terms.", curves, [(0, 2), (-1, 3), (1.5, 1)],
               settings=settings(AVERAGE, aggregation="sum"))  # fmt: skip


def tsukamoto() -> Iterator[Data]:
    """Monotonic sets as conclusions."""
    inputs = {"x": variable(0, 1, up=term("ramp", 0, 1), down=term("ramp", 1, 0))}
    rules = [rule(fires("x up"), y="more"), rule(fires("x down"), y="less")]
    sets = {
        "ramps": (term("ramp", 8, 0), term("ramp", 2, 10)),
        "ramps-crossing": (term("ramp", 10, 4), term("ramp", 0, 6)),
        "s-and-z": (term("z", 0, 8), term("s", 2, 10)),
        "ramp-and-s": (term("ramp", 6, 1), term("s", 0, 10)),
        "one-way": (term("ramp", 0, 10), term("ramp", 5, 10)),
    }  # fmt: skip
    for name, (less, more) in sets.items():
        system = {
            "inputs": inputs,
            "outputs": {"y": variable(0, 10, less=less, more=more)},
            "rules": rules,
        }
        yield case(f"tsukamoto-{name}", "The places where monotonic sets reach the strengths, averaged.", system,
                   [(0.5,), (0.125,), (0.875,), (0.25,), (1,)],
                   settings=settings(sampled("tsukamoto"), aggregation="sum"))  # fmt: skip
    system = {"inputs": inputs, "outputs": {"y": variable(0, 10, less=term("ramp", 8, 0), more=term("ramp", 2, 10))},
              "rules": [rule(fires("x up"), 0.5, y="more"), rule(fires("x down"), 0.75, y="less")]}  # fmt: skip
    yield case("tsukamoto-weights", "With weights.", system, [(0.5,), (0.25,)],
               settings=settings(sampled("tsukamoto"), aggregation="sum"))  # fmt: skip


def type_2() -> Iterator[Data]:
    """Interval type 2."""

    def between(upper: Data, lower: Data) -> Data:
        return {**upper, "lower": lower}

    inputs = {
        "x": variable(0, 10, low=between(term("trapezoid", 0, 0, 2, 8), term("trapezoid", 0, 0, 1, 6)),
                      high=between(term("trapezoid", 2, 8, 10, 10), term("trapezoid", 4, 9, 10, 10))),
        "y": variable(0, 10, few=between(tri(0, 0, 10), tri(0, 0, 8, height=0.9)),
                      many=between(tri(0, 10, 10), tri(2, 10, 10, height=0.9))),
    }  # fmt: skip
    outputs = {"z": variable(0, 20, small=between(tri(0, 5, 10), tri(1, 5, 9, height=0.9)),
                             large=between(tri(8, 14, 20), tri(9, 14, 18, height=0.8)))}  # fmt: skip
    rules = [rule(fires("x low", "y few"), z="small"), rule(fires("x high", "y many"), z="large"),
             rule(fires("x high", "y few"), z="small")]  # fmt: skip
    system = {"inputs": inputs, "outputs": outputs, "rules": rules}
    points = [(5, 5), (3, 2), (8, 7.5), (6, 9)]
    methods = ("karnik-mendel", "karnik-mendel left", "karnik-mendel right", "nie-tan")
    for method in methods:
        slug = method.replace(" ", "-")
        for suffix, way in ways(
            method, only=(("endpoints", 101), ("endpoints", 201), ("midpoints", 100))
        ):
            yield case(f"type-2-{slug}-{suffix}", "Between a lower and an upper set.", system, points,
                       settings=settings(way))  # fmt: skip
        yield case(f"type-2-{slug}-product", "The same, strengths and cuts by the product.", system, points,
                   settings=settings(sampled(method, "endpoints", 101), implication="product", **{"and": "product"}))  # fmt: skip
        values = {
            **system,
            "outputs": {"z": variable(0, 20, small=constant(5), large=constant(14))},
        }
        values["rules"] = [rules[0], rules[1]]
        yield case(f"type-2-{slug}-values", "Values, weighed between two strengths.", values, points,
                   settings=settings(sampled(method), aggregation="sum", **{"and": "product"}))  # fmt: skip


TOPICS = {
    "shapes": shapes, "norms": norms, "no-rule": no_rule, "weights": weights, "plateaus": plateaus,
    "gaps": gaps, "sampled-centroids": sampled_centroids, "maxima": maxima, "sugeno": sugeno,
    "tsukamoto": tsukamoto, "type-2": type_2,
}  # fmt: skip
