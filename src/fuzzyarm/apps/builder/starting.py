"""Starting files with comments, for ``fuzzyarm new`` and the designer.

A rule base that passes a check (one or two inputs, a grid whose terms rise with them, an
expectation), a controller of the motor around a rule base, or a heading alone.
"""

from __future__ import annotations

import math
import random
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import printable, quote, typed
from fuzzyarm.base.numbers import counted, number_text
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text
from fuzzyarm.language.edit import apply_edits, fixes, graded
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase
from fuzzyarm.language.tokens import name_text


@dataclass(frozen=True, slots=True)
class StartingFile:
    """A kind of starting file: its purpose, descriptions and variables."""

    purpose: str
    descriptions: tuple[str, str, str]
    inputs: tuple[str, ...]
    output: str


@dataclass(frozen=True, slots=True)
class Wish:
    """A requested variable: its range and its terms from low to high."""

    name: str
    low: float
    high: float
    terms: tuple[str, ...]

    @property
    def written(self) -> str:
        """The name as written in a file."""
        return name_text(self.name)

    @property
    def middle(self) -> float:
        """The middle of the range."""
        return 0.5 * (self.low + self.high)


_SEVEN = "-6..6 NB NM NS ZE PS PM PB"

STARTS = {
    "pd": StartingFile(
        "The output follows the error and its rate: a PD-type controller.",
        ("error, normalised", "error rate, normalised", "control, normalised"),
        (f"e {_SEVEN}", f"ce {_SEVEN}"),
        f"u {_SEVEN}",
    ),
    "pi": StartingFile(
        "The output is added to the control in each step: a PI-type controller.",
        ("error, normalised", "error rate, normalised", "increment of the control"),
        (f"e {_SEVEN}", f"ce {_SEVEN}"),
        f"du {_SEVEN}",
    ),
    "single": StartingFile(
        "The output follows one input.",
        ("measured value", "", "actuation"),
        ("x 0..10 LOW MIDDLE HIGH",),
        "y 0..1 LOW MIDDLE HIGH",
    ),
}
"""Kinds of starting rule bases by name."""

BLANK, CONTROLLER = "blank", "controller"

PURPOSES = {
    BLANK: "A heading alone: variables, terms and rules are yours.",
    **{name: start.purpose for name, start in STARTS.items()},
    CONTROLLER: "A rule base on a plant: errors of its ports, gains and actuators.",
}
"""All kinds of starting files by name, with their purposes."""


class NewFileError(FuzzyarmError, ValueError):
    """A starting file cannot be written as requested."""


_WISH = re.compile(
    r"\s*(?P<name>'[^']+'|[^\s'\"]+)\s+(?P<low>[-+.\deE]+?)\s*\.\.\s*(?P<high>[-+.\deE]+)"
    r"(?P<terms>(?:\s+(?:'[^']+'|[^\s'\"]+))*)\s*\Z"
)


def read_wish(text: str) -> Wish:
    """Return the variable of a line ``NAME LOW..HIGH TERM…``."""
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
    *,
    sugeno: bool = False,
) -> str:
    """Return a rule base with comments, in canonical form, on one or two inputs."""
    if kind == BLANK:
        if inputs or output:
            raise NewFileError(
                "a blank file has no variables", hint="leave them out, or take another kind"
            )
        return _BLANK.format(name_text(name))
    start = STARTS[kind]
    inputs = list(inputs or map(read_wish, start.inputs))
    output = output or read_wish(start.output)
    most = len(start.inputs)
    if len(inputs) > most:
        raise NewFileError(
            f"a starting file of kind {kind} has at most {counted(most, 'input')},"
            f" not {len(inputs)}",
            hint="add further inputs in the file, with `rules … when …`",
        )
    _demand_sound([*inputs, output])
    lines = [
        f"# {start.purpose}",
        "# Check it with `fuzzyarm check`, see it with `fuzzyarm watch`.",
        f'rulebase {name_text(name)} "{start.purpose.split(":")[0].rstrip(".").lower()}"',
        "",
        *_declarations(start, inputs, output),
        "",
        "# Evenly spaced over the range, each foot under its neighbour's peak. For a shape of its",
        f"# own write  term {inputs[0].written} {name_text(inputs[0].terms[0])}: triangle …",
        *(_terms([*inputs, output]) if not sugeno else [*_terms(inputs), *_values(output)]),
        "",
        f"inference {_SUGENO if sugeno else _MAMDANI}, outside clamp, no-rule error",
        "",
        *_grid(inputs, output),
        "",
        "lookup  # how `fuzzyarm compile` samples the rules to a table",
        *_levels(inputs),
        "",
        "# The expected output; `fuzzyarm check` verifies it.",
        _expectation(inputs, output),
        "",
    ]
    return _with_allowances(format_text("\n".join(lines)))


_MAMDANI = "and min, or max, implication min, aggregation max, defuzzifier centroid exact"
_SUGENO = (
    "and product, or probor, implication product, aggregation sum, defuzzifier weighted-average"
)

_BLANK = """\
# First inputs and outputs, then their terms, then the rules.
# `fuzzyarm check` lists the missing parts.
rulebase {} "its purpose"
"""

# --- A controller around a rule base ---


@dataclass(frozen=True, slots=True)
class Ground:
    """The plant of a starting controller, with its lines.

    `signals` feed an input each, with the unit of its gain and the signal value at the input's end;
    `drive` makes the port from the rules' output.
    """

    plant: str
    purpose: str
    period: str
    axis: str
    first: tuple[str, ...]
    signals: tuple[tuple[str, str, float], ...]
    gain: tuple[str, str, float]
    drive: tuple[str, ...]


_SHAFT = Ground(
    "motor",
    "A motor turns a shaft to a reference",
    "1 ms",
    "shaft",
    (),
    (("e = error of position", "1/rad", 0.375), ("ce = error of velocity", "s/rad", 8.5)),
    ("u", "V", 24.0),
    ("drive voltage = u, within -24 .. 24",),
)

_ROOM = Ground(
    "room",
    "A heating keeps a room at a reference: increments of its power are added up",
    "10 s",
    "room",
    ("error = error of temperature",),
    (("e = error", "1/K", 5.0), ("ce = rate of error, filter 60 s", "s/K", 0.01)),
    ("du", "%/s", 0.4),
    ("power = integral of du, within 0 .. 100, start 0", "drive power = power"),
)


def controller_text(name: str, file: str, rulebase: RuleBase) -> str:
    """Return a controller around a rule base, with comments, in canonical form.

    The inputs are an error and its rate, with gains that scale them to their ranges; the first
    output drives the plant: the motor, or the room for an output named an increment or a change
    (PI).
    """
    if len(rulebase.inputs) > 2:
        raise NewFileError(
            f"{file} has {len(rulebase.inputs)} inputs; a starting controller makes two, an error"
            " and its rate",
            hint="write the others as signals of a controller",
        )
    adds_up = re.search(r"\b(increment|change)\b", rulebase.outputs[0].description)
    ground = _ROOM if adds_up else _SHAFT
    result, unit, end = ground.gain
    gains, lines = [], list(ground.first)
    for (signal, of, at), variable in zip(ground.signals, rulebase.inputs, strict=False):
        gain = f"G_{signal.split()[0]}"
        gains.append(_gain(gain, _reach(variable) / at, of))
        source, comma, filtered = signal.partition(",")
        lines.append(f"{source} * {gain}{comma}{filtered}")
    gains.append(_gain(f"G_{result}", end / _reach(rulebase.outputs[0]), unit))
    names = ", ".join(line.split()[0] for line in lines[len(ground.first) :])
    call = f"rules {name_text(Path(file).stem)}({names})"
    if len(rulebase.outputs) > 1:
        several = [f"{result}{number}" for number, _ in enumerate(rulebase.outputs, 1)]
        lines += [f"{', '.join(several)} = {call}", f"{result} = {several[0]} * G_{result}"]
    else:
        lines.append(f"{result} = {call} * G_{result}")
    title = printable(file).replace('"', "'")
    text = [
        f"# {ground.purpose}, by the rules of {title}.",
        f"# Run it with `fuzzyarm simulate {typed(f'{name}.frb')} --plant {ground.plant}`.",
        "# For another plant, write its ports after `of` and `drive`, and fit the gains.",
        f'controller {name_text(name)} "{title} on the plant {ground.plant}"',
        "",
        f"use {name_text(Path(file).stem)} from {quote(file, chr(34))}",
        "",
        f"period {ground.period}",
        "",
        *gains,
        "",
        f"axis {ground.axis}",
        *(f"  {line}" for line in [*lines, *ground.drive]),
        "",
    ]
    return format_text("\n".join(text))


def _reach(variable: Input | Output) -> float:
    """Return the greatest magnitude of a variable; 1 if it is unbounded."""
    ends = [abs(end) for end in (variable.low, variable.high) if math.isfinite(end)]
    return max(ends, default=1.0) or 1.0


def _gain(name: str, value: float, unit: str) -> str:
    # Two digits: it is a first guess for a person to change.
    near = float(f"{value:.2g}")
    low, high = (number_text(float(f"{factor * near:.2g}")) for factor in (0.1, 10.0))
    return f'gain {name} = {number_text(near)} "{unit}", tune {low} .. {high} log'


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
    """Allow the remaining doubts of a request, such as an output without a middle term."""
    # A repair moves the positions after it: one at a time, at most one for each line.
    for _ in range(text.count("\n")):
        doubts = check_text(text).diagnostics
        repairs = [fix for doubt in doubts for fix in fixes(doubt, text) if not fix.preferred]
        if not repairs:
            break
        text = apply_edits(text, repairs[0].edits)
    return text


def _declarations(kind: StartingFile, inputs: list[Wish], output: Wish) -> list[str]:
    words = kind.descriptions
    roles = [("input", wish, words[i]) for i, wish in enumerate(inputs)]
    return [
        f'{role} {wish.written} {number_text(wish.low)} .. {number_text(wish.high)} "{description}"'
        for role, wish, description in [*roles, ("output", output, words[2])]
    ]


def _terms(wishes: list[Wish]) -> list[str]:
    by_terms: dict[tuple[str, ...], list[str]] = {}
    for wish in wishes:
        by_terms.setdefault(wish.terms, []).append(wish.written)
    return [
        f"terms {', '.join(names)}: triangles {' '.join(map(name_text, terms))}"
        for terms, names in by_terms.items()
    ]


def _values(output: Wish) -> list[str]:
    names = " ".join(map(name_text, output.terms))
    return [
        "# Values, not sets: the output is their average, weighted by how strongly the rules fire.",
        f"terms {output.written}: singletons {names}",
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
    return name_text(graded(share, output.terms))


def _levels(inputs: list[Wish]) -> list[str]:
    return [
        f"  levels {wish.written}: {number_text(wish.low)} .. {number_text(wish.high)} count 13"
        for wish in inputs
    ]


def _expectation(inputs: list[Wish], output: Wish) -> str:
    inputs_text = ", ".join(f"{wish.written} = {number_text(wish.high)}" for wish in inputs)
    return f"expect {inputs_text} -> {output.written} > {number_text(output.middle)}"


# --- Samples to learn from ---


def valve_samples() -> dict[str, str]:
    """Return the files of the lesson about data: flow of a valve over its lift and pressure."""
    draw = random.Random(1)
    lines = ["lift,pressure,flow"]
    for _ in range(120):
        lift, pressure = draw.uniform(0, 10), draw.uniform(1, 4)
        flow = lift**1.5 * pressure**0.5 / 4 + draw.gauss(0, 0.1)
        lines.append(f"{lift:.2f},{pressure:.2f},{flow:.2f}")
    return {
        "valve.csv": "\n".join(lines[:91]),
        "later.csv": "\n".join([lines[0], *lines[91:]]),
    }
