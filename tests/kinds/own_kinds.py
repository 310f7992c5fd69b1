"""Kinds of a user's own, one of each sort, and rule bases that use them."""

from __future__ import annotations

from fuzzyarm import kinds, op

SHAPE, NORM, HEDGE = "cosine-bell", "yager2", "sharply"


def register() -> None:
    """Register a shape, a T-norm, an S-norm and a hedge."""
    kinds.tnorm("yager2", lambda a, b: 1 - op.minimum(1, op.sqrt((1 - a) ** 2 + (1 - b) ** 2)))
    kinds.snorm("yager2", lambda a, b: op.minimum(1, op.sqrt(a**2 + b**2)))
    kinds.hedge("sharply", lambda d: op.power(d, 1.5))
    kinds.shape(
        "cosine-bell",
        ("centre", "width"),
        lambda x, centre, width: op.where(
            abs(x - centre) < width, 0.5 * (1 + op.cos(op.pi * (x - centre) / width)), 0
        ),
    )


def remove() -> None:
    """Take them back."""
    kinds.TNORMS.remove(NORM)
    kinds.SNORMS.remove(NORM)
    kinds.HEDGES.remove(HEDGE)
    kinds.SHAPES.remove(SHAPE)


def text(
    *,
    conjunction: str = "product",
    disjunction: str = "max",
    implication: str = "min",
    aggregation: str = "max",
    hedge: str = "",
    antecedent_shape: str = "triangle -2 0 2",
    consequent_shape: str = "triangle -6 0 6",
    defuzzifier: str = "centroid exact",
) -> str:
    """Return a rule base on the inputs and the output that the controllers of the arm have."""
    return f"""rulebase own
input  e   -6 .. 6
input  ce  -6 .. 6
output u   -6 .. 6
terms e, ce, u: triangles N Z P
term e Z: {antecedent_shape}
term u Z: {consequent_shape}
inference and {conjunction}, or {disjunction}, implication {implication}
inference aggregation {aggregation}, defuzzifier {defuzzifier}, no-rule 0
rule if e is {hedge} Z and ce is N then u is N
rule if e is N or ce is P then u is Z
rule if e is {hedge} Z and ce is Z then u is P
rule if e is P and ce is not N then u is P with 0.5
"""


TEXTS = {
    "antecedent shape": text(antecedent_shape=f"{SHAPE} 0 4"),
    "consequent shape": text(consequent_shape=f"{SHAPE} 0 3"),
    "and": text(conjunction=NORM),
    "or": text(disjunction=NORM),
    "implication": text(implication=NORM),
    "aggregation": text(aggregation=NORM),
    "hedge": text(hedge=HEDGE),
    "sampled": text(
        conjunction=NORM,
        implication=NORM,
        aggregation=NORM,
        consequent_shape=f"{SHAPE} 0 3",
        defuzzifier="centroid(101)",
    ),
    "all": text(
        conjunction=NORM,
        disjunction=NORM,
        implication=NORM,
        aggregation=NORM,
        hedge=HEDGE,
        antecedent_shape=f"{SHAPE} 0 4",
        consequent_shape=f"{SHAPE} 0 3",
    ),
}
"""By what is the user's own in it."""
