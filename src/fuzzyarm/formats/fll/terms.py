"""The terms of fuzzylite: class names and the order of their numbers."""

from __future__ import annotations

from fuzzyarm.formats.formula import FormulaError, read_formula, without_constants, write_formula
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.numerals import numbers, written
from fuzzyarm.formats.shaping import make_shape
from fuzzyarm.rulebase.model import Shape
from fuzzyarm.rulebase.shapes import SHAPES

FLL_SHAPES = {
    "Arc": "arc",
    "Bell": "bell",
    "Binary": "binary",
    "Concave": "concave",
    "Cosine": "cosine",
    "Gaussian": "gaussian",
    "GaussianProduct": "two-sided-gaussian",
    "PiShape": "pi",
    "Ramp": "ramp",
    "Rectangle": "rectangle",
    "SemiEllipse": "semi-ellipse",
    "Sigmoid": "sigmoid",
    "SigmoidDifference": "sigmoid-difference",
    "SigmoidProduct": "sigmoid-product",
    "Spike": "spike",
    "SShape": "s",
    "Trapezoid": "trapezoid",
    "Triangle": "triangle",
    "ZShape": "z",
}
"""Class name → kind of shape. The numbers stand in the same order but for two sigmoids."""

FLL_NAMES = {kind: name for name, kind in FLL_SHAPES.items()}
_TWO_SIGMOIDS = frozenset({"sigmoid-difference", "sigmoid-product"})
CLASSES = (*FLL_SHAPES, "Constant", "Discrete", "Function", "Linear")


def shape_of(
    name: Word, parameters: list[Word], formula: Word, inputs: int, findings: Findings
) -> Shape | None:
    """Return the shape of a term.

    Parameters
    ----------
    name : Word
        The class, ``Triangle`` and so on.
    parameters : list of Word
        What follows it.
    formula : Word
        The same as one text, for ``Function``.
    inputs : int
        Number of inputs, which a ``Linear`` must match.
    findings : Findings
        Where faults go.
    """
    if name.text == "Function":
        return formula_shape(formula, "fuzzylite", findings)
    if name.text not in CLASSES:
        findings.unknown("unknown-shape", "the term class", name, CLASSES)
        return None
    values = numbers(parameters, findings)
    if values is None:
        return None
    if name.text == "Constant":
        return make_shape("singleton", values, name, findings)
    if name.text == "Linear":
        return linear_shape(values, inputs, name, findings)
    return _fuzzy(name, values, findings)


def _fuzzy(name: Word, values: list[float], findings: Findings) -> Shape | None:
    height = 1.0
    if name.text == "Discrete":
        if len(values) % 2:
            height = values.pop()
        return make_shape("points", values, name, findings, height=height, ties="last")
    kind = FLL_SHAPES[name.text]
    if len(values) == len(SHAPES[kind].parameters) + 1:
        height = values.pop()
    if kind in _TWO_SIGMOIDS and len(values) == 4:
        values[2], values[3] = values[3], values[2]
    if kind == "ramp" and len(values) == 2 and values[0] == values[1]:
        findings.error("unordered-corners", "a Ramp from a number to itself is nowhere", name)
        return None
    return make_shape(kind, values, name, findings, height=height)


def linear_shape(values: list[float], inputs: int, at: Word, findings: Findings) -> Shape | None:
    """Return a linear consequent; a missing constant is 0."""
    if len(values) == inputs:
        values = [*values, 0.0]
    if len(values) != inputs + 1:
        message = (
            f"a linear term needs a factor for each of the {inputs} inputs and a constant, "
            f"not {len(values)} numbers"
        )
        findings.error("parameter-count", message, at)
        return None
    return make_shape("linear", values, at, findings)


def formula_shape(formula: Word, dialect: str, findings: Findings) -> Shape | None:
    """Return a formula, rewritten so that every reader takes it alike."""
    try:
        tree = read_formula(formula.text, dialect)
    except FormulaError as fault:
        findings.error("bad-formula", f"in '{formula.text[:60]}': {fault}", formula)
        return None
    return Shape("formula", (), 1.0, write_formula(without_constants(tree, set())))


def term_text(shape: Shape, rename: dict[str, str]) -> str | None:
    """Return class and numbers of a shape, or None where fuzzylite has no such class."""
    if shape.kind == "formula":
        tree = read_formula(shape.formula, "fuzzyarm")
        return f"Function {fuzzylite_formula(write_formula(tree, rename))}"
    values = list(shape.parameters)
    if shape.kind in _TWO_SIGMOIDS:
        values[2], values[3] = values[3], values[2]
    if shape.kind in ("singleton", "linear"):
        if shape.height != 1.0:
            return None
        name = "Constant" if shape.kind == "singleton" else "Linear"
    else:
        name = "Discrete" if shape.kind == "points" else FLL_NAMES[shape.kind]
        if shape.height != 1.0:
            values.append(shape.height)
    return " ".join([name, *map(written, values)])


def fuzzylite_formula(text: str) -> str:
    """Return a canonical formula with the unary minus that fuzzylite knows."""
    out: list[str] = []
    for index, letter in enumerate(text):
        before = text[:index].rstrip()[-1:]
        following = text[index + 1 : index + 2]
        unary = letter == "-" and before in ("", "(", ",", *"+-*/^%") and following != " "
        out.append("~" if unary else letter)
    return "".join(out)
