"""Where to begin: ``fuzzyarm new``, the files that are ``shipped``, and the ``demo``."""

from __future__ import annotations

import argparse
import contextlib
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from fuzzyarm.api import check_text
from fuzzyarm.cli.command import (
    argument,
    command,
    counted,
    flag,
    json_of,
    out,
    print_json,
    say,
    write_text,
)
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.language import format_text
from fuzzyarm.language.queries import apply_edits, fixes
from fuzzyarm.language.tokens import name_text
from fuzzyarm.shipped_files import shipped, shipped_names
from fuzzyarm.text.files import write_atomically
from fuzzyarm.text.names import typed
from fuzzyarm.text.numbers import number_text

_NEW = r"""A commented rule base to start from, which passes `check`.

    fuzzyarm new joint                       error and error rate, 7 × 7 rules (PD)
    fuzzyarm new joint --kind pi             the same for the increment of the control (PI)
    fuzzyarm new fan --kind single           one input
    fuzzyarm new hand --input "e -6..6 NB NM ZE PM PB" --input "ce -3..3 N Z P" \
                      --output "u -10..10 NB NM ZE PM PB"

Writes NAME.frb in the current folder; what is there already is only replaced with --force.
"""


# --- The text of a starting file: a grid whose terms rise with the inputs, and what it says ---


@dataclass(frozen=True, slots=True)
class _Kind:
    """What a starting file is for: its first line, its descriptions and its variables."""

    purpose: str
    descriptions: tuple[str, str, str]
    inputs: tuple[str, ...]
    output: str


@dataclass(frozen=True, slots=True)
class _Variable:
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

_KINDS = {
    "pd": _Kind(
        "The output follows the error and its rate: a PD-type controller.",
        ("error, normalised", "error rate, normalised", "control, normalised"),
        (f"e {_SEVEN}", f"ce {_SEVEN}"),
        f"u {_SEVEN}",
    ),
    "pi": _Kind(
        "The output is added to the control in each step: a PI-type controller.",
        ("error, normalised", "error rate, normalised", "increment of the control"),
        (f"e {_SEVEN}", f"ce {_SEVEN}"),
        f"du {_SEVEN}",
    ),
    "single": _Kind(
        "The output follows one input.",
        ("what is measured", "", "what is done about it"),
        ("x 0..10 LOW MIDDLE HIGH",),
        "y 0..1 LOW MIDDLE HIGH",
    ),
}


def _starting_text(name: str, kind: _Kind, inputs: list[_Variable], output: _Variable) -> str:
    """Return a rule base with comments, in canonical form, on one or two inputs."""
    lines = [
        f"# {kind.purpose}",
        "# Check it with `fuzzyarm check`, see it with `fuzzyarm studio`.",
        f'rulebase {name_text(name)} "{kind.purpose.split(":")[0].rstrip(".").lower()}"',
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
    """Say where the wishes leave a doubt (an output without a middle term, for instance)."""
    for _ in range(text.count("\n")):
        doubts = check_text(text).diagnostics
        repairs = [fix for doubt in doubts for fix in fixes(doubt, text) if not fix.preferred]
        if not repairs:
            break
        text = apply_edits(text, repairs[0].edits)
    return text


def _declarations(kind: _Kind, inputs: list[_Variable], output: _Variable) -> list[str]:
    words = kind.descriptions
    roles = [("input", wish, words[i]) for i, wish in enumerate(inputs)]
    return [
        f'{role} {wish.written} {number_text(wish.low)} .. {number_text(wish.high)} "{said}"'
        for role, wish, said in [*roles, ("output", output, words[2])]
    ]


def _terms(wishes: list[_Variable]) -> list[str]:
    by_terms: dict[tuple[str, ...], list[str]] = {}
    for wish in wishes:
        by_terms.setdefault(wish.terms, []).append(wish.written)
    return [
        f"terms {', '.join(names)}: triangles {' '.join(map(name_text, terms))}"
        for terms, names in by_terms.items()
    ]


def _grid(inputs: list[_Variable], output: _Variable) -> list[str]:
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


def _cell(share: float, output: _Variable) -> str:
    # Ties go away from the middle on both sides alike, so that the grid stays antisymmetric.
    position = share * (len(output.terms) - 1)
    middle = 0.5 * (len(output.terms) - 1)
    distance = abs(position - middle)
    steps = int(distance + 0.5 + 1e-9) if middle == int(middle) else int(distance) + 0.5
    index = middle + (steps if position > middle else -steps)
    if abs(position - middle) < 1e-9:
        index = int(middle)
    return name_text(output.terms[int(min(max(index, 0), len(output.terms) - 1))])


def _levels(inputs: list[_Variable]) -> list[str]:
    return [
        f"  levels {wish.written}: {number_text(wish.low)} .. {number_text(wish.high)} count 13"
        for wish in inputs
    ]


def _expectation(inputs: list[_Variable], output: _Variable) -> str:
    given = ", ".join(f"{wish.written} = {number_text(wish.high)}" for wish in inputs)
    return f"expect {given} -> {output.written} > {number_text(output.middle)}"


_WISH = re.compile(
    r"\s*(?P<name>'[^']+'|[^\s'\"]+)\s+(?P<low>[-+.\deE]+?)\s*\.\.\s*(?P<high>[-+.\deE]+)"
    r"(?P<terms>(?:\s+(?:'[^']+'|[^\s'\"]+))*)\s*\Z"
)


class NewFileError(FuzzyarmError, ValueError):
    """A starting file that cannot be written as it was asked for."""


def _read_variable(text: str) -> _Variable:
    match = _WISH.match(text)
    if match is None:
        raise argparse.ArgumentTypeError(f"'{text}' is not of the form NAME LOW..HIGH TERM…")
    try:
        low, high = float(match["low"]), float(match["high"])
    except ValueError:
        raise argparse.ArgumentTypeError(f"the range in '{text}' is not two numbers") from None
    names = re.findall(r"'[^']+'|\S+", match["terms"])
    terms = tuple(name.strip("'") for name in names)
    return _Variable(match["name"].strip("'"), low, high, terms)


def _new(arguments: argparse.Namespace) -> int:
    path = Path(arguments.name if arguments.name.endswith(".frb") else f"{arguments.name}.frb")
    if not path.name.removesuffix(".frb").strip("."):
        message = f"'{arguments.name}' is not a name for a rule base"
        raise NewFileError(message, hint="take one such as joint")
    kind = _KINDS[arguments.kind]
    inputs = arguments.input or [_read_variable(text) for text in kind.inputs]
    output = arguments.output or _read_variable(kind.output)
    most = len(kind.inputs)
    if len(inputs) > most:
        raise NewFileError(
            f"a starting file of kind {arguments.kind} has at most {counted(most, 'input')}, "
            f"not {len(inputs)}",
            hint="add further inputs in the file, with `rules … when …`",
        )
    _demand_sound([*inputs, output])
    text = _starting_text(path.stem, kind, inputs, output)
    if path.exists() and not arguments.force:
        raise NewFileError(f"{path} is there already", hint="--force replaces it")
    write_atomically(path, text)
    say(f"{path}: written; see it with  fuzzyarm studio {typed(path)}")
    return 0


def _demand_sound(wishes: list[_Variable]) -> None:
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


# --- The files that come with the program ---

_SHIPPED = """List the rule bases, controllers and tables that come with fuzzyarm, or copy some.

Wherever a controller names a file, and none of that name stands beside it, the shipped one is
taken. To change one, copy it first.

  fuzzyarm shipped                   all of them
  fuzzyarm shipped pd7.frb           the text of one
  fuzzyarm shipped pd7.frb -o .      a copy in this folder
"""

_HEAD = re.compile(r'^(rulebase|controller|output)\s[^"\n]*"([^"]*)"', re.MULTILINE)
"""The line of a file that says what it is: of a table that of its output."""


def _list_shipped(arguments: argparse.Namespace) -> int:
    if not arguments.names:
        if arguments.out:
            raise ShippedCopyError("name the files to copy", hint="fuzzyarm shipped lists them")
        rows = [(name, *_what_is(name)) for name in shipped_names()]
        if arguments.json:
            print_json(
                [dict(zip(("name", "kind", "description"), row, strict=True)) for row in rows]
            )
            return 0
        widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
        say(*(f"{row[0]:<{widths[0]}}  {row[1]:<{widths[1]}}  {row[2]}".rstrip() for row in rows))
        return 0
    paths = [shipped(name) for name in arguments.names]
    if arguments.out:
        _copy(paths, Path(arguments.out), force=arguments.force)
        return 0
    for path in paths:
        write_text(path.read_text(encoding="utf-8"))
    return 0


class ShippedCopyError(FuzzyarmError, ValueError):
    """Shipped files that cannot be copied as it was asked for."""


def _copy(paths: list[Path], out: Path, *, force: bool) -> None:
    if len(paths) > 1 and not out.is_dir():
        raise ShippedCopyError(f"{out} is not a folder, for {counted(len(paths), 'file')}")
    targets = [out / path.name if out.is_dir() else out for path in paths]
    there = [target for target in targets if target.exists() and not force]
    if there:
        are, what = ("is", "it") if len(there) == 1 else ("are", "them")
        listed = ", ".join(map(str, there))
        raise ShippedCopyError(f"{listed} {are} there already", hint=f"--force replaces {what}")
    for path, target in zip(paths, targets, strict=True):
        write_atomically(target, path.read_text(encoding="utf-8"))
        say(f"{target}: a copy of the shipped {path.name}")


def _what_is(name: str) -> tuple[str, str]:
    """Return of which kind a shipped file is, and what it says of itself."""
    found = _HEAD.search(shipped(name).read_text(encoding="utf-8"))
    kinds = {"rulebase": "rule base", "controller": "controller", "output": "table"}
    return (kinds[found[1]], found[2]) if found else ("", "")


# --- The whole story ---

_DEMO = """\
The whole story on a shipped rule base: read it, break it, draw it, evaluate it, compile it.

Works in a temporary folder and leaves nothing behind, unless --keep names a folder for the
files it makes.
"""

_POINT = ("e=1.3", "ce=-2.2")


def _demo(arguments: argparse.Namespace) -> int:
    if arguments.keep is not None:
        Path(arguments.keep).mkdir(parents=True, exist_ok=True)
        with contextlib.chdir(arguments.keep):
            return _tell()
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-demo-") as folder, contextlib.chdir(folder):
        return _tell()


def _tell() -> int:
    text = shipped("pd7.frb").read_text(encoding="utf-8")
    Path("pd7.frb").write_text(text, encoding="utf-8")
    _say("A fuzzy controller is a text file: ranges, terms and a grid of 49 rules.")
    print(text)
    _say("It is checked: for mistakes, and for what is allowed but probably not meant.")
    statuses = [_step("check", "pd7.frb") == 0]
    _say("Every mistake of a file is found in one run, with its position and a hint.")
    Path("broken.frb").write_text(_broken(text), encoding="utf-8")
    statuses.append(_step("check", "broken.frb") == 1)
    _say("It is drawn: terms as small plots, rules as a grid.")
    statuses.append(_step("show", "pd7.frb") == 0)
    _say("It is evaluated, and tells why: which rules fire, how strongly, on which lines.")
    statuses.append(_step("eval", "pd7.frb", *_POINT, "--explain") == 0)
    _say("It is compiled to the table that a controller runs on, with the error this makes.")
    statuses.append(_step("compile", "pd7.frb", "-o", "pd7.lut") == 0)
    statuses.append(_step("show", "pd7.lut") == 0)
    statuses.append(_step("eval", "pd7.lut", *_POINT) == 0)
    _say(
        "Next: take a copy with `fuzzyarm shipped pd7.frb -o .`, edit it, and run the same"
        " commands on it."
    )
    return 0 if all(statuses) else 1


def _broken(text: str) -> str:
    """Return `text` with three slips of the kind that editing makes."""
    slips = (
        ("NM      NB  NM  NM", "NM      NB  NX  NM"),
        ("triangles", "triangels"),
        ("  PB      ZE  PS  PS  PM  PB  PB  PB", "  PB      ZE  PS  PS  PM  PB  PB"),
    )
    for right, wrong in slips:
        text = text.replace(right, wrong, 1)
    return text


def _say(sentence: str) -> None:
    print(f"\n── {sentence}\n")


def _step(*words: str) -> int:
    from fuzzyarm.cli.main import main

    print(f"$ fuzzyarm {' '.join(words)}")
    sys.stdout.flush()
    # What goes wrong is part of the story, so it is told in its place.
    with contextlib.redirect_stderr(sys.stdout):
        return main(words)


_FORM = 'NAME LOW..HIGH TERM…, for instance "e -6..6 NB NM ZE PM PB"'

COMMANDS = (
    command(
        "new",
        _NEW,
        _new,
        argument("name NAME", "name of the rule base; writes NAME.frb"),
        argument("--kind", "what it is for; pd by default", choices=tuple(_KINDS), default="pd"),
        argument("--input SPEC", f"an input: {_FORM}", action="append", type=_read_variable),
        argument("--output SPEC", "the output, likewise", type=_read_variable),
        flag("--force", "replace a file that is there"),
    ),
    command(
        "shipped",
        _SHIPPED,
        _list_shipped,
        argument("names NAME", "files to print, or with -o to copy", nargs="*"),
        out("DIR", "the folder, or the file, to copy to", required=False),
        flag("--force", "replace files that are there"),
        json_of("the list"),
    ),
    command("demo", _DEMO, _demo, argument("--keep DIR", "work in DIR and leave the files there")),
)
