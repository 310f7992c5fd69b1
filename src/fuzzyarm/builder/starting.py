"""The text of a file to start from: a rule base with comments, which passes a check.

A grid whose terms rise with the inputs, for one or two inputs, and what must come out. It is what
``fuzzyarm new`` writes and what the designer begins a file with.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from fuzzyarm.api import check_text
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.language import format_text
from fuzzyarm.language.queries import apply_edits, fixes
from fuzzyarm.language.tokens import name_text
from fuzzyarm.text.numbers import number_text


@dataclass(frozen=True, slots=True)
class Start:
    """What a starting file is for: its first line, its descriptions and its variables."""

    purpose: str
    descriptions: tuple[str, str, str]
    inputs: tuple[str, ...]
    output: str


@dataclass(frozen=True, slots=True)
class Wish:
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


_SEVEN = "-6..6 NB NM NS ZE PS PM PB"

STARTS = {
    "pd": Start(
        "The output follows the error and its rate: a PD-type controller.",
        ("error, normalised", "error rate, normalised", "control, normalised"),
        (f"e {_SEVEN}", f"ce {_SEVEN}"),
        f"u {_SEVEN}",
    ),
    "pi": Start(
        "The output is added to the control in each step: a PI-type controller.",
        ("error, normalised", "error rate, normalised", "increment of the control"),
        (f"e {_SEVEN}", f"ce {_SEVEN}"),
        f"du {_SEVEN}",
    ),
    "single": Start(
        "The output follows one input.",
        ("what is measured", "", "what is done about it"),
        ("x 0..10 LOW MIDDLE HIGH",),
        "y 0..1 LOW MIDDLE HIGH",
    ),
}
"""Kinds of starting files by name."""


class NewFileError(FuzzyarmError, ValueError):
    """A starting file that cannot be written as it was asked for."""


_WISH = re.compile(
    r"\s*(?P<name>'[^']+'|[^\s'\"]+)\s+(?P<low>[-+.\deE]+?)\s*\.\.\s*(?P<high>[-+.\deE]+)"
    r"(?P<terms>(?:\s+(?:'[^']+'|[^\s'\"]+))*)\s*\Z"
)


def read_wish(text: str) -> Wish:
    """Return the variable that a line ``NAME LOW..HIGH TERM…`` asks for.

    Parameters
    ----------
    text : str
        For instance ``e -6..6 NB NM ZE PM PB``; a name with blanks in single quotes.

    Raises
    ------
    NewFileError
        If it is not of that form.
    """
    match = _WISH.match(text)
    if match is None:
        raise NewFileError(f"'{text}' is not of the form NAME LOW..HIGH TERM…")
    try:
        low, high = float(match["low"]), float(match["high"])
    except ValueError:
        raise NewFileError(f"the range in '{text}' is not two numbers") from None
    names = re.findall(r"'[^']+'|\S+", match["terms"])
    terms = tuple(name.strip("'") for name in names)
    return Wish(match["name"].strip("'"), low, high, terms)


def starting_text(
    name: str,
    kind: str = "pd",
    inputs: Sequence[Wish] | None = None,
    output: Wish | None = None,
) -> str:
    """Return a rule base with comments, in canonical form, on one or two inputs.

    Parameters
    ----------
    name : str
        Of the rule base.
    kind : str
        What it is for, one of `STARTS`.
    inputs, output : Wish, optional
        The variables; those of the kind by default.

    Raises
    ------
    NewFileError
        If the variables cannot stand in such a file.
    """
    start = STARTS[kind]
    inputs = list(inputs or map(read_wish, start.inputs))
    output = output or read_wish(start.output)
    most = len(start.inputs)
    if len(inputs) > most:
        counted = f"{most} input{'' if most == 1 else 's'}"
        raise NewFileError(
            f"a starting file of kind {kind} has at most {counted}, not {len(inputs)}",
            hint="add further inputs in the file, with `rules … when …`",
        )
    _demand_sound([*inputs, output])
    lines = [
        f"# {start.purpose}",
        "# Check it with `fuzzyarm check`, see it with `fuzzyarm studio`.",
        f'rulebase {name_text(name)} "{start.purpose.split(":")[0].rstrip(".").lower()}"',
        "",
        *_declarations(start, inputs, output),
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


def _demand_sound(wishes: list[Wish]) -> None:
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


def _with_allowances(text: str) -> str:
    """Say where the wishes leave a doubt (an output without a middle term, for instance)."""
    for _ in range(text.count("\n")):
        doubts = check_text(text).diagnostics
        repairs = [fix for doubt in doubts for fix in fixes(doubt, text) if not fix.preferred]
        if not repairs:
            break
        text = apply_edits(text, repairs[0].edits)
    return text


def _declarations(kind: Start, inputs: list[Wish], output: Wish) -> list[str]:
    words = kind.descriptions
    roles = [("input", wish, words[i]) for i, wish in enumerate(inputs)]
    return [
        f'{role} {wish.written} {number_text(wish.low)} .. {number_text(wish.high)} "{said}"'
        for role, wish, said in [*roles, ("output", output, words[2])]
    ]


def _terms(wishes: list[Wish]) -> list[str]:
    by_terms: dict[tuple[str, ...], list[str]] = {}
    for wish in wishes:
        by_terms.setdefault(wish.terms, []).append(wish.written)
    return [
        f"terms {', '.join(names)}: triangles {' '.join(map(name_text, terms))}"
        for terms, names in by_terms.items()
    ]


def _grid(inputs: list[Wish], output: Wish) -> list[str]:
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
        sums = [
            2 * i / (len(down.terms) - 1) - 1 + 2 * j / (len(across.terms) - 1) - 1
            for j in range(len(across.terms))
        ]
        cells = " ".join(_cell(0.5 + 0.5 * max(-1.0, min(1.0, x)), output) for x in sums)
        rows.append(f"  {name_text(label)} {cells}")
    return rows


def _cell(share: float, output: Wish) -> str:
    # Ties go away from the middle on both sides alike, so that the grid stays antisymmetric.
    position = share * (len(output.terms) - 1)
    middle = 0.5 * (len(output.terms) - 1)
    distance = abs(position - middle)
    steps = int(distance + 0.5 + 1e-9) if middle == int(middle) else int(distance) + 0.5
    index = middle + (steps if position > middle else -steps)
    if abs(position - middle) < 1e-9:
        index = int(middle)
    return name_text(output.terms[int(min(max(index, 0), len(output.terms) - 1))])


def _levels(inputs: list[Wish]) -> list[str]:
    return [
        f"  levels {wish.written}: {number_text(wish.low)} .. {number_text(wish.high)} count 13"
        for wish in inputs
    ]


def _expectation(inputs: list[Wish], output: Wish) -> str:
    given = ", ".join(f"{wish.written} = {number_text(wish.high)}" for wish in inputs)
    return f"expect {given} -> {output.written} > {number_text(output.middle)}"
