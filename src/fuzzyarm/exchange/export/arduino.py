"""Libraries for Arduino and projects for PlatformIO, with a sketch, a test and measured figures."""

from __future__ import annotations

import json
import math
import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.avr import (
    FLAGS,
    TOOLS,
    Measured,
    MeasuredStep,
    Pace,
    clock_of,
    demand_pace,
    has_compiler,
    measure,
    pace_of,
    unchecked,
)
from fuzzyarm.exchange.export.boards import Board, Footprint, demand_fit
from fuzzyarm.exchange.export.c import LIBRARY, PORTS
from fuzzyarm.exchange.export.c_files import CText, controller_c, routines_c
from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.exchange.export.document import filled_text
from fuzzyarm.exchange.export.guard import step_name
from fuzzyarm.exchange.export.numbers import C_TYPES, ExportError, Kind, c_number
from fuzzyarm.exchange.export.routine import Routine, plain
from fuzzyarm.exchange.export.steps import StepVariable
from fuzzyarm.exchange.export.table import WholeNumberScale
from fuzzyarm.symbolic.identifiers import ARDUINO_MACROS, Names, identifier
from fuzzyarm.version import __version__

_IN_SKETCH = {"setup", "loop", "delay", "millis", "micros", "Serial", "pin"}

_SECONDS_BETWEEN_LINES = 0.5
"""How often the sketch of a controller prints."""

_SKETCH_CALLS = 48
"""Measured calls of the self-test: a simulated second takes a second."""


@json_properties(
    "files=names functions=library.prototypes board=board.name constants state measured"
)
@dataclass(frozen=True)
class BoardFolder:
    """A folder for an IDE, not yet written.

    Attributes
    ----------
    files : dict of str to str
        Texts by their paths in the folder.
    library : CText
        Its content.
    board : Board
        The board.
    measured : Measured or None
        Its cost there; None where nothing here can measure it.
    constants, state : int
        Bytes of tables, and of its variables in a program.
    doubt : str
        A sentence on unchecked parts; empty if there are none.
    """

    files: dict[str, str]
    library: CText
    board: Board
    measured: Measured | None
    constants: int
    state: int
    doubt: str = ""

    @property
    def names(self) -> list[str]:
        """Names of the files."""
        return sorted(self.files)


@dataclass(frozen=True)
class BoardPart:
    """The common part of routines and controllers on a board."""

    stem: str
    words: str  # its purpose, in one line
    library: CText
    call: MeasuredStep
    sketch: str
    state: int
    stack: int
    notes: list[str]
    period: float | None = None  # of a controller, in s
    inputs: int = 0  # read from pins by the sketch

    def sources(self) -> dict[str, str]:
        """Return the texts of the library by the names of their files."""
        return {f"{self.stem}{end}": text for end, text in self.library.files.items()}

    def measured(self, board: Board) -> Measured | None:
        """Return its cost on a board; None if it cannot be measured here."""
        if not (board.avr and has_compiler()):
            return None
        return measure(board, self.sources(), self.stem, self.call)


def board_folder(
    exported: Sequence[Routine] | ControllerProgram,
    stem: str,
    board: Board,
    place: str,
    others: Mapping[str, Callable[[], ControllerProgram]] = MappingProxyType({}),
) -> BoardFolder:
    """Return the folder of routines or of a controller, measured if possible."""
    if isinstance(exported, ControllerProgram):
        part = board_part(exported, stem, board)
    else:
        part = _routines_part(exported, stem, board)
    constants = part.library.printer.flash
    largest = part.library.printer.largest
    words = "its tables alone"
    footprint = Footprint(constants, part.state, part.stack, words, constants, largest)
    demand_fit(footprint, board, stem)
    measured = part.measured(board)
    if measured is not None:
        demand_fit(measured.footprint, board, stem)
    doubt = ""
    if part.period is not None:
        pace = pace_of(measured, board, part.inputs)
        paces = {
            option: lambda make=make: _other_pace(make, stem, board)
            for option, make in others.items()
        }
        demand_pace(pace, part.period, stem, board, paces)
        doubt = unchecked(measured, board, part.period)
    files = dict(_files(part, board, place, measured, doubt))
    return BoardFolder(files, part.library, board, measured, constants, part.state, doubt)


def _other_pace(make: Callable[[], ControllerProgram], stem: str, board: Board) -> Pace | None:
    """Return the cost of a turn of another program; None if it cannot be built, or is too large."""
    try:
        part = board_part(make(), stem, board)
        measured = part.measured(board)
        if measured is not None:
            demand_fit(measured.footprint, board, stem)
    except ExportError:
        return None
    return pace_of(measured, board, part.inputs)


# --- The board ---


def _routines_part(routines: Sequence[Routine], stem: str, board: Board) -> BoardPart:
    library = routines_c(routines, stem, stem, LIBRARY)
    first = routines[0]
    vectors = first.vectors()
    rows = _spread([list(row) for row in zip(*vectors.inputs, strict=True)])
    kind = C_TYPES[first.kind]
    names = [f"x_{k}" for k in range(len(first.arguments))]
    globals_ = [f"static volatile {kind} {', '.join([*names, 'result'])};"]
    call = MeasuredStep(
        header=f"{stem}.h",
        declarations=["#include <stdint.h>", *globals_, *_rows("given", kind, rows, first.kind)],
        start=[],
        load=[f"{name} = given[k][{k}];" for k, name in enumerate(names)],
        call=f"result = {_function(library.prototypes[0])}({', '.join(names)});",
        count=len(rows),
        arrays=(len(names) + 1) * np.dtype(first.kind).itemsize,
        self_test=library.self_test,
    )
    words = f"{', '.join(r.output.name for r in routines)} of {_listed(first)}"
    notes = [f"`{prototype}`" for prototype in library.prototypes]
    stack = max(routine.cost().stack for routine in routines)
    sketch = _routine_sketch(routines, library, stem, board)
    return BoardPart(stem, plain(words), library, call, sketch, 0, stack, notes)


def board_part(program: ControllerProgram, stem: str, board: Board) -> BoardPart:
    """Return a controller on a board."""
    steps, trial_run = program.steps, program.tried
    guard = program.guard
    vectors, step = trial_run.vectors, step_name(guarded=guard is not None)
    library = controller_c(steps, stem, stem, LIBRARY, vectors, program.head(), guard)
    kind = C_TYPES[steps.precision.outside]
    rows = [list(row) or [0.0] for row in trial_run.vectors.inputs][:_SKETCH_CALLS]
    if guard is not None:  # else it would send the fallback
        rows = list(guard.inside(steps, _SKETCH_CALLS))
    declarations = [f"static {stem}_{PORTS[sort]} {sort};" for sort in steps.port_sorts]
    variables = [*steps.of_sort("reference"), *steps.of_sort("measured")]
    arguments = ", ".join(["&state", *(f"&{sort}" for sort in steps.port_sorts)])
    call = MeasuredStep(
        header=f"{stem}.h",
        declarations=[
            f"static {stem}_state state;",
            *declarations,
            *_rows("given", kind, rows, steps.precision.outside),
        ],
        start=[f"{stem}_init(&state);"],
        load=[f"{library.place(port)} = given[k][{k}];" for k, port in enumerate(variables)],
        call=f"{stem}_{step}({arguments});",
        count=len(rows),
        arrays=0,
        self_test=library.self_test,
    )
    model = program.text.model
    words = plain(f"{model.name}: {model.description}" if model.description else model.name)
    notes = [f"`{prototype}`" for prototype in library.prototypes]
    sketch = _controller_sketch(program, library, stem, board)
    inputs = len(steps.of_sort("measured"))
    return BoardPart(
        stem, words, library, call, sketch, library.printer.ram(), 0, notes, model.period, inputs
    )


def _spread(rows: Sequence[list[float]]) -> Sequence[list[float]]:
    """Return at most as many rows as are measured, first and last among them."""
    return rows[:: -(-len(rows) // _SKETCH_CALLS)]


def _function(prototype: str) -> str:
    return prototype.partition("(")[0].split()[-1]


def _listed(routine: Routine) -> str:
    return ", ".join(argument.name for argument in routine.arguments)


def _rows(name: str, kind: str, rows: Sequence[Sequence[float]], of: Kind) -> list[str]:
    """Return an array of the numbers of calls, in a separate flash if there is one."""
    lines = [f"    {{{', '.join(_number(x, of) for x in row)}}}," for row in rows]
    macro = ["#ifdef __FLASH", "#define FLASH __flash", "#else", "#define FLASH", "#endif"]
    return [*macro, f"static const FLASH {kind} {name}[{len(rows)}][{len(rows[0])}] = {{",
            *lines, "};"]  # fmt: skip


def _number(value: float, kind: Kind) -> str:
    return '__builtin_nanf("")' if math.isnan(value) else c_number(value, kind)


# --- The sketch ---


_ROUTINES = """
// Reads <inputs>, prints <outputs>. Made by fuzzyarm; change it at will, in a copy.
#include <<stem>.h>

void setup()
{
    Serial.begin(115200);
}
<last>

void loop()
{
    <read>
    <printed>
    delay(100);
}
"""


def _routine_sketch(routines: Sequence[Routine], library: CText, stem: str, board: Board) -> str:
    """Return a sketch that reads every input from a pin and prints every output."""
    names = Names(reserved=set(_IN_SKETCH), refused=ARDUINO_MACROS)
    first = routines[0]
    kind, scales = C_TYPES[first.kind], _scales(first)
    last, read, printed = [], [], []
    variables = []
    for number, argument in enumerate(a for a in first.arguments if not a.holds):
        variables.append(names.new(argument.name))
        text = _from_pin(argument.low, argument.high, number, scales[number], first.kind, board)
        read.append(f"const {kind} {variables[-1]} = {text};")
    for routine, prototype in zip(routines, library.prototypes, strict=True):
        result, held = names.new(routine.output.name), identifier(f"last {routine.output.name}")
        # A routine that holds its value has no state: its caller passes the last one.
        holds = any(argument.holds for argument in routine.arguments)
        kind = C_TYPES[routine.kind]
        given = ", ".join([*variables, held] if holds else variables)
        printed.append(f"const {kind} {result} = {_function(prototype)}({given});")
        if holds:
            last.append(f"static {kind} {held};")
            printed.append(f"{held} = {result};")
        printed.append(f'Serial.print("{_quoted(routine.output.name)} ");')
        printed.append(f"Serial.println({_quantity(result, _scales(routine)[-1])}, 3);")
    return filled_text(_ROUTINES, {
        "stem": stem, "inputs": plain(_listed(first)), "last": last, "read": read,
        "outputs": plain(", ".join(routine.output.name for routine in routines)),
        "printed": printed,
    })  # fmt: skip


# A line takes a millisecond at 115200 baud: `show` prints rarely.
_CONTROLLER = """
// <words> Made by fuzzyarm; change it at will, in a copy.
#include <<stem>.h>

static <stem>_state state;
<ports>
static const unsigned long period = <count>UL; // <unit>
static unsigned long began, overruns<turns>;

void setup()
{
    Serial.begin(115200);
    <stem>_init(&state);
    began = <clock>() - period;
}

static void show()
{
    <rarely>
    <drives>
    if (overruns > 0) {
        Serial.print("overruns ");
        Serial.println(overruns);
    }
}

void loop()
{
    const unsigned long passed = <clock>() - began; // right when it wraps, too
    if (passed < period) {
        return;
    }
    if (passed - period < period) {
        began += period; // so that a short delay does not add up
    } else {
        began += passed; // a whole period late: anew, nothing is made up for
        overruns++;
    }

    <given>
    <stem>_<step>(<arguments>);
    show();
}
"""


def _controller_sketch(
    program: ControllerProgram, controller: CText, stem: str, board: Board
) -> str:
    """Return a sketch that runs a controller at its period."""
    steps, model = program.steps, program.text.model
    kind, clock = steps.precision.outside, clock_of(model.period)
    every = max(1, round(_SECONDS_BETWEEN_LINES / model.period))
    ports = [f"static {stem}_{PORTS[sort]} {sort};" for sort in steps.port_sorts
             if sort != "measured"]  # fmt: skip
    given = [
        f"{controller.place(port)} = {c_number(0.0, kind)};"
        f" /* what you want of {_said(program, port)} */"
        for port in steps.of_sort("reference")
    ]
    if steps.of_sort("measured"):
        given.append(f"{stem}_measured measured;")
    for number, port in enumerate(steps.of_sort("measured")):
        text = _from_pin(-1.0, 1.0, number, None, kind, board)
        remark = f"/* {_said(program, port)}: the range of your sensor */"
        given.append(f"{controller.place(port)} = {text}; {remark}")
    drives = [
        line
        for port in steps.of_sort("drive")
        for line in (
            f'Serial.print("{_quoted(_said(program, port))} ");',
            f"Serial.println({controller.place(port)}, 3);",
        )
    ]
    rarely = [f"if (++turns < {every}UL) {{", "    return;", "}", "turns = 0;"]
    words = (
        f"Runs {model.name} every {number_text(model.period)} s; prints its drives, and how many"
        " periods began too late."
    )
    return filled_text(_CONTROLLER, {
        "words": plain(words), "stem": stem, "ports": ports, "count": str(clock.count),
        "unit": clock.unit, "clock": clock.function, "turns": ", turns" * (every > 1),
        "rarely": rarely if every > 1 else [], "drives": drives, "given": given,
        "step": step_name(guarded=program.certified is not None),
        "arguments": ", ".join(["&state", *(f"&{sort}" for sort in steps.port_sorts)]),
    })  # fmt: skip


_SELF_TEST = """
// Reports whether this board agrees with the model.
#include <<stem>.h>

void setup()
{
    Serial.begin(115200);
    Serial.println(<test>() == 0 ? "the same" : "not the same");
}

void loop()
{
}
"""


def _scales(routine: Routine) -> list[WholeNumberScale | None]:
    core = getattr(routine, "core", None)
    return list(core.scales) if core is not None else [None] * (len(routine.arguments) + 1)


def _from_pin(
    low: float, high: float, number: int, scale: WholeNumberScale | None, kind: Kind, board: Board
) -> str:
    """Return the code that reads an input; beyond the board's pins inputs stay in the middle."""
    ends = [x if math.isfinite(x) else 0.0 for x in (low, high)]
    if number >= board.pins:
        middle = 0.5 * (ends[0] + ends[1])
        return c_number(scale.nearest(middle) if scale else middle, kind)
    if scale is not None:
        # From 0 .. analog_top to the whole range of the fixed-point number.
        steps = f"analogRead(A{number}) * {1 << (scale.bits + 1)}L / {board.analog_top + 1}"
        return f"({C_TYPES[kind]})({steps} - {1 << scale.bits})"
    width = c_number(ends[1] - ends[0], kind)
    top = c_number(float(board.analog_top), kind)
    return f"{c_number(ends[0], kind)} + analogRead(A{number}) * ({width} / {top})"


def _quantity(name: str, scale: WholeNumberScale | None) -> str:
    """Return the meaning of a result."""
    if scale is None:
        return name
    text = f"{name} * {c_number(scale.step, np.float32)}"
    return f"{text} + {c_number(scale.offset, np.float32)}" if scale.offset else text


def _said(program: ControllerProgram, port: StepVariable) -> str:
    return plain(program.steps.port_name(port))


def _quoted(text: str) -> str:
    return plain(text).replace("\\", "\\\\").replace('"', '\\"')


# --- The files around it ---


def _files(
    part: BoardPart, board: Board, place: str, measured: Measured | None, doubt: str
) -> Iterator[tuple[str, str]]:
    stem = part.stem
    testing = filled_text(_SELF_TEST, {"stem": stem, "test": part.library.self_test})
    library = {
        "library.properties": _properties(part, board),
        "library.json": _library_json(part, board),
        "keywords.txt": _keywords(part),
        **{f"src/{name}": text for name, text in part.sources().items()},
    }
    if place == "arduino":
        yield from library.items()
        yield f"examples/{stem}_example/{stem}_example.ino", part.sketch
        yield f"examples/{stem}_test/{stem}_test.ino", testing
    else:
        for name, text in library.items():
            yield f"lib/{stem}/{name}", text
        words = {"environment": board.environment, "platform": board.platform}
        yield "platformio.ini", filled_text(_PLATFORMIO, words)
        yield "src/main.cpp", f"#include <Arduino.h>\n\n{part.sketch}"
        yield f"lib/{stem}/examples/{stem}_test/{stem}_test.ino", testing
    yield "README.md", "\n".join([*_readme(part, board, place, measured, doubt), ""])


def _properties(part: BoardPart, board: Board) -> str:
    words = {
        "name": part.stem,
        "version": "1.0.0",
        "author": "fuzzyarm",
        "maintainer": "fuzzyarm",
        "sentence": part.words,
        "paragraph": f"Fuzzy inference in C, made by fuzzyarm {__version__}; tables stay in flash.",
        "category": "Signal Input/Output",
        "url": "",
        # Single precision runs on any board; a double is a float on an AVR.
        "architectures": "*" if board.avr else _architecture(board),
        "includes": f"{part.stem}.h",
    }
    return "".join(f"{key}={value}\n" for key, value in words.items())


def _architecture(board: Board) -> str:
    """Return the Arduino IDE's name of a PlatformIO platform."""
    names = {"atmelsam": "sam", "raspberrypi": "rp2040,mbed_rp2040", "espressif32": "esp32"}
    return names[board.platform]


def _library_json(part: BoardPart, board: Board) -> str:
    content = {
        "name": part.stem,
        "version": "1.0.0",
        "description": part.words,
        "keywords": ["fuzzy", "control"],
        "frameworks": "arduino",
        "platforms": "*" if board.avr else board.platform,
        "headers": f"{part.stem}.h",
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _keywords(part: BoardPart) -> str:
    """Return the words that the IDE colours, separated by tabs."""
    functions = [_function(prototype) for prototype in part.library.prototypes]
    listed = [*functions, part.library.self_test]
    return "".join(f"{name}\tKEYWORD2\n" for name in listed)


_PLATFORMIO = """
[env:<environment>]
platform = <platform>
board = <environment>
framework = arduino
monitor_speed = 115200
"""


_MARKDOWN = re.compile(r"[\\`*\[<&~]|(?<!\w)_|_(?!\w)")
"""Marks of Markdown and HTML within a line, which a backslash makes text."""


def _readme(
    part: BoardPart, board: Board, place: str, measured: Measured | None, doubt: str
) -> Iterator[str]:
    words = _MARKDOWN.sub(r"\\\g<0>", part.words)
    yield from [f"# {part.stem}", "", f"{words}. Made by fuzzyarm {__version__}.", ""]
    yield from [*part.notes, ""]
    if place == "arduino":
        yield from _wrapped(
            f"Put this folder into `libraries` of your sketchbook under the name `{part.stem}`"
            " (or zip it: *Sketch, Include Library, Add .ZIP Library*), then open"
            f" *File, Examples, {part.stem}, {part.stem}_example*. The other example,"
            f" `{part.stem}_test`, says over the serial line at 115200 baud whether the board"
            " computes what the model says."
        )
    else:
        yield from _wrapped(
            "Open this folder in PlatformIO, or call `pio run -t upload` in it;"
            f" `src/main.cpp` is the sketch, `lib/{part.stem}` the library;"
            f" `examples/{part.stem}_test` of the library says whether the board computes what the"
            " model says."
        )
    yield from ["", f"## On {board.named}", ""]
    yield from _figures(part, board, measured)
    if doubt:
        yield from ["", *_wrapped(doubt)]


def _figures(part: BoardPart, board: Board, measured: Measured | None) -> Iterator[str]:
    constants = part.library.printer.flash
    yield f"- tables: {constants} bytes of flash, no RAM"
    if measured is None:
        words = f"state: about {part.state} bytes of RAM; {board.ram:,} are there"
        yield from [f"- {words}"] if part.state else []
        yield ""
        if board.avr:
            yield from _wrapped(
                f"Not measured: no avr-gcc was there. With `apt-get install {TOOLS}` the command"
                " that made this folder measures and states bytes and cycles."
            )
        else:
            yield f"Not measured: cycles are counted for AVR boards ({TOOLS})."
        return
    footprint = measured.footprint
    share = 100.0 * footprint.flash / board.flash
    yield (
        f"- flash: {footprint.flash} bytes of {board.flash} ({share:.1f} %), arithmetic of the C"
        " library included"
    )
    yield f"- object file of the library: {measured.object} bytes"
    yield f"- RAM: {footprint.static} bytes of variables of {board.ram}"
    if measured.cycles:
        worst, least = max(measured.cycles), min(measured.cycles)
        micros = worst / board.clock * 1e6
        yield f"- stack of a call: {footprint.stack} bytes"
        yield (
            f"- cycles of a call: {least} to {worst} over {len(measured.cycles)} points;"
            f" {worst} are {micros:.1f} µs at {board.clock // 1_000_000} MHz"
        )
        yield f"- self-test: {'passes' if measured.passes else 'FAILS'}"
    yield ""
    program = "; run in simavr" if measured.cycles else "; no simavr was there to count cycles"
    yield from _wrapped(
        f"Counted with avr-gcc {measured.compiler} `-mmcu={board.processor} {' '.join(FLAGS)}`"
        f"{program}. Bytes are those of a program that calls it, less those of one that does"
        " nothing; the Arduino core is not in them."
    )


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, 110, break_on_hyphens=False, break_long_words=False)
