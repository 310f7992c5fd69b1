"""Membership functions of FIS: MATLAB's and Octave's, and fuzzylite's additions."""

from __future__ import annotations

from fuzzyarm.formats.fis.lines import bracketed
from fuzzyarm.formats.fll.terms import FLL_SHAPES, formula_shape, fuzzylite_formula, linear_shape
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.numerals import all_written, numbers
from fuzzyarm.formats.shaping import make_shape
from fuzzyarm.rulebase.model import Shape
from fuzzyarm.rulebase.shapes import SHAPES

# Kind of shape, and where each of its numbers stands in the list of the file.
_ORDER: dict[str, tuple[str, tuple[int, ...]]] = {
    "trimf": ("triangle", (0, 1, 2)),
    "trapmf": ("trapezoid", (0, 1, 2, 3)),
    "gaussmf": ("gaussian", (1, 0)),
    "gauss2mf": ("two-sided-gaussian", (1, 0, 3, 2)),
    "gbellmf": ("bell", (2, 0, 1)),
    "sigmf": ("sigmoid", (1, 0)),
    "dsigmf": ("sigmoid-difference", (1, 0, 3, 2)),
    "psigmf": ("sigmoid-product", (1, 0, 3, 2)),
    "zmf": ("z", (0, 1)),
    "smf": ("s", (0, 1)),
    "pimf": ("pi", (0, 1, 2, 3)),
    "linsmf": ("ramp", (0, 1)),
    "linzmf": ("ramp", (1, 0)),
    "rampmf": ("ramp", (0, 1)),
    "rectmf": ("rectangle", (0, 1)),
    "cosinemf": ("cosine", (0, 1)),
    "concavemf": ("concave", (0, 1)),
    "spikemf": ("spike", (0, 1)),
    "binarymf": ("binary", (0, 1)),
    "singletonmf": ("singleton", (0,)),
}
MATLAB_SHAPES = frozenset(
    [
        "trimf",
        "trapmf",
        "gaussmf",
        "gauss2mf",
        "gbellmf",
        "sigmf",
        "dsigmf",
        "psigmf",
        "zmf",
        "smf",
        "pimf",
        "linsmf",
        "linzmf",
        "constant",
        "linear",
    ]
)
"""What MATLAB reads; Octave's toolkit has these but for linsmf and linzmf."""

_WORDS = (*_ORDER, "discretemf", "constant", "linear", "function")

_NAMES = {kind: name for name, (kind, _) in reversed(_ORDER.items())} | {
    "arc": "Arc",
    "semi-ellipse": "SemiEllipse",
}
"""Kind of shape → name in the file; fuzzylite has no ``…mf`` for the last two."""


def fis_shape(kind: Word, rest: Word, inputs: int, findings: Findings) -> Shape | None:
    """Return the shape of ``'kind',[numbers]``."""
    name = kind.text.lower()
    if name == "function":
        text = rest.text.strip().removeprefix("[").removesuffix("]")
        return formula_shape(Word(text, rest.span), "fuzzylite", findings)
    if name not in _WORDS and kind.text not in FLL_SHAPES:
        _unknown(kind, findings)
        return None
    values = numbers(bracketed(rest), findings)
    return None if values is None else _of_numbers(kind, values, inputs, findings)


def _of_numbers(kind: Word, values: list[float], inputs: int, findings: Findings) -> Shape | None:
    name = kind.text.lower()
    if name == "constant":
        return make_shape("singleton", values[-1:], kind, findings)
    if name == "linear":
        return linear_shape(values, inputs, kind, findings)
    if name == "discretemf":
        height = values.pop() if len(values) % 2 else 1.0
        return make_shape("points", values, kind, findings, height=height, ties="last")
    shape, order = _ORDER[name] if name in _ORDER else _class(kind.text)
    height = values.pop() if len(values) == len(order) + 1 else 1.0
    if len(values) == len(order):
        values = [values[index] for index in order]
    if name in ("smf", "zmf"):
        values = _crossed(values)
    return make_shape(shape, values, kind, findings, height=height)


def _unknown(kind: Word, findings: Findings) -> None:
    if not kind.text:
        findings.error("syntax", "the kind of the membership function is missing", kind)
        return
    if kind.text.lower().endswith("mf"):
        message = f"'{kind.text[:40]}' is a function of its author's own, which is not in the file"
        findings.error("unknown-shape", message, kind)
        return
    findings.unknown("unknown-shape", "the membership function", kind, _WORDS)


def _class(name: str) -> tuple[str, tuple[int, ...]]:
    shape = FLL_SHAPES[name]
    return shape, tuple(range(len(SHAPES[shape].parameters)))


def _crossed(values: list[float]) -> list[float]:
    """MATLAB makes a step half-way of an s or z whose numbers are the wrong way round."""
    if len(values) == 2 and values[0] > values[1]:
        middle = 0.5 * (values[0] + values[1])
        return [middle, middle]
    return values


def fis_term(shape: Shape, producer: str) -> tuple[str, str]:
    """Return kind and bracketed numbers of a shape, as `producer` calls it."""
    if shape.kind == "formula":
        return "function", f"[{fuzzylite_formula(shape.formula)}]"
    height = () if shape.height == 1.0 else (shape.height,)
    if shape.kind == "singleton":
        return "constant", f"[{all_written(shape.parameters)}]"
    if shape.kind == "linear":
        return "linear", f"[{all_written(shape.parameters)}]"
    if shape.kind == "points":
        return "discretemf", f"[{all_written((*shape.parameters, *height))}]"
    name = _NAMES[shape.kind]
    if shape.kind == "ramp":
        name = "linsmf" if shape.parameters[0] <= shape.parameters[1] else "linzmf"
        name = "rampmf" if producer == "fuzzylite" else name
    _, order = _ORDER[name] if name in _ORDER else _class(name)
    values = [0.0] * len(order)
    for position, index in enumerate(order):
        values[index] = shape.parameters[position]
    return name, f"[{all_written((*values, *height))}]"
