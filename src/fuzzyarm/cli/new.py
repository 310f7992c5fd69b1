r"""A commented rule base to start from, which passes `check`.

    fuzzyarm new joint                       error and error rate, 7 × 7 rules (PD)
    fuzzyarm new joint --kind pi             the same for the increment of the control (PI)
    fuzzyarm new fan --kind single           one input
    fuzzyarm new hand --input "e -6..6 NB NM ZE PM PB" --input "ce -3..3 N Z P" \
                      --output "u -10..10 NB NM ZE PM PB"

Writes NAME.frb in the current folder; what is there already is only replaced with --force.
"""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from fuzzyarm.api import check_text
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.language import format_text
from fuzzyarm.language.queries import apply_edits, fixes
from fuzzyarm.language.tokens import name_text
from fuzzyarm.text.files import write_atomically
from fuzzyarm.text.numbers import number_text

# --- The text of a starting file: a grid whose terms rise with the inputs, and what it says ---


class Shape(StrEnum):
    """What a starting file is for."""

    PD = "pd"
    PI = "pi"
    SINGLE = "single"


@dataclass(frozen=True, slots=True)
class VariableWish:
    """A variable as it was asked for: its range and its terms from low to high."""

    name: str
    low: float
    high: float
    terms: tuple[str, ...]

    @property
    def written(self) -> str:
        """The name as it stands in a file."""
        return name_text(self.name)

    @property
    def middle(self) -> float:
        """The middle of the range."""
        return 0.5 * (self.low + self.high)


_PURPOSE = {
    Shape.PD: "The output follows the error and its rate: a PD-type controller.",
    Shape.PI: "The output is added to the control in each step: a PI-type controller.",
    Shape.SINGLE: "The output follows one input.",
}
_DESCRIPTIONS = {
    Shape.PD: ("error, normalised", "error rate, normalised", "control, normalised"),
    Shape.PI: ("error, normalised", "error rate, normalised", "increment of the control"),
    Shape.SINGLE: ("what is measured", "", "what is done about it"),
}


def starting_text(name: str, kind: Shape, inputs: list[VariableWish], output: VariableWish) -> str:
    """Return a rule base with comments, in canonical form.

    Parameters
    ----------
    name : str
        Of the rule base.
    kind : Shape
        Decides the words.
    inputs : list of VariableWish
        One or two.
    output : VariableWish
        The output.
    """
    lines = [
        f"# {_PURPOSE[kind]}",
        "# Check it with `fuzzyarm check`, see it with `fuzzyarm studio`.",
        f'rulebase {name_text(name)} "{_PURPOSE[kind].split(":")[0].rstrip(".").lower()}"',
        "",
        *_declarations(kind, inputs, output),
        "",
        "# Evenly spaced over the range, each foot under its neighbour's peak. For a shape of its",
        f"# own write  term {inputs[0].written} {name_text(inputs[0].terms[0])}: triangle …",
        *_terms([*inputs, output]),
        "",
        "inference and min, or max, implication min, aggregation max, defuzzifier centroid exact,"
        " outside clamp, no-rule error",
        "",
        *_grid(inputs, output),
        "",
        "lookup  # how `fuzzyarm compile` samples the rules to a table",
        *_levels(inputs),
        "",
        "# What must come out; `fuzzyarm check` evaluates it.",
        _expectation(inputs, output),
        "",
    ]
    return _with_allowances(format_text("\n".join(lines)))


def _with_allowances(text: str) -> str:
    """Say at the place where the wishes leave a doubt (an output without a middle term, say)."""
    for _ in range(text.count("\n")):
        doubts = check_text(text).diagnostics
        repairs = [fix for doubt in doubts for fix in fixes(doubt, text) if not fix.preferred]
        if not repairs:
            break
        text = apply_edits(text, repairs[0].edits)
    return text


def _declarations(kind: Shape, inputs: list[VariableWish], output: VariableWish) -> list[str]:
    words = _DESCRIPTIONS[kind]
    roles = [("input", wish, words[i]) for i, wish in enumerate(inputs)]
    return [
        f'{role} {wish.written} {number_text(wish.low)} .. {number_text(wish.high)} "{said}"'
        for role, wish, said in [*roles, ("output", output, words[2])]
    ]


def _terms(wishes: list[VariableWish]) -> list[str]:
    by_terms: dict[tuple[str, ...], list[str]] = {}
    for wish in wishes:
        by_terms.setdefault(wish.terms, []).append(wish.written)
    return [
        f"terms {', '.join(names)}: triangles {' '.join(map(name_text, terms))}"
        for terms, names in by_terms.items()
    ]


def _grid(inputs: list[VariableWish], output: VariableWish) -> list[str]:
    across = inputs[-1]
    header = " ".join(map(name_text, across.terms))
    if len(inputs) == 1:
        cells = " ".join(
            _cell(j / (len(across.terms) - 1), output) for j in range(len(across.terms))
        )
        return [
            f"rules {output.written}",
            f"  {across.written} {header}",
            f"  {output.written} {cells}",
        ]
    down = inputs[0]
    rows = [
        "# The variable before the backslash goes down, the one behind it across.",
        "# A dot would mean: no rule here.",
        f"rules {output.written}",
        f"  {down.written} \\ {across.written} {header}",
    ]
    for i, label in enumerate(down.terms):
        # The sum of both inputs, each from −1 to 1, held to the range of the output.
        places = [
            2 * i / (len(down.terms) - 1) - 1 + 2 * j / (len(across.terms) - 1) - 1
            for j in range(len(across.terms))
        ]
        cells = " ".join(_cell(0.5 + 0.5 * max(-1.0, min(1.0, x)), output) for x in places)
        rows.append(f"  {name_text(label)} {cells}")
    return rows


def _cell(share: float, output: VariableWish) -> str:
    # Ties go away from the middle on both sides alike, so that the grid stays antisymmetric.
    place = share * (len(output.terms) - 1)
    middle = 0.5 * (len(output.terms) - 1)
    distance = abs(place - middle)
    steps = int(distance + 0.5 + 1e-9) if middle == int(middle) else int(distance) + 0.5
    index = middle + (steps if place > middle else -steps)
    if abs(place - middle) < 1e-9:
        index = int(middle)
    return name_text(output.terms[int(min(max(index, 0), len(output.terms) - 1))])


def _levels(inputs: list[VariableWish]) -> list[str]:
    return [
        f"  levels {wish.written}: {number_text(wish.low)} .. {number_text(wish.high)} count 13"
        for wish in inputs
    ]


def _expectation(inputs: list[VariableWish], output: VariableWish) -> str:
    given = ", ".join(f"{wish.written} = {number_text(wish.high)}" for wish in inputs)
    return f"expect {given} -> {output.written} > {number_text(output.middle)}"


_WISH = re.compile(
    r"\s*(?P<name>'[^']+'|[^\s'\"]+)\s+(?P<low>[-+.\deE]+?)\s*\.\.\s*(?P<high>[-+.\deE]+)"
    r"(?P<terms>(?:\s+(?:'[^']+'|[^\s'\"]+))*)\s*\Z"
)
_DEFAULTS: dict[str, tuple[tuple[str, ...], str]] = {
    "pd": (
        ("e -6..6 NB NM NS ZE PS PM PB", "ce -6..6 NB NM NS ZE PS PM PB"),
        "u -6..6 NB NM NS ZE PS PM PB",
    ),
    "pi": (
        ("e -6..6 NB NM NS ZE PS PM PB", "ce -6..6 NB NM NS ZE PS PM PB"),
        "du -6..6 NB NM NS ZE PS PM PB",
    ),
    "single": (("x 0..10 LOW MIDDLE HIGH",), "y 0..1 LOW MIDDLE HIGH"),
}


class NewFileError(FuzzyarmError, ValueError):
    """A starting file that cannot be written as it was asked for."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm new``."""
    parser.add_argument("name", metavar="NAME", help="of the rule base; NAME.frb is written")
    parser.add_argument(
        "--kind", choices=tuple(_DEFAULTS), default="pd", help="what it is for (pd)"
    )
    wish = 'NAME LOW..HIGH TERM…, for instance "e -6..6 NB NM ZE PM PB"'
    parser.add_argument(
        "--input", action="append", type=_wish, metavar="SPEC", help=f"an input: {wish}"
    )
    parser.add_argument("--output", type=_wish, metavar="SPEC", help="the output, likewise")
    parser.add_argument("--force", action="store_true", help="replace a file that is there")


def _wish(text: str) -> VariableWish:
    match = _WISH.match(text)
    if match is None:
        raise argparse.ArgumentTypeError(f"'{text}' is not of the form NAME LOW..HIGH TERM…")
    try:
        low, high = float(match["low"]), float(match["high"])
    except ValueError:
        raise argparse.ArgumentTypeError(f"the range in '{text}' has no two numbers") from None
    names = re.findall(r"'[^']+'|\S+", match["terms"])
    terms = tuple(name.strip("'") for name in names)
    return VariableWish(match["name"].strip("'"), low, high, terms)


def run(arguments: argparse.Namespace) -> int:
    """Write the file; return 0."""
    path = Path(arguments.name if arguments.name.endswith(".frb") else f"{arguments.name}.frb")
    defaults = _DEFAULTS[arguments.kind]
    inputs = arguments.input or [_wish(text) for text in defaults[0]]
    output = arguments.output or _wish(defaults[1])
    most = 1 if arguments.kind == "single" else 2
    if len(inputs) > most:
        raise NewFileError(
            f"a starting file of kind {arguments.kind} has at most {most} input"
            f"{'s' if most > 1 else ''}, not {len(inputs)}",
            hint="add further inputs in the file, with `rules … when …`",
        )
    _demand_sound([*inputs, output])
    text = starting_text(path.stem, Shape(arguments.kind), inputs, output)
    if path.exists() and not arguments.force:
        raise NewFileError(f"{path} is there already", hint="--force replaces it")
    write_atomically(path, text)
    print(f"{path}: written; see it with  fuzzyarm studio {path}")
    return 0


def _demand_sound(wishes: list[VariableWish]) -> None:
    names = [wish.name for wish in wishes]
    for index, wish in enumerate(wishes):
        if wish.name in names[:index]:
            raise NewFileError(f"two variables are called '{wish.name}'")
        if not wish.low < wish.high:
            raise NewFileError(
                f"the range of '{wish.name}' does not go up: {wish.low:g} .. {wish.high:g}"
            )
        if len(wish.terms) < 2 or len(set(wish.terms)) < len(wish.terms):
            raise NewFileError(f"'{wish.name}' needs two or more different terms")
