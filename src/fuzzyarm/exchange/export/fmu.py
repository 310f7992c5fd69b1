"""Controllers and rule bases as co-simulation units: description, library, archive."""

from __future__ import annotations

import hashlib
import io
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from xml.etree import ElementTree as Xml

import numpy as np

from fuzzyarm.base.extras import installing
from fuzzyarm.exchange.export.c import PORTS
from fuzzyarm.exchange.export.c_files import CText, controller_c, routines_c
from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.exchange.export.document import xml_document
from fuzzyarm.exchange.export.fmi import UnitC, fmi_source
from fuzzyarm.exchange.export.numbers import ExportError
from fuzzyarm.exchange.export.routine import Routine, RoutineArgument
from fuzzyarm.exchange.export.steps import Steps, StepVariable
from fuzzyarm.symbolic.identifiers import in_ascii
from fuzzyarm.version import __version__

VERSIONS = (2, 3)

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of all files in an archive: the same source gives the same bytes."""


@dataclass(frozen=True, slots=True)
class Platform:
    """A machine for which a unit can contain a library."""

    target: str  # as the compiler of the ``ziglang`` wheel calls it
    # Of the library in the archive, by the version of FMI; some are unknown to version 2.
    folders: dict[int, str]
    suffix: str  # of the library


PLATFORMS = {
    # 2.17 is the oldest glibc that a host may have.
    "linux64": Platform("x86_64-linux-gnu.2.17", {2: "linux64", 3: "x86_64-linux"}, ".so"),
    "win64": Platform("x86_64-windows-gnu", {2: "win64", 3: "x86_64-windows"}, ".dll"),
    "darwin64": Platform("x86_64-macos", {2: "darwin64", 3: "x86_64-darwin"}, ".dylib"),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", {3: "aarch64-linux"}, ".so"),
    "aarch64-darwin": Platform("aarch64-macos", {3: "aarch64-darwin"}, ".dylib"),
}
"""Platforms by name: those of version 2 of FMI, and two of version 3."""


def platforms_named(text: str, version: int) -> tuple[Platform, ...]:
    """Return platforms by a list like ``linux64,win64``."""
    platforms = []
    for name in dict.fromkeys(part.strip() for part in text.split(",")):
        if name not in PLATFORMS:
            raise ExportError(f"no platform '{name}'", hint=f"there are {', '.join(PLATFORMS)}")
        if version not in PLATFORMS[name].folders:
            raise ExportError(f"version {version} of FMI does not know '{name}'", hint="--fmi 3")
        platforms.append(PLATFORMS[name])
    return tuple(platforms)


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of a unit, in the words of FMI; `member` is its C."""

    name: str
    member: str
    causality: str
    variability: str
    start: float | None = None
    unit: str = ""
    description: str = ""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit to build: its C, and the data of its description.

    Settable variables come first. Without a `period` outputs follow their inputs at once; with one
    they follow the inputs at the beginning of a step.
    """

    prefix: str
    name: str
    description: str
    functions: str
    c: UnitC
    variables: tuple[Variable, ...]
    period: float | None = None


def controller_fmu(
    program: ControllerProgram, prefix: str, version: int = 2, platforms: Sequence[Platform] = ()
) -> bytes:
    """Return a controller as a co-simulation unit, built with the installed C compiler."""
    _require_double(program.precision == "float64")
    steps, model = program.steps, program.text.model
    made = controller_c(steps, prefix, prefix, ".h", program.tried.vectors, program.head())
    variables = _controller_variables(program, made)
    sorts = steps.port_sorts
    period = repr(float(model.period))
    called = ", ".join(["&u->state", *(f"&u->{sort}" for sort in sorts)])
    c = UnitC(
        members=(
            f"{prefix}_state state;",
            *(f"{prefix}_{PORTS[sort]} {sort};" for sort in sorts),
        ),
        begin=(f"{prefix}_init(&u->state);",),
        refresh=(),
        advance=(
            "/* The steps whose time has come; a thousandth of a period is rounding. */",
            f"while (u->start + (double)u->steps * {period} < end - 1e-3 * {period}) {{",
            f"    {prefix}_step({called});",
            "    u->steps++;",
            "}",
        ),
        now=f"u->start + (double)u->steps * {period}",
        places=tuple(variable.member for variable in variables),
        settable=sum(variable.start is not None for variable in variables),
    )
    words = f"{model.description or model.name}; runs every {model.period!r} s"
    unit = Unit(prefix, model.name, words, made.files[".h"], c, variables, model.period)
    return _built(unit, version, platforms)


def routines_fmu(
    routines: Sequence[Routine], prefix: str, version: int = 2, platforms: Sequence[Platform] = ()
) -> bytes:
    """Return functions of a rule base or of tables as a co-simulation unit."""
    _require_double(all(routine.kind is np.float64 for routine in routines))
    made = routines_c(routines, prefix, prefix, ".h")
    functions = made.printer.program.functions.items()
    called = [made.printer.called[key] for key, each in functions if each.public]
    inputs = {a.name: a for routine in routines for a in routine.arguments if not a.holds}
    # Arguments in the order of inputs, a last value in a separate member.
    at = {name: f"u->input[{k}]" for k, name in enumerate(inputs)}
    holding = [k for k, routine in enumerate(routines) if routine.arguments[-1].holds]
    taken: set[str] = set()
    starts = [_start(argument) for argument in inputs.values()]
    variables = [
        Variable(_structured(argument.name, taken), at[name], "input", "continuous", start,
                 description=argument.description)
        for (name, argument), start in zip(inputs.items(), starts, strict=True)
    ]  # fmt: skip
    members, begin, refresh = [f"double input[{len(inputs)}];"], [], []
    if holding:
        members += [f"double {word}[{len(holding)}];" for word in ("first", "last")]
    members += [f"double output[{len(routines)}];", "double passed; /* since the start, s */"]
    begin = [f"{at[name]} = {start!r};" for name, start in zip(inputs, starts, strict=True)]
    kept = []
    for slot, number in enumerate(holding):
        output = routines[number].output
        variables.append(
            Variable(_structured(f"first.{output.name}", taken), f"u->first[{slot}]",
                     "parameter", "fixed", _start(output),
                     description=f"{output.name} before a rule has fired")
        )  # fmt: skip
        begin.append(f"u->first[{slot}] = {_start(output)!r};")
        refresh.append(f"if (u->steps == 0ul) {{ u->last[{slot}] = u->first[{slot}]; }}")
        kept.append(f"u->last[{slot}] = u->output[{number}];")
    settable = len(variables)
    for number, (routine, function) in enumerate(zip(routines, called, strict=True)):
        output = routine.output
        given = [at[a.name] if not a.holds else f"u->last[{holding.index(number)}]"
                 for a in routine.arguments]  # fmt: skip
        refresh.append(f"u->output[{number}] = {function}({', '.join(given)});")

        variables.append(
            Variable(_structured(output.name, taken), f"u->output[{number}]", "output",
                     "continuous", description=output.description)
        )  # fmt: skip
    c = UnitC(
        members=tuple(members),
        begin=tuple(begin),
        refresh=tuple(refresh),
        advance=("refresh(u);", *kept, "u->passed = end - u->start;", "u->steps++;"),
        now="u->start + u->passed",
        places=tuple(variable.member for variable in variables),
        settable=settable,
    )
    name = dict(routines[0].provenance()).get("rulebase", prefix)
    unit = Unit(
        prefix, name, f"{name}, inferred whenever it is read", made.files[".h"], c, tuple(variables)
    )
    return _built(unit, version, platforms)


def _require_double(double: bool) -> None:
    if not double:
        raise ExportError(
            "an FMU computes in double precision", hint="leave out --precision and --q"
        )


def _start(argument: RoutineArgument) -> float:
    """Return the value of a range nearest to zero."""
    return float(min(max(0.0, argument.low), argument.high))


def _built(unit: Unit, version: int, platforms: Sequence[Platform]) -> bytes:
    """Return a unit with its libraries."""
    if version not in VERSIONS:
        raise ExportError(f"version {version} of FMI is not supported", hint="versions 2 and 3 are")
    compiler = _cross_compiler() if platforms else find_compiler()
    prefix = unit.prefix
    # The host compares this token with that of the library: it is a digest of the program.
    digest = hashlib.sha256((unit.functions + str(version)).encode()).digest()
    token = f"{{{uuid.UUID(bytes=digest[:16])}}}"
    source = f'#include "{prefix}.h"\n\n{fmi_source(version, token, unit.c)}'
    sources = {f"{prefix}.h": unit.functions, f"{prefix}.c": source}
    folder = {2: _platform2(), 3: _platform3()}[version]
    content: dict[str, str | bytes] = {
        "modelDescription.xml": _description(unit, version, token),
        **{
            f"binaries/{entry.folders[version]}/{prefix}{entry.suffix}": compile_library(
                [*compiler, "-target", entry.target], sources, prefix, entry.suffix
            )
            for entry in platforms
        },
        **{f"sources/{name}": text for name, text in sources.items()},
    }
    if not platforms:
        place = f"binaries/{folder}/{prefix}{_suffix()}"
        content[place] = compile_library(compiler, sources, prefix, _suffix())
    if version == 3:
        content["sources/buildDescription.xml"] = _build_description(prefix)
    return _archive(content)


# --- The C compiler ---


def find_compiler() -> list[str]:
    """Return the words that call the C compiler: `CC`, else the first of cc, gcc and clang."""
    command = os.environ.get("CC", "")
    words = shlex.split(command)
    if words:
        if shutil.which(words[0]) is None:
            raise ExportError(f"the C compiler '{words[0]}' named by CC was not found")
        return words
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name) is not None:
            return [name]
    raise ExportError(
        "an .fmu needs a C compiler, and none was found",
        hint="install gcc or clang, or name one in CC; a .h needs no compiler",
    )


def _cross_compiler() -> list[str]:
    """Return the words that call the compiler of the ``ziglang`` wheel; ExportError without it."""
    if find_spec("ziglang") is None:
        raise ExportError(
            "libraries for other platforms are built by the ziglang wheel, which is not installed",
            hint=installing("platforms"),
        )
    return [sys.executable, "-m", "ziglang", "cc"]


def compile_library(
    compiler: Sequence[str], files: dict[str, str], name: str, suffix: str
) -> bytes:
    """Return the shared library from some files, by a C compiler."""
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        for file, text in files.items():
            (Path(folder) / file).write_text(text, "utf-8")
        target = Path(folder) / f"{name}{suffix}"
        # Products and sums stay apart: a fused one would move the last bit.
        words = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden"]
        command = [*compiler, *words, f"{name}.c", "-o", target.name, "-lm"]
        try:
            process = subprocess.run(
                command, cwd=folder, capture_output=True, text=True, check=False
            )
        except OSError as error:
            raise ExportError(f"cannot run the C compiler: {error}") from None
        if process.returncode != 0 or not target.is_file():
            message = next(iter(process.stderr.strip().splitlines()), "it says nothing")
            raise ExportError(f"the C compiler '{' '.join(compiler)}' failed: {message}")
        return target.read_bytes()


def _suffix() -> str:
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def _platform2() -> str:
    bits = "64" if sys.maxsize > 2**32 else "32"
    return {"win32": "win", "darwin": "darwin"}.get(sys.platform, "linux") + bits


def _platform3() -> str:
    machine = platform.machine().lower()
    machine = {"amd64": "x86_64", "arm64": "aarch64", "i686": "x86"}.get(machine, machine)
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    return f"{machine}-{system}"


# --- The description ---


_CAUSALITY = {
    "reference": "input", "measured": "input", "gain": "parameter", "drive": "output",
    "signal": "local",
}  # fmt: skip
"""Of the variables of a controller, in the order of value references."""


def _controller_variables(program: ControllerProgram, made: CText) -> tuple[Variable, ...]:
    steps, taken = program.steps, set[str]()
    units = {gain.name: gain.unit for gain in program.text.model.gains}
    variables = []
    for sort, causality in _CAUSALITY.items():
        gain = sort == "gain"
        for variable in steps.of_sort(sort):
            found = Variable(
                _structured(_variable_name(steps, variable), taken),
                f"u->{made.place(variable)}",
                causality,
                "tunable" if gain else "discrete",
                variable.start if sort in ("reference", "measured", "gain") else None,
                units.get(variable.name, "") if gain else "",
            )
            variables.append(found)
    return tuple(variables)


def _variable_name(steps: Steps, variable: StepVariable) -> str:
    """Return ``measured.joint1.position`` and its like."""
    name = variable.name if variable.sort == "gain" else steps.port_name(variable)
    if variable.number >= 0:
        name = f"{name}[{variable.number + 1}]"
    return f"{variable.sort}.{name}" if variable.sort not in ("gain", "drive") else name


def _structured(name: str, taken: set[str]) -> str:
    """Return a unique ASCII name by the structured naming convention: odd parts in quotes."""
    plain, number = in_ascii(name), 1
    name = plain
    while name in taken:
        number += 1
        name = f"{plain}_{number}"
    taken.add(name)
    parts = name.split(".")
    return ".".join(part if _PLAIN.fullmatch(part) else _quoted(part) for part in parts)


_PLAIN = re.compile(r"[A-Za-z_]\w*(\[\d+\])?", re.ASCII)


def _quoted(part: str) -> str:
    escaped = part.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


def _words_of(variable: Variable) -> dict[str, str]:
    """Return the attributes that both versions share, except for the start."""
    words = {"causality": variable.causality, "variability": variable.variability}
    optional = {"unit": variable.unit, "description": variable.description}
    return words | {word: text for word, text in optional.items() if text}


def _description(unit: Unit, version: int, token: str) -> str:
    root = Xml.Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{version}.0",
            "modelName": unit.name,
            "guid" if version == 2 else "instantiationToken": token,
            "description": unit.description,
            "generationTool": f"fuzzyarm {__version__}",
            "variableNamingConvention": "structured",
        },
    )
    if version == 2:
        root.set("numberOfEventIndicators", "0")
    ways = {
        "modelIdentifier": unit.prefix,
        "canHandleVariableCommunicationStepSize": "true",
        "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState": "true",
        "canSerializeFMUstate" if version == 2 else "canSerializeFMUState": "true",
    }
    period = unit.period
    if version == 3 and period is not None:
        ways["fixedInternalStepSize"] = repr(period)
    way = Xml.SubElement(root, "CoSimulation", ways)
    if version == 2:
        Xml.SubElement(Xml.SubElement(way, "SourceFiles"), "File", {"name": f"{unit.prefix}.c"})
    if units := list(dict.fromkeys(entry.unit for entry in unit.variables if entry.unit)):
        listed = Xml.SubElement(root, "UnitDefinitions")
        for name in units:
            Xml.SubElement(listed, "Unit", {"name": name})
    if period is not None:
        times = {"startTime": "0.0", "stopTime": repr(1000 * period), "stepSize": repr(period)}
        Xml.SubElement(root, "DefaultExperiment", times)
    variables = Xml.SubElement(root, "ModelVariables")
    for number, entry in enumerate(unit.variables):
        words = {"name": entry.name, "valueReference": str(number), **_words_of(entry)}
        start = {} if entry.start is None else {"start": repr(entry.start)}
        if version == 3:
            Xml.SubElement(variables, "Float64", {**words, **start})
        else:
            unit_attribute = {"unit": words.pop("unit")} if "unit" in words else {}
            variable = Xml.SubElement(variables, "ScalarVariable", words)
            Xml.SubElement(variable, "Real", {**unit_attribute, **start})
    if version == 3:
        # FMI 3 requires the independent variable; FMI 2 has none.
        reference = str(len(unit.variables))
        time = {"name": "time", "valueReference": reference, "causality": "independent"}
        Xml.SubElement(variables, "Float64", {**time, "variability": "continuous"})
    _structure(root, version, unit)
    Xml.indent(root)
    return xml_document(root, "UTF-8")


def _structure(root: Xml.Element, version: int, unit: Unit) -> None:
    """List the outputs, and whether inputs reach them within a step."""
    structure = Xml.SubElement(root, "ModelStructure")
    outputs = [k for k, entry in enumerate(unit.variables) if entry.causality == "output"]
    # Without the attribute an output depends on all inputs.
    depends = {} if unit.period is None else {"dependencies": ""}
    if version == 3:
        for word in ("Output", "InitialUnknown"):
            for number in outputs:
                Xml.SubElement(structure, word, {"valueReference": str(number), **depends})
        return
    for word in ("Outputs", "InitialUnknowns"):
        listed = Xml.SubElement(structure, word)
        for number in outputs:
            # FMI 2 refers to a variable by its position, from 1.
            Xml.SubElement(listed, "Unknown", {"index": str(number + 1), **depends})


def _build_description(prefix: str) -> str:
    root = Xml.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = Xml.SubElement(root, "BuildConfiguration", {"modelIdentifier": prefix})
    sources = Xml.SubElement(configuration, "SourceFileSet", {"language": "C99"})
    Xml.SubElement(sources, "SourceFile", {"name": f"{prefix}.c"})
    Xml.indent(root)
    return xml_document(root, "UTF-8")


def _archive(content: dict[str, str | bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    return buffer.getvalue()
