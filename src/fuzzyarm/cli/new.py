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
from pathlib import Path

from fuzzyarm.cli.starting_text import Shape, VariableWish, starting_text
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.files import write_atomically

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
